//! `anamorph warp`: models in, a recipe, warped models out.

use super::animation;
use super::bind::bound_stack;
use super::frames::{self, Frames, Pattern};
use super::image;
use super::image_frames;
use super::jobs::{Job, is_folder, jobs};
use super::promises::{fold, promises, to_json};
use super::sequence::warp_frames;
use super::undone::Undone;
use crate::arguments::WarpOptions;
use crate::companions::Copies;
use crate::error::{Failure, say};
use crate::files::{self, Pending};
use crate::meshes::RecipeFiles;
use crate::model::{self, ModelSpace};
use crate::painted::Painted;
use crate::picture;
use crate::progress::Progress;
use anamorph_core::{
    Bounds, Deformation, Domain, Inverse, Linear, Plane, Solid, Space, carry_normal, carry_tangent,
    map_all_parallel,
};
use anamorph_io::{Document, Lost, Moved, Normals, Points, ReadOptions, WriteReport};
use anamorph_recipe::{BuiltRecipe, Recipe};
use serde_json::{Value, json};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

pub(crate) fn run(options: &WarpOptions) -> Result<(), Failure> {
    let frames = Frames::of(options)?;
    let of_image = options.models.iter().any(|model| image::is_image(model));
    if frames.is_some() {
        frames::check(options, of_image)?;
    }
    let jobs = jobs(options)?;
    if frames.is_some() && !of_image {
        image::refuse_options(options)?;
    }
    if options.preview.is_some() {
        picture::check(&options.view, options.turntable.is_some())
            .map_err(|error| Failure::usage(format!("--size: {error}")))?;
        for path in jobs.iter().filter_map(|job| job.preview.as_ref()) {
            picture::Kind::of(path, options.turntable)?;
        }
    }
    let recipe = match &options.recipe {
        Some(path) => model::read_recipe(path, &options.set)?,
        None => Recipe::read(b"version = 1\n", "no recipe").map_err(Failure::new)?,
    };
    let beside = RecipeFiles::beside(options.recipe_path(), options.allow_outside);
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = options.threads {
        pool = pool.num_threads(threads);
    }
    let pool = pool
        .build()
        .map_err(|error| Failure::new(format!("cannot start threads: {error}")))?;
    let known = |path: &PathBuf| (!files::is_immediate(path)).then(|| files::identity(path));
    let results = jobs.iter().flat_map(Job::results).map(|(path, _)| path);
    let inputs = jobs
        .iter()
        .map(|job| &job.model)
        .chain(&options.recipe)
        .chain(&options.image.from_stmap);
    let run = Run {
        recipe,
        beside,
        options,
        taken: Mutex::new(results.chain(inputs).filter_map(known).collect()),
        replace: options.force,
        rest: rest_model(options)?,
        around: None,
        at_rest: false,
    };
    let mut made = Vec::new();
    let result = pool.install(|| match &frames {
        Some(frames) if of_image => image_frames::warp_frames(&jobs[0], &run, frames),
        Some(frames) if Pattern::is_animation(&jobs[0].output) => {
            animation::animate(&jobs[0], &run, frames)
        }
        Some(frames) => warp_frames(&jobs[0], &run, frames),
        None => warp_all(&jobs, &run, &mut made),
    });
    files::remove_empty(&made);
    result
}

/// What all jobs share.
pub(super) struct Run<'a> {
    pub(super) recipe: Recipe,
    pub(super) beside: RecipeFiles,
    pub(super) options: &'a WarpOptions,
    /// Files that copies of companions must not replace: inputs, results, and copies made for other models.
    pub(super) taken: Mutex<HashSet<PathBuf>>,
    /// Whether results may replace what exists.
    pub(super) replace: bool,
    /// The model as it was, where what is undone has other bounds.
    pub(super) rest: Option<Box<dyn Document>>,
    /// What pictures must have room for beside the model: two corners.
    pub(super) around: Option<[Solid; 2]>,
    /// Whether the recipe stands at the time when nothing has moved yet.
    pub(super) at_rest: bool,
}

/// The model that `--rest` names.
fn rest_model(options: &WarpOptions) -> Result<Option<Box<dyn Document>>, Failure> {
    let Some(path) = &options.rest else {
        return Ok(None);
    };
    model::read(path, &ReadOptions::default(), options.allow_outside).map(Some)
}

impl Run<'_> {
    /// Begins copies of the files that a model refers to.
    pub(super) fn copies(&self, document: &dyn Document, job: &Job) -> Result<Copies, Failure> {
        Copies::begin(document, &job.model, &job.output, self.replace, &|target| {
            self.beside.refuse_replacing([target])?;
            let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
            Ok(taken.insert(files::identity(target)))
        })
    }
}

