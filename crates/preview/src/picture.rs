//! The finished pixels.

use crate::PreviewError;

/// A finished picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    pixels: Vec<u8>,
    width: u32,
    height: u32,
}

impl Picture {
    /// A picture from linear light, row by row from the top; values are clamped to 0 to 1.
    pub(crate) fn from_linear(linear: &[[f32; 3]], width: u32, height: u32) -> Self {
        let table = SrgbTable::new();
        let pixels = linear
            .iter()
            .flat_map(|&[r, g, b]| [table.encode(r), table.encode(g), table.encode(b), 255])
            .collect();
        Self {
            pixels,
            width,
            height,
        }
    }

    /// A picture from pixels row by row from the top, three bytes each: red, green, blue, sRGB-encoded.
    ///
    /// # Errors
    /// [`PreviewError::Pixels`] where there are not as many as `width` and `height` say, or none.
    pub fn from_rgb(pixels: &[u8], width: u32, height: u32) -> Result<Self, PreviewError> {
        let (threes, rest) = pixels.as_chunks::<3>();
        let count = u64::from(width) * u64::from(height);
        if threes.len() as u64 != count || count == 0 || !rest.is_empty() {
            return Err(PreviewError::Pixels {
                width,
                height,
                found: pixels.len(),
            });
        }
        Ok(Self {
            pixels: threes
                .iter()
                .flat_map(|&[r, g, b]| [r, g, b, 255])
                .collect(),
            width,
            height,
        })
    }

    /// A picture from pixels that are opaque, four bytes each.
    pub(crate) fn from_opaque(pixels: &[u8], width: u32, height: u32) -> Self {
        Self {
            pixels: pixels.to_vec(),
            width,
            height,
        }
    }

    /// The pixels, row by row from the top, four bytes each (red, green, blue, opacity; sRGB; opacity is always 255),
    /// with the width and the height.
    #[must_use]
    pub fn rgba(&self) -> (&[u8], u32, u32) {
        (&self.pixels, self.width, self.height)
    }

    /// The red, green, blue and opacity of a pixel; `None` outside the picture.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> Option<[u8; 4]> {
        if x >= self.width || y >= self.height {
            return None;
        }
        let start = (y as usize * self.width as usize + x as usize) * 4;
        self.pixels.get(start..start + 4)?.try_into().ok()
    }

    /// The picture as a PNG file.
    ///
    /// # Errors
    /// [`PreviewError::Png`] if the encoder fails.
    pub fn png(&self) -> Result<Vec<u8>, PreviewError> {
        let failed = |error: png::EncodingError| PreviewError::Png {
            reason: error.to_string(),
        };
        // Without the opacity, which is always full: a third smaller.
        let (pixels, _) = self.pixels.as_chunks::<4>();
        let rows: Vec<u8> = pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_filter(png::Filter::Adaptive);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header().map_err(failed)?;
        writer.write_image_data(&rows).map_err(failed)?;
        writer.finish().map_err(failed)?;
        Ok(file)
    }
}

/// Rounds linear light to the nearest sRGB byte without a power for each pixel.
struct SrgbTable {
    bytes: Vec<u8>,
}

impl SrgbTable {
    /// Steps of linear light; the steepest part of the curve has 12.92 · 255 bytes per unit, so that a byte is never
    /// skipped.
    const STEPS: usize = 1 << 14;

    fn new() -> Self {
        let bytes = (0..=Self::STEPS)
            .map(|step| (encode_srgb(step as f32 / Self::STEPS as f32) * 255.0).round() as u8)
            .collect();
        Self { bytes }
    }

    fn encode(&self, linear: f32) -> u8 {
        // NaN casts to 0.
        let step = (linear.clamp(0.0, 1.0) * Self::STEPS as f32).round() as usize;
        self.bytes.get(step).copied().unwrap_or(255)
    }
}

/// From linear light, 0 to 1, to an sRGB-encoded value (IEC 61966-2-1).
fn encode_srgb(value: f32) -> f32 {
    if value <= 0.003_130_8 {
        value * 12.92
    } else {
        1.055 * value.powf(1.0 / 2.4) - 0.055
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::decode_srgb;
    use tiny_skia::Pixmap;

    #[test]
    fn every_byte_survives_decoding_and_encoding() {
        let table = SrgbTable::new();
        for byte in 0..=255_u8 {
            assert_eq!(table.encode(decode_srgb(f32::from(byte) / 255.0)), byte);
        }
        assert_eq!(table.encode(f32::NAN), 0);
        assert_eq!(table.encode(7.0), 255);
    }

    #[test]
    fn pixels_must_fill_the_picture() {
        let bytes: Vec<u8> = (0..18).collect();
        let picture = Picture::from_rgb(&bytes, 3, 2).unwrap();
        assert_eq!(picture.pixel(2, 1), Some([15, 16, 17, 255]));
        for (count, width, height) in [(17, 3, 2), (18, 3, 3), (0, 0, 2), (16, 3, 2)] {
            let odd = Picture::from_rgb(&bytes[..count], width, height);
            assert!(matches!(odd, Err(PreviewError::Pixels { .. })), "{count}");
        }
    }

    #[test]
    fn png_holds_the_pixels() {
        let picture = Picture::from_linear(&[[0.0, 0.5, 1.0], [1.0, 0.2, 0.0]], 2, 1);
        let png = picture.png().unwrap();
        let read = Pixmap::decode_png(&png).unwrap();
        assert_eq!(read.data(), picture.rgba().0);
        assert_eq!((read.width(), read.height()), (2, 1));
        assert_eq!(picture.pixel(1, 0).unwrap()[0], 255);
        assert_eq!(picture.pixel(2, 0), None);
    }
}
