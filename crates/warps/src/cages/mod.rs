//! Cages: control points and frames of lattices as points and wires that are edited in a modeller and read back.
//!
//! A cage of control points has one point each, in the flat order of [`Grid`] (the last axis runs fastest), and wires
//! along the lines of the grid. A cage of frames has, for each control frame in the same order, its origin and the tips of
//! its basis vectors, joined to the origin by a wire each. A few words, kept as comments where the file format has them,
//! say what a cage is; without them the order and place of the points tell.
//!
//! *Source*: the layout is a decision; T. W. Sederberg and S. R. Parry, *Free-Form Deformation of Solid Geometric Models*,
//! SIGGRAPH 1986, for the numbering of control points.

#[cfg(feature = "recipe")]
mod fit;
#[cfg(feature = "recipe")]
mod read;
#[cfg(feature = "recipe")]
mod topology;

#[cfg(feature = "recipe")]
pub(crate) use fit::{NoFit, fit, infer_shape};
#[cfg(feature = "recipe")]
pub(crate) use read::{Feature, expect_in_space, load, missing};

use crate::lattices::bernstein::BernsteinLattice;
use crate::lattices::bspline::{BsplineLattice, Knots};
use crate::lattices::{Grid, LatticeError, PointLattice};
use anamorph_core::{Linear, Space};

/// Most control points of one lattice: beyond it someone has surely slipped a zero.
pub const MOST_CONTROL_POINTS: usize = 4_000_000;

/// How long the arrows of a control frame are: a share of the distance to the next one.
const ARROW: f64 = 0.4;

/// Which warp a cage is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CageKind {
    /// Control points of `lattice`.
    Lattice,
    /// Control points of `spline-lattice`, of this degree and with these knots.
    Spline(usize, Knots),
    /// Control frames of `frame-lattice`.
    Frames,
}

/// Points and wires around a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Cage<S> {
    /// The warp it is for.
    pub kind: CageKind,
    /// Number of control points or frames along each axis; 1 for an axis the space does not have.
    pub shape: [usize; 3],
    /// The points.
    pub points: Vec<S>,
    /// Its wires, by the points' indices from 0.
    pub lines: Vec<Vec<u32>>,
}

impl<S: Space> Cage<S> {
    /// The control points of a lattice on `grid` as they are before any edit.
    ///
    /// # Errors
    /// Those of the lattice, such as a shape that it does not take.
    pub fn new(grid: Grid<S>, kind: CageKind) -> Result<Self, LatticeError> {
        let shape = grid.shape();
        let still = vec![S::ZERO; grid.len()];
        fn points<S: Space>(lattice: &impl PointLattice<S>) -> Vec<S> {
            (0..lattice.grid().len())
                .map(|flat| lattice.control_point(flat))
                .collect()
        }
        let (points, lines) = match kind {
            CageKind::Lattice => (
                points(&BernsteinLattice::construct(grid, still)?),
                grid_lines(shape),
            ),
            CageKind::Spline(degree, knots) => (
                points(&BsplineLattice::construct(grid, degree, knots, still)?),
                grid_lines(shape),
            ),
            CageKind::Frames => {
                let origins = points(&BernsteinLattice::construct(grid.clone(), still)?);
                (frame_points(&grid, &origins), frame_lines::<S>(grid.len()))
            }
        };
        if let Some(index) = points.iter().position(|point| !point.is_finite()) {
            return Err(LatticeError::NotFinite { index });
        }
        Ok(Self {
            kind,
            shape,
            points,
            lines,
        })
    }

    /// The words that say what it is, a line each; recipes read them from the comments of a file.
    pub fn words(&self) -> Vec<String> {
        let mut words = vec![format!("cage: {}", self.kind.name())];
        let counts: Vec<String> = self.shape[..S::DIM].iter().map(usize::to_string).collect();
        words.push(format!("shape: {}", counts.join(" ")));
        if let CageKind::Spline(degree, knots) = self.kind {
            words.push(format!("degree: {degree}"));
            words.push(format!("knots: {}", knots_name(knots)));
        }
        words
    }
}

impl CageKind {
    /// The kind of warp that reads it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Lattice => "lattice",
            Self::Spline(..) => "spline-lattice",
            Self::Frames => "frame-lattice",
        }
    }
}

fn knots_name(knots: Knots) -> &'static str {
    match knots {
        Knots::Uniform => "uniform",
        Knots::Clamped => "clamped",
    }
}

/// The lines of a grid of points, along each axis in turn.
fn grid_lines(shape: [usize; 3]) -> Vec<Vec<u32>> {
    let strides = [shape[1] * shape[2], shape[2], 1];
    let count: usize = shape.iter().product();
    let mut lines = Vec::new();
    for (stride, points) in strides.into_iter().zip(shape) {
        let starts = (0..count).filter(|flat| points > 1 && flat / stride % points == 0);
        lines.extend(starts.map(|start| {
            (0..points)
                .filter_map(|step| u32::try_from(start + step * stride).ok())
                .collect::<Vec<u32>>()
        }));
    }
    lines
}

/// Origins and tips of the control frames of a grid.
pub(crate) fn frame_points<S: Space>(grid: &Grid<S>, origins: &[S]) -> Vec<S> {
    let shape = grid.shape();
    let mut points = Vec::with_capacity(origins.len() * (S::DIM + 1));
    for &origin in origins {
        points.push(origin);
        points.extend((0..S::DIM).map(|axis| {
            #[allow(clippy::cast_precision_loss)]
            let step = (shape[axis].max(2) - 1) as f64;
            origin + grid.edges().column(axis) * (ARROW / step)
        }));
    }
    points
}

