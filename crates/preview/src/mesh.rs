//! A model made ready to draw: in the frame, without what cannot be drawn, with normals that keep hard edges.
//!
//! *Source* of the angle weights: G. Thürmer, C. A. Wüthrich, *Computing vertex normals from polygonal facets*,
//! Journal of Graphics Tools 3(1), 1998.

use std::collections::HashSet;

use anamorph_core::glam::DVec3;

use crate::panel::{Drawable, Model};
use crate::parallel;
use crate::view::Frame;

/// Cosine of the angle between two faces (48°) above which their common edge stays hard. Lower and coarse smooth bodies
/// show facets; higher and the edges of machined parts smear.
const CREASE_COSINE: f64 = 0.669;

/// Triangles a point above which repeated triangles are looked for and left out: each would be drawn into every depth map
/// of every light, for nothing.
const REPEATS: usize = 8;

/// A model in the frame.
#[derive(Debug, Default)]
pub(crate) struct Mesh {
    /// All points; those that are not finite are NaN and not referred to.
    pub points: Vec<DVec3>,
    /// Triangles with area.
    pub triangles: Vec<[u32; 3]>,
    /// Lines between two different finite points.
    pub lines: Vec<[u32; 2]>,
    /// Points to draw on their own.
    pub dots: Vec<u32>,
    /// Linear colour of each point; empty if the model has none.
    pub colours: Vec<Option<[f32; 3]>>,
}

/// Which points of a model are drawn: the finite ends of its triangles and lines, or else all that are finite.
pub(crate) fn drawn_points<'a, S: Drawable>(
    model: &Model<'a, S>,
) -> impl Iterator<Item = DVec3> + use<'a, S> {
    let points = model.points;
    let at = move |index: &u32| {
        points
            .get(*index as usize)
            .copied()
            .filter(|point| point.is_finite())
    };
    let mut any = false;
    let mut used = vec![false; points.len()];
    let mut mark = |corners: &[u32]| {
        let mut places = corners.iter().filter_map(at);
        // A triangle or a line at a single place draws nothing.
        let first = places.next();
        let extended = places.any(|place| Some(place) != first);
        if corners.iter().all(|corner| at(corner).is_some()) && extended {
            any = true;
            for &corner in corners {
                if let Some(flag) = used.get_mut(corner as usize) {
                    *flag = true;
                }
            }
        }
    };
    model.triangles.iter().for_each(|corners| mark(corners));
    model.lines.iter().for_each(|corners| mark(corners));
    points
        .iter()
        .zip(used)
        .filter(move |(point, used)| point.is_finite() && (*used || !any))
        .map(|(point, _)| point.lift())
}

impl Mesh {
    /// The drawable part of `model` in `frame`.
    pub(crate) fn new<S: Drawable>(model: &Model<'_, S>, frame: &Frame) -> Self {
        let points: Vec<DVec3> = model
            .points
            .iter()
            .map(|point| {
                if point.is_finite() {
                    frame.place(point.lift())
                } else {
                    DVec3::NAN
                }
            })
            .collect();
        let finite = |index: u32| {
            points
                .get(index as usize)
                .is_some_and(|point| point.is_finite())
        };
        let mut triangles: Vec<[u32; 3]> = model
            .triangles
            .iter()
            .copied()
            .filter(|&[a, b, c]| {
                finite(a) && finite(b) && finite(c) && {
                    let [a, b, c] = [a, b, c].map(|index| points[index as usize]);
                    (b - a).cross(c - a).length_squared() > 0.0
                }
            })
            .collect();
        if triangles.len() > REPEATS * points.len() {
            // A surface has about two triangles a point; here many lie on one another.
            let mut seen = HashSet::new();
            triangles.retain(|&[a, b, c]| {
                let least = a.min(b).min(c);
                seen.insert(if least == a {
                    [a, b, c]
                } else if least == b {
                    [b, c, a]
                } else {
                    [c, a, b]
                })
            });
        }
        let lines: Vec<[u32; 2]> = model
            .lines
            .iter()
            .copied()
            .filter(|&[a, b]| finite(a) && finite(b) && points[a as usize] != points[b as usize])
            .collect();
        let dots = if triangles.is_empty() && lines.is_empty() {
            (0..points.len())
                .filter_map(|index| u32::try_from(index).ok())
                .filter(|&index| finite(index))
                .collect()
        } else {
            Vec::new()
        };
        let colours = model.colours.map_or_else(Vec::new, |colours| {
            colours
                .iter()
                .map(|colour| {
                    colour
                        .iter()
                        .all(|part| part.is_finite())
                        .then(|| colour.map(decode_srgb))
                })
                .collect()
        });
        Self {
            points,
            triangles,
            lines,
            dots,
            colours,
        }
    }

    /// Linear colour of a point, or `material`.
    pub(crate) fn colour(&self, index: u32, material: [f32; 3]) -> [f32; 3] {
        self.colours
            .get(index as usize)
            .copied()
            .flatten()
            .unwrap_or(material)
    }

