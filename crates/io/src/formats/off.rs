//! OFF, the object file format of Geomview: text with counts, points and polygons.
//!
//! *Source*: *Geomview Manual*, version 1.9, "OFF Files", The Geometry Center, 2007. The header may ask for texture
//! coordinates, colours and normals of the points (`STCNOFF` in any selection, the letters in this order), which stand
//! behind the coordinates as normal, colour, texture. Where files differ from the manual:
//!
//! - Colours may be written as 0 to 255; if any number of them is above 1, all are read so.
//! - Each point and each face stands on a line of its own.
//! - Faces of two corners are lines, of one corner points.
//!
//! Comments, colours of faces, blanks and line ends are kept. The binary form, and points of other dimensions (`4OFF`,
//! `nOFF`), are refused by name.

mod create;

pub(crate) use create::create;

use crate::elements::{self, Elements};
use crate::faces::NONE;
use crate::inspect::First;
use crate::normals::{per_vertex, same};
use crate::patch::Patch;
use crate::text::{self, excerpt};
use crate::{
    Document, Format, Geometry, Inspection, Mesh, Moved, Normals, Points, ReadError, ReadErrorKind,
    ReadOptions, Recognition, Values, WriteError, WriteReport, number,
};
use anamorph_core::glam::{DVec2, DVec3};
use core::ops::Range;
use std::io::Write;

/// The format.
pub(crate) struct Off;

/// What the points hold besides their place.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Kind {
    texture: bool,
    colour: bool,
    normal: bool,
}

impl Kind {
    /// The kind that a keyword names, with whether it is of another dimension.
    fn named(word: &[u8]) -> Option<(Self, bool)> {
        let mut rest = word.strip_suffix(b"OFF")?;
        let mut take = |prefix: &[u8]| match rest.strip_prefix(prefix) {
            Some(behind) => {
                rest = behind;
                true
            }
            None => false,
        };
        let kind = Self {
            texture: take(b"ST"),
            colour: take(b"C"),
            normal: take(b"N"),
        };
        let other = take(b"4") | take(b"n");
        rest.is_empty().then_some((kind, other))
    }
}

/// A read file.
struct Text {
    bytes: Vec<u8>,
    kind: Kind,
    /// Where the lines of points begin and end, and those of faces begin.
    vertices: Range<usize>,
    face_count: u64,
    positions: Vec<DVec3>,
    nonfinite: Vec<usize>,
    /// How many numbers the colour of a point has.
    channels: usize,
}

/// The lines that hold something, from byte `at`: their tokens' places, without comments.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
    tokens: Vec<Range<usize>>,
}

impl<'a> Lines<'a> {
    fn new(bytes: &'a [u8], at: usize) -> Self {
        Self {
            bytes,
            at,
            tokens: Vec::new(),
        }
    }

    /// The tokens of the next line that has any, at most `most` of them.
    fn next(&mut self, most: usize) -> Option<&[Range<usize>]> {
        self.tokens.clear();
        let bytes = self.bytes;
        while self.at < bytes.len() {
            let rest = &bytes[self.at..];
            let end = self.at + memchr::memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
            let content = memchr::memchr(b'#', &bytes[self.at..end]).map_or(end, |c| self.at + c);
            let mut at = self.at;
            while self.tokens.len() < most {
                while at < content && bytes[at].is_ascii_whitespace() {
                    at += 1;
                }
                let start = at;
                while at < content && !bytes[at].is_ascii_whitespace() {
                    at += 1;
                }
                if at == start {
                    break;
                }
                self.tokens.push(start..at);
            }
            self.at = (end + 1).min(bytes.len());
            if !self.tokens.is_empty() {
                return Some(&self.tokens);
            }
        }
        None
    }
}

