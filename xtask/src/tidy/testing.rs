//! Small trees to try the rules on.

use super::{Finding, Rule, Tree};
use std::path::Path;

/// A tree in a temporary folder, written file by file.
pub(crate) struct Sketch {
    folder: tempfile::TempDir,
}

impl Sketch {
    pub(crate) fn new() -> Self {
        Self {
            folder: tempfile::tempdir().expect("a temporary folder"),
        }
    }

    /// Writes a file and the folders it lies in.
    pub(crate) fn file(self, path: &str, contents: impl AsRef<[u8]>) -> Self {
        let place = self.folder.path().join(path);
        std::fs::create_dir_all(place.parent().expect("a folder")).expect("a folder");
        std::fs::write(place, contents).expect("a file");
        self
    }

    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    pub(crate) fn tree(&self) -> Tree {
        Tree::open(self.path()).expect("a listing")
    }

    /// The findings of a rule, as printed.
    pub(crate) fn findings(&self, rule: Rule) -> Vec<String> {
        rule(&self.tree()).iter().map(Finding::to_string).collect()
    }
}

/// Checks that the findings are as many as the texts, and that each contains its text.
#[track_caller]
pub(crate) fn assert_found(findings: &[String], texts: &[&str]) {
    let agree =
        findings.len() == texts.len() && findings.iter().zip(texts).all(|(f, t)| f.contains(t));
    assert!(agree, "found {findings:#?}\nexpected {texts:#?}");
}
