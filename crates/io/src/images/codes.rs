//! PNG, JPEG, TIFF and WebP: one layer of grey or RGB, with or without alpha, in codes of 8 or 16 bits or, in TIFF, 32-bit numbers.

use super::chunks::{self, Chunks};
use super::grey_numbers::{self, GreyNumbers};
use super::{
    Channel, ChannelKind, EncodeOptions, ImageError, ImageFile, ImageFormat, ImageLayer,
    ImageLimits, Kept as AnyKept, SampleType,
};
use crate::Lost;
use anamorph_raster::colour::{Srgb8, Srgb16, premultiply};
use anamorph_raster::{Raster, Window};
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageReader};
use std::io::Cursor;

/// What a file holds beside the pixels.
#[derive(Debug, Clone, Default)]
pub(super) struct Kept {
    /// Chunks of a PNG file.
    chunks: Chunks,
    pub(super) profile: Option<Vec<u8>>,
    pub(super) exif: Option<Vec<u8>>,
    hidden: Option<Hidden>,
}

impl Kept {
    /// As the picture becomes RGB: a profile of grey is not one of RGB.
    pub(super) fn widen(&mut self) {
        self.profile = None;
        self.chunks.drop_profile();
        for (_, codes) in self.hidden.iter_mut().flat_map(|hidden| &mut hidden.codes) {
            *codes = [codes[0]; 3];
        }
    }
}

/// Colours of pixels that nothing is seen of. Premultiplied they are all the same; a pixel that stays where it was gets its own back.
#[derive(Debug, Clone)]
struct Hidden {
    window: Window,
    /// Number of the pixel and its colour channels, in order.
    codes: Vec<(usize, [u16; 3])>,
}

/// Bytes that decoders may take beside the picture.
const WORKING_MEMORY: u64 = 64 << 20;

fn foreign(format: ImageFormat) -> image::ImageFormat {
    match format {
        ImageFormat::Png => image::ImageFormat::Png,
        ImageFormat::Jpeg => image::ImageFormat::Jpeg,
        ImageFormat::Tiff => image::ImageFormat::Tiff,
        ImageFormat::WebP => image::ImageFormat::WebP,
        ImageFormat::OpenExr => image::ImageFormat::OpenExr,
    }
}

/// What decoders say, for people: some print the insides of the program.
fn plain(error: &dyn core::fmt::Display) -> String {
    let text = error.to_string();
    if text.contains("CRC") {
        "a checksum does not agree with its bytes".to_owned()
    } else if text.contains(['{', '[', '`']) || text.contains("::") {
        "what it holds is not as the format says".to_owned()
    } else {
        text
    }
}

/// An error of the decoders in our words.
fn failed(format: ImageFormat, error: image::ImageError) -> ImageError {
    let format = format.title();
    match error {
        image::ImageError::Unsupported(error) => ImageError::Unsupported {
            format,
            what: match error.kind() {
                image::error::UnsupportedErrorKind::Color(_) => {
                    "samples or colours of a kind that is not read".to_owned()
                }
                _ => plain(&error),
            },
            mend: "save it as 8 or 16 bits of grey or RGB",
        },
        image::ImageError::Limits(error) => ImageError::Damaged {
            format,
            what: format!("it takes more memory than its size accounts for ({error})"),
        },
        error => ImageError::Damaged {
            format,
            what: plain(&error),
        },
    }
}

