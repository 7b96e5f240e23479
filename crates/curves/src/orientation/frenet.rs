//! Frenet frames, with the repairs they need.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Frenet Frame": `w = P′/|P′|`, up towards the centre of curvature; "Frenet
//! Frame – undefined" (where the curvature vanishes, interpolate between the frames at the edges of the stretch, about the
//! common `w`); "Frenet Frame – discontinuity" (at inflections the second derivative changes sides and the camera flips); errata
//! C10.
//!
//! Preparation finds the stretches of undefined frames: straight spans, inflections, stops. Angles about the direction are measured
//! against rotation-minimizing frames, which on a straight stretch do not turn, so that the interpolation is that of the
//! slides there, and has a meaning on stretches that are not quite straight or have corners. The angle changes evenly by arc
//! length. A stretch at the end of an open curve keeps the angle of its edge; through the start of a closed one it is
//! interpolated like others.

use super::directions::{Directions, jet_at_end};
use super::error::direction;
use super::{
    Frame, OrientationError, Orienter, RotationMinimizing, RotationMinimizingFrames, SpaceCurve,
};
use crate::ArcLength;
use crate::orientation::End;
use anamorph_core::glam::DVec3;
use anamorph_core::{Curve, Differentiable, Jet, Solid, Space};
use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// The part of the second derivative across the direction, against all derivatives over the span, below which it is rounding.
/// Above it the normal keeps six digits.
const STRAIGHT: f64 = 1e-10;
/// Cells of a span before any is halved: for polynomials of degree up to 5 more than `P′ × P″` has zeros.
const CELLS: u32 = 16;
/// Halvings of a cell at most. What is undefined there is as long as 2⁻²² of a cell.
const DEPTH: u32 = 22;
/// Cells of a span at most.
const MOST: usize = 1 << 14;

/// What happens where the curvature vector changes sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Flips {
    /// The sign of the normal is carried through: of the two normals that the curve offers, the one nearer to that before. The up
    /// axis may then point away from the centre of curvature. On a closed curve whose normals turn over an odd number of
    /// times in a round, the flip that must remain is where the curve starts.
    #[default]
    Repaired,
    /// As the slides print it: up is always towards the centre of curvature, and flips at inflections.
    AsPrinted,
}

/// Which of the curve's vectors is up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrenetUp {
    /// The principal normal, towards the centre of curvature: a full bank into the turn.
    #[default]
    Normal,
    /// The binormal `w × normal`: upright on curves in a plane.
    Binormal,
}

/// Frenet frames: settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frenet {
    /// Which vector is up.
    pub axis: FrenetUp,
    /// What happens at inflections.
    pub flips: Flips,
    /// Up at the start of a curve that is straight all along, where frames are rotation-minimizing; `y` by default.
    pub up: DVec3,
}

impl Default for Frenet {
    fn default() -> Self {
        Self {
            axis: FrenetUp::Normal,
            flips: Flips::Repaired,
            up: DVec3::Y,
        }
    }
}

/// A stretch of the curve.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    start: f64,
    /// The angle of its first frame against the rotation-minimizing one.
    angle: f64,
    kind: Kind,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// The curve has a normal, taken with this sign.
    Defined(f64),
    /// It has none: the angle changes by `turn` over `length` up to `end`.
    Undefined { end: f64, length: f64, turn: f64 },
}

/// Frenet frames along a path, prepared.
#[derive(Clone, Debug)]
pub struct FrenetFrames<P> {
    base: RotationMinimizingFrames<P>,
    stretches: Vec<Stretch>,
    axis: FrenetUp,
}

/// An angle brought into (−π, π].
fn wrapped(angle: f64) -> f64 {
    let turned = angle.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}

/// The frame of the direction with the normal up, where the curve has one.
fn frenet(jet: &Jet<Solid>, forward: Solid, width: f64) -> Option<Frame> {
    let across = jet.second - forward * forward.dot(jet.second);
    let all = Space::length(jet.first) / width
        + Space::length(jet.second)
        + Space::length(jet.third) * width;
    let bends = Space::length(across) > STRAIGHT * all;
    if !bends {
        return None;
    }
    Some(Frame::nearly(forward, Space::normalized(across)?))
}

/// A place of a span that is looked at.
#[derive(Clone, Copy)]
struct Probe {
    u: f64,
    frame: Option<Frame>,
    /// `P′ × P″` without unit.
    cross: Solid,
}

/// Looks for stretches with and without normals in one span.
struct Search<'a, C: ?Sized> {
    curve: &'a C,
    directions: &'a Directions,
    span: usize,
}

