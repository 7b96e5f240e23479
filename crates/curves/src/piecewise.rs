//! The one curve that every piecewise-cubic family becomes.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Curve formulations": `P(u) = U·M·B`. All families with cubic pieces are
//! generators of this type, so that all evaluate at equal cost and share length, nearest points, bounds and splitting.
//! A piece is a polynomial of the local parameter `x = (u − b_i)/(b_{i+1} − b_i)`, which keeps pieces of very different
//! lengths equally exact. At a break the piece behind it is evaluated at `x = 0`, where the polynomial is its first
//! coefficient: keys are hit exactly, and the last point is kept beside the pieces for the same reason.

use crate::bezier::{Pieces, scaled};
use crate::error::{finite, increasing};
use crate::{Bezier, CurveError};
use anamorph_core::{Curve, Differentiable, Jet, Space};

/// A polynomial of degree 3: `c₀ + c₁x + c₂x² + c₃x³`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Cubic<S>(pub [S; 4]);

impl<S: Space> Cubic<S> {
    /// The cubic with these Bézier control points (errata C1).
    #[must_use]
    pub fn from_bezier([a, b, c, d]: [S; 4]) -> Self {
        Self([
            a,
            (b - a) * 3.0,
            (a - b + (c - b)) * 3.0,
            (d - a) - (c - b) * 3.0,
        ])
    }

    /// The cubic from `a` to `b` with these derivatives at its ends.
    #[must_use]
    pub fn from_hermite(a: S, b: S, at_a: S, at_b: S) -> Self {
        let chord = b - a;
        Self([
            a,
            at_a,
            chord * 3.0 - at_a * 2.0 - at_b,
            at_a + at_b - chord * 2.0,
        ])
    }

    /// Its Bézier control points.
    #[must_use]
    pub fn to_bezier(&self) -> [S; 4] {
        let [a, b, c, d] = self.0;
        let first = a + b / 3.0;
        [a, first, first + (b + c) / 3.0, a + b + (c + d)]
    }

    /// The point at `x`.
    #[must_use]
    #[inline]
    pub fn point(&self, x: f64) -> S {
        let [a, b, c, d] = self.0;
        a + (b + (c + d * x) * x) * x
    }

    /// First derivative by `x`.
    #[must_use]
    #[inline]
    pub fn velocity(&self, x: f64) -> S {
        let [_, b, c, d] = self.0;
        b + (c * 2.0 + d * (3.0 * x)) * x
    }

    /// Point and derivatives by `x`.
    #[must_use]
    #[inline]
    pub fn jet(&self, x: f64) -> Jet<S> {
        let [_, _, c, d] = self.0;
        Jet {
            point: self.point(x),
            first: self.velocity(x),
            second: (c + d * (3.0 * x)) * 2.0,
            third: d * 6.0,
        }
    }

    /// The part from `x = start` to `x = end`, as a cubic over `[0, 1]`.
    #[must_use]
    pub fn part(&self, start: f64, end: f64) -> Self {
        let w = end - start;
        let jet = self.jet(start);
        Self([
            jet.point,
            jet.first * w,
            jet.second * (0.5 * w * w),
            jet.third * (w * w * w / 6.0),
        ])
    }
}

/// Refuses breaks of the wrong number, out of order, or so near or far that derivatives, which are divided by the third
/// power of a width, would not be numbers.
pub(crate) fn check_breaks(breaks: &[f64], pieces: usize) -> Result<(), CurveError> {
    increasing("break", breaks)?;
    if breaks.len() != pieces + 1 {
        return Err(CurveError::Mismatch {
            what: "breaks",
            found: breaks.len(),
            needed: pieces + 1,
            of: "pieces",
            expected: pieces,
        });
    }
    let widths = breaks.windows(2).map(|w| w[1] - w[0]);
    match widths.clone().find(|w| !(1e-80..=1e80).contains(w)) {
        Some(value) => Err(CurveError::OutOfRange {
            name: "the distance between breaks",
            value,
            range: "between 1e-80 and 1e80",
        }),
        None => Ok(()),
    }
}

/// Where pieces meet.
#[derive(Clone, Debug, PartialEq)]
enum Breaks {
    /// `0, 1, 2, …`: the piece is the whole part of the parameter.
    Whole,
    /// Any increasing numbers, one more than pieces.
    Any(Vec<f64>),
}

/// A curve of cubic pieces, made by the families of [`families`](crate::families) or from pieces.
///
/// The parameter runs over the breaks: `0, 1, 2, …` where a family has no times of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseCubic<S> {
    pieces: Vec<Cubic<S>>,
    breaks: Breaks,
    end: S,
    closed: bool,
}

