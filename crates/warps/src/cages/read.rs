//! Files of features as the parameters `source` and `target` name them.
//!
//! A file is read through the [`Context`]; its points are brought into the space of the model and held to the cage that is
//! expected. A cage that lost its comments or was saved with other objects is accepted, one with other points or wires is
//! not.
//!
//! *Source*: the notation is a decision.

use super::topology::{self, Expected};
use super::{CageKind, Said};
use anamorph_catalog::{ConstructError, Context, FeatureMesh};
use anamorph_core::Space;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A file that a parameter names.
pub(crate) struct Feature<S> {
    /// The parameter, for errors.
    key: &'static str,
    /// The file, as the recipe writes it.
    pub(crate) name: String,
    /// All its points.
    pub(crate) points: Vec<S>,
    /// What its comments say.
    pub(crate) said: Said,
    mesh: Arc<FeatureMesh>,
}

/// Refuses a file whose points are not finite, or do not lie in the space of the model; `path` is the parameter that names it.
pub(crate) fn expect_in_space<S: Space>(
    path: &str,
    name: &str,
    mesh: &FeatureMesh,
) -> Result<(), ConstructError> {
    let fail =
        |message: String, hint: &str| Err(ConstructError::new(path, message).with_hint(hint));
    if let Some(index) = mesh.points.iter().position(|point| !point.is_finite()) {
        let message = format!("v {} of {name} is not finite", index + 1);
        return fail(message, "write numbers, or export the file again");
    }
    if mesh.dimension < S::DIM {
        let message = format!("{name} lies in the plane, and the model in space");
        return fail(message, "give its points a third coordinate, z");
    }
    let largest = mesh.points.iter().map(|p| p.abs().max_element());
    let size = largest.fold(0.0, f64::max);
    let off = mesh.points.iter().position(|p| p.z.abs() > 1e-6 * size);
    if let (2, Some(index)) = (S::DIM, off) {
        let z = mesh.points[index].z;
        let message = format!(
            "v {} of {name} stands at z = {z}, and the model lies in the plane",
            index + 1
        );
        return fail(message, "move it back to z = 0");
    }
    Ok(())
}

/// The file that the parameter `key` names, if it names one.
pub(crate) fn load<S: Space>(
    key: &'static str,
    name: Option<&String>,
    context: &Context<'_, S>,
) -> Result<Option<Feature<S>>, ConstructError> {
    let Some(name) = name else {
        return Ok(None);
    };
    let mesh = context.mesh(key, name)?;
    expect_in_space::<S>(key, name, &mesh)?;
    Ok(Some(Feature {
        key,
        name: name.clone(),
        points: mesh
            .points
            .iter()
            .map(|p| S::from_fn(|axis| p[axis]))
            .collect(),
        said: Said::of(&mesh.comments),
        mesh,
    }))
}

/// The error of a parameter that is needed, in the words of a deserializer, so that it is shown like any other.
pub(crate) fn missing(key: &str) -> ConstructError {
    ConstructError::new("", format!("missing field `{key}`"))
}

