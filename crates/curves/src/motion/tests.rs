//! Laws of all speed controls, what each promises, every finding on a motion that has it and one that lacks it.

use super::*;
use crate::eases::{
    Back, Bounce, Circular, ConstantAcceleration, Cubic, CubicBezier, Directed, Direction, Linear,
    Power, Quintic, Sinusoidal, StepPosition, Steps, Stops, registry,
};

/// Marsaglia's xorshift, between two numbers.
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
    /// Increasing times from about 0 on.
    fn times(&mut self, count: usize) -> Vec<f64> {
        let mut time = 0.0;
        (0..count)
            .map(|_| {
                let now = time;
                time += self.between(0.05, 1.5);
                now
            })
            .collect()
    }
    fn distances(&mut self, count: usize, rising: bool) -> Vec<DistanceKey> {
        let times = self.times(count);
        let mut distance = 0.0;
        times
            .into_iter()
            .map(|time| {
                let here = distance;
                distance += if rising && self.between(0.0, 1.0) < 0.8 {
                    self.between(0.0, 2.0)
                } else if rising {
                    0.0
                } else {
                    self.between(-1.0, 1.0)
                };
                let asked = self.between(-1.0, 1.0);
                DistanceKey {
                    time,
                    distance: here,
                    speed: (asked > 0.0).then(|| 10f64.powf(6.0 * asked - 3.0)),
                }
            })
            .collect()
    }
}

fn keys(list: &[(f64, f64)]) -> Vec<DistanceKey> {
    list.iter().map(|&(t, d)| DistanceKey::new(t, d)).collect()
}

fn monotone(list: &[(f64, f64)]) -> DistanceTime {
    DistanceTime::monotone(&keys(list)).unwrap()
}

fn eased<E: Ease>(ease: E) -> Eased<E> {
    Eased::new(ease, 1.0, 1.0).unwrap()
}

fn controls() -> Vec<Box<dyn SpeedControl>> {
    let mut random = Random(17);
    let mut all: Vec<Box<dyn SpeedControl>> = Vec::new();
    for count in 2..12 {
        let distances = random.distances(count, count % 2 == 0);
        all.push(Box::new(DistanceTime::monotone(&distances).unwrap()));
        all.push(Box::new(DistanceTime::free(&distances).unwrap()));
        let times = random.times(count);
        for between in [Between::Linear, Between::Smooth, Between::Hold] {
            let speeds: Vec<SpeedKey> = times
                .iter()
                .map(|&time| SpeedKey::free(time + 0.3, random.between(0.1, 2.0)))
                .collect();
            all.push(Box::new(SpeedTime::new(&speeds, 5.0, between).unwrap()));
            let pushes: Vec<AccelerationKey> = times
                .iter()
                .map(|&time| AccelerationKey::free(time + 0.3, random.between(0.1, 2.0)))
                .collect();
            let pushed = AccelerationTime::new(&pushes, 0.2, None, 100.0, between);
            all.push(Box::new(pushed.unwrap()));
        }
    }
    all.push(Box::new(Eased::new(Sinusoidal, 2.5, -7.0).unwrap()));
    all.push(Box::new(eased(Directed::new(Circular, Direction::InOut))));
    all.push(Box::new(eased(Steps::STEP_START)));
    all
}

#[test]
fn derivatives_are_difference_quotients_and_nothing_is_strange() {
    for control in controls() {
        let (end, breaks) = (control.duration(), control.breaks());
        assert_eq!(breaks[0], 0.0);
        assert_eq!(breaks[breaks.len() - 1], end);
        assert!(breaks.windows(2).all(|pair| pair[0] < pair[1]));
        for i in 0..500 {
            let (t, h) = (end * (f64::from(i) + 0.37) / 500.0, 1e-5 * end);
            if breaks.iter().any(|b| (b - t).abs() <= 2.0 * h) || t < h || t > end - h {
                continue;
            }
            let slope = |f: &dyn Fn(f64) -> f64| (f(t + h) - f(t - h)) / (2.0 * h);
            let speed = slope(&|t| control.distance(t));
            let rate = slope(&|t| control.speed(t));
            let size = control.speed(t).abs() + control.acceleration(t).abs() + 1.0;
            // Steep ramps and the ends of circles bend within the step.
            let bend = (control.acceleration(t + h) - control.acceleration(t - h)).abs();
            assert!(
                (speed - control.speed(t)).abs() < 1e-6 * size + bend * h,
                "{control:?} at {t}"
            );
            assert!(
                (rate - control.acceleration(t)).abs() < 1e-5 * size + bend,
                "{control:?} at {t}"
            );
        }
        for t in [f64::NAN, -1.0, f64::NEG_INFINITY] {
            assert_eq!(control.distance(t), control.distance(0.0));
            assert_eq!(control.speed(t), 0.0);
            assert_eq!(control.acceleration(t), 0.0);
        }
        for t in [end + 1.0, f64::INFINITY] {
            assert_eq!(control.distance(t), control.distance(end));
            assert_eq!(control.speed(t), 0.0);
        }
    }
}

