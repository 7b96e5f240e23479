//! Logarithmic strain: the logarithm of the stretch goes evenly, so that ratios of lengths do.
//!
//! Computes `U(t) = exp(t log U)`, that is `ε(t) = ½(C^t − I)` with `C = I + 2ε_n`. The determinant is a power, so that the area wanted
//! of every element is monotone; no other scheme here has that. From B to A it is the same way back. Targets without area have no logarithm.
//!
//! *Source*: decision, errata S2; the strain is that of H. Hencky, *Über die Form des Elastizitätsgesetzes bei ideal elastischen Stoffen*, 1928.

use super::Scheme;
use crate::strain::Strain;

/// `U(t) = exp(t log U)`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Log;

impl Scheme for Log {
    fn name(&self) -> &'static str {
        "log"
    }
    fn title(&self) -> &'static str {
        "ratios of lengths go evenly; areas are monotone"
    }
    fn strain(&self, target: Strain, t: f64) -> Strain {
        Strain::of_squared_stretch(target.power(t))
    }
    fn needs_area(&self) -> bool {
        true
    }
}
