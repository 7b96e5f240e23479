//! What a snake may not do: go farther than its reach, and cross itself.
//!
//! A point that was given stays in the disc of the reach about the place where it was given, and one between two of them in what lies within
//! the reach of the segment between those places. Both sets are convex, so that all of the curve stays there, however its points are spread
//! anew. Where the shape that a round ends with would cross itself, the points about the crossings go only a part of their way, each try a
//! smaller one and more of them; if no try is free of crossings the round is not done at all.
//!
//! *Source*: elementary. Keeping the topology by refusing single moves is after X. Han, C. Xu, J. L. Prince, *A Topology Preserving Level Set
//! Method for Geometric Deformable Models*, IEEE Transactions on PAMI 25(6), 2003.

use super::crossings::crossings;
use super::curve::Curve;
use super::{Snake, SnakeError};
use anamorph_core::glam::DVec2;

/// Tries to make a round's step free of crossings.
const TRIES: i32 = 8;
/// Points to either side of a crossing that go less far, at the first try; each has twice as many as the one before.
const BESIDE: usize = 8;
/// Crossings looked at in one try.
const LOOKED_AT: usize = 4096;

/// The nearest place to `to` that is within `reach` of the segment between two places.
pub(super) fn held(to: DVec2, [a, b]: [DVec2; 2], reach: f64) -> DVec2 {
    let along = b - a;
    let squared = along.length_squared();
    let share = if squared > 0.0 {
        ((to - a).dot(along) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let nearest = a + along * share;
    let off = to - nearest;
    let distance = off.length();
    if distance > reach {
        nearest + off * (reach / distance)
    } else {
        to
    }
}

/// Which shapes are kept free of crossings: those that were in the beginning.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    closed: bool,
    points: Option<usize>,
    /// The curve itself.
    curve: bool,
    /// The polyline that is the result.
    result: bool,
}

impl Limits {
    pub(super) fn new(curve: &Curve, options: &Snake) -> Self {
        let free = |line: &[DVec2]| crossings(line, options.closed, 1).is_empty();
        Self {
            closed: options.closed,
            points: options.points,
            curve: free(&curve.points),
            result: free(&curve.result(options.points)),
        }
    }

    /// Whether the result crossed itself in the beginning.
    pub(super) fn crossed_before(self) -> bool {
        !self.result
    }

    /// Where a result crosses itself.
    pub(super) fn crossing(self, result: &[DVec2]) -> Option<DVec2> {
        let first = crossings(result, self.closed, 1).into_iter().next();
        first.map(|[_, number]| result[number])
    }

    /// The curve whose points have gone to `ends`, or as far as they get without a crossing, spread anew; and whether they got there.
    /// The curve itself is `None` if there is no such way.
    pub(super) fn stepped(
        self,
        curve: &Curve,
        ends: &[DVec2],
    ) -> Result<(Option<Curve>, bool), SnakeError> {
        let mut shares = vec![1.0_f64; ends.len()];
        for number in 0..TRIES {
            let ways = curve.points.iter().zip(ends).zip(&shares);
            let gone = ways.map(|((from, to), &share)| {
                if share == 1.0 {
                    *to
                } else {
                    *from + (*to - *from) * share
                }
            });
            let moved = curve.with_points(gone.collect());
            let mut crossed = Vec::new();
            if self.curve {
                crossed = crossings(&moved.points, self.closed, LOOKED_AT);
            }
            if crossed.is_empty() {
                let mut next = moved.respaced().ok_or(super::TOO_MANY)?;
                // Shorter ways round corners may cross where the corners do not.
                if self.curve && !crossings(&next.points, self.closed, 1).is_empty() {
                    next = moved;
                }
                let result = next.result(self.points);
                if self.result {
                    crossed = crossings(&result, self.closed, LOOKED_AT);
                }
                if crossed.is_empty() {
                    return Ok((Some(next), number == 0));
                }
                // From the segments of the result to the points of the curve.
                let of = |segment: usize| curve.place_of(segment, self.points);
                crossed = crossed
                    .into_iter()
                    .flat_map(|pair| pair.map(|n| [of(n), of(n + 1)]))
                    .collect();
            }
            let most = 0.5_f64.powi(number + 1);
            let most = if number + 2 >= TRIES { 0.0 } else { most };
            slow(&mut shares, &crossed, self.closed, BESIDE << number, most);
        }
        Ok((None, false))
    }
}

/// Lowers the shares of points about crossings to `most`, less and less with the distance, `beside` points to either side.
fn slow(shares: &mut [f64], crossed: &[[usize; 2]], closed: bool, beside: usize, most: f64) {
    let count = shares.len();
    // How far each point is from one that is at a crossing, by one way there and one back, twice where the curve is closed.
    let mut far = vec![beside; count];
    for &[a, b] in crossed {
        let (a, b) = (a.min(count - 1), b.min(count - 1));
        // A small loop as a whole, else both places.
        let whole = b.max(a) - a.min(b) <= beside;
        let run = if whole { a.min(b)..=a.max(b) } else { a..=a };
        for i in run.chain([b, (a + 1) % count, (b + 1) % count]) {
            far[i] = 0;
        }
    }
    let rounds = if closed { 2 } else { 1 };
    for _ in 0..rounds {
        let mut before = if closed { far[count - 1] } else { beside };
        for far in &mut far {
            *far = (*far).min(before + 1);
            before = *far;
        }
    }
    for _ in 0..rounds {
        let mut before = if closed { far[0] } else { beside };
        for far in far.iter_mut().rev() {
            *far = (*far).min(before + 1);
            before = *far;
        }
    }
    for (share, far) in shares.iter_mut().zip(far) {
        let rest = far as f64 / beside as f64;
        *share = share.min(most + (1.0 - most) * rest.min(1.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::dvec2;

    #[test]
    fn points_are_held_within_reach_of_their_segment() {
        let segment = [dvec2(0.0, 0.0), dvec2(10.0, 0.0)];
        assert_eq!(held(dvec2(3.0, 2.0), segment, 2.0), dvec2(3.0, 2.0));
        assert_eq!(held(dvec2(3.0, -5.0), segment, 2.0), dvec2(3.0, -2.0));
        assert_eq!(held(dvec2(16.0, 8.0), segment, 5.0), dvec2(13.0, 4.0));
        let point = [dvec2(1.0, 1.0); 2];
        assert_eq!(held(dvec2(1.0, 9.0), point, 3.0), dvec2(1.0, 4.0));
        assert_eq!(held(dvec2(7.0, 9.0), point, 0.0), dvec2(1.0, 1.0));
    }

    #[test]
    fn points_about_a_crossing_go_less_far() {
        let mut shares = vec![1.0; 40];
        slow(&mut shares, &[[1, 30]], true, 4, 0.5);
        assert_eq!([shares[1], shares[2], shares[30], shares[31]], [0.5; 4]);
        assert!(shares[3] > 0.5 && shares[3] < shares[4] && shares[0] < shares[39]);
        assert_eq!(shares[15], 1.0);
        let mut shares = vec![1.0; 40];
        slow(&mut shares, &[[10, 14]], false, 8, 0.0);
        assert!(shares[10..=15].iter().all(|&share| share == 0.0));
        assert_eq!(shares[39], 1.0);
    }
}
