//! Curves in the plane and in space, and motion along them.
//!
//! A motion is `P(U(S(t)))` (*Interpolation Techniques*, chapter 2): time becomes distance, distance becomes a parameter,
//! the parameter becomes a point.

pub mod arc_length;
pub mod bezier;
mod bounds;
mod curvature;
pub mod eases;
mod error;
pub mod families;
pub mod motion;
mod nearest;
pub mod orientation;
mod piecewise;
mod polynomial;
pub mod smoothing;

pub use arc_length::{ArcLength, InverseArcLength, LengthTable};
pub use bezier::{Bezier, Pieces, PiecewiseBezier};
pub use bounds::TightBounds;
pub use curvature::{Curvature, SignedCurvature, Torsion};
pub use error::CurveError;
pub use nearest::NearestTable;
pub use piecewise::{Cubic, PiecewiseCubic};
