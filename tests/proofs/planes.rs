//! B20: polynomials of their degree are reproduced. B24: nodes of grids are met, cells are what they say.

use anamorph_core::{
    Bounds, Deformation, Plane, Site, Smoothness, Solid, Space, difference_jacobian, glam::dvec2,
};
use anamorph_features::PointPair;
use anamorph_tests::measure::{linear_distance, same_bits};
use anamorph_tests::random::Random;
use anamorph_warps::grids::{Between, GridError, GridWarp};
use anamorph_warps::lattices::{Grid, bernstein::BernsteinLattice};
use anamorph_warps::polynomials::{PolynomialError, PolynomialWarp};

/// A random polynomial map, by Horner's rule over all products of coordinates; its degree is `degree`.
fn polynomial<S: Space>(random: &mut Random, degree: u32) -> impl Fn(S) -> S + use<S> {
    let mut terms = Vec::new();
    for total in 0..=degree {
        for _ in 0..4 {
            // A product of `total` linear forms.
            let forms: Vec<(S, f64)> = (0..total)
                .map(|_| (random.direction::<S>(), random.between(-0.5, 0.5)))
                .collect();
            terms.push((forms, random.vector::<S>()));
        }
    }
    move |p| {
        terms.iter().fold(S::ZERO, |sum, (forms, vector)| {
            sum + *vector * forms.iter().map(|(n, c)| n.dot(p) + c).product::<f64>()
        })
    }
}

fn b20_reproduces<S: Space>() {
    let mut random = Random::new(200);
    for degree in 1..=5 {
        for lower in 1..=degree {
            let map = polynomial::<S>(&mut random, lower as u32);
            let pairs: Vec<PointPair<S>> = (0..90)
                .map(|_| {
                    let source = S::from_fn(|_| random.between(-1.0, 1.0));
                    PointPair {
                        source,
                        target: map(source),
                    }
                })
                .collect();
            let warp = PolynomialWarp::construct(pairs, degree).unwrap();
            for _ in 0..100 {
                let p = S::from_fn(|_| random.between(-1.2, 1.2));
                let (found, wanted) = (warp.map(&Site::anywhere(p)), map(p));
                assert!(
                    (found - wanted).largest() < 1e-10,
                    "degree {degree}: {found:?}, {wanted:?}"
                );
                let site = Site::anywhere(p);
                let jacobian = warp.jacobian(&site, 2.0).unwrap();
                let differences = difference_jacobian(&warp, &site, 2.0).unwrap();
                assert!(linear_distance::<S>(&jacobian, &differences) < 1e-7);
            }
        }
    }
}

#[test]
fn b20_polynomials_of_the_degree_are_reproduced() {
    b20_reproduces::<Plane>();
    b20_reproduces::<Solid>();
}

/// The residuals of least squares are across every monomial.
#[test]
fn b20_residuals_are_across_the_monomials() {
    let mut random = Random::new(201);
    // Far from the origin, to see that coordinates are about the middle.
    let middle = dvec2(3e3, -8e2);
    let pairs: Vec<PointPair<Plane>> = (0..40)
        .map(|_| {
            let source = middle + random.vector::<Plane>();
            let target = source + random.vector::<Plane>() * 0.3;
            PointPair { source, target }
        })
        .collect();
    let warp = PolynomialWarp::construct(pairs.clone(), 3).unwrap();
    for i in 0..=3 {
        for j in 0..=3 - i {
            let sum = pairs.iter().fold(Plane::ZERO, |sum, pair| {
                let p = pair.source - middle;
                let residual = warp.map(&Site::anywhere(pair.source)) - pair.target;
                sum + residual * p.x.powi(i) * p.y.powi(j)
            });
            assert!(sum.largest() < 1e-10, "{i}, {j}: {sum:?}");
        }
    }
    assert!(warp.condition() < 1e4);
}

#[test]
fn b20_what_points_leave_open_is_told() {
    let pair = |x: f64, y: f64| PointPair {
        source: dvec2(x, y),
        target: dvec2(y, x),
    };
    let construct = PolynomialWarp::<Plane>::construct;
    let five = (0..5).map(|i| pair(f64::from(i), f64::from(i * i)));
    let too_few = PolynomialError::TooFew {
        points: 5,
        needed: 6,
        degree: 2,
    };
    assert_eq!(construct(five.collect(), 2), Err(too_few));
    // Points of a circle leave one of six coefficients open, and determine all of degree 1.
    let circle: Vec<_> = (0..20)
        .map(|i| f64::from(i) * 0.3)
        .map(|angle| pair(5.0 + 2.0 * angle.cos(), 2.0 * angle.sin() - 7.0))
        .collect();
    let error = construct(circle.clone(), 2).unwrap_err();
    assert!(
        matches!(error, PolynomialError::Dependent { rank: 5, needed: 6, condition, .. } if condition > 1e11),
        "{error}"
    );
    assert!(construct(circle, 1).is_ok());
    let same = vec![pair(1.0, 2.0); 12];
    assert!(matches!(
        construct(same, 1),
        Err(PolynomialError::Dependent { rank: 1, .. })
    ));
}

