//! The whole command on a large file, against loading the same file with `tobj`.

// A benchmark that cannot be set up has nothing to measure.
#![allow(clippy::unwrap_used)]

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

criterion_group!(benches, whole);
criterion_main!(benches);
