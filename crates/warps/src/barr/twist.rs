//! Twist: the model is turned about an axis by an angle that varies along it.
//!
//! Computes `(x, y, z) ↦ (x cos θ − y sin θ, x sin θ + y cos θ, z)`, `θ = θ(ẑ)`, in local coordinates. It keeps volume for
//! any `θ(z)`.
//!
//! *Source*: A. H. Barr, *Global and Local Deformations of Solid Primitives*, SIGGRAPH 1984, §3.3 (global axial twists).

use super::axis::{Course, Law, LocalMap, limited, limited_block, range_note};
use super::{AxialWarp, AxisError, AxisFrame};
use anamorph_core::simd::{self, Simd};
use anamorph_core::{Scaling, Smoothness, Space, math};
use anamorph_fields::AxisRange;

/// The angle along the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Twist {
    angle: Course,
    range: Option<AxisRange>,
}

impl Twist {
    /// A twist about `frame`'s axis by `angle` (radians, by the right-hand rule), a function of the axis coordinate
    /// limited to `range`.
    ///
    /// # Errors
    /// [`AxisError::NoPlane`] in the plane, where there is nothing to turn about; [`AxisError::NotFinite`] for an angle
    /// that is not finite.
    pub fn construct<S: Space>(
        frame: AxisFrame<S>,
        angle: Course,
        range: Option<AxisRange>,
        scaling: Scaling,
    ) -> Result<AxialWarp<S, Self>, AxisError> {
        if S::DIM == 2 {
            return Err(AxisError::NoPlane { what: "twist" });
        }
        if !angle.is_finite() {
            return Err(AxisError::NotFinite { what: "the angle" });
        }
        Ok(AxialWarp::new(frame, Self { angle, range }, scaling))
    }
}

impl Law for Twist {
    fn at(&self, z: f64, strength: f64) -> LocalMap {
        let angle = self
            .angle
            .value_and_slope(limited(self.range.as_ref(), z).0)
            .0
            * strength;
        let (sin, cos) = math::sin_cos(angle);
        LocalMap {
            linear: [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]],
            translation: [0.0; 3],
        }
    }
    fn slope(&self, z: f64) -> LocalMap {
        let (limited, rate) = limited(self.range.as_ref(), z);
        let (angle, slope) = self.angle.value_and_slope(limited);
        let (sin, cos) = math::sin_cos(angle);
        let turn = slope * rate;
        LocalMap {
            linear: [
                [-sin * turn, -cos * turn, 0.0],
                [cos * turn, -sin * turn, 0.0],
                [0.0; 3],
            ],
            translation: [0.0; 3],
        }
    }
    #[inline(always)]
    fn map_block<V: Simd>(&self, v: V, q: simd::Block<V>) -> simd::Block<V> {
        let angle = self
            .angle
            .block(v, limited_block(v, self.range.as_ref(), q[2]));
        let (sin, cos) = simd::sin_cos(v, angle);
        [q[0] * cos - q[1] * sin, q[0] * sin + q[1] * cos, q[2]]
    }
    fn smoothness(&self) -> Smoothness {
        self.range
            .as_ref()
            .map_or(Smoothness::Smooth, AxisRange::smoothness)
            .min(self.angle.smoothness())
    }
    fn range(&self) -> Option<&AxisRange> {
        self.range.as_ref()
    }
    fn notes(&self) -> Vec<String> {
        range_note(self.range.as_ref())
    }
    fn upright(&self) -> Option<String> {
        Some("every slice across the axis is turned as a whole".to_owned())
    }
    fn inverse(&self, q: [f64; 3]) -> Option<[f64; 3]> {
        let angle = self
            .angle
            .value_and_slope(limited(self.range.as_ref(), q[2]).0)
            .0;
        let (sin, cos) = math::sin_cos(angle);
        Some([q[0] * cos + q[1] * sin, q[1] * cos - q[0] * sin, q[2]])
    }
    fn is_identity(&self) -> bool {
        self.angle.is_constant(0.0)
    }
}
