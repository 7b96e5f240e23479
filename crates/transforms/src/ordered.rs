//! Composition scaling of components given by the user, in the user's order.
//!
//! *Source*: Milliron et al. 2002, §3.3: a transformation composed of simple ones is scaled by scaling each. Angle·s,
//! translation·s, scale `1 + (x − 1)s` (errata F8), shear·s.

use anamorph_core::{Affine, Linear, Scaling, Space, Transformation, math};

use crate::{Rotational, TransformError};

/// One component of an [`Ordered`] transformation. All but the translation act about its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Component<S> {
    /// A shift by a vector, in scene units.
    Translate(S),
    /// A rotation by `angle` radians: counter-clockwise in the plane (`axis` is not read), by the right-hand rule about
    /// `axis` in space.
    Rotate {
        /// The axis, of any length.
        axis: S,
        /// The angle in radians; more than one full turn is kept.
        angle: f64,
    },
    /// A scale by one factor per coordinate axis. At strength `s` each factor is `1 + (factor − 1)s`.
    Scale(S),
    /// A scale by `factor` along one direction.
    Stretch {
        /// The direction, of any length.
        direction: S,
        /// The factor; 1 changes nothing.
        factor: f64,
    },
    /// A shear: a point at (signed) height `h` over the plane through the centre moves by `h · amount` along `direction`.
    Shear {
        /// Where points move, of any length, perpendicular to `normal`.
        direction: S,
        /// The normal of the plane that stays, of any length.
        normal: S,
        /// Movement per height.
        amount: f64,
    },
}

/// What a component needs at every strength.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Prepared<S: Space> {
    Translate(S),
    Rotate {
        generator: S::Linear,
        square: S::Linear,
        angle: f64,
    },
    /// A linear part that grows with the strength: `I + s·growth`.
    Grow(S::Linear),
}

/// Components applied one after the other about a centre, the first of the list first, each scaled by the strength.
#[derive(Debug, Clone, PartialEq)]
pub struct Ordered<S: Space> {
    parts: Vec<Prepared<S>>,
    centre: S,
    affine: Affine<S>,
}

impl<S: Rotational> Ordered<S> {
    /// The composition of `components`, the first of the list applied first, about `centre`. An empty list is the
    /// identity.
    ///
    /// # Errors
    /// [`TransformError`] when a number is not finite, a direction that is needed is null, or a shear leaves its plane.
    pub fn new(components: &[Component<S>], centre: S) -> Result<Self, TransformError> {
        if !centre.is_finite() {
            return Err(TransformError::NotFinite { what: "centre" });
        }
        let parts = components
            .iter()
            .enumerate()
            .map(|(index, component)| prepared(index, component))
            .collect::<Result<Vec<_>, _>>()?;
        let affine = composed(&parts, centre, 1.0);
        if !affine.is_finite() {
            return Err(TransformError::NotFinite { what: "product" });
        }
        Ok(Self {
            parts,
            centre,
            affine,
        })
    }

    /// The centre of rotations, scales, stretches and shears.
    pub fn centre(&self) -> S {
        self.centre
    }
}

/// A unit vector, or the error that names what was null.
fn direction<S: Space>(v: S, index: usize, what: &'static str) -> Result<S, TransformError> {
    if !v.is_finite() {
        return Err(TransformError::NotFinite { what });
    }
    v.normalized()
        .ok_or(TransformError::NullDirection { index, what })
}

fn finite(x: f64, what: &'static str) -> Result<f64, TransformError> {
    if x.is_finite() {
        Ok(x)
    } else {
        Err(TransformError::NotFinite { what })
    }
}

fn prepared<S: Rotational>(
    index: usize,
    component: &Component<S>,
) -> Result<Prepared<S>, TransformError> {
    Ok(match *component {
        Component::Translate(offset) => {
            finite(offset.largest(), "translation")?;
            Prepared::Translate(offset)
        }
        Component::Rotate { axis, angle } => {
            let axis = if S::DIM == 2 {
                S::ZERO
            } else {
                direction(axis, index, "axis")?
            };
            let generator = S::generator(axis);
            Prepared::Rotate {
                generator,
                square: generator.after(&generator),
                angle: finite(angle, "angle")?,
            }
        }
        Component::Scale(factors) => {
            finite(factors.largest(), "scale")?;
            Prepared::Grow(S::Linear::from_columns(|i| {
                S::unit(i) * (factors.component(i) - 1.0)
            }))
        }
        Component::Stretch {
            direction: d,
            factor,
        } => {
            let d = direction(d, index, "direction")?;
            Prepared::Grow(S::Linear::outer(d, d) * (finite(factor, "factor")? - 1.0))
        }
        Component::Shear {
            direction: d,
            normal,
            amount,
        } => {
            /// Cosine that typed-in directions of nine digits stay below.
            const PERPENDICULAR: f64 = 1e-9;
            let normal = direction(normal, index, "normal")?;
            let d = direction(d, index, "direction")?;
            if d.dot(normal).abs() > PERPENDICULAR {
                return Err(TransformError::ShearOffPlane { index });
            }
            Prepared::Grow(S::Linear::outer(d, normal) * finite(amount, "amount")?)
        }
    })
}

