//! Rotations by axis and angle, in the plane and in space.
//!
//! *Source*: O. Rodrigues, *Des lois géométriques qui régissent les déplacements d'un système solide*, J. Math. Pures
//! Appl. 5, 1840, as `R(φ) = I + sin φ·K + (1 − cos φ)·K²` with `K` the generator. Errata F8, F18: a half turn has no
//! smallest rotation; the first non-zero component of its axis is positive, and in the plane it goes counter-clockwise.

use anamorph_core::glam::{DMat2, DMat3, DVec2, DVec3};
use anamorph_core::{Space, math};
use core::f64::consts::{PI, TAU};

use crate::quaternion;

/// Rotations this close (radians) to a half turn follow the sign rule for half turns.
///
/// A half turn read from a file or computed by a sine carries errors near 1e-16, which would otherwise choose its sense
/// by accident. Only the sense follows the rule, the rotation itself is not rounded: angles may exceed π by this much.
pub const HALF_TURN: f64 = 1e-9;

/// Components of a unit axis below this count as zero for the sign rule.
const NEGLIGIBLE: f64 = 1e-9;

/// Directions this far (sine of the angle between them) from antiparallel have a plane to turn in.
const ANTIPARALLEL: f64 = 1e-12;

/// A rotation by axis and angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn<S> {
    /// Unit vector of the axis, null for no rotation. Not read in the plane, where it is null.
    pub axis: S,
    /// Angle in radians: counter-clockwise in the plane, by the right-hand rule about the axis in space.
    pub angle: f64,
}

impl<S: Rotational> Turn<S> {
    /// No rotation.
    pub fn none() -> Self {
        Self {
            axis: S::ZERO,
            angle: 0.0,
        }
    }

    /// The rotation by `strength` times the angle.
    pub fn matrix(&self, strength: f64) -> S::Linear {
        S::rotation(self.axis, self.angle * strength)
    }
}

/// Spaces whose rotations can be taken apart: the plane and space.
pub trait Rotational: Space {
    /// The generator `K` of rotations about the unit vector `axis`: in space `K v = axis × v`, in the plane the quarter
    /// turn (and `axis` is not read).
    fn generator(axis: Self) -> Self::Linear;

    /// Axis and angle of a rotation matrix. The angle is in (−π, π] in the plane and in [0, π] in space; within
    /// [`HALF_TURN`] of π the sense follows the sign rule and the angle may pass π by as much.
    fn turn_of(rotation: &Self::Linear) -> Turn<Self>;

    /// The smallest rotation that takes the direction of `from` to the direction of `to`, or `None` when either is null
    /// or not finite. Antiparallel directions have no smallest rotation: then a half turn, in space about
    /// `from × (the coordinate axis least aligned with it)`, in the plane counter-clockwise (errata F8).
    fn turn_between(from: Self, to: Self) -> Option<Turn<Self>>;

    /// Whether the sense of a turn is the one the sign rule prefers.
    fn sense_is_positive(turn: &Turn<Self>) -> bool;
}

impl Rotational for DVec2 {
    fn generator(_: Self) -> DMat2 {
        DMat2::from_cols(DVec2::new(0.0, 1.0), DVec2::new(-1.0, 0.0))
    }

    fn turn_of(rotation: &DMat2) -> Turn<Self> {
        // Of the four entries two say the sine and two the cosine; their means halve the rounding.
        let sin = rotation.x_axis.y - rotation.y_axis.x;
        let cos = rotation.x_axis.x + rotation.y_axis.y;
        Turn {
            axis: DVec2::ZERO,
            angle: counter_clockwise(math::atan2(sin, cos)),
        }
    }

    fn turn_between(from: Self, to: Self) -> Option<Turn<Self>> {
        let (a, b) = (Space::normalized(from)?, Space::normalized(to)?);
        let angle = math::atan2(a.x * b.y - a.y * b.x, Space::dot(a, b));
        Some(Turn {
            axis: DVec2::ZERO,
            angle: counter_clockwise(angle),
        })
    }

