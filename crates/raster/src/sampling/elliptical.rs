//! The elliptical weighted average: all that a target pixel covers in the source, from the Jacobian of the inverse map.
//!
//! *Source*: N. Greene and P. S. Heckbert, *Creating raster Omnimax images from multiple perspective views using the
//! elliptical weighted average filter*, IEEE Computer Graphics and Applications 6(6), 1986; P. S. Heckbert,
//! *Fundamentals of Texture Mapping and Image Warping*, 1989, §3.5; the pyramid after L. Williams, SIGGRAPH 1983.
//!
//! A target pixel is a disc of radius 1 whose image under the Jacobian is an ellipse. Its axes are made at least 1 pixel
//! long (so that the ellipse always holds a pixel, and where nothing shrinks the filter interpolates), and the shorter at
//! least 1/8 of the longer. From the level of the pyramid on which the shorter semi-axis is between 1.5 and 3 pixels, the
//! mean is taken with the weight `(1 − r²)²`, `r` from 0 in the middle to 1 on the ellipse: within 4 % of the Gaussian
//! `e^(−2r²)`, cut off, of the sources, without its step at the edge. So a pixel costs at most 3·24·π, about 230
//! samples, however much the image shrinks.

use super::pyramid::Pyramid;
use super::separable::{Grid, split};
use anamorph_core::glam::{DMat2, DVec2, dvec2};

/// The longer axis is at most this many times the shorter: beyond it the picture is blurred across rather than more
/// samples taken. Visible only on planes seen almost edge on.
pub(super) const SLIMMEST: f64 = 8.0;
/// The shorter semi-axis on the level that is read is below this, in pixels of that level. Half of it is left after the step
/// to a level: the level's own squares then make up less than a tenth of the filter's variance.
const WIDEST: f64 = 3.0;

/// What a target pixel covers: the ellipse `dᵀ C⁻¹ d ≤ 1`, by the entries `xx`, `xy`, `yy` of `C`, and the square of its
/// shorter semi-axis.
#[derive(Clone, Copy)]
pub(super) struct Ellipse {
    pub(super) xx: f64,
    pub(super) xy: f64,
    pub(super) yy: f64,
    pub(super) short: f64,
}

impl Ellipse {
    /// The image of the unit disc, widened as the module's documentation says. A Jacobian that is not finite gives the disc.
    ///
    /// `C` is `J·Jᵀ` with other eigenvalues. For two rows and columns a function of a matrix is a multiple of it plus a
    /// multiple of the identity, so that no eigenvector is needed.
    #[inline(always)]
    pub(super) fn new(jacobian: DMat2) -> Self {
        let mut j = jacobian;
        // False for what is not a number.
        let tame = |x: f64| x.abs() < 1e60;
        if !(tame(j.x_axis.x) && tame(j.x_axis.y) && tame(j.y_axis.x) && tame(j.y_axis.y)) {
            j = DMat2::IDENTITY;
        }
        let a = j.x_axis.x * j.x_axis.x + j.y_axis.x * j.y_axis.x;
        let b = j.x_axis.x * j.x_axis.y + j.y_axis.x * j.y_axis.y;
        let c = j.x_axis.y * j.x_axis.y + j.y_axis.y * j.y_axis.y;
        let half = 0.5 * (a - c);
        let spread = (half * half + b * b).sqrt();
        let large = 0.5 * (a + c) + spread;
        let small = large - 2.0 * spread;
        let long = large.max(1.0);
        let short = small.max(1.0).max(long / (SLIMMEST * SLIMMEST));
        // The multiple of `J·Jᵀ`; where its eigenvalues are alike there is none to tell apart.
        let share = if spread > 1e-12 * large {
            (long - short) / (large - small)
        } else {
            0.0
        };
        Self {
            xx: short + share * (a - small),
            xy: share * b,
            yy: short + share * (c - small),
            short,
        }
    }

    /// The ellipse on a raster that is smaller by those factors.
    fn scaled(self, x: f64, y: f64) -> Self {
        Self {
            xx: self.xx * x * x,
            xy: self.xy * x * y,
            yy: self.yy * y * y,
            short: self.short,
        }
    }
}

