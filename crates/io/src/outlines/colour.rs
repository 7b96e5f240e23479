//! Fills between two fills.
//!
//! Colours mix in Oklab, in which equal steps look equally large and the lightness of the middle is the middle of the lightnesses. They are
//! weighted by their opacity, so that a part that appears or goes away keeps its own colour all the way.
//!
//! *Source*: B. Ottosson, *A perceptual color space for image processing*, 2020; T. Porter and T. Duff, *Compositing Digital Images*,
//! SIGGRAPH 1984 (premultiplied opacity).

use anamorph_raster::colour::{linear_to_oklab, linear_to_srgb, oklab_to_linear, srgb_to_linear};

/// A fill's red, green, blue and opacity from 0 to 1, sRGB-encoded.
pub type Fill = [f64; 4];

/// The fill at a share `t` of the way from `a` to `b`; nothing is the other fill without opacity. At 0 and 1 it is `a` and `b` themselves;
/// colours that a screen cannot show between them are cut off at its limits.
#[must_use]
pub fn mix_fill(a: Option<Fill>, b: Option<Fill>, t: f64) -> Option<Fill> {
    if t <= 0.0 || (t.is_nan()) || a == b {
        return a;
    }
    if t >= 1.0 {
        return b;
    }
    let clear = |[red, green, blue, _]: Fill| [red, green, blue, 0.0];
    let a = a.or(b.map(clear))?;
    let b = b.unwrap_or(clear(a));
    let opacity = (1.0 - t) * a[3] + t * b[3];
    // Where neither is seen, the colours count alike.
    let (share_a, share_b) = if opacity > 0.0 {
        ((1.0 - t) * a[3] / opacity, t * b[3] / opacity)
    } else {
        (1.0 - t, t)
    };
    let lab = |[red, green, blue, _]: Fill| linear_to_oklab([red, green, blue].map(srgb_to_linear));
    let (from, to) = (lab(a), lab(b));
    let mixed = [0, 1, 2].map(|i| share_a * from[i] + share_b * to[i]);
    let [red, green, blue] =
        oklab_to_linear(mixed).map(|light| linear_to_srgb(light.clamp(0.0, 1.0)).clamp(0.0, 1.0));
    Some([red, green, blue, opacity])
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Fill = [1.0, 0.0, 0.0, 1.0];
    const BLUE: Fill = [0.0, 0.0, 1.0, 1.0];

    #[test]
    fn ends_are_exact_and_the_middle_is_that_of_oklab() {
        assert_eq!(mix_fill(Some(RED), Some(BLUE), 0.0), Some(RED));
        assert_eq!(mix_fill(Some(RED), Some(BLUE), 1.0), Some(BLUE));
        // Red is (0.628, 0.225, 0.126) in Oklab and blue (0.452, −0.032, −0.312).
        let [red, green, blue, opacity] = mix_fill(Some(RED), Some(BLUE), 0.5).unwrap();
        let lab = linear_to_oklab([red, green, blue].map(srgb_to_linear));
        for (value, expected) in lab.into_iter().zip([0.540, 0.096, -0.093]) {
            assert!((value - expected).abs() < 1e-3, "{lab:?}");
        }
        assert_eq!(opacity, 1.0);
    }

    #[test]
    fn what_appears_keeps_its_colour() {
        let half = mix_fill(None, Some(RED), 0.25).unwrap();
        assert_eq!(half[3], 0.25);
        for (value, expected) in half.into_iter().zip(RED).take(3) {
            assert!((value - expected).abs() < 1e-6, "{half:?}");
        }
        // Black without opacity does not darken.
        let from_clear = mix_fill(Some([0.0; 4]), Some(RED), 0.25).unwrap();
        assert!((from_clear[0] - 1.0).abs() < 1e-6);
        assert_eq!(mix_fill(None, None, 0.5), None);
        assert_eq!(mix_fill(Some(RED), None, 1.0), None);
        let unseen = mix_fill(Some([0.0; 4]), Some([1.0, 1.0, 1.0, 0.0]), 0.5).unwrap();
        assert!(unseen.iter().all(|value| value.is_finite()));
    }

    #[test]
    fn swapping_the_fills_swaps_the_time() {
        let (a, b) = (Some([0.2, 0.7, 0.1, 0.9]), Some([0.9, 0.3, 0.6, 0.4]));
        for t in [0.125, 0.5, 0.875] {
            let (one, other) = (mix_fill(a, b, t).unwrap(), mix_fill(b, a, 1.0 - t).unwrap());
            for (x, y) in one.into_iter().zip(other) {
                assert!((x - y).abs() < 1e-12);
            }
        }
    }
}
