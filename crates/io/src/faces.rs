//! Faces with any number of corners, and cutting them into triangles.
//!
//! *Source*: ear clipping after G. H. Meisters, "Polygons Have Ears", American Mathematical Monthly 82(6), 1975; area
//! vectors after M. E. Newell (I. E. Sutherland, R. F. Sproull and R. A. Schumacker, "A Characterization of Ten
//! Hidden-Surface Algorithms", ACM Computing Surveys 6(1), 1974).

use crate::normals::area_vector;
use anamorph_core::glam::{DVec2, DVec3};

/// Stands for "no normal" in [`Faces`].
pub(crate) const NONE: u32 = u32::MAX;

/// The faces of a mesh: `n` faces, their corners in file order.
#[derive(Default)]
pub(crate) struct Faces {
    /// Where each face's corners end.
    ends: Vec<usize>,
    /// Vertex of each corner.
    pub(crate) vertices: Vec<u32>,
    /// Normal of each corner or [`NONE`]; empty where normals were not asked for.
    pub(crate) normals: Vec<u32>,
}

impl Faces {
    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }
    fn range(&self, face: usize) -> core::ops::Range<usize> {
        (if face == 0 { 0 } else { self.ends[face - 1] })..self.ends[face]
    }
    /// Vertices of the corners of a face, at least three.
    pub(crate) fn vertices(&self, face: usize) -> &[u32] {
        &self.vertices[self.range(face)]
    }
    /// Normals of the corners of a face; empty where normals were not asked for.
    pub(crate) fn normals(&self, face: usize) -> &[u32] {
        self.normals.get(self.range(face)).unwrap_or(&[])
    }
    /// Where each face's corners end.
    pub(crate) fn ends(&self) -> &[usize] {
        &self.ends
    }
    /// Makes the corners pushed since the last call a face.
    pub(crate) fn close(&mut self) {
        self.ends.push(self.vertices.len());
    }
    /// Puts the faces of `parts` one after the other.
    pub(crate) fn concatenate(parts: Vec<Faces>) -> Faces {
        let mut all = Faces::default();
        all.ends.reserve_exact(parts.iter().map(Faces::len).sum());
        all.vertices
            .reserve_exact(parts.iter().map(|part| part.vertices.len()).sum());
        all.normals
            .reserve_exact(parts.iter().map(|part| part.normals.len()).sum());
        for part in parts {
            let base = all.vertices.len();
            all.ends.extend(part.ends.iter().map(|end| base + end));
            all.vertices.extend_from_slice(&part.vertices);
            all.normals.extend_from_slice(&part.normals);
        }
        all
    }

    /// All faces as triangles, in order.
    pub(crate) fn triangles(&self, points: &[DVec3]) -> Vec<[u32; 3]> {
        let mut out = Vec::with_capacity(self.vertices.len().saturating_sub(2 * self.len()));
        for face in 0..self.len() {
            triangulate(self.vertices(face), points, &mut out);
        }
        out
    }
}

/// Cuts one face into triangles wound as it is. A face of `n` corners gives `n − 2`, a degenerate one too.
pub(crate) fn triangulate(face: &[u32], points: &[DVec3], out: &mut Vec<[u32; 3]>) {
    if let &[a, b, c] = face {
        out.push([a, b, c]);
        return;
    }
    match flatten(face, points) {
        Some(flat) if !fan_is_correct(&flat) => clip_ears(face, &flat, out),
        // Also where nothing can be told: no area, or not finite.
        _ => fan(face, out),
    }
}

fn fan(face: &[u32], out: &mut Vec<[u32; 3]>) {
    if let Some((&first, rest)) = face.split_first() {
        out.extend(rest.windows(2).map(|pair| [first, pair[0], pair[1]]));
    }
}

