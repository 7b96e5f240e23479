//! The JSON Schema of recipes, judged by a small validator of its own (the subset of draft 2020-12 that it uses).

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use anamorph_core::{Plane, Solid, Space};
use anamorph_recipe::{COMMON_KEYS, Recipe, Registry, schema};
use common::{build, registry};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// Validates and returns the keys of `value` that were evaluated; `None` if it is not valid.
fn validate(value: &Value, schema: &Value, root: &Value) -> Option<BTreeSet<String>> {
    let object = match schema {
        Value::Bool(valid) => return valid.then(BTreeSet::new),
        other => other
            .as_object()
            .expect("a schema is a table or a truth value"),
    };
    let mut evaluated = BTreeSet::new();
    let table = value.as_object();
    let empty = Map::new();
    let entries = table.unwrap_or(&empty);
    // Words that say more about others come last.
    let last = ["additionalProperties", "unevaluatedProperties"];
    let words = object
        .iter()
        .filter(|(word, _)| !last.contains(&word.as_str()));
    for (word, rule) in words.chain(last.iter().filter_map(|word| object.get_key_value(*word))) {
        let inner = |rule: &Value| validate(value, rule, root);
        let ok = match word.as_str() {
            "$ref" => {
                let pointer = rule.as_str()?.strip_prefix('#')?;
                let keys = inner(root.pointer(pointer).expect("a reference leads somewhere"))?;
                evaluated.extend(keys);
                true
            }
            "type" => {
                let is = |name: &Value| match name.as_str() {
                    Some("object") => value.is_object(),
                    Some("array") => value.is_array(),
                    Some("string") => value.is_string(),
                    Some("number") => value.is_number(),
                    Some("integer") => value.as_f64().is_some_and(|n| n.fract() == 0.0),
                    Some("boolean") => value.is_boolean(),
                    Some("null") => value.is_null(),
                    other => panic!("unknown type {other:?}"),
                };
                rule.as_array()
                    .map_or_else(|| is(rule), |names| names.iter().any(is))
            }
            "const" => value == rule || value.as_f64().is_some_and(|n| rule.as_f64() == Some(n)),
            "enum" => rule.as_array()?.contains(value),
            "required" => rule.as_array()?.iter().all(|key| {
                table.is_none_or(|table| table.contains_key(key.as_str().unwrap_or("")))
            }),
            "properties" => rule.as_object()?.iter().all(|(key, rule)| {
                let Some(item) = entries.get(key) else {
                    return true;
                };
                evaluated.insert(key.clone());
                validate(item, rule, root).is_some()
            }),
            "additionalProperties" => {
                let own = object.get("properties").and_then(Value::as_object);
                let others = entries
                    .iter()
                    .filter(|(key, _)| !own.is_some_and(|own| own.contains_key(*key)));
                others.clone().for_each(|(key, _)| {
                    evaluated.insert(key.clone());
                });
                others
                    .map(|(_, item)| item)
                    .all(|item| validate(item, rule, root).is_some())
            }
            "unevaluatedProperties" => entries
                .iter()
                .all(|(key, item)| evaluated.contains(key) || validate(item, rule, root).is_some()),
            "items" => value
                .as_array()
                .is_none_or(|list| list.iter().all(|item| validate(item, rule, root).is_some())),
            "minItems" => value
                .as_array()
                .is_none_or(|list| Some(list.len() as u64) >= rule.as_u64()),
            "maxItems" => value
                .as_array()
                .is_none_or(|list| Some(list.len() as u64) <= rule.as_u64()),
            "minimum" => value.as_f64().is_none_or(|n| Some(n) >= rule.as_f64()),
            "exclusiveMinimum" => value.as_f64().is_none_or(|n| Some(n) > rule.as_f64()),
            "allOf" | "anyOf" | "oneOf" => {
                let list = rule.as_array()?;
                let valid: Vec<_> = list.iter().filter_map(inner).collect();
                let count = valid.len();
                evaluated.extend(valid.into_iter().flatten());
                match word.as_str() {
                    "allOf" => count == list.len(),
                    "anyOf" => count > 0,
                    _ => count == 1,
                }
            }
            "title" | "description" | "default" | "$schema" | "$defs" | "format" | "pattern" => {
                true
            }
            other => panic!("this validator does not know {other}"),
        };
        if !ok {
            return None;
        }
    }
    Some(evaluated)
}

fn whole() -> Value {
    schema(&registry::<Plane>(), &registry::<Solid>())
}

