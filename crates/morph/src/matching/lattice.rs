//! The cheapest way through the lattice of pairs of samples, with given ends or around a cycle.
//!
//! A node `(i, j)` pairs sample `i` of one outline with sample `j` of the other; a step goes on by one in one outline or in
//! both. With given ends one pass over the lattice finds the best way. Around a cycle the start `(0, k)` is free, and the way ends at
//! `(m, n + k)`. Best ways from different starts need not cross, since where they meet either may go on as the other; so the
//! best way from a start between two others stays between theirs, and halving the starts again and again costs
//! `m · n · log n` in all and loses nothing. Nor does passing over a range of starts of which even a way that may begin at one
//! and end at another costs more than the best known.
//!
//! *Source*: T. Sederberg and E. Greenwood, *A Physically Based Approach to 2-D Shape Blending*, SIGGRAPH 1992 (the lattice, and
//! work of stretching and bending); M. Maes, *On a Cyclic String-to-String Correction Problem*, Information Processing
//! Letters 35, 1990 (halving the starts).

use super::outline::FEATURES;

/// The samples of one outline, or of a piece of one.
#[derive(Debug)]
pub(super) struct Track {
    /// How far each sample is from the one before; there is one more sample than gaps.
    pub(super) gaps: Vec<f64>,
    /// What describes each sample; around a cycle the last is the first again.
    pub(super) features: Vec<[f32; FEATURES]>,
    /// How sharply the outline turns there, weighted so that the square is what passing it alone costs.
    pub(super) corners: Vec<f32>,
}

/// A way: in each row the first and the last column that it passes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Way {
    rows: Vec<(u32, u32)>,
    /// What its steps cost together.
    pub(super) cost: f64,
}

impl Way {
    /// All its nodes, in order.
    pub(super) fn nodes(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let rows = self.rows.iter().enumerate();
        rows.flat_map(|(i, &(first, last))| (first..=last).map(move |j| (i, j as usize)))
    }

    /// The column in which it starts.
    pub(super) fn start(&self) -> usize {
        self.rows[0].0 as usize
    }

    fn shifted(&self, by: usize) -> Self {
        let by = by as u32;
        Self {
            rows: self.rows.iter().map(|&(a, b)| (a + by, b + by)).collect(),
            cost: self.cost,
        }
    }
}

/// Where a step into a node came from: both outlines went on.
const BOTH: u8 = 0;
/// The second outline alone went on, whatever the other bits say; the lowest bit says that the first alone did.
const SECOND: u8 = 2;

/// Whether the best way among so many starts is bounded before it is looked for: among more the bound says little, and at
/// every halving it would cost as much as looking.
fn bounded(starts: usize) -> bool {
    matches!(starts, 33..=64 | 9..=16)
}
/// Every so many samples make the coarse track, which guesses where a way starts.
pub(super) const COARSE: usize = 4;
/// A better way than by this share is not looked for.
const ROUNDING: f64 = 1e-9;

impl Track {
    /// About a quarter of the samples.
    pub(super) fn coarse(&self) -> Self {
        let last = self.gaps.len();
        let kept: Vec<usize> = (0..last).step_by(COARSE).chain([last]).collect();
        Self {
            gaps: kept
                .windows(2)
                .map(|pair| self.gaps[pair[0]..pair[1]].iter().sum())
                .collect(),
            features: kept.iter().map(|&k| self.features[k]).collect(),
            corners: kept.iter().map(|&k| self.corners[k]).collect(),
        }
    }
}

/// What steps cost.
#[derive(Debug)]
pub(super) struct Lattice {
    /// Gaps of the rows.
    m: usize,
    /// Gaps of the columns.
    n: usize,
    /// Columns kept; around a cycle column `n` is column 0.
    columns: usize,
    cyclic: bool,
    /// How bending differs at each node.
    bending: Vec<f32>,
    /// What the step in both costs that ends there.
    both: Vec<f32>,
    /// The step in one outline costs the first number, and the second times the bending, by where it ends.
    row_step: Vec<[f64; 2]>,
    column_step: Vec<[f64; 2]>,
}

