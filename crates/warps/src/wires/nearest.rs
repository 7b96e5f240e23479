//! Wires: curves that a modeller bends, and the surface near them follows.
//!
//! Computes eq. (3) with one term a wire: the transformation `T(v)` of [`wire`](super::wire) at the parameter of the source's nearest
//! point, its strength there, and the weight `s^k ‖(s·T)⟨p⟩ − p‖^m`, `k` the locality and `m` the exponent. Wires that do not
//! reach a point take no part.
//!
//! Where a point has two nearest places the warp may tear; [`ContinuousWires`](super::ContinuousWires) does not.
//!
//! *Source*: K. Singh and E. Fiume, *Wires: A Geometric Deformation Technique*, SIGGRAPH 1998; Milliron et al. 2002, §4.4;
//! errata F8 (rotation), F9 (weights), F10 (nearest places).

use super::wire::{Prepared, Wire};
use super::{WireError, number, prepared};
use anamorph_core::{
    Address, Affine, Bounds, Condition, Deformation, Facts, Influence, Influences, Mark, Site,
    Smoothness, Space, Support, Unmapped, Warp, evaluate_points,
};
use anamorph_transforms::Rotational;

/// A warp by wires, each acting from its nearest point.
pub struct Wires<S: Space> {
    wires: Vec<Prepared<S>>,
    /// A box around all that any wire may move.
    bounds: Bounds<S>,
}

impl<S: Rotational> Wires<S> {
    /// The warp by these wires. With a `view`, a direction of space, every point keeps its depth along it.
    ///
    /// # Errors
    /// [`WireError`] for curves that are not finite, radii that are not positive and numbers out of range.
    pub fn construct(wires: Vec<Wire<S>>, view: Option<S>) -> Result<Self, WireError> {
        let wires = prepared(wires, view)?;
        let bounds = super::support(&wires).ok_or(WireError::None)?;
        Ok(Self { wires, bounds })
    }

    /// The curves for pictures.
    pub fn marks(&self) -> Vec<Mark<S>> {
        super::marks(&self.wires)
    }
}

impl<S: Rotational> Deformation<S> for Wires<S> {
    fn map(&self, site: &Site<S>) -> S {
        super::within(self.bounds, self, site)
    }

    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        evaluate_points(self, first, points)
    }

    fn facts(&self) -> Facts<S> {
        let mut facts = Facts {
            support: Support::Box(self.bounds),
            inside: Smoothness::Jump,
            edge: Smoothness::Jump,
            translations_only: false,
            weights_follow_targets: self.wires.iter().any(|w| w.wire.exponent != 0.0),
            strength_blends: false,
            ..Facts::identity()
        };
        facts = facts.with_note(
            "where a point has two nearest places on a wire the warp may tear; `continuous-wires` does not",
        );
        if self.wires.len() > 1 && self.wires.iter().any(|w| w.wire.exponent <= 0.0) {
            facts = facts.with_note(
                "a wire of exponent 0 or less has a say as soon as it reaches a point: where its radius ends inside \
                 another wire's, the warp jumps",
            );
        }
        facts
    }
}

impl<S: Rotational> Warp<S> for Wires<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        if !self.bounds.contains(site.point) {
            return;
        }
        for (feature, wire) in self.wires.iter().enumerate() {
            let Some(nearest) = wire.wire.source.nearest_within(site.point, wire.reach) else {
                continue;
            };
            let strength = wire.strength(site.point, nearest.parameter, nearest.point);
            if strength != 0.0 {
                let address = Address {
                    feature: number(feature),
                    at: nearest.parameter,
                };
                out.push(address, strength, wire.local_weight(strength));
            }
        }
    }

    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        match self.wires.get(address.feature as usize) {
            Some(wire) if strength != 0.0 => wire.local(address.at).scaled(strength, wire.view),
            _ => Affine::IDENTITY,
        }
    }

    fn weight(&self, influence: &Influence, displacement: S) -> f64 {
        match self.wires.get(influence.address.feature as usize) {
            Some(wire) => wire.weight(influence.weight, influence.strength, displacement),
            None => influence.weight,
        }
    }

    fn conditions(&self) -> Vec<Condition<S>> {
        super::conditions(&self.wires)
    }
}
