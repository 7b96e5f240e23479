//! `anamorph inspect`: what a file holds, and what is odd about it.

use crate::arguments::InspectOptions;
use crate::error::{Failure, output};
use crate::{files, model};
use anamorph_io::{Inspection, ReadOptions};
use serde_json::{Value, json};
use std::io::Write;

fn to_json(name: &str, inspection: &Inspection, notes: &[String]) -> Value {
    let counts: serde_json::Map<String, Value> = inspection
        .counts
        .iter()
        .map(|(what, count)| ((*what).to_owned(), json!(count)))
        .collect();
    let problems: Vec<Value> = inspection
        .problems
        .iter()
        .map(|p| {
            json!({
                "kind": p.kind.name(),
                "title": p.kind.title(),
                "count": p.count,
                "first": p.first,
                "line": p.line,
            })
        })
        .collect();
    json!({
        "file": name,
        "format": inspection.format,
        "dimension": inspection.dimension,
        "counts": counts,
        "bounds": inspection.bounds.as_ref().map(|(min, max)| json!({ "min": min, "max": max })),
        "attributes": inspection.attributes,
        "problems": problems,
        "notes": notes,
    })
}

fn to_text(name: &str, inspection: &Inspection, notes: &[String]) -> String {
    let numbers = |list: &[f64]| {
        list.iter()
            .map(|x| files::short(*x))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let mut rows = vec![(
        "format",
        format!("{}, {}-D", inspection.format, inspection.dimension),
    )];
    for (what, count) in &inspection.counts {
        rows.push((what, count.to_string()));
    }
    if let Some((min, max)) = &inspection.bounds {
        rows.push((
            "bounds",
            format!("({}) to ({})", numbers(min), numbers(max)),
        ));
    }
    if !inspection.attributes.is_empty() {
        rows.push(("attributes", listed(&inspection.attributes)));
    }
    if inspection.problems.is_empty() {
        rows.push(("problems", "none".to_owned()));
    }
    for problem in &inspection.problems {
        let line = problem
            .line
            .map_or(String::new(), |line| format!(" (line {line})"));
        let title = problem.kind.title();
        rows.push((
            "problem",
            format!("{title}: {}, first {}{line}", problem.count, problem.first),
        ));
    }
    for note in notes {
        rows.push(("note", note.clone()));
    }
    let width = rows.iter().map(|(what, _)| what.len()).max().unwrap_or(0);
    let lines = rows
        .iter()
        .map(|(what, value)| format!("  {what:width$}  {value}\n"));
    format!("{name}\n{}", lines.collect::<String>())
}

/// Attributes that a line names.
const MOST_NAMES: usize = 20;

fn listed(names: &[String]) -> String {
    match names.get(MOST_NAMES..) {
        None | Some([]) => names.join(", "),
        Some(more) => format!("{} and {} more", names[..MOST_NAMES].join(", "), more.len()),
    }
}

pub(crate) fn run(options: &InspectOptions) -> Result<(), Failure> {
    files::at_most_one_stream(&options.files)?;
    let mut out = std::io::stdout().lock();
    let (mut failed, mut all) = (false, Vec::new());
    for path in &options.files {
        match model::read(path, &ReadOptions::for_inspection(), options.allow_outside) {
            Ok(document) => {
                let inspection = document.inspect();
                let (name, notes) = (files::shown(path), document.notes());
                if options.json {
                    all.push(to_json(&name, &inspection, &notes));
                } else {
                    write!(out, "{}", to_text(&name, &inspection, &notes))
                        .map_err(|error| output(&error))?;
                }
            }
            Err(failure) => {
                failure.print();
                failed = true;
            }
        }
    }
    if options.json {
        let text = serde_json::to_string_pretty(&all).map_err(Failure::new)?;
        writeln!(out, "{text}").map_err(|error| output(&error))?;
    }
    if failed {
        Err(Failure::Reported)
    } else {
        Ok(())
    }
}
