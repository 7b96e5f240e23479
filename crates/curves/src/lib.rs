//! Curves in the plane and in space, and motion along them.
//!
//! A motion is `P(U(S(t)))` (*Interpolation Techniques*, chapter 2): time becomes distance, distance becomes a parameter,
//! the parameter becomes a point. This crate has all three, for anyone who needs only them: it compiles glam, libm and
//! thiserror, and nothing heavy.
//!
//! - `P`: [`families`], one file each, are generators of curves. Those with cubic pieces all make a [`PiecewiseCubic`];
//!   [`Bezier`] curves of any degree, B-splines ([`PiecewiseBezier`]) and [`families::Lagrange`] stand beside it.
//! - `U`: [`ArcLength`], [`InverseArcLength`], and [`LengthTable`], prepared once and asked often. An accuracy is always a
//!   length in scene units, and kept.
//! - `S`: [`eases`] and [`motion`], speed control by keys and its diagnosis.
//! - [`orientation`]: which way something on the path faces, and which way is up for it.
//! - [`NearestTable`] finds all places where the distance to a point is least, [`TightBounds`] the smallest box,
//!   [`Curvature`], [`SignedCurvature`] and [`Torsion`] the bending; [`smoothing`] prepares digitized points.
//!
//! What a curve can do is said by small traits, one capability each; [`Curve`](anamorph_core::Curve) and
//! [`Differentiable`](anamorph_core::Differentiable) are in `anamorph-core`, so that warps need not know this crate. Points
//! and vectors are glam's `DVec2` and `DVec3`, re-exported by the core; they share a type there and so they do here.
//!
//! Features: `simd` uses the widest vectors of the processor (results are the same bit for bit), `serde` writes and reads
//! curves, `mint` converts points of other libraries.
//!
//! ```
//! use anamorph_core::{Curve, glam::dvec3};
//! use anamorph_curves::families::{CatmullRom, Generator};
//! use anamorph_curves::{ArcLength, LengthTable};
//!
//! let path = CatmullRom::new(vec![
//!     dvec3(0.0, 0.0, 0.0),
//!     dvec3(1.0, 2.0, 0.0),
//!     dvec3(4.0, 2.0, 1.0),
//!     dvec3(5.0, 0.0, 3.0),
//! ])
//! .curve()?;
//! let table = LengthTable::new(&path, 1e-6)?;
//!
//! // Eleven points with the same distance from each to the next along the curve.
//! let steps: Vec<_> = table.even_parameters(11).into_iter().map(|u| path.point(u)).collect();
//! assert_eq!(steps.len(), 11);
//! let walked = path.length_between(0.0, table.parameter(2.5), 1e-9);
//! assert!((walked - 2.5).abs() < 1.1e-6);
//! # Ok::<(), anamorph_curves::CurveError>(())
//! ```

pub mod arc_length;
pub mod bezier;
mod bounds;
mod curvature;
pub mod eases;
mod error;
pub mod families;
mod indexed;
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
pub use indexed::Indexed;

pub use nearest::NearestTable;
pub use piecewise::{Cubic, PiecewiseCubic};
