//! What passes unchanged, closed paths against periodic ones, pinned points, bad input.

use super::*;
use anamorph_core::glam::{DVec2, DVec3, dvec2};

fn filters() -> Vec<(&'static str, Box<dyn Filter>, usize, usize)> {
    // Name, filter, degree of polynomials that pass inside, degree at the ends.
    let kernel = |kernel: Result<Kernel, CurveError>| Box::new(kernel.unwrap());
    vec![
        ("average", Box::new(NeighbourAverage), 1, 1),
        ("cubic", Box::new(FourNeighbourCubic), 3, 2),
        ("box", kernel(Kernel::box_of(1)), 1, 1),
        ("wide box", kernel(Kernel::box_of(2)), 1, 1),
        ("box of 40", kernel(Kernel::box_of(40)), 1, 1),
        ("tent", kernel(Kernel::tent(3)), 1, 1),
        ("gaussian", kernel(Kernel::gaussian(1.7, 1e-9)), 1, 1),
        ("wide gaussian", kernel(Kernel::gaussian(12.0, 1e-3)), 1, 1),
        ("area", Box::new(Kernel::area_weighted()), 1, 1),
        (
            "savitzky 5 2",
            Box::new(SavitzkyGolay::new(5, 2).unwrap()),
            3,
            2,
        ),
        (
            "savitzky 7 3",
            Box::new(SavitzkyGolay::new(7, 3).unwrap()),
            3,
            3,
        ),
        (
            "savitzky 11 4",
            Box::new(SavitzkyGolay::new(11, 4).unwrap()),
            5,
            4,
        ),
        (
            "savitzky 15 9",
            Box::new(SavitzkyGolay::new(15, 9).unwrap()),
            9,
            9,
        ),
        (
            "savitzky 1 0",
            Box::new(SavitzkyGolay::new(1, 0).unwrap()),
            1,
            1,
        ),
    ]
}

fn noise(count: usize) -> Vec<f64> {
    let mut state = 88_172_645_463_325_252_u64;
    let step = |_| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    (0..count).map(step).collect()
}

fn polynomial(count: usize, degree: usize) -> Vec<f64> {
    let at = |i: usize| {
        let x = i as f64 / 10.0 - 1.3;
        (0..=degree).fold(0.0, |sum, k| sum * x + [0.7, -1.1, 0.4, 2.0][k % 4])
    };
    (0..count).map(at).collect()
}

fn reach(filter: &dyn Filter) -> usize {
    // The widest row of a path long enough to have an inner one.
    let mut row = Vec::new();
    filter.weights(401, false).row(200, &mut row);
    row.iter().map(|(i, _)| i.abs_diff(200)).max().unwrap()
}

#[test]
fn polynomials_of_the_stated_degrees_pass() {
    for (name, filter, inside, ends) in filters() {
        let reach = reach(&*filter);
        for degree in 0..=inside.max(ends) {
            let count = 2 * reach + 9;
            let path = polynomial(count, degree);
            let size = path.iter().fold(1.0_f64, |m, y| m.max(y.abs()));
            let smoothed = smooth(&path, &*filter, &Smoothing::default()).unwrap();
            for i in 0..count {
                let inner = i >= reach && i + reach < count;
                if degree <= if inner { inside } else { ends } {
                    let error = (smoothed[i] - path[i]).abs();
                    assert!(
                        error <= 1e-13 * size,
                        "{name}, degree {degree}, point {i}: {error:e}"
                    );
                }
            }
        }
        // The next degree (of the right parity, for symmetric weights) does not pass.
        if name != "savitzky 1 0" {
            let path: Vec<f64> = (0..2 * reach + 9)
                .map(|i| (i as f64 / 10.0).powi(inside as i32 + 1))
                .collect();
            let smoothed = smooth(&path, &*filter, &Smoothing::default()).unwrap();
            assert!(
                (smoothed[reach + 4] - path[reach + 4]).abs() > 1e-11,
                "{name}"
            );
        }
    }
}

#[test]
fn constants_pass_however_short_the_path() {
    for (name, filter, ..) in filters() {
        for count in 1..12 {
            for closed in [false, true] {
                let path = vec![dvec2(0.3, -7.1); count];
                let smoothing = Smoothing {
                    closed,
                    iterations: 3,
                    ..Smoothing::default()
                };
                for point in smooth(&path, &*filter, &smoothing).unwrap() {
                    assert!(
                        (point - path[0]).length() < 1e-14 * 8.0,
                        "{name}, {count} points"
                    );
                }
            }
        }
        assert!(
            smooth::<DVec3>(&[], &*filter, &Smoothing::default())
                .unwrap()
                .is_empty()
        );
    }
}