impl<S: Space> Feature<S> {
    /// Its wires and the edges of its faces, each once.
    pub(crate) fn edges(&self) -> Vec<[u32; 2]> {
        let faces = self.mesh.triangles.iter();
        let around = faces.flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
        let all = self.mesh.lines.iter().copied().chain(around);
        let mut edges: Vec<[u32; 2]> = all.map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Refuses faces that join other points than those of `source` do; quadrilaterals may be cut along the other diagonal.
    /// Files without faces are not looked at.
    pub(crate) fn expect_faces_of(&self, source: &Self) -> Result<(), ConstructError> {
        let sides = |triangles: &[[u32; 3]]| {
            let mut sides: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
            for &[a, b, c] in triangles {
                for ([a, b], across) in [([a, b], c), ([b, c], a), ([c, a], b)] {
                    sides.entry([a.min(b), a.max(b)]).or_default().push(across);
                }
            }
            sides
        };
        let (own, theirs) = (sides(&self.mesh.triangles), sides(&source.mesh.triangles));
        if own.is_empty() || theirs.is_empty() {
            return Ok(());
        }
        let other_cut = |across: &[u32]| match *across {
            [c, d] => own.contains_key(&[c.min(d), c.max(d)]),
            _ => false,
        };
        let gone = theirs
            .iter()
            .find(|&(side, across)| !own.contains_key(side) && !other_cut(across));
        let Some(([a, b], _)) = gone else {
            return Ok(());
        };
        Err(self.fail(
            format!(
                "the faces of {} join other points than those of {}: v {} and v {} are not joined any more",
                self.name,
                source.name,
                u64::from(*a) + 1,
                u64::from(*b) + 1
            ),
            "keep every face, and export with the vertices in their order; exporters have a setting such as \"keep vertex order\"",
        ))
    }

    /// An error of this file.
    pub(crate) fn fail(
        &self,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> ConstructError {
        ConstructError::new(self.key, message).with_hint(hint)
    }

    /// Refuses a cage that says it is for another warp.
    pub(crate) fn expect_kind(&self, kind: &str) -> Result<(), ConstructError> {
        match self.said.kind.as_deref() {
            Some(said) if said != kind => {
                let message = format!("{} is a cage for `{said}`, not for `{kind}`", self.name);
                let options = match kind {
                    "lattice" => "--lattice",
                    "spline-lattice" => "--kind spline-lattice --lattice",
                    _ => "--frames",
                };
                Err(self.fail(
                    message,
                    format!("name the warp it is for, or make one with `anamorph cage {options}`"),
                ))
            }
            _ => Ok(()),
        }
    }

    /// The points that are the cage, in its order.
    pub(crate) fn cage(
        &self,
        origin: &str,
        count: usize,
        edges: &[[u32; 2]],
        near: &dyn Fn(u32, u32) -> bool,
    ) -> Result<Vec<S>, ConstructError> {
        let expected = Expected {
            count,
            edges,
            near,
            origin,
        };
        let first = topology::locate(&self.name, &self.mesh, &expected)
            .map_err(|(message, hint)| self.fail(message, hint))?;
        Ok(self.points[first..first + count].to_vec())
    }

    /// Where the points of this file, which are `target`, went from `source`. Coordinates that were only rounded did not
    /// move.
    pub(crate) fn settled(
        &self,
        origin: &str,
        source: &[S],
        target: &[S],
        edges: &[[u32; 2]],
    ) -> Result<Vec<S>, ConstructError> {
        let settled = topology::settle(source, target);
        if let Some((index, other)) = topology::reordered(source, &settled, edges) {
            let message = format!(
                "the points of {} are in another order than those of {origin}: v {} stands where v {} stood",
                self.name,
                index + 1,
                other + 1
            );
            return Err(self.fail(
                message,
                "export with the vertices in their order; exporters have a setting such as \"keep vertex order\"",
            ));
        }
        Ok(settled)
    }

    /// The points of this file, one for each of `source`, which come without an order of a cage.
    pub(crate) fn one_for_each(&self, source: &Self) -> Result<Vec<S>, ConstructError> {
        let sorted = |mesh: &FeatureMesh| {
            let mut edges: Vec<[u32; 2]> = mesh
                .lines
                .iter()
                .map(|&[a, b]| [a.min(b), a.max(b)])
                .collect();
            edges.sort_unstable();
            edges.dedup();
            edges
        };
        let (count, edges) = (source.points.len(), sorted(&source.mesh));
        if self.points.len() != count {
            let few = self.points.len() < count;
            return Err(self.fail(
                format!(
                    "{} has {} points where {} has {count}",
                    self.name,
                    self.points.len(),
                    source.name
                ),
                if few {
                    "keep every vertex: undo merging and deleting, then save it again"
                } else {
                    "give both files the same points in the same order; what was added to one belongs into both"
                },
            ));
        }
        if !edges.is_empty() && !self.mesh.lines.is_empty() {
            self.cage(&source.name, count, &edges, &|_, _| true)?;
        }
        self.settled(&source.name, &source.points, &self.points, &edges)
    }
}

impl CageKind {
    /// Whether two points may be corners of a face: in one cell of the grid, or of one frame.
    pub(crate) fn near<S: Space>(self, shape: [usize; 3]) -> impl Fn(u32, u32) -> bool {
        move |a, b| {
            let (a, b) = (a as usize, b as usize);
            if self == Self::Frames {
                let step = S::DIM + 1;
                return a / step == b / step;
            }
            let triple = |flat: usize| {
                let rest = flat / shape[2];
                [rest / shape[1], rest % shape[1], flat % shape[2]]
            };
            let (a, b) = (triple(a), triple(b));
            (0..3).all(|axis| a[axis].abs_diff(b[axis]) <= 1)
        }
    }
}
