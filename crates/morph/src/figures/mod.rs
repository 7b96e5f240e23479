//! What is between two drawings: their parts paired, outlines matched, regions meshed alike, and the meshes morphed.
//!
//! Each pair of regions gets outlines of equally many points ([`crate::matching`]), one triangulation of both
//! ([`anamorph_meshing::compatible`]) and in-betweens ([`crate::strain`]). A hole without a partner becomes a speck where the other region
//! has room for it; a part without one comes from a speck, or shares its partner with others, as [`Pieces`] says. Specks are not
//! shown at the ends: there the outlines are those that were given, to within the simplification.
//!
//! *Source*: H.-B. Yan, S.-M. Hu and R. Martin, *Morphing based on strain field interpolation*, Computer Animation and Virtual Worlds 15, 2004;
//! errata S6 and S10. How parts share partners and how large specks are is decided here.

use crate::matching::{Anchor, Consistent, MatchError, Places, Thinning, Weights, match_placed};
use crate::shapes::{
    Part, PartPairing, Pieces, area, carry, centroid, clearance, pair_holes, pair_parts,
};
use crate::strain::{Element, FrameError, InBetween, Method, PairError, PrepareError, Settings};
use anamorph_core::glam::DVec2;
use anamorph_meshing::compatible::{
    CompatibleError, CompatibleOptions, CompatiblePair, compatible,
};
use anamorph_meshing::planar::Region;

/// Size of a speck beside the region that it is in.
const SPECK: f64 = 1e-2;
/// And at most so much of the way to the nearest border.
const ROOM: f64 = 0.25;

/// Places that are tried for a speck, and how often it is made smaller.
const TURNS: u32 = 64;
const SMALLER: usize = 8;

/// How drawings are morphed.
#[derive(Debug, Clone)]
pub struct FigureOptions {
    /// What counts in matching outlines.
    pub weights: Weights,
    /// Which points outlines get.
    pub thinning: Thinning,
    /// Points are dropped that leave both outlines where they are to within this share of the region's size: short edges make bad
    /// triangles, and slow and uneven in-betweens. 0 keeps all.
    pub simplification: f64,
    /// Edges longer than this share of an outline's length are cut, so that they can bend; infinite for none.
    pub longest_edge: f64,
    /// What becomes of parts without a partner.
    pub pieces: Pieces,
    /// Places of the outlines of the largest parts that must become each other.
    pub anchors: Vec<Anchor>,
    /// How meshes are made.
    pub meshes: CompatibleOptions,
    /// Choices of the in-betweens.
    pub settings: Settings,
}

impl Default for FigureOptions {
    /// Outlines keep upright where all else is nearly equal; edges are at most a fortieth of their outline.
    fn default() -> Self {
        Self {
            weights: Weights {
                upright: 0.02,
                ..Weights::default()
            },
            thinning: Thinning::default(),
            simplification: 1e-3,
            longest_edge: 1.0 / 40.0,
            pieces: Pieces::default(),
            anchors: Vec::new(),
            meshes: CompatibleOptions::default(),
            settings: Settings::default(),
        }
    }
}

/// Why there is nothing between two drawings. Parts are numbered as they were given, from 0.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// Outlines that cannot be matched.
    #[error("{parts}: {error}")]
    Match {
        /// Which parts.
        parts: String,
        /// Why.
        error: MatchError,
    },
    /// Regions that cannot be meshed alike.
    #[error("{parts}: {error}")]
    Mesh {
        /// Which parts.
        parts: String,
        /// Why.
        error: CompatibleError,
    },
    /// Meshes that cannot be morphed.
    #[error("{parts}: {error}")]
    Pair {
        /// Which parts.
        parts: String,
        /// Why.
        error: PairError,
    },
    /// In-betweens that cannot be prepared.
    #[error("{parts}: {error}")]
    Prepare {
        /// Which parts.
        parts: String,
        /// Why.
        error: PrepareError,
    },
}

/// A part of one drawing on its way to a part of the other.
pub struct Couple {
    /// The part of the source; none where it comes from a point.
    pub source: Option<usize>,
    /// The part of the target; none where it goes into a point.
    pub target: Option<usize>,
    /// One triangulation of both.
    pub mesh: CompatiblePair,
    /// Rings that are specks in the source, and in the target.
    specks: [Vec<usize>; 2],
    between: Box<dyn InBetween>,
    pair: crate::strain::Pair,
}

