//! Prepared tables of arc length: made once, asked often.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Build table of approximate lengths"; errata C13 (the tolerance is on
//! length). Where the slides interpolate linearly between samples, each interval here holds two polynomials of degree 5,
//! `s(u)` and `u(s)`, with the position, speed and change of speed of the curve at both ends (quintic Hermite
//! interpolation). Both are compared with quadrature at three places inside; an interval that errs by more than a quarter of the accuracy
//! is halved. At a cusp the inverse has no derivative: there intervals shrink geometrically until they are shorter than the
//! accuracy itself.

use super::ArcLength;
use crate::CurveError;
use anamorph_core::Space;

/// How often a span is halved at most; 2⁻⁵⁰ of a span is at the rounding of its ends.
const DEPTH: u32 = 50;
/// The most intervals of a table: bounds memory whatever accuracy is asked for.
const MOST: usize = 1 << 20;

/// The most work for a table, in lengths of cubics measured ([`ArcLength::effort`]): some seconds.
const EFFORT: usize = 1 << 21;
/// Lengths of curves from which squares of speeds stay within the range of numbers.
const LENGTHS: core::ops::RangeInclusive<f64> = 1e-150..=1e150;

/// An interval of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Interval {
    u: f64,
    s: f64,
    u_width: f64,
    s_width: f64,
    /// Coefficients of `(u − u₀)/u_width` by `(s − s₀)/s_width`.
    inverse: [f64; 5],
    /// Coefficients of `(s − s₀)/s_width` by `(u − u₀)/u_width`.
    forward: [f64; 5],
}

/// The value at `x` of a polynomial without constant term.
#[inline(always)]
pub(super) fn polynomial([a, b, c, d, e]: &[f64; 5], x: f64) -> f64 {
    x * (a + x * (b + x * (c + x * (d + x * e))))
}

/// The polynomial of degree 5 from 0 to 1 with first and second derivatives `v`, `a` at its ends.
#[inline(always)]
pub(super) fn quintic(v0: f64, a0: f64, v1: f64, a1: f64) -> [f64; 5] {
    let rest = 1.0 - v0 - 0.5 * a0;
    let slope = v1 - v0 - a0;
    let bend = a1 - a0;
    [
        v0,
        0.5 * a0,
        10.0 * rest - 4.0 * slope + 0.5 * bend,
        -15.0 * rest + 7.0 * slope - bend,
        6.0 * rest - 3.0 * slope + 0.5 * bend,
    ]
}

/// A place on the curve while the table is made.
#[derive(Clone, Copy)]
struct Knot {
    u: f64,
    s: f64,
    /// Speed and its derivative by the parameter.
    speed: f64,
    change: f64,
}

/// Lengths and parameters of a curve, both ways, each to the accuracy asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthTable {
    intervals: Vec<Interval>,
    /// For equal steps of length: the first interval that reaches into the step.
    buckets: Vec<u32>,
    per_length: f64,
    domain: (f64, f64),
    length: f64,
    accuracy: f64,
    closed: bool,
    complete: bool,
}

impl LengthTable {
    /// Whether a curve has few enough pieces for a table: 262 144 cubic ones, and fewer of higher degree
    /// ([`ArcLength::effort`]). Measuring more would take long.
    ///
    /// # Errors
    ///
    /// [`CurveError::TooManyPieces`].
    pub fn check<S: Space, C: ArcLength<S> + ?Sized>(curve: &C) -> Result<(), CurveError> {
        let pieces = curve.breaks().len().saturating_sub(1);
        let most = EFFORT / 8 / curve.effort().max(1);
        if pieces <= most {
            Ok(())
        } else {
            Err(CurveError::TooManyPieces { pieces, most })
        }
    }

