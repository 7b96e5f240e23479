//! Recipes as morphs: the features of the one warp, where they are at a time, and how far colours have dissolved.
//!
//! A recipe of a warp between features, or of a coordinate grid (`[grid]`), says at the same time what a morph of two images needs: the sources stand on the first image, the
//! targets on the second. Schedules, eases and tracks are those of recipes over time; only what becomes of colours is said besides, as
//! `dissolve` under `[time]`, and whether lines go straight or turn, as `path`.
//!
//! *Source*: Beier and Neely, *Feature-Based Image Metamorphosis*, SIGGRAPH 1992 (§3.3: features between the images; shape and colour apart);
//! S. Lee, K.-Y. Chwa, S. Y. Shin, *Image Metamorphosis Using Snakes and Free-Form Deformations*, SIGGRAPH 1995 (a schedule for each feature).
//! The notation is a decision.

use crate::construct::construct;
use crate::error::{Problem, RecipeError, quoted};
use crate::names::nearest;
use crate::time::ease;
use crate::tree::{Part, join};
use crate::words::plain;
use crate::{Recipe, Registry};
use anamorph_catalog::schemars::{self, JsonSchema, SchemaGenerator};
use anamorph_catalog::{Between, ConstructError, Context, Place, parse};
use anamorph_core::Space;
use serde::Deserialize;
use serde_json::{Map, Value};

/// Words of `path`.
pub(crate) const PATHS: [&str; 2] = ["straight", "turning"];
/// Keys of a warp that its fields and pins are, which in-betweens have no place for.
const WITHOUT: [&str; 6] = ["strength", "weight", "ambient", "mask", "fit", "scaling"];

/// The features that a recipe carries from one image to another.
pub struct MorphFeatures<S: Space> {
    /// What it is called: the warp's label or kind.
    pub title: String,
    /// The places of each feature on the first image.
    pub sources: Vec<Vec<S>>,
    /// The places of each feature on the second.
    pub targets: Vec<Vec<S>>,
    /// What leads from places to places.
    pub way: MorphWay<S>,
}

/// What a morph goes by.
pub enum MorphWay<S: Space> {
    /// A warp, built again between any features.
    Warp(Box<Between<S>>),
    /// A coordinate grid, the features being its nodes, row by row.
    Grid {
        /// Nodes in a row.
        columns: usize,
        /// Nodes in a column.
        rows: usize,
        /// The name of the curves through them, if the recipe says it.
        curves: Option<String>,
    },
}

/// A coordinate grid over each of two images, for morphs: x increases along its rows, y down its columns.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct GridParameters {
    /// Nodes in a row.
    columns: usize,
    /// Nodes in a column.
    rows: usize,
    /// The curves through the nodes: "catmull-rom" (also if left out), "monotone" or "linear".
    curves: Option<String>,
    /// The nodes on the first image, row by row from the top: a file of points or a list; evenly spread if left out.
    source: Option<Nodes>,
    /// The nodes on the second image; evenly spread if left out.
    target: Option<Nodes>,
    /// When the nodes move.
    #[allow(dead_code, reason = "read where time is")]
    #[schemars(with = "Option<Map<String, Value>>")]
    schedule: Option<Value>,
}

/// The nodes of a grid.
#[derive(Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "the name of a file of points, or a list of places row by row, such as [[0, 0], [\"50%\", 0]]"
)]
#[schemars(inline)]
enum Nodes {
    /// A file of points.
    File(String),
    /// The places.
    Places(Vec<Place>),
}

/// Nodes are at least so far apart along a row or column, in pixels.
const LEAST_GAP: f64 = 1e-6;
/// Most nodes of a grid in a row or column.
const MOST_LINES: usize = 1024;

impl GridParameters {
    fn check(&self) -> Result<(), ConstructError> {
        for (key, count) in [("columns", self.columns), ("rows", self.rows)] {
            if !(2..=MOST_LINES).contains(&count) {
                let message = format!("there are {count} {key}, and a grid has 2 to {MOST_LINES}");
                return Err(ConstructError::new(key, message).with_hint("write another number"));
            }
        }
        Ok(())
    }

