//! The depth buffer: which triangle or dot is nearest at every sample.

use anamorph_core::glam::DVec3;

use crate::mesh::Mesh;
use crate::parallel;
use crate::view::{Pixel, View};

/// What is nearest at one sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    /// Its nearness ([`Pixel::near`]); negative infinity where there is nothing.
    pub near: f32,
    /// 0 for nothing, `1 + t` for triangle `t`, `1 + triangles + d` for dot `d`.
    pub id: u32,
}

const NOTHING: Sample = Sample {
    near: f32::NEG_INFINITY,
    id: 0,
};

/// The samples of a panel, row by row from the top.
#[derive(Debug)]
pub(crate) struct DepthBuffer {
    /// `width × height` samples.
    pub samples: Vec<Sample>,
    /// Samples in a row.
    pub width: usize,
    /// Samples along each side of a pixel.
    pub per_pixel: usize,
}

/// A triangle as three linear functions of the picture that are not negative inside, and the nearness as a fourth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plot {
    edges: [[f64; 3]; 3],
    near: [f64; 3],
}

impl Plot {
    /// `None` for a triangle that is seen edge-on.
    pub(crate) fn new(corners: [Pixel; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
        if area == 0.0 || !area.is_finite() {
            return None;
        }
        let edge = |p: Pixel, q: Pixel| {
            let (x, y) = ((p.y - q.y) / area, (q.x - p.x) / area);
            [x, y, -(x * p.x + y * p.y)]
        };
        let edges = [edge(b, c), edge(c, a), edge(a, b)];
        let near =
            [0, 1, 2].map(|k| edges[0][k] * a.near + edges[1][k] * b.near + edges[2][k] * c.near);
        Some(Self { edges, near })
    }

    /// Weights of the corners at a place in the picture.
    pub(crate) fn weights(&self, x: f64, y: f64) -> [f64; 3] {
        self.edges.map(|[a, b, c]| a * x + b * y + c)
    }

    /// The places of a row that are inside: the first and the one after the last.
    fn row(&self, y: f64, first: usize, end: usize) -> (usize, usize) {
        // The slack closes hairline gaps between neighbours whose rounding differs.
        const SLACK: f64 = 1e-7;
        let (mut low, mut high) = (first as f64, end as f64 - 1.0);
        for [a, b, c] in self.edges {
            let rest = b * y + c;
            if a > 0.0 {
                low = low.max(-rest / a - SLACK);
            } else if a < 0.0 {
                high = high.min(-rest / a + SLACK);
            } else if rest < 0.0 {
                return (first, first);
            }
        }
        if low > high || high < 0.0 {
            (first, first)
        } else {
            (above(low), high as usize + 1)
        }
    }
}

/// The least whole number not below a value; 0 for a negative one.
fn above(value: f64) -> usize {
    let whole = value as usize;
    if (whole as f64) < value {
        whole + 1
    } else {
        whole
    }
}

/// Plots a triangle into rows `rows` of a buffer; places are whole numbers. `put(column, row, nearness)`.
pub(crate) fn plot_triangle(
    corners: [Pixel; 3],
    width: usize,
    rows: core::ops::Range<usize>,
    mut put: impl FnMut(usize, usize, f64),
) {
    let (left, right) = span([corners[0].x, corners[1].x, corners[2].x], 0, width);
    let (top, bottom) = span(
        [corners[0].y, corners[1].y, corners[2].y],
        rows.start,
        rows.end,
    );
    if left >= right || top >= bottom {
        return;
    }
    if let Some(plot) = Plot::new(corners) {
        for y in top..bottom {
            let (low, high) = plot.row(y as f64, left, right);
            let base = plot.near[1] * y as f64 + plot.near[2];
            for x in low..high {
                put(x, y, plot.near[0] * x as f64 + base);
            }
        }
    }
}

/// The whole numbers of `first..end` between the least and the greatest value.
fn span(values: [f64; 3], first: usize, end: usize) -> (usize, usize) {
    let least = values[0].min(values[1]).min(values[2]);
    let most = values[0].max(values[1]).max(values[2]);
    // Casts saturate and NaN becomes 0, which leaves an empty or harmless range.
    (
        above(least - 1e-6).max(first),
        ((most + 1e-6).max(-1.0) + 1.0).min(end as f64) as usize,
    )
}

/// Rows given to one thread at a time.
const BAND: usize = 96;

impl DepthBuffer {
    /// The nearest triangle or dot at every sample of a panel seen through `view`; `radius` is that of the dots in
    /// pixels.
    pub(crate) fn new(mesh: &Mesh, view: &View, per_pixel: usize, radius: f64) -> Self {
        let [width, height] = view.size.map(|side| side * per_pixel);
        let mut buffer = Self {
            samples: vec![NOTHING; width * height],
            width,
            per_pixel,
        };
        let screen = Screen::new(mesh, view, per_pixel);
        let bands = screen.bands(height);
        parallel::chunks(&mut buffer.samples, width * BAND, |number, band| {
            let first = number * BAND;
            let rows = first..first + band.len() / width;
            let mut write = |x: usize, y: usize, near: f64, id: u32| {
                let sample = &mut band[(y - first) * width + x];
                if near as f32 > sample.near {
                    *sample = Sample {
                        near: near as f32,
                        id,
                    };
                }
            };
            let here = number as u16;
            for (index, &[top, bottom]) in bands.iter().enumerate() {
                if (top..=bottom).contains(&here) {
                    let corners = mesh.triangles[index].map(|corner| screen.at(corner));
                    plot_triangle(corners, width, rows.clone(), |x, y, near| {
                        write(x, y, near, 1 + index as u32);
                    });
                }
            }
            let base = 1 + mesh.triangles.len() as u32;
            for (index, &dot) in mesh.dots.iter().enumerate() {
                let centre = screen.at(dot);
                let ball = Ball::new(centre, view, radius, per_pixel);
                ball.plot(view, width, rows.clone(), |x, y, near| {
                    write(x, y, near, base + index as u32);
                });
            }
        });
        buffer
    }
}

/// The points of a mesh in units of samples, with whole numbers at the samples.
struct Screen<'a> {
    mesh: &'a Mesh,
    points: Vec<[f32; 3]>,
    view: &'a View,
    per_pixel: f64,
}