    /// Makes a table whose answers are within `accuracy` of the curve's length, in scene units.
    ///
    /// An accuracy below 1e-14 of the length is taken as that. Of a curve that no table of a million intervals describes to the
    /// accuracy, or none that takes less than the measuring of two million cubics, the table says so: [`Self::is_complete`].
    ///
    /// # Errors
    ///
    /// An accuracy that is not positive, a curve without length, or one shorter than 1e-150 or longer than 1e150; see also
    /// [`Self::check`].
    pub fn new<S: Space, C: ArcLength<S> + ?Sized>(
        curve: &C,
        accuracy: f64,
    ) -> Result<Self, CurveError> {
        if !(accuracy > 0.0 && accuracy.is_finite()) {
            return Err(CurveError::OutOfRange {
                name: "the accuracy",
                value: accuracy,
                range: "a positive length",
            });
        }
        Self::check(curve)?;
        let breaks = curve.breaks();
        let rough = curve.length(accuracy);
        if !(rough > 0.0 && rough.is_finite()) {
            return Err(CurveError::NoLength);
        }
        if !LENGTHS.contains(&rough) {
            return Err(CurveError::OutOfRange {
                name: "the length of the curve",
                value: rough,
                range: "from 1e-150 to 1e150, so that its square is a number: scale its points",
            });
        }
        let accuracy = accuracy.max(1e-14 * rough);
        let mut builder = Builder {
            curve,
            tolerance: 0.25 * accuracy,
            // Errors of lengths add up over a table.
            each: (0.05 * accuracy / breaks.len() as f64).max(1e-16 * rough),
            intervals: Vec::new(),
            complete: true,
            effort: 0,
            space: core::marker::PhantomData,
        };
        let mut s = 0.0;
        for pair in breaks.windows(2) {
            s = builder.span(pair[0], pair[1], s);
        }
        let Builder {
            intervals,
            complete,
            ..
        } = builder;
        let Some(last) = intervals.last() else {
            return Err(CurveError::NoLength);
        };
        let length = last.s + last.s_width;
        let count = intervals.len();
        let per_length = count as f64 / length;
        let mut buckets = Vec::with_capacity(count + 2);
        let mut at = 0;
        for step in 0..=count {
            let start = step as f64 / per_length;
            while at + 1 < count && intervals[at + 1].s <= start {
                at += 1;
            }
            buckets.push(at as u32);
        }
        buckets.push(count as u32 - 1);
        Ok(Self {
            intervals,
            buckets,
            per_length,
            domain: curve.domain(),
            length,
            accuracy,
            closed: curve.is_closed(),
            complete,
        })
    }

    /// The length of the whole curve.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The accuracy of its answers, in scene units.
    #[must_use]
    pub fn accuracy(&self) -> f64 {
        self.accuracy
    }

    /// Whether every interval met the accuracy.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.complete
    }

    /// The number of intervals.
    #[must_use]
    pub fn intervals(&self) -> usize {
        self.intervals.len()
    }

    /// A length brought onto the curve: clamped, or wrapped where the curve is closed. What is not a number gives 0.
    #[inline]
    fn on_curve(&self, s: f64) -> f64 {
        if s >= 0.0 && s <= self.length {
            return s;
        }
        if self.closed && s.is_finite() {
            let wrapped = s.rem_euclid(self.length);
            return if wrapped < self.length { wrapped } else { 0.0 };
        }
        if s > 0.0 { self.length } else { 0.0 }
    }

    /// The parameter `U(s)` at a length from the start: the curve's length up to it is within the accuracy of `s`.
    /// Lengths before and behind the curve give its ends, or wrap where it is closed.
    #[must_use]
    #[inline]
    pub fn parameter(&self, s: f64) -> f64 {
        let s = self.on_curve(s);
        let step = ((s * self.per_length) as usize).min(self.buckets.len() - 2);
        // Rounding may put a length a bucket too far.
        let mut low = self.buckets[step] as usize;
        while low > 0 && self.intervals[low].s > s {
            low -= 1;
        }
        let high = self.buckets[step + 1] as usize;
        let index = if high <= low + 4 {
            let mut i = low;
            while i < high && self.intervals[i + 1].s <= s {
                i += 1;
            }
            i
        } else {
            low + self.intervals[low + 1..=high].partition_point(|interval| interval.s <= s)
        };
        let at = &self.intervals[index];
        let x = (s - at.s) / at.s_width;
        at.u + at.u_width * polynomial(&at.inverse, x).clamp(0.0, 1.0)
    }

    /// The length `s(u)` from the start to a parameter, within the accuracy. Parameters outside the domain give its ends, or
    /// wrap where the curve is closed.
    #[must_use]
    pub fn length_to(&self, u: f64) -> f64 {
        let (start, end) = self.domain;
        let u = if u >= start && u <= end {
            u
        } else if self.closed && u.is_finite() {
            start + (u - start).rem_euclid(end - start)
        } else if u > end {
            end
        } else {
            start
        };
        let index = self.intervals[1..].partition_point(|interval| interval.u <= u);
        let at = &self.intervals[index];
        // Behind a stretch without length the parameter may lie beyond the interval.
        let x = ((u - at.u) / at.u_width).clamp(0.0, 1.0);
        at.s + at.s_width * polynomial(&at.forward, x).clamp(0.0, 1.0)
    }

    /// `count` parameters (at least 2) at equal lengths from each other, both ends included; the last of a closed curve is its
    /// start again.
    #[must_use]
    pub fn even_parameters(&self, count: usize) -> Vec<f64> {
        let steps = count.max(2) - 1;
        let all = 0..=steps;
        all.map(|i| {
            if i == steps {
                self.domain.1
            } else {
                self.parameter(self.length * (i as f64 / steps as f64))
            }
        })
        .collect()
    }
}

