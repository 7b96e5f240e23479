//! Light on the model: a sky all around and a key light of some breadth, both with true shadows.
//!
//! Each light is a depth map of the model seen from its direction (L. Williams, *Casting curved shadows on curved
//! surfaces*, SIGGRAPH 1978); the mean over many directions is the ambient occlusion (S. Zhukov, A. Iones, G. Kronin,
//! *An ambient light illumination model*, EGWR 1998) and the soft shadow of the key light at once. The directions are
//! fixed relative to the camera, so that every view is lit well, and sums run in their order: the result does not
//! depend on threads.

use anamorph_core::glam::DVec3;

use crate::mesh::Mesh;
use crate::parallel;
use crate::view::View;

/// Side of a depth map of the sky and of the key light. A shadow's finest detail is about the model's size over half of
/// this.
const SIDES: [usize; 2] = [320, 512];
/// Directions of the sky, and of the key light. Fewer show as bands in soft shadows; more cost time.
const DIRECTIONS: [usize; 2] = [160, 32];
/// Triangles above which a third of the directions must do.
const MANY: usize = 400_000;
/// Sine of the key light's angular radius: the softness of its shadow.
const KEY_BREADTH: f64 = 0.13;
/// Depth maps held at a time.
const BATCH: usize = 8;

/// A place that receives light, and what it has received.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Receiver {
    /// Place in the frame.
    pub point: [f32; 3],
    /// Unit normal towards the viewer; null for a small dot, which receives from all sides alike.
    pub normal: [f32; 3],
    /// Nearness; negative infinity where nothing receives.
    pub near: f32,
    /// Light of the sky and of its reflection from the floor: 1 for an open place that faces up.
    pub sky: [f32; 3],
    /// Visible part of the key light, 0 to 1, whatever the normal.
    pub key: f32,
}

/// A set of parallel lights.
#[derive(Debug)]
pub(crate) struct Lights {
    /// Unit vector to the middle of the key light.
    pub key: DVec3,
    /// Unit vector to the fill light, which casts no shadow.
    pub fill: DVec3,
    lights: Vec<Light>,
}

#[derive(Debug, Clone, Copy)]
struct Light {
    /// Unit vector to the light.
    direction: DVec3,
    /// Contribution to the sky; null for a part of the key light.
    sky: [f32; 3],
    /// Contribution to the key light.
    key: f32,
}

impl Lights {
    /// The lights for a camera, and a number of triangles.
    pub(crate) fn new(view: &View, triangles: usize) -> Self {
        let up = view.up;
        let side = view.right;
        let front = side.cross(up);
        // From the upper left of the camera, as in most drawings.
        let key = (front * 0.78 - side * 0.60 + up * 1.12).normalize();
        let fewer = if triangles > MANY { 3 } else { 1 };
        let [sky_count, key_count] = DIRECTIONS.map(|count| count / fewer);
        let mut lights = Vec::with_capacity(sky_count + key_count);
        let golden = core::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
        for index in 0..sky_count {
            let height = 1.0 - (2.0 * index as f64 + 1.0) / sky_count as f64;
            let (sin, cos) = (golden * index as f64 + 0.4).sin_cos();
            let level = (1.0 - height * height).sqrt();
            let direction = side * (level * cos) + front * (level * sin) + up * height;
            // The mean of max(0, n·d) over the sphere is a quarter.
            let weight = 4.0 / sky_count as f64;
            lights.push(Light {
                direction,
                sky: sky_colour(height).map(|part| (part * weight) as f32),
                key: 0.0,
            });
        }
        let (across, along) = key.any_orthonormal_pair();
        for index in 0..key_count {
            let radius = KEY_BREADTH * ((index as f64 + 0.5) / key_count as f64).sqrt();
            let (sin, cos) = (golden * index as f64).sin_cos();
            let direction = (key + across * (radius * cos) + along * (radius * sin)).normalize();
            lights.push(Light {
                direction,
                sky: [0.0; 3],
                key: 1.0 / key_count as f32,
            });
        }
        let fill = (front * 0.35 + side * 0.9 + up * 0.25).normalize();
        Self { key, fill, lights }
    }

    /// Adds to every receiver the light that reaches it past the model.
    pub(crate) fn cast(&self, mesh: &Mesh, receivers: &mut [Receiver]) {
        let Some(room) = Room::of(mesh) else { return };
        let mut maps: Vec<Map> = (0..BATCH).map(|_| Map::new()).collect();
        for batch in self.lights.chunks(BATCH) {
            parallel::chunks(&mut maps[..batch.len()], 1, |number, maps| {
                for map in maps {
                    map.render(mesh, &room, &batch[number]);
                }
            });
            parallel::chunks(receivers, 1 << 12, |_, chunk| {
                for receiver in chunk
                    .iter_mut()
                    .filter(|receiver| receiver.near > f32::NEG_INFINITY)
                {
                    for (light, map) in batch.iter().zip(&maps) {
                        let facing = if receiver.normal == [0.0; 3] {
                            0.5
                        } else {
                            dot(receiver.normal, map.axes[2])
                        };
                        if facing > 0.0 {
                            let visible = map.visible(receiver.point, receiver.normal);
                            receiver.sky = [0, 1, 2]
                                .map(|k| receiver.sky[k] + light.sky[k] * (facing * visible));
                            receiver.key += light.key * visible;
                        }
                    }
                }
            });
        }
    }
}

