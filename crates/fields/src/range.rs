//! A coordinate limited to a range: sharply, or by a smooth blend.
//!
//! *Source*: A. H. Barr, *Global and Local Deformations of Solid Primitives*, SIGGRAPH 1984 (the bend's `ŷ`, clamped
//! between `y_min` and `y_max`); the smooth blend is ours.
//!
//! `ẑ(z)` is `z` inside the range and stays at its ends outside. Clamped, `ẑ` is C⁰. Blended, its slope is no step but a
//! smoothstep over a width centred at each end, so that `ẑ`, the integral, is C² and *equals the clamp outside the two
//! blend zones*: with `u` from 0 to 1 across the zone, `ẑ = min + width·(u³ − u⁴/2)`, which is `min` and `min + width/2`
//! at its ends.

use crate::RangeError;
use anamorph_core::Smoothness;

/// What happens at the ends of a range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// The coordinate stops at once: C⁰.
    Clamp,
    /// The coordinate stops over a blend of this width (scene units), centred at each end: C².
    Smooth {
        /// The width of the blend.
        width: f64,
    },
}

/// A range of a coordinate with the way it ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisRange {
    min: f64,
    max: f64,
    limit: Limit,
    /// Half the width of the blend, and the reciprocal of the width; 0 for a clamp.
    half: f64,
    reciprocal: f64,
}

impl AxisRange {
    /// The range from `min` to `max`, in scene units.
    ///
    /// # Errors
    /// [`RangeError`] when a number is not finite, the range is empty, or the blend is wider than half the range.
    pub fn new(min: f64, max: f64, limit: Limit) -> Result<Self, RangeError> {
        for (value, what) in [(min, "start"), (max, "end"), (max - min, "length")] {
            if !value.is_finite() {
                return Err(RangeError::NotFinite { what });
            }
        }
        if min >= max {
            return Err(RangeError::Empty { min, max });
        }
        let (half, reciprocal) = match limit {
            Limit::Clamp => (0.0, 0.0),
            Limit::Smooth { width } => {
                let most = 0.5 * (max - min);
                if !width.is_finite() {
                    return Err(RangeError::NotFinite {
                        what: "blend width",
                    });
                }
                if !(width > 0.0 && width <= most && (1.0 / width).is_finite()) {
                    return Err(RangeError::BadWidth { width, most });
                }
                (0.5 * width, 1.0 / width)
            }
        };
        Ok(Self {
            min,
            max,
            limit,
            half,
            reciprocal,
        })
    }

    /// Start of the range.
    pub fn min(&self) -> f64 {
        self.min
    }
    /// End of the range.
    pub fn max(&self) -> f64 {
        self.max
    }
    /// The way it ends.
    pub fn limit(&self) -> Limit {
        self.limit
    }
    /// Class of `ẑ`.
    pub fn smoothness(&self) -> Smoothness {
        match self.limit {
            Limit::Clamp => Smoothness::C(0),
            Limit::Smooth { .. } => Smoothness::C(2),
        }
    }

    /// `ẑ(z)` and its derivative. At the very ends of a clamp the derivative is 1.
    #[inline(always)]
    pub fn value_and_slope(&self, z: f64) -> (f64, f64) {
        // Branch-free: a loop over it vectorizes. A clamp has zones of no width.
        let width = 2.0 * self.half;
        let low = (z - (self.min - self.half)) * self.reciprocal;
        let high = ((self.max + self.half) - z) * self.reciprocal;
        let zone_low = self.min + width * integral(low);
        let zone_high = self.max - width * integral(high);
        let (mut value, mut slope) = (z, 1.0);
        if z < self.min + self.half {
            (value, slope) = (zone_low, smoothstep(low));
        }
        if z > self.max - self.half {
            (value, slope) = (zone_high, smoothstep(high));
        }
        if z < self.min - self.half {
            (value, slope) = (self.min, 0.0);
        }
        if z > self.max + self.half {
            (value, slope) = (self.max, 0.0);
        }
        (value, slope)
    }

    /// [`AxisRange::value_and_slope`] of a block of coordinates; equal to it bit for bit.
    #[inline(always)]
    pub fn block<const N: usize>(&self, z: &[f64; N]) -> ([f64; N], [f64; N]) {
        let (mut value, mut slope) = ([0.0; N], [0.0; N]);
        for lane in 0..N {
            (value[lane], slope[lane]) = self.value_and_slope(z[lane]);
        }
        (value, slope)
    }
}

#[inline(always)]
fn smoothstep(u: f64) -> f64 {
    u * u * (3.0 - 2.0 * u)
}

