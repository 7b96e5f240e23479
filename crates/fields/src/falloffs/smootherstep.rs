//! The quintic smoothstep, `1 − (6t⁵ − 15t⁴ + 10t³)`.
//!
//! *Source*: K. Perlin, *Improving Noise*, SIGGRAPH 2002.
//!
//! Continuity: first and second derivatives vanish at both ends and the third does not: C² at the centre (`|x|³`) and at
//! the edge, and C² as a step.

use super::{Falloff, FalloffFacts};
use anamorph_core::Smoothness;

/// `1 − (6t⁵ − 15t⁴ + 10t³)`, and 0 from `t = 1` on. C².
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Smootherstep;

impl Falloff for Smootherstep {
    #[inline]
    fn value(&self, t: f64) -> f64 {
        // By symmetry the polynomial of 1 − t, which does not cancel at the edge.
        let u = (1.0 - t).max(0.0);
        u * u * u * (10.0 + u * (6.0 * u - 15.0))
    }
    fn derivative(&self, t: f64) -> f64 {
        if t < 1.0 {
            let u = t * (1.0 - t);
            -30.0 * u * u
        } else {
            0.0
        }
    }
    fn facts(&self) -> FalloffFacts {
        FalloffFacts {
            name: "smootherstep",
            reach: Some(1.0),
            centre: Smoothness::C(2),
            start: Smoothness::C(2),
            edge: Smoothness::C(2),
        }
    }
}
