//! Conversions, logarithm, exponential and the great arc.
//!
//! *Source*: K. Shoemake, *Animating Rotation with Quaternion Curves*, SIGGRAPH 1985; S. W. Shepperd, *Quaternion from
//! Rotation Matrix*, J. Guidance and Control 1(3), 1978. Errata C8 (opposite quaternions), F8 and F18 (half turns). glam's
//! own conversions call the standard library's sine, which differs between processors; these call [`math`].

use anamorph_core::glam::{DMat3, DQuat, DVec3};
use anamorph_core::{Space, math};
use core::f64::consts::{PI, TAU};

use super::arc::Arc;
use crate::rotation::first_component_is_positive;
use crate::{HALF_TURN, Rotational, Turn};

/// The quaternion with the given scalar part and vector part, `[w, x, y, z]`, as it is (not normalized).
pub fn from_wxyz(wxyz: [f64; 4]) -> DQuat {
    let [w, x, y, z] = wxyz;
    DQuat::from_xyzw(x, y, z, w)
}

/// Scalar part and vector part, `[w, x, y, z]`.
pub fn to_wxyz(q: DQuat) -> [f64; 4] {
    [q.w, q.x, q.y, q.z]
}

/// The quaternion scaled to length 1, or `None` when it is null or not finite.
pub fn normalized(q: DQuat) -> Option<DQuat> {
    let size = q.to_array().iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    if !(size > 0.0 && q.is_finite()) {
        return None;
    }
    // Two steps, so that neither a tiny nor a huge quaternion is lost in its square.
    let scaled = q / size;
    Some(scaled / scaled.dot(scaled).sqrt())
}

/// The rotation by `angle` radians about `axis`, of any length. A null or non-finite axis gives the identity.
pub fn from_axis_angle(axis: DVec3, angle: f64) -> DQuat {
    Space::normalized(axis).map_or(DQuat::IDENTITY, |axis| exp(axis * (0.5 * angle)))
}

/// Axis (a unit vector; null for no rotation) and angle in [0, π] of the rotation of a unit quaternion, accurate near 0
/// and near π. Within [`HALF_TURN`] of a half turn the first non-zero component of the axis is positive, and the angle
/// may exceed π by as much.
pub fn to_axis_angle(q: DQuat) -> (DVec3, f64) {
    let q = if q.w < 0.0 { -q } else { q };
    let vector = DVec3::new(q.x, q.y, q.z);
    let Some(axis) = Space::normalized(vector) else {
        return (DVec3::ZERO, 0.0);
    };
    let angle = 2.0 * math::atan2(Space::length(vector), q.w);
    if PI - angle <= HALF_TURN && !first_component_is_positive(axis) {
        (-axis, TAU - angle)
    } else {
        (axis, angle)
    }
}

/// [`to_axis_angle`] as a [`Turn`].
pub fn to_turn(q: DQuat) -> Turn<DVec3> {
    let (axis, angle) = to_axis_angle(q);
    Turn { axis, angle }
}

/// The unit quaternion of a rotation matrix, with scalar part not negative unless the largest part is another one.
pub fn from_matrix(m: &DMat3) -> DQuat {
    let [[xx, yx, zx], [xy, yy, zy], [xz, yz, zz]] = m.to_cols_array_2d();
    // Four times the squares of the parts; dividing by the largest keeps the digits of the others.
    let squares = [
        1.0 + xx + yy + zz,
        1.0 + xx - yy - zz,
        1.0 - xx + yy - zz,
        1.0 - xx - yy + zz,
    ];
    let largest = (1..4).fold(0, |l, i| if squares[i] > squares[l] { i } else { l });
    let s = squares[largest];
    let wxyz = match largest {
        0 => [s, zy - yz, xz - zx, yx - xy],
        1 => [zy - yz, s, yx + xy, xz + zx],
        2 => [xz - zx, yx + xy, s, zy + yz],
        _ => [yx - xy, xz + zx, zy + yz, s],
    };
    normalized(from_wxyz(wxyz)).unwrap_or(DQuat::IDENTITY)
}

