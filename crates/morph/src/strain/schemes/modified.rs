//! Modified strain: lengths along x and y go evenly, and so does the arc tangent of the shear.
//!
//! Computes `ε(t) = ½((t √(1 + 2ε_n) + 1 − t)² − 1)` along both axes and `γ(t) = tan(t arctan γ_n)`, eq. (3) as printed. It depends on where
//! the axes of the source lie: the same two shapes turned together go another way (errata S2). Under a root is what is never
//! negative but for rounding (S3).
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004, eq. (3).

use super::Scheme;
use crate::strain::Strain;
use anamorph_core::math;

/// Eq. (3) as printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Modified;

impl Scheme for Modified {
    fn name(&self) -> &'static str {
        "modified"
    }
    fn title(&self) -> &'static str {
        "lengths along the axes go evenly; depends on where the axes lie"
    }
    fn strain(&self, target: Strain, t: f64) -> Strain {
        let along = |strain: f64| {
            let gained = t * ((1.0 + 2.0 * strain).max(0.0).sqrt() - 1.0);
            gained + 0.5 * gained * gained
        };
        Strain {
            x: along(target.x),
            y: along(target.y),
            shear: math::tan(t * math::atan2(target.shear, 1.0)),
        }
    }
}
