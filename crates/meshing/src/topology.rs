//! Which vertices, edges and faces of a triangle mesh touch, in linear time and memory.
//!
//! Edges are found by sorting the sides of all faces by their two vertices with a counting sort (D. E. Knuth, *The Art of
//! Computer Programming* 3, §5.2, algorithm D), so that their numbers follow from the faces alone. Around each vertex the
//! faces are put in order by crossing edges. Any mesh is taken as it is: open, closed, in pieces, with edges of three
//! faces and more, with faces wound either way.

use core::ops::Range;

use crate::TopologyError;

/// A face at a vertex, between two edges that end there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Corner {
    /// The face.
    pub face: usize,
    /// The edge by which the face is entered when going around the vertex in order.
    pub before: usize,
    /// The edge by which it is left.
    pub after: usize,
}

/// The neighbourhoods of a triangle mesh of `v` vertices, `f` faces and `e` edges, each numbered from 0.
///
/// Faces keep the caller's numbers. A face that names a vertex twice (*degenerate*) keeps its number but has no edges and
/// touches nothing; [`degenerate`](Self::degenerate) lists them. Edges are numbered in the order of their vertices, the
/// lower first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Topology {
    triangles: Vec<[usize; 3]>,
    sides: Vec<Option<[usize; 3]>>,
    degenerate: Vec<usize>,
    ends: Vec<[usize; 2]>,
    /// Faces of edge `e`: `edge_faces[edge_start[e]..edge_start[e + 1]]`.
    edge_start: Vec<usize>,
    edge_faces: Vec<usize>,
    /// Corners at vertex `v`: `ring[ring_start[v]..ring_start[v + 1]]`.
    ring_start: Vec<usize>,
    ring: Vec<Corner>,
}

impl Topology {
    /// The topology of triangles over `vertices` vertices. Vertices of no face are allowed.
    ///
    /// # Errors
    /// Where there is no face, a face names a vertex that does not exist, or every face names a vertex twice.
    pub fn new(vertices: usize, triangles: &[[usize; 3]]) -> Result<Self, TopologyError> {
        if triangles.is_empty() {
            return Err(TopologyError::Empty);
        }
        for (face, triangle) in triangles.iter().enumerate() {
            if let Some(&vertex) = triangle.iter().find(|&&vertex| vertex >= vertices) {
                return Err(TopologyError::IndexOutOfRange {
                    face,
                    vertex,
                    vertices,
                });
            }
        }
        let repeats = |t: &[usize; 3]| t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
        let degenerate: Vec<usize> = (0..triangles.len())
            .filter(|&face| repeats(&triangles[face]))
            .collect();
        if degenerate.len() == triangles.len() {
            return Err(TopologyError::AllDegenerate {
                faces: triangles.len(),
            });
        }

        let mut topology = Self {
            triangles: triangles.to_vec(),
            sides: triangles
                .iter()
                .map(|t| (!repeats(t)).then_some([0; 3]))
                .collect(),
            degenerate,
            ends: Vec::new(),
            edge_start: Vec::new(),
            edge_faces: Vec::new(),
            ring_start: Vec::new(),
            ring: Vec::new(),
        };
        topology.find_edges(vertices);
        topology.order_corners(vertices);
        Ok(topology)
    }

    /// Side `k` of face `f` has the number `3f + k` and joins the face's corners `k` and `k + 1`.
    fn side_ends(&self, side: usize) -> [usize; 2] {
        let triangle = self.triangles[side / 3];
        let (a, b) = (triangle[side % 3], triangle[(side + 1) % 3]);
        [a.min(b), a.max(b)]
    }

    fn find_edges(&mut self, vertices: usize) {
        let sides: Vec<usize> = (0..3 * self.triangles.len())
            .filter(|side| self.sides[side / 3].is_some())
            .collect();
        let sides = counting_sort(&sides, vertices, |&side| self.side_ends(side)[1]).0;
        let sides = counting_sort(&sides, vertices, |&side| self.side_ends(side)[0]).0;
        for side in sides {
            let ends = self.side_ends(side);
            if self.ends.last() != Some(&ends) {
                self.ends.push(ends);
                self.edge_start.push(self.edge_faces.len());
            }
            self.edge_faces.push(side / 3);
            if let Some(sides) = &mut self.sides[side / 3] {
                sides[side % 3] = self.ends.len() - 1;
            }
        }
        self.edge_start.push(self.edge_faces.len());
    }

