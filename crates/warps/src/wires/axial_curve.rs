//! Axial deformation: an axis through the model is bent into a curve, and every point keeps its place in the axis's frame.
//!
//! Computes `p' = C*(v) + F*(v) F(v)⁻¹ (p − C(v))` with `v` the place of the axis nearest to `p`, `C` and `F` point and frame of the
//! axis there, `C*` and `F*` those of the target ([`Rail`]). Frames carry the direction along the curve and those across it, which
//! turn as little as the curve makes them when they come from rotation-minimizing frames. Beyond its ends the axis moves the
//! model rigidly. A reach limits the effect: strength 1 up to an inner distance, falling to 0 at an outer one; displacements are
//! multiplied by it.
//!
//! Of a straight axis the nearest place is a projection: the kernel reads one piece of the rail a point and searches nothing. The error
//! of the rail is stated ([`Rail::error`]); the warp is exact with regard to it.
//!
//! *Source*: F. Lazarus, S. Coquillart, P. Jancène, *Axial deformations: an intuitive deformation technique*, Computer-Aided
//! Design 26(8), 1994; Milliron et al. 2002, §4.4 (displacement scaling).

use super::rail::{Rail, Station, across, along};
use super::wire::WireCurve;
use super::{WireError, polyline};
use crate::lattices::one;
use anamorph_core::simd::{Level, Simd, dispatch};
use anamorph_core::{
    Address, Affine, Bounds, Condition, Deformation, Facts, Influences, Linear, Mark, Role, Shape,
    Site, Smoothness, Space, Support, Unmapped, Warp,
};
use anamorph_fields::Falloff;
use std::sync::Arc;

/// The axis as it lies in the model.
pub enum Axis<S: Space> {
    /// A straight axis from an origin over a length.
    Line {
        /// Where it starts.
        origin: S,
        /// An orthonormal frame, the first column along the axis.
        frame: S::Linear,
        /// Its length in scene units, greater than 0.
        length: f64,
    },
    /// A curved axis.
    Curve {
        /// The curve.
        curve: Arc<dyn WireCurve<S>>,
        /// Its points and frames by the share of its domain.
        rail: Rail<S>,
    },
}

/// How far from the axis the deformation reaches.
#[derive(Debug, Clone, Copy)]
pub struct AxialReach {
    /// Up to this distance the strength is 1; 0 or more.
    pub inner: f64,
    /// From this distance on it is 0; more than `inner`.
    pub outer: f64,
    /// How it falls in between; one that ends at 1.
    pub falloff: &'static dyn Falloff,
}

impl AxialReach {
    #[inline(always)]
    fn strength(&self, distance: f64) -> f64 {
        if distance <= self.inner {
            return 1.0;
        }
        if distance >= self.outer {
            return 0.0;
        }
        self.falloff
            .value((distance - self.inner) / (self.outer - self.inner))
    }
}

/// A deformation by an axis that is bent into a curve.
pub struct AxialCurve<S: Space> {
    axis: Axis<S>,
    target: Rail<S>,
    reach: Option<AxialReach>,
}

impl<S: Space> AxialCurve<S> {
    /// The deformation that takes the axis to the target's rail, the same share of both.
    ///
    /// # Errors
    /// [`WireError`] for an axis without length or not finite, and a reach that is not ordered.
    pub fn construct(
        axis: Axis<S>,
        target: Rail<S>,
        reach: Option<AxialReach>,
    ) -> Result<Self, WireError> {
        if let Axis::Line {
            origin,
            frame,
            length,
        } = &axis
        {
            let which = "axis";
            if !(Affine::<S>::new(*frame, *origin).is_finite() && length.is_finite()) {
                return Err(WireError::NotFinite { feature: 0, which });
            }
            if *length <= 0.0 {
                return Err(WireError::NoLength { feature: 0, which });
            }
        }
        if let Some(reach) = &reach {
            let ordered = reach.inner >= 0.0 && reach.outer > reach.inner;
            if !(ordered && reach.outer.is_finite()) {
                return Err(WireError::Radius {
                    feature: 0,
                    radius: reach.outer,
                });
            }
            if reach.falloff.reach() != Some(1.0) {
                return Err(WireError::Falloff {
                    feature: 0,
                    name: reach.falloff.name(),
                });
            }
        }
        Ok(Self {
            axis,
            target,
            reach,
        })
    }

