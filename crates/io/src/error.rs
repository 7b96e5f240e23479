//! What can go wrong, said so that it can be mended.

use core::fmt;

/// Which rule a file breaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ReadErrorKind {
    /// Neither the content nor the name tells the format.
    UnknownFormat,
    /// The bytes are not text in an encoding that the format has (UTF-16, binary data).
    Encoding,
    /// There are no points to move.
    NoPoints,
    /// A point has too few coordinates, or a row too few or too many fields.
    Shape,
    /// A coordinate is not a number.
    Number,
    /// A coordinate is NaN or infinite.
    NonFinite,
    /// A face, line or point element is malformed, has too few corners, or refers to what does not exist.
    Element,
    /// The table has no header, or its header lacks or repeats a coordinate.
    Header,
    /// A quoted field is not closed.
    Quote,
    /// The file ends before what it announces.
    Truncated,
    /// There are more points than the 2³² that an index can tell apart, or than the file's size can account for.
    TooLarge,
    /// The text is not what its syntax asks for (JSON).
    Syntax,
    /// The binary container is damaged: cut off, or its lengths disagree.
    Container,
    /// Something refers to what does not exist, or to bytes beyond their buffer.
    Reference,
    /// A version, extension or type that is not built.
    Unsupported,
    /// A file beside the one that is read is missing or may not be read.
    Companion,
    /// The nodes of a scene are no forest, or one has an impossible place.
    Scene,
    /// A drawing has nothing with an outline.
    NoPath,
    /// The font has no glyph for this character.
    Glyph(char),
}

/// Why a file could not be read: what is wrong, where, and how to mend it.
///
/// Shown as one line: `line 7, column 12: vertex 3 has the coordinate "x1", which is not a number; write …`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadError {
    /// Which rule the file breaks.
    pub kind: ReadErrorKind,
    /// Line in the file, from 1.
    pub line: Option<u64>,
    /// Byte within that line, from 1 (a table's column is named in `what`).
    pub column: Option<u64>,
    /// What is wrong, in words.
    pub what: String,
    /// How to mend it, in words.
    pub mend: String,
}

impl ReadError {
    /// An error about the file as a whole.
    pub(crate) fn new(
        kind: ReadErrorKind,
        what: impl Into<String>,
        mend: impl Into<String>,
    ) -> Self {
        Self {
            kind,
            line: None,
            column: None,
            what: what.into(),
            mend: mend.into(),
        }
    }

    /// The same error, placed at byte `offset` of `bytes`.
    pub(crate) fn at(mut self, bytes: &[u8], offset: usize) -> Self {
        let (line, column) = crate::text::place(bytes, offset);
        self.line = Some(line);
        self.column = Some(column);
        self
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.line, self.column) {
            (Some(line), Some(column)) => write!(f, "line {line}, column {column}: ")?,
            (Some(line), None) => write!(f, "line {line}: ")?,
            _ => {}
        }
        write!(f, "{}; {}", self.what, self.mend)
    }
}

impl core::error::Error for ReadError {}

/// Why a moved document could not be written. Nothing has been written unless it is [`WriteError::Output`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The moved points do not match the document's.
    #[error(
        "the document has {expected} points in {space}, but {got} moved points in {got_space} were given; give one per point, in the document's order"
    )]
    Mismatch {
        /// Points of the document.
        expected: usize,
        /// `plane` or `space`.
        space: &'static str,
        /// Points given.
        got: usize,
        /// `plane` or `space`.
        got_space: &'static str,
    },
    /// A finite point was moved to a place that is not finite.
    #[error(
        "{count} of the points were moved to a place that is not finite, the first is point {first}; a field or feature of the warp overflows there"
    )]
    NonFinite {
        /// Number of the first such point, from 1.
        first: usize,
        /// How many there are.
        count: usize,
    },
    /// A number does not fit the type that the file, or the format to be written, has for it.
    #[error("{what}; {mend}")]
    DoesNotFit {
        /// What does not fit where, in words.
        what: String,
        /// How to mend it, in words.
        mend: &'static str,
    },
    /// The format cannot hold the moved points.
    #[error("{what}; {mend}")]
    Refused {
        /// What cannot be written.
        what: String,
        /// How to mend it.
        mend: String,
    },
    /// The receiver of the bytes failed.
    #[error("the output could not be written: {0}")]
    Output(#[from] std::io::Error),
}
