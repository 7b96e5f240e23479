//! Two outlines of equally many points from a matching: point to point, with every original vertex of both.
//!
//! Where a vertex of one outline meets none of the other, the other gets a point on its edge; so both keep their forms
//! exactly. Vertices that nearly meet are joined instead, for short edges make bad triangles.
//!
//! *Source*: a decision of the project, after the consistent boundaries of T. Sederberg and E. Greenwood, *A Physically Based
//! Approach to 2-D Shape Blending*, SIGGRAPH 1992, §2.

use super::outline::Outline;
use super::{MatchError, Matching, RingPlace, Side};
use anamorph_core::glam::DVec2;

/// Least share of an edge between new points on it, where there is room.
const GAP: f64 = 1e-3;

/// Which points are put on edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thinning {
    /// Two vertices, one of each outline, become each other where each is within this share of the other's place, measured by
    /// the shorter edge at either. From 0, where only vertices that meet do, to ½.
    pub join: f64,
    /// Whether matched places that are no vertices get points too: more points, and the matching kept along edges.
    pub every_pair: bool,
}

impl Default for Thinning {
    fn default() -> Self {
        Self {
            join: 0.3,
            every_pair: false,
        }
    }
}

/// Two outlines of equally many points; see [`Matching::consistent`].
#[derive(Debug, Clone, PartialEq)]
pub struct Consistent {
    /// The source, with new points on its edges.
    pub source: Vec<DVec2>,
    /// The target, with new points on its edges; point `i` is what point `i` of the source becomes.
    pub target: Vec<DVec2>,
    /// Where each point is in the source and in the target as given.
    pub places: Vec<[RingPlace; 2]>,
}

/// A point of both outlines to be.
#[derive(Debug, Clone, Copy)]
struct Event {
    /// Where, in shares of the lengths, going on beyond 1.
    at: [f64; 2],
    vertex: [Option<usize>; 2],
    fixed: bool,
}

impl Matching {
    /// Both outlines with equally many points, point `i` of one matched to point `i` of the other.
    ///
    /// Every vertex of both is kept bit for bit, new points are on edges only, and no point is where its neighbour is; the
    /// list begins with the source's first vertex. Places of anchors always get points. `source` and `target` are
    /// the outlines that were matched; of others the result is consistent, but without meaning.
    ///
    /// # Errors
    /// [`MatchError`] where the outlines could not have been matched.
    pub fn consistent(
        &self,
        source: &[DVec2],
        target: &[DVec2],
        thinning: &Thinning,
    ) -> Result<Consistent, MatchError> {
        let outlines = [
            Outline::new(source, Side::Source)?,
            Outline::new(target, Side::Target)?,
        ];
        let mut events = self.events(&outlines, thinning.every_pair);
        join(&mut events, &outlines, thinning.join.clamp(0.0, 0.5));
        let first = events.iter().position(|e| e.vertex[0] == Some(0));
        events.rotate_left(first.unwrap_or(0));
        let [first, second] = [0, 1].map(|k| places(&events, &outlines[k], k));
        let on = |places: &[RingPlace], outline: &[DVec2]| {
            places.iter().filter_map(|p| p.on(outline)).collect()
        };
        Ok(Consistent {
            source: on(&first, source),
            target: on(&second, target),
            places: first.into_iter().zip(second).map(|(a, b)| [a, b]).collect(),
        })
    }

