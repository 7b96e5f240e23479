//! Least squares of least norm: what the pseudo-inverse of a square matrix makes of a right side.
//!
//! Computes `x = A⁺ b` by Householder reflections with column pivoting, `A P = Q (R₁; 0)`, and, where `A` has not full rank, a second
//! set of reflections for `R₁ᵀ`, so that of all `x` with the least residual the shortest is found. One step of iterative refinement.
//! Columns whose rest is below a share of the largest count as dependent on those before them.
//!
//! Decision: the complete orthogonal decomposition rather than singular values, as it takes a fixed number of operations; our own
//! rather than a library's, so that every digit is the same on every processor.
//!
//! *Source*: G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed. 2013, §5.4.2 (pivoting) and §5.4.7 (complete orthogonal
//! decomposition); P. Businger, G. H. Golub, *Linear Least Squares Solutions by Householder Transformations*, 1965.

use anamorph_core::simd::{Level, dispatch};

/// Partial sums of a dot product, so that they can be taken together.
const LANES: usize = 8;

/// Reflections that make a matrix triangular, its columns in another order.
struct Triangular {
    rows: usize,
    /// By columns: above the diagonal `R`, on it and below the reflection vectors.
    entries: Vec<f64>,
    /// The diagonal of `R`, as long as the rank.
    diagonal: Vec<f64>,
    /// `2 / vᵀv` of the reflection vectors.
    factors: Vec<f64>,
    /// Column `k` is column `order[k]` of the matrix.
    order: Vec<usize>,
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (heads, tail) = a.as_chunks::<LANES>();
    let (others, rest) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in heads.iter().zip(others) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    for ((sum, a), b) in sums.iter_mut().zip(tail).zip(rest) {
        *sum += a * b;
    }
    sums.iter().sum()
}

/// `target −= factor · v`.
#[inline(always)]
fn subtract(target: &mut [f64], factor: f64, v: &[f64]) {
    for (t, v) in target.iter_mut().zip(v) {
        *t -= factor * v;
    }
}

/// Factors a matrix given by columns; ends where what is left of all columns is at most `negligible` of the first.
#[inline(always)]
fn factor(rows: usize, columns: usize, mut entries: Vec<f64>, negligible: f64) -> Triangular {
    let mut order: Vec<usize> = (0..columns).collect();
    let mut squares: Vec<f64> = entries.chunks_exact(rows).map(|c| dot(c, c)).collect();
    let (mut diagonal, mut factors) = (Vec::new(), Vec::new());
    let mut first = 0.0;
    for k in 0..rows.min(columns) {
        let mut pivot = k;
        for j in k + 1..columns {
            if squares[j] > squares[pivot] {
                pivot = j;
            }
        }
        let norm = squares[pivot].sqrt();
        if k == 0 {
            first = norm;
        }
        if !(norm > negligible * first && norm > 0.0) {
            break;
        }
        if pivot != k {
            let (left, right) = entries.split_at_mut(pivot * rows);
            left[k * rows..][..rows].swap_with_slice(&mut right[..rows]);
            order.swap(k, pivot);
            squares.swap(k, pivot);
        }
        let (left, right) = entries.split_at_mut((k + 1) * rows);
        let vector = &mut left[k * rows + k..];
        let corner = vector[0];
        let end = -norm.copysign(corner);
        vector[0] = corner - end;
        let scale = 1.0 / (norm * (norm + corner.abs()));
        for (column, square) in right.chunks_exact_mut(rows).zip(&mut squares[k + 1..]) {
            let rest = &mut column[k..];
            subtract(rest, scale * dot(vector, rest), vector);
            *square = dot(&rest[1..], &rest[1..]);
        }
        diagonal.push(end);
        factors.push(scale);
    }
    Triangular {
        rows,
        entries,
        diagonal,
        factors,
        order,
    }
}

impl Triangular {
    fn rank(&self) -> usize {
        self.diagonal.len()
    }

    /// The entry of `R` in a row above the diagonal.
    fn above(&self, row: usize, column: usize) -> f64 {
        self.entries[column * self.rows + row]
    }

    /// Reflects by the vector of a column.
    fn reflect(&self, k: usize, x: &mut [f64]) {
        let vector = &self.entries[k * self.rows + k..(k + 1) * self.rows];
        let rest = &mut x[k..];
        subtract(rest, self.factors[k] * dot(vector, rest), vector);
    }
}

/// A square matrix and what its pseudo-inverse takes.
pub(super) struct PseudoInverse {
    size: usize,
    /// By columns.
    matrix: Vec<f64>,
    first: Triangular,
    /// Those of the transposed upper rows, unless the rank is full.
    second: Option<Triangular>,
}

impl PseudoInverse {
    /// Of a matrix of `size` columns, one after the other. Columns of which no more than `negligible` of the longest one is left by those
    /// before count as dependent.
    pub(super) fn new(size: usize, matrix: Vec<f64>, negligible: f64) -> Self {
        let copy = matrix.clone();
        let first = dispatch!(Level::new(), _v => factor(size, size, copy, negligible));
        let rank = first.rank();
        let second = (rank < size).then(|| {
            let mut rows = vec![0.0; size * rank];
            for (i, row) in rows.chunks_exact_mut(size).enumerate() {
                row[i] = first.diagonal[i];
                for (j, entry) in row.iter_mut().enumerate().skip(i + 1) {
                    *entry = first.above(i, j);
                }
            }
            dispatch!(Level::new(), _v => factor(size, rank, rows, 0.0))
        });
        Self {
            size,
            matrix,
            first,
            second,
        }
    }

