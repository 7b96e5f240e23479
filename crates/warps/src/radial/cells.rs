//! Centres of a kernel with a radius, sorted so that a point looks only at those in reach.
//!
//! In units of the radius, centres are sorted by the cells of side 1 of all axes but the last, and in each such column by the last
//! coordinate. A point looks into 3 columns in the plane and 9 in space, in each at a run of centres that two searches find, eight at a
//! time. Which centres these are, and in what order they are added, depends on the point alone.
//!
//! *Source*: J. L. Bentley, D. F. Stanat, E. H. Williams, *The Complexity of Finding Fixed-Radius Near Neighbors*, Inf. Process. Lett.
//! 6(6), 1977; sorted columns are a decision.

use super::kernels::Profile;
use super::{Terms, squared};
use anamorph_core::Space;
use anamorph_core::simd::{self, LANES, Simd, f64x8, prelude::*};
use core::ops::Range;

/// From so many centres on, a kernel that ends is evaluated by cells.
pub(super) const WORTHWHILE: usize = 64;

/// Sorted centres with their coefficients.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cells {
    /// Columns with centres, ascending, and where each starts; behind the last where it ends.
    columns: Vec<([i64; 2], usize)>,
    /// The number of each centre.
    pub(super) numbers: Vec<u32>,
    /// Coordinates, an axis each, and behind them a block that pads them.
    at: [Vec<f64>; 3],
    /// Coefficients, the same.
    coefficients: [Vec<f64>; 3],
}

/// The cell of a coordinate.
#[inline(always)]
fn cell(x: f64) -> i64 {
    // Beyond the range of integers the last one, and 0 for what is no number: no centre is in reach of either.
    #[allow(clippy::cast_possible_truncation)]
    let cell = x.floor() as i64;
    cell
}

fn column<S: Space>(place: S) -> [i64; 2] {
    core::array::from_fn(|axis| {
        if axis + 1 < S::DIM {
            cell(place.component(axis))
        } else {
            0
        }
    })
}

impl Cells {
    /// The centres at these places, without coefficients.
    pub(super) fn new<S: Space>(places: &[S]) -> Self {
        let last = S::DIM - 1;
        let mut order: Vec<(([i64; 2], f64), usize)> = places
            .iter()
            .enumerate()
            .map(|(number, &place)| ((column(place), place.component(last)), number))
            .collect();
        order.sort_by(|((a, x), i), ((b, y), j)| a.cmp(b).then(x.total_cmp(y)).then(i.cmp(j)));
        let mut columns: Vec<([i64; 2], usize)> = Vec::new();
        for (position, ((column, _), _)) in order.iter().enumerate() {
            if columns.last().is_none_or(|(last, _)| last != column) {
                columns.push((*column, position));
            }
        }
        columns.push(([i64::MAX; 2], places.len()));
        let padded = places.len() + LANES;
        let mut at: [Vec<f64>; 3] = core::array::from_fn(|_| vec![0.0; padded]);
        for (position, (_, number)) in order.iter().enumerate() {
            for (axis, at) in at.iter_mut().enumerate().take(S::DIM) {
                at[position] = places[*number].component(axis);
            }
        }
        // At most a few hundred thousand.
        #[allow(clippy::cast_possible_truncation)]
        let numbers = order.iter().map(|(_, number)| *number as u32).collect();
        Self {
            columns,
            numbers,
            at,
            coefficients: core::array::from_fn(|_| vec![0.0; padded]),
        }
    }

    /// Takes the coefficients, in the order of the places.
    pub(super) fn set<S: Space>(&mut self, coefficients: &[S]) {
        for (position, &number) in self.numbers.iter().enumerate() {
            for (axis, row) in self.coefficients.iter_mut().enumerate().take(S::DIM) {
                row[position] = coefficients[number as usize].component(axis);
            }
        }
    }

    /// Calls with runs of positions, in order, that hold all centres nearer than 1 to a place along each axis.
    #[inline(always)]
    pub(super) fn near<S: Space>(&self, place: S, mut with: impl FnMut(Range<usize>)) {
        let [x, y] = column(place);
        let last = &self.at[S::DIM - 1][..self.numbers.len()];
        let along = place.component(S::DIM - 1);
        let (low, high) = (along - 1.0, along + 1.0);
        for x in [x.saturating_sub(1), x, x.saturating_add(1)] {
            let (first, end) = ([x, y.saturating_sub(1)], [x, y.saturating_add(1)]);
            let from = self.columns.partition_point(|(column, _)| *column < first);
            for pair in self.columns[from..].windows(2) {
                let (column, start) = pair[0];
                if column > end {
                    break;
                }
                let centres = &last[start..pair[1].1];
                let a = centres.partition_point(|&c| c < low);
                let b = a + centres[a..].partition_point(|&c| c <= high);
                if a < b {
                    with(start + a..start + b);
                }
            }
        }
    }

