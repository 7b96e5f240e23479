//! The two forms of glTF hold the same: what goes from one to the other and back has lost nothing.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::glam::DVec3;
use anamorph_io::{Companions, Document, Moved, Normals, Points, ReadOptions, read_with};
use std::path::{Path, PathBuf};

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/fixtures/valid")
}

/// Files beside the fixtures.
struct Beside;

impl Companions for Beside {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        std::fs::read(fixtures().join(name)).map_err(|error| error.to_string())
    }
}

fn read(bytes: Vec<u8>) -> Box<dyn Document> {
    read_with(bytes, None, &ReadOptions::default(), &Beside).unwrap()
}

fn points(document: &dyn Document) -> Vec<DVec3> {
    match document.points() {
        Points::Solid(points) => points.to_vec(),
        Points::Plane(_) => panic!("glTF is of space"),
    }
}

fn written(document: &dyn Document, form: &str, points: &[DVec3]) -> Vec<u8> {
    let mut out = Vec::new();
    let moved = Moved::new(Points::Solid(points)).with_normals(Normals::Recompute);
    document.write_as(form, &moved, &mut out).unwrap();
    out
}

/// Whether a GLB has chunks behind JSON and BIN.
fn has_own_chunks(bytes: &[u8]) -> bool {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    if !bytes.starts_with(b"glTF") {
        return false;
    }
    let bin = 20 + word(12);
    bin < bytes.len() && bin + 8 + word(bin) < bytes.len()
}

#[test]
fn chunks_of_ones_own_keep_a_model_binary() {
    let found = std::fs::read_dir(fixtures())
        .unwrap()
        .map(|file| file.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "glb"))
        .map(|path| std::fs::read(path).unwrap())
        .find(|bytes| has_own_chunks(bytes));
    let document = read(found.expect("a fixture has such chunks"));
    let moved = Moved::new(document.points());
    let error = document
        .write_as("gltf", &moved, &mut Vec::new())
        .unwrap_err();
    assert!(error.to_string().contains("only a GLB holds"));
}

fn all() -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for file in std::fs::read_dir(fixtures()).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_some_and(|e| e == "glb" || e == "gltf") {
            let bytes = std::fs::read(&path).unwrap();
            if !has_own_chunks(&bytes) {
                found.push((path.display().to_string(), bytes));
            }
        }
    }
    assert!(found.len() >= 5);
    found.sort();
    found
}

#[test]
fn sister_forms_hold_the_same_points() {
    for (name, bytes) in all() {
        let document = read(bytes);
        let [sister] = document.sisters() else {
            panic!("{name} has one sister");
        };
        let rest = points(document.as_ref());
        let moved: Vec<DVec3> = rest.iter().map(|p| *p * 2.0 + DVec3::X).collect();
        for target in [&rest, &moved] {
            let own = written(document.as_ref(), document.format(), target);
            let other = written(document.as_ref(), sister, target);
            let (own, other) = (read(own), read(other));
            assert_eq!(other.format(), *sister, "{name}");
            assert_eq!(points(own.as_ref()), points(other.as_ref()), "{name}");
            assert_eq!(own.mesh(), other.mesh(), "{name}");
            assert_eq!(own.attributes(), other.attributes(), "{name}");
            // And back again.
            let back = read(written(
                other.as_ref(),
                own.format(),
                &points(other.as_ref()),
            ));
            assert_eq!(points(own.as_ref()), points(back.as_ref()), "{name}");
        }
    }
}

/// The JSON of either form.
fn json(bytes: &[u8]) -> serde_json::Value {
    if bytes.starts_with(b"glTF") {
        let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        serde_json::from_slice(&bytes[20..20 + length]).unwrap()
    } else {
        serde_json::from_slice(bytes).unwrap()
    }
}

#[test]
fn nothing_but_the_first_buffer_changes() {
    for (name, bytes) in all() {
        let before = json(&bytes);
        let document = read(bytes);
        let other = written(
            document.as_ref(),
            document.sisters()[0],
            &points(document.as_ref()),
        );
        if let Some(rest) = other.strip_prefix(b"glTF") {
            let length = u32::from_le_bytes(rest[4..8].try_into().unwrap()) as usize;
            assert_eq!(length, other.len(), "{name}");
            assert_eq!(length % 4, 0, "{name}");
        }
        let mut after = json(&other);
        let mut expected = before.clone();
        for value in [&mut expected, &mut after] {
            if let Some(buffer) = value["buffers"][0].as_object_mut() {
                buffer.remove("uri");
            }
        }
        assert_eq!(expected, after, "{name}");
    }
}

fn converted(text: &str, form: &str) -> Vec<u8> {
    let document = read(text.as_bytes().to_vec());
    written(document.as_ref(), form, &points(document.as_ref()))
}

/// A triangle in a second buffer; the first holds what no mesh needs.
const UNNEEDED_FIRST: &str = r#"{"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"images":[{"bufferView":1,"mimeType":"image/png"}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[0,0,0]}],
"bufferViews":[{"buffer":1,"byteLength":36},{"buffer":0,"byteLength":5}],
"buffers":[{"byteLength":5,"uri":"data:application/octet-stream;base64,AQIDBAU="},
{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"}]}"#;

#[test]
fn a_buffer_that_no_mesh_needs_moves_too() {
    let glb = converted(UNNEEDED_FIRST, "glb");
    let json_length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    assert_eq!(&glb[20 + json_length + 8..][..5], [1, 2, 3, 4, 5]);
    assert!(json(&glb)["buffers"][0].get("uri").is_none());
    assert_eq!(read(glb).points().len(), 3);
}

#[test]
fn a_data_uri_with_percent_signs_is_written_in_base64() {
    let text = UNNEEDED_FIRST.replace(
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA",
        &format!("data:application/octet-stream,{}", "%00".repeat(36)),
    );
    let document = read(text.into_bytes());
    let moved: Vec<DVec3> = (0..3).map(|i| DVec3::splat(f64::from(i))).collect();
    let out = written(document.as_ref(), "gltf", &moved);
    let uri = json(&out)["buffers"][1]["uri"].as_str().unwrap().to_owned();
    assert!(
        uri.starts_with("data:application/octet-stream;base64,"),
        "{uri}"
    );
    assert_eq!(points(read(out).as_ref()), moved);
}

/// What other formats can hold of a scene, and what is named as lost.
#[test]
fn conversion_keeps_normals_and_names_the_rest() {
    for (name, bytes) in all() {
        let document = read(bytes);
        let moved = Moved::new(document.points());
        let geometry = document.geometry(&moved).unwrap();
        assert_eq!(geometry.points.len(), document.visible(), "{name}");
        if name.ends_with("skinned-morph.glb") {
            let named = geometry.beyond.join(", ");
            assert!(
                named.contains("morph target") && named.contains("skin"),
                "{named}"
            );
        }
        for normal in geometry.normals.pool() {
            assert!((normal.length() - 1.0).abs() < 1e-6, "{name}");
        }
        let mut out = Vec::new();
        let targets = anamorph_io::targets();
        let text = targets.iter().find(|target| target.name == "gltf").unwrap();
        text.create(&geometry, &mut out).unwrap();
        // Vertices may be others, corners are where they were.
        let corners = |document: &dyn Document| -> Vec<[[f32; 3]; 3]> {
            let places = points(document);
            let place = |i: u32| places[i as usize].to_array().map(|x| x as f32);
            let triangles = document.mesh().unwrap().triangles;
            triangles.iter().map(|t| t.map(place)).collect()
        };
        assert_eq!(
            corners(read(out).as_ref()),
            corners(document.as_ref()),
            "{name}"
        );
    }
}
