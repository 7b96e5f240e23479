//! Shapes that become one another, as strips of frames: what strain fields keep that straight ways do not.
//!
//! Lines on the shapes are a grid over the source, carried by barycentric coordinates, as a texture is.
//!
//! *Source*: Figures 2 to 9 of H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004, show a bar that is bent, its
//! strains, schemes, letters, a gymnast of quadrilaterals and animals; the shapes are others.

use super::page::escape;
use crate::arguments::GalleryOptions;
use crate::error::Failure;
use crate::files::Pending;
use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::math;
use anamorph_io::outlines;
use anamorph_morph::figures::{Figure as Morph, FigureOptions};
use anamorph_morph::shapes::{FillRule, Part, Ring, Shape};
use anamorph_morph::strain::{Element, Pair, Settings, StrainSeries, method};
use anamorph_preview::{Anchor, Figure, Ink};
use core::f64::consts::PI;
use std::fmt::Write;

/// A strip and what is said of it.
pub(super) struct Scene {
    name: &'static str,
    title: &'static str,
    about: &'static str,
    credit: &'static str,
    draw: fn() -> Result<Figure, Failure>,
}

/// What the section says of itself.
pub(super) const ABOUT: &str = "Two shapes get one triangulation, and what lies between bends and grows without a triangle turned over.";

/// All scenes.
pub(super) const SCENES: &[Scene] = &[
    Scene {
        name: "shape-bend",
        title: "A bar bends",
        about: "Above each point goes straight, and the bar shrinks on its way; below its strains go evenly.",
        credit: "made here",
        draw: bend,
    },
    Scene {
        name: "shape-strains",
        title: "Strains of the bar over time",
        about: "Strain along the bar of a triangle near its end: of points that go straight it turns back, of the strain field it goes one way.",
        credit: "made here",
        draw: strains,
    },
    Scene {
        name: "shape-schemes",
        title: "Linear and modified strains",
        about: "A bar that grows threefold and bends: above strains go evenly, and it grows fast at first; below lengths do.",
        credit: "made here",
        draw: schemes,
    },
    Scene {
        name: "shape-letters",
        title: "A to B to C",
        about: "Holes are paired, open and close by themselves.",
        credit: "outlines of DejaVu Sans, Bitstream, Inc., and the DejaVu fonts contributors",
        draw: letters,
    },
    Scene {
        name: "shape-gymnast",
        title: "A gymnast of quadrilaterals",
        about: "Quadrilaterals bend as triangles do; from standing upright to a bridge.",
        credit: "made here",
        draw: gymnast,
    },
    Scene {
        name: "shape-animals",
        title: "Alpaca to bull",
        about: "Two outlines matched, meshed and morphed with nothing set; the grid is carried by the triangles.",
        credit: "side views of the animal pack of Quaternius, CC0",
        draw: animals,
    },
];

const PAPER: Ink = Ink::new(255, 255, 255);
const EDGE: Ink = Ink::new(30, 41, 59);
const FILL: Ink = Ink::new(226, 232, 240);
const MESH: Ink = Ink::new(148, 163, 184);
const GRID: Ink = Ink::new(37, 99, 235);
const OTHER: Ink = Ink::new(213, 94, 0);
/// Pixels of a frame.
const CELL: [f64; 2] = [190.0, 150.0];
/// Times of frames.
const TIMES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// What a frame shows, y downwards.
#[derive(Default)]
struct Sheet {
    rings: Vec<Vec<DVec2>>,
    mesh: Vec<Vec<DVec2>>,
    lines: Vec<Vec<DVec2>>,
}

fn bounds(points: impl Iterator<Item = DVec2>) -> (DVec2, DVec2) {
    points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
        (low.min(p), high.max(p))
    })
}

