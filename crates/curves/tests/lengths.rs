//! Arc length, its inverse and tables (systems C2; errata C11, C13).

#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use anamorph_core::glam::{DVec2, DVec3, dvec2, dvec3};
use anamorph_curves::arc_length::methods::methods;
use anamorph_curves::arc_length::{closed, cubic_lengths, cubic_parameter_at, cubic_parameters_at};
use anamorph_curves::families::{CatmullRom, CubicBezier, Generator, Lagrange, Spacing};
use anamorph_curves::{
    ArcLength, Bezier, Cubic, InverseArcLength, LengthTable, PiecewiseBezier, PiecewiseCubic,
};
use common::{Random, exact_length, hard, slanted};

fn solid(points: &[DVec2; 4]) -> [DVec3; 4] {
    points.map(|p| dvec3(p.x, p.y, 0.0))
}

#[test]
fn lengths_keep_their_accuracy_on_all_hard_cubics() {
    let curves = hard();
    let exact: Vec<f64> = curves.iter().map(|c| exact_length(&solid(c))).collect();
    let space: Vec<[DVec3; 4]> = curves.iter().map(|c| c.map(slanted)).collect();
    let (mut plane_found, mut space_found) = (Vec::new(), Vec::new());
    for accuracy in [1e-2, 1e-4, 1e-6, 1e-9, 1e-12] {
        cubic_lengths(&curves, accuracy, &mut plane_found);
        cubic_lengths(&space, accuracy, &mut space_found);
        for (i, e) in exact.iter().enumerate() {
            // The exact value is known to about 2e-13.
            let allowed = accuracy.max(5e-13);
            assert!(
                (plane_found[i] - e).abs() <= allowed,
                "{accuracy:e} {i} {:?}: {} {e}",
                curves[i],
                plane_found[i]
            );
            assert!(
                (space_found[i] - e).abs() <= allowed,
                "{accuracy:e} {i} {:?}: {} {e}",
                curves[i],
                space_found[i]
            );
        }
    }
}

#[test]
fn lengths_keep_their_accuracy_on_random_cubics_of_space() {
    let mut random = Random(11);
    let curves: Vec<[DVec3; 4]> = (0..3000)
        .map(|i| {
            let flat = if i % 3 == 0 { 1e-7 } else { 1.0 };
            core::array::from_fn(|_| random.solid() * dvec3(1.0, 1.0, flat))
        })
        .collect();
    let mut found = Vec::new();
    for accuracy in [1e-3, 1e-6, 1e-9, 1e-12] {
        cubic_lengths(&curves, accuracy, &mut found);
        for (curve, length) in curves.iter().zip(&found) {
            let exact = exact_length(curve);
            assert!(
                (length - exact).abs() <= accuracy.max(5e-13),
                "{accuracy:e} {curve:?}: {length} {exact}"
            );
        }
    }
}

#[test]
fn one_and_many_agree_bit_for_bit() {
    let curves = hard();
    let mut all = Vec::new();
    cubic_lengths(&curves, 1e-9, &mut all);
    for (curve, together) in curves.iter().zip(&all) {
        let mut alone = Vec::new();
        cubic_lengths(&[*curve], 1e-9, &mut alone);
        assert_eq!(alone[0].to_bits(), together.to_bits());
    }
}

#[test]
fn lengths_scale_with_the_curve() {
    let curve = [
        dvec2(0.0, 0.0),
        dvec2(1.0, 2.0),
        dvec2(-1.0, 2.5),
        dvec2(3.0, 0.5),
    ];
    let mut found = Vec::new();
    cubic_lengths(&[curve], 1e-12, &mut found);
    let one = found[0];
    for scale in [1e-150, 1e-30, 1e30, 1e150, 1e200] {
        cubic_lengths(&[curve.map(|p| p * scale)], 1e-12 * scale, &mut found);
        assert!(
            (found[0] / scale - one).abs() < 1e-12,
            "{scale:e}: {}",
            found[0] / scale
        );
    }
}

