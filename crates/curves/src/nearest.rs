//! Nearest points of a curve: all local minima of the distance, and the least.
//!
//! *Source*: Milliron et al., 2002, §4.4 (features need nearest points; errata F10: exact, ties to the smallest parameter);
//! P. Schneider, *Solving the nearest-point-on-curve problem*, Graphics Gems I, 1990. For a polynomial piece of degree `n`
//! the derivative of the squared distance, `(P − q)·P′`, is a polynomial of degree `2n − 1`; its roots in Bernstein form are found
//! all, by variation diminution, so that nothing is sampled and nothing guessed.

use crate::bezier::{Bezier, Pieces};
use crate::families::Lagrange;
use crate::polynomial::{crossings, product};
use crate::{PiecewiseBezier, PiecewiseCubic};
use anamorph_core::{Curve, Nearest, NearestPoint, Space};

/// Distances that differ by less than this share of the curve's size are equal (errata F10).
const TIE: f64 = 1e-12;

/// Parameters that differ by less than this share of the domain may belong to one minimum.
const BESIDE: f64 = 1e-3;

/// The derivative of the squared distance to `to` along a piece, in Bernstein form, in units in which its products neither overflow nor vanish.
fn slope<S: Space>(piece: &Bezier<S>, to: S, unit: f64) -> Vec<f64> {
    let velocity = piece.differences();
    let mut sum = vec![0.0; 2 * piece.degree()];
    for axis in 0..S::DIM {
        let offset: Vec<f64> = piece
            .points()
            .iter()
            .map(|p| (*p - to).component(axis) / unit)
            .collect();
        let along: Vec<f64> = velocity.iter().map(|v| v.component(axis) / unit).collect();
        for (s, p) in sum.iter_mut().zip(product(&offset, &along)) {
            *s += p;
        }
    }
    sum
}

/// A run of pieces and the box around their control points.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node<S> {
    low: S,
    high: S,
    from: usize,
    to: usize,
    /// Its two halves, or nothing.
    halves: Option<(usize, usize)>,
}

impl<S: Space> Node<S> {
    /// The distance of a point to the box.
    fn distance(&self, to: S) -> f64 {
        let out = S::from_fn(|axis| {
            let p = to.component(axis);
            (self.low.component(axis) - p)
                .max(p - self.high.component(axis))
                .max(0.0)
        });
        out.length()
    }
}

/// Pieces of a short list are cut into as many parts, whose boxes are smaller.
const PARTS: [(usize, u32); 2] = [(16, 3), (256, 2)];

/// The pieces of a curve, those of a short one halved a few times: most points are then told by boxes alone that they are far.
fn halved<S: Space>(mut pieces: Vec<(f64, f64, Bezier<S>)>) -> Vec<(f64, f64, Bezier<S>)> {
    let times = PARTS.iter().find(|(most, _)| pieces.len() <= *most);
    for _ in 0..times.map_or(0, |(_, times)| *times) {
        let halves = pieces.iter().flat_map(|(a, b, piece)| {
            let middle = a + 0.5 * (b - a);
            let (first, second) = piece.split(0.5);
            [(*a, middle, first), (middle, *b, second)]
        });
        pieces = halves.collect();
    }
    pieces
}

/// A curve prepared for many nearest-point questions: its pieces in a tree of boxes.
#[derive(Clone, Debug, PartialEq)]
pub struct NearestTable<S> {
    pieces: Vec<(f64, f64, Bezier<S>)>,
    nodes: Vec<Node<S>>,
    root: usize,
    size: f64,
    closed: bool,
}

impl<S: Space> NearestTable<S> {
    /// Prepares a curve.
    #[must_use]
    pub fn new<C: Pieces<S> + ?Sized>(curve: &C) -> Self {
        let pieces = halved(curve.bezier_pieces());
        let mut nodes: Vec<Node<S>> = Vec::with_capacity(2 * pieces.len());
        let mut level: Vec<usize> = Vec::with_capacity(pieces.len());
        for (i, (_, _, piece)) in pieces.iter().enumerate() {
            let first = piece.points()[0];
            let (low, high) = piece
                .points()
                .iter()
                .fold((first, first), |(low, high), p| (low.min(*p), high.max(*p)));
            level.push(nodes.len());
            nodes.push(Node {
                low,
                high,
                from: i,
                to: i + 1,
                halves: None,
            });
        }
        while level.len() > 1 {
            let mut next = Vec::with_capacity(level.len().div_ceil(2));
            for pair in level.chunks(2) {
                if let [a, b] = *pair {
                    let (left, right) = (nodes[a], nodes[b]);
                    next.push(nodes.len());
                    nodes.push(Node {
                        low: left.low.min(right.low),
                        high: left.high.max(right.high),
                        from: left.from,
                        to: right.to,
                        halves: Some((a, b)),
                    });
                } else {
                    next.extend_from_slice(pair);
                }
            }
            level = next;
        }
        let root = level.first().copied().unwrap_or(0);
        let size = nodes.get(root).map_or(0.0, |n| n.high.distance(n.low));
        Self {
            pieces,
            nodes,
            root,
            size,
            closed: curve.is_closed(),
        }
    }

    fn found(&self, piece: usize, t: f64, to: S) -> Nearest<S> {
        let (a, b, bezier) = &self.pieces[piece];
        let point = bezier.point(t);
        Nearest {
            parameter: if t >= 1.0 { *b } else { a + (b - a) * t },
            point,
            distance: point.distance(to),
        }
    }

