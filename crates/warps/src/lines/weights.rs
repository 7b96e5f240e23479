//! The weight `(size^p / (a + d))^b` of an element at distance `d`.
//!
//! *Source*: T. Beier and S. Neely, *Feature-Based Image Metamorphosis*, SIGGRAPH 1992; A. Lerios et al., *Feature-Based
//! Volume Metamorphosis*, SIGGRAPH 1995, have `1/(d + ε)²`: `p = 0`, `a = ε`, `b = 2`. Errata F6: powers by logarithms
//! where plain ones over- or underflow; infinite at distance 0 with `a = 0`, constant with `b = 0`.

use super::ElementError;
use anamorph_core::math;

/// Plain weights between these are summed as they are; beyond, logarithms take over. The sum of displacements of ordinary
/// and of very large models stays in range with them.
pub(super) const SAFE: core::ops::Range<f64> = 1e-140..1e140;

/// The constants of an element's weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightConstants {
    /// Added to the distance, in scene units: 0 makes the element decide alone on itself, more lets others have a say.
    pub a: f64,
    /// How fast the weight falls off with distance: 0 for not at all, usually ½ to 2.
    pub b: f64,
    /// How much the weight grows with the element's size: 0 for not at all, 1 in proportion. A point has no size and with
    /// `p > 0` no weight.
    pub p: f64,
}

impl Default for WeightConstants {
    /// `1/d²`.
    fn default() -> Self {
        Self {
            a: 0.0,
            b: 2.0,
            p: 0.0,
        }
    }
}

impl WeightConstants {
    /// Refuses constants that are negative or not finite.
    pub(super) fn check(&self, feature: usize) -> Result<(), ElementError> {
        for (constant, value) in [("a", self.a), ("b", self.b), ("p", self.p)] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(ElementError::Constant {
                    feature,
                    constant,
                    value,
                });
            }
        }
        Ok(())
    }

    /// The weight of an element of size `size` with everything that does not depend on the distance.
    pub(super) fn of_size(self, size: f64) -> SizedWeight {
        // 0⁰ = 1: with p = 0 no size matters.
        let log_size = if self.p == 0.0 {
            0.0
        } else {
            self.p * math::ln(size)
        };
        SizedWeight {
            constants: self,
            power: Power::new(self.b),
            size: math::exp(log_size),
            log_size,
        }
    }
}

/// `x ↦ x^b`, with the exponents that need no logarithm apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Power {
    None,
    Root,
    Plain,
    Square,
    Cube,
    Other(f64),
}

impl Power {
    fn new(b: f64) -> Self {
        match b {
            0.0 => Self::None,
            0.5 => Self::Root,
            1.0 => Self::Plain,
            2.0 => Self::Square,
            3.0 => Self::Cube,
            b => Self::Other(b),
        }
    }
}

/// The weight as a function of the distance alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SizedWeight {
    pub(super) constants: WeightConstants,
    pub(super) power: Power,
    /// `size^p`; may be 0 or infinite, which plain powers do not serve.
    pub(super) size: f64,
    /// Its logarithm; −∞ for an element without size.
    log_size: f64,
}

impl SizedWeight {
    /// Whether the weight is 0 everywhere: a point with `p > 0` and `b > 0`.
    pub(super) fn vanishes(&self) -> bool {
        self.log_size == f64::NEG_INFINITY && self.constants.b > 0.0
    }

    /// Whether the weight is infinite on the element.
    pub(super) fn pins(&self) -> bool {
        self.constants.a == 0.0 && self.constants.b > 0.0 && !self.vanishes()
    }

    /// The weight by plain powers at distance `d`; outside of [`SAFE`] where these cannot be trusted.
    #[inline(always)]
    pub(super) fn plain(&self, d: f64) -> f64 {
        let base = self.size / (self.constants.a + d);
        match self.power {
            Power::None => 1.0,
            Power::Root if SAFE.contains(&base) => base.sqrt(),
            Power::Plain => base,
            Power::Square => base * base,
            Power::Cube => base * base * base,
            Power::Other(b) if SAFE.contains(&base) => math::pow(base, b),
            Power::Root | Power::Other(_) => 0.0,
        }
    }

    /// The logarithm of `size^(p·b)`.
    pub(super) fn log_factor(&self) -> f64 {
        self.constants.b * self.log_size
    }

    /// The logarithm of the weight at distance `d`, finite where the weight is neither 0 nor infinite.
    pub(super) fn log(&self, d: f64) -> f64 {
        if self.constants.b == 0.0 {
            return 0.0;
        }
        let log = self.constants.b * (self.log_size - math::ln(self.constants.a + d));
        // Beyond this no sum of weights sees the difference; infinities would.
        log.clamp(-1e300, 1e300)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errata F6: both forms agree to 1e-12 where both can be had.
    #[test]
    fn plain_and_logarithmic_powers_agree() {
        for b in [0.0, 0.5, 0.7, 1.0, 1.7, 2.0, 3.0, 4.25] {
            for p in [0.0, 0.5, 1.0] {
                for a in [0.0, 1e-3, 2.0] {
                    for size in [1e-4, 1.0, 37.0] {
                        let weight = WeightConstants { a, b, p }.of_size(size);
                        for d in [1e-8, 1e-2, 1.0, 55.0, 1e9] {
                            let (plain, log) = (weight.plain(d), math::exp(weight.log(d)));
                            assert!((plain / log - 1.0).abs() < 1e-12, "{weight:?} at {d}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn ends_of_the_range_of_numbers() {
        let weight = WeightConstants {
            a: 0.0,
            b: 0.25,
            p: 2.0,
        };
        // size² overflows, the weight does not.
        let huge = weight.of_size(1e200);
        assert!(!SAFE.contains(&huge.plain(1e150)));
        assert!((huge.log(1e150) - 0.25 * math::ln(1e250)).abs() < 1e-9);
        assert!(weight.of_size(0.0).vanishes() && !weight.of_size(0.0).pins());
        let steep = WeightConstants {
            b: f64::MAX,
            ..weight
        };
        assert!(steep.of_size(1.0).log(1e-300).is_finite());
        assert_eq!(
            WeightConstants { b: 0.0, ..weight }.of_size(0.0).plain(0.0),
            1.0
        );
    }
}
