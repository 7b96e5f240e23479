//! Pictures of computed models: `synthetic KIND OUT.png [dark]` with KIND one of `disc` (a mesh of the plane, swirled),
//! `dots` (points of the plane), `knot` (50 000 points in space), `sphere` (two million triangles).

use std::error::Error;
use std::f64::consts::TAU;
use std::io::Write;
use std::time::Instant;

use anamorph_core::glam::{DVec2, DVec3};
use anamorph_core::{Mark, Role, Shape};
use anamorph_preview::{Model, Options, Panel, Picture, PreviewError, Theme, before_after};

/// Points of a disc in rings, and its triangles.
fn disc(rings: u32, spokes: u32) -> (Vec<DVec2>, Vec<[u32; 3]>) {
    let mut points = vec![DVec2::ZERO];
    let mut triangles = Vec::new();
    for ring in 1..=rings {
        for spoke in 0..spokes {
            let angle = TAU * f64::from(spoke) / f64::from(spokes);
            points.push(DVec2::new(angle.cos(), angle.sin()) * f64::from(ring) / f64::from(rings));
            let next = (spoke + 1) % spokes;
            let at = |ring: u32, spoke: u32| {
                if ring == 0 {
                    0
                } else {
                    1 + (ring - 1) * spokes + spoke
                }
            };
            triangles.push([at(ring - 1, spoke), at(ring, spoke), at(ring, next)]);
            if ring > 1 {
                triangles.push([at(ring - 1, spoke), at(ring, next), at(ring - 1, next)]);
            }
        }
    }
    (points, triangles)
}

/// A swirl about the origin, and a pull to the right.
fn swirl(point: DVec2) -> DVec2 {
    let near = (1.0 - point.length_squared() * 0.8).max(0.0);
    DVec2::from_angle(near * 1.4).rotate(point) + DVec2::new(0.25 * near, 0.1 * point.x)
}

fn plane(dots: bool, options: &Options) -> Result<Picture, PreviewError> {
    let (points, triangles) = disc(9, 48);
    let warped: Vec<DVec2> = points.iter().map(|&point| swirl(point)).collect();
    let (mut before, mut after) = (Vec::new(), Vec::new());
    for index in 0..6 {
        let from = DVec2::from_angle(TAU * f64::from(index) / 6.0) * 0.55;
        before.push(Mark::new(Role::Source, Shape::Point(from)));
        after.push(Mark::new(Role::Target, Shape::Arrow(from, swirl(from))));
        after.push(Mark::new(Role::Target, Shape::Point(swirl(from))));
    }
    let ring: Vec<DVec2> = (0..=96)
        .map(|step| DVec2::from_angle(TAU * f64::from(step) / 96.0) * 1.1)
        .collect();
    after.push(Mark::new(
        Role::TargetGuide,
        Shape::Polyline(ring.iter().map(|&point| swirl(point)).collect()),
    ));
    before.push(Mark::new(Role::SourceGuide, Shape::Polyline(ring)));
    let model = |points| {
        if dots {
            Model::cloud(points)
        } else {
            Model::mesh(points, &triangles)
        }
    };
    before_after(
        &Panel::new(model(&points)).with_marks(&before),
        &Panel::new(model(&warped)).with_marks(&after),
        options,
    )
}

fn knot(options: &Options) -> Result<Picture, PreviewError> {
    let points: Vec<DVec3> = (0..50_000)
        .map(|index| {
            let (t, s) = (
                f64::from(index) / 50_000.0 * TAU,
                f64::from(index) * 2.399_963,
            );
            let ring = 2.0 + (3.0 * t).cos();
            let centre = DVec3::new(
                ring * (2.0 * t).cos(),
                (3.0 * t).sin(),
                ring * (2.0 * t).sin(),
            );
            centre
                + DVec3::new(
                    s.cos() * (2.0 * t).cos(),
                    s.sin(),
                    s.cos() * (2.0 * t).sin(),
                ) * 0.4
        })
        .collect();
    let warped: Vec<DVec3> = points
        .iter()
        .map(|&point| point * DVec3::new(1.0, 1.3, 0.7))
        .collect();
    before_after(
        &Panel::new(Model::cloud(&points)),
        &Panel::new(Model::cloud(&warped)),
        options,
    )
}

fn sphere(options: &Options) -> Result<Picture, PreviewError> {
    let (rows, columns) = (1000_u32, 1000_u32);
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for row in 0..=rows {
        for column in 0..columns {
            let (u, v) = (
                TAU * f64::from(column) / f64::from(columns),
                TAU / 2.0 * f64::from(row) / f64::from(rows),
            );
            let radius = 1.0 + 0.06 * (9.0 * u).sin() * (8.0 * v).sin() * v.sin();
            points.push(DVec3::new(v.sin() * u.cos(), -v.cos(), v.sin() * u.sin()) * radius);
            if row < rows {
                let next = (column + 1) % columns;
                let at = |row: u32, column: u32| row * columns + column;
                triangles.push([at(row, column), at(row + 1, column), at(row, next)]);
                triangles.push([at(row, next), at(row + 1, column), at(row + 1, next)]);
            }
        }
    }
    let warped: Vec<DVec3> = points
        .iter()
        .map(|&point| point * DVec3::new(1.0, 0.6, 1.0))
        .collect();
    before_after(
        &Panel::new(Model::mesh(&points, &triangles)),
        &Panel::new(Model::mesh(&warped, &triangles)),
        options,
    )
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [kind, out, rest @ ..] = &words[..] else {
        return Err("usage: synthetic disc|dots|knot|sphere OUT.png [dark]".into());
    };
    let theme = if rest.iter().any(|word| word == "dark") {
        Theme::Dark
    } else {
        Theme::Light
    };
    let options = Options {
        theme,
        ..Options::default()
    };
    let start = Instant::now();
    let picture = match kind.as_str() {
        "disc" => plane(false, &options)?,
        "dots" => plane(true, &options)?,
        "knot" => knot(&options)?,
        "sphere" => sphere(&options)?,
        other => return Err(format!("no model called {other}: disc, dots, knot or sphere").into()),
    };
    let drawn = start.elapsed();
    std::fs::write(out, picture.png()?)?;
    writeln!(std::io::stderr(), "drawn in {drawn:.2?}")?;
    Ok(())
}
