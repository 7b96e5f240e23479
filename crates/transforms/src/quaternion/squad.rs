//! Squad through keys.
//!
//! *Source*: K. Shoemake, *Quaternion Calculus and Fast Animation*, SIGGRAPH course notes 10, 1987. Errata C15: two inner
//! points a key where times are unequal ([`squad_points`]), and no slerp that flips a sign.

use super::arc::{Arc, slerp_moving};
use super::basics::slerp;
use super::keys::Keys;
use super::operators::squad_points;
use super::path::{Orientations, angular_velocity};
use super::timeline::Timeline;
use anamorph_core::glam::{DQuat, DVec3};

/// Shoemake's spherical quadrangle curves from key to key: the angular velocity is continuous at the keys, for unequal
/// times too. Half the work of [`BezierPath`](super::BezierPath).
///
/// At an open end the missing neighbour is the other one reflected in the key (errata C9).
#[derive(Debug, Clone, PartialEq)]
pub struct SquadPath {
    line: Timeline,
    /// The arcs between the keys and between the inner points of a span.
    arcs: Vec<[Arc; 2]>,
}

impl SquadPath {
    /// The path through the keys.
    pub fn new(keys: &Keys) -> Self {
        let q = keys.keys();
        let inner = |i: usize| {
            let at = keys.around(i);
            squad_points(at.previous, at.key, at.next, at.spans)
        };
        let arcs = keys.each_segment([Arc::between(q[0], q[0]); 2], |i| {
            [
                Arc::between(q[i], q[i + 1]),
                Arc::between(inner(i)[1], inner(i + 1)[0]),
            ]
        });
        Self {
            line: Timeline::new(keys),
            arcs,
        }
    }
}

impl Orientations for SquadPath {
    fn times(&self) -> &[f64] {
        self.line.times()
    }

    fn is_closed(&self) -> bool {
        self.line.is_closed()
    }

    fn orientation(&self, t: f64) -> DQuat {
        let (i, x) = self.line.locate(t);
        let [outer, inner] = self.arcs[i].map(|arc| arc.at(x));
        slerp(outer, inner, 2.0 * x * (1.0 - x))
    }

    fn angular_velocity(&self, t: f64) -> DVec3 {
        if self.line.rests_at(t) {
            return DVec3::ZERO;
        }
        let (i, x) = self.line.locate(t);
        let [outer, inner] = self.arcs[i].map(|arc| arc.moving(x));
        let moving = slerp_moving(outer, inner, 2.0 * x * (1.0 - x), 2.0 - 4.0 * x);
        angular_velocity(moving, self.line.span(i))
    }
}
