//! The error of constructions: which parameter, what is wrong, how to mend it.

use serde::de::DeserializeOwned;
use serde_json::Value;

/// Why a plug-in could not be built from its parameters.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConstructError {
    /// Path to the parameter inside the plug-in's table, such as `move.2.index`; empty for the table itself.
    pub path: String,
    /// What is wrong, without a full stop.
    pub message: String,
    /// How to mend it; may be empty.
    pub hint: String,
}

impl ConstructError {
    /// An error at `path`.
    pub fn new(path: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            path: path.into(),
            message: message.into(),
            hint: String::new(),
        }
    }
    /// Adds how to mend it.
    #[must_use]
    pub fn with_hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = hint.into();
        self
    }
    /// Moves the error into the table `prefix`.
    #[must_use]
    pub fn under(mut self, prefix: &str) -> Self {
        self.path = match (prefix.is_empty(), self.path.is_empty()) {
            (true, _) => self.path,
            (false, true) => prefix.to_owned(),
            (false, false) => format!("{prefix}.{}", self.path),
        };
        self
    }
}

impl core::fmt::Display for ConstructError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        if !self.path.is_empty() {
            write!(f, "`{}`: ", self.path)?;
        }
        f.write_str(&self.message)?;
        if !self.hint.is_empty() {
            write!(f, "; {}", self.hint)?;
        }
        Ok(())
    }
}

impl std::error::Error for ConstructError {}

/// Reads a plug-in's parameters from its table; the error names the parameter.
pub fn parse<T: DeserializeOwned>(value: &Value) -> Result<T, ConstructError> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let path: Vec<String> = error
            .path()
            .iter()
            .filter_map(|segment| match segment {
                serde_path_to_error::Segment::Seq { index } => Some(index.to_string()),
                serde_path_to_error::Segment::Map { key } => Some(key.clone()),
                serde_path_to_error::Segment::Enum { .. }
                | serde_path_to_error::Segment::Unknown => None,
            })
            .collect();
        let text = error.into_inner().to_string();
        // Parameter types put the hint behind a bar; see `parameters`.
        let (message, hint) = text.split_once(" | ").unwrap_or((&text, ""));
        ConstructError {
            path: path.join("."),
            message: message.to_owned(),
            hint: hint.to_owned(),
        }
    })
}
/// What the parameters `source` and `target` name, where neither goes without the other; nothing where both are left out.
///
/// # Errors
/// An error at the one that is given alone.
pub fn source_and_target<'a, T>(
    source: Option<&'a T>,
    target: Option<&'a T>,
) -> Result<Option<(&'a T, &'a T)>, ConstructError> {
    let (here, other) = match (source, target) {
        (None, None) => return Ok(None),
        (Some(source), Some(target)) => return Ok(Some((source, target))),
        (Some(_), None) => ("source", "target"),
        (None, Some(_)) => ("target", "source"),
    };
    let message = format!("there is a `{here}` file and no `{other}`");
    Err(ConstructError::new(here, message).with_hint(format!("name the other file as `{other}`")))
}
