//! TOML into the common tree.

use crate::error::{Problem, quoted, shown};
use crate::recipe::MAX_DEPTH;
use crate::tree::{Node, Source, join};
use serde_json::{Map, Number, Value};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeInteger, DeTable, DeValue};
use toml_parser::lexer::TokenKind;

/// Why a value has no place in the tree: offset, path, message, hint.
struct Refusal(usize, String, String, &'static str);

/// Reads a document.
pub(crate) fn read(source: &Source) -> Result<(Value, Node), Problem> {
    let text = source.text.as_str();
    let syntax_problem = |error: &toml::de::Error| {
        let (offset, message, hint) = plain(error.message(), text, error.span().unwrap_or(0..0));
        (offset, source.problem(offset, "", message, hint))
    };
    if let Some(offset) = too_deep(text) {
        // Brackets that were never closed add up: then the first of them is to blame.
        let lines = text
            .get(..offset)
            .and_then(|before| before.rsplit_once('\n'));
        let before = lines.map_or("", |(lines, _)| lines);
        return Err(
            match DeTable::parse(before).map_err(|error| syntax_problem(&error)) {
                Err((offset, problem)) if offset < before.trim_end().len() => problem,
                _ => depth_problem(source, offset),
            },
        );
    }
    let table = DeTable::parse(text).map_err(|error| syntax_problem(&error).1)?;
    let mut node = Node {
        span: 0..text.len(),
        ..Node::default()
    };
    let value = table_value(table.get_ref(), "", &mut node).map_err(
        |Refusal(offset, path, message, hint)| source.problem(offset, &path, message, hint),
    )?;
    Ok((value, node))
}

/// Reads a single value; `None` if the text is no TOML value or a date. An error is message and hint.
pub(crate) fn read_value(text: &str) -> Option<Result<Value, (String, String)>> {
    if too_deep(text).is_some() {
        let message = format!("nested deeper than {MAX_DEPTH} levels");
        return Some(Err((message, "no recipe needs that many".to_owned())));
    }
    let parsed = DeValue::parse(text).ok()?;
    if parsed.get_ref().is_datetime() {
        return None;
    }
    let read = value(&parsed, "", &mut Node::default());
    Some(read.map_err(|Refusal(_, _, message, hint)| (message, hint.to_owned())))
}

pub(crate) fn depth_problem(source: &Source, offset: usize) -> Problem {
    let message = format!("tables and lists are nested deeper than {MAX_DEPTH} levels");
    source.problem(offset, "", message, "no recipe needs that many")
}

/// The offset at which the document nests too deeply, if it does.
///
/// The parser limits brackets and the length of each dotted key, but not their product: 80 inline tables under keys of 80
/// words are 6400 tables deep, and dropping them would overflow a small stack. So count before parsing, in tokens: every
/// open bracket and every dot of the key before it is a level; a header is two levels per word.
fn too_deep(text: &str) -> Option<usize> {
    // Dots since the last separator, for every open bracket.
    let mut levels = vec![0_usize];
    let (mut depth, mut header) = (0, 0);
    for token in toml_parser::Source::new(text).lex() {
        match token.kind() {
            TokenKind::LeftSquareBracket | TokenKind::LeftCurlyBracket => {
                depth += 1;
                levels.push(0);
            }
            TokenKind::RightSquareBracket | TokenKind::RightCurlyBracket if levels.len() > 1 => {
                let dots = levels.pop().unwrap_or(0);
                depth -= 1 + dots;
                if levels.len() <= 2 {
                    // Perhaps the end of a header, below which the next keys are. Each of its words may be a list
                    // of tables.
                    header = header.max(2 * (dots + 1));
                }
            }
            TokenKind::Dot => {
                if let Some(dots) = levels.last_mut() {
                    *dots += 1;
                    depth += 1;
                }
            }
            TokenKind::Comma | TokenKind::Newline => {
                if let Some(dots) = levels.last_mut() {
                    depth -= core::mem::take(dots);
                }
            }
            _ => {}
        }
        if depth + header > MAX_DEPTH {
            return Some(token.span().start());
        }
    }
    None
}

fn table_value(table: &DeTable<'_>, path: &str, node: &mut Node) -> Result<Value, Refusal> {
    let mut map = Map::new();
    for (key, item) in table {
        let name: &str = key.get_ref();
        let mut child = Node {
            key: Some(key.span()),
            span: item.span(),
            ..Node::default()
        };
        map.insert(name.to_owned(), value(item, &join(path, name), &mut child)?);
        node.children.insert(name.to_owned(), child);
    }
    Ok(Value::Object(map))
}

fn value(item: &Spanned<DeValue<'_>>, path: &str, node: &mut Node) -> Result<Value, Refusal> {
    let refuse =
        |message: String, hint| Err(Refusal(item.span().start, path.to_owned(), message, hint));
    match item.get_ref() {
        DeValue::String(text) => Ok(Value::String(text.clone().into_owned())),
        DeValue::Boolean(truth) => Ok(Value::Bool(*truth)),
        DeValue::Integer(number) => match integer(number) {
            Some(number) => Ok(Value::Number(number)),
            None => refuse(
                format!("the number {} is too large", quoted(&number.to_string())),
                "",
            ),
        },
        DeValue::Float(number) => {
            let parsed = number.as_str().parse::<f64>().ok();
            match parsed.and_then(Number::from_f64) {
                Some(number) => Ok(Value::Number(number)),
                None => refuse(
                    format!("{} is not a finite number", quoted(number.as_str())),
                    "write a finite number",
                ),
            }
        }
        DeValue::Datetime(_) => refuse(
            "a date or time has no meaning in a recipe".to_owned(),
            "put text in quotes",
        ),
        DeValue::Array(list) => {
            let mut values = Vec::with_capacity(list.len());
            for (i, item) in list.iter().enumerate() {
                let index = i.to_string();
                let mut child = Node {
                    span: item.span(),
                    ..Node::default()
                };
                values.push(value(item, &join(path, &index), &mut child)?);
                node.children.insert(index, child);
            }
            Ok(Value::Array(values))
        }
        DeValue::Table(table) => table_value(table, path, node),
    }
}

/// An integer; one that fits no machine word becomes the nearest number, as in JSON.
fn integer(number: &DeInteger<'_>) -> Option<Number> {
    let (digits, radix) = (number.as_str(), number.radix());
    if let Ok(small) = i64::from_str_radix(digits, radix) {
        return Some(small.into());
    }
    if let Ok(large) = u64::from_str_radix(digits, radix) {
        return Some(large.into());
    }
    (radix == 10)
        .then(|| digits.parse::<f64>().ok().and_then(Number::from_f64))
        .flatten()
}

/// A syntax error in plain words: offset, message, and how to mend it.
fn plain(message: &str, text: &str, span: Range<usize>) -> (usize, String, String) {
    let offset = span.start.min(text.len());
    let starts = |phrases: &[&str]| phrases.iter().any(|phrase| message.starts_with(phrase));
    let line = text
        .get(..offset)
        .unwrap_or("")
        .rfind('\n')
        .map_or(0, |n| n + 1);
    let line = text.get(line..).unwrap_or("").trim_start();
    if line.starts_with("//") || line.starts_with("/*") {
        let hint = "a comment in TOML begins with #".to_owned();
        return (offset, message.to_owned(), hint);
    }
    if starts(&[
        "invalid float",
        "invalid integer",
        "invalid datetime",
        "invalid decimal",
        "invalid boolean",
        "string values must",
    ]) {
        // The parser points into the word; show all of it.
        let inside = |c: char| !c.is_whitespace() && !",=[]{}#\"'".contains(c);
        let before = text.get(..offset).unwrap_or("");
        let start = before.trim_end_matches(inside).len();
        let after = text.get(start..).unwrap_or("");
        let word = &after[..after.find(|c| !inside(c)).unwrap_or(after.len())];
        if word.is_empty() {
            let message = "a value is missing".to_owned();
            return (offset, message, "write it after the `=`".to_owned());
        }
        let message = format!("{} is neither a number nor text in quotes", quoted(word));
        return (start, message, format!("write \"{}\"", shown(word, 40)));
    }
    let hint = if starts(&["duplicate key"]) {
        let key = quoted(text.get(span).unwrap_or(""));
        return (
            offset,
            format!("duplicate key {key}"),
            "write each key once".to_owned(),
        );
    } else if starts(&["key with no value"]) {
        "write `key = value`"
    } else if starts(&["unclosed array table"]) {
        "a warp begins with two brackets on each side: [[warp]]"
    } else if starts(&["invalid basic string", "invalid literal string"]) {
        "close the text with a quote on the same line"
    } else {
        ""
    };
    (offset, message.to_owned(), hint.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_is_counted_before_parsing() {
        assert_eq!(
            too_deep("a = 1.5\nb = [1.5, 2.5, [3.5]]\n[x.y]\nc.d = { e.f = 1 }"),
            None
        );
        assert!(too_deep(&format!("a = {}", "[".repeat(10_000))).is_some());
        assert!(too_deep(&format!("{} = 1", ["a"; 100].join("."))).is_some());
        assert!(
            too_deep(&format!(
                "[{}]\nx = {}",
                ["a"; 40].join("."),
                "[".repeat(40)
            ))
            .is_some()
        );
        let nest = format!("{{{} = ", ["a"; 79].join("."));
        assert!(too_deep(&format!("a = {}", nest.repeat(79))).is_some());
        // Long lists of numbers are not deep, and dots inside strings and comments are not keys.
        let long = format!("a = [{}]", vec!["[0.5, 1.25]"; 10_000].join(", "));
        assert_eq!(too_deep(&long), None);
        assert_eq!(
            too_deep(&format!(
                "a = \"{}\" # {}",
                ".[".repeat(500),
                "[.".repeat(500)
            )),
            None
        );
    }

    #[test]
    fn single_values() {
        let read = |text| read_value(text).map(|value| value.map(|value| value.to_string()));
        assert_eq!(
            read("[1, 2.5, {a = \"x\"}]"),
            Some(Ok("[1,2.5,{\"a\":\"x\"}]".into()))
        );
        assert_eq!(read("30deg"), None);
        assert_eq!(read("2020-01-01"), None);
        assert_eq!(read("1 2"), None);
        assert_eq!(read("99999999999999999999"), Some(Ok("1e+20".into())));
        assert!(read("nan").unwrap().is_err());
        assert!(read(&"[".repeat(100_000)).unwrap().is_err());
    }
}
