//! Composition scaling of any affine map about a centre.
//!
//! *Source*: Milliron et al. 2002, §3.3 (the composition method); errata F18: the centre is part of the transformation,
//! and the stretch scales as `I + (U − I)s`, not `U^s`. With `T⟨p⟩ = c + t + R(θ)·U·(p − c)`:
//! `(s·T)⟨p⟩ = c + s·t + R(s·θ)·(I + (U − I)s)·(p − c)`.

use anamorph_core::{Affine, Linear, Scaling, Space, Transformation, math};

use crate::{Rotational, TransformError, Turn, polar};

/// An affine map that is scaled by composition: shift, rotation and stretch about a centre, each scaled by itself.
///
/// A rotation stays a rotation at every strength, and a rigid motion stays rigid. A reflection is carried by the stretch
/// (errata F18), which is singular at some strength between 0 and 1: at ½ for a mirror.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Composed<S: Space> {
    affine: Affine<S>,
    centre: S,
    /// What the centre moves by.
    shift: S,
    turn: Turn<S>,
    /// `U − I`.
    growth: S::Linear,
    /// The generator of the rotation, its square, and both after the growth, so that scaling adds matrices only.
    generator: S::Linear,
    square: S::Linear,
    generator_growth: S::Linear,
    square_growth: S::Linear,
}

impl<S: Rotational> Composed<S> {
    /// The map `affine`, scaled about `centre`.
    ///
    /// # Errors
    /// [`TransformError::NotFinite`] when the map or the centre has an infinite or undefined entry.
    pub fn new(affine: Affine<S>, centre: S) -> Result<Self, TransformError> {
        if !affine.is_finite() {
            return Err(TransformError::NotFinite { what: "map" });
        }
        if !centre.is_finite() {
            return Err(TransformError::NotFinite { what: "centre" });
        }
        // The identity is left out of the stretch exactly, so that translations and rotations bring no rounding in.
        let (turn, growth) = if affine.linear == S::Linear::IDENTITY {
            (Turn::none(), S::Linear::ZERO)
        } else {
            let parts = polar::<S>(&affine.linear);
            let turn = S::turn_of(&parts.rotation);
            (turn, parts.stretch - S::Linear::IDENTITY)
        };
        let generator = S::generator(turn.axis);
        let square = generator.after(&generator);
        Ok(Self {
            shift: affine.displacement(centre),
            generator_growth: generator.after(&growth),
            square_growth: square.after(&growth),
            affine,
            centre,
            turn,
            growth,
            generator,
            square,
        })
    }

    /// The centre, the point at which rotation and stretch take hold.
    pub fn centre(&self) -> S {
        self.centre
    }
    /// What the centre moves by at strength 1.
    pub fn shift(&self) -> S {
        self.shift
    }
    /// Axis and angle of the rotation at strength 1.
    pub fn turn(&self) -> Turn<S> {
        self.turn
    }
    /// The symmetric stretch `U` at strength 1.
    pub fn stretch(&self) -> S::Linear {
        self.growth + S::Linear::IDENTITY
    }
}

impl<S: Rotational> Transformation<S> for Composed<S> {
    fn affine(&self) -> Affine<S> {
        self.affine
    }

    fn scaled(&self, strength: f64) -> Affine<S> {
        if strength == 1.0 {
            return self.affine;
        }
        if strength == 0.0 {
            return Affine::IDENTITY;
        }
        // R(φ)·(I + sE) = I + sE + sin φ·(K + sKE) + (1 − cos φ)·(K² + sK²E), with 1 − cos φ = 2 sin²(φ/2) to keep the
        // digits of small angles.
        let (half_sin, half_cos) = math::sin_cos(0.5 * strength * self.turn.angle);
        let sin = 2.0 * half_sin * half_cos;
        let versine = 2.0 * half_sin * half_sin;
        let linear = S::Linear::IDENTITY
            + (self.growth * strength
                + (self.generator + self.generator_growth * strength) * sin
                + (self.square + self.square_growth * strength) * versine);
        Affine::about(self.centre, linear, self.shift * strength)
    }

    fn scaling(&self) -> Scaling {
        Scaling::Composition
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, affine_far, far};
    use anamorph_core::glam::{DMat2, DMat3, DVec2, DVec3};
    use core::f64::consts::PI;

    /// The laws of §3.3 with errata F18, against the formula evaluated plainly.
    fn laws<S: Rotational>(affine: Affine<S>, centre: S) {
        let scaled = Composed::new(affine, centre).unwrap();
        assert_eq!(scaled.scaled(0.0), Affine::IDENTITY);
        assert_eq!(scaled.scaled(1.0), affine);
        assert_eq!(scaled.affine(), affine);
        // No jump at the ends.
        let near = scaled.scaled(1.0 - 1e-13);
        assert!(affine_far(&near, &affine) < 1e-12 * 10.0, "{affine:?}");
        assert!(affine_far(&scaled.scaled(1e-13), &Affine::IDENTITY) < 1e-12 * 10.0);
        let stretch = scaled.stretch();
        for s in [-0.5, 0.1, 0.3, 0.5, 0.9, 1.7] {
            let grown = S::Linear::IDENTITY + (stretch - S::Linear::IDENTITY) * s;
            let linear = scaled.turn().matrix(s).after(&grown);
            let plain = Affine::about(centre, linear, scaled.shift() * s);
            assert!(affine_far(&scaled.scaled(s), &plain) < 1e-13);
        }
    }

