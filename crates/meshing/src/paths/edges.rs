//! The shortest path along edges.
//!
//! *Source*: E. W. Dijkstra, *A Note on Two Problems in Connexion with Graphs*, Numerische Mathematik 1, 1959. Only the
//! topology and the lengths of edges are needed; [`EdgeDistances`] takes no more. Of paths equally long, to the last bit
//! of their sums, that whose vertices are reached first from lower vertices is taken.
//!
//! Such a path is longer than the shortest on the surface, and stays so when the mesh is refined.

use std::collections::BinaryHeap;

use super::{PathError, SurfacePath, Trace, Waiting, checked};
use crate::{Surface, SurfacePoint, Topology};

/// How a path along edges ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EdgeEnd {
    /// At the target.
    Reached,
    /// No edges lead from the start to the target; the path is the start alone.
    Apart,
}

/// The distance of every vertex along edges from some vertices, and the way back.
///
/// Made once in O((v + e) log v) for `v` vertices and `e` edges; each path then takes time for its own length.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeDistances {
    distances: Vec<f64>,
    /// The vertex and edge by which a vertex was reached; none for the sources.
    previous: Vec<Option<(usize, usize)>>,
}

impl EdgeDistances {
    /// Distances from sources, each a vertex with the distance at which it starts. `length` gives the length of an edge
    /// by its number; lengths that are negative or not a number count as 0. Sources that do not exist are left out.
    #[must_use]
    pub fn new(
        topology: &Topology,
        length: impl Fn(usize) -> f64,
        sources: &[(usize, f64)],
    ) -> Self {
        Self::until(topology, length, sources, |_| false)
    }

    /// As [`new`](Self::new), stopping when `enough` says so of a distance that is final.
    fn until(
        topology: &Topology,
        length: impl Fn(usize) -> f64,
        sources: &[(usize, f64)],
        mut enough: impl FnMut(Waiting) -> bool,
    ) -> Self {
        let mut all = Self {
            distances: vec![f64::INFINITY; topology.vertices()],
            previous: vec![None; topology.vertices()],
        };
        let mut queue = BinaryHeap::new();
        for &(node, distance) in sources {
            if all
                .distances
                .get(node)
                .is_some_and(|&known| distance < known)
            {
                all.distances[node] = distance;
                queue.push(Waiting { distance, node });
            }
        }
        while let Some(waiting) = queue.pop() {
            let Waiting { distance, node } = waiting;
            if distance > all.distances[node] {
                continue;
            }
            if enough(waiting) {
                break;
            }
            let corners = topology.corners(node);
            for edge in corners.iter().flat_map(|c| [c.before, c.after]) {
                let [a, b] = topology.ends(edge);
                let other = if a == node { b } else { a };
                // `max` takes 0 where the length is not a number.
                let farther = distance + length(edge).max(0.0);
                if farther < all.distances[other] {
                    all.distances[other] = farther;
                    all.previous[other] = Some((node, edge));
                    queue.push(Waiting {
                        distance: farther,
                        node: other,
                    });
                }
            }
        }
        all
    }

    /// The distance of a vertex; `None` where no edges lead to it.
    #[must_use]
    pub fn distance(&self, vertex: usize) -> Option<f64> {
        let distance = self.distances.get(vertex).copied();
        distance.filter(|distance| distance.is_finite())
    }

    /// The vertices from the nearest source to a vertex, with the edges between them, one fewer; `None` where no edges
    /// lead to it.
    #[must_use]
    pub fn path_to(&self, vertex: usize) -> Option<(Vec<usize>, Vec<usize>)> {
        self.distance(vertex)?;
        let (mut vertices, mut edges) = (vec![vertex], Vec::new());
        let mut current = vertex;
        while let Some((previous, edge)) = self.previous[current] {
            vertices.push(previous);
            edges.push(edge);
            current = previous;
        }
        vertices.reverse();
        edges.reverse();
        Some((vertices, edges))
    }
}

