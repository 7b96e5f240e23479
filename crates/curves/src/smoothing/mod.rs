//! Smoothing of paths that are jerky because of noise or imprecision.
//!
//! Every method is linear: a smoothed point is a weighted sum of the points about it. A [`Filter`] gives the weights;
//! [`smooth`] applies them to points of the plane or of space, or to numbers, for open and closed paths, as often as asked,
//! and never moves what is pinned.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Smoothing data" (errata C5, C6); A. Savitzky and M. J. E. Golay,
//! *Smoothing and Differentiation of Data by Simplified Least Squares Procedures*, Analytical Chemistry 36(8), 1964.
//!
//! ```
//! use anamorph_curves::smoothing::{NeighbourAverage, Smoothing, smooth};
//!
//! let path = [0.0, 1.0, 0.0, 1.0, 0.0];
//! let smoothed = smooth(&path, &NeighbourAverage, &Smoothing::default())?;
//! assert_eq!(smoothed, [0.0, 0.5, 0.5, 0.5, 0.0]);
//! # Ok::<(), anamorph_curves::CurveError>(())
//! ```

mod cubic;
mod kernel;
mod savitzky_golay;

pub use cubic::FourNeighbourCubic;
pub use kernel::{Kernel, NeighbourAverage};
pub use savitzky_golay::SavitzkyGolay;

use crate::CurveError;
use core::ops::{Add, Mul, Sub};

/// What can be smoothed: numbers, and the points of any [`Space`](anamorph_core::Space).
pub trait Smoothable:
    Copy + PartialEq + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>
{
}

impl<V> Smoothable for V where
    V: Copy + PartialEq + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>
{
}

/// Finite values are those whose difference with themselves is a number.
#[allow(clippy::eq_op)]
fn is_finite<V: Smoothable>(value: V) -> bool {
    (value - value) == (value - value)
}

/// A method of smoothing.
pub trait Filter: core::fmt::Debug + Send + Sync {
    /// The weights for a path of that many points, at least one; `closed` paths wrap.
    fn weights(&self, count: usize, closed: bool) -> Box<dyn Weights + '_>;
}

/// The weights of a filter for paths of one length.
pub trait Weights {
    /// Adds to `row` the points, by index, of which smoothed point `index` is the sum, and their weights. A point may be
    /// named more than once.
    fn row(&self, index: usize, row: &mut Vec<(usize, f64)>);
}

/// How a path is smoothed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Smoothing<'a> {
    /// Whether the last point is followed by the first. The first point is not repeated at the end.
    pub closed: bool,
    /// How often the filter is applied, each time to the result of the time before.
    pub iterations: u32,
    /// Indices of points that do not move. Others see them where they are.
    pub pinned: &'a [usize],
    /// Whether the ends of an open path do not move.
    pub pin_ends: bool,
}

impl Default for Smoothing<'_> {
    /// Once, an open path, nothing pinned.
    fn default() -> Self {
        Self {
            closed: false,
            iterations: 1,
            pinned: &[],
            pin_ends: false,
        }
    }
}

/// Smooths the points of a path. The result has as many; pinned points keep their bits.
///
/// # Errors
/// [`CurveError::NotFinite`] for a point that is not finite, or one that leaves the range of numbers;
/// [`CurveError::NoSuchIndex`] for a pinned index.
pub fn smooth<V: Smoothable>(
    points: &[V],
    filter: &dyn Filter,
    smoothing: &Smoothing<'_>,
) -> Result<Vec<V>, CurveError> {
    let check = |what, points: &[V]| match points.iter().position(|&point| !is_finite(point)) {
        Some(index) => Err(CurveError::NotFinite { what, index }),
        None => Ok(()),
    };
    check("point", points)?;
    let mut held = vec![false; points.len()];
    for &index in smoothing.pinned {
        match held.get_mut(index) {
            Some(place) => *place = true,
            None => {
                return Err(CurveError::NoSuchIndex {
                    what: "pinned point",
                    index,
                    count: points.len(),
                });
            }
        }
    }
    let mut now = points.to_vec();
    let Some(last) = points.len().checked_sub(1) else {
        return Ok(now);
    };
    if smoothing.pin_ends && !smoothing.closed {
        held[0] = true;
        held[last] = true;
    }
    let weights = filter.weights(points.len(), smoothing.closed);
    let mut next = now.clone();
    let mut row = Vec::new();
    for _ in 0..smoothing.iterations {
        for (index, place) in next.iter_mut().enumerate() {
            if held[index] {
                continue;
            }
            row.clear();
            weights.row(index, &mut row);
            let mut terms = row.iter().map(|&(from, weight)| now[from] * weight);
            if let Some(first) = terms.next() {
                *place = terms.fold(first, |sum, term| sum + term);
            }
        }
        core::mem::swap(&mut now, &mut next);
    }
    check("smoothed point", &now)?;
    Ok(now)
}

/// The index that an offset from `index` leads to on a closed path.
fn wrapped(index: usize, offset: i64, count: usize) -> usize {
    // Counts and indices of slices are below 2⁶³.
    #[allow(
        clippy::cast_possible_wrap,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss
    )]
    let at = (index as i64 + offset).rem_euclid(count as i64) as usize;
    at
}

#[cfg(test)]
mod tests;
