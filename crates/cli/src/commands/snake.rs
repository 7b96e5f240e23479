//! `anamorph snake`: a curve drawn roughly over an image settles on its edges, to be a feature of a warp.

use super::panels::Panels;
use crate::arguments::ThemeName;
use crate::error::{Failure, say};
use crate::files::{self, Pending};
use crate::model;
use anamorph_core::{Mark, Plane, Role, Shape};
use anamorph_io::images::{ImageFile, ImageLimits};
use anamorph_io::{Points, ReadOptions, drawings};
use anamorph_raster::Window;
use anamorph_raster::snake::{Ends, Snake, SnakeReport, relax};
use clap::Args;
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// How much red, green and blue count in the luminance (Rec. ITU-R BT.709, linear light); coverage does not.
const LUMINANCE: [f64; 4] = [0.2126, 0.7152, 0.0722, 0.0];
/// Flattening of a drawing's curves, as a share of its extent.
const FLATTENED: f64 = 1e-4;

/// Let a curve settle on the edges of an image.
///
/// The points of the same curve in two images are features for `lines` and `thin-plate`.
#[derive(Debug, Args)]
pub(crate) struct SnakeOptions {
    /// The image; `-` is standard input
    #[arg(value_name = "IMAGE")]
    pub image: PathBuf,
    /// The curve drawn roughly: a table of points with the columns x and y, or an SVG drawing of one path; in pixels, y down
    #[arg(short, long, value_name = "FILE")]
    pub curve: PathBuf,
    /// Where the settled curve goes: a table, or a drawing if it ends in .svg; `-` is a table on standard output
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Join the last point to the first; paths of drawings that are closed say so themselves
    #[arg(long)]
    pub closed: bool,
    /// Leave the ends of an open curve where they are
    #[arg(long, conflicts_with = "closed")]
    pub fixed_ends: bool,
    /// How far the image is smoothed, in pixels (the standard deviation of a Gaussian)
    #[arg(
        long,
        value_name = "PIXELS",
        default_value = "1",
        allow_hyphen_values = true
    )]
    pub sigma: f64,
    /// How far away edges are seen, and how far the curve may go, in pixels
    #[arg(
        long,
        value_name = "PIXELS",
        default_value = "10",
        allow_hyphen_values = true
    )]
    pub reach: f64,
    /// How stiff the curve is against stretching
    #[arg(
        long,
        value_name = "NUMBER",
        default_value = "1",
        allow_hyphen_values = true
    )]
    pub alpha: f64,
    /// How stiff the curve is against bending
    #[arg(
        long,
        value_name = "NUMBER",
        default_value = "1",
        allow_hyphen_values = true
    )]
    pub beta: f64,
    /// Write that many points, evenly along the curve; if left out each of the given points where it has gone
    #[arg(long, value_name = "N")]
    pub points: Option<usize>,
    /// Draw the image with the curve before and after (PNG)
    #[arg(long, value_name = "PICTURE")]
    pub preview: Option<PathBuf>,
    /// Write what happened as JSON
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<PathBuf>,
    /// Read images that have far more pixels than the size of their file accounts for
    #[arg(long)]
    pub allow_large: bool,
    /// Print nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
    /// Replace files that exist
    #[arg(short, long)]
    pub force: bool,
}

/// Whether a file's name ends so.
fn ends(path: &Path, extension: &str) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

/// The points of a curve, and whether the file says that it is closed.
fn curve(path: &Path) -> Result<(Vec<Plane>, bool), Failure> {
    let bytes = files::read(path)?;
    let name = files::shown(path);
    if !ends(path, "svg") && !drawings::is_svg(&bytes) {
        let document = model::document(bytes, path, &ReadOptions::default(), false)?;
        let points = match document.points() {
            Points::Plane(points) => points.to_vec(),
            Points::Solid(points) => points.iter().map(|p| p.truncate()).collect(),
        };
        return Ok((points, false));
    }
    let drawing = drawings::polylines(&bytes, FLATTENED)
        .map_err(|error| Failure::new(format!("{name}: {error}")))?;
    let count = drawing.points.len();
    let mut closed = false;
    for (number, &[from, to]) in drawing.lines.iter().enumerate() {
        let (from, to) = (from as usize, to as usize);
        if from == number && to == number + 1 {
            continue;
        }
        if from == number && to == 0 && number + 1 == drawing.lines.len() && from + 1 == count {
            closed = true;
            continue;
        }
        return Err(Failure::new(format!(
            "{name}: a snake is one path, and this drawing has several; keep the one along the edge"
        )));
    }
    let drawn = drawing.lines.len() + usize::from(!closed);
    if drawn < count {
        return Err(Failure::new(format!(
            "{name}: a snake is one path, and this drawing has several; keep the one along the edge"
        )));
    }
    Ok((drawing.points, closed))
}

