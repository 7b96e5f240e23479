//! A new binary glTF file: one mesh, its positions, normals, texture coordinates and colours rounded to 32 bits.
//!
//! *Source*: Khronos Group, *glTF 2.0 Specification*, version 2.0.1, 2021: sections 3.6 (buffers), 3.7 (meshes) and 4 (GLB).
//! A vertex of glTF has one normal and one texture coordinate; points whose corners differ become several. Colours are
//! linear there (section 3.7.2.1) and sRGB-encoded here; `v` of texture coordinates runs downwards there and upwards here.

use crate::normals::unit;
use crate::patch::flush;
use crate::{Format, Geometry, Lost, Moved, ReadOptions, WriteError};
use anamorph_core::glam::DVec3;
use std::collections::HashMap;
use std::io::Write;

/// A corner as glTF sees it: point, normal and texture coordinate.
type Vertex = (u32, Option<u32>, Option<u32>);

/// The linear value of an sRGB-encoded one, both from 0 to 1 (IEC 61966-2-1).
fn linear(encoded: f64) -> f32 {
    let encoded = if encoded.is_nan() {
        0.0
    } else {
        encoded.clamp(0.0, 1.0)
    };
    let value = if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        anamorph_core::math::pow((encoded + 0.055) / 1.055, 2.4)
    };
    value as f32
}

/// What the buffer holds, one view each.
struct View {
    /// Numbers of bytes, and elements.
    bytes: usize,
    count: usize,
    kind: &'static str,
    /// Whether its elements are indices.
    indices: bool,
    /// `min` and `max`, for positions.
    bounds: String,
}

/// Writes a geometry as a glTF text with its data in it.
pub(crate) fn create_text(geometry: &Geometry, out: &mut dyn Write) -> Result<Lost, WriteError> {
    let mut glb = Vec::new();
    let lost = create(geometry, &mut glb)?;
    let own = |error: &dyn core::fmt::Display| WriteError::Refused {
        what: format!("the model cannot be a glTF: {error}"),
        mend: "name the output .glb".to_owned(),
    };
    let options = ReadOptions::default().allow_nonfinite(true);
    let document = super::gltf::Glb
        .read(glb, &options)
        .map_err(|error| own(&error))?;
    document.write_as("gltf", &Moved::new(document.points()), out)?;
    Ok(lost)
}

/// Writes a new file; see [`crate::Target::create`].
pub(crate) fn create(geometry: &Geometry, out: &mut dyn Write) -> Result<Lost, WriteError> {
    create_traced(geometry, out).map(|(lost, _)| lost)
}