    /// The sum of the terms at a place.
    #[inline(always)]
    fn sum<V: Simd, P: Profile, S: Space>(&self, v: V, place: S) -> S {
        let number = |x: f64| simd::splat(v, x);
        let lanes = simd::lanes(v, |lane| [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0][lane]);
        let load = |row: &[f64], from: usize| {
            let block = row.get(from..).and_then(|rest| rest.first_chunk::<LANES>());
            f64x8::simd_from(v, *block.unwrap_or(&[0.0; LANES]))
        };
        let mut sums = [number(0.0); 3];
        self.near(place, |run| {
            for from in run.clone().step_by(LANES) {
                let d = number(place.component(0)) - load(&self.at[0], from);
                let mut q = d * d;
                for axis in 1..S::DIM {
                    let d = number(place.component(axis)) - load(&self.at[axis], from);
                    q += d * d;
                }
                #[allow(clippy::cast_precision_loss)]
                let rest = (run.end - from) as f64;
                let inside = lanes.simd_lt(number(rest));
                let value = inside.select(P::values(v, q), number(0.0));
                for (axis, sum) in sums.iter_mut().enumerate().take(S::DIM) {
                    *sum += load(&self.coefficients[axis], from) * value;
                }
            }
        });
        let sums: [[f64; LANES]; 3] = sums.map(Into::into);
        S::from_fn(|axis| sums[axis].iter().sum())
    }
}

/// Moves a run of points.
#[inline(always)]
pub(super) fn run<V: Simd, P: Profile, S: Space>(
    v: V,
    terms: &Terms<S>,
    cells: &Cells,
    points: &mut [S],
) {
    for p in points {
        let place = terms.place(*p);
        let mut moved = cells.sum::<V, P, S>(v, place);
        for (axis, &a) in terms.affine.iter().enumerate() {
            let strength = if axis == 0 {
                1.0
            } else {
                place.component(axis - 1)
            };
            moved += a * strength;
        }
        *p = p.moved_by(moved);
    }
}

impl<S: Space> Terms<S> {
    /// Calls with the number of every centre that is in reach of a place, if the kernel ends, and of all if not.
    pub(super) fn in_reach(&self, place: S, mut with: impl FnMut(usize)) {
        match &self.cells {
            Some(cells) => cells.near(place, |run| {
                for &number in &cells.numbers[run] {
                    if squared(place, self.places[number as usize]) < 1.0 {
                        with(number as usize);
                    }
                }
            }),
            None => (0..self.places.len()).for_each(with),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::{Plane, Solid};

    fn places<S: Space>(count: usize, spread: f64) -> Vec<S> {
        let mut state = 1_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * spread
        };
        (0..count).map(|_| S::from_fn(|_| next())).collect()
    }

    fn all_within_reach_once<S: Space>() {
        for (count, spread) in [(300, 4.0), (500, 40.0), (90, 0.5)] {
            let list: Vec<S> = places(count, spread);
            let cells = Cells::new(&list);
            let mut probes: Vec<S> = places(200, 1.2 * spread);
            probes.extend(&list[..20]);
            probes.extend([S::splat(1e300), S::splat(f64::NAN), S::splat(-1e30)]);
            for place in probes {
                let mut found = Vec::new();
                cells.near(place, |run| found.extend(&cells.numbers[run]));
                found.sort_unstable();
                let before = found.len();
                found.dedup();
                assert_eq!(before, found.len());
                for (number, &at) in list.iter().enumerate() {
                    if squared(place, at) < 1.0 {
                        assert!(found.contains(&(number as u32)), "{place:?} {at:?}");
                    }
                }
                assert!(found.len() < count || spread < 5.0);
            }
        }
    }

    #[test]
    fn every_centre_within_reach_is_found_once() {
        all_within_reach_once::<Plane>();
        all_within_reach_once::<Solid>();
    }
}
