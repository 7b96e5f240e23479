//! What is wrong with the input of an orientation.

use crate::CurveError;
use crate::error::Short;
use thiserror::Error;

/// Why frames along a path could not be made.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum OrientationError {
    /// The path, or the auxiliary curve, has no length: it never has a direction.
    #[error("{what}: {source}")]
    Curve {
        /// Which curve.
        what: &'static str,
        /// What is wrong with it.
        source: CurveError,
    },
    /// A vector that is null or not finite where a direction is needed.
    #[error(
        "{name} is ({x}, {y}, {z}), which is no direction: give it a finite vector that is not null"
    )]
    NoDirection {
        /// The parameter.
        name: &'static str,
        /// Its coordinates.
        x: f64,
        /// Its coordinates.
        y: f64,
        /// Its coordinates.
        z: f64,
    },
    /// A point that is not finite.
    #[error("{name} is not finite: give it finite coordinates")]
    NotFinite {
        /// The parameter.
        name: &'static str,
    },
    /// A number outside its range.
    #[error("{name} is {}, but must be {range}", Short(*value))]
    OutOfRange {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The range, in words.
        range: &'static str,
    },
    /// The two curves of an auxiliary orientation, one closed, one open.
    #[error("the path is {path} and the auxiliary curve {auxiliary}: close both or neither")]
    Unlike {
        /// `"open"` or `"closed"`.
        path: &'static str,
        /// `"open"` or `"closed"`.
        auxiliary: &'static str,
    },
    /// A parameter that an orientation would not read.
    #[error("the orientation `{kind}` does not read {what}: leave it out; it reads {known}")]
    NotRead {
        /// The orientation.
        kind: &'static str,
        /// What was given.
        what: String,
        /// What it reads, in words.
        known: String,
    },
    /// A parameter without which an orientation is nothing.
    #[error("the orientation `{kind}` needs `{name}`, {meaning}")]
    Missing {
        /// The orientation.
        kind: &'static str,
        /// The parameter.
        name: &'static str,
        /// What it is.
        meaning: &'static str,
    },
    /// A value of the wrong type.
    #[error("`{name}` takes {takes}: give it that")]
    WrongType {
        /// The parameter.
        name: &'static str,
        /// What it takes, in words.
        takes: &'static str,
    },
    /// A word that is not one of a choice.
    #[error("`{name}` is \"{value}\", but must be one of {choices}")]
    NoChoice {
        /// The parameter.
        name: &'static str,
        /// The word given.
        value: String,
        /// The words there are.
        choices: String,
    },
}

/// Refuses vectors that are no direction.
pub(super) fn direction(
    name: &'static str,
    vector: anamorph_core::Solid,
) -> Result<anamorph_core::Solid, OrientationError> {
    anamorph_core::Space::normalized(vector).ok_or(OrientationError::NoDirection {
        name,
        x: vector.x,
        y: vector.y,
        z: vector.z,
    })
}

/// Refuses numbers outside a range; `holds` says whether they are in it. What is not finite never is.
pub(super) fn in_range(
    name: &'static str,
    value: f64,
    holds: bool,
    range: &'static str,
) -> Result<f64, OrientationError> {
    if holds && value.is_finite() {
        Ok(value)
    } else {
        Err(OrientationError::OutOfRange { name, value, range })
    }
}

/// An error of the path itself.
pub(super) fn of_path(source: CurveError) -> OrientationError {
    OrientationError::Curve {
        what: "the path",
        source,
    }
}
