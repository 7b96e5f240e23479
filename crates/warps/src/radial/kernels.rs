//! Kernels of radial basis functions, as functions of the squared distance, one number and eight at a time.
//!
//! The vector forms do the operations of the plain ones and agree with them bit for bit.
//!
//! *Source*: N. Arad, N. Dyn, D. Reisfeld, Y. Yeshurun, *Image Warping by Radial Basis Functions*, CVGIP 56(2), 1994; the
//! thin plate is J. Duchon's, 1977; the compact kernel is ψ₃,₁ of H. Wendland, *Piecewise polynomial, positive definite and
//! compactly supported radial functions of minimal degree*, Adv. Comput. Math. 4, 1995.

use anamorph_core::simd::{self, Simd, f64x8, prelude::*};
use anamorph_core::{Smoothness, Space, math};

/// How the influence of a point depends on the distance `r` to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kernel {
    /// `r`.
    Linear,
    /// `r³`.
    Cubic,
    /// `r² log r` in the plane, `r` in space: the surface of least bending.
    ThinPlate,
    /// `r² log r` in the plane and in space; in the plane it is the thin plate.
    Logarithmic,
    /// `exp(−(r/width)²)`.
    Gaussian {
        /// The width in scene units.
        width: f64,
    },
    /// `√(r² + width²)`.
    Multiquadric {
        /// The width in scene units.
        width: f64,
    },
    /// `1/√(r² + width²)`.
    InverseMultiquadric {
        /// The width in scene units.
        width: f64,
    },
    /// `(1 − r/radius)⁴ (4 r/radius + 1)` within the radius, else 0.
    Wendland {
        /// The radius in scene units.
        radius: f64,
    },
}

impl Kernel {
    /// The word a recipe uses.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Cubic => "cubic",
            Self::ThinPlate => "thin-plate",
            Self::Logarithmic => "logarithmic",
            Self::Gaussian { .. } => "gaussian",
            Self::Multiquadric { .. } => "multiquadric",
            Self::InverseMultiquadric { .. } => "inverse-multiquadric",
            Self::Wendland { .. } => "wendland",
        }
    }

    /// Its width or radius, if it has one.
    pub fn length(self) -> Option<f64> {
        match self {
            Self::Linear | Self::Cubic | Self::ThinPlate | Self::Logarithmic => None,
            Self::Gaussian { width }
            | Self::Multiquadric { width }
            | Self::InverseMultiquadric { width } => Some(width),
            Self::Wendland { radius } => Some(radius),
        }
    }

    /// Whether it is 0 from some distance on.
    pub fn is_compact(self) -> bool {
        matches!(self, Self::Wendland { .. })
    }

    /// Whether the equations of this kernel have a solution only beside an affine part, which takes away what they leave open.
    pub fn needs_affine(self) -> bool {
        matches!(self, Self::Cubic | Self::ThinPlate | Self::Logarithmic)
    }

    /// The formula in units of its length, or in any units if it has none: other units change what the affine part takes up.
    pub(super) fn formula<S: Space>(self) -> Formula {
        match self {
            Self::Logarithmic => Formula::Plate,
            Self::ThinPlate if S::DIM == 2 => Formula::Plate,
            Self::Linear | Self::ThinPlate => Formula::Distance,
            Self::Cubic => Formula::Cube,
            Self::Gaussian { .. } => Formula::Gaussian,
            Self::Multiquadric { .. } => Formula::Multiquadric,
            Self::InverseMultiquadric { .. } => Formula::Inverse,
            Self::Wendland { .. } => Formula::Wendland,
        }
    }
}

/// The formulas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Formula {
    Distance,
    Cube,
    Plate,
    Gaussian,
    Multiquadric,
    Inverse,
    Wendland,
}

/// Added to the squared distance whose logarithm is taken: the logarithm of 0 is then a number, and no other changes that counts.
const TINY: f64 = 1e-290;

