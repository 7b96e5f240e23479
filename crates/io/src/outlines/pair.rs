//! Two meshes in the plane with the same triangles, and the file that holds them (`pair.json`).
//!
//! The file is JSON: `{format: "anamorph-pair", version: 1, y_axis, canvas, source: {name, points}, target: {name, points}, rings: [{points,
//! hole}], triangles, parts: [{name, points, triangles, rings, source, target}], anchors}`; numbers of points count from 0, and `docs/shapes.md`
//! says what each is. `canvas`, `parts` and `anchors` may be missing. Coordinates are the shortest numbers that read back exactly, not rounded:
//! whether a triangle is turned over may hang on the last digit.

use super::drawing::Drawing;
use super::polygons::json;
use crate::error::{ReadError, ReadErrorKind};
use crate::{WriteError, number};
use anamorph_core::glam::{DVec2, dvec2};
use serde_json::Value;
use std::io::Write;

const FORMAT: &str = "anamorph-pair";
const VERSION: u64 = 1;

/// A closed chain of points along an outline, the same in both meshes.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PairRing {
    /// Numbers of points; the last is joined to the first, which is not repeated.
    pub points: Vec<u32>,
    /// Whether it goes around a hole.
    pub hole: bool,
}

/// A part of both meshes: so many of the points, triangles and rings, behind those of the parts before it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PairPart {
    /// What it is called.
    pub name: String,
    /// How many points it has.
    pub points: usize,
    /// How many triangles.
    pub triangles: usize,
    /// How many rings.
    pub rings: usize,
    /// Its fill in the source and in the target: red, green, blue and opacity from 0 to 1, sRGB-encoded; none where it is not to be seen.
    pub fills: [Option<[f64; 4]>; 2],
}

/// What belongs to a part; numbers of points are those of the whole.
#[derive(Debug, Clone, PartialEq)]
pub struct PairSlice<'a> {
    /// The part.
    pub part: PairPart,
    /// The numbers of its points.
    pub points: core::ops::Range<usize>,
    /// Its triangles.
    pub triangles: &'a [[u32; 3]],
    /// Its rings.
    pub rings: &'a [PairRing],
}

/// Two meshes with the same triangles.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pair {
    /// Whether y grows downwards.
    pub y_down: bool,
    /// What is to be seen: left, the lesser y, width and height.
    pub canvas: Option<[f64; 4]>,
    /// What the two shapes are called.
    pub names: [String; 2],
    /// Points of the first mesh.
    pub source: Vec<DVec2>,
    /// The same points in the second mesh.
    pub target: Vec<DVec2>,
    /// The outlines.
    pub rings: Vec<PairRing>,
    /// Numbers of the corners of the triangles.
    pub triangles: Vec<[u32; 3]>,
    /// The parts, one behind the other; empty where nothing is said of parts.
    pub parts: Vec<PairPart>,
    /// Numbers of the points that somebody placed.
    pub anchors: Vec<u32>,
}

fn wrong(kind: ReadErrorKind, what: impl Into<String>, mend: &str) -> ReadError {
    ReadError::new(kind, what, mend)
}

impl Pair {
    /// Whether a file's bytes are those of a pair; they are parsed to find out.
    #[must_use]
    pub fn is_pair(bytes: &[u8]) -> bool {
        json(bytes).is_ok_and(|value| value.get("format").and_then(Value::as_str) == Some(FORMAT))
    }

