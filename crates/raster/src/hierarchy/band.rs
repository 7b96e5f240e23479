//! A few rows of the coarsest cells with all that becomes of them: the unit of work of a thread.

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
/// Distance of the places at which evaluations may be kept: a quarter of the smallest cells.
const GRAIN: usize = FINEST / 4;
/// Pixels that are evaluated together.
const RUN: usize = 4096;
/// No evaluation yet.
const NONE: u32 = u32::MAX;

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
    /// Quartered; the smallest ones evaluated pixel by pixel.
    Refined,
}

/// Cells of one size.
struct Cells {
    size: usize,
    across: usize,
    states: Vec<State>,
}

/// What a thread keeps from band to band.
pub(super) struct Scratch {
    levels: Vec<Cells>,
    /// Numbers of the kept evaluations, by place.
    value_at: Vec<u32>,
    values: Vec<DVec2>,
    jacobian_at: Vec<u32>,
    jacobians: Vec<DMat2>,
    /// Where evaluations and Jacobians are asked for or kept, in the order of their numbers.
    value_places: Vec<(usize, usize)>,
    jacobian_places: Vec<(usize, usize)>,
    points: Vec<DVec2>,
    todo: Vec<(usize, usize)>,
    exact: Vec<(usize, usize)>,
    width: usize,
}

impl Scratch {
    /// For a picture of that width.
    pub(super) fn new(width: usize, coarsest: usize) -> Self {
        let width = width.div_ceil(coarsest) * coarsest;
        let sizes = core::iter::successors(Some(coarsest), |size| Some(size / 2));
        let levels = sizes
            .take_while(|&size| size >= FINEST)
            .map(|size| Cells {
                size,
                across: width / size,
                states: vec![State::Absent; width / size * (ROWS / size)],
            })
            .collect();
        let places = |distance: usize| (width / distance + 1) * (ROWS / distance + 1);
        Self {
            levels,
            value_at: vec![NONE; places(GRAIN)],
            values: Vec::new(),
            jacobian_at: vec![NONE; places(FINEST)],
            jacobians: Vec::new(),
            value_places: Vec::new(),
            jacobian_places: Vec::new(),
            points: Vec::new(),
            todo: Vec::new(),
            exact: Vec::new(),
            width,
        }
    }

    fn value_slot(&self, x: usize, y: usize) -> usize {
        y / GRAIN * (self.width / GRAIN + 1) + x / GRAIN
    }
    fn jacobian_slot(&self, x: usize, y: usize) -> usize {
        y / FINEST * (self.width / FINEST + 1) + x / FINEST
    }

    /// Forgets the last band.
    fn clear(&mut self) {
        for i in 0..self.value_places.len() {
            let (x, y) = self.value_places[i];
            let slot = self.value_slot(x, y);
            self.value_at[slot] = NONE;
        }
        for i in 0..self.jacobian_places.len() {
            let (x, y) = self.jacobian_places[i];
            let slot = self.jacobian_slot(x, y);
            self.jacobian_at[slot] = NONE;
        }
        self.value_places.clear();
        self.jacobian_places.clear();
        self.values.clear();
        self.jacobians.clear();
        for level in &mut self.levels {
            level.states.fill(State::Absent);
        }
        self.levels[0].states.fill(State::Fresh);
    }
}

/// The places of a cell's checks, in quarters of it.
const CHECKS: [(usize, usize); 9] = [
    (2, 0),
    (0, 2),
    (2, 2),
    (4, 2),
    (2, 4),
    (1, 1),
    (3, 1),
    (1, 3),
    (3, 3),
];

/// A band at work. Coordinates are pixels from the window's left and the band's top.
pub(super) struct Band<'a> {
    deformation: &'a dyn Deformation<Plane>,
    window: Window,
    options: &'a Hierarchy,
    knowledge: &'a Knowledge,
    coarse: &'a Coarse,
    top: usize,
    scratch: &'a mut Scratch,
    report: HierarchyReport,
}

impl<'a> Band<'a> {
    /// Rows of pixels in a band: a whole number of cells of every size.
    pub(super) fn rows(coarsest: usize) -> usize {
        ROWS.next_multiple_of(coarsest)
    }

    pub(super) fn new(
        deformation: &'a dyn Deformation<Plane>,
        window: Window,
        options: &'a Hierarchy,
        knowledge: &'a Knowledge,
        coarse: &'a Coarse,
        top: usize,
        scratch: &'a mut Scratch,
    ) -> Self {
        scratch.clear();
        Self {
            deformation,
            window,
            options,
            knowledge,
            coarse,
            top,
            scratch,
            report: HierarchyReport::NOTHING,
        }
    }

    /// Fills the band's offsets.
    pub(super) fn draw(mut self, out: &mut [[f32; 2]]) -> HierarchyReport {
        loop {
            for level in 0..self.scratch.levels.len() {
                self.settle(level);
            }
            if !self.grade() {
                break;
            }
        }
        self.fill(out);
        self.report
    }

