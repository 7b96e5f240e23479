//! Points as a table: delimited text whose header names the columns `x`, `y` and perhaps `z`.
//!
//! *Source*: Y. Shafranovich, *Common Format and MIME Type for Comma-Separated Values (CSV) Files*, RFC 4180, IETF 2005.
//! Beyond it: semicolons, tabs and bars are told from commas by the header; coordinates are found by name, in any case,
//! order and place; blank lines pass; text behind a closing quote belongs to the field. With `z` the points lie in space,
//! without in the plane. Every other column, quote, blank and line end is kept to the byte, and columns that hold nothing
//! but numbers are attributes. A decimal comma is refused, never guessed at.

mod create;

pub(crate) use create::create;

use crate::inspect::{Finding, First, bounds, coincident};
use crate::number;
use crate::text::{BYTE_ORDER_MARK, encoding_error, excerpt, is_wide, place};
use crate::{
    Document, Format, Inspection, Moved, Points, Problem, ProblemKind, ReadError, ReadErrorKind,
    ReadOptions, Recognition, WriteError, WriteReport,
};
use anamorph_core::glam::{DVec2, DVec3};
use core::ops::Range;
use std::collections::HashSet;
use std::io::Write;

/// The format.
pub(crate) struct Csv;

const DELIMITERS: [u8; 4] = *b",;\t|";
const AXES: [&str; 3] = ["x", "y", "z"];

fn is_blank(byte: u8) -> bool {
    byte == b' ' || byte == b'\t'
}

/// Reads records, that is rows that may run over several lines within quotes.
struct Records<'a> {
    bytes: &'a [u8],
    at: usize,
    delimiter: u8,
    /// The fields of the last record, as they stand in the file.
    fields: Vec<Range<usize>>,
}

/// A quote at this offset is not closed.
struct OpenQuote(usize);

impl<'a> Records<'a> {
    fn new(bytes: &'a [u8], delimiter: u8) -> Self {
        let at = if bytes.starts_with(BYTE_ORDER_MARK) {
            BYTE_ORDER_MARK.len()
        } else {
            0
        };
        Self {
            bytes,
            at,
            delimiter,
            fields: Vec::new(),
        }
    }

