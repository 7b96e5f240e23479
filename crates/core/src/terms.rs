//! Warps made of explicit terms, and wrappers that change a warp's fields.
//!
//! *Source*: Milliron et al. 2002, §3.5: a construction function outputs `(T̄, s̄, w̄)`; [`Terms`] is that output as a
//! value. [`Modulated`] multiplies every strength or weight of an existing warp by a field and sets the ambient weight
//! of errata F4.

use crate::deformation::{blend, map_masked, masked_facts, masked_jacobian};
use crate::{
    Address, Affine, Average, Condition, Deformation, Domain, Facts, Field, Influence, Influences,
    Scaling, Site, Smoothness, Space, Support, Transformation, Unmapped, Warp, evaluate,
    evaluate_points,
};

/// One discrete term: a transformation, its strength field and its weight field.
pub struct Term<S: Space> {
    /// The transformation `T` with its scaling method.
    pub transformation: Box<dyn Transformation<S>>,
    /// The strength field `s`.
    pub strength: Box<dyn Field<S>>,
    /// The weight field `w`.
    pub weight: Box<dyn Field<S>>,
}

impl<S: Space> Term<S> {
    /// A term from its three parts.
    pub fn new(
        transformation: impl Transformation<S> + 'static,
        strength: impl Field<S> + 'static,
        weight: impl Field<S> + 'static,
    ) -> Self {
        Self {
            transformation: Box::new(transformation),
            strength: Box::new(strength),
            weight: Box::new(weight),
        }
    }
}

/// A warp given by its terms: the output of any construction function.
pub struct Terms<S: Space> {
    terms: Vec<Term<S>>,
    average: Average,
    conditions: Vec<Condition<S>>,
}

impl<S: Space> Terms<S> {
    /// The warp with the given terms, averaged by weight. Without terms it is the identity.
    pub fn new(terms: Vec<Term<S>>) -> Self {
        Self {
            terms,
            average: Average::Weights,
            conditions: Vec::new(),
        }
    }
    /// The same terms under another average.
    #[must_use]
    pub fn with_average(mut self, average: Average) -> Self {
        self.average = average;
        self
    }
    /// States what the warp is meant to interpolate, for its report.
    #[must_use]
    pub fn with_conditions(mut self, conditions: Vec<Condition<S>>) -> Self {
        self.conditions = conditions;
        self
    }
    /// The terms.
    pub fn terms(&self) -> &[Term<S>] {
        &self.terms
    }
}

impl<S: Space> Deformation<S> for Terms<S> {
    fn map(&self, site: &Site<S>) -> S {
        evaluate(self, site)
    }
    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        evaluate_points(self, first, points)
    }
    fn domain(&self) -> Domain {
        let domain = |t: &Term<S>| t.strength.domain().max(t.weight.domain());
        self.terms.iter().map(domain).max().unwrap_or(Domain::Space)
    }
    fn facts(&self) -> Facts<S> {
        let mut facts = Facts::identity();
        facts.weights_fade = true;
        let mut jumps = false;
        for term in &self.terms {
            let (s, w) = (&term.strength, &term.weight);
            facts.support = facts.support.union(s.support().intersection(w.support()));
            facts.inside = facts.inside.min(s.smoothness()).min(w.smoothness());
            facts.weights = facts.weights.min(w.smoothness());
            facts.weights_fade &= w.smoothness() > Smoothness::Jump;
            facts.translations_only &= term.transformation.is_translation();
            facts.strength_blends &= term.transformation.is_translation()
                || term.transformation.scaling() == Scaling::Displacement;
            // Where the last weight vanishes the average jumps, unless no strength is left there (errata F4).
            jumps |= !(w.positive() && w.support().covers(&s.support()));
        }
        // A weight that vanishes nowhere leaves no place to jump.
        let covered = self
            .terms
            .iter()
            .any(|t| t.weight.positive() && t.weight.support() == Support::Everywhere);
        facts.edge = facts.inside;
        if jumps && !covered && self.average == Average::Weights {
            facts.edge = Smoothness::Jump;
            facts = facts.with_note(
                "jumps where the last weight vanishes, because the strength is not zero there (errata F4); let the \
                 strength fall to 0 inside the weight's support, or set an ambient weight",
            );
        }
        facts
    }
}

