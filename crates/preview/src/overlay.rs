//! Lines, points and arrows over a finished panel, tested against its depth: what lies behind the model shows faintly,
//! and a nearer mark parts a farther one by a thin gap.
//!
//! *Source* of the gaps: A. Appel, F. J. Rohlf, A. J. Stein, *The haloed line effect for hidden line elimination*,
//! SIGGRAPH 1979.

use anamorph_core::glam::DVec3;

use crate::palette::{Linear, mix, scale};
use crate::raster::DepthBuffer;
use crate::view::{Pixel, View};

/// One thing to draw.
#[derive(Debug, Clone)]
pub(crate) struct Element {
    pub shape: Figure,
    pub colour: Linear,
    /// Half the width of a line, or the radius of a point, in pixels.
    pub radius: f64,
    /// Opacity, 0 to 1.
    pub opacity: f32,
}

/// The geometry of an element, in the frame.
#[derive(Debug, Clone)]
pub(crate) enum Figure {
    Line(Vec<DVec3>),
    Arrow([DVec3; 2]),
    Point(DVec3),
}

impl Figure {
    fn points(&self) -> &[DVec3] {
        match self {
            Self::Line(points) => points,
            Self::Arrow(points) => points,
            Self::Point(point) => core::slice::from_ref(point),
        }
    }
}

/// How elements are drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Style {
    /// Opacity behind the model.
    pub hidden: f32,
    /// Colour of points' outlines, as a factor on their own.
    pub outline: f32,
    /// Pixels for a length of 1 in a panel of 900 pixels.
    pub unit: f64,
    /// Nearest and farthest distance of what is drawn.
    pub range: [f64; 2],
    /// How much the farthest marks are lost in the air, 0 to 1.
    pub haze: f32,
    /// Whether points are shaded like balls.
    pub round: bool,
}

/// How far a mark may lie behind the surface and still count as on it, in the frame.
const SURFACE: f64 = 0.006;
/// Depth in the frame that is needed for the full effect of the air: a shallow scene is not hazy at its back.
pub(crate) const DEEP: f64 = 0.9;
/// How much farther a mark must be to be parted by a nearer one, in the frame.
const PARTED: f64 = 0.03;

/// The panel being drawn over.
pub(crate) struct Overlay<'a> {
    view: &'a View,
    depth: Option<&'a DepthBuffer>,
    style: Style,
    canvas: &'a mut [Linear],
    /// The panel without marks.
    base: Vec<Linear>,
    /// Nearness of the marks drawn.
    near: Vec<f32>,
    /// For the element being drawn: signed distance to its outline in pixels, and its nearness.
    outline: Vec<f32>,
    front: Vec<f32>,
    touched: Vec<u32>,
}

impl<'a> Overlay<'a> {
    pub(crate) fn new(
        view: &'a View,
        depth: Option<&'a DepthBuffer>,
        style: Style,
        canvas: &'a mut [Linear],
    ) -> Self {
        let count = canvas.len();
        let base = canvas.to_vec();
        Self {
            view,
            depth,
            style,
            canvas,
            base,
            near: vec![f32::NEG_INFINITY; count],
            outline: vec![f32::INFINITY; count],
            front: vec![f32::NEG_INFINITY; count],
            touched: Vec::new(),
        }
    }

    /// Draws the elements from far to near, points after lines of the same depth.
    pub(crate) fn draw(&mut self, elements: &[Element]) {
        let mut order: Vec<(f64, usize)> = elements
            .iter()
            .enumerate()
            .filter(|(_, element)| !element.shape.points().is_empty())
            .map(|(index, element)| {
                let points = element.shape.points();
                let middle = points
                    .iter()
                    .fold(DVec3::ZERO, |sum, &point| sum + point / points.len() as f64);
                let lift = if matches!(element.shape, Figure::Point(_)) {
                    PARTED
                } else {
                    0.0
                };
                (
                    self.view.distance_of(self.view.project(middle).near) - lift,
                    index,
                )
            })
            .collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for (_, index) in order {
            let element = &elements[index];
            match &element.shape {
                Figure::Line(points) => self.line(element, points),
                Figure::Arrow(ends) => self.arrow(element, *ends),
                Figure::Point(centre) => self.point(element, *centre),
            }
        }
    }

