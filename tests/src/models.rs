//! Models made in code: grids, a ball, and the boxes the laws are checked in.

use anamorph_core::{Bounds, Plane, Solid, Space, glam::dvec2, glam::dvec3};

/// A grid of `n`×`n` points over [−1, 1]² in the plane, row by row.
#[allow(clippy::cast_precision_loss)]
pub fn plane_grid(n: usize) -> Vec<Plane> {
    let at = |i: usize| 2.0 * i as f64 / (n - 1) as f64 - 1.0;
    (0..n * n).map(|i| dvec2(at(i % n), at(i / n))).collect()
}

/// The surface of a cube [−1, 1]³ as the outer points of an `n`×`n`×`n` grid.
#[allow(clippy::cast_precision_loss)]
pub fn cube_surface(n: usize) -> Vec<Solid> {
    let at = |i: usize| 2.0 * i as f64 / (n - 1) as f64 - 1.0;
    let outer = |i: usize| i == 0 || i == n - 1;
    (0..n * n * n)
        .map(|i| [i % n, i / n % n, i / (n * n)])
        .filter(|i| i.iter().any(|&i| outer(i)))
        .map(|[i, j, k]| dvec3(at(i), at(j), at(k)))
        .collect()
}

/// The boxes of four models: ordinary; off the origin with uneven edges; tiny and far away; huge.
pub fn boxes<S: Space>() -> [Bounds<S>; 4] {
    let bounds = |min: [f64; 3], size: [f64; 3]| {
        let min = S::from_fn(|i| min[i]);
        Bounds::new(min, min + S::from_fn(|i| size[i]))
    };
    [
        bounds([-1.0, -1.0, -1.0], [2.0, 2.0, 2.0]),
        bounds([-3.0, 10.0, 2.0], [7.0, 2.5, 28.0]),
        bounds([100.0, -50.0, 2.0], [0.02, 0.03, 0.01]),
        bounds([-1e6, 2e5, -3e6], [2e6, 3e6, 4e6]),
    ]
}

/// A disk of triangles of radius `radius` about a point, across `normal`: the point is vertex 0.
pub fn patch(centre: Solid, normal: Solid, radius: f64) -> (Vec<Solid>, Vec<[u32; 3]>) {
    const SIDES: u32 = 12;
    let across = normal.any_orthonormal_vector();
    let along = normal.cross(across);
    let mut points = vec![centre];
    for i in 0..SIDES {
        let (s, c) =
            anamorph_core::math::sin_cos(core::f64::consts::TAU * f64::from(i) / f64::from(SIDES));
        points.push(centre + (across * c + along * s) * radius);
    }
    let triangles = (0..SIDES)
        .map(|i| [0, 1 + i, 1 + (i + 1) % SIDES])
        .collect();
    (points, triangles)
}
