//! A few rows of the coarsest cells with all that becomes of them: what one thread works on.

use super::coarse::{Coarse, jacobian, push_neighbours};
use super::knowledge::{Knowledge, Verdict};
use super::patch::{Patch, rounding};
use super::{FINEST, Hierarchy, HierarchyReport};
use crate::Window;
use anamorph_core::glam::{DMat2, DVec2};
use anamorph_core::{Deformation, Plane};

/// Rows of pixels in a band. More would share more evaluations between rows of cells, fewer give more to share out among
/// threads.
const ROWS: usize = 64;
/// Distance of the places at which evaluations may be kept: half of the smallest cells.
const GRAIN: usize = FINEST / 2;
/// Pixels that are evaluated together.
const RUN: usize = 4096;
/// No evaluation yet.
const NONE: u32 = 0;

/// What became of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// Its larger cell was not quartered.
    Absent,
    /// Not looked at yet.
    Fresh,
    /// Outside the picture.
    Void,
    Still,
    Derived,
    Estimated,
    /// Estimated, and made to agree with the middles of its edges and its own.
    Bulged,
    /// Quartered; the smallest ones evaluated pixel by pixel.
    Refined,
}

impl State {
    fn is_estimated(self) -> bool {
        matches!(self, Self::Estimated | Self::Bulged)
    }
}

/// Cells of one size.
struct Cells {
    size: usize,
    across: usize,
    states: Vec<State>,
    /// The largest error that was found in each.
    errors: Vec<f64>,
    /// Sides along which each is to be probed, and, four bits higher, has been.
    probes: Vec<u8>,
}

/// Largest size of cells whose sides are probed.
const PROBED: usize = 8;
/// Pixels along a side that are probed; of smaller cells those that there are.
const PROBES: [usize; 4] = [1, 3, 5, 7];
/// What may be missing in the middles of a cell that is made to agree with them, in allowed errors: so little that what the checks
/// between them do not see, a crease across a middle, stays within about one.
const BULGE: f64 = 2.0;

/// What all bands work on.
pub(super) struct Work<'a> {
    pub(super) deformation: &'a dyn Deformation<Plane>,
    pub(super) window: Window,
    pub(super) options: &'a Hierarchy,
    pub(super) knowledge: &'a Knowledge,
    pub(super) coarse: &'a Coarse,
}

/// The places of a cell's checks, in quarters of it: the middles, and between them. Cells of 8 pixels are checked between the middles
/// only if those are nearly good enough, smaller ones in the middles alone: their sides are looked at more closely where a
/// neighbour gives cause.
const CHECKS: [(usize, usize); 9] = [
    (2, 0),
    (2, 4),
    (0, 2),
    (4, 2),
    (2, 2),
    (1, 1),
    (3, 1),
    (1, 3),
    (3, 3),
];

/// The pixel along a side of a cell: 0 the upper, 1 the lower, 2 the left, 3 the right one.
fn beside(size: usize, side: usize, step: usize) -> (usize, usize) {
    match side {
        0 => (step, 0),
        1 => (step, size - 1),
        2 => (0, step),
        _ => (size - 1, step),
    }
}

/// How many places along a side are probed.
fn probes(size: usize) -> usize {
    size / 2
}

/// A band. Coordinates are pixels from the window's left and the band's top.
pub(super) struct Band<'a> {
    work: &'a Work<'a>,
    top: usize,
    /// The picture's width, filled up to whole cells.
    width: usize,
    levels: Vec<Cells>,
    /// Numbers of the kept evaluations, from 1, by place.
    value_at: Vec<u32>,
    values: Vec<DVec2>,
    jacobian_at: Vec<u32>,
    jacobians: Vec<DMat2>,
    /// Where evaluations and Jacobians are asked for or kept, in the order of their numbers.
    value_places: Vec<(usize, usize)>,
    jacobian_places: Vec<(usize, usize)>,
    points: Vec<DVec2>,
    todo: Vec<(usize, usize)>,
    again: Vec<(usize, usize)>,
    report: HierarchyReport,
}

/// Which cells of a band's first and last rows are refined, for each size.
pub(super) struct Rims(Vec<[Vec<bool>; 2]>);

