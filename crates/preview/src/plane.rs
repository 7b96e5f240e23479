//! A panel of the plane without its marks: a grid, filled triangles with their edges, dots.

use crate::mesh::{Mesh, vec3};
use crate::overlay::{Element, Figure};
use crate::palette::{Linear, Palette, mix, scale};
use crate::raster::DepthBuffer;
use crate::view::{Frame, View};

/// Triangles above which their edges are no longer drawn: they would cover the picture.
const MOST_EDGED: usize = 6_000;

/// The panel's pixels in linear light.
pub(crate) fn paint(
    mesh: &Mesh,
    view: &View,
    frame: &Frame,
    palette: &Palette,
    buffer: &DepthBuffer,
) -> Vec<Linear> {
    let [width, height] = view.size;
    let mut pixels = Vec::with_capacity(width * height);
    for y in 0..height {
        for x in 0..width {
            let place = [
                (x as f32 + 0.5) / width as f32,
                (y as f32 + 0.5) / height as f32,
            ];
            pixels.push(palette.background(place[0], place[1], width as f32 / height as f32));
        }
    }
    grid(view, frame, palette, &mut pixels);
    let turned: Vec<bool> = mesh
        .face_normals()
        .into_iter()
        .map(|normal| vec3(normal).z < 0.0)
        .collect();
    let side = buffer.per_pixel;
    for y in 0..height {
        for x in 0..width {
            let ground = pixels[y * width + x];
            let mut sum = [0.0_f32; 3];
            for index in 0..side * side {
                let (column, line) = (x * side + index % side, y * side + index / side);
                let sample = buffer.samples[line * buffer.width + column];
                let colour = match (sample.id as usize).checked_sub(1) {
                    None => ground,
                    Some(index) => fill(mesh, index, &turned, palette),
                };
                sum = [0, 1, 2].map(|k| sum[k] + colour[k]);
            }
            pixels[y * width + x] = scale(sum, 1.0 / (side * side) as f32);
        }
    }
    pixels
}

fn fill(mesh: &Mesh, index: usize, turned: &[bool], palette: &Palette) -> Linear {
    match mesh.triangles.get(index) {
        Some(corners) => {
            let parts = corners.map(|corner| mesh.colour(corner, palette.fill));
            let colour = [0, 1, 2].map(|k| (parts[0][k] + parts[1][k] + parts[2][k]) / 3.0);
            if turned[index] {
                mix(colour, palette.turned, 0.8)
            } else {
                colour
            }
        }
        None => match mesh.dots.get(index - mesh.triangles.len()) {
            Some(&dot) => mesh.colour(dot, palette.ink),
            None => palette.ink,
        },
    }
}

/// The edges of the triangles of a small mesh.
pub(crate) fn edges(mesh: &Mesh, palette: &Palette, unit: f64) -> Vec<Element> {
    if mesh.triangles.len() > MOST_EDGED {
        return Vec::new();
    }
    let mut pairs: Vec<[u32; 2]> = mesh
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
        .into_iter()
        .map(|pair| Element {
            shape: Figure::Line(pair.map(|index| mesh.points[index as usize]).to_vec()),
            colour: palette.ink,
            radius: 0.45 * unit,
            opacity: 0.3,
        })
        .collect()
}

/// Lines at round coordinates, those through the origin stronger.
fn grid(view: &View, frame: &Frame, palette: &Palette, pixels: &mut [Linear]) {
    let [width, height] = view.size;
    let half = if frame.half > 0.0 { frame.half } else { 1.0 };
    // One pixel in scene units.
    let pixel = view.pixel_length(1.0) * half;
    let spacing = round_up(pixel * height as f64 / 11.0);
    if !spacing.is_finite() || spacing <= 0.0 {
        return;
    }
    for axis in 0..2 {
        let centre = frame.centre[axis];
        let count = [width, height][axis];
        // Beyond this the coordinates have too few digits for a grid.
        if (centre / spacing).abs() > 1e9 {
            continue;
        }
        let shift = {
            let origin = view.project(anamorph_core::glam::DVec3::ZERO);
            [origin.x, origin.y][axis]
        };
        let sign = [1.0, -1.0][axis];
        let coordinate = |place: f64| centre + sign * (place - shift) * pixel;
        let (low, high) = (coordinate(0.0), coordinate(count as f64));
        let first = (low.min(high) / spacing).floor() as i64;
        let last = (low.max(high) / spacing).ceil() as i64;
        for number in first..=last.min(first + 200) {
            let place = shift + sign * (number as f64 * spacing - centre) / pixel;
            let (strength, radius) = if number == 0 { (1.0, 0.8) } else { (0.75, 0.5) };
            let begin = (place - 2.0).max(0.0) as usize;
            for line in begin..((place + 3.0).max(0.0) as usize).min(count) {
                let cover =
                    (radius + 0.5 - (line as f64 + 0.5 - place).abs()).clamp(0.0, 1.0) * strength;
                for along in 0..[height, width][axis] {
                    let index = if axis == 0 {
                        along * width + line
                    } else {
                        line * width + along
                    };
                    pixels[index] = mix(pixels[index], palette.grid, cover as f32);
                }
            }
        }
    }
}

/// The least of 1, 2, 5 times a power of ten that is not below `value`.
fn round_up(value: f64) -> f64 {
    let power = 10.0_f64.powf(value.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|factor| power * factor >= value * (1.0 - 1e-9));
    power * factor.unwrap_or(10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spacings_are_round() {
        for (value, round) in [
            (1.0, 1.0),
            (1.1, 2.0),
            (0.03, 0.05),
            (700.0, 1000.0),
            (2e-9, 2e-9),
        ] {
            assert!((round_up(value) / round - 1.0_f64).abs() < 1e-9, "{value}");
        }
    }
}
