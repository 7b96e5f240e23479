//! Directions of curves, defined where the derivative vanishes, and lengths between their parameters.
//!
//! Where a curve rests or has a cusp its direction is the limit from the larger parameter, at its end from the smaller one; a curve
//! that is a point has none. The limit is read off the first derivative that does not vanish, and where three vanish, off
//! points further along.
//!
//! *Source*: Milliron et al. 2002, §4.4 (tangents of wires), errata F8 (zero tangents); the thresholds are a decision.

use anamorph_core::sampling::{Node, Sampling, adaptive};
use anamorph_core::{Bounds, Differentiable, Space};
use std::sync::Arc;

/// A derivative shorter than this share of the curve's mean speed counts as vanishing: the direction of the nearest parameter, which
/// is known to about this share of the domain, says nothing below it.
const RESTING: f64 = 1e-9;
/// Samples a smooth piece, from which sizes and bounds are taken.
const SAMPLES: u32 = 32;
/// Smooth pieces that are sampled at most; longer lists are sampled at their breaks, which is enough for sizes.
const MOST_PIECES: usize = 1 << 16;
/// Accuracy of lengths, as a share of the whole.
const LENGTHS: f64 = 1e-12;

/// A curve with what its directions need to be defined everywhere.
pub(super) struct Tangents<S: Space> {
    pub(super) curve: Arc<dyn Differentiable<S>>,
    /// First and last parameter.
    pub(super) domain: (f64, f64),
    /// A velocity below this is none.
    resting: f64,
    /// The length of the polygon through the samples.
    pub(super) polygon: f64,
    /// The samples: parameters and points, ends of pieces included.
    pub(super) samples: Vec<(f64, S)>,
}

impl<S: Space> Tangents<S> {
    /// Samples the curve; `None` if a point is not finite or the domain is none.
    pub(super) fn new(curve: Arc<dyn Differentiable<S>>) -> Option<Self> {
        let domain = curve.domain();
        let width = domain.1 - domain.0;
        if !(width > 0.0 && width.is_finite()) {
            return None;
        }
        let breaks = pieces(curve.as_ref());
        let steps = if breaks.len() > MOST_PIECES / SAMPLES as usize {
            1
        } else {
            SAMPLES
        };
        let mut samples = vec![(domain.0, curve.point(domain.0))];
        for piece in breaks.windows(2) {
            for i in 1..=steps {
                let at = if i == steps {
                    piece[1]
                } else {
                    piece[0] + (piece[1] - piece[0]) * (f64::from(i) / f64::from(steps))
                };
                samples.push((at, curve.point(at)));
            }
        }
        if samples.iter().any(|(_, point)| !point.is_finite()) {
            return None;
        }
        let polygon: f64 = samples.windows(2).map(|p| p[0].1.distance(p[1].1)).sum();
        polygon.is_finite().then_some(Self {
            curve,
            domain,
            resting: RESTING * polygon / width,
            polygon,
            samples,
        })
    }

    /// The share of the domain that lies before a parameter.
    pub(super) fn share(&self, at: f64) -> f64 {
        ((at - self.domain.0) / (self.domain.1 - self.domain.0)).clamp(0.0, 1.0)
    }

    /// The parameter at a share of the domain; exact at both ends.
    pub(super) fn parameter(&self, share: f64) -> f64 {
        self.domain.0 * (1.0 - share) + self.domain.1 * share
    }

    /// The unit direction at a parameter and the point there, by errata F8; `None` for a curve that is a point.
    pub(super) fn point_and_direction(&self, at: f64) -> (S, Option<S>) {
        let jet = self.curve.jet(at);
        let speed = jet.first.length();
        if speed > self.resting {
            return (jet.point, Some(jet.first / speed));
        }
        (jet.point, self.limit(at, jet.second, jet.third))
    }

    /// The limit of the direction where the velocity vanishes.
    fn limit(&self, at: f64, second: S, third: S) -> Option<S> {
        let (start, end) = self.domain;
        let width = end - start;
        let last = at >= end && !self.curve.is_closed();
        // Behind: P′ ≈ h P″ + h²/2 P‴ for h > 0; at the end from before: P′ ≈ −h P″ + h²/2 P‴.
        let side = if last { -1.0 } else { 1.0 };
        if second.length() * width > self.resting {
            return second.normalized().map(|d| d * side);
        }
        if third.length() * width * width > self.resting {
            return third.normalized();
        }
        // A rest, or a rest of high order: the first point further along that differs.
        let here = self.curve.point(at);
        let seek = |side: f64| {
            let room = if side > 0.0 { end - at } else { at - start };
            (0..40).find_map(|k| {
                let step = room * anamorph_core::math::powi(0.5, 39 - k);
                let offset = (self.curve.point(at + side * step) - here) * side;
                (offset.length() > RESTING * self.polygon).then(|| offset.normalized())?
            })
        };
        if self.polygon == 0.0 {
            return None;
        }
        if last {
            seek(-1.0)
        } else {
            seek(1.0).or_else(|| seek(-1.0))
        }
    }

