//! Transcendental functions, the only ones the project uses.
//!
//! The standard library's `sin`, `exp`, `ln` and `powf` differ in the last bit between processors and platforms. These
//! do not: [`sin`], [`cos`] and [`sin_cos`], [`ln_positive`] and [`exp_negative`] are polynomials of plain multiplications
//! and additions (the vector forms in `simd` do the same operations and agree bit for bit), the others come from the `libm`
//! crate, a port of musl's. `sqrt` is exact by IEEE 754 and may be called anywhere.
//!
//! *Source*: range reduction after W. J. Cody and W. Waite, *Software Manual for the Elementary Functions*, 1980 (three
//! parts of π/2); polynomials are those of FreeBSD's msun `k_sin.c` and `k_cos.c` (minimax on ±π/4, error < 2⁻⁵⁸), `e_log.c`
//! and `e_exp.c`.

/// The numbers behind [`sin_cos`], shared with its vector form.
pub(crate) mod constants {
    /// Beyond this magnitude (radians) the three-part reduction loses digits and `libm` takes over.
    pub(crate) const REDUCIBLE: f64 = 1.0e5;

    /// π/2 in three parts: the first two have 33 significant bits, so that `k · part` is exact for |k| < 2²⁰.
    pub(crate) const HALF_PI_1: f64 = 1.570_796_326_734_125_6;
    pub(crate) const HALF_PI_2: f64 = 6.077_100_506_303_966e-11;
    pub(crate) const HALF_PI_3: f64 = 2.022_266_248_795_950_7e-21;
    /// 1.5 · 2⁵²: adding and subtracting it rounds a small number to the nearest integer.
    pub(crate) const ROUNDER: f64 = 6_755_399_441_055_744.0;

    pub(crate) const SIN: [f64; 6] = [
        -1.666_666_666_666_663_2e-1,
        8.333_333_333_322_49e-3,
        -1.984_126_982_985_795e-4,
        2.755_731_370_707_006_8e-6,
        -2.505_076_025_340_686_3e-8,
        1.589_690_995_211_55e-10,
    ];
    pub(crate) const COS: [f64; 6] = [
        4.166_666_666_666_66e-2,
        -1.388_888_888_887_411e-3,
        2.480_158_728_947_673e-5,
        -2.755_731_435_139_066_3e-7,
        2.087_572_321_298_175e-9,
        -1.135_964_755_778_819_5e-11,
    ];

    /// ln 2 in two parts, the first with 32 significant bits.
    pub(crate) const LN_2_1: f64 = 6.931_471_803_691_238e-1;
    pub(crate) const LN_2_2: f64 = 1.908_214_929_270_587_7e-10;
    /// Bits of about √½, and of 1: a logarithm's mantissa is taken between √½ and √2.
    pub(crate) const ROOT_HALF: u64 = 0x3fe6_a09e_0000_0000;
    pub(crate) const ONE: u64 = 0x3ff0_0000_0000_0000;
    pub(crate) const MANTISSA: u64 = 0x000f_ffff_ffff_ffff;
    /// Bits of 2⁵², and 2⁵² plus the bias of exponents.
    pub(crate) const TWO_52: u64 = 0x4330_0000_0000_0000;
    pub(crate) const TWO_52_BIASED: f64 = 4_503_599_627_370_496.0 + 1023.0;
    pub(crate) const LN: [f64; 7] = [
        6.666_666_666_666_735e-1,
        3.999_999_999_940_942e-1,
        2.857_142_874_366_239e-1,
        2.222_219_843_214_978_4e-1,
        1.818_357_216_161_805e-1,
        1.531_383_769_920_937_3e-1,
        1.479_819_860_511_658_6e-1,
    ];
    pub(crate) const EXP: [f64; 5] = [
        1.666_666_666_666_660_2e-1,
        -2.777_777_777_701_559_3e-3,
        6.613_756_321_437_934e-5,
        -1.653_390_220_546_525_2e-6,
        4.138_136_797_057_238_5e-8,
    ];
    /// Below this an exponential is 0 to the functions here: its value would not be a normal number.
    pub(crate) const LEAST_EXPONENT: f64 = -708.0;
}
use constants::*;

/// Sine and cosine of a number with magnitude at most 10⁵; branch-free.
#[inline(always)]
fn sin_cos_small(x: f64) -> (f64, f64) {
    let shifted = x * core::f64::consts::FRAC_2_PI + ROUNDER;
    let k = shifted - ROUNDER;
    // The low bits of the shifted number's mantissa are the quadrant.
    let quadrant = shifted.to_bits();
    let r1 = x - k * HALF_PI_1;
    let r2 = k * HALF_PI_2;
    let r = r1 - r2;
    // What the last two subtractions lost.
    let tail = ((r1 - r) - r2) - k * HALF_PI_3;

    let z = r * r;
    let sin_poly = SIN[1] + z * (SIN[2] + z * (SIN[3] + z * (SIN[4] + z * SIN[5])));
    let v = z * r;
    let sin = r - ((z * (0.5 * tail - v * sin_poly) - tail) - v * SIN[0]);
    let cos_poly =
        z * (COS[0] + z * (COS[1] + z * (COS[2] + z * (COS[3] + z * (COS[4] + z * COS[5])))));
    let half = 0.5 * z;
    let one = 1.0 - half;
    let cos = one + (((1.0 - one) - half) + (z * cos_poly - r * tail));

    let swap = quadrant & 1 == 1;
    let (s, c) = (if swap { cos } else { sin }, if swap { sin } else { cos });
    let s_sign = (quadrant & 2) << 62;
    let c_sign = (quadrant.wrapping_add(1) & 2) << 62;
    (
        f64::from_bits(s.to_bits() ^ s_sign),
        f64::from_bits(c.to_bits() ^ c_sign),
    )
}

