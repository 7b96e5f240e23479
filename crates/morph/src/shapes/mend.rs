//! Shapes as drawn, and the regions that they become.
//!
//! Repeated points and spikes go first, ring by ring. Then what is filled is worked out on the grid, with outlines and holes at once.
//! Last, where rings of one region still touch in a point, corners that point into the void are cut off there, by a ten-thousandth of
//! their edges, so that every border is a simple ring.
//!
//! *Source*: decisions of the project; [`super`] names the grid's.

use super::{area, crossings, inside};
use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::math;
use anamorph_meshing::planar::Region;
use core::f64::consts::TAU;
use i_overlay::core::fill_rule::FillRule as OverlayFill;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;
use std::collections::{BTreeMap, HashMap};

/// Half the drawing is at most two to this power steps of the grid.
pub const GRID_BITS: u32 = 40;

/// Points nearer than this share of the drawing's size are one, and narrower spikes have no width.
const NEAR: f64 = 1e-10;

/// How much of its edges a corner loses that touches another.
const CUT: f64 = 1e-4;

/// Beyond this coordinates are refused: areas and their moments overflow.
const FAR: f64 = 1e100;

/// Which places are inside, by how often the rings go around them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum FillRule {
    /// All that they go around, each way counted against the other.
    #[default]
    NonZero,
    /// What they go around an odd number of times.
    EvenOdd,
}

/// A closed outline as drawn; the last point is joined to the first, which may be repeated.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ring {
    /// Its points.
    pub points: Vec<DVec2>,
    /// Whether it is said to be a hole, as polygons in files do; what lies in such a ring is never filled. The holes of drawings that
    /// only a fill rule makes are plain rings.
    pub hole: bool,
}

/// Rings and what of them is filled.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shape {
    /// The rings, in any order and orientation.
    pub rings: Vec<Ring>,
    /// What is inside.
    pub fill: FillRule,
}

/// Something about a shape that was mended. Rings and points are numbered as they were given, from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mended {
    /// A point where the one before is, dropped.
    Repeated {
        /// The ring.
        ring: usize,
        /// The point.
        point: usize,
    },
    /// A point at which the ring turns straight back, dropped.
    Spike {
        /// The ring.
        ring: usize,
        /// The point.
        point: usize,
    },
    /// A ring that encloses nothing, dropped.
    NoArea {
        /// The ring.
        ring: usize,
    },
    /// A ring that now goes around the other way.
    Reversed {
        /// The ring.
        ring: usize,
    },
    /// Edges that crossed, or overlapped, and now meet in a point.
    Crossing {
        /// Where.
        place: DVec2,
    },
    /// Two rings that became one, for they overlapped.
    Joined {
        /// The one.
        first: usize,
        /// The other.
        second: usize,
    },
    /// A ring that is no border of what is filled, dropped.
    Covered {
        /// The ring.
        ring: usize,
    },
    /// A hole outside every outline, dropped.
    HoleOutside {
        /// The ring.
        ring: usize,
    },
    /// A piece narrower than can be told, dropped.
    Sliver {
        /// Where.
        place: DVec2,
    },
    /// Borders that touched in a point, now a little apart.
    Touching {
        /// Where.
        place: DVec2,
    },
}

impl core::fmt::Display for Mended {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Repeated { ring, point } => {
                write!(
                    f,
                    "ring {ring}: point {point} repeats the one before; dropped"
                )
            }
            Self::Spike { ring, point } => {
                write!(
                    f,
                    "ring {ring}: a spike without width at point {point}; dropped"
                )
            }
            Self::NoArea { ring } => write!(f, "ring {ring} encloses no area; dropped"),
            Self::Reversed { ring } => write!(f, "ring {ring} goes around the wrong way; reversed"),
            Self::Crossing { place } => {
                write!(
                    f,
                    "edges cross at ({}, {}); they now meet there",
                    place.x, place.y
                )
            }
            Self::Joined { first, second } => {
                write!(
                    f,
                    "rings {first} and {second} overlap; joined to one border"
                )
            }
            Self::Covered { ring } => {
                write!(f, "ring {ring} borders nothing that is filled; dropped")
            }
            Self::HoleOutside { ring } => {
                write!(
                    f,
                    "the hole of ring {ring} is outside every outline; dropped"
                )
            }
            Self::Sliver { place } => {
                write!(
                    f,
                    "a piece at ({}, {}) has no width; dropped",
                    place.x, place.y
                )
            }
            Self::Touching { place } => {
                write!(
                    f,
                    "borders touch at ({}, {}); moved apart",
                    place.x, place.y
                )
            }
        }
    }
}

