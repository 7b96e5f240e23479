//! Laws over the fixtures, and what each of them is for.

use super::scene::Job;
use super::{Glb, Gltf, Model};
use crate::{
    Companions, Document, Format, Moved, Normals, Points, ReadErrorKind, ReadOptions, WriteError,
};
use anamorph_core::glam::{DMat3, DVec3};
use serde_json::Value;
use std::path::PathBuf;

const FIXTURES: [&str; 6] = [
    "gltf-external.gltf",
    "gltf-instances.glb",
    "gltf-interleaved.glb",
    "gltf-quantized.glb",
    "gltf-skinned-morph.glb",
    "gltf-sparse.gltf",
];

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/valid")
}

struct Beside;

impl Companions for Beside {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        std::fs::read(folder().join(name)).map_err(|error| error.to_string())
    }
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(folder().join(name)).unwrap()
}

fn format(name: &str) -> &'static dyn Format {
    if name.ends_with(".glb") { &Glb } else { &Gltf }
}

fn read_bytes(name: &str, bytes: Vec<u8>, local: bool) -> Box<dyn Document> {
    let options = ReadOptions::default().local(local);
    format(name).read_with(bytes, &options, &Beside).unwrap()
}

fn read(name: &str) -> Box<dyn Document> {
    read_bytes(name, bytes(name), false)
}

fn points(document: &dyn Document) -> Vec<DVec3> {
    match document.points() {
        Points::Solid(points) => points.to_vec(),
        Points::Plane(_) => panic!("in the plane"),
    }
}

fn write(document: &dyn Document, moved: &Moved<'_>) -> Vec<u8> {
    let mut out = Vec::new();
    let report = document.write(moved, &mut out).unwrap();
    assert_eq!(report.bytes, out.len() as u64);
    out
}

/// The JSON and the binary chunk.
fn parts(bytes: &[u8]) -> (Value, Vec<u8>) {
    if bytes.starts_with(b"glTF") {
        let found = super::container::chunks(bytes).unwrap();
        let bin = found.bin.map_or(Vec::new(), |range| bytes[range].to_vec());
        (serde_json::from_slice(&bytes[found.json]).unwrap(), bin)
    } else {
        (serde_json::from_slice(bytes).unwrap(), Vec::new())
    }
}

fn bend(p: DVec3) -> DVec3 {
    DVec3::new(
        p.x + 0.3 * p.y * p.z + 0.25,
        1.5 * p.y - 0.2 * p.x * p.x,
        p.z + 0.1 * p.x * p.y,
    )
}

/// What is read from `written` stands where `moved` says, to the rounding of single precision on both ways.
fn assert_read_back(name: &str, written: Vec<u8>, local: bool, moved: &[DVec3]) {
    let again = points(read_bytes(name, written, local).as_ref());
    assert_eq!(again.len(), moved.len(), "{name}");
    for (i, (a, b)) in again.iter().zip(moved).enumerate() {
        // Two stored numbers make a morphed point, and matrices magnify by at most their norm.
        let allowed = 4e-7 * (1.0 + b.length()) * 4.0;
        assert!(a.distance(*b) <= allowed, "{name}, point {i}: {a} and {b}");
    }
}

#[test]
fn what_does_not_move_is_written_byte_for_byte() {
    for name in FIXTURES {
        for local in [false, true] {
            let document = read_bytes(name, bytes(name), local);
            let same = points(document.as_ref());
            let turn = |_: usize, direction: DVec3| direction;
            let moved = Moved::new(Points::Solid(&same))
                .with_normals(Normals::Transform(&turn))
                .with_tangents(&turn);
            assert!(write(document.as_ref(), &moved) == bytes(name), "{name}");
            let moved = Moved::new(Points::Solid(&same)).with_normals(Normals::Recompute);
            assert!(write(document.as_ref(), &moved) == bytes(name), "{name}");
        }
    }
}

#[test]
fn what_moves_is_read_back_where_it_went() {
    for name in FIXTURES {
        for local in [false, true] {
            let document = read_bytes(name, bytes(name), local);
            let moved: Vec<DVec3> = points(document.as_ref()).into_iter().map(bend).collect();
            let written = write(document.as_ref(), &Moved::new(Points::Solid(&moved)));
            assert_read_back(name, written.clone(), local, &moved);
            // What was written is as good an input as what was read.
            let again = read_bytes(name, written, local);
            let twice: Vec<DVec3> = points(again.as_ref()).into_iter().map(bend).collect();
            let written = write(again.as_ref(), &Moved::new(Points::Solid(&twice)));
            assert_read_back(name, written, local, &twice);
        }
    }
}

