//! What every path through orientations promises, and what the kinds promise each.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::glam::{DQuat, DVec3};
use anamorph_transforms::quaternion::{
    BezierPath, End, Ends, EvenTurning, InnerPoints, Keys, LerpPath, OrientationError,
    Orientations, RotationSpline, SlerpPath, SquadPath, from_axis_angle, slerp,
};
use std::f64::consts::PI;

struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
    fn axis(&mut self) -> DVec3 {
        loop {
            let v = DVec3::new(
                self.between(-1.0, 1.0),
                self.between(-1.0, 1.0),
                self.between(-1.0, 1.0),
            );
            if (0.01..1.0).contains(&v.length_squared()) {
                return v / v.length();
            }
        }
    }
    fn orientation(&mut self) -> DQuat {
        from_axis_angle(self.axis(), self.between(-PI, PI))
    }
    /// Keys with turns of at most `most` radians from one to the next.
    fn keys(&mut self, count: usize, most: f64) -> Vec<DQuat> {
        let mut q = self.orientation();
        (0..count)
            .map(|_| {
                q = from_axis_angle(self.axis(), self.between(0.1 * most, most)) * q;
                q
            })
            .collect()
    }
    fn times(&mut self, count: usize) -> Vec<f64> {
        let mut t = self.between(-5.0, 5.0);
        (0..count)
            .map(|_| {
                t += self.between(0.2, 2.0);
                t
            })
            .collect()
    }
}

/// The angle of the rotation from `a` to `b`, in radians.
fn turn(a: DQuat, b: DQuat) -> f64 {
    let (d, s) = (a - b, a + b);
    let (d, s) = (d.dot(d).sqrt(), s.dot(s).sqrt());
    4.0 * d.min(s).atan2(d.max(s))
}

fn kinds(keys: &Keys) -> Vec<(&'static str, Box<dyn Orientations>)> {
    vec![
        ("slerp", Box::new(SlerpPath::new(keys))),
        ("lerp", Box::new(LerpPath::new(keys))),
        ("bezier", Box::new(BezierPath::new(keys))),
        (
            "bezier as printed",
            Box::new(BezierPath::with_inner_points(keys, InnerPoints::AsPrinted)),
        ),
        ("squad", Box::new(SquadPath::new(keys))),
        (
            "spline",
            Box::new(RotationSpline::new(keys, Ends::NATURAL).unwrap()),
        ),
        (
            "spline, chords",
            Box::new(RotationSpline::new(keys, Ends::CHORDS).unwrap()),
        ),
        (
            "spline, rests",
            Box::new(RotationSpline::new(keys, Ends::RESTS).unwrap()),
        ),
    ]
}

/// Keys of several kinds, open and closed, with even and uneven times.
fn sequences(random: &mut Random) -> Vec<Keys> {
    let mut list = Vec::new();
    for count in [2, 3, 4, 9, 40] {
        for most in [0.3, 1.5, 3.0] {
            let keys = random.keys(count, most);
            let times = random.times(count + 1);
            list.push(Keys::new(&keys, &times[..count]).unwrap());
            list.push(Keys::even(&keys).unwrap());
            list.push(Keys::closed(&keys, &times).unwrap());
            list.push(Keys::closed_even(&keys).unwrap());
        }
    }
    list
}

fn samples(path: &dyn Orientations) -> Vec<f64> {
    let spans = path.times().windows(2);
    spans
        .flat_map(|pair| (0..8).map(|i| pair[0] + (pair[1] - pair[0]) * f64::from(i) / 8.0))
        .collect()
}

#[test]
fn paths_pass_their_keys_as_unit_quaternions() {
    let mut random = Random(1);
    for keys in sequences(&mut random) {
        for (name, path) in kinds(&keys) {
            for (&t, &q) in keys.times().iter().zip(keys.keys()) {
                assert!(turn(path.orientation(t), q) < 1e-12, "{name} at {t}");
            }
            for t in samples(&path) {
                let q = path.orientation(t);
                assert!((q.dot(q) - 1.0).abs() < 1e-14, "{name} at {t}");
            }
        }
    }
}

