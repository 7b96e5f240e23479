//! The inverse `U(s)` of arc length for a single question.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Reparameterizing by arc length"; errata C13: prefix sums of Gauss'
//! quadrature, then Newton's method with the speed as derivative, kept inside a bracket and halving it at cusps, until the
//! *length* is within the accuracy. Each step adds the length between the last parameter and the next, so that intervals and
//! with them the work shrink. Many questions are better asked of a [`LengthTable`](super::LengthTable).

use super::cubic::{self, Stretch};
use super::{ArcLength, sensible};
use crate::{Cubic, PiecewiseCubic};
use anamorph_core::{Curve, Space};

/// Steps at most; halving alone needs 53 to reach the rounding of the parameter.
const STEPS: usize = 64;

/// A curve that finds the parameter at a length.
pub trait InverseArcLength<S: Space>: ArcLength<S> {
    /// The parameter at length `s` from the start; the curve's length up to it is within `accuracy` of `s`. Lengths before and
    /// behind the curve give its ends, or wrap where it is closed.
    fn parameter_at(&self, s: f64, accuracy: f64) -> f64;
}

/// Finds where, between `from` (length `s_from` there) and `to` (`s_to`), the length is `s`.
fn newton(
    target: f64,
    mut low: (f64, f64),
    mut high: (f64, f64),
    accuracy: f64,
    speed: impl Fn(f64) -> f64,
    mut between: impl FnMut(f64, f64) -> f64,
) -> f64 {
    let width = high.1 - low.1;
    if width <= 0.0 {
        return low.0;
    }
    // The cubic from speed to speed at the ends, at the wanted share: exact for curves of even speed.
    let x = ((target - low.1) / width).clamp(0.0, 1.0);
    let du = high.0 - low.0;
    let slope = |u: f64| {
        let slope = width / (speed(u) * du);
        // Beyond three the cubic would turn back.
        if slope < 3.0 { slope } else { 3.0 }
    };
    let (a, b) = (slope(low.0), slope(high.0));
    let share = x * (a + x * (3.0 - 2.0 * a - b + x * (a + b - 2.0)));
    let mut u = low.0 + du * share.clamp(0.0, 1.0);
    let mut known = if x < 0.5 { low } else { high };
    for _ in 0..STEPS {
        let s = known.1
            + if u >= known.0 {
                between(known.0, u)
            } else {
                -between(u, known.0)
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
        let next = u - miss / speed(u);
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

/// The local parameter of a cubic at length `s` from `x = 0`, for a length inside it; `found` holds its intervals with the
/// lengths up to their starts.
fn in_cubic<S: Space>(cubic: &Cubic<S>, s: f64, accuracy: f64, mut before: f64) -> f64 {
    let whole = Stretch { from: 0.0, to: 1.0 };
    // Half of the accuracy for the length so far, half for the search.
    let mut at: Option<(f64, f64, f64, f64)> = None;
    let mut last = 1.0;
    let parts = core::iter::once((cubic, whole));
    cubic::lengths(parts, 0.25 * accuracy, |_, from, to, length| {
        if at.is_none() {
            if before + length >= s {
                at = Some((from, before, to, before + length));
            }
            before += length;
            last = to;
        }
    });
    let Some((from, s_from, to, s_to)) = at else {
        return last;
    };
    newton(
        s,
        (from, s_from),
        (to, s_to),
        0.5 * accuracy,
        |x| cubic.velocity(x).length(),
        |a, b| {
            let part = core::iter::once((cubic, Stretch { from: a, to: b }));
            let mut sum = 0.0;
            cubic::lengths(part, 0.05 * accuracy, |_, _, _, length| sum += length);
            sum
        },
    )
}

impl<S: Space> InverseArcLength<S> for PiecewiseCubic<S> {
    fn parameter_at(&self, s: f64, accuracy: f64) -> f64 {
        let accuracy = sensible(accuracy, self.polygon());
        let count = self.pieces().len();
        let mut ends = Vec::with_capacity(count);
        let mut sum = 0.0;
        let whole = Stretch { from: 0.0, to: 1.0 };
        if count > 1 || self.is_closed() {
            let parts = self.pieces().iter().map(|c| (c, whole));
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
        let x = in_cubic(&self.pieces()[index], s, accuracy, before);
        let (a, b) = (self.break_at(index), self.break_at(index + 1));
        if x >= 1.0 { b } else { a + (b - a) * x }
    }
}

/// The local parameters of one cubic Bézier curve at a length from its start.
pub fn cubic_parameter_at<S: Space>(curve: &[S; 4], s: f64, accuracy: f64) -> f64 {
    if s.is_nan() || s <= 0.0 {
        return 0.0;
    }
    let cubic = Cubic::from_bezier(*curve);
    let size = cubic.0[1].length() + cubic.0[2].length() + cubic.0[3].length();
    in_cubic(&cubic, s, sensible(accuracy, size), 0.0)
}

/// The same by the generic length, for curves without a faster way.
macro_rules! by_length {
    ($curve:ty) => {
        impl<S: Space> InverseArcLength<S> for $curve {
            fn parameter_at(&self, s: f64, accuracy: f64) -> f64 {
                search(self, s, accuracy)
            }
        }
    };
}
by_length!(crate::Bezier<S>);
by_length!(crate::PiecewiseBezier<S>);
by_length!(crate::families::Lagrange<S>);

fn search<S: Space, C: ArcLength<S>>(curve: &C, s: f64, accuracy: f64) -> f64 {
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
    newton(
        s,
        (breaks[index - 1], lengths[index - 1]),
        (breaks[index], lengths[index]),
        0.5 * accuracy,
        |u| curve.velocity(u).length(),
        |a, b| curve.length_between(a, b, 0.05 * accuracy),
    )
}
