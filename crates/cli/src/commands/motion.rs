//! `anamorph motion`: a recipe of a motion as a table, an animation or a picture.

use crate::arguments::{MotionOptions, ThemeName};
use crate::error::{Failure, say};
use crate::files::{self, Pending, short};
use crate::meshes::RecipeFiles;
use crate::model::read_recipe;
use crate::motion::drawing::{self, Palette};
use crate::motion::frames::{self, Frames};
use crate::motion::{shapes, tracks};
use anamorph_core::Solid;
use anamorph_curves::motion::Finding;
use anamorph_io::{MovingNode, WriteError, write_motion};
use anamorph_recipe::{BuiltMotion, Subject};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Table,
    Animation,
    Svg,
    Png,
}

impl Kind {
    /// From the name of the output.
    fn of(path: &Path) -> Result<Self, Failure> {
        if files::is_stream(path) {
            return Ok(Self::Table);
        }
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        match extension.as_deref().unwrap_or_default() {
            "csv" => Ok(Self::Table),
            "glb" => Ok(Self::Animation),
            "svg" => Ok(Self::Svg),
            "png" => Ok(Self::Png),
            "gltf" => Err(Failure::usage(format!(
                "{}: an animation is written as one file; name it .glb",
                path.display()
            ))),
            _ => Err(Failure::usage(format!(
                "{}: the name says what is written: .csv (a table), .glb (an animation), .svg or .png (a picture)",
                path.display()
            ))),
        }
    }
}

/// Vertical field of view of a camera: that of a 50 mm lens.
const FIELD_OF_VIEW: f64 = 0.471;
/// Pixels of a side of a picture.
const SIDES: std::ops::RangeInclusive<u32> = 1..=16384;
/// Points of the line that shows the path in a glTF.
const LINE: u32 = 512;

pub(crate) fn run(options: &MotionOptions) -> Result<(), Failure> {
    let kind = Kind::of(&options.output)?;
    let sides = [options.size.0, options.size.1];
    if matches!(kind, Kind::Svg | Kind::Png) && !sides.iter().all(|side| SIDES.contains(side)) {
        return Err(Failure::usage(format!(
            "--size: a picture is from {} to {} pixels wide and high",
            SIDES.start(),
            SIDES.end()
        )));
    }
    let report = options.report.as_ref();
    if report.is_some_and(|path| files::is_stream(path)) {
        return Err(Failure::usage(
            "only the table can go to standard output; name a file for the report",
        ));
    }
    for path in report.into_iter().chain([&options.output]) {
        if files::is_immediate(path) {
            continue;
        }
        if files::identity(path) == files::identity(&options.recipe) {
            return Err(Failure::usage(format!(
                "{}: a result would replace the recipe; choose another name",
                path.display()
            )));
        }
    }
    if let Some(report) = report
        && !files::is_immediate(report)
        && files::identity(report) == files::identity(&options.output)
    {
        return Err(Failure::usage(format!(
            "{}: two results would be written there; choose another name",
            report.display()
        )));
    }
    for path in report.into_iter().chain([&options.output]) {
        files::refuse_existing(path, options.force)?;
    }
    let mut set = options.set.clone();
    if let Some(duration) = options.duration {
        set.push(format!("motion.duration={duration:?}"));
    }
    let recipe = read_recipe(&options.recipe, &set)?;
    let beside = RecipeFiles::beside(&options.recipe, options.allow_outside);
    let built = recipe.build_motion(Some(&beside)).map_err(Failure::new)?;
    beside.refuse_replacing(report.into_iter().chain([&options.output]))?;
    let name = files::shown(&options.recipe);
    write(options, kind, &built, &name)
}

/// Warnings of a kind that are printed, and findings of a kind that stand in a report; the rest is counted.
const SHOWN: usize = 8;
const REPORTED: usize = 1000;

/// The first findings of each kind, and how many there are besides, by kind.
fn first(findings: &[Finding], most: usize) -> (Vec<&Finding>, BTreeMap<&'static str, usize>) {
    let (mut counts, mut more) = (BTreeMap::new(), BTreeMap::new());
    let shown = findings.iter().filter(|finding| {
        let count = counts.entry(finding.kind()).or_insert(0_usize);
        *count += 1;
        if *count > most {
            *more.entry(finding.kind()).or_insert(0) += 1;
        }
        *count <= most
    });
    (shown.collect(), more)
}

/// Warnings about a motion, one a line: at most eight of a kind.
pub(crate) fn warnings(built: &BuiltMotion) -> Vec<String> {
    let mut all: Vec<String> = built.notes.iter().take(SHOWN).cloned().collect();
    let beyond = |count: usize, what: &str| {
        let more = count.saturating_sub(SHOWN);
        (more > 0).then(|| format!("and {more} more {what}"))
    };
    all.extend(beyond(built.notes.len(), "such keys"));
    all.extend(built.changes.iter().take(SHOWN).map(ToString::to_string));
    all.extend(beyond(built.changes.len(), "speeds that could not be had"));
    let (shown, more) = first(&built.findings, SHOWN);
    all.extend(shown.iter().map(ToString::to_string));
    all.extend(
        more.iter()
            .map(|(kind, count)| format!("and {count} more {kind}")),
    );
    all
}

/// A motion for reports.
pub(crate) fn described(built: &BuiltMotion) -> Value {
    let (findings, more) = first(&built.findings, REPORTED);
    let changes = built.changes.iter().map(ToString::to_string);
    json!({
        "duration": built.motion.duration(),
        "path": {
            "family": built.family,
            "length": built.motion.table().length(),
            "closed": built.motion.path().is_closed(),
            "plane": built.plane,
        },
        "orientation": built.orientation,
        "subject": match built.subject {
            Subject::Object => "object",
            Subject::Camera => "camera",
        },
        "notes": built.notes,
        "changes": changes.collect::<Vec<_>>(),
        "more": more,
        "findings": findings
            .iter()
            .map(|f| json!({ "time": f.time(), "text": f.to_string() }))
            .collect::<Vec<_>>(),
    })
}

