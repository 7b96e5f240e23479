//! Linear strain: every component goes evenly to that of the target.
//!
//! Computes `ε(t) = t ε_n`, eq. (2) as errata S1 reads it (it is printed the other way round). Squared lengths go evenly: the square of a
//! length that doubles is 2.5 half way, so that large strains are uneven in time.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004, eq. (2).

use super::Scheme;
use crate::strain::Strain;

/// `ε(t) = t ε_n`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Linear;

impl Scheme for Linear {
    fn name(&self) -> &'static str {
        "linear"
    }
    fn title(&self) -> &'static str {
        "strains, and with them squared lengths, go evenly"
    }
    fn strain(&self, target: Strain, t: f64) -> Strain {
        Strain {
            x: t * target.x,
            y: t * target.y,
            shear: t * target.shear,
        }
    }
}
