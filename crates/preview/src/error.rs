//! What can go wrong when a picture is made.

/// Why there is no picture.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PreviewError {
    /// A panel has nothing that could be drawn.
    #[error(
        "nothing to draw in the {panel} panel: none of its {points} points has finite coordinates; \
         give a model with at least one finite point"
    )]
    Empty {
        /// Which panel: `"only"`, `"before"` or `"after"`.
        panel: &'static str,
        /// How many points the model has.
        points: usize,
    },
    /// A drawing without pixels, or with too many.
    #[error(
        "a drawing of {width} × {height} pixels cannot be made; width and height go from 1 to {most} pixels"
    )]
    Drawing {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// The largest width and height.
        most: u32,
    },
    /// Bytes that are not those of a picture.
    #[error(
        "{found} bytes are given for a picture of {width} × {height} pixels; give three for each pixel, and at least one pixel"
    )]
    Pixels {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// How many bytes were given.
        found: usize,
    },
    /// The picture is too small to hold anything or too large to be made.
    #[error(
        "a picture of {width} × {height} pixels with {samples} × {samples} samples each cannot be made; \
         width and height go from {least} to {most} pixels, samples from 1 to 8, \
         and at that many samples a picture has at most {} pixels",
        budget / u64::from(*samples).pow(2).max(1)
    )]
    Size {
        /// Asked width in pixels.
        width: u32,
        /// Asked height in pixels.
        height: u32,
        /// Asked samples along each side of a pixel.
        samples: u32,
        /// Least width and height.
        least: u32,
        /// Greatest width and height.
        most: u32,
        /// Greatest number of samples in the picture.
        budget: u64,
    },
    /// The camera has no view.
    #[error("the camera's {what} is {value}; give {mend}")]
    Camera {
        /// Which value.
        what: &'static str,
        /// What it was.
        value: f64,
        /// What it may be.
        mend: &'static str,
    },
    /// A picture of an animation has another size than the first.
    #[error(
        "picture {index} of the animation has {width} × {height} pixels where the first has {expected_width} × \
         {expected_height}; give all of them one size"
    )]
    Frame {
        /// Which picture, from 0.
        index: usize,
        /// Its width in pixels.
        width: u32,
        /// Its height in pixels.
        height: u32,
        /// Width of the first.
        expected_width: u32,
        /// Height of the first.
        expected_height: u32,
    },
    /// An animation needs pictures and a rate.
    #[error("an animation of {count} pictures at {rate} a second cannot be made; {mend}")]
    Animation {
        /// How many pictures were announced.
        count: usize,
        /// Pictures a second.
        rate: f64,
        /// What may be given.
        mend: &'static str,
    },
    /// The animation could not be written.
    #[error("the animation could not be encoded: {reason}; fewer or smaller pictures may work")]
    Encoding {
        /// What the encoder said.
        reason: String,
    },
    /// The pixels could not be written as PNG.
    #[error("the picture could not be encoded as PNG: {reason}; a smaller picture may work")]
    Png {
        /// What the encoder said.
        reason: String,
    },
}
