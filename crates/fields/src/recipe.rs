//! How recipes describe fields: a number, or a table `{ field = "…", … }`.
//!
//! A *field expression* is what the keys `strength`, `weight` and `mask` of a recipe hold. Every field is an [`Entry`] of
//! the catalogue of [`entries`]; products and complements hold further expressions.
//!
//! *Source*: Milliron et al. 2002, §3.2 (strength and weighting fields); the notation is a decision.

use crate::{
    Attribute, AxisProfile, AxisRamp, BoxField, Complement, Ends, FALLOFFS, Falloff, HalfSpace,
    Product, Profile, Radial, falloff,
};
use anamorph_catalog::schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use anamorph_catalog::serde_json::{Map, json};
use anamorph_catalog::{
    Along, Axis, ConstructError, Context, Entry, FieldEntry, Length, Place, Value, parse, schemars,
};
use anamorph_core::{Bounds, Field, Space};
use serde::Deserialize;
use std::borrow::Cow;

/// A falloff by name; `"wires"` by default.
#[derive(Debug, Clone, Copy)]
pub struct FalloffName(&'static dyn Falloff);

impl FalloffName {
    /// The falloff.
    pub fn get(self) -> &'static dyn Falloff {
        self.0
    }
}

impl Default for FalloffName {
    fn default() -> Self {
        Self(&crate::falloffs::Wires)
    }
}

impl<'de> Deserialize<'de> for FalloffName {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        falloff(&name).map(Self).ok_or_else(|| {
            let known: Vec<&str> = FALLOFFS.iter().copied().map(Falloff::name).collect();
            serde::de::Error::custom(format!(
                "no falloff is called `{name}` | the falloffs are {}",
                known.join(", ")
            ))
        })
    }
}

impl JsonSchema for FalloffName {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Falloff".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let names: Vec<&str> = FALLOFFS.iter().copied().map(Falloff::name).collect();
        json_schema!({ "description": "how it falls off, \"wires\" if left out", "type": "string", "enum": names })
    }
}

/// A field expression as a parameter: kept as written until the model is known.
#[derive(Debug, Clone, Deserialize)]
#[serde(transparent)]
pub struct FieldParameter(Value);

impl FieldParameter {
    /// Builds the field; `path` names the parameter in errors.
    ///
    /// # Errors
    /// [`ConstructError`] with the path of what is wrong inside the expression.
    pub fn resolve<S: Space>(
        &self,
        path: &str,
        context: &Context<'_, S>,
    ) -> Result<Box<dyn Field<S>>, ConstructError> {
        construct(&self.0, context).map_err(|error| error.under(path))
    }
}

impl JsonSchema for FieldParameter {
    fn schema_name() -> Cow<'static, str> {
        "Field".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut ways =
            vec![json!({ "type": "number", "description": "the same value everywhere" })];
        for entry in entries::<anamorph_core::Solid>() {
            let mut table = (entry.schema)(generator).to_value();
            if let Some(table) = table.as_object_mut() {
                table.remove("$schema");
                table.insert("description".to_owned(), json!(entry.summary));
                let properties = table.entry("properties").or_insert_with(|| json!({}));
                if let Some(properties) = properties.as_object_mut() {
                    properties.insert("field".to_owned(), json!({ "const": entry.kind }));
                }
                let required = table.entry("required").or_insert_with(|| json!([]));
                if let Some(required) = required.as_array_mut() {
                    required.insert(0, json!("field"));
                }
            }
            ways.push(table);
        }
        json_schema!({ "description": "a number or a field of space or of the model", "anyOf": ways })
    }
}

/// The schema of a field expression.
pub fn schema(generator: &mut SchemaGenerator) -> Schema {
    generator.subschema_for::<FieldParameter>()
}

/// Builds a field from an expression.
///
/// # Errors
/// [`ConstructError`] for an unknown field, or parameters that its construction refuses.
pub fn construct<S: Space>(
    value: &Value,
    context: &Context<'_, S>,
) -> Result<Box<dyn Field<S>>, ConstructError> {
    if let Some(number) = value.as_f64() {
        return Ok(Box::new(number));
    }
    let Some(table) = value.as_object() else {
        return Err(
            ConstructError::new("", "a field is a number or a table").with_hint(
                "write, for example, `{ field = \"radial\", centre = \"50%\", radius = \"30%\" }`",
            ),
        );
    };
    let all = entries::<S>();
    let known = || {
        let kinds: Vec<&str> = all.iter().map(|entry| entry.kind).collect();
        format!("the fields are {}", kinds.join(", "))
    };
    let Some(kind) = table.get("field").and_then(Value::as_str) else {
        return Err(ConstructError::new("", "the field has no name")
            .with_hint(format!("write `field = \"…\"`; {}", known())));
    };
    let Some(entry) = all.iter().find(|entry| entry.kind == kind) else {
        return Err(
            ConstructError::new("field", format!("no field is called `{kind}`")).with_hint(known()),
        );
    };
    let rest: Map<String, Value> = table
        .iter()
        .filter(|(key, _)| *key != "field")
        .map(|(key, value)| (key.clone(), value.clone()))
        .collect();
    (entry.construct)(&Value::Object(rest), context)
}

