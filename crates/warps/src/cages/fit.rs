//! The grid that a cage's points stand on, found from the points alone.
//!
//! Computes the counts along each axis from runs of points on straight lines, and the box of the lattice from the corners
//! of the cage, for control points at any local coordinates (even, or the Greville abscissae of splines).
//!
//! *Source*: a decision. Corners are exact where the file is; the other points are only checked.

use crate::lattices::{Grid, LatticeError};
use anamorph_core::{Linear, Space};

/// How far points of an unedited cage may stand from their places, as a share of the cage's size. Modellers round to six
/// decimals; what is farther off has been moved.
const LOOSE: f64 = 1e-4;

/// The size that tolerances refer to: the largest distance of a coordinate from the first point's.
fn extent<S: Space>(points: &[S]) -> f64 {
    let first = points.first().copied().unwrap_or(S::ZERO);
    points
        .iter()
        .fold(0.0, |most: f64, &p| most.max((p - first).largest()))
}

/// How many of the points, each `stride` after the one before it, go forward on a straight line from the first.
fn run<S: Space>(points: &[S], stride: usize, tolerance: f64) -> usize {
    let (Some(&first), Some(&second)) = (points.first(), points.get(stride)) else {
        return points.len().min(1);
    };
    let Some(direction) = (second - first).normalized() else {
        return 1;
    };
    let mut reached = 0.0;
    let line = points.iter().step_by(stride.max(1)).skip(1);
    let on_line = line.take_while(|&&point| {
        let along = (point - first).dot(direction);
        let off = (point - first - direction * along).length();
        let forward = off <= tolerance && along > reached + tolerance;
        reached = along;
        forward
    });
    1 + on_line.count()
}

/// The counts along each axis of points in the order of a grid, or `None` where they are in no such order.
pub(crate) fn infer_shape<S: Space>(points: &[S]) -> Option<Vec<usize>> {
    if points.is_empty() {
        return None;
    }
    let tolerance = LOOSE * extent(points);
    let mut shape = vec![0; S::DIM];
    let mut stride = 1;
    for axis in (1..S::DIM).rev() {
        shape[axis] = run(points, stride, tolerance);
        stride = stride.checked_mul(shape[axis])?;
    }
    shape[0] = points.len() / stride;
    (shape.iter().product::<usize>() == points.len() && shape.iter().all(|&n| n > 1))
        .then_some(shape)
}

/// Why a cage fits no grid.
#[derive(Debug, PartialEq)]
pub(crate) enum NoFit {
    /// The box of its corners is none.
    Box(LatticeError),
    /// A point stands elsewhere: its flat index, and how far off it is.
    Off(usize, f64),
}

/// The grid whose control points are `points`, where those of the unit box stand at `locals` (flat order, last axis
/// fastest).
pub(crate) fn fit<S: Space>(points: &[S], locals: &[S], shape: &[usize]) -> Result<Grid<S>, NoFit> {
    let unit = Grid::<S>::unit(shape).map_err(NoFit::Box)?;
    let counts = unit.shape();
    let end = |axis: usize| {
        let mut index = [0; 3];
        index[axis] = counts[axis] - 1;
        unit.flat(index)
    };
    let mut origin = points[0];
    let edges = S::Linear::from_columns(|axis| {
        let (near, far) = (locals[0].component(axis), locals[end(axis)].component(axis));
        (points[end(axis)] - points[0]) / (far - near)
    });
    for axis in 0..S::DIM {
        let near = locals[0].component(axis);
        if near != 0.0 {
            origin += edges.column(axis) * -near;
        }
    }
    let grid = Grid::new(origin, edges, shape).map_err(NoFit::Box)?;
    let tolerance = LOOSE * extent(points);
    let off = |flat: usize| points[flat].distance(grid.place(locals[flat]));
    match (0..points.len()).find(|&flat| off(flat) > tolerance) {
        Some(flat) => Err(NoFit::Off(flat, off(flat))),
        None => Ok(grid),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Cage, CageKind};
    use super::*;
    use crate::lattices::bspline::Knots;
    use anamorph_core::{glam::DMat3, glam::dvec3};

    #[test]
    fn skew_boxes_of_every_kind_are_found_again() {
        let edges = DMat3::from_cols(
            dvec3(2.0, 0.1, 0.0),
            dvec3(0.3, 3.0, -0.2),
            dvec3(0.0, 0.7, -1.5),
        );
        let shape = [5, 4, 6];
        let grid = Grid::new(dvec3(10.0, -3.0, 0.5), edges, &shape).unwrap();
        let unit = Grid::unit(&shape).unwrap();
        for kind in [
            CageKind::Lattice,
            CageKind::Spline(3, Knots::Uniform),
            CageKind::Spline(3, Knots::Clamped),
            CageKind::Spline(1, Knots::Uniform),
        ] {
            let points = Cage::new(grid.clone(), kind).unwrap().points;
            assert_eq!(infer_shape(&points), Some(shape.to_vec()));
            let locals = Cage::new(unit.clone(), kind).unwrap().points;
            let found = fit(&points, &locals, &shape).unwrap();
            assert!(found.origin().distance(grid.origin()) < 1e-13);
            for axis in 0..3 {
                assert!(found.edges().col(axis).distance(edges.col(axis)) < 1e-13);
            }
            let mut edited = points.clone();
            edited[17] += dvec3(0.0, 0.01, 0.0);
            assert!(
                matches!(fit(&edited, &locals, &shape), Err(NoFit::Off(17, off)) if (off - 0.01).abs() < 1e-9)
            );
        }
    }

    #[test]
    fn what_is_no_grid_has_no_shape() {
        assert_eq!(infer_shape::<anamorph_core::Solid>(&[]), None);
        assert_eq!(infer_shape(&[dvec3(0.0, 0.0, 0.0)]), None);
        let line: Vec<_> = (0..8).map(|i| dvec3(f64::from(i), 0.0, 0.0)).collect();
        assert_eq!(infer_shape(&line), None);
        assert_eq!(infer_shape(&[dvec3(1.0, 1.0, 1.0); 8]), None);
    }
}