    /// What cannot be: meshes of different numbers of points, points that are not finite, numbers of points that are not there, triangles and
    /// rings that have a point twice. Whether triangles are turned over is not looked at.
    ///
    /// # Errors
    /// The first of these.
    pub fn check(&self) -> Result<(), ReadError> {
        let count = self.source.len();
        if count != self.target.len() {
            return Err(wrong(
                ReadErrorKind::Shape,
                format!(
                    "the source has {count} points and the target {}",
                    self.target.len()
                ),
                "give both as many",
            ));
        }
        let sides = [("source", &self.source), ("target", &self.target)];
        for (side, points) in sides {
            if let Some(bad) = points.iter().position(|point| !point.is_finite()) {
                return Err(wrong(
                    ReadErrorKind::NonFinite,
                    format!("point {bad} of the {side} is not finite"),
                    "correct it",
                ));
            }
        }
        let absent = |list: &[u32]| list.iter().copied().find(|point| *point as usize >= count);
        let lists = self
            .triangles
            .iter()
            .enumerate()
            .map(|(i, list)| ("triangle", i, &list[..]));
        let rings = self
            .rings
            .iter()
            .enumerate()
            .map(|(i, ring)| ("ring", i, &ring.points[..]));
        let anchors = core::iter::once(("list of anchors", 0, &self.anchors[..]));
        let mut seen = vec![usize::MAX; count];
        for (round, (what, i, list)) in lists.chain(rings).chain(anchors).enumerate() {
            if let Some(absent) = absent(list) {
                return Err(wrong(
                    ReadErrorKind::Reference,
                    format!("{what} {i} names point {absent}, and there are {count}, from 0"),
                    "correct the number",
                ));
            }
            for &point in list {
                let last = core::mem::replace(&mut seen[point as usize], round);
                if last == round {
                    return Err(wrong(
                        ReadErrorKind::Element,
                        format!("{what} {i} names point {point} twice"),
                        "name each point once",
                    ));
                }
            }
        }
        self.check_parts()?;
        if let Some([.., width, height]) = self.canvas
            && !(width > 0.0 && height > 0.0)
        {
            return Err(wrong(
                ReadErrorKind::Shape,
                format!("the canvas is {width} × {height}"),
                "give its left, its lesser y, its width and its height",
            ));
        }
        if let Some(short) = self.rings.iter().position(|ring| ring.points.len() < 3) {
            return Err(wrong(
                ReadErrorKind::Element,
                format!("ring {short} has {} points", self.rings[short].points.len()),
                "an outline takes at least three",
            ));
        }
        Ok(())
    }

    /// Parts that have more or fewer points, triangles and rings than there are, or whose triangles and rings name points of others.
    fn check_parts(&self) -> Result<(), ReadError> {
        if self.parts.is_empty() {
            return Ok(());
        }
        let together = |of: fn(&PairPart) -> usize| {
            let counts = self.parts.iter().map(of);
            counts.fold(0_usize, usize::saturating_add)
        };
        for (what, count, together) in [
            ("points", self.source.len(), together(|part| part.points)),
            (
                "triangles",
                self.triangles.len(),
                together(|part| part.triangles),
            ),
            ("rings", self.rings.len(), together(|part| part.rings)),
        ] {
            if together != count {
                return Err(wrong(
                    ReadErrorKind::Shape,
                    format!("the parts have {together} {what} together, and there are {count}"),
                    "correct the numbers, or leave `parts` out",
                ));
            }
        }
        for (number, part) in self.split().enumerate() {
            let lists = part.triangles.iter().map(|list| &list[..]);
            let all = lists.chain(part.rings.iter().map(|ring| &ring.points[..]));
            let points = &part.points;
            let other = all
                .flatten()
                .find(|point| !points.contains(&(**point as usize)));
            if let Some(other) = other {
                return Err(wrong(
                    ReadErrorKind::Reference,
                    format!("part {number} names point {other}, which is not one of its own"),
                    "list the points, triangles and rings of each part behind those of the one before",
                ));
            }
        }
        Ok(())
    }

