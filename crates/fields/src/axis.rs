//! Fields of the coordinate along an axis.
//!
//! *Source*: Milliron et al. 2002, §4.3: Barr's warps are driven by strength fields of the coordinate along an axis.

use crate::error::{direction, finite, place};
use crate::region::Step;
use crate::{Falloff, FieldError, Profile};
use anamorph_core::{Field, Site, Smoothness, Space, Support};

/// Lanes of a batch.
const LANES: usize = 8;

/// A coordinate axis: `z = (p − origin) · direction`, in scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Axis<S> {
    origin: S,
    direction: S,
}

impl<S: Space> Axis<S> {
    fn new(origin: S, axis: S) -> Result<Self, FieldError> {
        Ok(Self {
            origin: place(origin, "origin")?,
            direction: direction(axis, "axis")?,
        })
    }
    #[inline(always)]
    fn coordinate(&self, p: S) -> f64 {
        (p - self.origin).dot(self.direction)
    }
}

/// 0 before a place on an axis, 1 after another, rising in between by a falloff turned round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisRamp<S, F = &'static dyn Falloff> {
    axis: Axis<S>,
    from: f64,
    /// 1 if the ramp rises along the axis, −1 if it falls.
    sense: f64,
    step: Step<F>,
}

impl<S: Space, F: Falloff> AxisRamp<S, F> {
    /// The ramp from 0 at the coordinate `from` to 1 at `to` (in scene units from `origin` along `axis`, which may have any
    /// length); `from > to` falls along the axis. With the falloff `f` it is `1 − f(u)`, `u` running from 0 to 1.
    ///
    /// # Errors
    /// [`FieldError`] when a number is not finite, the axis is null, `from` equals `to`, or the falloff does not lead from
    /// 1 to 0.
    pub fn new(origin: S, axis: S, from: f64, to: f64, falloff: F) -> Result<Self, FieldError> {
        let (from, to) = (finite(from, "start")?, finite(to, "end")?);
        if from == to {
            return Err(FieldError::EmptyRamp { from, to });
        }
        Ok(Self {
            axis: Axis::new(origin, axis)?,
            from,
            sense: if to > from { 1.0 } else { -1.0 },
            step: Step::new(falloff, (to - from).abs(), "length")?,
        })
    }
    #[inline(always)]
    fn along(&self, p: S) -> f64 {
        (self.axis.coordinate(p) - self.from) * self.sense
    }
}

impl<S: Space, F: Falloff> Field<S> for AxisRamp<S, F> {
    fn value(&self, site: &Site<S>) -> f64 {
        1.0 - self.step.value(self.along(site.point))
    }
    fn support(&self) -> Support<S> {
        Support::Everywhere
    }
    fn smoothness(&self) -> Smoothness {
        self.step.smoothness()
    }
    fn values(&self, _: usize, points: &[S], values: &mut [f64]) {
        for (value, &p) in values.iter_mut().zip(points) {
            *value = self.along(p);
        }
        self.step.apply(values);
        for value in values {
            *value = 1.0 - *value;
        }
    }
    fn gradient(&self, site: &Site<S>, _: f64) -> Option<S> {
        let slope = self.step.derivative(self.along(site.point));
        Some(self.axis.direction * (-slope * self.sense))
    }
}

/// A [`Profile`] of the coordinate along an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisProfile<S> {
    axis: Axis<S>,
    profile: Profile,
}

impl<S: Space> AxisProfile<S> {
    /// `profile(z)`, `z` the coordinate in scene units from `origin` along `axis`, which may have any length.
    ///
    /// # Errors
    /// [`FieldError`] when the origin is not finite or the axis null or not finite.
    pub fn new(origin: S, axis: S, profile: Profile) -> Result<Self, FieldError> {
        Ok(Self {
            axis: Axis::new(origin, axis)?,
            profile,
        })
    }
    /// The profile.
    pub fn profile(&self) -> &Profile {
        &self.profile
    }
}

