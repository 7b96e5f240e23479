//! Drawings as SVG, single or one after the other in time.
//!
//! An animated SVG moves by itself wherever SVG is shown, without a script: each path has its first frame as `d` and an `animate` element
//! with the `d` of all frames, and others for its colour and opacity where these change. Between two frames a viewer goes straight where
//! all frames of a part are made of the same segments; else it jumps from frame to frame. Every frame takes the same time, the last one
//! too. Numbers are rounded by [`Rounding`]; y always grows downwards in the file.
//!
//! *Source*: W3C, *Scalable Vector Graphics (SVG) 2*, 2018, chapters 9 and 13; W3C, *SVG Animations Level 2*, 2021 (values, `calcMode`).

use super::drawing::{Contour, Drawing, Part, Rule, Segment, Stroke, view_of};
use super::rounding::Rounding;
use crate::WriteError;
use std::borrow::Cow;
use std::io::Write;

/// How often an animation is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Repeat {
    /// Without end.
    #[default]
    Forever,
    /// So many times; the last frame stays. 0 is once.
    Times(u32),
}

/// Drawings one after the other. The parts of all frames are the same ones in the same order.
#[derive(Debug, Clone)]
pub struct Animation<'a> {
    /// The frames.
    pub frames: &'a [Drawing],
    /// Frames in a second.
    pub rate: f64,
    /// How often they are shown.
    pub repeat: Repeat,
    /// How numbers are rounded; nothing for what keeps 10⁻⁴ of a pixel.
    pub rounding: Option<Rounding>,
}

/// An animation that can be written: y grows downwards.
pub(super) struct Stage<'a> {
    pub(super) frames: Vec<Cow<'a, Drawing>>,
    pub(super) view: [f64; 4],
    pub(super) rounding: Rounding,
    pub(super) rate: f64,
    pub(super) repeat: Repeat,
}

pub(super) fn refused(what: impl Into<String>, mend: &str) -> WriteError {
    WriteError::Refused {
        what: what.into(),
        mend: mend.to_owned(),
    }
}

impl<'a> Animation<'a> {
    /// Frames at a rate, without end.
    #[must_use]
    pub fn new(frames: &'a [Drawing], rate: f64) -> Self {
        Self {
            frames,
            rate,
            repeat: Repeat::Forever,
            rounding: None,
        }
    }

    pub(super) fn stage(&self) -> Result<Stage<'a>, WriteError> {
        let Some(first) = self.frames.first() else {
            return Err(refused("there is no frame", "give at least one"));
        };
        if !(self.rate > 0.0 && self.rate.is_finite()) {
            let what = format!("{} frames a second are no animation", self.rate);
            return Err(refused(what, "give a positive number, such as 30"));
        }
        for (i, frame) in self.frames.iter().enumerate() {
            if frame.parts.len() != first.parts.len() {
                return Err(refused(
                    format!(
                        "frame {} has {} parts, and the first has {}",
                        i + 1,
                        frame.parts.len(),
                        first.parts.len()
                    ),
                    "give all frames the same parts; one that is not seen has no contours",
                ));
            }
            if let Some(bad) = frame.points().position(|point| !point.is_finite()) {
                return Err(refused(
                    format!("point {} of frame {} is not finite", bad + 1, i + 1),
                    "correct it",
                ));
            }
        }
        let turn = |frame: &'a Drawing| {
            if frame.y_down {
                Cow::Borrowed(frame)
            } else {
                Cow::Owned(frame.turned(true))
            }
        };
        let frames: Vec<Cow<'a, Drawing>> = self.frames.iter().map(turn).collect();
        let view = joint_view(&frames);
        let rounding = self
            .rounding
            .unwrap_or(Rounding::for_side(view[2].max(view[3])));
        Ok(Stage {
            frames,
            view,
            rounding,
            rate: self.rate,
            repeat: self.repeat,
        })
    }

    /// Writes one animated SVG.
    ///
    /// # Errors
    /// No frames, frames of different parts, a rate that is not positive, points that are not finite; nothing is written then. Else what the
    /// receiver says.
    pub fn write_svg(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        let stage = self.stage()?;
        let mut text = Vec::new();
        svg(&stage, &mut text);
        out.write_all(&text)?;
        Ok(())
    }
}

