//! Radial basis functions against plain code and what the machine can do, in one run.
//!
//! Rows named `baseline` are what the others are divided by; bars are in `bars.toml`.

// A benchmark that cannot be set up has nothing to measure.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::dvec3;
use anamorph_core::simd::{Level, Simd, dispatch, f64x8, prelude::*};
use anamorph_core::{Deformation, Solid, map_all_parallel};
use anamorph_features::PointPair;
use anamorph_warps::radial::{Kernel, RadialWarp};
use criterion::{
    BatchSize, BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main,
    measurement::WallTime,
};
use std::hint::black_box;
use std::time::Duration;

/// Points of a large model.
const POINTS: usize = 1_000_000;
/// Centres of the warps of all space.
const CENTRES: usize = 200;
/// Operations for each point and centre of `r² log r` in space: 8 for the squared distance, 1 that keeps it from 0, 35 for the
/// logarithm (a division counted as one), 7 for its share.
const OPERATIONS: usize = 51;

fn unit(state: &mut u64) -> f64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Points all over the unit cube, in no order.
fn scattered(count: usize, seed: u64) -> Vec<Solid> {
    let mut state = seed;
    (0..count)
        .map(|_| dvec3(unit(&mut state), unit(&mut state), unit(&mut state)))
        .collect()
}

fn pairs(count: usize) -> Vec<PointPair<Solid>> {
    let moves = scattered(count, 99);
    let sources = scattered(count, 88_172_645_463_325_252).into_iter();
    sources
        .zip(moves)
        .map(|(source, by)| PointPair {
            source,
            target: source + (by - 0.5) * 0.05,
        })
        .collect()
}

/// What anyone would write: each point against every centre.
fn plain(centres: &[(Solid, Solid)], kernel: impl Fn(f64) -> f64, points: &mut [Solid]) {
    for point in points {
        let mut sum = Solid::ZERO;
        for (centre, coefficient) in centres {
            sum += *coefficient * kernel(point.distance_squared(*centre));
        }
        *point += sum;
    }
}

/// `CENTRES` square roots for each of `count` points.
fn roots(count: usize) -> f64 {
    #[inline(always)]
    fn chains<V: Simd>(v: V, rounds: usize) -> f64 {
        const CHAINS: usize = 12;
        let mut sums: [f64x8<V>; CHAINS] =
            core::array::from_fn(|i| f64x8::splat(v, 1.5 + i as f64));
        for _ in 0..rounds {
            for sum in &mut sums {
                *sum = sum.sqrt();
            }
        }
        let total = sums.into_iter().reduce(|a, b| a + b);
        let lanes: [f64; 8] = total.map_or([0.0; 8], Into::into);
        lanes.iter().sum()
    }
    dispatch!(Level::new(), v => chains(v, count * CENTRES / (12 * 8)))
}

/// `OPERATIONS` separate multiplications and additions for each of `count` points and each centre.
fn operations(count: usize) -> f64 {
    #[inline(always)]
    fn chains<V: Simd>(v: V, rounds: usize) -> f64 {
        const CHAINS: usize = 12;
        let mut sums: [f64x8<V>; CHAINS] =
            core::array::from_fn(|i| f64x8::splat(v, 1.0 + i as f64));
        let (factor, term) = (f64x8::splat(v, 0.999_999_999), f64x8::splat(v, 1e-9));
        for _ in 0..rounds {
            for sum in &mut sums {
                *sum = *sum * factor + term;
            }
        }
        let total = sums.into_iter().reduce(|a, b| a + b).unwrap_or(term);
        let lanes: [f64; 8] = total.into();
        lanes.iter().sum()
    }
    dispatch!(Level::new(), v => chains(v, count * CENTRES * OPERATIONS / (12 * 8 * 2)))
}

fn row(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    points: &[Solid],
    mut run: impl FnMut(&mut [Solid]),
) {
    group.bench_function(name, |bencher| {
        bencher.iter_batched_ref(
            || points.to_vec(),
            |points| run(black_box(points)),
            BatchSize::PerIteration,
        );
    });
}

fn settle<'a>(criterion: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group
        .sample_size(10)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    group.throughput(Throughput::Elements(POINTS as u64));
    group
}

fn pool() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(2)
        .build()
        .unwrap()
}

fn space(
    criterion: &mut Criterion,
    name: &str,
    kernel: Kernel,
    formula: impl Fn(f64) -> f64,
    (bound_name, bound): (&str, fn(usize) -> f64),
) {
    let points = scattered(POINTS, 4_712);
    let pairs = pairs(CENTRES);
    let warp = RadialWarp::construct(pairs.clone(), kernel, true, 0.0).unwrap();
    let centres: Vec<(Solid, Solid)> = pairs
        .iter()
        .map(|pair| (pair.source, (pair.target - pair.source) * 0.01))
        .collect();
    let mut group = settle(criterion, name);
    row(
        &mut group,
        "baseline: plain loop over structures",
        &points,
        |p| {
            plain(&centres, &formula, p);
        },
    );
    row(&mut group, "1 thread", &points, |p| {
        warp.map_points(0, p);
    });
    let two = pool();
    row(&mut group, "2 threads", &points, |p| {
        two.install(|| map_all_parallel(&warp, p, &|_| {}));
    });
    group.bench_function(format!("bound: {bound_name}, 2 threads"), |bencher| {
        bencher.iter(|| {
            two.install(|| {
                rayon::join(
                    || bound(black_box(POINTS / 2)),
                    || bound(black_box(POINTS / 2)),
                )
            })
        });
    });
    group.finish();
}

fn kernels(criterion: &mut Criterion) {
    space(
        criterion,
        "Radial kernel r, 200 centres, space",
        Kernel::Linear,
        f64::sqrt,
        ("square roots", roots),
    );
    space(
        criterion,
        "Radial kernel r² log r, 200 centres, space",
        Kernel::Logarithmic,
        |q| if q > 0.0 { 0.5 * q * q.ln() } else { 0.0 },
        ("separate multiply and add", operations),
    );
}

/// Many centres within a radius: the equations and the evaluation.
fn compact(criterion: &mut Criterion) {
    const MANY: usize = 15_000;
    let pairs = pairs(MANY);
    // About thirty neighbours each.
    let kernel = Kernel::Wendland { radius: 0.08 };
    let points = scattered(POINTS, 4_712);
    let warp = RadialWarp::construct(pairs.clone(), kernel, false, 0.0).unwrap();
    let mut group = settle(criterion, "15 000 centres of a kernel with a radius");
    let two = pool();
    row(&mut group, "a million points, 2 threads", &points, |p| {
        two.install(|| map_all_parallel(&warp, p, &|_| {}));
    });
    group.throughput(Throughput::Elements(MANY as u64));
    group.bench_function("equations", |bencher| {
        bencher.iter(|| RadialWarp::construct(black_box(pairs.clone()), kernel, false, 0.0));
    });
    group.finish();
}

criterion_group!(benches, kernels, compact);
criterion_main!(benches);
