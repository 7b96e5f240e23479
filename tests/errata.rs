//! Rows of the errata, pinned by name: what the formulas are, and what they are not.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::guarantees::{Verdict, continuity, interpolation};
use anamorph_core::{
    Affine, Average, Bounds, Condition, Deformation, Linear, Modulated, Plane, Site, Smoothness,
    Solid, Space, Term, Terms, Transformation, Warp, deforming_function,
    glam::{DMat2, dvec2, dvec3},
};
use anamorph_fields::falloffs::Wires;
use anamorph_fields::{Radial, RadialWeight};
use anamorph_tests::random::Random;
use anamorph_transforms::{Component, Composed, Ordered};
use anamorph_warps::lattices::PointLattice;
use anamorph_warps::lattices::bernstein::BernsteinLattice;
use anamorph_warps::lattices::bspline::{BsplineLattice, Knots};
use anamorph_warps::lattices::frames::FrameLattice;
use anamorph_warps::lattices::{Grid, LatticeError};

fn at<S: Space>(warp: &dyn Deformation<S>, p: S) -> S {
    warp.map(&Site::anywhere(p))
}

fn square(shape: &[usize]) -> Result<Grid<Plane>, LatticeError> {
    Grid::around(Bounds::new(Plane::ZERO, Plane::ONE), shape)
}

/// A lattice over the unit square, one control point of which moves.
fn one_moved(shape: [usize; 2], index: [usize; 2], by: Plane) -> BernsteinLattice<Plane> {
    let grid = square(&shape).unwrap();
    let mut list = vec![Plane::ZERO; grid.len()];
    list[grid.flat([index[0], index[1], 0])] = by;
    BernsteinLattice::construct(grid, list).unwrap()
}

/// F1: `B_i^d(t) = C(d,i) tⁱ (1−t)^(d−i)`; reversed, a lattice point would move its mirror image.
#[test]
fn f1_bernstein_index_is_not_reversed() {
    let warp = one_moved([4, 2], [1, 0], dvec2(0.0, 1.0));
    for i in 0..=20 {
        let t = f64::from(i) / 20.0;
        let moved = at(&warp, dvec2(t, 0.0)).y;
        assert!((moved - 3.0 * t * (1.0 - t) * (1.0 - t)).abs() < 1e-15);
    }
    // Its own place moves more than its mirror image.
    assert!(at(&warp, dvec2(1.0 / 3.0, 0.0)).y > 1.9 * at(&warp, dvec2(2.0 / 3.0, 0.0)).y);
    // The corner goes where its control point goes.
    let corner = one_moved([5, 3], [0, 2], dvec2(0.25, 0.5));
    assert_eq!(at(&corner, dvec2(0.0, 1.0)), dvec2(0.25, 1.5));
    assert_eq!(at(&corner, dvec2(1.0, 0.0)), dvec2(1.0, 0.0));
}

/// F2: `T = P* − P`: the model follows the control points, it does not flee them.
#[test]
fn f2_points_follow_their_control_points() {
    let by = dvec2(0.3, -0.2);
    let grid = square(&[3, 4]).unwrap();
    let warp = BernsteinLattice::construct(grid, vec![by; 12]).unwrap();
    for p in [dvec2(0.1, 0.9), dvec2(0.5, 0.5), dvec2(1.0, 0.0)] {
        assert!((at(&warp, p) - (p + by)).length() < 1e-15);
    }
    for condition in warp.conditions() {
        assert!((condition.target - condition.source - by).length() < 1e-15);
    }
}

/// F3: outside the closed box (tolerance 1e-12 of its edges) points stay; C^k across a face iff the outer k + 1 planes stay.
#[test]
fn f3_outside_the_box_nothing_moves() {
    let warp = one_moved([3, 3], [1, 1], dvec2(0.0, 0.8));
    for p in [dvec2(1.0 + 1e-11, 0.5), dvec2(-0.3, 0.5), dvec2(0.5, 1.7)] {
        assert_eq!(at(&warp, p), p);
    }
    // The polynomial, left to itself, would go negative there.
    let extended = 2.0 * 1.3 * (1.0 - 1.3) * 0.5;
    assert!(extended < 0.0);
    // On the face and within its tolerance the lattice holds.
    let faces = one_moved([3, 3], [2, 1], dvec2(0.0, 0.8));
    for x in [1.0, 1.0 + 5e-13] {
        let moved = at(&faces, dvec2(x, 0.5)) - dvec2(x, 0.5);
        assert!((moved - dvec2(0.0, 0.4)).length() < 1e-12);
    }
}

