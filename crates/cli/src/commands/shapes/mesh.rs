//! `anamorph mesh`: one triangulation of two shapes, without morphing them.

use super::super::film::fill;
use super::inputs::Input;
use super::{Sources, Step, pairs, sheets};
use crate::error::{Failure, output, say};
use crate::files;
use crate::shape_arguments::MeshOptions;
use anamorph_core::glam::DVec2;
use anamorph_meshing::compatible::PairQuality;
use anamorph_morph::strain;
use anamorph_preview::{Figure, Ink};
use serde_json::{Value, json};
use std::io::Write;

/// Pixels of the longer side of one of both meshes if nothing is said.
const SIZE: f64 = 512.0;

/// What the result is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    Pair,
    Picture,
}

/// Makes what the arguments name.
pub(crate) fn run(options: &MeshOptions) -> Result<(), Failure> {
    super::on_threads(options.threads, || mesh(options))
}

fn mesh(options: &MeshOptions) -> Result<(), Failure> {
    let form = form(options)?;
    let inputs: Vec<_> = options.inputs.iter().map(|p| files::identity(p)).collect();
    if inputs.contains(&files::identity(&options.output)) {
        return Err(Failure::usage(format!(
            "{}: the result would replace what it is made from; choose another name",
            options.output.display()
        )));
    }
    files::refuse_existing(&options.output, options.force)?;
    let sources = Sources::read(&options.inputs, &options.shapes)?;
    // Nothing is drawn between; these are prepared at once.
    let method = strain::method("vertex-linear").map_err(Failure::new)?;
    let steps = sources.steps(&method)?;
    let (inputs, step) = (&sources.inputs, &steps[0]);
    let mut qualities = Vec::new();
    for (number, couple) in step.figure.couples().iter().enumerate() {
        let name = pairs::part_name(inputs, step, number);
        let quality = couple.mesh.check().map_err(|fault| {
            Failure::new(format!(
                "{} and {}: {name}: {fault}",
                inputs[0].name, inputs[1].name
            ))
        })?;
        qualities.push((name, quality));
    }
    let view = super::common_view(inputs);
    match form {
        Form::Pair => fill(&options.output, options.force, |out| {
            let pair = pairs::of(inputs, step, &sources.anchors[0], view);
            pair.write(out).map_err(Failure::new)
        })?,
        Form::Picture => {
            let figure = picture(options, inputs, step);
            let label = "one triangulation of two shapes";
            sheets::write_figure(&options.output, options.force, &figure, label)?;
        }
    }
    if options.json {
        let text =
            serde_json::to_string_pretty(&report(inputs, &qualities)).map_err(Failure::new)?;
        writeln!(std::io::stdout().lock(), "{text}").map_err(|error| output(&error))?;
    }
    if !options.quiet {
        say_result(options, inputs, &qualities);
    }
    Ok(())
}

fn form(options: &MeshOptions) -> Result<Form, Failure> {
    let path = &options.output;
    if files::is_stream(path) {
        return if options.json {
            Err(Failure::usage(
                "--json: standard output holds the pair of meshes already; name a file for it",
            ))
        } else {
            Ok(Form::Pair)
        };
    }
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("json") => Ok(Form::Pair),
        Some("svg" | "png") => Ok(Form::Picture),
        _ => Err(Failure::usage(format!(
            "{}: a pair of meshes is a .json, and its picture .svg or .png",
            path.display()
        ))),
    }
}

/// Points and triangles of all parts, and the smallest angles.
fn total(qualities: &[(String, PairQuality)]) -> PairQuality {
    let none = PairQuality {
        smallest_angle: [f64::INFINITY; 2],
        triangles: 0,
        points: 0,
    };
    qualities.iter().fold(none, |all, (_, own)| PairQuality {
        smallest_angle: [0, 1].map(|i| all.smallest_angle[i].min(own.smallest_angle[i])),
        triangles: all.triangles + own.triangles,
        points: all.points + own.points,
    })
}

