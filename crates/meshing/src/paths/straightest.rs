//! The straightest walk: from a place in a direction for a length, turning neither left nor right.
//!
//! *Source*: K. Polthier and M. Schmies, *Straightest Geodesics on Polyhedral Surfaces*, in: Mathematical Visualization,
//! Springer, 1998, §3: a curve is straightest where it has equal angles on its left and on its right. Within faces and
//! over edges that is a line in the unfolded faces; through a vertex it halves the total angle. It is the exponential map of
//! the polyhedron, unique for every direction, and need not be shortest.
//!
//! At the boundary the definition ends, and so does the walk, except where it touches the boundary in a vertex: it goes on
//! straight (an angle of π) on a side on which the surface has so much.

use anamorph_core::glam::DVec3;

use super::heading::{Heading, at_vertex, in_face, on_edge, over_side, through_corner};
use super::unfold::{Exit, between};
use super::{PathError, SurfacePath, Trace, checked, checked_length, unit};
use crate::{Surface, SurfacePoint};

/// Most segments of a walk: what a mesh of a hundred million faces has in a row, a hundred times. A longer walk stops
/// there and says so.
pub const STRAIGHTEST_STEPS: usize = 1_000_000;

/// Why a straightest walk ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StraightestStop {
    /// Its length is walked.
    Length,
    /// It came to the boundary of the surface.
    Boundary,
    /// It came to an edge of three faces or more, behind which no face is straight ahead.
    NonManifold,
    /// It came to a vertex whose faces have no angle there.
    NoTangent,
    /// It has [`STRAIGHTEST_STEPS`] segments.
    Steps,
}

/// How a straightest walk ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StraightestEnd {
    /// Why.
    pub stop: StraightestStop,
    /// The length that was not walked; 0 where all was.
    pub remaining: f64,
    /// The unit direction of the last segment. Walking back from the end in the opposite one leads to the start.
    pub direction: DVec3,
}

/// The straightest walk from a place in a direction of space, for a length.
///
/// In a face, the direction's part in its plane counts. On an edge, its parts along the edge and across it, in the plane
/// that halves the angle of the two faces. At a vertex, that direction of the surface which is nearest to it; of several,
/// that in the first face around the vertex. (Where the surface falls away from it on all sides, as at the point of a spike,
/// that nearest to its part perpendicular to the vertex's normal.)
///
/// # Errors
/// Where the start is not on the surface or has no tangent there, the direction is null, not finite or perpendicular to the
/// surface, or the length is negative or not a number.
pub fn straightest(
    surface: &Surface,
    start: SurfacePoint,
    direction: DVec3,
    length: f64,
) -> Result<SurfacePath<StraightestEnd>, PathError> {
    let start = checked(surface, "start", start)?;
    let direction = unit("direction", direction)?;
    let remaining = checked_length("length", length)?;
    let heading = match start {
        SurfacePoint::Face { face, .. } => in_face(surface, start, face, direction)?,
        SurfacePoint::Edge { edge, .. } => on_edge(surface, start, edge, direction)?,
        SurfacePoint::Vertex(vertex) => at_vertex(surface, vertex, direction)?,
    };
    let walk = Walk {
        surface,
        trace: Trace::new(surface, start),
        place: start,
        remaining,
        direction,
    };
    Ok(match heading {
        Some(heading) => walk.go(heading),
        None => walk.stop(StraightestStop::Boundary),
    })
}

struct Walk<'a> {
    surface: &'a Surface,
    trace: Trace<'a>,
    place: SurfacePoint,
    remaining: f64,
    direction: DVec3,
}

