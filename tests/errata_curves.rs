//! Rows of the errata about curves and arc length, pinned by name: what the formulas are, and what they are not.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::{Curve, Differentiable};
use anamorph_curves::arc_length::methods::methods;
use anamorph_curves::arc_length::{closed, cubic_parameter_at};
use anamorph_curves::families::{
    BSpline, BlendedParabolas, CatmullRom, CubicBezier, Ends, Generator, Lagrange, Spacing,
};
use anamorph_curves::{ArcLength, Bezier, LengthTable};

/// C1: the cubic Bézier matrix; the printed one is Hermite's, which would not end at the last point.
#[test]
fn c1_bezier_matrix() {
    let p = [
        dvec2(0.0, 0.0),
        dvec2(1.0, 3.0),
        dvec2(4.0, 3.0),
        dvec2(5.0, 0.0),
    ];
    let rows = [
        [-1.0, 3.0, -3.0, 1.0],
        [3.0, -6.0, 3.0, 0.0],
        [-3.0, 3.0, 0.0, 0.0],
        [1.0, 0.0, 0.0, 0.0],
    ];
    let curve = CubicBezier {
        points: p.to_vec(),
        closed: false,
    }
    .curve()
    .unwrap();
    for i in 0..=20 {
        let u = f64::from(i) / 20.0;
        let powers = [u * u * u, u * u, u, 1.0];
        let mut expected = DVec2::ZERO;
        for (power, row) in powers.iter().zip(rows) {
            for (entry, point) in row.iter().zip(p) {
                expected += point * (power * entry);
            }
        }
        assert!(curve.point(u).distance(expected) < 1e-14);
    }
    // Hermite's matrix with the same four would start with the velocity p[2].
    assert!(curve.velocity(0.0).distance(p[2]) > 1.0);
}

/// C2: "first degree continuity" is C¹, not C²: Catmull–Rom's second derivative jumps.
#[test]
fn c2_first_degree_is_c1() {
    let points = vec![
        dvec2(0.0, 0.0),
        dvec2(1.0, 2.0),
        dvec2(3.0, 1.0),
        dvec2(4.0, 4.0),
    ];
    let curve = CatmullRom::new(points)
        .spaced(Spacing::Uniform)
        .curve()
        .unwrap();
    let (before, behind) = (curve.jet(1.0 - 1e-12), curve.jet(1.0));
    assert!(before.first.distance(behind.first) < 1e-9);
    assert!(before.second.distance(behind.second) > 1.0);
}

/// C3: Lagrange in barycentric form equals the product form, and holds at and next to nodes where that form divides by 0.
#[test]
fn c3_barycentric_lagrange() {
    let nodes = [0.0, 0.7, 1.0, 2.5, 3.0];
    let values = [
        dvec2(0.0, 1.0),
        dvec2(2.0, 0.0),
        dvec2(1.0, 1.0),
        dvec2(-1.0, 3.0),
        dvec2(0.0, 0.0),
    ];
    let curve = Lagrange::at_nodes(nodes.to_vec(), values.to_vec()).unwrap();
    for i in 0..=60 {
        let x = f64::from(i) / 20.0;
        let product = |j: usize| -> f64 {
            let others = (0..nodes.len()).filter(|k| *k != j);
            others
                .map(|k| (x - nodes[k]) / (nodes[j] - nodes[k]))
                .product()
        };
        let expected: DVec2 = (0..nodes.len()).map(|j| values[j] * product(j)).sum();
        assert!(curve.point(x).distance(expected) < 1e-12);
    }
    for (x, value) in nodes.iter().zip(values) {
        assert_eq!(curve.point(*x), value);
        assert!(curve.point(x + 1e-13).distance(value) < 1e-11);
    }
}

