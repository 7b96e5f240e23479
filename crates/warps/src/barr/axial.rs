//! The generalized Barr deformation: scaling across, turning about and shifting from an axis, each drawn along it.
//!
//! Computes `T(ẑ)`: in local coordinates the point `(x, y, z)` is scaled by `(fx, fy)` across the axis, turned by `θ` about
//! it, and shifted by `(dx, dy, dz)`, each a function of the limited axis coordinate.
//!
//! *Source*: A. H. Barr, *Global and Local Deformations of Solid Primitives*, SIGGRAPH 1984, §4; generalized as in Milliron
//! et al. 2002, §4.3.2: any single transformation that varies along an axis.

use super::axis::{Course, Law, LocalMap, limited, range_note};
use super::{AxialWarp, AxisError, AxisFrame};
use anamorph_core::{Scaling, Smoothness, Space, math};
use anamorph_fields::AxisRange;

/// The transformation along the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axial {
    /// Factors along local `x` and `y`.
    pub factors: [Course; 2],
    /// Angle about the axis in radians; ignored in the plane.
    pub turn: Course,
    /// Shifts along local `x`, `y` and `z`.
    pub shifts: [Course; 3],
    /// Limits along the axis.
    pub range: Option<AxisRange>,
}

impl Axial {
    /// The deformation by this law about `frame`'s axis.
    ///
    /// # Errors
    /// [`AxisError::NotFinite`] for a course that is not finite; [`AxisError::NoPlane`] for a turn in the plane.
    pub fn construct<S: Space>(
        self,
        frame: AxisFrame<S>,
        scaling: Scaling,
    ) -> Result<AxialWarp<S, Self>, AxisError> {
        if S::DIM == 2 && !self.turn.is_constant(0.0) {
            return Err(AxisError::NoPlane {
                what: "turn about an axis",
            });
        }
        let courses = self.factors.iter().chain([&self.turn]).chain(&self.shifts);
        if courses.into_iter().any(|course| !course.is_finite()) {
            return Err(AxisError::NotFinite {
                what: "a factor, turn or shift",
            });
        }
        Ok(AxialWarp::new(frame, self, scaling))
    }
}

impl Law for Axial {
    fn at(&self, z: f64, strength: f64) -> LocalMap {
        let limited = limited(self.range.as_ref(), z).0;
        let value = |course: &Course| course.value_and_slope(limited).0;
        let scale = |factor: f64| {
            if strength == 1.0 {
                factor
            } else {
                1.0 + (factor - 1.0) * strength
            }
        };
        let (fx, fy) = (
            scale(value(&self.factors[0])),
            scale(value(&self.factors[1])),
        );
        let (sin, cos) = math::sin_cos(value(&self.turn) * strength);
        LocalMap {
            linear: [
                [cos * fx, -sin * fy, 0.0],
                [sin * fx, cos * fy, 0.0],
                [0.0, 0.0, 1.0],
            ],
            translation: core::array::from_fn(|i| value(&self.shifts[i]) * strength),
        }
    }
    fn slope(&self, z: f64) -> LocalMap {
        let (limited, rate) = limited(self.range.as_ref(), z);
        let course = |course: &Course| {
            let (value, slope) = course.value_and_slope(limited);
            (value, slope * rate)
        };
        let ((fx, dfx), (fy, dfy)) = (course(&self.factors[0]), course(&self.factors[1]));
        let (angle, turn) = course(&self.turn);
        let (sin, cos) = math::sin_cos(angle);
        LocalMap {
            linear: [
                [
                    cos * dfx - sin * turn * fx,
                    -sin * dfy - cos * turn * fy,
                    0.0,
                ],
                [
                    sin * dfx + cos * turn * fx,
                    cos * dfy - sin * turn * fy,
                    0.0,
                ],
                [0.0; 3],
            ],
            translation: core::array::from_fn(|i| course(&self.shifts[i]).1),
        }
    }
    fn smoothness(&self) -> Smoothness {
        let courses = self.factors.iter().chain([&self.turn]).chain(&self.shifts);
        let range = self
            .range
            .as_ref()
            .map_or(Smoothness::Smooth, AxisRange::smoothness);
        courses
            .into_iter()
            .fold(range, |class, course| class.min(course.smoothness()))
    }
    fn range(&self) -> Option<&AxisRange> {
        self.range.as_ref()
    }
    fn notes(&self) -> Vec<String> {
        range_note(self.range.as_ref())
    }
    fn upright(&self) -> Option<String> {
        let range = self.range.as_ref();
        let positive = self.factors.iter().all(|f| f.is_positive(range));
        let level = self.shifts[2].is_level();
        (positive && level).then(|| {
            "every slice across the axis is scaled by positive factors, turned and shifted as a whole"
                .to_owned()
        })
    }
    fn inverse(&self, q: [f64; 3]) -> Option<[f64; 3]> {
        if !self.shifts[2].is_level() {
            return None;
        }
        let z = q[2] - self.shifts[2].value_and_slope(q[2]).0;
        let limited = limited(self.range.as_ref(), z).0;
        let value = |course: &Course| course.value_and_slope(limited).0;
        let (x, y) = (q[0] - value(&self.shifts[0]), q[1] - value(&self.shifts[1]));
        let (sin, cos) = math::sin_cos(value(&self.turn));
        let back = [
            (x * cos + y * sin) / value(&self.factors[0]),
            (y * cos - x * sin) / value(&self.factors[1]),
            z,
        ];
        back.iter().all(|c| c.is_finite()).then_some(back)
    }
    fn is_identity(&self) -> bool {
        self.factors.iter().all(|f| f.is_constant(1.0))
            && self.turn.is_constant(0.0)
            && self.shifts.iter().all(|s| s.is_constant(0.0))
    }
}