impl<S: Space> Warp<S> for Terms<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        for (feature, term) in self.terms.iter().enumerate() {
            let weight = term.weight.value(site);
            if weight > 0.0 {
                out.push(
                    Address::of(u32::try_from(feature).unwrap_or(u32::MAX)),
                    term.strength.value(site),
                    weight,
                );
            }
        }
    }
    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        self.terms
            .get(address.feature as usize)
            .map_or(Affine::IDENTITY, |t| t.transformation.scaled(strength))
    }
    fn average(&self) -> Average {
        self.average
    }
    fn conditions(&self) -> Vec<Condition<S>> {
        self.conditions.clone()
    }
}

/// A warp whose strengths and weights are multiplied by fields, and whose average may be another.
pub struct Modulated<S: Space> {
    warp: Box<dyn Warp<S>>,
    strength: Option<Box<dyn Field<S>>>,
    weight: Option<Box<dyn Field<S>>>,
    ambient: Option<f64>,
    /// What the warp's facts say; asked once, because kernels are asked for every run.
    blends: bool,
}

impl<S: Space> Modulated<S> {
    /// The warp as it is.
    pub fn new(warp: Box<dyn Warp<S>>) -> Self {
        let blends = warp.facts().strength_blends;
        Self {
            warp,
            strength: None,
            weight: None,
            ambient: None,
            blends,
        }
    }
    /// Multiplies every strength by `field`.
    #[must_use]
    pub fn with_strength(mut self, field: Box<dyn Field<S>>) -> Self {
        self.strength = Some(field);
        self
    }
    /// Multiplies every weight by `field`. It matters where the field vanishes, and beside an ambient weight.
    #[must_use]
    pub fn with_weight(mut self, field: Box<dyn Field<S>>) -> Self {
        self.weight = Some(field);
        self
    }
    /// Adds an identity term of weight `ambient > 0` to the denominator (errata F4).
    #[must_use]
    pub fn with_ambient(mut self, ambient: f64) -> Self {
        self.ambient = Some(ambient);
        self
    }

    /// Whether nothing is changed at all: then the warp's kernel serves.
    fn neutral(&self) -> bool {
        let one = |field: &Option<Box<dyn Field<S>>>| {
            field.as_ref().is_none_or(|f| f.constant() == Some(1.0))
        };
        self.ambient.is_none() && one(&self.strength) && one(&self.weight)
    }

    /// The strength factor, if scaling strengths by it is the same as blending the result and nothing else is changed:
    /// then the warp's kernel serves.
    fn blending_strength(&self) -> Option<&dyn Field<S>> {
        let field = self.strength.as_deref()?;
        (self.weight.is_none() && self.ambient.is_none() && self.blends).then_some(field)
    }
}

impl<S: Space> Deformation<S> for Modulated<S> {
    fn map(&self, site: &Site<S>) -> S {
        if self.neutral() {
            return self.warp.map(site);
        }
        match self.blending_strength() {
            Some(field) => blend(site.point, self.warp.map(site), field.value(site)),
            None => evaluate(self, site),
        }
    }

