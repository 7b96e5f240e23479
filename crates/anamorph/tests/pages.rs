//! The pages under `docs/` are true: what the registries hold is described, and the recipes work.

#![cfg(all(feature = "io", feature = "recipe"))]
#![allow(clippy::panic, reason = "helpers of tests")]

use anamorph::catalog::schemars::SchemaGenerator;
use anamorph::catalog::serde_json::Value;
use anamorph::catalog::{Attributes, Context, FeatureMesh, Meshes};
use anamorph::io::{Document, Points, ReadOptions};
use anamorph::recipe::{COMMON_KEYS, Recipe};
use anamorph::{Bounds, Space, Stack, fields, map_all, registry};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn text(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The part of a page under a heading, up to the next of the same or a higher level.
fn section<'a>(page: &'a str, heading: &str) -> Option<&'a str> {
    let level = heading.bytes().take_while(|&byte| byte == b'#').count();
    let begin = page.find(&format!("\n{heading}\n"))? + heading.len() + 2;
    let ends = |line: &str| {
        let hashes = line.bytes().take_while(|&byte| byte == b'#').count();
        (1..=level).contains(&hashes)
    };
    let mut length = 0;
    for line in page[begin..].split_inclusive('\n') {
        if ends(line) {
            break;
        }
        length += line.len();
    }
    Some(&page[begin..begin + length])
}

/// All keys of tables anywhere in a schema, with what it refers to.
fn keys(schema: &Value, definitions: &Value, found: &mut BTreeSet<String>) {
    match schema {
        Value::Object(object) => {
            if let Some(Value::Object(properties)) = object.get("properties") {
                found.extend(properties.keys().cloned());
            }
            if let Some(Value::String(reference)) = object.get("$ref") {
                let name = reference.trim_start_matches("#/$defs/");
                keys(&definitions[name], definitions, found);
            }
            object
                .values()
                .for_each(|value| keys(value, definitions, found));
        }
        Value::Array(list) => list
            .iter()
            .for_each(|value| keys(value, definitions, found)),
        _ => {}
    }
}

#[test]
fn every_warp_and_parameter_is_described() {
    let page = text("docs/recipes.md");
    let lattice = section(&page, "### lattice").unwrap();
    for entry in registry::solid().warps {
        let heading = format!("### {}", entry.kind);
        let section = section(&page, &heading).unwrap_or_else(|| panic!("no {heading}"));
        let mut generator = SchemaGenerator::default();
        let schema = Value::from((entry.schema)(&mut generator));
        let definitions = Value::Object(generator.take_definitions(true));
        let mut names = BTreeSet::new();
        keys(&schema, &definitions, &mut names);
        assert!(names.len() > 1, "{}", entry.kind);
        for name in names {
            let described = |text: &str| {
                text.contains(&format!("`{name}`"))
                    || ["min", "max", "origin", "edges"].contains(&name.as_str())
                        && lattice.contains(&name)
                    || section.contains("are as for `lattice`")
                        && lattice.contains(&format!("| `{name}` |"))
            };
            assert!(described(section), "{heading} says nothing about `{name}`");
        }
    }
}

#[test]
fn common_keys_fields_and_falloffs_are_described() {
    let page = text("docs/recipes.md");
    let common = section(&page, "## Keys of every warp").unwrap();
    for key in COMMON_KEYS {
        assert!(common.contains(&format!("| `{key}` |")), "{key}");
    }
    let part = section(&page, "## Fields").unwrap();
    for entry in fields::recipe::entries::<anamorph::Solid>() {
        let row = part
            .lines()
            .find(|line| line.starts_with(&format!("| `{}` |", entry.kind)))
            .unwrap_or_else(|| panic!("no row for {}", entry.kind));
        let schema = Value::from((entry.schema)(&mut SchemaGenerator::default()));
        for key in schema["properties"].as_object().unwrap().keys() {
            assert!(row.contains(&format!("`{key}`")), "{}: {key}", entry.kind);
        }
    }
    for falloff in fields::FALLOFFS {
        let row = format!("| `{}` |", falloff.name());
        assert!(part.contains(&row), "{row}");
    }
}

#[test]
fn the_front_page_lists_every_warp() {
    let page = text("README.md");
    for entry in registry::solid().warps {
        let row = format!("| [`{0}`](docs/recipes/{0}.toml) |", entry.kind);
        assert!(page.contains(&row), "{row}");
    }
}