#[test]
fn closed_forms_equal_quadrature() {
    let mut random = Random(3);
    for i in 0..500 {
        let [a, b, mut c] = [random.solid(), random.solid(), random.solid()];
        if i % 5 == 0 {
            // Nearly a line, and a line that turns.
            c = a
                + (b - a) * random.between(-2.0, 3.0)
                + random.solid() * if i % 2 == 0 { 0.0 } else { 1e-9 };
        }
        let curve = Bezier::new(vec![a, b, c]).unwrap();
        let exact = exact_length(&{
            let cubic = curve.raised().unwrap();
            [
                cubic.points()[0],
                cubic.points()[1],
                cubic.points()[2],
                cubic.points()[3],
            ]
        });
        assert!(
            (closed::quadratic([a, b, c]) - exact).abs() < 1e-12,
            "{a} {b} {c}"
        );
        assert!((curve.length(1e-12) - exact).abs() < 2e-12);
        let half = closed::quadratic_between([a, b, c], 0.25, 0.5);
        assert!((half - curve.length_between(0.25, 0.5, 1e-13)).abs() < 1e-12);
    }
    assert_eq!(closed::line(dvec2(1.0, 1.0), dvec2(4.0, 5.0)), 5.0);
    assert_eq!(closed::quadratic([dvec2(1.0, 1.0); 3]), 0.0);
}

/// Every length at which a table and single questions are asked keeps the tolerance on length (C13).
fn check_inverse(curve: &[DVec2; 4], accuracy: f64) {
    let path = PiecewiseCubic::new(vec![Cubic::from_bezier(*curve)], false).unwrap();
    let total = path.length(1e-13);
    if total == 0.0 {
        assert!(LengthTable::new(&path, accuracy).is_err());
        return;
    }
    let table = LengthTable::new(&path, accuracy).unwrap();
    assert!(table.is_complete(), "{curve:?}");
    assert!((table.length() - total).abs() <= accuracy);
    for k in 0..=50 {
        // Also next to the ends, where cusps often are.
        let share = match k {
            0..=40 => f64::from(k) / 40.0,
            41..=45 => 0.1_f64.powi(k - 38),
            _ => 1.0 - 0.1_f64.powi(k - 43),
        };
        let s = total * share;
        let checks = [
            ("table", table.parameter(s)),
            ("path", path.parameter_at(s, accuracy)),
            ("cubic", cubic_parameter_at(curve, s, accuracy)),
        ];
        for (name, u) in checks {
            let reached = path.length_between(0.0, u, 1e-13);
            assert!(
                (reached - s).abs() <= accuracy + 2e-13,
                "{name} {curve:?} {share}: {u}, off by {:e}",
                (reached - s).abs()
            );
        }
        let u = share;
        let to = path.length_between(0.0, u, 1e-13);
        assert!(
            (table.length_to(u) - to).abs() <= accuracy + 2e-13,
            "{curve:?} {u}"
        );
    }
}

#[test]
fn many_inverses_equal_one_at_a_time() {
    let curves = hard();
    let (mut lengths, mut many) = (Vec::new(), Vec::new());
    cubic_lengths(&curves, 1e-12, &mut lengths);
    // From before the start to behind the end, and one that is no number.
    for (step, length) in lengths.iter_mut().enumerate() {
        *length *= (step % 13) as f64 / 10.0 - 0.1;
    }
    lengths[5] = f64::NAN;
    for accuracy in [1e-3, 1e-9] {
        cubic_parameters_at(&curves, &lengths, accuracy, &mut many);
        assert_eq!(many.len(), curves.len());
        for ((curve, &s), u) in curves.iter().zip(&lengths).zip(&many) {
            assert_eq!(*u, cubic_parameter_at(curve, s, accuracy), "{curve:?} {s}");
        }
        let solid: Vec<[DVec3; 4]> = curves
            .iter()
            .map(|c| c.map(|p| p.extend(p.x - 0.3 * p.y)))
            .collect();
        cubic_parameters_at(&solid, &lengths, accuracy, &mut many);
        for ((curve, &s), u) in solid.iter().zip(&lengths).zip(&many) {
            assert_eq!(*u, cubic_parameter_at(curve, s, accuracy), "{curve:?} {s}");
        }
    }
    cubic_parameters_at(&curves[..3], &lengths[..2], 1e-9, &mut many);
    assert_eq!(many.len(), 2);
    cubic_parameters_at::<DVec2>(&[], &[], 1e-9, &mut many);
    assert!(many.is_empty());
}

