//! Rule: a plug-in says what it is and where it comes from, and a component's module says what it holds.
//!
//! A plug-in file begins with a module doc of [`SHORTEST`] lines or more, one of which starts a reference: `*Source*:`
//! followed, on that line or its continuation, by a year of publication or by the word `decision` where the project
//! chose for itself. Every module directly under a component's `src` begins with a module doc.

use super::floors::HOUSE;
use super::{Finding, Tree};

/// Where plug-ins live, as patterns of [`super::glob`]; `mod.rs` is not one.
const PLUGINS: &[&str] = &[
    "crates/warps/src/*/*.rs",
    "crates/fields/src/falloffs/*.rs",
    "crates/io/src/formats/*.rs",
    "crates/morph/src/schemes/*.rs",
    "crates/curves/src/families/*.rs",
];

/// The fewest lines of a plug-in's module doc.
pub const SHORTEST: usize = 3;

/// The floor of the façade and the command line; components are below.
const TOP_FLOOR: u8 = 4;

const REFERENCE: &str = "*Source*:";

/// Plug-ins and modules that do not say what they are.
#[must_use]
pub fn findings(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for row in HOUSE.iter().filter(|row| row.floor < TOP_FLOOR) {
        for file in tree.matching(&format!("crates/{}/src/*.rs", row.folder)) {
            if module_doc(&tree.text(file).unwrap_or_default()).is_empty() {
                findings.push(undocumented(file));
            }
        }
    }
    let plugins = PLUGINS.iter().flat_map(|pattern| tree.matching(pattern));
    for file in plugins.filter(|file| !file.ends_with("/mod.rs")) {
        findings.extend(of_plugin(file, &tree.text(file).unwrap_or_default()));
    }
    findings
}

fn of_plugin(file: &str, text: &str) -> Option<Finding> {
    let doc = module_doc(text);
    if doc.is_empty() {
        return Some(undocumented(file));
    }
    if doc.len() < SHORTEST {
        let what = format!(
            "the module doc has {} lines, fewer than {SHORTEST}",
            doc.len()
        );
        return Some(Finding::new(
            file,
            1,
            what,
            format!("say what it computes, and give its `{REFERENCE}`"),
        ));
    }
    let references: Vec<(usize, String)> = references(&doc);
    match references.first() {
        None => {
            let mend = format!(
                "add a line `{REFERENCE} …` with title, authors and year, or with the word `decision`"
            );
            Some(Finding::new(
                file,
                1,
                "the module doc has no reference",
                mend,
            ))
        }
        Some((line, _))
            if !references
                .iter()
                .any(|(_, text)| names_year_or_decision(text)) =>
        {
            let mend = "name the year of publication, or say `decision` where the project chose";
            Some(Finding::new(file, *line, "the reference has no year", mend))
        }
        Some(_) => None,
    }
}

fn undocumented(file: &str) -> Finding {
    Finding::new(
        file,
        1,
        "does not begin with a module doc",
        "say in `//!` lines at the top what it holds",
    )
}

/// The lines of the module doc that a file begins with, without their `//!`.
fn module_doc(text: &str) -> Vec<&str> {
    text.lines()
        .map_while(|line| line.strip_prefix("//!"))
        .map(str::trim)
        .collect()
}

/// The references of a module doc: the line each starts on, and its text up to the next blank line or reference.
fn references(doc: &[&str]) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let mut open = false;
    for (index, line) in doc.iter().enumerate() {
        if line.contains(REFERENCE) {
            open = true;
            found.push((index + 1, (*line).to_owned()));
        } else if line.is_empty() {
            open = false;
        } else if let Some((_, text)) = found.last_mut().filter(|_| open) {
            text.push(' ');
            text.push_str(line);
        }
    }
    found
}

fn names_year_or_decision(text: &str) -> bool {
    text.split(|c: char| !c.is_alphanumeric()).any(|word| {
        let year = word.len() == 4
            && (word.starts_with("19") || word.starts_with("20"))
            && word.bytes().all(|b| b.is_ascii_digit());
        year || word.eq_ignore_ascii_case("decision")
    })
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Sketch, assert_found};
    use super::*;

    const GOOD: &str = "//! Twists about an axis.\n//!\n//! *Source*: Barr, *Global and Local Deformations of Solid\n\
        //! Primitives*, SIGGRAPH 1984, eq. (3).\n//!\n//! More.\n\nfn x() {}\n";

    fn warp(text: &str) -> Vec<String> {
        Sketch::new()
            .file("crates/warps/src/barr/twist.rs", text)
            .findings(findings)
    }

    #[test]
    fn documented_plugins_and_modules_are_clean() {
        let decided = "//! A cosine.\n//!\n//! *Source*: a decision of the project: the easiest smooth step.\n";
        let sketch = Sketch::new()
            .file("crates/warps/src/barr/twist.rs", GOOD)
            .file("crates/warps/src/barr/mod.rs", "mod twist;\n")
            .file("crates/fields/src/falloffs/cosine.rs", decided)
            .file("crates/io/src/formats/obj.rs", GOOD)
            .file("crates/io/src/lib.rs", "//! Bytes.\n")
            .file("crates/cli/src/main.rs", "fn main() {}\n");
        assert_found(&sketch.findings(findings), &[]);
    }

    #[test]
    fn every_place_for_plugins_is_looked_at() {
        for place in [
            "warps/src/f/a",
            "fields/src/falloffs/a",
            "io/src/formats/a",
            "morph/src/schemes/a",
            "curves/src/families/a",
        ] {
            let sketch = Sketch::new().file(&format!("crates/{place}.rs"), "fn x() {}\n");
            assert_found(
                &sketch.findings(findings),
                &[":1: does not begin with a module doc"],
            );
        }
    }

    #[test]
    fn a_doc_that_is_short_or_not_at_the_top_is_found() {
        assert_found(
            &warp("//! *Source*: Barr 1984.\n"),
            &["twist.rs:1: the module doc has 1 lines, fewer than 3"],
        );
        assert_found(
            &warp(&format!("use x;\n{GOOD}")),
            &["twist.rs:1: does not begin with a module doc"],
        );
    }

    #[test]
    fn a_missing_reference_or_one_without_a_year_is_found() {
        assert_found(
            &warp(&GOOD.replace("*Source*:", "Source:")),
            &["twist.rs:1: the module doc has no reference"],
        );
        assert_found(
            &warp(&GOOD.replace("1984", "some year")),
            &["twist.rs:3: the reference has no year"],
        );
        assert_found(
            &warp(&GOOD.replace("1984", "19845")),
            &["the reference has no year"],
        );
        // A year in a later paragraph is not the reference's.
        assert_found(
            &warp(&GOOD.replace("1984", "?").replace("More", "Since 1999")),
            &["the reference has no year"],
        );
    }

    #[test]
    fn one_dated_reference_of_several_is_enough() {
        assert_found(
            &warp("//! A.\n//! *Source*: unpublished notes.\n//! *Source*: Barr 1984.\n"),
            &[],
        );
    }

    #[test]
    fn a_components_module_without_a_doc_is_found() {
        let sketch = Sketch::new()
            .file("crates/core/src/space.rs", "// The plane.\n")
            .file("crates/recipe/src/units.rs", "\n//! Late.\n")
            .file("crates/core/src/inner/deep.rs", "fn x() {}\n");
        assert_found(
            &sketch.findings(findings),
            &[
                "crates/core/src/space.rs:1: does not begin",
                "crates/recipe/src/units.rs:1: does not begin",
            ],
        );
    }
}
