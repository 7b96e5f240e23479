//! Rasters: `f32` samples on a window of the pixel grid.
//!
//! Samples are interleaved, all channels of a pixel side by side, rows from the top: a resampled pixel then reads its
//! neighbourhood from one place for all channels, and four channels make one vector.

use crate::{RasterError, Window};

/// An image: `channels` numbers for every pixel of its data window.
///
/// The display window is what a viewer shows; it may be larger or smaller than the data. It is carried along.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    window: Window,
    display: Window,
    channels: usize,
    samples: Vec<f32>,
}

impl Raster {
    /// A raster of zeros.
    ///
    /// # Errors
    /// [`RasterError::NoChannels`]; [`RasterError::TooLarge`].
    pub fn new(window: Window, channels: usize) -> Result<Self, RasterError> {
        if channels == 0 {
            return Err(RasterError::NoChannels);
        }
        Ok(Self {
            window,
            display: window,
            channels,
            samples: window.room(channels, 0.0)?,
        })
    }

    /// The raster of given samples: `height` rows from the top, `width` pixels from the left, `channels` numbers each.
    ///
    /// # Errors
    /// [`RasterError::NoChannels`]; [`RasterError::Length`] where there are more or fewer samples than that.
    pub fn from_samples(
        window: Window,
        channels: usize,
        samples: Vec<f32>,
    ) -> Result<Self, RasterError> {
        if channels == 0 {
            return Err(RasterError::NoChannels);
        }
        let needed = window.pixels().and_then(|n| n.checked_mul(channels));
        if needed != Some(samples.len()) {
            return Err(RasterError::Length {
                what: "samples",
                found: samples.len(),
                needed: needed.unwrap_or(usize::MAX),
                window,
                channels,
            });
        }
        Ok(Self {
            window,
            display: window,
            channels,
            samples,
        })
    }

    /// The same raster with another display window.
    #[must_use]
    pub fn with_display(mut self, display: Window) -> Self {
        self.display = display;
        self
    }

    /// The pixels it has.
    pub fn window(&self) -> Window {
        self.window
    }
    /// The pixels a viewer shows.
    pub fn display(&self) -> Window {
        self.display
    }
    /// Pixels across.
    pub fn width(&self) -> usize {
        self.window.width()
    }
    /// Pixels down.
    pub fn height(&self) -> usize {
        self.window.height()
    }
    /// Numbers a pixel.
    pub fn channels(&self) -> usize {
        self.channels
    }
    /// All samples, as [`Raster::from_samples`] takes them.
    pub fn samples(&self) -> &[f32] {
        &self.samples
    }
    /// The same, to change.
    pub fn samples_mut(&mut self) -> &mut [f32] {
        &mut self.samples
    }
    /// The samples alone.
    pub fn into_samples(self) -> Vec<f32> {
        self.samples
    }

    fn offset(&self, column: usize, row: usize) -> Option<usize> {
        let inside = column < self.width() && row < self.height();
        inside.then(|| (row * self.width() + column) * self.channels)
    }
    /// The samples of the pixel in that column and row, counted from the data window's corner; none outside.
    pub fn pixel(&self, column: usize, row: usize) -> &[f32] {
        match self.offset(column, row) {
            Some(at) => &self.samples[at..at + self.channels],
            None => &[],
        }
    }
    /// The same, to change.
    pub fn pixel_mut(&mut self, column: usize, row: usize) -> &mut [f32] {
        match self.offset(column, row) {
            Some(at) => &mut self.samples[at..at + self.channels],
            None => &mut [],
        }
    }

    /// Refuses a channel that it does not have.
    pub(crate) fn check_channel(&self, channel: usize) -> Result<(), RasterError> {
        if channel < self.channels {
            return Ok(());
        }
        Err(RasterError::NoChannel {
            channel,
            channels: self.channels,
        })
    }
    /// Refuses a raster of another window or with other channels.
    pub(crate) fn check_alike(&self, other: &Self) -> Result<(), RasterError> {
        if self.window != other.window {
            return Err(RasterError::Windows {
                first: self.window,
                second: other.window,
            });
        }
        if self.channels != other.channels {
            return Err(RasterError::Channels {
                first: self.channels,
                second: other.channels,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_must_fill_the_window() {
        let window = Window::new(2, 3, 4, 5).unwrap();
        assert_eq!(Raster::new(window, 0), Err(RasterError::NoChannels));
        for count in [0, 59, 61] {
            let error = Raster::from_samples(window, 3, vec![0.0; count]);
            assert!(matches!(error, Err(RasterError::Length { needed: 60, .. })));
        }
        let raster = Raster::from_samples(window, 3, (0..60_u8).map(f32::from).collect()).unwrap();
        assert_eq!(raster.pixel(1, 2), [27.0, 28.0, 29.0]);
        assert!(raster.pixel(4, 0).is_empty() && raster.pixel(0, 5).is_empty());
    }
}
