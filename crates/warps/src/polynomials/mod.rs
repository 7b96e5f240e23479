//! Polynomials of the coordinates, fitted to pairs of points.
//!
//! Computes `p̃ = p + Σ_k c_k m_k(p)` over the monomials `m_k` of a degree, of coordinates about the middle of the source points in
//! units of half their size; the coefficients minimize `Σ_j ‖p̃(P_j) − P*_j‖²`. As terms of eq. (3): the coefficients are
//! translations, the monomials their strengths, summed without an average. The fit is by Householder reflections of the columns, the
//! longest first, which tells what the points leave open.
//!
//! *Source*: G. Wolberg, *Digital Image Warping*, IEEE Computer Society Press 1990, §3.6; G. H. Golub, C. F. Van Loan, *Matrix
//! Computations*, 4th ed. 2013, §5.4.

#[cfg(feature = "recipe")]
pub(crate) mod parameters;

use anamorph_core::{
    Address, Affine, Average, Bounds, Condition, Deformation, Facts, Influences, Linear, Mark,
    Site, Smoothness, Space, Support, Unmapped, Warp, evaluate, evaluate_points,
};
use anamorph_features::PointPair;

/// Highest degree.
pub const HIGHEST_DEGREE: usize = 5;
/// A column that keeps less than this share of the longest is a combination of those before it.
const DEPENDENT: f64 = 1e-11;

/// What is wrong with a polynomial warp.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PolynomialError {
    /// A degree out of range.
    #[error("the degree is {degree}, and must be 1 to {HIGHEST_DEGREE}")]
    Degree {
        /// The degree given.
        degree: usize,
    },
    /// Fewer points than coefficients.
    #[error(
        "{points} points do not determine a polynomial of degree {degree}, which has {needed} coefficients for each coordinate; \
             give {needed} points at least, or take a lower degree"
    )]
    TooFew {
        /// How many points.
        points: usize,
        /// How many are needed.
        needed: usize,
        /// The degree.
        degree: usize,
    },
    /// A point that is not finite.
    #[error(
        "point {point} has a coordinate that is not finite, or is too far from the others; give finite numbers"
    )]
    NotFinite {
        /// Number of the point.
        point: usize,
    },
    /// Points that leave coefficients open.
    #[error(
        "the {points} points determine {rank} of the {needed} coefficients of degree {degree} only (condition number {condition:.1e}): they lie \
             on a curve or surface of that degree, or in too few places; spread them, or take a lower degree"
    )]
    Dependent {
        /// How many points.
        points: usize,
        /// How many coefficients they determine.
        rank: usize,
        /// How many there are.
        needed: usize,
        /// The degree.
        degree: usize,
        /// The ratio of the longest column to the first that is dependent; infinite where nothing is left of it.
        condition: f64,
    },
}

/// A polynomial fitted to pairs of points.
#[derive(Debug, Clone, PartialEq)]
pub struct PolynomialWarp<S: Space> {
    pairs: Vec<PointPair<S>>,
    degree: usize,
    centre: S,
    scale: f64,
    /// Exponents of the monomials.
    exponents: Vec<[u8; 3]>,
    coefficients: Vec<S>,
    condition: f64,
}

/// Exponents of all monomials of a degree, lower ones first.
fn exponents(axes: usize, degree: usize) -> Vec<[u8; 3]> {
    let mut all = Vec::new();
    for total in 0..=degree {
        for x in (0..=total).rev() {
            for y in (0..=total - x).rev() {
                let z = total - x - y;
                if axes == 3 || z == 0 {
                    #[allow(clippy::cast_possible_truncation)]
                    all.push([x as u8, y as u8, z as u8]);
                }
            }
        }
    }
    all
}

/// Powers of the coordinates of a place, from 0 on.
fn powers<S: Space>(place: S) -> [[f64; HIGHEST_DEGREE + 1]; 3] {
    let mut powers = [[1.0; HIGHEST_DEGREE + 1]; 3];
    for (axis, row) in powers.iter_mut().enumerate().take(S::DIM) {
        for i in 1..row.len() {
            row[i] = row[i - 1] * place.component(axis);
        }
    }
    powers
}

