//! Recipes: a declarative file, TOML or JSON, becomes a stack of warps, or a motion along a path.
//!
//! ```toml
//! version = 1
//!
//! [[warp]]
//! kind = "twist"
//! axis = "y"
//! angle = "90deg"
//! mask = 0.5
//! ```
//!
//! [`Recipe::read`] parses either syntax into one tree that remembers where everything stands. [`Recipe::set`] changes
//! single values. [`Recipe::build`] checks every key at every depth against the schemas of a [`Registry`] and constructs
//! the warps in order; [`schema`] is the JSON Schema of the whole file, for editors. Which warps and fields exist is the
//! registry's business, not this crate's.
//!
//! A recipe with a table `[motion]` describes no warps but a motion along a path: [`Recipe::build_motion`].
//!
//! The keys of every warp, whatever its kind, are [`COMMON_KEYS`]; they are taken out before a plug-in sees its table.
//!
//! A [`RecipeError`] names file, line, column and path of each problem and says how to mend it. Nothing here panics on
//! data, and no recipe, however hostile, overflows the stack: nesting is limited to [`MAX_DEPTH`] levels.

mod check;
mod construct;
mod error;
mod fit;
mod json;
mod keys;
mod morph;
mod motion;
mod names;
mod recipe;
mod registry;
mod schema;
mod set;
mod time;
mod toml;
mod tree;
mod words;

pub use construct::{BoundsAfter, BuiltPart, BuiltRecipe};
pub use error::{Place, Problem, RecipeError};
pub use morph::{MorphFeatures, MorphWay};
pub use motion::{
    Attitude, BuiltMotion, KEYED, KeyedOrientation, SMOOTHINGS, SmoothingEntry, Subject,
};
pub use recipe::{MAX_DEPTH, Recipe};
pub use registry::{COMMON_KEYS, FieldConstruction, FieldExpression, Registry};
pub use schema::schema;
