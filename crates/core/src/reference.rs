//! The literal evaluator of eq. (3): slow, plain, and kept forever as the reference for every kernel.
//!
//! Forms the homogeneous matrices `A_i` of `s_i·T_i`, normalizes the weights by their sum, adds
//! `D = I + Σ ŵ_i (A_i − I)` entry by entry and applies it. Shares no code with the engine beyond the trait it reads.
//!
//! *Source*: Milliron et al. 2002, eq. (3); errata F4 (`Σw = 0`: identity; ambient), F5 (matrix form), F6/F9 (infinite
//! weights decide alone).

use crate::{Average, Influences, Linear, Site, Space, Term, Warp};

type Matrix = [[f64; 4]; 4];

fn homogeneous<S: Space>(affine: &crate::Affine<S>) -> Matrix {
    let mut matrix = [[0.0; 4]; 4];
    for (row, entries) in matrix.iter_mut().enumerate().take(S::DIM) {
        for (column, entry) in entries.iter_mut().enumerate().take(S::DIM) {
            *entry = affine.linear.entry(row, column);
        }
        entries[S::DIM] = affine.translation.component(row);
    }
    matrix[S::DIM][S::DIM] = 1.0;
    matrix
}

fn apply<S: Space>(matrix: &Matrix, p: S) -> S {
    S::from_fn(|row| {
        let linear: f64 = (0..S::DIM)
            .map(|column| matrix[row][column] * p.component(column))
            .sum();
        linear + matrix[row][S::DIM]
    })
}

fn average<S: Space>(parts: &[(Matrix, f64)], how: Average, log_scale: f64, p: S) -> S {
    let mut weights: Vec<f64> = parts.iter().map(|(_, w)| *w).collect();
    if weights.contains(&f64::INFINITY) {
        for w in &mut weights {
            *w = if *w == f64::INFINITY { 1.0 } else { 0.0 };
        }
        let count: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|w| *w /= count);
    } else {
        let scale = crate::math::exp(log_scale);
        let total = match how {
            Average::Weights => weights.iter().sum(),
            Average::Ambient(epsilon) => weights.iter().sum::<f64>() + epsilon / scale,
            Average::Plain => 1.0 / scale,
        };
        if total == 0.0 {
            return p;
        }
        weights.iter_mut().for_each(|w| *w /= total);
    }
    let mut d = [[0.0; 4]; 4];
    for row in 0..=S::DIM {
        for column in 0..=S::DIM {
            let identity = if row == column { 1.0 } else { 0.0 };
            d[row][column] = identity;
            for ((a, _), w) in parts.iter().zip(&weights) {
                d[row][column] += w * (a[row][column] - identity);
            }
        }
    }
    apply(&d, p)
}

/// Eq. (3) for a warp at one site, from its influences and transformations.
pub fn evaluate<S: Space, W: Warp<S> + ?Sized>(warp: &W, site: &Site<S>) -> S {
    let mut influences = Influences::default();
    warp.influences(site, &mut influences);
    let parts: Vec<(Matrix, f64)> = influences
        .list
        .iter()
        .map(|influence| {
            let matrix = homogeneous(&warp.scaled(influence.address, influence.strength));
            let weight = warp.weight(influence, apply(&matrix, site.point) - site.point);
            (matrix, weight)
        })
        .collect();
    average(&parts, warp.average(), influences.log_scale, site.point)
}

/// Eq. (3) for explicit terms at one site.
pub fn evaluate_terms<S: Space>(terms: &[Term<S>], how: Average, site: &Site<S>) -> S {
    let parts: Vec<(Matrix, f64)> = terms
        .iter()
        .map(|t| {
            (
                homogeneous(&t.transformation.scaled(t.strength.value(site))),
                t.weight.value(site),
            )
        })
        .collect();
    average(&parts, how, 0.0, site.point)
}
