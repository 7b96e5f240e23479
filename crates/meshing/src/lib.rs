//! Triangle meshes as surfaces, and paths on them.
//!
//! - [`Topology`]: who neighbours whom. It knows no positions.
//! - [`Surface`]: a topology with positions; [`SurfacePoint`]: a place at a vertex, on an edge or in a face; normals.
//! - [`SurfaceTree`]: the place of a surface that is nearest to a point of space, answered often.
//! - [`decimation`]: a coarse mesh from a fine one, of the same topology.
//! - [`paths`]: sections by a plane, shortest paths along edges, straightest walks, downhill walks.
//!
//! Polygons are cut into triangles by the caller. Lengths are in the units of the positions, angles in radians. Results
//! do not depend on the processor, nor on the order of a hash map.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Path finding" and "Path finding – downhill"; K. Polthier and
//! M. Schmies, *Straightest Geodesics on Polyhedral Surfaces*, Mathematical Visualization, 1998.
//!
//! ```
//! use anamorph_core::glam::dvec3;
//! use anamorph_meshing::{Surface, SurfacePoint, paths::{self, DownhillEnd, Upright}};
//!
//! // A roof: its ridge, from vertex 2 to vertex 3, stands a unit above the eaves.
//! let roof = Surface::new(
//!     vec![
//!         dvec3(0.0, -1.0, 0.0), dvec3(4.0, -1.0, 0.0),
//!         dvec3(0.0, 0.0, 1.0), dvec3(4.0, 0.0, 1.0),
//!         dvec3(0.0, 1.0, 0.0), dvec3(4.0, 1.0, 0.0),
//!     ],
//!     &[[0, 1, 3], [0, 3, 2], [2, 3, 5], [2, 5, 4]],
//! )?;
//! let start = SurfacePoint::Face { face: 0, weights: [0.25, 0.5, 0.25] };
//!
//! // Straight over the ridge, in the upright plane through both points.
//! let over = paths::section(&roof, start, SurfacePoint::Vertex(4), Upright::Along(dvec3(0.0, 0.0, 1.0)))?;
//! assert_eq!(over.positions.last(), Some(&dvec3(0.0, 1.0, 0.0)));
//! assert!(over.positions.iter().any(|p| (p.z - 1.0).abs() < 1e-12));
//!
//! // Downhill, water runs straight to the eaves and off the roof.
//! let down = paths::downhill(&roof, start, dvec3(0.0, 0.0, 1.0), f64::INFINITY)?;
//! assert_eq!(down.ending, DownhillEnd::Boundary);
//! assert!((down.length - 0.25 * 2.0_f64.sqrt()).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod decimation;
mod error;
mod nearest;
pub mod paths;
pub mod planar;
mod surface;
#[cfg(test)]
mod testing;
mod topology;

pub use error::{SurfaceError, SurfacePointError, TopologyError};
pub use nearest::{NearestSurfacePoint, SurfaceTree};
pub use surface::{Surface, SurfacePoint};
pub use topology::{Corner, Topology};
