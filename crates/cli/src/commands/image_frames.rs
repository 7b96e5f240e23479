//! `anamorph warp --frames` of an image: a recipe over time as numbered pictures, the image read once.

use super::frames::{self, Frames, Pattern};
use super::image;
use super::jobs::Job;
use super::sequence::{Record, is_finished, refuse_inputs};
use super::warp::Run;
use crate::error::Failure;
use crate::files;
use crate::meshes::RecipeFiles;
use anamorph_core::Fingerprint;
use serde_json::json;
use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::Mutex;

/// The fingerprint of a file: FNV-1a (Fowler, Noll and Vo).
fn fingerprint(bytes: &[u8]) -> Fingerprint {
    let step = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    Fingerprint(bytes.iter().fold(0xcbf2_9ce4_8422_2325, step))
}

/// All frames of a range. Frames that exist and are of the same making are kept, so that a run that was interrupted goes on.
pub(super) fn warp_frames(job: &Job, run: &Run<'_>, frames: &Frames) -> Result<(), Failure> {
    let options = run.options;
    let output = Pattern::of(&job.output, "--output")?;
    let pattern = |path: &Option<PathBuf>, what| {
        path.as_deref()
            .map(|path| Pattern::of(path, what))
            .transpose()
    };
    let report = pattern(&job.report, "--report")?;
    let preview = pattern(&job.preview, "--preview")?;
    image::check(job, options)?;
    let bytes = files::read(&job.model)?;
    let picture = image::decoded(&files::shown(&job.model), &bytes, &options.image)?;
    refuse_inputs(
        &job.model,
        run,
        frames,
        [Some(&output), report.as_ref(), preview.as_ref()],
    )?;
    let drawn = &options.image;
    let record = Record::new(fingerprint(&bytes), run, frames).with(
        "drawing",
        json!([
            drawn.filter,
            drawn.edge,
            drawn.max_error,
            drawn.mapping.map(|mapping| format!("{mapping:?}")),
            drawn.grow,
            drawn.quality,
        ]),
    );
    drop(bytes);
    let record_path = output.record();
    if !record.check(&record_path, options.force, frames, &output)? {
        record.write(&record_path)?;
    }
    let mut kept = 0;
    for frame in frames.all() {
        let named = |pattern: &Option<Pattern>| pattern.as_ref().map(|p| p.path(frame.number));
        let job = Job {
            model: job.model.clone(),
            output: output.path(frame.number),
            report: named(&report),
            preview: named(&preview),
        };
        if !options.force && job.results().all(|(path, _)| is_finished(path)) {
            kept += 1;
            continue;
        }
        let run = Run {
            recipe: run.recipe.at(frame.time).map_err(Failure::new)?,
            beside: RecipeFiles::beside(options.recipe_path(), options.allow_outside),
            options,
            taken: Mutex::new(HashSet::new()),
            replace: true,
            rest: None,
            around: None,
            at_rest: frame.time == 0.0,
        };
        image::warp_image(&job, &run, picture.clone())?;
    }
    if !options.quiet {
        frames::kept(kept);
        frames.say_length();
    }
    Ok(())
}
