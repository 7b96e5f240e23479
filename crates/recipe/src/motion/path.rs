//! `path`: points, smoothed if asked for, become a curve of a family.

use super::values::{Values, below, moderate, point, read, short, unknown};
use crate::words::form;
use anamorph_catalog::{ConstructError, FeatureMesh};
use anamorph_core::{Bounds, Solid};
use anamorph_curves::CurveError;
use anamorph_curves::families::registry::{FAMILIES, Given, Path, family};
use anamorph_curves::smoothing::{
    Filter, FourNeighbourCubic, Kernel, NeighbourAverage, SavitzkyGolay, Smoothing, smooth,
};
use serde_json::Value;
use std::sync::Arc;

/// A path that was built.
pub(super) struct Built {
    pub(super) curve: Arc<dyn Path<Solid>>,
    pub(super) points: Vec<Solid>,
    pub(super) plane: bool,
    pub(super) family: &'static str,
    /// The diagonal of the points' bounds, or 1.
    pub(super) size: f64,
}

/// The curves crate's error at a path.
pub(super) fn refused(path: &str, error: &CurveError) -> ConstructError {
    let text = error.to_string();
    // Its hints stand behind a colon or a semicolon.
    match text.rsplit_once(": ") {
        Some((message, hint)) if !matches!(error, CurveError::UnknownName { .. }) => {
            ConstructError::new(path, message).with_hint(hint)
        }
        _ => ConstructError::new(path, text),
    }
}

/// Builds a filter from the numbers of its entry, in their order.
type Make = fn(&[f64]) -> Result<Box<dyn Filter>, CurveError>;

/// A way of smoothing by name.
pub struct SmoothingEntry {
    /// Its name in recipes.
    pub name: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
    /// The numbers it reads: name, meaning, default.
    pub numbers: &'static [(&'static str, &'static str, f64)],
    make: Make,
}

fn boxed<F: Filter + 'static>(filter: F) -> Result<Box<dyn Filter>, CurveError> {
    Ok(Box::new(filter))
}

/// A whole number for the constructors, which refuse too large ones.
fn whole(value: f64) -> usize {
    if value >= 0.0 && value <= f64::from(u32::MAX) {
        value as usize
    } else {
        usize::MAX
    }
}

/// All ways of smoothing.
pub static SMOOTHINGS: &[SmoothingEntry] = &[
    SmoothingEntry {
        name: "average",
        summary: "half of the point and a quarter of either neighbour; keeps lines",
        numbers: &[],
        make: |_| boxed(NeighbourAverage),
    },
    SmoothingEntry {
        name: "cubic",
        summary: "half-way to where the cubic through four neighbours passes; keeps cubics",
        numbers: &[],
        make: |_| boxed(FourNeighbourCubic),
    },
    SmoothingEntry {
        name: "area",
        summary: "area weights 1/8, 3/4, 1/8",
        numbers: &[],
        make: |_| boxed(Kernel::area_weighted()),
    },
    SmoothingEntry {
        name: "box",
        summary: "the mean of the neighbourhood",
        numbers: &[("radius", "points to each side, up to 100000", 1.0)],
        make: |n| boxed(Kernel::box_of(whole(n[0]))?),
    },
    SmoothingEntry {
        name: "tent",
        summary: "weights that fall evenly with the distance",
        numbers: &[("radius", "points to each side, up to 100000", 1.0)],
        make: |n| boxed(Kernel::tent(whole(n[0]))?),
    },
    SmoothingEntry {
        name: "gaussian",
        summary: "weights of the normal distribution",
        numbers: &[("deviation", "in points, from 0.01 to 10000", 1.0)],
        make: |n| boxed(Kernel::gaussian(n[0], 1e-9)?),
    },
    SmoothingEntry {
        name: "savitzky-golay",
        summary: "the polynomial that fits a window best; keeps polynomials of its degree",
        numbers: &[
            ("window", "an odd number of points, up to 10001", 5.0),
            ("degree", "less than the window, up to 64", 2.0),
        ],
        make: |n| boxed(SavitzkyGolay::new(whole(n[0]), whole(n[1]))?),
    },
];

/// Smoothings one after the other at most, so that the work is bounded by the file's size.
pub(super) const MOST_ITERATIONS: u32 = 10_000;

/// Products of a number and a weight at most: some seconds.
const MOST_WORK: usize = 1_000_000_000;

