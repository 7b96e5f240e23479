//! The path between two places along the section of the surface by a plane.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Path finding": a plane that contains the two points and is generally
//! perpendicular to the surface, for example that of the average of their two normals; its intersection with the faces is
//! the path, reasonable but not necessarily shortest.
//!
//! The section is walked as a graph whose nodes are the edges that the plane crosses and the vertices on it, joined
//! within faces, by E. W. Dijkstra's *A Note on Two Problems in Connexion with Graphs*, Numerische Mathematik 1, 1959. On
//! an ordinary surface that walks both ways from the start at once and stops when the shorter way has reached the target;
//! through vertices, along edges and at edges of three faces it is still complete. A vertex whose signed distance from the
//! plane is less than its rounding error counts as on the plane, so that what the numbers cannot tell is not decided by
//! accident; all other signs are certain. Within faces that lie in the plane the path follows the edges.

use std::collections::{BTreeMap, BinaryHeap};

use anamorph_core::glam::DVec3;

use super::{PathError, SurfacePath, Trace, Waiting, checked, unit};
use crate::{Surface, SurfacePoint};

/// Directions whose angle has a smaller sine than this span no plane: rounding would choose it.
const PARALLEL: f64 = 1e-9;

/// A vertex nearer to the plane than this many units in the last place of the numbers that its distance is made of may be
/// on either side: three products, three differences, a normal of some five roundings and an origin of as many.
const ROUNDINGS: f64 = 16.0;

/// Which of the planes through two places is meant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Upright {
    /// The one that contains the average of the normals at both. Where that is null or along the way from start to
    /// target: the normal at the start, else that at the target, else the coordinate axis least along the way.
    Normals,
    /// The one that contains a direction, of any length.
    Along(DVec3),
}

/// How a section ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SectionEnd {
    /// At the target.
    Reached,
    /// At the boundary of the surface: the plane does not join the places before that. The path leads to the end nearest
    /// to the target in space.
    Boundary,
    /// The section through the start is closed and does not contain the target. The path leads to its corner nearest to
    /// the target in space.
    Apart,
}

/// A plane that cuts a surface through two places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionPlane<'a> {
    surface: &'a Surface,
    from: SurfacePoint,
    to: SurfacePoint,
    origin: DVec3,
    normal: DVec3,
}

impl<'a> SectionPlane<'a> {
    /// The plane through two places that are not at the same point of space.
    ///
    /// # Errors
    /// Where a place is not on the surface, both are at the same point, or the upright direction is null, not finite, or
    /// along the way between them.
    pub fn between(
        surface: &'a Surface,
        from: SurfacePoint,
        to: SurfacePoint,
        upright: Upright,
    ) -> Result<Self, PathError> {
        let from = checked(surface, "start", from)?;
        let to = checked(surface, "target", to)?;
        let origin = surface.position(from);
        let chord =
            unit("chord", surface.position(to) - origin).map_err(|_| PathError::SamePlace)?;
        let normal_with = |up: DVec3| {
            let normal = chord.cross(up);
            // Rounding leans the cross product out of upright by as much as up is along the chord; a second look mends it.
            (normal.length() > PARALLEL)
                .then(|| normal.normalize())
                .and_then(|n| (n - chord * n.dot(chord)).try_normalize())
        };
        let normal = match upright {
            Upright::Along(up) => normal_with(unit("upright direction of the plane", up)?)
                .ok_or(PathError::UprightAlongChord)?,
            Upright::Normals => {
                let normals = [from, to].map(|p| surface.normal(p).unwrap_or(DVec3::ZERO));
                let sum = normals[0] + normals[1];
                // Normals that cancel to rounding have no average.
                let average = if sum.length() > PARALLEL {
                    sum.normalize()
                } else {
                    DVec3::ZERO
                };
                [average, normals[0], normals[1]]
                    .into_iter()
                    .find_map(normal_with)
                    .or_else(|| normal_with(DVec3::AXES[chord.abs().min_position()]))
                    .ok_or(PathError::SamePlace)?
            }
        };
        Ok(Self {
            surface,
            from,
            to,
            origin,
            normal,
        })
    }

