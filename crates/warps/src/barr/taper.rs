//! Taper: the model is scaled across an axis by a factor that varies along it.
//!
//! Computes `(x, y, z) ↦ (f(ẑ) x, f(ẑ) y, z)` in local coordinates, `ẑ` the coordinate along the axis limited to a range.
//!
//! *Source*: A. H. Barr, *Global and Local Deformations of Solid Primitives*, SIGGRAPH 1984, §3.2 (tapering); Milliron et
//! al. 2002, §4.3.1, Fig. 12 (user-drawn profile). Jacobian: `diag(f, f, 1)` plus `f′ (x, y, 0)` in the last column.

use super::axis::{Course, Law, LocalMap, limited, limited_block, range_note};
use super::{AxialWarp, AxisError, AxisFrame};
use anamorph_core::simd::{self, Simd};
use anamorph_core::{Scaling, Smoothness, Space};
use anamorph_fields::AxisRange;

/// The factor along the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Taper {
    factor: Course,
    range: Option<AxisRange>,
}

impl Taper {
    /// A taper about `frame` by `factor`, a function of the axis coordinate limited to `range`.
    ///
    /// # Errors
    /// [`AxisError::NotFinite`] for a factor that is not finite.
    pub fn construct<S: Space>(
        frame: AxisFrame<S>,
        factor: Course,
        range: Option<AxisRange>,
        scaling: Scaling,
    ) -> Result<AxialWarp<S, Self>, AxisError> {
        if !factor.is_finite() {
            return Err(AxisError::NotFinite { what: "the factor" });
        }
        Ok(AxialWarp::new(frame, Self { factor, range }, scaling))
    }
}

impl Law for Taper {
    fn at(&self, z: f64, strength: f64) -> LocalMap {
        let factor = self
            .factor
            .value_and_slope(limited(self.range.as_ref(), z).0)
            .0;
        let f = if strength == 1.0 {
            factor
        } else {
            1.0 + (factor - 1.0) * strength
        };
        LocalMap {
            linear: [[f, 0.0, 0.0], [0.0, f, 0.0], [0.0, 0.0, 1.0]],
            translation: [0.0; 3],
        }
    }
    fn slope(&self, z: f64) -> LocalMap {
        let (limited, rate) = limited(self.range.as_ref(), z);
        let slope = self.factor.value_and_slope(limited).1 * rate;
        LocalMap {
            linear: [[slope, 0.0, 0.0], [0.0, slope, 0.0], [0.0; 3]],
            translation: [0.0; 3],
        }
    }
    #[inline(always)]
    fn map_block<V: Simd>(&self, v: V, q: simd::Block<V>) -> simd::Block<V> {
        let factor = self
            .factor
            .block(v, limited_block(v, self.range.as_ref(), q[2]));
        [factor * q[0], factor * q[1], q[2]]
    }
    fn smoothness(&self) -> Smoothness {
        self.range
            .as_ref()
            .map_or(Smoothness::Smooth, AxisRange::smoothness)
            .min(self.factor.smoothness())
    }
    fn range(&self) -> Option<&AxisRange> {
        self.range.as_ref()
    }
    fn notes(&self) -> Vec<String> {
        range_note(self.range.as_ref())
    }
    fn upright(&self) -> Option<String> {
        let positive = self.factor.is_positive(self.range.as_ref());
        positive.then(|| "every slice across the axis is scaled by a positive factor".to_owned())
    }
    fn inverse(&self, q: [f64; 3]) -> Option<[f64; 3]> {
        let factor = self
            .factor
            .value_and_slope(limited(self.range.as_ref(), q[2]).0)
            .0;
        let back = [q[0] / factor, q[1] / factor, q[2]];
        back.iter().all(|c| c.is_finite()).then_some(back)
    }
    fn is_identity(&self) -> bool {
        self.factor.is_constant(1.0)
    }
}
