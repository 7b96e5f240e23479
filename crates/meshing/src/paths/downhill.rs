//! The downhill walk: the way that water takes.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Path finding – downhill": the cross product of normal and up is level,
//! its cross product with the normal is downhill. In a face that is the part of −up in its plane, along which the height of
//! the face falls fastest. On edges and at vertices the steepest of all directions of the surface is taken, which is either
//! downhill in a face or along an edge (the walk along *valleys*): S. Yu, M. van Kreveld and J. Snoeyink, *Drainage Queries
//! in TINs: from Local to Global and back again*, 7th Symposium on Spatial Data Handling, 1996.
//!
//! The walk ends: in exact arithmetic the height falls with every step. Of steps so short that the computed height does not
//! fall, none comes to the same vertex or edge twice before it does; there are finitely many numbers and edges.

use std::collections::BTreeSet;

use anamorph_core::glam::{DVec2, DVec3};

use super::unfold::{Entry, Flat, between, cross};
use super::{PathError, SurfacePath, Trace, checked, checked_length, unit};
use crate::{Surface, SurfacePoint};

/// Most segments of a walk; a longer one stops there and says so.
pub const DOWNHILL_STEPS: usize = 1_000_000;

/// Downhill directions this near (sine of the angle) to an edge run along it.
const ALONG: f64 = 1e-12;

/// Units in the last place of the coordinates by which heights must differ to be different.
const ROUNDINGS: f64 = 8.0;

/// How a downhill walk ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DownhillEnd {
    /// At a vertex inside the surface around which everything rises.
    Pit,
    /// At the boundary: downhill leads off the surface, or its lowest vertex lies there.
    Boundary,
    /// Where nothing falls and something is level: a level face, a level valley.
    Level,
    /// At a vertex that a face without area joins to another at the same place or height, from which it may go on
    /// downhill; weld vertices at the same place to get rid of such faces.
    NoArea {
        /// Number of the face.
        face: usize,
    },
    /// Its greatest length is walked.
    Length,
    /// It has [`DOWNHILL_STEPS`] segments.
    Steps,
}

/// The walk downhill from a place, where `up` (of any length) is up, until it ends or `length` is walked; `length` may be
/// infinite. Of directions equally steep, the first is taken: faces before edges, in order around a vertex.
///
/// # Errors
/// Where the start is not on the surface or touches no face with area, `up` is null or not finite, or the length is
/// negative or not a number.
pub fn downhill(
    surface: &Surface,
    start: SurfacePoint,
    up: DVec3,
    length: f64,
) -> Result<SurfacePath<DownhillEnd>, PathError> {
    let start = checked(surface, "start", start)?;
    let heights = Heights {
        surface,
        up: unit("up direction", up)?,
        origin: surface.position(start),
    };
    let remaining = checked_length("greatest length", length)?;
    let has_area =
        |face: usize| Flat::on_longest_side(surface, face).is_some_and(|flat| flat.has_area());
    if !surface.faces_at(start).into_iter().any(has_area) {
        return Err(PathError::NoTangent);
    }
    Ok(walk(&heights, start, remaining))
}

/// The walk uphill: downhill with `up` turned around. A pit is then a summit.
///
/// # Errors
/// As [`downhill`].
pub fn uphill(
    surface: &Surface,
    start: SurfacePoint,
    up: DVec3,
    length: f64,
) -> Result<SurfacePath<DownhillEnd>, PathError> {
    downhill(surface, start, -up, length)
}

/// Where to go next.
#[derive(Debug, Clone, Copy)]
enum Step {
    /// Across a face.
    Face {
        flat: Flat,
        origin: DVec2,
        direction: DVec2,
        from: Entry,
    },
    /// Along an edge to a vertex.
    Edge { edge: usize, to: usize },
}

/// The steepest way seen so far.
#[derive(Debug, Default)]
struct Steepest {
    slope: f64,
    step: Option<Step>,
}

impl Steepest {
    fn consider(&mut self, slope: f64, step: Step) {
        if slope > self.slope {
            *self = Self {
                slope,
                step: Some(step),
            };
        }
    }
}

