//! The classic geometric warps, one file each.
//!
//! - [`features`]: free-standing points, coordinate frames, and the vortex.
//! - [`lines`]: lines of the plane, points, segments, rectangles and boxes, by their distance.
//! - [`lattices`]: free-form deformation with Bernstein polynomials, B-splines, and lattices of frames.
//! - [`cages`]: control points and frames as wires that a modeller edits.
//! - [`barr`]: taper, twist, bend and the generalized deformation along an axis.
//! - [`grids`]: grids of the plane, each cell of which follows its corners.
//! - [`multilevel`]: hierarchies of lattices fitted to points.
//! - [`polynomials`]: polynomials of the coordinates, fitted to points.
//! - [`radial`]: radial basis functions and thin plates through points.
//! - [`scodef`]: points with displacements, each with a surrounding of its own.
//! - [`wires`]: curves that are bent, and the model near them follows; axes that bend.
//!
//! Each warp is built by a `construct` function that checks its parameters and returns a typed error, and is a
//! [`Warp`](anamorph_core::Warp): it can be evaluated, bound, masked, stacked and reported on. With the feature `recipe`
//! the `registry` module lists them for recipes.
//!
//! ```
//! use anamorph_core::{glam::dvec3, map_all, Bounds, Scaling, Solid};
//! use anamorph_warps::barr::{twist::Twist, AxisFrame, Course};
//!
//! // A quarter turn over two units of height.
//! let frame = AxisFrame::new(Solid::ZERO, Solid::Y, None)?;
//! let angle = Course::linear(0.0, 0.0, 2.0, std::f64::consts::FRAC_PI_2);
//! let twist = Twist::construct(frame, angle, None, Scaling::Composition)?;
//! let mut points = [dvec3(1.0, 0.0, 0.0), dvec3(1.0, 2.0, 0.0)];
//! map_all(&twist, &mut points);
//! assert!((points[1] - dvec3(0.0, 2.0, -1.0)).length() < 1e-12);
//! # Ok::<(), anamorph_warps::barr::AxisError>(())
//! ```

pub mod barr;
pub mod cages;
pub mod features;
pub mod grids;
pub mod lattices;
pub mod lines;
pub mod meshes;
pub mod multilevel;
pub mod polynomials;
pub mod radial;
#[cfg(feature = "recipe")]
pub mod registry;
pub mod scodef;
pub mod wires;