#[test]
fn angular_velocity_is_the_derivative() {
    let mut random = Random(2);
    for keys in sequences(&mut random) {
        for (name, path) in kinds(&keys) {
            for (i, t) in samples(&path).into_iter().enumerate() {
                if i % 8 == 0 {
                    continue; // at a key there may be a corner
                }
                let h = 1e-5;
                let (a, b) = (path.orientation(t - h), path.orientation(t + h));
                let turn = ((b - a) / (2.0 * h)) * path.orientation(t).conjugate();
                let measured = DVec3::new(turn.x, turn.y, turn.z) * 2.0;
                let velocity = path.angular_velocity(t);
                let off = (measured - velocity).length();
                assert!(
                    off < 2e-6 * (1.0 + velocity.length().powi(3)),
                    "{name} at {t}: {off:e}"
                );
            }
        }
    }
}

/// The angular velocity just before and just after inner key `i` (of a closed path, of the first key too).
fn around(path: &dyn Orientations, i: usize) -> (DVec3, DVec3) {
    let times = path.times();
    let before = if i == 0 {
        times[times.len() - 1]
    } else {
        times[i]
    };
    (
        path.angular_velocity(before.next_down()),
        path.angular_velocity(times[i]),
    )
}

#[test]
fn c5_angular_velocity_is_continuous_at_the_keys() {
    let mut random = Random(3);
    for keys in sequences(&mut random) {
        for (name, path) in kinds(&keys) {
            if matches!(name, "slerp" | "lerp") {
                continue;
            }
            for i in usize::from(!keys.is_closed())..keys.times().len() - 1 {
                let (before, after) = around(&path, i);
                let off = (before - after).length();
                assert!(
                    off <= 1e-10 * (1.0 + after.length()),
                    "{name}, key {i}: {before} and {after}"
                );
            }
        }
    }
}

#[test]
fn c15_the_velocity_at_a_key_is_the_turn_over_the_whole_time() {
    // On one axis the rule can be read off: (2 + 1) radians in (0.5 + 3) units of time.
    let about = |angle: f64| from_axis_angle(DVec3::Z, angle);
    let keys = Keys::new(&[about(0.0), about(2.0), about(3.0)], &[0.0, 0.5, 3.5]).unwrap();
    for path in [
        Box::new(BezierPath::new(&keys)) as Box<dyn Orientations>,
        Box::new(SquadPath::new(&keys)),
    ] {
        let (before, after) = around(&path, 1);
        for velocity in [before, after] {
            assert!((velocity - DVec3::Z * (3.0 / 3.5)).length() < 1e-12);
        }
    }
}

#[test]
fn the_spline_has_a_continuous_angular_acceleration() {
    let mut random = Random(4);
    let mut settled = 0;
    for keys in sequences(&mut random) {
        for ends in [Ends::NATURAL, Ends::CHORDS, Ends::RESTS] {
            let path = RotationSpline::new(&keys, ends).unwrap();
            settled += usize::from(path.is_settled());
            let times = keys.times();
            for i in usize::from(!keys.is_closed())..times.len() - 1 {
                // One-sided differences of third order.
                let h = 1e-4;
                let slope = |t: f64, h: f64| {
                    let w = |k: f64| path.angular_velocity(t + k * h);
                    (w(0.0) * -11.0 + w(1.0) * 18.0 - w(2.0) * 9.0 + w(3.0) * 2.0) / (6.0 * h)
                };
                let end = if i == 0 {
                    times[times.len() - 1]
                } else {
                    times[i]
                };
                let (before, after) = (slope(end.next_down(), -h), slope(times[i], h));
                let size = 1.0 + before.length() + path.angular_velocity(times[i]).length();
                assert!(
                    (before - after).length() < 1e-6 * size * size * size,
                    "key {i}: {before} and {after}"
                );
            }
            if ends == Ends::NATURAL && !keys.is_closed() {
                for (t, h) in [(times[0], 1e-5), (times[times.len() - 1], -1e-5)] {
                    let w = |k: f64| path.angular_velocity(t + k * h);
                    let slope = (w(0.0) * -1.5 + w(1.0) * 2.0 - w(2.0) * 0.5) / h;
                    assert!(slope.length() < 1e-4 * (1.0 + w(0.0).length().powi(3)));
                }
            }
        }
    }
    // Only uneven spans may leave the equations open.
    assert!(settled > 150, "{settled}");
}