pub(super) fn read(
    format: ImageFormat,
    bytes: &[u8],
    limits: ImageLimits,
) -> Result<ImageFile, ImageError> {
    let fail = |error| failed(format, error);
    if format == ImageFormat::Png {
        // A header alone says so, and decoders only call it damaged.
        let number = |at: usize| {
            let four = bytes.get(at..at + 4).and_then(<[u8]>::first_chunk::<4>);
            four.map(|four| u64::from(u32::from_be_bytes(*four)))
        };
        if let (Some(width), Some(height)) = (number(16), number(20)) {
            limits.check(width, height, 1)?;
        }
    }
    if format == ImageFormat::Tiff
        && let Some(numbers) = grey_numbers::read(bytes, limits)?
    {
        return of_numbers(bytes, numbers);
    }
    let mut reader = ImageReader::with_format(Cursor::new(bytes), foreign(format));
    let mut allowed = image::Limits::no_limits();
    allowed.max_alloc = Some(
        limits
            .samples
            .saturating_mul(4)
            .saturating_add(WORKING_MEMORY),
    );
    reader.limits(allowed);
    let mut decoder = reader.into_decoder().map_err(fail)?;
    let (width, height) = decoder.dimensions();
    let colour = decoder.color_type();
    limits.check(width.into(), height.into(), colour.channel_count().into())?;
    let original = decoder.original_color_type();
    let mut kept = Kept {
        profile: decoder.icc_profile().ok().flatten(),
        exif: decoder.exif_metadata().ok().flatten(),
        ..Kept::default()
    };
    if format == ImageFormat::Tiff && kept.profile.is_none() {
        kept.profile = TiffDirectory::of(bytes).and_then(|directory| directory.profile());
    }
    if format == ImageFormat::Png {
        kept.chunks = chunks::beside_pixels(bytes);
    }
    let decoded = DynamicImage::from_decoder(decoder).map_err(fail)?;
    let window = Window::new(0, 0, width as usize, height as usize)?;
    let layer = layer(decoded, window, &mut kept)?;
    let mut notes = notes(format, bytes, original);
    if !kept.chunks.left.is_empty() {
        let names = kept.chunks.left.join(", ");
        notes.push(format!(
            "chunks that depend on the old pixels are left out: {names}"
        ));
    }
    Ok(ImageFile {
        format,
        display: window,
        layers: vec![layer],
        notes,
        kept: AnyKept::Codes(kept),
    })
}

/// A picture of one linear number a pixel.
fn of_numbers(bytes: &[u8], numbers: GreyNumbers) -> Result<ImageFile, ImageError> {
    let window = Window::new(0, 0, numbers.width as usize, numbers.height as usize)?;
    let layer = ImageLayer {
        name: None,
        channels: vec![Channel::new("Y", SampleType::Float32)],
        raster: Some(Raster::from_samples(window, 1, numbers.samples)?),
        identifiers: None,
    };
    let mut notes = notes(ImageFormat::Tiff, bytes, ExtendedColorType::L16);
    notes.extend(numbers.note);
    Ok(ImageFile {
        format: ImageFormat::Tiff,
        display: window,
        layers: vec![layer],
        notes,
        kept: AnyKept::Codes(Kept {
            profile: TiffDirectory::of(bytes).and_then(|directory| directory.profile()),
            ..Kept::default()
        }),
    })
}

/// What is not read or not kept.
fn notes(format: ImageFormat, bytes: &[u8], original: ExtendedColorType) -> Vec<String> {
    let mut notes = Vec::new();
    // Colour type 3, in the byte behind the sizes and the depth.
    if format == ImageFormat::Png && bytes.get(25) == Some(&3) {
        notes.push("the palette becomes RGB".to_owned());
    } else if matches!(
        original,
        ExtendedColorType::L1 | ExtendedColorType::L2 | ExtendedColorType::L4
    ) {
        notes.push("grey of fewer than 8 bits becomes 8 bits".to_owned());
    } else if matches!(
        original,
        ExtendedColorType::Cmyk8 | ExtendedColorType::Cmyk16
    ) {
        notes.push("CMYK becomes RGB".to_owned());
    }
    // An extended file whose flags name an animation.
    let is_animated =
        bytes.get(12..16) == Some(b"VP8X") && bytes.get(20).is_some_and(|f| f & 2 != 0);
    if format == ImageFormat::WebP && is_animated {
        notes.push("of the animation only the first picture is read".to_owned());
    }
    if format == ImageFormat::Tiff && TiffDirectory::of(bytes).is_some_and(|d| d.has_more()) {
        notes.push("of the pages only the first is read".to_owned());
    }
    notes
}

