//! `anamorph morph` of shapes: drawings, letters and outlines become one another.
//!
//! What the inputs are follows from their content: SVG, polygons, `GeoJSON` and fonts are shapes, and so are images with `--silhouette`. Each
//! step of a chain is a figure (module `figures` of `anamorph-morph`), prepared once; frames are drawn from it.

mod inputs;
pub(crate) mod mesh;
mod outputs;
mod pairs;
mod plots;
mod sheets;
mod textures;

use super::frames::{Frame, Frames};
use crate::arguments::MorphOptions;
use crate::error::{Failure, say};
use crate::files;
use crate::progress::Progress;
use crate::shape_arguments::ShapeOptions;
use anamorph_core::glam::DVec2;
use anamorph_curves::eases::Ease;
use anamorph_io::outlines::{Drawing, Fill, Part, Rule, mix_fill};
use anamorph_morph::figures::{Figure, FigureOptions};
use anamorph_morph::matching::Anchor;
use anamorph_morph::shapes::Pieces;
use anamorph_morph::strain::{self, Settings};
use inputs::Input;
use outputs::Output;
use pairs::Meshes;
use rayon::prelude::*;
use std::path::PathBuf;

/// Frames of a step if nothing is said.
const FRAMES: usize = 25;

/// Whether the inputs are shapes.
pub(crate) fn are_shapes(options: &MorphOptions) -> bool {
    options.shapes.silhouette || options.images.iter().any(|path| inputs::is_shape(path))
}

/// From one shape to the next.
struct Step {
    figure: Figure,
    /// Fills of both ends of each couple.
    fills: Vec<[Option<Fill>; 2]>,
}

/// Morphs what the arguments name.
pub(crate) fn run(options: &MorphOptions) -> Result<(), Failure> {
    on_threads(options.threads, || morph(options))
}

/// Works on so many threads.
fn on_threads(
    threads: Option<usize>,
    work: impl FnOnce() -> Result<(), Failure> + Send,
) -> Result<(), Failure> {
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = threads {
        pool = pool.num_threads(threads);
    }
    let pool = pool
        .build()
        .map_err(|error| Failure::new(format!("cannot start threads: {error}")))?;
    pool.install(work)
}

/// What is morphed: shapes to be matched, or meshes that are there already.
struct Sources {
    inputs: Vec<Input>,
    meshes: Option<Meshes>,
    /// Anchors of each step.
    anchors: Vec<Vec<Anchor>>,
    pieces: Pieces,
}

impl Sources {
    fn read(paths: &[PathBuf], options: &ShapeOptions) -> Result<Self, Failure> {
        let pieces = options.pieces.map(Into::into).unwrap_or_default();
        if let Some(path) = paths.iter().find(|path| inputs::is_pair(path)) {
            if paths.len() > 1 {
                return Err(Failure::usage(format!(
                    "{}: a pair of meshes is both shapes already; name it alone",
                    path.display()
                )));
            }
            if let Some(name) = options.given().filter(|name| *name != "--size") {
                return Err(Failure::usage(format!(
                    "{name}: only shapes have it; the input is a pair of meshes, matched already"
                )));
            }
            let (inputs, meshes) = pairs::read(path)?;
            return Ok(Self {
                inputs: inputs.into(),
                meshes: Some(meshes),
                anchors: vec![Vec::new()],
                pieces,
            });
        }
        let inputs = inputs::read(paths, options)?;
        Ok(Self {
            anchors: inputs::anchors(options, inputs.len())?,
            inputs,
            meshes: None,
            pieces,
        })
    }

    /// All steps, with in-betweens by a method.
    fn steps(&self, method: &strain::Method) -> Result<Vec<Step>, Failure> {
        if let Some(meshes) = &self.meshes {
            return Ok(vec![meshes.step(&self.inputs[0].name, method)?]);
        }
        let windows = self.inputs.windows(2).zip(&self.anchors);
        windows
            .map(|(ends, anchors)| {
                let options = FigureOptions {
                    pieces: self.pieces,
                    anchors: anchors.clone(),
                    settings: Settings::default(),
                    ..FigureOptions::default()
                };
                Step::new(ends, method, &options)
            })
            .collect()
    }
}