/// The wires of frames: from each origin to its tips.
fn frame_lines<S: Space>(frames: usize) -> Vec<Vec<u32>> {
    let step = S::DIM + 1;
    let index = |i: usize| u32::try_from(i).unwrap_or(u32::MAX);
    (0..frames * step)
        .filter(|i| i % step != 0)
        .map(|i| vec![index(i - i % step), index(i)])
        .collect()
}

/// The joined pairs of points of wires, the smaller index first, sorted.
#[cfg(feature = "recipe")]
pub(crate) fn edges(lines: &[Vec<u32>]) -> Vec<[u32; 2]> {
    let pairs = lines.iter().flat_map(|line| line.windows(2));
    let mut edges: Vec<[u32; 2]> = pairs
        .map(|pair| [pair[0].min(pair[1]), pair[0].max(pair[1])])
        .collect();
    edges.sort_unstable();
    edges
}

/// The joined neighbours of a grid of control points.
#[cfg(feature = "recipe")]
pub(crate) fn grid_edges(shape: [usize; 3]) -> Vec<[u32; 2]> {
    edges(&grid_lines(shape))
}

/// The joined points of control frames.
#[cfg(feature = "recipe")]
pub(crate) fn frame_edges<S: Space>(frames: usize) -> Vec<[u32; 2]> {
    edges(&frame_lines::<S>(frames))
}

/// What the comments of a file say about a cage.
#[cfg(feature = "recipe")]
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Said {
    /// The kind of warp it is for.
    pub(crate) kind: Option<String>,
    /// Number of control points or frames along each axis.
    pub(crate) shape: Option<Vec<usize>>,
    /// Degree of the splines.
    pub(crate) degree: Option<usize>,
    /// How knots are spread.
    pub(crate) knots: Option<Knots>,
}

#[cfg(feature = "recipe")]
impl Said {
    /// Reads [`Cage::words`] from comments, and passes over everything else.
    pub(crate) fn of(comments: &[String]) -> Self {
        let mut said = Self::default();
        for line in comments {
            let Some((key, value)) = line.split_once(':') else {
                continue;
            };
            let value = value.trim();
            match key.trim() {
                "cage" => said.kind = Some(value.to_owned()),
                "shape" => {
                    let counts = value.split_whitespace().map(str::parse);
                    said.shape = counts.collect::<Result<_, _>>().ok();
                }
                "degree" => said.degree = value.parse().ok(),
                "knots" => {
                    said.knots = [Knots::Uniform, Knots::Clamped]
                        .into_iter()
                        .find(|&knots| knots_name(knots) == value);
                }
                _ => {}
            }
        }
        // Without the first line the others may be anybody's.
        if said.kind.is_some() {
            said
        } else {
            Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::{Bounds, Plane, Solid, glam::dvec2, glam::dvec3};

    #[test]
    fn points_and_wires_follow_the_flat_order() {
        let bounds = Bounds::new(dvec3(0.0, 0.0, 0.0), dvec3(1.0, 2.0, 3.0));
        let grid = Grid::around(bounds, &[2, 3, 4]).unwrap();
        let cage = Cage::new(grid.clone(), CageKind::Lattice).unwrap();
        assert_eq!(cage.points.len(), 24);
        assert_eq!(cage.points[1], dvec3(0.0, 0.0, 1.0));
        assert_eq!(cage.points[4], dvec3(0.0, 1.0, 0.0));
        assert_eq!(cage.points[12], dvec3(1.0, 0.0, 0.0));
        // Lines along x, y and z: as many as the other two axes have points.
        assert_eq!(cage.lines.len(), 12 + 8 + 6);
        for line in &cage.lines {
            for pair in line.windows(2) {
                let [a, b] = [pair[0], pair[1]].map(|i| grid.triple(i as usize));
                let apart: usize = (0..3).map(|axis| a[axis].abs_diff(b[axis])).sum();
                assert_eq!(apart, 1, "{a:?} {b:?}");
            }
        }
        let grid = Grid::around(Bounds::new(dvec2(0.0, 0.0), dvec2(2.0, 1.0)), &[3, 2]).unwrap();
        let cage = Cage::<Plane>::new(grid, CageKind::Frames).unwrap();
        assert_eq!(cage.points.len(), 3 * 6);
        assert_eq!(
            cage.points[9..12],
            [dvec2(1.0, 1.0), dvec2(1.4, 1.0), dvec2(1.0, 1.4)]
        );
        assert_eq!(cage.lines[6..8], [vec![9, 10], vec![9, 11]]);
    }

    #[cfg(feature = "recipe")]
    #[test]
    fn words_are_read_as_written() {
        let grid = Grid::around(Bounds::new(Solid::ZERO, Solid::ONE), &[5, 6, 7]).unwrap();
        let cage = Cage::new(grid, CageKind::Spline(3, Knots::Clamped)).unwrap();
        let said = Said::of(&cage.words());
        assert_eq!(said.kind.as_deref(), Some("spline-lattice"));
        assert_eq!(said.shape, Some(vec![5, 6, 7]));
        assert_eq!((said.degree, said.knots), (Some(3), Some(Knots::Clamped)));
        // Without the words of a cage, a shape is someone else's.
        assert_eq!(Said::of(&["shape: 1 2 3".to_owned()]), Said::default());
        assert_eq!(
            Said::of(&["cage: lattice".to_owned(), "shape: a b".to_owned()]).shape,
            None
        );
    }
}
