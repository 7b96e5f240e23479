//! Where the numbers of each element stand.
//!
//! Rows of a binary element without lists are equally long. So are, in most files, those with lists: all faces are
//! triangles. This is tried first, so that such elements are reached by stride; else rows are walked one by one.

use super::header::{Element, Encoding, Header, Kind};
use super::lists::{self, Lists};
use super::scalar::{Order, Scalar};
use crate::text::{self, excerpt};
use crate::{ReadError, ReadErrorKind, number};
use core::ops::Range;

/// Where a property stands, from the beginning of its row: a scalar, or the items of a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Spot {
    pub(super) start: usize,
    pub(super) end: usize,
    /// Items of a list; 1 for a scalar.
    pub(super) count: usize,
}

/// How the rows of an element lie.
#[derive(Debug)]
pub(super) enum Rows {
    /// All alike, one every `stride` bytes.
    Even { stride: usize, spots: Vec<Spot> },
    /// Binary rows of different lengths.
    Uneven,
    /// Lines of text; where `wrapped` is set, numbers are parted by any blanks and line ends.
    Text { wrapped: bool },
}

/// The rows of one element.
#[derive(Debug)]
pub(super) struct Section {
    pub(super) range: Range<usize>,
    pub(super) rows: Rows,
    /// Whether the walk over the rows has seen that, as faces or strips, they are in order. Where it is not set, they may
    /// still be.
    pub(super) sound: bool,
}

/// One row.
pub(super) struct Row<'a> {
    bytes: &'a [u8],
    encoding: Encoding,
    pub(super) base: usize,
    spots: &'a [Spot],
}

