//! Features that recipes keep in files: points and wires that someone edits in a modeller.

use anamorph_core::glam::DVec3;
use std::sync::Arc;

/// What a file of features holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FeatureMesh {
    /// Number of coordinates the file gives a point: 2 or 3.
    pub dimension: usize,
    /// The points in file order; z is 0 where the file has none.
    pub points: Vec<DVec3>,
    /// Segments of its wires, by the points' indices from 0.
    pub lines: Vec<[u32; 2]>,
    /// Its faces cut into triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Its comments, a line each, without the signs that make them one.
    pub comments: Vec<String>,
}

/// The files that a recipe may name. Libraries open none: whoever builds the recipe offers them.
pub trait Meshes {
    /// The content of the file called `name`, as written in the recipe: relative to the recipe's folder.
    ///
    /// # Errors
    /// One sentence that names the file, says what is wrong, and how to mend it.
    fn mesh(&self, name: &str) -> Result<Arc<FeatureMesh>, String>;
}
