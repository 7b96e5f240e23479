//! B-splines of any degree over any knots.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "B-spline"; G. Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002,
//! chapter 8. The curve runs over `[t_d, t_n]`, both ends included (errata C17). Each span becomes a Bézier curve by
//! blossoming: its control points are the blossom at `d − i` times the left and `i` times the right end (de Boor's
//! algorithm with different arguments at each level). Spans between equal knots vanish.

use super::Generator;
use crate::error::enough;
use crate::{Bezier, Cubic, CurveError, PiecewiseBezier, PiecewiseCubic};
use anamorph_core::Space;

/// Where the knots lie.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Knots {
    /// At whole numbers, spread so that the curve runs over `0, 1, 2, …`. Its ends are no control points.
    #[default]
    Uniform,
    /// The same, but the ends repeated degree + 1 times: the curve runs from the first to the last control point.
    Clamped,
    /// These: as many as control points and degree and one more, not decreasing, none repeated more than degree + 1 times.
    Given(Vec<f64>),
}

/// A B-spline: smooth, near its control points, inside their hull. A control point moves degree + 1 spans.
#[derive(Clone, Debug, PartialEq)]
pub struct BSpline<S> {
    /// Control points: more than the degree.
    pub points: Vec<S>,
    /// The degree, 1 to 16.
    pub degree: usize,
    /// Knots. A closed curve has uniform ones.
    pub knots: Knots,
    /// Whether the control points run around.
    pub closed: bool,
}

/// The largest degree.
const MAX_DEGREE: usize = 16;

impl<S: Space> BSpline<S> {
    /// An open cubic B-spline with uniform knots.
    #[must_use]
    pub fn new(points: Vec<S>) -> Self {
        Self {
            points,
            degree: 3,
            knots: Knots::Uniform,
            closed: false,
        }
    }

    /// The same with other knots.
    #[must_use]
    pub fn with_knots(self, knots: Knots) -> Self {
        Self { knots, ..self }
    }

    /// The same, closed.
    #[must_use]
    pub fn closed(self) -> Self {
        Self {
            closed: true,
            ..self
        }
    }

    /// All knots, checked.
    fn all_knots(&self, points: usize) -> Result<Vec<f64>, CurveError> {
        let d = self.degree;
        let needed = points + d + 1;
        let knots = match &self.knots {
            Knots::Given(knots) => knots.clone(),
            Knots::Uniform => (0..needed).map(|i| i as f64 - d as f64).collect(),
            Knots::Clamped => {
                let spans = points - d;
                (0..needed)
                    .map(|i| i.saturating_sub(d).min(spans) as f64)
                    .collect()
            }
        };
        if knots.len() != needed {
            return Err(CurveError::Mismatch {
                what: "knots",
                found: knots.len(),
                needed,
                of: "control points and degree + 1",
                expected: points,
            });
        }
        if let Some(index) = knots.iter().position(|k| !k.is_finite()) {
            return Err(CurveError::NotFinite {
                what: "knot",
                index,
            });
        }
        if let Some(i) = knots.windows(2).position(|w| w[1] < w[0]) {
            return Err(CurveError::Decreasing {
                what: "knot",
                index: i + 1,
                value: knots[i + 1],
                before: knots[i],
            });
        }
        if let Some(i) = knots.windows(d + 2).position(|w| w[d + 1] == w[0]) {
            return Err(CurveError::OutOfRange {
                name: "how often a knot is repeated",
                value: knots[i..].iter().filter(|k| **k == knots[i]).count() as f64,
                range: "at most the degree + 1",
            });
        }
        Ok(knots)
    }

