//! A quarter of a circle.
//!
//! *Source*: R. Penner, *Programming Macromedia Flash MX*, 2002, chapter 7, `1 − √(1 − t²)`; here `t²/(1 + √(1 − t²))`, which
//! keeps its digits near 0.

use super::{Ease, EaseFacts, EaseState};

/// The profile `1 − √(1 − t²)`. Its speed is infinite at `t = 1`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Circular;

impl Ease for Circular {
    fn state(&self, t: f64) -> EaseState {
        let square = (1.0 - t) * (1.0 + t);
        let root = square.sqrt();
        EaseState {
            value: t * t / (1.0 + root),
            speed: t / root,
            acceleration: if root > 0.0 {
                1.0 / (square * root)
            } else {
                0.0
            },
        }
    }
    fn facts(&self) -> EaseFacts {
        EaseFacts {
            finite_speed: false,
            ..EaseFacts::PLAIN
        }
    }
}
