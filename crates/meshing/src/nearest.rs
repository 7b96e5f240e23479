//! The place of a surface that is nearest to a point of space.
//!
//! A binary tree of boxes around the faces, cut at the median along the longest side; the search visits the nearer box
//! first and leaves out those farther than the best place found (S. Arya and D. M. Mount, *Algorithms for Fast Vector
//! Quantization*, Data Compression Conference, 1993, for trees of points). The answer is exact: that of looking at every
//! face.

use anamorph_core::glam::DVec3;

use crate::{Surface, SurfacePoint, SurfacePointError};

/// Faces in a leaf: below it, a box costs as much as the faces in it.
const LEAF: usize = 4;

/// The place of a surface nearest to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestSurfacePoint {
    /// The place.
    pub point: SurfacePoint,
    /// Where it is in space.
    pub position: DVec3,
    /// Its distance from the point.
    pub distance: f64,
}

/// A box around the faces `start..end` of the tree's list.
#[derive(Debug, Clone, Copy)]
struct Node {
    low: DVec3,
    high: DVec3,
    start: usize,
    end: usize,
    /// The two halves; the first stands behind its parent.
    second: Option<usize>,
}

/// A surface prepared to be asked for nearest places, in time that grows with the logarithm of the number of faces.
#[derive(Debug, Clone)]
pub struct SurfaceTree<'a> {
    surface: &'a Surface,
    faces: Vec<usize>,
    nodes: Vec<Node>,
}

impl<'a> SurfaceTree<'a> {
    /// The tree over all faces that are not degenerate; those without area count, as segments and points.
    #[must_use]
    pub fn new(surface: &'a Surface) -> Self {
        let topology = surface.topology();
        let faces = (0..topology.faces())
            .filter(|&face| topology.sides(face).is_some())
            .collect();
        let mut tree = Self {
            surface,
            faces,
            nodes: Vec::new(),
        };
        let centres: Vec<DVec3> = (0..topology.faces())
            .map(|face| surface.corners(face).into_iter().sum::<DVec3>() / 3.0)
            .collect();
        tree.split(0, tree.faces.len(), &centres);
        tree
    }

    /// Builds the node of a range; as deep as the logarithm of its length.
    fn split(&mut self, start: usize, end: usize, centres: &[DVec3]) {
        let surface = self.surface;
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (mut centre_low, mut centre_high) = (low, high);
        for &face in &self.faces[start..end] {
            for p in surface.corners(face) {
                (low, high) = (low.min(p), high.max(p));
            }
            let c = centres[face];
            (centre_low, centre_high) = (centre_low.min(c), centre_high.max(c));
        }
        let own = self.nodes.len();
        self.nodes.push(Node {
            low,
            high,
            start,
            end,
            second: None,
        });
        if end - start <= LEAF {
            return;
        }
        let axis = (centre_high - centre_low).max_position();
        let middle = (start + end) / 2;
        self.faces[start..end].select_nth_unstable_by(middle - start, |&a, &b| {
            centres[a][axis]
                .total_cmp(&centres[b][axis])
                .then(a.cmp(&b))
        });
        self.split(start, middle, centres);
        self.nodes[own].second = Some(self.nodes.len());
        self.split(middle, end, centres);
    }

    /// The nearest place; of places equally near, that in the lowest face.
    ///
    /// # Errors
    /// Where the point is not finite.
    pub fn nearest(&self, point: DVec3) -> Result<NearestSurfacePoint, SurfacePointError> {
        if !point.is_finite() {
            return Err(SurfacePointError::NotFinite);
        }
        let mut best = (f64::INFINITY, usize::MAX, [0.0; 3]);
        let mut waiting = vec![(0.0, 0)];
        while let Some((distance, index)) = waiting.pop() {
            if distance > best.0 {
                continue;
            }
            let node = self.nodes[index];
            if let Some(second) = node.second {
                let mut halves = [index + 1, second].map(|i| (self.distance_to_box(i, point), i));
                if halves[0].0 <= halves[1].0 {
                    halves.reverse();
                }
                waiting.extend(halves);
                continue;
            }
            for &face in &self.faces[node.start..node.end] {
                let (distance, weights) = nearest_in_triangle(self.surface.corners(face), point);
                if distance < best.0 || (distance == best.0 && face < best.1) {
                    best = (distance, face, weights);
                }
            }
        }
        let (distance, face, weights) = best;
        let place = self
            .surface
            .simplified(SurfacePoint::Face { face, weights });
        Ok(NearestSurfacePoint {
            point: place,
            position: self.surface.position(place),
            distance,
        })
    }

    fn distance_to_box(&self, index: usize, point: DVec3) -> f64 {
        let node = self.nodes[index];
        distance(point, point.clamp(node.low, node.high))
    }
}

/// The distance of two points, however far; squares of coordinates beyond 1e150 would overflow.
fn distance(a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    let size = d.abs().max_element();
    if size > 1e-140 && size < 1e140 {
        d.length()
    } else if size > 0.0 && size.is_finite() {
        (d / size).length() * size
    } else {
        size
    }
}

