//! The chores of the project, run as `cargo xtask CHORE`.
//!
//! | chore | what it does |
//! | --- | --- |
//! | `cargo xtask test` | everything that decides whether a change is good: format, clippy, tests and doc tests, documentation, the feature matrix, `wasm32` where that target is installed, and `tidy` ([`mod@test`]) |
//! | `cargo xtask tidy` | the rules of the house that no compiler checks: floors, documented plug-ins, licences of fixtures and others ([`mod@tidy`]) |
//! | `cargo xtask bench [--quick] [FILTER…]` | measures, and writes `docs/benchmarks.md` with ratios inside the run ([`mod@bench`]) |
//! | `cargo xtask gallery` | draws every warp, and refreshes `docs/gallery.md` and its pictures ([`mod@gallery`]) |
//! | `cargo xtask pairs [--jumps] [FILE…]` | morphs all pairs of shapes, and prints how good each is ([`mod@pairs`]) |
//! | `cargo xtask validate [FILE…]` | the Khronos validator on glTF models before and after a twist ([`mod@validate`]) |
//!
//! Without a chore, or with an unknown one, it prints its usage and exits with 2; a chore that fails exits with 1.
//!
//! **A new chore** is one file with a `pub const CHORE` ([`Chore`]), declared below, and one line in [`CHORES`]. A chore
//! runs on a machine that has a Rust toolchain and nothing else: it may use `cargo` and, when present, `git`; `validate`,
//! which `test` does not run, needs `node` and `npm` too.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "the chores are a program for people: their output is what they are run for"
)]

pub mod bench;
pub mod document;
pub mod gallery;
pub mod pairs;
pub mod test;
pub mod tidy;
pub mod validate;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Every chore, in the order of the usage text.
pub const CHORES: &[Chore] = &[
    test::CHORE,
    tidy::CHORE,
    bench::CHORE,
    gallery::CHORE,
    pairs::CHORE,
    validate::CHORE,
];

/// One chore: what it is called and what it does.
#[derive(Clone, Copy)]
pub struct Chore {
    /// What one types after `cargo xtask`.
    pub name: &'static str,
    /// The arguments it takes, as the usage text shows them; empty when it takes none.
    pub arguments: &'static str,
    /// What it does, in a few words.
    pub what: &'static str,
    /// Runs it on the checkout at the given root, with the arguments that followed its name.
    pub run: fn(&Path, &[String]) -> Result<(), Failure>,
}

/// Why a chore did not succeed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Failure {
    /// It was called wrongly: exit 2, with the usage.
    Usage(String),
    /// It ran and something is wrong: exit 1.
    Failed(String),
}

impl Failure {
    /// A failure to read or write `path`.
    pub(crate) fn file(path: &Path, error: &std::io::Error) -> Self {
        Self::Failed(format!("{}: {error}", path.display()))
    }
}

/// Refuses arguments, for chores that take none.
pub(crate) fn no_arguments(chore: &str, arguments: &[String]) -> Result<(), Failure> {
    match arguments.first() {
        None => Ok(()),
        Some(first) => Err(Failure::Usage(format!(
            "`{chore}` takes no arguments, but was given `{first}`"
        ))),
    }
}

/// Runs the chore that the arguments ask for; the exit code is 0 when it succeeded, 1 when it failed, 2 when the
/// arguments make no sense.
#[must_use]
pub fn run(arguments: &[String]) -> ExitCode {
    match dispatch(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Failed(message)) => {
            eprintln!("{message}");
            ExitCode::from(1)
        }
        Err(Failure::Usage(message)) => {
            eprintln!("xtask: {message}\n\n{}", usage());
            ExitCode::from(2)
        }
    }
}