/// All jobs, one after the other; one that fails does not keep the others from being done. Adds the folders it makes to
/// `made`.
fn warp_all(jobs: &[Job], run: &Run<'_>, made: &mut Vec<PathBuf>) -> Result<(), Failure> {
    let options = run.options;
    let folders = [
        Some(&options.output),
        options.report.as_ref(),
        options.preview.as_ref(),
    ];
    for path in folders.into_iter().flatten() {
        if is_folder(path) && !path.is_dir() {
            made.extend(files::make_folder(path)?);
        }
    }
    let mut failed = false;
    for job in jobs {
        match warp_one(job, run) {
            Ok(()) => {}
            Err(failure) if jobs.len() == 1 => return Err(failure),
            Err(failure) => {
                failure.print();
                failed = true;
            }
        }
    }
    if failed {
        Err(Failure::Reported)
    } else {
        Ok(())
    }
}

/// All of a recipe's warps, or what undoes them.
pub(super) fn whole<S: ModelSpace>(
    recipe: &Recipe,
    options: &WarpOptions,
    built: &BuiltRecipe<S>,
    size: f64,
) -> Box<dyn Deformation<S>> {
    if recipe.is_inverse() == options.invert {
        Box::new(built.stack())
    } else {
        Box::new(Inverse::new(built.stack(), size))
    }
}

/// Whether a file's name ends so.
fn is_extension_of(path: &Path, extension: &str) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

