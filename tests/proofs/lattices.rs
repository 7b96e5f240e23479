//! B3: affine edits and joined lattices. B4: local control and affine edits of every degree. B7: direct manipulation. B9: a frame that turns.

use anamorph_core::{
    Affine, Bounds, Deformation, Linear, Pin, Plane, Scaling, Site, Smoothness, Solid, Space,
    Transformation, difference_jacobian, fit,
    glam::{dvec2, dvec3},
};
use anamorph_tests::measure::{linear_distance, same_bits};
use anamorph_tests::random::Random;
use anamorph_transforms::{Composed, Rotational};
use anamorph_warps::lattices::Grid;
use anamorph_warps::lattices::PointLattice;
use anamorph_warps::lattices::bernstein::BernsteinLattice;
use anamorph_warps::lattices::bspline::{BsplineLattice, HIGHEST_DEGREE, Knots};
use anamorph_warps::lattices::frames::FrameLattice;

/// A skew box of about unit size.
fn skew<S: Space>(random: &mut Random, shape: &[usize]) -> Grid<S> {
    let edges = S::Linear::IDENTITY + random.linear::<S>() * 0.25;
    Grid::new(random.vector(), edges, shape).unwrap()
}

/// Points of a box, corners and faces included.
fn inside<S: Space>(random: &mut Random, grid: &Grid<S>) -> S {
    let snap = |x: f64| {
        if x < 0.1 {
            0.0
        } else if x > 0.9 {
            1.0
        } else {
            x
        }
    };
    grid.place(S::from_fn(|_| snap(random.between(0.0, 1.0))))
}

fn b3_affine<S: Space>() {
    let mut random = Random::new(3);
    for shape in [[2, 2, 2], [4, 4, 4], [3, 7, 5], [9, 2, 6], [17, 4, 3]] {
        let grid = skew::<S>(&mut random, &shape);
        let edit = random.affine::<S>();
        let still = BernsteinLattice::construct(grid.clone(), vec![S::ZERO; grid.len()]).unwrap();
        let list = (0..grid.len()).map(|i| edit.displacement(still.control_point(i)));
        let warp = BernsteinLattice::construct(grid.clone(), list.collect()).unwrap();
        for _ in 0..200 {
            let p = inside(&mut random, &grid);
            let site = Site::anywhere(p);
            assert!((warp.map(&site) - edit.apply(p)).largest() < 1e-12);
            let jacobian = warp.jacobian(&site, 1.0).unwrap();
            assert!(linear_distance::<S>(&jacobian, &edit.linear) < 1e-11);
        }
    }
}

#[test]
fn b3_affine_edits_are_reproduced() {
    b3_affine::<Plane>();
    b3_affine::<Solid>();
}

/// Two lattices over boxes that share a face; the displacement at a point, each lattice on its own side.
fn joined(order: usize, seed: u64) -> (BernsteinLattice<Solid>, BernsteinLattice<Solid>) {
    let mut random = Random::new(seed);
    let shape = [5, 4, 3];
    let grid = |x: f64| {
        Grid::around(
            Bounds::new(dvec3(x, 0.0, 0.0), dvec3(x + 1.0, 1.0, 1.0)),
            &shape,
        )
        .unwrap()
    };
    let (left, right) = (grid(0.0), grid(1.0));
    let random_list = |random: &mut Random| -> Vec<Solid> {
        (0..left.len())
            .map(|_| random.vector::<Solid>() * 0.2)
            .collect()
    };
    let (mine, mut other) = (random_list(&mut random), random_list(&mut random));
    // With matching differences up to an order k across the face: plane j of the right lattice is the left one's
    // polynomial carried on, because the boxes are of one length.
    for j in 0..4 {
        for k in 0..3 {
            let at = |i: usize| mine[left.flat([i, j, k])];
            let carried = [
                at(4),
                at(4) * 2.0 - at(3),
                at(4) * 4.0 - at(3) * 4.0 + at(2),
            ];
            for (i, value) in carried.into_iter().enumerate().take(order + 1) {
                other[right.flat([i, j, k])] = value;
            }
        }
    }
    (
        BernsteinLattice::construct(left, mine).unwrap(),
        BernsteinLattice::construct(right, other).unwrap(),
    )
}

