//! Random numbers, meshes and the laws of paths for the tests.

use anamorph_core::glam::{DVec3, dvec3};
use anamorph_core::math;
use core::f64::consts::TAU;

use crate::paths::SurfacePath;
use crate::{Surface, SurfacePoint};

/// Marsaglia's xorshift generator, seeded: the same numbers in every run.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        (self.between(0.0, bound as f64) as usize).min(bound - 1)
    }
    pub(crate) fn vector(&mut self) -> DVec3 {
        dvec3(
            self.between(-1.0, 1.0),
            self.between(-1.0, 1.0),
            self.between(-1.0, 1.0),
        )
    }
    /// A place of a surface: a vertex, on an edge or in a face, equally often.
    pub(crate) fn place(&mut self, surface: &Surface) -> SurfacePoint {
        let topology = surface.topology();
        match self.below(3) {
            0 => SurfacePoint::Vertex(self.below(topology.vertices())),
            1 => SurfacePoint::Edge {
                edge: self.below(topology.edges()),
                fraction: self.between(0.01, 0.99),
            },
            _ => self.in_face(surface),
        }
    }
    pub(crate) fn in_face(&mut self, surface: &Surface) -> SurfacePoint {
        let weights = [(); 3].map(|()| self.between(0.02, 1.0));
        let sum: f64 = weights.iter().sum();
        SurfacePoint::Face {
            face: self.below(surface.topology().faces()),
            weights: weights.map(|w| w / sum),
        }
    }
}

/// The laws of every path: places of the surface in simplest form, consecutive ones in the named common face, positions
/// and length as evaluated again.
pub(crate) fn assert_lawful<End>(surface: &Surface, path: &SurfacePath<End>) {
    assert_eq!(path.points.len(), path.positions.len());
    assert_eq!(path.points.len(), path.faces.len() + 1);
    let mut length = 0.0;
    for (k, &point) in path.points.iter().enumerate() {
        assert_eq!(surface.simplest(point), Ok(point));
        let position = surface.position(point);
        assert!(position.distance(path.positions[k]) <= 1e-14 * (1.0 + position.length()));
        if k > 0 {
            let face = path.faces[k - 1];
            for end in [path.points[k - 1], point] {
                assert!(surface.touches(face, end), "{end:?} is not in face {face}");
            }
            assert_ne!(path.points[k - 1], point);
            length += path.positions[k - 1].distance(path.positions[k]);
        }
    }
    assert!((length - path.length).abs() <= 1e-12 * (1.0 + length));
}

/// The faces of a grid of `nx` by `ny` squares, vertex `(i, j)` at number `j·(nx + 1) + i`, all diagonals one way.
pub(crate) fn grid_faces(nx: usize, ny: usize) -> Vec<[usize; 3]> {
    let mut faces = Vec::new();
    for j in 0..ny {
        for i in 0..nx {
            let a = j * (nx + 1) + i;
            let (b, c, d) = (a + 1, a + nx + 2, a + nx + 1);
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    faces
}

/// A grid over `[0, nx] × [0, ny]` with a height for each vertex.
pub(crate) fn grid(nx: usize, ny: usize, mut height: impl FnMut(f64, f64) -> f64) -> Surface {
    let mut positions = Vec::new();
    for j in 0..=ny {
        for i in 0..=nx {
            let (x, y) = (i as f64, j as f64);
            positions.push(dvec3(x, y, height(x, y)));
        }
    }
    Surface::new(positions, &grid_faces(nx, ny)).expect("a grid")
}

/// A grid with random heights and vertices moved aside at random, the outline included.
pub(crate) fn rough(nx: usize, ny: usize, random: &mut Random) -> Surface {
    let flat = grid(nx, ny, |_, _| 0.0);
    let moved = flat
        .positions()
        .iter()
        .map(|&p| p + random.vector() * dvec3(0.3, 0.3, 0.8))
        .collect();
    Surface::new(moved, &grid_faces(nx, ny)).expect("a rough grid")
}

/// The unit cube: vertex `x + 2y + 4z`, each face cut in two.
pub(crate) fn cube() -> Surface {
    let positions = (0..8)
        .map(|k| dvec3((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2 & 1) as f64))
        .collect();
    Surface::new(
        positions,
        &[
            [0, 2, 3],
            [0, 3, 1],
            [4, 5, 7],
            [4, 7, 6], // z = 0, z = 1
            [0, 1, 5],
            [0, 5, 4],
            [2, 6, 7],
            [2, 7, 3], // y = 0, y = 1
            [0, 4, 6],
            [0, 6, 2],
            [1, 3, 7],
            [1, 7, 5], // x = 0, x = 1
        ],
    )
    .expect("a cube")
}

/// An octahedron cut `levels` times into four, pushed onto the unit sphere.
pub(crate) fn sphere(levels: usize) -> Surface {
    let mut positions = vec![
        DVec3::X,
        DVec3::NEG_X,
        DVec3::Y,
        DVec3::NEG_Y,
        DVec3::Z,
        DVec3::NEG_Z,
    ];
    let mut faces = vec![
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    for _ in 0..levels {
        let mut middles = std::collections::BTreeMap::new();
        let mut next = Vec::new();
        for [a, b, c] in faces {
            let [p, q, r] = [(a, b), (b, c), (c, a)].map(|(i, j): (usize, usize)| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    positions.push((positions[i] + positions[j]).normalize());
                    positions.len() - 1
                })
            });
            next.extend([[a, p, r], [p, b, q], [r, q, c], [p, q, r]]);
        }
        faces = next;
    }
    Surface::new(positions, &faces).expect("a sphere")
}

/// A ring of `n` vertices with radius 1 at height 0 around an apex, vertex `n`, at a height.
pub(crate) fn cone(n: usize, height: f64) -> Surface {
    let mut positions: Vec<DVec3> = (0..n)
        .map(|k| {
            let (sin, cos) = math::sin_cos(TAU * k as f64 / n as f64);
            dvec3(cos, sin, 0.0)
        })
        .collect();
    positions.push(dvec3(0.0, 0.0, height));
    let faces: Vec<[usize; 3]> = (0..n).map(|k| [k, (k + 1) % n, n]).collect();
    Surface::new(positions, &faces).expect("a cone")
}
