//! The rotation of a wire: the smallest one from the source's direction to the target's, defined where there is none.
//!
//! Opposite directions have no smallest rotation. In the plane they turn by +π. In space the axis is carried along, without
//! twist about the source, from the nearest smaller parameter that has a smallest rotation, else from the nearest larger one;
//! where no parameter has one, it is the source's direction × the coordinate axis least aligned with it at the start, carried along
//! the curve.
//!
//! *Source*: Milliron et al. 2002, §4.4, with errata F8; W. Wang, B. Jüttler, D. Zheng, Y. Liu, *Computation of Rotation
//! Minimizing Frames*, ACM Transactions on Graphics 27(1), 2008 (double reflection).

use super::tangents::Tangents;
use anamorph_core::Space;
use anamorph_transforms::{Rotational, Turn};
use core::f64::consts::PI;

/// Directions this far (sine) from opposite have a plane to turn in.
const OPPOSITE: f64 = 1e-9;
/// Steps of the transport between two samples of a stretch.
const STEPS: u32 = 8;

/// A place in a stretch of opposite directions.
struct Knot<S> {
    at: f64,
    point: S,
    ahead: S,
    axis: S,
}

/// The rotations of a wire from its source to its target.
pub(super) struct Turning<S: Space> {
    /// Directions count as opposite below this sine: [`OPPOSITE`], more where coordinates are so large that rounding tilts them.
    opposite: f64,
    /// Stretches in which directions are opposite, each with its carried axes.
    stretches: Vec<Vec<Knot<S>>>,
    /// A direction of view about which alone turns go, in space.
    view: Option<S>,
}

fn cross<S: Rotational>(a: S, b: S) -> S {
    S::generator(a).apply_to(b)
}

/// Applies a linear map; a name of its own, because both traits of a linear map are in scope here.
trait Apply<S> {
    fn apply_to(&self, v: S) -> S;
}
impl<S: Space, L: anamorph_core::Linear<S>> Apply<S> for L {
    fn apply_to(&self, v: S) -> S {
        self.apply(v)
    }
}

/// Carries a vector across a unit direction from one place to another without twist (double reflection).
fn carried<S: Space>(axis: S, from: (S, S), to: (S, S)) -> S {
    let mirror = |x: S, n: S, squared: f64| x - n * (2.0 * n.dot(x) / squared);
    let chord = to.0 - from.0;
    let squared = chord.dot(chord);
    let (first, along) = if squared > 0.0 && squared.is_finite() {
        (mirror(axis, chord, squared), mirror(from.1, chord, squared))
    } else {
        (axis, from.1)
    };
    let second = to.1 - along;
    let squared = second.dot(second);
    let out = if squared > 1e-28 {
        mirror(first, second, squared)
    } else {
        first
    };
    let across = out - to.1 * to.1.dot(out);
    across.normalized().unwrap_or(axis)
}

/// Any unit vector across a direction: its product with the coordinate axis least aligned with it.
fn perpendicular<S: Rotational>(direction: S) -> S {
    let size = |i: usize| direction.component(i).abs();
    let least = (1..S::DIM).fold(0, |least, i| if size(i) < size(least) { i } else { least });
    cross(direction, S::unit(least))
        .normalized()
        .unwrap_or(S::ZERO)
}

impl<S: Rotational> Turning<S> {
    /// Looks for opposite directions along the source. With a `view`, a unit vector of space, directions are seen along it.
    pub(super) fn new(source: &Tangents<S>, target: &Tangents<S>, view: Option<S>) -> Self {
        let largest = |t: &Tangents<S>| {
            t.samples
                .iter()
                .fold(0.0_f64, |m, (_, p)| m.max(p.largest()))
        };
        let noise = |t: &Tangents<S>| {
            if t.polygon > 0.0 {
                1e-15 * largest(t) / t.polygon
            } else {
                0.0
            }
        };
        let mut turning = Self {
            opposite: (OPPOSITE + 256.0 * (noise(source) + noise(target))).min(1e-3),
            stretches: Vec::new(),
            view,
        };
        if S::DIM == 3 && view.is_none() {
            turning.find_stretches(source, target);
        }
        turning
    }

    /// Point and direction of the source at a parameter, and the direction of the target.
    fn directions(
        source: &Tangents<S>,
        target: &Tangents<S>,
        at: f64,
    ) -> (S, Option<S>, Option<S>) {
        let (point, a) = source.point_and_direction(at);
        let (_, b) = target.point_and_direction(target.parameter(source.share(at)));
        (point, a, b)
    }

    /// The axis of the smallest rotation at a parameter; the null vector where directions are equal, `None` where they are opposite
    /// or there are none.
    fn axis(&self, source: &Tangents<S>, target: &Tangents<S>, at: f64) -> Option<S> {
        let (_, Some(a), Some(b)) = Self::directions(source, target, at) else {
            return None;
        };
        if self.are_opposite(a, b) {
            return None;
        }
        S::turn_between(a, b).map(|turn| turn.axis)
    }

    fn are_opposite(&self, a: S, b: S) -> bool {
        a.dot(b) < 0.0 && cross(a, b).length() < self.opposite
    }

