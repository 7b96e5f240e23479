//! Warps by free-standing features: points, frames, and the vortex.
//!
//! *Source*: Milliron et al. 2002, §3.2–3.3.

pub mod frames;
#[cfg(feature = "recipe")]
pub(crate) mod parameters;
pub mod points;
pub mod vortex;

#[cfg(feature = "recipe")]
pub(crate) use parameters::turn_and_scale;

use anamorph_core::{Site, Smoothness, Space, Support};
use anamorph_fields::Falloff;

/// What is wrong with a feature warp.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FeatureError {
    /// A feature that is not finite.
    #[error("feature {feature} has a coordinate that is not finite; give finite numbers")]
    NotFinite {
        /// Number of the feature.
        feature: usize,
    },
    /// A radius that is not a positive number.
    #[error("the radius of feature {feature} is {radius}, and must be greater than 0")]
    Radius {
        /// Number of the feature.
        feature: usize,
        /// The radius given.
        radius: f64,
    },
    /// A frame whose basis has no volume.
    #[error(
        "the {which} frame of feature {feature} is flat: its vectors are dependent; give independent ones"
    )]
    Flat {
        /// Number of the feature.
        feature: usize,
        /// `source` or `target`.
        which: &'static str,
    },
    /// A direction without length.
    #[error("the axis has no direction: give a finite vector that is not zero")]
    NoAxis,
    /// An angle that is not finite.
    #[error("the angle is not finite")]
    Angle,
}

/// How far a feature reaches.
///
/// With a radius `r` the strength is `f(d/r)` and the weight `f(d/r)/d²`, `d` the distance to the feature's origin: the
/// feature is met exactly, and strength and weight end together, so that nothing jumps (a radius on the weight alone would:
/// errata F4). Without a radius the strength is 1 everywhere and the weight `1/d²` (Shepard).
#[derive(Debug, Clone, Copy)]
pub struct Reach {
    /// The radius in scene units; `None` reaches everywhere.
    pub radius: Option<f64>,
    /// The falloff `f`.
    pub falloff: &'static dyn Falloff,
}

impl PartialEq for Reach {
    fn eq(&self, other: &Self) -> bool {
        self.radius == other.radius && self.falloff.name() == other.falloff.name()
    }
}

impl Reach {
    /// Strength and weight at a squared distance.
    #[inline]
    pub fn strength_and_weight(&self, squared: f64) -> (f64, f64) {
        let strength = match self.radius {
            None => 1.0,
            Some(radius) => {
                if squared >= radius * radius {
                    return (0.0, 0.0);
                }
                self.falloff.value(squared.sqrt() / radius)
            }
        };
        // 1/0 is +∞: at the feature itself it decides alone.
        (strength, strength / squared)
    }

    /// Where a feature at `origin` has a say.
    pub fn support<S: Space>(&self, origin: S) -> Support<S> {
        match self.radius {
            None => Support::Everywhere,
            Some(radius) => Support::Ball {
                centre: origin,
                radius,
            },
        }
    }

    /// Continuity inside the support. The weight `1/d²` makes the average smooth at a lone feature and, at a feature among
    /// others, C¹ (Shepard's method with an even exponent; the second derivative exists too, but we claim what is needed).
    pub fn smoothness(&self) -> Smoothness {
        if self.radius.is_none() {
            Smoothness::C(1)
        } else {
            self.falloff.smoothness().min(Smoothness::C(1))
        }
    }
}

pub(crate) fn squared_distance<S: Space>(site: &Site<S>, origin: S) -> f64 {
    let d = site.point - origin;
    d.dot(d)
}
