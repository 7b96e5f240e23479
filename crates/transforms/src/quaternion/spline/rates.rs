//! The angular velocities at the keys of a [`RotationSpline`](super::RotationSpline), for which the angular acceleration is
//! continuous.
//!
//! Within a span the rotation vector is a cubic from 0 to `Δ` whose derivatives mean the angular velocities at both keys.
//! The condition at a key with spans `h₀` before and `h₁` after it is
//! `(2/h₀)J₀ω₋ + 4(1/h₀ + 1/h₁)ω + (2/h₁)J₁⁻¹ω₊ = 6(Δ₀/h₀² + Δ₁/h₁²) − N₀(J₀⁻¹ω)`,
//! three equations a key that are linear but for `N` ([`Turn::bending`]). Turns are at most half turns, so that the
//! linear part is diagonally dominant and always has its solution: that is where Newton's method starts.

use super::turn::Turn;
use super::{End, Ends};
use anamorph_core::glam::{DMat3, DVec3};

/// Newton steps at most; three to six are usual.
const STEPS: usize = 40;
/// Halvings of a step that does not help, at most.
const HALVINGS: usize = 10;
/// Greatest remainder of an equation, relative to the rates around, at which the iteration ends.
const TOLERANCE: f64 = 1e-14;
/// Greatest remainder at which the rates are taken for the solution when no step makes it smaller.
const SETTLED: f64 = 1e-10;
/// Rates that, kept up over a span beside the key, would turn farther than this (radians) are no solution that anyone
/// wants: the path would spin for hundreds of rounds between two keys, and lose digits by it.
const FARTHEST: f64 = 1e3;

/// One span: its turn as rotation vector, and how long it lasts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    pub(super) delta: DVec3,
    pub(super) length: f64,
    pub(super) turn: Turn,
    pub(super) jacobian: DMat3,
    pub(super) inverse: DMat3,
}

impl Span {
    pub(super) fn new(delta: DVec3, length: f64) -> Self {
        let turn = Turn::new(delta);
        let jacobian = turn.jacobian();
        Self {
            delta,
            length,
            turn,
            jacobian,
            inverse: jacobian.inverse(),
        }
    }

    /// The even rate.
    pub(super) fn chord(&self) -> DVec3 {
        self.delta / self.length
    }

    /// The angular acceleration at the start of the cubic with these angular velocities at its ends.
    fn start(&self, before: DVec3, after: DVec3) -> DVec3 {
        (self.chord() * 6.0 - before * 4.0 - self.inverse * after * 2.0) / self.length
    }

    /// The same at its end.
    fn end(&self, before: DVec3, after: DVec3) -> DVec3 {
        (self.jacobian * (before * 2.0 - self.chord() * 6.0) + after * 4.0) / self.length
            + self.turn.bending(self.inverse * after)
    }
}

/// A row of the equations: 3×3 blocks for the rates at the key before, at the key, and at the key after.
#[derive(Clone, Copy)]
struct Row {
    before: DMat3,
    at: DMat3,
    after: DMat3,
    right: DVec3,
    /// What `N` is multiplied by, and the span it belongs to.
    bending: Option<(f64, usize)>,
}

/// Rates and accelerations at the keys, in the frame of the body.
pub(super) struct Rates {
    pub(super) velocities: Vec<DVec3>,
    pub(super) accelerations: Vec<DVec3>,
    /// Whether the equations are solved by tame rates; if not, the velocities are [`local`] ones.
    pub(super) settled: bool,
}

