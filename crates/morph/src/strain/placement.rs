//! Where frames lie as wholes: turns and moves that strains do not say.
//!
//! *Best* turns a frame so that the mean rotation of its elements by area, unwound, is `t` times that of the target, and puts the centroid of its own
//! area on the straight way between those of both ends. *Anchors* puts a vertex on its straight way and turns the direction to another evenly,
//! by `R_AB + t R`. Both take the shorter way, and whole turns more on request. A mean of rotations is taken rather than the rotation of
//! a mean, which does not exist for a strip that closes to a ring.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004, "Interpolation of Rigid Body Motion"; errata S7, S8 and S12.

use super::body::{Body, area_and_centroid};
use super::tensor::{rotation, shorter, turn};
use anamorph_core::glam::DVec2;
use anamorph_core::math;
use std::f64::consts::TAU;

/// How a part moves as a whole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Motion {
    /// By the mean rotation, which goes to `angle`, and the centroid between these places.
    Best { angle: f64, centroids: [DVec2; 2] },
    /// By a vertex between two places and the direction to another, which goes from `from` by `angle`.
    Anchors {
        vertices: [usize; 2],
        places: [DVec2; 2],
        from: f64,
        angle: f64,
    },
}

impl Motion {
    pub(crate) fn best(body: &Body, source: &[DVec2], target: &[DVec2], turns: i32) -> Self {
        Self::Best {
            angle: shorter(body.mean_angle) + f64::from(turns) * TAU,
            centroids: [source, target].map(|list| area_and_centroid(&body.elements, list).1),
        }
    }

    /// Nothing if both anchors are in the same place at an end.
    pub(crate) fn anchors(
        vertices: [usize; 2],
        source: &[DVec2],
        target: &[DVec2],
        turns: i32,
    ) -> Option<Self> {
        let [a, b] = vertices;
        let directions = [source[b] - source[a], target[b] - target[a]];
        if directions.contains(&DVec2::ZERO) {
            return None;
        }
        let [from, to] = directions.map(|d| math::atan2(d.y, d.x));
        Some(Self::Anchors {
            vertices,
            places: [source[a], target[a]],
            from,
            angle: shorter(to - from) + f64::from(turns) * TAU,
        })
    }
}

/// The mean rotation of a frame by area, unwound along the way to the target's.
pub(crate) fn mean_rotation(body: &Body, positions: &[DVec2], t: f64) -> f64 {
    let points = &body.domains[0].points;
    let mut off = Vec::with_capacity(points.len());
    points.each_gradient(positions, |point, _, gradient| {
        off.push(rotation(gradient) - t * body.angles[point]);
    });
    // All are about one angle, which is only known up to the turns that they are to be brought to.
    let (mut sin, mut cos) = (0.0, 0.0);
    for (angle, weight) in off.iter().zip(points.weights()) {
        let (s, c) = math::sin_cos(*angle);
        sin += weight * s;
        cos += weight * c;
    }
    let about = math::atan2(sin, cos);
    let (mut sum, mut total) = (0.0, 0.0);
    for (angle, weight) in off.iter().zip(points.weights()) {
        sum += weight * shorter(angle - about);
        total += weight;
    }
    about + sum / total + t * body.mean_angle
}

/// Puts a frame, in the units of the part, where it belongs at `t`, in those of the pair.
pub(crate) fn place(body: &Body, motion: &Motion, t: f64, positions: &mut [DVec2]) {
    match motion {
        Motion::Best { angle, centroids } => {
            let turned = turn(t * angle - mean_rotation(body, positions, t)) * body.scale;
            let (_, centroid) = area_and_centroid(&body.elements, positions);
            let to = centroids[0].lerp(centroids[1], t);
            for place in positions {
                *place = to + turned * (*place - centroid);
            }
        }
        Motion::Anchors {
            vertices: [a, b],
            places,
            from,
            angle,
        } => {
            let direction = positions[*b] - positions[*a];
            let found = math::atan2(direction.y, direction.x);
            let turned = turn(from + t * angle - found) * body.scale;
            let (anchor, to) = (positions[*a], places[0].lerp(places[1], t));
            for place in positions {
                *place = to + turned * (*place - anchor);
            }
        }
    }
}
