//! The header of a PLY file: which elements follow, and what each consists of.

use super::scalar::{Order, Scalar};
use crate::text::{self, excerpt};
use crate::{ReadError, ReadErrorKind};
use core::ops::Range;

/// How the numbers behind the header are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Binary(Order),
}

/// What a property holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

#[derive(Debug, Clone)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

#[derive(Debug, Clone)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// Where its line begins.
    pub(super) at: usize,
}

impl Element {
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|p| p.name == name)
    }
    /// The scalar property of this name, and its type.
    pub(super) fn scalar(&self, name: &str) -> Option<(usize, Scalar)> {
        let at = self.find(name)?;
        match self.properties[at].kind {
            Kind::Scalar(scalar) => Some((at, scalar)),
            Kind::List { .. } => None,
        }
    }
    /// The list property of this name, and the type of its items.
    pub(super) fn list(&self, name: &str) -> Option<(usize, Scalar)> {
        let at = self.find(name)?;
        match self.properties[at].kind {
            Kind::List { item, .. } => Some((at, item)),
            Kind::Scalar(_) => None,
        }
    }
    /// The smallest number of bytes that a binary row takes.
    pub(super) fn least_bytes(&self) -> usize {
        self.properties
            .iter()
            .map(|p| match p.kind {
                Kind::Scalar(scalar) => scalar.size(),
                Kind::List { count, .. } => count.size(),
            })
            .sum()
    }
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Where the numbers begin.
    pub(super) end: usize,
}

fn bad(bytes: &[u8], at: usize, what: impl Into<String>, mend: impl Into<String>) -> ReadError {
    ReadError::new(ReadErrorKind::Header, what, mend).at(bytes, at)
}

/// The line that begins at `at`, without its end, and where the next begins; `None` if it does not end. Where `carriage`
/// is set, lines end in a carriage return alone.
fn line(bytes: &[u8], at: usize, carriage: bool) -> Option<(Range<usize>, usize)> {
    let rest = bytes.get(at..)?;
    let feed = if carriage { b'\r' } else { b'\n' };
    let found = at + memchr::memchr(feed, rest)?;
    let end = if !carriage && found > at && bytes[found - 1] == b'\r' {
        found - 1
    } else {
        found
    };
    Some((at..end, found + 1))
}

/// Whether the beginning of a file is that of a PLY file, and where its first line ends.
pub(super) fn magic(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(text::BYTE_ORDER_MARK).unwrap_or(bytes);
    bytes
        .strip_prefix(b"ply")
        .and_then(<[u8]>::first)
        .is_some_and(|b| matches!(b, b'\n' | b'\r' | b' ' | b'\t'))
}

pub(super) fn parse(bytes: &[u8]) -> Result<Header, ReadError> {
    if !magic(bytes) {
        let kind = if bytes.is_empty() {
            ReadErrorKind::NoPoints
        } else {
            ReadErrorKind::Header
        };
        return Err(ReadError::new(
            kind,
            "the file does not begin with a line `ply`",
            "check that it is a PLY file and was not damaged in transfer",
        ));
    }
    let start = if bytes.starts_with(text::BYTE_ORDER_MARK) {
        text::BYTE_ORDER_MARK.len()
    } else {
        0
    };
    // Old Macintosh text: the first line ends in a carriage return that no line feed follows.
    let carriage = memchr::memchr2(b'\r', b'\n', bytes)
        .is_some_and(|end| bytes[end] == b'\r' && bytes.get(end + 1) != Some(&b'\n'));
    let mut at = start;
    let (mut encoding, mut elements) = (None, Vec::<Element>::new());
    let mut first = true;
    loop {
        let Some((range, next)) = line(bytes, at, carriage) else {
            // A file may end with its header, even without a line end.
            if bytes[at..].trim_ascii_end() == b"end_header" && encoding == Some(Encoding::Ascii) {
                return finish(bytes, encoding, elements, bytes.len());
            }
            return Err(ReadError::new(
                ReadErrorKind::Truncated,
                "the header does not end",
                "check that the file is whole; a header ends with a line `end_header`",
            ));
        };
        let mut words = bytes[range.clone()]
            .split(|b| matches!(b, b' ' | b'\t' | b'\r'))
            .filter(|word| !word.is_empty());
        let keyword = words.next().unwrap_or(b"");
        match keyword {
            _ if core::mem::take(&mut first) => {}
            b"" | b"comment" | b"obj_info" => {}
            b"format" => {
                encoding = Some(format(bytes, &range, words.next(), words.next())?);
            }
            b"element" => elements.push(element(bytes, &range, words.next(), words.next())?),
            b"property" => {
                let Some(element) = elements.last_mut() else {
                    return Err(bad(
                        bytes,
                        range.start,
                        "a property stands before any element",
                        "put an `element` line before it",
                    ));
                };
                let property = property(bytes, &range, words)?;
                if element.find(&property.name).is_some() {
                    return Err(bad(
                        bytes,
                        range.start,
                        format!(
                            "the element {} has the property {} twice",
                            element.name, property.name
                        ),
                        "rename one of them",
                    ));
                }
                element.properties.push(property);
            }
            b"end_header" => return finish(bytes, encoding, elements, next),
            other => {
                return Err(bad(
                    bytes,
                    range.start,
                    format!(
                        "the header has a line that begins with \"{}\"",
                        excerpt(other)
                    ),
                    "a header consists of `format`, `comment`, `obj_info`, `element` and `property` lines, and ends with `end_header`",
                ));
            }
        }
        at = next;
    }
}

