//! How the columns and rows of a grid go on between their nodes.
//!
//! All are functions through given values at increasing abscissae, with cubic pieces and a slope at each:
//!
//! - `linear`: the chord.
//! - `catmull-rom`: the slope of the parabola through a value and its two neighbours (Catmull and Rom's on uneven knots, Barry
//!   and Goldman 1988), that of the only chord at the ends.
//! - `monotone`: the same, limited to twice the smaller of the two chords' slopes and 0 where these have opposite signs. No
//!   piece overshoots its two values, and through increasing values the function increases strictly.
//!
//! *Source*: E. Catmull and R. Rom, *A class of local interpolating splines*, 1974; M. Steffen, *A simple method for monotonic
//! interpolation in one dimension*, Astronomy and Astrophysics 239, 1990 (at the ends the chord in place of his parabola).

use crate::names::{self, Named, UnknownName};
use anamorph_core::Plane;
use anamorph_core::glam::DVec2;
use anamorph_curves::families::{Generator, Hermite};
use anamorph_curves::{Cubic, CurveError, PiecewiseCubic};

/// How the columns and rows of a grid go on between their nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Spline {
    /// Straight, with corners at nodes. Never overshoots.
    Linear,
    /// Smooth; may overshoot where nodes are uneven.
    #[default]
    CatmullRom,
    /// Smooth, and never overshoots.
    Monotone,
}

const SPLINES: &[Named<Spline>] = &[
    (Spline::Linear, "linear", "straight, with corners at nodes"),
    (
        Spline::CatmullRom,
        "catmull-rom",
        "smooth; may overshoot where nodes are uneven",
    ),
    (
        Spline::Monotone,
        "monotone",
        "smooth, and never overshoots: grids do not fold between their nodes",
    ),
];

impl Spline {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        SPLINES.iter().map(|row| row.0)
    }
    /// Its name in recipes and lists.
    pub fn name(self) -> &'static str {
        names::row_of(SPLINES, self).0
    }
    /// What it is, in a few words.
    pub fn title(self) -> &'static str {
        names::row_of(SPLINES, self).1
    }
    /// The one of that name.
    ///
    /// # Errors
    /// [`UnknownName`], which lists the names there are.
    pub fn by_name(name: &str) -> Result<Self, UnknownName> {
        names::by_name("spline of grids", SPLINES, name)
    }

    /// Whether it never overshoots.
    pub fn keeps_order(self) -> bool {
        self != Self::CatmullRom
    }
}

/// The slope of the parabola through three values from the slopes of its two chords and their widths; exactly that of the
/// chords where these are alike.
pub(super) fn parabola(before: f64, behind: f64, width: f64, next: f64) -> f64 {
    if before == behind {
        before
    } else {
        (before * next + behind * width) / (width + next)
    }
}

/// A slope limited by those of the chords on both sides.
fn limited(slope: f64, before: f64, behind: f64) -> f64 {
    if before * behind <= 0.0 {
        return 0.0;
    }
    let most = 2.0 * before.abs().min(behind.abs());
    slope.clamp(-most, most)
}

/// The function through `values` (two numbers each) at the abscissae `at`, which increase.
pub(super) fn function(
    spline: Spline,
    at: &[f64],
    values: Vec<DVec2>,
) -> Result<PiecewiseCubic<Plane>, CurveError> {
    if spline == Spline::Linear {
        let piece = |pair: &[DVec2]| Cubic([pair[0], pair[1] - pair[0], DVec2::ZERO, DVec2::ZERO]);
        let pieces = values.windows(2).map(piece).collect();
        return PiecewiseCubic::with_breaks(pieces, at.to_vec(), false);
    }
    let widths: Vec<f64> = at.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let chords: Vec<DVec2> = values
        .windows(2)
        .zip(&widths)
        .map(|(pair, width)| (pair[1] - pair[0]) / *width)
        .collect();
    let velocity = |i: usize| {
        let (Some(before), Some(behind)) = (i.checked_sub(1).map(|b| chords[b]), chords.get(i))
        else {
            return chords[i.min(chords.len() - 1)];
        };
        let along = |axis: usize| {
            let (before, behind) = (before[axis], behind[axis]);
            let slope = parabola(before, behind, widths[i - 1], widths[i]);
            match spline {
                Spline::Monotone => limited(slope, before, behind),
                _ => slope,
            }
        };
        DVec2::new(along(0), along(1))
    };
    Hermite {
        velocities: (0..values.len()).map(velocity).collect(),
        points: values,
        times: Some(at.to_vec()),
        closed: false,
    }
    .curve()
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::{Curve, glam::dvec2};

    #[test]
    fn functions_meet_their_values_and_lines_stay_lines() {
        let at = [-3.0, -1.0, 0.25, 7.0, 7.5];
        let values: Vec<DVec2> = [(1.0, 2.0), (4.0, -1.0), (4.5, 8.0), (4.6, 8.0), (9.0, 0.0)]
            .map(DVec2::from)
            .to_vec();
        let line: Vec<DVec2> = at.iter().map(|&x| dvec2(2.0 * x + 1.0, -0.5 * x)).collect();
        for spline in Spline::all() {
            let curve = function(spline, &at, values.clone()).unwrap();
            let straight = function(spline, &at, line.clone()).unwrap();
            for (x, value) in at.iter().zip(&values) {
                assert!(curve.point(*x).distance(*value) < 1e-12);
            }
            for i in -30..=75 {
                let x = f64::from(i) / 10.0;
                let expected = dvec2(2.0 * x + 1.0, -0.5 * x);
                assert!(straight.point(x).distance(expected) < 1e-12, "{spline:?}");
            }
            assert_eq!(Spline::by_name(spline.name()), Ok(spline));
        }
        assert!(Spline::by_name("bezier").is_err());
    }

    #[test]
    fn the_monotone_spline_never_overshoots_and_catmull_rom_does() {
        let at = [0.0, 1.0, 1.1, 5.0, 6.0, 6.01];
        let steps = [0.0, 0.01, 3.0, 3.02, 9.0, 9.5];
        let values: Vec<DVec2> = steps.iter().map(|&v| dvec2(v, (v - 3.0).abs())).collect();
        let overshoots = |spline: Spline| {
            let curve = function(spline, &at, values.clone()).unwrap();
            let mut found = false;
            for (i, pair) in values.windows(2).enumerate() {
                for k in 0..=50 {
                    let here = curve.point(at[i] + (at[i + 1] - at[i]) * f64::from(k) / 50.0);
                    for axis in 0..2 {
                        let (low, high) = (
                            pair[0][axis].min(pair[1][axis]),
                            pair[0][axis].max(pair[1][axis]),
                        );
                        found |= here[axis] < low - 1e-12 || here[axis] > high + 1e-12;
                    }
                }
            }
            found
        };
        assert!(overshoots(Spline::CatmullRom));
        assert!(!overshoots(Spline::Monotone) && !overshoots(Spline::Linear));
    }
}
