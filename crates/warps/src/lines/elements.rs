//! Elements: points, segments, rectangles and boxes are carried to their targets, and the rest follows.
//!
//! Computes eq. (3) with `T_i` the affine map of the element's frame, strength 1 and weight `(size^p / (a + d))^b`, `d` the
//! distance to the element. An element constrains 0, 1, 2 or 3 basis vectors; the others stay perpendicular and unit.
//!
//! *Source*: A. Lerios, C. D. Garfinkle, M. Levoy, *Feature-Based Volume Metamorphosis*, SIGGRAPH 1995; Milliron et al.
//! 2002, §4.2. Errata F6 (weights at the ends of the range of numbers and on the element). The factor `size^p` is Beier and
//! Neely's; Lerios et al. have `p = 0`, `b = 2`.

use super::contact::{apart, contacts};
use super::segments::Segments;
use super::weights::{SAFE, SizedWeight};
use super::{ElementError, WeightConstants, kernel};
use anamorph_core::simd::{Level, dispatch};
use anamorph_core::{
    Address, Affine, Bounds, Condition, Deformation, Facts, Influences, Linear, Mark, Scaling,
    Site, Smoothness, Space, Support, Transformation, Unmapped, Warp, difference_jacobian,
    evaluate, math,
};
use anamorph_features::ElementPair;
use anamorph_transforms::{Composed, Rotational};

/// A point this close to an element, relative to the coordinates of both, lies on it: rounding leaves no less.
pub(super) const ON: f64 = 2.0 * f64::EPSILON;
/// Elements this close, relative to their coordinates, touch.
const TOUCHING: f64 = 8.0 * f64::EPSILON;

/// An element with all that its term needs.
pub(super) struct Item<S: Space> {
    /// Its number.
    feature: u32,
    pub(super) pair: ElementPair<S>,
    pub(super) weight: SizedWeight,
    transformation: Box<dyn Transformation<S>>,
    /// Linear part of the transformation less the identity.
    pub(super) growth: S::Linear,
    /// From the source's corner to the target's.
    pub(super) shift: S,
    /// Largest coordinate of the source.
    pub(super) reach: f64,
}

impl<S: Space> Item<S> {
    /// How far its transformation moves a point, from the corner, so that no digits get lost far from the origin.
    #[inline(always)]
    fn displacement(&self, p: S) -> S {
        self.shift + self.growth.apply(p - self.pair.source.corner())
    }
    /// Whether a point at distance `d` lies on the element, and nothing else has a say there.
    #[inline(always)]
    fn decides(&self, p: S, d: f64) -> bool {
        // The distance is seldom as small, and then only the whole question is asked.
        d <= ON * self.reach.max(p.largest()) && self.weight.pins()
    }
}

/// A warp by pairs of elements.
pub struct ElementWarp<S: Space> {
    /// Those that have weight.
    active: Vec<Item<S>>,
    /// The same where they are segments of the plane and none decides alone.
    segments: Option<Segments>,
    /// Pairs and maps of all, in their order.
    all: Vec<(ElementPair<S>, Affine<S>)>,
    /// Derived once: it takes pairs of elements.
    facts: Facts<S>,
}

impl<S: Rotational> ElementWarp<S> {
    /// The warp that carries every source element to its target.
    ///
    /// # Errors
    /// [`ElementError`] for constants that are negative or not finite and elements whose map overflows.
    pub fn construct(
        features: &[(ElementPair<S>, WeightConstants)],
        scaling: Scaling,
    ) -> Result<Self, ElementError> {
        let with_maps = features
            .iter()
            .enumerate()
            .map(|(feature, &(pair, constants))| {
                let affine = pair.affine();
                let affine = affine.map_err(|error| ElementError::Feature { feature, error })?;
                Ok((pair, constants, affine))
            });
        Self::with_maps(with_maps.collect::<Result<_, _>>()?, scaling)
    }

