//! Shapes of files, repaired, on a common sheet.

use crate::error::Failure;
use crate::files;
use crate::shape_arguments::{Axis, ShapeOptions};
use anamorph_core::glam::DVec2;
use anamorph_io::images::{ImageFile, ImageFormat, ImageLimits};
use anamorph_io::outlines::{self, Drawing, Fill, FontOptions, Rule};
use anamorph_morph::matching::{Anchor, AnchorPlace};
use anamorph_morph::shapes::{FillRule, Part, Ring, Shape};
use anamorph_raster::colour::{linear_to_oklab, srgb_to_linear};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Black, for what has no colour of its own.
const BLACK: Fill = [0.0, 0.0, 0.0, 1.0];
/// Flattening tolerance as a share of the longer side of what is seen.
const TOLERANCE: f64 = 1.0 / 2000.0;

/// A shape of a file.
pub(super) struct Input {
    pub(super) name: String,
    pub(super) parts: Vec<Part>,
    /// The fills of the parts.
    pub(super) fills: Vec<Option<Fill>>,
    /// What is to be seen: left, top, width, height; y goes down.
    pub(super) view: [f64; 4],
    /// The sheet of its own file as it lies there.
    pub(super) canvas: [f64; 4],
    pub(super) notes: Vec<String>,
}

/// Whether a file holds a shape, by its first bytes.
pub(super) fn is_shape(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = std::fs::File::open(path).map(|file| file.take(1 << 16).read_to_end(&mut head));
    if !matches!(read, Ok(Ok(_))) {
        return false;
    }
    let text = String::from_utf8_lossy(&head);
    let text = text.trim_start_matches('\u{feff}').trim_start();
    outlines::is_font(&head)
        || is_pair_text(text)
        || (text.starts_with('<') && text.contains("<svg"))
        || (text.starts_with('{')
            && [
                "\"polygons\"",
                "\"Polygon\"",
                "\"MultiPolygon\"",
                "\"Feature\"",
                "\"FeatureCollection\"",
            ]
            .iter()
            .any(|word| text.contains(word)))
}

fn is_pair_text(text: &str) -> bool {
    text.starts_with('{') && text.contains("\"anamorph-pair\"")
}

/// Whether a file holds a pair of meshes, by its first bytes.
pub(super) fn is_pair(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = std::fs::File::open(path).map(|file| file.take(1 << 16).read_to_end(&mut head));
    let text = String::from_utf8_lossy(&head);
    matches!(read, Ok(Ok(_))) && is_pair_text(text.trim_start_matches('\u{feff}').trim_start())
}

/// Reads all inputs, and lays them on one sheet.
pub(super) fn read(paths: &[PathBuf], options: &ShapeOptions) -> Result<Vec<Input>, Failure> {
    files::at_most_one_stream(paths.iter())?;
    if let [path] = paths {
        // What cannot be read is said first.
        files::read(path)?;
    }
    if paths.len() < 2 {
        return Err(Failure::usage(
            "one shape becomes another; name two or more, or a pair of meshes, as `anamorph mesh` writes it",
        ));
    }
    let fonts: Vec<bool> = paths.iter().map(|path| is_font(path)).collect();
    let wanted = fonts.iter().filter(|font| **font).count();
    if options.text.len() != wanted && !(options.text.len() == 1 && wanted > 1) {
        return Err(Failure::usage(format!(
            "--text: there are {wanted} fonts among the inputs; give a text for each, as in --text A B"
        )));
    }
    check_axes(&options.axis, wanted)?;
    let mut texts = options.text.iter().cycle();
    let (mut inputs, mut number) = (Vec::new(), 0);
    for (path, is_font) in paths.iter().zip(fonts) {
        let text = if is_font { texts.next() } else { None };
        let font = text.map(|text| {
            let place = |axis: &Axis| {
                let own = axis.values.get(number).or(axis.values.first());
                own.map(|value| (axis.name.clone(), *value))
            };
            let axes = options.axis.iter().filter_map(place).collect();
            number += 1;
            let set = FontOptions {
                axes,
                ..FontOptions::default()
            };
            (text, set)
        });
        inputs.push(Input::read(path, font.as_ref(), options)?);
    }
    // Shapes of sheets of their own come to lie on the first's, as large as they can be.
    let first = inputs[0].view;
    // Letters keep their sizes.
    let all_fonts = wanted == inputs.len();
    if !all_fonts {
        for input in &mut inputs[1..] {
            input.fit(first);
        }
    }
    Ok(inputs)
}

