//! Curve families (systems C1; errata C1–C3, C17, C20): interpolation, end tangents, locality, continuity, conversions.

#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use anamorph_core::glam::{DVec2, DVec3, dvec2, dvec3};
use anamorph_core::{Curve, Differentiable, Plane, Solid};
use anamorph_curves::families::registry::{FAMILIES, Family, Given, family};
use anamorph_curves::families::{
    BSpline, BlendedParabolas, CatmullRom, CubicBezier, Ends, FourPoint, Generator, Hermite, Knots,
    KochanekBartels, Lagrange, Shape, Spacing,
};
use anamorph_curves::{
    Bezier, Cubic, Curvature, CurveError, PiecewiseCubic, SignedCurvature, TightBounds, Torsion,
};
use common::Random;

fn points(count: usize, seed: u64) -> Vec<DVec3> {
    let mut random = Random(seed);
    (0..count).map(|_| random.solid()).collect()
}

/// The largest jump of the derivative of order `order` over the inner breaks, from differences of the jets of both sides.
fn jump<C: Differentiable<DVec3> + ?Sized>(curve: &C, order: usize) -> f64 {
    let breaks = curve.breaks();
    let pick = |u: f64| {
        let jet = curve.jet(u);
        [jet.point, jet.first, jet.second, jet.third][order]
    };
    let inner = &breaks[1..breaks.len() - 1];
    let jumps = inner.iter().map(|b| pick(b - 1e-9).distance(pick(*b)));
    jumps.fold(0.0, f64::max)
}

/// Derivatives are those of the points.
fn check_derivatives<C: Differentiable<DVec3> + ?Sized>(curve: &C, name: &str) {
    let breaks = curve.breaks();
    for w in breaks.windows(2) {
        for share in [0.2, 0.5, 0.77] {
            let (u, h) = (w[0] + (w[1] - w[0]) * share, 1e-4 * (w[1] - w[0]));
            let jet = curve.jet(u);
            assert_eq!(jet.point, curve.point(u), "{name}");
            assert!((curve.velocity(u) - jet.first).length() <= 1e-12 * (1.0 + jet.first.length()));
            let (a, b) = (curve.jet(u - h), curve.jet(u + h));
            for (exact, from) in [
                (jet.first, (b.point - a.point) / (2.0 * h)),
                (jet.second, (b.first - a.first) / (2.0 * h)),
                (jet.third, (b.second - a.second) / (2.0 * h)),
            ] {
                let scale = 1.0 + exact.length() + jet.third.length();
                assert!(
                    (exact - from).length() < 2e-6 * scale,
                    "{name} {u}: {exact} {from}"
                );
            }
        }
    }
}

/// Input that each family can use.
fn given(family: &Family, closed: bool) -> Given<Solid> {
    let count = if closed { 9 } else { 10 };
    let list = points(count, 5);
    Given {
        velocities: if family.velocities {
            points(count, 6)
        } else {
            Vec::new()
        },
        points: list,
        closed,
        ..Given::default()
    }
}