#[test]
fn points_are_those_that_another_reader_finds() {
    for name in FIXTURES {
        let other = gltf::Gltf::from_slice(&bytes(name));
        // It knows neither quantized attributes nor required extensions.
        if name == "gltf-quantized.glb" {
            assert!(other.is_err());
            continue;
        }
        let other = other.unwrap();
        let document = read_bytes(name, bytes(name), true);
        let ours = points(document.as_ref());
        let buffers: Vec<Vec<u8>> = other
            .buffers()
            .map(|buffer| match buffer.source() {
                gltf::buffer::Source::Bin => other.blob.clone().unwrap(),
                gltf::buffer::Source::Uri(uri) => super::container::decoded(uri)
                    .or_else(|_| Beside.read(&uri.replace("%2D", "-")).map_err(|_| ""))
                    .unwrap(),
            })
            .collect();
        let mut theirs = Vec::new();
        for mesh in other.meshes() {
            let mut seen = Vec::new();
            for primitive in mesh.primitives() {
                let accessor = primitive.get(&gltf::Semantic::Positions).unwrap().index();
                if seen.contains(&accessor) {
                    continue;
                }
                seen.push(accessor);
                let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
                theirs.extend(reader.read_positions().unwrap());
            }
        }
        let ours: Vec<[f32; 3]> = ours[..document.visible()]
            .iter()
            .map(|p| p.as_vec3().to_array())
            .collect();
        assert_eq!(ours, theirs, "{name}");
    }
}

/// All bounds of accessors in a file are those of its numbers; every vertex attribute that needs them has them.
#[test]
fn bounds_are_exact() {
    for name in FIXTURES {
        let document = read(name);
        let moved: Vec<DVec3> = points(document.as_ref()).into_iter().map(bend).collect();
        let written = write(document.as_ref(), &Moved::new(Points::Solid(&moved)));
        let model = model(name, written.clone());
        let (json, _) = parts(&written);
        let data = model.data();
        let mut checked = 0;
        for mesh in &model.meshes {
            for found in &mesh.uses {
                let stored = &json["accessors"][found.accessor];
                if !matches!(
                    mesh.jobs[found.job],
                    Job::Position { .. } | Job::DeltaPosition { .. }
                ) {
                    continue;
                }
                let values: Vec<[f32; 3]> = model.accessors[found.accessor].elements(&data);
                for (axis, (key, pick)) in (0..3).flat_map(|a| {
                    [
                        (a, ("min", f32::min as fn(f32, f32) -> f32)),
                        (a, ("max", f32::max)),
                    ]
                }) {
                    let exact = values.iter().map(|v| v[axis]).reduce(pick).unwrap();
                    let written = stored[key][axis].as_f64().unwrap() as f32;
                    assert_eq!(written, exact, "{name} {key} {axis}");
                    checked += 1;
                }
            }
        }
        assert!(checked >= 6, "{name}");
    }
}

fn model(name: &str, bytes: Vec<u8>) -> Model {
    let options = ReadOptions::default();
    if name.ends_with(".glb") {
        let chunks = super::container::chunks(&bytes).unwrap();
        let json = super::Json::read(bytes[chunks.json.clone()].to_vec()).unwrap();
        Model::read("glb", bytes, Some(chunks), json, &options, &Beside).unwrap()
    } else {
        let json = super::Json::read(bytes).unwrap();
        Model::read("gltf", Vec::new(), None, json, &options, &Beside).unwrap()
    }
}

/// Removes what may change and compares the rest.
fn assert_same_but(name: &str, before: &Value, after: &Value, path: &str) {
    let key = path.rsplit('/').next().unwrap_or("");
    match (before, after) {
        (Value::Object(a), Value::Object(b)) => {
            for (key, value) in a {
                let path = format!("{path}/{key}");
                match b.get(key) {
                    Some(other) => assert_same_but(name, value, other, &path),
                    None => assert!(
                        ["byteOffset", "normalized", "sparse"].contains(&key.as_str()),
                        "{name}: {path} is gone"
                    ),
                }
            }
        }
        (Value::Array(a), Value::Array(b)) if !["min", "max"].contains(&key) => {
            assert!(a.len() <= b.len(), "{name}: {path}");
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                assert_same_but(name, a, b, &format!("{path}/{i}"));
            }
        }
        _ => {
            let may = [
                "min",
                "max",
                "bufferView",
                "componentType",
                "uri",
                "byteLength",
                "mesh",
                "POSITION",
            ];
            assert!(before == after || may.contains(&key), "{name}: {path}");
        }
    }
}

