//! Dense symmetric systems of linear equations, and how well their solutions are determined.
//!
//! Computes `A x = b` by `L U` factors with partial pivoting, in blocks of columns, with one step of iterative refinement, and
//! an estimate of the condition number `‖A‖₁ ‖A⁻¹‖₁`.
//!
//! Decision: our own factors rather than a library's, because those of the usual libraries fuse multiplications and additions
//! where the processor can, and the digits of a result would depend on it. Here every entry is computed by the same
//! operations everywhere.
//!
//! *Source*: G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed. 2013, §3.4–3.5; the estimate is W. W. Hager's,
//! *Condition Estimates*, SIAM J. Sci. Stat. Comput. 5, 1984.

use anamorph_core::simd::{Level, dispatch};

/// Columns that are eliminated together.
const BLOCK: usize = 32;

/// A symmetric matrix and its factors.
pub(super) struct Symmetric {
    size: usize,
    matrix: Vec<f64>,
    factors: Vec<f64>,
    /// Row `i` of the factors is row `order[i]` of the matrix.
    order: Vec<usize>,
}

/// `target −= Σ factor_k · row_k`, four rows at a time.
#[inline(always)]
fn subtract(target: &mut [f64], factors: &[f64], rows: &[f64], width: usize, from: usize) {
    let mut k = 0;
    while k + 4 <= factors.len() {
        let f = [factors[k], factors[k + 1], factors[k + 2], factors[k + 3]];
        let row = |i: usize| &rows[(k + i) * width + from..][..target.len()];
        let (a, b, c, d) = (row(0), row(1), row(2), row(3));
        for (j, t) in target.iter_mut().enumerate() {
            *t -= (f[0] * a[j] + f[1] * b[j]) + (f[2] * c[j] + f[3] * d[j]);
        }
        k += 4;
    }
    for (k, &factor) in factors.iter().enumerate().skip(k) {
        let row = &rows[k * width + from..][..target.len()];
        for (t, &a) in target.iter_mut().zip(row) {
            *t -= factor * a;
        }
    }
}

/// Factors in place; `None` where no pivot is left.
#[inline(always)]
fn factor(a: &mut [f64], n: usize) -> Option<Vec<usize>> {
    let mut order: Vec<usize> = (0..n).collect();
    for start in (0..n).step_by(BLOCK) {
        let end = (start + BLOCK).min(n);
        for k in start..end {
            let size = |i: &usize| a[i * n + k].abs();
            let pivot = (k..n).max_by(|i, j| size(i).total_cmp(&size(j)))?;
            if !(size(&pivot) > 0.0 && size(&pivot).is_finite()) {
                return None;
            }
            if pivot != k {
                let (above, below) = a.split_at_mut(pivot * n);
                above[k * n..(k + 1) * n].swap_with_slice(&mut below[..n]);
                order.swap(k, pivot);
            }
            let (above, below) = a.split_at_mut((k + 1) * n);
            let top = &above[k * n..];
            for row in below.chunks_exact_mut(n) {
                let factor = row[k] / top[k];
                row[k] = factor;
                for (x, &t) in row[k + 1..end].iter_mut().zip(&top[k + 1..end]) {
                    *x -= factor * t;
                }
            }
        }
        if end == n {
            break;
        }
        for k in start..end {
            let (above, row) = a.split_at_mut(k * n);
            let (factors, target) = row[..n].split_at_mut(end);
            subtract(target, &factors[start..k], &above[start * n..], n, end);
        }
        let (above, below) = a.split_at_mut(end * n);
        for row in below.chunks_exact_mut(n) {
            let (factors, target) = row.split_at_mut(end);
            subtract(target, &factors[start..], &above[start * n..], n, end);
        }
    }
    Some(order)
}

impl Symmetric {
    /// Factors of a matrix of `size` rows, one after the other. `None` if it is singular.
    pub(super) fn new(size: usize, matrix: Vec<f64>) -> Option<Self> {
        let mut factors = matrix.clone();
        let order = dispatch!(Level::new(), _v => factor(&mut factors, size))?;
        Some(Self {
            size,
            matrix,
            factors,
            order,
        })
    }

