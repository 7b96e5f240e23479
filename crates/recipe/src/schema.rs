//! The JSON Schema of recipes, for editors.
//!
//! Each kind of warp is one table whose `kind` is a constant, with the keys of every warp and the plug-in's own merged
//! into it, so that editors complete them and mark what is unknown.

use crate::Registry;
use crate::check::{MAPPINGS, SCALING, SPACES};
use crate::fit::FitParameters;
use crate::morph::{PATHS, grid_schema};
use crate::time::WAYS;
use anamorph_catalog::schemars::generate::SchemaSettings;
use anamorph_catalog::schemars::{JsonSchema, SchemaGenerator};
use anamorph_core::{Plane, Solid, Space};
use serde_json::{Map, Value, json};

/// Keywords of a schema that is a plain table: only these can be merged with the common keys key by key.
const PLAIN: [&str; 7] = [
    "type",
    "title",
    "description",
    "properties",
    "required",
    "additionalProperties",
    "$schema",
];

/// The JSON Schema (draft 2020-12) of recipes that name the warps of both registries.
pub fn schema(plane: &Registry<Plane>, solid: &Registry<Solid>) -> Value {
    let mut generator = SchemaSettings::draft2020_12().into_generator();
    let mut fields = vec![Value::from((plane.field.schema)(&mut generator))];
    add(
        &mut fields,
        Value::from((solid.field.schema)(&mut generator)),
    );

    // In the order of the registries, the plane's own kinds last; a kind of both spaces is listed once.
    let mut kinds: Vec<(Description, Vec<Value>)> = Vec::new();
    describe(solid, &mut generator, &mut kinds);
    describe(plane, &mut generator, &mut kinds);

    let fit = Value::from(FitParameters::json_schema(&mut generator));
    let grid = grid_schema(&mut generator);
    let mut definitions = generator.take_definitions(true);
    let field = unused(&definitions, "field-expression");
    definitions.insert(field.clone(), either(fields));
    let common = common(&format!("#/$defs/{field}"), fit);
    let mut list = Vec::new();
    for (description, parameters) in kinds {
        let tables = parameters
            .into_iter()
            .map(|parameters| warp(&description, parameters, &common, &definitions))
            .collect();
        let name = unused(&definitions, &format!("warp-{}", description.kind));
        definitions.insert(name.clone(), either(tables));
        list.push(json!({ "$ref": format!("#/$defs/{name}") }));
    }
    // A schema of alternatives needs one; without any warp, no table fits.
    let item = if list.is_empty() {
        Value::Bool(false)
    } else {
        json!({ "oneOf": list })
    };
    let motion = crate::motion::schema::motion(&mut definitions);
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "anamorph recipe",
        "description": "A stack of warps that are applied to a model one after the other, or a motion along a path.",
        "type": "object",
        "properties": {
            "$schema": { "description": "where this schema is; editors read it", "type": "string" },
            "version": { "description": "version of the recipe format", "const": 1 },
            "name": { "description": "what the recipe is called", "type": "string" },
            "description": { "description": "what the recipe does", "type": "string" },
            "space": {
                "description": "whose coordinates the recipe is in: those of the world, where the scene of a glTF places each mesh, or each mesh's own",
                "enum": SPACES,
                "default": SPACES[0],
            },
            "mapping": {
                "description": "the warps as they are, or what undoes them",
                "enum": MAPPINGS,
                "default": MAPPINGS[0],
            },
            "time": {
                "description": "how warps without a schedule of their own come in over time",
                "type": "object",
                "properties": {
                    "way": {
                        "description": "what grows: the blend of the result, each transformation, or each strength (the last two coincide)",
                        "enum": WAYS,
                        "default": WAYS[2],
                    },
                    "ease": ease_schema(),
                    "dissolve": {
                        "description": "in a morph of images, when colours go over: an ease, or a schedule; with the shape if left out",
                        "anyOf": [
                            ease_schema(),
                            {
                                "type": "object",
                                "properties": {
                                    "start": { "type": "number", "minimum": 0, "maximum": 1, "default": 0 },
                                    "end": { "type": "number", "minimum": 0, "maximum": 1, "default": 1 },
                                    "ease": ease_schema(),
                                },
                                "additionalProperties": false,
                            },
                        ],
                    },
                    "path": {
                        "description": "in a morph of images, how lines and other features of several places go from source to target: each place straight, or the feature turning about its middle",
                        "enum": PATHS,
                        "default": PATHS[0],
                    },
                },
                "additionalProperties": false,
            },
            "track": {
                "description": "values of the recipe over time",
                "type": "array",
                "items": {
                    "type": "object",
                    "properties": {
                        "set": { "description": "which value, such as warp.0.angle", "type": "string" },
                        "keys": {
                            "description": "times from 0 to 1 in ascending order, each with a value",
                            "type": "array",
                            "items": { "type": "array", "minItems": 2, "maxItems": 2 },
                            "minItems": 1,
                        },
                        "ease": ease_schema(),
                    },
                    "required": ["set", "keys"],
                    "additionalProperties": false,
                },
            },
            "warp": {
                "description": "the warps, first applied first; none leaves the model as it is",
                "type": "array",
                "items": item,
            },
            "grid": grid,
            "motion": motion,
        },
        "required": ["version"],
        "not": { "required": ["warp", "motion"] },
        "additionalProperties": false,
        "$defs": definitions,
    })
}