    /// A point of the plane: where the path starts.
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The plane's unit normal, to the right of a walker who goes along the path and stands upright.
    #[must_use]
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The shortest path from start to target in the section of the surface.
    ///
    /// Takes time that grows with the number of faces crossed, and at most once for each edge and vertex.
    #[must_use]
    pub fn path(&self) -> SurfacePath<SectionEnd> {
        Search::new(self).run()
    }

    /// The signed distance of a vertex, exactly 0 where rounding does not tell its sign.
    fn side(&self, vertex: usize) -> f64 {
        let ends = [self.from, self.to];
        if ends.contains(&SurfacePoint::Vertex(vertex)) {
            return 0.0;
        }
        let offset = self.surface.positions()[vertex] - self.origin;
        let distance = self.normal.dot(offset);
        let noise = ROUNDINGS * f64::EPSILON * (offset.length() + self.origin.length());
        if distance.abs() <= noise {
            0.0
        } else {
            distance
        }
    }
}

/// The path between two places along the section of the surface by a plane; the shorter where there are two.
///
/// Two places of one face are joined within it. See [`SectionPlane`] for the plane itself.
///
/// # Errors
/// As [`SectionPlane::between`]; a place and itself are joined by a path of one point.
pub fn section(
    surface: &Surface,
    from: SurfacePoint,
    to: SurfacePoint,
    upright: Upright,
) -> Result<SurfacePath<SectionEnd>, PathError> {
    let from = checked(surface, "start", from)?;
    let to = checked(surface, "target", to)?;
    if from == to {
        return Ok(Trace::new(surface, from).end(SectionEnd::Reached));
    }
    if let Some(face) = surface.shared_face(from, to) {
        let mut trace = Trace::new(surface, from);
        trace.step(face, to);
        return Ok(trace.end(SectionEnd::Reached));
    }
    Ok(SectionPlane::between(surface, from, to, upright)?.path())
}

/// How a node was reached: from which, through which face, and how far from the start.
#[derive(Debug, Clone, Copy)]
struct Reached {
    distance: f64,
    from: Option<(usize, usize)>,
    settled: bool,
}

/// The walk through the section. Nodes are numbered: vertices, then edges, then the start and the target where they are in
/// faces.
struct Search<'a> {
    surface: &'a Surface,
    plane: &'a SectionPlane<'a>,
    reached: BTreeMap<usize, Reached>,
    queue: BinaryHeap<Waiting>,
}

impl<'a> Search<'a> {
    fn new(plane: &'a SectionPlane<'a>) -> Self {
        Self {
            surface: plane.surface,
            plane,
            reached: BTreeMap::new(),
            queue: BinaryHeap::new(),
        }
    }

    fn node_of(&self, end: SurfacePoint, in_face: usize) -> usize {
        let topology = self.surface.topology();
        match end {
            SurfacePoint::Vertex(vertex) => vertex,
            SurfacePoint::Edge { edge, .. } => topology.vertices() + edge,
            SurfacePoint::Face { .. } => topology.vertices() + topology.edges() + in_face,
        }
    }

    fn start(&self) -> usize {
        self.node_of(self.plane.from, 0)
    }

    fn target(&self) -> usize {
        self.node_of(self.plane.to, 1)
    }

    fn place(&self, node: usize) -> SurfacePoint {
        if node == self.start() {
            return self.plane.from;
        }
        if node == self.target() {
            return self.plane.to;
        }
        let vertices = self.surface.topology().vertices();
        if node < vertices {
            return SurfacePoint::Vertex(node);
        }
        let edge = node - vertices;
        let [low, high] = self
            .surface
            .topology()
            .ends(edge)
            .map(|v| self.plane.side(v));
        // The signs differ and are certain, so that the fraction lies within (0, 1) but for rounding.
        let fraction = (low / (low - high)).clamp(0.0, 1.0);
        self.surface
            .simplified(SurfacePoint::Edge { edge, fraction })
    }

