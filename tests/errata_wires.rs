//! Errata of wires, one test a row and point: F8, F9, F10, F17.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::glam::{DVec2, DVec3, dvec2, dvec3};
use anamorph_core::{
    Address, Affine, Curve, Deformation, Differentiable, Influences, Linear, Modulated, Plane,
    Sampling, Site, Solid, Space, Warp, math,
};
use anamorph_curves::{Bezier, Indexed, PiecewiseBezier};
use anamorph_fields::{Falloff, falloffs::Wires as Hat};
use anamorph_tests::random::Random;
use anamorph_warps::wires::{Along, ContinuousWires, Wire, Wires};
use std::sync::Arc;

type Held<S> = Indexed<S, Box<Bezier<S>>>;

fn bezier<S: Space>(points: &[S]) -> Arc<Held<S>> {
    Arc::new(Indexed::new(Box::new(
        Bezier::new(points.to_vec()).unwrap(),
    )))
}

fn at<S: Space>(warp: &dyn Deformation<S>, p: S) -> S {
    warp.map(&Site::anywhere(p))
}

fn place(feature: u32, at: f64) -> Address {
    Address { feature, at }
}

/// The rotation of a wire's transformation at a parameter and a strength.
fn rotation(warp: &Wires<Solid>, v: f64, s: f64) -> anamorph_core::glam::DMat3 {
    warp.scaled(place(0, v), s).linear
}

#[test]
fn f8_translation_after_rotation_after_scale_composed() {
    let source = bezier(&[dvec2(1.0, 1.0), dvec2(3.0, 1.0)]);
    let target = bezier(&[dvec2(5.0, 0.0), dvec2(5.0, 4.0)]);
    let mut wire = Wire::new(source, target, 1.0);
    wire.scale = Along::constant(1.8);
    let warp = Wires::construct(vec![wire], None).unwrap();
    for s in [0.0, 0.25, 0.7, 1.0] {
        let found = warp.scaled(place(0, 0.5), s);
        let centre = dvec2(2.0, 1.0);
        let turned = |p: DVec2| {
            let (sin, cos) = math::sin_cos(s * core::f64::consts::FRAC_PI_2);
            let q = (p - centre) * (1.0 + 0.8 * s);
            centre + dvec2(cos * q.x - sin * q.y, sin * q.x + cos * q.y) + dvec2(3.0, 1.0) * s
        };
        for p in [dvec2(0.0, 0.0), dvec2(2.5, 1.5), dvec2(-3.0, 7.0)] {
            assert!(found.apply(p).distance(turned(p)) < 1e-14 * 10.0, "{s}");
        }
    }
    assert_eq!(warp.scaled(place(0, 0.5), 0.0), Affine::IDENTITY);
}

/// A source and a target whose direction turns, in the plane across the source, by an angle that a function gives.
fn turning(points: usize, angle: impl Fn(f64) -> DVec3) -> Wires<Solid> {
    let source: Vec<Solid> = vec![Solid::ZERO, Solid::X];
    // Many short straight pieces whose directions are given.
    let mut here = dvec3(0.0, 2.0, 0.0);
    let (mut pieces, mut breaks) = (Vec::new(), vec![0.0]);
    for i in 0..points {
        let v = (i as f64 + 0.5) / points as f64;
        let next = here + angle(v) / points as f64;
        pieces.push(Bezier::new(vec![here, next]).unwrap());
        breaks.push((i as f64 + 1.0) / points as f64);
        here = next;
    }
    let target = PiecewiseBezier::new(pieces, breaks, false).unwrap();
    Wires::construct(
        vec![Wire::new(bezier(&source), Arc::new(target), 1.0)],
        None,
    )
    .unwrap()
}

#[test]
fn f8_opposite_directions_take_the_axis_of_the_nearest_smaller_parameter() {
    // The first quarter turns about y, then directions are opposite, the last quarter turns about z.
    let warp = turning(64, |v| {
        if v < 0.25 {
            dvec3(-0.6, 0.0, -0.8)
        } else if v > 0.75 {
            dvec3(-0.6, 0.8, 0.0)
        } else {
            -DVec3::X
        }
    });
    for v in [0.26, 0.4, 0.5, 0.74] {
        for s in [0.3, 0.5, 1.0] {
            let expected = <Solid as Space>::rotation(Solid::Y, s * core::f64::consts::PI);
            let found = rotation(&warp, v, s);
            assert!(
                (found - expected)
                    .to_cols_array()
                    .iter()
                    .all(|e| e.abs() < 1e-9),
                "{v}"
            );
        }
    }
}

