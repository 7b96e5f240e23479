//! The control lattices of a hierarchy: where points lie in them, what fits a residual locally, and how one is refined.
//!
//! A level of `n` spans along an axis has `n + 3` control points there, the first of them one spacing before the box. A point in the
//! span `i` depends on the control points `i` to `i + 3`.
//!
//! *Source*: S. Lee, G. Wolberg, S. Y. Shin, *Scattered Data Interpolation with Multilevel B-Splines*, IEEE TVCG 3(3), 1997: eqs.
//! (3)–(5) fit a lattice, §3.2 refines it.

use crate::lattices::{Grid, LatticeError};
use anamorph_core::{Bounds, Space};
use std::collections::HashSet;

/// Basis functions that are not zero at a point, along an axis.
const REACH: usize = 4;
/// Control points beside each face that are still in a lattice that vanishes at its faces with two derivatives.
const RIM: usize = 3;

/// Where a point lies in a level: the first control point along each axis, and the values of the bases.
#[derive(Debug, Clone, Copy)]
struct Place {
    first: [usize; 3],
    bases: [[f64; REACH]; 3],
}

/// The uniform cubic B-splines at a share of the span.
fn cubic(t: f64) -> [f64; REACH] {
    let s = 1.0 - t;
    [
        s * s * s / 6.0,
        (4.0 - 3.0 * t * t * (2.0 - t)) / 6.0,
        (4.0 - 3.0 * s * s * (2.0 - s)) / 6.0,
        t * t * t / 6.0,
    ]
}

/// One level of the hierarchy.
#[derive(Debug, Clone)]
pub(super) struct Level<S: Space> {
    /// The box and its control points.
    pub(super) grid: Grid<S>,
    /// Spans along each axis; 1 for an axis the space lacks.
    pub(super) spans: [usize; 3],
    still: bool,
}

/// Spans along each axis of the coarsest level: cells about as long as wide, and with faces that stay at least one control point that
/// is free.
pub(super) fn coarsest<S: Space>(bounds: Bounds<S>, still: bool) -> [usize; 3] {
    const LONGEST: f64 = 8.0;
    let size = bounds.size();
    let lengths = (0..S::DIM).map(|axis| size.component(axis));
    // An axis without extent gets a box of the diagonal's length, and is none of the shortest.
    let thick = lengths.filter(|&length| length > 1e-9 * bounds.diagonal());
    let shortest = thick.fold(f64::INFINITY, f64::min);
    let least = if still { REACH } else { 1 };
    core::array::from_fn(|axis| {
        if axis >= S::DIM {
            return 1;
        }
        let times = (size.component(axis) / shortest).round();
        // Between 1 and 8.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let times = times.clamp(1.0, LONGEST) as usize;
        least * times
    })
}

/// Control points of a level with so many spans.
pub(super) fn shape<S: Space>(spans: [usize; 3]) -> [usize; 3] {
    core::array::from_fn(|axis| if axis < S::DIM { spans[axis] + 3 } else { 1 })
}

impl<S: Space> Level<S> {
    /// The level of so many spans over a box.
    pub(super) fn new(
        bounds: Bounds<S>,
        spans: [usize; 3],
        still: bool,
    ) -> Result<Self, LatticeError> {
        Ok(Self {
            grid: Grid::around(bounds, &shape::<S>(spans))?,
            spans,
            still,
        })
    }

    /// Where a point lies; `None` outside the box.
    fn place(&self, p: S) -> Option<Place> {
        let local = self.grid.local(p)?;
        let mut place = Place {
            first: [0; 3],
            bases: [[1.0, 0.0, 0.0, 0.0]; 3],
        };
        for axis in 0..S::DIM {
            #[allow(clippy::cast_precision_loss)]
            let along = local.component(axis) * self.spans[axis] as f64;
            // Not negative, and at most the number of spans.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let span = (along as usize).min(self.spans[axis] - 1);
            place.first[axis] = span;
            #[allow(clippy::cast_precision_loss)]
            let share = along - span as f64;
            place.bases[axis] = cubic(share);
        }
        Some(place)
    }

