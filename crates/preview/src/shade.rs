//! A panel in space without its marks: the model in its light, on a floor that shows only by the model's shadow.

use anamorph_core::glam::DVec3;

use crate::light::{Lights, Receiver};
use crate::mesh::{Mesh, vec3};
use crate::overlay::DEEP;
use crate::palette::{Linear, Palette, mix, scale};
use crate::parallel;
use crate::raster::{Ball, DepthBuffer, Plot, in_samples};
use crate::shadow::Room;
use crate::view::View;

/// What is seen at one sample.
struct Surface {
    point: DVec3,
    /// Unit normal towards the viewer; null for a dot.
    normal: DVec3,
    /// Unit vector to the camera.
    eye: DVec3,
    colour: Linear,
    near: f64,
    /// For dots: how far the surface stands out, 0 to 1.
    height: f32,
}

/// The samples of a pixel that see the same thing.
struct Group {
    id: u32,
    count: usize,
    /// Sums of the places.
    column: usize,
    line: usize,
}

/// Light found for one surface of a pixel.
struct Known {
    point: DVec3,
    normal: DVec3,
    sky: [f32; 3],
    key: f32,
}

/// Light at every cell of the picture.
struct Gathered {
    receivers: Vec<Receiver>,
    columns: usize,
    lights: Lights,
}

/// Everything needed to shade the samples of a panel.
pub(crate) struct Scene<'a> {
    pub mesh: &'a Mesh,
    pub view: &'a View,
    pub palette: &'a Palette,
    pub buffer: &'a DepthBuffer,
    /// Radius of dots in pixels.
    pub radius: f64,
    /// Nearest and farthest distance of what is drawn.
    pub range: [f64; 2],
    normals: Vec<[[f32; 3]; 3]>,
}

/// Side in pixels of a cell of the model that receives light. Shadows are soft; more blurs creases.
const CELL: usize = 2;
/// Side in pixels of a cell of the floor's shadow. More shows at the feet.
const FLOOR_CELL: usize = 3;

impl<'a> Scene<'a> {
    pub(crate) fn new(
        mesh: &'a Mesh,
        view: &'a View,
        palette: &'a Palette,
        buffer: &'a DepthBuffer,
        radius: f64,
        range: [f64; 2],
    ) -> Self {
        let normals = mesh.corner_normals();
        Self {
            mesh,
            view,
            palette,
            buffer,
            radius,
            range,
            normals,
        }
    }

    /// The panel's pixels in linear light.
    pub(crate) fn paint(&self) -> Vec<Linear> {
        let [width, height] = self.view.size;
        let lights = Lights::new(self.view);
        let [columns, rows] = [width.div_ceil(CELL), height.div_ceil(CELL)];
        let mut receivers = vec![
            Receiver {
                near: f32::NEG_INFINITY,
                ..Receiver::default()
            };
            columns * rows
        ];
        parallel::chunks(&mut receivers, columns, |row, line| {
            for (column, receiver) in line.iter_mut().enumerate() {
                if let Some(found) = self.receiver(column, row) {
                    *receiver = found;
                }
            }
        });
        // The floor's receivers follow the model's: one round of depth maps serves both.
        let model = receivers.len();
        let floor = Floor::receivers(self);
        receivers.extend_from_slice(&floor.receivers);
        lights.cast(self.mesh, &mut receivers);
        let floor = floor.finish(self, &lights, &receivers[model..]);
        receivers.truncate(model);
        let light = Gathered {
            receivers,
            columns,
            lights,
        };
        let mut pixels = vec![[0.0; 3]; width * height];
        parallel::chunks(&mut pixels, width, |y, row| {
            let mut groups = Vec::new();
            for (x, pixel) in row.iter_mut().enumerate() {
                *pixel = self.pixel(x, y, &light, &floor, &mut groups);
            }
        });
        pixels
    }

