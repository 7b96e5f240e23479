//! Point features: every source point is carried to its target, the rest follows.
//!
//! Computes eq. (3) with `T_i = P*_i − P_i`, strength `f(d/r_i)` and weight `f(d/r_i)/d²`.
//!
//! *Source*: Milliron et al. 2002, §3.2, eqs. (1)–(3), Figs. 2–4; the weight `1/d²` is D. Shepard's (*A two-dimensional
//! interpolation function for irregularly-spaced data*, ACM 1968). Errata F4: a radius drives strength *and* weight.

use super::{FeatureError, Reach, squared_distance};
use anamorph_core::{
    Address, Affine, Condition, Deformation, Facts, Influences, Mark, Site, Smoothness, Space,
    Support, Unmapped, Warp,
};
use anamorph_features::PointPair;

/// A warp by pairs of points.
#[derive(Debug, Clone, PartialEq)]
pub struct PointWarp<S: Space> {
    pairs: Vec<(PointPair<S>, Reach)>,
}

impl<S: Space> PointWarp<S> {
    /// The warp that carries every pair's source to its target, each within its reach.
    ///
    /// # Errors
    /// [`FeatureError`] for coordinates that are not finite and radii that are not positive.
    pub fn construct(pairs: Vec<(PointPair<S>, Reach)>) -> Result<Self, FeatureError> {
        for (feature, (pair, reach)) in pairs.iter().enumerate() {
            if !(pair.source.is_finite() && pair.target.is_finite()) {
                return Err(FeatureError::NotFinite { feature });
            }
            if let Some(radius) = reach.radius.filter(|r| !(*r > 0.0 && r.is_finite())) {
                return Err(FeatureError::Radius { feature, radius });
            }
        }
        Ok(Self { pairs })
    }

    /// The pairs.
    pub fn pairs(&self) -> &[(PointPair<S>, Reach)] {
        &self.pairs
    }

    /// Points and arrows for pictures.
    pub fn marks(&self) -> Vec<Mark<S>> {
        self.pairs
            .iter()
            .flat_map(|(pair, _)| pair.marks())
            .collect()
    }
}

/// Facts of features with reaches: nothing jumps at the edges, because strength and weight end together.
pub(super) fn reach_facts<S: Space>(reaches: impl Iterator<Item = (S, Reach)>) -> Facts<S> {
    let mut facts = Facts::identity();
    for (origin, reach) in reaches {
        facts.support = facts.support.union(reach.support(origin));
        facts.inside = facts.inside.min(reach.smoothness());
        // The falloff's tip.
        if reach.radius.is_some() && reach.falloff.facts().centre < Smoothness::C(1) {
            facts.kinks.push(origin);
        }
    }
    if facts.support == Support::Nowhere {
        return Facts::identity();
    }
    // Where one reach ends inside others its weight and strength vanish with the falloff's class; where the last ends,
    // the displacement does: as ŵ is 1 there, with the class of the strength.
    facts.edge = facts.inside;
    if facts.inside == Smoothness::Jump {
        facts = facts.with_note("a falloff that does not end at its radius jumps there");
    }
    facts
}

impl<S: Space> Deformation<S> for PointWarp<S> {
    fn map(&self, site: &Site<S>) -> S {
        let (mut moved, mut total) = (S::ZERO, 0.0);
        let (mut infinite, mut count) = (S::ZERO, 0_u32);
        for (pair, reach) in &self.pairs {
            let (strength, weight) = reach.strength_and_weight(squared_distance(site, pair.source));
            if weight == f64::INFINITY {
                infinite += (pair.target - pair.source) * strength;
                count += 1;
            } else if weight > 0.0 {
                moved += (pair.target - pair.source) * (strength * weight);
                total += weight;
            }
        }
        if count > 0 {
            site.point.moved_by(infinite / f64::from(count))
        } else if total > 1e-290 && total < 1e290 {
            site.point.moved_by(moved / total)
        } else {
            // Weights at the ends of the number range: the engine rescales them.
            anamorph_core::evaluate(self, site)
        }
    }

    fn facts(&self) -> Facts<S> {
        reach_facts(self.pairs.iter().map(|(pair, reach)| (pair.source, *reach)))
    }

    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        for (i, point) in points.iter_mut().enumerate() {
            *point = self.map(&Site::new(first + i, *point));
        }
        Unmapped::none()
    }
}

impl<S: Space> Warp<S> for PointWarp<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        for (feature, (pair, reach)) in self.pairs.iter().enumerate() {
            let (strength, weight) = reach.strength_and_weight(squared_distance(site, pair.source));
            if weight > 0.0 {
                out.push(
                    Address::of(u32::try_from(feature).unwrap_or(u32::MAX)),
                    strength,
                    weight,
                );
            }
        }
    }
    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        let pair = self.pairs.get(address.feature as usize);
        Affine::translation(
            pair.map_or(S::ZERO, |(pair, _)| (pair.target - pair.source) * strength),
        )
    }
    fn conditions(&self) -> Vec<Condition<S>> {
        let all = self.pairs.iter().enumerate();
        all.map(|(feature, (pair, _))| Condition {
            feature: u32::try_from(feature).unwrap_or(u32::MAX),
            source: pair.source,
            target: pair.target,
        })
        .collect()
    }
}
