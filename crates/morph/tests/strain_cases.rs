//! The worked cases of shapes that become one another: strain fields with their energies, and as-rigid-as-possible in-betweens.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod bodies;

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_morph::strain::{Element, Pair, Rigid, Settings, Shear, Weight, method};
use bodies::{apart, apart_rigidly};
use serde_json::Value;

fn places(value: &Value) -> Vec<DVec2> {
    let rows = value.as_array().unwrap().iter();
    rows.map(|row| dvec2(row[0].as_f64().unwrap(), row[1].as_f64().unwrap()))
        .collect()
}

fn index(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap()).unwrap()
}

fn elements(value: &Value) -> Vec<Element> {
    let rows = value.as_array().unwrap().iter();
    rows.map(|row| {
        let list: Vec<usize> = row.as_array().unwrap().iter().map(index).collect();
        Element::of(&list).unwrap()
    })
    .collect()
}

/// The energies that a note says.
fn energies(note: &str) -> Vec<f64> {
    let list = note.split_once("energies [").unwrap().1;
    let list = list.split_once(']').unwrap().0;
    list.split(", ").map(|e| e.parse().unwrap()).collect()
}

#[test]
fn every_case_is_met() {
    let folder = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/fixtures/cases/strain"
    );
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let text = std::fs::read_to_string(entry.unwrap().path()).unwrap();
        let case: Value = serde_json::from_str(&text).unwrap();
        let id = case["id"].as_str().unwrap();
        let params = &case["params"];
        let (source, target) = (places(&params["source"]), places(&params["target"]));
        let mut settings = Settings::default();
        let (pair, name) = match case["op"].as_str().unwrap() {
            "arap.morph" => {
                settings.pinned = index(&params["pinned"]);
                settings.weight = Weight::by_name(params["weight"].as_str().unwrap()).unwrap();
                let pair = Pair::new(source, target, elements(&params["triangles"])).unwrap();
                (pair, "as-rigid-as-possible")
            }
            "strain.morph" => {
                assert_eq!(params["axes"], "source");
                settings.shear = match params["shear"].as_f64().unwrap() {
                    0.5 => Shear::Tensor,
                    1.0 => Shear::Printed,
                    other => panic!("{other}"),
                };
                settings.symmetric = params["symmetric"].as_bool().unwrap();
                settings.turns = i32::try_from(params["turns"].as_i64().unwrap()).unwrap();
                settings.rigid = match params["rigid"].as_str().unwrap() {
                    "best" => Rigid::Best,
                    "AB" => Rigid::Anchors(index(&params["A"]), index(&params["B"])),
                    other => panic!("{other}"),
                };
                let pair = Pair::new(source, target, elements(&params["elements"])).unwrap();
                (pair, params["scheme"].as_str().unwrap())
            }
            other => panic!("{other}"),
        };
        let morph = method(name).unwrap().prepare(&pair, &settings).unwrap();
        let tolerance = case["tol"].as_f64().unwrap();
        let times = case["in"].as_array().unwrap();
        let wanted = case["out"].as_array().unwrap();
        assert_eq!(times.len(), wanted.len());
        for (k, (time, wanted)) in times.iter().zip(wanted).enumerate() {
            let frame = morph.at(time[0].as_f64().unwrap()).unwrap();
            let wanted = places(wanted);
            let off = match case["compare"].as_str().unwrap() {
                "frames" => apart(&frame.positions, &wanted),
                "frames_rigid" => apart_rigidly(&frame.positions, &wanted),
                other => panic!("{other}"),
            };
            assert!(off <= tolerance, "{id}, frame {k}: off by {off:e}");
            if name != "as-rigid-as-possible" {
                let (found, wanted) = (
                    frame.solution.energy,
                    energies(case["note"].as_str().unwrap())[k],
                );
                assert!(
                    (found - wanted).abs() < 1e-5 * wanted + 1e-20,
                    "{id}, frame {k}: energy {found:e}, not {wanted:e}"
                );
                assert!(
                    frame.solution.residual < 1e-10,
                    "{id}: {:?}",
                    frame.solution
                );
            }
            count += 1;
        }
    }
    assert_eq!(count, 31);
}