    /// The mean over the samples of a pixel. Samples that see the same triangle are shaded once, in their middle.
    fn pixel(
        &self,
        x: usize,
        y: usize,
        light: &Gathered,
        floor: &Floor,
        groups: &mut Vec<Group>,
    ) -> Linear {
        let side = self.buffer.per_pixel;
        groups.clear();
        for (column, line) in self.samples_of(x, y) {
            let id = self.buffer.samples[line * self.buffer.width + column].id;
            match groups.iter_mut().find(|group| group.id == id) {
                Some(group) => {
                    group.count += 1;
                    group.column += column;
                    group.line += line;
                }
                None => groups.push(Group {
                    id,
                    count: 1,
                    column,
                    line,
                }),
            }
        }
        let mut sum = [0.0_f32; 3];
        let mut known = None;
        for group in groups {
            let share = group.count as f32 / (side * side) as f32;
            let place = [group.column, group.line].map(|total| total as f64 / group.count as f64);
            let colour = match self.surface(place, group.id) {
                Some(surface) => self.shade(&surface, light, x, y, &mut known),
                None => floor.shade(self, x, y),
            };
            sum = [0, 1, 2].map(|k| sum[k] + colour[k] * share);
        }
        sum
    }

    fn samples_of(&self, x: usize, y: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
        let side = self.buffer.per_pixel;
        (0..side * side).map(move |index| (x * side + index % side, y * side + index / side))
    }

    /// The covered sample nearest to the middle of a cell, as a receiver of light.
    fn receiver(&self, column: usize, row: usize) -> Option<Receiver> {
        let [width, height] = self.view.size;
        let side = self.buffer.per_pixel;
        let middle = CELL * side - 1;
        let (mut best, mut found) = (usize::MAX, None);
        for y in row * CELL..((row + 1) * CELL).min(height) {
            for x in column * CELL..((column + 1) * CELL).min(width) {
                for (across, down) in self.samples_of(x, y) {
                    let id = self.buffer.samples[down * self.buffer.width + across].id;
                    let off = |place: usize, cell: usize| {
                        (2 * (place - cell * CELL * side)).abs_diff(middle)
                    };
                    let away = off(across, column).pow(2) + off(down, row).pow(2);
                    if id != 0 && away < best {
                        (best, found) = (away, Some((across, down, id)));
                    }
                }
            }
        }
        let (across, down, id) = found?;
        let surface = self.surface([across as f64, down as f64], id)?;
        Some(Receiver {
            point: surface.point.to_array().map(|part| part as f32),
            normal: surface.normal.to_array().map(|part| part as f32),
            near: surface.near as f32,
            ..Receiver::default()
        })
    }

    /// What the triangle or dot `id` shows at a place in samples; `None` for nothing.
    fn surface(&self, [column, line]: [f64; 2], id: u32) -> Option<Surface> {
        let index = (id as usize).checked_sub(1)?;
        let side = self.buffer.per_pixel;
        let Some(&corners) = self.mesh.triangles.get(index) else {
            let dot = *self.mesh.dots.get(index - self.mesh.triangles.len())?;
            let point = self.mesh.points[dot as usize];
            let ball = Ball::new(
                in_samples(self.view, point, side),
                self.view,
                self.radius,
                side,
            );
            return Some(Surface {
                point,
                normal: DVec3::ZERO,
                eye: self.view.toward_camera(point),
                colour: self.mesh.colour(dot, self.palette.dot),
                near: self.view.project(point).near,
                height: ball.height(column, line).unwrap_or(0.0) as f32,
            });
        };
        let places = corners.map(|corner| self.mesh.points[corner as usize]);
        let pixels = places.map(|place| in_samples(self.view, place, side));
        let weights = Plot::new(pixels)
            .map_or([1.0 / 3.0; 3], |plot| plot.weights(column, line))
            .map(|weight| weight.clamp(0.0, 1.0));
        let sum = weights[0] + weights[1] + weights[2];
        let weights = self.view.true_weights(
            weights.map(|weight| weight / sum),
            pixels.map(|pixel| pixel.near),
        );
        let point = places[0] * weights[0] + places[1] * weights[1] + places[2] * weights[2];
        let eye = self.view.toward_camera(point);
        let face = (places[1] - places[0]).cross(places[2] - places[0]);
        let inside = face.dot(eye) < 0.0;
        let [a, b, c] = self.normals[index].map(vec3);
        let blended = (a * weights[0] + b * weights[1] + c * weights[2])
            .normalize_or(face.normalize_or_zero());
        let mut normal = if inside { -blended } else { blended };
        // Near the outline a blended normal may look away; bring it back to the rim.
        let away = normal.dot(eye);
        if away < 0.0 {
            normal = (normal - eye * (away * 1.01)).normalize_or(eye);
        }
        let own = |corner: u32| self.mesh.colour(corner, self.palette.material);
        let parts = corners.map(own);
        let mut colour =
            [0, 1, 2].map(|k| (0..3).map(|i| parts[i][k] * weights[i] as f32).sum::<f32>());
        if inside {
            colour = mix(scale(colour, 0.55), self.palette.inside, 0.75);
        }
        Some(Surface {
            point,
            normal,
            eye,
            colour,
            near: self.view.project(point).near,
            height: 1.0,
        })
    }

