//! Where each place of a result comes from in an image, by two grids in two passes.
//!
//! A place `(x', y')` of the result stands on a column of pixels, which the rows of the result's grid meet at knots; rows of the
//! auxiliary grid, x of the result and y of the image, say where these are in the image, and the function through them
//! gives `y` of `y'`. The place `(x', y)` stands on a row of pixels, which the columns of the auxiliary grid meet; columns of
//! the image's grid say where these are, and the function through them gives `x` of `x'`. A node thus comes from its fellow.
//!
//! *Source*: G. Wolberg, *Digital Image Warping*, 1990, §7.7.4, read backwards, so that it is a map from result to image.
//! Decisions: rows beyond their first and last node keep the node's y, columns its x, and along a line the outermost
//! displacements go on, so that far away the map is a shift and nothing grows. Curves of a grid that touch between their
//! nodes are refused; where they are apart, only the functions along lines can turn back, and those of `linear` and
//! `monotone` cannot: [`GridWarp::folds`] measures it for `catmull-rom`.

use super::line::{Knot, place, span_before};
use super::spline::function;
use super::{CoordinateGrid, GridError, LEAST_GAP, Spline};
use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::{Curve, Deformation, Facts, Plane, Site, Smoothness, Support};
use anamorph_curves::{Cubic, PiecewiseCubic};
use anamorph_raster::Window;

/// A map from the places of a result to those of an image, given by a grid over each.
#[derive(Debug, Clone)]
pub struct GridWarp {
    /// For each row of nodes, y in result and image by the result's x.
    rows: Vec<PiecewiseCubic<Plane>>,
    /// For each column of nodes, x in result and image by the image's y.
    columns: Vec<PiecewiseCubic<Plane>>,
    spline: Spline,
    identity: bool,
}

/// What of a window is folded: lines of pixels along which places of the image go back.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Folds {
    /// Columns of pixels with a fold.
    pub columns: usize,
    /// Rows of pixels with a fold.
    pub rows: usize,
    /// A place of the result in one of them.
    pub near: Option<DVec2>,
}

impl GridWarp {
    /// The map that takes nodes of the grid `result` to their fellows of the grid `image`.
    ///
    /// # Errors
    /// [`GridError::Unlike`] for grids of unlike shape; [`GridError::Crossing`] where neighbouring curves of a grid touch or
    /// cross between their nodes.
    pub fn new(
        result: &CoordinateGrid,
        image: &CoordinateGrid,
        spline: Spline,
    ) -> Result<Self, GridError> {
        let (columns, rows) = result.shape();
        if image.shape() != result.shape() {
            return Err(GridError::Unlike {
                index: 1,
                found: image.shape(),
                first: result.shape(),
            });
        }
        let node = |column, row| row * columns + column;
        let curve = |nodes: &mut dyn Iterator<Item = usize>, axis: usize| {
            let (mut at, mut values) = (Vec::new(), Vec::new());
            for node in nodes {
                let (there, here) = (result.nodes()[node], image.nodes()[node]);
                at.push(if axis == 0 { here.y } else { there.x });
                values.push(dvec2(there[axis], here[axis]));
            }
            function(spline, &at, values)
        };
        let across = |row| curve(&mut (0..columns).map(|column| node(column, row)), 1);
        let down = |column| curve(&mut (0..rows).map(|row| node(column, row)), 0);
        let warp = Self {
            rows: (0..rows).map(across).collect::<Result<_, _>>()?,
            columns: (0..columns).map(down).collect::<Result<_, _>>()?,
            spline,
            identity: result == image,
        };
        warp.check_apart()?;
        Ok(warp)
    }

    /// How columns and rows go on between nodes.
    pub fn spline(&self) -> Spline {
        self.spline
    }

    /// Looks for neighbouring curves that are not apart.
    fn check_apart(&self) -> Result<(), GridError> {
        for (lines, curves, grids) in [
            (
                "rows",
                &self.rows,
                ["result", "auxiliary grid (x of the result, y of the image)"],
            ),
            (
                "columns",
                &self.columns,
                ["auxiliary grid (x of the result, y of the image)", "image"],
            ),
        ] {
            for (first, pair) in curves.windows(2).enumerate() {
                for (side, grid) in grids.into_iter().enumerate() {
                    if let Some((at, across)) = touching(&pair[0], &pair[1], side) {
                        let near = if lines == "rows" {
                            dvec2(at, across)
                        } else {
                            dvec2(across, at)
                        };
                        return Err(GridError::Crossing {
                            lines,
                            grid,
                            first,
                            near,
                        });
                    }
                }
            }
        }
        Ok(())
    }