#[test]
fn inverses_keep_their_accuracy_on_length() {
    let curves = hard();
    let some = curves
        .iter()
        .enumerate()
        .filter(|(i, _)| *i < 280 || i % 16 == 0);
    for (_, curve) in some {
        check_inverse(curve, 1e-9);
    }
    for curve in curves.iter().take(9) {
        for accuracy in [1e-2, 1e-5, 1e-12] {
            check_inverse(curve, accuracy);
        }
    }
}

#[test]
fn tables_are_small_and_monotone() {
    let points: Vec<DVec3> = (0..40)
        .map(|i| {
            let a = 0.7 * f64::from(i);
            dvec3(a.cos(), a.sin() * 0.3, 0.05 * f64::from(i))
        })
        .collect();
    let curve = CatmullRom::new(points).curve().unwrap();
    let table = LengthTable::new(&curve, 1e-9).unwrap();
    assert!(table.intervals() < 2000, "{}", table.intervals());
    let mut before = -1.0;
    for i in 0..=10_000 {
        let u = table.parameter(table.length() * f64::from(i) / 10_000.0);
        assert!(u >= before);
        before = u;
    }
    assert_eq!(table.parameter(-1.0), 0.0);
    assert_eq!(table.parameter(f64::NAN), 0.0);
    assert_eq!(table.parameter(f64::INFINITY), 39.0);
}

#[test]
fn constant_speed_motion_is_constant() {
    // Systems C3: deviates by less than 0.1 % in speed.
    let points = [
        (0.0, 0.0),
        (1.0, 2.0),
        (1.1, 2.0),
        (5.0, -1.0),
        (5.0, 3.0),
        (0.0, 0.1),
    ];
    let curve = CatmullRom::new(points.map(|(x, y)| dvec2(x, y)).to_vec())
        .curve()
        .unwrap();
    let table = LengthTable::new(&curve, 1e-9).unwrap();
    let n = 4000;
    let step = table.length() / f64::from(n);
    let at = |i: u32| table.parameter(step * f64::from(i));
    for i in 0..n {
        let walked = curve.length_between(at(i), at(i + 1), 1e-13);
        assert!((walked / step - 1.0).abs() < 1e-5, "{i}: {walked} {step}");
    }
}

#[test]
fn closed_curves_wrap() {
    let points = vec![
        dvec2(0.0, 0.0),
        dvec2(2.0, 0.0),
        dvec2(2.0, 1.0),
        dvec2(0.0, 1.5),
    ];
    let curve = CatmullRom::new(points).closed().curve().unwrap();
    let table = LengthTable::new(&curve, 1e-10).unwrap();
    let l = table.length();
    for s in [0.3, 1.7, 3.0] {
        let (u, around) = (table.parameter(s), table.parameter(s + l));
        assert!((u - around).abs() < 1e-8, "{u} {around}");
        assert!((table.parameter(s - l) - u).abs() < 1e-8);
        assert!((curve.parameter_at(s - l, 1e-10) - u).abs() < 1e-8);
    }
    assert!(
        (curve.length_between(3.5, 0.5, 1e-12) + curve.length_between(0.5, 3.5, 1e-12)).abs()
            < 1e-12
    );
}