/// The mean over the ellipse about `at`, from the raster's corner. What is not finite shows as far as the ellipse reaches,
/// on the level that is read.
#[inline(always)]
pub(super) fn filtered(
    base: &Grid<'_>,
    pyramid: &Pyramid,
    at: DVec2,
    ellipse: &Ellipse,
    out: &mut [f32],
) {
    let mut short = ellipse.short;
    let mut number = 0;
    while short >= WIDEST * WIDEST && number < pyramid.levels.len() {
        short *= 0.25;
        number += 1;
    }
    let level = number.checked_sub(1).and_then(|n| pyramid.levels.get(n));
    let Some(level) = level else {
        return mean(base, at, &Quadric::new(*ellipse), out);
    };
    let grid = Grid::new(
        &level.samples,
        level.width,
        level.height,
        base.channels,
        base.edge,
    );
    let scale = dvec2(
        level.width as f64 / base.width as f64,
        level.height as f64 / base.height as f64,
    );
    // Beyond the last level an ellipse may be as large as it likes; there is one pixel to see, and its surroundings.
    let shrink = (WIDEST / short.sqrt()).min(1.0);
    let ellipse = ellipse.scaled(scale.x * shrink, scale.y * shrink);
    mean(&grid, at * scale, &Quadric::new(ellipse), out);
}

/// An ellipse `a·(x − m·y)² + c·y² ≤ 1`.
struct Quadric {
    a: f64,
    m: f64,
    c: f64,
    /// `1/a`.
    width: f64,
    /// How far it reaches up and down.
    reach: f64,
    /// Whether it reaches less than 1½ pixels in all directions.
    small: bool,
}

impl Quadric {
    #[inline(always)]
    fn new(Ellipse { xx, xy, yy, .. }: Ellipse) -> Self {
        let inverse = 1.0 / yy;
        let width = (xx * yy - xy * xy) * inverse;
        Self {
            a: 1.0 / width,
            m: xy * inverse,
            c: inverse,
            width,
            reach: yy.sqrt(),
            small: xx < 2.25 && yy < 2.25,
        }
    }
}

/// The weighted mean of the pixels whose centres the ellipse holds.
#[inline(always)]
fn mean(grid: &Grid<'_>, at: DVec2, quadric: &Quadric, out: &mut [f32]) {
    macro_rules! whole {
        ($($channels:literal)*) => {
            match grid.channels {
                $($channels => {
                    if let Some(out) = out.first_chunk_mut::<$channels>() {
                        *out = channels(grid, at, quadric, 0);
                    }
                })*
                _ => {
                    for (channel, sample) in out.iter_mut().enumerate() {
                        [*sample] = channels::<1>(grid, at, quadric, channel);
                    }
                }
            }
        };
    }
    whole!(1 3 4);
}

/// A sum of weighted samples.
struct Sum<const N: usize> {
    sum: [f32; N],
    total: f32,
    /// A single tap is copied: a weight and its reciprocal need not multiply to 1.
    taps: u32,
    only: [f32; N],
}

impl<const N: usize> Sum<N> {
    /// Adds a tap, or, without a sample, a weight alone.
    #[inline(always)]
    fn add(&mut self, weight: f64, samples: Option<&[f32; N]>) {
        let weight = (weight * weight) as f32;
        self.total += weight;
        self.taps += 1;
        if let Some(samples) = samples {
            self.only = *samples;
            for (sum, sample) in self.sum.iter_mut().zip(samples) {
                *sum += sample * weight;
            }
        }
    }
}

/// The mean over a small ellipse inside the raster, without choices: all nine pixels it may hold, those outside with weight 0.
/// None where that is no answer: with a single tap, and where something is not finite, which weight 0 would not keep out.
#[inline(always)]
fn small<const N: usize>(grid: &Grid<'_>, at: DVec2, quadric: &Quadric) -> Option<[f32; N]> {
    let inside = |x: f64, size: usize| x >= 1.0 && x < size as f64 - 1.0;
    if !quadric.small
        || grid.channels != N
        || !inside(at.x, grid.width)
        || !inside(at.y, grid.height)
    {
        return None;
    }
    // The pixel that the position lies in is the middle one.
    let (column, row) = (at.x as usize - 1, at.y as usize - 1);
    let (x, y) = (column as f64 - (at.x - 0.5), row as f64 - (at.y - 0.5));
    // Four to a row, of which three count: as many as the processor takes at a time.
    let mut weights = [[0.0_f32; 4]; 3];
    for (i, line) in weights.iter_mut().enumerate() {
        let y = y + i as f64;
        let rest = 1.0 - quadric.c * y * y;
        let x = x - quadric.m * y;
        for (j, weight) in line.iter_mut().enumerate() {
            let x = x + j as f64;
            let w = (rest - quadric.a * x * x).max(0.0);
            *weight = (w * w) as f32;
        }
    }
    let mut total = 0.0_f32;
    let mut sum = [0.0_f32; N];
    let (pixels, _) = grid.samples.as_chunks::<N>();
    for (i, line) in weights.iter().enumerate() {
        let start = (row + i) * grid.width + column;
        let taps = pixels.get(start..)?.first_chunk::<3>()?;
        for (weight, samples) in line.iter().zip(taps) {
            total += weight;
            for (sum, sample) in sum.iter_mut().zip(samples) {
                *sum += sample * weight;
            }
        }
    }
    let scale = 1.0 / total;
    let mut probe = 0.0;
    for sum in &mut sum {
        *sum *= scale;
        probe += *sum * 0.0;
    }
    (total > weights[1][1] && probe == 0.0).then_some(sum)
}

