//! B19: radial basis functions and thin plates meet their points, reproduce affine maps, and end where they say.

use anamorph_core::{Affine, Deformation, Linear, Plane, Site, Solid, Space, glam::dvec2, map_all};
use anamorph_features::PointPair;
use anamorph_tests::measure::{linear_distance, same_bits};
use anamorph_tests::random::Random;
use anamorph_warps::radial::{Kernel, RadialError, RadialWarp};

const KERNELS: [Kernel; 8] = [
    Kernel::Linear,
    Kernel::Cubic,
    Kernel::ThinPlate,
    Kernel::Gaussian { width: 0.4 },
    Kernel::Multiquadric { width: 0.3 },
    Kernel::InverseMultiquadric { width: 0.3 },
    Kernel::Wendland { radius: 0.7 },
    Kernel::Logarithmic,
];

/// Points of about unit size, no two much nearer than so many need be, that move by about `move_by`.
fn pairs<S: Space>(random: &mut Random, count: usize, move_by: f64) -> Vec<PointPair<S>> {
    let apart = 0.6 / (count as f64).powf(1.0 / S::DIM as f64);
    let mut list: Vec<PointPair<S>> = Vec::new();
    while list.len() < count {
        let source = S::from_fn(|_| random.between(-1.0, 1.0));
        if list.iter().all(|pair| pair.source.distance(source) > apart) {
            let target = source + random.vector::<S>() * move_by;
            list.push(PointPair { source, target });
        }
    }
    list
}

fn at<S: Space>(warp: &RadialWarp<S>, p: S) -> S {
    warp.map(&Site::anywhere(p))
}

fn b19_interpolates<S: Space>() {
    let mut random = Random::new(19);
    for kernel in KERNELS {
        for count in [5, 17, 60, 300] {
            for affine in [true, false] {
                // Sources of any size anywhere; the kernel's length with them.
                for (size, offset) in [(1.0, 0.0), (1e-6, 3.0), (4e5, -1e6)] {
                    let place = |p: S| S::splat(offset) + p * size;
                    let scaled = match kernel {
                        Kernel::Gaussian { width } => Kernel::Gaussian {
                            width: width * size,
                        },
                        Kernel::Multiquadric { width } => Kernel::Multiquadric {
                            width: width * size,
                        },
                        Kernel::InverseMultiquadric { width } => Kernel::InverseMultiquadric {
                            width: width * size,
                        },
                        Kernel::Wendland { radius } => Kernel::Wendland {
                            radius: radius * size,
                        },
                        other => other,
                    };
                    if count == 300 && size != 1.0 {
                        continue;
                    }
                    let list = pairs::<S>(&mut random, count, 0.2);
                    let list: Vec<PointPair<S>> = list
                        .iter()
                        .map(|pair| PointPair {
                            source: place(pair.source),
                            target: place(pair.target),
                        })
                        .collect();
                    let warp = RadialWarp::construct(list.clone(), scaled, affine, 0.0);
                    if kernel.needs_affine() && !affine {
                        assert!(matches!(warp, Err(RadialError::NeedsAffine { .. })));
                        continue;
                    }
                    // So many wide and smooth kernels cannot be told apart by floating-point numbers: refused, never wrong.
                    if let (Err(error), 300) = (&warp, count) {
                        assert!(!KERNELS[..3].contains(&kernel), "{kernel:?}: {error}");
                        assert!(
                            matches!(error, RadialError::IllConditioned { condition, .. } if *condition > 1e9)
                        );
                        continue;
                    }
                    let warp = warp.unwrap();
                    for pair in &list {
                        let miss = at(&warp, pair.source).distance(pair.target);
                        assert!(miss <= 1e-9 * size, "{kernel:?}, {count}: {miss:e}");
                    }
                }
            }
        }
    }
}

#[test]
fn b19_points_are_met() {
    b19_interpolates::<Plane>();
    b19_interpolates::<Solid>();
}

fn b19_affine<S: Space>() {
    let mut random = Random::new(20);
    for kernel in KERNELS {
        let edit: Affine<S> = random.affine();
        let list = pairs::<S>(&mut random, 20, 0.0);
        let list = list.into_iter().map(|pair| PointPair {
            source: pair.source,
            target: edit.apply(pair.source),
        });
        let warp = RadialWarp::construct(list.collect(), kernel, true, 0.0).unwrap();
        for _ in 0..50 {
            let p = random.vector::<S>() * 3.0;
            assert!(
                (at(&warp, p) - edit.apply(p)).largest() < 1e-10,
                "{kernel:?}"
            );
            let jacobian = warp.jacobian(&Site::anywhere(p), 1.0).unwrap();
            assert!(linear_distance::<S>(&jacobian, &edit.linear) < 1e-10);
        }
    }
}