    fn order_corners(&mut self, vertices: usize) {
        let corners: Vec<usize> = (0..3 * self.triangles.len())
            .filter(|corner| self.sides[corner / 3].is_some())
            .collect();
        let vertex_of = |corner: &usize| self.triangles[corner / 3][corner % 3];
        let (corners, start) = counting_sort(&corners, vertices, vertex_of);
        let mut placed = vec![false; 3 * self.triangles.len()];
        let mut ring = Vec::with_capacity(corners.len());
        for vertex in 0..vertices {
            for &corner in &corners[start[vertex]..start[vertex + 1]] {
                if !placed[corner] {
                    self.place_fan(vertex, corner, &mut placed, &mut ring);
                }
            }
        }
        (self.ring_start, self.ring) = (start, ring);
    }

    /// Appends the faces that are connected with a corner across edges of its vertex, in order.
    fn place_fan(&self, vertex: usize, corner: usize, placed: &mut [bool], ring: &mut Vec<Corner>) {
        let Some(sides) = self.sides[corner / 3] else {
            return;
        };
        // Seen from the front of a face, its corner lies between the side that leaves the vertex and the one that arrives.
        let first = Corner {
            face: corner / 3,
            before: sides[corner % 3],
            after: sides[(corner + 2) % 3],
        };
        let turned = |c: Corner| Corner {
            face: c.face,
            before: c.after,
            after: c.before,
        };
        let mut start = first;
        while let Some(previous) = self.next_corner(vertex, turned(start)).map(turned) {
            start = previous;
            if start.face == first.face {
                break;
            }
        }
        let mut current = start;
        loop {
            let triangle = self.triangles[current.face];
            for (k, &v) in triangle.iter().enumerate() {
                if v == vertex {
                    placed[3 * current.face + k] = true;
                }
            }
            ring.push(current);
            match self.next_corner(vertex, current) {
                Some(next) if next.face != start.face => current = next,
                _ => return,
            }
        }
    }

    /// The corner behind the edge by which a corner is left, where exactly two faces meet.
    fn next_corner(&self, vertex: usize, corner: Corner) -> Option<Corner> {
        let face = self.across(corner.face, corner.after)?;
        let after = self.sides[face]?
            .into_iter()
            .find(|&side| side != corner.after && self.ends[side].contains(&vertex))?;
        Some(Corner {
            face,
            before: corner.after,
            after,
        })
    }

    /// How many vertices there are, those of no face included.
    #[must_use]
    pub fn vertices(&self) -> usize {
        self.ring_start.len() - 1
    }

    /// How many faces there are, degenerate ones included.
    #[must_use]
    pub fn faces(&self) -> usize {
        self.triangles.len()
    }

    /// How many edges there are.
    #[must_use]
    pub fn edges(&self) -> usize {
        self.ends.len()
    }

    /// The faces that name a vertex twice, in order; they are no part of the surface.
    #[must_use]
    pub fn degenerate(&self) -> &[usize] {
        &self.degenerate
    }

    /// The vertices of a face, as given.
    ///
    /// # Panics
    /// Where the face does not exist, like a slice; so do the other methods that take a number.
    #[must_use]
    pub fn triangle(&self, face: usize) -> [usize; 3] {
        self.triangles[face]
    }

    /// The edges of a face: edge `k` joins its corners `k` and `k + 1` (mod 3). `None` for degenerate faces.
    #[must_use]
    pub fn sides(&self, face: usize) -> Option<[usize; 3]> {
        self.sides[face]
    }

    /// The two vertices of an edge, the lower first.
    #[must_use]
    pub fn ends(&self, edge: usize) -> [usize; 2] {
        self.ends[edge]
    }

