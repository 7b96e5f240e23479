//! `cubic-bezier(x1, y1, x2, y2)` of style sheets.
//!
//! *Source*: W3C, *CSS Easing Functions Level 2*, "Cubic Bézier easing functions": the curve with control points (0, 0),
//! (x1, y1), (x2, y2), (1, 1), read as a function of `x`. With `x1` and `x2` in [0, 1] it is one.
//!
//! The parameter is found by Newton's method kept in a bracket. Where the curve is steep a rounding error of `x` moves the
//! parameter a lot (by its cube root at the inflection of `cubic-bezier(1, 0, 0, 1)`); there the residual is
//! computed in twice the precision, by error-free products and sums (T. J. Dekker, *A Floating-Point Technique for Extending
//! the Available Precision*, Numerische Mathematik 18, 1971), so that the value keeps 1e-12 but within about 1e-15
//! of an infinite slope.

use super::{Ease, EaseFacts, EaseState, ranged};
use crate::CurveError;

/// Below this slope of `x` by the parameter the residual is computed in twice the precision: above it the error of the
/// value is at most a few units in the last place over the slope.
const STEEP: f64 = 0.05;

/// Halvings and Newton steps together; halving alone needs 1074 to separate any two numbers, but 64 to reach 1e-19.
const STEPS: usize = 80;

/// The largest magnitude of `y1` and `y2`: derivatives, with their factors, stay finite.
const LARGEST: f64 = 1e100;

/// A cubic Bézier curve as a function of its abscissa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicBezier {
    x1: f64,
    y1: f64,
    x2: f64,
    y2: f64,
}

impl CubicBezier {
    /// The keyword `ease`.
    pub const EASE: Self = Self::of(0.25, 0.1, 0.25, 1.0);
    /// The keyword `ease-in`.
    pub const EASE_IN: Self = Self::of(0.42, 0.0, 1.0, 1.0);
    /// The keyword `ease-out`.
    pub const EASE_OUT: Self = Self::of(0.0, 0.0, 0.58, 1.0);
    /// The keyword `ease-in-out`.
    pub const EASE_IN_OUT: Self = Self::of(0.42, 0.0, 0.58, 1.0);

    const fn of(x1: f64, y1: f64, x2: f64, y2: f64) -> Self {
        Self { x1, y1, x2, y2 }
    }

    /// The curve with inner control points (x1, y1) and (x2, y2): abscissas from 0 to 1, ordinates at most 1e100.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`].
    pub fn new(x1: f64, y1: f64, x2: f64, y2: f64) -> Result<Self, CurveError> {
        let ordinate = |name, y| ranged(name, y, -LARGEST, LARGEST, "at most 1e100 in size");
        Ok(Self {
            x1: ranged("x1", x1, 0.0, 1.0, "from 0 to 1")?,
            y1: ordinate("y1", y1)?,
            x2: ranged("x2", x2, 0.0, 1.0, "from 0 to 1")?,
            y2: ordinate("y2", y2)?,
        })
    }

    /// The parameter at which the abscissa is `x`, 0 < x < 1.
    fn parameter(&self, x: f64) -> f64 {
        let Self { x1, x2, .. } = *self;
        let plain = |s: f64| coordinate(x1, x2, s) - x;
        let slope = |s: f64| derivatives(x1, x2, s)[0];
        let s = bracketed(x, (0.0, 1.0), plain, slope);
        if slope(s) >= STEEP {
            return s;
        }
        // The plain residual's error, a few units of 1, moves the parameter by at most its cube root, about 1e-5.
        let reach = 1e-4;
        let bracket = ((s - reach).max(0.0), (s + reach).min(1.0));
        bracketed(s, bracket, |s| precise_residual(x1, x2, s, x), slope)
    }
}

/// A zero of a function that rises over the bracket, by Newton's method where that stays inside and converges, else by
/// halving.
fn bracketed(
    start: f64,
    (mut low, mut high): (f64, f64),
    residual: impl Fn(f64) -> f64,
    slope: impl Fn(f64) -> f64,
) -> f64 {
    let (mut s, mut last) = (start.clamp(low, high), high - low);
    for _ in 0..STEPS {
        let error = residual(s);
        if error == 0.0 {
            return s;
        }
        if error < 0.0 {
            low = s;
        } else {
            high = s;
        }
        let step = error / slope(s);
        let newton = s - step;
        // A step that is not at most half of the one before it is not converging.
        let next = if newton > low && newton < high && 2.0 * step.abs() <= last {
            last = step.abs();
            newton
        } else {
            last = 0.5 * (high - low);
            0.5 * (low + high)
        };
        if (next - s).abs() <= 0.5 * f64::EPSILON * next || next == low || next == high {
            return next;
        }
        s = next;
    }
    s
}

/// A coordinate of the curve at parameter `s`, the inner control points' being `a` and `b`. Ends are exact.
fn coordinate(a: f64, b: f64, s: f64) -> f64 {
    let r = 1.0 - s;
    3.0 * r * r * s * a + 3.0 * r * s * s * b + s * s * s
}

