//! The worked cases: every operation built, at the tolerance of the case.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_catalog::Value;
use anamorph_core::{
    Affine, Average, Deformation, Pin, Plane, Sampling, Scaling, Solid, Space, Term, Terms,
    Transformation, fit, glam::dvec3,
};
use anamorph_curves::{Bezier, Indexed};
use anamorph_features::{ElementPair, Frame, FramePair, PointPair};
use anamorph_fields::falloffs::Wires;
use anamorph_fields::{AxisRange, Limit};
use anamorph_tests::cases::{Case, affine, all, field, matrix, number, numbers, point, rows};
use anamorph_transforms::{Composed, Rotational};
use anamorph_warps::barr::{AxisFrame, Course, bend::Bend, taper::Taper};
use anamorph_warps::features::vortex::Vortex;
use anamorph_warps::grids::{Between, GridWarp};
use anamorph_warps::lattices::bernstein::BernsteinLattice;
use anamorph_warps::lattices::bspline::{BsplineLattice, Knots};
use anamorph_warps::lattices::{Grid, frames::FrameLattice};
use anamorph_warps::lines::{WeightConstants, global, local};
use anamorph_warps::meshes::{MeshWarp, Reaches, Uncovered};
use anamorph_warps::polynomials::PolynomialWarp;
use anamorph_warps::radial::{Kernel, RadialWarp};
use anamorph_warps::wires::{Along, ContinuousWires, Wire};
use std::sync::Arc;

/// Direct manipulation: a lattice fitted to pins.
fn direct<S: Space>(case: &Case) -> usize {
    let grid: Grid<S> = grid(&case.params);
    let still = BernsteinLattice::construct(grid.clone(), vec![S::ZERO; grid.len()]).unwrap();
    let pairs = rows(&case.params["source"])
        .into_iter()
        .zip(rows(&case.params["target"]));
    let pins: Vec<Pin<S>> = pairs
        .map(|(source, target)| Pin {
            source: point(&source),
            target: point(&target),
            weight: 1.0,
        })
        .collect();
    let moves = fit(&still, grid.len(), &pins, 0.0).unwrap();
    case.check(&BernsteinLattice::construct(grid, moves).unwrap())
}

fn scaling(method: &Value) -> Scaling {
    match method.as_str().unwrap() {
        "displacement" => Scaling::Displacement,
        "composition" => Scaling::Composition,
        other => panic!("{other}"),
    }
}

fn transformation<S: Rotational>(
    affine: Affine<S>,
    centre: S,
    scaling: Scaling,
) -> Box<dyn Transformation<S>> {
    match scaling {
        Scaling::Displacement => Box::new(affine),
        Scaling::Composition => Box::new(Composed::new(affine, centre).unwrap()),
    }
}

/// A transformation scaled twice: `t·T`, scaled again by whatever strength is asked for.
struct Partly<S: Space>(Box<dyn Transformation<S>>, f64);
impl<S: Space> Transformation<S> for Partly<S> {
    fn affine(&self) -> Affine<S> {
        self.0.scaled(self.1)
    }
    fn scaled(&self, strength: f64) -> Affine<S> {
        self.0.scaled(self.1 * strength)
    }
    fn scaling(&self) -> Scaling {
        self.0.scaling()
    }
}

/// The weighted average at strength 1, blended with the identity: way 1 of varying a warp over time.
struct Blended<S: Space>(Terms<S>, f64);
impl<S: Space> Deformation<S> for Blended<S> {
    fn map(&self, site: &anamorph_core::Site<S>) -> S {
        site.point + (self.0.map(site) - site.point) * self.1
    }
    fn facts(&self) -> anamorph_core::Facts<S> {
        self.0.facts()
    }
}

/// Terms of the framework cases, their strengths times `strength`, their transformations scaled by `part`.
fn terms<S: Rotational>(params: &Value, strength: f64, part: f64) -> Terms<S> {
    let list = params["terms"].as_array().unwrap();
    let terms = list.iter().map(|term| {
        let (map, centre) = affine::<S>(term);
        let whole = transformation(map, centre, scaling(&term["method"]));
        Term {
            transformation: Box::new(Partly(whole, part)),
            strength: field(&term["s"], centre, strength),
            weight: field(&term["w"], centre, 1.0),
        }
    });
    let terms = Terms::new(terms.collect());
    match params.get("ambient") {
        Some(ambient) => terms.with_average(Average::Ambient(number(ambient))),
        None => terms,
    }
}

fn at_time<S: Rotational>(case: &Case) -> usize {
    let (params, t) = (&case.params, number(&case.params["t"]));
    match case.params["way"].as_u64().unwrap() {
        1 => case.check(&Blended::<S>(terms(params, 1.0, 1.0), t)),
        2 => case.check(&terms::<S>(params, t, 1.0)),
        // s·(t·T) = (s t)·T: ways 2 and 3 coincide (errata F19).
        3 => case.check(&terms::<S>(params, t, 1.0)) + case.check(&terms::<S>(params, 1.0, t)),
        other => panic!("way {other}"),
    }
}

