//! Deformations: everything that moves sites.
//!
//! *Source*: Milliron et al. 2002, §3.1: `M̃(u) = D(u, M)⟨M(u)⟩`. Stacks, masks and inverses are deformations; a warp is
//! a deformation with terms ([`crate::Warp`]).

use crate::{Affine, Domain, Field, Linear, Site, Smoothness, Space, Support};

/// Small facts about a deformation from which guarantees are derived. Every part declares its own; wrappers combine.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts<S> {
    /// Outside this set the deformation is exactly the identity.
    pub support: Support<S>,
    /// Continuity of the moved point inside the support.
    pub inside: Smoothness,
    /// Continuity of the moved point across the edge of the support (errata F3, F4). Equal to `inside` or better where
    /// there is no edge.
    pub edge: Smoothness,
    /// All transformations are translations.
    pub translations_only: bool,
    /// Weights depend on the transformations (Wires: errata F9), so that a strength factor is no blend.
    pub weights_follow_targets: bool,
    /// Multiplying every strength by `m` equals blending the result, `p + m(D(p) − p)`: displacement scaling and weights
    /// that ignore targets.
    pub strength_blends: bool,
    /// Weights fall to 0 continuously wherever they end, so that an ambient weight removes a jump at the edge (errata F4).
    /// Those of a lattice do not: they sum to 1 up to the faces of its box.
    pub weights_fade: bool,
    /// Continuity of the weights by themselves: what a single feature does not show, as its weight cancels, but an ambient weight and
    /// features that come in at different times do.
    pub weights: Smoothness,
    /// A bound of `‖J − I‖` (spectral norm) wherever the Jacobian `J` exists. Below 1 the determinant is positive; where the
    /// deformation is continuous, too, it has an inverse (the displacement contracts).
    pub stretch: Option<f64>,
    /// Why the Jacobian determinant is positive wherever it exists, where more than a bound is known.
    pub upright: Option<String>,
    /// Why no two places have the same image, where more than a bound is known.
    pub one_to_one: Option<String>,
    /// Places where the Jacobian jumps although `inside` is at least continuous, as far as they are single points: the
    /// centres of cones. A hint for whoever samples the deformation; more such places may exist, and none need be in the support.
    pub kinks: Vec<S>,
    /// Straight pieces along which it jumps, by their ends; a hint, too.
    pub creases: Vec<[S; 2]>,
    /// Sentences a report should carry: which limits are in force, where continuity is lost, what repairs it.
    pub notes: Vec<String>,
}

impl<S: Space> Facts<S> {
    /// The facts of the identity.
    pub fn identity() -> Self {
        Self {
            support: Support::Nowhere,
            inside: Smoothness::Smooth,
            edge: Smoothness::Smooth,
            translations_only: true,
            weights_follow_targets: false,
            strength_blends: true,
            weights_fade: false,
            weights: Smoothness::Smooth,
            stretch: None,
            upright: None,
            one_to_one: None,
            kinks: Vec::new(),
            creases: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// The bound of `‖J − I‖`: 0 of what moves nothing.
    pub fn stretch(&self) -> Option<f64> {
        if self.support == Support::Nowhere {
            Some(0.0)
        } else {
            self.stretch
        }
    }

    /// Why the Jacobian determinant is positive wherever it exists, if that is known.
    pub fn upright(&self) -> Option<String> {
        match (&self.upright, self.stretch()) {
            (Some(why), _) => Some(why.clone()),
            (None, Some(0.0)) => Some("nothing moves".to_owned()),
            (None, Some(bound)) if bound < 1.0 => Some(format!(
                "the displacement changes by at most {bound:.3} of the way one goes, which is less than 1"
            )),
            _ => None,
        }
    }

    /// Why no two places have the same image, if that is known.
    pub fn one_to_one(&self) -> Option<String> {
        match (&self.one_to_one, self.stretch()) {
            (Some(why), _) => Some(why.clone()),
            (None, Some(bound)) if bound < 1.0 && self.smoothness() > Smoothness::Jump => {
                self.upright()
            }
            _ => None,
        }
    }

    /// Continuity over the whole of space.
    pub fn smoothness(&self) -> Smoothness {
        self.inside.min(self.edge)
    }

    /// Adds a sentence for the report.
    #[must_use]
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }
}

/// Indices of sites that a deformation could not move: they stay where they were.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Unmapped {
    indices: Vec<usize>,
}

