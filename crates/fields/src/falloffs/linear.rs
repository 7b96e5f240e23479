//! The linear falloff, `1 − t`.
//!
//! *Source*: Milliron et al. 2002, §8.5 (distance metrics and falloffs): the plainest one.
//!
//! Continuity: a cone at the centre and a kink at the edge, C⁰ at both.

use super::{Falloff, FalloffFacts};
use anamorph_core::Smoothness;

/// `1 − t`, and 0 from `t = 1` on. C⁰: a crease at the centre and at the edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Linear;

impl Falloff for Linear {
    #[inline]
    fn value(&self, t: f64) -> f64 {
        (1.0 - t).max(0.0)
    }
    fn derivative(&self, t: f64) -> f64 {
        if t < 1.0 { -1.0 } else { 0.0 }
    }
    fn facts(&self) -> FalloffFacts {
        FalloffFacts {
            name: "linear",
            reach: Some(1.0),
            centre: Smoothness::C(0),
            start: Smoothness::C(0),
            edge: Smoothness::C(0),
        }
    }
}
