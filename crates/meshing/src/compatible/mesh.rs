//! Two meshes with the same triangles while they are made, and how their triangles are split.
//!
//! Points `0..on_rings` lie on the rings, those before `fixed` stay where they are in both. A chord, an inner edge between two points of
//! the rings, is split, because the two may not see each other in the other region.
//!
//! *Source*: Yan, Hu and Martin 2004, "Mapping Back" (more inner points where triangles stay flipped).

use crate::planar::{PlanarMesh, orientation};
use anamorph_core::glam::DVec2;
use std::collections::HashMap;

/// Meshes of source and target.
pub(super) struct Mesh {
    pub(super) source: Vec<DVec2>,
    /// As many; those behind `fixed` are found.
    pub(super) target: Vec<DVec2>,
    /// Logarithms of how large the target is beside the source.
    pub(super) sizes: Vec<f64>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) on_rings: usize,
    pub(super) fixed: usize,
}

/// The smallest angle of a triangle in radians.
pub(super) fn smallest_angle(corners: [DVec2; 3]) -> f64 {
    let angle = |i: usize| {
        let (a, b, c) = (corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]);
        let (u, v) = (b - a, c - a);
        u.perp_dot(v).atan2(u.dot(v))
    };
    angle(0).min(angle(1)).min(angle(2))
}

/// An edge with the triangles on either side and their corners opposite of it.
pub(super) type InnerEdge = ([u32; 2], [(usize, u32); 2]);

/// The triangles on either side of each inner edge, in a fixed order: edge, then triangle and the opposite corner of the side that has the edge in
/// its own direction, then of the other.
pub(super) fn inner_edges(triangles: &[[u32; 3]]) -> Vec<InnerEdge> {
    let mut open: HashMap<[u32; 2], (usize, u32)> = HashMap::new();
    let mut edges = Vec::new();
    for (number, triangle) in triangles.iter().enumerate() {
        for side in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|i| triangle[(side + i) % 3]);
            match open.remove(&[b, a]) {
                Some(first) => edges.push(([b, a], [first, (number, c)])),
                None => {
                    open.insert([a, b], (number, c));
                }
            }
        }
    }
    edges
}

impl Mesh {
    pub(super) fn new(planar: PlanarMesh, held: Vec<DVec2>, on_rings: usize, fixed: usize) -> Self {
        let mut target = held;
        target.resize(planar.points.len(), DVec2::ZERO);
        Self {
            sizes: vec![0.0; planar.points.len()],
            source: planar.points,
            target,
            triangles: planar.triangles,
            on_rings,
            fixed,
        }
    }

    /// Numbers of the triangles that are not positive in the target.
    pub(super) fn folded(&self) -> Vec<usize> {
        let folded = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|i| self.target[i as usize]);
            let twice = orientation(a, b, c);
            twice <= 0.0 || twice.is_nan()
        };
        let numbered = self.triangles.iter().enumerate();
        numbered
            .filter(|(_, triangle)| folded(triangle))
            .map(|(number, _)| number)
            .collect()
    }

    /// Splits all inner edges between points of the rings.
    pub(super) fn split_chords(&mut self) {
        let on_rings = self.on_rings as u32;
        let edges = inner_edges(&self.triangles);
        let chords = edges.iter().map(|(edge, _)| *edge);
        let chords: Vec<_> = chords
            .filter(|edge| edge.iter().all(|i| *i < on_rings))
            .collect();
        self.split_edges(&chords);
    }

    /// Splits all inner edges of some triangles.
    pub(super) fn split(&mut self, triangles: &[usize]) {
        let mut chosen = vec![false; self.triangles.len()];
        for &triangle in triangles {
            chosen[triangle] = true;
        }
        let edges = inner_edges(&self.triangles);
        let edges = edges
            .iter()
            .filter(|(_, [a, b])| chosen[a.0] || chosen[b.0])
            .map(|(edge, _)| *edge)
            .collect::<Vec<_>>();
        self.split_edges(&edges);
        self.split_chords();
    }

    /// Splits edges in their middles.
    fn split_edges(&mut self, edges: &[[u32; 2]]) {
        let mut middles = HashMap::new();
        for edge in edges {
            let [a, b] = edge.map(|i| i as usize);
            let middle = self.source.len() as u32;
            self.source.push(0.5 * (self.source[a] + self.source[b]));
            self.target.push(0.5 * (self.target[a] + self.target[b]));
            self.sizes.push(0.5 * (self.sizes[a] + self.sizes[b]));
            middles.insert([edge[0].min(edge[1]), edge[0].max(edge[1])], middle);
        }
        let middle = |a: u32, b: u32| middles.get(&[a.min(b), a.max(b)]).copied();
        let mut triangles = Vec::with_capacity(self.triangles.len() + 2 * edges.len());
        for &[a, b, c] in &self.triangles {
            let found = [middle(a, b), middle(b, c), middle(c, a)];
            // Turned so that what is split comes first.
            let turn = match found.map(|m| m.is_some()) {
                [true, true, _] | [true, false, false] => 0,
                [false, true, _] => 1,
                [true, false, true] | [false, false, true] => 2,
                [false, false, false] => 0,
            };
            let corner = |i: usize| [a, b, c][(i + turn) % 3];
            let split = |i: usize| found[(i + turn) % 3];
            let [p, q, r] = [corner(0), corner(1), corner(2)];
            match [split(0), split(1), split(2)] {
                [Some(x), Some(y), Some(z)] => {
                    triangles.extend([[p, x, z], [x, q, y], [z, y, r], [x, y, z]]);
                }
                [Some(x), Some(y), None] => {
                    triangles.extend([[x, q, y], [p, x, y], [p, y, r]]);
                }
                [Some(x), ..] => triangles.extend([[p, x, r], [x, q, r]]),
                _ => triangles.push([a, b, c]),
            }
        }
        self.triangles = triangles;
    }
}
