//! Silhouettes: the outlines of what an image shows, by a level of one of its channels or of its luminance.
//!
//! [`silhouette`] follows the level between the centres of pixels, by linear interpolation, or at level ½ by the share that is covered
//! where an edge goes from all to nothing within two pixels (linear interpolation is off there by up to 0.09 pixels); it smooths the outlines,
//! and drops points that a tolerance allows. What is outside the image counts as nothing, so that outlines are closed at its border. Rings are in coordinates of the
//! image, `y` down; outer ones have positive area in these numbers and holes negative.
//!
//! *Source*: W. Lorensen and H. Cline, *Marching Cubes*, SIGGRAPH 1987, in the plane; G. Nielson and B. Hamann, *The Asymptotic
//! Decider*, Visualization 1991, for cells in which the level leaves both pairs of corners apart or joins one; G. Taubin, *A
//! Signal Processing Approach to Fair Surface Design*, SIGGRAPH 1995, for smoothing that does not shrink; D. Douglas and
//! T. Peucker, *Algorithms for the Reduction of the Number of Points*, Cartographica 10, 1973. That rings may not cross while points
//! are dropped, and that smoothing keeps the area of each ring, are decisions.

use crate::shapes::{FillRule, Mended, Ring, Shape, ShapeError, area, centroid, crossings};
use anamorph_core::glam::{DVec2, dvec2};
use anamorph_meshing::planar::Region;
use anamorph_raster::Raster;

/// What of a pixel is compared with the level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// One of its channels, by number from 0; alpha is usually the last.
    Channel(usize),
    /// Its luminance, of the first three channels in linear light with the primaries of sRGB; of the first where there are fewer.
    Luminance,
    /// 1 less its luminance: what is dark on a light ground.
    Darkness,
}

/// How a silhouette is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SilhouetteOptions {
    /// What is compared.
    pub measure: Measure,
    /// What is at least this is inside; above 0.
    pub level: f64,
    /// Passes of smoothing, each over the nearest neighbours; 0 for none.
    pub smoothing: usize,
    /// How far, in pixels, an outline may move where points are dropped; 0 drops only points on straight lines.
    pub tolerance: f64,
    /// Rings that enclose less, in square pixels, are dropped.
    pub least_area: f64,
}

impl Default for SilhouetteOptions {
    fn default() -> Self {
        Self {
            measure: Measure::Channel(3),
            level: 0.5,
            smoothing: 2,
            tolerance: 0.1,
            least_area: 1.0,
        }
    }
}

/// Why an image has no silhouette.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SilhouetteError {
    /// The channel does not exist.
    #[error(
        "the image has no channel {channel}, only {channels}, numbered from 0; choose another, or luminance"
    )]
    NoChannel {
        /// What was asked for.
        channel: usize,
        /// How many there are.
        channels: usize,
    },
    /// An option that cannot be.
    #[error(
        "the {name} {value} cannot be; give a finite number, for the level above 0 and otherwise not below"
    )]
    Option {
        /// Its name.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// Nothing reaches the level.
    #[error(
        "nothing in the image reaches the level {level} over an area of {least_area} square pixels; choose a lower one, or another measure"
    )]
    Nothing {
        /// The level.
        level: f64,
        /// The least area.
        least_area: f64,
    },
    /// The outlines make no regions.
    #[error("the outlines make no regions: {0}")]
    Shape(#[from] ShapeError),
}