/// Sine and cosine of an angle in radians. NaN for infinite or NaN angles; error below one unit in the last place.
#[inline]
#[must_use]
pub fn sin_cos(angle: f64) -> (f64, f64) {
    if angle.abs() <= REDUCIBLE {
        sin_cos_small(angle)
    } else {
        (libm::sin(angle), libm::cos(angle))
    }
}

/// Sine of an angle in radians.
#[inline]
#[must_use]
pub fn sin(angle: f64) -> f64 {
    sin_cos(angle).0
}

/// Cosine of an angle in radians.
#[inline]
#[must_use]
pub fn cos(angle: f64) -> f64 {
    sin_cos(angle).1
}

/// Tangent of an angle in radians.
#[must_use]
pub fn tan(angle: f64) -> f64 {
    libm::tan(angle)
}

/// Angle of the vector `(x, y)` in radians, in (−π, π].
#[must_use]
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// Arc cosine in radians of a number clamped to [−1, 1] first, so that rounding never makes NaN.
#[must_use]
pub fn acos(x: f64) -> f64 {
    libm::acos(x.clamp(-1.0, 1.0))
}

/// Arc sine in radians of a number clamped to [−1, 1] first.
#[must_use]
pub fn asin(x: f64) -> f64 {
    libm::asin(x.clamp(-1.0, 1.0))
}

/// The exponential `eˣ`.
#[must_use]
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// The natural logarithm.
#[must_use]
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// The natural logarithm of a positive normal number; anything for other numbers. Error below one unit in the last place.
#[inline(always)]
#[must_use]
pub fn ln_positive(x: f64) -> f64 {
    let shifted = x.to_bits().wrapping_add(ONE - ROOT_HALF);
    let k = f64::from_bits(shifted >> 52 | TWO_52) - TWO_52_BIASED;
    let f = f64::from_bits((shifted & MANTISSA) + ROOT_HALF) - 1.0;
    let half = 0.5 * f * f;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let even = w * (LN[1] + w * (LN[3] + w * LN[5]));
    let odd = z * (LN[0] + w * (LN[2] + w * (LN[4] + w * LN[6])));
    s * (half + (even + odd)) + k * LN_2_2 - half + f + k * LN_2_1
}

/// The exponential of a number that is not positive; 0 below −708, where it would not be a normal number.
#[inline(always)]
#[must_use]
pub fn exp_negative(x: f64) -> f64 {
    if x < LEAST_EXPONENT {
        return 0.0;
    }
    let shifted = x * core::f64::consts::LOG2_E + ROUNDER;
    let k = shifted - ROUNDER;
    let (high, low) = (x - k * LN_2_1, k * LN_2_2);
    let r = high - low;
    let z = r * r;
    let c = r - z * (EXP[0] + z * (EXP[1] + z * (EXP[2] + z * (EXP[3] + z * EXP[4]))));
    let y = 1.0 + (r * c / (2.0 - c) - low + high);
    y * f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52)
}

/// `x` to the power `y`.
#[must_use]
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// The cube root.
#[must_use]
pub fn cbrt(x: f64) -> f64 {
    libm::cbrt(x)
}

/// `x` to a small whole power by repeated squaring: exact products only, hence the same everywhere.
#[inline]
#[must_use]
pub fn powi(x: f64, mut n: u32) -> f64 {
    let (mut base, mut result) = (x, 1.0);
    while n > 0 {
        if n & 1 == 1 {
            result *= base;
        }
        base *= base;
        n >>= 1;
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    fn units_off(a: f64, b: f64) -> f64 {
        (a - b).abs() / (f64::EPSILON * b.abs().max(f64::MIN_POSITIVE))
    }

    #[test]
    fn sine_and_cosine_agree_with_libm_to_an_ulp() {
        let mut worst = 0.0_f64;
        let mut x = -100.0;
        while x < 100.0 {
            let (s, c) = sin_cos(x);
            worst = worst
                .max(units_off(s, libm::sin(x)))
                .max(units_off(c, libm::cos(x)));
            x += 0.001_234_567;
        }
        for k in -60_000..60_000 {
            // Near multiples of π/2, where cancellation is worst.
            let x = f64::from(k) * core::f64::consts::FRAC_PI_2;
            let (s, c) = sin_cos(x);
            worst = worst
                .max((s - libm::sin(x)).abs() / 1e-16)
                .max((c - libm::cos(x)).abs() / 1e-16);
        }
        assert!(worst <= 1.2, "{worst} units in the last place");
    }

    #[test]
    fn logarithm_and_exponential_agree_with_libm_to_an_ulp() {
        let mut worst = 0.0_f64;
        for i in -30_000..30_000 {
            let x = libm::pow(10.0, f64::from(i) * 1.003e-2);
            if x.is_normal() {
                worst = worst.max(units_off(ln_positive(x), libm::log(x)));
            }
            let near = 1.0 + f64::from(i) * 1e-5;
            worst = worst.max(units_off(ln_positive(near), libm::log(near)));
            let down = -(f64::from(i) + 30_000.0) * 0.0118;
            worst = worst.max(units_off(exp_negative(down), libm::exp(down)));
        }
        assert!(worst <= 1.5, "{worst} units in the last place");
        assert_eq!(exp_negative(-1e9), 0.0);
        assert_eq!((exp_negative(0.0), ln_positive(1.0)), (1.0, 0.0));
    }

    #[test]
    fn whole_powers() {
        assert_eq!(powi(3.0, 5), 243.0);
        assert_eq!(powi(0.0, 0), 1.0);
    }
}
