//! Which part of a drawing becomes which part of another, and which hole of a region which hole.
//!
//! Parts with the same id belong together. The others are assigned so that the sum of their differences is least: in place
//! within the drawing, in size, and in colour. With more than [`MOST`] on a side each takes in turn, the largest part of the source
//! first, what suits it best of what is left. Of equal choices the one with lower numbers wins.
//!
//! *Source*: H. Kuhn, *The Hungarian Method for the Assignment Problem*, Naval Research Logistics Quarterly 2, 1955, in the form
//! with potentials and shortest augmenting paths of R. Jonker and A. Volgenant, 1987. What is compared, and how much it counts, are
//! decisions.

use super::inside::nearest_inside;
use super::{area, centroid, mean_value_weights};
use crate::matching::Consistent;
use anamorph_core::glam::DVec2;
use anamorph_core::math;
use anamorph_meshing::planar::Region;
use std::collections::HashMap;

/// Up to so many on each side the assignment is the best there is.
const MOST: usize = 300;

/// A part of a drawing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Part {
    /// Its name; none where it has none.
    pub id: Option<String>,
    /// Its fill in Oklab (lightness, a, b); none where it has none.
    pub colour: Option<[f64; 3]>,
    /// What it covers.
    pub region: Region,
}

/// What becomes of parts that have no partner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Pieces {
    /// Further parts of the target split off what their nearest neighbour comes from, and further parts of the source merge into
    /// what theirs becomes.
    #[default]
    SplitAndMerge,
    /// They split off; further parts of the source shrink to points.
    Split,
    /// They merge; further parts of the target grow from points.
    Merge,
    /// All grow from points, or shrink to points.
    Grow,
}

/// What becomes what. Parts are numbered as they were given, from 0.
#[derive(Debug, Clone, PartialEq)]
pub enum PartPairing {
    /// One part becomes one part.
    One {
        /// Of the source.
        source: usize,
        /// Of the target.
        target: usize,
    },
    /// One part becomes several; the first of them is its partner.
    Split {
        /// Of the source.
        source: usize,
        /// Of the target.
        targets: Vec<usize>,
    },
    /// Several parts become one; the first of them is its partner.
    Merge {
        /// Of the source.
        sources: Vec<usize>,
        /// Of the target.
        target: usize,
    },
    /// A part of the target comes from a point.
    Grow {
        /// Of the target.
        target: usize,
        /// The point, in the source.
        from: DVec2,
    },
    /// A part of the source goes into a point.
    Shrink {
        /// Of the source.
        source: usize,
        /// The point, in the target.
        to: DVec2,
    },
}

/// What is compared of a part: its place and its size, in those of its drawing, and its colour.
#[derive(Debug, Clone, Copy)]
struct Look {
    low: DVec2,
    high: DVec2,
    centre: DVec2,
    size: f64,
    colour: Option<[f64; 3]>,
}

/// The corner of a drawing and its larger side.
#[derive(Debug, Clone, Copy)]
struct Frame {
    low: DVec2,
    size: DVec2,
}

impl Frame {
    fn new(parts: &[Part]) -> Self {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for point in parts.iter().flat_map(|part| &part.region.outer) {
            low = low.min(*point);
            high = high.max(*point);
        }
        let size = high - low;
        Self {
            low,
            size: size.max(DVec2::splat(size.max_element() * 1e-9)),
        }
    }
    fn into(self, place: DVec2) -> DVec2 {
        (place - self.low) / self.size
    }
    fn out_of(self, place: DVec2) -> DVec2 {
        self.low + place * self.size
    }
    fn look(self, part: &Part) -> Look {
        let outer = &part.region.outer;
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for point in outer {
            low = low.min(self.into(*point));
            high = high.max(self.into(*point));
        }
        Look {
            low,
            high,
            centre: self.into(centroid(outer)),
            size: area(outer).abs() / (self.size.x * self.size.y),
            colour: part.colour,
        }
    }
}

