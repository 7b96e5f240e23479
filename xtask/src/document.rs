//! TOML files with the line of every entry, so that a finding can say where it is.

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// A value of a TOML file.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A string.
    Text(String),
    /// An integer or float.
    Number(f64),
    /// A boolean.
    Flag(bool),
    /// An array: each item with its line.
    List(Vec<(usize, Value)>),
    /// A table, whichever way it is written.
    Table(Table),
    /// A date or time; no file of the project uses them.
    Date,
}

/// One `key = value`, or the table under a header.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// The line of the key, from 1.
    pub line: usize,
    /// The value.
    pub value: Value,
}

/// A table, with its entries in the order of the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The entries.
    pub entries: Vec<Entry>,
}

/// Why a file could not be read as TOML.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotToml {
    /// The line of the error, from 1.
    pub line: usize,
    /// What the parser says.
    pub message: String,
}

impl Table {
    /// Reads a whole file.
    ///
    /// # Errors
    /// [`NotToml`] with the line, when `text` is not TOML.
    pub fn parse(text: &str) -> Result<Self, NotToml> {
        let lines = Lines::new(text);
        match DeTable::parse(text) {
            Ok(table) => Ok(convert_table(table.get_ref(), &lines)),
            Err(error) => Err(NotToml {
                line: error.span().map_or(1, |span| lines.at(span.start)),
                message: error.message().to_owned(),
            }),
        }
    }

    /// The entry of that key.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|e| e.key == key)
    }

    /// The entry that the keys lead to, table by table.
    #[must_use]
    pub fn at(&self, keys: &[&str]) -> Option<&Entry> {
        let (last, tables) = keys.split_last()?;
        let mut table = self;
        for key in tables {
            table = table.get(key)?.value.as_table()?;
        }
        table.get(last)
    }

    /// The string of that key, when it has one.
    #[must_use]
    pub fn text(&self, key: &str) -> Option<&str> {
        self.get(key)?.value.as_text()
    }
}

impl Value {
    /// The string, when it is one.
    #[must_use]
    pub fn as_text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The table, when it is one.
    #[must_use]
    pub fn as_table(&self) -> Option<&Table> {
        match self {
            Self::Table(table) => Some(table),
            _ => None,
        }
    }

    /// The items, when it is an array; else nothing.
    #[must_use]
    pub fn items(&self) -> &[(usize, Value)] {
        match self {
            Self::List(items) => items,
            _ => &[],
        }
    }
}

/// Turns byte positions into line numbers.
pub struct Lines {
    starts: Vec<usize>,
}

impl Lines {
    /// Notes where the lines of `text` start.
    #[must_use]
    pub fn new(text: &str) -> Self {
        let after_breaks = text
            .bytes()
            .enumerate()
            .filter(|(_, b)| *b == b'\n')
            .map(|(i, _)| i + 1);
        Self {
            starts: std::iter::once(0).chain(after_breaks).collect(),
        }
    }

    /// The line, from 1, of a byte position.
    #[must_use]
    pub fn at(&self, position: usize) -> usize {
        self.starts
            .partition_point(|start| *start <= position)
            .max(1)
    }
}

fn convert_table(table: &DeTable<'_>, lines: &Lines) -> Table {
    let mut entries: Vec<(usize, Entry)> = table
        .iter()
        .map(|(key, value)| {
            let start = key.span().start;
            let entry = Entry {
                key: key.get_ref().to_string(),
                line: lines.at(start),
                value: convert(value.get_ref(), lines),
            };
            (start, entry)
        })
        .collect();
    entries.sort_by_key(|(start, _)| *start);
    Table {
        entries: entries.into_iter().map(|(_, entry)| entry).collect(),
    }
}

fn convert(value: &DeValue<'_>, lines: &Lines) -> Value {
    match value {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(number) => Value::Number(
            i64::from_str_radix(number.as_str(), number.radix()).map_or(f64::NAN, |n| n as f64),
        ),
        DeValue::Float(number) => Value::Number(number.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Array(items) => Value::List(convert_list(items, lines)),
        DeValue::Table(table) => Value::Table(convert_table(table, lines)),
    }
}

fn convert_list(items: &DeArray<'_>, lines: &Lines) -> Vec<(usize, Value)> {
    items
        .iter()
        .map(|item: &Spanned<DeValue<'_>>| {
            (lines.at(item.span().start), convert(item.get_ref(), lines))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "top = 1\n\n[package]\nname = \"x\"\nversion.workspace = true\n\n[[bar]]\nat = 2.5\n\n[[bar]]\nat = [\n  \"a\",\n  \"b\",\n]\n";

    #[test]
    fn values_and_lines_are_found() {
        let file = Table::parse(TEXT).expect("TOML");
        assert_eq!(
            file.get("top").map(|e| (e.line, e.value.clone())),
            Some((1, Value::Number(1.0)))
        );
        assert_eq!(file.at(&["package", "name"]).map(|e| e.line), Some(4));
        let inherited = file
            .at(&["package", "version", "workspace"])
            .expect("a dotted key");
        assert_eq!((inherited.line, &inherited.value), (5, &Value::Flag(true)));
        let bars = file.get("bar").expect("tables").value.items();
        assert_eq!(
            bars.iter().map(|(line, _)| *line).collect::<Vec<_>>(),
            [7, 10]
        );
        let list = bars[1]
            .1
            .as_table()
            .and_then(|t| t.get("at"))
            .expect("a list")
            .value
            .items();
        assert_eq!(
            list,
            [(12, Value::Text("a".into())), (13, Value::Text("b".into()))]
        );
    }

    #[test]
    fn an_error_has_its_line() {
        let error = Table::parse("a = 1\nb = = 2\n").expect_err("not TOML");
        assert_eq!(error.line, 2);
        assert!(!error.message.is_empty());
    }

    #[test]
    fn positions_on_line_breaks_belong_to_the_line_they_end() {
        let lines = Lines::new("ab\n\nc");
        assert_eq!([0, 2, 3, 4].map(|p| lines.at(p)), [1, 1, 2, 3]);
    }
}
