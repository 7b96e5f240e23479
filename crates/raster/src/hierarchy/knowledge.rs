//! What a deformation's facts say about cells.

use super::{FINEST, Hierarchy};
use crate::Window;
use anamorph_core::glam::DVec2;
use anamorph_core::{Bounds, Facts, Plane, Smoothness, Support};

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
    /// It must be quartered because of a crease, beside which the map is smooth.
    Crease,
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
    /// Cells at kinks and creases.
    kinks: Marks,
    /// Bounds of first and second derivatives of the displacement.
    first: Option<f64>,
    second: Option<f64>,
    max_error: f64,
    only_derived: bool,
    corner: DVec2,
}

/// Marks of cells that creases cross, and of those at kinks.
const CREASE: u8 = 1;
const KINK: u8 = 2;

/// Marked cells of all sizes.
#[derive(Default)]
struct Marks {
    /// By size, the coarsest first: how many cells there are across, and how each is marked, row by row.
    levels: Vec<(usize, Vec<u8>)>,
    coarsest: usize,
}

impl Marks {
    /// The cells that hold a kink or have one near, or are crossed by a crease.
    fn new(facts: &Facts<Plane>, window: Window, coarsest: usize) -> Self {
        if facts.kinks.is_empty() && facts.creases.is_empty() {
            return Self::default();
        }
        let sizes = || {
            let sizes = core::iter::successors(Some(coarsest), |size| Some(size / 2));
            sizes.take_while(|size| *size >= FINEST)
        };
        let none = |size| {
            let across = window.width().div_ceil(size);
            (across, vec![0; across * window.height().div_ceil(size)])
        };
        let mut levels: Vec<(usize, Vec<u8>)> = sizes().map(none).collect();
        let mut mark = |level: usize, column: i64, row: i64, kind: u8| {
            let (across, marks) = &mut levels[level];
            if let (Ok(column), Ok(row)) = (usize::try_from(column), usize::try_from(row))
                && column < *across
                && let Some(mark) = marks.get_mut(row * *across + column)
            {
                *mark |= kind;
            }
        };
        let whole = DVec2::new(window.width() as f64, window.height() as f64);
        let margin = coarsest as f64;
        // The cell of the interpolant begins at the centre of its first pixel.
        let own = |place: DVec2| place - window.corner() - 0.5;
        for crease in &facts.creases {
            let Some(ends) = clipped(crease.map(own), whole + margin) else {
                continue;
            };
            for (level, size) in sizes().enumerate() {
                for (column, row) in crossed(ends.map(|end| end / size as f64)) {
                    mark(level, column, row, CREASE);
                }
            }
        }
        for place in facts.kinks.iter().chain(facts.creases.as_flattened()) {
            let at = own(*place);
            let seen = at.cmpge(DVec2::splat(-margin)).all() && at.cmple(whole + margin).all();
            if !seen {
                continue;
            }
            for (level, size) in sizes().enumerate() {
                let (cell, near) = (at / size as f64, DVec2::splat(NEAR));
                let (low, high) = ((cell - near).floor(), (cell + near).floor());
                for column in low.x as i64..=high.x as i64 {
                    for row in low.y as i64..=high.y as i64 {
                        mark(level, column, row, KINK);
                    }
                }
            }
        }
        Self { levels, coarsest }
    }

    /// How the cell of that size at that pixel is marked.
    fn at(&self, x: usize, y: usize, size: usize) -> u8 {
        let Some(level) = self.coarsest.checked_ilog2().zip(size.checked_ilog2()) else {
            return 0;
        };
        let level = self.levels.get((level.0 - level.1) as usize);
        level.map_or(0, |(across, marks)| marks[y / size * across + x / size])
    }
}

/// The piece of a segment between the corner and `far`.
fn clipped([from, to]: [DVec2; 2], far: DVec2) -> Option<[DVec2; 2]> {
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    let step = to - from;
    for axis in 0..2 {
        let (a, b) = (
            -from[axis] / step[axis],
            (far[axis] - from[axis]) / step[axis],
        );
        if step[axis] == 0.0 {
            if !(0.0..=far[axis]).contains(&from[axis]) {
                return None;
            }
        } else {
            first = first.max(a.min(b));
            last = last.min(a.max(b));
        }
    }
    (first <= last).then(|| [from + step * first, from + step * last])
}

/// The unit squares that a segment goes through, those that it touches in an edge or corner included.
fn crossed([a, b]: [DVec2; 2]) -> Vec<(i64, i64)> {
    // A rounding more on either side.
    const MORE: f64 = 1e-9;
    let (left, right) = if a.x <= b.x { (a, b) } else { (b, a) };
    let mut squares = Vec::new();
    for column in (left.x - MORE).floor() as i64..=(right.x + MORE).floor() as i64 {
        let at = |x: f64| {
            let share = (x - left.x) / (right.x - left.x);
            let share = if share.is_nan() { 0.0 } else { share };
            left.y + (right.y - left.y) * share.clamp(0.0, 1.0)
        };
        let (x, whole) = (column as f64, right.x - left.x <= MORE);
        let (y0, y1) = if whole {
            (left.y, right.y)
        } else {
            (at(x - MORE), at(x + 1.0 + MORE))
        };
        let (low, high) = (y0.min(y1) - MORE, y0.max(y1) + MORE);
        squares.extend((low.floor() as i64..=high.floor() as i64).map(|row| (column, row)));
    }
    squares
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
            kinks: Marks::new(facts, window, options.coarsest),
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
        let marks = self.kinks.at(x, y, size);
        if self.only_derived || h > self.largest || on_edge || marks & KINK != 0 {
            return Verdict::Refine;
        }
        if marks & CREASE != 0 {
            return Verdict::Crease;
        }
        Verdict::Ask
    }
}
