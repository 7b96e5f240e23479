//! Rows of the errata about eases and smoothing, pinned by name: what the formulas are, and what they are not.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_curves::eases::{ConstantAcceleration, Ease, PiecewiseSinusoidal, Sinusoidal};
use anamorph_curves::smoothing::{
    Filter, FourNeighbourCubic, Kernel, NeighbourAverage, Smoothing, smooth,
};
use core::f64::consts::{FRAC_PI_2, PI};

fn once(path: &[f64], filter: &dyn Filter) -> Vec<f64> {
    smooth(path, filter, &Smoothing::default()).unwrap()
}

/// C4: the first part has `+ 1`; printed without it the ease would start below 0. Empty parts are allowed.
#[test]
fn c4_piecewise_sinusoid_starts_at_zero() {
    for (k1, k2) in [
        (0.3, 0.8),
        (0.2, 0.2),
        (0.0, 0.6),
        (0.4, 1.0),
        (0.0, 1.0),
        (0.5, 0.5),
    ] {
        let ease = PiecewiseSinusoidal::new(k1, k2).unwrap();
        let f = k1 * 2.0 / PI + k2 - k1 + (1.0 - k2) * 2.0 / PI;
        for i in 0..=100 {
            let t = f64::from(i) / 100.0;
            let formula = if t < k1 {
                k1 * (2.0 / PI) * ((t / k1 * FRAC_PI_2 - FRAC_PI_2).sin() + 1.0) / f
            } else if t <= k2 {
                (2.0 * k1 / PI + t - k1) / f
            } else {
                let last = ((t - k2) / (1.0 - k2) * FRAC_PI_2).sin();
                (2.0 * k1 / PI + k2 - k1 + (1.0 - k2) * (2.0 / PI) * last) / f
            };
            assert!((ease.value(t) - formula).abs() < 1e-14, "{k1}, {k2} at {t}");
        }
        assert_eq!(ease.value(0.0), 0.0);
        assert_eq!(ease.value(1.0), 1.0);
        // Without the `+ 1` the first part would be lower by its whole rise.
        let printed = -k1 * (2.0 / PI) / f;
        assert!(k1 == 0.0 || printed < -0.05);
    }
    // Without an even part in the middle it is the plain sinusoid.
    let halves = PiecewiseSinusoidal::new(0.5, 0.5).unwrap();
    assert!((0..=50).all(|i| {
        let t = f64::from(i) / 50.0;
        (halves.value(t) - Sinusoidal.value(t)).abs() < 1e-15
    }));
    assert!(PiecewiseSinusoidal::new(0.6, 0.5).is_err());
}

/// C5: `¼ ½ ¼`; the printed `¼ ¼ ¼` would shrink the path.
#[test]
fn c5_weights_of_the_average_sum_to_one() {
    let mut pulse = vec![0.0; 9];
    pulse[4] = 1.0;
    let smoothed = once(&pulse, &NeighbourAverage);
    assert_eq!(smoothed[3..6], [0.25, 0.5, 0.25]);
    let line: Vec<f64> = (0..9).map(|i| 3.0 - 0.25 * f64::from(i)).collect();
    assert_eq!(once(&line, &NeighbourAverage), line);
}

/// C6: the estimates inside, next to the end and at the end; what passes unchanged.
#[test]
fn c6_cubic_smoothing_and_its_end_rules() {
    let p = [0.3, -1.2, 2.0, 0.7, -0.4, 1.9, 0.1];
    let n = p.len();
    let smoothed = once(&p, &FourNeighbourCubic);
    let with = |data: f64, estimate: f64| 0.5 * (data + estimate);
    for i in 2..n - 2 {
        let estimate = (-p[i - 2] + 4.0 * p[i - 1] + 4.0 * p[i + 1] - p[i + 2]) / 6.0;
        assert!((smoothed[i] - with(p[i], estimate)).abs() < 1e-15);
    }
    let ends = [
        (1, p[2] + (p[0] - p[3]) / 3.0),
        (0, p[3] + 3.0 * (p[1] - p[2])),
        (n - 2, p[n - 3] + (p[n - 1] - p[n - 4]) / 3.0),
        (n - 1, p[n - 4] + 3.0 * (p[n - 2] - p[n - 3])),
    ];
    for (i, estimate) in ends {
        assert!((smoothed[i] - with(p[i], estimate)).abs() < 1e-15, "{i}");
    }
    let power = |degree: i32| -> Vec<f64> { (0..9).map(|i| f64::from(i).powi(degree)).collect() };
    let changes = |degree: i32| -> Vec<usize> {
        let path = power(degree);
        let moved = once(&path, &FourNeighbourCubic);
        (0..9)
            .filter(|&i| (moved[i] - path[i]).abs() > 1e-9)
            .collect()
    };
    assert_eq!(changes(2), []);
    assert_eq!(changes(3), [0, 1, 7, 8]);
    assert_eq!(changes(4).len(), 9);
    // Fewer than five points: four have end rules only, three stay; closed paths wrap.
    let squares = [0.0, 1.0, 4.0, 9.0];
    assert!(
        once(&squares, &FourNeighbourCubic)
            .iter()
            .zip(squares)
            .all(|(a, b)| (a - b).abs() < 1e-14)
    );
    assert_ne!(
        once(&[0.0, 1.0, 0.0, 1.0], &FourNeighbourCubic),
        [0.0, 1.0, 0.0, 1.0]
    );
    assert_eq!(once(&[0.0, 5.0, 1.0], &FourNeighbourCubic), [0.0, 5.0, 1.0]);
    let closed = Smoothing {
        closed: true,
        ..Smoothing::default()
    };
    let wrapped = smooth(&p, &FourNeighbourCubic, &closed).unwrap();
    let first = (-p[n - 2] + 4.0 * p[n - 1] + 4.0 * p[1] - p[2]) / 6.0;
    assert!((wrapped[0] - with(p[0], first)).abs() < 1e-15);
    // The area-weighted kernel.
    let mut pulse = vec![0.0; 5];
    pulse[2] = 1.0;
    assert_eq!(
        once(&pulse, &Kernel::area_weighted())[1..4],
        [0.125, 0.75, 0.125]
    );
}

/// C12: the even speed is `2/(1 − t1 + t2)`; the area under the speed is 1.
#[test]
fn c12_constant_acceleration_covers_the_whole() {
    for (t1, t2) in [(0.2, 0.7), (0.0, 1.0), (0.5, 0.5), (0.0, 0.3), (0.9, 1.0)] {
        let ease = ConstantAcceleration::new(t1, t2).unwrap();
        let v0 = 2.0 / (1.0 - t1 + t2);
        assert!((ease.even_speed() - v0).abs() < 1e-15);
        assert!((0.5 * v0 * t1 + v0 * (t2 - t1) + 0.5 * v0 * (1.0 - t2) - 1.0).abs() < 1e-15);
        assert_eq!((ease.value(0.0), ease.value(1.0)), (0.0, 1.0));
        let middle = 0.5 * (t1 + t2);
        assert!((ease.value(middle) - v0 * (middle - 0.5 * t1)).abs() < 1e-15);
        assert!((ease.speed(middle) - v0).abs() < 1e-15);
    }
}
