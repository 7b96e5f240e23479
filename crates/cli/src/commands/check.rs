//! `anamorph check`: what the warps of a recipe promise.

use super::promises::{line, promises, to_json, to_text};
use crate::arguments::CheckOptions;
use crate::error::{Failure, output};
use crate::files;
use crate::meshes::RecipeFiles;
use crate::model::{ModelSpace, build, read, read_recipe, size};
use anamorph_catalog::Context;
use anamorph_core::guarantees::{Guarantee, commutation};
use anamorph_core::{Bounds, Plane, Solid, Stack, map_all};
use anamorph_io::{Document, Points, ReadOptions};
use anamorph_recipe::{BuiltRecipe, Recipe};
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;

/// A recipe built for a model or for its stand-in, the points, and what they are.
fn built_for<S: ModelSpace>(
    path: &Path,
    recipe: &Recipe,
    options: &CheckOptions,
    document: Option<&dyn Document>,
) -> Result<(BuiltRecipe<S>, Vec<S>, String), Failure> {
    let beside = RecipeFiles::beside(path, options.allow_outside);
    Ok(match document {
        Some(document) => {
            let points = S::points(document.points()).unwrap_or_default();
            let points = points[..document.visible().min(points.len())].to_vec();
            let name = options
                .model
                .as_deref()
                .map(files::shown)
                .unwrap_or_default();
            (build(recipe, document, &points, &beside)?, points, name)
        }
        None => {
            let points = stand_in::<S>();
            let context = Context {
                meshes: Some(&beside),
                ..Context::of_bounds(Bounds::new(S::splat(-1.0), S::splat(1.0)))
            };
            let built = recipe
                .build(&S::registry(), &context, &mut |parts| {
                    let mut moved = points.clone();
                    let parts = parts
                        .iter()
                        .map(|part| Box::new(std::sync::Arc::clone(part)) as _)
                        .collect();
                    let _ = map_all(&Stack::new(parts), &mut moved);
                    Bounds::of(&moved)
                })
                .map_err(Failure::new)?;
            let shape = if S::DIM == 2 {
                "a square from -1 to 1 (name a model with --model)"
            } else {
                "a cube from -1 to 1 (name a model with --model)"
            };
            (built, points, shape.to_owned())
        }
    })
}

/// The verdicts on one recipe, as text and as JSON.
fn check_one<S: ModelSpace>(
    path: &Path,
    recipe: &Recipe,
    options: &CheckOptions,
    document: Option<&dyn Document>,
) -> Result<(String, Value), Failure> {
    let (built, points, on) = built_for::<S>(path, recipe, options, document)?;
    let all = promises(&built, &points, size(&points));
    let name = files::shown(path);
    let text = if all.is_empty() || built.parts.is_empty() {
        format!("{name} on {on}\nno warp: nothing moves\n")
    } else {
        format!("{name} on {on}\n{}", to_text(&all))
    };
    Ok((
        text,
        json!({ "recipe": name, "model": on, "warps": to_json(&all) }),
    ))
}

/// What there is to say of a motion.
fn check_motion(
    path: &Path,
    recipe: &Recipe,
    options: &CheckOptions,
) -> Result<(String, Value), Failure> {
    let beside = RecipeFiles::beside(path, options.allow_outside);
    let built = recipe.build_motion(Some(&beside)).map_err(Failure::new)?;
    let name = files::shown(path);
    let mut text = format!(
        "{name}\nmotion: {} along {}, {} units in {} seconds\n",
        built.orientation,
        built.family,
        files::short(built.motion.table().length()),
        files::short(built.motion.duration()),
    );
    let warnings = super::motion::warnings(&built);
    for warning in &warnings {
        text.push_str(&format!("  {warning}\n"));
    }
    if warnings.is_empty() {
        text.push_str("  no faults\n");
    }
    Ok((
        text,
        json!({ "recipe": name, "motion": super::motion::described(&built) }),
    ))
}

/// Points that fill the square or cube from −1 to 1 evenly.
fn stand_in<S: ModelSpace>() -> Vec<S> {
    const STEPS: usize = 17;
    let count = STEPS.pow(if S::DIM == 2 { 2 } else { 3 });
    (0..count)
        .map(|i| {
            let mut rest = i;
            S::from_fn(|_| {
                let step = rest % STEPS;
                rest /= STEPS;
                #[allow(clippy::cast_precision_loss)]
                {
                    2.0 * step as f64 / (STEPS - 1) as f64 - 1.0
                }
            })
        })
        .collect()
}

/// Whether two recipes may change places, as text and as JSON.
fn compare<S: ModelSpace>(
    recipes: [(&Path, &Recipe); 2],
    options: &CheckOptions,
    document: Option<&dyn Document>,
) -> Result<(String, Value), Failure> {
    let [first, second] = recipes;
    let names = [files::shown(first.0), files::shown(second.0)];
    if first.1.fingerprint() == second.1.fingerprint() {
        let found: Guarantee<S> = anamorph_core::guarantees::commutes_with_itself();
        let text = format!("{} and {}\n{}", names[0], names[1], line(&found));
        let value =
            json!({ "recipes": names, "guarantees": super::promises::guarantee_json(&found) });
        return Ok((text, value));
    }
    let (a, points, _) = built_for::<S>(first.0, first.1, options, document)?;
    let (b, _, _) = built_for::<S>(second.0, second.1, options, document)?;
    let points = super::promises::examined(&points);
    let found: Guarantee<S> = commutation(&a.stack(), &b.stack(), &points, size(&points));
    let text = format!("{} and {}\n{}", names[0], names[1], line(&found));
    let value = json!({ "recipes": names, "guarantees": super::promises::guarantee_json(&found) });
    Ok((text, value))
}

