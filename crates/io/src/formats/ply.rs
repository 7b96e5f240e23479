//! PLY, the Stanford polygon format: a text header that says which elements follow and what each consists of, then their
//! numbers as text or binary, of either byte order.
//!
//! *Source*: G. Turk, "The PLY Polygon File Format", Stanford University, 1994. Where the text is silent:
//!
//! - The points are the element `vertex` with the scalar properties `x`, `y` and `z`, or `x` and `y` alone for points in
//!   the plane. `nx`, `ny`, `nz` of a floating type are its normal; every other scalar is an attribute. Colours written as
//!   whole numbers are read as 0 to 1.
//! - Faces are the lists `vertex_indices` or `vertex_index` of the element `face`; `tristrips` and `edge` are read as well.
//!   Other elements and properties are kept and not looked into.
//! - In text each row stands on a line of its own; where a file breaks lines otherwise, its numbers must come out even.
//! - A moved coordinate of type `float` is rounded once to 32 bits. One of a whole type must be whole.

mod create;
mod header;
mod inspect;
mod lists;
mod rows;
mod scalar;
mod triple;
mod write;

pub(crate) use create::create;

use crate::elements::Elements;
use crate::faces::NONE;
use crate::normals::per_vertex;
use crate::text;
use crate::{
    Document, Format, Geometry, Inspection, Mesh, Moved, Normals, Points, ReadError, ReadErrorKind,
    ReadOptions, Recognition, Values, WriteError, WriteReport,
};
use anamorph_core::glam::{DVec2, DVec3};
use core::convert::Infallible;
use header::{Element, Encoding, Header};
use rows::{Row, Rows, Section, Spot, each, measure};
use scalar::{Order, Scalar};
use std::io::Write;
use triple::Triple;

/// The format.
pub(crate) struct Ply;

/// A scalar property: its number in the element, and its type.
type Column = (usize, Scalar);

/// How the rows of a binary element lie that are all alike.
#[derive(Clone, Copy)]
struct Strided<'a> {
    /// Bytes of a row.
    stride: usize,
    spots: &'a [Spot],
    order: Order,
}

/// Rows read together.
const RUN: usize = 1 << 15;

/// A read file.
struct Model {
    bytes: Vec<u8>,
    header: Header,
    sections: Vec<Section>,
    /// The number of the element `vertex`.
    vertex: usize,
    /// The columns of x, y and, in space, z.
    axes: Vec<Column>,
    normal: Option<[Column; 3]>,
    /// The positions, with z = 0 in the plane.
    positions: Vec<DVec3>,
    /// The same in the plane; empty in space.
    plane: Vec<DVec2>,
    nonfinite: Vec<usize>,
}

impl Format for Ply {
    fn name(&self) -> &'static str {
        "ply"
    }
    fn title(&self) -> &'static str {
        "PLY, Stanford polygon format"
    }
    fn extensions(&self) -> &'static [&'static str] {
        &["ply"]
    }
    fn recognises(&self, head: &[u8]) -> Recognition {
        if header::magic(head) {
            Recognition::Certain
        } else {
            Recognition::No
        }
    }
    fn read(&self, bytes: Vec<u8>, options: &ReadOptions) -> Result<Box<dyn Document>, ReadError> {
        Ok(Box::new(read(bytes, options)?))
    }
}

fn read(bytes: Vec<u8>, options: &ReadOptions) -> Result<Model, ReadError> {
    if text::is_wide(&bytes)
        && let Some(error) = text::encoding_error(&bytes, "PLY")
    {
        return Err(error);
    }
    let header = header::parse(&bytes)?;
    let (vertex, axes, normal) = columns(&bytes, &header)?;
    let sections = measure(&bytes, &header, header.elements[vertex].count)?;
    // Only once it is clear that they are there.
    let element = &header.elements[vertex];
    if element.count >= u64::from(NONE) {
        return Err(ReadError::new(
            ReadErrorKind::TooLarge,
            format!("the header announces {} vertices", element.count),
            format!("split the model into parts of at most {}", NONE - 1),
        )
        .at(&bytes, element.at));
    }
    let mut model = Model {
        bytes,
        header,
        sections,
        vertex,
        axes,
        normal,
        positions: Vec::new(),
        plane: Vec::new(),
        nonfinite: Vec::new(),
    };
    let axes: Vec<Option<Column>> = (0..3).map(|a| model.axes.get(a).copied()).collect();
    model.positions = model.vectors(&[axes[0], axes[1], axes[2]]);
    if model.axes.len() == 2 {
        model.plane = model.positions.iter().map(|p| p.truncate()).collect();
    }
    let runs = text::runs(model.positions.len(), RUN);
    let parts = text::map(&runs, |run| -> Vec<usize> {
        if triple::all_finite(&model.positions[run.clone()], |x| x) {
            return Vec::new();
        }
        run.clone()
            .filter(|&i| !model.positions[i].is_finite())
            .collect()
    });
    model.nonfinite = parts.concat();
    if let Some(&first) = model.nonfinite.first()
        && !options.allow_nonfinite
    {
        return Err(model.error(
            ReadErrorKind::NonFinite,
            model.vertex,
            first,
            "has a coordinate that is not finite",
            "correct it, or pass such points through untouched with --allow-nonfinite",
        ));
    }
    if !options.allow_broken_elements {
        model.check_elements()?;
    }
    Ok(model)
}

