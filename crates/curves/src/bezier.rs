//! Bézier curves of any degree, and chains of them.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Cubic Bézier" (errata C1); G. Farin, *Curves and Surfaces for CAGD*,
//! 5th ed., 2002, chapters 4–5: de Casteljau's algorithm, derivatives as differences, subdivision.

use crate::error::{enough, increasing};
use crate::{Cubic, CurveError};
use anamorph_core::{Curve, Differentiable, Jet, Space};

/// The largest degree: above, de Casteljau's algorithm and differences lose most digits.
pub const MAX_DEGREE: usize = 64;
/// Points kept without an allocation.
const FEW: usize = 16;

/// A Bézier curve over `[0, 1]`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Bezier<S> {
    points: Vec<S>,
}

#[cfg(feature = "serde")]
impl<'de, S: Space + serde::Deserialize<'de>> serde::Deserialize<'de> for Bezier<S> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(serde::Deserialize)]
        struct Data<S> {
            points: Vec<S>,
        }
        let data = Data::deserialize(deserializer)?;
        Self::new(data.points).map_err(serde::de::Error::custom)
    }
}

impl<S: Space> Bezier<S> {
    /// The curve with these control points: one more than the degree.
    ///
    /// # Errors
    ///
    /// Fewer than two points, more than [`MAX_DEGREE`] + 1, or one that is not finite.
    pub fn new(points: Vec<S>) -> Result<Self, CurveError> {
        enough("a Bézier curve", 2, &points)?;
        if points.len() > MAX_DEGREE + 1 {
            return Err(CurveError::WrongCount {
                what: "a Bézier curve",
                needed: "2 to 65",
                found: points.len(),
            });
        }
        Ok(Self { points })
    }

    /// A curve from points that are known to be good.
    pub(crate) fn of(points: Vec<S>) -> Self {
        debug_assert!(points.len() >= 2);
        Self { points }
    }

    /// Sets the last control point.
    pub(crate) fn end_at(&mut self, end: S) {
        if let Some(last) = self.points.last_mut() {
            *last = end;
        }
    }

    /// Its control points.
    #[must_use]
    pub fn points(&self) -> &[S] {
        &self.points
    }

    /// Its degree.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.points.len() - 1
    }

    /// The same curve with one more control point.
    ///
    /// # Errors
    ///
    /// A degree above [`MAX_DEGREE`].
    pub fn raised(&self) -> Result<Self, CurveError> {
        let n = self.points.len();
        let mut points = Vec::with_capacity(n + 1);
        points.push(self.points[0]);
        for i in 1..n {
            let share = i as f64 / n as f64;
            points.push(self.points[i - 1] * share + self.points[i] * (1.0 - share));
        }
        points.push(self.points[n - 1]);
        Self::new(points)
    }

    /// The control points of the derivative.
    #[must_use]
    pub fn differences(&self) -> Vec<S> {
        let degree = self.degree() as f64;
        let pairs = self.points.windows(2);
        pairs.map(|p| (p[1] - p[0]) * degree).collect()
    }

    /// The parts before and behind `t`, each over `[0, 1]`.
    #[must_use]
    pub fn split(&self, t: f64) -> (Self, Self) {
        let t = self.within(t);
        let n = self.points.len();
        let mut left = self.points.clone();
        let mut right = self.points.clone();
        for (level, first) in left.iter_mut().enumerate().skip(1) {
            for i in 0..n - level {
                right[i] = between(right[i], right[i + 1], t);
            }
            *first = right[0];
        }
        (Self { points: left }, Self { points: right })
    }

    /// The part between two parameters in `[0, 1]`, the first less than the second, over `[0, 1]`.
    ///
    /// # Errors
    ///
    /// Parameters that do not increase or lie outside.
    pub fn part(&self, start: f64, end: f64) -> Result<Self, CurveError> {
        increasing("parameter", &[start, end])?;
        for value in [start, end] {
            if !(0.0..=1.0).contains(&value) {
                return Err(CurveError::OutOfRange {
                    name: "a parameter",
                    value,
                    range: "in [0, 1]",
                });
            }
        }
        let (_, behind) = self.split(start);
        Ok(behind.split((end - start) / (1.0 - start)).0)
    }

    /// The curve run backwards.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self {
            points: self.points.iter().rev().copied().collect(),
        }
    }

    /// A parameter brought into the domain.
    pub(crate) fn within_unit(&self, t: f64) -> f64 {
        Curve::within(self, t)
    }

    /// The curve, of degree 3 at most, as a cubic.
    pub(crate) fn cubic(&self) -> Cubic<S> {
        let p = &self.points;
        match p.len() {
            2 => Cubic([p[0], p[1] - p[0], S::ZERO, S::ZERO]),
            3 => Cubic([
                p[0],
                (p[1] - p[0]) * 2.0,
                p[0] - p[1] + (p[2] - p[1]),
                S::ZERO,
            ]),
            _ => Cubic::from_bezier([p[0], p[1], p[2], p[3]]),
        }
    }
}

