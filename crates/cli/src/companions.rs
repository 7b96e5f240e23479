//! Files beside a model: read with it, and put beside what is written.

use crate::error::{Failure, say};
use crate::files::{self, Pending};
use anamorph_io::{Companions, Document};
use std::path::{Component, Path, PathBuf};

/// The files in the folder of a model.
pub(crate) struct Folder<'a> {
    /// Its folder; `None` for a model from standard input.
    folder: Option<&'a Path>,
    allow_outside: bool,
}

impl<'a> Folder<'a> {
    pub(crate) fn of(model: &'a Path, allow_outside: bool) -> Self {
        let folder = (!files::is_stream(model)).then(|| files::folder_of(model));
        Self {
            folder,
            allow_outside,
        }
    }
}

/// Whether a name leads only downwards.
fn is_inside(name: &Path) -> bool {
    name.components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}

impl Companions for Folder<'_> {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        let Some(folder) = self.folder else {
            return Err(format!(
                "it is in the file {name:?}, and a model from standard input has no folder; name the model's file instead"
            ));
        };
        let outside = |what: &str| {
            format!("{what}, outside of the model's folder; move it there, or add --allow-outside")
        };
        let relative = Path::new(name);
        if !self.allow_outside && !is_inside(relative) {
            return Err(outside(&format!("it is in the file {name:?}")));
        }
        let path = folder.join(relative);
        let missing = |error: std::io::Error| {
            let mend = files::mend(error.kind());
            format!("{}: {error}{mend}", path.display())
        };
        let real = std::fs::canonicalize(&path).map_err(missing)?;
        let real_folder = std::fs::canonicalize(folder).map_err(missing)?;
        if !self.allow_outside && !real.starts_with(&real_folder) {
            return Err(outside(&format!(
                "the file {name:?} is a link to {}",
                real.display()
            )));
        }
        let is_file = std::fs::metadata(&real).map_err(missing)?.is_file();
        if !is_file {
            return Err(format!(
                "{}: is no file; correct the name in the model",
                path.display()
            ));
        }
        std::fs::read(&real).map_err(missing)
    }
}

/// Claims a place for a copy; `false` if it belongs to an input, a result or another copy of the run.
pub(crate) type Claim<'a> = &'a dyn Fn(&PathBuf) -> Result<bool, Failure>;

/// Files that go with a written model.
#[derive(Default)]
pub(crate) struct Copies {
    pub(crate) files: Vec<Pending>,
    /// Folders made for them.
    made: Vec<PathBuf>,
    notes: Vec<String>,
}

impl Copies {
    /// Begins copies of the files that the written model refers to, where it goes to another folder than the one it came
    /// from. One that is there already stays if it is the same, and is replaced only if `replace`.
    pub(crate) fn begin(
        document: &dyn Document,
        model: &Path,
        output: &Path,
        replace: bool,
        claim: Claim<'_>,
    ) -> Result<Self, Failure> {
        let mut copies = Self::default();
        let names = document.companions();
        if names.is_empty() {
            return Ok(copies);
        }
        if files::is_immediate(output) || files::is_stream(model) {
            copies.notes.push(format!(
                "what is written refers to files beside it: {}",
                names.join(", ")
            ));
            return Ok(copies);
        }
        let (from, to) = (files::folder_of(model), files::folder_of(output));
        if files::identity(from) == files::identity(to) {
            return Ok(copies);
        }
        for name in names {
            copies.one(&name, from, to, replace, claim)?;
        }
        Ok(copies)
    }

    fn one(
        &mut self,
        name: &str,
        from: &Path,
        to: &Path,
        replace: bool,
        claim: Claim<'_>,
    ) -> Result<(), Failure> {
        let relative = Path::new(name);
        if relative.is_absolute() {
            return Ok(());
        }
        if !is_inside(relative) {
            self.notes.push(format!(
                "{name} is outside of the model's folder and was not copied; what is written refers to it"
            ));
            return Ok(());
        }
        let (source, target) = (from.join(relative), to.join(relative));
        let inside = std::fs::canonicalize(&source)
            .ok()
            .zip(std::fs::canonicalize(from).ok())
            .is_some_and(|(source, from)| source.starts_with(from));
        if !source.is_file() || !inside {
            self.notes.push(format!(
                "the model refers to {name}, which is not in its folder"
            ));
            return Ok(());
        }
        if files::identity(&source) == files::identity(&target) {
            return Ok(());
        }
        let there = target.symlink_metadata().is_ok();
        if there && same_content(&source, &target) {
            return Ok(());
        }
        if !claim(&target)? {
            return Err(Failure::new(format!(
                "{}: the model refers to a file of this name, which would be copied to where another file of this run is or goes; \
                 choose another folder for the output",
                target.display()
            )));
        }
        if there && !replace {
            return Err(Failure::new(format!(
                "{}: exists already and differs from the file that goes with the model; choose another folder, or add --force to replace it",
                target.display()
            )));
        }
        let folder = files::folder_of(&target);
        if !folder.is_dir() {
            self.made.extend(files::make_folder(folder)?);
        }
        let mut pending = Pending::create(&target, replace)?;
        pending.fill(|out| {
            let mut source = std::fs::File::open(&source)?;
            std::io::copy(&mut source, out).map(|_| ())
        })?;
        self.notes.push(format!("{name} was copied with the model"));
        self.files.push(pending);
        Ok(())
    }

    /// Says what was copied and what was not.
    pub(crate) fn print(&self) {
        for note in &self.notes {
            say!("  note: {note}");
        }
    }
}

impl Drop for Copies {
    /// Takes away folders in which nothing came to be.
    fn drop(&mut self) {
        self.files.clear();
        files::remove_empty(&self.made);
    }
}

/// Whether two files hold the same.
fn same_content(a: &Path, b: &Path) -> bool {
    let length = |path: &Path| {
        std::fs::metadata(path)
            .ok()
            .filter(std::fs::Metadata::is_file)
            .map(|m| m.len())
    };
    length(a).is_some()
        && length(a) == length(b)
        && std::fs::read(a)
            .ok()
            .zip(std::fs::read(b).ok())
            .is_some_and(|(a, b)| a == b)
}
