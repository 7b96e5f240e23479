//! Lagrange interpolation: one polynomial through all points.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Lagrange polynomial", in the barycentric form of J.-P. Berrut and
//! L. N. Trefethen, *Barycentric Lagrange interpolation*, SIAM Review 46(3), 2004 (errata C3). Derivatives are those of its
//! Chebyshev series between each two nodes (L. N. Trefethen, *Approximation Theory and Approximation Practice*, 2013, chapters
//! 3 and 19): differences of the barycentric form would lose to rounding what the polynomial's swings gain, and lengths
//! would be integrals of noise. Through many points at even nodes the polynomial swings widely between them (Runge): at most
//! [`MAX_NODES`] points are taken.

use crate::bezier::Pieces;
use crate::error::{enough, increasing};
use crate::{Bezier, CurveError};
use anamorph_core::{Curve, Differentiable, Jet, Space};

/// The most points: with 33 even nodes a rounding of the data is already magnified a hundred million times.
pub const MAX_NODES: usize = 33;

/// Nodes are at least this share of their whole width apart: what is nearer would be told apart by rounding alone.
const CLOSEST: f64 = 1e-9;
/// Widths of the nodes from which derivatives and their squares stay within the range of numbers.
const WIDTHS: core::ops::RangeInclusive<f64> = 1e-50..=1e50;
/// Chebyshev coefficients below this share of the largest are rounding.
const ROUNDING: f64 = 2e-16;

/// The polynomial through points at nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Lagrange<S> {
    nodes: Vec<f64>,
    points: Vec<S>,
    weights: Vec<f64>,
    /// Between each two nodes, the Chebyshev coefficients of the first three derivatives.
    derivatives: Vec<[Vec<S>; 3]>,
    bezier: Bezier<S>,
}

impl<S: Space> Lagrange<S> {
    /// Through `points` at nodes 0, 1, 2, ….
    ///
    /// # Errors
    ///
    /// As [`Self::at_nodes`].
    pub fn new(points: Vec<S>) -> Result<Self, CurveError> {
        let nodes = (0..points.len()).map(|i| i as f64).collect();
        Self::at_nodes(nodes, points)
    }

    /// Through `points` at `nodes`, which increase.
    ///
    /// # Errors
    ///
    /// Fewer than 2 or more than [`MAX_NODES`] points, another number of nodes, numbers that are not finite, nodes that do not
    /// increase, that are nearer than a billionth of their width or whose width is not between 1e-50 and 1e50, or points so
    /// wild that the polynomial is not finite.
    pub fn at_nodes(nodes: Vec<f64>, points: Vec<S>) -> Result<Self, CurveError> {
        enough("a Lagrange curve", 2, &points)?;
        if points.len() > MAX_NODES {
            return Err(CurveError::WrongCount {
                what: "a Lagrange curve",
                needed: "2 to 33",
                found: points.len(),
            });
        }
        increasing("node", &nodes)?;
        if nodes.len() != points.len() {
            return Err(CurveError::Mismatch {
                what: "nodes",
                found: nodes.len(),
                needed: points.len(),
                of: "points",
                expected: points.len(),
            });
        }
        let width = nodes[nodes.len() - 1] - nodes[0];
        if !WIDTHS.contains(&width) {
            return Err(CurveError::OutOfRange {
                name: "the distance from the first node to the last",
                value: width,
                range: "from 1e-50 to 1e50",
            });
        }
        if let Some(i) = nodes
            .windows(2)
            .position(|pair| pair[1] - pair[0] < CLOSEST * width)
        {
            return Err(CurveError::ElementOutOfRange {
                what: "node",
                index: i + 1,
                value: nodes[i + 1],
                range: "greater than the one before it by at least a billionth of the distance from the first node to the \
                        last",
            });
        }
        // Weights scale out; differences of the whole width 4 keep products from over- and underflow.
        let weights = nodes.iter().enumerate().map(|(j, x)| {
            let others = nodes.iter().enumerate().filter(|(k, _)| *k != j);
            1.0 / others.map(|(_, y)| (x - y) / width * 4.0).product::<f64>()
        });
        let weights: Vec<f64> = weights.collect();
        if let Some(index) = weights.iter().position(|w| !w.is_finite()) {
            return Err(CurveError::NotFinite {
                what: "the distance to another node of node",
                index,
            });
        }
        let bezier = bernstein_form(&nodes, &points, width)?;
        let mut curve = Self {
            nodes,
            points,
            weights,
            derivatives: Vec::new(),
            bezier,
        };
        curve.derivatives = curve.differentiated();
        let all = curve.derivatives.iter().flatten().flatten();
        if all.into_iter().any(|coefficient| !coefficient.is_finite()) {
            return Err(CurveError::NotFinite {
                what: "a derivative near point",
                index: 0,
            });
        }
        Ok(curve)
    }

    /// The same polynomial as a Bézier curve over `[0, 1]`. Exact to about 2ⁿ roundings of the data.
    #[must_use]
    pub fn to_bezier(&self) -> &Bezier<S> {
        &self.bezier
    }

    /// When which point is passed.
    #[must_use]
    pub fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// The point at `base + step`, where the distance from `base` to each node is exact; the points themselves at nodes.
    fn at(&self, base: f64, step: f64) -> S {
        let (mut above, mut below) = (S::ZERO, 0.0);
        for ((x, w), value) in self.nodes.iter().zip(&self.weights).zip(&self.points) {
            let d = (base - x) + step;
            if d == 0.0 {
                return *value;
            }
            let share = w / d;
            above += *value * share;
            below += share;
        }
        let value = above / below;
        if value.is_finite() {
            value
        } else {
            self.points[0]
        }
    }

