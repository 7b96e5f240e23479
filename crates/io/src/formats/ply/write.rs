//! Writing a PLY file with moved vertices.

use super::header::Encoding;
use super::scalar::Scalar;
use super::triple::Triple;
use super::{Column, Model, Strided};
use crate::normals::same;
use crate::patch::Patch;
use crate::{Document, Moved, Normals, Points, WriteError, WriteReport, number, text};
use anamorph_core::glam::DVec3;
use std::io::Write;

/// Vertices rewritten together, and how many such runs are in memory at a time: bounds memory to what caches hold, and feeds
/// as many cores.
const RUN: usize = 1 << 12;
const IN_FLIGHT: usize = 16;

/// The vectors of one property group, before and after.
struct Change<'a> {
    columns: &'a [Column],
    old: &'a [DVec3],
    new: &'a [DVec3],
    /// How the columns stand, if they stand side by side.
    triple: Option<Triple>,
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

    /// Puts the new numbers into rows, the first of which is that of the vertex `first`. The result is how many vectors
    /// changed.
    fn write(&self, layout: Strided<'_>, rows: &mut [u8], first: usize) -> usize {
        if let Some(triple) = self.triple {
            return triple.write(rows, &self.new[first..]);
        }
        let mut changed = 0;
        for (vertex, row) in (first..).zip(rows.chunks_exact_mut(layout.stride)) {
            let Some(values) = self.of(vertex) else {
                continue;
            };
            changed += 1;
            for ((column, scalar), value) in values {
                scalar.write(value, layout.order, &mut row[layout.spots[column].start..]);
            }
        }
        changed
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
    let layout = model.strided(model.vertex);
    let triple = |columns: &[Column]| layout.and_then(|layout| Triple::of(columns, layout));
    let axes = triple(&model.axes);
    // Nearly always all is well, which one look at the new points alone can tell.
    let well = match (axes, moved.points) {
        (Some(axes), Points::Solid(new)) => new.len() == model.positions.len() && axes.holds(new),
        _ => false,
    };
    if !well {
        model.points().check(&moved.points)?;
    }
    let new = moved.points.solid();
    let positions = Change {
        columns: &model.axes,
        old: &model.positions,
        new: &new,
        triple: axes,
    };
    if !well {
        positions.check(model)?;
    }
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
        triple: model.normal.as_ref().and_then(|n| triple(n)),
    };
    // A normal is a direction: there is always room for one.
    let changes = [
        Some(positions),
        (!normals.new.is_empty()).then_some(normals),
    ];
    match layout {
        Some(layout) => in_strides(model, layout, &changes, &mut report, out)?,
        None => row_by_row(model, &changes, &mut report, out)?,
    }
    Ok(report)
}

/// Counts what changed.
fn count(report: &mut WriteReport, which: usize, more: usize) {
    match which {
        0 => report.moved_points += more,
        _ => report.changed_normals += more,
    }
}

fn in_strides(
    model: &Model,
    layout: Strided<'_>,
    changes: &[Option<Change<'_>>; 2],
    report: &mut WriteReport,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let stride = layout.stride;
    let range = model.sections[model.vertex].range.clone();
    out.write_all(&model.bytes[..range.start])?;
    let mut buffer = Vec::new();
    let mut first = 0;
    for group in model.bytes[range.clone()].chunks(stride * RUN * IN_FLIGHT) {
        buffer.resize(group.len(), 0);
        let done = text::fill(&mut buffer, stride * RUN, |at, rows| {
            rows.copy_from_slice(&group[at..at + rows.len()]);
            let start = first + at / stride;
            let mut done = WriteReport::default();
            for (which, change) in changes.iter().enumerate() {
                if let Some(change) = change {
                    count(&mut done, which, change.write(layout, rows, start));
                }
            }
            done
        });
        for done in done {
            report.moved_points += done.moved_points;
            report.changed_normals += done.changed_normals;
        }
        out.write_all(&buffer)?;
        first += group.len() / stride;
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
            count(report, which, 1);
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
