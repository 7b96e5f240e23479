//! The curve formulations of *Interpolation Techniques*, chapter 2, one a file, each a generator of a curve.
//!
//! Families with cubic pieces make a [`PiecewiseCubic`]; [`Lagrange`] and curves of other degrees
//! make a [`PiecewiseBezier`](crate::PiecewiseBezier) or themselves.

mod bezier;
mod bspline;
mod catmull_rom;
mod four_point;
mod hermite;
mod kochanek_bartels;
mod lagrange;
mod parabolas;
pub mod registry;

pub use bezier::CubicBezier;
pub use bspline::{BSpline, Knots};
pub use catmull_rom::{CatmullRom, Ends, Spacing};
pub use four_point::FourPoint;
pub use hermite::Hermite;
pub use kochanek_bartels::{KochanekBartels, Shape};
pub use lagrange::{Lagrange, MAX_NODES};
pub use parabolas::BlendedParabolas;

use crate::error::{enough, increasing};
use crate::{Cubic, CurveError, PiecewiseCubic};
use anamorph_core::Space;

/// A recipe for a curve of cubic pieces.
pub trait Generator<S: Space> {
    /// Makes the curve.
    ///
    /// # Errors
    ///
    /// Input from which the family cannot make one; the error names the element.
    fn curve(&self) -> Result<PiecewiseCubic<S>, CurveError>;
}

/// Refuses times that do not increase, or are not one for each of `count` keys (`closed`: and one for the return to the
/// first).
fn check_times(times: &[f64], count: usize, closed: bool) -> Result<(), CurveError> {
    let needed = count + usize::from(closed);
    if times.len() != needed {
        return Err(CurveError::Mismatch {
            what: "times",
            found: times.len(),
            needed,
            of: if closed {
                "points and the return to the first"
            } else {
                "points"
            },
            expected: count,
        });
    }
    increasing("time", times)
}

/// The points of chained spans, four to a span of which the next begins with the last; a closed chain returns to its first.
fn in_threes<'a, S: Space>(
    what: &'static str,
    points: &'a [S],
    closed: bool,
) -> Result<impl Iterator<Item = [S; 4]> + use<'a, S>, CurveError> {
    let (least, rest, needed) = if closed {
        (3, 0, "3, 6, 9, …")
    } else {
        (4, 1, "4, 7, 10, …")
    };
    enough(what, least, points)?;
    let found = points.len();
    if found % 3 != rest {
        return Err(CurveError::WrongCount {
            what,
            needed,
            found,
        });
    }
    let starts = (0..found - rest).step_by(3);
    Ok(starts.map(move |i| core::array::from_fn(|k| points[(i + k) % found])))
}

/// The curve of these spans over `times` (or 0, 1, 2, …) that ends at the last of `points`, or at the first if closed.
fn through<S: Space>(
    points: &[S],
    spans: Vec<Cubic<S>>,
    times: Option<&[f64]>,
    closed: bool,
) -> Result<PiecewiseCubic<S>, CurveError> {
    let curve = match times {
        Some(times) => PiecewiseCubic::with_breaks(spans, times.to_vec(), closed)?,
        None => PiecewiseCubic::new(spans, closed)?,
    };
    let end = if closed {
        points.first()
    } else {
        points.last()
    };
    Ok(match end {
        Some(end) => curve.ending_at(*end),
        None => curve,
    })
}
