//! Inverse mapping: every target pixel is read where the map says it comes from.
//!
//! Target rows are independent, so that results are the same on any number of threads. The Jacobian that the anisotropic
//! filter needs is taken from the positions of neighbouring target pixels: it is then the footprint that the pixels really
//! have, and costs no evaluations.

use crate::map::offsets_of_row;
use crate::sampling::{Around, Edge, Filter, Sampler};
use crate::{PixelMap, Raster, RasterError, Window, parallel};
use anamorph_core::glam::DVec2;
use anamorph_core::{Deformation, Plane};
use std::borrow::Cow;
use std::ops::Range;

/// Rows a task draws.
const ROWS: usize = 16;

/// Draws `source` through `map`: a raster of the map's window with the source's channels and display window.
///
/// # Errors
/// [`RasterError::TooLarge`].
pub fn resample(
    source: &Raster,
    map: &PixelMap,
    filter: Filter,
    edge: Edge,
) -> Result<Raster, RasterError> {
    let target = Raster::new(map.window(), source.channels())?;
    let mut target = target.with_display(source.display());
    resample_into(source, map, filter, edge, &mut target)?;
    Ok(target)
}

/// As [`resample`], over a raster that is already there: sequences need no new memory for each picture.
///
/// # Errors
/// [`RasterError::Windows`], [`RasterError::Channels`] where the target's differ from the map's and the source's.
pub fn resample_into(
    source: &Raster,
    map: &PixelMap,
    filter: Filter,
    edge: Edge,
    target: &mut Raster,
) -> Result<(), RasterError> {
    if target.window() != map.window() {
        return Err(RasterError::Windows {
            first: target.window(),
            second: map.window(),
        });
    }
    if target.channels() != source.channels() {
        return Err(RasterError::Channels {
            first: target.channels(),
            second: source.channels(),
        });
    }
    let width = map.window().width();
    draw(source, filter, edge, target, |rows, _| {
        Cow::Borrowed(&map.offsets()[rows.start * width..rows.end * width])
    });
    Ok(())
}

/// Draws `source` through a deformation from target to source, evaluated at every pixel of `window`: the same picture as
/// through [`PixelMap::from_deformation`], bit for bit, without keeping the map.
///
/// # Errors
/// [`RasterError::TooLarge`].
pub fn resample_through(
    source: &Raster,
    deformation: &dyn Deformation<Plane>,
    filter: Filter,
    edge: Edge,
    window: Window,
) -> Result<Raster, RasterError> {
    let target = Raster::new(window, source.channels())?;
    let mut target = target.with_display(source.display());
    let width = window.width();
    draw(source, filter, edge, &mut target, |rows, points| {
        let mut offsets = vec![[0.0; 2]; rows.len() * width];
        for (row, out) in rows.zip(offsets.chunks_exact_mut(width)) {
            offsets_of_row(deformation, window, row, points, out);
        }
        Cow::Owned(offsets)
    });
    Ok(target)
}

/// Draws all rows of `target`; `fetch` gives the offsets of a range of them.
fn draw<'a>(
    source: &Raster,
    filter: Filter,
    edge: Edge,
    target: &mut Raster,
    fetch: impl Fn(Range<usize>, &mut Vec<DVec2>) -> Cow<'a, [[f32; 2]]> + Sync + Send,
) {
    let sampler = Sampler::new(source, filter, edge);
    let window = target.window();
    let (width, height) = (window.width(), window.height());
    let line = width * source.channels();
    // One row more on either side, as far as there are any, for the differences.
    let border = usize::from(filter.needs_jacobian());
    parallel::chunks_with(
        target.samples_mut(),
        line * ROWS,
        Vec::new,
        |points, task, chunk| {
            let first = task * ROWS;
            let rows = first..first + chunk.len() / line;
            let around = rows.start.saturating_sub(border)..(rows.end + border).min(height);
            let offsets = fetch(around.clone(), points);
            for (row, out) in rows.zip(chunk.chunks_exact_mut(line)) {
                let here = (row - around.start) * width;
                let offsets_here = &offsets[here..here + width];
                let centre = window.centre(0, row);
                // The rows next to it; none where the filter does not ask for them.
                let at = row - around.start;
                let line = |row: usize| &offsets[row * width..(row + 1) * width];
                let (above, below) = (at.saturating_sub(1), (at + 1).min(around.len() - 1));
                let neighbours = Around {
                    above: if border == 1 { line(above) } else { &[] },
                    below: if border == 1 { line(below) } else { &[] },
                    steps: below - above,
                };
                sampler.row(centre, offsets_here, &neighbours, out);
            }
        },
    );
}
