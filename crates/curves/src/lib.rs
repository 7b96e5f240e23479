//! Curves in the plane and in space, and motion along them.
//!
//! A motion is `P(U(S(t)))` (*Interpolation Techniques*, chapter 2): time becomes distance, distance becomes a parameter,
//! the parameter becomes a point.

pub mod eases;
mod error;
pub mod motion;
pub mod smoothing;

pub use error::CurveError;
