//! Edge strength: how steep the luminance is, smoothed by a Gaussian, and which way it grows.
//!
//! *Source*: J. Canny, *A Computational Approach to Edge Detection*, IEEE Transactions on PAMI 8(6), 1986 (the gradient of the smoothed
//! image, its largest values across an edge).

use super::TOGETHER;
use super::curve::Curve;
use crate::{Raster, RasterError, Window, parallel};
use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::math;

/// The Gaussian is cut off at so many standard deviations, where it is 1/2981 of its middle.
const CUT: f64 = 4.0;
/// An edge weaker than this share of the strongest in sight of the curve at all is none worth following.
const WEAKEST: f64 = 0.02;
/// Steepness below this share of the largest luminance is rounding.
const ROUNDING: f64 = 1e-6;

/// Edge strength around a curve on one scale.
pub(super) struct Edges {
    /// Left and top of the part of the image that is looked at.
    corner: DVec2,
    width: usize,
    height: usize,
    strength: Vec<f32>,
    /// The derivatives of the strength.
    slopes: Vec<[f32; 2]>,
    largest: f64,
}

/// The part of a window that a curve can get to see.
fn part(window: Window, points: &[DVec2], margin: f64) -> (usize, usize, usize, usize) {
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for point in points {
        let local = *point - window.corner();
        (low, high) = (low.min(local), high.max(local));
    }
    let (low, high) = ((low - margin).floor(), (high + margin).ceil());
    let cut = |at: f64, size: usize| (at.max(0.0) as usize).min(size);
    let left = cut(low.x, window.width() - 1);
    let top = cut(low.y, window.height() - 1);
    let right = cut(high.x, window.width()).max(left + 1);
    let bottom = cut(high.y, window.height()).max(top + 1);
    (left, top, right - left, bottom - top)
}

/// The luminance of a part of an image. What is not finite counts as the pixel before it in the row.
fn luminance(
    image: &Raster,
    weights: &[f64],
    (left, top, width, height): (usize, usize, usize, usize),
) -> Result<Vec<f32>, RasterError> {
    let mut values = Window::new(0, 0, width, height)?.room(1, 0.0_f32)?;
    let channels = image.channels();
    parallel::chunks(&mut values, width, |row, out| {
        let start = ((top + row) * image.width() + left) * channels;
        let line = &image.samples()[start..start + width * channels];
        let mut last = 0.0;
        for (value, pixel) in out.iter_mut().zip(line.chunks_exact(channels)) {
            let counted = pixel
                .iter()
                .zip(weights)
                .filter(|(_, weight)| **weight != 0.0);
            let sum: f64 = counted.map(|(&s, &w)| f64::from(s) * w).sum();
            let sum = sum as f32;
            if sum.is_finite() {
                last = sum;
            }
            *value = last;
        }
    });
    Ok(values)
}

/// Weights of a Gaussian from its middle on, which sum to 1 over both sides.
fn gaussian(sigma: f64) -> Vec<f32> {
    let reach = (CUT * sigma).ceil() as usize;
    let weight = |i: usize| math::exp(-0.5 * (i as f64 / sigma) * (i as f64 / sigma));
    let whole = 1.0 + 2.0 * (1..=reach).map(weight).sum::<f64>();
    (0..=reach).map(|i| (weight(i) / whole) as f32).collect()
}

