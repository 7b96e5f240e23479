//! The whole command on a large file, against loading the same file with `tobj`; and a binary PLY document in memory, against
//! copying its bytes and warping its points.

// A benchmark that cannot be set up has nothing to measure.
#![allow(clippy::unwrap_used)]

use anamorph_core::{Bounds, map_all_parallel};
use anamorph_io::{Moved, Points, ReadOptions};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

/// Vertices along each side of the sheet.
const SIDE: usize = 1000;

/// A wavy sheet of a million vertices and two million triangles as OBJ text.
fn sheet() -> String {
    let mut text = String::from("# a wavy sheet\no sheet\n");
    for i in 0..SIDE * SIDE {
        let (x, y) = ((i % SIDE) as f64 * 0.01, (i / SIDE) as f64 * 0.01);
        let _ = writeln!(
            text,
            "v {x:.6} {:.6} {y:.6}",
            (x * 1.3).sin() * (y * 0.7).cos()
        );
    }
    for row in 0..SIDE - 1 {
        for column in 0..SIDE - 1 {
            let a = row * SIDE + column + 1;
            let _ = writeln!(
                text,
                "f {a} {} {}\nf {a} {} {}",
                a + SIDE,
                a + SIDE + 1,
                a + SIDE + 1,
                a + 1
            );
        }
    }
    text
}

fn whole(criterion: &mut Criterion) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (model, output) = (folder.join("sheet.obj"), folder.join("sheet-warped.obj"));
    let text = sheet();
    std::fs::write(&model, &text).unwrap();
    let recipe = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/recipes/lattice.toml");
    let mut group = criterion.benchmark_group("Whole command, OBJ of a million vertices");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_secs(10));
    group.throughput(Throughput::Bytes(text.len() as u64));
    group.bench_function("baseline: tobj load", |bencher| {
        bencher.iter(|| {
            tobj::load_obj(&model, &tobj::LoadOptions::default())
                .unwrap()
                .0
                .len()
        });
    });
    group.bench_function("anamorph warp", |bencher| {
        bencher.iter(|| {
            anamorph_cli::run([
                "anamorph".as_ref(),
                "warp".as_ref(),
                model.as_os_str(),
                "--recipe".as_ref(),
                recipe.as_os_str(),
                "-o".as_ref(),
                output.as_os_str(),
                "--quiet".as_ref(),
                "--force".as_ref(),
            ])
        });
    });
    group.bench_function("plain copy of the file", |bencher| {
        bencher.iter(|| std::fs::copy(&model, &output).unwrap());
    });
    group.finish();
    let _ = std::fs::remove_file(&output);
}

/// The sheet as binary PLY.
fn binary_sheet() -> Vec<u8> {
    let faces = 2 * (SIDE - 1) * (SIDE - 1);
    let mut file = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nelement face {faces}\nproperty list uchar int vertex_indices\nend_header\n",
        SIDE * SIDE
    )
    .into_bytes();
    for i in 0..SIDE * SIDE {
        let (x, y) = ((i % SIDE) as f32 * 0.01, (i / SIDE) as f32 * 0.01);
        for value in [x, (x * 1.3).sin() * (y * 0.7).cos(), y] {
            file.extend(value.to_le_bytes());
        }
    }
    for row in 0..SIDE - 1 {
        for column in 0..SIDE - 1 {
            let a = (row * SIDE + column) as u32;
            let side = SIDE as u32;
            for corners in [[a, a + side, a + side + 1], [a, a + side + 1, a + 1]] {
                file.push(3);
                corners
                    .iter()
                    .for_each(|corner| file.extend(corner.to_le_bytes()));
            }
        }
    }
    file
}

/// Reading, warping and writing a binary PLY of a million vertices, all in memory.
fn ply(criterion: &mut Criterion) {
    let file = binary_sheet();
    let registry = anamorph_warps::registry::solid();
    let entry = registry.iter().find(|e| e.kind == "lattice").unwrap();
    let parameters = serde_json::json!({
        "shape": [4, 4, 4],
        "move": [{ "index": ["*", 3, "*"], "by": ["10%", "20%", "0%"] }],
    });
    let open = || anamorph_io::read(file.clone(), None, &ReadOptions::default()).unwrap();
    let document = open();
    let Points::Solid(points) = document.points() else {
        return;
    };
    let context = anamorph_catalog::Context::of_bounds(Bounds::of(points).unwrap());
    let warp = (entry.construct)(&parameters, &context).unwrap().warp;
    let mut out: Vec<u8> = Vec::with_capacity(file.len());

    let mut group = criterion.benchmark_group("Binary PLY of a million vertices");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_secs(3));
    group.throughput(Throughput::Bytes(file.len() as u64));
    group.bench_function("baseline: copy the bytes, warp the points", |bencher| {
        bencher.iter(|| {
            let copy = file.clone();
            let mut moved = points.to_vec();
            let _ = map_all_parallel(&warp, &mut moved, &|_| {});
            (copy.len(), moved.len())
        });
    });
    group.bench_function("read, warp, write", |bencher| {
        bencher.iter(|| {
            let document = open();
            let Points::Solid(points) = document.points() else {
                return 0;
            };
            let mut moved = points.to_vec();
            let _ = map_all_parallel(&warp, &mut moved, &|_| {});
            out.clear();
            let moved = Moved::new(Points::Solid(&moved));
            document.write(&moved, &mut out).unwrap().moved_points
        });
    });
    group.finish();
}