/// The regions of an image that reach a level, by their first points.
///
/// Samples that are not numbers count as nothing. Smoothing and dropping points move an outline by some tenths of a pixel at
/// most, and never make it cross another.
///
/// # Errors
/// [`SilhouetteError`].
pub fn silhouette(
    image: &Raster,
    options: &SilhouetteOptions,
) -> Result<Vec<Region>, SilhouetteError> {
    if let Measure::Channel(channel) = options.measure
        && channel >= image.channels()
    {
        return Err(SilhouetteError::NoChannel {
            channel,
            channels: image.channels(),
        });
    }
    let numbers = [
        ("level", options.level, f64::MIN_POSITIVE),
        ("tolerance", options.tolerance, 0.0),
        ("least area", options.least_area, 0.0),
    ];
    for (name, value, least) in numbers {
        if !(value >= least && value.is_finite()) {
            return Err(SilhouetteError::Option { name, value });
        }
    }
    let mut rings = Field::new(image, options).rings();
    rings.retain(|ring| area(ring).abs() >= options.least_area);
    if !rings.iter().any(|ring| area(ring) > 0.0) {
        return Err(SilhouetteError::Nothing {
            level: options.level,
            least_area: options.least_area,
        });
    }
    let smoothed: Vec<Vec<DVec2>> = rings
        .iter()
        .map(|ring| smooth(ring, options.smoothing))
        .collect();
    // Where outlines come within a pixel of each other smoothing may make them cross.
    if options.smoothing > 0 && !crossed(&smoothed).contains(&true) {
        rings = smoothed;
    } else if options.smoothing > 0 {
        let crossed = crossed(&smoothed);
        for ((ring, smoothed), crossed) in rings.iter_mut().zip(smoothed).zip(crossed) {
            if !crossed {
                *ring = smoothed;
            }
        }
    }
    let rings = simplify_rings(&rings, options.tolerance);
    let rings = rings.into_iter().map(|points| Ring {
        points,
        hole: false,
    });
    let shape = Shape {
        rings: rings.collect(),
        fill: FillRule::NonZero,
    };
    let (mut regions, mended): (Vec<Region>, Vec<Mended>) = shape.regions()?;
    if !mended.is_empty() {
        // What crossed in spite of all was resolved, and may have left crumbs.
        regions.retain(|region| area(&region.outer) >= options.least_area);
    }
    let origin = image.window().corner();
    for region in &mut regions {
        for point in region
            .outer
            .iter_mut()
            .chain(region.holes.iter_mut().flatten())
        {
            *point += origin;
        }
    }
    Ok(regions)
}

/// Which rings cross others or themselves.
fn crossed(rings: &[Vec<DVec2>]) -> Vec<bool> {
    let all: Vec<&[DVec2]> = rings.iter().map(Vec::as_slice).collect();
    let mut crossed = vec![false; rings.len()];
    for crossing in crossings(&all, usize::MAX) {
        crossed[crossing.first.0] = true;
        crossed[crossing.second.0] = true;
    }
    crossed
}

/// What is compared with the level, at the centres of the pixels and of those around the image.
struct Field {
    width: usize,
    height: usize,
    level: f64,
    /// The value less the level; rows of `width`.
    values: Vec<f64>,
}

impl Field {
    fn new(image: &Raster, options: &SilhouetteOptions) -> Self {
        let (width, height) = (image.width() + 2, image.height() + 2);
        let mut values = vec![-options.level; width * height];
        let luminance = |pixel: &[f32]| match pixel {
            [r, g, b, ..] => {
                0.2126 * f64::from(*r) + 0.7152 * f64::from(*g) + 0.0722 * f64::from(*b)
            }
            _ => pixel.first().map_or(0.0, |v| f64::from(*v)),
        };
        for row in 0..image.height() {
            for column in 0..image.width() {
                let pixel = image.pixel(column, row);
                let value = match options.measure {
                    Measure::Channel(channel) => pixel.get(channel).map_or(0.0, |v| f64::from(*v)),
                    Measure::Luminance => luminance(pixel),
                    Measure::Darkness => 1.0 - luminance(pixel),
                };
                // What is not a number is nothing; what is infinite is merely large.
                let value = if value.is_nan() {
                    0.0
                } else {
                    value.clamp(-1e30, 1e30)
                };
                values[(row + 1) * width + column + 1] = value - options.level;
            }
        }
        Self {
            width,
            height,
            level: options.level,
            values,
        }
    }

    fn inside(&self, corner: usize) -> bool {
        self.values[corner] >= 0.0
    }

    /// Where the level is between two neighbouring corners, of which the first is inside.
    fn between(&self, inside: usize, outside: usize) -> DVec2 {
        let (a, b) = (self.values[inside], self.values[outside]);
        let share = self.edge(inside, outside).unwrap_or(a / (a - b));
        // Never at a corner: there four outlines could meet.
        let share = share.clamp(1e-6, 1.0 - 1e-6);
        let place = |corner: usize| {
            // Corner 1 is the centre of the first pixel.
            dvec2((corner % self.width) as f64, (corner / self.width) as f64) - 0.5
        };
        place(inside) + (place(outside) - place(inside)) * share
    }

