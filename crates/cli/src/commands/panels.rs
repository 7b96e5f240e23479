//! Images side by side, with features and grids drawn over them: previews of warped images and of snakes.

use crate::arguments::ThemeName;
use crate::error::Failure;
use anamorph_core::glam::{DMat2, DVec2, dvec2};
use anamorph_core::{Affine, Deformation, Mark, Plane, Role, Shape, Site};
use anamorph_preview::{Figure, Ink, Picture};
use anamorph_raster::colour::Srgb8;
use anamorph_raster::{Edge, Filter, Raster, Window, resample_through};

/// Least width and height of a picture.
const LEAST: u32 = 64;
/// Greatest width and height of a picture.
const MOST: u32 = 8192;
/// Lines of a grid over the longer side of an image.
const LINES: usize = 12;
/// Points of a line of a grid.
const POINTS: usize = 193;

/// Orange and blue as in the pictures of models, the pale ones for guides.
fn ink(role: Role) -> Ink {
    match role {
        Role::Source => Ink::new(0xf2, 0x70, 0x0c),
        Role::Target => Ink::new(0x1b, 0x62, 0xdc),
        Role::SourceGuide => Ink::new(0xef, 0x9a, 0x58),
        Role::TargetGuide => Ink::new(0x78, 0xa2, 0xe8),
    }
}

/// A picture with a row of panels, all showing the same rectangle of pixels.
pub(super) struct Panels {
    size: (u32, u32),
    shown: Window,
    /// Pixels of the picture for a pixel of the image.
    scale: f64,
    /// Top left corners of the panels, in whole pixels of the picture.
    corners: Vec<(u32, u32)>,
    /// Width and height of each.
    own: (u32, u32),
    pixels: Vec<u8>,
    figure: Figure,
    /// Widths of lines are multiples of this many pixels.
    unit: f64,
}

impl Panels {
    /// `count` panels beside each other that show `window`.
    pub(super) fn new(
        size: (u32, u32),
        theme: ThemeName,
        window: Window,
        count: u32,
    ) -> Result<Self, Failure> {
        let (width, height) = size;
        if !(LEAST..=MOST).contains(&width) || !(LEAST..=MOST).contains(&height) {
            return Err(Failure::usage(format!(
                "--size: a picture of {width} × {height} pixels cannot be made; width and height go from {LEAST} to {MOST}"
            )));
        }
        let margin = (width.min(height) / 40).max(2);
        let room = ((width - margin * (count + 1)) / count, height - 2 * margin);
        let (across, down) = (window.width() as f64, window.height() as f64);
        let scale = (f64::from(room.0) / across).min(f64::from(room.1) / down);
        let side = |length: f64| (length * scale).round().max(1.0) as u32;
        let own = (side(across).min(room.0), side(down).min(room.1));
        let corners = (0..count).map(|number| {
            let cell = margin + number * (room.0 + margin);
            (cell + (room.0 - own.0) / 2, (height - own.1) / 2)
        });
        let ground = match theme {
            ThemeName::Light => [0xe4, 0xe4, 0xe3],
            ThemeName::Dark => [0x22, 0x25, 0x2a],
        };
        let [r, g, b] = ground;
        Ok(Self {
            size,
            shown: window,
            scale,
            corners: corners.collect(),
            own,
            pixels: ground.repeat(width as usize * height as usize),
            figure: Figure::new(f64::from(width), f64::from(height), Ink::new(r, g, b)),
            unit: f64::from(width.min(height)) / 900.0,
        })
    }

    /// Draws an image (red, green, blue, coverage, as [`light`](anamorph_io::images::ImageFile::light) gives it) into a panel.
    pub(super) fn image(&mut self, panel: usize, light: &Raster) -> Result<(), Failure> {
        let Some(&(left, top)) = self.corners.get(panel) else {
            return Ok(());
        };
        let (width, height) = (self.own.0 as usize, self.own.1 as usize);
        let window = Window::new(0, 0, width, height).map_err(Failure::new)?;
        let back = Affine {
            linear: DMat2::from_diagonal(DVec2::splat(1.0 / self.scale)),
            translation: self.shown.corner(),
        };
        let drawn = resample_through(light, &back, Filter::ANISOTROPIC, Edge::Transparent, window)
            .map_err(Failure::new)?;
        let codes = Srgb8::new();
        let (pixels, _) = drawn.samples().as_chunks::<4>();
        for (row, line) in pixels.chunks_exact(width).enumerate() {
            let start = ((top as usize + row) * self.size.0 as usize + left as usize) * 3;
            let places = self.pixels[start..].chunks_exact_mut(3);
            for (place, pixel) in places.zip(line) {
                // What is not a number is seen as black, and covers.
                let cover = if pixel[3].is_nan() {
                    1.0
                } else {
                    pixel[3].clamp(0.0, 1.0)
                };
                for (code, light) in place.iter_mut().zip(pixel) {
                    let light = if light.is_nan() {
                        0.0
                    } else {
                        light.clamp(0.0, 1.0)
                    };
                    *code = codes.encode(light + (1.0 - cover) * codes.decode(*code));
                }
            }
        }
        Ok(())
    }

