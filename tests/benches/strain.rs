//! Shapes that become one another by strain fields: the case of the paper, a larger one, and how the cost grows.
//!
//! Rows named `baseline` are as-rigid-as-possible in-betweens of the same frames; bars are in `bars.toml`.

// A benchmark that cannot be set up has nothing to measure.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::math;
use anamorph_morph::strain::{Element, Pair, Settings, Solver, method};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::time::Duration;

fn pool() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(2)
        .build()
        .unwrap()
}

/// A strip of triangles that is bent by 143°, grows and swells unevenly.
fn strip(columns: usize, rows: usize) -> Pair {
    let mut state = 0x1234_5678_9abc_def1_u64;
    let mut unit = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut source = Vec::new();
    for i in 0..=columns {
        for j in 0..=rows {
            let mut place = dvec2(i as f64, j as f64);
            if i > 0 && i < columns && j > 0 && j < rows {
                place += dvec2(unit(), unit()) * 0.3;
            }
            source.push(place * dvec2(5.0 / columns as f64, 1.0 / rows as f64));
        }
    }
    let target: Vec<DVec2> = source
        .iter()
        .map(|p| {
            let swell = (1.0 - p.y) * (1.0 + 0.3 * math::sin(3.0 * p.x));
            let radius = 2.0 + swell + 0.2 * math::cos(2.0 * p.x);
            let (sin, cos) = math::sin_cos(0.5 * p.x);
            dvec2(sin, -cos) * radius * 1.2
        })
        .collect();
    let at = |i: usize, j: usize| i * (rows + 1) + j;
    let mut elements: Vec<Element> = Vec::new();
    for i in 0..columns {
        for j in 0..rows {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            elements.push([a, b, c].into());
            elements.push([a, c, d].into());
        }
    }
    Pair::new(source, target, elements).unwrap()
}

/// Preparation and all frames.
fn whole(pair: &Pair, name: &str, settings: &Settings, frames: usize) -> f64 {
    let morph = method(name).unwrap().prepare(pair, settings).unwrap();
    let times: Vec<f64> = (1..=frames)
        .map(|k| k as f64 / (frames + 1) as f64)
        .collect();
    let frames = morph.frames(&times).unwrap();
    frames.iter().map(|frame| frame.positions[0].x).sum()
}

fn in_betweens(criterion: &mut Criterion) {
    let cases = [
        ("115 vertices, 180 in-betweens, 2 threads", 22, 4, 180),
        ("5 088 vertices, 60 in-betweens, 2 threads", 158, 31, 60),
    ];
    for (name, columns, rows, frames) in cases {
        let pair = strip(columns, rows);
        let mut group = criterion.benchmark_group(name);
        group
            .sample_size(10)
            .warm_up_time(Duration::from_millis(300))
            .measurement_time(Duration::from_secs(4))
            .throughput(Throughput::Elements(frames as u64));
        let pool = pool();
        let rows = [
            ("baseline: as-rigid-as-possible", "as-rigid-as-possible"),
            ("indifferent", "indifferent"),
            ("linear", "linear"),
            ("modified", "modified"),
            ("log", "log"),
        ];
        for (row, method) in rows {
            group.bench_function(row, |b| {
                b.iter(|| pool.install(|| whole(&pair, method, &Settings::default(), frames)));
            });
        }
        if frames == 180 {
            let chain = Settings {
                solver: Solver::Continuation,
                chain: 180,
                stages: 1,
                ..Settings::default()
            };
            group.bench_function("the paper's chain of frames, 1 thread", |b| {
                b.iter(|| whole(&pair, "indifferent", &chain, 180));
            });
        }
        group.finish();
    }
}

fn growth(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("One in-between, 1 thread");
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(4));
    for (name, columns, rows) in [
        ("1 065 vertices", 70, 14),
        ("9 945 vertices", 220, 44),
        ("98 841 vertices", 700, 140),
    ] {
        let pair = strip(columns, rows);
        group.throughput(Throughput::Elements(pair.source().len() as u64));
        let settings = Settings::default();
        let morph = method("indifferent")
            .unwrap()
            .prepare(&pair, &settings)
            .unwrap();
        group.bench_function(name, |b| b.iter(|| morph.at(0.5).unwrap()));
    }
    group.finish();
}

criterion_group!(benches, in_betweens, growth);
criterion_main!(benches);
