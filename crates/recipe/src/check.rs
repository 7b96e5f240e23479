//! What can be said about a recipe without constructing anything: its structure, its kinds and its keys.

use crate::error::{Problem, RecipeError, quoted, shown};
use crate::fit::FitParameters;
use crate::keys::Walk;
use crate::names::{nearest, suggestion};
use crate::tree::{Part, Syntax, join};
use crate::words::form;
use crate::{COMMON_KEYS, Recipe, Registry};
use anamorph_catalog::WarpEntry;
use anamorph_catalog::schemars::{JsonSchema, SchemaGenerator};
use anamorph_core::Space;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Whose coordinates a recipe may be in; the first if it says nothing.
pub(crate) const SPACES: [&str; 2] = ["world", "local"];
/// Which way a recipe's warps are applied; the first if it says nothing.
pub(crate) const MAPPINGS: [&str; 2] = ["forward", "inverse"];
/// Keys of the recipe itself. Editors write `$schema` into JSON.
const ROOT_KEYS: [&str; 11] = [
    "version",
    "warp",
    "grid",
    "track",
    "time",
    "motion",
    "space",
    "mapping",
    "name",
    "description",
    "$schema",
];

/// Words of [`scaling`](anamorph_catalog::ScalingMethod).
pub(crate) const SCALING: [&str; 2] = ["displacement", "composition"];

impl Recipe {
    /// Checks the structure of the recipe, the kinds of its warps, and every key at every depth against the schemas of
    /// the registry. [`Recipe::build`] begins with it.
    ///
    /// # Errors
    ///
    /// All problems found, in the order of the file.
    pub fn check_keys<S: Space>(&self, registry: &Registry<S>) -> Result<(), RecipeError> {
        let mut problems = self.key_problems(registry);
        problems.extend(self.grid_problem());
        RecipeError::of(&self.source.name, problems).map_or(Ok(()), Err)
    }

    /// What is wrong with the keys, but for those of a coordinate grid.
    pub(crate) fn key_problems<S: Space>(&self, registry: &Registry<S>) -> Vec<Problem> {
        let mut problems = Vec::new();
        problems.extend(self.version_problem());
        self.check_root(&mut problems);
        if let Some(problem) = self.motion_problem() {
            problems.push(problem);
        }
        let mut schemas = Schemas::new(registry);
        for (i, table) in self.warp_tables(&mut problems) {
            self.check_warp(i, table, registry, &mut schemas, &mut problems);
        }
        problems
    }

    /// What is wrong with `version`, if anything.
    pub(crate) fn version_problem(&self) -> Option<Problem> {
        let write = format!("write `{}`", self.source.assignment("version", "1"));
        match self.tree.get("version") {
            None => Some(self.problem(
                "version",
                Part::Key,
                "the recipe does not say its version",
                format!("{write} at its beginning"),
            )),
            Some(Value::Number(number)) if number.as_f64() == Some(1.0) => None,
            Some(Value::Number(number)) => Some(self.problem(
                "version",
                Part::Value,
                format!("version {number} of recipes is not known here"),
                "the version is 1",
            )),
            Some(other) => Some(self.problem(
                "version",
                Part::Value,
                format!("the version is a number, and this is {}", form(other)),
                write,
            )),
        }
    }

    pub(crate) fn check_root(&self, problems: &mut Vec<Problem>) {
        let begin = match self.source.syntax {
            Syntax::Toml => "begin each warp with [[warp]]",
            Syntax::Json => "put each warp into the list \"warp\": [{ … }]",
        };
        if self.tree.contains_key("kind") {
            // Then its parameters are outside too, and one message is enough.
            problems.push(self.problem(
                "kind",
                Part::Key,
                "this stands outside of any warp",
                begin,
            ));
        } else {
            let known: Vec<String> = ROOT_KEYS[..10].iter().map(|&key| key.to_owned()).collect();
            for key in self
                .tree
                .keys()
                .filter(|key| !ROOT_KEYS.contains(&key.as_str()))
            {
                let hint = if COMMON_KEYS.contains(&key.as_str()) {
                    begin.to_owned()
                } else {
                    suggestion(key, &known)
                };
                let message = format!("unknown key {}", quoted(key));
                problems.push(self.problem(key, Part::Key, message, hint));
            }
        }
        for key in ["name", "description", "$schema"] {
            self.expect(
                key,
                self.tree.get(key),
                Value::is_string,
                "text in quotes",
                problems,
            );
        }
        self.check_space(problems);
        self.check_mapping(problems);
        self.check_time(problems);
    }