#[test]
fn f3_continuity_across_faces_counts_still_planes() {
    let edge = |shape: [usize; 2], index: [usize; 2]| {
        one_moved(shape, index, dvec2(0.1, 0.1)).facts().edge
    };
    assert_eq!(edge([7, 7], [0, 3]), Smoothness::Jump);
    assert_eq!(edge([7, 7], [6, 3]), Smoothness::Jump);
    assert_eq!(edge([7, 7], [1, 3]), Smoothness::C(0));
    assert_eq!(edge([7, 7], [3, 4]), Smoothness::C(1));
    assert_eq!(edge([7, 7], [3, 3]), Smoothness::C(2));
    // Only if: a plane that moves is seen in the derivative of its order, and of no lower one.
    let order = |index: [usize; 2]| {
        let warp = one_moved([7, 7], index, dvec2(0.0, 1.0));
        let moved = |x: f64| at(&warp, dvec2(1.0 - x, 0.5)).y - 0.5;
        (moved(1e-3) / moved(5e-4)).log2().round()
    };
    assert_eq!(
        (order([6, 3]), order([5, 3]), order([4, 3])),
        (0.0, 1.0, 2.0)
    );
    // For frames, identity transformations suffice; a frame that turns about a point of the face is no identity.
    let grid = square(&[3, 3]).unwrap();
    let mut frames: Vec<Box<dyn Transformation<Plane>>> = Vec::new();
    for flat in 0..9 {
        let turn = Affine::about(
            dvec2(1.0, 0.5),
            Plane::rotation(Plane::ZERO, 0.5),
            Plane::ZERO,
        );
        let still = flat != grid.flat([2, 1, 0]);
        frames.push(Box::new(if still { Affine::IDENTITY } else { turn }));
    }
    let warp = FrameLattice::construct(grid, frames).unwrap();
    assert_eq!(warp.facts().edge, Smoothness::Jump);
    let p = dvec2(1.0, 0.25);
    assert!((at(&warp, p) - p).length() > 0.02);
}

/// One feature at the origin that pushes by 1, with the given radii of strength and weight.
fn feature(strength: Option<f64>, weight: f64) -> Terms<Plane> {
    let hat = |radius| Radial::new(Plane::ZERO, radius, Wires).unwrap();
    let push = Affine::translation(dvec2(0.0, 1.0));
    let term = match strength {
        Some(radius) => Term::new(push, hat(radius), hat(weight)),
        None => Term::new(push, 1.0, hat(weight)),
    };
    let condition = Condition {
        feature: 0,
        source: Plane::ZERO,
        target: dvec2(0.0, 1.0),
    };
    Terms::new(vec![term]).with_conditions(vec![condition])
}

/// F4: a radius on the weight alone jumps by the whole displacement at the edge, and the report says so.
#[test]
fn f4_a_radius_on_the_weight_alone_jumps() {
    let warp = feature(None, 1.0);
    let up = |x: f64| at(&warp, dvec2(x, 0.0)).y;
    assert_eq!(
        (up(0.0), up(0.5), up(1.0 - 1e-9), up(1.0 + 1e-9)),
        (1.0, 1.0, 1.0, 0.0)
    );
    let facts = warp.facts();
    assert_eq!(facts.edge, Smoothness::Jump);
    assert!(facts.notes[0].contains("jumps"), "{:?}", facts.notes);
    let verdict = continuity(&warp);
    assert_eq!(verdict.verdict, Verdict::Unknown);
    assert!(verdict.statement.contains("may jump at the edge"));
    assert_eq!(interpolation(&warp, 1.0).verdict, Verdict::Proved);
}

#[test]
fn f4_radii_on_strength_and_weight_do_not_jump() {
    let warp = feature(Some(1.0), 1.0);
    for (x, largest) in [(0.9, 0.04), (0.99, 4e-4), (1.0 - 1e-6, 1e-11)] {
        let moved = at(&warp, dvec2(x, 0.0)).y;
        assert!(moved > 0.0 && moved < largest, "{x}: {moved}");
    }
    assert_eq!(warp.facts().smoothness(), Smoothness::C(1));
    assert_eq!(continuity(&warp).verdict, Verdict::Proved);
    assert_eq!(interpolation(&warp, 1.0).verdict, Verdict::Proved);
}

