//! Even motion, the single cubic and the quintic.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Ease-in: Single Cubic", `s = −2t³ + 3t²`; K. Perlin, *Improving
//! Noise*, SIGGRAPH 2002, for the quintic `6t⁵ − 15t⁴ + 10t³`, whose acceleration vanishes at the ends, too.

use super::{Ease, EaseFacts, EaseState};

/// Even motion, `s = t`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Linear;

impl Ease for Linear {
    fn state(&self, t: f64) -> EaseState {
        EaseState {
            value: t,
            speed: 1.0,
            acceleration: 0.0,
        }
    }
    fn facts(&self) -> EaseFacts {
        EaseFacts::PLAIN
    }
}

/// The single cubic `3t² − 2t³`, at rest at both ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cubic;

impl Ease for Cubic {
    fn state(&self, t: f64) -> EaseState {
        EaseState {
            value: t * t * (3.0 - 2.0 * t),
            speed: 6.0 * t * (1.0 - t),
            acceleration: 6.0 - 12.0 * t,
        }
    }
    fn facts(&self) -> EaseFacts {
        EaseFacts::PLAIN
    }
}

/// The quintic `10t³ − 15t⁴ + 6t⁵`, at rest and without acceleration at both ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Quintic;

impl Ease for Quintic {
    fn state(&self, t: f64) -> EaseState {
        let rest = t * (1.0 - t);
        EaseState {
            value: t * t * t * (10.0 + t * (6.0 * t - 15.0)),
            speed: 30.0 * rest * rest,
            acceleration: 60.0 * rest * (1.0 - 2.0 * t),
        }
    }
    fn facts(&self) -> EaseFacts {
        EaseFacts::PLAIN
    }
}
