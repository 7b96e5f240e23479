//! Warps by lines, wires, curves and meshes, and their bindings, against plain code in one run.
//!
//! Rows named `baseline` are what the others are divided by; bars are in `bars.toml`.

// A benchmark that cannot be set up has nothing to measure.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::{DMat3, DQuat, DVec2, dvec2, dvec3};
use anamorph_core::{
    Binding, Bound, Curve, Deformation, Differentiable, Plane, Scaling, Solid, Space, Warp,
    evaluate_points, map_all_parallel,
};
use anamorph_curves::{Bezier, Indexed};
use anamorph_features::ElementPair;
use anamorph_warps::lines::{WeightConstants, local};
use anamorph_warps::meshes::{MeshWarp, Reaches, Uncovered};
use anamorph_warps::wires::{AxialCurve, Axis, Rail, Station, Wire, Wires};
use criterion::{
    BatchSize, BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main,
    measurement::WallTime,
};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

/// Points of a large model.
const POINTS: usize = 1_000_000;
/// Points of the axial deformation.
const AXIAL: usize = 200_000;

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
        .map(|_| dvec3(unit(&mut state), unit(&mut state), unit(&mut state)))
        .collect()
}

fn row<S: Space>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    points: &[S],
    mut run: impl FnMut(&mut [S]),
) {
    group.throughput(Throughput::Elements(points.len() as u64));
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
        .sample_size(12)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    group
}

fn two() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(2)
        .build()
        .unwrap()
}

type Held = Indexed<Solid, Box<Bezier<Solid>>>;

fn bezier(points: [Solid; 4]) -> Arc<Held> {
    Arc::new(Indexed::new(Box::new(
        Bezier::new(points.to_vec()).unwrap(),
    )))
}

/// Wires all over the unit cube.
fn wires(count: usize, radius: f64) -> (Vec<[Solid; 4]>, Wires<Solid>) {
    let mut state = 4_712;
    let controls: Vec<[Solid; 4]> = (0..count)
        .map(|_| {
            let start = dvec3(unit(&mut state), unit(&mut state), unit(&mut state));
            let mut step = || dvec3(unit(&mut state), unit(&mut state), unit(&mut state)) - 0.5;
            let [a, b, c] = [step(), step(), step()].map(|s| s * 0.3);
            [start, start + a, start + a + b, start + a + b + c]
        })
        .collect();
    let made = controls
        .iter()
        .map(|c| {
            let target = [c[0], c[1] + 0.05, c[2] - 0.02, c[3] + 0.01];
            Wire::new(bezier(*c), bezier(target), radius)
        })
        .collect();
    (controls, Wires::construct(made, None).unwrap())
}

/// What anyone would write: each point against every sample of every wire.
fn plain_wires(controls: &[[Solid; 4]], radius: f64, points: &mut [Solid]) {
    const SAMPLES: usize = 64;
    let at = |c: &[Solid; 4], t: f64| {
        let u = 1.0 - t;
        c[0] * (u * u * u)
            + c[1] * (3.0 * t * u * u)
            + c[2] * (3.0 * t * t * u)
            + c[3] * (t * t * t)
    };
    let sampled: Vec<Vec<(Solid, Solid)>> = controls
        .iter()
        .map(|c| {
            let target = [c[0], c[1] + 0.05, c[2] - 0.02, c[3] + 0.01];
            (0..=SAMPLES)
                .map(|i| i as f64 / SAMPLES as f64)
                .map(|t| (at(c, t), at(&target, t) - at(c, t)))
                .collect()
        })
        .collect();
    for point in points {
        let (mut moved, mut total) = (Solid::ZERO, 0.0);
        for wire in &sampled {
            let mut nearest = (f64::INFINITY, Solid::ZERO);
            for (place, displacement) in wire {
                let squared = place.distance_squared(*point);
                if squared < nearest.0 {
                    nearest = (squared, *displacement);
                }
            }
            let share = nearest.0.sqrt() / radius;
            if share < 1.0 {
                let falloff = (1.0 - share * share) * (1.0 - share * share);
                moved += nearest.1 * (falloff * falloff);
                total += falloff;
            }
        }
        if total > 0.0 {
            *point += moved / total;
        }
    }
}

fn wire_rows(criterion: &mut Criterion) {
    let points = scattered(POINTS);
    let mut group = settle(criterion, "Wires, 20 over a million points, 1 thread");
    for (name, radius) in [
        ("20 wires, small radii", 0.05),
        ("20 wires, large radii", 0.2),
    ] {
        let (_, warp) = wires(20, radius);
        row(&mut group, name, &points, |p| {
            warp.map_points(0, p);
        });
    }
    let (_, one) = wires(1, 0.05);
    row(&mut group, "1 wire, small radius", &points, |p| {
        one.map_points(0, p);
    });
    let (controls, _) = wires(20, 0.05);
    let few = &points[..POINTS / 50];
    row(
        &mut group,
        "baseline: points × wires × samples",
        few,
        |p| {
            plain_wires(&controls, 0.05, p);
        },
    );
    group.finish();
}

