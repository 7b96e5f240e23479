//! Rotation-minimizing frames: accuracy, closing, pinned ends, cusps.

use crate::paths::*;
use anamorph_core::Curve;
use anamorph_core::glam::{DVec3, dvec3};
use anamorph_curves::families::{CatmullRom, Generator};
use anamorph_curves::orientation::{End, Frame, Frenet, Orienter, RotationMinimizing, UpdatedUp};
use anamorph_curves::{ArcLength, Torsion};
use core::f64::consts::{PI, TAU};

#[test]
fn on_a_helix_the_twist_against_frenet_is_minus_the_torsion() {
    for (r, h) in [(1.0, 0.3), (2.0, -1.5), (0.1, 4.0), (5.0, 0.01)] {
        let helix = Helix { r, h, turns: 3.0 };
        let minimizing = RotationMinimizing::default().along(&helix).unwrap();
        let frenet = Frenet::default().along(&helix).unwrap();
        assert!(minimizing.is_complete());
        let start = frenet.frame(0.0).twist_to(&minimizing.frame(0.0));
        let mut twist = 0.0;
        let mut before = start;
        for u in even(&helix, 600).into_iter().skip(1) {
            let now = frenet.frame(u).twist_to(&minimizing.frame(u));
            twist += (now - before + PI).rem_euclid(TAU) - PI;
            before = now;
            let length = r.hypot(h) * u;
            let torsion = helix.torsion(u).unwrap();
            assert!((torsion - h / (r * r + h * h)).abs() < 1e-12);
            let off = (twist + torsion * length).abs();
            assert!(off < 2e-9, "r {r}, h {h}, at {u}: {off:e}");
        }
    }
}

#[test]
fn the_accuracy_asked_for_is_honoured() {
    let mut curves = hard();
    curves.push((
        "wide loops",
        CatmullRom::new(
            (0..40)
                .map(|i| {
                    let t = f64::from(i) * 1.9;
                    dvec3(t.sin(), (1.7 * t).cos(), 0.05 * t)
                })
                .collect(),
        )
        .curve()
        .unwrap(),
    ));
    for (name, curve) in curves {
        if name == "near cusp" || name == "far away" {
            // Directions there are known to a few digits.
            continue;
        }
        let with = |accuracy| {
            RotationMinimizing {
                accuracy,
                end: End::Free,
                ..RotationMinimizing::default()
            }
            .along(&curve)
            .unwrap()
        };
        let exact = with(1e-13);
        assert!(exact.is_complete(), "{name}");
        for accuracy in [1e-2, 1e-4, 1e-6, 1e-9] {
            let frames = with(accuracy);
            for u in even(&curve, 97) {
                let off = exact.twist_of(u, &frames.frame(u)).abs();
                assert!(off <= accuracy, "{name} at {u}: {off:e}, not {accuracy:e}");
            }
        }
    }
}

#[test]
fn coarse_samples_are_as_good_as_fine_ones() {
    let curve = trefoil();
    let frames = RotationMinimizing::default().along(&curve).unwrap();
    let fine = frames.frames(&even(&curve, 1000));
    let coarse = frames.frames(&even(&curve, 4));
    for (i, frame) in coarse.iter().enumerate() {
        assert_eq!(*frame, fine[250 * i]);
    }
}

#[test]
fn backwards_the_up_axes_are_the_same() {
    for (name, curve) in hard() {
        if [
            "far away",
            "near cusp",
            "rests",
            "repeated points",
            "stops at its ends",
        ]
        .contains(&name)
        {
            continue;
        }
        let free = RotationMinimizing {
            end: End::Free,
            ..RotationMinimizing::default()
        };
        let there = free.along(&curve).unwrap();
        let (a, b) = curve.domain();
        // The frame that arrives: a closed path with a corner where it starts turns there.
        let last = there.frame(b.next_down());
        let back_curve = curve.reversed();
        let back = RotationMinimizing {
            up: last.up(),
            ..free
        }
        .along(&back_curve)
        .unwrap();
        // Off the corners, where the frame is that of the piece behind.
        for i in 1..50 {
            let u = a + (b - a) * (f64::from(i) + 0.013) / 50.0;
            let (x, y) = (there.frame(u), back.frame(a + (b - u)));
            let off = (x.up() - y.up()).length();
            assert!(off < 1e-7, "{name} at {u}: {off:e}");
            assert!((x.forward() + y.forward()).length() < 1e-7, "{name} at {u}");
        }
    }
}

