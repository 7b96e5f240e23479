//! JSON into the common tree.
//!
//! The text is validated and read by `serde_json`; a scan over the then valid text adds what that does not tell: spans
//! and repeated keys.

use crate::error::{Problem, quoted};
use crate::recipe::MAX_DEPTH;
use crate::tree::{Node, Source, join};
use serde_json::Value;
use std::collections::btree_map::Entry;

/// Reads a document.
pub(crate) fn read(source: &Source) -> Result<(Value, Node), Problem> {
    let value: Value =
        serde_json::from_str(&source.text).map_err(|error| syntax_problem(source, &error))?;
    let mut scan = Scan { source, offset: 0 };
    let node = scan.node("", 0)?;
    Ok((value, node))
}

fn syntax_problem(source: &Source, error: &serde_json::Error) -> Problem {
    let text = source.text.as_str();
    let full = error.to_string();
    let message = full
        .rsplit_once(" at line ")
        .map_or(full.as_str(), |(message, _)| message);
    // `serde_json` counts lines from 1 and columns in bytes from 1; column 0 is the newline itself.
    let line_start = error
        .line()
        .checked_sub(2)
        .and_then(|n| text.match_indices('\n').nth(n))
        .map_or(0, |(newline, _)| newline + 1);
    let mut offset = line_start + error.column().saturating_sub(1);
    if matches!(message, "expected ident" | "invalid number") {
        // Found in the middle of a word; show all of it.
        let before = text.get(..offset).unwrap_or("");
        let inside = |c: char| c.is_ascii_alphanumeric() || "+-.".contains(c);
        offset = before.trim_end_matches(inside).len();
    }
    let at = text.get(offset..).unwrap_or("");
    let (message, hint) = if at.starts_with(['/', '#']) {
        (
            "JSON has no comments",
            "remove it, or write the recipe as TOML, where a comment begins with #",
        )
    } else if error.is_eof() {
        ("the file ends in the middle of the recipe", "complete it")
    } else {
        match message {
            "trailing comma" => ("a comma with nothing after it", "remove the comma"),
            "trailing characters" => ("something follows the end of the recipe", "remove it"),
            "key must be a string" => ("a key in JSON is a string", "put the key in double quotes"),
            "recursion limit exceeded" => return crate::toml::depth_problem(source, offset),
            "number out of range" => ("the number is too large", "write a finite number"),
            "expected value" | "expected ident" | "invalid number" if number_name(at) => {
                ("JSON has only finite numbers", "write a finite number")
            }
            "expected value" => (
                "a value was expected here",
                "write a number, a string in double quotes, true, false, a list or a table",
            ),
            "expected ident" => (
                "this word has no meaning in JSON",
                "put text in double quotes",
            ),
            _ if message.starts_with("control character") => (
                "a line break or another control character stands inside a string",
                "close the string before the line ends",
            ),
            other => (other, ""),
        }
    };
    source.problem(offset, "", message, hint)
}

/// Whether a number that JSON does not know stands here.
fn number_name(text: &str) -> bool {
    let text = text.strip_prefix(['-', '+']).unwrap_or(text);
    let word = text.get(..3).unwrap_or("");
    word.eq_ignore_ascii_case("nan") || word.eq_ignore_ascii_case("inf")
}

/// A walk over valid JSON.
struct Scan<'a> {
    source: &'a Source,
    offset: usize,
}

impl Scan<'_> {
    fn peek(&mut self) -> u8 {
        let bytes = self.source.text.as_bytes();
        while let Some(byte) = bytes.get(self.offset) {
            if !byte.is_ascii_whitespace() {
                return *byte;
            }
            self.offset += 1;
        }
        0
    }

    /// Steps over a comma; whether there was one.
    fn comma(&mut self) -> bool {
        let found = self.peek() == b',';
        self.offset += usize::from(found);
        found
    }

    /// Steps over a string, quotes included.
    fn string(&mut self) {
        let bytes = self.source.text.as_bytes();
        self.offset += 1;
        while let Some(byte) = bytes.get(self.offset) {
            self.offset += match byte {
                b'\\' => 2,
                b'"' => {
                    self.offset += 1;
                    return;
                }
                _ => 1,
            };
        }
    }

    fn node(&mut self, path: &str, depth: usize) -> Result<Node, Problem> {
        let mut node = Node::default();
        let open = self.peek();
        let start = self.offset;
        if depth > MAX_DEPTH {
            return Err(crate::toml::depth_problem(self.source, start));
        }
        match open {
            b'{' => self.members(path, depth, &mut node)?,
            b'[' => {
                self.offset += 1;
                while self.peek() != b']' && self.peek() != 0 {
                    let index = node.children.len().to_string();
                    let child = self.node(&join(path, &index), depth + 1)?;
                    node.children.insert(index, child);
                    if !self.comma() {
                        break;
                    }
                }
                self.offset += 1;
            }
            b'"' => self.string(),
            _ => {
                let bytes = self.source.text.as_bytes();
                let scalar = |b: &u8| b.is_ascii_alphanumeric() || b"+-.".contains(b);
                while bytes.get(self.offset).is_some_and(scalar) {
                    self.offset += 1;
                }
            }
        }
        node.span = start..self.offset;
        Ok(node)
    }

    fn members(&mut self, path: &str, depth: usize, node: &mut Node) -> Result<(), Problem> {
        self.offset += 1;
        while self.peek() == b'"' {
            let start = self.offset;
            self.string();
            let span = start..self.offset;
            let text = self.source.text.get(span.clone()).unwrap_or("\"\"");
            let key: String = serde_json::from_str(text).unwrap_or_default();
            // The colon.
            self.peek();
            self.offset += 1;
            let mut child = self.node(&join(path, &key), depth + 1)?;
            child.key = Some(span);
            match node.children.entry(key) {
                Entry::Vacant(place) => {
                    place.insert(child);
                }
                Entry::Occupied(place) => {
                    return Err(self.source.problem(
                        start,
                        &join(path, place.key()),
                        format!("duplicate key {}", quoted(place.key())),
                        "write each key once",
                    ));
                }
            }
            if !self.comma() {
                break;
            }
        }
        self.peek();
        self.offset += 1;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tree::Syntax;

    #[test]
    fn spans_are_those_of_the_text() {
        let text = r#" { "a\"\u00e9" : [1.5e-3, {"b": "]}\\"}, null], "c": {}, "d": [] } "#;
        let source = Source::new("a.json", text, Syntax::Json);
        let (value, node) = read(&source).unwrap();
        let list = &node.children["a\"é"];
        assert_eq!(&text[list.key.clone().unwrap()], r#""a\"\u00e9""#);
        let spans = list.children.values().map(|n| &text[n.span.clone()]);
        assert_eq!(
            spans.collect::<Vec<_>>(),
            ["1.5e-3", r#"{"b": "]}\\"}"#, "null"]
        );
        assert_eq!(&text[node.span.clone()], text.trim());
        // Every span holds the JSON of its value.
        fn agree(text: &str, value: &Value, node: &Node) {
            let read: Value = serde_json::from_str(&text[node.span.clone()]).unwrap();
            assert_eq!(&read, value);
            for (key, child) in &node.children {
                let inner = match value {
                    Value::Array(list) => &list[key.parse::<usize>().unwrap()],
                    other => &other[key],
                };
                agree(text, inner, child);
            }
        }
        agree(text, &value, &node);
    }
}