    /// The Chebyshev coefficients of the first three derivatives between each two nodes.
    fn differentiated(&self) -> Vec<[Vec<S>; 3]> {
        use anamorph_core::math;
        let n = self.nodes.len();
        // cos(π k / 2n), of which all that follows is made.
        let quarter = core::f64::consts::FRAC_PI_2 / n as f64;
        let cosine = |k: usize| math::cos(quarter * (k % (4 * n)) as f64);
        let cosines: Vec<f64> = (0..4 * n).map(cosine).collect();
        let between = self.nodes.windows(2).map(|pair| {
            let half = 0.5 * (pair[1] - pair[0]);
            let values: Vec<S> = (0..n)
                .map(|k| self.at(pair[0], half * (1.0 + cosines[2 * k + 1])))
                .collect();
            let mut series: Vec<S> = (0..n)
                .map(|i| {
                    let each = values.iter().enumerate();
                    let sum = each.fold(S::ZERO, |sum, (k, value)| {
                        sum + *value * cosines[i * (2 * k + 1) % (4 * n)]
                    });
                    sum * (if i == 0 { 1.0 } else { 2.0 } / n as f64)
                })
                .collect();
            let largest = series.iter().map(|c| c.largest()).fold(0.0, f64::max);
            while series.len() > 2
                && series
                    .last()
                    .is_some_and(|last| last.largest() <= ROUNDING * largest)
            {
                series.pop();
            }
            let first = derived(&series, half);
            let second = derived(&first, half);
            let third = derived(&second, half);
            [first, second, third]
        });
        between.collect()
    }

    /// The derivatives at a parameter of the domain.
    fn derivative(&self, order: usize, u: f64) -> S {
        let behind = self.nodes.partition_point(|x| *x <= u);
        let span = behind.saturating_sub(1).min(self.derivatives.len() - 1);
        let (a, b) = (self.nodes[span], self.nodes[span + 1]);
        let x = 2.0 * ((u - a) / (b - a)) - 1.0;
        summed(&self.derivatives[span][order], x)
    }
}

/// The Chebyshev coefficients of the derivative of a series over an interval of that half-width.
fn derived<S: Space>(series: &[S], half: f64) -> Vec<S> {
    let n = series.len();
    let mut out = vec![S::ZERO; n.saturating_sub(1).max(1)];
    for i in (1..n).rev() {
        let higher = out.get(i + 1).copied().unwrap_or(S::ZERO);
        out[i - 1] = higher + series[i] * (2.0 * i as f64);
    }
    out[0] = out[0] * 0.5;
    for coefficient in &mut out {
        *coefficient = *coefficient / half;
    }
    out
}

/// The value of a Chebyshev series at `x` in `[−1, 1]` (C. W. Clenshaw, 1955).
fn summed<S: Space>(series: &[S], x: f64) -> S {
    let (mut next, mut after) = (S::ZERO, S::ZERO);
    for coefficient in series[1..].iter().rev() {
        (next, after) = (*coefficient + next * (2.0 * x) - after, next);
    }
    series[0] + next * x - after
}

/// Bernstein coefficients by solving for the values at the nodes. The matrix of the system is totally positive, so that
/// elimination without exchanges is as good as any (C. de Boor and A. Pinkus, 1977).
fn bernstein_form<S: Space>(
    nodes: &[f64],
    points: &[S],
    width: f64,
) -> Result<Bezier<S>, CurveError> {
    let n = nodes.len();
    let choose = crate::polynomial::binomials(n - 1);
    let mut rows: Vec<Vec<f64>> = nodes
        .iter()
        .map(|x| {
            let t = (x - nodes[0]) / width;
            let basis = (0..n as u32).zip(&choose);
            basis
                .map(|(k, c)| {
                    use anamorph_core::math::powi;
                    c * powi(t, k) * powi(1.0 - t, n as u32 - 1 - k)
                })
                .collect()
        })
        .collect();
    let mut values = points.to_vec();
    for i in 0..n {
        for j in i + 1..n {
            let factor = rows[j][i] / rows[i][i];
            if factor != 0.0 {
                let above = rows[i].clone();
                for (entry, above) in rows[j].iter_mut().zip(&above).skip(i) {
                    *entry -= factor * above;
                }
                let above = values[i];
                values[j] -= above * factor;
            }
        }
    }
    for i in (0..n).rev() {
        for j in i + 1..n {
            let known = values[j];
            values[i] -= known * rows[i][j];
        }
        values[i] = values[i] / rows[i][i];
    }
    crate::error::finite("the Bézier form of point", &values)?;
    Ok(Bezier::of(values))
}

impl<S: Space> Curve<S> for Lagrange<S> {
    fn domain(&self) -> (f64, f64) {
        (self.nodes[0], self.nodes[self.nodes.len() - 1])
    }

    fn point(&self, parameter: f64) -> S {
        self.at(self.within(parameter), 0.0)
    }
}

impl<S: Space> Differentiable<S> for Lagrange<S> {
    fn jet(&self, parameter: f64) -> Jet<S> {
        let u = self.within(parameter);
        Jet {
            point: self.at(u, 0.0),
            first: self.derivative(0, u),
            second: self.derivative(1, u),
            third: self.derivative(2, u),
        }
    }

    fn velocity(&self, parameter: f64) -> S {
        self.derivative(0, self.within(parameter))
    }

    fn breaks(&self) -> Vec<f64> {
        self.nodes.clone()
    }
}

impl<S: Space> Pieces<S> for Lagrange<S> {
    fn bezier_pieces(&self) -> Vec<(f64, f64, Bezier<S>)> {
        let (start, end) = self.domain();
        vec![(start, end, self.bezier.clone())]
    }
}
