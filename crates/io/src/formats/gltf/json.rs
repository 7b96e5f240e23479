//! JSON that remembers where everything stands, so that a few values can be replaced and every other byte kept.
//!
//! *Source*: RFC 8259, "The JavaScript Object Notation (JSON) Data Interchange Format", 2017. The text is kept as it is; beside
//! it stands one small record a value, in the order of the text. Reading needs no recursion, so nesting may be of any depth.

use crate::{ReadError, ReadErrorKind};
use core::ops::Range;
use std::borrow::Cow;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Null,
    Bool,
    Number,
    Text,
    List,
    Table,
}

/// A value: where its text is, and which record follows behind it and all it holds.
#[derive(Clone, Copy)]
struct Record {
    start: u32,
    end: u32,
    next: u32,
    kind: Kind,
}

/// A JSON text and its values. In a table keys and values alternate.
pub(super) struct Json {
    pub(super) text: String,
    records: Vec<Record>,
}

/// A value of a [`Json`].
#[derive(Clone, Copy)]
pub(super) struct Value<'a> {
    json: &'a Json,
    at: u32,
}

fn wrong(text: &[u8], at: usize, what: impl Into<String>) -> ReadError {
    ReadError::new(
        ReadErrorKind::Syntax,
        what,
        "export the model again, or correct the JSON there",
    )
    .at(text, at)
}

/// Reads tokens.
struct Scanner<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Scanner<'_> {
    fn blank(&mut self) {
        while let Some(b' ' | b'\t' | b'\n' | b'\r') = self.bytes.get(self.at) {
            self.at += 1;
        }
    }
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }
    fn error(&self, what: &str) -> ReadError {
        let found = match self.bytes.get(self.at..) {
            Some([first, ..]) if first.is_ascii_graphic() => format!("`{}`", char::from(*first)),
            Some([first, ..]) => format!("byte {first:#04x}"),
            _ => "the end of the text".to_owned(),
        };
        wrong(
            self.bytes,
            self.at,
            format!("the JSON has {found} where {what} should be"),
        )
    }
    fn word(&mut self, word: &[u8]) -> Result<(), ReadError> {
        if self.bytes[self.at..].starts_with(word) {
            self.at += word.len();
            Ok(())
        } else {
            Err(self.error("a value"))
        }
    }
    fn text(&mut self) -> Result<(), ReadError> {
        let start = self.at;
        self.at += 1;
        loop {
            let Some(skipped) = memchr::memchr2(b'"', b'\\', &self.bytes[self.at..]) else {
                return Err(wrong(
                    self.bytes,
                    start,
                    "the JSON has a text without its closing quote",
                ));
            };
            if let Some(control) = self.bytes[self.at..self.at + skipped]
                .iter()
                .position(|byte| *byte < 0x20)
            {
                self.at += control;
                return Err(self.error("a character of a text"));
            }
            self.at += skipped + 1;
            if self.bytes[self.at - 1] == b'"' {
                return Ok(());
            }
            match self.peek() {
                Some(b'"' | b'\\' | b'/' | b'b' | b'f' | b'n' | b'r' | b't') => self.at += 1,
                Some(b'u')
                    if self
                        .bytes
                        .get(self.at + 1..self.at + 5)
                        .is_some_and(|digits| digits.iter().all(u8::is_ascii_hexdigit)) =>
                {
                    self.at += 5;
                }
                _ => return Err(self.error("an escape such as \\n")),
            }
        }
    }
    fn digits(&mut self) -> Result<(), ReadError> {
        if !self.peek().is_some_and(|b| b.is_ascii_digit()) {
            return Err(self.error("a digit"));
        }
        while self.peek().is_some_and(|b| b.is_ascii_digit()) {
            self.at += 1;
        }
        Ok(())
    }
    fn number(&mut self) -> Result<(), ReadError> {
        if self.peek() == Some(b'-') {
            self.at += 1;
        }
        if self.peek() == Some(b'0') {
            self.at += 1;
        } else {
            self.digits()?;
        }
        if self.peek() == Some(b'.') {
            self.at += 1;
            self.digits()?;
        }
        if let Some(b'e' | b'E') = self.peek() {
            self.at += 1;
            if let Some(b'+' | b'-') = self.peek() {
                self.at += 1;
            }
            self.digits()?;
        }
        Ok(())
    }
}