/// Why a shape has no regions.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// There are no rings.
    #[error("the shape has no rings; give at least one outline")]
    Empty,
    /// A coordinate is infinite, not a number, or too large.
    #[error(
        "ring {ring}, point {point}: the coordinates ({}, {}) are not finite numbers below 1e100; mend them", place.x, place.y
    )]
    NotFinite {
        /// The ring.
        ring: usize,
        /// The point.
        point: usize,
        /// What it is.
        place: DVec2,
    },
    /// Nothing is filled.
    #[error(
        "none of the {rings} rings encloses any area that is filled; give an outline that does"
    )]
    NoArea {
        /// How many rings there are.
        rings: usize,
    },
    /// Borders are nearer to each other than numbers can tell.
    #[error(
        "borders at ({}, {}) are too near to each other to be told apart; simplify the shape there", place.x, place.y
    )]
    TooNear {
        /// Where.
        place: DVec2,
    },
}

/// A point of a ring that is kept.
type Kept = (usize, DVec2);

impl Shape {
    /// The regions that are filled, by their first points, and all that was mended on the way.
    ///
    /// Rings of the regions are simple and touch neither each other nor themselves, by exact predicates; outer ones have positive
    /// area and holes negative. Two regions may touch in a point. Points as given keep their bits, and points on
    /// straight edges are kept. The time is that of sorting all edges, and of all crossings.
    ///
    /// # Errors
    /// [`ShapeError`].
    pub fn regions(&self) -> Result<(Vec<Region>, Vec<Mended>), ShapeError> {
        if self.rings.is_empty() {
            return Err(ShapeError::Empty);
        }
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for (ring, Ring { points, .. }) in self.rings.iter().enumerate() {
            for (point, &place) in points.iter().enumerate() {
                // Not a number is not below anything.
                if !(place.x.abs() < FAR && place.y.abs() < FAR) {
                    return Err(ShapeError::NotFinite { ring, point, place });
                }
                low = low.min(place);
                high = high.max(place);
            }
        }
        let nothing = ShapeError::NoArea {
            rings: self.rings.len(),
        };
        let Some(grid) = Grid::new(low, high) else {
            return Err(nothing);
        };
        let mut report = Vec::new();
        let mut rings: Vec<Vec<Kept>> = Vec::with_capacity(self.rings.len());
        for (number, ring) in self.rings.iter().enumerate() {
            let mut kept: Vec<Kept> = ring.points.iter().copied().enumerate().collect();
            tidy(&mut kept, grid.near, number, &mut report);
            if kept.len() < 3 {
                report.push(Mended::NoArea { ring: number });
                kept.clear();
            }
            rings.push(kept);
        }
        let mut filled = Filled::new(self, &rings, &grid);
        let regions = filled.regions(&grid, &mut report)?;
        filled.tell(self, &rings, &mut report);
        if regions.is_empty() {
            return Err(nothing);
        }
        Ok((regions, report))
    }
}

/// Drops repeated points and spikes of a ring.
fn tidy(kept: &mut Vec<Kept>, near: f64, ring: usize, report: &mut Vec<Mended>) {
    let (mut i, mut looked) = (0, 0);
    while kept.len() >= 2 && looked < kept.len() {
        let count = kept.len();
        let before = kept[(i + count - 1) % count].1;
        let (point, at) = kept[i];
        let behind = kept[(i + 1) % count].1;
        let (there, back) = (before - at, behind - at);
        let repeated = there.length() <= near;
        let spike = !repeated && {
            // How far the shorter of both edges is from the line of the longer.
            let longer = there.length().max(back.length());
            there.dot(back) > 0.0 && there.perp_dot(back).abs() <= near * longer
        };
        if !(repeated || spike) {
            i = (i + 1) % count;
            looked += 1;
            continue;
        }
        report.push(if repeated {
            Mended::Repeated { ring, point }
        } else {
            Mended::Spike { ring, point }
        });
        kept.remove(i);
        let count = kept.len().max(1);
        // Its neighbours are others now.
        i = (i + count - 1) % count;
        looked = looked.saturating_sub(2);
    }
}

/// Whole numbers for places.
#[derive(Debug, Clone, Copy)]
struct Grid {
    centre: DVec2,
    step: f64,
    near: f64,
}

impl Grid {
    fn new(low: DVec2, high: DVec2) -> Option<Self> {
        let half = (high - low).max_element() * 0.5;
        let far = low.abs().max(high.abs()).max_element();
        if half <= f64::MIN_POSITIVE * 1e20 {
            return None;
        }
        let steps = |bits: u32| (1_u64 << bits) as f64;
        // A power of two, so that the grid's places are exact.
        let mut step = 1.0_f64;
        while half / step > steps(GRID_BITS) || far / step > steps(51) {
            step *= 2.0;
        }
        while half / step <= steps(GRID_BITS - 1) && far / step <= steps(50) {
            step *= 0.5;
        }
        let round = |x: f64| (x / step).round() * step;
        let middle = low + (high - low) * 0.5;
        Some(Self {
            centre: dvec2(round(middle.x), round(middle.y)),
            step,
            near: half * 2.0 * NEAR,
        })
    }