/// The corners projected along the coordinate axis nearest to the face's normal, so that the face turns
/// counter-clockwise, and scaled to unit size. `None` when it has no normal.
fn flatten(face: &[u32], points: &[DVec3]) -> Option<Vec<DVec2>> {
    let at = |i: usize| points[face[i] as usize];
    // Half of everything first: a difference of two finite halves is finite.
    let size = (1..face.len()).fold(0.0_f64, |size, i| {
        size.max((at(i) * 0.5 - at(0) * 0.5).abs().max_element())
    });
    if !(size > 0.0 && size.is_finite()) {
        return None;
    }
    let scaled = |i: usize| (at(i) * 0.5 - at(0) * 0.5) / size;
    let normal = area_vector(face.len(), scaled);
    let magnitude = normal.abs();
    let largest = magnitude.max_element();
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    let project = |p: DVec3| {
        let (flat, sign) = if magnitude.x == largest {
            (DVec2::new(p.y, p.z), normal.x)
        } else if magnitude.y == largest {
            (DVec2::new(p.z, p.x), normal.y)
        } else {
            (DVec2::new(p.x, p.y), normal.z)
        };
        if sign < 0.0 {
            DVec2::new(flat.y, flat.x)
        } else {
            flat
        }
    };
    Some((0..face.len()).map(|i| project(scaled(i))).collect())
}

/// Twice the signed area of a triangle.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Whether all triangles of the fan from the first corner are wound as the face: then a simple polygon is seen whole
/// from that corner.
fn fan_is_correct(flat: &[DVec2]) -> bool {
    flat.windows(2)
        .skip(1)
        .all(|pair| turn(flat[0], pair[0], pair[1]) > 0.0)
}

/// How many corners the search for ears may look at, per corner of the face. Outlines met in practice need few tens; a
/// contrived one beyond this is fanned from where the search stopped, so that time stays linear in the file's size.
const EFFORT: usize = 4096;

