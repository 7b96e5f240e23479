//! Closed forms of arc length: lines and parabolas.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Reparameterizing by arc length – analytic" (errata C11). The speed of a
//! curve of degree 2 is `√(A x² + B x + C)`; with `x` moved to where the speed is least, `√(A y² + m²)`, whose integral is
//! `½ y √(A y² + m²) + m²/(2√A)·asinh(√A y/m)`.

use anamorph_core::{Space, math};

/// The length of the segment from `a` to `b`.
#[must_use]
pub fn line<S: Space>(a: S, b: S) -> f64 {
    a.distance(b)
}

/// The length of the quadratic Bézier curve `a b c`.
#[must_use]
pub fn quadratic<S: Space>([a, b, c]: [S; 3]) -> f64 {
    quadratic_between([a, b, c], 0.0, 1.0)
}

/// The length of the quadratic Bézier curve between two parameters, the first not greater.
#[must_use]
pub fn quadratic_between<S: Space>([a, b, c]: [S; 3], from: f64, to: f64) -> f64 {
    // The velocity is first + second·x.
    let first = (b - a) * 2.0;
    let second = (a - b + (c - b)) * 2.0;
    let scale = first.length().max(second.length());
    if scale == 0.0 || !scale.is_finite() {
        return 0.0;
    }
    let (first, second) = (first / scale, second / scale);
    let bend = second.length();
    // A bend that does not change the speed by a rounding.
    if bend < 1e-9 {
        let middle = first + second * (0.5 * (from + to));
        return middle.length() * (to - from) * scale;
    }
    // Where the speed is least, and how large it is there: the part of the velocity across the bend.
    let along = second / bend;
    let least = -first.dot(along) / bend;
    let across = (first - along * first.dot(along)).length();
    let part = |x: f64| {
        let y = (x - least) * bend;
        let speed = Space::length(S::from_fn(|axis| match axis {
            0 => y,
            1 => across,
            _ => 0.0,
        }));
        let log = if across == 0.0 {
            0.0
        } else {
            // asinh(|y|/across), odd in y.
            let log = math::ln((y.abs() + speed) / across);
            across * across * if y < 0.0 { -log } else { log }
        };
        (y * speed + log) / (2.0 * bend)
    };
    (part(to) - part(from)) * scale
}