    /// The faces at an edge, in order: one at the boundary, two inside, more where the mesh is not a manifold.
    #[must_use]
    pub fn edge_faces(&self, edge: usize) -> &[usize] {
        &self.edge_faces[self.edge_start[edge]..self.edge_start[edge + 1]]
    }

    /// The face on the other side of an edge, where exactly two faces meet.
    #[must_use]
    pub fn across(&self, face: usize, edge: usize) -> Option<usize> {
        match *self.edge_faces(edge) {
            [a, b] if a == face => Some(b),
            [a, b] if b == face => Some(a),
            _ => None,
        }
    }

    /// The edge between two vertices, by binary search.
    #[must_use]
    pub fn edge_between(&self, a: usize, b: usize) -> Option<usize> {
        self.ends.binary_search(&[a.min(b), a.max(b)]).ok()
    }

    /// The corners at a vertex, fan after fan, in order around it: counter-clockwise as seen from the front of the lowest
    /// face of the fan.
    #[must_use]
    pub fn corners(&self, vertex: usize) -> &[Corner] {
        let range: Range<usize> = self.ring_start[vertex]..self.ring_start[vertex + 1];
        &self.ring[range]
    }

    /// The fans of a vertex: runs of faces that hang together across edges of the vertex. One at an ordinary vertex, none
    /// at a vertex of no face, several where surfaces touch in a point. Edges of three faces and more end a fan.
    pub fn fans(&self, vertex: usize) -> impl Iterator<Item = &[Corner]> {
        self.corners(vertex)
            .chunk_by(|a, b| a.after == b.before && self.edge_faces(a.after).len() == 2)
    }

    /// Whether a fan goes all the way around its vertex.
    #[must_use]
    pub fn is_closed(&self, fan: &[Corner]) -> bool {
        match (fan.first(), fan.last()) {
            (Some(first), Some(last)) => {
                first.before == last.after && self.edge_faces(last.after).len() == 2
            }
            _ => false,
        }
    }

    /// Whether an edge has one face only.
    #[must_use]
    pub fn is_boundary_edge(&self, edge: usize) -> bool {
        self.edge_faces(edge).len() == 1
    }

    /// Whether an edge of one face only ends at the vertex. A vertex of no face is not at the boundary.
    #[must_use]
    pub fn is_boundary_vertex(&self, vertex: usize) -> bool {
        self.corners(vertex)
            .iter()
            .any(|c| self.is_boundary_edge(c.before) || self.is_boundary_edge(c.after))
    }

    /// The edges of one face only, in order.
    pub fn boundary_edges(&self) -> impl Iterator<Item = usize> {
        (0..self.edges()).filter(|&edge| self.is_boundary_edge(edge))
    }

    /// The edges of three faces and more, in order.
    pub fn non_manifold_edges(&self) -> impl Iterator<Item = usize> {
        (0..self.edges()).filter(|&edge| self.edge_faces(edge).len() > 2)
    }

    /// The edges of two faces whose windings disagree, in order.
    pub fn turned_edges(&self) -> impl Iterator<Item = usize> {
        (0..self.edges()).filter(|&edge| match *self.edge_faces(edge) {
            [a, b] => self.runs_up(a, edge) == self.runs_up(b, edge),
            _ => false,
        })
    }

    /// Whether a face goes along an edge from the lower vertex to the higher.
    fn runs_up(&self, face: usize, edge: usize) -> bool {
        let t = self.triangles[face];
        let [low, high] = self.ends[edge];
        (0..3).any(|k| t[k] == low && t[(k + 1) % 3] == high)
    }
}

