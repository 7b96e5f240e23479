//! YUV4MPEG2: a film without compression, frame after frame, for an encoder at the other end of a pipe.
//!
//! Colours are sRGB-encoded and become Y′CbCr of ITU-R BT.709 in the limited range (16 to 235, 16 to 240), one sample of each a pixel (4:4:4);
//! grey images are luma alone. What has alpha stands before black.
//!
//! *Source*: mjpegtools, *yuv4mpeg(5)* (the format); ITU-R Recommendation BT.709-6, §3 (the matrix and the ranges).

use super::ImageError;
use crate::text::fill;
use anamorph_raster::Raster;
use anamorph_raster::colour::Srgb8;
use std::io::Write;

/// Fixed point of the matrix.
const ONE: i32 = 1 << 16;
/// Rows a task converts.
const ROWS: usize = 16;

/// A film that is being written to `W`, a frame at a time.
pub struct Y4m<W: Write> {
    out: W,
    size: [usize; 2],
    grey: bool,
    table: Srgb8,
    planes: Vec<u8>,
}

impl<W: Write> Y4m<W> {
    /// Begins a film of frames of so many pixels, at so many frames a second; `channels` as of [`Y4m::push`].
    ///
    /// # Errors
    /// What the output says.
    pub fn new(mut out: W, size: [usize; 2], channels: usize, rate: f64) -> std::io::Result<Self> {
        let grey = channels < 3;
        let [width, height] = size;
        let (frames, seconds) = fraction(rate);
        let colours = if grey { "mono" } else { "444" };
        writeln!(
            out,
            "YUV4MPEG2 W{width} H{height} F{frames}:{seconds} Ip A1:1 C{colours} XCOLORRANGE=LIMITED"
        )?;
        let planes = vec![0; width * height * if grey { 1 } else { 3 }];
        Ok(Self {
            out,
            size,
            grey,
            table: Srgb8::new(),
            planes,
        })
    }

    /// Adds a frame: grey, grey and alpha, RGB, or RGB and alpha by its number of channels, in premultiplied linear light.
    ///
    /// # Errors
    /// [`ImageError::Mismatch`] where it has other pixels or channels than were announced; what the output says.
    pub fn push(&mut self, frame: &Raster) -> Result<std::io::Result<()>, ImageError> {
        let channels = frame.channels();
        let found = [frame.width(), frame.height()];
        if found != self.size || (channels < 3) != self.grey || !(1..=4).contains(&channels) {
            let count = |size: [usize; 2], of: usize| size[0] * size[1] * of;
            return Err(ImageError::Mismatch {
                found: count(found, channels),
                needed: count(self.size, if self.grey { 1 } else { 3 }),
            });
        }
        let width = self.size[0];
        let (samples, table) = (frame.samples(), &self.table);
        let row = |row: usize| &samples[row * width * channels..(row + 1) * width * channels];
        if self.grey {
            fill(&mut self.planes, width, |first, luma| {
                for (luma, pixel) in luma
                    .iter_mut()
                    .zip(row(first / width).chunks_exact(channels))
                {
                    *luma = byte(16, 56_284 * i32::from(table.encode(pixel[0])));
                }
            });
        } else {
            let (luma, chroma) = self.planes.split_at_mut(width * self.size[1]);
            let (blue, red) = chroma.split_at_mut(luma.len());
            let rows = luma
                .chunks_exact_mut(width)
                .zip(blue.chunks_exact_mut(width));
            let mut rows: Vec<_> = rows.zip(red.chunks_exact_mut(width)).collect();
            fill(&mut rows, ROWS, |first, rows| {
                for (at, ((luma, blue), red)) in (first..).zip(rows) {
                    let pixels = row(at).chunks_exact(channels);
                    let outs = luma.iter_mut().zip(blue.iter_mut()).zip(red.iter_mut());
                    for (((luma, blue), red), pixel) in outs.zip(pixels) {
                        let code = |i: usize| i32::from(table.encode(pixel[i]));
                        let (r, g, b) = (code(0), code(1), code(2));
                        *luma = byte(16, 11_966 * r + 40_254 * g + 4_064 * b);
                        *blue = byte(128, -6_596 * r - 22_188 * g + 28_784 * b);
                        *red = byte(128, 28_784 * r - 26_145 * g - 2_639 * b);
                    }
                }
            });
        }
        Ok(self.write())
    }

