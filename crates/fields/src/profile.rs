//! Profiles: smooth functions of one variable, drawn by points or given by coefficients.
//!
//! *Source*: F. N. Fritsch and J. Butland, *A Method for Constructing Local Monotone Piecewise Cubic Interpolants*, SIAM
//! J. Sci. Stat. Comput. 5(2), 1984, with the weighted harmonic mean of Brodlie for the slope at a point and the
//! shape-preserving three-point slope at the ends (C. Moler, *Numerical Computing with MATLAB*, 2004, §3.6).
//!
//! The curve goes through the points, is C¹ between them, and never leaves the range of the two points beside it: between
//! rising points it rises, and peaks are where points are.

use crate::ProfileError;
use anamorph_core::Smoothness;

/// How a profile drawn by points continues beyond its first and last point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ends {
    /// With the value of the end: the profile never leaves the range of its points. C⁰ at an end whose slope is not 0.
    #[default]
    Constant,
    /// With the slope of the end: C¹, but without bound.
    Linear,
}

/// One cubic: `c0 + c1·u + c2·u² + c3·u³`, `u = x − start`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    start: f64,
    c0: f64,
    c1: f64,
    c2: f64,
    c3: f64,
}

impl Piece {
    #[inline(always)]
    fn value_and_derivative(&self, x: f64) -> (f64, f64) {
        let u = x - self.start;
        (
            self.c0 + u * (self.c1 + u * (self.c2 + u * self.c3)),
            self.c1 + u * (2.0 * self.c2 + u * (3.0 * self.c3)),
        )
    }
    /// Integral from the start.
    fn integral(&self, x: f64) -> f64 {
        let u = x - self.start;
        u * (self.c0 + u * (self.c1 / 2.0 + u * (self.c2 / 3.0 + u * self.c3 / 4.0)))
    }
    fn is_finite(&self) -> bool {
        [self.c0, self.c1, self.c2, self.c3]
            .iter()
            .all(|c| c.is_finite())
    }
}

#[derive(Debug, Clone, PartialEq)]
enum Form {
    /// `pieces[0]` is valid before `knots[0]`, `pieces[i]` between knots `i − 1` and `i`, the last one from the last knot
    /// on. `areas[i]` is the integral from the first knot to the start of piece `i`.
    Pieces {
        knots: Vec<f64>,
        pieces: Vec<Piece>,
        areas: Vec<f64>,
    },
    /// Coefficients, the constant one first.
    Polynomial(Vec<f64>),
}

/// A smooth scalar function of one variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    form: Form,
    smoothness: Smoothness,
}

/// Up to this many knots a block selects its coefficients knot by knot, which vectorizes; beyond, it looks them up.
const FEW: usize = 8;

impl Profile {
    /// The C¹ curve through the points `[x, y]`, monotone wherever the points are, and constant beyond its ends
    /// ([`Ends::Constant`]). One point is a constant.
    ///
    /// # Errors
    /// [`ProfileError`] when there is no point, a number is not finite, the x do not increase, or a slope overflows.
    pub fn through(points: &[[f64; 2]]) -> Result<Self, ProfileError> {
        Self::through_with_ends(points, Ends::Constant)
    }

