//! Outlines of a glyph or of a short text in a font: OpenType and TrueType, with variable axes.
//!
//! The text is one line. It is shaped as a text engine does: kerning, ligatures, marks, right-to-left scripts; each glyph with an outline
//! is a part, named after its characters. Outlines overlap where the font's do, and the rule is that of fonts, nonzero. y grows upwards
//! from the baseline, and the em is [`FontOptions::size`] units. A character without a glyph is an error that names it.
//!
//! *Source*: ISO/IEC 14496-22, *Open Font Format*, 2019; outlines by `skrifa`, shaping by `harfrust` (`HarfBuzz`).

use super::drawing::{Contour, Drawing, Part, Rule, Segment};
use crate::error::{ReadError, ReadErrorKind};
use anamorph_core::glam::{DVec2, dvec2};
use harfrust::{Buffer, ShapeOptions, ShaperFont};
use skrifa::instance::Size;
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider, Tag};

/// Characters of a text at most.
pub const MOST_CHARACTERS: usize = 10_000;
/// Points of all glyphs at most.
const MOST_POINTS: usize = 1 << 23;

/// How a text is set.
#[derive(Debug, Clone, PartialEq)]
pub struct FontOptions {
    /// Which font of a collection, from 0.
    pub index: u32,
    /// The em in units of the drawing.
    pub size: f64,
    /// Places on the axes of a variable font: `("wght", 700.0)`. Axes that are not named stay at their defaults.
    pub axes: Vec<(String, f64)>,
}

impl Default for FontOptions {
    /// The first font, an em of 1000 units, all axes at their defaults.
    fn default() -> Self {
        Self {
            index: 0,
            size: 1000.0,
            axes: Vec::new(),
        }
    }
}

/// Whether a file's bytes are those of a font or of a collection of fonts.
#[must_use]
pub fn is_font(bytes: &[u8]) -> bool {
    let heads = [&b"\x00\x01\x00\x00"[..], b"OTTO", b"true", b"ttcf"];
    heads.iter().any(|head| bytes.starts_with(head))
}

fn damaged(what: impl Into<String>) -> ReadError {
    let mend = "take another copy of the font";
    ReadError::new(ReadErrorKind::Container, what, mend)
}

/// Reads the outlines of a text.
///
/// # Errors
/// A damaged or cut-off font, a character without a glyph ([`ReadErrorKind::Glyph`]), an axis that the font does not have, a text that
/// shows nothing ([`ReadErrorKind::NoPath`]), has more than one line, or is too long.
pub fn read_text(bytes: &[u8], text: &str, options: &FontOptions) -> Result<Drawing, ReadError> {
    check_text(text)?;
    if !(options.size > 0.0 && options.size.is_finite()) {
        return Err(ReadError::new(
            ReadErrorKind::Number,
            format!(
                "the size {} of the font is no positive number",
                options.size
            ),
            "give the height of the em, such as 1000",
        ));
    }
    if bytes.starts_with(b"wOFF") || bytes.starts_with(b"wOF2") {
        return Err(ReadError::new(
            ReadErrorKind::Unsupported,
            "this font is packed for the web (WOFF)",
            "take its .ttf or .otf form",
        ));
    }
    let font = FontRef::from_index(bytes, options.index)
        .map_err(|error| damaged(format!("this is no font that can be read: {error}")))?;
    check_tables(&font, bytes)?;
    let (settings, notes) = settings(&font, &options.axes)?;
    let location = font.axes().location(settings.iter().copied());
    let metrics = font.metrics(Size::unscaled(), &location);
    if metrics.units_per_em == 0 {
        return Err(damaged("this font has an em of 0 units"));
    }
    let scale = options.size / f64::from(metrics.units_per_em);

    let whole = harfrust::Font::new(bytes.to_vec(), options.index)
        .ok_or_else(|| damaged("this is no font that can be set"))?;
    let instance = whole
        .instance_builder()
        .normalized_coords(location.coords().iter().copied())
        .build();
    let mut shaped = Buffer::new();
    shaped.push_str(text);
    shaped.guess_segment_properties();
    harfrust::shape(
        &ShaperFont::new(&instance),
        &mut shaped,
        ShapeOptions::new(),
    )
    .map_err(|error| damaged(format!("the text cannot be set: {error:?}")))?;
    if !shaped.allocation_successful() {
        return Err(damaged(
            "the font makes more glyphs of the text than can be",
        ));
    }

    let mut starts: Vec<usize> = shaped
        .glyph_infos()
        .iter()
        .map(|info| info.cluster as usize)
        .collect();
    starts.sort_unstable();
    starts.dedup();
    let characters = |start: usize| {
        let next = starts.partition_point(|other| *other <= start);
        let end = starts.get(next).copied().unwrap_or(text.len());
        text.get(start..end).unwrap_or_default()
    };
    let glyphs = font.outline_glyphs();
    let mut parts: Vec<Part> = Vec::new();
    let (mut pen_at, mut points) = (DVec2::ZERO, 0);
    for (info, position) in shaped.glyph_infos().iter().zip(shaped.glyph_positions()) {
        let own = characters(info.cluster as usize);
        let units = |x: i32, y: i32| dvec2(f64::from(x), f64::from(y)) * scale;
        if info.glyph_id == 0 {
            let known = font.charmap();
            let missing = own.chars().find(|c| known.map(*c).is_none());
            let missing = missing.or(own.chars().next()).unwrap_or('\u{fffd}');
            return Err(ReadError::new(
                ReadErrorKind::Glyph(missing),
                format!(
                    "the font has no glyph for {missing:?} (U+{:04X})",
                    u32::from(missing)
                ),
                "take a font that has it, or another character",
            ));
        }
        let at = pen_at + units(position.x_offset, position.y_offset);
        pen_at += units(position.x_advance, position.y_advance);
        let glyph = glyphs
            .get(GlyphId::new(info.glyph_id))
            .ok_or_else(|| damaged(format!("the outline of {own:?} is not in the font")))?;
        let mut pen = Pen {
            at,
            scale,
            contours: Vec::new(),
        };
        glyph
            .draw(
                DrawSettings::unhinted(Size::unscaled(), &location),
                &mut pen,
            )
            .map_err(|error| damaged(format!("the outline of {own:?} is damaged: {error}")))?;
        let mut contours = pen.contours;
        contours.retain(|contour| !contour.segments.is_empty());
        if contours.is_empty() {
            continue;
        }
        points += contours.iter().map(|c| c.points().count()).sum::<usize>();
        if points > MOST_POINTS {
            return Err(ReadError::new(
                ReadErrorKind::TooLarge,
                format!("the outlines have more than {MOST_POINTS} points"),
                "take a shorter text",
            ));
        }
        parts.push(Part {
            name: own.to_owned(),
            fill: Some([0.0, 0.0, 0.0, 1.0]),
            rule: Rule::NonZero,
            contours,
            ..Part::default()
        });
    }
    if parts.is_empty() {
        return Err(ReadError::new(
            ReadErrorKind::NoPath,
            format!("the text {text:?} shows nothing"),
            "take a text with letters",
        ));
    }
    let (low, high) = (
        f64::from(metrics.descent) * scale,
        f64::from(metrics.ascent) * scale,
    );
    let left = pen_at.x.min(0.0);
    let wide = pen_at.x.abs();
    Ok(Drawing {
        name: Some(text.to_owned()),
        units: None,
        parts,
        canvas: (wide > 0.0 && high > low).then_some([left, low, wide, high - low]),
        y_down: false,
        notes,
    })
}

