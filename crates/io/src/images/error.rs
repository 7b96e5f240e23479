//! What can be wrong with images.

use anamorph_raster::RasterError;

/// Why an image could not be read or written: what is wrong, and how to mend it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The first bytes are of no format of images.
    #[error("no image that can be read; give a PNG, JPEG, TIFF, WebP or OpenEXR file")]
    UnknownFormat,
    /// An image without pixels.
    #[error("the image has {width} × {height} pixels, so none; export it again with pixels")]
    Empty {
        /// Pixels across.
        width: u64,
        /// Pixels down.
        height: u64,
    },
    /// More samples than the file's size can account for, or than are allowed.
    #[error(
        "the file claims {width} × {height} pixels of {channels} numbers, and at most {most} numbers are read from a file of its \
         size; if it is sound, allow large images"
    )]
    TooLarge {
        /// Pixels across.
        width: u64,
        /// Pixels down, of all layers.
        height: u64,
        /// Numbers a pixel.
        channels: u64,
        /// How many numbers are allowed.
        most: u64,
    },
    /// The file breaks the rules of its format.
    #[error("the {format} file is damaged: {what}; export it again")]
    Damaged {
        /// The format, in prose.
        format: &'static str,
        /// What is wrong, in the decoder's words.
        what: String,
    },
    /// Something of the format that is not built.
    #[error("the {format} file has {what}, which is not supported; {mend}")]
    Unsupported {
        /// The format, in prose.
        format: &'static str,
        /// What it has.
        what: String,
        /// How to mend it.
        mend: &'static str,
    },
    /// A raster that does not fit its layer's channels.
    #[error("a layer got {found} numbers a pixel, and its channels need {needed}")]
    Mismatch {
        /// Numbers given.
        found: usize,
        /// Numbers needed.
        needed: usize,
    },
    /// A conversion of an image without colours.
    #[error(
        "the image has no channel R, G, B or Y, only {channels}; write it as OpenEXR, which holds any channels"
    )]
    NoColour {
        /// The channels there are.
        channels: String,
    },
    /// A channel that is asked for and can be made from no other.
    #[error(
        "the image has no channel {name}, only {channels}; give it one, or leave {name} out of the others"
    )]
    NoChannel {
        /// The channel.
        name: String,
        /// The channels there are.
        channels: String,
    },
    /// A format cannot hold the picture.
    #[error("{format} cannot hold the picture: {what}; {mend}")]
    Cannot {
        /// The format, in prose.
        format: &'static str,
        /// Why not.
        what: String,
        /// How to mend it.
        mend: &'static str,
    },
    /// Windows or memory.
    #[error(transparent)]
    Raster(#[from] RasterError),
}