impl<C: Differentiable<Solid> + ?Sized> Search<'_, C> {
    fn probe(&self, u: f64) -> Probe {
        let (a, b) = self.directions.span(self.span);
        let place = self.directions.place(self.curve, u);
        let (jet, forward) = if u >= b {
            (jet_at_end(self.curve, a, b), place.behind)
        } else {
            (self.curve.jet(u), place.ahead)
        };
        let moves = self.directions.span_moves(self.span);
        let frame = frenet(&jet, forward, b - a).filter(|_| moves);
        let unit = (b - a) / self.directions.size();
        let cross = (jet.first * unit).cross(jet.second * (unit * (b - a)));
        Probe { u, frame, cross }
    }

    /// Whether between two places with normals the curve has some without, or turns so fast that it may.
    fn is_defined(from: &Probe, middle: &Probe, to: &Probe) -> bool {
        let (Some(a), Some(m), Some(b)) = (from.frame, middle.frame, to.frame) else {
            return false;
        };
        let near = |x: &Frame, y: &Frame| x.side().dot(y.side()) > 0.5;
        let bent = Space::length(middle.cross - (from.cross + to.cross) * 0.5);
        let least = Space::length(from.cross).min(Space::length(to.cross));
        near(&a, &m) && near(&m, &b) && bent <= 0.25 * least
    }

    /// Hands out the cells of the span in order, with whether normals are defined.
    fn cells(&self, each: &mut dyn FnMut(&Probe, &Probe, bool)) {
        let (a, b) = self.directions.span(self.span);
        let at = |k: u32| match k {
            CELLS => b,
            k => a + (b - a) * (f64::from(k) / f64::from(CELLS)),
        };
        let mut from = self.probe(a);
        let mut stack: Vec<(Probe, u32)> =
            (1..=CELLS).rev().map(|k| (self.probe(at(k)), 0)).collect();
        let mut count = 0;
        while let Some((to, depth)) = stack.pop() {
            let u = 0.5 * (from.u + to.u);
            let middle = self.probe(u);
            let defined = Self::is_defined(&from, &middle, &to);
            let none = [&from, &middle, &to].iter().all(|p| p.frame.is_none());
            let last = depth >= DEPTH || count >= MOST || !(u > from.u && u < to.u);
            if defined || last || (none && depth >= 1) {
                count += 1;
                each(&from, &to, defined);
                from = to;
            } else {
                stack.push((to, depth + 1));
                stack.push((middle, depth + 1));
            }
        }
    }
}

/// What preparation knows while it walks along the curve.
struct Walk<'a, P> {
    base: &'a RotationMinimizingFrames<P>,
    flips: Flips,
    stretches: Vec<Stretch>,
    /// Where the undefined stretch began that one is in.
    undefined: Option<f64>,
    /// The last frame known and its sign.
    last: Option<(Frame, f64)>,
}

impl<P: SpaceCurve> Walk<'_, P> {
    fn length(&self, start: f64, end: f64) -> f64 {
        let accuracy = 1e-10 * self.base.directions().size();
        self.base
            .path()
            .length_between(start, end, accuracy)
            .max(0.0)
    }

    fn undefined(&self, start: f64, end: f64, angle: f64, turn: f64) -> Stretch {
        Stretch {
            start,
            angle,
            kind: Kind::Undefined {
                end,
                length: self.length(start, end),
                turn,
            },
        }
    }

    fn cell(&mut self, from: &Probe, to: &Probe, defined: bool) {
        let (true, Some(first), Some(second)) = (defined, from.frame, to.frame) else {
            self.undefined.get_or_insert(from.u);
            return;
        };
        let angle = self.base.carried(from.u, true).twist_to(&first);
        let gap = self.undefined.take();
        let mut sign = 1.0;
        match (gap, self.last) {
            (Some(start), Some((before, _))) => {
                let edge = self.base.carried(start, false).twist_to(&before);
                let mut turn = wrapped(angle - edge);
                if self.flips == Flips::Repaired && turn.abs() > FRAC_PI_2 {
                    sign = -1.0;
                    turn = wrapped(turn + PI);
                }
                self.stretches
                    .push(self.undefined(start, from.u, edge, turn));
            }
            (Some(start), None) => self
                .stretches
                .push(self.undefined(start, from.u, angle, 0.0)),
            (None, Some((before, _))) => {
                let carried = before.turned(first.forward());
                if self.flips == Flips::Repaired && carried.up().dot(first.up()) < 0.0 {
                    sign = -1.0;
                }
            }
            (None, None) => {}
        }
        let changed = self.last.is_none_or(|(_, before)| before != sign);
        if gap.is_some() || changed {
            self.stretches.push(Stretch {
                start: from.u,
                angle: if sign < 0.0 { angle + PI } else { angle },
                kind: Kind::Defined(sign),
            });
        }
        self.last = Some((signed(second, sign), sign));
    }

    /// Deals with what is undefined at the end, and through the start of a closed curve.
    fn finish(mut self) -> Vec<Stretch> {
        let (start, end) = self.base.path().domain();
        let Some((last, _)) = self.last else {
            // Straight all along.
            let angle = 0.0;
            self.stretches = vec![self.undefined(start, end, angle, 0.0)];
            return self.stretches;
        };
        let gap = self.undefined.unwrap_or(end);
        let edge = self.base.carried(gap, false).twist_to(&last);
        let mut behind = self.length(gap, end);
        let leading = match self.stretches.first() {
            Some(Stretch {
                kind: Kind::Undefined { length, .. },
                ..
            }) => Some(*length),
            _ => None,
        };
        let mut turn = 0.0;
        if let (Some(leftover), true) = (
            self.base.leftover(),
            leading.is_some() || self.undefined.is_some(),
        ) {
            let first = self.stretches.first().map_or(0.0, |s| s.angle);
            let whole = wrapped(first - leftover - edge);
            let ahead = leading.unwrap_or(0.0);
            if behind + ahead <= 0.0 {
                behind = 1.0;
            }
            turn = whole * (behind / (behind + ahead));
            if let Some(Stretch {
                angle,
                kind: Kind::Undefined { turn, .. },
                ..
            }) = self.stretches.first_mut()
            {
                *turn = whole * (ahead / (behind + ahead));
                *angle -= *turn;
            }
        }
        if let Some(start) = self.undefined {
            self.stretches.push(self.undefined(start, end, edge, turn));
        }
        self.stretches
    }
}

