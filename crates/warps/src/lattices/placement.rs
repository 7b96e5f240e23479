//! Where the box of a lattice stands and where its control points went, as recipes say it: by shape and box, or by files.
//!
//! *Source*: Milliron et al. 2002, §4.1; the notation is a decision.

use super::{Grid, LatticeError};
use crate::cages::{
    Cage, CageKind, Feature, MOST_CONTROL_POINTS, Said, fit, frame_edges, grid_edges, infer_shape,
    missing,
};
use anamorph_catalog::schemars::JsonSchema;
use anamorph_catalog::{ConstructError, Context, Length, Offset, Place, schemars};
use anamorph_core::{Affine, Bounds, Linear, Space};
use anamorph_features::{Frame, FramePair};
use serde::Deserialize;

/// The box of a lattice.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "a box is \"fit\", or a table with `min` and `max`, or with `origin` and `edges`"
)]
pub(super) enum BoxParameters {
    /// The bounds of the model.
    #[default]
    #[serde(skip)]
    Fit,
    /// `"fit"`, written out.
    Named(Fit),
    /// An axis-parallel box.
    Corners(Corners),
    /// A skew box.
    Edges(Edges),
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub(crate) enum Fit {
    /// The bounds of the model.
    Fit,
}

/// An axis-parallel box between two corners.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub(crate) struct Corners {
    /// One corner.
    min: Place,
    /// The opposite corner.
    max: Place,
}

impl Corners {
    /// The box between the corners.
    pub(crate) fn bounds<S: Space>(
        &self,
        context: &Context<'_, S>,
    ) -> Result<Bounds<S>, ConstructError> {
        let min = self.min.resolve("box.min", context)?;
        Ok(Bounds::new(min, self.max.resolve("box.max", context)?))
    }
}

/// A box spanned by edges from a corner.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(inline)]
pub(super) struct Edges {
    /// The corner with index 0, 0, 0.
    origin: Place,
    /// One edge per axis.
    edges: Vec<Offset>,
}

/// Refuses counts that are not one per axis, or beyond any use.
fn check_shape<S: Space>(shape: &[usize]) -> Result<(), ConstructError> {
    if shape.len() != S::DIM {
        let message = format!(
            "{} counts where the {} has {} axes",
            shape.len(),
            S::NAME,
            S::DIM
        );
        return Err(ConstructError::new("shape", message)
            .with_hint("count the control points along each axis"));
    }
    let count = shape
        .iter()
        .try_fold(1_usize, |product, &n| product.checked_mul(n));
    if count.is_none_or(|count| count > MOST_CONTROL_POINTS) {
        return Err(
            ConstructError::new("shape", "that many control points are beyond any use")
                .with_hint(format!("a lattice has at most {MOST_CONTROL_POINTS}")),
        );
    }
    Ok(())
}

/// The grid of a lattice.
fn grid<S: Space>(
    shape: &[usize],
    parameters: Option<&BoxParameters>,
    margin: Option<Length>,
    context: &Context<'_, S>,
) -> Result<Grid<S>, ConstructError> {
    check_shape::<S>(shape)?;
    let margin = match margin {
        Some(length) => {
            let margin = length.resolve("margin", context)?;
            if margin < 0.0 || !margin.is_finite() {
                return Err(
                    ConstructError::new("margin", format!("the margin is {margin}"))
                        .with_hint("write a length that is not negative"),
                );
            }
            margin
        }
        None => 0.0,
    };
    let grid = match parameters {
        None | Some(BoxParameters::Fit | BoxParameters::Named(Fit::Fit)) => {
            Grid::around_with_margin(context.bounds("box")?, margin, shape)
        }
        Some(BoxParameters::Corners(corners)) => {
            Grid::around_with_margin(corners.bounds(context)?, margin, shape)
        }
        Some(BoxParameters::Edges(edges)) => {
            if margin != 0.0 {
                return Err(
                    ConstructError::new("margin", "a box given by edges takes no margin")
                        .with_hint("remove it"),
                );
            }
            if edges.edges.len() != S::DIM {
                let message = format!(
                    "{} edges where the {} has {} axes",
                    edges.edges.len(),
                    S::NAME,
                    S::DIM
                );
                return Err(
                    ConstructError::new("box.edges", message).with_hint("write one edge per axis")
                );
            }
            let origin = edges.origin.resolve("box.origin", context)?;
            let mut columns = Vec::new();
            for (i, edge) in edges.edges.iter().enumerate() {
                columns.push(edge.resolve::<S>(&format!("box.edges.{i}"), context)?);
            }
            Grid::new(origin, S::Linear::from_columns(|i| columns[i]), shape)
        }
    };
    grid.map_err(|error| ConstructError::new("box", error.to_string()))
}