/// Refuses files that would replace each other or what is read.
fn check(options: &SnakeOptions) -> Result<(), Failure> {
    files::at_most_one_stream([&options.image, &options.curve])?;
    let known = |path: &PathBuf| (!files::is_immediate(path)).then(|| files::identity(path));
    let mut taken: Vec<_> = [&options.image, &options.curve]
        .into_iter()
        .filter_map(known)
        .collect();
    let results = [
        Some(&options.output),
        options.preview.as_ref(),
        options.report.as_ref(),
    ];
    for (number, path) in results.into_iter().enumerate() {
        let Some(path) = path else { continue };
        if number > 0 && files::is_stream(path) {
            return Err(Failure::usage(
                "only the curve can go to standard output; name files for the others",
            ));
        }
        files::refuse_existing(path, options.force)?;
        let Some(identity) = known(path) else {
            continue;
        };
        if taken.contains(&identity) {
            return Err(Failure::usage(format!(
                "{}: a result would replace an input or another result; choose another name",
                path.display()
            )));
        }
        taken.push(identity);
    }
    if options
        .preview
        .as_deref()
        .is_some_and(|path| !ends(path, "png"))
    {
        return Err(Failure::usage(
            "--preview: a preview is a PNG; name it .png",
        ));
    }
    Ok(())
}

/// The points as a table.
fn table(points: &[Plane]) -> String {
    let mut text = "x,y\n".to_owned();
    for point in points {
        let _ = writeln!(text, "{},{}", point.x, point.y);
    }
    text
}

/// The curve as a drawing of the size of the image.
fn drawing(points: &[Plane], closed: bool, display: Window) -> String {
    let (x, y, width, height) = (display.x(), display.y(), display.width(), display.height());
    let mut path = String::new();
    for (number, point) in points.iter().enumerate() {
        let step = if number == 0 { "M" } else { " L" };
        let _ = write!(path, "{step}{} {}", point.x, point.y);
    }
    if closed {
        path.push_str(" Z");
    }
    // Pixels are units, also where the picture does not begin at the origin: the view box alone would move them.
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\">\n\
         <path d=\"{path}\" fill=\"none\" stroke=\"#1b62dc\"/>\n</svg>\n",
        x.saturating_add_unsigned(width as u64).max(1),
        y.saturating_add_unsigned(height as u64).max(1),
    )
}

/// The curve before and after over the image.
fn preview(
    image: &ImageFile,
    before: &[Plane],
    after: &[Plane],
    closed: bool,
) -> Result<Vec<u8>, Failure> {
    let light = image.light().map_err(Failure::new)?;
    let mut panels = Panels::new((1600, 900), ThemeName::Light, image.display(), 2)?;
    for (panel, (points, role)) in [(before, Role::Source), (after, Role::Target)]
        .into_iter()
        .enumerate()
    {
        panels.image(panel, &light)?;
        let mut line = points.to_vec();
        if closed {
            line.extend(points.first());
        }
        let mut marks = vec![Mark::new(role, Shape::Polyline(line))];
        // Points are told apart only where there are not too many.
        if points.len() <= 100 {
            marks.extend(points.iter().map(|&p| Mark::new(role, Shape::Point(p))));
        }
        panels.marks(panel, &marks);
    }
    panels.png()
}

/// A place as JSON.
fn place(at: Option<Plane>) -> serde_json::Value {
    at.map_or(serde_json::Value::Null, |at| json!([at.x, at.y]))
}

