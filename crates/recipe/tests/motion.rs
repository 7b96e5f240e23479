//! Motions from recipes: everything that is registered can be named, places of errors, and hostile input.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

use anamorph_core::Solid;
use anamorph_curves::eases::{self, Setting};
use anamorph_curves::families::registry::FAMILIES;
use anamorph_recipe::{Attitude, BuiltMotion, Recipe, SMOOTHINGS, Subject};

fn build(inside: &str) -> Result<BuiltMotion, String> {
    let text = format!("version = 1\n[motion]\n{inside}\n");
    let recipe = Recipe::from_toml(&text, "m.toml").map_err(|error| error.to_string())?;
    recipe.build_motion(None).map_err(|error| error.to_string())
}

fn built(inside: &str) -> BuiltMotion {
    build(inside).unwrap_or_else(|error| panic!("{inside}: {error}"))
}

const POINTS: &str =
    "points = [[0, 0, 0], [1, 2, 0], [3, 2, 1], [4, 0, 1], [5, -1, 1], [7, 0, 0], [8, 2, 0]]";
const PATH: &str = "duration = 2\npath = { kind = \"catmull-rom\", points = [[0, 0, 0], [1, 2, 0], [3, 2, 1], [4, 0, 1]] }";

#[test]
fn every_family_can_be_named_with_all_it_reads() {
    for family in FAMILIES {
        let mut path = format!("kind = \"{}\", {POINTS}", family.name);
        if family.velocities {
            path.push_str(", velocities = [[1, 0, 0], [1, 0, 0], [1, 0, 0], [1, 0, 0], [1, 0, 0], [1, 0, 0], [1, 0, 0]]");
        }
        if let Some(word) = family.times.filter(|word| *word != "knots") {
            path.push_str(&format!(", {word} = [0, 1, 2, 3, 4, 6, 7]"));
        }
        for number in family.numbers {
            path.push_str(&format!(", {} = {}", number.name, number.default));
        }
        let motion = built(&format!("duration = 3\npath = {{ {path} }}"));
        assert_eq!((motion.family, motion.points.len()), (family.name, 7));
        assert!(
            (motion.motion.position(3.0) - Solid::new(8.0, 2.0, 0.0)).length() < 1e-9,
            "{}",
            family.name
        );
    }
}

#[test]
fn every_ease_can_be_named_with_its_parameters() {
    for entry in eases::registry() {
        assert!(
            entry
                .parameters
                .iter()
                .all(|p| !["ease", "distance"].contains(&p.name))
        );
        let mut table = format!("ease = \"{}\"", entry.name);
        for parameter in entry.parameters {
            let value = match parameter.default {
                Setting::Number(number) => format!("{number:?}"),
                Setting::Word(word) => format!("\"{word}\""),
                Setting::Stops(_) => "[[0, 0], [0.5, 0.1], [1, 1]]".to_owned(),
            };
            table.push_str(&format!(", {} = {value}", parameter.name));
        }
        let long = built(&format!("{PATH}\nspeed = {{ {table} }}"));
        let short = built(&format!("{PATH}\nspeed = \"{}\"", entry.name));
        let length = long.motion.table().length();
        assert!(
            (short.motion.distance(2.0) - length).abs() < 0.01 * length,
            "{}",
            entry.name
        );
        if entry.name != "stops" {
            for time in [0.3, 1.1, 1.9] {
                let off = long.motion.distance(time) - short.motion.distance(time);
                assert!(off.abs() < 1e-9, "{} {time}", entry.name);
            }
        }
    }
}

#[test]
fn every_smoothing_can_be_named() {
    let noisy = "points = [[0, 0], [1, 1], [2, 0], [3, 1], [4, 0], [5, 1], [6, 0], [7, 1]]";
    for entry in SMOOTHINGS {
        let mut table = format!("kind = \"{}\", repeat = 2", entry.name);
        for (name, _, default) in entry.numbers {
            table.push_str(&format!(", {name} = {default}"));
        }
        let motion = built(&format!(
            "duration = 1\npath = {{ kind = \"b-spline\", degree = 1, {noisy}, smooth = {{ {table}, pinned = [3] }} }}"
        ));
        assert!(motion.plane);
        assert_eq!(motion.points[3], Solid::new(3.0, 1.0, 0.0));
        assert_eq!(motion.points[0], Solid::ZERO);
        let moved = (motion.points[4].y - 0.0).abs();
        assert!(moved > 0.05, "{}", entry.name);
    }
}

#[test]
fn shares_are_of_the_path_and_of_the_duration() {
    let motion = built(&format!(
        "{PATH}\nspeed = {{ distances = [[0, 0], [\"25%\", \"50%\"], [\"100%\", \"100%\"]] }}"
    ));
    let length = motion.motion.table().length();
    assert!((motion.motion.distance(0.5) - 0.5 * length).abs() < 1e-9);
    assert!((motion.motion.distance(2.0) - length).abs() < 1e-9);
    let ring = built(
        "duration = 2\npath = { kind = \"catmull-rom\", closed = true, points = [[0, 0], [1, 1], [2, 0]] }\n\
         speed = { ease = \"linear\", distance = \"300%\" }",
    );
    assert!((ring.motion.distance(2.0) - 3.0 * ring.motion.table().length()).abs() < 1e-9);
    assert!(ring.findings.is_empty(), "{:?}", ring.findings);
    let by = built(&format!("{PATH}\nby = \"parameter\""));
    let path = by.motion.path();
    let (start, end) = path.domain();
    let half = path.point(0.5 * (start + end));
    assert!((by.motion.position(1.0) - half).length() < 1e-12);
}

