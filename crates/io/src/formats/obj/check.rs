//! The first thing wrong with an OBJ text, found by a second, careful pass once scanning has seen that something is.

use super::scan::{Keyword, Reference, Statement, Statements, Tokens, resolve};
use super::{Counts, MOST, fewest};
use crate::text::{encoding_error, excerpt};
use crate::{ReadError, ReadErrorKind, ReadOptions};

/// The first error in file order that `options` do not let pass; errors about the file as a whole come first when they
/// explain the others, and last when they do not. `totals` are the counts of the whole file.
pub(super) fn first_error(
    bytes: &[u8],
    start: usize,
    totals: Counts,
    options: &ReadOptions,
) -> Result<(), ReadError> {
    if let Some(error) = encoding_error(bytes, "OBJ") {
        return Err(error);
    }
    if memchr::memchr(b'\n', bytes).is_none()
        && memchr::memchr(b'\r', bytes.trim_ascii_end()).is_some()
    {
        return Err(ReadError::new(
            ReadErrorKind::Encoding,
            "the lines end in carriage returns alone, as on old Macintosh systems",
            "convert the line ends to line feeds",
        ));
    }
    if totals.vertices > MOST || totals.normals > MOST {
        return Err(ReadError::new(
            ReadErrorKind::TooLarge,
            format!(
                "the file has {} vertices and {} normals",
                totals.vertices, totals.normals
            ),
            format!("split it into parts of at most {MOST} of each"),
        ));
    }
    let mut before = Counts::default();
    for statement in Statements::new(bytes, start..bytes.len()) {
        match statement.keyword {
            Keyword::Vertex => vertex(bytes, &statement, before, options)?,
            Keyword::Face | Keyword::Line | Keyword::Point if !options.allow_broken_elements => {
                element(bytes, &statement, before, totals)?;
            }
            _ => {}
        }
        before.count(statement.keyword);
    }
    if totals.vertices == 0 {
        return Err(ReadError::new(
            ReadErrorKind::NoPoints,
            if bytes.is_empty() {
                "the file is empty"
            } else {
                "the file has no vertices"
            },
            "give an OBJ file with lines such as `v 0 0 0`",
        ));
    }
    Ok(())
}

fn vertex(
    bytes: &[u8],
    statement: &Statement,
    before: Counts,
    options: &ReadOptions,
) -> Result<(), ReadError> {
    let number = before.vertices + 1;
    let mut tokens = Tokens::of(bytes, statement);
    for (found, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let Some((value, token)) = tokens.number() else {
            return Err(ReadError::new(
                ReadErrorKind::Shape,
                format!("vertex {number} has {found} coordinates and needs 3"),
                "write its x, y and z behind the v",
            )
            .at(bytes, statement.start));
        };
        let shown = excerpt(&bytes[token.clone()]);
        let error = match value {
            None => ReadError::new(
                ReadErrorKind::Number,
                format!(
                    "the {axis} coordinate of vertex {number} is \"{shown}\", which is not a number"
                ),
                if shown.contains(',') {
                    "write a decimal point, not a comma"
                } else {
                    "write a number such as -1.5"
                },
            ),
            Some(value) if !value.is_finite() && !options.allow_nonfinite => ReadError::new(
                ReadErrorKind::NonFinite,
                format!(
                    "the {axis} coordinate of vertex {number} is \"{shown}\", which is not finite"
                ),
                "correct it, or pass such points through untouched with --allow-nonfinite",
            ),
            Some(_) => continue,
        };
        return Err(error.at(bytes, token.start));
    }
    Ok(())
}

/// What messages call an element.
pub(super) fn element_name(keyword: Keyword) -> &'static str {
    match keyword {
        Keyword::Face => "face",
        Keyword::Line => "line",
        _ => "point",
    }
}

/// The first thing wrong with an element.
pub(super) fn element(
    bytes: &[u8],
    statement: &Statement,
    before: Counts,
    totals: Counts,
) -> Result<(), ReadError> {
    let (name, number) = match statement.keyword {
        Keyword::Face => ("face", before.faces + 1),
        Keyword::Line => ("line element", before.lines + 1),
        _ => ("point element", before.points + 1),
    };
    let broken = |what: String, mend: &str| ReadError::new(ReadErrorKind::Element, what, mend);
    let mut corners = 0;
    for token in Tokens::of(bytes, statement) {
        corners += 1;
        let text = &bytes[token.clone()];
        let shown = excerpt(text);
        let zero = || {
            text.split(|b| *b == b'/')
                .any(|part| !part.is_empty() && part.iter().all(|b| *b == b'0'))
        };
        let error = match Reference::parse(text) {
            Some(reference) => match resolve(reference.vertex, before.vertices) {
                Some(vertex) if vertex < totals.vertices => continue,
                Some(_) => broken(
                    format!(
                        "{name} {number} refers to vertex \"{shown}\", but the file has {} vertices",
                        totals.vertices
                    ),
                    "correct the index, or add the missing vertices",
                ),
                None => broken(
                    format!(
                        "{name} {number} refers back to vertex \"{shown}\", but only {} vertices come before it",
                        before.vertices
                    ),
                    "correct the index, or put the vertices before it",
                ),
            },
            None if zero() => broken(
                format!("{name} {number} has the index 0 in \"{shown}\""),
                "count from 1: OBJ has no index 0",
            ),
            None => broken(
                format!("{name} {number} has the corner \"{shown}\", which is no reference"),
                "write v, v/vt, v//vn or v/vt/vn with whole numbers",
            ),
        };
        return Err(error.at(bytes, token.start));
    }
    let needed = fewest(statement.keyword);
    if corners < needed {
        let counted = if corners == 1 { "corner" } else { "corners" };
        let error = broken(
            format!("{name} {number} has {corners} {counted} and needs at least {needed}"),
            "add the missing corners, or remove the statement",
        );
        return Err(error.at(bytes, statement.start));
    }
    Ok(())
}