/// Every field that a recipe can name.
pub fn entries<S: Space>() -> Vec<FieldEntry<S>> {
    vec![
        radial(),
        boxed(),
        half_space(),
        axis(),
        attribute(),
        product(),
        complement(),
    ]
}

const FRAMEWORK: &str = "Milliron, Jensen, Barzel and Finkelstein, A Framework for Geometric Warps and Deformations, ACM TOG 21(1), 2002, §3.2";

fn refused(error: impl core::fmt::Display) -> ConstructError {
    ConstructError::new("", error.to_string())
}

/// A falloff that ends, for fields that must.
fn compact(name: Option<FalloffName>) -> Result<&'static dyn Falloff, ConstructError> {
    let falloff = name.unwrap_or_default().get();
    if falloff.compact() {
        return Ok(falloff);
    }
    Err(
        ConstructError::new("falloff", format!("`{}` does not end", falloff.name()))
            .with_hint("take one that does, such as \"wires\""),
    )
}

/// Falls from 1 at a centre to 0 at a radius.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct RadialParameters {
    /// The centre.
    centre: Place,
    /// Distance at which the field has fallen to 0.
    radius: Length,
    /// How it falls off.
    falloff: Option<FalloffName>,
}

fn radial<S: Space>() -> FieldEntry<S> {
    Entry {
        kind: "radial",
        system: "",
        figure: "",
        summary: "falls from 1 at a centre to 0 at a radius",
        reference: FRAMEWORK,
        example: "centre = \"50%\"\nradius = \"30%\"\n",
        schema: RadialParameters::json_schema,
        construct: |value, context| {
            let p: RadialParameters = parse(value)?;
            let centre: S = p.centre.resolve("centre", context)?;
            let radius = p.radius.resolve_positive("radius", context)?;
            let name = p.falloff.unwrap_or_default().get();
            let falloff = compact(p.falloff)?;
            // The default gets code of its own: no virtual call a point.
            if name.name() == "wires" {
                return Ok(Box::new(
                    Radial::new(centre, radius, crate::falloffs::Wires).map_err(refused)?,
                ));
            }
            Ok(Box::new(
                Radial::new(centre, radius, falloff).map_err(refused)?,
            ))
        },
    }
}

/// Is 1 inside a box and falls to 0 over a margin around it.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct BoxParameters {
    /// One corner of the box.
    min: Place,
    /// The opposite corner.
    max: Place,
    /// Width of the margin in which the field falls to 0.
    margin: Length,
    /// How it falls off.
    falloff: Option<FalloffName>,
}

fn boxed<S: Space>() -> FieldEntry<S> {
    Entry {
        kind: "box",
        system: "",
        figure: "",
        summary: "1 inside an axis-parallel box, falling to 0 over a margin around it",
        reference: FRAMEWORK,
        example: "min = \"25%\"\nmax = \"75%\"\nmargin = \"10%\"\n",
        schema: BoxParameters::json_schema,
        construct: |value, context| {
            let p: BoxParameters = parse(value)?;
            let bounds = Bounds::new(
                p.min.resolve::<S>("min", context)?,
                p.max.resolve("max", context)?,
            );
            let margin = p.margin.resolve_positive("margin", context)?;
            Ok(Box::new(
                BoxField::new(bounds, margin, compact(p.falloff)?).map_err(refused)?,
            ))
        },
    }
}

/// Is 1 on one side of a plane (line) and falls to 0 over a width on the other.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct HalfSpaceParameters {
    /// A point of the plane.
    point: Place,
    /// Direction of the side on which the field is 1.
    normal: Axis,
    /// Width over which it falls to 0 on the other side.
    width: Length,
    /// How it falls off.
    falloff: Option<FalloffName>,
}

fn half_space<S: Space>() -> FieldEntry<S> {
    Entry {
        kind: "half-space",
        system: "",
        figure: "",
        summary: "1 on one side of a plane, falling to 0 over a width on the other",
        reference: FRAMEWORK,
        example: "point = \"50%\"\nnormal = \"y\"\nwidth = \"20%\"\n",
        schema: HalfSpaceParameters::json_schema,
        construct: |value, context| {
            let p: HalfSpaceParameters = parse(value)?;
            let point: S = p.point.resolve("point", context)?;
            let normal = p.normal.resolve("normal")?;
            let width = p.width.resolve_positive("width", context)?;
            Ok(Box::new(
                HalfSpace::new(point, normal, width, compact(p.falloff)?).map_err(refused)?,
            ))
        },
    }
}