/// The integral of the smoothstep from 0 to `u`.
#[inline(always)]
fn integral(u: f64) -> f64 {
    u * u * u * (1.0 - 0.5 * u)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clamps() {
        let range = AxisRange::new(-1.0, 3.0, Limit::Clamp).unwrap();
        for (z, expected) in [
            (-9.0, (-1.0, 0.0)),
            (-1.0, (-1.0, 1.0)),
            (0.7, (0.7, 1.0)),
            (3.0, (3.0, 1.0)),
            (3.1, (3.0, 0.0)),
            (1e300, (3.0, 0.0)),
        ] {
            assert_eq!(range.value_and_slope(z), expected);
        }
        assert_eq!(range.smoothness(), Smoothness::C(0));
    }

    #[test]
    fn blends_equal_the_clamp_outside_their_zones() {
        for width in [0.01, 0.3, 2.0] {
            let smooth = AxisRange::new(-1.0, 3.0, Limit::Smooth { width }).unwrap();
            let clamp = AxisRange::new(-1.0, 3.0, Limit::Clamp).unwrap();
            let mut last = f64::NEG_INFINITY;
            for i in -3000..=6000 {
                let z = f64::from(i) * 1e-3;
                let (value, slope) = smooth.value_and_slope(z);
                let in_zone = (z + 1.0).abs() <= 0.5 * width || (z - 3.0).abs() <= 0.5 * width;
                if in_zone {
                    assert!((0.0..=1.0 + 1e-15).contains(&slope));
                    let (clamped, _) = clamp.value_and_slope(z);
                    assert!((value - clamped).abs() <= width * 3.0 / 32.0 + 1e-15);
                } else {
                    assert_eq!((value, slope), clamp.value_and_slope(z));
                }
                assert!(value >= last);
                last = value;
            }
        }
    }

    #[test]
    fn the_blend_is_twice_continuously_differentiable() {
        let width = 0.8;
        let range = AxisRange::new(-1.0, 3.0, Limit::Smooth { width }).unwrap();
        for joint in [-1.4, -0.6, 2.6, 3.4] {
            let h = 1e-7;
            let (low, below) = range.value_and_slope(joint - h);
            let (high, above) = range.value_and_slope(joint + h);
            assert!((high - low).abs() < 3.0 * h && (above - below).abs() < 1e-11);
            // The slope's own slope, which vanishes at the zones' ends.
            let curvature = (above - below) / (2.0 * h);
            assert!(curvature.abs() < 1e-5, "{curvature}");
        }
        for i in 0..400 {
            let z = -1.5 + f64::from(i) * 0.0127;
            let h = 1e-5;
            let difference =
                (range.value_and_slope(z + h).0 - range.value_and_slope(z - h).0) / (2.0 * h);
            assert!((difference - range.value_and_slope(z).1).abs() < 1e-8);
        }
    }

    #[test]
    fn blocks_equal_scalars_bit_for_bit() {
        for limit in [Limit::Clamp, Limit::Smooth { width: 0.7 }] {
            let range = AxisRange::new(0.1, 1.9, limit).unwrap();
            for start in 0..100 {
                let z: [f64; 8] =
                    core::array::from_fn(|i| f64::from(start) * 0.05 - 1.5 + i as f64 * 0.013);
                let (value, slope) = range.block(&z);
                for lane in 0..8 {
                    let (v, s) = range.value_and_slope(z[lane]);
                    assert_eq!(value[lane].to_bits(), v.to_bits());
                    assert_eq!(slope[lane].to_bits(), s.to_bits());
                }
            }
        }
    }

    #[test]
    fn bad_ranges_are_refused() {
        let smooth = |width| AxisRange::new(0.0, 1.0, Limit::Smooth { width });
        assert!(smooth(0.5).is_ok());
        for width in [0.0, -0.1, 0.51, 1e-320] {
            assert!(matches!(smooth(width), Err(RangeError::BadWidth { .. })));
        }
        assert!(matches!(
            smooth(f64::NAN),
            Err(RangeError::NotFinite { .. })
        ));
        let error = AxisRange::new(1.0, 1.0, Limit::Clamp).unwrap_err();
        assert_eq!(error, RangeError::Empty { min: 1.0, max: 1.0 });
        assert!(AxisRange::new(f64::NEG_INFINITY, 0.0, Limit::Clamp).is_err());
        assert!(AxisRange::new(-f64::MAX, f64::MAX, Limit::Clamp).is_err());
    }
}