#[test]
fn given_rates_hold_at_the_ends() {
    let mut random = Random(5);
    let keys = Keys::new(&random.keys(6, 2.0), &random.times(6)).unwrap();
    let (a, b) = (random.axis() * 2.0, random.axis() * 0.5);
    let ends = Ends {
        start: End::Rate(a),
        end: End::Rate(b),
    };
    let path = RotationSpline::new(&keys, ends).unwrap();
    let [start, end] = path.domain();
    assert!((path.angular_velocity(start) - a).length() < 1e-12);
    assert!((path.angular_velocity(end) - b).length() < 1e-12);
    for bad in [f64::NAN, f64::INFINITY, 1e31] {
        let ends = Ends {
            start: End::Natural,
            end: End::Rate(DVec3::X * bad),
        };
        assert_eq!(
            RotationSpline::new(&keys, ends),
            Err(OrientationError::Rate { end: "end" })
        );
    }
}

#[test]
fn even_keys_turn_evenly() {
    let axis = DVec3::new(2.0, -1.0, 2.0) / 3.0;
    for step in [0.05, 1.0, 2.0, 3.1] {
        let keys: Vec<DQuat> = (0..9)
            .map(|i| from_axis_angle(axis, step * f64::from(i)))
            .collect();
        let even = Keys::even(&keys).unwrap();
        // The same rate with uneven times.
        let at = [0.0, 0.3, 0.9, 1.0];
        let uneven: Vec<DQuat> = at.iter().map(|t| from_axis_angle(axis, step * t)).collect();
        let uneven = Keys::new(&uneven, &at).unwrap();
        for keys in [even, uneven] {
            for (name, path) in kinds(&keys) {
                if matches!(name, "lerp" | "bezier as printed" | "spline, rests") {
                    continue;
                }
                for t in samples(&path) {
                    let wanted = from_axis_angle(axis, step * t);
                    assert!(turn(path.orientation(t), wanted) < 1e-12, "{name} at {t}");
                    let off = path.angular_velocity(t) - axis * step;
                    assert!(off.length() < 1e-11, "{name} at {t}: {off}");
                }
            }
        }
    }
}

#[test]
fn frames_and_signs_do_not_matter() {
    let mut random = Random(6);
    for round in 0..12 {
        let count = 3 + round % 5;
        let given = random.keys(count, 2.5);
        let times = random.times(count + 1);
        let make = |given: &[DQuat]| match round % 2 {
            0 => Keys::new(given, &times[..count]).unwrap(),
            _ => Keys::closed(given, &times).unwrap(),
        };
        let left = random.orientation();
        let right = random.orientation();
        let turned: Vec<DQuat> = given.iter().map(|&q| left * q * right).collect();
        let flipped: Vec<DQuat> = given
            .iter()
            .map(|&q| q * [1.0, -3.0][usize::from(random.between(0.0, 1.0) > 0.5)])
            .collect();
        let (plain, turned, flipped) = (make(&given), make(&turned), make(&flipped));
        let rows = kinds(&plain).into_iter().zip(kinds(&turned));
        for (((name, path), (_, turned)), (_, flipped)) in rows.zip(kinds(&flipped)) {
            if name == "spline, rests" && round % 2 == 0 {
                // Rests are rests in every frame, too.
                assert!(turned.angular_velocity(times[0]).length() < 1e-12);
            }
            for t in samples(&path) {
                let q = path.orientation(t);
                assert!(
                    turn(turned.orientation(t), left * q * right) < 1e-11,
                    "{name}"
                );
                assert!(turn(flipped.orientation(t), q) < 1e-11, "{name}");
            }
        }
    }
}

