//! Animated drawings as Lottie: vector animations for telephones, browsers and the like.
//!
//! Each part is a shape layer, the last part the topmost; each contour is a path with one keyframe a frame, whose vertices have tangents
//! where the contour has curves and zeros where it is straight. Between two keyframes the path goes straight, or stays where the next one is
//! made of other segments. Colours and opacities have keyframes where they change. The layers' transform brings the drawing's coordinates
//! onto the canvas. How often the animation is shown is the player's business.
//!
//! *Source*: Lottie Animation Community, *Lottie Specification* 1.0, 2024, and the JSON that the exporter Bodymovin 5.7 writes, which
//! all players read.

use super::animation::{Animation, Stage};
use super::drawing::{Contour, Part, Rule, Segment};
use super::rounding::Rounding;
use crate::WriteError;
use anamorph_core::glam::DVec2;
use std::io::Write;

/// A canvas smaller than this is enlarged to [`ENLARGED`].
const SMALLEST: f64 = 64.0;
/// The longer side of an enlarged canvas.
const ENLARGED: f64 = 512.0;

impl Animation<'_> {
    /// Writes the frames as Lottie.
    ///
    /// # Errors
    /// As [`Animation::write_svg`].
    pub fn write_lottie(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        let stage = self.stage()?;
        let mut text = Vec::new();
        lottie(&stage, &mut text);
        out.write_all(&text)?;
        Ok(())
    }
}

fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

fn number(value: f64, places: u8) -> String {
    let mut text = Vec::new();
    Rounding::places(places).write(value, &mut text);
    String::from_utf8_lossy(&text).into_owned()
}