impl Json {
    /// Reads a text; a byte-order mark is passed over.
    pub(super) fn read(bytes: Vec<u8>) -> Result<Self, ReadError> {
        let text = String::from_utf8(bytes).map_err(|error| {
            let at = error.utf8_error().valid_up_to();
            let mut broken = wrong(error.as_bytes(), at, "the JSON is not UTF-8 text");
            broken.kind = ReadErrorKind::Encoding;
            broken
        })?;
        if u32::try_from(text.len()).is_err() {
            return Err(ReadError::new(
                ReadErrorKind::TooLarge,
                "the JSON is larger than 4 GiB",
                "keep the model's data in a binary buffer (GLB)",
            ));
        }
        let mut records: Vec<Record> = Vec::new();
        // The lists and tables that are open.
        let mut open: Vec<usize> = Vec::new();
        let mut scan = Scanner {
            bytes: text.as_bytes(),
            at: 0,
        };
        if scan.bytes.starts_with(crate::text::BYTE_ORDER_MARK) {
            scan.at = crate::text::BYTE_ORDER_MARK.len();
        }
        loop {
            // A value, or the end of an empty list or table.
            scan.blank();
            let start = scan.at as u32;
            let kind = match scan.peek() {
                Some(b'{') => Kind::Table,
                Some(b'[') => Kind::List,
                Some(b'"') => Kind::Text,
                Some(b'-' | b'0'..=b'9') => Kind::Number,
                Some(b't' | b'f') => Kind::Bool,
                Some(b'n') => Kind::Null,
                _ => return Err(scan.error("a value")),
            };
            let record = records.len();
            records.push(Record {
                start,
                end: start,
                next: record as u32 + 1,
                kind,
            });
            let mut closing = false;
            match kind {
                Kind::Table | Kind::List => {
                    scan.at += 1;
                    scan.blank();
                    open.push(record);
                    closing = scan.peek() == Some(if kind == Kind::Table { b'}' } else { b']' });
                    if !closing {
                        if kind == Kind::Table {
                            key(&mut scan, &mut records)?;
                        }
                        continue;
                    }
                }
                Kind::Text => scan.text()?,
                Kind::Number => scan.number()?,
                Kind::Bool if scan.peek() == Some(b't') => scan.word(b"true")?,
                Kind::Bool => scan.word(b"false")?,
                Kind::Null => scan.word(b"null")?,
            }
            if !closing {
                records[record].end = scan.at as u32;
            }
            // What is complete now may be the last of what holds it.
            loop {
                scan.blank();
                let Some(&holder) = open.last() else {
                    if scan.at < scan.bytes.len() {
                        return Err(scan.error("the end of the text"));
                    }
                    return Ok(Self { text, records });
                };
                let table = records[holder].kind == Kind::Table;
                match scan.peek() {
                    Some(b',') if !closing => {
                        scan.at += 1;
                        if table {
                            key(&mut scan, &mut records)?;
                        }
                        break;
                    }
                    Some(b'}') if table => {}
                    Some(b']') if !table => {}
                    _ if table => return Err(scan.error("`,` or `}`")),
                    _ => return Err(scan.error("`,` or `]`")),
                }
                scan.at += 1;
                closing = false;
                let next = records.len() as u32;
                records[holder].end = scan.at as u32;
                records[holder].next = next;
                open.pop();
            }
        }
    }

    /// The whole.
    pub(super) fn root(&self) -> Value<'_> {
        Value { json: self, at: 0 }
    }
}

/// Reads a key and the colon behind it.
fn key(scan: &mut Scanner<'_>, records: &mut Vec<Record>) -> Result<(), ReadError> {
    scan.blank();
    if scan.peek() != Some(b'"') {
        return Err(scan.error("a key in quotes"));
    }
    let start = scan.at as u32;
    scan.text()?;
    records.push(Record {
        start,
        end: scan.at as u32,
        next: records.len() as u32 + 1,
        kind: Kind::Text,
    });
    scan.blank();
    if scan.peek() != Some(b':') {
        return Err(scan.error("`:`"));
    }
    scan.at += 1;
    Ok(())
}