#[test]
fn every_family_makes_sound_curves() {
    for family in FAMILIES {
        for closed in [false, true] {
            if closed && !family.closes {
                continue;
            }
            let curve = family.make(&given(family, closed)).unwrap();
            let (start, end) = curve.domain();
            assert!(start < end, "{}", family.name);
            assert_eq!(curve.is_closed(), closed, "{}", family.name);
            check_derivatives(&*curve, family.name);
            assert!(jump(&*curve, 0) < 1e-7, "{}", family.name);
            // Outside the domain: ends, or around.
            if closed {
                assert_eq!(curve.point(start), curve.point(end), "{}", family.name);
                let around = curve.point(end + 0.25).distance(curve.point(start + 0.25));
                assert!(around < 1e-12, "{}", family.name);
            } else {
                assert_eq!(curve.point(start - 1.0), curve.point(start));
                assert_eq!(curve.point(end + 1.0), curve.point(end));
            }
            for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
                assert!(curve.point(odd).is_finite(), "{} {odd}", family.name);
                assert!(curve.jet(odd).second.is_finite(), "{} {odd}", family.name);
            }
            // Its pieces are the curve.
            for (a, b, piece) in curve.bezier_pieces() {
                for x in [0.0, 0.3, 1.0] {
                    let (here, there) = (piece.point(x), curve.point(a + (b - a) * x));
                    assert!(here.distance(there) < 1e-9, "{} {a}", family.name);
                }
            }
            // The box holds the curve and is touched by it.
            let bounds = curve.tight_bounds();
            let mut seen = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            let steps = (0..=5000).map(|i| start + (end - start) * f64::from(i) / 5000.0);
            for u in steps.chain(curve.breaks()) {
                let p = curve.point(u);
                seen = (seen.0.min(p), seen.1.max(p));
            }
            assert!(
                (seen.0 - bounds.min).min_element() > -1e-12,
                "{}",
                family.name
            );
            assert!(
                (bounds.max - seen.1).min_element() > -1e-12,
                "{}",
                family.name
            );
            assert!(
                (seen.0 - bounds.min).max_element() < 1e-4,
                "{}",
                family.name
            );
            assert!(
                (bounds.max - seen.1).max_element() < 1e-4,
                "{}",
                family.name
            );
        }
    }
}

#[test]
fn every_family_refuses_bad_points() {
    for family in FAMILIES {
        let mut none = given(family, false);
        none.points.clear();
        none.velocities.clear();
        assert!(family.make(&none).is_err(), "{}", family.name);
        none.points.push(DVec3::ONE);
        assert!(family.make(&none).is_err(), "{}", family.name);
        for bad in [f64::NAN, f64::INFINITY] {
            let mut wrong = given(family, false);
            wrong.points[3].y = bad;
            let error = family.make(&wrong).err().unwrap();
            assert!(error.to_string().contains('3'), "{}: {error}", family.name);
        }
        // Repeated, collinear and huge points make a curve or an error, never NaN.
        for list in [
            vec![DVec3::ONE; 10],
            (0..10).map(|i| DVec3::X * f64::from(i / 3)).collect(),
            vec![DVec3::splat(1e300); 10],
        ] {
            let mut same = given(family, false);
            same.points = list;
            if let Ok(curve) = family.make(&same) {
                let (start, end) = curve.domain();
                for i in 0..=50 {
                    let jet = curve.jet(start + (end - start) * f64::from(i) / 50.0);
                    assert!(
                        jet.point.is_finite() && !jet.first.is_nan() && !jet.second.is_nan(),
                        "{}",
                        family.name
                    );
                }
            }
        }
        let mut unread = given(family, false);
        unread.numbers.push(("tensoin".to_owned(), 0.5));
        assert!(matches!(
            family.make(&unread),
            Err(CurveError::NotRead { .. })
        ));
    }
    assert!(family("no such family").is_none());
    let names: Vec<&str> = FAMILIES.iter().map(|f| f.name).collect();
    let mut unique = names.clone();
    unique.sort_unstable();
    unique.dedup();
    assert_eq!(unique.len(), names.len());
}

