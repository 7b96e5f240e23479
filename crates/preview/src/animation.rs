//! Series of pictures in one file: GIF, which everything plays, and APNG, which keeps the colours.
//!
//! *Source*: `CompuServe`, *Graphics Interchange Format, Version 89a*, 1990; W3C, *Portable Network Graphics (PNG)
//! Specification (Third Edition)*, 2025, §11.3.5 (animation). The palette of a GIF is chosen per picture by a neural network
//! (A. H. Dekker, *Kohonen neural networks for optimal colour quantization*, Network 5, 1994), as the `color_quant` crate offers it.

use crate::{Picture, PreviewError};
use std::io::Write;

/// How an animation is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnimationFormat {
    /// At most 256 colours a picture; plays everywhere. Its clock has hundredths of a second.
    Gif,
    /// All colours, about three times the size; browsers play it, and what does not shows the first picture.
    Apng,
}

/// One in so many pixels teaches the palette its colours. More and the studio's soft ground shows bands.
const SAMPLED: usize = 7;
/// Difference between the largest and the smallest channel from which on a pixel counts as coloured.
const COLOURED: u8 = 60;

/// An animation that is being written to `W`: pictures are encoded as they come, so that only one is held at a time.
///
/// ```
/// use anamorph_core::glam::DVec3;
/// use anamorph_preview::{Animation, AnimationFormat, Model, Options, Panel, single};
///
/// let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let panel = Panel::new(Model::mesh(&points, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]));
/// let options = Options { width: 64, height: 64, turning: true, ..Options::default() };
/// let mut file = Vec::new();
/// let mut animation = Animation::new(&mut file, AnimationFormat::Gif, 8, 12.0)?;
/// for step in 0..8 {
///     let angle = f64::from(step) / 8.0 * std::f64::consts::TAU;
///     let camera = options.camera.turned(angle);
///     animation.push(&single(&panel, &Options { camera, ..options })?)?;
/// }
/// animation.finish()?;
/// assert!(file.starts_with(b"GIF89a"));
/// # Ok::<(), anamorph_preview::PreviewError>(())
/// ```
pub struct Animation<W: Write> {
    encoder: Encoder<W>,
    count: usize,
    rate: f64,
    pushed: usize,
    size: Option<(u32, u32)>,
}

/// The encoder, once the size of the pictures is known.
enum Encoder<W: Write> {
    Waiting(AnimationFormat, Option<W>),
    Gif(Box<gif::Encoder<W>>),
    Apng(Box<png::Writer<W>>, Vec<u8>),
}

fn failed(error: &impl ToString) -> PreviewError {
    PreviewError::Encoding {
        reason: error.to_string(),
    }
}

impl<W: Write> Animation<W> {
    /// An animation of `count` pictures, `rate` a second, that starts again at its end.
    ///
    /// # Errors
    /// [`PreviewError::Animation`] for no pictures or more than 10 000, or a rate that is not from 0.1 to 60.
    pub fn new(
        out: W,
        format: AnimationFormat,
        count: usize,
        rate: f64,
    ) -> Result<Self, PreviewError> {
        if !(1..=10_000).contains(&count) || !(0.1..=60.0).contains(&rate) {
            return Err(PreviewError::Animation {
                count,
                rate,
                mend: "give 1 to 10 000 pictures at 0.1 to 60 a second",
            });
        }
        Ok(Self {
            encoder: Encoder::Waiting(format, Some(out)),
            count,
            rate,
            pushed: 0,
            size: None,
        })
    }

    /// Adds the next picture.
    ///
    /// # Errors
    /// [`PreviewError::Frame`] if it has another size than the first, [`PreviewError::Animation`] if it is one too many,
    /// [`PreviewError::Encoding`] if the encoder or the output fails.
    pub fn push(&mut self, picture: &Picture) -> Result<(), PreviewError> {
        let (pixels, width, height) = picture.rgba();
        let (expected_width, expected_height) = *self.size.get_or_insert((width, height));
        if (width, height) != (expected_width, expected_height) {
            return Err(PreviewError::Frame {
                index: self.pushed,
                width,
                height,
                expected_width,
                expected_height,
            });
        }
        if self.pushed == self.count {
            return Err(self.miscounted(self.pushed + 1));
        }
        if let Encoder::Waiting(format, out) = &mut self.encoder
            && let Some(out) = out.take()
        {
            self.encoder = begin(*format, out, [width, height], self.count, self.rate)?;
        }
        self.pushed += 1;
        match &mut self.encoder {
            Encoder::Waiting(..) => Err(failed(&"it failed before")),
            Encoder::Gif(encoder) => {
                let (palette, indices) = quantized(pixels, width as usize);
                let (width, height) = (side(width)?, side(height)?);
                let mut frame =
                    gif::Frame::from_palette_pixels(width, height, indices, palette, None);
                // Each picture ends where the clock's hundredths are nearest to its time, so that the whole lasts as long as it should;
                // two hundredths at least: players take less for ten.
                #[allow(clippy::cast_precision_loss)]
                let at = |picture: usize| (100.0 * picture as f64 / self.rate).round();
                frame.delay = units(at(self.pushed) - at(self.pushed - 1)).max(2);
                encoder.write_frame(&frame).map_err(|error| failed(&error))
            }
            Encoder::Apng(writer, rows) => {
                rows.clear();
                let (opaque, _) = pixels.as_chunks::<4>();
                let colours = opaque
                    .iter()
                    .map(|&[red, green, blue, _]| [red, green, blue]);
                rows.extend(colours.flatten());
                writer
                    .write_image_data(rows)
                    .map_err(|error| failed(&error))
            }
        }
    }

