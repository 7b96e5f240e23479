//! Places of a mesh at which gradients are taken: the middle of a triangle, 2 × 2 points of Gauss in a quadrilateral.
//!
//! A point has a weight, the area that it stands for, and the gradients `∇N_k` of the shape functions of its element, eq. (5), so that the
//! gradient of a map is `F = Σ p_k ∇N_kᵀ`. Lists are flat; those of one element follow each other.
//!
//! *Source*: O. C. Zienkiewicz, *The Finite Element Method*, 2000; K.-J. Bathe, *Finite Element Procedures*, 1996, ch. 5: the bilinear
//! element with 2 × 2 points, which passes the patch test.

use super::pair::Element;
use super::tensor::cross;
use anamorph_core::glam::{DMat2, DVec2, dvec2};

/// Points in elements of `K` vertices.
#[derive(Debug, Clone)]
pub(crate) struct Cells<const K: usize> {
    /// Vertices of each element, within its part.
    pub(crate) nodes: Vec<[u32; K]>,
    /// Number of each element within its part.
    pub(crate) elements: Vec<u32>,
    /// Points in an element.
    pub(crate) per: usize,
    /// Of each point: gradients of the shape functions.
    pub(crate) gradients: Vec<[DVec2; K]>,
    /// Of each point: the area it stands for.
    pub(crate) weights: Vec<f64>,
}

impl<const K: usize> Cells<K> {
    fn new(per: usize) -> Self {
        Self {
            nodes: Vec::new(),
            elements: Vec::new(),
            per,
            gradients: Vec::new(),
            weights: Vec::new(),
        }
    }

    /// How many points there are.
    pub(crate) fn len(&self) -> usize {
        self.weights.len()
    }

    /// The gradient of a map at a point of an element, the vertices being carried to these places.
    #[inline]
    pub(crate) fn gradient(&self, nodes: &[u32; K], point: usize, positions: &[DVec2]) -> DMat2 {
        gradient_of(&self.gradients[point], nodes, positions)
    }

    /// The gradients of a map at all points, in order, with the number of the element.
    pub(crate) fn each_gradient(
        &self,
        positions: &[DVec2],
        mut body: impl FnMut(usize, usize, DMat2),
    ) {
        for (cell, nodes) in self.nodes.iter().enumerate() {
            let element = self.elements[cell] as usize;
            for point in cell * self.per..(cell + 1) * self.per {
                body(point, element, self.gradient(nodes, point, positions));
            }
        }
    }
}

#[inline]
fn gradient_of<const K: usize>(
    gradients: &[DVec2; K],
    nodes: &[u32; K],
    positions: &[DVec2],
) -> DMat2 {
    let (mut x, mut y) = (DVec2::ZERO, DVec2::ZERO);
    for (gradient, &node) in gradients.iter().zip(nodes) {
        let place = positions[node as usize];
        x += place * gradient.x;
        y += place * gradient.y;
    }
    DMat2::from_cols(x, y)
}

/// All points of a part in one of its two places.
#[derive(Debug, Clone)]
pub(crate) struct Points {
    pub(crate) triangles: Cells<3>,
    pub(crate) quadrilaterals: Cells<4>,
}

/// Where the points of a quadrilateral are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Where {
    /// The 2 × 2 points of Gauss.
    Gauss,
    /// The middle alone.
    Middle,
    /// The corners, where determinants are extreme.
    Corners,
}

/// Gradients of the shape functions of a bilinear element at `(ξ, η)` and the determinant there, whatever its sign.
fn bilinear(corners: &[DVec2; 4], xi: f64, eta: f64) -> ([DVec2; 4], f64) {
    const SIGNS: [(f64, f64); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let inner = SIGNS.map(|(s, r)| dvec2(0.25 * s * (1.0 + r * eta), 0.25 * r * (1.0 + s * xi)));
    let (mut along_xi, mut along_eta) = (DVec2::ZERO, DVec2::ZERO);
    for (corner, d) in corners.iter().zip(&inner) {
        along_xi += *corner * d.x;
        along_eta += *corner * d.y;
    }
    let determinant = cross(along_xi, along_eta);
    // ∇N = J⁻ᵀ ∂N/∂(ξ, η), the columns of J being the two tangents.
    let gradients = inner.map(|d| {
        dvec2(
            along_eta.y * d.x - along_xi.y * d.y,
            along_xi.x * d.y - along_eta.x * d.x,
        ) / determinant
    });
    (gradients, determinant)
}

impl Points {
    /// The points of a part: its elements with vertices numbered within the part, and the places of those.
    pub(crate) fn new(elements: &[Element], positions: &[DVec2], place: Where) -> Self {
        let gauss = 1.0 / 3.0_f64.sqrt();
        let (list, weight): (&[(f64, f64)], f64) = match place {
            Where::Gauss => (
                &[
                    (-gauss, -gauss),
                    (gauss, -gauss),
                    (gauss, gauss),
                    (-gauss, gauss),
                ],
                1.0,
            ),
            Where::Corners => (&[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)], 1.0),
            Where::Middle => (&[(0.0, 0.0)], 4.0),
        };
        let mut points = Self {
            triangles: Cells::new(1),
            quadrilaterals: Cells::new(list.len()),
        };
        for (number, element) in elements.iter().enumerate() {
            // Counts of a pair fit 31 bits.
            #[allow(clippy::cast_possible_truncation)]
            let narrow = |number: usize| number as u32;
            match element {
                Element::Triangle(nodes) => {
                    let corners = nodes.map(|node| positions[node]);
                    let [a, b, c] = corners;
                    let twice = cross(b - a, c - a);
                    let opposite = |from: DVec2, to: DVec2| (to - from).perp() / twice;
                    let cells = &mut points.triangles;
                    cells.nodes.push(nodes.map(narrow));
                    cells.elements.push(narrow(number));
                    cells
                        .gradients
                        .push([opposite(b, c), opposite(c, a), opposite(a, b)]);
                    cells.weights.push(0.5 * twice.abs());
                }
                Element::Quadrilateral(nodes) => {
                    let corners = nodes.map(|node| positions[node]);
                    let cells = &mut points.quadrilaterals;
                    cells.nodes.push(nodes.map(narrow));
                    cells.elements.push(narrow(number));
                    for &(xi, eta) in list {
                        let (gradients, determinant) = bilinear(&corners, xi, eta);
                        cells.gradients.push(gradients);
                        cells.weights.push(weight * determinant.abs());
                    }
                }
            }
        }
        points
    }

    /// How many points there are; those of triangles come first.
    pub(crate) fn len(&self) -> usize {
        self.triangles.len() + self.quadrilaterals.len()
    }

    /// The gradients of a map at all points, in order, with the number of the element.
    pub(crate) fn each_gradient(
        &self,
        positions: &[DVec2],
        mut body: impl FnMut(usize, usize, DMat2),
    ) {
        let first = self.triangles.len();
        self.triangles.each_gradient(positions, &mut body);
        self.quadrilaterals
            .each_gradient(positions, |point, element, gradient| {
                body(first + point, element, gradient);
            });
    }

    /// The weights of all points, in order.
    pub(crate) fn weights(&self) -> impl Iterator<Item = f64> + '_ {
        let (first, second) = (&self.triangles.weights, &self.quadrilaterals.weights);
        first.iter().chain(second).copied()
    }

    /// Divides the weights.
    pub(crate) fn divide_weights(&mut self, by: f64) {
        let lists = [
            &mut self.triangles.weights,
            &mut self.quadrilaterals.weights,
        ];
        for weight in lists.into_iter().flatten() {
            *weight /= by;
        }
    }
}