#[inline]
fn monomial(powers: &[[f64; HIGHEST_DEGREE + 1]; 3], exponents: [u8; 3]) -> f64 {
    let [x, y, z] = exponents.map(usize::from);
    powers[0][x] * powers[1][y] * powers[2][z]
}

/// Coefficients of least squares, or how many columns are independent and the condition number.
///
/// `columns` holds the columns of the matrix, `right` the right sides, as vectors.
fn least_squares<S: Space>(
    mut columns: Vec<Vec<f64>>,
    mut right: Vec<S>,
) -> Result<(Vec<S>, f64), (usize, f64)> {
    let count = columns.len();
    let mut order: Vec<usize> = (0..count).collect();
    let (mut longest, mut shortest) = (0.0_f64, f64::INFINITY);
    for k in 0..count {
        let length = |column: &Vec<f64>| column[k..].iter().map(|x| x * x).sum::<f64>().sqrt();
        let lengths = columns.iter().map(length).enumerate().skip(k);
        let (best, norm) = lengths
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((k, 0.0));
        longest = longest.max(norm);
        if norm <= DEPENDENT * longest || norm.is_nan() {
            return Err((k, longest / norm));
        }
        shortest = norm.min(shortest);
        columns.swap(k, best);
        order.swap(k, best);
        // The reflection that takes the rest of the column onto its first axis.
        let mut mirror = columns[k][k..].to_vec();
        let along = if mirror[0] > 0.0 { -norm } else { norm };
        mirror[0] -= along;
        let size: f64 = mirror.iter().map(|x| x * x).sum();
        for column in &mut columns[k..] {
            let dot: f64 = mirror.iter().zip(&column[k..]).map(|(a, b)| a * b).sum();
            let factor = 2.0 * dot / size;
            for (x, m) in column[k..].iter_mut().zip(&mirror) {
                *x -= factor * m;
            }
        }
        let dot = mirror.iter().zip(&right[k..]);
        let dot = dot.fold(S::ZERO, |sum, (&m, &r)| sum + r * m);
        for (r, &m) in right[k..].iter_mut().zip(&mirror) {
            *r -= dot * (2.0 / size * m);
        }
    }
    let mut solution = vec![S::ZERO; count];
    for k in (0..count).rev() {
        let known = (k + 1..count).fold(S::ZERO, |sum, j| sum + solution[order[j]] * columns[j][k]);
        solution[order[k]] = (right[k] - known) / columns[k][k];
    }
    Ok((solution, longest / shortest))
}

impl<S: Space> PolynomialWarp<S> {
    /// The polynomial of a degree from 1 to [`HIGHEST_DEGREE`] that comes nearest to the pairs.
    ///
    /// # Errors
    /// [`PolynomialError`] for a degree out of range, numbers that are not finite, and too few or dependent points.
    pub fn construct(pairs: Vec<PointPair<S>>, degree: usize) -> Result<Self, PolynomialError> {
        if !(1..=HIGHEST_DEGREE).contains(&degree) {
            return Err(PolynomialError::Degree { degree });
        }
        let exponents = exponents(S::DIM, degree);
        let (points, needed) = (pairs.len(), exponents.len());
        if points < needed {
            return Err(PolynomialError::TooFew {
                points,
                needed,
                degree,
            });
        }
        let finite = |pair: &PointPair<S>| pair.source.is_finite() && pair.target.is_finite();
        if let Some(point) = pairs.iter().position(|pair| !finite(pair)) {
            return Err(PolynomialError::NotFinite { point });
        }
        let sources: Vec<S> = pairs.iter().map(|pair| pair.source).collect();
        let bounds = Bounds::of(&sources).unwrap_or(Bounds::new(S::ZERO, S::ZERO));
        let half = 0.5 * bounds.diagonal();
        let mut warp = Self {
            degree,
            centre: bounds.centre(),
            scale: if half > 0.0 { 1.0 / half } else { 1.0 },
            exponents,
            coefficients: Vec::new(),
            condition: 1.0,
            pairs,
        };
        let places: Vec<_> = sources.iter().map(|&p| powers(warp.place(p))).collect();
        let column = |&e: &[u8; 3]| places.iter().map(|place| monomial(place, e)).collect();
        let columns: Vec<Vec<f64>> = warp.exponents.iter().map(column).collect();
        let moves: Vec<S> = warp
            .pairs
            .iter()
            .map(|pair| pair.target - pair.source)
            .collect();
        let number = columns.iter().flatten().all(|x| x.is_finite());
        if let Some(point) = moves.iter().position(|d| !(d.is_finite() && number)) {
            return Err(PolynomialError::NotFinite { point });
        }
        let (coefficients, condition) =
            least_squares(columns, moves).map_err(|(rank, condition)| {
                PolynomialError::Dependent {
                    points,
                    rank,
                    needed,
                    degree,
                    condition,
                }
            })?;
        (warp.coefficients, warp.condition) = (coefficients, condition);
        Ok(warp)
    }