/// How far the colours of two parts are apart.
fn hue(a: &Look, b: &Look) -> f64 {
    match (a.colour, b.colour) {
        (Some(a), Some(b)) => {
            let square: f64 = (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum();
            square.sqrt()
        }
        (None, None) => 0.0,
        _ => 0.5,
    }
}

/// How much two parts differ.
fn difference(a: &Look, b: &Look) -> f64 {
    let common = (a.high.min(b.high) - a.low.max(b.low)).max(DVec2::ZERO);
    let whole = |look: &Look| (look.high - look.low).element_product();
    let common = common.element_product();
    let overlap = common / (whole(a) + whole(b) - common).max(f64::MIN_POSITIVE);
    let colour = hue(a, b);
    let ratio = ratio(a.size, b.size);
    let sum = a.centre.distance(b.centre) + 0.5 * (1.0 - overlap) + 4.0 * colour + 0.15 * ratio;
    if sum.is_finite() { sum } else { 1e6 }
}

/// The logarithm of how often the smaller goes into the larger, at most 10.
fn ratio(a: f64, b: f64) -> f64 {
    let (least, most) = (a.min(b), a.max(b));
    if most <= 0.0 {
        0.0
    } else {
        math::ln(most / least.max(most * 4e-5)).min(10.0)
    }
}

/// Pairs the parts of two drawings.
///
/// Every part is in exactly one pairing, as itself or among others; they come by the source's number, then growing ones by
/// the target's. Of ids that are not unique only the first counts.
pub fn pair_parts(source: &[Part], target: &[Part], pieces: Pieces) -> Vec<PartPairing> {
    let frames = [Frame::new(source), Frame::new(target)];
    let looks: [Vec<Look>; 2] = [
        source.iter().map(|p| frames[0].look(p)).collect(),
        target.iter().map(|p| frames[1].look(p)).collect(),
    ];
    let mut partner: [Vec<Option<usize>>; 2] = [vec![None; source.len()], vec![None; target.len()]];
    let mut ids: HashMap<&str, usize> = HashMap::new();
    for (j, part) in target.iter().enumerate() {
        if let Some(id) = &part.id {
            ids.entry(id).or_insert(j);
        }
    }
    for (i, part) in source.iter().enumerate() {
        let found = part.id.as_ref().and_then(|id| ids.remove(id.as_str()));
        if let Some(j) = found {
            partner[0][i] = Some(j);
            partner[1][j] = Some(i);
        }
    }
    let rest = |k: usize| -> Vec<usize> {
        let free = partner[k].iter().enumerate();
        free.filter_map(|(i, p)| p.is_none().then_some(i)).collect()
    };
    let (mut rows, columns) = (rest(0), rest(1));
    // Stable: equal ones stay by number.
    rows.sort_by(|&a, &b| looks[0][b].size.total_cmp(&looks[0][a].size));
    let cost = |i: usize, j: usize| difference(&looks[0][rows[i]], &looks[1][columns[j]]);
    for (i, j) in assign(rows.len(), columns.len(), cost) {
        partner[0][rows[i]] = Some(columns[j]);
        partner[1][columns[j]] = Some(rows[i]);
    }

    // Those without: with the partner of the nearest of the same drawing that has one.
    let nearest = |part: usize, k: usize| {
        let look = &looks[k][part];
        let far = |other: &Look| {
            let gap = (look.low.max(other.low) - look.high.min(other.high)).max(DVec2::ZERO);
            gap.length() + hue(look, other) + 1e-3 * difference(look, other)
        };
        let with = looks[k].iter().zip(&partner[k]).enumerate();
        with.filter_map(|(i, (other, partner))| partner.map(|partner| (far(other), i, partner)))
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
            .map(|(_, _, partner)| partner)
    };
    let splits = matches!(pieces, Pieces::SplitAndMerge | Pieces::Split);
    let merges = matches!(pieces, Pieces::SplitAndMerge | Pieces::Merge);
    let mut further: [Vec<Vec<usize>>; 2] = [
        vec![Vec::new(); source.len()],
        vec![Vec::new(); target.len()],
    ];
    let mut alone: [Vec<usize>; 2] = [Vec::new(), Vec::new()];
    for (j, found) in partner[1].iter().enumerate() {
        if found.is_none() {
            match nearest(j, 1) {
                Some(i) if splits => further[0][i].push(j),
                _ => alone[1].push(j),
            }
        }
    }
    for (i, found) in partner[0].iter().enumerate() {
        if found.is_none() {
            match nearest(i, 0) {
                Some(j) if merges => further[1][j].push(i),
                _ => alone[0].push(i),
            }
        }
    }
    let mut pairings = Vec::new();
    for (source, found) in partner[0].iter().enumerate() {
        let Some(target) = *found else { continue };
        let (more, less) = (&further[0][source], &further[1][target]);
        // What is left over is left over on one side only, unless ids say otherwise; then it splits, and the rest goes alone.
        if !more.is_empty() {
            let targets = core::iter::once(target)
                .chain(more.iter().copied())
                .collect();
            pairings.push(PartPairing::Split { source, targets });
            alone[0].extend(less);
        } else if !less.is_empty() {
            let sources = core::iter::once(source)
                .chain(less.iter().copied())
                .collect();
            pairings.push(PartPairing::Merge { sources, target });
        } else {
            pairings.push(PartPairing::One { source, target });
        }
    }
    alone[0].sort_unstable();
    for &source in &alone[0] {
        pairings.push(PartPairing::Shrink {
            source,
            to: related(&looks[0][source], frames[0], frames[1]),
        });
    }
    for &target in &alone[1] {
        pairings.push(PartPairing::Grow {
            target,
            from: related(&looks[1][target], frames[1], frames[0]),
        });
    }
    pairings
}

/// The place of a part's centre in the other drawing; its own where that has no parts to relate it to.
fn related(look: &Look, own: Frame, other: Frame) -> DVec2 {
    let place = other.out_of(look.centre);
    if place.is_finite() {
        place
    } else {
        own.out_of(look.centre)
    }
}

/// Where an unmatched hole opens or closes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opening {
    /// Number of the hole.
    pub hole: usize,
    /// The place in the region that has no such hole.
    pub at: DVec2,
}

