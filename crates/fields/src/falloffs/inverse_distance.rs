//! Inverse distance, `1/t^p`.
//!
//! *Source*: D. Shepard, *A Two-Dimensional Interpolation Function for Irregularly-Spaced Data*, ACM National Conference
//! 1968; errata F6 (an infinite weight decides alone).
//!
//! Continuity: infinite at the centre, so that what counts is `1/f = t^p`: smooth for even `p`, otherwise C^(⌈p⌉−1). No
//! edge.

use super::{Falloff, FalloffFacts};
use crate::FieldError;
use anamorph_core::{Smoothness, math};

/// `1/t^p`: infinite at 0, never 0. A weight, not a strength or mask.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InverseDistance {
    power: f64,
}

impl InverseDistance {
    /// The inverse square.
    pub const DEFAULT: Self = Self { power: 2.0 };

    /// The falloff with power `p`.
    ///
    /// # Errors
    /// [`FieldError::NotPositive`] or [`FieldError::NotFinite`] for the power.
    pub fn new(power: f64) -> Result<Self, FieldError> {
        crate::error::reciprocal(power, "power")?;
        Ok(Self { power })
    }
    /// The power `p`.
    pub fn power(&self) -> f64 {
        self.power
    }
}

impl Default for InverseDistance {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Falloff for InverseDistance {
    fn value(&self, t: f64) -> f64 {
        if self.power == 2.0 {
            1.0 / (t * t)
        } else {
            math::pow(t, -self.power)
        }
    }
    fn derivative(&self, t: f64) -> f64 {
        -self.power * self.value(t) / t
    }
    fn facts(&self) -> FalloffFacts {
        let order = self.power.ceil() - 1.0;
        let centre = if self.power % 2.0 == 0.0 || order > 250.0 {
            Smoothness::Smooth
        } else {
            // At most 250, see above.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            Smoothness::C(order as u8)
        };
        FalloffFacts {
            name: "inverse-distance",
            reach: None,
            centre,
            start: Smoothness::Jump,
            edge: Smoothness::Smooth,
        }
    }
    fn value_of_square(&self, q: f64) -> f64 {
        if self.power == 2.0 {
            1.0 / q
        } else {
            math::pow(q, -0.5 * self.power)
        }
    }
}
