//! Continuous wires: Wires without its tears, as an integral over every wire's arc length.
//!
//! Computes eq. (4): every place `v` of every wire is a term with the transformation `T(v)`, the strength `s(v) = f(|p − C(v)|/r)`
//! and the weight `s(v)·s(v)^k·‖(s·T)⟨p⟩ − p‖^m ds`, `ds` the source's arc length, so that another parameter of the curve changes
//! nothing. A [`Sampling`] says where the integral is sampled:
//!
//! | sampling | nodes | error |
//! | --- | --- | --- |
//! | nearest | the nearest place alone, with mass 1 | none of its own: it is Wires with `s` in the weight, tears included |
//! | uniform | the middles of equal cells of length | falls with the square of the cells |
//! | Gauss–Legendre | on every smooth piece of the source | falls fast until the edge of the reach, where weights are C¹, is met |
//! | adaptive | by Gauss–Kronrod panels for each point | at most its tolerance, relative to the wire's largest displacement |
//!
//! Adaptive panels are halved until the integrals of the weight and of weight × displacement have converged. Where they are halved
//! follows the target, too, because its corners, and places that hardly move, are what is hard to integrate; a binding keeps the
//! nodes of the target that it was made with, which is a quadrature for any other target, though not one of its tolerance. Uniform
//! and Gauss–Legendre nodes are those of the source alone, and with them the warp is exactly as smooth as
//! [`facts`](Deformation::facts) says; with adaptive ones it may jump by as much as the tolerance.
//!
//! The price of continuity: targets are met approximately (FW §7.2).
//!
//! *Source*: Milliron et al. 2002, §5.3, Fig. 16, eq. (4); errata F9, F17.

use super::tangents::Tangents;
use super::wire::{Local, Prepared, Wire};
use super::{WireError, number, prepared};
use anamorph_core::sampling::{Node, Sampling, adaptive};
use anamorph_core::{
    Address, Affine, Bounds, Condition, Deformation, Facts, Influence, Influences, Mark, Site,
    Smoothness, Space, Support, Unmapped, Warp, evaluate_points,
};
use anamorph_transforms::Rotational;

/// Nodes that are left out together where they are out of reach.
const BLOCK: usize = 16;
/// Halvings of a panel until it is shorter than half the radius.
const HALVINGS: u32 = 16;
/// How much better the integrals are than the tolerance: the average is a quotient, to whose error both contribute.
const SAFETY: f64 = 0.05;
/// Displacements below this share of the largest count as that where panels are halved: weights with negative exponents are infinite
/// where nothing moves.
const STILL: f64 = 1e-6;

/// A node with what does not depend on the point.
struct Sample<S: Space> {
    at: f64,
    /// Its share of the arc length, in scene units.
    length: f64,
    local: Local<S>,
}

/// A part of a wire with a ball around it.
#[derive(Clone, Copy)]
struct Part<S> {
    centre: S,
    radius: f64,
    /// Indices of samples, or parameters of a panel.
    from: f64,
    to: f64,
}

/// What is prepared of a wire's integral.
struct Course<S: Space> {
    samples: Vec<Sample<S>>,
    parts: Vec<Part<S>>,
    /// No point is displaced by more than about this; 0 for a wire that stays.
    largest: f64,
}

/// The largest displacement that a wire's transformations make within its reach, from samples.
fn largest<S: Rotational>(wire: &Prepared<S>) -> f64 {
    let places = wire.source.samples.iter();
    let of = |at: f64| {
        let local = wire.local(at);
        // A turn moves by the chord, at most the angle and at most twice the distance.
        let turned = local.turn.angle.abs().min(2.0) + (local.scale - 1.0).abs();
        local.shift.length() + turned * wire.reach
    };
    places.map(|(at, _)| of(*at)).fold(0.0, f64::max)
}

/// A warp by wires, each acting from all of its length.
pub struct ContinuousWires<S: Space> {
    wires: Vec<Prepared<S>>,
    courses: Vec<Course<S>>,
    sampling: Sampling,
    bounds: Bounds<S>,
}

