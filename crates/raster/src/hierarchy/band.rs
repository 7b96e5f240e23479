//! A few rows of the coarsest cells with all that becomes of them: what one thread works on.

use super::coarse::{Coarse, jacobian, push_neighbours};
use super::knowledge::{Knowledge, Verdict};
use super::patch::{Bubbles, Corners, Patch, largest, rounding};
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
pub(super) enum State {
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
    pub(super) fn is_estimated(self) -> bool {
        matches!(self, Self::Estimated | Self::Bulged)
    }
}

/// Cells of one size.
pub(super) struct Cells {
    pub(super) size: usize,
    pub(super) across: usize,
    pub(super) states: Vec<State>,
    /// The largest error that was found in each.
    pub(super) errors: Vec<f64>,
    /// Whether each was quartered because of a crease that is known.
    pub(super) known: Vec<bool>,
    /// Sides along which each is to be probed, and, four bits higher, has been.
    pub(super) probes: Vec<u8>,
    /// Those to be decided on.
    pub(super) fresh: Vec<u32>,
    /// Those that are to be probed.
    pub(super) exposed: Vec<u32>,
    /// Those refined since the neighbouring bands were told.
    pub(super) news: Vec<u32>,
    /// Refined ones whose neighbours have not all been seen to.
    pub(super) ungraded: Vec<u32>,
    /// The same of the bands above and below, by column.
    pub(super) beyond: [Vec<u32>; 2],
}

/// Largest size of cells whose sides are probed.
pub(super) const PROBED: usize = 8;
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

/// The places of a cell's checks, in quarters of it: the middles of its edges and its own.
const MIDDLES: [(usize, usize); 5] = [(2, 0), (2, 4), (0, 2), (4, 2), (2, 2)];
/// And the middles of its quarters. Cells of 8 pixels are checked there only if the others are nearly good enough, smaller ones
/// not at all: their sides are looked at more closely where a neighbour gives cause.
const QUARTERS: [(usize, usize); 4] = [(1, 1), (3, 1), (1, 3), (3, 3)];

