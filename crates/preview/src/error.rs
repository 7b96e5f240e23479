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
    /// The pixels could not be written as PNG.
    #[error("the picture could not be encoded as PNG: {reason}; a smaller picture may work")]
    Png {
        /// What the encoder said.
        reason: String,
    },
}
