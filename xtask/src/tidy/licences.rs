//! Rule: every fixture under `tests/fixtures` has a licence entry, and every entry a fixture.
//!
//! The entries are in `tests/fixtures/LICENCES.toml`, whose header explains their format. Exempt are that file,
//! `README.md` beside it, and the notices that entries name.

use super::{Finding, Tree, glob};
use crate::document::{Table, Value};

const FOLDER: &str = "tests/fixtures/";
const LIST: &str = "tests/fixtures/LICENCES.toml";
const HEADER: &str = "the header of that file explains the entries";

const REQUIRED: &[&str] = &["licence", "author", "source"];
const KEYS: &[&str] = &["files", "licence", "author", "source", "notice", "modified"];

struct Entry {
    line: usize,
    /// Patterns, each with its line.
    patterns: Vec<(usize, String)>,
    notice: Option<String>,
}

/// Fixtures without a licence, entries without a fixture, and entries that leave something out.
#[must_use]
pub fn findings(tree: &Tree) -> Vec<Finding> {
    let fixtures: Vec<&str> = tree
        .files()
        .filter_map(|file| file.strip_prefix(FOLDER))
        .filter(|file| !["LICENCES.toml", "README.md"].contains(file))
        .collect();
    if !tree.has(LIST) {
        let missing = Finding::new(LIST, 1, "is missing", "give each fixture an entry in it");
        return if fixtures.is_empty() {
            Vec::new()
        } else {
            vec![missing]
        };
    }
    let mut findings = Vec::new();
    let entries = read(&tree.text(LIST).unwrap_or_default(), &mut findings);
    let notices: Vec<&str> = entries.iter().filter_map(|e| e.notice.as_deref()).collect();
    for entry in &entries {
        if let Some(notice) = entry.notice.as_deref().filter(|n| !fixtures.contains(n)) {
            let what = format!("the notice `{notice}` does not exist");
            findings.push(Finding::new(
                LIST,
                entry.line,
                what,
                "add the text of the notice, or correct the path",
            ));
        }
        for (line, pattern) in &entry.patterns {
            if !fixtures
                .iter()
                .any(|fixture| glob::matches(pattern, fixture))
            {
                let what = format!("no fixture matches `{pattern}`");
                findings.push(Finding::new(
                    LIST,
                    *line,
                    what,
                    "remove it, or correct the path (from tests/fixtures)",
                ));
            }
        }
    }
    for fixture in fixtures.iter().filter(|f| !notices.contains(f)) {
        let lines: Vec<usize> = entries
            .iter()
            .filter(|e| e.patterns.iter().any(|(_, p)| glob::matches(p, fixture)))
            .map(|e| e.line)
            .collect();
        let path = format!("{FOLDER}{fixture}");
        match lines[..] {
            [_] => {}
            [] => findings.push(Finding::new(
                path,
                1,
                "has no licence",
                format!("add an entry to {LIST}; {HEADER}"),
            )),
            [first, second, ..] => {
                let what = format!(
                    "has two licences: the entries on lines {first} and {second} of {LIST} both cover it"
                );
                findings.push(Finding::new(path, 1, what, "narrow one of the patterns"));
            }
        }
    }
    findings
}