#[test]
fn the_leftover_of_a_closed_path_is_the_area_its_directions_enclose() {
    // Gauss and Bonnet: three right angles round a corner of a cube enclose an eighth of the sphere, π/2.
    let curve = polyline(
        &[
            [0., 0., 0.],
            [1., 0., 0.],
            [1., 1., 0.],
            [1., 1., 1.],
            [0., 0., 1.],
            [0., 0., 0.],
        ],
        true,
    );
    let free = RotationMinimizing {
        end: End::Free,
        ..RotationMinimizing::default()
    };
    let leftover = free.along(&curve).unwrap().leftover().unwrap();
    // Directions: x, y, z, (−1, −1, 0)/√2, −z and back to x.
    let list = [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        dvec3(-1., -1., 0.).normalize(),
        DVec3::NEG_Z,
    ];
    let mut area = 0.0;
    for pair in list[1..].windows(2) {
        // The triangle with the first (Van Oosterom and Strackee 1983).
        let (a, b, c) = (list[0], pair[0], pair[1]);
        let below = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
        area += 2.0 * a.dot(b.cross(c)).atan2(below);
    }
    let off = (leftover - area + PI).rem_euclid(TAU) - PI;
    assert!(off.abs() < 1e-12, "{leftover} {area}");
}

#[test]
fn pinned_ends_are_met_and_the_difference_is_spread() {
    let curve = space_curve();
    let wanted = dvec3(-0.2, 0.1, -1.0);
    let settings = RotationMinimizing {
        end: End::Up(wanted),
        turns: 1,
        up: DVec3::Z,
        ..RotationMinimizing::default()
    };
    let frames = settings.along(&curve).unwrap();
    let free = RotationMinimizing {
        end: End::Free,
        turns: 0,
        ..settings
    }
    .along(&curve)
    .unwrap();
    assert_eq!(frames.frame(0.0), free.frame(0.0));
    let last = frames.frame(1.0);
    assert!(close(&last, &Frame::level(last.forward(), wanted)) < 1e-12);
    let length = curve.length(1e-12);
    for u in even(&curve, 20) {
        let share = curve.length_between(0.0, u, 1e-12) / length;
        let expected = free.frame(u).rolled(frames.added_twist() * share);
        assert!(close(&frames.frame(u), &expected) < 1e-9);
    }
    assert!(frames.added_twist() > PI && frames.added_twist() < 3.0 * PI);
}

#[test]
fn cusps_keep_the_up_axis_and_corners_turn_least() {
    let cusp = bezier(&[[0., 0., 0.], [2., 2., 0.], [0., 2., 0.], [2., 0., 0.]]);
    for up in [DVec3::Y, DVec3::Z, dvec3(1.0, 2.0, 3.0)] {
        let frames = RotationMinimizing {
            up,
            ..RotationMinimizing::default()
        }
        .along(&cusp)
        .unwrap();
        for h in [1e-3, 1e-5, 1e-7] {
            let (before, after) = (frames.frame(0.5 - h), frames.frame(0.5 + h));
            assert!((before.forward() + after.forward()).length() < 10.0 * h);
            assert!(
                (before.up() - after.up()).length() < 10.0 * h,
                "{h}: {before:?} {after:?}"
            );
        }
    }
    let corner = polyline(
        &[[0., 0., 0.], [1., 0., 0.], [1., 0., 1.], [1., 2., 1.]],
        false,
    );
    let frames = RotationMinimizing::default().along(&corner).unwrap();
    let list = [0.5, 1.0, 1.5, 2.0, 3.0].map(|u| frames.frame(u));
    assert_eq!(list[0], Frame::new(DVec3::X, DVec3::Y).unwrap());
    assert_eq!(list[1], Frame::new(DVec3::Z, DVec3::Y).unwrap());
    assert_eq!(list[1], list[2]);
    // From z to y by the smallest rotation: what was up, y, is now behind.
    assert!(close(&list[3], &Frame::new(DVec3::Y, DVec3::NEG_Z).unwrap()) < 1e-15);
    assert_eq!(list[3], list[4]);
}

#[test]
fn updated_up_becomes_rotation_minimizing() {
    let curve = space_curve();
    let minimizing = RotationMinimizing {
        up: DVec3::Z,
        ..RotationMinimizing::default()
    }
    .along(&curve)
    .unwrap();
    let updated = UpdatedUp::along(&curve, DVec3::Z).unwrap();
    let off = |count| {
        let last = updated.frames(&even(&curve, count)).pop().unwrap();
        minimizing.twist_of(1.0, &last).abs()
    };
    let (coarse, fine) = (off(200), off(400));
    assert!(
        fine < 0.01 && (1.9..2.1).contains(&(coarse / fine)),
        "{coarse:e} {fine:e}"
    );
}

#[test]
fn a_million_frames_need_no_memory_but_theirs() {
    let curve = trefoil();
    let frames = RotationMinimizing::default().along(&curve).unwrap();
    assert!(frames.steps() < 10_000, "{}", frames.steps());
    let (a, b) = curve.domain();
    let count = 1_000_000_u32;
    let (mut seen, mut sum) = (0_u32, 0.0);
    let mut all = (0..count).map(|i| a + (b - a) * f64::from(i) / f64::from(count));
    frames.stream(&mut all, &mut |frame| {
        seen += 1;
        sum += frame.up().dot(frame.forward()).abs();
    });
    assert_eq!(seen, count);
    assert!(sum / f64::from(count) < 1e-15);
}