/// C11: the five methods of the slides and the closed forms agree.
#[test]
fn c11_five_methods_and_closed_forms() {
    let p = [dvec2(0.0, 0.0), dvec2(1.0, 2.0), dvec2(3.0, 0.0)];
    let exact = closed::quadratic(p);
    let curve = Bezier::new(p.to_vec()).unwrap();
    let mut names = Vec::new();
    for method in methods::<DVec2>() {
        let found = method.measure(&curve, 1e-6);
        assert!(
            found.converged && (found.length - exact).abs() <= 1e-6,
            "{}",
            method.name()
        );
        names.push(method.name());
    }
    assert_eq!(names.len(), 5);
    assert!((curve.length(1e-12) - exact).abs() < 1e-12);
    assert_eq!(closed::line(p[0], p[2]), 3.0);
}

/// C13: the tolerance is on length. Where the curve is slow, a tolerance on the parameter would be met long before.
#[test]
fn c13_tolerance_is_on_length() {
    // A near-cusp: parameters change fast where lengths do not, and the other way round.
    let p = [
        dvec2(0.0, 0.0),
        dvec2(1.0, 1.0),
        dvec2(1e-3, 1.0),
        dvec2(1.0, 0.0),
    ];
    let curve = Bezier::new(p.to_vec()).unwrap();
    let total = curve.length(1e-13);
    for accuracy in [1e-4, 1e-9] {
        let table = LengthTable::new(&curve, accuracy).unwrap();
        for i in 0..=200 {
            let s = total * f64::from(i) / 200.0;
            for u in [table.parameter(s), cubic_parameter_at(&p, s, accuracy)] {
                let reached = curve.length_between(0.0, u, 1e-13);
                assert!((reached - s).abs() <= accuracy + 1e-12, "{s}: {u}");
            }
        }
    }
}

/// C17: a B-spline lives on `[t_d, t_n]`, both ends included; a closed one has its last span.
#[test]
fn c17_bspline_domain() {
    let points: Vec<DVec2> = (0..6)
        .map(|i| dvec2(f64::from(i), f64::from(i * i % 5)))
        .collect();
    let open = BSpline::new(points.clone()).curve().unwrap();
    assert_eq!(open.domain(), (0.0, 3.0));
    assert!(
        open.point(3.0)
            .distance((points[3] + points[4] * 4.0 + points[5]) / 6.0)
            < 1e-14
    );
    let closed = BSpline::new(points.clone()).closed().curve().unwrap();
    assert_eq!(closed.domain(), (0.0, 6.0));
    assert!(closed.point(5.5).is_finite());
    assert_eq!(closed.point(6.0), closed.point(0.0));
}

/// C20: coincident points make a constant span with null tangents; blended parabolas are Catmull–Rom with equal end rules
/// only.
#[test]
fn c20_catmull_rom() {
    let points = vec![
        dvec2(0.0, 0.0),
        dvec2(1.0, 2.0),
        dvec2(1.0, 2.0),
        dvec2(3.0, 0.0),
    ];
    for spacing in [Spacing::Centripetal, Spacing::Chordal] {
        let curve = CatmullRom::new(points.clone())
            .spaced(spacing)
            .curve()
            .unwrap();
        assert!((0..=10).all(|i| curve.point(1.0 + f64::from(i) / 10.0) == points[1]));
        assert_eq!(curve.velocity(1.0), DVec2::ZERO);
        assert_eq!(curve.velocity(2.0), DVec2::ZERO);
    }
    let blended = BlendedParabolas {
        points: points.clone(),
        closed: false,
    }
    .curve()
    .unwrap();
    let end = |ends| {
        CatmullRom {
            ends,
            ..CatmullRom::new(points.clone()).spaced(Spacing::Uniform)
        }
        .curve()
        .unwrap()
    };
    assert!(blended.point(0.5).distance(end(Ends::Parabola).point(0.5)) < 1e-14);
    assert!(blended.point(0.5).distance(end(Ends::Reflected).point(0.5)) > 0.1);
    assert!(blended.point(1.5).distance(end(Ends::Reflected).point(1.5)) < 1e-14);
}
