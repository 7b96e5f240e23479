//! Wavefront OBJ: text with vertices, polygons, lines and points.
//!
//! *Source*: Alias|Wavefront, *Advanced Visualizer Manual*, Appendix B1 "Object Files (.obj)", version 3.0, 1995. Where the
//! text is silent or files differ from it, we read as Blender does:
//!
//! - A fourth number `w` behind a vertex is, as the text has it, the weight of a rational curve's control point: the
//!   position is x, y, z as written. (Blender and tinyobjloader do the same; Assimp and `tobj` divide by it.) Three numbers
//!   behind a vertex are its colour. Both are attributes and keep their bytes.
//! - Faces may come before their vertices; relative (negative) indices count back from where they stand.
//! - The corners of a face may differ in whether they have a texture coordinate or normal.
//! - Keywords are lower case. Statements other than `v`, `vn`, `vt`, `f`, `l`, `p` are kept and not looked into; free-form
//!   curves and surfaces therefore follow their control points, but their normals are not rewritten.
//!
//! The text is cut into chunks at line ends, which are scanned and written independently. Only the positions and the
//! chunks' counts are kept beside the bytes; faces are checked while scanning and read again when someone asks for them.

mod check;
mod geometry;
mod inspect;
mod normals;
mod scan;
#[cfg(test)]
mod tests;
mod write;

pub(crate) use geometry::create;

use crate::faces::{Faces, NONE};
use crate::text;
use crate::{
    Document, Format, Geometry, Inspection, Mesh, Moved, Points, ReadError, ReadOptions,
    Recognition, WriteError, WriteReport,
};
use anamorph_core::glam::DVec3;
use core::ops::Range;
use scan::{Keyword, Reference, Statement, Statements, Tokens, resolve};
use std::io::Write;

/// The format.
pub(crate) struct Obj;

/// Bytes of text in a chunk: enough to make the cost of a chunk negligible, few enough that the chunks in flight do not
/// weigh against the file.
const CHUNK: usize = 1 << 20;

/// Vertices and normals are counted in 32 bits, of which the last value means "none".
const MOST: u64 = NONE as u64 - 1;

/// How many statements of which kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Counts {
    vertices: u64,
    normals: u64,
    textures: u64,
    faces: u64,
    lines: u64,
    points: u64,
}

impl Counts {
    fn count(&mut self, keyword: Keyword) {
        match keyword {
            Keyword::Vertex => self.vertices += 1,
            Keyword::Normal => self.normals += 1,
            Keyword::Texture => self.textures += 1,
            Keyword::Face => self.faces += 1,
            Keyword::Line => self.lines += 1,
            Keyword::Point => self.points += 1,
            Keyword::Other => {}
        }
    }
    fn plus(self, other: Self) -> Self {
        Self {
            vertices: self.vertices + other.vertices,
            normals: self.normals + other.normals,
            textures: self.textures + other.textures,
            faces: self.faces + other.faces,
            lines: self.lines + other.lines,
            points: self.points + other.points,
        }
    }
}

/// A run of whole statements.
struct Chunk {
    range: Range<usize>,
    /// What the chunks before it hold.
    before: Counts,
    /// What it holds itself.
    here: Counts,
}

/// A read file.
struct Text {
    bytes: Vec<u8>,
    chunks: Vec<Chunk>,
    totals: Counts,
    positions: Vec<DVec3>,
    nonfinite: Vec<usize>,
}

/// What scanning a chunk finds. Whether references are in range is known once all chunks are counted.
#[derive(Default)]
struct Scanned {
    here: Counts,
    positions: Vec<DVec3>,
    /// Indices within the chunk.
    nonfinite: Vec<usize>,
    /// The largest vertex index written.
    highest: i64,
    /// How many vertices before the chunk the relative indices reach for.
    deepest: u64,
    /// Something is malformed.
    broken: bool,
}

/// How many corners an element needs.
fn fewest(keyword: Keyword) -> usize {
    match keyword {
        Keyword::Face => 3,
        Keyword::Line => 2,
        _ => 1,
    }
}