/// The rotation matrix of a unit quaternion.
pub fn to_matrix(q: DQuat) -> DMat3 {
    let DQuat { x, y, z, w } = q;
    DMat3::from_cols(
        DVec3::new(
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y + z * w),
            2.0 * (x * z - y * w),
        ),
        DVec3::new(
            2.0 * (x * y - z * w),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z + x * w),
        ),
        DVec3::new(
            2.0 * (x * z + y * w),
            2.0 * (y * z - x * w),
            1.0 - 2.0 * (x * x + y * y),
        ),
    )
}

/// The smallest rotation that takes the direction of `from` to that of `to`; `None` when either is null or not finite.
/// Antiparallel directions: [`Rotational::turn_between`].
pub fn rotation_between(from: DVec3, to: DVec3) -> Option<DQuat> {
    let turn = DVec3::turn_between(from, to)?;
    Some(from_axis_angle(turn.axis, turn.angle))
}

/// The exponential of the pure quaternion `v`: the rotation about `v` by *twice* its length, in radians.
pub fn exp(v: DVec3) -> DQuat {
    let angle = Space::length(v);
    let (sin, cos) = math::sin_cos(angle);
    let v = if angle > 0.0 { v * (sin / angle) } else { v };
    DQuat::from_xyzw(v.x, v.y, v.z, cos)
}

/// The logarithm of a unit quaternion, a pure quaternion of length in [0, π]: `exp(ln(q)) = q`, sign included. That of
/// −1, which any direction would serve, goes along x.
pub fn ln(q: DQuat) -> DVec3 {
    let vector = DVec3::new(q.x, q.y, q.z);
    let length = Space::length(vector);
    let angle = math::atan2(length, q.w);
    match Space::normalized(vector) {
        Some(direction) => direction * angle,
        None if q.w < 0.0 => DVec3::X * PI,
        None => DVec3::ZERO,
    }
}

/// `q` or `−q`, the same rotation, whichever is nearer to `reference`; `q` itself when both are equally near.
pub fn nearer(reference: DQuat, q: DQuat) -> DQuat {
    if reference.dot(q) < 0.0 { -q } else { q }
}

