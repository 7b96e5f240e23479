//! Images on meshes: what is between two shapes shows what is on both, one dissolving into the other.
//!
//! A pixel of the frame lies in a triangle; at the same barycentric coordinates of that triangle lies a place of each image, which is read there
//! over what the pixel covers. Both are dissolved in premultiplied linear light, and covered as far as the outlines cover the pixel. Places are found
//! as offsets from the pixel: where the frame's mesh is an image's own, every pixel is that image's pixel, bit for bit.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004, which asks for "values at corresponding barycentric
//! coordinates". How pixels at the border are found is decided here.

mod coverage;

pub use coverage::coverage;

use anamorph_core::glam::{DMat2, DVec2, dvec2};
use anamorph_raster::{Raster, RasterError, Sampler, Window, parallel};

/// Channels of images and frames: red, green, blue and alpha.
pub const CHANNELS: usize = 4;
/// Rows a task draws.
const ROWS: usize = 8;
/// No triangle.
const NONE: u32 = u32::MAX;

/// Where units of a drawing lie in pixels: a canvas is as large as an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sheet {
    corner: DVec2,
    scale: DVec2,
}

impl Sheet {
    /// A canvas (left, top, width and height in units, y downwards) on so many pixels. The image's edges are the canvas's: the centre of pixel
    /// `(i, j)` lies `(i + ½) / width` of the canvas's width from its left.
    pub fn new([left, top, across, down]: [f64; 4], width: usize, height: usize) -> Self {
        Self {
            corner: dvec2(left, top),
            scale: dvec2(width as f64 / across, height as f64 / down),
        }
    }

    /// The place of a point in pixels.
    pub fn pixel(&self, point: DVec2) -> DVec2 {
        (point - self.corner) * self.scale
    }

    /// The places of points in pixels.
    pub fn pixels(&self, points: &[DVec2]) -> Vec<DVec2> {
        points.iter().map(|point| self.pixel(*point)).collect()
    }
}

/// A mesh with images on it, all places in pixels.
#[derive(Debug, Clone, Copy)]
pub struct Textured<'a> {
    /// Triangles by numbers of points.
    pub triangles: &'a [[u32; 3]],
    /// Where its points are in the frame.
    pub places: &'a [DVec2],
    /// Its outlines in the frame, holes the other way round.
    pub rings: &'a [Vec<DVec2>],
    /// Where its points are in both images.
    pub images: [&'a [DVec2]; 2],
    /// The share of the second image, 0 to 1.
    pub dissolve: f64,
    /// 0 is nothing, 1 hides what is behind.
    pub opacity: f64,
}

/// Why there is no frame.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TextureError {
    /// Rasters that do not fit.
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// A triangle with a point that is not there.
    #[error("triangle {triangle} has a point that the frame or an image lacks")]
    Point {
        /// Which triangle.
        triangle: usize,
    },
    /// A number that makes no sense.
    #[error("`{name}` is {value}; it has to be from 0 to 1")]
    OutOfRange {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
}

/// Where the pixels of a triangle are in an image: `p + start + slope (p − corner)`.
#[derive(Clone, Copy, Default)]
struct Way {
    start: DVec2,
    slope: DMat2,
}

/// A triangle of the frame.
struct Patch {
    corners: [DVec2; 3],
    ways: [Way; 2],
}

impl Patch {
    fn new(corners: [DVec2; 3], images: [[DVec2; 3]; 2]) -> Self {
        let [a, b, c] = corners;
        let inverse = DMat2::from_cols(b - a, c - a).inverse();
        let ways = images.map(|places| {
            let [s, t, u] = [0, 1, 2].map(|i: usize| places[i] - corners[i]);
            let slope = DMat2::from_cols(t - s, u - s) * inverse;
            // Triangles without area cover nothing, but a pixel at the border may be nearest to one.
            let slope = if slope.is_finite() {
                slope
            } else {
                DMat2::ZERO
            };
            Way { start: s, slope }
        });
        Self { corners, ways }
    }

    /// The place of the triangle that is nearest to a point.
    fn nearest(&self, p: DVec2) -> DVec2 {
        let [a, b, c] = self.corners;
        let turn = (b - a).perp_dot(c - a);
        let inside = |p: DVec2, q: DVec2, x: DVec2| (q - p).perp_dot(x - p) * turn >= 0.0;
        if turn != 0.0 && inside(a, b, p) && inside(b, c, p) && inside(c, a, p) {
            return p;
        }
        let on = |from: DVec2, to: DVec2| {
            let way = to - from;
            let share = (p - from).dot(way) / way.length_squared();
            let share = if share.is_nan() {
                0.0
            } else {
                share.clamp(0.0, 1.0)
            };
            from + way * share
        };
        let all = [on(a, b), on(b, c), on(c, a)];
        let far = |q: &DVec2| q.distance_squared(p);
        let [first, second, third] = all;
        let best = if far(&second) < far(&first) {
            second
        } else {
            first
        };
        if far(&third) < far(&best) {
            third
        } else {
            best
        }
    }
}

