//! B1: points land on their targets. B2: frames become their targets, exactly, linear part included; the vortex.

use anamorph_core::{
    Deformation, Linear, Plane, Scaling, Site, Solid, Space, deforming_function,
    difference_jacobian,
    glam::{dvec2, dvec3},
    guarantees,
};
use anamorph_features::{Frame, FramePair, PointPair};
use anamorph_fields::falloffs::{FALLOFFS, Falloff, Smoothstep, Wires};
use anamorph_tests::measure::linear_distance;
use anamorph_tests::random::Random;
use anamorph_transforms::Rotational;
use anamorph_warps::features::frames::FrameWarp;
use anamorph_warps::features::points::PointWarp;
use anamorph_warps::features::vortex::Vortex;
use anamorph_warps::features::{FeatureError, Reach};

fn b1<S: Space>() {
    let mut random = Random::new(11);
    let compact = FALLOFFS.iter().copied().filter(Falloff::compact);
    for falloff in compact {
        for radius in [None, Some(0.4), Some(2.0)] {
            let pairs: Vec<(PointPair<S>, Reach)> = (0..6)
                .map(|_| {
                    let source = random.vector::<S>();
                    let target = random.vector();
                    (PointPair { source, target }, Reach { radius, falloff })
                })
                .collect();
            let warp = PointWarp::construct(pairs.clone()).unwrap();
            for (pair, _) in &pairs {
                let landed = warp.map(&Site::anywhere(pair.source));
                let alone = landed.distance(pair.target);
                assert!(alone < 1e-14, "{}: {alone}", falloff.name());
                // It comes from all sides continuously.
                let beside = pair.source + S::unit(0) * 1e-9;
                assert!(warp.map(&Site::anywhere(beside)).distance(pair.target) < 1e-7);
            }
            let verdict = guarantees::interpolation(&warp, 2.0);
            assert_eq!(verdict.verdict, guarantees::Verdict::Proved);
        }
    }
}

#[test]
fn b1_sources_land_on_targets() {
    b1::<Plane>();
    b1::<Solid>();
}

#[test]
fn b1_reaches_are_kept() {
    let reach = |radius| Reach {
        radius: Some(radius),
        falloff: &Smoothstep,
    };
    let pair = PointPair {
        source: Plane::ZERO,
        target: dvec2(0.5, 0.0),
    };
    let warp = PointWarp::construct(vec![(pair, reach(2.0))]).unwrap();
    // A lone feature moves by f(d/r) of its displacement.
    for i in 0..40 {
        let d = 0.06 * f64::from(i);
        let expected = if d < 2.0 {
            0.5 * Smoothstep.value(d / 2.0)
        } else {
            0.0
        };
        let moved = warp.map(&Site::anywhere(dvec2(0.0, d))).x;
        assert!((moved - expected).abs() < 1e-15);
    }
    let bad = PointWarp::construct(vec![(pair, reach(1.0)), (pair, reach(0.0))]);
    assert_eq!(
        bad.err(),
        Some(FeatureError::Radius {
            feature: 1,
            radius: 0.0
        })
    );
}

fn random_pair<S: Space>(random: &mut Random, origin: S) -> FramePair<S> {
    let basis = |random: &mut Random| loop {
        let linear = random.linear::<S>();
        if linear.determinant().abs() > 0.2 {
            return linear;
        }
    };
    FramePair {
        source: Frame::new(origin, basis(random)).unwrap(),
        target: Frame::new(random.vector(), basis(random)).unwrap(),
    }
}