/// Writes a drawing as a plain SVG; `view` overrides what is to be seen, in the drawing's own coordinates.
///
/// # Errors
/// Points that are not finite; what the receiver says.
pub fn write_svg(
    drawing: &Drawing,
    rounding: Option<Rounding>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    Animation {
        frames: core::slice::from_ref(drawing),
        rate: 1.0,
        repeat: Repeat::Forever,
        rounding,
    }
    .write_svg(out)
}

/// What is to be seen of all frames.
fn joint_view(frames: &[Cow<'_, Drawing>]) -> [f64; 4] {
    let join = |a: [f64; 4], b: [f64; 4]| {
        let (x, y) = (a[0].min(b[0]), a[1].min(b[1]));
        let right = (a[0] + a[2]).max(b[0] + b[2]);
        let low = (a[1] + a[3]).max(b[1] + b[3]);
        [x, y, right - x, low - y]
    };
    let canvases = frames.iter().filter_map(|frame| frame.canvas);
    if let Some(view) = canvases.reduce(join) {
        return view;
    }
    let bounds = frames.iter().filter_map(|frame| frame.bounds());
    let all = bounds.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    view_of(all.unwrap_or_default())
}

/// Path data of a part.
pub(super) fn path_data(part: &Part, rounding: Rounding, out: &mut Vec<u8>) {
    if part.contours.is_empty() {
        // A path without data is an error of its own; a single point shows nothing.
        out.extend_from_slice(b"M0 0");
    }
    for contour in &part.contours {
        contour_data(contour, rounding, out);
    }
}

fn contour_data(contour: &Contour, rounding: Rounding, out: &mut Vec<u8>) {
    out.push(b'M');
    rounding.pair(contour.start, b' ', out);
    let mut before = b'M';
    for segment in &contour.segments {
        let letter = match segment {
            Segment::Line(_) => b'L',
            Segment::Quadratic(_) => b'Q',
            Segment::Cubic(_) => b'C',
        };
        // A letter that is repeated may be left out.
        out.push(if letter == before { b' ' } else { letter });
        before = letter;
        for (i, point) in segment.points().iter().enumerate() {
            if i > 0 {
                out.push(b' ');
            }
            rounding.pair(*point, b' ', out);
        }
    }
    if contour.closed {
        out.push(b'Z');
    }
}

/// `#rrggbb`.
pub(super) fn hex(colour: [f64; 4]) -> String {
    let code = |value: f64| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    let [red, green, blue] = [colour[0], colour[1], colour[2]].map(code);
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Text inside quotes or elements of XML. Characters that XML cannot hold are left out.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => {}
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// A number in an attribute, with four decimals.
fn short(value: f64) -> String {
    let mut text = Vec::new();
    Rounding::places(4).write(value, &mut text);
    String::from_utf8_lossy(&text).into_owned()
}

fn svg(stage: &Stage<'_>, out: &mut Vec<u8>) {
    let put = |out: &mut Vec<u8>, text: &str| out.extend_from_slice(text.as_bytes());
    put(out, "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"");
    for (i, value) in stage.view.iter().enumerate() {
        if i > 0 {
            out.push(b' ');
        }
        stage.rounding.write(*value, out);
    }
    put(out, "\" width=\"");
    stage.rounding.write(stage.view[2], out);
    put(out, "\" height=\"");
    stage.rounding.write(stage.view[3], out);
    put(out, "\">\n");
    let first = &stage.frames[0];
    if let Some(name) = &first.name {
        put(out, &format!("<title>{}</title>\n", escaped(name)));
    }
    let mut seen: Vec<&str> = Vec::new();
    for (number, part) in first.parts.iter().enumerate() {
        put(out, "<path");
        // An id stands once in a document.
        if let Some(id) = part.id.as_deref().filter(|id| !seen.contains(id)) {
            seen.push(id);
            put(out, &format!(" id=\"{}\"", escaped(id)));
        }
        put(out, &attributes(part));
        put(out, " d=\"");
        path_data(part, stage.rounding, out);
        put(out, "\"");
        let before = out.len();
        put(out, ">");
        let opened = out.len();
        animate(stage, number, out);
        if out.len() == opened {
            out.truncate(before);
            put(out, "/>\n");
        } else {
            put(out, "\n</path>\n");
        }
    }
    put(out, "</svg>\n");
}

fn attributes(part: &Part) -> String {
    let mut text = match part.fill {
        Some(fill) => format!(" fill=\"{}\"", hex(fill)),
        None => " fill=\"none\"".to_owned(),
    };
    if let Some(fill) = part.fill.filter(|fill| fill[3] != 1.0) {
        text.push_str(&format!(" fill-opacity=\"{}\"", short(fill[3])));
    }
    if part.rule == Rule::EvenOdd {
        text.push_str(" fill-rule=\"evenodd\"");
    }
    if let Some(stroke) = &part.stroke {
        text.push_str(&stroke_attributes(stroke));
    }
    text
}

fn stroke_attributes(stroke: &Stroke) -> String {
    let mut text = format!(
        " stroke=\"{}\" stroke-width=\"{}\"",
        hex(stroke.colour),
        short(stroke.width)
    );
    let mut add = |unless: bool, name: &str, value: &str| {
        if !unless {
            text.push_str(&format!(" {name}=\"{value}\""));
        }
    };
    let opacity = stroke.colour[3];
    add(opacity == 1.0, "stroke-opacity", &short(opacity));
    add(stroke.cap == "butt", "stroke-linecap", stroke.cap);
    add(stroke.join == "miter", "stroke-linejoin", stroke.join);
    let limit = short(stroke.miter_limit);
    add(stroke.miter_limit == 4.0, "stroke-miterlimit", &limit);
    let dashes: Vec<String> = stroke.dashes.iter().map(|dash| short(*dash)).collect();
    add(dashes.is_empty(), "stroke-dasharray", &dashes.join(" "));
    text
}

/// The `animate` elements of a part: of what changes.
fn animate(stage: &Stage<'_>, number: usize, out: &mut Vec<u8>) {
    let parts: Vec<&Part> = stage
        .frames
        .iter()
        .map(|frame| &frame.parts[number])
        .collect();
    let first = parts[0];
    if parts.iter().any(|part| part.contours != first.contours) {
        let smooth = parts.iter().all(|part| part.is_like(first));
        let value = |i: usize, out: &mut Vec<u8>| path_data(parts[i], stage.rounding, out);
        element(stage, "d", smooth, &value, out);
    }
    let fills: Vec<[f64; 4]> = parts
        .iter()
        .map(|part| part.fill.unwrap_or([0.0; 4]))
        .collect();
    if first.fill.is_some() && fills.iter().any(|fill| hex(*fill) != hex(fills[0])) {
        let value = |i: usize, out: &mut Vec<u8>| out.extend_from_slice(hex(fills[i]).as_bytes());
        element(stage, "fill", true, &value, out);
    }
    if first.fill.is_some() && fills.iter().any(|fill| fill[3] != fills[0][3]) {
        let value =
            |i: usize, out: &mut Vec<u8>| out.extend_from_slice(short(fills[i][3]).as_bytes());
        element(stage, "fill-opacity", true, &value, out);
    }
}

fn element(
    stage: &Stage<'_>,
    attribute: &str,
    smooth: bool,
    value: &dyn Fn(usize, &mut Vec<u8>),
    out: &mut Vec<u8>,
) {
    let count = stage.frames.len();
    let seconds = count as f64 / stage.rate;
    let repeat = match stage.repeat {
        Repeat::Forever => "repeatCount=\"indefinite\"".to_owned(),
        Repeat::Times(times) => format!("repeatCount=\"{}\" fill=\"freeze\"", times.max(1)),
    };
    let mode = if smooth { "" } else { " calcMode=\"discrete\"" };
    let head = format!(
        "\n<animate attributeName=\"{attribute}\" dur=\"{}s\" {repeat}{mode} values=\"",
        short(seconds.max(1e-4))
    );
    out.extend_from_slice(head.as_bytes());
    // Values are spread evenly: n of them over n − 1 steps if the viewer goes from one to the next, else over n. With the last one twice
    // both take the same time for each.
    for i in 0..count + usize::from(smooth) {
        if i > 0 {
            out.push(b';');
        }
        value(i.min(count - 1), out);
    }
    out.extend_from_slice(b"\"/>");
}
