//! One value, many ways to compute it: the literal formula, kernels, single sites, runs, threads, bindings.

use crate::laws;
use anamorph_core::{
    Binding, Deformation, Masked, Modulated, Site, Space, Stack, Unmapped, Warp, evaluate_points,
    map_all, map_all_parallel, reference,
};
use anamorph_tests::measure::{first_difference, same_bits};
use anamorph_tests::settings::retargetings;
use anamorph_tests::subjects::{Registered, Subject};
use std::sync::Arc;

laws!(
    kernels_equal_the_literal_formula,
    kernels_equal_the_literal_formula_on_long_runs,
    single_sites_equal_runs_to_the_bit,
    results_do_not_depend_on_the_cutting_into_runs,
    results_do_not_depend_on_threads,
    neutral_wrappers_change_no_bit,
    bound_equals_direct,
    bindings_serve_new_targets,
    finite_points_stay_finite,
);

/// The points moved by the warp's kernel.
fn moved<S: Space>(warp: &dyn Deformation<S>, points: &[S]) -> Vec<S> {
    let mut moved = points.to_vec();
    assert!(warp.map_points(0, &mut moved).is_empty());
    moved
}

/// Holds moved points to the literal evaluator, to 1e-12 of the size of the numbers in play.
fn check_against_reference<S: Registered>(subject: &Subject<S>, points: &[S], moved: &[S]) {
    let warp = subject.warp();
    for (index, (&p, &q)) in points.iter().zip(moved).enumerate() {
        let literal = reference::evaluate(&warp, &Site::new(index, p));
        let scale = subject.scale().max(p.largest()).max(literal.largest());
        let error = (q - literal).largest();
        assert!(
            error <= 1e-12 * scale,
            "{subject}\nat {p:?}: {q:?} for {literal:?}, {} of scale",
            error / scale
        );
    }
}

fn kernels_equal_the_literal_formula<S: Registered>() {
    for (i, subject) in Subject::<S>::all().iter().enumerate() {
        let points = subject.points(120, 1 + i as u64);
        check_against_reference(subject, &points, &moved(&subject.warp(), &points));
    }
}

fn kernels_equal_the_literal_formula_on_long_runs<S: Registered>() {
    for subject in Subject::<S>::examples() {
        let points = subject.points(10_007, 5);
        let warp = subject.warp();
        // Every length of a tail, and the lengths about the engine's runs.
        for count in (0..=20).chain([511, 512, 513]) {
            let part = moved(&warp, &points[..count]);
            check_against_reference(&subject, &points[..count], &part);
        }
        check_against_reference(&subject, &points, &moved(&warp, &points));
    }
}

fn single_sites_equal_runs_to_the_bit<S: Registered>() {
    for (i, subject) in Subject::<S>::all().iter().enumerate() {
        let (points, warp) = (subject.points(203, 300 + i as u64), subject.warp());
        let run = moved(&warp, &points);
        for (index, (&p, &q)) in points.iter().zip(&run).enumerate() {
            let single = warp.map(&Site::new(index, p));
            assert!(
                same_bits(single, q),
                "{subject}\nat {p:?}: {single:?}, {q:?}"
            );
        }
    }
}

fn results_do_not_depend_on_the_cutting_into_runs<S: Registered>() {
    for subject in Subject::<S>::some() {
        let (points, warp) = (subject.points(1031, 9), subject.warp());
        let whole = moved(&warp, &points);
        for run in [1, 3, 8, 17, 500] {
            let mut cut = points.clone();
            for (number, chunk) in cut.chunks_mut(run).enumerate() {
                warp.map_points(number * run, chunk);
            }
            assert_eq!(
                first_difference(&whole, &cut),
                None,
                "{subject}, runs of {run}"
            );
        }
    }
}

fn results_do_not_depend_on_threads<S: Registered>() {
    let pools: Vec<rayon::ThreadPool> = [1, 2, 7]
        .iter()
        .map(|&n| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(n)
                .build()
                .unwrap()
        })
        .collect();
    for subject in Subject::<S>::examples() {
        // More than one task of the engine, the last one short, with points that cannot be moved.
        let mut points = subject.points(20_011, 4);
        points[12_345] = S::splat(f64::NAN);
        points[20_000] = S::splat(f64::INFINITY);
        let warp = subject.warp();
        let mut alone = points.clone();
        let unmapped = map_all(&warp, &mut alone);
        assert!(unmapped.indices().contains(&12_345), "{subject}");
        for pool in &pools {
            let mut parallel = points.clone();
            let counted = std::sync::atomic::AtomicUsize::new(0);
            let done = |n| {
                counted.fetch_add(n, std::sync::atomic::Ordering::Relaxed);
            };
            let named = pool.install(|| map_all_parallel(&warp, &mut parallel, &done));
            assert_eq!(named, unmapped, "{subject}");
            assert_eq!(counted.into_inner(), points.len());
            assert_eq!(first_difference(&alone, &parallel), None, "{subject}");
        }
    }
}

