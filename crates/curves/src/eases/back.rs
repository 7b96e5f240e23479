//! A step back to take a run.
//!
//! *Source*: R. Penner, *Programming Macromedia Flash MX*, 2002, chapter 7: `t²((o + 1)t − o)`. With the usual `o` = 1.70158
//! it goes back by a tenth of the distance; in-out uses 1.525 times as much, so that each half goes back by nearly as far.

use super::{Directed, Direction, Ease, EaseFacts, EaseState, ranged};
use crate::CurveError;

/// How much more in-out takes, so that a half of the size goes back by a tenth, too.
const IN_OUT: f64 = 1.525;

/// The profile `t²(t + o(t − 1))`, which goes below 0 first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Back {
    overshoot: f64,
}

impl Default for Back {
    fn default() -> Self {
        Self { overshoot: 1.70158 }
    }
}

impl Back {
    /// A run-up with the coefficient `overshoot`, from 0 (a cubic) to 100. It goes back by `4o³/(27(o + 1)²)`.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`].
    pub fn new(overshoot: f64) -> Result<Self, CurveError> {
        let overshoot = ranged("overshoot", overshoot, 0.0, 100.0, "from 0 to 100")?;
        Ok(Self { overshoot })
    }

    /// The profile in a direction; in-out and out-in take 1.525 times the coefficient.
    pub fn directed(self, direction: Direction) -> Directed<Self> {
        let overshoot = match direction {
            Direction::In | Direction::Out => self.overshoot,
            Direction::InOut | Direction::OutIn => IN_OUT * self.overshoot,
        };
        Directed::new(Self { overshoot }, direction)
    }
}

impl Ease for Back {
    fn state(&self, t: f64) -> EaseState {
        let o = self.overshoot;
        EaseState {
            value: t * t * (t + o * (t - 1.0)),
            speed: t * (3.0 * (o + 1.0) * t - 2.0 * o),
            acceleration: 6.0 * (o + 1.0) * t - 2.0 * o,
        }
    }
    fn facts(&self) -> EaseFacts {
        EaseFacts {
            monotone: self.overshoot == 0.0,
            ..EaseFacts::PLAIN
        }
    }
}