    fn solve_once(&self, right: &[f64]) -> Vec<f64> {
        let n = self.size;
        let mut x: Vec<f64> = self.order.iter().map(|&i| right[i]).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for i in 0..n {
            x[i] -= dot(&self.factors[i * n..][..i], &x[..i]);
        }
        for i in (0..n).rev() {
            let row = &self.factors[i * n..][..n];
            x[i] = (x[i] - dot(&row[i + 1..], &x[i + 1..])) / row[i];
        }
        x
    }

    /// The solution for a right side.
    pub(super) fn solve(&self, right: &[f64]) -> Vec<f64> {
        let mut x = self.solve_once(right);
        let rows = self.matrix.chunks_exact(self.size).zip(right);
        let rest: Vec<f64> = rows
            .map(|(row, b)| row.iter().zip(&x).fold(*b, |rest, (a, x)| rest - a * x))
            .collect();
        for (x, change) in x.iter_mut().zip(self.solve_once(&rest)) {
            *x += change;
        }
        x
    }

    /// An estimate of the condition number, never above the true one but for rounding.
    pub(super) fn condition(&self) -> f64 {
        let n = self.size;
        let sum = |list: &[f64]| list.iter().map(|x| x.abs()).sum::<f64>();
        let norm = self.matrix.chunks_exact(n).map(sum).fold(0.0, f64::max);
        norm * norm_of_inverse(n, |right| Some(self.solve_once(right)))
    }
}

/// An estimate of `‖A⁻¹‖₁` of a symmetric matrix of `size` rows from solutions of `A x = b`; infinite where there is none.
pub(super) fn norm_of_inverse(
    size: usize,
    mut solve: impl FnMut(&[f64]) -> Option<Vec<f64>>,
) -> f64 {
    #[allow(clippy::cast_precision_loss)]
    let mut probe = vec![1.0 / size as f64; size];
    let mut inverse = 0.0_f64;
    for _ in 0..5 {
        let Some(y) = solve(&probe) else {
            return f64::INFINITY;
        };
        inverse = inverse.max(y.iter().map(|x| x.abs()).sum());
        let signs: Vec<f64> = y.iter().map(|y| y.signum()).collect();
        // The matrix is its own transpose, and so is its inverse.
        let Some(z) = solve(&signs) else {
            return f64::INFINITY;
        };
        let best = (0..size).max_by(|&i, &j| z[i].abs().total_cmp(&z[j].abs()));
        let reached: f64 = z.iter().zip(&probe).map(|(z, x)| z * x).sum();
        match best {
            Some(best) if z[best].abs() > reached => {
                probe.fill(0.0);
                probe[best] = 1.0;
            }
            _ => break,
        }
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hilbert_matrices_are_solved_and_their_condition_is_known() {
        // ‖A‖₁ ‖A⁻¹‖₁ of the Hilbert matrices of 3 and 6 rows.
        for (n, condition) in [(3, 748.0), (6, 29_070_279.0)] {
            let entry = |i: usize, j: usize| 1.0 / (i + j + 1) as f64;
            let matrix: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
            let right: Vec<f64> = matrix.chunks(n).map(|row| row.iter().sum()).collect();
            let system = Symmetric::new(n, matrix).unwrap();
            for x in system.solve(&right) {
                assert!((x - 1.0).abs() < 1e-16 * condition, "{x}");
            }
            assert!((system.condition() / condition - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn more_rows_than_a_block_with_zeros_on_the_diagonal() {
        let n = 150;
        let entry = |i: usize, j: usize| {
            let (i, j) = (i.min(j), i.max(j));
            if i == j {
                0.0
            } else {
                ((i * 7919 + j * 104_729) % 1000) as f64 / 500.0 - 1.0
            }
        };
        let matrix: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
        let wanted: Vec<f64> = (0..n).map(|i| (i % 13) as f64 - 6.0).collect();
        let dot = |row: &[f64]| row.iter().zip(&wanted).map(|(a, x)| a * x).sum();
        let right: Vec<f64> = matrix.chunks(n).map(dot).collect();
        let system = Symmetric::new(n, matrix).unwrap();
        for (x, wanted) in system.solve(&right).iter().zip(&wanted) {
            assert!((x - wanted).abs() < 1e-9, "{x}, {wanted}");
        }
    }

    #[test]
    fn singular_matrices_are_refused() {
        assert!(Symmetric::new(2, vec![0.0, 0.0, 0.0, 1.0]).is_none());
        assert!(Symmetric::new(1, vec![f64::NAN]).is_none());
    }
}
