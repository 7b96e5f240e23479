//! `anamorph morph`: images become one another, frame by frame.
//!
//! Each step of a chain has its features; a frame is drawn from the two images it lies between. Images and series are read when they are
//! needed: three pictures and the frame are in memory, however long the film is.

mod batch;
mod form;
pub(crate) mod overlay;
mod sources;
mod steps;

use super::film::{Output, Writing, Written};
use super::frames::{Frame, Frames};
use super::sequence::Record;
use crate::arguments::{FitName, MorphOptions};
use crate::error::{Failure, say};
use crate::files::{self, Pending, short};
use crate::meshes::RecipeFiles;
use crate::progress::Progress;
use anamorph_core::glam::DVec2;
use anamorph_io::Lost;
use anamorph_io::images::{EncodeOptions, ImageFile, ImageFormat};
use anamorph_morph::images::{Accuracy, Drawing, Mixer};
use anamorph_raster::{Edge, Filter, Hierarchy, Raster, Window};
use anamorph_recipe::Recipe;
use form::Form;
use serde_json::{Value, json};
use sources::{Image, Source};
use std::path::PathBuf;
use steps::{Lie, Step};

/// Data windows together may have this many times the pixels that the images show.
const GROWTH: usize = 16;
/// Pixels that data windows may have however small the images are.
const SMALL: usize = 1 << 22;
/// Frames of a step if nothing is said.
const FRAMES: usize = 25;

/// Morphs what the arguments name.
pub(crate) fn run(options: &MorphOptions) -> Result<(), Failure> {
    if let Some(list) = &options.batch {
        return batch::run(list, options);
    }
    if super::shapes::are_shapes(options) {
        return super::shapes::run(options);
    }
    if let [path] = &options.images[..] {
        // What cannot be read is said first.
        files::read(path)?;
    }
    if options.images.len() < 2 {
        return Err(Failure::usage(
            "a morph goes from one image or shape to another; name two or more",
        ));
    }
    // A file that is not there is said before what would be asked of it; names of series stand for others.
    let lost = |path: &&PathBuf| {
        !files::is_stream(path) && !path.exists() && !path.to_string_lossy().contains('%')
    };
    if let Some(path) = options.images.iter().find(lost) {
        files::read(path)?;
    }
    if options.recipe.is_empty() && options.landmarks.is_empty() {
        return Err(Failure::usage(
            "images are matched by landmarks, -l/--landmarks A.json B.json, or by the features of a recipe, -r/--recipe",
        ));
    }
    refuse_options_of_shapes(options)?;
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = options.threads {
        pool = pool.num_threads(threads);
    }
    let pool = pool
        .build()
        .map_err(|error| Failure::new(format!("cannot start threads: {error}")))?;
    pool.install(|| Morph::prepare(options)?.write())
}

/// Options that only shapes have.
fn refuse_options_of_shapes(options: &MorphOptions) -> Result<(), Failure> {
    match options.shapes.given().or(options.between.given()) {
        Some(name) => Err(Failure::usage(format!(
            "{name}: only morphs of shapes have it; the inputs are images (--silhouette takes their outlines)"
        ))),
        None => Ok(()),
    }
}

/// The places of features, a list each.
pub(crate) type Places = Vec<Vec<DVec2>>;