/// A grid of uneven columns and rows, all nodes moved.
fn grid(random: &mut Random, columns: usize, rows: usize, between: Between) -> GridWarp {
    let mut uneven = |count: usize| {
        let mut at = random.between(-1.0, 1.0);
        let list = (0..count).map(|_| {
            at += random.between(0.05, 1.0);
            at
        });
        list.collect::<Vec<f64>>()
    };
    let (columns, rows) = (uneven(columns), uneven(rows));
    let moves = (0..columns.len() * rows.len()).map(|_| random.vector::<Plane>() * 0.2);
    let moves = moves.collect();
    GridWarp::construct(columns, rows, between, moves).unwrap()
}

fn nodes(warp: &GridWarp) -> Vec<(Plane, Plane)> {
    use anamorph_core::Warp;
    warp.conditions()
        .iter()
        .map(|c| (c.source, c.target))
        .collect()
}

#[test]
fn b24_nodes_are_met_to_the_bit() {
    let mut random = Random::new(240);
    for between in [Between::Bilinear, Between::Smooth] {
        for (columns, rows) in [(2, 2), (2, 5), (3, 3), (7, 4), (20, 31)] {
            let warp = grid(&mut random, columns, rows, between);
            let nodes = nodes(&warp);
            assert_eq!(nodes.len(), columns * rows);
            for (source, target) in nodes {
                assert!(
                    same_bits(warp.map(&Site::anywhere(source)), target),
                    "{source:?}"
                );
            }
        }
    }
}

#[test]
fn b24_a_cell_is_the_lattice_of_degree_one() {
    let mut random = Random::new(241);
    for between in [Between::Bilinear, Between::Smooth] {
        let (low, high) = (dvec2(-0.3, 2.0), dvec2(1.7, 2.5));
        let moves: Vec<Plane> = (0..4).map(|_| random.vector::<Plane>() * 0.3).collect();
        let warp = GridWarp::construct(
            vec![low.x, high.x],
            vec![low.y, high.y],
            between,
            moves.clone(),
        )
        .unwrap();
        let box_of = Grid::around(Bounds::new(low, high), &[2, 2]).unwrap();
        let lattice = BernsteinLattice::construct(box_of, moves).unwrap();
        for _ in 0..500 {
            let p = dvec2(random.between(-0.4, 1.8), random.between(1.9, 2.6));
            let site = Site::anywhere(p);
            let (a, b) = (warp.map(&site), lattice.map(&site));
            // A cubic with the slopes of its only chord is that chord.
            assert!(
                (a - b).largest() < 1e-14,
                "{between:?} at {p:?}: {a:?}, {b:?}"
            );
        }
        assert_eq!(warp.facts().inside, Smoothness::Smooth);
    }
}

/// Affine edits of the nodes are affine maps between them; a smooth grid has no creases, a bilinear one has.
#[test]
fn b24_affine_edits_and_creases() {
    let mut random = Random::new(242);
    for between in [Between::Bilinear, Between::Smooth] {
        let edit = random.affine::<Plane>();
        let (columns, rows) = (vec![0.0, 0.1, 0.7, 1.0, 2.0], vec![-1.0, 0.0, 0.3, 1.0]);
        let moves = GridWarp::nodes(&columns, &rows);
        let moves = moves.iter().map(|&p| edit.displacement(p)).collect();
        let warp = GridWarp::construct(columns, rows, between, moves).unwrap();
        for _ in 0..300 {
            let p = dvec2(random.between(0.0, 2.0), random.between(-1.0, 1.0));
            let site = Site::anywhere(p);
            assert!((warp.map(&site) - edit.apply(p)).largest() < 1e-12);
            let jacobian = warp.jacobian(&site, 1.0).unwrap();
            assert!(linear_distance::<Plane>(&jacobian, &edit.linear) < 1e-11);
        }
        let warp = grid(&mut random, 6, 5, between);
        let mut crease = 0.0_f64;
        for (node, _) in nodes(&warp) {
            let side = |x: f64, y: f64| {
                warp.jacobian(&Site::anywhere(node + dvec2(x, y) * 1e-9), 1.0)
                    .unwrap()
            };
            let inner = warp.facts().support.contains(node + dvec2(1e-6, 1e-6))
                && warp.facts().support.contains(node - dvec2(1e-6, 1e-6));
            if inner {
                crease = crease.max(linear_distance::<Plane>(&side(1.0, 1.0), &side(-1.0, -1.0)));
            }
        }
        assert_eq!(crease < 1e-6, between == Between::Smooth, "{crease}");
    }
}

#[test]
fn b24_bad_grids_are_refused() {
    let still = |count| vec![Plane::ZERO; count];
    let construct = |columns: &[f64], rows: &[f64], count| {
        GridWarp::construct(
            columns.to_vec(),
            rows.to_vec(),
            Between::Smooth,
            still(count),
        )
        .unwrap_err()
    };
    let good = [0.0, 1.0];
    let order = |what, index| GridError::Order { what, index };
    assert_eq!(construct(&[0.0, 0.0], &good, 4), order("columns", 1));
    assert_eq!(construct(&good, &[f64::NAN, 1.0], 4), order("rows", 0));
    assert_eq!(construct(&good, &[-1e308, 1e308], 4), order("rows", 1));
    assert_eq!(
        construct(&[3.0], &good, 2),
        GridError::TooFew {
            what: "columns",
            count: 1
        }
    );
    assert_eq!(
        construct(&good, &good, 3),
        GridError::Count {
            expected: 4,
            found: 3
        }
    );
}
