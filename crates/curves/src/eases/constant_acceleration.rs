//! Constant acceleration, even motion, constant deceleration.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Ease-in: Constant Acceleration": the speed rises evenly to `v₀` at
//! `t₁`, stays, and falls evenly from `t₂` to the end. Errata C12: the distance is 1 with `v₀ = 2/(1 − t₁ + t₂)`.

use super::piecewise_sinusoidal::{finite, inner_breaks};
use super::{Ease, EaseFacts, EaseState, ranged};
use crate::CurveError;
use anamorph_core::Smoothness;

/// Even acceleration up to the time `t1`, even motion up to `t2`, even deceleration to the end. C¹.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantAcceleration {
    t1: f64,
    t2: f64,
    /// The speed in the middle.
    v0: f64,
}

impl ConstantAcceleration {
    /// An ease that reaches its even speed at `t1` and leaves it at `t2`, `0 ≤ t1 ≤ t2 ≤ 1`. Empty parts are allowed.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`].
    pub fn new(t1: f64, t2: f64) -> Result<Self, CurveError> {
        let t1 = ranged("t1", t1, 0.0, 1.0, "from 0 to 1")?;
        let t2 = ranged("t2", t2, t1, 1.0, "from t1 to 1")?;
        let v0 = 2.0 / (1.0 - t1 + t2);
        Ok(Self { t1, t2, v0 })
    }

    /// The even speed in the middle.
    pub fn even_speed(&self) -> f64 {
        self.v0
    }
}

impl Ease for ConstantAcceleration {
    fn state(&self, t: f64) -> EaseState {
        let Self { t1, t2, v0 } = *self;
        if t < t1 {
            EaseState {
                value: 0.5 * v0 * t * (t / t1),
                speed: v0 * (t / t1),
                acceleration: finite(v0 / t1),
            }
        } else if t > t2 {
            let left = 1.0 - t;
            let share = left / (1.0 - t2);
            EaseState {
                value: 1.0 - 0.5 * v0 * left * share,
                speed: v0 * share,
                acceleration: finite(-v0 / (1.0 - t2)),
            }
        } else {
            EaseState {
                value: if t == 1.0 { 1.0 } else { v0 * (t - 0.5 * t1) },
                speed: v0,
                acceleration: 0.0,
            }
        }
    }
    fn facts(&self) -> EaseFacts {
        EaseFacts {
            smoothness: Smoothness::C(1),
            ..EaseFacts::PLAIN
        }
    }
    fn breaks(&self) -> Vec<f64> {
        inner_breaks(self.t1, self.t2)
    }
}