struct Builder<'a, S: Space, C: ?Sized> {
    curve: &'a C,
    tolerance: f64,
    each: f64,
    intervals: Vec<Interval>,
    complete: bool,
    effort: usize,
    space: core::marker::PhantomData<S>,
}

impl<S: Space, C: ArcLength<S> + ?Sized> Builder<'_, S, C> {
    fn between(&self, a: f64, b: f64) -> f64 {
        self.curve.length_between(a, b, self.each).max(0.0)
    }

    /// Speed and its change at `u`, as seen from inside the span that ends at `end`.
    fn knot(&self, u: f64, s: f64, end: Option<f64>) -> Knot {
        let jet = self.curve.jet(u);
        let (mut first, mut second) = (jet.first, jet.second);
        if let Some(start) = end {
            // At its end a jet is that of the next span. Those of this one, from inside: the third derivative of a polynomial of
            // degree 3 is constant, and of others a difference is good enough: what it gives is compared with quadrature.
            let inside = u - (u - start) * 1e-7;
            let near = self.curve.jet(inside);
            let h = u - inside;
            first = near.first + near.second * h + near.third * (0.5 * h * h);
            second = near.second + near.third * h;
        }
        let speed = first.length();
        let change = if speed > 0.0 {
            (first / speed).dot(second)
        } else {
            0.0
        };
        Knot {
            u,
            s,
            speed,
            change,
        }
    }

    /// Adds the intervals of a span and returns the length at its end.
    fn span(&mut self, start: f64, end: f64, s: f64) -> f64 {
        let total = self.between(start, end);
        let first = self.knot(start, s, None);
        let last = self.knot(end, s + total, Some(start));
        let mut stack = vec![(first, last, 0_u32)];
        while let Some((a, b, depth)) = stack.pop() {
            if b.s <= a.s {
                // Without length there is nothing to find.
                continue;
            }
            let interval = Self::interval(&a, &b);
            let short = b.s - a.s <= self.tolerance;
            let full = depth >= DEPTH
                || self.intervals.len() + stack.len() >= MOST
                || self.effort >= EFFORT;
            self.effort += self.curve.effort();
            let good = self.is_good(&a, &interval);
            if good || short || full {
                self.complete &= good || short;
                let keep = if good { interval } else { straight(&interval) };
                self.intervals.push(keep);
                continue;
            }
            let middle = 0.5 * (a.u + b.u);
            let s = (a.s + self.between(a.u, middle)).min(b.s);
            let m = self.knot(middle, s, None);
            stack.push((m, b, depth + 1));
            stack.push((a, m, depth + 1));
        }
        s + total
    }

    fn interval(a: &Knot, b: &Knot) -> Interval {
        let (du, ds) = (b.u - a.u, b.s - a.s);
        let forward = |k: &Knot| (k.speed * du / ds, k.change * du * du / ds);
        let inverse = |k: &Knot| {
            let slope = 1.0 / k.speed;
            (
                slope * ds / du,
                -k.change * slope * slope * slope * ds * ds / du,
            )
        };
        let fit = |[(v0, a0), (v1, a1)]: [(f64, f64); 2]| {
            let fit = quintic(v0, a0, v1, a1);
            let straight = [1.0, 0.0, 0.0, 0.0, 0.0];
            if fit.iter().all(|c| c.is_finite()) {
                fit
            } else {
                straight
            }
        };
        Interval {
            u: a.u,
            s: a.s,
            u_width: du,
            s_width: ds,
            inverse: fit([inverse(a), inverse(b)]),
            forward: fit([forward(a), forward(b)]),
        }
    }

    /// Whether both polynomials of an interval are as good as asked for, at three places.
    fn is_good(&self, a: &Knot, at: &Interval) -> bool {
        let (mut u_before, mut s_before) = (a.u, a.s);
        [0.2, 0.5, 0.8].iter().all(|x| {
            let share = polynomial(&at.inverse, *x);
            let u = at.u + at.u_width * share.clamp(0.0, 1.0);
            let s = s_before
                + if u >= u_before {
                    self.between(u_before, u)
                } else {
                    -self.between(u, u_before)
                };
            (u_before, s_before) = (u, s);
            let inverse = (s - (at.s + at.s_width * x)).abs();
            let y = (u - at.u) / at.u_width;
            let forward = (at.s + at.s_width * polynomial(&at.forward, y) - s).abs();
            inverse <= self.tolerance && forward <= self.tolerance
        })
    }
}

/// The interval with straight lines, which never leave it.
fn straight(interval: &Interval) -> Interval {
    let line = [1.0, 0.0, 0.0, 0.0, 0.0];
    Interval {
        inverse: line,
        forward: line,
        ..*interval
    }
}