/// A part between.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Which couple it is of, counted from 0.
    pub couple: usize,
    /// Its outlines, the outer one first.
    pub rings: Vec<Vec<DVec2>>,
    /// Where all points of the mesh are.
    pub places: Vec<DVec2>,
}

/// Two drawings with what is between them, prepared.
pub struct Figure {
    couples: Vec<Couple>,
}

/// A place and a size for a speck near a place, clear of other specks and of the border.
fn apart(region: &Region, at: DVec2, size: f64, taken: &[(DVec2, f64)]) -> (DVec2, f64) {
    let clear = |place: DVec2, size: f64| {
        taken
            .iter()
            .all(|(other, theirs)| place.distance(*other) > 2.0 * (size + theirs))
    };
    let mut own = size;
    for _ in 0..SMALLER {
        for turn in 0..TURNS {
            // A spiral of seeds: each a golden angle on from the last.
            let radius = 2.0 * own * f64::from(turn).sqrt();
            let angle = f64::from(turn) * 2.399_963_229_728_653;
            let (sin, cos) = anamorph_core::math::sin_cos(angle);
            let place = at + radius * DVec2::new(cos, sin);
            let inside = turn == 0
                || (crate::shapes::contains(region, place)
                    && ROOM * clearance(region, place) >= own);
            if inside && clear(place, own) {
                return (place, own);
            }
        }
        own *= 0.3;
    }
    (at, own)
}

/// A small copy of a ring about a place.
fn speck(ring: &[DVec2], at: DVec2, size: f64) -> Vec<DVec2> {
    let middle = centroid(ring);
    let far = ring.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
    let scale = if far > 0.0 { size / far } else { 0.0 };
    ring.iter().map(|p| at + (*p - middle) * scale).collect()
}

/// Points of a pair of outlines that are kept when those are dropped that are near to the straight line between their neighbours in both
/// (Douglas and Peucker 1973, in four dimensions).
fn simplified(consistent: &Consistent, nearness: [f64; 2]) -> Consistent {
    let count = consistent.source.len();
    let rings = [&consistent.source, &consistent.target];
    // From the point that is farthest from the first, so that neither is dropped.
    let far = |i: usize| {
        let distance = |k: usize| rings[k][i].distance_squared(rings[k][0]) / nearness[k];
        distance(0).max(distance(1))
    };
    let farthest = (0..count).max_by(|a, b| far(*a).total_cmp(&far(*b)));
    let mut kept = vec![false; count + 1];
    let mut todo = Vec::new();
    if let Some(farthest) = farthest.filter(|far| *far > 0) {
        (kept[0], kept[farthest], kept[count]) = (true, true, true);
        todo.extend([(0, farthest), (farthest, count)]);
    }
    while let Some((first, last)) = todo.pop() {
        let off = |i: usize| {
            let distance = |k: usize| {
                let (a, b) = (rings[k][first], rings[k][last % count]);
                // At the same share of the way in both, as it will be when it moves.
                let way = b - a;
                let share = (rings[k][i] - a).dot(way) / way.length_squared();
                let share = if share.is_nan() {
                    0.0
                } else {
                    share.clamp(0.0, 1.0)
                };
                rings[k][i].distance(a + way * share) / nearness[k]
            };
            distance(0).max(distance(1))
        };
        let worst = (first + 1..last).max_by(|a, b| off(*a).total_cmp(&off(*b)));
        if let Some(worst) = worst.filter(|worst| off(*worst) > 1.0) {
            kept[worst] = true;
            todo.extend([(first, worst), (worst, last)]);
        }
    }
    let choose = |ring: &[DVec2]| -> Vec<DVec2> {
        let points = ring.iter().zip(&kept);
        points.filter(|(_, kept)| **kept).map(|(p, _)| *p).collect()
    };
    Consistent {
        source: choose(&consistent.source),
        target: choose(&consistent.target),
        places: Vec::new(),
    }
}

/// Cuts edges that are longer in either outline than a share of it.
fn cut(consistent: &mut Consistent, longest: f64) {
    let count = consistent.source.len();
    let length = |ring: &[DVec2]| -> f64 {
        (0..count)
            .map(|i| ring[i].distance(ring[(i + 1) % count]))
            .sum()
    };
    let lengths = [length(&consistent.source), length(&consistent.target)];
    let (mut source, mut target) = (Vec::new(), Vec::new());
    for i in 0..count {
        let j = (i + 1) % count;
        let ends = [&consistent.source, &consistent.target].map(|ring| [ring[i], ring[j]]);
        let share = |k: usize| ends[k][0].distance(ends[k][1]) / lengths[k];
        let pieces = (share(0).max(share(1)) / longest).ceil().clamp(1.0, 1e4) as usize;
        for piece in 0..pieces {
            let at = piece as f64 / pieces as f64;
            source.push(ends[0][0].lerp(ends[0][1], at));
            target.push(ends[1][0].lerp(ends[1][1], at));
        }
    }
    (consistent.source, consistent.target) = (source, target);
}