/// The checks of a cell before anything is known of it.
fn checks(size: usize) -> &'static [(usize, usize)] {
    if size <= PROBED {
        &CHECKS[..5]
    } else {
        &CHECKS
    }
}

impl<'a> Band<'a> {
    /// Rows of pixels in a band: a whole number of cells of every size.
    pub(super) const ROWS: usize = ROWS;

    pub(super) fn new(work: &'a Work<'a>, number: usize) -> Self {
        let coarsest = work.options.coarsest;
        let width = work.window.width().next_multiple_of(coarsest);
        let sizes = core::iter::successors(Some(coarsest), |size| Some(size / 2));
        let levels = sizes
            .take_while(|&size| size >= FINEST)
            .map(|size| {
                let start = if size == coarsest {
                    State::Fresh
                } else {
                    State::Absent
                };
                let count = width / size * (ROWS / size);
                Cells {
                    size,
                    across: width / size,
                    states: vec![start; count],
                    errors: vec![0.0; count],
                    probes: vec![0; count],
                }
            })
            .collect();
        let places = |distance: usize| (width / distance + 1) * (ROWS / distance + 1);
        Self {
            work,
            top: number * ROWS,
            width,
            levels,
            value_at: vec![NONE; places(GRAIN)],
            values: Vec::new(),
            jacobian_at: vec![NONE; places(FINEST)],
            jacobians: Vec::new(),
            value_places: Vec::new(),
            jacobian_places: Vec::new(),
            points: Vec::new(),
            todo: Vec::new(),
            again: Vec::new(),
            report: HierarchyReport::NOTHING,
        }
    }

    fn value_slot(&self, x: usize, y: usize) -> usize {
        y / GRAIN * (self.width / GRAIN + 1) + x / GRAIN
    }
    fn jacobian_slot(&self, x: usize, y: usize) -> usize {
        y / FINEST * (self.width / FINEST + 1) + x / FINEST
    }

    /// Decides on all cells that are fresh.
    pub(super) fn decide(&mut self) {
        for level in 0..self.levels.len() {
            self.settle(level);
        }
        for level in 0..self.levels.len() {
            if self.levels[level].size <= PROBED {
                self.probe(level);
                // What was quartered then.
                if level + 1 < self.levels.len() {
                    self.settle(level + 1);
                }
            }
        }
    }

    /// What the neighbouring bands need to know.
    pub(super) fn rims(&self) -> Rims {
        let refined = |states: &[State]| states.iter().map(|&s| s == State::Refined).collect();
        let rims = self.levels.iter().map(|level| {
            let last = level.states.len() - level.across;
            [
                refined(&level.states[..level.across]),
                refined(&level.states[last..]),
            ]
        });
        Rims(rims.collect())
    }

    /// How much of a cell is in the picture.
    fn visible(&self, x: usize, y: usize, size: usize) -> (usize, usize) {
        let columns = self.work.window.width().saturating_sub(x).min(size);
        let rows = self
            .work
            .window
            .height()
            .saturating_sub(self.top + y)
            .min(size);
        (columns, rows)
    }

    /// Decides on all fresh cells of a size.
    fn settle(&mut self, level: usize) {
        let Cells { size, across, .. } = self.levels[level];
        let mut todo = core::mem::take(&mut self.todo);
        todo.clear();
        for cell in 0..self.levels[level].states.len() {
            if self.levels[level].states[cell] != State::Fresh {
                continue;
            }
            let (x, y) = (cell % across * size, cell / across * size);
            let (columns, rows) = self.visible(x, y, size);
            let state = if columns == 0 || rows == 0 {
                State::Void
            } else {
                match self.work.knowledge.verdict(x, self.top + y, size) {
                    Verdict::Still => State::Still,
                    Verdict::Derived => {
                        self.ask_corners(x, y, size);
                        State::Derived
                    }
                    Verdict::Refine => {
                        self.quarter(level, cell);
                        State::Refined
                    }
                    Verdict::Ask => {
                        self.ask_all(x, y, size);
                        todo.push((x, y));
                        State::Fresh
                    }
                }
            };
            self.levels[level].states[cell] = state;
        }
        self.evaluate();
        let mut again = core::mem::take(&mut self.again);
        again.clear();
        for &(x, y) in &todo {
            let patch = self.patch(x, y, size);
            let error = self.deviation(&patch, x, y, size, checks(size));
            // The smallest cells are next to what no cell serves: there the middles alone count twice.
            let counted = if size == FINEST { 2.0 * error } else { error };
            if self.accepts(&patch, counted) {
                self.accept(level, (x, y), State::Estimated, error);
                continue;
            }
            let nearly = size > FINEST
                && self.bulged(x, y, size).largest_bubble() * self.work.options.safety
                    <= BULGE * self.work.options.max_error;
            if nearly {
                again.push((x, y));
                if size <= PROBED {
                    for &(i, j) in &CHECKS[5..] {
                        self.ask_value(x + i * size / 4, y + j * size / 4);
                    }
                }
            } else {
                self.refine(level, (x, y));
            }
        }
        self.evaluate();
        for &(x, y) in &again {
            let patch = self.bulged(x, y, size);
            let error = self.deviation(&patch, x, y, size, &CHECKS[5..]);
            if self.accepts(&patch, error) {
                self.accept(level, (x, y), State::Bulged, error);
            } else {
                self.refine(level, (x, y));
            }
        }
        self.again = again;
        self.todo = todo;
    }

