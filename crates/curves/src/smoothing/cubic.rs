//! The average of a point with the cubic through its four neighbours.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Smoothing data", and errata C6. With points evenly spaced in the
//! parameter the cubic through four neighbours passes at `(−P(i−2) + 4P(i−1) + 4P(i+1) − P(i+2))/6`. Next to an end the
//! parabola through three is taken: `P₂ + (P₀ − P₃)/3` for `P₁`; and for the end, `P₃ + 3(P₁ − P₂)` for `P₀`.

use super::{Filter, Weights, wrapped};

/// Averages every point with where its neighbours' polynomial passes. Cubics pass unchanged inside, quadratics at the two
/// points of each end.
///
/// An open path of four points has only end rules; one of fewer than four does not change. Closed paths wrap, however few
/// their points are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FourNeighbourCubic;

struct Cubic {
    count: usize,
    closed: bool,
}

const INNER: [(i64, f64); 4] = [(-2, -1.0), (-1, 4.0), (1, 4.0), (2, -1.0)];

impl Filter for FourNeighbourCubic {
    fn weights(&self, count: usize, closed: bool) -> Box<dyn Weights + '_> {
        Box::new(Cubic { count, closed })
    }
}

impl Weights for Cubic {
    fn row(&self, index: usize, row: &mut Vec<(usize, f64)>) {
        let count = self.count;
        if !self.closed && count < 4 {
            row.push((index, 1.0));
            return;
        }
        row.push((index, 0.5));
        let from_end = count - 1 - index;
        if self.closed || index.min(from_end) >= 2 {
            row.extend(
                INNER
                    .iter()
                    .map(|&(offset, weight)| (wrapped(index, offset, count), weight / 12.0)),
            );
            return;
        }
        // Counted from the nearer end; four points have two at each.
        let near = index.min(from_end);
        let place = |k: usize| if index <= from_end { k } else { count - 1 - k };
        if near == 1 {
            row.extend([
                (place(2), 0.5),
                (place(0), 1.0 / 6.0),
                (place(3), -1.0 / 6.0),
            ]);
        } else {
            row.extend([(place(3), 0.5), (place(1), 1.5), (place(2), -1.5)]);
        }
    }
}