    fn nodes<S: Space>(
        &self,
        key: &'static str,
        context: &Context<'_, S>,
    ) -> Result<Vec<S>, ConstructError> {
        let count = self.columns * self.rows;
        let nodes = match if key == "source" {
            &self.source
        } else {
            &self.target
        } {
            None => {
                let bounds = context.bounds(key)?;
                let at = |i: usize, of: usize| i as f64 / (of - 1) as f64;
                let node = |i: usize| {
                    let shares = [
                        at(i % self.columns, self.columns),
                        at(i / self.columns, self.rows),
                    ];
                    S::from_fn(|axis| {
                        let share = shares[axis.min(1)];
                        bounds.min.component(axis) * (1.0 - share)
                            + bounds.max.component(axis) * share
                    })
                };
                (0..count).map(node).collect::<Vec<S>>()
            }
            Some(Nodes::Places(list)) => {
                let each = list.iter().enumerate();
                each.map(|(i, place)| place.resolve(&format!("{key}.{i}"), context))
                    .collect::<Result<_, _>>()?
            }
            Some(Nodes::File(name)) => {
                let mesh = context.mesh(key, name)?;
                let flat = |p: &anamorph_core::glam::DVec3| S::from_fn(|axis| p[axis]);
                mesh.points.iter().map(flat).collect()
            }
        };
        if nodes.len() != count {
            let message = format!(
                "there are {} nodes, and {} columns and {} rows have {count}",
                nodes.len(),
                self.columns,
                self.rows
            );
            return Err(
                ConstructError::new(key, message).with_hint("list them row by row from the top")
            );
        }
        self.check_order(key, &nodes)?;
        Ok(nodes)
    }

    /// Refuses a grid that is folded: the node is named as the recipe lists it.
    fn check_order<S: Space>(&self, key: &'static str, nodes: &[S]) -> Result<(), ConstructError> {
        let listed = match key {
            "source" => &self.source,
            _ => &self.target,
        };
        for (i, node) in nodes.iter().enumerate() {
            let (column, row) = (i % self.columns, i / self.columns);
            let left = column
                .checked_sub(1)
                .map(|_| (i - 1, 0, "x", "to its left"));
            let above = row
                .checked_sub(1)
                .map(|_| (i - self.columns, 1, "y", "above it"));
            for (other, axis, name, where_) in left.into_iter().chain(above) {
                let (own, before) = (node.component(axis), nodes[other].component(axis));
                if own - before >= LEAST_GAP {
                    continue;
                }
                let path = match listed {
                    Some(Nodes::Places(_)) => format!("{key}.{i}"),
                    _ => key.to_owned(),
                };
                let message = format!(
                    "the grid folds: the node in column {column}, row {row} (counted from 0) has {name} = {own}, and the one {where_} has {before}"
                );
                let hint = "x has to grow along each row, and y down each column; move one of them";
                return Err(ConstructError::new(path, message).with_hint(hint));
            }
        }
        Ok(())
    }
}

/// The JSON Schema of `[grid]`.
pub(crate) fn grid_schema(generator: &mut SchemaGenerator) -> Value {
    Value::from(GridParameters::json_schema(generator))
}