#[test]
fn monotone_motion_never_turns_round_between_keys_and_keeps_speeds() {
    let mut random = Random(5);
    for round in 0..400 {
        let rising = round % 2 == 0;
        let keys = random.distances(2 + round % 9, rising);
        let motion = DistanceTime::monotone(&keys).unwrap();
        for (index, key) in keys.iter().enumerate() {
            assert!((motion.distance(key.time) - key.distance).abs() < 1e-12);
            let change = motion.changes().iter().find(|change| change.key == index);
            let beside = keys[index.saturating_sub(1)..(index + 2).min(keys.len())].windows(2);
            let steps: Vec<f64> = beside
                .map(|pair| pair[1].distance - pair[0].distance)
                .collect();
            if let Some(asked) = key.speed {
                // Kept exactly unless a neighbour makes it impossible; all asked for are positive.
                let possible = steps.iter().all(|&step| step > 0.0);
                assert_eq!(change.is_none(), possible, "{keys:?}, {index}");
                let used = if possible { asked } else { 0.0 };
                let speed = motion.speed(key.time);
                assert!(
                    (speed - used).abs() <= 1e-12 * used.max(1.0),
                    "{speed} is not {used}"
                );
                if let Some(change) = change {
                    assert_eq!((change.asked, change.used), (asked, 0.0));
                }
            }
        }
        for pair in keys.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let way = (to.distance - from.distance).signum();
            let size = (to.distance - from.distance).abs();
            let mut last = from.distance;
            for i in 1..=300 {
                let t = from.time + (to.time - from.time) * f64::from(i) / 300.0;
                let here = motion.distance(t);
                assert!(
                    way * (here - last) >= -1e-13 * (1.0 + size),
                    "{keys:?} at {t}"
                );
                last = here;
            }
        }
        // Continuous speed, also within spans that are not cubics.
        for &b in &motion.breaks() {
            let (before, behind) = (motion.speed(b.next_down()), motion.speed(b));
            let inner = b > 0.0 && b < motion.duration();
            assert!(
                !inner || (before - behind).abs() < 1e-6 * (1.0 + behind.abs()),
                "{before} {behind}"
            );
        }
        // What never turns round between rising keys never backs up.
        if rising {
            let found = diagnose(&motion, motion.distance(motion.duration()));
            assert!(
                !found.iter().any(|f| matches!(f, Finding::BacksUp { .. })),
                "{found:?}"
            );
        }
    }
}

#[test]
fn extreme_speeds_do_not_spoil_the_distance() {
    for speed in [3.0, 3.1, 50.0, 1e6, 1e15, 1e30, 1e50] {
        let list = [
            DistanceKey::new(0.0, 0.0),
            DistanceKey::with_speed(1.0, 1.0, speed),
            DistanceKey::with_speed(2.0, 2.0, speed),
            DistanceKey::new(3.0, 3.0),
        ];
        let motion = DistanceTime::monotone(&list).unwrap();
        assert!(motion.changes().is_empty());
        let mut last = 0.0;
        for i in 0..=3000 {
            let here = motion.distance(f64::from(i) * 1e-3);
            assert!(
                here >= last - 1e-12 && here <= 3.0 + 1e-12,
                "{speed:e}: {here}"
            );
            last = here;
        }
        assert!((motion.distance(1.5) - 1.5).abs() < 1e-9);
    }
}

