//! A half of a sine wave, and a quarter of one.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Ease-in: Sinusoidal", `s = (sin(tπ − π/2) + 1)/2`; R. Penner 2002 for
//! the quarter. Here the half is `sin²(πt/2)`, which is the same and keeps its digits near 0.

use super::{Ease, EaseFacts, EaseState};
use anamorph_core::math;
use core::f64::consts::{FRAC_PI_2, PI};

/// The sinusoidal ease `(1 − cos πt)/2`, at rest at both ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sinusoidal;

impl Ease for Sinusoidal {
    fn state(&self, t: f64) -> EaseState {
        let (half_sin, half_cos) = math::sin_cos(FRAC_PI_2 * t);
        EaseState {
            value: half_sin * half_sin,
            // sin(πt)/2 is the product; at the end the half's cosine is not exactly 0.
            speed: PI * half_sin * half_cos,
            acceleration: 0.5 * PI * PI * math::cos(PI * t),
        }
    }
    fn facts(&self) -> EaseFacts {
        EaseFacts::PLAIN
    }
}

/// The profile `1 − cos(πt/2)`, a quarter of a wave.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sine;

impl Ease for Sine {
    fn state(&self, t: f64) -> EaseState {
        let (sin, cos) = math::sin_cos(FRAC_PI_2 * t);
        EaseState {
            // The cosine of the number next to π/2 is not 0.
            value: if t == 1.0 { 1.0 } else { 1.0 - cos },
            speed: FRAC_PI_2 * sin,
            acceleration: FRAC_PI_2 * FRAC_PI_2 * cos,
        }
    }
    fn facts(&self) -> EaseFacts {
        EaseFacts::PLAIN
    }
}