    /// The warp of elements with given maps, which take the sources' corners to the targets'.
    pub(super) fn with_maps(
        features: Vec<(ElementPair<S>, WeightConstants, Affine<S>)>,
        scaling: Scaling,
    ) -> Result<Self, ElementError> {
        let (mut active, mut all) = (Vec::new(), Vec::new());
        for (number, (pair, constants, affine)) in features.into_iter().enumerate() {
            constants.check(number)?;
            all.push((pair, affine));
            let weight = constants.of_size(pair.source.size());
            if weight.vanishes() {
                continue;
            }
            let centre = pair.source.corner();
            let transformation: Box<dyn Transformation<S>> = match scaling {
                Scaling::Displacement => Box::new(affine),
                Scaling::Composition => {
                    Box::new(
                        Composed::new(affine, centre).map_err(|_| ElementError::Feature {
                            feature: number,
                            error: anamorph_features::FeatureError::Overflow,
                        })?,
                    )
                }
            };
            let corners = pair.source.corners();
            active.push(Item {
                feature: u32::try_from(number).unwrap_or(u32::MAX),
                pair,
                weight,
                transformation,
                growth: affine.linear - S::Linear::IDENTITY,
                shift: pair.target.corner() - centre,
                reach: corners.iter().fold(0.0, |m, c| c.largest().max(m)),
            });
        }
        let mut facts = facts(&active);
        facts.strength_blends = facts.translations_only || scaling == Scaling::Displacement;
        if active.len() < all.len() {
            let kept = |n: usize| active.iter().any(|i| i.feature as usize == n);
            let idle: Vec<String> = (0..all.len())
                .filter(|&n| !kept(n))
                .map(|n| n.to_string())
                .collect();
            facts = facts.with_note(format!(
                "feature {} has no size and, with p > 0, no weight: it moves nothing",
                idle.join(", ")
            ));
        }
        let segments = Segments::new(&active);
        Ok(Self {
            active,
            segments,
            all,
            facts,
        })
    }
}

/// Continuity of an element's weight. With b = 0 it is a constant. Else the distance has a kink on the element, which a > 0 lets be
/// seen; with a = 0 the others' share goes like d^b there.
fn class(constants: WeightConstants) -> Smoothness {
    match (constants.a, constants.b) {
        (_, 0.0) => Smoothness::Smooth,
        (0.0, b) if b > 1.0 => Smoothness::C(1),
        _ => Smoothness::C(0),
    }
}

/// What the elements promise.
fn facts<S: Space>(items: &[Item<S>]) -> Facts<S> {
    let Some(first) = items.first() else {
        return Facts::identity();
    };
    let mut facts = Facts {
        support: Support::Everywhere,
        ..Facts::identity()
    };
    facts.translations_only = items.iter().all(|i| i.transformation.is_translation());
    facts.weights_fade = items.iter().all(|i| !i.weight.pins());
    let map = |i: &Item<S>| i.transformation.affine();
    for item in items {
        facts.weights = facts.weights.min(class(item.weight.constants));
    }
    // One map everywhere: an affine map.
    if items.iter().all(|i| map(i) == map(first)) {
        if map(first) == Affine::IDENTITY {
            facts.support = Support::Nowhere;
        }
        return facts;
    }
    facts.inside = facts.weights;
    // The distance to an element bends on it: a point is the tip of a cone, a segment a crease.
    for item in items {
        let source = &item.pair.source;
        if class(item.weight.constants) < Smoothness::C(1) {
            match source.dimension() {
                0 => facts.kinks.push(source.corner()),
                1 => facts
                    .creases
                    .push([source.corner(), source.corner() + source.edge(0)]),
                _ => {}
            }
        }
    }
    let pinning: Vec<(&Item<S>, Bounds<S>)> = items
        .iter()
        .filter(|i| i.weight.pins())
        .filter_map(|i| Some((i, Bounds::of(&i.pair.source.corners())?)))
        .collect();
    let mut disputed = None;
    for (n, (one, bounds)) in pinning.iter().enumerate() {
        for (other, other_bounds) in &pinning[..n] {
            let reach = one.reach.max(other.reach);
            if apart(bounds, other_bounds, TOUCHING * reach) || map(one) == map(other) {
                continue;
            }
            let shared = contacts(&one.pair.source, &other.pair.source, TOUCHING * reach);
            if shared.is_empty() {
                continue;
            }
            facts.inside = facts.inside.min(Smoothness::C(0));
            let disagree = |&p: &S| {
                let (one, other) = (one.displacement(p), other.displacement(p));
                let size = reach.max(one.largest()).max(other.largest());
                (one - other).length() > 1e-12 * size
            };
            if disputed.is_none() && shared.iter().any(disagree) {
                disputed = Some((other.feature, one.feature));
            }
        }
    }
    if let Some((one, other)) = disputed {
        facts.inside = Smoothness::Jump;
        facts = facts.with_note(format!(
            "features {one} and {other} touch and take the same points to different places: with a = 0 the warp jumps \
             there, and takes the mean of those of the largest b; set `a` greater than 0, or let them agree"
        ));
    }
    facts.edge = facts.inside;
    facts
}

