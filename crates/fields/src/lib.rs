//! Strength, weight and mask fields, and the scalar functions they are made of.
//!
//! - [`falloffs`]: functions of relative distance, 1 at a feature and 0 at its radius, each with its continuity class.
//! - Fields in space: [`Radial`], [`RadialWeight`], [`InverseDistance`], [`BoxField`], [`HalfSpace`], [`AxisRamp`],
//!   [`AxisProfile`]; on a model: [`Attribute`]; of fields: [`Product`], [`Complement`], [`Scaled`]. A plain number is a
//!   constant field.
//! - [`basis`]: Bernstein polynomials and B-splines, values and derivatives.
//! - [`Profile`]: a function drawn by points or given by coefficients; [`AxisRange`]: a coordinate limited to a range.
//!
//! ```
//! use anamorph_core::{glam::dvec3, Field, Site, Smoothness};
//! use anamorph_fields::{falloffs::Wires, Radial};
//!
//! let field = Radial::new(dvec3(1.0, 0.0, 0.0), 2.0, Wires)?;
//! assert_eq!(field.value(&Site::anywhere(dvec3(1.0, 0.0, 0.0))), 1.0);
//! assert_eq!(field.value(&Site::anywhere(dvec3(3.0, 0.0, 0.0))), 0.0);
//! assert_eq!(Field::smoothness(&field), Smoothness::C(1));
//! # Ok::<(), anamorph_fields::FieldError>(())
//! ```

mod algebra;
mod attribute;
mod axis;
pub mod basis;
mod error;
pub mod falloffs;
mod profile;
mod radial;
mod range;
#[cfg(feature = "recipe")]
pub mod recipe;
mod region;
#[cfg(test)]
mod testing;

pub use algebra::{Complement, Product, Scaled};
pub use attribute::Attribute;
pub use axis::{AxisProfile, AxisRamp};
pub use error::{BasisError, FieldError, ProfileError, RangeError};
pub use falloffs::{FALLOFFS, Falloff, FalloffFacts, falloff};
pub use profile::{Ends, Profile};
pub use radial::{InverseDistance, Radial, RadialWeight};
pub use range::{AxisRange, Limit};
pub use region::{BoxField, HalfSpace};
