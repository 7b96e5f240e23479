//! Which span of a sequence a time lies in: a grid over the domain, so that a query does not search all keys.

use super::keys::Keys;

/// The times of a path, prepared for queries.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Timeline {
    times: Vec<f64>,
    closed: bool,
    /// `first[c]` is how many of the inner times lie in cells before `c`; one more entry than cells.
    first: Vec<usize>,
    /// Cells per unit of time.
    scale: f64,
}

/// Inner times in one cell beyond which they are bisected rather than counted.
const COUNTED: usize = 8;

impl Timeline {
    pub(super) fn new(keys: &Keys) -> Self {
        let times = keys.times().to_vec();
        let spans = times.len() - 1;
        // Two cells a span: with even times a cell holds at most one key.
        let cells = 2 * spans.max(1);
        let length = times[spans] - times[0];
        let mut line = Self {
            times,
            closed: keys.is_closed(),
            first: vec![0; cells + 1],
            scale: if length > 0.0 {
                cells as f64 / length
            } else {
                0.0
            },
        };
        for i in 1..spans {
            let cell = line.cell(line.times[i]);
            line.first[cell + 1] += 1;
        }
        for c in 0..cells {
            line.first[c + 1] += line.first[c];
        }
        line
    }

    pub(super) fn times(&self) -> &[f64] {
        &self.times
    }

    pub(super) fn start(&self) -> f64 {
        self.times[0]
    }

    pub(super) fn end(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    pub(super) fn is_closed(&self) -> bool {
        self.closed
    }

    /// How long span `i` lasts; 1 for a single key, which has none.
    pub(super) fn span(&self, i: usize) -> f64 {
        match self.times.get(i + 1) {
            Some(end) => end - self.times[i],
            None => 1.0,
        }
    }

    /// The time within the domain that `t` stands for: repeated for closed sequences, the nearer end for open ones.
    #[inline]
    pub(super) fn within(&self, t: f64) -> f64 {
        let (start, end) = (self.start(), self.end());
        if t >= start && t <= end {
            return t;
        }
        if self.closed && t.is_finite() {
            let t = start + (t - start).rem_euclid(end - start);
            return t.min(end);
        }
        // NaN and closed sequences at infinity: the start.
        if t > end && !self.closed { end } else { start }
    }

    /// Whether a path stands still at `t`: before the start or after the end of an open sequence.
    pub(super) fn rests_at(&self, t: f64) -> bool {
        !(self.closed || (t >= self.start() && t <= self.end()))
    }

    /// Grows with `t`, which is all that [`Self::locate`] needs of it, whatever the rounding.
    #[inline]
    fn cell(&self, t: f64) -> usize {
        // The conversion cuts off at 0 and at the last cell.
        (((t - self.times[0]) * self.scale) as usize).min(self.first.len() - 2)
    }

    /// The span that `t` lies in, and where within it, in [0, 1]. At a key it is the span that starts there, at the end
    /// of the domain the last.
    #[inline]
    pub(super) fn locate(&self, t: f64) -> (usize, f64) {
        if self.times.len() < 2 {
            return (0, 0.0);
        }
        let t = self.within(t);
        let cell = self.cell(t);
        let (low, high) = (self.first[cell], self.first[cell + 1]);
        let inner = &self.times[low + 1..=high];
        let passed = if inner.len() <= COUNTED {
            inner.iter().map(|&key| usize::from(key <= t)).sum()
        } else {
            inner.partition_point(|&key| key <= t)
        };
        let i = low + passed;
        let (start, end) = (self.times[i], self.times[i + 1]);
        (i, (t - start) / (end - start))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;
    use anamorph_core::glam::DQuat;

    fn check(keys: &Keys, random: &mut Random) {
        let line = Timeline::new(keys);
        let times = keys.times().to_vec();
        let last = times.len() - 2;
        let mut queries = times.clone();
        for pair in times.windows(2) {
            queries.extend((0..5).map(|_| random.between(pair[0], pair[1])));
            queries.extend([pair[0].next_up(), pair[1].next_down()]);
        }
        for t in queries {
            let (i, x) = line.locate(t);
            let searched = times.partition_point(|&key| key <= t).max(1) - 1;
            assert_eq!(i, searched.min(last), "{t}");
            assert!((0.0..=1.0).contains(&x));
        }
    }

    #[test]
    fn the_grid_finds_what_a_search_finds() {
        let mut random = Random::new(51);
        for count in [2, 3, 7, 50, 400] {
            for kind in 0..4 {
                let mut time = random.between(-10.0, 10.0);
                let times: Vec<f64> = (0..count)
                    .map(|i| {
                        time += match kind {
                            0 => 1.0,
                            1 => random.between(0.01, 3.0),
                            // Crowds and deserts.
                            2 if i % 40 == 0 => 1e6,
                            _ => 1e-6,
                        };
                        time
                    })
                    .collect();
                let keys = Keys::new(&vec![DQuat::IDENTITY; count], &times).unwrap();
                check(&keys, &mut random);
            }
        }
    }

    #[test]
    fn outside_of_the_domain() {
        let q = DQuat::IDENTITY;
        let open = Timeline::new(&Keys::new(&[q, q, q], &[1.0, 2.0, 4.0]).unwrap());
        assert_eq!(open.locate(-3.0), (0, 0.0));
        assert_eq!(open.locate(9.0), (1, 1.0));
        assert_eq!(open.locate(f64::INFINITY), (1, 1.0));
        assert_eq!(open.locate(f64::NAN), (0, 0.0));
        let closed = Timeline::new(&Keys::closed(&[q, q], &[1.0, 2.0, 4.0]).unwrap());
        assert_eq!(closed.locate(6.0), (1, 0.5));
        assert_eq!(closed.locate(0.0), (1, 0.5));
        for t in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(closed.locate(t), (0, 0.0));
        }
        assert!(closed.locate(1e300).1 <= 1.0 && closed.locate(-1e-300).1 <= 1.0);
        let one = Timeline::new(&Keys::even(&[q]).unwrap());
        assert_eq!(one.locate(7.0), (0, 0.0));
    }
}
