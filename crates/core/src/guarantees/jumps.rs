//! Jumps: where facts leave continuity open, two places ever closer together whose displacements stay apart.
//!
//! *Source*: Milliron et al. 2002, §7.3; errata F4 (a normalized average jumps where its last weight vanishes; an ambient weight
//! repairs that, at a price). The search halves segments between points of the model and keeps the half over which the displacement
//! changes more (decision); a change that does not shrink with the segment is a jump.

use super::{Guarantee, Property, Verdict, Witness, continuity, interpolation, rounded};
use crate::{Deformation, Domain, Influences, Modulated, Site, Smoothness, Space, Warp};

/// Segments that are searched.
const SEGMENTS: usize = 300;
/// Parts of a segment at first.
const PARTS: u32 = 24;
/// Halvings of the part with the largest change.
const HALVINGS: usize = 44;
/// A jump below this share of the model's size is none.
const LEAST: f64 = 1e-9;

/// Continuity from facts and, where they leave it open, from a search for a jump among the places of a model of size `size`.
pub fn continuity_of<S: Space, D: Deformation<S> + ?Sized>(
    deformation: &D,
    points: &[S],
    size: f64,
) -> Guarantee<S> {
    let mut known = continuity(deformation);
    if known.verdict != Verdict::Unknown || deformation.domain() == Domain::Model {
        return known;
    }
    let Some(witness) = jump(deformation, points, size) else {
        known.statement = format!("{}; no jump was found", known.statement);
        return known;
    };
    let inside = deformation.facts().inside;
    let statement = if inside > Smoothness::Jump {
        format!(
            "at least {inside} inside its support, but jumps by {} at its edge",
            rounded(witness.value)
        )
    } else {
        format!("jumps by {}", rounded(witness.value))
    };
    Guarantee::new(
        Property::Continuity,
        Verdict::Refuted,
        statement,
        Some(witness),
    )
}

/// The largest jump found: its place, its size, the other side.
fn jump<S: Space, D: Deformation<S> + ?Sized>(
    deformation: &D,
    points: &[S],
    size: f64,
) -> Option<Witness<S>> {
    let count = points.len();
    if count < 2 {
        return None;
    }
    let displacement = |place: S| deformation.map(&Site::anywhere(place)) - place;
    let mut worst: Option<Witness<S>> = None;
    for number in 0..SEGMENTS.min(count) {
        // Spread over the model; the partner anywhere else in it.
        let first = number * count / SEGMENTS.min(count);
        let second = (first + 1 + (number * 7919 + 13) % (count - 1)) % count;
        let (a, b) = (points[first], points[second]);
        if !(a.is_finite() && b.is_finite()) || a == b {
            continue;
        }
        let at = |t: f64| a + (b - a) * t;
        let change = |t: f64, u: f64| displacement(at(u)).distance(displacement(at(t)));
        let part = |i: u32| f64::from(i) / f64::from(PARTS);
        let largest = (0..PARTS)
            .map(|i| (i, change(part(i), part(i + 1))))
            .max_by(|x, y| x.1.total_cmp(&y.1));
        let Some((i, whole)) = largest else { continue };
        if whole.is_nan() || whole <= LEAST * size {
            continue;
        }
        let (mut from, mut to) = (part(i), part(i + 1));
        // What the change was when the segment was a thousand times as long as in the end.
        let (mut before, mut now) = (whole, whole);
        for halving in 0..HALVINGS {
            let middle = 0.5 * (from + to);
            if middle <= from || middle >= to {
                break;
            }
            let (left, right) = (change(from, middle), change(middle, to));
            if left >= right {
                (to, now) = (middle, left);
            } else {
                (from, now) = (middle, right);
            }
            if halving == HALVINGS - 10 {
                before = now;
            }
            if now <= LEAST * size {
                break;
            }
        }
        let jumps = now > LEAST * size && now > 0.5 * before;
        if jumps && worst.is_none_or(|w| now > w.value) {
            worst = Some(Witness {
                place: at(from),
                value: now,
                other: Some(at(to)),
            });
        }
    }
    worst
}

/// An ambient weight that makes a warp continuous where it jumps at the edge of its support, and what it costs: the weight, and the
/// largest distance by which a feature then misses its target (`None` where the warp names none). `None` where it would not help.
pub fn ambient_repair<S: Space, W: Warp<S> + Clone + 'static>(
    warp: &W,
    points: &[S],
    size: f64,
) -> Option<(f64, Option<f64>)> {
    let facts = warp.facts();
    if facts.edge > Smoothness::Jump || !facts.weights_fade {
        return None;
    }
    // A hundredth of the weights as they are inside.
    let mut list = Influences::default();
    let mut totals: Vec<f64> = points
        .iter()
        .enumerate()
        .filter_map(|(index, &place)| {
            list.clear();
            warp.influences(&Site::new(index, place), &mut list);
            let total: f64 = list.list.iter().map(|i| i.weight).sum();
            (total > 0.0 && total.is_finite()).then_some(total)
        })
        .collect();
    totals.sort_by(f64::total_cmp);
    let typical = *totals.get(totals.len() / 2)?;
    let ambient = 0.01 * typical;
    let repaired = Modulated::new(Box::new(warp.clone())).with_ambient(ambient);
    if repaired.facts().smoothness() == Smoothness::Jump {
        return None;
    }
    let miss = interpolation(&repaired, size).witness.map(|w| w.value);
    Some((ambient, miss))
}
