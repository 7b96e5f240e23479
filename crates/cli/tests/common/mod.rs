//! The built command, run in a folder of its own.

// Each test file uses its own part of this.
#![allow(dead_code)]

use serde_json::Value;
use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A recipe that does nothing.
pub(crate) const EMPTY: &str = "version = 1\n";
/// A recipe that moves nearly every point of any solid model that has a height.
pub(crate) const TWIST: &str =
    "version = 1\n[[warp]]\nkind = \"twist\"\naxis = \"y\"\nangle = \"120deg\"\n";

/// A file of the repository.
pub(crate) fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path)
}

/// The bytes of a fixture.
pub(crate) fn fixture(path: &str) -> Vec<u8> {
    let path = repository("tests/fixtures").join(path);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Names of the files in a folder of the repository that end so, sorted.
pub(crate) fn listed(folder: &str, end: &str) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(repository(folder))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(end))
        .collect();
    names.sort();
    assert!(!names.is_empty(), "no {end} in {folder}");
    names
}

/// What a run of the command did.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) out: Vec<u8>,
    pub(crate) err: String,
}

impl Run {
    /// Standard output as text.
    pub(crate) fn text(&self) -> String {
        String::from_utf8(self.out.clone()).unwrap()
    }
    /// Standard output as JSON.
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.out).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }
    /// The command ended well.
    pub(crate) fn done(self) -> Self {
        assert_eq!(self.code, 0, "{self:?}");
        self
    }
    /// The command ended with this code and says all of these on standard error.
    pub(crate) fn failed(self, code: i32, says: &[&str]) -> Self {
        assert_eq!(self.code, code, "{self:?}");
        for words in says {
            assert!(self.err.contains(words), "no {words:?} in {}", self.err);
        }
        assert!(self.err.contains("error: "), "{}", self.err);
        self
    }
}

/// A folder in which the command is run.
pub(crate) struct Folder(tempfile::TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }
    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }
    /// Writes a file.
    pub(crate) fn put(&self, name: &str, content: impl AsRef<[u8]>) -> &Self {
        std::fs::write(self.path().join(name), content).unwrap();
        self
    }
    /// A folder with a copy of a fixture and these recipes.
    pub(crate) fn with(fixture_path: &str, recipes: &[(&str, &str)]) -> Self {
        let folder = Self::new();
        let name = fixture_path.rsplit('/').next().unwrap();
        folder.put(name, fixture(fixture_path));
        for (name, text) in recipes {
            folder.put(name, text);
        }
        folder
    }
    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }
    pub(crate) fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&self.read(name)).unwrap()
    }
    /// Everything in it, hidden files and folders (with `/`) too, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        fn walk(folder: &Path, prefix: &str, names: &mut Vec<String>) {
            for entry in std::fs::read_dir(folder).unwrap() {
                let entry = entry.unwrap();
                let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
                if entry.file_type().unwrap().is_dir() {
                    names.push(format!("{name}/"));
                    walk(&entry.path(), &format!("{name}/"), names);
                } else {
                    names.push(name);
                }
            }
        }
        let mut names = Vec::new();
        walk(self.path(), "", &mut names);
        names.sort();
        names
    }
    /// The command, to be run here with pipes for its streams.
    pub(crate) fn command<A: AsRef<OsStr>>(&self, arguments: &[A]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_anamorph"));
        command
            .args(arguments)
            .current_dir(self.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }
    /// Runs the command without input.
    pub(crate) fn run<A: AsRef<OsStr>>(&self, arguments: &[A]) -> Run {
        self.finish(&mut self.command(arguments), b"")
    }
    /// Runs the command with this on standard input.
    pub(crate) fn run_with<A: AsRef<OsStr>>(&self, input: &[u8], arguments: &[A]) -> Run {
        self.finish(self.command(arguments).stdin(Stdio::piped()), input)
    }
    /// Runs a prepared command. However it ends: no panic, no signal, no temporary file.
    pub(crate) fn finish(&self, command: &mut Command, input: &[u8]) -> Run {
        let mut child = command.spawn().unwrap();
        let stdin = child.stdin.take();
        let output = std::thread::scope(|scope| {
            scope.spawn(move || {
                if let Some(mut stdin) = stdin {
                    // Who fails early does not read it all.
                    let _ = stdin.write_all(input);
                }
            });
            child.wait_with_output().unwrap()
        });
        let run = Run {
            code: output
                .status
                .code()
                .unwrap_or_else(|| panic!("{:?}", output.status)),
            out: output.stdout,
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        };
        assert!(!run.err.contains("panicked"), "{run:?}");
        assert!(matches!(run.code, 0..=2), "{run:?}");
        let left = self.names();
        assert!(
            !left.iter().any(|name| name.contains(".anamorph-")),
            "{left:?}"
        );
        run
    }
}
