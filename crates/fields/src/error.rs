//! What can be wrong with the parameters of fields, bases, profiles and ranges.

/// Why a field or falloff could not be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// A parameter is infinite or not a number.
    #[error(
        "the {what} of the field is not finite; give numbers that are neither infinite nor NaN"
    )]
    NotFinite {
        /// Which parameter.
        what: &'static str,
    },
    /// A length, width or power that must be positive is not (or so small that its reciprocal overflows).
    #[error("the {what} is {value}; it must be greater than 0")]
    NotPositive {
        /// Which parameter.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// A parameter is outside its range.
    #[error("the {what} is {value}; it must be from {min} to {max}")]
    OutOfRange {
        /// Which parameter.
        what: &'static str,
        /// What was given.
        value: f64,
        /// The smallest allowed value.
        min: f64,
        /// The largest allowed value.
        max: f64,
    },
    /// A direction is the null vector.
    #[error("the {what} is the null vector; give it a direction")]
    NullDirection {
        /// Which direction.
        what: &'static str,
    },
    /// A ramp starts where it ends.
    #[error("the ramp goes from {from} to {to}: give two different places along the axis")]
    EmptyRamp {
        /// Where the ramp begins.
        from: f64,
        /// Where the ramp ends.
        to: f64,
    },
    /// The falloff does not lead from 1 to 0.
    #[error(
        "the falloff `{name}` does not fall from 1 to 0 within a finite distance; choose another, such as `smoothstep`"
    )]
    NotAStep {
        /// Name of the falloff.
        name: &'static str,
    },
    /// `α < β`, `β > 0` is violated (errata F14).
    #[error("f_ab with α = {alpha} and β = {beta}: α must be less than β, and β greater than 0")]
    BadPlateau {
        /// End of the plateau.
        alpha: f64,
        /// Where the function reaches 0.
        beta: f64,
    },
    /// A model attribute holds a value that is infinite or not a number.
    #[error("attribute `{name}`: the value at index {index} is not finite")]
    BadAttribute {
        /// Name of the attribute.
        name: String,
        /// The first such index.
        index: usize,
    },
}

/// Why a basis could not be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BasisError {
    /// Degree 0 is piecewise constant: a warp made of it would tear.
    #[error("a B-spline of degree 0 jumps; give a degree of at least 1")]
    DegreeZero,
    /// Fewer control points than one span needs.
    #[error("a B-spline of degree {degree} needs at least {} control points, not {count}", degree + 1)]
    TooFewPoints {
        /// The degree.
        degree: usize,
        /// Control points given.
        count: usize,
    },
}

/// Why a profile could not be built.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ProfileError {
    /// No points or coefficients.
    #[error("the profile is empty; give at least one point [x, y] or one coefficient")]
    Empty,
    /// A coordinate or coefficient is infinite or not a number.
    #[error("entry {index} of the profile is not finite")]
    NotFinite {
        /// Number of the point or coefficient, from 0.
        index: usize,
    },
    /// The points are not in order.
    #[error(
        "point {index} of the profile has x = {x}, not greater than {previous} before it; sort the points by x and give \
         each x once"
    )]
    NotIncreasing {
        /// Number of the point, from 0.
        index: usize,
        /// Its x.
        x: f64,
        /// The x of the point before.
        previous: f64,
    },
    /// Neighbouring points whose slope overflows.
    #[error("the profile is too steep before point {index}; move the points apart")]
    TooSteep {
        /// Number of the point, from 0.
        index: usize,
    },
}

/// Why an axis range could not be built.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RangeError {
    /// A bound or the width is infinite or not a number.
    #[error("the range's {what} is not finite")]
    NotFinite {
        /// Which number.
        what: &'static str,
    },
    /// The range is empty.
    #[error("the range goes from {min} to {max}; its end must be greater than its start")]
    Empty {
        /// The start.
        min: f64,
        /// The end.
        max: f64,
    },
    /// The blend does not fit.
    #[error(
        "the blend width {width:?} must be greater than 0 and at most {most:?}, half the range"
    )]
    BadWidth {
        /// The width given.
        width: f64,
        /// The greatest width.
        most: f64,
    },
}

/// `value` if it is finite.
pub(crate) fn finite(value: f64, what: &'static str) -> Result<f64, FieldError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(FieldError::NotFinite { what })
    }
}

/// The reciprocal of a length that must be positive.
pub(crate) fn reciprocal(length: f64, what: &'static str) -> Result<f64, FieldError> {
    finite(length, what)?;
    let reciprocal = 1.0 / length;
    if length > 0.0 && reciprocal.is_finite() {
        Ok(reciprocal)
    } else {
        Err(FieldError::NotPositive {
            what,
            value: length,
        })
    }
}

/// A place with finite coordinates.
pub(crate) fn place<S: anamorph_core::Space>(p: S, what: &'static str) -> Result<S, FieldError> {
    finite(p.largest(), what).map(|_| p)
}

/// A unit vector.
pub(crate) fn direction<S: anamorph_core::Space>(
    v: S,
    what: &'static str,
) -> Result<S, FieldError> {
    place(v, what)?
        .normalized()
        .ok_or(FieldError::NullDirection { what })
}
