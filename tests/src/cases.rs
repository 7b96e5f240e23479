//! Worked cases: inputs and expected outputs computed by an independent implementation, read from
//! `fixtures/cases/*.json`.
//!
//! Units are scene units and radians; matrices are rows and act on columns; lattices are flat, the last index fastest. The
//! affine map `{L, t, c}` is `p ↦ c + t + L(p − c)`; the field `{"hat": R}` is `(1 − (d/R)²)²` about `c`.

use anamorph_catalog::Value;
use anamorph_core::{Affine, Deformation, Field, Linear, Space, map_all};
use anamorph_fields::{Radial, falloffs::Wires};
use std::path::PathBuf;

/// The folder of all fixtures.
pub fn fixtures() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures")
}

/// One worked case.
pub struct Case {
    /// Its name, that of its file.
    pub id: String,
    /// What is computed.
    pub op: String,
    /// The parameters of `op`.
    pub params: Value,
    /// Greatest difference of a coordinate, times the larger of 1 and the largest coordinate of the row.
    pub tol: f64,
    points: Value,
    expected: Value,
}

/// All cases, by name.
pub fn all() -> Vec<Case> {
    let folder = fixtures().join("cases");
    let mut paths: Vec<PathBuf> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    paths.sort();
    paths
        .iter()
        .map(|path| {
            let text = std::fs::read_to_string(path).unwrap();
            let value: Value = serde_json::from_str(&text).unwrap();
            let text = |key: &str| value[key].as_str().unwrap().to_owned();
            assert_eq!(text("compare"), "points", "{}", path.display());
            Case {
                id: text("id"),
                op: text("op"),
                params: value["params"].clone(),
                tol: number(&value["tol"]),
                points: value["in"].clone(),
                expected: value["out"].clone(),
            }
        })
        .collect()
}

impl Case {
    /// Number of coordinates of its points.
    pub fn dimension(&self) -> usize {
        rows(&self.points)[0].len()
    }

    /// What goes in, row by row.
    pub fn input(&self) -> Vec<Vec<f64>> {
        rows(&self.points)
    }

    /// Compares rows with those expected; returns how many were compared.
    pub fn compare(&self, found: &[Vec<f64>]) -> usize {
        let expected = rows(&self.expected);
        assert_eq!(found.len(), expected.len(), "{}", self.id);
        for (i, (found, wanted)) in found.iter().zip(&expected).enumerate() {
            assert_eq!(found.len(), wanted.len(), "{}, row {i}", self.id);
            let size = wanted.iter().fold(1.0_f64, |m, w| m.max(w.abs()));
            for (f, w) in found.iter().zip(wanted) {
                let error = (f - w).abs();
                assert!(
                    error <= self.tol * size,
                    "{}, row {i}: {found:?} is not {wanted:?} ({error:e})",
                    self.id
                );
            }
        }
        found.len()
    }

    /// Moves the points of the case and compares them with those expected; returns how many were compared.
    pub fn check<S: Space>(&self, deformation: &dyn Deformation<S>) -> usize {
        let start: Vec<S> = rows(&self.points).iter().map(|row| point(row)).collect();
        let expected: Vec<S> = rows(&self.expected).iter().map(|row| point(row)).collect();
        assert_eq!(start.len(), expected.len(), "{}", self.id);
        let mut moved = start.clone();
        assert!(map_all(deformation, &mut moved).is_empty(), "{}", self.id);
        for (i, (&found, &wanted)) in moved.iter().zip(&expected).enumerate() {
            let error = (found - wanted).largest();
            let tolerance = self.tol * wanted.largest().max(1.0);
            assert!(
                error <= tolerance,
                "{}, row {i}: {:?} goes to {found:?}, not {wanted:?} ({error:e})",
                self.id,
                start[i]
            );
        }
        assert_ne!(start, moved, "{} moves nothing", self.id);
        moved.len()
    }
}

/// A number.
pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// A list of numbers.
pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

/// A list of rows of numbers.
pub fn rows(value: &Value) -> Vec<Vec<f64>> {
    value.as_array().unwrap().iter().map(numbers).collect()
}

/// A point from its coordinates.
pub fn point<S: Space>(row: &[f64]) -> S {
    assert_eq!(row.len(), S::DIM);
    S::from_fn(|i| row[i])
}

/// A matrix from its rows.
pub fn matrix<S: Space>(value: &Value) -> S::Linear {
    let rows = rows(value);
    S::Linear::from_columns(|column| S::from_fn(|row| rows[row][column]))
}

/// The affine map `{L, t, c}` and its centre.
pub fn affine<S: Space>(value: &Value) -> (Affine<S>, S) {
    let centre = point(&numbers(&value["c"]));
    let map = Affine::about(
        centre,
        matrix::<S>(&value["L"]),
        point(&numbers(&value["t"])),
    );
    (map, centre)
}

/// A field: a number or `{"hat": R}` about a centre, times `factor`.
pub fn field<S: Space>(value: &Value, centre: S, factor: f64) -> Box<dyn Field<S>> {
    match value.get("hat") {
        Some(radius) => {
            let hat = Radial::new(centre, number(radius), Wires).unwrap();
            if factor == 1.0 {
                Box::new(hat)
            } else {
                Box::new(anamorph_fields::Scaled::new(hat, factor).unwrap())
            }
        }
        None => Box::new(number(value) * factor),
    }
}