fn walk(heights: &Heights<'_>, start: SurfacePoint, length: f64) -> SurfacePath<DownhillEnd> {
    let surface = heights.surface;
    let mut trace = Trace::new(surface, start);
    let (mut place, mut remaining) = (start, length);
    let mut lowest = heights.of_point(start);
    // Since the height last fell: the places visited, and the faces without area that were crossed.
    let (mut since_lowest, mut crossed) = (BTreeSet::new(), BTreeSet::new());
    for _ in 0..DOWNHILL_STEPS {
        let step = match place {
            SurfacePoint::Face { face, .. } => heights.in_face(place, face),
            SurfacePoint::Edge { edge, .. } => heights.on_edge(place, edge, &crossed),
            SurfacePoint::Vertex(vertex) => heights.at_vertex(vertex),
        };
        let (face, next) = match step {
            Err(ending) => return trace.end(ending),
            Ok(Step::Edge { edge, to }) => (
                surface.topology().edge_faces(edge)[0],
                SurfacePoint::Vertex(to),
            ),
            Ok(Step::Face {
                flat,
                origin,
                direction,
                from,
            }) => {
                if !flat.has_area() {
                    crossed.insert(flat.face);
                }
                let (exit, _) = flat.leave(origin, direction, from);
                (flat.face, flat.exit_point(surface, exit))
            }
        };
        let distance = surface.position(place).distance(surface.position(next));
        if remaining <= distance {
            let share = if distance > 0.0 {
                remaining / distance
            } else {
                0.0
            };
            trace.step(face, between(surface, face, place, next, share));
            return trace.end(DownhillEnd::Length);
        }
        let height = heights.of_point(next);
        if height < lowest {
            lowest = height;
            since_lowest.clear();
            crossed.clear();
        } else {
            let element = match next {
                SurfacePoint::Vertex(vertex) => (0, vertex),
                SurfacePoint::Edge { edge, .. } => (1, edge),
                SurfacePoint::Face { face, .. } => (2, face),
            };
            if !since_lowest.insert(element) {
                return trace.end(DownhillEnd::Level);
            }
        }
        trace.step(face, next);
        remaining -= distance;
        place = next;
    }
    trace.end(DownhillEnd::Steps)
}

/// Heights above the start of a walk.
struct Heights<'a> {
    surface: &'a Surface,
    up: DVec3,
    origin: DVec3,
}

