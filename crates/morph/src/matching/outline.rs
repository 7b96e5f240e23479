//! One outline as its matching sees it: arc length, directions, turning over several distances, and samples.
//!
//! Everything is measured in shares of the outline's whole length, so that size does not count, and by the direction of its
//! edges relative to each other, so that place and turn do not either. Where weights ask for them, directions themselves count, and places
//! within the box around the outline.
//!
//! *Source*: E. Arkin, L. Chew, D. Huttenlocher, K. Kedem and J. Mitchell, *An Efficiently Computable Metric for Comparing
//! Polygonal Shapes*, IEEE PAMI 13(3), 1991 (the direction of an outline as a step function of its arc length). Turning over a
//! distance `r` is a decision: the mean direction over the `r` ahead less the mean over the `r` behind. Unlike angles at
//! vertices it hardly knows how finely an outline is drawn.

use super::{MatchError, RingPlace, Side, Weights};
use anamorph_core::glam::DVec2;
use anamorph_core::math;
use core::f64::consts::{PI, TAU};

/// Over which distances turning is compared, in shares of the length.
const DISTANCES: [f64; 4] = [0.01, 0.03, 0.08, 0.2];

/// How much each of them counts.
const SHARES: [f64; 4] = [0.2, 0.35, 0.3, 0.15];

/// How many numbers describe a place: turning over [`DISTANCES`], the direction itself, and the place in two boxes.
pub(super) const FEATURES: usize = DISTANCES.len() + 6;

/// An outline with area relative to its length squared below this is none.
const LEAST_AREA: f64 = 1e-12;

/// A closed outline, measured.
#[derive(Debug, Clone)]
pub(super) struct Outline<'a> {
    points: &'a [DVec2],
    /// The same from −1 to 1 in the box around them, or where they are in the source and in the target.
    places: [Vec<DVec2>; 2],
    /// Where each point is, from 0; behind the last one 1.
    at: Vec<f64>,
    /// The direction of each edge, in radians, followed from the first without jumps.
    directions: Vec<f64>,
    /// The integral of the direction up to each point; one more than there are points.
    integral: Vec<f64>,
    /// How far all of it turns: a whole turn, unless it crosses itself.
    turning: f64,
    /// Twice the signed area over the length squared.
    area: f64,
}

/// A place that the matching looks at.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Where it is; may be beyond 1 where it follows a start within the outline.
    pub(super) at: f64,
    /// The vertex that it is.
    pub(super) vertex: Option<usize>,
    /// How far the outline turns about it.
    pub(super) turn: f64,
}

impl<'a> Outline<'a> {
    pub(super) fn new(points: &'a [DVec2], side: Side) -> Result<Self, MatchError> {
        let count = points.len();
        if count < 3 {
            return Err(MatchError::TooFew { side, count });
        }
        if let Some(point) = points.iter().position(|p| !p.is_finite()) {
            return Err(MatchError::NotFinite { side, point });
        }
        // About a point of its own, in units of its own size: nothing overflows, and little is lost far from the origin.
        let scale = points.iter().fold(0.0_f64, |most, p| {
            let half = *p * 0.5 - points[0] * 0.5;
            most.max(half.x.abs()).max(half.y.abs())
        });
        if scale == 0.0 {
            return Err(MatchError::NoArea { side });
        }
        // By division twice: the reciprocal of a very small scale is infinite.
        let local: Vec<DVec2> = points
            .iter()
            .map(|p| (*p * 0.5 - points[0] * 0.5) / scale)
            .collect();
        let edge = |i: usize| local[(i + 1) % count] - local[i];
        let (mut low, mut high) = (local[0], local[0]);
        for p in &local {
            (low, high) = (low.min(*p), high.max(*p));
        }
        let half = (0.5 * (high - low)).max(DVec2::splat(f64::MIN_POSITIVE));
        let boxed = local.iter().map(|p| (*p - 0.5 * (low + high)) / half);
        let boxed: Vec<DVec2> = boxed.collect();
        let mut at = Vec::with_capacity(count + 1);
        let mut length = 0.0;
        for i in 0..count {
            at.push(length);
            let step = edge(i).length();
            if !(step > 0.0 && length + step > length) {
                return Err(MatchError::Repeated {
                    side,
                    point: (i + 1) % count,
                });
            }
            length += step;
        }
        for place in &mut at {
            *place /= length;
        }
        at.push(1.0);
        let twice: f64 = (0..count)
            .map(|i| local[i].perp_dot(local[(i + 1) % count]))
            .sum();
        let area = twice / (length * length);
        if area.abs() <= LEAST_AREA {
            return Err(MatchError::NoArea { side });
        }

        let turn = |i: usize| {
            let (from, to) = (edge((i + count - 1) % count), edge(i));
            math::atan2(from.perp_dot(to), from.dot(to))
        };
        let mut directions = Vec::with_capacity(count);
        let first = edge(0);
        let mut direction = math::atan2(first.y, first.x);
        for i in 0..count {
            if i > 0 {
                direction += turn(i);
            }
            directions.push(direction);
        }
        let turning = direction + turn(0) - directions[0];
        let mut integral = Vec::with_capacity(count + 1);
        let mut sum = 0.0;
        for i in 0..count {
            integral.push(sum);
            // Relative to the first direction, so that a turned outline has the same numbers but for rounding.
            sum += (directions[i] - directions[0]) * (at[i + 1] - at[i]);
        }
        integral.push(sum);
        Ok(Self {
            points,
            places: [boxed.clone(), boxed],
            at,
            directions,
            integral,
            turning,
            area,
        })
    }

