//! Cholesky's factors of sparse matrices, `P A Pᵀ = L Lᵀ`, with an order `P` of approximately minimum degree.
//!
//! What follows from the pattern alone (the order, and where `L` has entries) is [`Symbolic`], and serves all matrices of the pattern; the
//! numbers are [`Factor`], which takes new ones without asking for memory again. Both run on the thread that calls.
//!
//! *Source*: P. R. Amestoy, T. A. Davis, I. S. Duff, *An Approximate Minimum Degree Ordering Algorithm*, SIAM J. Matrix Anal. Appl. 17,
//! 1996; T. A. Davis, *Direct Methods for Sparse Linear Systems*, SIAM 2006, ch. 4; both as the crate `faer` has them. Its supernodal
//! factors multiply dense blocks with whatever instructions the processor has, so that last digits differ between processors; its simplicial ones
//! are plain products and differences, and so are the blocks of this crate. Which of them is the caller's choice ([`Arithmetic`]).

use crate::SolverError;
use crate::blocks::{BlockRoom, Blocks};
use crate::pattern::{Pattern, check_count};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use std::sync::Arc;

/// Which digits the factors have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arithmetic {
    /// The same on every processor.
    Reproducible,
    /// The same on every processor, by dense blocks: faster for matrices of meshes, where neighbouring columns of the factor are alike.
    Blocks,
    /// Whatever is fastest here; several times faster where the factor is dense in places, and last digits may depend on the processor.
    Fastest,
}

/// What the pattern of a matrix says about its factor. Cheap to clone.
#[derive(Debug, Clone)]
pub struct Symbolic {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    pattern: Pattern,
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    Library(SymbolicCholesky<u32>),
    Blocks(Blocks),
}

fn columns(pattern: &Pattern) -> SymbolicSparseColMatRef<'_, u32> {
    let size = pattern.size();
    SymbolicSparseColMatRef::new_checked(size, size, pattern.starts(), None, pattern.rows())
}

fn buffer(size: faer::dyn_stack::StackReq) -> Result<MemBuffer, SolverError> {
    MemBuffer::try_new(size).map_err(|_| SolverError::OutOfMemory)
}

impl Symbolic {
    /// Orders the rows of a pattern, and finds where the factor has entries: at most `most_entries`.
    ///
    /// # Errors
    /// [`SolverError::TooDense`] if the factor has more entries than that, [`SolverError::OutOfMemory`] if there is no memory for it.
    pub fn of(
        pattern: Pattern,
        arithmetic: Arithmetic,
        most_entries: usize,
    ) -> Result<Self, SolverError> {
        let size = pattern.size();
        let matrix = columns(&pattern);
        let mut order = vec![0_u32; size];
        let mut place = vec![0_u32; size];
        let mut memory = buffer(amd::order_maybe_unsorted_scratch::<u32>(
            size,
            pattern.len(),
        ))?;
        let cost = amd::order_maybe_unsorted(
            &mut order,
            &mut place,
            matrix,
            amd::Control::default(),
            MemStack::new(&mut memory),
        )
        .map_err(|_| SolverError::OutOfMemory)?;
        // An entry below the diagonal is one division.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let entries = size.saturating_add(cost.n_div as usize);
        if entries > most_entries.min(i32::MAX as usize) {
            return Err(SolverError::TooDense {
                entries,
                most: most_entries.min(i32::MAX as usize),
            });
        }
        if arithmetic == Arithmetic::Blocks {
            let kind = Kind::Blocks(Blocks::of(&pattern, &order));
            return Ok(Self {
                shared: Arc::new(Shared { pattern, kind }),
            });
        }
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: match arithmetic {
                Arithmetic::Reproducible => SupernodalThreshold::FORCE_SIMPLICIAL,
                Arithmetic::Fastest | Arithmetic::Blocks => SupernodalThreshold::AUTO,
            },
            ..CholeskySymbolicParams::default()
        };
        let factor = factorize_symbolic_cholesky(
            matrix,
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&order, &place, size)),
            params,
        )
        .map_err(|_| SolverError::OutOfMemory)?;
        let kind = Kind::Library(factor);
        let shared = Arc::new(Shared { pattern, kind });
        Ok(Self { shared })
    }

    /// The pattern.
    pub fn pattern(&self) -> &Pattern {
        &self.shared.pattern
    }

    /// Entries of the factor.
    pub fn entries(&self) -> usize {
        match &self.shared.kind {
            Kind::Library(factor) => factor.len_val(),
            Kind::Blocks(blocks) => blocks.len(),
        }
    }
}