#[test]
fn b19_affine_maps_are_reproduced() {
    b19_affine::<Plane>();
    b19_affine::<Solid>();
}

/// The sum of the kernels' displacements written out, its coefficients found from the warp by its linearity: the warp of unit
/// displacements at one point is the formula's, whatever the coefficients.
#[test]
fn b19_thin_plates_are_r_squared_log_r_in_the_plane() {
    let mut random = Random::new(21);
    let list = pairs::<Plane>(&mut random, 7, 0.4);
    let warp = RadialWarp::construct(list.clone(), Kernel::ThinPlate, true, 0.0).unwrap();
    // Δ²(r² log r) = 0 away from the points: so is that of the warp, by differences of a 13-point star.
    let star = [
        (0, 0, 20.0),
        (1, 0, -8.0),
        (-1, 0, -8.0),
        (0, 1, -8.0),
        (0, -1, -8.0),
        (1, 1, 2.0),
        (1, -1, 2.0),
        (-1, 1, 2.0),
        (-1, -1, 2.0),
        (2, 0, 1.0),
        (-2, 0, 1.0),
        (0, 2, 1.0),
        (0, -2, 1.0),
    ];
    let h = 2e-2;
    for p in [dvec2(1.7, 1.6), dvec2(-1.8, 1.9), dvec2(2.5, -2.0)] {
        let sum = star.iter().fold(Plane::ZERO, |sum, &(x, y, factor)| {
            sum + at(&warp, p + dvec2(f64::from(x), f64::from(y)) * h) * factor
        });
        assert!((sum / (h * h * h * h)).largest() < 5e-2, "{p:?}: {sum:?}");
    }
    // Far away it grows no faster than r log r.
    let far = |r: f64| (at(&warp, dvec2(0.6, 0.8) * r) - dvec2(0.6, 0.8) * r).length() / r;
    assert!(far(1e5) < far(1e3) * 3.0 + 1.0);
}

/// No other surface through the points bends less: among all that have the same kernels, that is a matter of the quadratic form.
#[test]
fn b19_more_smoothing_bends_less_and_misses_more() {
    let mut random = Random::new(22);
    let list = pairs::<Plane>(&mut random, 25, 0.3);
    let warp = |smoothing| {
        RadialWarp::construct(list.clone(), Kernel::ThinPlate, true, smoothing).unwrap()
    };
    let misses = |warp: &RadialWarp<Plane>| -> f64 {
        list.iter()
            .map(|pair| (at(warp, pair.source) - pair.target).length_squared())
            .sum()
    };
    let mut before = 0.0;
    for smoothing in [0.0, 1e-3, 1e-2, 0.1, 1.0, 1e3] {
        let now = misses(&warp(smoothing));
        assert!(
            now > before || smoothing == 0.0 && now < 1e-18,
            "{smoothing}"
        );
        before = now;
    }
    // At last the affine map of least squares: residuals are across 1, x and y.
    let stiff = warp(1e9);
    let residual = |pair: &PointPair<Plane>| at(&stiff, pair.source) - pair.target;
    let sum = |factor: fn(Plane) -> f64| {
        let terms = list.iter().map(|pair| residual(pair) * factor(pair.source));
        terms.fold(Plane::ZERO, |a, b| a + b)
    };
    for factor in [|_: Plane| 1.0, |p: Plane| p.x, |p: Plane| p.y] {
        assert!(sum(factor).largest() < 1e-8, "{:?}", sum(factor));
    }
    let jacobian = |p| stiff.jacobian(&Site::anywhere(p), 1.0).unwrap();
    let apart = linear_distance::<Plane>(&jacobian(dvec2(0.1, 0.2)), &jacobian(dvec2(-0.8, 0.5)));
    assert!(apart < 1e-6, "{apart}");
}

fn b19_ends<S: Space>() {
    let mut random = Random::new(23);
    let list = pairs::<S>(&mut random, 9, 0.1);
    let radius = 0.35;
    let warp =
        RadialWarp::construct(list.clone(), Kernel::Wendland { radius }, false, 0.0).unwrap();
    let support = warp.facts().support;
    let (mut still, mut moved) = (0, 0);
    for _ in 0..4000 {
        let p = S::from_fn(|_| random.between(-2.0, 2.0));
        let nearest = list
            .iter()
            .map(|pair| pair.source.distance(p))
            .fold(f64::INFINITY, f64::min);
        if nearest > radius {
            assert!(same_bits(at(&warp, p), p));
            still += 1;
        } else {
            assert!(support.contains(p));
            moved += usize::from(at(&warp, p) != p);
        }
    }
    assert!(still > 500 && moved > 50, "{still}, {moved}");
}