#[test]
fn changed_speeds_say_why() {
    let list = [
        DistanceKey::with_speed(0.0, 0.0, -1.0),
        DistanceKey::with_speed(1.0, 1.0, 2.0),
        DistanceKey::with_speed(2.0, 1.0, 0.0),
        DistanceKey::with_speed(3.0, 2.0, 0.5),
        DistanceKey::with_speed(4.0, 0.0, -0.5),
    ];
    let motion = DistanceTime::monotone(&list).unwrap();
    let causes: Vec<(usize, Cause)> = motion.changes().iter().map(|c| (c.key, c.cause)).collect();
    assert_eq!(
        causes,
        [(0, Cause::Sign), (1, Cause::Rest), (3, Cause::Turn)]
    );
    assert_eq!(
        motion.changes()[0].to_string(),
        "the speed of key 0 is 0 instead of -1: it would back up against the keys beside it"
    );
    // Going back is kept as it is keyed.
    assert!((motion.speed(4.0) + 0.5).abs() < 1e-12);
}

#[test]
fn free_motion_is_a_spline() {
    let mut random = Random(9);
    for count in 2..10 {
        let mut keys = random.distances(count, false);
        for key in &mut keys {
            key.speed = None;
        }
        let motion = DistanceTime::free(&keys).unwrap();
        for key in &keys {
            assert!((motion.distance(key.time) - key.distance).abs() < 1e-12);
            // Continuous acceleration, none at the ends.
            let inside = key.time > 0.0 && key.time < motion.duration();
            let wanted = if inside {
                motion.acceleration(key.time.next_down())
            } else {
                0.0
            };
            assert!((motion.acceleration(key.time) - wanted).abs() < 1e-9);
        }
        keys[count / 2].speed = Some(3.25);
        let motion = DistanceTime::free(&keys).unwrap();
        assert!((motion.speed(keys[count / 2].time) - 3.25).abs() < 1e-12);
    }
    // Even keys make even motion.
    let line =
        DistanceTime::free(&keys(&[(0.0, 0.0), (1.0, 2.0), (1.5, 3.0), (4.0, 8.0)])).unwrap();
    assert!((line.distance(2.2) - 4.4).abs() < 1e-14);
}

#[test]
fn speeds_cover_the_distance_exactly() {
    let list = [
        SpeedKey::free(0.0, 0.0),
        SpeedKey::free(1.0, 1.0),
        SpeedKey::fixed(2.0, 3.0),
        SpeedKey::free(4.0, 0.5),
    ];
    for between in [Between::Linear, Between::Smooth, Between::Hold] {
        let motion = SpeedTime::new(&list, 12.0, between).unwrap();
        assert_eq!(motion.distance(4.0), 12.0);
        assert!((motion.distance(4.0_f64.next_down()) - 12.0).abs() < 1e-13);
        assert!(
            (motion.speed(2.0) - 3.0).abs() < 1e-14,
            "a fixed speed stays"
        );
        assert!((motion.speed(1.0) - motion.factor()).abs() < 1e-14);
        // The distance is the area under the speed, span by span (Simpson's rule is exact for cubics).
        for (a, b) in [(0.0, 1.0), (1.0, 2.0), (2.0, 4.0)] {
            let (middle, inside) = (0.5 * (a + b), 1e-13);
            let area = motion.speed(a) + 4.0 * motion.speed(middle) + motion.speed(b - inside);
            let gained = motion.distance(b) - motion.distance(a);
            assert!((area * (b - a) / 6.0 - gained).abs() < 1e-11, "{between:?}");
        }
        // Speeds stay between those of the keys.
        for i in 0..=100 {
            let speed = motion.speed(0.04 * f64::from(i));
            assert!((-1e-15..=motion.factor().max(3.0) + 1e-14).contains(&speed));
        }
    }
    let drawn = SpeedTime::as_drawn(&list, Between::Linear).unwrap();
    assert!((drawn.distance(4.0) - (0.5 + 2.0 + 3.5)).abs() < 1e-14);
    // A motion back, within a total ahead.
    let back = [
        SpeedKey::free(0.0, 2.0),
        SpeedKey::free(1.0, -1.0),
        SpeedKey::free(2.0, 2.0),
    ];
    assert_eq!(
        SpeedTime::new(&back, 1.0, Between::Smooth)
            .unwrap()
            .distance(2.0),
        1.0
    );
}

