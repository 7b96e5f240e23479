//! Frame features: every source coordinate frame is carried to its target frame.
//!
//! Computes eq. (3) with `T_i` the affine map that takes frame `f_i` to `f*_i`, scaled by displacement or by composition
//! about the source's origin, strength `f(d/r_i)` and weight `f(d/r_i)/d²`.
//!
//! *Source*: Milliron et al. 2002, §3.3, Fig. 5. Errata F4 (radius on strength and weight), F18 (composition about a
//! centre).

use super::points::reach_facts;
use super::{FeatureError, Reach, squared_distance};
use anamorph_core::{
    Address, Affine, Condition, Deformation, Facts, Influences, Mark, Scaling, Site, Space,
    Transformation, Unmapped, Warp, evaluate, evaluate_points,
};
use anamorph_features::FramePair;
use anamorph_transforms::{Composed, Rotational};

struct Feature<S: Space> {
    pair: FramePair<S>,
    reach: Reach,
    transformation: Box<dyn Transformation<S>>,
}

/// A warp by pairs of coordinate frames.
pub struct FrameWarp<S: Space> {
    features: Vec<Feature<S>>,
    scaling: Scaling,
}

impl<S: Rotational> FrameWarp<S> {
    /// The warp that carries every pair's source frame to its target frame, each within its reach.
    ///
    /// # Errors
    /// [`FeatureError`] for frames that are flat or not finite and radii that are not positive.
    pub fn construct(
        pairs: Vec<(FramePair<S>, Reach)>,
        scaling: Scaling,
    ) -> Result<Self, FeatureError> {
        let mut features = Vec::new();
        for (feature, (pair, reach)) in pairs.into_iter().enumerate() {
            if let Some(radius) = reach.radius.filter(|r| !(*r > 0.0 && r.is_finite())) {
                return Err(FeatureError::Radius { feature, radius });
            }
            let affine = pair
                .affine()
                .map_err(|_| FeatureError::NotFinite { feature })?;
            let transformation: Box<dyn Transformation<S>> = match scaling {
                Scaling::Displacement => Box::new(affine),
                Scaling::Composition => {
                    let composed = Composed::new(affine, pair.source.origin());
                    Box::new(composed.map_err(|_| FeatureError::NotFinite { feature })?)
                }
            };
            features.push(Feature {
                pair,
                reach,
                transformation,
            });
        }
        Ok(Self { features, scaling })
    }
}

impl<S: Space> FrameWarp<S> {
    /// Axes of all frames for pictures, drawn with the given length per unit of their basis vectors.
    pub fn marks(&self, length: f64) -> Vec<Mark<S>> {
        self.features
            .iter()
            .flat_map(|f| f.pair.marks(length))
            .collect()
    }
}

impl<S: Space> Deformation<S> for FrameWarp<S> {
    fn map(&self, site: &Site<S>) -> S {
        evaluate(self, site)
    }
    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        evaluate_points(self, first, points)
    }
    fn facts(&self) -> Facts<S> {
        let mut facts = reach_facts(
            self.features
                .iter()
                .map(|f| (f.pair.source.origin(), f.reach)),
        );
        facts.translations_only = self
            .features
            .iter()
            .all(|f| f.transformation.is_translation());
        facts.strength_blends = facts.translations_only || self.scaling == Scaling::Displacement;
        facts
    }
}

impl<S: Space> Warp<S> for FrameWarp<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        for (number, feature) in self.features.iter().enumerate() {
            let squared = squared_distance(site, feature.pair.source.origin());
            let (strength, weight) = feature.reach.strength_and_weight(squared);
            if weight > 0.0 {
                out.push(
                    Address::of(u32::try_from(number).unwrap_or(u32::MAX)),
                    strength,
                    weight,
                );
            }
        }
    }
    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        let feature = self.features.get(address.feature as usize);
        feature.map_or(Affine::IDENTITY, |f| f.transformation.scaled(strength))
    }
    fn conditions(&self) -> Vec<Condition<S>> {
        let all = self.features.iter().enumerate();
        all.map(|(number, f)| Condition {
            feature: u32::try_from(number).unwrap_or(u32::MAX),
            source: f.pair.source.origin(),
            target: f.pair.target.origin(),
        })
        .collect()
    }
}
