//! Triangles, lines and points of primitives, and what hangs on vertices.
//!
//! *Source*: Khronos Group, *glTF 2.0 Specification*, 2021, section 3.7.2.1 "Overview" (of primitives) and section 3.7.4
//! "Instantiation": where a node mirrors its mesh, triangles run the other way.

use super::Model;
use super::scene::{Instance, Primitive};
use crate::Mesh;
use anamorph_core::math;

/// Triangles of a strip, fan or list of `n` corners, as numbers of corners.
fn triangles(mode: usize, n: usize) -> impl Iterator<Item = [usize; 3]> {
    let count = match mode {
        4 => n / 3,
        5 | 6 => n.saturating_sub(2),
        _ => 0,
    };
    (0..count).map(move |i| match mode {
        4 => [3 * i, 3 * i + 1, 3 * i + 2],
        5 if i % 2 == 1 => [i + 1, i, i + 2],
        5 => [i, i + 1, i + 2],
        _ => [0, i + 1, i + 2],
    })
}

/// Segments of lines, a loop or a strip of `n` corners, as numbers of corners.
fn segments(mode: usize, n: usize) -> impl Iterator<Item = [usize; 2]> {
    let count = match mode {
        1 => n / 2,
        2 if n > 2 => n,
        2 | 3 => n.saturating_sub(1),
        _ => 0,
    };
    (0..count).map(move |i| match mode {
        1 => [2 * i, 2 * i + 1],
        _ => [i, (i + 1) % n],
    })
}

impl Model {
    /// Vertices of the corners of a primitive, counted from its first; `None` where one does not exist.
    pub(super) fn corners(&self, primitive: &Primitive, count: usize) -> Option<Vec<u32>> {
        match primitive.indices {
            None => Some((0..count as u32).collect()),
            Some(accessor) => {
                let corners = self.accessors[accessor].indices(&self.data());
                corners
                    .iter()
                    .all(|v| (*v as usize) < count)
                    .then_some(corners)
            }
        }
    }

    /// Primitives of an instance whose corners exist, with the number of the first point; and the number of the others.
    fn primitives(
        &self,
        instance: &Instance,
        mut each: impl FnMut(&Primitive, u32, &[u32]),
    ) -> u64 {
        let mesh = &self.meshes[instance.mesh];
        let mut broken = 0;
        for primitive in &mesh.primitives {
            let Some(slot) = primitive.slot else {
                continue;
            };
            let count = self.accessors[mesh.slots[slot]].count;
            match self.corners(primitive, count) {
                Some(corners) => each(primitive, instance.starts[slot] as u32, &corners),
                None => broken += 1,
            }
        }
        broken
    }

    /// Triangles of a primitive in terms of the vertices of its corners.
    pub(super) fn primitive_triangles(primitive: &Primitive, corners: &[u32]) -> Vec<[u32; 3]> {
        if primitive.mode == 4 {
            return corners
                .chunks_exact(3)
                .map(|t| [t[0], t[1], t[2]])
                .collect();
        }
        triangles(primitive.mode, corners.len())
            .map(|t| t.map(|i| corners[i]))
            .collect()
    }
}

/// All elements of all instances, and the number of primitives left out because a corner does not exist.
pub(super) fn all(model: &Model) -> (Mesh, u64) {
    let mut out = Mesh::default();
    let mut broken = 0;
    for instance in &model.instances {
        let mirrored = instance
            .world
            .is_some_and(|world| world.matrix3.determinant() < 0.0);
        broken += model.primitives(instance, |primitive, first, corners| {
            let found = Model::primitive_triangles(primitive, corners);
            out.triangles.extend(found.into_iter().map(|t| {
                let [a, b, c] = t.map(|v| v + first);
                if mirrored { [a, c, b] } else { [a, b, c] }
            }));
            let found = segments(primitive.mode, corners.len());
            out.lines
                .extend(found.map(|s| s.map(|i| corners[i] + first)));
            if primitive.mode == 0 {
                out.points.extend(corners.iter().map(|v| v + first));
            }
        });
    }
    out.faces = out.triangles.len();
    (out, broken)
}

