//! What Barr's deformations share: a local frame about an axis and a transformation per axis coordinate.
//!
//! *Source*: A. H. Barr, *Global and Local Deformations of Solid Primitives*, SIGGRAPH 1984; Milliron et al. 2002, §4.3. The
//! Jacobian is `T(z)` with `T′(z)⟨p⟩` added to its last column.

use crate::lattices::one;
use anamorph_core::simd::{self, Level, Simd, dispatch};
use anamorph_core::{
    Address, Affine, Deformation, Facts, Influences, Linear, Mark, Role, Scaling, Shape, Site,
    Smoothness, Space, Support, Unmapped, Warp,
};
use anamorph_fields::{AxisRange, Limit, Profile};

/// What is wrong with the axis or the numbers of a Barr deformation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AxisError {
    /// The axis has no direction.
    #[error("the axis has no direction: give a finite vector that is not zero")]
    NoAxis,
    /// The direction across is parallel to the axis.
    #[error("the direction across is parallel to the axis: give one that is not")]
    Parallel,
    /// A number that is not finite.
    #[error("{what} is not finite; give a finite number")]
    NotFinite {
        /// Which number.
        what: &'static str,
    },
    /// The warp needs a range.
    #[error("{what} needs a range of positive length along the axis")]
    NoRange {
        /// Which parameter.
        what: &'static str,
    },
    /// A warp that the plane does not have.
    #[error("the plane has no {what}: use it on a 3-D model")]
    NoPlane {
        /// Which warp.
        what: &'static str,
    },
}

/// A right-handed local frame about an axis: coordinates `(x, y, z)` with `z` along the axis and `x` along the direction
/// across. In the plane there is no `y`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisFrame<S> {
    /// A point of the axis: local `(0, 0, 0)`.
    pub origin: S,
    /// Unit vectors of local `x`, `y` and `z`; `y` is null in the plane.
    pub basis: [S; 3],
}

impl<S: Space> AxisFrame<S> {
    /// The frame at `origin` along `axis`. `across` fixes local `x` (its part perpendicular to the axis counts); without
    /// it the coordinate axis least aligned with `axis` is taken, in the plane the normal to the left of the axis.
    ///
    /// # Errors
    /// [`AxisError::NoAxis`] or [`AxisError::Parallel`] for directions that do not span a frame.
    pub fn new(origin: S, axis: S, across: Option<S>) -> Result<Self, AxisError> {
        let z = axis.normalized().ok_or(AxisError::NoAxis)?;
        if !origin.is_finite() {
            return Err(AxisError::NotFinite { what: "the origin" });
        }
        let hint = across.unwrap_or_else(|| {
            if S::DIM == 2 {
                return S::from_fn(|i| {
                    if i == 0 {
                        -z.component(1)
                    } else {
                        z.component(0)
                    }
                });
            }
            let least =
                (0..S::DIM).min_by(|&a, &b| z.component(a).abs().total_cmp(&z.component(b).abs()));
            S::unit(least.unwrap_or(0))
        });
        let hint = hint.normalized().ok_or(AxisError::Parallel)?;
        let perpendicular = hint - z * z.dot(hint);
        if perpendicular.length() < 1e-9 {
            return Err(AxisError::Parallel);
        }
        let mut x = perpendicular.normalized().ok_or(AxisError::Parallel)?;
        // Once more, against the rounding of a nearly parallel hint.
        x = (x - z * z.dot(x)).normalized().ok_or(AxisError::Parallel)?;
        // y = z × x, written out so that it is null in the plane.
        let y = S::from_fn(|i| {
            if S::DIM == 2 {
                return 0.0;
            }
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            z.component(j) * x.component(k) - z.component(k) * x.component(j)
        });
        Ok(Self {
            origin,
            basis: [x, y, z],
        })
    }

    /// Local coordinates of a point.
    pub fn local(&self, p: S) -> [f64; 3] {
        let q = p - self.origin;
        self.basis.map(|e| e.dot(q))
    }

    /// The point with the given local coordinates.
    pub fn place(&self, local: [f64; 3]) -> S {
        self.origin + self.basis[0] * local[0] + self.basis[1] * local[1] + self.basis[2] * local[2]
    }
}