fn b2<S: Rotational>() {
    let mut random = Random::new(22);
    for round in 0..60 {
        let count = [1, 5][round % 2];
        let radius = [None, Some(0.9), Some(3.0)][round % 3];
        for scaling in [Scaling::Displacement, Scaling::Composition] {
            let reach = Reach {
                radius,
                falloff: &Wires,
            };
            let pairs: Vec<(FramePair<S>, Reach)> = (0..count)
                .map(|_| {
                    let origin = random.vector::<S>() * 2.0;
                    (random_pair(&mut random, origin), reach)
                })
                .collect();
            let warp = FrameWarp::construct(pairs.clone(), scaling).unwrap();
            for (pair, _) in &pairs {
                let origin = pair.source.origin();
                let site = Site::anywhere(origin);
                let landed = warp.map(&site).distance(pair.target.origin());
                assert!(landed < 1e-13, "{scaling:?}: {landed}");
                // The deforming function at the origin takes the whole frame along.
                let there = deforming_function(&warp, &site);
                let basis = there.linear.after(&pair.source.basis());
                let error = linear_distance::<S>(&basis, &pair.target.basis());
                assert!(error < 1e-12, "{scaling:?}: {error}");
                // So does the warp itself: its Jacobian is the frame's map, whose fields are flat there.
                let map = pair.affine().unwrap();
                let jacobian = difference_jacobian(&warp, &site, 1e-2).unwrap();
                let error = linear_distance::<S>(&jacobian, &map.linear);
                let size = anamorph_tests::measure::linear_size::<S>(&map.linear);
                assert!(error < 1e-5 * (1.0 + size), "{scaling:?}, {count}: {error}");
            }
        }
    }
}

#[test]
fn b2_frames_become_their_targets() {
    b2::<Plane>();
    b2::<Solid>();
}

#[test]
fn b2_a_lone_frame_without_radius_is_its_map_everywhere() {
    let mut random = Random::new(23);
    for scaling in [Scaling::Displacement, Scaling::Composition] {
        let pair = random_pair(&mut random, Solid::X);
        let reach = Reach {
            radius: None,
            falloff: &Wires,
        };
        let warp = FrameWarp::construct(vec![(pair, reach)], scaling).unwrap();
        for _ in 0..100 {
            let p = random.vector::<Solid>() * 10.0;
            let expected = pair.affine().unwrap().apply(p);
            assert!((warp.map(&Site::anywhere(p)) - expected).length() < 1e-11);
        }
    }
}

#[test]
fn b2_vortex_turns_by_the_falloff_and_keeps_distances() {
    let mut random = Random::new(24);
    let (centre, axis, angle, radius) = (dvec3(0.3, 0.2, 0.0), dvec3(1.0, 1.0, 1.0), 9.5, 1.5);
    let warp = Vortex::construct(centre, axis, angle, radius, &Wires, Scaling::Composition);
    let warp = warp.unwrap();
    let unit = axis.normalize();
    for _ in 0..500 {
        let p = random.vector::<Solid>() * 2.0;
        let q = warp.map(&Site::anywhere(p));
        let (along, out) = ((p - centre).dot(unit), (p - centre).reject_from(unit));
        let turned = (q - centre).reject_from(unit);
        // Height and distance from the axis stay; the angle is f(d/r) of the whole.
        assert!(((q - centre).dot(unit) - along).abs() < 1e-14);
        assert!((turned.length() - out.length()).abs() < 1e-14);
        let share = Wires.value(out.length() / radius) * angle;
        let expected = anamorph_core::glam::DQuat::from_axis_angle(unit, share) * out;
        assert!((turned - expected).length() < 1e-13);
        // A swirl of circles against each other keeps volume.
        let jacobian = warp.jacobian(&Site::anywhere(p), 4.0).unwrap();
        assert!((Linear::<Solid>::determinant(&jacobian) - 1.0).abs() < 1e-6);
    }
    // In the plane counter-clockwise is positive.
    let quarter = core::f64::consts::FRAC_PI_2;
    let plane = Vortex::construct(
        Plane::ZERO,
        Plane::ZERO,
        quarter,
        1.0,
        &Wires,
        Scaling::Composition,
    );
    let q = plane.unwrap().map(&Site::anywhere(dvec2(1e-9, 0.0)));
    assert!((q - dvec2(0.0, 1e-9)).length() < 1e-20);
}