    /// Where the edge is of something that covers all behind one corner and nothing beyond the other: values are shares of
    /// pixels that are covered, and their sum is how far it reaches. None where values are no such shares.
    fn edge(&self, inside: usize, outside: usize) -> Option<f64> {
        if self.level != 0.5 {
            return None;
        }
        let value = |corner: usize| self.values[corner] + self.level;
        let at = |corner: usize| (corner % self.width, corner / self.width);
        let ((x, y), (to_x, to_y)) = (at(inside), at(outside));
        // What is inside is never on the rim, what is outside may be.
        let behind = (2 * y - to_y) * self.width + 2 * x - to_x;
        let (x, y) = ((2 * to_x).wrapping_sub(x), (2 * to_y).wrapping_sub(y));
        let beyond = if x < self.width && y < self.height {
            value(y * self.width + x)
        } else {
            0.0
        };
        let (behind, first, second) = (value(behind), value(inside), value(outside));
        let covers = behind > 0.98 && beyond < 0.02 && behind <= 1.0 && beyond >= 0.0;
        let falls = behind >= first && first >= second && second >= beyond;
        (covers && falls).then_some(behind + first + second + beyond - 1.5)
    }

    /// Closed outlines, with what is inside on the side that makes its area positive.
    fn rings(&self) -> Vec<Vec<DVec2>> {
        // Each edge between corners that the level crosses is left by one segment: edges are numbered by their corner, those
        // to the right even and those down odd.
        let mut next: Vec<u32> = vec![u32::MAX; 2 * self.width * self.height];
        let edges = |corner: usize| {
            // Top, right, bottom, left.
            [
                2 * corner,
                2 * (corner + 1) + 1,
                2 * (corner + self.width),
                2 * corner + 1,
            ]
        };
        for row in 0..self.height - 1 {
            for column in 0..self.width - 1 {
                let corner = row * self.width + column;
                let corners = [
                    corner,
                    corner + 1,
                    corner + self.width + 1,
                    corner + self.width,
                ];
                let inside = corners.map(|c| self.inside(c));
                let count = inside.iter().filter(|inside| **inside).count();
                if count == 0 || count == 4 {
                    continue;
                }
                let edges = edges(corner);
                // Around the cell, clockwise as seen: side k lies between corners k and k + 1. A segment enters by a side
                // that goes from inside to outside, and leaves by one that goes from outside to inside.
                let leaving = |k: usize| !inside[k] && inside[(k + 1) % 4];
                let entering = |k: usize| inside[k] && !inside[(k + 1) % 4];
                let apart = count == 2 && inside[0] == inside[2];
                let joined = apart && {
                    let [a, b, c, d] = corners.map(|c| self.values[c]);
                    // The value where the bilinear surface is level.
                    let sum = a + c - b - d;
                    let saddle = (a * c - b * d) / sum;
                    saddle.is_finite() && saddle >= 0.0
                };
                for from in (0..4).filter(|&k| entering(k)) {
                    // Joined: to the next side on; apart: back around the corner that is inside.
                    let order = if joined { [1, 2, 3] } else { [3, 2, 1] };
                    let to = order
                        .into_iter()
                        .map(|step| (from + step) % 4)
                        .find(|&k| leaving(k));
                    if let Some(to) = to {
                        #[allow(clippy::cast_possible_truncation)]
                        {
                            next[edges[from]] = edges[to] as u32;
                        }
                    }
                }
            }
        }
        let mut rings = Vec::new();
        for start in 0..next.len() {
            if next[start] == u32::MAX {
                continue;
            }
            let mut ring = Vec::new();
            let mut edge = start;
            while next[edge] != u32::MAX {
                let (first, second) = (
                    edge / 2,
                    edge / 2
                        + if edge.is_multiple_of(2) {
                            1
                        } else {
                            self.width
                        },
                );
                ring.push(if self.inside(first) {
                    self.between(first, second)
                } else {
                    self.between(second, first)
                });
                edge = core::mem::replace(&mut next[edge], u32::MAX) as usize;
            }
            rings.push(ring);
        }
        rings
    }
}

