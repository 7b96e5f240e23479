//! B14, B15, A2 on them, and depth of B16: wires and continuous wires.

use anamorph_core::glam::{DVec3, dvec2, dvec3};
use anamorph_core::{
    Curve, Deformation, Differentiable, Influences, Jet, Nearest, NearestPoint, Plane, Sampling,
    Site, Solid, Space, Warp, map_all,
};
use anamorph_curves::{Bezier, Indexed};
use anamorph_fields::falloffs::Wires as Hat;
use anamorph_fields::{Falloff, Profile};
use anamorph_tests::measure::jump_share;
use anamorph_tests::random::Random;
use anamorph_transforms::Rotational;
use anamorph_warps::wires::{Along, Anchor, ContinuousWires, Wire, Wires};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

type Held<S> = Indexed<S, Box<Bezier<S>>>;

fn bezier<S: Space>(points: &[S]) -> Arc<Held<S>> {
    Arc::new(Indexed::new(Box::new(
        Bezier::new(points.to_vec()).unwrap(),
    )))
}

fn random_bezier<S: Space>(random: &mut Random, count: usize) -> Arc<Held<S>> {
    let points: Vec<S> = (0..count).map(|_| random.vector::<S>() * 2.0).collect();
    bezier(&points)
}

fn random_wire<S: Rotational>(random: &mut Random) -> Wire<S> {
    let source = random_bezier(random, 4);
    let target = random_bezier(random, 4);
    Wire::new(source, target, random.between(0.3, 1.5))
}

fn at<S: Space>(warp: &dyn Deformation<S>, p: S) -> S {
    warp.map(&Site::anywhere(p))
}

fn lone_wires_land<S: Rotational>(seed: u64) {
    let mut random = Random::new(seed);
    for round in 0..60 {
        let mut wire = random_wire::<S>(&mut random);
        wire.scale = Along::constant(random.between(0.2, 3.0));
        wire.exponent = [1.0, 0.0, 2.0, -1.0][round % 4];
        wire.locality = [0.0, 2.0][round % 2];
        let crimp = |share: f64| {
            if round % 5 == 0 { share * share } else { share }
        };
        if round % 5 == 0 {
            let points: Vec<[f64; 2]> = (0..=64)
                .map(|i| f64::from(i) / 64.0)
                .map(|s| [s, s * s])
                .collect();
            wire.crimp = Some(Profile::through(&points).unwrap());
        }
        let (source, target) = (wire.source.clone(), wire.target.clone());
        // A wire out of reach, and one that stays: neither changes what the first does (m > 0).
        let mut wires = vec![wire];
        if wires[0].exponent > 0.0 {
            let still = random_bezier::<S>(&mut random, 3);
            wires.push(Wire::new(still.clone(), still, 5.0));
            let far: Vec<S> = (0..4).map(|_| S::splat(100.0) + random.vector()).collect();
            wires.push(Wire::new(bezier(&far), random_bezier(&mut random, 4), 1.0));
        }
        let warp = Wires::construct(wires, None).unwrap();
        for i in 0..=40 {
            let v = f64::from(i) / 40.0;
            let p = source.point(v);
            // A curve that crosses itself is nearest at the smaller parameter.
            let nearest = source.nearest(p).parameter;
            let goal = target.point(crimp(nearest));
            let off = at(&warp, p).distance(goal);
            let allowed = if round % 5 == 0 { 2e-3 } else { 1e-9 };
            assert!(off < allowed, "round {round}, {v}: {off}");
        }
    }
}

#[test]
fn b14_a_lone_wire_lands_on_its_target() {
    lone_wires_land::<Plane>(141);
    lone_wires_land::<Solid>(142);
}