pub(super) fn mesh(model: &Model) -> Option<Mesh> {
    let (mesh, _) = all(model);
    let empty = mesh.triangles.is_empty() && mesh.lines.is_empty() && mesh.points.is_empty();
    (!empty).then_some(mesh)
}

const COLOURS: [&str; 4] = ["red", "green", "blue", "alpha"];

fn all_primitives(model: &Model) -> impl Iterator<Item = &Primitive> {
    let primitives = model.meshes.iter().flat_map(|mesh| &mesh.primitives);
    primitives.filter(|primitive| primitive.slot.is_some())
}

pub(super) fn attributes(model: &Model) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    let colours = all_primitives(model).filter_map(|primitive| primitive.colour);
    let width = colours.map(|colour| model.accessors[colour].width).max();
    let known = match width {
        Some(4) => 4,
        Some(_) => 3,
        None => 0,
    };
    names.extend(COLOURS[..known].iter().map(|name| (*name).to_owned()));
    let mut own: Vec<&String> = all_primitives(model)
        .flat_map(|primitive| primitive.scalars.iter().map(|(name, _)| name))
        .collect();
    own.sort_unstable();
    own.dedup();
    names.extend(own.into_iter().cloned());
    names
}

/// The stored, linear light as the numbers that pictures hold (IEC 61966-2-1, sRGB).
fn encoded(linear: f64) -> f64 {
    if linear > 0.003_130_8 {
        1.055 * math::pow(linear, 1.0 / 2.4) - 0.055
    } else {
        12.92 * linear
    }
}

/// Values of an attribute, one a point. Vertices of primitives that have none are white, or 0 in an attribute of the
/// application's own; where several primitives share vertices, the first that has the attribute counts.
pub(super) fn attribute(model: &Model, name: &str) -> Option<Vec<f64>> {
    if !attributes(model).iter().any(|known| known == name) {
        return None;
    }
    let channel = COLOURS.iter().position(|colour| *colour == name);
    let accessor = |primitive: &Primitive| match channel {
        Some(_) => primitive.colour,
        None => {
            let mut own = primitive.scalars.iter();
            own.find(|(known, _)| known == name).map(|(_, at)| *at)
        }
    };
    let none = if channel.is_some() { 1.0 } else { 0.0 };
    let data = model.data();
    let mut out = vec![none; model.points.len()];
    for instance in &model.instances {
        let mesh = &model.meshes[instance.mesh];
        let mut done = vec![false; mesh.slots.len()];
        for primitive in &mesh.primitives {
            let (Some(slot), Some(found)) = (primitive.slot, accessor(primitive)) else {
                continue;
            };
            if core::mem::replace(&mut done[slot], true) {
                continue;
            }
            let found = &model.accessors[found];
            let values: Vec<[f64; 4]> = found.elements(&data);
            let start = instance.starts[slot];
            for (value, place) in values.iter().zip(&mut out[start..]) {
                *place = match channel {
                    Some(3) if found.width < 4 => 1.0,
                    Some(3) => value[3],
                    Some(channel) => encoded(value[channel]),
                    None => value[0],
                };
            }
        }
        for (shadow, start) in mesh.shadows.iter().zip(&instance.shadow_starts) {
            let base = instance.starts[shadow.slot];
            for (i, vertex) in shadow.vertices.iter().enumerate() {
                out[start + i] = out[base + *vertex as usize];
            }
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_fans_and_loops_are_unrolled_as_the_specification_says() {
        let all = |mode, n| triangles(mode, n).collect::<Vec<_>>();
        assert_eq!(all(4, 7), [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(all(5, 5), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
        assert_eq!(all(6, 4), [[0, 1, 2], [0, 2, 3]]);
        assert!(all(5, 1).is_empty());
        let all = |mode, n| segments(mode, n).collect::<Vec<_>>();
        assert_eq!(all(1, 5), [[0, 1], [2, 3]]);
        assert_eq!(all(2, 3), [[0, 1], [1, 2], [2, 0]]);
        assert_eq!(all(3, 3), [[0, 1], [1, 2]]);
        assert!(all(2, 0).is_empty() && all(2, 1).is_empty());
    }
}