fn smoothed(
    table: &Values<'_>,
    points: &[Solid],
    closed: bool,
) -> Result<Vec<Solid>, ConstructError> {
    let names: Vec<&str> = SMOOTHINGS.iter().map(|entry| entry.name).collect();
    let entry = match table.text("kind")? {
        None => return Err(table.missing("kind", "one of average, cubic, gaussian, …")),
        Some(kind) => SMOOTHINGS
            .iter()
            .find(|entry| entry.name == kind)
            .ok_or_else(|| unknown(&table.at("kind"), "smoothing", kind, &names))?,
    };
    let mut numbers = Vec::new();
    for (name, _, default) in entry.numbers {
        numbers.push(table.number(name)?.unwrap_or(*default));
    }
    let fails = |error: CurveError| refused(&table.path, &error);
    if let Some(place) = entry
        .numbers
        .iter()
        .zip(&numbers)
        .find_map(|((name, ..), value)| {
            (*name != "deviation" && value.fract() != 0.0).then_some(*name)
        })
    {
        return Err(
            ConstructError::new(table.at(place), format!("`{place}` is no whole number"))
                .with_hint("write a number of points"),
        );
    }
    let filter = (entry.make)(&numbers).map_err(fails)?;
    let pinned = match table.list("pinned")? {
        None => Vec::new(),
        Some(list) => {
            let each = list.iter().enumerate();
            each.map(|(i, value)| read(value, &below(&table.at("pinned"), i)))
                .collect::<Result<Vec<usize>, _>>()?
        }
    };
    let free = table.get("ends") == Some(&Value::String("free".to_owned()));
    table.word("ends", &["pinned", "free"])?;
    let smoothing = Smoothing {
        closed,
        iterations: table.count("repeat", MOST_ITERATIONS)?.unwrap_or(1) as u32,
        pinned: &pinned,
        pin_ends: !free,
    };
    let mut reach = Vec::new();
    if !points.is_empty() {
        let weights = filter.weights(points.len(), closed);
        weights.row(points.len() / 2, &mut reach);
    }
    let work = points.len().saturating_mul(reach.len());
    if work.saturating_mul(smoothing.iterations as usize) > MOST_WORK {
        let message = "this would take too long: the points, times those that each looks at, times `repeat`, are more than a \
                       billion";
        return Err(ConstructError::new(&table.path, message)
            .with_hint("look at fewer neighbours, or repeat it less often"));
    }
    smooth(points, filter.as_ref(), &smoothing).map_err(fails)
}

/// The points of a polyline in a file, and whether it is closed: in the order of its lines, or in that of the file where it has
/// none.
fn polyline(mesh: &FeatureMesh, name: &str) -> Result<(Vec<Solid>, bool), String> {
    if mesh.lines.is_empty() {
        return Ok((mesh.points.clone(), false));
    }
    let one = || {
        format!(
            "the lines of {name} are not one polyline; keep one, or remove all lines to take the points in their order"
        )
    };
    let mut beside: Vec<[Option<u32>; 2]> = vec![[None; 2]; mesh.points.len()];
    for &[a, b] in &mesh.lines {
        for (from, to) in [(a, b), (b, a)] {
            let places = beside.get_mut(from as usize).ok_or_else(one)?;
            let free = places.iter_mut().find(|place| place.is_none());
            *free.ok_or_else(one)? = Some(to);
        }
    }
    let count = |index: usize| beside[index].iter().flatten().count();
    let all = 0..mesh.points.len();
    let end = all.clone().find(|&i| count(i) == 1);
    let closed = end.is_none();
    let start = end
        .or_else(|| all.clone().find(|&i| count(i) == 2))
        .ok_or_else(one)?;
    let mut points = vec![mesh.points[start]];
    let (mut before, mut here) = (None, start as u32);
    loop {
        let places = beside[here as usize];
        let next = match (places, before) {
            ([Some(a), b], Some(from)) if a == from => b,
            ([a, _], _) => a,
        };
        match next {
            Some(next) if next as usize != start && points.len() < mesh.points.len() => {
                points.push(mesh.points[next as usize]);
                (before, here) = (Some(here), next);
            }
            _ => break,
        }
    }
    let used = all.filter(|&i| count(i) > 0).count();
    if points.len() == used {
        Ok((points, closed))
    } else {
        Err(one())
    }
}

/// Points of a path at most; more would take long to measure, and are more than any hand places.
const MOST_POINTS: usize = 100_000;

/// Refuses more points than a path may have, before any work is done on them.
fn few_enough(count: usize, at: &str) -> Result<(), ConstructError> {
    if count <= MOST_POINTS {
        return Ok(());
    }
    let message = format!("{count} points, but a path has at most {MOST_POINTS}");
    Err(ConstructError::new(at, message).with_hint("take fewer points"))
}

/// What is wrong with a table whose list of points is too long.
pub(super) fn too_many(table: &serde_json::Map<String, Value>) -> Option<ConstructError> {
    let list = table.get("path")?.get("points")?.as_array()?;
    few_enough(list.len(), "path.points").err()
}

/// Least size of a path: below it, squares and cubes of lengths would vanish.
const SMALLEST: f64 = 1e-75;

/// Refuses points so near to each other that their path cannot be measured.
fn large_enough(points: &[Solid], at: &str) -> Result<(), ConstructError> {
    let extent = Bounds::of(points).map_or(0.0, |b| (b.max - b.min).max_element());
    if extent > 0.0 && extent < SMALLEST {
        let message = format!(
            "the path is too small: its points are all within {}",
            short(extent)
        );
        return Err(ConstructError::new(at, message)
            .with_hint(format!("scale them up to a size of at least {SMALLEST:e}")));
    }
    Ok(())
}