/// The form in which a model is written.
#[derive(Clone, Copy)]
pub(super) enum Form {
    /// The file's own, to the byte where nothing moves.
    Own,
    /// Another that holds all of it; by name.
    Sister(&'static str),
    /// Another that may not.
    Other(&'static anamorph_io::Target),
}

/// The form that the name of the output asks for.
pub(super) fn form(job: &Job, document: &dyn Document) -> Result<Form, Failure> {
    let Some(extension) = job.output.extension().and_then(|e| e.to_str()) else {
        return Ok(Form::Own);
    };
    let extension = extension.to_ascii_lowercase();
    let has = |known: &[&str]| known.contains(&extension.as_str());
    let other = anamorph_io::formats().iter().find(|f| has(f.extensions()));
    if other.is_some_and(|format| format.name() == document.format()) {
        return Ok(Form::Own);
    }
    let mut sisters = document.sisters().iter();
    if let Some(sister) = sisters.find(|name| other.is_some_and(|f| f.name() == **name)) {
        return Ok(Form::Sister(sister));
    }
    let target = anamorph_io::targets().iter().find(|t| has(t.extensions));
    if let (None, Some(other)) = (target, other) {
        let names: Vec<&str> = anamorph_io::targets().iter().map(|t| t.name).collect();
        return Err(Failure::new(format!(
            "{}: the model is {} and cannot become {}; name the output .{}, or one of these: .{}",
            job.output.display(),
            document.format().to_uppercase(),
            other.name().to_uppercase(),
            document.format(),
            names.join(", .")
        )));
    }
    if target.is_none() && !is_extension_of(&job.model, &extension) {
        say!(
            "{}: .{extension} is the name of no format that is written; the file is {}",
            job.output.display(),
            document.format().to_uppercase()
        );
    }
    Ok(target.map_or(Form::Own, Form::Other))
}

fn warp_one(job: &Job, run: &Run<'_>) -> Result<(), Failure> {
    let (options, recipe) = (run.options, &run.recipe);
    for (path, _) in job.results() {
        files::refuse_existing(path, options.force)?;
    }
    let read_options = ReadOptions::default()
        .allow_nonfinite(options.allow_nonfinite)
        .local(recipe.is_local());
    let bytes = files::read(&job.model)?;
    if image::concerns(&job.model, &bytes) {
        return image::warp(job, run, &bytes);
    }
    image::refuse_options(options)?;
    let document = model::document(bytes, &job.model, &read_options, options.allow_outside)?;
    let form = form(job, document.as_ref())?;
    match document.points() {
        Points::Plane(_) => warp_document::<Plane>(job, run, document.as_ref(), form),
        Points::Solid(_) => warp_document::<Solid>(job, run, document.as_ref(), form),
    }
}

pub(super) fn warp_document<S: ModelSpace>(
    job: &Job,
    run: &Run<'_>,
    document: &dyn Document,
    form: Form,
) -> Result<(), Failure> {
    let (options, recipe, beside) = (run.options, &run.recipe, &run.beside);
    let name = files::shown(&job.model);
    let rest = S::points(document.points()).unwrap_or_default();
    let built = match &run.rest {
        None => model::build(recipe, document, rest, beside)?,
        Some(unwarped) => {
            let points = S::points(unwarped.points()).ok_or_else(|| {
                Failure::usage("--rest: that model lies in another space than this one")
            })?;
            model::build(recipe, unwarped.as_ref(), points, beside)?
        }
    };
    beside.refuse_replacing(job.results().map(|(path, _)| path))?;
    let visible = document.visible().min(rest.len());
    let size = model::size(&rest[..visible]);
    let inverted = recipe.is_inverse() != options.invert;
    let stack: Box<dyn Deformation<S>> = match &options.binding {
        Some(_) if inverted => {
            return Err(Failure::usage(
                "a binding moves the model as the recipe does; leave out `mapping = \"inverse\"`",
            ));
        }
        Some(path) => Box::new(bound_stack(path, &built, rest, &name, options.quiet)?),
        None => whole(recipe, options, &built, size),
    };

    let mut moved = rest.to_vec();
    let progress = Progress::new("warping", moved.len(), options.quiet);
    let stayed = move_all(&stack, document, &mut moved, &progress);
    drop(progress);
    let undone = inverted.then(|| Undone::measure(&built.stack(), rest, &moved, &stayed));
    refuse_overflow(&name, &stayed, inverted)?;

    // All files are begun before any is written, and the model comes last but for its report: what goes to standard output
    // cannot be taken back.
    let begin = |path: &PathBuf| Pending::create(path, run.replace);
    let mut model_file = begin(&job.output)?;
    let mut report_file = job.report.as_ref().map(begin).transpose()?;
    let mut preview_file = job.preview.as_ref().map(begin).transpose()?;
    let mut copies = run.copies(document, job)?;
    let mut painted = None;
    if let (Some(file), Some(path)) = (&mut preview_file, &job.preview) {
        let kind = picture::Kind::of(path, options.turntable)?;
        let (before, after) = (&rest[..visible], &moved[..visible]);
        if let Some(field) = options.preview_field {
            let numbers = Painted::new(field, &built, &stack, before, after, size)?;
            painted = Some(numbers);
        }
        let subject = picture::Subject::new(document, before, after, &built);
        let subject = subject
            .painted(painted.as_ref())
            .undoing(inverted)
            .within(run.around);
        let mut failed = None;
        file.fill(|out| {
            failed = subject.write(&options.view, kind, out).err();
            Ok(())
        })?;
        if let Some(error) = failed {
            return Err(Failure::new(format!(
                "{name}: cannot draw the preview: {error}"
            )));
        }
    }
    let policy = normals_policy(document, &built, &stack, options);
    let mut report = WriteReport::default();
    let (mut lost, mut refused) = (Lost::default(), None);
    let written = model_file.fill(|out| {
        let written = with_directions(
            &stack,
            document,
            size,
            policy,
            &moved,
            |wrapped| match form {
                Form::Own => document.write(wrapped, out),
                Form::Sister(name) => document.write_as(name, wrapped, out),
                Form::Other(target) => document.geometry(wrapped).and_then(|geometry| {
                    lost = target.create(&geometry, out)?;
                    Ok(converted(&rest[..visible], &moved[..visible], report))
                }),
            },
        );
        match written {
            Ok(done) => report = done,
            Err(anamorph_io::WriteError::Output(error)) => return Err(error),
            Err(error) => refused = Some(Failure::new(format!("{name}: {error}"))),
        }
        Ok(())
    });
    if let Some(failure) = refused {
        return Err(failure);
    }
    written?;
    if let Some(file) = &mut report_file {
        let mut value = report_json(
            job,
            options,
            document,
            &built,
            &rest[..visible],
            &moved[..visible],
            &report,
            policy,
            size,
        );
        match form {
            Form::Own => {}
            Form::Sister(name) => {
                value["conversion"] = json!({ "to": name, "lost": Vec::<String>::new() });
            }
            Form::Other(target) => {
                value["conversion"] = json!({ "to": target.name, "lost": lost.0 });
            }
        }
        if let Some(undone) = &undone {
            value["inverse"] = json!({ "residual": undone.residual, "stayed": undone.stayed });
        }
        let text = serde_json::to_string_pretty(&value).map_err(Failure::new)?;
        file.fill(|out| writeln!(out, "{text}"))?;
    }
    let own = [preview_file, report_file, Some(model_file)];
    files::keep_all(
        std::mem::take(&mut copies.files)
            .into_iter()
            .chain(own.into_iter().flatten()),
    )?;
    if !options.quiet {
        summary(job, &built, visible, &report, policy);
        if options.frames.is_none() && recipe.track_count() > 0 {
            say!(
                "  note: without --frames the recipe's tracks do nothing; its warps are in full force, with the values that stand in them"
            );
        }
        for note in document.notes() {
            say!("  note: {note}");
        }
        if let Form::Sister(name) = form {
            say!(
                "  written as {}, which holds all of it",
                name.to_uppercase()
            );
        }
        if let Form::Other(target) = form {
            say!("  converted to {}", target.title);
            if !lost.is_empty() {
                say!(
                    "  warning: {} cannot hold: {lost}",
                    target.name.to_uppercase()
                );
            }
        }
        copies.print();
        if let Some(painted) = &painted {
            say!("  {}", painted.sentence());
        }
        if let Some(undone) = &undone {
            undone.print();
            if run.rest.is_none() && model::is_relative(recipe, document, rest, beside) {
                say!(
                    "  note: the recipe has values relative to the model, which this one, already warped, gives otherwise: name \
                     the model as it was with --rest"
                );
            }
        }
        if !built.parts.is_empty() {
            if report.moved_points == 0 && !run.at_rest {
                say!(
                    "  warning: nothing moved; see whether the recipe says how far (an edit, a `target`), and whether a strength, weight or mask is 0"
                );
            } else if let Some(fold) = fold(&built, &rest[..visible], size) {
                say!("  warning: {fold}; `anamorph check` says more");
            }
        }
    }
    Ok(())
}

/// What a conversion did: how many points moved; its normals are all new.
fn converted<S: Space>(rest: &[S], moved: &[S], report: WriteReport) -> WriteReport {
    let differs = |(a, b): &(&S, &S)| {
        (0..S::DIM).any(|axis| a.component(axis).to_bits() != b.component(axis).to_bits())
    };
    let mut report = report;
    report.moved_points = rest.iter().zip(moved).filter(differs).count();
    report
}

/// Moves all points; gives those that have no finite place to go, and stay.
pub(super) fn move_all<S: ModelSpace>(
    stack: &dyn Deformation<S>,
    document: &dyn Document,
    points: &mut [S],
    progress: &Progress,
) -> Vec<usize> {
    let unmapped = map_all_parallel(&stack, points, &|count| progress.add(count));
    let expected = document.nonfinite();
    let unexpected = |index: &usize| expected.binary_search(index).is_err();
    unmapped
        .indices()
        .iter()
        .copied()
        .filter(unexpected)
        .collect()
}

/// Refuses a warp that moves points to places that are not finite. An inverse may leave points where they are.
pub(super) fn refuse_overflow(name: &str, stayed: &[usize], inverted: bool) -> Result<(), Failure> {
    match stayed.first() {
        Some(&index) if !inverted => Err(Failure::new(format!(
            "{name}: point {} moves to a place that is not finite (it, or a warp, is too large for the number range); \
             scale the model down, or mask the warp there",
            index + 1
        ))),
        _ => Ok(()),
    }
}

/// Calls `f` with moved points, and with what becomes of the directions that are stored with them.
pub(super) fn with_directions<S: ModelSpace, T>(
    stack: &dyn Deformation<S>,
    document: &dyn Document,
    size: f64,
    policy: NormalsPolicy,
    moved: &[S],
    f: impl FnOnce(&Moved<'_>) -> T,
) -> T {
    let carry = |vertex: usize, normal: Solid| {
        carried(stack, document, size, vertex, normal, |jacobian, normal| {
            carry_normal::<S>(jacobian, normal)
        })
    };
    let carry_along = |vertex: usize, tangent: Solid| {
        carried(
            stack,
            document,
            size,
            vertex,
            tangent,
            |jacobian, tangent| carry_tangent::<S>(jacobian, tangent),
        )
    };
    let normals = match policy {
        NormalsPolicy::Carried if S::DIM == 3 => Normals::Transform(&carry),
        NormalsPolicy::Recomputed | NormalsPolicy::OfFacets => Normals::Recompute,
        _ => Normals::Keep,
    };
    let mut wrapped = Moved::new(S::wrap(moved)).with_normals(normals);
    if matches!(normals, Normals::Transform(_)) {
        wrapped = wrapped.with_tangents(&carry_along);
    }
    f(&wrapped)
}

/// What happens to the normals stored in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NormalsPolicy {
    None,
    Kept,
    Carried,
    Recomputed,
    /// They belong to triangles, not to points.
    OfFacets,
}

impl NormalsPolicy {
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::None => "the file stores none",
            Self::Kept => "kept as they were",
            Self::Carried => "carried by the inverse transpose of the Jacobian",
            Self::Recomputed => "recomputed from faces, because a field lives on the model",
            Self::OfFacets => "are those of the moved triangles",
        }
    }
}