impl Format for Off {
    fn name(&self) -> &'static str {
        "off"
    }
    fn title(&self) -> &'static str {
        "OFF, Geomview object file"
    }
    fn extensions(&self) -> &'static [&'static str] {
        &["off"]
    }
    fn recognises(&self, head: &[u8]) -> Recognition {
        let head = head.strip_prefix(text::BYTE_ORDER_MARK).unwrap_or(head);
        let mut lines = Lines::new(head, 0);
        match lines.next(1) {
            Some([word]) if Kind::named(&head[word.clone()]).is_some() => Recognition::Certain,
            _ => Recognition::No,
        }
    }
    fn read(&self, bytes: Vec<u8>, options: &ReadOptions) -> Result<Box<dyn Document>, ReadError> {
        Ok(Box::new(read(bytes, options)?))
    }
}

fn fail(
    bytes: &[u8],
    at: usize,
    kind: ReadErrorKind,
    what: impl Into<String>,
    mend: &str,
) -> ReadError {
    ReadError::new(kind, what, mend).at(bytes, at)
}

/// The file ends before it should.
fn cut(bytes: &[u8], what: &str) -> ReadError {
    fail(
        bytes,
        bytes.len(),
        ReadErrorKind::Truncated,
        format!("the file ends before {what}"),
        "the file is cut off, or its counts are wrong",
    )
}

/// A whole number that fits.
fn whole(bytes: &[u8], token: &Range<usize>) -> Option<u64> {
    core::str::from_utf8(&bytes[token.clone()])
        .ok()?
        .parse()
        .ok()
}

/// The kind and the counts of points and faces, and where the points begin.
fn header(bytes: &[u8]) -> Result<(Kind, [u64; 2], usize), ReadError> {
    let start = if bytes.starts_with(text::BYTE_ORDER_MARK) {
        3
    } else {
        0
    };
    let mut lines = Lines::new(bytes, start);
    let Some(first) = lines.next(8) else {
        return Err(ReadError::new(
            ReadErrorKind::NoPoints,
            "there is nothing in it",
            "give an OFF file with a line `OFF`, one with the counts, and points",
        ));
    };
    let mut tokens: Vec<Range<usize>> = first.to_vec();
    let word = &bytes[tokens[0].clone()];
    let mut kind = Kind::default();
    if let Some((named, other)) = Kind::named(word) {
        let binary = tokens
            .get(1)
            .is_some_and(|t| &bytes[t.clone()] == b"BINARY");
        if other || binary {
            let what = if binary {
                "the file is binary OFF".to_owned()
            } else {
                format!("the file is {}, of another dimension than 3", excerpt(word))
            };
            return Err(fail(
                bytes,
                tokens[0].start,
                ReadErrorKind::Unsupported,
                what,
                "only the text form with three coordinates is read; export the model as OFF text or PLY",
            ));
        }
        kind = named;
        tokens.remove(0);
        if tokens.is_empty() {
            tokens = lines
                .next(8)
                .ok_or_else(|| cut(bytes, "its counts"))?
                .to_vec();
        }
    } else if number::parse(word).is_none() {
        return Err(text::encoding_error(bytes, "OFF").unwrap_or_else(|| {
            fail(
                bytes,
                tokens[0].start,
                ReadErrorKind::Header,
                format!("the file begins with \"{}\"", excerpt(word)),
                "it must begin with `OFF`, or `COFF`, `NOFF`, `CNOFF`, `STOFF`",
            )
        }));
    }
    let count = |i: usize| tokens.get(i).and_then(|t| whole(bytes, t));
    let (Some(vertices), Some(faces)) = (count(0), count(1)) else {
        return Err(fail(
            bytes,
            tokens[0].start,
            ReadErrorKind::Header,
            "the counts of points and faces are missing",
            "write a line such as `8 6 12` behind `OFF`",
        ));
    };
    Ok((kind, [vertices, faces], lines.at))
}

