//! Filters by name.
//!
//! *Sources*: R. G. Keys, *Cubic convolution interpolation for digital image processing*, IEEE Transactions on ASSP 29(6),
//! 1981 (his a = −½ is the spline of Catmull and Rom); D. P. Mitchell and A. N. Netravali, *Reconstruction filters in
//! computer graphics*, SIGGRAPH 1988; C. E. Duchon, *Lanczos filtering in one and two dimensions*, Journal of Applied
//! Meteorology 18, 1979, and K. Turkowski, *Filters for common resampling tasks*, Graphics Gems, 1990.

use crate::RasterError;
use anamorph_core::math;

/// Most taps a separable filter has along an axis.
pub(super) const TAPS: usize = 6;

/// The weights of the taps for a position `t` in [0, 1) after the middle tap; those of the filter's taps are written. At
/// `t = 0` an interpolating filter has weight 1 on the middle and exactly 0 elsewhere.
pub(super) type Weights = fn(f64, &mut [f64; TAPS]);

/// What a filter does.
#[derive(Clone, Copy)]
pub(super) enum Kernel {
    /// The pixel that a position lies in.
    Nearest,
    /// The product of weights across and down; the middle tap is number `taps / 2 − 1`.
    Separable { taps: usize, weights: Weights },
    /// A weighted mean over an ellipse, from a pyramid.
    Elliptical,
}

/// A filter of the registry.
struct Entry {
    name: &'static str,
    aliases: &'static [&'static str],
    title: &'static str,
    reference: &'static str,
    interpolates: bool,
    kernel: Kernel,
}

static FILTERS: [Entry; 6] = [
    Entry {
        name: "nearest",
        aliases: &["point"],
        title: "the pixel that a position lies in",
        reference: "",
        interpolates: true,
        kernel: Kernel::Nearest,
    },
    Entry {
        name: "bilinear",
        aliases: &["linear"],
        title: "linear across and down, 2 × 2 pixels",
        reference: "",
        interpolates: true,
        kernel: Kernel::Separable {
            taps: 2,
            weights: bilinear,
        },
    },
    Entry {
        name: "catmull-rom",
        aliases: &["bicubic", "cubic"],
        title: "cubic convolution, sharp, 4 × 4 pixels",
        reference: "Keys 1981",
        interpolates: true,
        kernel: Kernel::Separable {
            taps: 4,
            weights: catmull_rom,
        },
    },
    Entry {
        name: "mitchell",
        aliases: &["mitchell-netravali"],
        title: "cubic with B = C = 1/3, between blur and ringing, 4 × 4 pixels; blurs even where nothing moves",
        reference: "Mitchell and Netravali 1988",
        interpolates: false,
        kernel: Kernel::Separable {
            taps: 4,
            weights: mitchell,
        },
    },
    Entry {
        name: "lanczos",
        aliases: &["lanczos3"],
        title: "windowed sine of three lobes, sharpest, may ring, 6 × 6 pixels",
        reference: "Duchon 1979; Turkowski 1990",
        interpolates: true,
        kernel: Kernel::Separable {
            taps: 6,
            weights: lanczos,
        },
    },
    Entry {
        name: "anisotropic",
        aliases: &["ewa", "elliptical"],
        title: "weighted mean of all that a target pixel covers; does not alias where the image shrinks",
        reference: "Greene and Heckbert 1986; Heckbert 1989",
        interpolates: true,
        kernel: Kernel::Elliptical,
    },
];

