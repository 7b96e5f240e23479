//! Worked cases of eq. (3) with both scaling methods, from an independent implementation.

// A fixture that does not read fails the test that asked for it.
#![allow(clippy::expect_used)]

use std::error::Error;

use anamorph_core::glam::{DMat3, DVec2, DVec3};
use anamorph_core::{
    Affine, Average, Deformation, Field, Linear, Site, Smoothness, Space, Support, Term, Terms,
    Transformation, reference,
};
use anamorph_transforms::{Composed, Rotational};
use serde_json::Value;

/// `(1 − (r/R)²)²` inside the radius, times a factor.
struct Hat<S> {
    centre: S,
    radius: f64,
    factor: f64,
}

impl<S: Space> Field<S> for Hat<S> {
    fn value(&self, site: &Site<S>) -> f64 {
        let t = site.point.distance(self.centre) / self.radius;
        let inside = 1.0 - t * t;
        if t < 1.0 {
            self.factor * inside * inside
        } else {
            0.0
        }
    }
    fn support(&self) -> Support<S> {
        Support::Ball {
            centre: self.centre,
            radius: self.radius,
        }
    }
    fn smoothness(&self) -> Smoothness {
        Smoothness::C(1)
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn vector<S: Space>(value: &Value) -> S {
    S::from_fn(|i| number(&value[i]))
}

fn field<S: Space>(value: &Value, centre: S, factor: f64) -> Box<dyn Field<S>> {
    match value.get("hat") {
        Some(radius) => Box::new(Hat {
            centre,
            radius: number(radius),
            factor,
        }),
        None => Box::new(factor * number(value)),
    }
}

/// A transformation multiplied by a time: way 1 of varying a warp over time (FW §8.1).
struct Timed<S: Space>(Box<dyn Transformation<S>>, f64);

impl<S: Space> Transformation<S> for Timed<S> {
    fn affine(&self) -> Affine<S> {
        self.0.scaled(self.1)
    }
    fn scaled(&self, strength: f64) -> Affine<S> {
        self.0.scaled(self.1 * strength)
    }
    fn scaling(&self) -> anamorph_core::Scaling {
        self.0.scaling()
    }
}

fn terms<S: Rotational>(params: &Value, way: Option<u64>) -> Vec<Term<S>> {
    let t = params.get("t").map_or(1.0, number);
    let term = |term: &Value| {
        let centre: S = vector(&term["c"]);
        let linear = S::Linear::from_columns(|j| S::from_fn(|i| number(&term["L"][i][j])));
        let affine = Affine::about(centre, linear, vector(&term["t"]));
        let transformation: Box<dyn Transformation<S>> = match term["method"].as_str() {
            Some("composition") => Box::new(Composed::new(affine, centre).expect("finite")),
            _ => Box::new(affine),
        };
        let strength = if way == Some(3) { t } else { 1.0 };
        let transformation: Box<dyn Transformation<S>> = match way {
            // Ways 2 and 3 coincide (errata F19): the transformation or its strength times t.
            Some(2) => Box::new(Timed(transformation, t)),
            _ => transformation,
        };
        Term {
            transformation,
            strength: field(&term["s"], centre, strength),
            weight: field(&term["w"], centre, 1.0),
        }
    };
    let list = params["terms"].as_array().expect("terms");
    list.iter().map(term).collect()
}

fn check<S: Rotational>(text: &str) -> Result<(), Box<dyn Error>> {
    let case: Value = serde_json::from_str(text)?;
    let way = case["params"].get("way").and_then(Value::as_u64);
    if way == Some(3) {
        check_way::<S>(&case, Some(2))?;
    }
    check_way::<S>(&case, way)
}

fn check_way<S: Rotational>(case: &Value, way: Option<u64>) -> Result<(), Box<dyn Error>> {
    let params = &case["params"];
    let average = match params.get("ambient") {
        Some(epsilon) => Average::Ambient(number(epsilon)),
        None => Average::Weights,
    };
    // Way 1: the whole deforming function is scaled, which is a blend of the result.
    let blend = match way {
        Some(1) => number(&params["t"]),
        _ => 1.0,
    };
    let warp = Terms::new(terms::<S>(params, way)).with_average(average);
    let tolerance = number(&case["tol"]);
    let (input, output) = (
        case["in"].as_array().ok_or("no input")?,
        case["out"].as_array().ok_or("no output")?,
    );
    assert_eq!(input.len(), output.len());
    assert!(!input.is_empty());
    for (index, (from, to)) in input.iter().zip(output).enumerate() {
        let (from, to): (S, S) = (vector(from), vector(to));
        let site = Site::new(index, from);
        let limit = tolerance * to.largest().max(1.0);
        for moved in [
            warp.map(&site),
            reference::evaluate_terms(warp.terms(), average, &site),
        ] {
            let moved = from + (moved - from) * blend;
            assert!(
                (moved - to).largest() <= limit,
                "row {index}: {from:?} went to {moved:?} and not to {to:?}"
            );
        }
    }
    Ok(())
}

macro_rules! case {
    ($name:ident, $space:ty) => {
        #[test]
        fn $name() -> Result<(), Box<dyn Error>> {
            check::<$space>(include_str!(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../tests/fixtures/cases/",
                stringify!($name),
                ".json"
            )))
        }
    };
}

case!(framework_composition_2d, DVec2);
case!(framework_fields_3d, DVec3);
case!(framework_ambient, DVec3);
case!(framework_time_way1, DVec2);
case!(framework_time_way3, DVec2);

#[test]
fn errata_f19_ways_two_and_three_coincide() {
    let term = |t: f64, scaled_map: bool| -> Term<DVec3> {
        let linear = DMat3::from_cols(
            DVec3::new(0.2, 1.4, 0.0),
            DVec3::new(-0.9, 0.1, 0.3),
            DVec3::new(0.0, 0.2, 1.0),
        );
        let centre = DVec3::new(0.3, 0.0, -0.2);
        let composed = Composed::new(Affine::new(linear, DVec3::X), centre).expect("finite");
        let (map_time, field_time) = if scaled_map { (t, 1.0) } else { (1.0, t) };
        Term {
            transformation: Box::new(Timed(Box::new(composed), map_time)),
            strength: Box::new(Hat {
                centre,
                radius: 2.0,
                factor: field_time,
            }),
            weight: Box::new(1.0),
        }
    };
    for t in [0.0, 0.3, 1.0] {
        for p in [DVec3::ZERO, DVec3::ONE, DVec3::new(0.5, -1.0, 0.7)] {
            let two = Terms::new(vec![term(t, true)]).map(&Site::anywhere(p));
            let three = Terms::new(vec![term(t, false)]).map(&Site::anywhere(p));
            assert!((two - three).length() < 1e-14);
        }
    }
}
