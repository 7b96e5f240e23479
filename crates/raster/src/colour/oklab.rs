//! Oklab: colours whose distances look alike.
//!
//! *Source*: B. Ottosson, *A perceptual color space for image processing*, 2020 (matrices of 2021-01-25, for linear sRGB).

use anamorph_core::math::cbrt;

/// Lightness, green to red, blue to yellow of a colour in linear sRGB. White is about `[1, 0, 0]`. Colours outside the
/// gamut have values, too: the cube root keeps signs.
pub fn linear_to_oklab([r, g, b]: [f64; 3]) -> [f64; 3] {
    let l = cbrt(0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b);
    let m = cbrt(0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b);
    let s = cbrt(0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b);
    [
        0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
        1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
        0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
    ]
}

/// The colour in linear sRGB of an Oklab one; not clamped to the gamut.
pub fn oklab_to_linear([lightness, a, b]: [f64; 3]) -> [f64; 3] {
    let cube = |x: f64| x * x * x;
    let l = cube(lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b);
    let m = cube(lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b);
    let s = cube(lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_colours_and_the_way_back() {
        // From the author's page: linear red, to the digits printed there.
        let [l, a, b] = linear_to_oklab([1.0, 0.0, 0.0]);
        assert!((l - 0.628).abs() < 1e-3 && (a - 0.2249).abs() < 1e-3 && (b - 0.1258).abs() < 1e-3);
        let [l, a, b] = linear_to_oklab([1.0; 3]);
        assert!((l - 1.0).abs() < 1e-6 && a.abs() < 1e-6 && b.abs() < 1e-6);
        for colour in [[0.2, 0.7, 0.1], [0.0, 0.0, 1.0], [-0.1, 0.4, 1.7]] {
            let back = oklab_to_linear(linear_to_oklab(colour));
            for (x, y) in back.into_iter().zip(colour) {
                assert!((x - y).abs() < 1e-5, "{back:?} {colour:?}");
            }
        }
    }
}
