//! Entries, what they build, and what they are told about the model.

use crate::{ConstructError, FeatureMesh, Meshes, Value};
use anamorph_core::{Bounds, Field, Mark, Scaling, Space, Warp};
use schemars::{Schema, SchemaGenerator};
use std::sync::Arc;

/// One plug-in of a catalogue, over the space `S`, building a `T`.
pub struct Entry<S: Space, T> {
    /// The word a recipe uses, in lower case with hyphens.
    pub kind: &'static str,
    /// The row of the inventory of systems it covers, such as `B3`; empty for ingredients.
    pub system: &'static str,
    /// Where Milliron et al., *A Framework for Geometric Warps and Deformations*, 2002, has it: section and figure; empty for
    /// ingredients and for warps that the paper does not know.
    pub figure: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
    /// Where it comes from: authors, title, venue, year.
    pub reference: &'static str,
    /// A complete example of its parameters as TOML, without the `kind` key; valid for any model of the space.
    pub example: &'static str,
    /// The JSON Schema of its parameters, without `kind`; what it refers to is defined in the generator.
    pub schema: fn(&mut SchemaGenerator) -> Schema,
    /// Builds it from its parameters, without `kind`.
    pub construct: fn(&Value, &Context<'_, S>) -> Result<T, ConstructError>,
}

// Derives would ask for `S: Clone` and `T: Clone`.
impl<S: Space, T> Clone for Entry<S, T> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Space, T> Copy for Entry<S, T> {}

/// A registered warp.
pub type WarpEntry<S> = Entry<S, Built<S>>;
/// A registered field.
pub type FieldEntry<S> = Entry<S, Box<dyn Field<S>>>;

/// A constructed warp and how to draw it.
pub struct Built<S: Space> {
    /// The warp.
    pub warp: Box<dyn Warp<S>>,
    /// Its features and guides.
    pub marks: Vec<Mark<S>>,
    /// How it is built again with other targets, if its images are linear in them.
    pub refit: Option<Refit<S>>,
    /// Its features, and how it is built again between others, if it is made of pairs of features.
    pub features: Option<Features<S>>,
}

impl<S: Space> Built<S> {
    /// A warp that cannot be fitted.
    pub fn new(marks: Vec<Mark<S>>, warp: Box<dyn Warp<S>>) -> Self {
        Self {
            warp,
            marks,
            refit: None,
            features: None,
        }
    }

    /// The warp as one between features.
    #[must_use]
    pub fn between(mut self, features: Features<S>) -> Self {
        self.features = Some(features);
        self
    }

    /// The warp as one that can be fitted: `targets` features, built again by `with` from a displacement to be added to the target of each.
    #[must_use]
    pub fn fitted_by(
        mut self,
        targets: usize,
        with: impl Fn(&[S]) -> Result<Built<S>, ConstructError> + 'static,
    ) -> Self {
        self.refit = Some(Refit {
            targets,
            with: Box::new(with),
        });
        self
    }
}

/// Builds a warp again, each of its targets moved by a displacement.
pub type WithTargets<S> = dyn Fn(&[S]) -> Result<Built<S>, ConstructError>;

/// How a warp whose images are linear in its targets is built again with others.
pub struct Refit<S: Space> {
    /// How many targets it has.
    pub targets: usize,
    /// Builds it, from a displacement for each target.
    pub with: Box<WithTargets<S>>,
}

/// Builds a warp again between source and target features: as many as it has, of as many places each.
pub type Between<S> =
    dyn Fn(&[Vec<S>], &[Vec<S>]) -> Result<Box<dyn Warp<S>>, ConstructError> + Send + Sync;

/// The features of a warp, and how it is built again between others of the same kind. A morph asks for them: it moves the features from
/// source to target, and warps both ends to what is between.
pub struct Features<S: Space> {
    /// The places of each source feature: one for a point, two for a line, those of its corners for an element.
    pub sources: Vec<Vec<S>>,
    /// The places of each target feature.
    pub targets: Vec<Vec<S>>,
    /// Builds the warp between others.
    pub with: Box<Between<S>>,
}

/// What a construction may know about the model a recipe is for.
#[derive(Clone, Default)]
pub struct Context<'a, S: Space> {
    /// Bounds of the model's points, for parameters given as percentages and `"fit"`.
    pub bounds: Option<Bounds<S>>,
    /// The scaling method the recipe asks for; `None` leaves the plug-in's own.
    pub scaling: Option<Scaling>,
    /// Per-vertex attributes of the model by name.
    pub attributes: Option<&'a dyn Attributes>,
    /// The files that the recipe may name.
    pub meshes: Option<&'a dyn Meshes>,
}

/// Per-vertex attributes of a model.
pub trait Attributes {
    /// The values of an attribute, one a vertex.
    fn attribute(&self, name: &str) -> Option<Arc<[f64]>>;
    /// The names of all attributes.
    fn names(&self) -> Vec<String>;
}

impl<S: Space> Context<'_, S> {
    /// A context of a model with these bounds and nothing else.
    pub fn of_bounds(bounds: Bounds<S>) -> Self {
        Self {
            bounds: Some(bounds),
            ..Self::default()
        }
    }

    /// The content of a file that the parameter at `path` names.
    ///
    /// # Errors
    /// An error at `path` if the file cannot be had, or if the context has no files.
    pub fn mesh(&self, path: &str, name: &str) -> Result<Arc<FeatureMesh>, ConstructError> {
        let Some(meshes) = self.meshes else {
            let message = format!("this recipe reads {name}, but no files are at hand");
            return Err(ConstructError::new(path, message)
                .with_hint("build it with files, or describe the feature in the recipe"));
        };
        meshes
            .mesh(name)
            .map_err(|message| ConstructError::new(path, message))
    }

    /// The bounds, or an error at `path` that says that a model is needed.
    pub fn bounds(&self, path: &str) -> Result<Bounds<S>, ConstructError> {
        self.bounds.ok_or_else(|| {
            ConstructError::new(
                path,
                "this is relative to the model, and no model was given",
            )
            .with_hint("name a model, or write an absolute number in scene units")
        })
    }
}