#[test]
fn b3_joined_lattices_are_as_smooth_as_their_control_planes_match() {
    // One-sided derivatives of order 0 to 3 along x at the shared face, from the side's own lattice.
    let derivatives = |warp: &BernsteinLattice<Solid>, side: f64, y: f64, z: f64| -> [Solid; 4] {
        let h = 1e-2;
        let value = |i: f64| {
            let p = dvec3(1.0 + side * h * i, y, z);
            warp.map(&Site::anywhere(p)) - p
        };
        // Newton's forward differences of a quartic polynomial are exact with five points.
        let f: [Solid; 5] = core::array::from_fn(|i| value(i as f64));
        let d1 = (f[1] * 48.0 - f[2] * 36.0 + f[3] * 16.0 - f[4] * 3.0 - f[0] * 25.0) / 12.0;
        let d2 = (f[0] * 35.0 - f[1] * 104.0 + f[2] * 114.0 - f[3] * 56.0 + f[4] * 11.0) / 12.0;
        let d3 = (f[0] * -5.0 + f[1] * 18.0 - f[2] * 24.0 + f[3] * 14.0 - f[4] * 3.0) / 2.0;
        let step = side * h;
        [
            f[0],
            d1 / step,
            d2 / (step * step),
            d3 / (step * step * step),
        ]
    };
    for order in 0..=2_usize {
        let (left, right) = joined(order, 33 + order as u64);
        let mut breaks: f64 = 0.0;
        for i in 0..20 {
            let (y, z) = (0.05 * f64::from(i), 0.97 - 0.04 * f64::from(i));
            let (a, b) = (
                derivatives(&left, -1.0, y, z),
                derivatives(&right, 1.0, y, z),
            );
            for k in 0..=order {
                let jump = (a[k] - b[k]).length();
                assert!(jump < [1e-13, 1e-9, 1e-6][k], "C{order}, order {k}: {jump}");
            }
            breaks = breaks.max((a[order + 1] - b[order + 1]).length());
        }
        // And no smoother.
        assert!(breaks > 0.1, "C{order}: {breaks}");
    }
}

fn b4_affine<S: Space>() {
    let mut random = Random::new(4);
    for degree in 1..=HIGHEST_DEGREE {
        for knots in [Knots::Uniform, Knots::Clamped] {
            let shape = [degree + 1, degree + 3, 9];
            let grid = skew::<S>(&mut random, &shape);
            let edit = random.affine::<S>();
            let build = |list| BsplineLattice::construct(grid.clone(), degree, knots, list);
            let still = build(vec![S::ZERO; grid.len()]).unwrap();
            let list = (0..grid.len()).map(|i| edit.displacement(still.control_point(i)));
            let warp = build(list.collect()).unwrap();
            for _ in 0..100 {
                let p = inside(&mut random, &grid);
                let site = Site::anywhere(p);
                let error = (warp.map(&site) - edit.apply(p)).largest();
                assert!(error < 1e-12, "degree {degree}, {knots:?}: {error}");
                let jacobian = warp.jacobian(&site, 1.0).unwrap();
                assert!(linear_distance::<S>(&jacobian, &edit.linear) < 1e-11);
            }
        }
    }
}

#[test]
fn b4_affine_edits_are_reproduced_at_every_degree() {
    b4_affine::<Plane>();
    b4_affine::<Solid>();
}

#[test]
fn b4_a_control_point_moves_only_its_knot_spans() {
    let mut random = Random::new(44);
    let points = 10_usize;
    for degree in 1..=HIGHEST_DEGREE {
        for knots in [Knots::Uniform, Knots::Clamped] {
            let grid = Grid::around(Bounds::new(Plane::ZERO, Plane::ONE), &[points, points]);
            let grid = grid.unwrap();
            let mut list: Vec<Plane> = (0..100).map(|_| random.vector()).collect();
            let build = |list: Vec<Plane>| {
                BsplineLattice::construct(grid.clone(), degree, knots, list).unwrap()
            };
            let before = build(list.clone());
            let (i, j) = (random.below(points), random.below(points));
            list[grid.flat([i, j, 0])] += dvec2(0.5, -0.25);
            let after = build(list);
            // Interior knots of both kinds are even; basis i lives on spans i − degree to i.
            let spans = (points - degree) as f64;
            let reach = |i: usize| {
                let low = i.saturating_sub(degree) as f64 / spans;
                let high = ((i + 1) as f64 / spans).min(1.0);
                (low, high)
            };
            let (x, y) = (reach(i), reach(j));
            let (mut changed, mut kept) = (0, 0);
            for _ in 0..3000 {
                let p = dvec2(random.between(0.0, 1.0), random.between(0.0, 1.0));
                let near = (x.0..=x.1).contains(&p.x) && (y.0..=y.1).contains(&p.y);
                let (a, b) = (
                    before.map(&Site::anywhere(p)),
                    after.map(&Site::anywhere(p)),
                );
                if near {
                    changed += usize::from(a != b);
                } else {
                    assert!(
                        same_bits(a, b),
                        "degree {degree}, {knots:?}, {i}, {j}: {p:?}"
                    );
                    kept += 1;
                }
            }
            assert!(kept > 100 && changed > 5, "{kept}, {changed}");
        }
    }
}

#[test]
fn b4_declared_smoothness_is_that_of_the_degree() {
    for degree in 1..=HIGHEST_DEGREE {
        let grid = Grid::around(Bounds::new(Solid::ZERO, Solid::ONE), &[12, 12, 12]).unwrap();
        let mut list = vec![Solid::ZERO; grid.len()];
        list[grid.flat([6, 6, 6])] = Solid::X;
        let warp = BsplineLattice::construct(grid, degree, Knots::Uniform, list).unwrap();
        let class = Smoothness::C(degree as u8 - 1);
        assert_eq!(warp.facts().inside, class);
        // The moved middle does not reach the faces.
        assert_eq!(warp.facts().edge, class);
    }
}

