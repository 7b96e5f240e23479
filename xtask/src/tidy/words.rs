//! Rule: words that have no place in a file of the project.
//!
//! Paths of somebody's machine and hosts of package registries say where the work was done, not what it is; marks of
//! unfinished work belong in an issue; a test that is switched off tests nothing. Every text file is read but the lock
//! file. The words are written here in pieces, so that this file does not trip on itself.

use super::{Finding, Tree};
use crate::document::Lines;

/// Where in the text around it a word counts.
#[derive(Clone, Copy)]
enum Where {
    /// Anywhere.
    Anywhere,
    /// Not inside a longer word.
    AsWord,
    /// At the start of a path: not after a name, so that a folder of that name elsewhere may be written.
    AsRoot,
}

struct Word {
    text: &'static str,
    counts: Where,
    what: &'static str,
    mend: &'static str,
}

const fn machine(text: &'static str) -> Word {
    Word {
        text,
        counts: Where::AsRoot,
        what: "a path of one machine",
        mend: "write it relative to the checkout",
    }
}

const fn registry(text: &'static str) -> Word {
    Word {
        text,
        counts: Where::Anywhere,
        what: "a package registry's address",
        mend: "leave it to cargo's defaults",
    }
}

const fn mark(text: &'static str) -> Word {
    Word {
        text,
        counts: Where::AsWord,
        what: "a mark of unfinished work",
        mend: "finish it, or open an issue",
    }
}

const fn stub(text: &'static str) -> Word {
    Word {
        text,
        counts: Where::Anywhere,
        what: "code that is not written yet",
        mend: "write it or leave it out",
    }
}

const WORDS: &[Word] = &[
    machine(concat!("/ho", "me/")),
    machine(concat!("/ro", "ot/")),
    machine(concat!("/wo", "rk/")),
    machine(concat!("/Us", "ers/")),
    registry(concat!("index.cra", "tes.io")),
    registry(concat!("static.cra", "tes.io")),
    registry(concat!("://cra", "tes.io")),
    registry(concat!("sparse", "+http")),
    registry(concat!("registry", "+http")),
    registry(concat!("replace", "-with")),
    registry(concat!("py", "pi.org")),
    registry(concat!("python", "hosted.org")),
    registry(concat!("npm", "js.org")),
    registry(concat!("proxy.go", "lang.org")),
    registry(concat!("arti", "factory")),
    mark(concat!("TO", "DO")),
    mark(concat!("FIX", "ME")),
    mark(concat!("XX", "X")),
    stub(concat!("todo", "!(")),
    stub(concat!("unimpl", "emented!(")),
    Word {
        text: concat!("#[ign", "ore"),
        counts: Where::Anywhere,
        what: "a test that does not run",
        mend: "mend the test or remove it",
    },
];

/// Words that must not be there.
#[must_use]
pub fn findings(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for file in tree.files().filter(|file| *file != "Cargo.lock") {
        if let Some(text) = tree.text(file) {
            in_text(file, &text, &mut findings);
        }
    }
    findings
}

fn in_text(file: &str, text: &str, findings: &mut Vec<Finding>) {
    let mut lines = None;
    for word in WORDS {
        for (start, _) in text.match_indices(word.text) {
            if word.counts_at(text, start) {
                let line = lines.get_or_insert_with(|| Lines::new(text)).at(start);
                findings.push(Finding::new(
                    file,
                    line,
                    format!("`{}` is {}", word.text, word.what),
                    word.mend,
                ));
            }
        }
    }
}

impl Word {
    fn counts_at(&self, text: &str, start: usize) -> bool {
        let before = text[..start].chars().next_back();
        let after = text[start + self.text.len()..].chars().next();
        let in_name = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
        match self.counts {
            Where::Anywhere => true,
            Where::AsWord => !in_name(before) && !in_name(after),
            Where::AsRoot => !in_name(before) && !before.is_some_and(|c| ".-~})]".contains(c)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Sketch, assert_found};
    use super::*;

    fn of(text: &str) -> Vec<String> {
        Sketch::new().file("docs/a.md", text).findings(findings)
    }

    #[test]
    fn every_word_is_found_on_its_line() {
        for word in WORDS {
            let text = format!("first\nsecond {}\n", word.text);
            let found = of(&text);
            assert!(!found.is_empty(), "{}", word.text);
            assert!(
                found.iter().all(|f| f.starts_with("docs/a.md:2: ")),
                "{found:?}"
            );
        }
    }

    #[test]
    fn ordinary_text_is_clean() {
        let host = concat!("cra", "tes.io");
        assert_found(
            &of(&format!(
                "See {host}, or the index on github.com/rust-lang/{host}-index.\n"
            )),
            &[],
        );
        let work = concat!("/wo", "rk/");
        assert_found(
            &of(&format!(
                "docs{work}a, ..{work}b, $X{work}c, {{root}}{work}d, example.org{work}e\n"
            )),
            &[],
        );
        assert_found(
            &of(&format!("method{0} {0}S x{0}_\n", concat!("TO", "DO"))),
            &[],
        );
        assert_found(
            &of("todo, fixme: written small they are ordinary words\n"),
            &[],
        );
    }

    #[test]
    fn paths_are_found_wherever_a_path_can_start() {
        for before in ["", " ", "\"", "(", "=", ":", "`", "file://"] {
            let text = format!("{before}{}x", concat!("/ho", "me/"));
            assert_found(&of(&text), &["is a path of one machine; write it relative"]);
        }
    }

    #[test]
    fn binary_files_and_the_lock_file_are_not_read() {
        let mark = concat!("TO", "DO");
        let sketch = Sketch::new()
            .file("Cargo.lock", mark)
            .file("docs/a.png", format!("{mark}\0"));
        assert_found(&sketch.findings(findings), &[]);
    }

    #[test]
    fn this_file_does_not_trip_on_itself() {
        let mut found = Vec::new();
        in_text("words.rs", include_str!("words.rs"), &mut found);
        assert_eq!(found, []);
    }
}