impl Unmapped {
    /// No site.
    pub fn none() -> Self {
        Self::default()
    }
    /// Whether every site was moved.
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }
    /// The indices, ascending where they were recorded in ascending order.
    pub fn indices(&self) -> &[usize] {
        &self.indices
    }
    /// Records a site.
    pub fn push(&mut self, index: usize) {
        self.indices.push(index);
    }
    /// Records those of eight sites from `first` on whose bits are set in `lanes` and whose index is below `end`.
    #[cfg(feature = "simd")]
    pub fn push_lanes(&mut self, first: usize, lanes: u8, end: usize) {
        let indices = (0..8)
            .filter(|lane| lanes >> lane & 1 == 1)
            .map(|lane| first + lane);
        self.indices.extend(indices.filter(|&index| index < end));
    }
    /// Records all of another list.
    pub fn append(&mut self, mut other: Self) {
        self.indices.append(&mut other.indices);
    }
    /// Sorts the indices and drops repeated ones.
    pub fn tidy(&mut self) {
        self.indices.sort_unstable();
        self.indices.dedup();
    }
}

/// Something that moves sites.
pub trait Deformation<S: Space>: Send + Sync {
    /// The image of a site. Finite where the site is, unless a coordinate overflows.
    fn map(&self, site: &Site<S>) -> S;

    /// What is known about the deformation.
    fn facts(&self) -> Facts<S>;

    /// Whether the deformation is a function of space or of one model's indices.
    fn domain(&self) -> Domain {
        Domain::Space
    }

    /// Moves a run of points with indices `first`, `first + 1`, … in place and names those it could not move.
    ///
    /// The provided plain loop may be overridden by a kernel, which must give the same result for any way of cutting a
    /// model into runs. Wrappers must forward it, or they silently lose the kernel.
    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        for (i, point) in points.iter_mut().enumerate() {
            *point = self.map(&Site::new(first + i, *point));
        }
        Unmapped::none()
    }

    /// Whether [`Deformation::map_points`] itself leaves in place, and names, a point whose image would not be finite, so
    /// that the engine need not remember where the points were.
    fn keeps_finite(&self) -> bool {
        false
    }

    /// The place of this index that is moved to `image`, in closed form. `None` where there is no such form, or no such place;
    /// [`crate::Inverse`] then searches.
    fn inverse_at(&self, image: &Site<S>) -> Option<S> {
        let _ = image;
        None
    }

    /// The deformations that this one applies one after the other, if it is nothing but that; itself otherwise has none.
    fn stages(&self) -> &[Box<dyn Deformation<S>>] {
        &[]
    }

    /// The Jacobian: derivative of the image by the point. `size` is the model's size (diagonal of its bounds) in scene
    /// units, to which the step of the provided central differences is relative. `None` where the deformation depends on
    /// a field that lives on a model.
    fn jacobian(&self, site: &Site<S>, size: f64) -> Option<S::Linear> {
        difference_jacobian(self, site, size)
    }
}

/// The step of central differences at `p` for a model of size `size`: the cube root of the machine epsilon times the
/// size, which balances truncation (∝ step²) and cancellation (∝ 1/step); never so small that it drowns in `p`.
pub fn difference_step<S: Space>(p: S, size: f64) -> f64 {
    const CUBE_ROOT_OF_EPSILON: f64 = 6.055_454_452_393_343e-6;
    let scale = if size > 0.0 && size.is_finite() {
        size
    } else {
        1.0
    };
    CUBE_ROOT_OF_EPSILON * scale.max(p.largest() * 1e-4)
}

/// The Jacobian of any deformation by central differences; see [`Deformation::jacobian`]. Kept as the check of every
/// analytic one.
pub fn difference_jacobian<S: Space, D: Deformation<S> + ?Sized>(
    deformation: &D,
    site: &Site<S>,
    size: f64,
) -> Option<S::Linear> {
    if deformation.domain() == Domain::Model {
        return None;
    }
    let step = difference_step(site.point, size);
    Some(S::Linear::from_columns(|i| {
        let (fore, aft) = (
            site.point + S::unit(i) * step,
            site.point - S::unit(i) * step,
        );
        let width = fore.component(i) - aft.component(i);
        (deformation.map(&Site::new(site.index, fore))
            - deformation.map(&Site::new(site.index, aft)))
            / width
    }))
}