/// Between two rotation vectors farther apart than this there may be a jump.
const JUMP: f64 = 1.0;

/// The parameters at which a wire's transformation is not smooth: breaks of its source and its target, and where the smallest rotation
/// changes its sense, because the target's direction passes the opposite of the source's. A jump just beside the outermost node of a
/// panel would not be seen.
fn joints<S: Rotational>(wire: &Prepared<S>) -> Vec<f64> {
    let (source, target) = (&wire.source, &wire.target);
    let mut joints = source.curve.breaks();
    if wire.wire.crimp.is_none() {
        let shares = target.curve.breaks().into_iter().map(|v| target.share(v));
        joints.extend(shares.map(|share| source.parameter(share)));
    }
    let apart = |from: f64, to: f64| {
        let (a, b) = (wire.local(from).turn, wire.local(to).turn);
        if S::DIM == 2 {
            (a.angle - b.angle).abs()
        } else {
            (a.axis * a.angle).distance(b.axis * b.angle)
        }
    };
    for pair in source.samples.windows(2) {
        let (mut low, mut high) = (pair[0].0, pair[1].0);
        if apart(low, high) < JUMP {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if apart(low, middle) >= apart(middle, high) {
                high = middle;
            } else {
                low = middle;
            }
        }
        if apart(low, high) >= JUMP {
            joints.push(high);
        }
    }
    let (start, end) = source.domain;
    joints.retain(|v| *v >= start && *v <= end);
    joints.sort_by(f64::total_cmp);
    joints.dedup();
    joints
}

/// Panels of a source for adaptive sampling: between joints, and shorter than half the least radius, so that no reach hides between
/// nodes.
fn panels<S: Rotational>(wire: &Prepared<S>) -> Vec<Part<S>> {
    let source = &wire.source;
    let longest = 0.5 * wire.wire.radius.range().0;
    let joints = joints(wire);
    let mut ends: Vec<f64> = source.samples.iter().map(|(at, _)| *at).collect();
    ends.extend_from_slice(&joints);
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    let mut parts = Vec::new();
    for pair in ends.windows(2) {
        let mut stack = vec![(pair[0], pair[1], 0_u32)];
        while let Some((from, to, depth)) = stack.pop() {
            let (length, middle) = (source.step_length(from, to), 0.5 * (from + to));
            if length > longest && depth < HALVINGS && middle > from && middle < to {
                stack.push((middle, to, depth + 1));
                stack.push((from, middle, depth + 1));
                continue;
            }
            if length > 0.0 {
                parts.push(Part {
                    centre: source.curve.point(middle),
                    radius: 1.05 * length,
                    from,
                    to,
                });
            }
        }
    }
    merged(source, parts, longest, &joints)
}

/// Neighbouring panels without a joint between them as one, as long as it is short enough.
fn merged<S: Rotational>(
    source: &Tangents<S>,
    parts: Vec<Part<S>>,
    longest: f64,
    breaks: &[f64],
) -> Vec<Part<S>> {
    let mut out: Vec<Part<S>> = Vec::new();
    for part in parts {
        if let Some(last) = out.last_mut()
            && last.to == part.from
            && (last.radius + part.radius) / 1.05 <= longest
            && breaks
                .binary_search_by(|b| b.total_cmp(&part.from))
                .is_err()
        {
            last.to = part.to;
            last.radius += part.radius;
            last.centre = source.curve.point(0.5 * (last.from + last.to));
            continue;
        }
        out.push(part);
    }
    out
}

