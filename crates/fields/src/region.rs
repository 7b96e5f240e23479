//! Masks of regions: boxes and half-spaces with soft edges.
//!
//! *Source*: Milliron et al. 2002, §3.2: a strength field that is 1 in a region and falls to 0 around it. The box is the
//! product of one step per axis, which keeps the falloff's class everywhere; a falloff of the distance to the box would
//! be no better than C¹ beside the edges, where the distance changes its formula.

use crate::error::{direction, finite, place, reciprocal};
use crate::{Falloff, FieldError};
use anamorph_core::{Bounds, Field, Site, Smoothness, Space, Support};

/// Points a batch handles at a time: 4 KiB of scratch.
const RUN: usize = 512;

/// A falloff used as a step over a width, which may be 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Step<F> {
    falloff: F,
    /// 1/width, or infinity for a jump.
    reciprocal: f64,
    /// Where the step ends, in scene units beyond its start.
    reach: f64,
}

impl<F: Falloff> Step<F> {
    pub(crate) fn new(falloff: F, width: f64, what: &'static str) -> Result<Self, FieldError> {
        let facts = falloff.facts();
        let (Some(reach), true) = (facts.reach, facts.start != Smoothness::Jump) else {
            return Err(FieldError::NotAStep { name: facts.name });
        };
        let reciprocal = if width == 0.0 {
            f64::INFINITY
        } else {
            reciprocal(width, what)?
        };
        Ok(Self {
            falloff,
            reciprocal,
            reach: reach * width,
        })
    }
    pub(crate) fn smoothness(&self) -> Smoothness {
        if self.reciprocal.is_finite() {
            self.falloff.step_smoothness()
        } else {
            Smoothness::Jump
        }
    }
    /// The falloff's argument at the distance `d` beyond the start: not negative, also where infinity meets 0.
    #[inline(always)]
    fn argument(&self, d: f64) -> f64 {
        (d * self.reciprocal).max(0.0)
    }
    pub(crate) fn value(&self, d: f64) -> f64 {
        self.falloff.value(self.argument(d))
    }
    /// Derivative by `d`; 0 at a jump.
    pub(crate) fn derivative(&self, d: f64) -> f64 {
        if d <= 0.0 || !self.reciprocal.is_finite() {
            return 0.0;
        }
        self.falloff.derivative(d * self.reciprocal) * self.reciprocal
    }
    /// Replaces distances by values.
    pub(crate) fn apply(&self, d: &mut [f64]) {
        for d in d.iter_mut() {
            *d = self.argument(*d);
        }
        self.falloff.apply(d);
    }
}

/// 1 in an axis-parallel box, falling to 0 over a margin around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxField<S, F = &'static dyn Falloff> {
    bounds: Bounds<S>,
    step: Step<F>,
}

impl<S: Space, F: Falloff> BoxField<S, F> {
    /// The field that is 1 in `bounds` and falls over `margin ≥ 0` scene units outside; a margin of 0 makes it jump.
    ///
    /// # Errors
    /// [`FieldError`] when a number is not finite, the margin is negative, or the falloff does not lead from 1 to 0.
    pub fn new(bounds: Bounds<S>, margin: f64, falloff: F) -> Result<Self, FieldError> {
        place(bounds.min, "box")?;
        place(bounds.max, "box")?;
        Ok(Self {
            bounds: Bounds::new(bounds.min, bounds.max),
            step: Step::new(falloff, margin, "margin")?,
        })
    }
    /// How far beyond the box's sides a coordinate is; negative inside.
    #[inline(always)]
    fn beyond(&self, p: S, axis: usize) -> f64 {
        let x = p.component(axis);
        (self.bounds.min.component(axis) - x).max(x - self.bounds.max.component(axis))
    }
}

