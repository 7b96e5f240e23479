//! `anamorph morph --batch`: a list of morphs, each as if it had been asked for alone.
//!
//! A table of the list holds the options of the command by their names. Paths are relative to the folder of the list.

use crate::arguments::{Arguments, Command, MorphOptions};
use crate::error::{Failure, say};
use crate::files;
use clap::Parser;
use std::path::{Path, PathBuf};

const FORM: &str = "write tables [[morph]] with `inputs`, `output` and options by their names";

/// Morphs all that a list names, goes on after a failure, and fails at the end if any did.
pub(super) fn run(list: &Path, options: &MorphOptions) -> Result<(), Failure> {
    let shown = files::shown(list);
    let failed = |what: String| Failure::new(format!("{shown}: {what}"));
    let bytes = files::read(list)?;
    let text = std::str::from_utf8(&bytes).map_err(|error| failed(error.to_string()))?;
    let table: toml::Table = text
        .parse()
        .map_err(|error: toml::de::Error| failed(error.to_string()))?;
    if let Some(key) = table.keys().find(|key| *key != "morph") {
        return Err(failed(format!("`{key}` is unknown; {FORM}")));
    }
    let rows = table.get("morph").and_then(toml::Value::as_array);
    let rows = rows.filter(|rows| !rows.is_empty());
    let rows = rows.ok_or_else(|| failed(format!("it names no morph; {FORM}")))?;
    let folder = if files::is_stream(list) {
        Path::new(".")
    } else {
        files::folder_of(list)
    };
    let mut bad = 0;
    for (number, row) in rows.iter().enumerate() {
        let output = row.get("output").and_then(toml::Value::as_str);
        let name = match output {
            Some(output) => format!("morph {} ({output})", number + 1),
            None => format!("morph {}", number + 1),
        };
        let done = parsed(row, folder).and_then(|mut own| {
            own.force |= options.force;
            own.quiet |= options.quiet;
            own.allow_outside |= options.allow_outside;
            own.threads = own.threads.or(options.threads);
            super::run(&own)
        });
        match done {
            Ok(()) => {}
            Err(Failure::ClosedPipe) => return Err(Failure::ClosedPipe),
            Err(failure) => {
                bad += 1;
                if let Failure::Message(text) | Failure::Usage(text) = failure {
                    for line in text.lines() {
                        say!("error: {shown}: {name}: {line}");
                    }
                }
            }
        }
    }
    if !options.quiet {
        say!(
            "{shown}: {} of {} morphs done",
            rows.len() - bad,
            rows.len()
        );
    }
    if bad > 0 {
        return Err(Failure::Reported);
    }
    Ok(())
}

/// The options of a table, as the command line has them.
fn parsed(row: &toml::Value, folder: &Path) -> Result<MorphOptions, Failure> {
    let Some(row) = row.as_table() else {
        return Err(Failure::new(format!("it is no table; {FORM}")));
    };
    if !row.contains_key("output") {
        return Err(Failure::new(format!("it has no `output`; {FORM}")));
    }
    let mut arguments = vec!["anamorph".to_owned(), "morph".to_owned()];
    let mut inputs = Vec::new();
    for (key, value) in row {
        if ["batch", "help", "version"].contains(&key.as_str()) {
            return Err(Failure::new(format!(
                "`{key}` is no option of a morph in a list"
            )));
        }
        let option = format!("--{}", key.replace('_', "-"));
        let alone = [value.clone()];
        let values = value.as_array().map_or(&alone[..], Vec::as_slice);
        for value in values {
            let text = match value {
                toml::Value::Boolean(true) if key != "inputs" => {
                    arguments.push(option.clone());
                    continue;
                }
                toml::Value::Boolean(false) if key != "inputs" => continue,
                toml::Value::String(text) => text.clone(),
                toml::Value::Integer(number) => number.to_string(),
                toml::Value::Float(number) => number.to_string(),
                _ => {
                    return Err(Failure::new(format!(
                        "`{key}` is neither words, a number, true or false, nor a list of these"
                    )));
                }
            };
            if key == "inputs" {
                inputs.push(text);
            } else {
                arguments.push(format!("{option}={text}"));
            }
        }
    }
    arguments.push("--".to_owned());
    arguments.extend(inputs);
    let parsed = Arguments::try_parse_from(arguments).map_err(|error| {
        let text = error.to_string();
        let line = text.lines().find(|line| !line.trim().is_empty());
        let line = line.unwrap_or("these options do not fit together");
        Failure::new(line.trim_start_matches("error: ").trim())
    })?;
    let Command::Morph(mut options) = parsed.command else {
        return Err(Failure::new(FORM));
    };
    let own = &mut *options;
    let lists = [
        &mut own.images,
        &mut own.recipe,
        &mut own.landmarks,
        &mut own.shapes.anchors,
        &mut own.between.texture,
    ];
    let alone = [
        &mut own.report,
        &mut own.between.metrics,
        &mut own.between.matching,
        &mut own.between.strain_plot,
    ];
    let paths = lists.into_iter().flatten();
    let paths = paths.chain(alone.into_iter().flatten());
    for path in paths.chain([&mut own.output]) {
        place(path, folder);
    }
    Ok(*options)
}

/// Where a path of the list leads.
fn place(path: &mut PathBuf, folder: &Path) {
    if !files::is_stream(path) && folder != Path::new(".") {
        *path = folder.join(&*path);
    }
}
