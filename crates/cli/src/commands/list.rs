//! `anamorph list KIND`: what can be named.

use crate::arguments::{ListKind, ListOptions};
use crate::error::{Failure, output};
use anamorph_catalog::Entry;
use anamorph_core::{Plane, Solid, Space};
use anamorph_curves::eases::{self, EaseEntry, Setting};
use anamorph_curves::families::registry::{FAMILIES, Family};
use anamorph_curves::orientation::registry::{MODIFIERS, ORIENTATIONS, Parameter};
use anamorph_fields::FALLOFFS;
use anamorph_io::images::ImageFormat;
use anamorph_recipe::KEYED;
use anamorph_warps::registry;
use serde_json::{Value, json};
use std::io::Write;

/// One line of a list.
struct Row {
    name: String,
    summary: String,
    json: Value,
}

fn entry<S: Space, T>(entry: &Entry<S, T>, spaces: &[&str]) -> Row {
    let place = if spaces.len() == 2 {
        String::new()
    } else {
        format!(" ({} only)", spaces.join(", "))
    };
    Row {
        name: entry.kind.to_owned(),
        summary: format!("{}{place}", entry.summary),
        json: json!({
            "kind": entry.kind,
            "system": entry.system,
            "figure": entry.figure,
            "summary": entry.summary,
            "spaces": spaces,
            "reference": entry.reference,
            "example": entry.example,
        }),
    }
}

fn rows(kind: ListKind) -> Vec<Row> {
    match kind {
        ListKind::Warps => {
            let plane: Vec<_> = registry::plane().iter().map(|entry| entry.kind).collect();
            registry::solid()
                .iter()
                .map(|e| {
                    let spaces: &[&str] = if plane.contains(&e.kind) {
                        &[Plane::NAME, Solid::NAME]
                    } else {
                        &[Solid::NAME]
                    };
                    entry(e, spaces)
                })
                .collect()
        }
        ListKind::Fields => anamorph_fields::recipe::entries::<Solid>()
            .iter()
            .map(|e| entry(e, &[Plane::NAME, Solid::NAME]))
            .collect(),
        ListKind::Falloffs => FALLOFFS
            .iter()
            .map(|falloff| {
                let class = falloff.smoothness();
                let reach = if falloff.compact() {
                    "ends at the radius"
                } else {
                    "reaches everywhere"
                };
                Row {
                    name: falloff.name().to_owned(),
                    summary: format!("{class}, {reach}"),
                    json: json!({
                        "name": falloff.name(),
                        "continuity": class.to_string(),
                        "compact": falloff.compact(),
                    }),
                }
            })
            .collect(),
        ListKind::Curves => FAMILIES.iter().map(family).collect(),
        ListKind::Eases => eases::registry().iter().map(ease).collect(),
        ListKind::Orientations => orientations(),
        ListKind::Formats => {
            let models = anamorph_io::formats().iter();
            let models = models.map(|f| format(f.name(), f.title(), f.extensions(), "model"));
            let images = ImageFormat::ALL.into_iter();
            let images = images.map(|f| format(f.name(), f.title(), f.extensions(), "image"));
            models.chain(images).collect()
        }
    }
}

/// A format; `holds` says what files of it are.
fn format(name: &str, title: &str, extensions: &[&str], holds: &str) -> Row {
    let image = if holds == "image" { ", an image" } else { "" };
    Row {
        name: name.to_owned(),
        summary: format!("{title}{image} (.{})", extensions.join(", .")),
        json: json!({
            "name": name,
            "title": title,
            "extensions": extensions,
            "holds": holds,
        }),
    }
}

fn family(family: &Family) -> Row {
    let numbers = family.numbers.iter();
    let numbers: Vec<Value> = numbers
        .map(|n| json!({ "name": n.name, "meaning": n.meaning, "default": n.default }))
        .collect();
    let closes = if family.closes { "" } else { "; not closed" };
    Row {
        name: family.name.to_owned(),
        summary: format!("{}: {}{closes}", family.title, family.reads),
        json: json!({
            "name": family.name,
            "title": family.title,
            "reads": family.reads,
            "closes": family.closes,
            "velocities": family.velocities,
            "times": family.times,
            "numbers": numbers,
            "reference": family.reference,
        }),
    }
}

fn ease(entry: &EaseEntry) -> Row {
    let parameters = entry.parameters.iter().map(|p| {
        let default = match p.default {
            Setting::Number(number) => json!(number),
            Setting::Word(word) => json!(word),
            Setting::Stops(stops) => json!(stops),
        };
        json!({ "name": p.name, "meaning": p.summary, "default": default })
    });
    let names: Vec<&str> = entry.parameters.iter().map(|p| p.name).collect();
    let takes = if names.is_empty() {
        String::new()
    } else {
        format!(" ({})", names.join(", "))
    };
    Row {
        name: entry.name.to_owned(),
        summary: format!("{}{takes}", entry.title),
        json: json!({
            "name": entry.name,
            "aliases": entry.aliases,
            "title": entry.title,
            "parameters": parameters.collect::<Vec<_>>(),
            "reference": entry.reference,
        }),
    }
}

/// Frames along the path, ways from key to key, and what changes frames.
fn orientations() -> Vec<Row> {
    let row =
        |name: &str, title: &str, summary: &str, reference: &str, parameters: Value, role: &str| {
            Row {
                name: name.to_owned(),
                summary: format!("{title}: {summary}"),
                json: json!({
                    "name": name,
                    "role": role,
                    "title": title,
                    "summary": summary,
                    "parameters": parameters,
                    "reference": reference,
                }),
            }
        };
    let listed = |all: &[Parameter]| {
        let each = all.iter();
        Value::Array(
            each.map(|p| json!({ "name": p.name, "meaning": p.meaning, "required": p.required }))
                .collect(),
        )
    };
    let along = ORIENTATIONS.iter().map(|e| {
        row(
            e.name,
            e.title,
            e.summary,
            e.reference,
            listed(e.parameters),
            "along",
        )
    });
    let keyed = KEYED.iter().map(|e| {
        let keys =
            json!([{ "name": "keys", "meaning": "orientations at times", "required": true }]);
        row(e.name, e.title, e.summary, e.reference, keys, "keys")
    });
    let changes = MODIFIERS.iter().map(|e| {
        row(
            e.name,
            e.title,
            e.summary,
            e.reference,
            listed(e.parameters),
            "modifier",
        )
    });
    along.chain(keyed).chain(changes).collect()
}

pub(crate) fn run(options: &ListOptions) -> Result<(), Failure> {
    let rows = rows(options.kind);
    let mut out = std::io::stdout().lock();
    if options.json {
        let all: Vec<&Value> = rows.iter().map(|row| &row.json).collect();
        let text = serde_json::to_string_pretty(&all).map_err(Failure::new)?;
        return writeln!(out, "{text}").map_err(|error| output(&error));
    }
    let width = rows.iter().map(|row| row.name.len()).max().unwrap_or(0);
    for row in &rows {
        writeln!(out, "{:width$}  {}", row.name, row.summary).map_err(|error| output(&error))?;
    }
    Ok(())
}
