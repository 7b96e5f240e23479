//! Every bug found gets a name here.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_catalog::Context;
use anamorph_core::guarantees::{Verdict, no_fold};
use anamorph_core::{
    Affine, Average, Bounds, Deformation, Field, Modulated, Plane, Scaling, Site, Smoothness,
    Solid, Support, Term, Terms, Warp, glam::dvec2, glam::dvec3, map_all,
};
use anamorph_features::PointPair;
use anamorph_fields::falloffs::{Smoothstep, Wires};
use anamorph_fields::{AxisRange, BoxField, Complement, HalfSpace, Limit, Product, Radial};
use anamorph_tests::subjects::{Registered, entry, parameters};
use anamorph_warps::barr::{AxisFrame, Course, bend::Bend, taper::Taper, twist::Twist};
use anamorph_warps::features::Reach;
use anamorph_warps::features::points::PointWarp;
use anamorph_warps::lattices::bernstein::BernsteinLattice;
use anamorph_warps::lattices::bspline::{BsplineLattice, Knots};
use anamorph_warps::lattices::{Grid, LatticeError};

fn hat(radius: f64) -> Radial<Plane, Wires> {
    Radial::new(Plane::ZERO, radius, Wires).unwrap()
}

fn push() -> Affine<Plane> {
    Affine::translation(dvec2(0.0, 1.0))
}

/// The examples of `points` and `vortex` were those of the plane in space, too.
#[test]
fn examples_of_the_registry_are_valid_in_their_space() {
    fn check<S: Registered>() {
        let context = Context::of_bounds(Bounds::new(S::ZERO, S::splat(2.0)));
        for entry in S::registry() {
            let built = (entry.construct)(&parameters(entry.example), &context);
            assert!(built.is_ok(), "{}: {}", entry.kind, built.err().unwrap());
        }
    }
    check::<Plane>();
    check::<Solid>();
}

/// A vertex at −0 that does not move was written as 0, because adding nothing to −0 gives 0.
#[test]
fn a_negative_zero_that_does_not_move_keeps_its_sign() {
    let still: Vec<Box<dyn Deformation<Solid>>> = vec![
        Box::new(
            PointWarp::construct(vec![(
                PointPair {
                    source: Solid::ONE,
                    target: Solid::ONE,
                },
                Reach {
                    radius: None,
                    falloff: &Wires,
                },
            )])
            .unwrap(),
        ),
        Box::new(lattice(vec![Solid::ZERO; 8]).unwrap()),
        Box::new(Terms::new(vec![Term::new(
            Affine::translation(dvec3(1.0, 1.0, 0.0)),
            1.0,
            1.0,
        )])),
    ];
    for deformation in &still {
        let mut points = [dvec3(0.5, 0.25, -0.0); 9];
        deformation.map_points(0, &mut points);
        for p in points {
            assert!(p.z == 0.0 && p.z.is_sign_negative(), "{p:?}");
        }
    }
}

fn lattice(displacements: Vec<Solid>) -> Result<BernsteinLattice<Solid>, LatticeError> {
    let grid = Grid::around(Bounds::new(-Solid::ONE, Solid::ONE), &[2, 2, 2])?;
    BernsteinLattice::construct(grid, displacements)
}

/// Lattices move points on their faces within a tolerance, and their declared support ended before it.
#[test]
fn supports_of_lattices_hold_the_tolerance_of_their_faces() {
    let warp = lattice(vec![Solid::X; 8]).unwrap();
    let grid = Grid::around(Bounds::new(-Solid::ONE, Solid::ONE), &[3, 3, 3]).unwrap();
    let spline = BsplineLattice::construct(grid, 2, Knots::Clamped, vec![Solid::X; 27]).unwrap();
    let just_outside = dvec3(1.0 + 1e-12, 0.0, 0.0);
    for deformation in [&warp as &dyn Deformation<Solid>, &spline] {
        assert_ne!(deformation.map(&Site::anywhere(just_outside)), just_outside);
        assert!(deformation.facts().support.contains(just_outside));
        let beyond = dvec3(1.0 + 1e-11, 0.0, 0.0);
        assert!(!deformation.facts().support.contains(beyond));
    }
}