impl<S: Space> Field<S> for AxisProfile<S> {
    fn value(&self, site: &Site<S>) -> f64 {
        self.profile.value(self.axis.coordinate(site.point))
    }
    fn support(&self) -> Support<S> {
        if self.constant() == Some(0.0) {
            Support::Nowhere
        } else {
            Support::Everywhere
        }
    }
    fn smoothness(&self) -> Smoothness {
        self.profile.smoothness()
    }
    fn constant(&self) -> Option<f64> {
        self.profile.as_constant()
    }
    fn values(&self, _: usize, points: &[S], values: &mut [f64]) {
        for (value, &p) in values.iter_mut().zip(points) {
            *value = self.axis.coordinate(p);
        }
        let (blocks, rest) = values.as_chunks_mut::<LANES>();
        for block in blocks {
            (*block, _) = self.profile.values_block(block);
        }
        for value in rest {
            *value = self.profile.value(*value);
        }
    }
    fn gradient(&self, site: &Site<S>, _: f64) -> Option<S> {
        let z = self.axis.coordinate(site.point);
        Some(self.axis.direction * self.profile.derivative(z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FALLOFFS;
    use crate::falloffs::{Linear, Smoothstep};
    use crate::testing::check_field;
    use anamorph_core::glam::{DVec2, DVec3, dvec2, dvec3};

    #[test]
    fn laws_hold_for_every_falloff() {
        for &falloff in FALLOFFS.iter().filter(Falloff::compact) {
            let ramp = AxisRamp::new(
                dvec3(0.1, 0.2, 0.0),
                dvec3(1.0, 1.0, 3.0),
                -0.3,
                0.6,
                falloff,
            );
            check_field(&ramp.unwrap(), 1.5);
            let ramp = AxisRamp::new(DVec2::ZERO, DVec2::Y, 0.5, -0.4, falloff);
            check_field(&ramp.unwrap(), 1.5);
        }
        let points = [[-0.5, 0.0], [0.0, 1.0], [0.2, 0.5], [0.9, 0.4]];
        let profile = Profile::through(&points).unwrap();
        check_field(
            &AxisProfile::new(DVec3::ZERO, DVec3::Z * 2.0, profile).unwrap(),
            1.5,
        );
        let profile = Profile::polynomial(&[0.3, -1.0, 0.5]).unwrap();
        check_field(
            &AxisProfile::new(DVec2::X, DVec2::ONE, profile).unwrap(),
            1.5,
        );
    }

    #[test]
    fn ramps_rise_and_fall() {
        let up = AxisRamp::new(DVec2::X, DVec2::X * 3.0, 1.0, 3.0, Linear).unwrap();
        let down = AxisRamp::new(DVec2::X, DVec2::X, 3.0, 1.0, Linear).unwrap();
        for (x, rising) in [(0.0, 0.0), (2.0, 0.0), (2.5, 0.25), (4.0, 1.0), (9.0, 1.0)] {
            let site = Site::anywhere(dvec2(x, -7.0));
            assert_eq!(up.value(&site), rising);
            assert_eq!(down.value(&site), 1.0 - rising);
        }
    }

    #[test]
    fn constants_are_seen() {
        let zero = Profile::polynomial(&[0.0]).unwrap();
        let field = AxisProfile::new(DVec3::ZERO, DVec3::X, zero).unwrap();
        assert_eq!(
            (field.constant(), field.support()),
            (Some(0.0), Support::Nowhere)
        );
    }

    #[test]
    fn bad_parameters_are_refused() {
        assert!(matches!(
            AxisRamp::new(DVec2::ZERO, DVec2::X, 1.0, 1.0, Smoothstep),
            Err(FieldError::EmptyRamp { .. })
        ));
        assert!(AxisRamp::new(DVec2::ZERO, DVec2::ZERO, 0.0, 1.0, Smoothstep).is_err());
        assert!(AxisRamp::new(DVec2::ZERO, DVec2::X, f64::NAN, 1.0, Smoothstep).is_err());
    }
}