    /// Light of the sky and the key at a pixel, smoothed over the receivers around it that lie on the same surface.
    fn gather(&self, surface: &Surface, light: &Gathered, x: usize, y: usize) -> ([f32; 3], f32) {
        // In units of cells, whole numbers in their middles.
        let place = [x, y].map(|part| (part as f32 + 0.5) / CELL as f32 - 0.5);
        let rows = light.receivers.len() / light.columns.max(1);
        let reach = (self.view.pixel_length(self.view.distance_of(surface.near)) * 4.0) as f32;
        let point = surface.point.to_array().map(|part| part as f32);
        let normal = surface.normal.to_array().map(|part| part as f32);
        let dot = surface.normal == DVec3::ZERO;
        let around = |part: f32, count: usize| {
            let middle = (part + 0.5).max(0.0) as usize;
            middle.saturating_sub(2)..(middle + 3).min(count)
        };
        let (mut sky, mut key, mut total) = ([0.0_f32; 3], 0.0_f32, 0.0_f32);
        for row in around(place[1], rows) {
            for column in around(place[0], light.columns) {
                let receiver = &light.receivers[row * light.columns + column];
                if receiver.near == f32::NEG_INFINITY {
                    continue;
                }
                let (dx, dy) = (column as f32 - place[0], row as f32 - place[1]);
                let close = 1.0 / (1.0 + 0.5 * (dx * dx + dy * dy)).powi(2);
                let apart = [0, 1, 2].map(|k| receiver.point[k] - point[k]);
                let same = if dot {
                    let gap =
                        (apart[0].powi(2) + apart[1].powi(2) + apart[2].powi(2)) / (reach * reach);
                    1.0 / (1.0 + gap * gap)
                } else {
                    // Off the tangent plane, or turned away: another surface.
                    let gap = (apart[0] * normal[0] + apart[1] * normal[1] + apart[2] * normal[2])
                        / reach;
                    let turn = (0..3)
                        .map(|k| receiver.normal[k] * normal[k])
                        .sum::<f32>()
                        .max(0.0);
                    turn.powi(8) / (1.0 + gap.powi(4))
                };
                // The small constant settles a place that is like none of its neighbours.
                let weight = close * (same + 1e-5);
                sky = [0, 1, 2].map(|k| sky[k] + receiver.sky[k] * weight);
                key += receiver.key * weight;
                total += weight;
            }
        }
        if total > 0.0 {
            (scale(sky, 1.0 / total), key / total)
        } else {
            ([0.9; 3], 1.0)
        }
    }

