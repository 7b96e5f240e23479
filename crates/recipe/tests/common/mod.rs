//! A small registry to read recipes with: parameters nested as deep as real plug-ins nest them.

// Each test file uses its own part of this.
#![allow(dead_code)]

use anamorph_catalog::schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use anamorph_catalog::{
    Angle, Built, ConstructError, Context, Length, Offset, Place, Value, WarpEntry, parse,
};
use anamorph_core::{
    Affine, Bounds, Deformation, Field, Mark, Plane, Role, Shape, Site, Smoothness, Solid, Space,
    Support, Term, Terms,
};
use anamorph_recipe::{BuiltRecipe, FieldExpression, Recipe, RecipeError, Registry};
use serde::Deserialize;
use std::sync::Arc;

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Shift {
    /// How far all points move.
    offset: Offset,
    /// A turn about the origin after the move.
    #[serde(default)]
    angle: Option<Angle>,
    /// Single moves on top.
    #[serde(default, rename = "move")]
    moves: Vec<Move>,
    #[serde(default)]
    profile: Vec<[f64; 2]>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Move {
    /// Which feature.
    index: u32,
    by: Offset,
    #[serde(default)]
    blend: Option<Blend>,
}

#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum Blend {
    Clamp,
    Smooth,
}

fn shift<S: Space>(value: &Value, context: &Context<'_, S>) -> Result<Built<S>, ConstructError> {
    let parameters: Shift = parse(value)?;
    let mut offset = parameters.offset.resolve("offset", context)?;
    for (i, one) in parameters.moves.iter().enumerate() {
        if one.index > 9 {
            let message = format!("there is no feature {}", one.index);
            return Err(ConstructError::new(format!("move.{i}.index"), message)
                .with_hint("the features are 0 to 9"));
        }
        let by = one.by.resolve(&format!("move.{i}.by"), context)?;
        offset += match one.blend {
            Some(Blend::Smooth) => by * 0.5,
            _ => by,
        };
    }
    let angle = parameters.angle.map_or(0.0, Angle::radians);
    let turn = Affine::new(S::rotation(S::unit(S::DIM - 1), angle), S::ZERO);
    let map = turn.after(&Affine::translation(offset));
    Ok(Built::new(
        vec![Mark::new(Role::Source, Shape::Arrow(S::ZERO, offset))],
        Box::new(Terms::new(vec![Term::new(map, 1.0, 1.0)])),
    ))
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Grow {
    factor: f64,
    /// The point that stays; the middle of the model if left out.
    #[serde(default)]
    centre: Option<Place>,
}

fn grow<S: Space>(value: &Value, context: &Context<'_, S>) -> Result<Built<S>, ConstructError> {
    let parameters: Grow = parse(value)?;
    let centre = match &parameters.centre {
        Some(place) => place.resolve("centre", context)?,
        None => context.bounds("centre")?.centre(),
    };
    let scale = |x: S| x * parameters.factor;
    let linear = <S::Linear as anamorph_core::Linear<S>>::from_columns(|i| scale(S::unit(i)));
    let map = Affine::new(linear, centre - scale(centre));
    Ok(Built::new(
        Vec::new(),
        Box::new(Terms::new(vec![Term::new(map, 1.0, 1.0)])),
    ))
}

/// Two ways to write one warp: a schema that is no plain table.
#[derive(Deserialize, JsonSchema)]
#[serde(tag = "by", deny_unknown_fields, rename_all = "kebab-case")]
enum Turn {
    Angle { angle: Angle },
    Slope { rise: f64, run: f64 },
}

fn turn<S: Space>(value: &Value, _: &Context<'_, S>) -> Result<Built<S>, ConstructError> {
    let angle = match parse(value)? {
        Turn::Angle { angle } => angle.radians(),
        Turn::Slope { rise, run } => anamorph_core::math::atan2(rise, run),
    };
    let map = Affine::new(S::rotation(S::unit(S::DIM - 1), angle), S::ZERO);
    Ok(Built::new(
        Vec::new(),
        Box::new(Terms::new(vec![Term::new(map, 1.0, 1.0)])),
    ))
}

struct Radial<S> {
    centre: S,
    radius: f64,
}

impl<S: Space> Field<S> for Radial<S> {
    fn value(&self, site: &Site<S>) -> f64 {
        (1.0 - site.point.distance(self.centre) / self.radius).max(0.0)
    }
    fn support(&self) -> Support<S> {
        Support::Ball {
            centre: self.centre,
            radius: self.radius,
        }
    }
    fn smoothness(&self) -> Smoothness {
        Smoothness::C(0)
    }
}

struct Product<S: Space>(Vec<Box<dyn Field<S>>>);

impl<S: Space> Field<S> for Product<S> {
    fn value(&self, site: &Site<S>) -> f64 {
        self.0.iter().map(|field| field.value(site)).product()
    }
    fn support(&self) -> Support<S> {
        Support::Everywhere
    }
    fn smoothness(&self) -> Smoothness {
        Smoothness::C(0)
    }
}

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(dead_code)]
struct RadialParameters {
    field: String,
    centre: Place,
    radius: Length,
}

