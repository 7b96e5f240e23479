//! Distances at times.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Curve fitting to distance-time pairs", "Interpolating distance-time
//! pairs".
//!
//! Monotone: speeds at keys without one are those of the parabola through three keys, limited to three times the smaller
//! of the two chords, and 0 at turning points (J. M. Hyman, *Accurate Monotonicity Preserving Cubic Interpolation*, SIAM J.
//! Sci. Stat. Comput. 4(4), 1983; F. N. Fritsch and R. E. Carlson, *Monotone Piecewise Cubic Interpolation*, SIAM J. Numer.
//! Anal. 17(2), 1980: with both slopes at most three chords a cubic is monotone). Speeds that the user gives are kept wherever a
//! monotone curve can have them: where one exceeds three chords, the span is not a cubic but goes from it to half of the
//! chord's speed, on evenly, and to the other key's speed, by single cubics of the speed, so short that the distance is met. Only
//! speeds of the wrong sign, or beside a span that stays, cannot be had: they become 0, and [`DistanceTime::changes`]
//! tells.
//!
//! Free: the cubic spline with continuous acceleration (natural at ends without a speed; C. de Boor, *A Practical Guide to
//! Splines*, 1978, chapter IV), which may overshoot. Speeds that the user gives are kept; acceleration may jump there.

use super::piecewise::{Coefficients, evaluate, hermite, integrated};
use super::{Between, PiecewisePolynomial, key_numbers, key_times, spans};
use crate::CurveError;
use crate::error::Short;

/// A distance at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceKey {
    /// The time, from 0.
    pub time: f64,
    /// The distance from the start of the path.
    pub distance: f64,
    /// The speed there; computed where there is none.
    pub speed: Option<f64>,
}

impl DistanceKey {
    /// A distance whose speed is computed.
    pub fn new(time: f64, distance: f64) -> Self {
        Self {
            time,
            distance,
            speed: None,
        }
    }

    /// A distance with a speed.
    pub fn with_speed(time: f64, distance: f64, speed: f64) -> Self {
        Self {
            time,
            distance,
            speed: Some(speed),
        }
    }
}

/// Why a speed that was asked for cannot be had without backing up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// It goes back where the keys go on, or the other way round.
    Sign,
    /// A neighbouring key has the same distance: motion must rest between them.
    Rest,
    /// The keys turn round here.
    Turn,
}

/// A speed that was asked for, and what it became.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedChange {
    /// The key, counted from 0.
    pub key: usize,
    /// The speed asked for.
    pub asked: f64,
    /// The speed it has.
    pub used: f64,
    /// Why.
    pub cause: Cause,
}

impl core::fmt::Display for SpeedChange {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self {
            key, asked, used, ..
        } = self;
        let why = match self.cause {
            Cause::Sign => "it would back up against the keys beside it",
            Cause::Rest => "the motion rests beside it, between keys of equal distance",
            Cause::Turn => "the keys turn round there",
        };
        let (used, asked) = (Short(*used), Short(*asked));
        write!(
            f,
            "the speed of key {key} is {used} instead of {asked}: {why}"
        )
    }
}

/// Motion through distances at times; C¹ at least. Before the first key it rests at its distance.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceTime {
    pub(super) curve: PiecewisePolynomial,
    changes: Vec<SpeedChange>,
}

/// With both speeds below this multiple of the chord's a cubic is monotone.
const MONOTONE: f64 = 3.0;