    /// With other places than those in its own box.
    pub(super) fn placed(mut self, places: &[Vec<DVec2>; 2]) -> Self {
        let fit = |list: &Vec<DVec2>| list.len() == self.points.len();
        if places.iter().all(fit) {
            self.places = places.clone();
        }
        self
    }

    /// Whether its area is positive.
    pub(super) fn positive(&self) -> bool {
        self.area > 0.0
    }

    /// How many points it has.
    pub(super) fn count(&self) -> usize {
        self.points.len()
    }

    /// Where a point is.
    pub(super) fn vertex(&self, index: usize) -> f64 {
        self.at[index]
    }

    /// The edge of a place in `[0, 1)`.
    fn edge(&self, at: f64) -> usize {
        let behind = self.at.partition_point(|&start| start <= at);
        behind.saturating_sub(1).min(self.count() - 1)
    }

    /// The place, as a point and a fraction of the edge behind it, of a place in shares of the length.
    pub(super) fn place(&self, at: f64) -> RingPlace {
        let at = at - at.floor();
        let index = self.edge(at);
        let fraction = (at - self.at[index]) / (self.at[index + 1] - self.at[index]);
        if fraction >= 1.0 {
            let index = (index + 1) % self.count();
            return RingPlace::vertex(index);
        }
        RingPlace {
            index,
            fraction: fraction.max(0.0),
        }
    }

    /// The reverse of [`Outline::place`].
    pub(super) fn at(&self, place: RingPlace) -> f64 {
        let (from, to) = (self.at[place.index], self.at[place.index + 1]);
        from + (to - from) * place.fraction
    }

    /// The integral of the direction relative to the first, from 0 to any place; the outline goes on and on.
    fn integral(&self, at: f64) -> f64 {
        let rounds = at.floor();
        let within = at - rounds;
        let edge = self.edge(within);
        let direction = self.directions[edge] - self.directions[0];
        let part = self.integral[edge] + direction * (within - self.at[edge]);
        let whole = self.integral[self.count()];
        rounds * whole
            + self.turning * rounds * (rounds - 1.0) * 0.5
            + part
            + rounds * self.turning * within
    }

    /// How far it turns about a place: the mean direction over a distance ahead less that behind.
    fn turn(&self, at: f64, over: f64) -> f64 {
        let here = self.integral(at);
        (self.integral(at + over) - 2.0 * here + self.integral(at - over)) / over
    }

    /// How sharply it turns about a place, weighted.
    pub(super) fn corner(&self, at: f64, over: f64, weights: &Weights) -> f32 {
        (self.turn(at, over) / PI * weights.corners.sqrt()) as f32
    }

    /// How far it turns about a place, over each distance.
    fn turns(&self, at: f64) -> [f64; DISTANCES.len()] {
        DISTANCES.map(|over| self.turn(at, over))
    }

    /// What describes a place, so that the square of two places' difference is how much bending differs.
    pub(super) fn features(&self, at: f64, weights: &Weights) -> [f32; FEATURES] {
        let turns = self.turns(at);
        let mut features = [0.0; FEATURES];
        for (k, turn) in turns.iter().enumerate() {
            features[k] = (turn / PI * (weights.bending * SHARES[k]).sqrt()) as f32;
        }
        if weights.upright > 0.0 {
            let r = DISTANCES[0];
            let mean = (self.integral(at + r) - self.integral(at - r)) / (2.0 * r);
            let (sin, cos) = math::sin_cos((mean + self.directions[0]) % TAU);
            let weight = weights.upright.sqrt();
            features[FEATURES - 6] = (cos * weight) as f32;
            features[FEATURES - 5] = (sin * weight) as f32;
        }
        if weights.placed > 0.0 {
            let RingPlace { index, fraction } = self.place(at);
            let next = (index + 1) % self.count();
            let weight = (0.5 * weights.placed).sqrt();
            for (k, places) in self.places.iter().enumerate() {
                let place = places[index].lerp(places[next], fraction) * weight;
                features[FEATURES - 4 + 2 * k] = place.x as f32;
                features[FEATURES - 3 + 2 * k] = place.y as f32;
            }
        }
        features
    }

