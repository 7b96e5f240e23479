//! Compatible triangulations: the same triangles over two regions whose rings correspond point by point.
//!
//! Both regions have the same number of rings, and each ring the same number of points as its partner; point `i` of a ring belongs to
//! point `i` of the other. The source is triangulated, with points added inside; its triangles are laid into the target, whose rings are
//! held, first by a discrete harmonic map, which may fold, then by minimizing an energy that unfolds what is folded (module
//! `unfolding`). What stays folded is split into smaller triangles, and unfolded again. Edges are flipped and inner points moved where
//! that makes the smallest angle of both meshes larger. Every triangle of both meshes is positive by exact tests: with rings that do not
//! cross, the piecewise linear map from one region to the other is then one to one.
//!
//! *Source*: Yan, Hu and Martin 2004, "From Objects to Isomorphic Meshes": anchors, inner points, constrained Delaunay triangulation, flips,
//! added inner points, optimization of both meshes. Decision: instead of patches that are mapped onto a regular polygon, whose merged
//! points are triangulated and mapped back, the triangles of one region are laid into the other directly. That needs no patches (regions
//! may have holes), keeps the number of triangles that of one mesh, and ends in the same repairs: flips, smoothing, more inner points.
//! Erratum S6: no triangle is turned.

mod flips;
mod mesh;
mod unfolding;

use crate::planar::{Fineness, Region, RegionError, orientation, triangulate};
use anamorph_core::glam::DVec2;
use mesh::Mesh;

/// Splitting ends where there are so many times as many triangles as at first.
const MOST_GROWTH: usize = 4;

/// How compatible triangulations are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompatibleOptions {
    /// How fine the first triangulation is.
    pub fineness: Fineness,
    /// How often what stays folded is split.
    pub rounds: usize,
}

impl Default for CompatibleOptions {
    /// The default fineness; at most 16 rounds.
    fn default() -> Self {
        Self {
            fineness: Fineness::default(),
            rounds: 16,
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
    /// How often triangles had to be split because they stayed folded.
    pub rounds: usize,
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
        "{folded} triangles stay folded near ({}, {}) of the source, ({}, {}) of the target; set an anchor there, or match the outlines \
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
    /// A system of equations without a solution.
    #[error("the triangles could not be laid into the target: {0}")]
    Solver(#[from] anamorph_solvers::SolverError),
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
    // The triangles of one laid into the other; if that cannot be done, the other way round.
    let there = one_way(source, target, inner, options);
    match there {
        Err(CompatibleError::Folded { .. }) => {
            let swapped: Vec<_> = inner.iter().map(|&(a, b)| (b, a)).collect();
            match one_way(target, source, &swapped, options) {
                Ok(pair) => Ok(CompatiblePair {
                    source: pair.target,
                    target: pair.source,
                    ..pair
                }),
                Err(_) => there,
            }
        }
        _ => there,
    }
}

fn one_way(
    source: &Region,
    target: &Region,
    inner: &[(DVec2, DVec2)],
    options: &CompatibleOptions,
) -> Result<CompatiblePair, CompatibleError> {
    let inner_source: Vec<DVec2> = inner.iter().map(|pair| pair.0).collect();
    let planar =
        triangulate(source, &inner_source, &options.fineness).map_err(CompatibleError::Source)?;
    let (on_rings, fixed) = (source.len(), source.len() + inner.len());
    let held: Vec<DVec2> = target
        .rings()
        .flatten()
        .copied()
        .chain(inner.iter().map(|pair| pair.1))
        .collect();
    let mut mesh = Mesh::new(planar, held, on_rings, fixed);
    mesh.split_chords();
    let counts: Vec<usize> = source.rings().map(Vec::len).collect();
    unfolding::harmonic(&mut mesh, &counts)?;
    let most = MOST_GROWTH * mesh.triangles.len() + 1000;
    let mut rounds = 0;
    loop {
        unfolding::unfold(&mut mesh)?;
        let folded = mesh.folded();
        let Some(&first) = folded.first() else {
            break;
        };
        if rounds == options.rounds || mesh.triangles.len() > most {
            let middle = |points: &[DVec2]| {
                let corners = mesh.triangles[first].map(|i| points[i as usize]);
                (corners[0] + corners[1] + corners[2]) / 3.0
            };
            return Err(CompatibleError::Folded {
                folded: folded.len(),
                source_place: middle(&mesh.source),
                target_place: middle(&mesh.target),
            });
        }
        mesh.split(&folded);
        rounds += 1;
    }
    flips::improve(&mut mesh);
    let mut rings = Vec::new();
    let mut first = 0;
    for ring in source.rings() {
        let count = ring.len() as u32;
        rings.push((first..first + count).collect());
        first += count;
    }
    Ok(CompatiblePair {
        source: mesh.source,
        target: mesh.target,
        triangles: mesh.triangles,
        rings,
        rounds,
    })
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
