//! OpenEXR: layers of any channels, with windows and attributes.

use super::{
    Channel, ImageError, ImageFile, ImageFormat, ImageLayer, ImageLimits, Kept as AnyKept,
    SampleType,
};
use crate::Lost;
use anamorph_raster::{Raster, Window};
use exr::image::Blocks;
use exr::meta::attribute::{LevelMode, LineOrder};
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image, ImageAttributes,
    IntegerBounds, Layer, LayerAttributes, Layers, ReadChannels, ReadLayers, Text, Vec2,
    WritableImage, f16, read as reading,
};
use std::io::Cursor;
use std::ops::Range;

type Exr = Image<Layers<AnyChannels<FlatSamples>>>;

/// The file without its samples.
#[derive(Debug, Clone)]
pub(super) struct Kept(Exr);

impl Kept {
    /// Changes what a viewer shows.
    pub(super) fn set_display(&mut self, display: Window) -> Result<(), ImageError> {
        self.0.attributes.display_window = bounds(display)?;
        Ok(())
    }
    /// Changes the channels of a layer; those that stay keep what is said about them.
    pub(super) fn set_channels(
        &mut self,
        layer: usize,
        channels: &[Channel],
    ) -> Result<(), ImageError> {
        let Some(layer) = self.0.layer_data.get_mut(layer) else {
            return Ok(());
        };
        let old = std::mem::take(&mut layer.channel_data.list);
        let one = |channel: &Channel| {
            let known = old.iter().find(|c| c.name.eq(channel.name()));
            known.cloned().map_or_else(|| empty(channel), Ok)
        };
        layer.channel_data.list = channels.iter().map(one).collect::<Result<_, _>>()?;
        Ok(())
    }
    /// What packs the samples of a layer.
    pub(super) fn compression(&self, layer: usize) -> Option<String> {
        let layer = self.0.layer_data.get(layer)?;
        Some(layer.encoding.compression.to_string())
    }
}

fn failed(error: exr::error::Error) -> ImageError {
    let format = ImageFormat::OpenExr.title();
    match error {
        exr::error::Error::NotSupported(what) => ImageError::Unsupported {
            format,
            what: what.into_owned(),
            mend: "save it as scan lines or tiles of whole channels",
        },
        error => ImageError::Damaged {
            format,
            what: error.to_string(),
        },
    }
}

fn unsupported(what: impl Into<String>, mend: &'static str) -> ImageError {
    ImageError::Unsupported {
        format: ImageFormat::OpenExr.title(),
        what: what.into(),
        mend,
    }
}

fn window_of(position: Vec2<i32>, size: Vec2<usize>) -> Result<Window, ImageError> {
    let (x, y) = (position.x().into(), position.y().into());
    Ok(Window::new(x, y, size.x(), size.y())?)
}

/// Looks at the headers before anything is decoded; gives what is to be said about them.
fn check(bytes: &[u8], limits: ImageLimits) -> Result<Vec<String>, ImageError> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(failed)?;
    let mut notes = Vec::new();
    let mut samples = 0_u64;
    for header in &meta.headers {
        if header.deep {
            return Err(unsupported("deep data", "flatten it"));
        }
        let channels = &header.channels.list;
        if channels.iter().any(|c| c.sampling != Vec2(1, 1)) {
            return Err(unsupported(
                "channels of lower resolution (luminance and chroma)",
                "save it as RGB",
            ));
        }
        let (width, height) = (header.layer_size.x() as u64, header.layer_size.y() as u64);
        let own = limits.check(width, height, channels.len() as u64)?;
        samples = samples.saturating_add(own);
        limits.check(1, samples.max(1), 1)?;
        if let BlockDescription::Tiles(tiles) = &header.blocks {
            // A tile is decoded as a whole, however small the picture is.
            let tile = (tiles.tile_size.x() as u64, tiles.tile_size.y() as u64);
            limits.check(tile.0.min(width), tile.1.min(height), channels.len() as u64)?;
            if tiles.level_mode != LevelMode::Singular {
                notes.push("of the levels of resolution only the largest is kept".to_owned());
            }
        }
    }
    notes.dedup();
    Ok(notes)
}

