//! What cells ask of their neighbours: that no cell is much larger than a refined one beside it, and a closer look along the sides
//! of small ones that have such a neighbour; but for neighbours that were refined because of a crease that the deformation names.
//!
//! Every refined cell is looked at until its neighbours have been seen to, those in the first and last rows of a band by the
//! bands above and below, too.
//!
//! *Source*: balanced quadtrees are B. Von Herzen and A. H. Barr, *Accurate triangulations of deformed, intersecting surfaces*,
//! SIGGRAPH 1987; the closer look is a decision.

use super::band::{Band, PROBED, State};

/// Which cells of a band's first and last rows have been refined since the last time, for each size, by column; twice it, and one more for those that
/// were known to need it.
pub(super) struct Rims(Vec<[Vec<u32>; 2]>);

/// What came of looking at a neighbour.
#[derive(Clone, Copy)]
enum Seen {
    /// Nothing is to be done, now or later.
    Settled,
    /// It has not been decided on.
    Later,
    /// Something was changed.
    Changed,
}

impl Band<'_> {
    /// What the neighbouring bands need to know that they have not been told yet.
    pub(super) fn rims(&mut self) -> Rims {
        let rims = self.levels.iter_mut().map(|level| {
            let (across, count) = (level.across as u32, level.states.len() as u32);
            let mut rims = [Vec::new(), Vec::new()];
            for cell in level.news.drain(..) {
                let known = u32::from(level.known[cell as usize]);
                if cell < across {
                    rims[0].push(2 * cell + known);
                }
                if cell + across >= count {
                    rims[1].push(2 * (cell + across - count) + known);
                }
            }
            rims
        });
        Rims(rims.collect())
    }

    /// Quarters cells next to quartered ones, also of the bands above and below, that are more than twice as large as their
    /// quarters, and asks for a closer look at small ones next to such that are quartered or evaluated pixel by pixel. Whether
    /// there were any, or may be.
    pub(super) fn grade(&mut self, above: Option<&Rims>, below: Option<&Rims>) -> bool {
        let mut open = false;
        for level in (0..self.levels.len()).rev() {
            let rows = self.levels[level].states.len() / self.levels[level].across;
            for (number, rims, row) in [(0, above, 0), (1, below, rows - 1)] {
                let mut beyond = core::mem::take(&mut self.levels[level].beyond[number]);
                if let Some(rims) = rims {
                    beyond.extend(&rims.0[level][1 - number]);
                }
                beyond.retain(|&cell| {
                    let place = (cell as usize / 2, row);
                    self.grade_beyond(level, place, number, cell % 2 == 1)
                });
                open |= !beyond.is_empty();
                self.levels[level].beyond[number] = beyond;
            }
            let mut cells = core::mem::take(&mut self.levels[level].ungraded);
            cells.retain(|&cell| self.grade_cell(level, cell as usize));
            open |= !cells.is_empty();
            self.levels[level].ungraded = cells;
        }
        open
    }

    /// The level of the cells that must be beside refined ones of a level: next to pixels there may be cells of twice the
    /// smallest size.
    fn beside(&self, level: usize) -> usize {
        if level + 1 == self.levels.len() {
            level.saturating_sub(1)
        } else {
            level
        }
    }

    /// Sees to the neighbours of a refined cell of the band above (0) or below (1). Whether it must be looked at again.
    fn grade_beyond(
        &mut self,
        level: usize,
        (column, row): (usize, usize),
        side: usize,
        known: bool,
    ) -> bool {
        let least = self.beside(level);
        let shift = level - least;
        let across = self.levels[level].across;
        let mut again = false;
        for x in column.saturating_sub(1)..(column + 2).min(across) {
            again |= self.present(least, x >> shift, row >> shift);
        }
        if self.levels[level].size <= PROBED && !known {
            again |= !matches!(self.expose(level, column, row, side), Seen::Settled);
        }
        again
    }

    /// Sees to the neighbours of a refined cell. Whether it must be looked at again.
    fn grade_cell(&mut self, level: usize, cell: usize) -> bool {
        let least = self.beside(level);
        let shift = level - least;
        let across = self.levels[level].across;
        let rows = self.levels[level].states.len() / across;
        let (column, row) = (cell % across, cell / across);
        let mut again = false;
        for y in row.saturating_sub(1)..(row + 2).min(rows) {
            for x in column.saturating_sub(1)..(column + 2).min(across) {
                again |= self.present(least, x >> shift, y >> shift);
            }
        }
        if self.levels[level].size <= PROBED && !self.levels[level].known[cell] {
            let (up, left) = (row.checked_sub(1), column.checked_sub(1));
            let (down, right) = (row + 1, column + 1);
            let sides = [
                (Some(column), up, 1),
                (Some(column), (down < rows).then_some(down), 0),
                (left, Some(row), 3),
                ((right < across).then_some(right), Some(row), 2),
            ];
            for (x, y, side) in sides {
                if let (Some(x), Some(y)) = (x, y) {
                    again |= !matches!(self.expose(level, x, y, side), Seen::Settled);
                }
            }
        }
        again
    }

    /// Asks for a closer look at a cell along a side, or at the larger one in its place.
    fn expose(&mut self, level: usize, column: usize, row: usize, side: usize) -> Seen {
        let cells = &mut self.levels[level];
        let cell = row * cells.across + column;
        match cells.states[cell] {
            State::Absent if level > 0 => self.expose(level - 1, column / 2, row / 2, side),
            State::Fresh => Seen::Later,
            state if state.is_estimated() && cells.size <= PROBED => {
                if cells.probes[cell] >> side & 1 == 1 {
                    return Seen::Settled;
                }
                cells.probes[cell] |= 1 << side;
                cells.exposed.push(cell as u32);
                Seen::Changed
            }
            _ => Seen::Settled,
        }
    }

    /// Sees to it that there is a cell of that size at a place, unless it is known to be good. Whether that changed anything.
    fn present(&mut self, level: usize, column: usize, row: usize) -> bool {
        let across = self.levels[level].across;
        if level == 0 || self.levels[level].states[row * across + column] != State::Absent {
            return false;
        }
        let mut changed = self.present(level - 1, column / 2, row / 2);
        let parents = &self.levels[level - 1];
        let parent = row / 2 * parents.across + column / 2;
        if parents.states[parent].is_estimated() {
            self.quarter(level - 1, parent);
            changed = true;
        }
        changed
    }
}