/// The element of the points, and its columns.
#[allow(clippy::type_complexity)]
fn columns(
    bytes: &[u8],
    header: &Header,
) -> Result<(usize, Vec<Column>, Option<[Column; 3]>), ReadError> {
    let vertex = header.elements.iter().position(|e| e.name == "vertex");
    let Some(vertex) = vertex.filter(|v| header.elements[*v].count > 0) else {
        return Err(ReadError::new(
            ReadErrorKind::NoPoints,
            "the file has no vertices",
            "give a PLY file with an element `vertex`",
        ));
    };
    let element = &header.elements[vertex];
    let mut axes = Vec::with_capacity(3);
    for axis in ["x", "y", "z"] {
        match (element.scalar(axis), element.find(axis)) {
            (Some(column), _) => axes.push(column),
            (None, None) if axis == "z" => {}
            (None, found) => {
                let how = if found.is_some() {
                    "is a list"
                } else {
                    "is missing"
                };
                return Err(ReadError::new(
                    ReadErrorKind::Header,
                    format!("the property {axis} of the element vertex {how}"),
                    format!("add a line such as `property float {axis}`, and its values"),
                )
                .at(bytes, element.at));
            }
        }
    }
    let float = |name: &str| element.scalar(name).filter(|c| c.1.is_float());
    let normal = match (float("nx"), float("ny"), float("nz")) {
        (Some(x), Some(y), Some(z)) if axes.len() == 3 => Some([x, y, z]),
        _ => None,
    };
    Ok((vertex, axes, normal))
}

/// Names of colours, which are read as 0 to 1.
const COLOURS: [&str; 4] = ["red", "green", "blue", "alpha"];

/// Kinds of elements that are read.
enum Reading {
    Faces(Column),
    Strips(Column),
    Edges([Column; 2]),
    /// Not looked into.
    Other,
}

fn reading(element: &Element) -> Reading {
    let list = || {
        element
            .list("vertex_indices")
            .or_else(|| element.list("vertex_index"))
    };
    let read = match element.name.as_str() {
        "face" => list().map(Reading::Faces),
        "tristrips" => list().map(Reading::Strips),
        "edge" => element
            .scalar("vertex1")
            .zip(element.scalar("vertex2"))
            .map(|(a, b)| Reading::Edges([a, b])),
        _ => None,
    };
    read.unwrap_or(Reading::Other)
}