/// A strength in a box was taken to lie in a weight's ball when only their bounds did: at the corners the warp jumps.
#[test]
fn a_box_is_not_inside_a_ball_because_their_bounds_are() {
    let corners = Bounds::new(Plane::splat(-0.95), Plane::splat(0.95));
    let strength = BoxField::new(corners, 0.05, Wires).unwrap();
    let warp = Terms::new(vec![Term::new(push(), strength, hat(1.01))]);
    let along = |d: f64| warp.map(&Site::anywhere(Plane::splat(d))) - Plane::splat(d);
    let rim = 1.01 * 0.5_f64.sqrt();
    assert_eq!(along(rim - 1e-9), dvec2(0.0, 1.0));
    assert_eq!(along(rim + 1e-9), Plane::ZERO);
    assert_eq!(warp.facts().edge, Smoothness::Jump);

    let ball = Support::Ball {
        centre: Plane::ZERO,
        radius: 1.0,
    };
    let square = |half: f64| Support::Box(Bounds::new(Plane::splat(-half), Plane::splat(half)));
    assert!(ball.covers(&square(0.7)) && !ball.covers(&square(0.72)));
    assert!(square(1.0).covers(&ball) && !square(0.99).covers(&ball));
    assert!(Support::Everywhere.covers(&ball) && !ball.covers(&Support::Everywhere));
    assert!(ball.covers(&ball) && ball.covers(&Support::Nowhere));
}

/// A weight without bounded support was taken to vanish nowhere; a half-space does, and the warp jumps at its end.
#[test]
fn a_weight_that_ends_without_bounds_jumps() {
    let half = || HalfSpace::new(Plane::ZERO, Plane::X, 0.5, Smoothstep).unwrap();
    let hole = || Complement::new(hat(1.0));
    let part = || {
        Product::new(vec![
            Box::new(half()) as Box<dyn Field<Plane>>,
            Box::new(hat(3.0)),
        ])
    };
    let ending: [Box<dyn Field<Plane>>; 3] = [Box::new(half()), Box::new(hole()), Box::new(part())];
    for weight in ending {
        let term = Term {
            transformation: Box::new(push()),
            strength: Box::new(1.0),
            weight,
        };
        assert_eq!(Terms::new(vec![term]).facts().edge, Smoothness::Jump);
    }
    let whole = || Box::new(Terms::new(vec![Term::new(push(), 1.0, 1.0)]));
    let modulated = || Modulated::new(whole()).with_weight(Box::new(half()));
    assert_eq!(modulated().facts().edge, Smoothness::Jump);
    assert_eq!(
        modulated().with_ambient(0.1).facts().smoothness(),
        Smoothness::C(1)
    );
    // A weight that covers all that moves is no reason to jump.
    let small = || Box::new(Terms::new(vec![Term::new(push(), hat(1.0), 1.0)]));
    let covered = Modulated::new(small()).with_weight(Box::new(hat(2.0)));
    assert_eq!(covered.facts().smoothness(), Smoothness::C(1));
}

/// Terms under an ambient weight were said to jump.
#[test]
fn terms_under_an_ambient_weight_do_not_jump() {
    let terms = || Terms::new(vec![Term::new(push(), 1.0, hat(1.0))]);
    assert_eq!(terms().facts().edge, Smoothness::Jump);
    let ambient = terms().with_average(Average::Ambient(0.1));
    assert_eq!(ambient.facts().smoothness(), Smoothness::C(1));
    assert!(ambient.map(&Site::anywhere(dvec2(1.0 - 1e-9, 0.0))).y < 1e-15);
}