    /// As [`Profile::through`], with the given continuation beyond the ends.
    ///
    /// # Errors
    /// Those of [`Profile::through`].
    pub fn through_with_ends(points: &[[f64; 2]], ends: Ends) -> Result<Self, ProfileError> {
        for (index, [x, y]) in points.iter().enumerate() {
            if !(x.is_finite() && y.is_finite()) {
                return Err(ProfileError::NotFinite { index });
            }
            if index > 0 && *x <= points[index - 1][0] {
                let (x, previous) = (*x, points[index - 1][0]);
                return Err(ProfileError::NotIncreasing { index, x, previous });
            }
        }
        let (first, last) = match points {
            [] => return Err(ProfileError::Empty),
            [[_, y]] => return Self::polynomial(&[*y]),
            [first, .., last] => (*first, *last),
        };
        let slopes = slopes(points);
        let slope_at = |index: usize| match ends {
            Ends::Constant => 0.0,
            Ends::Linear => slopes[index],
        };
        let line = |[x, y]: [f64; 2], slope: f64| Piece {
            start: x,
            c0: y,
            c1: slope,
            c2: 0.0,
            c3: 0.0,
        };
        let end = points.len() - 1;
        let mut pieces = vec![line(first, slope_at(0))];
        let mut areas = vec![0.0, 0.0];
        for (i, pair) in points.windows(2).enumerate() {
            let piece = hermite(pair[0], pair[1], slopes[i], slopes[i + 1]);
            let area = piece.integral(pair[1][0]);
            if !(piece.is_finite() && area.is_finite()) {
                return Err(ProfileError::TooSteep { index: i + 1 });
            }
            areas.push(areas[i + 1] + area);
            pieces.push(piece);
        }
        pieces.push(line(last, slope_at(end)));
        let kink = ends == Ends::Constant && (slopes[0] != 0.0 || slopes[end] != 0.0);
        let smoothness = match points.len() {
            2 if ends == Ends::Linear || first[1] == last[1] => Smoothness::Smooth,
            _ if kink => Smoothness::C(0),
            _ => Smoothness::C(1),
        };
        Ok(Self {
            form: Form::Pieces {
                knots: points.iter().map(|p| p[0]).collect(),
                pieces,
                areas,
            },
            smoothness,
        })
    }

    /// The polynomial `c₀ + c₁x + c₂x² + …`.
    ///
    /// # Errors
    /// [`ProfileError`] when there is no coefficient or one is not finite.
    pub fn polynomial(coefficients: &[f64]) -> Result<Self, ProfileError> {
        if let Some(index) = coefficients.iter().position(|c| !c.is_finite()) {
            return Err(ProfileError::NotFinite { index });
        }
        if coefficients.is_empty() {
            return Err(ProfileError::Empty);
        }
        Ok(Self {
            form: Form::Polynomial(coefficients.to_vec()),
            smoothness: Smoothness::Smooth,
        })
    }

    /// The constant `value`.
    ///
    /// # Errors
    /// [`ProfileError::NotFinite`].
    pub fn constant(value: f64) -> Result<Self, ProfileError> {
        Self::polynomial(&[value])
    }

    /// The line `value + slope·x`.
    ///
    /// # Errors
    /// [`ProfileError::NotFinite`].
    pub fn linear(value: f64, slope: f64) -> Result<Self, ProfileError> {
        Self::polynomial(&[value, slope])
    }

    /// Continuity over the whole line, ends included.
    pub fn smoothness(&self) -> Smoothness {
        self.smoothness
    }

    /// The value, if it is the same everywhere.
    pub fn as_constant(&self) -> Option<f64> {
        match &self.form {
            Form::Polynomial(c) => c[1..].iter().all(|&c| c == 0.0).then(|| c[0]),
            Form::Pieces { pieces, .. } => {
                let value = pieces[0].c0;
                let flat = |p: &Piece| p.c0 == value && p.c1 == 0.0 && p.c2 == 0.0 && p.c3 == 0.0;
                pieces.iter().all(flat).then_some(value)
            }
        }
    }

    /// The value at `x`.
    pub fn value(&self, x: f64) -> f64 {
        self.value_and_derivative(x).0
    }

    /// The derivative at `x`; at a kink ([`Ends::Constant`]), the right one.
    pub fn derivative(&self, x: f64) -> f64 {
        self.value_and_derivative(x).1
    }

    /// Value and derivative at `x`.
    pub fn value_and_derivative(&self, x: f64) -> (f64, f64) {
        match &self.form {
            Form::Polynomial(coefficients) => {
                let (value, derivative) = horner(coefficients, &[x]);
                (value[0], derivative[0])
            }
            Form::Pieces { knots, pieces, .. } => {
                pieces[piece_at(knots, x)].value_and_derivative(x)
            }
        }
    }

    /// The integral from `from` to `to`.
    pub fn integral(&self, from: f64, to: f64) -> f64 {
        let primitive = |x: f64| match &self.form {
            Form::Polynomial(coefficients) => {
                let terms = coefficients.iter().enumerate().rev();
                terms.fold(0.0, |sum, (i, c)| (sum + c / (i as f64 + 1.0)) * x)
            }
            Form::Pieces {
                knots,
                pieces,
                areas,
            } => {
                let index = piece_at(knots, x);
                areas[index] + pieces[index].integral(x)
            }
        };
        primitive(to) - primitive(from)
    }