/// The points, whether they are of the plane, and whether a file says that they are closed.
fn points(table: &Values<'_>) -> Result<(Vec<Solid>, bool, bool), ConstructError> {
    let at = table.at("points");
    match table.get("points") {
        None => Err(table.missing("points", "a list of points, or the name of a file")),
        Some(Value::String(name)) => {
            let mesh = table.context.mesh(&at, name)?;
            let (points, closed) =
                polyline(&mesh, name).map_err(|e| ConstructError::new(&at, e))?;
            few_enough(points.len(), &at)?;
            Ok((points, mesh.dimension == 2, closed))
        }
        Some(Value::Array(list)) => {
            few_enough(list.len(), &at)?;
            let (points, plane) = vectors(list, &at)?;
            Ok((points, plane, false))
        }
        Some(other) => {
            let message = format!("{} where points were expected", form(other));
            Err(ConstructError::new(at, message)
                .with_hint("write [[0, 0, 0], [1, 0, 0]], or the name of a file in quotes"))
        }
    }
}

/// Points or vectors of one dimension, and whether that is 2.
fn vectors(list: &[Value], at: &str) -> Result<(Vec<Solid>, bool), ConstructError> {
    let mut found = Vec::with_capacity(list.len());
    let mut first = None;
    for (i, value) in list.iter().enumerate() {
        let at = below(at, i);
        let (vector, dimension) = point(value, &at)?;
        let before = *first.get_or_insert(dimension);
        if before != dimension {
            let message = format!("{dimension} numbers where the first has {before}");
            return Err(ConstructError::new(at, message)
                .with_hint("give all of them two numbers, or all three"));
        }
        found.push(vector);
    }
    Ok((found, first == Some(2)))
}

/// A path from its table.
pub(super) fn build(table: &Values<'_>) -> Result<Built, ConstructError> {
    let names: Vec<&str> = FAMILIES.iter().map(|family| family.name).collect();
    let kind = table
        .text("kind")?
        .ok_or_else(|| table.missing("kind", "the family of curves, such as \"catmull-rom\""))?;
    let family =
        family(kind).ok_or_else(|| unknown(&table.at("kind"), "family of curves", kind, &names))?;
    let (mut points, plane, ring) = points(table)?;
    let closed = match table.get("closed") {
        None => ring && family.closes,
        Some(_) => table.flag("closed")?,
    };
    if let Some(value) = table.get("smooth") {
        points = smoothed(&table.inside(value, "smooth")?, &points, closed)?;
    }
    let velocities = match table.list("velocities")? {
        Some(list) => vectors(list, &table.at("velocities"))?.0,
        None => Vec::new(),
    };
    let times = match family.times {
        Some(word) if table.get(word).is_some() => {
            let list = table.list(word)?.unwrap_or_default();
            let each = list.iter().enumerate();
            each.map(|(i, value)| moderate(value, &below(&table.at(word), i)))
                .collect::<Result<_, _>>()?
        }
        _ => Vec::new(),
    };
    let mut numbers = Vec::new();
    for number in family.numbers {
        let value = match table.get(number.name) {
            Some(Value::Bool(yes)) if number.flag => Some(f64::from(u8::from(*yes))),
            Some(other) if number.flag && other.as_f64().is_none_or(|n| n != 0.0 && n != 1.0) => {
                let message = format!("{} where true or false was expected", form(other));
                return Err(ConstructError::new(table.at(number.name), message)
                    .with_hint("write true or false"));
            }
            _ => table.number(number.name)?,
        };
        if let Some(value) = value {
            numbers.push((number.name.to_owned(), value));
        }
    }
    large_enough(&points, &table.at("points"))?;
    let diagonal = Bounds::of(&points).map_or(0.0, |bounds| bounds.diagonal());
    let given = Given {
        points,
        velocities,
        times,
        closed,
        numbers,
    };
    let curve = family.make(&given).map_err(|error| {
        let key = match &error {
            CurveError::NotIncreasing { .. }
            | CurveError::Decreasing { .. }
            | CurveError::ElementOutOfRange { what: "node", .. } => {
                family.times.unwrap_or("points")
            }
            CurveError::NotRead { what, .. } if what.contains("clamped") => "clamped",
            CurveError::NotRead { what, .. } if what.contains("knots") => "knots",
            CurveError::OutOfRange { name, .. } if name.contains("node") => {
                family.times.unwrap_or("points")
            }
            CurveError::NotClosed { .. } => "closed",
            CurveError::Mismatch { what, .. } if what.contains("velocit") => "velocities",
            CurveError::Mismatch { .. } => family.times.unwrap_or("points"),
            CurveError::OutOfRange { .. } => "kind",
            _ => "points",
        };
        refused(&table.at(key), &error)
    })?;
    Ok(Built {
        curve: Arc::from(curve),
        points: given.points,
        plane,
        family: family.name,
        size: if diagonal > 0.0 { diagonal } else { 1.0 },
    })
}