fn morph(options: &MorphOptions) -> Result<(), Failure> {
    refuse_options_of_images(options)?;
    let between = &options.between;
    let output = if between.texture.is_empty() {
        Some(Output::of(options)?)
    } else {
        textures::check_output(options)?;
        None
    };
    if let Some(path) = &between.strain_plot {
        plots::check(path)?;
    }
    let beside = [&between.metrics, &between.matching, &between.strain_plot];
    let results: Vec<&PathBuf> = beside.into_iter().flatten().collect();
    for (number, path) in results.iter().enumerate() {
        files::refuse_existing(path, options.force)?;
        let others = results[..number].iter().copied().chain([&options.output]);
        if others
            .into_iter()
            .any(|other| files::identity(other) == files::identity(path))
        {
            return Err(Failure::usage(format!(
                "{}: two results have this name; choose another for one",
                path.display()
            )));
        }
    }
    if let Some(output) = &output {
        output.check(options)?;
    }
    let sources = Sources::read(&options.images, &options.shapes)?;
    let inputs = &sources.inputs;
    let method = strain::method(between.scheme.as_deref().unwrap_or(strain::METHODS[0].name))
        .map_err(|error| Failure::usage(format!("--scheme: {error}")))?;
    let ease = options.ease.as_deref().unwrap_or("linear");
    let ease = anamorph_curves::eases::parse(ease)
        .map_err(|error| Failure::usage(format!("--ease: {error}")))?;
    let count = inputs.len() - 1;
    let frames = match options.at {
        Some(_) => None,
        None => Some(Frames::new(
            options.frames.unwrap_or(FRAMES * count),
            options.start,
            options.range,
            options.fps,
        )?),
    };
    let list: Vec<Frame> = match &frames {
        Some(frames) => frames.all().collect(),
        None => vec![Frame {
            number: 0,
            time: options.at.unwrap_or(0.0),
        }],
    };
    // An ease may go beyond both ends; shapes do not.
    let moments = list.iter().map(|frame| {
        let (step, time) = moment(frame.time, count);
        (step, ease.value(time).clamp(0.0, 1.0))
    });
    let moments: Vec<(usize, f64)> = moments.collect();
    let view = common_view(inputs);
    let steps = match &output {
        Some(output) => {
            let (drawings, steps) =
                all_frames(options, &sources, &method, &moments, |steps, step, time| {
                    let most = steps.iter().map(|step| step.fills.len()).max();
                    steps[step].draw(time, view, most.unwrap_or(0))
                })?;
            output.write(options, frames.as_ref(), &list, &drawings, &steps, &moments)?;
            steps
        }
        None => {
            let textures = textures::Textures::read(options, inputs, view)?;
            let (pieces, steps) =
                all_frames(options, &sources, &method, &moments, |steps, step, time| {
                    steps[step].figure.at(time)
                })?;
            textures.write(options, frames.as_ref(), &list, &pieces, &steps, &moments)?;
            steps
        }
    };
    if let Some(path) = &between.metrics {
        sheets::metrics(path, options, inputs, &steps)?;
    }
    if let Some(path) = &between.matching {
        sheets::matching(path, options, inputs, &steps)?;
    }
    if let Some(path) = &between.strain_plot {
        plots::write(path, options, inputs, &steps)?;
    }
    if !options.quiet {
        say_result(options, inputs, &steps, list.len());
    }
    Ok(())
}

/// What all frames show, on all cores, and the steps that it is of.
fn all_frames<T: Send>(
    options: &MorphOptions,
    sources: &Sources,
    method: &strain::Method,
    moments: &[(usize, f64)],
    draw: impl Fn(&[Step], usize, f64) -> Result<T, strain::FrameError> + Sync,
) -> Result<(Vec<T>, Vec<Step>), Failure> {
    let inputs = &sources.inputs;
    let all = |steps: &[Step]| -> Result<Vec<T>, (usize, strain::FrameError)> {
        let progress = Progress::new("morphing", moments.len(), options.quiet);
        let drawn: Vec<_> = moments
            .par_iter()
            .map(|&(step, time)| {
                let drawn = draw(steps, step, time);
                progress.add(1);
                drawn.map_err(|error| (step, error))
            })
            .collect();
        drawn.into_iter().collect()
    };
    let failed = |(step, error): (usize, strain::FrameError)| {
        let (from, to) = (&inputs[step].name, &inputs[step + 1].name);
        Failure::new(format!("{from} and {to}: {error}"))
    };
    let steps = sources.steps(method)?;
    let drawn = all(&steps).map_err(failed)?;
    Ok((drawn, steps))
}

