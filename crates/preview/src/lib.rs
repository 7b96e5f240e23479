//! Pictures of models and of what warps do to them.
//!
//! [`before_after`] puts a model and its warped self side by side under one camera; [`single`] shows one. A model in
//! space ([`DVec3`](anamorph_core::glam::DVec3) points) is shaded like porcelain in a studio, with soft shadows and
//! smooth normals that keep hard edges; its inside is cooler than its outside. A model in the plane
//! ([`DVec2`](anamorph_core::glam::DVec2) points) is drawn flat on a grid. Over it lie the
//! [marks](anamorph_core::Mark) of a warp, source features orange and target features blue, faint where the model
//! hides them.
//!
//! A [`Figure`] is a drawing of lines and words, such as a plot.
//!
//! Everything is computed: no files, fonts, windows or graphics hardware. The same input gives the same pixels on any
//! number of threads (feature `parallel` uses several).
//!
//! ```
//! use anamorph_core::glam::DVec3;
//! use anamorph_core::{Mark, Role, Shape};
//! use anamorph_preview::{Model, Options, Panel, before_after};
//!
//! let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let stretched = points.map(|point| point * DVec3::new(1.0, 1.5, 1.0));
//! let source = [Mark::new(Role::Source, Shape::Point(DVec3::Y))];
//! let target = [Mark::new(Role::Target, Shape::Arrow(DVec3::Y, DVec3::Y * 1.5))];
//! let picture = before_after(
//!     &Panel::new(Model::mesh(&points, &triangles)).with_marks(&source),
//!     &Panel::new(Model::mesh(&stretched, &triangles)).with_marks(&target),
//!     &Options { width: 320, height: 180, ..Options::default() },
//! )?;
//! assert!(picture.png()?.starts_with(b"\x89PNG"));
//! # Ok::<(), anamorph_preview::PreviewError>(())
//! ```

mod animation;
mod compose;
mod error;
mod figure;
mod light;
mod mesh;
mod options;
mod overlay;
mod palette;
mod panel;
mod parallel;
mod picture;
mod plane;
mod raster;
mod shade;
mod shadow;
mod strokes;
mod view;

pub use animation::{Animation, AnimationFormat};
pub use compose::{before_after, single};
pub use error::PreviewError;
pub use figure::{Anchor, Figure, Ink};
pub use options::{Camera, Options, Projection, Theme, Up};
pub use panel::{Drawable, Model, Panel};
pub use picture::Picture;