/// Centres that are looked at together. Registers hold what four logarithms need, and four keep the processor busy.
pub(super) const TOGETHER: usize = 4;

/// One kernel as a function of the squared distance `q`.
pub(super) trait Profile {
    /// `φ(q)`.
    fn value(q: f64) -> f64;
    /// `φ(q)` of eight numbers.
    fn values<V: Simd>(v: V, q: f64x8<V>) -> f64x8<V>;
    /// `φ(q)` of several vectors, together where that is faster.
    #[inline(always)]
    fn values_of_each<V: Simd>(v: V, mut q: [f64x8<V>; TOGETHER]) -> [f64x8<V>; TOGETHER] {
        for q in &mut q {
            *q = Self::values(v, *q);
        }
        q
    }
    /// `2 dφ/dq`: the gradient is this times the way from the point. At the point itself, where it may not exist, what makes the gradient 0.
    fn slope(q: f64) -> f64;
    /// The class at the point and at the radius.
    const CLASS: Smoothness;
    /// The sign with which the quadratic form of the kernel is positive.
    const SIGN: f64;
    /// The largest `|dφ/dr|`.
    const STEEPEST: Option<f64>;
    /// Whether it ends at 1.
    const COMPACT: bool = false;
}

pub(super) struct Distance;
impl Profile for Distance {
    #[inline(always)]
    fn value(q: f64) -> f64 {
        q.sqrt()
    }
    #[inline(always)]
    fn values<V: Simd>(_: V, q: f64x8<V>) -> f64x8<V> {
        q.sqrt()
    }
    fn slope(q: f64) -> f64 {
        if q == 0.0 { 0.0 } else { 1.0 / q.sqrt() }
    }
    const CLASS: Smoothness = Smoothness::C(0);
    const SIGN: f64 = -1.0;
    const STEEPEST: Option<f64> = Some(1.0);
}

pub(super) struct Cube;
impl Profile for Cube {
    #[inline(always)]
    fn value(q: f64) -> f64 {
        q * q.sqrt()
    }
    #[inline(always)]
    fn values<V: Simd>(_: V, q: f64x8<V>) -> f64x8<V> {
        q * q.sqrt()
    }
    fn slope(q: f64) -> f64 {
        3.0 * q.sqrt()
    }
    const CLASS: Smoothness = Smoothness::C(2);
    const SIGN: f64 = 1.0;
    const STEEPEST: Option<f64> = None;
}

/// `q ln q`, twice `r² log r`: no root is taken. The logarithm is a polynomial with an error below one unit in the last place
/// ([`math::ln_positive`]).
pub(super) struct Plate;
impl Profile for Plate {
    #[inline(always)]
    fn value(q: f64) -> f64 {
        q * math::ln_positive(q + TINY)
    }
    #[inline(always)]
    fn values<V: Simd>(v: V, q: f64x8<V>) -> f64x8<V> {
        q * simd::ln_positive(v, q + simd::splat(v, TINY))
    }
    #[inline(always)]
    fn values_of_each<V: Simd>(v: V, q: [f64x8<V>; TOGETHER]) -> [f64x8<V>; TOGETHER] {
        let mut sums = q;
        for sum in &mut sums {
            *sum += simd::splat(v, TINY);
        }
        let mut values = simd::ln_positive_each(v, sums);
        for (value, q) in values.iter_mut().zip(q) {
            *value = q * *value;
        }
        values
    }
    fn slope(q: f64) -> f64 {
        if q < TINY {
            0.0
        } else {
            2.0 * (math::ln_positive(q) + 1.0)
        }
    }
    const CLASS: Smoothness = Smoothness::C(1);
    const SIGN: f64 = 1.0;
    const STEEPEST: Option<f64> = None;
}