    fn sense_is_positive(turn: &Turn<Self>) -> bool {
        turn.angle >= 0.0
    }
}

/// Clockwise half turns as counter-clockwise ones.
fn counter_clockwise(angle: f64) -> f64 {
    if angle < HALF_TURN - PI {
        angle + TAU
    } else {
        angle
    }
}

impl Rotational for DVec3 {
    fn generator(k: Self) -> DMat3 {
        DMat3::from_cols(
            DVec3::new(0.0, k.z, -k.y),
            DVec3::new(-k.z, 0.0, k.x),
            DVec3::new(k.y, -k.x, 0.0),
        )
    }

    fn turn_of(rotation: &DMat3) -> Turn<Self> {
        quaternion::to_turn(quaternion::from_matrix(rotation))
    }

    fn turn_between(from: Self, to: Self) -> Option<Turn<Self>> {
        let (a, b) = (Space::normalized(from)?, Space::normalized(to)?);
        let cross = a.cross(b);
        let (sin, cos) = (Space::length(cross), Space::dot(a, b));
        if cos < 0.0 && sin < ANTIPARALLEL {
            let least = (1..3).fold(0, |least, i| {
                if a.component(i).abs() < a.component(least).abs() {
                    i
                } else {
                    least
                }
            });
            let axis = Space::normalized(a.cross(Space::unit(least)))?;
            return Some(Turn { axis, angle: PI });
        }
        // Rounding of the cross product leans the axis out of the plane's normal; a second look at `from` sets it upright,
        // which near a half turn is the difference between 1e-16 and 1e-4.
        let axis = Space::normalized(cross).unwrap_or(DVec3::ZERO);
        let axis = Space::normalized(axis - a * Space::dot(axis, a)).unwrap_or(DVec3::ZERO);
        Some(Turn {
            axis,
            angle: math::atan2(sin, cos),
        })
    }

    fn sense_is_positive(turn: &Turn<Self>) -> bool {
        first_component_is_positive(turn.axis) == (turn.angle >= 0.0)
    }
}

