//! Frames as rotations and views; looking ahead, at points, along other curves.

use crate::paths::*;
use anamorph_core::glam::{DVec3, DVec4, dvec3};
use anamorph_core::{Curve, Differentiable};
use anamorph_curves::orientation::{
    Auxiliary, Frame, LookAhead, OrientationError, Orienter, Pairing, Role, heading,
};
use anamorph_curves::{ArcLength, LengthTable};
use core::f64::consts::FRAC_PI_2;

#[test]
fn look_ahead_goes_on_straight_or_around() {
    let curve = space_curve();
    let length = curve.length(1e-12);
    let frames = LookAhead::along(&curve, 0.5, DVec3::Y).unwrap();
    // In the middle it is the chord.
    let u = 0.3;
    let s = curve.length_between(0.0, u, 1e-12);
    use anamorph_curves::InverseArcLength;
    let there = curve.point(curve.parameter_at(s + 0.5, 1e-12));
    let chord = (there - curve.point(u)).normalize();
    assert!((frames.frame(u).forward() - chord).length() < 1e-7);
    // At the end, the last direction; a little before, towards a point beyond the end.
    let last = curve.velocity(1.0).normalize();
    assert!((frames.frame(1.0).forward() - last).length() < 1e-12);
    let near = curve.parameter_at(length - 0.2, 1e-12);
    let beyond = curve.point(1.0) + last * 0.3;
    assert!(
        (frames.frame(near).forward() - (beyond - curve.point(near)).normalize()).length() < 1e-7
    );
    // No distance: the limit.
    for distance in [0.0, 1e-12] {
        let none = LookAhead::along(&curve, distance, DVec3::Y).unwrap();
        assert!((none.frame(0.4).forward() - curve.velocity(0.4).normalize()).length() < 1e-12);
    }
    let small = LookAhead::along(&curve, 1e-7, DVec3::Y).unwrap();
    assert!((small.frame(0.4).forward() - curve.velocity(0.4).normalize()).length() < 1e-4);
    // Closed paths go on at their start; a whole round ahead there is nothing to see, and one faces along the path.
    let ring = tilted_circle();
    let round = ring.length(1e-12);
    let (a, b) = ring.domain();
    let frames = LookAhead::along(&ring, 0.25 * round, DVec3::Y).unwrap();
    assert!(close(&frames.frame(a), &frames.frame(b)) < 1e-8);
    let chord = ring.point(a + 0.25 * (b - a)) - ring.point(a);
    assert!((frames.frame(b).forward() - chord.normalize()).length() < 1e-3);
    let whole = LookAhead::along(&ring, round, DVec3::Y).unwrap();
    assert_sound(&whole.frame(3.0), "a round ahead");
    for wrong in [-1.0, f64::NAN, f64::INFINITY] {
        let error = LookAhead::along(&curve, wrong, DVec3::Y).unwrap_err();
        assert!(error.to_string().contains("the distance"), "{error}");
    }
}

#[test]
fn auxiliary_curves_give_direction_or_up() {
    let curve = space_curve();
    let beside = bezier(&[[0., 3., 0.], [1., 4., 2.], [2., 3., 1.], [3., 3., 3.]]);
    for pairing in [Pairing::Parameter, Pairing::Length] {
        let looks = Auxiliary::along(&curve, &beside, Role::Direction, pairing, DVec3::Y).unwrap();
        let stands = Auxiliary::along(&curve, &beside, Role::Up, pairing, DVec3::Y).unwrap();
        for u in even(&curve, 20) {
            let v = match pairing {
                Pairing::Parameter => u,
                Pairing::Length => {
                    let share = curve.length_between(0.0, u, 1e-13) / curve.length(1e-13);
                    LengthTable::new(&beside, 1e-12)
                        .unwrap()
                        .parameter(share * beside.length(1e-13))
                }
            };
            let to = (beside.point(v) - curve.point(u)).normalize();
            assert!((looks.frame(u).forward() - to).length() < 1e-8);
            assert!(
                close(
                    &stands.frame(u),
                    &Frame::new(curve.velocity(u), to).unwrap()
                ) < 1e-8
            );
        }
    }
    // Where the curves meet one faces along the path.
    let same = Auxiliary::along(
        &curve,
        &curve,
        Role::Direction,
        Pairing::Parameter,
        DVec3::Y,
    )
    .unwrap();
    assert!((same.frame(0.3).forward() - curve.velocity(0.3).normalize()).length() < 1e-12);
    let closed = tilted_circle();
    let error = Auxiliary::along(
        &curve,
        &closed,
        Role::Direction,
        Pairing::Parameter,
        DVec3::Y,
    )
    .unwrap_err();
    assert_eq!(
        error,
        OrientationError::Unlike {
            path: "open",
            auxiliary: "closed"
        }
    );
}

