//! Balls in a grid of cells: which of them may hold a point, without looking at all.
//!
//! *Source*: decision: a grid as fine as keeps the list of balls in cells within a few times the number of balls, whatever their sizes.

use anamorph_core::{Bounds, Space};

/// Entries of the grid for each ball, at most.
const EACH: usize = 96;
/// Cells along an axis at most.
const FINEST: usize = 96;

/// Balls by the cells they touch.
#[derive(Debug, Clone)]
pub(super) struct Cells<S: Space> {
    bounds: Option<Bounds<S>>,
    counts: [usize; 3],
    /// Cells a scene unit, along each axis.
    per_unit: S,
    starts: Vec<u32>,
    entries: Vec<u32>,
}

impl<S: Space> Default for Cells<S> {
    fn default() -> Self {
        Self {
            bounds: None,
            counts: [1; 3],
            per_unit: S::ZERO,
            starts: vec![0, 0],
            entries: Vec::new(),
        }
    }
}

impl<S: Space> Cells<S> {
    /// The grid of balls: number, centre, radius. Balls of a cell stand in the order of the list.
    pub(super) fn new(balls: &[(u32, S, f64)]) -> Self {
        let mut bounds: Option<Bounds<S>> = None;
        for (_, centre, radius) in balls {
            // A little more, so that rounding loses no point of a ball.
            let reach = S::splat(radius * (1.0 + 1e-9));
            let ball = Bounds::new(*centre - reach, *centre + reach);
            bounds = Some(bounds.map_or(ball, |b| b.union(ball)));
        }
        let Some(bounds) = bounds else {
            return Self::default();
        };
        let mut fine = FINEST;
        loop {
            let mut cells = Self::empty(bounds, fine);
            let total: usize = balls.iter().map(|ball| cells.touched(ball).count()).sum();
            if fine == 1 || total <= EACH * balls.len() {
                cells.fill(balls);
                return cells;
            }
            fine = (fine * 2 / 3).max(1);
        }
    }

    /// No balls, `fine` cells along the longest edge.
    fn empty(bounds: Bounds<S>, fine: usize) -> Self {
        let size = bounds.size();
        let longest = size.largest();
        #[allow(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss
        )]
        let counts = core::array::from_fn(|axis| {
            if axis >= S::DIM {
                return 1;
            }
            let share = size.component(axis) / longest * fine as f64;
            if share.is_finite() {
                (share.ceil() as usize).clamp(1, FINEST)
            } else {
                1
            }
        });
        #[allow(clippy::cast_precision_loss)]
        let per_unit = S::from_fn(|axis| {
            let per = counts[axis] as f64 / size.component(axis);
            if per.is_finite() { per } else { 0.0 }
        });
        Self {
            bounds: Some(bounds),
            counts,
            per_unit,
            starts: Vec::new(),
            entries: Vec::new(),
        }
    }

    /// The cell of a coordinate along an axis.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn cell(&self, axis: usize, low: f64, coordinate: f64) -> usize {
        // What is below 0 or not a number becomes 0.
        let cell = ((coordinate - low) * self.per_unit.component(axis)) as usize;
        cell.min(self.counts[axis] - 1)
    }

    /// The flat numbers of the cells that the box around a ball touches.
    fn touched(&self, (_, centre, radius): &(u32, S, f64)) -> impl Iterator<Item = usize> + use<S> {
        let low = self.bounds.map_or(S::ZERO, |b| b.min);
        let reach = radius * (1.0 + 1e-9);
        let range: [(usize, usize); 3] = core::array::from_fn(|axis| {
            if axis >= S::DIM {
                return (0, 0);
            }
            let (low, at) = (low.component(axis), centre.component(axis));
            (
                self.cell(axis, low, at - reach),
                self.cell(axis, low, at + reach),
            )
        });
        let counts = self.counts;
        let [x, y, z] = range.map(|(from, to)| from..=to);
        x.flat_map(move |i| {
            let z = z.clone();
            y.clone()
                .flat_map(move |j| z.clone().map(move |k| (i * counts[1] + j) * counts[2] + k))
        })
    }

    fn fill(&mut self, balls: &[(u32, S, f64)]) {
        let count: usize = self.counts.iter().product();
        let mut starts = vec![0_u32; count + 1];
        for ball in balls {
            for cell in self.touched(ball) {
                starts[cell + 1] += 1;
            }
        }
        for cell in 0..count {
            starts[cell + 1] += starts[cell];
        }
        let mut next = starts.clone();
        let mut entries = vec![0; starts[count] as usize];
        for ball in balls {
            for cell in self.touched(ball) {
                entries[next[cell] as usize] = ball.0;
                next[cell] += 1;
            }
        }
        (self.starts, self.entries) = (starts, entries);
    }

    /// A box around all balls.
    pub(super) fn bounds(&self) -> Option<Bounds<S>> {
        self.bounds
    }

    /// The balls that may hold a point, all that do among them.
    #[inline]
    pub(super) fn at(&self, point: S) -> &[u32] {
        let Some(bounds) = self.bounds.filter(|b| b.contains(point)) else {
            return &[];
        };
        let mut flat = 0;
        for axis in 0..S::DIM {
            let cell = self.cell(axis, bounds.min.component(axis), point.component(axis));
            flat = flat * self.counts[axis] + cell;
        }
        if S::DIM == 2 {
            flat *= self.counts[2];
        }
        &self.entries[self.starts[flat] as usize..self.starts[flat + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::{Plane, Solid};

    fn check<S: Space>(count: u32) {
        let mut state = 7_u64;
        let mut unit = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let balls: Vec<(u32, S, f64)> = (0..count)
            .map(|i| {
                let radius = 0.02 + 0.3 * unit() * unit();
                (i, S::from_fn(|_| unit() * 4.0 - 2.0), radius)
            })
            .collect();
        let cells = Cells::new(&balls);
        assert!(cells.entries.len() <= EACH * balls.len());
        for _ in 0..2000 {
            let point = S::from_fn(|_| unit() * 5.0 - 2.5);
            let near = cells.at(point);
            assert!(near.windows(2).all(|w| w[0] < w[1]));
            for (i, centre, radius) in &balls {
                if centre.distance(point) <= *radius {
                    assert!(near.contains(i), "{point:?}");
                }
            }
        }
    }

    #[test]
    fn every_ball_around_a_point_is_found() {
        for count in [1, 10, 500] {
            check::<Solid>(count);
            check::<Plane>(count);
        }
        assert!(Cells::<Solid>::new(&[]).at(Solid::ZERO).is_empty());
        let flat = [(0, Solid::ZERO, 1e-300), (1, Solid::X * 1e300, 1e300)];
        assert!(Cells::new(&flat).at(Solid::ZERO).contains(&0));
    }
}
