//! How recipes describe grids and edits of their nodes.
//!
//! *Source*: Burtnyk and Wein 1976; edits are those of lattices (Milliron et al. 2002, §4.1), the rest is a decision.

use super::{Between, GridError, GridWarp};
use crate::lattices::parameters::{MoveParameters, edit};
use crate::lattices::{Grid, LatticeError};
use anamorph_catalog::schemars::JsonSchema;
use anamorph_catalog::{
    Built, ConstructError, Context, Coordinate, Value, WarpEntry, parse, schemars,
};
use anamorph_core::{Bounds, Plane};
use serde::Deserialize;

/// Where the columns or rows of a grid are.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "a number of columns or rows, or a list of their coordinates, such as [\"0%\", \"30%\", \"100%\"]"
)]
#[schemars(inline)]
enum Lines {
    /// So many, evenly over the model.
    Count(usize),
    /// Their coordinates, ascending.
    At(Vec<Coordinate>),
}

/// How displacements go on between nodes.
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum BetweenName {
    /// Each cell is bilinear.
    Bilinear,
    /// Bicubic, without creases.
    Smooth,
}

/// A grid of nodes; each cell of the plane follows its corners.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct GridParameters {
    /// How many columns, evenly over the model, or their coordinates.
    columns: Lines,
    /// How many rows, evenly over the model, or their coordinates.
    rows: Lines,
    /// Between the nodes "bilinear", also if left out, or "smooth".
    cells: Option<BetweenName>,
    /// Edits of nodes, applied in order.
    #[serde(default, rename = "move")]
    moves: Vec<MoveParameters>,
}

fn located(error: &GridError) -> ConstructError {
    let path = match error {
        GridError::TooFew { what, .. } => (*what).to_owned(),
        GridError::Order { what, index } => format!("{what}.{index}"),
        GridError::TooMany { .. } => "columns".to_owned(),
        GridError::Count { .. } | GridError::NotFinite { .. } => "move".to_owned(),
    };
    ConstructError::new(path, error.to_string())
}

/// Coordinates of columns (axis 0) or rows (axis 1).
fn coordinates(
    lines: &Lines,
    path: &'static str,
    axis: usize,
    context: &Context<'_, Plane>,
) -> Result<Vec<f64>, ConstructError> {
    let within = || {
        let bounds = context.bounds(path)?;
        Ok::<_, ConstructError>((bounds.min[axis], bounds.max[axis]))
    };
    match lines {
        Lines::Count(count) => {
            if !(2..=super::MOST_NODES).contains(count) {
                let message = format!(
                    "there are {count} {path}, and a grid has 2 to {}",
                    super::MOST_NODES
                );
                return Err(ConstructError::new(path, message));
            }
            let (from, to) = within()?;
            #[allow(clippy::cast_precision_loss)]
            let at = |i: usize| {
                let share = i as f64 / (count - 1) as f64;
                // Exact at both ends.
                from * (1.0 - share) + to * share
            };
            Ok((0..*count).map(at).collect())
        }
        Lines::At(list) => {
            let place = |coordinate: &Coordinate| -> Result<f64, ConstructError> {
                match *coordinate {
                    Coordinate::Absolute(x) => Ok(x),
                    Coordinate::Relative(share) => {
                        let (from, to) = within()?;
                        Ok(from * (1.0 - share) + to * share)
                    }
                }
            };
            list.iter().map(place).collect()
        }
    }
}

/// The registry entry of grids.
pub(crate) fn grid() -> WarpEntry<Plane> {
    fn construct(
        value: &Value,
        context: &Context<'_, Plane>,
    ) -> Result<Built<Plane>, ConstructError> {
        let p: GridParameters = parse(value)?;
        let columns = coordinates(&p.columns, "columns", 0, context)?;
        let rows = coordinates(&p.rows, "rows", 1, context)?;
        let between = match p.cells {
            None | Some(BetweenName::Bilinear) => Between::Bilinear,
            Some(BetweenName::Smooth) => Between::Smooth,
        };
        // Refuses columns and rows before nodes are counted by them.
        let shape = [columns.len(), rows.len()];
        let count = shape[0].saturating_mul(shape[1]);
        let still = vec![Plane::ZERO; count.min(super::MOST_NODES + 1)];
        GridWarp::construct(columns.clone(), rows.clone(), between, still)
            .map_err(|error| located(&error))?;
        let rest = GridWarp::nodes(&columns, &rows);
        let numbering = |error: LatticeError| ConstructError::new("columns", error.to_string());
        let unit = Bounds::new(Plane::ZERO, Plane::ONE);
        let numbers = Grid::around(unit, &shape).map_err(numbering)?;
        let targets = edit(&numbers, &rest, None, &p.moves, context)?;
        let moves: Vec<Plane> = targets
            .iter()
            .zip(&rest)
            .map(|(&to, &from)| to - from)
            .collect();
        let nodes = moves.len();
        let built = move |changes: &[Plane]| {
            let moved = moves.iter().zip(changes).map(|(&d, &change)| d + change);
            let warp = GridWarp::construct(columns.clone(), rows.clone(), between, moved.collect());
            let warp = warp.map_err(|error| located(&error))?;
            Ok(Built::new(warp.marks(), Box::new(warp)))
        };
        Ok(built(&vec![Plane::ZERO; nodes])?.fitted_by(nodes, built))
    }
    WarpEntry {
        kind: "grid",
        system: "B24",
        figure: "",
        summary: "a grid over the plane: each cell follows its corners",
        reference: "N. Burtnyk and M. Wein, Interactive Skeleton Techniques for Enhancing Motion Dynamics in Key Frame Animation, \
                    CACM 19(10), 1976",
        example: "columns = 4\nrows = [\"0%\", \"30%\", \"100%\"]\ncells = \"smooth\"\n\
                  move = [{ index = [1, 1], by = [\"12%\", \"5%\"] }]\n",
        schema: GridParameters::json_schema,
        construct,
    }
}
