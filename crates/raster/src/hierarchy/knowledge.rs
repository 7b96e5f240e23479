//! What a deformation's facts say about cells.

use super::Hierarchy;
use crate::Window;
use anamorph_core::glam::DVec2;
use anamorph_core::{Bounds, Facts, Plane, Smoothness, Support};

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
    /// Bounds of first and second derivatives of the displacement.
    first: Option<f64>,
    second: Option<f64>,
    max_error: f64,
    only_derived: bool,
    corner: DVec2,
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
        if self.only_derived || h > self.largest || on_edge {
            return Verdict::Refine;
        }
        Verdict::Ask
    }
}