    /// How much of a cell is in the picture.
    fn visible(&self, x: usize, y: usize, size: usize) -> (usize, usize) {
        let columns = self.window.width().saturating_sub(x).min(size);
        let rows = self.window.height().saturating_sub(self.top + y).min(size);
        (columns, rows)
    }

    /// Decides on all fresh cells of a size.
    fn settle(&mut self, level: usize) {
        let Cells { size, across, .. } = self.scratch.levels[level];
        let mut todo = core::mem::take(&mut self.scratch.todo);
        todo.clear();
        for cell in 0..self.scratch.levels[level].states.len() {
            if self.scratch.levels[level].states[cell] != State::Fresh {
                continue;
            }
            let (x, y) = (cell % across * size, cell / across * size);
            let (columns, rows) = self.visible(x, y, size);
            let state = if columns == 0 || rows == 0 {
                State::Void
            } else {
                match self.knowledge.verdict(x, self.top + y, size) {
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
            self.scratch.levels[level].states[cell] = state;
        }
        self.evaluate();
        for &(x, y) in &todo {
            let cell = y / size * across + x / size;
            let accepted = self.estimate(x, y, size);
            self.scratch.levels[level].states[cell] = if accepted {
                State::Estimated
            } else {
                self.quarter(level, cell);
                State::Refined
            };
        }
        self.scratch.todo = todo;
    }

    /// Makes the quarters of a cell fresh.
    fn quarter(&mut self, level: usize, cell: usize) {
        let across = self.scratch.levels[level].across;
        let (column, row) = (cell % across, cell / across);
        if let Some(finer) = self.scratch.levels.get_mut(level + 1) {
            for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let child = (2 * row + y) * finer.across + 2 * column + x;
                if finer.states[child] == State::Absent {
                    finer.states[child] = State::Fresh;
                }
            }
        }
    }

    /// Quarters cells next to refined ones that are less than half as large. Whether there were any.
    fn grade(&mut self) -> bool {
        let mut changed = false;
        for level in (1..self.scratch.levels.len()).rev() {
            let across = self.scratch.levels[level].across;
            let count = self.scratch.levels[level].states.len();
            for cell in 0..count {
                if self.scratch.levels[level].states[cell] != State::Refined {
                    continue;
                }
                let (column, row) = (cell % across, cell / across);
                for y in row.saturating_sub(1)..(row + 2).min(count / across) {
                    for x in column.saturating_sub(1)..(column + 2).min(across) {
                        changed |= self.present(level, x, y);
                    }
                }
            }
        }
        changed
    }

    /// Sees to it that there is a cell of that size at a place, unless it is known to be good. Whether that changed anything.
    fn present(&mut self, level: usize, column: usize, row: usize) -> bool {
        let Cells { across, states, .. } = &self.scratch.levels[level];
        if level == 0 || states[row * across + column] != State::Absent {
            return false;
        }
        let mut changed = self.present(level - 1, column / 2, row / 2);
        let parents = &mut self.scratch.levels[level - 1];
        let parent = row / 2 * parents.across + column / 2;
        if parents.states[parent] == State::Estimated {
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
        for (i, j) in CHECKS {
            self.ask_value(x + i * size / 4, y + j * size / 4);
        }
    }

    fn ask_value(&mut self, x: usize, y: usize) {
        let slot = self.scratch.value_slot(x, y);
        if self.scratch.value_at[slot] == NONE && self.coarse.value(x, self.top + y).is_none() {
            self.scratch.value_at[slot] = self.scratch.value_places.len() as u32;
            self.scratch.value_places.push((x, y));
        }
    }

    fn ask_jacobian(&mut self, x: usize, y: usize) {
        let slot = self.scratch.jacobian_slot(x, y);
        if self.scratch.jacobian_at[slot] == NONE && self.coarse.jacobian(x, self.top + y).is_none()
        {
            self.scratch.jacobian_at[slot] = self.scratch.jacobian_places.len() as u32;
            self.scratch.jacobian_places.push((x, y));
        }
    }

    fn value(&self, x: usize, y: usize) -> DVec2 {
        let number = self.scratch.value_at[self.scratch.value_slot(x, y)] as usize;
        match self.scratch.values.get(number) {
            Some(value) => *value,
            None => self.coarse.value(x, self.top + y).unwrap_or(DVec2::NAN),
        }
    }

    fn jacobian(&self, x: usize, y: usize) -> DMat2 {
        let number = self.scratch.jacobian_at[self.scratch.jacobian_slot(x, y)] as usize;
        match self.scratch.jacobians.get(number) {
            Some(jacobian) => *jacobian,
            None => self.coarse.jacobian(x, self.top + y).unwrap_or(DMat2::NAN),
        }
    }

    fn place(&self, (x, y): (usize, usize)) -> DVec2 {
        self.window.centre(x, self.top + y)
    }

    /// Evaluates what has been asked for.
    fn evaluate(&mut self) {
        let mut points = core::mem::take(&mut self.scratch.points);
        points.clear();
        let known = self.scratch.values.len();
        let measured = self.scratch.jacobians.len();
        for &place in &self.scratch.value_places[known..] {
            points.push(self.place(place));
        }
        let fresh = points.len();
        for &place in &self.scratch.jacobian_places[measured..] {
            push_neighbours(self.place(place), &mut points);
        }
        if !points.is_empty() {
            let _ = self.deformation.map_points(0, &mut points);
            self.report.evaluations += points.len();
        }
        for (i, moved) in points[..fresh].iter().enumerate() {
            let place = self.place(self.scratch.value_places[known + i]);
            self.scratch.values.push(*moved - place);
        }
        let (pairs, _) = points[fresh..].as_chunks::<2>();
        for (i, pair) in pairs.iter().enumerate() {
            let (x, y) = self.scratch.jacobian_places[measured + i];
            let slope = jacobian(self.place((x, y)), self.value(x, y), *pair);
            self.scratch.jacobians.push(slope);
        }
        self.scratch.points = points;
    }

    fn patch(&self, x: usize, y: usize, size: usize) -> Patch {
        let corners = Self::corners(x, y, size);
        let values = corners.map(|(x, y)| self.value(x, y));
        let jacobians = corners.map(|(x, y)| self.jacobian(x, y));
        Patch::new(values, jacobians, size)
    }

    /// The largest error of a cell's interpolant where it is checked; not a number where the map is not.
    fn deviation(&self, patch: &Patch, x: usize, y: usize, size: usize) -> f64 {
        let mut largest = 0.0_f64;
        for (i, j) in CHECKS {
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

    /// Whether evaluations say that a cell is good enough.
    fn estimate(&mut self, x: usize, y: usize, size: usize) -> bool {
        let patch = self.patch(x, y, size);
        let error = self.deviation(&patch, x, y, size);
        error * self.options.safety + patch.rounding() <= self.options.max_error
    }

    /// Writes all offsets.
    fn fill(&mut self, out: &mut [[f32; 2]]) {
        let stride = self.window.width();
        let mut exact = core::mem::take(&mut self.scratch.exact);
        exact.clear();
        for level in 0..self.scratch.levels.len() {
            let Cells { size, across, .. } = self.scratch.levels[level];
            for cell in 0..self.scratch.levels[level].states.len() {
                let state = self.scratch.levels[level].states[cell];
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
                    // The map was made of zeros.
                    State::Still => {
                        self.report.still_pixels += pixels;
                        continue;
                    }
                    State::Derived => self.report.derived_pixels += pixels,
                    State::Estimated => self.report.estimated_pixels += pixels,
                }
                let patch = if state == State::Derived {
                    let corners = Self::corners(x, y, size);
                    let patch = Patch::bilinear(corners.map(|(x, y)| self.value(x, y)));
                    let error = 0.5 * self.options.max_error + patch.rounding();
                    self.report.max_error = self.report.max_error.max(error);
                    patch
                } else {
                    let patch = self.patch(x, y, size);
                    let error = self.deviation(&patch, x, y, size);
                    self.report.measured = self.report.measured.max(error);
                    self.report.checks += CHECKS.len();
                    patch
                };
                patch.draw(size, columns, &mut out[y * stride + x..], stride);
            }
        }
        for cells in exact.chunks(RUN / (FINEST * FINEST)) {
            self.fill_exactly(cells, out);
        }
        self.scratch.exact = exact;
    }

    /// Evaluates cells pixel by pixel.
    fn fill_exactly(&mut self, cells: &[(usize, usize)], out: &mut [[f32; 2]]) {
        let stride = self.window.width();
        let mut points = core::mem::take(&mut self.scratch.points);
        points.clear();
        let pixels = |band: &Self, (x, y): (usize, usize)| {
            let (columns, rows) = band.visible(x, y, FINEST);
            (y..y + rows).flat_map(move |y| (x..x + columns).map(move |x| (x, y)))
        };
        for &cell in cells {
            points.extend(pixels(self, cell).map(|place| self.place(place)));
        }
        let _ = self.deformation.map_points(0, &mut points);
        self.report.evaluations += points.len();
        self.report.exact_pixels += points.len();
        let mut moved = points.iter();
        let mut largest = 0.0_f64;
        for &cell in cells {
            for (place, point) in pixels(self, cell).zip(&mut moved) {
                let offset = *point - self.place(place);
                largest = largest.max(offset.abs().max_element());
                out[place.1 * stride + place.0] = [offset.x as f32, offset.y as f32];
            }
        }
        let error = core::f64::consts::SQRT_2 * rounding(largest);
        self.report.max_error = self.report.max_error.max(error);
        self.scratch.points = points;
    }
}