#[test]
fn f4_an_ambient_weight_mends_the_jump_and_costs_exactness() {
    for ambient in [1e-3, 0.05, 2.0] {
        let own = feature(None, 1.0).with_average(Average::Ambient(ambient));
        let wrapped = Modulated::new(Box::new(feature(None, 1.0))).with_ambient(ambient);
        let warps: [&dyn Warp<Plane>; 2] = [&own, &wrapped];
        for warp in warps {
            // At a lone feature the displacement is w/(w + ε) of the whole.
            for x in [0.0, 0.3, 0.7, 0.95] {
                let w = (1.0_f64 - x * x).powi(2);
                let moved = warp.map(&Site::anywhere(dvec2(x, 0.0))).y;
                assert!((moved - w / (w + ambient)).abs() < 1e-14, "{x}: {moved}");
            }
            let rim = warp.map(&Site::anywhere(dvec2(1.0 - 1e-9, 0.0))).y;
            assert!(rim < 1e-13, "{rim}");
            assert_eq!(warp.facts().smoothness(), Smoothness::C(1));
            assert_eq!(continuity(warp).verdict, Verdict::Proved);
            let verdict = interpolation(warp, 1.0);
            assert_eq!(verdict.verdict, Verdict::Refuted);
            let miss = verdict.witness.unwrap().value;
            assert!((miss - ambient / (1.0 + ambient)).abs() < 1e-14);
        }
        assert!(
            wrapped
                .facts()
                .notes
                .iter()
                .any(|n| n.contains("approximate"))
        );
    }
}

/// F5: averages are of displacements; `D = I + Σ ŵ(A − I)`, not `Σ ŵ A` applied after a sum that does not reach 1.
#[test]
fn f5_displacements_are_averaged() {
    let mut random = Random::new(5);
    for _ in 0..200 {
        let parts: Vec<(Affine<Solid>, f64, f64)> = (0..4)
            .map(|_| {
                (
                    random.affine(),
                    random.between(-1.0, 2.0),
                    random.between(0.0, 3.0),
                )
            })
            .collect();
        let terms = parts.iter().map(|&(a, s, w)| Term::new(a, s, w));
        let ambient = random.between(0.0, 1.0);
        let warp = Terms::new(terms.collect()).with_average(Average::Ambient(ambient));
        let p = random.vector::<Solid>() * 3.0;
        let total: f64 = ambient + parts.iter().map(|t| t.2).sum::<f64>();
        let mut expected = p;
        for (a, s, w) in &parts {
            // s·T under displacement scaling moves p by s (T⟨p⟩ − p).
            expected += (a.apply(p) - p) * (s * w / total);
        }
        assert!((at(&warp, p) - expected).length() < 1e-12);
        let matrix = deforming_function(&warp, &Site::anywhere(p));
        assert!((matrix.apply(p) - expected).length() < 1e-12);
        // The matrices' weights sum to less than 1; averaging them alone would shrink space.
        let mut sum = <anamorph_core::glam::DMat3 as Linear<Solid>>::ZERO;
        for (a, s, w) in &parts {
            sum += a.scaled(*s).linear * (w / total);
        }
        let shrunk =
            sum + <anamorph_core::glam::DMat3 as Linear<Solid>>::IDENTITY * (ambient / total);
        assert!(anamorph_tests::measure::linear_distance::<Solid>(&matrix.linear, &shrunk) < 1e-12);
    }
}

/// F18: composition scaling has a centre.
#[test]
fn f18_composition_scaling_is_about_a_centre() {
    let quarter = Plane::rotation(Plane::ZERO, core::f64::consts::FRAC_PI_2);
    let map = Affine::about(dvec2(3.0, 0.0), quarter, Plane::ZERO);
    let p = dvec2(4.0, 0.0);
    let half = |centre| Composed::new(map, centre).unwrap().scaled(0.5).apply(p);
    let d = 0.5_f64.sqrt();
    assert!((half(dvec2(3.0, 0.0)) - dvec2(3.0 + d, d)).length() < 1e-14);
    // About another centre the same map is a turn and a shift, and goes elsewhere at half strength.
    assert!((half(Plane::ZERO) - half(dvec2(3.0, 0.0))).length() > 0.5);
}

