//! From a checked recipe to constructed warps.

use crate::check::parameters;
use crate::error::{Problem, RecipeError};
use crate::fit::fitted;
use crate::keys::Walk;
use crate::recipe::hash;
use crate::time::Share;
use crate::tree::{Part, join};
use crate::words::plain;
use crate::{Recipe, Registry};
use anamorph_catalog::schemars::SchemaGenerator;
use anamorph_catalog::{Built, ConstructError, Context, WarpEntry};
use anamorph_core::{
    Bounds, Deformation, Field, Mark, Masked, Modulated, Scaling, Scheduled, Space, Stack, Warp,
};
use serde_json::{Map, Value};
use std::sync::Arc;

/// One warp of a recipe, constructed.
pub struct BuiltPart<S: Space> {
    /// Number of its table in the recipe's list.
    pub index: usize,
    /// Its kind.
    pub kind: &'static str,
    /// The label the recipe gives it.
    pub label: Option<String>,
    /// The row of the inventory of systems it covers.
    pub system: &'static str,
    /// Tells tables of warps apart that differ otherwise than by their numbers.
    pub structure: u64,
    /// The warp, with the recipe's strength, weight and ambient weight but without its mask.
    pub warp: Arc<dyn Warp<S>>,
    /// Its mask, if it has one.
    pub mask: Option<Arc<dyn Field<S>>>,
    /// The warp with its mask: what moves points.
    pub deformation: Arc<dyn Deformation<S>>,
    /// Its features and guides, for pictures.
    pub marks: Vec<Mark<S>>,
}

impl<S: Space> BuiltPart<S> {
    /// The label, or else the kind.
    pub fn title(&self) -> &str {
        self.label.as_deref().unwrap_or(self.kind)
    }
}

/// The enabled warps of a recipe, constructed, in order.
pub struct BuiltRecipe<S: Space> {
    /// The warps; none is the identity.
    pub parts: Vec<BuiltPart<S>>,
}

impl<S: Space> BuiltRecipe<S> {
    /// All parts one after the other.
    pub fn stack(&self) -> Stack<S> {
        let part = |part: &BuiltPart<S>| -> Box<dyn Deformation<S>> {
            Box::new(Arc::clone(&part.deformation))
        };
        Stack::new(self.parts.iter().map(part).collect())
    }
}

/// Tells the bounds of the model after deformations, first applied first; `None` if no point is left with finite
/// coordinates.
pub type BoundsAfter<'a, S> = dyn FnMut(&[Arc<dyn Deformation<S>>]) -> Option<Bounds<S>> + 'a;

/// A field, if there is one.
type Held<S> = Option<Box<dyn Field<S>>>;