#[test]
fn lines_pass_however_short_the_path() {
    for (name, filter, ..) in filters() {
        for count in 1..12 {
            let path: Vec<f64> = (0..count).map(|i| 2.0 - 0.5 * f64::from(i)).collect();
            let smoothed = smooth(&path, &*filter, &Smoothing::default()).unwrap();
            for (new, old) in smoothed.iter().zip(&path) {
                assert!((new - old).abs() < 1e-12, "{name}, {count} points");
            }
        }
    }
}

#[test]
fn closed_paths_are_periodic() {
    for (name, filter, ..) in filters() {
        for period in [1, 2, 3, 4, 5, 17] {
            let path = noise(period);
            let closed = Smoothing {
                closed: true,
                iterations: 2,
                ..Smoothing::default()
            };
            let wrapped = smooth(&path, &*filter, &closed).unwrap();
            // Enough repetitions that the open path's ends are out of sight.
            let repeats = 4 * reach(&*filter) / period + 5;
            let long: Vec<f64> = path
                .iter()
                .copied()
                .cycle()
                .take(period * repeats)
                .collect();
            let open = Smoothing {
                iterations: 2,
                ..Smoothing::default()
            };
            let unrolled = smooth(&long, &*filter, &open).unwrap();
            for i in 0..period {
                let there = unrolled[repeats / 2 * period + i];
                assert!(
                    (wrapped[i] - there).abs() < 1e-14,
                    "{name}, period {period}"
                );
            }
        }
    }
}

#[test]
fn pinned_points_keep_their_bits() {
    let path: Vec<DVec2> = noise(60)
        .chunks(2)
        .map(|p| dvec2(p[0], -0.0 * p[1]))
        .collect();
    for (name, filter, ..) in filters() {
        let smoothing = Smoothing {
            iterations: 5,
            pinned: &[3, 17, 17, 29],
            pin_ends: true,
            ..Smoothing::default()
        };
        let smoothed = smooth(&path, &*filter, &smoothing).unwrap();
        for i in [0, 3, 17, 29] {
            assert_eq!(smoothed[i].x.to_bits(), path[i].x.to_bits(), "{name}");
            assert_eq!(smoothed[i].y.to_bits(), path[i].y.to_bits(), "{name}");
        }
        let free = smooth(
            &path,
            &*filter,
            &Smoothing {
                iterations: 5,
                ..Smoothing::default()
            },
        )
        .unwrap();
        if name != "savitzky 1 0" {
            assert_ne!(free[3], path[3], "{name}");
            assert_ne!(
                free[4], smoothed[4],
                "{name}: neighbours see what is pinned"
            );
        }
        let never = Smoothing {
            iterations: 0,
            ..Smoothing::default()
        };
        assert_eq!(smooth(&path, &*filter, &never).unwrap(), path);
    }
}

#[test]
fn ends_stay_under_kernels_and_move_under_fits() {
    let path = noise(30);
    for (name, filter, ..) in filters() {
        let smoothed = smooth(&path, &*filter, &Smoothing::default()).unwrap();
        let fits = name == "cubic" || (name.starts_with("savitzky") && name != "savitzky 1 0");
        assert_eq!(smoothed[0] != path[0], fits, "{name}");
        assert_eq!(smoothed[29] != path[29], fits, "{name}");
        // Noise gets less.
        let rough = |path: &[f64]| path.windows(2).map(|p| (p[1] - p[0]).powi(2)).sum::<f64>();
        if name != "savitzky 1 0" {
            assert!(rough(&smoothed) < 0.9 * rough(&path), "{name}");
        }
    }
}