/// Which hole becomes which.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HolePairing {
    /// Holes of the source and of the target that become each other.
    pub pairs: Vec<[usize; 2]>,
    /// Holes of the source that close, each in a point of the target.
    pub closing: Vec<Opening>,
    /// Holes of the target that open, each from a point of the source.
    pub opening: Vec<Opening>,
}

/// Pairs the holes of two regions whose outer outlines are matched.
///
/// Centres are carried from one region to the other by mean value coordinates of the matched outlines; holes whose centres
/// come near each other and whose sizes agree belong together, as many as the region with fewer has. Where an unmatched hole opens
/// is where its centre is carried to, or the nearest place with room about it.
pub fn pair_holes(source: &Region, target: &Region, outlines: &Consistent) -> HolePairing {
    let sizes = [source, target].map(|region| {
        let holes = region.holes.iter().map(|hole| area(hole).abs());
        holes.collect::<Vec<f64>>()
    });
    let whole = [source, target].map(|region| area(&region.outer).abs());
    let centres = [source, target].map(|region| {
        let holes = region.holes.iter().map(|hole| centroid(hole));
        holes.collect::<Vec<DVec2>>()
    });
    let carried: Vec<DVec2> = centres[0]
        .iter()
        .map(|c| carry(&outlines.source, &outlines.target, *c))
        .collect();
    let back: Vec<DVec2> = centres[1]
        .iter()
        .map(|c| carry(&outlines.target, &outlines.source, *c))
        .collect();
    let cost = |i: usize, j: usize| {
        // Both ways, so that swapping the regions swaps the roles.
        let there = carried[i].distance(centres[1][j]) / whole[1].sqrt();
        let here = back[j].distance(centres[0][i]) / whole[0].sqrt();
        let sum = there + here + 0.15 * ratio(sizes[0][i] / whole[0], sizes[1][j] / whole[1]);
        if sum.is_finite() { sum } else { 1e6 }
    };
    let mut pairing = HolePairing::default();
    let (m, n) = (centres[0].len(), centres[1].len());
    let mut matched = [vec![false; m], vec![false; n]];
    for (i, j) in assign(m, n, cost) {
        matched[0][i] = true;
        matched[1][j] = true;
        pairing.pairs.push([i, j]);
    }
    let openings = |matched: &[bool], places: &[DVec2], region: &Region| {
        let free = matched.iter().enumerate().filter(|(_, matched)| !**matched);
        let open = |hole: usize| Opening {
            hole,
            at: nearest_inside(region, places[hole]),
        };
        free.map(|(hole, _)| open(hole)).collect()
    };
    pairing.closing = openings(&matched[0], &carried, target);
    pairing.opening = openings(&matched[1], &back, source);
    pairing
}

