//! Paths through orientations against what anyone would write: a search for the span and glam's slerp.
//!
//! Rows named `baseline` are what the others are divided by; bars are in `bars.toml`.

// A benchmark that cannot be set up has nothing to measure.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::{DQuat, DVec3};
use anamorph_transforms::quaternion::{
    BezierPath, Ends, Keys, Orientations, RotationSpline, SlerpPath, SquadPath, from_axis_angle,
};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;

/// Keys of the sequence.
const KEYS: usize = 1000;
/// Times asked for.
const QUERIES: usize = 200_000;

fn unit(state: &mut u64) -> f64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Keys a fifth to one and a half radians apart, at uneven times.
fn keys() -> Keys {
    let mut state = 88_172_645_463_325_252;
    let (mut q, mut t) = (DQuat::IDENTITY, 0.0);
    let (mut keys, mut times) = (Vec::new(), Vec::new());
    for _ in 0..KEYS {
        let axis = DVec3::new(unit(&mut state), unit(&mut state), unit(&mut state)) - 0.5;
        q = from_axis_angle(axis, 0.2 + 1.3 * unit(&mut state)) * q;
        t += 0.5 + unit(&mut state);
        keys.push(q);
        times.push(t);
    }
    Keys::new(&keys, &times).unwrap()
}

/// A binary search for the span, and `DQuat::slerp`.
fn searched(keys: &[DQuat], times: &[f64], queries: &[f64], out: &mut [DQuat]) {
    for (q, &t) in out.iter_mut().zip(queries) {
        let i = times
            .partition_point(|&key| key <= t)
            .clamp(1, times.len() - 1)
            - 1;
        let x = (t - times[i]) / (times[i + 1] - times[i]);
        *q = keys[i].slerp(keys[i + 1], x);
    }
}

fn rotations(criterion: &mut Criterion) {
    let keys = keys();
    let slerp = SlerpPath::new(&keys);
    let spline = RotationSpline::new(&keys, Ends::NATURAL).unwrap();
    let (squad, bezier) = (SquadPath::new(&keys), BezierPath::new(&keys));
    let [start, end] = slerp.domain();
    let mut state = 1_234_567;
    let mut queries: Vec<f64> = (0..QUERIES)
        .map(|_| start + (end - start) * unit(&mut state))
        .collect();
    for order in ["no order", "ascending order"] {
        if order == "ascending order" {
            queries.sort_by(f64::total_cmp);
        }
        let mut out = vec![DQuat::IDENTITY; QUERIES];
        let mut group = criterion.benchmark_group(format!("Rotations, times in {order}"));
        group
            .throughput(Throughput::Elements(QUERIES as u64))
            .sample_size(20)
            .measurement_time(Duration::from_secs(2));
        group.bench_function("baseline: search and glam's slerp", |bencher| {
            bencher.iter(|| searched(keys.keys(), keys.times(), black_box(&queries), &mut out));
        });
        group.bench_function("slerp over keys, one by one", |bencher| {
            bencher.iter(|| {
                for (q, &t) in out.iter_mut().zip(black_box(&queries)) {
                    *q = slerp.orientation(t);
                }
            });
        });
        let paths: [(&str, &dyn Orientations); 4] = [
            ("slerp over keys", &slerp),
            ("rotation spline", &spline),
            ("squad", &squad),
            ("Bézier", &bezier),
        ];
        for (name, path) in paths {
            group.bench_function(name, |bencher| {
                bencher.iter(|| path.orientations(black_box(&queries), &mut out).unwrap());
            });
        }
        group.finish();
    }
}

criterion_group!(benches, rotations);
criterion_main!(benches);