impl DistanceTime {
    /// Motion through at least two keys that between two keys never turns round.
    ///
    /// # Errors
    /// For times that do not increase from 0 on, and numbers that are not finite.
    pub fn monotone(keys: &[DistanceKey]) -> Result<Self, CurveError> {
        let (times, chords) = checked(keys)?;
        let steps: Vec<(f64, f64)> = spans(&times).collect();
        let mut changes = Vec::new();
        let mut speeds = Vec::with_capacity(keys.len());
        for (index, key) in keys.iter().enumerate() {
            let before = index.checked_sub(1).map(|i| (steps[i].1, chords[i]));
            let behind = chords.get(index).map(|&chord| (steps[index].1, chord));
            let chord = |side: Option<(f64, f64)>| side.map(|(_, chord)| chord);
            let beside = [chord(before), chord(behind)];
            let speed = match key.speed {
                Some(asked) => {
                    let (used, cause) = permitted(asked, beside);
                    if let Some(cause) = cause {
                        changes.push(SpeedChange {
                            key: index,
                            asked,
                            used,
                            cause,
                        });
                    }
                    used
                }
                None => {
                    let estimate = match (before, behind) {
                        (Some(before), Some(behind)) => parabolic(before, behind),
                        (None, Some(first)) => at_end(
                            first,
                            steps.get(1).zip(chords.get(1)).map(|(s, c)| (s.1, *c)),
                        ),
                        (Some(last), None) => {
                            at_end(last, index.checked_sub(2).map(|i| (steps[i].1, chords[i])))
                        }
                        (None, None) => 0.0,
                    };
                    limited(estimate, beside)
                }
            };
            speeds.push(speed);
        }
        Ok(Self {
            curve: joined(keys, &steps, &chords, &speeds, true),
            changes,
        })
    }

    /// Motion through at least two keys on a smooth curve, which may overshoot and back up.
    ///
    /// # Errors
    /// For times that do not increase from 0 on, and numbers that are not finite.
    pub fn free(keys: &[DistanceKey]) -> Result<Self, CurveError> {
        let (times, chords) = checked(keys)?;
        let steps: Vec<(f64, f64)> = spans(&times).collect();
        let speeds = spline_speeds(keys, &steps, &chords);
        Ok(Self {
            curve: joined(keys, &steps, &chords, &speeds, false),
            changes: Vec::new(),
        })
    }

    /// The speeds that were asked for and could not be had.
    pub fn changes(&self) -> &[SpeedChange] {
        &self.changes
    }
}

/// Times and chords of checked keys.
fn checked(keys: &[DistanceKey]) -> Result<(Vec<f64>, Vec<f64>), CurveError> {
    let times: Vec<f64> = keys.iter().map(|key| key.time).collect();
    key_times("a curve of distances", &times)?;
    key_numbers("distance of key", keys.iter().map(|key| key.distance))?;
    key_numbers(
        "speed of key",
        keys.iter().map(|key| key.speed.unwrap_or(0.0)),
    )?;
    let chords = keys.windows(2).map(|pair| {
        let (from, to) = (pair[0], pair[1]);
        (to.distance - from.distance) / (to.time - from.time)
    });
    let chords = chords.collect();
    Ok((times, chords))
}

/// The speed nearest to the one asked for that a monotone curve can have between these chords.
fn permitted(asked: f64, beside: [Option<f64>; 2]) -> (f64, Option<Cause>) {
    let chords = || beside.iter().flatten();
    let cause = if asked == 0.0 {
        None
    } else if chords().any(|&chord| chord == 0.0) {
        Some(Cause::Rest)
    } else if chords().any(|&chord| chord > 0.0) && chords().any(|&chord| chord < 0.0) {
        Some(Cause::Turn)
    } else if chords().any(|&chord| (chord > 0.0) != (asked > 0.0)) {
        Some(Cause::Sign)
    } else {
        None
    };
    (if cause.is_some() { 0.0 } else { asked }, cause)
}

/// The slope in the middle of the parabola through three keys.
fn parabolic((h0, c0): (f64, f64), (h1, c1): (f64, f64)) -> f64 {
    (c0 * h1 + c1 * h0) / (h0 + h1)
}

/// The slope at the end of the parabola through the three keys there; of the line through two.
fn at_end((h0, c0): (f64, f64), next: Option<(f64, f64)>) -> f64 {
    match next {
        Some((h1, c1)) => c0 + (c0 - c1) * (h0 / (h0 + h1)),
        None => c0,
    }
}

/// The estimate, limited to three times either chord, and to their sign.
fn limited(estimate: f64, beside: [Option<f64>; 2]) -> f64 {
    let mut speed = estimate;
    for &chord in beside.iter().flatten() {
        speed = if chord > 0.0 {
            speed.clamp(0.0, MONOTONE * chord)
        } else if chord < 0.0 {
            speed.clamp(MONOTONE * chord, 0.0)
        } else {
            0.0
        };
    }
    speed
}

