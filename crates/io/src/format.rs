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
}

impl ReadOptions {
    /// Sets [`ReadOptions::allow_nonfinite`].
    #[must_use]
    pub fn allow_nonfinite(mut self, allow: bool) -> Self {
        self.allow_nonfinite = allow;
        self
    }
    /// Lets everything pass that an [inspection](crate::Document::inspect) can report as a problem.
    #[must_use]
    pub fn for_inspection() -> Self {
        Self {
            allow_nonfinite: true,
            allow_broken_elements: true,
        }
    }
}
