//! Catmull–Rom curves: through all points, with tangents from their neighbours.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Blended parabolas/Catmull–Rom"; E. Catmull and R. Rom, *A class of
//! local interpolating splines*, 1974; P. Barry and R. Goldman, *A recursive evaluation algorithm for a class of
//! Catmull–Rom splines*, SIGGRAPH 1988 (unequal knots); C. Yuksel, S. Schaefer and J. Keyser, *Parameterization and
//! applications of Catmull–Rom curves*, CAD 43, 2011 (centripetal knots have no cusps or loops within a span). Errata C20:
//! where neighbours coincide the span is constant and the tangent null.
//!
//! With knots `k`, `h_i = k_{i+1} − k_i`, the velocity at `P_i` by the knots is
//! `(P_i − P_{i−1})/h_{i−1} − (P_{i+1} − P_{i−1})/(h_{i−1} + h_i) + (P_{i+1} − P_i)/h_i`.

use super::{Generator, through};
use crate::error::enough;
use crate::{Cubic, CurveError, PiecewiseCubic};
use anamorph_core::{Space, math};

/// How far apart the knots of neighbouring points lie.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Spacing {
    /// Equally far: the classic curve. Loops where points are unevenly spaced.
    Uniform,
    /// The square root of the distance: no cusps or loops within a span.
    #[default]
    Centripetal,
    /// The distance.
    Chordal,
    /// The distance to this power, in `[0, 1]`.
    Power(f64),
}

impl Spacing {
    pub(super) fn exponent(self) -> f64 {
        match self {
            Self::Uniform => 0.0,
            Self::Centripetal => 0.5,
            Self::Chordal => 1.0,
            Self::Power(power) => power,
        }
    }
}

/// What stands for the neighbour that the ends of an open curve lack.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Ends {
    /// The neighbour reflected at the end: the tangent is the first chord.
    #[default]
    Reflected,
    /// The end span is the parabola through the last three points, by their knots.
    Parabola,
    /// The curve runs only between the second and the last but one point, as in the original paper.
    Omitted,
}

/// A curve through all points, continuous to the first derivative by its knots, local: a point moves four spans.
#[derive(Clone, Debug, PartialEq)]
pub struct CatmullRom<S> {
    /// Points to pass: at least two (omitted ends: four; closed: three).
    pub points: Vec<S>,
    /// Knots.
    pub spacing: Spacing,
    /// Ends of an open curve.
    pub ends: Ends,
    /// Whether the curve returns to its first point.
    pub closed: bool,
}

impl<S: Space> CatmullRom<S> {
    /// An open curve with centripetal knots and reflected ends.
    #[must_use]
    pub fn new(points: Vec<S>) -> Self {
        Self {
            points,
            spacing: Spacing::default(),
            ends: Ends::default(),
            closed: false,
        }
    }

    /// The same with other knots.
    #[must_use]
    pub fn spaced(self, spacing: Spacing) -> Self {
        Self { spacing, ..self }
    }

    /// The same, closed.
    #[must_use]
    pub fn closed(self) -> Self {
        Self {
            closed: true,
            ..self
        }
    }

    /// The knots of the points from the first (0); a closed curve has one more, for its return to the first point.
    /// Coincident points have equal knots unless the spacing is uniform.
    ///
    /// # Errors
    ///
    /// As [`Generator::curve`].
    pub fn knots(&self) -> Result<Vec<f64>, CurveError> {
        let widths = self.widths()?;
        let mut knots = vec![0.0];
        let mut sum = 0.0;
        for width in widths {
            sum += width;
            knots.push(sum);
        }
        Ok(knots)
    }

    /// Distances between knots, one for each span between neighbouring points.
    fn widths(&self) -> Result<Vec<f64>, CurveError> {
        let needed = match (self.closed, self.ends) {
            (true, _) => 3,
            (false, Ends::Omitted) => 4,
            (false, _) => 2,
        };
        enough("a Catmull-Rom curve", needed, &self.points)?;
        let exponent = self.spacing.exponent();
        if !(0.0..=1.0).contains(&exponent) {
            return Err(CurveError::OutOfRange {
                name: "the power of the spacing",
                value: exponent,
                range: "in [0, 1]",
            });
        }
        let n = self.points.len();
        let chords = (0..n - usize::from(!self.closed))
            .map(|i| self.points[i].distance(self.points[(i + 1) % n]));
        Ok(chords
            .map(|d| match exponent {
                0.0 => 1.0,
                0.5 => d.sqrt(),
                1.0 => d,
                e => math::pow(d, e),
            })
            .collect())
    }
}

/// Velocity at `b` by the knots of the points before it and behind it; null where two of them coincide.
fn velocity<S: Space>(a: S, b: S, c: S, before: f64, behind: f64) -> S {
    if !(before > 0.0 && behind > 0.0) {
        return S::ZERO;
    }
    // The form of the module's formula without cancellation: chord velocities weighted by the other span's width.
    let whole = before + behind;
    (b - a) / before * (behind / whole) + (c - b) / behind * (before / whole)
}

impl<S: Space> Generator<S> for CatmullRom<S> {
    fn curve(&self) -> Result<PiecewiseCubic<S>, CurveError> {
        let widths = self.widths()?;
        let points = &self.points;
        let n = points.len();
        let velocity_at = |i: usize| -> S {
            let (last, spans) = (n - 1, widths.len());
            let (before, behind) = ((i + n - 1) % n, (i + 1) % n);
            if self.closed || (i > 0 && i < last) {
                let h = widths[(i + spans - 1) % spans];
                return velocity(
                    points[before],
                    points[i],
                    points[behind],
                    h,
                    widths[i % spans],
                );
            }
            // An end: `inner` is the neighbour, `far` the one behind it.
            let (inner, far, h, next, sign) = if i == 0 {
                (1, 2, widths[0], widths.get(1), 1.0)
            } else {
                let next = spans.checked_sub(2).map(|s| &widths[s]);
                (
                    last - 1,
                    last.saturating_sub(2),
                    widths[spans - 1],
                    next,
                    -1.0,
                )
            };
            if h <= 0.0 {
                return S::ZERO;
            }
            let chord = (points[inner] - points[i]) / h * sign;
            match (self.ends, next) {
                (Ends::Parabola, Some(&next)) if next > 0.0 => {
                    let at_inner = (points[far] - points[inner]) / next * sign;
                    // Derivative at the end of the parabola through three points.
                    chord + (chord - at_inner) * (h / (h + next))
                }
                _ => chord,
            }
        };
        let skip = usize::from(!self.closed && self.ends == Ends::Omitted);
        let spans = (skip..widths.len() - skip).map(|i| {
            let j = (i + 1) % n;
            let h = widths[i];
            if h > 0.0 {
                Cubic::from_hermite(points[i], points[j], velocity_at(i) * h, velocity_at(j) * h)
            } else {
                Cubic([points[i], S::ZERO, S::ZERO, S::ZERO])
            }
        });
        through(&points[..n - skip], spans.collect(), None, self.closed)
    }
}
