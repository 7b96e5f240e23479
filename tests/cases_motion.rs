//! Worked cases of eases and of smoothing.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::{Plane, Space};
use anamorph_curves::eases::{self, Ease, Setting};
use anamorph_curves::smoothing::{Filter, FourNeighbourCubic, NeighbourAverage, Smoothing, smooth};
use anamorph_tests::cases::{Case, all, number, numbers, point};

fn ease(case: &Case) -> Box<dyn Ease> {
    let of = |key: &str| Setting::Number(number(&case.params[key]));
    let (name, settings) = match case.params["kind"].as_str().unwrap() {
        "cubic" => ("cubic", vec![]),
        "sine" => ("sinusoidal", vec![]),
        "piecewise_sine" => (
            "piecewise-sinusoidal",
            vec![("k1", of("k1")), ("k2", of("k2"))],
        ),
        "constant_acceleration" => (
            "constant-acceleration",
            vec![("t1", of("k1")), ("t2", of("k2"))],
        ),
        "css" => {
            let control = numbers(&case.params["control"]);
            let names = ["x1", "y1", "x2", "y2"];
            let given = names
                .into_iter()
                .zip(control.into_iter().map(Setting::Number));
            ("cubic-bezier", given.collect())
        }
        other => panic!("{}: no test computes {other}", case.id),
    };
    eases::ease(name, &settings).unwrap()
}

fn smoothed(case: &Case) -> Vec<Vec<f64>> {
    let path: Vec<Plane> = case.input().iter().map(|row| point(row)).collect();
    let flag = |key: &str| {
        case.params
            .get(key)
            .is_some_and(|flag| flag.as_bool().unwrap())
    };
    let filter: &dyn Filter = match case.params["kind"].as_str().unwrap() {
        "average" => &NeighbourAverage,
        "cubic" => &FourNeighbourCubic,
        other => panic!("{}: no test computes {other}", case.id),
    };
    let smoothing = Smoothing {
        closed: flag("closed"),
        pin_ends: flag("pin"),
        ..Smoothing::default()
    };
    let moved = smooth(&path, filter, &smoothing).unwrap();
    assert_ne!(moved, path);
    let row = |p: &Plane| (0..2).map(|axis| p.component(axis)).collect();
    moved.iter().map(row).collect()
}

#[test]
fn every_case_of_eases_and_smoothing_is_met() {
    let mut met = [0, 0];
    for case in all() {
        match case.op.as_str() {
            "curves.ease" => {
                let ease = ease(&case);
                let found: Vec<Vec<f64>> = case
                    .input()
                    .iter()
                    .map(|row| vec![ease.value(row[0])])
                    .collect();
                assert!(case.compare(&found) > 0);
                met[0] += 1;
            }
            "curves.smooth" => {
                assert!(case.compare(&smoothed(&case)) > 0);
                met[1] += 1;
            }
            _ => {}
        }
    }
    assert!(met[0] >= 7 && met[1] >= 3, "{met:?}");
}
