//! Nearest pixels and separable filters.

use super::edge::Edge;
use super::filter::{TAPS, Weights};
use anamorph_core::glam::DVec2;
use anamorph_core::simd::{
    Level, Simd, dispatch,
    fearless_simd::{f32x4, f32x8, i32x8},
    prelude::*,
};

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
    dispatch!(Level::new(), v => runs::<_, T, N>(v, grid, weights, first, offsets, pixels, slow));
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
fn runs<V: Simd, const T: usize, const N: usize>(
    v: V,
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
    let (number, whole) = (|x: f32| f32x8::splat(v, x), |x: i32| i32x8::splat(v, x));
    let (none, zero) = (whole(-1), whole(0));
    let (most_x, most_y) = (whole(width - T as i32), whole(height - T as i32));
    let (near, far) = (number(NEAR), number(1.0 - NEAR));
    let ahead = i32x8::from_fn(v, |lane| lane as i32);
    // First tap or −1, and what is left across and down.
    let (mut from, mut across, mut down) = ([0_i32; RUN], [0.0_f32; RUN], [0.0_f32; RUN]);
    let (mut us, mut vs) = ([0.0_f32; RUN], [0.0_f32; RUN]);
    let runs = pixels.chunks_mut(RUN).zip(offsets.chunks(RUN));
    for (number_of_run, (pixels, offsets)) in runs.enumerate() {
        let start = number_of_run * RUN;
        for ((u, v), offset) in us.iter_mut().zip(&mut vs).zip(offsets) {
            [*u, *v] = *offset;
        }
        let mut all = true;
        for at in (0..RUN).step_by(8) {
            // Wide offsets become whole numbers, which go the slow way like all that are not between pixels.
            let wide = |from: &[f32]| {
                let offset = f32x8::from_slice(v, from);
                offset.max(number(-WIDE)).min(number(WIDE))
            };
            let (u, w) = (wide(&us[at..at + 8]), wide(&vs[at..at + 8]));
            let (floor_u, floor_w) = (u.floor(), w.floor());
            let (s, t) = (u - floor_u, w - floor_w);
            let x = i32x8::truncate_from(floor_u) + whole(left + (start + at) as i32) + ahead;
            let y = i32x8::truncate_from(floor_w) + whole(top);
            let inside = x.simd_ge(zero) & x.simd_le(most_x) & y.simd_ge(zero) & y.simd_le(most_y);
            let between = s.simd_ge(near) & s.simd_le(far) & t.simd_ge(near) & t.simd_le(far);
            let place = (inside & between).select(y * whole(width) + x, none);
            place.store_slice(&mut from[at..at + 8]);
            s.store_slice(&mut across[at..at + 8]);
            t.store_slice(&mut down[at..at + 8]);
        }
        let places = from.iter().zip(&across).zip(&down);
        for (pixel, ((&from, &across), &down)) in pixels.iter_mut().zip(places) {
            let Ok(from) = usize::try_from(from) else {
                all = false;
                continue;
            };
            let (across, down) = (weights(across), weights(down));
            if let Some(value) = block(v, samples, from, grid.width, &across, &down) {
                *pixel = value;
            }
            // The two weights of a line are not 0 between pixels.
            all &= T == 2 || across.iter().chain(&down).all(|&w| w != 0.0);
        }
        if all {
            continue;
        }
        let rest = pixels.iter_mut().zip(offsets).zip(&from).enumerate();
        for (i, ((pixel, offset), &from)) in rest {
            let weightless = || {
                let (across, down) = (weights(across[i]), weights(down[i]));
                T != 2 && across.iter().chain(&down).any(|&w| w == 0.0)
            };
            if from < 0 || weightless() {
                slow(at(first, start + i, offset), pixel);
            }
        }
    }
}

/// The weighted sum of `T × T` pixels from `start` on.
#[inline(always)]
fn block<V: Simd, const T: usize, const N: usize>(
    v: V,
    pixels: &[[f32; N]],
    start: usize,
    width: usize,
    across: &[f32; T],
    down: &[f32; T],
) -> Option<[f32; N]> {
    if N == 4 {
        // Four channels are a vector.
        let mut total = f32x4::splat(v, 0.0);
        for (row, down) in down.iter().enumerate() {
            let taps = pixels.get(start + row * width..)?.first_chunk::<T>()?;
            let mut line = f32x4::splat(v, 0.0);
            for (tap, across) in taps.iter().zip(across) {
                line += f32x4::from_slice(v, tap) * f32x4::splat(v, *across);
            }
            total += line * f32x4::splat(v, *down);
        }
        let mut out = [0.0; N];
        total.store_slice(&mut out);
        return Some(out);
    }
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