#[test]
fn all_else_in_the_json_stays() {
    for name in FIXTURES {
        let document = read(name);
        let moved: Vec<DVec3> = points(document.as_ref()).into_iter().map(bend).collect();
        let written = write(document.as_ref(), &Moved::new(Points::Solid(&moved)));
        let ((before, _), (after, _)) = (parts(&bytes(name)), parts(&written));
        assert_same_but(name, &before, &after, "");
        let text = String::from_utf8_lossy(&written);
        if name == "gltf-instances.glb" {
            // Numbers as they were written, and the chunk that nobody knows.
            assert!(text.contains("\"numbers\": [1.0, 0.002]"));
            assert!(text.contains("whatever"));
        }
    }
}

#[test]
fn instances_that_differ_get_meshes_of_their_own() {
    let name = "gltf-instances.glb";
    let document = read(name);
    let old = points(document.as_ref());
    // A twin, an instance under a turned and stretched node, a mirrored one: 24 points each; then the second mesh, the third.
    assert_eq!(old.len(), 6 * 24);
    let moved: Vec<DVec3> = old.iter().copied().map(bend).collect();
    let written = write(document.as_ref(), &Moved::new(Points::Solid(&moved)));
    let (json, _) = parts(&written);
    let meshes: Vec<u64> = [0, 1, 3, 4, 5]
        .map(|node: usize| json["nodes"][node]["mesh"].as_u64().unwrap())
        .to_vec();
    assert_eq!(meshes, [0, 0, 3, 4, 1]);
    assert_eq!(json["meshes"][3]["name"], "cube (stretched)");
    assert_eq!(json["meshes"][4]["extras"], json["meshes"][0]["extras"]);
    assert_eq!(json["meshes"].as_array().unwrap().len(), 5);
    // The indices are still shared, the positions of the three versions are not.
    let primitive = |mesh: usize, key: &str| json["meshes"][mesh]["primitives"][0][key].clone();
    assert_eq!(primitive(0, "indices"), primitive(4, "indices"));
    let mut positions: Vec<u64> = (0..5)
        .map(|mesh| primitive(mesh, "attributes")["POSITION"].as_u64().unwrap())
        .collect();
    positions.sort_unstable();
    positions.dedup();
    // The mesh of no node goes with the first.
    assert_eq!(positions.len(), 4);

    // Only the third moves: the others keep what they have.
    let mut moved = old.clone();
    moved[48..72].iter_mut().for_each(|p| *p += DVec3::X);
    let written = write(document.as_ref(), &Moved::new(Points::Solid(&moved)));
    assert_read_back(name, written.clone(), false, &moved);
    let ((before, bin), (after, new)) = (parts(&bytes(name)), parts(&written));
    assert_eq!(after["nodes"][0]["mesh"], 0);
    assert_eq!(after["nodes"][3]["mesh"], 3);
    assert_eq!(after["meshes"][0], before["meshes"][0]);
    assert!(new.starts_with(&bin));
}

#[test]
fn in_local_space_nothing_is_split() {
    let name = "gltf-instances.glb";
    let document = read_bytes(name, bytes(name), true);
    let moved: Vec<DVec3> = points(document.as_ref()).into_iter().map(bend).collect();
    assert_eq!(moved.len(), 3 * 24);
    let written = write(document.as_ref(), &Moved::new(Points::Solid(&moved)));
    // The three meshes have one accessor of positions, and still do.
    assert_eq!(written.len() % 4, 0);
    let (json, bin) = parts(&written);
    assert_eq!(json["meshes"].as_array().unwrap().len(), 3);
    assert_eq!(bin.len(), parts(&bytes(name)).1.len());
}