/// How pixels become a function of the plane.
///
/// All but [`Filter::ANISOTROPIC`] have a footprint that does not know the warp: right where the image is enlarged or about
/// as large as before, aliasing where it shrinks.
#[derive(Clone, Copy)]
pub struct Filter(&'static Entry);

impl Filter {
    /// The pixel that a position lies in.
    pub const NEAREST: Self = Self(&FILTERS[0]);
    /// Linear across and down.
    pub const BILINEAR: Self = Self(&FILTERS[1]);
    /// Cubic convolution after Keys, the spline of Catmull and Rom.
    pub const CATMULL_ROM: Self = Self(&FILTERS[2]);
    /// The cubic of Mitchell and Netravali. It does not interpolate: where nothing moves it blurs.
    pub const MITCHELL: Self = Self(&FILTERS[3]);
    /// Sine windowed by its own main lobe, three lobes each side, weights made to sum to 1.
    pub const LANCZOS: Self = Self(&FILTERS[4]);
    /// The elliptical weighted average after Greene and Heckbert, its footprint from the warp's Jacobian.
    pub const ANISOTROPIC: Self = Self(&FILTERS[5]);

    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        FILTERS.iter().map(Self)
    }
    /// The one of that name or alias.
    ///
    /// # Errors
    /// [`RasterError::UnknownName`], which lists the names there are.
    pub fn by_name(name: &str) -> Result<Self, RasterError> {
        let called = |entry: &&Entry| entry.name == name || entry.aliases.contains(&name);
        let found = FILTERS.iter().find(called);
        found
            .map(Self)
            .ok_or_else(|| unknown("filter", name, FILTERS.iter().map(|entry| entry.name)))
    }
    /// Its name in recipes and lists.
    pub fn name(self) -> &'static str {
        self.0.name
    }
    /// Further names.
    pub fn aliases(self) -> &'static [&'static str] {
        self.0.aliases
    }
    /// What it is, in a few words.
    pub fn title(self) -> &'static str {
        self.0.title
    }
    /// Where it comes from; empty where that is common knowledge.
    pub fn reference(self) -> &'static str {
        self.0.reference
    }
    /// Whether it gives back a pixel at that pixel's centre where nothing shrinks.
    pub fn interpolates(self) -> bool {
        self.0.interpolates
    }
    /// Whether it reads the Jacobian of the map.
    pub fn needs_jacobian(self) -> bool {
        matches!(self.0.kernel, Kernel::Elliptical)
    }
    #[inline]
    pub(super) fn kernel(self) -> Kernel {
        self.0.kernel
    }
}

impl PartialEq for Filter {
    fn eq(&self, other: &Self) -> bool {
        core::ptr::eq(self.0, other.0)
    }
}
impl Eq for Filter {}

impl core::fmt::Debug for Filter {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("Filter").field(&self.name()).finish()
    }
}

/// The error for a name that is not in a list.
pub(super) fn unknown<'a>(
    what: &'static str,
    name: &str,
    known: impl Iterator<Item = &'a str>,
) -> RasterError {
    RasterError::UnknownName {
        what,
        name: name.to_owned(),
        known: known.collect::<Vec<_>>().join(", "),
    }
}

fn bilinear(t: f64, weights: &mut [f64; TAPS]) {
    weights[0] = 1.0 - t;
    weights[1] = t;
}

#[inline(always)]
pub(super) fn catmull_rom(t: f64, weights: &mut [f64; TAPS]) {
    weights[0] = ((2.0 - t) * t - 1.0) * t * 0.5;
    weights[1] = ((3.0 * t - 5.0) * t * t + 2.0) * 0.5;
    weights[2] = ((4.0 - 3.0 * t) * t + 1.0) * t * 0.5;
    weights[3] = (t - 1.0) * t * t * 0.5;
}

#[inline(always)]
pub(super) fn mitchell(t: f64, weights: &mut [f64; TAPS]) {
    // Their eq. (8) with B = C = 1/3.
    let inner = |x: f64| ((7.0 * x - 12.0) * x * x + 16.0 / 3.0) / 6.0;
    let outer = |x: f64| (((-7.0 / 3.0 * x + 12.0) * x - 20.0) * x + 32.0 / 3.0) / 6.0;
    weights[0] = outer(1.0 + t);
    weights[1] = inner(t);
    weights[2] = inner(1.0 - t);
    weights[3] = outer(2.0 - t);
}

