//! A picture warped from grid to grid: rows first, then columns.
//!
//! The first pass resamples each row of the image into the columns of the result, the second each column of that into the rows
//! of the result, both after [`resampling`](super::resampling). It is the picture that [`GridWarp`] maps, where
//! shrinking is averaged along rows and columns.
//!
//! *Source*: G. Wolberg, *Digital Image Warping*, 1990, §7.7.4; E. Catmull and A. R. Smith, *3-D Transformations of Images in
//! Scanline Order*, SIGGRAPH 1980 (two passes). Decisions: the second pass reads columns where they stand, a run of the
//! result's rows at a time, so that neighbouring columns share what they read and nothing is transposed. Beyond the rows of
//! the image the second pass goes on with the rows that the first has made, as the edge says.

use super::line::{Knot, Span, span};
use super::resampling::Line;
use super::{GridWarp, Spline};
use crate::parallel;
use anamorph_raster::{Edge, Raster, RasterError, Window};

/// Rows a task draws in the second pass. Each task looks for the start of every column once.
const ROWS: usize = 32;
/// Rows a task draws in the first pass.
const ACROSS: usize = 8;

/// Memory of [`two_pass_into`], kept from picture to picture.
#[derive(Debug, Clone, Default)]
pub struct TwoPassMemory {
    /// What the first pass has drawn.
    across: Vec<f32>,
    /// For each column of pixels where it meets the rows of the grid.
    knots: Vec<Knot>,
}

/// Draws the pixels of `window` of the image warped by grids. Samples are mixed as they are, which is right for premultiplied
/// linear light. Nodes of the image's grid come to stand on those of the result's; equal grids give the same pixels bit for
/// bit.
///
/// # Errors
/// [`RasterError::TooLarge`].
pub fn two_pass(
    image: &Raster,
    warp: &GridWarp,
    window: Window,
    edge: Edge,
) -> Result<Raster, RasterError> {
    let target = Raster::new(window, image.channels())?;
    let mut target = target.with_display(image.display());
    two_pass_into(
        image,
        warp,
        edge,
        &mut TwoPassMemory::default(),
        &mut target,
    )?;
    Ok(target)
}

/// As [`two_pass`], over a raster that is already there and with memory of an earlier call: sequences need no new memory for
/// each picture.
///
/// # Errors
/// [`RasterError::Channels`] where the target's differ from the image's; [`RasterError::TooLarge`].
pub fn two_pass_into(
    image: &Raster,
    warp: &GridWarp,
    edge: Edge,
    memory: &mut TwoPassMemory,
    target: &mut Raster,
) -> Result<(), RasterError> {
    let channels = image.channels();
    if target.channels() != channels {
        return Err(RasterError::Channels {
            first: target.channels(),
            second: channels,
        });
    }
    let window = target.window();
    let (width, height) = (window.width(), window.height());
    let (_, lines) = warp.shape();

    make_room(&mut memory.knots, window, lines, Knot::default())?;
    parallel::chunks_with(
        &mut memory.knots,
        lines,
        || (),
        |(), column, knots| {
            let x = window.centre(column, 0).x;
            for (row, knot) in knots.iter_mut().enumerate() {
                *knot = warp.knot_down(x, row);
            }
        },
    );

    let rows = needed_rows(
        warp.spline(),
        &memory.knots,
        lines,
        window,
        image.window(),
        edge,
    );
    let between = Window::new(window.x(), image.window().y(), width, rows.len())?;
    make_room_for(&mut memory.across, between, channels)?;
    parallel::chunks_with(
        &mut memory.across,
        ACROSS * width * channels,
        Vec::new,
        |knots, task, out| {
            for (row, out) in out.chunks_exact_mut(width * channels).enumerate() {
                let row = rows.start + task * ACROSS + row;
                row_across(image, warp, edge, window, row, knots, out);
            }
        },
    );

    let corner = image.window().corner().y + rows.start as f64;
    let (across, knots) = (&memory.across, &memory.knots);
    parallel::chunks_with(
        target.samples_mut(),
        ROWS * width * channels,
        Vec::new,
        |columns: &mut Vec<(Span, f64)>, task, out| {
            let top = window.corner().y + (task * ROWS) as f64;
            let column = |column: usize, at: f64| {
                let knots = &knots[column * lines..][..lines];
                span(warp.spline(), lines, |i| knots[i], at)
            };
            columns.clear();
            columns.extend((0..width).map(|x| {
                let span = column(x, top);
                (span, span.place(top) - corner)
            }));
            for (row, out) in out.chunks_exact_mut(width * channels).enumerate() {
                let below = top + (row + 1) as f64;
                let pixels = out.chunks_exact_mut(channels).zip(columns.iter_mut());
                for (x, (pixel, (here, above))) in pixels.enumerate() {
                    if !here.holds(below) {
                        *here = column(x, below);
                    }
                    let place = here.place(below) - corner;
                    let line = Line {
                        samples: across,
                        start: x * channels,
                        stride: width * channels,
                        count: rows.len(),
                        edge,
                    };
                    line.pixel(*above, place, pixel);
                    *above = place;
                }
            }
        },
    );
    debug_assert_eq!(target.samples().len(), width * height * channels);
    Ok(())
}

