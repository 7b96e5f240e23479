//! A new binary glTF file of one node that moves, and of the path it moves along.
//!
//! *Source*: Khronos Group, *glTF 2.0 Specification*, version 2.0.1, 2021: sections 3.6 (buffers), 3.11 (animations), 4 (GLB)
//! and appendix C (interpolation modes). All numbers are rounded to 32 bits, times too.

use crate::WriteError;
use anamorph_core::glam::{DQuat, DVec3};
use std::io::Write;

/// A value at each of some times, and how it goes from one to the next.
#[derive(Debug, Clone, PartialEq)]
pub enum Track<T> {
    /// Straight; rotations turn evenly on the shorter way (slerp).
    Linear(Vec<(f64, T)>),
    /// By cubics: at each time the slope by which the value is reached, the value, and the slope by which it is left, by the time.
    Cubic(Vec<(f64, [T; 3])>),
}

impl<T> Track<T> {
    /// The number of keys.
    pub fn len(&self) -> usize {
        match self {
            Self::Linear(keys) => keys.len(),
            Self::Cubic(keys) => keys.len(),
        }
    }

    /// Whether there are no keys.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What glTF calls it.
    pub fn interpolation(&self) -> &'static str {
        match self {
            Self::Linear(_) => "LINEAR",
            Self::Cubic(_) => "CUBICSPLINE",
        }
    }

    fn times(&self) -> Vec<f64> {
        match self {
            Self::Linear(keys) => keys.iter().map(|key| key.0).collect(),
            Self::Cubic(keys) => keys.iter().map(|key| key.0).collect(),
        }
    }
}

/// A node that moves.
#[derive(Debug, Clone)]
pub struct MovingNode<'a> {
    /// Its name.
    pub name: &'a str,
    /// Triangles of its shape in its own coordinates, counter-clockwise from outside.
    pub triangles: &'a [[DVec3; 3]],
    /// Where it is, by seconds.
    pub translation: Track<DVec3>,
    /// How it is turned, by seconds: unit quaternions.
    pub rotation: Track<DQuat>,
    /// The vertical field of view in radians, if it is a camera.
    pub camera: Option<f64>,
    /// Points of the line it moves along; nothing where there is none.
    pub path: &'a [DVec3],
    /// What is said about it in the file, as JSON; empty for nothing.
    pub extras: String,
}

/// A part of the buffer, and the accessor of it.
struct View {
    offset: usize,
    length: usize,
    count: usize,
    kind: &'static str,
    /// For the graphics card (vertices), rather than for animations.
    vertices: bool,
    bounds: String,
}

#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<View>,
}

impl Buffer {
    /// Adds an accessor of rows of `width` numbers; gives its index.
    fn add(&mut self, rows: &[f32], width: usize, vertices: bool, bounded: bool) -> usize {
        let offset = self.bytes.len();
        for number in rows {
            self.bytes.extend_from_slice(&number.to_le_bytes());
        }
        let bounds = if bounded {
            let fold = |f: fn(f32, f32) -> f32, start: f32| -> String {
                let each = (0..width).map(|k| {
                    let column = rows.iter().skip(k).step_by(width).copied();
                    // As 64-bit numbers, which readers of JSON round to exactly the 32-bit ones.
                    format!("{:?}", f64::from(column.fold(start, f)))
                });
                each.collect::<Vec<_>>().join(",")
            };
            let (low, high) = (
                fold(f32::min, f32::INFINITY),
                fold(f32::max, f32::NEG_INFINITY),
            );
            format!(r#","min":[{low}],"max":[{high}]"#)
        } else {
            String::new()
        };
        self.views.push(View {
            offset,
            length: self.bytes.len() - offset,
            count: rows.len() / width,
            kind: match width {
                1 => "SCALAR",
                3 => "VEC3",
                _ => "VEC4",
            },
            vertices,
            bounds,
        });
        self.views.len() - 1
    }
}

fn fits(numbers: &[f32], what: &str) -> Result<(), WriteError> {
    if numbers.iter().all(|number| number.is_finite()) {
        return Ok(());
    }
    Err(WriteError::DoesNotFit {
        what: format!("{what} has a number beyond what 32 bits hold"),
        mend: "scale the path down",
    })
}

fn of_points<'a>(points: impl IntoIterator<Item = &'a DVec3>) -> Vec<f32> {
    let each = points.into_iter().flat_map(DVec3::to_array);
    each.map(|number| number as f32).collect()
}