/// The sign rule for axes: the first component that is not negligible is positive.
pub(crate) fn first_component_is_positive(axis: DVec3) -> bool {
    (0..3)
        .map(|i| axis.component(i))
        .find(|c| c.abs() > NEGLIGIBLE)
        .is_none_or(|c| c > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, far};
    use anamorph_core::Linear;

    #[test]
    fn turns_of_rotations_by_any_angle() {
        let mut random = Random::new(11);
        for step in 0..2000 {
            let axis: DVec3 = random.direction();
            // Down to 1e-12 from zero and from a half turn.
            let small = math::powi(0.1, step % 13);
            let angle = match step % 3 {
                0 => small,
                1 => PI - small,
                _ => random.between(0.0, PI),
            };
            let rotation = <DVec3 as Space>::rotation(axis, angle);
            let turn = DVec3::turn_of(&rotation);
            assert!(far::<DVec3>(&turn.matrix(1.0), &rotation) < 1e-15);
            let same_sense = if Space::dot(turn.axis, axis) > 0.0 {
                (turn.angle - angle).abs()
            } else {
                // Only a half turn may change its sense.
                assert!(PI - angle <= 1.01 * HALF_TURN);
                (TAU - turn.angle - angle).abs()
            };
            assert!(same_sense < 1e-15 + 1e-15 * angle, "{same_sense}");

            let plane = <DVec2 as Space>::rotation(DVec2::ZERO, -angle);
            let turn = DVec2::turn_of(&plane);
            let expected = if PI - angle < HALF_TURN {
                TAU - angle
            } else {
                -angle
            };
            assert!((turn.angle - expected).abs() < 1e-15 * (1.0 + angle));
        }
    }

    #[test]
    fn small_angles_keep_their_digits() {
        for angle in [1e-3, 1e-9, 1e-200] {
            let turn = DVec3::turn_of(&<DVec3 as Space>::rotation(DVec3::NEG_Y, angle));
            assert!((turn.angle / angle - 1.0).abs() < 1e-14);
            assert!((turn.axis - DVec3::NEG_Y).length() < 1e-14);
        }
        assert_eq!(DVec3::turn_of(&DMat3::IDENTITY), Turn::none());
    }

    #[test]
    fn half_turns_follow_the_sign_rule() {
        for axis in [
            DVec3::new(-1.0, 2.0, 3.0),
            DVec3::NEG_Z,
            DVec3::new(0.0, -1.0, 1.0),
            DVec3::new(-1e-17, 1.0, 0.0),
        ] {
            let turn = DVec3::turn_of(&<DVec3 as Space>::rotation(axis, PI));
            assert!(first_component_is_positive(turn.axis), "{turn:?}");
            assert!((turn.angle - PI).abs() < 1e-15);
        }
        for noise in [-1.2e-16, 0.0, -0.0, 1.2e-16] {
            let half = DMat2::from_cols(DVec2::new(-1.0, noise), DVec2::new(-noise, -1.0));
            assert!((DVec2::turn_of(&half).angle - PI).abs() < 1e-15);
        }
    }

    #[test]
    fn turns_between_directions() {
        let mut random = Random::new(12);
        for step in 0..2000 {
            let from: DVec3 = random.direction();
            let to = match step % 4 {
                0 => random.direction(),
                1 => -from + random.direction::<DVec3>() * math::powi(0.1, step % 17),
                2 => from + random.direction::<DVec3>() * math::powi(0.1, step % 17),
                _ => -from,
            };
            let Some(turn) = DVec3::turn_between(from * 3.0, to) else {
                panic!("no turn from {from} to {to}");
            };
            let landed = turn.matrix(1.0).apply(from);
            assert!((landed - to.normalize()).length() < 3e-12, "{from} {to}");
            // Smallest: the angle is the angle between the directions.
            let between = math::atan2(
                Space::length(from.cross(to.normalize())),
                Space::dot(from, to.normalize()),
            );
            assert!((turn.angle - between).abs() < 3e-12);

            let (p, q) = (
                DVec2::new(from.x, from.y + 2.0),
                DVec2::new(to.x, to.y - 0.3),
            );
            if let Some(turn) = DVec2::turn_between(p, q) {
                assert!((turn.matrix(1.0).apply(p.normalize()) - q.normalize()).length() < 1e-14);
            }
        }
        assert!(DVec3::turn_between(DVec3::ZERO, DVec3::X).is_none());
        assert!(DVec2::turn_between(DVec2::X, DVec2::new(f64::NAN, 0.0)).is_none());
    }

    #[test]
    fn errata_f8_antiparallel_directions() {
        let turn = DVec3::turn_between(DVec3::new(0.1, 2.0, 0.0), DVec3::new(-0.1, -2.0, 0.0));
        let turn = turn.unwrap();
        assert!((turn.axis - DVec3::new(2.0, -0.1, 0.0).normalize()).length() < 1e-15);
        assert_eq!(turn.angle, PI);
        assert_eq!(
            DVec2::turn_between(DVec2::X, DVec2::new(-1.0, -0.0))
                .unwrap()
                .angle,
            PI
        );
    }

    #[test]
    fn generators_generate() {
        let axis = DVec3::new(1.0, -2.0, 0.5).normalize();
        for angle in [0.3, -2.0, 3.0] {
            let (sin, cos) = math::sin_cos(angle);
            let k = DVec3::generator(axis);
            let sum = DMat3::IDENTITY + k * sin + k * k * (1.0 - cos);
            assert!(far::<DVec3>(&sum, &<DVec3 as Space>::rotation(axis, angle)) < 1e-15);
            let k = DVec2::generator(DVec2::ZERO);
            let sum = DMat2::IDENTITY + k * sin + k * k * (1.0 - cos);
            assert!(far::<DVec2>(&sum, &<DVec2 as Space>::rotation(DVec2::ZERO, angle)) < 1e-15);
        }
    }
}
