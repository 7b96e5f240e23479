//! Hermite curves: points, and the velocity at each.
//!
//! *Source*: G. Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002; *Interpolation Techniques*, chapter 2, "Hermite": the cubic of each span has given points and derivatives at
//! its ends. With times, velocities are per unit of time; without, per span.

use super::{Generator, check_times, through};
use crate::error::{enough, finite};
use crate::{Cubic, CurveError, PiecewiseCubic};
use anamorph_core::Space;

/// A curve through `points` with `velocities`. Continuous to the first derivative.
#[derive(Clone, Debug, PartialEq)]
pub struct Hermite<S> {
    /// Points to pass, at least two (one of a closed curve is enough to make a loop).
    pub points: Vec<S>,
    /// One velocity for each point.
    pub velocities: Vec<S>,
    /// When each point is passed, strictly increasing; a closed curve has one more, for the return to the first. `None`:
    /// 0, 1, 2, ….
    pub times: Option<Vec<f64>>,
    /// Whether the curve returns to its first point.
    pub closed: bool,
}

impl<S: Space> Hermite<S> {
    /// An open curve with a unit of the parameter for each span.
    #[must_use]
    pub fn new(points: Vec<S>, velocities: Vec<S>) -> Self {
        Self {
            points,
            velocities,
            times: None,
            closed: false,
        }
    }
}

impl<S: Space> Generator<S> for Hermite<S> {
    fn curve(&self) -> Result<PiecewiseCubic<S>, CurveError> {
        let (points, velocities) = (&self.points, &self.velocities);
        enough("a Hermite curve", if self.closed { 1 } else { 2 }, points)?;
        if velocities.len() != points.len() {
            return Err(CurveError::Mismatch {
                what: "velocities",
                found: velocities.len(),
                needed: points.len(),
                of: "points",
                expected: points.len(),
            });
        }
        finite("velocity", velocities)?;
        let n = points.len();
        if let Some(times) = &self.times {
            check_times(times, n, self.closed)?;
        }
        let spans = (0..n - usize::from(!self.closed)).map(|i| {
            let j = (i + 1) % n;
            let width = self.times.as_ref().map_or(1.0, |t| t[i + 1] - t[i]);
            Cubic::from_hermite(
                points[i],
                points[j],
                velocities[i] * width,
                velocities[j] * width,
            )
        });
        through(points, spans.collect(), self.times.as_deref(), self.closed)
    }
}
