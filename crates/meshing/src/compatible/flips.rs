//! What makes both meshes better: edges flipped and inner points moved where the smallest angle of both grows.
//!
//! *Source*: Yan, Hu and Martin 2004, "Merge all Patches and Optimization": moving interior vertices and flipping interior edges.

use super::mesh::{Mesh, inner_edges, smallest_angle};
use crate::planar::orientation;
use anamorph_core::glam::DVec2;

/// Rounds of flips and moves.
const ROUNDS: usize = 6;

/// Makes smallest angles larger.
pub(super) fn improve(mesh: &mut Mesh) {
    for _ in 0..ROUNDS {
        let flipped = flip(mesh);
        let moved = smooth(mesh);
        if !flipped && !moved {
            break;
        }
    }
}

/// The worst angle of a triangle in both meshes; negative where it is folded in one.
fn worst(mesh: &Mesh, triangle: [u32; 3]) -> f64 {
    let angle = |points: &[DVec2]| {
        let [a, b, c] = triangle.map(|i| points[i as usize]);
        if orientation(a, b, c) > 0.0 {
            smallest_angle([a, b, c])
        } else {
            -1.0
        }
    };
    angle(&mesh.source).min(angle(&mesh.target))
}

/// Flips edges, each triangle at most once. Whether there were any.
fn flip(mesh: &mut Mesh) -> bool {
    let mut touched = vec![false; mesh.triangles.len()];
    let mut any = false;
    for ([a, b], [(first, c), (second, d)]) in inner_edges(&mesh.triangles) {
        if touched[first] || touched[second] {
            continue;
        }
        let before = worst(mesh, [a, b, c]).min(worst(mesh, [b, a, d]));
        let (left, right) = ([a, d, c], [d, b, c]);
        let after = worst(mesh, left).min(worst(mesh, right));
        if after > before + 1e-6 {
            (mesh.triangles[first], mesh.triangles[second]) = (left, right);
            (touched[first], touched[second]) = (true, true);
            any = true;
        }
    }
    any
}

/// Moves inner points towards the middle of their neighbours. Whether any moved.
fn smooth(mesh: &mut Mesh) -> bool {
    let mut around = vec![Vec::new(); mesh.source.len()];
    for (number, triangle) in mesh.triangles.iter().enumerate() {
        for &corner in triangle {
            around[corner as usize].push(number);
        }
    }
    let mut any = false;
    for point in mesh.fixed..mesh.source.len() {
        let star = &around[point];
        let of_star = |mesh: &Mesh| {
            let all = star.iter().map(|&t| worst(mesh, mesh.triangles[t]));
            all.fold(f64::INFINITY, f64::min)
        };
        for is_target in [false, true] {
            let before = of_star(mesh);
            let points = if is_target {
                &mesh.target
            } else {
                &mesh.source
            };
            let here = points[point];
            let (mut sum, mut count) = (DVec2::ZERO, 0.0);
            for &corner in star.iter().flat_map(|&t| &mesh.triangles[t]) {
                if corner as usize != point {
                    sum += points[corner as usize];
                    count += 1.0;
                }
            }
            for share in [0.5, 0.15] {
                let there = here + (sum / count - here) * share;
                let points = if is_target {
                    &mut mesh.target
                } else {
                    &mut mesh.source
                };
                points[point] = there;
                if of_star(mesh) > before + 1e-6 {
                    any = true;
                    break;
                }
                let points = if is_target {
                    &mut mesh.target
                } else {
                    &mut mesh.source
                };
                points[point] = here;
            }
        }
    }
    any
}
