//! Forward mapping: source pixels are drawn where a deformation takes them.
//!
//! *Source*: the image warps of T. Milliron et al. 2002, Figure 15, shown by moving the picture's points; mesh warping after
//! G. Wolberg, *Digital Image Warping*, 1990, §3.
//!
//! The corners of a mesh are the centres of the source's pixels and, around them, points of its border, so that the mesh
//! covers the whole picture. All corners are moved; every cell is drawn as two triangles, and a target pixel whose centre
//! lies in one gets the source's colour, bilinear, at the corresponding place. So there are no holes between source pixels,
//! however far they are pulled apart; what lies outside the moved mesh stays zero. Edges shared by triangles belong to
//! exactly one of them: a target pixel is drawn once wherever the deformation does not fold.
//!
//! Along the outline of the moved mesh, and where it is torn, pixels are covered in part: there the areas of the triangles in the pixel are
//! summed, and the colour is multiplied by the sum. Where sheets lie over each other it is at most 1. A pixel whose centre is outside
//! has the mean of the pieces in it as colour. All others are as opaque as the source.
//!
//! Where it folds, several cells cover a pixel. [`Overlap`] says which counts; the order is that of the source's rows, from
//! the top, and in them of its columns.

use crate::sampling::{Edge, Filter, Sampler};
use crate::{Raster, RasterError, Window, parallel};
use anamorph_core::glam::{DMat2, DVec2, dvec2};
use anamorph_core::{Deformation, Plane};

/// Rows of the target a task draws.
const ROWS: usize = 32;

/// What counts where a deformation folds the picture over itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Overlap {
    /// The last in the source's order lies on top.
    #[default]
    Last,
    /// The first lies on top.
    First,
    /// The mean of all.
    Mean,
}

/// How source pixels are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SplatOptions {
    /// What counts where the picture folds over itself.
    pub overlap: Overlap,
    /// Cells with a side longer than this many target pixels are torn and not drawn; without, every gap is filled by
    /// stretching the cell across it.
    pub tear: Option<f64>,
}

/// A picture drawn by forward mapping.
#[derive(Debug, Clone, PartialEq)]
pub struct Splat {
    /// The picture; zeros where nothing arrived.
    pub raster: Raster,
    /// How many cells arrived at the centre of each pixel, row by row: 0 in holes, 2 and more where the picture folds over itself.
    /// Pixels along the outline may have a little of the picture and a 0.
    pub layers: Vec<u32>,
}

/// Draws `source` where `deformation`, from source to target, takes it. The index of a site is that of the pixel in the
/// source, row by row; the border's are those of the pixels next to it.
///
/// # Errors
/// [`RasterError::TooLarge`]; [`RasterError::OutOfRange`] for a tear that is not positive.
pub fn splat(
    source: &Raster,
    deformation: &dyn Deformation<Plane>,
    window: Window,
    options: SplatOptions,
) -> Result<Splat, RasterError> {
    if let Some(tear) = options.tear
        && (tear.is_nan() || tear <= 0.0)
    {
        return Err(RasterError::OutOfRange {
            name: "tear",
            value: tear,
            range: "positive",
        });
    }
    let mesh = Mesh::new(source, deformation, window)?;
    let mut raster = Raster::new(window, source.channels())?.with_display(source.display());
    let mut layers = window.room(1, 0_u32)?;
    let sampler = Sampler::new(source, Filter::BILINEAR, Edge::Clamp);
    let line = window.width() * source.channels();
    // One task's part of the picture and of the layers.
    let mut parts: Vec<(&mut [f32], &mut [u32])> = raster
        .samples_mut()
        .chunks_mut(line * ROWS)
        .zip(layers.chunks_mut(window.width() * ROWS))
        .collect();
    parallel::chunks(&mut parts, 1, |task, part| {
        if let [(samples, layers)] = part {
            let mut band = Band {
                first: task * ROWS,
                width: window.width(),
                channels: source.channels(),
                samples,
                layers,
                sampler: &sampler,
                overlap: options.overlap,
                value: vec![0.0; source.channels()],
                slots: Vec::new(),
                parts: Vec::new(),
            };
            mesh.outline(options.tear, &mut band);
            mesh.draw(options.tear, &mut band);
            band.finish();
        }
    });
    drop(parts);
    Ok(Splat { raster, layers })
}

