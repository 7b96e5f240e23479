//! A triangle mesh with positions, places on it, and normals.
//!
//! Vertex normals are the sums of the face normals weighted by area (H. Gouraud, *Continuous Shading of Curved Surfaces*,
//! IEEE Transactions on Computers C-20(6), 1971), which are the gradient of the volume and need no angles.

use anamorph_core::glam::DVec3;

use crate::{SurfaceError, SurfacePointError, Topology};

/// Coordinates up to this magnitude have areas and squared areas that are finite numbers.
const LARGEST: f64 = 1e75;

/// How far the sum of barycentric coordinates may be from 1; beyond it they are not rounding but a mistake.
const WEIGHT_SUM: f64 = 1e-9;

/// A place on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurfacePoint {
    /// At a vertex.
    Vertex(usize),
    /// On an edge.
    Edge {
        /// Number of the edge.
        edge: usize,
        /// 0 at the edge's lower vertex, 1 at the higher ([`Topology::ends`]).
        fraction: f64,
    },
    /// In a face.
    Face {
        /// Number of the face.
        face: usize,
        /// Barycentric coordinates: the shares of the face's corners, in their order.
        weights: [f64; 3],
    },
}

/// A triangle mesh with one finite position for each vertex.
///
/// Edges shorter than 1e-75 count as points and faces smaller than that as without area; all else is scale-free.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    topology: Topology,
    positions: Vec<DVec3>,
}

impl Surface {
    /// The surface of triangles over positions.
    ///
    /// # Errors
    /// Where the triangles have no [`Topology`], or a position is not finite or beyond 1e75.
    pub fn new(positions: Vec<DVec3>, triangles: &[[usize; 3]]) -> Result<Self, SurfaceError> {
        let topology = Topology::new(positions.len(), triangles)?;
        Self::with_topology(topology, positions)
    }

    /// The surface of a known topology, for a mesh that moves.
    ///
    /// # Errors
    /// Where there is not one position for each vertex, or one is not finite or beyond 1e75.
    pub fn with_topology(topology: Topology, positions: Vec<DVec3>) -> Result<Self, SurfaceError> {
        if positions.len() != topology.vertices() {
            return Err(SurfaceError::Count {
                positions: positions.len(),
                vertices: topology.vertices(),
            });
        }
        for (vertex, position) in positions.iter().enumerate() {
            if !position.is_finite() {
                return Err(SurfaceError::NotFinite { vertex });
            }
            if position.abs().max_element() > LARGEST {
                return Err(SurfaceError::TooLarge { vertex });
            }
        }
        Ok(Self {
            topology,
            positions,
        })
    }

    /// The neighbourhoods.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// One position a vertex.
    #[must_use]
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The positions of a face's corners.
    ///
    /// # Panics
    /// Where the face does not exist, like a slice.
    #[must_use]
    pub fn corners(&self, face: usize) -> [DVec3; 3] {
        self.topology.triangle(face).map(|v| self.positions[v])
    }

    /// The length of an edge.
    ///
    /// # Panics
    /// Where the edge does not exist, like a slice.
    #[must_use]
    pub fn edge_length(&self, edge: usize) -> f64 {
        let [a, b] = self.topology.ends(edge);
        self.positions[a].distance(self.positions[b])
    }

    /// A place brought into its simplest form: a fraction of 0 or 1 and barycentric coordinates of 0 become a vertex or an
    /// edge, and barycentric coordinates add up to 1.
    ///
    /// # Errors
    /// Where it is no place of this surface.
    pub fn simplest(&self, point: SurfacePoint) -> Result<SurfacePoint, SurfacePointError> {
        let exists = |what, index, count| {
            if index < count {
                Ok(())
            } else {
                Err(SurfacePointError::NoSuch { what, index, count })
            }
        };
        match point {
            SurfacePoint::Vertex(vertex) => exists("vertex", vertex, self.topology.vertices())?,
            SurfacePoint::Edge { edge, fraction } => {
                exists("edge", edge, self.topology.edges())?;
                if !(0.0..=1.0).contains(&fraction) {
                    return Err(SurfacePointError::Fraction { edge, fraction });
                }
            }
            SurfacePoint::Face { face, weights } => {
                exists("face", face, self.topology.faces())?;
                let sum: f64 = weights.iter().sum();
                // Written so that NaN fails.
                let inside = weights.iter().all(|&w| w >= 0.0) && (sum - 1.0).abs() <= WEIGHT_SUM;
                if !inside {
                    return Err(SurfacePointError::Weights { face, weights });
                }
                if self.topology.sides(face).is_none() {
                    return Err(SurfacePointError::Degenerate { face });
                }
            }
        }
        Ok(self.simplified(point))
    }

