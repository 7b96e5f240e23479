//! The files that the rules look at.

use super::glob;
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What a walk without git leaves out: git's own folder and the build output that `.gitignore` names.
const IGNORED: &[&str] = &[
    ".git",
    "target",
    "out",
    "tests/fuzz/target",
    "tests/fuzz/corpus",
    "tests/fuzz/artifacts",
];

/// The files of a checkout.
pub struct Tree {
    root: PathBuf,
    files: BTreeSet<String>,
}

impl Tree {
    /// Lists the files under `root`: those that git tracks or would track when `root` is a checkout, else all but
    /// build output.
    ///
    /// # Errors
    /// That of reading a folder.
    pub fn open(root: &Path) -> io::Result<Self> {
        let listed = if root.join(".git").exists() {
            list_by_git(root)
        } else {
            None
        };
        let files = match listed {
            Some(files) => files,
            None => {
                let mut files = BTreeSet::new();
                walk(root, "", &mut files)?;
                files
            }
        };
        Ok(Self {
            root: root.to_path_buf(),
            files,
        })
    }

    /// The folder the tree was opened at.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The files, from the root, with `/` between folders, sorted.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(String::as_str)
    }

    /// The files that match a pattern of [`glob`].
    pub fn matching(&self, pattern: &str) -> impl Iterator<Item = &str> {
        self.files()
            .filter(move |file| glob::matches(pattern, file))
    }

    /// Whether the file is in the tree.
    #[must_use]
    pub fn has(&self, file: &str) -> bool {
        self.files.contains(file)
    }

    /// The text of a file; nothing when it is binary (not UTF-8, or with a NUL) or cannot be read.
    #[must_use]
    pub fn text(&self, file: &str) -> Option<String> {
        let bytes = std::fs::read(self.root.join(file)).ok()?;
        if bytes.contains(&0) {
            None
        } else {
            String::from_utf8(bytes).ok()
        }
    }
}

/// What git lists; nothing when git is absent or refuses.
fn list_by_git(root: &Path) -> Option<BTreeSet<String>> {
    let output = Command::new("git")
        .args([
            "ls-files",
            "-z",
            "--cached",
            "--others",
            "--exclude-standard",
        ])
        .current_dir(root)
        // Set in git's hooks, where they may name another checkout.
        .env_remove("GIT_DIR")
        .env_remove("GIT_WORK_TREE")
        .env_remove("GIT_INDEX_FILE")
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    let names = String::from_utf8(output.stdout).ok()?;
    let exists = |name: &&str| !name.is_empty() && root.join(name).is_file();
    Some(
        names
            .split('\0')
            .filter(exists)
            .map(str::to_owned)
            .collect(),
    )
}

fn walk(root: &Path, folder: &str, files: &mut BTreeSet<String>) -> io::Result<()> {
    for entry in std::fs::read_dir(root.join(folder))? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = if folder.is_empty() {
            name
        } else {
            format!("{folder}/{name}")
        };
        if IGNORED.contains(&path.as_str()) {
            continue;
        }
        if entry.file_type()?.is_dir() {
            walk(root, &path, files)?;
        } else {
            files.insert(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::testing::Sketch;
    use super::*;

    fn files(sketch: &Sketch) -> Vec<String> {
        sketch.tree().files().map(str::to_owned).collect()
    }

    #[test]
    fn without_git_build_output_is_left_out() {
        let sketch = Sketch::new()
            .file("a/b/c.rs", "")
            .file("target/debug/x", "")
            .file("tests/fuzz/corpus/1", "")
            .file("tests/out/kept", "")
            .file(".ci/run", "");
        assert_eq!(files(&sketch), [".ci/run", "a/b/c.rs", "tests/out/kept"]);
    }

    #[test]
    fn with_git_ignored_and_deleted_files_are_left_out_and_new_ones_are_not() {
        let sketch = Sketch::new()
            .file(".gitignore", "/made\n")
            .file("gone.rs", "")
            .file("kept.rs", "");
        let git = |arguments: &[&str]| {
            Command::new("git")
                .args(arguments)
                .current_dir(sketch.path())
                .output()
                .is_ok_and(|o| o.status.success())
        };
        if !git(&["init", "--quiet"]) {
            return; // A machine without git lists by walking, which the test above covers.
        }
        assert!(git(&["add", "."]));
        std::fs::remove_file(sketch.path().join("gone.rs")).expect("removed");
        let sketch = sketch.file("made/x", "").file("new ünusual.rs", "");
        assert_eq!(files(&sketch), [".gitignore", "kept.rs", "new ünusual.rs"]);
    }

    #[test]
    fn binary_files_have_no_text() {
        let sketch = Sketch::new()
            .file("a", "grüße")
            .file("b", [b'a', 0])
            .file("c", [0xff, 0xfe]);
        let tree = sketch.tree();
        assert_eq!(tree.text("a").as_deref(), Some("grüße"));
        assert_eq!(
            [tree.text("b"), tree.text("c"), tree.text("absent")],
            [None, None, None]
        );
    }
}