pub(super) fn read(bytes: &[u8], limits: ImageLimits) -> Result<ImageFile, ImageError> {
    let mut notes = check(bytes, limits)?;
    let reader = reading()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes();
    #[cfg(not(feature = "parallel"))]
    let reader = reader.non_parallel();
    let mut image: Exr = reader.from_buffered(Cursor::new(bytes)).map_err(failed)?;
    let bounds = image.attributes.display_window;
    let display = window_of(bounds.position, bounds.size)?;
    let mut layers = Vec::new();
    for layer in &mut image.layer_data {
        layers.push(read_layer(layer, display)?);
        if matches!(
            layer.encoding.compression,
            Compression::B44 | Compression::B44A
        ) {
            notes.push("the compression, B44, loses something each time".to_owned());
        }
        if matches!(
            layer.encoding.compression,
            Compression::DWAA(_) | Compression::DWAB(_)
        ) {
            notes.push("the compression, DWA, loses something each time".to_owned());
        }
    }
    notes.dedup();
    Ok(ImageFile {
        format: ImageFormat::OpenExr,
        display,
        layers,
        notes,
        kept: AnyKept::OpenExr(Box::new(Kept(image))),
    })
}

/// A layer's pixels; takes its samples away.
fn read_layer(
    layer: &mut Layer<AnyChannels<FlatSamples>>,
    display: Window,
) -> Result<ImageLayer, ImageError> {
    let window = window_of(layer.attributes.layer_position, layer.size)?;
    let list = &mut layer.channel_data.list;
    let whole = |c: &AnyChannel<FlatSamples>| matches!(c.sample_data, FlatSamples::U32(_));
    let wholes = list.iter().filter(|c| whole(c)).count();
    let mixed = list.len() - wholes;
    let raster = |channels: usize| -> Result<Option<Raster>, ImageError> {
        if channels == 0 {
            return Ok(None);
        }
        Ok(Some(Raster::new(window, channels)?.with_display(display)))
    };
    let (mut numbers, mut identifiers) = (raster(mixed)?, raster(2 * wholes)?);
    let mut channels = Vec::new();
    let (mut mixed, mut whole) = (Vec::new(), Vec::new());
    for channel in list.iter_mut() {
        let none = FlatSamples::F32(Vec::new());
        let samples = std::mem::replace(&mut channel.sample_data, none);
        let sample = match &samples {
            FlatSamples::F16(_) => SampleType::Half,
            FlatSamples::F32(_) => SampleType::Float32,
            FlatSamples::U32(_) => SampleType::Integer32,
        };
        if sample == SampleType::Integer32 {
            whole.push(samples);
        } else {
            mixed.push(samples);
        }
        channels.push(Channel::new(channel.name.to_string(), sample));
    }
    interleave(numbers.as_mut(), &mixed);
    interleave(identifiers.as_mut(), &whole);
    Ok(ImageLayer {
        name: layer.attributes.layer_name.as_ref().map(Text::to_string),
        channels,
        raster: numbers,
        identifiers,
    })
}

/// Pixels that a task reads or writes at a time: few enough for a cache, with all their channels.
const PIXELS: usize = 4096;

/// Writes one channel of some pixels.
fn fill(out: &mut [f32], channels: usize, channel: usize, values: impl Iterator<Item = f32>) {
    for (pixel, value) in out.chunks_exact_mut(channels).zip(values) {
        pixel[channel] = value;
    }
}

/// The part of a channel that belongs to some pixels.
fn of<'a, T>(values: &'a [T], part: &Range<usize>) -> &'a [T] {
    values.get(part.clone()).unwrap_or_default()
}

/// Puts channels side by side, whole numbers as two each. Every task fills some pixels with all their channels, so that memory is gone
/// through once.
fn interleave(raster: Option<&mut Raster>, sources: &[FlatSamples]) {
    let Some(raster) = raster else { return };
    let channels = raster.channels();
    let has_halves = sources.iter().any(|s| matches!(s, FlatSamples::F16(_)));
    // All halves as numbers: looked up faster than converted one by one.
    let halves: Vec<f32> = if has_halves {
        (0..=u16::MAX)
            .map(|bits| f16::from_bits(bits).to_f32())
            .collect()
    } else {
        Vec::new()
    };
    chunks(raster.samples_mut(), PIXELS * channels, |number, out| {
        let start = number * PIXELS;
        let part = start..start + out.len() / channels;
        let mut at = 0;
        for source in sources {
            match source {
                FlatSamples::F16(values) => {
                    let number = |h: &f16| halves.get(usize::from(h.to_bits())).copied();
                    let number = |h: &f16| number(h).unwrap_or(f32::NAN);
                    fill(out, channels, at, of(values, &part).iter().map(number));
                    at += 1;
                }
                FlatSamples::F32(values) => {
                    fill(out, channels, at, of(values, &part).iter().copied());
                    at += 1;
                }
                FlatSamples::U32(values) => {
                    for shift in [16, 0] {
                        let half = |v: &u32| (v >> shift & 0xffff) as f32;
                        fill(out, channels, at, of(values, &part).iter().map(half));
                        at += 1;
                    }
                }
            }
        }
    });
}

