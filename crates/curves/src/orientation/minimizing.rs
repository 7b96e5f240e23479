//! Rotation-minimizing frames: the default, frames that turn no more than the curve makes them.
//!
//! *Source*: W. Wang, B. Jüttler, D. Zheng, Y. Liu, *Computation of Rotation Minimizing Frames*, ACM Transactions on
//! Graphics 27(1), 2008: double reflection (§4, Table I), minimal total twist for closed curves and given end frames (§6.3);
//! errata C14.
//!
//! A step of double reflection errs by the fifth power of its length. Preparation halves steps until one whole step and two
//! halves agree, so that the twist is as accurate as asked for wherever frames are asked for: they do not depend on which
//! others were. Each span starts with four steps; a step is halved, too, until its chord is within 40° of the directions at both
//! its ends, so that no loop of the curve passes between two samples.
//!
//! Where the direction jumps, frames turn by the smallest rotation at a corner; where it reverses (a cusp) they turn about
//! their up axis, which stays. The place itself has the frame that leaves it. Where the curve rests, frames rest. Steps
//! whose chord is lost in the rounding of the coordinates use the directions alone, which is of second order, and are halved
//! accordingly.

use super::directions::{Directions, Place};
use super::error::{direction, in_range, of_path};
use super::{Frame, OrientationError, Orienter, SpaceCurve};
use crate::{ArcLength, LengthTable};
use anamorph_core::glam::DVec3;
use anamorph_core::{Curve, Solid, Space};
use core::f64::consts::TAU;

/// The accuracy when none is asked for, in radians: a hundred-thousandth of a pixel at the edge of a large picture.
pub const ACCURACY: f64 = 1e-9;
/// Cosine of the angle allowed between a step's chord and the directions at its ends.
const CHORD: f64 = 0.766;
/// Halvings of a quarter of a span at most. What is not resolved then is a cusp or corner: sums of velocities and
/// rounding keep seven digits of its directions.
const DEPTH: u32 = 28;
/// Steps at most, which bounds memory (56 MB) whatever is asked for.
const MOST: usize = 1 << 20;
/// Shares of the coordinates below which chords are rounding: their directions keep six digits above it.
const LOST: f64 = 1e-10;
/// No pair of steps agrees better than this, in radians.
const ROUNDING: f64 = 4e-15;

/// What happens to the twist at the end of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum End {
    /// Closed paths close: the twist left over after a round is taken back, evenly by arc length. Open ones end as they end.
    #[default]
    Close,
    /// No twist is added; the frames of a closed path jump where it starts.
    Free,
    /// The last frame has its up axis as near to this vector as can be; the difference is spread evenly by arc length. On closed paths, the
    /// same as [`Self::Close`] where it is the vector of the start.
    Up(DVec3),
}

/// Rotation-minimizing frames: settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotationMinimizing {
    /// The up vector of the first frame ([`Frame::level`]); `y` by default.
    pub up: DVec3,
    /// What happens to the twist at the end.
    pub end: End,
    /// Whole turns added over the path, about its direction by the right-hand rule. Frames of a closed path still close.
    pub turns: i32,
    /// The largest error of the twist in radians, from 1e-13; [`ACCURACY`] by default.
    pub accuracy: f64,
}

impl Default for RotationMinimizing {
    fn default() -> Self {
        Self {
            up: DVec3::Y,
            end: End::Close,
            turns: 0,
            accuracy: ACCURACY,
        }
    }
}