/// Where a place in one ring comes to be in another, point to point, by mean value coordinates (Floater 2003).
pub(crate) fn carry(from: &[DVec2], to: &[DVec2], place: DVec2) -> DVec2 {
    let weights = mean_value_weights(from, place);
    weights.map_or(place, |weights| {
        to.iter().zip(weights).map(|(p, weight)| *p * weight).sum()
    })
}

/// Pairs of rows and columns with the least sum of costs, as many as there can be, by row.
fn assign(m: usize, n: usize, cost: impl Fn(usize, usize) -> f64) -> Vec<(usize, usize)> {
    if m == 0 || n == 0 {
        return Vec::new();
    }
    let mut pairs = if m.max(n) > MOST {
        greedy(m, n, cost)
    } else if m <= n {
        hungarian(m, n, cost)
    } else {
        let turned = hungarian(n, m, |i, j| cost(j, i));
        turned.into_iter().map(|(j, i)| (i, j)).collect()
    };
    pairs.sort_unstable();
    pairs
}

/// Each row in turn takes the column that is left and costs least.
fn greedy(m: usize, n: usize, cost: impl Fn(usize, usize) -> f64) -> Vec<(usize, usize)> {
    let mut free = vec![true; n];
    let mut pairs = Vec::new();
    for i in 0..m {
        let left = (0..n).filter(|&j| free[j]).map(|j| (cost(i, j), j));
        if let Some((_, j)) = left.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))) {
            free[j] = false;
            pairs.push((i, j));
        }
    }
    pairs
}

/// The best assignment of `m` rows to `n` columns, `m` at most `n`.
fn hungarian(m: usize, n: usize, cost: impl Fn(usize, usize) -> f64) -> Vec<(usize, usize)> {
    // Row and column 0 are none.
    let (mut row_potential, mut column_potential) = (vec![0.0; m + 1], vec![0.0; n + 1]);
    let mut row_of = vec![0; n + 1];
    for row in 1..=m {
        row_of[0] = row;
        let mut least = vec![f64::INFINITY; n + 1];
        let mut came = vec![0; n + 1];
        let mut done = vec![false; n + 1];
        let mut column = 0;
        while row_of[column] != 0 {
            done[column] = true;
            let at = row_of[column];
            let (mut step, mut next) = (f64::INFINITY, 0);
            for j in 1..=n {
                if done[j] {
                    continue;
                }
                let reduced = cost(at - 1, j - 1) - row_potential[at] - column_potential[j];
                if reduced < least[j] {
                    least[j] = reduced;
                    came[j] = column;
                }
                if least[j] < step {
                    step = least[j];
                    next = j;
                }
            }
            for j in 0..=n {
                if done[j] {
                    row_potential[row_of[j]] += step;
                    column_potential[j] -= step;
                } else {
                    least[j] -= step;
                }
            }
            column = next;
        }
        while column != 0 {
            row_of[column] = row_of[came[column]];
            column = came[column];
        }
    }
    let columns = row_of.iter().enumerate().skip(1);
    columns
        .filter(|(_, row)| **row != 0)
        .map(|(j, &row)| (row - 1, j - 1))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assignments_are_the_best_of_all() {
        let mut seed = 3_u64;
        for (m, n) in [(1, 1), (3, 3), (2, 5), (5, 2), (5, 5)] {
            for _ in 0..20 {
                let costs: Vec<f64> = (0..m * n)
                    .map(|_| {
                        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(99);
                        ((seed >> 40) % 50) as f64
                    })
                    .collect();
                let cost = |i: usize, j: usize| costs[i * n + j];
                let found: f64 = assign(m, n, cost)
                    .into_iter()
                    .map(|(i, j)| cost(i, j))
                    .sum();
                // All, one row after the other.
                fn least(
                    i: usize,
                    m: usize,
                    left: &mut Vec<bool>,
                    skip: usize,
                    cost: &dyn Fn(usize, usize) -> f64,
                ) -> f64 {
                    if i == m {
                        return 0.0;
                    }
                    let mut best = f64::INFINITY;
                    if skip > 0 {
                        best = least(i + 1, m, left, skip - 1, cost);
                    }
                    for j in 0..left.len() {
                        if left[j] {
                            left[j] = false;
                            best = best.min(cost(i, j) + least(i + 1, m, left, skip, cost));
                            left[j] = true;
                        }
                    }
                    best
                }
                let skip = m.saturating_sub(n);
                assert_eq!(found, least(0, m, &mut vec![true; n], skip, &cost));
            }
        }
    }
}
