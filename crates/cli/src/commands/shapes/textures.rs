//! Morphs of shapes with images on them: frames are pictures.
//!
//! The image of a shape lies over the canvas of its file, edge on edge: over the canvas of a drawing, over the image itself where the shape is its
//! silhouette.

use super::super::film::{Output, Writing};
use super::super::frames::{Frame, Frames};
use super::super::sequence::Record;
use super::Step;
use super::inputs::Input;
use crate::arguments::MorphOptions;
use crate::error::{Failure, say};
use crate::files;
use anamorph_core::glam::DVec2;
use anamorph_io::Lost;
use anamorph_io::images::{EncodeOptions, ImageFile, ImageFormat, ImageLimits};
use anamorph_morph::figures::Piece;
use anamorph_morph::texture::{self, Sheet, Textured};
use anamorph_raster::{Edge, Filter, Raster, Sampler, Window};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Pixels of a side of a frame at most.
const MOST: f64 = 16_384.0;
/// The channels of frames.
const NAMES: [&str; 4] = ["R", "G", "B", "A"];

/// Refuses results that are no pictures.
pub(super) fn check_output(options: &MorphOptions) -> Result<(), Failure> {
    let path = &options.output;
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    if let Some(extension @ ("svg" | "json" | "obj" | "glb")) = extension.as_deref() {
        return Err(Failure::usage(format!(
            "{}: --texture draws pixels, and .{extension} holds outlines or meshes; name numbered images (out.%04d.png), a film (.gif, .apng, \
             .y4m), or with --at one image",
            path.display()
        )));
    }
    Output::of(path, options.at.is_some()).map(|_| ())
}

/// The images of all shapes, and how frames are drawn.
pub(super) struct Textures {
    images: Vec<Raster>,
    /// Where each canvas lies on its image.
    sheets: Vec<Sheet>,
    frame: Sheet,
    window: Window,
    /// The form of the result.
    template: ImageFile,
    filter: Filter,
    edge: Edge,
}

/// An image as red, green, blue and alpha, from its corner.
fn raster(path: &Path, options: &MorphOptions) -> Result<(ImageFile, Raster), Failure> {
    let shown = files::shown(path);
    let failed = |error: &dyn std::fmt::Display| Failure::new(format!("{shown}: {error}"));
    let bytes = files::read(path)?;
    let limits = if options.pixels.allow_large {
        ImageLimits::NONE
    } else {
        ImageLimits::of_file(bytes.len())
    };
    let file = ImageFile::read(&bytes, limits).map_err(|error| failed(&error))?;
    let found = file.colours().map_err(|error| failed(&error))?;
    let (width, height) = (found.width(), found.height());
    let mut samples = Vec::with_capacity(4 * width * height);
    for pixel in found.samples().chunks_exact(found.channels()) {
        samples.extend(match *pixel {
            [grey] => [grey, grey, grey, 1.0],
            [grey, alpha] => [grey, grey, grey, alpha],
            [r, g, b] => [r, g, b, 1.0],
            [r, g, b, a, ..] => [r, g, b, a],
            [] => [0.0; 4],
        });
    }
    let window = Window::new(0, 0, width, height).map_err(|error| failed(&error))?;
    let raster = Raster::from_samples(window, 4, samples).map_err(|error| failed(&error))?;
    Ok((file, raster))
}

/// The pixels of a frame.
fn size(
    options: &MorphOptions,
    first: &Input,
    image: &Raster,
    [_, _, width, height]: [f64; 4],
) -> Result<[usize; 2], Failure> {
    let own = [image.width() as f64, image.height() as f64];
    let scale = match options.shapes.size {
        Some(size) => size / width.max(height),
        None => own[0] / first.canvas[2],
    };
    let mut sides = [width * scale, height * scale];
    // An image of the canvas's own form keeps its size.
    if (0..2).all(|i| (sides[i] - own[i]).abs() <= 1.0) {
        sides = own;
    }
    if sides.iter().any(|side| *side > MOST) {
        return Err(Failure::usage(format!(
            "frames would have {:.0} × {:.0} pixels; give the longer side, as in --size 1024",
            sides[0], sides[1]
        )));
    }
    Ok(sides.map(|side| side.round().max(1.0) as usize))
}