/// A linear map, with a mirror in it: normals go by the cofactor matrix, tangents by the matrix, `w` turns round.
#[test]
fn directions_follow_linear_maps_exactly_in_any_frame() {
    let map = DMat3::from_cols(
        DVec3::new(-1.0, 0.2, 0.0),
        DVec3::new(0.3, 1.5, 0.1),
        DVec3::new(0.0, -0.4, 0.8),
    );
    assert!(map.determinant() < 0.0);
    let cofactor = map.inverse().transpose() * map.determinant();
    let name = "gltf-instances.glb";
    let old = model(name, bytes(name));
    let moved: Vec<DVec3> = old.points.iter().map(|p| map * *p).collect();
    let normal = |_: usize, n: DVec3| {
        assert!((n.length() - 1.0).abs() < 1e-9);
        (cofactor * n).normalize()
    };
    let tangent = |_: usize, t: DVec3| (map * t).normalize();
    let moved = Moved::new(Points::Solid(&moved))
        .with_normals(Normals::Transform(&normal))
        .with_tangents(&tangent);
    let new = model(name, write(&old, &moved));
    let mut checked = 0;
    for (before, after) in old.instances.iter().zip(&new.instances) {
        let directions = |model: &Model, instance: &super::Instance| {
            let mesh = &model.meshes[instance.mesh];
            let world = instance.world.map_or(DMat3::IDENTITY, |w| {
                DMat3::from_cols(w.x_axis, w.y_axis, w.z_axis)
            });
            let mut normals: Vec<DVec3> = Vec::new();
            let mut tangents: Vec<(DVec3, f32)> = Vec::new();
            for job in &mesh.jobs {
                match job {
                    Job::Normal { accessor, .. } => {
                        let list: Vec<[f64; 3]> =
                            model.accessors[*accessor].elements(&model.data());
                        let out = world.inverse().transpose();
                        normals = list
                            .iter()
                            .map(|n| (out * DVec3::from_array(*n)).normalize())
                            .collect();
                        assert!(
                            list.iter()
                                .all(|n| (DVec3::from_array(*n).length() - 1.0).abs() < 1e-6)
                        );
                    }
                    Job::Tangent { accessor, .. } => {
                        let list: Vec<[f32; 4]> =
                            model.accessors[*accessor].elements(&model.data());
                        tangents = list
                            .iter()
                            .map(|t| {
                                let t3 =
                                    DVec3::new(f64::from(t[0]), f64::from(t[1]), f64::from(t[2]));
                                ((world * t3).normalize(), t[3])
                            })
                            .collect();
                    }
                    _ => {}
                }
            }
            (normals, tangents)
        };
        let (n0, t0) = directions(&old, before);
        let (n1, t1) = directions(&new, after);
        for (a, b) in n0.iter().zip(&n1) {
            assert!(((cofactor * *a).normalize() - *b).length() < 1e-5);
            checked += 1;
        }
        for (a, b) in t0.iter().zip(&t1) {
            assert!(((map * a.0).normalize() - b.0).length() < 1e-5);
            assert_eq!(a.1, -b.1);
            checked += 1;
        }
    }
    assert_eq!(checked, 5 * 24 + 4 * 24);
}

#[test]
fn recomputed_normals_are_those_of_the_moved_faces() {
    // A cube turned by a map that keeps its faces flat.
    let map = |p: DVec3| DVec3::new(p.y, 2.0 * p.x + 0.5 * p.z, p.z);
    for name in [
        "gltf-interleaved.glb",
        "gltf-quantized.glb",
        "gltf-instances.glb",
    ] {
        let old = model(name, bytes(name));
        let moved: Vec<DVec3> = old.points.iter().copied().map(map).collect();
        let moved = Moved::new(Points::Solid(&moved)).with_normals(Normals::Recompute);
        let new = model(name, write(&old, &moved));
        for instance in &new.instances {
            let mesh = &new.meshes[instance.mesh];
            for primitive in mesh.primitives.iter().filter(|p| p.normal.is_some()) {
                let slot = primitive.slot.unwrap();
                let corners = new.corners(primitive, 24).unwrap();
                let data = new.data();
                let normals: Vec<[f64; 3]> =
                    new.accessors[primitive.normal.unwrap()].elements(&data);
                let places: Vec<[f64; 3]> = new.accessors[mesh.slots[slot]].elements(&data);
                let at = |list: &[[f64; 3]], v: u32| DVec3::from_array(list[v as usize]);
                for face in Model::primitive_triangles(primitive, &corners) {
                    let [a, b, c] = face.map(|v| at(&places, v));
                    let flat = (b - a).cross(c - a).normalize();
                    // The map mirrors, so faces turn inside out, and normals with them.
                    for v in face {
                        assert!((at(&normals, v) - flat).length() < 1e-5, "{name}");
                    }
                }
            }
        }
    }
}

