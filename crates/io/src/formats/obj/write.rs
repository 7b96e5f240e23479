//! Writing an OBJ file with moved vertices.

use super::normals::{self, Plan};
use super::scan::{Keyword, Reference, Statement, Tokens, ends_in_backslash};
use super::{Chunk, Text};
use crate::number;
use crate::text;
use crate::{Document, Moved, Points, WriteError, WriteReport};
use anamorph_core::glam::DVec3;
use std::io::Write;

/// Chunks whose new text is in memory at a time: bounds memory, and feeds as many cores.
const IN_FLIGHT: usize = 16;

pub(super) fn write(
    text: &Text,
    moved: &Moved<'_>,
    out: &mut dyn Write,
) -> Result<WriteReport, WriteError> {
    text.points().check(&moved.points)?;
    // Checked above; in the plane there would be nothing to write.
    let new = if let Points::Solid(new) = moved.points {
        new
    } else {
        &[]
    };
    let plan = normals::plan(text, new, moved.normals);

    let mut report = WriteReport::default();
    let start = text
        .chunks
        .first()
        .map_or(text.bytes.len(), |chunk| chunk.range.start);
    report.put(&text.bytes[..start], out)?;
    for group in text.chunks.chunks(IN_FLIGHT) {
        let pieces = text::map(group, |chunk| rewritten(text, chunk, new, plan.as_ref()));
        for (chunk, piece) in group.iter().zip(pieces) {
            match piece {
                Some(piece) => {
                    report.moved_points += piece.moved_points;
                    report.changed_normals += piece.changed_normals;
                    report.put(&piece.bytes, out)?;
                }
                None => report.put(&text.bytes[chunk.range.clone()], out)?,
            }
        }
    }
    if let Some(plan) = plan {
        report.kept_normals = plan.kept;
        report.added_normals = plan.added.len();
        report.put(&appendix(&text.bytes, &plan.added), out)?;
    }
    Ok(report)
}

impl WriteReport {
    pub(crate) fn put(&mut self, bytes: &[u8], out: &mut dyn Write) -> Result<(), WriteError> {
        out.write_all(bytes)?;
        self.bytes += bytes.len() as u64;
        Ok(())
    }
}

/// The new text of a chunk.
struct Piece {
    bytes: Vec<u8>,
    moved_points: usize,
    changed_normals: usize,
}

/// Whether two vectors are the same bit for bit.
pub(super) fn same(a: DVec3, b: DVec3) -> bool {
    a.to_array().map(f64::to_bits) == b.to_array().map(f64::to_bits)
}

/// Copies a text, replacing parts of it in order.
struct Patch<'a> {
    bytes: &'a [u8],
    copied: usize,
    out: Vec<u8>,
}

impl Patch<'_> {
    /// Leaves out `bytes[from..to]`; what is pushed to `out` next stands in its place.
    fn replace(&mut self, from: usize, to: usize) -> &mut Vec<u8> {
        self.out.extend_from_slice(&self.bytes[self.copied..from]);
        self.copied = to;
        &mut self.out
    }

    /// Replaces those of the first three numbers of a statement that differ; whether any does.
    fn numbers(&mut self, statement: &Statement, old: DVec3, new: DVec3) -> bool {
        // A number that is not finite is none of ours to mend.
        if same(old, new) || !old.is_finite() {
            return false;
        }
        for (token, (old, new)) in
            Tokens::of(self.bytes, statement).zip(old.to_array().into_iter().zip(new.to_array()))
        {
            if old.to_bits() != new.to_bits() {
                number::write(new, self.replace(token.start, token.end));
            }
        }
        true
    }
}

/// The text of a chunk after the move, or `None` where it stays as it is.
fn rewritten(text: &Text, chunk: &Chunk, new: &[DVec3], plan: Option<&Plan>) -> Option<Piece> {
    let first = chunk.before.vertices as usize;
    let vertices = first..first + chunk.here.vertices as usize;
    let moves = vertices.clone().any(|v| !same(text.positions[v], new[v]));
    let plan = plan.filter(|plan| {
        chunk.here.normals > 0 || chunk.here.faces > 0 && !plan.redirected.is_empty()
    });
    if !moves && plan.is_none() {
        return None;
    }

    let mut patch = Patch {
        bytes: &text.bytes[..chunk.range.end],
        copied: chunk.range.start,
        // Full numbers are about twice as long as the usual seven digits.
        out: Vec::with_capacity(chunk.range.len() + 32 * vertices.len()),
    };
    let (mut moved_points, mut changed_normals) = (0, 0);
    let mut before = chunk.before;
    for statement in text.statements(chunk) {
        match (statement.keyword, plan) {
            (Keyword::Vertex, _) => {
                let v = before.vertices as usize;
                moved_points += usize::from(patch.numbers(&statement, text.positions[v], new[v]));
            }
            (Keyword::Normal, Some(plan)) => {
                let n = before.normals as usize;
                changed_normals += usize::from(patch.numbers(&statement, plan.old[n], plan.new[n]));
            }
            (Keyword::Face, Some(plan)) if !plan.redirected.is_empty() => {
                for token in Tokens::of(&text.bytes, &statement) {
                    let Some(reference) = Reference::parse(&text.bytes[token.clone()]) else {
                        continue;
                    };
                    let corner = text
                        .vertex(reference, before)
                        .zip(text.normal(reference, before));
                    if let Some(index) =
                        corner.and_then(|(vertex, normal)| plan.redirect(normal, vertex))
                    {
                        number::write_whole(
                            index + 1,
                            patch.replace(token.start + reference.normal_at, token.end),
                        );
                    }
                }
            }
            _ => {}
        }
        before.count(statement.keyword);
    }
    patch.replace(chunk.range.end, chunk.range.end);
    Some(Piece {
        bytes: patch.out,
        moved_points,
        changed_normals,
    })
}

/// The lines with added normals. They stand at the end of the file, where no relative index counts past them.
fn appendix(bytes: &[u8], added: &[DVec3]) -> Vec<u8> {
    let mut out = Vec::new();
    if added.is_empty() {
        return out;
    }
    let feed: &[u8] = match memchr::memchr(b'\n', bytes) {
        Some(at) if at > 0 && bytes[at - 1] == b'\r' => b"\r\n",
        _ => b"\n",
    };
    let closed = bytes.last() == Some(&b'\n');
    let last_feed = bytes.len() - usize::from(closed);
    if !closed {
        out.extend_from_slice(feed);
    }
    if ends_in_backslash(bytes, 0, last_feed) {
        // The backslash joins the empty line.
        out.extend_from_slice(feed);
    }
    for (i, normal) in added.iter().enumerate() {
        out.extend_from_slice(b"vn");
        for coordinate in normal.to_array() {
            out.push(b' ');
            number::write(coordinate, &mut out);
        }
        if closed || i + 1 < added.len() {
            out.extend_from_slice(feed);
        }
    }
    out
}
