//! The direction of motion everywhere along a curve, also where its velocity is null.
//!
//! *Source*: P. Bézier's rule for the tangent where derivatives vanish (G. Farin, *Curves and Surfaces for CAGD*, 5th ed.,
//! 2002, §5.6): the first derivative that does not vanish. Ahead of a stop, motion starts along it; behind, it ended along
//! it with the sign of its order: `P″` changes sides (a cusp), `P‴` does not. Errata C14: unit tangents.
//!
//! Every place has two directions, *behind* (from which one arrives) and *ahead* (in which one leaves). They differ at
//! corners and cusps. Spans without length have the direction in which one arrived there.

use crate::CurveError;
use anamorph_core::{Differentiable, Jet, Solid, Space};

/// A velocity below this share of what its span's derivatives amount to is rounding: a stop.
const STOP: f64 = 1e-12;
/// The same as a share of the coordinates, from differences of which some curves make their derivatives.
const ROUNDING: f64 = 1e-14;
/// At a stop, the share of all derivatives that the second must have to decide, and below which the third does. Between them
/// the stop may be a very flat one, and velocities nearby decide.
const BENT: f64 = 1e-3;
const STEADY: f64 = 1e-8;
/// The share of what a span's derivatives amount to at most that any must have to decide.
const CERTAIN: f64 = 1e-9;
/// A span that moves less than this share of the one that moves most, or of its coordinates, does not move.
const RESTING: f64 = 1e-14;
const PUT: f64 = 1e-13;
/// How far inside a span its derivatives are taken to carry them to its end, as a share of it. For cubics that is exact.
const INSIDE: f64 = 1e-6;

/// A place on a curve with its directions, unit vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) u: f64,
    pub(super) point: Solid,
    pub(super) behind: Solid,
    pub(super) ahead: Solid,
}

/// The directions of motion along a curve.
#[derive(Clone, Debug)]
pub(super) struct Directions {
    breaks: Vec<f64>,
    /// For each span, the direction at its start and at its end, from inside.
    ends: Vec<(Solid, Solid)>,
    moves: Vec<bool>,
    /// For each span, the most that its derivatives amount to.
    reaches: Vec<f64>,
    closed: bool,
    /// A length of the size of the curve.
    size: f64,
}

/// Sizes of the first three derivatives over a span of that width, and their sum.
fn sizes(jet: &Jet<Solid>, width: f64) -> (f64, f64, f64, f64) {
    let a = Space::length(jet.first) * width;
    let b = Space::length(jet.second) * width * width;
    let c = Space::length(jet.third) * width * width * width;
    (a, b, c, a + b + c)
}

/// Directions behind and ahead of a place with these derivatives, in a span whose derivatives amount to `reach`; `None` where
/// they do not tell.
fn of_jet(jet: &Jet<Solid>, width: f64, reach: f64) -> Option<(Solid, Solid)> {
    let (a, b, _, all) = sizes(jet, width);
    if a > STOP * all && a > ROUNDING * jet.point.largest() {
        let along = Space::normalized(jet.first)?;
        return Some((along, along));
    }
    if b > BENT * all && b > CERTAIN * reach {
        let along = Space::normalized(jet.second)?;
        return Some((-along, along));
    }
    if b <= STEADY * all && all > CERTAIN * reach {
        let along = Space::normalized(jet.third)?;
        return Some((along, along));
    }
    None
}

/// The jet at the end of the span from `start` to `end`, as seen from inside it.
pub(super) fn jet_at_end<C: Differentiable<Solid> + ?Sized>(
    curve: &C,
    start: f64,
    end: f64,
) -> Jet<Solid> {
    let inside = end - (end - start) * INSIDE;
    let near = curve.jet(inside);
    let h = end - inside;
    Jet {
        point: near.point + (near.first + (near.second + near.third * (h / 3.0)) * (h / 2.0)) * h,
        first: near.first + (near.second + near.third * (h / 2.0)) * h,
        second: near.second + near.third * h,
        third: near.third,
    }
}