#[test]
fn interpolating_families_pass_their_points_exactly() {
    let list = points(9, 1);
    let velocities = points(9, 2);
    let times: Vec<f64> = [0.0, 0.1, 2.0, 2.5, 2.6, 7.0, 8.0, 9.5, 10.0].to_vec();
    let hermite = Hermite {
        times: Some(times.clone()),
        ..Hermite::new(list.clone(), velocities.clone())
    };
    let curve = hermite.curve().unwrap();
    for i in 0..9 {
        assert_eq!(curve.point(times[i]), list[i]);
        assert!((curve.velocity(times[i]) - velocities[i]).length() < 1e-11);
    }
    for spacing in [
        Spacing::Uniform,
        Spacing::Centripetal,
        Spacing::Chordal,
        Spacing::Power(0.3),
    ] {
        let curve = CatmullRom::new(list.clone())
            .spaced(spacing)
            .curve()
            .unwrap();
        for (i, p) in list.iter().enumerate() {
            assert_eq!(curve.point(i as f64), *p);
        }
    }
    let shape = Shape {
        tension: 0.3,
        continuity: -0.4,
        bias: 0.2,
    };
    let tcb = KochanekBartels {
        times: Some(times.clone()),
        ..KochanekBartels::new(list.clone(), shape)
    };
    let curve = tcb.curve().unwrap();
    for i in 0..9 {
        assert_eq!(curve.point(times[i]), list[i]);
    }
    let lagrange = Lagrange::at_nodes(times.clone(), list.clone()).unwrap();
    for i in 0..9 {
        assert_eq!(lagrange.point(times[i]), list[i]);
    }
    let four = FourPoint {
        points: list[..7].to_vec(),
        closed: false,
    }
    .curve()
    .unwrap();
    for (i, p) in list[..7].iter().enumerate() {
        assert!(four.point(i as f64 / 3.0).distance(*p) < 1e-14);
    }
}

#[test]
fn continuity_is_as_promised() {
    let list = points(9, 1);
    let whole = |curve: PiecewiseCubic<DVec3>| [jump(&curve, 1), jump(&curve, 2)];
    let [first, second] = whole(
        CatmullRom::new(list.clone())
            .spaced(Spacing::Uniform)
            .curve()
            .unwrap(),
    );
    assert!(first < 1e-6 && second > 0.1);
    let [first, second] = whole(BSpline::new(list.clone()).curve().unwrap());
    assert!(first < 1e-6 && second < 1e-6);
    let [first, _] = whole(
        BSpline {
            degree: 2,
            ..BSpline::new(list.clone())
        }
        .curve()
        .unwrap(),
    );
    assert!(first < 1e-6);
    let [first, _] = whole(
        KochanekBartels::new(
            list.clone(),
            Shape {
                tension: 0.5,
                continuity: 0.0,
                bias: 0.4,
            },
        )
        .curve()
        .unwrap(),
    );
    assert!(first < 1e-6);
    let times = vec![0.0, 0.1, 2.0, 2.5, 2.6, 7.0, 8.0, 9.5, 10.0];
    let timed = KochanekBartels {
        times: Some(times),
        ..KochanekBartels::new(list.clone(), Shape::default())
    };
    let [first, _] = whole(timed.curve().unwrap());
    assert!(first < 1e-5, "{first}");
    let corner = KochanekBartels::new(
        list.clone(),
        Shape {
            continuity: -1.0,
            ..Shape::default()
        },
    );
    assert!(whole(corner.curve().unwrap())[0] > 0.1);
    // Centripetal and chordal curves have continuous velocity by their knots.
    for spacing in [Spacing::Centripetal, Spacing::Chordal] {
        let generator = CatmullRom::new(list.clone()).spaced(spacing);
        let curve = PiecewiseCubic::with_breaks(
            generator.curve().unwrap().pieces().to_vec(),
            generator.knots().unwrap(),
            false,
        )
        .unwrap();
        assert!(jump(&curve, 1) < 1e-6);
    }
    // A B-spline of degree 5 is continuous to the fourth derivative; jets go to the third.
    let smooth = BSpline {
        degree: 5,
        ..BSpline::new(points(12, 3))
    }
    .pieces()
    .unwrap();
    assert!(jump(&smooth, 2) < 1e-6 && jump(&smooth, 3) < 1e-6);
    let clamped = BSpline::new(list.clone())
        .with_knots(Knots::Clamped)
        .curve()
        .unwrap();
    assert!(
        clamped.point(0.0).distance(list[0]) < 1e-15
            && clamped.point(6.0).distance(list[8]) < 1e-15
    );
}

