//! A new OFF file.

use crate::patch::flush;
use crate::{Geometry, Lost, WriteError, number};
use std::io::Write;

fn numbers(buffer: &mut Vec<u8>, values: impl IntoIterator<Item = f64>) {
    for value in values {
        if buffer.last().is_some_and(|b| *b != b'\n') {
            buffer.push(b' ');
        }
        number::write_any(value, buffer);
    }
}

/// Writes a new file; see [`crate::Target::create`].
pub(crate) fn create(geometry: &Geometry, out: &mut dyn Write) -> Result<Lost, WriteError> {
    let points = &geometry.points;
    let mut lost = Lost(geometry.beyond.clone());
    let (normals, textures) = geometry.per_point("OFF", &mut lost);
    lost.add(
        textures.is_none() && !geometry.textures.is_none(),
        "texture coordinates (points have several, OFF holds one pair for each)",
    );
    lost.add_attributes(geometry);

    let coloured = !geometry.colours.is_empty();
    let mut buffer = Vec::new();
    for (asked, prefix) in [
        (textures.is_some(), "ST"),
        (coloured, "C"),
        (normals.is_some(), "N"),
    ] {
        if asked {
            buffer.extend_from_slice(prefix.as_bytes());
        }
    }
    let elements = geometry.ends.len() + geometry.lines.len() + geometry.loose.len();
    buffer.extend_from_slice(format!("OFF\n{} {elements} 0\n", points.len()).as_bytes());
    for (i, point) in points.iter().enumerate() {
        numbers(&mut buffer, point.to_array());
        if let Some(normals) = &normals {
            numbers(&mut buffer, normals[i].to_array());
        }
        if let Some(colour) = geometry.colours.get(i) {
            numbers(&mut buffer, *colour);
        }
        if let Some(textures) = &textures {
            numbers(&mut buffer, textures[i].to_array());
        }
        buffer.push(b'\n');
        flush(&mut buffer, out)?;
    }
    let faces = geometry.faces().map(|(_, face)| face);
    let lines = geometry.lines.iter().map(<[u32; 2]>::as_slice);
    for element in faces.chain(lines).chain(geometry.loose.chunks(1)) {
        number::write_whole(element.len() as u64, &mut buffer);
        for point in element {
            buffer.push(b' ');
            number::write_whole(u64::from(*point), &mut buffer);
        }
        buffer.push(b'\n');
        flush(&mut buffer, out)?;
    }
    out.write_all(&buffer)?;
    Ok(lost)
}