impl<S: Space> ElementWarp<S> {
    /// Outlines for pictures.
    pub fn marks(&self) -> Vec<Mark<S>> {
        self.all.iter().flat_map(|(pair, _)| pair.marks()).collect()
    }

    /// The map of feature `number` at full strength.
    pub fn affine(&self, number: usize) -> Option<Affine<S>> {
        self.all.get(number).map(|(_, affine)| *affine)
    }

    /// The image of a point that vectors do not serve.
    fn one(&self, p: S) -> S {
        self.moved(p)
            .unwrap_or_else(|| evaluate(self, &Site::anywhere(p)))
    }

    /// The image where weights are of ordinary size and none is infinite.
    #[inline]
    fn moved(&self, p: S) -> Option<S> {
        let (mut moved, mut total) = (S::ZERO, 0.0);
        let (mut least, mut largest) = (f64::INFINITY, 0.0_f64);
        for item in &self.active {
            let d = item.pair.source.distance(p);
            if item.decides(p, d) {
                return None;
            }
            let weight = item.weight.plain(d);
            least = least.min(weight);
            largest = largest.max(weight);
            moved += item.displacement(p) * weight;
            total += weight;
        }
        (SAFE.contains(&least) && SAFE.contains(&largest)).then(|| p.moved_by(moved / total))
    }
}

impl<S: Space> Deformation<S> for ElementWarp<S> {
    fn map(&self, site: &Site<S>) -> S {
        if self.segments.is_some() {
            // The same operations for one point as for many.
            let mut point = [site.point];
            let _ = self.map_points(site.index, &mut point);
            return point[0];
        }
        self.one(site.point)
    }

    fn facts(&self) -> Facts<S> {
        self.facts.clone()
    }

    fn map_points(&self, _: usize, points: &mut [S]) -> Unmapped {
        if self.active.is_empty() {
            return Unmapped::none();
        }
        let one = |p: S| self.one(p);
        if let Some(segments) = &self.segments {
            for index in segments.run(S::coordinates_mut(points)) {
                points[index] = one(points[index]);
            }
            return Unmapped::none();
        }
        if self.active.iter().all(|i| i.pair.source.is_square()) {
            dispatch!(Level::new(), v => kernel::run(v, &self.active, points, &one));
            return Unmapped::none();
        }
        for point in points {
            *point = self.one(*point);
        }
        Unmapped::none()
    }