/// The formula of the framework paper, word for word, in space, with the nearest place of many samples.
fn literal(wires: &[Wire<Solid>], p: DVec3) -> DVec3 {
    let (mut moved, mut total) = (DVec3::ZERO, 0.0);
    for wire in wires {
        let (mut v, mut best) = (0.0, f64::INFINITY);
        let (mut low, mut high) = (0.0, 1.0);
        // Four rounds of 4000 samples, each about the best of the last.
        for _ in 0..4 {
            for i in 0..=4000 {
                let here = low + (high - low) * f64::from(i) / 4000.0;
                let distance = p.distance(wire.source.point(here));
                if distance < best {
                    (v, best) = (here, distance);
                }
            }
            let step = (high - low) / 1000.0;
            (low, high) = ((v - step).max(0.0), (v + step).min(1.0));
        }
        let s = Hat.value(best / wire.radius.value(v));
        if s == 0.0 {
            continue;
        }
        let (c, a) = (wire.source.point(v), wire.source.velocity(v).normalize());
        let (goal, b) = (wire.target.point(v), wire.target.velocity(v).normalize());
        let axis = a.cross(b).normalize();
        let angle = a.cross(b).length().atan2(a.dot(b)) * s;
        let scaled = (p - c) * (1.0 + (wire.scale.value(v) - 1.0) * s);
        let q = anamorph_core::glam::DQuat::from_axis_angle(axis, angle) * scaled;
        let moved_to = c + q + (goal - c) * s;
        let w = (moved_to - p).length().powf(wire.exponent) * s.powf(wire.locality);
        moved += (moved_to - p) * w;
        total += w;
    }
    if total > 0.0 { p + moved / total } else { p }
}

#[test]
fn b14_is_the_formula() {
    let mut random = Random::new(143);
    for round in 0..12 {
        let wires: Vec<Wire<Solid>> = (0..3)
            .map(|i| {
                let mut wire = random_wire(&mut random);
                wire.exponent = [1.0, 2.0, 0.0, -0.5][(round + i) % 4];
                wire.locality = [0.0, 3.0][round % 2];
                wire.radius = Along::through(&[[0.0, 0.8], [0.4, 2.0], [1.0, 1.1]]).unwrap();
                wire.scale = Along::through(&[[0.0, 1.4], [1.0, 0.5]]).unwrap();
                wire
            })
            .collect();
        let warp = Wires::construct(wires.clone(), None).unwrap();
        let mut moved = 0;
        for _ in 0..30 {
            let p = random.vector::<Solid>() * 2.0;
            let expected = literal(&wires, p);
            let error = at(&warp, p).distance(expected);
            assert!(error < 1e-6, "{p:?}: {error}");
            moved += usize::from(expected != p);
        }
        assert!(moved > 5);
    }
}

/// A wire bent like a horseshoe, whose arms are told to go different ways: Fig. 16.
fn horseshoe() -> Wire<Plane> {
    let source = [
        dvec2(-1.0, 0.0),
        dvec2(-1.0, 3.0),
        dvec2(1.0, 3.0),
        dvec2(1.0, 0.0),
    ];
    let target = [
        dvec2(-1.0, -0.5),
        dvec2(-1.0, 3.0),
        dvec2(1.0, 3.0),
        dvec2(1.0, 0.5),
    ];
    Wire::new(bezier(&source), bezier(&target), 3.0)
}

#[test]
fn b15_the_tear_of_b14_is_gone() {
    let line: Vec<Plane> = (0..anamorph_tests::measure::SAMPLES)
        .map(|i| {
            dvec2(
                -0.7 + 1.4 * i as f64 / (anamorph_tests::measure::SAMPLES - 1) as f64,
                0.3,
            )
        })
        .collect();
    let moved = |warp: &dyn Deformation<Plane>| {
        let mut moved = line.clone();
        map_all(warp, &mut moved);
        let largest = moved
            .windows(2)
            .map(|p| p[0].distance(p[1]))
            .fold(0.0, f64::max);
        (jump_share(&moved, 0), largest)
    };
    let torn = moved(&Wires::construct(vec![horseshoe()], None).unwrap());
    // The arms go 0.5 down and 0.5 up; the strength there is (1 − 1/9)², and more than half a unit tears.
    assert!(torn.0 > 0.9 && torn.1 > 0.5, "{torn:?}");
    for sampling in [
        Sampling::Uniform(64),
        Sampling::GaussLegendre(24),
        Sampling::Adaptive(1e-6),
    ] {
        let warp = ContinuousWires::construct(vec![horseshoe()], sampling, None).unwrap();
        let whole = moved(&warp);
        assert!(whole.0 < 0.2 && whole.1 < 2e-3, "{sampling:?}: {whole:?}");
    }
    // Sampled at the nearest place alone it is Wires again.
    let nearest = ContinuousWires::construct(vec![horseshoe()], Sampling::Nearest, None).unwrap();
    assert!(moved(&nearest).1 > 0.5);
    // The verdicts say the same.
    let smooth = ContinuousWires::construct(vec![horseshoe()], Sampling::Uniform(64), None);
    let facts = smooth.unwrap().facts();
    assert_eq!(facts.smoothness(), anamorph_core::Smoothness::C(0));
    assert_eq!(
        Wires::construct(vec![horseshoe()], None)
            .unwrap()
            .facts()
            .smoothness(),
        anamorph_core::Smoothness::Jump
    );
}

