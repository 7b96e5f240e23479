//! Where a boundary crosses itself.
//!
//! Edges are swept from left to right, and those whose boxes meet are tried: they cross if each has its ends strictly on both sides of the
//! other. The sign of `(a − c) × (b − c)` is taken from rounded numbers where these are sure of it, and else from exact ones. Edges that only touch, as
//! those of a slit do, do not cross.
//!
//! *Source*: J. R. Shewchuk, *Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates*, 1997; M. I. Shamos, D. Hoey,
//! *Geometric Intersection Problems*, 1976, for the sweep.

use super::tensor::cross;
use anamorph_core::glam::DVec2;

/// A sum and what rounding took from it.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// A product and what rounding took from it.
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let split = |x: f64| {
        let c = 134_217_729.0 * x;
        let high = c - (c - x);
        (high, x - high)
    };
    let product = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    let rest = al * bl - (((product - ah * bh) - al * bh) - ah * bl);
    (product, rest)
}

/// The sign of `(a − c) × (b − c)`, exact while nothing over- or underflows.
fn orientation(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let (left, right) = ((a.x - c.x) * (b.y - c.y), (a.y - c.y) * (b.x - c.x));
    let rounded = left - right;
    if rounded.abs() > 4e-16 * (left.abs() + right.abs()) {
        return rounded.signum();
    }
    let difference = |p: f64, q: f64| {
        let (high, low) = two_sum(p, -q);
        [high, low]
    };
    let factors = [
        (difference(a.x, c.x), difference(b.y, c.y), 1.0),
        (difference(a.y, c.y), difference(b.x, c.x), -1.0),
    ];
    // A sum of sixteen products whose parts do not overlap, the largest last.
    let mut parts: Vec<f64> = Vec::with_capacity(32);
    for (first, second, sign) in factors {
        for p in first {
            for q in second {
                let (high, low) = two_product(p, q);
                for mut more in [sign * low, sign * high] {
                    for part in &mut parts {
                        let (sum, rest) = two_sum(*part, more);
                        *part = rest;
                        more = sum;
                    }
                    parts.push(more);
                }
            }
        }
    }
    let last = parts.iter().rev().find(|&&part| part != 0.0);
    last.map_or(0.0, |part| part.signum())
}

/// Pairs of edges, by their numbers, that cross. Edges name two of the positions; those that share a vertex do not cross.
pub fn crossings(edges: &[(usize, usize)], positions: &[DVec2]) -> Vec<(usize, usize)> {
    struct Swept {
        number: usize,
        ends: [DVec2; 2],
        vertices: [usize; 2],
        low: DVec2,
        high: DVec2,
    }
    let mut swept: Vec<Swept> = Vec::with_capacity(edges.len());
    for (number, &(a, b)) in edges.iter().enumerate() {
        if let (Some(&p), Some(&q)) = (positions.get(a), positions.get(b)) {
            swept.push(Swept {
                number,
                ends: [p, q],
                vertices: [a, b],
                low: p.min(q),
                high: p.max(q),
            });
        }
    }
    swept.sort_by(|a, b| a.low.x.total_cmp(&b.low.x).then(a.number.cmp(&b.number)));
    let mut found = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    for (at, edge) in swept.iter().enumerate() {
        open.retain(|&other| swept[other].high.x >= edge.low.x);
        for &other in &open {
            let other = &swept[other];
            let apart = other.high.y < edge.low.y || other.low.y > edge.high.y;
            let [a, b] = edge.vertices;
            if apart || other.vertices.contains(&a) || other.vertices.contains(&b) {
                continue;
            }
            let ([p, q], [r, s]) = (edge.ends, other.ends);
            let between = |p, q, r, s| orientation(p, q, r) * orientation(p, q, s) < 0.0;
            if between(p, q, r, s) && between(r, s, p, q) {
                let (a, b) = (edge.number, other.number);
                found.push((a.min(b), a.max(b)));
            }
        }
        open.push(at);
    }
    found.sort_unstable();
    found
}

/// The smallest angle of a polygon's corners; 0 where an edge has no length.
pub(crate) fn smallest_angle(corners: &[DVec2]) -> f64 {
    let count = corners.len();
    let mut smallest = f64::INFINITY;
    for k in 0..count {
        let (a, b) = (
            corners[(k + 1) % count] - corners[k],
            corners[(k + count - 1) % count] - corners[k],
        );
        let angle = if a == DVec2::ZERO || b == DVec2::ZERO {
            0.0
        } else {
            anamorph_core::math::atan2(cross(a, b).abs(), a.dot(b))
        };
        smallest = smallest.min(angle);
    }
    smallest
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::dvec2;

    #[test]
    fn signs_are_exact_where_rounding_is_not_sure() {
        // On the line y = x, but for the last bit.
        let (a, b) = (dvec2(12.0, 12.0), dvec2(24.0, 24.0));
        for k in -4..=4 {
            let off = f64::from(k) * f64::EPSILON / 2.0;
            let c = dvec2(0.5 + off, 0.5);
            let expected = if k == 0 { 0.0 } else { -f64::from(k).signum() };
            assert_eq!(orientation(a, b, c), -expected * -1.0, "{k}");
        }
    }

    #[test]
    fn crossings_are_found_and_touching_is_none() {
        let positions = [
            dvec2(0.0, 0.0),
            dvec2(2.0, 2.0),
            dvec2(2.0, 0.0),
            dvec2(0.0, 2.0),
            dvec2(1.0, 1.0),
            dvec2(5.0, 1.0),
            dvec2(1.5, 1.5),
        ];
        let eight = [(0, 1), (1, 2), (2, 3), (3, 0)];
        assert_eq!(crossings(&eight, &positions), [(0, 2)]);
        // From the middle of the first edge, and along it.
        assert!(crossings(&[(0, 1), (4, 5)], &positions).is_empty());
        assert!(crossings(&[(0, 1), (4, 6)], &positions).is_empty());
    }

    #[test]
    fn a_sweep_finds_what_trying_all_pairs_does() {
        let mut state = 88_172_645_463_325_252_u64;
        let mut unit = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let positions: Vec<DVec2> = (0..80).map(|_| dvec2(unit(), unit())).collect();
        let edges: Vec<(usize, usize)> = (0..80).map(|k| (k, (k + 1) % 80)).collect();
        let mut all = Vec::new();
        for i in 0..80 {
            for j in 0..i {
                if crossings(&[edges[j], edges[i]], &positions).len() == 1 {
                    all.push((j, i));
                }
            }
        }
        all.sort_unstable();
        assert!(all.len() > 100);
        assert_eq!(crossings(&edges, &positions), all);
    }
}