#[test]
fn distances_out_of_reach_name_the_keys() {
    let message = |keys: &[SpeedKey], total: f64| {
        SpeedTime::new(keys, total, Between::Linear)
            .unwrap_err()
            .to_string()
    };
    let fixed = [SpeedKey::fixed(0.0, 1.0), SpeedKey::fixed(1.0, 1.0)];
    assert!(message(&fixed, 2.0).contains("the fixed keys (0, 1) cover 1, and no free key"));
    assert!(SpeedTime::new(&fixed, 1.0, Between::Linear).is_ok());
    let much = [
        SpeedKey::free(0.0, 1.0),
        SpeedKey::fixed(1.0, 4.0),
        SpeedKey::free(2.0, 0.0),
    ];
    let found = message(&much, 3.0);
    assert!(
        found.contains("the fixed keys (1) cover 4, and the free keys (0)"),
        "{found}"
    );
    let none = [
        SpeedKey::free(0.0, 1.0),
        SpeedKey::free(1.0, 0.0),
        SpeedKey::free(2.0, -1.0),
    ];
    assert!(message(&none, 3.0).contains("the free keys (0, 2) cover nothing together"));
}

#[test]
fn accelerations_meet_distance_and_end_speed() {
    // The slides' constant acceleration is three keys held.
    let (t1, t2) = (0.2, 0.7);
    let push = |time, a| AccelerationKey::free(time, a);
    let held = [
        push(0.0, 1.0),
        push(t1, 0.0),
        push(t2, -1.0),
        push(1.0, 0.0),
    ];
    let motion = AccelerationTime::new(&held, 0.0, Some(0.0), 1.0, Between::Hold).unwrap();
    let ease = ConstantAcceleration::new(t1, t2).unwrap();
    for i in 0..=200 {
        let t = f64::from(i) / 200.0;
        assert!((motion.distance(t) - ease.value(t)).abs() < 1e-14);
        assert!((motion.speed(t) - ease.speed(t)).abs() < 1e-14);
    }
    assert!((motion.factors()[0] - ease.even_speed() / t1).abs() < 1e-13);
    for between in [Between::Linear, Between::Smooth] {
        let list = [
            push(0.5, 0.3),
            AccelerationKey::fixed(1.0, 0.7),
            push(2.0, 0.0),
            push(3.0, -2.0),
            push(4.0, 0.0),
        ];
        let motion = AccelerationTime::new(&list, 0.25, Some(0.125), 6.0, between).unwrap();
        assert_eq!(motion.distance(4.0), 6.0);
        assert!((motion.distance(4.0_f64.next_down()) - 6.0).abs() < 1e-13);
        assert!((motion.speed(4.0) - 0.125).abs() < 1e-13);
        assert!((motion.speed(0.0) - 0.25).abs() < 1e-15);
        assert!((motion.acceleration(1.0) - 0.7).abs() < 1e-13);
        let one = AccelerationTime::new(&list, 0.25, None, 2.0, between).unwrap();
        assert_eq!(one.factors()[0], one.factors()[1]);
        assert!((one.distance(4.0_f64.next_down()) - 2.0).abs() < 1e-13);
    }
    let unreachable = |list: &[AccelerationKey], end| {
        AccelerationTime::new(list, 0.0, end, 1.0, Between::Linear)
            .unwrap_err()
            .to_string()
    };
    let only = [push(0.0, 1.0), push(1.0, 1.0)];
    assert!(unreachable(&only, Some(0.0)).contains("a free key that brakes"));
    let wrong = [push(0.0, -1.0), push(1.0, 0.0), push(2.0, 1.0)];
    assert!(unreachable(&wrong, Some(0.0)).contains("would have to"));
    assert!(unreachable(&[push(0.0, -1.0), push(1.0, 0.0)], None).contains("turn round"));
}

