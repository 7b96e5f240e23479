//! STL, the format of stereolithography: triangles, each with its three corners and a normal, as text or binary.
//!
//! *Source*: 3D Systems, *Stereolithography Interface Specification*, 1988. Where files differ from it:
//!
//! - The file says nowhere that two triangles share a corner. Corners at the same place (0 and −0 are the same) are one
//!   point, in the order of their first appearance, so that they move together.
//! - A binary file is told by its length, 84 bytes and 50 for each triangle: its header may well begin with `solid`.
//! - The normal is that of the triangle. Where a triangle has moved it is computed again, whatever was stored; one of
//!   (0, 0, 0), by which writers leave it to the reader, stays.
//!
//! The header, the two attribute bytes of a triangle, names of solids and the way that text is set out are kept.

mod ascii;

use crate::elements::{self, Elements};
use crate::inspect::First;
use crate::normals::{same, unit_normal};
use crate::patch::{Patch, flush};
use crate::text;
use crate::{
    Document, Format, Geometry, Inspection, Lost, Mesh, Moved, Normals, Points, ReadError,
    ReadErrorKind, ReadOptions, Recognition, WriteError, WriteReport, number,
};
use anamorph_core::glam::DVec3;
use core::ops::Range;
use std::collections::HashMap;
use std::io::Write;

/// The format.
pub(crate) struct Stl;

/// Bytes before the number of triangles, before the triangles, and of a triangle.
const HEADER: usize = 80;
const START: usize = HEADER + 4;
const FACET: usize = 50;

/// A read file.
struct Soup {
    bytes: Vec<u8>,
    ascii: bool,
    /// The places of the corners, each once.
    positions: Vec<DVec3>,
    /// Point of each corner.
    corners: Vec<[u32; 3]>,
    nonfinite: Vec<usize>,
}

/// The number of triangles that the header of a binary file announces.
fn announced(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(HEADER..START)?.first_chunk::<4>()?;
    Some(u64::from(u32::from_le_bytes(*count)))
}

/// The length of a binary file by its header.
fn whole_length(bytes: &[u8]) -> Option<u64> {
    Some(announced(bytes)? * FACET as u64 + START as u64)
}

/// Three 32-bit numbers, and as many bytes as they take.
fn vector(bytes: &[u8]) -> DVec3 {
    let value = |i: usize| {
        let chunk = bytes.get(4 * i..).and_then(<[u8]>::first_chunk::<4>);
        f64::from(f32::from_le_bytes(chunk.copied().unwrap_or_default()))
    };
    DVec3::new(value(0), value(1), value(2))
}

/// Whether triangles at the beginning of a file are plausible: finite, with normals of unit length or none.
fn plausible(head: &[u8]) -> bool {
    head.get(START..).is_some_and(|body| {
        let mut facets = body.chunks_exact(FACET).take(256).peekable();
        facets.peek().is_some()
            && facets.all(|facet| {
                let length = vector(facet).length();
                let sound = (0.5..2.0).contains(&length) || length < 1e-6;
                sound && (1..4).all(|i| vector(&facet[12 * i..]).is_finite())
            })
    })
}

impl Format for Stl {
    fn name(&self) -> &'static str {
        "stl"
    }
    fn title(&self) -> &'static str {
        "STL, stereolithography"
    }
    fn extensions(&self) -> &'static [&'static str] {
        &["stl"]
    }
    fn recognises(&self, head: &[u8]) -> Recognition {
        // A head of this length may be cut off.
        const CUT: u64 = 1 << 16;
        let length = head.len() as u64;
        let binary = whole_length(head).is_some_and(|whole| {
            whole == length && whole > START as u64
                || length == CUT && whole > length && plausible(head)
        });
        if binary {
            return Recognition::Certain;
        }
        match ascii::begins(head) {
            true => Recognition::Certain,
            false => Recognition::No,
        }
    }
    fn read(&self, bytes: Vec<u8>, options: &ReadOptions) -> Result<Box<dyn Document>, ReadError> {
        Ok(Box::new(read(bytes, options)?))
    }
}

/// Finds the points of corners.
#[derive(Default)]
struct Joiner {
    known: HashMap<[u64; 3], u32>,
    positions: Vec<DVec3>,
    nonfinite: Vec<usize>,
}

impl Joiner {
    fn point(&mut self, place: DVec3) -> u32 {
        // Adding 0 turns −0 into 0.
        let key = place.to_array().map(|c| (c + 0.0).to_bits());
        let next = self.positions.len();
        *self.known.entry(key).or_insert_with(|| {
            self.positions.push(place);
            if !place.is_finite() {
                self.nonfinite.push(next);
            }
            next as u32
        })
    }
}