impl Heights<'_> {
    fn of(&self, vertex: usize) -> f64 {
        self.up.dot(self.surface.positions()[vertex] - self.origin)
    }

    fn of_point(&self, point: SurfacePoint) -> f64 {
        self.up.dot(self.surface.position(point) - self.origin)
    }

    /// Differences of heights of vertices that may be rounding.
    fn noise(&self, vertices: &[usize]) -> f64 {
        let size = vertices.iter().fold(0.0_f64, |m, &v| {
            m.max(self.surface.positions()[v].abs().max_element())
        });
        ROUNDINGS * f64::EPSILON * size
    }

    /// Downhill in a face laid flat, as long as the slope is steep (height for length). Null where the face is level.
    fn downhill_in(&self, flat: &Flat) -> DVec2 {
        let h = flat.vertices.map(|v| self.of(v));
        let range = h[0].max(h[1]).max(h[2]) - h[0].min(h[1]).min(h[2]);
        if range <= self.noise(&flat.vertices) {
            return DVec2::ZERO;
        }
        let [_, b, c] = flat.corners;
        let x = (h[1] - h[0]) / b.x;
        let y = (h[2] - h[0] - x * c.x) / c.y;
        DVec2::new(-x, -y)
    }

    fn in_face(&self, place: SurfacePoint, face: usize) -> Result<Step, DownhillEnd> {
        let no_area = DownhillEnd::NoArea { face };
        let flat = Flat::on_longest_side(self.surface, face).ok_or(no_area)?;
        if !flat.has_area() {
            return Err(no_area);
        }
        let direction = self.downhill_in(&flat).try_normalize();
        Ok(Step::Face {
            flat,
            origin: flat.place(self.surface, place),
            direction: direction.ok_or(DownhillEnd::Level)?,
            from: Entry::Inside,
        })
    }

    /// Faces without area are crossed straight, each once while the height does not fall: what lies behind them is beside
    /// the edge.
    fn on_edge(
        &self,
        place: SurfacePoint,
        edge: usize,
        crossed: &BTreeSet<usize>,
    ) -> Result<Step, DownhillEnd> {
        let [low, high] = self.surface.topology().ends(edge);
        let faces = self.surface.topology().edge_faces(edge);
        let mut steepest = Steepest::default();
        let mut without_area = None;
        for &face in faces {
            let Some(flat) = Flat::along(self.surface, face, low, high) else {
                continue;
            };
            if !flat.has_area() {
                if !crossed.contains(&face) {
                    without_area = without_area.or(Some(flat));
                } else if faces.len() == 1 {
                    return Err(DownhillEnd::Boundary);
                }
                continue;
            }
            let down = self.downhill_in(&flat);
            let slope = down.length();
            if down.y > ALONG * slope {
                steepest.consider(
                    slope,
                    Step::Face {
                        flat,
                        origin: flat.place(self.surface, place),
                        direction: down / slope,
                        from: Entry::Base,
                    },
                );
            } else if faces.len() == 1 && down.y < -ALONG * slope {
                return Err(DownhillEnd::Boundary);
            }
        }
        if let (None, Some(flat)) = (steepest.step, without_area) {
            return Ok(Step::Face {
                flat,
                origin: flat.place(self.surface, place),
                direction: DVec2::Y,
                from: Entry::Base,
            });
        }
        let end = if self.of(low) < self.of(high) {
            low
        } else {
            high
        };
        steepest.consider(self.slope_along(edge), Step::Edge { edge, to: end });
        steepest.step.ok_or(DownhillEnd::Level)
    }

    /// How steeply an edge falls to its lower end; 0 where it is level.
    fn slope_along(&self, edge: usize) -> f64 {
        let ends = self.surface.topology().ends(edge);
        let drop = (self.of(ends[0]) - self.of(ends[1])).abs();
        if drop > self.noise(&ends) {
            drop / self.surface.edge_length(edge)
        } else {
            0.0
        }
    }

    fn at_vertex(&self, vertex: usize) -> Result<Step, DownhillEnd> {
        let topology = self.surface.topology();
        let corners = topology.corners(vertex);
        let mut steepest = Steepest::default();
        let (mut all_rises, mut sloped, mut without_area) = (true, false, None);
        let far = |edge: usize| {
            let [a, b] = topology.ends(edge);
            if a == vertex { b } else { a }
        };
        for corner in corners {
            let flat = Flat::along(self.surface, corner.face, vertex, far(corner.before));
            let Some(flat) = flat.filter(Flat::has_area) else {
                without_area = without_area.or(Some(corner.face));
                continue;
            };
            let down = self.downhill_in(&flat);
            let slope = down.length();
            sloped |= slope > 0.0;
            let after = flat.corners[2].normalize_or_zero();
            if down.y > ALONG * slope && cross(down, after) > ALONG * slope {
                steepest.consider(
                    slope,
                    Step::Face {
                        flat,
                        origin: DVec2::ZERO,
                        direction: down / slope,
                        from: Entry::Origin,
                    },
                );
            }
        }
        for edge in corners.iter().flat_map(|c| [c.before, c.after]) {
            let slope = self.slope_along(edge);
            let other = far(edge);
            if slope == 0.0 {
                all_rises = false;
            } else if self.of(other) < self.of(vertex) {
                steepest.consider(slope, Step::Edge { edge, to: other });
            }
        }
        match steepest.step {
            Some(Step::Edge { edge, to }) if self.falls_outward(edge, vertex, to) => {
                Err(DownhillEnd::Boundary)
            }
            Some(step) => Ok(step),
            None => Err(match without_area {
                Some(face) if !all_rises => DownhillEnd::NoArea { face },
                _ if sloped && topology.is_boundary_vertex(vertex) => DownhillEnd::Boundary,
                _ if all_rises => DownhillEnd::Pit,
                _ => DownhillEnd::Level,
            }),
        }
    }

    /// Whether the one face at a boundary edge falls over it.
    fn falls_outward(&self, edge: usize, from: usize, to: usize) -> bool {
        let [face] = *self.surface.topology().edge_faces(edge) else {
            return false;
        };
        let flat = Flat::along(self.surface, face, from, to).filter(Flat::has_area);
        flat.is_some_and(|flat| {
            let down = self.downhill_in(&flat);
            down.y < -ALONG * down.length()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, assert_lawful, cone, cube, grid, rough, sphere};
    use anamorph_core::glam::dvec3;
    use anamorph_core::math;
    use core::f64::consts::PI;

    const FAR: f64 = f64::INFINITY;

    /// The path, having obeyed the laws of walks downhill: the height falls with every step.
    fn lawful(surface: &Surface, start: SurfacePoint, up: DVec3) -> SurfacePath<DownhillEnd> {
        let path = downhill(surface, start, up, FAR).expect("a walk");
        assert_lawful(surface, &path);
        let up = up.normalize();
        for pair in path.positions.windows(2) {
            let fall = up.dot(pair[0] - pair[1]);
            let short = pair[0].distance(pair[1]) < 1e-11;
            assert!(
                fall > 0.0 || (short && fall > -1e-15),
                "{fall} from {} to {}",
                pair[0],
                pair[1]
            );
        }
        path
    }

    /// Downhill as the slides find it: normal and up, crossed, crossed with the normal.
    fn of_the_slides(surface: &Surface, face: usize, up: DVec3) -> DVec3 {
        let [a, b, c] = surface.corners(face);
        let normal = (b - a).cross(c - a).normalize();
        let down = normal.cross(up).cross(normal);
        if down.dot(up) > 0.0 { -down } else { down }
    }

    /// Every step goes downhill in its face, or along a valley: an edge of which no face leads away.
    fn assert_steepest(surface: &Surface, path: &SurfacePath<DownhillEnd>, up: DVec3) {
        for k in 0..path.faces.len() {
            let way = path.positions[k + 1] - path.positions[k];
            if way.length() < 1e-6 {
                continue;
            }
            let way = way.normalize();
            let down = of_the_slides(surface, path.faces[k], up).normalize();
            if way.cross(down).length() < 1e-8 {
                continue;
            }
            let edge = (0..surface.topology().edges()).find(|&edge| {
                let [a, b] = surface.topology().ends(edge).map(SurfacePoint::Vertex);
                let on = |p: SurfacePoint| {
                    p == a || p == b || matches!(p, SurfacePoint::Edge { edge: e, .. } if e == edge)
                };
                on(path.points[k]) && on(path.points[k + 1])
            });
            let edge = edge.expect("an edge, or downhill");
            for &face in surface.topology().edge_faces(edge) {
                let t = surface.topology().triangle(face);
                let ends = surface.topology().ends(edge);
                let third = t
                    .into_iter()
                    .find(|v| !ends.contains(v))
                    .expect("a third corner");
                let apex = surface.positions()[third] - path.positions[k];
                let inward = apex - way * apex.dot(way);
                let down = of_the_slides(surface, face, up);
                assert!(
                    down.dot(inward) <= 1e-9,
                    "the face leads away from the valley"
                );
            }
        }
    }

    #[test]
    fn every_step_is_steepest() {
        let mut random = Random::new(19);
        for round in 0..40 {
            let mesh = if round % 4 == 0 {
                sphere(2)
            } else {
                rough(9, 9, &mut random)
            };
            for _ in 0..20 {
                let up = (random.vector() + DVec3::Z).normalize();
                let path = lawful(&mesh, random.place(&mesh), up);
                assert_steepest(&mesh, &path, up);
            }
            // At a vertex no direction around it is steeper than the one taken.
            for vertex in 0..mesh.topology().vertices() {
                let path = lawful(&mesh, SurfacePoint::Vertex(vertex), DVec3::Z);
                let [first, second, ..] = path.positions[..] else {
                    continue;
                };
                let slope = (first - second).normalize().z;
                for corner in mesh.topology().corners(vertex) {
                    let [a, b, c] = mesh.corners(corner.face);
                    for k in 0..=50 {
                        let t = f64::from(k) / 50.0;
                        let toward = match mesh
                            .topology()
                            .triangle(corner.face)
                            .iter()
                            .position(|&v| v == vertex)
                        {
                            Some(0) => b + (c - b) * t,
                            Some(1) => c + (a - c) * t,
                            _ => a + (b - a) * t,
                        };
                        assert!((first - toward).normalize().z <= slope + 1e-12);
                    }
                }
            }
        }
    }

    fn last(path: &SurfacePath<DownhillEnd>) -> DVec3 {
        path.positions[path.positions.len() - 1]
    }

    #[test]
    fn on_a_cone_it_is_a_generator() {
        for n in [3, 7, 64] {
            let cone = cone(n, 2.0);
            let apothem = math::cos(PI / n as f64);
            let slant = (4.0 + apothem * apothem).sqrt();
            // From the apex along the middle of a face, and from the middle line of every face.
            let path = lawful(&cone, SurfacePoint::Vertex(n), DVec3::Z);
            assert_eq!(path.ending, DownhillEnd::Boundary);
            assert!((path.length - slant).abs() < 1e-12);
            for face in 0..n {
                let start = SurfacePoint::Face {
                    face,
                    weights: [0.2, 0.2, 0.6],
                };
                let path = lawful(&cone, start, DVec3::Z * 7.0);
                assert_eq!(path.ending, DownhillEnd::Boundary);
                assert!((path.length - 0.6 * slant).abs() < 1e-12);
                let p = cone.position(start);
                let generator = dvec3(p.x, p.y, 0.0) / 0.4;
                assert!(last(&path).distance(generator) < 1e-12);
            }
            // From any place of a face, parallel to the generator of its middle, within the tessellation.
            let mut random = Random::new(n as u64);
            for _ in 0..100 {
                let start = random.in_face(&cone);
                let SurfacePoint::Face { face, .. } = start else {
                    continue;
                };
                let path = lawful(&cone, start, DVec3::Z);
                let [a, b, c] = cone.corners(face);
                let down = ((a + b) * 0.5 - c).normalize();
                let way = last(&path) - cone.position(start);
                assert!(
                    way.cross(down).length() < 1e-13,
                    "parallel to the middle line"
                );
                assert_eq!(path.points.len(), 2);
                let axis = (cone.position(start) * dvec3(1.0, 1.0, 0.0)).normalize();
                let bend = way.normalize().dot(axis.cross(DVec3::Z)).abs();
                assert!(bend <= math::sin(PI / n as f64) + 1e-12);
            }
            // In the cone turned over every way ends in the apex; uphill likewise on the cone.
            for _ in 0..30 {
                let start = random.place(&cone);
                let down = lawful(&cone, start, DVec3::NEG_Z);
                let up = uphill(&cone, start, DVec3::Z, FAR).expect("a walk");
                assert_eq!(up, down);
                assert_eq!(up.ending, DownhillEnd::Pit);
                assert_eq!(up.points.last(), Some(&SurfacePoint::Vertex(n)));
            }
        }
    }

    #[test]
    fn on_a_plane_it_is_straight() {
        let mut random = Random::new(10);
        for _ in 0..40 {
            let (u, v) = (random.between(-1.0, 1.0), random.between(-1.0, 1.0));
            let plane = grid(9, 9, |x, y| u * x + v * y);
            let down = dvec3(-u, -v, -(u * u + v * v)).normalize();
            for _ in 0..20 {
                let start = random.in_face(&plane);
                let path = lawful(&plane, start, DVec3::Z);
                assert_eq!(path.ending, DownhillEnd::Boundary);
                for &p in &path.positions {
                    let way = p - plane.position(start);
                    assert!(
                        way.cross(down).length() < 1e-10,
                        "{}",
                        way.cross(down).length()
                    );
                }
                let end = last(&path);
                let edge = end.x.min(end.y).min(9.0 - end.x).min(9.0 - end.y);
                assert!(edge.abs() < 1e-9, "off the edge, not before");
            }
        }
        // Along the grid lines and through the vertices.
        let slope = grid(6, 6, |x, _| x);
        let path = lawful(&slope, SurfacePoint::Vertex(7 * 3 + 6), DVec3::Z);
        assert_eq!(path.points.last(), Some(&SurfacePoint::Vertex(7 * 3)));
        assert!((path.length - 6.0 * 2.0_f64.sqrt()).abs() < 1e-12);
        // Along the boundary, which is no way off.
        let path = lawful(&slope, SurfacePoint::Vertex(6), DVec3::Z);
        assert_eq!(path.points.last(), Some(&SurfacePoint::Vertex(0)));
        assert_eq!(path.ending, DownhillEnd::Boundary);
    }

    #[test]
    fn along_a_valley_to_its_pit() {
        // A gutter that falls towards x = 4 from both sides, its walls steep.
        let gutter = grid(8, 6, |x, y| 3.0 * (y - 3.0).abs() + 0.5 * (x - 4.0).abs());
        let mut random = Random::new(11);
        let pit = SurfacePoint::Vertex(9 * 3 + 4);
        for _ in 0..200 {
            let start = random.place(&gutter);
            let path = lawful(&gutter, start, DVec3::Z);
            assert_eq!(path.ending, DownhillEnd::Pit);
            assert_eq!(path.points.last(), Some(&pit));
        }
        let path = lawful(&gutter, SurfacePoint::Vertex(9 * 3), DVec3::Z);
        assert_eq!(path.points.len(), 5, "four edges of the valley");
        // Only so far.
        let path = downhill(&gutter, SurfacePoint::Vertex(9 * 3), DVec3::Z, 1.5).expect("a walk");
        assert_lawful(&gutter, &path);
        assert_eq!(path.ending, DownhillEnd::Length);
        assert!((path.length - 1.5).abs() < 1e-12);
        let path = downhill(&gutter, SurfacePoint::Vertex(0), DVec3::Z, 0.0).expect("a walk");
        assert_eq!((path.ending, path.points.len()), (DownhillEnd::Length, 1));
    }

    #[test]
    fn where_nothing_falls_it_says_level() {
        let flat = grid(3, 3, |_, _| 2.0);
        let mut random = Random::new(12);
        for _ in 0..50 {
            let path = lawful(&flat, random.place(&flat), DVec3::Z);
            assert_eq!((path.ending, path.points.len()), (DownhillEnd::Level, 1));
        }
        // A level valley, a level floor, a cube's top.
        let trough = grid(4, 4, |_, y| (y - 2.0).abs());
        let path = lawful(&trough, SurfacePoint::Vertex(2), DVec3::Z);
        assert_eq!(path.ending, DownhillEnd::Level);
        assert_eq!(last(&path).z, 0.0);
        let basin = grid(6, 6, |x, y| {
            ((x - 3.0).abs().max((y - 3.0).abs()) - 1.0).max(0.0)
        });
        let path = lawful(&basin, SurfacePoint::Vertex(7 * 2 + 6), DVec3::Z);
        assert_eq!(path.ending, DownhillEnd::Level);
        assert_eq!(last(&path).z, 0.0);
        let top = SurfacePoint::Face {
            face: 2,
            weights: [0.5, 0.25, 0.25],
        };
        assert_eq!(lawful(&cube(), top, DVec3::Z).ending, DownhillEnd::Level);
        // Far from the origin, where heights are rounded coarsely.
        let far = flat
            .positions()
            .iter()
            .map(|&p| p + DVec3::splat(1e6 + 0.1))
            .collect();
        let far = Surface::with_topology(flat.topology().clone(), far).expect("a grid");
        let tilted = downhill(&far, SurfacePoint::Vertex(5), DVec3::Z, FAR).expect("a walk");
        assert_eq!(tilted.ending, DownhillEnd::Level);
    }

    #[test]
    fn closed_and_rough_surfaces_end_in_pits_or_at_the_boundary() {
        let mut random = Random::new(13);
        let ball = sphere(4);
        for _ in 0..100 {
            let up = random.vector();
            let path = lawful(&ball, random.place(&ball), up);
            assert_eq!(path.ending, DownhillEnd::Pit);
            let lowest = ball
                .positions()
                .iter()
                .map(|p| p.dot(up))
                .fold(FAR, f64::min);
            assert!(
                (last(&path).dot(up) - lowest).abs() < 1e-15,
                "convex: one pit"
            );
        }
        let mut ends = [0; 2];
        for _ in 0..60 {
            let mesh = rough(12, 12, &mut random);
            for _ in 0..30 {
                let path = lawful(&mesh, random.place(&mesh), DVec3::Z);
                match path.ending {
                    DownhillEnd::Pit => {
                        let Some(&SurfacePoint::Vertex(v)) = path.points.last() else {
                            panic!("no vertex")
                        };
                        let corners = mesh.topology().corners(v);
                        for edge in corners.iter().flat_map(|c| [c.before, c.after]) {
                            let ends = mesh.topology().ends(edge).map(|v| mesh.positions()[v].z);
                            assert!(ends[0].min(ends[1]) >= mesh.positions()[v].z);
                        }
                        ends[0] += 1;
                    }
                    DownhillEnd::Boundary => ends[1] += 1,
                    other => panic!("{other:?}"),
                }
            }
        }
        assert!(ends[0] > 100 && ends[1] > 100, "{ends:?}");
    }

    #[test]
    fn faces_without_area_and_questions_without_meaning() {
        // Two triangles joined by a face without area, whose third corner is on its long side, beside the way.
        let seam = |bottom: f64| {
            let positions = vec![
                dvec3(0.0, 0.0, 2.0),
                dvec3(-1.0, 0.0, 1.0),
                dvec3(1.0, 0.0, 1.0),
                dvec3(0.0, 0.0, 1.0),
                dvec3(0.0, 0.5, bottom),
            ];
            let faces = [[0, 1, 2], [1, 3, 2], [1, 4, 3], [3, 4, 2]];
            Surface::new(positions, &faces).expect("a seam")
        };
        let start = SurfacePoint::Face {
            face: 0,
            weights: [0.4, 0.4, 0.2],
        };
        let path = downhill(&seam(0.0), start, DVec3::Z, FAR).expect("a walk");
        assert_lawful(&seam(0.0), &path);
        assert_eq!(path.faces, [0, 1, 2]);
        assert_eq!(path.ending, DownhillEnd::Boundary);
        // Where it rises behind the seam, the seam is a level valley.
        let path = downhill(&seam(1.5), start, DVec3::Z, FAR).expect("a walk");
        assert_lawful(&seam(1.5), &path);
        assert_eq!(path.ending, DownhillEnd::Level);
        // With nothing behind it, the seam is the boundary.
        let bare = Surface::new(seam(0.0).positions().to_vec(), &[[0, 1, 2], [1, 3, 2]])
            .expect("a face and a seam");
        let path = downhill(&bare, start, DVec3::Z, FAR).expect("a walk");
        assert_eq!(
            (path.ending, path.faces),
            (DownhillEnd::Boundary, vec![0, 1])
        );
        // Into a vertex whose double may lead on.
        let mut positions = seam(0.0).positions().to_vec();
        positions.extend([dvec3(0.0, 0.0, 1.0), dvec3(0.0, -1.0, 2.0)]);
        let double =
            Surface::new(positions, &[[6, 1, 3], [3, 1, 5], [1, 4, 5]]).expect("a double vertex");
        let path = downhill(&double, SurfacePoint::Vertex(3), DVec3::Z, FAR).expect("a walk");
        assert_eq!(path.ending, DownhillEnd::NoArea { face: 1 });
        let seam = seam(0.0);
        let in_seam = SurfacePoint::Face {
            face: 1,
            weights: [0.4, 0.4, 0.2],
        };
        assert_eq!(
            downhill(&seam, in_seam, DVec3::Z, FAR),
            Err(PathError::NoTangent)
        );
        for up in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
            let refused = downhill(&seam, start, up, FAR);
            assert_eq!(
                refused,
                Err(PathError::Direction {
                    what: "up direction"
                })
            );
        }
        for length in [-1.0, f64::NAN] {
            let refused = downhill(&seam, start, DVec3::Z, length);
            assert!(matches!(refused, Err(PathError::Length { .. })));
        }
        // A ridge of three faces: the steepest of them.
        let positions = vec![
            DVec3::ZERO,
            DVec3::X,
            dvec3(0.5, 1.0, -1.0),
            dvec3(0.5, -1.0, -2.0),
            dvec3(0.5, 0.0, 1.0),
        ];
        let fins = Surface::new(positions, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]]).expect("fins");
        let edge = fins.topology().edge_between(0, 1).expect("the ridge");
        let path = lawful(
            &fins,
            SurfacePoint::Edge {
                edge,
                fraction: 0.25,
            },
            DVec3::Z,
        );
        assert_eq!(path.faces, [1]);
    }
}
