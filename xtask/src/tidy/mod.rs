//! `cargo xtask tidy`: the rules of the house that no compiler checks.
//!
//! A rule is a function from a [`Tree`] to its findings; a new one is a file here and a line in [`RULES`]. Each is
//! tested on a tree that obeys it and on trees that break it.
//!
//! The rules look at the files that git tracks or would track, and at everything but build output where there is no
//! git.

pub mod floors;
pub mod glob;
pub mod length;
pub mod licences;
pub mod manifests;
pub mod plugins;
pub mod root;
#[cfg(test)]
pub(crate) mod testing;
mod tree;
pub mod words;

pub use tree::Tree;

use crate::{Chore, Failure};
use std::fmt;
use std::path::Path;

/// The chore.
pub const CHORE: Chore = Chore {
    name: "tidy",
    arguments: "",
    what: "the rules of the house: floors, documented plug-ins, licences…",
    run,
};

/// Every rule, by name.
pub const RULES: &[(&str, Rule)] = &[
    ("root entries", root::findings),
    ("manifests", manifests::findings),
    ("floors", floors::findings),
    ("plug-in docs", plugins::findings),
    ("file length", length::findings),
    ("licences of fixtures", licences::findings),
    ("words", words::findings),
];

/// What a rule is.
pub type Rule = fn(&Tree) -> Vec<Finding>;

/// One breach of a rule.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Finding {
    /// The file, from the root, with `/` between folders.
    pub path: String,
    /// The line, from 1.
    pub line: usize,
    /// What is wrong.
    pub what: String,
    /// How to mend it.
    pub mend: String,
}

impl Finding {
    /// A finding.
    pub fn new(
        path: impl Into<String>,
        line: usize,
        what: impl Into<String>,
        mend: impl Into<String>,
    ) -> Self {
        Self {
            path: path.into(),
            line,
            what: what.into(),
            mend: mend.into(),
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}:{}: {}; {}",
            self.path, self.line, self.what, self.mend
        )
    }
}

/// Applies every rule; the findings are sorted by place.
#[must_use]
pub fn findings(tree: &Tree) -> Vec<Finding> {
    let mut all: Vec<Finding> = RULES.iter().flat_map(|(_, rule)| rule(tree)).collect();
    all.sort();
    all.dedup();
    all
}

/// Applies every rule to the checkout at `root` and prints what it finds.
///
/// # Errors
/// [`Failure::Failed`] when there are findings, or when the files cannot be listed.
pub fn report(root: &Path) -> Result<(), Failure> {
    let tree = Tree::open(root).map_err(|e| Failure::file(root, &e))?;
    let found = findings(&tree);
    for finding in &found {
        println!("{finding}");
    }
    match found.len() {
        0 => {
            println!(
                "tidy: clean ({} files, {} rules)",
                tree.files().count(),
                RULES.len()
            );
            Ok(())
        }
        1 => Err(Failure::Failed("tidy: 1 finding".to_owned())),
        n => Err(Failure::Failed(format!("tidy: {n} findings"))),
    }
}

fn run(root: &Path, arguments: &[String]) -> Result<(), Failure> {
    crate::no_arguments("tidy", arguments)?;
    report(root)
}

#[cfg(test)]
mod tests {
    use super::testing::Sketch;
    use super::*;

    #[test]
    fn a_finding_is_a_line_that_an_editor_can_open() {
        let finding = Finding::new("crates/io/src/lib.rs", 7, "it is wrong", "mend it");
        assert_eq!(
            finding.to_string(),
            "crates/io/src/lib.rs:7: it is wrong; mend it"
        );
    }

    #[test]
    fn the_chore_fails_on_findings_and_says_how_many() {
        let clean = Sketch::new().file("README.md", "# a\n");
        assert_eq!(report(clean.path()), Ok(()));
        let broken = clean.file("stray.txt", "a\n").file("other.txt", "b\n");
        assert_eq!(
            report(broken.path()),
            Err(Failure::Failed("tidy: 2 findings".into()))
        );
    }

    #[test]
    fn findings_of_all_rules_come_in_the_order_of_places() {
        let sketch = Sketch::new()
            .file("b.txt", "")
            .file("a.txt", "")
            .file("crates/new/Cargo.toml", "[package]\n");
        let found = findings(&sketch.tree());
        assert!(found.is_sorted());
        let places: Vec<&str> = found.iter().map(|f| f.path.as_str()).collect();
        assert_eq!(places.first(), Some(&"a.txt"));
        assert!(places.contains(&"crates/new/Cargo.toml"));
    }
}
