//! Leaning into turns.

use crate::paths::*;
use anamorph_core::Curve;
use anamorph_core::glam::{DVec3, dvec3};
use anamorph_curves::LengthTable;
use anamorph_curves::orientation::{
    Banking, FixedUp, OrientationError, Orienter, RotationMinimizing, Speed,
};
use core::f64::consts::FRAC_PI_3;
use std::sync::Arc;

#[test]
fn banking_leans_into_turns() {
    // Seen from above (y up), this circle of radius 3 goes from z to x: to the left.
    let ring = around(64, |t| dvec3(t.sin(), 0.0, t.cos()) * 3.0);
    let (speed, gravity) = (4.0, 9.81);
    let banking = Banking {
        speed: Speed::Constant(speed),
        gravity,
        ..Banking::default()
    };
    for (path, left) in [(ring.clone(), 1.0), (ring.reversed(), -1.0)] {
        let base = FixedUp::along(&path, DVec3::Y).unwrap();
        let banked = banking.of(base.clone(), &path).unwrap();
        let expected = (speed * speed / 3.0 / gravity).atan();
        for u in even(&path, 40) {
            let frame = banked.frame(u);
            assert!((banked.lean(&base.frame(u), u) - left * expected).abs() < 1e-2);
            // The head is inside.
            assert!(frame.up().dot(-path.point(u)) > 0.5);
            assert!((frame.forward() - base.frame(u).forward()).length() < 1e-12);
        }
        // Gains lean less, or out; the limit holds.
        let with = |gain, limit| {
            Banking {
                gain,
                limit,
                ..banking.clone()
            }
            .of(base.clone(), &path)
            .unwrap()
            .lean(&base.frame(1.0), 1.0)
        };
        assert!(with(0.5, FRAC_PI_3).abs() < expected);
        assert!(with(-1.0, FRAC_PI_3) * left < 0.0);
        assert!((with(100.0, 0.2) - 0.2 * left).abs() < 1e-15);
        // Speeds may depend on the place.
        let slow = Banking {
            speed: Speed::At(Arc::new(|_| 0.0)),
            ..banking.clone()
        };
        assert_eq!(
            slow.of(base.clone(), &path).unwrap().frame(1.0),
            base.frame(1.0)
        );
    }
}

#[test]
fn banking_is_smoothed_over_a_length() {
    // A road: straight, then a turn to the left (seen from above, from z to x), then straight. Its curvature jumps.
    let k = 0.5522847498;
    let road = bezier(&[
        [0., 0., 0.],
        [0., 0., 1.],
        [0., 0., 2.],
        [0., 0., 3.],
        [0., 0., 3. + k],
        [1. - k, 0., 4.],
        [1., 0., 4.],
        [2., 0., 4.],
        [3., 0., 4.],
        [4., 0., 4.],
    ]);
    let base = FixedUp::along(&road, DVec3::Y).unwrap();
    let lean = |smoothing: f64| {
        let banking = Banking {
            speed: Speed::Constant(2.0),
            smoothing,
            ..Banking::default()
        };
        let banked = banking.of(&base, &road).unwrap();
        let table = LengthTable::new(&road, 1e-10).unwrap();
        table
            .even_parameters(2001)
            .iter()
            .map(|u| banked.lean(&base.frame(*u), *u))
            .collect::<Vec<f64>>()
    };
    let (sharp, smooth) = (lean(0.0), lean(0.8));
    let jump = |list: &[f64]| {
        list.windows(2)
            .map(|p| (p[1] - p[0]).abs())
            .fold(0.0, f64::max)
    };
    assert!(jump(&sharp) > 0.3, "{}", jump(&sharp));
    assert!(jump(&smooth) < 0.005, "{}", jump(&smooth));
    // Averages keep the sum, and nothing is beyond what was there.
    let sum = |list: &[f64]| list.iter().sum::<f64>();
    assert!((sum(&sharp) / sum(&smooth) - 1.0).abs() < 0.01);
    assert!(
        smooth.iter().all(|l| (-1e-3..0.45).contains(l)),
        "leans to the left"
    );
    // Further from the turn than the half-width, nothing leans.
    assert!(smooth[..550].iter().all(|l| l.abs() < 1e-12));
    for wrong in [
        Banking {
            gravity: 0.0,
            ..Banking::default()
        },
        Banking {
            limit: 2.0,
            ..Banking::default()
        },
        Banking {
            smoothing: f64::NAN,
            ..Banking::default()
        },
        Banking {
            gain: f64::INFINITY,
            ..Banking::default()
        },
        Banking {
            speed: Speed::Constant(-1.0),
            ..Banking::default()
        },
    ] {
        assert!(matches!(
            wrong.of(&base, &road),
            Err(OrientationError::OutOfRange { .. })
        ));
    }
}

#[test]
fn vertical_loops_do_not_lean() {
    let ring = around(64, |t| dvec3(0.0, t.sin(), t.cos()) * 3.0);
    let base = RotationMinimizing {
        up: DVec3::X.cross(DVec3::Y),
        ..RotationMinimizing::default()
    }
    .along(&ring)
    .unwrap();
    let banked = Banking {
        speed: Speed::Constant(5.0),
        ..Banking::default()
    }
    .of(&base, &ring)
    .unwrap();
    for u in even(&ring, 50) {
        assert!(banked.lean(&base.frame(u), u).abs() < 1e-9, "{u}");
        assert!(close(&banked.frame(u), &base.frame(u)) < 1e-9);
    }
}
