//! The registries of this command: all warps and fields of both spaces.

use anamorph_core::{Plane, Solid, Space};
use anamorph_recipe::{FieldExpression, Registry};
use anamorph_warps::registry;

fn fields<S: Space>() -> FieldExpression<S> {
    FieldExpression {
        construct: anamorph_fields::recipe::construct,
        schema: anamorph_fields::recipe::schema,
    }
}

/// Kinds of `all` that `here` lacks.
fn missing(here: &[&'static str], all: &[&'static str]) -> Vec<&'static str> {
    all.iter()
        .copied()
        .filter(|kind| !here.contains(kind))
        .collect()
}

/// What a recipe for a model in the plane may name.
pub(crate) fn plane() -> Registry<Plane> {
    let warps = registry::plane();
    let kinds: Vec<_> = warps.iter().map(|entry| entry.kind).collect();
    let all: Vec<_> = registry::solid().iter().map(|entry| entry.kind).collect();
    Registry {
        warps,
        field: fields(),
        elsewhere: missing(&kinds, &all),
    }
}

/// What a recipe for a model in space may name.
pub(crate) fn solid() -> Registry<Solid> {
    let warps = registry::solid();
    let kinds: Vec<_> = warps.iter().map(|entry| entry.kind).collect();
    let all: Vec<_> = registry::plane().iter().map(|entry| entry.kind).collect();
    Registry {
        warps,
        field: fields(),
        elsewhere: missing(&kinds, &all),
    }
}