fn grid<S: Space>(params: &Value) -> Grid<S> {
    let axes = rows(&params["axes"]);
    let shape: Vec<usize> = numbers(&params["shape"])
        .iter()
        .map(|&n| n as usize)
        .collect();
    let edges = anamorph_core::Linear::from_columns(|i: usize| point::<S>(&axes[i]));
    Grid::new(point(&numbers(&params["origin"])), edges, &shape).unwrap()
}

fn displacements<S: Space>(params: &Value) -> Vec<S> {
    rows(&params["disp"]).iter().map(|row| point(row)).collect()
}

fn bspline<S: Space>(case: &Case) -> usize {
    let knots = match case.params["knots"].as_str().unwrap() {
        "uniform" => Knots::Uniform,
        "clamped" => Knots::Clamped,
        other => panic!("{other}"),
    };
    let degree = case.params["degree"].as_u64().unwrap() as usize;
    let lattice = BsplineLattice::construct(
        grid(&case.params),
        degree,
        knots,
        displacements::<S>(&case.params),
    );
    case.check(&lattice.unwrap())
}

fn lattice_frames<S: Rotational>(case: &Case) -> usize {
    let frames = case.params["frames"].as_array().unwrap().iter();
    for scaling in [Scaling::Displacement, Scaling::Composition] {
        let list = frames.clone().map(|frame| {
            let (map, centre) = affine::<S>(frame);
            transformation(map, centre, scaling)
        });
        let lattice = FrameLattice::construct(grid(&case.params), list.collect()).unwrap();
        case.check(&lattice);
    }
    case.dimension()
}

fn frames<S: Rotational>(case: &Case) -> usize {
    let method = scaling(&case.params["method"]);
    let list = case.params["features"].as_array().unwrap();
    let terms = list.iter().map(|feature| {
        let frame = |key: &str| {
            let value = &feature[key];
            let origin = point::<S>(&numbers(&value["O"]));
            // Basis vectors are the rows of `B`.
            let basis = matrix::<S>(&value["B"]);
            Frame::new(origin, anamorph_core::Linear::transposed(&basis)).unwrap()
        };
        let pair = FramePair {
            source: frame("f"),
            target: frame("fs"),
        };
        let centre = pair.source.origin();
        let hat = |key: &str| {
            let radius = number(&feature[key]);
            Box::new(anamorph_fields::Radial::new(centre, radius, Wires).unwrap())
        };
        Term {
            transformation: transformation(pair.affine().unwrap(), centre, method),
            strength: hat("rs"),
            weight: hat("rw"),
        }
    });
    case.check(&Terms::new(terms.collect()))
}

fn barr(case: &Case) -> usize {
    let params = &case.params;
    let vector = |key: &str| point::<Solid>(&numbers(&params[key]));
    let (axis, reference) = (vector("axis"), vector("ref"));
    match case.op.as_str() {
        "barr.taper" => {
            let frame = AxisFrame::new(vector("origin"), axis, Some(reference)).unwrap();
            let course = Course::Polynomial(numbers(&params["f"]));
            let taper = Taper::construct(frame, course, None, Scaling::Displacement);
            case.check(&taper.unwrap())
        }
        "barr.bend" => {
            // The case bends towards the third axis of (ref, axis × ref, axis).
            let toward = axis.cross(reference);
            let frame = AxisFrame::new(vector("origin"), axis, Some(toward)).unwrap();
            let value = |key: &str| number(&params[key]);
            let range = AxisRange::new(value("zmin"), value("zmax"), Limit::Clamp).unwrap();
            let (k, centre) = (value("k"), value("z0"));
            let bend = Bend::construct(frame, k, centre, Some(range), Scaling::Composition);
            case.check(&bend.unwrap())
        }
        other => panic!("{other}"),
    }
}

fn vortex(case: &Case) -> usize {
    let params = &case.params;
    let vector = |key: &str| {
        let n = numbers(&params[key]);
        dvec3(n[0], n[1], n[2])
    };
    let warp = Vortex::construct(
        vector("centre"),
        vector("axis"),
        number(&params["angle"]),
        number(&params["R"]),
        &Wires,
        Scaling::Composition,
    );
    case.check(&warp.unwrap())
}

fn lines(case: &Case) -> usize {
    let list = case.params["lines"].as_array().unwrap().iter();
    let list = list.map(|line| {
        let ends = |from: &str, to: &str| [from, to].map(|key| point(&numbers(&line[key])));
        let pair = ElementPair::of_corners(&ends("P", "Q"), &ends("Ps", "Qs")).unwrap();
        let [a, b, p] = ["a", "b", "p"].map(|key| number(&line[key]));
        (pair, WeightConstants { a, b, p })
    });
    let list: Vec<_> = list.collect();
    let warp = match case.params["variant"].as_str().unwrap() {
        "local" => local::construct(&list, Scaling::Displacement),
        "global" => global::construct(&list, Scaling::Displacement),
        other => panic!("{other}"),
    };
    case.check::<Plane>(&warp.unwrap())
}