/// Frames between two images of one layer, at times from 0 to 1, each with the places of its features.
pub(crate) fn frames(
    images: [&ImageFile; 2],
    recipe: Recipe,
    beside: RecipeFiles,
    times: &[f64],
) -> Result<Vec<(Raster, Places)>, Failure> {
    let display = images[0].display();
    let lies = [images[0], images[1]].map(|image| Lie::of(image.display(), display, None, "image"));
    let [first, second] = lies;
    let lies = [&first?, &second?];
    let mut step = Step::new(recipe, beside);
    step.prepare(lies, ["image", "image"])?;
    let rasters = images.map(ImageFile::colours);
    let [first, second] = rasters;
    let (first, second) = (first.map_err(Failure::new)?, second.map_err(Failure::new)?);
    let mut mixer = Mixer::new(first.window(), display, first.channels()).map_err(Failure::new)?;
    let drawing = Drawing {
        filter: Filter::ANISOTROPIC,
        edge: Edge::Clamp,
        max_error: Hierarchy::default().max_error,
    };
    let mut frames = Vec::new();
    for &time in times {
        let between = step.between(time, lies)?;
        let ways = [
            (first.as_ref(), between.back(0)),
            (second.as_ref(), between.back(1)),
        ];
        let drawn = mixer
            .draw(ways, between.dissolve, &drawing)
            .map_err(Failure::new)?;
        frames.push((drawn.clone(), between.places));
    }
    Ok(frames)
}

/// Everything that is known before the first frame.
struct Morph<'a> {
    options: &'a MorphOptions,
    sources: Vec<Source>,
    steps: Vec<Step>,
    lies: Vec<Lie>,
    /// Features of each step, in words.
    features: Vec<String>,
    frames: Option<Frames>,
    output: Output,
    filter: Filter,
    /// The first picture of the first source: its form is that of the result.
    template: ImageFile,
    /// The channels that all images are brought to, and what that changes, in words.
    form: Form,
    notes: Vec<String>,
    /// Pixels of each layer in the result, and what stands beyond.
    layers: Vec<Layer>,
}

/// A layer of the result.
#[derive(Clone, Copy)]
struct Layer {
    window: Window,
    channels: usize,
    edge: Edge,
}

/// What drawing the frames so far has brought.
#[derive(Default)]
struct Known {
    /// The pictures that the last frame was made of, by source and number.
    images: Vec<(usize, usize, Image)>,
    /// Frames in which an image is turned over somewhere, and where the first is.
    folded: Vec<(Frame, DVec2)>,
}

