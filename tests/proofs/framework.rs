//! A1: eq. (3) equals its literal evaluation. A4: a warp built from terms.

use anamorph_core::{
    Affine, Average, Deformation, Field, Plane, Scaling, Site, Solid, Space, Term, Terms,
    Transformation, Warp, deforming_function, evaluate_points, glam::dvec2, reference,
};
use anamorph_fields::falloffs::{Smoothstep, Wires};
use anamorph_fields::{InverseDistance, Product, Radial, RadialWeight};
use anamorph_tests::random::Random;
use anamorph_transforms::{Composed, Rotational};
use anamorph_warps::features::vortex::Vortex;

/// A random weight: constant, hat, Shepard's, a product; of sizes between the ends of the number range.
fn weight<S: Space>(random: &mut Random, centre: S) -> Box<dyn Field<S>> {
    let radius = random.between(0.5, 3.0);
    match random.below(6) {
        0 => Box::new(random.between(0.0, 2.0)),
        1 => Box::new(Radial::new(centre, radius, Wires).unwrap()),
        2 => Box::new(InverseDistance::new(centre, random.between(0.5, 4.0)).unwrap()),
        3 => Box::new(RadialWeight::new(centre, Some(radius), Smoothstep).unwrap()),
        4 => {
            let size = [1e-300, 1e-100, 1e100, 1e300][random.below(4)];
            Box::new(Product::new(vec![
                Box::new(size) as Box<dyn Field<S>>,
                Box::new(Radial::new(centre, radius, Wires).unwrap()),
            ]))
        }
        _ => Box::new(0.0),
    }
}

fn random_terms<S: Rotational>(random: &mut Random) -> (Vec<Term<S>>, Vec<S>) {
    let mut centres = Vec::new();
    let terms = (0..1 + random.below(6)).map(|_| {
        let centre = random.vector::<S>() * 2.0;
        centres.push(centre);
        let affine = random.affine::<S>();
        let transformation: Box<dyn Transformation<S>> = match random.below(3) {
            0 => Box::new(Affine::translation(affine.translation)),
            1 => Box::new(affine),
            _ => Box::new(Composed::new(affine, centre).unwrap()),
        };
        let strength: Box<dyn Field<S>> = match random.below(3) {
            0 => Box::new(1.0),
            1 => Box::new(random.between(-1.0, 2.0)),
            _ => Box::new(Radial::new(centre, random.between(0.5, 3.0), Wires).unwrap()),
        };
        Term {
            transformation,
            strength,
            weight: weight(random, centre),
        }
    });
    let terms = terms.collect();
    (terms, centres)
}

fn a1<S: Rotational>() {
    let mut random = Random::new(1);
    for round in 0..600 {
        let (terms, centres) = random_terms::<S>(&mut random);
        let average = match round % 3 {
            0 => Average::Weights,
            1 => Average::Ambient(random.between(0.0, 1.0)),
            _ => Average::Weights,
        };
        let mut points: Vec<S> = (0..20).map(|_| random.vector::<S>() * 3.0).collect();
        points.extend(centres);
        points.extend([S::ZERO, S::splat(100.0)]);
        let expected: Vec<S> = points
            .iter()
            .enumerate()
            .map(|(i, &p)| reference::evaluate_terms(&terms, average, &Site::new(i, p)))
            .collect();
        let warp = Terms::new(terms).with_average(average);
        let mut moved = points.clone();
        evaluate_points(&warp, 0, &mut moved);
        for (i, (&p, &wanted)) in points.iter().zip(&expected).enumerate() {
            let scale = 1.0 + p.largest() + wanted.largest();
            let site = Site::new(i, p);
            let matrix = deforming_function(&warp, &site).apply(p);
            for found in [moved[i], warp.map(&site), matrix] {
                let error = (found - wanted).largest() / scale;
                assert!(
                    error <= 1e-12,
                    "{average:?} at {p:?}: {found:?}, {wanted:?}"
                );
            }
        }
    }
}

#[test]
fn a1_the_engine_equals_the_literal_formula_in_the_plane() {
    a1::<Plane>();
}

#[test]
fn a1_the_engine_equals_the_literal_formula_in_space() {
    a1::<Solid>();
}

#[test]
fn a1_without_weight_points_stay() {
    let push = Affine::translation(dvec2(5.0, 1.0));
    let warp = Terms::new(vec![Term::new(push, 1.0, 0.0)]);
    let p = dvec2(0.3, -0.0);
    assert_eq!(warp.map(&Site::anywhere(p)), p);
    assert_eq!(Terms::<Plane>::new(Vec::new()).map(&Site::anywhere(p)), p);
}

/// A plain sum is not normalized: radial basis functions.
#[test]
fn a1_plain_sums_add() {
    let push = |x| Affine::translation(dvec2(x, 0.0));
    let terms = vec![
        Term::new(push(1.0), 1.0, 3.0),
        Term::new(push(10.0), 0.5, 2.0),
    ];
    let warp = Terms::new(terms).with_average(Average::Plain);
    assert_eq!(warp.map(&Site::anywhere(Plane::ZERO)), dvec2(13.0, 0.0));
    assert_eq!(warp.average(), Average::Plain);
}

/// A4: the vortex from one term equals the vortex from its construction.
#[test]
fn a4_a_vortex_is_one_term() {
    let (centre, angle, radius) = (dvec2(0.3, -0.2), 2.5, 1.5);
    let turn = Affine::about(centre, Plane::rotation(Plane::ZERO, angle), Plane::ZERO);
    let term = Term::new(
        Composed::new(turn, centre).unwrap(),
        Radial::new(centre, radius, Wires).unwrap(),
        1.0,
    );
    let by_hand = Terms::new(vec![term]);
    let built = Vortex::construct(
        centre,
        Plane::ZERO,
        angle,
        radius,
        &Wires,
        Scaling::Composition,
    );
    let built = built.unwrap();
    let mut random = Random::new(4);
    for _ in 0..500 {
        let site = Site::anywhere(random.vector::<Plane>() * 2.0);
        assert!((by_hand.map(&site) - built.map(&site)).length() < 1e-14);
    }
}