impl Textures {
    /// Reads the images.
    pub(super) fn read(
        options: &MorphOptions,
        inputs: &[Input],
        view: [f64; 4],
    ) -> Result<Self, Failure> {
        let paths = &options.between.texture;
        if paths.len() != inputs.len() {
            return Err(Failure::usage(format!(
                "--texture: there are {} shapes and {} images; give an image for each",
                inputs.len(),
                paths.len()
            )));
        }
        let pixels = &options.pixels;
        let filter = pixels.filter.as_deref().map(Filter::by_name).transpose();
        let filter = filter.map_err(|error| Failure::usage(format!("--filter: {error}")))?;
        let edge = pixels.edge.as_deref().map(Edge::by_name).transpose();
        let edge = edge.map_err(|error| Failure::usage(format!("--edge: {error}")))?;
        let (mut images, mut sheets, mut template) = (Vec::new(), Vec::new(), None);
        for (path, input) in paths.iter().zip(inputs) {
            let (file, image) = raster(path, options)?;
            let [.., width, height] = input.canvas;
            let (across, down) = (image.width(), image.height());
            let wanted = across as f64 * height / width;
            if (wanted - down as f64).abs() > 1.0 && !options.quiet {
                say!(
                    "  note: {}: it has {across} × {down} pixels, and the canvas of {} is {} × {} units; the image is stretched over it",
                    files::shown(path),
                    input.name,
                    files::short(width),
                    files::short(height)
                );
            }
            sheets.push(Sheet::new(input.canvas, across, down));
            if template.is_none() {
                template = Some(if file.format() == ImageFormat::OpenExr {
                    ImageFile::data(&image, &NAMES).map_err(Failure::new)?
                } else {
                    file.with_channels(0, &NAMES).map_err(Failure::new)?
                });
            }
            images.push(image);
        }
        let Some(mut template) = template.map(|file| file.without_pixels()) else {
            return Err(Failure::usage("--texture: name an image for each shape"));
        };
        let [width, height] = size(options, &inputs[0], &images[0], view)?;
        let window = Window::new(0, 0, width, height).map_err(Failure::new)?;
        template.set_display(window).map_err(Failure::new)?;
        Ok(Self {
            images,
            sheets,
            frame: Sheet::new(view, width, height),
            window,
            template,
            filter: filter.unwrap_or(Filter::ANISOTROPIC),
            edge: edge.unwrap_or(Edge::Clamp),
        })
    }

    /// Draws and writes all frames.
    pub(super) fn write(
        &self,
        options: &MorphOptions,
        frames: Option<&Frames>,
        list: &[Frame],
        pieces: &[Vec<Piece>],
        steps: &[Step],
        moments: &[(usize, f64)],
    ) -> Result<(), Failure> {
        let output = Output::of(&options.output, options.at.is_some())?;
        let writing = Writing {
            path: &options.output,
            force: options.force,
            encoding: EncodeOptions {
                quality: options.pixels.quality.unwrap_or(95),
                whole: false,
            },
            size: [self.window.width(), self.window.height()],
            frames,
        };
        let read = options.images.iter().chain(&options.between.texture);
        let read: Vec<PathBuf> = read.chain(&options.shapes.anchors).cloned().collect();
        output.check(&writing, None, &read)?;
        let samplers: Vec<Sampler<'_>> = self
            .images
            .iter()
            .map(|image| Sampler::new(image, self.filter, self.edge))
            .collect();
        let is_film = matches!(output, Output::Animation(..) | Output::Y4m);
        let mut lost = Lost::default();
        let mut drawn = pieces.iter().zip(moments);
        let all: std::collections::HashMap<i64, _> = list
            .iter()
            .filter_map(|frame| Some((frame.number, drawn.next()?)))
            .collect();
        let written = output.write(
            &writing,
            list,
            &|| self.record(options, &read, frames),
            &mut |frame| {
                let Some((pieces, moment)) = all.get(&frame.number) else {
                    return Err(Failure::new("a frame of the morph is missing"));
                };
                let mut raster = self.draw(pieces, steps, **moment, &samplers)?;
                if is_film {
                    before_white(&mut raster);
                }
                let mut image = self.template.clone();
                for layer in image.layers_mut() {
                    layer.raster = Some(raster.clone());
                }
                Ok(image)
            },
            &mut lost,
        )?;
        if !options.quiet {
            super::super::frames::kept(written.kept, written.again);
            if let Some(frames) = frames {
                output.say_rate(frames);
            }
            // That films stand before white is meant.
            lost.0.retain(|what| !what.starts_with("alpha"));
            if !lost.is_empty() {
                say!("  warning: the result does not hold: {lost}");
            }
        }
        Ok(())
    }