fn read(bytes: Vec<u8>, options: &ReadOptions) -> Result<Text, ReadError> {
    if text::is_wide(&bytes)
        && let Some(error) = text::encoding_error(&bytes, "OFF")
    {
        return Err(error);
    }
    let (kind, [count, face_count], start) = header(&bytes)?;
    let room = (bytes.len() - start) as u64 / 2 + 1;
    if count.saturating_mul(3).saturating_add(face_count) > room {
        return Err(ReadError::new(
            ReadErrorKind::Truncated,
            format!(
                "the file announces {count} points and {face_count} faces, but only {} bytes follow",
                bytes.len() - start
            ),
            "the file is cut off, or its counts are wrong",
        ));
    }
    if count == 0 {
        return Err(ReadError::new(
            ReadErrorKind::NoPoints,
            "the file has no points",
            "check what was to write it",
        ));
    }
    if count >= u64::from(NONE) {
        return Err(ReadError::new(
            ReadErrorKind::TooLarge,
            format!("the file has {count} points"),
            "split it into parts",
        ));
    }
    let mut positions = Vec::with_capacity(count as usize);
    let mut nonfinite = Vec::new();
    let mut channels = None;
    let mut lines = Lines::new(&bytes, start);
    let fixed = 3 + 3 * usize::from(kind.normal) + 2 * usize::from(kind.texture);
    for v in 0..count as usize {
        let Some(tokens) = lines.next(MOST) else {
            return Err(cut(&bytes, &format!("point {} of {count}", v + 1)));
        };
        let colour = *channels.get_or_insert_with(|| {
            if kind.colour {
                tokens.len().saturating_sub(fixed).clamp(3, 4)
            } else {
                0
            }
        });
        let needed = fixed + colour;
        if tokens.len() < needed {
            return Err(fail(
                &bytes,
                tokens[0].start,
                ReadErrorKind::Shape,
                format!(
                    "point {} has {} numbers and needs {needed}",
                    v + 1,
                    tokens.len()
                ),
                "write each point on a line of its own, with the numbers that the header asks for",
            ));
        }
        let mut place = [0.0; 3];
        for (i, token) in tokens[..needed].iter().enumerate() {
            let Some(value) = number::parse(&bytes[token.clone()]) else {
                return Err(fail(
                    &bytes,
                    token.start,
                    ReadErrorKind::Number,
                    format!(
                        "point {} has \"{}\", which is not a number",
                        v + 1,
                        excerpt(&bytes[token.clone()])
                    ),
                    "write a number such as -1.5",
                ));
            };
            if i < 3 {
                place[i] = value;
            }
        }
        let place = DVec3::from_array(place);
        if !place.is_finite() {
            if !options.allow_nonfinite {
                return Err(fail(
                    &bytes,
                    tokens[0].start,
                    ReadErrorKind::NonFinite,
                    format!("point {} has a coordinate that is not finite", v + 1),
                    "correct it, or pass such points through untouched with --allow-nonfinite",
                ));
            }
            nonfinite.push(v);
        }
        positions.push(place);
    }
    let end = lines.at;
    let model = Text {
        kind,
        vertices: start..end,
        face_count,
        positions,
        nonfinite,
        channels: channels.unwrap_or(0),
        bytes,
    };
    model.elements(Some(options))?;
    Ok(model)
}

/// Tokens of a point that are looked at.
const MOST: usize = 16;

impl Text {
    /// The numbers of the points from token `first` on, as vectors of `N`.
    fn values<const N: usize>(&self, first: usize) -> Vec<[f64; N]> {
        let mut lines = Lines::new(&self.bytes, self.vertices.start);
        let mut all = Vec::with_capacity(self.positions.len());
        for _ in 0..self.positions.len() {
            let tokens = lines.next(MOST).unwrap_or(&[]);
            all.push(core::array::from_fn(|i| {
                let token = tokens.get(first + i).cloned().unwrap_or(0..0);
                number::parse(&self.bytes[token]).unwrap_or(0.0)
            }));
        }
        all
    }

    fn stored_normals(&self) -> Option<Vec<DVec3>> {
        self.kind
            .normal
            .then(|| self.values(3).into_iter().map(DVec3::from_array).collect())
    }

    fn moved_normals(&self, new: &[DVec3], policy: Normals<'_>) -> Option<(Vec<DVec3>, usize)> {
        let faces = || self.elements(None).unwrap_or_default().faces;
        let old = self.stored_normals()?;
        Some(per_vertex(old, &self.positions, new, faces, policy))
    }

