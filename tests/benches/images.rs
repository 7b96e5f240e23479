//! Resampling against a copy of the pixels, and hierarchical maps against exact ones, in one run.
//!
//! Rows named `baseline` are what the others are divided by; bars are in `bars.toml`.

// A benchmark that cannot be set up has nothing to measure.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::{Deformation, Plane, Scaling};
use anamorph_features::{Element, ElementPair, PointPair};
use anamorph_io::images::{EncodeOptions, ImageFile, ImageFormat, ImageLimits};
use anamorph_morph::grid::{CoordinateGrid, GridWarp, Spline, TwoPassMemory, two_pass_into};
use anamorph_raster::{
    Edge, Filter, Hierarchy, PixelMap, Raster, Window, hierarchical_map, hierarchical_map_into,
    resample_into,
};
use anamorph_warps::lines::{WeightConstants, local};
use anamorph_warps::radial::{Kernel, RadialWarp};
use criterion::{
    BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime,
};
use rayon::prelude::*;
use std::io::Cursor;
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
fn pairs_of_lines(side: usize) -> (Vec<ElementPair<Plane>>, WeightConstants) {
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
    let pairs = (0..100).map(|_| {
        let from = dvec2(unit(), unit()) * size;
        let to = from + (dvec2(unit(), unit()) - 0.5) * size * 0.15;
        let mut moved = || (dvec2(unit(), unit()) - 0.5) * size * 0.02;
        let target = [from + moved(), to + moved()];
        ElementPair::of_corners(&[from, to], &target).unwrap()
    });
    (pairs.collect(), constants)
}

fn lines(side: usize) -> impl Deformation<Plane> {
    let (pairs, constants) = pairs_of_lines(side);
    let pairs: Vec<_> = pairs.into_iter().map(|pair| (pair, constants)).collect();
    local::construct(&pairs, Scaling::Displacement).unwrap()
}

/// A thin plate through fifty landmarks all over a square, moved by up to a fiftieth of its side.
fn plate(side: usize) -> impl Deformation<Plane> {
    let mut state = 0x9876_5432_1abc_def1_u64;
    let mut unit = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let size = side as f64;
    let mut place = || dvec2(unit(), unit());
    let pairs = (0..50).map(|_| {
        let source = place() * size;
        let target = source + (place() - 0.5) * size * 0.04;
        PointPair { source, target }
    });
    RadialWarp::construct(pairs.collect(), Kernel::ThinPlate, true, 0.0).unwrap()
}