/// The moved corners, and which rows of the target each row of cells reaches.
struct Mesh {
    /// Corners across.
    across: usize,
    /// Where the columns and rows of corners stand in the source.
    columns: Vec<f64>,
    rows: Vec<f64>,
    /// Moved, from the target window's corner.
    corners: Vec<DVec2>,
    /// Lowest and highest `y` of each row of cells.
    reach: Vec<(f64, f64)>,
    /// All corners are finite.
    is_whole: bool,
}

/// Whether a cell is drawn.
fn is_drawn(moved: &[DVec2; 4], tear: Option<f64>) -> bool {
    let [a, b, c, d] = *moved;
    let sides = [a - b, a - c, b - d, c - d];
    let is_torn = tear.is_some_and(|most| sides.iter().any(|side| side.length() > most));
    moved.iter().all(|p| p.is_finite()) && !is_torn
}

/// Where corners stand along an axis, and the pixels they belong to: the border, all centres, the border.
fn stations(start: i64, size: usize) -> (Vec<f64>, Vec<usize>) {
    let start = start as f64;
    let inner = (0..size).map(|i| (start + i as f64 + 0.5, i));
    let all = core::iter::once((start, 0))
        .chain(inner)
        .chain([(start + size as f64, size - 1)]);
    all.unzip()
}

impl Mesh {
    fn new(
        source: &Raster,
        deformation: &dyn Deformation<Plane>,
        target: Window,
    ) -> Result<Self, RasterError> {
        let window = source.window();
        let (columns, column_pixels) = stations(window.x(), window.width());
        let (rows, row_pixels) = stations(window.y(), window.height());
        let across = columns.len();
        let lattice = Window::new(0, 0, across, rows.len())?;
        let mut corners = lattice.room(1, DVec2::ZERO)?;
        let origin = target.corner();
        parallel::chunks(&mut corners, across, |row, out| {
            for (corner, &x) in out.iter_mut().zip(&columns) {
                *corner = dvec2(x, rows[row]);
            }
            let first = row_pixels[row] * window.width();
            let last = across - 1;
            // The pixels themselves are a run; the border's two points have indices of their own.
            let _ = deformation.map_points(first, &mut out[1..last]);
            for end in [0, last] {
                let index = first + column_pixels[end];
                let _ = deformation.map_points(index, &mut out[end..=end]);
            }
            out.iter_mut().for_each(|corner| *corner -= origin);
        });
        let span = |(low, high): (f64, f64), p: &DVec2| (low.min(p.y), high.max(p.y));
        let nothing = (f64::INFINITY, f64::NEG_INFINITY);
        let reach = (0..rows.len() - 1)
            .map(|row| {
                let both = &corners[row * across..(row + 2) * across];
                both.iter().fold(nothing, span)
            })
            .collect();
        Ok(Self {
            is_whole: corners.iter().all(|corner| corner.is_finite()),
            across,
            columns,
            rows,
            corners,
            reach,
        })
    }

    /// The moved corners of a cell.
    fn cell(&self, row: usize, column: usize) -> [DVec2; 4] {
        let upper = row * self.across + column;
        let lower = upper + self.across;
        [upper, upper + 1, lower, lower + 1].map(|corner| self.corners[corner])
    }

