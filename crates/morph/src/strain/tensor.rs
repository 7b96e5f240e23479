//! Strains of the plane: how a map changes lengths and angles about a place, whatever it turns and wherever it carries.
//!
//! Computes eq. (1) from the gradient of a map, and what follows from it: the squared stretch `C = I + 2ε`, the stretch `U = √C` of the
//! polar decomposition `F = R U`, its principal values, and the angle of `R`.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004, eq. (1); errata S3.

use anamorph_core::glam::{DMat2, DVec2, dvec2};
use anamorph_core::math;

/// The strain `[ε_x, ε_y, γ_xy]` of eq. (1).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Strain {
    /// `ε_x`: half of what the squared length along x gains.
    pub x: f64,
    /// `ε_y`: half of what the squared length along y gains.
    pub y: f64,
    /// `γ_xy`: the scalar product of what becomes of the unit vectors; twice the entry `ε_xy` of the tensor.
    pub shear: f64,
}

/// A symmetric matrix of the plane: the entries `xx`, `yy` and `xy`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Symmetric {
    pub(crate) xx: f64,
    pub(crate) yy: f64,
    pub(crate) xy: f64,
}

impl Symmetric {
    /// The matrix with the same principal directions whose principal values are those of `f`.
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let ([large, small], half, radius) = self.principal();
        let (large, small) = (f(large), f(small));
        let mean = 0.5 * (large + small);
        if radius == 0.0 {
            return Self {
                xx: mean,
                yy: mean,
                xy: 0.0,
            };
        }
        let share = 0.5 * (large - small) / radius;
        Self {
            xx: mean + share * half,
            yy: mean - share * half,
            xy: share * self.xy,
        }
    }

    /// Principal values, the larger first, and what they were found from.
    fn principal(self) -> ([f64; 2], f64, f64) {
        let (mean, half) = (0.5 * (self.xx + self.yy), 0.5 * (self.xx - self.yy));
        let radius = (half * half + self.xy * self.xy).sqrt();
        let large = mean + radius;
        // The product of both is the determinant; the difference would lose the digits of a small one.
        let determinant = self.xx * self.yy - self.xy * self.xy;
        let small = if large > 0.0 {
            (determinant / large).clamp(mean - radius - large * 1e-15, large)
        } else {
            mean - radius
        };
        ([large, small], half, radius)
    }

    pub(crate) fn matrix(self) -> DMat2 {
        DMat2::from_cols(dvec2(self.xx, self.xy), dvec2(self.xy, self.yy))
    }
}

impl Strain {
    /// Eq. (1): the strain of a map with that gradient, whose columns are `∂p′/∂x` and `∂p′/∂y`.
    #[inline]
    pub fn of(gradient: DMat2) -> Self {
        let (x, y) = (gradient.x_axis, gradient.y_axis);
        Self {
            x: 0.5 * (x.dot(x) - 1.0),
            y: 0.5 * (y.dot(y) - 1.0),
            shear: x.dot(y),
        }
    }

    /// The squared stretch `C = I + 2ε`.
    pub(crate) fn squared_stretch(self) -> Symmetric {
        Symmetric {
            xx: 1.0 + 2.0 * self.x,
            yy: 1.0 + 2.0 * self.y,
            xy: self.shear,
        }
    }

    /// `ε = ½(C − I)`.
    pub(crate) fn of_squared_stretch(c: Symmetric) -> Self {
        Self {
            x: 0.5 * (c.xx - 1.0),
            y: 0.5 * (c.yy - 1.0),
            shear: c.xy,
        }
    }

    /// The stretch `U = √(I + 2ε)`; what rounding has made negative under the root counts as zero.
    pub(crate) fn stretch(self) -> Symmetric {
        self.squared_stretch().map(|value| value.max(0.0).sqrt())
    }

    /// The strain whose principal stretches are no less than `least`.
    pub(crate) fn floored(self, least: f64) -> Self {
        let floor = least * least;
        Self::of_squared_stretch(self.squared_stretch().map(|value| value.max(floor)))
    }

    /// The power `C^t`, `0 ≤ t ≤ 1`.
    pub(crate) fn power(self, t: f64) -> Symmetric {
        self.squared_stretch().map(|value| {
            if value > 0.0 {
                math::pow(value, t)
            } else {
                0.0
            }
        })
    }

    /// The principal stretches, the larger first: how much longer and shorter lengths become.
    pub fn stretches(self) -> [f64; 2] {
        let (values, ..) = self.squared_stretch().principal();
        values.map(|value| value.max(0.0).sqrt())
    }
}

/// The angle of the rotation `R` of `F = R U`, in (−π, π].
#[inline]
pub(crate) fn rotation(gradient: DMat2) -> f64 {
    let (x, y) = (gradient.x_axis, gradient.y_axis);
    math::atan2(x.y - y.x, x.x + y.y)
}

/// The rotation by an angle.
#[inline]
pub(crate) fn turn(angle: f64) -> DMat2 {
    let (sin, cos) = math::sin_cos(angle);
    DMat2::from_cols(dvec2(cos, sin), dvec2(-sin, cos))
}

/// An angle up to whole turns, in (−π, π].
pub(crate) fn shorter(angle: f64) -> f64 {
    let turns = (angle / std::f64::consts::TAU).round();
    let rest = angle - turns * std::f64::consts::TAU;
    if rest <= -std::f64::consts::PI {
        rest + std::f64::consts::TAU
    } else {
        rest
    }
}

/// `a × b`.
#[inline]
pub(crate) fn cross(a: DVec2, b: DVec2) -> f64 {
    a.x * b.y - a.y * b.x
}
