//! A growing oscillation, as of something on a rubber band.
//!
//! *Source*: R. Penner, *Programming Macromedia Flash MX*, 2002, chapter 7: `−a 2^(10(t−1)) sin(2π(t − 1 − s)/p)` with
//! `s = p/(2π)·asin(1/a)`. Written out, that is `2^(10(t−1)) (cos x − √(a² − 1) sin x)` with `x = 2π(t − 1)/p`. The envelope
//! here is `(2^(10t) − 1)/(2^10 − 1)`, which starts at 0 rather than being set to it, and differs by less than 1/1024.

use super::{Directed, Direction, Ease, EaseFacts, EaseState, Exponential, ranged};
use crate::CurveError;
use anamorph_core::math;
use core::f64::consts::TAU;

/// How much longer the period of in-out is, so that a half of the time has as many swings.
const IN_OUT: f64 = 1.5;

/// The profile of an oscillation that grows to the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastic {
    amplitude: f64,
    period: f64,
}

impl Default for Elastic {
    fn default() -> Self {
        Self {
            amplitude: 1.0,
            period: 0.3,
        }
    }
}

impl Elastic {
    /// An oscillation with an amplitude from 1 to 100 and a period from 0.01 to 100 times the duration.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`].
    pub fn new(amplitude: f64, period: f64) -> Result<Self, CurveError> {
        Ok(Self {
            amplitude: ranged("amplitude", amplitude, 1.0, 100.0, "from 1 to 100")?,
            period: ranged("period", period, 0.01, 100.0, "from 0.01 to 100")?,
        })
    }

    /// The profile in a direction; in-out and out-in take 1.5 times the period.
    pub fn directed(self, direction: Direction) -> Directed<Self> {
        let period = match direction {
            Direction::In | Direction::Out => self.period,
            Direction::InOut | Direction::OutIn => IN_OUT * self.period,
        };
        Directed::new(Self { period, ..self }, direction)
    }
}

impl Ease for Elastic {
    fn state(&self, t: f64) -> EaseState {
        let envelope = Exponential::default().state(t);
        let rate = TAU / self.period;
        let (sin, cos) = math::sin_cos(rate * (t - 1.0));
        let lift = ((self.amplitude - 1.0) * (self.amplitude + 1.0)).sqrt();
        let wave = cos - lift * sin;
        let slope = -rate * (sin + lift * cos);
        EaseState {
            value: envelope.value * wave,
            speed: envelope.speed * wave + envelope.value * slope,
            acceleration: envelope.acceleration * wave + 2.0 * envelope.speed * slope
                - envelope.value * rate * rate * wave,
        }
    }
    fn facts(&self) -> EaseFacts {
        EaseFacts {
            // Even the slowest swing may turn back; none is promised not to.
            monotone: false,
            ..EaseFacts::PLAIN
        }
    }
}