/// An affine map in local coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalMap {
    /// Rows of the linear part.
    pub linear: [[f64; 3]; 3],
    /// Translation.
    pub translation: [f64; 3],
}

impl LocalMap {
    /// The identity.
    pub const IDENTITY: Self = Self {
        linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        translation: [0.0; 3],
    };

    /// The image of a local point.
    pub fn apply(&self, q: [f64; 3]) -> [f64; 3] {
        core::array::from_fn(|row| {
            let l = &self.linear[row];
            l[0] * q[0] + l[1] * q[1] + l[2] * q[2] + self.translation[row]
        })
    }
}

/// A transformation per axis coordinate, in local coordinates: the whole of what distinguishes one Barr deformation from
/// another.
pub trait Law: Send + Sync {
    /// The transformation at axis coordinate `z`, its parameters (angles, factors − 1, shifts) multiplied by `strength`.
    fn at(&self, z: f64, strength: f64) -> LocalMap;
    /// Derivative of `at(z, 1)` by `z`, entry by entry.
    fn slope(&self, z: f64) -> LocalMap;
    /// The image of eight local points; equal to `at(z, 1)` applied, up to rounding, and exactly still where that is the
    /// identity.
    fn map_block<V: Simd>(&self, v: V, q: simd::Block<V>) -> simd::Block<V> {
        let rows: [[f64; simd::LANES]; 3] = q.map(Into::into);
        let moved: [[f64; 3]; simd::LANES] = core::array::from_fn(|lane| {
            let local = [rows[0][lane], rows[1][lane], rows[2][lane]];
            self.at(local[2], 1.0).apply(local)
        });
        core::array::from_fn(|c| simd::lanes(v, |lane| moved[lane][c]))
    }
    /// Continuity of the moved point in space.
    fn smoothness(&self) -> Smoothness;
    /// The limits along the axis, if there are any.
    fn range(&self) -> Option<&AxisRange>;
    /// Sentences for the report.
    fn notes(&self) -> Vec<String>;
    /// Whether the transformation is the identity for every `z`.
    fn is_identity(&self) -> bool;
    /// Why every slice across the axis stays a slice, shifted along it by the same distance as all others, and is mapped one-to-one
    /// without being turned over, if that is so.
    fn upright(&self) -> Option<String> {
        None
    }
    /// The local point whose image is `q`, where there is a closed form.
    fn inverse(&self, q: [f64; 3]) -> Option<[f64; 3]> {
        let _ = q;
        None
    }
}

/// A Barr deformation: a [`Law`] about an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AxialWarp<S: Space, L> {
    frame: AxisFrame<S>,
    law: L,
    scaling: Scaling,
}

impl<S: Space, L: Law> AxialWarp<S, L> {
    /// The law about the frame's axis; `scaling` says what a strength field does to it.
    pub fn new(frame: AxisFrame<S>, law: L, scaling: Scaling) -> Self {
        Self {
            frame,
            law,
            scaling,
        }
    }
    /// The local frame.
    pub fn frame(&self) -> &AxisFrame<S> {
        &self.frame
    }
    /// The law.
    pub fn law(&self) -> &L {
        &self.law
    }

    /// A local map in world coordinates.
    fn world(&self, local: &LocalMap) -> Affine<S> {
        let e = &self.frame.basis;
        // E (L − I) Eᵀ + I, so that an identity stays exact.
        let mut linear = S::Linear::IDENTITY;
        for (row, entries) in local.linear.iter().enumerate() {
            for (column, &entry) in entries.iter().enumerate() {
                let identity = if row == column { 1.0 } else { 0.0 };
                if entry != identity {
                    linear = linear + S::Linear::outer(e[row], e[column]) * (entry - identity);
                }
            }
        }
        let t = local.translation;
        Affine::about(
            self.frame.origin,
            linear,
            e[0] * t[0] + e[1] * t[1] + e[2] * t[2],
        )
    }

