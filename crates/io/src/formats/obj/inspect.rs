//! What an OBJ file holds and what is wrong with it.

use super::scan::{Keyword, Reference, Statement, Tokens, resolve};
use super::{COLOURS, Counts, Text, check};
use crate::elements::used;
use crate::inspect::{Finding, First, bounds, coincident, faces, unused};
use crate::{Document, Inspection, Problem, ProblemKind};
use std::collections::BTreeMap;

pub(super) fn inspect(text: &Text) -> Inspection {
    let elements = text.elements(false);
    let mut findings = Vec::new();
    let boundary = faces(&elements.faces, &text.positions, &mut findings);

    let (lines, loose) = (&elements.lines, &elements.points);
    let in_use = used(text.positions.len(), &elements.faces, lines, loose);
    unused(&in_use, &mut findings);
    coincident(
        text.positions
            .iter()
            .map(anamorph_core::glam::DVec3::to_array),
        &mut findings,
    );
    if let Some(&first) = text.nonfinite.first() {
        let count = text.nonfinite.len() as u64;
        findings.push(Finding {
            kind: ProblemKind::NonFinitePoint,
            count,
            first: First::Vertex(first),
        });
    }

    let attributes = text.attributes();
    let mut problems = in_statements(text, attributes.len() == COLOURS.len());
    problems.extend(findings.into_iter().map(|finding| named(text, &finding)));
    problems.sort_by_key(|problem| problem.kind);

    let totals = text.totals;
    let triangles = elements.faces.vertices.len() - 2 * elements.faces.len();
    let mut counts = vec![
        ("vertices", totals.vertices),
        ("normals", totals.normals),
        ("texture coordinates", totals.textures),
        ("faces", totals.faces),
        ("triangles", triangles as u64),
        ("boundary edges", boundary),
        ("line elements", totals.lines),
        ("point elements", totals.points),
    ];
    counts.retain(|(name, count)| *count > 0 || matches!(*name, "vertices" | "faces"));
    Inspection {
        format: text.format(),
        dimension: 3,
        counts,
        bounds: bounds(
            text.positions
                .iter()
                .map(anamorph_core::glam::DVec3::to_array),
        ),
        attributes,
        problems,
    }
}

/// Problems that single statements have by themselves.
fn in_statements(text: &Text, coloured: bool) -> Vec<Problem> {
    let mut found: BTreeMap<ProblemKind, Problem> = BTreeMap::new();
    let mut add = |kind: ProblemKind, statement: &Statement, first: &dyn Fn() -> String| {
        let problem = found.entry(kind).or_insert_with(|| Problem {
            kind,
            count: 0,
            first: first(),
            line: Some(crate::text::place(&text.bytes, statement.start).0),
        });
        problem.count += 1;
    };
    let mut before = Counts::default();
    for statement in text.chunks.iter().flat_map(|chunk| text.statements(chunk)) {
        match statement.keyword {
            Keyword::Vertex
                if coloured && text.extras(&statement).take(3).any(|c| !c.is_finite()) =>
            {
                let first = || format!("the colour of vertex {}", before.vertices + 1);
                add(ProblemKind::NonFiniteAttribute, &statement, &first);
            }
            Keyword::Normal
                if super::position(&text.bytes, &statement).is_none_or(|n| !n.is_finite()) =>
            {
                add(ProblemKind::NonFiniteNormal, &statement, &|| {
                    format!("normal {}", before.normals + 1)
                });
            }
            Keyword::Face | Keyword::Line | Keyword::Point => {
                if let Err(error) = check::element(&text.bytes, &statement, before, text.totals) {
                    add(ProblemKind::BrokenElement, &statement, &|| {
                        error.what.clone()
                    });
                } else {
                    let name = check::element_name(statement.keyword);
                    let (dangling, mixed) = loose_references(text, &statement, before);
                    if let Some(what) = dangling {
                        let first =
                            || format!("{name} {}: {what}", number(before, statement.keyword));
                        add(ProblemKind::DanglingReference, &statement, &first);
                    }
                    if mixed {
                        let first = || format!("{name} {}", number(before, statement.keyword));
                        add(ProblemKind::MixedReferences, &statement, &first);
                    }
                }
            }
            _ => {}
        }
        before.count(statement.keyword);
    }
    found.into_values().collect()
}

/// The number of the element, from 1, that follows the counted ones.
fn number(before: Counts, keyword: Keyword) -> u64 {
    1 + match keyword {
        Keyword::Face => before.faces,
        Keyword::Line => before.lines,
        _ => before.points,
    }
}

/// The first reference of an element to a texture coordinate or normal that does not exist, and whether some corners
/// have one and others not.
fn loose_references(text: &Text, statement: &Statement, before: Counts) -> (Option<String>, bool) {
    let (mut dangling, mut shapes) = (None, [false; 4]);
    for token in Tokens::of(&text.bytes, statement) {
        let Some(reference) = Reference::parse(&text.bytes[token]) else {
            continue;
        };
        let (texture, normal) = (reference.texture, reference.normal);
        shapes[usize::from(texture != 0) + 2 * usize::from(normal != 0)] = true;
        let textures = (
            texture,
            before.textures,
            text.totals.textures,
            "texture coordinate",
        );
        let normals = (normal, before.normals, text.totals.normals, "normal");
        for (written, before, total, what) in [textures, normals] {
            if written != 0 && resolve(written, before).is_none_or(|index| index >= total) {
                dangling.get_or_insert_with(|| format!("{what} {written} of {total}"));
            }
        }
    }
    (dangling, shapes.iter().filter(|shape| **shape).count() > 1)
}

/// A finding with the place in the file.
fn named(text: &Text, finding: &Finding) -> Problem {
    let (first, offset) = match finding.first {
        First::Vertex(v) => {
            let chunk = text
                .chunks
                .iter()
                .rfind(|c| c.here.vertices > 0 && c.before.vertices <= v as u64);
            let offset = chunk.and_then(|chunk| {
                let mut vertices = text
                    .statements(chunk)
                    .filter(|s| s.keyword == Keyword::Vertex);
                vertices
                    .nth(v - chunk.before.vertices as usize)
                    .map(|s| s.start)
            });
            (finding.first, offset)
        }
        First::Face(f) => match sound_face(text, f) {
            Some((ordinal, offset)) => (First::Face(ordinal), Some(offset)),
            None => (finding.first, None),
        },
        First::Edge(a, b, f) => match sound_face(text, f) {
            Some((ordinal, offset)) => (First::Edge(a, b, ordinal), Some(offset)),
            None => (finding.first, None),
        },
    };
    Problem {
        kind: finding.kind,
        count: finding.count,
        first: first.words(),
        line: offset.map(|at| crate::text::place(&text.bytes, at).0),
    }
}

/// The face that is number `sound` (from 0) among those that make sense: its number among all, and where it begins.
fn sound_face(text: &Text, sound: usize) -> Option<(usize, usize)> {
    let mut before = Counts::default();
    let mut passed = 0;
    for statement in text.chunks.iter().flat_map(|chunk| text.statements(chunk)) {
        if statement.keyword == Keyword::Face
            && check::element(&text.bytes, &statement, before, text.totals).is_ok()
        {
            if passed == sound {
                return Some((before.faces as usize, statement.start));
            }
            passed += 1;
        }
        before.count(statement.keyword);
    }
    None
}