/// Feature lines as plainly as can be: for every pixel a loop over the lines, in ordinary code.
fn plain_lines(pairs: &[[DVec2; 4]], a: f64, width: usize, row: usize, out: &mut [DVec2]) {
    for (column, out) in out.iter_mut().enumerate().take(width) {
        let p = dvec2(column as f64 + 0.5, row as f64 + 0.5);
        let (mut sum, mut total) = (DVec2::ZERO, 0.0);
        for &[from, to, new_from, new_to] in pairs {
            let (line, new_line) = (to - from, new_to - new_from);
            let length = line.length();
            let u = (p - from).dot(line) / (length * length);
            let v = (p - from).dot(line.perp()) / length;
            let moved = new_from + new_line * u + new_line.perp() * (v / new_line.length());
            let d = if u < 0.0 {
                p.distance(from)
            } else if u > 1.0 {
                p.distance(to)
            } else {
                v.abs()
            };
            let weight = 1.0 / ((a + d) * (a + d));
            sum += (moved - p) * weight;
            total += weight;
        }
        *out = p + sum / total;
    }
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
fn map_of(criterion: &mut Criterion, what: &str, side: usize, warp: &dyn Deformation<Plane>) {
    let two = pool();
    let mut map = PixelMap::identity(window(side)).unwrap();
    let name = format!("Map of {what}, {side}², 2 threads");
    let mut group = settle(criterion, &name, side);
    group.bench_function("baseline: every pixel", |bencher| {
        bencher.iter(|| two.install(|| map.evaluate(warp)));
    });
    group.bench_function("hierarchical, 0.05 px", |bencher| {
        let options = Hierarchy::default();
        bencher.iter(|| two.install(|| hierarchical_map_into(warp, &options, &mut map)));
    });
    group.finish();
}

fn maps(criterion: &mut Criterion) {
    for side in [1024, 4096] {
        map_of(criterion, "100 lines", side, &lines(side));
    }
    map_of(criterion, "50 landmarks", 1024, &plate(1024));
}

/// Every pixel through a hundred lines, one thread: pixels times lines a second.
fn lines_at_every_pixel(criterion: &mut Criterion) {
    let side = 1024;
    let one = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    let mut group = settle(criterion, "100 lines at every pixel, 1024², 1 thread", side);
    group.throughput(Throughput::Elements((side * side * 100) as u64));
    let (pairs, constants) = pairs_of_lines(side);
    let corners: Vec<[DVec2; 4]> = pairs
        .iter()
        .map(|pair| {
            let corner = |element: &Element<Plane>, t: f64| element.at([t; 3]);
            let (source, target) = (&pair.source, &pair.target);
            [
                corner(source, 0.0),
                corner(source, 1.0),
                corner(target, 0.0),
                corner(target, 1.0),
            ]
        })
        .collect();
    let mut line = vec![DVec2::ZERO; side];
    group.bench_function("baseline: plain loop", |bencher| {
        bencher.iter(|| {
            for row in 0..side {
                plain_lines(&corners, constants.a, side, row, &mut line);
                std::hint::black_box(&line);
            }
        });
    });
    let mut map = PixelMap::identity(window(side)).unwrap();
    for (name, b) in [("b = 2", 2.0), ("b = 1", 1.0), ("b = 1.7", 1.7)] {
        let pairs: Vec<_> = pairs
            .iter()
            .map(|&pair| (pair, WeightConstants { b, ..constants }))
            .collect();
        let warp = local::construct(&pairs, Scaling::Displacement).unwrap();
        group.bench_function(name, |bencher| {
            bencher.iter(|| one.install(|| map.evaluate(&warp)));
        });
    }
    group.finish();
}

/// Map within 0.05 px and sampling, over memory that is already there.
fn whole_warp(criterion: &mut Criterion) {
    let side = 1024;
    let two = pool();
    let warp = plate(side);
    let mut source = Raster::new(window(side), 4).unwrap();
    for (i, sample) in source.samples_mut().iter_mut().enumerate() {
        *sample = (i % 251) as f32;
    }
    let mut target = source.clone();
    let mut map = PixelMap::identity(window(side)).unwrap();
    let mut group = settle(
        criterion,
        "Thin plate of 50 landmarks on an image, 1024², 4 channels, 2 threads",
        side,
    );
    for filter in [Filter::BILINEAR, Filter::ANISOTROPIC] {
        group.bench_function(filter.name(), |bencher| {
            let options = Hierarchy::default();
            bencher.iter(|| {
                two.install(|| {
                    hierarchical_map_into(&warp, &options, &mut map).unwrap();
                    resample_into(&source, &map, filter, Edge::Clamp, &mut target).unwrap();
                });
            });
        });
    }
    group.finish();
}

/// A file of 4096 × 2048 pixels, four channels of halves, ZIP, through what the crate `exr` itself gives and takes, and through ours.
fn openexr(criterion: &mut Criterion) {
    use exr::prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ReadChannels, ReadLayers,
        WritableImage, f16, read,
    };
    let (width, height) = (4096, 2048);
    let wave = |i: usize, channel: usize| {
        let (x, y) = ((i % width) as f32, (i / width) as f32);
        f16::from_f32(((x * 0.01 + channel as f32).sin() * (y * 0.013).cos() + 1.0) * 0.5)
    };
    let channels = ["A", "B", "G", "R"]
        .iter()
        .enumerate()
        .map(|(number, &name)| {
            let samples = (0..width * height).map(|i| wave(i, number)).collect();
            AnyChannel::new(name, FlatSamples::F16(samples))
        });
    let encoding = Encoding {
        compression: exr::compression::Compression::ZIP16,
        ..Encoding::default()
    };
    let image = Image::from_encoded_channels(
        (width, height),
        encoding,
        AnyChannels::sort(channels.collect()),
    );
    let written = |out: &mut Vec<u8>| {
        out.clear();
        image.write().to_buffered(Cursor::new(out)).unwrap();
    };
    let mut bytes = Vec::new();
    written(&mut bytes);
    let limits = ImageLimits::NONE;
    let ours = ImageFile::read(&bytes, limits).unwrap();
    let name = "OpenEXR, 4096 × 2048, four halves, ZIP";
    let mut group = criterion.benchmark_group(name);
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .throughput(Throughput::Elements((width * height) as u64));
    group.bench_function("baseline: exr, read", |bencher| {
        bencher.iter(|| {
            let reader = read().no_deep_data().largest_resolution_level();
            let reader = reader.all_channels().all_layers().all_attributes();
            reader.from_buffered(Cursor::new(&bytes)).unwrap()
        });
    });
    group.bench_function("read", |bencher| {
        bencher.iter(|| ImageFile::read(&bytes, limits).unwrap());
    });
    let mut out = Vec::new();
    group.bench_function("baseline: exr, write", |bencher| {
        bencher.iter(|| written(&mut out));
    });
    group.bench_function("write", |bencher| {
        bencher.iter(|| {
            ours.encode(ImageFormat::OpenExr, &EncodeOptions::default())
                .unwrap()
        });
    });
    group.finish();
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

criterion_group!(
    benches,
    resampling,
    lines_at_every_pixel,
    maps,
    whole_warp,
    openexr,
    grids
);
criterion_main!(benches);
