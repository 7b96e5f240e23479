//! Metamorphosis by coordinate grids: images warped from grid to grid in two passes.
//!
//! Over each image the user lays a grid of as many nodes, each on the feature that its fellow is on in the other image. The
//! nodes of all grids are interpolated ([`GridKeys`]), both images are warped to the grid between ([`GridWarp`], drawn by
//! [`two_pass`]), and dissolved. Columns and rows of a grid go on between their nodes as a named [`Spline`] says.
//!
//! *Source*: *Interpolation Techniques*, slides, chapter 2, "Morphing"; G. Wolberg, *Digital Image Warping*, 1990, §7.7.4
//! (two-pass mesh warping), after D. B. Smythe, *A Two-Pass Mesh Warping Algorithm for Object Transformation and Image
//! Interpolation*, 1990. The slides' auxiliary grid has the x of the source and the y of the intermediate grid, and is
//! then used to distort in x, for which it would have to be the other way round: here it has the x of the result and the y
//! of the image, as Wolberg's. Decisions: in this crate columns of a grid are numbered from the left and rows from the
//! top; x increases along every row and y down every column, without which no row or column is a function.

mod line;
mod resampling;
mod spline;
mod two_pass;
mod warp;

pub use spline::Spline;
pub use two_pass::{TwoPassMemory, two_pass, two_pass_into};
pub use warp::{Folds, GridWarp};

use crate::{KeyError, KeyPath};
use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::{Curve, Plane};
use anamorph_curves::CurveError;
use anamorph_raster::Window;

/// Most columns, and most rows, of a grid. A node every fourth pixel of a picture of 4096; what is kept for a column of pixels
/// is as long as a grid is high.
pub const MOST_LINES: usize = 1024;

/// Least distance of neighbouring nodes, in pixels: in x along a row, in y down a column. Far below anything seen, far above
/// the rounding of positions in images.
pub const LEAST_GAP: f64 = 1e-6;

/// Largest magnitude of a node's coordinates: that of a window's.
const FAR: f64 = (1_u64 << 50) as f64;

