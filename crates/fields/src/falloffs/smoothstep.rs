//! The cubic smoothstep, `1 − (3t² − 2t³)`.
//!
//! *Source*: the interpolating cubic of Milliron et al. 2002, §6, over the whole radius; D. Ebert et al., *Texturing and
//! Modeling*, 1994 (`smoothstep`).
//!
//! Continuity: `t³` is the lowest odd power, and `|x|³` is C² at the centre; at the edge `f″(1) = 6`, hence C¹.

use super::{Falloff, FalloffFacts};
use anamorph_core::Smoothness;

/// `1 − (3t² − 2t³)`, and 0 from `t = 1` on. C¹.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Smoothstep;

impl Falloff for Smoothstep {
    #[inline]
    fn value(&self, t: f64) -> f64 {
        // (1 − t)²(1 + 2t) does not cancel at the edge.
        let inside = (1.0 - t).max(0.0);
        inside * inside * (3.0 - 2.0 * inside)
    }
    fn derivative(&self, t: f64) -> f64 {
        if t < 1.0 { -6.0 * t * (1.0 - t) } else { 0.0 }
    }
    fn facts(&self) -> FalloffFacts {
        FalloffFacts {
            name: "smoothstep",
            reach: Some(1.0),
            centre: Smoothness::C(2),
            start: Smoothness::C(1),
            edge: Smoothness::C(1),
        }
    }
}