/// Light from a direction of the given height (−1 to 1): cool from above, warm and dim from the floor.
fn sky_colour(height: f64) -> [f64; 3] {
    let zenith = [0.97, 1.0, 1.05];
    let horizon = [0.92, 0.93, 0.95];
    let floor = [0.50, 0.46, 0.42];
    let blend = |a: [f64; 3], b: [f64; 3], t: f64| [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * t);
    if height > 0.0 {
        blend(horizon, zenith, height)
    } else {
        blend(horizon, floor, (-height * 3.0).min(1.0))
    }
}

/// The sphere around what casts shadows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Room {
    /// Its centre in the frame.
    pub centre: DVec3,
    /// Its radius.
    pub radius: f64,
}

impl Room {
    /// The sphere around the drawn points of a mesh; `None` if there are none.
    pub(crate) fn of(mesh: &Mesh) -> Option<Self> {
        let mut least = DVec3::INFINITY;
        let mut most = DVec3::NEG_INFINITY;
        let each = |visit: &mut dyn FnMut(DVec3)| {
            for &corner in mesh.triangles.iter().flatten().chain(&mesh.dots) {
                visit(mesh.points[corner as usize]);
            }
        };
        each(&mut |point| (least, most) = (least.min(point), most.max(point)));
        if least.x > most.x {
            return None;
        }
        let centre = (least + most) * 0.5;
        let mut square = 0.0_f64;
        each(&mut |point| square = square.max(point.distance_squared(centre)));
        // A single place still casts a shadow of some size.
        Some(Self {
            centre,
            radius: square.sqrt().max(1e-3),
        })
    }
}

