//! Numbers in files of shapes: as few digits as keep what can be seen.
//!
//! Coordinates are rounded to a number of decimal places, so that no coordinate is farther than 10⁻⁴ of a pixel from its own (half of the
//! last place). A pixel is a unit of the drawing; a drawing whose longer side is less than [`SIDE`] units is taken to be shown with that
//! many pixels. The text is the shortest that reads back to the rounded number, and the same everywhere.

use super::drawing::Drawing;
use crate::number;
use anamorph_core::glam::DVec2;

/// Pixels of the longer side of a drawing, at least.
pub const SIDE: f64 = 1024.0;
/// Decimal places at most.
const MOST: u8 = 12;

/// How many decimal places numbers get.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounding {
    places: u8,
    scale: f64,
}

impl Rounding {
    /// This many decimal places, at most 12.
    #[must_use]
    pub fn places(places: u8) -> Self {
        let places = places.min(MOST);
        let mut scale = 1.0;
        for _ in 0..places {
            scale *= 10.0;
        }
        Self { places, scale }
    }

    /// The fewest decimal places that keep 10⁻⁴ of a pixel where the longer side of what is seen is this many units.
    #[must_use]
    pub fn for_side(side: f64) -> Self {
        let pixel = if side > 0.0 {
            (side / SIDE).min(1.0)
        } else {
            1.0
        };
        let mut places = 0;
        let mut half = 0.5;
        while half > 1e-4 * pixel && places < MOST {
            places += 1;
            half /= 10.0;
        }
        Self::places(places)
    }

    /// As [`Rounding::for_side`], of what is to be seen of a drawing.
    #[must_use]
    pub fn for_drawing(drawing: &Drawing) -> Self {
        let [_, _, width, height] = drawing.view();
        Self::for_side(width.max(height))
    }

    /// Decimal places.
    #[must_use]
    pub fn decimals(self) -> u8 {
        self.places
    }

    /// The rounded number; one too large for decimal places stays as it is.
    #[must_use]
    pub fn round(self, value: f64) -> f64 {
        let rounded = (value * self.scale).round() / self.scale;
        // 0 has no sign.
        if rounded.is_finite() {
            rounded + 0.0
        } else {
            value
        }
    }

    pub(super) fn write(self, value: f64, out: &mut Vec<u8>) {
        number::write(self.round(value), out);
    }

    /// `x` and `y` with `between` between them.
    pub(super) fn pair(self, point: DVec2, between: u8, out: &mut Vec<u8>) {
        self.write(point.x, out);
        out.push(between);
        self.write(point.y, out);
    }

    /// `[1,2,3]`.
    pub(super) fn list(self, values: &[f64], out: &mut Vec<u8>) {
        out.push(b'[');
        for (i, value) in values.iter().enumerate() {
            if i > 0 {
                out.push(b',');
            }
            self.write(*value, out);
        }
        out.push(b']');
    }

    /// `[[1,2],[3,4]]`.
    pub(super) fn points(self, points: &[DVec2], out: &mut Vec<u8>) {
        out.push(b'[');
        for (i, point) in points.iter().enumerate() {
            if i > 0 {
                out.push(b',');
            }
            self.list(&point.to_array(), out);
        }
        out.push(b']');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fewest_places_that_keep_what_is_seen() {
        for (side, places) in [(4000.0, 4), (1024.0, 4), (32.0, 6), (0.0, 4), (1e-30, 12)] {
            assert_eq!(Rounding::for_side(side).decimals(), places, "{side}");
        }
        let rounding = Rounding::for_side(500.0);
        let pixel = 500.0 / SIDE;
        for i in 0..1000 {
            let value = f64::from(i) * 0.123_456_789_1;
            let mut text = Vec::new();
            rounding.write(value, &mut text);
            let text = String::from_utf8(text).unwrap();
            assert!((text.parse::<f64>().unwrap() - value).abs() <= 1e-4 * pixel);
            let decimals = text.split_once('.').map_or(0, |(_, after)| after.len());
            assert!(decimals <= usize::from(rounding.decimals()), "{text}");
        }
    }

    #[test]
    fn zero_has_no_sign_and_large_numbers_stay() {
        let mut text = Vec::new();
        Rounding::places(2).list(&[-0.001, 1e300, 2.0, 0.125], &mut text);
        assert_eq!(text, b"[0,1e+300,2,0.13]");
    }
}