    /// Values and derivatives of a block of places; equal to [`Profile::value_and_derivative`] bit for bit, and
    /// vectorizable for polynomials and for up to eight points.
    #[inline(always)]
    pub fn values_block<const N: usize>(&self, x: &[f64; N]) -> ([f64; N], [f64; N]) {
        match &self.form {
            Form::Polynomial(coefficients) => horner(coefficients, x),
            Form::Pieces { knots, pieces, .. } => {
                // One array per coefficient, so that selecting and evaluating vectorize.
                let head = &pieces[0];
                let (mut start, mut c0, mut c1) = ([head.start; N], [head.c0; N], [head.c1; N]);
                let (mut c2, mut c3) = ([head.c2; N], [head.c3; N]);
                if knots.len() <= FEW {
                    for (&knot, piece) in knots.iter().zip(&pieces[1..]) {
                        for lane in 0..N {
                            let beyond = x[lane] >= knot;
                            start[lane] = if beyond { piece.start } else { start[lane] };
                            c0[lane] = if beyond { piece.c0 } else { c0[lane] };
                            c1[lane] = if beyond { piece.c1 } else { c1[lane] };
                            c2[lane] = if beyond { piece.c2 } else { c2[lane] };
                            c3[lane] = if beyond { piece.c3 } else { c3[lane] };
                        }
                    }
                } else {
                    for lane in 0..N {
                        let piece = &pieces[piece_at(knots, x[lane])];
                        (start[lane], c0[lane]) = (piece.start, piece.c0);
                        (c1[lane], c2[lane], c3[lane]) = (piece.c1, piece.c2, piece.c3);
                    }
                }
                let (mut value, mut derivative) = ([0.0; N], [0.0; N]);
                for lane in 0..N {
                    let piece = Piece {
                        start: start[lane],
                        c0: c0[lane],
                        c1: c1[lane],
                        c2: c2[lane],
                        c3: c3[lane],
                    };
                    (value[lane], derivative[lane]) = piece.value_and_derivative(x[lane]);
                }
                (value, derivative)
            }
        }
    }
}

/// Number of knots not after `x`, which is the number of the piece that is valid there.
#[inline(always)]
fn piece_at(knots: &[f64], x: f64) -> usize {
    if knots.len() <= 2 * FEW {
        // Counting has no branches to mispredict.
        knots.iter().map(|&knot| usize::from(x >= knot)).sum()
    } else {
        knots.partition_point(|&knot| x >= knot)
    }
}

/// Values and derivatives of a polynomial by Horner's rule.
#[inline(always)]
fn horner<const N: usize>(coefficients: &[f64], x: &[f64; N]) -> ([f64; N], [f64; N]) {
    let (mut value, mut derivative) = ([0.0; N], [0.0; N]);
    let Some((last, rest)) = coefficients.split_last() else {
        return (value, derivative);
    };
    value = [*last; N];
    for c in rest.iter().rev() {
        for lane in 0..N {
            derivative[lane] = derivative[lane] * x[lane] + value[lane];
            value[lane] = value[lane] * x[lane] + c;
        }
    }
    (value, derivative)
}

/// The cubic from point to point with the given slopes.
fn hermite(from: [f64; 2], to: [f64; 2], slope_from: f64, slope_to: f64) -> Piece {
    let h = to[0] - from[0];
    let mean = (to[1] - from[1]) / h;
    Piece {
        start: from[0],
        c0: from[1],
        c1: slope_from,
        c2: (3.0 * mean - 2.0 * slope_from - slope_to) / h,
        c3: (slope_from + slope_to - 2.0 * mean) / h / h,
    }
}