/// An error of a lattice at its parameter.
pub(super) fn located(error: &LatticeError) -> ConstructError {
    let path = match error {
        LatticeError::Flat | LatticeError::Overflow => "box",
        LatticeError::Shape { .. } => "shape",
        LatticeError::Count { .. } | LatticeError::NotFinite { .. } => "move",
    };
    ConstructError::new(path, error.to_string())
}

/// What a recipe says about a lattice.
pub(super) struct Placement<'a, S> {
    /// Number of control points along each axis.
    pub(super) shape: Option<&'a [usize]>,
    /// The box.
    pub(super) bounds: Option<&'a BoxParameters>,
    /// By how much it is larger.
    pub(super) margin: Option<Length>,
    /// The cage as it was.
    pub(super) source: Option<Feature<S>>,
    /// The cage as it was edited.
    pub(super) target: Option<Feature<S>>,
}

/// A lattice with its cage, in the order of [`Cage`].
pub(super) struct Placed<S: Space> {
    /// The box and its grid.
    pub(super) grid: Grid<S>,
    /// The points of the cage as they were.
    pub(super) rest: Vec<S>,
    /// The points as a file has them edited.
    pub(super) target: Option<Vec<S>>,
}

/// Counts as messages show them.
fn by(shape: &[usize]) -> String {
    let counts: Vec<String> = shape.iter().map(usize::to_string).collect();
    counts.join(" × ")
}