fn composed<S: Rotational>(parts: &[Prepared<S>], centre: S, strength: f64) -> Affine<S> {
    // The linear part, and the image of the centre relative to it.
    let mut linear = S::Linear::IDENTITY;
    let mut offset = S::ZERO;
    for part in parts {
        let step = match part {
            Prepared::Translate(shift) => {
                offset += *shift * strength;
                continue;
            }
            Prepared::Rotate {
                generator,
                square,
                angle,
            } => {
                let (half_sin, half_cos) = math::sin_cos(0.5 * strength * angle);
                S::Linear::IDENTITY
                    + *generator * (2.0 * half_sin * half_cos)
                    + *square * (2.0 * half_sin * half_sin)
            }
            Prepared::Grow(growth) => S::Linear::IDENTITY + *growth * strength,
        };
        linear = step.after(&linear);
        offset = step.apply(offset);
    }
    Affine::about(centre, linear, offset)
}

impl<S: Rotational> Transformation<S> for Ordered<S> {
    fn affine(&self) -> Affine<S> {
        self.affine
    }

    fn scaled(&self, strength: f64) -> Affine<S> {
        if strength == 1.0 {
            self.affine
        } else if strength == 0.0 {
            Affine::IDENTITY
        } else {
            composed(&self.parts, self.centre, strength)
        }
    }

    fn scaling(&self) -> Scaling {
        Scaling::Composition
    }