impl<'a> Morph<'a> {
    fn prepare(options: &'a MorphOptions) -> Result<Self, Failure> {
        files::at_most_one_stream(options.images.iter().chain(&options.recipe))?;
        if options.images.iter().any(|path| files::is_stream(path)) {
            return Err(Failure::usage(
                "images of a morph are read when they are needed; name files",
            ));
        }
        let named = |name: &Option<String>| name.as_deref().map(Filter::by_name).transpose();
        let filter = named(&options.pixels.filter)
            .map_err(|error| Failure::usage(format!("--filter: {error}")))?
            .unwrap_or(Filter::ANISOTROPIC);
        let edge = options
            .pixels
            .edge
            .as_deref()
            .map(Edge::by_name)
            .transpose();
        let edge = edge.map_err(|error| Failure::usage(format!("--edge: {error}")))?;
        let output = Output::of(&options.output, options.at.is_some())?;
        let source = |path: &PathBuf| Source::of(path, options.pixels.allow_large);
        let sources: Vec<Source> = options
            .images
            .iter()
            .map(source)
            .collect::<Result<_, _>>()?;
        let mut steps = steps::steps(options, sources.len())?;
        let frames = Self::frames(options, &sources)?;
        let writing = writing(options, frames.as_ref(), [0; 2]);
        let report = options.report.as_ref();
        output.check(&writing, report, &inputs(options, &sources))?;

        let first = sources[0].read(0)?;
        let frame = first.display();
        let mut lies = vec![Lie::of(frame, frame, None, &first.name)?];
        let mut form = Form::of(&first);
        let mut others = Vec::new();
        let mut open: Vec<bool> = (0..first.file.layers().len())
            .map(|i| first.is_open(i))
            .collect();
        let mut windows: Vec<Option<Window>> = first
            .file
            .layers()
            .iter()
            .map(anamorph_io::images::ImageLayer::window)
            .collect();
        for source in &sources[1..] {
            let image = source.read(0)?;
            form.join(&image)?;
            let lie = Lie::of(image.display(), frame, options.fit, &image.name)?;
            for (i, (open, window)) in open.iter_mut().zip(&mut windows).enumerate() {
                *open |= image.is_open(i) || options.fit == Some(FitName::Contain);
                let own = image.file.layers()[i].window();
                let own = own
                    .map(|own| lie.window_in(own, frame))
                    .transpose()?
                    .flatten();
                *window = match (*window, own) {
                    (Some(a), Some(b)) => Some(a.union(&b).map_err(Failure::new)?),
                    (a, b) => a.or(b),
                };
            }
            lies.push(lie);
            others.push(Image {
                file: image.file.without_pixels(),
                name: image.name,
            });
        }
        let all = std::iter::once(&first).chain(&others);
        let notes = all.filter_map(|image| form.changes(image)).collect();
        let first = form.fit(first)?;
        for ((path, lie), source) in options.landmarks.iter().zip(&lies).zip(&sources) {
            steps::check_landmarks(path, lie, source.name())?;
        }
        let mut features = Vec::new();
        let names = sources.windows(2);
        for ((step, pair), names) in steps.iter_mut().zip(lies.windows(2)).zip(names) {
            let names = [names[0].name(), names[1].name()];
            let (title, count) = step.prepare([&pair[0], &pair[1]], names)?;
            features.push(format!("{title}, {count} features"));
            step.beside()
                .refuse_replacing(options.report.iter().chain([&options.output]))?;
        }
        if let Some(frames) = frames.as_ref().filter(|_| steps.iter().all(Step::is_light)) {
            // What cannot be drawn is found before anything is.
            for frame in frames.all() {
                let (step, time) = moment(frame.time, steps.len());
                let lies = [&lies[step], &lies[step + 1]];
                steps[step]
                    .between(time, lies)
                    .map_err(|failure| at_frame(failure, &frame))?;
            }
        }
        let most = lies
            .iter()
            .filter_map(|lie| lie.display().pixels())
            .sum::<usize>();
        let most = most.saturating_mul(GROWTH).max(SMALL);
        for window in windows.iter().flatten() {
            if !options.pixels.allow_large && window.pixels().is_none_or(|pixels| pixels > most) {
                return Err(Failure::new(format!(
                    "{}: the data windows of the images together reach over {window}, far more than they show; crop them, or add \
                     --allow-large",
                    options.images[0].display()
                )));
            }
        }
        let layer = |((layer, window), open): (
            (&anamorph_io::images::ImageLayer, Option<Window>),
            bool,
        )| Layer {
            window: window.unwrap_or(frame),
            channels: layer.raster.as_ref().map_or(0, Raster::channels),
            edge: edge.unwrap_or(if open { Edge::Transparent } else { Edge::Clamp }),
        };
        let layers = first
            .file
            .layers()
            .iter()
            .zip(windows)
            .zip(open)
            .map(layer)
            .collect();
        if first
            .file
            .layers()
            .iter()
            .any(|layer| layer.identifiers.is_some())
        {
            return Err(Failure::new(format!(
                "{}: it has channels of whole numbers, which name things and cannot be mixed; leave them out of the file",
                first.name
            )));
        }
        Ok(Self {
            options,
            sources,
            steps,
            lies,
            features,
            frames,
            output,
            filter,
            template: first.file.without_pixels(),
            form,
            notes,
            layers,
        })
    }

    fn frames(options: &MorphOptions, sources: &[Source]) -> Result<Option<Frames>, Failure> {
        if options.at.is_some() {
            return Ok(None);
        }
        let longest = sources.iter().map(Source::count).max().unwrap_or(1);
        let usual = if longest > 1 {
            longest
        } else {
            FRAMES * (sources.len() - 1)
        };
        let count = options.frames.unwrap_or(usual);
        Frames::new(count, options.start, options.range, options.fps).map(Some)
    }

