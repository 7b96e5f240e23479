//! Paths that go from key to key along great arcs, at constant speed or by linear interpolation.
//!
//! Both have corners at the keys, where the angular velocity jumps.
//!
//! *Source*: K. Shoemake, *Animating Rotation with Quaternion Curves*, SIGGRAPH 1985.

use super::arc::{Arc, Moving};
use super::error::OrientationError;
use super::keys::Keys;
use super::operators::lerp;
use super::path::{Circle, Orientations, RUN, angular_velocity, room};
use super::timeline::Timeline;
use anamorph_core::glam::{DQuat, DVec3};

/// [`slerp`](super::slerp) from key to key: turns at constant speed within each span.
#[derive(Debug, Clone, PartialEq)]
pub struct SlerpPath {
    line: Timeline,
    arcs: Vec<Arc>,
}

impl SlerpPath {
    /// The path through the keys.
    pub fn new(keys: &Keys) -> Self {
        let q = keys.keys();
        Self {
            line: Timeline::new(keys),
            arcs: keys.each_segment(Arc::between(q[0], q[0]), |i| Arc::between(q[i], q[i + 1])),
        }
    }
}

impl Orientations for SlerpPath {
    fn times(&self) -> &[f64] {
        self.line.times()
    }

    fn is_closed(&self) -> bool {
        self.line.is_closed()
    }

    fn orientation(&self, t: f64) -> DQuat {
        let (i, x) = self.line.locate(t);
        self.arcs[i].at(x)
    }

    fn angular_velocity(&self, t: f64) -> DVec3 {
        if self.line.rests_at(t) {
            return DVec3::ZERO;
        }
        let (i, x) = self.line.locate(t);
        angular_velocity(self.arcs[i].moving(x), self.line.span(i))
    }

    fn orientations(&self, times: &[f64], out: &mut [DQuat]) -> Result<(), OrientationError> {
        room(times, out)?;
        let mut circle = Circle::new();
        let mut segments = [0; RUN];
        for (times, out) in times.chunks(RUN).zip(out.chunks_mut(RUN)) {
            for (j, &t) in times.iter().enumerate() {
                let (i, x) = self.line.locate(t);
                segments[j] = i;
                circle.angle[j] = x * self.arcs[i].angle;
            }
            circle.fill(times.len());
            for (j, q) in out.iter_mut().enumerate() {
                *q = self.arcs[segments[j]].combined(circle.sin[j], circle.cos[j]);
            }
        }
        Ok(())
    }
}

/// [`lerp`](super::lerp) from key to key: the arcs of [`SlerpPath`], faster in the middle of each span than at its ends.
#[derive(Debug, Clone, PartialEq)]
pub struct LerpPath {
    line: Timeline,
    ends: Vec<[DQuat; 2]>,
}

impl LerpPath {
    /// The path through the keys.
    pub fn new(keys: &Keys) -> Self {
        let q = keys.keys();
        Self {
            line: Timeline::new(keys),
            ends: keys.each_segment([q[0]; 2], |i| [q[i], q[i + 1]]),
        }
    }
}

impl Orientations for LerpPath {
    fn times(&self) -> &[f64] {
        self.line.times()
    }

    fn is_closed(&self) -> bool {
        self.line.is_closed()
    }

    fn orientation(&self, t: f64) -> DQuat {
        let (i, x) = self.line.locate(t);
        let [a, b] = self.ends[i];
        lerp(a, b, x)
    }

    fn angular_velocity(&self, t: f64) -> DVec3 {
        if self.line.rests_at(t) {
            return DVec3::ZERO;
        }
        let (i, x) = self.line.locate(t);
        let [a, b] = self.ends[i];
        let sum = a * (1.0 - x) + b * x;
        // Neighbouring keys are at most a right angle apart, so that the sum is at least √½ long.
        let length = sum.dot(sum).sqrt();
        let at = sum / length;
        let rate = (b - a) / length;
        let rate = rate - at * at.dot(rate);
        angular_velocity(Moving { at, rate }, self.line.span(i))
    }
}
