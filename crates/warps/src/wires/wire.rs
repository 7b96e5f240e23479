//! One wire: a source curve, a target curve, and how the source's neighbourhood follows.
//!
//! Computes `T(v) = X∘R∘S` of a parameter `v`: the scale `x` about `C(v)`, the rotation `R` from the source's direction to the
//! target's, and the translation `C*(v*) − C(v)`. A strength multiplies the angle, the translation and `x − 1`. The target
//! parameter `v*` lies at the same share of its domain as `v` of its own, or at the share that `crimp` draws.
//!
//! The strength is `f(d/ρ)·Π (1 − f(a/r_a))`: `d` is the distance to `C(v)`, `ρ` the reach, and `a` the distances to anchor
//! curves, which hold what is near. The reach is the radius `r(v)`, drawn along the wire by locators. With a domain curve `D`
//! it is `r + (|D(v) − C(v)| − r) cos²θ` on the side of `D`, `θ` the angle between `p − C(v)` and `D(v) − C(v)`: straight towards the
//! domain curve the wire reaches just to it.
//!
//! *Source*: K. Singh and E. Fiume, *Wires: A Geometric Deformation Technique*, SIGGRAPH 1998 (wires, falloff, scale, locators,
//! domain and anchor curves); Milliron et al. 2002, §4.4; errata F8, F9. Decisions, because the framework paper leaves these options
//! out: the angular blend towards the domain curve, anchors as factors of the strength, and crimp as a drawn correspondence.
//! A direction of view keeps depth: turns go about it and displacements lose their part along it (W. Corrêa, R. Jensen, C. Thayer,
//! A. Finkelstein, *Texture Mapping for Cel Animation*, SIGGRAPH 1998).

use super::WireError;
use super::tangents::Tangents;
use super::turning::Turning;
use anamorph_core::{Affine, Bounds, Differentiable, Linear, NearestPoint, Space};
use anamorph_fields::{Falloff, Profile, ProfileError, falloffs::Wires};
use anamorph_transforms::{Rotational, Turn};
use std::sync::Arc;

/// What a wire asks of its source curve.
pub trait WireCurve<S: Space>: Differentiable<S> + NearestPoint<S> {}

impl<S: Space, C: Differentiable<S> + NearestPoint<S> + ?Sized> WireCurve<S> for C {}

/// A number along a wire: the same everywhere, or drawn by locators.
#[derive(Debug, Clone, PartialEq)]
pub struct Along {
    form: Form,
    low: f64,
    high: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum Form {
    Constant(f64),
    Drawn(Profile),
}

impl Along {
    /// The same number everywhere.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Self {
            form: Form::Constant(value),
            low: value,
            high: value,
        }
    }

    /// Drawn by locators `[share of the wire's domain, number]`: smooth through them, monotone between them, constant beyond.
    ///
    /// # Errors
    /// Those of [`Profile::through`].
    pub fn through(locators: &[[f64; 2]]) -> Result<Self, ProfileError> {
        let profile = Profile::through(locators)?;
        let numbers = locators.iter().map(|l| l[1]);
        Ok(Self {
            form: Form::Drawn(profile),
            low: numbers.clone().fold(f64::INFINITY, f64::min),
            high: numbers.fold(f64::NEG_INFINITY, f64::max),
        })
    }

    /// The number at a share of the domain.
    #[inline]
    #[must_use]
    pub fn value(&self, share: f64) -> f64 {
        match &self.form {
            Form::Constant(value) => *value,
            Form::Drawn(profile) => profile.value(share).clamp(self.low, self.high),
        }
    }

    /// Least and greatest number over the wire.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        (self.low, self.high)
    }
}

/// A curve that holds what is near it.
#[derive(Clone)]
pub struct Anchor<S: Space> {
    /// The curve.
    pub curve: Arc<dyn WireCurve<S>>,
    /// How far it holds, in scene units.
    pub radius: f64,
}

/// A wire as it is given.
#[derive(Clone)]
pub struct Wire<S: Space> {
    /// The source curve: where the wire lies on the model.
    pub source: Arc<dyn WireCurve<S>>,
    /// The target curve: where it is bent to.
    pub target: Arc<dyn Differentiable<S>>,
    /// Radius of influence `r`, in scene units, greater than 0.
    pub radius: Along,
    /// Scale `x` about the wire; 1 changes nothing.
    pub scale: Along,
    /// Exponent `m` of the displacement in the weight, −16 to 16: with several wires, 0 averages alike, 1 prefers larger
    /// displacements, more so with more, and a negative one prefers smaller.
    pub exponent: f64,
    /// Exponent of the strength in the weight, 0 to 16: the more, the more a place belongs to the wire that is near. 0 in the
    /// framework paper.
    pub locality: f64,
    /// The falloff `f`; one that ends at 1.
    pub falloff: &'static dyn Falloff,
    /// Which share of the target a share of the source follows; `None` for the same.
    pub crimp: Option<Profile>,
    /// A curve towards which the wire reaches just as far as it lies.
    pub domain: Option<Arc<dyn Differentiable<S>>>,
    /// Curves that hold what is near them.
    pub anchors: Vec<Anchor<S>>,
}