    /// Where the column of pixels at `x` meets row number `row` of the grids.
    #[inline]
    pub(super) fn knot_down(&self, x: f64, row: usize) -> Knot {
        knot(&self.rows[row], x)
    }
    /// Where the row of pixels at `y` of the image meets column number `column` of the grids.
    #[inline]
    pub(super) fn knot_across(&self, y: f64, column: usize) -> Knot {
        knot(&self.columns[column], y)
    }
    /// Columns and rows of its grids.
    pub(super) fn shape(&self) -> (usize, usize) {
        (self.columns.len(), self.rows.len())
    }

    /// What of the pixels of `window` is folded: all columns of pixels, and the image's rows of pixels that they come from.
    /// Nothing is for splines that keep the order.
    pub fn folds(&self, window: Window) -> Folds {
        let mut folds = Folds::default();
        if self.spline.keeps_order() {
            return folds;
        }
        let (columns, rows) = self.shape();
        // Rows of the image that the window comes from.
        let (mut top, mut bottom) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut knots, mut heights) = (Vec::new(), Vec::new());
        for column in 0..window.width() {
            let x = window.centre(column, 0).x;
            knots.clear();
            knots.extend((0..rows).map(|row| self.knot_down(x, row)));
            let range = window.corner().y..=window.corner().y + window.height() as f64;
            for end in [*range.start(), *range.end()] {
                let y = place(self.spline, rows, |row| knots[row], end);
                (top, bottom) = (top.min(y), bottom.max(y));
            }
            heights.push((top, bottom));
            if let Some(at) = self.first_fold(&knots, &range) {
                folds.columns += 1;
                folds.near.get_or_insert(dvec2(x, at));
            }
        }
        let range = window.corner().x..=window.corner().x + window.width() as f64;
        // At most as many rows as the window has, evenly: a map that shrinks is not looked at more closely than it is drawn.
        let count = window.height();
        for row in 0..count {
            let y = top + (bottom - top) * ((row as f64 + 0.5) / count as f64);
            knots.clear();
            knots.extend((0..columns).map(|column| self.knot_across(y, column)));
            if let Some(at) = self.first_fold(&knots, &range) {
                folds.rows += 1;
                folds.near.get_or_insert(dvec2(at, y));
            }
        }
        folds
    }

    /// The first place within `range` near which the function through these knots turns back.
    fn first_fold(&self, knots: &[Knot], range: &std::ops::RangeInclusive<f64>) -> Option<f64> {
        let spans = 1..knots.len();
        spans
            .filter_map(|behind| {
                span_before(self.spline, knots.len(), |i| knots[i], behind).turning_back()
            })
            .find(|at| range.contains(at))
    }
}

/// Where a curve stands in the result, and how far from there in the image.
#[inline]
fn knot(curve: &PiecewiseCubic<Plane>, at: f64) -> Knot {
    let there = curve.point(at);
    Knot {
        at: there.x,
        shift: there.y - there.x,
    }
}

/// A curve's cubic between two abscissae that no break lies between; its ends go on as constants.
fn cubic_between(curve: &PiecewiseCubic<Plane>, piece: usize, from: f64, to: f64) -> Cubic<Plane> {
    let (start, end) = curve.domain();
    if to <= start || from >= end {
        let rest = curve.point(if to <= start { start } else { end });
        return Cubic([rest, DVec2::ZERO, DVec2::ZERO, DVec2::ZERO]);
    }
    let (low, high) = (curve.break_at(piece), curve.break_at(piece + 1));
    let width = high - low;
    curve.pieces()[piece].part((from - low) / width, (to - low) / width)
}