fn is_valid(recipe: &Recipe) -> bool {
    let schema = whole();
    validate(&Value::Object(recipe.tree().clone()), &schema, &schema).is_some()
}

fn examples<S: Space>(registry: &Registry<S>) -> Vec<String> {
    let entries = registry.warps.iter();
    entries
        .map(|entry| {
            format!(
                "version = 1\n[[warp]]\nkind = \"{}\"\n{}\n",
                entry.kind, entry.example
            )
        })
        .collect()
}

#[test]
fn every_example_is_valid_with_and_without_the_common_keys() {
    let common = "label = \"x\"\nenabled = true\nstrength = 0.5\nambient = 0.5\nscaling = \"composition\"\n\
                  weight = { field = \"radial\", centre = \"50%\", radius = 1 }\n\
                  mask = { field = \"product\", of = [0.5, { field = \"radial\", centre = [1, 2, 3], radius = \"5%\" }] }\n";
    for example in examples(&registry::<Plane>())
        .into_iter()
        .chain(examples(&registry::<Solid>()))
    {
        for text in [example.clone(), example + common] {
            let recipe = Recipe::read(text.as_bytes(), "a.toml").unwrap();
            assert!(is_valid(&recipe), "{text}");
        }
    }
    for example in examples(&registry::<Solid>()) {
        let recipe = Recipe::read(example.as_bytes(), "a.toml").unwrap();
        assert!(build(&recipe).is_ok(), "{example}");
    }
}

#[test]
fn what_the_walk_refuses_the_schema_refuses() {
    let shift = "[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n";
    for extra in [
        "ofset = 1",
        "move = [{ index = 1, by = \"1%\", indx = 1 }]",
        "mask = { field = \"radal\", centre = \"50%\", radius = 1 }",
        "mask = { field = \"radial\", centre = \"50%\", radius = 1, of = 1 }",
        "weight = { field = \"product\", of = [{ field = \"product\", of = [1], q = 1 }] }",
        "scaling = \"none\"",
        "ambient = 0",
        "enabled = \"yes\"",
        "label = 3",
        "[[warp]]\nkind = \"shft\"\noffset = [1, 2, 3]",
        "[[warp]]\nkind = \"screw\"\nby = \"slope\"\nrise = 1\nrun = 1\nangle = \"1rad\"",
        "[[warp]]\nkind = \"screw\"\nby = \"angle\"\nangle = \"1rad\"\nq = 1",
        "[[warp]]\noffset = [1, 2, 3]",
    ] {
        let text = format!("version = 1\n{shift}{extra}\n");
        let recipe = Recipe::read(text.as_bytes(), "a.toml").unwrap();
        assert!(recipe.check_keys(&registry::<Solid>()).is_err(), "{text}");
        assert!(!is_valid(&recipe), "{text}");
    }
    for text in [
        "version = 1\nwarps = []",
        "version = 1\n[warp]\nkind = \"shift\"",
    ] {
        assert!(
            !is_valid(&Recipe::read(text.as_bytes(), "a.toml").unwrap()),
            "{text}"
        );
    }
}

#[test]
fn the_schema_says_what_editors_show() {
    let schema = whole();
    let definitions = schema["$defs"].as_object().unwrap();
    let kinds = schema["properties"]["warp"]["items"]["oneOf"]
        .as_array()
        .unwrap();
    let names: Vec<&str> = kinds
        .iter()
        .map(|kind| kind["$ref"].as_str().unwrap())
        .collect();
    assert_eq!(
        names,
        [
            "#/$defs/warp-shift",
            "#/$defs/warp-grow",
            "#/$defs/warp-screw",
            "#/$defs/warp-whirl"
        ]
    );
    let shift = &definitions["warp-shift"];
    assert_eq!(shift["properties"]["kind"], json!({ "const": "shift" }));
    assert_eq!(shift["required"], json!(["kind", "offset"]));
    assert_eq!(shift["additionalProperties"], json!(false));
    assert_eq!(
        shift["description"],
        "Moves points.\n\nNo one, Nowhere, 1900"
    );
    assert_eq!(
        definitions["warp-screw"]["unevaluatedProperties"],
        json!(false)
    );
    for kind in ["warp-shift", "warp-screw"] {
        for key in COMMON_KEYS {
            let property = &definitions[kind]["properties"][key];
            assert!(property["description"].is_string(), "{kind} {key}");
        }
    }
    assert!(schema["properties"]["version"]["const"] == 1);
}