/// The point of `a b` at `t`; both ends exactly.
#[inline]
fn between<S: Space>(a: S, b: S, t: f64) -> S {
    if t == 1.0 { b } else { a * (1.0 - t) + b * t }
}

/// Reduces `points` to `keep` by de Casteljau's algorithm; the first `keep` of the result hold them.
fn reduce<S: Space>(points: &mut [S], keep: usize, t: f64) {
    let n = points.len();
    for level in 1..=n - keep {
        for i in 0..n - level {
            points[i] = between(points[i], points[i + 1], t);
        }
    }
}

/// Point and derivatives by de Casteljau's algorithm, stopped at the last four points.
fn jet_of<S: Space>(points: &mut [S], t: f64) -> Jet<S> {
    let n = points.len();
    let d = (n - 1) as f64;
    let keep = n.min(4);
    reduce(points, keep, t);
    let (p, keep) = (points, keep);
    let mut third = S::ZERO;
    let mut second = S::ZERO;
    if keep == 4 {
        third = (p[3] - p[2] * 3.0 + p[1] * 3.0 - p[0]) * (d * (d - 1.0) * (d - 2.0));
        reduce(&mut p[..4], 3, t);
    }
    if keep >= 3 {
        second = (p[2] - p[1] * 2.0 + p[0]) * (d * (d - 1.0));
        reduce(&mut p[..3], 2, t);
    }
    Jet {
        first: (p[1] - p[0]) * d,
        point: between(p[0], p[1], t),
        second,
        third,
    }
}

/// Runs `f` on a copy of the points.
fn on_a_copy<S: Space, T>(points: &[S], f: impl FnOnce(&mut [S]) -> T) -> T {
    if points.len() <= FEW {
        let mut few = [S::ZERO; FEW];
        few[..points.len()].copy_from_slice(points);
        f(&mut few[..points.len()])
    } else {
        f(&mut points.to_vec())
    }
}

impl<S: Space> Curve<S> for Bezier<S> {
    fn domain(&self) -> (f64, f64) {
        (0.0, 1.0)
    }

    fn point(&self, parameter: f64) -> S {
        let t = self.within(parameter);
        on_a_copy(&self.points, |p| {
            reduce(p, 1, t);
            p[0]
        })
    }
}

impl<S: Space> Differentiable<S> for Bezier<S> {
    fn jet(&self, parameter: f64) -> Jet<S> {
        let t = self.within(parameter);
        on_a_copy(&self.points, |p| jet_of(p, t))
    }

    fn breaks(&self) -> Vec<f64> {
        vec![0.0, 1.0]
    }
}

impl<S: Space> From<&Cubic<S>> for Bezier<S> {
    fn from(cubic: &Cubic<S>) -> Self {
        Self::of(cubic.to_bezier().to_vec())
    }
}

/// Bézier curves of any degrees, one after the other: what B-splines of any degree become.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PiecewiseBezier<S> {
    pieces: Vec<Bezier<S>>,
    breaks: Vec<f64>,
    closed: bool,
}