#[test]
fn b19_compact_kernels_end_at_their_radius() {
    b19_ends::<Plane>();
    b19_ends::<Solid>();
}

/// The bound of the derivative holds, and where it is below 1 nothing folds.
fn b19_stretch<S: Space>() {
    let mut random = Random::new(24);
    for kernel in KERNELS {
        let list = pairs::<S>(&mut random, 6, 0.05);
        let warp = RadialWarp::construct(list, kernel, true, 0.0).unwrap();
        let Some(bound) = warp.facts().stretch() else {
            assert!(matches!(
                kernel,
                Kernel::Cubic | Kernel::ThinPlate | Kernel::Logarithmic
            ));
            continue;
        };
        for _ in 0..2000 {
            let p = random.vector::<S>() * 2.0;
            let change = warp.jacobian(&Site::anywhere(p), 1.0).unwrap() - S::Linear::IDENTITY;
            let longest = (0..20).map(|_| change.apply(random.direction::<S>()).length());
            assert!(longest.fold(0.0, f64::max) <= bound, "{kernel:?}");
        }
    }
}

#[test]
fn b19_derivatives_are_bounded_as_claimed() {
    b19_stretch::<Plane>();
    b19_stretch::<Solid>();
}

#[test]
fn b19_what_cannot_be_met_is_named() {
    let pair = |x: f64, y: f64, to: f64| PointPair {
        source: dvec2(x, y),
        target: dvec2(x, y + to),
    };
    let plate =
        |list: Vec<PointPair<Plane>>| RadialWarp::construct(list, Kernel::ThinPlate, true, 0.0);
    let line: Vec<_> = (0..9)
        .map(|i| pair(f64::from(i), 2.0 * f64::from(i), 0.1))
        .collect();
    let Err(RadialError::Dependent(found)) = plate(line.clone()) else {
        panic!("points of a line are no plate");
    };
    assert_eq!(
        (found.places, found.span.as_slice()),
        (9, [0, 8].as_slice())
    );
    assert!(found.condition > 1e10);
    // One point off the line, and it is one.
    let mut off = line.clone();
    off.push(pair(1.0, 0.0, 0.2));
    let warp = plate(off.clone()).unwrap();
    let mut moved: Vec<Plane> = off.iter().map(|pair| pair.source).collect();
    assert!(map_all(&warp, &mut moved).is_empty());
    for (pair, moved) in off.iter().zip(moved) {
        assert!(moved.distance(pair.target) < 1e-9);
    }
    // The same place twice: with one target once, with two an error unless it may be missed.
    off.push(off[3]);
    assert_eq!(
        at(&plate(off.clone()).unwrap(), dvec2(0.3, 0.1)),
        at(&warp, dvec2(0.3, 0.1))
    );
    off.push(pair(3.0, 6.0, 0.5));
    let coincident = RadialError::Coincident {
        first: 3,
        second: 11,
    };
    assert_eq!(plate(off.clone()), Err(coincident));
    assert!(RadialWarp::construct(off, Kernel::ThinPlate, true, 0.1).is_ok());
    // Bells a thousand times as wide as their points are apart.
    let bells = (0..30).map(|i| pair(f64::from(i % 6), f64::from(i / 6), f64::from(i % 4)));
    let wide = Kernel::Gaussian { width: 1e4 };
    let error = RadialWarp::construct(bells.collect(), wide, false, 0.0).unwrap_err();
    assert!(
        matches!(error, RadialError::IllConditioned { condition, .. } if condition > 1e14),
        "{error}"
    );
}

/// Points of the unit box, no two too near.
fn spread<S: Space>(random: &mut Random, count: usize) -> Vec<PointPair<S>> {
    let side = (count as f64).powf(1.0 / S::DIM as f64).ceil() as usize;
    let cell = |k: usize, axis: usize| (k / side.pow(axis as u32) % side) as f64;
    (0..count)
        .map(|k| {
            let source =
                S::from_fn(|axis| (cell(k, axis) + random.between(0.15, 0.85)) / side as f64);
            let step = random.vector::<S>() * 0.02;
            PointPair {
                source,
                target: source + step,
            }
        })
        .collect()
}

