//! What once took for ever, or was wrong, each under the name of what it was.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::{DQuat, DVec3, dvec3};
use anamorph_core::{Curve, Differentiable, Solid};
use anamorph_curves::eases::{Back, Directed, Direction, Linear, StepPosition, Steps};
use anamorph_curves::families::registry::{Given, Path, family};
use anamorph_curves::families::{BSpline, Lagrange};
use anamorph_curves::motion::{Eased, Finding, Measure, Motion, SpeedControl, turns_at_once};
use anamorph_curves::orientation::registry::{Value, modifier, orientation};
use anamorph_curves::orientation::{LookAhead, Orienter};
use anamorph_curves::{ArcLength, CurveError, LengthTable};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Far more than any of these takes, and far less than they once took; debug builds on busy machines are slow.
const SOON: Duration = Duration::from_secs(20);

fn zigzag(count: usize) -> Vec<DVec3> {
    let sign = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
    (0..count).map(|i| dvec3(i as f64, sign(i), 0.0)).collect()
}

fn path(kind: &str, points: Vec<DVec3>, closed: bool) -> Arc<dyn Path<Solid>> {
    let given = Given {
        points,
        closed,
        ..Given::default()
    };
    Arc::from(family(kind).unwrap().make(&given).unwrap())
}

fn ring() -> Vec<DVec3> {
    vec![
        dvec3(2.0, 0.0, 0.0),
        dvec3(0.0, 0.3, 2.0),
        dvec3(-2.0, 0.0, 0.5),
        dvec3(0.5, -0.3, -2.0),
    ]
}

#[test]
fn polynomials_through_zigzags_were_measured_for_ever() {
    for count in [17, 20, 25, 33] {
        let curve = Lagrange::new(zigzag(count)).unwrap();
        let started = Instant::now();
        let rough = curve.length(1e-3);
        let table = LengthTable::new(&curve, 1e-10 * rough).unwrap();
        assert!(table.is_complete(), "{count}");
        assert!(started.elapsed() < SOON, "{count}: {:?}", started.elapsed());
        // Against a fine polyline.
        let steps = 400_000;
        let end = curve.domain().1;
        let at = |i: usize| curve.point(end * (i as f64 / steps as f64));
        let chords: f64 = (0..steps).map(|i| at(i).distance(at(i + 1))).sum();
        let off = (table.length() - chords).abs() / chords;
        assert!(off < 1e-6, "{count}: {off}");
    }
}

#[test]
fn derivatives_of_polynomials_were_noise() {
    let curve = Lagrange::new(zigzag(25)).unwrap();
    // Of the same polynomial by differences of neighbouring points, well inside the steep end.
    for u in [0.4, 1.7, 12.3, 23.6] {
        let h = 1e-4;
        let slope = (curve.point(u + h) - curve.point(u - h)) / (2.0 * h);
        let jet = curve.jet(u);
        assert!(
            (jet.first - slope).length() < 1e-5 * (1.0 + slope.length()),
            "{u}: {} {slope}",
            jet.first
        );
        let bend = (curve.velocity(u + h) - curve.velocity(u - h)) / (2.0 * h);
        assert!((jet.second - bend).length() < 1e-5 * (1.0 + bend.length()));
    }
}

#[test]
fn nodes_that_nearly_coincide_took_minutes() {
    let points = zigzag(4);
    let nodes = |list: [f64; 4]| Lagrange::at_nodes(list.to_vec(), points.clone());
    let near = nodes([0.0, 1.0, 1.000_000_000_000_001, 3.0]).unwrap_err();
    assert!(
        matches!(
            near,
            CurveError::ElementOutOfRange {
                what: "node",
                index: 2,
                ..
            }
        ),
        "{near}"
    );
    assert!(near.to_string().contains("a billionth"), "{near}");
    let wide = nodes([0.0, 1e150, 2e150, 3e150]).unwrap_err();
    assert!(wide.to_string().contains("from 1e-50 to 1e50"), "{wide}");
    assert!(nodes([0.0, 1e-160, 2e-160, 3e-160]).is_err());
    for scale in [1e-50, 1e-20, 1e20, 3e49] {
        let started = Instant::now();
        let curve = nodes([0.0, scale, 1.5 * scale, 3.0 * scale]).unwrap();
        let table = LengthTable::new(&curve, 1e-9).unwrap();
        assert!(table.is_complete() && started.elapsed() < SOON, "{scale}");
    }
}