    fn line(&mut self, element: &Element, points: &[DVec3]) {
        let pixels: Vec<Pixel> = points
            .iter()
            .map(|&point| self.view.project(point))
            .collect();
        if let [only] = pixels[..] {
            self.capsule(only, only, element.radius);
        }
        for pair in pixels.windows(2) {
            self.capsule(pair[0], pair[1], element.radius);
        }
        self.blend(element, |_, _| element.colour);
    }

    fn arrow(&mut self, element: &Element, [from, to]: [DVec3; 2]) {
        let (a, b) = (self.view.project(from), self.view.project(to));
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        let length = dx.hypot(dy);
        let head = (element.radius * 9.0).min(length * 0.65);
        if length < 1e-3 {
            self.capsule(a, b, element.radius);
        } else {
            let at = |part: f64| Pixel {
                x: a.x + dx * part,
                y: a.y + dy * part,
                near: a.near + (b.near - a.near) * part,
            };
            let neck = 1.0 - head / length;
            self.capsule(a, at(neck + 0.3 * head / length), element.radius);
            let half = head * 0.40;
            let (nx, ny) = (-dy / length * half, dx / length * half);
            let base = at(neck);
            let wing = |side: f64| Pixel {
                x: base.x + nx * side,
                y: base.y + ny * side,
                near: base.near,
            };
            self.triangle([b, wing(1.0), wing(-1.0)]);
        }
        self.blend(element, |_, _| element.colour);
    }

    fn point(&mut self, element: &Element, centre: DVec3) {
        let pixel = self.view.project(centre);
        let distance = self.view.distance_of(pixel.near);
        let length = element.radius * self.view.pixel_length(distance);
        let radius = element.radius;
        let view = self.view;
        self.each(pixel, pixel, radius, |x, y| {
            let away = (x - pixel.x).hypot(y - pixel.y);
            let part = (1.0 - (away / radius).powi(2)).max(0.0).sqrt();
            (away - radius, view.nearness(distance - part * length))
        });
        let style = self.style;
        let ring = (1.1 * style.unit).min(radius * 0.3);
        self.blend(element, |x, y| {
            let (dx, dy) = ((x - pixel.x) / radius, (y - pixel.y) / radius);
            let away = dx.hypot(dy);
            let part = (1.0 - away * away).max(0.0).sqrt();
            let light = (dx * -0.48 + dy * -0.58 + part * 0.66).max(0.0);
            let body = if style.round {
                let shine = 0.55 * light.powi(24) as f32;
                mix(
                    scale(element.colour, 0.78 + 0.38 * light as f32),
                    [1.0; 3],
                    shine,
                )
            } else {
                element.colour
            };
            let inner = ((away - 1.0) * radius + ring + 0.5).clamp(0.0, 1.0) as f32;
            mix(body, scale(element.colour, style.outline), inner)
        });
    }

    /// A line with round ends.
    fn capsule(&mut self, a: Pixel, b: Pixel, radius: f64) {
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        let square = dx * dx + dy * dy;
        self.each(a, b, radius, |x, y| {
            let along = if square > 0.0 {
                (((x - a.x) * dx + (y - a.y) * dy) / square).clamp(0.0, 1.0)
            } else {
                0.0
            };
            let away = (x - a.x - dx * along).hypot(y - a.y - dy * along);
            (away - radius, a.near + (b.near - a.near) * along)
        });
    }

    fn triangle(&mut self, corners: [Pixel; 3]) {
        let [tip, left, right] = corners;
        let middle = Pixel {
            x: (left.x + right.x) * 0.5,
            y: (left.y + right.y) * 0.5,
            near: left.near,
        };
        let reach = (left.x - right.x).hypot(left.y - right.y) * 0.5;
        let area = (left.x - tip.x) * (right.y - tip.y) - (right.x - tip.x) * (left.y - tip.y);
        let sign = if area < 0.0 { -1.0 } else { 1.0 };
        let side = |p: Pixel, q: Pixel, x: f64, y: f64| {
            let (ex, ey) = (q.x - p.x, q.y - p.y);
            let length = ex.hypot(ey).max(1e-9);
            -sign * (ex * (y - p.y) - ey * (x - p.x)) / length
        };
        self.each(tip, middle, reach, |x, y| {
            let away = side(tip, left, x, y)
                .max(side(left, right, x, y))
                .max(side(right, tip, x, y));
            // Slightly rounded corners.
            (away - 0.4, tip.near)
        });
    }