    fn miscounted(&self, count: usize) -> PreviewError {
        PreviewError::Animation {
            count,
            rate: self.rate,
            mend: "push as many pictures as were announced",
        }
    }

    /// Ends the file.
    ///
    /// # Errors
    /// [`PreviewError::Animation`] if pictures are missing, [`PreviewError::Encoding`] if the encoder or the output fails.
    pub fn finish(self) -> Result<(), PreviewError> {
        if self.pushed != self.count {
            return Err(self.miscounted(self.pushed));
        }
        match self.encoder {
            Encoder::Gif(encoder) => {
                let mut out = encoder.into_inner().map_err(|error| failed(&error))?;
                out.flush().map_err(|error| failed(&error))
            }
            Encoder::Apng(writer, _) => writer.finish().map_err(|error| failed(&error)),
            Encoder::Waiting(..) => Err(failed(&"it failed before")),
        }
    }
}

/// A palette of 256 colours and the index of each pixel. Features are thin: all of their pixels are shown to the network, as
/// often as makes them a quarter of what it sees, or else their colours would drown in those of the model.
fn quantized(pixels: &[u8], width: usize) -> (Vec<u8>, Vec<u8>) {
    let (pixels, _) = pixels.as_chunks::<4>();
    let span = |p: &[u8; 4]| p[0].max(p[1]).max(p[2]) - p[0].min(p[1]).min(p[2]);
    let coloured: Vec<[u8; 4]> = pixels
        .iter()
        .copied()
        .filter(|p| span(p) >= COLOURED)
        .collect();
    let mut seen: Vec<[u8; 4]> = pixels.iter().step_by(SAMPLED).copied().collect();
    if !coloured.is_empty() {
        let wanted = seen.len() / 3;
        let step = coloured.len().div_ceil(wanted.max(1)).max(1);
        let some: Vec<[u8; 4]> = coloured.iter().step_by(step).copied().collect();
        seen.extend(some.iter().cycle().take(wanted.max(some.len())));
    }
    let network = color_quant::NeuQuant::new(1, 256, seen.as_flattened());
    // Pixels of equal colour, to seven bits a channel, share an answer. A faint fixed pattern (B. E. Bayer, *An optimum method
    // for two-level rendition of continuous-tone pictures*, ICC 1973) breaks up the bands of soft gradients.
    const PATTERN: [[i8; 4]; 4] = [[-2, 1, -2, 1], [2, -1, 2, -1], [-1, 2, -2, 1], [1, 0, 1, 0]];
    let mut known = vec![None; 1 << 21];
    let indices = pixels
        .iter()
        .enumerate()
        .map(|(i, pixel)| {
            let (x, y) = (i % width.max(1), i / width.max(1));
            let shift = PATTERN[y % 4][x % 4];
            let mut pixel = pixel.map(|channel| channel.saturating_add_signed(shift));
            pixel[3] = 255;
            let [red, green, blue, _] = pixel.map(|channel| usize::from(channel >> 1));
            let slot = &mut known[red << 14 | green << 7 | blue];
            *slot.get_or_insert_with(|| {
                #[allow(clippy::cast_possible_truncation)]
                {
                    network.index_of(&pixel) as u8
                }
            })
        })
        .collect();
    (network.color_map_rgb(), indices)
}

fn side(pixels: u32) -> Result<u16, PreviewError> {
    u16::try_from(pixels).map_err(|error| failed(&error))
}

/// A delay in the file's units; rates have been checked to give at most 10 seconds.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn units(delay: f64) -> u16 {
    delay.round() as u16
}

