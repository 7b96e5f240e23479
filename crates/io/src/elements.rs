//! What the mesh formats share: elements over points, what is broken among them, and their inspection.

use crate::faces::Faces;
use crate::inspect::{Finding, First, bounds, coincident, faces, unused};
use crate::{Inspection, Mesh, Problem, ProblemKind};
use anamorph_core::glam::DVec3;

/// The elements of a file that make sense, and the first of those that do not.
#[derive(Default)]
pub(crate) struct Elements {
    pub(crate) faces: Faces,
    /// The number in the file, from 0, of each of the faces, where some are left out.
    pub(crate) ordinals: Vec<u32>,
    pub(crate) lines: Vec<[u32; 2]>,
    pub(crate) points: Vec<u32>,
    /// How many elements are left out, and what is wrong with the first.
    pub(crate) broken: Option<(u64, String)>,
}

impl Elements {
    /// Counts an element that makes no sense.
    pub(crate) fn add_broken(&mut self, what: impl FnOnce() -> String) {
        match &mut self.broken {
            Some((count, _)) => *count += 1,
            None => self.broken = Some((1, what())),
        }
    }

    pub(crate) fn mesh(self, points: &[DVec3]) -> Mesh {
        Mesh {
            triangles: self.faces.triangles(points),
            faces: self.faces.len(),
            lines: self.lines,
            points: self.points,
        }
    }
}

/// Which of `count` points some face, line or point element refers to.
pub(crate) fn used(count: usize, faces: &Faces, lines: &[[u32; 2]], points: &[u32]) -> Vec<bool> {
    let mut used = vec![false; count];
    let corners = faces.vertices.iter();
    for &vertex in corners.chain(lines.iter().flatten()).chain(points) {
        used[vertex as usize] = true;
    }
    used
}

/// What an inspection needs of a document besides its elements.
pub(crate) struct Subject<'a> {
    pub(crate) format: &'static str,
    pub(crate) dimension: usize,
    pub(crate) points: &'a [DVec3],
    pub(crate) nonfinite: &'a [usize],
    pub(crate) attributes: Vec<String>,
    /// Counts by the format's own terms, put behind that of the vertices.
    pub(crate) counts: Vec<(&'static str, u64)>,
    /// Indices of vertices with a normal that is not finite.
    pub(crate) nonfinite_normals: Vec<usize>,
}

/// The inspection of a mesh. `line` gives the line of a vertex (from 0) or face (number in the file, from 0), where there
/// are lines.
pub(crate) fn inspect(
    subject: Subject<'_>,
    elements: &Elements,
    values: impl Fn(&str) -> Option<Vec<f64>>,
    line: impl Fn(First) -> Option<u64>,
) -> Inspection {
    let points = subject.points;
    let mut findings = Vec::new();
    let boundary = faces(&elements.faces, points, &mut findings);
    let in_use = used(
        points.len(),
        &elements.faces,
        &elements.lines,
        &elements.points,
    );
    unused(&in_use, &mut findings);
    coincident(points.iter().map(DVec3::to_array), &mut findings);
    let mut list = |kind, vertices: &[usize]| {
        if let Some(&first) = vertices.first() {
            findings.push(Finding {
                kind,
                count: vertices.len() as u64,
                first: First::Vertex(first),
            });
        }
    };
    list(ProblemKind::NonFinitePoint, subject.nonfinite);
    list(ProblemKind::NonFiniteNormal, &subject.nonfinite_normals);

    let mut problems: Vec<Problem> = findings
        .into_iter()
        .map(|finding| {
            let ordinal = |f: usize| elements.ordinals.get(f).map_or(f, |o| *o as usize);
            let first = match finding.first {
                First::Face(f) => First::Face(ordinal(f)),
                First::Edge(a, b, f) => First::Edge(a, b, ordinal(f)),
                vertex @ First::Vertex(_) => vertex,
            };
            Problem {
                kind: finding.kind,
                count: finding.count,
                first: first.words(),
                line: line(first),
            }
        })
        .collect();
    for name in &subject.attributes {
        let bad = |values: Vec<f64>| {
            let first = values.iter().position(|v| !v.is_finite())?;
            let count = values.iter().filter(|v| !v.is_finite()).count() as u64;
            Some((first, count))
        };
        if let Some((first, count)) = values(name).and_then(bad) {
            problems.push(Problem {
                kind: ProblemKind::NonFiniteAttribute,
                count,
                first: format!("{name} of vertex {}", first + 1),
                line: line(First::Vertex(first)),
            });
            break;
        }
    }
    if let Some((count, first)) = &elements.broken {
        problems.push(Problem {
            kind: ProblemKind::BrokenElement,
            count: *count,
            first: first.clone(),
            line: None,
        });
    }
    problems.sort_by_key(|problem| problem.kind);

    let triangles = elements.faces.vertices.len() - 2 * elements.faces.len();
    let mut counts = vec![("vertices", points.len() as u64)];
    counts.extend(subject.counts);
    counts.extend([
        ("faces", elements.faces.len() as u64),
        ("triangles", triangles as u64),
        ("boundary edges", boundary),
        ("line elements", elements.lines.len() as u64),
        ("point elements", elements.points.len() as u64),
    ]);
    counts.retain(|(name, count)| *count > 0 || matches!(*name, "vertices" | "faces"));
    let bounds = if subject.dimension == 2 {
        bounds(points.iter().map(|p| [p.x, p.y]))
    } else {
        bounds(points.iter().map(DVec3::to_array))
    };
    Inspection {
        format: subject.format,
        dimension: subject.dimension,
        counts,
        bounds,
        attributes: subject.attributes,
        problems,
    }
}