    /// `J = I + Σ ŵ_i G_i + Σ ŵ_i (d_i − d̄) ∇ln w_iᵀ`, `G_i` the maps less the identity, `d_i` the displacements, `d̄` their
    /// mean. By differences on elements that decide alone.
    fn jacobian(&self, site: &Site<S>, size: f64) -> Option<S::Linear> {
        let p = site.point;
        let mut list = Influences::default();
        self.influences(site, &mut list);
        let total: f64 = list.list.iter().map(|i| i.weight).sum();
        if total == 0.0 {
            return Some(S::Linear::IDENTITY);
        }
        if !total.is_finite() {
            return difference_jacobian(self, site, size);
        }
        let shares = || {
            list.list.iter().filter_map(|influence| {
                let item = self.item(influence.address)?;
                Some((item, influence.weight / total))
            })
        };
        let mean = shares().fold(S::ZERO, |sum, (item, share)| {
            sum + item.displacement(p) * share
        });
        let mut jacobian = S::Linear::IDENTITY;
        for (item, share) in shares() {
            jacobian = jacobian + item.growth * share;
            let offset = item.pair.source.offset(p);
            // On the element, where the distance has no gradient, the mean of the two sides.
            let (d, constants) = (offset.length(), item.weight.constants);
            if d <= ON * item.reach.max(p.largest()) {
                continue;
            }
            let slope = offset / d * (-constants.b / (constants.a + d));
            let apart = (item.displacement(p) - mean) * share;
            jacobian = jacobian + S::Linear::outer(apart, slope);
        }
        Some(jacobian)
    }
}

impl<S: Space> ElementWarp<S> {
    fn item(&self, address: Address) -> Option<&Item<S>> {
        let found = self
            .active
            .binary_search_by_key(&address.feature, |item| item.feature);
        found.ok().and_then(|n| self.active.get(n))
    }
}

impl<S: Space> Warp<S> for ElementWarp<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        let p = site.point;
        let (mut least, mut largest) = (f64::INFINITY, 0.0_f64);
        // The largest b of those that decide alone.
        let mut steepest: Option<f64> = None;
        for item in &self.active {
            let d = item.pair.source.distance(p);
            if item.decides(p, d) {
                let b = item.weight.constants.b;
                steepest = Some(steepest.map_or(b, |s| s.max(b)));
            }
            let weight = item.weight.plain(d);
            least = least.min(weight);
            largest = largest.max(weight);
            out.push(Address::of(item.feature), 1.0, weight);
        }
        if let Some(steepest) = steepest {
            out.clear();
            for item in &self.active {
                let d = item.pair.source.distance(p);
                if item.weight.constants.b == steepest && item.decides(p, d) {
                    out.push(Address::of(item.feature), 1.0, f64::INFINITY);
                }
            }
        } else if !(SAFE.contains(&least) && SAFE.contains(&largest)) {
            let logs = self.active.iter().map(|item| {
                let d = item.pair.source.distance(p);
                item.weight.log(d)
            });
            out.log_scale = logs.clone().fold(f64::NEG_INFINITY, f64::max);
            let most = out.log_scale;
            for (influence, log) in out.list.iter_mut().zip(logs) {
                influence.weight = math::exp(log - most);
            }
        }
    }

    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        self.item(address)
            .map_or(Affine::IDENTITY, |i| i.transformation.scaled(strength))
    }

    /// The corners, the middle, and for segments the quarters.
    fn conditions(&self) -> Vec<Condition<S>> {
        let mut conditions = Vec::new();
        for (number, (pair, _)) in self.all.iter().enumerate() {
            let mut add = |source, target| {
                conditions.push(Condition {
                    feature: u32::try_from(number).unwrap_or(u32::MAX),
                    source,
                    target,
                });
            };
            let (source, target) = (&pair.source, &pair.target);
            if source.dimension() == 0 || source.size() == 0.0 {
                add(source.corner(), target.corner());
                continue;
            }
            let corners = source.corners().into_iter().zip(target.corners());
            corners.for_each(|(from, to)| add(from, to));
            let inner: &[f64] = if source.dimension() == 1 {
                &[0.25, 0.5, 0.75]
            } else {
                &[0.5]
            };
            for &share in inner {
                add(source.at([share; 3]), target.at([share; 3]));
            }
        }
        conditions
    }
}