/// The times as 32-bit numbers, which must still increase.
fn times(all: &[f64], what: &str) -> Result<Vec<f32>, WriteError> {
    let rounded: Vec<f32> = all.iter().map(|time| *time as f32).collect();
    fits(&rounded, what)?;
    if rounded.is_empty() {
        return Err(WriteError::Refused {
            what: format!("{what} has no keys"),
            mend: "give at least one".to_owned(),
        });
    }
    if let Some(i) = rounded.windows(2).position(|pair| pair[1] <= pair[0]) {
        return Err(WriteError::DoesNotFit {
            what: format!(
                "the times {} and {} of {what} are the same in the 32-bit numbers of glTF",
                all[i],
                all[i + 1]
            ),
            mend: "take fewer frames a second, or a shorter motion",
        });
    }
    Ok(rounded)
}

fn quaternion(q: DQuat) -> [f64; 4] {
    [q.x, q.y, q.z, q.w]
}

/// Writes a new GLB file: the moving node, and the path as a line.
///
/// # Errors
///
/// Tracks without keys, times that are the same in 32-bit numbers, numbers beyond what 32 bits hold, more than 4 GB; nothing is
/// written then. Else what the receiver says.
pub fn write_motion(moving: &MovingNode<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    let mut buffer = Buffer::default();
    let corners = of_points(moving.triangles.iter().flatten());
    fits(&corners, "the shape")?;
    let normals = moving.triangles.iter().flat_map(|[a, b, c]| {
        let normal = (*b - *a).cross(*c - *a).normalize_or(DVec3::Z);
        [normal; 3]
    });
    let normals = of_points(&normals.collect::<Vec<_>>());
    let shape = buffer.add(&corners, 3, true, true);
    let facing = buffer.add(&normals, 3, true, false);
    let line = if moving.path.len() > 1 {
        let points = of_points(moving.path);
        fits(&points, "the path")?;
        Some(buffer.add(&points, 3, true, true))
    } else {
        None
    };

    let moved = times(&moving.translation.times(), "the translation")?;
    let moved = buffer.add(&moved, 1, false, true);
    let places: Vec<f32> = match &moving.translation {
        Track::Linear(keys) => of_points(keys.iter().map(|key| &key.1)),
        Track::Cubic(keys) => of_points(keys.iter().flat_map(|key| &key.1)),
    };
    fits(&places, "the translation")?;
    let places_view = buffer.add(&places, 3, false, false);
    let turned = times(&moving.rotation.times(), "the rotation")?;
    let turned = buffer.add(&turned, 1, false, true);
    let turns: Vec<f32> = match &moving.rotation {
        Track::Linear(keys) => keys
            .iter()
            .flat_map(|key| quaternion(key.1))
            .map(|n| n as f32)
            .collect(),
        Track::Cubic(keys) => keys
            .iter()
            .flat_map(|key| key.1.map(quaternion).concat())
            .map(|n| n as f32)
            .collect(),
    };
    fits(&turns, "the rotation")?;
    let turns_view = buffer.add(&turns, 4, false, false);

    // Where it is before anything moves: at the first key.
    let skip = |cubic: bool, width: usize| if cubic { width } else { 0 };
    let first = |numbers: &[f32], cubic: bool, width: usize| {
        let from = skip(cubic, width);
        let each = numbers[from..from + width]
            .iter()
            .map(|n| format!("{:?}", f64::from(*n)));
        each.collect::<Vec<_>>().join(",")
    };
    let start = first(&places, matches!(moving.translation, Track::Cubic(_)), 3);
    let turn = first(&turns, matches!(moving.rotation, Track::Cubic(_)), 4);

    let name = escaped(moving.name);
    let camera = if moving.camera.is_some() {
        r#","camera":0"#
    } else {
        ""
    };
    let mut nodes = vec![format!(
        r#"{{"name":"{name}","mesh":0{camera},"translation":[{start}],"rotation":[{turn}]}}"#
    )];
    let mut meshes = vec![format!(
        r#"{{"name":"{name}","primitives":[{{"attributes":{{"POSITION":{shape},"NORMAL":{facing}}},"material":0}}]}}"#
    )];
    if let Some(line) = line {
        nodes.push(r#"{"name":"path","mesh":1}"#.to_owned());
        // Mode 3: one line from point to point.
        meshes.push(format!(
            r#"{{"name":"path","primitives":[{{"attributes":{{"POSITION":{line}}},"mode":3,"material":1}}]}}"#
        ));
    }
    let scene: Vec<String> = (0..nodes.len()).map(|i| i.to_string()).collect();
    let cameras = moving.camera.map_or(String::new(), |angle| {
        format!(r#","cameras":[{{"type":"perspective","perspective":{{"yfov":{angle:?},"znear":0.01}}}}]"#)
    });
    let extras = if moving.extras.is_empty() {
        String::new()
    } else {
        format!(r#","extras":{}"#, moving.extras)
    };
    let (accessors, views) = described(&buffer);
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0","generator":"anamorph {}"{extras}}},"scene":0,"scenes":[{{"nodes":[{}]}}],"nodes":[{}],"meshes":[{}],"materials":[{{"name":"{name}","doubleSided":true,"pbrMetallicRoughness":{{"baseColorFactor":[0.13,0.36,0.72,1.0],"metallicFactor":0.0,"roughnessFactor":0.6}}}},{{"name":"path","pbrMetallicRoughness":{{"baseColorFactor":[0.75,0.3,0.05,1.0],"metallicFactor":0.0,"roughnessFactor":1.0}},"emissiveFactor":[0.35,0.14,0.02]}}]{cameras},"animations":[{{"name":"motion","samplers":[{{"input":{moved},"output":{places_view},"interpolation":"{}"}},{{"input":{turned},"output":{turns_view},"interpolation":"{}"}}],"channels":[{{"sampler":0,"target":{{"node":0,"path":"translation"}}}},{{"sampler":1,"target":{{"node":0,"path":"rotation"}}}}]}}],"accessors":[{accessors}],"bufferViews":[{views}],"buffers":[{{"byteLength":{}}}]}}"#,
        env!("CARGO_PKG_VERSION"),
        scene.join(","),
        nodes.join(","),
        meshes.join(","),
        moving.translation.interpolation(),
        moving.rotation.interpolation(),
        buffer.bytes.len()
    );
    while !json.len().is_multiple_of(4) {
        json.push(' ');
    }
    let total = 12 + 8 + json.len() + 8 + buffer.bytes.len();
    let Ok(total) = u32::try_from(total) else {
        return Err(WriteError::DoesNotFit {
            what: format!("the motion takes {total} bytes, and a GLB file at most 4294967295"),
            mend: "take fewer frames",
        });
    };
    out.write_all(b"glTF")?;
    for value in [2, total, json.len() as u32] {
        out.write_all(&value.to_le_bytes())?;
    }
    out.write_all(b"JSON")?;
    out.write_all(json.as_bytes())?;
    out.write_all(&(buffer.bytes.len() as u32).to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    out.write_all(&buffer.bytes)?;
    Ok(())
}

/// The text inside quotes of JSON.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// The accessors and the views of a buffer.
fn described(buffer: &Buffer) -> (String, String) {
    let (mut accessors, mut views) = (Vec::new(), Vec::new());
    for (i, view) in buffer.views.iter().enumerate() {
        // 5126: 32-bit numbers; 34962: vertices.
        accessors.push(format!(
            r#"{{"bufferView":{i},"componentType":5126,"count":{},"type":"{}"{}}}"#,
            view.count, view.kind, view.bounds
        ));
        let target = if view.vertices {
            r#","target":34962"#
        } else {
            ""
        };
        views.push(format!(
            r#"{{"buffer":0,"byteOffset":{},"byteLength":{}{target}}}"#,
            view.offset, view.length
        ));
    }
    (accessors.join(","), views.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Format, ReadOptions};

    fn moving(translation: Track<DVec3>) -> MovingNode<'static> {
        MovingNode {
            name: "a \"thing\"",
            triangles: &[[DVec3::ZERO, DVec3::X, DVec3::Y]],
            translation,
            rotation: Track::Linear(vec![(0.0, DQuat::IDENTITY)]),
            camera: None,
            path: &[DVec3::ZERO, DVec3::X],
            extras: String::new(),
        }
    }

    #[test]
    fn the_file_is_read_back() {
        let keys = vec![
            (0.0, [DVec3::ZERO, DVec3::X, DVec3::Y]),
            (1.5, [DVec3::Y, DVec3::Z, DVec3::ZERO]),
        ];
        let mut file = Vec::new();
        let mut node = moving(Track::Cubic(keys));
        node.camera = Some(0.8);
        write_motion(&node, &mut file).unwrap();
        assert_eq!(
            u32::from_le_bytes(file[8..12].try_into().unwrap()) as usize,
            file.len()
        );
        let document = super::super::gltf::Glb
            .read(file, &ReadOptions::default())
            .unwrap();
        // The shape stands where the first key puts it, beside the path.
        assert_eq!(document.points().len(), 5);
        assert!(
            document
                .notes()
                .iter()
                .all(|note| !note.contains("damaged"))
        );
    }

    #[test]
    fn what_32_bits_cannot_tell_apart_is_refused() {
        let near = vec![(1e6, DVec3::ZERO), (1e6 + 1e-3, DVec3::X)];
        let cases = [
            (near, "the same in the 32-bit"),
            (vec![], "no keys"),
            (vec![(0.0, DVec3::splat(1e39))], "beyond what 32 bits hold"),
        ];
        for (keys, says) in cases {
            let mut file = Vec::new();
            let error = write_motion(&moving(Track::Linear(keys)), &mut file).unwrap_err();
            assert!(error.to_string().contains(says), "{error}");
            assert!(file.is_empty());
        }
    }
}