impl<'a> Value<'a> {
    fn record(self) -> Record {
        self.json.records[self.at as usize]
    }
    pub(super) fn kind(self) -> Kind {
        self.record().kind
    }
    /// Where its text is.
    pub(super) fn span(self) -> Range<usize> {
        self.record().start as usize..self.record().end as usize
    }
    /// Its text as written.
    pub(super) fn raw(self) -> &'a str {
        &self.json.text[self.span()]
    }
    /// Everything directly in it; of a table keys and values in turn.
    fn parts(self) -> impl Iterator<Item = Value<'a>> {
        let record = self.record();
        let holds = matches!(record.kind, Kind::List | Kind::Table);
        let mut at = self.at + 1;
        core::iter::from_fn(move || {
            if !holds || at >= record.next {
                return None;
            }
            let part = Value {
                json: self.json,
                at,
            };
            at = part.record().next;
            Some(part)
        })
    }
    /// The values of a list; nothing for what is none.
    pub(super) fn items(self) -> impl Iterator<Item = Value<'a>> {
        let list = self.kind() == Kind::List;
        self.parts().filter(move |_| list)
    }
    /// Keys and values of a table; nothing for what is none.
    pub(super) fn entries(self) -> impl Iterator<Item = (Cow<'a, str>, Value<'a>)> {
        let table = self.kind() == Kind::Table;
        let mut parts = self.parts().filter(move |_| table);
        core::iter::from_fn(move || Some((parts.next()?.text()?, parts.next()?)))
    }
    /// The value of a key; of the last, if there are several, as most readers have it.
    pub(super) fn get(self, key: &str) -> Option<Value<'a>> {
        self.entries()
            .filter(|(known, _)| known == key)
            .last()
            .map(|(_, value)| value)
    }
    /// A text, its escapes resolved.
    pub(super) fn text(self) -> Option<Cow<'a, str>> {
        if self.kind() != Kind::Text {
            return None;
        }
        let raw = self.raw();
        let inner = &raw[1..raw.len() - 1];
        Some(if inner.contains('\\') {
            Cow::Owned(unescaped(inner))
        } else {
            Cow::Borrowed(inner)
        })
    }
    /// A number.
    pub(super) fn number(self) -> Option<f64> {
        (self.kind() == Kind::Number)
            .then(|| self.raw().parse().ok())
            .flatten()
    }
    /// A whole number from 0.
    pub(super) fn whole(self) -> Option<usize> {
        if self.kind() != Kind::Number {
            return None;
        }
        self.raw().parse().ok().or_else(|| {
            // 1.0 and 1e3 are whole, too.
            let number: f64 = self.raw().parse().ok()?;
            (number.fract() == 0.0 && (0.0..9e15).contains(&number)).then_some(number as usize)
        })
    }
    /// Whether it is `true`.
    pub(super) fn is_true(self) -> bool {
        self.kind() == Kind::Bool && self.raw() == "true"
    }
}

fn unescaped(inner: &str) -> String {
    let mut out = String::with_capacity(inner.len());
    let mut rest = inner;
    // The first half of a character beyond the basic plane.
    let mut high: Option<u32> = None;
    while let Some(at) = rest.find('\\') {
        if at > 0 && high.take().is_some() {
            out.push(char::REPLACEMENT_CHARACTER);
        }
        out.push_str(&rest[..at]);
        let code = rest.as_bytes().get(at + 1).copied().unwrap_or(b'\\');
        rest = rest.get(at + 2..).unwrap_or("");
        if code == b'u' {
            let unit = rest
                .get(..4)
                .and_then(|digits| u32::from_str_radix(digits, 16).ok())
                .unwrap_or(0xFFFD);
            rest = rest.get(4..).unwrap_or("");
            match (high.take(), unit) {
                (Some(first), 0xDC00..=0xDFFF) => {
                    let whole = 0x10000 + ((first - 0xD800) << 10) + (unit - 0xDC00);
                    out.push(char::from_u32(whole).unwrap_or(char::REPLACEMENT_CHARACTER));
                    continue;
                }
                (Some(_), _) => out.push(char::REPLACEMENT_CHARACTER),
                (None, _) => {}
            }
            if (0xD800..0xDC00).contains(&unit) {
                high = Some(unit);
            } else {
                out.push(char::from_u32(unit).unwrap_or(char::REPLACEMENT_CHARACTER));
            }
            continue;
        }
        if high.take().is_some() {
            out.push(char::REPLACEMENT_CHARACTER);
        }
        out.push(match code {
            b'b' => '\u{8}',
            b'f' => '\u{c}',
            b'n' => '\n',
            b'r' => '\r',
            b't' => '\t',
            other => char::from(other),
        });
    }
    if high.is_some() {
        out.push(char::REPLACEMENT_CHARACTER);
    }
    out.push_str(rest);
    out
}