impl Recipe {
    /// Checks the recipe ([`Recipe::check_keys`]) and constructs its enabled warps in order.
    ///
    /// Percentages and `"fit"` refer to the model *as it arrives at the warp*. `context` describes the model before the
    /// first warp (its `scaling` is not read: the recipe's own holds); when a later warp needs bounds,
    /// `bounds_after(parts)` is called for those of the model after the given deformations. It is not called where
    /// `context` has no bounds, nor for a warp that can be constructed without.
    ///
    /// # Errors
    ///
    /// All problems that [`Recipe::check_keys`] finds, or the first that a plug-in finds, at the line of the parameter.
    pub fn build<S: Space>(
        &self,
        registry: &Registry<S>,
        context: &Context<'_, S>,
        bounds_after: &mut BoundsAfter<'_, S>,
    ) -> Result<BuiltRecipe<S>, RecipeError> {
        self.check_keys(registry)?;
        let fail = |problem| RecipeError::one(&self.source.name, problem);
        let mut parts: Vec<BuiltPart<S>> = Vec::new();
        let mut moved: Vec<Arc<dyn Deformation<S>>> = Vec::new();
        for (index, table) in self.warp_tables(&mut Vec::new()) {
            if table.get("enabled") == Some(&Value::Bool(false)) {
                continue;
            }
            let path = format!("warp.{index}");
            let entry = self.entry(&path, table, registry).map_err(fail)?;
            let mut here = Context {
                scaling: scaling(table),
                ..context.clone()
            };
            if !moved.is_empty() && here.bounds.is_some() {
                // A parameter left out may be relative by default: try without bounds to find out.
                let without = Context {
                    bounds: None,
                    ..here.clone()
                };
                if is_relative(table) || construct(entry, registry, table, &without).is_err() {
                    here.bounds = bounds_after(&moved);
                }
            }
            let (built, mask) = construct(entry, registry, table, &here)
                .map_err(|error| fail(self.located(&path, error, entry)))?;
            let warp: Arc<dyn Warp<S>> = Arc::from(built.warp);
            let share = self.share(table);
            let warp = match &share {
                Some(share) if !share.blend => scheduled(warp, share),
                _ => warp,
            };
            let mask: Option<Arc<dyn Field<S>>> = mask.map(Arc::from);
            let deformation: Arc<dyn Deformation<S>> = match &mask {
                Some(mask) => Arc::new(Masked::new(
                    Box::new(Arc::clone(&warp)),
                    Box::new(Arc::clone(mask)),
                )),
                None => Arc::clone(&warp) as Arc<dyn Deformation<S>>,
            };
            let deformation = match share {
                // The first way: one number blends the result.
                Some(share) if share.blend && share.common != 1.0 => {
                    Arc::new(Masked::new(Box::new(deformation), Box::new(share.common)))
                }
                _ => deformation,
            };
            moved.push(Arc::clone(&deformation));
            parts.push(BuiltPart {
                index,
                kind: entry.kind,
                label: table
                    .get("label")
                    .and_then(Value::as_str)
                    .map(str::to_owned),
                system: entry.system,
                structure: structure(table),
                warp,
                mask,
                deformation,
                marks: built.marks,
            });
        }
        Ok(BuiltRecipe { parts })
    }

    /// A plug-in's error at its place in the file, in plain words.
    pub(crate) fn located<S: Space>(
        &self,
        path: &str,
        error: ConstructError,
        entry: &WarpEntry<S>,
    ) -> Problem {
        let missing = error
            .message
            .strip_prefix("missing field `")
            .and_then(|rest| rest.strip_suffix('`'));
        let (message, mut hint) = plain(&error.message);
        if let (Some(key), true) = (missing, error.path.is_empty()) {
            // Say what it is that is missing.
            let mut generator = SchemaGenerator::default();
            let schema = Value::from((entry.schema)(&mut generator));
            let definitions = generator.take_definitions(true);
            let property = Walk::new(&definitions)
                .property(&schema, key)
                .and_then(|property| property.get("description")?.as_str());
            hint = hint.zip(property).map(|(hint, what)| {
                let what = what.split("\n\n").next().unwrap_or(what).replace('\n', " ");
                // In the middle of a sentence.
                let mut letters = what.trim_end_matches('.').chars();
                let first = letters.next().map(|first| first.to_lowercase().to_string());
                format!("{hint}: {}{}", first.unwrap_or_default(), letters.as_str())
            });
        }
        let hint = if error.hint.is_empty() {
            hint.unwrap_or_default()
        } else {
            error.hint
        };
        self.problem(&join(path, &error.path), Part::Value, message, hint)
    }
}

/// What a warp's table says, without its numbers, its label, when it is in force, and what is constant and no part of the fields.
fn structure(table: &Map<String, Value>) -> u64 {
    let mut table = table.clone();
    for key in ["label", "enabled", "schedule", "ambient"] {
        table.remove(key);
    }
    for key in ["strength", "mask"] {
        if table.get(key).is_some_and(Value::is_number) {
            table.remove(key);
        }
    }
    hash(&Value::Object(table), false)
}

