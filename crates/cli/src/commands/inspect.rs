//! `anamorph inspect`: what a file holds, and what is odd about it.

use super::image;
use crate::arguments::InspectOptions;
use crate::error::{Failure, output};
use crate::{files, model};
use anamorph_io::images::{ImageFile, ImageLimits};
use anamorph_io::{Document, Inspection, ReadOptions};
use anamorph_raster::Window;
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;

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
    written(name, &rows)
}

/// Rows under a file's name.
fn written(name: &str, rows: &[(&str, String)]) -> String {
    let width = rows.iter().map(|(what, _)| what.len()).max().unwrap_or(0);
    let lines = rows
        .iter()
        .map(|(what, value)| format!("  {what:width$}  {value}\n"));
    format!("{name}\n{}", lines.collect::<String>())
}

fn rectangle(window: Window) -> String {
    let size = format!("{} × {} pixels", window.width(), window.height());
    match (window.x(), window.y()) {
        (0, 0) => size,
        (x, y) => format!("{size} at ({x}, {y})"),
    }
}

fn image_to_text(name: &str, image: &ImageFile) -> String {
    let mut rows = vec![
        ("format", image.format().title().to_owned()),
        ("size", rectangle(image.display())),
    ];
    if image.has_profile() {
        rows.push(("profile", "embedded, kept and not applied".to_owned()));
    }
    for (number, layer) in image.layers().iter().enumerate() {
        let channels = layer.channels().iter();
        let channels: Vec<String> = channels
            .map(|c| format!("{} ({})", c.name(), c.sample().title()))
            .collect();
        let name = layer
            .name()
            .map_or(String::new(), |name| format!("{name}: "));
        let mut row = format!("{name}{}", listed(&channels));
        if let Some(window) = layer.window().filter(|&window| window != image.display()) {
            row.push_str(&format!("; data window {}", rectangle(window)));
        }
        if let Some(compression) = image.compression(number) {
            row.push_str(&format!("; compression {compression}"));
        }
        rows.push(("layer", row));
    }
    for note in image.notes() {
        rows.push(("note", note.clone()));
    }
    written(name, &rows)
}

fn image_to_json(name: &str, image: &ImageFile) -> Value {
    let list = |window: Window| json!([window.x(), window.y(), window.width(), window.height()]);
    let layers = image.layers().iter().enumerate().map(|(number, layer)| {
        let channels = layer.channels().iter();
        let channels: Vec<Value> = channels
            .map(|c| json!({ "name": c.name(), "stored": c.sample().title() }))
            .collect();
        json!({
            "name": layer.name(),
            "channels": channels,
            "data_window": layer.window().map(list),
            "compression": image.compression(number),
        })
    });
    json!({
        "file": name,
        "format": image.format().name(),
        "width": image.display().width(),
        "height": image.display().height(),
        "display_window": list(image.display()),
        "layers": layers.collect::<Vec<_>>(),
        "profile": image.has_profile(),
        "notes": image.notes(),
    })
}

/// Attributes that a line names.
const MOST_NAMES: usize = 20;

fn listed(names: &[String]) -> String {
    match names.get(MOST_NAMES..) {
        None | Some([]) => names.join(", "),
        Some(more) => format!("{} and {} more", names[..MOST_NAMES].join(", "), more.len()),
    }
}

/// What a file holds.
enum Content {
    Model(Box<dyn Document>),
    Image(Box<ImageFile>),
}

pub(crate) fn run(options: &InspectOptions) -> Result<(), Failure> {
    files::at_most_one_stream(&options.files)?;
    let mut out = std::io::stdout().lock();
    let (mut failed, mut all) = (false, Vec::new());
    let read = |path: &PathBuf| -> Result<Content, Failure> {
        let bytes = files::read(path)?;
        if image::concerns(path, &bytes) {
            let limits = ImageLimits::of_file(bytes.len());
            return ImageFile::read(&bytes, limits)
                .map(|image| Content::Image(Box::new(image)))
                .map_err(|error| Failure::new(format!("{}: {error}", files::shown(path))));
        }
        let reading = ReadOptions::for_inspection();
        model::document(bytes, path, &reading, options.allow_outside).map(Content::Model)
    };
    for path in &options.files {
        match read(path) {
            Ok(Content::Image(image)) => {
                let name = files::shown(path);
                if options.json {
                    all.push(image_to_json(&name, &image));
                } else {
                    write!(out, "{}", image_to_text(&name, &image))
                        .map_err(|error| output(&error))?;
                }
            }
            Ok(Content::Model(document)) => {
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