#[test]
fn curves_are_local() {
    let list = points(12, 4);
    let mut moved = list.clone();
    moved[6] += dvec3(0.3, -0.2, 0.1);
    let spans_changed = |a: &PiecewiseCubic<DVec3>, b: &PiecewiseCubic<DVec3>| {
        let pairs = a.pieces().iter().zip(b.pieces());
        pairs.filter(|(x, y)| x != y).count()
    };
    let catmull = |p: &[DVec3]| CatmullRom::new(p.to_vec()).curve().unwrap();
    assert_eq!(spans_changed(&catmull(&list), &catmull(&moved)), 4);
    let bspline = |p: &[DVec3]| BSpline::new(p.to_vec()).curve().unwrap();
    assert_eq!(spans_changed(&bspline(&list), &bspline(&moved)), 4);
}

#[test]
fn blended_parabolas_are_uniform_catmull_rom_curves() {
    // Errata C20: with equal end rules, and closed.
    for closed in [false, true] {
        let list = points(8, 9);
        let blended = BlendedParabolas {
            points: list.clone(),
            closed,
        }
        .curve()
        .unwrap();
        let catmull = CatmullRom {
            ends: Ends::Parabola,
            closed,
            ..CatmullRom::new(list).spaced(Spacing::Uniform)
        };
        let catmull = catmull.curve().unwrap();
        for (a, b) in blended.pieces().iter().zip(catmull.pieces()) {
            for (x, y) in a.0.iter().zip(&b.0) {
                assert!(x.distance(*y) < 1e-14);
            }
        }
    }
}

#[test]
fn end_rules_of_catmull_rom() {
    let list = vec![
        dvec2(0.0, 0.0),
        dvec2(1.0, 1.0),
        dvec2(3.0, 0.0),
        dvec2(4.0, 2.0),
    ];
    let curve = |ends| {
        CatmullRom {
            ends,
            ..CatmullRom::new(list.clone()).spaced(Spacing::Uniform)
        }
        .curve()
        .unwrap()
    };
    assert_eq!(curve(Ends::Reflected).velocity(0.0), dvec2(1.0, 1.0));
    let omitted = curve(Ends::Omitted);
    assert_eq!(omitted.domain(), (0.0, 1.0));
    assert_eq!((omitted.point(0.0), omitted.point(1.0)), (list[1], list[2]));
    // A parabola through points of a parabola is that parabola.
    let on: Vec<DVec2> = (0..3).map(f64::from).map(|x| dvec2(x, x * x)).collect();
    let curve = CatmullRom {
        ends: Ends::Parabola,
        ..CatmullRom::new(on).spaced(Spacing::Uniform)
    }
    .curve()
    .unwrap();
    for i in 0..=20 {
        let p = curve.point(f64::from(i) / 10.0);
        assert!((p.y - p.x * p.x).abs() < 1e-14);
    }
}

#[test]
fn bsplines_equal_the_recurrence_of_de_boor() {
    let list = points(9, 12);
    let knots = [
        0.0, 0.0, 0.5, 1.0, 2.0, 2.0, 3.5, 4.0, 4.0, 4.5, 5.0, 6.5, 7.0,
    ];
    for degree in [1_usize, 2, 3, 5] {
        let knots = knots[..list.len() + degree + 1 - if degree == 5 { 2 } else { 0 }].to_vec();
        let list = &list[..knots.len() - degree - 1];
        let spline = BSpline {
            points: list.to_vec(),
            degree,
            knots: Knots::Given(knots.clone()),
            closed: false,
        };
        let Ok(curve) = spline.pieces() else {
            panic!("degree {degree}: {:?}", spline.pieces());
        };
        let basis = |i: usize, u: f64| -> f64 {
            // Cox–de Boor, literally.
            fn n(i: usize, d: usize, u: f64, t: &[f64]) -> f64 {
                if d == 0 {
                    return if t[i] <= u && u < t[i + 1] { 1.0 } else { 0.0 };
                }
                let part =
                    |num: f64, den: f64, rest: f64| if den == 0.0 { 0.0 } else { num / den * rest };
                part(u - t[i], t[i + d] - t[i], n(i, d - 1, u, t))
                    + part(
                        t[i + d + 1] - u,
                        t[i + d + 1] - t[i + 1],
                        n(i + 1, d - 1, u, t),
                    )
            }
            n(i, degree, u, &knots)
        };
        let (start, end) = curve.domain();
        assert_eq!((start, end), (knots[degree], knots[list.len()]));
        for k in 0..100 {
            let u = start + (end - start) * f64::from(k) / 100.0;
            let expected: DVec3 = list.iter().enumerate().map(|(i, p)| *p * basis(i, u)).sum();
            assert!(
                curve.point(u).distance(expected) < 1e-12,
                "degree {degree} at {u}"
            );
        }
    }
}