    fn facts(&self) -> Facts<S> {
        let mut facts = self.warp.facts();
        if let Some(strength) = &self.strength {
            facts = masked_facts(facts, strength);
        }
        if !self.neutral() && (self.weight.is_some() || self.ambient.is_some() || !self.blends) {
            // What is known was known of other weights, or of full strength.
            (facts.stretch, facts.upright, facts.one_to_one) = (None, None, None);
        }
        if let Some(weight) = &self.weight {
            facts.inside = facts.inside.min(weight.smoothness());
            facts.weights = facts.weights.min(weight.smoothness());
            facts.weights_fade &= weight.smoothness() > Smoothness::Jump;
            // A weight that vanishes within the warp's reach leaves the rest of the average to jump.
            if !(weight.positive() && weight.support().covers(&facts.support)) {
                // Beside an ambient weight the rest fades with the field, unless weights are infinite: these decide alone up to where it ends.
                if self.ambient.is_none() || !facts.weights_fade {
                    facts.edge = Smoothness::Jump;
                    facts = facts.with_note(
                        "the weight field ends inside the warp: with normalized weights the warp jumps there (errata \
                         F4); use `strength` or `mask` for a smooth end, or set `ambient`",
                    );
                }
                facts.support = facts.support.intersection(weight.support());
            }
        }
        if self.ambient.is_some() {
            facts.inside = facts.inside.min(facts.weights);
            facts.edge = facts.edge.min(facts.weights);
            if facts.edge == Smoothness::Jump && facts.weights_fade {
                facts.edge = facts.inside;
            }
            facts.strength_blends &= self.weight.is_none();
            facts = facts.with_note(
                "an ambient weight ε is in force: a feature of weight w moves by w/(w+ε) of the whole, so that \
                 interpolation is approximate and rigid motions are not reproduced (errata F4)",
            );
        }
        facts
    }

    fn domain(&self) -> Domain {
        let of =
            |field: &Option<Box<dyn Field<S>>>| field.as_ref().map_or(Domain::Space, Field::domain);
        self.warp
            .domain()
            .max(of(&self.strength))
            .max(of(&self.weight))
    }

    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        if self.neutral() {
            return self.warp.map_points(first, points);
        }
        if let Some(field) = self.blending_strength() {
            return map_masked(&self.warp, field, first, points);
        }
        evaluate_points(self, first, points)
    }

    fn keeps_finite(&self) -> bool {
        if self.neutral() {
            self.warp.keeps_finite()
        } else {
            self.blending_strength().is_some()
        }
    }

    fn inverse_at(&self, image: &Site<S>) -> Option<S> {
        self.neutral().then(|| self.warp.inverse_at(image))?
    }

    fn jacobian(&self, site: &Site<S>, size: f64) -> Option<S::Linear> {
        if self.neutral() {
            return self.warp.jacobian(site, size);
        }
        if let Some(field) = self.blending_strength() {
            return masked_jacobian(&self.warp, field, site, size);
        }
        crate::difference_jacobian(self, site, size)
    }
}

impl<S: Space> Warp<S> for Modulated<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        // A constant strength is applied where transformations are scaled, so that a binding outlives its change.
        let strength = match &self.strength {
            Some(field) if field.constant().is_none() => field.value(site),
            _ => 1.0,
        };
        let weight = self.weight.as_ref().map_or(1.0, |f| f.value(site));
        if weight == 0.0 {
            return;
        }
        self.warp.influences(site, out);
        for influence in &mut out.list {
            influence.strength *= strength;
            influence.weight *= weight;
        }
    }
    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        let constant = self.strength.as_ref().and_then(Field::constant);
        self.warp
            .scaled(address, strength * constant.unwrap_or(1.0))
    }
    fn factor(&self, address: Address) -> f64 {
        let constant = self.strength.as_ref().and_then(Field::constant);
        self.warp.factor(address) * constant.unwrap_or(1.0)
    }
    fn weight(&self, influence: &Influence, displacement: S) -> f64 {
        self.warp.weight(influence, displacement)
    }
    fn average(&self) -> Average {
        match (self.ambient, self.warp.average()) {
            (Some(ambient), Average::Weights | Average::Ambient(_)) => Average::Ambient(ambient),
            (_, average) => average,
        }
    }
    fn conditions(&self) -> Vec<Condition<S>> {
        self.warp.conditions()
    }
}