    /// Every vertex of both outlines and every pair that gets a point, in order.
    fn events(&self, outlines: &[Outline<'_>; 2], every_pair: bool) -> Vec<Event> {
        let ends: Vec<[RingPlace; 2]> = self.pairs.iter().map(|p| [p.source, p.target]).collect();
        let valid = |place: &RingPlace, k: usize| place.index < outlines[k].count();
        let ends: Vec<_> = ends
            .into_iter()
            .zip(&self.pairs)
            .filter(|(e, _)| valid(&e[0], 0) && valid(&e[1], 1))
            .collect();
        let mut events = Vec::new();
        for (number, (start, pair)) in ends.iter().enumerate() {
            let (stop, _) = &ends[(number + 1) % ends.len()];
            let mut at = [0.0; 2];
            let mut inner: [Vec<(f64, usize)>; 2] = Default::default();
            let mut spans = [0.0; 2];
            for k in 0..2 {
                let outline = &outlines[k];
                at[k] = outline.at(start[k]);
                let span = outline.at(stop[k]) - at[k];
                spans[k] = if span <= 0.0 { span + 1.0 } else { span };
                inner[k] = passed(outline, start[k], stop[k])
                    .map(|index| {
                        let ahead = outline.vertex(index) - at[k];
                        let ahead = if ahead < 0.0 { ahead + 1.0 } else { ahead };
                        ((ahead / spans[k]).clamp(0.0, 1.0), index)
                    })
                    .collect();
            }
            let vertex = [0, 1].map(|k| (start[k].fraction == 0.0).then_some(start[k].index));
            if every_pair || pair.anchor || vertex[0].is_some() || vertex[1].is_some() {
                events.push(Event {
                    at,
                    vertex,
                    fixed: pair.anchor || (vertex[0].is_some() && vertex[1].is_some()),
                });
            }
            let (mut i, mut j) = (0, 0);
            while i < inner[0].len() || j < inner[1].len() {
                let next = |k: usize, i: usize| inner[k].get(i).map_or(f64::INFINITY, |e| e.0);
                let (a, b) = (next(0, i), next(1, j));
                let share = a.min(b);
                let mut vertex = [None; 2];
                if a <= b {
                    vertex[0] = Some(inner[0][i].1);
                    i += 1;
                } else {
                    vertex[1] = Some(inner[1][j].1);
                    j += 1;
                }
                events.push(Event {
                    at: [0, 1].map(|k| at[k] + share * spans[k]),
                    vertex,
                    fixed: false,
                });
            }
        }
        events
    }
}

/// The vertices strictly between two places, from the one on to the other; from a place to itself all the way round.
fn passed(outline: &Outline<'_>, start: RingPlace, stop: RingPlace) -> impl Iterator<Item = usize> {
    let count = outline.count();
    let ahead = (stop.index + count - start.index) % count;
    let ahead = match ahead {
        0 if stop.fraction > start.fraction => 0,
        0 => count,
        ahead => ahead,
    };
    let met = usize::from(ahead > 0 && stop.fraction == 0.0);
    (1..=ahead - met).map(move |step| (start.index + step) % count)
}

/// Joins neighbouring vertices of the two outlines, the nearest first.
fn join(events: &mut Vec<Event>, outlines: &[Outline<'_>; 2], most: f64) {
    let count = events.len();
    let edge = |k: usize, index: usize| {
        let outline = &outlines[k];
        let n = outline.count();
        let length = |i: usize| {
            let end = if i + 1 == n {
                1.0
            } else {
                outline.vertex(i + 1)
            };
            end - outline.vertex(i)
        };
        length(index).min(length((index + n - 1) % n))
    };
    // Between an event and the next: how far they are apart, where one is a vertex of the source and one of the target.
    let gap = |a: &Event, b: &Event| {
        if a.fixed || b.fixed {
            return None;
        }
        let (source, target) = match (a.vertex, b.vertex) {
            ([Some(s), None], [None, Some(t)]) | ([None, Some(t)], [Some(s), None]) => (s, t),
            _ => return None,
        };
        let apart = |k: usize| {
            let apart = b.at[k] - a.at[k];
            apart - apart.floor()
        };
        let near = apart(0).max(apart(1)) <= super::NEAR;
        let share = (apart(0) / edge(0, source)).max(apart(1) / edge(1, target));
        (share <= most || near).then_some(share)
    };
    let mut gaps: Vec<(f64, usize)> = (0..count)
        .filter_map(|i| gap(&events[i], &events[(i + 1) % count]).map(|gap| (gap, i)))
        .collect();
    gaps.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut dropped = vec![false; count];
    let mut taken = vec![false; count];
    for (_, i) in gaps {
        let next = (i + 1) % count;
        if taken[i] || taken[next] {
            continue;
        }
        taken[i] = true;
        taken[next] = true;
        dropped[next] = true;
        let other = events[next];
        let event = &mut events[i];
        for k in 0..2 {
            if event.vertex[k].is_none() {
                event.vertex[k] = other.vertex[k];
                event.at[k] = other.at[k];
            }
        }
    }
    let mut keep = dropped.iter().map(|dropped| !dropped);
    events.retain(|_| keep.next().unwrap_or(true));
}

/// Where the events are in one outline: at its vertices, and between two of them on the edge, a little apart.
fn places(events: &[Event], outline: &Outline<'_>, k: usize) -> Vec<RingPlace> {
    let count = events.len();
    let mut places = vec![RingPlace::vertex(0); count];
    let Some(first) = events.iter().position(|e| e.vertex[k].is_some()) else {
        return places;
    };
    let mut start = 0;
    while start < count {
        let at = (first + start) % count;
        let index = events[at].vertex[k].unwrap_or(0);
        places[at] = RingPlace::vertex(index);
        let from = outline.vertex(index);
        let to = if index + 1 == outline.count() {
            1.0
        } else {
            outline.vertex(index + 1)
        };
        let rest = 1..count - start;
        let on_edge: Vec<usize> = rest
            .map(|step| (at + step) % count)
            .take_while(|&i| events[i].vertex[k].is_none())
            .collect();
        let mut fractions: Vec<f64> = on_edge
            .iter()
            .map(|&i| {
                let ahead = events[i].at[k] - from;
                // Rounding may put it a little before the vertex.
                let ahead = ahead - (ahead + 0.5 * (1.0 - (to - from))).floor();
                ahead / (to - from)
            })
            .collect();
        let gap = GAP.min(0.25 / (fractions.len() + 1) as f64);
        let mut least = 0.0;
        for fraction in &mut fractions {
            least = fraction.max(least + gap);
            *fraction = least;
        }
        let mut most = 1.0;
        for fraction in fractions.iter_mut().rev() {
            most = fraction.min(most - gap);
            *fraction = most;
        }
        for (&i, fraction) in on_edge.iter().zip(fractions) {
            places[i] = RingPlace { index, fraction };
        }
        start += 1 + on_edge.len();
    }
    places
}
