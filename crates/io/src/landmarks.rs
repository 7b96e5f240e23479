//! Landmarks of images: named places on faces and other things, which features of warps are made of.
//!
//! Read are JSON (a list of `[x, y]`, or a table with such a list as `points`, as annotation tools write it) and the text form of the iBUG
//! group (`.pts`). Places are in pixels: x goes right, y goes down, and the outer corner of the first pixel is the origin. A plain table of
//! points (CSV) needs no reader of its own.
//!
//! Chains join places to lines: those that the file lists as `chains`, or those of the 68 places of a face.
//!
//! *Source*: C. Sagonas, G. Tzimiropoulos, S. Zafeiriou, M. Pantic, *300 Faces in-the-Wild Challenge*, ICCVW 2013 (the 68 places and the
//! text form).

use anamorph_core::glam::{DVec2, dvec2};
use serde_json::Value;

/// Most places of a file.
pub const MOST_LANDMARKS: usize = 1_000_000;

/// The chains of the 68 places of a face: first and last place, and whether it is closed.
const FACE: [(u32, u32, bool); 9] = [
    (0, 16, false),
    (17, 21, false),
    (22, 26, false),
    (27, 30, false),
    (31, 35, false),
    (36, 41, true),
    (42, 47, true),
    (48, 59, true),
    (60, 67, true),
];

/// What is wrong with a file of landmarks.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LandmarkError {
    /// Text that is not what it should be.
    #[error("{what}; {mend}")]
    Damaged {
        /// What is wrong, and where.
        what: String,
        /// How to mend it.
        mend: &'static str,
    },
    /// A place that is not two numbers.
    #[error("place {number} is not two finite numbers; write [x, y] in pixels")]
    Place {
        /// Its number, from 0.
        number: usize,
    },
    /// No place at all.
    #[error("there is no place; list some as [x, y]")]
    None,
    /// More than anybody places.
    #[error("there are {count} places, and at most {MOST_LANDMARKS} are read")]
    TooMany {
        /// How many.
        count: usize,
    },
    /// A chain that names a place that is not there.
    #[error("a chain names place {number} of {count}, counted from 0; correct the chain")]
    Chain {
        /// The place it names.
        number: String,
        /// How many there are.
        count: usize,
    },
}

/// Places on an image.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Landmarks {
    /// The places, in pixels.
    pub points: Vec<DVec2>,
    /// What they are called, one each; empty if the file does not say.
    pub names: Vec<String>,
    /// Width and height of the image, if the file says.
    pub size: Option<[f64; 2]>,
    /// Pairs of places that are joined, in the order of the chains.
    pub lines: Vec<[u32; 2]>,
}

impl Landmarks {
    /// Whether bytes are landmarks rather than a model: JSON that is a list or has `points`, or the text form with its count.
    #[must_use]
    pub fn are(bytes: &[u8]) -> bool {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let first = text.iter().find(|byte| !byte.is_ascii_whitespace());
        match first {
            Some(b'[') => true,
            Some(b'{') => {
                let value: Result<Value, _> = serde_json::from_slice(text);
                value.is_ok_and(|value| {
                    value.get("points").is_some() && value.get("asset").is_none()
                })
            }
            Some(b'v') => text.starts_with(b"version:"),
            _ => false,
        }
    }

    /// Reads landmarks, their form found by the content.
    ///
    /// # Errors
    /// [`LandmarkError`]: what is wrong, and how to mend it.
    pub fn read(bytes: &[u8]) -> Result<Self, LandmarkError> {
        let damaged = |what: String, mend| LandmarkError::Damaged { what, mend };
        let text = core::str::from_utf8(bytes).map_err(|error| {
            damaged(
                format!("byte {} is not UTF-8 text", error.valid_up_to()),
                "save the file as UTF-8",
            )
        })?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let read = if text.trim_start().starts_with(['[', '{']) {
            let value: Value = serde_json::from_str(text)
                .map_err(|error| damaged(format!("it is no JSON: {error}"), "correct the place"))?;
            Self::of_json(&value)?
        } else {
            Self::of_pts(text)?
        };
        match read.points.len() {
            0 => Err(LandmarkError::None),
            count if count > MOST_LANDMARKS => Err(LandmarkError::TooMany { count }),
            _ => Ok(read),
        }
    }

