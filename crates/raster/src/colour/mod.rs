//! Colour: encodings of light, and coverage.
//!
//! Everything that mixes pixels (filters, dissolves, splats) is right only for light itself, premultiplied by coverage.

mod alpha;
mod oklab;
mod srgb;

pub use alpha::{premultiply, unpremultiply};
pub use oklab::{linear_to_oklab, oklab_to_linear};
pub use srgb::{Srgb8, Srgb16, linear_to_srgb, srgb_to_linear};