/// What a pass over the lattice works in.
#[derive(Debug, Default)]
struct Memory {
    cost: Vec<f64>,
    before: Vec<f64>,
    aside: Vec<f64>,
    came: Vec<u8>,
    offsets: Vec<usize>,
}

impl Lattice {
    pub(super) fn new(rows: &Track, columns: &Track, stretching: f64, cyclic: bool) -> Self {
        let (m, n) = (rows.gaps.len(), columns.gaps.len());
        let kept = if cyclic { n } else { n + 1 };
        let mut bending = vec![0.0_f32; (m + 1) * kept];
        let mut both = vec![0.0_f32; (m + 1) * kept];
        // The gap before a column; around a cycle column 0 has one.
        let before: Vec<f64> = (0..kept)
            .map(|j| match j {
                0 if cyclic => columns.gaps[n - 1],
                0 => 0.0,
                _ => columns.gaps[j - 1],
            })
            .collect();
        let corner = |track: &Track, k: usize| f64::from(track.corners[k]);
        let transposed: Vec<Vec<f32>> = (0..FEATURES)
            .map(|k| columns.features[..kept].iter().map(|f| f[k]).collect())
            .collect();
        for i in 0..=m {
            let row = &mut bending[i * kept..(i + 1) * kept];
            for (k, column) in transposed.iter().enumerate() {
                let own = rows.features[i][k];
                for (sum, other) in row.iter_mut().zip(column) {
                    let difference = own - other;
                    *sum += difference * difference;
                }
            }
            if i == 0 {
                continue;
            }
            let (gap, sharp) = (rows.gaps[i - 1], corner(rows, i));
            let into = &mut both[i * kept..(i + 1) * kept];
            for (j, (into, bent)) in into.iter_mut().zip(row).enumerate() {
                let (sum, difference) = (gap + before[j], gap - before[j]);
                let stretched = stretching * difference * difference / sum;
                let turned = sharp - corner(columns, j);
                *into = (f64::from(*bent) * sum * 0.5 + stretched + turned * turned) as f32;
            }
        }
        let step = |gap: f64, corner: f64| [stretching * gap + corner * corner, gap * 0.5];
        let row_step = (0..=m)
            .map(|i| match i {
                0 => [0.0; 2],
                _ => step(rows.gaps[i - 1], corner(rows, i)),
            })
            .collect();
        let column_step = (0..kept)
            .map(|j| step(before[j], corner(columns, j)))
            .collect();
        Self {
            m,
            n,
            columns: kept,
            cyclic,
            bending,
            both,
            row_step,
            column_step,
        }
    }

    /// How bending differs at a node.
    pub(super) fn bending(&self, i: usize, j: usize) -> f64 {
        let j = if self.cyclic { j % self.n } else { j };
        f64::from(self.bending[i * self.columns + j])
    }

    /// The best way from `(0, start)` to `(m, start + n)` between two others.
    fn between(&self, start: usize, bounds: Option<(&Way, &Way)>, memory: &mut Memory) -> Way {
        let (m, end) = (self.m, start + self.n);
        let window = |i: usize| match bounds {
            None => (start, end),
            Some((below, above)) => {
                let (low, high) = (below.rows[i].0 as usize, above.rows[i].1 as usize);
                (low.max(start), high.min(end))
            }
        };
        self.pass(start, start, window, memory);
        let cost = memory.cost[self.n];

        // From the end back.
        let mut rows = vec![(0_u32, 0_u32); m + 1];
        let mut j = end;
        for i in (0..=m).rev() {
            let (low, _) = window(i);
            let step = |j: usize| memory.came[memory.offsets[i] + j - low];
            let last = j;
            while j > low && step(j) & SECOND != 0 {
                j -= 1;
            }
            rows[i] = (j as u32, last as u32);
            if i > 0 && step(j) == BOTH {
                j -= 1;
            }
        }
        Way { rows, cost }
    }