impl Recipe {
    /// The features of the recipe's one warp at a time from 0 to 1 (its tracks have set their values): sources by the context of the
    /// first image, targets by that of the second. Schedules are not in force; see [`Recipe::morph_ways`].
    ///
    /// # Errors
    ///
    /// All problems that [`Recipe::check_keys`] finds; no warp or several; one that is not made of pairs of features, or has fields, which
    /// in-betweens have no place for; what the warp finds wrong, at its line.
    pub fn morph_features<S: Space>(
        &self,
        time: f64,
        registry: &Registry<S>,
        source: &Context<'_, S>,
        target: &Context<'_, S>,
    ) -> Result<MorphFeatures<S>, RecipeError> {
        let mut problems = self.key_problems(registry);
        if let Some(grid) = self.tree.get("grid") {
            self.check_grid(grid, &mut problems);
        }
        if let Some(error) = RecipeError::of(&self.source.name, problems) {
            return Err(error);
        }
        let recipe = self.at(time)?;
        if let Some(grid) = recipe.tree.get("grid") {
            let one = |error: ConstructError| {
                let at = join("grid", &error.path);
                let problem = recipe.problem(&at, Part::Value, error.message, error.hint);
                RecipeError::one(&self.source.name, problem)
            };
            return morph_grid(grid, source, target).map_err(one);
        }
        let fail = |path: &str, part, message: String, hint: &str| {
            RecipeError::one(&self.source.name, recipe.problem(path, part, message, hint))
        };
        let tables = recipe.warp_tables(&mut Vec::new());
        let mut enabled = tables
            .into_iter()
            .filter(|(_, table)| table.get("enabled") != Some(&Value::Bool(false)));
        let Some((index, table)) = enabled.next() else {
            let hint =
                "add a table [[warp]] of a kind with features, such as \"lines\" or \"thin-plate\"";
            return Err(fail("", Part::Key, "a morph needs a warp".to_owned(), hint));
        };
        if let Some((second, _)) = enabled.next() {
            let message =
                "a morph goes by the features of one warp, and this is a second".to_owned();
            let hint = "put all features into one, or set `enabled = false`";
            return Err(fail(&format!("warp.{second}"), Part::Key, message, hint));
        }
        let path = format!("warp.{index}");
        if let Some(key) = WITHOUT.iter().find(|key| table.contains_key(**key)) {
            let message = format!("`{key}` means nothing between two images");
            let hint = "leave it out; a `schedule` says when which feature goes over";
            return Err(fail(&join(&path, key), Part::Key, message, hint));
        }
        let one = |problem| RecipeError::one(&self.source.name, problem);
        let entry = recipe.entry(&path, table, registry).map_err(one)?;
        let built = |context: &Context<'_, S>| {
            construct(entry, registry, table, context)
                .map(|(built, _)| built)
                .map_err(|error| one(recipe.located(&path, error, entry)))
        };
        let (first, second) = (built(source)?, built(target)?);
        let (Some(features), Some(other)) = (first.features, second.features) else {
            let message = format!("{} is not made of pairs of features", quoted(entry.kind));
            let hint = "take a kind that is, such as \"lines\", \"thin-plate\", \"multilevel\" or \"points\", or a [grid]";
            return Err(fail(&join(&path, "kind"), Part::Value, message, hint));
        };
        let label = table.get("label").and_then(Value::as_str);
        Ok(MorphFeatures {
            title: label.unwrap_or(entry.kind).to_owned(),
            sources: features.sources,
            targets: other.targets,
            way: MorphWay::Warp(features.with),
        })
    }

    /// Whether it is of a coordinate grid, rather than warps.
    #[must_use]
    pub fn is_grid(&self) -> bool {
        self.tree.contains_key("grid")
    }

    /// What is wrong where a recipe of warps is wanted and this is one of a coordinate grid.
    pub(crate) fn grid_problem(&self) -> Option<Problem> {
        self.is_grid().then(|| {
            let message = "this recipe is of a coordinate grid, which morphs go by";
            let hint = "use `anamorph morph`; warps go into a recipe of their own";
            self.problem("grid", Part::Key, message, hint)
        })
    }

    fn check_grid(&self, grid: &Value, problems: &mut Vec<Problem>) {
        if let Some(other) = ["warp", "motion", "mapping", "space"]
            .into_iter()
            .find(|key| self.tree.contains_key(*key))
        {
            let message = format!("a recipe with a [grid] has no `{other}`");
            problems.push(self.problem(other, Part::Key, message, "keep them in two files"));
        }
        let checked = parse::<GridParameters>(grid).and_then(|parameters| parameters.check());
        if let Err(error) = checked {
            let at = join("grid", &error.path);
            let (message, hint) = plain(&error.message);
            let hint = if error.hint.is_empty() {
                hint.unwrap_or_default()
            } else {
                error.hint
            };
            problems.push(self.problem(&at, Part::Value, message, hint));
        }
        if let Some(schedule) = grid.get("schedule") {
            self.check_schedule("grid.schedule", schedule, true, problems);
        }
    }

    /// How far each of so many features has gone at a time: 0 on the first image, 1 on the second. Eases may lead beyond.
    #[must_use]
    pub fn morph_ways(&self, time: f64, features: usize) -> Vec<f64> {
        let share = self.shape_share(time);
        let mut ways = share.as_ref().map_or(Vec::new(), |s| s.features.clone());
        ways.resize(features, share.map_or(time, |share| share.common));
        ways
    }

    /// How far the colours have gone at a time, from 0 to 1: as `dissolve` under `[time]` says, or with the shape.
    #[must_use]
    pub fn morph_dissolve(&self, time: f64) -> f64 {
        let own = self.time_table().and_then(|table| table.get("dissolve"));
        let value = match own {
            Some(Value::Object(table)) => {
                let number = |key: &str, default: f64| {
                    table.get(key).and_then(Value::as_f64).unwrap_or(default)
                };
                let (start, end) = (number("start", 0.0), number("end", 1.0));
                let x = if time >= end {
                    1.0
                } else if time <= start {
                    0.0
                } else {
                    (time - start) / (end - start)
                };
                ease(table.get("ease")).map_or(x, |ease| ease.value(x))
            }
            Some(name) => ease(Some(name)).map_or(time, |ease| ease.value(time)),
            None => self.shape_share(time).map_or(time, |share| share.common),
        };
        if value.is_nan() {
            time
        } else {
            value.clamp(0.0, 1.0)
        }
    }

    /// Whether features of several places turn on their way, instead of going straight.
    #[must_use]
    pub fn morph_turns(&self) -> bool {
        let path = self.time_table().and_then(|table| table.get("path"));
        path.and_then(Value::as_str) == Some(PATHS[1])
    }

    fn time_table(&self) -> Option<&Map<String, Value>> {
        self.tree.get("time").and_then(Value::as_object)
    }

    /// How much of the one warp is in force; tracks have no say in it.
    fn shape_share(&self, time: f64) -> Option<crate::time::Share> {
        let mut tables = self.warp_tables(&mut Vec::new()).into_iter();
        let is_enabled =
            |table: &Map<String, Value>| table.get("enabled") != Some(&Value::Bool(false));
        let grid = self.tree.get("grid").and_then(Value::as_object);
        let warp = || {
            tables
                .find(|(_, table)| is_enabled(table))
                .map(|(_, table)| table)
        };
        let table = grid.or_else(warp)?;
        let mut at = self.clone();
        at.tree.remove("track");
        at.time = Some(if time.is_nan() {
            0.0
        } else {
            time.clamp(0.0, 1.0)
        });
        at.share(table)
    }

    /// Checks `path` and `dissolve` of `[time]`.
    pub(crate) fn check_morph(&self, table: &Map<String, Value>, problems: &mut Vec<Problem>) {
        if let Some(path) = table.get("path")
            && path.as_str().is_none_or(|word| !PATHS.contains(&word))
        {
            let near = nearest(path.as_str().unwrap_or_default(), PATHS);
            let hint = near.map_or_else(
                || "write \"straight\" or \"turning\"".to_owned(),
                |name| format!("did you mean `{name}`?"),
            );
            let message = "features go straight or turning";
            problems.push(self.problem("time.path", Part::Value, message, hint));
        }
        match table.get("dissolve") {
            None => {}
            Some(schedule @ Value::Object(_)) => {
                self.check_schedule("time.dissolve", schedule, false, problems);
            }
            Some(name) => {
                let mut named = Map::new();
                named.insert("ease".to_owned(), name.clone());
                let first = problems.len();
                self.check_ease(&named, "time.dissolve", problems);
                if problems.len() > first {
                    problems.truncate(first);
                    let message = "this is no ease and no schedule";
                    let hint = "write the name of an ease (`anamorph list eases`), or { start = 0.2, end = 0.8 }";
                    problems.push(self.problem("time.dissolve", Part::Value, message, hint));
                }
            }
        }
    }
}

/// The nodes of a grid on two images.
fn morph_grid<S: Space>(
    grid: &Value,
    source: &Context<'_, S>,
    target: &Context<'_, S>,
) -> Result<MorphFeatures<S>, ConstructError> {
    let p: GridParameters = parse(grid)?;
    p.check()?;
    let one = |node: S| vec![node];
    Ok(MorphFeatures {
        title: format!("grid of {} × {} nodes", p.columns, p.rows),
        sources: p.nodes("source", source)?.into_iter().map(one).collect(),
        targets: p.nodes("target", target)?.into_iter().map(one).collect(),
        way: MorphWay::Grid {
            columns: p.columns,
            rows: p.rows,
            curves: p.curves,
        },
    })
}
