//! Triangles in the text form of STL.
//!
//! Keywords may be of either case, and blanks and line ends stand anywhere between words. Names, behind `solid` and
//! `endsolid`, run to the end of their line.

use super::{Joiner, NONFINITE};
use crate::text::excerpt;
use crate::{ReadError, ReadErrorKind, ReadOptions, number};
use anamorph_core::glam::DVec3;
use core::ops::Range;

/// The places of the numbers of a triangle: its normal, then its corners.
pub(super) struct Facet {
    pub(super) places: [[Range<usize>; 3]; 4],
}

impl Facet {
    fn vector(&self, bytes: &[u8], which: usize) -> DVec3 {
        let [x, y, z] = &self.places[which];
        let value = |place: &Range<usize>| number::parse(&bytes[place.clone()]).unwrap_or(f64::NAN);
        DVec3::new(value(x), value(y), value(z))
    }
    pub(super) fn normal(&self, bytes: &[u8]) -> DVec3 {
        self.vector(bytes, 0)
    }
}

/// The triangles of a text, or the first thing wrong with it.
pub(super) struct Facets<'a> {
    bytes: &'a [u8],
    at: usize,
    count: usize,
    /// Whether a solid has begun, and whether it is over.
    open: bool,
    failed: bool,
}

impl<'a> Facets<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let marked = bytes.starts_with(crate::text::BYTE_ORDER_MARK);
        Self {
            bytes,
            at: if marked { 3 } else { 0 },
            count: 0,
            open: false,
            failed: false,
        }
    }

    fn token(&mut self) -> Option<Range<usize>> {
        let bytes = self.bytes;
        while self.at < bytes.len() && bytes[self.at].is_ascii_whitespace() {
            self.at += 1;
        }
        let start = self.at;
        while self.at < bytes.len() && !bytes[self.at].is_ascii_whitespace() {
            self.at += 1;
        }
        (self.at > start).then_some(start..self.at)
    }

    fn skip_line(&mut self) {
        let rest = &self.bytes[self.at..];
        self.at += memchr::memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
    }

    fn end(&self) -> ReadError {
        ReadError::new(
            ReadErrorKind::Truncated,
            format!(
                "the file ends within {}",
                if self.open {
                    format!("triangle {} or before `endsolid`", self.count + 1)
                } else {
                    "its first line".to_owned()
                }
            ),
            "the file is cut off: get the whole file",
        )
        .at(self.bytes, self.bytes.len())
    }

    /// Takes the words of a row.
    fn expect(&mut self, words: &[&str]) -> Result<(), ReadError> {
        for word in words {
            let token = self.token().ok_or_else(|| self.end())?;
            if !self.bytes[token.clone()].eq_ignore_ascii_case(word.as_bytes()) {
                return Err(self.wrong(&token, &format!("`{word}`")));
            }
        }
        Ok(())
    }

    fn wrong(&self, token: &Range<usize>, expected: &str) -> ReadError {
        ReadError::new(
            ReadErrorKind::Shape,
            format!(
                "triangle {} has \"{}\" where {expected} must stand",
                self.count + 1,
                excerpt(&self.bytes[token.clone()])
            ),
            "a triangle is `facet normal`, `outer loop`, three times `vertex`, `endloop` and `endfacet`",
        )
        .at(self.bytes, token.start)
    }

    fn numbers(&mut self) -> Result<[Range<usize>; 3], ReadError> {
        let mut places = [0..0, 0..0, 0..0];
        for place in &mut places {
            let token = self.token().ok_or_else(|| self.end())?;
            if number::parse(&self.bytes[token.clone()]).is_none() {
                let mut error = self.wrong(&token, "a number");
                error.kind = ReadErrorKind::Number;
                return Err(error);
            }
            *place = token;
        }
        Ok(places)
    }

    /// The next triangle; `None` where the file properly ends.
    fn facet(&mut self) -> Result<Option<Facet>, ReadError> {
        loop {
            let Some(token) = self.token() else {
                return if self.open { Err(self.end()) } else { Ok(None) };
            };
            let word = &self.bytes[token.clone()];
            if self.open && word.eq_ignore_ascii_case(b"facet") {
                break;
            }
            let begins = word.eq_ignore_ascii_case(b"solid");
            let ends = word.eq_ignore_ascii_case(b"endsolid");
            if !(self.open && ends || !self.open && begins) {
                let expected = if self.open {
                    "`facet` or `endsolid`"
                } else {
                    "`solid`"
                };
                return Err(self.wrong(&token, expected));
            }
            self.open = begins;
            self.skip_line();
        }
        self.expect(&["normal"])?;
        let normal = self.numbers()?;
        self.expect(&["outer", "loop", "vertex"])?;
        let a = self.numbers()?;
        self.expect(&["vertex"])?;
        let b = self.numbers()?;
        self.expect(&["vertex"])?;
        let c = self.numbers()?;
        self.expect(&["endloop", "endfacet"])?;
        self.count += 1;
        Ok(Some(Facet {
            places: [normal, a, b, c],
        }))
    }
}

impl Iterator for Facets<'_> {
    type Item = Result<Facet, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let facet = self.facet().transpose();
        self.failed = !matches!(facet, Some(Ok(_)));
        facet
    }
}

/// Whether a file that begins like this is text, as far as can be seen.
pub(super) fn is_text(head: &[u8]) -> bool {
    let head = &head[..head.len().min(1024)];
    head.iter()
        .all(|b| *b >= 0x20 && *b != 0x7f || b.is_ascii_whitespace())
}

/// Whether a file begins like the text form: `solid`, a name, and on a later line `facet` or `endsolid`.
pub(super) fn begins(head: &[u8]) -> bool {
    let mut text = Facets::new(head);
    let word = |text: &mut Facets<'_>, words: &[&str]| {
        text.token().is_some_and(|token| {
            let word = &head[token];
            words
                .iter()
                .any(|w| word.eq_ignore_ascii_case(w.as_bytes()))
        })
    };
    if !word(&mut text, &["solid"]) {
        return false;
    }
    text.skip_line();
    word(&mut text, &["facet", "endsolid"])
}

/// The triangles of a text.
pub(super) fn read(
    bytes: &[u8],
    joiner: &mut Joiner,
    options: &ReadOptions,
) -> Result<Vec<[u32; 3]>, ReadError> {
    let mut corners = Vec::new();
    for (f, facet) in Facets::new(bytes).enumerate() {
        let facet = facet?;
        let places = [1, 2, 3].map(|which| facet.vector(bytes, which));
        if !options.allow_nonfinite
            && let Some(corner) = places.iter().position(|p| !p.is_finite())
        {
            return Err(ReadError::new(
                ReadErrorKind::NonFinite,
                format!(
                    "corner {} of triangle {} has a coordinate that is not finite",
                    corner + 1,
                    f + 1
                ),
                NONFINITE,
            )
            .at(bytes, facet.places[corner + 1][0].start));
        }
        corners.push(places.map(|place| joiner.point(place)));
    }
    Ok(corners)
}

/// The stored normals.
pub(super) fn normals(bytes: &[u8]) -> Vec<DVec3> {
    let facets = Facets::new(bytes).map_while(Result::ok);
    facets.map(|facet| facet.normal(bytes)).collect()
}