    /// All frames, to where they go.
    fn write(mut self) -> Result<(), Failure> {
        let output = std::mem::take(&mut self.output);
        let mut report_file = match &self.options.report {
            Some(path) => Some(Pending::create(path, self.options.force)?),
            None => None,
        };
        let list: Vec<Frame> = match &self.frames {
            Some(frames) => frames.all().collect(),
            None => vec![Frame {
                number: 0,
                time: self.options.at.unwrap_or(0.0),
            }],
        };
        let progress = Progress::new("morphing", list.len(), self.options.quiet);
        let mut mixers = Vec::new();
        for layer in &self.layers {
            mixers.push(
                Mixer::new(layer.window, self.template.display(), layer.channels.max(1))
                    .map_err(Failure::new)?,
            );
        }
        let mut known = Known::default();
        let mut lost = Lost::default();
        let shown = self.template.display();
        let size = [shown.width(), shown.height()];
        let written = output.write(
            &writing(self.options, self.frames.as_ref(), size),
            &list,
            &|| self.record(),
            &mut |frame| {
                let image = self.draw(frame, &mut mixers, &mut known)?;
                progress.add(1);
                Ok(image)
            },
            &mut lost,
        )?;
        drop(progress);
        let accuracy =
            mixers
                .iter()
                .map(|mixer| mixer.accuracy)
                .fold(Accuracy::default(), |a, b| Accuracy {
                    maps: a.maps + b.maps,
                    max_error: a.max_error.max(b.max_error),
                    measured: a.measured.max(b.measured),
                    estimated: a.estimated || b.estimated,
                    evaluations: a.evaluations + b.evaluations,
                    pixels: a.pixels + b.pixels,
                });
        if let Some(mut file) = report_file.take() {
            let text = serde_json::to_string_pretty(&self.report(&list, &accuracy, &lost))
                .map_err(Failure::new)?;
            file.fill(|out| writeln!(out, "{text}"))?;
            files::keep_all([file])?;
        }
        if !self.options.quiet {
            self.summary(&list, written, &accuracy, &lost);
            if let Some(frames) = &self.frames {
                output.say_rate(frames);
            }
            self.say_folds(&known);
        }
        Ok(())
    }

    /// The frame as an image in the form of the first.
    fn draw(
        &self,
        frame: &Frame,
        mixers: &mut [Mixer],
        known: &mut Known,
    ) -> Result<ImageFile, Failure> {
        let count = self.steps.len();
        let (step, time) = moment(frame.time, count);
        let ends = [step, step + 1];
        let lies = ends.map(|end| &self.lies[end]);
        let between = self.steps[step].between(time, lies);
        let between = between.map_err(|failure| match self.frames {
            Some(_) => at_frame(failure, frame),
            None => failure,
        })?;
        let numbers = ends.map(|end| {
            let source = &self.sources[end];
            match &self.frames {
                Some(frames) => {
                    source.at(usize::try_from(frame.number - frames.first()).unwrap_or(0))
                }
                None => source.at((frame.time * (source.count() - 1) as f64).round() as usize),
            }
        });
        known.images.retain(|(source, number, _)| {
            ends.iter()
                .zip(numbers)
                .any(|(end, wanted)| (*source, *number) == (*end, wanted))
        });
        for (end, number) in ends.into_iter().zip(numbers) {
            if known
                .images
                .iter()
                .any(|(s, n, _)| (*s, *n) == (end, number))
            {
                continue;
            }
            let image = self.fitting(end, self.sources[end].read(number)?)?;
            known.images.push((end, number, image));
        }
        let find = |end: usize| known.images.iter().find(|(source, ..)| *source == end);
        let (Some((.., first)), Some((.., second))) = (find(ends[0]), find(ends[1])) else {
            return Err(Failure::new("an image of the morph is missing"));
        };
        let frame_window = self.lies[0].display();
        if let Some(place) = (0..2).find_map(|image| between.fold(image, frame_window)) {
            known.folded.push((*frame, place));
        }
        // The ends are the images themselves, with all that their files hold.
        for (image, share) in [(first, 1.0 - between.dissolve), (second, between.dissolve)]
            .into_iter()
            .enumerate()
            .map(|(i, (image, share))| (image, if between.is_still(i) { share } else { 0.0 }))
        {
            if share == 1.0 && !self.options.draw_features && self.is_like_result(&image.file) {
                return Ok(image.file.clone());
            }
        }
        let mut result = self.template.without_pixels();
        for (number, (layer, mixer)) in self.layers.iter().zip(mixers).enumerate() {
            let rasters = [first, second].map(|image| image.file.layers()[number].raster.as_ref());
            let [Some(a), Some(b)] = rasters else {
                continue;
            };
            let drawing = Drawing {
                filter: self.filter,
                edge: layer.edge,
                max_error: self
                    .options
                    .pixels
                    .max_error
                    .unwrap_or(Hierarchy::default().max_error),
            };
            let drawn = mixer
                .draw(
                    [(a, between.back(0)), (b, between.back(1))],
                    between.dissolve,
                    &drawing,
                )
                .map_err(Failure::new)?;
            let mut drawn = drawn.clone();
            if self.options.draw_features && drawn.channels() <= 4 {
                overlay::draw(&mut drawn, &between.places, overlay::INK);
            }
            result.layers_mut()[number].raster = Some(drawn);
        }
        Ok(result)
    }