macro_rules! forward_deformation {
    ($($pointer:ty),*) => {$(
        impl<S: Space, D: Deformation<S> + ?Sized> Deformation<S> for $pointer {
            fn map(&self, site: &Site<S>) -> S { (**self).map(site) }
            fn facts(&self) -> Facts<S> { (**self).facts() }
            fn domain(&self) -> Domain { (**self).domain() }
            fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped { (**self).map_points(first, points) }
            fn keeps_finite(&self) -> bool { (**self).keeps_finite() }
            fn jacobian(&self, site: &Site<S>, size: f64) -> Option<S::Linear> { (**self).jacobian(site, size) }
            fn inverse_at(&self, image: &Site<S>) -> Option<S> { (**self).inverse_at(image) }
            fn stages(&self) -> &[Box<dyn Deformation<S>>] { (**self).stages() }
        }
    )*};
}
forward_deformation!(&D, Box<D>, std::sync::Arc<D>);

/// An affine map of the whole space is a deformation.
impl<S: Space> Deformation<S> for Affine<S> {
    fn map(&self, site: &Site<S>) -> S {
        self.apply(site.point)
    }
    fn facts(&self) -> Facts<S> {
        let support = if *self == Self::IDENTITY {
            Support::Nowhere
        } else {
            Support::Everywhere
        };
        let determinant = self.linear.determinant();
        Facts {
            support,
            translations_only: self.linear == S::Linear::IDENTITY,
            upright: (determinant > 0.0)
                .then(|| "an affine map with a positive determinant".to_owned()),
            one_to_one: self
                .inverted()
                .map(|_| "an affine map that is not singular".to_owned()),
            ..Facts::identity()
        }
    }
    fn inverse_at(&self, image: &Site<S>) -> Option<S> {
        self.inverted().map(|inverse| inverse.apply(image.point))
    }
    fn jacobian(&self, _: &Site<S>, _: f64) -> Option<S::Linear> {
        Some(self.linear)
    }
}

/// Deformations applied one after the other, the first of the list first. Site indices stay; points move on.
pub struct Stack<S: Space> {
    parts: Vec<Box<dyn Deformation<S>>>,
}

impl<S: Space> Stack<S> {
    /// The stack of the given parts; an empty one is the identity.
    pub fn new(parts: Vec<Box<dyn Deformation<S>>>) -> Self {
        Self { parts }
    }
    /// The parts, first applied first.
    pub fn parts(&self) -> &[Box<dyn Deformation<S>>] {
        &self.parts
    }
}

/// Two reasons for a property that compositions inherit.
fn joined(first: Option<String>, second: Option<String>) -> Option<String> {
    let (first, second) = (first?, second?);
    if first == second || second == "nothing moves" {
        Some(first)
    } else if first == "nothing moves" {
        Some(second)
    } else {
        Some(format!("{first}; {second}"))
    }
}

impl<S: Space> Deformation<S> for Stack<S> {
    fn inverse_at(&self, image: &Site<S>) -> Option<S> {
        let mut here = *image;
        for part in self.parts.iter().rev() {
            here.point = part.inverse_at(&here)?;
        }
        Some(here.point)
    }

    fn stages(&self) -> &[Box<dyn Deformation<S>>] {
        &self.parts
    }

    fn map(&self, site: &Site<S>) -> S {
        self.parts.iter().fold(site.point, |point, part| {
            part.map(&Site::new(site.index, point))
        })
    }

    fn facts(&self) -> Facts<S> {
        let mut moving = self.parts.iter().map(Deformation::facts);
        let Some(mut facts) = moving.next() else {
            return Facts::identity();
        };
        let mut alone = true;
        for (number, mut next) in moving.enumerate() {
            alone = false;
            // A crease of a later part is seldom straight before it. Where the parts before have no inverse in closed form, kinks of a later one are left out: they are a hint.
            let before = &self.parts[..=number];
            let back = |kink: S| {
                before.iter().rev().try_fold(kink, |place, part| {
                    let place = part.inverse_at(&Site::anywhere(place))?;
                    place.is_finite().then_some(place)
                })
            };
            facts.kinks.extend(next.kinks.drain(..).filter_map(back));
            // A later part sees moved points: its edge lies somewhere inside, so only the weaker class is known.
            let class = facts.smoothness().min(next.smoothness());
            let (upright, one_to_one, stretch) = (
                joined(facts.upright(), next.upright()),
                joined(facts.one_to_one(), next.one_to_one()),
                // ‖J₂J₁ − I‖ ≤ ‖J₂ − I‖ ‖J₁‖ + ‖J₁ − I‖.
                facts
                    .stretch()
                    .zip(next.stretch())
                    .map(|(a, b)| b * (1.0 + a) + a),
            );
            facts.inside = class;
            facts.edge = class;
            facts.support = match (facts.support, next.support) {
                (s, Support::Nowhere) | (Support::Nowhere, s) => s,
                // Points outside the first support are unmoved when the second sees them.
                (a, b) => a.union(b),
            };
            facts.translations_only &= next.translations_only;
            facts.weights_follow_targets |= next.weights_follow_targets;
            facts.strength_blends = false;
            facts.weights_fade = false;
            (facts.upright, facts.one_to_one, facts.stretch) = (upright, one_to_one, stretch);
            facts.notes.extend(next.notes);
        }
        if !alone {
            facts.strength_blends = false;
        }
        facts
    }