    /// Calls with the flat index and the basis value of every control point that a place depends on.
    fn each(&self, place: &Place, mut with: impl FnMut(usize, f64)) {
        let reach = |axis: usize| if axis < S::DIM { REACH } else { 1 };
        let [a, b, c] = place.bases;
        for (i, a) in a.into_iter().enumerate().take(reach(0)) {
            for (j, b) in b.into_iter().enumerate().take(reach(1)) {
                for (k, c) in c.into_iter().enumerate().take(reach(2)) {
                    let [x, y, z] = place.first;
                    with(self.grid.flat([x + i, y + j, z + k]), a * b * c);
                }
            }
        }
    }

    /// Whether a control point must stay.
    fn is_still(&self, flat: usize) -> bool {
        let (triple, shape) = (self.grid.triple(flat), self.grid.shape());
        self.still
            && (0..S::DIM).any(|axis| triple[axis] < RIM || triple[axis] + RIM >= shape[axis])
    }

    /// Displacements of the control points that bring each point of a list as near as can be to its displacement, each on its own,
    /// averaged where points meet: eqs. (3)–(5).
    pub(super) fn fit(&self, points: &[S], displacements: &[S]) -> Vec<S> {
        let count = self.grid.len();
        let (mut sums, mut weights) = (vec![S::ZERO; count], vec![0.0; count]);
        for (&p, &wanted) in points.iter().zip(displacements) {
            let Some(place) = self.place(p) else {
                continue;
            };
            let mut squares = 0.0;
            self.each(&place, |flat, w| {
                if !self.is_still(flat) {
                    squares += w * w;
                }
            });
            if squares <= f64::MIN_POSITIVE {
                continue;
            }
            self.each(&place, |flat, w| {
                if !self.is_still(flat) {
                    let square = w * w;
                    sums[flat] += wanted * (w / squares * square);
                    weights[flat] += square;
                }
            });
        }
        for (sum, weight) in sums.iter_mut().zip(weights) {
            if weight > f64::MIN_POSITIVE {
                *sum = *sum / weight;
            } else {
                *sum = S::ZERO;
            }
        }
        sums
    }

    /// The displacement of a point by those of the control points.
    pub(super) fn displacement(&self, control: &[S], p: S) -> S {
        let mut sum = S::ZERO;
        if let Some(place) = self.place(p) {
            self.each(&place, |flat, w| sum += control[flat] * w);
        }
        sum
    }

    /// The same spline by the control points of the level with twice as many spans along each axis.
    pub(super) fn refined(&self, control: &[S]) -> Vec<S> {
        let mut shape = self.grid.shape();
        let mut values = control.to_vec();
        for axis in 0..S::DIM {
            let after: usize = shape[axis + 1..].iter().product();
            let (before, count) = (shape[..axis].iter().product::<usize>(), shape[axis]);
            let finer = 2 * count - 3;
            let mut out = vec![S::ZERO; before * finer * after];
            for line in 0..before * after {
                let (outer, inner) = (line / after, line % after);
                let at = |i: usize| values[(outer * count + i) * after + inner];
                for i in 0..finer {
                    // Even ones lie in the middle of two, odd ones on one.
                    let half = i / 2;
                    out[(outer * finer + i) * after + inner] = if i % 2 == 0 {
                        (at(half) + at(half + 1)) * 0.5
                    } else {
                        (at(half) + at(half + 1) * 6.0 + at(half + 2)) * 0.125
                    };
                }
            }
            values = out;
            shape[axis] = finer;
        }
        values
    }

