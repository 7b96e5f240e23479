//! Evaluations for the coarsest cells, all at once: whoever shares one finds it here.

use crate::{RasterError, Window, parallel};
use anamorph_core::glam::{DMat2, DVec2, dvec2};
use anamorph_core::{Deformation, Plane};

/// Step of the differences, in pixels: half of it times the second derivative is their error, which the checks see
/// like any other. A power of 2, so that it is exact.
const STEP: f64 = 1.0 / 1024.0;

/// The step at a place: never so small that it drowns in the coordinates.
fn step(p: DVec2) -> f64 {
    let large = p.abs().max_element() * (1.0 / (1_u64 << 30) as f64);
    STEP.max(large)
}

/// Adds the two places next to `p` at which Jacobians are measured.
pub(super) fn push_neighbours(p: DVec2, points: &mut Vec<DVec2>) {
    let step = step(p);
    points.push(p + dvec2(step, 0.0));
    points.push(p + dvec2(0.0, step));
}

/// The Jacobian of the displacement at `p` from that displacement and the two moved neighbours.
pub(super) fn jacobian(p: DVec2, displacement: DVec2, neighbours: [DVec2; 2]) -> DMat2 {
    let step = step(p);
    let (right, below) = (p + dvec2(step, 0.0), p + dvec2(0.0, step));
    DMat2::from_cols(
        (neighbours[0] - right - displacement) / (right.x - p.x),
        (neighbours[1] - below - displacement) / (below.y - p.y),
    )
}

/// Displacements at corners, middles of edges and middles of the coarsest cells and at the middles of their quarters, and
/// Jacobians at corners.
pub(super) struct Coarse {
    size: usize,
    /// Corners across.
    across: usize,
    /// Places half a cell apart.
    halves: Vec<DVec2>,
    /// Middles of quarters.
    quarters: Vec<DVec2>,
    jacobians: Vec<DMat2>,
    evaluations: usize,
}

/// Evaluates the displacement at `count` places a row.
fn lattice(
    deformation: &dyn Deformation<Plane>,
    columns: usize,
    rows: usize,
    place: impl Fn(usize, usize) -> DVec2 + Sync + Send,
) -> Result<Vec<DVec2>, RasterError> {
    let mut values = Window::new(0, 0, columns, rows)?.room(1, DVec2::ZERO)?;
    parallel::chunks(&mut values, columns, |row, out| {
        for (column, value) in out.iter_mut().enumerate() {
            *value = place(column, row);
        }
        let _ = deformation.map_points(0, out);
        for (column, value) in out.iter_mut().enumerate() {
            *value -= place(column, row);
        }
    });
    Ok(values)
}

impl Coarse {
    pub(super) fn new(
        deformation: &dyn Deformation<Plane>,
        window: Window,
        size: usize,
    ) -> Result<Self, RasterError> {
        let (half, quarter) = (size / 2, size / 4);
        let (nx, ny) = (
            window.width().div_ceil(size),
            window.height().div_ceil(size),
        );
        let halves = lattice(deformation, 2 * nx + 1, 2 * ny + 1, |x, y| {
            window.centre(x * half, y * half)
        })?;
        let quarters = lattice(deformation, 2 * nx, 2 * ny, |x, y| {
            window.centre(x * half + quarter, y * half + quarter)
        })?;
        let corners = Window::new(0, 0, nx + 1, ny + 1)?;
        let mut jacobians = corners.room(1, DMat2::ZERO)?;
        parallel::chunks(&mut jacobians, nx + 1, |row, out| {
            let mut points = Vec::with_capacity(2 * out.len());
            for column in 0..out.len() {
                push_neighbours(window.centre(column * size, row * size), &mut points);
            }
            let _ = deformation.map_points(0, &mut points);
            let (pairs, _) = points.as_chunks::<2>();
            for ((column, out), pair) in out.iter_mut().enumerate().zip(pairs) {
                let p = window.centre(column * size, row * size);
                let displacement = halves[2 * row * (2 * nx + 1) + 2 * column];
                *out = jacobian(p, displacement, *pair);
            }
        });
        Ok(Self {
            size,
            across: nx + 1,
            evaluations: halves.len() + quarters.len() + 2 * jacobians.len(),
            halves,
            quarters,
            jacobians,
        })
    }

    pub(super) fn evaluations(&self) -> usize {
        self.evaluations
    }

    /// The displacement at pixel `(x, y)` of the window, if it was evaluated.
    #[inline]
    pub(super) fn value(&self, x: usize, y: usize) -> Option<DVec2> {
        // Sizes are powers of 2.
        let (shift, quarter) = (self.size.trailing_zeros() - 1, self.size / 4);
        let (column, row) = (x >> shift, y >> shift);
        let across = self.across * 2;
        match (x - (column << shift), y - (row << shift)) {
            (0, 0) => Some(self.halves[row * (across - 1) + column]),
            (a, b) if a == quarter && b == quarter => {
                Some(self.quarters[row * (across - 2) + column])
            }
            _ => None,
        }
    }

    /// The Jacobian of the displacement there, if it was measured.
    pub(super) fn jacobian(&self, x: usize, y: usize) -> Option<DMat2> {
        let (shift, rest) = (self.size.trailing_zeros(), self.size - 1);
        ((x | y) & rest == 0).then(|| self.jacobians[(y >> shift) * self.across + (x >> shift)])
    }
}