/// A region that is on its way to another.
struct Matched {
    regions: [Region; 2],
    specks: [Vec<usize>; 2],
}

/// Makes the rings of two regions those of as many points.
fn matched(
    source: &Region,
    target: &Region,
    anchors: &[Anchor],
    options: &FigureOptions,
) -> Result<Matched, MatchError> {
    let few = with_points(
        source,
        target,
        anchors,
        options,
        options.simplification > 0.0,
    )?;
    // Dropping points can make outlines touch; then all are kept.
    if few.regions.iter().all(|region| region.check().is_ok()) {
        return Ok(few);
    }
    with_points(source, target, anchors, options, false)
}

fn with_points(
    source: &Region,
    target: &Region,
    anchors: &[Anchor],
    options: &FigureOptions,
    simplify: bool,
) -> Result<Matched, MatchError> {
    let nearness = [source, target].map(|region| {
        let size = region.area().abs().sqrt();
        (options.simplification * size).max(f64::MIN_POSITIVE)
    });
    let rings = |a: &[DVec2], b: &[DVec2], places: Option<&Places>, anchors: &[Anchor]| {
        let found = match_placed(a, b, places, anchors, &options.weights)?;
        let mut consistent = found.consistent(a, b, &options.thinning)?;
        if simplify {
            let fewer = simplified(&consistent, nearness);
            if fewer.source.len() >= 3 {
                consistent = fewer;
            }
        }
        if options.longest_edge.is_finite() {
            cut(&mut consistent, options.longest_edge.max(1e-4));
        }
        Ok(consistent)
    };
    let outer = rings(&source.outer, &target.outer, None, anchors)?;
    let holes = pair_holes(source, target, &outer);
    let mut regions = [Region::default(), Region::default()];
    let mut specks = [Vec::new(), Vec::new()];
    let size = |region: &Region, at: DVec2| {
        let whole = SPECK * region.area().abs().sqrt();
        whole.min(ROOM * clearance(region, at))
    };
    for [a, b] in &holes.pairs {
        let (a, b) = (&source.holes[*a], &target.holes[*b]);
        let both = rings(a, b, Some(&places_of_holes(a, b, &outer)), &[])?;
        regions[0].holes.push(both.source);
        regions[1].holes.push(both.target);
    }
    // Specks that are there already.
    let mut taken = [Vec::new(), Vec::new()];
    // A hole of one side, and the side that has none like it.
    let closing = holes
        .closing
        .iter()
        .map(|opening| (opening, source, target, 1));
    let opening = holes
        .opening
        .iter()
        .map(|opening| (opening, target, source, 0));
    for (opening, from, into, side) in closing.chain(opening) {
        let ring = &from.holes[opening.hole];
        let (at, small) = apart(into, opening.at, size(into, opening.at), &taken[side]);
        taken[side].push((at, small));
        let small = speck(ring, at, small);
        let both = Consistent {
            source: ring.clone(),
            target: small,
            places: Vec::new(),
        };
        let own = nearness[1 - side];
        let fewer = simplified(&both, [own, f64::INFINITY]);
        let keep = simplify && fewer.source.len() >= 6;
        let Consistent {
            source: ring,
            target: small,
            ..
        } = if keep { fewer } else { both };
        specks[side].push(regions[side].holes.len() + 1);
        regions[side].holes.push(small);
        regions[1 - side].holes.push(ring);
    }
    regions[0].outer = outer.source;
    regions[1].outer = outer.target;
    Ok(Matched { regions, specks })
}

/// Where the points of two holes are in both outlines, so that holes are matched as the outlines around them are.
fn places_of_holes(source: &[DVec2], target: &[DVec2], outer: &Consistent) -> Places {
    let unit = |ring: &[DVec2], places: Vec<DVec2>| -> Vec<DVec2> {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for p in ring {
            (low, high) = (low.min(*p), high.max(*p));
        }
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        places.iter().map(|p| (*p - middle) / half).collect()
    };
    let there = source
        .iter()
        .map(|p| carry(&outer.source, &outer.target, *p));
    let back = target
        .iter()
        .map(|p| carry(&outer.target, &outer.source, *p));
    Places {
        source: [
            unit(&outer.source, source.to_vec()),
            unit(&outer.target, there.collect()),
        ],
        target: [
            unit(&outer.source, back.collect()),
            unit(&outer.target, target.to_vec()),
        ],
    }
}

