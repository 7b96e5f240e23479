//! Polygons with holes: files of our own (JSON) and `GeoJSON`.
//!
//! Ours is `{name, units, y_axis, fill_rule, polygons: [{id, name, part, fill, fill_rule, outer, holes}]}`, of which only the rings have to
//! be there; see `docs/shapes.md`. Polygons of the same `part` are one part with several outlines. Rings are read as they are, in any
//! direction, a repeated last point left out; what they may not be (crossing, empty, outside) is the business of those who use them.
//! Written outlines run in the positive direction of the stored coordinates (shoelace), and holes in the negative one.
//!
//! *Source*: H. Butler et al., *The `GeoJSON` Format*, RFC 7946, 2016.

use super::drawing::{Contour, Drawing, Part, Rule};
use super::nesting::Polygon;
use super::rounding::Rounding;
use crate::WriteError;
use crate::error::{ReadError, ReadErrorKind};
use anamorph_core::glam::{DVec2, dvec2};
use serde_json::Value;
use std::collections::HashMap;
use std::io::Write;

/// Bytes of a file at most.
const LARGEST: usize = 1 << 28;
/// What is not said to have another colour.
const BLACK: [f64; 4] = [0.0, 0.0, 0.0, 1.0];
/// Collections of geometries inside of each other at most.
const DEEPEST: usize = 16;

fn wrong(kind: ReadErrorKind, what: impl Into<String>, mend: &str) -> ReadError {
    ReadError::new(kind, what, mend)
}

/// The JSON value of a file.
pub(super) fn json(bytes: &[u8]) -> Result<Value, ReadError> {
    if bytes.len() > LARGEST {
        return Err(wrong(
            ReadErrorKind::TooLarge,
            "this file is larger than 256 MiB",
            "split it, or leave out what is not needed",
        ));
    }
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    serde_json::from_slice(text).map_err(|error| {
        let mut refused = wrong(
            ReadErrorKind::Syntax,
            format!("this is no JSON: {}", plain(&error)),
            "correct the place; numbers are finite there",
        );
        refused.line = Some(error.line() as u64).filter(|line| *line > 0);
        refused.column = refused.line.map(|_| error.column() as u64);
        refused
    })
}

/// What is wrong, without the place that is told apart.
fn plain(error: &serde_json::Error) -> String {
    let text = error.to_string();
    match text.rfind(" at line ") {
        Some(end) => text[..end].to_owned(),
        None => text,
    }
}

/// Whether a JSON value is `GeoJSON`.
pub(super) fn is_geojson(value: &Value) -> bool {
    let kind = value.get("type").and_then(Value::as_str);
    let kinds = [
        "Polygon",
        "MultiPolygon",
        "Feature",
        "FeatureCollection",
        "GeometryCollection",
    ];
    kind.is_some_and(|kind| kinds.contains(&kind))
        && ["coordinates", "geometry", "features", "geometries"]
            .iter()
            .any(|key| value.get(key).is_some())
}

/// Whether a JSON value is a file of polygons.
pub(super) fn is_polygons(value: &Value) -> bool {
    value.get("polygons").is_some_and(Value::is_array)
}

/// Reads a ring; `what` names it.
fn ring(value: &Value, what: &dyn Fn() -> String) -> Result<Contour, ReadError> {
    let Some(list) = value.as_array() else {
        return Err(wrong(
            ReadErrorKind::Shape,
            format!("{} is no list of points", what()),
            "write a list of [x, y]",
        ));
    };
    let mut points: Vec<DVec2> = Vec::with_capacity(list.len());
    for (i, place) in list.iter().enumerate() {
        let numbers = place.as_array().filter(|numbers| numbers.len() >= 2);
        let pair = numbers.and_then(|n| Some(dvec2(n[0].as_f64()?, n[1].as_f64()?)));
        match pair.filter(|point| point.is_finite()) {
            Some(point) => points.push(point),
            None => {
                return Err(wrong(
                    ReadErrorKind::Number,
                    format!("point {} of {} is not two finite numbers", i + 1, what()),
                    "write [x, y]",
                ));
            }
        }
    }
    if points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    if points.len() < 3 {
        return Err(wrong(
            ReadErrorKind::Shape,
            format!("{} has {} points", what(), points.len()),
            "an outline takes at least three; complete it or leave it out",
        ));
    }
    Contour::polygon(points).ok_or_else(|| {
        wrong(
            ReadErrorKind::Shape,
            format!("{} is empty", what()),
            "leave it out",
        )
    })
}