fn ease_schema() -> Value {
    json!({ "description": "an ease, such as \"cubic\" or \"cubic-bezier(0.4, 0, 0.2, 1)\"; even if left out", "type": "string" })
}

/// The schema of a schedule; of a whole warp's it has a list for single features.
fn schedule(whole: bool) -> Value {
    let time = |description: &str| json!({ "description": description, "type": "number", "minimum": 0, "maximum": 1 });
    let mut properties = Map::new();
    properties.insert(
        "start".to_owned(),
        time("when strengths begin to rise from 0"),
    );
    properties.insert("end".to_owned(), time("when they reach 1"));
    properties.insert("ease".to_owned(), ease_schema());
    if whole {
        properties.insert(
            "features".to_owned(),
            json!({ "description": "schedules of single features, in their order", "type": "array", "items": schedule(false) }),
        );
    }
    json!({
        "description": "when the warp comes in, as time goes from 0 to 1",
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
    })
}

/// How a kind is described.
struct Description {
    kind: &'static str,
    text: String,
}

fn describe<S: Space>(
    registry: &Registry<S>,
    generator: &mut SchemaGenerator,
    kinds: &mut Vec<(Description, Vec<Value>)>,
) {
    for entry in &registry.warps {
        let parameters = Value::from((entry.schema)(generator));
        match kinds.iter_mut().find(|(known, _)| known.kind == entry.kind) {
            Some((_, list)) => add(list, parameters),
            None => {
                let description = Description {
                    kind: entry.kind,
                    text: format!("{}\n\n{}", entry.summary, entry.reference),
                };
                kinds.push((description, vec![parameters]));
            }
        }
    }
}

fn add(list: &mut Vec<Value>, schema: Value) {
    if !list.contains(&schema) {
        list.push(schema);
    }
}

fn either(mut schemas: Vec<Value>) -> Value {
    if schemas.len() == 1 {
        schemas.remove(0)
    } else {
        json!({ "anyOf": schemas })
    }
}

/// A name that no definition has yet.
fn unused(definitions: &Map<String, Value>, name: &str) -> String {
    let mut candidate = name.to_owned();
    let mut number = 2;
    while definitions.contains_key(&candidate) {
        candidate = format!("{name}-{number}");
        number += 1;
    }
    candidate
}