/// The entries of the list; what is wrong with them goes to `findings`.
fn read(text: &str, findings: &mut Vec<Finding>) -> Vec<Entry> {
    let mut found =
        |line: usize, what: String, mend: &str| findings.push(Finding::new(LIST, line, what, mend));
    let table = match Table::parse(text) {
        Ok(table) => table,
        Err(error) => {
            found(error.line, error.message, "write it as TOML");
            return Vec::new();
        }
    };
    for entry in table.entries.iter().filter(|e| e.key != "fixture") {
        found(
            entry.line,
            format!("the key `{}` means nothing here", entry.key),
            HEADER,
        );
    }
    let mut entries = Vec::new();
    for (line, value) in table.get("fixture").map_or(&[][..], |e| e.value.items()) {
        let Some(table) = value.as_table() else {
            found(*line, "an entry is not a table".to_owned(), HEADER);
            continue;
        };
        for key in REQUIRED {
            if table.text(key).is_none_or(|text| text.trim().is_empty()) {
                found(
                    *line,
                    format!("the entry has no {key}"),
                    "add it as a string; `unknown` is no licence",
                );
            }
        }
        for entry in &table.entries {
            let wrong = match entry.key.as_str() {
                "modified" => !matches!(entry.value, Value::Flag(_)),
                "notice" => entry.value.as_text().is_none(),
                key => !KEYS.contains(&key),
            };
            if wrong {
                found(
                    entry.line,
                    format!("`{}` is not a key, or not of its type", entry.key),
                    HEADER,
                );
            }
        }
        let files = table.get("files").map_or(&[][..], |e| e.value.items());
        let patterns: Vec<(usize, String)> = files
            .iter()
            .filter_map(|(line, file)| Some((*line, file.as_text()?.to_owned())))
            .collect();
        if patterns.is_empty() {
            found(
                *line,
                "the entry names no files".to_owned(),
                "add `files = [\"…\"]`, with paths from tests/fixtures",
            );
        }
        entries.push(Entry {
            line: *line,
            patterns,
            notice: table.text("notice").map(str::to_owned),
        });
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Sketch, assert_found};
    use super::*;

    const GOOD: &str = "[[fixture]]\nfiles = [\"valid/spot.obj\"]\nlicence = \"CC0-1.0\"\nauthor = \"A\"\n\
        source = \"a place\"\nnotice = \"notices/spot.txt\"\nmodified = true\n\n\
        [[fixture]]\nfiles = [\"cases/**/*.json\", \"damaged/*\"]\nlicence = \"MIT\"\nauthor = \"B\"\nsource = \"made here\"\n";

    fn fixtures() -> Sketch {
        Sketch::new()
            .file("tests/fixtures/README.md", "")
            .file("tests/fixtures/valid/spot.obj", "")
            .file("tests/fixtures/notices/spot.txt", "")
            .file("tests/fixtures/cases/a.json", "")
            .file("tests/fixtures/cases/deep/b.json", "")
            .file("tests/fixtures/damaged/c.obj", "")
    }

    fn with_list(text: impl AsRef<[u8]>) -> Vec<String> {
        fixtures().file(LIST, text).findings(findings)
    }

    #[test]
    fn licensed_fixtures_are_clean() {
        assert_found(&with_list(GOOD), &[]);
        assert_found(&Sketch::new().findings(findings), &[]);
        assert_found(
            &Sketch::new()
                .file(LIST, "# No fixtures yet.\n")
                .findings(findings),
            &[],
        );
    }

    #[test]
    fn a_fixture_without_an_entry_is_found() {
        let sketch = fixtures()
            .file(LIST, GOOD)
            .file("tests/fixtures/valid/teapot.obj", "");
        assert_found(
            &sketch.findings(findings),
            &["tests/fixtures/valid/teapot.obj:1: has no licence"],
        );
        assert_found(
            &fixtures().findings(findings),
            &["tests/fixtures/LICENCES.toml:1: is missing"],
        );
    }

    #[test]
    fn an_entry_without_a_fixture_is_found_on_its_line() {
        let text = GOOD.replace(
            "[\"valid/spot.obj\"]",
            "[\n  \"valid/spot.obj\",\n  \"valid/gone-*.obj\",\n]",
        );
        assert_found(
            &with_list(text),
            &["LICENCES.toml:4: no fixture matches `valid/gone-*.obj`"],
        );
    }

    #[test]
    fn missing_and_blank_keys_are_found() {
        for key in [
            "licence = \"CC0-1.0\"",
            "author = \"A\"",
            "source = \"a place\"",
        ] {
            let name = key.split(' ').next().expect("a key");
            assert_found(
                &with_list(GOOD.replacen(key, "", 1)),
                &[&format!("LICENCES.toml:1: the entry has no {name}")],
            );
            assert_found(
                &with_list(GOOD.replacen(key, &format!("{name} = \" \""), 1)),
                &["the entry has no"],
            );
        }
    }

    #[test]
    fn two_entries_for_one_fixture_are_found() {
        let text = GOOD.replace("\"damaged/*\"", "\"damaged/*\", \"valid/*.obj\"");
        assert_found(
            &with_list(text),
            &["valid/spot.obj:1: has two licences: the entries on lines 1 and 9"],
        );
    }

    #[test]
    fn unknown_keys_wrong_types_and_absent_notices_are_found() {
        assert_found(
            &with_list(GOOD.replace("modified = true", "modfied = true")),
            &[":7: `modfied` is not a key"],
        );
        assert_found(
            &with_list(GOOD.replace("modified = true", "modified = \"yes\"")),
            &[":7: `modified` is not"],
        );
        let absent = GOOD.replace("notices/spot.txt", "notices/other.txt");
        assert_found(
            &with_list(absent),
            &[
                "the notice `notices/other.txt` does not exist",
                "notices/spot.txt:1: has no licence",
            ],
        );
        let no_files =
            format!("{GOOD}[[fixture]]\nlicence = \"MIT\"\nauthor = \"B\"\nsource = \"here\"\n");
        assert_found(&with_list(no_files), &[":14: the entry names no files"]);
        assert_found(
            &with_list(format!("mode = 1\n{GOOD}")),
            &[":1: the key `mode` means nothing here"],
        );
    }

    #[test]
    fn a_list_that_is_no_toml_is_found_with_its_line() {
        let found = with_list("[[fixture]]\nfiles = = 1\n");
        assert!(
            found[0].starts_with("tests/fixtures/LICENCES.toml:2: "),
            "{found:?}"
        );
    }
}
