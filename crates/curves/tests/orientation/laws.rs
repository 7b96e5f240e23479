//! Laws of all orientations.

use crate::paths::*;
use anamorph_core::glam::{DQuat, DVec3, dvec3};
use anamorph_core::{Curve, Differentiable, Solid, Space};
use anamorph_curves::families::registry::Path;
use anamorph_curves::families::{BSpline, CatmullRom, CubicBezier, Generator, Hermite};
use anamorph_curves::orientation::registry::{
    MODIFIERS, ORIENTATIONS, Takes, Value, modifier, orientation,
};
use anamorph_curves::orientation::{
    Auxiliary, End, FixedUp, Frenet, LookAhead, LookAt, OrientationError, Orienter, Pairing, Role,
    RotationMinimizing, UpdatedUp,
};
use anamorph_curves::{ArcLength, Bezier, CurveError, PiecewiseCubic};
use std::sync::Arc;

#[test]
fn every_orientation_gives_sound_frames_everywhere() {
    for (name, curve) in hard() {
        for entry in ORIENTATIONS {
            let path = shared(&curve);
            let given = settings(entry.name, &curve);
            let frames = entry.make(Arc::clone(&path), &given).unwrap();
            let what = format!("{} on {name}", entry.name);
            let list = parameters(&curve);
            let out = frames.frames(&list);
            for (u, frame) in list.iter().zip(&out) {
                assert_sound(frame, &format!("{what} at {u}"));
                assert_sound(&frames.frame(*u), &format!("{what} at {u} alone"));
                // Only one kind depends on its samples.
                if entry.name != "updated-up" {
                    assert_eq!(*frame, frames.frame(*u), "{what} at {u}");
                }
            }
            for modify in MODIFIERS {
                let base = entry.make(Arc::clone(&path), &given).unwrap();
                let smooth = [
                    ("smoothing".to_owned(), Value::Number(0.2)),
                    ("speed".to_owned(), Value::Number(20.0)),
                ];
                let leaned = modify.modify(base, Arc::clone(&path), &smooth).unwrap();
                for (u, frame) in list.iter().zip(leaned.frames(&list)) {
                    assert_sound(&frame, &format!("{what}, {} at {u}", modify.name));
                }
            }
        }
    }
}

#[test]
fn frames_along_the_path_face_along_it() {
    for (name, curve) in hard() {
        for kind in ["rotation-minimizing", "frenet", "up"] {
            let frames = orientation(kind)
                .unwrap()
                .make(shared(&curve), &[])
                .unwrap();
            for u in parameters(&curve) {
                let velocity = curve.velocity(curve.within(u));
                // Where a closed path ends it starts again.
                if curve.is_closed() && curve.within(u) == curve.domain().1 {
                    continue;
                }
                let scale = curve.length(1e-3 * Space::length(velocity).max(1e-160));
                if Space::length(velocity) > 1e-6 * scale {
                    let along = Space::normalized(velocity).unwrap();
                    let off = (frames.frame(u).forward() - along).length();
                    assert!(off < 1e-12, "{kind} on {name} at {u}: {off:e}");
                }
            }
        }
    }
}

#[test]
fn neighbouring_frames_never_flip() {
    for (name, curve) in hard() {
        let jumps = [
            "cusp",
            "near cusp",
            "straight back",
            "repeated points",
            "corners",
            "turns back",
            "rests",
            "closed corners",
        ];
        if jumps.contains(&name) {
            continue;
        }
        for kind in ["rotation-minimizing", "updated-up"] {
            let frames = orientation(kind)
                .unwrap()
                .make(shared(&curve), &[])
                .unwrap();
            let list = frames.frames(&even(&curve, 4096));
            for pair in list.windows(2) {
                assert!(close(&pair[0], &pair[1]) < 0.05, "{kind} on {name}");
            }
        }
    }
}

