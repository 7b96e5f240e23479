//! Schedules: a warp whose features come in at different times.
//!
//! *Source*: Milliron et al. 2002, §8.1: of the four ways to vary a warp over time, the second (transformations between the identity and
//! themselves) and the third (strengths from 0 to 1) multiply each feature's strength by a number; errata F19: they coincide, as
//! `s·(t·T) = (st)·T`. The first is a mask that is the same everywhere, the fourth another warp at every time.

use crate::{
    Address, Affine, Average, Condition, Deformation, Domain, Facts, Influence, Influences, Site,
    Space, Unmapped, Warp, evaluate, evaluate_points,
};

/// A warp whose strengths are multiplied feature by feature.
pub struct Scheduled<W> {
    warp: W,
    factors: Vec<f64>,
    others: f64,
}

impl<W> Scheduled<W> {
    /// The strengths of feature `i` are multiplied by `factors[i]`, those of features beyond the list by `others`.
    pub fn new(warp: W, factors: Vec<f64>, others: f64) -> Self {
        Self {
            warp,
            factors,
            others,
        }
    }

    fn share(&self, feature: u32) -> f64 {
        let known = self.factors.get(feature as usize);
        known.copied().unwrap_or(self.others)
    }
}

impl<S: Space, W: Warp<S>> Deformation<S> for Scheduled<W> {
    fn map(&self, site: &Site<S>) -> S {
        evaluate(self, site)
    }
    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        evaluate_points(self, first, points)
    }
    fn domain(&self) -> Domain {
        self.warp.domain()
    }
    fn facts(&self) -> Facts<S> {
        // Continuity and support are those of the fields, which stay; what is known of slopes is not, and weights that cancelled
        // among equal features do not among those that are on their way.
        let facts = self.warp.facts();
        Facts {
            inside: facts.inside.min(facts.weights),
            edge: facts.edge.min(facts.weights),
            stretch: None,
            upright: None,
            one_to_one: None,
            ..facts
        }
    }
}

impl<S: Space, W: Warp<S>> Warp<S> for Scheduled<W> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        self.warp.influences(site, out);
    }
    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        let factor = self.share(address.feature);
        self.warp.scaled(address, strength * factor)
    }
    fn factor(&self, address: Address) -> f64 {
        self.warp.factor(address) * self.share(address.feature)
    }
    fn weight(&self, influence: &Influence, displacement: S) -> f64 {
        self.warp.weight(influence, displacement)
    }
    fn average(&self) -> Average {
        self.warp.average()
    }
    fn conditions(&self) -> Vec<Condition<S>> {
        // Whoever is on the way has not arrived.
        let arrived = |c: &Condition<S>| self.share(c.feature) == 1.0;
        self.warp.conditions().into_iter().filter(arrived).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Plane, Term, Terms};
    use glam::dvec2;

    #[test]
    fn features_come_in_one_by_one() {
        let term = |by: Plane| Term::new(Affine::translation(by), 1.0, 1.0);
        let warp = || Terms::new(vec![term(dvec2(2.0, 0.0)), term(dvec2(0.0, 4.0))]);
        let at = |factors: Vec<f64>, others| {
            let site = Site::anywhere(Plane::ZERO);
            Scheduled::new(warp(), factors, others).map(&site)
        };
        assert_eq!(at(vec![1.0, 1.0], 0.0), dvec2(1.0, 2.0));
        assert_eq!(at(vec![1.0], 0.0), dvec2(1.0, 0.0));
        assert_eq!(at(vec![0.0], 0.5), dvec2(0.0, 1.0));
        assert_eq!(at(Vec::new(), 0.0), Plane::ZERO);
    }
}
