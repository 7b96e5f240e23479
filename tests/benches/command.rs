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

criterion_group!(benches, whole, ply);
criterion_main!(benches);
