//! A face laid flat, and where a straight line leaves it.
//!
//! Unfolding faces one by one into the plane keeps lengths and angles, so that lines on a polyhedron are lines in the
//! plane (Polthier and Schmies 1998, §2; H. S. M. Coxeter, *Introduction to Geometry*, 1961, for nets). Everything is done
//! with signed distances from the line, never by dividing by an area, so that faces without area can be crossed.

use anamorph_core::glam::{DVec2, DVec3};

use crate::{Surface, SurfacePoint};

/// A line that passes a corner nearer than this share of the face's size goes through the corner; a place this near to an
/// end of an edge, as a share of its length, is the end. A hundred roundings; smaller, and lines aimed at a vertex miss it.
pub(super) const SNAP: f64 = 1e-13;

/// Faces whose height is below this share of their base have no area: their plane is rounding.
const FLAT: f64 = 4.0 * f64::EPSILON;

/// A face laid into the plane, its first corner at the origin, its second on the x axis, its third above or on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Flat {
    pub(super) face: usize,
    /// The vertices of the corners.
    pub(super) vertices: [usize; 3],
    /// The corners in the plane, counter-clockwise.
    pub(super) corners: [DVec2; 3],
}

/// Where a line comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Entry {
    /// From within the face.
    Inside,
    /// Over the first side, from corner 0 to corner 1.
    Base,
    /// From corner 0.
    Origin,
}

/// Where a line leaves a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Exit {
    /// At a corner.
    Corner(usize),
    /// On the side from a corner to the next, at a fraction of it.
    Side(usize, f64),
}

/// The signed area of the parallelogram of two vectors: positive where the second is to the left of the first.
pub(super) fn cross(a: DVec2, b: DVec2) -> f64 {
    a.perp_dot(b)
}

impl Flat {
    /// A face laid so that two of its vertices are the first and the second corner. `None` for degenerate faces and
    /// vertices that are not the face's.
    pub(super) fn along(
        surface: &Surface,
        face: usize,
        first: usize,
        second: usize,
    ) -> Option<Self> {
        surface.topology().sides(face)?;
        let triangle = surface.topology().triangle(face);
        let &third = triangle.iter().find(|&&v| v != first && v != second)?;
        let vertices = [first, second, third];
        let [a, b, c] = vertices.map(|v| surface.positions()[v]);
        let (base, side) = (b - a, c - a);
        let corners = match base.try_normalize() {
            Some(x) => [
                DVec2::ZERO,
                DVec2::new(base.length(), 0.0),
                DVec2::new(side.dot(x), x.cross(side).length()),
            ],
            None => [DVec2::ZERO, DVec2::ZERO, DVec2::new(side.length(), 0.0)],
        };
        Some(Self {
            face,
            vertices,
            corners,
        })
    }

    /// A face laid on its longest side.
    pub(super) fn on_longest_side(surface: &Surface, face: usize) -> Option<Self> {
        let triangle = surface.topology().triangle(face);
        let length = |k: usize| {
            let [a, b] = [triangle[k], triangle[(k + 1) % 3]].map(|v| surface.positions()[v]);
            a.distance(b)
        };
        let k = (1..3).fold(0, |longest, k| {
            if length(k) > length(longest) {
                k
            } else {
                longest
            }
        });
        Self::along(surface, face, triangle[k], triangle[(k + 1) % 3])
    }

    /// Whether the face has area, and its plane a direction.
    pub(super) fn has_area(&self) -> bool {
        let size = self.corners[1].x.max(self.corners[2].length());
        self.corners[2].y > FLAT * size
    }

    /// The axes of the plane in space: along the base, and in the face away from it. `None` without area.
    fn axes(&self, surface: &Surface) -> Option<[DVec3; 2]> {
        if !self.has_area() {
            return None;
        }
        let [a, b, c] = self.vertices.map(|v| surface.positions()[v]);
        let x = (b - a).try_normalize()?;
        let side = c - a;
        let y = (side - x * side.dot(x)).try_normalize()?;
        // Once more, for needles whose third corner is far along the base.
        let y = (y - x * y.dot(x)).try_normalize()?;
        Some([x, y])
    }

    /// The part of a direction in space that lies in the face.
    pub(super) fn part_of(&self, surface: &Surface, direction: DVec3) -> Option<DVec2> {
        let [x, y] = self.axes(surface)?;
        Some(DVec2::new(direction.dot(x), direction.dot(y)))
    }

    /// A direction of the plane in space.
    pub(super) fn in_space(&self, surface: &Surface, direction: DVec2) -> Option<DVec3> {
        let [x, y] = self.axes(surface)?;
        Some(x * direction.x + y * direction.y)
    }