/// Calls `body(number, chunk)` for consecutive chunks of `size` elements, on all cores where that is asked for.
fn chunks<T: Send>(data: &mut [T], size: usize, body: impl Fn(usize, &mut [T]) + Sync + Send) {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        data.par_chunks_mut(size)
            .enumerate()
            .for_each(|(number, chunk)| body(number, chunk));
    }
    #[cfg(not(feature = "parallel"))]
    for (number, chunk) in data.chunks_mut(size).enumerate() {
        body(number, chunk);
    }
}

/// A number for each pixel, from its channels.
fn picked<T: Clone + Send>(
    raster: Option<&Raster>,
    none: T,
    pick: impl Fn(&[f32]) -> T + Sync + Send,
) -> Vec<T> {
    let Some(raster) = raster else {
        return Vec::new();
    };
    let channels = raster.channels();
    let mut all = vec![none; raster.samples().len() / channels];
    chunks(&mut all, PIXELS, |number, out| {
        let pixels = raster.samples()[number * PIXELS * channels..].chunks_exact(channels);
        for (out, pixel) in out.iter_mut().zip(pixels) {
            *out = pick(pixel);
        }
    });
    all
}

/// Puts one channel among the others.
fn spread(raster: Option<&mut Raster>, channel: usize, values: impl Iterator<Item = f32>) {
    let Some(raster) = raster else { return };
    let channels = raster.channels();
    let slots = raster.samples_mut().iter_mut().skip(channel);
    for (slot, value) in slots.step_by(channels).zip(values) {
        *slot = value;
    }
}

/// One channel of a raster.
fn gather(raster: Option<&Raster>, channel: usize) -> impl Iterator<Item = f32> {
    let (samples, channels) = raster.map_or((&[][..], 1), |r| (r.samples(), r.channels()));
    samples.iter().skip(channel).step_by(channels).copied()
}

/// The nearest half; finite numbers stay finite.
fn to_half(value: f32) -> f16 {
    if value.is_finite() {
        let most = f16::MAX.to_f32();
        f16::from_f32(value.clamp(-most, most))
    } else {
        f16::from_f32(value)
    }
}

fn samples(layer: &ImageLayer) -> Vec<FlatSamples> {
    let (numbers, identifiers) = (layer.raster.as_ref(), layer.identifiers.as_ref());
    let (mut at, mut at_whole) = (0, 0);
    let mut all = Vec::new();
    for channel in &layer.channels {
        if channel.sample() == SampleType::Integer32 {
            let (high, low) = (2 * at_whole, 2 * at_whole + 1);
            let whole = |p: &[f32]| (p[high] as u32) << 16 | (p[low] as u32) & 0xffff;
            all.push(FlatSamples::U32(picked(identifiers, 0, whole)));
            at_whole += 1;
            continue;
        }
        let own = at;
        at += 1;
        all.push(match channel.sample() {
            SampleType::Half | SampleType::Code8 => {
                FlatSamples::F16(picked(numbers, f16::ZERO, |p| to_half(p[own])))
            }
            _ => FlatSamples::F32(picked(numbers, 0.0, |p| p[own])),
        });
    }
    all
}

/// A window as OpenEXR holds it.
fn bounds(window: Window) -> Result<IntegerBounds, ImageError> {
    let corner = |at: i64| i32::try_from(at).ok();
    let end = |at: i64, size: usize| corner(at.saturating_add_unsigned(size as u64));
    let far = || ImageError::Cannot {
        format: ImageFormat::OpenExr.title(),
        what: format!("the window of {window} reaches beyond ±2³¹"),
        mend: "keep the result near the picture",
    };
    let (Some(x), Some(y)) = (corner(window.x()), corner(window.y())) else {
        return Err(far());
    };
    if end(window.x(), window.width()).is_none() || end(window.y(), window.height()).is_none() {
        return Err(far());
    }
    let size = Vec2(window.width(), window.height());
    Ok(IntegerBounds::new(Vec2(x, y), size))
}

