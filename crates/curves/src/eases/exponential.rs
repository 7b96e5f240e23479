//! Exponential growth.
//!
//! *Source*: R. Penner, *Programming Macromedia Flash MX*, 2002, chapter 7, `2^(10(t − 1))`. That starts at 1/1024 and is
//! usually set to 0 at `t = 0`, a jump; here it is `(2^(rt) − 1)/(2^r − 1)`, which starts at 0 and differs by less than
//! 1/1024 at the usual rate `r = 10`.

use super::{Ease, EaseFacts, EaseState, ranged};
use crate::CurveError;
use anamorph_core::math;
use core::f64::consts::LN_2;

/// The profile `(2^(rt) − 1)/(2^r − 1)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponential {
    rate: f64,
}

impl Default for Exponential {
    fn default() -> Self {
        Self { rate: 10.0 }
    }
}

impl Exponential {
    /// Growth that doubles `rate` times, from 0.1 to 100.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`].
    pub fn new(rate: f64) -> Result<Self, CurveError> {
        let rate = ranged("rate", rate, 0.1, 100.0, "from 0.1 to 100")?;
        Ok(Self { rate })
    }
}

impl Ease for Exponential {
    fn state(&self, t: f64) -> EaseState {
        let growth = self.rate * LN_2;
        let (now, last) = (math::exp(growth * t), math::exp(growth));
        let whole = last - 1.0;
        EaseState {
            value: (now - 1.0) / whole,
            speed: growth * now / whole,
            acceleration: growth * growth * now / whole,
        }
    }
    fn facts(&self) -> EaseFacts {
        EaseFacts::PLAIN
    }
}
