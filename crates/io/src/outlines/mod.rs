//! Files of filled shapes: drawings, polygons and letters in; animated drawings, frames and pairs of meshes out.
//!
//! - [`Drawing`], [`Part`], [`Contour`]: shapes of lines and curves, one colour each, flattened by [`Contour::flatten`].
//! - [`read`] finds the form by the content: SVG (with the feature `svg`), files of polygons, `GeoJSON`. `read_text` gives the outlines of a
//!   text in a font (with the feature `fonts`).
//! - [`Animation`] writes frames as one animated SVG or as Lottie, or as single SVG drawings; [`write_polygons`] as files of polygons.
//! - [`Pair`]: two meshes with the same triangles, and its file. [`MeshFrames`] writes in-betweens of a mesh as OBJ or as one GLB.
//! - [`mix_fill`]: colours between two colours. [`Rounding`]: how many digits files have.

mod animation;
mod colour;
mod drawing;
#[cfg(feature = "fonts")]
mod fonts;
mod lottie;
mod mesh;
mod nesting;
mod pair;
mod polygons;
mod rounding;
#[cfg(feature = "svg")]
mod svg;

pub use animation::{Animation, Repeat, write_svg};
pub use colour::{Fill, mix_fill};
pub use drawing::{Contour, Drawing, MOST_PIECES, Part, Rule, Segment, Stroke};
#[cfg(feature = "fonts")]
pub use fonts::{FontOptions, MOST_CHARACTERS, is_font, read_text};
pub use mesh::MeshFrames;
pub use nesting::Polygon;
pub use pair::{Pair, PairPart, PairRing, PairSlice};
pub use polygons::{read_geojson, read_polygons, write_polygons};
pub use rounding::{Rounding, SIDE};
#[cfg(feature = "svg")]
pub use svg::{DEEPEST, MOST_ELEMENTS, read_svg};

use crate::error::{ReadError, ReadErrorKind};

fn unknown() -> ReadError {
    ReadError::new(
        ReadErrorKind::UnknownFormat,
        "this is no drawing: neither SVG, nor JSON with `polygons`, nor GeoJSON",
        "export the shape in one of these forms",
    )
}

/// The first byte that is no blank, behind a byte order mark.
fn first(bytes: &[u8]) -> Option<u8> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    text.iter()
        .copied()
        .find(|byte| !byte.is_ascii_whitespace())
}

/// Whether a file's bytes may be those of a drawing that [`read`] reads. JSON is parsed to find out.
#[must_use]
pub fn is_drawing(bytes: &[u8]) -> bool {
    match first(bytes) {
        Some(b'<') => {
            let head = String::from_utf8_lossy(&bytes[..bytes.len().min(1 << 16)]);
            cfg!(feature = "svg") && head.contains("<svg")
        }
        Some(b'{') => polygons::json(bytes)
            .is_ok_and(|value| polygons::is_polygons(&value) || polygons::is_geojson(&value)),
        _ => false,
    }
}

/// Reads a drawing, its form found by the content.
///
/// # Errors
/// What is of no known form, damaged, too large, or shows nothing; see the readers of each form.
pub fn read(bytes: &[u8]) -> Result<Drawing, ReadError> {
    match first(bytes) {
        #[cfg(feature = "svg")]
        Some(b'<') => read_svg(bytes),
        Some(b'{') => {
            let value = polygons::json(bytes)?;
            if polygons::is_polygons(&value) {
                polygons::of_polygons(&value)
            } else if polygons::is_geojson(&value) {
                polygons::of_geojson(&value)
            } else {
                Err(unknown())
            }
        }
        _ => Err(unknown()),
    }
}
