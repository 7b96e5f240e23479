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
        "the map from the source to the target overflows; they differ too much in size or place"
    )]
    Overflow,
    /// An element has no corner, or more edges than the space has dimensions.
    #[error("an element of the {space} has 1 to {most} corners, and {found} are given")]
    Corners {
        /// The space's name.
        space: &'static str,
        /// How many corners were given.
        found: usize,
        /// How many the space allows.
        most: usize,
    },
    /// The edges of a rectangle or box are dependent.
    #[error(
        "the {what} is flat: its edges lie in one {flat}; move a corner, or give fewer corners to a feature of less extent"
    )]
    Flat {
        /// Which part of the feature.
        what: &'static str,
        /// What they lie in: `"line"` or `"plane"`.
        flat: &'static str,
    },
    /// A source and a target with different numbers of corners.
    #[error(
        "the source has {source_corners} corners and the target {target_corners}; give both as many"
    )]
    Unlike {
        /// Corners of the source.
        source_corners: usize,
        /// Corners of the target.
        target_corners: usize,
    },
}