fn read(bytes: Vec<u8>, options: &ReadOptions) -> Result<Soup, ReadError> {
    if text::is_wide(&bytes)
        && whole_length(&bytes) != Some(bytes.len() as u64)
        && let Some(error) = text::encoding_error(&bytes, "STL")
    {
        return Err(error);
    }
    if bytes.is_empty() {
        return Err(ReadError::new(
            ReadErrorKind::NoPoints,
            "the file is empty",
            "give an STL file with triangles",
        ));
    }
    // By its length; text that happens to have the right one would be a miracle.
    let binary = whole_length(&bytes) == Some(bytes.len() as u64);
    let ascii = !binary && (ascii::begins(&bytes) || ascii::is_text(&bytes));
    let mut joiner = Joiner::default();
    let corners = if ascii {
        ascii::read(&bytes, &mut joiner, options)?
    } else {
        read_binary(&bytes, &mut joiner, options)?
    };
    if corners.is_empty() {
        return Err(ReadError::new(
            ReadErrorKind::NoPoints,
            "the file has no triangles",
            "check what was to write it",
        ));
    }
    Ok(Soup {
        bytes,
        ascii,
        positions: joiner.positions,
        corners,
        nonfinite: joiner.nonfinite,
    })
}

fn read_binary(
    bytes: &[u8],
    joiner: &mut Joiner,
    options: &ReadOptions,
) -> Result<Vec<[u32; 3]>, ReadError> {
    let Some(count) = announced(bytes) else {
        return Err(ReadError::new(
            ReadErrorKind::Truncated,
            format!(
                "the file has {} bytes; the header alone takes {START}",
                bytes.len()
            ),
            "the file is cut off: get the whole file",
        ));
    };
    let body = &bytes[START..];
    let held = (body.len() / FACET) as u64;
    if held < count {
        return Err(ReadError::new(
            ReadErrorKind::Truncated,
            format!("the header announces {count} triangles, but only {held} follow"),
            "the file is cut off or no STL file: get the whole file",
        ));
    }
    let count = count as usize;
    let mut corners = Vec::with_capacity(count);
    for (f, facet) in body.chunks_exact(FACET).take(count).enumerate() {
        let places = [12, 24, 36].map(|at| vector(&facet[at..]));
        if !options.allow_nonfinite
            && let Some(corner) = places.iter().position(|p| !p.is_finite())
        {
            return Err(ReadError::new(
                ReadErrorKind::NonFinite,
                format!(
                    "corner {} of triangle {} (at byte {}) has a coordinate that is not finite",
                    corner + 1,
                    f + 1,
                    START + f * FACET + 12 * (corner + 1)
                ),
                NONFINITE,
            ));
        }
        corners.push(places.map(|place| joiner.point(place)));
    }
    Ok(corners)
}

/// How to mend what is not finite.
const NONFINITE: &str = "correct it, or pass such points through untouched with --allow-nonfinite";

/// What becomes of the normal of a triangle.
enum Facet {
    /// It stays.
    Keep,
    New(DVec3),
    /// It should be new, but the triangle has no area.
    Unusable,
}

impl Soup {
    fn elements(&self) -> Elements {
        let mut elements = Elements::default();
        for corners in &self.corners {
            elements.faces.vertices.extend(corners);
            elements.faces.close();
        }
        elements
    }

    /// The new normal of triangle `f`, which is stored as `old`.
    fn normal(&self, f: usize, old: DVec3, new: &[DVec3], policy: Normals<'_>) -> Facet {
        let corners = self.corners[f];
        let still = |&v: &u32| same(self.positions[v as usize], new[v as usize]);
        if matches!(policy, Normals::Keep)
            || old == DVec3::ZERO
            || !old.is_finite()
            || corners.iter().all(still)
        {
            return Facet::Keep;
        }
        unit_normal(&corners, new).map_or(Facet::Unusable, Facet::New)
    }

    fn stored_normals(&self) -> Vec<DVec3> {
        if self.ascii {
            return ascii::normals(&self.bytes);
        }
        let facets = self.bytes[START..].chunks_exact(FACET);
        facets.take(self.corners.len()).map(vector).collect()
    }

