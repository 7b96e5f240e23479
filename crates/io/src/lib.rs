//! Model files as documents: points to move, and every other byte kept.
//!
//! Reading gives a [`Document`]; its [`points`](Document::points) can be moved by anything; writing it gives the original
//! file with the moved points in place. What a format holds besides — comments, groups, materials, columns of a table,
//! unknown statements, the way numbers and line ends are written — stays as it was, to the byte.
//!
//! This crate opens no files: it reads from a `Vec<u8>` and writes to any [`std::io::Write`].
//!
//! ```
//! use anamorph_core::glam::DVec3;
//! use anamorph_io::{Moved, Points, ReadOptions, read};
//!
//! let file = b"# a triangle\nv 0 0 0 # origin\nv 1.50 0 0\nv 0 1e0 0\nf 1 2 3\n".to_vec();
//! let document = read(file, Some("triangle.obj"), &ReadOptions::default())?;
//!
//! let Points::Solid(points) = document.points() else { return Ok(()) };
//! let doubled: Vec<DVec3> = points.iter().map(|p| *p * 2.0).collect();
//!
//! let mut out = Vec::new();
//! document.write(&Moved::new(Points::Solid(&doubled)), &mut out)?;
//! assert_eq!(out, b"# a triangle\nv 0 0 0 # origin\nv 3 0 0\nv 0 2 0\nf 1 2 3\n");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A format is one file in `formats/` and one line in the registry, see [`formats`]. Damaged files give a [`ReadError`]
//! that says what is wrong, where, and how to mend it; [`Document::inspect`] lists what is odd in files that can be read.
//! With the feature `parallel` large files are scanned and written on all cores, with the same result bit for bit.

pub mod bindings;
mod document;
#[cfg(feature = "svg")]
pub mod drawings;
mod elements;
mod error;
mod faces;
mod format;
mod formats;
mod geometry;
#[cfg(feature = "images")]
pub mod images;
mod inspect;
#[cfg(feature = "landmarks")]
pub mod landmarks;
mod normals;
mod number;
#[cfg(feature = "outlines")]
pub mod outlines;
mod patch;
mod registry;
mod text;

pub use document::{Document, Mesh, Moved, NormalMap, Normals, Points, WriteReport};
pub use error::{ReadError, ReadErrorKind, WriteError};
pub use format::{Companions, Format, NoCompanions, ReadOptions, Recognition};
pub use formats::gltf::morph::{Farthest, MorphBase, MorphFrames, MorphKeys, MorphReport, Storage};
pub use formats::gltf_motion::{MovingNode, Track, write_motion};
pub use geometry::{Create, Geometry, Lost, Target, Values};
pub use inspect::{Inspection, Problem, ProblemKind};
pub use registry::{find, formats, read, read_with, targets};