    /// The number of the cell of a level that begins there.
    fn cell(&self, level: usize, (x, y): (usize, usize)) -> usize {
        let Cells { size, across, .. } = self.levels[level];
        y / size * across + x / size
    }

    fn accept(&mut self, level: usize, place: (usize, usize), state: State, error: f64) {
        let cell = self.cell(level, place);
        self.levels[level].states[cell] = state;
        self.levels[level].errors[cell] = error;
    }

    fn refine(&mut self, level: usize, place: (usize, usize)) {
        let cell = self.cell(level, place);
        self.levels[level].states[cell] = State::Refined;
        self.quarter(level, cell);
    }

    /// Makes the quarters of a cell fresh.
    fn quarter(&mut self, level: usize, cell: usize) {
        let across = self.levels[level].across;
        let (column, row) = (cell % across, cell / across);
        if let Some(finer) = self.levels.get_mut(level + 1) {
            for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let child = (2 * row + y) * finer.across + 2 * column + x;
                if finer.states[child] == State::Absent {
                    finer.states[child] = State::Fresh;
                }
            }
        }
    }

    /// Looks closer at small cells next to such that are quartered or evaluated pixel by pixel: along the common side, where what made
    /// that necessary there may reach a little way in.
    fn probe(&mut self, level: usize) {
        let Cells { size, across, .. } = self.levels[level];
        let mut cells = core::mem::take(&mut self.todo);
        let mut points = core::mem::take(&mut self.points);
        cells.clear();
        points.clear();
        let steps = &PROBES[..probes(size)];
        for cell in 0..self.levels[level].states.len() {
            let sides = self.levels[level].probes[cell];
            let sides = sides & !(sides >> 4) & 15;
            if sides == 0 || !self.levels[level].states[cell].is_estimated() {
                continue;
            }
            self.levels[level].probes[cell] |= sides << 4;
            let (x, y) = (cell % across * size, cell / across * size);
            for side in (0..4).filter(|side| sides >> side & 1 == 1) {
                cells.push((cell, side));
                let places = steps.iter().map(|&step| beside(size, side, step));
                points.extend(places.map(|(i, j)| self.place((x + i, y + j))));
            }
        }
        let _ = self.work.deformation.map_points(0, &mut points);
        self.report.evaluations += points.len();
        for (&(cell, side), moved) in cells.iter().zip(points.chunks_exact(steps.len())) {
            let (x, y) = (cell % across * size, cell / across * size);
            // Another side may have decided already.
            let state = self.levels[level].states[cell];
            if !state.is_estimated() {
                continue;
            }
            let patch = self.chosen(state, x, y, size);
            let mut largest = self.levels[level].errors[cell];
            for (&step, moved) in steps.iter().zip(moved) {
                let (i, j) = beside(size, side, step);
                let share = |i: usize| i as f64 / size as f64;
                let exact = *moved - self.place((x + i, y + j));
                let error = patch.value(share(i), share(j)).distance(exact);
                if error > largest || error.is_nan() {
                    largest = error;
                }
            }
            self.levels[level].errors[cell] = largest;
            if !self.accepts(&patch, largest) {
                self.refine(level, (x, y));
            }
        }
        self.todo = cells;
        self.points = points;
    }

    fn accepts(&self, patch: &Patch, error: f64) -> bool {
        let options = self.work.options;
        error * options.safety + patch.rounding() <= options.max_error
    }

    /// Asks for a closer look at a cell along a side, or at the larger one in its place. Whether nobody has asked before.
    fn expose(&mut self, level: usize, column: usize, row: usize, side: usize) -> bool {
        let cells = &mut self.levels[level];
        let cell = row * cells.across + column;
        match cells.states[cell] {
            State::Absent if level > 0 => self.expose(level - 1, column / 2, row / 2, side),
            state if state.is_estimated() && cells.size <= PROBED => {
                let fresh = cells.probes[cell] >> side & 1 == 0;
                cells.probes[cell] |= 1 << side;
                fresh
            }
            _ => false,
        }
    }

    /// Quarters cells next to quartered ones, also of the bands above and below, that are more than twice as large as their
    /// quarters, and asks for a closer look at small ones next to such that are quartered or evaluated pixel by pixel. Whether there
    /// were any.
    pub(super) fn grade(&mut self, above: Option<&Rims>, below: Option<&Rims>) -> bool {
        let mut changed = false;
        let last = self.levels.len() - 1;
        for level in (0..=last).rev() {
            let across = self.levels[level].across;
            let rows = self.levels[level].states.len() / across;
            let near = |column: usize| column.saturating_sub(1)..(column + 2).min(across);
            // Next to pixels there may be cells of twice the smallest size.
            let least = if level == last {
                level.saturating_sub(1)
            } else {
                level
            };
            let shift = level - least;
            let small = self.levels[level].size <= PROBED;
            for (rims, side, row) in [(above, 1, 0), (below, 0, rows - 1)] {
                let Some(rims) = rims else { continue };
                for column in (0..across).filter(|&column| rims.0[level][side][column]) {
                    for x in near(column) {
                        changed |= self.present(least, x >> shift, row >> shift);
                    }
                    changed |= small && self.expose(level, column, row, 1 - side);
                }
            }
            for cell in 0..across * rows {
                if self.levels[level].states[cell] != State::Refined {
                    continue;
                }
                let (column, row) = (cell % across, cell / across);
                for y in row.saturating_sub(1)..(row + 2).min(rows) {
                    for x in near(column) {
                        changed |= self.present(least, x >> shift, y >> shift);
                    }
                }
                if small {
                    let (up, left) = (row.checked_sub(1), column.checked_sub(1));
                    changed |= up.is_some_and(|up| self.expose(level, column, up, 1));
                    changed |= row + 1 < rows && self.expose(level, column, row + 1, 0);
                    changed |= left.is_some_and(|left| self.expose(level, left, row, 3));
                    changed |= column + 1 < across && self.expose(level, column + 1, row, 2);
                }
            }
        }
        changed
    }

    /// Sees to it that there is a cell of that size at a place, unless it is known to be good. Whether that changed anything.
    fn present(&mut self, level: usize, column: usize, row: usize) -> bool {
        let Cells { across, states, .. } = &self.levels[level];
        if level == 0 || states[row * across + column] != State::Absent {
            return false;
        }
        let mut changed = self.present(level - 1, column / 2, row / 2);
        let parents = &mut self.levels[level - 1];
        let parent = row / 2 * parents.across + column / 2;
        if parents.states[parent].is_estimated() {
            parents.states[parent] = State::Refined;
            self.quarter(level - 1, parent);
            changed = true;
        }
        changed
    }

    fn corners(x: usize, y: usize, size: usize) -> [(usize, usize); 4] {
        [(x, y), (x + size, y), (x, y + size), (x + size, y + size)]
    }

    fn ask_corners(&mut self, x: usize, y: usize, size: usize) {
        for (x, y) in Self::corners(x, y, size) {
            self.ask_value(x, y);
        }
    }

    fn ask_all(&mut self, x: usize, y: usize, size: usize) {
        for (x, y) in Self::corners(x, y, size) {
            self.ask_value(x, y);
            self.ask_jacobian(x, y);
        }
        for &(i, j) in checks(size) {
            self.ask_value(x + i * size / 4, y + j * size / 4);
        }
    }

    fn ask_value(&mut self, x: usize, y: usize) {
        let slot = self.value_slot(x, y);
        if self.value_at[slot] == NONE && self.work.coarse.value(x, self.top + y).is_none() {
            self.value_at[slot] = self.value_places.len() as u32 + 1;
            self.value_places.push((x, y));
        }
    }

    fn ask_jacobian(&mut self, x: usize, y: usize) {
        let slot = self.jacobian_slot(x, y);
        if self.jacobian_at[slot] == NONE && self.work.coarse.jacobian(x, self.top + y).is_none() {
            self.jacobian_at[slot] = self.jacobian_places.len() as u32 + 1;
            self.jacobian_places.push((x, y));
        }
    }

    fn value(&self, x: usize, y: usize) -> DVec2 {
        let number = self.value_at[self.value_slot(x, y)] as usize;
        match self.values.get(number.wrapping_sub(1)) {
            Some(value) => *value,
            None => self
                .work
                .coarse
                .value(x, self.top + y)
                .unwrap_or(DVec2::NAN),
        }
    }

    fn jacobian(&self, x: usize, y: usize) -> DMat2 {
        let number = self.jacobian_at[self.jacobian_slot(x, y)] as usize;
        match self.jacobians.get(number.wrapping_sub(1)) {
            Some(jacobian) => *jacobian,
            None => self
                .work
                .coarse
                .jacobian(x, self.top + y)
                .unwrap_or(DMat2::NAN),
        }
    }

    fn place(&self, (x, y): (usize, usize)) -> DVec2 {
        self.work.window.centre(x, self.top + y)
    }

    /// Evaluates what has been asked for.
    fn evaluate(&mut self) {
        let mut points = core::mem::take(&mut self.points);
        points.clear();
        let known = self.values.len();
        let measured = self.jacobians.len();
        for &place in &self.value_places[known..] {
            points.push(self.place(place));
        }
        let fresh = points.len();
        for &place in &self.jacobian_places[measured..] {
            push_neighbours(self.place(place), &mut points);
        }
        if !points.is_empty() {
            let _ = self.work.deformation.map_points(0, &mut points);
            self.report.evaluations += points.len();
        }
        for (i, moved) in points[..fresh].iter().enumerate() {
            let place = self.place(self.value_places[known + i]);
            self.values.push(*moved - place);
        }
        let (pairs, _) = points[fresh..].as_chunks::<2>();
        for (i, pair) in pairs.iter().enumerate() {
            let (x, y) = self.jacobian_places[measured + i];
            let slope = jacobian(self.place((x, y)), self.value(x, y), *pair);
            self.jacobians.push(slope);
        }
        self.points = points;
    }

    fn patch(&self, x: usize, y: usize, size: usize) -> Patch {
        let corners = Self::corners(x, y, size);
        let values = corners.map(|(x, y)| self.value(x, y));
        let jacobians = corners.map(|(x, y)| self.jacobian(x, y));
        Patch::new(values, jacobians, size)
    }

    /// The patch that agrees with the middles, too.
    fn bulged(&self, x: usize, y: usize, size: usize) -> Patch {
        let middle = |(i, j): (usize, usize)| self.value(x + i * size / 4, y + j * size / 4);
        let edges = [CHECKS[0], CHECKS[1], CHECKS[2], CHECKS[3]].map(middle);
        self.patch(x, y, size)
            .with_middles(edges, middle(CHECKS[4]))
    }

    /// The patch of an estimated cell.
    fn chosen(&self, state: State, x: usize, y: usize, size: usize) -> Patch {
        if state == State::Bulged {
            self.bulged(x, y, size)
        } else {
            self.patch(x, y, size)
        }
    }

    /// The largest error of a cell's interpolant at these checks; not a number where the map is not.
    fn deviation(
        &self,
        patch: &Patch,
        x: usize,
        y: usize,
        size: usize,
        checks: &[(usize, usize)],
    ) -> f64 {
        let mut largest = 0.0_f64;
        for &(i, j) in checks {
            let exact = self.value(x + i * size / 4, y + j * size / 4);
            let error = patch.value(i as f64 / 4.0, j as f64 / 4.0).distance(exact);
            if error > largest || error.is_nan() {
                largest = error;
            }
            if largest.is_nan() {
                break;
            }
        }
        largest
    }

    /// Writes all offsets.
    pub(super) fn fill(&mut self, out: &mut [[f32; 2]]) {
        let stride = self.work.window.width();
        let mut exact = Vec::new();
        for level in 0..self.levels.len() {
            let Cells { size, across, .. } = self.levels[level];
            for cell in 0..self.levels[level].states.len() {
                let state = self.levels[level].states[cell];
                let (x, y) = (cell % across * size, cell / across * size);
                let (columns, rows) = self.visible(x, y, size);
                let pixels = columns * rows;
                match state {
                    State::Absent | State::Fresh | State::Void => continue,
                    State::Refined => {
                        if size == FINEST {
                            exact.push((x, y));
                        }
                        continue;
                    }
                    State::Still => {
                        self.report.still_pixels += pixels;
                        for line in out[y * stride..].chunks_mut(stride).take(rows) {
                            line[x..x + columns].fill([0.0; 2]);
                        }
                        continue;
                    }
                    State::Derived => self.report.derived_pixels += pixels,
                    State::Estimated | State::Bulged => self.report.estimated_pixels += pixels,
                }
                let patch = if state == State::Derived {
                    let corners = Self::corners(x, y, size);
                    let patch = Patch::bilinear(corners.map(|(x, y)| self.value(x, y)));
                    let error = 0.5 * self.work.options.max_error + patch.rounding();
                    self.report.max_error = self.report.max_error.max(error);
                    patch
                } else {
                    let error = self.levels[level].errors[cell];
                    self.report.measured = self.report.measured.max(error);
                    let probed = (self.levels[level].probes[cell] >> 4).count_ones() as usize;
                    let checked = if state == State::Bulged {
                        CHECKS.len()
                    } else {
                        checks(size).len()
                    };
                    self.report.checks += checked + probes(size) * probed;
                    self.chosen(state, x, y, size)
                };
                patch.draw(size, columns, &mut out[y * stride + x..], stride);
            }
        }
        for cells in exact.chunks(RUN / (FINEST * FINEST)) {
            self.fill_exactly(cells, out);
        }
    }

    /// What became of the band.
    pub(super) fn report(&self) -> &HierarchyReport {
        &self.report
    }

    /// What is known of the displacement at a pixel.
    fn known(&self, (x, y): (usize, usize)) -> Option<DVec2> {
        if !(x.is_multiple_of(GRAIN) && y.is_multiple_of(GRAIN)) {
            return None;
        }
        let number = self.value_at[self.value_slot(x, y)] as usize;
        let kept = self.values.get(number.wrapping_sub(1)).copied();
        kept.or_else(|| self.work.coarse.value(x, self.top + y))
    }

    /// Evaluates cells pixel by pixel, where that has not happened already.
    fn fill_exactly(&mut self, cells: &[(usize, usize)], out: &mut [[f32; 2]]) {
        let stride = self.work.window.width();
        let mut points = core::mem::take(&mut self.points);
        points.clear();
        let pixels = |band: &Self, (x, y): (usize, usize)| {
            let (columns, rows) = band.visible(x, y, FINEST);
            (y..y + rows).flat_map(move |y| (x..x + columns).map(move |x| (x, y)))
        };
        for &cell in cells {
            let unknown = pixels(self, cell).filter(|&place| self.known(place).is_none());
            points.extend(unknown.map(|place| self.place(place)));
        }
        let _ = self.work.deformation.map_points(0, &mut points);
        self.report.evaluations += points.len();
        let mut moved = points.iter();
        let mut largest = 0.0_f64;
        for &cell in cells {
            for place in pixels(self, cell) {
                self.report.exact_pixels += 1;
                let offset = match self.known(place) {
                    Some(offset) => offset,
                    None => moved.next().map_or(DVec2::NAN, |p| *p - self.place(place)),
                };
                largest = largest.max(offset.abs().max_element());
                out[place.1 * stride + place.0] = [offset.x as f32, offset.y as f32];
            }
        }
        let error = core::f64::consts::SQRT_2 * rounding(largest);
        self.report.max_error = self.report.max_error.max(error);
        self.points = points;
    }
}
