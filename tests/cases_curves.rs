//! Worked cases of curves, their lengths and the inverse.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::{Differentiable, Plane, Solid, Space};
use anamorph_curves::families::{
    BSpline, CatmullRom, CubicBezier, Generator, KochanekBartels, Lagrange, Shape, Spacing,
};
use anamorph_curves::{ArcLength, InverseArcLength, LengthTable, PiecewiseCubic};
use anamorph_tests::cases::{Case, all, number, numbers, point, rows};

fn points<S: Space>(case: &Case) -> Vec<S> {
    rows(&case.params["points"])
        .iter()
        .map(|row| point(row))
        .collect()
}

fn closed(case: &Case) -> bool {
    case.params
        .get("closed")
        .is_some_and(|flag| flag.as_bool().unwrap())
}

fn piecewise<S: Space>(case: &Case) -> PiecewiseCubic<S> {
    let mut points = points::<S>(case);
    let curve = match case.params["kind"].as_str().unwrap() {
        "catmull_rom" => CatmullRom {
            closed: closed(case),
            ..CatmullRom::new(points).spaced(Spacing::Uniform)
        }
        .curve(),
        "bezier" => CubicBezier {
            points,
            closed: false,
        }
        .curve(),
        "tcb" => {
            let of = |key: &str| number(&case.params[key]);
            let shape = Shape {
                tension: of("tension"),
                continuity: of("continuity"),
                bias: of("bias"),
            };
            KochanekBartels::new(points, shape).curve()
        }
        "bspline" => {
            // End points are there three times in all.
            let (first, last) = (points[0], points[points.len() - 1]);
            points.splice(0..0, [first; 2]);
            points.extend([last; 2]);
            BSpline::new(points).curve()
        }
        other => panic!("{}: no test computes {other}", case.id),
    };
    curve.unwrap()
}

fn row<S: Space>(p: S) -> Vec<f64> {
    (0..S::DIM).map(|axis| p.component(axis)).collect()
}

/// Points or derivatives at the parameters of the case.
fn evaluated<S: Space>(case: &Case, curve: &dyn Differentiable<S>) -> Vec<Vec<f64>> {
    let order = case.params.get("derivative").map_or(0.0, number);
    let rows = case.input();
    rows.iter()
        .map(|u| {
            let jet = curve.jet(u[0]);
            row(if order == 0.0 { jet.point } else { jet.first })
        })
        .collect()
}

fn run<S: Space>(case: &Case) -> usize {
    let found = match case.op.as_str() {
        "curves.eval" => evaluated::<S>(case, &piecewise(case)),
        "curves.catmull_rom_knots" => {
            let spacing = Spacing::Power(number(&case.params["alpha"]));
            let curve = CatmullRom::new(points::<S>(case)).spaced(spacing).curve();
            evaluated(case, &curve.unwrap())
        }
        "curves.lagrange" => {
            let nodes = numbers(&case.params["nodes"]);
            evaluated(case, &Lagrange::at_nodes(nodes, points::<S>(case)).unwrap())
        }
        "curves.length" => {
            let curve = piecewise::<S>(case);
            let table = LengthTable::new(&curve, 1e-12).unwrap();
            let to = |u: &Vec<f64>| vec![curve.length_between(0.0, u[0], 1e-12)];
            let from_table: Vec<Vec<f64>> = case
                .input()
                .iter()
                .map(|u| vec![table.length_to(u[0])])
                .collect();
            assert!(case.compare(&from_table) > 0);
            case.input().iter().map(to).collect()
        }
        "curves.parameter" => {
            // What counts is the length up to the parameter (errata C13); parameters are compared as well.
            let curve = piecewise::<S>(case);
            let table = LengthTable::new(&curve, 1e-12).unwrap();
            let asked = case.input();
            let found = asked.iter().map(|s| {
                let (u, single) = (table.parameter(s[0]), curve.parameter_at(s[0], 1e-12));
                for u in [u, single] {
                    let reached = curve.length_between(0.0, u, 1e-13);
                    assert!(
                        (reached - s[0]).abs() < 5e-12,
                        "{}: {reached} {}",
                        case.id,
                        s[0]
                    );
                }
                vec![u]
            });
            found.collect()
        }
        other => panic!("{}: no test computes {other}", case.id),
    };
    case.compare(&found)
}

#[test]
fn every_case_of_curves_is_met() {
    let elsewhere = ["curves.ease", "curves.smooth", "curves.rmf"];
    let mut met = 0;
    for case in all() {
        if !case.op.starts_with("curves.") || elsewhere.contains(&case.op.as_str()) {
            continue;
        }
        let compared = match rows(&case.params["points"])[0].len() {
            2 => run::<Plane>(&case),
            _ => run::<Solid>(&case),
        };
        assert!(compared > 0, "{}", case.id);
        met += 1;
    }
    assert!(met >= 12, "{met}");
}