/// The first directory of a classic TIFF file: where it is, how many entries it has, and how its numbers are read.
///
/// *Source*: Adobe, *TIFF 6.0*, 1992, §2.
struct TiffDirectory<'a> {
    bytes: &'a [u8],
    little: bool,
    start: usize,
    entries: usize,
}

impl<'a> TiffDirectory<'a> {
    fn of(bytes: &'a [u8]) -> Option<Self> {
        let little = bytes.starts_with(b"II*\0");
        if !little && !bytes.starts_with(b"MM\0*") {
            return None;
        }
        let mut directory = Self {
            bytes,
            little,
            start: 0,
            entries: 0,
        };
        directory.start = directory.number(4, 4)?;
        directory.entries = directory.number(directory.start, 2)?;
        directory.start = directory.start.checked_add(2)?;
        Some(directory)
    }

    fn number(&self, at: usize, count: usize) -> Option<usize> {
        let digits = self.bytes.get(at..at.checked_add(count)?)?;
        let add = |sum: usize, &byte: &u8| sum << 8 | usize::from(byte);
        Some(if self.little {
            digits.iter().rev().fold(0, add)
        } else {
            digits.iter().fold(0, add)
        })
    }

    /// Whether it names another directory: a second page.
    fn has_more(&self) -> bool {
        let next = self.start.checked_add(12 * self.entries);
        next.and_then(|next| self.number(next, 4))
            .is_some_and(|next| next != 0)
    }

    /// The value of the tag 34675, a colour profile (ICC.1:2004-10, annex B.4), which the decoder does not find.
    fn profile(&self) -> Option<Vec<u8>> {
        const PROFILE: usize = 34_675;
        let mut entries = (0..self.entries).map(|entry| self.start + 12 * entry);
        let entry = entries.find(|&at| self.number(at, 2) == Some(PROFILE))?;
        let (count, place) = (self.number(entry + 4, 4)?, self.number(entry + 8, 4)?);
        let value = self.bytes.get(place..place.checked_add(count)?)?;
        (count > 4).then(|| value.to_vec())
    }
}

/// The names of so many channels.
pub(super) fn names(channels: usize) -> &'static [&'static str] {
    match channels {
        1 => &["Y"],
        2 => &["Y", "A"],
        3 => &["R", "G", "B"],
        _ => &["R", "G", "B", "A"],
    }
}

fn layer(decoded: DynamicImage, window: Window, kept: &mut Kept) -> Result<ImageLayer, ImageError> {
    let channels = usize::from(decoded.color().channel_count());
    let has_alpha = decoded.color().has_alpha();
    // Alpha, the last channel, is no light and has no curve.
    let is_alpha = |i: usize| has_alpha && i % channels == channels - 1;
    let from_8 = |codes: Vec<u8>| {
        let table = Srgb8::new();
        let light = |(i, &code): (usize, &u8)| {
            if is_alpha(i) {
                f32::from(code) / 255.0
            } else {
                table.decode(code)
            }
        };
        let samples: Vec<f32> = codes.iter().enumerate().map(light).collect();
        let wide = |i: usize| u16::from(codes[i]);
        let hidden = hidden(codes.len(), channels, has_alpha, wide);
        (SampleType::Code8, samples, hidden)
    };
    let from_16 = |codes: Vec<u16>| {
        let table = Srgb16::new();
        let light = |(i, &code): (usize, &u16)| {
            if is_alpha(i) {
                f32::from(code) / 65535.0
            } else {
                table.decode(code)
            }
        };
        let samples: Vec<f32> = codes.iter().enumerate().map(light).collect();
        let hidden = hidden(codes.len(), channels, has_alpha, |i| codes[i]);
        (SampleType::Code16, samples, hidden)
    };
    let (sample, samples, hidden) = match decoded {
        DynamicImage::ImageLuma8(p) => from_8(p.into_raw()),
        DynamicImage::ImageLumaA8(p) => from_8(p.into_raw()),
        DynamicImage::ImageRgb8(p) => from_8(p.into_raw()),
        DynamicImage::ImageRgba8(p) => from_8(p.into_raw()),
        DynamicImage::ImageLuma16(p) => from_16(p.into_raw()),
        DynamicImage::ImageLumaA16(p) => from_16(p.into_raw()),
        DynamicImage::ImageRgb16(p) => from_16(p.into_raw()),
        DynamicImage::ImageRgba16(p) => from_16(p.into_raw()),
        DynamicImage::ImageRgb32F(p) => (SampleType::Float32, p.into_raw(), Vec::new()),
        DynamicImage::ImageRgba32F(p) => (SampleType::Float32, p.into_raw(), Vec::new()),
        _ => {
            return Err(ImageError::Unsupported {
                format: "image",
                what: "samples of an unknown type".to_owned(),
                mend: "save it as 8 or 16 bits of grey or RGB",
            });
        }
    };
    let mut raster = Raster::from_samples(window, channels, samples)?;
    if has_alpha {
        premultiply(&mut raster, channels - 1)?;
    }
    kept.hidden = (!hidden.is_empty()).then_some(Hidden {
        window,
        codes: hidden,
    });
    let of = |name: &&str| Channel::new(*name, sample);
    Ok(ImageLayer {
        name: None,
        channels: names(channels).iter().map(of).collect(),
        raster: Some(raster),
        identifiers: None,
    })
}

