//! Drawings of lines, discs and words, as SVG and as pixels: plots and diagrams beside the pictures of models.
//!
//! Places are in pixels from the upper left corner. Words need no font files: in pixels they are drawn with strokes, in SVG
//! they are text. *Source*: W3C, *Scalable Vector Graphics (SVG) 2*, 2018.

use crate::strokes;
use crate::{Picture, PreviewError};
use std::fmt::Write;
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform,
};

/// A colour: red, green and blue, sRGB-encoded, and how far it covers what is behind, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ink {
    /// Red, green, blue.
    pub rgb: [u8; 3],
    /// 0 is nothing, 1 hides what is behind.
    pub opacity: f64,
}

impl Ink {
    /// A colour that hides what is behind.
    #[must_use]
    pub const fn new(red: u8, green: u8, blue: u8) -> Self {
        Self {
            rgb: [red, green, blue],
            opacity: 1.0,
        }
    }

    /// The colour at another opacity.
    #[must_use]
    pub const fn fading(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }

    fn hex(self) -> String {
        let [r, g, b] = self.rgb;
        format!("#{r:02x}{g:02x}{b:02x}")
    }
}

/// Which part of a word stands at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Its beginning.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

#[derive(Debug, Clone)]
enum Item {
    Line {
        points: Vec<[f64; 2]>,
        ink: Ink,
        width: f64,
    },
    Area {
        rings: Vec<Vec<[f64; 2]>>,
        ink: Ink,
    },
    Disc {
        at: [f64; 2],
        radius: f64,
        ink: Ink,
    },
    Words {
        at: [f64; 2],
        height: f64,
        anchor: Anchor,
        ink: Ink,
        text: String,
    },
}

/// A drawing; what is drawn later covers what was drawn before. Items with a number that is not finite are left out.
#[derive(Debug, Clone)]
pub struct Figure {
    size: [f64; 2],
    ground: Ink,
    items: Vec<Item>,
}

fn finite(points: &[[f64; 2]]) -> bool {
    points.iter().flatten().all(|number| number.is_finite())
}

/// Text that stands for itself in SVG.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