    fn shade(
        &self,
        surface: &Surface,
        light: &Gathered,
        x: usize,
        y: usize,
        known: &mut Option<Known>,
    ) -> Linear {
        let palette = self.palette;
        let lights = &light.lights;
        let near_enough = self.view.pixel_length(self.view.distance_of(surface.near)) * 2.0;
        let (sky, key) = match known {
            Some(known)
                if known.normal.dot(surface.normal) > 0.95
                    && known.point.distance(surface.point) < near_enough =>
            {
                (known.sky, known.key)
            }
            _ => {
                let (sky, key) = self.gather(surface, light, x, y);
                *known = Some(Known {
                    point: surface.point,
                    normal: surface.normal,
                    sky,
                    key,
                });
                (sky, key)
            }
        };
        let key_colour = [1.0, 0.955, 0.89];
        if surface.normal == DVec3::ZERO {
            let round = 0.72 + 0.4 * surface.height;
            let lit = [0, 1, 2].map(|k| {
                surface.colour[k]
                    * round
                    * (sky[k] * palette.sky * 1.15 + key_colour[k] * key * palette.key * 0.62)
            });
            let distance = self.view.distance_of(surface.near);
            let depth = (distance - self.range[0]) / (self.range[1] - self.range[0]).max(DEEP);
            let [width, height] = self.view.size.map(|side| side as f32);
            let air = palette.background(x as f32 / width, y as f32 / height, width / height);
            return mix(soft(lit), air, 0.45 * depth.clamp(0.0, 1.0) as f32);
        }
        let (normal, eye) = (surface.normal, surface.eye);
        let toward_key = normal.dot(lights.key).max(0.0) as f32;
        let facing = normal.dot(eye).clamp(0.0, 1.0) as f32;
        let half = (lights.key + eye).normalize_or(eye);
        let glance = normal.dot(half).max(0.0) as f32;
        let open = (sky[0] + sky[1] + sky[2]) / 3.0;
        // The fill light wraps around and is dimmed where the sky is hidden.
        let fill =
            (normal.dot(lights.fill) as f32 * 0.7 + 0.3).max(0.0) * (0.25 + 0.75 * open.min(1.0));
        // Porcelain: a broad sheen under a small highlight.
        let gloss =
            key * toward_key.min(0.25) * 4.0 * (0.10 * glance.powi(70) + 0.055 * glance.powi(14));
        let rim = palette.rim
            * (1.0 - facing).powi(4)
            * open
            * (0.6 + 0.4 * normal.dot(self.view.up) as f32).max(0.0);
        let lit = [0, 1, 2].map(|k| {
            let light = sky[k] * palette.sky
                + key_colour[k] * key * toward_key * palette.key
                + fill * palette.fill_light * [0.92, 0.98, 1.06][k];
            // A little of the light that reaches a hollow has met the material before.
            let bounce = 1.0 + (1.0 - open.min(1.0)) * surface.colour[k] * 0.35;
            surface.colour[k] * light * bounce + gloss + rim * [0.9, 0.96, 1.05][k]
        });
        soft(lit)
    }
}

/// Keeps highlights below white: straight up to 0.7, then bending towards 1.
fn soft(colour: Linear) -> Linear {
    const KNEE: f32 = 0.7;
    colour.map(|part| {
        if part <= KNEE {
            part
        } else {
            KNEE + (1.0 - KNEE) * (1.0 - (-(part - KNEE) / (1.0 - KNEE)).exp())
        }
    })
}

/// The floor before it is lit.
struct DarkFloor {
    /// Corners of the cells, row by row; empty if no floor is seen.
    receivers: Vec<Receiver>,
    columns: usize,
    /// Place on the floor below the model's middle, and the model's radius.
    below: DVec3,
    radius: f64,
}

/// The shadow on the floor, by cells of a few pixels.
struct Floor {
    /// Part of the open light that arrives, at the corners of the cells; empty if no floor is seen.
    open: Vec<f32>,
    columns: usize,
}

impl DarkFloor {
    /// How far a place on the floor is from below the model's middle, in radii of the model.
    fn far(&self, point: DVec3) -> f64 {
        point.distance(self.below) / self.radius
    }

    fn finish(self, scene: &Scene<'_>, lights: &Lights, lit: &[Receiver]) -> Floor {
        let [sky, key] = [
            scene.palette.sky,
            scene.palette.key * lights.key.dot(scene.view.up) as f32,
        ];
        let open: Vec<f32> = lit
            .iter()
            .map(|receiver| {
                if receiver.near == f32::NEG_INFINITY {
                    return 1.0;
                }
                let part = (receiver.sky[1].min(OPEN_SKY) * sky + receiver.key * key)
                    / (OPEN_SKY * sky + key);
                let t = ((self.far(vec3(receiver.point)) - FADE[0]) / (FADE[1] - FADE[0]))
                    .clamp(0.0, 1.0) as f32;
                let fade = t * t * (3.0 - 2.0 * t);
                part + (1.0 - part) * fade
            })
            .collect();
        let open = smoothed(&open, self.columns);
        Floor {
            open,
            columns: self.columns,
        }
    }
}