/// F18: reflections go to the stretch, whose rotation is the smallest, and are singular at some strength.
#[test]
fn f18_reflections_are_stretches() {
    let mirror = DMat2::from_cols(dvec2(-1.0, 0.0), dvec2(0.0, 1.0));
    let composed = Composed::new(Affine::new(mirror, Plane::ZERO), Plane::ZERO).unwrap();
    assert_eq!(composed.turn().angle, 0.0);
    assert!(composed.scaled(0.5).linear.determinant().abs() < 1e-15);
    // −I in space is a half turn and a mirror across it: no rotation at all is smaller still.
    let all = <anamorph_core::glam::DMat3 as Linear<Solid>>::IDENTITY * -1.0;
    let composed = Composed::new(Affine::new(all, Solid::ZERO), Solid::ZERO).unwrap();
    assert!(Linear::<Solid>::determinant(&composed.stretch()) < 0.0);
    assert!(composed.turn().angle.abs() < 1e-12);
}

/// F18: a rotation by π turns counter-clockwise in the plane; the stretch scales as `I + (U − I)s`, not `U^s`.
#[test]
fn f18_half_turns_and_stretches() {
    let half_turn = Plane::rotation(Plane::ZERO, core::f64::consts::PI);
    for linear in [
        half_turn,
        DMat2::from_cols(dvec2(-1.0, 0.0), dvec2(0.0, -1.0)),
    ] {
        let turn = Composed::new(Affine::new(linear, Plane::ZERO), Plane::ZERO).unwrap();
        assert!((turn.scaled(0.5).apply(Plane::X) - Plane::Y).length() < 1e-12);
    }
    let stretch = DMat2::from_cols(dvec2(9.0, 0.0), dvec2(0.0, 1.0));
    let composed = Composed::new(Affine::new(stretch, Plane::ZERO), Plane::ZERO).unwrap();
    assert!((composed.scaled(0.5).apply(Plane::X).x - 5.0).abs() < 1e-14);
    let ordered = Ordered::new(&[Component::Scale(dvec2(9.0, 1.0))], Plane::ZERO).unwrap();
    assert!((ordered.scaled(0.5).apply(Plane::X).x - 5.0).abs() < 1e-14);
}

/// F20: affine edits are reproduced with control points at Greville abscissae, and not with evenly spaced ones.
#[test]
fn f20_control_points_stand_at_greville_abscissae() {
    let edit = Affine::new(
        DMat2::from_cols(dvec2(1.3, 0.2), dvec2(-0.4, 0.8)),
        dvec2(0.1, -0.3),
    );
    for knots in [Knots::Uniform, Knots::Clamped] {
        let grid = || square(&[7, 6]).unwrap();
        let still = BsplineLattice::construct(grid(), 3, knots, vec![Plane::ZERO; 42]).unwrap();
        let rest: Vec<Plane> = (0..42).map(|i| still.control_point(i)).collect();
        let moved = rest.iter().map(|&p| edit.displacement(p)).collect();
        let warp = BsplineLattice::construct(grid(), 3, knots, moved).unwrap();
        let evenly =
            (0..42).map(|i| edit.displacement(dvec2((i / 6) as f64 / 6.0, (i % 6) as f64 / 5.0)));
        let wrong = BsplineLattice::construct(grid(), 3, knots, evenly.collect()).unwrap();
        let (mut error, mut other) = (0.0_f64, 0.0_f64);
        for i in 0..=400 {
            let p = dvec2(f64::from(i % 20) / 19.0, f64::from(i / 20) / 20.0);
            error = error.max(at(&warp, p).distance(edit.apply(p)));
            other = other.max(at(&wrong, p).distance(edit.apply(p)));
        }
        assert!(error < 1e-14 && other > 0.01, "{error}, {other}");
        // Uniform knots put one ring outside the box; clamped ones put the outer points on its faces.
        let first = rest[0];
        match knots {
            Knots::Uniform => assert!((first - dvec2(-0.25, -1.0 / 3.0)).length() < 1e-15),
            Knots::Clamped => assert_eq!(first, Plane::ZERO),
        }
    }
}

/// The weight `1/d²` that the point warps use is a field, too, infinite at the feature: it decides alone there.
#[test]
fn f4_infinite_weights_decide_alone() {
    let far = RadialWeight::new(dvec3(1.0, 0.0, 0.0), None, Wires).unwrap();
    let near = RadialWeight::new(Solid::ZERO, None, Wires).unwrap();
    let push = |v| Affine::translation(v);
    let warp = Terms::new(vec![
        Term::new(push(Solid::Y), 1.0, near),
        Term::new(push(Solid::Z), 1.0, far),
    ])
    .with_average(Average::Ambient(0.5));
    assert_eq!(at(&warp, Solid::ZERO), Solid::Y);
    assert_eq!(at(&warp, Solid::X), Solid::X + Solid::Z);
}
