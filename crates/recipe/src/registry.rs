//! What a recipe may name: the warps of a space and the way fields are written in it.

use anamorph_catalog::schemars::{Schema, SchemaGenerator};
use anamorph_catalog::serde_json::Value;
use anamorph_catalog::{ConstructError, Context, WarpEntry};
use anamorph_core::{Field, Space};

/// Builds a field from an expression.
pub type FieldConstruction<S> =
    fn(&Value, &Context<'_, S>) -> Result<Box<dyn Field<S>>, ConstructError>;

/// How a field expression (a number, or a table that names a field and its parameters) becomes a field.
pub struct FieldExpression<S: Space> {
    /// Builds the field; paths of errors are relative to the expression.
    pub construct: FieldConstruction<S>,
    /// The JSON Schema of expressions.
    pub schema: fn(&mut SchemaGenerator) -> Schema,
}

// Derives would ask for `S: Clone`.
impl<S: Space> Clone for FieldExpression<S> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Space> Copy for FieldExpression<S> {}

/// The plug-ins that a recipe for models of the space `S` may name.
#[derive(Clone)]
pub struct Registry<S: Space> {
    /// The warps, in the order of their listing.
    pub warps: Vec<WarpEntry<S>>,
    /// The fields.
    pub field: FieldExpression<S>,
    /// Kinds of warps that exist only in the other space, for a message that says so.
    pub elsewhere: Vec<&'static str>,
}

/// The keys that a warp of any kind has, beside `kind`. A plug-in's parameters must have other names.
pub const COMMON_KEYS: [&str; 9] = [
    "label", "enabled", "strength", "weight", "mask", "ambient", "scaling", "schedule", "fit",
];