pub(super) fn encode(image: &ImageFile, kept: &Kept) -> Result<(Vec<u8>, Lost), ImageError> {
    let mut file = kept.0.clone();
    let mut lost = Lost::default();
    for (layer, new) in file.layer_data.iter_mut().zip(&image.layers) {
        if let Some(window) = new.window() {
            let bounds = bounds(window)?;
            layer.attributes.layer_position = bounds.position;
            layer.size = bounds.size;
        }
        let channels = layer.channel_data.list.iter_mut();
        for (channel, samples) in channels.zip(samples(new)) {
            channel.sample_data = samples;
        }
    }
    let write = |file: &Exr| -> Result<Vec<u8>, exr::error::Error> {
        let mut out = Vec::new();
        let writer = file.write();
        #[cfg(not(feature = "parallel"))]
        let writer = writer.non_parallel();
        writer.to_buffered(Cursor::new(&mut out))?;
        Ok(out)
    };
    match write(&file) {
        Ok(bytes) => Ok((bytes, lost)),
        // Some compressions can be read and not written.
        Err(exr::error::Error::NotSupported(_)) => {
            for layer in &mut file.layer_data {
                let old = layer.encoding.compression;
                layer.encoding.compression = Compression::ZIP16;
                lost.add(
                    old != Compression::ZIP16,
                    format!("the compression {old} (now ZIP)"),
                );
            }
            lost.0.dedup();
            let bytes = write(&file).map_err(|error| cannot(&error))?;
            Ok((bytes, lost))
        }
        Err(error) => Err(cannot(&error)),
    }
}

fn cannot(error: &exr::error::Error) -> ImageError {
    ImageError::Cannot {
        format: ImageFormat::OpenExr.title(),
        what: error.to_string(),
        mend: "choose another format",
    }
}

/// A channel without its samples.
fn empty(channel: &Channel) -> Result<AnyChannel<FlatSamples>, ImageError> {
    let name = Text::new_or_none(channel.name()).ok_or_else(|| ImageError::Cannot {
        format: ImageFormat::OpenExr.title(),
        what: format!("{:?} cannot be the name of a channel", channel.name()),
        mend: "use letters and points",
    })?;
    Ok(AnyChannel::new(name, FlatSamples::F32(Vec::new())))
}

/// A new file of one layer.
pub(super) fn created(
    raster: &Raster,
    mut channels: Vec<Channel>,
) -> Result<ImageFile, ImageError> {
    if raster.channels() != channels.len() {
        return Err(ImageError::Mismatch {
            found: raster.channels(),
            needed: channels.len(),
        });
    }
    // Channels are in the order of their names.
    let mut order: Vec<usize> = (0..channels.len()).collect();
    order.sort_by(|&a, &b| channels[a].name().cmp(channels[b].name()));
    let (window, display) = (raster.window(), raster.display());
    let mut sorted = Raster::new(window, channels.len())?.with_display(display);
    for (to, &from) in order.iter().enumerate() {
        spread(Some(&mut sorted), to, gather(Some(raster), from));
    }
    channels.sort_by(|a, b| a.name().cmp(b.name()));
    let list = channels
        .iter()
        .map(empty)
        .collect::<Result<_, ImageError>>()?;
    let bounds_of_data = bounds(window)?;
    let layer = Layer {
        channel_data: AnyChannels { list },
        attributes: LayerAttributes {
            layer_position: bounds_of_data.position,
            ..LayerAttributes::default()
        },
        size: bounds_of_data.size,
        encoding: Encoding {
            compression: Compression::ZIP16,
            blocks: Blocks::ScanLines,
            line_order: LineOrder::Increasing,
        },
    };
    let mut layers = Layers::new();
    layers.push(layer);
    let file = Image {
        attributes: ImageAttributes::new(bounds(display)?),
        layer_data: layers,
    };
    let layer = ImageLayer {
        name: None,
        channels,
        raster: Some(sorted),
        identifiers: None,
    };
    Ok(ImageFile {
        format: ImageFormat::OpenExr,
        display,
        layers: vec![layer],
        notes: Vec::new(),
        kept: AnyKept::OpenExr(Box::new(Kept(file))),
    })
}