/// The position that a vertex statement gives; `None` unless it has three numbers.
#[inline]
fn position(bytes: &[u8], statement: &Statement) -> Option<DVec3> {
    let mut tokens = Tokens::of(bytes, statement);
    let mut next = || tokens.number().and_then(|(value, _)| value);
    Some(DVec3::new(next()?, next()?, next()?))
}

/// Cuts the text behind `start` into ranges of whole statements, each of at least `chunk` bytes but for the last.
fn cut(bytes: &[u8], start: usize, chunk: usize) -> Vec<Range<usize>> {
    let mut ranges = Vec::new();
    let mut at = start;
    while at < bytes.len() {
        let mut end = at.saturating_add(chunk).min(bytes.len());
        loop {
            let Some(found) = memchr::memchr(b'\n', &bytes[end..]) else {
                end = bytes.len();
                break;
            };
            let feed = end + found;
            end = feed + 1;
            // A backslash may join the next line. In a comment it does not, but to cut elsewhere is never wrong.
            if !scan::ends_in_backslash(bytes, at, feed) {
                break;
            }
        }
        ranges.push(at..end);
        at = end;
    }
    ranges
}

fn scan_chunk(bytes: &[u8], range: Range<usize>) -> Scanned {
    let mut found = Scanned::default();
    for statement in Statements::new(bytes, range) {
        match statement.keyword {
            Keyword::Vertex => match position(bytes, &statement) {
                Some(position) => {
                    if !position.is_finite() {
                        found.nonfinite.push(found.positions.len());
                    }
                    found.positions.push(position);
                }
                None => found.broken = true,
            },
            Keyword::Face | Keyword::Line | Keyword::Point => {
                let mut corners = 0;
                for token in Tokens::of(bytes, &statement) {
                    corners += 1;
                    match Reference::parse(&bytes[token]) {
                        Some(Reference {
                            vertex: vertex @ 1..,
                            ..
                        }) => found.highest = found.highest.max(vertex),
                        Some(reference) => {
                            let reach = reference
                                .vertex
                                .unsigned_abs()
                                .saturating_sub(found.here.vertices);
                            found.deepest = found.deepest.max(reach);
                        }
                        None => found.broken = true,
                    }
                }
                found.broken |= corners < fewest(statement.keyword);
            }
            Keyword::Normal | Keyword::Texture | Keyword::Other => {}
        }
        found.here.count(statement.keyword);
    }
    found
}

impl Format for Obj {
    fn name(&self) -> &'static str {
        "obj"
    }
    fn title(&self) -> &'static str {
        "Wavefront OBJ"
    }
    fn extensions(&self) -> &'static [&'static str] {
        &["obj"]
    }

    fn recognises(&self, head: &[u8]) -> Recognition {
        const OTHERS: [&[u8]; 14] = [
            b"o",
            b"g",
            b"s",
            b"mg",
            b"mtllib",
            b"usemtl",
            b"usemap",
            b"vp",
            b"cstype",
            b"deg",
            b"lod",
            b"bevel",
            b"maplib",
            b"c_interp",
        ];
        let head = head.strip_prefix(text::BYTE_ORDER_MARK).unwrap_or(head);
        let mut recognition = Recognition::No;
        for statement in Statements::new(head, 0..head.len()) {
            match statement.keyword {
                Keyword::Vertex => {
                    // The head may be cut within a number, but not so that nothing is left of it.
                    let numbers = Tokens::of(head, &statement).take(3).filter(|t| {
                        crate::number::parse(&head[t.clone()]).is_some() || t.end == head.len()
                    });
                    let complete = numbers.count() == 3;
                    return if complete {
                        Recognition::Certain
                    } else {
                        recognition
                    };
                }
                Keyword::Other => {
                    let whole = Statement {
                        arguments: statement.start,
                        ..statement
                    };
                    match Tokens::of(head, &whole).next() {
                        None => {}
                        Some(token) if OTHERS.contains(&&head[token.clone()]) => {
                            recognition = Recognition::Possible;
                        }
                        Some(_) => return recognition,
                    }
                }
                _ => recognition = Recognition::Possible,
            }
        }
        recognition
    }

    fn read(&self, bytes: Vec<u8>, options: &ReadOptions) -> Result<Box<dyn Document>, ReadError> {
        Ok(Box::new(read(bytes, options, CHUNK)?))
    }
}

