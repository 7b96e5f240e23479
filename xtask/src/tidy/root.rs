//! Rule: the root holds only what everyone must see first.

use super::{Finding, Tree, glob};
use std::collections::BTreeSet;

/// What may lie in the root, as patterns of [`glob`]. `target` is ignored by git and never listed.
const ALLOWED: &[&str] = &[
    "Cargo.toml",
    "Cargo.lock",
    "crates",
    "xtask",
    "tests",
    "docs",
    "README.md",
    "LICENSE-*",
    ".*",
    "clippy.toml",
    "deny.toml",
    "rust-toolchain.toml",
    "rustfmt.toml",
];

/// Entries of the root that do not belong there.
#[must_use]
pub fn findings(tree: &Tree) -> Vec<Finding> {
    let entries: BTreeSet<&str> = tree
        .files()
        .map(|f| f.split('/').next().unwrap_or(f))
        .collect();
    entries
        .into_iter()
        .filter(|entry| !ALLOWED.iter().any(|pattern| glob::matches(pattern, entry)))
        .map(|entry| {
            let mend = format!(
                "move it into one of the folders there are, or allow it in {}",
                file!().replace('\\', "/")
            );
            Finding::new(entry, 1, "does not belong in the root", mend)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Sketch, assert_found};
    use super::*;

    #[test]
    fn the_house_as_planned_is_allowed() {
        let sketch = Sketch::new()
            .file("Cargo.toml", "")
            .file("LICENSE-MIT", "")
            .file("README.md", "")
            .file(".ci/run", "")
            .file(".gitignore", "")
            .file("crates/core/anything.at.all", "")
            .file("docs/a/b.png", "")
            .file("target/debug/x", "");
        assert_found(&sketch.findings(findings), &[]);
    }

    #[test]
    fn anything_else_is_found_once() {
        let sketch = Sketch::new()
            .file("notes.txt", "")
            .file("tools/a.py", "")
            .file("tools/b.py", "");
        assert_found(
            &sketch.findings(findings),
            &["notes.txt:1: does not belong in the root", "tools:1:"],
        );
    }
}