fn finish(
    bytes: &[u8],
    encoding: Option<Encoding>,
    elements: Vec<Element>,
    end: usize,
) -> Result<Header, ReadError> {
    let encoding = encoding.ok_or_else(|| {
        bad(
            bytes,
            0,
            "the header does not say how the numbers are written",
            "add a line such as `format ascii 1.0` behind the first",
        )
    })?;
    for (i, element) in elements.iter().enumerate() {
        if elements[..i].iter().any(|other| other.name == element.name) {
            return Err(bad(
                bytes,
                element.at,
                format!("there are two elements called {}", element.name),
                "rename one of them",
            ));
        }
    }
    Ok(Header {
        encoding,
        elements,
        end,
    })
}

fn format(
    bytes: &[u8],
    range: &Range<usize>,
    word: Option<&[u8]>,
    version: Option<&[u8]>,
) -> Result<Encoding, ReadError> {
    let encoding = match word {
        Some(b"ascii") => Encoding::Ascii,
        Some(b"binary_little_endian") => Encoding::Binary(Order::Little),
        Some(b"binary_big_endian") => Encoding::Binary(Order::Big),
        other => {
            return Err(bad(
                bytes,
                range.start,
                format!("the format is \"{}\"", excerpt(other.unwrap_or(b""))),
                "it must be ascii, binary_little_endian or binary_big_endian",
            ));
        }
    };
    match version {
        Some(b"1.0") | None => Ok(encoding),
        Some(other) => Err(ReadError::new(
            ReadErrorKind::Unsupported,
            format!("the version of the format is \"{}\"", excerpt(other)),
            "only version 1.0 is known; export the model as PLY 1.0",
        )
        .at(bytes, range.start)),
    }
}

fn element(
    bytes: &[u8],
    range: &Range<usize>,
    name: Option<&[u8]>,
    count: Option<&[u8]>,
) -> Result<Element, ReadError> {
    let parsed = count
        .and_then(|c| core::str::from_utf8(c).ok())
        .and_then(|c| c.parse().ok());
    let (Some(name), Some(count)) = (name, parsed) else {
        return Err(bad(
            bytes,
            range.start,
            format!(
                "\"{}\" names no element and how many there are",
                excerpt(&bytes[range.clone()])
            ),
            "write a line such as `element vertex 8`",
        ));
    };
    Ok(Element {
        name: String::from_utf8_lossy(name).into_owned(),
        count,
        properties: Vec::new(),
        at: range.start,
    })
}

fn property<'a>(
    bytes: &[u8],
    range: &Range<usize>,
    mut words: impl Iterator<Item = &'a [u8]>,
) -> Result<Property, ReadError> {
    let scalar = |word: Option<&[u8]>| {
        let word = word.unwrap_or(b"");
        Scalar::named(word).ok_or_else(|| {
            bad(
                bytes,
                range.start,
                format!("\"{}\" is not a type of number", excerpt(word)),
                "use char, uchar, short, ushort, int, uint, float or double",
            )
        })
    };
    let kind = match words.next() {
        Some(b"list") => Kind::List {
            count: scalar(words.next())?,
            item: scalar(words.next())?,
        },
        word => Kind::Scalar(scalar(word)?),
    };
    let name = words.next().ok_or_else(|| {
        bad(
            bytes,
            range.start,
            "a property has no name",
            "write a line such as `property float x`",
        )
    })?;
    Ok(Property {
        name: String::from_utf8_lossy(name).into_owned(),
        kind,
    })
}
