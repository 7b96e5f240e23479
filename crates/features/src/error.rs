//! What can be wrong with a feature.

/// Why a feature or its map could not be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum FeatureError {
    /// A coordinate is infinite or not a number.
    #[error("the {what} is not finite; give coordinates that are neither infinite nor NaN")]
    NotFinite {
        /// Which part of the feature.
        what: &'static str,
    },
    /// A frame's basis vectors do not span the space.
    #[error(
        "the frame's basis vectors lie in one {flat}; give {count} directions that are independent and not null"
    )]
    Degenerate {
        /// What they lie in: `"line"` in the plane, `"plane"` in space.
        flat: &'static str,
        /// How many the space needs.
        count: usize,
    },
    /// The map from source to target has entries beyond the range of numbers.
    #[error(
        "the map from the source frame to the target overflows; the frames differ too much in size"
    )]
    Overflow,
}