/// Pixels without coverage that have a colour nevertheless.
fn hidden(
    count: usize,
    channels: usize,
    has_alpha: bool,
    code: impl Fn(usize) -> u16,
) -> Vec<(usize, [u16; 3])> {
    if !has_alpha {
        return Vec::new();
    }
    let colours = channels - 1;
    let of = |pixel: usize| {
        let first = pixel * channels;
        let mut codes = [0; 3];
        for (i, slot) in codes.iter_mut().enumerate().take(colours) {
            *slot = code(first + i);
        }
        (code(first + colours) == 0 && codes != [0; 3]).then_some((pixel, codes))
    };
    (0..count / channels).filter_map(of).collect()
}

/// The samples as a format stores them.
enum Stored {
    Eight(Vec<u8>),
    Sixteen(Vec<u16>),
    Numbers(Vec<f32>),
}

/// How a format stores a picture.
struct Layout {
    sample: SampleType,
    /// Whether grey is written as RGB.
    widen: bool,
    alpha: bool,
}

fn layout(format: ImageFormat, sample: SampleType, grey: bool, alpha: bool) -> Layout {
    let sample = match (format, sample) {
        (ImageFormat::Tiff, SampleType::Half | SampleType::Float32) => SampleType::Float32,
        (ImageFormat::Jpeg | ImageFormat::WebP, _) | (_, SampleType::Code8) => SampleType::Code8,
        _ => SampleType::Code16,
    };
    Layout {
        sample,
        widen: grey && format == ImageFormat::Tiff && alpha,
        alpha: alpha && format != ImageFormat::Jpeg,
    }
}

