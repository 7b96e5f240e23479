//! The JSON Schema of recipes, judged by a small validator of its own (the subset of draft 2020-12 that it uses).

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;
#[path = "common/validator.rs"]
mod validator;

use anamorph_core::{Plane, Solid, Space};
use anamorph_recipe::{COMMON_KEYS, Recipe, Registry, schema};
use common::{build, registry};
use serde_json::{Value, json};
use validator::validate;

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