/// The first place where the second curve does not lie behind the first: the abscissa, and the value there. `side` is 0 for
/// the result's values and 1 for the image's.
fn touching(
    first: &PiecewiseCubic<Plane>,
    second: &PiecewiseCubic<Plane>,
    side: usize,
) -> Option<(f64, f64)> {
    let curves = [first, second];
    let count = curves.map(|curve| curve.pieces().len());
    // Breaks of both, ascending; `passed` of each lie before the interval at hand.
    let mut passed = [0, 0];
    let next = |passed: [usize; 2]| {
        let ends = [0, 1].map(|i| {
            let more = passed[i] <= count[i];
            if more {
                curves[i].break_at(passed[i])
            } else {
                f64::INFINITY
            }
        });
        ends[0].min(ends[1])
    };
    let mut from = next(passed);
    loop {
        for i in 0..2 {
            while passed[i] <= count[i] && curves[i].break_at(passed[i]) <= from {
                passed[i] += 1;
            }
        }
        let to = next(passed);
        if to == f64::INFINITY {
            return None;
        }
        let [a, b] = [0, 1].map(|i| {
            let piece = passed[i].saturating_sub(1).min(count[i] - 1);
            cubic_between(curves[i], piece, from, to)
        });
        let gap: [f64; 4] = std::array::from_fn(|power| b.0[power][side] - a.0[power][side]);
        let (t, least) = lowest(gap);
        // Half the least distance of nodes: what rounding leaves of it.
        if least < 0.5 * LEAST_GAP || least.is_nan() {
            return Some((from + (to - from) * t, a.point(t)[side]));
        }
        from = to;
    }
}

/// Where on [0, 1] a cubic is lowest, and its value there.
fn lowest([a, b, c, d]: [f64; 4]) -> (f64, f64) {
    let value = |t: f64| a + (b + (c + d * t) * t) * t;
    let mut found = (0.0, value(0.0));
    let mut look = |t: f64| {
        if value(t) < found.1 {
            found = (t, value(t));
        }
    };
    look(1.0);
    // b + 2ct + 3dt² = 0, in the form that keeps digits.
    let discriminant = c * c - 3.0 * d * b;
    if discriminant >= 0.0 {
        let sum = -(c + discriminant.sqrt().copysign(c));
        for t in [sum / (3.0 * d), b / sum] {
            if t > 0.0 && t < 1.0 {
                look(t);
            }
        }
    }
    found
}

impl Deformation<Plane> for GridWarp {
    fn map(&self, site: &Site<Plane>) -> Plane {
        let there = site.point;
        let (columns, rows) = self.shape();
        let y = place(
            self.spline,
            rows,
            |row| self.knot_down(there.x, row),
            there.y,
        );
        let x = place(
            self.spline,
            columns,
            |column| self.knot_across(y, column),
            there.x,
        );
        dvec2(x, y)
    }

    fn facts(&self) -> Facts<Plane> {
        if self.identity {
            return Facts::identity();
        }
        let reason = "along every column and then along every row places keep their order";
        let reason = self.spline.keeps_order().then(|| reason.to_owned());
        let facts = Facts {
            support: Support::Everywhere,
            // Where curves end, and at nodes of those that are straight or limited, there is a crease.
            inside: Smoothness::C(0),
            edge: Smoothness::C(0),
            translations_only: false,
            strength_blends: false,
            weights: Smoothness::C(0),
            upright: reason.clone(),
            one_to_one: reason,
            ..Facts::identity()
        };
        match self.spline {
            Spline::CatmullRom => facts
                .with_note("without creases within the grid; beyond it the outermost displacements go on, with a crease at its border")
                .with_note("Catmull-Rom splines may turn back between uneven nodes; the spline `monotone` cannot"),
            Spline::Linear | Spline::Monotone => {
                facts.with_note("beyond the grid the outermost displacements go on")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_place_of_a_cubic() {
        for cubic in [
            [1.0, 0.0, 0.0, 0.0],
            [1.0, -1.0, 0.0, 0.0],
            [0.0, -1.0, 1.0, 0.0],
            [0.0, -3.0, 4.0, 0.0],
            // The minimum behind the maximum.
            [0.0, 0.5625, -1.5, 1.0],
            [0.0, 0.1875, -1.0, 1.0],
            [0.0, -1.0, 0.0, 1.0],
            [0.0, -0.5, 1.5, -1.0],
        ] {
            let found = lowest(cubic);
            let sampled = (0..=1000)
                .map(|i| f64::from(i) / 1000.0)
                .map(|t| cubic[0] + (cubic[1] + (cubic[2] + cubic[3] * t) * t) * t)
                .fold(f64::INFINITY, f64::min);
            assert!(
                found.1 <= sampled + 1e-12 && found.1 > sampled - 1e-5,
                "{cubic:?} {found:?}"
            );
        }
    }
}
