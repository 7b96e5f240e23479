//! `cargo xtask pairs`: morphs all pairs of some shapes and prints what they are like.
//!
//! Each shape is an SVG, polygons or `GeoJSON`, or a font followed by `:` and a text; without any, the shapes of the fixtures are taken.
//! A line a pair goes to standard error as soon as it is there, a table of all methods to standard output. It exits with 1
//! if a pair failed; the others are measured all the same. The measuring is that of `anamorph_tests::pairs`.
//!
//! *Source*: the project's own design.

use crate::{Chore, Failure, cargo};
use std::path::Path;
use std::process::Command;

/// The chore.
pub const CHORE: Chore = Chore {
    name: "pairs",
    arguments: "[--jumps] [FILE…]",
    what: "morphs all pairs of shapes (those of the fixtures), and prints how good each is beside other methods",
    run,
};

/// Where the fixtures are.
const FIXTURES: &str = "tests/fixtures/shapes";

fn run(root: &Path, arguments: &[String]) -> Result<(), Failure> {
    let mut command = Command::new(cargo());
    command.current_dir(root);
    command.args([
        "run",
        "--release",
        "-q",
        "-p",
        "anamorph-tests",
        "--bin",
        "pairs",
        "--",
    ]);
    command.args(arguments);
    if arguments.iter().all(|argument| argument.starts_with("--")) {
        let folder = root.join(FIXTURES);
        let listed = std::fs::read_dir(&folder).map_err(|error| Failure::file(&folder, &error))?;
        let mut files = Vec::new();
        for entry in listed {
            files.push(
                entry
                    .map_err(|error| Failure::file(&folder, &error))?
                    .path(),
            );
        }
        files.sort();
        command.args(files);
    }
    let status = command.status();
    match status.map_err(|error| Failure::file(Path::new("cargo"), &error))? {
        status if status.success() => Ok(()),
        _ => Err(Failure::Failed("some pairs have faults".to_owned())),
    }
}