    fn number(&self, place: DVec2) -> IntPoint<i64> {
        let at = (place - self.centre) / self.step;
        // Below two to the 41st.
        #[allow(clippy::cast_possible_truncation)]
        IntPoint::new(at.x.round() as i64, at.y.round() as i64)
    }

    fn place(&self, number: IntPoint<i64>) -> DVec2 {
        self.centre + dvec2(number.x as f64, number.y as f64) * self.step
    }
}

/// What is filled, on the grid.
struct Filled {
    shapes: Vec<Vec<Vec<IntPoint<i64>>>>,
    /// Which point as given is there: its ring, and it.
    given: HashMap<(i64, i64), (usize, DVec2)>,
    /// Rings that have a point in a region; whether they go around the way they did, as long as all is theirs.
    used: BTreeMap<usize, Option<bool>>,
    joined: BTreeMap<(usize, usize), ()>,
}

impl Filled {
    fn new(shape: &Shape, rings: &[Vec<Kept>], grid: &Grid) -> Self {
        let mut given = HashMap::new();
        let options = IntOverlayOptions {
            ogc: true,
            ..IntOverlayOptions::keep_all_points()
        };
        let capacity = rings.iter().map(Vec::len).sum();
        let mut overlay = Overlay::<i64>::new_custom(capacity, options, Default::default());
        for (number, kept) in rings.iter().enumerate() {
            let path: Vec<IntPoint<i64>> = kept.iter().map(|(_, p)| grid.number(*p)).collect();
            for (at, (_, place)) in path.iter().zip(kept) {
                given.entry((at.x, at.y)).or_insert((number, *place));
            }
            let role = if shape.rings[number].hole {
                ShapeType::Clip
            } else {
                ShapeType::Subject
            };
            overlay.add_contour(&path, role);
        }
        let fill = match shape.fill {
            FillRule::NonZero => OverlayFill::NonZero,
            FillRule::EvenOdd => OverlayFill::EvenOdd,
        };
        Self {
            shapes: overlay.overlay(OverlayRule::Difference, fill),
            given,
            used: BTreeMap::new(),
            joined: BTreeMap::new(),
        }
    }

    fn regions(
        &mut self,
        grid: &Grid,
        report: &mut Vec<Mended>,
    ) -> Result<Vec<Region>, ShapeError> {
        let mut regions = Vec::new();
        let mut crossed = BTreeMap::new();
        for shape in core::mem::take(&mut self.shapes) {
            let mut exact: Vec<Vec<DVec2>> = Vec::with_capacity(shape.len());
            let mut snapped: Vec<Vec<DVec2>> = Vec::with_capacity(shape.len());
            for (k, path) in shape.iter().enumerate() {
                let places: Vec<DVec2> = path.iter().map(|at| grid.place(*at)).collect();
                let around: f64 = (0..places.len())
                    .map(|i| places[i].distance(places[(i + 1) % places.len()]))
                    .sum();
                if path.len() < 3 || area(&places).abs() <= 0.5 * grid.near * around {
                    if let Some(&place) = places.first() {
                        report.push(Mended::Sliver { place });
                    }
                    if k == 0 {
                        break;
                    }
                    continue;
                }
                let mut own = Vec::with_capacity(path.len());
                let mut owner: Option<usize> = None;
                for (at, place) in path.iter().zip(&places) {
                    let Some(&(ring, given)) = self.given.get(&(at.x, at.y)) else {
                        crossed.entry((at.x, at.y)).or_insert(*place);
                        own.push(*place);
                        continue;
                    };
                    own.push(given);
                    self.used.entry(ring).or_insert(None);
                    match owner {
                        Some(other) if other != ring => {
                            self.joined.insert((ring.min(other), ring.max(other)), ());
                        }
                        _ => owner = Some(ring),
                    }
                }
                if let Some(ring) = owner {
                    self.used.insert(ring, Some(area(&own) > 0.0));
                }
                exact.push(own);
                snapped.push(places);
            }
            if exact.is_empty() {
                continue;
            }
            let mut touching = Vec::new();
            let mut rings = part(exact, grid.step, &mut touching);
            if first_crossing(&rings).is_some() {
                touching.clear();
                rings = part(snapped, grid.step, &mut touching);
                if let Some(place) = first_crossing(&rings) {
                    return Err(ShapeError::TooNear { place });
                }
            }
            report.extend(touching);
            let mut rings = rings.into_iter();
            if let Some(outer) = rings.next() {
                regions.push(Region {
                    outer,
                    holes: rings.collect(),
                });
            }
        }
        report.extend(
            crossed
                .into_values()
                .map(|place| Mended::Crossing { place }),
        );
        Ok(regions)
    }