/// Says what was made.
fn say_result(options: &MorphOptions, inputs: &[Input], steps: &[Step], frames: usize) {
    let names: Vec<&str> = inputs.iter().map(|input| input.name.as_str()).collect();
    say!(
        "{} -> {}",
        names.join(" -> "),
        files::shown_output(&options.output)
    );
    for (number, step) in steps.iter().enumerate() {
        let couples = step.figure.couples();
        let triangles: usize = couples.iter().map(|c| c.mesh.triangles.len()).sum();
        let parts = couples.len();
        let method = couples.first().map_or("", |c| c.between().name());
        let one = if parts == 1 { "part" } else { "parts" };
        say!(
            "  step {}: {parts} {one}, {triangles} triangles, {method}",
            number + 1
        );
    }
    for input in inputs {
        for note in &input.notes {
            say!("  note: {}: {note}", input.name);
        }
    }
    say!("  {frames} frames");
}

/// Options that only images have.
fn refuse_options_of_images(options: &MorphOptions) -> Result<(), Failure> {
    let given = [
        (!options.recipe.is_empty(), "--recipe"),
        (!options.landmarks.is_empty(), "--landmarks"),
        (options.method.is_some(), "--method"),
        (options.dissolve.is_some(), "--dissolve"),
        (!options.set.is_empty(), "--set"),
        (options.draw_features, "--draw-features"),
        (options.fit.is_some(), "--fit"),
        (options.report.is_some(), "--report"),
    ];
    match given.iter().find(|(given, _)| *given) {
        Some((_, name)) => Err(Failure::usage(format!(
            "{name}: only morphs of images have it; shapes are matched by their outlines (--anchors, --scheme)"
        ))),
        None => Ok(()),
    }
}

/// The step of a time, and the time within it.
fn moment(time: f64, steps: usize) -> (usize, f64) {
    let at = time * steps as f64;
    let step = (at.floor() as usize).min(steps.saturating_sub(1));
    (step, (at - step as f64).clamp(0.0, 1.0))
}

/// What is to be seen of all inputs: left, top, width, height.
fn common_view(inputs: &[Input]) -> [f64; 4] {
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for input in inputs {
        let [x, y, width, height] = input.view;
        low = low.min(DVec2::new(x, y));
        high = high.max(DVec2::new(x + width, y + height));
    }
    [low.x, low.y, high.x - low.x, high.y - low.y]
}

impl Step {
    fn new(
        ends: &[Input],
        method: &strain::Method,
        options: &FigureOptions,
    ) -> Result<Self, Failure> {
        let figure =
            Figure::new(&ends[0].parts, &ends[1].parts, method, options).map_err(|error| {
                Failure::new(format!("{} and {}: {error}", ends[0].name, ends[1].name))
            })?;
        let fill = |input: &Input, part: Option<usize>| part.and_then(|i| input.fills[i]);
        let fills = figure
            .couples()
            .iter()
            .map(|couple| [fill(&ends[0], couple.source), fill(&ends[1], couple.target)])
            .collect();
        Ok(Self { figure, fills })
    }

    /// What is between at `t`, with as many parts as asked for.
    fn draw(&self, t: f64, view: [f64; 4], parts: usize) -> Result<Drawing, strain::FrameError> {
        let mut drawing = Drawing {
            canvas: Some(view),
            y_down: true,
            parts: vec![Part::default(); parts],
            ..Drawing::default()
        };
        // What is not seen yet, or any more, has a fill all the same: it is the same part in all frames.
        for (part, [a, b]) in drawing.parts.iter_mut().zip(&self.fills) {
            part.fill = a
                .or(*b)
                .map(|[red, green, blue, _]| [red, green, blue, 0.0]);
        }
        for piece in self.figure.at(t)? {
            let [a, b] = self.fills[piece.couple];
            let mut part = Part::of_rings("", mix_fill(a, b, t), piece.rings);
            // Holes go the other way round; what comes to lie over itself is filled.
            part.rule = Rule::NonZero;
            drawing.parts[piece.couple] = part;
        }
        Ok(drawing)
    }
}