/// The slope at every point (at least two of them).
fn slopes(points: &[[f64; 2]]) -> Vec<f64> {
    let steps: Vec<(f64, f64)> = points
        .windows(2)
        .map(|p| {
            let h = p[1][0] - p[0][0];
            (h, (p[1][1] - p[0][1]) / h)
        })
        .collect();
    if let [(_, mean)] = steps[..] {
        return vec![mean; 2];
    }
    let inner = steps.windows(2).map(|pair| {
        let [(h0, d0), (h1, d1)] = [pair[0], pair[1]];
        if (d0 > 0.0 && d1 > 0.0) || (d0 < 0.0 && d1 < 0.0) {
            // Brodlie's weighted harmonic mean, never more than three times the smaller: monotone.
            3.0 * (h0 + h1) / ((2.0 * h1 + h0) / d0 + (h1 + 2.0 * h0) / d1)
        } else {
            0.0
        }
    });
    let last = steps.len() - 1;
    let mut slopes = vec![end_slope(steps[0], steps[1])];
    slopes.extend(inner);
    slopes.push(end_slope(steps[last], steps[last - 1]));
    slopes
}

/// Slope at an end from the step beside it and the next: that of the parabola through three points, as far as it keeps the
/// step monotone.
fn end_slope((h0, d0): (f64, f64), (h1, d1): (f64, f64)) -> f64 {
    let slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
    if slope * d0.signum() <= 0.0 || d0 == 0.0 {
        0.0
    } else if d0.signum() != d1.signum() && slope.abs() > 3.0 * d0.abs() {
        3.0 * d0
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    fn random_points(random: &mut Random, count: usize) -> Vec<[f64; 2]> {
        let mut x = -1.0;
        (0..count)
            .map(|i| {
                x += random.between(0.01, 1.0);
                // Steps of every kind, level ones included.
                let y = if i % 5 == 3 {
                    0.5
                } else {
                    random.between(-1.0, 1.0)
                };
                [x, y]
            })
            .collect()
    }

    #[test]
    fn through_the_points_without_overshoot() {
        let mut random = Random::new(51);
        for step in 0..300 {
            let points = random_points(&mut random, 2 + step % 20);
            for ends in [Ends::Constant, Ends::Linear] {
                let profile = Profile::through_with_ends(&points, ends).unwrap();
                for pair in points.windows(2) {
                    let [[x0, y0], [x1, y1]] = [pair[0], pair[1]];
                    assert_eq!(profile.value(x0), y0);
                    let mut last = y0;
                    for i in 0..=50 {
                        let x = x0 + (x1 - x0) * f64::from(i) / 50.0;
                        let y = profile.value(x);
                        // Monotone between two points, hence between their values.
                        assert!((y - last) * (y1 - y0) >= -1e-15, "{points:?} at {x}");
                        assert!(y >= y0.min(y1) - 1e-15 && y <= y0.max(y1) + 1e-15);
                        last = y;
                    }
                }
                let [x, y] = points[points.len() - 1];
                assert_eq!(profile.value(x), y);
            }
        }
    }

    #[test]
    fn continuous_slope_and_right_derivative() {
        let mut random = Random::new(52);
        for step in 0..100 {
            let points = random_points(&mut random, 3 + step % 17);
            let profile = Profile::through_with_ends(&points, Ends::Linear).unwrap();
            assert_eq!(profile.smoothness(), Smoothness::C(1));
            for [x, _] in &points {
                let (before, after) = (profile.derivative(x - 1e-9), profile.derivative(x + 1e-9));
                assert!((before - after).abs() < 1e-4);
            }
            for _ in 0..50 {
                let x = random.between(-2.0, 12.0);
                let h = 1e-6;
                let difference = (profile.value(x + h) - profile.value(x - h)) / (2.0 * h);
                let slack = 1e-3 * (1.0 + difference.abs());
                assert!((difference - profile.derivative(x)).abs() < slack);
            }
        }
    }

    #[test]
    fn ends_continue_as_asked() {
        let points = [[0.0, 1.0], [0.5, 0.6], [1.0, 1.0]];
        let constant = Profile::through(&points).unwrap();
        assert_eq!(
            (constant.value(-5.0), constant.derivative(-5.0)),
            (1.0, 0.0)
        );
        assert_eq!((constant.value(7.0), constant.value(0.5)), (1.0, 0.6));
        assert_eq!(constant.derivative(0.5), 0.0);
        assert_eq!(constant.smoothness(), Smoothness::C(0));
        let linear = Profile::through_with_ends(&points, Ends::Linear).unwrap();
        let slope = linear.derivative(0.0);
        assert!((linear.value(-1.0) - (1.0 - slope)).abs() < 1e-15);
        // Level ends: C¹ though constant beyond.
        let level = Profile::through(&[[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [3.0, 1.0]]).unwrap();
        assert_eq!(level.smoothness(), Smoothness::C(1));
        assert_eq!(
            Profile::through(&[[3.0, 2.0]]).unwrap().as_constant(),
            Some(2.0)
        );
        let flat = Profile::through(&[[0.0, 2.0], [1.0, 2.0], [4.0, 2.0]]).unwrap();
        assert_eq!(flat.as_constant(), Some(2.0));
        assert_eq!(constant.as_constant(), None);
    }

    #[test]
    fn straight_lines_stay_straight() {
        let points: Vec<[f64; 2]> = [0.0, 0.3, 1.0, 1.1, 5.0]
            .iter()
            .map(|&x| [x, 2.0 - 0.7 * x])
            .collect();
        let profile = Profile::through_with_ends(&points, Ends::Linear).unwrap();
        for i in -20..80 {
            let x = f64::from(i) * 0.1;
            assert!((profile.value(x) - (2.0 - 0.7 * x)).abs() < 1e-14);
        }
    }

    #[test]
    fn integrals() {
        let mut random = Random::new(53);
        let mut profiles = vec![Profile::polynomial(&[0.3, -1.0, 0.5, 2.0]).unwrap()];
        for count in [2, 3, 9, 40] {
            profiles.push(Profile::through(&random_points(&mut random, count)).unwrap());
        }
        for profile in &profiles {
            for _ in 0..10 {
                let (a, b) = (random.between(-2.0, 2.0), random.between(0.0, 6.0));
                let n = 20_000;
                let h = (b - a) / f64::from(n);
                let sum: f64 = (0..n)
                    .map(|i| profile.value(a + (f64::from(i) + 0.5) * h) * h)
                    .sum();
                assert!((profile.integral(a, b) - sum).abs() < 1e-5 * (1.0 + sum.abs()));
            }
        }
    }

    #[test]
    fn blocks_equal_scalars_bit_for_bit() {
        let mut random = Random::new(54);
        let mut profiles = vec![
            Profile::constant(0.4).unwrap(),
            Profile::linear(1.0, -0.5).unwrap(),
            Profile::polynomial(&[0.1, 0.0, -2.0, 0.3, 1.0]).unwrap(),
        ];
        for count in [1, 2, 3, 8, 9, 16, 17, 60] {
            profiles.push(Profile::through(&random_points(&mut random, count)).unwrap());
        }
        for profile in &profiles {
            for _ in 0..200 {
                let x: [f64; 8] = core::array::from_fn(|_| random.between(-3.0, 30.0));
                let (value, derivative) = profile.values_block(&x);
                for lane in 0..8 {
                    let (v, d) = profile.value_and_derivative(x[lane]);
                    assert_eq!(value[lane].to_bits(), v.to_bits());
                    assert_eq!(derivative[lane].to_bits(), d.to_bits());
                }
            }
        }
    }

    #[test]
    fn bad_points_are_named() {
        assert_eq!(Profile::through(&[]), Err(ProfileError::Empty));
        assert_eq!(Profile::polynomial(&[]), Err(ProfileError::Empty));
        let nan = Profile::through(&[[0.0, 1.0], [f64::NAN, 1.0]]);
        assert_eq!(nan, Err(ProfileError::NotFinite { index: 1 }));
        let equal = Profile::through(&[[0.0, 1.0], [1.0, 1.0], [1.0, 2.0]]);
        assert!(matches!(
            equal,
            Err(ProfileError::NotIncreasing { index: 2, .. })
        ));
        let steep = Profile::through(&[[0.0, -1e308], [1e-300, 1e308], [1.0, 0.0]]);
        assert!(matches!(steep, Err(ProfileError::TooSteep { index: 1 })));
        assert!(Profile::linear(f64::INFINITY, 0.0).is_err());
    }
}
