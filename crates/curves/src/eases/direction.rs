//! In, out and in-out: a profile that starts slowly, reversed, or both halves of each.
//!
//! *Source*: R. Penner, *Programming Macromedia Flash MX*, 2002, chapter 7. With the profile `f`: out is `1 − f(1 − t)`,
//! in-out is `f(2t)/2` in the first half and `1 − f(2 − 2t)/2` in the second, out-in the halves the other way round.

use super::{Ease, EaseFacts, EaseState};
use anamorph_core::Smoothness;

/// Where an ease is slow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// At the start: the profile as it is.
    #[default]
    In,
    /// At the end: the profile reversed.
    Out,
    /// At both ends.
    InOut,
    /// In the middle.
    OutIn,
}

/// A profile in one of the directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directed<E> {
    /// The ease for [`Direction::In`].
    pub profile: E,
    /// The direction.
    pub direction: Direction,
}

impl<E: Ease> Directed<E> {
    /// A profile in a direction.
    pub fn new(profile: E, direction: Direction) -> Self {
        Self { profile, direction }
    }

    fn reversed(&self, t: f64) -> EaseState {
        let state = self.profile.state(1.0 - t);
        EaseState {
            value: 1.0 - state.value,
            speed: state.speed,
            acceleration: -state.acceleration,
        }
    }
}

/// A half of the time, filled with a state at twice the speed.
fn half(state: EaseState, offset: f64) -> EaseState {
    EaseState {
        value: offset + 0.5 * state.value,
        speed: state.speed,
        acceleration: 2.0 * state.acceleration,
    }
}

impl<E: Ease> Ease for Directed<E> {
    fn state(&self, t: f64) -> EaseState {
        let first = t < 0.5;
        match self.direction {
            Direction::In => self.profile.state(t),
            Direction::Out => self.reversed(t),
            Direction::InOut if first => half(self.profile.state(2.0 * t), 0.0),
            Direction::InOut => half(self.reversed(2.0 * t - 1.0), 0.5),
            Direction::OutIn if first => half(self.reversed(2.0 * t), 0.0),
            Direction::OutIn => half(self.profile.state(2.0 * t - 1.0), 0.5),
        }
    }

    fn facts(&self) -> EaseFacts {
        let facts = self.profile.facts();
        let (starts, ends) = (facts.starts_at_zero, facts.ends_at_one);
        // The halves mirror each other about the middle: their speeds agree there, their accelerations are opposite.
        let joint = match (facts.finite_speed, starts && ends) {
            (_, false) => Smoothness::Jump,
            (false, _) => Smoothness::C(0),
            (true, true) => Smoothness::C(1),
        };
        match self.direction {
            Direction::In => facts,
            Direction::Out => EaseFacts {
                starts_at_zero: ends,
                ends_at_one: starts,
                ..facts
            },
            Direction::InOut => EaseFacts {
                ends_at_one: starts,
                smoothness: facts.smoothness.min(joint),
                ..facts
            },
            Direction::OutIn => EaseFacts {
                starts_at_zero: ends,
                smoothness: facts.smoothness.min(joint),
                ..facts
            },
        }
    }

    fn breaks(&self) -> Vec<f64> {
        let forward = self.profile.breaks();
        let backward: Vec<f64> = forward.iter().rev().map(|t| 1.0 - t).collect();
        let (first, second) = match self.direction {
            Direction::In => return forward,
            Direction::Out => return backward,
            Direction::InOut => (forward, backward),
            Direction::OutIn => (backward, forward),
        };
        let mut all: Vec<f64> = first.iter().map(|t| 0.5 * t).collect();
        all.push(0.5);
        all.extend(second.iter().map(|t| 0.5 + 0.5 * t));
        all
    }
}