fn neutral_wrappers_change_no_bit<S: Registered>() {
    for subject in Subject::<S>::some() {
        let points = subject.points(517, 6);
        let plain = moved(&subject.warp(), &points);
        let one = || Box::new(1.0);
        let shared: Arc<dyn Warp<S>> = Arc::from(subject.warp());
        let wrapped: [(&str, Box<dyn Deformation<S>>); 9] = [
            ("box", Box::new(subject.warp())),
            ("shared", Box::new(shared)),
            ("stack", Box::new(Stack::new(vec![subject.warp()]))),
            ("mask", Box::new(Masked::new(subject.warp(), one()))),
            ("plain modulation", Box::new(Modulated::new(subject.warp()))),
            (
                "strength",
                Box::new(Modulated::new(subject.warp()).with_strength(one())),
            ),
            (
                "weight",
                Box::new(Modulated::new(subject.warp()).with_weight(one())),
            ),
            (
                "both",
                Box::new(
                    Modulated::new(subject.warp())
                        .with_strength(one())
                        .with_weight(one()),
                ),
            ),
            (
                "nested",
                Box::new(Masked::new(
                    Box::new(Stack::new(vec![Box::new(Modulated::new(subject.warp()))])),
                    one(),
                )),
            ),
        ];
        for (name, wrapper) in &wrapped {
            let through = moved(wrapper, &points);
            assert_eq!(
                first_difference(&plain, &through),
                None,
                "{name}: {subject}"
            );
            for (index, &p) in points.iter().enumerate().take(40) {
                let single = wrapper.map(&Site::new(index, p));
                assert!(
                    same_bits(single, plain[index]),
                    "{name}, one site: {subject}"
                );
            }
        }
    }
}

fn bound_equals_direct<S: Registered>() {
    for subject in Subject::<S>::all() {
        let (points, warp) = (subject.points(97, 8), subject.warp());
        let binding = Binding::new(&warp, &points);
        assert_eq!(binding.len(), points.len());
        let (mut bound, mut direct) = (points.clone(), points.clone());
        assert!(binding.map_points(&warp, 0, &mut bound).is_empty());
        evaluate_points(&warp, 0, &mut direct);
        assert_eq!(first_difference(&direct, &bound), None, "{subject}");
        for ((&p, &b), &k) in points.iter().zip(&bound).zip(&moved(&warp, &points)) {
            let scale = subject.scale().max(p.largest()).max(k.largest());
            assert!((b - k).largest() <= 1e-12 * scale, "{subject}\nat {p:?}");
        }
        // A part of the model, and more points than were bound.
        let mut part = points[40..].to_vec();
        part.push(S::ZERO);
        assert_eq!(binding.map_points(&warp, 40, &mut part).indices(), [97]);
        assert_eq!(first_difference(&direct[40..], &part[..57]), None);
    }
}

fn bindings_serve_new_targets<S: Registered>() {
    for bounds in anamorph_tests::models::boxes::<S>() {
        for [first, second] in retargetings::<S>() {
            let (first, second) = (Subject::new(first, bounds), Subject::new(second, bounds));
            let points = first.points(203, 12);
            let binding = Binding::new(&first.warp(), &points);
            let (mut bound, mut direct) = (points.clone(), points.clone());
            let target = second.warp();
            binding.map_points(&target, 0, &mut bound);
            evaluate_points(&target, 0, &mut direct);
            assert_eq!(first_difference(&direct, &bound), None, "{first}\n{second}");
            assert_ne!(first_difference(&points, &bound), None, "{second}");
        }
    }
}

fn finite_points_stay_finite<S: Registered>() {
    let mut random = anamorph_tests::random::Random::new(31);
    let mut points: Vec<S> = (0..600)
        .map(|_| {
            S::from_fn(|_| {
                let size = anamorph_core::math::pow(10.0, random.between(-150.0, 150.0));
                size * random.between(-1.0, 1.0)
            })
        })
        .collect();
    for value in [0.0, -0.0, 1e150, -1e150, f64::MIN_POSITIVE, 5e-324, 1e-320] {
        points.push(S::splat(value));
        points.push(S::unit(0) * value);
    }
    for subject in Subject::<S>::all() {
        let warp = subject.warp();
        let mut moved = points.clone();
        let unmapped = map_all(&warp, &mut moved);
        for (index, (&p, &q)) in points.iter().zip(&moved).enumerate() {
            assert!(q.is_finite(), "{subject}\nat {p:?}");
            if unmapped.indices().contains(&index) {
                assert!(same_bits(p, q), "{subject}: not put back");
            }
        }
        // A polynomial of the coordinate may leave the range of numbers, a power of the distance too, nothing else does.
        let leaves = ["polynomial", "cubic"];
        if leaves.iter().any(|word| subject.to_string().contains(word)) {
            continue;
        }
        assert_eq!(unmapped, Unmapped::none(), "{subject}");
        // What was infinite or undefined stays and is named.
        let mut bad = vec![S::splat(f64::NAN), S::splat(f64::INFINITY), S::ZERO];
        let named = map_all(&warp, &mut bad);
        assert!(named.indices().contains(&0), "{subject}");
        assert!(!bad[0].is_finite() && !bad[1].is_finite() && bad[2].is_finite());
    }
}