fn clip_ears(face: &[u32], flat: &[DVec2], out: &mut Vec<[u32; 3]>) {
    let n = face.len();
    let mut next: Vec<usize> = (1..n).chain([0]).collect();
    let mut previous: Vec<usize> = [n - 1].into_iter().chain(0..n - 1).collect();
    let mut effort = n.saturating_mul(EFFORT);
    let (mut left, mut at, mut refused) = (n, 1 % n, 0);
    while left > 3 && refused < left && effort > 0 {
        let (a, c) = (previous[at], next[at]);
        let (pa, pb, pc) = (flat[a], flat[at], flat[c]);
        let mut is_ear = turn(pa, pb, pc) > 0.0;
        let mut other = next[c];
        while is_ear && other != a {
            effort = effort.saturating_sub(1);
            let p = flat[other];
            // A corner where the outline touches itself (a bridge to a hole) does not block the ear it touches.
            is_ear = p == pa
                || p == pb
                || p == pc
                || turn(pa, pb, p) < 0.0
                || turn(pb, pc, p) < 0.0
                || turn(pc, pa, p) < 0.0;
            other = next[other];
        }
        if is_ear {
            out.push([face[a], face[at], face[c]]);
            (next[a], previous[c]) = (c, a);
            left -= 1;
            refused = 0;
            // Going on past the neighbour keeps the triangles from all meeting in one corner.
            at = next[c];
        } else {
            refused += 1;
            at = c;
        }
    }
    // What is left: the last triangle, or a part without proper ears (collinear or crossing itself).
    let rest: Vec<u32> = core::iter::successors(Some(at), |&i| Some(next[i]))
        .take(left)
        .map(|i| face[i])
        .collect();
    fan(&rest, out);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cuts a polygon of the plane, lifted and turned into space, and checks the triangles: as many as there must be,
    /// none inside out, areas adding up, and no corner of the outline strictly inside of one.
    fn check(outline: &[(f64, f64)]) -> Vec<[u32; 3]> {
        let lift = |x: f64, y: f64| DVec3::new(0.3 * x - y, x + 0.1 * y, 2.0 * x + 3.0 * y + 5.0);
        let points: Vec<DVec3> = outline.iter().map(|&(x, y)| lift(x, y)).collect();
        let flat: Vec<DVec2> = outline.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
        let face: Vec<u32> = (0..outline.len() as u32).collect();
        let mut triangles = Vec::new();
        triangulate(&face, &points, &mut triangles);
        assert_eq!(triangles.len(), outline.len() - 2);
        let whole: f64 = (1..flat.len() - 1)
            .map(|i| turn(flat[0], flat[i], flat[i + 1]))
            .sum();
        let mut sum = 0.0;
        for t in &triangles {
            let [a, b, c] = t.map(|i| flat[i as usize]);
            let area = turn(a, b, c);
            assert!(area * whole >= -1e-12, "{t:?} is inside out");
            sum += area;
            for p in &flat {
                let inside = [turn(a, b, *p), turn(b, c, *p), turn(c, a, *p)]
                    .map(|s| s * whole.signum() > 1e-9);
                assert!(inside != [true; 3], "{t:?} covers a corner");
            }
        }
        assert!((sum - whole).abs() < 1e-9 * whole.abs(), "{sum} of {whole}");
        triangles
    }

    #[test]
    fn convex_faces_are_fanned() {
        assert_eq!(
            check(&[(0., 0.), (1., 0.), (1., 1.), (0., 1.)]),
            [[0, 1, 2], [0, 2, 3]]
        );
        assert_eq!(
            check(&[(0., 1.), (1., 1.), (1., 0.), (0., 0.)]),
            [[0, 1, 2], [0, 2, 3]]
        );
    }

    #[test]
    fn concave_faces_are_cut_inside() {
        // An arrow head whose fan from the first corner leaves it.
        check(&[(0., 0.), (2., 1.), (0., 2.), (1., 1.)].map(|(x, y)| (x, y)));
        check(&[(1., 1.), (0., 0.), (2., 1.), (0., 2.)]);
        // A comb, both ways round.
        let mut comb = vec![(0., 0.)];
        for i in 0..20 {
            let x = f64::from(i);
            comb.extend([(x + 0.1, 5.), (x + 0.5, 0.2), (x + 0.9, 5.1)]);
        }
        comb.push((20., 0.));
        comb.push((10., -1.));
        check(&comb);
        comb.reverse();
        check(&comb);
        // A spiral.
        let arm = |turns: f64, radius: f64| {
            (
                radius * (turns * core::f64::consts::TAU).cos(),
                radius * (turns * core::f64::consts::TAU).sin(),
            )
        };
        let mut spiral: Vec<_> = (0..60)
            .map(|i| arm(f64::from(i) / 20.0, 1.0 + f64::from(i) / 20.0))
            .collect();
        spiral.extend(
            (0..60)
                .rev()
                .map(|i| arm(f64::from(i) / 20.0, 1.3 + f64::from(i) / 20.0)),
        );
        check(&spiral);
    }

    #[test]
    fn bridged_holes_and_collinear_corners() {
        // A square with a square hole, joined by a bridge that is walked twice.
        check(&[
            (0., 0.),
            (4., 0.),
            (4., 4.),
            (0., 4.),
            (0., 0.),
            (1., 1.),
            (1., 3.),
            (3., 3.),
            (3., 1.),
            (1., 1.),
        ]);
        check(&[
            (0., 0.),
            (1., 0.),
            (2., 0.),
            (2., 1.),
            (2., 2.),
            (1., 2.),
            (0., 2.),
            (0., 1.),
        ]);
    }

    #[test]
    fn faces_without_area_still_give_triangles() {
        let points = [
            DVec3::ZERO,
            DVec3::X,
            DVec3::X * 2.0,
            DVec3::splat(f64::NAN),
            DVec3::splat(1e308),
        ];
        for face in [
            vec![0, 1, 2, 1],
            vec![0, 0, 0, 0, 0],
            vec![0, 1, 3, 2],
            vec![4, 0, 1, 2],
        ] {
            let mut out = Vec::new();
            triangulate(&face, &points, &mut out);
            assert_eq!(out.len(), face.len() - 2);
        }
    }

    #[test]
    fn an_outline_made_to_be_slow_ends_in_time() {
        // A zigzag between two near-parallel lines, then back: many corners, few ears.
        let n = 3000;
        let points: Vec<DVec3> = (0..n)
            .map(|i| {
                let t = f64::from(i) * 0.5;
                DVec3::new(
                    t * (i % 2 * 2 - 1) as f64,
                    t * t * 1e-3 * f64::from(i % 3 - 1),
                    0.0,
                )
            })
            .collect();
        let face: Vec<u32> = (0..n as u32).collect();
        let mut out = Vec::new();
        triangulate(&face, &points, &mut out);
        assert_eq!(out.len(), face.len() - 2);
    }
}
