//! A recipe over time as numbered files: which of them are finished, what made them, and how a film of them is framed.
//!
//! Beside the frames lies a record of what they were made from. Frames of another recipe, model or count are never mixed with new ones.

use super::frames::{self, Frame, Frames, Pattern};
use super::jobs::Job;
use super::warp::{Run, form, warp_document, whole};
use crate::error::Failure;
use crate::files::{self, Pending};
use crate::meshes::RecipeFiles;
use crate::model::{self, ModelSpace};
use anamorph_core::{Bounds, Fingerprint, Plane, Solid, Space, map_all_parallel};
use anamorph_io::images::{ImageFile, ImageFormat, ImageLimits};
use anamorph_io::{Document, Points, ReadOptions};
use serde_json::{Value, json};
use std::collections::HashSet;

use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Whether a result is there and holds something.
pub(super) fn is_finished(path: &Path) -> bool {
    path.metadata().is_ok_and(|m| m.is_file() && m.len() > 0)
}

/// Whether a frame is there, whole, and a picture of that format and size.
pub(super) fn is_picture(path: &Path, format: ImageFormat, size: Option<[usize; 2]>) -> bool {
    let Ok(bytes) = std::fs::read(path) else {
        return false;
    };
    // Decoders forgive an end that is missing.
    let whole = match format {
        ImageFormat::Png => bytes.ends_with(b"IEND\xaeB`\x82"),
        ImageFormat::Jpeg => bytes.ends_with(b"\xff\xd9"),
        _ => true,
    };
    let image = ImageFile::read(&bytes, ImageLimits::NONE);
    image.is_ok_and(|image| {
        let shown = [image.display().width(), image.display().height()];
        whole && image.format() == format && size.is_none_or(|size| size == shown)
    })
}

/// Refuses names by which any frame would replace what it is made from.
fn refuse_inputs(
    model: &Path,
    run: &Run<'_>,
    frames: &Frames,
    patterns: [Option<&Pattern>; 3],
) -> Result<(), Failure> {
    let known = |path: &Path| (!files::is_stream(path)).then(|| files::identity(path));
    let inputs = [
        ("model", known(model)),
        ("recipe", known(run.options.recipe_path())),
    ];
    for frame in frames.all() {
        for path in patterns.iter().flatten().map(|p| p.path(frame.number)) {
            if !path.exists() {
                continue;
            }
            let identity = Some(files::identity(&path));
            if let Some((what, _)) = inputs.iter().find(|(_, input)| *input == identity) {
                return Err(Failure::usage(format!(
                    "{}: a frame would replace the {what}; choose another name",
                    path.display()
                )));
            }
            run.beside.refuse_replacing([&path])?;
        }
    }
    Ok(())
}

/// What a series of frames was made from.
pub(super) struct Record(pub(super) Value);

impl Record {
    fn of(document: &dyn Document, run: &Run<'_>, frames: &Frames) -> Self {
        let model = match document.points() {
            Points::Plane(points) => Fingerprint::of(points),
            Points::Solid(points) => Fingerprint::of(points),
        };
        Self::new(model, run, frames)
    }

    /// Of a model with that fingerprint.
    pub(super) fn new(model: Fingerprint, run: &Run<'_>, frames: &Frames) -> Self {
        Self(json!({
            "anamorph": "frames",
            "model": format!("{:016x}", model.0),
            "recipe": format!("{:016x}", run.recipe.fingerprint()),
            "inverse": run.options.invert,
            "frames": frames.count(),
            "first": frames.first(),
        }))
    }

    /// The same with one thing more that the frames depend on.
    pub(super) fn with(mut self, name: &str, value: Value) -> Self {
        self.0[name] = value;
        self
    }