    fn of_json(value: &Value) -> Result<Self, LandmarkError> {
        let list = value.get("points").unwrap_or(value).as_array();
        let list = list.ok_or_else(|| LandmarkError::Damaged {
            what: "`points` is no list".to_owned(),
            mend: "write a list of [x, y]",
        })?;
        let place = |(number, place): (usize, &Value)| {
            let numbers = match place {
                Value::Array(list) if list.len() == 2 => (list[0].as_f64(), list[1].as_f64()),
                Value::Object(table) => {
                    let number = |key| table.get(key).and_then(Value::as_f64);
                    (number("x"), number("y"))
                }
                _ => (None, None),
            };
            let point = numbers.0.zip(numbers.1).map(|(x, y)| dvec2(x, y));
            let point = point.filter(|point| point.is_finite());
            point.ok_or(LandmarkError::Place { number })
        };
        let points: Vec<DVec2> = list
            .iter()
            .enumerate()
            .map(place)
            .collect::<Result<_, _>>()?;
        let names = value.get("names").and_then(Value::as_array);
        let names = names.map_or(Vec::new(), |names| {
            let text = |name: &Value| name.as_str().unwrap_or_default().to_owned();
            names.iter().map(text).collect()
        });
        let number = |key| value.get(key).and_then(Value::as_f64);
        let lines = match value.get("chains") {
            Some(chains) => listed(chains, points.len())?,
            None => face(points.len(), value.get("scheme").and_then(Value::as_str)),
        };
        Ok(Self {
            points,
            names,
            size: number("width").zip(number("height")).map(|(w, h)| [w, h]),
            lines,
        })
    }

    fn of_pts(text: &str) -> Result<Self, LandmarkError> {
        let damaged = |what: String| LandmarkError::Damaged {
            what,
            mend: "the form is `version: 1`, `n_points: 68`, and a place a line between { and }",
        };
        let mut count = None;
        let mut points = Vec::new();
        let mut inside = false;
        for (line, text) in text.lines().enumerate() {
            let text = text.trim();
            let wrong = || damaged(format!("line {}: {text:.40} is not understood", line + 1));
            match text {
                "{" if !inside => inside = true,
                "}" if inside => inside = false,
                "" => {}
                _ if text.starts_with("//") || text.starts_with('#') => {}
                _ if inside => {
                    let mut numbers = text.split_whitespace().map(str::parse::<f64>);
                    let (x, y) = (numbers.next(), numbers.next());
                    let (Some(Ok(x)), Some(Ok(y)), None) = (x, y, numbers.next()) else {
                        return Err(wrong());
                    };
                    let point = dvec2(x, y);
                    if !point.is_finite() {
                        let number = points.len();
                        return Err(LandmarkError::Place { number });
                    }
                    points.push(point);
                }
                _ => match text.split_once(':') {
                    Some(("version", _)) => {}
                    Some(("n_points", number)) => {
                        count = Some(number.trim().parse::<usize>().map_err(|_| wrong())?);
                    }
                    _ => return Err(wrong()),
                },
            }
        }
        if inside {
            return Err(damaged("the list of places does not end".to_owned()));
        }
        if let Some(count) = count.filter(|&count| count != points.len()) {
            let found = points.len();
            return Err(damaged(format!(
                "{count} places are announced, and {found} are there"
            )));
        }
        Ok(Self {
            lines: face(points.len(), None),
            points,
            ..Self::default()
        })
    }
}

