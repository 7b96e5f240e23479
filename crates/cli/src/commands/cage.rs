//! `anamorph cage`: control points, frames and points of a model as a file that people edit. Coarse meshes are in `coarse.rs`.

use super::coarse;
use crate::arguments::{CageOptions, Counts, KnotsName, LatticeKind};
use crate::error::{Failure, say};
use crate::files::{self, Pending};
use crate::model::{self, ModelSpace};
use anamorph::features::spread;
use anamorph::warps::cages::{Cage, CageKind, MOST_CONTROL_POINTS};
use anamorph::warps::lattices::Grid;
use anamorph::warps::lattices::bspline::Knots;
use anamorph_catalog::{Context, Length};
use anamorph_core::{Bounds, Plane, Solid, Space};
use anamorph_io::{Document, Points, ReadOptions};
use serde_json::json;
use std::fmt::Write as _;
use std::path::Path;

/// What is written: points with what a table says of each, wires, and comments.
struct Sheet<S> {
    points: Vec<S>,
    /// Wires by indices from 0; without any, every point is an element.
    lines: Vec<Vec<u32>>,
    name: String,
    comments: Vec<String>,
    /// A comment before a point, by its index.
    remarks: Vec<(usize, String)>,
    /// Titles of further columns of a table, and their values point by point.
    columns: (Vec<&'static str>, Vec<Vec<usize>>),
    /// What is said when it is done.
    summary: String,
}

pub(crate) fn run(options: &CageOptions) -> Result<(), Failure> {
    let coarse = match options.content.mesh {
        Some(count) => Some((count, coarse::target(&options.output)?)),
        None => None,
    };
    let table = coarse.is_none() && is_table(&options.output)?;
    let kind = kind(options)?;
    files::refuse_existing(&options.output, options.force)?;
    if !files::is_stream(&options.model)
        && !files::is_immediate(&options.output)
        && files::identity(&options.model) == files::identity(&options.output)
    {
        return Err(Failure::usage(format!(
            "{}: the cage would replace the model; choose another name",
            options.output.display()
        )));
    }
    let document = model::read(
        &options.model,
        &ReadOptions::default(),
        options.allow_outside,
    )?;
    if let Some((count, target)) = coarse {
        return coarse::write(options, count, target, document.as_ref());
    }
    match document.points() {
        Points::Plane(_) => write::<Plane>(options, kind, table, document.as_ref()),
        Points::Solid(_) => write::<Solid>(options, kind, table, document.as_ref()),
    }
}

/// Whether the output is a table of points; refuses names that promise anything but that and OBJ.
fn is_table(output: &Path) -> Result<bool, Failure> {
    let extension = output
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("csv") => Ok(true),
        None | Some("obj") => Ok(false),
        Some(_) if files::is_immediate(output) => Ok(false),
        Some(other) => Err(Failure::usage(format!(
            "{}: a cage is written as OBJ or CSV, not as .{other}; name the output .obj",
            output.display()
        ))),
    }
}

/// The kind of cage; `None` for points of the model.
fn kind(options: &CageOptions) -> Result<Option<CageKind>, Failure> {
    if options.content.points.is_some() {
        return Ok(None);
    }
    if options.content.frames.is_some() {
        return Ok(Some(CageKind::Frames));
    }
    let spline = options.degree.is_some() || options.knots.is_some();
    match options.kind {
        Some(LatticeKind::Lattice) if spline => Err(Failure::usage(
            "--degree and --knots belong to --kind spline-lattice; remove them, or take that kind",
        )),
        None if !spline => Ok(Some(CageKind::Lattice)),
        Some(LatticeKind::Lattice) => Ok(Some(CageKind::Lattice)),
        _ => {
            let knots = match options.knots {
                None | Some(KnotsName::Uniform) => Knots::Uniform,
                Some(KnotsName::Clamped) => Knots::Clamped,
            };
            Ok(Some(CageKind::Spline(options.degree.unwrap_or(3), knots)))
        }
    }
}

/// Counts for each axis of the space; a single one is for all.
fn shape<S: Space>(counts: &Counts) -> Result<Vec<usize>, Failure> {
    let shape = match counts.0.as_slice() {
        [all] => vec![*all; S::DIM],
        list if list.len() == S::DIM => list.to_vec(),
        list => {
            return Err(Failure::new(format!(
                "{} counts where the {} has {} axes; write one for each, such as {}",
                list.len(),
                S::NAME,
                S::DIM,
                if S::DIM == 2 { "4,4" } else { "4,4,4" }
            )));
        }
    };
    let count = shape
        .iter()
        .try_fold(1_usize, |product, &n| product.checked_mul(n));
    if count.is_none_or(|count| count > MOST_CONTROL_POINTS) {
        return Err(Failure::new(format!(
            "that many control points are beyond any use; a cage has at most {MOST_CONTROL_POINTS}"
        )));
    }
    Ok(shape)
}

