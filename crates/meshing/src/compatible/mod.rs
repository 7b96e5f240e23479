//! Compatible triangulations: the same triangles over two regions whose rings correspond point by point.
//!
//! Both regions have the same number of rings, and each ring the same number of points as its partner; point `i` of a ring belongs to
//! point `i` of the other.
//!
//! 1. Both regions are cut open along paths between their rings, until each is a disk; the paths correspond (module `cuts`).
//! 2. Both are triangulated, and the triangulations laid over each other: what lies in one triangle of each is a convex polygon in both. This
//!    always works (module `overlay`).
//! 3. The points are as few and the angles as large as can be: edges are flipped, joined and split and inner points moved in both meshes at
//!    once, as long as that helps and every triangle stays positive in both (module `remeshing`).
//!
//! Every triangle of both meshes is positive by exact tests: with rings that do not cross, the piecewise linear map from one region to the
//! other is then one to one.
//!
//! *Source*: Yan, Hu and Martin 2004, "From Objects to Isomorphic Meshes": anchors, inner points, constrained Delaunay triangulation, paths,
//! patches seen on a regular polygon, flips, added inner points, optimization of both meshes. Decision: there is one patch, all of the region,
//! and which edges of both triangulations cross on the polygon is found from the order of their ends, without coordinates. Merging
//! points and triangulating them anew, as published, may turn triangles over; the overlay may not, and what it has too much of is
//! taken away again. Erratum S6: no triangle is turned.

mod cuts;
mod mesh;
mod overlay;
mod remeshing;

use crate::planar::{Region, RegionError, orientation};
use anamorph_core::glam::DVec2;
use mesh::Mesh;

/// How compatible triangulations are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompatibleOptions {
    /// Whether both meshes are made better; if not, they are as they were laid over each other.
    pub improve: bool,
    /// The largest triangle, as a share of the region's area in either mesh; infinite for any. Counts where meshes are made better.
    pub largest_triangle: f64,
}

impl Default for CompatibleOptions {
    /// Made better; no triangle above a hundredth of its region.
    fn default() -> Self {
        Self {
            improve: true,
            largest_triangle: 0.01,
        }
    }
}

/// One triangulation of two regions.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CompatiblePair {
    /// Points in the source: those of the rings as given, then the inner ones that were asked for, then those that were added.
    pub source: Vec<DVec2>,
    /// The same points in the target.
    pub target: Vec<DVec2>,
    /// Triangles by numbers of points, counterclockwise in both.
    pub triangles: Vec<[u32; 3]>,
    /// The rings by numbers of points, the outer one first.
    pub rings: Vec<Vec<u32>>,
    /// How many triangles there were when both triangulations lay over each other.
    pub overlaid: usize,
}

/// Why there is no compatible triangulation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CompatibleError {
    /// The source is no region.
    #[error("the source: {0}")]
    Source(RegionError),
    /// The target is no region.
    #[error("the target: {0}")]
    Target(RegionError),
    /// Unlike numbers of rings.
    #[error("the source has {source_rings} rings and the target {target_rings}; match them first")]
    Rings {
        /// Rings of the source.
        source_rings: usize,
        /// Rings of the target.
        target_rings: usize,
    },
    /// Unlike numbers of points.
    #[error(
        "ring {ring} has {source_points} points in the source and {target_points} in the target; make them the same"
    )]
    Points {
        /// Which ring.
        ring: usize,
        /// Its points in the source.
        source_points: usize,
        /// Its points in the target.
        target_points: usize,
    },
    /// An inner point that is not inside.
    #[error("inner point {point} is not inside the target, at ({}, {})", place.x, place.y)]
    Inner {
        /// Which point.
        point: usize,
        /// Where.
        place: DVec2,
    },
    /// Some triangles stay folded.
    #[error(
        "{folded} triangles are too thin for numbers of 64 bits near ({}, {}) of the source, ({}, {}) of the target; set an anchor there, or match the outlines \
         otherwise", source_place.x, source_place.y, target_place.x, target_place.y
    )]
    Folded {
        /// How many triangles.
        folded: usize,
        /// Where one of them is in the source.
        source_place: DVec2,
        /// And in the target.
        target_place: DVec2,
    },
    /// Regions that cannot be cut open into disks.
    #[error(
        "the triangulations of both could not be laid over each other: their rings have too few points to be joined"
    )]
    Overlay,
}

/// Triangulates two regions alike. `inner` are pairs of points inside that correspond.
///
/// # Errors
/// [`CompatibleError`].
pub fn compatible(
    source: &Region,
    target: &Region,
    inner: &[(DVec2, DVec2)],
    options: &CompatibleOptions,
) -> Result<CompatiblePair, CompatibleError> {
    source.check().map_err(CompatibleError::Source)?;
    target.check().map_err(CompatibleError::Target)?;
    let (source_rings, target_rings) = (source.rings().count(), target.rings().count());
    if source_rings != target_rings {
        return Err(CompatibleError::Rings {
            source_rings,
            target_rings,
        });
    }
    for (ring, (a, b)) in source.rings().zip(target.rings()).enumerate() {
        if a.len() != b.len() {
            return Err(CompatibleError::Points {
                ring,
                source_points: a.len(),
                target_points: b.len(),
            });
        }
    }
    for (point, (_, place)) in inner.iter().enumerate() {
        let around = target
            .rings()
            .filter(|ring| crate::planar::contains(ring, *place));
        if around.count() != 1 {
            let place = *place;
            return Err(CompatibleError::Inner { point, place });
        }
    }
    let made = overlay::overlay([source, target], inner).map_err(CompatibleError::Source)?;
    let made = made.ok_or(CompatibleError::Overlay)?;
    let overlaid = made.triangles.len();
    let mut mesh = Mesh {
        source: made.source,
        target: made.target,
        triangles: made.triangles,
        fixed: source.len() + inner.len(),
    };
    if options.improve {
        remeshing::improve(&mut mesh, options.largest_triangle);
    }
    let folded = mesh.folded();
    match folded.first() {
        Some(&first) => Err(mesh.fault(first, folded.len())),
        None => Ok(mesh.pair(source, overlaid)),
    }
}

