//! What a deformation's facts say about cells.

use super::{FINEST, Hierarchy};
use crate::Window;
use anamorph_core::glam::DVec2;
use anamorph_core::{Bounds, Facts, Plane, Smoothness, Support};
use std::collections::HashSet;

/// How far from a cell, in its sizes, a kink still makes it be quartered: beside a cone the map bends most.
const NEAR: f64 = 0.25;

/// What is to be done with a cell before anything is evaluated in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    /// It is outside the support.
    Still,
    /// Interpolating its corners is good enough.
    Derived,
    /// It must be quartered.
    Refine,
    /// Evaluations must tell.
    Ask,
}

/// Facts in the form in which cells ask for them.
pub(super) struct Knowledge {
    support: Support<Plane>,
    /// Cells that meet the support are at most this large.
    largest: f64,
    /// The deformation has kinks or jumps along the edge of its support.
    sharp_edge: bool,
    /// Cells at kinks: their size, and which across and down. Only asked whether a cell is among them.
    kinks: HashSet<(usize, i64, i64)>,
    /// Bounds of first and second derivatives of the displacement.
    first: Option<f64>,
    second: Option<f64>,
    max_error: f64,
    only_derived: bool,
    corner: DVec2,
}

/// The cells of all sizes that hold one of the places or have one near.
fn cells_at(places: &[Plane], window: Window, coarsest: usize) -> HashSet<(usize, i64, i64)> {
    let mut cells = HashSet::new();
    let whole = DVec2::new(window.width() as f64, window.height() as f64);
    let margin = coarsest as f64;
    for place in places {
        // The cell of the interpolant begins at the centre of its first pixel.
        let at = *place - window.corner() - 0.5;
        let seen = at.cmpge(DVec2::splat(-margin)).all() && at.cmple(whole + margin).all();
        if !seen {
            continue;
        }
        let sizes = core::iter::successors(Some(coarsest), |size| Some(size / 2));
        for size in sizes.take_while(|size| *size >= FINEST) {
            let (cell, near) = (at / size as f64, DVec2::splat(NEAR));
            let (low, high) = ((cell - near).floor(), (cell + near).floor());
            for column in low.x as i64..=high.x as i64 {
                for row in low.y as i64..=high.y as i64 {
                    cells.insert((size, column, row));
                }
            }
        }
    }
    cells
}

impl Knowledge {
    pub(super) fn new(facts: &Facts<Plane>, window: Window, options: &Hierarchy) -> Self {
        let largest = facts
            .support
            .bounds()
            .map_or(f64::INFINITY, |bounds| bounds.size().min_element() / 8.0);
        let continuous = facts.smoothness() > Smoothness::Jump;
        Self {
            support: facts.support,
            largest,
            sharp_edge: facts.edge < Smoothness::C(1),
            kinks: cells_at(&facts.kinks, window, options.coarsest),
            first: facts.stretch().filter(|_| continuous),
            second: options.second_derivative,
            max_error: options.max_error,
            only_derived: options.only_derived,
            corner: window.corner(),
        }
    }

    /// The verdict on the cell whose first pixel is `(x, y)`, counted from the window's corner.
    pub(super) fn verdict(&self, x: usize, y: usize, size: usize) -> Verdict {
        let h = size as f64;
        let first = self.corner + DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        // The cell of the interpolant reaches to the first pixels of its neighbours.
        let cell = Support::Box(Bounds::new(first, first + h));
        let outside = match self.support {
            Support::Nowhere => true,
            Support::Everywhere => false,
            Support::Ball { centre, radius } => {
                centre.clamp(first, first + h).distance(centre) > radius
            }
            Support::Box(_) => self.support.intersection(cell) == Support::Nowhere,
        };
        if outside {
            return Verdict::Still;
        }
        let first_order = self.first.map(|l| l * h * core::f64::consts::FRAC_1_SQRT_2);
        let second_order = self.second.map(|k| k * h * h / 4.0);
        let fits = |bound: Option<f64>| bound.is_some_and(|b| b <= 0.5 * self.max_error);
        if fits(first_order) || fits(second_order) {
            return Verdict::Derived;
        }
        let on_edge = self.sharp_edge && !self.support.covers(&cell);
        let index = |at: usize| (at / size) as i64;
        let on_kink = !self.kinks.is_empty() && self.kinks.contains(&(size, index(x), index(y)));
        if self.only_derived || h > self.largest || on_edge || on_kink {
            return Verdict::Refine;
        }
        Verdict::Ask
    }
}