    /// The parts with what belongs to each; the whole is one part where there are none. Call [`Pair::check`] before.
    pub fn split(&self) -> impl Iterator<Item = PairSlice<'_>> {
        let whole = PairPart {
            name: self.names[0].clone(),
            points: self.source.len(),
            triangles: self.triangles.len(),
            rings: self.rings.len(),
            fills: [None; 2],
        };
        let none = self.parts.is_empty();
        let parts = self.parts.iter().cloned().chain(none.then_some(whole));
        let (mut points, mut triangles, mut rings) = (0, 0, 0);
        parts.map(move |part| {
            let first = [points, triangles, rings];
            points += part.points;
            triangles += part.triangles;
            rings += part.rings;
            PairSlice {
                points: first[0]..points,
                triangles: self.triangles.get(first[1]..triangles).unwrap_or_default(),
                rings: self.rings.get(first[2]..rings).unwrap_or_default(),
                part,
            }
        })
    }

    /// Reads a pair.
    ///
    /// # Errors
    /// What is no such file, and what [`Pair::check`] finds.
    pub fn read(bytes: &[u8]) -> Result<Self, ReadError> {
        let value = json(bytes)?;
        if value.get("format").and_then(Value::as_str) != Some(FORMAT) {
            return Err(wrong(
                ReadErrorKind::UnknownFormat,
                format!("this file is no pair of meshes: its `format` is not \"{FORMAT}\""),
                "take a file that `anamorph mesh` wrote",
            ));
        }
        match value.get("version").and_then(Value::as_u64) {
            Some(VERSION) => {}
            other => {
                let other = other.map_or("no number".to_owned(), |version| version.to_string());
                return Err(wrong(
                    ReadErrorKind::Unsupported,
                    format!("this pair is of version {other}, and version {VERSION} is known"),
                    "write it anew",
                ));
            }
        }
        let y_down = match value.get("y_axis").and_then(Value::as_str) {
            Some("up") => false,
            Some("down") => true,
            _ => {
                return Err(wrong(
                    ReadErrorKind::Unsupported,
                    "`y_axis` is neither \"up\" nor \"down\"",
                    "write one of them",
                ));
            }
        };
        let none = Value::Null;
        let [source, target] = ["source", "target"].map(|key| value.get(key).unwrap_or(&none));
        let name = |side: &Value| {
            let name = side.get("name").and_then(Value::as_str);
            name.unwrap_or_default().to_owned()
        };
        let mut rings = Vec::new();
        for (i, ring) in list(value.get("rings"), "rings")?.iter().enumerate() {
            let points = list(ring.get("points"), "points of a ring")?;
            rings.push(PairRing {
                points: numbers(points, &|| format!("ring {i}"))?,
                hole: ring.get("hole").and_then(Value::as_bool).unwrap_or(false),
            });
        }
        let mut triangles = Vec::new();
        let all = list(value.get("triangles"), "triangles")?;
        for (i, triangle) in all.iter().enumerate() {
            let corners = triangle.as_array().map_or(&[][..], Vec::as_slice);
            let corners = numbers(corners, &|| format!("triangle {i}"))?;
            triangles.push(<[u32; 3]>::try_from(corners).map_err(|corners| {
                wrong(
                    ReadErrorKind::Element,
                    format!("triangle {i} has {} corners", corners.len()),
                    "write three",
                )
            })?);
        }
        let anchors = match value.get("anchors") {
            None => Vec::new(),
            some => numbers(list(some, "anchors")?, &|| "the list of anchors".to_owned())?,
        };
        let canvas = match value.get("canvas") {
            None | Some(Value::Null) => None,
            Some(canvas) => {
                let numbers = numbers_of(canvas, "canvas", "write [left, least y, width, height]")?;
                Some(numbers)
            }
        };
        let mut parts = Vec::new();
        if let Some(all) = value.get("parts") {
            for (i, part) in list(Some(all), "parts")?.iter().enumerate() {
                parts.push(read_part(i, part)?);
            }
        }
        let pair = Self {
            y_down,
            canvas,
            parts,
            names: [name(source), name(target)],
            source: places(source, "source")?,
            target: places(target, "target")?,
            rings,
            triangles,
            anchors,
        };
        pair.check()?;
        Ok(pair)
    }

    /// Writes the pair.
    ///
    /// # Errors
    /// What [`Pair::check`] finds, before anything is written; what the receiver says.
    pub fn write(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        self.check().map_err(|error| WriteError::Refused {
            what: error.what,
            mend: error.mend,
        })?;
        let axis = if self.y_down { "down" } else { "up" };
        let mut text =
            format!("{{\"format\":\"{FORMAT}\",\"version\":{VERSION},\"y_axis\":\"{axis}\",\n")
                .into_bytes();
        if let Some(canvas) = &self.canvas {
            text.extend_from_slice(b"\"canvas\":");
            four(canvas, &mut text);
            text.extend_from_slice(b",\n");
        }
        let sides = [("source", &self.source), ("target", &self.target)];
        for ((side, points), name) in sides.into_iter().zip(&self.names) {
            let name = Value::from(name.as_str()).to_string();
            text.extend_from_slice(format!("\"{side}\":{{\"name\":{name},\"points\":[").as_bytes());
            for (i, point) in points.iter().enumerate() {
                text.extend_from_slice(if i > 0 { b",[" } else { b"[" });
                number::write(point.x, &mut text);
                text.push(b',');
                number::write(point.y, &mut text);
                text.push(b']');
            }
            text.extend_from_slice(b"]},\n");
        }
        text.extend_from_slice(b"\"rings\":[");
        for (i, ring) in self.rings.iter().enumerate() {
            text.extend_from_slice(if i > 0 {
                b",{\"points\":"
            } else {
                b"{\"points\":"
            });
            whole(&ring.points, &mut text);
            text.extend_from_slice(format!(",\"hole\":{}}}", ring.hole).as_bytes());
        }
        text.extend_from_slice(b"],\n\"triangles\":[");
        for (i, triangle) in self.triangles.iter().enumerate() {
            if i > 0 {
                text.push(b',');
            }
            whole(triangle, &mut text);
        }
        if !self.parts.is_empty() {
            text.extend_from_slice(b"],\n\"parts\":[");
            for (i, part) in self.parts.iter().enumerate() {
                let gap = if i > 0 { "," } else { "" };
                let name = Value::from(part.name.as_str()).to_string();
                let PairPart {
                    points,
                    triangles,
                    rings,
                    ..
                } = part;
                let line = format!(
                    "{gap}\n{{\"name\":{name},\"points\":{points},\"triangles\":{triangles},\"rings\":{rings}"
                );
                text.extend_from_slice(line.as_bytes());
                for (side, fill) in ["source", "target"].into_iter().zip(&part.fills) {
                    text.extend_from_slice(format!(",\"{side}\":{{\"fill\":").as_bytes());
                    match fill {
                        Some(fill) => four(fill, &mut text),
                        None => text.extend_from_slice(b"null"),
                    }
                    text.push(b'}');
                }
                text.push(b'}');
            }
        }
        text.extend_from_slice(b"],\n\"anchors\":");
        whole(&self.anchors, &mut text);
        text.extend_from_slice(b"}\n");
        out.write_all(&text)?;
        Ok(())
    }

    /// The outlines of the first or the second mesh as a drawing of one part.
    #[must_use]
    pub fn drawing(&self, target: bool, fill: Option<[f64; 4]>) -> Drawing {
        let points = if target { &self.target } else { &self.source };
        let ring = |ring: &PairRing| {
            let known = ring.points.iter();
            known
                .filter_map(|point| points.get(*point as usize).copied())
                .collect()
        };
        let name = self.names[usize::from(target)].clone();
        let part = super::Part::of_rings(name.clone(), fill, self.rings.iter().map(ring));
        Drawing {
            name: Some(name),
            parts: vec![part],
            y_down: self.y_down,
            ..Drawing::default()
        }
    }
}

