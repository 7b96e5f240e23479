//! Normals computed again from moved faces.
//!
//! *Source*: G. Thürmer and C. A. Wüthrich, "Computing Vertex Normals from Polygonal Facets", Journal of Graphics Tools
//! 3(1), 1998. A glTF splits a vertex where its faces differ in anything; vertices that were at one place with one normal
//! count as one, so that what was smooth stays smooth.

use super::Model;
use super::content::{Frame, Movement, same};
use super::scene::Instance;
use crate::normals::{Mean, angle, unit, unit_normal};
use anamorph_core::glam::DVec3;
use std::collections::HashMap;

/// New normals of an instance, for each pair of a slot and an accessor of normals.
pub(super) struct Recomputed {
    pairs: HashMap<(usize, usize), Vec<Found>>,
}

/// `None`: nothing bears on it; `Some(None)`: there is no direction.
type Found = Option<Option<DVec3>>;

/// The faces around vertices that count as one.
#[derive(Clone, Copy, Default)]
struct Around {
    mean: Mean,
    touched: bool,
}

/// Vertices of some pairs of slot and normals, and which of them count as one.
struct Groups {
    /// The pairs with the group of each vertex.
    pairs: Vec<((usize, usize), Vec<usize>)>,
    count: usize,
}

fn groups(movement: &Movement<'_>, instance: &Instance, only: Option<usize>) -> Groups {
    let model = movement.model;
    let mesh = &model.meshes[instance.mesh];
    let mut known: HashMap<([u64; 3], [u32; 3]), usize> = HashMap::new();
    let mut pairs: Vec<((usize, usize), Vec<usize>)> = Vec::new();
    for primitive in &mesh.primitives {
        let (Some(slot), Some(normal)) = (primitive.slot, primitive.normal) else {
            continue;
        };
        if only.is_some_and(|only| only != slot) || pairs.iter().any(|p| p.0 == (slot, normal)) {
            continue;
        }
        let normals: Vec<[f32; 3]> = model.accessors[normal].elements(&movement.data);
        let start = instance.starts[slot];
        let found = normals.iter().enumerate().map(|(i, normal)| {
            let place = model.points[start + i]
                .to_array()
                .map(|x| (x + 0.0).to_bits());
            let next = known.len();
            *known
                .entry((place, normal.map(|x| (x + 0.0).to_bits())))
                .or_insert(next)
        });
        pairs.push(((slot, normal), found.collect()));
    }
    Groups {
        pairs,
        count: known.len(),
    }
}

/// Adds up the faces of an instance where `new` puts its vertices; `moved` says which of them count as moved.
fn around(
    model: &Model,
    instance: &Instance,
    groups: &Groups,
    new: impl Fn(usize, usize) -> DVec3,
    moved: impl Fn(usize, usize) -> bool,
) -> Vec<Around> {
    let mesh = &model.meshes[instance.mesh];
    let mut all = vec![Around::default(); groups.count];
    for primitive in &mesh.primitives {
        let (Some(slot), Some(normal)) = (primitive.slot, primitive.normal) else {
            continue;
        };
        let Some((_, group)) = groups.pairs.iter().find(|p| p.0 == (slot, normal)) else {
            continue;
        };
        let Some(corners) = model.corners(primitive, group.len()) else {
            continue;
        };
        for face in Model::primitive_triangles(primitive, &corners) {
            let points = face.map(|v| new(slot, v as usize));
            let touched = face.iter().any(|v| moved(slot, *v as usize));
            let direction = unit_normal(&[0, 1, 2], &points);
            for (i, v) in face.iter().enumerate() {
                let around = &mut all[group[*v as usize]];
                around.touched |= touched;
                if let Some(direction) = direction {
                    around.mean.add(direction, angle(&[0, 1, 2], i, &points));
                }
            }
        }
    }
    all
}

/// The mean as the mesh stores it.
fn stored(around: &Around, frame: &Frame) -> Found {
    around.touched.then(|| {
        let mean = around.mean.result()?;
        let back = unit(frame.normal_back(mean))?;
        Some(if frame.mirrors() { -back } else { back })
    })
}

impl Recomputed {
    pub(super) fn of(movement: &Movement<'_>, instance: &Instance, frame: &Frame) -> Self {
        let groups = groups(movement, instance, None);
        let point = |slot: usize, v: usize| instance.starts[slot] + v;
        let all = around(
            movement.model,
            instance,
            &groups,
            |slot, v| movement.new[point(slot, v)],
            |slot, v| {
                let i = point(slot, v);
                !same(movement.model.points[i], movement.new[i])
            },
        );
        let pairs = groups.pairs.iter().map(|(pair, group)| {
            let found = group.iter().map(|g| stored(&all[*g], frame));
            (*pair, found.collect())
        });
        Self {
            pairs: pairs.collect(),
        }
    }

    pub(super) fn get(&self, slot: usize, accessor: usize, vertex: usize) -> Found {
        *self.pairs.get(&(slot, accessor))?.get(vertex)?
    }

    /// New deltas of a target's normals: the normals of the morphed shape less those of the shape itself, both moved;
    /// `None` where the target moves no face, or no face moves.
    pub(super) fn deltas(
        &self,
        movement: &Movement<'_>,
        instance: &Instance,
        frame: &Frame,
        slot: usize,
        shadow: Option<usize>,
        base: usize,
    ) -> Vec<Option<DVec3>> {
        let Some(shadow) = shadow else {
            return Vec::new();
        };
        let model = movement.model;
        let vertices = &model.meshes[instance.mesh].shadows[shadow].vertices;
        let start = instance.starts[slot];
        let place = |v: usize| match vertices.binary_search(&(v as u32)) {
            Ok(k) => instance.shadow_starts[shadow] + k,
            Err(_) => start + v,
        };
        let groups = groups(movement, instance, Some(slot));
        let morphed = around(
            model,
            instance,
            &groups,
            |_, v| movement.new[place(v)],
            |_, v| place(v) != start + v,
        );
        let plain = around(
            model,
            instance,
            &groups,
            |_, v| movement.new[start + v],
            |_, _| true,
        );
        let Some((_, group)) = groups.pairs.iter().find(|p| p.0 == (slot, base)) else {
            return Vec::new();
        };
        group
            .iter()
            .enumerate()
            .map(|(v, g)| {
                // Where the faces stand still, so do the deltas.
                self.get(slot, base, v)?;
                let to = stored(&morphed[*g], frame)??;
                let from = stored(&plain[*g], frame)??;
                Some(to - from)
            })
            .collect()
    }
}
