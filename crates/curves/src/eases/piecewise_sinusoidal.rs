//! Sinusoidal acceleration, even motion, sinusoidal deceleration.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Ease-in: Piecewise Sinusoidal", as corrected by errata C4: the first
//! part is `k₁(2/π)(sin(πt/(2k₁) − π/2) + 1)/f` with `f = 2k₁/π + k₂ − k₁ + 2(1 − k₂)/π`; printed without the `+ 1` it would
//! start below 0. Sums of a sine and 1 are written as squares of sines of half the angle, so that the ends are exact.

use super::{Ease, EaseFacts, EaseState, ranged};
use crate::CurveError;
use anamorph_core::{Smoothness, math};
use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// A sine up to the time `k1`, even motion up to `k2`, a sine to the end. C¹; at rest at an end whose part is not empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiecewiseSinusoidal {
    k1: f64,
    k2: f64,
    /// The distance before it is scaled to 1.
    whole: f64,
}

impl PiecewiseSinusoidal {
    /// An ease that reaches its even speed at `k1` and leaves it at `k2`, `0 ≤ k1 ≤ k2 ≤ 1`. Empty parts (`k1` = 0,
    /// `k2` = 1, `k1` = `k2`) are allowed.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`].
    pub fn new(k1: f64, k2: f64) -> Result<Self, CurveError> {
        let k1 = ranged("k1", k1, 0.0, 1.0, "from 0 to 1")?;
        let k2 = ranged("k2", k2, k1, 1.0, "from k1 to 1")?;
        let whole = 2.0 * k1 / PI + (k2 - k1) + 2.0 * (1.0 - k2) / PI;
        Ok(Self { k1, k2, whole })
    }
}

impl Ease for PiecewiseSinusoidal {
    fn state(&self, t: f64) -> EaseState {
        let Self { k1, k2, whole } = *self;
        if t < k1 {
            let share = t / k1;
            let half = math::sin(FRAC_PI_4 * share);
            let (sin, cos) = math::sin_cos(FRAC_PI_2 * share);
            EaseState {
                value: 4.0 * k1 / PI * half * half / whole,
                speed: sin / whole,
                acceleration: finite(FRAC_PI_2 / k1 * cos / whole),
            }
        } else if t > k2 {
            let (rest, left) = (1.0 - k2, 1.0 - t);
            let share = left / rest;
            let half = math::sin(FRAC_PI_4 * share);
            let (sin, cos) = math::sin_cos(FRAC_PI_2 * share);
            EaseState {
                value: 1.0 - 4.0 * rest / PI * half * half / whole,
                speed: sin / whole,
                acceleration: finite(-FRAC_PI_2 / rest * cos / whole),
            }
        } else if t == 1.0 {
            // No last part.
            EaseState {
                value: 1.0,
                speed: 1.0 / whole,
                acceleration: 0.0,
            }
        } else {
            EaseState {
                value: (2.0 * k1 / PI + (t - k1)) / whole,
                speed: 1.0 / whole,
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
        inner_breaks(self.k1, self.k2)
    }
}

/// The two times without those at the ends and without a repetition.
pub(super) fn inner_breaks(first: f64, second: f64) -> Vec<f64> {
    let mut all = vec![first, second];
    all.dedup();
    all.retain(|&t| t > 0.0 && t < 1.0);
    all
}

/// A part so short that its acceleration overflows.
pub(super) fn finite(acceleration: f64) -> f64 {
    acceleration.clamp(-f64::MAX, f64::MAX)
}