    fn place(&self, p: S) -> S {
        (p - self.centre) * self.scale
    }

    /// The pairs that it was fitted to.
    pub fn pairs(&self) -> &[PointPair<S>] {
        &self.pairs
    }

    /// The ratio of the longest to the shortest column of the triangle that was solved: an estimate of the condition number.
    pub fn condition(&self) -> f64 {
        self.condition
    }

    /// Points and arrows for pictures.
    pub fn marks(&self) -> Vec<Mark<S>> {
        self.pairs.iter().flat_map(PointPair::<S>::marks).collect()
    }
}

impl<S: Space> Deformation<S> for PolynomialWarp<S> {
    fn map(&self, site: &Site<S>) -> S {
        evaluate(self, site)
    }
    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        evaluate_points(self, first, points)
    }
    fn facts(&self) -> Facts<S> {
        if self.coefficients.iter().all(|c| *c == S::ZERO) {
            return Facts::identity();
        }
        Facts {
            support: Support::Everywhere,
            inside: Smoothness::Smooth,
            edge: Smoothness::Smooth,
            ..Facts::identity()
        }
    }

    /// `J = I + Σ c_k ∇m_kᵀ`.
    fn jacobian(&self, site: &Site<S>, _: f64) -> Option<S::Linear> {
        let powers = powers(self.place(site.point));
        let mut sum = S::Linear::ZERO;
        for (&c, &e) in self.coefficients.iter().zip(&self.exponents) {
            let gradient = S::from_fn(|axis| {
                let Some(lower) = e[axis].checked_sub(1) else {
                    return 0.0;
                };
                let mut less = e;
                less[axis] = lower;
                f64::from(e[axis]) * monomial(&powers, less)
            });
            sum = sum + S::Linear::outer(c, gradient);
        }
        Some(S::Linear::IDENTITY + sum * self.scale)
    }
}

impl<S: Space> Warp<S> for PolynomialWarp<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        let powers = powers(self.place(site.point));
        for (k, &e) in self.exponents.iter().enumerate() {
            let strength = monomial(&powers, e);
            if strength != 0.0 {
                let address = Address::of(u32::try_from(k).unwrap_or(u32::MAX));
                out.push(address, strength, 1.0);
            }
        }
    }
    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        let coefficient = self.coefficients.get(address.feature as usize);
        Affine::translation(coefficient.copied().unwrap_or(S::ZERO) * strength)
    }
    fn average(&self) -> Average {
        Average::Plain
    }
    fn conditions(&self) -> Vec<Condition<S>> {
        let all = self.pairs.iter().enumerate();
        all.map(|(feature, pair)| Condition {
            feature: u32::try_from(feature).unwrap_or(u32::MAX),
            source: pair.source,
            target: pair.target,
        })
        .collect()
    }
}