/// Two recipes of warps, compared on the model or on a stand-in. Recipes in different coordinates, and motions, are not.
fn compare_recipes(
    options: &CheckOptions,
    documents: &mut [Option<Box<dyn Document>>; 2],
) -> Result<Option<(String, Value)>, Failure> {
    let [first, second] = &options.recipes[..] else {
        return Ok(None);
    };
    let (a, _) = timed(read_recipe(first, &options.set)?, options)?;
    let (b, _) = timed(read_recipe(second, &options.set)?, options)?;
    if a.is_motion() || b.is_motion() || a.is_local() != b.is_local() {
        return Ok(None);
    }
    let document = documents[usize::from(a.is_local())].as_deref();
    let recipes = [(first.as_path(), &a), (second.as_path(), &b)];
    let plane = match document {
        Some(document) => matches!(document.points(), Points::Plane(_)),
        None => options.plane,
    };
    if !plane {
        match (compare::<Solid>(recipes, options, document), document) {
            (Err(_), None) => {}
            (found, _) => return found.map(Some),
        }
    }
    compare::<Plane>(recipes, options, document).map(Some)
}

/// One recipe, on the model or on a stand-in.
fn check_recipe(
    path: &Path,
    options: &CheckOptions,
    documents: &mut [Option<Box<dyn Document>>; 2],
) -> Result<(String, Value), Failure> {
    let (recipe, about) = timed(read_recipe(path, &options.set)?, options)?;
    if recipe.is_motion() {
        return check_motion(path, &recipe, options);
    }
    let (text, mut value) = check_warps(path, &recipe, options, documents)?;
    if about.is_empty() {
        return Ok((text, value));
    }
    value["notes"] = json!(about);
    let about: String = about.iter().map(|n| format!("note: {n}\n")).collect();
    Ok((format!("{text}{about}"), value))
}

/// The recipe at the time that is asked for, and what is to be said about times and directions.
fn timed(recipe: Recipe, options: &CheckOptions) -> Result<(Recipe, Vec<String>), Failure> {
    let mut about = Vec::new();
    if recipe.is_motion() {
        return Ok((recipe, about));
    }
    // Values of tracks are looked at before any frame is.
    let keyed = recipe.at_keys().map_err(Failure::new)?;
    for moment in keyed.iter().filter(|_| recipe.track_count() > 0) {
        let solid = moment.check_keys(&Solid::registry());
        if let (Err(error), Err(_)) = (solid, moment.check_keys(&Plane::registry())) {
            return Err(Failure::new(error));
        }
    }
    if recipe.is_inverse() {
        about.push(
            "`mapping = \"inverse\"`: these are promises of the warps as they are, not of what undoes them"
                .to_owned(),
        );
    }
    match options.time {
        Some(time) => Ok((recipe.at(time).map_err(Failure::new)?, about)),
        None => {
            if recipe.track_count() > 0 {
                about.push(
                    "the values of tracks are not in force here: look at a moment with --time, from 0 to 1"
                        .to_owned(),
                );
            }
            Ok((recipe, about))
        }
    }
}

/// The warps of a recipe, on the model or on a stand-in.
fn check_warps(
    path: &Path,
    recipe: &Recipe,
    options: &CheckOptions,
    documents: &mut [Option<Box<dyn Document>>; 2],
) -> Result<(String, Value), Failure> {
    let document = &mut documents[usize::from(recipe.is_local())];
    if let (Some(model), None) = (&options.model, &document) {
        let read_options = ReadOptions::default().local(recipe.is_local());
        *document = Some(read(model, &read_options, options.allow_outside)?);
    }
    let document = document.as_deref();
    let plane = match document {
        Some(document) => matches!(document.points(), Points::Plane(_)),
        None => options.plane,
    };
    if plane {
        return check_one::<Plane>(path, recipe, options, document);
    }
    match (
        check_one::<Solid>(path, recipe, options, document),
        document,
    ) {
        // Without a model a recipe that only makes sense in the plane is taken for one of the plane.
        (Err(failure), None) => {
            check_one::<Plane>(path, recipe, options, None).map_err(|_| failure)
        }
        (solid, _) => solid,
    }
}

pub(crate) fn run(options: &CheckOptions) -> Result<(), Failure> {
    files::at_most_one_stream(options.recipes.iter().chain(&options.model))?;
    // The model in world coordinates and in local ones, each read when a recipe asks for it.
    let mut documents: [Option<Box<dyn Document>>; 2] = [None, None];
    let mut out = std::io::stdout().lock();
    let (mut failed, mut all) = (false, Vec::new());
    for (number, path) in options.recipes.iter().enumerate() {
        let result = check_recipe(path, options, &mut documents);
        match result {
            Ok((text, value)) => {
                all.push(value);
                if !options.json {
                    let gap = if number > 0 { "\n" } else { "" };
                    write!(out, "{gap}{text}").map_err(|error| output(&error))?;
                }
            }
            Err(failure) => {
                failure.print();
                failed = true;
            }
        }
    }
    if !failed && !options.recipes.iter().any(|path| files::is_stream(path)) {
        match compare_recipes(options, &mut documents) {
            Ok(None) => {}
            Ok(Some((text, value))) => {
                all.push(value);
                if !options.json {
                    write!(out, "\n{text}").map_err(|error| output(&error))?;
                }
            }
            Err(failure) => {
                failure.print();
                failed = true;
            }
        }
    }
    if options.json {
        let text = serde_json::to_string_pretty(&all).map_err(Failure::new)?;
        writeln!(out, "{text}").map_err(|error| output(&error))?;
    }
    if failed {
        Err(Failure::Reported)
    } else {
        Ok(())
    }
}
