//! `anamorph inspect`: what a file holds, and what is odd about it.

use crate::arguments::InspectOptions;
use crate::error::{Failure, output};
use crate::{files, model};
use anamorph_io::{Inspection, ReadOptions};
use serde_json::{Value, json};
use std::io::Write;

fn to_json(name: &str, inspection: &Inspection) -> Value {
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
    })
}

fn to_text(name: &str, inspection: &Inspection) -> String {
    let numbers = |list: &[f64]| {
        list.iter()
            .map(|x| files::short(*x))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let mut text = format!(
        "{name}\n  format      {}, {}-D\n",
        inspection.format, inspection.dimension
    );
    for (what, count) in &inspection.counts {
        text.push_str(&format!("  {what:<11} {count}\n"));
    }
    if let Some((min, max)) = &inspection.bounds {
        text.push_str(&format!(
            "  bounds      ({}) to ({})\n",
            numbers(min),
            numbers(max)
        ));
    }
    if !inspection.attributes.is_empty() {
        text.push_str(&format!(
            "  attributes  {}\n",
            inspection.attributes.join(", ")
        ));
    }
    if inspection.problems.is_empty() {
        text.push_str("  problems    none\n");
    }
    for problem in &inspection.problems {
        let line = problem
            .line
            .map_or(String::new(), |line| format!(" (line {line})"));
        text.push_str(&format!(
            "  problem     {}: {}, first {}{line}\n",
            problem.kind.title(),
            problem.count,
            problem.first
        ));
    }
    text
}

pub(crate) fn run(options: &InspectOptions) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    let (mut failed, mut all) = (false, Vec::new());
    for path in &options.files {
        match model::read(path, &ReadOptions::for_inspection()) {
            Ok(document) => {
                let inspection = document.inspect();
                let name = files::shown(path);
                if options.json {
                    all.push(to_json(&name, &inspection));
                } else {
                    write!(out, "{}", to_text(&name, &inspection))
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