#[test]
fn curves_whose_squares_vanish_were_slow() {
    for kind in [
        "lagrange",
        "catmull-rom",
        "bezier",
        "b-spline",
        "general-bezier",
    ] {
        for size in [1e-60, 1e-100, 1e-155, 1e-160, 1e-200, 1e-310] {
            let started = Instant::now();
            let points: Vec<DVec3> = zigzag(4).iter().map(|p| *p * size).collect();
            let curve = path(kind, points, false);
            match LengthTable::new(curve.as_ref(), 1e-10 * size) {
                Ok(table) => assert!(
                    size >= 1e-150 && (size < 1e-60 || table.is_complete()),
                    "{kind} {size}"
                ),
                Err(CurveError::OutOfRange { name, range, .. }) => {
                    assert!(
                        name.contains("length") && range.contains("1e-150") && size < 1e-149,
                        "{kind} {size}"
                    );
                }
                Err(CurveError::NoLength) => assert!(size < 1e-150, "{kind} {size}"),
                // The accuracy itself is no number any more.
                Err(other) => assert!(size < 1e-300, "{kind} {size} {other}"),
            }
            assert!(started.elapsed() < SOON, "{kind} {size}");
        }
    }
}

#[test]
fn long_b_splines_took_the_square_of_their_points() {
    let started = Instant::now();
    for degree in [3, 5] {
        let spline = BSpline {
            degree,
            ..BSpline::new(zigzag(100_000))
        };
        assert!(spline.pieces().is_ok());
    }
    assert!(started.elapsed() < SOON, "{:?}", started.elapsed());
    // Lengths of curves of many pieces do not walk over all of them.
    let spline = BSpline {
        degree: 5,
        ..BSpline::new(zigzag(100_000))
    };
    let curve = spline.pieces().unwrap();
    let started = Instant::now();
    for i in 0..10_000 {
        let u = f64::from(i) * 9.0;
        assert!(curve.length_between(u, u + 0.5, 1e-9) > 0.0);
    }
    assert!(started.elapsed() < SOON, "{:?}", started.elapsed());
}

#[test]
fn a_million_steps_were_diagnosed_for_half_a_minute() {
    let started = Instant::now();
    let steps = Steps::new(1e6, StepPosition::End).unwrap();
    let control: Box<dyn SpeedControl> = Box::new(Eased::new(steps, 4.0, 1.0).unwrap());
    let line = path("b-spline", zigzag(5), false);
    let motion = Motion::new(line, control, Measure::Length, 1e-9).unwrap();
    assert!(!motion.diagnose().is_empty());
    assert!(motion.knots().is_none());
    assert!(started.elapsed() < SOON, "{:?}", started.elapsed());
}

fn moved(
    path: &Arc<dyn Path<Solid>>,
    ease: impl anamorph_curves::eases::Ease + 'static,
    share: f64,
) -> (Motion<Solid>, f64) {
    let length = path.length(1e-10);
    let control = Eased::new(ease, 4.0, share * length).unwrap();
    let motion = Motion::new(Arc::clone(path), Box::new(control), Measure::Length, 1e-10);
    (motion.unwrap(), length)
}

#[test]
fn eases_beyond_the_end_were_said_to_back_up() {
    let path = path("catmull-rom", zigzag(4), false);
    let back = Directed::new(Back::default(), Direction::Out);
    let (motion, length) = moved(&path, back, 1.0);
    let findings = motion.diagnose();
    assert!(
        !findings
            .iter()
            .any(|f| matches!(f, Finding::BacksUp { .. })),
        "{findings:?}"
    );
    let Some(Finding::LeavesPath { from, to, by }) = findings
        .iter()
        .find(|f| matches!(f, Finding::LeavesPath { .. }))
    else {
        unreachable!("{findings:?}");
    };
    // In between the table and the picture have it wait at the end.
    for share in [0.01, 0.5, 0.99] {
        let time = from + (to - from) * share;
        assert_eq!((motion.distance(time), motion.speed(time)), (length, 0.0));
    }
    assert!((by / length - 0.1).abs() < 1e-3);
    let said = Finding::LeavesPath {
        from: *from,
        to: *to,
        by: *by,
    }
    .to_string();
    assert!(
        said.contains("goes beyond the end") && said.contains("waits at the end"),
        "{said}"
    );
    // What goes back on the path is said, as far as it is on it.
    let (motion, length) = moved(&path, Directed::new(Back::default(), Direction::In), 1.0);
    assert!(
        !motion
            .diagnose()
            .iter()
            .any(|f| matches!(f, Finding::BacksUp { .. }))
    );
    let keys = [(0.0, 0.0), (1.0, 1.2), (2.0, 0.7), (4.0, 1.0)];
    let keys = keys.map(|(t, s)| anamorph_curves::motion::DistanceKey::new(t, s * length));
    let control = anamorph_curves::motion::DistanceTime::monotone(&keys).unwrap();
    let motion = Motion::new(Arc::clone(&path), Box::new(control), Measure::Length, 1e-10).unwrap();
    let backs: Vec<Finding> = motion
        .diagnose()
        .into_iter()
        .filter(|f| matches!(f, Finding::BacksUp { .. }))
        .collect();
    let [Finding::BacksUp { from, to, distance }] = backs[..] else {
        unreachable!("{backs:?}");
    };
    assert!(
        (distance - 0.3 * length).abs() < 1e-6 * length && from > 1.0 && (to - 2.0).abs() < 1e-6
    );
    assert!((motion.control().distance(from) - length).abs() < 1e-6 * length);
}

