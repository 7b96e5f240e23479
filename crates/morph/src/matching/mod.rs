//! Which place of one closed outline becomes which place of another.
//!
//! [`match_outlines`] walks around both outlines at once and looks for the walk that takes the least work of stretching and of bending.
//! [`Anchor`]s are met exactly. What comes out, a [`Matching`], is a list of pairs of places that goes on strictly in both
//! outlines; [`Matching::consistent`] makes of it two outlines of equally many points, point `i` to point `i`, that keep every
//! original vertex.
//!
//! - Swapping the outlines swaps the roles and changes nothing else.
//! - Moving, turning and scaling either outline changes nothing but for rounding; [`Weights::upright`] and [`Weights::placed`] ask for the turn
//!   that changes directions least, which decides between the corners of a square.
//! - Both outlines go around in the same orientation. Neither may repeat a point or be without area; what crosses itself is matched
//!   all the same.
//!
//! *Source*: T. Sederberg and E. Greenwood, *A Physically Based Approach to 2-D Shape Blending*, SIGGRAPH 1992: work of
//! stretching with `e_s = 2` and `c_s = ½`, which is symmetric, `k (a − b)² / (a + b)` here with lengths in shares of the whole.
//! Their work of bending compares angles at vertices, and so depends on how finely an outline is drawn: here it is the squared
//! difference of turning over several distances, per length; angles between neighbouring samples count besides, which for a smooth
//! outline vanish with their distance and for a corner do not. Both outlines are sampled evenly, and at their vertices,
//! so that a place on an edge can meet a vertex. Decisions, as are the numbers.

mod consistent;
mod lattice;
mod outline;

pub use consistent::{Consistent, Thinning};

use anamorph_core::glam::DVec2;
use lattice::{Lattice, Track, Way};
use outline::{FEATURES, Outline, Sample};

/// Fewest samples of an outline.
const FEWEST: usize = 256;
/// Most samples of an outline; time and memory grow with their square.
const MOST: usize = 896;

/// Two places of an outline nearer than this, in shares of its length, are one.
pub(crate) const NEAR: f64 = 1e-9;

/// One of the two outlines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The first.
    Source,
    /// The second.
    Target,
}

impl core::fmt::Display for Side {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Source => "source",
            Self::Target => "target",
        })
    }
}

/// A place of an outline: so far along the edge from point `index` to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingPlace {
    /// Number of the point, from 0.
    pub index: usize,
    /// Share of the edge, in `[0, 1)`; 0 is the point itself.
    pub fraction: f64,
}

impl RingPlace {
    /// The place of a point.
    pub fn vertex(index: usize) -> Self {
        Self {
            index,
            fraction: 0.0,
        }
    }

    /// Where it is on an outline; none where the outline has no such point.
    pub fn on(&self, outline: &[DVec2]) -> Option<DVec2> {
        let from = *outline.get(self.index)?;
        if self.fraction == 0.0 {
            return Some(from);
        }
        let to = outline[(self.index + 1) % outline.len()];
        Some(from + (to - from) * self.fraction)
    }
}

/// How an anchor names a place of an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnchorPlace {
    /// A point, by its number from 0.
    Point(usize),
    /// A share of the outline's length, from point 0 on, in `[0, 1]`.
    Fraction(f64),
}

impl core::fmt::Display for AnchorPlace {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Point(index) => write!(f, "point {index}"),
            Self::Fraction(fraction) => write!(f, "fraction {fraction}"),
        }
    }
}

/// A place of the source that must become a place of the target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor {
    /// In the source.
    pub source: AnchorPlace,
    /// In the target.
    pub target: AnchorPlace,
}

/// How much each kind of work counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    /// For each share of the length that is stretched or squeezed.
    pub stretching: f64,
    /// For turning that differs by half a turn, per share of the length.
    pub bending: f64,
    /// For a corner of half a turn that meets none.
    pub corners: f64,
    /// For directions that differ by a sixth of a turn, per share of the length. Not 0, and turning an outline matters;
    /// about 0.01 only decides where all else is equal.
    pub upright: f64,
    /// For places that differ by half the box around the outlines, per share of the length. Not 0, and turning an outline matters.
    pub placed: f64,
}

impl Default for Weights {
    fn default() -> Self {
        Self {
            stretching: 0.05,
            bending: 1.0,
            corners: 0.02,
            upright: 0.0,
            placed: 0.0,
        }
    }
}

