//! `anamorph warp`: models in, a recipe, warped models out.

use super::promises::{promises, to_json};
use crate::arguments::WarpOptions;
use crate::error::Failure;
use crate::files::{self, Pending};
use crate::model::{self, ModelSpace};
use crate::picture;
use crate::progress::Progress;
use anamorph_core::{
    Bounds, Deformation, Domain, Linear, Plane, Solid, Space, carry_normal, map_all_parallel,
};
use anamorph_io::{Document, Moved, Normals, Points, ReadOptions, WriteReport};
use anamorph_recipe::{BuiltRecipe, Recipe};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Where the results of one model go.
struct Job {
    model: PathBuf,
    output: PathBuf,
    report: Option<PathBuf>,
    preview: Option<PathBuf>,
}

/// Whether a destination means a folder: it ends in a separator, or is one.
fn is_folder(path: &Path) -> bool {
    path.as_os_str()
        .to_string_lossy()
        .ends_with(['/', std::path::MAIN_SEPARATOR])
        || path.is_dir()
}

/// One job a model; refuses arguments that do not fit together before anything is read.
fn jobs(options: &WarpOptions) -> Result<Vec<Job>, Failure> {
    let several = options.models.len() > 1;
    let streams = options
        .models
        .iter()
        .chain([&options.recipe])
        .filter(|path| files::is_stream(path))
        .count();
    if streams > 1 {
        return Err(Failure::usage(
            "standard input can be read only once; name files for the others",
        ));
    }
    for (what, path) in [
        ("--output", Some(&options.output)),
        ("--preview", options.preview.as_ref()),
    ] {
        if let Some(path) = path.filter(|path| several && !is_folder(path)) {
            return Err(Failure::usage(format!(
                "several models need a folder for {what}: write `{}/`",
                path.display()
            )));
        }
    }
    if several
        && options
            .report
            .as_deref()
            .is_some_and(|path| !is_folder(path))
    {
        return Err(Failure::usage(
            "several models need a folder for --report: write it with a `/` at its end",
        ));
    }
    let outputs = [options.report.as_deref(), options.preview.as_deref()];
    if outputs.iter().flatten().any(|path| files::is_stream(path)) {
        return Err(Failure::usage(
            "only the model can go to standard output; name files for the others",
        ));
    }
    let jobs: Vec<Job> = options
        .models
        .iter()
        .map(|model| {
            let inside = |path: &Path, extension: Option<&str>| -> Result<PathBuf, Failure> {
                if !is_folder(path) {
                    return Ok(path.to_owned());
                }
                let Some(name) = model.file_name().filter(|_| !files::is_stream(model)) else {
                    return Err(Failure::usage(
                        "a model from standard input has no name; name the output file",
                    ));
                };
                let mut name = PathBuf::from(name);
                if let Some(extension) = extension {
                    name.set_extension(extension);
                }
                Ok(path.join(name))
            };
            Ok(Job {
                model: model.clone(),
                output: inside(&options.output, None)?,
                report: options
                    .report
                    .as_deref()
                    .map(|path| inside(path, Some("json")))
                    .transpose()?,
                preview: options
                    .preview
                    .as_deref()
                    .map(|path| inside(path, Some("png")))
                    .transpose()?,
            })
        })
        .collect::<Result<_, Failure>>()?;
    let mut seen = std::collections::HashSet::new();
    for job in &jobs {
        for path in [Some(&job.output), job.report.as_ref(), job.preview.as_ref()]
            .into_iter()
            .flatten()
        {
            if !files::is_stream(path) && !seen.insert(path.clone()) {
                return Err(Failure::usage(format!(
                    "two results would be written to {}",
                    path.display()
                )));
            }
        }
    }
    Ok(jobs)
}