/// The factor of a matrix.
pub struct Factor {
    symbolic: Symbolic,
    values: Vec<f64>,
    memory: MemBuffer,
    room: BlockRoom,
    /// Whether `values` are those of a matrix.
    whole: bool,
}

impl Factor {
    /// The factor of the matrix whose values stand in the order of the pattern, see [`Pattern::assemble`].
    ///
    /// # Errors
    /// [`SolverError`] for a list of the wrong length, values that are not finite, and a matrix that is not positive definite.
    pub fn of(symbolic: Symbolic, values: &[f64]) -> Result<Self, SolverError> {
        let shared = &symbolic.shared;
        let (memory, work) = match &shared.kind {
            Kind::Library(factor) => {
                let solve = factor.solve_in_place_scratch::<f64>(1, Par::Seq);
                let factor =
                    factor.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
                (factor.or(solve), BlockRoom::default())
            }
            Kind::Blocks(blocks) => (faer::dyn_stack::StackReq::EMPTY, blocks.room()),
        };
        let memory = buffer(memory)?;
        let mut room = Vec::new();
        room.try_reserve_exact(symbolic.entries())
            .map_err(|_| SolverError::OutOfMemory)?;
        room.resize(symbolic.entries(), 0.0);
        let mut factor = Self {
            symbolic,
            values: room,
            memory,
            room: work,
            whole: false,
        };
        factor.renew(values)?;
        Ok(factor)
    }

