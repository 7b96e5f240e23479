//! A model file and a recipe brought together in the model's space.

use crate::companions::Folder;
use crate::error::Failure;
use crate::files;
use crate::meshes::RecipeFiles;
use anamorph::registry;
use anamorph_catalog::{Attributes, Context};
use anamorph_core::{Bounds, Deformation, Plane, Solid, Space, Stack, map_all_parallel};
use anamorph_io::{Document, Points, ReadOptions};
use anamorph_recipe::{BuiltRecipe, Recipe, Registry};
use std::path::Path;
use std::sync::Arc;

/// A space that models come in.
pub(crate) trait ModelSpace: anamorph_preview::Drawable {
    fn registry() -> Registry<Self>;
    /// The points of a document of this space.
    fn points<'a>(points: Points<'a>) -> Option<&'a [Self]>;
    fn wrap(points: &[Self]) -> Points<'_>;
}

impl ModelSpace for Plane {
    fn registry() -> Registry<Self> {
        registry::plane()
    }
    fn points<'a>(points: Points<'a>) -> Option<&'a [Self]> {
        match points {
            Points::Plane(points) => Some(points),
            Points::Solid(_) => None,
        }
    }
    fn wrap(points: &[Self]) -> Points<'_> {
        Points::Plane(points)
    }
}

impl ModelSpace for Solid {
    fn registry() -> Registry<Self> {
        registry::solid()
    }
    fn points<'a>(points: Points<'a>) -> Option<&'a [Self]> {
        match points {
            Points::Solid(points) => Some(points),
            Points::Plane(_) => None,
        }
    }
    fn wrap(points: &[Self]) -> Points<'_> {
        Points::Solid(points)
    }
}

/// Reads a model file, and the files in its folder that it refers to; others only where that is allowed.
pub(crate) fn read(
    path: &Path,
    options: &ReadOptions,
    allow_outside: bool,
) -> Result<Box<dyn Document>, Failure> {
    document(files::read(path)?, path, options, allow_outside)
}

/// The same of bytes that have been read already.
pub(crate) fn document(
    bytes: Vec<u8>,
    path: &Path,
    options: &ReadOptions,
    allow_outside: bool,
) -> Result<Box<dyn Document>, Failure> {
    let name = path
        .file_name()
        .map(|name| name.to_string_lossy().into_owned());
    let name = if files::is_stream(path) { None } else { name };
    let folder = Folder::of(path, allow_outside);
    anamorph_io::read_with(bytes, name.as_deref(), options, &folder)
        .map_err(|error| Failure::new(format!("{}: {error}", files::shown(path))))
}

/// Reads a recipe and applies `--set` arguments.
pub(crate) fn read_recipe(path: &Path, set: &[String]) -> Result<Recipe, Failure> {
    let bytes = files::read(path)?;
    let mut recipe = Recipe::read(&bytes, &files::shown(path)).map_err(Failure::new)?;
    for argument in set {
        recipe.set(argument).map_err(Failure::new)?;
    }
    Ok(recipe)
}

/// A document's attributes as recipes read them.
struct DocumentAttributes<'a>(&'a dyn Document);

impl Attributes for DocumentAttributes<'_> {
    fn attribute(&self, name: &str) -> Option<Arc<[f64]>> {
        self.0.attribute(name).map(Arc::from)
    }
    fn names(&self) -> Vec<String> {
        self.0.attributes()
    }
}

/// Builds a recipe for a document's points.
pub(crate) fn build<S: ModelSpace>(
    recipe: &Recipe,
    document: &dyn Document,
    points: &[S],
    files: &RecipeFiles,
) -> Result<BuiltRecipe<S>, Failure> {
    let attributes = DocumentAttributes(document);
    let visible = document.visible().min(points.len());
    let context = Context {
        bounds: Bounds::of(&points[..visible]),
        scaling: None,
        attributes: Some(&attributes),
        meshes: Some(files),
    };
    // The model as it arrives at a later warp; each call moves it on by the parts that are new.
    let mut moved: Option<(usize, Vec<S>)> = None;
    let mut bounds_after = |parts: &[Arc<dyn Deformation<S>>]| {
        let (done, points) = moved.get_or_insert_with(|| (0, points.to_vec()));
        let new: Vec<Box<dyn Deformation<S>>> = parts[(*done).min(parts.len())..]
            .iter()
            .map(|part| Box::new(Arc::clone(part)) as _)
            .collect();
        *done = parts.len();
        let _ = map_all_parallel(&Stack::new(new), points, &|_| {});
        Bounds::of(&points[..visible])
    };
    recipe
        .build(&S::registry(), &context, &mut bounds_after)
        .map_err(Failure::new)
}

/// Whether a recipe that can be built for a document cannot be without its bounds.
pub(crate) fn is_relative<S: ModelSpace>(
    recipe: &Recipe,
    document: &dyn Document,
    _: &[S],
    files: &RecipeFiles,
) -> bool {
    let attributes = DocumentAttributes(document);
    let context = Context::<S> {
        bounds: None,
        scaling: None,
        attributes: Some(&attributes),
        meshes: Some(files),
    };
    recipe
        .build(&S::registry(), &context, &mut |_| None)
        .is_err()
}

/// The size of a model: the diagonal of its bounds, or 1 if it has none.
pub(crate) fn size<S: Space>(points: &[S]) -> f64 {
    Bounds::of(points)
        .map_or(1.0, |bounds| bounds.diagonal())
        .max(f64::MIN_POSITIVE)
}
