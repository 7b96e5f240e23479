//! A Gaussian that ends: `exp(−k t²)` less the quadratic that meets it at `t = 1`.
//!
//! *Source*: the Gaussian falloff of Milliron et al. 2002, §8.5, made compact here. With `v = 1 − t²` the Gaussian is
//! `e^(−k) e^(kv)`; taking off the first three terms of its series at the edge leaves
//! `f(t) = E(k v)/E(k)`, `E(x) = eˣ − 1 − x − x²/2`.
//!
//! Continuity: `E(x) = x³/6 + …`, a triple root at the edge, hence C² there; a smooth function of `t²`, smooth at the
//! centre. It falls everywhere, since `E′(x) = eˣ − 1 − x ≥ 0`. For large `k` it tends to the Gaussian, for small `k` to
//! `(1 − t²)³`.

use super::{Falloff, FalloffFacts};
use crate::FieldError;
use anamorph_core::{Smoothness, math};

/// `(exp(−k t²) − its second Taylor polynomial in t² at 1)`, scaled to 1 at the centre; 0 from `t = 1` on. C².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gaussian {
    steepness: f64,
    /// `E(k)`.
    top: f64,
}

/// `eˣ − 1 − x − x²/2` for `x ≥ 0`.
fn remainder(x: f64) -> f64 {
    if x < 1.0 {
        // The series x³/3! + x⁴/4! + …, because the closed form cancels; term 21 is below rounding.
        let mut sum = 1.0;
        let mut n = 21.0;
        while n > 3.0 {
            sum = 1.0 + sum * x / n;
            n -= 1.0;
        }
        sum * x * x * x / 6.0
    } else {
        math::exp(x) - 1.0 - x - 0.5 * x * x
    }
}

impl Gaussian {
    /// The steepness `k = 4.5`: the radius is three standard deviations.
    pub const DEFAULT: Self = Self {
        steepness: 4.5,
        top: 74.392_131_300_521_81,
    };
    const LEAST: f64 = 0.01;
    const MOST: f64 = 100.0;

    /// The falloff like `exp(−k t²)`; `k = ½(r/σ)²` for a standard deviation `σ`.
    ///
    /// # Errors
    /// [`FieldError::OutOfRange`] unless `k` is from 0.01 (as good as `(1 − t²)³`) to 100 (below 1e-10 from half
    /// the radius on).
    pub fn new(steepness: f64) -> Result<Self, FieldError> {
        if (Self::LEAST..=Self::MOST).contains(&steepness) {
            Ok(Self {
                steepness,
                top: remainder(steepness),
            })
        } else {
            Err(FieldError::OutOfRange {
                what: "steepness of the Gaussian",
                value: steepness,
                min: Self::LEAST,
                max: Self::MOST,
            })
        }
    }
    /// The steepness `k`.
    pub fn steepness(&self) -> f64 {
        self.steepness
    }
}

impl Default for Gaussian {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Falloff for Gaussian {
    #[inline]
    fn value(&self, t: f64) -> f64 {
        self.value_of_square(t * t)
    }
    fn derivative(&self, t: f64) -> f64 {
        if t >= 1.0 {
            return 0.0;
        }
        let x = self.steepness * (1.0 - t * t);
        -2.0 * self.steepness * t * (remainder(x) + 0.5 * x * x) / self.top
    }
    fn facts(&self) -> FalloffFacts {
        FalloffFacts {
            name: "gaussian",
            reach: Some(1.0),
            centre: Smoothness::Smooth,
            start: Smoothness::C(1),
            edge: Smoothness::C(2),
        }
    }
    fn value_of_square(&self, q: f64) -> f64 {
        if q < 1.0 {
            remainder(self.steepness * (1.0 - q)) / self.top
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_is_what_new_makes() {
        assert_eq!(Gaussian::new(4.5).unwrap(), Gaussian::DEFAULT);
    }

    #[test]
    fn tends_to_the_gaussian_and_to_a_cubic() {
        let (steep, flat) = (Gaussian::new(50.0).unwrap(), Gaussian::new(0.01).unwrap());
        for i in 0..10 {
            let t = f64::from(i) * 0.1;
            assert!((steep.value(t) - math::exp(-50.0 * t * t)).abs() < 1e-15);
            assert!((flat.value(t) - math::powi(1.0 - t * t, 3)).abs() < 2e-3);
        }
    }

    #[test]
    fn both_branches_of_the_remainder_agree() {
        let x = 1.0 - 1e-12;
        let closed = math::exp(x) - 1.0 - x - 0.5 * x * x;
        assert!((remainder(x) - closed).abs() < 1e-15);
        assert!(Gaussian::new(0.0).is_err() && Gaussian::new(f64::NAN).is_err());
    }
}