    /// Takes another matrix of the same pattern. After an error there is none to solve for.
    ///
    /// # Errors
    /// As [`Factor::of`].
    pub fn renew(&mut self, values: &[f64]) -> Result<(), SolverError> {
        self.whole = false;
        let Shared { pattern, kind } = &*self.symbolic.shared;
        check_count("values", values, pattern.len())?;
        let wild = pattern.entries().zip(values).find(|(_, v)| !v.is_finite());
        if let Some(((column, row), _)) = wild {
            return Err(SolverError::NotFinite { row, column });
        }
        let factor = match kind {
            Kind::Library(factor) => factor,
            Kind::Blocks(blocks) => {
                blocks
                    .factorize(values, &mut self.values, &mut self.room)
                    .map_err(|row| SolverError::NotPositiveDefinite { row })?;
                self.whole = true;
                return Ok(());
            }
        };
        let original = |row: usize| match factor.perm() {
            Some(order) => order.arrays().0.get(row).map_or(row, |&row| row as usize),
            None => row,
        };
        factor
            .factorize_numeric_llt(
                &mut self.values,
                SparseColMatRef::new(columns(pattern), values),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .map_err(|LltError::NonPositivePivot { index }| {
                let row = original(index.saturating_sub(1));
                SolverError::NotPositiveDefinite { row }
            })?;
        // Numbers that overflowed are found where they are used.
        self.whole = true;
        Ok(())
    }

    /// What the pattern says.
    pub fn symbolic(&self) -> &Symbolic {
        &self.symbolic
    }

    /// The solution in place of the right side.
    ///
    /// # Errors
    /// [`SolverError`] for a list of the wrong length, numbers that are not finite, and a factor whose last [`Factor::renew`] failed.
    pub fn solve_in_place(&mut self, right: &mut [f64]) -> Result<(), SolverError> {
        let Shared { pattern, kind } = &*self.symbolic.shared;
        check_count("right side", right, pattern.size())?;
        let finite = |what, list: &[f64]| match list.iter().position(|x| !x.is_finite()) {
            Some(row) => Err(SolverError::NoSolution { what, row }),
            None => Ok(()),
        };
        finite("right side", right)?;
        if !self.whole {
            return Err(SolverError::NotPositiveDefinite { row: 0 });
        }
        if right.is_empty() {
            return Ok(());
        }
        let rows = right.len();
        match kind {
            Kind::Library(factor) => LltRef::new(factor, &self.values).solve_in_place_with_conj(
                Conj::No,
                MatMut::from_column_major_slice_mut(right, rows, 1),
                Par::Seq,
                MemStack::new(&mut self.memory),
            ),
            Kind::Blocks(blocks) => blocks.solve(&self.values, right, &mut self.room),
        }
        finite("solution", right)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const KINDS: [Arithmetic; 3] = [
        Arithmetic::Reproducible,
        Arithmetic::Blocks,
        Arithmetic::Fastest,
    ];

    /// Numbers between −1 and 1.
    fn numbers(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    /// A matrix of random entries, its diagonal large enough.
    fn matrix(size: usize, per_row: usize, seed: u64) -> (Pattern, Vec<f64>) {
        let mut next = numbers(seed);
        let mut pick = |most: usize| ((next() + 1.0) * 0.5 * most as f64) as usize % most;
        let entries: Vec<(usize, usize)> = (0..size * per_row)
            .map(|k| (k / per_row, pick(size)))
            .collect();
        let pattern = Pattern::of_entries(size, &entries).unwrap();
        let contributions: Vec<f64> = entries.iter().map(|_| next()).collect();
        let mut values = pattern.assemble(&contributions).unwrap();
        let mut sums = vec![0.0; size];
        for ((column, row), value) in pattern.entries().zip(&values) {
            if row != column {
                sums[row] += value.abs();
                sums[column] += value.abs();
            }
        }
        let diagonal: Vec<usize> = pattern.starts()[..size]
            .iter()
            .map(|&s| s as usize)
            .collect();
        for (row, at) in diagonal.into_iter().enumerate() {
            values[at] = sums[row] + 0.1 + values[at].abs();
        }
        (pattern, values)
    }

    /// The solution by dense elimination with pivots.
    fn dense(pattern: &Pattern, values: &[f64], right: &[f64]) -> Vec<f64> {
        let n = pattern.size();
        let mut a = vec![vec![0.0; n + 1]; n];
        for ((column, row), &value) in pattern.entries().zip(values) {
            a[row][column] = value;
            a[column][row] = value;
        }
        for (row, &b) in a.iter_mut().zip(right) {
            row[n] = b;
        }
        for k in 0..n {
            let pivot = (k..n)
                .max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))
                .unwrap();
            a.swap(k, pivot);
            let top = a[k].clone();
            for row in a.iter_mut().skip(k + 1) {
                let factor = row[k] / top[k];
                for (x, t) in row.iter_mut().zip(&top).skip(k) {
                    *x -= factor * t;
                }
            }
        }
        let mut x = vec![0.0; n];
        for k in (0..n).rev() {
            let known: f64 = (k + 1..n).map(|j| a[k][j] * x[j]).sum();
            x[k] = (a[k][n] - known) / a[k][k];
        }
        x
    }

    #[test]
    fn solutions_are_those_of_dense_elimination() {
        for (size, per_row) in [(1, 1), (2, 1), (17, 3), (60, 0), (60, 4), (150, 30)] {
            for arithmetic in KINDS {
                let (pattern, values) = matrix(size, per_row, size as u64);
                let symbolic = Symbolic::of(pattern.clone(), arithmetic, usize::MAX).unwrap();
                assert!(symbolic.entries() >= pattern.len().min(size));
                let mut factor = Factor::of(symbolic, &values).unwrap();
                let mut next = numbers(7);
                for _ in 0..3 {
                    let right: Vec<f64> = (0..size).map(|_| next()).collect();
                    let mut x = right.clone();
                    factor.solve_in_place(&mut x).unwrap();
                    for (x, expected) in x.iter().zip(dense(&pattern, &values, &right)) {
                        assert!((x - expected).abs() < 1e-11, "{size}: {x}, {expected}");
                    }
                    let mut product = vec![0.0; size];
                    pattern.multiply(&values, &x, &mut product).unwrap();
                    for (a, b) in product.iter().zip(&right) {
                        assert!((a - b).abs() < 1e-11);
                    }
                }
            }
        }
    }

    /// The matrix of a grid with two numbers at every place, as those of meshes are.
    #[test]
    fn blocks_solve_what_grids_ask() {
        let (wide, high) = (23, 17);
        let mut entries = Vec::new();
        for y in 0..high {
            for x in 0..wide {
                for (right, down) in [(1, 0), (0, 1), (1, 1)] {
                    if x + right < wide && y + down < high {
                        let (a, b) = (y * wide + x, (y + down) * wide + x + right);
                        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                            entries.push((2 * a + i, 2 * b + j));
                        }
                    }
                }
            }
        }
        let pattern = Pattern::of_entries(2 * wide * high, &entries).unwrap();
        let mut next = numbers(11);
        let contributions: Vec<f64> = entries.iter().map(|_| next()).collect();
        let mut values = pattern.assemble(&contributions).unwrap();
        for row in 0..pattern.size() {
            values[pattern.starts()[row] as usize] = 13.0;
        }
        let [mut plain, mut blocks] = [Arithmetic::Reproducible, Arithmetic::Blocks].map(|kind| {
            let symbolic = Symbolic::of(pattern.clone(), kind, usize::MAX).unwrap();
            Factor::of(symbolic, &values).unwrap()
        });
        // Zeros that joining adds are few.
        assert!(blocks.symbolic().entries() < 2 * plain.symbolic().entries());
        for _ in 0..3 {
            let right: Vec<f64> = (0..pattern.size()).map(|_| next()).collect();
            let (mut x, mut y) = (right.clone(), right);
            plain.solve_in_place(&mut x).unwrap();
            blocks.solve_in_place(&mut y).unwrap();
            for (x, y) in x.iter().zip(&y) {
                assert!((x - y).abs() < 1e-13, "{x} {y}");
            }
            for value in &mut values {
                *value *= 1.5;
            }
            plain.renew(&values).unwrap();
            blocks.renew(&values).unwrap();
        }
    }

