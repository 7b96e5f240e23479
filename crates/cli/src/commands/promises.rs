//! What the parts of a built recipe and the whole of it promise, for `check` and for reports.

use crate::model::ModelSpace;
use anamorph_core::guarantees::{
    Guarantee, Property, Verdict, continuity, interpolation_of, no_fold, undecided,
};
use anamorph_core::{Deformation, Domain, Warp};
use anamorph_recipe::BuiltRecipe;
use serde_json::{Value, json};

/// Points at which Jacobians are examined, at most; a larger model is sampled evenly.
const EXAMINED: usize = 50_000;

/// The promises of one deformation.
pub(crate) struct Promises<S> {
    /// Number of the warp in the recipe, or `None` for all of it.
    pub index: Option<usize>,
    /// What it is called.
    pub title: String,
    /// Its kind; `stack` for the whole.
    pub kind: String,
    pub guarantees: Vec<Guarantee<S>>,
    pub notes: Vec<String>,
    pub domain: Domain,
}

/// The promises of every part (on the model as it arrives there) and, when there are several, of the whole.
pub(crate) fn promises<S: ModelSpace>(
    built: &BuiltRecipe<S>,
    points: &[S],
    size: f64,
) -> Vec<Promises<S>> {
    let mut here = sample(points);
    let original = here.clone();
    let mut all = Vec::new();
    for part in &built.parts {
        let guarantees = vec![
            interpolation_of(&part.deformation, &part.warp.conditions(), size),
            continuity(&part.deformation),
            no_fold(&part.deformation, &here, size),
            undecided(Property::Invertibility),
            undecided(Property::Commutation),
        ];
        all.push(Promises {
            index: Some(part.index),
            title: part.title().to_owned(),
            kind: part.kind.to_owned(),
            guarantees,
            notes: part.deformation.facts().notes,
            domain: part.deformation.domain(),
        });
        let _ = part.deformation.map_points(0, &mut here);
    }
    if built.parts.len() != 1 {
        let stack = built.stack();
        let guarantees = vec![
            undecided(Property::Interpolation),
            continuity(&stack),
            no_fold(&stack, &original, size),
            undecided(Property::Invertibility),
            undecided(Property::Commutation),
        ];
        all.push(Promises {
            index: None,
            title: "the whole".to_owned(),
            kind: "stack".to_owned(),
            guarantees,
            notes: Vec::new(),
            domain: stack.domain(),
        });
    }
    all
}

/// Points spread over a model, few enough to be examined one by one.
fn sample<S: ModelSpace>(points: &[S]) -> Vec<S> {
    let step = points.len().div_ceil(EXAMINED).max(1);
    let finite = points.iter().copied().filter(|p| p.is_finite());
    finite.step_by(step).collect()
}

/// A sentence about the place where a recipe turns the model inside out, if one is found.
pub(crate) fn fold<S: ModelSpace>(
    built: &BuiltRecipe<S>,
    points: &[S],
    size: f64,
) -> Option<String> {
    let guarantee = no_fold(&built.stack(), &sample(points), size);
    let witness = guarantee.witness?;
    (guarantee.verdict == Verdict::Refuted).then(|| {
        let place: Vec<String> = (0..S::DIM)
            .map(|axis| crate::files::short(witness.place.component(axis)))
            .collect();
        format!(
            "it folds over, first seen at ({}) of the original",
            place.join(", ")
        )
    })
}

/// As JSON.
pub(crate) fn to_json<S: ModelSpace>(promises: &[Promises<S>]) -> Value {
    let coordinates = |p: S| -> Vec<f64> { (0..S::DIM).map(|axis| p.component(axis)).collect() };
    promises
        .iter()
        .map(|p| {
            let guarantees: Vec<Value> = p
                .guarantees
                .iter()
                .map(|g| {
                    json!({
                        "property": g.property.name(),
                        "verdict": g.verdict.name(),
                        "statement": g.statement,
                        "witness": g.witness.map(|w| json!({ "place": coordinates(w.place), "value": w.value })),
                    })
                })
                .collect();
            json!({
                "index": p.index,
                "title": p.title,
                "kind": p.kind,
                "lives": if p.domain == Domain::Space { "in space" } else { "on the model" },
                "guarantees": guarantees,
                "notes": p.notes,
            })
        })
        .collect()
}

/// As text: a block a deformation.
pub(crate) fn to_text<S: ModelSpace>(promises: &[Promises<S>]) -> String {
    let mut text = String::new();
    for p in promises {
        let name = match p.index {
            Some(index) if p.title != p.kind => format!("warp {index}: {} ({})", p.title, p.kind),
            Some(index) => format!("warp {index}: {}", p.kind),
            None => p.title.clone(),
        };
        text.push_str(&format!("{name}\n"));
        for g in &p.guarantees {
            text.push_str(&format!(
                "  {:<14} {:<8} {}",
                g.property.name(),
                g.verdict.name(),
                g.statement
            ));
            if let (Some(w), Verdict::Refuted) = (g.witness, g.verdict) {
                let place: Vec<String> = (0..S::DIM)
                    .map(|axis| format!("{:.6}", w.place.component(axis)))
                    .collect();
                text.push_str(&format!(", at ({})", place.join(", ")));
            }
            text.push('\n');
        }
        for note in &p.notes {
            text.push_str(&format!("  note: {note}\n"));
        }
    }
    text
}
