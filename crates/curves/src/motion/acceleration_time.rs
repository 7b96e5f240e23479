//! Accelerations at times.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Arbitrary Speed Control" (acceleration–time curves) and "Ease-in:
//! Constant Acceleration", which is three keys held.
//!
//! Speed and distance are the integrals, polynomials of degree up to 5. Both are linear in the keys' accelerations: the total
//! distance is met by multiplying those of the free keys by one factor; where a speed at the end is asked for as well, by two,
//! one for keys that accelerate and one for keys that brake.

use super::piecewise::{evaluate, integrated};
use super::speed_time::{Part, scale};
use super::{Between, PiecewisePolynomial, key_numbers, key_times, moderate, spans};
use crate::CurveError;

/// An acceleration at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AccelerationKey {
    /// The time, from 0.
    pub time: f64,
    /// The acceleration; negative ones brake.
    pub acceleration: f64,
    /// Whether the acceleration must stay what it is.
    pub fixed: bool,
}

impl AccelerationKey {
    /// A key whose acceleration may be scaled.
    pub fn free(time: f64, acceleration: f64) -> Self {
        Self {
            time,
            acceleration,
            fixed: false,
        }
    }

    /// A key whose acceleration stays.
    pub fn fixed(time: f64, acceleration: f64) -> Self {
        Self {
            time,
            acceleration,
            fixed: true,
        }
    }
}

/// Motion by accelerations at times, covering a given distance. Distances are C¹ at least. Before the first key it
/// goes evenly with the speed at the start. Nothing keeps the speed from becoming negative: see
/// [`diagnose`](super::diagnose).
#[derive(Clone, Debug, PartialEq)]
pub struct AccelerationTime {
    pub(super) curve: PiecewisePolynomial,
    factors: [f64; 2],
}

/// What the quantities at the end are made of: distance and speed.
#[derive(Clone, Copy, Default)]
struct Outcome {
    distance: f64,
    speed: f64,
}

impl AccelerationTime {
    /// Motion through at least two keys with a speed at the start, covering the distance `total` in the time of the last
    /// key. With `end_speed` it arrives with that speed, 0 for rest.
    ///
    /// # Errors
    /// For times that do not increase from 0 on, numbers that are not finite; [`CurveError::Unreachable`] where no
    /// factors that are not negative meet the conditions.
    pub fn new(
        keys: &[AccelerationKey],
        start_speed: f64,
        end_speed: Option<f64>,
        total: f64,
        between: Between,
    ) -> Result<Self, CurveError> {
        let times: Vec<f64> = keys.iter().map(|key| key.time).collect();
        key_times("a curve of accelerations", &times)?;
        key_numbers(
            "acceleration of key",
            keys.iter().map(|key| key.acceleration),
        )?;
        let start_speed = moderate("speed at the start", start_speed)?;
        let total = moderate("total distance", total)?;
        let outcomes = outcomes(&times, between);
        let duration = times[times.len() - 1];
        let even = start_speed * duration;
        let factors = if let Some(end_speed) = end_speed {
            let end_speed = moderate("speed at the end", end_speed)?;
            two_factors(keys, &outcomes, [total - even, end_speed - start_speed])?
        } else {
            let parts: Vec<Part> = keys
                .iter()
                .zip(&outcomes)
                .map(|(key, outcome)| Part {
                    amount: key.acceleration * outcome.distance,
                    fixed: key.fixed,
                })
                .collect();
            [scale("acceleration", &parts, even, total)?; 2]
        };
        let accelerations: Vec<f64> = keys
            .iter()
            .map(|key| {
                if key.fixed {
                    key.acceleration
                } else {
                    key.acceleration * factors[usize::from(key.acceleration < 0.0)]
                }
            })
            .collect();
        let curve = summed(&times, &accelerations, start_speed, between, total);
        Ok(Self { curve, factors })
    }

    /// By what the accelerations of the free keys were multiplied: of those that accelerate, and of those that brake.
    pub fn factors(&self) -> [f64; 2] {
        self.factors
    }
}

/// Distance and speed at the end that a unit of each key's acceleration makes.
fn outcomes(times: &[f64], between: Between) -> Vec<Outcome> {
    let end = times[times.len() - 1];
    let mut outcomes = vec![Outcome::default(); times.len()];
    for (index, (start, span)) in spans(times).enumerate() {
        let left = end - (start + span);
        for (key, from, to) in [(index, 1.0, 0.0), (index + 1, 0.0, 1.0)] {
            let speed = integrated(&between.piece(span, from, to), 0.0);
            let distance = integrated(&speed, 0.0);
            let gained = evaluate(&speed, span);
            outcomes[key].speed += gained;
            outcomes[key].distance += evaluate(&distance, span) + gained * left;
        }
    }
    outcomes
}

/// The factors of accelerating and of braking free keys with which distance and speed grow as wanted.
fn two_factors(
    keys: &[AccelerationKey],
    outcomes: &[Outcome],
    wanted: [f64; 2],
) -> Result<[f64; 2], CurveError> {
    // Sums over fixed, accelerating and braking keys.
    let mut sums = [Outcome::default(); 3];
    for (key, outcome) in keys.iter().zip(outcomes) {
        let group = match (key.fixed, key.acceleration < 0.0) {
            (true, _) => 0,
            (false, false) => 1,
            (false, true) => 2,
        };
        sums[group].distance += key.acceleration * outcome.distance;
        sums[group].speed += key.acceleration * outcome.speed;
    }
    let [kept, up, down] = sums;
    let (distance, speed) = (wanted[0] - kept.distance, wanted[1] - kept.speed);
    let determinant = up.distance * down.speed - down.distance * up.speed;
    let size = (up.distance * down.speed).abs() + (down.distance * up.speed).abs();
    let conditions = "the distance and the speed at the end cannot both be met";
    if determinant.abs() <= 1e-12 * size || size == 0.0 {
        return Err(CurveError::Unreachable {
            problem: format!(
                "{conditions}: that takes a free key that accelerates and a free key that brakes, at different times"
            ),
        });
    }
    let factors = [
        (distance * down.speed - down.distance * speed) / determinant,
        (up.distance * speed - distance * up.speed) / determinant,
    ];
    for (factor, which, verb) in [
        (factors[0], "accelerate", "brake"),
        (factors[1], "brake", "accelerate"),
    ] {
        if factor < 0.0 {
            return Err(CurveError::Unreachable {
                problem: format!(
                    "{conditions}: the free keys that {which} would have to {verb}; move keys in time, change the fixed ones, or leave the speed at the end open"
                ),
            });
        }
    }
    Ok(factors)
}

fn summed(
    times: &[f64],
    accelerations: &[f64],
    start_speed: f64,
    between: Between,
    total: f64,
) -> PiecewisePolynomial {
    let mut breaks = Vec::with_capacity(times.len() + 1);
    let mut pieces = Vec::with_capacity(times.len());
    let (mut distance, mut speed) = (0.0, start_speed);
    if times[0] > 0.0 {
        breaks.push(0.0);
        pieces.push([0.0, start_speed, 0.0, 0.0, 0.0, 0.0]);
        distance = start_speed * times[0];
    }
    for (index, (start, span)) in spans(times).enumerate() {
        let piece = between.piece(span, accelerations[index], accelerations[index + 1]);
        let speeds = integrated(&piece, speed);
        let distances = integrated(&speeds, distance);
        speed = evaluate(&speeds, span);
        distance = evaluate(&distances, span);
        breaks.push(start);
        pieces.push(distances);
    }
    breaks.push(times[times.len() - 1]);
    PiecewisePolynomial::new(breaks, pieces, total)
}