/// The same sheet as a GLB: positions, texture coordinates and indices.
fn sheet_glb() -> Vec<u8> {
    let (mut floats, mut textures): (Vec<f32>, Vec<f32>) = Default::default();
    for i in 0..SIDE * SIDE {
        let (x, y) = ((i % SIDE) as f64 * 0.01, (i / SIDE) as f64 * 0.01);
        let height = (x * 1.3).sin() * (y * 0.7).cos();
        floats.extend([x as f32, height as f32, y as f32]);
        textures.extend([x as f32, y as f32]);
    }
    let mut indices: Vec<u32> = Vec::new();
    for row in 0..SIDE - 1 {
        for column in 0..SIDE - 1 {
            let a = (row * SIDE + column) as u32;
            let below = a + SIDE as u32;
            indices.extend([a, below, below + 1, a, below + 1, a + 1]);
        }
    }
    let mut bin: Vec<u8> = Vec::new();
    let mut views = Vec::new();
    for list in [&floats, &textures] {
        views.push((bin.len(), list.len() * 4));
        bin.extend(list.iter().flat_map(|x| x.to_le_bytes()));
    }
    views.push((bin.len(), indices.len() * 4));
    bin.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
    let least = |axis: usize| {
        floats
            .iter()
            .skip(axis)
            .step_by(3)
            .copied()
            .fold(f32::MAX, f32::min)
    };
    let most = |axis: usize| {
        floats
            .iter()
            .skip(axis)
            .step_by(3)
            .copied()
            .fold(f32::MIN, f32::max)
    };
    let views: Vec<String> = views
        .iter()
        .map(|(start, length)| {
            format!("{{\"buffer\":0,\"byteOffset\":{start},\"byteLength\":{length}}}")
        })
        .collect();
    let count = SIDE * SIDE;
    let mut json = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scenes\":[{{\"nodes\":[0]}}],\"nodes\":[{{\"mesh\":0}}],\
         \"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0,\"TEXCOORD_0\":1}},\"indices\":2}}]}}],\
         \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":{count},\"type\":\"VEC3\",\"min\":[{},{},{}],\"max\":[{},{},{}]}},\
         {{\"bufferView\":1,\"componentType\":5126,\"count\":{count},\"type\":\"VEC2\"}},\
         {{\"bufferView\":2,\"componentType\":5125,\"count\":{},\"type\":\"SCALAR\"}}],\
         \"bufferViews\":[{}],\"buffers\":[{{\"byteLength\":{}}}]}}",
        least(0),
        least(1),
        least(2),
        most(0),
        most(1),
        most(2),
        indices.len(),
        views.join(","),
        bin.len()
    );
    while json.len() % 4 != 0 {
        json.push(' ');
    }
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((12 + 16 + json.len() as u32 + bin.len() as u32).to_le_bytes());
    out.extend((json.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(json.as_bytes());
    out.extend((bin.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(bin);
    out
}

fn binary(criterion: &mut Criterion) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (model, output) = (folder.join("sheet.glb"), folder.join("sheet-warped.glb"));
    let bytes = sheet_glb();
    std::fs::write(&model, &bytes).unwrap();
    let recipe = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/recipes/lattice.toml");
    let mut group = criterion.benchmark_group("Whole command, GLB of a million vertices");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(100))
        .measurement_time(Duration::from_secs(5));
    group.throughput(Throughput::Bytes(bytes.len() as u64));
    // What the task asks for at the least: the file's bytes read and written, and the points moved.
    let text = std::fs::read_to_string(&recipe).unwrap();
    let table: toml::Table = text.parse().unwrap();
    let parameters = {
        let mut warp = table["warp"][0].clone();
        warp.as_table_mut().unwrap().remove("kind");
        serde_json::to_value(warp).unwrap()
    };
    let mut rest: Vec<anamorph_core::Solid> = Vec::new();
    for i in 0..SIDE * SIDE {
        let (x, y) = ((i % SIDE) as f64 * 0.01, (i / SIDE) as f64 * 0.01);
        rest.push(anamorph_core::Solid::new(
            x,
            (x * 1.3).sin() * (y * 0.7).cos(),
            y,
        ));
    }
    let bounds = Bounds::of(&rest).unwrap();
    let entry = anamorph_tests::subjects::entry::<anamorph_core::Solid>("lattice");
    let warp = (entry.construct)(&parameters, &anamorph_catalog::Context::of_bounds(bounds))
        .map_err(|error| error.to_string())
        .unwrap()
        .warp;
    group.bench_function("baseline: a copy of the file and the warp", |bencher| {
        let mut points = rest.clone();
        bencher.iter(|| {
            points.copy_from_slice(&rest);
            let _ = map_all_parallel(&warp, &mut points, &|_| {});
            let bytes = std::fs::read(&model).unwrap();
            std::fs::write(&output, &bytes).unwrap();
        });
    });
    group.bench_function("anamorph warp", |bencher| {
        bencher.iter(|| {
            anamorph_cli::run([
                "anamorph".as_ref(),
                "warp".as_ref(),
                model.as_os_str(),
                "--recipe".as_ref(),
                recipe.as_os_str(),
                "-o".as_ref(),
                output.as_os_str(),
                "--quiet".as_ref(),
                "--force".as_ref(),
            ])
        });
    });
    group.finish();
    let _ = std::fs::remove_file(&output);
}

criterion_group!(benches, whole, ply, binary);
criterion_main!(benches);