/// Schemas of the keys of every warp.
fn common(field: &str, fit: Value) -> Map<String, Value> {
    let field = |description: &str| json!({ "description": description, "$ref": field });
    let mut map = Map::new();
    let mut put = |key: &str, schema| map.insert(key.to_owned(), schema);
    put(
        "label",
        json!({ "description": "what reports call this warp", "type": "string" }),
    );
    put(
        "enabled",
        json!({ "description": "false leaves the warp out", "type": "boolean", "default": true }),
    );
    put(
        "strength",
        field("a number or field that multiplies the strength of every term"),
    );
    put(
        "weight",
        field("a number or field, not negative, that multiplies the weight of every term"),
    );
    put(
        "mask",
        field(
            "a number or field from 0 to 1 that blends the warped model with the model as it was",
        ),
    );
    put(
        "ambient",
        json!({
            "description": "weight of an identity term: continuous where the warp's support ends, at the price of exactness",
            "type": "number",
            "exclusiveMinimum": 0,
        }),
    );
    put(
        "scaling",
        json!({
            "description": "how transformations are scaled by a strength: their displacements, or their angles, shifts and \
                            stretches",
            "enum": SCALING,
        }),
    );
    put("schedule", schedule(true));
    put("fit", fit);
    map
}

/// The schema of a kind's table: its parameters, the common keys and `kind`.
fn warp(
    description: &Description,
    parameters: Value,
    common: &Map<String, Value>,
    definitions: &Map<String, Value>,
) -> Value {
    let kind = json!({ "const": description.kind });
    let parameters = resolved(parameters, definitions);
    let is_plain = parameters.as_object().is_some_and(|object| {
        object.keys().all(|key| PLAIN.contains(&key.as_str()))
            && !object
                .get("additionalProperties")
                .is_some_and(Value::is_object)
    });
    let own = |key: &str| parameters.get(key).cloned();
    let mut properties = Map::new();
    let mut required = vec![Value::from("kind")];
    if is_plain {
        if let Some(Value::Object(map)) = own("properties") {
            properties.extend(map);
        }
        if let Some(Value::Array(list)) = own("required") {
            required.extend(list);
        }
    }
    properties.extend(common.clone());
    properties.insert("kind".to_owned(), kind);
    let mut table = json!({
        "title": description.kind,
        "description": description.text,
        "type": "object",
        "properties": properties,
        "required": required,
    });
    if let Some(table) = table.as_object_mut() {
        if is_plain {
            table.insert("additionalProperties".to_owned(), Value::Bool(false));
        } else {
            let open = opened(parameters, definitions, 0);
            table.insert("allOf".to_owned(), json!([open]));
            table.insert("unevaluatedProperties".to_owned(), Value::Bool(false));
        }
    }
    table
}

/// A schema, or what it refers to if it is nothing but a reference.
fn resolved(schema: Value, definitions: &Map<String, Value>) -> Value {
    let target = schema
        .get("$ref")
        .and_then(Value::as_str)
        .and_then(|reference| definitions.get(reference.strip_prefix("#/$defs/")?));
    match (target, schema.as_object().map(Map::len)) {
        (Some(target), Some(1)) => target.clone(),
        _ => schema,
    }
}

/// A schema of a table that lets other keys stand beside its own.
fn opened(schema: Value, definitions: &Map<String, Value>, nesting: usize) -> Value {
    let schema = resolved(schema, definitions);
    let Value::Object(mut object) = schema else {
        return schema;
    };
    for word in ["additionalProperties", "unevaluatedProperties"] {
        if object.get(word) == Some(&Value::Bool(false)) {
            object.remove(word);
        }
    }
    for word in ["allOf", "anyOf", "oneOf"] {
        if let (Some(Value::Array(list)), true) = (object.get_mut(word), nesting < 8) {
            for inner in list.iter_mut() {
                *inner = opened(inner.take(), definitions, nesting + 1);
            }
        }
    }
    Value::Object(object)
}