fn b9<S: Rotational>(axis: S) {
    let grid = Grid::around(Bounds::new(S::ZERO, S::splat(2.0)), &[3, 3, 3]).unwrap();
    let centre = S::splat(1.0);
    let middle = grid.flat([1, 1, usize::from(S::DIM == 3)]);
    for (angle, scaling) in [
        (0.4, Scaling::Displacement),
        (1.0, Scaling::Composition),
        (2.5, Scaling::Composition),
    ] {
        let turn = Affine::about(centre, S::rotation(axis, angle), S::ZERO);
        let mut frames: Vec<Box<dyn Transformation<S>>> = Vec::new();
        for flat in 0..grid.len() {
            frames.push(match (flat == middle, scaling) {
                (false, _) => Box::new(Affine::IDENTITY),
                (true, Scaling::Displacement) => Box::new(turn),
                (true, Scaling::Composition) => Box::new(Composed::new(turn, centre).unwrap()),
            });
        }
        let warp = FrameLattice::construct(grid.clone(), frames).unwrap();
        assert_eq!(warp.map(&Site::anywhere(centre)), centre);
        // The middle's Bernstein weight is ½ per axis, and flat there: the Jacobian is I + w(R − I).
        let weight = 0.5_f64.powi(i32::try_from(S::DIM).unwrap());
        let rotation = S::rotation(axis, angle);
        let expected = S::Linear::IDENTITY + (rotation - S::Linear::IDENTITY) * weight;
        let seen = difference_jacobian(&warp, &Site::anywhere(centre), 2.0).unwrap();
        assert!(linear_distance::<S>(&seen, &expected) < 1e-9);
        // Nearby points turn about the middle, and what is on the faces stays.
        let near = centre + S::unit(0) * 1e-4;
        let out = warp.map(&Site::anywhere(near)) - centre;
        let turned = (out.normalized().unwrap() - S::unit(0)).length();
        assert!(turned > 0.5 * weight * angle.min(1.0), "{turned}");
        for p in [S::ZERO, S::splat(2.0), S::unit(0) * 2.0] {
            assert_eq!(warp.map(&Site::anywhere(p)), p);
        }
    }
}

#[test]
fn b9_a_frame_that_turns_turns_its_neighbourhood() {
    b9(Plane::ZERO);
    b9(dvec3(1.0, 2.0, -1.0));
}

/// Pins are met to 1e-9, many and close ones too, and no other edit that meets them changes less.
fn b7_pins<S: Space>() {
    let mut random = Random::new(7);
    for round in 0..12 {
        let grid = skew::<S>(&mut random, &[4, 5, 4]);
        let bernstein = round % 2 == 0;
        let build = |moves: Vec<S>| -> Box<dyn anamorph_core::Warp<S>> {
            if bernstein {
                Box::new(BernsteinLattice::construct(grid.clone(), moves).unwrap())
            } else {
                let knots = [Knots::Uniform, Knots::Clamped][round / 2 % 2];
                Box::new(BsplineLattice::construct(grid.clone(), 3, knots, moves).unwrap())
            }
        };
        let count = [1, 3, 9, 12][round % 4];
        let pins: Vec<Pin<S>> = (0..count)
            .map(|_| {
                let source = inside(&mut random, &grid);
                Pin {
                    source,
                    target: source + random.vector::<S>() * 0.2,
                    weight: random.between(0.1, 10.0),
                }
            })
            .collect();
        let start: Vec<S> = (0..grid.len())
            .map(|_| random.vector::<S>() * 0.1)
            .collect();
        let changes = fit(&build(start.clone()), grid.len(), &pins, 0.0).unwrap();
        let moved = |changes: &[S]| {
            let moves = start.iter().zip(changes).map(|(&a, &b)| a + b);
            build(moves.collect())
        };
        let warp = moved(&changes);
        for pin in &pins {
            let miss = warp.map(&Site::anywhere(pin.source)).distance(pin.target);
            assert!(miss < 1e-9, "round {round}: {miss:e}");
        }
        // Another edit that meets the pins: fitted after a push.
        let push: Vec<S> = (0..grid.len())
            .map(|_| random.vector::<S>() * 0.1)
            .collect();
        let pushed: Vec<S> = start.iter().zip(&push).map(|(&a, &b)| a + b).collect();
        let again = fit(&build(pushed), grid.len(), &pins, 0.0).unwrap();
        let other: Vec<S> = push.iter().zip(&again).map(|(&a, &b)| a + b).collect();
        let size = |list: &[S]| list.iter().map(|d| d.dot(*d)).sum::<f64>();
        assert!(size(&changes) <= size(&other) * (1.0 + 1e-9));
    }
}

#[test]
fn b7_pins_are_met_with_the_least_change() {
    b7_pins::<Plane>();
    b7_pins::<Solid>();
}