    /// Where the colour and the texture coordinates begin among the numbers of a point.
    fn colour_at(&self) -> usize {
        3 + 3 * usize::from(self.kind.normal)
    }
    fn texture_at(&self) -> usize {
        self.colour_at() + self.channels
    }

    /// The elements; with options, the first that makes no sense is an error unless they let it pass.
    fn elements(&self, options: Option<&ReadOptions>) -> Result<Elements, ReadError> {
        let mut elements = Elements::default();
        let strict = options.is_some_and(|o| !o.allow_broken_elements);
        let mut lines = Lines::new(&self.bytes, self.vertices.end);
        let count = self.positions.len() as u64;
        let mut corners: Vec<u32> = Vec::new();
        for f in 0..self.face_count {
            let Some(tokens) = lines.next(usize::MAX) else {
                let what = format!("face {} of {}", f + 1, self.face_count);
                if options.is_some() {
                    return Err(cut(&self.bytes, &what));
                }
                break;
            };
            corners.clear();
            let shown = |token: &Range<usize>| excerpt(&self.bytes[token.clone()]);
            let n = whole(&self.bytes, &tokens[0]);
            let wrong = match n {
                Some(n) if n >= 1 && n < tokens.len() as u64 => {
                    tokens[1..=n as usize].iter().find_map(|token| {
                        match whole(&self.bytes, token).filter(|v| *v < count) {
                            Some(v) => {
                                corners.push(v as u32);
                                None
                            }
                            None => Some((
                                token.start,
                                format!(
                                    "face {} refers to point index {}, but indices run from 0 to {}",
                                    f + 1,
                                    shown(token),
                                    count - 1
                                ),
                            )),
                        }
                    })
                }
                Some(n) => Some((
                    tokens[0].start,
                    format!(
                        "face {} has {} corners on its line but says {n}",
                        f + 1,
                        tokens.len() - 1
                    ),
                )),
                None => Some((
                    tokens[0].start,
                    format!("face {} begins with \"{}\"", f + 1, shown(&tokens[0])),
                )),
            };
            if let Some((at, what)) = wrong {
                if strict {
                    return Err(fail(
                        &self.bytes,
                        at,
                        ReadErrorKind::Element,
                        what,
                        "a face is the number of its corners and their indices from 0, on a line of its own",
                    ));
                }
                elements.add_broken(|| what);
                continue;
            }
            match corners.as_slice() {
                [point] => elements.points.push(*point),
                [a, b] => elements.lines.push([*a, *b]),
                all => {
                    elements.faces.vertices.extend(all);
                    elements.faces.close();
                    elements.ordinals.push(f as u32);
                }
            }
        }
        Ok(elements)
    }

    /// The line of the `number`-th row from byte `at`.
    fn line(&self, at: usize, number: usize) -> Option<u64> {
        let mut lines = Lines::new(&self.bytes, at);
        for _ in 0..number {
            lines.next(1)?;
        }
        let start = lines.next(1)?.first()?.start;
        Some(text::place(&self.bytes, start).0)
    }
}

/// Names of the numbers of colours.
const COLOURS: [&str; 4] = ["red", "green", "blue", "alpha"];

