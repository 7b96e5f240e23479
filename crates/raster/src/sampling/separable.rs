//! Nearest pixels and separable filters.

use super::edge::Edge;
use super::filter::{TAPS, Weights};
use anamorph_core::glam::DVec2;
use anamorph_core::simd::{Level, dispatch};

/// Beyond this magnitude every position is a pixel's corner, and counting in whole numbers would overflow.
const FAR: f64 = (1_i64 << 52) as f64;

/// Samples with what stands beyond them.
#[derive(Clone, Copy)]
pub(super) struct Grid<'a> {
    pub(super) samples: &'a [f32],
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) channels: usize,
    pub(super) edge: Edge,
}

impl<'a> Grid<'a> {
    pub(super) fn new(
        samples: &'a [f32],
        width: usize,
        height: usize,
        channels: usize,
        edge: Edge,
    ) -> Self {
        Self {
            samples,
            width,
            height,
            channels,
            edge,
        }
    }

    /// Where the samples of a pixel begin.
    #[inline]
    pub(super) fn at(&self, column: usize, row: usize) -> usize {
        (row * self.width + column) * self.channels
    }
}

/// The whole number at or below, and what is left of 1. Without the library's `floor`, which is a call on plain processors.
#[inline(always)]
pub(super) fn split(x: f64) -> (i64, f64) {
    let x = x.clamp(-FAR, FAR);
    let toward_zero = x as i64;
    let whole = toward_zero - i64::from(toward_zero as f64 > x);
    (whole, x - whole as f64)
}

/// The pixel that `at` (from the raster's corner) lies in.
pub(super) fn nearest(grid: &Grid<'_>, at: DVec2, out: &mut [f32]) {
    let column = grid.edge.pixel(split(at.x).0, grid.width);
    let row = grid.edge.pixel(split(at.y).0, grid.height);
    match (column, row) {
        (Some(column), Some(row)) => {
            let start = grid.at(column, row);
            out.copy_from_slice(&grid.samples[start..start + grid.channels]);
        }
        _ => out.fill(0.0),
    }
}

/// The taps along an axis that have weight and pixels.
struct Axis {
    taps: [(usize, f32); TAPS],
    count: usize,
}

impl Axis {
    /// `x` counts from the first pixel's centre.
    #[inline]
    fn new(x: f64, taps: usize, weights: Weights, size: usize, edge: Edge) -> Self {
        let (whole, t) = split(x);
        let mut list = [0.0; TAPS];
        weights(t, &mut list);
        let first = whole + 1 - (taps / 2) as i64;
        let mut axis = Self {
            taps: [(0, 0.0); TAPS],
            count: 0,
        };
        for (tap, &weight) in list.iter().enumerate().take(taps) {
            let weight = weight as f32;
            if weight != 0.0
                && let Some(pixel) = edge.pixel(first + tap as i64, size)
            {
                axis.taps[axis.count] = (pixel, weight);
                axis.count += 1;
            }
        }
        axis
    }
    fn taps(&self) -> &[(usize, f32)] {
        &self.taps[..self.count]
    }
}

/// A separable filter of `taps` pixels along each axis at `at`, from the raster's corner.
pub(super) fn filtered(grid: &Grid<'_>, at: DVec2, taps: usize, weights: Weights, out: &mut [f32]) {
    let across = Axis::new(at.x - 0.5, taps, weights, grid.width, grid.edge);
    let down = Axis::new(at.y - 0.5, taps, weights, grid.height, grid.edge);
    if let ([(column, 1.0)], [(row, 1.0)]) = (across.taps(), down.taps()) {
        let start = grid.at(*column, *row);
        out.copy_from_slice(&grid.samples[start..start + grid.channels]);
        return;
    }
    let mut channel = 0;
    let (fours, rest) = out.as_chunks_mut::<4>();
    for four in fours {
        *four = sum(grid, &across, &down, channel);
        channel += 4;
    }
    for one in rest {
        [*one] = sum(grid, &across, &down, channel);
        channel += 1;
    }
}

/// The weighted sum for `N` channels from `channel` on.
#[inline]
fn sum<const N: usize>(grid: &Grid<'_>, across: &Axis, down: &Axis, channel: usize) -> [f32; N] {
    let mut total = [0.0_f32; N];
    for &(row, row_weight) in down.taps() {
        let mut line = [0.0_f32; N];
        for &(column, weight) in across.taps() {
            let start = grid.at(column, row) + channel;
            if let Some(pixel) = grid.samples[start..].first_chunk::<N>() {
                for (sum, sample) in line.iter_mut().zip(pixel) {
                    *sum += sample * weight;
                }
            }
        }
        for (sum, line) in total.iter_mut().zip(line) {
            *sum += line * row_weight;
        }
    }
    total
}

/// The quick way for whole rows, with the number of taps and channels known to the compiler: positions whose taps are all
/// inside the raster and have weight. The others are left to `slow`, which is given the position.
///
/// `first` is the first target pixel's centre from the source's corner: a whole number and a half. What is left of an offset
/// above the next whole number is then what is left of the position, and is exact in `f32`; operations and their order are
/// otherwise those of [`filtered`].
pub(super) fn row<const T: usize, const N: usize>(
    grid: &Grid<'_>,
    weights: impl Fn(f32) -> [f32; T],
    first: DVec2,
    offsets: &[[f32; 2]],
    out: &mut [f32],
    slow: impl Fn(DVec2, &mut [f32]),
) {
    let (pixels, _) = out.as_chunks_mut::<N>();
    // Whole numbers of the quick way have 32 bits.
    let few = |size: usize| size < 1 << 29;
    let near = first.abs().max_element() < f64::from(1 << 29);
    if !(near && few(grid.samples.len()) && few(offsets.len())) {
        for (i, (pixel, offset)) in pixels.iter_mut().zip(offsets).enumerate() {
            slow(at(first, i, offset), pixel);
        }
        return;
    }
    // With the processor's widest vectors; their operations are the same as without.
    dispatch!(Level::new(), _v => runs::<T, N>(grid, weights, first, offsets, pixels, slow));
}

