//! The worked cases of paths through orientations, at the tolerance of the case, up to a common sign of each row.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_catalog::Value;
use anamorph_core::glam::DQuat;
use anamorph_tests::cases::{fixtures, number, numbers, rows};
use anamorph_transforms::quaternion::{
    BezierPath, Keys, LerpPath, Orientations, SlerpPath, SquadPath, from_wxyz, to_wxyz,
};

fn quaternion(row: &[f64]) -> DQuat {
    from_wxyz([row[0], row[1], row[2], row[3]])
}

fn path(case: &Value) -> Box<dyn Orientations> {
    let params = &case["params"];
    let keys: Vec<DQuat> = rows(&params["keys"])
        .iter()
        .map(|row| quaternion(row))
        .collect();
    let closed = params["closed"].as_bool().unwrap_or(false);
    let keys = match (params.get("times"), closed) {
        (Some(times), false) => Keys::new(&keys, &numbers(times)),
        (Some(times), true) => Keys::closed(&keys, &numbers(times)),
        (None, false) => Keys::even(&keys),
        (None, true) => Keys::closed_even(&keys),
    };
    let keys = keys.unwrap();
    // Times in `quaternions.timed_path` are always those of Bézier segments. Its `weights` do not matter in these cases:
    // either the times are even or the rate is.
    match params.get("kind").and_then(Value::as_str) {
        None | Some("bezier") => Box::new(BezierPath::new(&keys)),
        Some("slerp") => Box::new(SlerpPath::new(&keys)),
        Some("lerp") => Box::new(LerpPath::new(&keys)),
        Some("squad") => Box::new(SquadPath::new(&keys)),
        Some(other) => panic!("{other}"),
    }
}

#[test]
fn every_case_is_met() {
    let folder = fixtures().join("cases/quaternions");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let text = std::fs::read_to_string(entry.unwrap().path()).unwrap();
        let case: Value = serde_json::from_str(&text).unwrap();
        let id = case["id"].as_str().unwrap();
        assert!(case["op"].as_str().unwrap().starts_with("quaternions."));
        assert_eq!(case["compare"].as_str().unwrap(), "quaternion");
        let tolerance = number(&case["tol"]);
        let path = path(&case);
        let (times, expected) = (rows(&case["in"]), rows(&case["out"]));
        assert_eq!(times.len(), expected.len());
        for (time, wanted) in times.iter().zip(&expected) {
            let (found, wanted) = (path.orientation(time[0]), quaternion(wanted));
            let same = if found.dot(wanted) < 0.0 {
                -found
            } else {
                found
            };
            let size = to_wxyz(wanted).iter().fold(1.0, |m: f64, c| m.max(c.abs()));
            let off = to_wxyz(same - wanted)
                .iter()
                .fold(0.0, |m: f64, c| m.max(c.abs()));
            assert!(
                off <= tolerance * size,
                "{id}, at {}: {found:?}, not {wanted:?} ({off:e})",
                time[0]
            );
        }
        count += 1;
    }
    assert!(count >= 3, "{count}");
}
