//! Free-form deformation by lattices of control points.
//!
//! A lattice is a parallelepiped box with local coordinates in [0, 1] per axis and a grid of control points; a warp moves
//! the points inside by the weighted average of what happens to the control points.

pub mod bernstein;
pub mod bspline;
pub mod frames;
mod grid;
#[cfg(feature = "recipe")]
pub(crate) mod parameters;
#[cfg(feature = "recipe")]
mod placement;
mod points;

pub(crate) use grid::one;
pub use grid::{Grid, LatticeError};
#[cfg(feature = "recipe")]
pub(crate) use placement::{Corners, Fit, frame_pairs};
pub use points::PointLattice;