#[test]
fn two_rounds_and_a_half_never_arrived() {
    let path = path("catmull-rom", ring(), true);
    let (motion, length) = moved(&path, anamorph_curves::eases::Sinusoidal, 2.5);
    let findings = motion.diagnose_over(2.5 * length);
    assert!(findings.is_empty(), "{findings:?}");
    // Evenly, it stops abruptly somewhere else than it starts; three rounds go on as they came.
    let (motion, length) = moved(&path, Linear, 2.5);
    assert_eq!(motion.diagnose_over(2.5 * length).len(), 2);
    let (motion, length) = moved(&path, Linear, 3.0);
    assert!(motion.diagnose_over(3.0 * length).is_empty() && motion.diagnose().is_empty());
}

#[test]
fn looking_ahead_by_whole_rounds_faced_by_rounding() {
    let path = path("catmull-rom", ring(), true);
    let length = path.length(1e-12);
    let along = LookAhead::along(Arc::clone(&path), 0.0, DVec3::Y).unwrap();
    for rounds in [1.0, 2.0, 7.0] {
        for off in [0.0, 1e-12, -1e-12] {
            let ahead = LookAhead::along(Arc::clone(&path), length * (rounds + off), DVec3::Y);
            let ahead = ahead.unwrap();
            for i in 0..50 {
                let u = 4.0 * (f64::from(i) / 50.0);
                assert_eq!(ahead.frame(u), along.frame(u), "{rounds} {u}");
            }
        }
    }
    let quarter = LookAhead::along(Arc::clone(&path), 1.25 * length, DVec3::Y).unwrap();
    assert_ne!(quarter.frame(0.3), along.frame(0.3));
}

/// The turns at once of a motion along a path with an orientation by name.
fn turns(path: &Arc<dyn Path<Solid>>, name: &str, settings: &[(&str, Value)]) -> Vec<(f64, f64)> {
    let settings: Vec<(String, Value)> = settings
        .iter()
        .map(|(name, value)| ((*name).to_owned(), value.clone()))
        .collect();
    let frames = match name {
        "banking" => {
            let base = orientation("up")
                .unwrap()
                .make(Arc::clone(path), &[])
                .unwrap();
            let banking = modifier("banking").unwrap();
            banking.modify(base, Arc::clone(path), &settings).unwrap()
        }
        name => {
            let entry = orientation(name).unwrap();
            entry.make(Arc::clone(path), &settings).unwrap()
        }
    };
    turns_of(path, frames.as_ref())
}

fn turns_of(path: &Arc<dyn Path<Solid>>, frames: &dyn Orienter) -> Vec<(f64, f64)> {
    let (motion, _) = moved(path, Linear, 1.0);
    let mut rotations = |times: &[f64]| {
        let parameters: Vec<f64> = times.iter().map(|t| motion.parameter(*t)).collect();
        let all = frames.frames(&parameters);
        all.iter()
            .map(anamorph_curves::orientation::Frame::to_quaternion)
            .collect::<Vec<DQuat>>()
    };
    let findings = motion.diagnose_turning(&mut rotations);
    let each = findings.into_iter().filter_map(|finding| match finding {
        Finding::TurnsAtOnce { time, angle } => Some((time, angle.to_degrees())),
        _ => None,
    });
    each.collect()
}