/// Hard wires for quadrature: a cusp, a loop, a corner of speeds, several exponents.
fn hard(round: usize) -> Vec<Wire<Plane>> {
    let curves: [[Plane; 4]; 3] = [
        [
            dvec2(-1.0, 0.0),
            dvec2(1.0, 1.0),
            dvec2(-1.0, 1.0),
            dvec2(1.0, 0.0),
        ],
        [
            dvec2(-1.0, 0.0),
            dvec2(3.0, 1.5),
            dvec2(-3.0, 1.5),
            dvec2(1.0, 0.0),
        ],
        [
            dvec2(-1.0, 0.2),
            dvec2(-0.9, 0.2),
            dvec2(0.9, 0.9),
            dvec2(1.0, -0.3),
        ],
    ];
    let target = [
        dvec2(-1.2, 0.4),
        dvec2(0.2, 1.4),
        dvec2(0.3, -0.5),
        dvec2(1.3, 0.6),
    ];
    let mut wire = Wire::new(bezier(&curves[round % 3]), bezier(&target), 0.9);
    wire.exponent = [0.0, 1.0, 2.0, 0.5][round % 4];
    vec![wire]
}

#[test]
fn a2_each_sampling_has_its_error() {
    let mut random = Random::new(2);
    for round in 0..12 {
        let build = |sampling| ContinuousWires::construct(hard(round), sampling, None).unwrap();
        let fine = build(Sampling::Uniform(60_000));
        let points: Vec<Plane> = (0..12).map(|_| random.vector::<Plane>()).collect();
        let exact: Vec<Plane> = points.iter().map(|&p| at(&fine, p)).collect();
        let largest = points
            .iter()
            .zip(&exact)
            .map(|(p, q)| p.distance(*q))
            .fold(0.0, f64::max);
        // What the fine quadrature itself errs by.
        let half = build(Sampling::Uniform(30_000));
        let own = points
            .iter()
            .zip(&exact)
            .map(|(&p, q)| at(&half, p).distance(*q));
        let own = 2.0 * own.fold(0.0, f64::max);
        assert!(own < 1e-4 * largest);
        let error = |sampling| {
            let warp = build(sampling);
            let off = points
                .iter()
                .zip(&exact)
                .map(|(&p, q)| at(&warp, p).distance(*q));
            off.fold(0.0, f64::max)
        };
        for tolerance in [1e-2, 1e-4, 1e-6] {
            if round % 3 == 1 && tolerance < 1e-5 {
                // The rotation of a loop changes its sense somewhere: even cells find that to half their width only.
                continue;
            }
            let off = error(Sampling::Adaptive(tolerance));
            assert!(
                off <= tolerance * largest + own,
                "round {round}: {off:e} of {largest} at {tolerance:e}"
            );
        }
        // The second order, but for corners where displacements vanish, and the first where a loop's rotation jumps.
        let (coarse, dense) = (error(Sampling::Uniform(50)), error(Sampling::Uniform(1600)));
        let order = (coarse / dense).ln() / 32.0_f64.ln();
        assert!(
            order > if round % 3 == 1 { 0.9 } else { 1.4 },
            "round {round}: {coarse:e}, {dense:e}, order {order}"
        );
        assert!(error(Sampling::GaussLegendre(256)) < 1e-2 * largest);
    }
    // Where everything is smooth the order is two.
    let wires = || {
        vec![Wire {
            exponent: 0.0,
            radius: Along::constant(6.0),
            ..horseshoe()
        }]
    };
    let warp = |sampling| ContinuousWires::construct(wires(), sampling, None).unwrap();
    let p = dvec2(0.2, 0.7);
    let exact = at(&warp(Sampling::GaussLegendre(200)), p);
    let off = |n| at(&warp(Sampling::Uniform(n)), p).distance(exact);
    for n in [40, 80, 160] {
        let ratio = off(n) / off(2 * n);
        assert!((3.7..4.3).contains(&ratio), "{n}: {ratio}");
    }
    let gauss = at(&warp(Sampling::GaussLegendre(80)), p).distance(exact);
    assert!(gauss < 1e-8, "{gauss:e}");
}