#[test]
fn f8_opposite_from_the_start_take_the_axis_of_the_nearest_larger_parameter() {
    let warp = turning(64, |v| {
        if v > 0.5 {
            dvec3(-0.6, 0.8, 0.0)
        } else {
            -DVec3::X
        }
    });
    let expected = <Solid as Space>::rotation(Solid::Z, 0.5 * core::f64::consts::PI);
    let found = rotation(&warp, 0.2, 0.5);
    assert!(
        (found - expected)
            .to_cols_array()
            .iter()
            .all(|e| e.abs() < 1e-9)
    );
}

#[test]
fn f8_opposite_everywhere_take_the_least_aligned_axis_carried_along() {
    // A helix and the same with reversed directions: a half turn about an axis that does not twist about the source.
    let helix: Vec<Solid> = (0..=60)
        .map(|i| {
            let t = f64::from(i) * 0.1;
            dvec3(t.cos(), t.sin(), 0.3 * t)
        })
        .collect();
    let curve = |sign: f64| {
        use anamorph_curves::families::{CatmullRom, Generator};
        let points: Vec<Solid> = helix.iter().map(|p| *p * sign).collect();
        Box::new(CatmullRom::new(points).curve().unwrap())
    };
    let source = curve(1.0);
    let warp = Wires::construct(
        vec![Wire::new(
            Arc::new(Indexed::new(curve(1.0))),
            Arc::new(*curve(-1.0)),
            1.0,
        )],
        None,
    )
    .unwrap();
    let axis = |v: f64| {
        // Half a half turn: the skew part of the matrix is the axis.
        let m = rotation(&warp, v, 0.5);
        0.5 * dvec3(
            m.y_axis.z - m.z_axis.y,
            m.z_axis.x - m.x_axis.z,
            m.x_axis.y - m.y_axis.x,
        )
    };
    let start = source.domain().0;
    let first = source.velocity(start).normalize();
    let least = [Solid::X, Solid::Y, Solid::Z]
        .into_iter()
        .min_by(|a, b| a.dot(first).abs().total_cmp(&b.dot(first).abs()))
        .unwrap();
    assert!((axis(start) - first.cross(least).normalize()).length() < 1e-9);
    // Rotation-minimizing: the axis changes along the direction alone.
    let (_, end) = source.domain();
    let h = 1e-4;
    for i in 1..40 {
        let v = start + (end - start) * f64::from(i) / 40.0 + 0.013;
        let along = source.velocity(v).normalize();
        let a = axis(v);
        assert!(a.dot(along).abs() < 1e-9 && (a.length() - 1.0).abs() < 1e-9);
        let change = (axis(v + h) - axis(v - h)) / (2.0 * h);
        let twist = change.dot(along.cross(a));
        assert!(twist.abs() < 1e-4, "{v}: {twist}");
    }
}

#[test]
fn f8_in_the_plane_opposite_directions_turn_counter_clockwise() {
    for noise in [-1e-17, 0.0, 1e-17] {
        let source = bezier(&[dvec2(0.0, 0.0), dvec2(2.0, 0.0)]);
        let target = bezier(&[dvec2(2.0, 0.0), dvec2(0.0, noise)]);
        let warp = Wires::construct(vec![Wire::new(source, target, 1.0)], None).unwrap();
        let half = warp.scaled(place(0, 0.5), 0.5).linear;
        assert!((Linear::apply(&half, DVec2::X) - DVec2::Y).length() < 1e-12);
    }
}

#[test]
fn f8_a_single_opposite_place_takes_the_limit_from_below() {
    // The target's direction passes the opposite once, turning in the x–y plane.
    let target = |v: f64| {
        let (s, c) = math::sin_cos(core::f64::consts::PI * (0.6 + 0.8 * v));
        dvec3(c, s, 0.0)
    };
    let mut here = Solid::ZERO;
    let mut points = vec![here];
    for i in 0..400 {
        here += target((f64::from(i) + 0.5) / 400.0) / 400.0;
        points.push(here);
    }
    use anamorph_curves::families::{CatmullRom, Generator};
    let curve = CatmullRom::new(points).curve().unwrap();
    let wire = Wire::new(bezier(&[Solid::ZERO, Solid::X]), Arc::new(curve), 1.0);
    let warp = Wires::construct(vec![wire], None).unwrap();
    for v in [0.499_999, 0.5] {
        let half = rotation(&warp, v, 0.5);
        assert!((half * Solid::X - Solid::Y).length() < 1e-4, "{v}: {half}");
    }
    let half = rotation(&warp, 0.500_01, 0.5);
    assert!((half * Solid::X + Solid::Y).length() < 1e-3);
}

