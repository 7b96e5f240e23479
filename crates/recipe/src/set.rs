//! Changing single values from outside: `--set warp.0.angle=30deg`.

use crate::error::{Place, Problem, RecipeError, quoted, shown};
use crate::tree::{Node, join};
use crate::words::form;
use crate::{MAX_DEPTH, Recipe, toml};
use serde_json::{Map, Value};
use std::sync::Arc;

impl Recipe {
    /// Sets one value: `path=value`, such as `warp.0.angle=30deg`.
    ///
    /// The path names keys, and entries of lists by number from 0. Missing keys are created, missing entries are not. The
    /// value is read as TOML if it is a TOML value (a number, `true`, `false`, a list, an inline table, a quoted string);
    /// else it is the text as it stands.
    ///
    /// # Errors
    ///
    /// No `=`, an empty word in the path, an entry a list does not have, a path into something that is neither table nor
    /// list, a broken list or string, and a number that is not finite. The recipe is unchanged then.
    pub fn set(&mut self, argument: &str) -> Result<(), RecipeError> {
        let fail = |path: &str, message: String, hint: String| {
            let place = Place::Setting(shown(argument, 200));
            RecipeError::one(&self.source.name, Problem::new(place, path, message, hint))
        };
        let Some((path, text)) = argument.split_once('=') else {
            let hint = "write path=value, such as warp.0.angle=30deg".to_owned();
            return Err(fail("", "there is no `=`".to_owned(), hint));
        };
        let path = words(path);
        if path.iter().any(|word| word.is_empty()) {
            let hint = "write keys and numbers with dots between, such as warp.0.angle".to_owned();
            return Err(fail("", "a word of the path is empty".to_owned(), hint));
        }
        if path.len() > MAX_DEPTH {
            let message = format!("the path is longer than {MAX_DEPTH} words");
            return Err(fail("", message, String::new()));
        }
        let value = read_value(text.trim())
            .map_err(|(message, hint)| fail(&path.join("."), message, hint))?;

        let mut tree = self.tree.clone();
        let mut spans = self.spans.clone();
        let origin: Arc<str> = argument.into();
        put(&mut tree, &mut spans, &path, value, &origin)
            .map_err(|(path, message, hint)| fail(&path, message, hint))?;
        (self.tree, self.spans) = (tree, spans);
        Ok(())
    }
}

/// The value that a text means; else message and hint.
fn read_value(text: &str) -> Result<Value, (String, String)> {
    match toml::read_value(text) {
        Some(read) => read,
        None if text.starts_with(['[', '{', '"', '\'']) => Err((
            format!("{} is not a complete TOML value", quoted(text)),
            "close what it opens; text may also stand without quotes".to_owned(),
        )),
        None => Ok(Value::String(text.to_owned())),
    }
}

/// Path, message, hint.
type Failure = (String, String, String);

/// Where a walk along a path has arrived.
enum At<'a> {
    Table(&'a mut Map<String, Value>),
    Value(&'a mut Value),
}

/// The words of a path.
pub(crate) fn words(path: &str) -> Vec<&str> {
    path.split('.').map(str::trim).collect()
}

/// Sets the value at the end of a path.
pub(crate) fn put(
    tree: &mut Map<String, Value>,
    spans: &mut Node,
    path: &[&str],
    value: Value,
    origin: &Arc<str>,
) -> Result<(), Failure> {
    let (mut here, mut node) = (At::Table(tree), spans);
    let mut walked = String::new();
    for (i, &word) in path.iter().enumerate() {
        let next = match here {
            At::Table(table) | At::Value(Value::Object(table)) => {
                let missing = !table.contains_key(word);
                if missing
                    && path
                        .get(i + 1)
                        .is_some_and(|next| next.parse::<usize>().is_ok())
                {
                    let list = join(&walked, word);
                    let message = format!("there is no list {}", quoted(&list));
                    let hint = format!("set it whole, as in {list}=[…]");
                    return Err((list, message, hint));
                }
                table
                    .entry(word)
                    .or_insert_with(|| Value::Object(Map::new()))
            }
            At::Value(Value::Array(list)) => {
                let count = list.len();
                let entries = match count {
                    0 => "no entries".to_owned(),
                    1 => "one entry, number 0".to_owned(),
                    _ => format!("{count} entries, 0 to {}", count - 1),
                };
                match word.parse::<usize>().ok().and_then(|n| list.get_mut(n)) {
                    Some(entry) => entry,
                    None => {
                        let message = format!("{} has {entries}", quoted(&walked));
                        let hint = match count {
                            0 => "add them in the file".to_owned(),
                            _ => format!("name one by its number, as in {walked}.0"),
                        };
                        return Err((join(&walked, word), message, hint));
                    }
                }
            }
            At::Value(other) => {
                let message = format!("{} is {}", quoted(&walked), form(other));
                let hint = "only tables and lists have something inside".to_owned();
                return Err((join(&walked, word), message, hint));
            }
        };
        walked = join(&walked, word);
        // Inside what an earlier setting brought there are no spans: what is not set now is still its.
        let earlier = node.origin.clone().unwrap_or_else(|| origin.clone());
        node = node
            .children
            .entry(word.to_owned())
            .or_insert_with(|| Node::of_setting(earlier));
        here = At::Value(next);
    }
    if let At::Value(target) = here {
        *target = value;
        *node = Node::of_setting(origin.clone());
    }
    Ok(())
}