#[test]
fn closed_bsplines_have_a_last_span() {
    // Errata C17.
    let list = points(5, 2);
    let curve = BSpline::new(list.clone()).closed().curve().unwrap();
    assert_eq!(curve.domain(), (0.0, 5.0));
    assert_eq!(curve.point(0.0), curve.point(5.0));
    assert!(curve.velocity(5.0 - 1e-9).distance(curve.velocity(0.0)) < 1e-7);
    assert!(curve.jet(5.0 - 1e-9).second.distance(curve.jet(0.0).second) < 1e-7);
    let expected = (list[0] + list[1] * 4.0 + list[2]) / 6.0;
    assert!(curve.point(0.0).distance(expected) < 1e-15);
}

#[test]
fn knots_are_checked() {
    let spline = |knots: Vec<f64>| {
        BSpline::new(points(4, 1))
            .with_knots(Knots::Given(knots))
            .curve()
    };
    assert!(matches!(
        spline(vec![0.0; 7]),
        Err(CurveError::Mismatch {
            needed: 8,
            found: 7,
            ..
        })
    ));
    assert!(matches!(
        spline(vec![0.0, 1.0, 2.0, 3.0, 2.5, 5.0, 6.0, 7.0]),
        Err(CurveError::Decreasing { index: 4, .. })
    ));
    assert!(matches!(
        spline(vec![0.0, 1.0, 2.0, 3.0, f64::NAN, 5.0, 6.0, 7.0]),
        Err(CurveError::NotFinite { index: 4, .. })
    ));
    assert!(spline(vec![0.0; 8]).is_err());
    assert!(matches!(
        BSpline {
            degree: 17,
            ..BSpline::new(points(30, 1))
        }
        .pieces(),
        Err(CurveError::OutOfRange { .. })
    ));
}

#[test]
fn errata_c1_bezier_matrix() {
    let p = [
        dvec2(0.0, 0.0),
        dvec2(1.0, 3.0),
        dvec2(4.0, 3.0),
        dvec2(5.0, 0.0),
    ];
    let curve = CubicBezier {
        points: p.to_vec(),
        closed: false,
    }
    .curve()
    .unwrap();
    let u: f64 = 0.3;
    let v = 1.0 - u;
    let expected =
        p[0] * v.powi(3) + p[1] * 3.0 * u * v * v + p[2] * 3.0 * u * u * v + p[3] * u.powi(3);
    assert!(curve.point(u).distance(expected) < 1e-15);
    assert_eq!(curve.to_bezier()[0], p);
    assert!(curve.velocity(0.0).distance((p[1] - p[0]) * 3.0) < 1e-15);
}

#[test]
fn families_convert_into_each_other() {
    let curve = KochanekBartels::new(
        points(6, 3),
        Shape {
            tension: 0.2,
            continuity: 0.5,
            bias: -0.3,
        },
    )
    .curve()
    .unwrap();
    let controls: Vec<DVec3> = {
        let pieces = curve.to_bezier();
        let mut list: Vec<DVec3> = pieces.iter().flat_map(|p| p[..3].to_vec()).collect();
        list.push(pieces[pieces.len() - 1][3]);
        list
    };
    let chain = CubicBezier {
        points: controls,
        closed: false,
    }
    .curve()
    .unwrap();
    let spline = BSpline::from(&curve).curve().unwrap();
    for i in 0..=500 {
        let u = f64::from(i) / 100.0;
        assert!(curve.point(u).distance(chain.point(u)) < 1e-14);
        assert!(curve.point(u).distance(spline.point(u)) < 1e-14);
        assert!(curve.velocity(u).distance(spline.velocity(u)) < 1e-12);
    }
}

