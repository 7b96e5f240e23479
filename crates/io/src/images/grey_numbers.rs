//! TIFF files of grey in floating-point numbers, as renderers and scientific cameras write them: linear light, one number a pixel.
//!
//! The general decoder does not know them. Numbers of 32 bits come out as they are; those of 16 and 64 bits become 32 bits.
//!
//! *Source*: Adobe, *TIFF 6.0*, 1992, §19 (data sample format). Bytes are read and written by the crate `tiff`.

use super::{ImageError, ImageFormat, ImageLimits};
use std::io::{Cursor, Seek, Write};
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::encoder::{TiffEncoder, colortype::Gray32Float};
use tiff::tags::Tag;

/// Numbers of a picture, one a pixel.
pub(super) struct GreyNumbers {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) samples: Vec<f32>,
    /// What has been made of them, in words.
    pub(super) note: Option<String>,
}

fn failed(error: impl core::fmt::Display) -> ImageError {
    ImageError::Damaged {
        format: ImageFormat::Tiff.title(),
        what: error.to_string(),
    }
}

/// The numbers, if a file holds such; other files are for the general decoder.
pub(super) fn read(bytes: &[u8], limits: ImageLimits) -> Result<Option<GreyNumbers>, ImageError> {
    let Ok(decoder) = Decoder::new(Cursor::new(bytes)) else {
        return Ok(None);
    };
    let most = usize::try_from(limits.samples.saturating_mul(8)).unwrap_or(usize::MAX);
    let mut allowed = Limits::default();
    allowed.decoding_buffer_size = most;
    allowed.intermediate_buffer_size = most;
    let mut decoder = decoder.with_limits(allowed);
    let Ok(ColorType::Gray(bits @ (16 | 32 | 64))) = decoder.colortype() else {
        return Ok(None);
    };
    // 3: floating point. 16 bits of anything else are codes.
    let format = decoder.get_tag_u32(Tag::SampleFormat).unwrap_or(1);
    if format != 3 {
        return if bits == 16 {
            Ok(None)
        } else {
            Err(ImageError::Unsupported {
                format: ImageFormat::Tiff.title(),
                what: format!("whole numbers of {bits} bits"),
                mend: "save it as 8 or 16 bits, or as floating-point numbers of 32 bits",
            })
        };
    }
    let (width, height) = decoder.dimensions().map_err(failed)?;
    limits.check(width.into(), height.into(), 1)?;
    let (samples, note) = match decoder.read_image().map_err(failed)? {
        DecodingResult::F32(numbers) => (numbers, None),
        DecodingResult::F16(numbers) => {
            let samples = numbers.into_iter().map(f32::from).collect();
            (samples, Some("numbers of 16 bits become 32 bits"))
        }
        DecodingResult::F64(numbers) => {
            let samples = numbers.into_iter().map(|number| number as f32).collect();
            (samples, Some("numbers of 64 bits become 32 bits"))
        }
        _ => return Err(failed("its numbers are not what its tags say")),
    };
    if samples.len() as u64 != u64::from(width) * u64::from(height) {
        return Err(failed("it has more or fewer numbers than pixels"));
    }
    Ok(Some(GreyNumbers {
        width,
        height,
        samples,
        note: note.map(str::to_owned),
    }))
}

/// Writes numbers of 32 bits.
pub(super) fn write(
    out: impl Write + Seek,
    (width, height): (u32, u32),
    samples: &[f32],
) -> Result<(), tiff::TiffError> {
    TiffEncoder::new(out)?.write_image::<Gray32Float>(width, height, samples)
}
