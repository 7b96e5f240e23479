//! Pixels as a model: rasters, colour, sampling, resampling through maps.
//!
//! - [`Raster`]: `f32` samples on a [`Window`] of the pixel grid, any number of channels.
//! - [`colour`]: sRGB and linear light, premultiplied alpha, Oklab.
//! - [`sampling`]: filters and edges by name ([`Filter`], [`Edge`]); [`Sampler`] reads a raster between its pixels.
//! - [`PixelMap`]: where every target pixel comes from. [`resample`] draws through one, [`resample_through`] through any
//!   deformation of the plane.
//! - [`hierarchical_map`]: a map evaluated on a grid only as fine as a bound of its error asks for.
//! - [`splat`]: the other direction, source pixels drawn where a deformation takes them.
//! - [`cross_dissolve`]: two rasters in one.
//! - [`snake`]: curves that settle on an image's edges, to be features of a warp.
//!
//! Coordinates: pixel `(x, y)` covers `[x, x + 1) × [y, y + 1)`, its centre is `(x + ½, y + ½)`; `x` goes right and `y` goes
//! down, as in files. A warp of an image in these coordinates is a `Deformation<Plane>`, and inverse mapping takes the
//! one from target to source. Samples are in linear light and premultiplied wherever they are mixed; nothing here
//! checks that.
//!
//! Results do not depend on the processor or on the number of threads (feature `parallel`).
//!
//! ```
//! use anamorph_core::{Affine, glam::dvec2};
//! use anamorph_raster::{Edge, Filter, Raster, Window, resample_through};
//!
//! let window = Window::new(0, 0, 4, 2)?;
//! let mut image = Raster::new(window, 1)?;
//! image.pixel_mut(1, 0).fill(1.0);
//!
//! // Where target pixels come from: one to the left.
//! let inverse = Affine::translation(dvec2(-1.0, 0.0));
//! let moved = resample_through(&image, &inverse, Filter::CATMULL_ROM, Edge::Clamp, window)?;
//! assert_eq!(moved.pixel(2, 0), [1.0]);
//! # Ok::<(), anamorph_raster::RasterError>(())
//! ```

pub mod colour;
mod dissolve;
mod error;
mod hierarchy;
mod map;
pub mod parallel;
mod raster;
mod resample;
pub mod sampling;
pub mod snake;
mod splat;
mod window;

pub use dissolve::{cross_dissolve, dissolve_into};
pub use error::RasterError;
pub use hierarchy::{Bound, Hierarchy, HierarchyReport, hierarchical_map, hierarchical_map_into};
pub use map::PixelMap;
pub use raster::Raster;
pub use resample::{resample, resample_into, resample_through};
pub use sampling::{Edge, Filter, Sampler};
pub use splat::{Overlap, Splat, SplatOptions, splat};
pub use window::Window;