fn begin<W: Write>(
    format: AnimationFormat,
    out: W,
    [width, height]: [u32; 2],
    count: usize,
    rate: f64,
) -> Result<Encoder<W>, PreviewError> {
    match format {
        AnimationFormat::Gif => {
            let mut encoder = gif::Encoder::new(out, side(width)?, side(height)?, &[])
                .map_err(|error| failed(&error))?;
            encoder
                .set_repeat(gif::Repeat::Infinite)
                .map_err(|error| failed(&error))?;
            Ok(Encoder::Gif(Box::new(encoder)))
        }
        AnimationFormat::Apng => {
            let mut encoder = png::Encoder::new(out, width, height);
            encoder.set_color(png::ColorType::Rgb);
            encoder.set_depth(png::BitDepth::Eight);
            let count = u32::try_from(count).unwrap_or(u32::MAX);
            encoder
                .set_animated(count, 0)
                .map_err(|error| failed(&error))?;
            encoder
                .set_frame_delay(100, units(100.0 * rate))
                .map_err(|error| failed(&error))?;
            let writer = encoder.write_header().map_err(|error| failed(&error))?;
            Ok(Encoder::Apng(Box::new(writer), Vec::new()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: u32, shade: f32) -> Picture {
        let pixels = vec![[shade, 0.5, 1.0 - shade]; (width * 4) as usize];
        Picture::from_linear(&pixels, width, 4)
    }

    fn animated(format: AnimationFormat) -> Vec<u8> {
        let mut file = Vec::new();
        let mut animation = Animation::new(&mut file, format, 3, 12.0).unwrap();
        for shade in [0.0, 0.5, 1.0] {
            animation.push(&picture(6, shade)).unwrap();
        }
        animation.finish().unwrap();
        file
    }

    #[test]
    fn gif_holds_the_pictures() {
        let bytes = animated(AnimationFormat::Gif);
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(bytes.as_slice()).unwrap();
        let (mut shades, mut delays) = (Vec::new(), Vec::new());
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            assert_eq!((frame.width, frame.height), (6, 4));
            delays.push(frame.delay);
            shades.push(frame.buffer[0]);
        }
        // Three twelfths of a second are 25 hundredths.
        assert_eq!(delays, [8, 9, 8]);
        // The network's colours are near, not exact, and the pattern shifts them by up to two.
        assert_eq!(shades.len(), 3);
        for (shade, expected) in shades.iter().zip([0_u8, 188, 255]) {
            assert!(shade.abs_diff(expected) <= 8, "{shades:?}");
        }
    }

    /// A thin line keeps its colour among many greys.
    #[test]
    fn features_keep_their_colour() {
        let mut pixels: Vec<[f32; 3]> = (0..128 * 128)
            .map(|i| [(i % 128) as f32 / 128.0 * 0.8 + 0.1; 3])
            .collect();
        for i in 0..100 {
            pixels[64 * 128 + i] = [0.9, 0.25, 0.02];
        }
        let picture = Picture::from_linear(&pixels, 128, 128);
        let (palette, indices) = quantized(picture.rgba().0, 128);
        let index = usize::from(indices[64 * 128 + 50]);
        let found = &palette[3 * index..3 * index + 3];
        let wanted = picture.pixel(50, 64).unwrap();
        for (found, wanted) in found.iter().zip(wanted) {
            assert!(found.abs_diff(wanted) <= 12, "{found} is not {wanted}");
        }
    }

    #[test]
    fn apng_holds_the_pictures() {
        let bytes = animated(AnimationFormat::Apng);
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        assert_eq!(reader.info().animation_control().unwrap().num_frames, 3);
        let mut shades = Vec::new();
        let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
        for _ in 0..3 {
            reader.next_frame(&mut buffer).unwrap();
            shades.push(buffer[0]);
        }
        assert_eq!(shades, [0, 188, 255]);
    }

    #[test]
    fn miscounted_and_misfitting_pictures_are_refused() {
        assert!(Animation::new(Vec::new(), AnimationFormat::Gif, 0, 12.0).is_err());
        assert!(Animation::new(Vec::new(), AnimationFormat::Gif, 3, f64::NAN).is_err());
        for format in [AnimationFormat::Gif, AnimationFormat::Apng] {
            let mut animation = Animation::new(Vec::new(), format, 2, 12.0).unwrap();
            animation.push(&picture(6, 0.0)).unwrap();
            let error = animation.push(&picture(7, 0.0)).unwrap_err();
            assert!(error.to_string().contains("picture 1 of the animation"));
            assert!(animation.finish().is_err());
            let mut animation = Animation::new(Vec::new(), format, 1, 12.0).unwrap();
            animation.push(&picture(6, 0.0)).unwrap();
            assert!(animation.push(&picture(6, 0.0)).is_err());
        }
    }
}