    /// Whether all components are translations: others may cancel at strength 1 and yet act in between.
    fn is_translation(&self) -> bool {
        self.parts
            .iter()
            .all(|part| matches!(part, Prepared::Translate(_)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Composed;
    use crate::testing::{Random, affine_far, far};
    use anamorph_core::glam::{DMat2, DMat3, DVec2, DVec3, dvec2, dvec3};
    use core::f64::consts::{FRAC_PI_2, TAU};

    fn random_component<S: Space>(random: &mut Random, kind: u32) -> Component<S> {
        match kind % 5 {
            0 => Component::Translate(random.vector()),
            1 => Component::Rotate {
                axis: random.direction(),
                angle: random.between(-7.0, 7.0),
            },
            2 => Component::Scale(random.vector::<S>() + S::splat(1.5)),
            3 => Component::Stretch {
                direction: random.direction(),
                factor: random.between(0.2, 3.0),
            },
            _ => {
                let normal = random.direction::<S>();
                let other = random.direction::<S>();
                Component::Shear {
                    direction: other - normal * normal.dot(other),
                    normal,
                    amount: random.between(-2.0, 2.0),
                }
            }
        }
    }

    /// One component at a strength, written out plainly.
    fn plainly<S: Space>(component: &Component<S>, s: f64, centre: S, p: S) -> S {
        let q = p - centre;
        let unit = |v: S| v.normalized().unwrap();
        match *component {
            Component::Translate(t) => p + t * s,
            Component::Rotate { axis, angle } => centre + S::rotation(axis, angle * s).apply(q),
            Component::Scale(f) => {
                centre + q.scaled_by(S::from_fn(|i| 1.0 + (f.component(i) - 1.0) * s))
            }
            Component::Stretch { direction, factor } => {
                p + unit(direction) * (q.dot(unit(direction)) * (factor - 1.0) * s)
            }
            Component::Shear {
                direction,
                normal,
                amount,
            } => p + unit(direction) * (q.dot(unit(normal)) * amount * s),
        }
    }

    fn chains<S: Rotational>(seed: u64) {
        let mut random = Random::new(seed);
        for step in 0..500 {
            let components: Vec<Component<S>> = (0..step % 6)
                .map(|i| random_component(&mut random, step / 7 + i * (1 + step % 4)))
                .collect();
            let centre = random.vector();
            let ordered = Ordered::new(&components, centre).unwrap();
            assert_eq!(ordered.scaled(0.0), Affine::IDENTITY);
            assert_eq!(ordered.scaled(1.0), ordered.affine());
            assert!(affine_far(&ordered.scaled(1.0 - 1e-14), &ordered.affine()) < 1e-9);
            for s in [-0.7, 0.2, 0.5, 1.0, 1.4] {
                let p = random.vector::<S>();
                let expected = components.iter().fold(p, |p, c| plainly(c, s, centre, p));
                let moved = ordered.scaled(s).apply(p);
                assert!((moved - expected).length() < 1e-11 * (1.0 + expected.length()));
            }
        }
    }

    #[test]
    fn chains_equal_their_components_one_by_one() {
        chains::<DVec2>(41);
        chains::<DVec3>(42);
    }

    #[test]
    fn order_matters() {
        let turn = Component::Rotate {
            axis: DVec2::ZERO,
            angle: FRAC_PI_2,
        };
        let shift = Component::Translate(dvec2(1.0, 0.0));
        let first = Ordered::new(&[turn, shift], DVec2::ZERO).unwrap();
        let second = Ordered::new(&[shift, turn], DVec2::ZERO).unwrap();
        assert!((first.affine().apply(DVec2::ZERO) - dvec2(1.0, 0.0)).length() < 1e-15);
        assert!((second.affine().apply(DVec2::ZERO) - dvec2(0.0, 1.0)).length() < 1e-15);
    }

    #[test]
    fn stretch_then_rotate_is_the_polar_composition() {
        let mut random = Random::new(43);
        for _ in 0..100 {
            let (axis, direction) = (random.direction(), random.direction());
            let components = [
                Component::Stretch {
                    direction,
                    factor: random.between(0.2, 3.0),
                },
                Component::Rotate {
                    axis,
                    angle: random.between(0.0, 3.0),
                },
                Component::Translate(random.vector()),
            ];
            let centre: DVec3 = random.vector();
            let ordered = Ordered::new(&components, centre).unwrap();
            let composed = Composed::new(ordered.affine(), centre).unwrap();
            for s in [0.3, 0.8, 1.2] {
                assert!(affine_far(&ordered.scaled(s), &composed.scaled(s)) < 1e-12);
            }
        }
    }

    #[test]
    fn full_turns_are_kept() {
        let turn = [Component::Rotate {
            axis: DVec3::Z,
            angle: TAU,
        }];
        let ordered = Ordered::new(&turn, DVec3::ZERO).unwrap();
        let half = ordered.scaled(0.5).linear;
        let expected = DMat3::from_diagonal(dvec3(-1.0, -1.0, 1.0));
        assert!(far::<DVec3>(&half, &expected) < 1e-15);
        // Components that cancel at strength 1 are no translation.
        let there_and_back = [
            Component::Scale(dvec2(2.0, 2.0)),
            Component::Scale(dvec2(0.5, 0.5)),
        ];
        let ordered = Ordered::new(&there_and_back, DVec2::ZERO).unwrap();
        assert_eq!(ordered.affine().linear, DMat2::IDENTITY);
        assert!(!ordered.is_translation());
        assert_eq!(ordered.scaled(0.5).linear.x_axis.x, 1.125);
    }

    #[test]
    fn bad_components_are_named() {
        let bad = |component: Component<DVec3>| {
            Ordered::new(
                &[Component::Translate(DVec3::X * 2.0), component],
                DVec3::ZERO,
            )
            .unwrap_err()
        };
        assert_eq!(
            bad(Component::Rotate {
                axis: DVec3::ZERO,
                angle: 1.0
            }),
            TransformError::NullDirection {
                index: 1,
                what: "axis"
            }
        );
        assert_eq!(
            bad(Component::Shear {
                direction: dvec3(1.0, 0.0, 0.1),
                normal: DVec3::Z,
                amount: 1.0
            }),
            TransformError::ShearOffPlane { index: 1 }
        );
        assert_eq!(
            bad(Component::Scale(dvec3(1.0, f64::NAN, 1.0))),
            TransformError::NotFinite { what: "scale" }
        );
        assert_eq!(
            bad(Component::Scale(dvec3(f64::MAX, 1.0, 1.0))),
            TransformError::NotFinite { what: "product" }
        );
    }
}