fn moved(curve: &Cubics, turn: DQuat, by: DVec3) -> Cubics {
    let pieces = curve.pieces().iter().map(|piece| {
        let [a, b, c, d] = piece.to_bezier();
        anamorph_curves::Cubic::from_bezier([a, b, c, d].map(|p| turn * p + by))
    });
    PiecewiseCubic::with_breaks(pieces.collect(), curve.breaks(), curve.is_closed()).unwrap()
}

#[test]
fn a_rigid_motion_of_the_path_moves_its_frames() {
    let turn = DQuat::from_axis_angle(dvec3(0.3, -0.5, 0.8).normalize(), 2.1);
    let by = dvec3(0.5, -1.0, 2.0);
    for (name, curve) in hard() {
        if ["tiny", "huge", "far away", "near cusp"].contains(&name) {
            continue;
        }
        let other = moved(&curve, turn, by);
        // Straight up is no law: the answer there names coordinate axes.
        let up = dvec3(0.3, 0.8, 0.2);
        type Pair<'a> = (&'a str, Box<dyn Orienter + 'a>, Box<dyn Orienter + 'a>);
        let pairs: Vec<Pair<'_>> = vec![
            (
                "rotation-minimizing",
                Box::new(
                    RotationMinimizing {
                        up,
                        ..RotationMinimizing::default()
                    }
                    .along(&curve)
                    .unwrap(),
                ),
                Box::new(
                    RotationMinimizing {
                        up: turn * up,
                        ..RotationMinimizing::default()
                    }
                    .along(&other)
                    .unwrap(),
                ),
            ),
            (
                "up",
                Box::new(FixedUp::along(&curve, up).unwrap()),
                Box::new(FixedUp::along(&other, turn * up).unwrap()),
            ),
            (
                "look ahead",
                Box::new(LookAhead::along(&curve, 0.4, up).unwrap()),
                Box::new(LookAhead::along(&other, 0.4, turn * up).unwrap()),
            ),
            (
                "look at",
                Box::new(LookAt::along(&curve, dvec3(5.0, 6.0, 7.0), up).unwrap()),
                Box::new(
                    LookAt::along(&other, turn * dvec3(5.0, 6.0, 7.0) + by, turn * up).unwrap(),
                ),
            ),
        ];
        for (kind, here, there) in &pairs {
            for u in even(&curve, 60) {
                let (a, b) = (here.frame(u), there.frame(u));
                let off = (turn * a.up() - b.up())
                    .length()
                    .max((turn * a.forward() - b.forward()).length());
                assert!(off < 1e-7, "{kind} on {name} at {u}: {off:e}");
            }
        }
    }
}

#[test]
fn paths_without_direction_are_errors() {
    let still = polyline(&[[1., 2., 3.], [1., 2., 3.], [1., 2., 3.]], false);
    for entry in ORIENTATIONS {
        let error = entry
            .make(shared(&still), &settings(entry.name, &still))
            .err()
            .unwrap();
        assert_eq!(
            error,
            OrientationError::Curve {
                what: "the path",
                source: CurveError::NoLength
            },
            "{}",
            entry.name
        );
        assert!(
            error
                .to_string()
                .contains("the path: the curve has no length")
        );
    }
    let base = FixedUp::along(&s_curve(), DVec3::Y).map(|_| ());
    assert!(base.is_ok());
    let curve = s_curve();
    for up in [DVec3::ZERO, DVec3::NAN, dvec3(0.0, f64::INFINITY, 0.0)] {
        let wrong = [
            RotationMinimizing {
                up,
                ..RotationMinimizing::default()
            }
            .along(&curve)
            .map(|_| ()),
            RotationMinimizing {
                end: End::Up(up),
                ..RotationMinimizing::default()
            }
            .along(&curve)
            .map(|_| ()),
            Frenet {
                up,
                ..Frenet::default()
            }
            .along(&curve)
            .map(|_| ()),
            FixedUp::along(&curve, up).map(|_| ()),
            UpdatedUp::along(&curve, up).map(|_| ()),
            LookAhead::along(&curve, 1.0, up).map(|_| ()),
            LookAt::along(&curve, DVec3::ZERO, up).map(|_| ()),
            Auxiliary::along(&curve, &curve, Role::Up, Pairing::Parameter, up).map(|_| ()),
        ];
        for result in wrong {
            assert!(
                matches!(result, Err(OrientationError::NoDirection { .. })),
                "{result:?}"
            );
        }
    }
    assert_eq!(
        LookAt::along(&curve, DVec3::NAN, DVec3::Y).err(),
        Some(OrientationError::NotFinite { name: "the target" })
    );
    for accuracy in [0.0, -1.0, 1.0, f64::NAN] {
        let result = RotationMinimizing {
            accuracy,
            ..RotationMinimizing::default()
        }
        .along(&curve);
        assert!(matches!(result, Err(OrientationError::OutOfRange { .. })));
    }
}

