//! Which files `anamorph warp` reads and writes, one job a model.

use crate::arguments::WarpOptions;
use crate::error::Failure;
use crate::files;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Where the results of one model go.
pub(super) struct Job {
    pub(super) model: PathBuf,
    pub(super) output: PathBuf,
    pub(super) report: Option<PathBuf>,
    pub(super) preview: Option<PathBuf>,
}

/// Whether a destination means a folder: it ends in a separator, or is one.
pub(super) fn is_folder(path: &Path) -> bool {
    !files::is_stream(path)
        && (path
            .as_os_str()
            .to_string_lossy()
            .ends_with(['/', std::path::MAIN_SEPARATOR])
            || path.is_dir())
}

/// One job a model; refuses arguments that do not fit together before anything is read.
pub(super) fn jobs(options: &WarpOptions) -> Result<Vec<Job>, Failure> {
    let several = options.models.len() > 1;
    files::at_most_one_stream(options.models.iter().chain(&options.recipe))?;
    for (what, path) in [
        ("--output", Some(&options.output)),
        ("--preview", options.preview.as_ref()),
        ("--report", options.report.as_ref()),
    ] {
        if let Some(path) = path.filter(|path| several && !is_folder(path)) {
            let instead = if files::is_stream(path) {
                "name one, ending in `/`".to_owned()
            } else {
                format!("write `{}/`", path.display())
            };
            return Err(Failure::usage(format!(
                "several models need a folder for {what}: {instead}"
            )));
        }
    }
    let outputs = [options.report.as_deref(), options.preview.as_deref()];
    if outputs.iter().flatten().any(|path| files::is_stream(path)) {
        return Err(Failure::usage(
            "only the model can go to standard output; name files for the others",
        ));
    }
    let picture_extension = if options.turntable.is_some() {
        "gif"
    } else {
        "png"
    };
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
                    .map(|path| inside(path, Some(picture_extension)))
                    .transpose()?,
            })
        })
        .collect::<Result<_, Failure>>()?;
    refuse_collisions(&jobs, options)?;
    Ok(jobs)
}

/// Refuses two results in one place, and results in the place of an input; but a model may replace itself.
fn refuse_collisions(jobs: &[Job], options: &WarpOptions) -> Result<(), Failure> {
    let known = |path: &Path| (!files::is_stream(path)).then(|| files::identity(path));
    let recipe = options.recipe.as_deref().and_then(known);
    let map = options.image.from_stmap.as_deref().and_then(known);
    let binding = options.binding.as_deref().and_then(known);
    let models: HashSet<PathBuf> = jobs.iter().filter_map(|job| known(&job.model)).collect();
    let mut results = HashSet::new();
    for job in jobs {
        for (path, is_model) in job.results() {
            if files::is_immediate(path) {
                continue;
            }
            let Some(identity) = known(path) else {
                continue;
            };
            let shown = path.display();
            let asked = [("recipe", &recipe), ("binding", &binding), ("map", &map)];
            if let Some((what, _)) = asked.iter().find(|(_, f)| f.as_ref() == Some(&identity)) {
                return Err(Failure::usage(format!(
                    "{shown}: a result would replace the {what}; choose another name"
                )));
            }
            if !is_model && models.contains(&identity) {
                return Err(Failure::usage(format!(
                    "{shown}: a report or preview would replace a model; choose another name"
                )));
            }
            if !results.insert(identity) {
                return Err(Failure::usage(format!(
                    "{shown}: two results would be written there; choose another name or folder"
                )));
            }
        }
    }
    Ok(())
}

impl Job {
    /// Where its results go, and which of them is the model.
    pub(super) fn results(&self) -> impl Iterator<Item = (&PathBuf, bool)> {
        let model = [(&self.output, true)];
        let others = [self.report.as_ref(), self.preview.as_ref()];
        model
            .into_iter()
            .chain(others.into_iter().flatten().map(|path| (path, false)))
    }
}