/// The larger error; not a number where one of them is not.
fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

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
    pub(super) levels: Vec<Cells>,
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
                    known: vec![false; count],
                    probes: vec![0; count],
                    fresh: if size == coarsest {
                        (0..count as u32).collect()
                    } else {
                        Vec::new()
                    },
                    exposed: Vec::new(),
                    news: Vec::new(),
                    ungraded: Vec::new(),
                    beyond: [Vec::new(), Vec::new()],
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
            values: Vec::with_capacity(width * ROWS / 16),
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

    #[inline]
    fn value_slot(&self, x: usize, y: usize) -> usize {
        y / GRAIN * (self.width / GRAIN + 1) + x / GRAIN
    }
    #[inline]
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
        let fresh = core::mem::take(&mut self.levels[level].fresh);
        if fresh.is_empty() {
            return;
        }
        let mut todo = core::mem::take(&mut self.todo);
        todo.clear();
        for cell in fresh {
            let cell = cell as usize;
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
                    verdict @ (Verdict::Refine | Verdict::Crease) => {
                        self.levels[level].known[cell] = verdict == Verdict::Crease;
                        self.refine(level, (x, y));
                        continue;
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
            let corners = self.known_corners(x, y, size);
            let missing = corners.missing_in_middles(self.middles(x, y, size));
            let mut error = largest(&missing);
            let mut accepted = false;
            // The smallest cells are next to what no cell serves: there the middles alone count twice.
            let counted = if size == FINEST { 2.0 * error } else { error };
            if self.accepts(&corners, None, counted) {
                if size > PROBED {
                    let missing = corners.missing_in_quarters(None, self.quarters(x, y, size));
                    error = larger(error, largest(&missing));
                }
                accepted = size <= PROBED || self.accepts(&corners, None, error);
            }
            if accepted {
                self.accept(level, (x, y), State::Estimated, error);
                continue;
            }
            let nearly = size > FINEST
                && Corners::bubbles(missing).largest() * self.work.options.safety
                    <= BULGE * self.work.options.max_error;
            if nearly {
                again.push((x, y));
                if size <= PROBED {
                    for &(i, j) in &QUARTERS {
                        self.ask_value(x + i * size / 4, y + j * size / 4);
                    }
                }
            } else {
                self.refine(level, (x, y));
            }
        }
        self.evaluate();
        for &(x, y) in &again {
            let corners = self.known_corners(x, y, size);
            let bubbles = self.bubbles(&corners, x, y, size);
            let exact = self.quarters(x, y, size);
            let error = largest(&corners.missing_in_quarters(Some(&bubbles), exact));
            if self.accepts(&corners, Some(&bubbles), error) {
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
        self.quarter(level, cell);
    }

    /// Quarters a cell: its quarters are fresh.
    pub(super) fn quarter(&mut self, level: usize, cell: usize) {
        let cells = &mut self.levels[level];
        cells.states[cell] = State::Refined;
        cells.news.push(cell as u32);
        cells.ungraded.push(cell as u32);
        let across = self.levels[level].across;
        let (column, row) = (cell % across, cell / across);
        if let Some(finer) = self.levels.get_mut(level + 1) {
            for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let child = (2 * row + y) * finer.across + 2 * column + x;
                if finer.states[child] == State::Absent {
                    finer.states[child] = State::Fresh;
                    finer.fresh.push(child as u32);
                }
            }
        }
    }

    /// Looks closer at small cells next to such that are quartered or evaluated pixel by pixel: along the common side, where what made
    /// that necessary there may reach a little way in.
    fn probe(&mut self, level: usize) {
        let Cells { size, across, .. } = self.levels[level];
        let exposed = core::mem::take(&mut self.levels[level].exposed);
        if exposed.is_empty() {
            return;
        }
        let mut cells = core::mem::take(&mut self.todo);
        let mut points = core::mem::take(&mut self.points);
        cells.clear();
        points.clear();
        let steps = &PROBES[..probes(size)];
        for cell in exposed {
            let cell = cell as usize;
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
            let (corners, bubbles) = self.chosen(state, x, y, size);
            let patch = Patch::new(&corners, bubbles);
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
            if !self.accepts(&corners, bubbles.as_ref(), largest) {
                self.refine(level, (x, y));
            }
        }
        self.todo = cells;
        self.points = points;
    }

    fn accepts(&self, corners: &Corners, bubbles: Option<&Bubbles>, error: f64) -> bool {
        let options = self.work.options;
        error * options.safety + corners.rounding(bubbles) <= options.max_error
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
        let quarters = if size > PROBED { &QUARTERS[..] } else { &[] };
        for &(i, j) in MIDDLES.iter().chain(quarters) {
            self.ask_value(x + i * size / 4, y + j * size / 4);
        }
    }

    #[inline]
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

    #[inline]
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

    #[inline]
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

    #[inline]
    fn known_corners(&self, x: usize, y: usize, size: usize) -> Corners {
        let corners = Self::corners(x, y, size);
        let values = corners.map(|(x, y)| self.value(x, y));
        let jacobians = corners.map(|(x, y)| self.jacobian(x, y));
        Corners::new(values, jacobians, size)
    }

    /// The values in the middles of a cell's edges and its own.
    #[inline]
    fn middles(&self, x: usize, y: usize, size: usize) -> [DVec2; 5] {
        MIDDLES.map(|(i, j)| self.value(x + i * size / 4, y + j * size / 4))
    }

    /// The values in the middles of its quarters.
    #[inline]
    fn quarters(&self, x: usize, y: usize, size: usize) -> [DVec2; 4] {
        QUARTERS.map(|(i, j)| self.value(x + i * size / 4, y + j * size / 4))
    }

    /// What makes a cell agree with its middles.
    fn bubbles(&self, corners: &Corners, x: usize, y: usize, size: usize) -> Bubbles {
        Corners::bubbles(corners.missing_in_middles(self.middles(x, y, size)))
    }

    /// What an estimated cell is drawn from.
    fn chosen(&self, state: State, x: usize, y: usize, size: usize) -> (Corners, Option<Bubbles>) {
        let corners = self.known_corners(x, y, size);
        let bulged = state == State::Bulged;
        let bubbles = bulged.then(|| self.bubbles(&corners, x, y, size));
        (corners, bubbles)
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
                    let values = corners.map(|(x, y)| self.value(x, y));
                    let flat = Corners::new(values, [DMat2::ZERO; 4], size);
                    let error = 0.5 * self.work.options.max_error + flat.rounding(None);
                    self.report.max_error = self.report.max_error.max(error);
                    Patch::bilinear(values)
                } else {
                    let error = self.levels[level].errors[cell];
                    self.report.measured = self.report.measured.max(error);
                    let probed = (self.levels[level].probes[cell] >> 4).count_ones() as usize;
                    let checked = if state == State::Bulged || size > PROBED {
                        MIDDLES.len() + QUARTERS.len()
                    } else {
                        MIDDLES.len()
                    };
                    self.report.checks += checked + probes(size) * probed;
                    let (corners, bubbles) = self.chosen(state, x, y, size);
                    Patch::new(&corners, bubbles)
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
