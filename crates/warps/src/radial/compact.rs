//! The equations of many centres whose kernel ends at a radius: sparse, and solved as such.
//!
//! Neighbours are found by cells; the matrix of their kernels is positive definite, and `L Lᵀ` of it serves all axes. With an affine part
//! `B` the coefficients are `c = K⁻¹ (d − B a)`, and those of the affine part solve the small system `Bᵀ K⁻¹ B a = Bᵀ K⁻¹ d`. One
//! step of iterative refinement follows each solution. Factors are those that are the same on every processor.
//!
//! *Source*: H. Wendland, *Scattered Data Approximation*, Cambridge University Press 2005, §12.1 and §15.2.

use super::dense::{Symmetric, norm_of_inverse};
use super::kernels::{Profile, Wendland};
use super::{RadialError, Terms, squared};
use anamorph_core::Space;
use anamorph_solvers::{Arithmetic, Factor, Pattern, SolverError, Symbolic};

/// From so many points on, sparse equations are worth their while.
pub(super) const WORTHWHILE: usize = 512;
/// Most pairs of neighbours: as many take a gigabyte while the equations are made.
const MOST_PAIRS: usize = 25_000_000;
/// Most entries of the factor: as many take 1.2 GB.
const MOST_ENTRIES: usize = 100_000_000;

/// The equations, by position in the cells.
struct Equations {
    pattern: Pattern,
    values: Vec<f64>,
    factor: Factor,
}

impl Equations {
    /// The solution for a right side, refined once; `None` where it is not finite.
    fn solve(&mut self, right: &[f64]) -> Option<Vec<f64>> {
        let mut x = right.to_vec();
        self.factor.solve_in_place(&mut x).ok()?;
        let mut rest = vec![0.0; x.len()];
        self.pattern.multiply(&self.values, &x, &mut rest).ok()?;
        for (rest, right) in rest.iter_mut().zip(right) {
            *rest = right - *rest;
        }
        self.factor.solve_in_place(&mut rest).ok()?;
        for (x, change) in x.iter_mut().zip(rest) {
            *x += change;
        }
        Some(x)
    }

    /// `‖K‖₁`.
    fn norm(&self) -> f64 {
        let mut sums = vec![0.0; self.pattern.size()];
        let starts = self.pattern.starts().windows(2);
        for (column, ends) in starts.enumerate() {
            for at in ends[0] as usize..ends[1] as usize {
                let (row, size) = (self.pattern.rows()[at] as usize, self.values[at].abs());
                sums[row] += size;
                if row != column {
                    sums[column] += size;
                }
            }
        }
        sums.into_iter().fold(0.0, f64::max)
    }
}

/// Fills in the coefficients; the condition number, or `None` if there is no solution.
pub(super) fn solve<S: Space>(
    terms: &mut Terms<S>,
    moves: &[S],
    affine: bool,
    smoothing: f64,
) -> Result<Option<f64>, RadialError> {
    let n = moves.len();
    terms.coefficients = vec![S::ZERO; n];
    terms.affine = vec![S::ZERO; if affine { S::DIM + 1 } else { 0 }];
    let Some(numbers) = terms.cells.as_ref().map(|cells| cells.numbers.clone()) else {
        return Ok(None);
    };
    let too_dense = |entries: usize, most: usize| RadialError::TooDense {
        radius: 1.0 / terms.scale,
        points: n,
        entries,
        most,
    };
    let mut position = vec![0_usize; n];
    for (at, &number) in numbers.iter().enumerate() {
        position[number as usize] = at;
    }
    let (mut entries, mut contributions) = (Vec::new(), Vec::new());
    for (at, &number) in numbers.iter().enumerate() {
        let place = terms.places[number as usize];
        terms.in_reach(place, |other| {
            // Each pair once.
            if position[other] <= at {
                entries.push((at, position[other]));
                contributions.push(Wendland::value(squared(place, terms.places[other])));
            }
        });
        if entries.len() > MOST_PAIRS {
            return Err(too_dense(entries.len(), MOST_PAIRS));
        }
    }
    for at in 0..n {
        entries.push((at, at));
        contributions.push(Wendland::SIGN * smoothing);
    }
    let made = || {
        let pattern = Pattern::of_entries(n, &entries)?;
        let values = pattern.assemble(&contributions)?;
        let symbolic = Symbolic::of(pattern.clone(), Arithmetic::Reproducible, MOST_ENTRIES)?;
        let factor = Factor::of(symbolic, &values)?;
        Ok(Equations {
            pattern,
            values,
            factor,
        })
    };
    let mut equations = match made() {
        Ok(equations) => equations,
        Err(SolverError::TooDense { entries, most }) => return Err(too_dense(entries, most)),
        Err(SolverError::OutOfMemory) => return Err(too_dense(MOST_ENTRIES, MOST_ENTRIES)),
        Err(_) => return Ok(None),
    };
    drop((entries, contributions));
    let condition = equations.norm() * norm_of_inverse(n, |right| equations.solve(right));
    let column = |axis: usize| -> Vec<f64> {
        let at = |&number: &u32| moves[number as usize].component(axis);
        numbers.iter().map(at).collect()
    };
    let mut columns = Vec::new();
    for axis in 0..S::DIM {
        match equations.solve(&column(axis)) {
            Some(x) => columns.push(x),
            None => return Ok(None),
        }
    }
    if affine {
        let Some(part) = affine_part(terms, &numbers, &mut equations, &mut columns) else {
            return Ok(None);
        };
        terms.affine = part;
    }
    for (at, &number) in numbers.iter().enumerate() {
        terms.coefficients[number as usize] = S::from_fn(|axis| columns[axis][at]);
    }
    let finite = |list: &[S]| list.iter().all(|c| c.is_finite());
    Ok((finite(&terms.coefficients) && finite(&terms.affine)).then_some(condition))
}

/// The coefficients of the affine part; takes what it does off those of the kernels.
fn affine_part<S: Space>(
    terms: &Terms<S>,
    numbers: &[u32],
    equations: &mut Equations,
    columns: &mut [Vec<f64>],
) -> Option<Vec<S>> {
    let size = S::DIM + 1;
    let value = |k: usize, number: u32| {
        let place = terms.places[number as usize];
        if k == 0 { 1.0 } else { place.component(k - 1) }
    };
    let basis: Vec<Vec<f64>> = (0..size)
        .map(|k| numbers.iter().map(|&number| value(k, number)).collect())
        .collect();
    let mut answers = Vec::new();
    for column in &basis {
        answers.push(equations.solve(column)?);
    }
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let matrix = (0..size * size).map(|k| dot(&basis[k / size], &answers[k % size]));
    let system = Symmetric::new(size, matrix.collect())?;
    let mut parts = Vec::new();
    for column in columns {
        let right: Vec<f64> = basis.iter().map(|b| dot(b, column)).collect();
        let part = system.solve(&right);
        for (answer, a) in answers.iter().zip(&part) {
            for (x, y) in column.iter_mut().zip(answer) {
                *x -= a * y;
            }
        }
        parts.push(part);
    }
    Some(
        (0..size)
            .map(|k| S::from_fn(|axis| parts[axis][k]))
            .collect(),
    )
}