impl Model {
    /// Visits the rows of an element.
    fn rows<E>(
        &self,
        element: usize,
        visit: impl FnMut(usize, &Row<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        each(
            &self.bytes,
            self.header.encoding,
            &self.header.elements[element],
            &self.sections[element],
            visit,
        )
    }
    /// As [`Model::rows`], for visits that cannot fail.
    fn all_rows(&self, element: usize, mut visit: impl FnMut(usize, &Row<'_>)) {
        let done = self.rows(element, |index, row| {
            visit(index, row);
            Ok::<(), Infallible>(())
        });
        match done {
            Ok(()) => {}
            Err(never) => match never {},
        }
    }

    /// How the rows of an element lie, if it is binary and they are all alike.
    fn strided(&self, element: usize) -> Option<Strided<'_>> {
        match (&self.sections[element].rows, self.header.encoding) {
            (Rows::Even { stride, spots }, Encoding::Binary(order)) => Some(Strided {
                stride: *stride,
                spots,
                order,
            }),
            _ => None,
        }
    }

    /// Vectors of the vertices by their columns; 0 where there is none.
    fn vectors(&self, columns: &[Option<Column>; 3]) -> Vec<DVec3> {
        let element = &self.header.elements[self.vertex];
        let section = &self.sections[self.vertex];
        if let Some(layout) = self.strided(self.vertex) {
            let bytes = &self.bytes[section.range.clone()];
            let present: Vec<Column> = columns.iter().copied().flatten().collect();
            return match Triple::of(&present, layout) {
                Some(triple) => triple.read(bytes),
                None => one_by_one(bytes, layout, columns),
            };
        }
        let mut all = Vec::with_capacity(element.count as usize);
        self.all_rows(self.vertex, |_, row| {
            let value = |c: Option<Column>| c.map_or(0.0, |(column, s)| row.scalar(column, s));
            all.push(DVec3::from_array(columns.map(value)));
        });
        all
    }

    /// One column of the vertices.
    fn column(&self, column: Column) -> Vec<f64> {
        let mut all = Vec::with_capacity(self.positions.len());
        self.all_rows(self.vertex, |_, row| {
            all.push(row.scalar(column.0, column.1));
        });
        all
    }

    fn stored_normals(&self) -> Option<Vec<DVec3>> {
        Some(self.vectors(&self.normal?.map(Some)))
    }

    /// The normals after a move, and the number of those that should have changed and could not.
    fn moved_normals(&self, new: &[DVec3], policy: Normals<'_>) -> Option<(Vec<DVec3>, usize)> {
        let faces = || self.elements().faces;
        Some(per_vertex(
            self.stored_normals()?,
            &self.positions,
            new,
            faces,
            policy,
        ))
    }

    /// Where a row begins.
    fn place(&self, element: usize, row: usize) -> usize {
        if let Rows::Even { stride, .. } = self.sections[element].rows {
            return self.sections[element].range.start + row * stride;
        }
        let found = self.rows(
            element,
            |index, at| {
                if index == row { Err(at.base) } else { Ok(()) }
            },
        );
        found.err().unwrap_or(self.sections[element].range.start)
    }

    /// The line of a row; `None` in binary.
    fn line(&self, element: usize, row: usize) -> Option<u64> {
        (self.header.encoding == Encoding::Ascii)
            .then(|| text::place(&self.bytes, self.place(element, row)).0)
    }

    /// An error about a row, with its line or place in the file.
    fn error(
        &self,
        kind: ReadErrorKind,
        element: usize,
        row: usize,
        what: &str,
        mend: &str,
    ) -> ReadError {
        let name = format!("{} {}", self.header.elements[element].name, row + 1);
        let at = self.place(element, row);
        if self.header.encoding == Encoding::Ascii {
            ReadError::new(kind, format!("{name} {what}"), mend).at(&self.bytes, at)
        } else {
            ReadError::new(kind, format!("{name} (at byte {at}) {what}"), mend)
        }
    }

    /// The first of the elements that makes no sense.
    fn check_elements(&self) -> Result<(), ReadError> {
        for (e, element) in self.header.elements.iter().enumerate() {
            let kind = reading(element);
            if matches!(kind, Reading::Other) || self.sound_triangles(e) {
                continue;
            }
            let count = self.positions.len();
            let found = self.rows(e, |index, row| {
                check_row(&kind, row, count).map_err(|what| (index, what))
            });
            if let Err((row, what)) = found {
                return Err(self.error(
                    ReadErrorKind::Element,
                    e,
                    row,
                    &what,
                    "correct or remove it; `anamorph inspect` counts such elements",
                ));
            }
        }
        Ok(())
    }

    /// Whether this is a common case, and in order: binary faces of one list of 32-bit indices, or such lists of equal
    /// length among other properties.
    fn sound_triangles(&self, element: usize) -> bool {
        let section = &self.sections[element];
        if section.sound {
            return true;
        }
        let Reading::Faces((column, Scalar::I32 | Scalar::U32)) =
            reading(&self.header.elements[element])
        else {
            return false;
        };
        let Some(Strided {
            stride,
            spots,
            order,
        }) = self.strided(element)
        else {
            return false;
        };
        let Some(spot) = spots.get(column).filter(|spot| spot.count >= 3) else {
            return false;
        };
        // A negative index is larger than any as an unsigned number.
        let most = (self.positions.len() as u64).min(1 << 31) as u32;
        let bytes = &self.bytes[section.range.clone()];
        let runs: Vec<&[u8]> = bytes.chunks(stride * RUN).collect();
        let in_range = |item: &[u8; 4]| match order {
            Order::Little => u32::from_le_bytes(*item) < most,
            Order::Big => u32::from_be_bytes(*item) < most,
        };
        let sound = text::map(&runs, |run| {
            run.chunks_exact(stride).all(|row| {
                let (items, _) = row[spot.start..spot.end].as_chunks::<4>();
                items.iter().all(in_range)
            })
        });
        sound.iter().all(|sound| *sound)
    }

    /// All elements that make sense, in file order.
    fn elements(&self) -> Elements {
        let mut elements = Elements::default();
        let count = self.positions.len();
        for (e, element) in self.header.elements.iter().enumerate() {
            let kind = reading(element);
            if matches!(kind, Reading::Other) {
                continue;
            }
            let mut items: Vec<u32> = Vec::new();
            self.all_rows(e, |index, row| {
                if let Err(what) = check_row(&kind, row, count) {
                    elements.add_broken(|| format!("{} {} {what}", element.name, index + 1));
                    return;
                }
                match kind {
                    Reading::Faces((column, item)) => {
                        let corners = row.items(column, item).map(|i| i as u32);
                        elements.faces.vertices.extend(corners);
                        elements.faces.close();
                        elements.ordinals.push(index as u32);
                    }
                    Reading::Strips((column, item)) => {
                        items.clear();
                        let end = |i: f64| if i < 0.0 { NONE } else { i as u32 };
                        items.extend(row.items(column, item).map(end));
                        for strip in items.split(|i| *i == NONE) {
                            for (i, corner) in strip.windows(3).enumerate() {
                                let [a, b, c] = [corner[0], corner[1], corner[2]];
                                // Repeated corners lead from one part of a strip to the next.
                                if a != b && b != c && c != a {
                                    let turned = if i % 2 == 0 { [a, b, c] } else { [b, a, c] };
                                    elements.faces.vertices.extend(turned);
                                    elements.faces.close();
                                    elements.ordinals.push(index as u32);
                                }
                            }
                        }
                    }
                    Reading::Edges(ends) => {
                        let ends = ends.map(|(column, s)| row.scalar(column, s) as u32);
                        elements.lines.push(ends);
                    }
                    Reading::Other => {}
                }
            });
        }
        elements
    }

    /// Texture coordinates: one a vertex, or one a corner.
    fn textures(&self, corners: usize) -> Values<DVec2> {
        let vertex = &self.header.elements[self.vertex];
        let names = [("s", "t"), ("u", "v"), ("texture_u", "texture_v")];
        let pair = names
            .iter()
            .find_map(|(u, v)| vertex.scalar(u).zip(vertex.scalar(v)));
        if let Some((u, v)) = pair {
            let pairs = self.column(u).into_iter().zip(self.column(v));
            return Values::Points(pairs.map(|(u, v)| DVec2::new(u, v)).collect());
        }
        let face = self.header.elements.iter().position(|e| e.name == "face");
        let Some((face, (column, item))) =
            face.and_then(|f| Some((f, self.header.elements[f].list("texcoord")?)))
        else {
            return Values::None;
        };
        let Reading::Faces((indices, _)) = reading(&self.header.elements[face]) else {
            return Values::None;
        };
        let (mut pool, mut index) = (Vec::new(), Vec::with_capacity(corners));
        self.all_rows(face, |_, row| {
            let count = row.count(indices);
            if row.count(column) == 2 * count {
                let values: Vec<f64> = row.items(column, item).collect();
                for pair in values.chunks_exact(2) {
                    index.push(Some(pool.len() as u32));
                    pool.push(DVec2::new(pair[0], pair[1]));
                }
            } else {
                index.extend(core::iter::repeat_n(None, count));
            }
        });
        if pool.is_empty() || index.len() != corners {
            return Values::None;
        }
        Values::Corners { pool, index }
    }
}

/// Vectors of a binary element, whatever the places and types of their numbers.
fn one_by_one(bytes: &[u8], layout: Strided<'_>, columns: &[Option<Column>; 3]) -> Vec<DVec3> {
    let places = columns.map(|c| c.map(|(column, scalar)| (layout.spots[column].start, scalar)));
    text::rows(bytes, layout.stride, |row| {
        DVec3::from_array(places.map(|place| {
            place.map_or(0.0, |(start, scalar)| {
                scalar.read(&row[start..], layout.order)
            })
        }))
    })
}

/// What is wrong with a row, if anything is.
fn check_row(kind: &Reading, row: &Row<'_>, count: usize) -> Result<(), String> {
    let check = |index: f64| {
        if index.trunc() == index && index >= 0.0 && index < count as f64 {
            return Ok(());
        }
        Err(format!(
            "refers to vertex index {index}, but indices run from 0 to {}",
            count - 1
        ))
    };
    match *kind {
        Reading::Faces((column, item)) => {
            if row.count(column) < 3 {
                return Err(format!(
                    "has {} corners and needs at least 3",
                    row.count(column)
                ));
            }
            row.items(column, item).try_for_each(check)
        }
        Reading::Strips((column, item)) => {
            let mut items = row.items(column, item);
            items.try_for_each(|i| if i == -1.0 { Ok(()) } else { check(i) })
        }
        Reading::Edges(ends) => ends
            .into_iter()
            .try_for_each(|(column, scalar)| check(row.scalar(column, scalar))),
        Reading::Other => Ok(()),
    }
}

impl Document for Model {
    fn format(&self) -> &'static str {
        Ply.name()
    }
    fn points(&self) -> Points<'_> {
        if self.axes.len() == 2 {
            Points::Plane(&self.plane)
        } else {
            Points::Solid(&self.positions)
        }
    }
    fn notes(&self) -> Vec<String> {
        let end = self.sections.last().map_or(0, |s| s.range.end);
        let rest = &self.bytes[end..];
        let blank = self.header.encoding == Encoding::Ascii && rest.trim_ascii().is_empty();
        if rest.is_empty() || blank {
            return Vec::new();
        }
        vec![format!(
            "{} bytes follow the last element that the header announces; they are kept",
            rest.len()
        )]
    }
    fn nonfinite(&self) -> &[usize] {
        &self.nonfinite
    }
    fn normals(&self) -> usize {
        self.normal.map_or(0, |_| self.positions.len())
    }
    fn mesh(&self) -> Option<Mesh> {
        let element = |e: &Element| e.count > 0 && !matches!(reading(e), Reading::Other);
        self.header.elements.iter().any(element).then(|| {
            let elements = self.elements();
            elements.mesh(&self.positions)
        })
    }
    fn attributes(&self) -> Vec<String> {
        let element = &self.header.elements[self.vertex];
        let taken = |column: usize| {
            let mut coordinates = self.axes.iter().chain(self.normal.iter().flatten());
            coordinates.any(|c| c.0 == column)
        };
        element
            .properties
            .iter()
            .enumerate()
            .filter(|(i, p)| element.scalar(&p.name).is_some() && !taken(*i))
            .map(|(_, p)| p.name.clone())
            .collect()
    }
    fn attribute(&self, name: &str) -> Option<Vec<f64>> {
        if !self.attributes().iter().any(|known| known == name) {
            return None;
        }
        let column = self.header.elements[self.vertex].scalar(name)?;
        let mut values = self.column(column);
        if COLOURS.contains(&name) && !column.1.is_float() {
            let full = column.1.full();
            values.iter_mut().for_each(|value| *value /= full);
        }
        Some(values)
    }
    fn inspect(&self) -> Inspection {
        inspect::inspect(self)
    }
    fn geometry(&self, moved: &Moved<'_>) -> Result<Geometry, WriteError> {
        self.points().check(&moved.points)?;
        let new = moved.points.solid();
        let elements = self.elements();
        let corners = elements.faces.vertices.len();
        let mut geometry = Geometry {
            planar: self.axes.len() == 2,
            points: new.to_vec(),
            ends: elements.faces.ends().to_vec(),
            corners: elements.faces.vertices,
            lines: elements.lines,
            textures: self.textures(corners),
            ..Geometry::default()
        };
        geometry.take_attributes(self);
        if let Values::Points(_) = geometry.textures {
            let names = ["s", "t", "u", "v", "texture_u", "texture_v"];
            geometry
                .attributes
                .retain(|(name, _)| !names.contains(&name.as_str()));
        }
        if let Some((normals, _)) = self.moved_normals(&new, moved.normals) {
            geometry.normals = Values::Points(normals);
        }
        for element in &self.header.elements {
            let known = element.name == "vertex" || !matches!(reading(element), Reading::Other);
            if !known && element.count > 0 {
                geometry
                    .beyond
                    .push(format!("{} {} elements", element.count, element.name));
            }
        }
        Ok(geometry)
    }
    fn write(&self, moved: &Moved<'_>, out: &mut dyn Write) -> Result<WriteReport, WriteError> {
        write::write(self, moved, out)
    }
}
