//! Where frames of shapes go: an animated SVG or Lottie, pictures, a GLB, or numbered files.

use super::super::film::fill;
use super::super::frames::{Frame, Frames, Pattern};
use super::Step;
use crate::arguments::MorphOptions;
use crate::error::Failure;
use crate::files;
use anamorph_core::glam::DVec2;
use anamorph_io::outlines::{
    Animation as Moving, Drawing, MeshFrames, Rounding, write_polygons, write_svg,
};
use anamorph_preview::{Animation, AnimationFormat, Figure, Ink, Picture};
use std::path::{Path, PathBuf};

/// Pixels of the longer side of pictures if nothing is said.
const SIZE: f64 = 512.0;

/// Further decimal places of the points of meshes.
const FINER: u8 = 8;

/// The form of a single file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Svg,
    Png,
    Polygons,
    Obj,
}

/// The form of the result.
pub(super) enum Output {
    Svg(PathBuf),
    Lottie(PathBuf),
    Film(PathBuf, AnimationFormat),
    Glb(PathBuf),
    /// A file for each step.
    GlbSteps(Pattern),
    Numbered(Pattern, Kind),
    Single(PathBuf, Kind),
}

impl Kind {
    fn of(extension: &str) -> Option<Self> {
        Some(match extension {
            "svg" => Self::Svg,
            "png" => Self::Png,
            "json" => Self::Polygons,
            "obj" => Self::Obj,
            _ => return None,
        })
    }
}

impl Output {
    /// What the arguments name.
    pub(super) fn of(options: &MorphOptions) -> Result<Self, Failure> {
        let path = &options.output;
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let extension = extension.as_deref().unwrap_or("");
        let forms = "shapes become an animated .svg, Lottie (.json), .gif, .apng or .glb, or numbered files such as out.%04d.svg, .png, .json \
                     or .obj; with --at one such file";
        let unknown = || Failure::usage(format!("{}: {forms}", files::shown_output(path)));
        if files::is_stream(path) {
            return Err(unknown());
        }
        let kind = Kind::of(extension);
        if options.at.is_some() {
            let kind = kind.ok_or_else(unknown)?;
            return Ok(Self::Single(path.clone(), kind));
        }
        if let Some(pattern) = Pattern::find(path)? {
            if extension == "glb" {
                return Ok(Self::GlbSteps(pattern));
            }
            return Ok(Self::Numbered(pattern, kind.ok_or_else(unknown)?));
        }
        Ok(match extension {
            "svg" => Self::Svg(path.clone()),
            "json" => Self::Lottie(path.clone()),
            "gif" => Self::Film(path.clone(), AnimationFormat::Gif),
            "apng" => Self::Film(path.clone(), AnimationFormat::Apng),
            "glb" => Self::Glb(path.clone()),
            "png" | "obj" => {
                return Err(Failure::usage(format!(
                    "{}: say where the frames' numbers go, as in out.%04d.{extension}, or ask for one with --at 0.5",
                    path.display()
                )));
            }
            _ => return Err(unknown()),
        })
    }

    /// Refuses results that exist or that are inputs.
    pub(super) fn check(&self, options: &MorphOptions) -> Result<(), Failure> {
        let inputs: Vec<PathBuf> = options.images.iter().map(|p| files::identity(p)).collect();
        let refuse = |path: &Path| {
            if inputs.contains(&files::identity(path)) {
                return Err(Failure::usage(format!(
                    "{}: the result would replace what it is made from; choose another name",
                    path.display()
                )));
            }
            files::refuse_existing(path, options.force)
        };
        match self {
            Self::Numbered(..) | Self::GlbSteps(_) => {
                let folder = files::folder_of(&options.output);
                if folder.is_dir() {
                    Ok(())
                } else {
                    Err(Failure::new(format!(
                        "{}: its folder does not exist; make it first",
                        options.output.display()
                    )))
                }
            }
            Self::Svg(path)
            | Self::Lottie(path)
            | Self::Film(path, _)
            | Self::Glb(path)
            | Self::Single(path, _) => refuse(path),
        }
    }

    /// Writes all frames.
    pub(super) fn write(
        &self,
        options: &MorphOptions,
        frames: Option<&Frames>,
        list: &[Frame],
        drawings: &[Drawing],
        steps: &[Step],
        moments: &[(usize, f64)],
    ) -> Result<(), Failure> {
        let rate = frames.map_or(24.0, Frames::rate);
        let view = drawings.first().map_or([0.0; 4], Drawing::view);
        let moving = Moving::new(drawings, rate);
        match self {
            Self::Svg(path) => fill(path, options.force, |out| {
                moving.write_svg(out).map_err(Failure::new)
            }),
            Self::Lottie(path) => fill(path, options.force, |out| {
                moving.write_lottie(out).map_err(Failure::new)
            }),
            Self::Film(path, format) => fill(path, options.force, |out| {
                let mut film =
                    Animation::new(out, *format, drawings.len(), rate).map_err(Failure::new)?;
                for drawing in drawings {
                    film.push(&picture(drawing, options)?)
                        .map_err(Failure::new)?;
                }
                film.finish().map_err(Failure::new)
            }),
            Self::Glb(path) => {
                let [step] = steps else {
                    return Err(Failure::usage(format!(
                        "{}: each step of a chain has a mesh of its own, which no animation can exchange; say where the steps' numbers go, as \
                         in out.%d.glb",
                        path.display()
                    )));
                };
                let times: Vec<f64> = moments.iter().map(|(_, time)| *time).collect();
                glb(path, options, step, &times, rate, view)
            }
            Self::GlbSteps(pattern) => {
                let paths: Vec<PathBuf> =
                    (1_i64..).zip(steps).map(|(i, _)| pattern.path(i)).collect();
                for path in &paths {
                    files::refuse_existing(path, options.force)?;
                }
                // Each goes from one end to the other.
                let count = (moments.len().saturating_sub(1))
                    .div_ceil(steps.len())
                    .max(1);
                let times: Vec<f64> = (0..=count).map(|i| i as f64 / count as f64).collect();
                for (step, path) in steps.iter().zip(&paths) {
                    glb(path, options, step, &times, rate, view)?;
                }
                Ok(())
            }
            Self::Single(path, kind) => one(path, *kind, options, &drawings[0], steps, moments[0]),
            Self::Numbered(pattern, kind) => {
                for frame in list {
                    files::refuse_existing(&pattern.path(frame.number), options.force)?;
                }
                for ((frame, drawing), moment) in list.iter().zip(drawings).zip(moments) {
                    let path = pattern.path(frame.number);
                    one(&path, *kind, options, drawing, steps, *moment)?;
                }
                Ok(())
            }
        }
    }
}