    /// Whether the record that is there says the same; frames that exist and are not of this making are refused.
    pub(super) fn check(
        &self,
        path: &Path,
        force: bool,
        frames: &Frames,
        output: &Pattern,
    ) -> Result<bool, Failure> {
        let text = std::fs::read(path).unwrap_or_default();
        let there: Option<Value> = serde_json::from_slice(&text).ok();
        if there.as_ref() == Some(&self.0) {
            return Ok(true);
        }
        if path.exists() && !force && there.is_none_or(|v| v["anamorph"] != "frames") {
            return Err(Failure::usage(format!(
                "{}: the record of the frames would replace this file; choose another name, or say --force",
                path.display()
            )));
        }
        if force && let Some(other) = frames.others().map(|n| output.path(n)).find(|p| p.exists()) {
            return Err(Failure::usage(format!(
                "{}: this frame is outside of --range, and of other inputs, options or number of frames; write the whole series \
                 anew, without --range, or choose another name",
                other.display()
            )));
        }
        let mut existing = frames.all().map(|frame| output.path(frame.number));
        match existing.find(|path| path.exists()) {
            Some(frame) if !force => Err(Failure::usage(format!(
                "{}: this file exists, and is no frame of these inputs, options and number of frames ({} says what was made); \
                 --force makes them anew, or choose another name",
                frame.display(),
                path.display()
            ))),
            _ => Ok(false),
        }
    }

    /// Begins the series: frames of another making go before the record does, so that no run ever takes them for its own.
    pub(super) fn begin(
        &self,
        path: &Path,
        frames: &Frames,
        output: &Pattern,
    ) -> Result<(), Failure> {
        let frames = frames.all().map(|frame| output.path(frame.number));
        for frame in frames.filter(|path| path.is_file()) {
            match std::fs::remove_file(&frame) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                    return Err(Failure::written(&frame, &error));
                }
                _ => {}
            }
        }
        let mut file = Pending::create(path, true)?;
        let text = serde_json::to_string_pretty(&self.0).map_err(Failure::new)?;
        file.fill(|out| writeln!(out, "{text}"))?;
        files::keep_all([file])
    }
}

/// The bounds of the model over all frames, so that a film of pictures keeps its frame.
fn all_of_it<S: ModelSpace>(
    run: &Run<'_>,
    frames: &Frames,
    document: &dyn Document,
) -> Result<Option<[Solid; 2]>, Failure> {
    let rest = S::points(document.points()).unwrap_or_default();
    let visible = document.visible().min(rest.len());
    let mut around = Bounds::of(&rest[..visible]);
    for frame in frames.all() {
        let recipe = run.recipe.at(frame.time).map_err(Failure::new)?;
        let built = model::build(&recipe, document, rest, &run.beside)?;
        let mut moved = rest.to_vec();
        let stack = whole(&recipe, run.options, &built, model::size(&rest[..visible]));
        let _ = map_all_parallel(&stack, &mut moved, &|_| {});
        around = match (around, Bounds::of(&moved[..visible])) {
            (Some(a), Some(b)) => Some(a.union(b)),
            (a, b) => a.or(b),
        };
    }
    let lift = |p: S| {
        Solid::from_fn(|axis| {
            if axis < S::DIM {
                p.component(axis)
            } else {
                0.0
            }
        })
    };
    Ok(around.map(|b| [lift(b.min), lift(b.max)]))
}

/// The names of the frames of a series, and of what is written beside each.
pub(super) struct Series {
    pub(super) output: Pattern,
    report: Option<Pattern>,
    preview: Option<Pattern>,
}

impl Series {
    pub(super) fn of(job: &Job) -> Result<Self, Failure> {
        let pattern = |path: &Option<PathBuf>, what| {
            path.as_deref()
                .map(|path| Pattern::of(path, what))
                .transpose()
        };
        Ok(Self {
            output: Pattern::of(&job.output, "--output")?,
            report: pattern(&job.report, "--report")?,
            preview: pattern(&job.preview, "--preview")?,
        })
    }

    /// Refuses names by which a frame would replace what it is made from.
    pub(super) fn refuse_inputs(
        &self,
        model: &Path,
        run: &Run<'_>,
        frames: &Frames,
    ) -> Result<(), Failure> {
        let patterns = [
            Some(&self.output),
            self.report.as_ref(),
            self.preview.as_ref(),
        ];
        refuse_inputs(model, run, frames, patterns)
    }