/// The curve that the straight axis becomes.
fn curl() -> Bezier<Solid> {
    Bezier::new(vec![
        Solid::ZERO,
        dvec3(0.0, 0.6, 0.1),
        dvec3(0.5, 0.9, 0.3),
        dvec3(0.9, 0.4, 0.5),
    ])
    .unwrap()
}

fn frame_along(tangent: Solid) -> DMat3 {
    let along = tangent.normalize();
    let across = along.cross(Solid::Z).normalize();
    DMat3::from_cols(along, across, along.cross(across))
}

/// What anyone would write: a table of chord lengths and frames, searched and interpolated for each point.
struct PlainAxis {
    lengths: Vec<f64>,
    frames: Vec<DQuat>,
    curve: Bezier<Solid>,
}

impl PlainAxis {
    fn new() -> Self {
        const SAMPLES: usize = 256;
        let curve = curl();
        let mut lengths = vec![0.0];
        let mut frames = Vec::new();
        let mut last = curve.point(0.0);
        for i in 0..=SAMPLES {
            let jet = curve.jet(i as f64 / SAMPLES as f64);
            frames.push(DQuat::from_mat3(&frame_along(jet.first)));
            if i > 0 {
                lengths.push(lengths[i - 1] + jet.point.distance(last));
            }
            last = jet.point;
        }
        Self {
            lengths,
            frames,
            curve,
        }
    }

    fn map(&self, points: &mut [Solid]) {
        let whole = self.lengths[self.lengths.len() - 1];
        for point in points {
            let length = point.y.clamp(0.0, 1.0) * whole;
            let after = self.lengths.partition_point(|l| *l <= length);
            let after = after.clamp(1, self.lengths.len() - 1);
            let (from, to) = (self.lengths[after - 1], self.lengths[after]);
            let share = (length - from) / (to - from);
            let t = ((after - 1) as f64 + share) / (self.lengths.len() - 1) as f64;
            let frame = self.frames[after - 1].slerp(self.frames[after], share);
            let local = dvec3(point.y - point.y.clamp(0.0, 1.0), point.x, point.z);
            *point = self.curve.point(t) + frame * local;
        }
    }
}

fn axial_rows(criterion: &mut Criterion) {
    let points = scattered(AXIAL);
    let curve = curl();
    let station = |share: f64| {
        let jet = curve.jet(share);
        Station {
            point: jet.point,
            frame: frame_along(jet.first),
        }
    };
    let axis = Axis::Line {
        origin: Solid::ZERO,
        frame: DMat3::from_cols(Solid::Y, Solid::X, Solid::Z),
        length: 1.0,
    };
    let rail = Rail::new("target", &[], &station, 1e-8).unwrap();
    let warp = AxialCurve::construct(axis, rail, None).unwrap();
    let plain = PlainAxis::new();
    let mut group = settle(criterion, "Axial curve, 200 000 points");
    row(
        &mut group,
        "baseline: search and slerp, 1 thread",
        &points,
        |p| {
            plain.map(p);
        },
    );
    row(&mut group, "1 thread", &points, |p| {
        warp.map_points(0, p);
    });
    let two = two();
    row(&mut group, "2 threads", &points, |p| {
        two.install(|| map_all_parallel(&warp, p, &|_| {}));
    });
    group.finish();
}

/// A sphere of rings: vertices, edges, and vertices after an edit.
fn sphere(rings: usize, around: usize) -> (Vec<Solid>, Vec<Solid>, Vec<[u32; 2]>) {
    use core::f64::consts::{PI, TAU};
    let (mut source, mut edges) = (Vec::new(), Vec::new());
    for ring in 0..rings {
        for step in 0..around {
            let (a, b) = (
                (ring + 1) as f64 / (rings + 1) as f64 * PI,
                step as f64 / around as f64 * TAU,
            );
            source.push(dvec3(a.sin() * b.cos(), a.cos(), a.sin() * b.sin()));
            let vertex = |ring: usize, step: usize| (ring * around + step % around) as u32;
            edges.push([vertex(ring, step), vertex(ring, step + 1)]);
            if ring + 1 < rings {
                edges.push([vertex(ring, step), vertex(ring + 1, step)]);
                edges.push([vertex(ring, step), vertex(ring + 1, step + 1)]);
            }
        }
    }
    let target = source
        .iter()
        .map(|p: &Solid| *p * (1.0 + 0.2 * (4.0 * p.y).sin()) + dvec3(0.1 * p.y, 0.0, 0.0))
        .collect();
    (source, target, edges)
}

/// Points on and just outside of the unit sphere, in the order of its rings.
fn shell(count: usize) -> Vec<Solid> {
    let mut state = 99;
    (0..count)
        .map(|i| {
            let y = 0.98 * (1.0 - 2.0 * (i as f64 + 0.5) / count as f64);
            let (r, a) = (
                (1.0 - y * y).sqrt(),
                unit(&mut state) * core::f64::consts::TAU,
            );
            dvec3(r * a.cos(), y, r * a.sin()) * (1.0 + 0.03 * unit(&mut state))
        })
        .collect()
}