impl Document for Text {
    fn format(&self) -> &'static str {
        Off.name()
    }
    fn points(&self) -> Points<'_> {
        Points::Solid(&self.positions)
    }
    fn nonfinite(&self) -> &[usize] {
        &self.nonfinite
    }
    fn normals(&self) -> usize {
        if self.kind.normal {
            self.positions.len()
        } else {
            0
        }
    }
    fn mesh(&self) -> Option<Mesh> {
        let elements = self.elements(None).ok()?;
        (self.face_count > 0).then(|| elements.mesh(&self.positions))
    }
    fn attributes(&self) -> Vec<String> {
        let colours = COLOURS[..self.channels].iter();
        let textures: &[&str] = if self.kind.texture { &["s", "t"] } else { &[] };
        colours.chain(textures).map(|s| (*s).to_owned()).collect()
    }
    fn attribute(&self, name: &str) -> Option<Vec<f64>> {
        let attributes = self.attributes();
        let place = attributes.iter().position(|known| known == name)?;
        if place >= self.channels {
            let at = self.texture_at() + place - self.channels;
            return Some(self.values::<1>(at).into_iter().map(|[v]| v).collect());
        }
        let all = self.values::<4>(self.colour_at());
        let mut channels = all.iter().flat_map(|c| &c[..self.channels]);
        let full = if channels.any(|c| *c > 1.0) {
            255.0
        } else {
            1.0
        };
        Some(all.iter().map(|c| c[place] / full).collect())
    }
    fn inspect(&self) -> Inspection {
        let found = self.elements(None).unwrap_or_default();
        let normals = self.stored_normals().unwrap_or_default();
        let subject = elements::Subject {
            format: self.format(),
            dimension: 3,
            points: &self.positions,
            nonfinite: &self.nonfinite,
            attributes: self.attributes(),
            counts: vec![("normals", normals.len() as u64)],
            nonfinite_normals: (0..normals.len())
                .filter(|&i| !normals[i].is_finite())
                .collect(),
        };
        let line = |first: First| match first {
            First::Vertex(v) => self.line(self.vertices.start, v),
            First::Face(f) | First::Edge(_, _, f) => self.line(self.vertices.end, f),
        };
        elements::inspect(subject, &found, |name| self.attribute(name), line)
    }
    fn geometry(&self, moved: &Moved<'_>) -> Result<Geometry, WriteError> {
        self.points().check(&moved.points)?;
        let new = moved.points.solid();
        let elements = self.elements(None).unwrap_or_default();
        let mut geometry = Geometry {
            points: new.to_vec(),
            ends: elements.faces.ends().to_vec(),
            corners: elements.faces.vertices,
            lines: elements.lines,
            loose: elements.points,
            ..Geometry::default()
        };
        geometry.take_attributes(self);
        if self.kind.texture {
            geometry.attributes.clear();
            let pairs = self.values::<2>(self.texture_at());
            geometry.textures = Values::Points(pairs.into_iter().map(DVec2::from_array).collect());
        }
        if let Some((normals, _)) = self.moved_normals(&new, moved.normals) {
            geometry.normals = Values::Points(normals);
        }
        Ok(geometry)
    }
    fn write(&self, moved: &Moved<'_>, out: &mut dyn Write) -> Result<WriteReport, WriteError> {
        self.points().check(&moved.points)?;
        let new = moved.points.solid();
        let mut report = WriteReport::default();
        let mut normals = None;
        if !matches!(moved.normals, Normals::Keep)
            && let Some((new, kept)) = self.moved_normals(&new, moved.normals)
        {
            normals = self.stored_normals().map(|old| (old, new));
            report.kept_normals = kept;
        }
        let mut patch = Patch::new(&self.bytes, out);
        let mut put = |tokens: &[Range<usize>], old: DVec3, new: DVec3| {
            if same(old, new) || !old.is_finite() {
                return Ok::<bool, WriteError>(false);
            }
            let values = old.to_array().into_iter().zip(new.to_array());
            for (token, (old, new)) in tokens.iter().zip(values) {
                if old.to_bits() != new.to_bits() {
                    number::write(new, patch.replace(token.start, token.end)?);
                }
            }
            Ok(true)
        };
        let mut lines = Lines::new(&self.bytes, self.vertices.start);
        for (v, (old, new)) in self.positions.iter().zip(new.iter()).enumerate() {
            let Some(tokens) = lines.next(MOST) else {
                break;
            };
            report.moved_points += usize::from(put(tokens, *old, *new)?);
            if let Some((old, new)) = &normals {
                report.changed_normals += usize::from(put(&tokens[3..], old[v], new[v])?);
            }
        }
        patch.finish(&mut report)?;
        Ok(report)
    }
}
