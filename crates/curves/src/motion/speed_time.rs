//! Speeds at times.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Arbitrary Speed Control" (velocity–time curves) and "Curve fitting to
//! distance-time pairs" ("possible solution to enforce total distance covered: signed area under the curve").
//!
//! Between two keys the speed goes straight or by the single cubic `3t² − 2t³`. Both stay between the two speeds and
//! have the same area, so that the distance is linear in the keys' speeds, and the total is met exactly by multiplying those
//! of the keys that are free by one factor. A motion of speeds that are not negative never backs up.

use super::piecewise::{Coefficients, evaluate, integrated};
use super::{PiecewisePolynomial, key_numbers, key_times, moderate, spans};
use crate::CurveError;
use crate::error::Short;

/// How a quantity goes from key to key.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Between {
    /// It keeps the value of the key until the next, and jumps there.
    Hold,
    /// Straight.
    Linear,
    /// By the single cubic, whose slope is 0 at every key.
    #[default]
    Smooth,
}

impl Between {
    /// The quantity between two keys.
    pub(super) fn piece(self, span: f64, from: f64, to: f64) -> Coefficients {
        let rise = to - from;
        match self {
            Self::Hold => [from, 0.0, 0.0, 0.0, 0.0, 0.0],
            Self::Linear => [from, rise / span, 0.0, 0.0, 0.0, 0.0],
            Self::Smooth => {
                let square = rise / span / span;
                [from, 0.0, 3.0 * square, -2.0 * square / span, 0.0, 0.0]
            }
        }
    }
}

/// A speed at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedKey {
    /// The time, from 0.
    pub time: f64,
    /// The speed; negative ones go back.
    pub speed: f64,
    /// Whether the speed must stay what it is; speeds of other keys are scaled to meet the total distance.
    pub fixed: bool,
}

impl SpeedKey {
    /// A key whose speed may be scaled.
    pub fn free(time: f64, speed: f64) -> Self {
        Self {
            time,
            speed,
            fixed: false,
        }
    }

    /// A key whose speed stays.
    pub fn fixed(time: f64, speed: f64) -> Self {
        Self {
            time,
            speed,
            fixed: true,
        }
    }
}

/// Motion by speeds at times, covering a given distance. Distances are C¹ with [`Between::Linear`], C² with
/// [`Between::Smooth`], continuous with [`Between::Hold`]. Before the first key it rests.
#[derive(Clone, Debug, PartialEq)]
pub struct SpeedTime {
    pub(super) curve: PiecewisePolynomial,
    factor: f64,
}

impl SpeedTime {
    /// Motion through at least two keys, covering the distance `total` in the time of the last key: speeds of free keys are
    /// multiplied by one positive factor (or 0), those of fixed ones kept.
    ///
    /// # Errors
    /// For times that do not increase from 0 on, numbers that are not finite; [`CurveError::Unreachable`] where no such
    /// factor meets the distance, naming the keys.
    pub fn new(keys: &[SpeedKey], total: f64, between: Between) -> Result<Self, CurveError> {
        let times: Vec<f64> = keys.iter().map(|key| key.time).collect();
        key_times("a curve of speeds", &times)?;
        key_numbers("speed of key", keys.iter().map(|key| key.speed))?;
        let total = moderate("total distance", total)?;
        // The distance that a key's unit of speed contributes.
        let mut shares = vec![0.0; keys.len()];
        for (index, (_, span)) in spans(&times).enumerate() {
            if between == Between::Hold {
                shares[index] += span;
            } else {
                shares[index] += 0.5 * span;
                shares[index + 1] += 0.5 * span;
            }
        }
        let parts: Vec<Part> = keys
            .iter()
            .zip(&shares)
            .map(|(key, share)| Part {
                amount: key.speed * share,
                fixed: key.fixed,
            })
            .collect();
        let factor = scale("speed", &parts, 0.0, total)?;
        let speeds = keys.iter().map(|key| {
            if key.fixed {
                key.speed
            } else {
                key.speed * factor
            }
        });
        let curve = summed(&times, &speeds.collect::<Vec<_>>(), between, total);
        Ok(Self { curve, factor })
    }

    /// Motion through at least two keys, all of them kept, whatever distance that covers.
    ///
    /// # Errors
    /// As [`SpeedTime::new`], but all distances can be reached.
    pub fn as_drawn(keys: &[SpeedKey], between: Between) -> Result<Self, CurveError> {
        let times: Vec<f64> = keys.iter().map(|key| key.time).collect();
        key_times("a curve of speeds", &times)?;
        key_numbers("speed of key", keys.iter().map(|key| key.speed))?;
        let speeds: Vec<f64> = keys.iter().map(|key| key.speed).collect();
        let curve = summed(&times, &speeds, between, f64::NAN);
        Ok(Self { curve, factor: 1.0 })
    }

