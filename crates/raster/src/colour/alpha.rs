//! Premultiplied alpha.
//!
//! *Source*: T. Porter and T. Duff, *Compositing Digital Images*, SIGGRAPH 1984.

use crate::{Raster, RasterError, parallel};

/// Pixels a task works on.
const TASK: usize = 1 << 14;

fn each_pixel(
    raster: &mut Raster,
    alpha: usize,
    body: impl Fn(&mut [f32], f32) + Sync + Send,
) -> Result<(), RasterError> {
    raster.check_channel(alpha)?;
    let channels = raster.channels();
    parallel::chunks(raster.samples_mut(), TASK * channels, |_, chunk| {
        for pixel in chunk.chunks_exact_mut(channels) {
            let coverage = pixel[alpha];
            if coverage == 1.0 {
                continue;
            }
            body(pixel, coverage);
            pixel[alpha] = coverage;
        }
    });
    Ok(())
}

/// Multiplies all channels by the one numbered `alpha`. Where that is 1 nothing changes, bit for bit; where it is 0 the
/// others become 0, whatever they were.
///
/// # Errors
/// [`RasterError::NoChannel`].
pub fn premultiply(raster: &mut Raster, alpha: usize) -> Result<(), RasterError> {
    each_pixel(raster, alpha, |pixel, coverage| {
        if coverage == 0.0 {
            pixel.fill(0.0);
        } else {
            pixel.iter_mut().for_each(|sample| *sample *= coverage);
        }
    })
}

/// Divides all channels by the one numbered `alpha`. Where that is 1 nothing changes, bit for bit; where it is 0 neither:
/// light without coverage, as of glows, stays what it is.
///
/// # Errors
/// [`RasterError::NoChannel`].
pub fn unpremultiply(raster: &mut Raster, alpha: usize) -> Result<(), RasterError> {
    each_pixel(raster, alpha, |pixel, coverage| {
        if coverage != 0.0 {
            pixel.iter_mut().for_each(|sample| *sample /= coverage);
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Window;

    fn raster(samples: &[f32]) -> Raster {
        let window = Window::new(0, 0, samples.len() / 4, 1).unwrap();
        Raster::from_samples(window, 4, samples.to_vec()).unwrap()
    }

    #[test]
    fn opaque_pixels_keep_their_bits() {
        let odd = [0.1_f32, -0.0, f32::NAN, 1.0, f32::INFINITY, 1e-42, 7.0, 1.0];
        for change in [premultiply, unpremultiply] {
            let mut pixels = raster(&odd);
            change(&mut pixels, 3).unwrap();
            for (a, b) in pixels.samples().iter().zip(odd) {
                assert_eq!(a.to_bits(), b.to_bits());
            }
        }
    }

    #[test]
    fn both_ways_agree_and_nothing_covered_is_no_division() {
        let mut pixels = raster(&[0.5, 0.25, 2.0, 0.5, 3.0, f32::INFINITY, 1.0, 0.0]);
        premultiply(&mut pixels, 3).unwrap();
        assert_eq!(
            pixels.samples(),
            [0.25, 0.125, 1.0, 0.5, 0.0, 0.0, 0.0, 0.0]
        );
        unpremultiply(&mut pixels, 3).unwrap();
        assert_eq!(pixels.samples()[..4], [0.5, 0.25, 2.0, 0.5]);
        let mut glow = raster(&[3.0, 2.0, 1.0, 0.0]);
        unpremultiply(&mut glow, 3).unwrap();
        assert_eq!(glow.samples(), [3.0, 2.0, 1.0, 0.0]);
        assert!(matches!(
            premultiply(&mut glow, 4),
            Err(RasterError::NoChannel { .. })
        ));
    }
}