impl<S: Space> Placement<'_, S> {
    /// What the files say about the cage: the source, or else the target.
    pub(super) fn said(&self) -> Said {
        let file = self.source.as_ref().or(self.target.as_ref());
        file.map_or_else(Said::default, |file| file.said.clone())
    }

    /// The grid and the cage of the given kind.
    pub(super) fn place(
        &self,
        kind: CageKind,
        context: &Context<'_, S>,
    ) -> Result<Placed<S>, ConstructError> {
        for file in [&self.source, &self.target].into_iter().flatten() {
            file.expect_kind(kind.name())?;
        }
        if let (Some(own), Some(said)) = (self.shape, self.said().shape)
            && own != said
        {
            let file = self.source.as_ref().or(self.target.as_ref());
            let message = format!(
                "the shape is {}, but {} says that it is {}",
                by(own),
                file.map_or("the file", |file| file.name.as_str()),
                by(&said)
            );
            return Err(ConstructError::new("shape", message)
                .with_hint("remove it here, or make the cage again"));
        }
        let (grid, rest, origin) = match &self.source {
            Some(source) => {
                let (grid, rest) = self.of_source(source, kind)?;
                (grid, rest, source.name.clone())
            }
            None => {
                let said = self.said().shape;
                let shape = self
                    .shape
                    .or(said.as_deref())
                    .ok_or_else(|| missing("shape"))?;
                let grid = grid(shape, self.bounds, self.margin, context)?;
                let cage = Cage::new(grid.clone(), kind).map_err(|error| located(&error))?;
                (grid, cage.points, "the lattice of the recipe".to_owned())
            }
        };
        let target = match &self.target {
            Some(target) => {
                let edges = expected_edges::<S>(kind, &grid);
                let near = kind.near::<S>(grid.shape());
                let points = target.cage(&origin, rest.len(), &edges, &near)?;
                Some(target.settled(&origin, &rest, &points, &edges)?)
            }
            None => None,
        };
        Ok(Placed { grid, rest, target })
    }

    /// The grid that a file shows, with the points as they stand there.
    fn of_source(
        &self,
        source: &Feature<S>,
        kind: CageKind,
    ) -> Result<(Grid<S>, Vec<S>), ConstructError> {
        for (key, given) in [
            ("box", self.bounds.is_some()),
            ("margin", self.margin.is_some()),
        ] {
            if given {
                let message = format!("{} says where the box is", source.name);
                return Err(ConstructError::new(key, message)
                    .with_hint(format!("remove `{key}`, or `source`")));
            }
        }
        let step = if kind == CageKind::Frames {
            S::DIM + 1
        } else {
            1
        };
        let origins = |points: &[S]| -> Vec<S> { points.iter().step_by(step).copied().collect() };
        let shape = self.shape.map(<[usize]>::to_vec);
        let shape = shape.or_else(|| source.said.shape.clone());
        let shape = shape.or_else(|| infer_shape(&origins(&source.points)));
        let Some(shape) = shape else {
            let message = format!(
                "the points of {} stand in no even grid, and it does not say the cage's shape",
                source.name
            );
            return Err(source.fail(
                message,
                "name the cage as `anamorph cage` wrote it, before any edit, or add `shape`",
            ));
        };
        check_shape::<S>(&shape)?;
        let unit = Grid::unit(&shape).map_err(|error| located(&error))?;
        let cage = Cage::new(unit.clone(), kind).map_err(|error| located(&error))?;
        let what = format!("a cage of {} control points", by(&shape));
        let edges = expected_edges::<S>(kind, &unit);
        let near = kind.near::<S>(unit.shape());
        let points = source.cage(&what, cage.points.len(), &edges, &near)?;
        let grid = fit(&origins(&points), &origins(&cage.points), &shape);
        let grid = grid.map_err(|error| match error {
            crate::cages::NoFit::Box(error) => {
                source.fail(format!("the cage of {}: {error}", source.name), "")
            }
            crate::cages::NoFit::Off(flat, off) => {
                let place = unit.triple(flat);
                let message = format!(
                    "v {} of {}, control point {:?}, stands {off:.3e} from its place in an even grid of {}",
                    flat * step + 1,
                    source.name,
                    &place[..S::DIM],
                    by(&shape)
                );
                source.fail(
                    message,
                    "`source` is the cage before any edit, as `anamorph cage` wrote it; name the edited one as `target`",
                )
            }
        })?;
        Ok((grid, points))
    }
}

fn expected_edges<S: Space>(kind: CageKind, grid: &Grid<S>) -> Vec<[u32; 2]> {
    if kind == CageKind::Frames {
        frame_edges::<S>(grid.len())
    } else {
        grid_edges(grid.shape())
    }
}

/// The maps that take the frames of one cage to those of another.
pub(crate) fn frame_maps<S: Space>(
    rest: &[S],
    target: &[S],
) -> Result<Vec<Affine<S>>, ConstructError> {
    frame_pairs(rest, target)?
        .iter()
        .map(|pair| match pair {
            None => Ok(Affine::IDENTITY),
            Some(pair) => pair
                .affine()
                .map_err(|error| ConstructError::new("target", error.to_string())),
        })
        .collect()
}

/// Pairs of frames from points that are origins and tips; `None` where nothing moved.
pub(crate) fn frame_pairs<S: Space>(
    rest: &[S],
    target: &[S],
) -> Result<Vec<Option<FramePair<S>>>, ConstructError> {
    let step = S::DIM + 1;
    let frame = |key: &str, number: usize, points: &[S]| {
        let basis = S::Linear::from_columns(|axis| points[axis + 1] - points[0]);
        Frame::new(points[0], basis).map_err(|error| {
            let first = number * step + 1;
            let message = format!("the frame of v {first} to {}: {error}", first + S::DIM);
            ConstructError::new(key, message)
        })
    };
    let pairs = rest.chunks_exact(step).zip(target.chunks_exact(step));
    pairs
        .enumerate()
        .map(|(number, (rest, target))| {
            let source = frame("source", number, rest)?;
            if rest == target {
                return Ok(None);
            }
            Ok(Some(FramePair {
                source,
                target: frame("target", number, target)?,
            }))
        })
        .collect()
}
