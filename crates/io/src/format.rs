//! What a file format is.

use crate::{Document, ReadError};

/// One file format: an entry of the [registry](crate::formats).
pub trait Format: Sync {
    /// Its short name: lower case, unique, the usual extension.
    fn name(&self) -> &'static str;
    /// What it is called in prose.
    fn title(&self) -> &'static str;
    /// Extensions of such files, in lower case, without the point.
    fn extensions(&self) -> &'static [&'static str];
    /// Whether a file that begins with `head` is of this format, judged by content alone. `head` may end anywhere.
    fn recognises(&self, head: &[u8]) -> Recognition;
    /// Reads a whole file. Memory is bounded by a small multiple of `bytes`, whatever numbers they contain.
    ///
    /// # Errors
    /// A [`ReadError`] that names the first thing wrong and how to mend it.
    fn read(&self, bytes: Vec<u8>, options: &ReadOptions) -> Result<Box<dyn Document>, ReadError>;
    /// As [`Format::read`], for a file that may keep part of its data in others.
    ///
    /// # Errors
    /// As of [`Format::read`]; also where a file that is needed cannot be had.
    fn read_with(
        &self,
        bytes: Vec<u8>,
        options: &ReadOptions,
        companions: &dyn Companions,
    ) -> Result<Box<dyn Document>, ReadError> {
        let _ = companions;
        self.read(bytes, options)
    }
}

/// The files beside the one that is read. The library opens none; whoever calls it decides what may be.
pub trait Companions {
    /// The content of the file of that name, which is relative to the place of the file that names it and written as there,
    /// with percent signs decoded.
    ///
    /// # Errors
    /// A sentence that says why there is none and how to mend it.
    fn read(&self, name: &str) -> Result<Vec<u8>, String>;
}

/// No files beside the one that is read.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoCompanions;

impl Companions for NoCompanions {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        Err(format!(
            "the file {name:?}, to which it refers, was not given with it"
        ))
    }
}

/// How sure a format is that a file is its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Recognition {
    /// It is not.
    No,
    /// It may be.
    Possible,
    /// It is.
    Certain,
}

/// What reading lets pass. The default is strict.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReadOptions {
    /// Let points with NaN or infinite coordinates pass; they are listed by
    /// [`Document::nonfinite`](crate::Document::nonfinite) and written as they were read.
    pub allow_nonfinite: bool,
    /// Let faces, lines and points pass that refer to what does not exist or make no sense; they are kept in the file,
    /// left out of the mesh, and listed as problems by [`Document::inspect`](crate::Document::inspect).
    pub allow_broken_elements: bool,
    /// Give points in the coordinates of each mesh, rather than in those of the scene that places it. Formats without a scene
    /// know no difference.
    pub local: bool,
}

impl ReadOptions {
    /// Sets [`ReadOptions::allow_nonfinite`].
    #[must_use]
    pub fn allow_nonfinite(mut self, allow: bool) -> Self {
        self.allow_nonfinite = allow;
        self
    }
    /// Sets [`ReadOptions::local`].
    #[must_use]
    pub fn local(mut self, local: bool) -> Self {
        self.local = local;
        self
    }
    /// Lets everything pass that an [inspection](crate::Document::inspect) can report as a problem.
    #[must_use]
    pub fn for_inspection() -> Self {
        Self {
            allow_nonfinite: true,
            allow_broken_elements: true,
            ..Self::default()
        }
    }
}
