//! The error of recipes: every problem with its place and how to mend it.

use std::fmt;

/// Problems shown in one error; the rest is counted.
const SHOWN: usize = 10;
/// Characters of a message that are shown, so that a megabyte of garbage in a value stays out of it.
const MESSAGE: usize = 600;
/// How the origin of a value ends that a track has set.
pub(crate) const OF_TRACK: &str = " of its track";
/// Characters of a path that are shown.
const PATH: usize = 200;

/// Where a problem is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// In the file.
    File {
        /// Line, counted from 1.
        line: usize,
        /// Column, counted in characters from 1; a tab is one character.
        column: usize,
    },
    /// In a value given to [`Recipe::set`](crate::Recipe::set), the text is its argument; or in one that a track has set, the text says
    /// which and when.
    Setting(String),
}

/// One thing that is wrong with a recipe.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Where it is.
    pub place: Place,
    /// Path in the recipe, such as `warp.0.angle`; empty for the recipe itself and where a syntax error leaves no path.
    pub path: String,
    /// What is wrong, without a full stop.
    pub message: String,
    /// How to mend it; may be empty.
    pub hint: String,
}

impl Problem {
    pub(crate) fn new(
        place: Place,
        path: &str,
        message: impl AsRef<str>,
        hint: impl AsRef<str>,
    ) -> Self {
        Self {
            place,
            path: shown(path, PATH),
            message: shown(message.as_ref(), MESSAGE),
            hint: shown(hint.as_ref(), MESSAGE),
        }
    }
}

/// Why a recipe could not be read or built: one problem or several, in the order of the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecipeError {
    /// Name of the file.
    pub name: String,
    /// What is wrong; at least one problem, at most ten.
    pub problems: Vec<Problem>,
    /// How many more problems there are.
    pub omitted: usize,
}

impl RecipeError {
    /// An error of the given problems, sorted by place; `None` if there are none.
    pub(crate) fn of(name: &str, mut problems: Vec<Problem>) -> Option<Self> {
        problems.sort_by_key(|problem| match problem.place {
            Place::File { line, column } => (0, line, column),
            Place::Setting(_) => (1, 0, 0),
        });
        let omitted = problems.len().saturating_sub(SHOWN);
        problems.truncate(SHOWN);
        (!problems.is_empty()).then(|| Self {
            name: name.to_owned(),
            problems,
            omitted,
        })
    }

    pub(crate) fn one(name: &str, problem: Problem) -> Self {
        Self {
            name: name.to_owned(),
            problems: vec![problem],
            omitted: 0,
        }
    }
}

impl fmt::Display for RecipeError {
    /// One line a problem: `file:line:column: path: message; hint`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.problems.iter().enumerate() {
            if i > 0 {
                f.write_str("\n")?;
            }
            match &problem.place {
                Place::File { line, column } => write!(f, "{}:{line}:{column}: ", self.name)?,
                Place::Setting(origin) if origin.ends_with(OF_TRACK) => {
                    write!(f, "{}: {origin}: ", self.name)?;
                }
                Place::Setting(argument) => write!(f, "{}: --set {argument}: ", self.name)?,
            }
            if !problem.path.is_empty() {
                write!(f, "{}: ", problem.path)?;
            }
            f.write_str(&problem.message)?;
            if !problem.hint.is_empty() {
                write!(f, "; {}", problem.hint)?;
            }
        }
        if self.omitted > 0 {
            write!(f, "\n{}: and {} more", self.name, self.omitted)?;
        }
        Ok(())
    }
}

impl std::error::Error for RecipeError {}

/// `text` with control characters escaped and, if it is longer than `most` characters, without its middle.
pub(crate) fn shown(text: &str, most: usize) -> String {
    let mut out: Vec<char> = Vec::new();
    for c in text.chars() {
        if c.is_control() {
            out.extend(c.escape_default());
        } else {
            out.push(c);
        }
    }
    if out.len() > most {
        let tail = most / 3;
        let head = most.saturating_sub(tail + 1);
        out.splice(head..out.len() - tail, ['…']);
    }
    out.into_iter().collect()
}

/// A word of the user as it appears inside a message.
pub(crate) fn quoted(text: &str) -> String {
    format!("`{}`", shown(text, 40))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_problems_are_counted_and_sorted() {
        let problem = |line| {
            Problem::new(
                Place::File { line, column: 1 },
                "warp.0",
                "wrong",
                "mend it",
            )
        };
        let error = RecipeError::of("a.toml", (1..=12).rev().map(problem).collect()).unwrap();
        let text = error.to_string();
        assert_eq!(text.lines().count(), 11);
        assert!(
            text.starts_with("a.toml:1:1: warp.0: wrong; mend it\na.toml:2:1"),
            "{text}"
        );
        assert!(text.ends_with("a.toml: and 2 more"), "{text}");
        assert_eq!(RecipeError::of("a.toml", Vec::new()), None);
    }

    #[test]
    fn garbage_is_escaped_and_cut() {
        assert_eq!(shown("a\u{7}\nb", 10), "a\\u{7}\\nb");
        assert_eq!(shown("abcdefgh", 6), "abc…gh");
        assert_eq!(shown("abcdef", 6), "abcdef");
        assert_eq!(quoted(&"\u{7}".repeat(1_000_000)).chars().count(), 42);
    }
}
