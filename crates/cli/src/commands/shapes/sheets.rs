//! What a morph of shapes is like: its metrics, and pictures of what was matched.

use super::super::film::fill;
use super::Step;
use super::inputs::Input;
use crate::arguments::MorphOptions;
use crate::error::{Failure, say};
use anamorph_core::glam::DVec2;
use anamorph_io::outlines::{Drawing, Part, Rule};
use anamorph_morph::silhouette::{Measure, SilhouetteError, SilhouetteOptions, silhouette};
use anamorph_morph::strain::{METHODS, Settings, metrics};
use anamorph_preview::{Figure, Ink};
use anamorph_raster::Raster;
use serde_json::{Value, json};
use std::path::Path;

/// Methods that may turn triangles over.
const BASELINES: [&str; 2] = ["vertex-linear", "as-rigid-as-possible"];

/// Times at which morphs are measured.
const TIMES: usize = 20;

/// The outline of what is opaque in an image, or dark where it has no alpha.
pub(super) fn outline(raster: &Raster) -> Result<Drawing, SilhouetteError> {
    let channels = raster.channels();
    let options = SilhouetteOptions {
        measure: if matches!(channels, 2 | 4) {
            Measure::Channel(channels - 1)
        } else {
            Measure::Darkness
        },
        ..SilhouetteOptions::default()
    };
    let regions = silhouette(raster, &options)?;
    let rings = regions.into_iter().flat_map(|region| {
        let outer = core::iter::once(region.outer);
        outer.chain(region.holes)
    });
    let mut part = Part::of_rings("", None, rings);
    part.rule = Rule::EvenOdd;
    Ok(Drawing {
        parts: vec![part],
        canvas: Some([0.0, 0.0, raster.width() as f64, raster.height() as f64]),
        y_down: true,
        ..Drawing::default()
    })
}

/// Writes how good the morph is, beside in-betweens by other methods over the same meshes, and prints a table.
pub(super) fn metrics(
    path: &Path,
    options: &MorphOptions,
    inputs: &[Input],
    steps: &[Step],
) -> Result<(), Failure> {
    let times: Vec<f64> = (0..=TIMES).map(|i| i as f64 / TIMES as f64).collect();
    let mut all = Vec::new();
    for (number, step) in steps.iter().enumerate() {
        for (couple, own) in step.figure.couples().iter().enumerate() {
            let quality = couple_quality(own);
            let mut methods = Vec::new();
            for method in METHODS {
                let settings = Settings {
                    // Counted where nothing promises that there are none; the others are measured as they are drawn.
                    allow_flips: BASELINES.contains(&method.name),
                    ..Settings::default()
                };
                let found = method
                    .prepare(own.pair(), &settings)
                    .map_err(|error| error.to_string())
                    .and_then(|between| {
                        metrics::measure(own.pair(), &*between, &times)
                            .map_err(|error| error.to_string())
                    });
                methods.push(match found {
                    Ok(found) => {
                        if !options.quiet {
                            say!("{found}");
                        }
                        of_method(&found)
                    }
                    Err(error) => {
                        if !options.quiet {
                            say!("{}: {error}", method.name);
                        }
                        json!({ "method": method.name, "error": error })
                    }
                });
            }
            all.push(json!({
                "source": inputs[number].name,
                "target": inputs[number + 1].name,
                "couple": couple,
                "mesh": quality,
                "methods": methods,
            }));
        }
    }
    let text = serde_json::to_string_pretty(&json!({ "anamorph": "metrics", "morphs": all }))
        .map_err(Failure::new)?;
    fill(path, options.force, |out| {
        writeln!(out, "{text}").map_err(|error| Failure::written(path, &error))
    })
}

fn couple_quality(couple: &anamorph_morph::figures::Couple) -> Value {
    match couple.mesh.check() {
        Ok(quality) => json!({
            "points": quality.points,
            "triangles": quality.triangles,
            "triangles_of_overlay": couple.mesh.overlaid,
            "smallest_angle_source": quality.smallest_angle[0],
            "smallest_angle_target": quality.smallest_angle[1],
        }),
        Err(fault) => json!({ "fault": fault.to_string() }),
    }
}

