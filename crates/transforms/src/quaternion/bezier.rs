//! Cubic Bézier segments on the sphere through keys.
//!
//! *Source*: K. Shoemake, *Animating Rotation with Quaternion Curves*, SIGGRAPH 1985. Errata C7, C8, C9 and C15: see
//! [`inner_points`].

use super::arc::{Arc, Moving, slerp_moving};
use super::basics::slerp;
use super::keys::Keys;
use super::operators::{InnerPoints, inner_points};
use super::path::{Orientations, angular_velocity};
use super::timeline::Timeline;
use anamorph_core::glam::{DQuat, DVec3};

/// Cubic Bézier curves on the sphere from key to key, by de Casteljau's construction: the angular velocity is continuous
/// at the keys, for unequal times too, and equal turns in equal times become one even turn.
///
/// At an open end the missing neighbour is the other one reflected in the key (errata C9).
#[derive(Debug, Clone, PartialEq)]
pub struct BezierPath {
    line: Timeline,
    /// The three arcs of a span's control polygon.
    sides: Vec<[Arc; 3]>,
}

impl BezierPath {
    /// The path through the keys, inner control points a third of the way.
    pub fn new(keys: &Keys) -> Self {
        Self::with_inner_points(keys, InnerPoints::Thirds)
    }

    /// The path through the keys with inner control points as far out as said.
    pub fn with_inner_points(keys: &Keys, distance: InnerPoints) -> Self {
        let q = keys.keys();
        let inner = |i: usize| {
            let at = keys.around(i);
            inner_points(at.previous, at.key, at.next, at.spans, distance)
        };
        let rest = [Arc::between(q[0], q[0]); 3];
        let sides = keys.each_segment(rest, |i| {
            let (a, b) = (inner(i)[1], inner(i + 1)[0]);
            [
                Arc::between(q[i], a),
                Arc::between(a, b),
                Arc::between(b, q[i + 1]),
            ]
        });
        Self {
            line: Timeline::new(keys),
            sides,
        }
    }

    /// The four control points of span `i`; `None` beyond the last.
    pub fn controls(&self, i: usize) -> Option<[DQuat; 4]> {
        let [first, second, third] = self.sides.get(i)?;
        Some([first.start, second.start, third.start, third.at(1.0)])
    }
}

impl Orientations for BezierPath {
    fn times(&self) -> &[f64] {
        self.line.times()
    }

    fn is_closed(&self) -> bool {
        self.line.is_closed()
    }

    fn orientation(&self, t: f64) -> DQuat {
        let (i, x) = self.line.locate(t);
        let [a, b, c] = self.sides[i].map(|side| side.at(x));
        slerp(slerp(a, b, x), slerp(b, c, x), x)
    }

    fn angular_velocity(&self, t: f64) -> DVec3 {
        if self.line.rests_at(t) {
            return DVec3::ZERO;
        }
        let (i, x) = self.line.locate(t);
        let [a, b, c]: [Moving; 3] = self.sides[i].map(|side| side.moving(x));
        let (left, right) = (slerp_moving(a, b, x, 1.0), slerp_moving(b, c, x, 1.0));
        angular_velocity(slerp_moving(left, right, x, 1.0), self.line.span(i))
    }
}