fn text(value: &Value, key: &str) -> Option<String> {
    let text = value.get(key).and_then(Value::as_str);
    text.filter(|text| !text.is_empty()).map(str::to_owned)
}

fn rule(value: &Value) -> Result<Option<Rule>, ReadError> {
    match value.get("fill_rule") {
        None | Some(Value::Null) => Ok(None),
        Some(name) => match name.as_str().and_then(Rule::of_name) {
            Some(rule) => Ok(Some(rule)),
            None => Err(wrong(
                ReadErrorKind::Unsupported,
                format!("the fill rule {name} is not known"),
                "write \"nonzero\" or \"evenodd\"",
            )),
        },
    }
}

fn fill(value: &Value, number: usize) -> Result<Option<[f64; 4]>, ReadError> {
    let list = match value.get("fill") {
        None => return Ok(Some(BLACK)),
        Some(Value::Null) => return Ok(None),
        Some(list) => list.as_array().map_or(&[][..], Vec::as_slice),
    };
    let numbers: Option<Vec<f64>> = list.iter().map(Value::as_f64).collect();
    let within = |numbers: &Vec<f64>| numbers.iter().all(|x| (0.0..=1.0).contains(x));
    match numbers.filter(within).as_deref() {
        Some(&[red, green, blue]) => Ok(Some([red, green, blue, 1.0])),
        Some(&[red, green, blue, opacity]) => Ok(Some([red, green, blue, opacity])),
        _ => Err(wrong(
            ReadErrorKind::Number,
            format!("the fill of polygon {number} is not three or four numbers from 0 to 1"),
            "write [red, green, blue, opacity], or null for none",
        )),
    }
}

/// Reads a file of polygons. A file that does not say has y growing downwards and the even-odd rule.
///
/// # Errors
/// What is no such file, points that are not two finite numbers, rings of fewer than three points, a file without polygons.
pub fn read_polygons(bytes: &[u8]) -> Result<Drawing, ReadError> {
    of_polygons(&json(bytes)?)
}

pub(super) fn of_polygons(value: &Value) -> Result<Drawing, ReadError> {
    let Some(list) = value.get("polygons").and_then(Value::as_array) else {
        return Err(wrong(
            ReadErrorKind::Shape,
            "this file has no list `polygons`",
            "write {\"polygons\": [{\"outer\": [[x, y], …], \"holes\": []}]}",
        ));
    };
    let y_down = match value.get("y_axis").map(Value::as_str) {
        None | Some(Some("down")) => true,
        Some(Some("up")) => false,
        _ => {
            return Err(wrong(
                ReadErrorKind::Unsupported,
                "`y_axis` is neither \"down\" nor \"up\"",
                "write one of them",
            ));
        }
    };
    let canvas = match value.get("canvas") {
        None | Some(Value::Null) => None,
        Some(canvas) => {
            let numbers = canvas.as_array().map_or(&[][..], Vec::as_slice);
            let numbers: Option<Vec<f64>> = numbers.iter().map(Value::as_f64).collect();
            match numbers.as_deref() {
                Some(&[x, y, w, h]) if w > 0.0 && h > 0.0 => Some([x, y, w, h]),
                _ => {
                    return Err(wrong(
                        ReadErrorKind::Number,
                        "`canvas` is not the left, the lesser y, the width and the height",
                        "write four numbers, the last two positive",
                    ));
                }
            }
        }
    };
    let all = rule(value)?.unwrap_or(Rule::EvenOdd);
    let mut parts: Vec<Part> = Vec::new();
    let mut known: HashMap<u64, usize> = HashMap::new();
    for (i, polygon) in list.iter().enumerate() {
        let number = i + 1;
        let outer = ring(polygon.get("outer").unwrap_or(&Value::Null), &|| {
            format!("the outline of polygon {number}")
        })?;
        let mut contours = vec![outer];
        let holes = polygon.get("holes").and_then(Value::as_array);
        for (k, hole) in holes.into_iter().flatten().enumerate() {
            contours.push(ring(hole, &|| {
                format!("hole {} of polygon {number}", k + 1)
            })?);
        }
        let group = polygon.get("part").and_then(Value::as_u64);
        if let Some(&part) = group.and_then(|group| known.get(&group)) {
            parts[part].contours.append(&mut contours);
            continue;
        }
        if let Some(group) = group {
            known.insert(group, parts.len());
        }
        let id = text(polygon, "id");
        let name = text(polygon, "name").or_else(|| id.clone());
        parts.push(Part {
            name: name.unwrap_or_else(|| format!("polygon {number}")),
            id,
            fill: fill(polygon, number)?,
            rule: rule(polygon)?.unwrap_or(all),
            contours,
            stroke: None,
        });
    }
    if parts.is_empty() {
        return Err(wrong(
            ReadErrorKind::NoPath,
            "this file has no polygon",
            "list some under `polygons`",
        ));
    }
    Ok(Drawing {
        name: text(value, "name"),
        units: text(value, "units"),
        parts,
        canvas,
        y_down,
        notes: Vec::new(),
    })
}

