//! What can be wrong with the parameters of a transformation.

/// Why a transformation could not be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TransformError {
    /// A matrix, vector or number is infinite or not a number.
    #[error(
        "the {what} of the transformation is not finite; give numbers that are neither infinite nor NaN"
    )]
    NotFinite {
        /// Which parameter.
        what: &'static str,
    },
    /// A direction is the null vector.
    #[error("component {index}: the {what} is the null vector; give it a direction")]
    NullDirection {
        /// Number of the component in its list, from 0.
        index: usize,
        /// Which direction.
        what: &'static str,
    },
    /// A shear whose direction leaves its plane.
    #[error(
        "component {index}: the direction of a shear must lie in its plane, perpendicular to the normal; a part along the \
         normal is a stretch, to be given as one"
    )]
    ShearOffPlane {
        /// Number of the component in its list, from 0.
        index: usize,
    },
}
