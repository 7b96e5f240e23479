//! Rule: no Rust file is longer than [`LONGEST`] lines.
//!
//! A file past that has more than one subject. Prose is exempt.

use super::{Finding, Tree};

/// The most lines a Rust file may have.
pub const LONGEST: usize = 800;

/// Files that are too long.
#[must_use]
pub fn findings(tree: &Tree) -> Vec<Finding> {
    let lengths = tree
        .files()
        .filter(|f| f.ends_with(".rs"))
        .filter_map(|f| Some((f, tree.text(f)?.lines().count())));
    lengths
        .filter(|(_, lines)| *lines > LONGEST)
        .map(|(file, lines)| {
            let what = format!("{lines} lines, more than {LONGEST}");
            Finding::new(file, LONGEST + 1, what, "split it by subject")
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Sketch, assert_found};
    use super::*;

    #[test]
    fn the_limit_itself_is_allowed() {
        let sketch = Sketch::new()
            .file("crates/core/src/a.rs", "//\n".repeat(LONGEST))
            .file("docs/a.md", "a\n".repeat(5 * LONGEST));
        assert_found(&sketch.findings(findings), &[]);
    }

    #[test]
    fn one_line_more_is_found() {
        let sketch = Sketch::new().file("crates/core/src/a.rs", "//\n".repeat(LONGEST + 1));
        assert_found(
            &sketch.findings(findings),
            &["crates/core/src/a.rs:801: 801 lines, more than 800"],
        );
    }
}