fn scaling(table: &Map<String, Value>) -> Option<Scaling> {
    match table.get("scaling").and_then(Value::as_str) {
        Some("displacement") => Some(Scaling::Displacement),
        Some("composition") => Some(Scaling::Composition),
        _ => None,
    }
}

/// Whether a warp's table holds a value that is relative to the model.
fn is_relative(table: &Map<String, Value>) -> bool {
    fn relative(value: &Value) -> bool {
        match value {
            Value::String(text) => text.trim_end().ends_with('%') || text == "fit",
            Value::Array(list) => list.iter().any(relative),
            Value::Object(table) => table.values().any(relative),
            _ => false,
        }
    }
    table
        .iter()
        .any(|(key, value)| key != "label" && relative(value))
}

/// The warp of a table with its fields, and its mask. Paths of errors are relative to the table.
pub(crate) fn construct<S: Space>(
    entry: &WarpEntry<S>,
    registry: &Registry<S>,
    table: &Map<String, Value>,
    context: &Context<'_, S>,
) -> Result<(Built<S>, Held<S>), ConstructError> {
    let mut built = (entry.construct)(&Value::Object(parameters(table)), context)?;
    let field = |key: &str, fits: fn(f64) -> bool, range: &str| {
        let Some(expression) = table.get(key) else {
            return Ok(None);
        };
        let field = (registry.field.construct)(expression, context).map_err(|e| e.under(key))?;
        match field.constant().filter(|&value| !fits(value)) {
            Some(value) => Err(ConstructError::new(
                key,
                format!("the {key} is {value} everywhere, and must be {range}"),
            )),
            None => Ok(Some(field)),
        }
    };
    let mut finish = |warp: Box<dyn Warp<S>>| -> Result<Box<dyn Warp<S>>, ConstructError> {
        let strength = field("strength", f64::is_finite, "finite")?;
        let weight = field("weight", |w| w >= 0.0 && w.is_finite(), "0 or more")?;
        Ok(modulated(warp, strength, weight, table))
    };
    match table.get("fit") {
        Some(pins) => built = fitted(pins, entry.kind, built, context, &mut finish)?,
        None => built.warp = finish(built.warp)?,
    }
    let mask = field("mask", |m| (0.0..=1.0).contains(&m), "from 0 to 1")?;
    Ok((built, mask))
}

fn modulated<S: Space>(
    warp: Box<dyn Warp<S>>,
    strength: Held<S>,
    weight: Held<S>,
    table: &Map<String, Value>,
) -> Box<dyn Warp<S>> {
    let ambient = table.get("ambient").and_then(Value::as_f64);
    if strength.is_none() && weight.is_none() && ambient.is_none() {
        return warp;
    }
    let mut modulated = Modulated::new(warp);
    if let Some(field) = strength {
        modulated = modulated.with_strength(field);
    }
    if let Some(field) = weight {
        modulated = modulated.with_weight(field);
    }
    if let Some(ambient) = ambient {
        modulated = modulated.with_ambient(ambient);
    }
    Box::new(modulated)
}

/// The warp with its strengths multiplied by how much of it is in force: ways 2 and 3 of §8.1, which coincide.
fn scheduled<S: Space>(warp: Arc<dyn Warp<S>>, share: &Share) -> Arc<dyn Warp<S>> {
    if share.features.iter().all(|f| *f == share.common) {
        return match share.common {
            1.0 => warp,
            factor => Arc::new(Modulated::new(Box::new(warp)).with_strength(Box::new(factor))),
        };
    }
    Arc::new(Scheduled::new(warp, share.features.clone(), share.common))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn relative_values_are_found_anywhere() {
        let table = |value: Value| value.as_object().cloned().unwrap();
        assert!(is_relative(&table(json!({ "a": [{ "b": "50%" }] }))));
        assert!(is_relative(&table(json!({ "box": "fit" }))));
        assert!(!is_relative(&table(
            json!({ "label": "50%", "a": "45deg", "b": [1, "y"] })
        )));
    }
}
