//! A new table of points.

use crate::patch::flush;
use crate::{Geometry, Lost, WriteError, number};
use std::io::Write;

/// Appends a name, in quotes where it needs them.
fn field(buffer: &mut Vec<u8>, name: &str) {
    if name.contains(['"', ',', ';', '\t', '|', '\n', '\r']) || name.trim() != name {
        buffer.push(b'"');
        buffer.extend_from_slice(name.replace('"', "\"\"").as_bytes());
        buffer.push(b'"');
    } else {
        buffer.extend_from_slice(name.as_bytes());
    }
}

/// Writes a new file; see [`crate::Target::create`].
pub(crate) fn create(geometry: &Geometry, out: &mut dyn Write) -> Result<Lost, WriteError> {
    let mut lost = Lost(geometry.beyond.clone());
    lost.add(!geometry.ends.is_empty(), "faces");
    lost.add(!geometry.lines.is_empty(), "lines");
    lost.add(!geometry.loose.is_empty(), "point elements");
    let normals = geometry
        .normals
        .per_point(geometry.points.len(), &geometry.corners);
    let textures = geometry
        .textures
        .per_point(geometry.points.len(), &geometry.corners);
    lost.add(
        normals.is_none() && !geometry.normals.is_none(),
        "normals (points have several)",
    );
    lost.add(
        textures.is_none() && !geometry.textures.is_none(),
        "texture coordinates (points have several)",
    );
    let axes = &["x", "y", "z"][..if geometry.planar { 2 } else { 3 }];
    let channels = match (geometry.colours.is_empty(), geometry.has_opacity()) {
        (true, _) => 0,
        (false, false) => 3,
        (false, true) => 4,
    };
    let mut names: Vec<&str> = axes.to_vec();
    if normals.is_some() {
        names.extend(["nx", "ny", "nz"]);
    }
    names.extend(&["red", "green", "blue", "alpha"][..channels]);
    if textures.is_some() {
        names.extend(["s", "t"]);
    }
    let mut attributes = Vec::new();
    for (name, values) in &geometry.attributes {
        // The table could not be read again if a coordinate came twice; a column without a name would not be found.
        if name.is_empty() || names.iter().any(|taken| taken.eq_ignore_ascii_case(name)) {
            lost.0.push(format!("the attribute {name:?}"));
        } else {
            attributes.push(values);
            names.push(name);
        }
    }
    let mut buffer = Vec::new();
    for (i, name) in names.iter().enumerate() {
        if i > 0 {
            buffer.push(b',');
        }
        field(&mut buffer, name);
    }
    buffer.push(b'\n');
    for (i, point) in geometry.points.iter().enumerate() {
        let place = point.to_array().into_iter().take(axes.len());
        let normal = normals.iter().flat_map(|all| all[i].to_array());
        let colour = geometry
            .colours
            .get(i)
            .into_iter()
            .flatten()
            .copied()
            .take(channels);
        let texture = textures.iter().flat_map(|all| all[i].to_array());
        let values = attributes.iter().map(|values| values[i]);
        let row = place
            .chain(normal)
            .chain(colour)
            .chain(texture)
            .chain(values);
        for (column, value) in row.enumerate() {
            if column > 0 {
                buffer.push(b',');
            }
            number::write_any(value, &mut buffer);
        }
        buffer.push(b'\n');
        flush(&mut buffer, out)?;
    }
    out.write_all(&buffer)?;
    Ok(lost)
}