fn rows(spans: &[Span], closed: bool, ends: &Ends) -> Vec<Row> {
    let count = spans.len();
    let inner = |before: usize, after: usize| {
        let (a, b) = (&spans[before], &spans[after]);
        // The equation over 4(1/h₀ + 1/h₁): shares of the two spans.
        let (share_a, share_b) = (
            b.length / (a.length + b.length),
            a.length / (a.length + b.length),
        );
        Row {
            before: a.jacobian * (0.5 * share_a),
            at: DMat3::IDENTITY,
            after: b.inverse * (0.5 * share_b),
            right: a.chord() * (1.5 * share_a) + b.chord() * (1.5 * share_b),
            bending: Some((0.25 * a.length * share_a, before)),
        }
    };
    if closed {
        return (0..count)
            .map(|i| inner((i + count - 1) % count, i))
            .collect();
    }
    let given = |rate: DVec3| Row {
        before: DMat3::ZERO,
        at: DMat3::IDENTITY,
        after: DMat3::ZERO,
        right: rate,
        bending: None,
    };
    let (first, last) = (&spans[0], &spans[count - 1]);
    let mut rows = Vec::with_capacity(count + 1);
    rows.push(match ends.start {
        End::Natural => Row {
            after: first.inverse * 0.5,
            ..given(first.chord() * 1.5)
        },
        End::Chord => given(first.chord()),
        End::Rate(rate) => given(rate),
    });
    rows.extend((1..count).map(|i| inner(i - 1, i)));
    rows.push(match ends.end {
        End::Natural => Row {
            before: last.jacobian * 0.5,
            bending: Some((0.25 * last.length, count - 1)),
            ..given(last.chord() * 1.5)
        },
        End::Chord => given(last.chord()),
        End::Rate(rate) => given(rate),
    });
    rows
}

/// Solves the block-tridiagonal system, in which the first row's `before` belongs to the last unknown and the last row's
/// `after` to the first. `None` if a block cannot be inverted.
fn solve(rows: &[Row], right: &[DVec3]) -> Option<Vec<DVec3>> {
    let last = rows.len().checked_sub(1)?;
    let inverse = |m: DMat3| {
        let inverse = m.inverse();
        inverse.is_finite().then_some(inverse)
    };
    // All unknowns but the last as affine functions of the one after them and of the last.
    let mut known: Vec<(DVec3, DMat3, DMat3)> = Vec::with_capacity(last);
    for (i, (row, &right)) in rows.iter().zip(right).take(last).enumerate() {
        let (mut at, mut right, mut by_last) = (row.at, right, DMat3::ZERO);
        match known.last() {
            Some(&(value, by_next, by_end)) => {
                at -= row.before * by_next;
                right -= row.before * value;
                by_last -= row.before * by_end;
            }
            None => by_last += row.before,
        }
        let mut by_next = row.after;
        if i + 1 == last {
            by_last += by_next;
            by_next = DMat3::ZERO;
        }
        let at = inverse(at)?;
        known.push((at * right, at * by_next, at * by_last));
    }
    for i in (0..last.saturating_sub(1)).rev() {
        let (value, _, by_end) = known[i + 1];
        let (own, by_next, by_last) = known[i];
        known[i] = (
            own - by_next * value,
            DMat3::ZERO,
            by_last - by_next * by_end,
        );
    }
    let row = &rows[last];
    let (mut at, mut value) = (row.at, right[last]);
    match (known.first(), known.last()) {
        (Some(first), Some(before)) => {
            at -= row.before * before.2 + row.after * first.2;
            value -= row.before * before.0 + row.after * first.0;
        }
        _ => at += row.before + row.after,
    }
    let end = inverse(at)? * value;
    let mut unknowns: Vec<DVec3> = known.iter().map(|k| k.0 - k.2 * end).collect();
    unknowns.push(end);
    unknowns.iter().all(|u| u.is_finite()).then_some(unknowns)
}

/// What the equations leave over at these rates.
fn remainders(rows: &[Row], spans: &[Span], rates: &[DVec3]) -> Vec<DVec3> {
    let count = rows.len();
    (0..count)
        .map(|i| {
            let row = &rows[i];
            let (before, after) = (rates[(i + count - 1) % count], rates[(i + 1) % count]);
            let bending = row.bending.map_or(DVec3::ZERO, |(weight, span)| {
                let span = &spans[span];
                span.turn.bending(span.inverse * rates[i]) * weight
            });
            row.before * before + row.at * rates[i] + row.after * after + bending - row.right
        })
        .collect()
}