    /// A picture in the form of all. Refuses one of a series that is not like the first.
    fn fitting(&self, end: usize, image: Image) -> Result<Image, Failure> {
        let image = self.form.fit(image)?;
        let lie = &self.lies[end];
        if image.display() != lie.display() {
            return Err(Failure::new(format!(
                "{}: it is {} × {} pixels, and the first of its series {} × {}; make them alike",
                image.name,
                image.display().width(),
                image.display().height(),
                lie.display().width(),
                lie.display().height()
            )));
        }
        Ok(image)
    }

    /// Whether an image has the form of the result.
    fn is_like_result(&self, image: &ImageFile) -> bool {
        let layers = image.layers().iter().zip(self.template.layers());
        let mut pairs = layers.zip(&self.layers);
        image.format() == self.template.format()
            && pairs.all(|((own, template), layer)| {
                own.channels() == template.channels() && own.window() == Some(layer.window)
            })
    }

    fn say_folds(&self, known: &Known) {
        let Some((frame, place)) = known.folded.first() else {
            return;
        };
        let (x, y) = (short(place.x), short(place.y));
        match (&self.frames, known.folded.len()) {
            (None, _) => say!("  warning: it folds over around ({x}, {y})"),
            (_, 1) => say!(
                "  warning: frame {} folds over around ({x}, {y})",
                frame.number
            ),
            (_, count) => say!(
                "  warning: {count} frames fold over, the first, {}, around ({x}, {y})",
                frame.number
            ),
        }
    }

    /// What tells these frames from others: what their inputs hold, and the options that they depend on.
    fn record(&self) -> Result<Record, Failure> {
        let options = self.options;
        let print = |number: u64| format!("{number:016x}");
        let mut images = Vec::new();
        for source in &self.sources {
            let mut pictures = Vec::new();
            for path in source.paths() {
                pictures.push(print(files::fingerprint(&files::read(path)?).0));
            }
            images.push(pictures);
        }
        let steps = self.steps.iter().map(|step| {
            let read = step.beside().fingerprints();
            let read: Vec<String> = read.into_iter().map(|(_, number)| print(number)).collect();
            json!([print(step.recipe().fingerprint()), read])
        });
        let pixels = &options.pixels;
        Ok(Record(json!({
            "anamorph": "frames",
            "images": images,
            "recipes": steps.collect::<Vec<_>>(),
            "drawing": [
                pixels.filter,
                pixels.edge,
                pixels.max_error,
                pixels.quality,
                options.fit.map(|fit| format!("{fit:?}")),
                options.draw_features,
            ],
            "frames": self.frames.as_ref().map(Frames::count),
            "first": self.frames.as_ref().map(Frames::first),
        })))
    }

