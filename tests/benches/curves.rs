//! Arc length and its inverse against kurbo, curve for curve.
//!
//! Rows named `baseline` are what the others are divided by; bars are in `bars.toml`.

// A benchmark that cannot be set up has nothing to measure.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::{DVec2, DVec3, dvec2};
use anamorph_curves::arc_length::{cubic_lengths, cubic_parameter_at, cubic_parameters_at};
use anamorph_curves::families::{CatmullRom, Generator};
use anamorph_curves::{LengthTable, NearestTable};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use kurbo::{CubicBez, ParamCurveArclen, ParamCurveNearest};
use std::hint::black_box;
use std::time::Duration;

/// The accuracy of all rows, in units of the square that holds the control points.
const ACCURACY: f64 = 1e-9;
/// Curves of a round.
const CURVES: usize = 20_000;

fn unit(state: &mut u64) -> f64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Random cubics with control points in the unit square.
fn cubics() -> Vec<[DVec2; 4]> {
    let mut state = 88_172_645_463_325_252;
    (0..CURVES)
        .map(|_| core::array::from_fn(|_| dvec2(unit(&mut state), unit(&mut state))))
        .collect()
}

fn theirs(p: &[DVec2; 4]) -> CubicBez {
    CubicBez::new(
        (p[0].x, p[0].y),
        (p[1].x, p[1].y),
        (p[2].x, p[2].y),
        (p[3].x, p[3].y),
    )
}

fn lengths(criterion: &mut Criterion) {
    let ours = cubics();
    let kurbo: Vec<CubicBez> = ours.iter().map(theirs).collect();
    let mut out = Vec::new();
    let mut group = criterion.benchmark_group("Arc length of cubics to 1e-9");
    group
        .throughput(Throughput::Elements(CURVES as u64))
        .sample_size(20)
        .measurement_time(Duration::from_secs(3));
    group.bench_function("baseline: kurbo", |bencher| {
        bencher.iter(|| {
            black_box(&kurbo)
                .iter()
                .map(|c| c.arclen(ACCURACY))
                .sum::<f64>()
        });
    });
    group.bench_function("many together", |bencher| {
        bencher.iter(|| {
            cubic_lengths(black_box(&ours), ACCURACY, &mut out);
            out.iter().sum::<f64>()
        });
    });
    let solid: Vec<[DVec3; 4]> = {
        let mut state = 362_436_069;
        (0..CURVES)
            .map(|_| {
                core::array::from_fn(|_| {
                    DVec3::from_array(core::array::from_fn(|_| unit(&mut state)))
                })
            })
            .collect()
    };
    group.bench_function("many together, in space", |bencher| {
        bencher.iter(|| {
            cubic_lengths(black_box(&solid), ACCURACY, &mut out);
            out.iter().sum::<f64>()
        });
    });
    group.finish();
}

fn inverses(criterion: &mut Criterion) {
    let ours = cubics();
    let kurbo: Vec<CubicBez> = ours.iter().map(theirs).collect();
    let mut lengths = Vec::new();
    cubic_lengths(&ours, 1e-12, &mut lengths);
    let mut state = 521_288_629;
    let asked: Vec<f64> = lengths.iter().map(|l| l * unit(&mut state)).collect();
    let mut group = criterion.benchmark_group("Inverse arc length of cubics to 1e-9");
    group
        .throughput(Throughput::Elements(CURVES as u64))
        .sample_size(20)
        .measurement_time(Duration::from_secs(3));
    group.bench_function("baseline: kurbo", |bencher| {
        bencher.iter(|| {
            let pairs = black_box(&kurbo).iter().zip(&asked);
            pairs.map(|(c, s)| c.inv_arclen(*s, ACCURACY)).sum::<f64>()
        });
    });
    group.bench_function("one at a time", |bencher| {
        bencher.iter(|| {
            let pairs = black_box(&ours).iter().zip(&asked);
            pairs
                .map(|(c, s)| cubic_parameter_at(c, *s, ACCURACY))
                .sum::<f64>()
        });
    });
    let mut out = Vec::new();
    group.bench_function("many together", |bencher| {
        bencher.iter(|| {
            cubic_parameters_at(black_box(&ours), &asked, ACCURACY, &mut out);
            out.iter().sum::<f64>()
        });
    });
    // A path of a hundred spans, asked a hundred thousand times.
    let points: Vec<DVec2> = (0..101)
        .map(|_| dvec2(unit(&mut state), unit(&mut state)))
        .collect();
    let path = CatmullRom::new(points).curve().unwrap();
    let rough = LengthTable::new(&path, 1e-6).unwrap().length();
    let table = LengthTable::new(&path, ACCURACY * rough).unwrap();
    let mut queries: Vec<f64> = (0..CURVES)
        .map(|_| table.length() * unit(&mut state))
        .collect();
    group.bench_function("prepared table, in no order", |bencher| {
        bencher.iter(|| {
            black_box(&queries)
                .iter()
                .map(|s| table.parameter(*s))
                .sum::<f64>()
        });
    });
    queries.sort_by(f64::total_cmp);
    group.bench_function("prepared table, in ascending order", |bencher| {
        bencher.iter(|| {
            black_box(&queries)
                .iter()
                .map(|s| table.parameter(*s))
                .sum::<f64>()
        });
    });
    group.finish();
}

fn nearest(criterion: &mut Criterion) {
    const FEW: usize = 2000;
    let ours = cubics();
    let kurbo: Vec<CubicBez> = ours.iter().map(theirs).collect();
    let tables: Vec<NearestTable<DVec2>> = ours[..FEW]
        .iter()
        .map(|p| NearestTable::new(&anamorph_curves::Bezier::new(p.to_vec()).unwrap()))
        .collect();
    let mut state = 88_675_123;
    let places: Vec<DVec2> = (0..FEW)
        .map(|_| dvec2(unit(&mut state), unit(&mut state)) * 2.0 - 0.5)
        .collect();
    let mut group = criterion.benchmark_group("Nearest point of cubics");
    group
        .throughput(Throughput::Elements(FEW as u64))
        .sample_size(20)
        .measurement_time(Duration::from_secs(2));
    group.bench_function("baseline: kurbo to 1e-9", |bencher| {
        bencher.iter(|| {
            let pairs = black_box(&kurbo[..FEW]).iter().zip(&places);
            pairs
                .map(|(c, p)| c.nearest(kurbo::Point::new(p.x, p.y), ACCURACY).distance_sq)
                .sum::<f64>()
        });
    });
    group.bench_function("all minima considered", |bencher| {
        bencher.iter(|| {
            let pairs = black_box(&tables).iter().zip(&places);
            pairs.map(|(t, p)| t.nearest(*p).distance).sum::<f64>()
        });
    });
    group.finish();
}

criterion_group!(benches, lengths, inverses, nearest);
criterion_main!(benches);