/// Smooths rows across, and then down; the outermost pixels go on.
fn smoothed(values: &mut Vec<f32>, width: usize, height: usize, sigma: f64) {
    let weights = gaussian(sigma);
    let mut across = vec![0.0_f32; values.len()];
    let source = &*values;
    parallel::chunks(&mut across, width, |row, out| {
        let line = &source[row * width..(row + 1) * width];
        let reach = weights.len() - 1;
        let mut padded = Vec::with_capacity(width + 2 * reach);
        padded.extend(std::iter::repeat_n(line[0], reach));
        padded.extend_from_slice(line);
        padded.extend(std::iter::repeat_n(line[width - 1], reach));
        for (sum, value) in out.iter_mut().zip(line) {
            *sum = weights[0] * value;
        }
        for (step, weight) in weights.iter().enumerate().skip(1) {
            let (before, after) = (&padded[reach - step..], &padded[reach + step..]);
            for ((sum, a), b) in out.iter_mut().zip(before).zip(after) {
                *sum += weight * (a + b);
            }
        }
    });
    let source = &across;
    parallel::chunks(values, width, |row, out| {
        let line = |row: usize| &source[row * width..(row + 1) * width];
        for (sum, value) in out.iter_mut().zip(line(row)) {
            *sum = weights[0] * value;
        }
        for (step, weight) in weights.iter().enumerate().skip(1) {
            let above = line(row.saturating_sub(step));
            let below = line((row + step).min(height - 1));
            for ((sum, a), b) in out.iter_mut().zip(above).zip(below) {
                *sum += weight * (a + b);
            }
        }
    });
}

/// The derivatives across and down by central differences; one-sided at the rim.
fn derivatives(values: &[f32], width: usize, height: usize) -> Vec<[f32; 2]> {
    let mut slopes = vec![[0.0_f32; 2]; values.len()];
    parallel::chunks(&mut slopes, width, |row, out| {
        let line = |row: usize| &values[row * width..(row + 1) * width];
        let (above, below) = (row.saturating_sub(1), (row + 1).min(height - 1));
        let down = 1.0 / (below - above).max(1) as f32;
        let (here, above, below) = (line(row), line(above), line(below));
        for (column, slope) in out.iter_mut().enumerate() {
            let (left, right) = (column.saturating_sub(1), (column + 1).min(width - 1));
            let across = 1.0 / (right - left).max(1) as f32;
            *slope = [
                (here[right] - here[left]) * across,
                (below[column] - above[column]) * down,
            ];
        }
    });
    slopes
}

impl Edges {
    /// Around a curve that begins at `points`, smoothed by `sigma`, as far as it can get when it begins on the scale `coarsest`.
    pub(super) fn new(
        image: &Raster,
        weights: &[f64],
        points: &[DVec2],
        sigma: f64,
        coarsest: f64,
    ) -> Result<Self, RasterError> {
        let window = image.window();
        let margin = (CUT + 6.0) * coarsest.max(2.0);
        let (left, top, width, height) = part(window, points, margin);
        let mut values = luminance(image, weights, (left, top, width, height))?;
        let brightest = values.iter().fold(0.0_f32, |most, v| most.max(v.abs()));
        smoothed(&mut values, width, height, sigma);
        let slopes = derivatives(&values, width, height);
        let strength: Vec<f32> = slopes.iter().map(|[x, y]| (x * x + y * y).sqrt()).collect();
        let largest = f64::from(strength.iter().fold(0.0_f32, |most, &s| most.max(s)));
        let steep = largest > ROUNDING * f64::from(brightest);
        Ok(Self {
            corner: window.corner() + dvec2(left as f64, top as f64),
            width,
            height,
            slopes: derivatives(&strength, width, height),
            strength,
            largest: if steep { largest } else { 0.0 },
        })
    }

    /// The nearest place in the part that is looked at.
    pub(super) fn within(&self, p: DVec2) -> DVec2 {
        let size = dvec2(self.width as f64, self.height as f64);
        p.clamp(self.corner, self.corner + size)
    }

