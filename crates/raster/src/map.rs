//! Maps of source positions: where every target pixel comes from.
//!
//! Kept as offsets from the target pixel's centre, in `f32`: an offset of 1000 pixels is then good to 1/30000 of a pixel, a
//! small one to far less, and the identity is exact on rasters of any size. The offsets are at the same time the motion
//! vectors towards the source. ST maps of compositors hold the positions divided by the size.

use crate::{RasterError, Window, parallel};
use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::{Deformation, Plane};

/// Rows a task evaluates.
const ROWS: usize = 8;

/// Where the pixels of a window come from: a position in source pixel coordinates for each, possibly none.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelMap {
    window: Window,
    offsets: Vec<[f32; 2]>,
}

impl PixelMap {
    /// The identity: every pixel comes from its own place.
    ///
    /// # Errors
    /// [`RasterError::TooLarge`].
    pub fn identity(window: Window) -> Result<Self, RasterError> {
        let offsets = window.room(1, [0.0; 2])?;
        Ok(Self { window, offsets })
    }

    /// The map of given offsets, source position less target pixel centre, rows from the top.
    ///
    /// # Errors
    /// [`RasterError::Length`] where there are more or fewer than the window has pixels.
    pub fn from_offsets(window: Window, offsets: Vec<[f32; 2]>) -> Result<Self, RasterError> {
        if window.pixels() != Some(offsets.len()) {
            return Err(RasterError::Length {
                what: "offsets",
                found: offsets.len(),
                needed: window.pixels().unwrap_or(usize::MAX),
                window,
                channels: 1,
            });
        }
        Ok(Self { window, offsets })
    }

    /// The map whose source positions a function of column and row, counted from the window's corner, gives.
    ///
    /// # Errors
    /// [`RasterError::TooLarge`].
    pub fn from_positions(
        window: Window,
        position: impl Fn(usize, usize) -> DVec2 + Sync + Send,
    ) -> Result<Self, RasterError> {
        let mut map = Self::identity(window)?;
        parallel::chunks(&mut map.offsets, window.width(), |row, out| {
            for (column, offset) in out.iter_mut().enumerate() {
                let moved = position(column, row) - window.centre(column, row);
                *offset = [moved.x as f32, moved.y as f32];
            }
        });
        Ok(map)
    }

    /// The map that a deformation from target to source gives, evaluated at every pixel. The index of a site is that of the
    /// pixel in the window, row by row.
    ///
    /// # Errors
    /// [`RasterError::TooLarge`].
    pub fn from_deformation(
        deformation: &dyn Deformation<Plane>,
        window: Window,
    ) -> Result<Self, RasterError> {
        let mut map = Self::identity(window)?;
        map.evaluate(deformation);
        Ok(map)
    }

    /// The same over the map's own window and memory.
    pub fn evaluate(&mut self, deformation: &dyn Deformation<Plane>) {
        let window = self.window;
        let width = window.width();
        parallel::chunks_with(
            &mut self.offsets,
            width * ROWS,
            Vec::new,
            |points, task, out| {
                for (row, out) in (task * ROWS..).zip(out.chunks_exact_mut(width)) {
                    offsets_of_row(deformation, window, row, points, out);
                }
            },
        );
    }

    /// The pixels it is for.
    pub fn window(&self) -> Window {
        self.window
    }
    /// Source position less pixel centre, rows from the top.
    pub fn offsets(&self) -> &[[f32; 2]] {
        &self.offsets
    }
    pub(crate) fn offsets_mut(&mut self) -> &mut [[f32; 2]] {
        &mut self.offsets
    }
    /// Where the pixel in that column and row comes from; none outside the window.
    pub fn position(&self, column: usize, row: usize) -> Option<DVec2> {
        let inside = column < self.window.width() && row < self.window.height();
        let [x, y] = *inside.then(|| &self.offsets[row * self.window.width() + column])?;
        Some(self.window.centre(column, row) + dvec2(f64::from(x), f64::from(y)))
    }
}

/// Evaluates a deformation at the pixels of a row.
pub(crate) fn offsets_of_row(
    deformation: &dyn Deformation<Plane>,
    window: Window,
    row: usize,
    points: &mut Vec<DVec2>,
    out: &mut [[f32; 2]],
) {
    points.clear();
    points.extend((0..window.width()).map(|column| window.centre(column, row)));
    // Points that cannot be moved stay where they are, which is what the deformation's own report says of them.
    let _ = deformation.map_points(row * window.width(), points);
    for (column, (offset, point)) in out.iter_mut().zip(points.iter()).enumerate() {
        let moved = *point - window.centre(column, row);
        *offset = [moved.x as f32, moved.y as f32];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::Affine;
    use anamorph_core::glam::DMat2;

    #[test]
    fn deformations_and_functions_give_the_same_map() {
        let window = Window::new(-5, 7, 13, 21).unwrap();
        let turn = Affine {
            linear: DMat2::from_angle(0.3),
            translation: dvec2(3.0, -2.0),
        };
        let map = PixelMap::from_deformation(&turn, window).unwrap();
        let same = PixelMap::from_positions(window, |x, y| turn.apply(window.centre(x, y)));
        assert_eq!(Ok(&map), same.as_ref());
        let there = map.position(12, 20).unwrap();
        assert!(there.distance(turn.apply(window.centre(12, 20))) < 1e-5);
        assert_eq!(map.position(13, 0), None);
        assert!(PixelMap::from_offsets(window, vec![[0.0; 2]; 3]).is_err());
    }
}
