//! Hierarchical sampling: a map evaluated on a grid only as fine as a bound of its error asks for.
//!
//! *Source*: proposed in Milliron et al. 2002, §8.5, without a method. The cells' interpolant is the element of A. Adini and
//! R. W. Clough, *Analysis of plate bending by the finite element method*, 1961, seen as a patch of S. A. Coons (cubic Hermite
//! edges, blended linearly): it takes values and Jacobians at the four corners, reproduces cubics and is continuous between cells
//! of one size.
//!
//! The window is covered by square cells of the coarsest size. A cell whose interpolant is not known to be good enough is
//! quartered, down to cells of 4 pixels, and those are evaluated pixel by pixel. A cell is accepted, in this order,
//!
//! - *still*, where it lies outside the deformation's support: exactly the identity;
//! - *derived*, where a bound of the deformation's derivatives bounds the error of interpolating between its corners: with
//!   `‖J − I‖ ≤ L` ([`Facts::stretch`](anamorph_core::Facts::stretch)) of a continuous deformation by `L·h/√2`, `h` the cell's size,
//!   because the weights' mean distance to the corners is at most that; with second derivatives of at most `K` by `K·h²/4`;
//! - *estimated*, where nine evaluations (five in cells of 8 and 4 pixels) between the corners, among them the middles of the edges and
//!   of the cell, where the error of smooth maps is largest, differ by at most the allowed error over a safety factor (half of that in cells of 4 pixels); or, but for the
//!   smallest cells, where the middles differ by no more than twice that, and a patch that is made to agree with them (quartic
//!   along the edges, one order better) agrees with four evaluations between them.
//!
//! An estimate can miss what is smaller than the distance of the evaluations, a quarter of a cell (half of the smallest).
//! Therefore cells are at most 32 pixels large; cells that meet the support are at most an eighth of the support's size; cells on
//! an edge of the support where the deformation is not smooth are evaluated pixel by pixel, and so are those at kinks that it names
//! ([`Facts::kinks`](anamorph_core::Facts::kinks)); a cell of 8 pixels or more is never larger
//! than a refined neighbour, so that a crease that a cell misses has been seen by the cells that it comes from; and cells of 8 and 4
//! pixels are looked at again along the sides that they share with cells that are quartered or evaluated pixel by pixel. The allowed error
//! holds pixel by pixel in each cell, so also where cells of different sizes meet; there the map can step by at most twice that.
//!
//! Every evaluation that a finer cell can use again is kept: the checks of a cell are corners and checks of its quarters. Only along
//! the rows where two bands of 64 rows meet, each a task of its own, may finer cells evaluate the same place twice.
//! Jacobians are differences of evaluations in one batch with the others, rather than
//! [`Deformation::jacobian`], because batches keep the deformations' kernels.

mod band;
mod coarse;
mod grading;
mod knowledge;
mod patch;

use crate::{PixelMap, RasterError, Window, parallel};
use anamorph_core::{Deformation, Domain, Plane};
use band::{Band, Work};
use coarse::Coarse;
use knowledge::Knowledge;
use std::sync::atomic::{AtomicBool, Ordering};

/// Size of the smallest cells: 4 pixels cost up to 5 evaluations more than the cell of 8 that they are of, 2 Jacobian differences among them, for
/// 16 pixels.
const FINEST: usize = 4;

/// How fine a hierarchical map is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hierarchy {
    /// The allowed distance between a position and the exact one, in source pixels; positive.
    pub max_error: f64,
    /// Size of the coarsest cells in pixels: 8, 16 or 32. Estimates may miss what is smaller than a quarter of it.
    pub coarsest: usize,
    /// Estimated errors are multiplied by this before they are compared; at least 1.
    pub safety: f64,
    /// A bound of the second derivatives of the deformation, per pixel, over the window and 32 pixels around it, where the
    /// caller knows one: `‖D²f(v, v)‖ ≤ K` for all unit vectors `v`.
    pub second_derivative: Option<f64>,
    /// Accepts no estimates: what no bound covers is evaluated pixel by pixel.
    pub only_derived: bool,
}

impl Default for Hierarchy {
    /// A twentieth of a pixel, cells of at most 32 pixels, estimates doubled.
    fn default() -> Self {
        Self {
            max_error: 0.05,
            coarsest: 32,
            safety: 2.0,
            second_derivative: None,
            only_derived: false,
        }
    }
}

impl Hierarchy {
    /// The default with another allowed error.
    pub fn within(max_error: f64) -> Self {
        Self {
            max_error,
            ..Self::default()
        }
    }

    fn check(&self) -> Result<(), RasterError> {
        let out_of_range = |name, value, range| Err(RasterError::OutOfRange { name, value, range });
        if !(self.max_error > 0.0 && self.max_error.is_finite()) {
            return out_of_range("max_error", self.max_error, "positive, in pixels");
        }
        if !matches!(self.coarsest, 8 | 16 | 32) {
            return out_of_range("coarsest", self.coarsest as f64, "8, 16 or 32");
        }
        if !(self.safety >= 1.0 && self.safety.is_finite()) {
            return out_of_range("safety", self.safety, "at least 1");
        }
        match self.second_derivative {
            Some(bound) if !(bound >= 0.0 && bound.is_finite()) => {
                out_of_range("second_derivative", bound, "not negative")
            }
            _ => Ok(()),
        }
    }
}

/// What the promise of a hierarchical map rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bound {
    /// Every pixel is exact or in a cell whose error is bounded by the deformation's derivatives.
    Derived,
    /// Some cells were accepted by evaluations inside them: an estimate.
    Estimated,
}