#[cfg(feature = "serde")]
impl<'de, S: Space + serde::Deserialize<'de>> serde::Deserialize<'de> for PiecewiseBezier<S> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(serde::Deserialize)]
        #[serde(bound = "S: Space + serde::Deserialize<'de>")]
        struct Data<S> {
            pieces: Vec<Bezier<S>>,
            breaks: Vec<f64>,
            closed: bool,
        }
        let data = Data::deserialize(deserializer)?;
        Self::new(data.pieces, data.breaks, data.closed).map_err(serde::de::Error::custom)
    }
}

impl<S: Space> PiecewiseBezier<S> {
    /// The curve of these pieces between `breaks`, one more than there are pieces.
    ///
    /// # Errors
    ///
    /// No pieces, or breaks of the wrong number, not finite or not increasing.
    pub fn new(pieces: Vec<Bezier<S>>, breaks: Vec<f64>, closed: bool) -> Result<Self, CurveError> {
        if pieces.is_empty() {
            return Err(CurveError::TooFewPoints {
                what: "a curve of pieces",
                needed: 1,
                found: 0,
            });
        }
        crate::piecewise::check_breaks(&breaks, pieces.len())?;
        Ok(Self {
            pieces,
            breaks,
            closed,
        })
    }

    /// The pieces, in order.
    #[must_use]
    pub fn pieces(&self) -> &[Bezier<S>] {
        &self.pieces
    }

    /// The breaks, where they are.
    pub(crate) fn breaks_in_place(&self) -> &[f64] {
        &self.breaks
    }

    fn locate(&self, parameter: f64) -> (usize, f64, f64) {
        let last = self.pieces.len() - 1;
        let index = self.breaks[1..=last].partition_point(|b| *b <= parameter);
        let width = self.breaks[index + 1] - self.breaks[index];
        let x = if parameter == self.breaks[index + 1] {
            1.0
        } else {
            (parameter - self.breaks[index]) / width
        };
        (index, x, width)
    }
}

impl<S: Space> Curve<S> for PiecewiseBezier<S> {
    fn domain(&self) -> (f64, f64) {
        (self.breaks[0], self.breaks[self.pieces.len()])
    }

    fn point(&self, parameter: f64) -> S {
        let (index, x, _) = self.locate(self.within(parameter));
        self.pieces[index].point(x)
    }

    fn is_closed(&self) -> bool {
        self.closed
    }
}

impl<S: Space> Differentiable<S> for PiecewiseBezier<S> {
    fn jet(&self, parameter: f64) -> Jet<S> {
        let (index, x, width) = self.locate(self.within(parameter));
        scaled(self.pieces[index].jet(x), width)
    }

    fn breaks(&self) -> Vec<f64> {
        self.breaks.clone()
    }
}

/// A jet by the local parameter of a piece as one by the parameter of the curve.
#[inline]
pub(crate) fn scaled<S: Space>(mut jet: Jet<S>, width: f64) -> Jet<S> {
    let per = 1.0 / width;
    jet.first = jet.first * per;
    jet.second = jet.second * per * per;
    jet.third = jet.third * per * per * per;
    jet
}

/// A curve of polynomial pieces, which can be asked for them: nearest points, bounds and lengths rest on that.
pub trait Pieces<S: Space>: Differentiable<S> {
    /// The Bézier curves it consists of, each with the parameters between which it runs.
    fn bezier_pieces(&self) -> Vec<(f64, f64, Bezier<S>)>;
}

impl<S: Space> Pieces<S> for Bezier<S> {
    fn bezier_pieces(&self) -> Vec<(f64, f64, Bezier<S>)> {
        vec![(0.0, 1.0, self.clone())]
    }
}

impl<S: Space> Pieces<S> for PiecewiseBezier<S> {
    fn bezier_pieces(&self) -> Vec<(f64, f64, Bezier<S>)> {
        let pairs = self.breaks.windows(2);
        let pieces = pairs.zip(&self.pieces);
        pieces.map(|(w, p)| (w[0], w[1], p.clone())).collect()
    }
}
