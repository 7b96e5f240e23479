//! Chains of cubic Bézier curves.
//!
//! *Source*: G. Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002; *Interpolation Techniques*, chapter 2, "Cubic Bézier", with the matrix of errata C1; curves of any degree are
//! [`Bezier`](crate::Bezier).

use super::{Generator, through};
use crate::error::enough;
use crate::{Cubic, CurveError, PiecewiseCubic};
use anamorph_core::Space;

/// Cubic Bézier curves, each starting where the one before it ends.
#[derive(Clone, Debug, PartialEq)]
pub struct CubicBezier<S> {
    /// Control points: 4, 7, 10, …; of a closed curve 3, 6, 9, … (the last piece ends at the first point). Every third is
    /// passed; the others play the part of tangents.
    pub points: Vec<S>,
    /// Whether the curve returns to its first point.
    pub closed: bool,
}

impl<S: Space> Generator<S> for CubicBezier<S> {
    fn curve(&self) -> Result<PiecewiseCubic<S>, CurveError> {
        let points = &self.points;
        let (needed, rest, in_words) = if self.closed {
            (3, 0, "3, 6, 9, …")
        } else {
            (4, 1, "4, 7, 10, …")
        };
        enough("a chain of cubic Bézier curves", needed, points)?;
        if points.len() % 3 != rest {
            return Err(CurveError::WrongCount {
                what: "a chain of cubic Bézier curves",
                needed: in_words,
                found: points.len(),
            });
        }
        let n = points.len();
        let spans = (0..n - rest)
            .step_by(3)
            .map(|i| Cubic::from_bezier(core::array::from_fn(|k| points[(i + k) % n])));
        through(points, spans.collect(), None, self.closed)
    }
}