/// Rows of frames, all to one scale, each in the middle of its cell.
fn strip(rows: &[(&str, Vec<Sheet>)]) -> Figure {
    let columns = rows
        .iter()
        .map(|(_, sheets)| sheets.len())
        .max()
        .unwrap_or(0);
    let above = if rows.iter().any(|(name, _)| !name.is_empty()) {
        18.0
    } else {
        0.0
    };
    let high = CELL[1] + above;
    let mut figure = Figure::new(CELL[0] * columns as f64, high * rows.len() as f64, PAPER);
    let all = rows.iter().flat_map(|(_, sheets)| sheets);
    let scale = all.fold(f64::INFINITY, |least, sheet| {
        let (low, high) = bounds(sheet.rings.iter().flatten().copied());
        let size = (high - low).max(DVec2::splat(1e-9));
        least
            .min((CELL[0] - 16.0) / size.x)
            .min((CELL[1] - 16.0) / size.y)
    });
    for (row, (name, sheets)) in rows.iter().enumerate() {
        let top = high * row as f64;
        if !name.is_empty() {
            figure.words([8.0, top + 14.0], 9.0, Anchor::Start, EDGE, name);
        }
        for (column, sheet) in sheets.iter().enumerate() {
            let (low, most) = bounds(sheet.rings.iter().flatten().copied());
            let middle = 0.5 * (low + most);
            let cell = dvec2(CELL[0] * (column as f64 + 0.5), top + above + 0.5 * CELL[1]);
            let place = |p: &DVec2| <[f64; 2]>::from((*p - middle) * scale + cell);
            let closed = |ring: &Vec<DVec2>| -> Vec<[f64; 2]> {
                ring.iter().chain(ring.first()).map(place).collect()
            };
            let rings: Vec<Vec<[f64; 2]>> = sheet.rings.iter().map(closed).collect();
            figure.region(&rings, FILL);
            for cell in &sheet.mesh {
                figure.line(&closed(cell), MESH, 0.5);
            }
            for line in &sheet.lines {
                let line: Vec<[f64; 2]> = line.iter().map(place).collect();
                figure.line(&line, GRID, 0.8);
            }
            for ring in &rings {
                figure.line(ring, EDGE, 1.3);
            }
        }
    }
    figure
}

/// A strip of cells along a path, as many on both sides of its middle; points are numbered across, then along.
fn band(path: impl Fn(f64) -> DVec2, width: impl Fn(f64) -> f64, along: usize) -> Vec<DVec2> {
    let mut points = Vec::new();
    for i in 0..=along {
        let t = i as f64 / along as f64;
        let way = (path(t + 1e-4) - path(t - 1e-4)).normalize_or_zero();
        for side in [-1.0, 0.0, 1.0] {
            points.push(path(t) + way.perp() * (0.5 * side * width(t)));
        }
    }
    points
}

/// The cells of a band, as quadrilaterals or halved, and its border.
fn cells(along: usize, halved: bool) -> (Vec<Vec<usize>>, Vec<usize>) {
    let mut cells = Vec::new();
    for i in 0..along {
        for side in 0..2 {
            let [a, b] = [3 * i + side, 3 * i + side + 1];
            let [c, d] = [b + 3, a + 3];
            if halved {
                cells.extend([vec![a, c, b], vec![a, d, c]]);
            } else {
                cells.push(vec![a, d, c, b]);
            }
        }
    }
    let near = (0..=along).map(|i| 3 * i);
    let far = (0..=along).rev().map(|i| 3 * i + 2);
    let ends = ([3 * along + 1], [1]);
    let border = near.chain(ends.0).chain(far).chain(ends.1);
    (cells, border.collect())
}

/// Frames of a band by some methods.
fn bands(
    ends: [Vec<DVec2>; 2],
    along: usize,
    halved: bool,
    methods: &[(&'static str, &'static str)],
) -> Result<Vec<(&'static str, Vec<Sheet>)>, Failure> {
    let (cells, border) = cells(along, halved);
    let pair = pair_of(ends, &cells)?;
    let mut rows = Vec::new();
    for (name, label) in methods {
        let method = method(name).map_err(Failure::new)?;
        let between = method
            .prepare(&pair, &Settings::default())
            .map_err(Failure::new)?;
        let mut sheets = Vec::new();
        for time in TIMES {
            let places = between.at(time).map_err(Failure::new)?.positions;
            let pick = |list: &Vec<usize>| list.iter().map(|&i| places[i]).collect();
            sheets.push(Sheet {
                rings: vec![pick(&border)],
                mesh: cells.iter().map(pick).collect(),
                lines: Vec::new(),
            });
        }
        rows.push((*label, sheets));
    }
    Ok(rows)
}