#[test]
fn morph_targets_lead_to_the_warped_places_with_carried_normals() {
    let name = "gltf-skinned-morph.glb";
    let old = model(name, bytes(name));
    // The bind pose is upright and twice as large, though the skeleton lies down.
    let high = old.points[..old.visible]
        .iter()
        .map(|p| p.y)
        .fold(0.0, f64::max);
    assert!((high - 4.0).abs() < 1e-5, "{high}");
    // All but the rows where the bulge has died out to exactly zero.
    assert!(old.points.len() > old.visible + 12);
    assert!(old.notes().iter().any(|note| note.contains("bind pose")));

    // A linear map for which the normals of the morphed shape are known.
    let map = DMat3::from_cols(DVec3::X * 3.0, DVec3::Y, DVec3::new(0.5, 0.0, 1.0));
    let cofactor = map.inverse().transpose() * map.determinant();
    let moved: Vec<DVec3> = old.points.iter().map(|p| map * *p).collect();
    let normal = |_: usize, n: DVec3| (cofactor * n).normalize();
    let moved = Moved::new(Points::Solid(&moved)).with_normals(Normals::Transform(&normal));
    let new = model(name, write(&old, &moved));
    let sum = |model: &Model, base: usize, delta: usize| -> Vec<DVec3> {
        let data = model.data();
        let base: Vec<[f64; 3]> = model.accessors[base].elements(&data);
        let delta: Vec<[f64; 3]> = model.accessors[delta].elements(&data);
        base.iter()
            .zip(&delta)
            .map(|(b, d)| DVec3::from_array(*b) + DVec3::from_array(*d))
            .collect()
    };
    let mut checked = 0;
    for (job, after) in old.meshes[0].jobs.iter().zip(&new.meshes[0].jobs) {
        let (
            Job::DeltaNormal {
                base: b0,
                accessor: d0,
                ..
            },
            Job::DeltaNormal {
                base: b1,
                accessor: d1,
                ..
            },
        ) = (job, after)
        else {
            continue;
        };
        for (a, b) in sum(&old, *b0, *d0).iter().zip(&sum(&new, *b1, *d1)) {
            let expected = (cofactor * a.normalize()).normalize() * a.length();
            assert!((expected - *b).length() < 2e-6, "{expected} {b}");
            checked += 1;
        }
    }
    assert_eq!(checked, 2 * 108);
}

#[test]
fn attributes_and_elements_fit_the_points() {
    for name in FIXTURES {
        let document = read(name);
        let count = document.points().len();
        for attribute in document.attributes() {
            assert_eq!(document.attribute(&attribute).unwrap().len(), count);
        }
        assert!(document.attribute("nothing").is_none());
        let mesh = document.mesh().unwrap();
        let corners = mesh
            .triangles
            .iter()
            .flatten()
            .chain(mesh.lines.iter().flatten());
        assert!(
            corners
                .chain(&mesh.points)
                .all(|v| (*v as usize) < document.visible())
        );
        assert!(document.inspect().problems.iter().all(|p| p.count > 0));
    }
    let boxed = read("gltf-interleaved.glb");
    assert_eq!(
        boxed.attributes(),
        ["red", "green", "blue", "alpha", "_HEIGHT"]
    );
    let red = boxed.attribute("red").unwrap();
    let at = points(boxed.as_ref());
    for (p, red) in at.iter().zip(&red) {
        assert!((*red - if p.x > 0.0 { 1.0 } else { 0.0 }).abs() < 1e-12);
    }
    assert_eq!(
        boxed.attribute("_HEIGHT").unwrap(),
        at.iter().map(|p| p.y).collect::<Vec<_>>()
    );
    let strips = read("gltf-external.gltf").mesh().unwrap();
    assert_eq!((strips.triangles.len(), strips.lines.len()), (6 + 4, 4));
    assert_eq!(strips.triangles[1], [1, 4, 5]);
    assert_eq!(
        read("gltf-external.gltf").companions(),
        ["gltf-external.bin", "gltf-external.png"]
    );
    // Mirrored instances keep their outside.
    let old = model("gltf-instances.glb", bytes("gltf-instances.glb"));
    let mesh = old.mesh().unwrap();
    for (i, t) in mesh.triangles.iter().enumerate().take(12 * 5) {
        let [a, b, c] = t.map(|v| old.points[v as usize]);
        let centre = old.points[i / 12 * 24..][..24].iter().sum::<DVec3>() / 24.0;
        assert!((b - a).cross(c - a).dot(a - centre) > 0.0, "triangle {i}");
    }
}

