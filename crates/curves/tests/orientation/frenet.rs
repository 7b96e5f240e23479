//! Frenet frames and their repairs.

use crate::paths::*;
use anamorph_core::Curve;
use anamorph_core::glam::{DVec3, dvec3};
use anamorph_curves::families::{CubicBezier, Generator};
use anamorph_curves::orientation::{Flips, Frame, Frenet, FrenetUp, Orienter};
use anamorph_curves::{ArcLength, Curvature};
use core::f64::consts::FRAC_PI_2;

#[test]
fn frenet_flips_at_inflections_only_as_printed() {
    // The inflection is at ½, where neither the second derivative nor the cross product has a direction.
    let curve = s_curve();
    assert!(curve.curvature(0.5).unwrap() < 1e-12);
    for axis in [FrenetUp::Normal, FrenetUp::Binormal] {
        let repaired = Frenet {
            axis,
            ..Frenet::default()
        }
        .along(&curve)
        .unwrap();
        let list = repaired.frames(&even(&curve, 1000));
        for pair in list.windows(2) {
            assert!(close(&pair[0], &pair[1]) < 0.02);
        }
        let printed = Frenet {
            axis,
            flips: Flips::AsPrinted,
            ..Frenet::default()
        }
        .along(&curve)
        .unwrap();
        let list = printed.frames(&even(&curve, 1001));
        let flips: Vec<f64> = list
            .windows(2)
            .map(|p| close(&p[0], &p[1]))
            .filter(|d| *d > 0.02)
            .collect();
        assert_eq!(flips.len(), 1);
        assert!((flips[0] - 2.0).abs() < 1e-6);
    }
    // As printed, up is towards the centre of curvature on both sides.
    let printed = Frenet {
        flips: Flips::AsPrinted,
        ..Frenet::default()
    }
    .along(&curve)
    .unwrap();
    for u in [0.1, 0.4, 0.6, 0.9] {
        assert!(
            printed
                .frame(u)
                .up()
                .dot(curve.curvature_vector(u).unwrap())
                > 0.0
        );
    }
    // Two inflections within one cell of the search: both are found.
    let near = bezier(&[
        [0., 0., 0.],
        [1., 0., 0.499],
        [0.5, 0., -0.24],
        [1.5, 0., 0.26],
    ]);
    let undefined = Frenet::default().along(&near).unwrap();
    for pair in undefined.frames(&even(&near, 20000)).windows(2) {
        assert!(pair[0].up().dot(pair[1].up()) > 0.9);
    }
}

#[test]
fn frenet_is_interpolated_over_straight_stretches() {
    // Turns in the plane y = 0, goes straight, turns in the plane x = 0 (seen along the common w = z), speeds up on its way.
    let first = [[-1., 0., 0.], [-0.5, 0., 0.], [0., 0., 0.5], [0., 0., 1.]];
    let line = [[0., 0., 1.5], [0., 0., 2.], [0., 0., 4.]];
    let second = [[0., 0., 4.5], [0., 0.5, 5.], [0., 1., 5.]];
    let curve = bezier(&[first.to_vec(), line.to_vec(), second.to_vec()].concat());
    let frenet = Frenet::default().along(&curve).unwrap();
    let gaps: Vec<(f64, f64)> = frenet.undefined().collect();
    assert_eq!(gaps.len(), 1, "{gaps:?}");
    assert!(
        (gaps[0].0 - 1.0).abs() < 1e-6 && (gaps[0].1 - 2.0).abs() < 1e-6,
        "{gaps:?}"
    );
    let (before, after) = (frenet.frame(1.0 - 1e-6), frenet.frame(2.0 + 1e-6));
    assert!(
        (before.up() - dvec3(-1.0, 0.0, 0.0)).length() < 1e-5,
        "{before:?}"
    );
    // Of the two normals the nearer one is taken; here both are a quarter turn away.
    assert!((after.up().y.abs() - 1.0).abs() < 1e-5, "{after:?}");
    let whole = before.twist_to(&after);
    assert!((whole.abs() - FRAC_PI_2).abs() < 1e-5);
    let length = curve.length_between(1.0, 2.0, 1e-12);
    for u in [1.01, 1.2, 1.5, 1.8, 1.99] {
        let share = curve.length_between(1.0, u, 1e-12) / length;
        let turned = before.twist_to(&frenet.frame(u));
        assert!((turned - whole * share).abs() < 1e-5, "at {u}");
        assert!((frenet.frame(u).forward() - DVec3::Z).length() < 1e-12);
    }
}

#[test]
fn frenet_on_straight_paths_and_at_their_ends() {
    let line = polyline(&[[0., 0., 0.], [1., 0., 0.], [3., 0., 0.]], false);
    let frenet = Frenet::default().along(&line).unwrap();
    for u in [0.0, 0.3, 1.0, 2.0] {
        assert_eq!(frenet.frame(u), Frame::level(DVec3::X, DVec3::Y));
    }
    // A curve between two straight stretches: they keep the frames of its ends.
    let curve = bezier(&[
        [-3., 0., 0.],
        [-2., 0., 0.],
        [-1., 0., 0.],
        [0., 0., 0.],
        [0.5, 0., 0.],
        [1., 0., 0.5],
        [1., 0., 1.],
        [1., 0., 2.],
        [1., 0., 3.],
        [1., 0., 4.],
    ]);
    let frenet = Frenet::default().along(&curve).unwrap();
    for u in [0.0, 0.5, 0.99] {
        assert!((frenet.frame(u).up() - DVec3::Z).length() < 1e-6);
        assert!((frenet.frame(3.0 - u).up() + DVec3::X).length() < 1e-6);
    }
}

#[test]
fn frenet_closes_over_a_straight_start() {
    // A stadium whose start lies on a straight side, out of plane so that frames turn on it.
    let points: Vec<DVec3> = vec![
        dvec3(0., 0., 0.),
        dvec3(1., 0., 0.),
        dvec3(2., 0., 0.),
        dvec3(3., 0., 0.),
        dvec3(4., 0., 0.),
        dvec3(4., 1., 1.5),
        dvec3(4., 2., 2.),
        dvec3(0., 4., 2.),
        dvec3(-2., 3., 1.),
        dvec3(-4., 2., 0.),
        dvec3(-4., 0., 0.),
        dvec3(-2., 0., 0.),
    ];
    let curve = CubicBezier {
        points,
        closed: true,
    }
    .curve()
    .unwrap();
    let frenet = Frenet {
        flips: Flips::AsPrinted,
        ..Frenet::default()
    }
    .along(&curve)
    .unwrap();
    let (a, b) = curve.domain();
    let before = frenet.frame(b - 1e-9);
    assert!(
        close(&before, &frenet.frame(a)) < 1e-6,
        "{before:?} {:?}",
        frenet.frame(a)
    );
    assert_eq!(frenet.frame(a), frenet.frame(b));
    // At the other end of the straight side, too.
    let end = frenet.undefined().next().unwrap().1;
    assert!(close(&frenet.frame(end - 1e-7), &frenet.frame(end + 1e-7)) < 1e-4);
}