#[test]
fn a2_adaptive_nodes_bind_and_serve_other_targets() {
    use anamorph_core::{Binding, evaluate_points};
    let mut random = Random::new(3);
    let points: Vec<Plane> = (0..200).map(|_| random.vector::<Plane>() * 1.5).collect();
    let build = |target: f64, sampling| {
        let mut wires = hard(5);
        let points = [dvec2(-1.2, target), dvec2(0.2, 0.9), dvec2(1.3, 0.6)];
        wires[0].target = bezier(&points);
        ContinuousWires::construct(wires, sampling, None).unwrap()
    };
    let first = build(0.4, Sampling::Adaptive(1e-6));
    let binding = Binding::new(&first, &points);
    let (mut bound, mut direct) = (points.clone(), points.clone());
    assert!(binding.map_points(&first, 0, &mut bound).is_empty());
    evaluate_points(&first, 0, &mut direct);
    assert_eq!(bound, direct);
    // Another target by the same nodes: no longer to the tolerance, but near.
    let other = build(0.1, Sampling::Adaptive(1e-6));
    let mut bound = points.clone();
    binding.map_points(&other, 0, &mut bound);
    let fine = build(0.1, Sampling::Uniform(20_000));
    let off = points
        .iter()
        .zip(&bound)
        .map(|(&p, q)| at(&fine, p).distance(*q));
    assert!(off.fold(0.0, f64::max) < 1e-3);
}

/// The same curve with another parameter: `v` becomes `v²`-like.
struct Hurried(Arc<Held<Plane>>);
impl Hurried {
    fn inner(u: f64) -> (f64, f64, f64) {
        (0.3 * u + 0.7 * u * u, 0.3 + 1.4 * u, 1.4)
    }
}
impl Curve<Plane> for Hurried {
    fn domain(&self) -> (f64, f64) {
        (0.0, 1.0)
    }
    fn point(&self, u: f64) -> Plane {
        self.0.point(Self::inner(u).0)
    }
}
impl Differentiable<Plane> for Hurried {
    fn jet(&self, u: f64) -> Jet<Plane> {
        let (v, d, dd) = Self::inner(u);
        let jet = self.0.jet(v);
        Jet {
            point: jet.point,
            first: jet.first * d,
            second: jet.second * d * d + jet.first * dd,
            third: jet.third * d * d * d + jet.second * (3.0 * d * dd),
        }
    }
    fn breaks(&self) -> Vec<f64> {
        vec![0.0, 1.0]
    }
}
impl NearestPoint<Plane> for Hurried {
    fn nearest(&self, to: Plane) -> Nearest<Plane> {
        let found = self.0.nearest(to);
        let u = (-0.3 + (0.09 + 2.8 * found.parameter).sqrt()) / 1.4;
        Nearest {
            parameter: u,
            ..found
        }
    }
}

#[test]
fn b15_another_parameter_changes_nothing() {
    let plain = horseshoe();
    let ends = [
        [
            dvec2(-1.0, 0.0),
            dvec2(-1.0, 3.0),
            dvec2(1.0, 3.0),
            dvec2(1.0, 0.0),
        ],
        [
            dvec2(-1.0, -0.5),
            dvec2(-1.0, 3.0),
            dvec2(1.0, 3.0),
            dvec2(1.0, 0.5),
        ],
    ];
    let hurried = Wire {
        source: Arc::new(Hurried(bezier(&ends[0]))),
        target: Arc::new(Hurried(bezier(&ends[1]))),
        ..plain.clone()
    };
    let mut random = Random::new(17);
    // Nodes are even in length: the same nodes, so that few of them agree as well as many.
    for (sampling, tolerance) in [
        (Sampling::Uniform(7), 1e-8),
        (Sampling::GaussLegendre(5), 1e-8),
        (Sampling::Adaptive(1e-9), 1e-8),
    ] {
        let [a, b] = [&plain, &hurried]
            .map(|w| ContinuousWires::construct(vec![w.clone()], sampling, None).unwrap());
        for _ in 0..50 {
            let p = random.vector::<Plane>() * 2.0;
            let off = at(&a, p).distance(at(&b, p));
            assert!(off < tolerance, "{sampling:?}: {off:e}");
        }
    }
}

