//! Rectangles of the pixel grid.
//!
//! *Source*: the data and display windows of OpenEXR (ASWF, *Technical Introduction to OpenEXR*), with a size in place of the
//! last pixel.

use crate::RasterError;
use anamorph_core::glam::{DVec2, dvec2};

/// Largest magnitude of a window's coordinates. Up to here a position in `f64` tells eighths of a pixel.
const FAR: i64 = 1 << 50;

/// A rectangle of pixels with at least one in it: columns `x .. x + width`, rows `y .. y + height`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Window {
    x: i64,
    y: i64,
    width: usize,
    height: usize,
}

impl Window {
    /// The window of the given size whose top left pixel is `(x, y)`.
    ///
    /// # Errors
    /// [`RasterError::Empty`] without pixels; [`RasterError::Far`] where it reaches beyond ±2⁵⁰.
    pub fn new(x: i64, y: i64, width: usize, height: usize) -> Result<Self, RasterError> {
        if width == 0 || height == 0 {
            return Err(RasterError::Empty { width, height });
        }
        let fits = |start: i64, size: usize| {
            let end = i64::try_from(size).ok().and_then(|s| start.checked_add(s));
            start >= -FAR && end.is_some_and(|end| end <= FAR)
        };
        if !(fits(x, width) && fits(y, height)) {
            return Err(RasterError::Far {
                x,
                y,
                width,
                height,
            });
        }
        Ok(Self {
            x,
            y,
            width,
            height,
        })
    }

    /// The leftmost column.
    pub fn x(&self) -> i64 {
        self.x
    }
    /// The top row.
    pub fn y(&self) -> i64 {
        self.y
    }
    /// Pixels across.
    pub fn width(&self) -> usize {
        self.width
    }
    /// Pixels down.
    pub fn height(&self) -> usize {
        self.height
    }
    /// How many pixels; `None` where they cannot be counted.
    pub fn pixels(&self) -> Option<usize> {
        self.width.checked_mul(self.height)
    }
    /// The top left corner of the top left pixel.
    pub fn corner(&self) -> DVec2 {
        dvec2(self.x as f64, self.y as f64)
    }
    /// The centre of the pixel in that column and row, counted from the window's own corner.
    #[inline]
    pub fn centre(&self, column: usize, row: usize) -> DVec2 {
        self.corner() + dvec2(column as f64 + 0.5, row as f64 + 0.5)
    }
    /// The smallest window around both.
    ///
    /// # Errors
    /// [`RasterError::Far`].
    pub fn union(&self, other: &Self) -> Result<Self, RasterError> {
        let (x, y) = (self.x.min(other.x), self.y.min(other.y));
        let end = |start: i64, size: usize| start.saturating_add_unsigned(size as u64);
        let right = end(self.x, self.width).max(end(other.x, other.width));
        let bottom = end(self.y, self.height).max(end(other.y, other.height));
        let size = |from: i64, to: i64| usize::try_from(to.abs_diff(from)).unwrap_or(usize::MAX);
        Self::new(x, y, size(x, right), size(y, bottom))
    }
    /// Room for `channels` numbers a pixel, all `value`.
    pub(crate) fn room<T: Clone>(&self, channels: usize, value: T) -> Result<Vec<T>, RasterError> {
        let too_large = RasterError::TooLarge {
            width: self.width,
            height: self.height,
            channels,
        };
        let count = self.pixels().and_then(|n| n.checked_mul(channels));
        let bytes = count.and_then(|n| n.checked_mul(size_of::<T>()));
        let (Some(count), Some(true)) = (count, bytes.map(|b| isize::try_from(b).is_ok())) else {
            return Err(too_large);
        };
        // Asked for first, so that a size that cannot be had is an error; then taken as the allocator's zeros, which
        // costs nothing until they are touched.
        Vec::<T>::new()
            .try_reserve_exact(count)
            .map_err(|_| too_large)?;
        Ok(vec![value; count])
    }
}

impl core::fmt::Display for Window {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self {
            x,
            y,
            width,
            height,
        } = self;
        write!(f, "{width} × {height} pixels at ({x}, {y})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_without_pixels_or_out_of_reach_are_refused() {
        assert!(matches!(
            Window::new(0, 0, 0, 5),
            Err(RasterError::Empty { .. })
        ));
        for (x, size) in [
            (i64::MAX, 1),
            (i64::MIN, 1),
            (0, usize::MAX),
            (FAR, 1),
            (-FAR - 1, 1),
        ] {
            let window = Window::new(x, 0, size, 1);
            assert!(matches!(window, Err(RasterError::Far { .. })), "{x} {size}");
        }
        assert!(Window::new(-FAR, FAR - 1, 1, 1).is_ok());
    }

    #[test]
    fn room_that_cannot_be_had_is_an_error() {
        let side = 1_usize << 49;
        let window = Window::new(0, 0, side, side).unwrap();
        assert_eq!(window.pixels(), None);
        assert!(window.room(1, 0.0_f32).is_err());
        let window = Window::new(0, 0, side, 1 << 14).unwrap();
        assert!(window.room(1, 0.0_f32).is_err());
    }

    #[test]
    fn unions_hold_both() {
        let a = Window::new(-3, 4, 2, 2).unwrap();
        let b = Window::new(5, -1, 1, 3).unwrap();
        assert_eq!(a.union(&b), Window::new(-3, -1, 9, 7));
        assert_eq!(a.union(&a), Ok(a));
    }
}
