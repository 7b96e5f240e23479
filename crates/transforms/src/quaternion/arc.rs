//! A great arc of the sphere of unit quaternions, prepared once and evaluated often.

use super::basics::from_wxyz;
use anamorph_core::glam::DQuat;
use anamorph_core::math;
use core::f64::consts::PI;

/// Below this length of the part of `b` across `a`, opposite quaternions have no plane to turn in.
pub(super) const OPPOSITE: f64 = 1e-12;

/// `cos(t·angle)·start + sin(t·angle)·direction`: from `start` at `t = 0`, at constant speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Arc {
    /// Where it starts.
    pub(super) start: DQuat,
    /// The unit tangent there; null where the arc is a point.
    pub(super) direction: DQuat,
    /// Its length on the sphere, in [0, π]: half the angle of the rotation.
    pub(super) angle: f64,
}

impl Arc {
    /// The arc from `a` to `b` with the signs as they are; from `q` to `−q` through `q·i` (errata C8).
    pub(super) fn between(a: DQuat, b: DQuat) -> Self {
        let cos = a.dot(b);
        let across = b - a * cos;
        let length = across.dot(across).sqrt();
        let (direction, angle) = if length < OPPOSITE && cos < 0.0 {
            (a * from_wxyz([0.0, 1.0, 0.0, 0.0]), PI)
        } else if length == 0.0 || a == b {
            (from_wxyz([0.0; 4]), 0.0)
        } else {
            // Once more perpendicular to `a`: the first time leaves rounding as large as a short `across`.
            let unit = across / length;
            let unit = unit - a * a.dot(unit);
            (unit / unit.dot(unit).sqrt(), math::atan2(length, cos))
        };
        Self {
            start: a,
            direction,
            angle,
        }
    }

    /// The point at the parameter `t`.
    #[inline]
    pub(super) fn at(&self, t: f64) -> DQuat {
        let (sin, cos) = math::sin_cos(t * self.angle);
        self.combined(sin, cos)
    }

    /// The point at the angle with this sine and cosine.
    #[inline(always)]
    pub(super) fn combined(&self, sin: f64, cos: f64) -> DQuat {
        self.start * cos + self.direction * sin
    }

    /// The point and its derivative by `t`.
    pub(super) fn moving(&self, t: f64) -> Moving {
        let (sin, cos) = math::sin_cos(t * self.angle);
        Moving {
            at: self.combined(sin, cos),
            rate: (self.direction * cos - self.start * sin) * self.angle,
        }
    }
}

/// A moving unit quaternion: where it is, and its derivative by the parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moving {
    pub(super) at: DQuat,
    pub(super) rate: DQuat,
}

/// Below this angle (radians) the quotient of [`by_cosine`] loses digits, and the first two terms of its series err by
/// less than 1e-12 of it.
const SMALL: f64 = 1e-3;

/// The derivative of `sin(tθ)/sin θ` by `cos θ`.
fn by_cosine(t: f64, angle: f64, sin: f64, cos: f64) -> f64 {
    if angle < SMALL {
        let s = t * t;
        let second = (7.0 - 10.0 * s + 3.0 * s * s) / 90.0 + (1.0 - s) / 18.0;
        return -t * ((1.0 - s) / 3.0 + angle * angle * second);
    }
    let (part_sin, part_cos) = math::sin_cos(t * angle);
    (part_sin * cos - t * part_cos * sin) / (sin * sin * sin)
}

/// The slerp of moving quaternions at a moving parameter, signs as they are. Where the two are opposite, and the arc
/// may jump, the derivative is that along the arc alone.
pub(super) fn slerp_moving(a: Moving, b: Moving, t: f64, t_rate: f64) -> Moving {
    let arc = Arc::between(a.at, b.at);
    let along = arc.moving(t);
    let (sin, cos) = math::sin_cos(arc.angle);
    // `along.rate` holds the change of the parameter; what is left is that of the ends and of the angle between them.
    let mut rate = along.rate * t_rate;
    if cos > 0.0 || sin >= OPPOSITE {
        let opening = a.rate.dot(b.at) + a.at.dot(b.rate);
        let weight = |t: f64| {
            if arc.angle < SMALL {
                t * (1.0 + (1.0 - t * t) * arc.angle * arc.angle / 6.0)
            } else {
                math::sin(t * arc.angle) / sin
            }
        };
        let slope = |t: f64| opening * by_cosine(t, arc.angle, sin, cos);
        rate = rate
            + a.rate * weight(1.0 - t)
            + b.rate * weight(t)
            + a.at * slope(1.0 - t)
            + b.at * slope(t);
    }
    Moving { at: along.at, rate }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quaternion::exp;
    use crate::testing::Random;
    use anamorph_core::glam::DVec3;

    #[test]
    fn derivatives_of_slerp_are_limits_of_differences() {
        let mut random = Random::new(31);
        for step in 0..600 {
            let a = exp(random.direction::<DVec3>() * 0.9);
            let apart = [1.3, 0.4, 2e-3, 5e-4, 1e-5, 0.0][step % 6];
            let b = a * exp(random.direction::<DVec3>() * apart);
            let (turn_a, turn_b): (DVec3, DVec3) = (random.vector(), random.vector());
            let (t, speed) = (random.between(0.0, 1.0), random.between(-2.0, 2.0));
            let at = |h: f64| {
                let (a, b) = (exp(turn_a * h) * a, exp(turn_b * h) * b);
                Arc::between(a, b).at(t + speed * h)
            };
            let pure = |v: DVec3| DQuat::from_xyzw(v.x, v.y, v.z, 0.0);
            let moving = |q: DQuat, turn: DVec3| Moving {
                at: q,
                rate: pure(turn) * q,
            };
            let found = slerp_moving(moving(a, turn_a), moving(b, turn_b), t, speed);
            let h = 1e-5;
            let difference = (at(h) - at(-h)) / (2.0 * h);
            let off = found.rate - difference;
            assert!(off.dot(off).sqrt() < 1e-8, "{step} {off:?}");
            assert!(found.rate.dot(found.at).abs() < 1e-11);
        }
    }
}