#[test]
fn the_registry_is_in_order() {
    let mut names: Vec<&str> = ORIENTATIONS.iter().map(|e| e.name).collect();
    names.extend(MODIFIERS.iter().map(|e| e.name));
    for (i, name) in names.iter().enumerate() {
        assert!(!names[..i].contains(name), "{name}");
        assert!(
            name.chars().all(|c| c.is_ascii_lowercase() || c == '-'),
            "{name}"
        );
    }
    let lists = ORIENTATIONS
        .iter()
        .map(|e| (e.title, e.reference, e.summary, e.parameters));
    for (title, reference, summary, parameters) in lists.chain(
        MODIFIERS
            .iter()
            .map(|e| (e.title, e.reference, e.summary, e.parameters)),
    ) {
        assert!(!title.is_empty() && !reference.is_empty() && !summary.is_empty());
        for (i, parameter) in parameters.iter().enumerate() {
            assert!(!parameter.meaning.is_empty());
            assert!(parameters[..i].iter().all(|p| p.name != parameter.name));
            // Whatever has a default can be given it.
            let value = match parameter.takes {
                Takes::Number(Some(number)) => Value::Number(number),
                Takes::Vector(Some(vector)) => Value::Vector(vector),
                Takes::Word(words) => Value::Word(words[0].to_owned()),
                _ => continue,
            };
            let (curve, set) = (s_curve(), (parameter.name.to_owned(), value));
            match ORIENTATIONS.iter().find(|e| e.title == title) {
                Some(entry) => {
                    let mut given = settings(entry.name, &curve);
                    let plain = entry.make(shared(&curve), &given).unwrap();
                    given.push(set);
                    let same = entry.make(shared(&curve), &given).unwrap();
                    assert_eq!(
                        plain.frames(&even(&curve, 9)),
                        same.frames(&even(&curve, 9))
                    );
                }
                None => {
                    let base = orientation("up")
                        .unwrap()
                        .make(shared(&curve), &[])
                        .unwrap();
                    modifier("banking")
                        .unwrap()
                        .modify(base, shared(&curve), &[set])
                        .unwrap();
                }
            }
        }
    }
}

#[test]
fn wrong_settings_are_named() {
    let curve = s_curve();
    let message = |kind: &str, settings: &[(&str, Value)]| {
        let settings: Vec<(String, Value)> = settings
            .iter()
            .map(|(n, v)| ((*n).to_owned(), v.clone()))
            .collect();
        orientation(kind)
            .unwrap()
            .make(shared(&curve), &settings)
            .err()
            .unwrap()
            .to_string()
    };
    let word = |w: &str| Value::Word(w.to_owned());
    assert!(message("up", &[("roll", Value::Number(1.0))]).contains("`roll`"));
    assert!(
        message(
            "up",
            &[
                ("up", Value::Vector(DVec3::Y)),
                ("up", Value::Vector(DVec3::Y))
            ]
        )
        .contains("twice")
    );
    assert!(
        message("frenet", &[("flips", word("never"))]).contains("\"repaired\", \"as-printed\"")
    );
    assert!(message("look-at", &[]).contains("`target`"));
    assert!(message("look-ahead", &[("distance", word("far"))]).contains("a number"));
    assert!(message("auxiliary", &[]).contains("`curve`"));
    assert!(
        message("rotation-minimizing", &[("turns", Value::Number(0.5))]).contains("whole number")
    );
    assert!(orientation("sideways").is_none() && modifier("leaning").is_none());
}