/// As [`create`]; also gives the point that each vertex of the file comes from.
pub(crate) fn create_traced(
    geometry: &Geometry,
    out: &mut dyn Write,
) -> Result<(Lost, Vec<u32>), WriteError> {
    let rounded = geometry.check_single("glTF")?;
    if let Some(bad) = geometry.points.iter().position(|p| !p.is_finite()) {
        return Err(WriteError::DoesNotFit {
            what: format!("point {} is not finite, which glTF does not allow", bad + 1),
            mend: "correct it, or write the model as PLY or OBJ",
        });
    }
    let mut lost = Lost(geometry.beyond.clone());
    lost.add(geometry.has_polygons(), "polygons (cut into triangles)");
    lost.add(rounded, "digits beyond 32-bit numbers");
    lost.add_attributes(geometry);

    // Either all vertices have a normal (or texture coordinate), or none.
    let complete = |index: &dyn Fn(usize, u32) -> Option<u32>| {
        let mut corners = geometry.corners.iter().enumerate();
        !geometry.corners.is_empty()
            && corners.all(|(corner, &point)| index(corner, point).is_some())
    };
    let normals: Option<Vec<DVec3>> = complete(&|c, p| geometry.normals.index(c, p))
        .then(|| {
            geometry
                .normals
                .pool()
                .iter()
                .map(|n| unit(*n))
                .collect::<Option<Vec<_>>>()
        })
        .flatten();
    lost.add(
        normals.is_none() && !geometry.normals.is_none(),
        "normals (not all corners have one)",
    );
    let textured = complete(&|c, p| geometry.textures.index(c, p));
    lost.add(
        !textured && !geometry.textures.is_none(),
        "texture coordinates (not all corners have one)",
    );

    let mut vertices: Vec<Vertex> = Vec::new();
    let mut known: HashMap<Vertex, u32> = HashMap::new();
    let mut number = |vertex: Vertex| {
        *known.entry(vertex).or_insert_with(|| {
            vertices.push(vertex);
            vertices.len() as u32 - 1
        })
    };
    let of_corner: Vec<u32> = geometry
        .corners
        .iter()
        .enumerate()
        .map(|(corner, &point)| {
            let normal = normals
                .as_ref()
                .and_then(|_| geometry.normals.index(corner, point));
            let texture = textured
                .then(|| geometry.textures.index(corner, point))
                .flatten();
            number((point, normal, texture))
        })
        .collect();
    let mut used: Vec<Option<u32>> = vec![None; geometry.points.len()];
    for (&point, &vertex) in geometry.corners.iter().zip(&of_corner) {
        used[point as usize].get_or_insert(vertex);
    }
    // Lines and points refer to some vertex of their point; points of no element are point elements where there is nothing
    // else.
    let bare = geometry.ends.is_empty() && geometry.lines.is_empty() && geometry.loose.is_empty();
    let mut loose = geometry.loose.clone();
    if bare {
        loose = (0..geometry.points.len() as u32).collect();
    }
    let mut of_point = |point: u32| {
        *used[point as usize].get_or_insert_with(|| {
            let index = vertices.len() as u32;
            vertices.push((point, normals.as_ref().map(|_| u32::MAX), None));
            index
        })
    };
    let lines: Vec<u32> = geometry
        .lines
        .iter()
        .flatten()
        .map(|&p| of_point(p))
        .collect();
    let loose: Vec<u32> = loose.iter().map(|&p| of_point(p)).collect();
    lost.add(used.contains(&None), "points that no element uses");
    if vertices.is_empty() {
        return Err(WriteError::DoesNotFit {
            what: "the model has nothing that glTF could show".to_owned(),
            mend: "write it as PLY or OBJ",
        });
    }
    let triangles: Vec<u32> = geometry
        .corner_triangles()
        .into_iter()
        .flatten()
        .map(|corner| of_corner[corner as usize])
        .collect();

    // The buffer: positions, normals, texture coordinates, colours, then the indices of each kind of element.
    let n = vertices.len();
    let mut views = vec![View {
        bytes: 12 * n,
        count: n,
        kind: "VEC3",
        indices: false,
        bounds: bounds(geometry, &vertices),
    }];
    let mut attributes = vec![r#""POSITION":0"#.to_owned()];
    let mut add = |name: &str, size: usize, kind: &'static str| {
        attributes.push(format!(r#""{name}":{}"#, views.len()));
        views.push(View {
            bytes: 4 * size * n,
            count: n,
            kind,
            indices: false,
            bounds: String::new(),
        });
    };
    if normals.is_some() {
        add("NORMAL", 3, "VEC3");
    }
    if textured {
        add("TEXCOORD_0", 2, "VEC2");
    }
    let coloured = !geometry.colours.is_empty();
    if coloured {
        add("COLOR_0", 4, "VEC4");
    }
    let attributes = attributes.join(",");
    let mut primitives = Vec::new();
    // Mode 4: triangles, 1: lines, 0: points.
    for (mode, indices) in [(4, &triangles), (1, &lines), (0, &loose)] {
        if !indices.is_empty() {
            primitives.push(format!(
                r#"{{"attributes":{{{attributes}}},"indices":{},"mode":{mode}}}"#,
                views.len()
            ));
            views.push(View {
                bytes: 4 * indices.len(),
                count: indices.len(),
                kind: "SCALAR",
                indices: true,
                bounds: String::new(),
            });
        }
    }
    let length: usize = views.iter().map(|view| view.bytes).sum();
    let mut json = document(&views, &primitives, length);
    while !json.len().is_multiple_of(4) {
        json.push(' ');
    }
    let total = 12 + 8 + json.len() + 8 + length;
    let Ok(total) = u32::try_from(total) else {
        return Err(WriteError::DoesNotFit {
            what: format!("the model takes {total} bytes, and a GLB file at most 4294967295"),
            mend: "write it as PLY",
        });
    };

    let mut buffer = Vec::new();
    buffer.extend_from_slice(b"glTF");
    for value in [2, total, json.len() as u32] {
        buffer.extend_from_slice(&value.to_le_bytes());
    }
    buffer.extend_from_slice(b"JSON");
    buffer.extend_from_slice(json.as_bytes());
    buffer.extend_from_slice(&(length as u32).to_le_bytes());
    buffer.extend_from_slice(b"BIN\0");
    let put = |buffer: &mut Vec<u8>, value: f64| {
        buffer.extend_from_slice(&(value as f32).to_le_bytes());
    };
    for vertex in &vertices {
        for value in geometry.points[vertex.0 as usize].to_array() {
            put(&mut buffer, value);
        }
        flush(&mut buffer, out)?;
    }
    if let Some(normals) = &normals {
        for vertex in &vertices {
            // A vertex that lines or points alone use has no normal; any unit vector is valid.
            let normal = vertex.1.and_then(|i| normals.get(i as usize));
            for value in normal.copied().unwrap_or(DVec3::Z).to_array() {
                put(&mut buffer, value);
            }
            flush(&mut buffer, out)?;
        }
    }
    if textured {
        for vertex in &vertices {
            let pool = geometry.textures.pool();
            let pair = vertex
                .2
                .and_then(|i| pool.get(i as usize))
                .copied()
                .unwrap_or_default();
            put(&mut buffer, pair.x);
            put(&mut buffer, 1.0 - pair.y);
            flush(&mut buffer, out)?;
        }
    }
    if coloured {
        for vertex in &vertices {
            let [r, g, b, a] = geometry.colours[vertex.0 as usize];
            let opacity = if a.is_nan() {
                1.0
            } else {
                a.clamp(0.0, 1.0) as f32
            };
            for value in [linear(r), linear(g), linear(b), opacity] {
                buffer.extend_from_slice(&value.to_le_bytes());
            }
            flush(&mut buffer, out)?;
        }
    }
    for index in triangles.iter().chain(&lines).chain(&loose) {
        buffer.extend_from_slice(&index.to_le_bytes());
        flush(&mut buffer, out)?;
    }
    out.write_all(&buffer)?;
    Ok((lost, vertices.into_iter().map(|vertex| vertex.0).collect()))
}

/// `min` and `max` of the positions as they are written.
fn bounds(geometry: &Geometry, vertices: &[Vertex]) -> String {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for vertex in vertices {
        let point = geometry.points[vertex.0 as usize].to_array();
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis] as f32);
            high[axis] = high[axis].max(point[axis] as f32);
        }
    }
    let list = |values: [f32; 3]| {
        // As 64-bit numbers, which readers of JSON round to exactly the 32-bit ones.
        let [x, y, z] = values.map(f64::from);
        format!("[{x:?},{y:?},{z:?}]")
    };
    format!(r#","min":{},"max":{}"#, list(low), list(high))
}

/// The JSON part.
fn document(views: &[View], primitives: &[String], length: usize) -> String {
    let (mut accessors, mut buffer_views, mut at) = (Vec::new(), Vec::new(), 0);
    for (i, view) in views.iter().enumerate() {
        // 5126: 32-bit numbers, 5125: 32-bit indices; 34962 and 34963: vertices and indices.
        let (component, target) = if view.indices {
            (5125, 34963)
        } else {
            (5126, 34962)
        };
        accessors.push(format!(
            r#"{{"bufferView":{i},"componentType":{component},"count":{},"type":"{}"{}}}"#,
            view.count, view.kind, view.bounds
        ));
        buffer_views.push(format!(
            r#"{{"buffer":0,"byteOffset":{at},"byteLength":{},"target":{target}}}"#,
            view.bytes
        ));
        at += view.bytes;
    }
    format!(
        r#"{{"asset":{{"version":"2.0","generator":"anamorph {}"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{}]}}],"accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{length}}}]}}"#,
        env!("CARGO_PKG_VERSION"),
        primitives.join(","),
        accessors.join(","),
        buffer_views.join(",")
    )
}
