//! A recipe as read: one tree for both syntaxes, with the place of everything in it.

use crate::error::{Place, Problem, RecipeError};
use crate::tree::{Node, Part, Source, Syntax};
use crate::words::form;
use crate::{json, toml};
use serde_json::{Map, Value};

/// Levels of tables and lists in a recipe.
pub const MAX_DEPTH: usize = 64;

/// A recipe: its tree of values and where each of them stands.
#[derive(Debug, Clone)]
pub struct Recipe {
    pub(crate) source: Source,
    /// Always a table.
    pub(crate) tree: Map<String, Value>,
    pub(crate) spans: Node,
    /// The time it is built for, if it is; see [`Recipe::at`].
    pub(crate) time: Option<f64>,
}

impl Recipe {
    /// Reads a recipe from the bytes of a file called `name`.
    ///
    /// The syntax follows from the content: what begins with `{` is JSON. Else a name that ends in `.json` means
    /// JSON, unless the content is TOML and no JSON; anything else is TOML. A UTF-8 byte-order mark is
    /// skipped.
    ///
    /// # Errors
    ///
    /// Text that is not UTF-8, syntax errors, repeated keys, dates, numbers that are not finite, nesting deeper than
    /// [`MAX_DEPTH`], and a missing or unknown `version`.
    pub fn read(bytes: &[u8], name: &str) -> Result<Self, RecipeError> {
        let at_start = |message: &str, hint: &str| {
            let place = Place::File { line: 1, column: 1 };
            RecipeError::one(name, Problem::new(place, "", message, hint))
        };
        if bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]) {
            return Err(at_start("the file is UTF-16 text", "save it as UTF-8"));
        }
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let offset = error.valid_up_to();
            let byte = bytes.get(offset).copied().unwrap_or(0);
            let readable = Source::new(name, &String::from_utf8_lossy(bytes), Syntax::Toml);
            let problem = if bytes.contains(&0) {
                (
                    "this is not a text file".to_owned(),
                    "a recipe is TOML or JSON text",
                )
            } else {
                (
                    format!("byte 0x{byte:02X} is not UTF-8 text"),
                    "save the file as UTF-8",
                )
            };
            let place = readable.place(offset);
            RecipeError::one(name, Problem::new(place, "", problem.0, problem.1))
        })?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let is_json_name = name.len() >= 5
            && name
                .get(name.len() - 5..)
                .is_some_and(|end| end.eq_ignore_ascii_case(".json"));
        if begins_as_json(text) {
            Self::from_json(text, name)
        } else if is_json_name {
            let source = Source::new(name, text, Syntax::Json);
            match json::read(&source) {
                Ok((value, spans)) => Self::of(source, value, spans),
                // Perhaps TOML under a wrong name; if it is neither, the name says which error is of interest.
                Err(problem) => match toml::read(&Source::new(name, text, Syntax::Toml)) {
                    Ok(_) => Self::from_toml(text, name),
                    Err(_) => Err(RecipeError::one(name, problem)),
                },
            }
        } else {
            Self::from_toml(text, name)
        }
    }

    /// Reads a recipe written in TOML; `name` is what errors call it.
    ///
    /// # Errors
    ///
    /// As [`Recipe::read`].
    pub fn from_toml(text: &str, name: &str) -> Result<Self, RecipeError> {
        let source = Source::new(name, text, Syntax::Toml);
        match toml::read(&source) {
            Ok((value, spans)) => Self::of(source, value, spans),
            Err(problem) => Err(RecipeError::one(name, problem)),
        }
    }

    /// Reads a recipe written in JSON; `name` is what errors call it.
    ///
    /// # Errors
    ///
    /// As [`Recipe::read`].
    pub fn from_json(text: &str, name: &str) -> Result<Self, RecipeError> {
        let source = Source::new(name, text, Syntax::Json);
        match json::read(&source) {
            Ok((value, spans)) => Self::of(source, value, spans),
            Err(problem) => Err(RecipeError::one(name, problem)),
        }
    }

    fn of(source: Source, value: Value, spans: Node) -> Result<Self, RecipeError> {
        let tree = match value {
            Value::Object(tree) => tree,
            other => {
                let message = format!("a recipe is a table of keys, and this is {}", form(&other));
                let hint = format!("begin with {{ {}", source.assignment("version", "1"));
                let problem = source.problem(spans.span.start, "", message, hint);
                return Err(RecipeError::one(&source.name, problem));
            }
        };
        let recipe = Self {
            source,
            tree,
            spans,
            time: None,
        };
        match recipe.version_problem() {
            Some(problem) => Err(RecipeError::one(&recipe.source.name, problem)),
            None => Ok(recipe),
        }
    }

    /// What the file is called in errors.
    pub fn name(&self) -> &str {
        &self.source.name
    }

    /// Tells recipes apart: a number made of all values, in the order of their keys (FNV-1a, Fowler, Noll and Vo).
    pub fn fingerprint(&self) -> u64 {
        hash(&Value::Object(self.tree.clone()), true)
    }

    /// The recipe as one table.
    pub fn tree(&self) -> &Map<String, Value> {
        &self.tree
    }

    /// The kinds of its warps in order, disabled ones included; nothing for those without one.
    pub fn kinds(&self) -> Vec<&str> {
        let warps = self.tree.get("warp").and_then(Value::as_array);
        warps.map_or_else(Vec::new, |list| {
            list.iter()
                .filter_map(|warp| warp.get("kind")?.as_str())
                .collect()
        })
    }

    /// Whether the recipe asks for what undoes its warps (`mapping = "inverse"`).
    pub fn is_inverse(&self) -> bool {
        self.tree.get("mapping").and_then(Value::as_str) == Some("inverse")
    }

    /// Whether it is for each mesh in its own coordinates (`space = "local"`), rather than where a scene places it.
    pub fn is_local(&self) -> bool {
        self.tree.get("space").and_then(Value::as_str) == Some("local")
    }

    /// A problem with the value, or the key, at `path`.
    pub(crate) fn problem(
        &self,
        path: &str,
        part: Part,
        message: impl AsRef<str>,
        hint: impl AsRef<str>,
    ) -> Problem {
        let place = self.spans.locate(&self.source, path, part);
        Problem::new(place, path, message, hint)
    }
}