fn field<S: Space>(
    value: &Value,
    context: &Context<'_, S>,
) -> Result<Box<dyn Field<S>>, ConstructError> {
    if let Some(number) = value.as_f64() {
        return Ok(Box::new(number));
    }
    match value.get("field").and_then(Value::as_str) {
        Some("radial") => {
            let parameters: RadialParameters = parse(value)?;
            Ok(Box::new(Radial {
                centre: parameters.centre.resolve("centre", context)?,
                radius: parameters.radius.resolve_positive("radius", context)?,
            }))
        }
        Some("product") => {
            let list = value.get("of").and_then(Value::as_array);
            let list = list.ok_or_else(|| ConstructError::new("", "missing field `of`"))?;
            let factors = list.iter().enumerate();
            let factors =
                factors.map(|(i, v)| field(v, context).map_err(|e| e.under(&format!("of.{i}"))));
            Ok(Box::new(Product(factors.collect::<Result<_, _>>()?)))
        }
        _ => Err(ConstructError::new(
            "",
            "a field is a number or a table with the key `field`",
        )),
    }
}

fn field_schema(generator: &mut SchemaGenerator) -> Schema {
    let mut radial = generator.subschema_for::<RadialParameters>();
    let definitions = generator.definitions_mut();
    if let Some(table) = definitions.get_mut("RadialParameters") {
        table["properties"]["field"] = serde_json::json!({ "const": "radial" });
    }
    radial.insert("title".into(), "radial".into());
    definitions.insert(
        "Field".into(),
        serde_json::json!({ "anyOf": [
            { "type": "number" },
            radial,
            {
                "type": "object",
                "properties": {
                    "field": { "const": "product" },
                    "of": { "type": "array", "items": { "$ref": "#/$defs/Field" } },
                },
                "required": ["field", "of"],
                "additionalProperties": false,
            },
        ] }),
    );
    json_schema!({ "$ref": "#/$defs/Field" })
}

macro_rules! entry {
    ($kind:literal, $parameters:ty, $construct:ident, $example:literal) => {
        WarpEntry {
            kind: $kind,
            system: "T1",
            figure: "",
            summary: "Moves points.",
            reference: "No one, Nowhere, 1900",
            example: $example,
            schema: |generator| generator.subschema_for::<$parameters>(),
            construct: $construct,
        }
    };
}

pub(crate) fn registry<S: Space>() -> Registry<S> {
    let offset = "offset = \"10%\"\nangle = \"90deg\"\nmove = [{ index = 1, by = \"1%\", blend = \"smooth\" }]\n";
    let mut warps = vec![
        WarpEntry {
            example: offset,
            ..entry!("shift", Shift, shift, "")
        },
        entry!("grow", Grow, grow, "factor = 2\ncentre = \"50%\""),
    ];
    let elsewhere = if S::DIM == 2 {
        warps.push(entry!(
            "whirl",
            Turn,
            turn,
            "by = \"angle\"\nangle = \"1rad\""
        ));
        vec!["screw"]
    } else {
        warps.push(entry!(
            "screw",
            Turn,
            turn,
            "by = \"slope\"\nrise = 1\nrun = 2.5"
        ));
        vec!["whirl"]
    };
    Registry {
        warps,
        field: FieldExpression {
            construct: field,
            schema: field_schema,
        },
        elsewhere,
    }
}

/// A box that is no cube and not about the origin.
pub(crate) fn bounds() -> Bounds<Solid> {
    Bounds::new(Solid::ZERO, anamorph_core::glam::dvec3(10.0, 20.0, 40.0))
}

/// Builds for a model in space whose points are the corners of [`bounds`].
pub(crate) fn build(recipe: &Recipe) -> Result<BuiltRecipe<Solid>, RecipeError> {
    let mut after = |parts: &[Arc<dyn Deformation<Solid>>]| {
        let moved = [bounds().min, bounds().max].map(|corner| {
            parts
                .iter()
                .fold(corner, |p, part| part.map(&Site::anywhere(p)))
        });
        Bounds::of(&moved)
    };
    recipe.build(&registry(), &Context::of_bounds(bounds()), &mut after)
}

/// Reads, sets and builds.
pub(crate) fn run(
    bytes: &[u8],
    name: &str,
    settings: &[&str],
) -> Result<BuiltRecipe<Solid>, RecipeError> {
    let mut recipe = Recipe::read(bytes, name)?;
    for setting in settings {
        recipe.set(setting)?;
    }
    build(&recipe)
}

/// Keeps the plane's registry in use where only space is tested.
pub(crate) fn plane() -> Registry<Plane> {
    registry()
}
