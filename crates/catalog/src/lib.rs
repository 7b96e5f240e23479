//! Registry entries: what a plug-in is called, how it is documented, and how it is built from a recipe's parameters.
//!
//! A component crate (warps, fields) offers a slice of [`Entry`] values behind its feature `recipe`. The recipe crate
//! reads them to build warps, to write the JSON Schema and to name the nearest known word after a typing error; the
//! gallery, the documentation and the law tests loop over the same slices. Adding a plug-in is one file and one line.
//!
//! The parameter types here ([`Angle`], [`Length`], [`Place`], …) are what makes recipes readable and portable: angles
//! carry a unit, places and lengths may be percentages of the model's bounds.

mod entry;
mod error;
mod mesh;
mod parameters;

pub use entry::{
    Attributes, Between, Built, Context, Entry, Features, FieldEntry, Refit, WarpEntry, WithTargets,
};
pub use error::{ConstructError, parse, source_and_target};
pub use mesh::{FeatureMesh, Meshes};
pub use parameters::{Along, Angle, Axis, Coordinate, Length, Offset, Place, ScalingMethod};
pub use schemars;
pub use serde_json::{self, Value};