    /// How many columns are independent.
    pub(super) fn rank(&self) -> usize {
        self.first.rank()
    }

    fn solve_once(&self, right: &[f64]) -> Vec<f64> {
        let first = &self.first;
        let mut c = right.to_vec();
        for k in 0..first.rank() {
            first.reflect(k, &mut c);
        }
        let mut ordered = vec![0.0; self.size];
        if let Some(second) = &self.second {
            // P₂ᵀ R₁ = Tᵀ Q₂ᵀ: forward through Tᵀ, and back by the reflections.
            for i in 0..second.rank() {
                let column = &second.entries[i * second.rows..][..i];
                let known = dot(column, &ordered[..i]);
                ordered[i] = (c[second.order[i]] - known) / second.diagonal[i];
            }
            for k in (0..second.rank()).rev() {
                second.reflect(k, &mut ordered);
            }
        } else {
            for k in (0..self.size).rev() {
                ordered[k] = c[k] / first.diagonal[k];
                let column = &first.entries[k * first.rows..][..k];
                subtract(&mut c[..k], ordered[k], column);
            }
        }
        let mut x = vec![0.0; self.size];
        for (&place, value) in first.order.iter().zip(ordered) {
            x[place] = value;
        }
        x
    }

    /// The shortest of all `x` whose `A x` is nearest to the right side.
    pub(super) fn solve(&self, right: &[f64]) -> Vec<f64> {
        let mut x = self.solve_once(right);
        let mut rest = right.to_vec();
        for (column, &x) in self.matrix.chunks_exact(self.size).zip(&x) {
            subtract(&mut rest, x, column);
        }
        for (x, change) in x.iter_mut().zip(self.solve_once(&rest)) {
            *x += change;
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in [−1, 1) without a pattern (G. Steele et al., *Fast Splittable Pseudorandom Number Generators*, 2014).
    fn entry(i: usize, j: usize) -> f64 {
        let mut x = (i * 1024 + j + 1) as u64;
        x = x.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// A product of so many columns and rows.
    fn of_rank(size: usize, rank: usize) -> Vec<f64> {
        let sum = |i: usize, j: usize| -> f64 {
            let terms = (0..rank).map(|k| entry(i, k) * entry(k + 50, j));
            terms.sum()
        };
        (0..size * size).map(|k| sum(k % size, k / size)).collect()
    }

    fn times(size: usize, matrix: &[f64], x: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; size];
        for (column, x) in matrix.chunks_exact(size).zip(x) {
            subtract(&mut sum, -x, column);
        }
        sum
    }

    fn largest(list: impl Iterator<Item = f64>) -> f64 {
        list.fold(0.0, |a, x| a.max(x.abs()))
    }

    #[test]
    fn regular_matrices_are_inverted() {
        for size in [1, 2, 7, 40] {
            let matrix: Vec<f64> = (0..size * size)
                .map(|k| entry(k / size, k % size) + if k / size == k % size { 3.0 } else { 0.0 })
                .collect();
            let wanted: Vec<f64> = (0..size).map(|i| entry(i, 3)).collect();
            let right = times(size, &matrix, &wanted);
            let inverse = PseudoInverse::new(size, matrix, 1e-10);
            assert_eq!(inverse.rank(), size);
            let found = inverse.solve(&right);
            assert!(largest(found.iter().zip(&wanted).map(|(a, b)| a - b)) < 1e-12);
        }
    }

    /// Penrose's conditions, by what they say of solutions: the residual is across the columns, and the solution is one of the rows'.
    #[test]
    fn singular_matrices_have_the_shortest_of_the_nearest_solutions() {
        for (size, rank) in [(3, 1), (6, 4), (25, 11), (30, 29)] {
            let matrix = of_rank(size, rank);
            let inverse = PseudoInverse::new(size, matrix.clone(), 1e-10);
            assert_eq!(inverse.rank(), rank);
            let right: Vec<f64> = (0..size).map(|i| entry(i, 77)).collect();
            let x = inverse.solve(&right);
            let image = times(size, &matrix, &x);
            let rest: Vec<f64> = right.iter().zip(&image).map(|(b, a)| b - a).collect();
            let across = matrix.chunks_exact(size).map(|column| dot(column, &rest));
            assert!(largest(across) < 1e-10, "{size}, {rank}");
            // A⁺ A x = x only for what is spanned by the rows.
            let again = inverse.solve(&image);
            assert!(largest(again.iter().zip(&x).map(|(a, b)| a - b)) < 1e-9);
            let null = (0..size).map(|i| entry(i, 5)).collect::<Vec<f64>>();
            let kept = inverse.solve(&times(size, &matrix, &null));
            let lost: Vec<f64> = null.iter().zip(&kept).map(|(a, b)| a - b).collect();
            assert!(largest(times(size, &matrix, &lost).into_iter()) < 1e-9);
            assert!(dot(&lost, &x).abs() < 1e-8);
        }
    }

    #[test]
    fn a_matrix_of_zeros_has_no_rank() {
        let inverse = PseudoInverse::new(2, vec![0.0; 4], 1e-10);
        assert_eq!(inverse.rank(), 0);
        assert_eq!(inverse.solve(&[1.0, 2.0]), [0.0, 0.0]);
    }
}