#[test]
fn views_along_the_up_vector_have_an_answer() {
    let frame = |w: DVec3| Frame::level(w, DVec3::Y);
    assert_eq!(heading(DVec3::Y), DVec3::Z);
    assert_eq!(frame(DVec3::Y), Frame::new(DVec3::Y, DVec3::NEG_Z).unwrap());
    assert_eq!(
        frame(DVec3::NEG_Y),
        Frame::new(DVec3::NEG_Y, DVec3::Z).unwrap()
    );
    // They are those of someone who tilts a forward view.
    let tilted = frame(dvec3(0.0, 1.0, 1e-8));
    assert!(close(&tilted, &frame(DVec3::Y)) < 1e-7);
    for up in [
        DVec3::X,
        DVec3::Z,
        dvec3(1., 1., 1.),
        dvec3(0.4, 0.01, 0.91),
    ] {
        assert!(heading(up).dot(up).abs() < 1e-15 && heading(up).is_normalized());
        for w in [up, -up, up + dvec3(1e-12, 0.0, 1e-12)] {
            assert_sound(&Frame::level(w, up), "parallel");
        }
    }
    for odd in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
        assert_sound(&Frame::level(odd, DVec3::Y), "odd");
        assert_sound(&Frame::level(DVec3::X, odd), "odd");
        assert_sound(&Frame::default().turned(odd), "odd");
        assert_eq!(Frame::new(odd, DVec3::Y), None);
        assert_eq!(Frame::new(DVec3::X, odd), None);
    }
    assert_eq!(Frame::new(DVec3::X, DVec3::X * -3.0), None);
}

#[test]
fn rotations_and_views_are_inverse() {
    let frame = Frame::new(dvec3(1.0, 2.0, -0.5), dvec3(0.1, 1.0, 0.0)).unwrap();
    let eye = dvec3(3.0, -1.0, 2.0);
    // What is in front of the camera has negative z, what is above it positive y, what is to its right positive x.
    let seen = |p: DVec3| frame.view_matrix(eye).transform_point3(eye + p);
    assert!((seen(frame.forward()) - dvec3(0., 0., -1.)).length() < 1e-14);
    assert!((seen(frame.up()) - DVec3::Y).length() < 1e-14);
    assert!((seen(-frame.side()) - DVec3::X).length() < 1e-14);
    assert!((frame.camera_to_world() * dvec3(0., 0., -1.) - frame.forward()).length() < 1e-14);
    assert!((frame.view_matrix(eye) * DVec4::from((eye, 1.0)) - DVec4::W).length() < 1e-14);
    let q = frame.to_quaternion();
    assert!((q * DVec3::X - frame.side()).length() < 1e-14);
    assert!((q * DVec3::Y - frame.up()).length() < 1e-14);
    assert!((q * DVec3::Z - frame.forward()).length() < 1e-14);
    assert!(close(&Frame::from_quaternion(q), &frame) < 1e-14);
    let camera = frame.camera_quaternion();
    assert!((camera * dvec3(0., 0., -1.) - frame.forward()).length() < 1e-14);
    // Rolling a frame carries its head to its right.
    assert!((frame.rolled(FRAC_PI_2).up() + frame.side()).length() < 1e-15);
    assert!((frame.twist_to(&frame.rolled(2.0)) - 2.0).abs() < 1e-15);
}