fn lottie(stage: &Stage<'_>, out: &mut Vec<u8>) {
    let [x, y, width, height] = stage.view;
    let side = width.max(height);
    let scale = if side < SMALLEST {
        ENLARGED / side
    } else {
        1.0
    };
    let whole = |length: f64| number((length * scale).ceil().max(1.0), 0);
    let count = stage.frames.len();
    let first = &stage.frames[0];
    let head = format!(
        r#"{{"v":"5.7.0","fr":{},"ip":0,"op":{count},"w":{},"h":{},"nm":{},"ddd":0,"assets":[],"layers":["#,
        number(stage.rate, 6),
        whole(width),
        whole(height),
        quoted(first.name.as_deref().unwrap_or("morph")),
    );
    out.extend_from_slice(head.as_bytes());
    let transform = format!(
        r#""ks":{{"o":{{"a":0,"k":100}},"r":{{"a":0,"k":0}},"p":{{"a":0,"k":[{},{},0]}},"a":{{"a":0,"k":[0,0,0]}},"s":{{"a":0,"k":[{},{},100]}}}}"#,
        number(-x * scale, 6),
        number(-y * scale, 6),
        number(100.0 * scale, 6),
        number(100.0 * scale, 6),
    );
    // The first layer is the topmost.
    for (i, number) in (0..first.parts.len()).rev().enumerate() {
        if i > 0 {
            out.push(b',');
        }
        let head = format!(
            r#"{{"ddd":0,"ind":{},"ty":4,"nm":{},"sr":1,{transform},"ao":0,"shapes":["#,
            i + 1,
            quoted(&first.parts[number].name),
        );
        out.extend_from_slice(head.as_bytes());
        group(stage, number, out);
        let tail = format!(r#"],"ip":0,"op":{count},"st":0,"bm":0}}"#);
        out.extend_from_slice(tail.as_bytes());
    }
    out.extend_from_slice(b"]}\n");
}

fn group(stage: &Stage<'_>, number: usize, out: &mut Vec<u8>) {
    let parts: Vec<&Part> = stage
        .frames
        .iter()
        .map(|frame| &frame.parts[number])
        .collect();
    let paths = parts
        .iter()
        .map(|part| part.contours.len())
        .max()
        .unwrap_or(0);
    out.extend_from_slice(br#"{"ty":"gr","it":["#);
    for path in 0..paths {
        let head = format!(r#"{{"ind":{path},"ty":"sh","nm":"Path {}","ks":"#, path + 1);
        out.extend_from_slice(head.as_bytes());
        let contours: Vec<Option<&Contour>> =
            parts.iter().map(|part| part.contours.get(path)).collect();
        let value = |i: usize, out: &mut Vec<u8>| shape(contours[i], stage.rounding, out);
        let like = |a: usize, b: usize| match (contours[a], contours[b]) {
            (Some(a), Some(b)) => vertices(a).0.len() == vertices(b).0.len(),
            (None, None) => true,
            _ => false,
        };
        let still = contours.iter().all(|contour| *contour == contours[0]);
        property(contours.len(), still, true, &like, &value, out);
        out.extend_from_slice(br#","hd":false},"#);
    }
    let mut items = 1 + paths;
    let [red, green, blue, _] = [0.0; 4];
    let fills: Vec<[f64; 4]> = parts
        .iter()
        .map(|part| part.fill.unwrap_or([red, green, blue, 0.0]))
        .collect();
    // A stroke is drawn over the fill, and what comes first is on top.
    if let Some(stroke) = &parts[0].stroke {
        let [red, green, blue, opacity] = stroke.colour;
        let mut colour = Vec::new();
        Rounding::places(4).list(&[red, green, blue, 1.0], &mut colour);
        let cap = 1 + ["butt", "round", "square"]
            .iter()
            .position(|cap| *cap == stroke.cap)
            .unwrap_or(0);
        let join = 1 + ["miter", "round", "bevel"]
            .iter()
            .position(|join| *join == stroke.join)
            .unwrap_or(0);
        let text = format!(
            r#"{{"ty":"st","c":{{"a":0,"k":{}}},"o":{{"a":0,"k":{}}},"w":{{"a":0,"k":{}}},"lc":{cap},"lj":{join},"ml":{},"nm":"Stroke","hd":false}},"#,
            String::from_utf8_lossy(&colour),
            self::number(100.0 * opacity, 4),
            self::number(stroke.width, 4),
            self::number(stroke.miter_limit, 4),
        );
        out.extend_from_slice(text.as_bytes());
        items += 1;
    }
    if parts.iter().any(|part| part.fill.is_some()) {
        out.extend_from_slice(br#"{"ty":"fl","c":"#);
        let colour = |i: usize, out: &mut Vec<u8>| {
            let [red, green, blue, _] = fills[i];
            Rounding::places(4).list(&[red, green, blue, 1.0], out);
        };
        let still = fills.iter().all(|fill| fill[..3] == fills[0][..3]);
        property(fills.len(), still, false, &|_, _| true, &colour, out);
        out.extend_from_slice(br#","o":"#);
        let opacity =
            |i: usize, out: &mut Vec<u8>| Rounding::places(2).write(100.0 * fills[i][3], out);
        let still = fills.iter().all(|fill| fill[3] == fills[0][3]);
        property(fills.len(), still, true, &|_, _| true, &opacity, out);
        let rule = match parts[0].rule {
            Rule::NonZero => 1,
            Rule::EvenOdd => 2,
        };
        out.extend_from_slice(format!(r#","r":{rule},"nm":"Fill","hd":false}},"#).as_bytes());
        items += 1;
    }
    let tail = format!(
        r#"{{"ty":"tr","p":{{"a":0,"k":[0,0]}},"a":{{"a":0,"k":[0,0]}},"s":{{"a":0,"k":[100,100]}},"r":{{"a":0,"k":0}},"o":{{"a":0,"k":100}},"sk":{{"a":0,"k":0}},"sa":{{"a":0,"k":0}}}}],"nm":{},"np":{items},"hd":false}}"#,
        quoted(&parts[0].name)
    );
    out.extend_from_slice(tail.as_bytes());
}

/// A value, or one keyframe for each frame. `listed` puts the values of keyframes into lists, which those that are lists already are not.
fn property(
    count: usize,
    still: bool,
    listed: bool,
    like: &dyn Fn(usize, usize) -> bool,
    value: &dyn Fn(usize, &mut Vec<u8>),
    out: &mut Vec<u8>,
) {
    if still {
        out.extend_from_slice(br#"{"a":0,"k":"#);
        value(0, out);
        out.push(b'}');
        return;
    }
    out.extend_from_slice(br#"{"a":1,"k":["#);
    for i in 0..count {
        if i > 0 {
            out.push(b',');
        }
        out.extend_from_slice(format!(r#"{{"t":{i},"s":"#).as_bytes());
        if listed {
            out.push(b'[');
        }
        value(i, out);
        if listed {
            out.push(b']');
        }
        if i + 1 < count {
            out.extend_from_slice(if like(i, i + 1) {
                // Straight in time.
                br#","i":{"x":1,"y":1},"o":{"x":0,"y":0}}"#
            } else {
                br#","h":1}"#
            });
        } else {
            out.push(b'}');
        }
    }
    out.extend_from_slice(b"]}");
}

/// Vertices of a contour, and the tangents that come in and go out, relative to them.
fn vertices(contour: &Contour) -> (Vec<DVec2>, Vec<DVec2>, Vec<DVec2>) {
    let mut points = vec![contour.start];
    let (mut into, mut from) = (vec![DVec2::ZERO], Vec::new());
    let mut last = contour.start;
    for segment in &contour.segments {
        let (a, b, end) = match segment {
            Segment::Line(end) => (last, *end, *end),
            Segment::Quadratic([control, end]) => (
                last + (*control - last) * (2.0 / 3.0),
                *end + (*control - *end) * (2.0 / 3.0),
                *end,
            ),
            Segment::Cubic([a, b, end]) => (*a, *b, *end),
        };
        from.push(a - last);
        into.push(b - end);
        points.push(end);
        last = end;
    }
    from.push(DVec2::ZERO);
    if contour.closed && points.len() > 1 && points.first() == points.last() {
        // The last vertex is the first one.
        points.pop();
        from.pop();
        if let Some(last) = into.pop() {
            into[0] = last;
        }
    }
    (points, into, from)
}

fn shape(contour: Option<&Contour>, rounding: Rounding, out: &mut Vec<u8>) {
    let Some(contour) = contour else {
        // What is not there is a point.
        out.extend_from_slice(br#"{"i":[[0,0]],"o":[[0,0]],"v":[[0,0]],"c":true}"#);
        return;
    };
    let (points, into, from) = vertices(contour);
    out.extend_from_slice(br#"{"i":"#);
    rounding.points(&into, out);
    out.extend_from_slice(br#","o":"#);
    rounding.points(&from, out);
    out.extend_from_slice(br#","v":"#);
    rounding.points(&points, out);
    out.extend_from_slice(if contour.closed {
        br#","c":true}"#
    } else {
        br#","c":false}"#
    });
}
