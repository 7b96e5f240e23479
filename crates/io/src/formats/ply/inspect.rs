//! What a PLY file holds and what is wrong with it.

use super::{Model, Reading, reading};
use crate::inspect::First;
use crate::{Document, Inspection, elements};

pub(super) fn inspect(model: &Model) -> Inspection {
    let found = model.elements();
    let normals = model.stored_normals().unwrap_or_default();
    let subject = elements::Subject {
        format: model.format(),
        dimension: model.axes.len(),
        points: &model.positions,
        nonfinite: &model.nonfinite,
        attributes: model.attributes(),
        counts: vec![("normals", normals.len() as u64)],
        nonfinite_normals: (0..normals.len())
            .filter(|&i| !normals[i].is_finite())
            .collect(),
    };
    let faces = model
        .header
        .elements
        .iter()
        .position(|e| matches!(reading(e), Reading::Faces(_)));
    let line = |first: First| match first {
        First::Vertex(v) => model.line(model.vertex, v),
        First::Face(f) | First::Edge(_, _, f) => model.line(faces?, f),
    };
    elements::inspect(subject, &found, |name| model.attribute(name), line)
}
