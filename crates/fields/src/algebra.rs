//! Fields made of fields.
//!
//! *Source*: Milliron et al. 2002, §3.2 and §7.3: products and multiples of fields are fields, no rougher than their
//! roughest part.

use anamorph_core::{Domain, Field, Site, Smoothness, Space, Support};

/// Points a batch handles at a time: 4 KiB of scratch.
const RUN: usize = 512;

/// `a · b`, where 0 wins even over an infinite weight: outside its support a field is nothing.
#[inline(always)]
fn times(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

/// The product of fields; without factors, 1.
pub struct Product<S> {
    factors: Vec<Box<dyn Field<S>>>,
}

impl<S: Space> Product<S> {
    /// The product of the given fields.
    pub fn new(factors: Vec<Box<dyn Field<S>>>) -> Self {
        Self { factors }
    }
    /// The factors.
    pub fn factors(&self) -> &[Box<dyn Field<S>>] {
        &self.factors
    }
}

impl<S: Space> Field<S> for Product<S> {
    fn value(&self, site: &Site<S>) -> f64 {
        self.factors
            .iter()
            .fold(1.0, |product, f| times(product, f.value(site)))
    }
    fn support(&self) -> Support<S> {
        self.factors
            .iter()
            .fold(Support::Everywhere, |s, f| s.intersection(f.support()))
    }
    fn smoothness(&self) -> Smoothness {
        let classes = self.factors.iter().map(Field::smoothness);
        classes.min().unwrap_or(Smoothness::Smooth)
    }
    fn domain(&self) -> Domain {
        let domains = self.factors.iter().map(Field::domain);
        domains.max().unwrap_or(Domain::Space)
    }
    fn positive(&self) -> bool {
        // Of two bounded supports only a box around the common part is known.
        let supports = self.factors.iter().map(Field::support);
        let bounded = supports.filter(|s| *s != Support::Everywhere).count();
        bounded <= 1 && self.factors.iter().all(Field::positive)
    }
    fn constant(&self) -> Option<f64> {
        let mut constants = self.factors.iter().map(Field::constant);
        if constants.clone().any(|c| c == Some(0.0)) {
            return Some(0.0);
        }
        constants.try_fold(1.0, |product, c| Some(times(product, c?)))
    }
    fn values(&self, first: usize, points: &[S], values: &mut [f64]) {
        let Some((head, tail)) = self.factors.split_first() else {
            values.fill(1.0);
            return;
        };
        let mut scratch = [0.0; RUN];
        for (run, (points, values)) in points.chunks(RUN).zip(values.chunks_mut(RUN)).enumerate() {
            let first = first + run * RUN;
            head.values(first, points, values);
            for factor in tail {
                if values.iter().all(|&v| v == 0.0) {
                    break;
                }
                let scratch = &mut scratch[..points.len()];
                factor.values(first, points, scratch);
                for (value, &s) in values.iter_mut().zip(scratch.iter()) {
                    *value = times(*value, s);
                }
            }
            for value in values {
                *value = times(1.0, *value);
            }
        }
    }
    fn gradient(&self, site: &Site<S>, size: f64) -> Option<S> {
        let mut sum = S::ZERO;
        for (i, factor) in self.factors.iter().enumerate() {
            let gradient = factor.gradient(site, size)?;
            let others = self
                .factors
                .iter()
                .enumerate()
                .filter(|(j, _)| *j != i)
                .fold(1.0, |product, (_, f)| times(product, f.value(site)));
            sum += S::from_fn(|axis| times(others, gradient.component(axis)));
        }
        Some(sum)
    }
}

/// `1 − f` for a field in [0, 1]: a mask turned round. Where `f` is infinite, 0.
pub struct Complement<F> {
    field: F,
}

impl<F> Complement<F> {
    /// The complement of `field`.
    pub fn new(field: F) -> Self {
        Self { field }
    }
}

#[inline(always)]
fn complement(f: f64) -> f64 {
    if f.is_finite() { 1.0 - f } else { 0.0 }
}

impl<S: Space, F: Field<S>> Field<S> for Complement<F> {
    fn value(&self, site: &Site<S>) -> f64 {
        complement(self.field.value(site))
    }
    fn support(&self) -> Support<S> {
        if self.constant() == Some(0.0) {
            Support::Nowhere
        } else {
            Support::Everywhere
        }
    }
    fn smoothness(&self) -> Smoothness {
        self.field.smoothness()
    }
    fn domain(&self) -> Domain {
        self.field.domain()
    }
    fn constant(&self) -> Option<f64> {
        self.field.constant().map(complement)
    }
    fn values(&self, first: usize, points: &[S], values: &mut [f64]) {
        self.field.values(first, points, values);
        for value in values {
            *value = complement(*value);
        }
    }
    fn gradient(&self, site: &Site<S>, size: f64) -> Option<S> {
        self.field.gradient(site, size).map(|g| -g)
    }
}

/// A field times a number.
pub struct Scaled<F> {
    field: F,
    factor: f64,
}

impl<F> Scaled<F> {
    /// `factor · field`.
    ///
    /// # Errors
    /// [`FieldError::NotFinite`](crate::FieldError::NotFinite) for a factor that is not finite.
    pub fn new(field: F, factor: f64) -> Result<Self, crate::FieldError> {
        let factor = crate::error::finite(factor, "factor")?;
        Ok(Self { field, factor })
    }
}

impl<S: Space, F: Field<S>> Field<S> for Scaled<F> {
    fn value(&self, site: &Site<S>) -> f64 {
        times(self.field.value(site), self.factor)
    }
    fn support(&self) -> Support<S> {
        if self.factor == 0.0 {
            Support::Nowhere
        } else {
            self.field.support()
        }
    }
    fn smoothness(&self) -> Smoothness {
        self.field.smoothness()
    }
    fn domain(&self) -> Domain {
        self.field.domain()
    }
    fn positive(&self) -> bool {
        self.factor > 0.0 && self.field.positive()
    }
    fn constant(&self) -> Option<f64> {
        if self.factor == 0.0 {
            return Some(0.0);
        }
        self.field.constant().map(|c| times(c, self.factor))
    }
    fn values(&self, first: usize, points: &[S], values: &mut [f64]) {
        self.field.values(first, points, values);
        for value in values {
            *value = times(*value, self.factor);
        }
    }
    fn gradient(&self, site: &Site<S>, size: f64) -> Option<S> {
        self.field.gradient(site, size).map(|g| g * self.factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloffs::{Cosine, Smootherstep, Smoothstep, Wires};
    use crate::testing::check_field;
    use crate::{Attribute, BoxField, HalfSpace, Radial, RadialWeight};
    use anamorph_core::Bounds;
    use anamorph_core::glam::{DVec2, DVec3, dvec2, dvec3};

    #[test]
    fn laws_hold_for_products_complements_and_multiples() {
        let ball = Radial::new(dvec3(0.2, 0.0, 0.1), 1.2, Wires).unwrap();
        let half = HalfSpace::new(DVec3::ZERO, dvec3(1.0, 1.0, 0.0), 0.7, Smootherstep).unwrap();
        let weight = RadialWeight::new(dvec3(-0.3, 0.1, 0.0), Some(1.0), Cosine).unwrap();
        let product = Product::new(vec![Box::new(ball), Box::new(half), Box::new(weight)]);
        check_field(&product, 1.5);
        assert_eq!(product.smoothness(), Smoothness::C(1));
        check_field(&Complement::new(ball), 1.5);
        check_field(&Scaled::new(product, -2.5).unwrap(), 1.5);
        check_field::<DVec2>(&Product::new(vec![]), 1.0);
        let bounds = Bounds::new(DVec2::ZERO, DVec2::ONE);
        let box_field = BoxField::new(bounds, 0.3, Smoothstep).unwrap();
        check_field(&Complement::new(Complement::new(box_field)), 1.5);
    }

    #[test]
    fn nothing_wins_over_infinity() {
        // The weight's centre lies outside the ball.
        let ball = Radial::new(DVec2::ZERO, 1.0, Wires).unwrap();
        let weight = RadialWeight::new(dvec2(5.0, 0.0), None, Wires).unwrap();
        let there = Site::anywhere(dvec2(5.0, 0.0));
        let product = Product::new(vec![Box::new(weight), Box::new(ball)]);
        assert_eq!(weight.value(&there), f64::INFINITY);
        assert_eq!(product.value(&there), 0.0);
        assert_eq!(Scaled::new(weight, 0.0).unwrap().value(&there), 0.0);
        assert_eq!(Complement::new(weight).value(&there), 0.0);
        assert!(Scaled::new(weight, f64::INFINITY).is_err());
    }

    #[test]
    fn facts_follow_the_parts() {
        let ball = Radial::new(DVec2::ZERO, 1.0, Wires).unwrap();
        let product = Product::new(vec![Box::new(ball), Box::new(0.5)]);
        assert_eq!(product.support(), ball.support());
        assert_eq!(product.constant(), None);
        assert_eq!(
            Product::<DVec2>::new(vec![Box::new(0.5), Box::new(4.0)]).constant(),
            Some(2.0)
        );
        let nothing = Product::new(vec![Box::new(ball), Box::new(0.0)]);
        assert_eq!(
            (nothing.constant(), nothing.support()),
            (Some(0.0), Support::Nowhere)
        );
        let paint = Attribute::new("paint", vec![1.0, 0.5]).unwrap();
        let painted = Product::<DVec2>::new(vec![Box::new(ball), Box::new(paint)]);
        assert_eq!(painted.domain(), Domain::Model);
        assert!(painted.gradient(&Site::new(0, DVec2::ZERO), 1.0).is_none());
        check_field(&painted, 1.0);
    }
}