pub(super) fn normals_policy<S: Space>(
    document: &dyn Document,
    built: &BuiltRecipe<S>,
    stack: &dyn Deformation<S>,
    options: &WarpOptions,
) -> NormalsPolicy {
    if document.normals() == 0 {
        NormalsPolicy::None
    } else if options.keep_normals || built.parts.is_empty() {
        NormalsPolicy::Kept
    } else if document.format() == "stl" {
        NormalsPolicy::OfFacets
    } else if stack.domain() == Domain::Model {
        NormalsPolicy::Recomputed
    } else {
        NormalsPolicy::Carried
    }
}

/// A direction at a vertex after the warp, carried by `carry` through the Jacobian there. One that the warp leaves alone
/// keeps its bits.
fn carried<S: ModelSpace>(
    stack: &dyn Deformation<S>,
    document: &dyn Document,
    size: f64,
    vertex: usize,
    direction: Solid,
    carry: impl Fn(&S::Linear, S) -> S,
) -> Solid {
    let Some(&point) = S::points(document.points()).and_then(|points| points.get(vertex)) else {
        return direction;
    };
    let Some(jacobian) = stack.jacobian(&anamorph_core::Site::new(vertex, point), size) else {
        return direction;
    };
    if jacobian == S::Linear::IDENTITY {
        return direction;
    }
    let moved = carry(&jacobian, S::from_fn(|axis| direction[axis]));
    Solid::from_fn(|axis| moved.component(axis))
}

