//! Chains of cubic Bézier curves.
//!
//! *Source*: G. Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002; *Interpolation Techniques*, chapter 2, "Cubic Bézier", with the matrix of errata C1; curves of any degree are
//! [`Bezier`](crate::Bezier).

use super::{Generator, in_threes, through};
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
        let fours = in_threes("a chain of cubic Bézier curves", points, self.closed)?;
        let spans = fours.map(Cubic::from_bezier);
        through(points, spans.collect(), None, self.closed)
    }
}
