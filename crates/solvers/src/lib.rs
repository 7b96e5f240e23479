//! Sparse symmetric positive definite systems of linear equations.
//!
//! - [`pattern`]: which entries a matrix may have, and how lists of contributions become their values.
//! - [`cholesky`]: `A = LLᵀ`, as two types: what follows from the pattern alone, and the factor of one matrix of it.
//!
//! ```
//! use anamorph_solvers::{Arithmetic, Factor, Pattern, Symbolic};
//!
//! // Second differences of four numbers between two that are held: one entry below each of the diagonal but the last.
//! let entries = [(0, 0), (1, 1), (2, 2), (3, 3), (1, 0), (2, 1), (3, 2)];
//! let pattern = Pattern::of_entries(4, &entries)?;
//! let values = pattern.assemble(&[2.0, 2.0, 2.0, 2.0, -1.0, -1.0, -1.0])?;
//! let symbolic = Symbolic::of(pattern, Arithmetic::Reproducible, usize::MAX)?;
//! let mut factor = Factor::of(symbolic, &values)?;
//! let mut x = [1.0, 0.0, 0.0, 1.0];
//! factor.solve_in_place(&mut x)?;
//! assert!(x.iter().all(|x| (x - 1.0).abs() < 1e-14));
//! # Ok::<(), anamorph_solvers::SolverError>(())
//! ```

mod blocks;
pub mod cholesky;
mod error;
pub mod pattern;

pub use cholesky::{Arithmetic, Factor, Symbolic};
pub use error::SolverError;
pub use pattern::Pattern;
