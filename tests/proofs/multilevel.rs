//! B8: multilevel lattices come nearer level by level, meet points that share no control point, and do not fold where they say so.

use anamorph_core::{
    Bounds, Deformation, Linear, Plane, Site, Smoothness, Solid, Space, Support, glam::dvec2,
    map_all,
};
use anamorph_features::PointPair;
use anamorph_tests::random::Random;
use anamorph_warps::multilevel::{Hierarchy, Multilevel, MultilevelError};

fn unit<S: Space>() -> Bounds<S> {
    Bounds::new(S::ZERO, S::splat(1.0))
}

/// Points in the middle of the unit box that move by up to `move_by`.
fn pairs<S: Space>(random: &mut Random, count: usize, move_by: f64) -> Vec<PointPair<S>> {
    (0..count)
        .map(|_| {
            let source = S::from_fn(|_| random.between(0.15, 0.85));
            let step = S::from_fn(|_| random.between(-move_by, move_by));
            PointPair {
                source,
                target: source + step,
            }
        })
        .collect()
}

fn with(levels: usize) -> Hierarchy {
    Hierarchy {
        levels: Some(levels),
        ..Hierarchy::default()
    }
}

fn b8_residuals<S: Space>() {
    let mut random = Random::new(8);
    for count in [1, 3, 10, 40, 150] {
        for one_to_one in [false, true] {
            for still_faces in [false, true] {
                let levels = if S::DIM == 2 { 6 } else { 4 };
                let hierarchy = Hierarchy {
                    one_to_one,
                    still_faces,
                    ..with(levels)
                };
                let list = pairs::<S>(&mut random, count, 0.1);
                let warp = Multilevel::construct(list.clone(), unit(), hierarchy).unwrap();
                let mut last = warp.before();
                for now in warp.residuals() {
                    // A level either lessens the misses or adds nothing.
                    let falls = now.root_mean_square < last.root_mean_square;
                    assert!(falls == (now.passes > 0) || now == warp.residuals().last().unwrap());
                    assert!(now.root_mean_square <= last.root_mean_square);
                    last = *now;
                }
                // Moves in all directions of many points at once take finer levels, or cannot be made one to one.
                let share = if count <= 3 { 0.3 } else { 1.0 };
                assert!(last.root_mean_square < share * warp.before().root_mean_square);
                // What is reported is so.
                let mut points: Vec<S> = list.iter().map(|pair| pair.source).collect();
                map_all(&warp, &mut points);
                let misses = points.iter().zip(&list).map(|(p, q)| p.distance(q.target));
                let largest = misses.fold(0.0, f64::max);
                assert!((largest - last.largest).abs() < 1e-13, "{largest} {last:?}");
                if !one_to_one {
                    assert_eq!(warp.lattices().len(), 1);
                }
            }
        }
    }
}

#[test]
fn b8_residuals_fall_level_by_level_and_are_true() {
    b8_residuals::<Plane>();
    b8_residuals::<Solid>();
}

fn b8_separate<S: Space>() {
    let mut random = Random::new(80);
    for count in [2, 5, 12] {
        let list = pairs::<S>(&mut random, count, 0.2);
        let levels = if S::DIM == 2 { 10 } else { 7 };
        let warp = Multilevel::construct(list.clone(), unit(), with(levels)).unwrap();
        let last = *warp.residuals().last().unwrap();
        // The first level at which no two points are within four spans of each other along every axis is the last.
        let spans = |levels: usize| f64::from(1_u32 << levels);
        let shared = |levels: usize| {
            let span = |x: f64| (x * spans(levels)).floor();
            let near = |a: S, b: S| {
                (0..S::DIM).all(|i| (span(a.component(i)) - span(b.component(i))).abs() <= 3.0)
            };
            let pairs = (0..count).flat_map(|i| (0..i).map(move |j| (i, j)));
            let mut pairs = pairs.map(|(i, j)| near(list[i].source, list[j].source));
            pairs.any(|near| near)
        };
        let first = (0..levels).find(|&level| !shared(level));
        let finest = first.unwrap_or(levels - 1);
        assert_eq!(last.spans[0], 1 << finest);
        if first.is_some() {
            assert!(last.largest < 1e-14, "{last:?}");
            for pair in &list {
                let image = warp.map(&Site::anywhere(pair.source));
                assert!(image.distance(pair.target) < 1e-14);
            }
        }
    }
}

