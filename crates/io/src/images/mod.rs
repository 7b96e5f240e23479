//! Pixel images: PNG, JPEG, TIFF, WebP and OpenEXR.
//!
//! Reading gives an [`ImageFile`]: layers, each an [`anamorph_raster::Raster`] in linear light, premultiplied where there is
//! alpha, with what else the file holds. The rasters can be replaced; encoding gives the file with the new pixels. Pixels
//! that have not changed come out as they were, code by code in files of 8 and 16 bits and sample by sample in
//! OpenEXR, unless the compression itself loses something (JPEG; B44 and DWA in OpenEXR).
//!
//! Codes of 8 and 16 bits are sRGB (IEC 61966-2-1), alpha is not; 32-bit numbers are linear light. An embedded colour
//! profile is kept and not applied.
//!
//! Memory is bounded before anything is decoded: see [`ImageLimits`].
//!
//! *Source*: ISO/IEC 15948 (PNG); ITU-T T.81 (JPEG); Adobe, *TIFF 6.0*; RFC 9649 (WebP); Academy Software Foundation,
//! *OpenEXR file layout*. Bytes are read and written by the crates `image` and `exr`.

mod arrange;
mod channel;
mod chunks;
mod codes;
mod convert;
mod error;
mod grey_numbers;
mod light;
mod openexr;
mod y4m;

pub use channel::{Channel, ChannelKind, SampleType};
pub use error::ImageError;
pub use y4m::Y4m;

use crate::Lost;
use anamorph_raster::{Raster, Window};
use std::borrow::Cow;

/// A format of images.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ImageFormat {
    /// Portable Network Graphics.
    Png,
    /// JPEG.
    Jpeg,
    /// Tagged Image File Format.
    Tiff,
    /// WebP; written without loss.
    WebP,
    /// OpenEXR.
    OpenExr,
}

impl ImageFormat {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Png, Self::Jpeg, Self::Tiff, Self::WebP, Self::OpenExr];

    /// Its short name: the usual extension.
    pub fn name(self) -> &'static str {
        self.extensions()[0]
    }
    /// What it is called in prose.
    pub fn title(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
            Self::Tiff => "TIFF",
            Self::WebP => "WebP",
            Self::OpenExr => "OpenEXR",
        }
    }
    /// Extensions of such files, in lower case, without the point.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Png => &["png"],
            Self::Jpeg => &["jpg", "jpeg"],
            Self::Tiff => &["tif", "tiff"],
            Self::WebP => &["webp"],
            Self::OpenExr => &["exr"],
        }
    }
    /// The format of that extension, in any case.
    pub fn of_extension(extension: &str) -> Option<Self> {
        let extension = extension.to_ascii_lowercase();
        let mut all = Self::ALL.into_iter();
        all.find(|format| format.extensions().contains(&extension.as_str()))
    }
    /// The format of a file that begins with `head`, by its first bytes; 12 of them suffice.
    pub fn of_content(head: &[u8]) -> Option<Self> {
        let begins = |magic: &[u8]| head.starts_with(magic);
        if begins(b"\x89PNG\r\n\x1a\n") {
            Some(Self::Png)
        } else if begins(b"\xff\xd8\xff") {
            Some(Self::Jpeg)
        } else if begins(b"II*\0") || begins(b"MM\0*") || begins(b"II+\0") || begins(b"MM\0+") {
            Some(Self::Tiff)
        } else if begins(b"RIFF") && head.get(8..12) == Some(b"WEBP") {
            Some(Self::WebP)
        } else if begins(&[0x76, 0x2f, 0x31, 0x01]) {
            Some(Self::OpenExr)
        } else {
            None
        }
    }
    /// Whether its pixels survive being written.
    pub fn is_lossless(self) -> bool {
        self != Self::Jpeg
    }
}

/// How many samples (numbers, over all pixels, channels and layers) may be read from a file. Reading takes at most about 16 bytes
/// for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ImageLimits {
    /// The most samples.
    pub samples: u64,
}

impl ImageLimits {
    /// Samples that any file may have: 2²⁶, 4096 × 4096 pixels of four channels.
    pub const SMALL: u64 = 1 << 26;
    /// Samples that a file may have beyond those for each of its bytes.
    pub const PER_BYTE: u64 = 64;

    /// The limit for a file of so many bytes: [`ImageLimits::SMALL`] and [`ImageLimits::PER_BYTE`] more for each byte. Photographs
    /// and renderings have a few samples a byte; what claims more than this is large and next to empty, or a trap.
    pub fn of_file(bytes: usize) -> Self {
        Self {
            samples: (bytes as u64)
                .saturating_mul(Self::PER_BYTE)
                .saturating_add(Self::SMALL),
        }
    }
    /// No limit but the machine's memory.
    pub const NONE: Self = Self { samples: u64::MAX };

