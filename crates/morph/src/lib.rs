//! Metamorphosis: one thing becomes another by way of things between them.
//!
//! - [`KeyPath`]: how anything goes through its keys over time, straight from one to the next or smoothly through all.
//! - [`places`]: in-betweens of features, points and lines.
//! - [`figures`]: what is between two drawings, by the parts below.
//! - [`grid`]: images warped by coordinate grids that the user lays over them, in two passes.
//! - [`strain`]: in-betweens of shapes by their strains.
//! - [`matching`]: which place of one closed outline becomes which place of another.
//! - [`shapes`]: what outlines need before they can be meshed, and which parts and holes become which.
//! - [`silhouette`]: the outlines of what an image shows.
//! - [`texture`]: images on meshes, from one shape to another.
//! - [`images`]: frames of a metamorphosis of two images, by any deformations that lead back to them.
//!
//! Coordinates of images are those of `anamorph-raster`: pixel `(x, y)` covers `[x, x + 1) × [y, y + 1)`, `x` goes right and `y`
//! goes down. Samples are in premultiplied linear light wherever they are mixed; nothing here checks that.
//!
//! Results do not depend on the processor or on the number of threads (feature `parallel`).
//!
//! ```
//! use anamorph_morph::KeyPath;
//! use anamorph_morph::grid::{CoordinateGrid, GridKeys, GridWarp, Spline, two_pass};
//! use anamorph_raster::{Edge, Raster, Window};
//!
//! let window = Window::new(0, 0, 32, 32)?;
//! let (first, second) = (Raster::new(window, 4)?, Raster::new(window, 4)?);
//! // A node of the first image's grid stands elsewhere in the second's.
//! let here = CoordinateGrid::regular(window, 3, 3)?;
//! let there = here.with_node(1, 1, [20.0, 12.0].into())?;
//!
//! // A quarter of the way, both images on the same grid; a cross-dissolve of the two is the metamorphosis.
//! let keys = GridKeys::new(vec![here.clone(), there.clone()], KeyPath::Straight)?;
//! let between = keys.at(0.25)?;
//! for (image, grid) in [(&first, &here), (&second, &there)] {
//!     let warp = GridWarp::new(&between, grid, Spline::CatmullRom)?;
//!     let drawn = two_pass(image, &warp, window, Edge::Clamp)?;
//!     assert_eq!(drawn.window(), window);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod figures;
pub mod grid;
pub mod images;
mod keys;
pub mod matching;
mod names;
pub mod places;
pub mod shapes;
pub mod silhouette;
pub mod strain;
pub mod texture;

pub use keys::{KeyError, KeyPath};
pub use names::UnknownName;
