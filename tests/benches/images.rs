//! Resampling against a copy of the pixels, and hierarchical maps against exact ones, in one run.
//!
//! Rows named `baseline` are what the others are divided by; bars are in `bars.toml`.

// A benchmark that cannot be set up has nothing to measure.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::dvec2;
use anamorph_core::{Deformation, Plane, Scaling};
use anamorph_features::ElementPair;
use anamorph_morph::grid::{CoordinateGrid, GridWarp, Spline, TwoPassMemory, two_pass_into};
use anamorph_raster::{
    Edge, Filter, Hierarchy, PixelMap, Raster, Window, hierarchical_map, hierarchical_map_into,
    resample_into,
};
use anamorph_warps::lines::{WeightConstants, local};
use criterion::{
    BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime,
};
use rayon::prelude::*;
use std::time::Duration;

fn pool() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(2)
        .build()
        .unwrap()
}

fn settle<'a>(
    criterion: &'a mut Criterion,
    name: &str,
    side: usize,
) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2))
        .throughput(Throughput::Elements((side * side) as u64));
    group
}

/// A hundred lines all over a square, moved and turned by up to a hundredth of its side.
fn lines(side: usize) -> impl Deformation<Plane> {
    let mut state = 0x1234_5678_9abc_def1_u64;
    let mut unit = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let size = side as f64;
    let constants = WeightConstants {
        a: size / 100.0,
        b: 2.0,
        p: 0.0,
    };
    let pairs: Vec<_> = (0..100)
        .map(|_| {
            let from = dvec2(unit(), unit()) * size;
            let to = from + (dvec2(unit(), unit()) - 0.5) * size * 0.15;
            let mut moved = || (dvec2(unit(), unit()) - 0.5) * size * 0.02;
            let target = [from + moved(), to + moved()];
            let pair = ElementPair::of_corners(&[from, to], &target).unwrap();
            (pair, constants)
        })
        .collect();
    local::construct(&pairs, Scaling::Displacement).unwrap()
}

fn window(side: usize) -> Window {
    Window::new(0, 0, side, side).unwrap()
}

fn resampling(criterion: &mut Criterion) {
    let side = 1024;
    let two = pool();
    let mut source = Raster::new(window(side), 4).unwrap();
    for (i, sample) in source.samples_mut().iter_mut().enumerate() {
        *sample = (i % 251) as f32;
    }
    let mut target = source.clone();
    let (map, _) = hierarchical_map(&lines(side), window(side), &Hierarchy::default()).unwrap();
    let mut group = settle(criterion, "Resampling 1024², 4 channels, 2 threads", side);
    group.bench_function("baseline: copy", |bencher| {
        bencher.iter(|| {
            two.install(|| {
                target
                    .samples_mut()
                    .par_chunks_mut(1 << 16)
                    .zip(source.samples().par_chunks(1 << 16))
                    .for_each(|(to, from)| to.copy_from_slice(from));
            });
        });
    });
    for filter in Filter::all() {
        group.bench_function(filter.name(), |bencher| {
            bencher.iter(|| {
                two.install(|| {
                    resample_into(&source, &map, filter, Edge::Clamp, &mut target).unwrap();
                });
            });
        });
    }
    group.finish();
}

/// Both over memory that is already there.
fn maps(criterion: &mut Criterion) {
    let two = pool();
    for side in [1024, 4096] {
        let warp = lines(side);
        let mut map = PixelMap::identity(window(side)).unwrap();
        let name = format!("Map of 100 lines, {side}², 2 threads");
        let mut group = settle(criterion, &name, side);
        group.bench_function("baseline: every pixel", |bencher| {
            bencher.iter(|| two.install(|| map.evaluate(&warp)));
        });
        group.bench_function("hierarchical, 0.05 px", |bencher| {
            let options = Hierarchy::default();
            bencher.iter(|| two.install(|| hierarchical_map_into(&warp, &options, &mut map)));
        });
        group.finish();
    }
}

/// A picture of 1024² on a grid of 20 × 20 nodes, moved by up to a tenth of a cell, by both ways of drawing it.
fn grids(criterion: &mut Criterion) {
    let side = 1024;
    let two = pool();
    let mut source = Raster::new(window(side), 4).unwrap();
    for (i, sample) in source.samples_mut().iter_mut().enumerate() {
        *sample = (i % 251) as f32;
    }
    let image = CoordinateGrid::regular(window(side), 20, 20).unwrap();
    let nodes = image.nodes().iter().enumerate().map(|(i, node)| {
        let by = dvec2((i * 37 % 11) as f64 - 5.0, (i * 53 % 13) as f64 - 6.0);
        *node + by
    });
    let result = CoordinateGrid::new(20, 20, nodes.collect()).unwrap();
    let warp = GridWarp::new(&result, &image, Spline::CatmullRom).unwrap();
    let (mut memory, mut target) = (TwoPassMemory::default(), source.clone());
    let mut map = PixelMap::identity(window(side)).unwrap();
    let mut group = settle(
        criterion,
        "Coordinate grid, 1024², 4 channels, 2 threads",
        side,
    );
    group.bench_function("baseline: map of every pixel, bilinear", |bencher| {
        bencher.iter(|| {
            two.install(|| {
                map.evaluate(&warp);
                resample_into(&source, &map, Filter::BILINEAR, Edge::Clamp, &mut target).unwrap();
            });
        });
    });
    group.bench_function("two passes", |bencher| {
        bencher.iter(|| {
            two.install(|| {
                two_pass_into(&source, &warp, Edge::Clamp, &mut memory, &mut target).unwrap();
            });
        });
    });
    group.finish();
}

criterion_group!(benches, resampling, maps, grids);
criterion_main!(benches);