#[test]
fn bad_keys_are_named() {
    let message =
        |list: &[(f64, f64)]| DistanceTime::monotone(&keys(list)).unwrap_err().to_string();
    assert!(message(&[]).contains("a curve of distances needs at least 2"));
    assert!(message(&[(0.0, 0.0)]).contains("there are 1"));
    assert!(message(&[(0.0, 0.0), (0.0, 1.0)]).contains("the time of key 1 is 0, not greater"));
    assert!(message(&[(0.0, 0.0), (2.0, 1.0), (1.0, 2.0)]).contains("the time of key 2 is 1"));
    assert!(message(&[(0.0, 0.0), (f64::NAN, 1.0)]).contains("the time of key 1 is not finite"));
    assert!(message(&[(-1.0, 0.0), (1.0, 1.0)]).contains("time of key 0 is -1"));
    assert!(message(&[(0.0, 0.0), (1.0, f64::INFINITY)]).contains("distance of key 1 is inf"));
    assert!(message(&[(0.0, 0.0), (1e-300, 1.0)]).contains("time of key 1"));
    assert!(Eased::new(Linear, 0.0, 1.0).is_err());
    assert!(Eased::new(Linear, f64::NAN, 1.0).is_err());
    assert!(Eased::new(Linear, 1.0, f64::INFINITY).is_err());
}

/// The findings of a kind.
fn found(control: &dyn SpeedControl, total: f64, kind: &str) -> Vec<Finding> {
    let all = diagnose(control, total);
    all.into_iter()
        .filter(|f| format!("{f:?}").starts_with(kind))
        .collect()
}

#[test]
fn motion_without_fault_has_no_findings() {
    let calm: Vec<Box<dyn SpeedControl>> = vec![
        Box::new(Eased::new(Cubic, 3.0, 20.0).unwrap()),
        Box::new(Eased::new(Cubic, 3.0, -20.0).unwrap()),
        Box::new(Eased::new(Quintic, 1e-3, 1e6).unwrap()),
        Box::new(eased(Sinusoidal)),
        Box::new(eased(ConstantAcceleration::new(0.1, 0.6).unwrap())),
        Box::new(eased(CubicBezier::EASE_IN_OUT)),
        Box::new(eased(Directed::new(Power::QUINT, Direction::InOut))),
        Box::new(eased(Directed::new(
            Power::new(1.5).unwrap(),
            Direction::InOut,
        ))),
    ];
    for control in calm {
        let total = control.distance(control.duration());
        assert_eq!(diagnose(&*control, total), [], "{control:?}");
    }
    let rest = [
        DistanceKey::with_speed(0.0, 0.0, 0.0),
        DistanceKey::new(1.0, 1.0),
        DistanceKey::new(2.0, 3.0),
        DistanceKey::with_speed(3.0, 4.0, 0.0),
    ];
    assert_eq!(diagnose(&DistanceTime::monotone(&rest).unwrap(), 4.0), []);
    assert_eq!(diagnose(&DistanceTime::free(&rest).unwrap(), 4.0), []);
}

#[test]
fn backing_up_is_timed() {
    // 3t² − 2t³ turned over: speed 6(t − 0.25)(t − 0.5) after scaling, between keys of one cubic.
    let cubic = |t: f64| 2.0 * t * t * t - 2.25 * t * t + 0.75 * t;
    let list = [
        DistanceKey::with_speed(0.0, 0.0, 0.75),
        DistanceKey::with_speed(1.0, cubic(1.0), 6.0 - 4.5 + 0.75),
    ];
    let motion = DistanceTime::free(&list).unwrap();
    let back = found(&motion, 0.5, "BacksUp");
    let [Finding::BacksUp { from, to, distance }] = back[..] else {
        panic!("{back:?}");
    };
    assert!(
        (from - 0.25).abs() < 1e-14 && (to - 0.5).abs() < 1e-14,
        "{from} {to}"
    );
    assert!((distance - (cubic(0.25) - cubic(0.5))).abs() < 1e-14);
    assert_eq!(
        back[0].to_string(),
        "it backs up from 0.25 to 0.5, by 0.015625"
    );
    // An ease that is no polynomial piece: t²(t + o(t − 1)) turns at 2o/(3(o + 1)).
    let run_up = eased(Back::default());
    let back = found(&run_up, 1.0, "BacksUp");
    let [Finding::BacksUp { from, to, .. }] = back[..] else {
        panic!("{back:?}");
    };
    assert!(from == 0.0 && (to - 2.0 * 1.70158 / (3.0 * 2.70158)).abs() < 1e-12);
    assert!(found(&eased(Cubic), 1.0, "BacksUp").is_empty());
    // The other way round: ahead is back.
    let there = Eased::new(Back::default(), 2.0, -5.0).unwrap();
    assert_eq!(found(&there, -5.0, "BacksUp").len(), 1);
}

