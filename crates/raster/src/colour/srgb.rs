//! The transfer function of sRGB: codes and linear light.
//!
//! *Source*: IEC 61966-2-1:1999 with its amendment 1: linear below 0.04045 (encoded), a power of 2.4 above.
//!
//! Codes are decoded by tables and encoded by comparing with the light half way (in code) to the next: both exact for all
//! light, and without a power for each sample.

use anamorph_core::math::pow;

/// Linear light of an sRGB-encoded value; 0 to 0 and 1 to 1. Beyond them the curve goes on, for negative numbers mirrored.
pub fn srgb_to_linear(encoded: f64) -> f64 {
    let size = encoded.abs();
    let light = if size <= 0.040_45 {
        size / 12.92
    } else {
        pow((size + 0.055) / 1.055, 2.4)
    };
    light.copysign(encoded)
}

/// The sRGB encoding of linear light, the other way round of [`srgb_to_linear`].
pub fn linear_to_srgb(light: f64) -> f64 {
    let size = light.abs();
    let encoded = if size <= 0.003_130_8 {
        size * 12.92
    } else {
        1.055 * pow(size, 1.0 / 2.4) - 0.055
    };
    encoded.copysign(light)
}

/// Both directions for codes of some width.
#[derive(Debug, Clone)]
struct Tables {
    /// Light of each code.
    light: Vec<f32>,
    /// Light from which on code `i + 1` is nearer than code `i`.
    half_way: Vec<f32>,
    /// The lowest code of each bin of light.
    first: Vec<u16>,
}

/// Bits of a number that do not tell its bin: 4096 bins an octave, few enough codes in each.
const SHIFT: u32 = 11;
/// Light below this is in the first bin; 2⁻¹⁹ is a fifth of the first half-way of 16 bits.
const DARKEST: f32 = 1.0 / (1 << 19) as f32;

fn bin(light: f32) -> usize {
    ((light.max(DARKEST).to_bits() - DARKEST.to_bits()) >> SHIFT) as usize
}

impl Tables {
    fn new(largest: u16) -> Self {
        let of = |code: f64| srgb_to_linear(code / f64::from(largest)) as f32;
        let light = (0..=largest).map(|code| of(f64::from(code))).collect();
        let half_way: Vec<f32> = (0..largest).map(|code| of(f64::from(code) + 0.5)).collect();
        let mut first = Vec::new();
        let mut code = 0_u16;
        for number in 0..=bin(1.0) {
            let start = DARKEST.to_bits() + ((number as u32) << SHIFT);
            let start = if number == 0 {
                0.0
            } else {
                f32::from_bits(start)
            };
            while half_way.get(usize::from(code)).is_some_and(|&h| h <= start) {
                code += 1;
            }
            first.push(code);
        }
        Self {
            light,
            half_way,
            first,
        }
    }

    fn encode(&self, light: f32) -> u16 {
        // The comparison is false for what is not a number.
        let light = if light > 0.0 { light.min(1.0) } else { 0.0 };
        let mut code = self.first[bin(light)];
        while self
            .half_way
            .get(usize::from(code))
            .is_some_and(|&h| h <= light)
        {
            code += 1;
        }
        code
    }
}

macro_rules! depth {
    ($name:ident, $code:ty, $what:literal) => {
        #[doc = concat!("sRGB in codes of ", $what, " bits, with its tables; make one and keep it.")]
        #[derive(Debug, Clone)]
        pub struct $name(Tables);

        impl Default for $name {
            fn default() -> Self {
                Self::new()
            }
        }

        impl $name {
            /// Fills the tables.
            pub fn new() -> Self {
                Self(Tables::new(u16::from(<$code>::MAX)))
            }
            /// Linear light of a code, rounded once from the exact value.
            pub fn decode(&self, code: $code) -> f32 {
                self.0.light[usize::from(code)]
            }
            /// The nearest code of linear light: 0 for negative light and for what is not a number, the largest from 1 on.
            pub fn encode(&self, light: f32) -> $code {
                self.0.encode(light) as $code
            }
            /// Decodes a run, up to the shorter of the two.
            pub fn decode_all(&self, codes: &[$code], light: &mut [f32]) {
                for (light, &code) in light.iter_mut().zip(codes) {
                    *light = self.decode(code);
                }
            }
            /// Encodes a run, up to the shorter of the two.
            pub fn encode_all(&self, light: &[f32], codes: &mut [$code]) {
                for (code, &light) in codes.iter_mut().zip(light) {
                    *code = self.encode(light);
                }
            }
        }
    };
}

depth!(Srgb8, u8, "8");
depth!(Srgb16, u16, "16");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_codes_make_the_round_trip() {
        let (eight, sixteen) = (Srgb8::new(), Srgb16::new());
        for code in 0..=u8::MAX {
            assert_eq!(eight.encode(eight.decode(code)), code);
        }
        for code in 0..=u16::MAX {
            assert_eq!(sixteen.encode(sixteen.decode(code)), code);
        }
        assert_eq!((eight.decode(0), eight.decode(255)), (0.0, 1.0));
        assert_eq!((sixteen.decode(0), sixteen.decode(65535)), (0.0, 1.0));
        assert_eq!(eight.decode(128), sixteen.decode(128 * 257));
    }

    #[test]
    fn tables_agree_with_the_formula_for_light_between_codes() {
        let (eight, sixteen) = (Srgb8::new(), Srgb16::new());
        let mut light = 1e-8_f32;
        while light < 1.1 {
            let exact = linear_to_srgb(f64::from(light)).min(1.0);
            let near = |code: f64, largest: f64| (code / largest - exact).abs() * largest;
            // Rounding of the half-way light may move a tie by little.
            assert!(near(f64::from(eight.encode(light)), 255.0) <= 0.5 + 1e-4);
            assert!(near(f64::from(sixteen.encode(light)), 65535.0) <= 0.5 + 1e-2);
            light *= 1.000_37;
        }
    }

    #[test]
    fn light_out_of_range_has_a_code() {
        let eight = Srgb8::new();
        for (light, code) in [
            (f32::NAN, 0),
            (f32::NEG_INFINITY, 0),
            (-0.0, 0),
            (f32::INFINITY, 255),
            (2.0, 255),
            (f32::MIN_POSITIVE, 0),
        ] {
            assert_eq!(eight.encode(light), code, "{light}");
        }
    }

    #[test]
    fn published_values() {
        // IEC 61966-2-1: code 188 is nearest to half the light; mid-grey 18 % is 118.
        let eight = Srgb8::new();
        assert_eq!(eight.encode(0.5), 188);
        assert_eq!(eight.encode(0.18), 118);
        assert!((srgb_to_linear(0.5) - 0.214_041_140_482_232_55).abs() < 1e-15);
        assert_eq!(srgb_to_linear(-0.5), -srgb_to_linear(0.5));
        assert!((linear_to_srgb(srgb_to_linear(1.7)) - 1.7).abs() < 1e-12);
    }
}
