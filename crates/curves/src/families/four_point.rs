//! The 4-point form: each span is the cubic through four points.
//!
//! *Source*: G. Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002; *Interpolation Techniques*, chapter 2, "4-point form". The points are passed at `x = 0, 1/3, 2/3, 1` of the
//! span; neighbouring spans share an end point and meet without a common tangent.

use super::{Generator, in_threes, through};
use crate::{Cubic, CurveError, PiecewiseCubic};
use anamorph_core::Space;

/// A curve through all points, three to a span. Continuous in position.
#[derive(Clone, Debug, PartialEq)]
pub struct FourPoint<S> {
    /// Points to pass: 4, 7, 10, …; of a closed curve 3, 6, 9, … (the last span ends at the first point).
    pub points: Vec<S>,
    /// Whether the curve returns to its first point.
    pub closed: bool,
}

impl<S: Space> Generator<S> for FourPoint<S> {
    fn curve(&self) -> Result<PiecewiseCubic<S>, CurveError> {
        let points = &self.points;
        let fours = in_threes("a curve in 4-point form", points, self.closed)?;
        let spans = fours.map(|p| {
            Cubic([
                p[0],
                (p[1] * 18.0 - p[0] * 11.0 - p[2] * 9.0 + p[3] * 2.0) * 0.5,
                (p[0] * 2.0 - p[1] * 5.0 + p[2] * 4.0 - p[3]) * 4.5,
                (p[1] * 3.0 - p[0] - p[2] * 3.0 + p[3]) * 4.5,
            ])
        });
        through(points, spans.collect(), None, self.closed)
    }
}