    /// Reads the next record that is not a blank line into `fields`; `false` at the end.
    fn advance(&mut self) -> Result<bool, OpenQuote> {
        while self.at < self.bytes.len() {
            self.fields.clear();
            loop {
                let start = self.at;
                let end = self.field_end(start)?;
                self.fields.push(start..end);
                self.at = end + 1;
                match self.bytes.get(end) {
                    Some(&byte) if byte == self.delimiter => {}
                    Some(b'\r') => {
                        self.at += usize::from(self.bytes.get(end + 1) == Some(&b'\n'));
                        break;
                    }
                    _ => break,
                }
            }
            let blank = self.fields.len() == 1
                && self.bytes[self.fields[0].clone()]
                    .iter()
                    .all(|b| is_blank(*b));
            if !blank {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Where the field that begins at `start` ends.
    fn field_end(&self, start: usize) -> Result<usize, OpenQuote> {
        let bytes = self.bytes;
        let mut at = start;
        while bytes
            .get(at)
            .is_some_and(|b| is_blank(*b) && *b != self.delimiter)
        {
            at += 1;
        }
        if bytes.get(at) == Some(&b'"') {
            let open = at;
            loop {
                let close = memchr::memchr(b'"', &bytes[at + 1..]).ok_or(OpenQuote(open))?;
                at += close + 2;
                if bytes.get(at) != Some(&b'"') {
                    break;
                }
            }
        }
        while bytes
            .get(at)
            .is_some_and(|b| *b != self.delimiter && *b != b'\n' && *b != b'\r')
        {
            at += 1;
        }
        Ok(at)
    }

    /// What a field of the last record says: without quotes and the blanks around.
    fn content(&self, field: usize) -> Range<usize> {
        content(self.bytes, self.fields[field].clone())
    }
}

/// The part of a field within its quotes and blanks.
fn content(bytes: &[u8], field: Range<usize>) -> Range<usize> {
    let trim = |range: Range<usize>| {
        let text = &bytes[range.clone()];
        let front = text.iter().take_while(|b| is_blank(**b)).count();
        let back = text[front..]
            .iter()
            .rev()
            .take_while(|b| is_blank(**b))
            .count();
        range.start + front..range.end - back
    };
    let outer = trim(field);
    let text = &bytes[outer.clone()];
    if text.len() >= 2 && text.starts_with(b"\"") && text.ends_with(b"\"") {
        trim(outer.start + 1..outer.end - 1)
    } else {
        outer
    }
}

/// What the first row says.
struct Header {
    delimiter: u8,
    names: Vec<String>,
    /// Columns that are called x, y and z.
    axes: [Vec<usize>; 3],
}

impl Header {
    fn parse(bytes: &[u8], delimiter: u8) -> Option<Self> {
        let mut records = Records::new(bytes, delimiter);
        if !matches!(records.advance(), Ok(true)) {
            return None;
        }
        let names: Vec<String> = (0..records.fields.len())
            .map(|i| String::from_utf8_lossy(&bytes[records.content(i)]).replace("\"\"", "\""))
            .collect();
        let axes = AXES.map(|axis| {
            (0..names.len())
                .filter(|i| names[*i].eq_ignore_ascii_case(axis))
                .collect()
        });
        Some(Self {
            delimiter,
            names,
            axes,
        })
    }

    /// The header with the delimiter that brings out the coordinates, or else most columns.
    fn detect(bytes: &[u8]) -> Option<Self> {
        let candidates = DELIMITERS
            .into_iter()
            .rev()
            .filter_map(|delimiter| Self::parse(bytes, delimiter));
        candidates.max_by_key(|header| (header.is_sufficient(), header.names.len()))
    }

    fn is_sufficient(&self) -> bool {
        !self.axes[0].is_empty() && !self.axes[1].is_empty()
    }

    fn error(&self) -> Option<ReadError> {
        let header = |what: String, mend: &str| {
            Some(ReadError {
                line: Some(1),
                ..ReadError::new(ReadErrorKind::Header, what, mend)
            })
        };
        for (axis, columns) in AXES.iter().zip(&self.axes) {
            if let [first, second, ..] = columns[..] {
                let what = format!(
                    "columns {} and {} are both called {axis}",
                    first + 1,
                    second + 1
                );
                return header(what, "rename the one that is not a coordinate");
            }
        }
        if self.is_sufficient() {
            return None;
        }
        if self
            .names
            .iter()
            .all(|name| number::parse(name.as_bytes()).is_some())
        {
            let what = "the first row holds numbers, not the names of the columns".to_string();
            return header(what, "add a first line such as x,y or x,y,z");
        }
        let missing = if self.axes[0].is_empty() { "x" } else { "y" };
        let shown = excerpt(self.names.join(", ").as_bytes());
        header(
            format!("the header has no column {missing}; its columns are: {shown}"),
            "name the columns with the coordinates x,y or x,y,z, separated by commas, semicolons or tabs",
        )
    }
}

/// The positions, with the dimension that the header gives them.
enum Positions {
    Plane(Vec<DVec2>),
    Solid(Vec<DVec3>),
}

/// A read file.
struct Table {
    bytes: Vec<u8>,
    delimiter: u8,
    names: Vec<String>,
    /// Columns of the coordinates: two or three.
    axes: Vec<usize>,
    positions: Positions,
    nonfinite: Vec<usize>,
}

impl Format for Csv {
    fn name(&self) -> &'static str {
        "csv"
    }
    fn title(&self) -> &'static str {
        "points as a table (CSV)"
    }
    fn extensions(&self) -> &'static [&'static str] {
        &["csv", "tsv"]
    }