fn mesh(case: &Case) -> usize {
    let params = &case.params;
    let points =
        |key: &str| -> Vec<Solid> { rows(&params[key]).iter().map(|r| point(r)).collect() };
    let edges = params["edges"].as_array().unwrap().iter();
    let edges: Vec<[u32; 2]> = edges
        .map(|edge| {
            let end = |i: usize| u32::try_from(edge[i].as_u64().unwrap()).unwrap();
            [end(0), end(1)]
        })
        .collect();
    let [alpha, beta, gamma, mu] = ["alpha", "beta", "gamma", "mu"].map(|key| number(&params[key]));
    let reaches = Reaches {
        alpha,
        beta,
        gamma,
        mu,
    };
    let (source, target) = (points("P"), points("Ps"));
    let warp = MeshWarp::construct(&source, &target, &edges, reaches, Uncovered::Stay);
    case.check(&warp.unwrap())
}

fn grid_of_nodes(case: &Case) -> usize {
    let params = &case.params;
    let moves = displacements::<Plane>(params);
    let (columns, rows) = (numbers(&params["xs"]), numbers(&params["ys"]));
    case.check(&GridWarp::construct(columns, rows, Between::Bilinear, moves).unwrap())
}

fn pairs<S: Space>(params: &Value) -> Vec<PointPair<S>> {
    let points = |key: &str| rows(&params[key]).into_iter().map(|row| point::<S>(&row));
    let pairs = points("P").zip(points("Ps"));
    let pairs = pairs.map(|(source, target)| PointPair { source, target });
    pairs.collect()
}

fn polynomial<S: Space>(case: &Case) -> usize {
    let degree = case.params["degree"].as_u64().unwrap() as usize;
    case.check(&PolynomialWarp::construct(pairs::<S>(&case.params), degree).unwrap())
}

fn radial<S: Space>(case: &Case) -> usize {
    let params = &case.params;
    let (kernel, affine) = match params.get("kernel").and_then(Value::as_str) {
        None => (Kernel::ThinPlate, true),
        Some("multiquadric") => {
            let width = number(&params["c"]);
            (Kernel::Multiquadric { width }, params["affine"] == true)
        }
        Some(other) => panic!("{other}"),
    };
    case.check(&RadialWarp::construct(pairs::<S>(params), kernel, affine, 0.0).unwrap())
}

fn wires<S: Rotational>(case: &Case) -> Vec<Wire<S>> {
    let list = case.params["wires"].as_array().unwrap();
    let curve = |value: &Value| {
        let points: Vec<S> = rows(value).iter().map(|row| point(row)).collect();
        Arc::new(Indexed::new(Box::new(Bezier::new(points).unwrap())))
    };
    let wires = list.iter().map(|wire| Wire {
        scale: Along::constant(number(&wire["x"])),
        exponent: number(&wire["m"]),
        ..Wire::new(curve(&wire["C"]), curve(&wire["Cs"]), number(&wire["r"]))
    });
    wires.collect()
}

fn run<S: Rotational>(case: &Case) -> usize {
    match case.op.as_str() {
        "framework.evaluate" => case.check(&terms::<S>(&case.params, 1.0, 1.0)),
        "framework.at_time" => at_time::<S>(case),
        "ffd.bernstein" => {
            let list = displacements::<S>(&case.params);
            case.check(&BernsteinLattice::construct(grid(&case.params), list).unwrap())
        }
        "ffd.direct" => direct::<S>(case),
        "ffd.bspline" => bspline::<S>(case),
        "ffd.frames" => lattice_frames::<S>(case),
        "frames" => frames::<S>(case),
        "barr.taper" | "barr.bend" => barr(case),
        "vortex" => vortex(case),
        "feature_lines.beier_neely" => lines(case),
        "mesh_warp" => mesh(case),
        "ffd.bilinear_grid" => grid_of_nodes(case),
        "polynomial" => polynomial::<S>(case),
        "rbf" | "thin_plate" => radial::<S>(case),
        "wires.wires" => {
            let warp = anamorph_warps::wires::Wires::construct(wires::<S>(case), None);
            case.check(&warp.unwrap())
        }
        "wires.continuous_wires" => {
            let uniform =
                ContinuousWires::construct(wires::<S>(case), Sampling::Uniform(20_000), None);
            let adaptive =
                ContinuousWires::construct(wires::<S>(case), Sampling::Adaptive(1e-8), None);
            case.check(&adaptive.unwrap()) + case.check(&uniform.unwrap())
        }
        other => panic!("{}: no test computes {other}", case.id),
    }
}

#[test]
fn every_case_is_met() {
    // Those of curves have tests of their own.
    let mut cases = all();
    cases.retain(|case| !case.op.starts_with("curves."));
    assert!(cases.len() >= 16, "{}", cases.len());
    for case in &cases {
        let compared = match case.dimension() {
            2 => run::<Plane>(case),
            3 => run::<Solid>(case),
            other => panic!("{}: {other} coordinates", case.id),
        };
        assert!(compared > 0, "{}", case.id);
    }
}
