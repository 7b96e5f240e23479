//! Panels put together: one frame, one camera, side by side.

use anamorph_core::glam::DVec3;
use anamorph_core::{Role, Shape};

use crate::mesh::{Mesh, drawn_points};
use crate::overlay::{Element, Figure, Overlay, Style};
use crate::palette::{Linear, Palette, mix};
use crate::plane;
use crate::raster::DepthBuffer;
use crate::shade::Scene;
use crate::view::{Frame, View};
use crate::{Drawable, Options, Panel, Picture, PreviewError};

/// A model before and after, side by side, with an arrow between.
///
/// Both panels have the same camera and scale, such that everything drawn in either fits in both: what looks larger is
/// larger.
///
/// # Errors
/// [`PreviewError::Empty`] if either model has no finite point, [`PreviewError::Size`] and [`PreviewError::Camera`] for
/// options that cannot be followed.
pub fn before_after<S: Drawable>(
    before: &Panel<'_, S>,
    after: &Panel<'_, S>,
    options: &Options,
) -> Result<Picture, PreviewError> {
    options.check()?;
    let [width, height] = [options.width as usize, options.height as usize];
    let side = (width - 1) / 2;
    let studio = Studio::new(
        &[(before, "before"), (after, "after")],
        [side, height],
        options,
    )?;
    let palette = studio.palette;
    let mut canvas = vec![[0.0; 3]; width * height];
    for (panel, left) in [(before, 0), (after, width - side)] {
        let pixels = studio.paint(panel);
        for (row, line) in canvas.chunks_mut(width).zip(pixels.chunks(side)) {
            row[left..left + side].copy_from_slice(line);
        }
    }
    divide(&mut canvas, [width, height], side, &palette, studio.unit);
    Ok(Picture::from_linear(&canvas, options.width, options.height))
}

/// A single model.
///
/// # Errors
/// As [`before_after`].
pub fn single<S: Drawable>(
    panel: &Panel<'_, S>,
    options: &Options,
) -> Result<Picture, PreviewError> {
    options.check()?;
    let size = [options.width as usize, options.height as usize];
    let studio = Studio::new(&[(panel, "only")], size, options)?;
    Ok(Picture::from_linear(
        &studio.paint(panel),
        options.width,
        options.height,
    ))
}

/// What all panels of a picture share.
struct Studio {
    frame: Frame,
    view: View,
    palette: Palette,
    samples: usize,
    /// Pixels for a length of 1 in a panel of 900 pixels.
    unit: f64,
    /// Nearest and farthest distance of what is drawn.
    range: [f64; 2],
}

/// The corners of a box.
fn corners([low, high]: [DVec3; 2]) -> impl Iterator<Item = DVec3> {
    (0..8).map(move |bits| {
        let pick = |axis: usize| {
            if bits >> axis & 1 == 0 {
                low[axis]
            } else {
                high[axis]
            }
        };
        DVec3::new(pick(0), pick(1), pick(2))
    })
}

/// The finite points of the marks.
fn mark_points<'a, S: Drawable>(panel: &Panel<'a, S>) -> impl Iterator<Item = DVec3> + use<'a, S> {
    let marks = panel.marks;
    marks
        .iter()
        .flat_map(|mark| match &mark.shape {
            Shape::Point(point) => vec![*point],
            Shape::Polyline(points) => points.clone(),
            Shape::Arrow(from, to) => vec![*from, *to],
        })
        .filter(|point| point.is_finite())
        .map(Drawable::lift)
}

impl Studio {
    fn new<S: Drawable>(
        panels: &[(&Panel<'_, S>, &'static str)],
        size: [usize; 2],
        options: &Options,
    ) -> Result<Self, PreviewError> {
        for (panel, name) in panels {
            if !panel.model.points.iter().any(|point| point.is_finite()) {
                return Err(PreviewError::Empty {
                    panel: name,
                    points: panel.model.points.len(),
                });
            }
        }
        let everything = || {
            let around = options.around.into_iter().flat_map(corners);
            panels
                .iter()
                .flat_map(|(panel, _)| drawn_points(&panel.model).chain(mark_points(panel)))
                .chain(around)
        };
        let Some(frame) = Frame::around(everything()) else {
            return Err(PreviewError::Empty {
                panel: "only",
                points: 0,
            });
        };
        let placed = everything().map(|point| frame.place(point));
        let view = if S::FLAT {
            View::fit_plane(size, placed)
        } else if options.turning {
            View::fit_turning(&options.camera, size, placed)
        } else {
            View::fit(&options.camera, size, placed)
        };
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for point in everything() {
            let distance = view.distance_of(view.project(frame.place(point)).near);
            range = [range[0].min(distance), range[1].max(distance)];
        }
        let unit = (size[0].min(size[1]) as f64 / 850.0).clamp(0.35, 8.0);
        Ok(Self {
            frame,
            view,
            palette: Palette::of(options.theme),
            samples: options.samples as usize,
            unit,
            range,
        })
    }