impl Walk<'_> {
    fn stop(self, stop: StraightestStop) -> SurfacePath<StraightestEnd> {
        self.trace.end(StraightestEnd {
            stop,
            remaining: self.remaining,
            direction: self.direction,
        })
    }

    fn go(mut self, mut heading: Heading) -> SurfacePath<StraightestEnd> {
        for _ in 0..STRAIGHTEST_STEPS {
            let flat = heading.flat;
            let (exit, distance) = flat.leave(heading.origin, heading.direction, heading.from);
            if let Some(direction) = flat.in_space(self.surface, heading.direction) {
                self.direction = direction;
            }
            let exit_point = flat.exit_point(self.surface, exit);
            if self.remaining < distance {
                let share = self.remaining / distance;
                let end = between(self.surface, flat.face, self.place, exit_point, share);
                self.trace.step(flat.face, end);
                self.remaining = 0.0;
                return self.stop(StraightestStop::Length);
            }
            self.trace.step(flat.face, exit_point);
            self.place = exit_point;
            self.remaining -= distance;
            if self.remaining <= 0.0 {
                return self.stop(StraightestStop::Length);
            }
            let next = match exit {
                Exit::Side(side, fraction) => {
                    over_side(self.surface, &flat, side, fraction, heading.direction)
                }
                Exit::Corner(corner) => {
                    through_corner(self.surface, &flat, corner, heading.direction)
                }
            };
            match next {
                Ok(next) => heading = next,
                Err(stop) => return self.stop(stop),
            }
        }
        self.stop(StraightestStop::Steps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, assert_lawful, cone, cube, grid, grid_faces, rough, sphere};
    use anamorph_core::glam::dvec3;
    use anamorph_core::math;
    use core::f64::consts::{PI, TAU};

    fn lawful(
        surface: &Surface,
        start: SurfacePoint,
        direction: DVec3,
        length: f64,
    ) -> SurfacePath<StraightestEnd> {
        let path = straightest(surface, start, direction, length).expect("a walk");
        assert_lawful(surface, &path);
        assert!((path.length + path.ending.remaining - length).abs() < 1e-11 * (1.0 + length));
        assert_eq!(
            path.ending.stop == StraightestStop::Length,
            path.ending.remaining == 0.0
        );
        path
    }

    /// The angle of two vectors.
    fn angle(a: DVec3, b: DVec3) -> f64 {
        math::atan2(a.cross(b).length(), a.dot(b))
    }

    /// The definition: equal angles on both sides, measured in space around every vertex and edge of the path. The number
    /// of places measured.
    fn assert_equal_angles(surface: &Surface, path: &SurfacePath<StraightestEnd>) -> usize {
        let mut measured = 0;
        for k in 1..path.points.len() - 1 {
            let (at, faces) = (path.positions[k], [path.faces[k - 1], path.faces[k]]);
            let (back, on) = (path.positions[k - 1] - at, path.positions[k + 1] - at);
            if back.length().min(on.length()) < 1e-3 || faces[0] == faces[1] {
                continue;
            }
            match path.points[k] {
                SurfacePoint::Edge { edge, .. } => {
                    let [a, b] = surface
                        .topology()
                        .ends(edge)
                        .map(|v| surface.positions()[v]);
                    let (left, right) = (
                        angle(back, a - at) + angle(a - at, on),
                        angle(back, b - at) + angle(b - at, on),
                    );
                    assert!(
                        (left - PI).abs() < 1e-9 && (right - PI).abs() < 1e-9,
                        "{left} {right}"
                    );
                }
                SurfacePoint::Vertex(vertex) => {
                    let fan = surface.topology().corners(vertex);
                    let far = |edge: usize| {
                        let [a, b] = surface.topology().ends(edge);
                        surface.positions()[if a == vertex { b } else { a }] - at
                    };
                    let before = |face: usize, way: DVec3| {
                        let own = fan.iter().position(|c| c.face == face).expect("a corner");
                        let whole = fan[..own]
                            .iter()
                            .map(|c| angle(far(c.before), far(c.after)));
                        whole.sum::<f64>() + angle(far(fan[own].before), way)
                    };
                    let total: f64 = fan.iter().map(|c| angle(far(c.before), far(c.after))).sum();
                    let between = (before(faces[0], back) - before(faces[1], on)).abs();
                    // At the boundary only one side has an angle, and it is straight.
                    let boundary = surface.topology().is_boundary_vertex(vertex);
                    let expected = if boundary { PI } else { 0.5 * total };
                    assert!((between - expected).abs() < 1e-9, "{between} of {total}");
                }
                SurfacePoint::Face { .. } => panic!("a bend within a face"),
            }
            measured += 1;
        }
        measured
    }

    #[test]
    fn angles_on_both_sides_are_equal() {
        let mut random = Random::new(18);
        let (mut edges, mut vertices) = (0, 0);
        for round in 0..40 {
            let mesh = if round % 4 == 0 {
                sphere(2)
            } else {
                rough(9, 9, &mut random)
            };
            for _ in 0..20 {
                let path = lawful(&mesh, random.place(&mesh), random.vector(), 6.0);
                edges += assert_equal_angles(&mesh, &path);
                // Aimed at an inner vertex along an edge.
                let edge = random.below(mesh.topology().edges());
                let [a, b] = mesh.topology().ends(edge);
                if !mesh.topology().is_boundary_vertex(b) {
                    let way = mesh.positions()[b] - mesh.positions()[a];
                    let start = SurfacePoint::Edge {
                        edge,
                        fraction: 0.25,
                    };
                    let path = lawful(&mesh, start, way, way.length() + 0.5);
                    assert_eq!(path.points[1], SurfacePoint::Vertex(b));
                    vertices += assert_equal_angles(&mesh, &path);
                }
            }
        }
        assert!(edges > 2000 && vertices > 200, "{edges} {vertices}");
    }

    fn last(path: &SurfacePath<StraightestEnd>) -> DVec3 {
        path.positions[path.positions.len() - 1]
    }

    #[test]
    fn on_a_plane_it_is_a_straight_line() {
        let mut random = Random::new(14);
        // A flat mesh that is irregular and leans in space.
        let axes = [dvec3(0.6, 0.8, 0.0), dvec3(-0.48, 0.36, 0.8)];
        let flat = grid(12, 12, |_, _| 0.0);
        let positions = flat.positions().iter().map(|p| {
            let inside = p.x > 0.0 && p.x < 12.0 && p.y > 0.0 && p.y < 12.0;
            let q = if inside {
                *p + random.vector() * 0.3
            } else {
                *p
            };
            axes[0] * q.x + axes[1] * q.y + DVec3::ONE
        });
        let plane = Surface::new(positions.collect(), &grid_faces(12, 12)).expect("a plane");
        for _ in 0..400 {
            let start = random.place(&plane);
            let angle = random.between(0.0, TAU);
            let direction = axes[0] * math::cos(angle) + axes[1] * math::sin(angle);
            let path = lawful(&plane, start, direction * 3.0, 5.0);
            let at = plane.position(start);
            for &p in &path.positions {
                assert!((p - at).cross(direction).length() < 1e-11);
            }
            assert!(path.ending.direction.distance(direction) < 1e-11);
            if path.ending.stop == StraightestStop::Length {
                assert!(last(&path).distance(at + direction * 5.0) < 1e-11);
            } else {
                assert_eq!(path.ending.stop, StraightestStop::Boundary);
            }
        }
    }

    #[test]
    fn through_vertices_and_along_edges_of_a_plane() {
        let flat = grid(8, 8, |_, _| 0.0);
        for (direction, length) in [
            (dvec3(1.0, 0.0, 0.0), 5.0),
            (dvec3(1.0, 1.0, 0.0), 5.0 * 2.0_f64.sqrt()),
            (dvec3(0.0, 1.0, 0.0), 4.5),
            (dvec3(2.0, 1.0, 0.0), 2.0 * 5.0_f64.sqrt()),
            (dvec3(-1.0, 1.0, 0.0), 2.0_f64.sqrt()),
        ] {
            let start = SurfacePoint::Vertex(9 * 2 + 2);
            let path = lawful(&flat, start, direction, length);
            let end = flat.position(start) + direction.normalize() * length;
            assert_eq!(path.ending.stop, StraightestStop::Length);
            assert!(
                last(&path).distance(end) < 1e-13,
                "{direction}: {}",
                last(&path)
            );
        }
        // Along the boundary, through its vertices, to its corner.
        let path = lawful(&flat, SurfacePoint::Vertex(2), DVec3::X, 100.0);
        assert_eq!(path.ending.stop, StraightestStop::Boundary);
        assert_eq!(path.points.last(), Some(&SurfacePoint::Vertex(8)));
        assert!((path.ending.remaining - 94.0).abs() < 1e-12);
        // Off it at once, from a vertex, a corner, an edge.
        let edge = flat.topology().edge_between(0, 1).expect("an edge");
        for start in [
            SurfacePoint::Vertex(3),
            SurfacePoint::Vertex(0),
            SurfacePoint::Edge {
                edge,
                fraction: 0.3,
            },
        ] {
            let path = lawful(&flat, start, dvec3(0.1, -1.0, 0.0), 2.0);
            assert_eq!(
                (path.ending.stop, path.points.len()),
                (StraightestStop::Boundary, 1)
            );
        }
        let path = lawful(&flat, SurfacePoint::Vertex(0), dvec3(-1.0, -1.0, 0.0), 2.0);
        assert_eq!(path.ending.stop, StraightestStop::Boundary);
        // Straight past a corner that reaches into the way: an L-shaped sheet.
        let mut faces = grid_faces(2, 2);
        faces.truncate(6);
        let sheet =
            Surface::new(grid(2, 2, |_, _| 0.0).positions().to_vec(), &faces).expect("a sheet");
        for (start, direction) in [(2, dvec3(-1.0, 1.0, 0.0)), (1, DVec3::Y), (5, DVec3::NEG_X)] {
            let path = lawful(
                &sheet,
                SurfacePoint::Vertex(start),
                direction,
                0.1 + direction.length(),
            );
            assert_eq!(path.ending.stop, StraightestStop::Length, "from {start}");
            let end = flat_end(&sheet, start, direction, 0.1 + direction.length());
            assert!(last(&path).distance(end) < 1e-14, "{}", last(&path));
        }
    }

    fn flat_end(surface: &Surface, vertex: usize, direction: DVec3, length: f64) -> DVec3 {
        surface.positions()[vertex] + direction.normalize() * length
    }

    #[test]
    fn on_a_cylinder_it_is_straight_in_the_unrolling() {
        // A prism of n sides, unrolled: x around, z up.
        let (n, rows) = (24, 10);
        let width = 2.0 * math::sin(TAU / 2.0 / n as f64);
        let positions: Vec<DVec3> = (0..=rows)
            .flat_map(|j| {
                (0..n).map(move |i| {
                    let (sin, cos) = math::sin_cos(TAU * i as f64 / n as f64);
                    dvec3(cos, sin, 0.5 * j as f64)
                })
            })
            .collect();
        let faces: Vec<[usize; 3]> = (0..rows)
            .flat_map(|j| {
                (0..n).flat_map(move |i| {
                    let (a, b) = (j * n + i, j * n + (i + 1) % n);
                    [[a, b, b + n], [a, b + n, a + n]]
                })
            })
            .collect();
        let prism = Surface::new(positions, &faces).expect("a prism");
        let mut random = Random::new(15);
        for _ in 0..200 {
            // In the lower triangle of a square, at (u, v) of its sides.
            let square = random.below(n * 3);
            let (u, v) = (random.between(0.5, 0.9), random.between(0.1, 0.5));
            let start = SurfacePoint::Face {
                face: 2 * square,
                weights: [1.0 - u, u - v, v],
            };
            let [a, b, _] = prism.corners(2 * square);
            let around = (b - a).normalize();
            let angle = random.between(0.05, 1.5);
            let (sin, cos) = math::sin_cos(angle);
            let length = random.between(0.0, 3.0);
            let path = lawful(&prism, start, around * cos + DVec3::Z * sin, length);
            assert_eq!(path.ending.stop, StraightestStop::Length);
            let x = ((square % n) as f64 + u) * width + cos * length;
            let z = ((square / n) as f64 + v) * 0.5 + sin * length;
            // Rolled up again.
            let side = (x / width).floor();
            let [p, q] = [side, side + 1.0].map(|k| {
                let (sin, cos) = math::sin_cos(TAU * k / n as f64);
                dvec3(cos, sin, z)
            });
            let expected = p + (q - p) * (x / width - side);
            assert!(
                last(&path).distance(expected) < 1e-12,
                "{}",
                last(&path).distance(expected)
            );
        }
    }

    #[test]
    fn over_the_edges_of_a_cube_as_the_unfolding_says() {
        let cube = cube();
        // On the top from (½, ¼) to the right and a little forward: over x = 1 down, round the bottom, up again: a closed
        // band of four squares in the direction (4, 1), that rises by a whole quarter of a band.
        let start = SurfacePoint::Face {
            face: 2,
            weights: [0.5, 0.25, 0.25],
        };
        assert!(cube.position(start).distance(dvec3(0.5, 0.25, 1.0)) < 1e-15);
        let path = lawful(&cube, start, dvec3(8.0, 1.0, 0.0), 65.0_f64.sqrt() / 2.0);
        assert!(last(&path).distance(dvec3(0.5, 0.75, 1.0)) < 1e-13);
        let expected = [
            dvec3(1.0, 0.25 + 1.0 / 16.0, 1.0),
            dvec3(1.0, 0.25 + 3.0 / 16.0, 0.0),
            dvec3(0.0, 0.25 + 5.0 / 16.0, 0.0),
            dvec3(0.0, 0.25 + 7.0 / 16.0, 1.0),
        ];
        for place in expected {
            assert!(
                path.positions.iter().any(|p| p.distance(place) < 1e-13),
                "{place}"
            );
        }
        // From the middle of an edge, symmetric: half way down the two faces there is the same.
        let edge = cube
            .topology()
            .edge_between(5, 7)
            .expect("the edge x = z = 1");
        let start = SurfacePoint::Edge {
            edge,
            fraction: 0.5,
        };
        let path = lawful(&cube, start, dvec3(1.0, 0.0, -1.0), 0.75);
        assert!(last(&path).distance(dvec3(1.0, 0.5, 0.25)) < 1e-14);
        let path = lawful(&cube, start, dvec3(-1.0, 0.0, 1.0), 0.75);
        assert!(last(&path).distance(dvec3(0.25, 0.5, 1.0)) < 1e-14);
        // Forty-five degrees to the edge stays so, in the plane that halves the faces' angle.
        let leaning = dvec3(1.0, 2.0_f64.sqrt(), -1.0);
        let path = lawful(&cube, start, leaning, 0.25);
        let end = dvec3(
            1.0,
            0.5 + 0.125 * 2.0_f64.sqrt(),
            1.0 - 0.125 * 2.0_f64.sqrt(),
        );
        assert!(last(&path).distance(end) < 1e-14);
        // Through the corner (1, 1, 1): the total angle is 270°, so the diagonal of the top goes on at 135° on both
        // sides, down the opposite edge.
        let start = SurfacePoint::Vertex(4);
        let path = lawful(&cube, start, dvec3(1.0, 1.0, 0.0), 2.0_f64.sqrt() + 0.5);
        assert!(
            last(&path).distance(dvec3(1.0, 1.0, 0.5)) < 1e-14,
            "{}",
            last(&path)
        );
    }

    #[test]
    fn the_way_back_leads_to_the_start() {
        let mut random = Random::new(16);
        for round in 0..30 {
            let mesh = if round % 3 == 0 {
                sphere(3)
            } else {
                rough(8, 8, &mut random)
            };
            for _ in 0..20 {
                let start = random.in_face(&mesh);
                let direction = random.vector();
                let path = lawful(&mesh, start, direction, 2.0);
                if path.ending.stop != StraightestStop::Length {
                    continue;
                }
                let Some(&end @ SurfacePoint::Face { .. }) = path.points.last() else {
                    continue;
                };
                let back = lawful(&mesh, end, -path.ending.direction, 2.0);
                let missed = last(&back).distance(mesh.position(start));
                assert!(missed < 1e-9, "{missed}");
            }
        }
    }

    #[test]
    fn through_the_apex_of_a_cone_both_sides_are_equal() {
        for (n, height) in [(6, 1.0), (7, 3.0), (5, 0.2)] {
            let cone = cone(n, height);
            for k in 0..n {
                // Up along a spoke; the far side is the spoke opposite, or the middle of the face opposite.
                let up = cone.positions()[n] - cone.positions()[k];
                let path = lawful(&cone, SurfacePoint::Vertex(k), up, 1.5 * up.length());
                let angle = TAU * (k as f64 + 0.5 * n as f64) / n as f64;
                let (sin, cos) = math::sin_cos(angle);
                let end = last(&path);
                assert!(end.x * sin - end.y * cos < 1e-13 && end.x * cos + end.y * sin > 0.0);
                assert_eq!(path.points[1], SurfacePoint::Vertex(n));
            }
        }
    }

    #[test]
    fn on_a_sphere_it_is_a_great_circle_within_the_tessellation() {
        let ball = sphere(5);
        let mut random = Random::new(17);
        for _ in 0..50 {
            let start = random.in_face(&ball);
            let direction = random.vector();
            let path = lawful(&ball, start, direction, TAU);
            assert_eq!(path.ending.stop, StraightestStop::Length);
            assert!(
                last(&path).distance(ball.position(start)) < 0.06,
                "once around"
            );
        }
    }

    #[test]
    fn faces_without_area_are_crossed() {
        // Two halves of a plane, joined at a seam of faces without area: one vertex of the left half twice.
        let positions = vec![
            dvec3(0.0, 0.0, 0.0),
            dvec3(0.0, 2.0, 0.0),
            dvec3(-2.0, 1.0, 0.0),
            dvec3(0.0, 0.0, 0.0),
            dvec3(0.0, 2.0, 0.0),
            dvec3(2.0, 1.0, 0.0),
            dvec3(0.0, 0.75, 0.0),
        ];
        let faces = [
            [0, 1, 2],
            [0, 3, 6],
            [0, 6, 1],
            [1, 6, 4],
            [6, 3, 5],
            [6, 5, 4],
        ];
        let seam = Surface::new(positions, &faces).expect("a seam");
        let start = SurfacePoint::Face {
            face: 0,
            weights: [0.25, 0.25, 0.5],
        };
        for (y, length) in [
            (0.0, 2.0),
            (0.2, 2.0),
            (-0.21, 1.9),
            (0.3, 1.6),
            (-0.4, 1.6),
        ] {
            let direction = dvec3(1.0, y, 0.0).normalize();
            let path = lawful(&seam, start, direction, length);
            assert_eq!(path.ending.stop, StraightestStop::Length);
            assert!(last(&path).distance(seam.position(start) + direction * length) < 1e-13);
        }
        let refused = straightest(
            &seam,
            SurfacePoint::Face {
                face: 3,
                weights: [0.25, 0.25, 0.5],
            },
            DVec3::X,
            1.0,
        );
        assert_eq!(refused, Err(PathError::NoTangent));
    }

    #[test]
    fn non_manifold_edges_stop_it_and_questions_without_meaning_are_refused() {
        let positions = vec![
            DVec3::NEG_Z,
            DVec3::Z,
            dvec3(2.0, 0.0, 0.0),
            dvec3(-1.0, 2.0, 0.0),
            dvec3(-1.0, -2.0, 0.0),
        ];
        let book = Surface::new(positions, &[[0, 1, 2], [0, 1, 3], [0, 1, 4]]).expect("a book");
        let start = SurfacePoint::Face {
            face: 0,
            weights: [0.25, 0.25, 0.5],
        };
        let path = lawful(&book, start, DVec3::NEG_X, 3.0);
        assert_eq!(path.ending.stop, StraightestStop::NonManifold);
        assert!((path.ending.remaining - 2.0).abs() < 1e-14);
        // From the edge of three faces: that of the three that is nearest to the direction.
        let edge = book.topology().edge_between(0, 1).expect("the spine");
        let path = lawful(
            &book,
            SurfacePoint::Edge {
                edge,
                fraction: 0.5,
            },
            dvec3(-1.0, 1.0, 0.0),
            0.5,
        );
        assert_eq!(path.faces, [1]);

        let refused = |direction, length| straightest(&book, start, direction, length);
        assert_eq!(refused(DVec3::Y, 1.0), Err(PathError::Perpendicular));
        assert_eq!(
            refused(DVec3::ZERO, 1.0),
            Err(PathError::Direction { what: "direction" })
        );
        assert!(matches!(
            refused(DVec3::X, -1.0),
            Err(PathError::Length { .. })
        ));
        assert!(matches!(
            refused(DVec3::X, f64::NAN),
            Err(PathError::Length { .. })
        ));
        let cube = cube();
        let corner = SurfacePoint::Vertex(7);
        let normal = cube.normal(corner).expect("a normal");
        assert_eq!(
            straightest(&cube, corner, normal, 1.0),
            Err(PathError::Perpendicular)
        );
        // From the point of a spike, up and to the side: to that side.
        let spike = cone(6, 9.0);
        let path = lawful(&spike, SurfacePoint::Vertex(6), dvec3(-0.1, 0.0, 1.0), 4.0);
        let end = last(&path);
        assert!(end.x < -0.3 && end.y.abs() < 1e-14, "{end}");
    }

    #[test]
    fn a_walk_of_endless_length_stops_and_says_so() {
        let path = straightest(
            &cube(),
            SurfacePoint::Vertex(0),
            dvec3(1.0, 0.3, 0.1),
            f64::INFINITY,
        );
        let path = path.expect("a walk");
        assert_eq!(path.ending.stop, StraightestStop::Steps);
        assert_eq!(path.faces.len(), STRAIGHTEST_STEPS);
        assert_eq!(path.ending.remaining, f64::INFINITY);
    }
}