    /// What became of whole rings.
    fn tell(&self, shape: &Shape, rings: &[Vec<Kept>], report: &mut Vec<Mended>) {
        for &(first, second) in self.joined.keys() {
            report.push(Mended::Joined { first, second });
        }
        for (ring, kept) in rings.iter().enumerate() {
            if kept.is_empty() {
                continue;
            }
            let points = || kept.iter().map(|(_, p)| *p).collect::<Vec<DVec2>>();
            match self.used.get(&ring) {
                Some(Some(positive)) if (area(&points()) > 0.0) != *positive => {
                    report.push(Mended::Reversed { ring });
                }
                Some(_) => {}
                None if shape.rings[ring].hole && !self.reaches(shape, rings, &points()) => {
                    report.push(Mended::HoleOutside { ring });
                }
                None => report.push(Mended::Covered { ring }),
            }
        }
    }

    /// Whether a hole has anything in common with an outline's inside.
    fn reaches(&self, shape: &Shape, rings: &[Vec<Kept>], hole: &[DVec2]) -> bool {
        let outlines = rings
            .iter()
            .zip(&shape.rings)
            .filter(|(kept, ring)| !ring.hole && !kept.is_empty());
        let mut outlines = outlines.map(|(kept, _)| kept.iter().map(|(_, p)| *p).collect());
        outlines.any(|outline: Vec<DVec2>| {
            let holds = |region: &[DVec2], place: DVec2| {
                let region = Region {
                    outer: region.to_vec(),
                    holes: Vec::new(),
                };
                inside::contains(&region, place)
            };
            holds(&outline, hole[0]) || holds(hole, outline[0])
        })
    }
}

/// Where rings of a region cross or touch, if they do.
fn first_crossing(rings: &[Vec<DVec2>]) -> Option<DVec2> {
    let all: Vec<&[DVec2]> = rings.iter().map(Vec::as_slice).collect();
    let found = crossings(&all, 1);
    found
        .first()
        .map(|crossing| rings[crossing.first.0][crossing.first.1])
}

/// Cuts corners off where borders touch: of each place all but the one with most void in it.
fn part(mut rings: Vec<Vec<DVec2>>, step: f64, report: &mut Vec<Mended>) -> Vec<Vec<DVec2>> {
    let mut passes: HashMap<[u64; 2], Vec<(usize, usize)>> = HashMap::new();
    let mut order = Vec::new();
    for (r, ring) in rings.iter().enumerate() {
        for (i, place) in ring.iter().enumerate() {
            // Adding 0 makes the two zeros one.
            let key = [(place.x + 0.0).to_bits(), (place.y + 0.0).to_bits()];
            let passes = passes.entry(key).or_default();
            passes.push((r, i));
            if passes.len() == 2 {
                order.push(key);
            }
        }
    }
    let mut cut: Vec<Vec<bool>> = rings.iter().map(|ring| vec![false; ring.len()]).collect();
    for key in order {
        let Some(passes) = passes.get(&key) else {
            continue;
        };
        let void = |&(r, i): &(usize, usize)| {
            let ring = &rings[r];
            let count = ring.len();
            let (from, to) = (
                ring[(i + count - 1) % count] - ring[i],
                ring[(i + 1) % count] - ring[i],
            );
            let angle = math::atan2(from.perp_dot(to), from.dot(to));
            if angle <= 0.0 { angle + TAU } else { angle }
        };
        let most = (0..passes.len()).fold(0, |most, k| {
            if void(&passes[k]) > void(&passes[most]) {
                k
            } else {
                most
            }
        });
        for (k, &(r, i)) in passes.iter().enumerate() {
            if k == 0 {
                report.push(Mended::Touching { place: rings[r][i] });
            }
            cut[r][i] = k != most;
        }
    }
    for (ring, cut) in rings.iter_mut().zip(cut) {
        if !cut.contains(&true) {
            continue;
        }
        let count = ring.len();
        let mut new = Vec::with_capacity(count + 1);
        for (i, &at) in ring.iter().enumerate() {
            if cut[i] {
                for next in [ring[(i + count - 1) % count], ring[(i + 1) % count]] {
                    // Some steps of the grid at least.
                    let share = CUT.max(16.0 * step / next.distance(at)).min(0.25);
                    new.push(at + (next - at) * share);
                }
            } else {
                new.push(at);
            }
        }
        *ring = new;
    }
    rings
}