impl<S: Space> PiecewiseCubic<S> {
    /// The curve of these pieces over `0, 1, 2, …`.
    ///
    /// # Errors
    ///
    /// No pieces, or coefficients that are not finite (a coordinate overflowed).
    pub fn new(pieces: Vec<Cubic<S>>, closed: bool) -> Result<Self, CurveError> {
        Self::build(pieces, Breaks::Whole, closed)
    }

    /// The curve of these pieces between `breaks` (increasing; one more than there are pieces).
    ///
    /// # Errors
    ///
    /// As [`Self::new`], and breaks of the wrong number or order.
    pub fn with_breaks(
        pieces: Vec<Cubic<S>>,
        breaks: Vec<f64>,
        closed: bool,
    ) -> Result<Self, CurveError> {
        check_breaks(&breaks, pieces.len())?;
        Self::build(pieces, Breaks::Any(breaks), closed)
    }

    fn build(pieces: Vec<Cubic<S>>, breaks: Breaks, closed: bool) -> Result<Self, CurveError> {
        let Some(last) = pieces.last() else {
            return Err(CurveError::TooFewPoints {
                what: "a curve of pieces",
                needed: 1,
                found: 0,
            });
        };
        for (index, piece) in pieces.iter().enumerate() {
            if finite("coefficient", &piece.0).is_err() {
                return Err(CurveError::NotFinite {
                    what: "piece",
                    index,
                });
            }
        }
        let end = if closed {
            pieces[0].0[0]
        } else {
            last.point(1.0)
        };
        Ok(Self {
            pieces,
            breaks,
            end,
            closed,
        })
    }

    /// Sets the last point to the bits it was given with: sums of coefficients round.
    pub(crate) fn ending_at(mut self, end: S) -> Self {
        self.end = end;
        self
    }

    /// The pieces, in order.
    #[must_use]
    pub fn pieces(&self) -> &[Cubic<S>] {
        &self.pieces
    }

    /// The parameter at which piece `index` starts; with the number of pieces, that of the end.
    #[must_use]
    #[inline]
    pub fn break_at(&self, index: usize) -> f64 {
        match &self.breaks {
            Breaks::Whole => index as f64,
            Breaks::Any(breaks) => breaks[index.min(breaks.len() - 1)],
        }
    }

    /// The piece of a parameter within the domain, the local parameter in it, and the piece's width.
    #[inline]
    pub(crate) fn locate(&self, parameter: f64) -> (usize, f64, f64) {
        let last = self.pieces.len() - 1;
        match &self.breaks {
            Breaks::Whole => {
                // Within the domain, so neither negative nor too large.
                let index = (parameter as usize).min(last);
                (index, parameter - index as f64, 1.0)
            }
            Breaks::Any(breaks) => {
                let index = breaks[1..=last].partition_point(|b| *b <= parameter);
                let width = breaks[index + 1] - breaks[index];
                (index, (parameter - breaks[index]) / width, width)
            }
        }
    }

    /// Bézier control points of each piece: the next starts where one ends.
    #[must_use]
    pub fn to_bezier(&self) -> Vec<[S; 4]> {
        let mut points: Vec<[S; 4]> = self.pieces.iter().map(Cubic::to_bezier).collect();
        // Shared points are those that are evaluated: starts of pieces, and the end.
        for (i, point) in points.iter_mut().enumerate() {
            point[3] = self.pieces.get(i + 1).map_or(self.end, |next| next.0[0]);
        }
        points
    }

    /// The part of an open curve between two parameters, with those as its domain; for a closed curve `end` may lie behind
    /// the end of its domain, and the part runs over the seam.
    ///
    /// # Errors
    ///
    /// An empty or reversed range, or one of an open curve outside its domain.
    pub fn part(&self, start: f64, end: f64) -> Result<Self, CurveError> {
        increasing("parameter", &[start, end])?;
        let (first, last) = self.domain();
        let period = last - first;
        let range = "within the domain of the curve";
        if start < first || start > last {
            return Err(CurveError::OutOfRange {
                name: "start",
                value: start,
                range,
            });
        }
        if end > last + if self.closed { period } else { 0.0 } {
            return Err(CurveError::OutOfRange {
                name: "end",
                value: end,
                range,
            });
        }
        let (mut pieces, mut breaks) = (Vec::new(), vec![start]);
        let rounds: &[f64] = if end > last { &[0.0, 1.0] } else { &[0.0] };
        for round in rounds {
            for (i, piece) in self.pieces.iter().enumerate() {
                let (a, b) = (
                    self.break_at(i) + round * period,
                    self.break_at(i + 1) + round * period,
                );
                let (from, to) = (a.max(start), b.min(end));
                if from < to {
                    let whole = from == a && to == b;
                    let w = b - a;
                    pieces.push(if whole {
                        *piece
                    } else {
                        piece.part((from - a) / w, (to - a) / w)
                    });
                    breaks.push(to);
                }
            }
        }
        let at_end = self.point(if end > last { end - period } else { end });
        Ok(Self::with_breaks(pieces, breaks, false)?.ending_at(at_end))
    }

