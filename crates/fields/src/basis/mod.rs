//! Polynomial bases on the unit interval: Bernstein and B-spline.
//!
//! *Source*: T. W. Sederberg and S. R. Parry, *Free-Form Deformation of Solid Geometric Models*, SIGGRAPH 1986
//! (Bernstein); J. Griessmair and W. Purgathofer, *Deformation of Solids with Trivariate B-Splines*, Eurographics 1989;
//! errata F1, F20, C17.

pub mod bernstein;
mod bspline;

pub use bspline::KnotVector;