pub(super) fn encode(
    image: &ImageFile,
    kept: &Kept,
    format: ImageFormat,
    options: &EncodeOptions,
) -> Result<(Vec<u8>, Lost), ImageError> {
    let (Some(layer), mut lost) = (image.layers.first(), Lost::default()) else {
        return Err(ImageError::Empty {
            width: 0,
            height: 0,
        });
    };
    let Some(raster) = &layer.raster else {
        let named: Vec<&str> = layer.channels.iter().map(Channel::name).collect();
        return Err(ImageError::NoColour {
            channels: named.join(", "),
        });
    };
    let sample = layer
        .channels
        .first()
        .map_or(SampleType::Code8, Channel::sample);
    let colours = layer
        .channels
        .iter()
        .filter(|c| c.kind() == ChannelKind::Colour)
        .count();
    let layout = layout(format, sample, colours == 1, layer.has_alpha());
    lost.add(
        layer.has_alpha() && !layout.alpha,
        "alpha (what is transparent is black)",
    );
    lost.add(
        layout.sample != sample && layout.sample != SampleType::Float32,
        format!(
            "samples of {} ({} are written)",
            sample.title(),
            layout.sample.title()
        ),
    );
    if layout.sample != SampleType::Float32
        && matches!(sample, SampleType::Half | SampleType::Float32)
    {
        let outside = raster.samples().iter();
        let outside = outside.filter(|s| !(0.0..=1.0).contains(*s)).count();
        lost.add(
            outside > 0,
            format!("{outside} samples below 0, above 1 or not numbers"),
        );
    }
    let (width, height) = sizes(format, raster.window())?;
    let (stored, channels) = stored(raster, colours, layer.has_alpha(), &layout, kept);
    if let (Stored::Numbers(numbers), 1) = (&stored, channels) {
        lost.add(kept.profile.is_some(), "the colour profile");
        let mut out = Vec::new();
        grey_numbers::write(Cursor::new(&mut out), (width, height), numbers).map_err(|error| {
            ImageError::Cannot {
                format: format.title(),
                what: error.to_string(),
                mend: "choose another format",
            }
        })?;
        return Ok((out, lost));
    }
    let colour = match (channels, layout.sample) {
        (1, SampleType::Code8) => ExtendedColorType::L8,
        (2, SampleType::Code8) => ExtendedColorType::La8,
        (3, SampleType::Code8) => ExtendedColorType::Rgb8,
        (_, SampleType::Code8) => ExtendedColorType::Rgba8,
        (3, SampleType::Float32) => ExtendedColorType::Rgb32F,
        (_, SampleType::Float32) => ExtendedColorType::Rgba32F,
        (1, _) => ExtendedColorType::L16,
        (2, _) => ExtendedColorType::La16,
        (3, _) => ExtendedColorType::Rgb16,
        (_, _) => ExtendedColorType::Rgba16,
    };
    let bytes: Vec<u8> = match stored {
        Stored::Eight(codes) => codes,
        Stored::Sixteen(codes) => codes.iter().flat_map(|c| c.to_ne_bytes()).collect(),
        Stored::Numbers(numbers) => numbers.iter().flat_map(|n| n.to_ne_bytes()).collect(),
    };
    let own_chunks = image.format == ImageFormat::Png && format == ImageFormat::Png;
    let mut out = Vec::new();
    let done = {
        let seekable = Cursor::new(&mut out);
        match format {
            ImageFormat::Png => {
                let encoder = image::codecs::png::PngEncoder::new(seekable);
                let kept = if own_chunks { &Kept::default() } else { kept };
                put(encoder, kept, &mut lost, &bytes, (width, height), colour)
            }
            ImageFormat::Jpeg => {
                let quality = options.quality.clamp(1, 100);
                let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(seekable, quality);
                put(encoder, kept, &mut lost, &bytes, (width, height), colour)
            }
            ImageFormat::WebP => {
                let encoder = image::codecs::webp::WebPEncoder::new_lossless(seekable);
                put(encoder, kept, &mut lost, &bytes, (width, height), colour)
            }
            ImageFormat::Tiff | ImageFormat::OpenExr => {
                let encoder = image::codecs::tiff::TiffEncoder::new(seekable);
                put(encoder, kept, &mut lost, &bytes, (width, height), colour)
            }
        }
    };
    done.map_err(|error| ImageError::Cannot {
        format: format.title(),
        what: error.to_string(),
        mend: "choose another format",
    })?;
    if own_chunks {
        chunks::insert(&mut out, &kept.chunks.copied);
    } else if image.format == ImageFormat::Png {
        lost.add(
            !kept.chunks.copied.is_empty() && kept.profile.is_none(),
            "chunks beside the pixels",
        );
    }
    Ok((out, lost))
}

/// Gives an encoder the profile and the notes of the camera, and the picture.
fn put(
    mut encoder: impl ImageEncoder,
    kept: &Kept,
    lost: &mut Lost,
    bytes: &[u8],
    (width, height): (u32, u32),
    colour: ExtendedColorType,
) -> Result<(), image::ImageError> {
    if let Some(profile) = kept.profile.clone() {
        let done = encoder.set_icc_profile(profile);
        lost.add(done.is_err(), "the colour profile");
    }
    if let Some(exif) = kept.exif.clone() {
        let done = encoder.set_exif_metadata(exif);
        lost.add(done.is_err(), "the Exif notes");
    }
    encoder.write_image(bytes, width, height, colour)
}

