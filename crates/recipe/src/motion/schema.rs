//! The JSON Schema of `[motion]`, made from the registries of curves, eases and orientations.

use super::attitude::{is_angle, is_length};
use super::path::MOST_ITERATIONS;
use super::speed::{AS_DRAWN, BETWEEN, FIXED, REPAIRS};
use super::{KEYED, MEASURES, SMOOTHINGS, SUBJECTS};
use anamorph_catalog::schemars::{JsonSchema, SchemaGenerator};
use anamorph_catalog::{Angle, Axis};
use anamorph_curves::eases::{self, EaseEntry, Setting};
use anamorph_curves::families::registry::FAMILIES;
use anamorph_curves::orientation::registry::{MODIFIERS, ORIENTATIONS, Parameter, Takes};
use serde_json::{Map, Value, json};

/// A table of these keys and no others.
#[allow(clippy::needless_pass_by_value, reason = "made for this table alone")]
fn closed(description: &str, properties: Map<String, Value>, required: &[&str]) -> Value {
    json!({
        "description": description,
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

fn map<const N: usize>(entries: [(&str, Value); N]) -> Map<String, Value> {
    let each = entries.into_iter();
    each.map(|(key, schema)| (key.to_owned(), schema)).collect()
}

/// A number, or a share of something.
fn share(description: &str) -> Value {
    json!({
        "description": description,
        "anyOf": [
            { "type": "number" },
            { "type": "string", "pattern": "^\\s*[-+]?[0-9.]+([eE][-+]?[0-9]+)?\\s*%\\s*$" },
        ],
    })
}

fn described(description: &str, schema: &Value) -> Value {
    let mut schema = schema.clone();
    if let Value::Object(table) = &mut schema {
        table.insert("description".to_owned(), Value::from(description));
    }
    schema
}

fn vector(description: &str) -> Value {
    json!({ "description": description, "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 3 })
}

fn of<T: JsonSchema>(description: &str) -> Value {
    described(
        description,
        &Value::from(T::json_schema(&mut SchemaGenerator::default())),
    )
}

/// A list of at least one.
fn list(description: &str, items: &Value) -> Value {
    json!({ "description": description, "type": "array", "items": items })
}

/// The tables of all families of curves.
fn paths() -> Value {
    let points = json!({
        "description": "the points: [x, y, z] each, or [x, y] in the plane; or the name of a file of points or of one polyline",
        "anyOf": [
            { "type": "string" },
            { "type": "array", "items": vector("a point") },
        ],
    });
    let all = FAMILIES.iter().map(|family| {
        let mut keys = map([
            ("kind", json!({ "const": family.name })),
            ("points", points.clone()),
            ("smooth", json!({ "$ref": "#/$defs/motion-smoothing" })),
        ]);
        let mut put = |key: &str, schema| keys.insert(key.to_owned(), schema);
        if family.closes {
            put("closed", json!({ "description": "whether it returns to its start", "type": "boolean" }));
        }
        if family.velocities {
            put("velocities", list("a velocity at each point", &vector("a velocity")));
        }
        if let Some(word) = family.times {
            put(word, list("one for each point, increasing", &json!({ "type": "number" })));
        }
        for number in family.numbers {
            let about = if number.flag {
                let default = number.default != 0.0;
                json!({ "description": number.meaning, "anyOf": [{ "type": "boolean" }, { "enum": [0, 1] }], "default": default })
            } else {
                json!({ "description": number.meaning, "type": "number", "default": number.default })
            };
            put(number.name, about);
        }
        let about = format!("{}: {}\n\n{}", family.title, family.reads, family.reference);
        closed(&about, keys, &["kind", "points"])
    });
    json!({ "oneOf": all.collect::<Vec<_>>() })
}

fn smoothings() -> Value {
    let all = SMOOTHINGS.iter().map(|entry| {
        let mut keys = map([
            ("kind", json!({ "const": entry.name })),
            ("repeat", json!({
                "description": "how often, each time what the time before made",
                "type": "integer", "minimum": 0, "maximum": MOST_ITERATIONS, "default": 1,
            })),
            ("pinned", list("indices, from 0, of points that stay", &json!({ "type": "integer", "minimum": 0 }))),
            ("ends", json!({ "description": "whether the ends of an open path stay", "enum": ["pinned", "free"], "default": "pinned" })),
        ]);
        for (name, meaning, default) in entry.numbers {
            let about = json!({ "description": meaning, "type": "number", "default": default });
            keys.insert((*name).to_owned(), about);
        }
        closed(entry.summary, keys, &["kind"])
    });
    json!({ "oneOf": all.collect::<Vec<_>>() })
}

fn ease(entry: &EaseEntry) -> Value {
    let mut names = vec![entry.name];
    names.extend(entry.aliases);
    let mut keys = map([
        ("ease", json!({ "enum": names })),
        (
            "distance",
            share("what is covered: scene units, or a share of the path; all of it if left out"),
        ),
    ]);
    for parameter in entry.parameters {
        let schema = match parameter.default {
            Setting::Number(default) => json!({ "type": "number", "default": default }),
            Setting::Word(default) => json!({ "type": "string", "default": default }),
            Setting::Stops(_) => list(
                "",
                &json!({ "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 }),
            ),
        };
        keys.insert(
            parameter.name.to_owned(),
            described(parameter.summary, &schema),
        );
    }
    closed(
        &format!("{}\n\n{}", entry.title, entry.reference),
        keys,
        &["ease"],
    )
}

/// A list of keys `[time, number]` and what may follow.
fn keys(description: &str, third: &Value) -> Value {
    let row = json!({
        "type": "array",
        "prefixItems": [
            share("seconds, or a share of the duration"),
            share("scene units, or a share of the path"),
            third,
        ],
        "minItems": 2,
        "maxItems": 3,
    });
    list(description, &row)
}

fn speeds() -> Value {
    let mut all: Vec<Value> = vec![json!({
        "description": "an ease by name, or as style sheets write it: cubic-bezier(), steps(), linear()",
        "type": "string",
    })];
    all.extend(eases::registry().iter().map(ease));
    let between = json!({ "description": "how the quantity goes from key to key", "enum": BETWEEN, "default": BETWEEN[0] });
    let fixed = json!({ "const": FIXED });
    let whole = share(
        "the distance to cover, exactly: scene units, or a share of the path; all of it if left out",
    );
    let drawn = json!({ "anyOf": [whole, { "const": AS_DRAWN }] });
    all.push(closed(
        "distances at times",
        map([
            ("distances", keys("[time, distance] or [time, distance, speed]", &share("the speed there"))),
            ("repair", json!({ "description": "never turning round between two keys, or smoother", "enum": REPAIRS, "default": REPAIRS[0] })),
        ]),
        &["distances"],
    ));
    all.push(closed(
        "speeds at times; those that are not fixed are scaled to cover the distance",
        map([
            (
                "speeds",
                keys("[time, speed] or [time, speed, \"fixed\"]", &fixed),
            ),
            ("between", between.clone()),
            ("distance", drawn),
        ]),
        &["speeds"],
    ));
    all.push(closed(
        "accelerations at times; those that are not fixed are scaled to cover the distance",
        map([
            (
                "accelerations",
                keys(
                    "[time, acceleration] or [time, acceleration, \"fixed\"]",
                    &fixed,
                ),
            ),
            ("between", between),
            ("distance", whole),
            ("start", share("the speed at the start, 0 if left out")),
            (
                "end",
                share("the speed at the end; whatever comes if left out"),
            ),
        ]),
        &["accelerations"],
    ));
    json!({ "description": "which distance is covered at which time; evenly if left out", "anyOf": all })
}

fn parameter(parameter: &Parameter) -> Value {
    let about = parameter.meaning;
    match parameter.takes {
        Takes::Number(_) if is_angle(parameter) => of::<Angle>(about),
        Takes::Number(_) if is_length(parameter) => {
            share(&format!("{about}; or a share of the path's length"))
        }
        Takes::Number(Some(default)) => {
            json!({ "description": about, "type": "number", "default": default })
        }
        Takes::Number(None) => json!({ "description": about, "type": "number" }),
        Takes::Vector(_) if parameter.name == "target" => vector(about),
        Takes::Vector(_) => of::<Axis>(about),
        Takes::Word(words) => {
            json!({ "description": about, "enum": words, "default": words.first() })
        }
        Takes::Curve => json!({ "description": about, "$ref": "#/$defs/motion-path" }),
    }
}

fn parameters(keys: &mut Map<String, Value>, all: &[Parameter]) {
    for p in all {
        keys.insert(p.name.to_owned(), parameter(p));
    }
}

fn orientations() -> Value {
    let along = ORIENTATIONS.iter().map(|entry| entry.name);
    let names: Vec<&str> = along.chain(KEYED.iter().map(|entry| entry.name)).collect();
    let mut all = vec![json!({ "description": "an orientation by name", "enum": names })];
    all.extend(ORIENTATIONS.iter().map(|entry| {
        let mut keys = map([("kind", json!({ "const": entry.name }))]);
        parameters(&mut keys, entry.parameters);
        for modifier in MODIFIERS {
            let mut inner = Map::new();
            parameters(&mut inner, modifier.parameters);
            let table = closed(modifier.summary, inner, &[]);
            let about =
                json!({ "description": modifier.summary, "anyOf": [{ "type": "boolean" }, table] });
            keys.insert(modifier.name.to_owned(), about);
        }
        let mut needed = vec!["kind"];
        needed.extend(
            entry
                .parameters
                .iter()
                .filter(|p| p.required)
                .map(|p| p.name),
        );
        closed(
            &format!("{}: {}\n\n{}", entry.title, entry.summary, entry.reference),
            keys,
            &needed,
        )
    }));
    let time = share("seconds, or a share of the duration");
    let key = closed(
        "an orientation at a time: `quaternion`, or `axis` and `angle`",
        map([
            ("time", time.clone()),
            (
                "quaternion",
                json!({
                    "description": "[w, x, y, z]", "type": "array", "items": { "type": "number" }, "minItems": 4, "maxItems": 4,
                }),
            ),
            ("axis", of::<Axis>("what it turns about")),
            ("angle", of::<Angle>("by how much, by the right-hand rule")),
        ]),
        &["time"],
    );
    all.extend(KEYED.iter().map(|entry| {
        let keys = map([
            ("kind", json!({ "const": entry.name })),
            ("keys", list("the keys, in the order of time", &key)),
            ("closed", json!({ "description": "whether the first key comes again", "type": "boolean", "default": false })),
            ("return", described("when the first key comes again; at the end of the motion if left out", &time)),
            ("even", json!({ "description": "turning at an even rate, whatever the keys' times in between", "type": "boolean", "default": false })),
        ]);
        closed(&format!("{}: {}\n\n{}", entry.title, entry.summary, entry.reference), keys, &["kind", "keys"])
    }));
    json!({ "description": "how it is turned; by rotation-minimizing frames if left out", "anyOf": all })
}

/// The schema of the table; what it refers to goes into `definitions`.
pub(crate) fn motion(definitions: &mut Map<String, Value>) -> Value {
    definitions.insert("motion-path".to_owned(), paths());
    definitions.insert("motion-smoothing".to_owned(), smoothings());
    closed(
        "a motion along a path",
        map([
            ("path", json!({ "$ref": "#/$defs/motion-path" })),
            ("speed", speeds()),
            (
                "duration",
                json!({ "description": "seconds; that of the keys if left out", "type": "number", "exclusiveMinimum": 0 }),
            ),
            (
                "by",
                json!({
                    "description": "what distances are: lengths along the path, or parameters of it", "enum": MEASURES, "default": MEASURES[0],
                }),
            ),
            ("orientation", orientations()),
            (
                "subject",
                json!({
                    "description": "what moves: an object, which faces its +z, or a camera, which looks along its -z", "enum": SUBJECTS, "default": SUBJECTS[0],
                }),
            ),
        ]),
        &["path"],
    )
}
