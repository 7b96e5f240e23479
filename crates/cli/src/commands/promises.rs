//! What the parts of a built recipe and the whole of it promise, for `check` and for reports.

use crate::model::ModelSpace;
use anamorph_core::guarantees::{
    Guarantee, ON_THE_MODEL, Property, Verdict, ambient_repair, commutation, continuity_of,
    coverage, disagreement, interpolation_of, invertibility, no_fold, safe_strength, undecided,
};
use anamorph_core::{Deformation, Domain, Smoothness, Warp, map_all_parallel};
use anamorph_recipe::{BuiltPart, BuiltRecipe};
use serde_json::{Value, json};

/// Points at which Jacobians are examined, at most; a larger model is sampled evenly.
const EXAMINED: usize = 6_000;
/// Points that are asked whether they feel a feature, at most.
const ASKED: usize = 200_000;

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
    let mut here = sample(points, EXAMINED);
    let original = here.clone();
    let mut asked = sample(points, ASKED);
    let mut all = Vec::new();
    for (number, part) in built.parts.iter().enumerate() {
        let covered = coverage(&part.warp, &asked, points.len().max(asked.len()));
        let mut guarantees = of_part(part, covered, &here, size);
        if let Some(next) = built.parts.get(number + 1) {
            let name = format!("with the next warp, {}", next.title());
            let mut found = commutation(&part.deformation, &next.deformation, &here, size);
            found.statement = format!("{name}: {}", found.statement);
            guarantees.push(found);
        }
        all.push(Promises {
            index: Some(part.index),
            title: part.title().to_owned(),
            kind: part.kind.to_owned(),
            guarantees,
            notes: notes(part),
            domain: part.deformation.domain(),
        });
        let _ = part.deformation.map_points(0, &mut here);
        here.retain(|p| p.is_finite());
        if number + 1 < built.parts.len() {
            let _ = map_all_parallel(&part.deformation, &mut asked, &|_| {});
        }
    }
    if built.parts.len() != 1 {
        let stack = built.stack();
        let fold = no_fold(&stack, &original, size);
        let folds = fold.witness.filter(|_| fold.verdict == Verdict::Refuted);
        let guarantees = vec![
            undecided(Property::Interpolation),
            continuity_of(&stack, &original, size),
            fold,
            invertibility(&stack, folds, &original, size),
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

/// What a part has to say beside its promises.
fn notes<S: ModelSpace>(part: &BuiltPart<S>) -> Vec<String> {
    let facts = part.deformation.facts();
    let mut notes: Vec<String> = facts.notes.iter().map(|n| plain(n)).collect();
    if let Some((one, other, place)) = disagreement(&part.warp.conditions()) {
        notes.push(format!(
            "features {one} and {other} both begin at {} and go to different places: their average is taken there",
            shown(place)
        ));
    }
    notes
}

/// A note without the numbers by which our pages name corrections of the paper.
fn plain(note: &str) -> String {
    let mut text = note.to_owned();
    while let Some(from) = text.find(" (errata ") {
        let Some(length) = text[from..].find(')') else {
            break;
        };
        text.replace_range(from..=from + length, "");
    }
    text
}

/// A place in a sentence.
fn shown<S: ModelSpace>(place: S) -> String {
    let numbers: Vec<String> = (0..S::DIM)
        .map(|axis| short(place.component(axis)))
        .collect();
    format!("({})", numbers.join(", "))
}

/// The promises of one part, with what would repair it.
fn of_part<S: ModelSpace>(
    part: &BuiltPart<S>,
    covered: Guarantee<S>,
    points: &[S],
    size: f64,
) -> Vec<Guarantee<S>> {
    let interpolation = interpolation_of(&part.deformation, &part.warp.conditions(), size);
    let mut continuous = continuity_of(&part.deformation, points, size);
    if part.deformation.facts().smoothness() == Smoothness::Jump
        && let Some((ambient, miss)) = ambient_repair(&part.warp, points, size)
    {
        let price = miss.map_or_else(
            || "features are then met approximately".to_owned(),
            |miss| format!("features then miss their targets by up to {}", short(miss)),
        );
        continuous = continuous.with_detail(
            "repair",
            format!(
                "`ambient = {}` makes it continuous; {price}",
                short(ambient)
            ),
        );
    }
    let mut fold = no_fold(&part.deformation, points, size);
    let folds = fold.witness.filter(|_| fold.verdict == Verdict::Refuted);
    if folds.is_some()
        && let Some(strength) = safe_strength(&part.warp, points, size)
    {
        fold = fold.with_detail(
            "largest safe strength",
            format!("{strength:.3} of the present one, as far as the search saw"),
        );
    }
    vec![
        interpolation,
        covered,
        continuous,
        fold,
        invertibility(&part.deformation, folds, points, size),
    ]
}

/// A number for a sentence.
fn short(value: f64) -> String {
    crate::files::short(value)
}

/// Points spread over a model, few enough to be examined one by one.
pub(crate) fn examined<S: ModelSpace>(points: &[S]) -> Vec<S> {
    sample(points, EXAMINED)
}

fn sample<S: ModelSpace>(points: &[S], most: usize) -> Vec<S> {
    let step = points.len().div_ceil(most).max(1);
    let finite = points.iter().copied().filter(|p| p.is_finite());
    finite.step_by(step).collect()
}

/// A sentence about the place where a recipe turns the model inside out, if one is found.
pub(crate) fn fold<S: ModelSpace>(
    built: &BuiltRecipe<S>,
    points: &[S],
    size: f64,
) -> Option<String> {
    let points = examined(points);
    let guarantee = no_fold(&built.stack(), &points, size);
    let witness = guarantee.witness?;
    (guarantee.verdict == Verdict::Refuted).then(|| {
        let place = shown(witness.place);
        let mut named = guarantee.details.iter();
        let on_the_model = named.find(|(name, _)| *name == ON_THE_MODEL);
        match on_the_model {
            Some((_, sentence)) if sentence.starts_with("none") => {
                let away = points.iter().map(|p| p.distance(witness.place));
                format!(
                    "the space about the model folds over, at {place}, {} from the nearest point looked at; {sentence}",
                    short(away.fold(f64::INFINITY, f64::min))
                )
            }
            Some((_, sentence)) => format!("it folds over, worst at {place} of the original: {sentence}"),
            None => format!("it folds over, worst at {place} of the original"),
        }
    })
}

/// What else was found out, by name.
fn details<S>(guarantee: &Guarantee<S>) -> Value {
    let named = guarantee.details.iter();
    Value::Object(
        named
            .map(|(name, sentence)| ((*name).to_owned(), json!(sentence)))
            .collect(),
    )
}

/// One guarantee as JSON.
pub(crate) fn guarantee_json<S: ModelSpace>(g: &Guarantee<S>) -> Value {
    let coordinates = |p: S| -> Vec<f64> { (0..S::DIM).map(|axis| p.component(axis)).collect() };
    json!({
        "property": g.property.name(),
        "verdict": g.verdict.name(),
        "statement": g.statement,
        "witness": g.witness.map(|w| json!({
            "place": coordinates(w.place),
            "value": w.value,
            "other": w.other.map(coordinates),
        })),
        "details": details(g),
    })
}

/// As JSON.
pub(crate) fn to_json<S: ModelSpace>(promises: &[Promises<S>]) -> Value {
    promises
        .iter()
        .map(|p| {
            let guarantees: Vec<Value> = p.guarantees.iter().map(guarantee_json).collect();
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
            text.push_str(&line(g));
        }
        for note in &p.notes {
            text.push_str(&format!("  note: {note}\n"));
        }
    }
    text
}

/// One guarantee as text, with its witness where it is refuted.
pub(crate) fn line<S: ModelSpace>(g: &Guarantee<S>) -> String {
    let place = |p: S| {
        let numbers: Vec<String> = (0..S::DIM)
            .map(|axis| format!("{:.6}", p.component(axis)))
            .collect();
        format!("({})", numbers.join(", "))
    };
    let mut text = format!(
        "  {:<14} {:<8} {}",
        g.property.name(),
        g.verdict.name(),
        g.statement
    );
    if let (Some(w), Verdict::Refuted) = (g.witness, g.verdict) {
        text.push_str(&format!(", at {}", place(w.place)));
        if let Some(other) = w.other.filter(|_| g.property == Property::Invertibility) {
            text.push_str(&format!(" and {}", place(other)));
        }
    }
    text.push('\n');
    // The three kinds of continuity follow from the line itself; the JSON spells them out.
    let told = |name: &str| g.property != Property::Continuity || name == "repair";
    for (name, sentence) in g.details.iter().filter(|(name, _)| told(name)) {
        text.push_str(&format!("  {:<23} {name}: {sentence}\n", ""));
    }
    text
}