/// Varies along an axis: a ramp from 0 to 1, or a curve drawn by points.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AxisParameters {
    /// Direction along which the field varies.
    axis: Axis,
    /// Point from which coordinates along the axis count; the middle of the model if left out.
    origin: Option<Place>,
    /// Where the ramp (or the curve's 0) begins and ends; the whole model if left out.
    range: Option<[Along; 2]>,
    /// How a ramp rises.
    falloff: Option<FalloffName>,
    /// A curve instead of a ramp: points [share of the range, value], smooth through them.
    #[schemars(length(min = 1))]
    profile: Option<Vec<[f64; 2]>>,
}

fn axis<S: Space>() -> FieldEntry<S> {
    Entry {
        kind: "axis",
        system: "",
        figure: "",
        summary: "rises from 0 to 1 along an axis, or follows a curve drawn by points",
        reference: FRAMEWORK,
        example: "axis = \"y\"\nrange = [\"20%\", \"80%\"]\n",
        schema: AxisParameters::json_schema,
        construct: |value, context| {
            let p: AxisParameters = parse(value)?;
            let direction: S = p.axis.resolve("axis")?;
            let origin = match &p.origin {
                Some(place) => place.resolve("origin", context)?,
                None => context.bounds("origin")?.centre(),
            };
            let whole = [0.0, 1.0].map(|f| Along(anamorph_catalog::Coordinate::Relative(f)));
            let [from, to] = p.range.unwrap_or(whole);
            let from = from.resolve("range.0", origin, direction, context)?;
            let to = to.resolve("range.1", origin, direction, context)?;
            let Some(points) = &p.profile else {
                return Ok(Box::new(
                    AxisRamp::new(origin, direction, from, to, compact(p.falloff)?)
                        .map_err(refused)?,
                ));
            };
            if p.falloff.is_some() {
                return Err(
                    ConstructError::new("falloff", "a drawn curve needs no falloff")
                        .with_hint("remove it"),
                );
            }
            if from >= to {
                return Err(ConstructError::new(
                    "range",
                    format!("the range runs from {from} to {to}"),
                )
                .with_hint("write the smaller coordinate first"));
            }
            let placed: Vec<[f64; 2]> = points
                .iter()
                .map(|[x, y]| [from + (to - from) * x, *y])
                .collect();
            let profile = Profile::through_with_ends(&placed, Ends::Constant)
                .map_err(|error| ConstructError::new("profile", error.to_string()))?;
            Ok(Box::new(
                AxisProfile::new(origin, direction, profile).map_err(refused)?,
            ))
        },
    }
}

/// Reads a per-vertex attribute of the model.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AttributeParameters {
    /// Name of the attribute.
    name: String,
}

fn attribute<S: Space>() -> FieldEntry<S> {
    Entry {
        kind: "attribute",
        system: "",
        figure: "",
        summary: "a per-vertex attribute of the model; it has no derivative in space",
        reference: FRAMEWORK,
        example: "name = \"weight\"\n",
        schema: AttributeParameters::json_schema,
        construct: |value, context| {
            let p: AttributeParameters = parse(value)?;
            let Some(attributes) = context.attributes else {
                return Err(ConstructError::new(
                    "name",
                    "an attribute needs a model, and none was given",
                ));
            };
            let Some(values) = attributes.attribute(&p.name) else {
                let names = attributes.names();
                let hint = if names.is_empty() {
                    "the model has no attributes".to_owned()
                } else {
                    format!("the model has {}", names.join(", "))
                };
                let message = format!("the model has no attribute `{}`", p.name);
                return Err(ConstructError::new("name", message).with_hint(hint));
            };
            Ok(Box::new(Attribute::new(p.name, values).map_err(refused)?))
        },
    }
}

/// Multiplies fields.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ProductParameters {
    /// The factors.
    #[schemars(length(min = 1))]
    of: Vec<FieldParameter>,
}

fn product<S: Space>() -> FieldEntry<S> {
    Entry {
        kind: "product",
        system: "",
        figure: "",
        summary: "the product of fields",
        reference: FRAMEWORK,
        example: "of = [0.5, { field = \"axis\", axis = \"y\" }]\n",
        schema: ProductParameters::json_schema,
        construct: |value, context| {
            let p: ProductParameters = parse(value)?;
            let factors =
                p.of.iter()
                    .enumerate()
                    .map(|(i, factor)| factor.resolve(&format!("of.{i}"), context));
            Ok(Box::new(Product::new(factors.collect::<Result<_, _>>()?)))
        },
    }
}

/// One minus a field.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ComplementParameters {
    /// The field.
    of: FieldParameter,
}

fn complement<S: Space>() -> FieldEntry<S> {
    Entry {
        kind: "complement",
        system: "",
        figure: "",
        summary: "one minus a field",
        reference: FRAMEWORK,
        example: "of = { field = \"radial\", centre = \"50%\", radius = \"30%\" }\n",
        schema: ComplementParameters::json_schema,
        construct: |value, context| {
            let p: ComplementParameters = parse(value)?;
            Ok(Box::new(Complement::new(p.of.resolve("of", context)?)))
        },
    }
}