    /// No way that begins between two starts, whose best ways are given, costs less: it may end where any of them does.
    fn bound(&self, low: (usize, &Way), high: (usize, &Way), memory: &mut Memory) -> f64 {
        let window = |i: usize| (low.1.rows[i].0 as usize, high.1.rows[i].1 as usize);
        self.pass(low.0, high.0, window, memory);
        let ends = &memory.cost[self.n..=self.n + high.0 - low.0];
        ends.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// What the best ways cost that begin in row 0 anywhere from `start` to `last`, to each column of row `m`, within
    /// windows that only move on.
    fn pass(
        &self,
        start: usize,
        last: usize,
        window: impl Fn(usize) -> (usize, usize),
        memory: &mut Memory,
    ) {
        let (m, n) = (self.m, self.n);
        let most = n + 1 + last - start;
        let Memory {
            cost,
            before,
            aside,
            came,
            offsets,
        } = memory;
        // Costs by column from `start`.
        cost.clear();
        cost.resize(most, f64::INFINITY);
        before.resize(most, 0.0);
        aside.resize(most, 0.0);
        came.clear();
        offsets.clear();
        let mut low_before = start;
        for i in 0..=m {
            let (low, high) = window(i);
            let width = high + 1 - low;
            let first = low - start;
            offsets.push(came.len());
            came.resize(came.len() + width, BOTH);
            let came = &mut came[offsets[i]..];
            let old = &cost[first..first + width];
            let mut corner = f64::INFINITY;
            if low > low_before {
                corner = cost[first - 1];
            }
            // What does not depend on the neighbour in the same row; around a cycle in stretches.
            let mut done = 0;
            while done < width {
                let column = low + done;
                let column = if self.cyclic { column % n } else { column };
                let span = done..width.min(done + self.columns - column);
                let cells = column..column + span.len();
                let row = i * self.columns;
                let bent = &self.bending[row + cells.start..row + cells.end];
                let steps = &self.column_step[cells.clone()];
                for ((aside, bent), [plain, share]) in
                    aside[span.clone()].iter_mut().zip(bent).zip(steps)
                {
                    *aside = plain + share * f64::from(*bent);
                }
                if i > 0 {
                    let both = &self.both[row + cells.start..row + cells.end];
                    self.enter(i, &old[span.clone()], corner, (bent, both), {
                        (&mut before[span.clone()], &mut came[span.clone()])
                    });
                    corner = old[span.end - 1];
                }
                done = span.end;
            }
            if i == 0 {
                before[..width].fill(f64::INFINITY);
                before[..=last - start].fill(0.0);
            }
            // Along the row.
            let mut left = f64::INFINITY;
            let costs = cost[first..first + width].iter_mut().zip(came);
            for ((cost, came), (before, aside)) in costs.zip(before.iter().zip(aside.iter())) {
                let along = left + aside;
                // Without branches: which it is cannot be foreseen.
                *came |= u8::from(along < *before) << 1;
                left = choose(*before, along);
                *cost = left;
            }
            low_before = low;
        }
    }

    /// What it costs to enter neighbouring nodes of row `i` from the row before, whose costs are `old` and, one column
    /// earlier, `corner`.
    #[inline(always)]
    fn enter(
        &self,
        i: usize,
        old: &[f64],
        corner: f64,
        (bent, both): (&[f32], &[f32]),
        (before, came): (&mut [f64], &mut [u8]),
    ) {
        let [plain, share] = self.row_step[i];
        let mut node = |c: usize, diagonal: f64| {
            let diagonal = diagonal + f64::from(both[c]);
            let upright = old[c] + (plain + share * f64::from(bent[c]));
            came[c] = u8::from(upright < diagonal);
            before[c] = choose(diagonal, upright);
        };
        node(0, corner);
        for c in 1..old.len() {
            node(c, old[c - 1]);
        }
    }

    /// The best way with given ends.
    pub(super) fn open(&self) -> Way {
        self.between(0, None, &mut Memory::default())
    }

    /// The best way around a cycle, over all starts. `guess` is where it may start: the nearer, the fewer are looked at.
    pub(super) fn around(&self, guess: usize) -> Way {
        let mut memory = Memory::default();
        let first = self.between(guess, None, &mut memory);
        let last = first.shifted(self.n);
        let mut best = (first.clone(), guess);
        // Starts between two whose ways are known; those next to cheaper ways first.
        let mut ranges = vec![(guess, first, guess + self.n, last)];
        while let Some((low, below, high, above)) = ranges.pop() {
            if high - low < 2 {
                continue;
            }
            if bounded(high - low) {
                let bound = self.bound((low, &below), (high, &above), &mut memory);
                if bound >= best.0.cost * (1.0 - ROUNDING) {
                    continue;
                }
            }
            let start = low + (high - low) / 2;
            let way = self.between(start, Some((&below, &above)), &mut memory);
            if (way.cost, start) < (best.0.cost, best.1) {
                best = (way.clone(), start);
            }
            let lower = (low, below, start, way.clone());
            let upper = (start, way, high, above);
            if lower.1.cost <= upper.3.cost {
                ranges.extend([upper, lower]);
            } else {
                ranges.extend([lower, upper]);
            }
        }
        best.0
    }
}

/// The smaller; the first where they are equal.
#[inline(always)]
fn choose(first: f64, second: f64) -> f64 {
    if second < first { second } else { first }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers that look random.
    fn track(gaps: usize, cyclic: bool, seed: &mut u64) -> Track {
        let mut next = || {
            *seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (*seed >> 40) as f32 / (1_u64 << 24) as f32
        };
        let mut features: Vec<[f32; FEATURES]> = (0..=gaps)
            .map(|_| core::array::from_fn(|_| next()))
            .collect();
        if cyclic {
            features[gaps] = features[0];
        }
        let corners = features.iter().map(|f| f[1] * 0.1).collect();
        let gaps = (0..gaps).map(|_| f64::from(next()) + 0.1).collect();
        Track {
            gaps,
            features,
            corners,
        }
    }

    #[test]
    fn halving_finds_what_trying_all_starts_finds() {
        let mut seed = 1;
        for (m, n) in [(1, 1), (1, 7), (7, 1), (5, 9), (12, 6), (20, 31), (40, 40)] {
            for _ in 0..10 {
                let (rows, columns) = (track(m, true, &mut seed), track(n, true, &mut seed));
                let lattice = Lattice::new(&rows, &columns, 0.3, true);
                let best = lattice.around(n / 3);
                let mut memory = Memory::default();
                let tried = (0..n).map(|k| lattice.between(k, None, &mut memory).cost);
                let least = tried.fold(f64::INFINITY, f64::min);
                assert!((best.cost - least).abs() < 1e-9, "{m} {n}");
                let nodes: Vec<_> = best.nodes().collect();
                assert_eq!(nodes[nodes.len() - 1], (m, nodes[0].1 + n));
            }
        }
    }

    #[test]
    fn a_way_costs_what_its_steps_cost() {
        let mut seed = 5;
        let (rows, columns) = (track(17, false, &mut seed), track(23, false, &mut seed));
        let lattice = Lattice::new(&rows, &columns, 0.3, false);
        let way = lattice.open();
        let nodes: Vec<_> = way.nodes().collect();
        let mut cost = 0.0;
        for pair in nodes.windows(2) {
            let [(a, b), (i, j)] = [pair[0], pair[1]];
            assert!(i - a <= 1 && j - b <= 1 && i + j > a + b);
            let p = if i > a { rows.gaps[a] } else { 0.0 };
            let q = if j > b { columns.gaps[b] } else { 0.0 };
            cost += lattice.bending(i, j) * (p + q) * 0.5 + 0.3 * (p - q) * (p - q) / (p + q);
            let one = if i > a { rows.corners[i] } else { 0.0 };
            let other = if j > b { columns.corners[j] } else { 0.0 };
            cost += f64::from((one - other) * (one - other));
        }
        assert!((cost - way.cost).abs() < 1e-5, "{cost} {}", way.cost);
    }
}