/// The margin in scene units.
fn margin<S: Space>(text: Option<&String>, bounds: Bounds<S>) -> Result<f64, Failure> {
    let Some(text) = text else {
        return Ok(0.0);
    };
    let value = match text.trim().parse::<f64>() {
        Ok(number) => json!(number),
        Err(_) => json!(text),
    };
    let length = anamorph_catalog::parse::<Length>(&value)
        .and_then(|length| length.resolve("--margin", &Context::of_bounds(bounds)));
    match length {
        Ok(margin) if margin >= 0.0 && margin.is_finite() => Ok(margin),
        Ok(margin) => Err(Failure::new(format!(
            "--margin: the margin is {margin}; write a length that is not negative"
        ))),
        Err(error) => {
            let hint = if error.hint.is_empty() {
                "write a number or a share such as 2%"
            } else {
                error.hint.as_str()
            };
            Err(Failure::new(format!("--margin: {}; {hint}", error.message)))
        }
    }
}

fn write<S: ModelSpace>(
    options: &CageOptions,
    kind: Option<CageKind>,
    table: bool,
    document: &dyn Document,
) -> Result<(), Failure> {
    let name = files::shown(&options.model);
    let points = S::points(document.points()).unwrap_or_default();
    let points = &points[..document.visible().min(points.len())];
    let sheet = match kind {
        None => chosen(options, points, &name)?,
        Some(kind) => caged(options, kind, points, &name)?,
    };
    let text = if table { csv(&sheet) } else { obj(&sheet) };
    let mut file = Pending::create(&options.output, options.force)?;
    file.fill(|out| out.write_all(text.as_bytes()))?;
    files::keep_all([file])?;
    if !options.quiet {
        let output = if files::is_stream(&options.output) {
            "standard output".to_owned()
        } else {
            options.output.display().to_string()
        };
        say!("{name} -> {output}: {}", sheet.summary);
    }
    Ok(())
}

/// The name of a file as it stands in a comment, on one line.
pub(super) fn in_comment(path: &Path, otherwise: &str) -> String {
    let name = path.file_name().filter(|_| !files::is_stream(path));
    let name = name.map_or_else(|| otherwise.into(), |name| name.to_string_lossy());
    name.chars().filter(|c| !c.is_control()).collect()
}

/// How a recipe reads the file.
pub(super) fn usage(options: &CageOptions, kind: &str) -> Vec<String> {
    let source = in_comment(&options.output, "cage.obj");
    let end = if source.ends_with(".csv") {
        "csv"
    } else {
        "obj"
    };
    vec![
        "Move the vertices, keep their number, order and wires, and save under another name. A recipe".to_owned(),
        "beside both files reads them by".to_owned(),
        format!("  kind = {kind:?}"),
        format!("  source = {source:?}"),
        format!("  target = \"edited.{end}\""),
        String::new(),
    ]
}

/// Points of the model, well spread.
fn chosen<S: ModelSpace>(
    options: &CageOptions,
    points: &[S],
    name: &str,
) -> Result<Sheet<S>, Failure> {
    let count = options.content.points.unwrap_or(0);
    let indices = spread(points, count);
    if indices.len() < count {
        return Err(Failure::new(format!(
            "{name}: has only {} different points, and {count} were asked for; ask for fewer",
            indices.len()
        )));
    }
    let mut comments = vec![
        format!(
            "Points of {}, for anamorph's warp `points`.",
            in_comment(&options.model, "a model")
        ),
        String::new(),
        "cage: points".to_owned(),
        String::new(),
    ];
    comments.extend(usage(options, "points"));
    comments.pop();
    Ok(Sheet {
        summary: format!("{count} points, for `points`"),
        points: indices.iter().map(|&index| points[index]).collect(),
        lines: Vec::new(),
        name: format!("points_{count}"),
        comments,
        remarks: Vec::new(),
        columns: (
            vec!["vertex"],
            indices.iter().map(|&i| vec![i + 1]).collect(),
        ),
    })
}

