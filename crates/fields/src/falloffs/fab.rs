//! The paper's `f_αβ`: 1 up to α, 0 from β on, an interpolating cubic in between.
//!
//! *Source*: Milliron et al. 2002, §6 (weights of the mesh warp); errata F14: `α < β`, `β > 0`.
//!
//! Continuity: the cubic meets both constants with slope 0 and curvature not 0, hence C¹ at α and β. With `α = 0` it is
//! the smoothstep, C² at the centre. With `α < 0` it is cut on its slope: a cone at the centre, where it is less than 1.

use super::{Falloff, FalloffFacts};
use crate::FieldError;
use anamorph_core::Smoothness;

/// `f_αβ(t)`: 1 for `t ≤ α`, 0 for `t ≥ β`, the cubic with slope 0 at both ends in between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fab {
    alpha: f64,
    beta: f64,
}

impl Fab {
    /// A plateau up to a quarter of the radius, and 0 at the radius. The paper leaves both to the user.
    pub const DEFAULT: Self = Self {
        alpha: 0.25,
        beta: 1.0,
    };

    /// The function with the given plateau and end, in units of the radius.
    ///
    /// # Errors
    /// [`FieldError::BadPlateau`] unless `α < β`, `β > 0` and both are finite.
    pub fn new(alpha: f64, beta: f64) -> Result<Self, FieldError> {
        let slope = 1.0 / (beta - alpha);
        if alpha < beta && beta > 0.0 && beta.is_finite() && slope.is_finite() && slope > 0.0 {
            Ok(Self { alpha, beta })
        } else {
            Err(FieldError::BadPlateau { alpha, beta })
        }
    }
    /// End of the plateau.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }
    /// Where the function reaches 0.
    pub fn beta(&self) -> f64 {
        self.beta
    }
}

impl Default for Fab {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Falloff for Fab {
    #[inline]
    fn value(&self, t: f64) -> f64 {
        // From the far end, so that nothing cancels there.
        let u = ((self.beta - t) / (self.beta - self.alpha)).clamp(0.0, 1.0);
        u * u * (3.0 - 2.0 * u)
    }
    fn derivative(&self, t: f64) -> f64 {
        let u = ((self.beta - t) / (self.beta - self.alpha)).clamp(0.0, 1.0);
        let rise = 6.0 * u * (1.0 - u) / (self.beta - self.alpha);
        if rise == 0.0 { 0.0 } else { -rise }
    }
    fn facts(&self) -> FalloffFacts {
        let (centre, start) = if self.alpha > 0.0 {
            (Smoothness::C(1), Smoothness::C(1))
        } else if self.alpha == 0.0 {
            (Smoothness::C(2), Smoothness::C(1))
        } else {
            (Smoothness::C(0), Smoothness::Jump)
        };
        FalloffFacts {
            name: "f_ab",
            reach: Some(self.beta),
            centre,
            start,
            edge: Smoothness::C(1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloffs::Smoothstep;

    #[test]
    fn plateau_middle_and_end() {
        let f = Fab::new(0.2, 0.6).unwrap();
        assert_eq!((f.value(0.0), f.value(0.2), f.value(0.6)), (1.0, 1.0, 0.0));
        assert!((f.value(0.4) - 0.5).abs() < 1e-15);
        let whole = Fab::new(0.0, 1.0).unwrap();
        for i in 0..=100 {
            let t = f64::from(i) * 0.01;
            assert!((whole.value(t) - Smoothstep.value(t)).abs() < 1e-15);
        }
    }

    #[test]
    fn errata_f14_bounds() {
        for (alpha, beta) in [
            (1.0, 1.0),
            (0.5, 0.2),
            (-2.0, 0.0),
            (f64::NAN, 1.0),
            (0.0, f64::INFINITY),
        ] {
            let error = Fab::new(alpha, beta).unwrap_err();
            assert!(error.to_string().contains("α must be less than β"));
        }
    }
}
