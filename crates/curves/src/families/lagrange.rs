//! Lagrange interpolation: one polynomial through all points.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Lagrange polynomial", in the barycentric form of J.-P. Berrut and
//! L. N. Trefethen, *Barycentric Lagrange interpolation*, SIAM Review 46(3), 2004 (errata C3), derivatives by C. Schneider
//! and W. Werner, *Some new aspects of rational interpolation*, Math. Comp. 47, 1986. Through many points at even nodes the
//! polynomial swings widely between them (Runge): at most [`MAX_NODES`] points are taken.

use crate::bezier::Pieces;
use crate::error::{enough, increasing};
use crate::{Bezier, CurveError};
use anamorph_core::{Curve, Differentiable, Jet, Space};

/// The most points: with 33 even nodes a rounding of the data is already magnified a hundred million times.
pub const MAX_NODES: usize = 33;

/// The polynomial through points at nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Lagrange<S> {
    nodes: Vec<f64>,
    points: Vec<S>,
    weights: Vec<f64>,
    /// Values of the first three derivatives at the nodes.
    derivatives: [Vec<S>; 3],
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
    /// increase, or points so wild that the polynomial is not finite.
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
        let first = differentiated(&nodes, &weights, &points);
        let second = differentiated(&nodes, &weights, &first);
        let third = differentiated(&nodes, &weights, &second);
        Ok(Self {
            nodes,
            points,
            weights,
            derivatives: [first, second, third],
            bezier,
        })
    }

    /// The same polynomial as a Bézier curve over `[0, 1]`. Exact to about 2ⁿ roundings of the data.
    #[must_use]
    pub fn to_bezier(&self) -> &Bezier<S> {
        &self.bezier
    }

    /// The polynomial with given values at the nodes, at `u`: the values themselves at nodes.
    fn interpolate(&self, values: &[S], u: f64) -> S {
        let (mut above, mut below) = (S::ZERO, 0.0);
        for ((x, w), value) in self.nodes.iter().zip(&self.weights).zip(values) {
            let d = u - x;
            if d == 0.0 {
                return *value;
            }
            let share = w / d;
            above += *value * share;
            below += share;
        }
        let value = above / below;
        if value.is_finite() { value } else { values[0] }
    }
}

/// Values of the derivative at the nodes, from values of a polynomial there.
fn differentiated<S: Space>(nodes: &[f64], weights: &[f64], values: &[S]) -> Vec<S> {
    let rows = 0..nodes.len();
    rows.map(|i| {
        let mut sum = S::ZERO;
        for j in 0..nodes.len() {
            if j != i {
                let entry = weights[j] / weights[i] / (nodes[i] - nodes[j]);
                sum += (values[j] - values[i]) * entry;
            }
        }
        sum
    })
    .collect()
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
        self.interpolate(&self.points, self.within(parameter))
    }
}

impl<S: Space> Differentiable<S> for Lagrange<S> {
    fn jet(&self, parameter: f64) -> Jet<S> {
        let u = self.within(parameter);
        let [first, second, third] = &self.derivatives;
        Jet {
            point: self.interpolate(&self.points, u),
            first: self.interpolate(first, u),
            second: self.interpolate(second, u),
            third: self.interpolate(third, u),
        }
    }

    fn velocity(&self, parameter: f64) -> S {
        self.interpolate(&self.derivatives[0], self.within(parameter))
    }

    fn breaks(&self) -> Vec<f64> {
        let (start, end) = self.domain();
        vec![start, end]
    }
}

impl<S: Space> Pieces<S> for Lagrange<S> {
    fn bezier_pieces(&self) -> Vec<(f64, f64, Bezier<S>)> {
        let (start, end) = self.domain();
        vec![(start, end, self.bezier.clone())]
    }
}