/// Draws meshes over each other in a frame that is transparent elsewhere; both images have red, green, blue and alpha, premultiplied.
///
/// # Errors
/// [`TextureError`].
pub fn draw(
    meshes: &[Textured<'_>],
    images: [&Sampler<'_>; 2],
    window: Window,
) -> Result<Raster, TextureError> {
    for image in images {
        let channels = image.raster().channels();
        if channels != CHANNELS {
            let wrong = RasterError::Channels {
                first: channels,
                second: CHANNELS,
            };
            return Err(wrong.into());
        }
    }
    let mut frame = Raster::new(window, CHANNELS)?;
    for mesh in meshes {
        one(mesh, images, window, &mut frame)?;
    }
    Ok(frame)
}

fn one(
    mesh: &Textured<'_>,
    images: [&Sampler<'_>; 2],
    window: Window,
    frame: &mut Raster,
) -> Result<(), TextureError> {
    for (name, value) in [("dissolve", mesh.dissolve), ("opacity", mesh.opacity)] {
        if !(0.0..=1.0).contains(&value) {
            return Err(TextureError::OutOfRange { name, value });
        }
    }
    let mut patches = Vec::with_capacity(mesh.triangles.len());
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        let at = |list: &[DVec2]| {
            let [a, b, c] = corners.map(|i| list.get(i as usize).copied());
            Some([a?, b?, c?])
        };
        let found = (at(mesh.places), at(mesh.images[0]), at(mesh.images[1]));
        let (Some(places), Some(first), Some(second)) = found else {
            return Err(TextureError::Point { triangle });
        };
        patches.push(Patch::new(places, [first, second]));
    }
    let covered = coverage(mesh.rings, window);
    let owners = owners(&patches, &covered, window);
    let width = window.width();
    let shares = [1.0 - mesh.dissolve, mesh.dissolve];
    parallel::chunks(
        frame.samples_mut(),
        width * CHANNELS * ROWS,
        |task, chunk| {
            let first = task * ROWS * width;
            let (pixels, _) = chunk.as_chunks_mut::<CHANNELS>();
            for (number, pixel) in (first..).zip(pixels) {
                let Some(patch) = patches.get(owners[number] as usize) else {
                    continue;
                };
                let p = window.centre(number % width, number / width);
                let nearest = patch.nearest(p) - patch.corners[0];
                let mut colours = [0.0_f32; CHANNELS];
                for side in 0..2 {
                    if shares[side] <= 0.0 {
                        continue;
                    }
                    let way = &patch.ways[side];
                    let place = p + (way.start + way.slope * nearest);
                    let mut own = [0.0_f32; CHANNELS];
                    images[side].sample(place, DMat2::IDENTITY + way.slope, &mut own);
                    if shares[side] == 1.0 {
                        colours = own;
                    } else {
                        for (sum, own) in colours.iter_mut().zip(own) {
                            *sum += own * shares[side] as f32;
                        }
                    }
                }
                let cover = (covered[number] * mesh.opacity) as f32;
                let behind = 1.0 - colours[CHANNELS - 1] * cover;
                for (light, colour) in pixel.iter_mut().zip(colours) {
                    *light = colour * cover + *light * behind;
                }
            }
        },
    );
    Ok(())
}

/// Columns or rows of a box that lie in the window, from its corner; a pixel more on either side.
fn span(low: f64, high: f64, count: usize) -> core::ops::Range<usize> {
    let within = |value: f64| value.clamp(0.0, count as f64) as usize;
    within((low - 1.0).floor())..within((high + 1.0).ceil())
}

/// Which triangle every covered pixel is of: the one that its centre lies in, the first of several, else the nearest.
fn owners(patches: &[Patch], covered: &[f64], window: Window) -> Vec<u32> {
    let (width, height) = (window.width(), window.height());
    let mut owners = vec![NONE; covered.len()];
    let mut distances = vec![f64::INFINITY; covered.len()];
    let corner = window.corner();
    for (number, patch) in patches.iter().enumerate() {
        let [a, b, c] = patch.corners.map(|p| p - corner);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        if !(low.is_finite() && high.is_finite()) {
            continue;
        }
        for row in span(low.y, high.y, height) {
            for column in span(low.x, high.x, width) {
                let pixel = row * width + column;
                if covered[pixel] <= 0.0 || distances[pixel] == 0.0 {
                    continue;
                }
                let p = window.centre(column, row);
                let distance = patch.nearest(p).distance_squared(p);
                if distance < distances[pixel] {
                    distances[pixel] = distance;
                    owners[pixel] = number as u32;
                }
            }
        }
    }
    // What is left lies in holes that are too small to be shown.
    for (pixel, owner) in owners.iter_mut().enumerate() {
        if *owner == NONE && covered[pixel] > 0.0 {
            let p = window.centre(pixel % width, pixel / width);
            let far = |patch: &Patch| patch.nearest(p).distance_squared(p);
            let all = patches.iter().enumerate();
            let nearest = all.min_by(|(_, a), (_, b)| far(a).total_cmp(&far(b)));
            *owner = nearest.map_or(NONE, |(number, _)| number as u32);
        }
    }
    owners
}

#[cfg(test)]
mod tests;
