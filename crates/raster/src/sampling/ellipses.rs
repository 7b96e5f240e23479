//! The elliptical filter for whole rows, eight pixels at a time: ellipses, and the weights of those that hold no more than nine pixels.
//!
//! The operations are those of the filter for one pixel, in the same order. What it would not do with nine pixels (wide ellipses, the
//! raster's rim, what is not finite) is left to it.
//!
//! *Source*: as of the filter; the arrangement is a decision.

use super::elliptical::{Ellipse, SLIMMEST};
use super::separable::Grid;
use anamorph_core::glam::{DMat2, DVec2, dvec2};
use anamorph_core::simd::{
    LANES, Level, Simd, dispatch,
    fearless_simd::{f32x4, f64x8, mask64x8},
    prelude::*,
    splat,
};

/// The offsets of the rows above and below a row of a map, the row itself where there is none, and how many rows lie between them.
pub(crate) struct Around<'a> {
    pub(crate) above: &'a [[f32; 2]],
    pub(crate) below: &'a [[f32; 2]],
    pub(crate) steps: usize,
}

/// The difference of two offsets, `steps` pixels apart, for one pixel.
#[inline(always)]
fn slope(from: [f32; 2], to: [f32; 2], steps: usize) -> [f64; 2] {
    let share = if steps == 2 { 0.5 } else { 1.0 };
    [0, 1].map(|axis| (f64::from(to[axis]) - f64::from(from[axis])) * share)
}

impl Around<'_> {
    /// The derivative of the source position by the target position in a column of the row `here`, from the neighbours that
    /// there are, less the identity: across and down.
    #[inline(always)]
    fn slopes(&self, column: usize, here: &[[f32; 2]]) -> [[f64; 2]; 2] {
        let (left, right) = (column.saturating_sub(1), (column + 1).min(here.len() - 1));
        [
            slope(here[left], here[right], right - left),
            slope(self.above[column], self.below[column], self.steps),
        ]
    }

    /// The derivative itself.
    #[inline(always)]
    pub(super) fn jacobian(&self, column: usize, here: &[[f32; 2]]) -> DMat2 {
        if self.above.is_empty() {
            return DMat2::IDENTITY;
        }
        let [[a, b], [c, d]] = self.slopes(column, here);
        DMat2::from_cols(dvec2(1.0 + a, b), dvec2(c, 1.0 + d))
    }
}

/// Ellipses of eight pixels: `xx`, `xy`, `yy` and `short`; see [`Ellipse::new`].
#[inline(always)]
fn ellipses<V: Simd>(v: V, [ax, ay, bx, by]: [f64x8<V>; 4]) -> [f64x8<V>; 4] {
    let number = |x: f64| splat(v, x);
    let (one, zero) = (number(1.0), number(0.0));
    let tame = |x: f64x8<V>| x.abs().simd_lt(number(1e60));
    let all: mask64x8<V> = tame(ax) & tame(ay) & tame(bx) & tame(by);
    let (ax, ay) = (all.select(ax, one), all.select(ay, zero));
    let (bx, by) = (all.select(bx, zero), all.select(by, one));
    let a = ax * ax + bx * bx;
    let b = ax * ay + bx * by;
    let c = ay * ay + by * by;
    let half = number(0.5) * (a - c);
    let spread = (half * half + b * b).sqrt();
    let large = number(0.5) * (a + c) + spread;
    let small = large - number(2.0) * spread;
    let long = large.max(one);
    let short = small.max(one).max(long / number(SLIMMEST * SLIMMEST));
    let apart = spread.simd_gt(number(1e-12) * large);
    let share = apart.select((long - short) / (large - small), zero);
    [
        short + share * (a - small),
        share * b,
        short + share * (c - small),
        short,
    ]
}

/// Pixels that are prepared together.
const RUN: usize = 64;

/// What is known of a run of pixels before a sample is read.
struct Run {
    /// Where the middle pixel is, less one in both directions; −1 where nine pixels are not the answer.
    from: [i64; RUN],
    /// Weights of the nine pixels, row by row.
    weights: [[f32; RUN]; 9],
    /// Their sums, and one over that.
    total: [f32; RUN],
    scale: [f32; RUN],
    /// The ellipses: `xx`, `xy`, `yy`, `short`.
    ellipses: [[f64; RUN]; 4],
}

/// Fills a row of pixels; see [`Sampler::row`](super::Sampler). Those that are no mean of nine pixels are left to `slow`.
pub(super) fn row<const N: usize>(
    grid: &Grid<'_>,
    first: DVec2,
    offsets: &[[f32; 2]],
    around: &Around<'_>,
    out: &mut [f32],
    slow: impl Fn(DVec2, &Ellipse, &mut [f32]),
) {
    let (pixels, _) = out.as_chunks_mut::<N>();
    dispatch!(Level::new(), v => runs::<_, N>(v, grid, first, offsets, around, pixels, slow));
}