/// Newton's method from the rates of the linear part; `None` where it does not settle.
fn newton(rows: &[Row], spans: &[Span], linear: &[DVec3]) -> Option<Vec<DVec3>> {
    let count = rows.len();
    // Rates around each key, of which the remainders are fractions.
    let sizes: Vec<f64> = (0..count)
        .map(|i| {
            let own = rows[i].right.length().max(linear[i].length());
            let around = linear[(i + count - 1) % count].length();
            let size = own.max(around).max(linear[(i + 1) % count].length());
            if size > 0.0 { size } else { 1.0 }
        })
        .collect();
    let largest = |list: &[DVec3]| {
        let share = list.iter().zip(&sizes).map(|(r, size)| r.length() / size);
        share.fold(0.0_f64, |m, s| if s > m || s.is_nan() { s } else { m })
    };
    let mut rates = linear.to_vec();
    let mut left = remainders(rows, spans, &rates);
    let mut error = largest(&left);
    'steps: for _ in 0..STEPS {
        if error <= TOLERANCE {
            break;
        }
        let tangents: Vec<Row> = rows
            .iter()
            .zip(&rates)
            .map(|(row, &rate)| match row.bending {
                Some((weight, span)) => {
                    let span = &spans[span];
                    let slope = span.turn.bending_slope(span.inverse * rate) * span.inverse;
                    Row {
                        at: row.at + slope * weight,
                        ..*row
                    }
                }
                None => *row,
            })
            .collect();
        let Some(step) = solve(&tangents, &left) else {
            break;
        };
        let mut part = 1.0;
        for _ in 0..HALVINGS {
            let tried: Vec<DVec3> = rates.iter().zip(&step).map(|(r, s)| r - s * part).collect();
            let tried_left = remainders(rows, spans, &tried);
            let tried_error = largest(&tried_left);
            if tried_error < error {
                (rates, left, error) = (tried, tried_left, tried_error);
                continue 'steps;
            }
            part *= 0.5;
        }
        break;
    }
    (error <= SETTLED).then_some(rates)
}

/// The turn over both spans of a key by their whole time, as [`inner_points`](crate::quaternion::inner_points) have it: near no
/// solution, but never fast.
fn local(spans: &[Span], closed: bool, ends: &Ends) -> Vec<DVec3> {
    let count = spans.len();
    let inner = |before: usize, after: usize| {
        let (a, b) = (&spans[before], &spans[after]);
        (a.delta + b.delta) / (a.length + b.length)
    };
    if closed {
        return (0..count)
            .map(|i| inner((i + count - 1) % count, i))
            .collect();
    }
    let end = |end: &End, span: &Span| match end {
        End::Natural | End::Chord => span.chord(),
        End::Rate(rate) => *rate,
    };
    let mut rates = vec![end(&ends.start, &spans[0])];
    rates.extend((1..count).map(|i| inner(i - 1, i)));
    rates.push(end(&ends.end, &spans[count - 1]));
    rates
}

/// The rates at all keys, those of the return to the first included if closed. There must be a span.
pub(super) fn rates(spans: &[Span], closed: bool, ends: &Ends) -> Rates {
    let rows = rows(spans, closed, ends);
    let right: Vec<DVec3> = rows.iter().map(|row| row.right).collect();
    let linear = solve(&rows, &right);
    let count = spans.len();
    let tame = |rates: &Vec<DVec3>| {
        spans.iter().enumerate().all(|(i, span)| {
            let fastest = rates[i].length().max(rates[(i + 1) % rates.len()].length());
            fastest * span.length <= FARTHEST
        })
    };
    let solved = linear
        .and_then(|linear| newton(&rows, spans, &linear))
        .filter(tame);
    let settled = solved.is_some();
    let mut velocities = solved.unwrap_or_else(|| local(spans, closed, ends));
    if closed {
        velocities.push(velocities[0]);
    }
    let start = |i: usize| spans[i].start(velocities[i], velocities[i + 1]);
    let end = |i: usize| spans[i].end(velocities[i], velocities[i + 1]);
    // Both sides agree where the equations are solved. Where they are not, the longer span, which a change of
    // acceleration moves farther (as the square of its length), has the more say.
    let between = |before: usize, after: usize| {
        let ratio = spans[before].length / spans[after].length;
        let square = ratio * ratio;
        let share = square / (square + 1.0 / square);
        end(before) * share + start(after) * (1.0 - share)
    };
    let mut accelerations = Vec::with_capacity(count + 1);
    accelerations.push(match ends.start {
        _ if closed => between(count - 1, 0),
        End::Natural => DVec3::ZERO,
        End::Chord | End::Rate(_) => start(0),
    });
    accelerations.extend((1..count).map(|i| between(i - 1, i)));
    accelerations.push(match ends.end {
        _ if closed => accelerations[0],
        End::Natural => DVec3::ZERO,
        End::Chord | End::Rate(_) => end(count - 1),
    });
    Rates {
        velocities,
        accelerations,
        settled,
    }
}