    /// Marks the pixels that are on the mesh's border, or on that of a cell that is not drawn.
    fn outline(&self, tear: Option<f64>, band: &mut Band<'_>) {
        let (across, down) = (self.across, self.rows.len());
        let last = (down - 1) * across;
        for column in 1..across {
            for start in [0, last] {
                let end = start + column;
                band.mark(self.corners[end - 1], self.corners[end]);
            }
        }
        for row in 1..down {
            for column in [0, across - 1] {
                let end = row * across + column;
                band.mark(self.corners[end - across], self.corners[end]);
            }
        }
        if tear.is_none() && self.is_whole {
            return;
        }
        for row in 0..down - 1 {
            for column in 0..across - 1 {
                let moved = self.cell(row, column);
                if !is_drawn(&moved, tear) {
                    let [a, b, c, d] = moved;
                    for (from, to) in [(a, b), (a, c), (b, d), (c, d)] {
                        band.mark(from, to);
                    }
                }
            }
        }
    }

    /// Draws all cells that reach a band, in order.
    fn draw(&self, tear: Option<f64>, band: &mut Band<'_>) {
        let (top, bottom) = band.span();
        let (top, bottom) = (top - 0.5, bottom + 0.5);
        for (row, &(low, high)) in self.reach.iter().enumerate() {
            if low > bottom || high < top {
                continue;
            }
            let (y0, y1) = (self.rows[row], self.rows[row + 1]);
            for column in 0..self.across - 1 {
                let moved = self.cell(row, column);
                let above = moved.iter().all(|p| p.y < top);
                let below = moved.iter().all(|p| p.y > bottom);
                if above || below || !is_drawn(&moved, tear) {
                    continue;
                }
                let (x0, x1) = (self.columns[column], self.columns[column + 1]);
                let still = [dvec2(x0, y0), dvec2(x1, y0), dvec2(x0, y1), dvec2(x1, y1)];
                for [i, j, k] in [[0, 1, 2], [3, 2, 1]] {
                    band.triangle(
                        [moved[i], moved[j], moved[k]],
                        [still[i], still[j], still[k]],
                    );
                }
            }
        }
    }
}

/// Some rows of the target.
struct Band<'a> {
    first: usize,
    width: usize,
    channels: usize,
    samples: &'a mut [f32],
    layers: &'a mut [u32],
    sampler: &'a Sampler<'a>,
    overlap: Overlap,
    value: Vec<f32>,
    /// For each pixel the number of its part, from 1, or 0 for pixels that are not on the outline; empty if none is.
    slots: Vec<u32>,
    /// Of each pixel on the outline how much of it is covered, then the colours of that weighted by their areas.
    parts: Vec<f64>,
}

/// Coverage above this is all of a pixel, but for rounding.
const WHOLE: f64 = 1.0 - 1e-6;

/// The part of a triangle in the unit square at the origin: its area and its centroid, if there is any.
fn in_square(triangle: [DVec2; 3]) -> Option<(f64, DVec2)> {
    // Each side of the square adds one corner at most.
    let mut corners = [DVec2::ZERO; 8];
    corners[..3].copy_from_slice(&triangle);
    let mut count = 3;
    for axis in 0..2 {
        for (sign, limit) in [(1.0, 0.0), (-1.0, -1.0)] {
            let room = |p: DVec2| sign * p[axis] - limit;
            let mut kept = [DVec2::ZERO; 8];
            let mut number = 0;
            for i in 0..count {
                let (here, next) = (corners[i], corners[(i + 1) % count]);
                let (a, b) = (room(here), room(next));
                if a >= 0.0 && number < kept.len() {
                    kept[number] = here;
                    number += 1;
                }
                if (a < 0.0) != (b < 0.0) && number < kept.len() {
                    kept[number] = here + (next - here) * (a / (a - b));
                    number += 1;
                }
            }
            (corners, count) = (kept, number);
            if count < 3 {
                return None;
            }
        }
    }
    let (mut area, mut sum) = (0.0, DVec2::ZERO);
    for i in 1..count - 1 {
        let (a, b, c) = (corners[0], corners[i], corners[i + 1]);
        let own = 0.5 * (b - a).perp_dot(c - a).abs();
        area += own;
        sum += (a + b + c) * (own / 3.0);
    }
    (area > 0.0).then(|| (area, sum / area))
}

