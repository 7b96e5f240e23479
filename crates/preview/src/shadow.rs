//! Depth of a model from a direction, as shadows need it.

use anamorph_core::glam::DVec3;

use crate::mesh::Mesh;

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

/// What casts shadows, for depth maps of one size: larger triangles, and points in place of small ones, thinned to about one for each cell whatever the size of the mesh.
pub(crate) struct Casters {
    room: Room,
    side: usize,
    /// Cells per unit.
    scale: f32,
    triangles: Vec<[[f32; 3]; 3]>,
    points: Vec<[f32; 3]>,
}

/// Longest side, in cells, of a triangle that its corners and its middle stand for.
const SMALL: f32 = 1.8;
/// Side in cells of the cube that keeps one point. More leaves holes in the depth.
const THINNING: f32 = 0.9;

impl Casters {
    /// The casters of a mesh for maps of `side` × `side` cells.
    pub(crate) fn new(mesh: &Mesh, room: &Room, side: usize) -> Self {
        let scale = ((side as f64 * 0.5 - 2.0) / room.radius) as f32;
        let mut casters = Self {
            room: *room,
            side,
            scale,
            triangles: Vec::new(),
            points: Vec::new(),
        };
        let least = (room.centre - room.radius)
            .to_array()
            .map(|part| part as f32);
        let count = (side as f32 / THINNING) as usize + 2;
        let mut taken = vec![0_u64; (count * count * count).div_ceil(64)];
        let mut fresh = |point: [f32; 3]| {
            let cube =
                [0, 1, 2].map(|k| ((point[k] - least[k]) * scale / THINNING).max(0.0) as usize);
            let index = (cube[2] * count + cube[1]) * count + cube[0];
            let Some(word) = taken.get_mut(index / 64) else {
                return true;
            };
            let bit = 1 << (index % 64);
            let fresh = *word & bit == 0;
            *word |= bit;
            fresh
        };
        let at = |index: u32| {
            mesh.points[index as usize]
                .to_array()
                .map(|part| part as f32)
        };
        for corners in &mesh.triangles {
            let [a, b, c] = corners.map(at);
            let long =
                |p: [f32; 3], q: [f32; 3]| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f32>();
            if long(a, b).max(long(b, c)).max(long(c, a)) * scale * scale < SMALL * SMALL {
                let middle = [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0);
                casters
                    .points
                    .extend([middle, a, b, c].into_iter().filter(|&point| fresh(point)));
            } else {
                casters.triangles.push([a, b, c]);
            }
        }
        casters.points.extend(
            mesh.dots
                .iter()
                .map(|&dot| at(dot))
                .filter(|&point| fresh(point)),
        );
        casters
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

pub(crate) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Depth of the model from one direction.
pub(crate) struct Map {
    /// Cells along each side.
    side: usize,
    /// Nearness to the light, row by row.
    depth: Vec<f32>,
    /// Across, along, towards the light.
    axes: [[f32; 3]; 3],
    /// Place of the room's centre along the axes.
    centre: [f32; 3],
    /// Cells per unit.
    scale: f32,
}

impl Map {
    pub(crate) fn new() -> Self {
        Self {
            side: 0,
            depth: Vec::new(),
            axes: [[0.0; 3]; 3],
            centre: [0.0; 3],
            scale: 1.0,
        }
    }

    /// The unit vector to the light.
    pub(crate) fn direction(&self) -> [f32; 3] {
        self.axes[2]
    }

    /// Draws the depth of the model from `direction`, a unit vector.
    pub(crate) fn render(&mut self, casters: &Casters, direction: DVec3) {
        self.side = casters.side;
        self.scale = casters.scale;
        self.depth.clear();
        self.depth.resize(self.side * self.side, f32::NEG_INFINITY);
        let (across, along) = direction.any_orthonormal_pair();
        let axes = [across, along, direction];
        self.axes = axes.map(|axis| axis.to_array().map(|part| part as f32));
        self.centre = axes.map(|axis| axis.dot(casters.room.centre) as f32);
        for corners in &casters.triangles {
            self.plot(corners.map(|corner| self.cell(corner)));
        }
        for &point in &casters.points {
            self.put(self.cell(point));
        }
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

    /// Raises the cells inside a triangle.
    fn plot(&mut self, [a, b, c]: [[f32; 3]; 3]) {
        let least = [0, 1].map(|k| a[k].min(b[k]).min(c[k]));
        let most = [0, 1].map(|k| a[k].max(b[k]).max(c[k]));
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
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
    pub(crate) fn visible(&self, point: [f32; 3], normal: [f32; 3]) -> f32 {
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