    /// By what the speeds of the free keys were multiplied.
    pub fn factor(&self) -> f64 {
        self.factor
    }
}

/// What a key contributes to the distance.
pub(super) struct Part {
    pub(super) amount: f64,
    pub(super) fixed: bool,
}

/// Below this share of the sizes of what they sum up, the free keys' contributions cancel each other: a factor would be
/// enormous.
const CANCELLED: f64 = 1e-9;

/// The factor, not negative, of the free parts with which all parts, and what is covered without keys, sum up to the
/// total.
pub(super) fn scale(
    quantity: &'static str,
    parts: &[Part],
    without: f64,
    total: f64,
) -> Result<f64, CurveError> {
    let sum = |fixed: bool| {
        let chosen = parts.iter().filter(|part| part.fixed == fixed);
        chosen.fold((0.0, 0.0), |(sum, size), part| {
            (sum + part.amount, size + part.amount.abs())
        })
    };
    let ((kept, kept_size), (free, free_size)) = (sum(true), sum(false));
    let (kept, kept_size) = (kept + without, kept_size + without.abs());
    let missing = total - kept;
    if missing.abs() <= 1e-12 * total.abs().max(kept_size) && free_size == 0.0 {
        return Ok(1.0);
    }
    let names = |fixed: bool| {
        let chosen =
            (0..parts.len()).filter(|&i| parts[i].fixed == fixed && parts[i].amount != 0.0);
        let mut names: Vec<String> = chosen.clone().take(8).map(|i| i.to_string()).collect();
        if chosen.count() > 8 {
            names.push("…".to_owned());
        }
        names.join(", ")
    };
    let article = if quantity.starts_with('a') { "an" } else { "a" };
    let held = {
        let keys = names(true);
        let mut held = Vec::new();
        if !keys.is_empty() {
            held.push(format!("the fixed keys ({keys})"));
        }
        if without != 0.0 {
            held.push("the speed at the start".to_owned());
        }
        held.join(" and ")
    };
    let (distance, covered) = (Short(total), Short(kept));
    let holds = if held.is_empty() {
        String::new()
    } else if held.contains(" and ") || held.starts_with("the fixed") {
        format!("{held} cover {covered}, and ")
    } else {
        format!("{held} covers {covered}, and ")
    };
    if free_size == 0.0 || free.abs() <= CANCELLED * free_size {
        let reason = if free_size == 0.0 {
            format!("no free key has {article} {quantity} that could be scaled")
        } else {
            format!("the free keys ({}) cover nothing together", names(false))
        };
        let mend = if names(true).is_empty() {
            format!("give a key another {quantity}")
        } else {
            format!("free a key, or give a free one another {quantity}")
        };
        return Err(CurveError::Unreachable {
            problem: format!("the distance {distance} cannot be met: {holds}{reason}; {mend}"),
        });
    }
    let factor = missing / free;
    if factor < 0.0 {
        let free = names(false);
        let mend = if names(true).is_empty() {
            format!("give the keys another {quantity}, or ask for another distance")
        } else {
            format!("change the {quantity} of fixed keys, or free one")
        };
        return Err(CurveError::Unreachable {
            problem: format!(
                "the distance {distance} cannot be met: {holds}the free keys ({free}) would have to turn round; {mend}"
            ),
        });
    }
    Ok(factor)
}

/// The integral over the keys, from 0; a span at rest first, where the first key is later than time 0. The value at the
/// end is `total` where that is a number.
fn summed(times: &[f64], speeds: &[f64], between: Between, total: f64) -> PiecewisePolynomial {
    let mut breaks = Vec::with_capacity(times.len() + 1);
    let mut pieces = Vec::with_capacity(times.len());
    if times[0] > 0.0 {
        breaks.push(0.0);
        pieces.push([0.0; 6]);
    }
    let mut distance = 0.0;
    for (index, (start, span)) in spans(times).enumerate() {
        let piece = between.piece(span, speeds[index], speeds[index + 1]);
        let piece = integrated(&piece, distance);
        distance = evaluate(&piece, span);
        breaks.push(start);
        pieces.push(piece);
    }
    breaks.push(times[times.len() - 1]);
    let last = if total.is_nan() { distance } else { total };
    PiecewisePolynomial::new(breaks, pieces, last)
}
