//! Rotation vectors that change over time: from their derivatives to angular velocities and back.
//!
//! With `R(t) = R₀·exp(φ(t))` the angular velocity seen by the body is `ω = J(φ)·φ′`, where
//! `J = I − f·[φ×] + g·[φ×]²`, `f = (1 − cos θ)/θ²`, `g = (θ − sin θ)/θ³`, `θ = ‖φ‖` (the right Jacobian of the exponential).
//! Its derivative is `J·φ″` and what [`Turn::bending`] gives.

use anamorph_core::glam::{DMat3, DVec3};
use anamorph_core::math;

/// The functions of `θ` in `J` and its derivative.
#[derive(Debug, Clone, Copy)]
struct Weights {
    f: f64,
    g: f64,
    /// `f′/θ` and `g′/θ`.
    f_slope: f64,
    g_slope: f64,
}

/// Below this square of the angle the power series are used: twelve terms are exact to rounding there, while the
/// closed forms lose digits.
const SERIES: f64 = 1.0;

impl Weights {
    fn at(square: f64) -> Self {
        if square >= SERIES {
            let angle = square.sqrt();
            let (sin, cos) = math::sin_cos(angle);
            let half = math::sin(0.5 * angle);
            let f = 2.0 * half * half / square;
            let g = (angle - sin) / (square * angle);
            return Self {
                f,
                g,
                f_slope: (sin / angle - 2.0 * f) / square,
                g_slope: ((1.0 - cos) / square - 3.0 * g) / square,
            };
        }
        // f = Σ (−θ²)ᵏ/(2k + 2)!, g = Σ (−θ²)ᵏ/(2k + 3)!; the slopes are twice the derivatives by θ².
        let [mut f, mut g, mut f_slope, mut g_slope] = [0.0; 4];
        let (mut power, mut before, mut factorial) = (1.0, 0.0, 1.0);
        for k in 0..12_u32 {
            let k = f64::from(k);
            factorial *= 2.0 * k + 2.0;
            f += power / factorial;
            f_slope -= 2.0 * k * before / factorial;
            factorial *= 2.0 * k + 3.0;
            g += power / factorial;
            g_slope -= 2.0 * k * before / factorial;
            before = power;
            power *= -square;
        }
        Self {
            f,
            g,
            f_slope,
            g_slope,
        }
    }
}

/// A rotation vector, ready to take derivatives at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turn {
    vector: DVec3,
    weights: Weights,
}

impl Turn {
    pub(super) fn new(vector: DVec3) -> Self {
        Self {
            vector,
            weights: Weights::at(vector.dot(vector)),
        }
    }

    /// `J·rate`: the angular velocity that the derivative `rate` of the rotation vector means.
    pub(super) fn velocity(&self, rate: DVec3) -> DVec3 {
        let across = self.vector.cross(rate);
        rate - across * self.weights.f + self.vector.cross(across) * self.weights.g
    }

    /// The matrix of [`Self::velocity`]; invertible for angles below a whole turn.
    pub(super) fn jacobian(&self) -> DMat3 {
        DMat3::from_cols(
            self.velocity(DVec3::X),
            self.velocity(DVec3::Y),
            self.velocity(DVec3::Z),
        )
    }

    /// `J′·rate`, the part of the angular acceleration that is there without a second derivative; quadratic in `rate`.
    pub(super) fn bending(&self, rate: DVec3) -> DVec3 {
        let (across, along) = (self.vector.cross(rate), self.vector.dot(rate));
        rate.cross(across) * self.weights.g - across * (self.weights.f_slope * along)
            + self.vector.cross(across) * (self.weights.g_slope * along)
    }

    /// The derivative of [`Self::bending`] by `rate`.
    pub(super) fn bending_slope(&self, rate: DVec3) -> DMat3 {
        // Exact for a quadratic form: N(r + e) − N(r) − N(e) is its polar form; written out, so that a large `rate`
        // does not swallow `e`.
        let column = |e: DVec3| {
            let (across, along) = (self.vector.cross(rate), self.vector.dot(rate));
            let (e_across, e_along) = (self.vector.cross(e), self.vector.dot(e));
            let Weights {
                g,
                f_slope,
                g_slope,
                ..
            } = self.weights;
            (rate.cross(e_across) + e.cross(across)) * g
                - (e_across * along + across * e_along) * f_slope
                + self.vector.cross(e_across * along + across * e_along) * g_slope
        };
        DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quaternion::exp;
    use crate::testing::Random;

    #[test]
    fn velocities_and_accelerations_are_limits_of_differences() {
        let mut random = Random::new(61);
        for step in 0..400 {
            let size = [3.1, 1.01, 0.99, 0.1, 1e-3, 0.0, 9.0][step % 7];
            let (a, b) = (random.direction::<DVec3>() * size, random.vector::<DVec3>());
            let c: DVec3 = random.vector();
            // φ(t) = a + b t + c t²/2.
            let at = |t: f64| a + b * t + c * (0.5 * t * t);
            let velocity = |t: f64| Turn::new(at(t)).velocity(b + c * t);
            let h = 1e-5;
            let q = |t: f64| exp(at(t) * 0.5);
            let turn = q(0.0).conjugate() * ((q(h) - q(-h)) / (2.0 * h));
            let measured = DVec3::new(turn.x, turn.y, turn.z) * 2.0;
            assert!((measured - velocity(0.0)).length() < 1e-8, "{step}");
            let turn = Turn::new(a);
            let acceleration = turn.velocity(c) + turn.bending(b);
            let measured = (velocity(h) - velocity(-h)) / (2.0 * h);
            assert!((measured - acceleration).length() < 1e-7, "{step}");
            let slope = (turn.bending(b + c * h) - turn.bending(b - c * h)) / (2.0 * h);
            assert!((turn.bending_slope(b) * c - slope).length() < 1e-8);
            assert!((turn.jacobian() * c - turn.velocity(c)).length() < 1e-14);
        }
    }

    #[test]
    fn series_and_closed_forms_meet() {
        let (below, above) = (Weights::at(1.0_f64.next_down()), Weights::at(1.0));
        for (a, b) in [
            (below.f, above.f),
            (below.g, above.g),
            (below.f_slope, above.f_slope),
            (below.g_slope, above.g_slope),
        ] {
            assert!((a - b).abs() < 1e-14);
        }
    }
}
