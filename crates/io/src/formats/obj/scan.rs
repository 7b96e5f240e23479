//! Statements, tokens and references of OBJ text.
//!
//! A statement is a line, or several joined by a backslash at the end of all but the last. A comment runs from a token
//! that begins with `#` to the end of its line; a backslash at its end joins nothing, so that a path in a comment cannot
//! swallow the next line.

use crate::number;

/// What a statement is about, as far as we read it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Keyword {
    /// `v`: a vertex.
    Vertex,
    /// `vn`: a normal.
    Normal,
    /// `vt`: a texture coordinate.
    Texture,
    /// `f`: a face.
    Face,
    /// `l`: a line.
    Line,
    /// `p`: points.
    Point,
    /// Anything else, kept as it is.
    Other,
}

/// One statement: `bytes[start..end]` without its line end; its tokens after the keyword begin at `arguments`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Statement {
    pub(super) keyword: Keyword,
    pub(super) start: usize,
    pub(super) arguments: usize,
    pub(super) end: usize,
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | 0x0b | 0x0c)
}

/// Whether the line that ends at `end` (its line feed, or the end of the text) ends in a backslash.
pub(super) fn ends_in_backslash(bytes: &[u8], start: usize, end: usize) -> bool {
    bytes[start..end].iter().rev().find(|b| !is_blank(**b)) == Some(&b'\\')
}

/// Whether the line holds a comment: a `#` at its start or after a blank.
fn has_comment(line: &[u8]) -> bool {
    memchr::memchr_iter(b'#', line).any(|at| at == 0 || is_blank(line[at - 1]))
}

/// The statements of `bytes[at..end]`, which begins at the start of a statement and ends at the end of one.
pub(super) struct Statements<'a> {
    bytes: &'a [u8],
    at: usize,
    end: usize,
}

impl<'a> Statements<'a> {
    pub(super) fn new(bytes: &'a [u8], range: core::ops::Range<usize>) -> Self {
        Self {
            bytes,
            at: range.start,
            end: range.end,
        }
    }
}

impl Iterator for Statements<'_> {
    type Item = Statement;

    #[inline]
    fn next(&mut self) -> Option<Statement> {
        if self.at >= self.end {
            return None;
        }
        let bytes = &self.bytes[..self.end];
        let start = self.at;
        let mut line = start;
        let end = loop {
            let end = memchr::memchr(b'\n', &bytes[line..]).map_or(bytes.len(), |at| line + at);
            if end == bytes.len()
                || !ends_in_backslash(bytes, line, end)
                || has_comment(&bytes[line..end])
            {
                break end;
            }
            line = end + 1;
        };
        self.at = end + 1;

        let text = &bytes[..end];
        let mut at = start;
        while at < end && is_blank(text[at]) {
            at += 1;
        }
        let separated = |at: usize| at >= end || is_blank(text[at]) || text[at] == b'\\';
        let (keyword, length) = match text.get(at) {
            Some(b'v') if separated(at + 1) => (Keyword::Vertex, 1),
            Some(b'v') if separated(at + 2) && text[at + 1] == b'n' => (Keyword::Normal, 2),
            Some(b'v') if separated(at + 2) && text[at + 1] == b't' => (Keyword::Texture, 2),
            Some(b'f') if separated(at + 1) => (Keyword::Face, 1),
            Some(b'l') if separated(at + 1) => (Keyword::Line, 1),
            Some(b'p') if separated(at + 1) => (Keyword::Point, 1),
            _ => (Keyword::Other, 0),
        };
        Some(Statement {
            keyword,
            start,
            arguments: at + length,
            end,
        })
    }
}

/// The tokens of `bytes[at..end]` as ranges of `bytes`.
pub(super) struct Tokens<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Tokens<'a> {
    /// The tokens of a statement after its keyword.
    pub(super) fn of(bytes: &'a [u8], statement: &Statement) -> Self {
        Self {
            bytes: &bytes[..statement.end],
            at: statement.arguments,
        }
    }

    /// Goes to the start of the next token; `false` at the end or a comment.
    #[inline]
    fn skip(&mut self) -> bool {
        while let Some(&byte) = self.bytes.get(self.at) {
            // A line feed within a statement stands behind a backslash.
            if is_blank(byte) || byte == b'\n' || byte == b'\\' && self.joins(self.at) {
                self.at += 1;
            } else {
                return byte != b'#';
            }
        }
        false
    }

    /// Whether the backslash at `at` stands at the end of its line.
    fn joins(&self, at: usize) -> bool {
        self.bytes[at + 1..]
            .iter()
            .find(|b| !is_blank(**b))
            .is_none_or(|b| *b == b'\n')
    }

    /// The next token must be a number: its value (`None` when it is none) and its place.
    #[inline]
    pub(super) fn number(&mut self) -> Option<(Option<f64>, core::ops::Range<usize>)> {
        if !self.skip() {
            return None;
        }
        let start = self.at;
        if let Some((value, length)) = number::quick(&self.bytes[start..]) {
            let end = start + length;
            if self.bytes.get(end).is_none_or(|b| is_blank(*b)) {
                self.at = end;
                return Some((Some(value), start..end));
            }
        }
        let token = self.next()?;
        Some((number::parse(&self.bytes[token.clone()]), token))
    }
}

impl Iterator for Tokens<'_> {
    type Item = core::ops::Range<usize>;

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        if !self.skip() {
            return None;
        }
        let start = self.at;
        while let Some(&byte) = self.bytes.get(self.at) {
            if is_blank(byte) || byte == b'\n' || byte == b'\\' && self.joins(self.at) {
                break;
            }
            self.at += 1;
        }
        Some(start..self.at)
    }
}