/// The distance of a triangle and a point, and the barycentric coordinates of the nearest place.
///
/// The nearest of the three sides and, where its foot is inside, the plane: every candidate's distance is measured, so
/// that needles, segments and points are no special cases.
pub(crate) fn nearest_in_triangle(corners: [DVec3; 3], point: DVec3) -> (f64, [f64; 3]) {
    let mut best = (f64::INFINITY, [1.0, 0.0, 0.0]);
    let mut consider = |weights: [f64; 3], position: DVec3| {
        let distance = distance(position, point);
        if distance < best.0 {
            best = (distance, weights);
        }
    };
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        let along = b - a;
        let square = along.dot(along);
        let t = if square > 0.0 {
            ((point - a).dot(along) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let mut weights = [0.0; 3];
        weights[k] = 1.0 - t;
        weights[(k + 1) % 3] = t;
        let position = if t <= 0.5 {
            a + along * t
        } else {
            b - along * (1.0 - t)
        };
        consider(weights, position);
    }
    let [a, b, c] = corners;
    let (u, v, w) = (b - a, c - a, point - a);
    let normal = u.cross(v);
    let square = normal.dot(normal);
    if square > 0.0 && square.is_finite() {
        let second = w.cross(v).dot(normal) / square;
        let third = u.cross(w).dot(normal) / square;
        let first = 1.0 - second - third;
        if first > 0.0 && second > 0.0 && third > 0.0 {
            consider([first, second, third], a + u * second + v * third);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, rough, sphere};

    fn by_looking_at_all(surface: &Surface, point: DVec3) -> f64 {
        (0..surface.topology().faces())
            .filter(|&face| surface.topology().sides(face).is_some())
            .map(|face| nearest_in_triangle(surface.corners(face), point).0)
            .fold(f64::INFINITY, f64::min)
    }

    fn assert_nearest(surface: &Surface, point: DVec3) {
        let found = SurfaceTree::new(surface).nearest(point).expect("a place");
        assert_eq!(found.distance, by_looking_at_all(surface, point));
        assert_eq!(surface.simplest(found.point), Ok(found.point));
        let again = found.position.distance(point);
        assert!((again - found.distance).abs() <= 1e-14 * (1.0 + again));
    }

    #[test]
    fn as_near_as_the_nearest_of_all_faces() {
        let mut random = Random::new(2);
        for size in [1, 2, 5, 17] {
            let surface = rough(size, size, &mut random);
            for _ in 0..200 {
                let point = random.vector() * (2.0 * size as f64);
                assert_nearest(&surface, point);
            }
        }
        // A soup of triangles, among them points, segments and faces that name a vertex twice.
        for round in 0..50 {
            let mut positions: Vec<DVec3> = (0..30).map(|_| random.vector()).collect();
            positions[1] = positions[0];
            positions[3] = (positions[4] + positions[5]) * 0.5;
            let mut faces = vec![[0, 1, 2], [3, 4, 5], [7, 7, 8]];
            faces.extend((0..round).map(|_| [(); 3].map(|()| random.below(30))));
            let surface = Surface::new(positions, &faces).expect("a soup");
            for _ in 0..20 {
                assert_nearest(&surface, random.vector() * 1.5);
            }
        }
    }

    #[test]
    fn a_fine_triangle_by_dense_sampling() {
        // The candidates themselves: no sample of the triangle is nearer than what was found.
        let mut random = Random::new(3);
        for round in 0..200 {
            let mut corners = [(); 3].map(|()| random.vector());
            if round % 4 == 0 {
                corners[2] = corners[0] + (corners[1] - corners[0]) * 0.3 + random.vector() * 1e-9;
            }
            let point = random.vector();
            let (distance, weights) = nearest_in_triangle(corners, point);
            let [a, b, c] = corners;
            let at = |w: [f64; 3]| a * w[0] + b * w[1] + c * w[2];
            assert!((at(weights).distance(point) - distance).abs() < 1e-14);
            for i in 0..=40 {
                for j in 0..=40 - i {
                    let w = [i as f64 / 40.0, j as f64 / 40.0, (40 - i - j) as f64 / 40.0];
                    assert!(at(w).distance(point) >= distance - 1e-14);
                }
            }
        }
    }

    #[test]
    fn points_of_the_surface_are_their_own_nearest() {
        let mut random = Random::new(4);
        let sphere = sphere(3);
        let tree = SurfaceTree::new(&sphere);
        for _ in 0..500 {
            let place = random.place(&sphere);
            let found = tree.nearest(sphere.position(place)).expect("a place");
            assert!(found.distance < 1e-15);
        }
        for point in [DVec3::NAN, DVec3::INFINITY] {
            assert_eq!(tree.nearest(point), Err(SurfacePointError::NotFinite));
        }
        let far = tree.nearest(DVec3::X * 1e300).expect("a place");
        assert_eq!(far.distance, 1e300);
    }
}