    fn draw(
        &self,
        pieces: &[Piece],
        steps: &[Step],
        (step, t): (usize, f64),
        samplers: &[Sampler<'_>],
    ) -> Result<Raster, Failure> {
        struct Own<'a> {
            piece: &'a Piece,
            places: Vec<DVec2>,
            rings: Vec<Vec<DVec2>>,
            images: [Vec<DVec2>; 2],
            dissolve: f64,
            opacity: f64,
        }
        let couples = steps[step].figure.couples();
        let own = pieces.iter().filter_map(|piece| {
            let mesh = &couples[piece.couple].mesh;
            let (dissolve, opacity) = match steps[step].fills[piece.couple] {
                [Some(_), Some(_)] => (t, 1.0),
                // What appears or goes away has one image only, and fades.
                [Some(_), None] => (0.0, 1.0 - t),
                [None, Some(_)] => (1.0, t),
                [None, None] => return None,
            };
            Some(Own {
                piece,
                places: self.frame.pixels(&piece.places),
                rings: piece.rings.iter().map(|r| self.frame.pixels(r)).collect(),
                images: [
                    self.sheets[step].pixels(&mesh.source),
                    self.sheets[step + 1].pixels(&mesh.target),
                ],
                dissolve,
                opacity,
            })
        });
        let own: Vec<Own<'_>> = own.collect();
        let meshes: Vec<Textured<'_>> = own
            .iter()
            .map(|own| Textured {
                triangles: &couples[own.piece.couple].mesh.triangles,
                places: &own.places,
                rings: &own.rings,
                images: [&own.images[0], &own.images[1]],
                dissolve: own.dissolve,
                opacity: own.opacity,
            })
            .collect();
        texture::draw(&meshes, [&samplers[step], &samplers[step + 1]], self.window)
            .map_err(Failure::new)
    }

    /// What tells these frames from others.
    fn record(
        &self,
        options: &MorphOptions,
        read: &[PathBuf],
        frames: Option<&Frames>,
    ) -> Result<Record, Failure> {
        let mut prints = Vec::new();
        for path in read {
            let print = files::fingerprint(&files::read(path)?).0;
            prints.push(format!("{print:016x}"));
        }
        let shapes = &options.shapes;
        Ok(Record(json!({
            "anamorph": "frames",
            "shapes": prints,
            "matching": [
                json!(shapes.text),
                json!(shapes.silhouette),
                json!(shapes.tolerance),
                json!(shapes.pieces.map(|pieces| format!("{pieces:?}"))),
            ],
            "between": [json!(options.between.scheme), json!(options.ease)],
            "drawing": [
                json!(self.filter.name()),
                json!(self.edge.name()),
                json!([self.window.width(), self.window.height()]),
                json!(options.pixels.quality),
            ],
            "frames": frames.map(Frames::count),
            "first": frames.map(Frames::first),
        })))
    }
}

/// Films have no opacity: what is transparent is white.
fn before_white(raster: &mut Raster) {
    let (pixels, _) = raster.samples_mut().as_chunks_mut::<4>();
    for pixel in pixels {
        let beyond = 1.0 - pixel[3];
        for light in pixel {
            *light += beyond;
        }
    }
}