/// The speeds of the natural cubic spline, those given kept: a tridiagonal system with a dominant diagonal.
fn spline_speeds(keys: &[DistanceKey], steps: &[(f64, f64)], chords: &[f64]) -> Vec<f64> {
    let last = keys.len() - 1;
    // Each row: below, diagonal, above, right side. Rows are divided by what makes the diagonal 1 on the way.
    let row = |index: usize| -> [f64; 4] {
        if let Some(speed) = keys[index].speed {
            return [0.0, 1.0, 0.0, speed];
        }
        if index == 0 {
            return [0.0, 2.0, 1.0, 3.0 * chords[0]];
        }
        if index == last {
            return [1.0, 2.0, 0.0, 3.0 * chords[last - 1]];
        }
        let (h0, h1) = (steps[index - 1].1, steps[index].1);
        let (w0, w1) = (h1 / (h0 + h1), h0 / (h0 + h1));
        let right = 3.0 * (w0 * chords[index - 1] + w1 * chords[index]);
        [w0, 2.0, w1, right]
    };
    let (mut above, mut speeds) = (Vec::new(), Vec::new());
    let (mut last_above, mut last_right) = (0.0, 0.0);
    for index in 0..=last {
        let [below, diagonal, next, right] = row(index);
        let pivot = diagonal - below * last_above;
        last_above = next / pivot;
        last_right = (right - below * last_right) / pivot;
        above.push(last_above);
        speeds.push(last_right);
    }
    for index in (0..last).rev() {
        speeds[index] -= above[index] * speeds[index + 1];
    }
    speeds
}

/// The pieces between keys with these speeds.
fn joined(
    keys: &[DistanceKey],
    steps: &[(f64, f64)],
    chords: &[f64],
    speeds: &[f64],
    monotone: bool,
) -> PiecewisePolynomial {
    let mut breaks = Vec::with_capacity(keys.len() + 1);
    let mut pieces: Vec<Coefficients> = Vec::with_capacity(keys.len());
    if keys[0].time > 0.0 {
        breaks.push(0.0);
        pieces.push([keys[0].distance, 0.0, 0.0, 0.0, 0.0, 0.0]);
    }
    for (index, &(start, span)) in steps.iter().enumerate() {
        let (from, to) = (keys[index].distance, keys[index + 1].distance);
        let (first, second, chord) = (speeds[index], speeds[index + 1], chords[index]);
        let most = MONOTONE * chord.abs() * (1.0 + 1e-12);
        if !monotone || (first.abs() <= most && second.abs() <= most) {
            breaks.push(start);
            pieces.push(hermite(span, from, to, first, second));
        } else {
            ramps(
                start,
                span,
                from,
                [first, second, chord],
                &mut breaks,
                &mut pieces,
            );
        }
    }
    let end = keys[keys.len() - 1];
    breaks.push(end.time);
    PiecewisePolynomial::new(breaks, pieces, end.distance)
}

/// From one speed to half of the chord's, on evenly, and to the other speed. The two ramps take
/// `chord·span/(first + second − chord)` each, at most half of the span, as one speed is at least three chords.
fn ramps(
    start: f64,
    span: f64,
    from: f64,
    [first, second, chord]: [f64; 3],
    breaks: &mut Vec<f64>,
    pieces: &mut Vec<Coefficients>,
) {
    let end = start + span;
    let ramp = (span * (chord / (first + second - chord))).min(0.5 * span);
    // Where times are too coarse for a ramp it becomes shorter, never longer: the even speed keeps its sign.
    let (mut up, mut down) = (start + ramp, end - ramp);
    if up - start > ramp {
        up = up.next_down().max(start);
    }
    if end - down > ramp {
        down = down.next_up().min(end);
    }
    let (rise, fall) = (up - start, end - down);
    let middle = (down - up).max(0.0);
    let even =
        (chord * span - 0.5 * (first * rise + second * fall)) / (middle + 0.5 * (rise + fall));
    let mut distance = from;
    for (at, length, begin, stop) in [
        (start, rise, first, even),
        (up, middle, even, even),
        (down, fall, even, second),
    ] {
        if length > 0.0 {
            let piece = integrated(&Between::Smooth.piece(length, begin, stop), distance);
            distance = evaluate(&piece, length);
            breaks.push(at);
            pieces.push(piece);
        }
    }
}