    /// Unit normal of each triangle.
    pub(crate) fn face_normals(&self) -> Vec<[f32; 3]> {
        let mut normals = vec![[0.0; 3]; self.triangles.len()];
        parallel::chunks(&mut normals, 1 << 14, |number, chunk| {
            let first = number << 14;
            for (normal, &corners) in chunk.iter_mut().zip(&self.triangles[first..]) {
                let [a, b, c] = corners.map(|index| self.points[index as usize]);
                *normal = unit(
                    (b - a)
                        .normalize_or_zero()
                        .cross((c - a).normalize_or_zero()),
                );
            }
        });
        normals
    }

    /// Unit normal at each corner of each triangle: the angle-weighted mean over the faces that are reached around the
    /// vertex without crossing a hard edge. Points at the same place count as one vertex, so that seams do not show.
    pub(crate) fn corner_normals(&self) -> Vec<[[f32; 3]; 3]> {
        let faces = self.face_normals();
        let vertex = self.welded();
        // For every vertex the corners at it, in compressed rows.
        let mut start = vec![0_u32; self.points.len() + 1];
        for corners in &self.triangles {
            for &corner in corners {
                start[vertex[corner as usize] as usize + 1] += 1;
            }
        }
        for index in 1..start.len() {
            start[index] += start[index - 1];
        }
        let mut fill = start.clone();
        let mut around = vec![0_u32; self.triangles.len() * 3];
        for (face, corners) in self.triangles.iter().enumerate() {
            for (side, &corner) in corners.iter().enumerate() {
                let place = &mut fill[vertex[corner as usize] as usize];
                around[*place as usize] = (face * 3 + side) as u32;
                *place += 1;
            }
        }
        let mut normals: Vec<[[f32; 3]; 3]> = faces.iter().map(|&normal| [normal; 3]).collect();
        let mut fans = Fans::default();
        for row in start.windows(2) {
            let corners = &around[row[0] as usize..row[1] as usize];
            if corners.len() > 1 {
                fans.blend(self, &vertex, &faces, corners, &mut normals);
            }
        }
        normals
    }

    /// For each point the first point at the same place.
    fn welded(&self) -> Vec<u32> {
        let key = |index: u32| self.points[index as usize].to_array().map(f64::to_bits);
        let mut order: Vec<u32> = (0..self.points.len() as u32).collect();
        order.sort_unstable_by_key(|&index| (key(index), index));
        let mut first: Vec<u32> = (0..self.points.len() as u32).collect();
        for pair in order.windows(2) {
            if key(pair[0]) == key(pair[1]) {
                first[pair[1] as usize] = first[pair[0] as usize];
            }
        }
        first
    }
}

/// The corners at one vertex, parted by hard edges.
#[derive(Default)]
struct Fans {
    /// Edges from the vertex: (other end, number of the corner).
    edges: Vec<(u32, u32)>,
    /// Disjoint sets of corners.
    parent: Vec<u32>,
    /// Sum of the normals of each set.
    sums: Vec<DVec3>,
}

impl Fans {
    fn root(&mut self, mut corner: u32) -> u32 {
        while self.parent[corner as usize] != corner {
            let above = self.parent[self.parent[corner as usize] as usize];
            self.parent[corner as usize] = above;
            corner = above;
        }
        corner
    }

    fn blend(
        &mut self,
        mesh: &Mesh,
        vertex: &[u32],
        faces: &[[f32; 3]],
        corners: &[u32],
        normals: &mut [[[f32; 3]; 3]],
    ) {
        let face_of = |corner: u32| vec3(faces[corner as usize / 3]);
        self.edges.clear();
        self.parent.clear();
        self.parent.extend(0..corners.len() as u32);
        self.sums.clear();
        self.sums.resize(corners.len(), DVec3::ZERO);
        for (number, &corner) in corners.iter().enumerate() {
            let (face, side) = (mesh.triangles[corner as usize / 3], corner as usize % 3);
            for other in [face[(side + 1) % 3], face[(side + 2) % 3]] {
                self.edges.push((vertex[other as usize], number as u32));
            }
        }
        self.edges.sort_unstable();
        let edges = core::mem::take(&mut self.edges);
        for shared in edges.chunk_by(|a, b| a.0 == b.0) {
            for (index, &(_, one)) in shared.iter().enumerate() {
                // An edge with many faces has no meaningful smoothness; two sheets back to back are the case that counts.
                for &(_, other) in shared[index + 1..].iter().take(3) {
                    let cosine =
                        face_of(corners[one as usize]).dot(face_of(corners[other as usize]));
                    if cosine > CREASE_COSINE {
                        let (one, other) = (self.root(one), self.root(other));
                        self.parent[one.max(other) as usize] = one.min(other);
                    }
                }
            }
        }
        self.edges = edges;
        for (number, &corner) in corners.iter().enumerate() {
            let (face, side) = (mesh.triangles[corner as usize / 3], corner as usize % 3);
            let at = |step: usize| mesh.points[face[(side + step) % 3] as usize];
            let angle = (at(1) - at(0))
                .normalize_or_zero()
                .angle_between((at(2) - at(0)).normalize_or_zero());
            let root = self.root(number as u32);
            if angle.is_finite() {
                self.sums[root as usize] += face_of(corner) * angle;
            }
        }
        for (number, &corner) in corners.iter().enumerate() {
            let root = self.root(number as u32);
            let sum = self.sums[root as usize];
            if sum.length_squared() > 1e-12 {
                normals[corner as usize / 3][corner as usize % 3] = unit(sum);
            }
        }
    }
}