/// Reads polygons of `GeoJSON`: a polygon, several, a feature, or collections of these. y is latitude and grows upwards; nothing is
/// projected. Each polygon is a part; those of one feature share its name, and a feature of one polygon gives it its id.
///
/// # Errors
/// As [`read_polygons`].
pub fn read_geojson(bytes: &[u8]) -> Result<Drawing, ReadError> {
    of_geojson(&json(bytes)?)
}

#[derive(Default)]
struct Geo {
    parts: Vec<Part>,
    /// Geometries that have no inside.
    others: usize,
}

impl Geo {
    fn add(&mut self, value: &Value, name: &str, deep: usize) -> Result<(), ReadError> {
        let unknown = || {
            let what = "a geometry of this GeoJSON is of no known type";
            wrong(
                ReadErrorKind::Unsupported,
                what,
                "write a Polygon or a MultiPolygon",
            )
        };
        if deep > DEEPEST {
            return Err(wrong(
                ReadErrorKind::TooLarge,
                format!("collections are nested deeper than {DEEPEST}"),
                "write one list of features",
            ));
        }
        let list = |key: &str| {
            let list = value.get(key).and_then(Value::as_array);
            list.ok_or_else(|| {
                wrong(
                    ReadErrorKind::Shape,
                    format!("a part of this GeoJSON has no list `{key}`"),
                    "complete it",
                )
            })
        };
        match value.get("type").and_then(Value::as_str) {
            Some("FeatureCollection") => {
                for feature in list("features")? {
                    self.add(feature, name, deep + 1)?;
                }
            }
            Some("GeometryCollection") => {
                for geometry in list("geometries")? {
                    self.add(geometry, name, deep + 1)?;
                }
            }
            Some("Feature") => {
                let properties = value.get("properties");
                let own = properties.and_then(|p| text(p, "name").or_else(|| text(p, "NAME")));
                let first = self.parts.len();
                match value.get("geometry") {
                    None | Some(Value::Null) => self.others += 1,
                    Some(geometry) => {
                        self.add(geometry, own.as_deref().unwrap_or(name), deep + 1)?;
                    }
                }
                let id = match value.get("id") {
                    Some(Value::String(id)) if !id.is_empty() => Some(id.clone()),
                    Some(Value::Number(id)) => Some(id.to_string()),
                    _ => None,
                };
                if let [part] = &mut self.parts[first..] {
                    part.id = id.or(own);
                }
            }
            Some("Polygon") => self.polygon(list("coordinates")?, name)?,
            Some("MultiPolygon") => {
                for polygon in list("coordinates")? {
                    let rings = polygon.as_array().map_or(&[][..], Vec::as_slice);
                    self.polygon(rings, name)?;
                }
            }
            Some("Point" | "MultiPoint" | "LineString" | "MultiLineString") => self.others += 1,
            _ => return Err(unknown()),
        }
        Ok(())
    }

    fn polygon(&mut self, rings: &[Value], name: &str) -> Result<(), ReadError> {
        let number = self.parts.len() + 1;
        let mut contours = Vec::with_capacity(rings.len());
        for (k, one) in rings.iter().enumerate() {
            contours.push(ring(one, &|| {
                format!("ring {} of polygon {number}", k + 1)
            })?);
        }
        if contours.is_empty() {
            self.others += 1;
            return Ok(());
        }
        self.parts.push(Part {
            name: if name.is_empty() {
                format!("polygon {number}")
            } else {
                name.to_owned()
            },
            fill: Some(BLACK),
            rule: Rule::EvenOdd,
            contours,
            ..Part::default()
        });
        Ok(())
    }
}