    /// A place of the image in the picture.
    fn place(&self, panel: usize, point: Plane) -> [f64; 2] {
        let (left, top) = self.corners.get(panel).copied().unwrap_or_default();
        let at = (point - self.shown.corner()) * self.scale;
        [f64::from(left) + at.x, f64::from(top) + at.y]
    }

    /// Draws a line twice, so that it shows on any ground.
    fn line(&mut self, panel: usize, points: &[Plane], ink: Ink, halo: Ink, width: f64) {
        // Parts that go nowhere are left out, and what lies beyond the panel.
        for part in points.split(|point| !point.is_finite()) {
            for seen in self.seen(part) {
                let places: Vec<_> = seen.iter().map(|&p| self.place(panel, p)).collect();
                self.figure.line(&places, halo, (width + 1.6) * self.unit);
                self.figure.line(&places, ink, width * self.unit);
            }
        }
    }

    /// The runs of a line that a panel shows (Y.-D. Liang and B. A. Barsky, *A New Concept and Method for Line Clipping*, ACM TOG 3(1), 1984).
    fn seen(&self, line: &[Plane]) -> Vec<Vec<Plane>> {
        let low = self.shown.corner();
        let high = low + dvec2(self.shown.width() as f64, self.shown.height() as f64);
        let mut runs: Vec<Vec<Plane>> = Vec::new();
        for pair in line.windows(2) {
            let (from, along) = (pair[0], pair[1] - pair[0]);
            let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
            for axis in 0..2 {
                for (side, room) in [
                    (-along[axis], from[axis] - low[axis]),
                    (along[axis], high[axis] - from[axis]),
                ] {
                    if side < 0.0 {
                        enter = enter.max(room / side);
                    } else if side > 0.0 {
                        leave = leave.min(room / side);
                    } else if room < 0.0 {
                        leave = -1.0;
                    }
                }
            }
            if enter > leave {
                continue;
            }
            let (first, last) = (from + along * enter, from + along * leave);
            match runs.last_mut() {
                Some(run) if run.last() == Some(&first) => run.push(last),
                _ => runs.push(vec![first, last]),
            }
        }
        runs
    }

    /// Draws a square grid over `window`, moved by `moved`.
    pub(super) fn grid(&mut self, panel: usize, window: Window, moved: &dyn Deformation<Plane>) {
        let size = dvec2(window.width() as f64, window.height() as f64);
        let spacing = size.max_element() / LINES as f64;
        for axis in 0..2 {
            let count = (size[axis] / spacing + 1e-9).floor() as usize;
            // The same rest on both sides.
            let first = (size[axis] - spacing * count as f64) / 2.0;
            for number in 0..=count {
                let mut points: Vec<Plane> = (0..POINTS)
                    .map(|step| {
                        let mut at = size * (step as f64 / (POINTS - 1) as f64);
                        at[axis] = first + spacing * number as f64;
                        window.corner() + at
                    })
                    .collect();
                for point in &mut points {
                    *point = moved.map(&Site::anywhere(*point));
                }
                let (ink, halo) = (Ink::new(255, 255, 255), Ink::new(0, 0, 0));
                self.line(panel, &points, ink.fading(0.55), halo.fading(0.2), 0.9);
            }
        }
    }

    /// Draws features.
    pub(super) fn marks(&mut self, panel: usize, marks: &[Mark<Plane>]) {
        let halo = Ink::new(255, 255, 255).fading(0.8);
        for mark in marks {
            let ink = ink(mark.role);
            let guide = matches!(mark.role, Role::SourceGuide | Role::TargetGuide);
            let width = if guide { 1.4 } else { 2.6 };
            match &mark.shape {
                Shape::Point(point) => self.dot(panel, *point, ink, width * 1.8),
                Shape::Polyline(points) => self.line(panel, points, ink, halo, width),
                Shape::Arrow(from, to) => {
                    self.line(panel, &[*from, *to], ink, halo, width);
                    // As long as a dozen lines are wide, and no longer than a third of the arrow.
                    let along = (*from - *to) / 3.0;
                    let head = along.clamp_length_max(12.0 * self.unit / self.scale);
                    let [left, right] =
                        [0.45, -0.45].map(|turn| *to + DVec2::from_angle(turn).rotate(head));
                    self.line(panel, &[left, *to, right], ink, halo, width);
                }
            }
        }
    }

    /// Draws a point.
    pub(super) fn dot(&mut self, panel: usize, point: Plane, ink: Ink, radius: f64) {
        if self.seen(&[point, point]).is_empty() {
            return;
        }
        let at = self.place(panel, point);
        let halo = Ink::new(255, 255, 255).fading(0.8);
        self.figure.disc(at, (radius + 0.8) * self.unit, halo);
        self.figure.disc(at, radius * self.unit, ink);
    }

