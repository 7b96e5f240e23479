//! `anamorph gallery`: a page of every warp on a real model.
//!
//! Everything on the page is made from what the program knows: the recipes of the documentation, the registries, the
//! guarantees it derives. The page is static and needs no network.

mod curves;
mod images;
mod lengths;
mod motions;
mod page;
mod plots;
mod scenes;
mod shapes;

use crate::arguments::GalleryOptions;
use crate::commands::promises::{Promises, promises};
use crate::error::{Failure, say};
use crate::files::{self, Pending};
use crate::meshes::RecipeFiles;
use crate::model::{self, ModelSpace};
use crate::picture::{self, Subject};
use crate::progress::Progress;
use anamorph_core::{Plane, Solid, map_all_parallel};
use anamorph_io::{Document, Points, ReadOptions};
use anamorph_preview::{Options, Theme};
use anamorph_recipe::Recipe;
use scenes::{PARTS, Scene};
use std::path::Path;

/// A scene with all that the page says of it.
struct Shown {
    scene: &'static Scene,
    /// Kinds of its warps, in their order.
    kinds: Vec<String>,
    /// Where the paper has it; empty for what it does not know.
    figure: String,
    summary: String,
    reference: String,
    /// Verdict, property and statement of each promise, warp by warp.
    promises: Vec<Promised>,
    /// Names of its pictures in the light and in the dark.
    pictures: [String; 2],
    size: (u32, u32),
}

/// The promises of one warp.
struct Promised {
    title: String,
    rows: Vec<[String; 3]>,
    notes: Vec<String>,
}

/// What a warp of that kind is, in the words of its registry entry.
fn described<S: ModelSpace>(kind: &str) -> [String; 3] {
    let registry = S::registry();
    let entry = registry.warps.iter().find(|entry| entry.kind == kind);
    entry.map_or_else(Default::default, |e| {
        [e.figure, e.summary, e.reference].map(str::to_owned)
    })
}

fn promised<S: ModelSpace>(promises: &[Promises<S>]) -> Vec<Promised> {
    let all = promises.iter();
    all.map(|p| Promised {
        title: p.title.clone(),
        rows: p
            .guarantees
            .iter()
            .map(|g| {
                let names = [g.verdict.name().to_owned(), g.property.name().to_owned()];
                let [verdict, property] = names;
                [verdict, property, g.statement.clone()]
            })
            .collect(),
        notes: p.notes.clone(),
    })
    .collect()
}

/// Warps the scene's model, draws it twice, and begins the files of the pictures.
fn show<S: ModelSpace>(
    scene: &'static Scene,
    document: &dyn Document,
    folder: &Path,
    options: &GalleryOptions,
    files: &mut Vec<Pending>,
) -> Result<Shown, Failure> {
    let failed = |what: &str| Failure::new(format!("gallery: {}: {what}", scene.name));
    let recipe = Recipe::read(scene.recipe.as_bytes(), scene.name).map_err(Failure::new)?;
    let rest = S::points(document.points()).unwrap_or_default();
    let built = model::build(&recipe, document, rest, &RecipeFiles::embedded(scene.files))?;
    let mut moved = rest.to_vec();
    if !map_all_parallel(&built.stack(), &mut moved, &|_| {}).is_empty() {
        return Err(failed("a point could not be moved"));
    }
    let subject = Subject::new(document, rest, &moved, &built);
    let mut pictures = [String::new(), String::new()];
    for (name, theme) in pictures.iter_mut().zip([Theme::Light, Theme::Dark]) {
        let drawn = Options {
            width: options.size.0,
            height: options.size.1,
            theme,
            camera: picture::camera(scene.side),
            ..Options::default()
        };
        let picture = subject.draw(&drawn).and_then(|picture| picture.png());
        let png = picture.map_err(|error| failed(&error.to_string()))?;
        let suffix = if theme == Theme::Dark { "-dark" } else { "" };
        *name = format!("images/{}{suffix}.png", scene.name);
        let mut file = Pending::create(&folder.join(&name), options.force)?;
        file.fill(|out| out.write_all(&png))?;
        files.push(file);
    }
    let kinds: Vec<String> = built
        .parts
        .iter()
        .map(|part| part.kind.to_owned())
        .collect();
    let [figure, summary, reference] = match kinds.as_slice() {
        [kind] => described::<S>(kind),
        _ => [
            String::new(),
            "several warps, one after the other".to_owned(),
            String::new(),
        ],
    };
    Ok(Shown {
        scene,
        kinds,
        figure: scene.figure.map_or(figure, str::to_owned),
        summary,
        reference,
        promises: promised(&promises(&built, rest, model::size(rest))),
        pictures,
        size: options.size,
    })
}