    fn report(&self, frames: &[Frame], accuracy: &Accuracy, lost: &Lost) -> Value {
        let names: Vec<&str> = self.sources.iter().map(Source::name).collect();
        let display = self.template.display();
        json!({
            "anamorph": env!("CARGO_PKG_VERSION"),
            "images": names,
            "output": files::shown_output(&self.options.output),
            "steps": self.features,
            "size": [display.width(), display.height()],
            "frames": {
                "count": frames.len(),
                "first": frames.first().map(|frame| frame.number),
                "last": frames.last().map(|frame| frame.number),
                "times": frames.iter().map(|frame| frame.time).collect::<Vec<_>>(),
                "fps": self.frames.as_ref().map(Frames::rate),
            },
            "filter": self.filter.name(),
            "map": {
                "max_error": accuracy.max_error,
                "kind": if accuracy.estimated { "estimate" } else { "bound" },
                "measured": accuracy.measured,
                "evaluations": accuracy.evaluations,
                "pixels": accuracy.pixels,
            },
            "lost": lost.0,
        })
    }

    fn summary(&self, frames: &[Frame], written: Written, accuracy: &Accuracy, lost: &Lost) {
        let names: Vec<&str> = self.sources.iter().map(Source::name).collect();
        let display = self.template.display();
        say!(
            "{} -> {}: {}; {} × {} pixels",
            names.join(", "),
            files::shown_output(&self.options.output),
            self.features.join("; "),
            display.width(),
            display.height()
        );
        if let Some(all) = &self.frames {
            let rate = all.rate();
            say!(
                "  {} frames{}",
                frames.len(),
                if written.is_film {
                    format!(
                        ", {} seconds at {} a second",
                        short(frames.len() as f64 / rate),
                        short(rate)
                    )
                } else {
                    String::new()
                }
            );
            super::frames::kept(written.kept, written.again);
        }
        if accuracy.maps > 0 {
            let promise = if accuracy.estimated {
                "an estimate"
            } else {
                "a bound"
            };
            say!(
                "  filter {}; maps within {} px ({promise}; largest error measured {} px), {} evaluations for {} pixels",
                self.filter.name(),
                short(accuracy.max_error),
                short(accuracy.measured),
                accuracy.evaluations,
                accuracy.pixels
            );
        }
        let covers = self.template.has_alpha() || self.template.format() == ImageFormat::OpenExr;
        let open = self
            .layers
            .iter()
            .any(|layer| layer.edge == Edge::Transparent);
        if open && !covers {
            say!(
                "  note: what no image covers is black, because they have no alpha; --edge clamp goes on with their borders"
            );
        }
        for note in self.notes.iter().chain(self.template.notes()) {
            say!("  note: {note}");
        }
        if !lost.is_empty() {
            say!("  warning: the result does not hold: {lost}");
        }
    }
}

/// The step of a chain at a time, and its own time: the last frame belongs to the last step.
fn moment(time: f64, steps: usize) -> (usize, f64) {
    let along = time * steps as f64;
    let step = (along.floor() as usize).min(steps - 1);
    (step, along - step as f64)
}

/// A failure with the frame in which it is.
fn at_frame(failure: Failure, frame: &Frame) -> Failure {
    match failure {
        Failure::Message(text) => Failure::Message(format!("frame {}: {text}", frame.number)),
        failure => failure,
    }
}

/// All files that are read.
fn inputs(options: &MorphOptions, sources: &[Source]) -> Vec<PathBuf> {
    let pictures = sources.iter().flat_map(|source| source.paths().iter());
    let others = options.recipe.iter().chain(&options.landmarks);
    pictures.chain(others).cloned().collect()
}

/// How frames are written.
fn writing<'a>(
    options: &'a MorphOptions,
    frames: Option<&'a Frames>,
    size: [usize; 2],
) -> Writing<'a> {
    Writing {
        path: &options.output,
        force: options.force,
        encoding: EncodeOptions {
            quality: options.pixels.quality.unwrap_or(95),
            whole: false,
        },
        size,
        frames,
    }
}