impl<S: Space> Wire<S> {
    /// The wire from `source` to `target` with a radius, and nothing else: scale 1, exponent 1, no locality, the falloff of Wires.
    pub fn new(
        source: Arc<dyn WireCurve<S>>,
        target: Arc<dyn Differentiable<S>>,
        radius: f64,
    ) -> Self {
        Self {
            source,
            target,
            radius: Along::constant(radius),
            scale: Along::constant(1.0),
            exponent: 1.0,
            locality: 0.0,
            falloff: &Wires,
            crimp: None,
            domain: None,
            anchors: Vec::new(),
        }
    }
}

/// What becomes of a wire's neighbourhood at one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Local<S: Space> {
    pub(super) centre: S,
    pub(super) shift: S,
    pub(super) turn: Turn<S>,
    pub(super) scale: f64,
}

impl<S: Rotational> Local<S> {
    /// `s·T`: angle·s, translation·s, `1 + (x − 1)s`.
    pub(super) fn scaled(&self, strength: f64, view: Option<S>) -> Affine<S> {
        if strength == 0.0 {
            return Affine::IDENTITY;
        }
        let factor = 1.0 + (self.scale - 1.0) * strength;
        let linear = S::rotation(self.turn.axis, self.turn.angle * strength) * factor;
        let affine = Affine::about(self.centre, linear, self.shift * strength);
        match view {
            None => affine,
            Some(view) => flattened(&affine, view),
        }
    }
}

/// An affine map whose displacements lose their part along a unit vector.
fn flattened<S: Space>(affine: &Affine<S>, view: S) -> Affine<S> {
    let flat = |v: S| v - view * view.dot(v);
    let change = affine.linear - S::Linear::IDENTITY;
    Affine::new(
        S::Linear::IDENTITY + S::Linear::from_columns(|i| flat(change.column(i))),
        flat(affine.translation),
    )
}

/// A wire, prepared.
pub(super) struct Prepared<S: Space> {
    pub(super) wire: Wire<S>,
    pub(super) source: Tangents<S>,
    pub(super) target: Tangents<S>,
    turning: Turning<S>,
    domain: Option<Tangents<S>>,
    /// The wire changes nothing farther than this from its source.
    pub(super) reach: f64,
    pub(super) view: Option<S>,
}

impl<S: Rotational> Prepared<S> {
    /// Checks and prepares a wire. `feature` is its number.
    pub(super) fn new(feature: usize, wire: Wire<S>, view: Option<S>) -> Result<Self, WireError> {
        let (low, high) = wire.radius.range();
        if !(low > 0.0 && high.is_finite()) {
            let radius = if low > 0.0 { high } else { low };
            return Err(WireError::Radius { feature, radius });
        }
        let (least, most) = wire.scale.range();
        if !(least.is_finite() && most.is_finite()) {
            return Err(WireError::Number {
                feature,
                what: "scale",
                range: "a finite number",
            });
        }
        if !(-16.0..=16.0).contains(&wire.exponent) {
            return Err(WireError::Number {
                feature,
                what: "exponent",
                range: "a number from -16 to 16",
            });
        }
        if !(0.0..=16.0).contains(&wire.locality) {
            return Err(WireError::Number {
                feature,
                what: "locality",
                range: "a number from 0 to 16",
            });
        }
        if wire.falloff.reach() != Some(1.0) {
            return Err(WireError::Falloff {
                feature,
                name: wire.falloff.name(),
            });
        }
        let sampled =
            |curve, which| Tangents::new(curve).ok_or(WireError::NotFinite { feature, which });
        let source = sampled(wire.source.clone(), "source")?;
        let target = sampled(wire.target.clone(), "target")?;
        let domain = match &wire.domain {
            None => None,
            Some(curve) => Some(sampled(curve.clone(), "domain")?),
        };
        for anchor in &wire.anchors {
            if !(anchor.radius > 0.0 && anchor.radius.is_finite()) {
                return Err(WireError::Radius {
                    feature,
                    radius: anchor.radius,
                });
            }
            sampled(anchor.curve.clone(), "anchor")?;
        }
        // Between samples the domain curve may be a little farther; so that nothing hangs on that, the reach is cut here (see
        // `falloff`).
        let mut reach = high;
        if let Some(domain) = &domain {
            for (at, point) in &source.samples {
                let there = domain.curve.point(domain.parameter(source.share(*at)));
                reach = reach.max(there.distance(*point));
            }
        }
        if !reach.is_finite() {
            return Err(WireError::Radius {
                feature,
                radius: reach,
            });
        }
        let turning = Turning::new(&source, &target, view);
        Ok(Self {
            wire,
            source,
            target,
            turning,
            domain,
            reach,
            view,
        })
    }