#[inline(always)]
fn runs<V: Simd, const N: usize>(
    v: V,
    grid: &Grid<'_>,
    first: DVec2,
    offsets: &[[f32; 2]],
    around: &Around<'_>,
    pixels: &mut [[f32; N]],
    slow: impl Fn(DVec2, &Ellipse, &mut [f32]),
) {
    let mut run = Run {
        from: [0; RUN],
        weights: [[0.0; RUN]; 9],
        total: [0.0; RUN],
        scale: [0.0; RUN],
        ellipses: [[0.0; RUN]; 4],
    };
    let (samples, _) = grid.samples.as_chunks::<N>();
    // Source positions, and the four entries of the derivatives less the identity.
    let (mut xs, mut ys, mut slopes) = ([0.0; RUN], [0.0; RUN], [[0.0; RUN]; 4]);
    for (number, pixels) in pixels.chunks_mut(RUN).enumerate() {
        let start = number * RUN;
        let count = pixels.len();
        for (i, (x, y)) in xs.iter_mut().zip(&mut ys).enumerate().take(count) {
            let column = start + i;
            let [u, w] = offsets[column];
            *x = first.x + column as f64 + f64::from(u);
            *y = first.y + f64::from(w);
            let [[a, b], [c, d]] = around.slopes(column, offsets);
            (slopes[0][i], slopes[1][i]) = (a, b);
            (slopes[2][i], slopes[3][i]) = (c, d);
        }
        for at in (0..count).step_by(LANES) {
            prepare(v, grid, &xs, &ys, &slopes, at, &mut run);
        }
        for (i, pixel) in pixels.iter_mut().enumerate() {
            let near = usize::try_from(run.from[i]).ok();
            let value = near.and_then(|from| nine(v, samples, from, grid.width, &run, i));
            match value {
                Some(value) => *pixel = value,
                None => {
                    let [xx, xy, yy, short] = [0, 1, 2, 3].map(|k: usize| run.ellipses[k][i]);
                    let ellipse = Ellipse { xx, xy, yy, short };
                    slow(dvec2(xs[i], ys[i]), &ellipse, pixel);
                }
            }
        }
    }
}

/// Prepares eight pixels of a run from `at` on.
#[inline(always)]
fn prepare<V: Simd>(
    v: V,
    grid: &Grid<'_>,
    xs: &[f64; RUN],
    ys: &[f64; RUN],
    slopes: &[[f64; RUN]; 4],
    at: usize,
    run: &mut Run,
) {
    let number = |x: f64| splat(v, x);
    let read = |from: &[f64; RUN]| f64x8::from_slice(v, &from[at..at + LANES]);
    let (zero, one) = (number(0.0), number(1.0));
    let [ax, ay] = [one + read(&slopes[0]), read(&slopes[1])];
    let [bx, by] = [read(&slopes[2]), one + read(&slopes[3])];
    let ellipse = ellipses(v, [ax, ay, bx, by]);
    for (kept, part) in run.ellipses.iter_mut().zip(&ellipse) {
        part.store_slice(&mut kept[at..at + LANES]);
    }
    let [xx, xy, yy, _] = ellipse;
    let inverse = one / yy;
    let width = (xx * yy - xy * xy) * inverse;
    let (a, m, c) = (one / width, xy * inverse, inverse);

    let (x, y) = (read(xs), read(ys));
    let small = xx.simd_lt(number(2.25)) & yy.simd_lt(number(2.25));
    let (right, bottom) = (grid.width as f64 - 1.0, grid.height as f64 - 1.0);
    let inside =
        x.simd_ge(one) & x.simd_lt(number(right)) & y.simd_ge(one) & y.simd_lt(number(bottom));
    let usable = small & inside;
    // The pixel that the position lies in is the middle one.
    let (column, row) = (x.floor() - one, y.floor() - one);
    let place = usable.select(row * number(grid.width as f64) + column, number(-1.0));
    let places: [f64; LANES] = place.into();
    for (from, place) in run.from[at..at + LANES].iter_mut().zip(places) {
        *from = place as i64;
    }
    let (x, y) = (column - (x - number(0.5)), row - (y - number(0.5)));
    let mut total = [0.0_f32; LANES];
    for i in 0..3 {
        let y = y + number(i as f64);
        let rest = one - c * y * y;
        let x = x - m * y;
        for j in 0..3 {
            let x = x + number(j as f64);
            let w = (rest - a * x * x).max(zero);
            let squares: [f64; LANES] = (w * w).into();
            let kept = &mut run.weights[3 * i + j][at..at + LANES];
            for ((kept, total), square) in kept.iter_mut().zip(&mut total).zip(squares) {
                *kept = square as f32;
                *total += *kept;
            }
        }
    }
    run.total[at..at + LANES].copy_from_slice(&total);
    for (scale, total) in run.scale[at..at + LANES].iter_mut().zip(total) {
        *scale = 1.0 / total;
    }
}

/// The mean of nine pixels; none where it is a single one, or not finite.
#[inline(always)]
fn nine<V: Simd, const N: usize>(
    v: V,
    pixels: &[[f32; N]],
    start: usize,
    width: usize,
    run: &Run,
    i: usize,
) -> Option<[f32; N]> {
    let alone = run.total[i] <= run.weights[4][i];
    if N == 4 {
        // Four channels are a vector.
        let mut sum = f32x4::splat(v, 0.0);
        for row in 0..3 {
            let taps = pixels.get(start + row * width..)?.first_chunk::<3>()?;
            for (column, tap) in taps.iter().enumerate() {
                let weight = f32x4::splat(v, run.weights[3 * row + column][i]);
                sum += f32x4::from_slice(v, tap) * weight;
            }
        }
        sum *= f32x4::splat(v, run.scale[i]);
        let zero = f32x4::splat(v, 0.0);
        let finite = (sum * zero).simd_eq(zero).all_true();
        let mut out = [0.0; N];
        sum.store_slice(&mut out);
        return (finite && !alone).then_some(out);
    }
    let mut sum = [0.0_f32; N];
    for row in 0..3 {
        let taps = pixels.get(start + row * width..)?.first_chunk::<3>()?;
        for (column, tap) in taps.iter().enumerate() {
            let weight = run.weights[3 * row + column][i];
            for (sum, sample) in sum.iter_mut().zip(tap) {
                *sum += sample * weight;
            }
        }
    }
    let mut probe = 0.0;
    for sum in &mut sum {
        *sum *= run.scale[i];
        probe += *sum * 0.0;
    }
    (probe == 0.0 && !alone).then_some(sum)
}