impl RotationMinimizing {
    /// Prepares the frames along a path.
    ///
    /// # Errors
    ///
    /// A path without length, a vector that is no direction, an accuracy that is not positive or above 0.1.
    pub fn along<P: SpaceCurve>(
        &self,
        path: P,
    ) -> Result<RotationMinimizingFrames<P>, OrientationError> {
        let holds = self.accuracy > 0.0 && self.accuracy <= 0.1;
        let range = "above 0 and at most 0.1 radians";
        let accuracy = in_range("the accuracy", self.accuracy, holds, range)?.max(1e-13);
        let up = direction("up", self.up)?;
        let end_up = match self.end {
            End::Up(vector) => Some(direction("the up vector of the end", vector)?),
            _ => None,
        };
        let directions = Directions::new(&*path).map_err(of_path)?;
        let (start, end) = path.domain();
        let first = directions.place(&*path, start);
        let steps = Steps::take(
            &*path,
            &directions,
            Frame::level(first.ahead, up),
            accuracy / (end - start),
        );
        let mut frames = RotationMinimizingFrames {
            steps,
            directions,
            spread: None,
            leftover: None,
            twist: 0.0,
            closes: path.is_closed() && self.end == End::Close,
            path,
        };
        let last = frames.carried(end, true);
        let start = frames.steps.knots[0].frame;
        if frames.path.is_closed() {
            frames.leftover = Some(start.twist_to(&last));
        }
        let wanted = match end_up {
            Some(up) => Some(Frame::level(last.forward(), up)),
            None if frames.closes => Some(start),
            None => None,
        };
        let twist =
            wanted.map_or(0.0, |wanted| last.twist_to(&wanted)) + TAU * f64::from(self.turns);
        if twist != 0.0 {
            let rough = frames.path.length(1e-3 * frames.directions.size());
            // The twist is off by as much as the share of the length.
            let accuracy = 0.25 * rough * accuracy / twist.abs().max(1.0);
            frames.spread = Some(LengthTable::new(&*frames.path, accuracy).map_err(of_path)?);
            frames.twist = twist;
        }
        Ok(frames)
    }
}

/// A place with its frame. Its step reaches to the next.
#[derive(Clone, Copy, Debug)]
struct Knot {
    u: f64,
    frame: Frame,
}

/// The steps of double reflection along a path.
#[derive(Clone, Debug)]
struct Steps {
    knots: Vec<Knot>,
    complete: bool,
}

/// A step of double reflection between two places.
fn step(frame: &Frame, from: Solid, to: &Place) -> Frame {
    let chord = to.point - from;
    let coordinates = from.largest().max(to.point.largest());
    let counts = chord.largest() > LOST * coordinates;
    frame.reflected(counts.then_some(chord), to.behind)
}

/// Whether no loop of the curve hides in the step: its chord lies along the directions at both ends.
fn is_short(from: &Place, to: &Place) -> bool {
    let chord = to.point - from.point;
    let coordinates = from.point.largest().max(to.point.largest());
    if chord.largest() <= LOST * coordinates {
        return from.ahead.dot(to.behind) > CHORD;
    }
    Space::normalized(chord).is_some_and(|c| c.dot(from.ahead) > CHORD && c.dot(to.behind) > CHORD)
}

impl Steps {
    /// Takes steps along the whole path from a first frame; `per_parameter` is the twist by which the steps over a unit of the
    /// parameter may err.
    fn take<C: ArcLength<Solid> + ?Sized>(
        curve: &C,
        directions: &Directions,
        first: Frame,
        per_parameter: f64,
    ) -> Self {
        let mut knots = Vec::new();
        let mut complete = true;
        let mut frame = first;
        for span in 0..directions.spans() {
            let (a, b) = directions.span(span);
            if !directions.span_moves(span) {
                knots.push(Knot { u: a, frame });
                // Behind it the curve may leave another way.
                frame = frame.turned(directions.place(curve, b).ahead);
                continue;
            }
            let quarter = |k: u32| match k {
                4 => b,
                k => a + (b - a) * (0.25 * f64::from(k)),
            };
            let mut from = directions.place(curve, a);
            let mut stack = Vec::new();
            for k in (1..=4).rev() {
                stack.push((directions.place(curve, quarter(k)), 0));
            }
            while let Some((to, depth)) = stack.pop() {
                let middle = 0.5 * (from.u + to.u);
                if !(middle > from.u && middle < to.u) {
                    knots.push(Knot { u: from.u, frame });
                    frame = step(&frame, from.point, &to).turned(to.ahead);
                    from = to;
                    continue;
                }
                let middle = directions.place(curve, middle);
                let whole = step(&frame, from.point, &to);
                let half = step(&frame, from.point, &middle).turned(middle.ahead);
                let halves = step(&half, middle.point, &to);
                let allowed = (per_parameter * (to.u - from.u)).max(ROUNDING);
                let short =
                    is_short(&from, &middle) && is_short(&middle, &to) && is_short(&from, &to);
                let good = short && whole.twist_to(&halves).abs() <= allowed;
                let full = knots.len() + stack.len() >= MOST;
                if good || depth >= DEPTH || full {
                    complete &= good || !full;
                    knots.push(Knot { u: from.u, frame });
                    knots.push(Knot {
                        u: middle.u,
                        frame: half,
                    });
                    frame = halves.turned(to.ahead);
                    from = to;
                } else {
                    stack.push((to, depth + 1));
                    stack.push((middle, depth + 1));
                }
            }
        }
        Self { knots, complete }
    }
}

