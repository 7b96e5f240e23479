//! `anamorph cage --mesh`: a coarse mesh in the shape of a model, as a file that people edit for the warp `mesh`.

use super::cage::{in_comment, usage};
use crate::arguments::CageOptions;
use crate::error::{Failure, say};
use crate::files::{self, Pending};
use crate::model;
use anamorph::meshing::decimation::{Decimation, Hindered, decimate};
use anamorph::meshing::{Surface, SurfaceTree};
use anamorph_core::glam::DVec3;
use anamorph_io::{Document, Geometry, Points, Target, WriteError};
use std::path::Path;

/// A distance of no more than this share of the model's size is rounding.
const ROUNDING: f64 = 1e-12;

/// The format of the output, by its extension; OBJ without one.
pub(super) fn target(output: &Path) -> Result<&'static Target, Failure> {
    let extension = output
        .extension()
        .filter(|_| !files::is_immediate(output))
        .map_or_else(|| "obj".into(), |e| e.to_string_lossy().to_lowercase());
    // A table of points has no faces.
    let mut meshes = anamorph_io::targets().iter().filter(|t| t.name != "csv");
    let known = |t: &&Target| t.extensions.contains(&extension.as_str());
    meshes.clone().find(known).ok_or_else(|| {
        let names: Vec<&str> = meshes.by_ref().map(|t| t.name).collect();
        let why = if extension == "csv" {
            "a table of points has no faces; "
        } else {
            ""
        };
        Failure::usage(format!(
            "{}: a coarse mesh cannot be written as .{extension}; {why}name the output .obj, or one of these: .{}",
            output.display(),
            names.join(", .")
        ))
    })
}

/// Writes a coarse mesh of `count` vertices, and says how near to the model it is.
pub(super) fn write(
    options: &CageOptions,
    count: usize,
    target: &Target,
    document: &dyn Document,
) -> Result<(), Failure> {
    let name = files::shown(&options.model);
    let surface = surface(document, &name)?;
    let fail = |error: &dyn std::fmt::Display| Failure::new(format!("{name}: {error}"));
    let coarse = decimate(&surface, count).map_err(|error| fail(&error))?;
    let (vertex, distance) = farthest(&surface, &coarse.surface).map_err(|error| fail(&error))?;

    let topology = coarse.surface.topology();
    let mut geometry = Geometry::default();
    geometry.planar = document.points().dimension() == 2;
    geometry.points = coarse.surface.positions().to_vec();
    for face in 0..topology.faces() {
        // As many as the model had at most, which are numbered by 32 bits.
        let corners = topology.triangle(face).map(u32::try_from);
        geometry.corners.extend(corners.into_iter().flatten());
        geometry.ends.push(geometry.corners.len());
    }

    let (mut refused, mut lost) = (None, None);
    let mut file = Pending::create(&options.output, options.force)?;
    file.fill(|out| {
        if target.name == "obj" {
            out.write_all(comments(options).as_bytes())?;
        }
        match target.create(&geometry, out) {
            Ok(found) => lost = Some(found).filter(|lost| !lost.is_empty()),
            Err(WriteError::Output(error)) => return Err(error),
            Err(error) => refused = Some(fail(&error)),
        }
        Ok(())
    })?;
    if let Some(failure) = refused {
        return Err(failure);
    }
    files::keep_all([file])?;
    if options.quiet {
        return Ok(());
    }
    say!(
        "{name} -> {}: {} vertices, {} triangles, for `mesh`",
        files::shown_output(&options.output),
        topology.vertices(),
        topology.faces()
    );
    let size = model::size(surface.positions());
    let distance = if distance <= ROUNDING * size {
        0.0
    } else {
        distance
    };
    say!(
        "  vertices of its faces are at most {} from it, {} % of the model's size (vertex {})",
        files::short(distance),
        files::short(100.0 * (distance / size)),
        vertex + 1
    );
    for note in notes(&coarse, count) {
        say!("  note: {note}");
    }
    if let Some(lost) = lost {
        say!(
            "  warning: {} cannot hold: {lost}",
            target.name.to_uppercase()
        );
    }
    Ok(())
}