    /// The axis over the model and what becomes of it, for pictures; `from` and `to` bound its drawn part.
    pub fn marks(&self, from: f64, to: f64) -> Vec<Mark<S>> {
        const STEPS: u32 = 96;
        let along = |i: u32| from + (to - from) * f64::from(i) / f64::from(STEPS);
        let straight = (0..=STEPS)
            .map(|i| self.frame.place([0.0, 0.0, along(i)]))
            .collect();
        let bent = |x: f64, y: f64| -> Vec<S> {
            (0..=STEPS)
                .map(|i| {
                    self.frame
                        .place(self.law.at(along(i), 1.0).apply([x, y, along(i)]))
                })
                .collect()
        };
        let mut marks = vec![
            Mark::new(Role::Source, Shape::Polyline(straight)),
            Mark::new(Role::Target, Shape::Polyline(bent(0.0, 0.0))),
        ];
        // Rails beside the axis show turning and widening.
        let reach = (to - from).abs() * 0.22;
        let sides: &[(f64, f64)] = if S::DIM == 2 {
            &[(1.0, 0.0), (-1.0, 0.0)]
        } else {
            &[(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
        };
        for &(x, y) in sides {
            let rail = (0..=STEPS)
                .map(|i| self.frame.place([x * reach, y * reach, along(i)]))
                .collect();
            marks.push(Mark::new(Role::SourceGuide, Shape::Polyline(rail)));
            marks.push(Mark::new(
                Role::TargetGuide,
                Shape::Polyline(bent(x * reach, y * reach)),
            ));
        }
        if let Some(range) = self.law.range() {
            for z in [range.min(), range.max()] {
                let ring = |map: &dyn Fn([f64; 3]) -> [f64; 3]| -> Vec<S> {
                    if S::DIM == 2 {
                        return vec![
                            self.frame.place(map([-reach, 0.0, z])),
                            self.frame.place(map([reach, 0.0, z])),
                        ];
                    }
                    (0..=48)
                        .map(|i| {
                            let (s, c) = anamorph_core::math::sin_cos(
                                core::f64::consts::TAU * f64::from(i) / 48.0,
                            );
                            self.frame.place(map([c * reach, s * reach, z]))
                        })
                        .collect()
                };
                marks.push(Mark::new(Role::SourceGuide, Shape::Polyline(ring(&|q| q))));
                let map = self.law.at(z, 1.0);
                marks.push(Mark::new(
                    Role::TargetGuide,
                    Shape::Polyline(ring(&|q| map.apply(q))),
                ));
            }
        }
        marks
    }
}

impl<S: Space, L: Law> Deformation<S> for AxialWarp<S, L> {
    fn map(&self, site: &Site<S>) -> S {
        one(site, |points| {
            self.map_points(site.index, points);
        })
    }

    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        dispatch!(Level::new(), v => kernel(v, &self.frame, &self.law, first, points))
    }

    fn keeps_finite(&self) -> bool {
        true
    }

    fn jacobian(&self, site: &Site<S>, _: f64) -> Option<S::Linear> {
        let q = self.frame.local(site.point);
        let mut map = self.law.at(q[2], 1.0);
        let slope = self.law.slope(q[2]).apply(q);
        for (row, slope) in map.linear.iter_mut().zip(slope) {
            row[2] += slope;
        }
        Some(self.world(&map).linear)
    }

    fn facts(&self) -> Facts<S> {
        if self.law.is_identity() {
            return Facts::identity();
        }
        let class = self.law.smoothness();
        Facts {
            support: Support::Everywhere,
            inside: class,
            edge: class,
            translations_only: false,
            strength_blends: self.scaling == Scaling::Displacement,
            upright: self.law.upright(),
            one_to_one: self.law.upright(),
            notes: self.law.notes(),
            ..Facts::identity()
        }
    }

    fn inverse_at(&self, image: &Site<S>) -> Option<S> {
        let q = self.frame.local(image.point);
        let back = self.law.inverse(q)?;
        // What does not move keeps its bits; what does is placed anew, as differences of large numbers would lose the digits of
        // small ones.
        Some(if back == q {
            image.point
        } else {
            self.frame.place(back)
        })
    }
}

impl<S: Space, L: Law> Warp<S> for AxialWarp<S, L> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        let at = self.frame.local(site.point)[2];
        out.push(Address { feature: 0, at }, 1.0, 1.0);
    }
    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        match self.scaling {
            Scaling::Displacement => self
                .world(&self.law.at(address.at, 1.0))
                .lerp_from_identity(strength),
            Scaling::Composition => self.world(&self.law.at(address.at, strength)),
        }
    }
}

