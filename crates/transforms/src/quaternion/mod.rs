//! Unit quaternions, and paths through orientations.
//!
//! Quaternions are [`DQuat`]. Where one is written as an array it is `[w, x, y, z]`, the scalar first
//! ([`from_wxyz`], [`to_wxyz`]). `p · q` turns by `q` first; `q` and `−q` are the same rotation.
//!
//! - Conversions, [`exp`] and [`ln`], [`slerp`].
//! - The operators of constructions on the sphere: [`double`], [`bisect`], [`lerp`], [`bezier`], [`squad`],
//!   [`repair_signs`], [`inner_points`].
//! - [`Keys`]: a sequence of orientations with times, open or closed, and the paths through it, all of which are
//!   [`Orientations`]:
//!
//! | path | at the keys | even keys turn evenly | costs |
//! | --- | --- | --- | --- |
//! | [`LerpPath`] | corners | no | a square root |
//! | [`SlerpPath`] | corners | yes | a sine and cosine |
//! | [`SquadPath`] | angular velocity continuous | yes | three slerps |
//! | [`BezierPath`] | angular velocity continuous | yes | six slerps |
//! | [`RotationSpline`] | angular acceleration continuous | yes | a sine and cosine |
//!
//! - [`EvenTurning`]: any of them at constant angular speed, by the angle turned so far.
//!
//! ```
//! use anamorph_core::glam::{DQuat, DVec3};
//! use anamorph_transforms::quaternion::{
//!     Ends, EvenTurning, Keys, Orientations, RotationSpline, from_axis_angle,
//! };
//!
//! let keys = [
//!     DQuat::IDENTITY,
//!     from_axis_angle(DVec3::X, 1.0),
//!     from_axis_angle(DVec3::Y, 2.0),
//!     -from_axis_angle(DVec3::Z, 1.5), // the other cover of the same rotation: does not matter
//! ];
//! let keys = Keys::new(&keys, &[0.0, 1.0, 1.5, 4.0])?;
//! let path = RotationSpline::new(&keys, Ends::NATURAL)?;
//! assert!(path.orientation(1.0).dot(from_axis_angle(DVec3::X, 1.0)).abs() > 1.0 - 1e-12);
//!
//! // Eleven orientations with the same turn from each to the next along the path.
//! let even = EvenTurning::new(&path, 1e-9)?;
//! let steps: Vec<DQuat> = (0..=10)
//!     .map(|i| even.orientation(even.total() * f64::from(i) / 10.0))
//!     .collect();
//! assert_eq!(steps.len(), 11);
//! # Ok::<(), anamorph_transforms::quaternion::OrientationError>(())
//! ```

mod arc;
mod basics;
mod bezier;
mod error;
mod keys;
mod linear;
mod operators;
mod path;
mod spline;
mod squad;
mod timeline;
mod turning;

pub use basics::{
    exp, from_axis_angle, from_matrix, from_wxyz, ln, nearer, normalized, rotation_between, slerp,
    to_axis_angle, to_matrix, to_turn, to_wxyz,
};
pub use bezier::BezierPath;
pub use error::OrientationError;
pub use keys::Keys;
pub use linear::{LerpPath, SlerpPath};
pub use operators::{
    InnerPoints, bezier, bisect, double, inner_points, lerp, repair_signs, squad, squad_points,
};
pub use path::Orientations;
pub use spline::{End, Ends, RotationSpline};
pub use squad::SquadPath;
pub use turning::EvenTurning;

#[cfg(doc)]
use anamorph_core::glam::DQuat;