fn small(json: &str) -> Result<Box<dyn Document>, crate::ReadError> {
    Gltf.read(json.as_bytes().to_vec(), &ReadOptions::default())
}

/// A triangle whose JSON can be changed.
fn triangle(nodes: &str, more: &str) -> String {
    format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"nodes\":{nodes},\"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}}}}]}}],\
         \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]}}],\
         \"bufferViews\":[{{\"buffer\":0,\"byteLength\":36}}],\"buffers\":[{{\"byteLength\":36,\"uri\":\"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}}]{more}}}"
    )
}

#[test]
fn a_flat_node_is_refused_only_if_it_moves() {
    let document = small(&triangle(
        "[{\"mesh\":0,\"name\":\"pancake\",\"scale\":[1,0,1]}]",
        "",
    ))
    .unwrap();
    let mut moved = points(document.as_ref());
    assert!(!write(document.as_ref(), &Moved::new(Points::Solid(&moved))).is_empty());
    moved[1] += DVec3::Z;
    let error = document
        .write(&Moved::new(Points::Solid(&moved)), &mut Vec::new())
        .unwrap_err();
    assert!(matches!(error, WriteError::Refused { .. }));
    assert!(
        error.to_string().contains("nodes[0] (\"pancake\")"),
        "{error}"
    );
    // A small scale is no flat one.
    let document = small(&triangle(
        "[{\"mesh\":0,\"scale\":[1e-150,1e-150,1e-150]}]",
        "",
    ))
    .unwrap();
    let moved: Vec<DVec3> = points(document.as_ref()).iter().map(|p| *p * 2.0).collect();
    let again = small(
        &String::from_utf8(write(document.as_ref(), &Moved::new(Points::Solid(&moved)))).unwrap(),
    )
    .unwrap();
    assert_eq!(points(again.as_ref()), moved);
    // Beyond what single precision holds.
    let document = small(&triangle("[{\"mesh\":0}]", "")).unwrap();
    let moved = [DVec3::ZERO, DVec3::X * 1e39, DVec3::Y];
    let error = document.write(&Moved::new(Points::Solid(&moved)), &mut Vec::new());
    assert!(
        error
            .unwrap_err()
            .to_string()
            .contains("beyond the numbers")
    );
}