#[test]
fn every_key_of_a_motion_is_described() {
    let page = text("docs/recipes.md");
    let part = section(&page, "## Motions").unwrap();
    let schema = anamorph::recipe::schema(&registry::plane(), &registry::solid());
    let mut names = BTreeSet::new();
    keys(
        &schema["properties"]["motion"],
        &schema["$defs"],
        &mut names,
    );
    assert!(names.len() > 40);
    for name in names {
        // By its name, or in the form in which it is written.
        let described = [format!("`{name}`"), format!("{name} = ")];
        assert!(
            described.iter().any(|form| part.contains(form)),
            "`{name}` is not described"
        );
    }
    // The words that `kind` and `ease` take.
    fn constants(schema: &Value, found: &mut BTreeSet<String>) {
        match schema {
            Value::Object(object) => {
                let kind = &object.get("properties").unwrap_or(&Value::Null)["kind"]["const"];
                found.extend(kind.as_str().map(str::to_owned));
                object.values().for_each(|value| constants(value, found));
            }
            Value::Array(list) => list.iter().for_each(|value| constants(value, found)),
            _ => {}
        }
    }
    let mut kinds = BTreeSet::new();
    for part in [
        &schema["properties"]["motion"],
        &schema["$defs"]["motion-path"],
        &schema["$defs"]["motion-smoothing"],
    ] {
        constants(part, &mut kinds);
    }
    assert!(kinds.len() > 25);
    for kind in kinds {
        assert!(
            part.contains(&format!("`{kind}`")),
            "`{kind}` is not described"
        );
    }
}

struct Columns<'a>(&'a dyn Document);

impl Attributes for Columns<'_> {
    fn attribute(&self, name: &str) -> Option<Arc<[f64]>> {
        self.0.attribute(name).map(Arc::from)
    }
    fn names(&self) -> Vec<String> {
        self.0.attributes()
    }
}

/// The files beside the recipes of the pages.
struct Beside;

impl Meshes for Beside {
    fn mesh(&self, name: &str) -> Result<Arc<FeatureMesh>, String> {
        let bytes = std::fs::read(root().join("docs/recipes").join(name))
            .map_err(|error| format!("{name}: {error}"))?;
        let document = anamorph::io::read(bytes, Some(name), &ReadOptions::default())
            .map_err(|error| format!("{name}: {error}"))?;
        let Points::Solid(points) = document.points() else {
            return Err(format!("{name} lies in the plane"));
        };
        let mesh = document.mesh().unwrap_or_default();
        Ok(Arc::new(FeatureMesh {
            dimension: 3,
            points: points.to_vec(),
            lines: mesh.lines,
            triangles: mesh.triangles,
            comments: Vec::new(),
        }))
    }
}

/// Builds a recipe for a model and moves it; how far the farthest point went, and the kinds.
fn warped<S: Space>(
    recipe: &Recipe,
    registry: &anamorph::recipe::Registry<S>,
    points: &[S],
    document: &dyn Document,
) -> (f64, Vec<&'static str>) {
    let columns = Columns(document);
    let context = Context {
        bounds: Bounds::of(points),
        scaling: None,
        attributes: Some(&columns),
        meshes: Some(&Beside),
    };
    let mut after = |parts: &[Arc<dyn anamorph::Deformation<S>>]| {
        let mut moved = points.to_vec();
        let parts = parts.iter().map(|part| Box::new(Arc::clone(part)) as _);
        map_all(&Stack::new(parts.collect()), &mut moved);
        Bounds::of(&moved)
    };
    let built = recipe
        .build(registry, &context, &mut after)
        .unwrap_or_else(|error| panic!("{error}"));
    let mut moved = points.to_vec();
    assert!(map_all(&built.stack(), &mut moved).is_empty());
    let distances = points.iter().zip(&moved).map(|(&a, &b)| a.distance(b));
    let kinds = built.parts.iter().map(|part| part.kind).collect();
    (distances.fold(0.0, f64::max), kinds)
}

#[test]
fn every_recipe_moves_its_model_and_every_warp_has_one() {
    let mut shown = BTreeSet::new();
    for entry in std::fs::read_dir(root().join("docs/recipes")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|end| end != "toml") {
            // A cage that one of them reads.
            continue;
        }
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let source = std::fs::read_to_string(&path).unwrap();
        let recipe = Recipe::from_toml(&source, &name).unwrap();
        if recipe.is_motion() {
            let built = recipe
                .build_motion(Some(&Beside))
                .unwrap_or_else(|e| panic!("{e}"));
            assert!(
                built.motion.distance(built.motion.duration()) > 0.1,
                "{name}"
            );
            continue;
        }
        // The first line says which model the recipe is for.
        let first = source.lines().next().unwrap();
        let model = [
            ("teapot", "teapot.obj"),
            ("the plane", "grid.csv"),
            ("", "spot.obj"),
        ]
        .into_iter()
        .find_map(|(word, file)| first.contains(word).then_some(file))
        .unwrap();
        let bytes = std::fs::read(root().join("tests/fixtures/valid").join(model)).unwrap();
        let document = anamorph::io::read(bytes, Some(model), &ReadOptions::default()).unwrap();
        let (distance, kinds) = match document.points() {
            Points::Plane(points) => warped(&recipe, &registry::plane(), points, document.as_ref()),
            Points::Solid(points) => warped(&recipe, &registry::solid(), points, document.as_ref()),
        };
        assert!(distance > 0.1, "{name} moves {model} by {distance}");
        for kind in &kinds {
            if name == format!("{kind}.toml") {
                shown.insert(*kind);
            }
        }
    }
    for entry in registry::solid().warps {
        assert!(shown.contains(entry.kind), "no recipe {}.toml", entry.kind);
    }
}