/// Rotation-minimizing frames along a path, prepared.
#[derive(Clone, Debug)]
pub struct RotationMinimizingFrames<P> {
    path: P,
    directions: Directions,
    steps: Steps,
    /// Arc lengths, where twist is spread.
    spread: Option<LengthTable>,
    leftover: Option<f64>,
    twist: f64,
    /// The end of the path is its start again, in frames, too.
    closes: bool,
}

impl<P: SpaceCurve> RotationMinimizingFrames<P> {
    /// The path.
    pub fn path(&self) -> &P::Target {
        &self.path
    }

    pub(super) fn directions(&self) -> &Directions {
        &self.directions
    }

    /// Of a closed path: the angle in radians, in (−π, π], by which rotation-minimizing frames have turned about the direction
    /// after one round, before any is taken back. `None` for open paths.
    #[must_use]
    pub fn leftover(&self) -> Option<f64> {
        self.leftover
    }

    /// The twist in radians that was added over the whole path, evenly by arc length: to close, to meet the up vector of
    /// the end, and the whole turns.
    #[must_use]
    pub fn added_twist(&self) -> f64 {
        self.twist
    }

    /// The angle in radians, in (−π, π], by which a frame at a parameter is turned about the direction against these. Followed
    /// along the path, it is the frame's twist.
    #[must_use]
    pub fn twist_of(&self, parameter: f64, frame: &Frame) -> f64 {
        self.frame(parameter).twist_to(frame)
    }

    /// Whether the accuracy was reached everywhere. It is not where a curve turns so often that a million steps do not follow it.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.steps.complete
    }

    /// The number of steps prepared: what memory and time of preparation are proportional to.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.steps.knots.len()
    }

    /// The frame at a parameter within the domain as it is carried there, without added twist; `leaves`: behind a jump of the
    /// direction, not before it.
    pub(super) fn carried(&self, u: f64, leaves: bool) -> Frame {
        let knots = &self.steps.knots;
        let reached = knots.partition_point(|knot| knot.u < u);
        if leaves && knots.get(reached).is_some_and(|knot| knot.u == u) {
            return knots[reached].frame;
        }
        let knot = &knots[reached.saturating_sub(1)];
        let to = self.directions.place(&*self.path, u);
        let frame = if self.directions.span_moves(self.directions.span_of(knot.u)) {
            step(&knot.frame, self.path.point(knot.u), &to)
        } else {
            knot.frame
        };
        if leaves && to.ahead != to.behind {
            frame.turned(to.ahead)
        } else {
            frame
        }
    }
}

impl<P: SpaceCurve> Orienter for RotationMinimizingFrames<P> {
    fn frame(&self, parameter: f64) -> Frame {
        let (start, end) = self.path.domain();
        let mut u = self.path.within(parameter);
        if u == end && self.closes {
            u = start;
        }
        let frame = self.carried(u, u < end || self.path.is_closed());
        match &self.spread {
            Some(table) => frame.rolled(self.twist * (table.length_to(u) / table.length())),
            None => frame,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families::{CubicBezier, Generator};
    use anamorph_core::glam::dvec3;

    /// The method itself, without halving: halving all steps divides the error of the twist by 16.
    #[test]
    fn double_reflection_is_of_order_four() {
        let points = vec![
            dvec3(0.0, 0.0, 0.0),
            dvec3(2.0, 2.0, 0.3),
            dvec3(1.0, -2.0, 1.0),
            dvec3(3.0, 0.0, 0.5),
        ];
        let bezier = CubicBezier {
            points,
            closed: false,
        };
        let curve = bezier.curve().unwrap();
        let directions = Directions::new(&curve).unwrap();
        let last = |count: u32| {
            let place = |i: u32| directions.place(&curve, f64::from(i) / f64::from(count));
            let mut from = place(0);
            let mut frame = Frame::level(from.ahead, DVec3::Z);
            for i in 1..=count {
                let to = place(i);
                frame = step(&frame, from.point, &to);
                from = to;
            }
            frame
        };
        let exact = last(1 << 13);
        let errors = [64, 128, 256, 512].map(|n| last(n).twist_to(&exact).abs());
        for pair in errors.windows(2) {
            let ratio = pair[0] / pair[1];
            assert!((14.0..18.0).contains(&ratio), "{ratio}: {errors:?}");
        }
    }
}