/// How a hierarchical map was made, and how good it is.
#[derive(Debug, Clone, PartialEq)]
pub struct HierarchyReport {
    /// What `max_error` rests on.
    pub bound: Bound,
    /// The largest error, in source pixels: what was asked for, or the rounding of the stored offsets where that is more.
    pub max_error: f64,
    /// The largest error found where estimated cells were checked, in source pixels.
    pub measured: f64,
    /// How many places were checked.
    pub checks: usize,
    /// How many times the deformation was evaluated.
    pub evaluations: usize,
    /// Pixels that were evaluated one by one.
    pub exact_pixels: usize,
    /// Pixels outside the deformation's support.
    pub still_pixels: usize,
    /// Pixels in cells with a derived bound.
    pub derived_pixels: usize,
    /// Pixels in cells with an estimated one.
    pub estimated_pixels: usize,
}

impl HierarchyReport {
    const NOTHING: Self = Self {
        bound: Bound::Derived,
        max_error: 0.0,
        measured: 0.0,
        checks: 0,
        evaluations: 0,
        exact_pixels: 0,
        still_pixels: 0,
        derived_pixels: 0,
        estimated_pixels: 0,
    };

    fn add(&mut self, other: &Self) {
        self.max_error = self.max_error.max(other.max_error);
        self.measured = self.measured.max(other.measured);
        self.checks += other.checks;
        self.evaluations += other.evaluations;
        self.exact_pixels += other.exact_pixels;
        self.still_pixels += other.still_pixels;
        self.derived_pixels += other.derived_pixels;
        self.estimated_pixels += other.estimated_pixels;
    }
}

/// The map of a deformation from target to source over `window`, within `options.max_error` of the exact one; see the module's
/// documentation for how. A deformation that reads one model's indices is evaluated at every pixel.
///
/// # Errors
/// [`RasterError::OutOfRange`] for options outside their ranges; [`RasterError::TooLarge`].
pub fn hierarchical_map(
    deformation: &dyn Deformation<Plane>,
    window: Window,
    options: &Hierarchy,
) -> Result<(PixelMap, HierarchyReport), RasterError> {
    let mut map = PixelMap::identity(window)?;
    let report = hierarchical_map_into(deformation, options, &mut map)?;
    Ok((map, report))
}

/// As [`hierarchical_map`], over a map that is already there: sequences need no new memory for each picture, which on large
/// ones takes longer than all else.
///
/// # Errors
/// As [`hierarchical_map`].
pub fn hierarchical_map_into(
    deformation: &dyn Deformation<Plane>,
    options: &Hierarchy,
    map: &mut PixelMap,
) -> Result<HierarchyReport, RasterError> {
    options.check()?;
    if deformation.domain() == Domain::Model {
        return Ok(exact(deformation, options, map));
    }
    let window = map.window();
    let knowledge = Knowledge::new(&deformation.facts(), window, options);
    let coarse = Coarse::new(deformation, window, options.coarsest)?;
    let mut report = HierarchyReport {
        evaluations: coarse.evaluations(),
        ..HierarchyReport::NOTHING
    };
    let work = Work {
        deformation,
        window,
        options,
        knowledge: &knowledge,
        coarse: &coarse,
    };
    // All bands decide, then all look at their neighbours' decisions, until nobody changes anything: so the cells are the
    // same whichever band is first.
    let mut bands: Vec<Option<Band<'_>>> = Vec::new();
    bands.resize_with(window.height().div_ceil(Band::ROWS), || None);
    loop {
        parallel::chunks(&mut bands, 1, |number, bands| {
            for band in bands {
                band.get_or_insert_with(|| Band::new(&work, number))
                    .decide();
            }
        });
        let rims: Vec<_> = bands.iter_mut().flatten().map(Band::rims).collect();
        let changed = AtomicBool::new(false);
        parallel::chunks(&mut bands, 1, |number, bands| {
            let above = number.checked_sub(1).and_then(|n| rims.get(n));
            for band in bands.iter_mut().flatten() {
                if band.grade(above, rims.get(number + 1)) {
                    changed.store(true, Ordering::Relaxed);
                }
            }
        });
        if !changed.into_inner() {
            break;
        }
    }
    let mut parts: Vec<_> = bands
        .iter_mut()
        .flatten()
        .zip(map.offsets_mut().chunks_mut(Band::ROWS * window.width()))
        .collect();
    parallel::chunks(&mut parts, 1, |_, parts| {
        for (band, out) in parts {
            band.fill(out);
        }
    });
    for band in bands.iter().flatten() {
        report.add(band.report());
    }
    drop(bands);
    report.max_error = report.max_error.max(options.max_error);
    if report.estimated_pixels > 0 {
        report.bound = Bound::Estimated;
    }
    Ok(report)
}

/// The map evaluated at every pixel, as a hierarchical one.
fn exact(
    deformation: &dyn Deformation<Plane>,
    options: &Hierarchy,
    map: &mut PixelMap,
) -> HierarchyReport {
    map.evaluate(deformation);
    let pixels = map.offsets().len();
    let largest = map
        .offsets()
        .as_flattened()
        .iter()
        .fold(0.0_f32, |most, offset| most.max(offset.abs()));
    HierarchyReport {
        max_error: options.max_error.max(patch::rounding(f64::from(largest))),
        evaluations: pixels,
        exact_pixels: pixels,
        ..HierarchyReport::NOTHING
    }
}
