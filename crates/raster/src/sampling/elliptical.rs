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
const SLIMMEST: f64 = 8.0;
/// The shorter semi-axis on the level that is read is below this, in pixels of that level. Half of it is left after the step
/// to a level: the level's own squares then make up less than a tenth of the filter's variance.
const WIDEST: f64 = 3.0;

/// What a target pixel covers.
pub(super) struct Ellipse {
    /// The longer semi-axis.
    major: DVec2,
    /// The shorter one, perpendicular to it.
    minor: DVec2,
}

impl Ellipse {
    /// The image of the unit disc, widened as the module's documentation says. A Jacobian that is not finite gives the disc.
    pub(super) fn new(jacobian: DMat2) -> Self {
        let mut j = jacobian;
        if !(j.is_finite() && j.x_axis.abs().max(j.y_axis.abs()).max_element() < 1e100) {
            j = DMat2::IDENTITY;
        }
        // Eigenvectors of J·Jᵀ.
        let a = j.x_axis.x * j.x_axis.x + j.y_axis.x * j.y_axis.x;
        let b = j.x_axis.x * j.x_axis.y + j.y_axis.x * j.y_axis.y;
        let c = j.x_axis.y * j.x_axis.y + j.y_axis.y * j.y_axis.y;
        let (mean, half) = (0.5 * (a + c), 0.5 * (a - c));
        let spread = (half * half + b * b).sqrt();
        let largest = mean + spread;
        // Of the two forms of the eigenvector the one without cancellation.
        let along = if half >= 0.0 {
            DVec2::new(half + spread, b)
        } else {
            DVec2::new(b, spread - half)
        };
        let along = along.try_normalize().unwrap_or(DVec2::X);
        let long = largest.sqrt().max(1.0);
        // The determinant over the longer axis: no difference of nearly equal numbers.
        let short = if largest > 0.0 {
            j.determinant().abs() / largest.sqrt()
        } else {
            0.0
        };
        let short = short.max(1.0).max(long / SLIMMEST).min(long);
        Self {
            major: along * long,
            minor: along.perp() * short,
        }
    }
}