fn check_text(text: &str) -> Result<(), ReadError> {
    let count = text.chars().count();
    if count > MOST_CHARACTERS {
        return Err(ReadError::new(
            ReadErrorKind::TooLarge,
            format!("the text has {count} characters, and at most {MOST_CHARACTERS} are set"),
            "take a shorter text",
        ));
    }
    match text.chars().find(|c| c.is_control()) {
        Some(control) => Err(ReadError::new(
            ReadErrorKind::Glyph(control),
            format!("the text has the control character {control:?}; texts are one line"),
            "leave it out, or set each line on its own",
        )),
        None => Ok(()),
    }
}

/// Refuses fonts whose tables lie beyond their end.
fn check_tables(font: &FontRef<'_>, bytes: &[u8]) -> Result<(), ReadError> {
    for record in font.table_directory.table_records() {
        let end = u64::from(record.offset()) + u64::from(record.length());
        if end > bytes.len() as u64 {
            return Err(ReadError::new(
                ReadErrorKind::Truncated,
                format!(
                    "the font's table {} ends at byte {end}, and the file has {}",
                    record.tag(),
                    bytes.len()
                ),
                "take a whole copy of the font",
            ));
        }
    }
    Ok(())
}

/// Places on axes by tag, and what has to be said about them.
type Settings = (Vec<(Tag, f32)>, Vec<String>);

fn settings(font: &FontRef<'_>, wanted: &[(String, f64)]) -> Result<Settings, ReadError> {
    let (mut settings, mut notes) = (Vec::new(), Vec::new());
    for (name, value) in wanted {
        let axis = font
            .axes()
            .iter()
            .find(|axis| axis.tag().to_string() == *name);
        let Some(axis) = axis else {
            let known: Vec<String> = font
                .axes()
                .iter()
                .map(|axis| {
                    let (low, high) = (axis.min_value(), axis.max_value());
                    format!("{} from {low} to {high}", axis.tag())
                })
                .collect();
            let mend = if known.is_empty() {
                "it is not variable; leave the axis out".to_owned()
            } else {
                format!("it has {}", known.join(", "))
            };
            return Err(ReadError::new(
                ReadErrorKind::Unsupported,
                format!("the font has no axis {name:?}"),
                mend,
            ));
        };
        if !value.is_finite() {
            return Err(ReadError::new(
                ReadErrorKind::NonFinite,
                format!("the place {value} on the axis {name} is not finite"),
                format!("take one from {} to {}", axis.min_value(), axis.max_value()),
            ));
        }
        let (low, high) = (f64::from(axis.min_value()), f64::from(axis.max_value()));
        let taken = if low <= high {
            value.clamp(low, high)
        } else {
            *value
        };
        if taken != *value {
            notes.push(format!(
                "the axis {name} goes from {low} to {high}; {taken} is taken for {value}"
            ));
        }
        settings.push((axis.tag(), taken as f32));
    }
    Ok((settings, notes))
}

/// Takes down the outline of a glyph.
struct Pen {
    at: DVec2,
    scale: f64,
    contours: Vec<Contour>,
}

impl Pen {
    fn place(&self, x: f32, y: f32) -> DVec2 {
        self.at + dvec2(f64::from(x), f64::from(y)) * self.scale
    }

    fn add(&mut self, segment: Segment) {
        if let Some(contour) = self.contours.last_mut() {
            contour.segments.push(segment);
        }
    }
}

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let start = self.place(x, y);
        self.contours.push(Contour {
            start,
            segments: Vec::new(),
            closed: true,
        });
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.add(Segment::Line(self.place(x, y)));
    }
    fn quad_to(&mut self, ax: f32, ay: f32, x: f32, y: f32) {
        self.add(Segment::Quadratic([self.place(ax, ay), self.place(x, y)]));
    }
    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        let points = [self.place(ax, ay), self.place(bx, by), self.place(x, y)];
        self.add(Segment::Cubic(points));
    }
    fn close(&mut self) {}
}