/// Reads a file in chunks of about `chunk` bytes.
fn read(bytes: Vec<u8>, options: &ReadOptions, chunk: usize) -> Result<Text, ReadError> {
    if text::is_wide(&bytes)
        && let Some(error) = text::encoding_error(&bytes, "OBJ")
    {
        return Err(error);
    }
    let start = if bytes.starts_with(text::BYTE_ORDER_MARK) {
        text::BYTE_ORDER_MARK.len()
    } else {
        0
    };
    let ranges = cut(&bytes, start, chunk);
    let scanned = text::map(&ranges, |range| scan_chunk(&bytes, range.clone()));

    let totals = scanned
        .iter()
        .fold(Counts::default(), |sum, chunk| sum.plus(chunk.here));
    let mut suspicious = totals.vertices == 0 || totals.vertices > MOST || totals.normals > MOST;
    let mut before = Counts::default();
    for chunk in &scanned {
        let out_of_range =
            chunk.highest as u64 > totals.vertices || chunk.deepest > before.vertices;
        suspicious |=
            chunk.broken || out_of_range || !chunk.nonfinite.is_empty() && !options.allow_nonfinite;
        before = before.plus(chunk.here);
    }
    // Old Macintosh text: everything would be a single statement.
    let one_line = memchr::memchr(b'\n', &bytes).is_none();
    suspicious |= one_line && memchr::memchr(b'\r', bytes.trim_ascii_end()).is_some();
    if suspicious {
        check::first_error(&bytes, start, totals, options)?;
    }

    let mut document = Text {
        chunks: Vec::with_capacity(ranges.len()),
        totals,
        positions: Vec::with_capacity(totals.vertices as usize),
        nonfinite: Vec::new(),
        bytes,
    };
    let mut before = Counts::default();
    for (range, chunk) in ranges.into_iter().zip(scanned) {
        let first = document.positions.len();
        document
            .nonfinite
            .extend(chunk.nonfinite.iter().map(|i| first + i));
        document.positions.extend_from_slice(&chunk.positions);
        document.chunks.push(Chunk {
            range,
            before,
            here: chunk.here,
        });
        before = before.plus(chunk.here);
    }
    Ok(document)
}

/// The elements of a chunk that make sense.
#[derive(Default)]
struct Elements {
    faces: Faces,
    lines: Vec<[u32; 2]>,
    points: Vec<u32>,
}