    fn check_mapping(&self, problems: &mut Vec<Problem>) {
        let Some(mapping) = self.tree.get("mapping") else {
            return;
        };
        if mapping
            .as_str()
            .is_none_or(|name| !MAPPINGS.contains(&name))
        {
            let message = format!("{} is no mapping", form(mapping));
            let hint =
                "write \"forward\" (the warps as they are) or \"inverse\" (what undoes them)";
            problems.push(self.problem("mapping", Part::Value, message, hint));
        }
    }

    fn check_space(&self, problems: &mut Vec<Problem>) {
        let Some(space) = self.tree.get("space") else {
            return;
        };
        if space.as_str().is_none_or(|name| !SPACES.contains(&name)) {
            let message = format!("{} is no space", form(space));
            let hint = "write \"world\" (where the scene places each mesh) or \"local\" (each mesh in its own coordinates)";
            problems.push(self.problem("space", Part::Value, message, hint));
        }
    }

    fn expect(
        &self,
        path: &str,
        value: Option<&Value>,
        fits: impl Fn(&Value) -> bool,
        wanted: &str,
        problems: &mut Vec<Problem>,
    ) {
        if let Some(value) = value.filter(|value| !fits(value)) {
            let message = format!("{} where {wanted} was expected", form(value));
            problems.push(self.problem(path, Part::Value, message, ""));
        }
    }

    /// The tables of the warps with their numbers; problems where there are none.
    pub(crate) fn warp_tables(
        &self,
        problems: &mut Vec<Problem>,
    ) -> Vec<(usize, &Map<String, Value>)> {
        let list = match self.tree.get("warp") {
            None => return Vec::new(),
            Some(Value::Array(list)) => list,
            Some(other) => {
                let hint = match self.source.syntax {
                    Syntax::Toml if other.is_object() => "write [[warp]], with two brackets",
                    Syntax::Toml => "begin each warp with [[warp]]",
                    Syntax::Json => "write \"warp\": [{ … }]",
                };
                let message = format!("`warp` is a list of tables, and this is {}", form(other));
                problems.push(self.problem("warp", Part::Key, message, hint));
                return Vec::new();
            }
        };
        let mut tables = Vec::new();
        for (i, item) in list.iter().enumerate() {
            match item {
                Value::Object(table) => tables.push((i, table)),
                other => {
                    let message = format!("a warp is a table, and this is {}", form(other));
                    problems.push(self.problem(&format!("warp.{i}"), Part::Value, message, ""));
                }
            }
        }
        tables
    }

    fn check_warp<S: Space>(
        &self,
        i: usize,
        table: &Map<String, Value>,
        registry: &Registry<S>,
        schemas: &mut Schemas<'_, S>,
        problems: &mut Vec<Problem>,
    ) {
        let path = format!("warp.{i}");
        let entry = self.entry(&path, table, registry);
        let entry = entry.map_err(|problem| problems.push(problem)).ok();
        let Schema {
            warp,
            field,
            fit,
            definitions,
        } = schemas.of(entry);
        let mut walk = Walk::new(definitions);
        if let Some(schema) = warp {
            let parameters = Value::Object(parameters(table));
            let mut also = vec!["kind"];
            also.extend(COMMON_KEYS);
            walk.compare(&parameters, schema, &path, &also);
        }
        for key in ["strength", "weight", "mask"] {
            if let Some(expression) = table.get(key) {
                walk.compare(expression, field, &join(&path, key), &[]);
            }
        }
        if let Some(pins) = table.get("fit") {
            walk.compare(pins, fit, &join(&path, "fit"), &[]);
        }
        for unknown in walk.unknown {
            let part = if unknown.is_key {
                Part::Key
            } else {
                Part::Value
            };
            problems.push(self.problem(&unknown.path, part, unknown.message, unknown.hint));
        }
        let mut expect = |key: &str, fits: &dyn Fn(&Value) -> bool, wanted: &str| {
            self.expect(&join(&path, key), table.get(key), fits, wanted, problems);
        };
        expect("label", &Value::is_string, "text in quotes");
        expect("enabled", &Value::is_boolean, "true or false");
        expect(
            "ambient",
            &|value| value.as_f64().is_some_and(|weight| weight > 0.0),
            "a number above 0",
        );
        match table.get("scaling") {
            Some(Value::String(word)) if !SCALING.contains(&word.as_str()) => {
                let message = format!("no scaling method is called {}", quoted(word));
                let hint = suggestion(word, &SCALING.map(str::to_owned));
                problems.push(self.problem(&join(&path, "scaling"), Part::Value, message, hint));
            }
            scaling => self.expect(
                &join(&path, "scaling"),
                scaling,
                Value::is_string,
                "\"displacement\" or \"composition\"",
                problems,
            ),
        }
    }