/// Why outlines cannot be matched.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MatchError {
    /// Fewer than three points.
    #[error("the {side} outline has {count} points; give at least 3")]
    TooFew {
        /// Which outline.
        side: Side,
        /// How many it has.
        count: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error(
        "point {point} of the {side} outline is not finite; give coordinates that are neither infinite nor NaN"
    )]
    NotFinite {
        /// Which outline.
        side: Side,
        /// Number of the point, from 0.
        point: usize,
    },
    /// A point where the one before is.
    #[error("point {point} of the {side} outline is where the one before it is; drop one of them")]
    Repeated {
        /// Which outline.
        side: Side,
        /// Number of the point, from 0.
        point: usize,
    },
    /// The outline encloses nothing.
    #[error("the {side} outline encloses no area; give one whose points are not all on one line")]
    NoArea {
        /// Which outline.
        side: Side,
    },
    /// One outline goes around the other way.
    #[error(
        "the source and the target outline go around in opposite orientation; reverse one of them"
    )]
    Opposite,
    /// A weight that cannot be.
    #[error(
        "the weight {name} is {value}; give a number that is finite and at least 0, and for stretching above 0"
    )]
    Weight {
        /// Its name.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// An anchor names no place.
    #[error(
        "anchor {anchor}: {place} is no place of the {side} outline; give a point below {count}, or a fraction from 0 to 1"
    )]
    NoPlace {
        /// Number of the anchor, from 0.
        anchor: usize,
        /// What it names.
        place: AnchorPlace,
        /// Which outline.
        side: Side,
        /// How many points that has.
        count: usize,
    },
    /// Two anchors at one place.
    #[error(
        "anchors {first} and {second} are at the same place of the {side} outline; remove one of them"
    )]
    RepeatedAnchor {
        /// Number of the one, from 0.
        first: usize,
        /// Number of the other.
        second: usize,
        /// In which outline.
        side: Side,
    },
    /// Anchors that follow each other differently in the two outlines.
    #[error(
        "anchors {first} and {second} cross: around the target they come in another order than around the source; move or remove one of them"
    )]
    CrossingAnchors {
        /// Number of the one, from 0.
        first: usize,
        /// Number of the other.
        second: usize,
    },
}

/// Two places that become each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// In the source.
    pub source: RingPlace,
    /// In the target.
    pub target: RingPlace,
    /// Whether an [`Anchor`] asked for it.
    pub anchor: bool,
}

/// Which places of two outlines become each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Matching {
    pairs: Vec<Pair>,
    cost: f64,
}

impl Matching {
    /// Places that become each other, by where they are in the source. They follow each other strictly around the source
    /// and around the target; between neighbouring ones places go on in proportion to the length.
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// How much work it takes, per length: 0 for outlines of the same form; about [`Weights::stretching`] or more
    /// where little fits. For comparing choices of outlines, with the same weights.
    pub fn cost(&self) -> f64 {
        self.cost
    }
}

/// Matches two closed outlines.
///
/// The last point of an outline is joined to its first. Up to 896 places of each outline are looked at, the sharpest
/// vertices among them; a matching takes no longer than that allows.
///
/// # Errors
/// [`MatchError`].
pub fn match_outlines(
    source: &[DVec2],
    target: &[DVec2],
    anchors: &[Anchor],
    weights: &Weights,
) -> Result<Matching, MatchError> {
    match_placed(source, target, None, anchors, weights)
}

/// Where the points of both outlines are, in units of about half the size of what they belong to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Places {
    /// The points of the source outline, in the source and in the target.
    pub source: [Vec<DVec2>; 2],
    /// Those of the target outline, in the source and in the target.
    pub target: [Vec<DVec2>; 2],
}