#[test]
fn b8_points_that_share_no_control_point_are_met() {
    b8_separate::<Plane>();
    b8_separate::<Solid>();
}

#[test]
fn b8_a_level_is_the_formula_of_lee_wolberg_and_shin() {
    // One point and one span: φ = w z / Σ w², here written out.
    let source = dvec2(0.3, 0.8);
    let step = dvec2(0.2, -0.1);
    let pair = PointPair {
        source,
        target: source + step,
    };
    let warp = Multilevel::construct(vec![pair], unit(), with(1)).unwrap();
    let bases = |t: f64| {
        let powers = [1.0, t, t * t, t * t * t];
        let rows = [
            [1.0, -3.0, 3.0, -1.0],
            [4.0, 0.0, -6.0, 3.0],
            [1.0, 3.0, 3.0, -3.0],
            [0.0, 0.0, 0.0, 1.0],
        ];
        rows.map(|row| {
            row.iter()
                .zip(powers)
                .map(|(a, p)| a * p / 6.0)
                .sum::<f64>()
        })
    };
    let weights = |p: Plane| {
        let (x, y) = (bases(p.x), bases(p.y));
        core::array::from_fn::<f64, 16, _>(|i| x[i / 4] * y[i % 4])
    };
    let at = weights(source);
    let squares: f64 = at.iter().map(|w| w * w).sum();
    let mut random = Random::new(81);
    for _ in 0..100 {
        let p = dvec2(random.between(0.0, 1.0), random.between(0.0, 1.0));
        let share: f64 = weights(p)
            .iter()
            .zip(at)
            .map(|(a, b)| a * b / squares)
            .sum();
        let image = warp.map(&Site::anywhere(p));
        assert!((image - (p + step * share)).length() < 1e-15);
    }
    // Two points that share all control points: φ = Σ w² φ_c / Σ w².
    let other = PointPair {
        source: dvec2(0.6, 0.1),
        target: dvec2(0.9, 0.4),
    };
    let warp = Multilevel::construct(vec![pair, other], unit(), with(1)).unwrap();
    let b = weights(other.source);
    let other_squares: f64 = b.iter().map(|w| w * w).sum();
    let p = dvec2(0.45, 0.55);
    let mut expected = p;
    for (i, n) in weights(p).into_iter().enumerate() {
        let (first, second) = (at[i] * at[i], b[i] * b[i]);
        let moved = step * (at[i] / squares * first)
            + (other.target - other.source) * (b[i] / other_squares * second);
        expected += moved / (first + second) * n;
    }
    assert!((warp.map(&Site::anywhere(p)) - expected).length() < 1e-15);
}

fn b8_one_to_one<S: Space>() {
    let mut random = Random::new(82);
    for (count, move_by) in [(1, 0.14), (6, 0.12), (30, 0.05)] {
        let hierarchy = Hierarchy {
            one_to_one: true,
            ..with(if S::DIM == 2 { 6 } else { 4 })
        };
        let list = pairs::<S>(&mut random, count, move_by);
        let warp = Multilevel::construct(list.clone(), unit(), hierarchy).unwrap();
        let facts = warp.facts();
        assert!(facts.one_to_one().is_some() && facts.upright().is_some());
        assert_eq!(facts.edge, Smoothness::C(2));
        assert_eq!(facts.inside, Smoothness::C(2));
        let mut least = f64::INFINITY;
        for _ in 0..3000 {
            let p = S::from_fn(|_| random.between(-0.1, 1.1));
            let jacobian = warp.jacobian(&Site::anywhere(p), 1.0).unwrap();
            least = least.min(jacobian.determinant());
        }
        assert!(least > 0.0, "{least}");
        if count == 1 {
            // Farther than any lattice may move a point at once, by several.
            let last = warp.residuals().last().unwrap();
            assert!(
                last.largest < 1e-12 && warp.lattices().len() > 1,
                "{last:?}"
            );
        }
        // Outside, and on the faces, nothing moves.
        let mut far = S::splat(0.5);
        far += S::unit(1) * 0.5;
        assert_eq!(warp.map(&Site::anywhere(far)), far);
        let Support::Box(support) = facts.support else {
            panic!("a box");
        };
        assert!((support.max - S::splat(1.0)).largest() < 1e-9);
    }
}

#[test]
fn b8_compositions_are_one_to_one() {
    b8_one_to_one::<Plane>();
    b8_one_to_one::<Solid>();
}

