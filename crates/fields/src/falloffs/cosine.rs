//! The raised cosine, `½(1 + cos πt)`.
//!
//! *Source*: R. B. Blackman and J. W. Tukey, *The Measurement of Power Spectra*, 1958 (the window named after J. von
//! Hann).
//!
//! Continuity: even in `t`, smooth at the centre; `f′(1) = 0` and `f″(1) = π²/2`, hence C¹ at the edge.

use super::{Falloff, FalloffFacts};
use anamorph_core::{Smoothness, math};
use core::f64::consts::PI;

/// `½(1 + cos πt)`, and 0 from `t = 1` on. C¹.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Cosine;

/// `½(1 + cos πt) = cos²(πt/2)` is the square of the sine of this angle, which does not cancel at the edge.
#[inline(always)]
fn angle(t: f64) -> f64 {
    0.5 * PI * (1.0 - t).max(0.0)
}

impl Falloff for Cosine {
    #[inline]
    fn value(&self, t: f64) -> f64 {
        let sin = math::sin(angle(t));
        sin * sin
    }
    fn derivative(&self, t: f64) -> f64 {
        if t < 1.0 {
            -0.5 * PI * math::sin(PI * t)
        } else {
            0.0
        }
    }
    fn facts(&self) -> FalloffFacts {
        FalloffFacts {
            name: "cosine",
            reach: Some(1.0),
            centre: Smoothness::Smooth,
            start: Smoothness::C(1),
            edge: Smoothness::C(1),
        }
    }
}