impl<S: Space, F: Falloff> Field<S> for BoxField<S, F> {
    fn value(&self, site: &Site<S>) -> f64 {
        (0..S::DIM).fold(1.0, |product, axis| {
            product * self.step.value(self.beyond(site.point, axis))
        })
    }
    fn support(&self) -> Support<S> {
        // Rounding of the distances may leave a trace just outside.
        let largest = self.bounds.min.largest().max(self.bounds.max.largest());
        let slack = 4.0 * f64::EPSILON * (largest + self.step.reach);
        let margin = S::splat(self.step.reach + slack);
        Support::Box(Bounds {
            min: self.bounds.min - margin,
            max: self.bounds.max + margin,
        })
    }
    fn positive(&self) -> bool {
        true
    }
    fn smoothness(&self) -> Smoothness {
        self.step.smoothness()
    }
    fn values(&self, _: usize, points: &[S], values: &mut [f64]) {
        let mut scratch = [0.0; RUN];
        for (points, values) in points.chunks(RUN).zip(values.chunks_mut(RUN)) {
            let scratch = &mut scratch[..points.len()];
            values.fill(1.0);
            for axis in 0..S::DIM {
                for (d, &p) in scratch.iter_mut().zip(points) {
                    *d = self.beyond(p, axis);
                }
                self.step.apply(scratch);
                for (value, d) in values.iter_mut().zip(scratch.iter()) {
                    *value *= d;
                }
            }
        }
    }
    fn gradient(&self, site: &Site<S>, _: f64) -> Option<S> {
        Some(S::from_fn(|axis| {
            let others: f64 = (0..S::DIM)
                .filter(|&i| i != axis)
                .map(|i| self.step.value(self.beyond(site.point, i)))
                .product();
            let x = site.point.component(axis);
            let outward = if x > self.bounds.max.component(axis) {
                1.0
            } else {
                -1.0
            };
            outward * self.step.derivative(self.beyond(site.point, axis)) * others
        }))
    }
}

/// 1 on the side of a plane (a line in the plane) to which its normal points, falling to 0 over a width behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfSpace<S, F = &'static dyn Falloff> {
    point: S,
    normal: S,
    step: Step<F>,
}

impl<S: Space, F: Falloff> HalfSpace<S, F> {
    /// The field of the plane through `point` with `normal` (any length): 1 on it and in front of it, 0 farther than
    /// `width ≥ 0` scene units behind it. A width of 0 makes it jump.
    ///
    /// # Errors
    /// [`FieldError`] when a number is not finite, the normal is null, the width is negative, or the falloff does not lead
    /// from 1 to 0.
    pub fn new(point: S, normal: S, width: f64, falloff: F) -> Result<Self, FieldError> {
        Ok(Self {
            point: place(point, "point")?,
            normal: direction(normal, "normal")?,
            step: Step::new(falloff, finite(width, "width")?, "width")?,
        })
    }
    #[inline(always)]
    fn behind(&self, p: S) -> f64 {
        -(p - self.point).dot(self.normal)
    }
}