/// Control points or frames around the model.
fn caged<S: ModelSpace>(
    options: &CageOptions,
    kind: CageKind,
    points: &[S],
    name: &str,
) -> Result<Sheet<S>, Failure> {
    let content = &options.content;
    let counts = content.lattice.as_ref().or(content.frames.as_ref());
    let shape = shape::<S>(counts.unwrap_or(&Counts(Vec::new())))?;
    let bounds = Bounds::of(points).ok_or_else(|| {
        Failure::new(format!(
            "{name}: has no points; there is nothing to put a cage around"
        ))
    })?;
    let margin = margin(options.margin.as_ref(), bounds)?;
    let grid = Grid::around_with_margin(bounds, margin, &shape);
    let cage = grid
        .and_then(|grid| Cage::new(grid, kind))
        .map_err(|error| Failure::new(format!("{name}: {error}")))?;
    let letters = &["i", "j", "k"][..S::DIM];
    let axes = &["x", "y", "z"][..S::DIM];
    let frames = kind == CageKind::Frames;
    let step = if frames { S::DIM + 1 } else { 1 };
    let total: usize = shape.iter().product();
    let triple = |flat: usize| -> Vec<usize> {
        let mut rest = flat;
        let mut index = vec![0; S::DIM];
        for axis in (0..S::DIM).rev() {
            index[axis] = rest % shape[axis];
            rest /= shape[axis];
        }
        index
    };
    let what = if frames { "frames" } else { "points" };
    let mut comments = vec![
        format!(
            "Control {what} around {}, for anamorph's warp `{}`.",
            in_comment(&options.model, "a model"),
            kind.name()
        ),
        String::new(),
    ];
    comments.extend(cage.words());
    comments.push(String::new());
    comments.extend(usage(options, kind.name()));
    let place = letters[1..].iter().zip(&shape[1..]).fold(
        letters[0].to_owned(),
        |text, (letter, count)| {
            let inner = if text.len() > 1 {
                format!("({text})")
            } else {
                text
            };
            format!("{inner} * {count} + {letter}")
        },
    );
    let along: Vec<String> = letters
        .iter()
        .zip(axes)
        .map(|(letter, axis)| format!("{letter} along {axis}"))
        .collect();
    let counted = format!("counting from 0, {}", along.join(", "));
    if frames {
        let tips: Vec<String> = axes
            .iter()
            .map(|axis| format!("its {axis} arrow"))
            .collect();
        comments.push(format!(
            "Frame [{}] of a recipe has {step} vertices from v 1 + {step} * ({place}) on, {counted}:",
            letters.join(", ")
        ));
        comments.push(format!(
            "its origin, then the tips of {}. Turn and scale them about the origin, or move all.",
            tips.join(", ")
        ));
    } else {
        comments.push(format!(
            "Control point [{}] of a recipe is v 1 + {place}, {counted}.",
            letters.join(", ")
        ));
    }
    let row = shape[S::DIM - 1];
    let remarks = (0..total)
        .step_by(if frames { 1 } else { row })
        .map(|flat| {
            let first = triple(flat);
            let text = if frames {
                format!("frame {first:?}")
            } else {
                format!("{first:?} to {:?}", triple(flat + row - 1))
            };
            (flat * step, text)
        })
        .collect();
    let columns = (0..total * step)
        .map(|index| {
            let mut values = triple(index / step);
            if frames {
                values.push(index % step);
            }
            values
        })
        .collect();
    let mut titles = letters.to_vec();
    if frames {
        titles.push("arrow");
    }
    let by: Vec<String> = shape.iter().map(usize::to_string).collect();
    Ok(Sheet {
        points: cage.points,
        lines: cage.lines,
        name: format!("{}_{}", kind.name().replace('-', "_"), by.join("x")),
        comments,
        remarks,
        columns: (titles, columns),
        summary: format!("{} control {what}, for `{}`", by.join(" × "), kind.name()),
    })
}

/// The shortest text that reads back to the number.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-5..1e16).contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

fn obj<S: Space>(sheet: &Sheet<S>) -> String {
    let mut text = String::new();
    let mut line = |content: &str| {
        text.push_str(content.trim_end());
        text.push('\n');
    };
    for comment in &sheet.comments {
        line(&format!("# {comment}"));
    }
    line(&format!("o {}", sheet.name));
    let mut remarks = sheet.remarks.iter().peekable();
    for (index, point) in sheet.points.iter().enumerate() {
        if let Some((_, remark)) = remarks.next_if(|(at, _)| *at == index) {
            line(&format!("# {remark}"));
        }
        // A plane is the plane z = 0.
        let [x, y, z] = [0, 1, 2].map(|axis| number(point.component(axis)));
        line(&format!("v {x} {y} {z}"));
    }
    if sheet.lines.is_empty() {
        line("g points");
        for index in 1..=sheet.points.len() {
            line(&format!("p {index}"));
        }
    } else {
        line("g wires");
    }
    for wire in &sheet.lines {
        let mut element = "l".to_owned();
        for index in wire {
            let _ = write!(element, " {}", u64::from(*index) + 1);
        }
        line(&element);
    }
    text
}

fn csv<S: Space>(sheet: &Sheet<S>) -> String {
    let mut titles = ["x", "y", "z"][..S::DIM].to_vec();
    titles.extend(&sheet.columns.0);
    let mut text = titles.join(",");
    text.push('\n');
    for (point, further) in sheet.points.iter().zip(&sheet.columns.1) {
        let mut fields: Vec<String> = (0..S::DIM)
            .map(|axis| number(point.component(axis)))
            .collect();
        fields.extend(further.iter().map(usize::to_string));
        text.push_str(&fields.join(","));
        text.push('\n');
    }
    text
}