impl<S: Rotational> Course<S> {
    fn new(wire: &Prepared<S>, sampling: Sampling) -> Self {
        let Some(nodes) = wire.source.nodes(sampling) else {
            let parts = match sampling {
                Sampling::Adaptive(_) => panels(wire),
                _ => Vec::new(),
            };
            return Self {
                samples: Vec::new(),
                parts,
                largest: largest(wire),
            };
        };
        let samples: Vec<Sample<S>> = nodes
            .iter()
            .map(|Node { at, weight }| Sample {
                at: *at,
                length: *weight,
                local: wire.local(*at),
            })
            .collect();
        let blocks = samples.chunks(BLOCK).enumerate();
        let parts = blocks.map(|(i, block)| {
            let middle = block[block.len() / 2].local.centre;
            let radii = block.iter().map(|s| s.local.centre.distance(middle));
            Part {
                centre: middle,
                radius: radii.fold(0.0, f64::max) * (1.0 + 1e-12),
                from: (i * BLOCK) as f64,
                to: (i * BLOCK + block.len()) as f64,
            }
        });
        Self {
            parts: parts.collect(),
            samples,
            largest: 0.0,
        }
    }

    fn sample(&self, at: f64) -> Option<&Sample<S>> {
        let found = self.samples.binary_search_by(|s| s.at.total_cmp(&at));
        found.ok().map(|i| &self.samples[i])
    }
}

impl<S: Rotational> ContinuousWires<S> {
    /// The warp by these wires with a sampling of their length. With a `view`, a direction of space, every point keeps its depth along
    /// it.
    ///
    /// # Errors
    /// [`WireError`] for curves that are not finite or without length, radii that are not positive and numbers out of range.
    pub fn construct(
        wires: Vec<Wire<S>>,
        sampling: Sampling,
        view: Option<S>,
    ) -> Result<Self, WireError> {
        if !sampling.is_valid() {
            return Err(WireError::Sampling);
        }
        let wires = prepared(wires, view)?;
        let bounds = super::support(&wires).ok_or(WireError::None)?;
        let pointlike = wires.iter().position(|w| w.source.polygon <= 0.0);
        if let Some(feature) = pointlike {
            return Err(WireError::NoLength {
                feature,
                which: "source",
            });
        }
        let courses = wires.iter().map(|w| Course::new(w, sampling)).collect();
        Ok(Self {
            wires,
            courses,
            sampling,
            bounds,
        })
    }

    /// The curves for pictures.
    pub fn marks(&self) -> Vec<Mark<S>> {
        super::marks(&self.wires)
    }

    /// The nodes of one wire at a point, for one tolerance.
    fn adaptive_nodes(
        wire: &Prepared<S>,
        course: &Course<S>,
        point: S,
        common: f64,
        tolerance: f64,
    ) -> Vec<Node> {
        let parts = course.parts.iter();
        let near = parts
            .filter(|part| part.centre.distance(point) < wire.reach + part.radius)
            .map(|part| (part.from, part.to));
        let mut nodes = Vec::new();
        let mut integrand = |at: f64| {
            let local = wire.local(at);
            let strength = wire.strength_with(point, at, local.centre, common);
            if strength == 0.0 {
                return [0.0; 4];
            }
            let speed = wire.source.curve.velocity(at).length();
            let moved = local.scaled(strength, wire.view).displacement(point);
            let size = moved.length().max(STILL * course.largest);
            let base = strength * wire.local_weight(strength) * speed;
            let weight = wire.weight_of_size(base, strength, size);
            let mut values = [weight, 0.0, 0.0, 0.0];
            for axis in 0..S::DIM {
                values[1 + axis] = weight * (moved.component(axis) / course.largest);
            }
            values
        };
        if course.largest == 0.0 {
            return nodes;
        }
        adaptive(near, SAFETY * tolerance, &mut integrand, &mut nodes);
        nodes
    }
}