impl Mesh {
    /// That triangles stay folded.
    fn fault(&self, triangle: usize, folded: usize) -> CompatibleError {
        let middle = |points: &[DVec2]| {
            let corners = self.triangles[triangle].map(|i| points[i as usize]);
            (corners[0] + corners[1] + corners[2]) / 3.0
        };
        CompatibleError::Folded {
            folded,
            source_place: middle(&self.source),
            target_place: middle(&self.target),
        }
    }

    /// As it is given to whoever asked.
    fn pair(self, region: &Region, overlaid: usize) -> CompatiblePair {
        let mut rings = Vec::new();
        let mut first = 0;
        for ring in region.rings() {
            let count = ring.len() as u32;
            rings.push((first..first + count).collect());
            first += count;
        }
        CompatiblePair {
            source: self.source,
            target: self.target,
            triangles: self.triangles,
            rings,
            overlaid,
        }
    }
}

/// What a pair of meshes is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairQuality {
    /// The smallest angle of source and target, in degrees.
    pub smallest_angle: [f64; 2],
    /// Triangles.
    pub triangles: usize,
    /// Points.
    pub points: usize,
}

/// What is wrong with a pair of meshes.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PairFault {
    /// Lists of unlike length, or a triangle with a point that is not there.
    #[error("triangle {triangle} has a point that one of the meshes lacks")]
    Index {
        /// Which triangle.
        triangle: usize,
    },
    /// A triangle that is not positive.
    #[error("triangle {triangle} is folded in the {side}, near ({}, {})", place.x, place.y)]
    Folded {
        /// Which triangle.
        triangle: usize,
        /// `source` or `target`.
        side: &'static str,
        /// Where.
        place: DVec2,
    },
    /// An edge with two triangles on one side, or a ring that no triangles lie along, or triangles that cover another area than the region.
    #[error("the triangles do not tile the {side}: {reason}")]
    Tiling {
        /// `source` or `target`.
        side: &'static str,
        /// What is wrong.
        reason: String,
    },
}

impl CompatiblePair {
    /// Looks at a pair without knowing how it was made: every triangle is positive in both meshes by exact tests, every edge is between two
    /// triangles or on a ring, and the triangles cover the area that the rings enclose.
    ///
    /// # Errors
    /// [`PairFault`].
    pub fn check(&self) -> Result<PairQuality, PairFault> {
        let mut edges = std::collections::HashSet::new();
        for (number, triangle) in self.triangles.iter().enumerate() {
            let count = self.source.len().min(self.target.len());
            if triangle.iter().any(|&i| i as usize >= count) {
                return Err(PairFault::Index { triangle: number });
            }
            for side in 0..3 {
                if !edges.insert([triangle[side], triangle[(side + 1) % 3]]) {
                    return Err(PairFault::Tiling {
                        side: "source",
                        reason: format!(
                            "an edge of triangle {number} has two triangles on one side"
                        ),
                    });
                }
            }
        }
        for (side, points) in [("source", &self.source), ("target", &self.target)] {
            let mut covered = 0.0;
            for (triangle, corners) in self.triangles.iter().enumerate() {
                let [a, b, c] = corners.map(|i| points[i as usize]);
                let twice = orientation(a, b, c);
                if twice <= 0.0 {
                    let place = (a + b + c) / 3.0;
                    return Err(PairFault::Folded {
                        triangle,
                        side,
                        place,
                    });
                }
                covered += 0.5 * twice;
            }
            let wrong = |reason: String| PairFault::Tiling { side, reason };
            let mut enclosed = 0.0;
            let mut on_rings = 0;
            for (number, ring) in self.rings.iter().enumerate() {
                for (i, &from) in ring.iter().enumerate() {
                    let to = ring[(i + 1) % ring.len()];
                    if !edges.contains(&[from, to]) || edges.contains(&[to, from]) {
                        return Err(wrong(format!(
                            "ring {number} has no triangle after its point {i}"
                        )));
                    }
                    on_rings += 1;
                }
                let places: Vec<DVec2> = ring.iter().map(|&i| points[i as usize]).collect();
                enclosed += crate::planar::area(&places);
            }
            let alone = edges.iter().filter(|[a, b]| !edges.contains(&[*b, *a]));
            if alone.count() != on_rings {
                return Err(wrong(
                    "there are edges at the border that are in no ring".to_owned(),
                ));
            }
            if (covered - enclosed).abs() > 1e-9 * enclosed.abs() {
                return Err(wrong(format!(
                    "they cover {covered}, and the rings enclose {enclosed}"
                )));
            }
        }
        let smallest = |points: &[DVec2]| {
            let of = |corners: &[u32; 3]| mesh::smallest_angle(corners.map(|i| points[i as usize]));
            let all = self.triangles.iter().map(of);
            all.fold(f64::INFINITY, f64::min).to_degrees()
        };
        Ok(PairQuality {
            smallest_angle: [smallest(&self.source), smallest(&self.target)],
            triangles: self.triangles.len(),
            points: self.source.len(),
        })
    }
}