impl<S: Space, F: Falloff> Field<S> for HalfSpace<S, F> {
    fn value(&self, site: &Site<S>) -> f64 {
        self.step.value(self.behind(site.point))
    }
    fn support(&self) -> Support<S> {
        Support::Everywhere
    }
    fn smoothness(&self) -> Smoothness {
        self.step.smoothness()
    }
    fn values(&self, _: usize, points: &[S], values: &mut [f64]) {
        for (value, &p) in values.iter_mut().zip(points) {
            *value = self.behind(p);
        }
        self.step.apply(values);
    }
    fn gradient(&self, site: &Site<S>, _: f64) -> Option<S> {
        Some(self.normal * -self.step.derivative(self.behind(site.point)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FALLOFFS;
    use crate::falloffs::{Fab, InverseDistance, Smootherstep, Smoothstep};
    use crate::testing::check_field;
    use anamorph_core::glam::{DVec2, DVec3, dvec2, dvec3};

    fn steps() -> impl Iterator<Item = &'static dyn Falloff> {
        FALLOFFS.iter().copied().filter(Falloff::compact)
    }

    #[test]
    fn laws_hold_for_every_falloff() {
        for falloff in steps() {
            let bounds = Bounds::new(dvec3(-0.5, 0.2, -0.1), dvec3(0.4, 0.6, 0.3));
            check_field(&BoxField::new(bounds, 0.5, falloff).unwrap(), 1.5);
            let bounds = Bounds::new(dvec2(-0.5, 0.2), dvec2(0.4, 0.2));
            check_field(&BoxField::new(bounds, 0.5, falloff).unwrap(), 1.5);
            check_field(&BoxField::new(bounds, 0.0, falloff).unwrap(), 1.5);
            let half = HalfSpace::new(dvec3(0.1, 0.0, 0.2), dvec3(1.0, 2.0, -1.0), 0.8, falloff);
            check_field(&half.unwrap(), 1.5);
            check_field(
                &HalfSpace::new(DVec2::ZERO, DVec2::Y, 0.0, falloff).unwrap(),
                1.5,
            );
        }
    }

    #[test]
    fn one_inside_and_zero_beyond() {
        let bounds = Bounds::new(DVec2::ZERO, DVec2::ONE);
        let field = BoxField::new(bounds, 0.5, Smoothstep).unwrap();
        let at = |x: f64, y: f64| field.value(&Site::anywhere(dvec2(x, y)));
        assert_eq!((at(0.0, 0.0), at(1.0, 0.3)), (1.0, 1.0));
        assert_eq!((at(1.25, 0.3), at(1.25, -0.25)), (0.5, 0.25));
        assert_eq!((at(1.5, 0.3), at(0.3, -2.0)), (0.0, 0.0));
        let hard = BoxField::new(bounds, 0.0, Smoothstep).unwrap();
        assert_eq!(hard.value(&Site::anywhere(dvec2(1.0, 1.0))), 1.0);
        assert_eq!(hard.value(&Site::anywhere(dvec2(1.0 + 1e-15, 1.0))), 0.0);
        assert_eq!(Field::<DVec2>::smoothness(&hard), Smoothness::Jump);
        let half = HalfSpace::new(DVec2::X, DVec2::X * 7.0, 2.0, Smoothstep).unwrap();
        let at = |x: f64| half.value(&Site::anywhere(dvec2(x, 9.0)));
        assert_eq!((at(1.0), at(5.0), at(0.0), at(-1.0)), (1.0, 1.0, 0.5, 0.0));
    }

    #[test]
    fn a_box_keeps_the_class_of_its_falloff_at_its_edges() {
        // Second derivatives across the place where the nearest side changes: continuous for the quintic.
        let bounds = Bounds::new(DVec2::ZERO, DVec2::ONE);
        let field = BoxField::new(bounds, 1.0, Smootherstep).unwrap();
        assert_eq!(Field::<DVec2>::smoothness(&field), Smoothness::C(2));
        let second = |y: f64| {
            let h = 1e-4;
            let at = |y: f64| field.value(&Site::anywhere(dvec2(1.4, y)));
            (at(y + h) - 2.0 * at(y) + at(y - h)) / (h * h)
        };
        assert!((second(1.0 + 2e-4) - second(1.0 - 2e-4)).abs() < 0.05);
    }

    #[test]
    fn bad_parameters_are_refused() {
        let bounds = Bounds::new(DVec3::ZERO, DVec3::ONE);
        assert!(matches!(
            BoxField::new(bounds, -0.1, Smoothstep),
            Err(FieldError::NotPositive { what: "margin", .. })
        ));
        let error = BoxField::new(bounds, 1.0, InverseDistance::DEFAULT).unwrap_err();
        assert!(error.to_string().contains("inverse-distance"));
        assert!(BoxField::new(bounds, 1.0, Fab::new(-1.0, 1.0).unwrap()).is_err());
        assert_eq!(
            HalfSpace::new(DVec2::ZERO, DVec2::ZERO, 1.0, Smoothstep).unwrap_err(),
            FieldError::NullDirection { what: "normal" }
        );
        assert!(HalfSpace::new(DVec2::ZERO, DVec2::X, f64::NAN, Smoothstep).is_err());
    }
}
