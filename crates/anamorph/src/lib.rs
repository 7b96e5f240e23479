//! Geometric warps: models moved by weighted averages of scaled transformations.
//!
//! This crate is one name for the parts, each behind a feature flag. It holds no geometry of its own; whoever needs one
//! part alone can depend on that crate instead.
//!
//! | module | feature | what it holds |
//! | --- | --- | --- |
//! | (root) | always | the engine and its vocabulary: [`Deformation`], [`Warp`], [`Field`], [`Stack`], [`map_all`], … |
//! | `curves` | `curves` | curves, arc length, eases, motion, orientation along paths, smoothing |
//! | `meshing` | `meshing` | surfaces of triangles, paths on them, decimation |
//! | `features` | default | pairs of points and frames |
//! | `fields` | default | falloffs, fields of space and of a model, polynomial bases |
//! | `transforms` | default | composition scaling, polar decomposition, quaternions, paths through orientations |
//! | `solvers` | default | sparse symmetric systems of equations |
//! | `warps` | default | the warps: points, frames, vortex, lattices, taper, bend, twist, axial |
//! | `io` | `io` | OBJ and CSV documents that keep every byte that does not change |
//! | `recipe`, `catalog`, `registry` | `recipe` | TOML and JSON recipes, and what they can name |
//! | `raster` | `raster` | images: rasters, colour, filters, maps, resampling, splatting |
//! | `preview` | `preview` | pictures of models before and after |
//!
//! The feature `sparse`, on by default, lets radial warps with a radius have many points. The feature `parallel` uses all cores, with the same results bit for bit; `full` is everything.
//!
#![cfg_attr(feature = "warps", doc = "```")]
#![cfg_attr(not(feature = "warps"), doc = "```ignore")]
//! use anamorph::glam::dvec3;
//! use anamorph::warps::barr::{AxisFrame, bend::Bend};
//! use anamorph::{Scaling, Solid, map_all};
//!
//! // The z axis, bent towards x by a quarter turn a unit; the origin stays.
//! let frame = AxisFrame::new(Solid::ZERO, Solid::Z, Some(Solid::X))?;
//! let quarter = std::f64::consts::FRAC_PI_2;
//! let bend = Bend::construct(frame, quarter, 0.0, None, Scaling::Composition)?;
//!
//! let mut points = [dvec3(0.0, 0.0, 0.0), dvec3(0.0, 0.0, 1.0)];
//! let unmapped = map_all(&bend, &mut points);
//! assert!(unmapped.is_empty());
//! assert!((points[1] - dvec3(1.0 / quarter, 0.0, 1.0 / quarter)).length() < 1e-12);
//! # Ok::<(), anamorph::warps::barr::AxisError>(())
//! ```

pub use anamorph_core::*;

#[cfg(feature = "recipe")]
pub use anamorph_catalog as catalog;
#[cfg(feature = "curves")]
pub use anamorph_curves as curves;
#[cfg(feature = "features")]
pub use anamorph_features as features;
#[cfg(feature = "fields")]
pub use anamorph_fields as fields;
#[cfg(feature = "io")]
pub use anamorph_io as io;
#[cfg(feature = "meshing")]
pub use anamorph_meshing as meshing;
#[cfg(feature = "preview")]
pub use anamorph_preview as preview;
#[cfg(feature = "raster")]
pub use anamorph_raster as raster;
#[cfg(feature = "recipe")]
pub use anamorph_recipe as recipe;
#[cfg(feature = "solvers")]
pub use anamorph_solvers as solvers;
#[cfg(feature = "transforms")]
pub use anamorph_transforms as transforms;
#[cfg(feature = "warps")]
pub use anamorph_warps as warps;

#[cfg(feature = "recipe")]
pub mod registry;

// The examples of the pages are compiled and run.
#[cfg(all(doctest, feature = "warps"))]
#[doc = include_str!("../../../README.md")]
struct Readme;
#[cfg(all(doctest, feature = "recipe"))]
#[doc = include_str!("../../../docs/adding-a-warp.md")]
struct AddingAWarp;
#[cfg(all(doctest, feature = "raster"))]
#[doc = include_str!("../../../docs/images.md")]
struct Images;
