//! Places whose gradients are as near as can be to gradients that are given.
//!
//! Solves `min Σ w |∇v − F|²`, Poisson's equation: a matrix that depends on the source alone, and a right side for each coordinate.
//!
//! *Source*: M. Alexa, D. Cohen-Or, D. Levin, *As-Rigid-As-Possible Shape Interpolation*, SIGGRAPH 2000, eqs. (8) to (10); Y. Yu et al.,
//! *Mesh Editing with Poisson-Based Gradient Field Manipulation*, SIGGRAPH 2004.

use super::cells::{Cells, Points};
use super::system::{Kept, System};
use anamorph_core::glam::{DMat2, DVec2};
use anamorph_solvers::SolverError;

/// The matrix of the equations, one vertex standing still.
#[derive(Debug, Clone)]
pub(crate) struct Stitching {
    system: System,
    values: Vec<f64>,
    even: bool,
    held: usize,
}

fn sum<const K: usize>(
    cells: &Cells<K>,
    first: usize,
    weigh: impl Fn(f64) -> f64,
    wanted: &mut impl FnMut(usize) -> DMat2,
    (x, y): (&mut [f64], &mut [f64]),
) {
    for (cell, nodes) in cells.nodes.iter().enumerate() {
        for point in cell * cells.per..(cell + 1) * cells.per {
            let f = wanted(first + point) * weigh(cells.weights[point]);
            for (g, &node) in cells.gradients[point].iter().zip(nodes) {
                let moved = f * *g;
                x[node as usize] += moved.x;
                y[node as usize] += moved.y;
            }
        }
    }
}

impl Stitching {
    /// For points of so many vertices, of which `held` comes to the origin; `even` counts all points alike, whatever their area.
    pub(crate) fn new(
        points: &Points,
        vertices: usize,
        held: usize,
        even: bool,
    ) -> Result<Self, SolverError> {
        let weigh = |weight: f64| if even { 1.0 } else { weight };
        let (system, values) = System::of_numbers(points, vertices, held, weigh)?;
        Ok(Self {
            system,
            values,
            even,
            held,
        })
    }

    /// Places for the gradients wanted at the points; `right` has room for two numbers a vertex.
    pub(crate) fn places(
        &self,
        points: &Points,
        factor: &mut Kept,
        mut wanted: impl FnMut(usize) -> DMat2,
        right: &mut [f64],
        places: &mut [DVec2],
    ) -> Result<(), SolverError> {
        if !factor.is_there() {
            factor.renew(&self.system.symbolic, &self.values)?;
        }
        let weigh = |weight: f64| if self.even { 1.0 } else { weight };
        right.fill(0.0);
        let (x, y) = right.split_at_mut(places.len());
        sum(&points.triangles, 0, weigh, &mut wanted, (x, y));
        let first = points.triangles.len();
        sum(&points.quadrilaterals, first, weigh, &mut wanted, (x, y));
        for list in [&mut *x, &mut *y] {
            list[self.held] = 0.0;
            factor.solve(list)?;
        }
        for ((place, x), y) in places.iter_mut().zip(x).zip(y) {
            *place = DVec2::new(*x, *y);
        }
        Ok(())
    }
}