#[test]
fn b8_points_that_cross_fold_the_sum_and_not_the_composition() {
    let cross = |a: f64, b: f64| PointPair {
        source: dvec2(a, 0.5),
        target: dvec2(b, 0.5),
    };
    let list = vec![cross(0.4, 0.6), cross(0.6, 0.4)];
    let lowest = |one_to_one: bool| {
        let hierarchy = Hierarchy {
            one_to_one,
            ..with(6)
        };
        let warp = Multilevel::construct(list.clone(), unit(), hierarchy).unwrap();
        let determinant = |p| {
            warp.jacobian(&Site::anywhere(p), 1.0)
                .unwrap()
                .determinant()
        };
        let places = (0..=400).map(|i| dvec2(f64::from(i) / 400.0, 0.5));
        let least = places.map(determinant).fold(f64::INFINITY, f64::min);
        (least, warp.residuals().last().unwrap().largest)
    };
    let (sum, missed) = lowest(false);
    assert!(sum < 0.0 && missed < 1e-14);
    let (composed, missed) = lowest(true);
    assert!(composed > 0.0 && missed > 0.05);
}

#[test]
fn b8_free_faces_jump_and_still_ones_are_smooth() {
    let pair = PointPair {
        source: Solid::splat(0.4),
        target: Solid::splat(0.5),
    };
    let make = |still_faces| {
        let hierarchy = Hierarchy {
            still_faces,
            ..with(4)
        };
        Multilevel::construct(vec![pair], unit::<Solid>(), hierarchy).unwrap()
    };
    let free = make(false);
    assert_eq!(free.facts().edge, Smoothness::Jump);
    let face = Solid::new(0.4, 1.0, 0.4);
    assert_ne!(free.map(&Site::anywhere(face)), face);
    let beyond = face + Solid::Y * 1e-6;
    assert_eq!(free.map(&Site::anywhere(beyond)), beyond);
    let still = make(true);
    assert_eq!(still.facts().edge, Smoothness::C(2));
    assert_eq!(still.map(&Site::anywhere(face)), face);
    assert!(
        still
            .map(&Site::anywhere(pair.source))
            .distance(pair.target)
            < 1e-14
    );
}

#[test]
fn b8_a_tolerance_ends_the_levels() {
    let mut random = Random::new(83);
    let list = pairs::<Plane>(&mut random, 20, 0.1);
    let exact = Multilevel::construct(list.clone(), unit(), with(8)).unwrap();
    let tolerance = 0.3 * exact.before().largest;
    let hierarchy = Hierarchy {
        tolerance,
        ..with(8)
    };
    let coarse = Multilevel::construct(list.clone(), unit(), hierarchy).unwrap();
    let levels = coarse.residuals().len();
    assert!(levels < exact.residuals().len());
    assert_eq!(coarse.residuals(), &exact.residuals()[..levels]);
    assert!(coarse.residuals()[levels - 1].largest <= tolerance);
    assert!(coarse.residuals()[levels - 2].largest > tolerance);
    // Sources that say the same twice are one; those that differ are refused.
    let twice = [list.clone(), list.clone()].concat();
    let same = Multilevel::construct(twice, unit(), with(8)).unwrap();
    assert_eq!(same.residuals(), exact.residuals());
    let mut torn = list.clone();
    torn.push(PointPair {
        source: list[4].source,
        target: list[5].target,
    });
    let error = Multilevel::construct(torn, unit(), with(8)).err().unwrap();
    assert_eq!(
        error,
        MultilevelError::Coincident {
            first: 4,
            second: 20
        }
    );
}

#[test]
fn b8_sizes_and_places_do_not_matter() {
    let mut random = Random::new(84);
    let list = pairs::<Plane>(&mut random, 12, 0.1);
    let warp = Multilevel::construct(list.clone(), unit(), with(6)).unwrap();
    for (size, offset) in [(1e-7, 2.0), (3e6, -1e7)] {
        let place = |p: Plane| p * size + offset;
        let there = list.iter().map(|pair| PointPair {
            source: place(pair.source),
            target: place(pair.target),
        });
        let bounds = Bounds::new(place(Plane::ZERO), place(Plane::ONE));
        let other = Multilevel::construct(there.collect(), bounds, with(6)).unwrap();
        let p = dvec2(0.37, 0.61);
        let image = other.map(&Site::anywhere(place(p)));
        let apart = image.distance(place(warp.map(&Site::anywhere(p))));
        // As far as the digits of a coordinate go.
        assert!(apart < 1e-6 * size, "{apart}");
    }
}
