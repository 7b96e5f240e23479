//! Bounces of a ball, each lower by the same ratio.
//!
//! *Source*: R. Penner, *Programming Macromedia Flash MX*, 2002, chapter 7, has three bounces of 1/4, 1/16 and 1/64 of the
//! height. That is free fall with a restitution of 1/2: the ball leaves the floor at half the speed at which it arrives. With
//! the restitution `e` and `n` bounces the first fall lasts `T = 1/(1 + 2(e + e² + … + eⁿ))`.

use super::{Ease, EaseFacts, EaseState, ranged};
use crate::CurveError;
use anamorph_core::Smoothness;

/// The profile: bounces that grow, and a rise from the last to 1. Out is the ball that falls and comes to rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounce {
    /// The times at which the falling ball touches the floor, increasing, the last 1.
    touches: Vec<f64>,
}

impl Default for Bounce {
    fn default() -> Self {
        Self::with(3, 0.5)
    }
}

impl Bounce {
    /// From 0 to 30 bounces with a restitution from 0.01 to 1 (1: each as high as the first fall).
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`].
    pub fn new(bounces: f64, restitution: f64) -> Result<Self, CurveError> {
        let bounces = ranged("bounces", bounces, 0.0, 30.0, "a whole number from 0 to 30")?;
        if bounces.fract() != 0.0 {
            return Err(CurveError::OutOfRange {
                name: "bounces",
                value: bounces,
                range: "a whole number from 0 to 30",
            });
        }
        let restitution = ranged("restitution", restitution, 0.01, 1.0, "from 0.01 to 1")?;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        Ok(Self::with(bounces as u32, restitution))
    }

    fn with(bounces: u32, restitution: f64) -> Self {
        let (mut touches, mut time, mut width) = (vec![1.0], 1.0, 2.0);
        for _ in 0..bounces {
            width *= restitution;
            time += width;
            touches.push(time);
        }
        for touch in &mut touches {
            // The last is exactly 1. Bounces narrower than the spacing of numbers there vanish.
            *touch /= time;
        }
        touches.dedup();
        Self { touches }
    }
}

impl Ease for Bounce {
    fn state(&self, t: f64) -> EaseState {
        let u = 1.0 - t;
        let fall = self.touches[0];
        // Height of the falling ball: 1 − (u/T)², and (u − a)(b − u)/T² between two touches.
        let pull = 1.0 / (fall * fall);
        let next = self.touches.partition_point(|&touch| touch < u);
        let (value, slope) = match (next, self.touches.get(next)) {
            (0, _) => ((fall - u) * (fall + u) * pull, -2.0 * u * pull),
            (_, Some(&b)) => {
                let a = self.touches[next - 1];
                ((u - a) * (b - u) * pull, (a + b - 2.0 * u) * pull)
            }
            (_, None) => (0.0, 0.0),
        };
        EaseState {
            value: if t == 1.0 { 1.0 } else { value },
            speed: -slope,
            acceleration: -2.0 * pull,
        }
    }
    fn facts(&self) -> EaseFacts {
        EaseFacts {
            monotone: self.touches.len() == 1,
            smoothness: if self.touches.len() == 1 {
                Smoothness::Smooth
            } else {
                Smoothness::C(0)
            },
            ..EaseFacts::PLAIN
        }
    }
    fn breaks(&self) -> Vec<f64> {
        let inner = self.touches.iter().rev().map(|touch| 1.0 - touch);
        inner.filter(|&t| t > 0.0 && t < 1.0).collect()
    }
}