    fn recognises(&self, head: &[u8]) -> Recognition {
        match Header::detect(head) {
            Some(header) if header.is_sufficient() => Recognition::Certain,
            _ => Recognition::No,
        }
    }

    fn read(&self, bytes: Vec<u8>, options: &ReadOptions) -> Result<Box<dyn Document>, ReadError> {
        // A zero byte is in no text, but a binary file may fail in stranger ways first.
        match read_table(&bytes, options) {
            Ok((header, axes, positions, nonfinite)) => Ok(Box::new(Table {
                delimiter: header.delimiter,
                names: header.names,
                axes,
                positions,
                nonfinite,
                bytes,
            })),
            Err(error) => Err(encoding_error(&bytes, "CSV").unwrap_or(error)),
        }
    }
}

fn open_quote(bytes: &[u8], quote: &OpenQuote) -> ReadError {
    let what = "the quote that begins here is not closed";
    ReadError::new(
        ReadErrorKind::Quote,
        what,
        "close it, or write two quotes for one",
    )
    .at(bytes, quote.0)
}

type Read = (Header, Vec<usize>, Positions, Vec<usize>);

fn read_table(bytes: &[u8], options: &ReadOptions) -> Result<Read, ReadError> {
    let nothing = |what: &str| {
        ReadError::new(
            ReadErrorKind::NoPoints,
            what,
            "give a header x,y or x,y,z and a row per point",
        )
    };
    if is_wide(bytes) {
        // Replaced by what the encoding is.
        return Err(nothing("the text is not UTF-8"));
    }
    let Some(header) = Header::detect(bytes) else {
        let mut records = Records::new(bytes, b',');
        return Err(match records.advance() {
            Err(quote) => open_quote(bytes, &quote),
            Ok(_) => nothing("the file is empty"),
        });
    };
    if let Some(mut error) = header.error() {
        // Blank lines may stand above it.
        let blank = bytes
            .iter()
            .position(|b| !b.is_ascii_whitespace())
            .unwrap_or(0);
        error.line = Some(place(bytes, blank).0);
        return Err(error);
    }
    let axes: Vec<usize> = header
        .axes
        .iter()
        .filter_map(|columns| columns.first().copied())
        .collect();

    let mut records = Records::new(bytes, header.delimiter);
    let mut positions = if axes.len() == 2 {
        Positions::Plane(Vec::new())
    } else {
        Positions::Solid(Vec::new())
    };
    let mut nonfinite = Vec::new();
    let mut point = 0;
    let mut in_header = true;
    while records
        .advance()
        .map_err(|quote| open_quote(bytes, &quote))?
    {
        if core::mem::take(&mut in_header) {
            continue;
        }
        if records.fields.len() != header.names.len() {
            let (got, expected) = (records.fields.len(), header.names.len());
            let what = format!(
                "the row of point {} has {got} fields, but the header has {expected}",
                point + 1
            );
            let mend = "add the missing fields, or quote a field that contains the delimiter";
            return Err(
                ReadError::new(ReadErrorKind::Shape, what, mend).at(bytes, records.fields[0].start)
            );
        }
        let mut coordinates = [0.0; 3];
        for (axis, &column) in axes.iter().enumerate() {
            let content = records.content(column);
            coordinates[axis] = match number::parse(&bytes[content.clone()]) {
                Some(value) if value.is_finite() || options.allow_nonfinite => value,
                value => {
                    return Err(bad_number(
                        bytes,
                        content,
                        AXES[axis],
                        column,
                        point,
                        value.is_some(),
                    ));
                }
            };
        }
        let [x, y, z] = coordinates;
        if !coordinates.iter().all(|c| c.is_finite()) {
            nonfinite.push(point);
        }
        match &mut positions {
            Positions::Plane(points) => points.push(DVec2::new(x, y)),
            Positions::Solid(points) => points.push(DVec3::new(x, y, z)),
        }
        point += 1;
    }
    if point == 0 {
        return Err(nothing("the table has a header but no rows"));
    }
    Ok((header, axes, positions, nonfinite))
}