/// A region small enough not to be seen, of the form of another.
fn small_copy(region: &Region, at: DVec2) -> Region {
    let scale = SPECK;
    let middle = centroid(&region.outer);
    let place = |p: &DVec2| at + (*p - middle) * scale;
    Region {
        outer: region.outer.iter().map(place).collect(),
        holes: region
            .holes
            .iter()
            .map(|hole| hole.iter().map(place).collect())
            .collect(),
    }
}

impl Figure {
    /// Prepares what is between two drawings, by a method of in-betweens.
    ///
    /// # Errors
    /// [`FigureError`].
    pub fn new(
        source: &[Part],
        target: &[Part],
        method: &Method,
        options: &FigureOptions,
    ) -> Result<Self, FigureError> {
        let mut ends: Vec<(Option<usize>, Option<usize>, DVec2)> = Vec::new();
        for pairing in pair_parts(source, target, options.pieces) {
            match pairing {
                PartPairing::One { source, target } => {
                    ends.push((Some(source), Some(target), DVec2::ZERO));
                }
                PartPairing::Split { source, targets } => {
                    ends.extend(
                        targets
                            .iter()
                            .map(|t| (Some(source), Some(*t), DVec2::ZERO)),
                    );
                }
                PartPairing::Merge { sources, target } => {
                    ends.extend(
                        sources
                            .iter()
                            .map(|s| (Some(*s), Some(target), DVec2::ZERO)),
                    );
                }
                PartPairing::Grow { target, from } => ends.push((None, Some(target), from)),
                PartPairing::Shrink { source, to } => ends.push((Some(source), None, to)),
            }
        }
        // Anchors are of the largest couple.
        let size = |(s, t, _): &(Option<usize>, Option<usize>, DVec2)| {
            let of = |parts: &[Part], i: &Option<usize>| {
                i.map_or(0.0, |i| area(&parts[i].region.outer).abs())
            };
            of(source, s).min(of(target, t))
        };
        let largest = ends
            .iter()
            .enumerate()
            .max_by(|(i, a), (j, b)| size(a).total_cmp(&size(b)).then(j.cmp(i)))
            .map(|(i, _)| i);
        let mut couples = Vec::new();
        for (number, end) in ends.iter().enumerate() {
            let anchors: &[Anchor] = if Some(number) == largest {
                &options.anchors
            } else {
                &[]
            };
            couples.push(Couple::new(source, target, *end, anchors, method, options)?);
        }
        Ok(Self { couples })
    }

    /// Prepares what is between meshes that are there already, each with its part in the source and in the target.
    ///
    /// # Errors
    /// [`FigureError::Pair`] and [`FigureError::Prepare`].
    pub fn of_meshes(
        meshes: impl IntoIterator<Item = ([Option<usize>; 2], CompatiblePair)>,
        method: &Method,
        settings: &Settings,
    ) -> Result<Self, FigureError> {
        let mut couples = Vec::new();
        for (ends, mesh) in meshes {
            let parts = format!("part {} of the pair", couples.len());
            let couple = Couple::of_mesh(ends, mesh, Default::default(), method, settings);
            couples.push(couple.map_err(|error| match error {
                OfMesh::Pair(error) => FigureError::Pair { parts, error },
                OfMesh::Prepare(error) => FigureError::Prepare { parts, error },
            })?);
        }
        Ok(Self { couples })
    }

    /// Parts on their way.
    pub fn couples(&self) -> &[Couple] {
        &self.couples
    }

    /// What is between at `t`, from 0 (the source) to 1 (the target), in the order of the couples. Parts that are points then are left out.
    ///
    /// # Errors
    /// [`FrameError`].
    pub fn at(&self, t: f64) -> Result<Vec<Piece>, FrameError> {
        let mut pieces = Vec::new();
        for (number, couple) in self.couples.iter().enumerate() {
            if let Some((rings, places)) = couple.at(t)? {
                pieces.push(Piece {
                    couple: number,
                    rings,
                    places,
                });
            }
        }
        Ok(pieces)
    }
}

/// Why a mesh cannot be morphed.
enum OfMesh {
    Pair(PairError),
    Prepare(PrepareError),
}