#[test]
fn stalls_are_timed() {
    // Speed 3(1 − 2t)²: a moment in the middle, inside one polynomial.
    let list = [
        DistanceKey::with_speed(0.0, 0.0, 3.0),
        DistanceKey::with_speed(1.0, 1.0, 3.0),
    ];
    let cubic = DistanceTime::monotone(&list).unwrap();
    let stalls = found(&cubic, 1.0, "Stalls");
    let [Finding::Stalls { from, to, distance }] = stalls[..] else {
        panic!("{stalls:?}");
    };
    assert!(from == to && (from - 0.5).abs() < 1e-9 && (distance - 0.5).abs() < 1e-9);
    assert_eq!(
        stalls[0].to_string(),
        "it stalls for a moment at 0.5, at the distance 0.5"
    );
    assert!(found(&cubic, 1.0, "BacksUp").is_empty());
    // The same where the motion is no polynomial, off the middle, and at a break.
    let skewed = CubicBezier::new(0.2, 0.75, 0.8, -0.3).unwrap();
    assert_eq!(found(&eased(skewed), 1.0, "BacksUp").len(), 1);
    let joint = eased(Directed::new(Power::CUBIC, Direction::OutIn));
    let stalls = found(&joint, 1.0, "Stalls");
    assert!(
        matches!(
            stalls[..],
            [Finding::Stalls {
                from: 0.5,
                to: 0.5,
                ..
            }]
        ),
        "{stalls:?}"
    );
    // A while.
    let pause = monotone(&[(0.0, 0.0), (1.0, 1.0), (2.5, 1.0), (3.0, 2.0)]);
    let stalls = found(&pause, 2.0, "Stalls");
    assert!(
        matches!(
            stalls[..],
            [Finding::Stalls {
                from: 1.0,
                to: 2.5,
                distance: 1.0
            }]
        ),
        "{stalls:?}"
    );
    // A dip that does not reach rest is no stall.
    let dip = [
        DistanceKey::with_speed(0.0, 0.0, 2.9),
        DistanceKey::with_speed(1.0, 1.0, 2.9),
    ];
    assert!(found(&DistanceTime::monotone(&dip).unwrap(), 1.0, "Stalls").is_empty());
    let slow = eased(CubicBezier::new(0.3, 0.6, 0.7, 0.4).unwrap());
    assert!(found(&slow, 1.0, "Stalls").is_empty());
}