/// First, second and third derivative of a coordinate.
fn derivatives(a: f64, b: f64, s: f64) -> [f64; 3] {
    let r = 1.0 - s;
    let (d0, d1, d2) = (a, b - a, 1.0 - b);
    [
        3.0 * (r * r * d0 + 2.0 * r * s * d1 + s * s * d2),
        6.0 * (r * (d1 - d0) + s * (d2 - d1)),
        6.0 * (d2 - 2.0 * d1 + d0),
    ]
}

/// A number as an unevaluated sum of two.
type Double = (f64, f64);

/// The exact sum.
fn two_sum(a: f64, b: f64) -> Double {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The exact product, by splitting the factors in halves of 26 digits. Factors here are at most 3.
fn two_product(a: f64, b: f64) -> Double {
    let split = |x: f64| {
        let scaled = 134_217_729.0 * x;
        let high = scaled - (scaled - x);
        (high, x - high)
    };
    let product = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    let low = ((ah * bh - product) + ah * bl + al * bh) + al * bl;
    (product, low)
}

fn add(a: Double, b: Double) -> Double {
    let (sum, error) = two_sum(a.0, b.0);
    let (high, low) = two_sum(sum, error + (a.1 + b.1));
    (high, low)
}

fn times(a: Double, b: Double) -> Double {
    let (product, error) = two_product(a.0, b.0);
    two_sum(product, error + (a.0 * b.1 + a.1 * b.0))
}

/// The abscissa less `x` in twice the precision: `s(3a + s(3(b − 2a) + s(1 + 3a − 3b))) − x`.
fn precise_residual(a: f64, b: f64, s: f64, x: f64) -> f64 {
    let three_a = two_product(3.0, a);
    let three_b = two_product(3.0, b);
    let negative = |d: Double| (-d.0, -d.1);
    let third = add(add((1.0, 0.0), three_a), negative(three_b));
    let second = add(three_b, negative(add(three_a, three_a)));
    let s = (s, 0.0);
    let sum = times(s, add(three_a, times(s, add(second, times(s, third)))));
    let residual = add(sum, (-x, 0.0));
    residual.0 + residual.1
}

/// The least of the quadratic Bernstein form with these coefficients over [0, 1].
fn least(d0: f64, d1: f64, d2: f64) -> f64 {
    let bend = d0 - 2.0 * d1 + d2;
    let ends = d0.min(d2);
    let lowest = (d0 - d1) / bend;
    if bend > 0.0 && lowest > 0.0 && lowest < 1.0 {
        ends.min(d0 - (d0 - d1) * lowest)
    } else {
        ends
    }
}

impl Ease for CubicBezier {
    fn state(&self, t: f64) -> EaseState {
        let Self { x1, y1, x2, y2 } = *self;
        // The diagonal, however its control points are spaced.
        if x1 == y1 && x2 == y2 {
            return super::Linear.state(t);
        }
        let s = if t <= 0.0 {
            0.0
        } else if t >= 1.0 {
            1.0
        } else {
            self.parameter(t)
        };
        let value = coordinate(y1, y2, s);
        let [dx, ddx, dddx] = derivatives(x1, x2, s);
        let [dy, ddy, dddy] = derivatives(y1, y2, s);
        let dx = dx.max(0.0);
        let backwards = if s >= 1.0 { -1.0 } else { 1.0 };
        // L'Hôpital's rule where the curve stands still; a vertical tangent is an infinite speed. At the end the second
        // derivatives are seen from behind.
        let speed = if dx > 0.0 {
            dy / dx
        } else if dy != 0.0 {
            f64::INFINITY.copysign(dy)
        } else if ddx != 0.0 {
            ddy / ddx
        } else if ddy != 0.0 {
            f64::INFINITY.copysign(ddy * backwards)
        } else {
            dddy / dddx
        };
        let acceleration = (ddy * dx - dy * ddx) / (dx * dx * dx);
        EaseState {
            value,
            speed: if speed.is_nan() { 0.0 } else { speed },
            acceleration: if acceleration.is_finite() {
                acceleration
            } else {
                0.0
            },
        }
    }

    fn facts(&self) -> EaseFacts {
        let Self { x1, y1, x2, y2 } = *self;
        let vertical_start = x1 == 0.0 && (y1 != 0.0 || (x2 == 0.0 && y2 != 0.0));
        let vertical_end = x2 == 1.0 && (y2 != 1.0 || (x1 == 1.0 && y1 != 1.0));
        let vertical_middle = x1 == 1.0 && x2 == 0.0 && (y1, y2) != (1.0, 0.0);
        EaseFacts {
            monotone: least(y1, y2 - y1, 1.0 - y2) >= 0.0,
            smoothness: if vertical_middle {
                anamorph_core::Smoothness::C(0)
            } else {
                anamorph_core::Smoothness::Smooth
            },
            finite_speed: !(vertical_start || vertical_middle || vertical_end),
            ..EaseFacts::PLAIN
        }
    }

    fn breaks(&self) -> Vec<f64> {
        if self.facts().smoothness < anamorph_core::Smoothness::Smooth {
            vec![0.5]
        } else {
            Vec::new()
        }
    }
}