/// Items in the order of their keys, which are below `bound`; equal keys keep their order. With the places at which the
/// keys start, one more than there are keys.
fn counting_sort(
    items: &[usize],
    bound: usize,
    key: impl Fn(&usize) -> usize,
) -> (Vec<usize>, Vec<usize>) {
    let mut start = vec![0; bound + 1];
    for item in items {
        start[key(item) + 1] += 1;
    }
    for k in 0..bound {
        start[k + 1] += start[k];
    }
    let mut next = start.clone();
    let mut sorted = vec![0; items.len()];
    for item in items {
        let place = &mut next[key(item)];
        sorted[*place] = *item;
        *place += 1;
    }
    (sorted, start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, cube, grid_faces};

    /// Everything that the topology says, found again by looking at all faces.
    fn assert_sane(topology: &Topology) {
        let faces: Vec<usize> = (0..topology.faces())
            .filter(|&f| topology.sides(f).is_some())
            .collect();
        let mut pairs = std::collections::BTreeMap::<[usize; 2], Vec<usize>>::new();
        for &face in &faces {
            let t = topology.triangle(face);
            for k in 0..3 {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                pairs.entry([a.min(b), a.max(b)]).or_default().push(face);
                let edge = topology.edge_between(a, b).expect("an edge");
                assert_eq!(topology.sides(face).map(|s| s[k]), Some(edge));
            }
        }
        assert_eq!(topology.edges(), pairs.len());
        for (edge, (ends, faces)) in pairs.iter().enumerate() {
            assert_eq!(topology.ends(edge), *ends);
            assert_eq!(topology.edge_faces(edge), faces);
        }
        for vertex in 0..topology.vertices() {
            let mut seen: Vec<usize> = topology.corners(vertex).iter().map(|c| c.face).collect();
            seen.sort_unstable();
            let all = faces.iter().copied();
            let expected: Vec<usize> = all
                .filter(|&f| topology.triangle(f).contains(&vertex))
                .collect();
            assert_eq!(seen, expected);
            for fan in topology.fans(vertex) {
                for c in fan {
                    let sides = topology.sides(c.face).expect("sides");
                    assert!(sides.contains(&c.before) && sides.contains(&c.after));
                    assert_ne!(c.before, c.after);
                    for edge in [c.before, c.after] {
                        assert!(topology.ends(edge).contains(&vertex));
                    }
                }
                for pair in fan.windows(2) {
                    assert_eq!(
                        topology.across(pair[0].face, pair[0].after),
                        Some(pair[1].face)
                    );
                }
                // Fans are as long as they can be: no face of a manifold edge is left out.
                let (first, last) = (fan[0], fan[fan.len() - 1]);
                if topology.is_closed(fan) {
                    assert_eq!(topology.across(last.face, last.after), Some(first.face));
                } else {
                    assert_eq!(topology.across(first.face, first.before), None);
                    assert_eq!(topology.across(last.face, last.after), None);
                }
            }
        }
    }

    #[test]
    fn a_cube_is_closed_and_of_euler_characteristic_two() {
        let cube = cube();
        let topology = cube.topology();
        assert_sane(topology);
        assert_eq!(8 + topology.faces() - topology.edges(), 2);
        assert_eq!(topology.boundary_edges().count(), 0);
        assert_eq!(topology.non_manifold_edges().count(), 0);
        assert_eq!(topology.turned_edges().count(), 0);
        for vertex in 0..8 {
            let fans: Vec<_> = topology.fans(vertex).collect();
            assert_eq!(fans.len(), 1);
            assert!(topology.is_closed(fans[0]));
            assert!(!topology.is_boundary_vertex(vertex));
            // Counter-clockwise from outside: the far ends turn left about the way out.
            let far = |edge: usize| topology.ends(edge).into_iter().find(|&v| v != vertex);
            let out = cube.positions()[vertex] - anamorph_core::glam::DVec3::splat(0.5);
            for corner in fans[0] {
                let [a, b] = [corner.before, corner.after]
                    .map(|e| cube.positions()[far(e).expect("an end")] - cube.positions()[vertex]);
                assert!(a.cross(b).dot(out) > 0.0);
            }
        }
    }

    #[test]
    fn a_strip_with_a_half_twist_has_turned_edges_and_one_boundary() {
        let faces: Vec<[usize; 3]> = (0..5).map(|k| [k, (k + 1) % 5, (k + 2) % 5]).collect();
        let strip = Topology::new(5, &faces).expect("a Möbius strip");
        assert_sane(&strip);
        assert_eq!(5 + strip.faces() - strip.edges(), 0);
        assert_eq!(strip.boundary_edges().count(), 5);
        assert!(strip.turned_edges().count() > 0);
        for vertex in 0..5 {
            assert_eq!(
                strip.fans(vertex).map(<[Corner]>::len).collect::<Vec<_>>(),
                [3]
            );
        }
    }

    #[test]
    fn edges_of_three_faces_and_vertices_of_two_fans_are_named() {
        let book = [[0, 1, 2], [0, 1, 3], [0, 1, 4]];
        let book = Topology::new(5, &book).expect("a book");
        assert_sane(&book);
        let spine = book.edge_between(0, 1).expect("the spine");
        assert_eq!(book.non_manifold_edges().collect::<Vec<_>>(), [spine]);
        assert_eq!(book.edge_faces(spine), [0, 1, 2]);
        assert_eq!(book.across(0, spine), None);
        assert_eq!(book.fans(0).count(), 3);

        let tie = Topology::new(6, &[[0, 1, 2], [0, 3, 4]]).expect("a bow tie");
        assert_sane(&tie);
        assert_eq!(tie.fans(0).count(), 2);
        assert_eq!(tie.fans(5).count(), 0, "a vertex of no face");
        assert!(!tie.is_boundary_vertex(5));

        // Two triangles back to back, the same face twice: both are ordinary closed fans.
        let pillow = Topology::new(3, &[[0, 1, 2], [0, 2, 1]]).expect("a pillow");
        assert_sane(&pillow);
        assert!(pillow.fans(1).all(|fan| pillow.is_closed(fan)));
    }

    #[test]
    fn degenerate_faces_are_left_out_and_listed() {
        let faces = [[0, 1, 2], [1, 1, 2], [2, 1, 3], [3, 2, 3]];
        let topology = Topology::new(4, &faces).expect("two faces");
        assert_sane(&topology);
        assert_eq!(topology.degenerate(), [1, 3]);
        assert_eq!(topology.faces(), 4);
        assert_eq!(topology.sides(1), None);
        assert_eq!(topology.triangle(1), [1, 1, 2]);
        assert_eq!(topology.edges(), 5);
    }

    #[test]
    fn what_is_wrong_is_named() {
        assert_eq!(Topology::new(3, &[]), Err(TopologyError::Empty));
        let beyond = Topology::new(3, &[[0, 1, 2], [0, 1, 3]]);
        let expected = TopologyError::IndexOutOfRange {
            face: 1,
            vertex: 3,
            vertices: 3,
        };
        assert_eq!(beyond, Err(expected));
        assert!(expected.to_string().contains("face 1 names vertex 3"));
        let repeated = Topology::new(3, &[[0, 0, 2]]);
        assert_eq!(repeated, Err(TopologyError::AllDegenerate { faces: 1 }));
    }

    #[test]
    fn random_faces_of_any_kind() {
        let mut random = Random::new(1);
        for round in 0..300 {
            let vertices = 3 + round % 9;
            let faces: Vec<[usize; 3]> = (0..1 + round % 40)
                .map(|_| [(); 3].map(|()| random.below(vertices)))
                .collect();
            if let Ok(topology) = Topology::new(vertices, &faces) {
                assert_sane(&topology);
            }
        }
        let grid = Topology::new(35, &grid_faces(6, 4)).expect("a grid");
        assert_sane(&grid);
        assert_eq!(grid.boundary_edges().count(), 20);
    }

    #[test]
    fn a_vertex_of_many_faces_takes_linear_time() {
        let n = 200_000;
        let faces: Vec<[usize; 3]> = (0..n).map(|k| [k, (k + 1) % n, n]).collect();
        let cone = Topology::new(n + 1, &faces).expect("a cone");
        let fans: Vec<_> = cone.fans(n).collect();
        assert_eq!(fans.len(), 1);
        assert_eq!(fans[0].len(), n);
        assert!(cone.is_closed(fans[0]));
    }
}