    fn write_binary(
        &self,
        new: &[DVec3],
        policy: Normals<'_>,
        report: &mut WriteReport,
        out: &mut dyn Write,
    ) -> Result<(), WriteError> {
        for (i, (old, new)) in self.positions.iter().zip(new).enumerate() {
            let large = |c: f64| c.is_finite() && !(c as f32).is_finite();
            if !same(*old, *new)
                && let Some(value) = new.to_array().into_iter().find(|c| large(*c))
            {
                return Err(WriteError::DoesNotFit {
                    what: format!(
                        "point {} moves to {value}, which is too large for the 32-bit numbers of STL",
                        i + 1
                    ),
                    mend: "scale the model down, or write it as PLY or OBJ",
                });
            }
        }
        let put = |old: DVec3, new: DVec3, bytes: &mut [u8]| {
            let values = old.to_array().into_iter().zip(new.to_array());
            for (slot, (old, new)) in bytes.chunks_exact_mut(4).zip(values) {
                if old.to_bits() != new.to_bits() {
                    slot.copy_from_slice(&(new as f32).to_le_bytes());
                }
            }
        };
        let mut buffer = self.bytes[..START].to_vec();
        let facets = self.bytes[START..].chunks_exact(FACET);
        for (f, (facet, corners)) in facets.zip(&self.corners).enumerate() {
            let start = buffer.len();
            buffer.extend_from_slice(facet);
            let facet = &mut buffer[start..];
            let old = vector(facet);
            match self.normal(f, old, new, policy) {
                Facet::New(normal) => {
                    // As it is written, else rounding alone would count.
                    let single = normal.as_vec3().as_dvec3();
                    report.changed_normals += usize::from(!same(single, old));
                    put(old, single, &mut facet[..12]);
                }
                Facet::Unusable => report.kept_normals += 1,
                Facet::Keep => {}
            }
            for (i, &v) in corners.iter().enumerate() {
                let (old, new) = (self.positions[v as usize], new[v as usize]);
                if old.is_finite() && !same(old, new) {
                    put(old, new, &mut facet[12 * (i + 1)..12 * (i + 2)]);
                }
            }
            flush(&mut buffer, out)?;
        }
        out.write_all(&buffer)?;
        out.write_all(&self.bytes[START + self.corners.len() * FACET..])?;
        report.bytes += self.bytes.len() as u64;
        Ok(())
    }

    fn write_ascii(
        &self,
        new: &[DVec3],
        policy: Normals<'_>,
        report: &mut WriteReport,
        out: &mut dyn Write,
    ) -> Result<(), WriteError> {
        let mut patch = Patch::new(&self.bytes, out);
        let mut put = |places: &[Range<usize>; 3], old: DVec3, new: DVec3| {
            let values = old.to_array().into_iter().zip(new.to_array());
            for (place, (old, new)) in places.iter().zip(values) {
                if old.to_bits() != new.to_bits() {
                    number::write(new, patch.replace(place.start, place.end)?);
                }
            }
            Ok::<(), WriteError>(())
        };
        for (f, facet) in ascii::Facets::new(&self.bytes)
            .map_while(Result::ok)
            .enumerate()
        {
            let Some(corners) = self.corners.get(f) else {
                break;
            };
            let old = facet.normal(&self.bytes);
            match self.normal(f, old, new, policy) {
                Facet::New(normal) => {
                    report.changed_normals += usize::from(!same(normal, old));
                    put(&facet.places[0], old, normal)?;
                }
                Facet::Unusable => report.kept_normals += 1,
                Facet::Keep => {}
            }
            for (places, &v) in facet.places[1..].iter().zip(corners) {
                let (old, new) = (self.positions[v as usize], new[v as usize]);
                if old.is_finite() && !same(old, new) {
                    put(places, old, new)?;
                }
            }
        }
        patch.finish(report)
    }
}