fn pair_of([source, target]: [Vec<DVec2>; 2], cells: &[Vec<usize>]) -> Result<Pair, Failure> {
    let elements = cells.iter().filter_map(|cell| Element::of(cell)).collect();
    Pair::new(source, target, elements).map_err(Failure::new)
}

/// A place on an arch, from the left, that turns so far in all.
fn arch(t: f64, length: f64, turn: f64) -> DVec2 {
    let radius = length / turn;
    let angle = turn * (t - 0.5);
    radius * dvec2(math::sin(angle), -math::cos(angle))
}

const BAR: usize = 24;

fn bar() -> [Vec<DVec2>; 2] {
    [
        band(|t| dvec2(6.0 * t, 0.0), |_| 0.8, BAR),
        band(|t| arch(t, 6.0, 1.5 * PI), |_| 0.8, BAR),
    ]
}

fn bend() -> Result<Figure, Failure> {
    let methods = [
        ("vertex-linear", "points go straight"),
        ("indifferent", "strain field"),
    ];
    Ok(strip(&bands(bar(), BAR, true, &methods)?))
}

fn schemes() -> Result<Figure, Failure> {
    let ends = [
        band(|t| dvec2(2.0 * t, 0.0), |_| 0.6, BAR),
        band(|t| arch(t, 6.0, 1.2 * PI), |_| 0.6, BAR),
    ];
    let methods = [("linear", "linear"), ("modified", "modified")];
    Ok(strip(&bands(ends, BAR, true, &methods)?))
}

fn gymnast() -> Result<Figure, Failure> {
    // Hands, arms, head and shoulders, hips, legs, feet.
    let width = |t: f64| {
        let bump = |middle: f64, size: f64, reach: f64| {
            let off = (t - middle) / reach;
            size * math::exp(-off * off)
        };
        0.2 + bump(0.36, 0.28, 0.05) + bump(0.48, 0.26, 0.08) + bump(0.68, 0.2, 0.1)
    };
    let ends = [
        band(
            |t| dvec2(0.12 * math::sin(2.0 * PI * t), 5.0 * t),
            width,
            30,
        ),
        band(|t| arch(t, 5.0, 1.15 * PI), width, 30),
    ];
    // Standing, the way goes down; as a bridge, from hands to feet.
    Ok(strip(&bands(ends, 30, false, &[("indifferent", "")])?))
}