#[test]
fn b14_options_do_what_they_say() {
    let line = |y: f64| bezier(&[dvec2(0.0, y), dvec2(4.0, y)]);
    let base = || Wire::new(line(0.0), line(1.0), 1.0);
    let lift =
        |wire: Wire<Plane>, p: Plane| at(&Wires::construct(vec![wire], None).unwrap(), p).y - p.y;
    // Radius and scale drawn along the wire.
    let radius = Along::through(&[[0.0, 0.5], [1.0, 2.0]]).unwrap();
    let wire = || Wire {
        radius: radius.clone(),
        ..base()
    };
    assert_eq!(lift(wire(), dvec2(0.0, 0.5)), 0.0);
    assert!((lift(wire(), dvec2(4.0, 1.0)) - Hat.value(0.5)).abs() < 1e-12);
    let scale = Along::through(&[[0.0, 1.0], [1.0, 3.0]]).unwrap();
    let wire = Wire { scale, ..base() };
    let s = Hat.value(0.5);
    assert!((lift(wire, dvec2(4.0, 0.5)) - (s + 0.5 * 2.0 * s)).abs() < 1e-12);
    // A domain curve at height 3: upwards the wire reaches just to it, downwards as far as its radius.
    let wire = || Wire {
        domain: Some(line(3.0)),
        ..base()
    };
    assert!((lift(wire(), dvec2(2.0, 1.5)) - Hat.value(0.5)).abs() < 1e-12);
    assert_eq!(lift(wire(), dvec2(2.0, 3.0)), 0.0);
    assert_eq!(lift(wire(), dvec2(2.0, -1.0)), 0.0);
    assert!((lift(wire(), dvec2(2.0, -0.5)) - Hat.value(0.5)).abs() < 1e-12);
    // Anchors hold what is near, and nothing beyond their radius.
    let anchor = Anchor {
        curve: bezier(&[dvec2(2.0, -3.0), dvec2(2.0, 3.0)]),
        radius: 0.5,
    };
    let wire = || Wire {
        anchors: vec![anchor.clone()],
        ..base()
    };
    assert_eq!(lift(wire(), dvec2(2.0, 0.3)), 0.0);
    assert_eq!(lift(wire(), dvec2(3.0, 0.3)), lift(base(), dvec2(3.0, 0.3)));
    let half = lift(wire(), dvec2(2.25, 0.0));
    assert!((half - (1.0 - Hat.value(0.5))).abs() < 1e-12);
    // Locality: the wire that is near decides more.
    let two = |locality: f64| {
        let near = Wire {
            locality,
            exponent: 0.0,
            ..base()
        };
        let far = Wire {
            source: line(0.8),
            target: line(-0.2),
            locality,
            exponent: 0.0,
            ..base()
        };
        at(
            &Wires::construct(vec![near, far], None).unwrap(),
            dvec2(2.0, 0.1),
        )
        .y - 0.1
    };
    assert!(
        two(0.0) < two(2.0) && two(2.0) < two(8.0),
        "{} {} {}",
        two(0.0),
        two(2.0),
        two(8.0)
    );
    assert!((two(8.0) - Hat.value(0.1)).abs() < 0.05);
    // Exponents: larger displacements win with larger ones, smaller ones with negative ones.
    let pull = |exponent: f64| {
        let strong = Wire {
            target: line(3.0),
            exponent,
            ..base()
        };
        let weak = Wire {
            target: line(0.5),
            exponent,
            ..base()
        };
        at(
            &Wires::construct(vec![strong, weak], None).unwrap(),
            dvec2(2.0, 0.0),
        )
        .y
    };
    assert!((pull(0.0) - 1.75).abs() < 1e-12);
    assert!((pull(1.0) - (9.0 + 0.25) / 3.5).abs() < 1e-12);
    assert!(pull(12.0) > 2.99 && pull(-12.0) < 0.51);
}

