//! Where the edges of rings cross or touch, by exact predicates.
//!
//! Edges are taken from left to right; each is compared with those that still reach it. For the outlines of drawings that
//! is little more than sorting.
//!
//! *Source*: M. Shamos and D. Hoey, *Geometric Intersection Problems*, FOCS 1976 (sweeping); J. Shewchuk, *Adaptive Precision
//! Floating-Point Arithmetic and Fast Robust Geometric Predicates*, 1997 (orientation), as the crate `robust` has it.

use anamorph_core::glam::DVec2;
use robust::{Coord, orient2d};

/// Two edges that have more in common than the ends of neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crossing {
    /// Number of a ring, and of the point that the edge leaves.
    pub first: (usize, usize),
    /// The other edge.
    pub second: (usize, usize),
}

/// Twice the signed area of a triangle; its sign is exact.
fn orientation(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// Whether a point on the line of a segment is on the segment.
fn within(a: DVec2, b: DVec2, p: DVec2) -> bool {
    p.cmpge(a.min(b)).all() && p.cmple(a.max(b)).all()
}

/// Whether two segments have a point in common.
fn meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let (p, q) = (orientation(a, b, c), orientation(a, b, d));
    let (r, s) = (orientation(c, d, a), orientation(c, d, b));
    let apart = |x: f64, y: f64| (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0);
    if apart(p, q) && apart(r, s) {
        return true;
    }
    (p == 0.0 && within(a, b, c))
        || (q == 0.0 && within(a, b, d))
        || (r == 0.0 && within(c, d, a))
        || (s == 0.0 && within(c, d, b))
}

/// Pairs of edges of closed rings that cross, touch or lie on each other, at most so many; none where every ring is
/// simple and no two have a point in common.
///
/// Coordinates must be finite; the order of the pairs depends on the rings alone.
pub fn crossings(rings: &[&[DVec2]], most: usize) -> Vec<Crossing> {
    struct Edge {
        ring: usize,
        index: usize,
        ends: [DVec2; 2],
        low: DVec2,
        high: DVec2,
    }
    let mut edges = Vec::new();
    for (ring, points) in rings.iter().enumerate() {
        for (index, &from) in points.iter().enumerate() {
            let to = points[(index + 1) % points.len()];
            edges.push(Edge {
                ring,
                index,
                ends: [from, to],
                low: from.min(to),
                high: from.max(to),
            });
        }
    }
    edges.sort_by(|a, b| {
        let order = a.low.x.total_cmp(&b.low.x);
        order.then((a.ring, a.index).cmp(&(b.ring, b.index)))
    });
    let mut found = Vec::new();
    let mut active: Vec<usize> = Vec::new();
    for (number, edge) in edges.iter().enumerate() {
        active.retain(|&other| edges[other].high.x >= edge.low.x);
        for &other in &active {
            let other = &edges[other];
            if other.high.y < edge.low.y || other.low.y > edge.high.y {
                continue;
            }
            let count = rings[edge.ring].len();
            let follows = |a: &Edge, b: &Edge| a.ring == b.ring && (a.index + 1) % count == b.index;
            let crossed = if follows(other, edge) {
                folded(other.ends[0], edge.ends[0], edge.ends[1])
            } else if follows(edge, other) {
                folded(edge.ends[0], other.ends[0], other.ends[1])
            } else {
                meet(edge.ends, other.ends)
            };
            if crossed {
                let (a, b) = ((other.ring, other.index), (edge.ring, edge.index));
                found.push(Crossing {
                    first: a.min(b),
                    second: a.max(b),
                });
                if found.len() >= most {
                    return found;
                }
            }
        }
        active.push(number);
    }
    found
}

/// Whether neighbouring edges lie on each other.
fn folded(from: DVec2, at: DVec2, to: DVec2) -> bool {
    orientation(from, at, to) == 0.0 && (from - at).dot(to - at) >= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::dvec2;

    #[test]
    fn crossings_touches_and_folds_are_found() {
        let square = [(0, 0), (4, 0), (4, 4), (0, 4)].map(|(x, y)| dvec2(x.into(), y.into()));
        assert!(crossings(&[&square], 9).is_empty());
        let eight = [(0, 0), (4, 4), (4, 0), (0, 4)].map(|(x, y)| dvec2(x.into(), y.into()));
        let found = crossings(&[&eight], 9);
        assert_eq!(
            found,
            [Crossing {
                first: (0, 0),
                second: (0, 2)
            }]
        );
        // A hole that touches in a point, by a rounding error's width or not.
        for (x, touches) in [(4.0, true), (4.0_f64.next_down(), false)] {
            let hole = [dvec2(1.0, 1.0), dvec2(1.0, 3.0), dvec2(x, 2.0)];
            assert_eq!(!crossings(&[&square, &hole], 9).is_empty(), touches);
        }
        let spike = [(0, 0), (4, 0), (2, 0), (2, 3)].map(|(x, y)| dvec2(x.into(), y.into()));
        assert!(!crossings(&[&spike], 9).is_empty());
    }
}