    /// The finished picture.
    fn picture(&self) -> Result<Picture, Failure> {
        let (width, height) = self.size;
        let picture = Picture::from_rgb(&self.pixels, width, height).map_err(Failure::new)?;
        self.figure.over(&picture).map_err(Failure::new)
    }

    /// The finished picture as a PNG file.
    pub(super) fn png(&self) -> Result<Vec<u8>, Failure> {
        self.picture()?.png().map_err(Failure::new)
    }
}

#[cfg(test)]
mod tests {
    // A test that cannot be set up has nothing to say.
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// Two panels that show 30 × 20 pixels from (10, 20) on, 16 times as large.
    fn panels() -> Panels {
        let shown = Window::new(10, 20, 30, 20).unwrap();
        let Ok(panels) = Panels::new((1040, 400), ThemeName::Light, shown, 2) else {
            panic!("two panels of 500 × 380 pixels in a picture of 1040 × 400");
        };
        panels
    }

    #[test]
    fn lines_are_cut_to_what_a_panel_shows() {
        let panels = panels();
        let seen = |line: &[(f64, f64)]| -> Vec<Vec<(f64, f64)>> {
            let line: Vec<Plane> = line.iter().map(|&(x, y)| dvec2(x, y)).collect();
            let runs = panels.seen(&line);
            let run = |run: &Vec<Plane>| run.iter().map(|p| (p.x, p.y)).collect();
            runs.iter().map(run).collect()
        };
        // Within, through, and past.
        assert_eq!(
            seen(&[(12.0, 22.0), (20.0, 30.0)]),
            [[(12.0, 22.0), (20.0, 30.0)]]
        );
        assert_eq!(
            seen(&[(0.0, 30.0), (100.0, 30.0)]),
            [[(10.0, 30.0), (40.0, 30.0)]]
        );
        assert_eq!(
            seen(&[(5.0, 15.0), (45.0, 55.0)]),
            [[(10.0, 20.0), (30.0, 40.0)]]
        );
        assert!(seen(&[(0.0, 0.0), (100.0, 10.0)]).is_empty());
        assert!(seen(&[(41.0, 0.0), (41.0, 100.0)]).is_empty());
        // Out and in again are two runs; a corner within is one.
        let out_and_in = [(15.0, 25.0), (15.0, 45.0), (25.0, 45.0), (25.0, 25.0)];
        assert_eq!(
            seen(&out_and_in),
            [[(15.0, 25.0), (15.0, 40.0)], [(25.0, 40.0), (25.0, 25.0)]]
        );
        let corner = [(0.0, 25.0), (15.0, 25.0), (15.0, 0.0)];
        assert_eq!(seen(&corner), [[(10.0, 25.0), (15.0, 25.0), (15.0, 20.0)]]);
        // A point is a run, where it is shown.
        assert_eq!(seen(&[(10.0, 40.0); 2]).len(), 1);
        assert!(seen(&[(9.0, 40.0); 2]).is_empty());
    }

    #[test]
    fn nothing_is_drawn_beyond_the_panels() {
        let empty = panels().picture().unwrap_or_else(|_| panic!("a picture"));
        let mut panels = panels();
        let far = |x: f64, y: f64| dvec2(25.0 + x * 1e4, 30.0 + y * 1e4);
        let wild: Vec<Plane> = (0..40)
            .map(|i| {
                let angle = f64::from(i) * 2.3;
                far(angle.cos(), angle.sin())
            })
            .chain([
                dvec2(f64::NAN, 3.0),
                dvec2(-1e300, 1e300),
                dvec2(1e300, 0.0),
            ])
            .collect();
        for panel in 0..2 {
            let marks = [
                Mark::new(Role::Source, Shape::Polyline(wild.clone())),
                Mark::new(Role::Target, Shape::Arrow(far(-1.0, 0.0), far(1.0, 0.1))),
                Mark::new(Role::Target, Shape::Point(dvec2(-40.0, 30.0))),
                Mark::new(Role::Target, Shape::Point(dvec2(41.0, 30.0))),
            ];
            panels.marks(panel, &marks);
            let away = Affine {
                linear: DMat2::from_diagonal(DVec2::splat(3.0)),
                translation: dvec2(-50.0, -60.0),
            };
            panels.grid(panel, panels.shown, &away);
        }
        let drawn = panels.picture().unwrap_or_else(|_| panic!("a picture"));
        // Half of a line's width may stand out.
        let out = 3;
        let mut inked = 0;
        for y in 0..400 {
            for x in 0..1040 {
                let (across, down) = panels.own;
                let is_in = panels.corners.iter().any(|&(left, top)| {
                    let near = |at: u32, start: u32, size: u32| {
                        at + out >= start && at < start + size + out
                    };
                    near(x, left, across) && near(y, top, down)
                });
                let same = drawn.pixel(x, y) == empty.pixel(x, y);
                assert!(is_in || same, "({x}, {y})");
                inked += usize::from(!same);
            }
        }
        assert!(inked > 5000, "{inked}");
    }
}
