//! Two meshes with the same triangles while they are made, and what is asked of lists of triangles.
//!
//! Points before `fixed`, those of the rings and the inner ones that were asked for, stay where they are in both.
//!
//! *Source*: Yan, Hu and Martin 2004, "From Objects to Isomorphic Meshes".

use crate::planar::orientation;
use anamorph_core::glam::DVec2;
use std::collections::HashMap;

/// Meshes of source and target.
pub(super) struct Mesh {
    pub(super) source: Vec<DVec2>,
    pub(super) target: Vec<DVec2>,
    pub(super) triangles: Vec<[u32; 3]>,
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
    /// Numbers of the triangles that are not positive in both.
    pub(super) fn folded(&self) -> Vec<usize> {
        let folded = |triangle: &[u32; 3]| {
            [&self.source, &self.target].iter().any(|places| {
                let [a, b, c] = triangle.map(|i| places[i as usize]);
                let twice = orientation(a, b, c);
                twice <= 0.0 || twice.is_nan()
            })
        };
        let numbered = self.triangles.iter().enumerate();
        numbered
            .filter(|(_, triangle)| folded(triangle))
            .map(|(number, _)| number)
            .collect()
    }
}
