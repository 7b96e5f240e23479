//! Fields of the distance to a point.
//!
//! *Source*: Milliron et al. 2002, §3.2 (Figs. 2–4); errata F4: a radius on the weight alone makes a warp jump at the
//! edge, so that a feature of bounded reach has the strength `f(d/r)` ([`Radial`]) *and* the weight `f(d/r)/d²`
//! ([`RadialWeight`]).

use crate::error::{place, reciprocal};
use crate::{Falloff, FieldError, falloffs};
use anamorph_core::{Field, Site, Smoothness, Space, Support};

/// A ball of influence: what the radial fields share.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ball<S> {
    centre: S,
    radius: f64,
    reciprocal: f64,
}

impl<S: Space> Ball<S> {
    fn new(centre: S, radius: f64) -> Result<Self, FieldError> {
        Ok(Self {
            centre: place(centre, "centre")?,
            radius,
            reciprocal: reciprocal(radius, "radius")?,
        })
    }
    /// The offset from the centre in radii: scaled before it is squared, so that no radius over- or underflows.
    #[inline(always)]
    fn offset(&self, p: S) -> S {
        (p - self.centre) * self.reciprocal
    }
    #[inline(always)]
    fn square(&self, p: S) -> f64 {
        let u = self.offset(p);
        u.dot(u)
    }
    fn support(&self, falloff: &impl Falloff) -> Support<S> {
        match falloff.reach() {
            // Rounding of the scaled offset may leave a trace just outside the exact ball.
            Some(reach) => Support::Ball {
                centre: self.centre,
                radius: self.radius * reach * (1.0 + 4.0 * f64::EPSILON),
            },
            None => Support::Everywhere,
        }
    }
}

/// `f(d/r)`, `d` the distance to a centre: a strength or a mask.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Radial<S, F = &'static dyn Falloff> {
    ball: Ball<S>,
    falloff: F,
}

impl<S: Space, F: Falloff> Radial<S, F> {
    /// The field about `centre` with `radius > 0` in scene units.
    ///
    /// # Errors
    /// [`FieldError`] when the centre is not finite or the radius not positive.
    pub fn new(centre: S, radius: f64, falloff: F) -> Result<Self, FieldError> {
        let ball = Ball::new(centre, radius)?;
        Ok(Self { ball, falloff })
    }
    /// The centre.
    pub fn centre(&self) -> S {
        self.ball.centre
    }
    /// The radius in scene units.
    pub fn radius(&self) -> f64 {
        self.ball.radius
    }
    /// The falloff.
    pub fn falloff(&self) -> &F {
        &self.falloff
    }
}

impl<S: Space, F: Falloff> Field<S> for Radial<S, F> {
    fn value(&self, site: &Site<S>) -> f64 {
        self.falloff.value_of_square(self.ball.square(site.point))
    }
    fn support(&self) -> Support<S> {
        self.ball.support(&self.falloff)
    }
    fn positive(&self) -> bool {
        true
    }
    fn smoothness(&self) -> Smoothness {
        self.falloff.smoothness()
    }
    fn values(&self, _: usize, points: &[S], values: &mut [f64]) {
        let ball = self.ball;
        for (value, &p) in values.iter_mut().zip(points) {
            *value = ball.square(p);
        }
        self.falloff.apply_to_squares(values);
    }
    /// At the centre, where a falloff that is only C⁰ has a cone, the null vector.
    fn gradient(&self, site: &Site<S>, _: f64) -> Option<S> {
        let u = self.ball.offset(site.point);
        let t = u.length();
        Some(match u.normalized() {
            Some(direction) => direction * (self.falloff.derivative(t) * self.ball.reciprocal),
            None => S::ZERO,
        })
    }
}

/// `f(d/r)/d²`, or `1/d²` without a radius: the weight that makes a point feature interpolate. Infinite at the centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RadialWeight<S, F = &'static dyn Falloff> {
    centre: S,
    bounded: Option<(Ball<S>, F)>,
}

impl<S: Space, F: Falloff> RadialWeight<S, F> {
    /// The weight about `centre`, 0 outside the ball of `radius > 0` scene units if there is one.
    ///
    /// # Errors
    /// [`FieldError`] when the centre is not finite or the radius not positive.
    pub fn new(centre: S, radius: Option<f64>, falloff: F) -> Result<Self, FieldError> {
        let bounded = match radius {
            Some(radius) => Some((Ball::new(centre, radius)?, falloff)),
            None => None,
        };
        Ok(Self {
            centre: place(centre, "centre")?,
            bounded,
        })
    }
    /// The weight at the offset `x` from the centre, given `f(d/r)`.
    #[inline(always)]
    fn weight(f: f64, x: S) -> f64 {
        // 0 outside the support, though the square may overflow or vanish.
        if f == 0.0 { 0.0 } else { f / x.dot(x) }
    }
}