pub(super) struct Gaussian;
impl Profile for Gaussian {
    #[inline(always)]
    fn value(q: f64) -> f64 {
        math::exp_negative(-q)
    }
    #[inline(always)]
    fn values<V: Simd>(v: V, q: f64x8<V>) -> f64x8<V> {
        simd::exp_negative(v, -q)
    }
    fn slope(q: f64) -> f64 {
        -2.0 * math::exp_negative(-q)
    }
    const CLASS: Smoothness = Smoothness::Smooth;
    const SIGN: f64 = 1.0;
    // √2 e^(−½)
    const STEEPEST: Option<f64> = Some(0.857_763_884_960_707);
}

pub(super) struct Multiquadric;
impl Profile for Multiquadric {
    #[inline(always)]
    fn value(q: f64) -> f64 {
        (q + 1.0).sqrt()
    }
    #[inline(always)]
    fn values<V: Simd>(v: V, q: f64x8<V>) -> f64x8<V> {
        (q + simd::splat(v, 1.0)).sqrt()
    }
    fn slope(q: f64) -> f64 {
        1.0 / (q + 1.0).sqrt()
    }
    const CLASS: Smoothness = Smoothness::Smooth;
    const SIGN: f64 = -1.0;
    const STEEPEST: Option<f64> = Some(1.0);
}

pub(super) struct Inverse;
impl Profile for Inverse {
    #[inline(always)]
    fn value(q: f64) -> f64 {
        1.0 / (q + 1.0).sqrt()
    }
    #[inline(always)]
    fn values<V: Simd>(v: V, q: f64x8<V>) -> f64x8<V> {
        simd::splat(v, 1.0) / (q + simd::splat(v, 1.0)).sqrt()
    }
    fn slope(q: f64) -> f64 {
        -1.0 / ((q + 1.0) * (q + 1.0).sqrt())
    }
    const CLASS: Smoothness = Smoothness::Smooth;
    const SIGN: f64 = 1.0;
    // 2/(3√3)
    const STEEPEST: Option<f64> = Some(0.384_900_179_459_750_5);
}

pub(super) struct Wendland;
impl Profile for Wendland {
    #[inline(always)]
    fn value(q: f64) -> f64 {
        let r = q.sqrt();
        if r < 1.0 {
            let rest = 1.0 - r;
            let square = rest * rest;
            square * square * (4.0 * r + 1.0)
        } else {
            0.0
        }
    }
    #[inline(always)]
    fn values<V: Simd>(v: V, q: f64x8<V>) -> f64x8<V> {
        let (one, r) = (simd::splat(v, 1.0), q.sqrt());
        let rest = one - r;
        let square = rest * rest;
        let value = square * square * (simd::splat(v, 4.0) * r + one);
        r.simd_lt(one).select(value, simd::splat(v, 0.0))
    }
    fn slope(q: f64) -> f64 {
        let rest = 1.0 - q.sqrt();
        if rest > 0.0 {
            -20.0 * (rest * rest * rest)
        } else {
            0.0
        }
    }
    const CLASS: Smoothness = Smoothness::C(2);
    const SIGN: f64 = 1.0;
    // 20 r (1 − r)³ at r = ¼
    const STEEPEST: Option<f64> = Some(2.109_375);
    const COMPACT: bool = true;
}

/// Evaluates an expression with the profile of a formula as a type.
macro_rules! with_profile {
    ($formula:expr, $profile:ident => $value:expr) => {
        match $formula {
            Formula::Distance => {
                type $profile = kernels::Distance;
                $value
            }
            Formula::Cube => {
                type $profile = kernels::Cube;
                $value
            }
            Formula::Plate => {
                type $profile = kernels::Plate;
                $value
            }
            Formula::Gaussian => {
                type $profile = kernels::Gaussian;
                $value
            }
            Formula::Multiquadric => {
                type $profile = kernels::Multiquadric;
                $value
            }
            Formula::Inverse => {
                type $profile = kernels::Inverse;
                $value
            }
            Formula::Wendland => {
                type $profile = kernels::Wendland;
                $value
            }
        }
    };
}
pub(super) use with_profile;
