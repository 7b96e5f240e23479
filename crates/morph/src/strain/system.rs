//! The sparse systems of a part: where entries go, what is held fast, and the factor.
//!
//! A part can be moved and turned without a change of its energy, so that three numbers are held: both coordinates of one vertex and one
//! of another. Which ones they are does not matter, since moves and turns are taken out of every step.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004, "Fixing the Rigid Body Motion"; errata S8, S13.

use super::cells::{Cells, Points};
use super::energy::{Places, stride};
use anamorph_core::glam::DVec2;
use anamorph_solvers::{Arithmetic, Factor, Pattern, SolverError, Symbolic};

/// What follows from the elements of a part.
#[derive(Debug, Clone)]
pub(crate) struct System {
    pub(crate) symbolic: Symbolic,
    pub(crate) places: Places,
    /// The place of each diagonal entry.
    pub(crate) diagonal: Vec<u32>,
    /// Rows that are held.
    held: Vec<usize>,
}

/// The place of an entry of the lower triangle.
fn place(pattern: &Pattern, row: usize, column: usize) -> usize {
    let (row, column) = (row.max(column), row.min(column));
    let range = pattern.starts()[column] as usize..pattern.starts()[column + 1] as usize;
    let rows = &pattern.rows()[range.clone()];
    let found = rows.partition_point(|&r| (r as usize) < row);
    range.start + found
}

// Places of patterns fit 31 bits.
#[allow(clippy::cast_possible_truncation)]
fn narrow(number: usize) -> u32 {
    number as u32
}

fn pairs<const K: usize>(cells: &Cells<K>, mut body: impl FnMut(usize, usize)) {
    for nodes in &cells.nodes {
        for (k, &a) in nodes.iter().enumerate() {
            for &b in &nodes[..=k] {
                body(a as usize, b as usize);
            }
        }
    }
}

impl System {
    /// The system of both coordinates of all vertices: those of `held[0]` and the second one of `held[1]` stay.
    pub(crate) fn of_places(
        points: &Points,
        vertices: usize,
        held: [usize; 2],
    ) -> Result<Self, SolverError> {
        let held = vec![2 * held[0], 2 * held[0] + 1, 2 * held[1] + 1];
        let mut entries = Vec::new();
        let free = |row: usize| !held.contains(&row);
        let mut add = |a: usize, b: usize| {
            for i in 0..2 {
                for j in 0..2 {
                    let (row, column) = (2 * a + i, 2 * b + j);
                    if free(row) && free(column) && (a != b || i >= j) {
                        entries.push((row, column));
                    }
                }
            }
        };
        pairs(&points.triangles, &mut add);
        pairs(&points.quadrilaterals, &mut add);
        entries.sort_unstable();
        entries.dedup();
        let pattern = Pattern::of_entries(2 * vertices, &entries)?;
        let nowhere = pattern.len();
        let mut places = Places::default();
        let fill = |list: &mut Vec<u32>, a: usize, b: usize| {
            for i in 0..2 {
                for j in 0..2 {
                    let (row, column) = (2 * a + i, 2 * b + j);
                    let counts = free(row) && free(column) && (a != b || i >= j);
                    let place = if counts {
                        place(&pattern, row, column)
                    } else {
                        nowhere
                    };
                    list.push(narrow(place));
                }
            }
        };
        let (list, second) = (&mut places.triangles, &mut places.quadrilaterals);
        list.reserve_exact(points.triangles.nodes.len() * stride(3));
        second.reserve_exact(points.quadrilaterals.nodes.len() * stride(4));
        pairs(&points.triangles, |a, b| fill(list, a, b));
        pairs(&points.quadrilaterals, |a, b| fill(second, a, b));
        Self::finish(pattern, places, held)
    }

    /// The system of one number for every vertex, that of `held` staying: `Σ w ∇N_k · ∇N_l`, with its values.
    pub(crate) fn of_numbers(
        points: &Points,
        vertices: usize,
        held: usize,
        weigh: impl Fn(f64) -> f64,
    ) -> Result<(Self, Vec<f64>), SolverError> {
        let mut entries = Vec::new();
        let mut values = Vec::new();
        sum_numbers(&points.triangles, &weigh, held, &mut entries, &mut values);
        sum_numbers(
            &points.quadrilaterals,
            &weigh,
            held,
            &mut entries,
            &mut values,
        );
        let pattern = Pattern::of_entries(vertices, &entries)?;
        let mut values = pattern.assemble(&values)?;
        let system = Self::finish(pattern, Places::default(), vec![held])?;
        system.hold(&mut values);
        Ok((system, values))
    }

