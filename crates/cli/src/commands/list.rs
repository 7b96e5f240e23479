//! `anamorph list KIND`: what can be named.

use crate::arguments::{ListKind, ListOptions};
use crate::error::{Failure, output};
use anamorph_catalog::Entry;
use anamorph_core::{Plane, Solid, Space};
use anamorph_fields::FALLOFFS;
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
        ListKind::Formats => anamorph_io::formats()
            .iter()
            .map(|format| Row {
                name: format.name().to_owned(),
                summary: format!("{} (.{})", format.title(), format.extensions().join(", .")),
                json: json!({
                    "name": format.name(),
                    "title": format.title(),
                    "extensions": format.extensions(),
                }),
            })
            .collect(),
    }
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
