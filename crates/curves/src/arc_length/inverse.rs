//! The inverse `U(s)` of arc length for a single question.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Reparameterizing by arc length"; errata C13: prefix sums of Gauss'
//! quadrature, then Newton's method with the speed as derivative, kept inside a bracket and halving it at cusps, until the
//! *length* is within the accuracy. Each step adds the length between the last parameter and the next, so that intervals and
//! with them the work shrink. Many questions are better asked of a [`LengthTable`](super::LengthTable).

use super::cubic::{self, WHOLE};
use super::table::{polynomial, quintic};
use super::{ArcLength, search, sensible};
use crate::PiecewiseCubic;
use anamorph_core::{Curve, Space};

/// Steps at most; halving alone needs 53 to reach the rounding of the parameter.
pub(super) const STEPS: usize = 64;

/// A curve that finds the parameter at a length.
pub trait InverseArcLength<S: Space>: ArcLength<S> {
    /// The parameter at length `s` from the start; the curve's length up to it is within `accuracy` of `s`. Lengths before and
    /// behind the curve give its ends, or wrap where it is closed.
    fn parameter_at(&self, s: f64, accuracy: f64) -> f64;
}

/// What the search asks of a curve.
trait Walk {
    /// The speed and its first three derivatives by the parameter. A derivative that is not known is 0.
    fn speeds(&self, u: f64) -> [f64; 4];
    /// The length between two parameters, the first not greater.
    fn between(&mut self, a: f64, b: f64) -> f64;
}

/// How far to go from where the speed and its derivatives are `speeds` to add the length `missing`: the inverse of the length's
/// series (Lagrange's reversion) up to the fourth power.
#[inline(always)]
pub(super) fn step(missing: f64, speeds: [f64; 4]) -> f64 {
    let slowness = 1.0 / speeds[0];
    let way = missing * slowness;
    let (b, c, e) = (
        speeds[1] * slowness * (1.0 / 2.0),
        speeds[2] * slowness * (1.0 / 6.0),
        speeds[3] * slowness * (1.0 / 24.0),
    );
    let second = way * b;
    if second.abs() > 0.25 {
        // Too far for a series: Halley's method keeps its head.
        return way / (1.0 + second);
    }
    let square = b * b;
    let third = 2.0 * square - c;
    let fourth = 5.0 * b * (c - square) - e;
    way * (1.0 - second + way * way * (third + way * fourth))
}

/// Finds where, between `low` and `high` (parameters with the lengths there), the length is `target`. With three derivatives
/// of the speed a step's error falls with the fifth power.
#[inline(always)]
fn newton(
    target: f64,
    mut low: (f64, f64),
    mut high: (f64, f64),
    accuracy: f64,
    walk: &mut impl Walk,
) -> f64 {
    let width = high.1 - low.1;
    if width <= 0.0 {
        return low.0;
    }
    // The quintic with the curve's speed and change of speed at both ends, as in tables; where the curve stops, a line.
    let x = ((target - low.1) / width).clamp(0.0, 1.0);
    let du = high.0 - low.0;
    let end = |[speed, change, ..]: [f64; 4]| {
        let slope = 1.0 / speed;
        let bend = -change * slope * slope * slope;
        (slope * width / du, bend * width * width / du)
    };
    let (a, b) = (end(walk.speeds(low.0)), end(walk.speeds(high.0)));
    let share = polynomial(&quintic(a.0, a.1, b.0, b.1), x);
    let share = if share > 0.0 && share < 1.0 { share } else { x };
    let mut u = low.0 + du * share;
    let mut known = if x < 0.5 { low } else { high };
    for _ in 0..STEPS {
        let s = known.1
            + if u >= known.0 {
                walk.between(known.0, u)
            } else {
                -walk.between(u, known.0)
            };
        let miss = s - target;
        if miss.abs() <= accuracy {
            return u;
        }
        if miss < 0.0 {
            low = (u, s);
        } else {
            high = (u, s);
        }
        known = (u, s);
        let next = u + step(-miss, walk.speeds(u));
        u = if next > low.0 && next < high.0 {
            next
        } else {
            0.5 * (low.0 + high.0)
        };
        if u == low.0 || u == high.0 {
            break;
        }
    }
    u
}

