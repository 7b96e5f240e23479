//! What can be wrong with rasters and their parameters.

use crate::Window;

/// Why a raster could not be made, read or mixed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RasterError {
    /// A window without pixels.
    #[error("a window of {width} × {height} pixels has no pixels; both sides must be at least 1")]
    Empty {
        /// Pixels across.
        width: usize,
        /// Pixels down.
        height: usize,
    },
    /// A raster without channels.
    #[error("a raster needs at least 1 channel")]
    NoChannels,
    /// A window that reaches where pixel centres are no longer exact.
    #[error(
        "the window of {width} × {height} pixels at ({x}, {y}) reaches beyond ±2⁵⁰, where positions between pixels are no \
         longer told apart; move it nearer to the origin"
    )]
    Far {
        /// Left column.
        x: i64,
        /// Top row.
        y: i64,
        /// Pixels across.
        width: usize,
        /// Pixels down.
        height: usize,
    },
    /// More samples than can be counted or stored.
    #[error(
        "{width} × {height} pixels of {channels} numbers are more than this machine can hold; crop, or work on parts"
    )]
    TooLarge {
        /// Pixels across.
        width: usize,
        /// Pixels down.
        height: usize,
        /// Numbers a pixel.
        channels: usize,
    },
    /// A run of samples or positions whose length does not fit its window.
    #[error("{found} {what} given, and {window} with {channels} a pixel needs {needed}")]
    Length {
        /// What was given.
        what: &'static str,
        /// How many were given.
        found: usize,
        /// How many are needed.
        needed: usize,
        /// Where they belong.
        window: Window,
        /// How many make a pixel.
        channels: usize,
    },
    /// Two rasters that should cover the same pixels and do not.
    #[error("one covers {first}, the other {second}; crop or resample one to the other's window")]
    Windows {
        /// The first window.
        first: Window,
        /// The second.
        second: Window,
    },
    /// Two rasters that should have the same channels and do not.
    #[error("one has {first} channels, the other {second}; they must have the same")]
    Channels {
        /// Channels of the first.
        first: usize,
        /// Channels of the second.
        second: usize,
    },
    /// A channel that a raster does not have.
    #[error("channel {channel} is asked for, and the raster has {channels} (counted from 0)")]
    NoChannel {
        /// The channel asked for.
        channel: usize,
        /// How many there are.
        channels: usize,
    },
    /// A name that no filter or edge has.
    #[error("no {what} is called `{name}`; there are {known}")]
    UnknownName {
        /// What was looked for.
        what: &'static str,
        /// The name given.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A parameter outside its range.
    #[error("`{name}` is {value}, and must be {range}")]
    OutOfRange {
        /// The parameter.
        name: &'static str,
        /// The number given.
        value: f64,
        /// The range, in words.
        range: &'static str,
    },
    /// A map by index was asked for at places that have none.
    #[error(
        "the deformation reads one model's indices and has no value between its pixels; {mend}"
    )]
    NeedsSpace {
        /// How to mend it.
        mend: &'static str,
    },
}