impl Figure {
    /// An empty drawing.
    #[must_use]
    pub fn new(width: f64, height: f64, ground: Ink) -> Self {
        Self {
            size: [width, height],
            ground,
            items: Vec::new(),
        }
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> [f64; 2] {
        self.size
    }

    /// A line through points, with round ends and corners.
    pub fn line(&mut self, points: &[[f64; 2]], ink: Ink, width: f64) {
        if points.len() > 1 && finite(points) {
            self.items.push(Item::Line {
                points: points.to_vec(),
                ink,
                width,
            });
        }
    }

    /// An area with straight edges.
    pub fn area(&mut self, points: &[[f64; 2]], ink: Ink) {
        if points.len() > 2 {
            self.region(&[points.to_vec()], ink);
        }
    }

    /// What outlines with straight edges go around; holes go the other way round. What lies over itself is filled.
    pub fn region(&mut self, rings: &[Vec<[f64; 2]>], ink: Ink) {
        if !rings.is_empty() && rings.iter().all(|ring| finite(ring)) {
            self.items.push(Item::Area {
                rings: rings.to_vec(),
                ink,
            });
        }
    }

    /// A disc.
    pub fn disc(&mut self, at: [f64; 2], radius: f64, ink: Ink) {
        if finite(&[at]) {
            self.items.push(Item::Disc { at, radius, ink });
        }
    }

    /// Words on a line; `at` is on their baseline, `height` that of digits.
    pub fn words(&mut self, at: [f64; 2], height: f64, anchor: Anchor, ink: Ink, text: &str) {
        if finite(&[at]) {
            self.items.push(Item::Words {
                at,
                height,
                anchor,
                ink,
                text: text.to_owned(),
            });
        }
    }

    /// The drawing as an SVG file; `label` says what it shows to those who cannot see it.
    #[must_use]
    pub fn svg(&self, label: &str) -> String {
        let [width, height] = self.size;
        let label = escaped(label);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             role=\"img\" aria-label=\"{label}\">\n<title>{label}</title>\n<rect width=\"{width}\" height=\"{height}\" \
             fill=\"{}\"/>\n",
            self.ground.hex()
        );
        for item in &self.items {
            item.svg(&mut svg);
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// The drawing as pixels.
    ///
    /// # Errors
    /// [`PreviewError::Drawing`] for sizes below 1 or above 16384 pixels.
    pub fn picture(&self) -> Result<Picture, PreviewError> {
        let [width, height] = self.size.map(|side| side.round().clamp(0.0, 1e6) as u32);
        let most = 16_384;
        let too_large = || PreviewError::Drawing {
            width,
            height,
            most,
        };
        if width > most || height > most {
            return Err(too_large());
        }
        let mut pixels = Pixmap::new(width, height).ok_or_else(too_large)?;
        let [r, g, b] = self.ground.rgb;
        pixels.fill(Color::from_rgba8(r, g, b, 255));
        Ok(self.painted(pixels))
    }

    /// The drawing without its ground over a picture, whose size stays.
    ///
    /// # Errors
    /// [`PreviewError::Drawing`] where there is no memory for the pixels.
    pub fn over(&self, picture: &Picture) -> Result<Picture, PreviewError> {
        let (rgba, width, height) = picture.rgba();
        let most = 16_384;
        let failed = || PreviewError::Drawing {
            width,
            height,
            most,
        };
        let mut pixels = Pixmap::new(width, height).ok_or_else(failed)?;
        pixels.data_mut().copy_from_slice(rgba);
        Ok(self.painted(pixels))
    }

    fn painted(&self, mut pixels: Pixmap) -> Picture {
        for item in &self.items {
            item.paint(&mut pixels);
        }
        Picture::from_opaque(pixels.data(), pixels.width(), pixels.height())
    }
}

fn list(points: &[[f64; 2]]) -> String {
    let mut text = String::with_capacity(12 * points.len());
    for (i, [x, y]) in points.iter().enumerate() {
        let gap = if i > 0 { " " } else { "" };
        let _ = write!(text, "{gap}{x:.2},{y:.2}");
    }
    text
}

fn opacity(name: &str, ink: Ink) -> String {
    if ink.opacity < 1.0 {
        format!(" {name}-opacity=\"{:.3}\"", ink.opacity)
    } else {
        String::new()
    }
}

impl Item {
    fn svg(&self, out: &mut String) {
        let _ = match self {
            Self::Line { points, ink, width } => writeln!(
                out,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width:.2}\" stroke-linecap=\"round\" \
                 stroke-linejoin=\"round\"{}/>",
                list(points),
                ink.hex(),
                opacity("stroke", *ink)
            ),
            Self::Area { rings, ink } => match rings.as_slice() {
                [points] => writeln!(
                    out,
                    "<polygon points=\"{}\" fill=\"{}\"{}/>",
                    list(points),
                    ink.hex(),
                    opacity("fill", *ink)
                ),
                rings => {
                    let path = |ring: &Vec<[f64; 2]>| format!("M{}Z", list(ring));
                    let paths: String = rings.iter().map(path).collect();
                    writeln!(
                        out,
                        "<path d=\"{paths}\" fill-rule=\"nonzero\" fill=\"{}\"{}/>",
                        ink.hex(),
                        opacity("fill", *ink)
                    )
                }
            },
            Self::Disc {
                at: [x, y],
                radius,
                ink,
            } => writeln!(
                out,
                "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" fill=\"{}\"{}/>",
                ink.hex(),
                opacity("fill", *ink)
            ),
            Self::Words {
                at: [x, y],
                height,
                anchor,
                ink,
                text,
            } => {
                let anchor = match anchor {
                    Anchor::Start => "start",
                    Anchor::Middle => "middle",
                    Anchor::End => "end",
                };
                // Digits of sans-serif fonts are about 0.72 of the font's size.
                let size = height / 0.72;
                writeln!(
                    out,
                    "<text x=\"{x:.2}\" y=\"{y:.2}\" font-family=\"system-ui, sans-serif\" font-size=\"{size:.2}\" \
                     text-anchor=\"{anchor}\" fill=\"{}\">{}</text>",
                    ink.hex(),
                    escaped(text)
                )
            }
        };
    }

    fn paint(&self, pixels: &mut Pixmap) {
        let paint = |ink: Ink| {
            let mut paint = Paint::default();
            let [r, g, b] = ink.rgb;
            let alpha = (ink.opacity.clamp(0.0, 1.0) * 255.0).round() as u8;
            paint.set_color_rgba8(r, g, b, alpha);
            paint.anti_alias = true;
            paint
        };
        let along = |lines: &[Vec<[f64; 2]>], close: bool| {
            let mut path = PathBuilder::new();
            for points in lines {
                for (i, [x, y]) in points.iter().enumerate() {
                    if i == 0 {
                        path.move_to(*x as f32, *y as f32);
                    } else {
                        path.line_to(*x as f32, *y as f32);
                    }
                }
                if close {
                    path.close();
                }
            }
            path.finish()
        };
        let stroke = |width: f64| Stroke {
            width: width as f32,
            line_cap: LineCap::Round,
            line_join: LineJoin::Round,
            ..Stroke::default()
        };
        let here = Transform::identity();
        match self {
            Self::Line { points, ink, width } => {
                if let Some(path) = along(core::slice::from_ref(points), false) {
                    pixels.stroke_path(&path, &paint(*ink), &stroke(*width), here, None);
                }
            }
            Self::Area { rings, ink } => {
                if let Some(path) = along(rings, true) {
                    pixels.fill_path(&path, &paint(*ink), FillRule::Winding, here, None);
                }
            }
            Self::Disc {
                at: [x, y],
                radius,
                ink,
            } => {
                if let Some(path) = PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32) {
                    pixels.fill_path(&path, &paint(*ink), FillRule::Winding, here, None);
                }
            }
            Self::Words {
                at,
                height,
                anchor,
                ink,
                text,
            } => {
                let unit = height / strokes::HEIGHT;
                let width = strokes::width(text) * unit;
                let start = match anchor {
                    Anchor::Start => at[0],
                    Anchor::Middle => at[0] - 0.5 * width,
                    Anchor::End => at[0] - width,
                };
                for line in strokes::lines(text) {
                    let points: Vec<[f64; 2]> = line
                        .iter()
                        .map(|[x, y]| [start + x * unit, at[1] - y * unit])
                        .collect();
                    if let Some(path) = along(&[points], false) {
                        let width = stroke(0.13 * height);
                        pixels.stroke_path(&path, &paint(*ink), &width, here, None);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLACK: Ink = Ink::new(0, 0, 0);

    fn drawing() -> Figure {
        let mut figure = Figure::new(80.0, 40.0, Ink::new(255, 255, 255));
        figure.line(&[[5.0, 5.0], [75.0, 5.0]], BLACK, 3.0);
        figure.area(
            &[[5.0, 30.0], [25.0, 30.0], [25.0, 38.0]],
            BLACK.fading(0.5),
        );
        figure.disc([60.0, 30.0], 5.0, Ink::new(200, 0, 0));
        figure.words([40.0, 22.0], 8.0, Anchor::Middle, BLACK, "a<1 & 2");
        figure
    }

    #[test]
    fn items_are_where_they_should_be_in_pixels() {
        let picture = drawing().picture().unwrap();
        let dark = |x, y| picture.pixel(x, y).unwrap()[1] < 128;
        assert!(dark(40, 5) && !dark(40, 9) && !dark(2, 5));
        assert_eq!(picture.pixel(60, 30), Some([200, 0, 0, 255]));
        let grey = picture.pixel(22, 32).unwrap();
        assert!((120..=136).contains(&grey[0]), "{grey:?}");
        let words = (0..80).flat_map(|x| (13..24).map(move |y| (x, y)));
        let inked: Vec<u32> = words.filter(|&(x, y)| dark(x, y)).map(|(x, _)| x).collect();
        assert!(inked.len() > 20);
        let (least, most) = (inked.iter().min().unwrap(), inked.iter().max().unwrap());
        assert!((38..=42).contains(&((least + most) / 2)), "{least} {most}");
    }

    #[test]
    fn svg_escapes_and_leaves_out_what_is_not_finite() {
        let mut figure = drawing();
        figure.line(&[[0.0, f64::NAN], [1.0, 1.0]], BLACK, 1.0);
        figure.disc([f64::INFINITY, 0.0], 1.0, BLACK);
        let svg = figure.svg("x < y");
        assert!(svg.contains("aria-label=\"x &lt; y\"") && svg.contains("a&lt;1 &amp; 2"));
        assert_eq!(svg.matches("<polyline").count(), 1);
        assert_eq!(svg.matches("<circle").count(), 1);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn impossible_sizes_are_refused() {
        for size in [[0.0, 10.0], [1e9, 10.0], [f64::NAN, 1.0]] {
            let figure = Figure::new(size[0], size[1], BLACK);
            assert!(figure.picture().is_err(), "{size:?}");
        }
    }
}
