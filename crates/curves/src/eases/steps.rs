//! `steps(n, position)` of style sheets.
//!
//! *Source*: W3C, *CSS Easing Functions Level 2*, "Step easing functions".

use super::{Ease, EaseFacts, EaseState};
use crate::CurveError;
use anamorph_core::Smoothness;

/// Where the jumps are, in relation to the intervals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StepPosition {
    /// At the start of each interval: `jump-start`, the first jump at time 0.
    Start,
    /// At the end of each: `jump-end`, the last jump at time 1.
    #[default]
    End,
    /// Between the intervals alone: `jump-none`, from 0 to 1 with a rest at both ends.
    None,
    /// At the start, the end and between: `jump-both`.
    Both,
}

impl StepPosition {
    /// The words of style sheets, with the position of each.
    pub const WORDS: [(&'static str, Self); 6] = [
        ("jump-start", Self::Start),
        ("jump-end", Self::End),
        ("jump-none", Self::None),
        ("jump-both", Self::Both),
        ("start", Self::Start),
        ("end", Self::End),
    ];
}

/// A staircase. What is right at a jump is its upper side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Steps {
    count: u32,
    position: StepPosition,
}

/// The most steps: jumps can be listed.
const MOST: f64 = 1e6;

impl Steps {
    /// The keyword `step-start`.
    pub const STEP_START: Self = Self {
        count: 1,
        position: StepPosition::Start,
    };
    /// The keyword `step-end`.
    pub const STEP_END: Self = Self {
        count: 1,
        position: StepPosition::End,
    };

    /// A number of intervals, from 1 (2 with [`StepPosition::None`]) to a million.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`].
    pub fn new(count: f64, position: StepPosition) -> Result<Self, CurveError> {
        let (least, range) = match position {
            StepPosition::None => (2.0, "a whole number from 2 to 1000000 with jump-none"),
            _ => (1.0, "a whole number from 1 to 1000000"),
        };
        if !((least..=MOST).contains(&count) && count.fract() == 0.0) {
            return Err(CurveError::OutOfRange {
                name: "count",
                value: count,
                range,
            });
        }
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let count = count as u32;
        Ok(Self { count, position })
    }
}

impl Ease for Steps {
    fn state(&self, t: f64) -> EaseState {
        let intervals = f64::from(self.count);
        let (jumps, first) = match self.position {
            StepPosition::Start => (intervals, 1.0),
            StepPosition::End => (intervals, 0.0),
            StepPosition::None => (intervals - 1.0, 0.0),
            StepPosition::Both => (intervals + 1.0, 1.0),
        };
        let step = ((t * intervals).floor() + first).min(jumps);
        EaseState {
            value: step / jumps,
            speed: 0.0,
            acceleration: 0.0,
        }
    }
    fn facts(&self) -> EaseFacts {
        EaseFacts {
            starts_at_zero: matches!(self.position, StepPosition::End | StepPosition::None),
            smoothness: if self.count == 1 {
                Smoothness::Smooth
            } else {
                Smoothness::Jump
            },
            ..EaseFacts::PLAIN
        }
    }
    fn breaks(&self) -> Vec<f64> {
        let intervals = f64::from(self.count);
        (1..self.count).map(|i| f64::from(i) / intervals).collect()
    }
}