    fn domain(&self) -> Domain {
        self.parts
            .iter()
            .map(Deformation::domain)
            .max()
            .unwrap_or(Domain::Space)
    }

    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        let mut unmapped = Unmapped::none();
        // In cache-sized runs, so that a deep stack reads memory once.
        for (run, chunk) in points.chunks_mut(RUN).enumerate() {
            for part in &self.parts {
                unmapped.append(part.map_points(first + run * RUN, chunk));
            }
        }
        unmapped.tidy();
        unmapped
    }

    fn keeps_finite(&self) -> bool {
        matches!(self.parts.as_slice(), [only] if only.keeps_finite())
    }

    fn jacobian(&self, site: &Site<S>, size: f64) -> Option<S::Linear> {
        let mut here = *site;
        let mut product = S::Linear::IDENTITY;
        for part in &self.parts {
            product = part.jacobian(&here, size)?.after(&product);
            here.point = part.map(&here);
        }
        Some(product)
    }
}

/// Points in a run that wrappers process at a time: 12 KiB of 3-D points, half of a small first-level cache.
pub(crate) const RUN: usize = 512;

/// A deformation blended with the identity by a field `m`: `p + m (D(p) − p)`. Exactly `p` where `m = 0`, exactly
/// `D(p)` where `m = 1`.
pub struct Masked<S: Space> {
    deformation: Box<dyn Deformation<S>>,
    mask: Box<dyn Field<S>>,
}

impl<S: Space> Masked<S> {
    /// Blends `deformation` by `mask`, a field evaluated on the points before the deformation.
    pub fn new(deformation: Box<dyn Deformation<S>>, mask: Box<dyn Field<S>>) -> Self {
        Self { deformation, mask }
    }
}

/// `p + m (moved − p)`, exact at 0 and 1.
#[inline(always)]
pub(crate) fn blend<S: Space>(p: S, moved: S, m: f64) -> S {
    // Computed first and chosen afterwards: choices without branches, which random masks would mispredict.
    let between = p + (moved - p) * m;
    S::from_fn(|axis| {
        let inside = if m == 0.0 {
            p.component(axis)
        } else {
            between.component(axis)
        };
        if m == 1.0 {
            moved.component(axis)
        } else {
            inside
        }
    })
}

/// The facts of `facts` blended by `mask`.
pub(crate) fn masked_facts<S: Space>(mut facts: Facts<S>, mask: &dyn Field<S>) -> Facts<S> {
    let inner_edge = facts.edge;
    match mask.constant() {
        Some(1.0) => {}
        constant => {
            facts.stretch = constant
                .zip(facts.stretch())
                .map(|(m, bound)| m.abs() * bound);
            (facts.upright, facts.one_to_one) = (None, None);
        }
    }
    facts.inside = facts.inside.min(mask.smoothness());
    let support = facts.support.intersection(mask.support());
    if support != facts.support {
        // A mask that vanishes smoothly well inside the deformation hides its edge; this is claimed only where the
        // mask's bounds keep clear of it, which a box test cannot decide in general: keep the weaker class.
        facts.edge = inner_edge.min(mask.smoothness());
    } else {
        facts.edge = facts.edge.min(mask.smoothness());
    }
    facts.support = support;
    facts
}

impl<S: Space> Deformation<S> for Masked<S> {
    fn map(&self, site: &Site<S>) -> S {
        let m = self.mask.value(site);
        if m == 0.0 {
            site.point
        } else {
            blend(site.point, self.deformation.map(site), m)
        }
    }

    fn facts(&self) -> Facts<S> {
        masked_facts(self.deformation.facts(), &self.mask)
    }

