//! `anamorph warp --frames` of an image: a recipe over time as numbered pictures, the image read once.

use super::frames::Frames;
use super::image;
use super::jobs::Job;
use super::sequence::{Record, Series};
use super::warp::Run;
use crate::error::Failure;
use crate::files;
use anamorph_core::Fingerprint;
use serde_json::json;

/// The fingerprint of a file: FNV-1a (Fowler, Noll and Vo).
fn fingerprint(bytes: &[u8]) -> Fingerprint {
    let step = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    Fingerprint(bytes.iter().fold(0xcbf2_9ce4_8422_2325, step))
}

/// All frames of a range. Frames that exist and are of the same making are kept, so that a run that was interrupted goes on.
pub(super) fn warp_frames(job: &Job, run: &Run<'_>, frames: &Frames) -> Result<(), Failure> {
    let options = run.options;
    let series = Series::of(job)?;
    image::check(job, options)?;
    let bytes = files::read(&job.model)?;
    let picture = image::decoded(&files::shown(&job.model), &bytes, &options.image)?;
    series.refuse_inputs(&job.model, run, frames)?;
    let drawn = &options.image;
    let record = Record::new(fingerprint(&bytes), run, frames).with(
        "drawing",
        json!([
            drawn.pixels.filter,
            drawn.pixels.edge,
            drawn.pixels.max_error,
            drawn.mapping.map(|mapping| format!("{mapping:?}")),
            drawn.grow,
            drawn.pixels.quality,
        ]),
    );
    drop(bytes);
    let record_path = series.output.record();
    if !record.check(&record_path, options.force, frames, &series.output)? {
        record.write(&record_path)?;
    }
    series.write(job, run, frames, None, |job, run| {
        image::warp_image(job, run, picture.clone())
    })
}