impl Text {
    fn statements(&self, chunk: &Chunk) -> Statements<'_> {
        Statements::new(&self.bytes, chunk.range.clone())
    }

    /// The vertex that a reference means, if it exists.
    #[inline]
    fn vertex(&self, reference: Reference, before: Counts) -> Option<u32> {
        resolve(reference.vertex, before.vertices)
            .filter(|v| *v < self.totals.vertices)
            .map(|v| v as u32)
    }
    /// The normal that a reference means, if it has one and it exists.
    #[inline]
    fn normal(&self, reference: Reference, before: Counts) -> Option<u32> {
        resolve(reference.normal, before.normals)
            .filter(|n| *n < self.totals.normals)
            .map(|n| n as u32)
    }

    fn elements_of(&self, chunk: &Chunk, with_normals: bool) -> Elements {
        let mut elements = Elements::default();
        let mut before = chunk.before;
        let mut corners = Vec::new();
        for statement in self.statements(chunk) {
            if matches!(
                statement.keyword,
                Keyword::Face | Keyword::Line | Keyword::Point
            ) {
                corners.clear();
                let mut sound = true;
                for token in Tokens::of(&self.bytes, &statement) {
                    let reference = Reference::parse(&self.bytes[token]);
                    match reference.and_then(|r| Some((self.vertex(r, before)?, r))) {
                        Some((vertex, reference)) => {
                            let normal = if with_normals {
                                self.normal(reference, before)
                            } else {
                                None
                            };
                            corners.push((vertex, normal.unwrap_or(NONE)));
                        }
                        None => sound = false,
                    }
                }
                if !sound || corners.len() < fewest(statement.keyword) {
                    // Left out of the mesh.
                } else if statement.keyword == Keyword::Face {
                    elements.faces.vertices.extend(corners.iter().map(|c| c.0));
                    if with_normals {
                        elements.faces.normals.extend(corners.iter().map(|c| c.1));
                    }
                    elements.faces.close();
                } else if statement.keyword == Keyword::Line {
                    elements
                        .lines
                        .extend(corners.windows(2).map(|pair| [pair[0].0, pair[1].0]));
                } else {
                    elements.points.extend(corners.iter().map(|c| c.0));
                }
            }
            before.count(statement.keyword);
        }
        elements
    }

    /// All elements that make sense, in file order.
    fn elements(&self, with_normals: bool) -> Elements {
        let parts = text::map(&self.chunks, |chunk| self.elements_of(chunk, with_normals));
        let mut faces = Vec::with_capacity(parts.len());
        let mut all = Elements::default();
        for part in parts {
            faces.push(part.faces);
            all.lines.extend(part.lines);
            all.points.extend(part.points);
        }
        all.faces = Faces::concatenate(faces);
        all
    }

    /// The numbers behind the coordinates of a vertex, as far as they are numbers.
    fn extras(&self, statement: &Statement) -> impl Iterator<Item = f64> {
        let mut tokens = Tokens::of(&self.bytes, statement);
        core::iter::from_fn(move || tokens.number()?.0).skip(3)
    }

    fn vertex_statements(&self) -> impl Iterator<Item = Statement> {
        let chunks = self.chunks.iter().filter(|chunk| chunk.here.vertices > 0);
        chunks
            .flat_map(|chunk| self.statements(chunk))
            .filter(|s| s.keyword == Keyword::Vertex)
    }
}

/// Names of what may stand behind the coordinates, and where: the weight alone, or a colour.
const COLOURS: [&str; 3] = ["red", "green", "blue"];
const WEIGHT: &str = "w";

impl Document for Text {
    fn format(&self) -> &'static str {
        Obj.name()
    }
    fn points(&self) -> Points<'_> {
        Points::Solid(&self.positions)
    }
    fn nonfinite(&self) -> &[usize] {
        &self.nonfinite
    }
    fn normals(&self) -> usize {
        self.totals.normals as usize
    }

    fn mesh(&self) -> Option<Mesh> {
        if self.totals.faces + self.totals.lines + self.totals.points == 0 {
            return None;
        }
        let elements = self.elements(false);
        Some(Mesh {
            triangles: elements.faces.triangles(&self.positions),
            faces: elements.faces.len(),
            lines: elements.lines,
            points: elements.points,
        })
    }

    fn attributes(&self) -> Vec<String> {
        let (mut weights, mut colours) = (true, true);
        for statement in self.vertex_statements() {
            let extras = self.extras(&statement).take(3).count();
            weights &= extras == 1;
            colours &= extras == 3;
            if !weights && !colours {
                return Vec::new();
            }
        }
        if colours {
            COLOURS.map(String::from).to_vec()
        } else {
            vec![WEIGHT.to_string()]
        }
    }

    fn attribute(&self, name: &str) -> Option<Vec<f64>> {
        if !self.attributes().iter().any(|known| known == name) {
            return None;
        }
        let place = COLOURS
            .iter()
            .position(|colour| *colour == name)
            .unwrap_or(0);
        self.vertex_statements()
            .map(|statement| self.extras(&statement).nth(place))
            .collect()
    }

    fn inspect(&self) -> Inspection {
        inspect::inspect(self)
    }

    fn geometry(&self, moved: &Moved<'_>) -> Result<Geometry, WriteError> {
        geometry::geometry(self, moved)
    }

    fn write(&self, moved: &Moved<'_>, out: &mut dyn Write) -> Result<WriteReport, WriteError> {
        write::write(self, moved, out)
    }
}