fn summary(options: &SnakeOptions, count: usize, report: &SnakeReport) {
    let short = files::short;
    say!(
        "{}: {} -> {}: {count} points",
        files::shown(&options.image),
        files::shown(&options.curve),
        files::shown_output(&options.output)
    );
    say!(
        "  moved {} px in the mean, {} px at most, in {} steps",
        short(report.mean),
        short(report.farthest),
        report.steps
    );
    say!(
        "  edge strength {} before, {} after (luminance a pixel)",
        short(report.edge_before),
        short(report.edge_after)
    );
    if report.edge_after == 0.0 {
        say!(
            "  warning: there is no edge within reach, so nothing moved; draw nearer to one, or raise --reach"
        );
    } else if !report.settled {
        say!("  warning: it did not come to rest; draw nearer to the edge, or raise --sigma");
    }
    if let Some(at) = report.held_at {
        say!(
            "  note: {} {} of the curve {} held {} px from where it was drawn, first at ({}, {}); what is beyond is not reached: draw \
             nearer to the edge, or raise --reach",
            report.held,
            if report.held == 1 { "point" } else { "points" },
            if report.held == 1 { "was" } else { "were" },
            short(options.reach),
            short(at.x),
            short(at.y)
        );
    }
    if report.slowed > 0 {
        say!(
            "  note: the curve would have crossed itself, so that parts of it went less far in {} {}; look at --preview, and draw nearer \
             to the edge, or raise --sigma",
            report.slowed,
            if report.slowed == 1 {
                "round"
            } else {
                "rounds"
            }
        );
    }
    if let Some(at) = report.crossing {
        let cause = if options.points.is_some() {
            "as it was drawn it does with so few points; raise --points, or draw it apart"
        } else {
            "as it did when it was drawn; draw it apart"
        };
        say!(
            "  warning: the curve crosses itself near ({}, {}), {cause}",
            short(at.x),
            short(at.y)
        );
    }
    for path in [&options.preview, &options.report].into_iter().flatten() {
        say!("  wrote {}", path.display());
    }
}

pub(crate) fn run(options: &SnakeOptions) -> Result<(), Failure> {
    check(options)?;
    let (points, drawn_closed) = curve(&options.curve)?;
    let closed = options.closed || drawn_closed;
    let bytes = files::read(&options.image)?;
    let name = files::shown(&options.image);
    let limits = if options.allow_large {
        ImageLimits::NONE
    } else {
        ImageLimits::of_file(bytes.len())
    };
    let image = ImageFile::read(&bytes, limits)
        .map_err(|error| Failure::new(format!("{name}: {error}")))?;
    drop(bytes);
    let light = image
        .light()
        .map_err(|error| Failure::new(format!("{name}: {error}")))?;
    let settings = Snake {
        closed,
        ends: if options.fixed_ends {
            Ends::Fixed
        } else {
            Ends::Free
        },
        sigma: options.sigma,
        reach: options.reach,
        alpha: options.alpha,
        beta: options.beta,
        points: options.points,
    };
    let (settled, report) = relax(&light, &LUMINANCE, &points, &settings)
        .map_err(|error| Failure::new(format!("{}: {error}", files::shown(&options.curve))))?;

    let mut results = Vec::new();
    if let Some(path) = &options.preview {
        results.push((path, preview(&image, &points, &settled, closed)?));
    }
    if let Some(path) = &options.report {
        let value = json!({
            "image": name,
            "curve": files::shown(&options.curve),
            "output": files::shown_output(&options.output),
            "closed": closed,
            "points": settled.len(),
            "steps": report.steps,
            "moved": { "mean": report.mean, "farthest": report.farthest },
            "edge_strength": { "before": report.edge_before, "after": report.edge_after },
            "settled": report.settled,
            "held": { "points": report.held, "first": place(report.held_at) },
            "slowed_rounds": report.slowed,
            "crossing": { "before": report.crossed_before, "after": place(report.crossing) },
        });
        let text = serde_json::to_string_pretty(&value).map_err(Failure::new)?;
        results.push((path, format!("{text}\n").into_bytes()));
    }
    let text = if ends(&options.output, "svg") {
        drawing(&settled, closed, image.display())
    } else {
        table(&settled)
    };
    results.push((&options.output, text.into_bytes()));
    let mut pending = Vec::new();
    for (path, content) in results {
        let mut file = Pending::create(path, options.force)?;
        file.fill(|out| out.write_all(&content))?;
        pending.push(file);
    }
    files::keep_all(pending)?;
    if !options.quiet {
        summary(options, settled.len(), &report);
    }
    Ok(())
}