    /// The curve run backwards over the same domain.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let (first, last) = self.domain();
        let beziers = self.to_bezier();
        let pieces = beziers
            .iter()
            .rev()
            .map(|[a, b, c, d]| Cubic::from_bezier([*d, *c, *b, *a]));
        let breaks = match &self.breaks {
            Breaks::Whole => Breaks::Whole,
            Breaks::Any(breaks) => {
                Breaks::Any(breaks.iter().rev().map(|b| first + (last - b)).collect())
            }
        };
        Self {
            pieces: pieces.collect(),
            breaks,
            end: self.pieces[0].0[0],
            closed: self.closed,
        }
    }

    /// The two parts before and behind a parameter inside the domain.
    ///
    /// # Errors
    ///
    /// A parameter that is not inside.
    pub fn split(&self, at: f64) -> Result<(Self, Self), CurveError> {
        let (first, last) = self.domain();
        if !(at > first && at < last) {
            let range = "inside the domain of the curve, not at its ends";
            return Err(CurveError::OutOfRange {
                name: "split",
                value: at,
                range,
            });
        }
        Ok((self.part(first, at)?, self.part(at, last)?))
    }
}

impl<S: Space> Curve<S> for PiecewiseCubic<S> {
    fn domain(&self) -> (f64, f64) {
        (self.break_at(0), self.break_at(self.pieces.len()))
    }

    fn point(&self, parameter: f64) -> S {
        let u = self.within(parameter);
        let (_, last) = self.domain();
        if u == last {
            return self.end;
        }
        let (index, x, _) = self.locate(u);
        self.pieces[index].point(x)
    }

    fn is_closed(&self) -> bool {
        self.closed
    }
}

impl<S: Space> Differentiable<S> for PiecewiseCubic<S> {
    fn jet(&self, parameter: f64) -> Jet<S> {
        let u = self.within(parameter);
        let (index, x, width) = self.locate(u);
        let mut jet = self.pieces[index].jet(x);
        if u == self.domain().1 {
            jet.point = self.end;
        }
        scaled(jet, width)
    }

    fn velocity(&self, parameter: f64) -> S {
        let (index, x, width) = self.locate(self.within(parameter));
        self.pieces[index].velocity(x) / width
    }

    fn breaks(&self) -> Vec<f64> {
        (0..=self.pieces.len()).map(|i| self.break_at(i)).collect()
    }
}

impl<S: Space> Pieces<S> for PiecewiseCubic<S> {
    fn bezier_pieces(&self) -> Vec<(f64, f64, Bezier<S>)> {
        let points = self.to_bezier().into_iter().enumerate();
        points
            .map(|(i, p)| {
                let piece = Bezier::of(p.to_vec());
                (self.break_at(i), self.break_at(i + 1), piece)
            })
            .collect()
    }
}

/// What is written of a curve; reading goes through the constructors, which refuse what is no curve.
#[cfg(feature = "serde")]
mod data {
    use super::{Breaks, Cubic, PiecewiseCubic, Space};

    #[derive(serde::Serialize, serde::Deserialize)]
    struct Data<S> {
        pieces: Vec<Cubic<S>>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        breaks: Option<Vec<f64>>,
        end: S,
        closed: bool,
    }

    impl<S: Space + serde::Serialize> serde::Serialize for PiecewiseCubic<S> {
        fn serialize<T: serde::Serializer>(&self, serializer: T) -> Result<T::Ok, T::Error> {
            let breaks = match &self.breaks {
                Breaks::Whole => None,
                Breaks::Any(breaks) => Some(breaks.clone()),
            };
            let data = Data {
                pieces: self.pieces.clone(),
                breaks,
                end: self.end,
                closed: self.closed,
            };
            data.serialize(serializer)
        }
    }

    impl<'de, S: Space + serde::Deserialize<'de>> serde::Deserialize<'de> for PiecewiseCubic<S> {
        fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            let data = Data::deserialize(deserializer)?;
            let curve = match data.breaks {
                Some(breaks) => Self::with_breaks(data.pieces, breaks, data.closed),
                None => Self::new(data.pieces, data.closed),
            };
            match curve {
                Ok(curve) if data.end.is_finite() => Ok(curve.ending_at(data.end)),
                Ok(_) => Err(serde::de::Error::custom(
                    "the end of the curve is not finite",
                )),
                Err(error) => Err(serde::de::Error::custom(error)),
            }
        }
    }
}