#[test]
fn views_that_turn_at_once_had_no_faults() {
    let line = path(
        "b-spline",
        vec![
            dvec3(-1.0, 0.0, 0.0),
            DVec3::ZERO,
            dvec3(1.0, 0.0, 0.0),
            dvec3(3.0, 0.0, 0.0),
        ],
        false,
    );
    let target = Value::Vector(dvec3(1.0, 0.0, 0.0));
    let found = turns(&line, "look-at", &[("target", target)]);
    let (length, passed) = (line.length(1e-9), 2.0);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(
        (found[0].0 - 4.0 * passed / length).abs() < 1e-3 && (found[0].1 - 180.0).abs() < 0.1,
        "{found:?}"
    );
    let beside = Value::Vector(dvec3(1.0, 0.0, 0.1));
    assert!(turns(&line, "look-at", &[("target", beside)]).is_empty());
    // Over the top of a vertical loop.
    let circle = |i: u32| {
        let a = core::f64::consts::TAU * f64::from(i) / 8.0;
        dvec3(a.sin(), 1.0 - a.cos(), 0.0)
    };
    let vertical = path("catmull-rom", (0..8).map(circle).collect(), true);
    let found = turns(&vertical, "up", &[]);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found.iter().all(|(_, angle)| (angle - 180.0).abs() < 0.1));
    assert!(turns(&vertical, "rotation-minimizing", &[]).is_empty());
    // Corners.
    let degree = Given {
        points: zigzag(4),
        numbers: vec![("degree".to_owned(), 1.0)],
        ..Given::default()
    };
    let corners: Arc<dyn Path<Solid>> =
        Arc::from(family("b-spline").unwrap().make(&degree).unwrap());
    assert_eq!(turns(&corners, "rotation-minimizing", &[]).len(), 2);
}

#[test]
fn banking_jumped_where_the_curvature_does() {
    let points = [(0.0, 0.0), (1.0, 1.0), (4.0, 0.0), (5.0, 3.0), (2.0, 4.0)];
    let points = points.map(|(x, z)| dvec3(x, 0.0, z)).to_vec();
    let road = path("catmull-rom", points, true);
    let fast = ("speed", Value::Number(3.0));
    let sharp = turns(
        &road,
        "banking",
        &[fast.clone(), ("smoothing", Value::Number(0.0))],
    );
    assert!(sharp.iter().any(|(_, angle)| *angle > 10.0), "{sharp:?}");
    let soft = turns(&road, "banking", &[fast]);
    assert!(soft.is_empty(), "{soft:?}");
}

#[test]
fn quick_turns_are_not_at_once() {
    let spin = |times: &[f64]| -> Vec<DQuat> {
        times
            .iter()
            .map(|t| DQuat::from_rotation_y(200.0 * t))
            .collect()
    };
    assert!(turns_at_once(10.0, &mut |times| spin(times), &|_, _| true).is_empty());
    let mut click = |times: &[f64]| -> Vec<DQuat> {
        let angle = |t: f64| if t < 4.321 { 0.0 } else { 1.0 };
        times
            .iter()
            .map(|t| DQuat::from_rotation_y(angle(*t)))
            .collect()
    };
    let found = turns_at_once(10.0, &mut click, &|_, _| true);
    let [Finding::TurnsAtOnce { time, angle }] = found[..] else {
        unreachable!("{found:?}");
    };
    assert!((time - 4.321).abs() < 1e-3 && (angle - 1.0).abs() < 1e-9);
    let said = found[0].to_string();
    assert!(
        said.starts_with("it turns by 57.3 degrees at once at 4.32"),
        "{said}"
    );
}

/// An end of a curve that is as near as the place beside it, because distances grow with the square of the way, drew points to it: the
/// nearest parameter stayed at the end for a millionth of the curve, and then jumped.
#[test]
fn nearest_places_do_not_stick_to_ends_and_joints() {
    use anamorph_core::NearestPoint;
    use anamorph_core::glam::dvec2;
    use anamorph_curves::families::{CatmullRom, Generator};
    let points = [
        dvec2(-0.5, 0.0),
        dvec2(-0.1, 0.0),
        dvec2(0.2, 0.0),
        dvec2(0.5, 0.0),
    ];
    let curve = CatmullRom::new(points.to_vec()).curve().unwrap();
    for start in [-0.5, -0.1, 0.2] {
        for step in [1e-9, 3e-8, 2e-7, 5e-7, 1e-6, 1e-4] {
            for side in [-1.0, 1.0] {
                let x = start + side * step;
                let nearest = curve.nearest(dvec2(x, 0.1)).point.x;
                let wanted = f64::max(x, -0.5);
                assert!((nearest - wanted).abs() < 1e-13, "{x}: {nearest}");
            }
        }
    }
}
