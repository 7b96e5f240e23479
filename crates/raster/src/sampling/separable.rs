//! Nearest pixels and separable filters.

use super::edge::Edge;
use super::filter::{TAPS, Weights};
use crate::Raster;
use anamorph_core::glam::DVec2;

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

/// Rasters of four channels, for the quick way through the bilinear filter.
pub(super) struct Quads<'a> {
    pixels: &'a [[f32; 4]],
    width: usize,
    /// Positions from the first pixel's centre below these have all four pixels.
    inside: DVec2,
}

impl<'a> Quads<'a> {
    pub(super) fn new(raster: &'a Raster) -> Self {
        let (width, height) = (raster.width(), raster.height());
        Self {
            pixels: raster.samples().as_chunks::<4>().0,
            width,
            inside: DVec2::new(width as f64 - 1.0, height as f64 - 1.0),
        }
    }

    /// As [`filtered`], for positions strictly between four pixels; none elsewhere.
    #[inline(always)]
    pub(super) fn bilinear(&self, at: DVec2) -> Option<[f32; 4]> {
        let (x, y) = (at.x - 0.5, at.y - 0.5);
        if !(x > 0.0 && y > 0.0 && x < self.inside.x && y < self.inside.y) {
            return None;
        }
        // The width fits 32 bits wherever the samples of a row fit the memory of most machines; where not, the slow way.
        let (column, row) = (x as i32, y as i32);
        let (tx, ty) = ((x - f64::from(column)) as f32, (y - f64::from(row)) as f32);
        if tx == 0.0 || ty == 0.0 || tx >= 1.0 || ty >= 1.0 {
            return None;
        }
        let start = row as usize * self.width + column as usize;
        let upper = self.pixels.get(start..start + 2)?;
        let lower = self
            .pixels
            .get(start + self.width..start + self.width + 2)?;
        let (sx, sy) = (
            (1.0 - (x - f64::from(column))) as f32,
            (1.0 - (y - f64::from(row))) as f32,
        );
        let mut value = [0.0_f32; 4];
        for (channel, value) in value.iter_mut().enumerate() {
            let above = upper[0][channel] * sx + upper[1][channel] * tx;
            let below = lower[0][channel] * sx + lower[1][channel] * tx;
            *value = above * sy + below * ty;
        }
        Some(value)
    }
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