fn say_result(options: &MeshOptions, inputs: &[Input], qualities: &[(String, PairQuality)]) {
    let all = total(qualities);
    let parts = qualities.len();
    let one = if parts == 1 { "part" } else { "parts" };
    let [source, target] = all.smallest_angle;
    say!(
        "{}, {} -> {}: {parts} {one}, {} points, {} triangles; smallest angles {source:.1}° and {target:.1}°",
        inputs[0].name,
        inputs[1].name,
        files::shown_output(&options.output),
        all.points,
        all.triangles
    );
    for input in inputs {
        for note in &input.notes {
            say!("  note: {}: {note}", input.name);
        }
    }
}

fn report(inputs: &[Input], qualities: &[(String, PairQuality)]) -> Value {
    let of = |quality: &PairQuality| {
        json!({
            "points": quality.points,
            "triangles": quality.triangles,
            "smallest_angle_source": quality.smallest_angle[0],
            "smallest_angle_target": quality.smallest_angle[1],
        })
    };
    let parts: Vec<Value> = qualities
        .iter()
        .map(|(name, quality)| json!({ "name": name, "mesh": of(quality) }))
        .collect();
    let notes = inputs.iter().flat_map(|input| {
        let note = |note: &String| format!("{}: {note}", input.name);
        input.notes.iter().map(note)
    });
    json!({
        "anamorph": "mesh",
        "source": inputs[0].name,
        "target": inputs[1].name,
        "mesh": of(&total(qualities)),
        "parts": parts,
        "notes": notes.collect::<Vec<_>>(),
    })
}

/// Both meshes beside each other: triangles thin, outlines thick.
fn picture(options: &MeshOptions, inputs: &[Input], step: &Step) -> Figure {
    let size = options.shapes.size.unwrap_or(SIZE);
    let edge = 0.04 * size;
    let scales = [0, 1].map(|side| {
        let [.., w, h] = inputs[side].view;
        (size - 2.0 * edge) / w.max(h)
    });
    let sides = [0, 1].map(|side| {
        let [.., w, h] = inputs[side].view;
        [w * scales[side] + 2.0 * edge, h * scales[side] + 2.0 * edge]
    });
    let height = sides[0][1].max(sides[1][1]);
    let mut figure = Figure::new(sides[0][0] + sides[1][0], height, Ink::new(255, 255, 255));
    let thin = Ink::new(120, 128, 140);
    let dark = Ink::new(28, 32, 40);
    let widths = [size / 900.0, size / 230.0];
    for side in 0..2 {
        let [x, y, _, h] = inputs[side].view;
        let left = if side == 0 { 0.0 } else { sides[0][0] };
        let top = 0.5 * (height - h * scales[side]);
        let place = |p: DVec2| {
            [
                left + edge + (p.x - x) * scales[side],
                top + (p.y - y) * scales[side],
            ]
        };
        for (couple, fills) in step.figure.couples().iter().zip(&step.fills) {
            let points = if side == 0 {
                &couple.mesh.source
            } else {
                &couple.mesh.target
            };
            let ring = |list: &[u32]| -> Vec<[f64; 2]> {
                list.iter().map(|&i| place(points[i as usize])).collect()
            };
            let rings: Vec<Vec<[f64; 2]>> = couple.mesh.rings.iter().map(|r| ring(r)).collect();
            let [r, g, b, _] = fills[side].or(fills[1 - side]).unwrap_or([0.5; 4]);
            // Light enough that lines are seen on it.
            let code = |light: f64| (255.0 * (0.78 + 0.22 * light.clamp(0.0, 1.0))).round() as u8;
            figure.region(&rings, Ink::new(code(r), code(g), code(b)));
            for triangle in &couple.mesh.triangles {
                // Every inner edge is drawn by one of its triangles, those of the border below.
                for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                    let (a, b) = (triangle[a], triangle[b]);
                    if a < b {
                        figure.line(&ring(&[a, b]), thin, widths[0]);
                    }
                }
            }
            for mut outline in rings {
                outline.extend(outline.first().copied());
                figure.line(&outline, dark, widths[1]);
            }
        }
    }
    figure
}
