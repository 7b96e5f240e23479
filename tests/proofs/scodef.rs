//! B19: simple constrained deformations meet what can be met, miss the rest by least squares, and stay within their radii.

use anamorph_core::{Deformation, Facts, Linear, Plane, Site, Smoothness, Solid, Space, Warp};
use anamorph_features::PointPair;
use anamorph_tests::measure::same_bits;
use anamorph_tests::random::Random;
use anamorph_warps::scodef::{Basis, Constraint, ScodefWarp};

fn at<S: Space>(warp: &ScodefWarp<S>, p: S) -> S {
    warp.map(&Site::anywhere(p))
}

/// Constraints of random places of the unit box, with radii of about `radius`.
fn constraints<S: Space>(random: &mut Random, count: usize, radius: f64) -> Vec<Constraint<S>> {
    let apart = 0.4 / (count as f64).powf(1.0 / S::DIM as f64);
    let mut list: Vec<Constraint<S>> = Vec::new();
    while list.len() < count {
        let source = S::from_fn(|_| random.between(-1.0, 1.0));
        if list.iter().any(|c| c.pair.source.distance(source) < apart) {
            continue;
        }
        let radii = S::from_fn(|_| random.between(0.7, 1.3) * radius);
        let basis = if list.len().is_multiple_of(2) {
            Basis::BSpline {
                radius: radii.component(0),
            }
        } else {
            Basis::Box { radii }
        };
        let target = source + random.vector::<S>() * 0.2;
        let pair = PointPair { source, target };
        list.push(Constraint { pair, basis });
    }
    list
}

fn b19_meets<S: Space>() {
    let mut random = Random::new(191);
    for (count, radius) in [(1, 0.5), (6, 1.0), (40, 0.5), (200, 0.4)] {
        // Any size, anywhere.
        for (size, offset) in [(1.0, 0.0), (1e-5, 2.0), (3e6, -1e7)] {
            let place = |p: S| S::splat(offset) + p * size;
            let mut list = constraints::<S>(&mut random, count, radius);
            for Constraint { pair, basis } in &mut list {
                (pair.source, pair.target) = (place(pair.source), place(pair.target));
                *basis = match *basis {
                    Basis::BSpline { radius } => Basis::BSpline {
                        radius: radius * size,
                    },
                    Basis::Box { radii } => Basis::Box {
                        radii: radii * size,
                    },
                };
            }
            let warp = ScodefWarp::construct(list.clone()).unwrap();
            assert_eq!((warp.rank(), warp.missed()), (count, None));
            for Constraint { pair, .. } in &list {
                let miss = at(&warp, pair.source).distance(pair.target);
                assert!(miss <= 1e-9 * size, "{count}: {miss:e}");
            }
        }
    }
}

#[test]
fn b19_independent_constraints_are_met() {
    b19_meets::<Plane>();
    b19_meets::<Solid>();
}

/// `D F⁺` by Penrose: what is missed is across every column of `F`, and the coefficients are spanned by its rows: no other `M` misses as little
/// and is smaller.
fn b19_least<S: Space>() {
    let mut random = Random::new(192);
    let mut list = constraints::<S>(&mut random, 8, 1.2);
    // Twice the same, and next to nothing from one another, with displacements of their own.
    list.push(list[2]);
    let mut near = list[4];
    near.pair.source += S::unit(0) * 1e-9;
    near.pair.target += random.vector::<S>() * 0.3;
    list.push(near);
    let warp = ScodefWarp::construct(list.clone()).unwrap();
    assert_eq!(warp.rank(), 8);
    let missed = |warp: &ScodefWarp<S>, c: &Constraint<S>| at(warp, c.pair.source) - c.pair.target;
    let misses: Vec<S> = list.iter().map(|c| missed(&warp, c)).collect();
    for one in &list {
        let across = list.iter().zip(&misses).fold(S::ZERO, |sum, (c, &miss)| {
            sum + miss * one.basis.value(c.pair.source - one.pair.source)
        });
        assert!(across.largest() < 1e-6, "{across:?}");
    }
    // The two that are nearly one miss by as much, the twins not at all.
    assert!((misses[4] + misses[9]).largest() < 1e-6 && misses[4].length() > 1e-3);
    assert!(misses[2].largest() < 1e-6);
    let shares = warp.coefficients();
    assert!((shares[2] - shares[8]).largest() < 1e-6 && shares[2].length() > 1e-6);
    let worst = misses.iter().map(|m| m.length()).fold(0.0, f64::max);
    assert!((warp.missed().unwrap().distance - worst).abs() < 1e-12);
    assert_eq!(warp.facts().notes.len(), 1);
}

#[test]
fn b19_dependent_constraints_are_met_by_least_squares() {
    b19_least::<Plane>();
    b19_least::<Solid>();
}

/// Constraints act together linearly: the warp of the sums of displacements is the sum of the warps.
#[test]
fn b19_displacements_add_up() {
    let mut random = Random::new(193);
    let list = constraints::<Solid>(&mut random, 15, 0.9);
    let with = |by: &dyn Fn(usize) -> Solid| {
        let moved = list.iter().enumerate().map(|(i, c)| Constraint {
            pair: PointPair {
                source: c.pair.source,
                target: c.pair.source + by(i),
            },
            basis: c.basis,
        });
        ScodefWarp::construct(moved.collect()).unwrap()
    };
    let one = |i: usize| Solid::X * (i as f64 * 0.1);
    let two = |i: usize| Solid::new(0.3, -0.1 * i as f64, 0.2);
    let (a, b, both) = (with(&one), with(&two), with(&|i| one(i) + two(i)));
    for _ in 0..200 {
        let p = random.vector::<Solid>();
        let sum = at(&a, p) + at(&b, p) - p;
        assert!((at(&both, p) - sum).largest() < 1e-11);
    }
}

fn b19_ends<S: Space>() {
    let mut random = Random::new(194);
    let list = constraints::<S>(&mut random, 10, 0.4);
    let warp = ScodefWarp::construct(list.clone()).unwrap();
    let facts: Facts<S> = warp.facts();
    assert_eq!(
        (facts.inside, facts.edge),
        (Smoothness::C(2), Smoothness::C(2))
    );
    let stretch = facts.stretch().unwrap();
    let (mut still, mut moved) = (0, 0);
    for _ in 0..4000 {
        let p = S::from_fn(|_| random.between(-2.0, 2.0));
        let within = |c: &Constraint<S>| {
            let d = p - c.pair.source;
            match c.basis {
                Basis::BSpline { radius } => d.length() < radius,
                Basis::Box { radii } => {
                    (0..S::DIM).all(|axis| d.component(axis).abs() < radii.component(axis))
                }
            }
        };
        if !list.iter().any(within) {
            assert!(same_bits(at(&warp, p), p));
            still += 1;
            continue;
        }
        assert!(facts.support.contains(p));
        moved += usize::from(at(&warp, p) != p);
        let change = warp.jacobian(&Site::anywhere(p), 1.0).unwrap() - S::Linear::IDENTITY;
        let longest = (0..20).map(|_| change.apply(random.direction::<S>()).length());
        assert!(longest.fold(0.0, f64::max) <= stretch);
    }
    assert!(still > 500 && moved > 50, "{still}, {moved}");
    assert_eq!(warp.conditions().len(), 10);
}

#[test]
fn b19_constraints_end_at_their_radii() {
    b19_ends::<Plane>();
    b19_ends::<Solid>();
}