    /// The target parameter that a source parameter follows.
    pub(super) fn on_target(&self, at: f64) -> f64 {
        let share = self.source.share(at);
        let share = match &self.wire.crimp {
            None => share,
            Some(profile) => profile.value(share).clamp(0.0, 1.0),
        };
        self.target.parameter(share)
    }

    /// What becomes of the neighbourhood of a parameter.
    pub(super) fn local(&self, at: f64) -> Local<S> {
        let (centre, goal, turn) =
            self.turning
                .at(&self.source, &self.target, at, self.on_target(at));
        Local {
            centre,
            shift: goal - centre,
            turn,
            scale: self.wire.scale.value(self.source.share(at)),
        }
    }

    /// The strength of a point at a place of the source, without anchors.
    #[inline]
    fn falloff(&self, point: S, at: f64, centre: S, distance: f64) -> f64 {
        if distance >= self.reach {
            return 0.0;
        }
        let share = self.source.share(at);
        let mut reach = self.wire.radius.value(share);
        if let Some(domain) = &self.domain {
            let towards = domain.curve.point(domain.parameter(share)) - centre;
            let extent = towards.length();
            let along = (point - centre).dot(towards);
            if along > 0.0 && extent > 0.0 && distance > 0.0 {
                let cosine = (along / extent / distance).min(1.0);
                reach += (extent - reach) * cosine * cosine;
            }
        }
        self.wire.falloff.value(distance / reach.min(self.reach))
    }

    /// What anchors leave of a strength.
    fn held(&self, point: S) -> f64 {
        let mut left = 1.0;
        for anchor in &self.wire.anchors {
            if let Some(nearest) = anchor.curve.nearest_within(point, anchor.radius) {
                left *= 1.0 - self.wire.falloff.value(nearest.distance / anchor.radius);
            }
        }
        left
    }

    /// The strength of a point at a place of the source.
    pub(super) fn strength(&self, point: S, at: f64, centre: S) -> f64 {
        let strength = self.falloff(point, at, centre, point.distance(centre));
        if strength == 0.0 || self.wire.anchors.is_empty() {
            return strength;
        }
        strength * self.held(point)
    }

    /// The part of the strength that is the same for all places of the wire: what anchors leave.
    pub(super) fn common_strength(&self, point: S) -> f64 {
        if self.wire.anchors.is_empty() {
            1.0
        } else {
            self.held(point)
        }
    }

    /// The strength of a point at a place, where what anchors leave is known.
    #[inline]
    pub(super) fn strength_with(&self, point: S, at: f64, centre: S, common: f64) -> f64 {
        common * self.falloff(point, at, centre, point.distance(centre))
    }

    /// The weight by locality alone.
    #[inline]
    pub(super) fn local_weight(&self, strength: f64) -> f64 {
        power(strength, self.wire.locality)
    }

    /// The weight as finished by the displacement: `w‖δ‖^m` (errata F9).
    #[inline]
    pub(super) fn weight(&self, weight: f64, strength: f64, displacement: S) -> f64 {
        if self.wire.exponent == 0.0 {
            return if strength == 0.0 { 0.0 } else { weight };
        }
        self.weight_of_size(weight, strength, displacement.length())
    }

    /// The same for a displacement of that length.
    #[inline]
    pub(super) fn weight_of_size(&self, weight: f64, strength: f64, size: f64) -> f64 {
        if strength == 0.0 || weight == 0.0 {
            return 0.0;
        }
        if self.wire.exponent < 0.0 && size == 0.0 {
            return f64::INFINITY;
        }
        weight * power(size, self.wire.exponent)
    }

    /// A box around all that the wire may move.
    pub(super) fn support(&self) -> Bounds<S> {
        let mut bounds = self.source.bounds();
        bounds.min -= S::splat(self.reach);
        bounds.max += S::splat(self.reach);
        bounds
    }

    /// The image of a point of the source under the wire alone at strength 1, for conditions.
    pub(super) fn condition(&self, share: f64) -> (S, S) {
        let at = self.source.parameter(share);
        let source = self.source.curve.point(at);
        let target = self.target.curve.point(self.on_target(at));
        let goal = match self.view {
            None => target,
            Some(view) => target - view * view.dot(target - source),
        };
        (source, goal)
    }
}

/// `x` to the power `y`, quickly for the usual ones.
#[inline]
fn power(x: f64, y: f64) -> f64 {
    if y == 0.0 {
        1.0
    } else if y == 1.0 {
        x
    } else if y == 2.0 {
        x * x
    } else {
        anamorph_core::math::pow(x, y)
    }
}
