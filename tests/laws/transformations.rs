//! Scaling of transformations: `0·T = I`, `1·T = T`, rotations stay rotations.

use crate::laws;
use anamorph_core::{Affine, Linear, Transformation};
use anamorph_tests::measure::linear_distance;
use anamorph_tests::random::Random;
use anamorph_tests::subjects::Registered;
use anamorph_transforms::{Component, Composed, Ordered};

laws!(
    scaling_by_zero_and_one,
    composition_keeps_rotations_rotations,
    displacement_scaling_is_linear_in_the_strength,
    scaling_is_continuous_in_the_strength_from_zero_to_one,
);

fn transformations<S: Registered>() -> Vec<(Box<dyn Transformation<S>>, S)> {
    let mut random = Random::new(61);
    let mut all: Vec<(Box<dyn Transformation<S>>, S)> = Vec::new();
    for round in 0..60 {
        let centre = random.vector::<S>() * 3.0;
        let mut affine = random.affine::<S>();
        match round % 4 {
            // A reflection, a half turn, a rotation with a small stretch; else anything.
            0 => affine.linear = S::Linear::IDENTITY * -1.0,
            1 => affine.linear = S::rotation(random.direction(), core::f64::consts::PI),
            2 => {
                let stretch = S::Linear::IDENTITY + random.linear::<S>() * 1e-9;
                affine.linear = random.rotation::<S>().after(&stretch);
            }
            _ => {}
        }
        all.push((Box::new(affine), centre));
        all.push((Box::new(Composed::new(affine, centre).unwrap()), centre));
        let parts = [
            Component::Rotate {
                axis: random.direction(),
                angle: random.between(-9.0, 9.0),
            },
            Component::Scale(S::from_fn(|_| random.between(-1.0, 2.0))),
            Component::Translate(random.vector()),
        ];
        all.push((Box::new(Ordered::new(&parts, centre).unwrap()), centre));
    }
    all
}

fn scaling_by_zero_and_one<S: Registered>() {
    for (transformation, _) in transformations::<S>() {
        assert_eq!(transformation.scaled(0.0), Affine::IDENTITY);
        assert_eq!(transformation.scaled(1.0), transformation.affine());
    }
}

fn composition_keeps_rotations_rotations<S: Registered>() {
    let mut random = Random::new(62);
    for round in 0..200 {
        let centre = random.vector::<S>() * 2.0;
        let rotation = if round % 10 == 0 {
            S::rotation(random.direction(), core::f64::consts::PI)
        } else {
            random.rotation::<S>()
        };
        let shift = random.vector::<S>();
        let about = Affine::about(centre, rotation, shift);
        let composed = Composed::new(about, centre).unwrap();
        for strength in [-1.0, 0.1, 0.3, 0.5, 0.77, 0.999, 1.5, 4.0] {
            let part = composed.scaled(strength);
            let gram = part.linear.transposed().after(&part.linear);
            assert!(linear_distance::<S>(&gram, &S::Linear::IDENTITY) < 1e-13);
            assert!((part.linear.determinant() - 1.0).abs() < 1e-13);
            // The centre goes its share of the way.
            let gone = part.apply(centre) - centre;
            assert!((gone - shift * strength).largest() < 1e-13 * (1.0 + strength.abs()));
        }
        // A third of the way three times is the whole.
        let turn = Composed::new(Affine::about(centre, rotation, S::ZERO), centre).unwrap();
        let third = turn.scaled(1.0 / 3.0);
        let whole = third.after(&third).after(&third);
        assert!(linear_distance::<S>(&whole.linear, &rotation) < 1e-12);
    }
}

fn displacement_scaling_is_linear_in_the_strength<S: Registered>() {
    let mut random = Random::new(63);
    for _ in 0..100 {
        let affine = random.affine::<S>();
        let (p, s) = (random.vector::<S>() * 5.0, random.between(-2.0, 3.0));
        let expected = p + (affine.apply(p) - p) * s;
        assert!((affine.scaled(s).apply(p) - expected).largest() < 1e-13 * 20.0);
    }
}

fn scaling_is_continuous_in_the_strength_from_zero_to_one<S: Registered>() {
    for (transformation, centre) in transformations::<S>() {
        let p = centre + S::splat(0.5);
        let at = |i: u32| transformation.scaled(f64::from(i) / 4096.0).apply(p);
        for i in 0..4096 {
            let step = at(i).distance(at(i + 1));
            assert!(step < 0.02, "{step} at {i}");
        }
    }
}
