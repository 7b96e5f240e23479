//! The energy as a function of places, for those who want to look at it: its value, gradient and Hessian.
//!
//! Frames are found by the same sums. Here they are of the whole mesh in its own units, with nothing held fast.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004, eqs. (4), (9) and (10); errata S4 and S11.

use super::Pair;
use super::cells::{Points, Where};
use super::energy::{Curvature, Places, StrainTerm, Sums, stride};
use super::schemes::Scheme;
use super::settings::Shear;
use super::tensor::Strain;
use anamorph_core::glam::DVec2;

/// The energy of eq. (4) at a time: how far the strains of places are from those wanted.
#[derive(Debug, Clone)]
pub struct Energy {
    points: Points,
    wanted: Vec<Strain>,
    shear: Shear,
    vertices: usize,
}

impl Energy {
    /// The energy of a pair at time `t`.
    pub fn new(pair: &Pair, scheme: &dyn Scheme, shear: Shear, t: f64) -> Self {
        let points = Points::new(pair.elements(), pair.source(), Where::Gauss);
        let mut wanted = Vec::with_capacity(points.len());
        points.each_gradient(pair.target(), |_, _, gradient| {
            wanted.push(scheme.strain(Strain::of(gradient), t));
        });
        Self {
            points,
            wanted,
            shear,
            vertices: pair.source().len(),
        }
    }

    fn term(&self) -> StrainTerm<'_> {
        StrainTerm {
            wanted: &self.wanted,
            shear: self.shear.weight(),
        }
    }

    /// `W` of the vertices' places, eq. (4). Lists have one place for each vertex of the pair; infinite where they have not.
    pub fn value(&self, positions: &[DVec2]) -> f64 {
        if positions.len() == self.vertices {
            self.points.energy(&self.term(), positions)
        } else {
            f64::INFINITY
        }
    }

    /// `φ`, the derivatives by the places, eq. (9).
    pub fn gradient(&self, positions: &[DVec2]) -> Vec<DVec2> {
        let mut sum = vec![DVec2::ZERO; self.vertices];
        if positions.len() == self.vertices {
            self.points.gradient(&self.term(), positions, &mut sum);
        }
        sum
    }

    /// `K`, eq. (10), dense: rows of twice as many numbers as there are vertices, `x` and `y` of each.
    pub fn hessian(&self, positions: &[DVec2]) -> Vec<Vec<f64>> {
        let size = 2 * self.vertices;
        let mut values = vec![0.0; size * size + 1];
        if positions.len() == self.vertices {
            let mut gradient = vec![DVec2::ZERO; self.vertices];
            let mut sums = Sums {
                energy: 0.0,
                gradient: &mut gradient,
                values: &mut values,
            };
            let places = dense(&self.points, size);
            let (term, curvature) = (self.term(), Curvature::True);
            self.points
                .assemble(&term, positions, curvature, &places, &mut sums);
        }
        let entry = |row: usize, column: usize| values[row.max(column) * size + row.min(column)];
        (0..size)
            .map(|row| (0..size).map(|column| entry(row, column)).collect())
            .collect()
    }
}

/// Places in the lower triangle of a dense matrix.
fn dense(points: &Points, size: usize) -> Places {
    fn fill<const K: usize>(nodes: &[[u32; K]], size: usize) -> Vec<u32> {
        let mut list = Vec::with_capacity(nodes.len() * stride(K));
        for nodes in nodes {
            for (k, &a) in nodes.iter().enumerate() {
                for &b in &nodes[..=k] {
                    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                        let (row, column) = (2 * a as usize + i, 2 * b as usize + j);
                        let place = if a == b && i < j {
                            size * size
                        } else {
                            row.max(column) * size + row.min(column)
                        };
                        list.push(u32::try_from(place).unwrap_or(u32::MAX));
                    }
                }
            }
        }
        list
    }
    Places {
        triangles: fill(&points.triangles.nodes, size),
        quadrilaterals: fill(&points.quadrilaterals.nodes, size),
    }
}
