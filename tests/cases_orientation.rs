//! Worked cases of rotation-minimizing frames.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::{Solid, glam::DVec3};
use anamorph_curves::families::{CatmullRom, CubicBezier, Generator, Spacing};
use anamorph_curves::orientation::{End, Frame, Orienter, RotationMinimizing};
use anamorph_tests::cases::{Case, all, numbers, point, rows};

fn frames(case: &Case) -> Vec<Frame> {
    let points = rows(&case.params["points"])
        .iter()
        .map(|row| point::<Solid>(row))
        .collect();
    let curve = match case.params["kind"].as_str().unwrap() {
        "catmull_rom" => CatmullRom::new(points).spaced(Spacing::Uniform).curve(),
        "bezier" => CubicBezier {
            points,
            closed: false,
        }
        .curve(),
        other => panic!("{}: no test computes {other}", case.id),
    };
    let settings = RotationMinimizing {
        up: point(&numbers(&case.params["start"])),
        end: End::Free,
        ..RotationMinimizing::default()
    };
    let curve = curve.unwrap();
    let parameters: Vec<f64> = case.input().iter().map(|row| row[0]).collect();
    settings.along(&curve).unwrap().frames(&parameters)
}

#[test]
fn rotation_minimizing_frames_are_those_of_the_differential_equation() {
    let mut cases = all();
    cases.retain(|case| case.op == "curves.rmf");
    assert!(cases.len() >= 2, "{}", cases.len());
    for case in &cases {
        // The axes of the cases are direction, up, and their cross product: the right, opposite to the side axis.
        let row = |frame: Frame| {
            let axes: [DVec3; 3] = [frame.forward(), frame.up(), -frame.side()];
            axes.iter().flat_map(DVec3::to_array).collect()
        };
        let found: Vec<Vec<f64>> = frames(case).into_iter().map(row).collect();
        assert!(case.compare(&found) > 0, "{}", case.id);
    }
}