    fn domain(&self) -> Domain {
        self.deformation.domain().max(self.mask.domain())
    }

    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        if self.mask.constant() == Some(1.0) {
            return self.deformation.map_points(first, points);
        }
        map_masked(&self.deformation, &self.mask, first, points)
    }

    fn keeps_finite(&self) -> bool {
        self.mask.constant() != Some(1.0) || self.deformation.keeps_finite()
    }

    fn inverse_at(&self, image: &Site<S>) -> Option<S> {
        match self.mask.constant() {
            Some(1.0) => self.deformation.inverse_at(image),
            Some(0.0) => Some(image.point),
            _ => None,
        }
    }

    fn jacobian(&self, site: &Site<S>, size: f64) -> Option<S::Linear> {
        masked_jacobian(&self.deformation, &self.mask, site, size)
    }
}

/// `J = I + m (J_D − I) + (D(p) − p) ∇mᵀ`.
pub(crate) fn masked_jacobian<S: Space>(
    deformation: &dyn Deformation<S>,
    mask: &dyn Field<S>,
    site: &Site<S>,
    size: f64,
) -> Option<S::Linear> {
    let gradient = mask.gradient(site, size)?;
    let inner = deformation.jacobian(site, size)?;
    let m = mask.value(site);
    let moved = deformation.map(site) - site.point;
    Some(
        S::Linear::IDENTITY + (inner - S::Linear::IDENTITY) * m + S::Linear::outer(moved, gradient),
    )
}

/// Blends a run of points, keeping the deformation's kernel. A point whose image is not finite stays, and is named.
pub(crate) fn map_masked<S: Space>(
    deformation: &dyn Deformation<S>,
    mask: &dyn Field<S>,
    first: usize,
    points: &mut [S],
) -> Unmapped {
    let constant = mask.constant();
    if constant == Some(0.0) {
        return Unmapped::none();
    }
    let mut unmapped = Unmapped::none();
    let mut rest = [S::ZERO; RUN];
    let mut values = [constant.unwrap_or(0.0); RUN];
    for (run, chunk) in points.chunks_mut(RUN).enumerate() {
        let first = first + run * RUN;
        let (rest, values) = (&mut rest[..chunk.len()], &mut values[..chunk.len()]);
        rest.copy_from_slice(chunk);
        if constant.is_none() {
            mask.values(first, rest, values);
            if values.iter().all(|&m| m == 0.0) {
                continue;
            }
        }
        unmapped.append(deformation.map_points(first, chunk));
        blend_run(rest, values, chunk);
        if !crate::engine::all_finite(chunk) {
            for (i, (point, &p)) in chunk.iter_mut().zip(rest.iter()).enumerate() {
                if !point.is_finite() {
                    *point = p;
                    unmapped.push(first + i);
                }
            }
        }
    }
    unmapped
}

/// [`blend`] for a run.
#[cfg(not(feature = "simd"))]
fn blend_run<S: Space>(rest: &[S], values: &[f64], moved: &mut [S]) {
    for ((point, &p), &m) in moved.iter_mut().zip(rest).zip(values) {
        *point = blend(p, *point, m);
    }
}

/// [`blend`] for a run, eight points at a time.
#[cfg(feature = "simd")]
fn blend_run<S: Space>(rest: &[S], values: &[f64], moved: &mut [S]) {
    use crate::simd::{self, LANES, Level, Simd, dispatch, prelude::*};
    #[inline(always)]
    fn eights<V: Simd, S: Space>(
        v: V,
        rest: &[[S; LANES]],
        values: &[[f64; LANES]],
        moved: &mut [[S; LANES]],
    ) {
        let (zero, one) = (simd::splat(v, 0.0), simd::splat(v, 1.0));
        for ((moved, rest), values) in moved.iter_mut().zip(rest).zip(values) {
            let m = simd::lanes(v, |lane| values[simd::point_of_lane::<S>(lane)]);
            let (none, all) = (m.simd_eq(zero), m.simd_eq(one));
            let (p, q) = (simd::read_block(v, rest), simd::read_block(v, moved));
            let mut between = p;
            for axis in 0..S::DIM {
                let (p, q) = (p[axis], q[axis]);
                let blended = p + (q - p) * m;
                between[axis] = all.select(q, none.select(p, blended));
            }
            simd::write_block(between, moved);
        }
    }
    let (rest, rest_end) = rest.as_chunks::<LANES>();
    let (values, values_end) = values.as_chunks::<LANES>();
    let (moved, moved_end) = moved.as_chunks_mut::<LANES>();
    dispatch!(Level::new(), v => eights(v, rest, values, moved));
    for ((point, &p), &m) in moved_end.iter_mut().zip(rest_end).zip(values_end) {
        *point = blend(p, *point, m);
    }
}