#[test]
fn starts_ends_and_waiting() {
    // The slide's motion: waits a while before starting and does not reach the end.
    let late = monotone(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.4), (4.0, 0.9)]);
    assert_eq!(found(&late, 1.0, "Waits"), [Finding::Waits { until: 1.0 }]);
    let missing = found(&late, 1.0, "NeverArrives");
    assert!(
        matches!(missing[..], [Finding::NeverArrives { missing }] if (missing - 0.1).abs() < 1e-12)
    );
    assert!(missing[0].to_string().contains("0.1 is missing"));
    assert!(found(&late, 0.9, "NeverArrives").is_empty());
    // A first key after time 0 is waited for, and abrupt when it has a speed.
    let keyed = [
        DistanceKey::with_speed(0.5, 0.0, 1.0),
        DistanceKey::with_speed(1.5, 1.0, 0.0),
    ];
    let keyed = DistanceTime::monotone(&keyed).unwrap();
    assert_eq!(
        diagnose(&keyed, 1.0),
        [
            Finding::Waits { until: 0.5 },
            Finding::StartsAbruptly {
                time: 0.5,
                speed: 1.0
            }
        ]
    );
    // The other slide's: starts partway along the curve and gets to the end before the time is over.
    let early = monotone(&[(0.0, 0.3), (1.0, 0.7), (3.0, 1.0), (4.0, 1.0)]);
    assert_eq!(
        found(&early, 1.0, "StartsPartway"),
        [Finding::StartsPartway { distance: 0.3 }]
    );
    let arrives = found(&early, 1.0, "ArrivesEarly");
    assert_eq!(
        arrives,
        [Finding::ArrivesEarly {
            time: 3.0,
            due: 4.0
        }]
    );
    assert_eq!(
        arrives[0].to_string(),
        "it arrives early, at 3 instead of 4"
    );
    assert!(found(&eased(Cubic), 1.0, "ArrivesEarly").is_empty());
    assert!(found(&eased(Cubic), 1.0, "StartsPartway").is_empty());
    assert!(found(&eased(Cubic), 1.0, "Waits").is_empty());
    // Late: in its own time, but after it was due.
    let motion = Eased::new(Cubic, 4.0, 1.0).unwrap();
    assert_eq!(
        diagnose_until(&motion, 1.0, 3.0),
        [Finding::ArrivesLate {
            time: 4.0,
            due: 3.0
        }]
    );
    assert_eq!(
        diagnose_until(&motion, 1.0, 5.0),
        [Finding::ArrivesEarly {
            time: 4.0,
            due: 5.0
        }]
    );
    // Abrupt at both ends.
    let even = diagnose(&Eased::new(Linear, 2.0, 6.0).unwrap(), 6.0);
    assert_eq!(
        even,
        [
            Finding::StartsAbruptly {
                time: 0.0,
                speed: 3.0
            },
            Finding::EndsAbruptly {
                time: 2.0,
                speed: 3.0
            }
        ]
    );
    assert_eq!(
        even[0].to_string(),
        "it starts abruptly at 0, with the speed 3"
    );
    assert_eq!(found(&eased(Sinusoidal), 1.0, "EndsAbruptly"), []);
    // Abrupt about a pause.
    let stops = Stops::new(&[(0.0, 0.0), (0.25, 0.5), (0.5, 0.5), (1.0, 1.0)]).unwrap();
    let pause = diagnose(&eased(stops), 1.0);
    let times = |kind: &str| -> Vec<f64> {
        let of_kind = pause.iter().filter(|f| format!("{f:?}").starts_with(kind));
        of_kind.filter_map(Finding::time).collect()
    };
    assert_eq!(times("StartsAbruptly"), [0.0, 0.5], "{pause:?}");
    assert_eq!(times("EndsAbruptly"), [0.25, 1.0]);
    assert_eq!(times("Stalls"), [0.25]);
    // An infinite speed at the end is abrupt, too.
    let circle = diagnose(&eased(Circular), 1.0);
    let infinite = Finding::EndsAbruptly {
        time: 1.0,
        speed: f64::INFINITY,
    };
    assert_eq!(circle, [infinite]);
}