#[test]
fn f8_where_a_tangent_vanishes_it_is_the_limit() {
    // A cusp at the middle: the direction is that of the larger parameter. At the end of a resting curve, of the smaller.
    let cusp = [
        dvec2(0.0, 0.0),
        dvec2(1.0, 1.0),
        dvec2(0.0, 1.0),
        dvec2(1.0, 0.0),
    ];
    let source = bezier(&cusp);
    assert!(source.velocity(0.5).length() < 1e-12);
    let line = bezier(&[dvec2(0.0, 0.0), dvec2(1.0, 0.0)]);
    let warp = Wires::construct(vec![Wire::new(source.clone(), line.clone(), 1.0)], None).unwrap();
    let angle = |v: f64| {
        let m = warp.scaled(place(0, v), 1.0).linear;
        math::atan2(m.x_axis.y, m.x_axis.x)
    };
    let limit = source.velocity(0.5 + 1e-6);
    let expected = -math::atan2(limit.y, limit.x);
    assert!(
        (angle(0.5) - expected).abs() < 1e-5,
        "{} {expected}",
        angle(0.5)
    );
    let rests = bezier(&[dvec2(0.0, 0.0), dvec2(1.0, 1.0), dvec2(1.0, 1.0)]);
    let warp = Wires::construct(vec![Wire::new(rests, line.clone(), 1.0)], None).unwrap();
    let m = warp.scaled(place(0, 1.0), 1.0).linear;
    assert!((math::atan2(m.x_axis.y, m.x_axis.x) + core::f64::consts::FRAC_PI_4).abs() < 1e-12);
    // Three derivatives that vanish.
    let slow = bezier(&[
        dvec2(0.0, 0.0),
        dvec2(0.0, 0.0),
        dvec2(0.0, 0.0),
        dvec2(0.0, 0.0),
        dvec2(0.0, 1.0),
    ]);
    let warp = Wires::construct(vec![Wire::new(slow, line.clone(), 1.0)], None).unwrap();
    let m = warp.scaled(place(0, 0.0), 1.0).linear;
    assert!((math::atan2(m.x_axis.y, m.x_axis.x) + core::f64::consts::FRAC_PI_2).abs() < 1e-6);
    // A curve that is a point has no direction, and nothing turns.
    let point = bezier(&[dvec2(1.0, 1.0), dvec2(1.0, 1.0)]);
    let warp = Wires::construct(vec![Wire::new(point, line, 1.0)], None).unwrap();
    let m = warp.scaled(place(0, 0.5), 1.0);
    assert_eq!(m.linear, anamorph_core::glam::DMat2::IDENTITY);
}

fn wire(y: f64, target: f64, radius: f64, exponent: f64) -> Wire<Plane> {
    let line = |y: f64| bezier(&[dvec2(0.0, y), dvec2(4.0, y)]);
    let mut wire = Wire::new(line(y), line(target), radius);
    wire.exponent = exponent;
    wire
}

#[test]
fn f9_wires_out_of_reach_take_no_part() {
    // With m = 0 a wire out of reach would halve the other.
    let warp = Wires::construct(
        vec![wire(0.0, 1.0, 1.0, 0.0), wire(9.0, 9.0, 1.0, 0.0)],
        None,
    );
    let warp = warp.unwrap();
    assert_eq!(at(&warp, dvec2(2.0, 0.0)), dvec2(2.0, 1.0));
    let mut list = Influences::default();
    warp.influences(&Site::anywhere(dvec2(2.0, 0.0)), &mut list);
    assert_eq!(list.list.len(), 1);
    // Nor does one whose strength a field takes away.
    let all = Wires::construct(vec![wire(0.0, 1.0, 1.0, -1.0)], None).unwrap();
    let none = Modulated::new(Box::new(all)).with_strength(Box::new(0.0));
    assert_eq!(at(&none, dvec2(2.0, 0.0)), dvec2(2.0, 0.0));
}

#[test]
fn f9_an_unmoved_wire_pins_nothing_unless_its_exponent_is_negative() {
    let build = |exponent: f64| {
        let wires = vec![wire(0.0, 1.0, 1.0, exponent), wire(0.2, 0.2, 1.0, exponent)];
        Wires::construct(wires, None).unwrap()
    };
    let p = dvec2(2.0, 0.2);
    let lone = p.y + Hat.value(0.2);
    assert!((at(&build(1.0), p).y - lone).abs() < 1e-15);
    assert!((at(&build(0.5), p).y - lone).abs() < 1e-15);
    assert!((at(&build(0.0), p).y - 0.5 * (p.y + lone)).abs() < 1e-15);
    for exponent in [-0.5, -1.0, -3.0] {
        assert_eq!(at(&build(exponent), p), p);
    }
}

