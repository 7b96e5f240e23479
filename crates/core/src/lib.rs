//! The engine of anamorph: a warp is a weighted average of scaled transformations.
//!
//! This crate holds the vocabulary that all other crates speak and the engine that evaluates eq. (3) of Milliron,
//! Jensen, Barzel and Finkelstein, *A Framework for Geometric Warps and Deformations*, ACM Transactions on Graphics
//! 21(1), 2002:
//!
//! - [`Space`]: the plane or space, named by its point type ([`Plane`], [`Solid`]); [`Affine`] maps.
//! - [`Site`]: one index of a model with its point. Warps see sites, never files or meshes.
//! - [`Field`]: a scalar at a site with its [`Support`] and [`Smoothness`].
//! - [`Transformation`]: an affine map that can be scaled by a strength.
//! - [`Deformation`]: moves sites. [`Warp`]: a deformation with terms; [`Terms`]: a warp given by its terms.
//! - [`Stack`], [`Masked`], [`Modulated`]: deformations made of deformations.
//! - [`Curve`], [`Differentiable`], [`NearestPoint`]: what warps and motions know of a curve.
//! - [`Sampling`]: how integrals over continuous features become sums.
//! - [`Binding`]: fields evaluated once and kept. [`guarantees`]: what is promised. [`reference`](mod@reference): the
//!   literal formula.
//!
//! It knows no file format, no mesh structure, no image and no thread pool size; geometry is `f64`; glam is re-exported
//! as [`glam`]. Nothing here panics on data.
//!
//! ```
//! use anamorph_core::{glam::dvec3, map_all, Affine, Solid, Term, Terms};
//!
//! // One translation whose strength is 1 and whose weight is 1 everywhere moves all points alike.
//! let warp = Terms::new(vec![Term::new(Affine::translation(dvec3(0.0, 0.0, 2.0)), 1.0, 1.0)]);
//! let mut points = [Solid::ZERO, dvec3(1.0, 2.0, 3.0)];
//! assert!(map_all(&warp, &mut points).is_empty());
//! assert_eq!(points[1], dvec3(1.0, 2.0, 5.0));
//! ```

pub use glam;

mod affine;
mod binding;
mod curve;
mod deformation;
mod engine;
mod field;
mod fitting;
pub mod guarantees;
mod inverse;
mod marks;
pub mod math;
mod model;
pub mod reference;
pub mod sampling;
mod schedule;
#[cfg(feature = "simd")]
pub mod simd;
mod space;
mod surface;
mod terms;
mod transformation;
mod warp;

pub use affine::Affine;
pub use binding::{Binding, Bound, Fingerprint};
pub use curve::{Curve, Differentiable, Jet, Nearest, NearestPoint};
pub use deformation::{
    Deformation, Facts, Masked, Stack, Unmapped, difference_jacobian, difference_step,
};
#[cfg(feature = "parallel")]
pub use engine::map_all_parallel;
pub use engine::{map_all, map_all_f32};
pub use field::{Domain, Field, Smoothness, Support};
pub use fitting::{FitError, Fitted, Pin, fit};
pub use inverse::{Inverse, Inversion};
pub use marks::{Mark, Role, Shape};
pub use model::{Bounds, Site};
pub use sampling::Sampling;
pub use schedule::Scheduled;
pub use space::{Linear, Plane, Solid, Space};
pub use surface::{carry_normal, carry_tangent, vertex_normals};
pub use terms::{Modulated, Term, Terms};
pub use transformation::{Scaling, Transformation};
pub use warp::{
    Address, Average, Condition, Influence, Influences, Warp, combine, deforming_function,
    evaluate, evaluate_points, in_force,
};