/// The values of a grid, each blended with its eight neighbours: edges of single shadows disappear.
fn smoothed(values: &[f32], columns: usize) -> Vec<f32> {
    let blend = |before: f32, own: f32, after: f32| (before + 2.0 * own + after) * 0.25;
    let mut across = Vec::with_capacity(values.len());
    for row in values.chunks(columns.max(1)) {
        for (index, &own) in row.iter().enumerate() {
            let before = row[index.saturating_sub(1)];
            across.push(blend(
                before,
                own,
                row.get(index + 1).copied().unwrap_or(own),
            ));
        }
    }
    let at = |index: Option<usize>| index.and_then(|index| across.get(index)).copied();
    (0..across.len())
        .map(|index| {
            let own = across[index];
            blend(
                at(index.checked_sub(columns)).unwrap_or(own),
                own,
                at(Some(index + columns)).unwrap_or(own),
            )
        })
        .collect()
}

impl Floor {
    /// The places whose light is wanted.
    fn receivers(scene: &Scene<'_>) -> DarkFloor {
        let view = scene.view;
        let mut floor = DarkFloor {
            receivers: Vec::new(),
            columns: 0,
            below: DVec3::ZERO,
            radius: 1.0,
        };
        let Some(room) = Room::of(scene.mesh) else {
            return floor;
        };
        // Seen from below or edge-on there is no floor.
        if view.toward.dot(view.up) < 0.02 {
            return floor;
        }
        let drawn = scene
            .mesh
            .triangles
            .iter()
            .flatten()
            .chain(&scene.mesh.dots);
        let level = drawn
            .map(|&corner| scene.mesh.points[corner as usize].dot(view.up))
            .fold(f64::INFINITY, f64::min)
            - 0.004 * room.radius;
        floor.columns = view.size[0] / FLOOR_CELL + 2;
        let rows = view.size[1] / FLOOR_CELL + 2;
        floor.radius = room.radius;
        floor.below = room.centre - view.up * (room.centre.dot(view.up) - level);
        for index in 0..floor.columns * rows {
            let mut receiver = Receiver {
                near: f32::NEG_INFINITY,
                ..Receiver::default()
            };
            let place = [index % floor.columns, index / floor.columns]
                .map(|part| (part * FLOOR_CELL) as f64);
            let (origin, direction) = view.ray(place[0], place[1]);
            let along = (level - origin.dot(view.up)) / direction.dot(view.up);
            let point = origin + direction * along;
            if along > 0.0 && floor.far(point) < FADE[1] {
                receiver.point = point.to_array().map(|part| part as f32);
                receiver.normal = view.up.to_array().map(|part| part as f32);
                receiver.near = 1.0;
            }
            floor.receivers.push(receiver);
        }
        floor
    }

    /// Background and shadow at a pixel.
    fn shade(&self, scene: &Scene<'_>, x: usize, y: usize) -> Linear {
        let [width, height] = scene.view.size.map(|side| side as f32);
        let palette = scene.palette;
        let plain = palette.background(
            (x as f32 + 0.5) / width,
            (y as f32 + 0.5) / height,
            width / height,
        );
        if self.open.is_empty() {
            return plain;
        }
        let part = |place: usize| {
            (place % FLOOR_CELL) as f32 / FLOOR_CELL as f32 + 0.5 / FLOOR_CELL as f32
        };
        let base = y / FLOOR_CELL * self.columns + x / FLOOR_CELL;
        let at = |offset: usize| self.open.get(base + offset).copied().unwrap_or(1.0);
        let (right, down) = (part(x), part(y));
        let upper = at(0) + (at(1) - at(0)) * right;
        let lower = at(self.columns) + (at(self.columns + 1) - at(self.columns)) * right;
        let open = 1.0 - (1.0 - (upper + (lower - upper) * down)) * palette.shadow;
        // Shadows of warm light are a little cool.
        let tint = [1.0, 0.985, 0.96];
        [0, 1, 2].map(|k| plain[k] * open.powf(1.0 / tint[k]))
    }
}

/// Light of the sky on an open floor.
const OPEN_SKY: f32 = 0.98;

/// Where the floor's shadow begins and ends to fade, in radii of the model from below its middle.
const FADE: [f64; 2] = [1.3, 2.6];
