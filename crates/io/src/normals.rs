//! Normals of faces and vertices.
//!
//! *Source*: G. Thürmer and C. A. Wüthrich, "Computing Vertex Normals from Polygonal Facets", Journal of Graphics Tools
//! 3(1), 1998: weighted by angle, the normal of a vertex does not depend on how its faces are cut into triangles.

use crate::Normals;
use crate::faces::Faces;
use crate::text;
use anamorph_core::glam::DVec3;
use anamorph_core::math;

/// The area vector of a polygon with `n` corners: normal to it, as long as twice its area (Newell). Corners should be
/// near the origin and of moderate size.
pub(crate) fn area_vector(n: usize, corner: impl Fn(usize) -> DVec3) -> DVec3 {
    let mut sum = DVec3::ZERO;
    let first = corner(0);
    let mut before = corner(1) - first;
    for i in 2..n {
        let here = corner(i) - first;
        sum += before.cross(here);
        before = here;
    }
    sum
}

/// The unit normal of a polygon, or `None` when it has no area or is not finite.
pub(crate) fn unit_normal(face: &[u32], points: &[DVec3]) -> Option<DVec3> {
    let first = points[face[0] as usize];
    let edge = |i: usize| points[face[i] as usize] - first;
    let size = (1..face.len()).fold(0.0_f64, |size, i| size.max(edge(i).abs().max_element()));
    if !(size > 0.0 && size.is_finite()) {
        return None;
    }
    unit(area_vector(face.len(), |i| edge(i) / size))
}

/// The vector scaled to length 1, or `None` when it is null or not finite.
pub(crate) fn unit(v: DVec3) -> Option<DVec3> {
    let size = v.abs().max_element();
    (size > 0.0 && v.is_finite()).then(|| {
        let scaled = v / size;
        scaled / scaled.length()
    })
}

/// The angle of a polygon at corner `i` in radians, 0 where a side has no length.
pub(crate) fn angle(face: &[u32], i: usize, points: &[DVec3]) -> f64 {
    let at = |i: usize| points[face[i % face.len()] as usize];
    match (
        unit(at(i + 1) - at(i)),
        unit(at(i + face.len() - 1) - at(i)),
    ) {
        (Some(a), Some(b)) => math::acos(a.dot(b)),
        _ => 0.0,
    }
}

/// The mean of the normals around one vertex.
#[derive(Clone, Copy, Default)]
pub(crate) struct Mean {
    sum: DVec3,
    /// The only normal so far, kept apart so that the mean of equal normals is exactly that normal.
    only: Option<DVec3>,
    mixed: bool,
}

impl Mean {
    pub(crate) fn add(&mut self, normal: DVec3, weight: f64) {
        self.sum += normal * weight;
        match self.only {
            None => self.only = Some(normal),
            Some(only) => self.mixed |= only != normal,
        }
    }
    /// The mean, of unit length; `None` where there was none, or they cancel.
    pub(crate) fn result(&self) -> Option<DVec3> {
        if self.mixed {
            unit(self.sum)
        } else {
            self.only
        }
    }
}

/// Values that differ by less than this, relative to their largest coordinate, are one: far below what files store, and
/// above rounding.
const AGREE: f64 = 1e-12;

/// Whether two vectors are the same bit for bit.
#[inline]
pub(crate) fn same(a: DVec3, b: DVec3) -> bool {
    let differ = |a: f64, b: f64| a.to_bits() ^ b.to_bits();
    differ(a.x, b.x) | differ(a.y, b.y) | differ(a.z, b.z) == 0
}

/// Vertices evaluated together.
const BATCH: usize = 1 << 14;

/// The normals of a file that stores one a vertex, after the move, and the number of those for which there should have been
/// a new one but was none. A normal for which nothing changed keeps its bits.
pub(crate) fn per_vertex(
    old: Vec<DVec3>,
    positions: &[DVec3],
    moved: &[DVec3],
    faces: impl FnOnce() -> Faces,
    policy: Normals<'_>,
) -> (Vec<DVec3>, usize) {
    let mut new = old;
    // The value to write, and whether there should have been another.
    let settle = |old: DVec3, value: Option<DVec3>| match value {
        Some(value) if value.is_finite() && value != DVec3::ZERO => {
            let close = (old - value).abs().max_element() <= AGREE * old.abs().max_element();
            (if close { old } else { value }, false)
        }
        _ => (old, true),
    };
    let kept = match policy {
        Normals::Keep => 0,
        Normals::Transform(map) => {
            let runs = text::runs(new.len(), BATCH);
            let parts = text::map(&runs, |run| {
                let mut kept = 0;
                let values: Vec<DVec3> = run
                    .clone()
                    .map(|v| {
                        let old = new[v];
                        if !old.is_finite() || !positions[v].is_finite() {
                            return old;
                        }
                        let (value, failed) = settle(old, Some(map(v, old)));
                        kept += usize::from(failed);
                        value
                    })
                    .collect();
                (values, kept)
            });
            let mut kept = 0;
            let mut all = Vec::with_capacity(new.len());
            for (values, failed) in parts {
                all.extend(values);
                kept += failed;
            }
            new = all;
            kept
        }
        Normals::Recompute => {
            let faces = faces();
            let mut means = vec![Mean::default(); new.len()];
            let mut touched = vec![false; new.len()];
            for f in 0..faces.len() {
                let face = faces.vertices(f);
                let moves = face
                    .iter()
                    .any(|&v| !same(positions[v as usize], moved[v as usize]));
                let normal = unit_normal(face, moved);
                for (i, &v) in face.iter().enumerate() {
                    touched[v as usize] |= moves;
                    if let Some(normal) = normal {
                        means[v as usize].add(normal, angle(face, i, moved));
                    }
                }
            }
            let mut kept = 0;
            for (v, normal) in new.iter_mut().enumerate() {
                if touched[v] && normal.is_finite() {
                    let (value, failed) = settle(*normal, means[v].result());
                    *normal = value;
                    kept += usize::from(failed);
                }
            }
            kept
        }
    };
    (new, kept)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_corner_points_along_its_diagonal_however_it_is_cut() {
        let points = [
            DVec3::ZERO,
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
            DVec3::new(1., 1., 0.),
        ];
        let mean = |faces: &[&[u32]]| {
            let mut mean = Mean::default();
            for face in faces {
                let i = face.iter().position(|v| *v == 0).unwrap();
                mean.add(unit_normal(face, &points).unwrap(), angle(face, i, &points));
            }
            mean.result().unwrap()
        };
        let whole = mean(&[&[0, 2, 4, 1], &[0, 1, 3], &[0, 3, 2]]);
        let cut = mean(&[&[0, 2, 4], &[0, 4, 1], &[0, 1, 3], &[0, 3, 2]]);
        assert!((whole + DVec3::splat(3f64.sqrt().recip())).length() < 1e-15);
        assert!((whole - cut).length() < 1e-15);
    }

    #[test]
    fn extremes_have_normals_and_nothing_has_none() {
        for size in [1e-300, 1e300] {
            let points = [DVec3::ZERO, DVec3::X * size, DVec3::Y * size];
            assert_eq!(unit_normal(&[0, 1, 2], &points), Some(DVec3::Z));
        }
        assert_eq!(unit_normal(&[0, 0, 0], &[DVec3::ONE]), None);
        assert_eq!(Mean::default().result(), None);
    }
}