#[test]
fn what_cannot_be_right_is_said() {
    let cases: &[(&str, &str, ReadErrorKind, &str)] = &[
        (
            "[{\"mesh\":1}]",
            "",
            ReadErrorKind::Reference,
            "nodes[0] has mesh 1",
        ),
        (
            "[{\"mesh\":0,\"children\":[1]},{\"children\":[0]}]",
            "",
            ReadErrorKind::Scene,
            "ancestors",
        ),
        (
            "[{\"children\":[2]},{\"children\":[2]},{\"mesh\":0}]",
            "",
            ReadErrorKind::Scene,
            "child of both nodes[0] and nodes[1]",
        ),
        (
            "[{\"children\":[7]}]",
            "",
            ReadErrorKind::Reference,
            "child 7",
        ),
        (
            "[{\"mesh\":0,\"rotation\":[0,0,0,0]}]",
            "",
            ReadErrorKind::Scene,
            "quaternion",
        ),
        (
            "[{\"mesh\":0,\"matrix\":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}]",
            "",
            ReadErrorKind::Scene,
            "last row",
        ),
        (
            "[{\"mesh\":0,\"scale\":[1,1]}]",
            "",
            ReadErrorKind::Shape,
            "3 finite numbers",
        ),
        (
            "[{\"mesh\":0,\"skin\":0}]",
            "",
            ReadErrorKind::Reference,
            "skin 0",
        ),
        (
            "[{\"mesh\":0}]",
            ",\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]",
            ReadErrorKind::Unsupported,
            "KHR_draco_mesh_compression",
        ),
        (
            "[{\"mesh\":0}]",
            ",\"extensionsRequired\":[\"EXT_meshopt_compression\"]",
            ReadErrorKind::Unsupported,
            "EXT_meshopt_compression",
        ),
    ];
    for (nodes, more, kind, words) in cases {
        let error = small(&triangle(nodes, more)).err().unwrap();
        assert_eq!(error.kind, *kind, "{error}");
        assert!(error.to_string().contains(words), "{error}");
    }
    let whole = triangle("[{\"mesh\":0}]", "");
    assert!(small(&whole).is_ok());
    let changed: &[(&str, &str, ReadErrorKind)] = &[
        ("\"count\":3", "\"count\":4", ReadErrorKind::Reference),
        (
            "\"count\":3",
            "\"count\":18446744073709551615",
            ReadErrorKind::Reference,
        ),
        ("\"count\":3", "\"count\":-3", ReadErrorKind::Shape),
        (
            "\"componentType\":5126",
            "\"componentType\":5124",
            ReadErrorKind::Unsupported,
        ),
        ("\"bufferView\":0,\"comp", "\"comp", ReadErrorKind::NoPoints),
        (
            "\"byteLength\":36}",
            "\"byteLength\":37}",
            ReadErrorKind::Reference,
        ),
        (
            "\"byteLength\":36,\"uri",
            "\"byteLength\":360,\"uri",
            ReadErrorKind::Reference,
        ),
        ("base64,AAAA", "base64,A!AA", ReadErrorKind::Encoding),
        (
            "\"uri\":\"data:",
            "\"uri\":\"https:",
            ReadErrorKind::Companion,
        ),
        (
            "\"uri\":\"data:;base64,",
            "\"uri\":\"",
            ReadErrorKind::Companion,
        ),
        ("\"POSITION\":0", "\"POSITION\":1", ReadErrorKind::Reference),
        ("\"2.0\"", "\"1.0\"", ReadErrorKind::Unsupported),
        ("\"asset\"", "\"assets\"", ReadErrorKind::Header),
        ("AAAAAACAPw", "AAAAAACAfw", ReadErrorKind::NonFinite),
    ];
    for (from, to, kind) in changed {
        assert!(whole.contains(from), "{from}");
        match small(&whole.replacen(from, to, 1)) {
            Err(error) => assert_eq!(error.kind, *kind, "{to}: {error}"),
            // Zeros are as good as any points.
            Ok(_) => assert_eq!(*kind, ReadErrorKind::NoPoints, "{to}"),
        }
    }
    // Counts without bytes behind them, and instances without end, are no reason to fill memory.
    let zeros = whole
        .replacen("\"bufferView\":0,\"comp", "\"comp", 1)
        .replacen("\"count\":3", "\"count\":4000000000", 1);
    assert_eq!(small(&zeros).err().unwrap().kind, ReadErrorKind::TooLarge);
}

/// Every cut and many flipped bits: an error or a document that can be asked and written, never a panic.
#[test]
fn damage_never_panics() {
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut random = move |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below as u64) as usize
    };
    let use_all = |name: &str, bytes: Vec<u8>| {
        let options = ReadOptions::for_inspection();
        let Ok(document) = format(name).read_with(bytes, &options, &Beside) else {
            return 0;
        };
        let moved: Vec<DVec3> = points(document.as_ref())
            .into_iter()
            .map(|p| {
                if p.is_finite() {
                    p * 1.5 + DVec3::ONE
                } else {
                    p
                }
            })
            .collect();
        let _ = document.inspect();
        let finite = |p: &DVec3| p.is_finite();
        if moved
            .iter()
            .zip(&points(document.as_ref()))
            .all(|(a, b)| finite(a) || !finite(b))
        {
            for normals in [Normals::Recompute, Normals::Transform(&|_, n| n + DVec3::X)] {
                let moved = Moved::new(Points::Solid(&moved))
                    .with_normals(normals)
                    .with_tangents(&|_, t| -t);
                let _ = document.write(&moved, &mut Vec::new());
            }
        }
        1
    };
    let mut read = 0;
    for name in FIXTURES {
        let whole = bytes(name);
        for cut in (0..whole.len()).step_by(whole.len() / 100 + 1) {
            use_all(name, whole[..cut].to_vec());
        }
        let head = whole.len().min(2500);
        for _ in 0..400 {
            let mut damaged = whole.clone();
            for _ in 0..=random(3) {
                let within = if random(3) == 0 { whole.len() } else { head };
                let at = random(within);
                damaged[at] = match random(4) {
                    0 => damaged[at] ^ (1 << random(8)),
                    1 => b'0' + random(10) as u8,
                    2 => random(256) as u8,
                    _ => b"{}[],:\"-e."[random(10)],
                };
            }
            read += use_all(name, damaged);
        }
    }
    assert!(read > 300, "{read}");
}