/// The least whole number not below a value that is not negative.
fn above(value: f32) -> usize {
    let whole = value as usize;
    if (whole as f32) < value {
        whole + 1
    } else {
        whole
    }
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Depth of the model from one direction.
struct Map {
    /// Cells along each side.
    side: usize,
    /// Nearness to the light, row by row.
    depth: Vec<f32>,
    /// The points of the model in cells.
    points: Vec<[f32; 3]>,
    /// Across, along, towards the light.
    axes: [[f32; 3]; 3],
    /// Place of the room's centre along the axes.
    centre: [f32; 3],
    /// Cells per unit.
    scale: f32,
}

impl Map {
    fn new() -> Self {
        Self {
            side: 0,
            depth: Vec::new(),
            points: Vec::new(),
            axes: [[0.0; 3]; 3],
            centre: [0.0; 3],
            scale: 1.0,
        }
    }

    fn render(&mut self, mesh: &Mesh, room: &Room, light: &Light) {
        self.side = if light.key > 0.0 { SIDES[1] } else { SIDES[0] };
        self.scale = ((self.side as f64 * 0.5 - 2.0) / room.radius) as f32;
        self.depth.clear();
        self.depth.resize(self.side * self.side, f32::NEG_INFINITY);
        let direction = light.direction;
        let (across, along) = direction.any_orthonormal_pair();
        let axes = [across, along, direction];
        self.axes = axes.map(|axis| axis.to_array().map(|part| part as f32));
        self.centre = axes.map(|axis| axis.dot(room.centre) as f32);
        let mut points = core::mem::take(&mut self.points);
        points.clear();
        points.extend(
            mesh.points
                .iter()
                .map(|point| self.cell(point.to_array().map(|part| part as f32))),
        );
        for &corners in &mesh.triangles {
            self.plot(corners.map(|corner| points[corner as usize]));
        }
        for &dot in &mesh.dots {
            self.put(points[dot as usize]);
        }
        self.points = points;
    }

    /// Raises the cell at a point.
    fn put(&mut self, [x, y, near]: [f32; 3]) {
        let (column, row) = ((x + 0.5).max(0.0) as usize, (y + 0.5).max(0.0) as usize);
        if let Some(cell) = self.depth.get_mut(row * self.side + column)
            && near > *cell
        {
            *cell = near;
        }
    }

    /// Raises the cells inside a triangle, or the one in its middle if it is smaller than a cell.
    fn plot(&mut self, [a, b, c]: [[f32; 3]; 3]) {
        let least = [0, 1].map(|k| a[k].min(b[k]).min(c[k]));
        let most = [0, 1].map(|k| a[k].max(b[k]).max(c[k]));
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if (most[0] - least[0]).max(most[1] - least[1]) < 1.0 {
            self.put([0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0));
            return;
        }
        // Cells are inside where all three edges are to one side.
        let steep = |p: [f32; 3], q: [f32; 3]| [(p[1] - q[1]) / area, (q[0] - p[0]) / area];
        let edges = [(steep(b, c), b), (steep(c, a), c), (steep(a, b), a)];
        let slope =
            [0, 1].map(|k| edges[0].0[k] * a[2] + edges[1].0[k] * b[2] + edges[2].0[k] * c[2]);
        if !(slope[0].is_finite() && slope[1].is_finite()) {
            return;
        }
        // Where each edge crosses row 0, and how far it moves from row to row.
        let lines = edges.map(|([across, down], [x, y, _])| {
            let lean = -down / across;
            [across, x - lean * y, lean, down, y]
        });
        let last = (self.side - 1) as f32;
        let (top, bottom) = (above(least[1].max(0.0)), most[1].min(last) as usize);
        for row in top..=bottom {
            let y = row as f32;
            let (mut low, mut high) = (least[0].max(0.0), most[0].min(last));
            for [across, start, lean, down, level] in lines {
                if across > 0.0 {
                    low = low.max(start + lean * y);
                } else if across < 0.0 {
                    high = high.min(start + lean * y);
                } else if down * (y - level) < 0.0 {
                    high = -1.0;
                }
            }
            if high < 0.0 || low > high {
                continue;
            }
            let (first, end) = (above(low), high as usize + 1);
            let base = a[2] + slope[1] * (y - a[1]) - slope[0] * a[0];
            if let Some(cells) = self
                .depth
                .get_mut(row * self.side + first..row * self.side + end)
            {
                for (step, cell) in cells.iter_mut().enumerate() {
                    let near = base + slope[0] * (first + step) as f32;
                    if near > *cell {
                        *cell = near;
                    }
                }
            }
        }
    }

    /// A point in units of cells, whole numbers at their middles.
    fn cell(&self, point: [f32; 3]) -> [f32; 3] {
        let middle = self.side as f32 * 0.5 - 0.5;
        let at = |axis: usize| (dot(point, self.axes[axis]) - self.centre[axis]) * self.scale;
        [at(0) + middle, at(1) + middle, at(2)]
    }

    /// How much of the light reaches a point, 0 to 1, smoothed over the four nearest cells.
    ///
    /// The point is lifted off its surface by cells rather than by a length: the map's own steepness is what must be
    /// cleared. Less gives dark speckles on lit surfaces, more loosens shadows from what casts them.
    fn visible(&self, point: [f32; 3], normal: [f32; 3]) -> f32 {
        let lift = 1.6 / self.scale;
        let [x, y, near] = self.cell([0, 1, 2].map(|k| point[k] + normal[k] * lift));
        let near = near + 1.0;
        let last = (self.side - 1) as f32;
        if !(x >= 0.0 && y >= 0.0 && x < last && y < last) {
            return 1.0;
        }
        let (column, row) = (x as usize, y as usize);
        let (right, down) = (x - column as f32, y - row as f32);
        let base = row * self.side + column;
        let open = |cell: usize| if self.depth[cell] <= near { 1.0 } else { 0.0 };
        let upper = open(base) * (1.0 - right) + open(base + 1) * right;
        let lower = open(base + self.side) * (1.0 - right) + open(base + self.side + 1) * right;
        upper * (1.0 - down) + lower * down
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::Frame;
    use crate::{Camera, Model};

    fn open_receiver(point: DVec3, normal: DVec3) -> Receiver {
        Receiver {
            point: point.to_array().map(|part| part as f32),
            normal: normal.to_array().map(|part| part as f32),
            near: 1.0,
            ..Receiver::default()
        }
    }

    /// A roof of two triangles at height 0.5 over the origin.
    fn roof() -> Mesh {
        let points = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, z)| DVec3::new(x, 0.5, z));
        let frame = Frame {
            centre: DVec3::ZERO,
            half: 1.0,
        };
        Mesh::new(&Model::mesh(&points, &[[0, 1, 2], [0, 2, 3]]), &frame)
    }

    #[test]
    fn open_sky_is_one_and_a_roof_takes_most_of_it() {
        let view = View::fit(
            &Camera::default(),
            [100, 100],
            core::iter::once(DVec3::ZERO),
        );
        let lights = Lights::new(&view, 0);
        let roof = roof();
        let mut receivers = [
            open_receiver(DVec3::Y, DVec3::Y),
            open_receiver(DVec3::ZERO, DVec3::Y),
        ];
        lights.cast(&roof, &mut receivers);
        assert!(
            (receivers[0].sky[1] - 0.98).abs() < 0.03,
            "{:?}",
            receivers[0]
        );
        assert!((receivers[0].key - 1.0).abs() < 1e-5);
        // Seen from the middle of the floor the roof covers all directions steeper than about 27° to 35°.
        assert!(receivers[1].sky[1] < 0.4, "{:?}", receivers[1]);
        assert!(receivers[1].sky[1] > 0.1, "{:?}", receivers[1]);
    }

    #[test]
    fn a_surface_does_not_shade_itself() {
        let view = View::fit(
            &Camera::default(),
            [100, 100],
            core::iter::once(DVec3::ZERO),
        );
        let lights = Lights::new(&view, 0);
        let mut receivers: Vec<Receiver> = (-9..=9)
            .map(|step| open_receiver(DVec3::new(f64::from(step) * 0.1, 0.5, 0.03), DVec3::Y))
            .collect();
        lights.cast(&roof(), &mut receivers);
        assert!(receivers.iter().all(|receiver| receiver.key > 0.999));
    }
}