/// The first pass for one row of the image.
fn row_across(
    image: &Raster,
    warp: &GridWarp,
    edge: Edge,
    window: Window,
    row: usize,
    knots: &mut Vec<Knot>,
    out: &mut [f32],
) {
    let channels = image.channels();
    let y = image.window().centre(0, row).y;
    let (lines, _) = warp.shape();
    knots.clear();
    knots.extend((0..lines).map(|column| warp.knot_across(y, column)));
    let line = Line {
        samples: image.samples(),
        start: row * image.width() * channels,
        stride: channels,
        count: image.width(),
        edge,
    };
    let corner = image.window().corner().x;
    let left = window.corner().x;
    let mut here = span(warp.spline(), lines, |i| knots[i], left);
    let mut before = here.place(left) - corner;
    for (column, pixel) in out.chunks_exact_mut(channels).enumerate() {
        let right = left + (column + 1) as f64;
        if !here.holds(right) {
            here = span(warp.spline(), lines, |i| knots[i], right);
        }
        let place = here.place(right) - corner;
        line.pixel(before, place, pixel);
        before = place;
    }
}

/// The rows of the image that the second pass reads, at least one.
fn needed_rows(
    spline: Spline,
    knots: &[Knot],
    lines: usize,
    window: Window,
    image: Window,
    edge: Edge,
) -> std::ops::Range<usize> {
    let all = 0..image.height();
    if !spline.keeps_order() {
        return all;
    }
    let top = window.corner().y;
    let ends = [top, top + window.height() as f64];
    let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
    for knots in knots.chunks_exact(lines) {
        let [above, below] =
            ends.map(|at| span(spline, lines, |i| knots[i], at).place(at) - image.corner().y);
        (first, last) = (first.min(above), last.max(below));
    }
    // Up to a pixel more for interpolation.
    let (first, last) = (first - 1.0, last + 1.0);
    let height = image.height() as f64;
    let repeats = matches!(edge, Edge::Wrap | Edge::Mirror);
    // An edge inside the rows kept would not be the image's edge.
    if first < 0.0 || last > height || repeats {
        return all;
    }
    first as usize..(last as usize + 1).min(image.height())
}

/// Makes a list `lines` times as long as the window is wide.
fn make_room<T: Clone>(
    list: &mut Vec<T>,
    window: Window,
    lines: usize,
    value: T,
) -> Result<(), RasterError> {
    let too_large = || RasterError::TooLarge {
        width: window.width(),
        height: window.height(),
        channels: lines,
    };
    let count = window.width().checked_mul(lines).ok_or_else(too_large)?;
    grow(list, count, value).map_err(|()| too_large())
}

/// Makes a list hold a raster.
fn make_room_for(list: &mut Vec<f32>, window: Window, channels: usize) -> Result<(), RasterError> {
    let too_large = || RasterError::TooLarge {
        width: window.width(),
        height: window.height(),
        channels,
    };
    let count = window.pixels().and_then(|n| n.checked_mul(channels));
    grow(list, count.ok_or_else(too_large)?, 0.0).map_err(|()| too_large())
}

/// Makes a list that long; what was in it may stay.
fn grow<T: Clone>(list: &mut Vec<T>, count: usize, value: T) -> Result<(), ()> {
    let more = count.saturating_sub(list.len());
    list.try_reserve_exact(more).map_err(|_| ())?;
    list.resize(count, value);
    Ok(())
}