    /// A sample at a vertex.
    fn at_vertex(&self, index: usize) -> Sample {
        let at = self.at[index];
        Sample {
            at,
            vertex: Some(index),
            turn: self.turn(at, DISTANCES[0]),
        }
    }

    /// A sample at a place.
    pub(super) fn sample(&self, at: f64) -> Sample {
        let place = self.place(at);
        Sample {
            at,
            vertex: (place.fraction == 0.0).then_some(place.index),
            turn: self.turn(at, DISTANCES[0]),
        }
    }

    /// The vertex about which it turns most.
    pub(super) fn sharpest(&self) -> f64 {
        let all = (0..self.count()).map(|i| self.at_vertex(i));
        let most = all.reduce(|most, next| {
            // Not by rounding alone.
            if next.turn.abs() > most.turn.abs() * (1.0 + 1e-9) {
                next
            } else {
                most
            }
        });
        most.map_or(0.0, |sample| sample.at)
    }

    /// Samples from `start` to `end`, both with them, about `count` of them to the whole length: evenly, but where there are
    /// vertices at those.
    pub(super) fn samples(&self, start: f64, end: f64, count: usize) -> Vec<Sample> {
        let span = end - start;
        let intervals = (span * count as f64).round().max(1.0) as usize;
        let width = span / intervals as f64;
        let mut slots: Vec<Option<Sample>> = vec![None; intervals + 1];
        slots[0] = Some(self.sample(start));
        slots[intervals] = Some(Sample {
            at: end,
            ..self.sample(end)
        });
        for index in 0..self.count() {
            let mut sample = self.at_vertex(index);
            if sample.at <= start {
                sample.at += 1.0;
            }
            let slot = (sample.at - start) / width;
            if !(sample.at < end && slot.round() >= 1.0) {
                continue;
            }
            let slot = slot.round() as usize;
            if slot >= intervals {
                continue;
            }
            let better = |old: &Sample| sample.turn.abs() > old.turn.abs();
            if slots[slot].as_ref().is_none_or(better) {
                slots[slot] = Some(sample);
            }
        }
        let filled = slots.into_iter().enumerate();
        filled
            .map(|(k, slot)| slot.unwrap_or_else(|| self.sample(start + k as f64 * width)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::dvec2;

    #[test]
    fn directions_go_on_round_after_round() {
        let square = [
            dvec2(0.0, 0.0),
            dvec2(1.0, 0.0),
            dvec2(1.0, 1.0),
            dvec2(0.0, 1.0),
        ];
        let outline = Outline::new(&square, Side::Source).unwrap();
        assert!((outline.turning - TAU).abs() < 1e-15);
        // Every corner is like every other, the first one too, and no edge turns.
        for corner in [0.0, 0.25, 0.5, 0.75] {
            for turn in outline.turns(corner) {
                assert!((turn - PI / 2.0).abs() < 1e-12, "{corner} {turn}");
            }
            assert!(outline.turns(corner + 0.125)[2].abs() < 1e-12);
        }
        // The integral is that of the direction, by another way: midpoints.
        for (from, to) in [(-1.3, 0.2), (0.9, 2.7)] {
            let steps = 100_000;
            let mut sum = 0.0;
            for k in 0..steps {
                let at = from + (to - from) * (f64::from(k) + 0.5) / f64::from(steps);
                sum += (at * 4.0).floor() * PI / 2.0;
            }
            let sum = sum * (to - from) / f64::from(steps);
            let integral = outline.integral(to) - outline.integral(from);
            assert!((sum - integral).abs() < 1e-4, "{sum} {integral}");
        }
    }

    #[test]
    fn samples_are_at_vertices_where_there_are() {
        let bent = [
            dvec2(0.0, 0.0),
            dvec2(3.1, 0.0),
            dvec2(3.1, 1.7),
            dvec2(0.0, 1.7),
        ];
        let outline = Outline::new(&bent, Side::Source).unwrap();
        let samples = outline.samples(0.0, 1.0, 100);
        let vertices: Vec<_> = samples.iter().filter_map(|s| s.vertex).collect();
        assert_eq!(vertices, [0, 1, 2, 3, 0]);
        assert!(samples.windows(2).all(|pair| pair[0].at < pair[1].at));
        for sample in &samples {
            let place = outline.place(sample.at);
            assert!((outline.at(place) - sample.at.fract()).abs() < 1e-14);
        }
    }
}