    fn write(&mut self) -> std::io::Result<()> {
        self.out.write_all(b"FRAME\n")?;
        self.out.write_all(&self.planes)
    }

    /// Ends the film.
    ///
    /// # Errors
    /// What the output says.
    pub fn finish(mut self) -> std::io::Result<()> {
        self.out.flush()
    }
}

/// A fixed-point number, rounded, above `base`.
fn byte(base: i32, sum: i32) -> u8 {
    (base + ((sum + ONE / 2) >> 16)).clamp(0, 255) as u8
}

/// A rate as a fraction: whole numbers, those of television over 1001, else thousandths.
fn fraction(rate: f64) -> (u64, u64) {
    let near = |x: f64| (x - x.round()).abs() <= 1e-6 * x.abs();
    if near(rate) && rate >= 1.0 {
        return (rate.round() as u64, 1);
    }
    let film = rate * 1.001;
    if (film - film.round()).abs() <= 5e-4 && rate >= 1.0 {
        return (film.round() as u64 * 1000, 1001);
    }
    let (mut a, mut b) = ((rate * 1e6).round().max(1.0) as u64, 1_000_000);
    let whole = (a, b);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    (whole.0 / a, whole.1 / a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_raster::Window;

    fn raster(channels: usize, samples: &[f32]) -> Raster {
        let window = Window::new(0, 0, samples.len() / channels, 1).unwrap();
        Raster::from_samples(window, channels, samples.to_vec()).unwrap()
    }

    #[test]
    fn primaries_have_the_codes_of_the_recommendation() {
        // White, black, red, green, blue and half-covered white before black.
        let frame = raster(
            4,
            &[
                1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0,
                0.0, 0.0, 1.0, 1.0, 0.5, 0.5, 0.5, 0.5,
            ],
        );
        let mut out = Vec::new();
        let mut film = Y4m::new(&mut out, [6, 1], 4, 30.0).unwrap();
        film.push(&frame).unwrap().unwrap();
        film.push(&frame).unwrap().unwrap();
        assert!(film.push(&raster(4, &[0.0; 8])).is_err());
        assert!(film.push(&raster(1, &[0.0; 6])).is_err());
        film.finish().unwrap();
        let head = b"YUV4MPEG2 W6 H1 F30:1 Ip A1:1 C444 XCOLORRANGE=LIMITED\n";
        assert!(out.starts_with(head));
        let frame = &out[head.len()..head.len() + 6 + 18];
        assert_eq!(&frame[..6], b"FRAME\n");
        // Kr = 0.2126, Kb = 0.0722: luma 16 + 219 K, chroma 128 ± 224 · half.
        assert_eq!(frame[6..12], [235, 16, 63, 173, 32, 177]);
        assert_eq!(frame[12..18], [128, 128, 102, 42, 240, 128]);
        assert_eq!(frame[18..24], [128, 128, 240, 26, 118, 128]);
        assert_eq!(out.len(), head.len() + 2 * 24);
    }

    #[test]
    fn grey_is_luma_alone() {
        let mut out = Vec::new();
        let mut film = Y4m::new(&mut out, [2, 1], 1, 24.0).unwrap();
        film.push(&raster(1, &[0.0, 2.0])).unwrap().unwrap();
        film.finish().unwrap();
        let text = b"YUV4MPEG2 W2 H1 F24:1 Ip A1:1 Cmono XCOLORRANGE=LIMITED\nFRAME\n\x10\xeb";
        assert_eq!(out, text);
    }

    #[test]
    fn rates_are_fractions() {
        assert_eq!(fraction(24.0), (24, 1));
        assert_eq!(fraction(29.97), (30_000, 1001));
        assert_eq!(fraction(23.976), (24_000, 1001));
        assert_eq!(fraction(12.5), (25, 2));
        assert_eq!(fraction(0.5), (1, 2));
    }
}