    /// Visits the pixels within `radius` of the line from `a` to `b`, a little more for soft edges and gaps, and keeps
    /// the least of the distances that `distance` gives, with its nearness.
    fn each(&mut self, a: Pixel, b: Pixel, radius: f64, distance: impl Fn(f64, f64) -> (f64, f64)) {
        let [width, height] = self.view.size;
        let reach = radius + self.gap() + 1.0;
        let (top, bottom) = (a.y.min(b.y) - reach, a.y.max(b.y) + reach);
        let rows =
            (top.floor().max(0.0) as usize)..((bottom.ceil() + 1.0).max(0.0) as usize).min(height);
        for row in rows {
            let y = row as f64 + 0.5;
            // The part of the line that comes near this row.
            let part = |level: f64| {
                if (b.y - a.y).abs() < 1e-9 {
                    None
                } else {
                    Some(((level - a.y) / (b.y - a.y)).clamp(0.0, 1.0))
                }
            };
            let (s, t) = (
                part(y - reach).unwrap_or(0.0),
                part(y + reach).unwrap_or(1.0),
            );
            let (one, other) = (a.x + (b.x - a.x) * s, a.x + (b.x - a.x) * t);
            let left = (one.min(other) - reach).floor().max(0.0) as usize;
            let right = ((one.max(other) + reach).ceil().max(0.0) as usize).min(width);
            for column in left..right {
                let (away, near) = distance(column as f64 + 0.5, y);
                let index = row * width + column;
                if away < self.gap() + 0.5 && (away as f32) < self.outline[index] {
                    if self.outline[index] == f32::INFINITY {
                        self.touched.push(index as u32);
                    }
                    self.outline[index] = away as f32;
                    self.front[index] = near as f32;
                }
            }
        }
    }

    /// Width of the gap in a farther mark.
    fn gap(&self) -> f64 {
        1.6 * self.style.unit
    }

    /// Puts the element just outlined on the canvas. `colour` is asked at places in pixels.
    fn blend(&mut self, element: &Element, colour: impl Fn(f64, f64) -> Linear) {
        let touched = core::mem::take(&mut self.touched);
        let (width, gap) = (self.view.size[0], self.gap() as f32);
        for &index in &touched {
            let index = index as usize;
            let (away, near) = (self.outline[index], f64::from(self.front[index]));
            self.outline[index] = f32::INFINITY;
            let distance = self.view.distance_of(near);
            let (x, y) = (index % width, index / width);
            let seen = self.seen(x, y, distance - SURFACE);
            let parted = f64::from(self.near[index]) > f64::NEG_INFINITY
                && self.view.distance_of(f64::from(self.near[index])) > distance + PARTED;
            if parted {
                let cover = (0.5 - (away - gap)).clamp(0.0, 1.0) * seen * element.opacity;
                self.canvas[index] = mix(self.canvas[index], self.base[index], cover);
            }
            let cover = (0.5 - away).clamp(0.0, 1.0);
            if cover > 0.0 {
                let depth = (distance - self.style.range[0])
                    / (self.style.range[1] - self.style.range[0]).max(DEEP);
                let haze = self.style.haze * depth.clamp(0.0, 1.0) as f32;
                let opacity = cover
                    * element.opacity
                    * (seen + (1.0 - seen) * self.style.hidden)
                    * (1.0 - haze);
                let colour = colour(x as f64 + 0.5, y as f64 + 0.5);
                self.canvas[index] = mix(self.canvas[index], colour, opacity);
                if cover > 0.5 && seen > 0.5 {
                    self.near[index] = near as f32;
                }
            }
        }
        self.touched = touched;
        self.touched.clear();
    }

    /// The part of a pixel's samples in which nothing lies before a distance.
    fn seen(&self, x: usize, y: usize, distance: f64) -> f32 {
        let Some(depth) = self.depth else { return 1.0 };
        let near = self.view.nearness(distance) as f32;
        let side = depth.per_pixel;
        let open = (0..side * side)
            .filter(|index| {
                let place = (y * side + index / side) * depth.width + x * side + index % side;
                depth.samples[place].near <= near
            })
            .count();
        open as f32 / (side * side) as f32
    }
}
