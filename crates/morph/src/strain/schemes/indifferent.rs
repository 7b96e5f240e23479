//! Frame-indifferent strain: the stretch of the polar decomposition goes evenly, whatever the axes.
//!
//! Computes `U² = I + 2ε_n`, `U(t) = (1 − t) I + t U`, `ε(t) = ½(U(t)² − I)`. Lengths along the principal directions go evenly; under pure
//! stretch along the axes it is eq. (3).
//!
//! *Source*: decision, errata S2, after eq. (3) of H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004.

use super::Scheme;
use crate::strain::Strain;

/// `U(t) = (1 − t) I + t U`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Indifferent;

impl Scheme for Indifferent {
    fn name(&self) -> &'static str {
        "indifferent"
    }
    fn title(&self) -> &'static str {
        "principal stretches go evenly, whatever the axes"
    }
    fn strain(&self, target: Strain, t: f64) -> Strain {
        let u = target.stretch();
        // ½(U(t)² − I) with G = t(U − I): G + ½G², without the difference of numbers near 1.
        let (x, y, xy) = (t * (u.xx - 1.0), t * (u.yy - 1.0), t * u.xy);
        Strain {
            x: x + 0.5 * (x * x + xy * xy),
            y: y + 0.5 * (y * y + xy * xy),
            shear: 2.0 * xy + xy * (x + y),
        }
    }
}