fn of_method(found: &metrics::MorphMetrics) -> Value {
    let frames: Vec<Value> = found
        .frames
        .iter()
        .map(|frame| {
            json!({
                "time": frame.time,
                "area": frame.area,
                "flips": frame.flips,
                "smallest_determinant": frame.smallest_determinant,
                "symmetric_dirichlet": [frame.symmetric_dirichlet.mean, frame.symmetric_dirichlet.largest],
                "conformal": [frame.conformal.mean, frame.conformal.largest],
                "isometric": [frame.isometric.mean, frame.isometric.largest],
                "strain_difference": frame.strain_difference,
                "strain_overshoot": frame.strain_overshoot,
                "boundary_crossings": frame.crossings,
                "smallest_angle": frame.smallest_angle.to_degrees(),
                "newton_steps": frame.steps,
                "held_up": frame.held_up,
                "unfinished": frame.unfinished,
            })
        })
        .collect();
    json!({
        "method": found.method,
        "flips": found.flips(),
        "smallest_determinant": found.smallest_determinant(),
        "area_overshoot": found.area_overshoot,
        "area_reversal": found.area_reversal,
        "monotone_elements": found.monotone_elements,
        "elements": found.mesh.elements,
        "stretch_unevenness": found.stretch_unevenness,
        "boundary_crossings": found.crossings(),
        "median_newton_steps": found.median_steps(),
        "frames": frames,
    })
}

/// Draws both shapes of each step side by side, with a line between places that become each other.
pub(super) fn matching(
    path: &Path,
    options: &MorphOptions,
    inputs: &[Input],
    steps: &[Step],
) -> Result<(), Failure> {
    const SIDE: f64 = 420.0;
    const GAP: f64 = 120.0;
    const LINES: usize = 40;
    let grey = Ink::new(225, 228, 232);
    let dark = Ink::new(40, 44, 52);
    let height = SIDE * steps.len() as f64;
    let mut figure = Figure::new(2.0 * SIDE + GAP, height, Ink::new(255, 255, 255));
    for (number, step) in steps.iter().enumerate() {
        let place = |side: usize, p: DVec2| {
            let [x, y, w, h] = inputs[number + side].view;
            let scale = 0.9 * SIDE / w.max(h);
            let middle = DVec2::new(x + 0.5 * w, y + 0.5 * h);
            let centre = DVec2::new(
                0.5 * SIDE + side as f64 * (SIDE + GAP),
                (number as f64 + 0.5) * SIDE,
            );
            let p = centre + (p - middle) * scale;
            [p.x, p.y]
        };
        for couple in step.figure.couples() {
            let meshes = [&couple.mesh.source, &couple.mesh.target];
            for (side, points) in meshes.into_iter().enumerate() {
                let rings: Vec<Vec<[f64; 2]>> = couple
                    .mesh
                    .rings
                    .iter()
                    .map(|ring| {
                        ring.iter()
                            .map(|&i| place(side, points[i as usize]))
                            .collect()
                    })
                    .collect();
                figure.region(&rings, grey);
                for mut ring in rings {
                    ring.extend(ring.first().copied());
                    figure.line(&ring, dark, 1.2);
                }
            }
            for ring in &couple.mesh.rings {
                let every = ring.len().div_ceil(LINES).max(1);
                for (i, &point) in ring.iter().enumerate().step_by(every) {
                    let hue = core::f64::consts::TAU * i as f64 / ring.len() as f64;
                    let light = |shift: f64| (140.0 + 100.0 * (hue + shift).cos()) as u8;
                    let ink = Ink::new(light(0.0), light(2.1), light(4.2));
                    let [a, b] = [0, 1].map(|side| place(side, meshes[side][point as usize]));
                    figure.line(&[a, b], ink.fading(0.55), 0.8);
                    figure.disc(a, 2.4, ink);
                    figure.disc(b, 2.4, ink);
                }
            }
        }
    }
    write_figure(path, options.force, &figure, "what becomes what")
}

/// Writes a drawing as SVG or PNG, by the extension.
pub(super) fn write_figure(
    path: &Path,
    replace: bool,
    figure: &Figure,
    label: &str,
) -> Result<(), Failure> {
    let is_svg = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("svg"));
    let bytes = if is_svg {
        figure.svg(label).into_bytes()
    } else {
        let picture = figure.picture().map_err(Failure::new)?;
        picture.png().map_err(Failure::new)?
    };
    fill(path, replace, |out| {
        out.write_all(&bytes)
            .map_err(|error| Failure::written(path, &error))
    })
}