    /// The target's points and frames.
    pub fn target(&self) -> &Rail<S> {
        &self.target
    }

    /// Where on the axis a point is nearest (distance from the axis's origin, or the curve's parameter), and how far it is.
    fn place(&self, point: S) -> (f64, f64) {
        match &self.axis {
            Axis::Line {
                origin,
                frame,
                length,
            } => {
                let from = point - *origin;
                let at = limited(frame.column(0).dot(from), *length);
                (at, (from - frame.column(0) * at).length())
            }
            Axis::Curve { curve, .. } => {
                let nearest = curve.nearest(point);
                (nearest.parameter, nearest.distance)
            }
        }
    }

    /// The station of the axis at a place, and that of the target.
    fn stations(&self, at: f64) -> (Station<S>, Station<S>) {
        match &self.axis {
            Axis::Line {
                origin,
                frame,
                length,
            } => {
                let here = Station {
                    point: *origin + frame.column(0) * at,
                    frame: *frame,
                };
                (here, self.target.station(at / length))
            }
            Axis::Curve { curve, rail } => {
                let (start, end) = curve.domain();
                let share = (at - start) / (end - start);
                (rail.station(share), self.target.station(share))
            }
        }
    }

    /// The rigid motion (with the target's widths) of a place of the axis.
    fn motion(&self, at: f64) -> Affine<S> {
        let (here, there) = self.stations(at);
        let linear = there.frame.after(&here.frame.transposed());
        Affine::about(here.point, linear, there.point - here.point)
    }

    fn strength(&self, distance: f64) -> f64 {
        self.reach
            .as_ref()
            .map_or(1.0, |reach| reach.strength(distance))
    }

    /// The axis and what becomes of it, for pictures.
    pub fn marks(&self) -> Vec<Mark<S>> {
        const STEPS: u32 = 96;
        let shares = (0..=STEPS).map(|i| f64::from(i) / f64::from(STEPS));
        let source = match &self.axis {
            Axis::Line {
                origin,
                frame,
                length,
            } => vec![*origin, *origin + frame.column(0) * *length],
            Axis::Curve { curve, .. } => polyline(curve.as_ref()),
        };
        let target = shares.map(|share| self.target.station(share).point);
        vec![
            Mark::new(Role::Source, Shape::Polyline(source)),
            Mark::new(Role::Target, Shape::Polyline(target.collect())),
        ]
    }
}

/// A coordinate along an axis, limited to its length; what is not a number becomes 0.
#[inline(always)]
fn limited(z: f64, length: f64) -> f64 {
    if z > 0.0 {
        if z < length { z } else { length }
    } else {
        0.0
    }
}

/// What the kernel knows of a straight axis.
struct Line<'a, S: Space> {
    origin: [f64; 3],
    frame: [[f64; 3]; 3],
    length: f64,
    per_length: f64,
    target: &'a Rail<S>,
    reach: Option<&'a AxialReach>,
}

/// Points one after the other; the twelve numbers of a station are what is done at a time. Arrays and loops of fixed length, which
/// the compiler turns into vectors of the level that is dispatched.
#[inline(always)]
fn kernel<V: Simd, S: Space>(_: V, line: &Line<'_, S>, points: &mut [S]) {
    for point in points {
        let mut from = [0.0; 3];
        for (axis, from) in from.iter_mut().enumerate().take(S::DIM) {
            *from = point.component(axis) - line.origin[axis];
        }
        let part = |e: &[f64; 3]| e[0] * from[0] + e[1] * from[1] + e[2] * from[2];
        let z = part(&line.frame[0]);
        let at = limited(z, line.length);
        let local = [z - at, part(&line.frame[1]), part(&line.frame[2])];
        let strength = match line.reach {
            None => 1.0,
            Some(reach) => {
                let squared = local[0] * local[0] + local[1] * local[1] + local[2] * local[2];
                reach.strength(squared.sqrt())
            }
        };
        if strength == 0.0 {
            continue;
        }
        let (piece, t) = line.target.piece(at * line.per_length);
        let n = across(piece, t);
        let mut moved = [0.0; 3];
        for axis in 0..3 {
            moved[axis] = n[axis] + local[1] * n[3 + axis] + local[2] * n[6 + axis];
        }
        if local[0] != 0.0 {
            let beyond = along(piece, t);
            for axis in 0..3 {
                moved[axis] += local[0] * beyond[axis];
            }
        }
        let here = *point;
        *point = if strength == 1.0 {
            S::from_fn(|axis| moved[axis])
        } else {
            S::from_fn(|axis| {
                let p = here.component(axis);
                p + (moved[axis] - p) * strength
            })
        };
    }
}

