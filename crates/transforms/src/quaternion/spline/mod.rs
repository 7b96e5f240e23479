//! A rotation spline: orientation through keys with continuous angular velocity and angular acceleration.
//!
//! *Source*: the angular-rate method, as in N. Mayorov's *Smooth Attitude Interpolation* (2019) and `SciPy`'s
//! `RotationSpline`: from key to key the orientation is `q·exp(φ)` with a polynomial rotation vector `φ`, and the angular
//! velocities at the keys are those for which the angular acceleration is continuous (`rates.rs`). We deviate in two
//! things. The equations are solved by Newton's method to rounding, not by substitution to 1e-9. And a span is a
//! quintic that takes velocity and acceleration of both keys. It is the cubic where the equations are solved, and keeps the
//! path C² where they are not: when spans are very uneven they may have no solution, or one that spins for hundreds of
//! rounds between two keys. The velocities at the keys are then the local ones of errata C15.

mod rates;
mod turn;

use super::basics::{exp, ln, to_matrix};
use super::error::OrientationError;
use super::keys::Keys;
use super::path::{Circle, Orientations, RUN, room};
use super::timeline::Timeline;
use anamorph_core::Space;
use anamorph_core::glam::{DQuat, DVec3};
use rates::{Rates, Span};
use turn::Turn;

/// What holds at an end of an open [`RotationSpline`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum End {
    /// No angular acceleration.
    #[default]
    Natural,
    /// The angular velocity with which an even turn would cover the first or the last span, as `SciPy` takes it.
    Chord,
    /// This angular velocity, in radians per unit of time about an axis fixed in space; null for a rest.
    Rate(DVec3),
}

/// What holds at both ends of an open [`RotationSpline`]; a closed one is periodic instead.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ends {
    /// At the first key.
    pub start: End,
    /// At the last key.
    pub end: End,
}

impl Ends {
    /// No angular acceleration at either end.
    pub const NATURAL: Self = Self {
        start: End::Natural,
        end: End::Natural,
    };
    /// Even turns set the angular velocity at either end, as in `SciPy`.
    pub const CHORDS: Self = Self {
        start: End::Chord,
        end: End::Chord,
    };
    /// At rest at either end.
    pub const RESTS: Self = Self {
        start: End::Rate(DVec3::ZERO),
        end: End::Rate(DVec3::ZERO),
    };
}

/// Greatest angular velocity that may be given for an end.
const FASTEST: f64 = 1e30;

/// One span: `key·exp(v(x))`, with half the rotation vector, `v(x) = c₁x + … + c₅x⁵` for `x` in [0, 1].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    key: DQuat,
    half: [DVec3; 5],
}

impl Piece {
    /// Half the rotation vector at `x`.
    #[inline(always)]
    fn half(&self, x: f64) -> DVec3 {
        let [a, b, c, d, e] = self.half;
        (a + (b + (c + (d + e * x) * x) * x) * x) * x
    }

    /// The derivative of half the rotation vector.
    fn half_rate(&self, x: f64) -> DVec3 {
        let [a, b, c, d, e] = self.half;
        a + (b * 2.0 + (c * 3.0 + (d * 4.0 + e * (5.0 * x)) * x) * x) * x
    }

    /// The orientation, from half the rotation vector and the sine and cosine of its length.
    #[inline(always)]
    fn turned(&self, half: DVec3, length: f64, sin: f64, cos: f64) -> DQuat {
        let scale = if length > 0.0 { sin / length } else { 1.0 };
        self.key * DQuat::from_xyzw(half.x * scale, half.y * scale, half.z * scale, cos)
    }
}

/// A path through keys whose angular velocity and angular acceleration are continuous.
///
/// Like every C² spline it is not local: each key bears on the whole path, the less the farther away, and a span beside a
/// much shorter one swings out. [`BezierPath`](super::BezierPath) does neither.
#[derive(Debug, Clone, PartialEq)]
pub struct RotationSpline {
    line: Timeline,
    pieces: Vec<Piece>,
    settled: bool,
}