/// Eight points at a time: to local coordinates, the law, and the *difference* back, so that a point that does not move
/// keeps its bits.
#[inline(always)]
fn kernel<V: Simd, S: Space, L: Law>(
    v: V,
    frame: &AxisFrame<S>,
    law: &L,
    first: usize,
    points: &mut [S],
) -> Unmapped {
    let mut unmapped = Unmapped::none();
    let (mut index, end) = (first, first + points.len());
    let mut blocks = simd::Blocks::new(points);
    while let Some(block) = blocks.next() {
        let lost = eight(v, frame, law, block);
        if lost != 0 {
            unmapped.push_lanes(index, lost, end);
        }
        index += simd::LANES;
    }
    blocks.finish();
    unmapped
}

/// One block of the kernel. Loops and no closures: what is not inlined loses the vector instructions.
#[inline(always)]
fn eight<V: Simd, S: Space, L: Law>(
    v: V,
    frame: &AxisFrame<S>,
    law: &L,
    points: &mut [S; simd::LANES],
) -> u8 {
    let p = simd::read_block(v, points);
    let zero = simd::splat(v, 0.0);
    let mut d = [zero; 3];
    for c in 0..S::DIM {
        d[c] = p[c] - simd::splat(v, frame.origin.component(c));
    }
    let mut q = [zero; 3];
    for (q, e) in q.iter_mut().zip(&frame.basis) {
        *q = simd::splat(v, e.component(0)) * d[0];
        for (c, d) in d.iter().enumerate().take(S::DIM).skip(1) {
            *q += simd::splat(v, e.component(c)) * *d;
        }
    }
    let moved = law.map_block(v, q);
    let mut by = [zero; 3];
    for (c, by) in by.iter_mut().enumerate().take(S::DIM) {
        *by = simd::splat(v, frame.basis[0].component(c)) * (moved[0] - q[0]);
        for i in 1..3 {
            *by += simd::splat(v, frame.basis[i].component(c)) * (moved[i] - q[i]);
        }
    }
    simd::settle::<V, S>(v, &p, &by, points)
}

/// A scalar that varies along the axis: an angle, a factor, a shift.
#[derive(Debug, Clone, PartialEq)]
pub enum Course {
    /// `c₀ + c₁ ẑ + c₂ ẑ² + …` in the (limited) axis coordinate.
    Polynomial(Vec<f64>),
    /// `start + slope (ẑ − from)`: exactly `start` at `from`, so that a range that begins with no change changes no bit
    /// before it.
    Linear {
        /// Where the value is `start`.
        from: f64,
        /// The value there.
        start: f64,
        /// Change per scene unit.
        slope: f64,
    },
    /// A curve drawn by points over the share of the range, 0 at its start and 1 at its end, multiplied by `scale`.
    Drawn {
        /// The curve.
        profile: Profile,
        /// Start of the range.
        from: f64,
        /// One over the length of the range.
        per_length: f64,
        /// Factor of the value (1 for factors, radians for angles).
        scale: f64,
    },
}

impl Course {
    /// The value `start` at `from` and `end` at `to`, linear in between and beyond.
    pub fn linear(from: f64, start: f64, to: f64, end: f64) -> Self {
        let slope = (end - start) / (to - from);
        Self::Linear { from, start, slope }
    }

    /// Value and derivative at a coordinate.
    #[inline(always)]
    pub fn value_and_slope(&self, z: f64) -> (f64, f64) {
        match self {
            Self::Polynomial(coefficients) => {
                let (mut value, mut slope) = (0.0, 0.0);
                for &c in coefficients.iter().rev() {
                    slope = slope * z + value;
                    value = value * z + c;
                }
                (value, slope)
            }
            Self::Linear { from, start, slope } => (start + slope * (z - from), *slope),
            Self::Drawn {
                profile,
                from,
                per_length,
                scale,
            } => {
                let (value, slope) = profile.value_and_derivative((z - from) * per_length);
                (value * scale, slope * per_length * scale)
            }
        }
    }

