//! Reparameterization by the turned angle: any path at constant angular speed.
//!
//! The angle turned since the start is the integral of the angular speed. It is tabulated over pieces of the spans by
//! Gauss–Legendre quadrature of ten nodes, a piece being halved until the whole agrees with its two halves; the time of an
//! angle is found by Newton's method on the integral, kept within its piece by bisection.
//!
//! *Source*: the arc-length inverse of B. Guenter, R. Parent, *Computing the Arc Length of Parametric Curves*, IEEE CG&A
//! 10(3), 1990, on the sphere of rotations. As there (errata C13), the tolerance is on the angle, not on the time.

use super::error::OrientationError;
use super::path::Orientations;
use anamorph_core::glam::{DQuat, DVec3};

/// Nodes of the Gauss–Legendre rule on [−1, 1], each standing for ± itself, with their weights: M. Abramowitz,
/// I. A. Stegun, *Handbook of Mathematical Functions*, table 25.4.
const GAUSS: [(f64, f64); 5] = [
    (0.148_874_338_981_631_22, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];
/// Pieces a span may be cut into: beyond, the path spins rather than turns.
const PIECES: usize = 1 << 14;
/// Halvings of a piece: smaller ones are below the rounding of times.
const DEPTH: u32 = 48;
/// Steps of the search for a time; each at least halves its bracket or lands closer.
const STEPS: usize = 128;
/// Share of the accuracy for the table, the rest being for the search within a piece.
const SHARE: f64 = 0.25;
/// What rounding makes of sums of angles, as a share of the total.
const ROUNDING: f64 = 1e-14;

/// A path by the angle turned so far, in radians, from 0 to [`Self::total`]: equal steps are equal turns along the path.
///
/// As [`Orientations`] its "time" is that angle, and its angular speed 1. A closed path repeats after the angle of one
/// round. Where the path stands still for a while, the answer is the first time of the rest.
#[derive(Debug, Clone)]
pub struct EvenTurning<P> {
    path: P,
    accuracy: f64,
    /// Times at which pieces begin, and the last one ends.
    times: Vec<f64>,
    /// The angles turned by then.
    angles: Vec<f64>,
    /// The angles of the path's key times.
    key_angles: Vec<f64>,
}

/// The angle turned from `start` to `end`, within one span.
fn turned<P: Orientations>(path: &P, start: f64, end: f64) -> f64 {
    let (middle, half) = (0.5 * start + 0.5 * end, 0.5 * (end - start));
    let speed = |x: f64| path.angular_velocity(middle + half * x).length();
    let sum: f64 = GAUSS.iter().map(|(x, w)| (speed(-x) + speed(*x)) * w).sum();
    sum * half
}

impl<P: Orientations> EvenTurning<P> {
    /// Tabulates the path. Angles asked for later are met within `accuracy`, in radians, as far as rounding (1e-15 of the
    /// total) allows.
    ///
    /// # Errors
    /// [`OrientationError::Accuracy`] unless it is a positive number; [`OrientationError::TooWild`] where the path spins so
    /// much within a span that 16384 pieces do not suffice.
    pub fn new(path: P, accuracy: f64) -> Result<Self, OrientationError> {
        if !(accuracy > 0.0 && accuracy.is_finite()) {
            return Err(OrientationError::Accuracy { accuracy });
        }
        let spans = path.times().len().saturating_sub(1);
        let allowed = SHARE * accuracy / spans.max(1) as f64;
        let mut times = vec![path.domain()[0]];
        let (mut angles, mut key_angles) = (vec![0.0], vec![0.0]);
        let mut total = 0.0;
        // Pieces still to do, the next one last: end, angle by one rule, how often halved.
        let mut open: Vec<(f64, f64, u32)> = Vec::new();
        for span in 0..spans {
            let (mut start, end) = (path.times()[span], path.times()[span + 1]);
            open.push((end, turned(&path, start, end), 0));
            let mut pieces = 0;
            while let Some((end, whole, depth)) = open.pop() {
                let middle = 0.5 * start + 0.5 * end;
                let halves = [turned(&path, start, middle), turned(&path, middle, end)];
                let sum = halves[0] + halves[1];
                // Tolerances halve with the pieces, so that they add up; rounding is their floor.
                let tolerance = allowed / f64::from(1 << depth.min(30));
                let fine = (sum - whole).abs() <= tolerance.max(1e-15 * (total + sum));
                if fine || depth >= DEPTH || !(middle > start && middle < end) {
                    for (time, angle) in [(middle, halves[0]), (end, halves[1])] {
                        total += angle;
                        times.push(time);
                        angles.push(total);
                    }
                    start = end;
                    continue;
                }
                pieces += 1;
                if pieces > PIECES {
                    return Err(OrientationError::TooWild {
                        time: span + 1,
                        accuracy,
                        limit: PIECES,
                    });
                }
                open.push((end, halves[1], depth + 1));
                open.push((middle, halves[0], depth + 1));
            }
            key_angles.push(total);
        }
        Ok(Self {
            path,
            accuracy,
            times,
            angles,
            key_angles,
        })
    }

    /// The angle turned along the whole path, in radians: of a closed one, in one round.
    pub fn total(&self) -> f64 {
        self.angles[self.angles.len() - 1]
    }

    /// The path itself.
    pub fn path(&self) -> &P {
        &self.path
    }

    /// The angle turned from the start of the domain until the time `t`, cut off at its ends; NaN stands for the start.
    pub fn angle_at(&self, t: f64) -> f64 {
        let last = self.times.len() - 1;
        if t.is_nan() || t <= self.times[0] {
            return 0.0;
        }
        if t >= self.times[last] {
            return self.angles[last];
        }
        let piece = self.times.partition_point(|&start| start <= t) - 1;
        let angle = self.angles[piece] + turned(&self.path, self.times[piece], t);
        angle.min(self.angles[piece + 1])
    }

    /// The time at which `angle` radians have been turned, cut off at the ends; NaN stands for the start.
    pub fn time_at(&self, angle: f64) -> f64 {
        let last = self.times.len() - 1;
        if angle.is_nan() || angle <= 0.0 {
            return self.times[0];
        }
        if angle >= self.angles[last] {
            // The path may rest before its end.
            return self.times[self.angles.partition_point(|&a| a < self.angles[last])];
        }
        // An angle that is, but for rounding, that of a key is met there, not after the rest that may follow.
        let slack = (SHARE * self.accuracy).min(ROUNDING * self.total());
        let after = self.angles.partition_point(|&a| a < angle - slack).max(1);
        let (piece, angle) = (after - 1, angle.min(self.angles[after]));
        let (from, to) = (self.times[piece], self.times[piece + 1]);
        let wanted = angle - self.angles[piece];
        let whole = self.angles[piece + 1] - self.angles[piece];
        let (mut low, mut high) = (from, to);
        let mut t = from + (to - from) * (wanted / whole);
        for _ in 0..STEPS {
            let off = turned(&self.path, from, t) - wanted;
            if off.abs() <= SHARE * self.accuracy {
                // One more Newton step costs one velocity, and leaves far less than was asked for.
                let better = t - off / self.path.angular_velocity(t).length();
                return if better >= low && better <= high {
                    better
                } else {
                    t
                };
            }
            if off > 0.0 {
                high = t;
            } else {
                low = t;
            }
            let newton = t - off / self.path.angular_velocity(t).length();
            let middle = 0.5 * low + 0.5 * high;
            t = if newton > low && newton < high {
                newton
            } else {
                middle
            };
            if !(t > low && t < high) {
                break;
            }
        }
        t
    }

    /// The angle within [0, total] that an angle stands for.
    fn within(&self, angle: f64) -> f64 {
        let total = self.total();
        if self.path.is_closed() && angle.is_finite() && !(0.0..=total).contains(&angle) {
            let rest = angle.rem_euclid(total);
            // A path that does not turn has no rounds.
            return if rest.is_nan() { 0.0 } else { rest };
        }
        angle
    }
}

impl<P: Orientations> Orientations for EvenTurning<P> {
    /// The angles of the path's keys; equal ones where it rests from key to key.
    #[allow(clippy::misnamed_getters)] // the angles are this path's times
    fn times(&self) -> &[f64] {
        &self.key_angles
    }

    fn is_closed(&self) -> bool {
        self.path.is_closed()
    }

    fn orientation(&self, angle: f64) -> DQuat {
        self.path.orientation(self.time_at(self.within(angle)))
    }

    /// A unit vector, the axis of the turn; null where the path stands still.
    fn angular_velocity(&self, angle: f64) -> DVec3 {
        if !self.path.is_closed() && !(0.0..=self.total()).contains(&angle) {
            return DVec3::ZERO;
        }
        let velocity = self.path.angular_velocity(self.time_at(self.within(angle)));
        anamorph_core::Space::normalized(velocity).unwrap_or(DVec3::ZERO)
    }
}