    fn check(self, width: u64, height: u64, channels: u64) -> Result<u64, ImageError> {
        let samples = width.saturating_mul(height).saturating_mul(channels);
        // Where memory ends, whatever is allowed: one vector of 4-byte numbers.
        let most = self.samples.min(isize::MAX as u64 / 16);
        if width == 0 || height == 0 {
            return Err(ImageError::Empty { width, height });
        }
        if samples > most {
            return Err(ImageError::TooLarge {
                width,
                height,
                channels,
                most,
            });
        }
        Ok(samples)
    }
}

/// One layer of an image.
#[derive(Debug, Clone)]
pub struct ImageLayer {
    name: Option<String>,
    channels: Vec<Channel>,
    /// The pixels of all channels that are not [`SampleType::Integer32`], in the order of [`ImageLayer::channels`]: linear light, premultiplied where there is
    /// an alpha channel. None if there are no such channels.
    pub raster: Option<Raster>,
    /// The channels of whole 32-bit numbers, which tell things apart and must not be mixed: two numbers for each, the
    /// upper and the lower 16 bits. None if there are no such channels.
    pub identifiers: Option<Raster>,
}

impl ImageLayer {
    /// Its name, in files that name layers.
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }
    /// Its channels, in the file's order.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }
    /// Whether it has an alpha channel.
    pub fn has_alpha(&self) -> bool {
        self.channels.iter().any(|c| c.kind() == ChannelKind::Alpha)
    }
    /// The pixels it has data for.
    pub fn window(&self) -> Option<Window> {
        let rasters = [&self.raster, &self.identifiers];
        rasters.into_iter().flatten().map(Raster::window).next()
    }
    /// The channels that the raster holds.
    fn mixed(&self) -> impl Iterator<Item = &Channel> {
        let is_mixed = |c: &&Channel| c.sample() != SampleType::Integer32;
        self.channels.iter().filter(is_mixed)
    }
}

/// What a format keeps beside the pixels.
#[derive(Debug, Clone)]
enum Kept {
    Codes(codes::Kept),
    OpenExr(Box<openexr::Kept>),
}

/// An image: its layers, and what else its file holds.
#[derive(Debug, Clone)]
pub struct ImageFile {
    format: ImageFormat,
    display: Window,
    layers: Vec<ImageLayer>,
    notes: Vec<String>,
    kept: Kept,
}

impl ImageFile {
    /// Reads an image, its format found by its content.
    ///
    /// # Errors
    /// [`ImageError`]: what is wrong, and how to mend it.
    pub fn read(bytes: &[u8], limits: ImageLimits) -> Result<Self, ImageError> {
        match ImageFormat::of_content(bytes) {
            None => Err(ImageError::UnknownFormat),
            Some(ImageFormat::OpenExr) => openexr::read(bytes, limits),
            Some(format) => codes::read(format, bytes, limits),
        }
    }

    /// A new OpenEXR image of one layer of 32-bit channels, with the raster's windows.
    ///
    /// # Errors
    /// [`ImageError::Mismatch`] where the raster has more or fewer channels than names are given.
    pub fn data(raster: &Raster, channels: &[&str]) -> Result<Self, ImageError> {
        let of = |name: &&str| Channel::new(*name, SampleType::Float32);
        let channels: Vec<Channel> = channels.iter().map(of).collect();
        openexr::created(raster, channels)
    }

    /// The format it was read from.
    pub fn format(&self) -> ImageFormat {
        self.format
    }
    /// What a viewer shows; in formats that know no such thing, all pixels.
    pub fn display(&self) -> Window {
        self.display
    }
    /// Changes what a viewer shows; the pixels stay as they are.
    ///
    /// # Errors
    /// [`ImageError::Cannot`] for a window beyond what OpenEXR can say.
    pub fn set_display(&mut self, display: Window) -> Result<(), ImageError> {
        if let Kept::OpenExr(kept) = &mut self.kept {
            kept.set_display(display)?;
        }
        self.display = display;
        for layer in &mut self.layers {
            for raster in [&mut layer.raster, &mut layer.identifiers] {
                *raster = raster.take().map(|raster| raster.with_display(display));
            }
        }
        Ok(())
    }
    /// The layers; at least one.
    pub fn layers(&self) -> &[ImageLayer] {
        &self.layers
    }
    /// The layers, to give them new pixels. Windows may change, numbers of channels may not.
    pub fn layers_mut(&mut self) -> &mut [ImageLayer] {
        &mut self.layers
    }
    /// What the file holds that is neither read nor kept, in words.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }
    /// How the samples of a layer are packed, in OpenEXR, whose layers differ in it; none in other formats.
    pub fn compression(&self, layer: usize) -> Option<String> {
        match &self.kept {
            Kept::OpenExr(kept) => kept.compression(layer),
            Kept::Codes(_) => None,
        }
    }
    /// Whether a colour profile is embedded.
    pub fn has_profile(&self) -> bool {
        matches!(&self.kept, Kept::Codes(kept) if kept.profile.is_some())
    }
    /// Whether any layer has alpha.
    pub fn has_alpha(&self) -> bool {
        self.layers.iter().any(ImageLayer::has_alpha)
    }