/// The frame with its up axis turned over where the sign is negative.
fn signed(frame: Frame, sign: f64) -> Frame {
    if sign < 0.0 {
        Frame::nearly(frame.forward(), -frame.up())
    } else {
        frame
    }
}

impl Frenet {
    /// Prepares the frames along a path.
    ///
    /// # Errors
    ///
    /// A path without length, an up vector that is no direction.
    pub fn along<P: SpaceCurve>(&self, path: P) -> Result<FrenetFrames<P>, OrientationError> {
        let settings = RotationMinimizing {
            up: direction("up", self.up)?,
            end: End::Free,
            ..RotationMinimizing::default()
        };
        let base = settings.along(path)?;
        let mut walk = Walk {
            base: &base,
            flips: self.flips,
            stretches: Vec::new(),
            undefined: None,
            last: None,
        };
        for span in 0..base.directions().spans() {
            let search = Search {
                curve: base.path(),
                directions: base.directions(),
                span,
            };
            search.cells(&mut |from, to, defined| walk.cell(from, to, defined));
        }
        let stretches = walk.finish();
        Ok(FrenetFrames {
            base,
            stretches,
            axis: self.axis,
        })
    }
}

impl<P: SpaceCurve> FrenetFrames<P> {
    /// The parameters between which the curve has no normal, in order: straight stretches, and the narrow surroundings of inflections
    /// and stops.
    pub fn undefined(&self) -> impl Iterator<Item = (f64, f64)> {
        self.stretches.iter().filter_map(|s| match s.kind {
            Kind::Undefined { end, .. } => Some((s.start, end)),
            Kind::Defined(_) => None,
        })
    }

    /// The frame with the normal up.
    fn normal(&self, u: f64) -> Frame {
        let index = self.stretches.partition_point(|s| s.start <= u);
        let stretch = &self.stretches[index.saturating_sub(1)];
        let carried = || self.base.frame(u);
        match stretch.kind {
            Kind::Defined(sign) => {
                let search = Search {
                    curve: self.base.path(),
                    directions: self.base.directions(),
                    span: self.base.directions().span_of(u),
                };
                let frame = search.probe(u).frame.map(|frame| signed(frame, sign));
                frame.unwrap_or_else(|| carried().rolled(stretch.angle))
            }
            Kind::Undefined { end, length, turn } => {
                let share = if turn == 0.0 {
                    0.0
                } else if length > 0.0 {
                    let accuracy = 1e-10 * length;
                    let path = self.base.path();
                    path.length_between(stretch.start, u, accuracy) / length
                } else {
                    (u - stretch.start) / (end - stretch.start)
                };
                carried().rolled(stretch.angle + turn * share.clamp(0.0, 1.0))
            }
        }
    }
}

impl<P: SpaceCurve> Orienter for FrenetFrames<P> {
    fn frame(&self, parameter: f64) -> Frame {
        let path = self.base.path();
        let (start, end) = path.domain();
        let mut u = path.within(parameter);
        if u == end && path.is_closed() {
            u = start;
        }
        let frame = self.normal(u);
        match self.axis {
            FrenetUp::Normal => frame,
            FrenetUp::Binormal => frame.rolled(FRAC_PI_2),
        }
    }
}