#[test]
fn parts_and_splits_are_the_curve() {
    for closed in [false, true] {
        let curve = CatmullRom {
            closed,
            ..CatmullRom::new(points(6, 8))
        }
        .curve()
        .unwrap();
        let part = curve.part(1.25, 3.5).unwrap();
        assert_eq!(part.domain(), (1.25, 3.5));
        for i in 0..=30 {
            let u = 1.25 + 2.25 * f64::from(i) / 30.0;
            assert!(part.point(u).distance(curve.point(u)) < 1e-14);
            assert!(part.velocity(u).distance(curve.velocity(u)) < 1e-12);
        }
        let (a, b) = curve.split(2.0).unwrap();
        assert_eq!(
            (a.domain(), b.domain()),
            ((0.0, 2.0), (2.0, curve.domain().1))
        );
        assert_eq!(a.point(2.0), b.point(2.0));
        let back = curve.reversed();
        let end = curve.domain().1;
        for i in 0..=30 {
            let u = end * f64::from(i) / 30.0;
            assert!(back.point(u).distance(curve.point(end - u)) < 1e-14);
        }
        let over = curve.part(4.5, 7.25);
        if closed {
            let over = over.unwrap();
            assert!(over.point(7.0).distance(curve.point(1.0)) < 1e-14);
            assert!(over.point(7.25).distance(curve.point(1.25)) < 1e-14);
        } else {
            assert!(over.is_err());
        }
        assert!(
            curve.part(2.0, 2.0).is_err()
                && curve.part(-1.0, 2.0).is_err()
                && curve.split(0.0).is_err()
        );
    }
    let bezier = Bezier::new(points(7, 4)).unwrap();
    let part = bezier.part(0.25, 0.75).unwrap();
    let raised = bezier.raised().unwrap();
    for i in 0..=20 {
        let t = f64::from(i) / 20.0;
        assert!(part.point(t).distance(bezier.point(0.25 + 0.5 * t)) < 1e-14);
        assert!(raised.point(t).distance(bezier.point(t)) < 1e-14);
    }
}

#[test]
fn lagrange_reproduces_polynomials() {
    let nodes = vec![-1.0, -0.3, 0.1, 0.7, 1.4, 2.0];
    let at = |x: f64| dvec3(x.powi(5) - x, 3.0 * x * x, 1.0 - x.powi(3));
    let curve = Lagrange::at_nodes(nodes.clone(), nodes.iter().map(|x| at(*x)).collect()).unwrap();
    for i in 0..=60 {
        let x = -1.0 + f64::from(i) / 20.0;
        assert!(curve.point(x).distance(at(x)) < 1e-12);
        let first = dvec3(5.0 * x.powi(4) - 1.0, 6.0 * x, -3.0 * x * x);
        assert!(curve.velocity(x).distance(first) < 1e-10);
        assert!(curve.to_bezier().point((x + 1.0) / 3.0).distance(at(x)) < 1e-11);
    }
    assert!(matches!(
        Lagrange::at_nodes(vec![0.0, 1.0, 1.0], points(3, 1)),
        Err(CurveError::NotIncreasing { index: 2, .. })
    ));
    assert!(Lagrange::new(points(40, 1)).is_err());
    // Many even nodes: the largest allowed still passes its points.
    let many = Lagrange::new(points(33, 6)).unwrap();
    assert!((0..33).all(|i| many.point(f64::from(i)) == points(33, 6)[i as usize]));
}