impl<S: Rotational> Deformation<S> for ContinuousWires<S> {
    fn map(&self, site: &Site<S>) -> S {
        super::within(self.bounds, self, site)
    }

    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        evaluate_points(self, first, points)
    }

    fn facts(&self) -> Facts<S> {
        let mut facts = Facts {
            support: Support::Box(self.bounds),
            translations_only: false,
            weights_follow_targets: self.wires.iter().any(|w| w.wire.exponent != 0.0),
            strength_blends: false,
            weights_fade: true,
            ..Facts::identity()
        };
        for wire in &self.wires {
            let spec = &wire.wire;
            // At the edge of a node's reach its strength and its displacement vanish like f, its weight like f^(1+k+m).
            let fades = 1.0 + spec.locality + spec.exponent > 0.0;
            let mut class = spec.falloff.smoothness().min(Smoothness::C(1));
            if spec.exponent != 0.0 || spec.domain.is_some() {
                // The average has a corner where all displacements vanish.
                class = class.min(Smoothness::C(0));
            }
            if self.wires.iter().any(|w| w.wire.locality != spec.locality) {
                // Weights that end at different rates leave a corner where the last of them ends.
                class = class.min(Smoothness::C(0));
            }
            if !fades {
                class = Smoothness::Jump;
                facts = facts.with_note(
                    "the weight of a wire with so negative an exponent does not end where its strength does: the warp jumps \
                     there; raise `exponent`, or `locality`",
                );
            }
            facts.inside = facts.inside.min(class);
        }
        match self.sampling {
            Sampling::Nearest => {
                facts.inside = Smoothness::Jump;
                facts = facts.with_note(
                    "sampled at the nearest place alone, the warp tears where there are two; sample it uniformly",
                );
            }
            Sampling::Adaptive(tolerance) => {
                facts.inside = Smoothness::Jump;
                facts = facts.with_note(format!(
                    "adaptive sampling takes other nodes from point to point: the warp is continuous up to its tolerance, about \
                     {tolerance:e} of a displacement",
                ));
            }
            Sampling::Uniform(_) | Sampling::GaussLegendre(_) => {}
        }
        facts.edge = facts.inside;
        facts
    }
}

impl<S: Rotational> Warp<S> for ContinuousWires<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        let point = site.point;
        if !self.bounds.contains(point) {
            return;
        }
        for (feature, (wire, course)) in self.wires.iter().zip(&self.courses).enumerate() {
            let feature = number(feature);
            let mut push = |at: f64, strength: f64, length: f64| {
                if strength != 0.0 {
                    let weight = strength * wire.local_weight(strength) * length;
                    out.push(Address { feature, at }, strength, weight);
                }
            };
            match self.sampling {
                Sampling::Nearest => {
                    let reached = wire.wire.source.nearest_within(point, wire.reach);
                    if let Some(nearest) = reached {
                        let at = nearest.parameter;
                        push(at, wire.strength(point, at, nearest.point), 1.0);
                    }
                }
                Sampling::Adaptive(tolerance) => {
                    let common = wire.common_strength(point);
                    let nodes = Self::adaptive_nodes(wire, course, point, common, tolerance);
                    for Node { at, weight } in nodes {
                        let jet = wire.source.curve.jet(at);
                        let strength = wire.strength_with(point, at, jet.point, common);
                        push(at, strength, weight * jet.first.length());
                    }
                }
                Sampling::Uniform(_) | Sampling::GaussLegendre(_) => {
                    let mut common = None;
                    for part in &course.parts {
                        if part.centre.distance(point) >= wire.reach + part.radius {
                            continue;
                        }
                        let common = *common.get_or_insert_with(|| wire.common_strength(point));
                        for sample in &course.samples[part.from as usize..part.to as usize] {
                            let centre = sample.local.centre;
                            let strength = wire.strength_with(point, sample.at, centre, common);
                            push(sample.at, strength, sample.length);
                        }
                    }
                }
            }
        }
    }

    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        let feature = address.feature as usize;
        let (Some(wire), Some(course)) = (self.wires.get(feature), self.courses.get(feature))
        else {
            return Affine::IDENTITY;
        };
        match course.sample(address.at) {
            Some(sample) => sample.local.scaled(strength, wire.view),
            None => wire.local(address.at).scaled(strength, wire.view),
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
