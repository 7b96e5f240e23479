//! Warps by lines and other elements, whose pull falls off with the distance to them.
//!
//! - [`elements`]: points, segments, rectangles and boxes in one warp, in the plane and in space.
//! - [`local`]: the segments of the plane after Beier and Neely.
//! - [`global`]: the same, each turned across by what the others do.
//!
//! All three are an [`ElementWarp`](elements::ElementWarp); they differ in the transformations.
//!
//! *Source*: Milliron et al. 2002, §4.2 (Fig. 11) and §5.2 (Fig. 15), after T. Beier and S. Neely, *Feature-Based Image
//! Metamorphosis*, SIGGRAPH 1992, and A. Lerios, C. D. Garfinkle, M. Levoy, *Feature-Based Volume Metamorphosis*, SIGGRAPH
//! 1995; errata F6, F7, C18.

mod contact;
pub mod elements;
pub mod global;
mod kernel;
pub mod local;
#[cfg(feature = "recipe")]
pub(crate) mod parameters;
mod segments;
mod weights;

pub use weights::WeightConstants;

use anamorph_features::FeatureError;

/// What is wrong with a warp by elements.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ElementError {
    /// A pair whose map cannot be built.
    #[error("feature {feature}: {error}")]
    Feature {
        /// Number of the feature.
        feature: usize,
        /// What is wrong with it.
        #[source]
        error: FeatureError,
    },
    /// A constant of a weight that is negative or not finite.
    #[error(
        "`{constant}` of feature {feature} is {value}, and must be a number that is not negative"
    )]
    Constant {
        /// Number of the feature.
        feature: usize,
        /// `a`, `b` or `p`.
        constant: &'static str,
        /// The number given.
        value: f64,
    },
    /// A feature that is no segment where only segments are meant.
    #[error("feature {feature} has {corners} corners, and a line has 2")]
    NoLine {
        /// Number of the feature.
        feature: usize,
        /// How many corners it has.
        corners: usize,
    },
    /// The rotations of the lines about a line cancel, so that its direction across has no length left (errata F7).
    #[error(
        "the lines about feature {feature} turn against each other, which leaves {length:.1e} of its unit vector across \
         (at least {least} is needed); turn them less, or use the local variant"
    )]
    ShortNormal {
        /// Number of the feature.
        feature: usize,
        /// Length of the averaged vector.
        length: f64,
        /// The least that is accepted.
        least: f64,
    },
}

impl ElementError {
    /// Number of the feature at fault.
    pub fn feature(&self) -> usize {
        match *self {
            Self::Feature { feature, .. }
            | Self::Constant { feature, .. }
            | Self::NoLine { feature, .. }
            | Self::ShortNormal { feature, .. } => feature,
        }
    }
}