/// An ambient weight was said to make a lattice continuous across its box; its weights sum to 1 up to the faces.
#[test]
fn an_ambient_weight_does_not_mend_the_faces_of_a_lattice() {
    let warp = || Box::new(lattice(vec![Solid::X; 8]).unwrap());
    let ambient = Modulated::new(warp()).with_ambient(0.25);
    let at = |z: f64| ambient.map(&Site::anywhere(dvec3(0.0, 0.0, z))).x;
    assert!((at(1.0) - 0.8).abs() < 1e-12 && at(1.0 + 1e-9) == 0.0);
    assert_eq!(ambient.facts().smoothness(), Smoothness::Jump);
}

/// A modulation that changes nothing gave other bits for a single site than for a run.
#[test]
fn neutral_modulation_serves_the_kernel_for_single_sites() {
    let frame = AxisFrame::new(Solid::ZERO, dvec3(1.0, 2.0, 2.0), None).unwrap();
    let course = || Course::linear(-1.0, 0.3, 1.0, 2.9);
    let twist = || Twist::construct(frame, course(), None, Scaling::Composition).unwrap();
    let wrapped = [
        Modulated::new(Box::new(twist())),
        Modulated::new(Box::new(twist())).with_strength(Box::new(1.0)),
    ];
    let mut random = anamorph_tests::random::Random::new(8);
    for _ in 0..200 {
        let site = Site::anywhere(random.vector::<Solid>());
        for modulated in &wrapped {
            assert_eq!(modulated.map(&site), twist().map(&site));
        }
    }
}

/// A bend at strength 0 moved points by rounding.
#[test]
fn a_bend_without_strength_is_the_identity() {
    let frame = AxisFrame::new(dvec3(0.3, 0.2, 0.1), dvec3(1.0, 2.0, 2.0), None).unwrap();
    for limit in [Limit::Clamp, Limit::Smooth { width: 0.3 }] {
        let range = AxisRange::new(-0.7, 0.9, limit).unwrap();
        let bend = Bend::construct(frame, 1.3, 0.1, Some(range), Scaling::Composition).unwrap();
        for i in 0..50 {
            let address = anamorph_core::Address {
                feature: 0,
                at: -2.0 + 0.0813 * f64::from(i),
            };
            assert_eq!(bend.scaled(address, 0.0), Affine::IDENTITY);
        }
    }
}

/// A determinant that is not a number hid all that came after it.
#[test]
fn a_determinant_that_is_not_a_number_hides_no_fold() {
    let mirror = Affine::new(
        anamorph_core::glam::DMat2::from_cols(dvec2(-1.0, 0.0), dvec2(0.0, 1.0)),
        Plane::ZERO,
    );
    let warp = Terms::new(vec![Term::new(mirror, 1.0, 1.0)]);
    let points = [Plane::splat(f64::NAN), Plane::ZERO];
    assert_eq!(no_fold(&warp, &points, 1.0).verdict, Verdict::Refuted);
}

/// Frames that overflow were reported at `move`, a parameter that a lattice of frames does not have.
#[test]
fn frames_that_overflow_are_reported_at_their_parameter() {
    let toml = "shape = [2, 2, 2]
        frame = [{ index = [0, 0, 0], by = [1e308, 0, 0] }, { index = [0, 0, 0], by = [1e308, 0, 0] }]";
    for scaling in [Scaling::Displacement, Scaling::Composition] {
        let context = Context {
            bounds: Some(Bounds::new(Solid::ZERO, Solid::ONE)),
            scaling: Some(scaling),
            meshes: None,
            attributes: None,
        };
        let built = (entry::<Solid>("frame-lattice").construct)(&parameters(toml), &context);
        assert_eq!(built.err().unwrap().path, "frame");
    }
}

/// What the points of a model are does not change what the engine does with those it cannot move.
#[test]
fn points_that_overflow_are_put_back_and_named() {
    let huge = Affine::translation(dvec2(f64::MAX, 0.0));
    let warp = Terms::new(vec![Term::new(huge, 1.0, 1.0)]);
    let mut points = [dvec2(1.0, 0.0), dvec2(f64::MAX, 0.5), dvec2(-1.0, 0.0)];
    assert_eq!(map_all(&warp, &mut points).indices(), [1]);
    assert_eq!(points[1], dvec2(f64::MAX, 0.5));
}