/// A closed ring smoothed without shrinking: its area and its centroid stay.
pub fn smooth(ring: &[DVec2], passes: usize) -> Vec<DVec2> {
    let count = ring.len();
    if passes == 0 || count < 5 {
        return ring.to_vec();
    }
    let mut points = ring.to_vec();
    for _ in 0..passes {
        // Forth and a little more back: what varies slowly stays.
        for strength in [0.5, -0.53] {
            let moved = (0..count).map(|i| {
                let mean = (points[(i + count - 1) % count] + points[(i + 1) % count]) * 0.5;
                points[i] + (mean - points[i]) * strength
            });
            points = moved.collect();
        }
    }
    let (before, behind) = (area(ring), area(&points));
    let scale = (before / behind).sqrt();
    if !(scale.is_finite() && (0.5..2.0).contains(&scale)) {
        return ring.to_vec();
    }
    let (from, to) = (centroid(&points), centroid(ring));
    for point in &mut points {
        *point = to + (*point - from) * scale;
    }
    points
}

/// Closed rings with fewer points: every point that is dropped is within `tolerance` of the edge that takes its place, and rings that
/// did not cross or touch do not. At least three points of each ring stay.
pub fn simplify_rings(rings: &[Vec<DVec2>], tolerance: f64) -> Vec<Vec<DVec2>> {
    let mut kept: Vec<Vec<usize>> = rings
        .iter()
        .map(|ring| douglas_peucker(ring, tolerance))
        .collect();
    loop {
        let simple: Vec<Vec<DVec2>> = kept
            .iter()
            .zip(rings)
            .map(|(kept, ring)| kept.iter().map(|&i| ring[i]).collect())
            .collect();
        let all: Vec<&[DVec2]> = simple.iter().map(Vec::as_slice).collect();
        // Edges that cross get back the point that is farthest from them.
        let mut back: Vec<(usize, usize)> = crossings(&all, usize::MAX)
            .into_iter()
            .flat_map(|crossing| [crossing.first, crossing.second])
            .collect();
        back.sort_unstable();
        back.dedup();
        let mut any = false;
        for &(r, edge) in back.iter().rev() {
            let ring = &rings[r];
            let (from, to) = (kept[r][edge], kept[r][(edge + 1) % kept[r].len()]);
            if let Some((far, _)) = farthest(ring, from, to) {
                kept[r].insert(edge + 1, far);
                any = true;
            }
        }
        if !any {
            return simple;
        }
    }
}

/// The point between two of a ring that is farthest from the segment from the one to the other.
fn farthest(ring: &[DVec2], from: usize, to: usize) -> Option<(usize, f64)> {
    let count = ring.len();
    let between = (to + count - from) % count;
    let along = ring[to] - ring[from];
    let mut most: Option<(usize, f64)> = None;
    for step in 1..between {
        let i = (from + step) % count;
        let ahead = ring[i] - ring[from];
        let t = ahead.dot(along) / along.length_squared();
        let t = if t > 0.0 { t.min(1.0) } else { 0.0 };
        let far = (ahead - along * t).length();
        if most.is_none_or(|(_, most)| far > most) {
            most = Some((i, far));
        }
    }
    most
}

/// The points of a ring that stay, in order from the first.
fn douglas_peucker(ring: &[DVec2], tolerance: f64) -> Vec<usize> {
    let count = ring.len();
    if count <= 3 {
        return (0..count).collect();
    }
    // From the first point the farthest, from that again, and what is farthest from both.
    let far = |from: usize| {
        let far = |i: usize| ring[i].distance_squared(ring[from]);
        (0..count).fold(from, |most, i| if far(i) > far(most) { i } else { most })
    };
    let first = far(0);
    let second = far(first);
    let mut keep = vec![false; count];
    keep[first] = true;
    keep[second] = true;
    let mut spans = vec![(first, second), (second, first)];
    let mut widest: Option<(usize, f64)> = None;
    while let Some((from, to)) = spans.pop() {
        let Some((at, off)) = farthest(ring, from, to) else {
            continue;
        };
        if off > tolerance {
            keep[at] = true;
            spans.extend([(from, at), (at, to)]);
        } else if widest.is_none_or(|(_, most)| off > most) {
            widest = Some((at, off));
        }
    }
    // A ring has three points.
    if keep.iter().filter(|keep| **keep).count() < 3
        && let Some((at, _)) = widest
    {
        keep[at] = true;
    }
    let kept = keep.iter().enumerate();
    kept.filter_map(|(i, keep)| keep.then_some(i)).collect()
}