/// The shortest path along edges between two places.
///
/// A place on an edge or in a face enters the edges by the corners of the faces that it touches, straight across the face.
/// Two places of one face are joined within it.
///
/// # Errors
/// Where a place is not on the surface.
pub fn edge_path(
    surface: &Surface,
    from: SurfacePoint,
    to: SurfacePoint,
) -> Result<SurfacePath<EdgeEnd>, PathError> {
    let from = checked(surface, "start", from)?;
    let to = checked(surface, "target", to)?;
    let mut trace = Trace::new(surface, from);
    if from == to {
        return Ok(trace.end(EdgeEnd::Reached));
    }
    if let Some(face) = surface.shared_face(from, to) {
        trace.step(face, to);
        return Ok(trace.end(EdgeEnd::Reached));
    }
    let (sources, targets) = (gates(surface, from), gates(surface, to));
    let mut best: Option<(f64, usize)> = None;
    let distances = EdgeDistances::until(
        surface.topology(),
        |edge| surface.edge_length(edge),
        &sources,
        |Waiting { distance, node }| {
            if best.is_some_and(|(length, _)| distance > length) {
                return true;
            }
            for &(_, rest) in targets.iter().filter(|gate| gate.0 == node) {
                if best.is_none_or(|(length, _)| distance + rest < length) {
                    best = Some((distance + rest, node));
                }
            }
            false
        },
    );
    let Some((vertices, edges)) = best.and_then(|(_, gate)| distances.path_to(gate)) else {
        return Ok(trace.end(EdgeEnd::Apart));
    };
    let ends = [vertices.first(), vertices.last()].map(|v| v.map(|&v| SurfacePoint::Vertex(v)));
    let [Some(first), Some(last)] = ends else {
        return Ok(trace.end(EdgeEnd::Apart));
    };
    if let Some(face) = surface.shared_face(from, first) {
        trace.step(face, first);
    }
    for (edge, &vertex) in edges.into_iter().zip(&vertices[1..]) {
        trace.step(
            surface.topology().edge_faces(edge)[0],
            SurfacePoint::Vertex(vertex),
        );
    }
    if let Some(face) = surface.shared_face(last, to) {
        trace.step(face, to);
    }
    Ok(trace.end(EdgeEnd::Reached))
}