/// The size, if the format can hold it.
fn sizes(format: ImageFormat, window: Window) -> Result<(u32, u32), ImageError> {
    let most: u32 = match format {
        ImageFormat::Jpeg => u16::MAX.into(),
        ImageFormat::WebP => 1 << 14,
        _ => i32::MAX as u32,
    };
    let fits = |size: usize| u32::try_from(size).ok().filter(|&size| size <= most);
    match (fits(window.width()), fits(window.height())) {
        (Some(width), Some(height)) => Ok((width, height)),
        _ => Err(ImageError::Cannot {
            format: format.title(),
            what: format!(
                "it has {} × {} pixels, and {most} are the most along a side",
                window.width(),
                window.height()
            ),
            mend: "choose another format",
        }),
    }
}

/// The raster as a format stores it, with the number of channels.
fn stored(
    raster: &Raster,
    colours: usize,
    has_alpha: bool,
    layout: &Layout,
    kept: &Kept,
) -> (Stored, usize) {
    let written = if layout.widen { 3 } else { colours };
    let channels = written + usize::from(layout.alpha);
    let hidden = kept.hidden.as_ref();
    let hidden = hidden.filter(|h| h.window == raster.window() && layout.alpha);
    let mut hidden = hidden.map_or(&[][..], |h| &h.codes).iter().peekable();
    // Colours without coverage, coverage, and what was hidden there.
    let mut each = |out: &mut dyn FnMut([f32; 3], f32, Option<[u16; 3]>)| {
        for (number, pixel) in raster.samples().chunks_exact(raster.channels()).enumerate() {
            let covered = if has_alpha && layout.alpha {
                pixel[colours]
            } else {
                1.0
            };
            let mut own = None;
            while let Some((_, codes)) = hidden.next_if(|(place, _)| *place <= number) {
                own = Some(*codes);
            }
            let mut light = [0.0; 3];
            for (slot, &sample) in light.iter_mut().zip(&pixel[..colours]) {
                *slot = match layout.sample {
                    // Light without coverage is kept by numbers, which can hold it.
                    _ if covered == 1.0 => sample,
                    SampleType::Float32 if covered == 0.0 => sample,
                    _ if covered > 0.0 => sample / covered,
                    SampleType::Float32 => sample / covered,
                    _ => 0.0,
                };
            }
            out(light, covered, own.filter(|_| covered == 0.0));
        }
    };
    let room = raster.samples().len() / raster.channels() * channels;
    let which = |channel: usize| if layout.widen { 0 } else { channel };
    let level = |alpha: f32, most: f32| {
        // False for what is not a number.
        if alpha > 0.0 {
            (alpha.min(1.0) * most + 0.5) as u16
        } else {
            0
        }
    };
    let stored = match layout.sample {
        SampleType::Code8 => {
            let table = Srgb8::new();
            let mut codes = Vec::with_capacity(room);
            each(&mut |light, covered, own| {
                for channel in (0..written).map(which) {
                    codes.push(own.map_or_else(
                        || table.encode(light[channel]),
                        |own| own[channel].min(255) as u8,
                    ));
                }
                if layout.alpha {
                    codes.push(level(covered, 255.0) as u8);
                }
            });
            Stored::Eight(codes)
        }
        SampleType::Float32 => {
            let mut numbers = Vec::with_capacity(room);
            each(&mut |light, covered, _| {
                numbers.extend((0..written).map(|channel| light[which(channel)]));
                numbers.extend(layout.alpha.then_some(covered));
            });
            Stored::Numbers(numbers)
        }
        _ => {
            let table = Srgb16::new();
            let mut codes = Vec::with_capacity(room);
            each(&mut |light, covered, own| {
                for channel in (0..written).map(which) {
                    codes
                        .push(own.map_or_else(|| table.encode(light[channel]), |own| own[channel]));
                }
                if layout.alpha {
                    codes.push(level(covered, 65535.0));
                }
            });
            Stored::Sixteen(codes)
        }
    };
    (stored, channels)
}