fn whole(list: &[u32], out: &mut Vec<u8>) {
    out.push(b'[');
    for (i, value) in list.iter().enumerate() {
        if i > 0 {
            out.push(b',');
        }
        number::write_whole(u64::from(*value), out);
    }
    out.push(b']');
}

fn four(list: &[f64; 4], out: &mut Vec<u8>) {
    for (i, value) in list.iter().enumerate() {
        out.push(if i > 0 { b',' } else { b'[' });
        number::write(*value, out);
    }
    out.push(b']');
}

fn numbers_of(value: &Value, what: &str, mend: &str) -> Result<[f64; 4], ReadError> {
    let list = value.as_array().map_or(&[][..], Vec::as_slice);
    let numbers: Option<Vec<f64>> = list.iter().map(Value::as_f64).collect();
    let four = numbers.and_then(|numbers| <[f64; 4]>::try_from(numbers).ok());
    four.ok_or_else(|| {
        wrong(
            ReadErrorKind::Number,
            format!("the {what} is not four numbers"),
            mend,
        )
    })
}

fn read_part(number: usize, value: &Value) -> Result<PairPart, ReadError> {
    let count = |key: &str| {
        let count = value.get(key).and_then(Value::as_u64);
        let count = count.and_then(|count| usize::try_from(count).ok());
        count.ok_or_else(|| {
            wrong(
                ReadErrorKind::Number,
                format!("part {number} has no number of {key}"),
                "write a whole number",
            )
        })
    };
    let mut fills = [None; 2];
    for (side, fill) in ["source", "target"].into_iter().zip(&mut fills) {
        let given = value.get(side).and_then(|side| side.get("fill"));
        if let Some(given) = given.filter(|given| !given.is_null()) {
            let mend = "write red, green, blue and opacity from 0 to 1, or null";
            let read = numbers_of(given, &format!("fill of part {number}"), mend)?;
            if read.iter().any(|light| !(0.0..=1.0).contains(light)) {
                return Err(wrong(
                    ReadErrorKind::Number,
                    format!("the fill of part {number} leaves 0 to 1"),
                    mend,
                ));
            }
            *fill = Some(read);
        }
    }
    let name = value.get("name").and_then(Value::as_str);
    Ok(PairPart {
        name: name.unwrap_or_default().to_owned(),
        points: count("points")?,
        triangles: count("triangles")?,
        rings: count("rings")?,
        fills,
    })
}

