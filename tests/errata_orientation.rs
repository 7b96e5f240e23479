//! Rows of the errata on orientation, pinned by name.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::glam::{DMat3, DVec3, dvec3};
use anamorph_core::{Curve, Differentiable, Solid};
use anamorph_curves::families::{BSpline, CatmullRom, CubicBezier, Generator, Knots};
use anamorph_curves::orientation::registry::ORIENTATIONS;
use anamorph_curves::orientation::{
    Frame, Frenet, LookAt, Orienter, RotationMinimizing, UpdatedUp, heading,
};
use anamorph_curves::{LengthTable, PiecewiseCubic};

fn bezier(points: [DVec3; 4]) -> PiecewiseCubic<Solid> {
    let points = points.to_vec();
    let closed = false;
    CubicBezier { points, closed }.curve().unwrap()
}

fn polyline(points: &[DVec3]) -> PiecewiseCubic<Solid> {
    let spline = BSpline {
        points: points.to_vec(),
        degree: 1,
        knots: Knots::Clamped,
        closed: false,
    };
    spline.curve().unwrap()
}

fn space() -> PiecewiseCubic<Solid> {
    bezier([
        DVec3::ZERO,
        dvec3(2.0, 2.0, 0.3),
        dvec3(1.0, -2.0, 1.0),
        dvec3(3.0, 0.0, 0.5),
    ])
}

/// C10: `u = v_old × w`, `v = w × u`. The slides' `u = w × v_old`, `v = u × w` is left-handed.
#[test]
fn c10_updated_up_is_right_handed() {
    let curve = space();
    let samples: Vec<f64> = (0..=40).map(|i| f64::from(i) / 40.0).collect();
    let frames = UpdatedUp::along(&curve, DVec3::Y).unwrap().frames(&samples);
    for (pair, u) in frames.windows(2).zip(&samples[1..]) {
        let w = curve.velocity(*u).normalize();
        let side = pair[0].up().cross(w).normalize();
        assert!((pair[1].side() - side).length() < 1e-14);
        assert!((pair[1].up() - w.cross(side)).length() < 1e-14);
        assert!((pair[1].to_matrix().determinant() - 1.0).abs() < 1e-14);
        // As printed, with the same up axis: a mirror.
        let printed = w.cross(pair[0].up()).normalize();
        let mirror = DMat3::from_cols(printed, printed.cross(w), w);
        assert!((mirror.determinant() + 1.0).abs() < 1e-14);
    }
}

/// C10: a direction parallel to the last up axis keeps the last frame.
#[test]
fn c10_a_direction_along_the_last_up_axis_keeps_the_frame() {
    // Along x, then straight up, then back along −x.
    let path = polyline(&[
        DVec3::ZERO,
        DVec3::X,
        dvec3(1.0, 2.0, 0.0),
        dvec3(-1.0, 2.0, 0.0),
    ]);
    let frames = UpdatedUp::along(&path, DVec3::Y)
        .unwrap()
        .frames(&[0.5, 1.5, 1.7, 2.5]);
    let level = Frame::new(DVec3::X, DVec3::Y).unwrap();
    assert_eq!(frames[..3], [level; 3]);
    assert_eq!(frames[3], Frame::new(DVec3::NEG_X, DVec3::Y).unwrap());
}

/// C10: Frenet frames have an answer where the curvature vanishes, and do not flip at inflections.
#[test]
fn c10_frenet_frames_are_repaired() {
    let curve = bezier([
        DVec3::ZERO,
        dvec3(2.0, 0.0, 2.0),
        dvec3(2.0, 0.0, -2.0),
        dvec3(4.0, 0.0, 0.0),
    ]);
    let frenet = Frenet::default().along(&curve).unwrap();
    let (before, at, after) = (frenet.frame(0.499), frenet.frame(0.5), frenet.frame(0.501));
    assert!(before.up().dot(at.up()) > 0.99 && at.up().dot(after.up()) > 0.99);
    // Unrepaired they do: the second derivative changes sides.
    assert!(curve.jet(0.499).second.dot(curve.jet(0.501).second) < 0.0);
}