/// Spherical linear interpolation of unit quaternions along the great arc from `a` (at `t = 0`) to `b` (at `t = 1`), at
/// constant speed; `t` outside [0, 1] continues the arc.
///
/// Takes the signs as they are: the arc to `b` and the arc to `−b` are the two ways round. For the shorter one pass
/// [`nearer`]`(a, b)`. From `q` to `−q` the arc goes through `q·i` (errata C8).
pub fn slerp(a: DQuat, b: DQuat, t: f64) -> DQuat {
    if t == 0.0 {
        return a;
    }
    if t == 1.0 {
        return b;
    }
    Arc::between(a, b).at(t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, far};

    fn random_quaternion(random: &mut Random) -> DQuat {
        let axis: DVec3 = random.direction();
        from_axis_angle(axis, random.between(-6.0, 6.0))
    }

    fn apart(a: DQuat, b: DQuat) -> f64 {
        let d = a - b;
        d.dot(d).sqrt()
    }

    #[test]
    fn matrices_and_back() {
        let mut random = Random::new(21);
        for step in 0..2000 {
            let q = match step % 2 {
                0 => random_quaternion(&mut random),
                _ => from_axis_angle(random.direction(), PI - math::powi(0.1, step % 17)),
            };
            let m = to_matrix(q);
            let back = from_matrix(&m);
            assert!(apart(nearer(q, back), q) < 1e-15 * 4.0);
            let (axis, angle) = to_axis_angle(q);
            assert!(far::<DVec3>(&<DVec3 as Space>::rotation(axis, angle), &m) < 4e-15);
            assert!((0.0..=PI + HALF_TURN).contains(&angle));
            // The order of products, and agreement with glam.
            let p = random_quaternion(&mut random);
            assert!(far::<DVec3>(&to_matrix(p * q), &(to_matrix(p) * m)) < 4e-15);
            assert!(far::<DVec3>(&DMat3::from_quat(q), &m) < 4e-15);
        }
    }

    #[test]
    fn logarithm_and_exponential_are_inverse() {
        let mut random = Random::new(22);
        for step in 0..2000 {
            let q = random_quaternion(&mut random);
            assert!(apart(exp(ln(q)), q) < 2e-15);
            let v: DVec3 = random.direction::<DVec3>() * math::powi(0.1, step % 200);
            assert!(Space::length(ln(exp(v)) - v) <= 1e-15 * Space::length(v) * 4.0);
        }
        assert_eq!(ln(-DQuat::IDENTITY), DVec3::X * PI);
        assert!(apart(exp(ln(-DQuat::IDENTITY)), -DQuat::IDENTITY) < 1e-15);
        assert_eq!(exp(DVec3::ZERO), DQuat::IDENTITY);
    }

    #[test]
    fn slerp_runs_evenly_along_the_arc() {
        let mut random = Random::new(23);
        for step in 0..1000 {
            let a = random_quaternion(&mut random);
            let b = match step % 4 {
                0 => random_quaternion(&mut random),
                // Nearly the same, nearly opposite.
                1 => a * exp(random.direction::<DVec3>() * math::powi(0.1, step % 15)),
                2 => -(a * exp(random.direction::<DVec3>() * math::powi(0.1, step % 15))),
                _ => nearer(a, random_quaternion(&mut random)),
            };
            let whole = 2.0 * math::atan2(apart(a, b), apart(a, -b));
            for t in [0.0, 0.1, 0.5, 0.7, 1.0] {
                let q = slerp(a, b, t);
                assert!((q.dot(q) - 1.0).abs() < 1e-14);
                let from_a = 2.0 * math::atan2(apart(a, q), apart(a, -q));
                let to_b = 2.0 * math::atan2(apart(q, b), apart(q, -b));
                // Nearly opposite ends have no plane to turn in: their whole way is rounded to a half turn.
                let slack = if step % 4 == 2 { 3e-12 } else { 2e-14 };
                assert!((from_a - t * whole).abs() < slack, "{step} {t}");
                assert!((from_a + to_b - whole).abs() < slack, "{step} {t}");
            }
            assert_eq!((slerp(a, b, 0.0), slerp(a, b, 1.0)), (a, b));
        }
    }

    #[test]
    fn errata_c8_opposite_quaternions_go_through_i() {
        let q = from_axis_angle(DVec3::new(1.0, 2.0, -1.0), 1.0);
        let middle = slerp(q, -q, 0.5);
        assert!(apart(middle, q * from_wxyz([0.0, 1.0, 0.0, 0.0])) < 1e-15);
        // A right angle keeps its sign.
        let i = from_wxyz([0.0, 1.0, 0.0, 0.0]);
        assert_eq!(nearer(DQuat::IDENTITY, i), i);
    }

    #[test]
    fn rotations_between_directions() {
        let mut random = Random::new(24);
        for _ in 0..500 {
            let (a, b): (DVec3, DVec3) = (random.direction(), random.direction());
            let q = rotation_between(a * 2.0, b).unwrap();
            assert!(Space::length(to_matrix(q).mul_vec3(a) - b) < 1e-14);
            let back = rotation_between(a, -a).unwrap();
            assert!(Space::length(to_matrix(back).mul_vec3(a) + a) < 1e-14);
        }
        assert!(rotation_between(DVec3::ZERO, DVec3::X).is_none());
    }

    #[test]
    fn bad_quaternions_are_refused() {
        assert!(normalized(from_wxyz([0.0; 4])).is_none());
        assert!(normalized(from_wxyz([f64::NAN, 0.0, 0.0, 1.0])).is_none());
        let tiny = normalized(from_wxyz([3e-200, 0.0, 4e-200, 0.0])).unwrap();
        assert!(apart(tiny, from_wxyz([0.6, 0.0, 0.8, 0.0])) < 1e-15);
        assert_eq!(
            to_wxyz(from_wxyz([1.0, 2.0, 3.0, 4.0])),
            [1.0, 2.0, 3.0, 4.0]
        );
        assert_eq!(from_axis_angle(DVec3::ZERO, 1.0), DQuat::IDENTITY);
    }
}