pub(super) fn of_geojson(value: &Value) -> Result<Drawing, ReadError> {
    let mut geo = Geo::default();
    geo.add(value, "", 0)?;
    if geo.parts.is_empty() {
        return Err(wrong(
            ReadErrorKind::NoPath,
            "this GeoJSON has no polygon",
            "write a Polygon or a MultiPolygon",
        ));
    }
    let notes = match geo.others {
        0 => Vec::new(),
        1 => vec!["1 geometry without an inside is left out".to_owned()],
        more => vec![format!("{more} geometries without an inside are left out")],
    };
    let of_feature = value.get("properties").and_then(|p| text(p, "name"));
    Ok(Drawing {
        name: of_feature.or_else(|| text(value, "name")),
        units: Some("degrees".to_owned()),
        parts: geo.parts,
        canvas: None,
        y_down: false,
        notes,
    })
}

/// Writes a drawing as a file of polygons, its curves flattened to `tolerance` in its units, on one line. Strokes are left out.
///
/// # Errors
/// What the receiver says.
pub fn write_polygons(
    drawing: &Drawing,
    tolerance: f64,
    rounding: Rounding,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let mut text: Vec<u8> = Vec::new();
    let quoted = |text: &str| Value::from(text).to_string();
    text.extend_from_slice(b"{");
    if let Some(name) = &drawing.name {
        text.extend_from_slice(format!("\"name\":{},", quoted(name)).as_bytes());
    }
    if let Some(units) = &drawing.units {
        text.extend_from_slice(format!("\"units\":{},", quoted(units)).as_bytes());
    }
    let axis = if drawing.y_down { "down" } else { "up" };
    text.extend_from_slice(format!("\"y_axis\":\"{axis}\",").as_bytes());
    if let Some(canvas) = drawing.canvas {
        text.extend_from_slice(b"\"canvas\":");
        rounding.list(&canvas, &mut text);
        text.push(b',');
    }
    text.extend_from_slice(b"\"polygons\":[");
    let mut first = true;
    for (number, part) in drawing.parts.iter().enumerate() {
        for Polygon { outer, holes } in part.polygons(tolerance) {
            if !core::mem::take(&mut first) {
                text.push(b',');
            }
            text.extend_from_slice(b"{");
            if let Some(id) = &part.id {
                text.extend_from_slice(format!("\"id\":{},", quoted(id)).as_bytes());
            }
            let name = quoted(&part.name);
            let rule = part.rule.name();
            let head = format!("\"name\":{name},\"part\":{number},\"fill_rule\":\"{rule}\",");
            text.extend_from_slice(head.as_bytes());
            text.extend_from_slice(b"\"fill\":");
            match part.fill {
                Some(fill) => Rounding::places(4).list(&fill, &mut text),
                None => text.extend_from_slice(b"null"),
            }
            text.extend_from_slice(b",\"outer\":");
            rounding.points(&outer, &mut text);
            text.extend_from_slice(b",\"holes\":[");
            for (i, hole) in holes.iter().enumerate() {
                if i > 0 {
                    text.push(b',');
                }
                rounding.points(hole, &mut text);
            }
            text.extend_from_slice(b"]}");
        }
    }
    text.extend_from_slice(b"]}\n");
    out.write_all(&text)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(bytes: &[u8]) -> ReadErrorKind {
        super::super::read(bytes).unwrap_err().kind
    }

    #[test]
    fn geojson_of_every_depth_is_read() {
        let ring = "[[0,0],[4,0],[4,4],[0,4],[0,0]]";
        let hole = "[[1,1],[1,2],[2,2],[1,1]]";
        let feature = format!(
            r#"{{"type":"Feature","id":7,"properties":{{"name":"One"}},"geometry":{{"type":"Polygon","coordinates":[{ring},{hole}]}}}}"#
        );
        let one = read_geojson(feature.as_bytes()).unwrap();
        assert_eq!(one.name.as_deref(), Some("One"));
        assert!(!one.y_down);
        let part = &one.parts[0];
        assert_eq!((part.id.as_deref(), part.contours.len()), (Some("7"), 2));
        assert_eq!(part.contours[0].flatten(1.0).len(), 4);

        let all = format!(
            r#"{{"type":"FeatureCollection","features":[{feature},{{"type":"Feature","properties":null,"geometry":{{"type":"GeometryCollection","geometries":[{{"type":"MultiPolygon","coordinates":[[{ring}],[{hole}]]}},{{"type":"Point","coordinates":[0,0]}}]}}}}]}}"#
        );
        let all = super::super::read(all.as_bytes()).unwrap();
        assert_eq!(all.parts.len(), 3);
        assert_eq!(all.parts[2].id, None);
        assert_eq!(all.notes, ["1 geometry without an inside is left out"]);
    }

    #[test]
    fn damaged_files_say_what_and_where() {
        let mut deep = r#"{"type":"Point"}"#.to_owned();
        for _ in 0..40 {
            deep = format!(r#"{{"type":"GeometryCollection","geometries":[{deep}]}}"#);
        }
        assert_eq!(kind(deep.as_bytes()), ReadErrorKind::TooLarge);
        for (text, expected, says) in [
            (r#"{"polygons": []}"#, ReadErrorKind::NoPath, "no polygon"),
            (r#"{"polygons": [{}]}"#, ReadErrorKind::Shape, "polygon 1"),
            (
                r#"{"polygons": [{"outer": [[0,0],[1,1]]}]}"#,
                ReadErrorKind::Shape,
                "2 points",
            ),
            (
                r#"{"polygons": [{"outer": [[0,0],[1,1],[2]]}]}"#,
                ReadErrorKind::Number,
                "point 3",
            ),
            (
                r#"{"polygons": [{"outer": [[0,0],[1,1],[2,null]]}]}"#,
                ReadErrorKind::Number,
                "point 3",
            ),
            (
                r#"{"polygons": [{"outer": [[0,0],[1,1],[1e999,0]]}]}"#,
                ReadErrorKind::Syntax,
                "line 1",
            ),
            (
                r#"{"y_axis":"left","polygons": [{"outer": [[0,0],[1,1],[1,0]]}]}"#,
                ReadErrorKind::Unsupported,
                "y_axis",
            ),
            (
                r#"{"polygons": [{"fill":[2,0,0],"outer": [[0,0],[1,1],[1,0]]}]}"#,
                ReadErrorKind::Number,
                "fill",
            ),
            (
                r#"{"type":"Feature","geometry":{"type":"Polygon","coordinates":3}}"#,
                ReadErrorKind::Shape,
                "coordinates",
            ),
            (
                r#"{"type":"Feature","geometry":{"type":"Point","coordinates":[1,2]}}"#,
                ReadErrorKind::NoPath,
                "no polygon",
            ),
            (
                r#"{"points": [[0,0]]}"#,
                ReadErrorKind::UnknownFormat,
                "polygons",
            ),
        ] {
            let error = super::super::read(text.as_bytes()).unwrap_err();
            assert_eq!(error.kind, expected, "{text}: {error}");
            assert!(error.to_string().contains(says), "{text}: {error}");
        }
    }

    #[test]
    fn what_is_written_is_read_back() {
        let square = |x: f64, y: f64, side: f64| {
            vec![
                dvec2(x, y),
                dvec2(x + side, y),
                dvec2(x + side, y + side),
                dvec2(x, y + side),
            ]
        };
        let mut frame = Part::of_rings(
            "frame \"a\"",
            Some([0.25, 0.5, 1.0, 0.75]),
            [
                square(0.0, 0.0, 10.0),
                square(2.0, 2.0, 6.0),
                square(20.0, 0.0, 1.0),
            ],
        );
        frame.rule = Rule::EvenOdd;
        frame.id = Some("f".to_owned());
        let dot = Part::of_rings("dot", None, [square(1.0 / 3.0, 0.0, 1.0)]);
        let drawing = Drawing {
            name: Some("test".to_owned()),
            units: Some("mm".to_owned()),
            parts: vec![frame, dot],
            canvas: Some([0.0, 0.0, 21.0, 10.0]),
            y_down: false,
            notes: Vec::new(),
        };
        let mut file = Vec::new();
        write_polygons(&drawing, 0.1, Rounding::places(4), &mut file).unwrap();
        let read = read_polygons(&file).unwrap();
        let (one, other) = (&read.parts[0], &drawing.parts[0]);
        assert_eq!(
            (&one.id, &one.name, one.fill, one.rule),
            (&other.id, &other.name, other.fill, other.rule)
        );
        assert_eq!(one.contours.len(), 3);
        assert_eq!(read.parts[1].fill, None);
        assert_eq!(read.parts[1].contours[0].start, dvec2(0.3333, 0.0));
        assert_eq!(
            (read.canvas, read.y_down, read.units),
            (drawing.canvas, false, drawing.units)
        );
        // Written again, the same bytes.
        let mut again = Vec::new();
        let read = read_polygons(&file).unwrap();
        write_polygons(&read, 0.1, Rounding::places(4), &mut again).unwrap();
        assert_eq!(file, again);
        let value: Value = serde_json::from_slice(&file).unwrap();
        assert_eq!(value["polygons"].as_array().unwrap().len(), 3);
        assert_eq!(value["polygons"][0]["holes"].as_array().unwrap().len(), 1);
    }
}