    fn paint<S: Drawable>(&self, panel: &Panel<'_, S>) -> Vec<Linear> {
        let mesh = Mesh::new(&panel.model, &self.frame);
        let radius = self.dot_radius(mesh.dots.len(), if S::FLAT { 0.05 } else { 0.11 });
        let buffer = DepthBuffer::new(&mesh, &self.view, self.samples, radius);
        let mut pixels = if S::FLAT {
            plane::paint(&mesh, &self.view, &self.frame, &self.palette, &buffer)
        } else {
            Scene::new(
                &mesh,
                &self.view,
                &self.palette,
                &buffer,
                radius,
                self.range,
            )
            .paint()
        };
        let mut elements = Vec::new();
        if S::FLAT {
            elements.extend(plane::edges(&mesh, &self.palette, self.unit));
        }
        elements.extend(self.lines(&mesh));
        let style = Style {
            // Behind dots there is no behind: a line would only look dashed.
            hidden: if mesh.dots.is_empty() {
                self.palette.hidden
            } else {
                0.6
            },
            outline: self.palette.outline,
            unit: self.unit,
            range: self.range,
            haze: if S::FLAT { 0.0 } else { 0.25 },
            round: !S::FLAT,
        };
        let depth = if S::FLAT { None } else { Some(&buffer) };
        Overlay::new(&self.view, depth, style, &mut pixels).draw(&elements);
        Overlay::new(&self.view, depth, style, &mut pixels).draw(&self.marks(panel));
        pixels
    }

    /// Radius in pixels of each of `count` dots: about as much area in all, whatever their number.
    fn dot_radius(&self, count: usize, share: f64) -> f64 {
        let [width, height] = self.view.size;
        let share = share * (width * height) as f64 / count.max(1) as f64;
        share.sqrt().clamp(0.8, 6.0 * self.unit)
    }

    /// The model's own lines.
    fn lines(&self, mesh: &Mesh) -> Vec<Element> {
        mesh.lines
            .iter()
            .map(|line| Element {
                shape: Figure::Line(line.map(|index| mesh.points[index as usize]).to_vec()),
                colour: mesh.colour(line[0], self.palette.ink),
                radius: 0.8 * self.unit,
                opacity: 0.9,
            })
            .collect()
    }

    /// The marks of a panel. Where there are very many they are drawn finer, else they would hide the model.
    fn marks<S: Drawable>(&self, panel: &Panel<'_, S>) -> Vec<Element> {
        let points = panel
            .marks
            .iter()
            .filter(|mark| matches!(mark.shape, Shape::Point(_)))
            .count();
        let finer =
            |count: usize, plenty: f64| (plenty / count.max(1) as f64).sqrt().clamp(0.3, 1.0);
        let (point_size, line_size) = (
            finer(points, 250.0),
            finer(panel.marks.len() - points, 300.0),
        );
        let mut elements = Vec::new();
        for mark in panel.marks {
            let guide = matches!(mark.role, Role::SourceGuide | Role::TargetGuide);
            let mut add = |shape: Figure, radius: f64| {
                elements.push(Element {
                    shape,
                    colour: self.palette.feature(mark.role),
                    radius: radius * self.unit,
                    opacity: if guide { 0.85 } else { 1.0 },
                });
            };
            let place = |point: &S| self.frame.place(point.lift());
            match &mark.shape {
                Shape::Point(point) if point.is_finite() => {
                    add(
                        Figure::Point(place(point)),
                        if guide { 3.6 } else { 6.2 } * point_size,
                    );
                }
                Shape::Arrow(from, to) if from.is_finite() && to.is_finite() => {
                    add(
                        Figure::Arrow([place(from), place(to)]),
                        if guide { 0.95 } else { 1.5 } * line_size,
                    );
                }
                Shape::Polyline(points) => {
                    for part in points
                        .split(|point| !point.is_finite())
                        .filter(|part| !part.is_empty())
                    {
                        let line = part.iter().map(place).collect();
                        add(
                            Figure::Line(line),
                            if guide { 0.85 } else { 1.7 } * line_size,
                        );
                    }
                }
                Shape::Point(_) | Shape::Arrow(..) => {}
            }
        }
        elements
    }
}