    /// As [`simplest`](Self::simplest), of a place that is known to be one.
    pub(crate) fn simplified(&self, point: SurfacePoint) -> SurfacePoint {
        match point {
            SurfacePoint::Vertex(_) => point,
            SurfacePoint::Edge { edge, fraction } => {
                let [low, high] = self.topology.ends(edge);
                if fraction <= 0.0 {
                    SurfacePoint::Vertex(low)
                } else if fraction >= 1.0 {
                    SurfacePoint::Vertex(high)
                } else {
                    point
                }
            }
            SurfacePoint::Face { face, weights } => {
                let triangle = self.topology.triangle(face);
                let sum: f64 = weights.iter().sum();
                // Sums that are 1 to rounding stay, so that the simplest form of a simplest form is itself.
                let weights = if (sum - 1.0).abs() <= 4.0 * f64::EPSILON {
                    weights
                } else {
                    weights.map(|w| w / sum)
                };
                let positive = |k: usize| weights[k] > 0.0;
                match (0..3).filter(|&k| positive(k)).count() {
                    1 => (0..3)
                        .find(|&k| positive(k))
                        .map_or(point, |k| SurfacePoint::Vertex(triangle[k])),
                    2 => {
                        // The side opposite the corner without a share.
                        let k = (0..3).find(|&k| !positive(k)).map_or(0, |k| (k + 1) % 3);
                        let Some(sides) = self.topology.sides(face) else {
                            return point;
                        };
                        let up = triangle[k] == self.topology.ends(sides[k])[0];
                        let fraction = if up { weights[(k + 1) % 3] } else { weights[k] };
                        self.simplified(SurfacePoint::Edge {
                            edge: sides[k],
                            fraction,
                        })
                    }
                    _ => SurfacePoint::Face { face, weights },
                }
            }
        }
    }

    /// Where a place is in space.
    ///
    /// # Panics
    /// Where the vertex, edge or face does not exist, like a slice; [`simplest`](Self::simplest) checks that.
    #[must_use]
    pub fn position(&self, point: SurfacePoint) -> DVec3 {
        match point {
            SurfacePoint::Vertex(vertex) => self.positions[vertex],
            SurfacePoint::Edge { edge, fraction } => {
                let [a, b] = self.topology.ends(edge).map(|v| self.positions[v]);
                // From the nearer end, so that both ends are met exactly.
                if fraction <= 0.5 {
                    a + (b - a) * fraction
                } else {
                    b + (a - b) * (1.0 - fraction)
                }
            }
            SurfacePoint::Face { face, weights } => {
                let [a, b, c] = self.corners(face);
                a * weights[0] + b * weights[1] + c * weights[2]
            }
        }
    }

    /// Twice the area of a face times its unit normal, by the right-hand rule over its corners.
    #[must_use]
    pub(crate) fn area_vector(&self, face: usize) -> DVec3 {
        let [a, b, c] = self.corners(face);
        (b - a).cross(c - a)
    }