#[test]
fn jumps_and_leaving_the_path() {
    let steps = eased(Steps::new(2.0, StepPosition::End).unwrap());
    let all = diagnose(&steps, 1.0);
    let half = |f: &Finding| matches!(f, Finding::Jumps { distance, .. } if (distance - 0.5).abs() < 1e-12);
    assert!(matches!(all[0], Finding::Waits { until: 0.5 }), "{all:?}");
    let jumps: Vec<&Finding> = all.iter().filter(|f| half(f)).collect();
    assert_eq!(
        jumps.iter().filter_map(|f| f.time()).collect::<Vec<_>>(),
        [0.5, 1.0]
    );
    assert!(matches!(
        found(&steps, 1.0, "Stalls")[..],
        [Finding::Stalls {
            from: 0.5,
            to: 1.0,
            ..
        }]
    ));
    assert_eq!(all.len(), 4, "{all:?}");
    let start = diagnose(&eased(Steps::new(2.0, StepPosition::Start).unwrap()), 1.0);
    assert!(
        start.contains(&Finding::StartsPartway { distance: 0.5 }),
        "{start:?}"
    );
    assert!(
        start.contains(&Finding::ArrivesEarly {
            time: 0.5,
            due: 1.0
        }),
        "{start:?}"
    );
    // An infinite speed in the middle is no jump.
    let steep = eased(CubicBezier::new(1.0, 0.0, 0.0, 1.0).unwrap());
    assert!(found(&steep, 1.0, "Jumps").is_empty());
    // Beyond the end from where it passes 1 until it is back: t = 1 − r with r(r + o(r − 1)) = 0, r = o/(o + 1).
    let over = eased(Back::default().directed(Direction::Out));
    let away = found(&over, 1.0, "LeavesPath");
    let [Finding::LeavesPath { from, to, by }] = away[..] else {
        panic!("{away:?}");
    };
    assert!((from - (1.0 - 1.70158 / 2.70158)).abs() < 1e-12 && to == 1.0);
    assert!((by - 0.100_004_07).abs() < 1e-8, "{by}");
    assert!(away[0].to_string().contains("beyond the end of the path"));
    let under = eased(Back::default());
    assert!(
        found(&under, 1.0, "LeavesPath")[0]
            .to_string()
            .contains("before the start")
    );
    // A path of the wrong length: it is passed at speed.
    let short = found(&eased(Linear), 0.8, "LeavesPath");
    let [Finding::LeavesPath { from, to, by }] = short[..] else {
        panic!("{short:?}");
    };
    assert!((from - 0.8).abs() < 1e-12 && to == 1.0 && (by - 0.2).abs() < 1e-12);
    assert!(found(&eased(Cubic), 1.0, "LeavesPath").is_empty());
    assert!(found(&eased(Cubic), 1.0, "Jumps").is_empty());
}

/// A bouncing ball: at each touch of the floor it turns round at full speed, at each top it is back.
#[test]
fn bounces_back_up_as_often_as_they_touch() {
    let bounce = eased(Directed::new(Bounce::default(), Direction::Out));
    let back: Vec<Finding> = found(&bounce, 1.0, "BacksUp");
    let heights = [0.25, 1.0 / 16.0, 1.0 / 64.0];
    assert_eq!(back.len(), 3, "{back:?}");
    for (finding, height) in back.iter().zip(heights) {
        assert!(
            matches!(finding, Finding::BacksUp { distance, .. } if (distance - height).abs() < 1e-9)
        );
    }
}

/// Whatever is drawn, backing up is found where sampling sees it, and nowhere else.
#[test]
fn findings_agree_with_samples() {
    let mut random = Random(77);
    for round in 0..200 {
        let keys = random.distances(2 + round % 8, round % 3 == 0);
        let motion = DistanceTime::free(&keys).unwrap();
        let total = motion.distance(motion.duration());
        let forward = if total < 0.0 { -1.0 } else { 1.0 };
        let back = found(&motion, total, "BacksUp");
        let fastest = (0..1000).fold(0.0_f64, |m, i| {
            m.max(
                motion
                    .speed(motion.duration() * f64::from(i) / 1000.0)
                    .abs(),
            )
        });
        for i in 0..1000 {
            let t = motion.duration() * (f64::from(i) + 0.5) / 1000.0;
            let speed = forward * motion.speed(t);
            let inside = back
                .iter()
                .any(|f| matches!(f, Finding::BacksUp { from, to, .. } if *from <= t && t <= *to));
            if speed.abs() > 1e-6 * fastest {
                assert_eq!(inside, speed < 0.0, "{keys:?} at {t}");
            }
        }
    }
}

/// Registered eases: those that are monotone and finite are never said to back up or to leave the path.
#[test]
fn registered_eases_are_diagnosed_as_declared() {
    for entry in registry() {
        let ease = entry.construct(&[]).unwrap();
        let facts = ease.facts();
        let all = diagnose(&Eased::new(ease, 2.0, 3.0).unwrap(), 3.0);
        let has = |kind: &str| all.iter().any(|f| format!("{f:?}").starts_with(kind));
        if facts.monotone {
            assert!(
                !has("BacksUp") && !has("LeavesPath"),
                "{}: {all:?}",
                entry.name
            );
        }
        assert_eq!(
            has("StartsPartway"),
            !facts.starts_at_zero,
            "{}",
            entry.name
        );
        assert_eq!(has("NeverArrives"), !facts.ends_at_one, "{}", entry.name);
        assert!(all.iter().all(|f| !f.to_string().contains("NaN")));
    }
}