impl Directions {
    pub(super) fn new<C: Differentiable<Solid> + ?Sized>(curve: &C) -> Result<Self, CurveError> {
        let breaks = curve.breaks();
        let spans = breaks.len().saturating_sub(1);
        let reach = |pair: &[f64]| {
            let width = pair[1] - pair[0];
            let shares = [0.0, 0.21, 0.43, 0.68, 0.89];
            let all = shares.map(|x| sizes(&curve.jet(pair[0] + width * x), width).3);
            all.into_iter().fold(0.0, f64::max)
        };
        let reaches: Vec<f64> = breaks.windows(2).map(reach).collect();
        let puts = breaks.iter().map(|b| PUT * curve.point(*b).largest());
        let size = reaches.iter().copied().fold(0.0, f64::max);
        if !(size > 0.0 && size.is_finite()) {
            return Err(CurveError::NoLength);
        }
        let mut found = Self {
            ends: vec![(Solid::ZERO, Solid::ZERO); spans],
            moves: reaches
                .iter()
                .zip(puts)
                .map(|(reach, put)| *reach > RESTING * size && *reach > put)
                .collect(),
            reaches,
            breaks,
            closed: curve.is_closed(),
            size,
        };
        for i in 0..spans {
            if found.moves[i] {
                match (found.start_of(curve, i), found.end_of(curve, i)) {
                    (Some(start), Some(end)) => found.ends[i] = (start, end),
                    _ => found.moves[i] = false,
                }
            }
        }
        let first = found.moves.iter().position(|m| *m);
        let last = found.moves.iter().rposition(|m| *m);
        let (Some(first), Some(last)) = (first, last) else {
            return Err(CurveError::NoLength);
        };
        let mut before = if found.closed {
            found.ends[last].1
        } else {
            found.ends[first].0
        };
        for (ends, moves) in found.ends.iter_mut().zip(&found.moves) {
            if *moves {
                before = ends.1;
            } else {
                *ends = (before, before);
            }
        }
        Ok(found)
    }

    fn start_of<C: Differentiable<Solid> + ?Sized>(&self, curve: &C, span: usize) -> Option<Solid> {
        let (a, b) = self.span(span);
        let jet = curve.jet(a);
        of_jet(&jet, b - a, self.reaches[span])
            .map(|(_, ahead)| ahead)
            .or_else(|| self.probe(curve, span, a).map(|(_, ahead)| ahead))
    }

    fn end_of<C: Differentiable<Solid> + ?Sized>(&self, curve: &C, span: usize) -> Option<Solid> {
        let (a, b) = self.span(span);
        let jet = jet_at_end(curve, a, b);
        of_jet(&jet, b - a, self.reaches[span])
            .map(|(behind, _)| behind)
            .or_else(|| self.probe(curve, span, b).map(|(behind, _)| behind))
    }

    /// Where derivatives do not tell: the velocities a little behind and ahead.
    fn probe<C: Differentiable<Solid> + ?Sized>(
        &self,
        curve: &C,
        span: usize,
        u: f64,
    ) -> Option<(Solid, Solid)> {
        let (a, b) = self.span(span);
        let look = |sign: f64| {
            (2..=20).rev().find_map(|k| {
                let at = u + sign * (b - a) * f64::from(1_u32 << k).recip();
                if at < a || at >= b {
                    return None;
                }
                let velocity = curve.velocity(at);
                let enough = Space::length(velocity) * (b - a) > CERTAIN * self.reaches[span];
                Space::normalized(velocity).filter(|_| enough)
            })
        };
        match (look(-1.0), look(1.0)) {
            (Some(behind), Some(ahead)) => Some((behind, ahead)),
            (Some(only), None) | (None, Some(only)) => Some((only, only)),
            (None, None) => None,
        }
    }

    /// A length of the size of the curve: at least that of its longest span, by the sum of its derivatives.
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    pub(super) fn spans(&self) -> usize {
        self.ends.len()
    }

    /// Start and end of a span.
    pub(super) fn span(&self, index: usize) -> (f64, f64) {
        (self.breaks[index], self.breaks[index + 1])
    }

    pub(super) fn span_moves(&self, index: usize) -> bool {
        self.moves[index]
    }

    /// The span of a parameter within the domain.
    pub(super) fn span_of(&self, u: f64) -> usize {
        let behind = self.breaks.partition_point(|b| *b <= u);
        behind.saturating_sub(1).min(self.spans() - 1)
    }

    /// The place of a parameter within the domain, both ends included.
    pub(super) fn place<C: Differentiable<Solid> + ?Sized>(&self, curve: &C, u: f64) -> Place {
        let (count, i) = (self.spans(), self.span_of(u));
        let (a, b) = self.span(i);
        let place = |point, (behind, ahead)| Place {
            u,
            point,
            behind,
            ahead,
        };
        if u >= b {
            let behind = self.ends[i].1;
            let ahead = if self.closed { self.ends[0].0 } else { behind };
            return place(curve.point(u), (behind, ahead));
        }
        if u <= a {
            let ahead = self.ends[i].0;
            let behind = match i {
                0 if self.closed => self.ends[count - 1].1,
                0 => ahead,
                _ => self.ends[i - 1].1,
            };
            return place(curve.point(u), (behind, ahead));
        }
        if !self.moves[i] {
            return place(curve.point(u), self.ends[i]);
        }
        let jet = curve.jet(u);
        let directions = of_jet(&jet, b - a, self.reaches[i])
            .or_else(|| self.probe(curve, i, u))
            .unwrap_or((self.ends[i].0, self.ends[i].0));
        place(jet.point, directions)
    }
}
