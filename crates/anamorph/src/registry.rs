//! All warps and fields of this crate as registries, for [`Recipe::build`](crate::recipe::Recipe::build).
//!
//! ```
//! use anamorph::catalog::Context;
//! use anamorph::glam::dvec3;
//! use anamorph::recipe::Recipe;
//! use anamorph::{Bounds, map_all, registry};
//!
//! let recipe = Recipe::from_toml(
//!     "version = 1\n[[warp]]\nkind = \"taper\"\naxis = \"y\"\nfactor = 0.5\n",
//!     "taper.toml",
//! )?;
//! let mut points = [dvec3(-1.0, 0.0, -1.0), dvec3(1.0, 2.0, 1.0)];
//! let context = Context { bounds: Bounds::of(&points), ..Context::default() };
//! // A recipe with several warps asks where the model has come to; here there is one.
//! let built = recipe.build(&registry::solid(), &context, &mut |_| None)?;
//! map_all(&built.stack(), &mut points);
//! assert_eq!(points, [dvec3(-1.0, 0.0, -1.0), dvec3(0.5, 2.0, 0.5)]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::{Plane, Solid, Space};
use anamorph_recipe::{FieldExpression, Registry};
use anamorph_warps::registry;

fn field<S: Space>() -> FieldExpression<S> {
    FieldExpression {
        construct: anamorph_fields::recipe::construct,
        schema: anamorph_fields::recipe::schema,
    }
}

/// Kinds of `all` that `here` lacks.
fn missing(here: &[&'static str], all: &[&'static str]) -> Vec<&'static str> {
    let mut missing = all.to_vec();
    missing.retain(|kind| !here.contains(kind));
    missing
}

/// What a recipe for a model in the plane may name.
pub fn plane() -> Registry<Plane> {
    let (warps, others) = (registry::plane(), registry::solid());
    let here: Vec<_> = warps.iter().map(|entry| entry.kind).collect();
    let all: Vec<_> = others.iter().map(|entry| entry.kind).collect();
    Registry {
        warps,
        field: field(),
        elsewhere: missing(&here, &all),
    }
}

/// What a recipe for a model in space may name.
pub fn solid() -> Registry<Solid> {
    let (warps, others) = (registry::solid(), registry::plane());
    let here: Vec<_> = warps.iter().map(|entry| entry.kind).collect();
    let all: Vec<_> = others.iter().map(|entry| entry.kind).collect();
    Registry {
        warps,
        field: field(),
        elsewhere: missing(&here, &all),
    }
}