    /// The nodes at which the section touches a face; within it, each is joined to each by a straight segment.
    fn nodes_of_face(&self, face: usize) -> Vec<usize> {
        let topology = self.surface.topology();
        let triangle = topology.triangle(face);
        let sides = triangle.map(|v| self.plane.side(v));
        let mut nodes: Vec<usize> = (0..3)
            .filter(|&k| sides[k] == 0.0)
            .map(|k| triangle[k])
            .collect();
        let ends = [self.start(), self.target()];
        for (k, edge) in topology.sides(face).into_iter().flatten().enumerate() {
            let node = topology.vertices() + edge;
            let crossed =
                sides[k].min(sides[(k + 1) % 3]) < 0.0 && sides[k].max(sides[(k + 1) % 3]) > 0.0;
            if crossed || ends.contains(&node) {
                nodes.push(node);
            }
        }
        for (end, node) in [self.plane.from, self.plane.to].into_iter().zip(ends) {
            if matches!(end, SurfacePoint::Face { face: own, .. } if own == face) {
                nodes.push(node);
            }
        }
        nodes
    }

    fn run(mut self) -> SurfacePath<SectionEnd> {
        let (start, target) = (self.start(), self.target());
        self.reach(start, 0.0, None);
        while let Some(Waiting { distance, node }) = self.queue.pop() {
            match self.reached.get_mut(&node) {
                Some(reached) if !reached.settled => reached.settled = true,
                _ => continue,
            }
            if node == target {
                return self.path_to(target, SectionEnd::Reached);
            }
            let place = self.place(node);
            let position = self.surface.position(place);
            for face in self.surface.faces_at(place) {
                for other in self.nodes_of_face(face) {
                    if other != node {
                        let step = position.distance(self.surface.position(self.place(other)));
                        self.reach(other, distance + step, Some((node, face)));
                    }
                }
            }
        }
        let goal = self.surface.position(self.plane.to);
        let nearest = |boundary_only: bool| {
            self.reached
                .iter()
                .filter(|&(&node, _)| !boundary_only || self.is_at_boundary(node))
                .map(|(&node, reached)| {
                    let far = self.surface.position(self.place(node)).distance(goal);
                    (far, reached.distance, node)
                })
                .min_by(|a, b| {
                    let by_distance = a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1));
                    by_distance.then(a.2.cmp(&b.2))
                })
        };
        match (nearest(true), nearest(false)) {
            (Some((.., node)), _) => self.path_to(node, SectionEnd::Boundary),
            (None, Some((.., node))) => self.path_to(node, SectionEnd::Apart),
            (None, None) => self.path_to(start, SectionEnd::Apart),
        }
    }

    fn is_at_boundary(&self, node: usize) -> bool {
        match self.place(node) {
            SurfacePoint::Vertex(vertex) => self.surface.topology().is_boundary_vertex(vertex),
            SurfacePoint::Edge { edge, .. } => self.surface.topology().is_boundary_edge(edge),
            SurfacePoint::Face { .. } => false,
        }
    }

    fn reach(&mut self, node: usize, distance: f64, from: Option<(usize, usize)>) {
        let nearer = self
            .reached
            .get(&node)
            .is_none_or(|reached| distance < reached.distance);
        if nearer {
            self.reached.insert(
                node,
                Reached {
                    distance,
                    from,
                    settled: false,
                },
            );
            self.queue.push(Waiting { distance, node });
        }
    }

    fn path_to(&self, node: usize, ending: SectionEnd) -> SurfacePath<SectionEnd> {
        let mut steps = Vec::new();
        let mut current = node;
        while let Some((previous, face)) = self.reached.get(&current).and_then(|r| r.from) {
            steps.push((face, current));
            current = previous;
        }
        let mut trace = Trace::new(self.surface, self.plane.from);
        for (face, node) in steps.into_iter().rev() {
            trace.step(face, self.place(node));
        }
        trace.end(ending)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, assert_lawful, cube, grid, rough, sphere};
    use anamorph_core::glam::dvec3;
    use anamorph_core::math;

    /// The path, having obeyed the laws of sections: its points lie in the plane, and it is the same backwards.
    fn lawful(
        surface: &Surface,
        from: SurfacePoint,
        to: SurfacePoint,
        upright: Upright,
    ) -> SurfacePath<SectionEnd> {
        let path = section(surface, from, to, upright).expect("a plane");
        assert_lawful(surface, &path);
        if from == to {
            return path;
        }
        let plane = SectionPlane::between(surface, from, to, upright).expect("a plane");
        for &p in &path.positions {
            let off = plane.normal().dot(p - plane.origin()).abs();
            assert!(off <= 1e-12, "{off} off the plane");
        }
        assert_eq!(path.points[0], surface.simplest(from).expect("a place"));
        if path.ending == SectionEnd::Reached {
            assert_eq!(path.points.last(), surface.simplest(to).as_ref().ok());
            let back = section(surface, to, from, upright).expect("a plane");
            assert_eq!(back.ending, SectionEnd::Reached);
            assert!(
                (back.length - path.length).abs() < 1e-9,
                "{} {}",
                back.length,
                path.length
            );
        }
        path
    }

    #[test]
    fn a_sphere_is_cut_in_great_circles() {
        let mut random = Random::new(5);
        for levels in [2, 4] {
            let sphere = sphere(levels);
            // The longest edge spans an angle, under whose half the faces lie below the sphere.
            let longest = (0..sphere.topology().edges())
                .map(|e| sphere.edge_length(e))
                .fold(0.0, f64::max);
            let sag = 0.5 * longest * longest;
            for _ in 0..100 {
                let (a, b) = (random.place(&sphere), random.place(&sphere));
                let chord = (sphere.position(b) - sphere.position(a)).normalize();
                let centre = Upright::Along(sphere.position(a));
                if sphere.position(a).normalize().cross(chord).length() < 0.1 {
                    continue;
                }
                let path = lawful(&sphere, a, b, centre);
                assert_eq!(path.ending, SectionEnd::Reached);
                let [p, q] = [a, b].map(|x| sphere.position(x).normalize());
                let angle = math::atan2(p.cross(q).length(), p.dot(q));
                assert!(
                    path.length <= angle + 2.0 * sag,
                    "inside the sphere: {} {angle}",
                    path.length
                );
                assert!(
                    path.length >= angle * (1.0 - sag),
                    "{} {angle}",
                    path.length
                );
                for &p in &path.positions {
                    assert!(p.length() <= 1.0 + 1e-12 && p.length() >= 1.0 - sag);
                }
                // The average of normals is no worse.
                let free = lawful(&sphere, a, b, Upright::Normals);
                assert_eq!(free.ending, SectionEnd::Reached);
            }
        }
    }

    #[test]
    fn opposite_poles_are_joined_whatever_the_plane() {
        let sphere = sphere(3);
        let (north, south) = (SurfacePoint::Vertex(4), SurfacePoint::Vertex(5));
        let path = lawful(&sphere, north, south, Upright::Normals);
        assert_eq!(path.ending, SectionEnd::Reached);
        assert!((path.length - core::f64::consts::PI).abs() < 0.03);
        assert_eq!(
            section(&sphere, north, south, Upright::Along(DVec3::Z)),
            Err(PathError::UprightAlongChord)
        );
    }

    #[test]
    fn a_flat_mesh_is_cut_straight_through_vertices_and_along_edges() {
        let flat = grid(6, 6, |_, _| 0.0);
        let vertex = |i: usize, j: usize| SurfacePoint::Vertex(7 * j + i);
        // Along edges, along diagonals against and with the grain, along the boundary, through a vertex now and then.
        for (a, b) in [
            ((1, 2), (5, 2)),
            ((1, 1), (5, 5)),
            ((1, 5), (5, 1)),
            ((0, 0), (6, 0)),
            ((0, 1), (0, 5)),
            ((0, 0), (6, 3)),
            ((0, 6), (6, 0)),
            ((1, 1), (4, 3)),
            ((6, 6), (0, 6)),
        ] {
            let (from, to) = (vertex(a.0, a.1), vertex(b.0, b.1));
            let path = lawful(&flat, from, to, Upright::Normals);
            assert_eq!(path.ending, SectionEnd::Reached, "{a:?} {b:?}");
            let straight = flat.position(from).distance(flat.position(to));
            assert!((path.length - straight).abs() < 1e-12);
        }
        let mut random = Random::new(6);
        for _ in 0..300 {
            let (from, to) = (random.place(&flat), random.place(&flat));
            let path = lawful(&flat, from, to, Upright::Normals);
            assert_eq!(path.ending, SectionEnd::Reached);
            let straight = flat.position(from).distance(flat.position(to));
            assert!((path.length - straight).abs() < 1e-12);
        }
    }

    #[test]
    fn the_shorter_way_around_a_cube() {
        let cube = cube();
        let edge = cube.topology().edge_between(0, 1).expect("an edge");
        let from = SurfacePoint::Edge {
            edge,
            fraction: 0.5,
        };
        // On the upright edge's neighbour face, a quarter up: over the front it is ¼ away, over the back 3¾.
        let other = cube.topology().edge_between(4, 5).expect("an edge");
        let to = SurfacePoint::Edge {
            edge: other,
            fraction: 0.5,
        };
        let path = lawful(&cube, from, to, Upright::Along(DVec3::Y));
        assert!((path.length - 1.0).abs() < 1e-15);
        let opposite = cube.topology().edge_between(6, 7).expect("an edge");
        let to = SurfacePoint::Edge {
            edge: opposite,
            fraction: 0.5,
        };
        let path = lawful(&cube, from, to, Upright::Along(DVec3::Z));
        assert!((path.length - 2.0).abs() < 1e-15);
        // Within one face whatever the direction, and to itself.
        let path = section(
            &cube,
            SurfacePoint::Vertex(0),
            SurfacePoint::Vertex(1),
            Upright::Along(DVec3::X),
        );
        assert_eq!(path.expect("a segment").points.len(), 2);
        let path = section(&cube, from, from, Upright::Normals).expect("a point");
        assert_eq!((path.points.len(), path.length), (1, 0.0));
    }

    #[test]
    fn where_the_plane_finds_no_way_the_end_is_said() {
        // A sheet with a slit of squares missing from its middle line to its edge.
        let mut faces = crate::testing::grid_faces(6, 4);
        faces.retain(|f| !(f.contains(&(3 + 7)) && f.contains(&(3 + 14))));
        let positions = grid(6, 4, |_, _| 0.0).positions().to_vec();
        let slit = Surface::new(positions, &faces).expect("a slit sheet");
        let [from, to] = [[8, 15], [12, 19]].map(|[a, b]| {
            let edge = slit.topology().edge_between(a, b).expect("an upright edge");
            SurfacePoint::Edge {
                edge,
                fraction: 0.5,
            }
        });
        let path = lawful(&slit, from, to, Upright::Normals);
        assert_eq!(path.ending, SectionEnd::Boundary);
        let end = path.positions[path.positions.len() - 1];
        assert!(
            slit.position(from).distance(end) > 0.9,
            "it went as far as the slit"
        );

        // Two spheres: the section of the first is closed.
        let one = sphere(2);
        let n = one.positions().len();
        let shifted = one.positions().iter().map(|&p| p + dvec3(3.0, 0.1, 0.0));
        let positions: Vec<DVec3> = one.positions().iter().copied().chain(shifted).collect();
        let mut faces: Vec<[usize; 3]> = (0..one.topology().faces())
            .map(|f| one.topology().triangle(f))
            .collect();
        let second: Vec<[usize; 3]> = faces.iter().map(|f| f.map(|v| v + n)).collect();
        faces.extend(second);
        let two = Surface::new(positions, &faces).expect("two spheres");
        let path = lawful(
            &two,
            SurfacePoint::Vertex(4),
            SurfacePoint::Vertex(n + 4),
            Upright::Normals,
        );
        assert_eq!(path.ending, SectionEnd::Apart);
        assert!(path.positions[path.positions.len() - 1].x > 0.5);
        // A vertex of no face leads nowhere.
        let mut positions = cube().positions().to_vec();
        positions.push(DVec3::splat(3.0));
        let faces: Vec<[usize; 3]> = (0..12).map(|f| cube().topology().triangle(f)).collect();
        let lonely = Surface::new(positions, &faces).expect("a cube and a point");
        let path = lawful(
            &lonely,
            SurfacePoint::Vertex(8),
            SurfacePoint::Vertex(0),
            Upright::Normals,
        );
        assert_eq!((path.ending, path.points.len()), (SectionEnd::Apart, 1));
    }

    #[test]
    fn edges_of_three_faces_are_passed_and_places_at_one_point_are_refused() {
        // Three half planes at the z axis.
        let positions = vec![
            DVec3::NEG_Z,
            DVec3::Z,
            dvec3(2.0, 0.0, 0.0),
            dvec3(-1.0, 2.0, 0.0),
            dvec3(-1.0, -2.0, 0.0),
            DVec3::X * 2.0,
        ];
        let book =
            Surface::new(positions, &[[0, 1, 2], [0, 1, 3], [0, 1, 4], [0, 1, 5]]).expect("a book");
        let path = lawful(
            &book,
            SurfacePoint::Vertex(3),
            SurfacePoint::Vertex(2),
            Upright::Along(dvec3(0.0, 1.0, 0.0)),
        );
        // The plane of both and y is z = 0, which leads over the axis.
        assert_eq!(path.ending, SectionEnd::Reached);
        assert!((path.length - (2.0 + 5.0_f64.sqrt())).abs() < 1e-12);
        assert_eq!(
            section(
                &book,
                SurfacePoint::Vertex(2),
                SurfacePoint::Vertex(5),
                Upright::Normals
            ),
            Err(PathError::SamePlace)
        );
        let to = SurfacePoint::Vertex(2);
        for up in [DVec3::ZERO, DVec3::NAN] {
            let refused = section(&book, SurfacePoint::Vertex(3), to, Upright::Along(up));
            assert!(matches!(refused, Err(PathError::Direction { .. })));
        }
        let off =
            section(&book, SurfacePoint::Vertex(9), to, Upright::Normals).expect_err("no start");
        assert!(
            off.to_string()
                .contains("the start is not on the surface: vertex 9 does not exist")
        );
    }

    #[test]
    fn rough_meshes_with_faces_without_area() {
        let mut random = Random::new(7);
        let mut reached = 0;
        for round in 0..40 {
            let mesh = rough(7, 7, &mut random);
            let mut positions = mesh.positions().to_vec();
            if round % 2 == 0 {
                // Vertices at the same place, and one in the middle of others: faces without area.
                positions[27] = positions[28];
                positions[36] = (positions[35] + positions[37]) * 0.5;
                positions[44] = positions[36];
            }
            let mesh = Surface::with_topology(mesh.topology().clone(), positions).expect("a mesh");
            for _ in 0..20 {
                let (from, to) = (random.place(&mesh), random.place(&mesh));
                if mesh.position(from).distance(mesh.position(to)) > 1e-6 {
                    let path = lawful(&mesh, from, to, Upright::Along(dvec3(0.1, 0.2, 1.0)));
                    reached += usize::from(path.ending == SectionEnd::Reached);
                    let chord = mesh.position(from).distance(mesh.position(to));
                    assert!(path.ending != SectionEnd::Reached || path.length >= chord - 1e-12);
                }
            }
        }
        assert!(
            reached > 700,
            "{reached} of 800: a height field is cut in one piece but near its outline"
        );
    }

    #[test]
    fn a_path_written_down() {
        let hill = grid(4, 4, |x, y| 0.25 * x * (4.0 - x) + 0.125 * y);
        let from = SurfacePoint::Face {
            face: 2,
            weights: [0.25, 0.25, 0.5],
        };
        let path = lawful(&hill, from, SurfacePoint::Vertex(23), Upright::Normals);
        let lines: Vec<String> = path
            .positions
            .iter()
            .map(|p| format!("{:.9} {:.9} {:.9}", p.x, p.y, p.z))
            .collect();
        insta::assert_snapshot!(format!("{}\nlength {:.9}", lines.join("\n"), path.length), @r"
        1.750000000 0.500000000 1.000000000
        1.899760280 0.899760280 1.087410105
        1.937312607 1.000000000 1.109328152
        2.000000000 1.167333620 1.145916703
        2.293951447 2.000000000 1.176512138
        2.454346950 2.454346950 1.193206631
        2.646975723 3.000000000 1.213256069
        3.000000000 4.000000000 1.250000000
        length 3.733210121
        ");
    }
}