fn write(
    options: &MotionOptions,
    kind: Kind,
    built: &BuiltMotion,
    name: &str,
) -> Result<(), Failure> {
    let times = frames::times(built.motion.duration(), options.fps).map_err(Failure::new)?;
    let count = times.len();
    let mut output = Pending::create(&options.output, options.force)?;
    let mut report_file = options
        .report
        .as_ref()
        .map(|path| Pending::create(path, options.force))
        .transpose()?;
    let mut about = described(built);
    about["recipe"] = json!(name);
    about["output"] = json!(files::shown_output(&options.output));
    about["frames"] = json!(count);
    about["fps"] = json!(options.fps);
    let mut done = format!("{count} frames");
    let mut coarse = None;
    match kind {
        Kind::Table => {
            let frames = Frames::at(built, times, options.fps);
            finite(&frames, name)?;
            output.fill(|out| frames.write_csv(out))?;
        }
        Kind::Animation => {
            let frames = Frames::at(built, times, options.fps);
            finite(&frames, name)?;
            let (file, said) = animation(built, &frames)
                .map_err(|error| Failure::new(format!("{name}: {error}")))?;
            output.fill(|out| out.write_all(&file))?;
            done = format!(
                "translation {} with {} keys, off by at most {}; rotation {} with {} keys, off by at most {} degrees",
                said["translation"]["interpolation"]
                    .as_str()
                    .unwrap_or_default(),
                said["translation"]["keys"],
                short(said["translation"]["error"].as_f64().unwrap_or(0.0)),
                said["rotation"]["interpolation"]
                    .as_str()
                    .unwrap_or_default(),
                said["rotation"]["keys"],
                short(
                    said["rotation"]["error"]
                        .as_f64()
                        .unwrap_or(0.0)
                        .to_degrees()
                ),
            );
            coarse = tracks::coarse(built);
            about["tracks"] = said;
        }
        Kind::Svg | Kind::Png => {
            let palette = match options.theme {
                ThemeName::Light => Palette::LIGHT,
                ThemeName::Dark => Palette::DARK,
            };
            let (width, height) = options.size;
            let figure = drawing::figure(built, [f64::from(width), f64::from(height)], &palette);
            if kind == Kind::Svg {
                let svg = figure.svg(&drawing::label(built));
                output.fill(|out| out.write_all(svg.as_bytes()))?;
            } else {
                let picture = figure.picture().and_then(|picture| picture.png());
                let png = picture.map_err(|error| Failure::usage(format!("--size: {error}")))?;
                output.fill(|out| out.write_all(&png))?;
            }
            done = format!("a picture of {width} x {height} pixels");
        }
    }
    let mut all = vec![output];
    if let Some(mut file) = report_file.take() {
        let text = serde_json::to_string_pretty(&about).map_err(Failure::new)?;
        file.fill(|out| writeln!(out, "{text}"))?;
        all.push(file);
    }
    files::keep_all(all)?;
    if !options.quiet {
        for warning in warnings(built).into_iter().chain(coarse) {
            say!("warning: {name}: {warning}");
        }
        say!(
            "{name}: {} seconds along {} units -> {}: {done}",
            short(built.motion.duration()),
            short(built.motion.table().length()),
            files::shown_output(&options.output),
        );
    }
    Ok(())
}

/// Refuses numbers that left the range.
fn finite(frames: &Frames, name: &str) -> Result<(), Failure> {
    let bad = frames.positions.iter().position(|p| !p.is_finite());
    let bad = bad.or_else(|| frames.speeds.iter().position(|v| !v.is_finite()));
    match bad {
        Some(index) => Err(Failure::new(format!(
            "{name}: at {} seconds the motion is at no finite place, or infinitely fast; scale the path down",
            short(frames.times[index])
        ))),
        None => Ok(()),
    }
}

/// The bytes of a GLB file, and what is to be said of its tracks.
fn animation(built: &BuiltMotion, frames: &Frames) -> Result<(Vec<u8>, Value), WriteError> {
    let tracks = tracks::of(built, frames);
    let path = built.motion.path();
    let (start, end) = path.domain();
    let mut line: Vec<Solid> = (0..=LINE)
        .map(|i| path.point(start + (end - start) * (f64::from(i) / f64::from(LINE))))
        .collect();
    line.dedup();
    let bounds = anamorph_core::Bounds::of(&line).map_or(1.0, |bounds| bounds.diagonal());
    let said = json!({
        "translation": {
            "interpolation": tracks.translation.interpolation(),
            "keys": tracks.translation.len(),
            "error": tracks.translation_error,
        },
        "rotation": {
            "interpolation": tracks.rotation.interpolation(),
            "keys": tracks.rotation.len(),
            "error": tracks.rotation_error,
        },
    });
    let node = MovingNode {
        name: match built.subject {
            Subject::Object => "arrow",
            Subject::Camera => "camera",
        },
        triangles: &shapes::of(built.subject, 0.08 * bounds),
        translation: tracks.translation,
        rotation: tracks.rotation,
        camera: (built.subject == Subject::Camera).then_some(FIELD_OF_VIEW),
        path: &line,
        extras: said.to_string(),
    };
    let mut file = Vec::new();
    write_motion(&node, &mut file)?;
    Ok((file, said))
}