    /// Whether no control point depends on two of the places: then [`Level::fit`] meets all of them.
    pub(super) fn separates(&self, points: &[S]) -> bool {
        let places: Option<Vec<Place>> = points.iter().map(|&p| self.place(p)).collect();
        let Some(places) = places else {
            return false;
        };
        // Of every place all control points that depend on it, unless another's is among them.
        let mut taken = HashSet::new();
        places.iter().all(|place| {
            let mut free = true;
            self.each(place, |flat, w| {
                if w != 0.0 {
                    free &= taken.insert(flat);
                }
            });
            free
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::{Plane, Solid};

    fn values<S: Space>(count: usize, seed: usize) -> Vec<S> {
        let value = |i: usize| (((i + seed) * 7919) % 1009) as f64 / 500.0 - 1.0;
        (0..count)
            .map(|i| S::from_fn(|axis| value(3 * i + axis)))
            .collect()
    }

    fn refinement_changes_no_spline<S: Space>() {
        let bounds = Bounds::new(S::splat(-1.0), S::from_fn(|axis| 1.0 + axis as f64));
        let spans = core::array::from_fn(|axis| if axis < S::DIM { 2 + axis } else { 1 });
        let coarse = Level::new(bounds, spans, false).unwrap();
        let twice = core::array::from_fn(|axis| if axis < S::DIM { 2 * spans[axis] } else { 1 });
        let fine = Level::new(bounds, twice, false).unwrap();
        let control: Vec<S> = values(coarse.grid.len(), 1);
        let refined = coarse.refined(&control);
        assert_eq!(refined.len(), fine.grid.len());
        for p in values::<S>(300, 5) {
            let p = bounds.at((p + S::splat(1.0)) * 0.5);
            let apart = coarse.displacement(&control, p) - fine.displacement(&refined, p);
            assert!(apart.largest() < 1e-14, "{p:?}: {apart:?}");
        }
    }

    #[test]
    fn refined_lattices_are_the_same_spline() {
        refinement_changes_no_spline::<Plane>();
        refinement_changes_no_spline::<Solid>();
    }

    #[test]
    fn a_point_alone_is_met_with_the_least_moves() {
        let bounds = Bounds::new(Plane::ZERO, Plane::splat(4.0));
        let level = Level::new(bounds, [4, 4, 1], false).unwrap();
        let (p, d) = (Plane::new(1.3, 2.9), Plane::new(0.5, -0.25));
        let control = level.fit(&[p], &[d]);
        assert!((level.displacement(&control, p) - d).largest() < 1e-15);
        // Of all that meet it the one with the least sum of squares is proportional to the bases.
        let place = level.place(p).unwrap();
        let mut squares = 0.0;
        level.each(&place, |_, w| squares += w * w);
        level.each(&place, |flat, w| {
            assert!((control[flat] - d * (w / squares)).largest() < 1e-15);
        });
    }

    #[test]
    fn places_are_apart_where_no_control_point_sees_two() {
        let bounds = Bounds::new(Plane::ZERO, Plane::splat(16.0));
        let level = Level::new(bounds, [16, 16, 1], false).unwrap();
        let (a, near, far) = (
            Plane::new(5.5, 5.5),
            Plane::new(8.5, 5.5),
            Plane::new(9.5, 5.5),
        );
        assert!(!level.separates(&[a, near]));
        assert!(level.separates(&[a, far]));
        let (d, e) = (Plane::new(1.0, 2.0), Plane::new(-3.0, 0.5));
        let control = level.fit(&[a, far], &[d, e]);
        assert!((level.displacement(&control, a) - d).largest() < 1e-15);
        assert!((level.displacement(&control, far) - e).largest() < 1e-15);
    }

    #[test]
    fn still_faces_have_no_displacement_and_points_inside_are_met() {
        let bounds = Bounds::new(Solid::ZERO, Solid::splat(2.0));
        let level = Level::new(bounds, [8; 3], true).unwrap();
        let points: Vec<Solid> = values::<Solid>(40, 3).iter().map(|p| *p + 1.0).collect();
        let control = level.fit(&points, &values(40, 9));
        for p in values::<Solid>(200, 11) {
            let mut p = p + 1.0;
            p.y = 2.0;
            assert_eq!(level.displacement(&control, p), Solid::ZERO);
        }
        let middle = [Solid::splat(1.1)];
        let control = level.fit(&middle, &[Solid::X]);
        assert!((level.displacement(&control, middle[0]) - Solid::X).largest() < 1e-14);
    }
}