/// A curve that counts how often its nearest point is searched.
struct Counting(Arc<Held<Solid>>, Arc<AtomicUsize>);
impl Curve<Solid> for Counting {
    fn domain(&self) -> (f64, f64) {
        self.0.domain()
    }
    fn point(&self, u: f64) -> Solid {
        self.0.point(u)
    }
}
impl Differentiable<Solid> for Counting {
    fn jet(&self, u: f64) -> Jet<Solid> {
        self.0.jet(u)
    }
    fn breaks(&self) -> Vec<f64> {
        self.0.breaks()
    }
}
impl NearestPoint<Solid> for Counting {
    fn nearest(&self, to: Solid) -> Nearest<Solid> {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.nearest(to)
    }
    fn nearest_within(&self, to: Solid, reach: f64) -> Option<Nearest<Solid>> {
        let found = self.0.nearest_within(to, reach);
        self.1
            .fetch_add(usize::from(found.is_some()), Ordering::Relaxed);
        found
    }
}

#[test]
fn b14_points_out_of_reach_are_not_searched_for() {
    let count = Arc::new(AtomicUsize::new(0));
    let mut random = Random::new(20);
    let mut wires = Vec::new();
    for i in 0..20 {
        let offset = dvec3(f64::from(i % 5), f64::from(i / 5), 0.0) * 10.0;
        let curve = |random: &mut Random| {
            let points: Vec<Solid> = (0..4).map(|_| offset + random.vector::<Solid>()).collect();
            bezier(&points)
        };
        let source = Counting(curve(&mut random), count.clone());
        wires.push(Wire::new(Arc::new(source), curve(&mut random), 0.5));
    }
    let warp = Wires::construct(wires, None).unwrap();
    count.store(0, Ordering::Relaxed);
    let points: Vec<Solid> = (0..20_000)
        .map(|_| {
            let at: DVec3 = random.vector();
            (at * 0.5 + 0.5) * dvec3(40.0, 30.0, 1.0)
        })
        .collect();
    let mut moved = points.clone();
    map_all(&warp, &mut moved);
    let changed = points.iter().zip(&moved).filter(|(a, b)| a != b).count();
    let searched = count.load(Ordering::Relaxed);
    assert!(
        changed > 100 && searched <= 2 * changed,
        "{searched} for {changed}"
    );
}

#[test]
fn b16_depth_is_unchanged() {
    let mut random = Random::new(160);
    for round in 0..40 {
        let view = if round % 2 == 0 {
            Solid::Z
        } else {
            random.direction()
        };
        let wires: Vec<Wire<Solid>> = (0..1 + round % 3)
            .map(|_| {
                let mut wire = random_wire(&mut random);
                wire.scale = Along::constant(random.between(0.5, 2.0));
                wire.radius = Along::constant(2.0);
                wire
            })
            .collect();
        let plain = Wires::construct(wires.clone(), Some(view)).unwrap();
        let smooth = ContinuousWires::construct(wires.clone(), Sampling::Uniform(40), Some(view));
        let smooth = smooth.unwrap();
        let mut moved = 0.0_f64;
        for _ in 0..50 {
            let p = random.vector::<Solid>() * 2.0;
            for q in [at(&plain, p), at(&smooth, p)] {
                let depth = (q - p).dot(view).abs();
                assert!(depth <= 1e-12, "{depth:e}");
                moved = moved.max(p.distance(q));
                if view == Solid::Z {
                    assert_eq!(q.z.to_bits(), p.z.to_bits());
                }
            }
        }
        assert!(moved > 0.1);
        // On a lone wire, points land on the target as seen along the view.
        if wires.len() == 1 {
            let p = wires[0].source.point(0.37);
            let to = wires[0].target.point(wires[0].source.nearest(p).parameter);
            let off = at(&plain, p) - to;
            assert!((off - view * view.dot(off)).length() < 1e-9);
        }
    }
}