    /// A box around the curve: the samples' with the length of the longest step between two of them on all sides.
    pub(super) fn bounds(&self) -> Bounds<S> {
        let points: Vec<S> = self.samples.iter().map(|(_, point)| *point).collect();
        let first = points.first().copied().unwrap_or(S::ZERO);
        let mut bounds = Bounds::of(&points).unwrap_or(Bounds::new(first, first));
        let mut longest = 0.0_f64;
        for pair in self.samples.windows(2) {
            longest = longest.max(self.step_length(pair[0].0, pair[1].0));
        }
        // Half a step is as far as a curve gets from the nearer of its two samples; a tenth more for the quadrature.
        let margin = S::splat(0.55 * longest);
        bounds.min -= margin;
        bounds.max += margin;
        bounds
    }

    /// The length between two near parameters within a piece, by the five-point rule.
    pub(super) fn step_length(&self, from: f64, to: f64) -> f64 {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        // Gauss–Legendre's five nodes and weights.
        const RULE: [(f64, f64); 5] = [
            (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
            (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
            (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        ];
        let speeds = RULE.map(|(x, w)| w * self.curve.velocity(middle + half * x).length());
        half * speeds.iter().sum::<f64>()
    }

    /// The nodes of a sampling over the curve's arc length: parameters, and shares in scene units of length. `None` where the
    /// nodes depend on the point. Because the measure is arc length, a curve with another parameter has the same nodes.
    pub(super) fn nodes(&self, sampling: Sampling) -> Option<Vec<Node>> {
        let breaks = pieces(self.curve.as_ref());
        let mut lengths = vec![0.0];
        let mut total = 0.0;
        for piece in breaks.windows(2) {
            total += self.length(piece[0], piece[1]);
            lengths.push(total);
        }
        let mut nodes = sampling.nodes(&lengths)?;
        // Nodes ascend, and so do the parameters found: each search starts where the last ended.
        let (mut piece, mut known) = (0, (breaks[0], 0.0));
        for node in &mut nodes {
            while piece + 1 < lengths.len() - 1 && node.at > lengths[piece + 1] {
                piece += 1;
                known = (breaks[piece], lengths[piece]);
            }
            known = self.at_length(
                node.at,
                known,
                (breaks[piece + 1], lengths[piece + 1]),
                total,
            );
            node.at = known.0;
        }
        Some(nodes)
    }

    fn length(&self, from: f64, to: f64) -> f64 {
        let mut nodes = Vec::new();
        let speed = &mut |v: f64| [self.curve.velocity(v).length()];
        adaptive(core::iter::once((from, to)), LENGTHS, speed, &mut nodes).values[0]
    }

    /// The parameter at a length between two parameters whose lengths are known, and the length there.
    fn at_length(
        &self,
        length: f64,
        mut low: (f64, f64),
        mut high: (f64, f64),
        total: f64,
    ) -> (f64, f64) {
        // As many halvings as a parameter has bits, and none needed where Newton's method serves.
        for _ in 0..64 {
            let (width, rise) = (high.0 - low.0, high.1 - low.1);
            let guess = low.0 + width * ((length - low.1) / rise);
            let mut at = if guess > low.0 && guess < high.0 {
                guess
            } else {
                0.5 * (low.0 + high.0)
            };
            let mut here = (at, low.1 + self.length(low.0, at));
            // One step of Newton's method from the chord's guess, if it stays inside.
            let newton = at + (length - here.1) / self.curve.velocity(at).length();
            if newton > low.0 && newton < high.0 {
                at = newton;
                here = (at, low.1 + self.length(low.0, at));
            }
            if (here.1 - length).abs() <= 1e-11 * total || at <= low.0 || at >= high.0 {
                return here;
            }
            if here.1 < length {
                low = here;
            } else {
                high = here;
            }
            // Keeps the bracket shrinking where the chord's guess sticks to one side.
            let middle = 0.5 * (low.0 + high.0);
            let there = (middle, low.1 + self.length(low.0, middle));
            if there.1 < length {
                low = there;
            } else {
                high = there;
            }
        }
        low
    }
}

/// The breaks of a curve, its ends at least.
fn pieces<S: Space>(curve: &dyn Differentiable<S>) -> Vec<f64> {
    let (start, end) = curve.domain();
    let mut breaks = curve.breaks();
    breaks.retain(|b| *b > start && *b < end);
    breaks.insert(0, start);
    breaks.push(end);
    breaks
}
