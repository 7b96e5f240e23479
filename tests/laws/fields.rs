//! Laws over the registered fields and falloffs.

use crate::laws;
use anamorph_catalog::{Attributes, Context};
use anamorph_core::{Bounds, Domain, Field, Site};
use anamorph_fields::falloffs::{FALLOFFS, Falloff};
use anamorph_fields::recipe::entries;
use anamorph_tests::measure::{SAMPLES, breaks};
use anamorph_tests::models::boxes;
use anamorph_tests::random::Random;
use anamorph_tests::subjects::{Registered, parameters};
use std::sync::Arc;

laws!(
    names_are_unique_and_references_given,
    batches_equal_single_values_and_vanish_outside_the_support,
    gradients_equal_differences,
    declared_classes_hold_along_lines,
);

/// An attribute of 5000 vertices.
struct Weights;
impl Attributes for Weights {
    fn attribute(&self, name: &str) -> Option<Arc<[f64]>> {
        let values = (0..5000).map(|i| f64::from(i % 17) / 16.0);
        (name == "weight").then(|| values.collect())
    }
    fn names(&self) -> Vec<String> {
        vec!["weight".to_owned()]
    }
}

/// Every entry's example and settings of every falloff, built.
fn fields<S: Registered>(bounds: Bounds<S>) -> Vec<(String, Box<dyn Field<S>>)> {
    let mut texts: Vec<(&str, String)> = entries::<S>()
        .iter()
        .map(|e| (e.kind, e.example.to_owned()))
        .collect();
    let compact = FALLOFFS
        .iter()
        .copied()
        .filter(Falloff::compact)
        .map(Falloff::name);
    for name in compact {
        let falloff = format!("falloff = \"{name}\"\n");
        texts.push((
            "radial",
            format!("{falloff}centre = \"30%\"\nradius = \"40%\""),
        ));
        texts.push((
            "box",
            format!("{falloff}min = \"20%\"\nmax = \"50%\"\nmargin = \"15%\""),
        ));
        texts.push((
            "half-space",
            format!("{falloff}point = \"40%\"\nnormal = \"-x\"\nwidth = \"30%\""),
        ));
        texts.push((
            "axis",
            format!("{falloff}axis = \"-y\"\nrange = [\"10%\", \"60%\"]"),
        ));
    }
    texts.push((
        "axis",
        "axis = \"x\"\nprofile = [[0, 0], [0.3, 1], [0.6, 0.2], [1, 0.9]]".to_owned(),
    ));
    texts.push((
        "product",
        "of = [{ field = \"complement\", of = { field = \"radial\", centre = \"50%\", radius = \"40%\" } },
            { field = \"box\", min = \"10%\", max = \"80%\", margin = \"10%\" }, 0.4]"
            .to_owned(),
    ));
    let context = Context {
        bounds: Some(bounds),
        scaling: None,
        meshes: None,
        attributes: Some(&Weights),
    };
    let all = entries::<S>();
    texts
        .into_iter()
        .map(|(kind, text)| {
            let entry = all.iter().find(|e| e.kind == kind).unwrap();
            let field = (entry.construct)(&parameters(&text), &context);
            let what = format!("{kind} with\n{text}in {bounds:?}");
            let field = field.unwrap_or_else(|error| panic!("{what}: {error}"));
            (what, field)
        })
        .collect()
}

fn names_are_unique_and_references_given<S: Registered>() {
    let mut names = std::collections::HashSet::new();
    for entry in entries::<S>() {
        assert!(names.insert(entry.kind), "{}", entry.kind);
        assert!(!entry.summary.is_empty() && entry.reference.len() > 20);
    }
    let mut kinds = std::collections::HashSet::new();
    for entry in S::registry() {
        let well_formed = |c: char| c.is_ascii_lowercase() || c == '-';
        assert!(entry.kind.chars().all(well_formed), "{}", entry.kind);
        assert!(kinds.insert(entry.kind), "{}", entry.kind);
        assert!(entry.system.starts_with('B') && !entry.summary.is_empty());
        assert!(entry.reference.len() > 20);
    }
}

fn batches_equal_single_values_and_vanish_outside_the_support<S: Registered>() {
    for bounds in boxes::<S>() {
        let mut random = Random::new(5);
        let mut points: Vec<S> = (0..1003)
            .map(|_| bounds.at(S::from_fn(|_| random.between(-0.5, 1.5))))
            .collect();
        points.extend([
            S::ZERO,
            S::splat(1e150),
            bounds.min,
            bounds.max,
            bounds.centre(),
        ]);
        for (what, field) in fields(bounds) {
            let mut values = vec![f64::NAN; points.len()];
            field.values(11, &points, &mut values);
            for (i, (&p, &value)) in points.iter().zip(&values).enumerate() {
                let single = field.value(&Site::new(11 + i, p));
                assert_eq!(single.to_bits(), value.to_bits(), "{what} at {p:?}");
                assert!(
                    (0.0..=1.0 + 1e-12).contains(&value),
                    "{what} at {p:?}: {value}"
                );
                assert!(
                    value == 0.0 || field.support().contains(p),
                    "{what} at {p:?}"
                );
                assert!(field.constant().is_none_or(|c| c == value));
            }
        }
    }
}

fn gradients_equal_differences<S: Registered>() {
    for bounds in boxes::<S>() {
        let size = bounds.diagonal();
        for (what, field) in fields(bounds) {
            let site = Site::anywhere(bounds.centre());
            assert_eq!(
                field.domain() == Domain::Model,
                field.gradient(&site, size).is_none()
            );
            if field.domain() == Domain::Model {
                continue;
            }
            let (mut random, mut checked) = (Random::new(15), 0);
            for _ in 0..200 {
                let p = bounds.at(S::from_fn(|_| random.between(-0.2, 1.2)));
                let step = anamorph_core::difference_step(p, size);
                let value = |p: S| field.value(&Site::anywhere(p));
                let side = |step: f64| {
                    S::from_fn(|i| {
                        let there = p + S::unit(i) * step;
                        (value(there) - value(p)) / (there.component(i) - p.component(i))
                    })
                };
                let (fore, aft) = (side(step), side(-step));
                // In values per model size, so that boxes compare.
                if (fore - aft).largest() * size > 1e-2 {
                    continue;
                }
                let gradient = field.gradient(&Site::anywhere(p), size).unwrap();
                let error = (gradient - (fore + aft) * 0.5).largest() * size;
                assert!(error < 1e-4, "{what} at {p:?}: {error}");
                checked += 1;
            }
            assert!(checked >= 100, "{what}: {checked}");
        }
    }
}

fn declared_classes_hold_along_lines<S: Registered>() {
    let bounds = boxes::<S>()[1];
    for (what, field) in fields(bounds) {
        if field.domain() == Domain::Model {
            continue;
        }
        let mut random = Random::new(25);
        for _ in 0..12 {
            let end = |r: &mut Random| bounds.at(S::from_fn(|_| r.between(-0.4, 1.4)));
            let (from, to) = (end(&mut random), end(&mut random));
            let samples: Vec<S> = (0..SAMPLES)
                .map(|i| {
                    let p = from + (to - from) * (i as f64 / (SAMPLES - 1) as f64);
                    S::unit(0) * field.value(&Site::anywhere(p))
                })
                .collect();
            let class = field.smoothness();
            let found = breaks(&samples, class, 1e-13);
            assert_eq!(found, None, "{what} claims {class}");
        }
    }
}