/// A text with its quotes and escapes.
pub(super) fn quoted(text: &str) -> String {
    use core::fmt::Write;
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c < ' ' => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// Replacements in a text, each of a range of its bytes.
#[derive(Clone, Default)]
pub(super) struct Edits {
    list: Vec<(Range<usize>, String)>,
}

impl Edits {
    pub(super) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
    /// Replaces a value.
    pub(super) fn replace(&mut self, value: Value<'_>, by: impl Into<String>) {
        self.list.push((value.span(), by.into()));
    }
    /// Replaces what stands in a range.
    pub(super) fn replace_span(&mut self, span: Range<usize>, by: String) {
        self.list.push((span, by));
    }
    /// Makes those of another, too.
    pub(super) fn join(&mut self, other: Self) {
        self.list.extend(other.list);
    }
    /// Adds values at the end of a list, laid out as those before them.
    pub(super) fn append(&mut self, list: Value<'_>, values: &[String]) {
        if let Some(last) = list.items().last() {
            let blank = blank_before(list, last.span().start);
            let end = last.span().end;
            let added = values.iter().map(|value| format!(",{blank}{value}"));
            self.list.push((end..end, added.collect()));
        } else {
            let at = list.span().start + 1;
            self.list.push((at..at, values.join(",")));
        }
    }
    /// Adds a key that the table has not, with its value.
    pub(super) fn insert(&mut self, table: Value<'_>, key: &str, value: &str) {
        let entry = format!("{}:{value}", quoted(key));
        let mut parts: Vec<Value<'_>> = table.parts().collect();
        match (parts.pop(), parts.pop()) {
            (Some(last), Some(last_key)) => {
                let blank = blank_before(table, last_key.span().start);
                let end = last.span().end;
                self.list.push((end..end, format!(",{blank}{entry}")));
            }
            _ => {
                let at = table.span().start + 1;
                self.list.push((at..at, entry));
            }
        }
    }
    /// The bytes of `text` in `span` with the replacements made that lie in it.
    pub(super) fn apply(&self, text: &str, span: Range<usize>) -> String {
        let mut list: Vec<&(Range<usize>, String)> = self
            .list
            .iter()
            .filter(|(range, _)| span.start <= range.start && range.end <= span.end)
            .collect();
        list.sort_by_key(|(range, _)| range.start);
        let mut out = String::with_capacity(span.len() + 64);
        let mut copied = span.start;
        for (range, by) in list {
            out.push_str(&text[copied..range.start]);
            out.push_str(by);
            copied = range.end;
        }
        out.push_str(&text[copied..span.end]);
        out
    }
}

/// The blank between what comes before and a part of a list or table.
fn blank_before(holder: Value<'_>, at: usize) -> &str {
    let before = &holder.json.text[holder.span().start..at];
    &before[before.trim_end_matches([' ', '\t', '\n', '\r']).len()..]
}

/// A table with some keys given other values, or none; what it held otherwise stays as written.
pub(super) fn rebuilt(table: Value<'_>, changes: &[(&str, Option<String>)]) -> String {
    let mut entries: Vec<String> = Vec::new();
    let mut done = vec![false; changes.len()];
    for (key, value) in table.entries() {
        match changes.iter().position(|(changed, _)| *changed == key) {
            Some(which) => {
                if let (Some(new), false) = (&changes[which].1, done[which]) {
                    entries.push(format!("{}:{new}", quoted(&key)));
                }
                done[which] = true;
            }
            None => entries.push(format!("{}:{}", quoted(&key), value.raw())),
        }
    }
    for ((key, value), done) in changes.iter().zip(done) {
        if let (Some(value), false) = (value, done) {
            entries.push(format!("{}:{value}", quoted(key)));
        }
    }
    format!("{{{}}}", entries.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Json, ReadError> {
        Json::read(text.as_bytes().to_vec())
    }

    #[test]
    fn values_are_found_where_they_stand() {
        let json = read(
            " {\"a\": [1, 2.50, {\"b\":\"\\u0041\\n\\ud83d\\ude00\"}], \"c\":true, \"e\":{}, \"f\":[]} ",
        )
        .unwrap();
        let root = json.root();
        let a: Vec<_> = root.get("a").unwrap().items().collect();
        assert_eq!(a.len(), 3);
        assert_eq!(
            (a[0].whole(), a[1].raw(), a[1].whole()),
            (Some(1), "2.50", None)
        );
        assert_eq!(a[2].get("b").unwrap().text().unwrap(), "A\n\u{1F600}");
        assert!(root.get("c").unwrap().is_true());
        assert_eq!(root.get("e").unwrap().entries().count(), 0);
        assert_eq!(root.get("f").unwrap().items().count(), 0);
        assert!(root.get("b").is_none());
    }

    #[test]
    fn what_serde_json_refuses_is_refused() {
        let texts = [
            "",
            "{",
            "[1,]",
            "{\"a\":1,}",
            "{\"a\"}",
            "[01]",
            "[1.]",
            "[.5]",
            "[+1]",
            "[1e]",
            "tru",
            "nul",
            "\"a",
            "\"\\x\"",
            "\"\\u12g4\"",
            "\"a\nb\"",
            "[1 2]",
            "{1:2}",
            "[}",
            "{]",
            "1 1",
            "[-]",
            "{\"a\":}",
            "[",
            "]",
            "{\"a\":1]",
            "[1}",
            "[[],]",
            "[,]",
            "{,}",
        ];
        let sound = [
            "[]",
            "{}",
            "[[],[{}]]",
            "{\"a\":[]}",
            "-0.5e-7",
            "[1e+5,0]",
            "\"\\\"\\\\\"",
            "null",
            "{\"a\":{\"b\":[[1],[]]},\"c\":{}}",
            "[{},{}]",
        ];
        for text in texts.into_iter().chain(sound) {
            assert_eq!(
                read(text).is_ok(),
                serde_json::from_str::<serde_json::Value>(text).is_ok(),
                "{text}"
            );
        }
        let error = read("{\n \"a\": ?}").err().unwrap();
        assert_eq!((error.line, error.column), (Some(2), Some(7)));
    }

    #[test]
    fn nesting_of_any_depth_needs_no_stack() {
        let deep = "[".repeat(300_000) + &"]".repeat(300_000);
        assert!(read(&deep).is_ok());
        assert!(read(&"{\"a\":".repeat(300_000)).is_err());
    }

    #[test]
    fn edits_keep_what_they_do_not_touch() {
        let json = read("{ \"a\" : [ 1,\n  2 ], \"b\":{}, \"c\": [] }").unwrap();
        let root = json.root();
        let mut edits = Edits::default();
        edits.append(root.get("a").unwrap(), &["3".into(), "4".into()]);
        edits.replace(root.get("a").unwrap().items().next().unwrap(), "7");
        edits.insert(root.get("b").unwrap(), "x\"", "5");
        edits.append(root.get("c").unwrap(), &["6".into()]);
        edits.insert(root, "d", "8");
        assert_eq!(
            edits.apply(&json.text, 0..json.text.len()),
            "{ \"a\" : [ 7,\n  2,\n  3,\n  4 ], \"b\":{\"x\\\"\":5}, \"c\": [6], \"d\":8 }"
        );
        assert_eq!(
            rebuilt(
                root,
                &[
                    ("b", None),
                    ("c", Some("0".into())),
                    ("z", Some("1".into()))
                ]
            ),
            "{\"a\":[ 1,\n  2 ],\"c\":0,\"z\":1}"
        );
    }
}
