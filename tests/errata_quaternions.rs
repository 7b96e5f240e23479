//! Rows of the errata on quaternions, pinned by name: what the formulas are, and what they are not.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::glam::{DQuat, DVec3};
use anamorph_tests::random::Random;
use anamorph_transforms::quaternion::{
    BezierPath, Ends, InnerPoints, Keys, Orientations, RotationSpline, SquadPath, bezier, bisect,
    double, exp, from_axis_angle, from_wxyz, inner_points, nearer, slerp, squad,
};
use core::f64::consts::PI;

fn apart(a: DQuat, b: DQuat) -> f64 {
    let d = a - b;
    d.dot(d).sqrt()
}

fn about(axis: DVec3, angle: f64) -> DQuat {
    from_axis_angle(axis, angle)
}

fn orientation(random: &mut Random) -> DQuat {
    let axis: DVec3 = random.vector();
    about(axis, random.between(-PI, PI))
}

/// C7: every level of de Casteljau's construction takes its own neighbours, `t23 = slerp(t2, t3)`.
#[test]
fn c7_de_casteljau_on_quaternions() {
    let mut random = Random::new(7);
    for _ in 0..50 {
        let q: [DQuat; 4] = std::array::from_fn(|_| orientation(&mut random));
        let u = random.between(0.0, 1.0);
        let (t1, t2, t3) = (
            slerp(q[0], q[1], u),
            slerp(q[1], q[2], u),
            slerp(q[2], q[3], u),
        );
        let (t12, t23) = (slerp(t1, t2, u), slerp(t2, t3, u));
        assert!(apart(bezier(&q, u).unwrap(), slerp(t12, t23, u)) < 1e-15);
        // The printed one, `t23 = slerp(t12, …)`, is another point.
        let printed = slerp(t12, slerp(t12, t3, u), u);
        assert!(apart(printed, slerp(t12, t23, u)) > 1e-6);
        // The ends, where the printed one happens to be right at one only.
        assert!(apart(bezier(&q, 0.0).unwrap(), q[0]) < 1e-15);
        assert!(apart(bezier(&q, 1.0).unwrap(), q[3]) < 1e-15);
    }
}

/// C8: inner points a third of the way; equal keys then turn evenly, and as printed stall amid every segment.
#[test]
fn c8_a_third_of_the_way() {
    let mut random = Random::new(8);
    for _ in 0..50 {
        let axis = random.vector::<DVec3>().normalize();
        let step = random.between(0.1, 3.1);
        let keys: Vec<DQuat> = (0..5).map(|i| about(axis, step * f64::from(i))).collect();
        let keys = Keys::even(&keys).unwrap();
        let (thirds, printed) = (
            BezierPath::new(&keys),
            BezierPath::with_inner_points(&keys, InnerPoints::AsPrinted),
        );
        for i in 0..=40 {
            let t = f64::from(i) / 10.0;
            assert!((thirds.angular_velocity(t) - axis * step).length() < 1e-11);
        }
        for t in [1.5, 2.5] {
            assert!(printed.angular_velocity(t).length() < 1e-11);
        }
        assert!((printed.angular_velocity(2.0) - axis * (3.0 * step)).length() < 1e-10);
    }
    // In general: the printed point, a third of the way out, and its double for the other side.
    for _ in 0..50 {
        let previous = orientation(&mut random);
        let key = nearer(previous, orientation(&mut random));
        let next = nearer(key, orientation(&mut random));
        let whole = bisect(double(previous, key), next);
        let [b, a] = inner_points(previous, key, next, [2.0, 2.0], InnerPoints::Thirds);
        assert!(apart(a, slerp(key, whole, 1.0 / 3.0)) < 1e-14);
        assert!(apart(b, double(a, key)) < 1e-14);
        let [_, a] = inner_points(previous, key, next, [2.0, 2.0], InnerPoints::AsPrinted);
        assert!(apart(a, whole) < 1e-14);
    }
}

/// C8: opposite quaternions and right angles.
#[test]
fn c8_opposite_quaternions_and_half_turns() {
    let q = about(DVec3::new(0.3, -1.0, 2.0), 1.1);
    let through = q * from_wxyz([0.0, 1.0, 0.0, 0.0]);
    assert!(apart(bisect(q, -q), through) < 1e-15);
    assert!(apart(slerp(q, -q, 0.5), through) < 1e-15);
    // Within an inner point: the key.
    let half = about(DVec3::Z, PI) * q;
    let inner = inner_points(half, q, half, [1.0, 1.0], InnerPoints::Thirds);
    assert_eq!(inner, [q; 2]);
    // Dot product 0 keeps the sign.
    for sign in [1.0, -1.0] {
        let key = from_wxyz([0.0, 0.0, sign, 0.0]);
        assert_eq!(nearer(DQuat::IDENTITY, key), key);
    }
    // The return of a closed sequence is ±q₀ by the same rule.
    let keys: Vec<DQuat> = (0..4)
        .map(|i| about(DVec3::Y, 1.5 * f64::from(i)))
        .collect();
    let closed = Keys::closed_even(&keys).unwrap();
    assert_eq!(closed.keys()[4], -keys[0]);
    let path = BezierPath::new(&closed);
    let off = path.angular_velocity(0.0) - path.angular_velocity(4.0_f64.next_down());
    assert!(off.length() < 1e-12);
}

