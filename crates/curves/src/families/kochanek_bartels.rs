//! Tension, continuity and bias.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Tension–continuity–bias"; D. Kochanek and R. Bartels, *Interpolating
//! splines with local tension, continuity, and bias control*, SIGGRAPH 1984. With `d⁻`, `d⁺` the chords to the neighbours,
//! the tangents at a key are
//! `(1−t)(1−c)(1+b)/2·d⁻ + (1−t)(1+c)(1−b)/2·d⁺` as the curve arrives and
//! `(1−t)(1+c)(1+b)/2·d⁻ + (1−t)(1−c)(1−b)/2·d⁺` as it leaves. With unequal times each is multiplied by
//! `2h/(h⁻ + h⁺)`, `h` the width of the span it belongs to, so that with `c = 0` the velocity is continuous (their §4).
//! At an open end both chords are the only one.

use super::{Generator, check_times, through};
use crate::error::enough;
use crate::{Cubic, CurveError, PiecewiseCubic};
use anamorph_core::Space;

/// How a curve passes a key. All null: Catmull–Rom.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Shape {
    /// 1 is tight (the curve stops), 0 normal, −1 slack.
    pub tension: f64,
    /// 0 is smooth; towards −1 and 1 corners appear, inwards and outwards.
    pub continuity: f64,
    /// 0 is even; towards 1 the curve overshoots the key, towards −1 it turns before it.
    pub bias: f64,
}

/// A curve through all points, shaped at each.
#[derive(Clone, Debug, PartialEq)]
pub struct KochanekBartels<S> {
    /// Points to pass: at least two, closed three.
    pub points: Vec<S>,
    /// One shape for all points, or one for each.
    pub shapes: Vec<Shape>,
    /// When each point is passed, strictly increasing; a closed curve has one more. `None`: 0, 1, 2, ….
    pub times: Option<Vec<f64>>,
    /// Whether the curve returns to its first point.
    pub closed: bool,
}

impl<S: Space> KochanekBartels<S> {
    /// An open curve with one shape at all points and a unit of the parameter for each span.
    #[must_use]
    pub fn new(points: Vec<S>, shape: Shape) -> Self {
        Self {
            points,
            shapes: vec![shape],
            times: None,
            closed: false,
        }
    }
}

impl<S: Space> Generator<S> for KochanekBartels<S> {
    fn curve(&self) -> Result<PiecewiseCubic<S>, CurveError> {
        let points = &self.points;
        let n = points.len();
        let needed = if self.closed { 3 } else { 2 };
        enough("a tension-continuity-bias curve", needed, points)?;
        if let Some(times) = &self.times {
            check_times(times, n, self.closed)?;
        }
        if self.shapes.len() != 1 && self.shapes.len() != n {
            return Err(CurveError::Mismatch {
                what: "shapes",
                found: self.shapes.len(),
                needed: n,
                of: "points",
                expected: n,
            });
        }
        let numbers = |s: &Shape| [s.tension, s.continuity, s.bias];
        if let Some(index) = self
            .shapes
            .iter()
            .position(|s| numbers(s).iter().any(|v| !v.is_finite()))
        {
            return Err(CurveError::NotFinite {
                what: "shape",
                index,
            });
        }
        let width = |span: usize| self.times.as_ref().map_or(1.0, |t| t[span + 1] - t[span]);
        let count = n - usize::from(!self.closed);
        // Tangents at a key, by the local parameters of the spans before and behind it.
        let tangents = |i: usize| -> (S, S) {
            let shape = self.shapes[if self.shapes.len() == 1 { 0 } else { i }];
            let before = (self.closed || i > 0).then(|| {
                let span = (i + count - 1) % count;
                (points[i] - points[(i + n - 1) % n], width(span))
            });
            let behind = (self.closed || i + 1 < n)
                .then(|| (points[(i + 1) % n] - points[i], width(i % count)));
            let ((d0, h0), (d1, h1)) = match (before, behind) {
                (Some(a), Some(b)) => (a, b),
                (Some(a), None) => (a, a),
                (None, Some(b)) => (b, b),
                (None, None) => ((S::ZERO, 1.0), (S::ZERO, 1.0)),
            };
            let Shape {
                tension,
                continuity,
                bias,
            } = shape;
            let half = 0.5 * (1.0 - tension);
            let (early, late) = (half * (1.0 + bias), half * (1.0 - bias));
            let arriving = d0 * (early * (1.0 - continuity)) + d1 * (late * (1.0 + continuity));
            let leaving = d0 * (early * (1.0 + continuity)) + d1 * (late * (1.0 - continuity));
            let each = 2.0 / (h0 + h1);
            (arriving * (each * h0), leaving * (each * h1))
        };
        let spans = (0..count).map(|i| {
            let j = (i + 1) % n;
            Cubic::from_hermite(points[i], points[j], tangents(i).1, tangents(j).0)
        });
        through(points, spans.collect(), self.times.as_deref(), self.closed)
    }
}