/// The line between two panels, fading at its ends, and in its middle an arrow in a circle.
fn divide(canvas: &mut [Linear], size: [usize; 2], side: usize, palette: &Palette, unit: f64) {
    let [width, height] = size;
    for row in canvas.chunks_mut(width) {
        // The strip between the panels continues the left one.
        let edge = row[side - 1];
        row[side..width - side].fill(edge);
    }
    let (cx, cy) = (width as f64 * 0.5, height as f64 * 0.5);
    let radius = 17.0 * unit;
    let capsule = |x: f64, y: f64, a: [f64; 2], b: [f64; 2]| {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let t = (((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
        (x - a[0] - dx * t).hypot(y - a[1] - dy * t)
    };
    let reach = radius + 3.0;
    let columns = ((cx - reach).max(0.0) as usize)..((cx + reach) as usize + 1).min(width);
    for y in 0..height {
        let py = y as f64 + 0.5;
        let t = (py / height as f64 - 0.5).abs() * 2.0;
        let ends = ((1.0 - t) / 0.35).clamp(0.0, 1.0);
        for x in columns.clone() {
            let px = x as f64 + 0.5;
            let away = (px - cx).hypot(py - cy) - radius;
            let pixel = &mut canvas[y * width + x];
            let cover = |distance: f64| (0.5 - distance).clamp(0.0, 1.0) as f32;
            let line = cover((px - cx).abs() - 0.6 * unit.max(0.8)) * ends as f32;
            *pixel = mix(*pixel, palette.divider, line * (1.0 - cover(away)));
            *pixel = mix(*pixel, palette.pool, cover(away));
            *pixel = mix(
                *pixel,
                palette.divider,
                cover(away.abs() - 0.6 * unit.max(0.8)),
            );
            let (l, h) = (7.5 * unit, 4.6 * unit);
            let tip = [cx + l, cy];
            let arrow = capsule(px, py, [cx - l, cy], tip)
                .min(capsule(px, py, tip, [cx + l - h, cy - h]))
                .min(capsule(px, py, tip, [cx + l - h, cy + h]));
            *pixel = mix(*pixel, palette.ink, cover(arrow - 0.95 * unit));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Camera, Model, Projection};

    fn scattered(count: u32, scale: f64) -> Vec<DVec3> {
        (0..count)
            .map(|index| {
                let part = |k: f64| ((f64::from(index) * k).sin() * 43_758.545_3).fract() * scale;
                DVec3::new(part(12.9898), part(78.233) * 0.4, part(37.719))
            })
            .collect()
    }

    #[test]
    fn everything_drawn_is_inside_the_margins() {
        let cloud = scattered(500, 1.0);
        let shifted: Vec<DVec3> = cloud
            .iter()
            .map(|&point| point * 1.7 + DVec3::new(0.3, 2.0, -1.0))
            .collect();
        let far = [anamorph_core::Mark::new(
            Role::Target,
            Shape::Point(DVec3::new(4.0, 0.0, 3.0)),
        )];
        let (before, after) = (
            Panel::new(Model::cloud(&cloud)),
            Panel::new(Model::cloud(&shifted)).with_marks(&far),
        );
        for projection in [
            Projection::Orthographic,
            Projection::Perspective { field_of_view: 0.9 },
        ] {
            for (azimuth, elevation) in [
                (0.0, 0.0),
                (0.7, 0.4),
                (3.9, -1.2),
                (-2.0, core::f64::consts::FRAC_PI_2),
            ] {
                let camera = Camera {
                    projection,
                    ..Camera::default().at(azimuth, elevation)
                };
                let options = Options {
                    camera,
                    ..Options::default()
                };
                let panels = [(&before, "before"), (&after, "after")];
                let studio = Studio::new(&panels, [799, 900], &options).unwrap();
                let mut reach = [
                    f64::INFINITY,
                    f64::NEG_INFINITY,
                    f64::INFINITY,
                    f64::NEG_INFINITY,
                ];
                for point in cloud
                    .iter()
                    .chain(&shifted)
                    .chain([&DVec3::new(4.0, 0.0, 3.0)])
                {
                    let pixel = studio.view.project(studio.frame.place(*point));
                    reach = [
                        reach[0].min(pixel.x),
                        reach[1].max(pixel.x),
                        reach[2].min(pixel.y),
                        reach[3].max(pixel.y),
                    ];
                }
                let margin = 799.0 * 0.075 - 1e-6;
                assert!(
                    reach[0] >= margin && reach[1] <= 799.0 - margin,
                    "{reach:?}"
                );
                assert!(
                    reach[2] >= margin && reach[3] <= 900.0 - margin,
                    "{reach:?}"
                );
                // Tight: one of the two sides is filled.
                let slack = (799.0 - 2.0 * margin - (reach[1] - reach[0]))
                    .min(900.0 - 2.0 * margin - (reach[3] - reach[2]));
                assert!(slack < 1.0, "{slack}");
            }
        }
    }
}
