//! The files that a recipe names: cages, frames and points, sought beside the recipe.

use crate::error::Failure;
use crate::files;
use anamorph_catalog::{FeatureMesh, Meshes};
use anamorph_core::glam::DVec3;
use anamorph_io::landmarks::Landmarks;
use anamorph_io::{Points, ReadOptions, drawings};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// How far into a file comments are looked for: those that matter stand at its beginning.
const HEAD: usize = 1 << 16;

type Read = Result<Arc<FeatureMesh>, String>;

/// The files beside a recipe. Each is read once.
pub(crate) struct RecipeFiles {
    folder: PathBuf,
    allow_outside: bool,
    known: Mutex<BTreeMap<String, Read>>,
    /// Fingerprints of the files that were read.
    prints: Mutex<BTreeMap<String, u64>>,
}

impl RecipeFiles {
    /// The files in the folder of a recipe; those of a recipe from standard input are in the current folder.
    pub(crate) fn beside(recipe: &Path, allow_outside: bool) -> Self {
        let folder = if files::is_stream(recipe) {
            Path::new(".")
        } else {
            files::folder_of(recipe)
        };
        Self {
            folder: folder.to_owned(),
            allow_outside,
            known: Mutex::default(),
            prints: Mutex::default(),
        }
    }

    /// Files that come with the program, by name.
    pub(crate) fn embedded(files: &[(&str, &[u8])]) -> Self {
        let known = files
            .iter()
            .map(|(name, bytes)| ((*name).to_owned(), parsed(name, bytes.to_vec())));
        Self {
            folder: PathBuf::from("."),
            allow_outside: false,
            known: Mutex::new(known.collect()),
            prints: Mutex::default(),
        }
    }

    /// The files that have been read, by name, with the fingerprints of their contents.
    pub(crate) fn fingerprints(&self) -> Vec<(String, u64)> {
        let prints = self.prints.lock().unwrap_or_else(PoisonError::into_inner);
        prints
            .iter()
            .map(|(name, &print)| (name.clone(), print))
            .collect()
    }

    /// Refuses to write to a file that the recipe has read.
    pub(crate) fn refuse_replacing<'a>(
        &self,
        results: impl IntoIterator<Item = &'a PathBuf>,
    ) -> Result<(), Failure> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        for result in results {
            if files::is_immediate(result) {
                continue;
            }
            let identity = files::identity(result);
            let mut names = known.keys();
            if names.any(|name| files::identity(&self.folder.join(name)) == identity) {
                return Err(Failure::usage(format!(
                    "{}: a result would replace a file that the recipe reads; choose another name",
                    result.display()
                )));
            }
        }
        Ok(())
    }

    fn read(&self, name: &str) -> Read {
        let path = files::inside_folder(&self.folder, name, self.allow_outside)?;
        let file = std::fs::metadata(&path).map_err(|error| {
            let mend = match error.kind() {
                std::io::ErrorKind::NotFound => format!(
                    "; names are relative to the recipe, which is in {}",
                    self.folder.display()
                ),
                kind => files::mend(kind).to_owned(),
            };
            format!("cannot read {name}: {error}{mend}")
        })?;
        if !file.is_file() {
            return Err(format!("{name} is no file; name a file"));
        }
        let bytes = files::read(&path).map_err(|failure| match failure {
            Failure::Message(text) => text,
            _ => format!("cannot read {name}"),
        })?;
        let mut prints = self.prints.lock().unwrap_or_else(PoisonError::into_inner);
        prints.insert(name.to_owned(), files::fingerprint(&bytes).0);
        drop(prints);
        parsed(name, bytes)
    }
}

/// A file as warps read it.
fn parsed(name: &str, bytes: Vec<u8>) -> Read {
    if name.to_ascii_lowercase().ends_with(".svg") || drawings::is_svg(&bytes) {
        return drawing(name, &bytes);
    }
    if Landmarks::are(&bytes) {
        let landmarks = Landmarks::read(&bytes).map_err(|error| format!("{name}: {error}"))?;
        return Ok(Arc::new(FeatureMesh {
            dimension: 2,
            points: landmarks.points.iter().map(|p| p.extend(0.0)).collect(),
            lines: landmarks.lines,
            ..FeatureMesh::default()
        }));
    }
    let comments = comments(&bytes);
    let document = anamorph_io::read(bytes, Some(name), &ReadOptions::default())
        .map_err(|error| format!("{name}: {error}"))?;
    let visible = document.visible();
    let points = match document.points() {
        Points::Plane(points) => points.iter().map(|p| p.extend(0.0)).take(visible).collect(),
        Points::Solid(points) => points.iter().take(visible).copied().collect::<Vec<DVec3>>(),
    };
    let mesh = document.mesh().unwrap_or_default();
    Ok(Arc::new(FeatureMesh {
        dimension: document.points().dimension(),
        points,
        lines: mesh.lines,
        triangles: mesh.triangles,
        comments,
    }))
}

/// Flattening of a drawing's curves, as a share of its extent.
const FLATTENED: f64 = 1e-5;

/// The polylines of a drawing, in the plane z = 0.
fn drawing(name: &str, bytes: &[u8]) -> Read {
    let drawing =
        drawings::polylines(bytes, FLATTENED).map_err(|error| format!("{name}: {error}"))?;
    Ok(Arc::new(FeatureMesh {
        dimension: 3,
        points: drawing.points.iter().map(|p| p.extend(0.0)).collect(),
        lines: drawing.lines,
        ..FeatureMesh::default()
    }))
}

/// The comments at the beginning of a file of text.
fn comments(bytes: &[u8]) -> Vec<String> {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]);
    head.lines()
        .filter_map(|line| {
            let line = line.trim_start();
            line.strip_prefix('#')
                .or_else(|| line.strip_prefix("comment "))
        })
        .map(|line| line.trim().to_owned())
        .collect()
}

impl Meshes for RecipeFiles {
    fn mesh(&self, name: &str) -> Read {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known
            .entry(name.to_owned())
            .or_insert_with(|| self.read(name))
            .clone()
    }
}