/// What is wrong with a grid, or with two.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GridError {
    /// Fewer than two columns or rows.
    #[error("a grid of {columns} × {rows} nodes has no cell; give at least 2 columns and 2 rows")]
    TooFew {
        /// Columns.
        columns: usize,
        /// Rows.
        rows: usize,
    },
    /// More columns or rows than are served.
    #[error(
        "a grid of {columns} × {rows} nodes is too fine; give at most {MOST_LINES} columns and rows"
    )]
    TooMany {
        /// Columns.
        columns: usize,
        /// Rows.
        rows: usize,
    },
    /// A list of nodes of the wrong length.
    #[error(
        "there are {found} nodes, and a grid of {columns} × {rows} needs {}; give one for each, row by row from the top",
        .columns * .rows
    )]
    Count {
        /// Columns.
        columns: usize,
        /// Rows.
        rows: usize,
        /// How many nodes were given.
        found: usize,
    },
    /// A node that is not a place of an image.
    #[error(
        "the node in column {column}, row {row} (counted from 0) is at ({}, {}), which is no place of an image; give finite \
         pixel coordinates within ±2⁵⁰",
        .at.x, .at.y
    )]
    NotFinite {
        /// Column of the node, from 0.
        column: usize,
        /// Row of the node, from 0.
        row: usize,
        /// Where it is.
        at: DVec2,
    },
    /// A node that does not lie right of its left neighbour.
    #[error(
        "the node in column {column}, row {row} (counted from 0) has x = {x}, and the one to its left {before}: x must \
         increase along each row, by at least {LEAST_GAP} pixels; move the node to the right of its neighbour"
    )]
    Across {
        /// Column of the node, from 0.
        column: usize,
        /// Row of the node, from 0.
        row: usize,
        /// Its x, in pixels.
        x: f64,
        /// The x of its left neighbour.
        before: f64,
    },
    /// A node that does not lie below its upper neighbour.
    #[error(
        "the node in column {column}, row {row} (counted from 0) has y = {y}, and the one above it {before}: y must \
         increase down each column, by at least {LEAST_GAP} pixels; move the node below its neighbour"
    )]
    Down {
        /// Column of the node, from 0.
        column: usize,
        /// Row of the node, from 0.
        row: usize,
        /// Its y, in pixels.
        y: f64,
        /// The y of its upper neighbour.
        before: f64,
    },
    /// A node that a grid does not have.
    #[error(
        "there is no node in column {column}, row {row} of a grid of {columns} × {rows} (counted from 0)"
    )]
    NoNode {
        /// The column asked for.
        column: usize,
        /// The row asked for.
        row: usize,
        /// Columns there are.
        columns: usize,
        /// Rows there are.
        rows: usize,
    },
    /// Grids of unlike shape.
    #[error(
        "grid {index} (counted from 0) has {} × {} nodes, and the first {} × {}: each node needs its fellow in all grids; \
         add the columns and rows that are missing",
        .found.0, .found.1, .first.0, .first.1
    )]
    Unlike {
        /// Which grid, from 0; of a warp's two, the image's is grid 1.
        index: usize,
        /// Its columns and rows.
        found: (usize, usize),
        /// Those of the first.
        first: (usize, usize),
    },
    /// Two neighbouring curves that touch or cross between their nodes.
    #[error(
        "{lines} {first} and {} (counted from 0) of the {grid} touch or cross near ({:.1}, {:.1}): between their nodes the \
         curves are not apart; move the nodes there, give more nodes, or choose the spline `monotone` or `linear`",
        .first + 1, .near.x, .near.y
    )]
    Crossing {
        /// `columns` or `rows`.
        lines: &'static str,
        /// The grid they are of: the result's, the image's, or the auxiliary one.
        grid: &'static str,
        /// The first of the two, from 0.
        first: usize,
        /// Where, in pixels of that grid.
        near: DVec2,
    },
    /// No place between keys.
    #[error(transparent)]
    Key(#[from] KeyError),
    /// Nodes through which no curve goes.
    #[error(transparent)]
    Curve(#[from] CurveError),
}

/// A grid of nodes over an image, in pixel coordinates (x right, y down).
#[derive(Debug, Clone, PartialEq)]
pub struct CoordinateGrid {
    columns: usize,
    rows: usize,
    nodes: Vec<DVec2>,
}

impl CoordinateGrid {
    /// The grid of these nodes: row by row from the top, each from the left.
    ///
    /// # Errors
    /// [`GridError`] for fewer than two columns or rows or more than [`MOST_LINES`], a list of the wrong length, and the first
    /// node that is not finite, not right of its left neighbour, or not below its upper one.
    pub fn new(columns: usize, rows: usize, nodes: Vec<DVec2>) -> Result<Self, GridError> {
        if columns < 2 || rows < 2 {
            return Err(GridError::TooFew { columns, rows });
        }
        if columns > MOST_LINES || rows > MOST_LINES {
            return Err(GridError::TooMany { columns, rows });
        }
        if nodes.len() != columns * rows {
            let found = nodes.len();
            return Err(GridError::Count {
                columns,
                rows,
                found,
            });
        }
        for (index, at) in nodes.iter().enumerate() {
            let (column, row) = (index % columns, index / columns);
            if !(at.x.abs() <= FAR && at.y.abs() <= FAR) {
                let at = *at;
                return Err(GridError::NotFinite { column, row, at });
            }
            if column > 0 && !apart(nodes[index - 1].x, at.x) {
                return Err(GridError::Across {
                    column,
                    row,
                    x: at.x,
                    before: nodes[index - 1].x,
                });
            }
            if row > 0 && !apart(nodes[index - columns].y, at.y) {
                return Err(GridError::Down {
                    column,
                    row,
                    y: at.y,
                    before: nodes[index - columns].y,
                });
            }
        }
        Ok(Self {
            columns,
            rows,
            nodes,
        })
    }

    /// An even grid over a window, its outer nodes on the window's border.
    ///
    /// # Errors
    /// [`GridError`] for too few or too many columns or rows, and such as are not [`LEAST_GAP`] apart.
    pub fn regular(window: Window, columns: usize, rows: usize) -> Result<Self, GridError> {
        if columns < 2 || rows < 2 {
            return Err(GridError::TooFew { columns, rows });
        }
        if columns > MOST_LINES || rows > MOST_LINES {
            return Err(GridError::TooMany { columns, rows });
        }
        let size = dvec2(window.width() as f64, window.height() as f64);
        let share = |i: usize, count: usize| i as f64 / (count - 1) as f64;
        let node =
            |column, row| window.corner() + size * dvec2(share(column, columns), share(row, rows));
        let nodes = (0..rows).flat_map(|row| (0..columns).map(move |column| node(column, row)));
        Self::new(columns, rows, nodes.collect())
    }

    /// The same grid with a node elsewhere. Columns and rows are counted from 0.
    ///
    /// # Errors
    /// [`GridError::NoNode`], and as [`CoordinateGrid::new`].
    pub fn with_node(&self, column: usize, row: usize, at: DVec2) -> Result<Self, GridError> {
        let (columns, rows) = self.shape();
        let mut nodes = self.nodes.clone();
        let inside = column < columns && row < rows;
        match nodes.get_mut(row * columns + column) {
            Some(node) if inside => *node = at,
            _ => {
                return Err(GridError::NoNode {
                    column,
                    row,
                    columns,
                    rows,
                });
            }
        }
        Self::new(columns, rows, nodes)
    }

    /// How many columns and rows.
    pub fn shape(&self) -> (usize, usize) {
        (self.columns, self.rows)
    }
    /// All nodes, as [`CoordinateGrid::new`] takes them.
    pub fn nodes(&self) -> &[DVec2] {
        &self.nodes
    }
    /// The node in that column and row, counted from 0; none outside.
    pub fn node(&self, column: usize, row: usize) -> Option<DVec2> {
        let inside = column < self.columns && row < self.rows;
        inside.then(|| self.nodes[row * self.columns + column])
    }
    /// The nodes of each row from the left, then of each column from the top: what a picture of the grid draws.
    pub fn polylines(&self) -> Vec<Vec<Plane>> {
        let rows = self.nodes.chunks_exact(self.columns).map(<[_]>::to_vec);
        let down = |column: usize| self.nodes[column..].iter().step_by(self.columns).copied();
        let columns = (0..self.columns).map(|column| down(column).collect());
        rows.chain(columns).collect()
    }

    /// The same lines as they go on between nodes, in `steps` (at least 1) straight pieces from each node to the next.
    ///
    /// # Errors
    /// [`GridError::Curve`] where coordinates overflow.
    pub fn curves(&self, spline: Spline, steps: usize) -> Result<Vec<Vec<Plane>>, GridError> {
        let steps = steps.max(1);
        let mut lines = self.polylines();
        for (number, line) in lines.iter_mut().enumerate() {
            // Rows are functions of x, columns of y.
            let axis = usize::from(number >= self.rows);
            let at: Vec<f64> = line.iter().map(|node| node[axis]).collect();
            let curve = spline::function(spline, &at, line.clone())?;
            let mut points = Vec::with_capacity(steps * at.len());
            for (pair, node) in at.windows(2).zip(line.iter()) {
                points.push(*node);
                let share = |step: usize| step as f64 / steps as f64;
                points.extend((1..steps).map(|step| {
                    let there = pair[0] + (pair[1] - pair[0]) * share(step);
                    let mut point = curve.point(there);
                    point[axis] = there;
                    point
                }));
            }
            points.extend(line.last());
            *line = points;
        }
        Ok(lines)
    }
}

/// Whether a coordinate lies far enough behind another.
fn apart(before: f64, behind: f64) -> bool {
    behind > before && behind - before >= LEAST_GAP
}

/// Grids of one shape, one for each key of time, and the way through them.
#[derive(Debug, Clone, PartialEq)]
pub struct GridKeys {
    keys: Vec<CoordinateGrid>,
    path: KeyPath,
}

impl GridKeys {
    /// The grids at 0, 1, 2, ….
    ///
    /// # Errors
    /// [`GridError::Key`] without grids; [`GridError::Unlike`] where shapes differ.
    pub fn new(keys: Vec<CoordinateGrid>, path: KeyPath) -> Result<Self, GridError> {
        let Some(first) = keys.first().map(CoordinateGrid::shape) else {
            return Err(KeyError::None.into());
        };
        let unlike = keys.iter().position(|grid| grid.shape() != first);
        if let Some(index) = unlike {
            let found = keys[index].shape();
            return Err(GridError::Unlike {
                index,
                found,
                first,
            });
        }
        Ok(Self { keys, path })
    }

    /// The grids.
    pub fn keys(&self) -> &[CoordinateGrid] {
        &self.keys
    }

    /// The grid at `parameter`: key `k` at `k`, exactly. Straight paths always give a grid; a smooth one may swing too far.
    ///
    /// # Errors
    /// [`GridError::Key`] outside the keys; as [`CoordinateGrid::new`] where nodes of a smooth path overtake each other.
    pub fn at(&self, parameter: f64) -> Result<CoordinateGrid, GridError> {
        let shares = self.path.shares(self.keys.len(), parameter)?;
        let base = &self.keys[shares.base];
        let nodes = 0..base.nodes.len();
        let nodes = nodes.map(|node| shares.mix(|key| self.keys[key].nodes[node]));
        CoordinateGrid::new(base.columns, base.rows, nodes.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window() -> Window {
        Window::new(-2, 3, 30, 20).unwrap()
    }

    #[test]
    fn grids_are_regular_and_nodes_are_found() {
        let grid = CoordinateGrid::regular(window(), 4, 3).unwrap();
        assert_eq!(grid.node(0, 0), Some(dvec2(-2.0, 3.0)));
        assert_eq!(grid.node(3, 2), Some(dvec2(28.0, 23.0)));
        assert_eq!(grid.node(1, 1), Some(dvec2(8.0, 13.0)));
        assert_eq!(grid.node(4, 0), None);
        assert_eq!(grid.node(0, 3), None);
        let lines = grid.polylines();
        assert_eq!(lines.len(), 7);
        assert_eq!((lines[0].len(), lines[3].len()), (4, 3));
        assert_eq!(lines[4][1], dvec2(8.0, 13.0));
    }

    #[test]
    fn bad_grids_are_refused_by_node() {
        let corners = |x: f64, y: f64| {
            vec![
                dvec2(0.0, 0.0),
                dvec2(x, 0.0),
                dvec2(0.0, y),
                dvec2(9.0, 9.0),
            ]
        };
        assert!(CoordinateGrid::new(2, 2, corners(9.0, 9.0)).is_ok());
        for (columns, rows, nodes, says) in [
            (1, 4, corners(9.0, 9.0), "at least 2 columns"),
            (3, 2, corners(9.0, 9.0), "needs 6"),
            (2, 2, corners(0.0, 9.0), "column 1, row 0"),
            (2, 2, corners(9.0, -1.0), "column 0, row 1"),
            (2, 2, corners(1e-9, 9.0), "the one to its left 0"),
            (2, 2, corners(f64::NAN, 9.0), "NaN"),
            (2, 2, corners(9.0, f64::INFINITY), "inf"),
            (2, 2, corners(1e300, 9.0), "no place of an image"),
            (2000, 2, corners(9.0, 9.0), "at most 1024"),
        ] {
            let message = CoordinateGrid::new(columns, rows, nodes)
                .unwrap_err()
                .to_string();
            assert!(message.contains(says), "{message}");
        }
        let grid = CoordinateGrid::regular(window(), 3, 3).unwrap();
        assert!(matches!(
            grid.with_node(3, 0, DVec2::ZERO),
            Err(GridError::NoNode { .. })
        ));
        assert!(matches!(
            grid.with_node(1, 1, dvec2(13.0, 30.0)),
            Err(GridError::Down { .. })
        ));
        let huge = CoordinateGrid::regular(window(), usize::MAX, 3);
        assert!(matches!(huge, Err(GridError::TooMany { .. })));
    }

    #[test]
    fn lines_go_on_as_the_spline_says() {
        let even = CoordinateGrid::regular(window(), 4, 3).unwrap();
        let grid = even.with_node(1, 1, dvec2(9.0, 15.0)).unwrap();
        for spline in Spline::all() {
            let lines = grid.curves(spline, 4).unwrap();
            let nodes = grid.polylines();
            assert_eq!(lines.len(), nodes.len());
            for (line, nodes) in lines.iter().zip(&nodes) {
                assert_eq!(line.len(), 4 * (nodes.len() - 1) + 1);
                let every: Vec<DVec2> = line.iter().copied().step_by(4).collect();
                assert_eq!(&every, nodes);
            }
        }
        let lines = grid.curves(Spline::Linear, 2).unwrap();
        assert_eq!(lines[1][1], dvec2(3.5, 14.0));
        // The slope at the left end is that of the chord, at the moved node that of the parabola.
        let smooth = grid.curves(Spline::CatmullRom, 2).unwrap()[1][1];
        let slope =
            |width: f64, next: f64| (2.0 / width * next - 2.0 / next * width) / (width + next);
        let expected = 14.0 + 11.0 * (2.0 / 11.0 - slope(11.0, 9.0)) / 8.0;
        assert!(
            (smooth - dvec2(3.5, expected)).length() < 1e-12,
            "{smooth} {expected}"
        );
    }

    #[test]
    fn bottlenecks_are_grids() {
        let grid = CoordinateGrid::regular(window(), 3, 3).unwrap();
        assert!(grid.with_node(1, 1, dvec2(27.999, 22.999)).is_ok());
    }

    #[test]
    fn keys_are_met_and_ways_between_are_straight_or_smooth() {
        let grid = |x: f64| {
            let even = CoordinateGrid::regular(window(), 3, 3).unwrap();
            even.with_node(1, 1, dvec2(x, 13.0)).unwrap()
        };
        let keys = vec![grid(5.0), grid(9.0), grid(8.0)];
        let straight = GridKeys::new(keys.clone(), KeyPath::Straight).unwrap();
        let smooth = GridKeys::new(keys.clone(), KeyPath::Smooth).unwrap();
        for (k, key) in keys.iter().enumerate() {
            assert_eq!(straight.at(k as f64).as_ref(), Ok(key));
            assert_eq!(smooth.at(k as f64).as_ref(), Ok(key));
        }
        let x = |keys: &GridKeys| keys.at(0.5).unwrap().node(1, 1).unwrap().x;
        assert!((x(&straight) - 7.0).abs() < 1e-12);
        // The chord at the first key is 4, the velocity at the second ½(8 − 5).
        assert!((x(&smooth) - (7.0 + (4.0 - 1.5) / 8.0)).abs() < 1e-12);
        assert!(matches!(straight.at(2.5), Err(GridError::Key(_))));
        let other = CoordinateGrid::regular(window(), 3, 4).unwrap();
        let unlike = GridKeys::new(vec![keys[0].clone(), other], KeyPath::Smooth);
        assert!(matches!(unlike, Err(GridError::Unlike { index: 1, .. })));
        // Smooth ways may overshoot: x of the middle node swings beyond the right border.
        let swing = vec![grid(5.0), grid(27.9), grid(27.9), grid(5.0)];
        let smooth = GridKeys::new(swing, KeyPath::Smooth).unwrap();
        assert!(matches!(
            smooth.at(1.5),
            Err(GridError::Across {
                column: 2,
                row: 1,
                ..
            })
        ));
    }
}