/// Where the pixel with that number comes from.
fn at(first: DVec2, number: usize, offset: &[f32; 2]) -> DVec2 {
    let [u, v] = offset.map(f64::from);
    DVec2::new(first.x + number as f64 + u, first.y + v)
}

/// Pixels whose places are found together.
const RUN: usize = 64;
/// Positions nearer than this to a pixel's column or row go the slow way, which knows weights of 0.
const NEAR: f32 = 1.0 / (1 << 20) as f32;
/// Beyond this offsets are whole numbers.
const WIDE: f32 = (1 << 24) as f32;

#[inline(always)]
fn runs<const T: usize, const N: usize>(
    grid: &Grid<'_>,
    weights: impl Fn(f32) -> [f32; T],
    first: DVec2,
    offsets: &[[f32; 2]],
    pixels: &mut [[f32; N]],
    slow: impl Fn(DVec2, &mut [f32]),
) {
    let (samples, _) = grid.samples.as_chunks::<N>();
    let before = T as i32 / 2 - 1;
    let (width, height) = (grid.width as i32, grid.height as i32);
    // The first tap of a pixel that does not move, and the largest that a first tap may be.
    let (left, top) = (
        first.x.floor() as i32 - before,
        first.y.floor() as i32 - before,
    );
    let (most_x, most_y) = (width - T as i32, height - T as i32);
    // First tap or −1, and what is left across and down.
    let (mut from, mut across, mut down) = ([0_i32; RUN], [0.0_f32; RUN], [0.0_f32; RUN]);
    let runs = pixels.chunks_mut(RUN).zip(offsets.chunks(RUN));
    for (number, (pixels, offsets)) in runs.enumerate() {
        let start = number * RUN;
        let left = left + start as i32;
        // A fixed number and no branches, so that the compiler takes many at a time.
        let mut run = [[0.0_f32; 2]; RUN];
        run[..offsets.len()].copy_from_slice(offsets);
        for i in 0..RUN {
            // Wide offsets become whole numbers, which go the slow way like all that are not between pixels.
            let [u, v] = run[i].map(|offset| offset.clamp(-WIDE, WIDE));
            let (whole_u, whole_v) = (u.floor(), v.floor());
            let (s, t) = (u - whole_u, v - whole_v);
            let between = |t: f32| (NEAR..=1.0 - NEAR).contains(&t);
            let x = left + i as i32 + whole_u as i32;
            let y = top + whole_v as i32;
            let inside = (x >= 0) & (x <= most_x) & (y >= 0) & (y <= most_y);
            let place = y.wrapping_mul(width).wrapping_add(x);
            let usable = inside & between(s) & between(t);
            from[i] = if usable { place } else { -1 };
            (across[i], down[i]) = (s, t);
        }
        let places = from.iter().zip(&across).zip(&down);
        let pixels = pixels.iter_mut().zip(offsets).zip(places).enumerate();
        for (i, ((pixel, offset), ((&from, &across), &down))) in pixels {
            if let Ok(from) = usize::try_from(from) {
                let (across, down) = (weights(across), weights(down));
                // The two weights of a line are not 0 between pixels.
                let all = T == 2 || across.iter().chain(&down).all(|&w| w != 0.0);
                if all && let Some(value) = block(samples, from, grid.width, &across, &down) {
                    *pixel = value;
                    continue;
                }
            }
            slow(at(first, start + i, offset), pixel);
        }
    }
}

/// The weighted sum of `T × T` pixels from `start` on.
#[inline(always)]
fn block<const T: usize, const N: usize>(
    pixels: &[[f32; N]],
    start: usize,
    width: usize,
    across: &[f32; T],
    down: &[f32; T],
) -> Option<[f32; N]> {
    let mut total = [0.0_f32; N];
    for (row, down) in down.iter().enumerate() {
        let taps = pixels.get(start + row * width..)?.first_chunk::<T>()?;
        let mut line = [0.0_f32; N];
        for (tap, across) in taps.iter().zip(across) {
            for (sum, sample) in line.iter_mut().zip(tap) {
                *sum += sample * across;
            }
        }
        for (sum, line) in total.iter_mut().zip(line) {
            *sum += line * down;
        }
    }
    Some(total)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splitting_is_flooring() {
        for x in [
            0.0,
            -0.0,
            0.25,
            -0.25,
            3.0,
            -3.0,
            1e15 + 0.5,
            -1e15 - 0.5,
            -1e-300,
        ] {
            let (whole, t) = split(x);
            assert_eq!(whole as f64, f64::floor(x), "{x}");
            assert!((0.0..=1.0).contains(&t), "{x} {t}");
        }
        for x in [1e300, -1e300] {
            let (whole, t) = split(x);
            assert_eq!(t, 0.0);
            assert_eq!(whole as f64, FAR.copysign(x));
        }
    }
}