fn lanczos(t: f64, weights: &mut [f64; TAPS]) {
    if t == 0.0 {
        *weights = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
        return;
    }
    // sin π(t + k) = ±sin πt, and sin π(t + k)/3 by the sum of angles: two sines and a cosine for all taps.
    const COS: [f64; 3] = [1.0, 0.5, -0.5];
    const SIN: [f64; 3] = [0.0, 0.866_025_403_784_438_6, 0.866_025_403_784_438_6];
    let whole = math::sin(t * core::f64::consts::PI);
    let (sin, cos) = math::sin_cos(t * core::f64::consts::FRAC_PI_3);
    let mut sum = 0.0;
    for (tap, weight) in weights.iter_mut().enumerate() {
        // The tap stands at `t − k`.
        let k = tap as f64 - 2.0;
        let x = t - k;
        let turns = tap.abs_diff(2);
        let (c, s) = (COS[turns % 3], SIN[turns % 3] * k.signum());
        // Three thirds of a half turn: the sign changes. A whole turn of the first sine changes it with every tap.
        let third = if turns == 3 { -sin } else { sin * c - cos * s };
        let sign = if turns % 2 == 0 { 1.0 } else { -1.0 };
        *weight = sign * whole * third / (x * x);
        sum += *weight;
    }
    weights.iter_mut().for_each(|weight| *weight /= sum);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weights(filter: Filter, t: f64) -> Vec<f64> {
        let Kernel::Separable { taps, weights } = filter.kernel() else {
            return Vec::new();
        };
        let mut list = [0.0; TAPS];
        weights(t, &mut list);
        list[..taps].to_vec()
    }

    #[test]
    fn weights_sum_to_one_and_interpolating_ones_are_exact_at_pixels() {
        for filter in Filter::all() {
            for step in 0..64 {
                let t = f64::from(step) / 64.0;
                let list = weights(filter, t);
                if list.is_empty() {
                    continue;
                }
                assert!(
                    (list.iter().sum::<f64>() - 1.0).abs() < 1e-14,
                    "{filter:?} {t}"
                );
                if t == 0.0 && filter.interpolates() {
                    let middle = list.len() / 2 - 1;
                    for (tap, &weight) in list.iter().enumerate() {
                        assert_eq!(weight, f64::from(u8::from(tap == middle)), "{filter:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn cubics_reproduce_what_their_papers_say() {
        // Keys: quadratics; Mitchell and Netravali: lines.
        for step in 0..32 {
            let t = f64::from(step) / 32.0;
            let moment = |filter: Filter, power: i32| -> f64 {
                let list = weights(filter, t);
                let first = 1 - list.len() as i32 / 2;
                let at = |i: usize| f64::from(first + i as i32);
                list.iter()
                    .enumerate()
                    .map(|(i, w)| w * at(i).powi(power))
                    .sum()
            };
            assert!((moment(Filter::CATMULL_ROM, 1) - t).abs() < 1e-14);
            assert!((moment(Filter::CATMULL_ROM, 2) - t * t).abs() < 1e-14);
            assert!((moment(Filter::MITCHELL, 1) - t).abs() < 1e-14);
        }
        let at_pixel = weights(Filter::MITCHELL, 0.0);
        for (weight, known) in at_pixel
            .iter()
            .zip([1.0 / 18.0, 16.0 / 18.0, 1.0 / 18.0, 0.0])
        {
            assert!((weight - known).abs() < 1e-15);
        }
    }

    #[test]
    fn lanczos_agrees_with_its_definition() {
        let sinc = |x: f64| (core::f64::consts::PI * x).sin() / (core::f64::consts::PI * x);
        for step in 1..50 {
            let t = f64::from(step) / 50.0;
            let plain: Vec<f64> = (-2..=3)
                .map(|k| sinc(t - f64::from(k)) * sinc((t - f64::from(k)) / 3.0))
                .collect();
            let sum: f64 = plain.iter().sum();
            for (weight, plain) in weights(Filter::LANCZOS, t).iter().zip(plain) {
                assert!((weight - plain / sum).abs() < 1e-13, "{t}");
            }
        }
    }

    #[test]
    fn names_are_unique_and_found() {
        let mut names = Vec::new();
        for filter in Filter::all() {
            assert_eq!(Filter::by_name(filter.name()), Ok(filter));
            for alias in filter.aliases() {
                assert_eq!(Filter::by_name(alias), Ok(filter));
            }
            names.push(filter.name());
            names.extend(filter.aliases());
            assert!(!filter.title().is_empty());
        }
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
        let message = Filter::by_name("gauss").unwrap_err().to_string();
        assert!(
            message.contains("`gauss`") && message.contains("lanczos"),
            "{message}"
        );
    }
}