#[allow(clippy::too_many_arguments)]
fn report_json<S: ModelSpace>(
    job: &Job,
    options: &WarpOptions,
    document: &dyn Document,
    built: &BuiltRecipe<S>,
    rest: &[S],
    moved: &[S],
    report: &WriteReport,
    policy: NormalsPolicy,
    size: f64,
) -> Value {
    let bounds = |points: &[S]| {
        Bounds::of(points).map(|b| {
            let list = |p: S| -> Vec<f64> { (0..S::DIM).map(|axis| p.component(axis)).collect() };
            json!({ "min": list(b.min), "max": list(b.max) })
        })
    };
    let farthest = rest
        .iter()
        .zip(moved)
        .map(|(&a, &b)| a.distance(b))
        .enumerate();
    let farthest = farthest
        .filter(|(_, d)| d.is_finite() && *d > 0.0)
        .max_by(|a, b| a.1.total_cmp(&b.1));
    json!({
        "anamorph": env!("CARGO_PKG_VERSION"),
        "model": files::shown(&job.model),
        "recipe": files::shown(options.recipe_path()),
        "set": options.set,
        "output": job.output.display().to_string(),
        "format": document.format(),
        "space": S::NAME,
        "points": {
            "count": rest.len(),
            "moved": report.moved_points,
            "not_finite": document.nonfinite().len(),
            "farthest": farthest.map(|(index, distance)| json!({ "index": index, "distance": distance })),
        },
        "bounds": { "before": bounds(rest), "after": bounds(moved) },
        "normals": {
            "count": document.normals(),
            "policy": policy.words(),
            "changed": report.changed_normals,
            "added": report.added_normals,
            "kept": report.kept_normals,
        },
        "notes": document.notes(),
        "warps": to_json(&promises(built, rest, size)),
    })
}

/// Warps that the summary names.
const MOST_TITLES: usize = 8;

fn summary<S: ModelSpace>(
    job: &Job,
    built: &BuiltRecipe<S>,
    count: usize,
    report: &WriteReport,
    policy: NormalsPolicy,
) {
    let titles: Vec<&str> = built
        .parts
        .iter()
        .map(anamorph_recipe::BuiltPart::title)
        .collect();
    let by = match titles.len() {
        0 => "no warp".to_owned(),
        1..=MOST_TITLES => titles.join(", "),
        more => format!(
            "{} and {} more",
            titles[..MOST_TITLES].join(", "),
            more - MOST_TITLES
        ),
    };
    let output = if files::is_stream(&job.output) {
        "standard output".to_owned()
    } else {
        job.output.display().to_string()
    };
    let model = files::shown(&job.model);
    say!(
        "{model} -> {output}: {by}; {} of {count} points moved",
        report.moved_points
    );
    if policy != NormalsPolicy::None {
        say!("  normals {}", policy.words());
    }
    if let Some(path) = &job.preview {
        say!("  preview {}", path.display());
    }
    if let Some(path) = &job.report {
        say!("  report {}", path.display());
    }
}
