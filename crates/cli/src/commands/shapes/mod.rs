//! `anamorph morph` of shapes: drawings, letters and outlines become one another.
//!
//! What the inputs are follows from their content: SVG, polygons, `GeoJSON` and fonts are shapes, and so are images with `--silhouette`. Each
//! step of a chain is a figure (module `figures` of `anamorph-morph`), prepared once; frames are drawn from it.

mod inputs;
mod outputs;
mod sheets;

use super::frames::{Frame, Frames};
use crate::arguments::MorphOptions;
use crate::error::{Failure, say};
use crate::files;
use crate::progress::Progress;
use anamorph_core::glam::DVec2;
use anamorph_curves::eases::Ease;
use anamorph_io::outlines::{Drawing, Fill, Part, Rule, mix_fill};
use anamorph_morph::figures::{Figure, FigureOptions};
use anamorph_morph::strain::{self, Settings};
use inputs::Input;
use outputs::Output;
use rayon::prelude::*;

/// Frames of a step if nothing is said.
const FRAMES: usize = 25;
/// What is taken where strain fields come to no end, and no scheme was asked for.
const INSTEAD: &str = "as-rigid-as-possible";

/// Whether the inputs are shapes.
pub(crate) fn are_shapes(options: &MorphOptions) -> bool {
    options.silhouette || options.images.iter().any(|path| inputs::is_shape(path))
}

/// From one shape to the next.
struct Step {
    figure: Figure,
    /// Fills of both ends of each couple.
    fills: Vec<[Option<Fill>; 2]>,
}

/// Morphs what the arguments name.
pub(crate) fn run(options: &MorphOptions) -> Result<(), Failure> {
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = options.threads {
        pool = pool.num_threads(threads);
    }
    let pool = pool
        .build()
        .map_err(|error| Failure::new(format!("cannot start threads: {error}")))?;
    pool.install(|| morph(options))
}

fn morph(options: &MorphOptions) -> Result<(), Failure> {
    refuse_options_of_images(options)?;
    let output = Output::of(options)?;
    for path in [&options.metrics, &options.matching].into_iter().flatten() {
        files::refuse_existing(path, options.force)?;
    }
    output.check(options)?;
    let inputs = inputs::read(options)?;
    let method = strain::method(options.scheme.as_deref().unwrap_or(strain::METHODS[0].name))
        .map_err(|error| Failure::usage(format!("--scheme: {error}")))?;
    let ease = options.ease.as_deref().unwrap_or("linear");
    let ease = anamorph_curves::eases::parse(ease)
        .map_err(|error| Failure::usage(format!("--ease: {error}")))?;
    let anchors = inputs::anchors(options, inputs.len())?;
    let figure_options = |step: usize| FigureOptions {
        pieces: options.pieces.map(Into::into).unwrap_or_default(),
        anchors: anchors[step].clone(),
        settings: Settings::default(),
        ..FigureOptions::default()
    };
    let prepare = |method: &strain::Method| -> Result<Vec<Step>, Failure> {
        let windows = inputs.windows(2).enumerate();
        windows
            .map(|(number, ends)| Step::new(ends, method, &figure_options(number)))
            .collect()
    };
    let mut steps = prepare(&method)?;
    let count = steps.len();
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
    let view = common_view(&inputs);
    let most = steps.iter().map(|step| step.fills.len()).max().unwrap_or(0);
    let draw = |steps: &[Step]| -> Result<Vec<Drawing>, (usize, strain::FrameError)> {
        let progress = Progress::new("morphing", list.len(), options.quiet);
        let drawn: Vec<_> = list
            .par_iter()
            .map(|frame| {
                let (step, time) = moment(frame.time, count);
                let drawing = steps[step].draw(ease.value(time), view, most);
                progress.add(1);
                drawing.map_err(|error| (step, error))
            })
            .collect();
        drawn.into_iter().collect()
    };
    let failed = |(step, error): (usize, strain::FrameError)| {
        let (from, to) = (&inputs[step].name, &inputs[step + 1].name);
        Failure::new(format!("{from} and {to}: {error}"))
    };
    let drawings = match draw(&steps) {
        Err((step, error @ strain::FrameError::Stalled { .. })) if options.scheme.is_none() => {
            say!(
                "  note: {} and {}: {error}; all is drawn by `{INSTEAD}` instead",
                inputs[step].name,
                inputs[step + 1].name
            );
            let instead = strain::method(INSTEAD).map_err(Failure::new)?;
            steps = prepare(&instead)?;
            draw(&steps).map_err(failed)?
        }
        other => other.map_err(failed)?,
    };
    output.write(options, frames.as_ref(), &list, &drawings, &steps)?;
    if let Some(path) = &options.metrics {
        sheets::metrics(path, options, &inputs, &steps)?;
    }
    if let Some(path) = &options.matching {
        sheets::matching(path, options, &inputs, &steps)?;
    }
    if !options.quiet {
        say_result(options, &inputs, &steps, list.len());
    }
    Ok(())
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
        // An ease may go beyond both ends; shapes do not.
        let t = t.clamp(0.0, 1.0);
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
            part.rule = Rule::EvenOdd;
            drawing.parts[piece.couple] = part;
        }
        Ok(drawing)
    }
}