#[test]
fn every_kind_of_curve_can_be_a_path() {
    fn works(path: &dyn Path<Solid>) {
        let frames = RotationMinimizing::default().along(path).unwrap();
        for u in even(path, 30) {
            assert_sound(&frames.frame(u), "path");
        }
    }
    // A flat stop of order five, which three derivatives do not see.
    let flat = Bezier::new(vec![
        dvec3(1., 2., 3.),
        dvec3(1., 2., 3.),
        dvec3(1., 2., 3.),
        dvec3(1., 2., 3.),
        dvec3(1., 2., 3.),
        dvec3(2., 4., 6.),
    ])
    .unwrap();
    works(&flat);
    let frames = FixedUp::along(&flat, DVec3::Y).unwrap();
    for u in [0.0, 1e-9, 1e-3, 0.5, 1.0] {
        // At 1e-3 the velocity is 1e-11, of differences of coordinates.
        let off = (frames.frame(u).forward() - dvec3(1., 2., 3.).normalize()).length();
        assert!(off < if u == 1e-3 { 1e-4 } else { 1e-9 }, "{u}: {off:e}");
    }
    let hermite = Hermite::new(
        vec![DVec3::ZERO, DVec3::X, DVec3::ONE],
        vec![DVec3::Y, DVec3::ZERO, DVec3::Z],
    );
    works(&hermite.curve().unwrap());
}

#[test]
fn lattice_curves_are_survived() {
    // Control points of few places: repeated, collinear, coplanar, going back, in every order.
    let mut random = crate::common::Random(5);
    for round in 0..240 {
        let mut place = || {
            let p = random.solid() * 3.0;
            dvec3(p.x.floor(), p.y.floor(), p.z.floor())
                * if round % 3 == 0 { DVec3::X } else { DVec3::ONE }
        };
        let points: Vec<DVec3> = (0..7).map(|_| place()).collect();
        let closed = round % 2 == 0;
        let curve = match round % 4 {
            0 => CatmullRom {
                closed,
                ..CatmullRom::new(points)
            }
            .curve(),
            1 => CubicBezier {
                points,
                closed: false,
            }
            .curve(),
            2 => CubicBezier {
                points: points[..6].to_vec(),
                closed,
            }
            .curve(),
            _ => BSpline {
                closed,
                ..BSpline::new(points)
            }
            .curve(),
        };
        let curve = curve.unwrap();
        for entry in ORIENTATIONS {
            let made = entry.make(shared(&curve), &settings(entry.name, &curve));
            let Ok(frames) = made else {
                let moves = curve.length(1e-9) > 1e-9;
                assert!(!moves, "{} round {round}", entry.name);
                continue;
            };
            let list = parameters(&curve);
            for (u, frame) in list.iter().zip(frames.frames(&list)) {
                assert_sound(&frame, &format!("{} round {round} at {u}", entry.name));
            }
        }
    }
}

/// A number with nine decimals; what rounds to zero has no sign.
fn rounded(value: f64) -> String {
    let text = format!("{value:.9}");
    if text == "-0.000000000" {
        text[1..].to_owned()
    } else {
        text
    }
}

#[test]
fn frames_of_a_fixed_path() {
    let curve = space_curve();
    let mut lines = Vec::new();
    for entry in ORIENTATIONS {
        lines.push(entry.name.to_owned());
        let frames = entry
            .make(shared(&curve), &settings(entry.name, &curve))
            .unwrap();
        for frame in frames.frames(&even(&curve, 6)) {
            let numbers =
                [frame.up(), frame.forward()].map(|axis| axis.to_array().map(rounded).join(" "));
            lines.push(format!("  {}", numbers.join("  ")));
        }
    }
    insta::with_settings!({ omit_expression => true, prepend_module_to_snapshot => false }, {
        insta::assert_snapshot!("frames", lines.join("\n"));
    });
}
