//! What a valid recipe becomes.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use anamorph_catalog::Context;
use anamorph_core::glam::{DVec3, dvec3};
use anamorph_core::{Deformation, Plane, Site, Solid};
use anamorph_recipe::{BuiltPart, BuiltRecipe, Place, Recipe};
use common::{build, plane, registry, run};

fn recipe(text: &str) -> BuiltRecipe<Solid> {
    run(text.as_bytes(), "a.toml", &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn image(built: &BuiltRecipe<Solid>, point: DVec3) -> DVec3 {
    built.stack().map(&Site::anywhere(point))
}

#[test]
fn an_empty_recipe_is_the_identity() {
    for text in [
        "version = 1",
        "version = 1\nwarp = []",
        "{\"version\": 1.0}",
    ] {
        let built = recipe(text);
        assert!(built.parts.is_empty());
        let p = dvec3(0.1, -2.5, 1e300);
        assert_eq!(image(&built, p), p);
    }
}

#[test]
fn warps_apply_in_order_and_see_the_model_as_it_arrives() {
    // The model is 10 × 20 × 40. Doubled about its lowest corner it is 20 × 40 × 80: then 10 % are 2, 4 and 8.
    let built = recipe(
        "version = 1\n[[warp]]\nkind = \"grow\"\nfactor = 2\ncentre = \"0%\"\n\
         [[warp]]\nkind = \"shift\"\noffset = \"10%\"\nlabel = \"second\"\n",
    );
    assert_eq!(image(&built, Solid::ZERO), dvec3(2.0, 4.0, 8.0));
    assert_eq!(image(&built, dvec3(1.0, 1.0, 1.0)), dvec3(4.0, 6.0, 10.0));
    let titles: Vec<&str> = built.parts.iter().map(BuiltPart::title).collect();
    assert_eq!(titles, ["grow", "second"]);
    assert_eq!(built.parts[1].marks.len(), 1);
    assert_eq!((built.parts[1].index, built.parts[1].system), (1, "T1"));
}

#[test]
fn defaults_relative_to_the_model_follow_it_too() {
    // `centre` is left out and means the middle of what arrives, which the first warp has moved by 100.
    let built = recipe(
        "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [100, 0, 0]\n[[warp]]\nkind = \"grow\"\nfactor = 3\n",
    );
    assert_eq!(
        image(&built, dvec3(5.0, 10.0, 20.0)),
        dvec3(105.0, 10.0, 20.0)
    );
}

#[test]
fn bounds_are_asked_for_only_where_they_are_needed() {
    let count = |text: &str, context: &Context<'_, Solid>| {
        let recipe = Recipe::read(text.as_bytes(), "a.toml").unwrap();
        let mut seen = Vec::new();
        let built = recipe.build(&registry::<Solid>(), context, &mut |parts| {
            seen.push(parts.len());
            Some(common::bounds())
        });
        (seen, built.err().map(|error| error.to_string()))
    };
    let absolute = "[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nlabel = \"5%\"\n";
    let relative = "[[warp]]\nkind = \"shift\"\noffset = [\"1%\", 2, 3]\n";
    let mask = "[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\nmask = { field = \"radial\", centre = [0, 0, 0], radius = \"5%\" }\n";
    let off = "[[warp]]\nkind = \"shift\"\noffset = \"5%\"\nenabled = false\n";
    let text = |warps: &[&str]| format!("version = 1\n{}", warps.concat());
    let model = Context::of_bounds(common::bounds());
    assert_eq!(
        count(&text(&[relative, absolute, absolute]), &model),
        (vec![], None)
    );
    assert_eq!(
        count(&text(&[absolute, relative, absolute, mask]), &model),
        (vec![1, 3], None)
    );
    assert_eq!(
        count(&text(&[off, relative, off, relative]), &model),
        (vec![1], None)
    );
    let (seen, error) = count(&text(&[absolute, relative]), &Context::default());
    assert!(seen.is_empty());
    assert_eq!(
        error.as_deref(),
        Some(
            "a.toml:8:10: warp.1.offset: this is relative to the model, and no model was given; name a model, or write \
             an absolute number in scene units"
        )
    );
}

#[test]
fn strength_weight_mask_and_ambient() {
    let shifted = |keys: &str| {
        let built = recipe(&format!(
            "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [8, 0, 0]\n{keys}\n"
        ));
        (
            built.parts[0].warp.map(&Site::anywhere(Solid::ZERO)).x,
            built.parts[0]
                .deformation
                .map(&Site::anywhere(Solid::ZERO))
                .x,
        )
    };
    assert_eq!(shifted(""), (8.0, 8.0));
    assert_eq!(shifted("strength = 0.5"), (4.0, 4.0));
    assert_eq!(shifted("strength = -2"), (-16.0, -16.0));
    assert_eq!(shifted("mask = 0.25"), (8.0, 2.0));
    assert_eq!(shifted("mask = 0"), (8.0, 0.0));
    assert_eq!(shifted("ambient = 1"), (4.0, 4.0));
    assert_eq!(shifted("ambient = 1\nweight = 3\nmask = 0.5"), (6.0, 3.0));
    let radial = "{ field = \"radial\", centre = [4, 0, 0], radius = 8 }";
    assert_eq!(
        shifted(&format!(
            "strength = {radial}\nmask = {{ field = \"product\", of = [0.5, {radial}] }}"
        )),
        (4.0, 1.0)
    );
}

#[test]
fn both_syntaxes_say_the_same() {
    let toml = "version = 1\nname = \"n\"\n[[warp]]\nkind = \"shift\"\noffset = [1, \"50%\", -2.5e-3]\nenabled = true\n\
                [[warp.move]]\nindex = 3\nby = \"1%\"\n[warp.mask]\nfield = \"radial\"\ncentre = \"50%\"\nradius = 0x10\n";
    let json = r#"{"$schema": "recipe.json", "version": 1, "name": "n", "warp": [{"kind": "shift",
        "offset": [1, "50%", -2.5e-3], "enabled": true, "move": [{"index": 3, "by": "1%"}],
        "mask": {"field": "radial", "centre": "50%", "radius": 16}}]}"#;
    let (toml, json) = (
        Recipe::from_toml(toml, "a").unwrap(),
        Recipe::from_json(json, "b").unwrap(),
    );
    let mut tree = json.tree().clone();
    tree.remove("$schema");
    assert_eq!(&tree, toml.tree());
    let p = dvec3(4.0, 9.0, 21.0);
    assert_eq!(
        image(&build(&toml).unwrap(), p),
        image(&build(&json).unwrap(), p)
    );
    assert_ne!(image(&build(&toml).unwrap(), p), p);
}