fn bad_number(
    bytes: &[u8],
    content: Range<usize>,
    axis: &str,
    column: usize,
    point: usize,
    is_number: bool,
) -> ReadError {
    let shown = excerpt(&bytes[content.clone()]);
    let whose = format!(
        "the {axis} coordinate of point {} (column {})",
        point + 1,
        column + 1
    );
    let (kind, what, mend) = if is_number {
        let mend = "correct it, or pass such points through untouched with --allow-nonfinite";
        (
            ReadErrorKind::NonFinite,
            format!("{whose} is \"{shown}\", which is not finite"),
            mend,
        )
    } else if shown.is_empty() {
        (
            ReadErrorKind::Number,
            format!("{whose} is empty"),
            "write a number such as -1.5, or remove the row",
        )
    } else if shown.contains(',') {
        let mend = "write a decimal point, not a comma";
        (
            ReadErrorKind::Number,
            format!("{whose} is \"{shown}\", which is not a number"),
            mend,
        )
    } else {
        let mend = "write a number such as -1.5";
        (
            ReadErrorKind::Number,
            format!("{whose} is \"{shown}\", which is not a number"),
            mend,
        )
    };
    ReadError::new(kind, what, mend).at(bytes, content.start)
}

impl Table {
    /// Calls `visit` with each record below the header. Reading has seen that no quote is open.
    fn rows(&self, mut visit: impl FnMut(&Records<'_>)) {
        let mut records = Records::new(&self.bytes, self.delimiter);
        let mut in_header = true;
        while matches!(records.advance(), Ok(true)) {
            if !core::mem::take(&mut in_header) {
                visit(&records);
            }
        }
    }

    /// Columns besides the coordinates that have a name of their own: the first of those called the same.
    fn named_columns(&self) -> Vec<usize> {
        let mut seen = HashSet::new();
        (0..self.names.len())
            .filter(|i| !self.axes.contains(i))
            .filter(|i| !self.names[*i].is_empty() && seen.insert(&self.names[*i]))
            .collect()
    }

    /// Those of the columns that hold numbers only.
    fn numeric(&self, mut columns: Vec<usize>) -> Vec<usize> {
        self.rows(|records| {
            columns.retain(|i| number::parse(&self.bytes[records.content(*i)]).is_some());
        });
        columns
    }

    /// The first of the numeric columns with a value that is not finite, and the rows of such values.
    fn nonfinite_column(&self, columns: &[usize]) -> Option<Vec<usize>> {
        let mut found: Vec<Vec<usize>> = vec![Vec::new(); columns.len()];
        let mut row = 0;
        self.rows(|records| {
            for (rows, column) in found.iter_mut().zip(columns) {
                let value = number::parse(&self.bytes[records.content(*column)]);
                if !value.is_some_and(f64::is_finite) {
                    rows.push(row);
                }
            }
            row += 1;
        });
        found.into_iter().find(|rows| !rows.is_empty())
    }

    /// The values of a numeric column.
    fn column(&self, column: usize) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.points().len());
        self.rows(|records| {
            values.push(number::parse(&self.bytes[records.content(column)]).unwrap_or(f64::NAN));
        });
        values
    }

    /// The line of a point, counted from 0.
    fn line_of(&self, point: usize) -> Option<u64> {
        let (mut at, mut offset) = (0, None);
        self.rows(|records| {
            if at == point {
                offset = Some(records.fields[0].start);
            }
            at += 1;
        });
        offset.map(|offset| place(&self.bytes, offset).0)
    }
}

/// Bytes of new text collected before they are handed on.
const BUFFER: usize = 1 << 20;