pub(crate) fn run(options: &GalleryOptions) -> Result<(), Failure> {
    let trial = Options {
        width: options.size.0,
        height: options.size.1,
        ..Options::default()
    };
    trial
        .check()
        .map_err(|error| Failure::usage(format!("--size: {error}")))?;
    if files::is_stream(&options.out) {
        return Err(Failure::usage("a gallery is a folder; name one with --out"));
    }
    let index = options.out.join("index.html");
    let markdown = options.out.join("gallery.md");
    if options.out.is_dir() {
        files::refuse_existing(&index, options.force)?;
        if options.markdown {
            files::refuse_existing(&markdown, options.force)?;
        }
    }
    let mut made = files::make_folder(&options.out)?;
    let result = files::make_folder(&options.out.join("images")).and_then(|more| {
        made.extend(more);
        draw(options, &index, &markdown)
    });
    files::remove_empty(&made);
    result
}

fn draw(options: &GalleryOptions, index: &Path, markdown: &Path) -> Result<(), Failure> {
    let scenes: usize = PARTS.iter().map(|part| part.scenes.len()).sum();
    let count = scenes + motions::SCENES.len() + images::SCENES.len() + shapes::SCENES.len();
    let progress = Progress::new("drawing", count, options.quiet);
    let mut files = Vec::new();
    let mut parts = Vec::new();
    for part in PARTS {
        let mut shown = Vec::new();
        for scene in part.scenes {
            let exhibit = scene.exhibit;
            let read = ReadOptions::default();
            let document = anamorph_io::read(exhibit.bytes.to_vec(), Some(exhibit.file), &read)
                .map_err(|error| Failure::new(format!("gallery: {}: {error}", exhibit.file)))?;
            let document = document.as_ref();
            let folder = options.out.as_path();
            shown.push(match document.points() {
                Points::Plane(_) => show::<Plane>(scene, document, folder, options, &mut files)?,
                Points::Solid(_) => show::<Solid>(scene, document, folder, options, &mut files)?,
            });
            progress.add(1);
        }
        parts.push((part, shown));
    }
    let mut moving = Vec::new();
    for scene in motions::SCENES {
        moving.push(motions::show(scene, options, &mut files)?);
        progress.add(1);
    }
    let mut pixels = Vec::new();
    for scene in images::SCENES {
        pixels.push(images::show(scene, options, &mut files)?);
        progress.add(1);
    }
    let mut between = Vec::new();
    for scene in shapes::SCENES {
        between.push(shapes::show(scene, options, &mut files)?);
        progress.add(1);
    }
    drop(progress);
    let mut pages = vec![(
        index.to_owned(),
        page::html(&parts, &pixels, &between, &moving),
    )];
    if options.markdown {
        pages.extend([
            (
                markdown.to_owned(),
                page::markdown(&parts, &pixels, &between, &moving),
            ),
            (options.out.join("curves.md"), lengths::markdown()),
            (options.out.join("images/arc-length.svg"), lengths::svg()),
        ]);
    }
    for (path, text) in &pages {
        let mut file = Pending::create(path, options.force)?;
        file.fill(|out| out.write_all(text.as_bytes()))?;
        files.push(file);
    }
    files::keep_all(files)?;
    if !options.quiet {
        say!("{count} scenes -> {}", index.display());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// The kinds that the scenes' recipes name.
    fn shown_kinds() -> BTreeSet<String> {
        let scenes = PARTS.iter().flat_map(|part| part.scenes);
        let recipes = scenes.map(|scene| Recipe::read(scene.recipe.as_bytes(), scene.name));
        let mut kinds = BTreeSet::new();
        for recipe in recipes {
            kinds.extend(recipe.unwrap().kinds().iter().map(|&kind| kind.to_owned()));
        }
        kinds
    }

    #[test]
    fn every_registered_warp_is_shown() {
        let shown = shown_kinds();
        let plane = Plane::registry().warps;
        let solid = Solid::registry().warps;
        let names = plane
            .iter()
            .map(|e| e.kind)
            .chain(solid.iter().map(|e| e.kind));
        for kind in names {
            assert!(shown.contains(kind), "`{kind}` is not in the gallery");
        }
    }

    #[test]
    fn every_recipe_of_the_documentation_is_shown() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/recipes");
        let scenes = PARTS.iter().flat_map(|part| part.scenes);
        let moving = motions::SCENES.iter().map(|scene| scene.name);
        let scenes: BTreeSet<&str> = scenes.map(|scene| scene.name).chain(moving).collect();
        for file in std::fs::read_dir(folder).unwrap() {
            let path = file.unwrap().path();
            if path.extension().is_some_and(|e| e == "toml") {
                let name = path.file_stem().unwrap().to_string_lossy().into_owned();
                assert!(
                    scenes.contains(name.as_str()),
                    "{name} is not in the gallery"
                );
            }
        }
    }
}
