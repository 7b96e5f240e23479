//! Points and regions: whether a point is inside, how far from the border, and its mean value coordinates.
//!
//! *Source*: K. Hormann and N. Agathos, *The Point in Polygon Problem for Arbitrary Polygons*, Computational Geometry 20(3), 2001
//! (crossings of a ray); K. Hormann and M. Floater, *Mean Value Coordinates for Arbitrary Planar Polygons*, ACM Transactions on
//! Graphics 25(4), 2006.

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_meshing::planar::Region;

/// Whether a point is inside a ring, by even and odd.
fn inside_ring(ring: &[DVec2], point: DVec2) -> bool {
    let mut inside = false;
    for (i, &b) in ring.iter().enumerate() {
        let a = ring[(i + ring.len() - 1) % ring.len()];
        if (a.y > point.y) != (b.y > point.y) {
            let side = (b - a).perp_dot(point - a);
            if (side > 0.0) == (b.y > a.y) {
                inside = !inside;
            }
        }
    }
    inside
}

/// Whether a point is inside a region: in its outline and in none of its holes.
pub fn contains(region: &Region, point: DVec2) -> bool {
    inside_ring(&region.outer, point) && !region.holes.iter().any(|hole| inside_ring(hole, point))
}

/// How far a point is from the nearest border of a region; negative outside.
pub fn clearance(region: &Region, point: DVec2) -> f64 {
    let rings = core::iter::once(&region.outer).chain(&region.holes);
    let least = rings
        .map(|ring| distance(ring, point))
        .fold(f64::INFINITY, f64::min);
    if contains(region, point) {
        least
    } else {
        -least
    }
}

/// How far a point is from a ring.
fn distance(ring: &[DVec2], point: DVec2) -> f64 {
    let mut least = f64::INFINITY;
    for (i, &a) in ring.iter().enumerate() {
        let along = ring[(i + 1) % ring.len()] - a;
        let t = (point - a).dot(along) / along.length_squared();
        let t = if t > 0.0 { t.min(1.0) } else { 0.0 };
        least = least.min((a + along * t).distance_squared(point));
    }
    least.sqrt()
}

/// The mean value coordinates of a point in a closed ring: weights of its points that add up to 1 and whose mean is the point.
/// On the ring they are those of linear interpolation. None where the ring has fewer than three points, or they cannot be told.
pub fn mean_value_weights(ring: &[DVec2], point: DVec2) -> Option<Vec<f64>> {
    let count = ring.len();
    if count < 3 {
        return None;
    }
    let spokes: Vec<DVec2> = ring.iter().map(|p| *p - point).collect();
    let lengths: Vec<f64> = spokes.iter().map(|s| s.length()).collect();
    let mut weights = vec![0.0; count];
    if let Some(at) = lengths.iter().position(|&r| r == 0.0) {
        weights[at] = 1.0;
        return Some(weights);
    }
    for i in 0..count {
        let j = (i + 1) % count;
        let (cross, dot) = (spokes[i].perp_dot(spokes[j]), spokes[i].dot(spokes[j]));
        let (r, s) = (lengths[i], lengths[j]);
        if cross == 0.0 && dot < 0.0 {
            // On this edge.
            weights.fill(0.0);
            weights[i] = s / (r + s);
            weights[j] = r / (r + s);
            return Some(weights);
        }
        // The tangent of half the angle, by the form that does not cancel.
        let tangent = if dot > 0.0 {
            cross / (r * s + dot)
        } else {
            (r * s - dot) / cross
        };
        weights[i] += tangent / r;
        weights[j] += tangent / s;
    }
    let sum: f64 = weights.iter().sum();
    for weight in &mut weights {
        *weight /= sum;
    }
    weights.iter().all(|w| w.is_finite()).then_some(weights)
}

/// The place inside a region, with room about it, that is nearest to a wish: the wish itself where there is enough.
pub(super) fn nearest_inside(region: &Region, wish: DVec2) -> DVec2 {
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for point in &region.outer {
        low = low.min(*point);
        high = high.max(*point);
    }
    let size = high - low;
    let enough = 0.01 * size.max_element();
    if clearance(region, wish) >= enough {
        return wish;
    }
    // On a grid, finer where a coarse one misses the inside: the most room, less the way there.
    let mut best = (f64::NEG_INFINITY, wish);
    for steps in [24, 96, 384_u32] {
        for row in 0..steps {
            for column in 0..steps {
                let share = dvec2(f64::from(column) + 0.5, f64::from(row) + 0.5) / f64::from(steps);
                let place = low + size * share;
                let way = place.distance(wish);
                if enough - way <= best.0 {
                    continue;
                }
                let room = clearance(region, place);
                let worth = room.min(enough) - way;
                if room > 0.0 && worth > best.0 {
                    best = (worth, place);
                }
            }
        }
        if best.0 > f64::NEG_INFINITY {
            break;
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_value_weights_reproduce_the_point() {
        let ring =
            [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 1.0), (0.0, 4.0)].map(|(x, y)| dvec2(x, y));
        for point in [
            dvec2(1.0, 0.5),
            dvec2(3.9, 3.0),
            dvec2(2.0, 3.0),
            dvec2(9.0, -2.0),
            dvec2(2.0, 0.0),
            dvec2(4.0, 4.0),
        ] {
            let weights = mean_value_weights(&ring, point).unwrap();
            let mean: DVec2 = ring.iter().zip(&weights).map(|(p, w)| *p * *w).sum();
            assert!(mean.distance(point) < 1e-12, "{point} {mean}");
        }
        let region = Region {
            outer: ring.to_vec(),
            holes: Vec::new(),
        };
        for wish in [dvec2(2.0, 3.0), dvec2(-9.0, 9.0), dvec2(2.0, 0.5)] {
            assert!(clearance(&region, nearest_inside(&region, wish)) > 0.0);
        }
        assert_eq!(nearest_inside(&region, dvec2(2.0, 0.5)), dvec2(2.0, 0.5));
    }
}
