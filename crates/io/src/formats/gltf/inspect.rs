//! What a glTF holds, what is odd about it, and how it was understood.

use super::{Model, elements, listed};
use crate::faces::Faces;
use crate::inspect::{Finding, First, bounds, faces, unused};
use crate::{Document, Inspection, Problem, ProblemKind};
use anamorph_core::glam::DVec3;

pub(super) fn inspect(model: &Model) -> Inspection {
    let (mesh, broken) = elements::all(model);
    let points = &model.points[..model.visible];
    let mut list = Faces::default();
    for triangle in &mesh.triangles {
        list.vertices.extend_from_slice(triangle);
        list.close();
    }
    let mut findings = Vec::new();
    // Vertices are split where faces differ in normals or textures, so a boundary says nothing.
    let _ = faces(&list, points, &mut findings);
    let mut used = vec![false; points.len()];
    let in_faces = mesh.triangles.iter().flatten();
    let in_lines = mesh.lines.iter().flatten();
    for &vertex in in_faces.chain(in_lines).chain(&mesh.points) {
        used[vertex as usize] = true;
    }
    unused(&used, &mut findings);
    if let Some(&first) = model.nonfinite.first() {
        findings.push(Finding {
            kind: ProblemKind::NonFinitePoint,
            count: model.nonfinite.len() as u64,
            first: First::Vertex(first),
        });
    }
    let mut problems: Vec<Problem> = findings
        .into_iter()
        .map(|finding| Problem {
            kind: finding.kind,
            count: finding.count,
            first: match finding.first {
                First::Vertex(vertex) => model.name_of_point(vertex),
                other => other.words(),
            },
            line: None,
        })
        .collect();
    problems.extend(broken_primitives(model, broken));
    problems.extend(bad_normals(model));
    problems.sort_by_key(|problem| problem.kind);

    let root = model.json.root();
    let length = |key: &str| listed(root, key).len() as u64;
    let primitives = model.meshes.iter().map(|mesh| mesh.primitives.len() as u64);
    let targets = model.meshes.iter().map(|mesh| mesh.targets as u64);
    let mut counts = vec![
        ("vertices", model.visible as u64),
        ("triangles", mesh.triangles.len() as u64),
        ("line segments", mesh.lines.len() as u64),
        ("point elements", mesh.points.len() as u64),
        ("normals", model.normals() as u64),
        ("meshes", length("meshes")),
        ("primitives", primitives.sum()),
        ("morph targets", targets.sum()),
        ("nodes", length("nodes")),
        ("instances of meshes", model.instances.len() as u64),
        ("skins", length("skins")),
        ("animations", length("animations")),
        ("materials", length("materials")),
        ("images", length("images")),
    ];
    counts.retain(|(name, count)| *count > 0 || matches!(*name, "vertices" | "triangles"));
    Inspection {
        format: model.format,
        dimension: 3,
        counts,
        bounds: bounds(points.iter().map(DVec3::to_array)),
        attributes: model.attributes(),
        problems,
    }
}

fn broken_primitives(model: &Model, broken: u64) -> Option<Problem> {
    let data = model.data();
    for (m, mesh) in model.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            if let Some((highest, count)) = model.beyond(mesh, primitive, &data) {
                return Some(Problem {
                    kind: ProblemKind::BrokenElement,
                    count: broken,
                    first: format!(
                        "meshes[{m}].primitives[{p}]: a corner at vertex {highest} (from 0) of {count}"
                    ),
                    line: None,
                });
            }
        }
    }
    None
}

fn bad_normals(model: &Model) -> Option<Problem> {
    let data = model.data();
    let mut accessors: Vec<usize> = model
        .meshes
        .iter()
        .flat_map(|mesh| mesh.primitives.iter().filter_map(|p| p.normal))
        .collect();
    accessors.sort_unstable();
    accessors.dedup();
    let (mut count, mut first) = (0, None);
    for accessor in accessors {
        let normals: Vec<[f32; 3]> = model.accessors[accessor].elements(&data);
        for (i, normal) in normals.iter().enumerate() {
            if !normal.iter().all(|x| x.is_finite()) {
                count += 1;
                first
                    .get_or_insert_with(|| format!("normal {i} (from 0) of accessors[{accessor}]"));
            }
        }
    }
    first.map(|first| Problem {
        kind: ProblemKind::NonFiniteNormal,
        count,
        first,
        line: None,
    })
}

/// How the file was understood, where one might not expect it.
pub(super) fn notes(model: &Model) -> Vec<String> {
    let mut notes = Vec::new();
    let mut nodes = model.nodes.iter();
    if nodes.any(|node| node.mesh.is_some() && node.skin.is_some()) {
        notes.push(
            "skinned meshes are warped in their bind pose, as their first joint places it".into(),
        );
    }
    if model.local {
        notes.push("meshes are warped in their own coordinates, not where nodes place them".into());
    }
    let root = model.json.root();
    let instanced = |node: &super::Value<'_>| {
        node.get("extensions")
            .is_some_and(|extensions| extensions.get("EXT_mesh_gpu_instancing").is_some())
    };
    if listed(root, "nodes").iter().any(instanced) {
        notes.push(
            "instances of EXT_mesh_gpu_instancing are not seen: their mesh is warped where its node stands"
                .into(),
        );
    }
    let external = model
        .buffers
        .iter()
        .any(|buffer| matches!(buffer.source, super::Source::File) && !buffer.content.is_empty());
    if external {
        notes.push(
            "files beside the model stay as they are; what moves is written into the model itself"
                .into(),
        );
    }
    notes
}
