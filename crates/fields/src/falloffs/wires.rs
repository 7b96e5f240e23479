//! The falloff of Wires, `(1 − t²)²`.
//!
//! *Source*: K. Singh and E. Fiume, *Wires: A Geometric Deformation Technique*, SIGGRAPH 1998, §3.1.
//!
//! Continuity: a polynomial in `t²`, smooth at the centre; a double root at `t = 1`, hence C¹ at the edge.

use super::{Falloff, FalloffFacts};
use anamorph_core::Smoothness;

/// `(1 − t²)²`, and 0 from `t = 1` on. C¹; needs no square root.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Wires;

impl Falloff for Wires {
    #[inline]
    fn value(&self, t: f64) -> f64 {
        self.value_of_square(t * t)
    }
    fn derivative(&self, t: f64) -> f64 {
        if t < 1.0 {
            -4.0 * t * (1.0 - t * t)
        } else {
            0.0
        }
    }
    fn facts(&self) -> FalloffFacts {
        FalloffFacts {
            name: "wires",
            reach: Some(1.0),
            centre: Smoothness::Smooth,
            start: Smoothness::C(1),
            edge: Smoothness::C(1),
        }
    }
    #[inline]
    fn value_of_square(&self, q: f64) -> f64 {
        let inside = (1.0 - q).max(0.0);
        inside * inside
    }
}
