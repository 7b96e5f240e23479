//! `linear(…)` of style sheets: straight lines between stops.
//!
//! *Source*: W3C, *CSS Easing Functions Level 2*, "The linear easing function". Times that do not increase are raised to the
//! largest before them; times left out are spread evenly; before the first stop and behind the last their lines go on. At
//! the time of a jump the later stop counts.

use super::{Ease, EaseFacts, EaseState};
use crate::CurveError;
use anamorph_core::Smoothness;

/// The largest magnitude of a stop's value and time.
const LARGEST: f64 = 1e100;

/// Straight lines between stops.
#[derive(Clone, Debug, PartialEq)]
pub struct Stops {
    /// Time and value, times not decreasing; at least two.
    stops: Vec<(f64, f64)>,
}

impl Stops {
    /// Stops given as (time, value).
    ///
    /// # Errors
    /// [`CurveError::TooFewPoints`] below two, [`CurveError::ElementOutOfRange`] for numbers that are not finite or above
    /// 1e100 in size.
    pub fn new(stops: &[(f64, f64)]) -> Result<Self, CurveError> {
        let listed = stops.iter().map(|&(time, value)| (Some(time), value));
        Self::listed(&listed.collect::<Vec<_>>())
    }

    /// Stops of which some have no time.
    ///
    /// # Errors
    /// As [`Stops::new`].
    pub fn listed(stops: &[(Option<f64>, f64)]) -> Result<Self, CurveError> {
        if stops.len() < 2 {
            return Err(CurveError::TooFewPoints {
                what: "linear()",
                needed: 2,
                found: stops.len(),
            });
        }
        for (index, &(time, value)) in stops.iter().enumerate() {
            for (what, number) in [
                ("value of stop", value),
                ("time of stop", time.unwrap_or(0.0)),
            ] {
                if !number.is_finite() || number.abs() > LARGEST {
                    return Err(CurveError::ElementOutOfRange {
                        what,
                        index,
                        value: number,
                        range: "a number of at most 1e100 in size",
                    });
                }
            }
        }
        let last = stops.len() - 1;
        let mut largest = f64::NEG_INFINITY;
        let mut known: Vec<(usize, f64)> = Vec::with_capacity(stops.len());
        for (index, &(time, _)) in stops.iter().enumerate() {
            let ends = if index == 0 {
                Some(0.0)
            } else {
                (index == last).then_some(1.0)
            };
            if let Some(time) = time.or(ends) {
                largest = largest.max(time);
                known.push((index, largest));
            }
        }
        let mut filled: Vec<(f64, f64)> = Vec::with_capacity(stops.len());
        filled.push((known[0].1, stops[0].1));
        for pair in known.windows(2) {
            let ((from, start), (to, end)) = (pair[0], pair[1]);
            for (index, stop) in stops.iter().enumerate().take(to).skip(from + 1) {
                #[allow(clippy::cast_precision_loss)]
                let share = (index - from) as f64 / (to - from) as f64;
                filled.push((start + (end - start) * share, stop.1));
            }
            filled.push((end, stops[to].1));
        }
        Ok(Self { stops: filled })
    }

    /// The stops, (time, value), with all times filled in.
    pub fn stops(&self) -> &[(f64, f64)] {
        &self.stops
    }
}

impl Ease for Stops {
    fn state(&self, t: f64) -> EaseState {
        // The last stop not after t, but not the very last; the first where there is none.
        let after = self.stops.partition_point(|stop| stop.0 <= t);
        let a = after.saturating_sub(1).min(self.stops.len() - 2);
        let ((start, from), (end, to)) = (self.stops[a], self.stops[a + 1]);
        let rest = |value| EaseState {
            value,
            speed: 0.0,
            acceleration: 0.0,
        };
        if start == end {
            return rest(to);
        }
        let speed = (to - from) / (end - start);
        let value = if t == end {
            to
        } else {
            from + (to - from) * ((t - start) / (end - start))
        };
        if !value.is_finite() || !speed.is_finite() {
            // Two stops so near each other that their line leaves the range of numbers: a jump.
            return rest(if t < start { from } else { to });
        }
        EaseState {
            value,
            speed,
            acceleration: 0.0,
        }
    }

    fn facts(&self) -> EaseFacts {
        let (before, behind) = (self.stops[0].0, self.stops[self.stops.len() - 1].0);
        let mut slopes: Vec<f64> = Vec::new();
        let mut jump = false;
        let inside = |pair: &[(f64, f64)], index: usize| {
            let first = index == 0 && before > 0.0;
            let last = index + 2 == self.stops.len() && behind < 1.0;
            (pair[1].0 > 0.0 || last) && (pair[0].0 < 1.0 || first)
        };
        let mut monotone = true;
        for (index, pair) in self.stops.windows(2).enumerate() {
            let (width, rise) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
            if width == 0.0 {
                let within = pair[0].0 > 0.0 && pair[0].0 < 1.0;
                jump |= within && rise != 0.0;
                monotone &= !within || rise >= 0.0;
            } else if inside(pair, index) {
                monotone &= rise >= 0.0;
                slopes.push(rise / width);
            }
        }
        let straight = slopes.windows(2).all(|pair| pair[0] == pair[1]);
        EaseFacts {
            monotone,
            starts_at_zero: self.value(0.0) == 0.0,
            ends_at_one: self.value(1.0) == 1.0,
            smoothness: match (jump, straight) {
                (true, _) => Smoothness::Jump,
                (false, true) => Smoothness::Smooth,
                (false, false) => Smoothness::C(0),
            },
            finite_speed: true,
        }
    }

    fn breaks(&self) -> Vec<f64> {
        let mut times: Vec<f64> = self.stops.iter().map(|stop| stop.0).collect();
        times.dedup();
        times.retain(|&t| t > 0.0 && t < 1.0);
        times
    }
}
