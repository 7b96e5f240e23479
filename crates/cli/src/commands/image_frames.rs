//! `anamorph warp --frames` of an image: a recipe over time as numbered pictures or as a film, the image read once.

use super::film::{Output, Writing};
use super::frames::{Frame, Frames};
use super::image;
use super::jobs::Job;
use super::sequence::{self, Record, Series, is_picture};
use super::warp::Run;
use crate::error::{Failure, say};
use crate::files;
use crate::progress::Progress;
use anamorph_io::Lost;
use anamorph_io::images::{EncodeOptions, ImageFile};
use serde_json::json;

/// All frames of a range. Numbered frames that exist and are of the same making are kept, so that a run that was interrupted goes on.
pub(super) fn warp_frames(job: &Job, run: &Run<'_>, frames: &Frames) -> Result<(), Failure> {
    let options = run.options;
    let film = Output::film(&job.output)?;
    let series = film.is_none().then(|| Series::of(job)).transpose()?;
    image::check(job, options)?;
    let bytes = files::read(&job.model)?;
    let picture = image::decoded(&files::shown(&job.model), &bytes, &options.image)?;
    let Some(series) = series else {
        return film.map_or(Ok(()), |film| write_film(job, run, frames, &picture, &film));
    };
    series.refuse_inputs(&job.model, run, frames)?;
    let drawn = &options.image;
    let drawing = json!([
        drawn.pixels.filter,
        drawn.pixels.edge,
        drawn.pixels.max_error,
        drawn.mapping.map(|mapping| format!("{mapping:?}")),
        drawn.grow,
        drawn.pixels.quality,
    ]);
    let last = Frame {
        number: 0,
        time: 1.0,
    };
    let beside = image::fingerprints(&sequence::at(run, &last, None)?, &picture)?;
    let record = Record::new(files::fingerprint(&bytes), run, frames)
        .with("drawing", drawing)
        .with("beside", json!(beside));
    drop(bytes);
    let record_path = series.output.record();
    if !record.check(&record_path, options.force, frames, &series.output)? {
        record.begin(&record_path, frames, &series.output)?;
    }
    let format = image::named_format(&job.output).unwrap_or(picture.format());
    let display = picture.display();
    // A picture that grows has another size at each time, and an ST map has its own.
    let is_own = !drawn.grow && drawn.from_stmap.is_none();
    let size = is_own.then(|| [display.width(), display.height()]);
    let is_done = |path: &std::path::Path| is_picture(path, format, size);
    series.write(job, run, frames, None, &is_done, |job, run| {
        image::warp_image(job, run, picture.clone())
    })
}

/// The frames as a film.
fn write_film(
    job: &Job,
    run: &Run<'_>,
    frames: &Frames,
    picture: &ImageFile,
    film: &Output,
) -> Result<(), Failure> {
    let options = run.options;
    for (given, option, mend) in [
        (job.preview.is_some(), "--preview", "draws numbered images"),
        (job.report.is_some(), "--report", "is of numbered images"),
        (
            options.image.grow,
            "--grow",
            "gives each frame a size of its own, and a film has one",
        ),
    ] {
        if given {
            return Err(Failure::usage(format!(
                "{option} {mend}; leave it out, or write numbered images, as in -o out.%04d.png"
            )));
        }
    }
    files::refuse_existing(&job.output, options.force)?;
    let shown = picture.display();
    let writing = Writing {
        path: &job.output,
        force: options.force,
        encoding: EncodeOptions::default(),
        size: [shown.width(), shown.height()],
        frames: Some(frames),
    };
    let list: Vec<Frame> = frames.all().collect();
    let progress = Progress::new("warping", list.len(), options.quiet);
    let mut lost = Lost::default();
    film.write(
        &writing,
        &list,
        &|| Ok(Record(json!(null))),
        &mut |frame| {
            let image = image::film_frame(job, &sequence::at(run, frame, None)?, picture.clone())?;
            progress.add(1);
            Ok(image)
        },
        &mut lost,
    )?;
    drop(progress);
    if !options.quiet {
        let rate = frames.rate();
        say!(
            "{} -> {}: {} frames, {} seconds at {} a second; {} × {} pixels",
            files::shown(&job.model),
            files::shown_output(&job.output),
            list.len(),
            files::short(list.len() as f64 / rate),
            files::short(rate),
            shown.width(),
            shown.height()
        );
        film.say_rate(frames);
        for note in picture.notes() {
            say!("  note: {note}");
        }
        if !lost.is_empty() {
            say!("  warning: the film does not hold: {lost}");
        }
    }
    Ok(())
}
