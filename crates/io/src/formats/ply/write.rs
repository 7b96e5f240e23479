//! Writing a PLY file with moved vertices.

use super::header::Encoding;
use super::rows::Rows;
use super::scalar::{Order, Scalar};
use super::{Column, Model};
use crate::normals::same;
use crate::patch::Patch;
use crate::{Document, Moved, Normals, WriteError, WriteReport, number, text};
use anamorph_core::glam::DVec3;
use std::io::Write;

/// Vertices rewritten together, and how many such runs are in memory at a time: bounds memory, and feeds as many cores.
const RUN: usize = 1 << 14;
const IN_FLIGHT: usize = 16;

/// The vectors of one property group, before and after.
struct Change<'a> {
    columns: &'a [Column],
    old: &'a [DVec3],
    new: &'a [DVec3],
}

impl Change<'_> {
    /// The numbers of a vertex to replace: which column, and the new value. Where the old ones are not finite, none.
    #[inline]
    fn of(&self, vertex: usize) -> Option<impl Iterator<Item = (Column, f64)>> {
        let (old, new) = (self.old[vertex], self.new[vertex]);
        if same(old, new) || !old.is_finite() {
            return None;
        }
        let values = old.to_array().into_iter().zip(new.to_array());
        let changed = self.columns.iter().zip(values);
        Some(
            changed
                .filter(|(_, (old, new))| old.to_bits() != new.to_bits())
                .map(|(column, (_, new))| (*column, new)),
        )
    }

    /// Refuses values that their types cannot hold.
    fn check(&self, model: &Model) -> Result<(), WriteError> {
        if self.columns.iter().all(|c| c.1 == Scalar::F64) {
            return Ok(());
        }
        let runs = text::runs(self.new.len(), RUN);
        let first = text::map(&runs, |run| {
            run.clone().find_map(|v| {
                self.of(v)?
                    .find(|(column, value)| !column.1.holds(*value))
                    .map(|(column, value)| (v, column, value))
            })
        });
        let Some((vertex, (column, scalar), value)) = first.into_iter().flatten().next() else {
            return Ok(());
        };
        let name = &model.header.elements[model.vertex].properties[column].name;
        let whole = !scalar.is_float();
        Err(WriteError::DoesNotFit {
            what: format!(
                "vertex {} moves to {name} = {value}, but the file holds {name} as {} of type {}",
                vertex + 1,
                if whole { "whole numbers" } else { "numbers" },
                scalar.name()
            ),
            mend: if whole {
                "give the file coordinates of type float or double: write it with another extension such as .obj and back"
            } else {
                "scale the model down, or give the file coordinates of type double"
            },
        })
    }
}

pub(super) fn write(
    model: &Model,
    moved: &Moved<'_>,
    out: &mut dyn Write,
) -> Result<WriteReport, WriteError> {
    model.points().check(&moved.points)?;
    let new = moved.points.solid();
    let positions = Change {
        columns: &model.axes,
        old: &model.positions,
        new: &new,
    };
    positions.check(model)?;
    let mut report = WriteReport::default();
    let (mut old_normals, mut new_normals) = (Vec::new(), Vec::new());
    if !matches!(moved.normals, Normals::Keep)
        && let Some((normals, kept)) = model.moved_normals(&new, moved.normals)
    {
        old_normals = model.stored_normals().unwrap_or_default();
        new_normals = normals;
        report.kept_normals = kept;
    }
    let columns = model.normal.unwrap_or([(0, Scalar::F32); 3]);
    let normals = Change {
        columns: &columns,
        old: &old_normals,
        new: &new_normals,
    };
    // A normal is a direction: there is always room for one.
    let changes = [
        Some(positions),
        (!normals.new.is_empty()).then_some(normals),
    ];
    let section = &model.sections[model.vertex];
    match (&section.rows, model.header.encoding) {
        (Rows::Even { stride, spots }, Encoding::Binary(order)) => {
            let starts: Vec<usize> = spots.iter().map(|spot| spot.start).collect();
            in_strides(model, *stride, &starts, order, &changes, &mut report, out)?;
        }
        _ => row_by_row(model, &changes, &mut report, out)?,
    }
    Ok(report)
}

/// Counts what changed.
fn count(report: &mut WriteReport, which: usize) {
    match which {
        0 => report.moved_points += 1,
        _ => report.changed_normals += 1,
    }
}

fn in_strides(
    model: &Model,
    stride: usize,
    starts: &[usize],
    order: Order,
    changes: &[Option<Change<'_>>; 2],
    report: &mut WriteReport,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let range = model.sections[model.vertex].range.clone();
    let bytes = &model.bytes[range.clone()];
    out.write_all(&model.bytes[..range.start])?;
    let runs = text::runs(model.positions.len(), RUN);
    for group in runs.chunks(IN_FLIGHT) {
        let pieces = text::map(group, |run| {
            let mut piece = bytes[run.start * stride..run.end * stride].to_vec();
            let mut done = WriteReport::default();
            for (v, row) in run.clone().zip(piece.chunks_exact_mut(stride)) {
                for (which, change) in changes.iter().enumerate() {
                    let Some(values) = change.as_ref().and_then(|change| change.of(v)) else {
                        continue;
                    };
                    count(&mut done, which);
                    for ((column, scalar), value) in values {
                        scalar.write(value, order, &mut row[starts[column]..]);
                    }
                }
            }
            (piece, done)
        });
        for (piece, done) in pieces {
            out.write_all(&piece)?;
            report.moved_points += done.moved_points;
            report.changed_normals += done.changed_normals;
        }
    }
    out.write_all(&model.bytes[range.end..])?;
    report.bytes += model.bytes.len() as u64;
    Ok(())
}

fn row_by_row(
    model: &Model,
    changes: &[Option<Change<'_>>; 2],
    report: &mut WriteReport,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let mut patch = Patch::new(&model.bytes, out);
    // Replacements must come in the order of the file, whatever that of the properties.
    let mut edits: Vec<(core::ops::Range<usize>, Scalar, f64)> = Vec::with_capacity(6);
    model.rows(model.vertex, |v, row| -> Result<(), WriteError> {
        edits.clear();
        for (which, change) in changes.iter().enumerate() {
            let Some(values) = change.as_ref().and_then(|change| change.of(v)) else {
                continue;
            };
            count(report, which);
            edits.extend(values.map(|((column, scalar), new)| (row.range(column), scalar, new)));
        }
        edits.sort_unstable_by_key(|edit| edit.0.start);
        for (range, scalar, value) in edits.drain(..) {
            let buffer = patch.replace(range.start, range.end)?;
            match model.header.encoding {
                Encoding::Ascii if scalar == Scalar::F32 => {
                    number::write_single(value as f32, buffer);
                }
                Encoding::Ascii => number::write(value, buffer),
                Encoding::Binary(order) => {
                    let mut bytes = [0; 8];
                    scalar.write(value, order, &mut bytes);
                    buffer.extend_from_slice(&bytes[..scalar.size()]);
                }
            }
        }
        Ok(())
    })?;
    patch.finish(report)
}