    fn find_stretches(&mut self, source: &Tangents<S>, target: &Tangents<S>) {
        let opposite = |at: f64| {
            let (_, a, b) = Self::directions(source, target, at);
            a.zip(b).is_some_and(|(a, b)| self.are_opposite(a, b))
        };
        let parameters: Vec<f64> = source.samples.iter().map(|(at, _)| *at).collect();
        let flags: Vec<bool> = parameters.iter().map(|&at| opposite(at)).collect();
        // The last opposite parameter beside one that is not.
        let edge = |mut inside: f64, mut outside: f64| {
            for _ in 0..60 {
                let middle = 0.5 * (inside + outside);
                if opposite(middle) {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            (inside, outside)
        };
        let mut stretches = Vec::new();
        let mut i = 0;
        while i < flags.len() {
            if !flags[i] {
                i += 1;
                continue;
            }
            let first = i;
            while i + 1 < flags.len() && flags[i + 1] {
                i += 1;
            }
            let last = i;
            i += 1;
            if first == last && flags.len() > 2 {
                // A single sample is more likely a single place, which the limit serves better.
                continue;
            }
            let before = (first > 0).then(|| edge(parameters[first], parameters[first - 1]));
            let behind = (i < flags.len()).then(|| edge(parameters[last], parameters[i]));
            let mut at: Vec<f64> = Vec::new();
            at.extend(before.map(|(inside, _)| inside));
            at.extend_from_slice(&parameters[first..=last]);
            at.extend(behind.map(|(inside, _)| inside));
            at.dedup();
            let usable = |outside: f64| {
                self.axis(source, target, outside)
                    .filter(|axis| axis.length() > 0.5)
            };
            let from_before = before.and_then(|(_, outside)| usable(outside));
            let from_behind = behind.and_then(|(_, outside)| usable(outside));
            let backwards = from_before.is_none() && from_behind.is_some();
            if backwards {
                at.reverse();
            }
            let start = source.point_and_direction(at[0]);
            let Some(ahead) = start.1 else { continue };
            let axis = from_before
                .or(from_behind)
                .map(|axis| axis - ahead * ahead.dot(axis))
                .and_then(Space::normalized)
                .unwrap_or_else(|| perpendicular(ahead));
            let mut knots = vec![Knot {
                at: at[0],
                point: start.0,
                ahead,
                axis,
            }];
            for pair in at.windows(2) {
                for step in 1..=STEPS {
                    let share = f64::from(step) / f64::from(STEPS);
                    let at = pair[0] * (1.0 - share) + pair[1] * share;
                    let (point, ahead) = source.point_and_direction(at);
                    let Some(last) = knots.last() else { break };
                    let ahead = ahead.unwrap_or(last.ahead);
                    let axis = carried(last.axis, (last.point, last.ahead), (point, ahead));
                    knots.push(Knot {
                        at,
                        point,
                        ahead,
                        axis,
                    });
                }
            }
            if backwards {
                knots.reverse();
            }
            stretches.push(knots);
        }
        self.stretches = stretches;
    }

    /// The axis of the half turn at a parameter whose directions are opposite.
    fn half_turn_axis(
        &self,
        source: &Tangents<S>,
        target: &Tangents<S>,
        at: f64,
        here: (S, S),
    ) -> S {
        for knots in &self.stretches {
            let (Some(first), Some(last)) = (knots.first(), knots.last()) else {
                continue;
            };
            if at >= first.at && at <= last.at {
                let next = knots.partition_point(|knot| knot.at < at);
                let knot = &knots[next.min(knots.len() - 1)];
                let before = &knots[next.saturating_sub(1)];
                let from = if at - before.at <= knot.at - at {
                    before
                } else {
                    knot
                };
                return carried(from.axis, (from.point, from.ahead), here);
            }
        }
        // A single place: the limit from the smaller parameter, else from the larger.
        let width = source.domain.1 - source.domain.0;
        let limit = |side: f64| {
            (0..16).find_map(|k| {
                let step = side * width * 1e-7 * anamorph_core::math::powi(4.0, k);
                let there = at + step;
                if there < source.domain.0 || there > source.domain.1 {
                    return None;
                }
                let near = self.axis(source, target, there)?;
                // Twice the nearer less the farther: what is linear in the step cancels.
                let farther = self.axis(source, target, at + 2.0 * step).unwrap_or(near);
                let axis = near + (near - farther);
                (near.length() > 0.5).then(|| axis.normalized())?
            })
        };
        limit(-1.0)
            .or_else(|| limit(1.0))
            .map(|axis| axis - here.1 * here.1.dot(axis))
            .and_then(Space::normalized)
            .unwrap_or_else(|| perpendicular(here.1))
    }

    /// The point of the source at a parameter, and the rotation there.
    pub(super) fn at(
        &self,
        source: &Tangents<S>,
        target: &Tangents<S>,
        at: f64,
        on_target: f64,
    ) -> (S, S, Turn<S>) {
        let (point, a) = source.point_and_direction(at);
        let (goal, b) = target.point_and_direction(on_target);
        let (Some(a), Some(b)) = (a, b) else {
            return (point, goal, Turn::none());
        };
        if let Some(view) = self.view {
            return (point, goal, seen_along(view, a, b));
        }
        let turn = if S::DIM == 3 && self.are_opposite(a, b) {
            Turn {
                axis: self.half_turn_axis(source, target, at, (point, a)),
                angle: PI,
            }
        } else {
            S::turn_between(a, b).unwrap_or_else(Turn::none)
        };
        (point, goal, turn)
    }
}

/// The rotation about a direction of view between two directions as seen along it; none where one is seen as a point. Opposite
/// ones turn by +π, as in the plane.
fn seen_along<S: Rotational>(view: S, a: S, b: S) -> Turn<S> {
    let flat = |d: S| d - view * view.dot(d);
    let (a, b) = (flat(a), flat(b));
    if a.length() < OPPOSITE || b.length() < OPPOSITE {
        return Turn::none();
    }
    let sine = view.dot(cross(a, b));
    let angle = anamorph_core::math::atan2(sine, a.dot(b));
    Turn {
        axis: view,
        // A half turn's sense must not hang on rounding.
        angle: if angle < 1e-9 - PI {
            angle + 2.0 * PI
        } else {
            angle
        },
    }
}