fn list<'v>(value: Option<&'v Value>, what: &str) -> Result<&'v [Value], ReadError> {
    let list = value.and_then(Value::as_array).map(Vec::as_slice);
    list.ok_or_else(|| {
        wrong(
            ReadErrorKind::Shape,
            format!("this pair has no list `{what}`"),
            "complete it",
        )
    })
}

fn numbers(list: &[Value], what: &dyn Fn() -> String) -> Result<Vec<u32>, ReadError> {
    let number = |value: &Value| value.as_u64().and_then(|number| u32::try_from(number).ok());
    let numbers: Option<Vec<u32>> = list.iter().map(number).collect();
    numbers.ok_or_else(|| {
        wrong(
            ReadErrorKind::Number,
            format!("{} names something that is no number of a point", what()),
            "write whole numbers from 0",
        )
    })
}

fn places(side: &Value, what: &str) -> Result<Vec<DVec2>, ReadError> {
    let all = list(side.get("points"), &format!("points of the {what}"))?;
    let mut points = Vec::with_capacity(all.len());
    for (i, place) in all.iter().enumerate() {
        let pair = match place.as_array().map(Vec::as_slice) {
            Some([x, y]) => x.as_f64().zip(y.as_f64()),
            _ => None,
        };
        let Some((x, y)) = pair else {
            return Err(wrong(
                ReadErrorKind::Number,
                format!("point {i} of the {what} is not two numbers"),
                "write [x, y]",
            ));
        };
        points.push(dvec2(x, y));
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair() -> Pair {
        let square = [[0.0, 0.0], [0.1 + 0.2, 0.0], [1.0, 1.0 / 3.0], [0.0, 1e-17]];
        let points = square.map(|[x, y]| dvec2(x, y)).to_vec();
        Pair {
            y_down: false,
            names: ["a \"b\"".to_owned(), String::new()],
            target: points.iter().map(|p| *p * 3.0 - 1.0).collect(),
            source: points,
            rings: vec![PairRing {
                points: vec![0, 1, 2, 3],
                hole: false,
            }],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            anchors: vec![2],
            ..Pair::default()
        }
    }

    /// Two squares, the second not to be seen in the source.
    fn two_parts() -> Pair {
        let one = pair();
        let part = |name: &str, fills| PairPart {
            name: name.to_owned(),
            points: 4,
            triangles: 2,
            rings: 1,
            fills,
        };
        let red = Some([1.0, 0.1, 0.0, 0.5]);
        let mut both = Pair {
            canvas: Some([-1.0, 0.5, 20.0, 10.0]),
            parts: vec![part("a", [red; 2]), part("b", [None, red])],
            ..one.clone()
        };
        both.source
            .extend(one.source.iter().map(|p| *p + dvec2(5.0, 0.0)));
        both.target
            .extend(one.target.iter().map(|p| *p + dvec2(5.0, 0.0)));
        both.triangles.extend([[4, 5, 6], [4, 6, 7]]);
        both.rings.push(PairRing {
            points: vec![4, 5, 6, 7],
            hole: false,
        });
        both
    }

    #[test]
    fn parts_follow_each_other_and_are_read_back() {
        let both = two_parts();
        let mut file = Vec::new();
        both.write(&mut file).unwrap();
        assert_eq!(Pair::read(&file).unwrap(), both);
        let slices: Vec<PairSlice<'_>> = both.split().collect();
        assert_eq!(slices[1].points, 4..8);
        assert_eq!(slices[1].triangles, [[4, 5, 6], [4, 6, 7]]);
        assert_eq!(slices[1].part.fills[0], None);
        // Without parts the whole is one.
        let whole = pair();
        let slices: Vec<PairSlice<'_>> = whole.split().collect();
        assert_eq!(slices.len(), 1);
        assert_eq!(slices[0].triangles, whole.triangles);

        let text = String::from_utf8(file).unwrap();
        for (from, to, says) in [
            (
                "\"points\":4,\"triangles\":2",
                "\"points\":5,\"triangles\":2",
                "9 points",
            ),
            (
                "\"points\":4,\"triangles\":2",
                "\"triangles\":2",
                "no number of points",
            ),
            ("[4,5,6],", "[4,5,2],", "not one of its own"),
            ("[1,0.1,0,0.5]", "[1,0.1,0]", "four numbers"),
            ("[1,0.1,0,0.5]", "[1,0.1,0,2]", "leaves 0 to 1"),
            ("[-1,0.5,20,10]", "[-1,0.5,0,10]", "canvas"),
        ] {
            assert!(text.contains(from), "{from} in {text}");
            let error = Pair::read(text.replacen(from, to, 1).as_bytes()).unwrap_err();
            assert!(error.to_string().contains(says), "{to}: {error}");
        }
    }

    #[test]
    fn a_pair_is_read_back_bit_for_bit() {
        let pair = pair();
        let mut file = Vec::new();
        pair.write(&mut file).unwrap();
        assert!(Pair::is_pair(&file));
        assert_eq!(Pair::read(&file).unwrap(), pair);
        let value: Value = serde_json::from_slice(&file).unwrap();
        assert_eq!(value["version"], 1);
        assert_eq!(value["target"]["points"][0][0], -1.0);
        let drawing = pair.drawing(true, None);
        let points: Vec<DVec2> = drawing.points().collect();
        assert_eq!(points, pair.target);
    }

    #[test]
    fn damaged_pairs_say_what_and_where() {
        let mut file = Vec::new();
        pair().write(&mut file).unwrap();
        let text = String::from_utf8(file).unwrap();
        for (from, to, kind, says) in [
            ("[0,1,2],", "[0,1,9],", ReadErrorKind::Reference, "point 9"),
            ("[0,1,2],", "[0,1,1],", ReadErrorKind::Element, "twice"),
            ("[0,1,2],", "[0,1],", ReadErrorKind::Element, "2 corners"),
            ("[0,1,2],", "[0,1,-2],", ReadErrorKind::Number, "triangle 0"),
            (
                "\"points\":[[0,0],",
                "\"points\":[",
                ReadErrorKind::Shape,
                "3 points",
            ),
            (
                "\"version\":1",
                "\"version\":2",
                ReadErrorKind::Unsupported,
                "version 2",
            ),
            (
                "anamorph-pair",
                "other",
                ReadErrorKind::UnknownFormat,
                "no pair",
            ),
            (
                "\"points\":[0,1,2,3]",
                "\"points\":[0,1]",
                ReadErrorKind::Element,
                "2 points",
            ),
            (
                "\"anchors\":[2]",
                "\"anchors\":[2.5]",
                ReadErrorKind::Number,
                "anchors",
            ),
            (
                "\"y_axis\":\"up\",",
                "",
                ReadErrorKind::Unsupported,
                "y_axis",
            ),
        ] {
            assert!(text.contains(from), "{from}");
            let error = Pair::read(text.replacen(from, to, 1).as_bytes()).unwrap_err();
            assert_eq!(error.kind, kind, "{to}: {error}");
            assert!(error.to_string().contains(says), "{to}: {error}");
        }
        // Nothing is written of what cannot be read.
        let mut bad = pair();
        bad.target[1].x = f64::NAN;
        let mut file = Vec::new();
        assert!(bad.write(&mut file).is_err() && file.is_empty());
    }
}
