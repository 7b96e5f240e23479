//! Powers of the time.
//!
//! *Source*: R. Penner, *Programming Macromedia Flash MX*, 2002, chapter 7: `tⁿ` for n = 2 to 5; here any power from 1.

use super::{Ease, EaseFacts, EaseState, ranged};
use crate::CurveError;
use anamorph_core::math;

/// The profile `tⁿ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power {
    exponent: f64,
}

impl Power {
    /// The square.
    pub const QUAD: Self = Self { exponent: 2.0 };
    /// The third power.
    pub const CUBIC: Self = Self { exponent: 3.0 };
    /// The fourth power.
    pub const QUART: Self = Self { exponent: 4.0 };
    /// The fifth power.
    pub const QUINT: Self = Self { exponent: 5.0 };

    /// The power with an exponent from 1 to 100. Below 1 speed would be infinite at the start; use the other direction.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`].
    pub fn new(exponent: f64) -> Result<Self, CurveError> {
        let exponent = ranged("exponent", exponent, 1.0, 100.0, "from 1 to 100")?;
        Ok(Self { exponent })
    }

    fn raised(t: f64, exponent: f64) -> f64 {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        if exponent.fract() == 0.0 && exponent >= 0.0 {
            // At most 100.
            math::powi(t, exponent as u32)
        } else {
            math::pow(t, exponent)
        }
    }
}

impl Ease for Power {
    fn state(&self, t: f64) -> EaseState {
        let n = self.exponent;
        let second = n * (n - 1.0);
        EaseState {
            value: Self::raised(t, n),
            speed: n * Self::raised(t, n - 1.0),
            // Between 1 and 2 the acceleration is infinite at the start.
            acceleration: if second == 0.0 || (t == 0.0 && n < 2.0) {
                0.0
            } else {
                second * Self::raised(t, n - 2.0)
            },
        }
    }
    fn facts(&self) -> EaseFacts {
        EaseFacts::PLAIN
    }
}