    fn random_laws<S: Rotational>(seed: u64) {
        let mut random = Random::new(seed);
        for _ in 0..1000 {
            let affine: Affine<S> = Affine::new(random.linear::<S>(), random.vector());
            laws(affine, random.vector());
        }
    }

    #[test]
    fn laws_hold_for_random_maps() {
        random_laws::<DVec2>(31);
        random_laws::<DVec3>(32);
    }

    #[test]
    fn laws_hold_for_hard_maps() {
        let mut random = Random::new(33);
        for step in 0..200 {
            let near = PI - math::powi(0.1, step % 17);
            let turn = <DVec3 as Space>::rotation(random.direction(), near);
            laws::<DVec3>(Affine::new(turn, random.vector()), random.vector());
            let turn = <DVec2 as Space>::rotation(DVec2::ZERO, -near);
            laws::<DVec2>(Affine::new(turn, random.vector()), random.vector());
            let flat = DMat3::from_diagonal(DVec3::new(1.0, 2.0, math::powi(0.1, step % 20)));
            laws(Affine::new(turn3(&mut random) * flat, DVec3::ONE), DVec3::X);
            let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
            laws(
                Affine::new(turn3(&mut random) * mirror, DVec3::ONE),
                DVec3::X,
            );
        }
        laws(Affine::new(DMat3::ZERO, DVec3::ONE), DVec3::Y);
        laws(Affine::new(DMat2::ZERO, DVec2::ONE), DVec2::Y);
    }

    fn turn3(random: &mut Random) -> DMat3 {
        random.rotation::<DVec3>()
    }

    #[test]
    fn rigid_motions_stay_rigid() {
        let mut random = Random::new(34);
        for _ in 0..200 {
            let affine: Affine<DVec3> = Affine::new(turn3(&mut random), random.vector());
            let scaled = Composed::new(affine, random.vector()).unwrap();
            for s in [-1.0, 0.25, 0.5, 0.75, 2.0] {
                let linear = scaled.scaled(s).linear;
                let square = linear.transpose() * linear;
                assert!(far::<DVec3>(&square, &DMat3::IDENTITY) < 1e-14);
                assert!((linear.determinant() - 1.0).abs() < 1e-14);
            }
            // Half strength twice is the whole rotation.
            let half = scaled.scaled(0.5).linear;
            assert!(far::<DVec3>(&(half * half), &affine.linear) < 1e-14);
        }
    }

    #[test]
    fn translations_agree_with_displacement() {
        let affine = Affine::translation(DVec3::new(1.0, -2.0, 0.3));
        let scaled = Composed::new(affine, DVec3::new(1e6, 0.1, 3.0)).unwrap();
        assert!(scaled.is_translation());
        assert_eq!(scaled.scaled(0.3).linear, DMat3::IDENTITY);
        let expected = affine.scaled(0.3);
        assert!(affine_far(&scaled.scaled(0.3), &expected) < 1e-15);
    }

    #[test]
    fn errata_f18_stretch_is_linear_in_the_strength() {
        let affine = Affine::new(DMat2::from_diagonal(DVec2::new(4.0, 1.0)), DVec2::ZERO);
        let half = Composed::new(affine, DVec2::ZERO).unwrap().scaled(0.5);
        // I + (U − I)/2 = 2.5, where a power would give 2.
        assert!((half.linear.x_axis.x - 2.5).abs() < 1e-15);
        // A mirror is singular halfway.
        let mirror = Affine::new(DMat2::from_diagonal(DVec2::new(-1.0, 1.0)), DVec2::ZERO);
        let half = Composed::new(mirror, DVec2::ZERO).unwrap().scaled(0.5);
        assert!(half.linear.determinant().abs() < 1e-15);
    }

    #[test]
    fn errata_f18_half_turns() {
        // By +π in the plane, whatever the sign of the sine's rounding.
        for noise in [-1.2e-16, 1.2e-16] {
            let half = DMat2::from_cols(DVec2::new(-1.0, noise), DVec2::new(-noise, -1.0));
            let scaled = Composed::new(Affine::new(half, DVec2::ZERO), DVec2::ZERO).unwrap();
            assert!((scaled.scaled(0.5).apply(DVec2::X) - DVec2::Y).length() < 1e-15);
        }
        // About the axis whose first non-zero component is positive in space.
        let half = <DVec3 as Space>::rotation(DVec3::NEG_Z, PI);
        let scaled = Composed::new(Affine::new(half, DVec3::ZERO), DVec3::ZERO).unwrap();
        assert!((scaled.scaled(0.5).apply(DVec3::X) - DVec3::Y).length() < 1e-15);
    }

    #[test]
    fn the_centre_matters() {
        let quarter = <DVec2 as Space>::rotation(DVec2::ZERO, 0.5 * PI);
        let centre = DVec2::new(3.0, -1.0);
        let about = Affine::about(centre, quarter, DVec2::ZERO);
        let fixed = Composed::new(about, centre).unwrap();
        assert!((fixed.scaled(0.4).apply(centre) - centre).length() < 1e-15);
        let elsewhere = Composed::new(about, DVec2::ZERO).unwrap();
        assert!((elsewhere.scaled(0.4).apply(centre) - centre).length() > 0.1);
    }

    #[test]
    fn entries_that_are_not_finite_are_refused() {
        let bad = Affine::translation(DVec2::new(f64::NAN, 0.0));
        assert_eq!(
            Composed::new(bad, DVec2::ZERO),
            Err(TransformError::NotFinite { what: "map" })
        );
        let error = Composed::new(Affine::IDENTITY, DVec2::splat(f64::INFINITY)).unwrap_err();
        assert!(error.to_string().contains("centre"));
    }
}