/// Twice the area of the triangle `(a, b, p)`: positive where `p` is to the one side of the edge. Exactly the negative for
/// the edge the other way round, so that neighbours agree on which side a pixel is.
fn side(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let turned = (a.x, a.y) > (b.x, b.y);
    let (from, to) = if turned { (b, a) } else { (a, b) };
    let area = (to - from).perp_dot(p - from);
    if turned { -area } else { area }
}

/// Whether a triangle to the positive side of the edge owns the edge's own points: one of each two edges that run in opposite
/// directions does.
fn owns(a: DVec2, b: DVec2) -> bool {
    (a.x, a.y) < (b.x, b.y)
}

impl Band<'_> {
    /// The centres of the first and the last row.
    fn span(&self) -> (f64, f64) {
        let rows = self.layers.len() / self.width;
        let top = self.first as f64 + 0.5;
        (top, top + rows as f64 - 1.0)
    }

    /// Draws the part of a triangle, with its corners in the target and in the source.
    fn triangle(&mut self, mut moved: [DVec2; 3], mut still: [DVec2; 3]) {
        let mut area = side(moved[0], moved[1], moved[2]);
        if area < 0.0 {
            moved.swap(1, 2);
            still.swap(1, 2);
            area = side(moved[0], moved[1], moved[2]);
        }
        if !(area > 0.0 && area.is_finite()) {
            return;
        }
        let [a, b, c] = moved;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        if !self.slots.is_empty() {
            self.pieces(moved, still, area, (low, high));
        }
        let (top, bottom) = self.span();
        // Pixels whose centres are between; rounding may only add some, which the sides then leave out.
        let whole = |x: f64, most: usize| (x.max(0.0) as usize).min(most);
        if low.x > self.width as f64 || high.x < 0.0 || low.y > bottom || high.y < top {
            return;
        }
        let (left, right) = (
            whole(low.x - 0.5, self.width),
            whole(high.x + 1.0, self.width),
        );
        let rows = self.layers.len() / self.width;
        let (up, down) = (whole(low.y - top, rows), whole(high.y - top + 1.5, rows));
        for row in up..down {
            for column in left..right {
                let p = dvec2(column as f64 + 0.5, top + row as f64);
                let sides = [side(b, c, p), side(c, a, p), side(a, b, p)];
                let edges = [(b, c), (c, a), (a, b)];
                let inside = sides
                    .iter()
                    .zip(edges)
                    .all(|(&s, (from, to))| s > 0.0 || s == 0.0 && owns(from, to));
                if inside {
                    let (u, v) = (sides[1] / area, sides[2] / area);
                    let place = still[0] + (still[1] - still[0]) * u + (still[2] - still[0]) * v;
                    self.put(row * self.width + column, place);
                }
            }
        }
    }

    /// Marks the pixels that a segment goes through as such of the outline.
    fn mark(&mut self, from: DVec2, to: DVec2) {
        let rows = self.layers.len() / self.width;
        let first = self.first as f64;
        let (low, high) = (from.min(to), from.max(to));
        let (top, bottom) = (low.y.max(first), high.y.min(first + rows as f64));
        let is_seen = top <= bottom && high.x >= 0.0 && low.x <= self.width as f64;
        if !(is_seen && from.is_finite() && to.is_finite()) {
            return;
        }
        if self.slots.is_empty() {
            self.slots = vec![0; self.layers.len()];
        }
        let room = self.channels + 1;
        let rise = to.y - from.y;
        let whole = |at: f64, most: usize| (at.max(0.0) as usize).min(most);
        let span = whole(top - first, rows - 1)..=whole(bottom - first, rows - 1);
        for row in span {
            // Where the segment enters and leaves the row.
            let across = |y: f64| {
                let share = if rise == 0.0 {
                    0.0
                } else {
                    (y - from.y) / rise
                };
                from.x + (to.x - from.x) * share.clamp(0.0, 1.0)
            };
            let y = first + row as f64;
            let (mut left, mut right) = (low.x, high.x);
            if rise != 0.0 {
                let (one, other) = (across(y), across(y + 1.0));
                (left, right) = (one.min(other), one.max(other));
            }
            if right < 0.0 || left > self.width as f64 {
                continue;
            }
            let columns = whole(left, self.width - 1)..=whole(right, self.width - 1);
            for column in columns {
                let slot = &mut self.slots[row * self.width + column];
                if *slot == 0 {
                    self.parts.resize(self.parts.len() + room, 0.0);
                    *slot = u32::try_from(self.parts.len() / room).unwrap_or(0);
                }
            }
        }
    }

    /// Adds what of a triangle is in pixels of the outline to them.
    fn pieces(
        &mut self,
        moved: [DVec2; 3],
        still: [DVec2; 3],
        area: f64,
        (low, high): (DVec2, DVec2),
    ) {
        let rows = self.layers.len() / self.width;
        let first = self.first as f64;
        let outside = high.x < 0.0 || low.x > self.width as f64;
        if outside || high.y < first || low.y > first + rows as f64 {
            return;
        }
        let room = self.channels + 1;
        let whole = |at: f64, most: usize| (at.max(0.0) as usize).min(most);
        let columns = whole(low.x, self.width - 1)..=whole(high.x, self.width - 1);
        for row in whole(low.y - first, rows - 1)..=whole(high.y - first, rows - 1) {
            for column in columns.clone() {
                let slot = self.slots[row * self.width + column] as usize;
                if slot == 0 {
                    continue;
                }
                let corner = dvec2(column as f64, first + row as f64);
                let Some((share, middle)) = in_square(moved.map(|p| p - corner)) else {
                    continue;
                };
                let [a, b, c] = moved;
                let p = middle + corner;
                let (u, v) = (side(c, a, p) / area, side(a, b, p) / area);
                let place = still[0] + (still[1] - still[0]) * u + (still[2] - still[0]) * v;
                self.sampler.sample(place, DMat2::IDENTITY, &mut self.value);
                let part = &mut self.parts[(slot - 1) * room..slot * room];
                part[0] += share;
                for (sum, value) in part[1..].iter_mut().zip(&self.value) {
                    *sum += share * f64::from(*value);
                }
            }
        }
    }

    /// Makes pixels of the outline as opaque as they are covered.
    fn finish(&mut self) {
        let room = self.channels + 1;
        for (pixel, &slot) in self.slots.iter().enumerate() {
            let slot = slot as usize;
            if slot == 0 {
                continue;
            }
            let part = &self.parts[(slot - 1) * room..slot * room];
            let covered = part[0];
            let samples = &mut self.samples[pixel * self.channels..(pixel + 1) * self.channels];
            if self.layers[pixel] == 0 {
                let most = covered.max(1.0);
                for (sample, sum) in samples.iter_mut().zip(&part[1..]) {
                    *sample = (sum / most) as f32;
                }
            } else if covered < WHOLE {
                for sample in samples {
                    *sample = (f64::from(*sample) * covered) as f32;
                }
            }
        }
    }

    /// Draws the source's colour at `place` into a pixel.
    fn put(&mut self, pixel: usize, place: DVec2) {
        let layer = self.layers[pixel];
        self.layers[pixel] = layer.saturating_add(1);
        if layer > 0 && self.overlap == Overlap::First {
            return;
        }
        self.sampler.sample(place, DMat2::IDENTITY, &mut self.value);
        let samples = &mut self.samples[pixel * self.channels..(pixel + 1) * self.channels];
        if layer == 0 || self.overlap == Overlap::Last {
            samples.copy_from_slice(&self.value);
            return;
        }
        let share = 1.0 / (f64::from(layer) + 1.0);
        for (sample, new) in samples.iter_mut().zip(&self.value) {
            let (old, new) = (f64::from(*sample), f64::from(*new));
            *sample = (old * (1.0 - share) + new * share) as f32;
        }
    }
}
