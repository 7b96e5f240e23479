//! Kernels of the warps against plain code and against what the machine can do, in one run.
//!
//! Rows named `baseline` are what the others are divided by; bars are in `bars.toml`.

// A benchmark that cannot be set up has nothing to measure.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::DVec3;
use anamorph_core::simd::{Level, Simd, dispatch, f64x8, prelude::*};
use anamorph_core::{
    Bounds, Deformation, Linear, Masked, Modulated, Scaling, Solid, Stack, evaluate_points,
    map_all, map_all_parallel, reference,
};
use anamorph_fields::{Radial, falloffs::Wires};
use anamorph_warps::barr::{AxisFrame, Course, bend::Bend, taper::Taper, twist::Twist};
use anamorph_warps::lattices::Grid;
use anamorph_warps::lattices::bernstein::BernsteinLattice;
use anamorph_warps::lattices::bspline::{BsplineLattice, Knots};
use criterion::{
    BatchSize, BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main,
    measurement::WallTime,
};
use rayon::prelude::*;
use std::hint::black_box;
use std::time::Duration;

/// Points of the lattice benchmarks.
const POINTS: usize = 1_000_000;
/// Points of the benchmarks that memory limits: 96 MiB, beyond the caches.
const MANY: usize = 4_000_000;
/// Operations a point that the bound of the 4×4×4 lattice counts.
const OPERATIONS: usize = 400;

fn unit(state: &mut u64) -> f64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Points all over the unit cube, in no order.
fn scattered(count: usize) -> Vec<Solid> {
    let mut state = 88_172_645_463_325_252;
    (0..count)
        .map(|_| DVec3::new(unit(&mut state), unit(&mut state), unit(&mut state)))
        .collect()
}

/// Points on a sphere in the unit cube in the order of a scanned surface, as vertices of a model are.
fn surface(count: usize) -> Vec<Solid> {
    let golden = core::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let rows = (count as f64).sqrt();
    (0..count)
        .map(|i| {
            let (row, column) = ((i as f64 / rows).floor(), (i as f64 % rows) / rows);
            let y = 1.0 - 2.0 * (row + 0.5) / rows.max(1.0);
            let r = (1.0 - y * y).max(0.0).sqrt();
            let a = column * core::f64::consts::TAU + golden * 1e-3;
            DVec3::new(
                0.5 + 0.49 * r * a.cos(),
                0.5 + 0.49 * y,
                0.5 + 0.49 * r * a.sin(),
            )
        })
        .collect()
}

fn grid(shape: [usize; 3]) -> Grid<Solid> {
    Grid::around(Bounds::new(Solid::ZERO, Solid::ONE), &shape).unwrap()
}

fn displacements(count: usize) -> Vec<Solid> {
    let mut state = 1_234_567;
    (0..count)
        .map(|_| {
            DVec3::new(unit(&mut state), unit(&mut state), unit(&mut state)) * 0.1
                - DVec3::splat(0.05)
        })
        .collect()
}

/// What anyone would write: points one by one, arrays of structures, cubic Bernstein polynomials by formula.
struct Plain {
    origin: Solid,
    inverse: anamorph_core::glam::DMat3,
    displacements: Vec<Solid>,
}

impl Plain {
    fn map(&self, points: &mut [Solid]) {
        for point in points {
            let t = self.inverse * (*point - self.origin);
            if t.min_element() < 0.0 || t.max_element() > 1.0 {
                continue;
            }
            let basis = [t.x, t.y, t.z].map(|t| {
                let u = 1.0 - t;
                [u * u * u, 3.0 * t * u * u, 3.0 * t * t * u, t * t * t]
            });
            let mut sum = Solid::ZERO;
            for (i, bi) in basis[0].iter().enumerate() {
                for (j, bj) in basis[1].iter().enumerate() {
                    for (k, bk) in basis[2].iter().enumerate() {
                        sum += self.displacements[(i * 4 + j) * 4 + k] * (bi * bj * bk);
                    }
                }
            }
            *point += sum;
        }
    }
}

/// `OPERATIONS` separate multiplications and additions for each of `count` points, in twelve independent chains of
/// vectors of the width the kernels dispatch: the most any code of plain operations can do.
fn bound(count: usize) -> f64 {
    const CHAINS: usize = 12;
    #[inline(always)]
    fn chains<V: Simd>(v: V, rounds: usize) -> f64 {
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
    let rounds = count * OPERATIONS / (CHAINS * 8 * 2);
    dispatch!(Level::new(), v => chains(v, rounds))
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap()
}

/// A row that moves a fresh copy of `points` by `run`.
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

fn settle<'a>(
    criterion: &'a mut Criterion,
    name: &str,
    count: usize,
) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group
        .sample_size(15)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    group.throughput(Throughput::Elements(count as u64));
    group
}