    /// The unit normal at a place: of the face in a face, else of the faces that touch, weighted by area. `None` where
    /// they have no area, or their normals cancel.
    ///
    /// # Panics
    /// Where the vertex, edge or face does not exist, like a slice.
    #[must_use]
    pub fn normal(&self, point: SurfacePoint) -> Option<DVec3> {
        let sum: DVec3 = match point {
            SurfacePoint::Vertex(vertex) => {
                let corners = self.topology.corners(vertex);
                corners.iter().map(|c| self.area_vector(c.face)).sum()
            }
            SurfacePoint::Edge { edge, .. } => {
                let faces = self.topology.edge_faces(edge);
                faces.iter().map(|&face| self.area_vector(face)).sum()
            }
            SurfacePoint::Face { face, .. } => self.area_vector(face),
        };
        // The scaled sum has squares that neither overflow nor vanish.
        (sum / sum.abs().max_element()).try_normalize()
    }

    /// Whether a place is a corner of a face, on one of its sides, or in it.
    ///
    /// # Panics
    /// Where the face does not exist, like a slice.
    #[must_use]
    pub fn touches(&self, face: usize, point: SurfacePoint) -> bool {
        let Some(sides) = self.topology.sides(face) else {
            return false;
        };
        match point {
            SurfacePoint::Vertex(vertex) => self.topology.triangle(face).contains(&vertex),
            SurfacePoint::Edge { edge, .. } => sides.contains(&edge),
            SurfacePoint::Face { face: own, .. } => own == face,
        }
    }

    /// The faces that a place touches.
    pub(crate) fn faces_at(&self, point: SurfacePoint) -> Vec<usize> {
        match point {
            SurfacePoint::Vertex(vertex) => {
                let corners = self.topology.corners(vertex);
                corners.iter().map(|c| c.face).collect()
            }
            SurfacePoint::Edge { edge, .. } => self.topology.edge_faces(edge).to_vec(),
            SurfacePoint::Face { face, .. } => vec![face],
        }
    }

    /// The lowest face that two places touch.
    pub(crate) fn shared_face(&self, a: SurfacePoint, b: SurfacePoint) -> Option<usize> {
        let (few, other) = match a {
            SurfacePoint::Vertex(_) => (b, a),
            _ => (a, b),
        };
        self.faces_at(few)
            .into_iter()
            .filter(|&face| self.touches(face, other))
            .min()
    }