    /// The four pixels about a place and their shares.
    fn about(&self, p: DVec2) -> [(usize, f64); 4] {
        let most = dvec2(self.width as f64 - 1.0, self.height as f64 - 1.0);
        let at = (p - self.corner - 0.5).clamp(DVec2::ZERO, most);
        let (column, row) = (at.x as usize, at.y as usize);
        let (s, t) = (at.x - column as f64, at.y - row as f64);
        let (right, below) = (
            (column + 1).min(self.width - 1),
            (row + 1).min(self.height - 1),
        );
        let place = |column: usize, row: usize| row * self.width + column;
        [
            (place(column, row), (1.0 - s) * (1.0 - t)),
            (place(right, row), s * (1.0 - t)),
            (place(column, below), (1.0 - s) * t),
            (place(right, below), s * t),
        ]
    }

    /// The edge strength at a place: change of luminance for each pixel.
    pub(super) fn strength(&self, p: DVec2) -> f64 {
        let four = self.about(p).map(|(i, w)| f64::from(self.strength[i]) * w);
        four.iter().sum()
    }

    /// Where the strength grows, and how fast.
    pub(super) fn slope(&self, p: DVec2) -> DVec2 {
        self.about(p).iter().fold(DVec2::ZERO, |sum, &(i, w)| {
            let [x, y] = self.slopes[i];
            sum + dvec2(f64::from(x), f64::from(y)) * w
        })
    }

    /// The strongest edge that the curve sees, `reach` pixels to either side; 0 where there is none at all.
    pub(super) fn reference(&self, curve: &Curve, reach: f64) -> f64 {
        const LOOKS: i32 = 8;
        let mut seen = vec![0.0_f64; curve.points.len()];
        parallel::chunks(&mut seen, TOGETHER, |run, seen| {
            for (i, most) in (run * TOGETHER..).zip(seen) {
                let (normal, point) = (curve.normal(i), curve.points[i]);
                for look in -LOOKS..=LOOKS {
                    let aside = normal * (reach * f64::from(look) / f64::from(LOOKS));
                    *most = most.max(self.strength(point + aside));
                }
            }
        });
        let most = seen.into_iter().fold(WEAKEST * self.largest, f64::max);
        if self.largest > 0.0 { most } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_strongest_where_it_is() {
        let window = Window::new(-7, 3, 50, 30).unwrap();
        let mut image = Raster::new(window, 2).unwrap();
        for row in 0..30 {
            for column in 0..50 {
                // The border between columns 24 and 25, at x = 18; the other channel does not count.
                let light = if column >= 25 { 2.0 } else { 0.5 };
                image
                    .pixel_mut(column, row)
                    .copy_from_slice(&[light, row as f32]);
            }
        }
        image.pixel_mut(30, 10)[0] = f32::NAN;
        let centre = [dvec2(18.0, 15.0)];
        for sigma in [0.7, 1.0, 2.5] {
            let edges = Edges::new(&image, &[1.0, 0.0], &centre, sigma, 4.0).unwrap();
            let at = |x: f64| edges.strength(dvec2(x, 15.3));
            // Central differences and reading between pixels widen the Gaussian, by a third and a quarter of a pixel squared.
            let wide = (sigma * sigma + 1.0 / 3.0 + 0.25).sqrt();
            let peak = 1.5 / (wide * (2.0 * std::f64::consts::PI).sqrt());
            assert!(
                (at(18.0) / peak - 1.0).abs() < 0.15,
                "{sigma}: {} {peak}",
                at(18.0)
            );
            assert!(at(17.0) < at(18.0) && at(19.0) < at(18.0));
            let slope = |x: f64| edges.slope(dvec2(x, 15.0));
            assert!(slope(17.2).x > 0.0 && slope(18.8).x < 0.0 && slope(18.0).x.abs() < 1e-6);
            assert!(slope(17.2).y.abs() < 1e-6);
        }
    }

    #[test]
    fn gaussians_sum_to_one() {
        for sigma in [0.5, 1.3, 20.0] {
            let weights = gaussian(sigma);
            let sum = f64::from(weights[0])
                + 2.0 * weights[1..].iter().map(|&w| f64::from(w)).sum::<f64>();
            assert!((sum - 1.0).abs() < 1e-5, "{sigma}");
        }
    }
}
