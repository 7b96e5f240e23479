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

use super::line::{Knot, NUMBERS, Span, evaluate, span};
use super::resampling::{self, Line, RUN};
use super::{GridWarp, Spline};
use anamorph_core::simd::{Level, dispatch};
use anamorph_raster::parallel;
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
    let width = window.width();
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
    let first = First {
        image,
        warp,
        edge,
        window,
    };
    parallel::chunks_with(
        &mut memory.across,
        ACROSS * width * channels,
        Vec::new,
        |knots, task, out| {
            for (row, out) in out.chunks_exact_mut(width * channels).enumerate() {
                first.across(rows.start + task * ACROSS + row, knots, out);
            }
        },
    );

    let second = Second {
        across: &memory.across,
        rows: rows.len(),
        top: image.window().corner().y + rows.start as f64,
        knots: &memory.knots,
        lines,
        spline: warp.spline(),
        edge,
        width,
        channels,
    };
    parallel::chunks_with(
        target.samples_mut(),
        ROWS * width * channels,
        Cursors::default,
        |cursors, task, out| {
            let top = window.corner().y + (task * ROWS) as f64;
            second.down(top, cursors, out);
        },
    );
    Ok(())
}

/// Calls a function for the number of channels if the quick way knows it.
macro_rules! with_channels {
    ($channels:expr, $quick:ident($($argument:expr),*), $slow:expr) => {
        match $channels {
            1 => dispatch!(Level::new(), _simd => $quick::<1>($($argument),*)),
            2 => dispatch!(Level::new(), _simd => $quick::<2>($($argument),*)),
            3 => dispatch!(Level::new(), _simd => $quick::<3>($($argument),*)),
            4 => dispatch!(Level::new(), _simd => $quick::<4>($($argument),*)),
            _ => $slow,
        }
    };
}

/// The first pass: rows of the image become those between.
struct First<'a> {
    image: &'a Raster,
    warp: &'a GridWarp,
    edge: Edge,
    window: Window,
}

impl First<'_> {
    /// One row of the image.
    fn across(&self, row: usize, knots: &mut Vec<Knot>, out: &mut [f32]) {
        let channels = self.image.channels();
        let y = self.image.window().centre(0, row).y;
        let (lines, _) = self.warp.shape();
        knots.clear();
        knots.extend((0..lines).map(|column| self.warp.knot_across(y, column)));
        let line = Line {
            samples: self.image.samples(),
            start: row * self.image.width() * channels,
            stride: channels,
            count: self.image.width(),
            edge: self.edge,
        };
        let corner = self.image.window().corner().x;
        let left = self.window.corner().x;
        let spline = self.warp.spline();
        let places = Places::new(spline, knots, left, corner);
        with_channels!(channels, quick_across(line, places, out), {
            let mut places = places;
            let mut run = [0.0; RUN + 1];
            for pixels in out.chunks_mut(RUN * channels) {
                places.next_run(&mut run);
                for (pixel, pair) in pixels.chunks_exact_mut(channels).zip(run.windows(2)) {
                    line.pixel(pair[0], pair[1], pixel);
                }
            }
        });
    }
}

/// Where the boundaries between pixels of a row come from, a run at a time.
#[derive(Clone, Copy)]
struct Places<'a> {
    spline: Spline,
    knots: &'a [Knot],
    span: Span,
    /// The boundary at hand, in the result.
    at: f64,
    /// What places are counted from.
    corner: f64,
}

impl<'a> Places<'a> {
    fn new(spline: Spline, knots: &'a [Knot], at: f64, corner: f64) -> Self {
        Self {
            spline,
            knots,
            span: span(spline, knots.len(), |i| knots[i], at),
            at,
            corner,
        }
    }

    /// The boundary at hand and those of [`RUN`] pixels.
    #[inline(always)]
    fn next_run(&mut self, places: &mut [f64; RUN + 1]) {
        let mut done = 0;
        while done <= RUN {
            let at = self.at + done as f64;
            if !self.span.holds(at) {
                self.span = span(self.spline, self.knots.len(), |i| self.knots[i], at);
            }
            // So many for certain.
            let more = (self.span.end - at).clamp(1.0, RUN as f64) as usize;
            let end = (done + more).min(RUN + 1);
            let numbers = self.span.numbers();
            for (i, place) in places[done..end].iter_mut().enumerate() {
                *place = evaluate(numbers, self.at + (done + i) as f64) - self.corner;
            }
            done = end;
        }
        self.at += RUN as f64;
    }
}