impl<S: Space> Deformation<S> for AxialCurve<S> {
    fn map(&self, site: &Site<S>) -> S {
        one(site, |points| {
            self.map_points(site.index, points);
        })
    }

    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        let Axis::Line {
            origin,
            frame,
            length,
        } = &self.axis
        else {
            return anamorph_core::evaluate_points(self, first, points);
        };
        let numbers = |v: S| [v.component(0), v.component(1), v.component(2)];
        let line = Line {
            origin: numbers(*origin),
            frame: core::array::from_fn(|i| numbers(frame.column(i))),
            length: *length,
            per_length: 1.0 / length,
            target: &self.target,
            reach: self.reach.as_ref(),
        };
        dispatch!(Level::new(), v => kernel(v, &line, points));
        Unmapped::none()
    }

    fn facts(&self) -> Facts<S> {
        let mut facts = Facts {
            support: Support::Everywhere,
            inside: Smoothness::C(0),
            edge: Smoothness::C(0),
            translations_only: false,
            strength_blends: true,
            ..Facts::identity()
        };
        if let Some(reach) = &self.reach {
            let class = reach.falloff.step_smoothness();
            facts.inside = facts.inside.min(class);
            let mut bounds = match &self.axis {
                Axis::Line {
                    origin,
                    frame,
                    length,
                } => Bounds::new(*origin, *origin + frame.column(0) * *length),
                Axis::Curve { curve, .. } => super::tangents::Tangents::new(curve.clone())
                    .map_or(Bounds::new(S::ZERO, S::ZERO), |tangents| tangents.bounds()),
            };
            // A little more than the reach: the nearest place is found to rounding.
            let reach = reach.outer * (1.0 + 1e-12);
            bounds.min -= S::splat(reach);
            bounds.max += S::splat(reach);
            facts.support = Support::Box(bounds);
        }
        if matches!(self.axis, Axis::Curve { .. }) {
            facts.inside = Smoothness::Jump;
            facts = facts.with_note(
                "a point with two nearest places on the curved axis may tear away; a straight axis does not tear",
            );
        } else {
            facts = facts
                .with_note("beyond the ends of the axis the model moves rigidly: C0 across them");
        }
        if self.target.has_corners() {
            facts.inside = Smoothness::Jump;
            facts = facts.with_note(
                "the target has a corner: what is off the axis tears there; take a family of smooth curves",
            );
        }
        facts.edge = facts.inside;
        if self.target.error() > 1e-6 {
            facts = facts.with_note(format!(
                "the target bends so often that its table errs by {:.1e} of its extent",
                self.target.error()
            ));
        }
        facts
    }
}

impl<S: Space> Warp<S> for AxialCurve<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        let (at, distance) = self.place(site.point);
        let strength = self.strength(distance);
        if strength != 0.0 {
            out.push(Address { feature: 0, at }, strength, 1.0);
        }
    }

    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        if strength == 0.0 {
            return Affine::IDENTITY;
        }
        self.motion(address.at).lerp_from_identity(strength)
    }

    fn conditions(&self) -> Vec<Condition<S>> {
        let at = |share: f64| match &self.axis {
            Axis::Line { length, .. } => share * length,
            Axis::Curve { curve, .. } => {
                let (start, end) = curve.domain();
                start * (1.0 - share) + end * share
            }
        };
        (0..=8)
            .map(|i| {
                let (here, there) = self.stations(at(f64::from(i) / 8.0));
                Condition {
                    feature: 0,
                    source: here.point,
                    target: there.point,
                }
            })
            .collect()
    }
}