fn lattice(criterion: &mut Criterion) {
    let points = scattered(POINTS);
    let moves = displacements(64);
    let kernel = || BernsteinLattice::construct(grid([4, 4, 4]), moves.clone()).unwrap();
    let warp = kernel();
    let plain = Plain {
        origin: Solid::ZERO,
        inverse: Linear::<Solid>::inverted(grid([4, 4, 4]).edges()).unwrap(),
        displacements: moves.clone(),
    };
    let mut group = settle(criterion, "Bernstein lattice 4x4x4", POINTS);
    row(
        &mut group,
        "baseline: plain loop over structures",
        &points,
        |p| plain.map(p),
    );
    row(&mut group, "kernel, 1 thread", &points, |p| {
        warp.map_points(0, p);
    });
    row(
        &mut group,
        "kernel and finiteness check, 1 thread",
        &points,
        |p| {
            map_all(&warp, p);
        },
    );
    let two = pool(2);
    row(&mut group, "kernel, 2 threads", &points, |p| {
        two.install(|| map_all_parallel(&warp, p, &|_| {}));
    });
    let ball = || Box::new(Radial::new(DVec3::splat(0.5), 0.6, Wires).unwrap());
    let masked = Masked::new(Box::new(kernel()), ball());
    row(
        &mut group,
        "masked by a radial field, 1 thread",
        &points,
        |p| {
            masked.map_points(0, p);
        },
    );
    let strength = Modulated::new(Box::new(kernel())).with_strength(ball());
    row(
        &mut group,
        "strength by a radial field, 1 thread",
        &points,
        |p| {
            strength.map_points(0, p);
        },
    );
    let half = Masked::new(Box::new(kernel()), Box::new(0.5));
    row(&mut group, "masked by a number, 1 thread", &points, |p| {
        half.map_points(0, p);
    });
    let stack = Stack::new(vec![Box::new(kernel())]);
    row(&mut group, "in a stack, 1 thread", &points, |p| {
        stack.map_points(0, p);
    });
    group.bench_function("bound: separate multiply and add, 1 thread", |bencher| {
        bencher.iter(|| bound(black_box(POINTS)));
    });
    group.bench_function("bound: separate multiply and add, 2 threads", |bencher| {
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

    // The slow evaluators, on fewer points.
    let few = &points[..POINTS / 50];
    let mut group = settle(criterion, "Bernstein lattice 4x4x4, by terms", few.len());
    row(&mut group, "baseline: literal eq. (3)", few, |p| {
        for (index, point) in p.iter_mut().enumerate() {
            *point = reference::evaluate(&warp, &anamorph_core::Site::new(index, *point));
        }
    });
    row(&mut group, "engine, term by term", few, |p| {
        evaluate_points(&warp, 0, p);
    });
    row(&mut group, "kernel", few, |p| {
        warp.map_points(0, p);
    });
    group.finish();
}

fn spline(criterion: &mut Criterion) {
    for (name, points) in [
        ("in model order", surface(POINTS)),
        ("in no order", scattered(POINTS)),
    ] {
        let mut group = settle(
            criterion,
            &format!("B-spline lattice, points {name}"),
            POINTS,
        );
        for (label, side) in [("baseline: 4x4x4", 4), ("8x8x8", 8), ("32x32x32", 32)] {
            let count = side * side * side;
            let warp =
                BsplineLattice::construct(grid([side; 3]), 3, Knots::Uniform, displacements(count))
                    .unwrap();
            row(&mut group, label, &points, |p| {
                warp.map_points(0, p);
            });
        }
        group.finish();
    }
}

fn barr(criterion: &mut Criterion) {
    let points = scattered(MANY);
    let frame = AxisFrame::new(DVec3::splat(0.5), DVec3::new(0.1, 1.0, 0.2), None).unwrap();
    let range = anamorph_fields::AxisRange::new(-0.4, 0.4, anamorph_fields::Limit::Clamp).unwrap();
    let course = |start, end| Course::linear(-0.4, start, 0.4, end);
    let drawn = anamorph_fields::Profile::through(&[[0.0, 1.0], [0.5, 0.6], [1.0, 1.0]]).unwrap();
    let drawn = Course::Drawn {
        profile: drawn,
        from: -0.4,
        per_length: 1.25,
        scale: 1.0,
    };
    let warps: Vec<(&str, Box<dyn Deformation<Solid>>)> = vec![
        (
            "taper",
            Box::new(
                Taper::construct(frame, course(1.0, 0.5), Some(range), Scaling::Displacement)
                    .unwrap(),
            ),
        ),
        (
            "taper by a drawn profile",
            Box::new(Taper::construct(frame, drawn, Some(range), Scaling::Displacement).unwrap()),
        ),
        (
            "twist",
            Box::new(
                Twist::construct(frame, course(0.0, 2.0), Some(range), Scaling::Composition)
                    .unwrap(),
            ),
        ),
        (
            "bend",
            Box::new(Bend::construct(frame, 1.5, 0.0, Some(range), Scaling::Composition).unwrap()),
        ),
    ];
    let mut group = settle(criterion, "Barr deformations, 2 threads", MANY);
    let two = pool(2);
    let source = points.clone();
    row(&mut group, "baseline: copy", &points, |p| {
        two.install(|| {
            p.par_chunks_mut(8192)
                .zip(source.par_chunks(8192))
                .for_each(|(to, from)| to.copy_from_slice(from));
        });
    });
    for (name, warp) in &warps {
        row(&mut group, name, &points, |p| {
            two.install(|| map_all_parallel(warp, p, &|_| {}));
        });
    }
    group.finish();
}

criterion_group!(benches, lattice, spline, barr);
criterion_main!(benches);