#[inline(always)]
fn quick_across<const N: usize>(line: Line<'_>, mut places: Places<'_>, out: &mut [f32]) {
    let (pixels, _) = out.as_chunks_mut::<N>();
    let mut run = [0.0; RUN + 1];
    for pixels in pixels.chunks_mut(RUN) {
        places.next_run(&mut run);
        let (mut from, mut to) = ([0.0; RUN], [0.0; RUN]);
        from.copy_from_slice(&run[..RUN]);
        to.copy_from_slice(&run[1..]);
        resampling::run::<N>(line, 0, &from, &to, pixels);
    }
}

/// The second pass: columns of what the first has drawn become those of the result.
struct Second<'a> {
    across: &'a [f32],
    /// Rows of it.
    rows: usize,
    /// Where they begin, in the image's coordinates.
    top: f64,
    knots: &'a [Knot],
    lines: usize,
    spline: Spline,
    edge: Edge,
    width: usize,
    channels: usize,
}

/// Where each column of pixels is in its function: the span at hand, and where the boundary above comes from.
#[derive(Default)]
struct Cursors {
    ends: Vec<f64>,
    numbers: [Vec<f64>; NUMBERS],
    above: Vec<f64>,
}

impl Cursors {
    fn put(&mut self, column: usize, span: &Span) {
        self.ends[column] = span.end;
        for (list, number) in self.numbers.iter_mut().zip(span.numbers()) {
            list[column] = number;
        }
    }
    fn resize(&mut self, width: usize) {
        for list in self
            .numbers
            .iter_mut()
            .chain([&mut self.ends, &mut self.above])
        {
            list.resize(width, 0.0);
        }
    }
}

impl Second<'_> {
    fn span(&self, column: usize, at: f64) -> Span {
        let knots = &self.knots[column * self.lines..][..self.lines];
        span(self.spline, self.lines, |i| knots[i], at)
    }

    /// The rows of the result from the one that begins at `top` on.
    fn down(&self, top: f64, cursors: &mut Cursors, out: &mut [f32]) {
        cursors.resize(self.width);
        for column in 0..self.width {
            let span = self.span(column, top);
            cursors.put(column, &span);
            cursors.above[column] = span.place(top) - self.top;
        }
        let rows = out.chunks_exact_mut(self.width * self.channels);
        for (row, out) in rows.enumerate() {
            let below = top + (row + 1) as f64;
            for column in 0..self.width {
                if below >= cursors.ends[column] {
                    cursors.put(column, &self.span(column, below));
                }
            }
            with_channels!(self.channels, quick_down(self, below, cursors, out), {
                for (column, pixel) in out.chunks_exact_mut(self.channels).enumerate() {
                    let numbers = std::array::from_fn(|i| cursors.numbers[i][column]);
                    let place = evaluate(numbers, below) - self.top;
                    self.line(column).pixel(cursors.above[column], place, pixel);
                    cursors.above[column] = place;
                }
            });
        }
    }

    #[inline(always)]
    fn line(&self, column: usize) -> Line<'_> {
        Line {
            samples: self.across,
            start: column * self.channels,
            stride: self.width * self.channels,
            count: self.rows,
            edge: self.edge,
        }
    }
}

#[inline(always)]
fn quick_down<const N: usize>(
    pass: &Second<'_>,
    below: f64,
    cursors: &mut Cursors,
    out: &mut [f32],
) {
    let (pixels, _) = out.as_chunks_mut::<N>();
    for (number, pixels) in pixels.chunks_mut(RUN).enumerate() {
        let first = number * RUN;
        let (mut from, mut to) = ([0.0; RUN], [0.0; RUN]);
        let count = pixels.len();
        let numbers: [&[f64]; NUMBERS] =
            std::array::from_fn(|i| &cursors.numbers[i][first..first + count]);
        for (i, place) in to.iter_mut().enumerate().take(count) {
            *place = evaluate(numbers.map(|list| list[i]), below) - pass.top;
        }
        let above = &mut cursors.above[first..first + count];
        from[..count].copy_from_slice(above);
        above.copy_from_slice(&to[..count]);
        resampling::run::<N>(pass.line(first), N, &from, &to, pixels);
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