/// The value with the keys of all tables in alphabetical order.
fn sorted(value: &serde_json::Value) -> serde_json::Value {
    match value {
        serde_json::Value::Object(table) => {
            let mut entries: Vec<_> = table.iter().collect();
            entries.sort_by_key(|entry| entry.0);
            let entries = entries.into_iter();
            entries
                .map(|(key, value)| (key.clone(), sorted(value)))
                .collect()
        }
        serde_json::Value::Array(list) => list.iter().map(sorted).collect(),
        other => other.clone(),
    }
}

#[test]
fn settings_change_single_values() {
    let text = "version = 1\n[[warp]]\nkind = \"shift\"\noffset = [1, 2, 3]\n[[warp]]\nkind = \"grow\"\nfactor = 1\n";
    let mut recipe = Recipe::read(text.as_bytes(), "a.toml").unwrap();
    for setting in [
        "warp.0.offset.1=7",
        " warp.1.factor = 2.0 ",
        "warp.1.centre=[0, 0, 0]",
        "warp.0.angle=360deg",
        "warp.0.label=first = best",
        "warp.1.mask.field=radial",
        "warp.1.mask.centre=0%",
        "warp.1.mask.radius=1e9",
        "warp.1.label=2020-01-01",
        "warp.0.move=[]",
        "warp.0.enabled=true",
        "name='x'",
    ] {
        recipe
            .set(setting)
            .unwrap_or_else(|error| panic!("{error}"));
    }
    // Sorted, because whether tables keep their order is for the program to choose.
    let tree: std::collections::BTreeMap<_, _> = recipe
        .tree()
        .iter()
        .map(|(key, value)| (key, sorted(value)))
        .collect();
    insta::assert_snapshot!(serde_json::to_string(&tree).unwrap(), @r#"{"name":"x","version":1,"warp":[{"angle":"360deg","enabled":true,"kind":"shift","label":"first = best","move":[],"offset":[1,7,3]},{"centre":[0,0,0],"factor":2.0,"kind":"grow","label":"2020-01-01","mask":{"centre":"0%","field":"radial","radius":1000000000.0}}]}"#);
    let moved = image(&build(&recipe).unwrap(), Solid::ZERO);
    assert!(moved.distance(dvec3(2.0, 14.0, 6.0)) < 1e-6, "{moved}");
    assert_eq!(recipe.kinds(), ["shift", "grow"]);

    // A failed setting changes nothing; what was in the file is still found there.
    let before = recipe.tree().clone();
    assert!(recipe.set("warp.0.new.deep.0=1").is_err());
    assert_eq!(recipe.tree(), &before);
    recipe.set("warp.1.kind=shift").unwrap();
    let error = build(&recipe).err().unwrap();
    assert!(
        error
            .problems
            .iter()
            .any(|p| p.path == "warp.1.factor" && matches!(p.place, Place::Setting(_)))
    );
}

#[test]
fn the_plane_has_its_own_kinds() {
    let text = "version = 1\n[[warp]]\nkind = \"whirl\"\nby = \"angle\"\nangle = \"0.25turn\"\n";
    let recipe = Recipe::read(text.as_bytes(), "a.toml").unwrap();
    let built = recipe
        .build(&plane(), &Context::default(), &mut |_| None)
        .unwrap();
    let image = built.stack().map(&Site::anywhere(Plane::new(1.0, 0.0)));
    assert!(image.distance(Plane::new(0.0, 1.0)) < 1e-15);
    let text = text.replace("whirl", "screw");
    let error = Recipe::read(text.as_bytes(), "a.toml")
        .unwrap()
        .check_keys(&plane());
    insta::assert_snapshot!(error.unwrap_err(), @"a.toml:3:8: warp.0.kind: the warp `screw` works only in space, not in the plane; use it on a model in space; `anamorph list warps` names all warps");
}

#[test]
fn many_typing_errors_are_reported_at_once() {
    let mut text = "version = 1\nnme = \"x\"\n".to_owned();
    for i in 0..12 {
        text += &format!("[[warp]]\nkind = \"shift\"\nofset{i} = 1\noffset = [0, 0, 0]\n");
    }
    let error = run(text.as_bytes(), "a.toml", &[]).err().unwrap();
    assert_eq!((error.problems.len(), error.omitted), (10, 3));
    let lines: Vec<Place> = error.problems.iter().map(|p| p.place.clone()).collect();
    let expected = [2].into_iter().chain((0..9).map(|i| 5 + 4 * i));
    let expected: Vec<Place> = expected
        .map(|line| Place::File { line, column: 1 })
        .collect();
    assert_eq!(lines, expected);
}