    /// A place that the face touches, in the plane.
    pub(super) fn place(&self, surface: &Surface, point: SurfacePoint) -> DVec2 {
        let triangle = surface.topology().triangle(self.face);
        let weights = surface.weights_in(self.face, point);
        let mut sum = DVec2::ZERO;
        for (vertex, weight) in triangle.into_iter().zip(weights) {
            if let Some(k) = (0..3).find(|&k| self.vertices[k] == vertex) {
                sum += self.corners[k] * weight;
            }
        }
        sum
    }

    /// The side from a corner to the next as an edge of the surface.
    pub(super) fn edge(&self, surface: &Surface, side: usize) -> Option<usize> {
        let (a, b) = (self.vertices[side], self.vertices[(side + 1) % 3]);
        let topology = surface.topology();
        let ends = [a.min(b), a.max(b)];
        topology
            .sides(self.face)?
            .into_iter()
            .find(|&edge| topology.ends(edge) == ends)
    }

    /// An exit as a place of the surface.
    pub(super) fn exit_point(&self, surface: &Surface, exit: Exit) -> SurfacePoint {
        match exit {
            Exit::Corner(k) => SurfacePoint::Vertex(self.vertices[k]),
            Exit::Side(k, fraction) => match self.edge(surface, k) {
                Some(edge) => {
                    let up = surface.topology().ends(edge)[0] == self.vertices[k];
                    let fraction = if up { fraction } else { 1.0 - fraction };
                    surface.simplified(SurfacePoint::Edge { edge, fraction })
                }
                None => SurfacePoint::Vertex(self.vertices[k]),
            },
        }
    }

    /// Where a line from `origin` in the unit direction `direction`, which points into the face, leaves it, and how far
    /// that is.
    pub(super) fn leave(&self, origin: DVec2, direction: DVec2, from: Entry) -> (Exit, f64) {
        let offsets = self.corners.map(|corner| corner - origin);
        let size = offsets.iter().fold(0.0_f64, |m, o| m.max(o.length()));
        let sides = offsets.map(|o| cross(direction, o));
        let ahead = offsets.map(|o| o.dot(direction));
        let on_line = sides.map(|s| s.abs() <= SNAP * size);

        let corner = (0..3)
            .filter(|&k| on_line[k] && !(from == Entry::Origin && k == 0))
            // The corner opposite the side that was crossed is ahead, even where the face has no height.
            .filter(|&k| ahead[k] > 0.0 || (from == Entry::Base && k == 2))
            .min_by(|&a, &b| ahead[a].total_cmp(&ahead[b]));
        if let Some(k) = corner {
            return (Exit::Corner(k), ahead[k].max(0.0));
        }
        // The side whose first corner is to the right of the line and whose second is to its left.
        let side = match from {
            Entry::Origin => 1,
            Entry::Base if sides[2] > 0.0 => 1,
            Entry::Base => 2,
            Entry::Inside => {
                let reach = |k: usize| {
                    let (right, left) = (k, (k + 1) % 3);
                    let t = crossing(sides[right], sides[left]);
                    ahead[right] * (1.0 - t) + ahead[left] * t
                };
                (0..3)
                    .filter(|&k| sides[k] <= 0.0 && sides[(k + 1) % 3] >= 0.0)
                    .max_by(|&a, &b| reach(a).total_cmp(&reach(b)))
                    .unwrap_or(0)
            }
        };
        let (right, left) = (side, (side + 1) % 3);
        let t = crossing(sides[right], sides[left]);
        let exit = if t <= SNAP {
            Exit::Corner(right)
        } else if t >= 1.0 - SNAP {
            Exit::Corner(left)
        } else {
            Exit::Side(side, t)
        };
        let distance = ahead[right] * (1.0 - t) + ahead[left] * t;
        (exit, distance.max(0.0))
    }
}

/// Where a line crosses a side, as a fraction, from the signed distances of its ends.
fn crossing(right: f64, left: f64) -> f64 {
    if left > right {
        (right / (right - left)).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// The place at a fraction of the segment between two places of a face.
pub(super) fn between(
    surface: &Surface,
    face: usize,
    from: SurfacePoint,
    to: SurfacePoint,
    fraction: f64,
) -> SurfacePoint {
    let (a, b) = (surface.weights_in(face, from), surface.weights_in(face, to));
    let weights = core::array::from_fn(|k| a[k] * (1.0 - fraction) + b[k] * fraction);
    surface.simplified(SurfacePoint::Face { face, weights })
}