impl Document for Soup {
    fn format(&self) -> &'static str {
        Stl.name()
    }
    fn points(&self) -> Points<'_> {
        Points::Solid(&self.positions)
    }
    fn notes(&self) -> Vec<String> {
        let mut notes = vec![format!(
            "STL does not say which triangles share a corner: corners at the same place are one point ({} of {} corners); normals are those of the moved triangles",
            self.positions.len(),
            3 * self.corners.len()
        )];
        let rest = self
            .bytes
            .len()
            .saturating_sub(START + self.corners.len() * FACET);
        if !self.ascii && rest > 0 {
            notes.push(format!(
                "{rest} bytes follow the last triangle; they are kept"
            ));
        }
        notes
    }
    fn nonfinite(&self) -> &[usize] {
        &self.nonfinite
    }
    fn normals(&self) -> usize {
        self.corners.len()
    }
    fn mesh(&self) -> Option<Mesh> {
        Some(Mesh {
            triangles: self.corners.clone(),
            faces: self.corners.len(),
            ..Mesh::default()
        })
    }
    fn inspect(&self) -> Inspection {
        let bad = self.stored_normals();
        let subject = elements::Subject {
            format: self.format(),
            dimension: 3,
            points: &self.positions,
            nonfinite: &self.nonfinite,
            attributes: Vec::new(),
            counts: vec![("normals", self.corners.len() as u64)],
            nonfinite_normals: Vec::new(),
        };
        let line = |first: First| match first {
            First::Face(f) | First::Edge(_, _, f) if self.ascii => {
                let facet = ascii::Facets::new(&self.bytes).nth(f)?.ok()?;
                Some(text::place(&self.bytes, facet.places[0][0].start).0)
            }
            _ => None,
        };
        let mut inspection = elements::inspect(subject, &self.elements(), |_| None, line);
        let count = bad.iter().filter(|n| !n.is_finite()).count();
        if let Some(first) = bad.iter().position(|n| !n.is_finite()) {
            inspection.problems.push(crate::Problem {
                kind: crate::ProblemKind::NonFiniteNormal,
                count: count as u64,
                first: format!("the normal of triangle {}", first + 1),
                line: line(First::Face(first)),
            });
            inspection.problems.sort_by_key(|problem| problem.kind);
        }
        inspection
    }
    fn geometry(&self, moved: &Moved<'_>) -> Result<Geometry, WriteError> {
        self.points().check(&moved.points)?;
        let mut geometry = Geometry {
            points: moved.points.solid().to_vec(),
            ..Geometry::default()
        };
        for &corners in &self.corners {
            geometry.push_face(corners);
        }
        let attributes = |facet: &[u8]| facet[FACET - 2..] != [0, 0];
        let facets = || self.bytes[START..].chunks_exact(FACET);
        if !self.ascii && facets().take(self.corners.len()).any(attributes) {
            geometry.beyond.push("attribute bytes".to_owned());
        }
        Ok(geometry)
    }
    fn write(&self, moved: &Moved<'_>, out: &mut dyn Write) -> Result<WriteReport, WriteError> {
        self.points().check(&moved.points)?;
        let new = moved.points.solid();
        let mut report = WriteReport::default();
        let pairs = self.positions.iter().zip(new.iter());
        report.moved_points = pairs
            .filter(|(old, new)| old.is_finite() && !same(**old, **new))
            .count();
        if self.ascii {
            self.write_ascii(&new, moved.normals, &mut report, out)?;
        } else {
            self.write_binary(&new, moved.normals, &mut report, out)?;
        }
        Ok(report)
    }
}

/// Writes a new binary file; see [`crate::Target::create`].
pub(crate) fn create(geometry: &Geometry, out: &mut dyn Write) -> Result<Lost, WriteError> {
    let rounded = geometry.check_single("STL")?;
    let triangles = geometry.corner_triangles();
    let Ok(count) = u32::try_from(triangles.len()) else {
        return Err(WriteError::DoesNotFit {
            what: format!("STL cannot count {} triangles", triangles.len()),
            mend: "write the model as PLY or OBJ",
        });
    };
    if count == 0 {
        return Err(WriteError::DoesNotFit {
            what: "the model has no faces, and STL holds nothing else".to_owned(),
            mend: "write it as PLY, OBJ or CSV",
        });
    }
    let mut lost = Lost(geometry.beyond.clone());
    lost.add(geometry.has_polygons(), "polygons (cut into triangles)");
    lost.add(rounded, "digits beyond 32-bit numbers");
    lost.add(!geometry.normals.is_none(), "normals of points");
    lost.add(!geometry.textures.is_none(), "texture coordinates");
    lost.add(!geometry.colours.is_empty(), "colours");
    lost.add_attributes(geometry);
    lost.add(!geometry.lines.is_empty(), "lines");
    lost.add(!geometry.loose.is_empty(), "point elements");
    let mut used = vec![false; geometry.points.len()];
    for &point in &geometry.corners {
        used[point as usize] = true;
    }
    lost.add(used.contains(&false), "points without a face");

    let mut buffer = b"binary STL".to_vec();
    buffer.resize(HEADER, b' ');
    buffer.extend_from_slice(&count.to_le_bytes());
    for triangle in triangles {
        let points = triangle.map(|corner| geometry.corners[corner as usize]);
        let normal = unit_normal(&points, &geometry.points).unwrap_or(DVec3::ZERO);
        let places = points.map(|v| geometry.points[v as usize]);
        for vector in [normal, places[0], places[1], places[2]] {
            for value in vector.to_array() {
                buffer.extend_from_slice(&(value as f32).to_le_bytes());
            }
        }
        buffer.extend_from_slice(&[0, 0]);
        flush(&mut buffer, out)?;
    }
    out.write_all(&buffer)?;
    Ok(lost)
}