    /// Values at eight coordinates; the same numbers as [`Course::value_and_slope`].
    #[inline(always)]
    pub fn block<V: Simd>(&self, v: V, z: simd::f64x8<V>) -> simd::f64x8<V> {
        match self {
            Self::Polynomial(coefficients) => coefficients
                .iter()
                .rev()
                .fold(simd::splat(v, 0.0), |value, &c| {
                    value * z + simd::splat(v, c)
                }),
            Self::Linear { from, start, slope } => {
                simd::splat(v, *start) + simd::splat(v, *slope) * (z - simd::splat(v, *from))
            }
            Self::Drawn { .. } => {
                let z: [f64; simd::LANES] = z.into();
                simd::lanes(v, |lane| self.value_and_slope(z[lane]).0)
            }
        }
    }

    /// Continuity class.
    pub fn smoothness(&self) -> Smoothness {
        match self {
            Self::Polynomial(_) | Self::Linear { .. } => Smoothness::Smooth,
            Self::Drawn { profile, .. } => profile.smoothness(),
        }
    }

    /// Whether the value is certainly greater than 0 for all coordinates of a range, or everywhere without one.
    pub fn is_positive(&self, range: Option<&AxisRange>) -> bool {
        match (self, range) {
            (Self::Linear { .. }, Some(range)) => {
                // Limits that round the ends off stay between them.
                self.value_and_slope(range.min()).0 > 0.0
                    && self.value_and_slope(range.max()).0 > 0.0
            }
            (Self::Linear { start, slope, .. }, None) => *slope == 0.0 && *start > 0.0,
            (Self::Polynomial(c), _) => {
                c.first().is_some_and(|&c| c > 0.0) && c.iter().skip(1).all(|&c| c == 0.0)
            }
            (Self::Drawn { profile, scale, .. }, _) => {
                profile.as_constant().is_some_and(|c| c * scale > 0.0)
            }
        }
    }

    /// Whether the value is the same everywhere.
    pub fn is_level(&self) -> bool {
        self.is_constant(self.value_and_slope(0.0).0)
    }

    /// Whether the value is `value` everywhere.
    pub fn is_constant(&self, value: f64) -> bool {
        match self {
            Self::Polynomial(c) => {
                c.first().copied().unwrap_or(0.0) == value && c.iter().skip(1).all(|&c| c == 0.0)
            }
            Self::Linear { start, slope, .. } => *start == value && *slope == 0.0,
            Self::Drawn { profile, scale, .. } => {
                profile.as_constant().is_some_and(|c| c * scale == value)
            }
        }
    }

    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Polynomial(c) => c.iter().all(|c| c.is_finite()),
            Self::Linear { from, start, slope } => {
                from.is_finite() && start.is_finite() && slope.is_finite()
            }
            Self::Drawn {
                from,
                per_length,
                scale,
                ..
            } => from.is_finite() && per_length.is_finite() && scale.is_finite(),
        }
    }
}

/// The limited coordinate `ẑ(z)` and its slope; `z` itself without a range.
#[inline(always)]
pub(super) fn limited(range: Option<&AxisRange>, z: f64) -> (f64, f64) {
    range.map_or((z, 1.0), |range| range.value_and_slope(z))
}

/// The limited coordinates of eight points.
#[inline(always)]
pub(super) fn limited_block<V: Simd>(
    v: V,
    range: Option<&AxisRange>,
    z: simd::f64x8<V>,
) -> simd::f64x8<V> {
    use anamorph_core::simd::prelude::*;
    let Some(range) = range else { return z };
    if range.limit() == Limit::Clamp {
        let (low, high) = (simd::splat(v, range.min()), simd::splat(v, range.max()));
        let z = z.simd_lt(low).select(low, z);
        return z.simd_gt(high).select(high, z);
    }
    let z: [f64; simd::LANES] = z.into();
    simd::lanes(v, |lane| range.value_and_slope(z[lane]).0)
}

/// The sentence about limits for a report.
pub(super) fn range_note(range: Option<&AxisRange>) -> Vec<String> {
    let Some(range) = range else {
        return Vec::new();
    };
    vec![if range.limit() == Limit::Clamp {
        "the range ends in a clamp: C0 at its limits; `limits = \"smooth\"` gives C2".to_owned()
    } else {
        "the range ends in a smooth blend: C2 at its limits".to_owned()
    }]
}