/// The faces of a model.
fn surface(document: &dyn Document, name: &str) -> Result<Surface, Failure> {
    let visible = document.visible();
    let points: Vec<DVec3> = match document.points() {
        Points::Plane(points) => points.iter().map(|p| p.extend(0.0)).take(visible).collect(),
        Points::Solid(points) => points.iter().copied().take(visible).collect(),
    };
    let triangles = document.mesh().unwrap_or_default().triangles;
    if triangles.is_empty() {
        return Err(Failure::new(format!(
            "{name}: has no faces, and a coarse mesh is made from a surface; give a model with faces, or take --points COUNT"
        )));
    }
    let triangles: Vec<[usize; 3]> = triangles.iter().map(|t| t.map(|v| v as usize)).collect();
    Surface::new(points, &triangles).map_err(|error| Failure::new(format!("{name}: {error}")))
}

/// The vertex of a surface that is farthest from a coarse one, and its distance.
fn farthest(
    fine: &Surface,
    coarse: &Surface,
) -> Result<(usize, f64), anamorph::meshing::SurfacePointError> {
    let tree = SurfaceTree::new(coarse);
    let mut most = (0, 0.0);
    for (vertex, &point) in fine.positions().iter().enumerate() {
        if fine.topology().corners(vertex).is_empty() {
            continue;
        }
        let distance = tree.nearest(point)?.distance;
        if distance > most.1 {
            most = (vertex, distance);
        }
    }
    Ok(most)
}

/// What is worth knowing about how it was made.
fn notes(coarse: &Decimation, count: usize) -> Vec<String> {
    let mut notes = Vec::new();
    let left = coarse.surface.topology().vertices();
    let plural = |count: usize, one: &str, more: &str| {
        format!("{count} {}", if count == 1 { one } else { more })
    };
    if let Some(why) = coarse.hindered {
        notes.push(hindrances(left, count, why));
    } else if left < count {
        notes.push(format!(
            "the surface has no more than {left} vertices, {count} were asked for; it was written as it is"
        ));
    }
    if coarse.joined > 0 {
        notes.push(format!(
            "{} joined with others in the same place",
            plural(coarse.joined, "vertex was", "vertices were")
        ));
    }
    if coarse.locked > 0 {
        notes.push(format!(
            "{} where three faces and more share an edge, or surfaces touch in a point",
            plural(
                coarse.locked,
                "vertex stays as it is,",
                "vertices stay as they are,"
            )
        ));
    }
    if coarse.left_out > 0 {
        notes.push(format!(
            "{} left out: a place twice, or the same places as another",
            plural(coarse.left_out, "face was", "faces were")
        ));
    }
    if coarse.loose > 0 {
        notes.push(format!(
            "{} left out, which no face has",
            plural(coarse.loose, "vertex was", "vertices were")
        ));
    }
    notes
}

/// Why more vertices are left than asked for.
fn hindrances(left: usize, count: usize, why: Hindered) -> String {
    let reasons = [
        (
            why.topology,
            "close a hole, a handle or a piece of the surface",
        ),
        (why.locked, "change where faces meet that have to stay"),
        (why.turning, "turn a face over or flatten it"),
    ];
    let reasons: Vec<String> = reasons
        .into_iter()
        .filter(|&(edges, _)| edges > 0)
        .map(|(edges, what)| format!("{what} ({edges} of the edges)"))
        .collect();
    format!(
        "{left} vertices are left, not {count}: to take away one more would {}",
        reasons.join(" or ")
    )
}

/// What stands at the beginning of an OBJ file.
fn comments(options: &CageOptions) -> String {
    let mut lines = vec![
        format!(
            "A coarse mesh in the shape of {}, for anamorph's warp `mesh`.",
            in_comment(&options.model, "a model")
        ),
        String::new(),
    ];
    lines.extend(usage(options, "mesh"));
    lines.pop();
    let mut text = String::new();
    for line in lines {
        text.push_str(format!("# {line}").trim_end());
        text.push('\n');
    }
    text
}