/// Rings and the places of a mesh.
type Drawn = (Vec<Vec<DVec2>>, Vec<DVec2>);

impl Couple {
    fn new(
        source: &[Part],
        target: &[Part],
        (from, to, place): (Option<usize>, Option<usize>, DVec2),
        anchors: &[Anchor],
        method: &Method,
        options: &FigureOptions,
    ) -> Result<Self, FigureError> {
        let parts = match (from, to) {
            (Some(a), Some(b)) => format!("part {a} of the source and part {b} of the target"),
            (Some(a), None) => format!("part {a} of the source"),
            (None, Some(b)) => format!("part {b} of the target"),
            (None, None) => String::new(),
        };
        let region = |parts: &[Part], i: Option<usize>| {
            i.and_then(|i| parts.get(i)).map(|part| part.region.clone())
        };
        let regions = match (region(source, from), region(target, to)) {
            (Some(a), Some(b)) => [a, b],
            (Some(a), None) => {
                let small = small_copy(&a, place);
                [a, small]
            }
            (None, Some(b)) => {
                let small = small_copy(&b, place);
                [small, b]
            }
            (None, None) => [Region::default(), Region::default()],
        };
        // What only grows keeps its form: nothing needs to be matched.
        let found = if from.is_some() && to.is_some() {
            matched(&regions[0], &regions[1], anchors, options).map_err(|error| {
                FigureError::Match {
                    parts: parts.clone(),
                    error,
                }
            })?
        } else {
            Matched {
                regions,
                specks: [Vec::new(), Vec::new()],
            }
        };
        let [a, b] = &found.regions;
        let mesh = compatible(a, b, &[], &options.meshes).map_err(|error| FigureError::Mesh {
            parts: parts.clone(),
            error,
        })?;
        Self::of_mesh([from, to], mesh, found.specks, method, &options.settings).map_err(|error| {
            match error {
                OfMesh::Pair(error) => FigureError::Pair { parts, error },
                OfMesh::Prepare(error) => FigureError::Prepare { parts, error },
            }
        })
    }

    fn of_mesh(
        [source, target]: [Option<usize>; 2],
        mesh: CompatiblePair,
        specks: [Vec<usize>; 2],
        method: &Method,
        settings: &Settings,
    ) -> Result<Self, OfMesh> {
        let elements = mesh
            .triangles
            .iter()
            .filter_map(|corners| Element::of(&corners.map(|i| i as usize)))
            .collect();
        let pair = crate::strain::Pair::new(mesh.source.clone(), mesh.target.clone(), elements)
            .map_err(OfMesh::Pair)?;
        let between = method.prepare(&pair, settings).map_err(OfMesh::Prepare)?;
        Ok(Self {
            source,
            target,
            mesh,
            specks,
            between,
            pair,
        })
    }

    /// The mesh as the in-betweens see it.
    pub fn pair(&self) -> &crate::strain::Pair {
        &self.pair
    }

    /// Its in-betweens.
    pub fn between(&self) -> &dyn InBetween {
        &*self.between
    }

    /// Where the points of its mesh are at `t`.
    ///
    /// # Errors
    /// [`FrameError`].
    pub fn places(&self, t: f64) -> Result<Vec<DVec2>, FrameError> {
        // The ends are met exactly.
        if t == 0.0 {
            Ok(self.mesh.source.clone())
        } else if t == 1.0 {
            Ok(self.mesh.target.clone())
        } else {
            Ok(self.between.at(t)?.positions)
        }
    }

    /// Rings and places at `t`; nothing where it is a point.
    fn at(&self, t: f64) -> Result<Option<Drawn>, FrameError> {
        let is_point = (t == 0.0 && self.source.is_none()) || (t == 1.0 && self.target.is_none());
        if is_point {
            return Ok(None);
        }
        let places = self.places(t)?;
        let hidden: &[usize] = if t == 0.0 {
            &self.specks[0]
        } else if t == 1.0 {
            &self.specks[1]
        } else {
            &[]
        };
        let rings = self.mesh.rings.iter().enumerate();
        let rings = rings
            .filter(|(number, _)| !hidden.contains(number))
            .map(|(_, ring)| ring.iter().map(|&i| places[i as usize]).collect())
            .collect();
        Ok(Some((rings, places)))
    }

    /// Rings that are specks in the source and in the target, by number, the outer ring being 0.
    pub fn specks(&self) -> &[Vec<usize>; 2] {
        &self.specks
    }
}