#[test]
fn published_weights() {
    let rows = |filter: &dyn Filter, index: usize, count: usize| {
        let mut row = Vec::new();
        filter.weights(count, false).row(index, &mut row);
        row.into_iter()
            .map(|(_, weight)| weight)
            .collect::<Vec<f64>>()
    };
    let close = |found: &[f64], wanted: &[f64], scale: f64| {
        assert_eq!(found.len(), wanted.len());
        for (f, w) in found.iter().zip(wanted) {
            assert!((f * scale - w).abs() < 1e-12, "{found:?}");
        }
    };
    // Savitzky and Golay 1964, tables for 5 and 9 points; the first row of Gorry's table for 5 points, quadratic.
    let five = SavitzkyGolay::new(5, 2).unwrap();
    close(&rows(&five, 6, 20), &[-3.0, 12.0, 17.0, 12.0, -3.0], 35.0);
    close(&rows(&five, 0, 20), &[31.0, 9.0, -3.0, -5.0, 3.0], 35.0);
    close(&rows(&five, 19, 20), &[3.0, -5.0, -3.0, 9.0, 31.0], 35.0);
    let nine = SavitzkyGolay::new(9, 3).unwrap();
    let table = [-21.0, 14.0, 39.0, 54.0, 59.0, 54.0, 39.0, 14.0, -21.0];
    close(&rows(&nine, 9, 20), &table, 231.0);
    assert_eq!(Kernel::tent(1).unwrap().half(), [0.5, 0.25]);
    assert_eq!(Kernel::box_of(2).unwrap().half(), [0.2, 0.2, 0.2]);
    assert_eq!(Kernel::area_weighted().half(), [0.75, 0.125]);
}

/// The weights of a window as wide and a degree as high as allowed still reproduce polynomials.
#[test]
fn wide_windows_and_high_degrees_keep_their_digits() {
    let path: Vec<f64> = (0..200).map(|i| (f64::from(i) * 0.03).sin()).collect();
    let filter = SavitzkyGolay::new(101, 64).unwrap();
    let smoothed = smooth(&path, &filter, &Smoothing::default()).unwrap();
    for (new, old) in smoothed.iter().zip(&path) {
        assert!((new - old).abs() < 1e-12);
    }
}

#[test]
fn gaussians_are_cut_where_stated() {
    for (deviation, cut) in [
        (0.01, 1e-3),
        (0.5, 1e-6),
        (3.0, 1e-2),
        (3.0, 1e-12),
        (200.0, 1e-4),
    ] {
        let kernel = Kernel::gaussian(deviation, cut).unwrap();
        let weight = |k: f64| (-0.5 * (k / deviation).powi(2)).exp();
        let far = (40.0 * deviation).ceil() as usize + 3;
        let mass = |from: usize| 2.0 * (from..far).map(|k| weight(k as f64)).sum::<f64>();
        let whole = 1.0 + mass(1);
        assert!(mass(kernel.radius() + 1) <= cut * whole * (1.0 + 1e-9));
        if kernel.radius() > 0 {
            assert!(
                mass(kernel.radius()) > cut * whole * (1.0 - 1e-9),
                "wider than needed"
            );
        }
        let sum = kernel.half()[0] + 2.0 * kernel.half()[1..].iter().sum::<f64>();
        assert!((sum - 1.0).abs() < 1e-13);
    }
}

#[test]
fn bad_input_is_named() {
    let smoothing = Smoothing {
        pinned: &[2],
        ..Smoothing::default()
    };
    let message = |result: Result<Vec<f64>, CurveError>| result.unwrap_err().to_string();
    let pinned = message(smooth(&[0.0, 1.0], &NeighbourAverage, &smoothing));
    assert_eq!(
        pinned,
        "pinned point 2 does not exist: there are 2, counted from 0"
    );
    let path = [0.0, f64::NAN, f64::INFINITY];
    let wrong = message(smooth(&path, &NeighbourAverage, &Smoothing::default()));
    assert!(wrong.contains("point 1 is not finite"), "{wrong}");
    let huge = [f64::MAX, -f64::MAX, f64::MAX, -f64::MAX, f64::MAX];
    let left = message(smooth(&huge, &FourNeighbourCubic, &Smoothing::default()));
    assert!(left.contains("smoothed point"), "{left}");
    assert!(SavitzkyGolay::new(4, 2).is_err());
    assert!(SavitzkyGolay::new(5, 5).is_err());
    assert!(SavitzkyGolay::new(10_003, 2).is_err());
    assert!(Kernel::symmetric(&[]).is_err());
    assert!(Kernel::symmetric(&[1.0, -0.5]).is_err());
    assert!(Kernel::symmetric(&[1.0, f64::NAN]).is_err());
    assert!(Kernel::box_of(usize::MAX).is_err());
    assert!(Kernel::gaussian(f64::NAN, 1e-3).is_err());
    assert!(Kernel::gaussian(1.0, 0.0).is_err());
}