/// The mean over the ellipse about `at`, from the raster's corner. What is not finite shows as far as the ellipse reaches,
/// on the level that is read.
pub(super) fn filtered(
    base: &Grid<'_>,
    pyramid: &Pyramid,
    at: DVec2,
    ellipse: &Ellipse,
    out: &mut [f32],
) {
    let mut short = ellipse.minor.length();
    let mut number = 0;
    while short >= WIDEST && number < pyramid.levels.len() {
        short *= 0.5;
        number += 1;
    }
    let level = number.checked_sub(1).and_then(|n| pyramid.levels.get(n));
    let Some(level) = level else {
        let quadric = Quadric::new(ellipse.major, ellipse.minor);
        return mean(base, at, &quadric, out);
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
    let shrink = (WIDEST / short).min(1.0);
    let quadric = Quadric::new(
        ellipse.major * scale * shrink,
        ellipse.minor * scale * shrink,
    );
    mean(&grid, at * scale, &quadric, out);
}

/// An ellipse `a·x² + b·x·y + c·y² ≤ 1` and how far it reaches up and down.
struct Quadric {
    a: f64,
    b: f64,
    c: f64,
    reach: f64,
}

impl Quadric {
    /// The ellipse with two conjugate semi-diameters.
    fn new(u: DVec2, v: DVec2) -> Self {
        let determinant = u.x * v.y - u.y * v.x;
        let scale = 1.0 / (determinant * determinant);
        Self {
            a: (u.y * u.y + v.y * v.y) * scale,
            b: -2.0 * (u.x * u.y + v.x * v.y) * scale,
            c: (u.x * u.x + v.x * v.x) * scale,
            reach: (u.y * u.y + v.y * v.y).sqrt(),
        }
    }
}

/// The weighted mean of the pixels whose centres the ellipse holds.
fn mean(grid: &Grid<'_>, at: DVec2, quadric: &Quadric, out: &mut [f32]) {
    if grid.channels == 4
        && let ([four], []) = out.as_chunks_mut::<4>()
    {
        *four = channels::<4>(grid, at, quadric, 0);
        return;
    }
    for (channel, sample) in out.iter_mut().enumerate() {
        [*sample] = channels::<1>(grid, at, quadric, channel);
    }
}

/// The mean for `N` channels from `channel` on.
fn channels<const N: usize>(
    grid: &Grid<'_>,
    at: DVec2,
    quadric: &Quadric,
    channel: usize,
) -> [f32; N] {
    let Quadric { a, b, c, reach } = *quadric;
    let centre = at - 0.5;
    let (mut sum, mut total) = ([0.0_f32; N], 0.0_f32);
    // A single tap is copied: a weight and its reciprocal need not multiply to 1.
    let (mut taps, mut only) = (0_u32, [0.0_f32; N]);
    // The next whole number from `x` on.
    let from = |x: f64| split(x).0 + i64::from(split(x).1 > 0.0);
    let (first, last) = (from(centre.y - reach), split(centre.y + reach).0);
    for row in first..=last {
        let y = row as f64 - centre.y;
        let middle = -0.5 * b * y / a;
        // r² on this row is `a·(x − middle)² + rest`.
        let rest = c * y * y - a * middle * middle;
        if rest >= 1.0 {
            continue;
        }
        let half = ((1.0 - rest) / a).sqrt();
        let (left, right) = (centre.x + middle - half, centre.x + middle + half);
        let (left, right) = (from(left), split(right).0);
        let line = grid.edge.pixel(row, grid.height);
        let inside = left >= 0 && right < grid.width as i64;
        for column in left..=right {
            let x = column as f64 - centre.x - middle;
            let weight = 1.0 - (a * x * x + rest);
            if weight <= 0.0 {
                continue;
            }
            let weight = (weight * weight) as f32;
            total += weight;
            let pixel = if inside {
                Some(column as usize)
            } else {
                grid.edge.pixel(column, grid.width)
            };
            taps += 1;
            let (Some(pixel), Some(line)) = (pixel, line) else {
                continue;
            };
            let start = grid.at(pixel, line) + channel;
            if let Some(samples) = grid.samples[start..].first_chunk::<N>() {
                only = *samples;
                for (sum, sample) in sum.iter_mut().zip(samples) {
                    *sum += sample * weight;
                }
            }
        }
    }
    if taps == 1 {
        return only;
    }
    if total > 0.0 {
        let scale = 1.0 / total;
        sum.iter_mut().for_each(|sum| *sum *= scale);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ellipses_are_images_of_the_disc_made_wide_enough() {
        let axes = |columns: [f64; 4]| {
            let e = Ellipse::new(DMat2::from_cols_array(&columns));
            (e.major, e.minor)
        };
        let (major, minor) = axes([1.0, 0.0, 0.0, 1.0]);
        assert_eq!((major.length(), minor.length()), (1.0, 1.0));
        let (major, minor) = axes([0.0, 5.0, -2.0, 0.0]);
        assert!((major.abs() - dvec2(0.0, 5.0)).length() < 1e-12);
        assert!((minor.abs() - dvec2(2.0, 0.0)).length() < 1e-12);
        // A shear: the product of the axes is the determinant, the sum of squares that of the entries.
        let (major, minor) = axes([6.0, 1.0, 8.0, 4.0]);
        assert!((major.length() * minor.length() - 16.0).abs() < 1e-12);
        assert!((major.length_squared() + minor.length_squared() - 117.0).abs() < 1e-12);
        for odd in [[f64::NAN; 4], [0.0; 4], [f64::INFINITY, 0.0, 0.0, 1.0]] {
            let (major, minor) = axes(odd);
            assert_eq!((major.length(), minor.length()), (1.0, 1.0));
        }
        let (major, minor) = axes([100.0, 0.0, 0.0, 0.01]);
        assert_eq!((major.length(), minor.length()), (100.0, 12.5));
    }
}