/// Matches two closed outlines, such as those of holes, that have places in something larger; [`Weights::placed`] weighs these, not those in their
/// own boxes. Lists of other lengths than the outlines' count as none.
///
/// # Errors
/// [`MatchError`].
pub fn match_placed(
    source: &[DVec2],
    target: &[DVec2],
    places: Option<&Places>,
    anchors: &[Anchor],
    weights: &Weights,
) -> Result<Matching, MatchError> {
    let least = [
        ("stretching", weights.stretching, f64::MIN_POSITIVE),
        ("bending", weights.bending, 0.0),
        ("corners", weights.corners, 0.0),
        ("upright", weights.upright, 0.0),
        ("placed", weights.placed, 0.0),
    ];
    for (name, value, least) in least {
        if !(value >= least && value.is_finite()) {
            return Err(MatchError::Weight { name, value });
        }
    }
    let mut outlines = [
        Outline::new(source, Side::Source)?,
        Outline::new(target, Side::Target)?,
    ];
    if let Some(places) = places {
        let [source, target] = outlines;
        outlines = [source.placed(&places.source), target.placed(&places.target)];
    }
    if outlines[0].positive() != outlines[1].positive() {
        return Err(MatchError::Opposite);
    }
    let stops = stops(&outlines, anchors)?;
    let [source, target] = &outlines;
    let count = (2 * source.count().max(target.count())).clamp(FEWEST, MOST);
    let mut found = Found::default();
    if stops.is_empty() {
        let from = [source.sharpest(), target.sharpest()];
        found.piece(
            &outlines,
            from,
            from.map(|at| at + 1.0),
            count,
            true,
            weights,
        );
    } else {
        for (k, stop) in stops.iter().enumerate() {
            let mut next = stops[(k + 1) % stops.len()].at;
            for (next, from) in next.iter_mut().zip(stop.at) {
                if *next <= from {
                    *next += 1.0;
                }
            }
            found.pairs.push(Pair {
                source: stop.places[0],
                target: stop.places[1],
                anchor: true,
            });
            found.piece(&outlines, stop.at, next, count, false, weights);
        }
    }
    let mut pairs = found.pairs;
    let key = |pair: &Pair| (pair.source.index, pair.source.fraction);
    let first = (0..pairs.len()).min_by(|&a, &b| {
        let (a, b) = (key(&pairs[a]), key(&pairs[b]));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    pairs.rotate_left(first.unwrap_or(0));
    Ok(Matching {
        pairs,
        cost: found.cost,
    })
}

/// An anchor, located.
#[derive(Debug, Clone, Copy)]
struct Stop {
    anchor: usize,
    places: [RingPlace; 2],
    at: [f64; 2],
}

/// Anchors in their order around the source, checked.
fn stops(outlines: &[Outline<'_>; 2], anchors: &[Anchor]) -> Result<Vec<Stop>, MatchError> {
    let sides = [Side::Source, Side::Target];
    let mut stops = Vec::with_capacity(anchors.len());
    for (anchor, given) in anchors.iter().enumerate() {
        let mut stop = Stop {
            anchor,
            places: [RingPlace::vertex(0); 2],
            at: [0.0; 2],
        };
        for (k, place) in [given.source, given.target].into_iter().enumerate() {
            let outline = &outlines[k];
            stop.places[k] = match place {
                AnchorPlace::Point(index) if index < outline.count() => RingPlace::vertex(index),
                AnchorPlace::Fraction(share) if (0.0..=1.0).contains(&share) => {
                    outline.place(share)
                }
                _ => {
                    return Err(MatchError::NoPlace {
                        anchor,
                        place,
                        side: sides[k],
                        count: outline.count(),
                    });
                }
            };
            stop.at[k] = outline.at(stop.places[k]);
        }
        stops.push(stop);
    }
    for (k, side) in sides.into_iter().enumerate() {
        let mut order: Vec<&Stop> = stops.iter().collect();
        order.sort_by(|a, b| a.at[k].total_cmp(&b.at[k]));
        let count = order.len();
        for (i, stop) in order.iter().enumerate().skip(usize::from(count < 2)) {
            let next = order[(i + 1) % count];
            let gap = next.at[k] - stop.at[k] + if i + 1 == count { 1.0 } else { 0.0 };
            if gap <= NEAR {
                let (first, second) = (stop.anchor.min(next.anchor), stop.anchor.max(next.anchor));
                return Err(MatchError::RepeatedAnchor {
                    first,
                    second,
                    side,
                });
            }
        }
    }
    stops.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
    // Around the target from the first one on, each must be farther than the one before.
    let around = |stop: &Stop| {
        let ahead = stop.at[1] - stops[0].at[1];
        if ahead < 0.0 { ahead + 1.0 } else { ahead }
    };
    for pair in stops.windows(2) {
        if around(&pair[1]) < around(&pair[0]) {
            return Err(MatchError::CrossingAnchors {
                first: pair[0].anchor.min(pair[1].anchor),
                second: pair[0].anchor.max(pair[1].anchor),
            });
        }
    }
    Ok(stops)
}

/// Pairs found so far, in order.
#[derive(Debug, Default)]
struct Found {
    pairs: Vec<Pair>,
    cost: f64,
}

impl Found {
    /// Matches a piece of each outline, or the whole of both; the ends of a piece are not among the pairs.
    fn piece(
        &mut self,
        outlines: &[Outline<'_>; 2],
        from: [f64; 2],
        to: [f64; 2],
        count: usize,
        cyclic: bool,
        weights: &Weights,
    ) {
        let samples: [Vec<Sample>; 2] =
            core::array::from_fn(|k| outlines[k].samples(from[k], to[k], count));
        let tracks: [Track; 2] = core::array::from_fn(|k| Track {
            gaps: samples[k].windows(2).map(|p| p[1].at - p[0].at).collect(),
            features: samples[k]
                .iter()
                .map(|sample| outlines[k].features(sample.at, weights))
                .collect(),
            corners: samples[k]
                .iter()
                .map(|sample| outlines[k].corner(sample.at, 1.0 / count as f64, weights))
                .collect(),
        });
        // Rows and columns by what they hold, so that swapped outlines make the same lattice.
        let swapped = order(&tracks[0], &tracks[1]).is_gt();
        let (row, column) = if swapped { (1, 0) } else { (0, 1) };
        let lattice = Lattice::new(&tracks[row], &tracks[column], weights.stretching, cyclic);
        let way = if cyclic {
            let coarse = [row, column].map(|k| tracks[k].coarse());
            let coarse = Lattice::new(&coarse[0], &coarse[1], weights.stretching, true);
            let n = tracks[column].gaps.len();
            lattice.around(coarse.around(0).start() * lattice::COARSE % n)
        } else {
            lattice.open()
        };
        self.cost += way.cost;
        for (i, j) in strictly(&way, &lattice, &samples[row], &samples[column], cyclic) {
            let place = |k: usize, number: usize| {
                let sample = samples[k][number];
                match sample.vertex {
                    Some(index) => RingPlace::vertex(index),
                    None => outlines[k].place(sample.at),
                }
            };
            let (first, second) = (place(row, i), place(column, j));
            let (source, target) = if swapped {
                (second, first)
            } else {
                (first, second)
            };
            self.pairs.push(Pair {
                source,
                target,
                anchor: false,
            });
        }
        // Columns begin where the way does; the source's order is what counts.
        if swapped && cyclic {
            let start = self.pairs.windows(2).position(|pair| {
                let at = |k: usize| outlines[0].at(pair[k].source);
                at(1) < at(0)
            });
            self.pairs.rotate_left(start.map_or(0, |k| k + 1));
        }
    }
}

/// Which of two tracks comes first.
fn order(first: &Track, second: &Track) -> core::cmp::Ordering {
    let mut order = first.gaps.len().cmp(&second.gaps.len());
    for (a, b) in first.features.iter().zip(&second.features) {
        for k in 0..FEATURES {
            order = order.then(a[k].total_cmp(&b[k]));
        }
        if order.is_ne() {
            return order;
        }
    }
    for (a, b) in first.gaps.iter().zip(&second.gaps) {
        order = order.then(a.total_cmp(b));
    }
    order
}

/// Of a way's nodes as many as use no sample twice; those where sharp turns meet first, then those that fit best.
fn strictly(
    way: &Way,
    lattice: &Lattice,
    rows: &[Sample],
    columns: &[Sample],
    cyclic: bool,
) -> Vec<(usize, usize)> {
    let (m, n) = (rows.len() - 1, columns.len() - 1);
    let inner = |&(i, j): &(usize, usize)| cyclic || (i > 0 && i < m && j > 0 && j < n);
    let mut nodes: Vec<(usize, usize)> = way.nodes().filter(inner).collect();
    if cyclic {
        // The last one is the first again.
        nodes.pop();
        for (i, j) in &mut nodes {
            *i %= m;
            *j %= n;
        }
    }
    let rank = |&(i, j): &(usize, usize)| {
        let (a, b) = (&rows[i], &columns[j]);
        let vertices = usize::from(a.vertex.is_some()) + usize::from(b.vertex.is_some());
        let meeting = if a.turn * b.turn > 0.0 {
            a.turn.abs().min(b.turn.abs())
        } else {
            0.0
        };
        // Turning by less than this is noise.
        let sharp = if vertices == 2 && meeting > 0.2 {
            meeting
        } else {
            0.0
        };
        (sharp, vertices, lattice.bending(i, j))
    };
    let ranks: Vec<_> = nodes.iter().map(rank).collect();
    let mut order: Vec<usize> = (0..nodes.len()).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (&ranks[a], &ranks[b]);
        let sharper = b.0.total_cmp(&a.0);
        sharper.then(b.1.cmp(&a.1)).then(a.2.total_cmp(&b.2))
    });
    let (mut row_used, mut column_used) = (vec![false; m + 1], vec![false; n + 1]);
    let mut kept = vec![false; nodes.len()];
    for k in order {
        let (i, j) = nodes[k];
        if !(row_used[i] || column_used[j]) {
            row_used[i] = true;
            column_used[j] = true;
            kept[k] = true;
        }
    }
    let kept = nodes.into_iter().zip(kept);
    kept.filter_map(|(node, keep)| keep.then_some(node))
        .collect()
}
