//! Two meshes in the plane with the same triangles, and the file that holds them (`pair.json`).
//!
//! The file is JSON: `{format: "anamorph-pair", version: 1, y_axis, source: {name, points}, target: {name, points}, rings: [{points,
//! hole}], triangles, anchors}`; numbers of points count from 0, and `docs/shapes.md` says what each is. Coordinates are the shortest
//! numbers that read back exactly, not rounded: whether a triangle is turned over may hang on the last digit.

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

/// Two meshes with the same triangles.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pair {
    /// Whether y grows downwards.
    pub y_down: bool,
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
        if let Some(short) = self.rings.iter().position(|ring| ring.points.len() < 3) {
            return Err(wrong(
                ReadErrorKind::Element,
                format!("ring {short} has {} points", self.rings[short].points.len()),
                "an outline takes at least three",
            ));
        }
        Ok(())
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
        let pair = Self {
            y_down,
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
