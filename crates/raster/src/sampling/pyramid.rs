//! A pyramid of ever smaller rasters.
//!
//! *Source*: L. Williams, *Pyramidal parametrics*, SIGGRAPH 1983. Each level has half the pixels of the one before along each
//! axis, rounded up, and covers exactly the same rectangle: for odd sizes the means are over shares of pixels. So a level
//! can be wrapped around or mirrored like the raster itself.

use crate::{Raster, parallel};

/// One level.
#[derive(Debug)]
pub(super) struct Level {
    pub(super) samples: Vec<f32>,
    pub(super) width: usize,
    pub(super) height: usize,
}

/// All levels but the raster itself, from the largest.
#[derive(Debug)]
pub(super) struct Pyramid {
    pub(super) levels: Vec<Level>,
}

impl Pyramid {
    pub(super) fn new(raster: &Raster) -> Self {
        let channels = raster.channels();
        let (mut width, mut height) = (raster.width(), raster.height());
        let mut levels: Vec<Level> = Vec::new();
        while width > 1 || height > 1 {
            let above = levels.last().map_or(raster.samples(), |l| &l.samples);
            let level = halved(above, width, height, channels);
            (width, height) = (level.width, level.height);
            levels.push(level);
        }
        Self { levels }
    }
}

/// The pixels of `size` under pixel `index` of `halved`, at most three, and their shares of it.
fn shares(index: usize, size: usize, halved: usize) -> ([f32; 3], usize, usize) {
    // In units of 1 / halved of a pixel: pixel `p` covers [p·halved, (p + 1)·halved).
    let (from, to) = (index * size, (index + 1) * size);
    let (first, last) = (from / halved, to.div_ceil(halved));
    let mut list = [0.0; 3];
    for (share, pixel) in list.iter_mut().zip(first..last) {
        let covered = to.min((pixel + 1) * halved) - from.max(pixel * halved);
        *share = (covered as f64 / size as f64) as f32;
    }
    (list, first, last - first)
}

fn halved(samples: &[f32], width: usize, height: usize, channels: usize) -> Level {
    let (half_width, half_height) = (width.div_ceil(2), height.div_ceil(2));
    let mut half = vec![0.0_f32; half_width * half_height * channels];
    let columns: Vec<_> = (0..half_width)
        .map(|column| shares(column, width, half_width))
        .collect();
    parallel::chunks(&mut half, half_width * channels, |row, out| {
        let (down, first_row, rows) = shares(row, height, half_height);
        for (pixel, (across, first, count)) in out.chunks_exact_mut(channels).zip(&columns) {
            for (row, down) in (first_row..).zip(down).take(rows) {
                for (column, across) in (*first..).zip(across).take(*count) {
                    let weight = down * across;
                    let start = (row * width + column) * channels;
                    let from = &samples[start..start + channels];
                    for (sum, sample) in pixel.iter_mut().zip(from) {
                        *sum += sample * weight;
                    }
                }
            }
        }
    });
    Level {
        samples: half,
        width: half_width,
        height: half_height,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Window;

    #[test]
    fn levels_keep_the_mean_for_all_sizes() {
        for (width, height) in [(1, 1), (2, 2), (5, 3), (7, 16), (13, 1), (31, 33)] {
            let window = Window::new(0, 0, width, height).unwrap();
            let samples: Vec<f32> = (0..width * height)
                .map(|i| ((i * 7919) % 101) as f32)
                .collect();
            let mean = |s: &[f32]| s.iter().map(|&x| f64::from(x)).sum::<f64>() / s.len() as f64;
            let raster = Raster::from_samples(window, 1, samples).unwrap();
            let pyramid = Pyramid::new(&raster);
            for level in &pyramid.levels {
                assert_eq!(level.samples.len(), level.width * level.height);
                let off = mean(&level.samples) - mean(raster.samples());
                assert!(off.abs() < 1e-3, "{width} {height}: {off}");
            }
            if let Some(last) = pyramid.levels.last() {
                assert_eq!((last.width, last.height), (1, 1));
            }
        }
    }
}