    /// The spans as Bézier curves, with their breaks.
    fn spans(&self) -> Result<(Vec<Bezier<S>>, Vec<f64>), CurveError> {
        let d = self.degree;
        if !(1..=MAX_DEGREE).contains(&d) {
            return Err(CurveError::OutOfRange {
                name: "the degree",
                value: d as f64,
                range: "1 to 16",
            });
        }
        enough(
            "a B-spline",
            if self.closed { 3 } else { d + 1 },
            &self.points,
        )?;
        let mut points = self.points.clone();
        if self.closed {
            if self.knots != Knots::Uniform {
                return Err(CurveError::NotRead {
                    family: "closed B-spline",
                    what: "knots".to_owned(),
                });
            }
            // The last spans reach around to the first control points (errata C17).
            let n = points.len();
            points.extend((0..d).map(|i| self.points[i % n]));
        }
        let knots = self.all_knots(points.len())?;
        let (mut spans, mut breaks) = (Vec::new(), Vec::new());
        for k in d..points.len() {
            let (left, right) = (knots[k], knots[k + 1]);
            if left == right {
                continue;
            }
            if breaks.is_empty() {
                breaks.push(left);
            }
            let bezier = (0..=d).map(|i| blossom(&points[k - d..=k], &knots, k, d, left, right, i));
            spans.push(Bezier::of(bezier.collect()));
            breaks.push(right);
        }
        if spans.is_empty() {
            return Err(CurveError::NoLength);
        }
        // Neighbours are computed apart: where they meet, both get the point of the later.
        for i in 1..spans.len() {
            let shared = spans[i].points()[0];
            // A knot repeated degree + 1 times tears the curve.
            let from = knots.partition_point(|t| *t < breaks[i]);
            if knots[from..]
                .iter()
                .take_while(|t| **t == breaks[i])
                .count()
                <= d
            {
                spans[i - 1].end_at(shared);
            }
        }
        if self.closed {
            let first = spans[0].points()[0];
            if let Some(last) = spans.last_mut() {
                last.end_at(first);
            }
        }
        Ok((spans, breaks))
    }

    /// The curve, of any degree.
    ///
    /// # Errors
    ///
    /// A degree, knots or number of points that make none.
    pub fn pieces(&self) -> Result<PiecewiseBezier<S>, CurveError> {
        let (spans, breaks) = self.spans()?;
        PiecewiseBezier::new(spans, breaks, self.closed)
    }
}

/// The blossom of the span `[left, right]` (number `k`, control points `points`) at `d − i` times `left`, `i` times `right`.
fn blossom<S: Space>(
    points: &[S],
    knots: &[f64],
    k: usize,
    d: usize,
    left: f64,
    right: f64,
    i: usize,
) -> S {
    let mut p = points.to_vec();
    for level in 1..=d {
        let u = if level <= i { right } else { left };
        for j in 0..=d - level {
            // Control point j of this level lies between knots k − d + level + j and k + 1 + j.
            let (a, b) = (knots[k - d + level + j], knots[k + 1 + j]);
            let share = (u - a) / (b - a);
            p[j] = p[j] * (1.0 - share) + p[j + 1] * share;
        }
    }
    p[0]
}

impl<S: Space> Generator<S> for BSpline<S> {
    /// The curve as cubic pieces; for degrees up to 3.
    fn curve(&self) -> Result<PiecewiseCubic<S>, CurveError> {
        if self.degree > 3 {
            return Err(CurveError::OutOfRange {
                name: "the degree of a curve of cubic pieces",
                value: self.degree as f64,
                range: "1 to 3; `pieces` makes curves of any degree",
            });
        }
        let (spans, breaks) = self.spans()?;
        let mut cubics = Vec::with_capacity(spans.len());
        let mut end = S::ZERO;
        for span in spans {
            let mut span = span;
            while span.degree() < 3 {
                span = span.raised()?;
            }
            let p = span.points();
            cubics.push(Cubic::from_bezier([p[0], p[1], p[2], p[3]]));
            end = p[3];
        }
        let whole = breaks.iter().enumerate().all(|(i, b)| *b == i as f64);
        let curve = if whole {
            PiecewiseCubic::new(cubics, self.closed)?
        } else {
            PiecewiseCubic::with_breaks(cubics, breaks, self.closed)?
        };
        Ok(curve.ending_at(end))
    }
}

/// A curve of cubic pieces as a B-spline: knots are repeated thrice where it is continuous only in position.
impl<S: Space> From<&PiecewiseCubic<S>> for BSpline<S> {
    fn from(curve: &PiecewiseCubic<S>) -> Self {
        let beziers = curve.to_bezier();
        let count = beziers.len();
        let mut knots = vec![curve.break_at(0); 4];
        let mut points = Vec::with_capacity(3 * count + 1);
        for (i, piece) in beziers.iter().enumerate() {
            points.extend_from_slice(&piece[..3]);
            let repeated = if i + 1 == count { 4 } else { 3 };
            knots.extend(core::iter::repeat_n(curve.break_at(i + 1), repeated));
        }
        points.extend(beziers.last().map(|piece| piece[3]));
        Self {
            points,
            degree: 3,
            knots: Knots::Given(knots),
            closed: false,
        }
    }
}