#[test]
fn all_kinds_of_curves_have_lengths() {
    let points: Vec<DVec3> = (0..6).map(|i| Random(i + 1).solid()).collect();
    let bezier = Bezier::new(points.clone()).unwrap();
    let exact = |curve: &dyn ArcLength<DVec3>| {
        // Romberg-free check: chords of a million steps, extrapolated.
        let (start, end) = curve.domain();
        let chords = |n: usize| -> f64 {
            let at = |i: usize| curve.point(start + (end - start) * i as f64 / n as f64);
            (0..n).map(|i| at(i).distance(at(i + 1))).sum()
        };
        let (coarse, fine) = (chords(30_000), chords(60_000));
        fine + (fine - coarse) / 3.0
    };
    let lagrange = Lagrange::new(points.clone()).unwrap();
    let chain = PiecewiseBezier::new(
        vec![bezier.clone(), bezier.reversed()],
        vec![0.0, 2.0, 3.0],
        true,
    )
    .unwrap();
    for curve in [&bezier as &dyn ArcLength<DVec3>, &lagrange, &chain] {
        let found = curve.length(1e-10);
        assert!(
            (found - exact(curve)).abs() < 1e-8,
            "{found} {}",
            exact(curve)
        );
    }
    for (s, accuracy) in [(0.1, 1e-9), (0.5, 1e-6)] {
        let u = lagrange.parameter_at(s, accuracy);
        assert!((lagrange.length_between(0.0, u, 1e-12) - s).abs() <= accuracy);
        let u = chain.parameter_at(s, accuracy);
        assert!((chain.length_between(0.0, u, 1e-12) - s).abs() <= accuracy);
        let table = LengthTable::new(&chain, accuracy).unwrap();
        assert!((chain.length_between(0.0, table.parameter(s), 1e-12) - s).abs() <= accuracy);
    }
}

#[test]
fn the_five_methods_meet_their_accuracy_on_hard_curves() {
    for curve in hard().iter().take(150).step_by(7) {
        let path = CubicBezier {
            points: curve.to_vec(),
            closed: false,
        }
        .curve()
        .unwrap();
        let exact = exact_length(&solid(curve));

        for method in methods::<DVec2>() {
            for accuracy in [1e-2, 1e-4] {
                let found = method.measure(&path, accuracy);
                assert!(found.converged);
                // Chords are extrapolated by no one: their own estimate may be off by a factor at a cusp.
                assert!(
                    (found.length - exact).abs() <= 2.0 * accuracy,
                    "{} {curve:?} {accuracy}: {found:?} {exact}",
                    method.name()
                );
            }
        }
    }
}

#[test]
fn bad_accuracies_and_points_are_refused() {
    let path = CatmullRom::new(vec![dvec2(0.0, 0.0), dvec2(1.0, 0.0)])
        .curve()
        .unwrap();
    for accuracy in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(LengthTable::new(&path, accuracy).is_err(), "{accuracy}");
    }
    // Accuracies that no number can have still end.
    for accuracy in [0.0, -1.0, 1e-300] {
        assert!((path.length(accuracy) - 1.0).abs() < 1e-14);
        assert!((path.parameter_at(0.25, accuracy) - 0.25).abs() < 1e-14);
    }
    let still = CatmullRom::new(vec![dvec2(1.0, 1.0); 3]).curve().unwrap();
    assert!(LengthTable::new(&still, 1e-6).is_err());
    assert_eq!(still.length(1e-6), 0.0);
    assert_eq!(still.parameter_at(0.5, 1e-6), 2.0);
}

#[test]
fn a_stop_in_the_middle_is_passed() {
    // Coincident points make a span without length.
    let points = vec![
        dvec2(0.0, 0.0),
        dvec2(1.0, 0.0),
        dvec2(1.0, 0.0),
        dvec2(2.0, 1.0),
    ];
    let curve = CatmullRom::new(points)
        .spaced(Spacing::Chordal)
        .curve()
        .unwrap();
    let table = LengthTable::new(&curve, 1e-9).unwrap();
    for k in 0..=100 {
        let s = table.length() * f64::from(k) / 100.0;
        for u in [table.parameter(s), curve.parameter_at(s, 1e-9)] {
            assert!((curve.length_between(0.0, u, 1e-13) - s).abs() <= 1.1e-9);
        }
        let u = 3.0 * f64::from(k) / 100.0;
        assert!((table.length_to(u) - curve.length_between(0.0, u, 1e-13)).abs() <= 1.1e-9);
    }
}