/// A taper or twist that begins at a limit moved what lies before it by rounding.
#[test]
fn what_lies_before_the_range_of_a_straight_course_keeps_its_bits() {
    let mut random = anamorph_tests::random::Random::new(3);
    for round in 0..300 {
        let (from, length) = (random.between(-3.0, 3.0), random.between(0.1, 4.0));
        let range = AxisRange::new(from, from + length, Limit::Clamp).unwrap();
        let frame = AxisFrame::new(random.vector(), random.direction(), None).unwrap();
        let end = random.between(-2.0, 5.0);
        let course = |start| Course::linear(from, start, from + length, end);
        let how = Scaling::Composition;
        let warp: Box<dyn Warp<Solid>> = if round % 2 == 0 {
            Box::new(Taper::construct(frame, course(1.0), Some(range), how).unwrap())
        } else {
            Box::new(Twist::construct(frame, course(0.0), Some(range), how).unwrap())
        };
        let local = [
            random.between(-2.0, 2.0),
            0.7,
            from - random.between(0.01, 2.0),
        ];
        let p = frame.place(local);
        assert_eq!(warp.map(&Site::anywhere(p)), p);
    }
}

/// A mask that hides a feature was reported as exact interpolation, because the warp without its mask was asked.
#[test]
fn a_mask_counts_against_interpolation() {
    use anamorph_core::guarantees::{Verdict, interpolation, interpolation_of};
    use anamorph_core::{Affine, Condition, Masked, Plane, Term, Terms, glam::dvec2};

    let make = || {
        let condition = Condition {
            feature: 0,
            source: Plane::ZERO,
            target: dvec2(1.0, 0.0),
        };
        let term = Term::new(Affine::translation(dvec2(1.0, 0.0)), 1.0, 1.0);
        Terms::new(vec![term]).with_conditions(vec![condition])
    };
    assert_eq!(interpolation(&make(), 1.0).verdict, Verdict::Proved);
    let masked = Masked::new(Box::new(make()), Box::new(0.5));
    let conditions = make().conditions();
    let verdict = interpolation_of(&masked, &conditions, 1.0);
    assert_eq!(verdict.verdict, Verdict::Refuted);
    assert_eq!(verdict.witness.map(|w| w.value), Some(0.5));
}

/// The weight of a single feature cancels, and so did its kink in what was promised: beside an ambient weight, and among features of one
/// map that come in at different times, it does not.
#[test]
fn weights_that_cancel_show_beside_an_ambient_weight() {
    use anamorph_core::{Facts, Modulated, Scaling, Scheduled, glam::dvec2};
    use anamorph_features::ElementPair;
    use anamorph_warps::lines::{WeightConstants, elements::ElementWarp};

    let warp = |a, b, count| {
        let line = |i: usize| {
            let y = 0.3 * i as f64;
            let source = [dvec2(0.0, y), dvec2(1.0, y)];
            let target = source.map(|p| p + dvec2(0.0, 0.2));
            let pair = ElementPair::of_corners(&source, &target).unwrap();
            (pair, WeightConstants { a, b, p: 0.0 })
        };
        let all: Vec<_> = (0..count).map(line).collect();
        ElementWarp::<Plane>::construct(&all, Scaling::Displacement).unwrap()
    };
    for (a, b, expected) in [
        (0.1, 2.0, Smoothness::C(0)),
        (0.0, 0.5, Smoothness::C(0)),
        (0.0, 2.0, Smoothness::C(1)),
        (0.1, 0.0, Smoothness::Smooth),
    ] {
        let class = |facts: Facts<Plane>| facts.smoothness();
        assert_eq!(class(warp(a, b, 1).facts()), Smoothness::Smooth);
        let ambient = Modulated::new(Box::new(warp(a, b, 1))).with_ambient(0.1);
        assert_eq!(class(ambient.facts()), expected, "{a}, {b}");
        let scheduled = Scheduled::new(warp(a, b, 2), vec![1.0, 0.0], 1.0);
        assert_eq!(class(scheduled.facts()), expected, "{a}, {b}");
    }
}