#[test]
fn even_keys_turn_evenly_and_closed_ones_return() {
    let keys = "keys = [{ time = 0, axis = \"x\", angle = \"0deg\" }, { time = 0.2, axis = \"y\", angle = \"80deg\" }, \
        { time = 1.5, axis = \"z\", angle = \"70deg\" }]";
    for kind in ["lerp", "slerp", "squad", "bezier", "spline"] {
        let motion = built(&format!(
            "{PATH}\norientation = {{ kind = \"{kind}\", even = true, {keys} }}"
        ));
        let Attitude::Keyed(path) = &motion.attitude else {
            panic!("{kind} has keys")
        };
        let speeds: Vec<f64> = (1..15)
            .map(|i| path.angular_velocity(0.1 * f64::from(i)).length())
            .collect();
        assert!(
            speeds.iter().all(|s| (s - speeds[0]).abs() < 1e-6),
            "{kind} {speeds:?}"
        );
        let closed = built(&format!(
            "{PATH}\norientation = {{ kind = \"{kind}\", closed = true, {keys} }}"
        ));
        let turned = closed.rotations(&[0.0, 2.0]);
        assert!(turned[0].dot(turned[1]).abs() > 1.0 - 1e-12, "{kind}");
    }
}

#[test]
fn a_camera_looks_where_an_object_faces() {
    for orientation in ["frenet", "up", "rotation-minimizing"] {
        let inside = |subject: &str| {
            format!("{PATH}\nsubject = \"{subject}\"\norientation = \"{orientation}\"")
        };
        let (object, camera) = (built(&inside("object")), built(&inside("camera")));
        assert_eq!(
            (object.subject, camera.subject),
            (Subject::Object, Subject::Camera)
        );
        let times = [0.0, 0.7, 1.4];
        for (a, b) in object
            .rotations(&times)
            .iter()
            .zip(camera.rotations(&times))
        {
            assert!((*a * Solid::Z + b * Solid::Z).length() < 1e-12);
            assert!((*a * Solid::Y - b * Solid::Y).length() < 1e-12);
        }
    }
    // Banking leans, by default as for the motion's mean speed.
    let lean = |banking: &str| {
        let motion = built(&format!(
            "{PATH}\norientation = {{ kind = \"up\"{banking} }}"
        ));
        let q = motion.rotations(&[0.6])[0];
        let ahead = q * Solid::Z;
        // The sine of the lean: the height of the side axis, over that of the up axis of a frame that does not lean.
        (q * Solid::X).y.abs() / (1.0 - ahead.y * ahead.y).sqrt()
    };
    assert!(lean("") < 1e-9 && lean(", banking = true") > 0.01);
    assert!(lean(", banking = false") < 1e-9);
    let limited = lean(", banking = { speed = 100, limit = \"20deg\" }");
    assert!(
        (limited - 20_f64.to_radians().sin()).abs() < 1e-9,
        "{limited}"
    );
}

#[test]
fn all_unknown_keys_are_reported_at_once_with_their_places() {
    let error = build(
        "duration = 1\npth = 3\npath = { kind = \"catmull-rom\", pionts = [], points = [[0, 0], [1, 1]] }\n\
         orientation = { kind = \"look-at\", targt = [0, 0, 0] }",
    )
    .err()
    .unwrap();
    for words in [
        "m.toml:4:1: motion.pth: unknown key `pth`; did you mean `path`?",
        "m.toml:5:32: motion.path.pionts",
        "did you mean `points`?",
        "m.toml:6:35: motion.orientation.targt",
        "did you mean `target`?",
    ] {
        assert!(error.contains(words), "no {words:?} in {error}");
    }
}

#[test]
fn no_mutilated_recipe_panics() {
    let whole = format!(
        "version = 1\n[motion]\n{PATH}\nby = \"parameter\"\nspeed = {{ speeds = [[0, 1], [\"50%\", 2, \"fixed\"], [2, 0]] }}\n\
         orientation = {{ kind = \"squad\", even = true, keys = [{{ time = 0, axis = \"y\", angle = \"9deg\" }}, {{ time = 1, quaternion = [1, 0, 0, 2] }}] }}\n"
    );
    assert!(
        Recipe::from_toml(&whole, "m.toml")
            .unwrap()
            .build_motion(None)
            .is_ok()
    );
    let words = [
        "0",
        "-1",
        "1e300",
        "\"50%\"",
        "[]",
        "{}",
        "true",
        "\"x\"",
        "[[]]",
        "1e-300",
        "9223372036854775807",
    ];
    let mut state = 7_u64;
    let mut random = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as usize) % below
    };
    let starts: Vec<usize> = whole
        .match_indices([' ', '[', ',', '='])
        .map(|(i, _)| i + 1)
        .collect();
    let (mut good, mut bad) = (0, 0);
    for _ in 0..4000 {
        let from = starts[random(starts.len())];
        let to = starts[random(starts.len())].max(from).min(from + 12);
        let to = (to..=whole.len())
            .find(|i| whole.is_char_boundary(*i))
            .unwrap();
        let text = format!(
            "{}{}{}",
            &whole[..from],
            words[random(words.len())],
            &whole[to..]
        );
        match Recipe::from_toml(&text, "m.toml").and_then(|recipe| recipe.build_motion(None)) {
            Ok(motion) => {
                good += 1;
                for time in [0.0, 0.3, 1e9, -1.0, f64::NAN] {
                    assert!(motion.motion.position(time).is_finite(), "{text}");
                }
                assert!(
                    motion
                        .rotations(&[0.0, 0.5])
                        .iter()
                        .all(|q| (q.length() - 1.0).abs() < 1e-9),
                    "{text}"
                );
            }
            Err(error) => {
                bad += 1;
                assert!(error.to_string().starts_with("m.toml:"), "{error}");
            }
        }
    }
    assert!(good > 50 && bad > 500, "{good} {bad}");
}
