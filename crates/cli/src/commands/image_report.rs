//! What `anamorph warp` says of an image: a report as JSON, and a summary for people.
//!
//! Both name the filter, how good the map is, and which pixels have no place or several.

use super::image::{Drawing, Drawn, Outside};
use super::jobs::Job;
use super::warp::Run;
use crate::error::say;
use crate::files;
use anamorph_core::Plane;
use anamorph_io::Lost;
use anamorph_io::images::{Channel, ImageFile, ImageFormat, ImageLayer};
use anamorph_raster::Bound;
use anamorph_recipe::BuiltRecipe;
use serde_json::{Value, json};

/// How good a map is, over all layers.
fn quality(drawn: &Drawn) -> Option<(f64, f64, Bound, usize)> {
    let reports = drawn.maps.iter().filter_map(|(_, report)| report.as_ref());
    reports.fold(None, |all, report| {
        let (most, measured, bound, evaluations) = all.unwrap_or((0.0, 0.0, Bound::Derived, 0));
        let estimated = bound == Bound::Estimated || report.bound == Bound::Estimated;
        Some((
            report.max_error.max(most),
            report.measured.max(measured),
            if estimated {
                Bound::Estimated
            } else {
                Bound::Derived
            },
            evaluations + report.evaluations,
        ))
    })
}

pub(super) fn report(
    job: &Job,
    built: &BuiltRecipe<Plane>,
    image: &ImageFile,
    format: ImageFormat,
    drawing: &Drawing<'_>,
    drawn: &Drawn,
    lost: &Lost,
) -> Value {
    let layers = image.layers().iter().map(|layer| {
        let window = layer
            .window()
            .map(|w| [w.x(), w.y(), w.width() as i64, w.height() as i64]);
        let channels: Vec<&str> = layer.channels().iter().map(Channel::name).collect();
        json!({ "name": layer.name(), "channels": channels, "data_window": window })
    });
    let mut value = json!({
        "image": files::shown(&job.model),
        "output": files::shown_output(&job.output),
        "format": format.name(),
        "warps": built.parts.iter().map(anamorph_recipe::BuiltPart::title).collect::<Vec<_>>(),
        "layers": layers.collect::<Vec<_>>(),
        "mapping": if drawing.is_forward() { "forward" } else { "inverse" },
        "pixels": drawn.counts.pixels,
        "pixels_without_place": drawn.counts.lost,
        "lost": lost.0,
    });
    if drawing.is_forward() {
        value["pixels_covered_more_than_once"] = json!(drawn.counts.folded);
    } else {
        value["filter"] = json!(drawing.filter.name());
        value["edge"] = json!(drawn.edge.name());
    }
    if let Some((most, measured, bound, evaluations)) = quality(drawn) {
        let kind = match bound {
            Bound::Derived => "bound",
            Bound::Estimated => "estimate",
        };
        value["map"] = json!({
            "max_error": most, "kind": kind, "measured": measured, "evaluations": evaluations,
        });
    }
    value
}

#[allow(clippy::too_many_arguments)]
pub(super) fn summary(
    job: &Job,
    run: &Run<'_>,
    built: &BuiltRecipe<Plane>,
    image: &ImageFile,
    format: ImageFormat,
    drawing: &Drawing<'_>,
    drawn: &Drawn,
    lost: &Lost,
) {
    let short = files::short;
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
    let window = image.layers().iter().find_map(ImageLayer::window);
    let (width, height) = window.map_or((0, 0), |w| (w.width(), w.height()));
    say!(
        "{} -> {}: {by}; {width} × {height} pixels",
        files::shown(&job.model),
        files::shown_output(&job.output)
    );
    if drawing.is_forward() {
        say!("  forward mapping");
    } else {
        say!(
            "  filter {}, edge {}",
            drawing.filter.name(),
            drawn.edge.name()
        );
    }
    match quality(drawn) {
        Some((most, measured, bound, evaluations)) => {
            let promise = match bound {
                Bound::Derived => "a bound",
                Bound::Estimated => "an estimate",
            };
            say!(
                "  map within {} px ({promise}; largest error measured {} px), {evaluations} evaluations for {} pixels",
                short(most),
                short(measured),
                drawn.counts.pixels
            );
        }
        None if drawing.options.from_stmap.is_some() => say!("  map read from a file"),
        None if !drawing.is_forward() => say!("  map evaluated at every pixel"),
        None => {}
    }
    if drawn.counts.lost > 0 {
        say!(
            "  note: {} of {} pixels of the result are empty: nothing is moved there, or its place was not found",
            drawn.counts.lost,
            drawn.counts.pixels
        );
    }
    if drawn.counts.folded > 0 {
        say!(
            "  note: {} pixels are covered more than once; the last in the image's order is seen",
            drawn.counts.folded
        );
    }
    match drawn.outside {
        Outside::Unseen => {}
        Outside::Alpha => say!(
            "  note: the result has an alpha channel, because some of it lies outside of the image"
        ),
        Outside::Black => say!(
            "  warning: what lies outside of the image is black, because {} has no alpha; write .png, .tif, .webp or .exr, or say \
             --edge clamp",
            format.title()
        ),
    }
    for note in image.notes() {
        say!("  note: {note}");
    }
    if run.options.frames.is_none() && run.recipe.track_count() > 0 {
        say!("  note: the recipe's tracks do nothing; its warps are in full force");
    }
    if format != image.format() {
        say!("  converted to {}", format.title());
    }
    if !lost.is_empty() {
        say!("  warning: {} does not hold: {lost}", format.title());
    }
    for path in [&run.options.image.stmap, &run.options.image.motion_vectors]
        .into_iter()
        .flatten()
    {
        say!("  map {}", path.display());
    }
    if let Some(path) = &job.preview {
        say!("  preview {}", path.display());
    }
    if let Some(path) = &job.report {
        say!("  report {}", path.display());
    }
}