impl<S: Space, F: Falloff> Field<S> for RadialWeight<S, F> {
    fn value(&self, site: &Site<S>) -> f64 {
        let f = match &self.bounded {
            Some((ball, falloff)) => falloff.value_of_square(ball.square(site.point)),
            None => 1.0,
        };
        Self::weight(f, site.point - self.centre)
    }
    fn support(&self) -> Support<S> {
        match &self.bounded {
            Some((ball, falloff)) => ball.support(falloff),
            None => Support::Everywhere,
        }
    }
    fn positive(&self) -> bool {
        true
    }
    /// The class of the reciprocal `d²/f` at the centre, where the weight is infinite.
    fn smoothness(&self) -> Smoothness {
        match &self.bounded {
            Some((_, falloff)) => falloff.smoothness(),
            None => Smoothness::Smooth,
        }
    }
    fn values(&self, _: usize, points: &[S], values: &mut [f64]) {
        match &self.bounded {
            Some((ball, falloff)) => {
                for (value, &p) in values.iter_mut().zip(points) {
                    *value = ball.square(p);
                }
                falloff.apply_to_squares(values);
            }
            None => values.fill(1.0),
        }
        for (value, &p) in values.iter_mut().zip(points) {
            *value = Self::weight(*value, p - self.centre);
        }
    }
    /// The null vector at the centre, where the weight is infinite.
    fn gradient(&self, site: &Site<S>, _: f64) -> Option<S> {
        let x = site.point - self.centre;
        let d = x.length();
        let (f, slope) = match &self.bounded {
            Some((ball, falloff)) => {
                let t = ball.offset(site.point).length();
                (falloff.value(t), falloff.derivative(t) * ball.reciprocal)
            }
            None => (1.0, 0.0),
        };
        let gradient = x * ((slope - 2.0 * f / d) / (d * d * d));
        Some(if gradient.is_finite() {
            gradient
        } else {
            S::ZERO
        })
    }
}

/// `1/d^p`: Shepard's weight, infinite at the centre, everywhere else positive. The distance is in scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InverseDistance<S> {
    field: Radial<S, falloffs::InverseDistance>,
}

impl<S: Space> InverseDistance<S> {
    /// The weight about `centre` with `power > 0`.
    ///
    /// # Errors
    /// [`FieldError`] when the centre is not finite or the power not positive.
    pub fn new(centre: S, power: f64) -> Result<Self, FieldError> {
        let falloff = falloffs::InverseDistance::new(power)?;
        let field = Radial::new(centre, 1.0, falloff)?;
        Ok(Self { field })
    }
}

impl<S: Space> Field<S> for InverseDistance<S> {
    fn value(&self, site: &Site<S>) -> f64 {
        self.field.value(site)
    }
    fn support(&self) -> Support<S> {
        Support::Everywhere
    }
    fn positive(&self) -> bool {
        true
    }
    /// The class of the reciprocal, on which normalized weights depend.
    fn smoothness(&self) -> Smoothness {
        Field::<S>::smoothness(&self.field)
    }
    fn values(&self, first: usize, points: &[S], values: &mut [f64]) {
        self.field.values(first, points, values);
    }
    fn gradient(&self, site: &Site<S>, size: f64) -> Option<S> {
        self.field.gradient(site, size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FALLOFFS;
    use crate::falloffs::{Fab, Linear, Smootherstep, Wires};
    use crate::testing::check_field;
    use anamorph_core::glam::{DVec2, DVec3, dvec2, dvec3};

    #[test]
    fn laws_hold_for_every_falloff() {
        for &falloff in FALLOFFS {
            let centre = dvec3(0.3, -0.2, 0.1);
            check_field(&Radial::new(centre, 1.3, falloff).unwrap(), 1.5);
            check_field(&RadialWeight::new(centre, Some(1.3), falloff).unwrap(), 1.5);
            let centre = dvec2(-0.4, 0.2);
            check_field(&Radial::new(centre, 0.7, falloff).unwrap(), 1.5);
            check_field(&RadialWeight::new(centre, Some(0.7), falloff).unwrap(), 1.5);
        }
        check_field(&RadialWeight::new(DVec2::X, None, Wires).unwrap(), 1.5);
        check_field(&InverseDistance::new(DVec3::X, 3.0).unwrap(), 1.5);
        check_field(
            &Radial::new(DVec3::ZERO, 0.5, Fab::new(0.3, 1.8).unwrap()).unwrap(),
            1.0,
        );
    }

    #[test]
    fn weights_are_infinite_at_their_features() {
        let weight = RadialWeight::new(DVec3::ONE, Some(2.0), Wires).unwrap();
        assert_eq!(weight.value(&Site::anywhere(DVec3::ONE)), f64::INFINITY);
        assert_eq!(weight.value(&Site::anywhere(DVec3::ONE * 9.0)), 0.0);
        let at = |x: f64| weight.value(&Site::anywhere(dvec3(1.0 + x, 1.0, 1.0)));
        assert!((at(1.0) - 0.5625).abs() < 1e-15);
        let weight = InverseDistance::new(DVec2::ZERO, 1.0).unwrap();
        assert_eq!(weight.value(&Site::anywhere(DVec2::ZERO)), f64::INFINITY);
        assert!((weight.value(&Site::anywhere(dvec2(3.0, 4.0))) - 0.2).abs() < 1e-15);
    }

    #[test]
    fn radii_of_any_size() {
        for size in [1e-250, 1e-100, 1e100, 1e250] {
            let field = Radial::new(DVec2::ZERO, size, Smootherstep).unwrap();
            let half = Site::anywhere(dvec2(0.3 * size, 0.4 * size));
            assert!((field.value(&half) - 0.5).abs() < 1e-14);
            assert_eq!(field.value(&Site::anywhere(DVec2::ZERO)), 1.0);
            assert_eq!(field.value(&Site::anywhere(dvec2(1.1 * size, 0.0))), 0.0);
        }
    }

    #[test]
    fn bad_parameters_are_refused() {
        for radius in [0.0, -1.0, 1e-320] {
            assert!(matches!(
                Radial::new(DVec2::ZERO, radius, Linear),
                Err(FieldError::NotPositive { what: "radius", .. })
            ));
        }
        assert!(Radial::new(DVec2::ZERO, f64::INFINITY, Linear).is_err());
        assert!(Radial::new(dvec2(f64::NAN, 0.0), 1.0, Linear).is_err());
        assert!(RadialWeight::new(dvec2(0.0, f64::NAN), None, Linear).is_err());
        assert!(InverseDistance::new(DVec2::ZERO, 0.0).is_err());
    }
}