    /// Warps all frames of a range but those that are finished, the recipe standing at the time of each.
    pub(super) fn write(
        &self,
        job: &Job,
        run: &Run<'_>,
        frames: &Frames,
        around: Option<[Solid; 2]>,
        is_done: &dyn Fn(&Path) -> bool,
        mut warp: impl FnMut(&Job, &Run<'_>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let options = run.options;
        let (mut kept, mut again) = (0, 0);
        for frame in frames.all() {
            let named = |pattern: &Option<Pattern>| pattern.as_ref().map(|p| p.path(frame.number));
            let job = Job {
                model: job.model.clone(),
                output: self.output.path(frame.number),
                report: named(&self.report),
                preview: named(&self.preview),
            };
            if !options.force {
                let done = |(path, is_frame): (&PathBuf, bool)| {
                    is_finished(path) && (!is_frame || is_done(path))
                };
                if job.results().all(done) {
                    kept += 1;
                    continue;
                }
                again += usize::from(job.output.exists() && !done((&job.output, true)));
            }
            warp(&job, &at(run, &frame, around)?)?;
        }
        if !options.quiet {
            frames::kept(kept, again);
            frames.say_length();
        }
        Ok(())
    }
}

/// The run at the time of a frame.
pub(super) fn at<'a>(
    run: &Run<'a>,
    frame: &Frame,
    around: Option<[Solid; 2]>,
) -> Result<Run<'a>, Failure> {
    let options = run.options;
    Ok(Run {
        recipe: run.recipe.at(frame.time).map_err(Failure::new)?,
        beside: RecipeFiles::beside(options.recipe_path(), options.allow_outside),
        options,
        taken: Mutex::new(HashSet::new()),
        replace: true,
        rest: None,
        around,
        at_rest: frame.time == 0.0,
    })
}

/// All frames of a range, the model read once.
pub(super) fn warp_frames(job: &Job, run: &Run<'_>, frames: &Frames) -> Result<(), Failure> {
    let options = run.options;
    let series = Series::of(job)?;
    let recipe = &run.recipe;
    let read_options = ReadOptions::default()
        .allow_nonfinite(options.allow_nonfinite)
        .local(recipe.is_local());
    let document = model::read(&job.model, &read_options, options.allow_outside)?;
    series.refuse_inputs(&job.model, run, frames)?;
    let last = Frame {
        number: 0,
        time: 1.0,
    };
    let last = at(run, &last, None)?;
    // What a recipe reads is known when it is built.
    match document.points() {
        Points::Plane(rest) => {
            model::build(&last.recipe, document.as_ref(), rest, &last.beside)?;
        }
        Points::Solid(rest) => {
            model::build(&last.recipe, document.as_ref(), rest, &last.beside)?;
        }
    }
    let beside = last.beside.fingerprints().into_iter();
    let beside: Vec<String> = beside.map(|(_, print)| format!("{print:016x}")).collect();
    let record = Record::of(document.as_ref(), run, frames).with("beside", json!(beside));
    let record_path = series.output.record();
    let known = record.check(&record_path, options.force, frames, &series.output)?;
    let around = match (&series.preview, document.points()) {
        (None, _) => None,
        (_, Points::Plane(_)) => all_of_it::<Plane>(run, frames, document.as_ref())?,
        (_, Points::Solid(_)) => all_of_it::<Solid>(run, frames, document.as_ref())?,
    };
    if !known {
        record.begin(&record_path, frames, &series.output)?;
    }
    series.write(job, run, frames, around, &|_| true, |job, run| {
        let form = form(job, document.as_ref())?;
        match document.points() {
            Points::Plane(_) => warp_document::<Plane>(job, run, document.as_ref(), form),
            Points::Solid(_) => warp_document::<Solid>(job, run, document.as_ref(), form),
        }
    })
}