fn unit(vector: DVec3) -> [f32; 3] {
    vector
        .normalize_or_zero()
        .to_array()
        .map(|part| part as f32)
}

/// The vector as `f64`.
pub(crate) fn vec3(parts: [f32; 3]) -> DVec3 {
    DVec3::from_array(parts.map(f64::from))
}

/// From an sRGB-encoded value, clamped to 0 to 1, to linear light (IEC 61966-2-1).
pub(crate) fn decode_srgb(value: f32) -> f32 {
    let value = value.clamp(0.0, 1.0);
    if value <= 0.04045 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(points: &[DVec3], triangles: &[[u32; 3]]) -> Mesh {
        let frame = Frame {
            centre: DVec3::ZERO,
            half: 1.0,
        };
        Mesh::new(&Model::mesh(points, triangles), &frame)
    }

    /// Two triangles that share the edge along x, the second turned up by `angle`.
    fn hinge(angle: f64) -> Mesh {
        let points = [
            DVec3::ZERO,
            DVec3::X,
            DVec3::new(0.5, -1.0, 0.0),
            DVec3::new(0.5, angle.cos(), angle.sin()),
        ];
        mesh(&points, &[[0, 2, 1], [0, 1, 3]])
    }

    #[test]
    fn triangles_that_repeat_are_drawn_once() {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let many = [[0, 1, 2], [1, 2, 0], [2, 1, 0], [0, 2, 1]].repeat(100);
        // The other side of a triangle is another one.
        assert_eq!(mesh(&points, &many).triangles, [[0, 1, 2], [2, 1, 0]]);
        let few = [[0, 1, 2]; 5];
        assert_eq!(mesh(&points, &few).triangles.len(), 5);
    }

    #[test]
    fn a_gentle_edge_is_smooth_and_a_sharp_one_hard() {
        for (degrees, smooth) in [(20.0_f64, true), (45.0, true), (52.0, false), (90.0, false)] {
            let hinge = hinge(degrees.to_radians());
            let normals = hinge.corner_normals();
            assert_eq!(normals[0][0] == normals[1][0], smooth, "{degrees}°");
        }
    }

    #[test]
    fn points_at_one_place_are_one_vertex() {
        let points = [
            DVec3::ZERO,
            DVec3::X,
            DVec3::NEG_Y,
            DVec3::new(-0.0, 0.0, -0.0),
            DVec3::X,
            DVec3::new(0.0, 1.0, 0.3),
        ];
        let seam = mesh(&points, &[[0, 2, 1], [3, 4, 5]]);
        let normals = seam.corner_normals();
        assert_eq!(normals[0][0], normals[1][0]);
    }

    #[test]
    fn two_sheets_back_to_back_keep_their_own_sides() {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.1)];
        let sheets = mesh(&points, &[[0, 1, 2], [1, 3, 2], [0, 2, 1], [1, 2, 3]]);
        let normals = sheets.corner_normals();
        for corners in &normals[..2] {
            assert!(corners.iter().all(|normal| normal[2] > 0.9));
        }
        for corners in &normals[2..] {
            assert!(corners.iter().all(|normal| normal[2] < -0.9));
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_left_out() {
        let points = [
            DVec3::ZERO,
            DVec3::X,
            DVec3::Y,
            DVec3::NAN,
            DVec3::splat(f64::INFINITY),
            DVec3::X * 0.5,
        ];
        let frame = Frame {
            centre: DVec3::ZERO,
            half: 1.0,
        };
        let triangles = [
            [0, 1, 2],
            [0, 1, 3],
            [0, 4, 2],
            [0, 1, 99],
            [0, 0, 1],
            [0, 1, 5],
        ];
        let model = Model::mesh(&points, &triangles).with_lines(&[[0, 1], [1, 1], [2, 3], [7, 0]]);
        let kept = Mesh::new(&model, &frame);
        assert_eq!(kept.triangles, [[0, 1, 2]]);
        assert_eq!(kept.lines, [[0, 1]]);
        assert!(kept.dots.is_empty());
    }

    #[test]
    fn a_vertex_with_many_faces_takes_no_longer_than_sorting_them() {
        let count = 200_000_u32;
        let rim = (0..count).map(|index| {
            let angle = f64::from(index) / f64::from(count) * core::f64::consts::TAU;
            DVec3::new(angle.cos(), angle.sin(), 0.0)
        });
        let points: Vec<DVec3> = core::iter::once(DVec3::ZERO).chain(rim).collect();
        let triangles: Vec<[u32; 3]> = (1..count).map(|index| [0, index, index + 1]).collect();
        let disc = mesh(&points, &triangles);
        assert!(
            disc.corner_normals()
                .iter()
                .flatten()
                .all(|normal| normal[2] > 0.999)
        );
    }
}