/// C10: rotation-minimizing frames are the default.
#[test]
fn c10_rotation_minimizing_is_the_default() {
    assert_eq!(ORIENTATIONS[0].name, "rotation-minimizing");
}

/// C14: samples that coincide change nothing, and a closed curve spreads its leftover twist evenly by arc length.
#[test]
fn c14_coincident_samples_are_skipped_and_twist_is_spread() {
    let corners = [DVec3::ZERO, DVec3::X, dvec3(1.0, 1.0, 0.0), DVec3::ONE];
    let (once, again) = (
        polyline(&corners),
        polyline(&[
            corners[0], corners[0], corners[1], corners[1], corners[1], corners[2], corners[3],
            corners[3],
        ]),
    );
    let along = |path: &PiecewiseCubic<Solid>, list: &[f64]| {
        RotationMinimizing::default()
            .along(path)
            .unwrap()
            .frames(list)
    };
    assert_eq!(
        along(&once, &[0.0, 0.5, 1.5, 2.5, 3.0]),
        along(&again, &[0.5, 1.5, 4.5, 5.5, 6.5])
    );
    let points = [
        // Not its own mirror image, whose twist would vanish.
        dvec3(1.0, 0.0, 0.7),
        dvec3(0.0, 2.0, 0.5),
        dvec3(-1.0, 0.0, 0.0),
        dvec3(0.4, -1.0, 1.5),
    ];
    let closed = CatmullRom {
        closed: true,
        ..CatmullRom::new(points.to_vec())
    };
    let closed = closed.curve().unwrap();
    let spread = RotationMinimizing::default().along(&closed).unwrap();
    let twist = spread.added_twist();
    assert!(twist.abs() > 0.01);
    let (start, end) = closed.domain();
    assert_eq!(spread.frame(start), spread.frame(end));
    let free = RotationMinimizing {
        end: anamorph_curves::orientation::End::Free,
        ..RotationMinimizing::default()
    };
    let free = free.along(&closed).unwrap();
    let table = LengthTable::new(&closed, 1e-11).unwrap();
    for i in 0..8 {
        let u = table.parameter(table.length() * f64::from(i) / 8.0);
        let added = free.frame(u).twist_to(&spread.frame(u));
        assert!((added - twist * f64::from(i) / 8.0).abs() < 1e-8);
    }
}

/// C16: a view along the up vector has an answer, that of a tilted head.
#[test]
fn c16_views_along_the_up_vector() {
    let path = polyline(&[DVec3::ZERO, dvec3(0.0, 10.0, 0.0)]);
    let frames = LookAt::along(&path, dvec3(0.0, 4.0, 0.0), DVec3::Y).unwrap();
    let ahead = heading(DVec3::Y);
    assert_eq!(frames.frame(0.1), Frame::new(DVec3::Y, -ahead).unwrap());
    assert_eq!(frames.frame(0.9), Frame::new(DVec3::NEG_Y, ahead).unwrap());
    // Where the target is reached the view is along the path.
    assert_eq!(frames.frame(0.4), Frame::new(DVec3::Y, -ahead).unwrap());
}

/// C16: rotation and view matrix have names of their own, and are inverse.
#[test]
fn c16_rotation_and_view_matrix() {
    let frame = Frame::new(dvec3(1.0, 0.2, -0.4), DVec3::Y).unwrap();
    let eye = dvec3(3.0, 2.0, 1.0);
    let view = frame.view_matrix(eye);
    let camera = frame.camera_to_world();
    for p in [DVec3::X, DVec3::Y, DVec3::Z] {
        assert!((view.transform_point3(eye + camera * p) - p).length() < 1e-14);
    }
    // The camera looks along its negative z.
    assert!((camera * DVec3::NEG_Z - frame.forward()).length() < 1e-15);
}