#[test]
fn bad_curves_are_refused_or_answered() {
    use anamorph_warps::wires::WireError;
    // One point, and a cusp in the middle of a wire that doubles back: finite answers.
    let point = bezier(&[dvec2(0.5, 0.5), dvec2(0.5, 0.5)]);
    let there = bezier(&[dvec2(2.0, 0.5), dvec2(2.0, 0.5)]);
    let warp = Wires::construct(vec![Wire::new(point.clone(), there, 1.0)], None).unwrap();
    assert_eq!(at(&warp, dvec2(0.5, 0.5)), dvec2(2.0, 0.5));
    let still = ContinuousWires::construct(
        vec![Wire::new(point.clone(), point.clone(), 1.0)],
        Sampling::Uniform(5),
        None,
    );
    assert!(matches!(
        still.err(),
        Some(WireError::NoLength { feature: 0, .. })
    ));
    let back = bezier(&[dvec2(0.0, 0.0), dvec2(2.0, 0.0), dvec2(0.0, 0.0)]);
    let bent = bezier(&[dvec2(0.0, 1.0), dvec2(2.0, 2.0), dvec2(0.0, 1.5)]);
    for sampling in [
        Sampling::Nearest,
        Sampling::Uniform(9),
        Sampling::GaussLegendre(9),
        Sampling::Adaptive(1e-6),
    ] {
        let wire = vec![Wire::new(back.clone(), bent.clone(), 1.0)];
        let warp = ContinuousWires::construct(wire, sampling, None).unwrap();
        for i in 0..200 {
            let p = dvec2(f64::from(i) * 0.01, 0.01);
            assert!(at(&warp, p).is_finite());
        }
        let mut list = Influences::default();
        warp.influences(&Site::anywhere(dvec2(0.5, 0.1)), &mut list);
        assert!(!list.list.is_empty());
    }
    // Far from the origin the result is the same, to rounding.
    let far = dvec2(1e7, -3e6);
    let shifted = |points: &[Plane]| {
        let points: Vec<Plane> = points.iter().map(|p| *p + far).collect();
        bezier(&points)
    };
    let (a, b) = (
        [dvec2(0.0, 0.0), dvec2(2.0, 0.0), dvec2(3.0, 1.0)],
        [dvec2(3.0, 1.0), dvec2(2.0, 0.0), dvec2(0.0, 0.0)],
    );
    let near = Wires::construct(vec![Wire::new(bezier(&a), bezier(&b), 1.0)], None).unwrap();
    let away = Wires::construct(vec![Wire::new(shifted(&a), shifted(&b), 1.0)], None).unwrap();
    for i in 0..50 {
        let p = dvec2(0.04 * f64::from(i), 0.3);
        assert!((at(&near, p) + far).distance(at(&away, p + far)) < 1e-6);
    }
    // What is refused, by name.
    let good = || Wire::new(back.clone(), bent.clone(), 1.0);
    let refused = |wire: Wire<Plane>| Wires::construct(vec![wire], None).err().unwrap();
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = refused(Wire {
            radius: Along::constant(radius),
            ..good()
        });
        assert!(
            matches!(error, WireError::Radius { feature: 0, .. }),
            "{error}"
        );
    }
    let error = refused(Wire {
        exponent: f64::NAN,
        ..good()
    });
    assert!(error.to_string().contains("exponent"));
    let error = refused(Wire {
        locality: -1.0,
        ..good()
    });
    assert!(error.to_string().contains("locality"));
    let error = refused(Wire {
        scale: Along::constant(f64::NAN),
        ..good()
    });
    assert!(error.to_string().contains("scale"));
    assert_eq!(
        Wires::<Plane>::construct(Vec::new(), None).err(),
        Some(WireError::None)
    );
    let view = Wires::construct(vec![good()], Some(dvec2(1.0, 0.0))).err();
    assert_eq!(view, Some(WireError::View));
    let sampling = ContinuousWires::construct(vec![good()], Sampling::Adaptive(0.0), None);
    assert_eq!(sampling.err(), Some(WireError::Sampling));
    struct Lost;
    impl Curve<Plane> for Lost {
        fn domain(&self) -> (f64, f64) {
            (0.0, 1.0)
        }
        fn point(&self, _: f64) -> Plane {
            dvec2(f64::NAN, 0.0)
        }
    }
    impl Differentiable<Plane> for Lost {
        fn jet(&self, _: f64) -> Jet<Plane> {
            let nan = dvec2(f64::NAN, 0.0);
            Jet {
                point: nan,
                first: nan,
                second: nan,
                third: nan,
            }
        }
        fn breaks(&self) -> Vec<f64> {
            vec![0.0, 1.0]
        }
    }
    let error = refused(Wire {
        target: Arc::new(Lost),
        ..good()
    });
    assert_eq!(
        error,
        WireError::NotFinite {
            feature: 0,
            which: "target"
        }
    );
    // The kernel leaves what is not a number to the engine.
    let mut points = vec![dvec2(f64::NAN, 0.0), dvec2(0.5, 0.0)];
    let warp = Wires::construct(vec![good()], None).unwrap();
    assert_eq!(map_all(&warp, &mut points).indices(), [0]);
}