fn b19_many<S: Space>(count: usize, radius: f64) {
    let mut random = Random::new(22);
    let list = spread::<S>(&mut random, count);
    for affine in [false, true] {
        let kernel = Kernel::Wendland { radius };
        let warp = RadialWarp::construct(list.clone(), kernel, affine, 0.0).unwrap();
        assert!(warp.condition() > 1.0 && warp.condition().is_finite());
        let mut moved: Vec<S> = list.iter().map(|pair| pair.source).collect();
        map_all(&warp, &mut moved);
        for (moved, pair) in moved.iter().zip(&list) {
            assert!(moved.distance(pair.target) < 1e-11);
        }
        // The formula, over all centres, and its derivative.
        let mut near = 0;
        for _ in 0..30 {
            let site = Site::anywhere(S::from_fn(|_| random.between(-0.2, 1.2)));
            let literal = anamorph_core::reference::evaluate(&warp, &site);
            let image = warp.map(&site);
            assert!((image - literal).largest() < 1e-12);
            near += usize::from(image != site.point);
            let jacobian = warp.jacobian(&site, 1.0).unwrap();
            let differences = anamorph_core::difference_jacobian(&warp, &site, 1.0).unwrap();
            assert!(linear_distance::<S>(&jacobian, &differences) < 1e-5);
        }
        assert!(near > 5);
        if !affine {
            let far = S::splat(1.1 + radius);
            assert!(same_bits(at(&warp, far), far));
        }
    }
}

#[test]
fn b19_thousands_of_points_within_a_radius_are_met() {
    b19_many::<Plane>(5000, 0.04);
    b19_many::<Solid>(2000, 0.15);
}

#[test]
fn b19_fifteen_thousand_points_of_space_are_met() {
    b19_many::<Solid>(15_000, 0.06);
}

#[test]
fn b19_sparse_equations_are_the_dense_ones() {
    // Below and above the number at which they are sparse: one more point far from the others changes nothing among them.
    let mut random = Random::new(23);
    let mut list = spread::<Solid>(&mut random, 511);
    let kernel = Kernel::Wendland { radius: 0.4 };
    for (affine, smoothing) in [(false, 0.0), (false, 0.3)] {
        let dense = RadialWarp::construct(list.clone(), kernel, affine, smoothing).unwrap();
        let far = Solid::splat(9.0);
        list.push(PointPair {
            source: far,
            target: far,
        });
        let sparse = RadialWarp::construct(list.clone(), kernel, affine, smoothing).unwrap();
        list.pop();
        for _ in 0..200 {
            let p = random.vector::<Solid>();
            let apart = at(&dense, p).distance(at(&sparse, p));
            assert!(apart < 1e-11, "{apart}");
        }
        let ratio = dense.condition() / sparse.condition();
        assert!((0.2..5.0).contains(&ratio), "{ratio}");
    }
}

#[test]
fn b19_too_many_neighbours_are_refused_by_radius() {
    let mut random = Random::new(24);
    let list = spread::<Plane>(&mut random, 12_000);
    let kernel = Kernel::Wendland { radius: 1.0 };
    let error = RadialWarp::construct(list, kernel, false, 0.0).unwrap_err();
    assert!(matches!(error, RadialError::TooDense { .. }));
    assert!(error.to_string().contains("radius 1 "), "{error}");
}

/// `Δ²(r² log r) = −2/r²` in space and 0 in the plane: what tells this kernel from others.
#[test]
fn b19_logarithmic_kernels_are_r_squared_log_r_in_space_too() {
    let mut random = Random::new(25);
    let list = pairs::<Plane>(&mut random, 9, 0.3);
    let plate = RadialWarp::construct(list.clone(), Kernel::ThinPlate, true, 0.0).unwrap();
    let log = RadialWarp::construct(list, Kernel::Logarithmic, true, 0.0).unwrap();
    let list = pairs::<Solid>(&mut random, 5, 0.3);
    let solid = RadialWarp::construct(list.clone(), Kernel::Logarithmic, true, 0.0).unwrap();
    // The coefficients by eq. (3)'s terms, the formula by hand; units of length only change the affine part.
    for _ in 0..50 {
        let p = random.vector::<Plane>();
        assert!(same_bits(at(&plate, p), at(&log, p)));
        let p = random.vector::<Solid>();
        let literal = anamorph_core::reference::evaluate(&solid, &Site::anywhere(p));
        assert!((at(&solid, p) - literal).largest() < 1e-13);
    }
    let mut out = anamorph_core::Influences::default();
    let place = Site::anywhere(Solid::new(0.3, -0.2, 0.5));
    anamorph_core::Warp::influences(&solid, &place, &mut out);
    let all = anamorph_core::Bounds::of(&list.iter().map(|pair| pair.source).collect::<Vec<_>>());
    let unit = all.unwrap().diagonal();
    for (influence, pair) in out.list.iter().zip(&list) {
        let r = place.point.distance(pair.source) / unit;
        let expected = 2.0 * r * r * r.ln();
        assert!((influence.strength - expected).abs() < 1e-13);
    }
}