impl<S: Space> InverseArcLength<S> for PiecewiseCubic<S> {
    fn parameter_at(&self, s: f64, accuracy: f64) -> f64 {
        let accuracy = sensible(accuracy, self.polygon());
        let count = self.pieces().len();
        let mut ends = Vec::with_capacity(count);
        let mut sum = 0.0;
        if count > 1 || self.is_closed() {
            let parts = self.pieces().iter().map(|c| (c, WHOLE));
            let each = 0.25 * accuracy / count as f64;
            let mut piece = 0;
            cubic::lengths(parts, each, |index, _, _, length| {
                if index != piece {
                    ends.push(sum);
                    piece = index;
                }
                sum += length;
            });
            ends.push(sum);
        }
        let (start, end) = self.domain();
        let s = if self.is_closed() && s.is_finite() && sum > 0.0 && !(s >= 0.0 && s <= sum) {
            s.rem_euclid(sum)
        } else {
            s
        };
        if s.is_nan() || s <= 0.0 {
            return start;
        }
        let index = ends.partition_point(|e| *e < s);
        if index >= count {
            return end;
        }
        let before = if index == 0 { 0.0 } else { ends[index - 1] };
        let x = search::one(&self.pieces()[index], s - before, accuracy);
        let (a, b) = (self.break_at(index), self.break_at(index + 1));
        if x >= 1.0 { b } else { a + (b - a) * x }
    }
}

/// The same by the generic length, for curves without a faster way.
macro_rules! by_length {
    ($curve:ty) => {
        impl<S: Space> InverseArcLength<S> for $curve {
            fn parameter_at(&self, s: f64, accuracy: f64) -> f64 {
                by_search(self, s, accuracy)
            }
        }
    };
}
by_length!(crate::Bezier<S>);
by_length!(crate::PiecewiseBezier<S>);
by_length!(crate::families::Lagrange<S>);

fn by_search<S: Space, C: ArcLength<S>>(curve: &C, s: f64, accuracy: f64) -> f64 {
    let (start, end) = curve.domain();
    if s.is_nan() {
        return start;
    }
    let breaks = curve.breaks();
    let each = 0.25 * accuracy / breaks.len() as f64;
    let mut lengths = vec![0.0];
    let mut sum = 0.0;
    for pair in breaks.windows(2) {
        sum += curve.length_between(pair[0], pair[1], each);
        lengths.push(sum);
    }
    let inside = s >= 0.0 && s <= sum;
    let s = if curve.is_closed() && !inside && s.is_finite() && sum > 0.0 {
        s.rem_euclid(sum)
    } else {
        s
    };
    if s <= 0.0 {
        return start;
    }
    let index = lengths.partition_point(|e| *e < s);
    if index >= lengths.len() {
        return end;
    }
    let accuracy = sensible(accuracy, sum);
    let mut walk = Along {
        curve,
        accuracy: 0.05 * accuracy,
        space: core::marker::PhantomData,
    };
    let (low, high) = (
        (breaks[index - 1], lengths[index - 1]),
        (breaks[index], lengths[index]),
    );
    newton(s, low, high, 0.5 * accuracy, &mut walk)
}

struct Along<'a, S, C> {
    curve: &'a C,
    accuracy: f64,
    space: core::marker::PhantomData<S>,
}

impl<S: Space, C: ArcLength<S>> Walk for Along<'_, S, C> {
    fn speeds(&self, u: f64) -> [f64; 4] {
        let jet = self.curve.jet(u);
        let along = jet.first.normalized().unwrap_or(S::ZERO);
        [jet.first.length(), along.dot(jet.second), 0.0, 0.0]
    }
    fn between(&mut self, a: f64, b: f64) -> f64 {
        self.curve.length_between(a, b, self.accuracy)
    }
}
