//! Where everything stands: a tree of spans beside the tree of values, and the text they point into.

use crate::error::{Place, Problem};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// The syntax of a recipe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Syntax {
    Toml,
    Json,
}

/// The text of a recipe.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    pub(crate) name: String,
    pub(crate) text: String,
    pub(crate) syntax: Syntax,
    /// Where the lines but the first begin.
    lines: Vec<usize>,
}

impl Source {
    pub(crate) fn new(name: &str, text: &str, syntax: Syntax) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text).to_owned();
        Self {
            name: name.to_owned(),
            lines: text.match_indices('\n').map(|(at, _)| at + 1).collect(),
            text,
            syntax,
        }
    }

    /// Line and column of a byte offset. What lies behind the last visible character is shown just after it, so that
    /// "the file ends here" names a line that can be seen.
    pub(crate) fn place(&self, offset: usize) -> Place {
        let end = self.text.trim_end().len();
        let offset = offset.min(end);
        let line = self.lines.partition_point(|&start| start <= offset);
        let start = line.checked_sub(1).map_or(0, |last| self.lines[last]);
        Place::File {
            line: 1 + line,
            // Every byte but the continuation bytes of UTF-8 begins a character.
            column: 1 + self.text.as_bytes()[start..offset]
                .iter()
                .filter(|&&b| b & 0xC0 != 0x80)
                .count(),
        }
    }

    pub(crate) fn problem(
        &self,
        offset: usize,
        path: &str,
        message: impl AsRef<str>,
        hint: impl AsRef<str>,
    ) -> Problem {
        Problem::new(self.place(offset), path, message, hint)
    }

    /// How a key and its value are written in this syntax.
    pub(crate) fn assignment(&self, key: &str, value: &str) -> String {
        match self.syntax {
            Syntax::Toml => format!("{key} = {value}"),
            Syntax::Json => format!("\"{key}\": {value}"),
        }
    }
}

/// Span of a value and of what is inside it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Node {
    /// Bytes of the key; `None` in a list.
    pub(crate) key: Option<Range<usize>>,
    /// Bytes of the value; of the header for a table that has one.
    pub(crate) span: Range<usize>,
    /// The argument of `--set` that this came from.
    pub(crate) origin: Option<Arc<str>>,
    /// Entries by key, or by number in decimal digits.
    pub(crate) children: BTreeMap<String, Self>,
}

/// What of a node is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    Key,
    Value,
}

impl Node {
    pub(crate) fn of_setting(origin: Arc<str>) -> Self {
        Self {
            origin: Some(origin),
            ..Self::default()
        }
    }

    /// The node at a path, or its nearest ancestor, and whether it is the node itself. A key may contain dots: longer
    /// keys are tried after shorter ones.
    fn find(&self, path: &str) -> (&Self, bool) {
        let (mut node, mut rest) = (self, path);
        while !rest.is_empty() {
            let ends = rest.match_indices('.').map(|(end, _)| end);
            let step = ends.chain([rest.len()]).find_map(|end| {
                let child = node.children.get(&rest[..end])?;
                Some((child, rest.get(end + 1..).unwrap_or("")))
            });
            let Some((child, after)) = step else {
                return (node, false);
            };
            (node, rest) = (child, after);
        }
        (node, true)
    }

    /// Where the key or value at `path` stands; the nearest table or list around it if it is missing.
    pub(crate) fn locate(&self, source: &Source, path: &str, part: Part) -> Place {
        let (node, exact) = self.find(path);
        if let Some(origin) = &node.origin {
            return Place::Setting(crate::error::shown(origin, 200));
        }
        let offset = match (&node.key, part) {
            (Some(key), Part::Key) if exact => key.start,
            _ => node.span.start,
        };
        source.place(offset)
    }
}

/// `prefix.key`.
pub(crate) fn join(prefix: &str, key: &str) -> String {
    match (prefix.is_empty(), key.is_empty()) {
        (true, _) => key.to_owned(),
        (_, true) => prefix.to_owned(),
        _ => format!("{prefix}.{key}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_characters_and_stay_inside_the_text() {
        let source = Source::new("a", "é\tx\r\nyz\n\n\n", Syntax::Toml);
        let at = |offset| match source.place(offset) {
            Place::File { line, column } => (line, column),
            Place::Setting(_) => (0, 0),
        };
        assert_eq!(
            [at(0), at(2), at(3), at(6)],
            [(1, 1), (1, 2), (1, 3), (2, 1)]
        );
        assert_eq!([at(8), at(11), at(usize::MAX)], [(2, 3); 3]);
        assert_eq!(Source::new("a", "\u{feff}x", Syntax::Toml).text, "x");
    }

    #[test]
    fn keys_with_dots_are_found() {
        let leaf = |start| Node {
            span: start..start,
            ..Node::default()
        };
        let mut table = leaf(1);
        table.children.insert("b.c".into(), leaf(2));
        let mut root = leaf(0);
        root.children.insert("a".into(), table);
        assert_eq!(root.find("a.b.c").0.span.start, 2);
        assert!(root.find("a.b.c").1);
        assert_eq!(root.find("a.b.x").0.span.start, 1);
        assert!(!root.find("a.b.x").1);
    }
}
