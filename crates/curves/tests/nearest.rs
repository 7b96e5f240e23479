//! Nearest points (errata F10): all local minima, the least, ties; and a comparison with kurbo.

#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::{Curve, NearestPoint};
use anamorph_curves::arc_length::{cubic_lengths, cubic_parameter_at};
use anamorph_curves::families::{BSpline, CatmullRom, Generator, Lagrange};
use anamorph_curves::{Bezier, NearestTable, Pieces};
use common::{Random, hard};
use kurbo::{CubicBez, ParamCurveArclen, ParamCurveNearest};

/// Local minima of fine samples: each must be near one that was found, and the other way round.
fn check_minima<C: Pieces<DVec2> + ?Sized>(curve: &C, to: DVec2, name: &str) {
    let table = NearestTable::new(curve);
    let minima = table.local_minima(to);
    let (start, end) = curve.domain();
    let n = 6000;
    let at = |i: usize| start + (end - start) * i as f64 / n as f64;
    let d: Vec<f64> = (0..=n).map(|i| curve.point(at(i)).distance(to)).collect();
    let best = d.iter().copied().fold(f64::INFINITY, f64::min);
    let nearest = table.nearest(to);
    assert!(
        nearest.distance <= best + 1e-12,
        "{name}: {nearest:?} {best}"
    );
    assert!((nearest.distance - curve.point(nearest.parameter).distance(to)).abs() < 1e-12);
    assert!(
        minima.windows(2).all(|w| w[0].parameter < w[1].parameter),
        "{name}: {minima:?}"
    );
    for minimum in &minima {
        // No sample next to it is nearer.
        let h = 1e-5 * (end - start);
        for u in [minimum.parameter - h, minimum.parameter + h] {
            let there = curve.point(u).distance(to);
            assert!(
                there >= minimum.distance - 1e-9,
                "{name}: {minimum:?} but {there} at {u}"
            );
        }
    }
    for i in 1..n {
        // Dips of which samples leave no doubt.
        if d[i] < d[i - 1] - 1e-9 && d[i] < d[i + 1] - 1e-9 {
            let step = (end - start) / n as f64;
            let near =
                |m: &&anamorph_core::Nearest<DVec2>| (m.parameter - at(i)).abs() <= 2.0 * step;
            assert!(
                minima.iter().any(|m| near(&m)),
                "{name}: dip at {} of {minima:?}",
                at(i)
            );
        }
    }
}

#[test]
fn all_minima_of_random_curves_are_found() {
    let mut random = Random(21);
    for round in 0..60 {
        let points: Vec<DVec2> = (0..8).map(|_| random.plane()).collect();
        let to = random.plane() * 2.0 - 0.5;
        let catmull = CatmullRom::new(points.clone());
        check_minima(
            &catmull.clone().curve().unwrap(),
            to,
            &format!("catmull {round}"),
        );
        check_minima(
            &catmull.closed().curve().unwrap(),
            to,
            &format!("closed {round}"),
        );
        check_minima(
            &Bezier::new(points.clone()).unwrap(),
            to,
            &format!("bezier {round}"),
        );
        check_minima(
            &Lagrange::new(points[..6].to_vec()).unwrap(),
            to,
            &format!("lagrange {round}"),
        );
        let spline = BSpline {
            degree: 4,
            ..BSpline::new(points)
        };
        check_minima(&spline.pieces().unwrap(), to, &format!("spline {round}"));
    }
}

#[test]
fn minima_of_hard_cubics_are_found() {
    let mut random = Random(22);
    for (i, curve) in hard().iter().enumerate().step_by(9) {
        let bezier = Bezier::new(curve.to_vec()).unwrap();
        let to = if i % 2 == 0 {
            random.plane()
        } else {
            curve[0].lerp(curve[3], random.unit())
        };
        let nearest = bezier.nearest(to);
        let best = (0..=20_000).map(|k| bezier.point(f64::from(k) / 20_000.0).distance(to));
        assert!(
            nearest.distance <= best.fold(f64::INFINITY, f64::min) + 1e-12,
            "{i}"
        );
    }
}

#[test]
fn ties_go_to_the_smallest_parameter() {
    // A symmetric arch and a point on its axis, below: both feet are equally near.
    let arch = Bezier::new(vec![
        dvec2(-1.0, 0.0),
        dvec2(-1.0, 2.0),
        dvec2(1.0, 2.0),
        dvec2(1.0, 0.0),
    ])
    .unwrap();
    assert_eq!(arch.nearest(dvec2(0.0, -3.0)).parameter, 0.0);
    assert_eq!(
        NearestTable::new(&arch)
            .local_minima(dvec2(0.0, -3.0))
            .len(),
        2
    );
    assert!((arch.nearest(dvec2(0.0, 5.0)).parameter - 0.5).abs() < 1e-12);
    // A figure eight passes its middle twice.
    let eight = [
        (0.0, 0.0),
        (1.0, 1.0),
        (2.0, 0.0),
        (1.0, -1.0),
        (0.0, 0.0),
        (-1.0, 1.0),
        (-2.0, 0.0),
        (-1.0, -1.0),
    ];
    let eight = CatmullRom::new(eight.map(|(x, y)| dvec2(x, y)).to_vec())
        .closed()
        .curve()
        .unwrap();
    let middle = eight.nearest(dvec2(0.0, 0.0));
    assert_eq!((middle.parameter, middle.distance), (0.0, 0.0));
    assert!(
        NearestTable::new(&eight)
            .local_minima(dvec2(0.0, 0.0))
            .len()
            >= 2
    );
    // A point that is a curve, and a place that is no number.
    let still = Bezier::new(vec![dvec2(1.0, 0.0); 4]).unwrap();
    assert_eq!(still.nearest(dvec2(4.0, 4.0)).distance, 5.0);
    assert_eq!(
        NearestTable::new(&still)
            .local_minima(dvec2(4.0, 4.0))
            .len(),
        1
    );
    assert_eq!(arch.nearest(dvec2(f64::NAN, 0.0)).parameter, 0.0);
    assert!(
        NearestTable::new(&arch)
            .local_minima(dvec2(f64::INFINITY, 0.0))
            .is_empty()
    );
}

#[test]
fn agrees_with_kurbo() {
    let mut random = Random(23);
    for _ in 0..2000 {
        let p: [DVec2; 4] = core::array::from_fn(|_| random.plane());
        let theirs = CubicBez::new(
            (p[0].x, p[0].y),
            (p[1].x, p[1].y),
            (p[2].x, p[2].y),
            (p[3].x, p[3].y),
        );
        let mut length = Vec::new();
        cubic_lengths(&[p], 1e-10, &mut length);
        assert!((length[0] - theirs.arclen(1e-10)).abs() < 1e-9);
        let s = length[0] * random.unit();
        // Kurbo's tolerance is on its parameter's bracket: compare where the curve is not slow.
        let (ours, their) = (
            cubic_parameter_at(&p, s, 1e-10),
            theirs.inv_arclen(s, 1e-10),
        );
        let bezier = Bezier::new(p.to_vec()).unwrap();
        assert!(bezier.point(ours).distance(bezier.point(their)) < 1e-6);
        let to = random.plane() * 2.0 - 0.5;
        let nearest = bezier.nearest(to);
        let their = theirs.nearest(kurbo::Point::new(to.x, to.y), 1e-9);
        assert!(
            nearest.distance <= their.distance_sq.sqrt() + 1e-9,
            "{p:?} {to}"
        );
        assert!(
            nearest.distance >= their.distance_sq.sqrt() - 1e-5,
            "{p:?} {to}"
        );
    }
}