/// A corner of a face as written: vertex, texture coordinate and normal, each from 1 upwards or −1 downwards. 0 stands
/// for one that is left out; a written 0 is no reference at all. Numbers beyond 64 bits are cut to the largest.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Reference {
    pub(super) vertex: i64,
    pub(super) texture: i64,
    pub(super) normal: i64,
    /// Where the digits of the normal begin within the token.
    pub(super) normal_at: usize,
}

impl Reference {
    /// Reads `7`, `7/8`, `7//9`, `7/8/9`, also with the last parts left empty (`7//`). `None` when malformed or 0.
    #[inline]
    pub(super) fn parse(token: &[u8]) -> Option<Reference> {
        let mut at = 0;
        let vertex = whole(token, &mut at)?;
        let mut reference = Reference {
            vertex,
            ..Reference::default()
        };
        if at == token.len() {
            return Some(reference);
        }
        for part in 0..2 {
            if token.get(at) != Some(&b'/') {
                return None;
            }
            at += 1;
            if at == token.len() {
                return Some(reference);
            }
            if part == 0 && token[at] == b'/' {
                continue;
            }
            let begin = at;
            let value = whole(token, &mut at)?;
            if part == 0 {
                reference.texture = value;
            } else {
                reference.normal = value;
                reference.normal_at = begin;
            }
            if at == token.len() {
                return Some(reference);
            }
        }
        None
    }
}

/// Reads a whole number other than 0 at `at`, and goes past it.
#[inline]
fn whole(token: &[u8], at: &mut usize) -> Option<i64> {
    let negative = match token.get(*at)? {
        b'-' => {
            *at += 1;
            true
        }
        b'+' => {
            *at += 1;
            false
        }
        _ => false,
    };
    let begin = *at;
    let mut value = 0i64;
    while let Some(digit) = token
        .get(*at)
        .map(|b| b.wrapping_sub(b'0'))
        .filter(|d| *d < 10)
    {
        value = value.saturating_mul(10).saturating_add(i64::from(digit));
        *at += 1;
    }
    (*at > begin && value != 0).then_some(if negative { -value } else { value })
}

/// The index from 0 that a written reference means, `before` being how many there are above it in the file. `None` for
/// one that is left out (0) or reaches back beyond the first. Not checked against the number in the file.
#[inline]
pub(super) fn resolve(written: i64, before: u64) -> Option<u64> {
    match written {
        1.. => Some(written as u64 - 1),
        0 => None,
        _ => before.checked_sub(written.unsigned_abs()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn statements(text: &str) -> Vec<(Keyword, Vec<&str>)> {
        Statements::new(text.as_bytes(), 0..text.len())
            .map(|s| {
                (
                    s.keyword,
                    Tokens::of(text.as_bytes(), &s).map(|t| &text[t]).collect(),
                )
            })
            .collect()
    }

    #[test]
    fn lines_are_joined_by_a_backslash_but_not_in_a_comment() {
        use Keyword::{Face, Other, Vertex};
        assert_eq!(
            statements(
                "v 1 \\\r\n2\\\n 3\nf 1 2 \\  \n\\\n 3\n# C:\\dir\\\nv\t4 5 6 # tail \\\n  v 7 8 9 \\"
            ),
            [
                (Vertex, vec!["1", "2", "3"]),
                (Face, vec!["1", "2", "3"]),
                (Other, vec![]),
                (Vertex, vec!["4", "5", "6"]),
                (Vertex, vec!["7", "8", "9"]),
            ]
        );
    }

    #[test]
    fn keywords_are_whole_words() {
        use Keyword::{Line, Normal, Other, Point, Texture, Vertex};
        let keywords: Vec<_> =
            statements("vn 1\nvt 1\nvp 1\nvn\nv\nfoo\nline\nl 1\np 1\n\ng f\nv1 2 3\nV 1")
                .into_iter()
                .map(|s| s.0)
                .collect();
        assert_eq!(
            keywords,
            [
                Normal, Texture, Other, Normal, Vertex, Other, Other, Line, Point, Other, Other,
                Other, Other
            ]
        );
    }

    #[test]
    fn references() {
        let read =
            |text: &str| Reference::parse(text.as_bytes()).map(|r| (r.vertex, r.texture, r.normal));
        assert_eq!(read("7"), Some((7, 0, 0)));
        assert_eq!(read("7/8"), Some((7, 8, 0)));
        assert_eq!(read("-7//9"), Some((-7, 0, 9)));
        assert_eq!(read("7/8/-9"), Some((7, 8, -9)));
        assert_eq!(read("7//"), Some((7, 0, 0)));
        assert_eq!(read("7/8/"), Some((7, 8, 0)));
        assert_eq!(read("99999999999999999999"), Some((i64::MAX, 0, 0)));
        for bad in [
            "0", "7/0", "7//0", "a", "7/8/9/1", "7/8/9/", "/1", "7 ", "1.0", "-", "", "7///",
            "1/2x", "1x/2",
        ] {
            assert_eq!(read(bad), None, "{bad}");
        }
        assert_eq!(resolve(3, 0), Some(2));
        assert_eq!(resolve(-1, 5), Some(4));
        assert_eq!(resolve(-6, 5), None);
        assert_eq!(resolve(i64::MIN, 5), None);
    }
}