fn strains() -> Result<Figure, Failure> {
    let (cells, _) = cells(BAR, true);
    let pair = pair_of(bar(), &cells)?;
    let [wide, high] = [420.0, 260.0];
    let mut figure = Figure::new(wide, high, PAPER);
    let (left, right, top, bottom) = (60.0, wide - 20.0, 24.0, high - 40.0);
    let mut curves = Vec::new();
    for (name, label, ink) in [
        ("vertex-linear", "points go straight", OTHER),
        ("indifferent", "strain field", GRID),
    ] {
        let method = method(name).map_err(Failure::new)?;
        let between = method
            .prepare(&pair, &Settings::default())
            .map_err(Failure::new)?;
        let times: Vec<f64> = (0..=60).map(|i| f64::from(i) / 60.0).collect();
        let frames = between.frames(&times).map_err(Failure::new)?;
        // Near the end of the bar, at its outer side.
        let series = StrainSeries::new(&pair, 10, &frames)
            .ok_or_else(|| Failure::new("gallery: the bar has no such triangle"))?;
        curves.push((label, ink, series));
    }
    let values = curves
        .iter()
        .flat_map(|(_, _, s)| s.strains.iter().map(|s| s.x));
    let (low, most) = values.fold((0.0_f64, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    let (low, most) = ((low * 10.0).floor() / 10.0, (most * 10.0).ceil() / 10.0);
    let at = |t: f64, v: f64| {
        let up = (v - low) / (most - low);
        [left + t * (right - left), bottom + up * (top - bottom)]
    };
    for tick in 0..=4 {
        let t = f64::from(tick) / 4.0;
        let [x, _] = at(t, 0.0);
        figure.line(&[[x, top], [x, bottom]], FILL, 1.0);
        figure.words(
            [x, bottom + 16.0],
            8.0,
            Anchor::Middle,
            EDGE,
            &format!("{t}"),
        );
    }
    for tick in (low * 10.0).round() as i32..=(most * 10.0).round() as i32 {
        let value = f64::from(tick) / 10.0;
        let [_, y] = at(0.0, value);
        figure.line(&[[left, y], [right, y]], FILL, 1.0);
        figure.words(
            [left - 8.0, y + 4.0],
            8.0,
            Anchor::End,
            EDGE,
            &format!("{value:.1}"),
        );
    }
    figure.words(
        [0.5 * (left + right), high - 8.0],
        8.0,
        Anchor::Middle,
        EDGE,
        "time",
    );
    for (row, (label, ink, series)) in curves.iter().enumerate() {
        let pairs = series.times.iter().zip(&series.strains);
        let line: Vec<[f64; 2]> = pairs.map(|(t, strain)| at(*t, strain.x)).collect();
        figure.line(&line, *ink, 2.0);
        let y = top + 14.0 + 16.0 * row as f64;
        figure.line(&[[left + 12.0, y - 4.0], [left + 36.0, y - 4.0]], *ink, 2.0);
        figure.words([left + 42.0, y], 8.0, Anchor::Start, EDGE, label);
    }
    Ok(figure)
}

/// The parts of a drawing that comes with the program.
fn parts(bytes: &[u8]) -> Result<Vec<Part>, Failure> {
    let drawing = outlines::read(bytes).map_err(Failure::new)?.turned(true);
    let view = drawing.view();
    let tolerance = view[2].max(view[3]) / 2000.0;
    let mut parts = Vec::new();
    for part in &drawing.parts {
        let rings = part.contours.iter().map(|contour| Ring {
            points: contour.flatten(tolerance),
            hole: false,
        });
        let shape = Shape {
            rings: rings.collect(),
            fill: FillRule::EvenOdd,
        };
        let (regions, _) = shape.regions().map_err(Failure::new)?;
        parts.extend(regions.into_iter().map(|region| Part {
            id: None,
            colour: None,
            region,
        }));
    }
    Ok(parts)
}

/// Frames from one drawing to another, with a grid over the source.
fn frames(source: &[u8], target: &[u8], times: &[f64], lines: bool) -> Result<Vec<Sheet>, Failure> {
    let chosen = method("indifferent").map_err(Failure::new)?;
    let options = FigureOptions::default();
    let morph =
        Morph::new(&parts(source)?, &parts(target)?, &chosen, &options).map_err(Failure::new)?;
    let mut sheets = Vec::new();
    for &time in times {
        let mut sheet = Sheet::default();
        for piece in morph.at(time).map_err(Failure::new)? {
            let mesh = &morph.couples()[piece.couple].mesh;
            if lines {
                sheet
                    .lines
                    .extend(carried(&mesh.source, &mesh.triangles, &piece.places));
            } else {
                let corners = mesh.triangles.iter();
                let cells = corners.map(|t| t.map(|i| piece.places[i as usize]).to_vec());
                sheet.mesh.extend(cells);
            }
            sheet.rings.extend(piece.rings);
        }
        sheets.push(sheet);
    }
    Ok(sheets)
}

/// Lines of a grid over the source in its triangles, carried with them: each triangle has its own pieces.
fn carried(source: &[DVec2], triangles: &[[u32; 3]], places: &[DVec2]) -> Vec<Vec<DVec2>> {
    let (low, high) = bounds(source.iter().copied());
    let step = (high - low).max_element() / 16.0;
    let mut pieces = Vec::new();
    for triangle in triangles {
        let from = triangle.map(|i| source[i as usize]);
        let to = triangle.map(|i| places[i as usize]);
        for axis in 0..2 {
            let heights = from.map(|p| (p[axis] - low[axis]) / step);
            let least = heights.iter().copied().fold(f64::INFINITY, f64::min);
            let most = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            for line in least.ceil() as i64..=most.floor() as i64 {
                let line = line as f64;
                let ends: Vec<DVec2> = (0..3)
                    .filter_map(|i| {
                        let (a, b) = (heights[i], heights[(i + 1) % 3]);
                        let crosses = (a < line) != (b < line);
                        crosses.then(|| to[i].lerp(to[(i + 1) % 3], (line - a) / (b - a)))
                    })
                    .collect();
                if ends.len() == 2 {
                    pieces.push(ends);
                }
            }
        }
    }
    pieces
}

macro_rules! shape {
    ($name:literal) => {
        include_bytes!(concat!("../../../../tests/fixtures/shapes/", $name))
    };
}

fn letters() -> Result<Figure, Failure> {
    let [a, b, c] = [
        &shape!("letter-A.json")[..],
        &shape!("letter-B.json")[..],
        &shape!("letter-C.json")[..],
    ];
    let mut rows = [
        ("", frames(a, b, &[0.0, 0.2, 0.5, 0.8, 1.0], false)?),
        ("", frames(b, c, &[0.0, 0.2, 0.5, 0.8, 1.0], false)?),
    ];
    // Thousands of lines would hide the outlines.
    for sheet in rows.iter_mut().flat_map(|(_, sheets)| sheets) {
        sheet.mesh.clear();
    }
    Ok(strip(&rows))
}

fn animals() -> Result<Figure, Failure> {
    let [a, b] = [
        &shape!("alpaca-side.json")[..],
        &shape!("bull-side.json")[..],
    ];
    Ok(strip(&[("", frames(a, b, &TIMES, true)?)]))
}

/// A scene with its picture.
pub(super) struct Shown {
    scene: &'static Scene,
    picture: String,
    size: [f64; 2],
}

/// Draws a scene, and begins the file of its picture.
pub(super) fn show(
    scene: &'static Scene,
    options: &GalleryOptions,
    files: &mut Vec<Pending>,
) -> Result<Shown, Failure> {
    let figure = (scene.draw)()?;
    let picture = format!("images/{}.svg", scene.name);
    let svg = figure.svg(scene.title);
    let mut file = Pending::create(&options.out.join(&picture), options.force)?;
    file.fill(|out| out.write_all(svg.as_bytes()))?;
    files.push(file);
    Ok(Shown {
        scene,
        picture,
        size: figure.size(),
    })
}

/// The section of the page.
pub(super) fn html(all: &[Shown]) -> String {
    let mut html = String::new();
    for Shown {
        scene,
        picture,
        size: [width, height],
    } in all
    {
        let _ = writeln!(
            html,
            "<article id=\"{name}\"><div class=\"head\"><h3><a href=\"#{name}\">{title}</a></h3></div>\
             <div class=\"text\"><p>{}</p></div><figure class=\"picture\"><img src=\"{picture}\" width=\"{width}\" height=\"{height}\" \
             loading=\"lazy\" alt=\"{title}\"></figure><p class=\"note\">{}</p></article>",
            escape(scene.about),
            escape(scene.credit),
            name = scene.name,
            title = escape(scene.title),
        );
    }
    html
}

/// The section of the documentation's page.
pub(super) fn markdown(all: &[Shown]) -> String {
    let mut text =
        format!("\n## Shapes\n\n{ABOUT} More: [shapes](shapes.md), [strain fields](strain.md).\n");
    for Shown { scene, picture, .. } in all {
        let _ = write!(
            text,
            "\n### {}\n\n{}\n\n![{}]({picture})\n\nShapes: {}.\n",
            scene.title, scene.about, scene.title, scene.credit
        );
    }
    text
}
