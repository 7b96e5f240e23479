//! Features: the things a user places on a model, and where they should go.
//!
//! A feature pair is a source and a target of one kind: [`PointPair`], [`FramePair`], [`ElementPair`]. It knows the affine map that takes
//! the one to the other, the centre about which that map is scaled, and the [marks](anamorph_core::Mark) that show it in
//! a picture. How strongly and how far it acts is a warp's business.
//!
//! ```
//! use anamorph_core::{glam::{dvec2, DMat2}, Plane};
//! use anamorph_features::{Frame, FramePair};
//!
//! let source = Frame::<Plane>::at(dvec2(1.0, 0.0))?;
//! let target = Frame::new(dvec2(2.0, 2.0), DMat2::from_cols(dvec2(0.0, 2.0), dvec2(-2.0, 0.0)))?;
//! let map = FramePair::new(source, target).affine()?;
//! assert_eq!(map.apply(dvec2(1.0, 0.0)), dvec2(2.0, 2.0));
//! assert_eq!(map.apply(dvec2(2.0, 0.0)), dvec2(2.0, 4.0));
//! # Ok::<(), anamorph_features::FeatureError>(())
//! ```

mod element;
mod error;
mod frame;
mod point;
mod spread;

pub use element::{Element, ElementPair};
pub use error::FeatureError;
pub use frame::{Frame, FramePair};
pub use point::PointPair;
pub use spread::spread;

/// A source and a target of one kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair<F> {
    /// The feature before the warp.
    pub source: F,
    /// Where the warp should take it.
    pub target: F,
}

impl<F> Pair<F> {
    /// The pair of `source` and `target`.
    pub fn new(source: F, target: F) -> Self {
        Self { source, target }
    }

    /// The pair the other way round.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self {
            source: self.target,
            target: self.source,
        }
    }
}