#[test]
fn f9_weights_are_powers_of_the_displacement() {
    let p = dvec2(2.0, 0.0);
    for (m1, m2) in [(1.0, 1.0), (2.0, 0.5), (-1.0, 1.0), (0.0, 3.0)] {
        let warp = Wires::construct(
            vec![wire(0.0, 0.8, 1.0, m1), wire(0.0, -0.3, 2.0, m2)],
            None,
        );
        let (w1, w2) = (math::pow(0.8, m1), math::pow(0.3, m2));
        let expected = (0.8 * w1 - 0.3 * w2) / (w1 + w2);
        assert!(
            (at(&warp.unwrap(), p).y - expected).abs() < 1e-14,
            "{m1}, {m2}"
        );
    }
}

#[test]
fn f10_the_smallest_of_equally_near_parameters_is_taken() {
    // The centre of an arc is equally far from all of it; the middle of a zigzag from two places.
    let mut random = Random::new(10);
    let v = [dvec2(-1.0, 1.0), dvec2(0.0, -1.0), dvec2(1.0, 1.0)];
    let curve = bezier(&v);
    for _ in 0..50 {
        let p = dvec2(0.0, random.between(0.6, 3.0));
        let mut list = Influences::default();
        let target = bezier(&[dvec2(0.0, 0.0), dvec2(0.0, 1.0)]);
        let warp = Wires::construct(vec![Wire::new(curve.clone(), target, 5.0)], None).unwrap();
        warp.influences(&Site::anywhere(p), &mut list);
        let v = list.list[0].address.at;
        assert!(v < 0.5, "{p:?}: {v}");
        // And it is a nearest one.
        let least = (0..=100_000)
            .map(|i| curve.point(f64::from(i) / 1e5).distance(p))
            .fold(f64::INFINITY, f64::min);
        assert!(curve.point(v).distance(p) <= least + 1e-9 * 4.0);
    }
}

#[test]
fn f17_the_nearest_place_is_no_limit_of_uniform_nodes() {
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
    let p = dvec2(-0.3, 0.4);
    let build = |sampling| {
        let wire = Wire::new(bezier(&source), bezier(&target), 3.0);
        ContinuousWires::construct(vec![wire], sampling, None).unwrap()
    };
    let nearest = at(&build(Sampling::Nearest), p);
    let plain = Wires::construct(vec![Wire::new(bezier(&source), bezier(&target), 3.0)], None);
    assert!(nearest.distance(at(&plain.unwrap(), p)) < 1e-12);
    let dense: Vec<Plane> = [1000, 10_000]
        .map(|n| at(&build(Sampling::Uniform(n)), p))
        .to_vec();
    assert!(dense[0].distance(dense[1]) < 1e-6);
    assert!(nearest.distance(dense[1]) > 0.05);
}

#[test]
fn f17_the_measure_is_arc_length() {
    // One line run evenly, and the same run four times as fast at its end: the integral by the parameter would differ.
    let even = || bezier(&[dvec2(0.0, 0.0), dvec2(2.0, 0.0), dvec2(4.0, 0.0)]);
    let hurried = || bezier(&[dvec2(0.0, 0.0), dvec2(0.8, 0.0), dvec2(4.0, 0.0)]);
    let lifted =
        |points: &[Plane]| bezier(&points.iter().map(|p| dvec2(p.x, 1.0)).collect::<Vec<_>>());
    let a = Wire::new(
        even(),
        lifted(&[dvec2(0.0, 0.0), dvec2(2.0, 0.0), dvec2(4.0, 0.0)]),
        1.5,
    );
    let b = Wire::new(
        hurried(),
        lifted(&[dvec2(0.0, 0.0), dvec2(0.8, 0.0), dvec2(4.0, 0.0)]),
        1.5,
    );
    for sampling in [
        Sampling::Uniform(11),
        Sampling::GaussLegendre(6),
        Sampling::Adaptive(1e-10),
    ] {
        let [a, b] =
            [&a, &b].map(|w| ContinuousWires::construct(vec![w.clone()], sampling, None).unwrap());
        for i in 0..40 {
            let p = dvec2(0.1 * f64::from(i), 0.3);
            assert!(at(&a, p).distance(at(&b, p)) < 1e-9, "{sampling:?} {p:?}");
        }
    }
}