#[test]
fn curvature_and_torsion_of_a_helix() {
    // A fine Hermite helix: κ = a/(a² + b²), τ = b/(a² + b²).
    let (a, b) = (2.0, 0.5);
    let angles: Vec<f64> = (0..=200).map(|i| 0.05 * f64::from(i)).collect();
    let helix = Hermite {
        times: Some(angles.clone()),
        ..Hermite::new(
            angles
                .iter()
                .map(|t| dvec3(a * t.cos(), a * t.sin(), b * t))
                .collect(),
            angles
                .iter()
                .map(|t| dvec3(-a * t.sin(), a * t.cos(), b))
                .collect(),
        )
    };
    let curve = helix.curve().unwrap();
    let whole = a * a + b * b;
    for u in [1.025, 4.475] {
        assert!((curve.curvature(u).unwrap() - a / whole).abs() < 1e-3);
        assert!((curve.torsion(u).unwrap() - b / whole).abs() < 1e-2);
        let centre = curve.curvature_vector(u).unwrap();
        assert!(centre.dot(dvec3(-u.cos(), -u.sin(), 0.0)) > 0.99 * centre.length());
    }
    let arc = CatmullRom::new(
        (0..9)
            .map(|i| DVec2::from_angle(0.3 * f64::from(i)) * 2.0)
            .collect(),
    )
    .curve()
    .unwrap();
    assert!((arc.signed_curvature(4.0).unwrap() - 0.5).abs() < 0.05);
    assert!((arc.reversed().signed_curvature(4.0).unwrap() + 0.5).abs() < 0.05);
    let still = PiecewiseCubic::<Plane>::new(
        vec![Cubic([DVec2::ONE, DVec2::ZERO, DVec2::ZERO, DVec2::ZERO])],
        false,
    )
    .unwrap();
    assert_eq!(still.curvature(0.5), None);
    assert_eq!(still.signed_curvature(0.5), None);
}

#[test]
fn breaks_are_checked() {
    let piece = Cubic([DVec2::ZERO, DVec2::ONE, DVec2::ZERO, DVec2::ZERO]);
    let make = |breaks: Vec<f64>| PiecewiseCubic::with_breaks(vec![piece; 2], breaks, false);
    assert!(make(vec![0.0, 1.0]).is_err());
    assert!(matches!(
        make(vec![0.0, 2.0, 2.0]),
        Err(CurveError::NotIncreasing { index: 2, .. })
    ));
    assert!(make(vec![0.0, 1.0, f64::INFINITY]).is_err());
    assert!(make(vec![0.0, 1e-100, 1.0]).is_err());
    assert!(PiecewiseCubic::<Plane>::new(Vec::new(), false).is_err());
}

#[cfg(feature = "serde")]
#[test]
fn curves_are_written_and_read() {
    let curve = KochanekBartels {
        times: Some(vec![0.0, 0.5, 2.0, 3.0]),
        ..KochanekBartels::new(points(4, 3), Shape::default())
    };
    let curve = curve.curve().unwrap();
    // The reader of numbers is off by a rounding at most.
    let text = serde_json::to_string(&curve).unwrap();
    let read: PiecewiseCubic<DVec3> = serde_json::from_str(&text).unwrap();
    assert_eq!(read.domain(), curve.domain());
    for i in 0..=30 {
        let u = f64::from(i) / 10.0;
        assert!(read.point(u).distance(curve.point(u)) < 1e-14);
    }
    let bezier = Bezier::new(points(4, 3)).unwrap();
    let text = serde_json::to_string(&bezier).unwrap();
    let read: Bezier<DVec3> = serde_json::from_str(&text).unwrap();
    assert!(read.point(0.3).distance(bezier.point(0.3)) < 1e-14);
    // What is no curve is refused.
    assert!(
        serde_json::from_str::<PiecewiseCubic<DVec3>>(
            r#"{"pieces":[],"end":[0,0,0],"closed":false}"#
        )
        .is_err()
    );
    assert!(serde_json::from_str::<Bezier<DVec3>>(r#"{"points":[[0,0,0]]}"#).is_err());
}

#[cfg(feature = "mint")]
#[test]
fn points_come_from_other_libraries() {
    let from: mint::Point3<f64> = mint::Point3 {
        x: 1.0,
        y: 2.0,
        z: 3.0,
    };
    assert_eq!(DVec3::from(from), dvec3(1.0, 2.0, 3.0));
}
