//! A new PLY file: binary, little endian, positions as `double`, so that nothing is rounded.

use crate::patch::flush;
use crate::{Geometry, Lost, Values, WriteError};
use std::fmt::Write as _;
use std::io::Write;

/// A name that a header can hold.
fn is_word(name: &str) -> bool {
    !name.is_empty() && name.bytes().all(|b| b.is_ascii_graphic())
}

/// Names that the header uses itself.
const TAKEN: [&str; 12] = [
    "x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha", "s", "t",
];

/// Properties of colours.
const COLOURS: [&str; 4] = ["red", "green", "blue", "alpha"];

/// Whether colours are what eight bits can say.
fn is_bytes(geometry: &Geometry) -> bool {
    let mut all = geometry.colours.iter().flatten();
    all.all(|c| (0.0..=1.0).contains(c) && (c * 255.0).round() / 255.0 == *c)
}

/// Writes a new file; see [`crate::Target::create`].
pub(crate) fn create(geometry: &Geometry, out: &mut dyn Write) -> Result<Lost, WriteError> {
    let points = &geometry.points;
    let mut lost = Lost(geometry.beyond.clone());
    let (normals, textures) = geometry.per_point("PLY", &mut lost);
    let wedges = match (&textures, &geometry.textures) {
        (None, Values::Corners { pool, index }) => Some((pool, index)),
        _ => None,
    };
    lost.add(!geometry.loose.is_empty(), "point elements");
    let usable = |name: &str| is_word(name) && !TAKEN.contains(&name);
    let (attributes, unnamed): (Vec<_>, Vec<_>) = geometry
        .attributes
        .iter()
        .partition(|(name, _)| usable(name));
    for (name, _) in unnamed {
        lost.0.push(format!("the attribute {name:?}"));
    }
    let bytes = is_bytes(geometry);
    let opacity = geometry.has_opacity();
    let shown = &COLOURS[..if opacity { 4 } else { 3 }];

    let mut header = String::from("ply\nformat binary_little_endian 1.0\n");
    let mut lines = |prefix: &str, names: &[&str]| {
        for name in names {
            let _ = writeln!(header, "property {prefix} {name}");
        }
    };
    lines(
        "double",
        if geometry.planar {
            &["x", "y"]
        } else {
            &["x", "y", "z"]
        },
    );
    if normals.is_some() {
        lines("double", &["nx", "ny", "nz"]);
    }
    if !geometry.colours.is_empty() {
        lines(if bytes { "uchar" } else { "double" }, shown);
    }
    if textures.is_some() {
        lines("double", &["s", "t"]);
    }
    for (name, _) in &attributes {
        lines("double", &[name]);
    }
    let vertex = format!("element vertex {}\n", points.len());
    header.insert_str("ply\nformat binary_little_endian 1.0\n".len(), &vertex);
    // Counts fit a byte in almost all models.
    let largest = geometry.faces().map(|(_, face)| face.len()).max();
    let wide = largest.is_some_and(|n| 2 * n > 255);
    let count = if wide { "uint" } else { "uchar" };
    if largest.is_some() {
        let _ = writeln!(
            header,
            "element face {}\nproperty list {count} uint vertex_indices",
            geometry.ends.len()
        );
        if wedges.is_some() {
            let _ = writeln!(header, "property list {count} double texcoord");
        }
    }
    if !geometry.lines.is_empty() {
        let _ = writeln!(
            header,
            "element edge {}\nproperty uint vertex1\nproperty uint vertex2",
            geometry.lines.len()
        );
    }
    header.push_str("end_header\n");
    out.write_all(header.as_bytes())?;

    let mut buffer = Vec::new();
    for (i, point) in points.iter().enumerate() {
        let mut double = |value: f64| buffer.extend_from_slice(&value.to_le_bytes());
        double(point.x);
        double(point.y);
        if !geometry.planar {
            double(point.z);
        }
        if let Some(normals) = &normals {
            normals[i].to_array().into_iter().for_each(&mut double);
        }
        if let Some(colour) = geometry.colours.get(i) {
            for value in &colour[..shown.len()] {
                if bytes {
                    buffer.push((value * 255.0).round() as u8);
                } else {
                    buffer.extend_from_slice(&value.to_le_bytes());
                }
            }
        }
        let mut double = |value: f64| buffer.extend_from_slice(&value.to_le_bytes());
        if let Some(textures) = &textures {
            textures[i].to_array().into_iter().for_each(&mut double);
        }
        for (_, values) in &attributes {
            double(values[i]);
        }
        flush(&mut buffer, out)?;
    }
    for (first, face) in geometry.faces() {
        let put_count = |buffer: &mut Vec<u8>, n: usize| {
            if wide {
                buffer.extend_from_slice(&(n as u32).to_le_bytes());
            } else {
                buffer.push(n as u8);
            }
        };
        put_count(&mut buffer, face.len());
        for point in face {
            buffer.extend_from_slice(&point.to_le_bytes());
        }
        if let Some((pool, index)) = wedges {
            let whole = (first..first + face.len()).all(|c| index[c].is_some());
            put_count(&mut buffer, if whole { 2 * face.len() } else { 0 });
            if whole {
                for value in index[first..first + face.len()].iter().flatten() {
                    for coordinate in pool[*value as usize].to_array() {
                        buffer.extend_from_slice(&coordinate.to_le_bytes());
                    }
                }
            }
        }
        flush(&mut buffer, out)?;
    }
    for end in geometry.lines.iter().flatten() {
        buffer.extend_from_slice(&end.to_le_bytes());
        flush(&mut buffer, out)?;
    }
    out.write_all(&buffer)?;
    Ok(lost)
}