/// The mean for `N` channels from `channel` on.
#[inline(always)]
fn channels<const N: usize>(
    grid: &Grid<'_>,
    at: DVec2,
    quadric: &Quadric,
    channel: usize,
) -> [f32; N] {
    if let Some(value) = small(grid, at, quadric) {
        return value;
    }
    let Quadric {
        a,
        m,
        c,
        width,
        reach,
        ..
    } = *quadric;
    let centre = at - 0.5;
    let mut sum = Sum {
        sum: [0.0; N],
        total: 0.0,
        taps: 0,
        only: [0.0; N],
    };
    // The next whole number from `x` on.
    let from = |x: f64| -split(-x).0;
    let (first, last) = (from(centre.y - reach), split(centre.y + reach).0);
    for row in first..=last {
        let y = row as f64 - centre.y;
        let rest = 1.0 - c * y * y;
        if rest <= 0.0 {
            continue;
        }
        let middle = centre.x + m * y;
        let half = (rest * width).sqrt();
        let (left, right) = (from(middle - half), split(middle + half).0);
        let line = grid.edge.pixel(row, grid.height);
        let weight = |column: i64| {
            let x = column as f64 - middle;
            rest - a * x * x
        };
        if let Some(line) = line
            && left >= 0
            && left <= right
            && right < grid.width as i64
            && grid.channels == N
        {
            let range = grid.at(left as usize, line)..grid.at(right as usize + 1, line);
            let (pixels, _) = grid.samples[range].as_chunks::<N>();
            for (column, samples) in (left..).zip(pixels) {
                let weight = weight(column);
                if weight > 0.0 {
                    sum.add(weight, Some(samples));
                }
            }
            continue;
        }
        for column in left..=right {
            let weight = weight(column);
            if weight > 0.0 {
                let pixel = line.zip(grid.edge.pixel(column, grid.width));
                let samples = pixel.and_then(|(line, pixel)| {
                    grid.samples[grid.at(pixel, line) + channel..].first_chunk::<N>()
                });
                sum.add(weight, samples);
            }
        }
    }
    if sum.taps == 1 {
        return sum.only;
    }
    if sum.total > 0.0 {
        let scale = 1.0 / sum.total;
        sum.sum.iter_mut().for_each(|sum| *sum *= scale);
    }
    sum.sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ellipses_are_images_of_the_disc_made_wide_enough() {
        // Squares of the semi-axes, the longer first.
        let axes = |columns: [f64; 4]| {
            let e = Ellipse::new(DMat2::from_cols_array(&columns));
            let spread = (0.25 * (e.xx - e.yy).powi(2) + e.xy * e.xy).sqrt();
            let mean = 0.5 * (e.xx + e.yy);
            assert!((mean - spread - e.short).abs() < 1e-9 * mean);
            (mean + spread, mean - spread)
        };
        assert_eq!(axes([1.0, 0.0, 0.0, 1.0]), (1.0, 1.0));
        let (long, short) = axes([0.0, 5.0, -2.0, 0.0]);
        assert!((long - 25.0).abs() < 1e-12 && (short - 4.0).abs() < 1e-12);
        // A shear: the product of the axes is the determinant, the sum of squares that of the entries.
        let (long, short) = axes([6.0, 1.0, 8.0, 4.0]);
        assert!((long * short - 256.0).abs() < 1e-9 && (long + short - 117.0).abs() < 1e-9);
        for odd in [[f64::NAN; 4], [0.0; 4], [f64::INFINITY, 0.0, 0.0, 1.0]] {
            assert_eq!(axes(odd), (1.0, 1.0));
        }
        let (long, short) = axes([100.0, 0.0, 0.0, 0.01]);
        assert!((long - 1e4).abs() < 1e-8 && (short - 156.25).abs() < 1e-8);
    }
}