    fn finish(pattern: Pattern, places: Places, held: Vec<usize>) -> Result<Self, SolverError> {
        let diagonal = (0..pattern.size()).map(|row| narrow(place(&pattern, row, row)));
        let diagonal = diagonal.collect();
        let symbolic = Symbolic::of(pattern, Arithmetic::Blocks, usize::MAX)?;
        Ok(Self {
            symbolic,
            places,
            diagonal,
            held,
        })
    }

    /// How many values a matrix has.
    pub(crate) fn len(&self) -> usize {
        self.symbolic.pattern().len()
    }

    /// Gives what is held an equation of its own.
    pub(crate) fn hold(&self, values: &mut [f64]) {
        for &row in &self.held {
            values[self.diagonal[row] as usize] = 1.0;
        }
    }

    /// Sets what is held to zero.
    pub(crate) fn still(&self, right: &mut [f64]) {
        for &row in &self.held {
            right[row] = 0.0;
        }
    }
}

fn sum_numbers<const K: usize>(
    cells: &Cells<K>,
    weigh: impl Fn(f64) -> f64,
    held: usize,
    entries: &mut Vec<(usize, usize)>,
    values: &mut Vec<f64>,
) {
    for (cell, nodes) in cells.nodes.iter().enumerate() {
        for (k, &a) in nodes.iter().enumerate() {
            for (l, &b) in nodes[..=k].iter().enumerate() {
                if a as usize == held || b as usize == held {
                    continue;
                }
                let points = cell * cells.per..(cell + 1) * cells.per;
                entries.push((a as usize, b as usize));
                values.push(
                    points
                        .map(|point| {
                            let g = &cells.gradients[point];
                            weigh(cells.weights[point]) * g[k].dot(g[l])
                        })
                        .sum(),
                );
            }
        }
    }
}

/// A factor that is made when it is first wanted, and renewed afterwards.
#[derive(Default)]
pub(crate) struct Kept(Option<Factor>);

impl Kept {
    /// Takes a matrix.
    pub(crate) fn renew(&mut self, symbolic: &Symbolic, values: &[f64]) -> Result<(), SolverError> {
        match &mut self.0 {
            Some(factor) => factor.renew(values),
            none => {
                *none = Some(Factor::of(symbolic.clone(), values)?);
                Ok(())
            }
        }
    }

    /// Whether there is one.
    pub(crate) fn is_there(&self) -> bool {
        self.0.is_some()
    }

    /// Solves in place.
    pub(crate) fn solve(&mut self, right: &mut [f64]) -> Result<(), SolverError> {
        match &mut self.0 {
            Some(factor) => factor.solve_in_place(right),
            None => Err(SolverError::NotPositiveDefinite { row: 0 }),
        }
    }
}

/// The vertex nearest to the middle of the places, and of those that share an element with it the farthest from it.
pub(crate) fn gauge(points: &Points, positions: &[DVec2]) -> [usize; 2] {
    let sum: DVec2 = positions.iter().copied().sum();
    let middle = sum / positions.len().max(1) as f64;
    let mut first = (0, f64::INFINITY);
    for (vertex, place) in positions.iter().enumerate() {
        let distance = place.distance_squared(middle);
        if distance < first.1 {
            first = (vertex, distance);
        }
    }
    let mut second = (usize::MAX, -1.0);
    let mut look = |nodes: &[u32]| {
        if !nodes.contains(&narrow(first.0)) {
            return;
        }
        for &node in nodes {
            let distance = positions[node as usize].distance_squared(positions[first.0]);
            if node as usize != first.0 && distance > second.1 {
                second = (node as usize, distance);
            }
        }
    };
    points.triangles.nodes.iter().for_each(|n| look(n));
    points.quadrilaterals.nodes.iter().for_each(|n| look(n));
    [first.0, second.0]
}