    /// Everything but the pixels: to be given others.
    #[must_use]
    pub fn without_pixels(&self) -> Self {
        let empty = |layer: &ImageLayer| ImageLayer {
            name: layer.name.clone(),
            channels: layer.channels.clone(),
            raster: None,
            identifiers: None,
        };
        Self {
            format: self.format,
            display: self.display,
            layers: self.layers.iter().map(empty).collect(),
            notes: self.notes.clone(),
            kept: self.kept.clone(),
        }
    }

    /// What is seen: the colours within the display window as grey, grey and alpha, RGB, or RGB and alpha, by the number of channels;
    /// linear light, premultiplied.
    ///
    /// # Errors
    /// [`ImageError::NoColour`] for data without colours.
    pub fn colours(&self) -> Result<Cow<'_, Raster>, ImageError> {
        let only = self.layers.first().and_then(|layer| layer.raster.as_ref());
        if let (Kept::Codes(_), Some(raster)) = (&self.kept, only) {
            return Ok(Cow::Borrowed(raster));
        }
        let (mut image, _, _) = convert::to_codes(self, false)?;
        let raster = image.layers.pop().and_then(|layer| layer.raster);
        raster.map(Cow::Owned).ok_or(ImageError::Empty {
            width: 0,
            height: 0,
        })
    }

    /// The file in its own format, or converted to another; with what it cannot hold there. Formats without a display window
    /// hold the display window's pixels, or those of the data window of the layer with colours if `whole`.
    ///
    /// # Errors
    /// [`ImageError::Mismatch`] where a layer has got another number of channels; [`ImageError::NoColour`] for a
    /// conversion of data without colours; [`ImageError::Cannot`] where the format cannot hold the picture.
    pub fn encode(
        &self,
        format: ImageFormat,
        options: &EncodeOptions,
    ) -> Result<(Vec<u8>, Lost), ImageError> {
        for layer in &self.layers {
            layer.check()?;
        }
        match (&self.kept, format) {
            (Kept::OpenExr(kept), ImageFormat::OpenExr) => openexr::encode(self, kept),
            (Kept::Codes(kept), ImageFormat::OpenExr) => convert::to_openexr(self, kept),
            (Kept::Codes(kept), format) => codes::encode(self, kept, format, options),
            (Kept::OpenExr(_), format) => {
                let (image, kept, mut lost) = convert::to_codes(self, options.whole)?;
                let (bytes, more) = codes::encode(&image, &kept, format, options)?;
                lost.0.extend(more.0);
                Ok((bytes, lost))
            }
        }
    }
}

impl ImageLayer {
    /// Refuses rasters that do not fit the channels.
    fn check(&self) -> Result<(), ImageError> {
        let mixed = self.mixed().count();
        let pairs = [
            (&self.raster, mixed),
            (&self.identifiers, 2 * (self.channels.len() - mixed)),
        ];
        for (raster, needed) in pairs {
            let found = raster.as_ref().map_or(0, Raster::channels);
            if found != needed {
                return Err(ImageError::Mismatch { found, needed });
            }
        }
        match (&self.raster, &self.identifiers) {
            (Some(a), Some(b)) if a.window() != b.window() => {
                Err(ImageError::Raster(anamorph_raster::RasterError::Windows {
                    first: a.window(),
                    second: b.window(),
                }))
            }
            _ => Ok(()),
        }
    }
}

/// How an image is encoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EncodeOptions {
    /// Quality of JPEG files, 1 to 100.
    pub quality: u8,
    /// Formats without a display window hold the whole data window.
    pub whole: bool,
}

impl Default for EncodeOptions {
    /// Quality 95, the display window.
    fn default() -> Self {
        Self {
            quality: 95,
            whole: false,
        }
    }
}