impl RotationSpline {
    /// The spline through the keys. Closed keys make it periodic, whatever `ends` are.
    ///
    /// # Errors
    /// [`OrientationError::Rate`] for a given angular velocity that is not finite or beyond 1e30.
    pub fn new(keys: &Keys, ends: Ends) -> Result<Self, OrientationError> {
        let line = Timeline::new(keys);
        let q = keys.keys();
        let ends = Ends {
            start: in_body(ends.start, q[0], "start")?,
            end: in_body(ends.end, q[q.len() - 1], "end")?,
        };
        if keys.segments() == 0 {
            let rest = Piece {
                key: q[0],
                half: [DVec3::ZERO; 5],
            };
            return Ok(Self {
                line,
                pieces: vec![rest],
                settled: true,
            });
        }
        let turn = |a: DQuat, b: DQuat| {
            // The product of a quaternion and its conjugate is 1 but for rounding.
            if a == b {
                DVec3::ZERO
            } else {
                ln(a.conjugate() * b) * 2.0
            }
        };
        let spans: Vec<Span> = (0..keys.segments())
            .map(|i| Span::new(turn(q[i], q[i + 1]), keys.span(i)))
            .collect();
        let rates = rates::rates(&spans, keys.is_closed(), &ends);
        let pieces = spans.iter().zip(q).enumerate();
        Ok(Self {
            line,
            pieces: pieces
                .map(|(i, (span, &key))| piece(key, span, &rates, i))
                .collect(),
            settled: rates.settled,
        })
    }

    /// Whether the equations for the angular velocities were solved, which is so unless spans are very uneven (from about
    /// 1 : 100). If not, the
    /// path is C² all the same, through the angular velocities that [`BezierPath`](super::BezierPath) has at the keys.
    pub fn is_settled(&self) -> bool {
        self.settled
    }
}

/// An end as the body sees it, checked.
fn in_body(end: End, key: DQuat, name: &'static str) -> Result<End, OrientationError> {
    match end {
        End::Rate(rate) => {
            if !(rate.is_finite() && Space::largest(rate) <= FASTEST) {
                return Err(OrientationError::Rate { end: name });
            }
            Ok(End::Rate(to_matrix(key.conjugate()).mul_vec3(rate)))
        }
        other => Ok(other),
    }
}

/// The quintic of span `i` that has the rates of both its keys.
fn piece(key: DQuat, span: &Span, rates: &Rates, i: usize) -> Piece {
    let h = span.length;
    // Derivatives by x of the rotation vector, at both ends.
    let first = rates.velocities[i] * h;
    let last = span.inverse * rates.velocities[i + 1] * h;
    let first_second = rates.accelerations[i] * h * h;
    let last_second = span.inverse * (rates.accelerations[i + 1] * h * h - span.turn.bending(last));
    let c1 = first;
    let c2 = first_second * 0.5;
    let value = span.delta - c1 - c2;
    let slope = last - c1 - c2 * 2.0;
    let second = (last_second - c2 * 2.0) * 0.5;
    Piece {
        key,
        half: [
            c1,
            c2,
            value * 10.0 - slope * 4.0 + second,
            value * -15.0 + slope * 7.0 - second * 2.0,
            value * 6.0 - slope * 3.0 + second,
        ]
        .map(|c| c * 0.5),
    }
}

impl Orientations for RotationSpline {
    fn times(&self) -> &[f64] {
        self.line.times()
    }

    fn is_closed(&self) -> bool {
        self.line.is_closed()
    }

    fn orientation(&self, t: f64) -> DQuat {
        let (i, x) = self.line.locate(t);
        let half = self.pieces[i].half(x);
        let length = half.dot(half).sqrt();
        let (sin, cos) = anamorph_core::math::sin_cos(length);
        self.pieces[i].turned(half, length, sin, cos)
    }

    fn angular_velocity(&self, t: f64) -> DVec3 {
        if self.line.rests_at(t) {
            return DVec3::ZERO;
        }
        let (i, x) = self.line.locate(t);
        let piece = &self.pieces[i];
        let half = piece.half(x);
        let seen_by_body = Turn::new(half * 2.0).velocity(piece.half_rate(x) * 2.0);
        to_matrix(piece.key * exp(half)).mul_vec3(seen_by_body / self.line.span(i))
    }

    fn orientations(&self, times: &[f64], out: &mut [DQuat]) -> Result<(), OrientationError> {
        room(times, out)?;
        let mut circle = Circle::new();
        let mut halves = [DVec3::ZERO; RUN];
        let mut segments = [0; RUN];
        for (times, out) in times.chunks(RUN).zip(out.chunks_mut(RUN)) {
            for (j, &t) in times.iter().enumerate() {
                let (i, x) = self.line.locate(t);
                let half = self.pieces[i].half(x);
                segments[j] = i;
                halves[j] = half;
                circle.angle[j] = half.dot(half).sqrt();
            }
            circle.fill(times.len());
            for (j, q) in out.iter_mut().enumerate() {
                let (length, sin, cos) = (circle.angle[j], circle.sin[j], circle.cos[j]);
                *q = self.pieces[segments[j]].turned(halves[j], length, sin, cos);
            }
        }
        Ok(())
    }
}