    #[test]
    fn factors_take_other_matrices_of_their_pattern() {
        for arithmetic in KINDS {
            take_others(arithmetic);
        }
    }

    fn take_others(arithmetic: Arithmetic) {
        let (pattern, values) = matrix(80, 5, 3);
        let symbolic = Symbolic::of(pattern, arithmetic, usize::MAX).unwrap();
        let mut factor = Factor::of(symbolic.clone(), &values).unwrap();
        // Four times as large: the roots are twice as large, exactly.
        let larger: Vec<f64> = values.iter().map(|v| 4.0 * v).collect();
        let (mut once, mut there) = (vec![1.0; 80], vec![4.0; 80]);
        factor.solve_in_place(&mut once).unwrap();
        factor.renew(&larger).unwrap();
        factor.solve_in_place(&mut there).unwrap();
        assert_eq!(once, there);
        // A failed one leaves nothing to solve with, and the next whole one does.
        let mut broken = values.clone();
        broken[4] = f64::NAN;
        assert!(matches!(
            factor.renew(&broken),
            Err(SolverError::NotFinite { .. })
        ));
        assert!(factor.solve_in_place(&mut once).is_err());
        factor.renew(&values).unwrap();
        let (mut again, mut other) = (vec![1.0; 80], vec![1.0; 80]);
        factor.solve_in_place(&mut again).unwrap();
        let mut fresh = Factor::of(symbolic, &values).unwrap();
        fresh.solve_in_place(&mut other).unwrap();
        assert_eq!(again, other);
    }

    #[test]
    fn what_is_not_positive_definite_is_refused_by_row() {
        // Rows 1 and 3 are the same but for their names.
        let entries: Vec<(usize, usize)> = (0..5).map(|i| (i, i)).chain([(1, 3)]).collect();
        let pattern = Pattern::of_entries(5, &entries).unwrap();
        for arithmetic in KINDS {
            let symbolic = Symbolic::of(pattern.clone(), arithmetic, usize::MAX).unwrap();
            let values = pattern.assemble(&[1.0; 6]).unwrap();
            let Err(SolverError::NotPositiveDefinite { row }) =
                Factor::of(symbolic.clone(), &values)
            else {
                panic!("refused");
            };
            assert!(row == 1 || row == 3, "{row}");
            let negative = pattern.assemble(&[1.0, 1.0, -1.0, 1.0, 1.0, 0.0]).unwrap();
            let error = Factor::of(symbolic, &negative).err().unwrap();
            assert_eq!(error, SolverError::NotPositiveDefinite { row: 2 });
        }
    }

    #[test]
    fn overflow_limits_and_wrong_lengths_are_errors() {
        let (pattern, values) = matrix(30, 20, 5);
        let error = Symbolic::of(pattern.clone(), Arithmetic::Reproducible, 100)
            .err()
            .unwrap();
        assert!(matches!(error, SolverError::TooDense { most: 100, .. }));
        let symbolic = Symbolic::of(pattern, Arithmetic::Reproducible, usize::MAX).unwrap();
        let mut factor = Factor::of(symbolic.clone(), &values).unwrap();
        assert!(factor.solve_in_place(&mut [1.0; 3]).is_err());
        assert!(factor.solve_in_place(&mut [f64::NAN; 30]).is_err());
        assert!(Factor::of(symbolic.clone(), &values[1..]).is_err());
        let tiny: Vec<f64> = values.iter().map(|v| v * 1e-300).collect();
        let mut factor = Factor::of(symbolic, &tiny).unwrap();
        assert!(matches!(
            factor.solve_in_place(&mut [1e200; 30]),
            Err(SolverError::NoSolution {
                what: "solution",
                ..
            })
        ));
        let empty = Pattern::of_entries(0, &[]).unwrap();
        let symbolic = Symbolic::of(empty, Arithmetic::Reproducible, 10).unwrap();
        let mut nothing = Factor::of(symbolic, &[]).unwrap();
        nothing.solve_in_place(&mut []).unwrap();
    }
}