/// C9: at an end the missing neighbour is the other one reflected in the key.
#[test]
fn c9_end_controls() {
    let mut random = Random::new(9);
    for _ in 0..50 {
        let keys: Vec<DQuat> = (0..4).map(|_| orientation(&mut random)).collect();
        let keys = Keys::new(&keys, &[0.0, 2.0, 2.5, 4.0]).unwrap();
        let path = BezierPath::new(&keys);
        let q = keys.keys();
        let [first, last] = [path.controls(0).unwrap(), path.controls(2).unwrap()];
        let whole = bisect(double(double(q[1], q[0]), q[0]), q[1]);
        assert!(apart(first[1], slerp(q[0], whole, 1.0 / 3.0)) < 1e-14);
        assert!(apart(first[1], slerp(q[0], q[1], 1.0 / 3.0)) < 1e-14);
        assert!(apart(last[2], slerp(q[3], q[2], 1.0 / 3.0)) < 1e-14);
    }
}

/// C15: with unequal times the angular velocity at a key is the whole turn over the whole time, on both sides.
#[test]
fn c15_unequal_key_times() {
    let mut random = Random::new(15);
    for round in 0..60 {
        let keys: Vec<DQuat> = (0..5).map(|_| orientation(&mut random)).collect();
        let mut t = 0.0;
        let times: Vec<f64> = (0..6)
            .map(|_| {
                t += random.between(0.05, 3.0);
                t
            })
            .collect();
        let keys = match round % 2 {
            0 => Keys::new(&keys, &times[..5]).unwrap(),
            _ => Keys::closed(&keys, &times).unwrap(),
        };
        let q = keys.keys();
        for path in [
            Box::new(BezierPath::new(&keys)) as Box<dyn Orientations>,
            Box::new(SquadPath::new(&keys)),
        ] {
            for &key in &times[1..4] {
                let after = path.angular_velocity(key);
                let before = path.angular_velocity(key.next_down());
                assert!((before - after).length() < 1e-10 * (1.0 + after.length()));
            }
        }
        // Half the turn from previous to next, from the key, in half the time; not the parabola's velocity.
        let half = bisect(double(q[0], q[1]), q[2]) * q[1].conjugate();
        let turn = anamorph_transforms::quaternion::ln(half) * 2.0;
        let velocity = turn * (2.0 / (times[2] - times[0]));
        let found = BezierPath::new(&keys).angular_velocity(times[1]);
        assert!((velocity - found).length() < 1e-10 * (1.0 + found.length()));
    }
}

/// C15: squad's slerps take the signs as they are; flipped, the curve would jump where two inner points are just a right
/// angle apart.
#[test]
fn c15_squad_does_not_flip() {
    let (a, b) = (DQuat::IDENTITY, about(DVec3::X, 0.5));
    let inner = |angle: f64| about(DVec3::Y, angle);
    for t in [0.25, 0.5, 0.75] {
        // Twice a right angle on the sphere is an angle of π.
        let before = squad(a, a, inner(PI - 1e-9), b, t);
        let after = squad(a, a, inner(PI + 1e-9), b, t);
        assert!(apart(before, after) < 1e-8);
    }
    // Shoemake's formula, for equal times.
    let mut random = Random::new(16);
    let mut q = orientation(&mut random);
    let keys: Vec<DQuat> = (0..4)
        .map(|_| {
            q *= exp(random.vector::<DVec3>() * 0.5);
            q
        })
        .collect();
    let ln = anamorph_transforms::quaternion::ln;
    let inner = |i: usize| {
        let inverse = keys[i].conjugate();
        keys[i] * exp((ln(inverse * keys[i + 1]) + ln(inverse * keys[i - 1])) * -0.25)
    };
    let path = SquadPath::new(&Keys::even(&keys).unwrap());
    for i in 0..=10 {
        let x = f64::from(i) / 10.0;
        let wanted = squad(keys[1], inner(1), inner(2), keys[2], x);
        let found = path.orientation(1.0 + x);
        assert!(apart(nearer(wanted, found), wanted) < 1e-14);
    }
}

/// C15: the rotation spline's angular acceleration is continuous, with unequal times; that of Bézier segments is not.
#[test]
fn c15_a_rotation_spline_of_class_c2() {
    let mut random = Random::new(17);
    let keys: Vec<DQuat> = (0..8).map(|_| orientation(&mut random)).collect();
    let times = [0.0, 0.4, 1.4, 1.7, 3.0, 3.5, 4.5, 5.0];
    let keys = Keys::new(&keys, &times).unwrap();
    // Greatest jump of the acceleration at an inner key, by one-sided differences.
    let jump = |path: &dyn Orientations| {
        let acceleration = |t: f64, h: f64| {
            let w = |k: f64| path.angular_velocity(t + k * h);
            (w(0.0) * -11.0 + w(1.0) * 18.0 - w(2.0) * 9.0 + w(3.0) * 2.0) / (6.0 * h)
        };
        times[1..7]
            .iter()
            .map(|&t| (acceleration(t, 1e-4) - acceleration(t.next_down(), -1e-4)).length())
            .fold(0.0, f64::max)
    };
    let spline = RotationSpline::new(&keys, Ends::NATURAL).unwrap();
    assert!(spline.is_settled());
    assert!(jump(&spline) < 1e-4, "{}", jump(&spline));
    assert!(jump(&BezierPath::new(&keys)) > 1.0);
    assert!(jump(&SquadPath::new(&keys)) > 1.0);
}