fn mesh_rows(criterion: &mut Criterion) {
    let points = shell(POINTS);
    let (source, target, edges) = sphere(25, 40);
    let warp = MeshWarp::construct(
        &source,
        &target,
        &edges,
        Reaches::default(),
        Uncovered::Stay,
    )
    .unwrap();
    let mut neighbours = vec![Vec::new(); source.len()];
    for [a, b] in &edges {
        for (from, to) in [(*a, *b), (*b, *a)] {
            let edge = source[to as usize] - source[from as usize];
            neighbours[from as usize].push(edge);
        }
    }
    let maps: Vec<_> = (0..source.len())
        .map(|i| warp.scaled(anamorph_core::Address::of(i as u32), 1.0))
        .collect();
    let fall = |x: f64, a: f64, b: f64| {
        let t = ((b - x) / (b - a)).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    // The formula as it stands: every vertex, every edge of it.
    let plain = |points: &mut [Solid]| {
        for point in points {
            let (mut moved, mut total) = (Solid::ZERO, 0.0);
            for (i, vertex) in source.iter().enumerate() {
                let away = *point - *vertex;
                let longest = neighbours[i].iter().map(|e| e.length()).fold(0.0, f64::max);
                let mut weight = fall(away.length() / longest, 0.1, 1.0);
                for edge in &neighbours[i] {
                    weight *= fall(away.dot(*edge) / edge.dot(*edge), 0.1, 1.0);
                }
                if weight > 0.0 {
                    moved += maps[i].displacement(*point) * weight;
                    total += weight;
                }
            }
            if total > 0.0 {
                *point += moved / total;
            }
        }
    };
    let mut group = settle(
        criterion,
        "Mesh warp, 1 000 vertices over a million points, 1 thread",
    );
    let few = &points[..POINTS];
    let spread: Vec<Solid> = few.iter().step_by(200).copied().collect();
    row(
        &mut group,
        "baseline: points × vertices × edges",
        &spread,
        plain,
    );
    row(&mut group, "through cells", &points, |p| {
        warp.map_points(0, p);
    });
    group.finish();

    let rest = &points[..POINTS / 5];
    let bound = Bound::new(&warp, Binding::new(&warp, rest));
    let mut group = settle(
        criterion,
        "Binding of a mesh warp, 200 000 points, 1 thread",
    );
    row(&mut group, "baseline: afresh", rest, |p| {
        warp.map_points(0, p);
    });
    row(&mut group, "bound", rest, |p| {
        bound.map_points(0, p);
    });
    group.finish();
}

fn bound_wires(criterion: &mut Criterion) {
    let points = scattered(POINTS / 5);
    let (_, warp) = wires(20, 0.2);
    let bound = Bound::new(&warp, Binding::new(&warp, &points));
    let mut group = settle(criterion, "Binding of 20 wires, 200 000 points, 1 thread");
    row(&mut group, "baseline: afresh", &points, |p| {
        warp.map_points(0, p);
    });
    row(&mut group, "bound", &points, |p| {
        bound.map_points(0, p);
    });
    group.finish();
}

fn bound_lines(criterion: &mut Criterion) {
    let mut state = 7;
    let mut random = || dvec2(unit(&mut state), unit(&mut state));
    let points: Vec<Plane> = (0..40_000).map(|_| random()).collect();
    let mut lines = Vec::new();
    for _ in 0..100 {
        let (from, to): (DVec2, DVec2) = (random(), random());
        let to = from + (to - 0.5) * 0.2;
        let mut nudge = |p: DVec2| p + (random() - 0.5) * 0.04;
        let target = [nudge(from), nudge(to)];
        let pair = ElementPair::of_corners(&[from, to], &target).unwrap();
        let constants = WeightConstants {
            a: 0.01,
            b: 2.0,
            p: 0.5,
        };
        lines.push((pair, constants));
    }
    let warp = local::construct(&lines, Scaling::Displacement).unwrap();
    let all = Bound::new(&warp, Binding::new(&warp, &points));
    let fewer = Binding::new(&warp, &points).without_shares_below(&warp, 1e-3);
    let fewer = Bound::new(&warp, fewer);
    let mut group = settle(
        criterion,
        "Binding of 100 feature lines, 40 000 points, 1 thread",
    );
    row(&mut group, "baseline: term by term", &points, |p| {
        evaluate_points(&warp, 0, p);
    });
    row(&mut group, "kernel", &points, |p| {
        warp.map_points(0, p);
    });
    row(&mut group, "bound", &points, |p| {
        all.map_points(0, p);
    });
    row(
        &mut group,
        "bound, shares below 0.001 dropped",
        &points,
        |p| {
            fewer.map_points(0, p);
        },
    );
    group.finish();
}

criterion_group!(
    benches,
    wire_rows,
    axial_rows,
    mesh_rows,
    bound_wires,
    bound_lines
);
criterion_main!(benches);