    /// The registry entry of a warp's table.
    pub(crate) fn entry<'a, S: Space>(
        &self,
        path: &str,
        table: &Map<String, Value>,
        registry: &'a Registry<S>,
    ) -> Result<&'a WarpEntry<S>, Problem> {
        let at = join(path, "kind");
        let example = registry.warps.first().map_or("twist", |entry| entry.kind);
        let kind = match table.get("kind") {
            Some(Value::String(kind)) => kind,
            Some(other) => {
                let message = format!("the kind is a word in quotes, and this is {}", form(other));
                return Err(self.problem(&at, Part::Value, message, ""));
            }
            None => {
                let write = self.source.assignment("kind", &format!("\"{example}\""));
                return Err(self.problem(
                    &at,
                    Part::Key,
                    "the warp does not say its kind",
                    format!("add one, such as `{write}`"),
                ));
            }
        };
        if let Some(entry) = registry.warps.iter().find(|entry| entry.kind == kind) {
            return Ok(entry);
        }
        let (here, there) = if S::DIM == 2 {
            ("in the plane", "in space")
        } else {
            ("in space", "in the plane")
        };
        if registry.elsewhere.contains(&kind.as_str()) {
            let message = format!("the warp `{kind}` works only {there}, not {here}");
            let hint = format!("use it on a model {there}; `anamorph list warps` names all warps");
            return Err(self.problem(&at, Part::Value, message, hint));
        }
        let message = format!("no warp is called {}", quoted(kind));
        let own = nearest(kind, registry.warps.iter().map(|entry| entry.kind));
        let other = nearest(kind, registry.elsewhere.iter().copied());
        let meant = match (own, other) {
            (Some(near), _) => format!("did you mean `{near}`? "),
            (None, Some(near)) => format!("did you mean `{near}`, which works only {there}? "),
            (None, None) => {
                let known: Vec<String> = registry.warps.iter().map(|e| e.kind.to_owned()).collect();
                format!("{}; ", suggestion("", &known))
            }
        };
        let hint = format!("{meant}`anamorph list warps` names them all");
        Err(self.problem(&at, Part::Value, message, shown(&hint, 300)))
    }
}

/// The schemas that a warp's table is held against.
struct Schema {
    /// Of its parameters; `None` for a kind that is not known.
    warp: Option<Value>,
    field: Value,
    fit: Value,
    definitions: Map<String, Value>,
}

/// The schemas of the kinds met so far: a recipe may name one kind thousands of times.
struct Schemas<'a, S: Space> {
    registry: &'a Registry<S>,
    known: BTreeMap<Option<&'static str>, Schema>,
}

impl<'a, S: Space> Schemas<'a, S> {
    fn new(registry: &'a Registry<S>) -> Self {
        Self {
            registry,
            known: BTreeMap::new(),
        }
    }

    fn of(&mut self, entry: Option<&WarpEntry<S>>) -> &Schema {
        let field = self.registry.field.schema;
        self.known
            .entry(entry.map(|entry| entry.kind))
            .or_insert_with(|| {
                let mut generator = SchemaGenerator::default();
                Schema {
                    warp: entry.map(|entry| Value::from((entry.schema)(&mut generator))),
                    field: Value::from(field(&mut generator)),
                    fit: Value::from(FitParameters::json_schema(&mut generator)),
                    definitions: generator.take_definitions(true),
                }
            })
    }
}

/// A warp's table without the keys that every warp has.
pub(crate) fn parameters(table: &Map<String, Value>) -> Map<String, Value> {
    let own = |key: &str| key != "kind" && !COMMON_KEYS.contains(&key);
    let entries = table.iter().filter(|(key, _)| own(key));
    entries
        .map(|(key, value)| (key.clone(), value.clone()))
        .collect()
}
