//! What is wrong with the input of a curve, an ease, a motion or a path.

use thiserror::Error;

/// Why a curve or a motion could not be made. Indices count from 0.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum CurveError {
    /// Fewer points than the family needs.
    #[error("{what} needs at least {needed} points, but there are {found}: give more points")]
    TooFewPoints {
        /// The family.
        what: &'static str,
        /// Points it needs.
        needed: usize,
        /// Points given.
        found: usize,
    },
    /// A number of points that a family of fixed groups cannot use.
    #[error("{what} needs {needed} points, but there are {found}: add or remove points")]
    WrongCount {
        /// The family.
        what: &'static str,
        /// Which numbers are right, in words.
        needed: &'static str,
        /// Points given.
        found: usize,
    },
    /// A coordinate or number that is not finite.
    #[error("{what} {index} is not finite: give it a number")]
    NotFinite {
        /// What the list holds: `"point"`, `"time"`, …
        what: &'static str,
        /// Its place in the list.
        index: usize,
    },
    /// Times, nodes or keys that do not increase.
    #[error(
        "{what} {index} is {}, not greater than the one before it, {}: sort them and remove equal ones",
        Exact(*value), Exact(*before)
    )]
    NotIncreasing {
        /// What the list holds: `"time"`, `"node"`, …
        what: &'static str,
        /// Place of the first that is not greater than the one before it.
        index: usize,
        /// Its value.
        value: f64,
        /// The value before it.
        before: f64,
    },
    /// Knots that decrease.
    #[error(
        "{what} {index} is {}, less than the one before it, {}: sort them",
        Exact(*value), Exact(*before)
    )]
    Decreasing {
        /// What the list holds.
        what: &'static str,
        /// Place of the first that is less than the one before it.
        index: usize,
        /// Its value.
        value: f64,
        /// The value before it.
        before: f64,
    },
    /// Two lists that belong together have different lengths.
    #[error("there are {found} {what}, but {expected} {of} need {needed}: add or remove some")]
    Mismatch {
        /// What there is a wrong number of.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there must be.
        needed: usize,
        /// What they belong to.
        of: &'static str,
        /// How many of those there are.
        expected: usize,
    },
    /// A parameter outside its range.
    #[error("{name} is {}, but must be {range}", Short(*value))]
    OutOfRange {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The range, in words.
        range: &'static str,
    },
    /// An element of a list outside its range.
    #[error("{what} {index} is {}, but must be {range}", Exact(*value))]
    ElementOutOfRange {
        /// What the list holds.
        what: &'static str,
        /// Its place in the list.
        index: usize,
        /// Its value.
        value: f64,
        /// The range, in words.
        range: &'static str,
    },
    /// An index of something that a list does not have.
    #[error("{what} {index} does not exist: there are {count}, counted from 0")]
    NoSuchIndex {
        /// What the list holds.
        what: &'static str,
        /// The index.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A name that nothing has.
    #[error("no {what} is called `{name}`; there are: {known}")]
    UnknownName {
        /// What was looked for: `"ease"`, `"parameter of the ease"`, …
        what: &'static str,
        /// The name.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A parameter of the wrong kind.
    #[error("{name} is {found}, but must be {needed}")]
    WrongKind {
        /// The parameter.
        name: &'static str,
        /// What it is, in words.
        found: &'static str,
        /// What it must be, in words.
        needed: &'static str,
    },
    /// A text that does not say what it should.
    #[error("`{text}`, character {character}: {problem}")]
    Text {
        /// The text.
        text: String,
        /// Where in it, counted from 1.
        character: usize,
        /// What is wrong and how to mend it.
        problem: String,
    },
    /// Conditions that no motion of the kind meets together.
    #[error("{problem}")]
    Unreachable {
        /// Which conditions, and how to mend them.
        problem: String,
    },
    /// Input that a family would not read.
    #[error("a {family} curve does not read {what}: leave it out")]
    NotRead {
        /// The family.
        family: &'static str,
        /// What was given.
        what: String,
    },
    /// A family whose curves are always open.
    #[error("a {family} curve cannot be closed: leave `closed` out, or take another family")]
    NotClosed {
        /// The family.
        family: &'static str,
    },
    /// More pieces than lengths are measured of.
    #[error(
        "the curve has {pieces} pieces, but of its degree at most {most} are measured: take fewer points, or a lower degree"
    )]
    TooManyPieces {
        /// How many it has.
        pieces: usize,
        /// How many it may have.
        most: usize,
    },
    /// A curve of no length where a length is needed.
    #[error("the curve has no length: all its points coincide; give it distinct points")]
    NoLength,
}

/// A number with all digits that tell it from others, and no more zeros than needed.
struct Exact(f64);

impl core::fmt::Display for Exact {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let size = self.0.abs();
        if size != 0.0 && size.is_finite() && !(1e-4..1e9).contains(&size) {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}

/// A number with at most six significant digits, for people.
pub(crate) struct Short(pub(crate) f64);

impl core::fmt::Display for Short {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let rounded: f64 = format!("{:.5e}", self.0).parse().unwrap_or(self.0);
        let size = rounded.abs();
        if size != 0.0 && size.is_finite() && !(1e-4..1e9).contains(&size) {
            write!(f, "{rounded:e}")
        } else {
            write!(f, "{rounded}")
        }
    }
}

/// Refuses a list of points or numbers with one that is not finite.
pub(crate) fn finite<S: anamorph_core::Space>(
    what: &'static str,
    points: &[S],
) -> Result<(), CurveError> {
    match points.iter().position(|point| !point.is_finite()) {
        Some(index) => Err(CurveError::NotFinite { what, index }),
        None => Ok(()),
    }
}

/// Refuses numbers that are not finite or do not increase.
pub(crate) fn increasing(what: &'static str, values: &[f64]) -> Result<(), CurveError> {
    if let Some(index) = values.iter().position(|value| !value.is_finite()) {
        return Err(CurveError::NotFinite { what, index });
    }
    match values.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(before) => Err(CurveError::NotIncreasing {
            what,
            index: before + 1,
            value: values[before + 1],
            before: values[before],
        }),
        None => Ok(()),
    }
}

/// Refuses too few points, and points that are not finite.
pub(crate) fn enough<S: anamorph_core::Space>(
    what: &'static str,
    needed: usize,
    points: &[S],
) -> Result<(), CurveError> {
    if points.len() < needed {
        return Err(CurveError::TooFewPoints {
            what,
            needed,
            found: points.len(),
        });
    }
    finite("point", points)
}
