//! B16: an axis that is bent carries the model along.

use anamorph_core::Differentiable;
use anamorph_core::glam::{DMat2, DMat3, DVec2, dvec2, dvec3};
use anamorph_core::{Curve, Deformation, Plane, Site, Solid, Space, math};
use anamorph_curves::families::{CatmullRom, Generator};
use anamorph_curves::orientation::Orienter;
use anamorph_curves::{Indexed, PiecewiseCubic};
use anamorph_fields::falloffs::Smootherstep;
use anamorph_tests::random::Random;
use anamorph_warps::wires::{AxialCurve, AxialReach, Axis, Rail, Station};
use std::sync::Arc;

fn at<S: Space>(warp: &dyn Deformation<S>, p: S) -> S {
    warp.map(&Site::anywhere(p))
}

/// Stations of a circle of radius 2 about (2, 0), from the origin upwards and over to the right, for a length.
fn arc(length: f64) -> impl Fn(f64) -> Station<Plane> {
    move |share| {
        let (sin, cos) = math::sin_cos(share * length / 2.0);
        let along = dvec2(sin, cos);
        Station {
            point: dvec2(2.0 - 2.0 * cos, 2.0 * sin),
            frame: DMat2::from_cols(along, along.perp()),
        }
    }
}

fn upright(length: f64) -> Axis<Plane> {
    Axis::Line {
        origin: DVec2::ZERO,
        frame: DMat2::from_cols(DVec2::Y, DVec2::NEG_X),
        length,
    }
}

#[test]
fn b16_an_axis_bent_into_a_circle_is_a_bend() {
    let length = 3.0;
    let rail = Rail::new("target", &[], &arc(length), 1e-10).unwrap();
    let warp = AxialCurve::construct(upright(length), rail, None).unwrap();
    let mut random = Random::new(161);
    for _ in 0..500 {
        let p = dvec2(random.between(-1.0, 1.0), random.between(-1.0, 4.0));
        let at_axis = p.y.clamp(0.0, length);
        let angle = at_axis / 2.0;
        let (sin, cos) = angle.sin_cos();
        let radius = 2.0 - p.x;
        let beyond = p.y - at_axis;
        let expected = dvec2(2.0 - radius * cos, radius * sin) + dvec2(sin, cos) * beyond;
        let off = at(&warp, p).distance(expected);
        assert!(off < 1e-8, "{p:?}: {off:e}");
    }
    assert!(warp.target().error() <= 1e-10);
}

#[test]
fn b16_rigid_edits_of_the_axis_are_rigid() {
    let mut random = Random::new(162);
    for _ in 0..20 {
        let start: DMat3 = random.rotation::<Solid>();
        let turn: DMat3 = random.rotation::<Solid>();
        let (origin, shift) = (random.vector::<Solid>(), random.vector::<Solid>() * 3.0);
        let length = random.between(0.5, 4.0);
        let station = |share: f64| Station {
            point: turn * (origin + start.x_axis * (share * length)) + shift,
            frame: turn * start,
        };
        let axis = Axis::Line {
            origin,
            frame: start,
            length,
        };
        let rail = Rail::new("target", &[], &station, 1e-12).unwrap();
        let reach = AxialReach {
            inner: 50.0,
            outer: 60.0,
            falloff: &Smootherstep,
        };
        let warp = AxialCurve::construct(axis, rail, Some(reach)).unwrap();
        for _ in 0..50 {
            let p = random.vector::<Solid>() * 5.0;
            let error = at(&warp, p).distance(turn * p + shift);
            assert!(error < 1e-12 * 20.0, "{error:e}");
        }
        // Beyond the reach nothing moves; at its middle, half of the displacement.
        let across = start.y_axis;
        let far = origin + across * 60.0;
        assert_eq!(at(&warp, far), far);
        let p = origin + across * 55.0;
        let half = (at(&warp, p) - p) * 2.0;
        assert!(half.distance(turn * p + shift - p) < 1e-10);
    }
}

#[test]
fn b16_a_curved_axis_carries_its_frames() {
    // A wavy axis straightened: points keep their distance from it.
    let points: Vec<Solid> = (0..6)
        .map(|i| {
            dvec3(
                f64::from(i),
                0.4 * f64::from(i).sin(),
                0.2 * f64::from(i % 2),
            )
        })
        .collect();
    let curve: Arc<PiecewiseCubic<Solid>> = Arc::new(CatmullRom::new(points).curve().unwrap());
    let frames = anamorph_curves::orientation::RotationMinimizing::default()
        .along(curve.clone())
        .unwrap();
    let (start, end) = curve.domain();
    let source = |share: f64| {
        let v = start + (end - start) * share;
        let frame = frames.frame(v);
        Station {
            point: curve.point(v),
            frame: DMat3::from_cols(frame.forward(), frame.up(), -frame.side()),
        }
    };
    let straight = |share: f64| Station {
        point: Solid::Y * (share * 5.0),
        frame: DMat3::from_cols(Solid::Y, Solid::Z, Solid::X),
    };
    let indexed = Indexed::new(curve.clone());
    let breaks = curve.breaks().into_iter();
    let shares: Vec<f64> = breaks.map(|v| (v - start) / (end - start)).collect();
    let axis = Axis::Curve {
        curve: Arc::new(indexed),
        rail: Rail::new("source", &shares, &source, 1e-10).unwrap(),
    };
    let target = Rail::new("target", &[], &straight, 1e-10).unwrap();
    let warp = AxialCurve::construct(axis, target, None).unwrap();
    let mut random = Random::new(163);
    for _ in 0..200 {
        let v = random.between(start + 0.1, end - 0.1);
        let frame = frames.frame(v);
        let angle = random.between(0.0, 6.0);
        let out = frame.up() * angle.cos() + frame.side() * angle.sin();
        let p = curve.point(v) + out * 0.1;
        let q = at(&warp, p);
        let share = (v - start) / (end - start);
        assert!((q.y - 5.0 * share).abs() < 1e-6, "{q:?}");
        assert!((dvec2(q.x, q.z).length() - 0.1).abs() < 1e-6);
    }
}