fn dispatch(arguments: &[String]) -> Result<(), Failure> {
    let Some((name, rest)) = arguments.split_first() else {
        return Err(Failure::Usage("name a chore".to_owned()));
    };
    if arguments.iter().any(|a| a == "--help" || a == "-h") || name == "help" {
        println!("{}", usage());
        return Ok(());
    }
    let chore = find(name)?;
    let here = std::env::current_dir().map_err(|e| Failure::file(Path::new("."), &e))?;
    let root = find_root(&here).ok_or_else(|| {
        Failure::Failed(format!(
            "{}: not inside a checkout of the project; change into one and run again",
            here.display()
        ))
    })?;
    (chore.run)(&root, rest)
}

/// The chore of that name, or what to type instead.
///
/// # Errors
/// [`Failure::Usage`] that names the nearest chore.
pub fn find(name: &str) -> Result<Chore, Failure> {
    if let Some(chore) = CHORES.iter().find(|c| c.name == name) {
        return Ok(*chore);
    }
    let nearest = CHORES
        .iter()
        .min_by_key(|c| strsim::osa_distance(c.name, name))
        .map_or("", |c| c.name);
    Err(Failure::Usage(format!(
        "there is no chore `{name}`; the nearest is `{nearest}`"
    )))
}

/// The usage text: one line for each chore.
#[must_use]
pub fn usage() -> String {
    let left: Vec<String> = CHORES
        .iter()
        .map(|c| format!("{} {}", c.name, c.arguments))
        .collect();
    let width = left.iter().map(|l| l.chars().count()).max().unwrap_or(0);
    let mut text = String::from("usage: cargo xtask CHORE [ARGUMENTS]\n\nchores:");
    for (call, chore) in left.iter().zip(CHORES) {
        text.push_str(&format!("\n  {call:width$}  {}", chore.what));
    }
    text
}

/// The root of the checkout that holds `here`: the nearest folder upwards with a workspace manifest and this crate.
fn find_root(here: &Path) -> Option<PathBuf> {
    here.ancestors()
        .find(|folder| {
            folder.join("xtask/Cargo.toml").is_file() && folder.join("Cargo.toml").is_file()
        })
        .map(Path::to_path_buf)
}

/// The `cargo` that started this program, else the one on the search path.
pub(crate) fn cargo() -> String {
    std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_chore_is_found_and_has_a_line_of_its_own_in_the_usage() {
        for chore in CHORES {
            assert_eq!(find(chore.name).expect("a listed chore").name, chore.name);
            let lines = usage()
                .lines()
                .filter(|l| l.trim_start().starts_with(chore.name))
                .count();
            assert_eq!(lines, 1, "{}", chore.name);
        }
    }

    #[test]
    fn an_unknown_chore_names_the_nearest() {
        for (typed, nearest) in [
            ("tydi", "tidy"),
            ("tset", "test"),
            ("benhc", "bench"),
            ("tests", "test"),
        ] {
            let Err(Failure::Usage(message)) = find(typed) else {
                panic!("`{typed}` was found")
            };
            assert!(message.contains(&format!("`{nearest}`")), "{message}");
        }
    }

    #[test]
    fn no_chore_and_stray_arguments_are_errors_of_usage() {
        assert!(matches!(dispatch(&[]), Err(Failure::Usage(_))));
        assert!(matches!(
            dispatch(&["tidy".into(), "now".into()]),
            Err(Failure::Usage(_))
        ));
        assert_eq!(dispatch(&["tidy".into(), "--help".into()]), Ok(()));
    }

    #[test]
    fn the_root_is_found_from_a_folder_below() {
        let tree = tempfile::tempdir().expect("a folder");
        let deep = tree.path().join("crates/core/src");
        for folder in ["xtask", "crates/core/src"] {
            std::fs::create_dir_all(tree.path().join(folder)).expect("a folder");
        }
        for file in ["Cargo.toml", "xtask/Cargo.toml", "crates/core/Cargo.toml"] {
            std::fs::write(tree.path().join(file), "").expect("a file");
        }
        assert_eq!(find_root(&deep).as_deref(), Some(tree.path()));
        assert_eq!(find_root(tree.path()).as_deref(), Some(tree.path()));
        assert_eq!(find_root(Path::new("/nowhere/at/all")), None);
    }
}