/// The vertices by which a place enters the edges, with their distances: itself, or the corners of its faces.
fn gates(surface: &Surface, point: SurfacePoint) -> Vec<(usize, f64)> {
    if let SurfacePoint::Vertex(vertex) = point {
        return vec![(vertex, 0.0)];
    }
    let position = surface.position(point);
    let mut vertices: Vec<usize> = surface
        .faces_at(point)
        .into_iter()
        .flat_map(|face| surface.topology().triangle(face))
        .collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices
        .into_iter()
        .map(|v| (v, position.distance(surface.positions()[v])))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, assert_lawful, cube, grid, rough};
    use anamorph_core::glam::DVec3;

    /// All distances along edges, by Floyd and Warshall.
    fn all_distances(surface: &Surface) -> Vec<Vec<f64>> {
        let n = surface.topology().vertices();
        let mut d = vec![vec![f64::INFINITY; n]; n];
        for (v, row) in d.iter_mut().enumerate() {
            row[v] = 0.0;
        }
        for edge in 0..surface.topology().edges() {
            let [a, b] = surface.topology().ends(edge);
            d[a][b] = surface.edge_length(edge);
            d[b][a] = d[a][b];
        }
        for k in 0..n {
            for i in 0..n {
                for j in 0..n {
                    d[i][j] = d[i][j].min(d[i][k] + d[k][j]);
                }
            }
        }
        d
    }

    #[test]
    fn distances_are_those_of_all_pairs() {
        let mut random = Random::new(8);
        for round in 0..12 {
            let surface = if round % 3 == 0 {
                // Random faces, in pieces, with edges of many faces.
                let positions: Vec<DVec3> = (0..30).map(|_| random.vector()).collect();
                let faces: Vec<[usize; 3]> = (0..14)
                    .map(|_| [(); 3].map(|()| random.below(30)))
                    .collect();
                Surface::new(positions, &faces).expect("a soup")
            } else {
                rough(5, 4, &mut random)
            };
            let all = all_distances(&surface);
            for (from, row) in all.iter().enumerate() {
                let tree = EdgeDistances::new(
                    surface.topology(),
                    |e| surface.edge_length(e),
                    &[(from, 0.0)],
                );
                for (to, &known) in row.iter().enumerate() {
                    match tree.distance(to) {
                        Some(distance) => assert!((distance - known).abs() < 1e-12),
                        None => assert_eq!(known, f64::INFINITY),
                    }
                    let path = edge_path(
                        &surface,
                        SurfacePoint::Vertex(from),
                        SurfacePoint::Vertex(to),
                    );
                    let path = path.expect("a path");
                    assert_lawful(&surface, &path);
                    if known.is_finite() {
                        assert_eq!(path.ending, EdgeEnd::Reached);
                        assert!((path.length - known).abs() < 1e-12);
                    } else {
                        assert_eq!((path.ending, path.points.len()), (EdgeEnd::Apart, 1));
                    }
                }
            }
        }
    }

    #[test]
    fn places_off_the_vertices_enter_by_the_best_corner() {
        let mut random = Random::new(9);
        let surface = rough(6, 6, &mut random);
        let all = all_distances(&surface);
        for _ in 0..400 {
            let (from, to) = (random.place(&surface), random.place(&surface));
            let path = edge_path(&surface, from, to).expect("a path");
            assert_lawful(&surface, &path);
            assert_eq!(path.ending, EdgeEnd::Reached);
            let straight = surface.position(from).distance(surface.position(to));
            assert!(path.length >= straight - 1e-12);
            let expected = if surface.shared_face(from, to).is_some() {
                straight
            } else {
                let (sources, targets) = (gates(&surface, from), gates(&surface, to));
                let pairs = sources
                    .iter()
                    .flat_map(|s| targets.iter().map(move |t| (s, t)));
                pairs
                    .map(|(s, t)| s.1 + all[s.0][t.0] + t.1)
                    .fold(f64::INFINITY, f64::min)
            };
            assert!((path.length - expected).abs() < 1e-12);
            assert_eq!(path.points.last().copied(), surface.simplest(to).ok());
        }
    }

    #[test]
    fn ties_are_decided_alike_and_many_targets_need_one_tree() {
        // On the cube and the grid most distances have several shortest paths.
        let flat = grid(8, 8, |_, _| 0.0);
        let tree = EdgeDistances::new(
            flat.topology(),
            |e| flat.edge_length(e),
            &[(0, 0.0), (80, 0.5)],
        );
        let (vertices, edges) = tree.path_to(8).expect("a path");
        assert_eq!(vertices, (0..=8).collect::<Vec<_>>());
        assert_eq!(edges.len(), 8);
        assert_eq!(tree.distance(79), Some(1.5));
        assert_eq!(tree.distance(99), None);
        let again = EdgeDistances::new(
            flat.topology(),
            |e| flat.edge_length(e),
            &[(80, 0.5), (0, 0.0)],
        );
        assert_eq!(tree, again, "the order of the sources does not matter");
        let path =
            edge_path(&cube(), SurfacePoint::Vertex(1), SurfacePoint::Vertex(6)).expect("a path");
        assert!((path.length - (1.0 + 2.0_f64.sqrt())).abs() < 1e-15);
        // Lengths that are no lengths count as 0 instead of going around for ever.
        let odd = EdgeDistances::new(
            flat.topology(),
            |e| if e % 2 == 0 { -1.0 } else { f64::NAN },
            &[(40, 0.0), (99, 0.0)],
        );
        assert!((0..81).all(|v| odd.distance(v) == Some(0.0)));
    }
}