/// Whether the first thing in the text that is no comment can only be JSON: TOML has no `{` there and no `/` at all.
fn begins_as_json(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim_start);
    let first = lines.find(|line| !line.is_empty() && !line.starts_with('#'));
    first.is_some_and(|line| line.starts_with(['{', '/']))
}
/// A number made of a value: of all of it, or, without numbers, of what is there and how it is arranged.
pub(crate) fn hash(value: &Value, numbers: bool) -> u64 {
    fn add(sum: &mut u64, bytes: &[u8]) {
        for byte in bytes {
            *sum = (*sum ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
    fn walk(sum: &mut u64, value: &Value, numbers: bool) {
        match value {
            Value::Null => add(sum, b"null"),
            Value::Bool(flag) => add(sum, if *flag { b"true" } else { b"false" }),
            Value::Number(_) if !numbers => add(sum, b"number"),
            Value::Number(number) => {
                add(sum, b"n");
                add(
                    sum,
                    &number.as_f64().unwrap_or(f64::NAN).to_bits().to_le_bytes(),
                );
            }
            Value::String(text) if !numbers && crate::time::unit(text).is_some() => {
                add(sum, b"number");
            }
            Value::String(text) => {
                add(sum, b"s");
                add(sum, &(text.len() as u64).to_le_bytes());
                add(sum, text.as_bytes());
            }
            Value::Array(list) => {
                add(sum, b"[");
                list.iter().for_each(|value| walk(sum, value, numbers));
                add(sum, b"]");
            }
            Value::Object(table) => {
                add(sum, b"{");
                let mut keys: Vec<&String> = table.keys().collect();
                keys.sort();
                for key in keys {
                    add(sum, &(key.len() as u64).to_le_bytes());
                    add(sum, key.as_bytes());
                    walk(sum, &table[key], numbers);
                }
                add(sum, b"}");
            }
        }
    }
    let mut sum = 0xcbf2_9ce4_8422_2325;
    walk(&mut sum, value, numbers);
    sum
}
