//! The model of an OBJ file without the file, and the file of a model.

use super::normals::plan;
use super::scan::{Keyword, Reference, Statement, Tokens, resolve};
use super::{Text, fewest, normals};
use crate::patch::flush;
use crate::{Document, Geometry, Lost, Moved, Values, WriteError, number};
use anamorph_core::glam::{DVec2, DVec3};
use std::collections::BTreeSet;
use std::io::Write;

/// The model with its points moved.
pub(super) fn geometry(text: &Text, moved: &Moved<'_>) -> Result<Geometry, WriteError> {
    text.points().check(&moved.points)?;
    let new = moved.points.solid();
    let mut geometry = Geometry {
        points: new.to_vec(),
        ..Geometry::default()
    };
    let plan = plan(text, &new, moved.normals);
    let mut textures = Vec::with_capacity(text.totals.textures as usize);
    let (mut texture_of, mut normal_of) = (Vec::new(), Vec::new());
    let mut names = [BTreeSet::new(), BTreeSet::new(), BTreeSet::new()];
    let mut others = 0_u64;
    let all_textures = text.totals.textures;
    for chunk in &text.chunks {
        let mut before = chunk.before;
        for statement in text.statements(chunk) {
            match statement.keyword {
                Keyword::Texture => textures.push(coordinates(&text.bytes, &statement)),
                Keyword::Face => {
                    let first = geometry.corners.len();
                    let mut sound = true;
                    for token in Tokens::of(&text.bytes, &statement) {
                        let reference = Reference::parse(&text.bytes[token]);
                        let corner = reference.and_then(|r| Some((r, text.vertex(r, before)?)));
                        let Some((reference, vertex)) = corner else {
                            sound = false;
                            break;
                        };
                        geometry.corners.push(vertex);
                        let normal = text.normal(reference, before).map(|normal| {
                            let moved = plan.as_ref().and_then(|p| p.redirect(normal, vertex));
                            moved.map_or(normal, |index| index as u32)
                        });
                        normal_of.push(normal);
                        let texture = resolve(reference.texture, before.textures)
                            .filter(|t| *t < all_textures)
                            .map(|t| t as u32);
                        texture_of.push(texture);
                    }
                    if sound && geometry.corners.len() - first >= fewest(Keyword::Face) {
                        geometry.ends.push(geometry.corners.len());
                    } else {
                        geometry.corners.truncate(first);
                        normal_of.truncate(first);
                        texture_of.truncate(first);
                    }
                }
                Keyword::Other => {
                    let whole = Statement {
                        arguments: statement.start,
                        ..statement
                    };
                    if let Some(word) = Tokens::of(&text.bytes, &whole).next() {
                        let name = text.bytes[word.end..statement.end].trim_ascii();
                        match &text.bytes[word] {
                            b"o" => drop(names[0].insert(name)),
                            b"g" => drop(names[1].insert(name)),
                            b"usemtl" => drop(names[2].insert(name)),
                            b"curv" | b"curv2" | b"surf" => others += 1,
                            _ => {}
                        }
                    }
                }
                _ => {}
            }
            before.count(statement.keyword);
        }
    }
    let elements = text.elements(false);
    geometry.lines = elements.lines;
    geometry.loose = elements.points;
    geometry.take_attributes(text);
    if texture_of.iter().any(Option::is_some) {
        geometry.textures = Values::Corners {
            pool: textures,
            index: texture_of,
        };
    }
    if normal_of.iter().any(Option::is_some) {
        let mut pool = match plan {
            Some(plan) => [plan.new, plan.added].concat(),
            None => normals::stored(text),
        };
        // What is no normal has no direction.
        for normal in &mut pool {
            if normal.is_nan() {
                *normal = DVec3::ZERO;
            }
        }
        geometry.normals = Values::Corners {
            pool,
            index: normal_of,
        };
    }
    let words = [("object", 0), ("group", 1), ("material", 2)];
    for (word, which) in words {
        let count = names[which].len();
        // A single object is the model itself.
        if count > usize::from(which == 0) {
            let plural = if count == 1 { "" } else { "s" };
            geometry.beyond.push(format!("{count} {word}{plural}"));
        }
    }
    if others > 0 {
        geometry
            .beyond
            .push(format!("{others} free-form curves or surfaces"));
    }
    Ok(geometry)
}

/// The first two numbers of a texture coordinate; the second may be left out.
fn coordinates(bytes: &[u8], statement: &Statement) -> DVec2 {
    let mut tokens = Tokens::of(bytes, statement);
    let mut next = || tokens.number().and_then(|(value, _)| value).unwrap_or(0.0);
    DVec2::new(next(), next())
}

/// Writes a new file; see [`crate::Target::create`].
pub(crate) fn create(geometry: &Geometry, out: &mut dyn Write) -> Result<Lost, WriteError> {
    let mut lost = Lost(geometry.beyond.clone());
    let weights = match geometry.attributes.as_slice() {
        [(name, values)] if name == super::WEIGHT && geometry.colours.is_empty() => Some(values),
        _ => {
            lost.add_attributes(geometry);
            None
        }
    };
    lost.add(geometry.has_opacity(), "opacity");
    let mut buffer = Vec::new();
    for (i, point) in geometry.points.iter().enumerate() {
        let weight = weights.map(|values| values[i]);
        let colour = geometry.colours.get(i).map_or(&[][..], |c| &c[..3]);
        let numbers = point.to_array().into_iter().chain(weight);
        statement(&mut buffer, b"v", numbers.chain(colour.iter().copied()));
        flush(&mut buffer, out)?;
    }
    for texture in geometry.textures.pool() {
        statement(&mut buffer, b"vt", texture.to_array());
        flush(&mut buffer, out)?;
    }
    for normal in geometry.normals.pool() {
        statement(&mut buffer, b"vn", normal.to_array());
        flush(&mut buffer, out)?;
    }
    for (first, face) in geometry.faces() {
        buffer.push(b'f');
        for (i, &point) in face.iter().enumerate() {
            let texture = geometry.textures.index(first + i, point);
            let normal = geometry.normals.index(first + i, point);
            buffer.push(b' ');
            number::write_whole(u64::from(point) + 1, &mut buffer);
            if texture.is_some() || normal.is_some() {
                buffer.push(b'/');
            }
            if let Some(texture) = texture {
                number::write_whole(u64::from(texture) + 1, &mut buffer);
            }
            if let Some(normal) = normal {
                buffer.push(b'/');
                number::write_whole(u64::from(normal) + 1, &mut buffer);
            }
        }
        buffer.push(b'\n');
        flush(&mut buffer, out)?;
    }
    let lines = geometry.lines.iter().map(|line| (&b"l"[..], &line[..]));
    let loose = geometry.loose.chunks(1).map(|point| (&b"p"[..], point));
    for (keyword, points) in lines.chain(loose) {
        buffer.extend_from_slice(keyword);
        for &point in points {
            buffer.push(b' ');
            number::write_whole(u64::from(point) + 1, &mut buffer);
        }
        buffer.push(b'\n');
        flush(&mut buffer, out)?;
    }
    out.write_all(&buffer)?;
    Ok(lost)
}

/// Appends a line of numbers; those that are not finite in the spelling of Rust and C.
fn statement(buffer: &mut Vec<u8>, keyword: &[u8], numbers: impl IntoIterator<Item = f64>) {
    buffer.extend_from_slice(keyword);
    for value in numbers {
        buffer.push(b' ');
        number::write_any(value, buffer);
    }
    buffer.push(b'\n');
}