pub(crate) fn run(options: &WarpOptions) -> Result<(), Failure> {
    let jobs = jobs(options)?;
    let recipe = model::read_recipe(&options.recipe, &options.set)?;
    for path in [
        Some(&options.output),
        options.report.as_ref(),
        options.preview.as_ref(),
    ]
    .into_iter()
    .flatten()
    {
        if is_folder(path) && !path.is_dir() {
            std::fs::create_dir_all(path).map_err(|error| {
                Failure::new(format!(
                    "{}: cannot make the folder: {error}",
                    path.display()
                ))
            })?;
        }
    }
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = options.threads {
        pool = pool.num_threads(threads.get());
    }
    let pool = pool
        .build()
        .map_err(|error| Failure::new(format!("cannot start threads: {error}")))?;
    let single = jobs.len() == 1;
    let mut failed = false;
    for job in &jobs {
        match pool.install(|| warp_one(job, &recipe, options)) {
            Ok(()) => {}
            Err(failure) if single => return Err(failure),
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

fn warp_one(job: &Job, recipe: &Recipe, options: &WarpOptions) -> Result<(), Failure> {
    for path in [Some(&job.output), job.report.as_ref(), job.preview.as_ref()]
        .into_iter()
        .flatten()
    {
        files::refuse_existing(path, options.force)?;
    }
    let read_options = ReadOptions::default().allow_nonfinite(options.allow_nonfinite);
    let document = model::read(&job.model, &read_options)?;
    match document.points() {
        Points::Plane(_) => warp_document::<Plane>(job, recipe, options, document.as_ref()),
        Points::Solid(_) => warp_document::<Solid>(job, recipe, options, document.as_ref()),
    }
}

fn warp_document<S: ModelSpace>(
    job: &Job,
    recipe: &Recipe,
    options: &WarpOptions,
    document: &dyn Document,
) -> Result<(), Failure> {
    let name = files::shown(&job.model);
    let rest = S::points(document.points()).unwrap_or_default();
    let built = model::build(recipe, document, rest)?;
    let stack = built.stack();
    let size = model::size(rest);

    let mut moved = rest.to_vec();
    let unmapped = {
        let progress = Progress::new("warping", moved.len(), options.quiet);
        map_all_parallel(&stack, &mut moved, &|count| progress.add(count))
    };
    let expected = document.nonfinite();
    if let Some(&index) = unmapped
        .indices()
        .iter()
        .find(|index| expected.binary_search(index).is_err())
    {
        return Err(Failure::new(format!(
            "{name}: point {} moves to a place that is not finite (it, or a warp, is too large for the number range); \
             scale the model down, or mask the warp there",
            index + 1
        )));
    }

    let policy = normals_policy(document, &stack, options);
    let mut report = WriteReport::default();
    let model_file = Pending::write(&job.output, |out| {
        let solid = S::points(document.points()).map(|_| ()).is_some() && S::DIM == 3;
        let carry = |vertex: usize, normal: Solid| carried(&stack, document, size, vertex, normal);
        let normals = match policy {
            NormalsPolicy::Carried if solid => Normals::Transform(&carry),
            NormalsPolicy::Recomputed => Normals::Recompute,
            _ => Normals::Keep,
        };
        let wrapped = Moved {
            points: S::wrap(&moved),
            normals,
        };
        report = document.write(&wrapped, out).map_err(|error| match error {
            anamorph_io::WriteError::Output(error) if files::is_stream(&job.output) => {
                crate::error::output(&error)
            }
            error => Failure::new(format!("{}: {error}", job.output.display())),
        })?;
        Ok(())
    })?;
    let mut pending = vec![model_file];
    if let Some(path) = &job.preview {
        let png = picture::preview(document, rest, &moved, &built, &options.view)?;
        pending.push(Pending::write(path, |out| {
            out.write_all(&png)
                .map_err(|error| Failure::new(format!("{}: {error}", path.display())))
        })?);
    }
    if let Some(path) = &job.report {
        let value = report_json(
            job, options, document, &built, rest, &moved, &report, policy, size,
        );
        let text = serde_json::to_string_pretty(&value).map_err(Failure::new)?;
        pending.push(Pending::write(path, |out| {
            writeln!(out, "{text}")
                .map_err(|error| Failure::new(format!("{}: {error}", path.display())))
        })?);
    }
    for file in pending {
        file.keep()?;
    }
    if !options.quiet {
        summary(job, &built, rest.len(), &report, policy);
    }
    Ok(())
}

/// What happens to the normals stored in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum NormalsPolicy {
    None,
    Kept,
    Carried,
    Recomputed,
}

impl NormalsPolicy {
    fn words(self) -> &'static str {
        match self {
            Self::None => "the file stores none",
            Self::Kept => "kept as they were",
            Self::Carried => "carried by the inverse transpose of the Jacobian",
            Self::Recomputed => "recomputed from faces, because a field lives on the model",
        }
    }
}

fn normals_policy<S: Space>(
    document: &dyn Document,
    stack: &anamorph_core::Stack<S>,
    options: &WarpOptions,
) -> NormalsPolicy {
    if document.normals() == 0 {
        NormalsPolicy::None
    } else if options.keep_normals {
        NormalsPolicy::Kept
    } else if stack.domain() == Domain::Model {
        NormalsPolicy::Recomputed
    } else {
        NormalsPolicy::Carried
    }
}

/// The normal at a vertex after the warp, through the Jacobian there. A normal that the warp leaves alone keeps its bits.
fn carried<S: ModelSpace>(
    stack: &anamorph_core::Stack<S>,
    document: &dyn Document,
    size: f64,
    vertex: usize,
    normal: Solid,
) -> Solid {
    let Some(&point) = S::points(document.points()).and_then(|points| points.get(vertex)) else {
        return normal;
    };
    let Some(jacobian) = stack.jacobian(&anamorph_core::Site::new(vertex, point), size) else {
        return normal;
    };
    if jacobian == S::Linear::IDENTITY {
        return normal;
    }
    let moved = carry_normal::<S>(&jacobian, S::from_fn(|axis| normal[axis]));
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
        .filter(|(_, d)| d.is_finite())
        .max_by(|a, b| a.1.total_cmp(&b.1));
    json!({
        "anamorph": env!("CARGO_PKG_VERSION"),
        "model": files::shown(&job.model),
        "recipe": files::shown(&options.recipe),
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
        "warps": to_json(&promises(built, rest, size)),
    })
}

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
    let by = if titles.is_empty() {
        "no warp".to_owned()
    } else {
        titles.join(", ")
    };
    let output = if files::is_stream(&job.output) {
        "standard output".to_owned()
    } else {
        job.output.display().to_string()
    };
    let model = files::shown(&job.model);
    eprintln!(
        "{model} -> {output}: {by}; {} of {count} points moved",
        report.moved_points
    );
    if policy != NormalsPolicy::None {
        eprintln!("  normals {}", policy.words());
    }
    if let Some(path) = &job.preview {
        eprintln!("  preview {}", path.display());
    }
    if let Some(path) = &job.report {
        eprintln!("  report {}", path.display());
    }
}