    /// The barycentric coordinates of a place in a face that it touches.
    pub(crate) fn weights_in(&self, face: usize, point: SurfacePoint) -> [f64; 3] {
        let triangle = self.topology.triangle(face);
        match point {
            SurfacePoint::Vertex(vertex) => triangle.map(|v| f64::from(u8::from(v == vertex))),
            SurfacePoint::Edge { edge, fraction } => {
                let [low, high] = self.topology.ends(edge);
                triangle.map(|v| {
                    if v == low {
                        1.0 - fraction
                    } else if v == high {
                        fraction
                    } else {
                        0.0
                    }
                })
            }
            SurfacePoint::Face { weights, .. } => weights,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TopologyError;
    use crate::testing::{cube, grid, sphere};
    use anamorph_core::glam::dvec3;

    #[test]
    fn places_are_brought_into_their_simplest_form() {
        let cube = cube();
        let topology = cube.topology();
        let in_face = |weights| cube.simplest(SurfacePoint::Face { face: 0, weights });
        // Face 0 is [0, 2, 3].
        assert_eq!(in_face([0.0, 1.0, 0.0]), Ok(SurfacePoint::Vertex(2)));
        let edge = topology.edge_between(0, 3).expect("the diagonal");
        assert_eq!(
            in_face([0.25, 0.0, 0.75]),
            Ok(SurfacePoint::Edge {
                edge,
                fraction: 0.75
            })
        );
        for face in 0..topology.faces() {
            for weights in [[0.25, 0.75, 0.0], [0.0, 0.25, 0.75], [0.75, 0.0, 0.25]] {
                let point = SurfacePoint::Face { face, weights };
                let simplest = cube.simplest(point).expect("a place");
                assert!(matches!(simplest, SurfacePoint::Edge { .. }));
                assert_eq!(cube.position(simplest), cube.position(point));
                assert_eq!(cube.weights_in(face, simplest), weights);
            }
        }
        let ends = topology.ends(edge);
        let at = |fraction| cube.simplest(SurfacePoint::Edge { edge, fraction });
        assert_eq!(at(0.0), Ok(SurfacePoint::Vertex(ends[0])));
        assert_eq!(at(1.0), Ok(SurfacePoint::Vertex(ends[1])));
    }

    #[test]
    fn what_is_no_place_is_named() {
        let cube = cube();
        let error = |point| cube.simplest(point).expect_err("no place").to_string();
        assert!(error(SurfacePoint::Vertex(8)).contains("vertex 8 does not exist"));
        let far = SurfacePoint::Edge {
            edge: 99,
            fraction: 0.5,
        };
        assert!(error(far).contains("edge 99"));
        for fraction in [-0.1, 1.1, f64::NAN] {
            assert!(error(SurfacePoint::Edge { edge: 1, fraction }).contains("fraction"));
        }
        for weights in [[0.5, 0.6, -0.1], [0.5; 3], [f64::NAN, 0.5, 0.5], [0.0; 3]] {
            assert!(error(SurfacePoint::Face { face: 2, weights }).contains("in face 2"));
        }
        let pinched = Surface::new(
            vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            &[[0, 1, 2], [1, 1, 2]],
        );
        let point = SurfacePoint::Face {
            face: 1,
            weights: [0.2, 0.3, 0.5],
        };
        assert_eq!(
            pinched.expect("one face").simplest(point),
            Err(SurfacePointError::Degenerate { face: 1 })
        );
    }

    #[test]
    fn positions_that_are_no_numbers_are_named() {
        let mut positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let faces = [[0, 1, 2]];
        positions[1].z = f64::NAN;
        let nan = Surface::new(positions.clone(), &faces);
        assert_eq!(nan, Err(SurfaceError::NotFinite { vertex: 1 }));
        positions[1].z = 1e200;
        let large = Surface::new(positions.clone(), &faces);
        assert_eq!(large, Err(SurfaceError::TooLarge { vertex: 1 }));
        let topology = Topology::new(4, &faces).expect("a topology");
        let short = Surface::with_topology(topology, positions.clone());
        assert_eq!(
            short,
            Err(SurfaceError::Count {
                positions: 3,
                vertices: 4
            })
        );
        let none = Surface::new(positions, &[]);
        assert_eq!(none, Err(SurfaceError::Topology(TopologyError::Empty)));
    }

    #[test]
    fn normals_point_outward_and_are_weighted_by_area() {
        let sphere = sphere(4);
        for (vertex, &position) in sphere.positions().iter().enumerate() {
            let normal = sphere
                .normal(SurfacePoint::Vertex(vertex))
                .expect("a normal");
            assert!((normal.length() - 1.0).abs() < 1e-15);
            assert!(normal.dot(position) > 0.999);
        }
        // A large face in z = 0 and a small one in x = 0 that share an edge.
        let positions = vec![
            DVec3::ZERO,
            DVec3::Y,
            dvec3(4.0, 0.0, 0.0),
            dvec3(0.0, 0.0, 1.0),
        ];
        let fold = Surface::new(positions, &[[0, 2, 1], [0, 1, 3]]).expect("a fold");
        let expected = dvec3(1.0, 0.0, 4.0).normalize();
        assert!(
            fold.normal(SurfacePoint::Vertex(0))
                .expect("a normal")
                .distance(expected)
                < 1e-15
        );
        // Two triangles back to back cancel.
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let pillow = Surface::new(positions, &[[0, 1, 2], [0, 2, 1]]).expect("a pillow");
        assert_eq!(pillow.normal(SurfacePoint::Vertex(0)), None);
        // From the smallest to the largest.
        for size in [1e-70, 1e-30, 1e30, 1e75] {
            let positions = grid(2, 2, |x, _| x)
                .positions()
                .iter()
                .map(|&p| p * (0.25 * size))
                .collect();
            let faces = crate::testing::grid_faces(2, 2);
            let grid = Surface::new(positions, &faces).expect("a grid");
            let normal = grid.normal(SurfacePoint::Vertex(4)).expect("a normal");
            assert!(normal.distance(dvec3(-1.0, 0.0, 1.0).normalize()) < 1e-15);
        }
    }
}