impl Document for Table {
    fn format(&self) -> &'static str {
        Csv.name()
    }
    fn points(&self) -> Points<'_> {
        match &self.positions {
            Positions::Plane(points) => Points::Plane(points),
            Positions::Solid(points) => Points::Solid(points),
        }
    }
    fn nonfinite(&self) -> &[usize] {
        &self.nonfinite
    }
    fn attributes(&self) -> Vec<String> {
        self.numeric(self.named_columns())
            .into_iter()
            .map(|i| self.names[i].clone())
            .collect()
    }
    fn attribute(&self, name: &str) -> Option<Vec<f64>> {
        let named = self.named_columns().into_iter();
        let called = named.filter(|i| self.names[*i] == name).collect();
        let column = *self.numeric(called).first()?;
        Some(self.column(column))
    }

    fn inspect(&self) -> Inspection {
        let mut findings = Vec::new();
        let bounds = match &self.positions {
            Positions::Plane(points) => {
                coincident(points.iter().map(DVec2::to_array), &mut findings);
                bounds(points.iter().map(DVec2::to_array))
            }
            Positions::Solid(points) => {
                coincident(points.iter().map(DVec3::to_array), &mut findings);
                bounds(points.iter().map(DVec3::to_array))
            }
        };
        if let Some(&first) = self.nonfinite.first() {
            let count = self.nonfinite.len() as u64;
            findings.push(Finding {
                kind: ProblemKind::NonFinitePoint,
                count,
                first: First::Vertex(first),
            });
        }
        let columns = self.numeric(self.named_columns());
        // One report of each kind: the first such column.
        if let Some(rows) = self.nonfinite_column(&columns) {
            findings.push(Finding {
                kind: ProblemKind::NonFiniteAttribute,
                count: rows.len() as u64,
                first: First::Vertex(rows[0]),
            });
        }
        findings.sort_by_key(|finding| finding.kind);
        let problems = findings.iter().map(|finding| {
            let point = if let First::Vertex(point) = finding.first {
                point
            } else {
                0
            };
            let first = format!("point {}", point + 1);
            Problem {
                kind: finding.kind,
                count: finding.count,
                first,
                line: self.line_of(point),
            }
        });
        Inspection {
            format: self.format(),
            dimension: self.points().dimension(),
            counts: vec![
                ("points", self.points().len() as u64),
                ("columns", self.names.len() as u64),
            ],
            bounds,
            attributes: columns.iter().map(|i| self.names[*i].clone()).collect(),
            problems: problems.collect(),
        }
    }

    fn write(&self, moved: &Moved<'_>, out: &mut dyn Write) -> Result<WriteReport, WriteError> {
        self.points().check(&moved.points)?;
        let coordinates = |points: Points<'_>, point: usize| match points {
            Points::Plane(points) => [points[point].x, points[point].y, 0.0],
            Points::Solid(points) => points[point].to_array(),
        };
        let mut report = WriteReport::default();
        let mut text = Vec::with_capacity(BUFFER + BUFFER / 4);
        let (mut copied, mut point, mut failure) = (0, 0, None);
        let mut put = |text: &[u8]| {
            report.bytes += text.len() as u64;
            out.write_all(text)
        };
        self.rows(|records| {
            let (old, new) = (
                coordinates(self.points(), point),
                coordinates(moved.points, point),
            );
            point += 1;
            let moves =
                old.map(f64::to_bits) != new.map(f64::to_bits) && old.iter().all(|c| c.is_finite());
            if !moves || failure.is_some() {
                return;
            }
            report.moved_points += 1;
            // In the order of the columns, which need not be that of the axes.
            let mut axes: Vec<usize> = (0..self.axes.len()).collect();
            axes.sort_by_key(|axis| self.axes[*axis]);
            for axis in axes {
                if old[axis].to_bits() != new[axis].to_bits() {
                    let field = records.content(self.axes[axis]);
                    text.extend_from_slice(&self.bytes[copied..field.start]);
                    number::write(new[axis], &mut text);
                    copied = field.end;
                }
            }
            if text.len() >= BUFFER {
                failure = put(&text).err();
                text.clear();
            }
        });
        if let Some(failure) = failure {
            return Err(failure.into());
        }
        put(&text)?;
        put(&self.bytes[copied..])?;
        Ok(report)
    }
}