fn one(
    path: &Path,
    kind: Kind,
    options: &MorphOptions,
    drawing: &Drawing,
    steps: &[Step],
    (step, time): (usize, f64),
) -> Result<(), Failure> {
    let rounding = Rounding::for_drawing(drawing);
    fill(path, options.force, |out| match kind {
        Kind::Svg => write_svg(drawing, None, out).map_err(Failure::new),
        Kind::Polygons => write_polygons(drawing, 1e-3, rounding, out).map_err(Failure::new),
        Kind::Png => {
            let bytes = picture(drawing, options)?.png().map_err(Failure::new)?;
            out.write_all(&bytes)
                .map_err(|error| Failure::written(path, &error))
        }
        Kind::Obj => {
            let (triangles, places) = mesh(&steps[step], time)?;
            let all = [places];
            let textures = textures(&steps[step], drawing.view());
            let frames = MeshFrames {
                triangles: &triangles,
                frames: &all,
                textures: Some(&textures),
                y_down: true,
                fill: None,
                rate: 24.0,
            };
            // What is thin must not become flat.
            let fine = Rounding::places(rounding.decimals() + FINER);
            let written = frames.write_obj(0, fine, out);
            written.map(|_| ()).map_err(Failure::new)
        }
    })
}

/// A frame as pixels on white.
pub(super) fn picture(drawing: &Drawing, options: &MorphOptions) -> Result<Picture, Failure> {
    let [x, y, width, height] = drawing.view();
    let scale = options.shapes.size.unwrap_or(SIZE) / width.max(height);
    let mut figure = Figure::new(
        (width * scale).ceil().max(1.0),
        (height * scale).ceil().max(1.0),
        Ink::new(255, 255, 255),
    );
    for part in &drawing.parts {
        let Some([r, g, b, opacity]) = part.fill else {
            continue;
        };
        let code = |light: f64| (light.clamp(0.0, 1.0) * 255.0).round() as u8;
        let ink = Ink {
            rgb: [code(r), code(g), code(b)],
            opacity,
        };
        let place = |p: DVec2| [(p.x - x) * scale, (p.y - y) * scale];
        let rings: Vec<Vec<[f64; 2]>> = part
            .contours
            .iter()
            .map(|contour| contour.points().map(place).collect())
            .collect();
        figure.region(&rings, ink);
    }
    figure.picture().map_err(Failure::new)
}

/// Triangles and places of all couples of a step at a time.
fn mesh(step: &Step, t: f64) -> Result<(Vec<[u32; 3]>, Vec<DVec2>), Failure> {
    let (mut triangles, mut places) = (Vec::new(), Vec::new());
    for couple in step.figure.couples() {
        let first = places.len() as u32;
        triangles.extend(couple.mesh.triangles.iter().map(|t| t.map(|i| i + first)));
        places.extend(couple.places(t).map_err(Failure::new)?);
    }
    Ok((triangles, places))
}

/// Texture coordinates of the points of a step, the same in all frames: where they are on the canvas in the source, `v` upwards.
fn textures(step: &Step, [x, y, width, height]: [f64; 4]) -> Vec<DVec2> {
    let couples = step.figure.couples().iter();
    let points = couples.flat_map(|couple| &couple.mesh.source);
    let place = |p: &DVec2| DVec2::new((p.x - x) / width, 1.0 - (p.y - y) / height);
    points.map(place).collect()
}

/// One mesh with the frames as morph targets.
fn glb(
    path: &Path,
    options: &MorphOptions,
    step: &Step,
    times: &[f64],
    rate: f64,
    view: [f64; 4],
) -> Result<(), Failure> {
    let mut frames = Vec::new();
    let mut triangles = Vec::new();
    for time in times {
        let (corners, places) = mesh(step, *time)?;
        triangles = corners;
        frames.push(places);
    }
    let textures = textures(step, view);
    let frames = MeshFrames {
        triangles: &triangles,
        frames: &frames,
        textures: Some(&textures),
        y_down: true,
        fill: step.fills.first().and_then(|fills| fills[0].or(fills[1])),
        rate,
    };
    let mut storage = std::io::Cursor::new(Vec::new());
    fill(path, options.force, |out| {
        frames
            .write_glb(&mut storage, out)
            .map(|_| ())
            .map_err(Failure::new)
    })
}