/// Refuses axes without fonts, and numbers that are neither one nor one for each.
fn check_axes(axes: &[Axis], fonts: usize) -> Result<(), Failure> {
    for axis in axes {
        let count = axis.values.len();
        if fonts == 0 || (count != 1 && count != fonts) {
            return Err(Failure::usage(format!(
                "--axis {}: it has {count} numbers, and there are {fonts} fonts among the inputs; give one number, or one for each font",
                axis.name
            )));
        }
    }
    Ok(())
}

fn is_font(path: &Path) -> bool {
    let mut head = [0; 4];
    let read = std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut head));
    read.is_ok() && outlines::is_font(&head)
}

impl Input {
    fn read(
        path: &Path,
        font: Option<&(&String, FontOptions)>,
        options: &ShapeOptions,
    ) -> Result<Self, Failure> {
        let bytes = files::read(path)?;
        let shown = files::shown(path);
        let failed = |error: &dyn std::fmt::Display| Failure::new(format!("{shown}: {error}"));
        let drawing = match font {
            Some((text, set)) => outlines::read_text(&bytes, text, set),
            None if options.silhouette && ImageFormat::of_content(&bytes).is_some() => {
                return Self::silhouette(&bytes, &shown, options);
            }
            None => outlines::read(&bytes),
        };
        let drawing = drawing.map_err(|error| failed(&error))?.turned(true);
        let name = match font {
            Some((text, set)) if set.axes.is_empty() => format!("{shown} `{text}`"),
            Some((text, set)) => {
                let places = set.axes.iter();
                let places: Vec<String> = places
                    .map(|(name, value)| format!("{name}={value}"))
                    .collect();
                format!("{shown} `{text}` {}", places.join(" "))
            }
            None => shown.clone(),
        };
        Self::of_drawing(name, &drawing, options).map_err(|error| match error {
            Failure::Message(text) => Failure::Message(format!("{shown}: {text}")),
            other => other,
        })
    }

    fn of_drawing(
        name: String,
        drawing: &Drawing,
        options: &ShapeOptions,
    ) -> Result<Self, Failure> {
        let view = drawing.view();
        let tolerance = options
            .tolerance
            .unwrap_or(TOLERANCE * view[2].max(view[3]));
        let (mut parts, mut fills) = (Vec::new(), Vec::new());
        let mut notes = drawing.notes.clone();
        let coloured = drawing.parts.iter().any(|part| part.fill.is_some());
        for (number, part) in drawing.parts.iter().enumerate() {
            if coloured && part.fill.is_none() {
                notes.push(format!("part {} has no fill and is left out", number + 1));
                continue;
            }
            let shape = Shape {
                rings: part
                    .contours
                    .iter()
                    .map(|contour| Ring {
                        points: contour.flatten(tolerance),
                        hole: false,
                    })
                    .collect(),
                fill: match part.rule {
                    Rule::NonZero => FillRule::NonZero,
                    Rule::EvenOdd => FillRule::EvenOdd,
                },
            };
            let label = match &part.id {
                Some(id) => format!("part {} (`{id}`)", number + 1),
                None => format!("part {}", number + 1),
            };
            let (regions, mended) = match shape.regions() {
                Ok(found) => found,
                Err(error) if drawing.parts.len() > 1 => {
                    notes.push(format!("{label} is left out: {error}"));
                    continue;
                }
                Err(error) => return Err(Failure::new(format!("{label}: {error}"))),
            };
            const SHOWN: usize = 3;
            for mended in mended.iter().take(SHOWN) {
                notes.push(format!("{label}: {mended}"));
            }
            if mended.len() > SHOWN {
                notes.push(format!("{label}: {} more mended", mended.len() - SHOWN));
            }
            let fill = part.fill.or((!coloured).then_some(BLACK));
            let oklab = fill.map(|[r, g, b, _]| linear_to_oklab([r, g, b].map(srgb_to_linear)));
            for (i, region) in regions.into_iter().enumerate() {
                let id = part.id.as_ref().map(|id| match i {
                    0 => id.clone(),
                    _ => format!("{id}#{}", i + 1),
                });
                parts.push(Part {
                    id,
                    colour: oklab,
                    region,
                });
                fills.push(fill);
            }
        }
        if parts.is_empty() {
            return Err(Failure::new(
                "nothing in it is filled; give a drawing with a filled outline",
            ));
        }
        Ok(Self {
            name,
            parts,
            fills,
            view,
            canvas: view,
            notes,
        })
    }