impl Row<'_> {
    /// Bytes of a property in the file.
    #[inline]
    pub(super) fn range(&self, property: usize) -> Range<usize> {
        let spot = self.spots[property];
        self.base + spot.start..self.base + spot.end
    }
    /// The value of a scalar property.
    #[inline]
    pub(super) fn scalar(&self, property: usize, scalar: Scalar) -> f64 {
        let bytes = &self.bytes[self.range(property)];
        match self.encoding {
            Encoding::Binary(order) => scalar.read(bytes, order),
            Encoding::Ascii => number::parse(bytes).unwrap_or(f64::NAN),
        }
    }
    /// How many items a list has.
    #[inline]
    pub(super) fn count(&self, property: usize) -> usize {
        self.spots[property].count
    }
    /// The items of a list.
    pub(super) fn items(&self, property: usize, item: Scalar) -> impl Iterator<Item = f64> {
        let bytes = &self.bytes[self.range(property)];
        let mut left = self.count(property);
        let (mut at, encoding) = (0, self.encoding);
        core::iter::from_fn(move || {
            left = left.checked_sub(1)?;
            match encoding {
                Encoding::Binary(order) => {
                    let value = item.read(&bytes[at..], order);
                    at += item.size();
                    Some(value)
                }
                Encoding::Ascii => {
                    let token = token(bytes, &mut at, bytes.len(), true)?;
                    number::parse(&bytes[token])
                }
            }
        })
    }
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0x0b | 0x0c)
}
fn is_feed(byte: u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

/// The next token before `end`, on this line or, with `across`, on any.
#[inline]
fn token(bytes: &[u8], at: &mut usize, end: usize, across: bool) -> Option<Range<usize>> {
    while *at < end && (is_blank(bytes[*at]) || across && is_feed(bytes[*at])) {
        *at += 1;
    }
    let start = *at;
    while *at < end && !is_blank(bytes[*at]) && !is_feed(bytes[*at]) {
        *at += 1;
    }
    (*at > start).then_some(start..*at)
}

/// Goes to the first token of the next line that has one and is no comment.
fn next_line(bytes: &[u8], at: &mut usize) {
    loop {
        while *at < bytes.len() && (is_blank(bytes[*at]) || is_feed(bytes[*at])) {
            *at += 1;
        }
        let mut probe = *at;
        match token(bytes, &mut probe, bytes.len(), false) {
            Some(word) if matches!(&bytes[word.clone()], b"comment" | b"obj_info") => {
                *at = memchr::memchr2(b'\n', b'\r', &bytes[*at..])
                    .map_or(bytes.len(), |end| *at + end);
            }
            _ => return,
        }
    }
}

/// What an error calls a row.
fn row_name(element: &Element, row: usize) -> String {
    format!("{} {}", element.name, row + 1)
}

/// The places of all elements. Indices of vertices are in order below `vertices`.
pub(super) fn measure(
    bytes: &[u8],
    header: &Header,
    vertices: u64,
) -> Result<Vec<Section>, ReadError> {
    match header.encoding {
        Encoding::Binary(order) => binary(bytes, header, order, vertices),
        Encoding::Ascii => match lines(bytes, header, false) {
            Err(error) if error.kind == ReadErrorKind::Shape => {
                // Some writers break lines where they like.
                match lines(bytes, header, true) {
                    Ok(sections) if ends(bytes, &sections) => Ok(sections),
                    _ => Err(error),
                }
            }
            result => result,
        },
    }
}

/// Whether nothing follows the last section.
fn ends(bytes: &[u8], sections: &[Section]) -> bool {
    let end = sections.last().map_or(bytes.len(), |s| s.range.end);
    bytes[end..].trim_ascii().is_empty()
}

fn lines(bytes: &[u8], header: &Header, wrapped: bool) -> Result<Vec<Section>, ReadError> {
    let mut at = header.end;
    let mut sections = Vec::with_capacity(header.elements.len());
    for element in &header.elements {
        let start = at;
        let least = (element.properties.len() as u64).saturating_mul(element.count);
        let room = (bytes.len() - at) as u64 / 2 + 1;
        if least > room {
            return Err(too_few(bytes, element, least, room, "numbers"));
        }
        at = match text_rows(bytes, at, element, wrapped, &mut |_, _| {
            Ok::<(), core::convert::Infallible>(())
        }) {
            Ok(end) => end?,
            Err(never) => match never {},
        };
        sections.push(Section {
            range: start..at,
            rows: Rows::Text { wrapped },
            sound: false,
        });
    }
    Ok(sections)
}

/// More is announced than there can be.
fn too_few(bytes: &[u8], element: &Element, least: u64, room: u64, what: &str) -> ReadError {
    ReadError::new(
        ReadErrorKind::Truncated,
        format!(
            "the header announces {} rows of the element {}, which take at least {least} {what}, but there is room for {room}",
            element.count, element.name
        ),
        "the file is cut off, or the count is wrong: correct it or get the whole file",
    )
    .at(bytes, element.at)
}

/// Visits the rows of an element in text that begins at `at`; the result is where they end.
fn text_rows<E>(
    bytes: &[u8],
    mut at: usize,
    element: &Element,
    wrapped: bool,
    visit: &mut impl FnMut(usize, &Row<'_>) -> Result<(), E>,
) -> Result<Result<usize, ReadError>, E> {
    if element.properties.is_empty() {
        return Ok(Ok(at));
    }
    let mut spots = Vec::with_capacity(element.properties.len());
    for index in 0..element.count as usize {
        next_line(bytes, &mut at);
        let base = at;
        spots.clear();
        if let Err(error) = text_row(bytes, &mut at, element, index, wrapped, &mut spots) {
            return Ok(Err(error));
        }
        let row = Row {
            bytes,
            encoding: Encoding::Ascii,
            base,
            spots: &spots,
        };
        visit(index, &row)?;
    }
    Ok(Ok(at))
}

fn text_row(
    bytes: &[u8],
    at: &mut usize,
    element: &Element,
    index: usize,
    wrapped: bool,
    spots: &mut Vec<Spot>,
) -> Result<(), ReadError> {
    let base = *at;
    let next = |at: &mut usize, name: &str| {
        let Some(token) = token(bytes, at, bytes.len(), wrapped) else {
            let (kind, what, mend) = if bytes[*at..].trim_ascii().is_empty() {
                (
                    ReadErrorKind::Truncated,
                    format!(
                        "the file ends within {} of {}",
                        row_name(element, index),
                        element.count
                    ),
                    "the file is cut off, or the count in the header is wrong",
                )
            } else {
                (
                    ReadErrorKind::Shape,
                    format!("{} has no value for {name}", row_name(element, index)),
                    "give each row the numbers that the header says, on a line of its own",
                )
            };
            return Err(ReadError::new(kind, what, mend).at(bytes, *at));
        };
        match number::parse(&bytes[token.clone()]) {
            Some(value) => Ok((token, value)),
            None => Err(ReadError::new(
                ReadErrorKind::Number,
                format!(
                    "{name} of {} is \"{}\", which is not a number",
                    row_name(element, index),
                    excerpt(&bytes[token.clone()])
                ),
                "write a number such as -1.5",
            )
            .at(bytes, token.start)),
        }
    };
    for property in &element.properties {
        let (token, value) = next(at, &property.name)?;
        let spot = match property.kind {
            Kind::Scalar(_) => Spot {
                start: token.start - base,
                end: token.end - base,
                count: 1,
            },
            Kind::List { .. } => {
                let room = (bytes.len() - *at) as u64 / 2;
                let count = list_count(value, room).map_err(|what| {
                    let what = format!("{} of {} {what}", property.name, row_name(element, index));
                    ReadError::new(
                        ReadErrorKind::Element,
                        what,
                        "begin a list with the number of its items",
                    )
                    .at(bytes, token.start)
                })?;
                let (mut start, mut end) = (*at, *at);
                for i in 0..count {
                    let (token, _) = next(at, &property.name)?;
                    if i == 0 {
                        start = token.start;
                    }
                    end = token.end;
                }
                Spot {
                    start: start - base,
                    end: end - base,
                    count,
                }
            }
        };
        spots.push(spot);
    }
    let mut probe = *at;
    if !wrapped && let Some(more) = token(bytes, &mut probe, bytes.len(), false) {
        return Err(ReadError::new(
            ReadErrorKind::Shape,
            format!(
                "{} has more numbers than its header says",
                row_name(element, index)
            ),
            "correct the list's count or the header, and give each row a line of its own",
        )
        .at(bytes, more.start));
    }
    Ok(())
}

/// The number of items of a list, if there can be as many.
fn list_count(value: f64, room: u64) -> Result<usize, String> {
    if value.trunc() != value || value.is_nan() || value < 0.0 {
        Err(format!("is a list with {value} items"))
    } else if value > room as f64 {
        Err(format!(
            "is a list with {value} items, but there is room for {room}"
        ))
    } else {
        Ok(value as usize)
    }
}

fn binary(
    bytes: &[u8],
    header: &Header,
    order: Order,
    vertices: u64,
) -> Result<Vec<Section>, ReadError> {
    let limit = vertices.min(1 << 31) as u32;
    let mut at = header.end;
    let mut sections = Vec::with_capacity(header.elements.len());
    for element in &header.elements {
        let left = bytes.len() - at;
        let stride = element.least_bytes();
        let least = (stride as u64).saturating_mul(element.count);
        if least > left as u64 {
            return Err(too_few(bytes, element, least, left as u64, "bytes"));
        }
        let start = at;
        if element.count > 0
            && lists::fits(element)
            && let Some(found) = lists::walk(&bytes[at..], element.count as usize, order, limit)
        {
            at += found.length;
            sections.push(Section {
                range: start..at,
                rows: of_lists(found),
                sound: found.sound,
            });
            continue;
        }
        let rows = match even(bytes, at, element, order) {
            Some(rows) => {
                if let Rows::Even { stride, .. } = rows {
                    at += stride * element.count as usize;
                }
                rows
            }
            None => {
                at = match binary_rows(bytes, at, element, order, &mut |_, _| {
                    Ok::<(), core::convert::Infallible>(())
                }) {
                    Ok(end) => end?,
                    Err(never) => match never {},
                };
                Rows::Uneven
            }
        };
        sections.push(Section {
            range: start..at,
            rows,
            sound: false,
        });
    }
    Ok(sections)
}

/// How the rows of an element of one list counted by a byte lie.
fn of_lists(found: Lists) -> Rows {
    let Some(count) = found.alike else {
        return Rows::Uneven;
    };
    let end = 1 + 4 * count;
    Rows::Even {
        stride: end,
        spots: vec![Spot {
            start: 1,
            end,
            count,
        }],
    }
}

/// Rows compared together.
const RUN: usize = 1 << 16;

/// The rows of a binary element if all are alike.
fn even(bytes: &[u8], at: usize, element: &Element, order: Order) -> Option<Rows> {
    let mut spots = Vec::with_capacity(element.properties.len());
    if element.count == 0 || element.properties.is_empty() {
        return Some(Rows::Even { stride: 0, spots });
    }
    let mut end = at;
    binary_row(bytes, &mut end, element, 0, order, &mut spots).ok()?;
    let stride = end - at;
    let whole = bytes.get(at..at.checked_add(stride.checked_mul(element.count as usize)?)?)?;
    let counts: Vec<Range<usize>> = element
        .properties
        .iter()
        .zip(&spots)
        .filter_map(|(property, spot)| match property.kind {
            Kind::Scalar(_) => None,
            Kind::List { count, .. } => Some(spot.start - count.size()..spot.start),
        })
        .collect();
    if counts.is_empty() {
        return Some(Rows::Even { stride, spots });
    }
    let alike = |row: &[u8]| match counts.as_slice() {
        [only] if only.len() == 1 => row[only.start] == whole[only.start],
        all => all
            .iter()
            .all(|count| row[count.clone()] == whole[count.clone()]),
    };
    let runs: Vec<&[u8]> = whole.chunks(stride * RUN).collect();
    let all = text::map(&runs, |run| run.chunks_exact(stride).all(alike));
    all.iter()
        .all(|alike| *alike)
        .then_some(Rows::Even { stride, spots })
}

/// Visits the rows of a binary element that begins at `at`; the result is where they end.
fn binary_rows<E>(
    bytes: &[u8],
    mut at: usize,
    element: &Element,
    order: Order,
    visit: &mut impl FnMut(usize, &Row<'_>) -> Result<(), E>,
) -> Result<Result<usize, ReadError>, E> {
    let mut spots = Vec::with_capacity(element.properties.len());
    for index in 0..element.count as usize {
        let base = at;
        spots.clear();
        if let Err(error) = binary_row(bytes, &mut at, element, index, order, &mut spots) {
            return Ok(Err(error));
        }
        let row = Row {
            bytes,
            encoding: Encoding::Binary(order),
            base,
            spots: &spots,
        };
        visit(index, &row)?;
    }
    Ok(Ok(at))
}

fn binary_row(
    bytes: &[u8],
    at: &mut usize,
    element: &Element,
    index: usize,
    order: Order,
    spots: &mut Vec<Spot>,
) -> Result<(), ReadError> {
    let base = *at;
    let take = |at: &mut usize, size: usize| {
        let start = *at;
        match bytes.len() - start >= size {
            true => {
                *at += size;
                Ok(start)
            }
            false => Err(ReadError::new(
                ReadErrorKind::Truncated,
                format!(
                    "the file ends within {} of {}, at byte {}",
                    row_name(element, index),
                    element.count,
                    bytes.len()
                ),
                "the file is cut off, or a count in it is wrong: get the whole file",
            )),
        }
    };
    for property in &element.properties {
        let spot = match property.kind {
            Kind::Scalar(scalar) => {
                let start = take(at, scalar.size())?;
                Spot {
                    start: start - base,
                    end: *at - base,
                    count: 1,
                }
            }
            Kind::List { count, item } => {
                let start = take(at, count.size())?;
                let value = count.read(&bytes[start..], order);
                let room = ((bytes.len() - *at) / item.size()) as u64;
                let count = list_count(value, room).map_err(|what| {
                    let what = format!(
                        "{} of {} (at byte {start}) {what}",
                        property.name,
                        row_name(element, index)
                    );
                    ReadError::new(
                        ReadErrorKind::Element,
                        what,
                        "the file is cut off or damaged: get it again",
                    )
                })?;
                let start = take(at, count * item.size())?;
                Spot {
                    start: start - base,
                    end: *at - base,
                    count,
                }
            }
        };
        spots.push(spot);
    }
    Ok(())
}

/// Visits the rows of a section that has been measured.
pub(super) fn each<E>(
    bytes: &[u8],
    encoding: Encoding,
    element: &Element,
    section: &Section,
    mut visit: impl FnMut(usize, &Row<'_>) -> Result<(), E>,
) -> Result<(), E> {
    let start = section.range.start;
    match (&section.rows, encoding) {
        (Rows::Even { stride, spots }, _) => {
            if !spots.is_empty() {
                for index in 0..element.count as usize {
                    let row = Row {
                        bytes,
                        encoding,
                        base: start + index * stride,
                        spots,
                    };
                    visit(index, &row)?;
                }
            }
        }
        // What has been measured can be walked again.
        (Rows::Uneven, Encoding::Binary(order)) => {
            let _ = binary_rows(bytes, start, element, order, &mut visit)?;
        }
        (Rows::Text { wrapped }, _) => {
            let _ = text_rows(bytes, start, element, *wrapped, &mut visit)?;
        }
        (Rows::Uneven, Encoding::Ascii) => {}
    }
    Ok(())
}
