//! Values of a motion's table, each read with its place.

use anamorph_catalog::{ConstructError, Context, Coordinate, parse};
use anamorph_core::Solid;
use anamorph_core::glam::DVec3;
use serde_json::{Map, Value};

/// A table with its path from the motion's.
pub(super) struct Values<'a> {
    pub(super) path: String,
    pub(super) map: &'a Map<String, Value>,
    pub(super) context: &'a Context<'a, Solid>,
}

/// `prefix.key`.
pub(super) fn below(prefix: &str, key: impl std::fmt::Display) -> String {
    if prefix.is_empty() {
        key.to_string()
    } else {
        format!("{prefix}.{key}")
    }
}

/// Reads a value at a path.
pub(super) fn read<T: serde::de::DeserializeOwned>(
    value: &Value,
    path: &str,
) -> Result<T, ConstructError> {
    parse::<T>(value).map_err(|error| error.under(path))
}

/// Largest size of a coordinate: beyond it, products leave the range of numbers.
const LARGEST: f64 = 1e50;

/// A number that is not too large.
pub(super) fn moderate(value: &Value, path: &str) -> Result<f64, ConstructError> {
    let number: f64 = read(value, path)?;
    if number.abs() <= LARGEST {
        return Ok(number);
    }
    let message = format!("{} is too large", short(number));
    Err(ConstructError::new(path, message).with_hint("write numbers of at most 1e50 in size"))
}

/// A number with at most six significant digits, for people.
pub(super) fn short(number: f64) -> String {
    let rounded: f64 = format!("{number:.5e}").parse().unwrap_or(number);
    let size = rounded.abs();
    if size != 0.0 && size.is_finite() && !(1e-4..1e9).contains(&size) {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}

/// A point or vector of two or three numbers, and how many they are.
pub(super) fn point(value: &Value, path: &str) -> Result<(Solid, usize), ConstructError> {
    let numbers: Vec<f64> = read(value, path)?;
    let point = match numbers.as_slice() {
        [x, y] => DVec3::new(*x, *y, 0.0),
        [x, y, z] => DVec3::new(*x, *y, *z),
        other => {
            let message = format!("a point of {} numbers", other.len());
            return Err(ConstructError::new(path, message)
                .with_hint("write [x, y, z], or [x, y] for a path in the plane"));
        }
    };
    if point.abs().max_element() <= LARGEST {
        Ok((point, numbers.len()))
    } else {
        Err(ConstructError::new(path, "a coordinate is too large")
            .with_hint("write numbers of at most 1e50 in size"))
    }
}

impl<'a> Values<'a> {
    pub(super) fn new(map: &'a Map<String, Value>, context: &'a Context<'a, Solid>) -> Self {
        Self {
            path: String::new(),
            map,
            context,
        }
    }

    /// The path of a key.
    pub(super) fn at(&self, key: &str) -> String {
        below(&self.path, key)
    }

    pub(super) fn get(&self, key: &str) -> Option<&'a Value> {
        self.map.get(key)
    }

    pub(super) fn missing(&self, key: &str, what: &str) -> ConstructError {
        ConstructError::new(self.at(key), format!("`{key}` is missing"))
            .with_hint(format!("add `{key}`: {what}"))
    }

    /// A table that must be there.
    pub(super) fn table(&self, key: &str) -> Result<Values<'a>, ConstructError> {
        let value = self.get(key).ok_or_else(|| {
            self.missing(
                key,
                "a table such as { kind = \"catmull-rom\", points = [[0, 0, 0], [1, 0, 0]] }",
            )
        })?;
        self.inside(value, key)
    }

    /// A value that is a table, under a key.
    pub(super) fn inside(&self, value: &'a Value, key: &str) -> Result<Values<'a>, ConstructError> {
        match value {
            Value::Object(map) => Ok(Self {
                path: self.at(key),
                map,
                context: self.context,
            }),
            other => {
                let message = format!("{} where a table was expected", crate::words::form(other));
                Err(ConstructError::new(self.at(key), message))
            }
        }
    }

    pub(super) fn number(&self, key: &str) -> Result<Option<f64>, ConstructError> {
        let value = self.get(key);
        value.map(|value| read(value, &self.at(key))).transpose()
    }

    pub(super) fn flag(&self, key: &str) -> Result<bool, ConstructError> {
        let value = self.get(key);
        let read = value.map(|value| read(value, &self.at(key))).transpose()?;
        Ok(read.unwrap_or(false))
    }

    /// A whole number in a range.
    pub(super) fn count(&self, key: &str, most: u32) -> Result<Option<usize>, ConstructError> {
        let Some(number) = self.number(key)? else {
            return Ok(None);
        };
        if number.fract() == 0.0 && (0.0..=f64::from(most)).contains(&number) {
            return Ok(Some(number as usize));
        }
        let message = format!("`{key}` is {}", short(number));
        Err(ConstructError::new(self.at(key), message)
            .with_hint(format!("write a whole number from 0 to {most}")))
    }

    pub(super) fn text(&self, key: &str) -> Result<Option<&'a str>, ConstructError> {
        match self.get(key) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text)),
            Some(other) => {
                let message = format!(
                    "{} where text in quotes was expected",
                    crate::words::form(other)
                );
                Err(ConstructError::new(self.at(key), message))
            }
        }
    }

    /// The place of a word among those known.
    pub(super) fn word(&self, key: &str, known: &[&str]) -> Result<Option<usize>, ConstructError> {
        let Some(text) = self.text(key)? else {
            return Ok(None);
        };
        match known.iter().position(|word| *word == text) {
            Some(place) => Ok(Some(place)),
            None => Err(unknown(&self.at(key), "word", text, known)),
        }
    }

    /// A length: scene units, or a share of `whole`.
    pub(super) fn share(&self, key: &str, whole: f64) -> Result<Option<f64>, ConstructError> {
        let value = self.get(key);
        value
            .map(|value| share(value, &self.at(key), whole))
            .transpose()
    }

    /// A list.
    pub(super) fn list(&self, key: &str) -> Result<Option<&'a [Value]>, ConstructError> {
        match self.get(key) {
            None => Ok(None),
            Some(Value::Array(list)) => Ok(Some(list)),
            Some(other) => {
                let message = format!("{} where a list was expected", crate::words::form(other));
                Err(ConstructError::new(self.at(key), message))
            }
        }
    }
}

/// A number as it is, or a share of `whole`.
pub(super) fn share(value: &Value, path: &str, whole: f64) -> Result<f64, ConstructError> {
    if !matches!(value, Value::Number(_) | Value::String(_)) {
        let message = format!(
            "{} where a number or a share such as \"50%\" was expected",
            crate::words::form(value)
        );
        return Err(ConstructError::new(path, message));
    }
    let read = read::<Coordinate>(value, path).map_err(|mut error| {
        // What recipes of warps take shares of is the model.
        error.message = error.message.replace(" of the model's bounds", "");
        error.hint = error.hint.replace(" of the model's bounds", "");
        error
    });
    Ok(match read? {
        Coordinate::Absolute(number) => number,
        Coordinate::Relative(share) => share * whole,
    })
}

/// The error of a word that nothing here is called.
pub(super) fn unknown(path: &str, what: &str, word: &str, known: &[&str]) -> ConstructError {
    let names: Vec<String> = known.iter().map(|name| (*name).to_owned()).collect();
    let message = format!("no {what} is called {}", crate::error::quoted(word));
    ConstructError::new(path, message).with_hint(crate::names::suggestion(word, &names))
}