    /// The outline of what is opaque in an image, or dark where it has no alpha.
    fn silhouette(bytes: &[u8], shown: &str, options: &ShapeOptions) -> Result<Self, Failure> {
        let failed = |error: &dyn std::fmt::Display| Failure::new(format!("{shown}: {error}"));
        let image =
            ImageFile::read(bytes, ImageLimits::of_file(bytes.len())).map_err(|e| failed(&e))?;
        let raster = image.colours().map_err(|e| failed(&e))?;
        let drawing = super::sheets::outline(&raster).map_err(|e| failed(&e))?;
        Self::of_drawing(shown.to_owned(), &drawing, options).map_err(|error| match error {
            Failure::Message(text) => Failure::Message(format!("{shown}: {text}")),
            other => other,
        })
    }

    /// Lays it on a sheet, in its middle, as large as it can be.
    fn fit(&mut self, sheet: [f64; 4]) {
        if self.view == sheet {
            return;
        }
        let scale = (sheet[2] / self.view[2]).min(sheet[3] / self.view[3]);
        if !(scale.is_finite() && scale > 0.0) {
            return;
        }
        let middle = |[x, y, w, h]: [f64; 4]| DVec2::new(x + 0.5 * w, y + 0.5 * h);
        let (from, to) = (middle(self.view), middle(sheet));
        for part in &mut self.parts {
            let region = &mut part.region;
            for ring in core::iter::once(&mut region.outer).chain(&mut region.holes) {
                for point in ring {
                    *point = to + (*point - from) * scale;
                }
            }
        }
        let corner = to + (DVec2::new(self.view[0], self.view[1]) - from) * scale;
        self.canvas = [
            corner.x,
            corner.y,
            self.view[2] * scale,
            self.view[3] * scale,
        ];
        // Sheets of the same form lie on each other exactly.
        let far = self.canvas.iter().zip(&sheet).map(|(a, b)| (a - b).abs());
        if far.fold(0.0, f64::max) <= 1e-9 * sheet[2].max(sheet[3]) {
            self.canvas = sheet;
        }
        self.view = sheet;
    }

    /// Its name without folders.
    pub(super) fn short_name(&self) -> String {
        let (path, text) = self
            .name
            .split_at(self.name.find(" `").unwrap_or(self.name.len()));
        let file = Path::new(path).file_name();
        let file = file.map_or(path.into(), |file| file.to_string_lossy());
        format!("{file}{text}")
    }

    /// What stands for one side of a pair of meshes.
    pub(super) fn of_pair(name: String, view: [f64; 4], notes: Vec<String>) -> Self {
        Self {
            name,
            parts: Vec::new(),
            fills: Vec::new(),
            view,
            canvas: view,
            notes,
        }
    }
}

/// The anchors of each step, from the files of `--anchors`.
pub(super) fn anchors(options: &ShapeOptions, inputs: usize) -> Result<Vec<Vec<Anchor>>, Failure> {
    let steps = inputs - 1;
    if options.anchors.is_empty() {
        return Ok(vec![Vec::new(); steps]);
    }
    if options.anchors.len() != steps {
        return Err(Failure::usage(format!(
            "--anchors: {inputs} shapes are {steps} steps; give a file for each"
        )));
    }
    options
        .anchors
        .iter()
        .map(|path| anchors_of(path))
        .collect()
}

fn anchors_of(path: &Path) -> Result<Vec<Anchor>, Failure> {
    let shown = files::shown(path);
    let failed = |what: String| Failure::new(format!("{shown}: {what}"));
    let bytes = files::read(path)?;
    let text = std::str::from_utf8(&bytes).map_err(|error| failed(error.to_string()))?;
    let table: toml::Table = text
        .parse()
        .map_err(|error: toml::de::Error| failed(error.to_string()))?;
    let mut anchors = Vec::new();
    if let Some(key) = table.keys().find(|key| *key != "anchor") {
        return Err(failed(format!(
            "`{key}` is unknown; write tables [[anchor]] with `source` and `target`"
        )));
    }
    let list = table.get("anchor").and_then(toml::Value::as_array);
    for (number, anchor) in list.into_iter().flatten().enumerate() {
        let place = |name: &str| -> Result<AnchorPlace, Failure> {
            match anchor.get(name) {
                Some(toml::Value::Integer(point)) if *point >= 0 => {
                    Ok(AnchorPlace::Point(*point as usize))
                }
                Some(toml::Value::Float(share)) if (0.0..=1.0).contains(share) => {
                    Ok(AnchorPlace::Fraction(*share))
                }
                _ => Err(failed(format!(
                    "anchor {}: `{name}` is the number of a point of the outline (a whole number from 0), or a share of its length (from 0.0 to 1.0)",
                    number + 1
                ))),
            }
        };
        anchors.push(Anchor {
            source: place("source")?,
            target: place("target")?,
        });
    }
    Ok(anchors)
}
