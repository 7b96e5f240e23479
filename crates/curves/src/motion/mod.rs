//! Speed control: which distance is covered at which time.
//!
//! A [`Motion`] is `P(U(S(t)))`, and a [`SpeedControl`] its `S`: an ease over a duration and a distance ([`Eased`]), or
//! drawn by keys: distances at times ([`DistanceTime`]), speeds ([`SpeedTime`]) or accelerations ([`AccelerationTime`]).
//! [`diagnose`] names what an animator would not want, with its time.
//!
//! Times are in any unit, usually seconds, and begin at 0; distances in scene units along the path, or in shares of it.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Speed control", "Arbitrary Speed Control", "Curve fitting to
//! distance-time pairs" and "Working with time-distance curves".

mod acceleration_time;
mod along;
mod clipped;
mod diagnose;
mod distance_time;
mod finding;
mod piecewise;
mod speed_time;
mod turning;

pub use acceleration_time::{AccelerationKey, AccelerationTime};
pub use along::{Measure, Motion};
pub use diagnose::{diagnose, diagnose_until};
pub use distance_time::{Cause, DistanceKey, DistanceTime, SpeedChange};
pub use finding::Finding;
pub use piecewise::PiecewisePolynomial;
pub use speed_time::{Between, SpeedKey, SpeedTime};
pub use turning::turns_at_once;

use crate::CurveError;
use crate::eases::Ease;

/// Distance as a function of time, from time 0 to a duration. Total: before 0, and at what is not a number, it is as at 0,
/// after the duration as at the duration, and at rest.
pub trait SpeedControl: core::fmt::Debug + Send + Sync {
    /// How long it takes.
    fn duration(&self) -> f64;

    /// The distance covered at a time; always finite.
    fn distance(&self, time: f64) -> f64;

    /// Its derivative by the time, 0 outside the duration. Where the sides differ, one of them.
    fn speed(&self, time: f64) -> f64;

    /// The second derivative by the time, 0 outside the duration.
    fn acceleration(&self, time: f64) -> f64;

    /// The times between which the motion is analytic: 0, the duration, and those at which it may not be smooth;
    /// strictly increasing.
    fn breaks(&self) -> Vec<f64>;

    /// The distance as polynomials of the time, where it is such: its zeros and turning points are then found exactly.
    fn polynomials(&self) -> Option<&PiecewisePolynomial> {
        None
    }
}

/// An ease over a duration and a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eased<E> {
    ease: E,
    duration: f64,
    distance: f64,
}

impl<E: Ease> Eased<E> {
    /// An ease that takes `duration`, greater than 0, to cover `distance`.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`].
    pub fn new(ease: E, duration: f64, distance: f64) -> Result<Self, CurveError> {
        Ok(Self {
            ease,
            duration: positive_duration(duration)?,
            distance: moderate("distance", distance)?,
        })
    }
}

impl<E: Ease> SpeedControl for Eased<E> {
    fn duration(&self) -> f64 {
        self.duration
    }
    fn distance(&self, time: f64) -> f64 {
        self.distance * self.ease.value(time / self.duration)
    }
    fn speed(&self, time: f64) -> f64 {
        let speed = self.ease.speed(time / self.duration);
        if self.distance == 0.0 {
            0.0
        } else {
            self.distance * speed / self.duration
        }
    }
    fn acceleration(&self, time: f64) -> f64 {
        let acceleration = self.ease.acceleration(time / self.duration);
        self.distance * acceleration / (self.duration * self.duration)
    }
    fn breaks(&self) -> Vec<f64> {
        let mut breaks = vec![0.0];
        breaks.extend(self.ease.breaks().iter().map(|t| t * self.duration));
        breaks.push(self.duration);
        breaks.dedup();
        breaks
    }
}

/// Times and distances beyond this size are refused, so that no product of them leaves the range of numbers.
const LARGEST: f64 = 1e50;

/// Spans and durations below this are refused, for the same reason.
const SHORTEST: f64 = 1e-50;

fn moderate(name: &'static str, value: f64) -> Result<f64, CurveError> {
    if value.abs() <= LARGEST {
        Ok(value)
    } else {
        Err(CurveError::OutOfRange {
            name,
            value,
            range: "a number of at most 1e50 in size",
        })
    }
}

fn positive_duration(duration: f64) -> Result<f64, CurveError> {
    if (SHORTEST..=LARGEST).contains(&duration) {
        Ok(duration)
    } else {
        Err(CurveError::OutOfRange {
            name: "duration",
            value: duration,
            range: "a positive number from 1e-50 to 1e50",
        })
    }
}

/// Refuses key times of which there are fewer than two, that are not finite, do not increase, or begin before 0.
fn key_times(what: &'static str, times: &[f64]) -> Result<(), CurveError> {
    if times.len() < 2 {
        return Err(CurveError::TooFewPoints {
            what,
            needed: 2,
            found: times.len(),
        });
    }
    crate::error::increasing("the time of key", times)?;
    let last = times.len() - 1;
    for index in [0, last] {
        if !(0.0..=LARGEST).contains(&times[index]) {
            return Err(CurveError::ElementOutOfRange {
                what: "the time of key",
                index,
                value: times[index],
                range: "from 0 to 1e50: motion begins at time 0",
            });
        }
    }
    match times
        .windows(2)
        .position(|pair| pair[1] - pair[0] < SHORTEST)
    {
        Some(before) => Err(CurveError::ElementOutOfRange {
            what: "the time of key",
            index: before + 1,
            value: times[before + 1],
            range: "later than the one before it by at least 1e-50",
        }),
        None => Ok(()),
    }
}

/// Refuses a number of a key that is not finite or too large.
fn key_numbers(what: &'static str, numbers: impl Iterator<Item = f64>) -> Result<(), CurveError> {
    for (index, value) in numbers.enumerate() {
        if !value.is_finite() || value.abs() > LARGEST {
            return Err(CurveError::ElementOutOfRange {
                what,
                index,
                value,
                range: "a number of at most 1e50 in size",
            });
        }
    }
    Ok(())
}

/// The spans between keys: where each begins and how long it is; one more before the first key, where that is later than
/// time 0.
fn spans(times: &[f64]) -> impl Iterator<Item = (f64, f64)> + '_ {
    times.windows(2).map(|pair| (pair[0], pair[1] - pair[0]))
}

macro_rules! controlled_by_polynomials {
    ($($control:ty),*) => {$(
        impl SpeedControl for $control {
            fn duration(&self) -> f64 { self.curve.end() }
            fn distance(&self, time: f64) -> f64 { self.curve.value(time) }
            fn speed(&self, time: f64) -> f64 { self.curve.derivative(time, 1) }
            fn acceleration(&self, time: f64) -> f64 { self.curve.derivative(time, 2) }
            fn breaks(&self) -> Vec<f64> { self.curve.breaks().to_vec() }
            fn polynomials(&self) -> Option<&PiecewisePolynomial> { Some(&self.curve) }
        }
    )*};
}
controlled_by_polynomials!(DistanceTime, SpeedTime, AccelerationTime);

#[cfg(test)]
mod tests;
