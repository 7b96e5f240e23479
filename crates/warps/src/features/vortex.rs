//! Vortex: a swirl about a centre (2-D) or a line (3-D) that dies out with distance.
//!
//! Computes eq. (3) with one term: the rotation by `angle` about the centre, strength `f(d/r)`, weight 1, scaled by
//! composition, so that a point at distance `d` turns by `f(d/r)·angle`. In 3-D `d` is the distance to the axis line.
//!
//! *Source*: G. Wolberg, *Digital Image Warping*, IEEE Computer Society Press 1990; Milliron et al. 2002, §3.3, Fig. 5
//! (near the spout of the teapot).

use super::FeatureError;
use anamorph_core::{
    Address, Affine, Deformation, Facts, Influences, Linear, Mark, Role, Scaling, Shape, Site,
    Smoothness, Space, Support, Unmapped, Warp, evaluate, evaluate_points, math,
};
use anamorph_fields::Falloff;

/// A swirl.
#[derive(Debug, Clone, Copy)]
pub struct Vortex<S: Space> {
    centre: S,
    /// Unit direction of the axis; not read in the plane.
    axis: S,
    angle: f64,
    radius: f64,
    falloff: &'static dyn Falloff,
    scaling: Scaling,
}

impl<S: Space> Vortex<S> {
    /// The swirl by `angle` (radians, counter-clockwise, by the right-hand rule about `axis`) at `centre`, dying out over
    /// `radius`. `axis` is not read in the plane.
    ///
    /// # Errors
    /// [`FeatureError`] for numbers that are not finite, an axis without direction, a radius that is not positive.
    pub fn construct(
        centre: S,
        axis: S,
        angle: f64,
        radius: f64,
        falloff: &'static dyn Falloff,
        scaling: Scaling,
    ) -> Result<Self, FeatureError> {
        if !centre.is_finite() {
            return Err(FeatureError::NotFinite { feature: 0 });
        }
        if !angle.is_finite() {
            return Err(FeatureError::Angle);
        }
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(FeatureError::Radius { feature: 0, radius });
        }
        let axis = if S::DIM == 2 {
            S::ZERO
        } else {
            axis.normalized().ok_or(FeatureError::NoAxis)?
        };
        Ok(Self {
            centre,
            axis,
            angle,
            radius,
            falloff,
            scaling,
        })
    }

    /// The part of a vector across the axis.
    fn across(&self, v: S) -> S {
        v - self.axis * self.axis.dot(v)
    }

    fn strength(&self, site: &Site<S>) -> f64 {
        self.falloff
            .value(self.across(site.point - self.centre).length() / self.radius)
    }

    /// Whether angles, not displacements, are scaled: then distances from the axis stay.
    fn turns(&self) -> bool {
        self.scaling == Scaling::Composition
    }

    fn turned(&self, angle: f64) -> Affine<S> {
        Affine::about(self.centre, S::rotation(self.axis, angle), S::ZERO)
    }

    /// The axis, the circle of reach, and a spoke that shows the swirl, for pictures.
    pub fn marks(&self) -> Vec<Mark<S>> {
        const STEPS: u32 = 64;
        let spoke_direction = if S::DIM == 2 {
            S::unit(0)
        } else {
            let least = (0..S::DIM).min_by(|&a, &b| {
                self.axis
                    .component(a)
                    .abs()
                    .total_cmp(&self.axis.component(b).abs())
            });
            self.across(S::unit(least.unwrap_or(0)))
                .normalized()
                .unwrap_or(S::ZERO)
        };
        let rim = (0..=STEPS)
            .map(|i| {
                let angle = core::f64::consts::TAU * f64::from(i) / f64::from(STEPS);
                self.centre + S::rotation(self.axis, angle).apply(spoke_direction) * self.radius
            })
            .collect();
        let mut marks = vec![
            Mark::new(Role::Source, Shape::Point(self.centre)),
            Mark::new(Role::SourceGuide, Shape::Polyline(rim)),
        ];
        if S::DIM == 3 {
            let (from, to) = (
                self.centre - self.axis * self.radius,
                self.centre + self.axis * self.radius,
            );
            marks.push(Mark::new(Role::Source, Shape::Arrow(from, to)));
            marks.push(Mark::new(Role::Target, Shape::Arrow(from, to)));
        } else {
            marks.push(Mark::new(Role::Target, Shape::Point(self.centre)));
        }
        for quarter in 0..4_u32 {
            let direction =
                S::rotation(self.axis, core::f64::consts::FRAC_PI_2 * f64::from(quarter))
                    .apply(spoke_direction);
            let straight: Vec<S> = (0..=STEPS)
                .map(|i| self.centre + direction * (self.radius * f64::from(i) / f64::from(STEPS)))
                .collect();
            let swirled = straight
                .iter()
                .map(|&p| self.map(&Site::anywhere(p)))
                .collect();
            marks.push(Mark::new(Role::SourceGuide, Shape::Polyline(straight)));
            marks.push(Mark::new(Role::Target, Shape::Polyline(swirled)));
        }
        marks
    }
}

impl<S: Space> Deformation<S> for Vortex<S> {
    fn map(&self, site: &Site<S>) -> S {
        evaluate(self, site)
    }
    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        evaluate_points(self, first, points)
    }
    fn facts(&self) -> Facts<S> {
        if math::sin_cos(self.angle) == (0.0, 1.0) && self.scaling == Scaling::Displacement
            || self.angle == 0.0
        {
            return Facts::identity();
        }
        let turns = self.turns();
        let why = || "every circle about the axis is turned as a whole".to_owned();
        let class = self.falloff.smoothness();
        let inside = if class == Smoothness::Jump {
            class
        } else {
            class.max(Smoothness::C(0))
        };
        let support = match (self.falloff.compact(), S::DIM) {
            (true, 2) => Support::Ball {
                centre: self.centre,
                radius: self.radius,
            },
            // A cylinder without end.
            _ => Support::Everywhere,
        };
        Facts {
            support,
            inside,
            edge: inside,
            translations_only: false,
            strength_blends: self.scaling == Scaling::Displacement,
            upright: turns.then(why),
            one_to_one: turns.then(why),
            ..Facts::identity()
        }
    }

    fn inverse_at(&self, image: &Site<S>) -> Option<S> {
        if !self.turns() {
            return None;
        }
        // The distance from the axis stays, and with it the angle.
        let strength = self.strength(image);
        Some(self.turned(-self.angle * strength).apply(image.point))
    }
}

impl<S: Space> Warp<S> for Vortex<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        let strength = self.strength(site);
        if strength != 0.0 {
            out.push(Address::of(0), strength, 1.0);
        }
    }
    fn scaled(&self, _: Address, strength: f64) -> Affine<S> {
        match self.scaling {
            Scaling::Displacement => self.turned(self.angle).lerp_from_identity(strength),
            Scaling::Composition => self.turned(self.angle * strength),
        }
    }
}
