//! Transformations that can be scaled by a strength.
//!
//! Displacement scaling, `s·T = sT + (1 − s)I`, is what every [`Affine`] map of `anamorph-core` does by itself. This crate
//! holds the *composition* method, in which the parameters of the parts (angle, shift, stretch) are multiplied by the
//! strength and composed again, so that a rotation stays a rotation at every strength:
//!
//! - [`Composed`]: any affine map, taken apart by [`polar`](fn@polar) decomposition about a centre;
//! - [`Ordered`]: parts given by the user, in the user's order;
//! - [`Rotational`], [`Turn`]: rotations of the plane and of space by axis and angle;
//! - [`quaternion`]: unit quaternions, and paths through orientations with times: slerp, Bézier, squad, a C² spline, each at
//!   constant turning speed if wanted.
//!
//! ```
//! use anamorph_core::{glam::dvec2, Affine, Plane, Space, Transformation};
//! use anamorph_transforms::Composed;
//!
//! // A quarter turn about (1, 0), at half strength: an eighth turn, where displacement scaling would also shrink.
//! let centre = dvec2(1.0, 0.0);
//! let quarter = Affine::about(centre, Plane::rotation(Plane::ZERO, 0.5 * std::f64::consts::PI), Plane::ZERO);
//! let turn = Composed::new(quarter, centre)?;
//! let half = turn.scaled(0.5).apply(dvec2(2.0, 0.0));
//! assert!((half - dvec2(1.0 + 0.5_f64.sqrt(), 0.5_f64.sqrt())).length() < 1e-15);
//! # Ok::<(), anamorph_transforms::TransformError>(())
//! ```
//!
//! [`Affine`]: anamorph_core::Affine

mod composed;
mod error;
mod ordered;
mod polar;
pub mod quaternion;
mod rotation;
#[cfg(test)]
mod testing;

pub use composed::Composed;
pub use error::TransformError;
pub use ordered::{Component, Ordered};
pub use polar::{Polar, polar};
pub use rotation::{HALF_TURN, Rotational, Turn};