impl<'a> Screen<'a> {
    fn new(mesh: &'a Mesh, view: &'a View, per_pixel: usize) -> Self {
        let mut screen = Self {
            mesh,
            points: Vec::new(),
            view,
            per_pixel: per_pixel as f64,
        };
        let mut points = vec![[0.0_f32; 3]; mesh.points.len()];
        parallel::chunks(&mut points, 1 << 14, |number, chunk| {
            for (offset, point) in chunk.iter_mut().enumerate() {
                let pixel = screen.project((number << 14) + offset);
                *point = [pixel.x as f32, pixel.y as f32, pixel.near as f32];
            }
        });
        screen.points = points;
        screen
    }

    fn project(&self, index: usize) -> Pixel {
        let pixel = self.view.project(self.mesh.points[index]);
        Pixel {
            x: pixel.x * self.per_pixel - 0.5,
            y: pixel.y * self.per_pixel - 0.5,
            near: pixel.near,
        }
    }

    /// First and last band that each triangle touches.
    fn bands(&self, height: usize) -> Vec<[u16; 2]> {
        let mut bands = vec![[0; 2]; self.mesh.triangles.len()];
        parallel::chunks(&mut bands, 1 << 14, |number, chunk| {
            for (band, corners) in chunk.iter_mut().zip(&self.mesh.triangles[number << 14..]) {
                let [a, b, c] = corners.map(|corner| self.points[corner as usize][1]);
                let place = |y: f32| ((f64::from(y).max(0.0) as usize).min(height) / BAND) as u16;
                // A row more on either side, for rounding.
                *band = [place(a.min(b).min(c) - 1.0), place(a.max(b).max(c) + 1.0)];
            }
        });
        bands
    }

    fn at(&self, index: u32) -> Pixel {
        let [x, y, near] = self.points[index as usize].map(f64::from);
        Pixel { x, y, near }
    }
}

/// A dot: a small ball that faces the camera.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ball {
    x: f64,
    y: f64,
    /// Radius in samples.
    radius: f64,
    /// Distance of the centre.
    distance: f64,
    /// Radius in the frame.
    length: f64,
}

impl Ball {
    /// The ball about `centre` (in samples) with a radius in pixels.
    pub(crate) fn new(centre: Pixel, view: &View, radius: f64, per_pixel: usize) -> Self {
        let distance = view.distance_of(centre.near);
        Self {
            x: centre.x,
            y: centre.y,
            radius: radius * per_pixel as f64,
            distance,
            length: radius * view.pixel_length(distance),
        }
    }

    /// How far the surface stands out at a place, 0 at the rim and 1 in the middle; `None` outside.
    pub(crate) fn height(&self, x: f64, y: f64) -> Option<f64> {
        let (x, y) = ((x - self.x) / self.radius, (y - self.y) / self.radius);
        let square = 1.0 - x * x - y * y;
        (square >= 0.0).then(|| square.sqrt())
    }

    fn plot(
        &self,
        view: &View,
        width: usize,
        rows: core::ops::Range<usize>,
        mut put: impl FnMut(usize, usize, f64),
    ) {
        let (left, right) = span(
            [self.x - self.radius, self.x, self.x + self.radius],
            0,
            width,
        );
        let (top, bottom) = span(
            [self.y - self.radius, self.y, self.y + self.radius],
            rows.start,
            rows.end,
        );
        for y in top..bottom {
            for x in left..right {
                if let Some(height) = self.height(x as f64, y as f64) {
                    put(x, y, view.nearness(self.distance - height * self.length));
                }
            }
        }
    }
}

/// The place of a point of the frame in units of samples.
pub(crate) fn in_samples(view: &View, point: DVec3, per_pixel: usize) -> Pixel {
    let pixel = view.project(point);
    let per_pixel = per_pixel as f64;
    Pixel {
        x: pixel.x * per_pixel - 0.5,
        y: pixel.y * per_pixel - 0.5,
        near: pixel.near,
    }
}