/// The pairs of consecutive places of chains that a file lists: lists of numbers, in a list or by name. A chain is closed if its name ends in
/// `(closed)`.
fn listed(chains: &Value, count: usize) -> Result<Vec<[u32; 2]>, LandmarkError> {
    let named: Vec<(bool, &Value)> = match chains {
        Value::Array(list) => list.iter().map(|chain| (false, chain)).collect(),
        Value::Object(table) => {
            let each = table.iter();
            each.map(|(name, chain)| (name.trim_end().ends_with("(closed)"), chain))
                .collect()
        }
        _ => Vec::new(),
    };
    let mut lines = Vec::new();
    for (closed, chain) in named {
        let chain = chain.as_array().map_or(&[][..], Vec::as_slice);
        let numbers = chain.iter().map(|number| {
            let place = number
                .as_u64()
                .and_then(|number| u32::try_from(number).ok());
            let place = place.filter(|&place| (place as usize) < count);
            place.ok_or_else(|| LandmarkError::Chain {
                number: number.to_string(),
                count,
            })
        });
        let numbers: Vec<u32> = numbers.collect::<Result<_, _>>()?;
        lines.extend(numbers.windows(2).map(|pair| [pair[0], pair[1]]));
        if let (true, [first, _, .., last]) = (closed, numbers.as_slice()) {
            lines.push([*last, *first]);
        }
    }
    Ok(lines)
}

/// The lines of a face, if these are its 68 places.
fn face(count: usize, scheme: Option<&str>) -> Vec<[u32; 2]> {
    if count != 68 || scheme.is_some_and(|scheme| scheme != "ibug-68") {
        return Vec::new();
    }
    let mut lines = Vec::new();
    for (first, last, closed) in FACE {
        lines.extend((first..last).map(|place| [place, place + 1]));
        if closed {
            lines.push([last, first]);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_tables_are_read() {
        let list = Landmarks::read(b" [[1, 2], {\"x\": 3, \"y\": 4.5}]").unwrap();
        assert_eq!(list.points, [dvec2(1.0, 2.0), dvec2(3.0, 4.5)]);
        assert!(list.lines.is_empty() && list.size.is_none());
        let table = br#"{"width": 9, "height": 8, "points": [[0,0],[1,0],[1,1],[0,1]],
            "names": ["a","b","c","d"], "chains": {"box (closed)": [0,1,2], "edge": [2,3]}}"#;
        assert!(Landmarks::are(table) && Landmarks::are(b"[[1,2]]"));
        let table = Landmarks::read(table).unwrap();
        assert_eq!(table.size, Some([9.0, 8.0]));
        assert_eq!(table.lines, [[0, 1], [1, 2], [2, 0], [2, 3]]);
        assert_eq!(table.names[3], "d");
    }

    #[test]
    fn the_text_form_of_faces_has_lines() {
        let mut text = "version: 1\nn_points: 68\n{\n".to_owned();
        for i in 0..68 {
            text.push_str(&format!("{i}.5 {}\n", 2 * i));
        }
        text.push_str("}\n");
        assert!(Landmarks::are(text.as_bytes()));
        let face = Landmarks::read(text.as_bytes()).unwrap();
        assert_eq!(face.points[67], dvec2(67.5, 134.0));
        // 16 + 4 + 4 + 3 + 4 open and 6 + 6 + 12 + 8 closed.
        assert_eq!(face.lines.len(), 63);
        assert!(face.lines.contains(&[59, 48]) && !face.lines.contains(&[16, 17]));
    }

    #[test]
    fn damaged_files_say_what_and_where() {
        let error = |bytes: &[u8]| Landmarks::read(bytes).unwrap_err().to_string();
        assert!(error(b"[[1, 2], [3]]").contains("place 1"));
        assert!(error(b"[]").contains("no place"));
        assert!(error(b"{\"points\": 3}").contains("`points` is no list"));
        assert!(error(b"[[1, 2").contains("no JSON"));
        assert!(error(b"[[1,2]]\xff").contains("UTF-8"));
        assert!(error(b"{\"points\": [[1,2]], \"chains\": [[0, 1]]}").contains("place 1 of 1"));
        assert!(error(b"version: 1\nn_points: 3\n{\n1 2\n}\n").contains("3 places are announced"));
        assert!(error(b"version: 1\n{\n1 two\n}\n").contains("line 3"));
        assert!(error(b"version: 1\n{\n1 2\n").contains("does not end"));
        assert!(!Landmarks::are(b"{\"asset\": {}, \"points\": []}"));
        assert!(!Landmarks::are(b"v 1 2 3\n"));
    }
}
