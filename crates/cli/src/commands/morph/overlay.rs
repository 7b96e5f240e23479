//! Features drawn on a picture: points as discs, lines as strokes, with a dark border that shows on any ground.

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_raster::Raster;

/// Linear light of the border of strokes.
const BORDER: [f32; 3] = [0.02, 0.02, 0.02];
/// Linear light of the strokes of a morph.
pub(crate) const INK: [f32; 3] = [1.0, 0.35, 0.03];

/// Draws features of one or several places on a picture of grey or RGB, with or without alpha, in a colour of linear light.
pub(crate) fn draw(picture: &mut Raster, features: &[Vec<DVec2>], ink: [f32; 3]) {
    let window = picture.window();
    let size = window.width().max(window.height()) as f64;
    let radius = (size / 700.0).clamp(0.8, 4.0);
    for (colour, radius) in [BORDER, ink].into_iter().zip([radius + 0.9, radius]) {
        for feature in features {
            match feature.as_slice() {
                [] => {}
                [place] => stroke(picture, *place, *place, 1.5 * radius, colour),
                places => {
                    for pair in places.windows(2) {
                        stroke(picture, pair[0], pair[1], radius, colour);
                    }
                }
            }
        }
    }
}

/// A line with round ends: each pixel is covered as far as its centre is inside, over the width of a pixel.
fn stroke(picture: &mut Raster, from: DVec2, to: DVec2, radius: f64, colour: [f32; 3]) {
    if !(from.is_finite() && to.is_finite()) {
        return;
    }
    let window = picture.window();
    let channels = picture.channels();
    let corner = window.corner();
    let reach = dvec2(radius + 1.0, radius + 1.0);
    let size = dvec2(window.width() as f64, window.height() as f64);
    let low = (from.min(to) - reach - corner).clamp(DVec2::ZERO, size);
    let high = (from.max(to) + reach - corner).clamp(DVec2::ZERO, size);
    let along = to - from;
    let length = along.length_squared();
    for row in low.y as usize..high.y as usize {
        for column in low.x as usize..high.x as usize {
            let place = window.centre(column, row) - from;
            let share = if length > 0.0 {
                (place.dot(along) / length).clamp(0.0, 1.0)
            } else {
                0.0
            };
            let distance = (place - along * share).length();
            let covered = (radius + 0.5 - distance).clamp(0.0, 1.0) as f32;
            if covered == 0.0 {
                continue;
            }
            let light = match channels {
                1 | 2 => [0.4 * (colour[0] + colour[1] + colour[2]); 3],
                _ => colour,
            };
            let colours = if channels < 3 { 1 } else { 3 };
            for (i, sample) in picture.pixel_mut(column, row).iter_mut().enumerate() {
                // What comes behind the colours is coverage.
                let own = if i < colours { light[i] } else { 1.0 };
                *sample += (own - *sample) * covered;
            }
        }
    }
}