    /// A length in which all offsets and velocities are moderate numbers.
    fn unit(&self, to: S) -> f64 {
        let unit = self.size.max(self.nodes[self.root].distance(to));
        if unit > 0.0 && unit.is_finite() {
            unit
        } else {
            1.0
        }
    }

    /// The place nearest to a point; of places equally near, to 1e-12 of the curve's size, that of the least parameter.
    #[must_use]
    pub fn nearest(&self, to: S) -> Nearest<S> {
        if !to.is_finite() {
            return self.found(0, 0.0, to);
        }
        self.search(to, f64::INFINITY)
    }

    /// The same if it is no farther than `reach`; far from the curve's box that costs one comparison.
    #[must_use]
    pub fn nearest_within(&self, to: S, reach: f64) -> Option<Nearest<S>> {
        if !to.is_finite() || self.nodes[self.root].distance(to) > reach {
            return None;
        }
        let nearest = self.search(to, reach);
        (nearest.distance <= reach).then_some(nearest)
    }

    /// The nearest place, if it is no farther than `reach`; else any.
    fn search(&self, to: S, reach: f64) -> Nearest<S> {
        // The best so far, and whether the distance is stationary there: ends of pieces need not be.
        let mut best = (self.found(0, 0.0, to), false);
        let tie = TIE * self.size;
        let domain = match (self.pieces.first(), self.pieces.last()) {
            (Some(first), Some(last)) => last.1 - first.0,
            _ => 0.0,
        };
        let consider = |candidate: Nearest<S>, rests: bool, best: &mut (Nearest<S>, bool)| {
            let (known, known_rests) = *best;
            let nearer = candidate.distance < known.distance - tie;
            let as_near = candidate.distance <= known.distance + tie;
            // Distances grow with the square of the way from a minimum: what is as near because it is beside it is no place of its own.
            let gap = candidate.point.distance(known.point);
            let beside = gap * gap <= 16.0 * tie * (known.distance + tie)
                && (candidate.parameter - known.parameter).abs() <= BESIDE * domain;
            let better = if nearer || !as_near {
                nearer
            } else if beside && rests != known_rests {
                rests
            } else if beside && candidate.distance != known.distance {
                candidate.distance < known.distance
            } else {
                candidate.parameter < known.parameter
            };
            if better {
                *best = (candidate, rests);
            }
        };
        let mut stack = vec![self.root];
        while let Some(index) = stack.pop() {
            let node = self.nodes[index];
            if node.distance(to) > best.0.distance.min(reach) + tie {
                continue;
            }
            if let Some((a, b)) = node.halves {
                // The nearer half first: it makes the other more likely to be left out.
                let (near, far) = if self.nodes[a].distance(to) <= self.nodes[b].distance(to) {
                    (a, b)
                } else {
                    (b, a)
                };
                stack.push(far);
                stack.push(near);
                continue;
            }
            consider(self.found(node.from, 0.0, to), false, &mut best);
            consider(self.found(node.from, 1.0, to), false, &mut best);
            for crossing in crossings(&slope(&self.pieces[node.from].2, to, self.unit(to))) {
                if crossing.rising {
                    consider(self.found(node.from, crossing.at, to), true, &mut best);
                }
            }
        }
        best.0
    }

    /// All places at which the distance to a point has a local minimum, in the order of their parameters. Ends of an open curve and corners
    /// count where the curve leads away from the point; of a stretch that stays equally far, its first place.
    #[must_use]
    pub fn local_minima(&self, to: S) -> Vec<Nearest<S>> {
        let mut minima = Vec::new();
        if !to.is_finite() {
            return minima;
        }
        let unit = self.unit(to);
        let slopes: Vec<Vec<f64>> = self
            .pieces
            .iter()
            .map(|(_, _, p)| slope(p, to, unit))
            .collect();
        let sign = |c: &f64| (*c != 0.0).then_some(*c > 0.0);
        // Whether the distance grew at the end of what lies before, and where that was.
        let seam = slopes
            .iter()
            .rev()
            .find_map(|s| s.iter().rev().find_map(sign));
        let mut growing = if self.closed { seam } else { None };
        let mut since: (usize, f64) = (0, 0.0);
        for (i, slope) in slopes.iter().enumerate() {
            let Some(starts) = slope.iter().find_map(sign) else {
                continue;
            };
            if starts && growing != Some(true) {
                minima.push(self.found(since.0, since.1, to));
            }
            let inside = crossings(slope);
            let rising = inside.iter().filter(|c| c.rising);
            minima.extend(rising.map(|c| self.found(i, c.at, to)));
            growing = slope.iter().rev().find_map(sign);
            since = (i, 1.0);
        }
        match growing {
            // The whole curve is equally far.
            None => minima.push(self.found(0, 0.0, to)),
            Some(false) if !self.closed => minima.push(self.found(since.0, since.1, to)),
            Some(_) => {}
        }
        minima.sort_by(|a, b| a.parameter.total_cmp(&b.parameter));
        minima
    }
}

macro_rules! nearest {
    ($curve:ty) => {
        impl<S: Space> NearestPoint<S> for $curve {
            /// Prepares a [`NearestTable`] and asks it; for many questions keep the table.
            fn nearest(&self, to: S) -> Nearest<S> {
                NearestTable::new(self).nearest(to)
            }
        }
    };
}
nearest!(PiecewiseCubic<S>);
nearest!(PiecewiseBezier<S>);
nearest!(Bezier<S>);
nearest!(Lagrange<S>);

#[cfg(test)]
mod tests;