#[test]
fn batches_are_the_single_queries() {
    let mut random = Random(7);
    for keys in sequences(&mut random) {
        let [start, end] = SlerpPath::new(&keys).domain();
        let mut times: Vec<f64> = (0..300)
            .map(|_| random.between(start - 2.0, end + 2.0))
            .collect();
        times.extend(keys.times());
        times.extend([f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300]);
        let mut out = vec![DQuat::IDENTITY; times.len()];
        for (name, path) in kinds(&keys) {
            path.orientations(&times, &mut out).unwrap();
            for (&t, q) in times.iter().zip(&out) {
                let single = path.orientation(t).to_array().map(f64::to_bits);
                assert_eq!(q.to_array().map(f64::to_bits), single, "{name} at {t}");
                assert!((q.dot(*q) - 1.0).abs() < 1e-14, "{name} at {t}");
            }
            assert_eq!(
                path.orientations(&times, &mut out[1..]),
                Err(OrientationError::Room {
                    times: times.len(),
                    out: times.len() - 1
                })
            );
        }
    }
}

#[test]
fn singular_keys_have_answers() {
    let q = from_axis_angle(DVec3::new(1.0, 2.0, 3.0), 0.7);
    let half = from_axis_angle(DVec3::Y, PI) * q;
    let near = from_axis_angle(DVec3::X, 1e-9) * q;
    let nearly_half = from_axis_angle(DVec3::Y, PI - 1e-9) * q;
    let hard: Vec<Vec<DQuat>> = vec![
        vec![q],
        vec![q, q],
        vec![q, -q],
        vec![q, q, q, -q],
        vec![q, half],
        vec![q, half, q, -half],
        vec![q, half, -q, half],
        vec![q, near, q, near],
        vec![q, nearly_half, q, near, half],
        vec![q, q, half, half, near],
    ];
    for given in hard {
        let count = given.len();
        for scale in [1.0, 1e-6, 1e6] {
            for uneven in [1.0, 1e-6, 1e6, 1e12] {
                let mut t = 0.0;
                let times: Vec<f64> = (0..=count)
                    .map(|i| {
                        t += scale * if i % 2 == 1 { uneven } else { 1.0 };
                        t
                    })
                    .collect();
                for keys in [
                    Keys::new(&given, &times[..count]).unwrap(),
                    Keys::closed(&given, &times).unwrap(),
                ] {
                    for (name, path) in kinds(&keys) {
                        let mut times = samples(&path);
                        times.extend_from_slice(keys.times());
                        times.extend([-1.0, 0.0, 1e9, f64::NAN]);
                        for t in times {
                            let q = path.orientation(t);
                            assert!((q.dot(q) - 1.0).abs() < 1e-13, "{name} {given:?} at {t}");
                            let velocity = path.angular_velocity(t);
                            assert!(velocity.is_finite(), "{name} {given:?} at {t}");
                            if count == 1 {
                                assert!(turn(q, given[0]) < 1e-15);
                                assert!(velocity.length() * scale.min(1.0) < 1e-15);
                            }
                        }
                        for (&t, &q) in keys.times().iter().zip(keys.keys()) {
                            let off = turn(path.orientation(t), q);
                            assert!(
                                off < 1e-11,
                                "{name} {given:?} {scale} {uneven} at {t}: {off}"
                            );
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn slerp_paths_are_slerp() {
    let mut random = Random(8);
    let keys = Keys::new(&random.keys(7, 3.0), &random.times(7)).unwrap();
    let path = SlerpPath::new(&keys);
    for (pair, times) in keys.keys().windows(2).zip(keys.times().windows(2)) {
        for i in 0..10 {
            let x = f64::from(i) / 10.0;
            let t = times[0] + (times[1] - times[0]) * x;
            assert!(turn(path.orientation(t), slerp(pair[0], pair[1], x)) < 1e-13);
        }
    }
}

#[test]
fn c5_equal_angles_are_equal_steps() {
    let mut random = Random(9);
    let mut lists = sequences(&mut random);
    lists.retain(|keys| keys.keys().len() < 12);
    for keys in lists {
        for (name, path) in kinds(&keys) {
            let even = EvenTurning::new(&path, 1e-9).unwrap();
            let total = even.total();
            // The tolerance is on the angle: measure it by an independent, fine sum of chords.
            let mut angle = 0.0;
            for i in 1..=7 {
                let (a, b) = (f64::from(i - 1) / 7.0, f64::from(i) / 7.0);
                let (from, to) = (even.time_at(total * a), even.time_at(total * b));
                let measured = even.angle_at(to) - even.angle_at(from);
                assert!((measured - total / 7.0).abs() < 4e-9, "{name}: {measured}");
                let mut stops = vec![from];
                stops.extend(path.times().iter().filter(|&&t| t > from && t < to));
                stops.push(to);
                let chords = |n: u32| {
                    let between = |ends: &[f64]| {
                        let (start, step) = (ends[0], (ends[1] - ends[0]) / f64::from(n));
                        let at = |k: u32| path.orientation(start + step * f64::from(k));
                        (0..n).map(|k| turn(at(k), at(k + 1))).sum::<f64>()
                    };
                    stops.windows(2).map(between).sum::<f64>()
                };
                // Richardson: chords err by the square of their length.
                let (coarse, fine) = (chords(200), chords(400));
                let chord = fine + (fine - coarse) / 3.0;
                assert!(
                    (chord / (total / 7.0) - 1.0).abs() < 1e-5,
                    "{name}: {chord} of {}",
                    total / 7.0
                );
                angle += measured;
            }
            assert!((angle - total).abs() < 1e-9);
        }
    }
}

#[test]
fn angles_and_times_are_inverse() {
    let mut random = Random(10);
    let keys = Keys::new(&random.keys(8, 2.0), &random.times(8)).unwrap();
    for accuracy in [1e-4, 1e-9, 1e-12] {
        for (name, path) in kinds(&keys) {
            let even = EvenTurning::new(&path, accuracy).unwrap();
            let exact = EvenTurning::new(&path, 1e-13).unwrap();
            assert!((even.total() - exact.total()).abs() <= accuracy, "{name}");
            for _ in 0..60 {
                let angle = random.between(0.0, even.total());
                let off = exact.angle_at(even.time_at(angle)) - angle;
                assert!(off.abs() <= accuracy, "{name}: {off:e}");
                // As a path of its own it turns at speed 1.
                let velocity = even.angular_velocity(angle);
                assert!((velocity.length() - 1.0).abs() < 1e-12 || velocity == DVec3::ZERO);
            }
        }
    }
}

/// To and fro about one axis, a hundred million times: refused rather than measured for hours.
struct Trembling;

impl Orientations for Trembling {
    fn times(&self) -> &[f64] {
        &[0.0, 1.0]
    }
    fn is_closed(&self) -> bool {
        false
    }
    fn orientation(&self, t: f64) -> DQuat {
        from_axis_angle(DVec3::X, (1e8 * t).sin())
    }
    fn angular_velocity(&self, t: f64) -> DVec3 {
        DVec3::X * (1e8 * (1e8 * t).cos())
    }
}

#[test]
fn even_turning_has_answers_where_nothing_turns() {
    let q = DQuat::IDENTITY;
    let turned = from_axis_angle(DVec3::X, 1.0);
    let rest = EvenTurning::new(SlerpPath::new(&Keys::even(&[q, q, q]).unwrap()), 1e-9).unwrap();
    assert_eq!(rest.total(), 0.0);
    assert_eq!(rest.orientation(0.3), q);
    let one = EvenTurning::new(SlerpPath::new(&Keys::even(&[q]).unwrap()), 1e-9).unwrap();
    assert_eq!((one.total(), one.orientation(5.0)), (0.0, q));
    // A rest amid the path, and one at its end: their first times.
    let keys = Keys::even(&[q, turned, turned, turned * turned, turned * turned]).unwrap();
    let path = EvenTurning::new(SlerpPath::new(&keys), 1e-9).unwrap();
    assert!((path.total() - 2.0).abs() < 1e-12);
    assert!((path.time_at(1.0) - 1.0).abs() < 1e-9);
    assert_eq!(path.time_at(2.0), 3.0);
    assert!((path.time_at(1.5) - 2.5).abs() < 1e-9);
    for t in [f64::NAN, -1.0] {
        assert_eq!((path.angle_at(t), path.time_at(t)), (0.0, 0.0));
    }
    for accuracy in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            EvenTurning::new(&path, accuracy),
            Err(OrientationError::Accuracy { .. })
        ));
    }
    assert!(matches!(
        EvenTurning::new(Trembling, 1e-9),
        Err(OrientationError::TooWild { .. })
    ));
}

#[test]
fn the_farthest_spans_and_rates_give_numbers() {
    let mut random = Random(12);
    let ends = [Ends::NATURAL, Ends::CHORDS, Ends::RESTS];
    let fast = Ends {
        start: End::Rate(DVec3::new(1e30, -1e30, 1e29)),
        end: End::Rate(DVec3::new(-1e30, 1e20, 1e30)),
    };
    for times in [
        [0.0, 1e-30, 1e30, 1.5e30, 2e30],
        [-2e30, -1e30, 0.0, 1e-30, 2e-30],
        [0.0, 1.0, 2.0, 3.0, 4.0],
    ] {
        for closed in [false, true] {
            let keys = match closed {
                false => Keys::new(&random.keys(5, 3.0), &times),
                true => Keys::closed(&random.keys(4, 3.0), &times),
            };
            let keys = keys.unwrap();
            let mut paths = kinds(&keys);
            for ends in ends.into_iter().chain([fast]) {
                let spline = RotationSpline::new(&keys, ends).unwrap();
                paths.push(("spline", Box::new(spline)));
            }
            for (name, path) in paths {
                for t in samples(&path).into_iter().chain(times) {
                    let q = path.orientation(t);
                    assert!((q.dot(q) - 1.0).abs() < 1e-13, "{name} at {t}: {q:?}");
                    assert!(path.angular_velocity(t).is_finite(), "{name} at {t}");
                }
            }
        }
    }
}

/// Where spans are so uneven that the cubic equations have no solution worth having, the path stays C² and near its keys.
#[test]
fn very_uneven_spans_stay_tame() {
    let mut random = Random(11);
    for uneven in [1e6, 1e9, 1e12] {
        for _ in 0..20 {
            let mut t = 0.0;
            let times: Vec<f64> = (0..8)
                .map(|i| {
                    t += if i % 3 == 1 { 1.0 / uneven } else { 1.0 };
                    t
                })
                .collect();
            let keys = Keys::new(&random.keys(8, 2.5), &times).unwrap();
            let path = RotationSpline::new(&keys, Ends::NATURAL).unwrap();
            assert!(!path.is_settled());
            let shortest = SlerpPath::new(&keys);
            for t in samples(&path) {
                // Not a round beyond the great arc: the spline goes on where the keys go.
                let speed = path.angular_velocity(t).length();
                assert!(speed <= 4.0 * shortest.angular_velocity(t).length() + 6.0);
            }
            for i in 1..times.len() - 1 {
                let (before, after) = around(&path, i);
                // The neighbouring number is a time at which a short span has gone on already.
                assert!((before - after).length() < 1e-14 * uneven * uneven);
            }
        }
    }
}
