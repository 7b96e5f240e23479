//! A mesh from an OBJ file before and after a twist, with a lattice of marks: `twist MODEL.obj OUT.png [dark] [back]
//! [plain] [cloud] [untwisted] [AZIMUTH ELEVATION in degrees]`.

use std::error::Error;
use std::io::Write;
use std::time::Instant;

use anamorph_core::glam::DVec3;
use anamorph_core::{Mark, Role, Shape};
use anamorph_preview::{Camera, Model, Options, Panel, Theme, before_after};

/// Points and triangulated faces; everything else in the file is passed over.
fn read_obj(text: &str) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let mut next = || {
                    words
                        .next()
                        .and_then(|word| word.parse().ok())
                        .unwrap_or(f64::NAN)
                };
                points.push(DVec3::new(next(), next(), next()));
            }
            Some("f") => {
                let corners: Vec<u32> = words
                    .filter_map(|word| word.split('/').next()?.parse::<i64>().ok())
                    .map(|index| if index < 0 { points.len() as i64 + index } else { index - 1 } as u32)
                    .collect();
                triangles.extend(
                    corners
                        .windows(2)
                        .skip(1)
                        .map(|pair| [corners[0], pair[0], pair[1]]),
                );
            }
            _ => {}
        }
    }
    (points, triangles)
}

/// The lines and points of a 4 × 4 × 4 lattice.
fn lattice(
    at: impl Fn([usize; 3]) -> DVec3,
    moved: impl Fn([usize; 3]) -> bool,
    role: Role,
    guide: Role,
) -> Vec<Mark<DVec3>> {
    let mut marks = Vec::new();
    for a in 0..4 {
        for b in 0..4 {
            for axis in 0..3 {
                let cell = |k| {
                    let mut cell = [a, b, b];
                    cell[axis] = k;
                    cell[(axis + 1) % 3] = a;
                    cell[(axis + 2) % 3] = b;
                    cell
                };
                marks.push(Mark::new(
                    guide,
                    Shape::Polyline((0..4).map(|k| at(cell(k))).collect()),
                ));
            }
            for c in 0..4 {
                let role = if moved([a, b, c]) { role } else { guide };
                marks.push(Mark::new(role, Shape::Point(at([a, b, c]))));
            }
        }
    }
    marks
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [model, out, rest @ ..] = &words[..] else {
        return Err("usage: twist MODEL.obj OUT.png [dark] [back] [plain] [cloud] [untwisted] [AZIMUTH ELEVATION]".into());
    };
    let has = |word: &str| rest.iter().any(|other| other == word);
    let angles: Vec<f64> = rest.iter().filter_map(|word| word.parse().ok()).collect();
    let (points, mut triangles) = read_obj(&std::fs::read_to_string(model)?);
    if has("cloud") {
        triangles.clear();
    }
    let least = points
        .iter()
        .fold(DVec3::INFINITY, |least, &point| least.min(point));
    let most = points
        .iter()
        .fold(DVec3::NEG_INFINITY, |most, &point| most.max(point));
    let (centre, size) = ((least + most) * 0.5, most - least);
    let twist = |point: DVec3| {
        if has("untwisted") {
            return point;
        }
        let angle = ((point.y - centre.y) / size.y) * 1.1;
        let (sin, cos) = angle.sin_cos();
        let (x, z) = (point.x - centre.x, point.z - centre.z);
        DVec3::new(
            centre.x + x * cos + z * sin,
            point.y,
            centre.z - x * sin + z * cos,
        )
    };
    let node = |cell: [usize; 3]| {
        let part = DVec3::from_array(cell.map(|k| k as f64 / 3.0));
        centre + (part - 0.5) * (size * 1.04)
    };
    let moved = |cell: [usize; 3]| cell[1] == 3;
    let mut before = lattice(node, moved, Role::Source, Role::SourceGuide);
    let mut after = lattice(
        |cell| twist(node(cell)),
        moved,
        Role::Target,
        Role::TargetGuide,
    );
    after.push(Mark::new(
        Role::Target,
        Shape::Arrow(node([3, 3, 3]), twist(node([3, 3, 3]))),
    ));
    let warped: Vec<DVec3> = points.iter().map(|&point| twist(point)).collect();
    let mut camera = Camera::default();
    if has("back") {
        camera = camera.from_behind();
    }
    if let [azimuth, elevation] = angles[..] {
        camera = camera.at(azimuth.to_radians(), elevation.to_radians());
    }
    let options = Options {
        theme: if has("dark") {
            Theme::Dark
        } else {
            Theme::Light
        },
        camera,
        ..Options::default()
    };
    if has("plain") {
        before.clear();
        after.clear();
    }
    let start = Instant::now();
    let picture = before_after(
        &Panel::new(Model::mesh(&points, &triangles)).with_marks(&before),
        &Panel::new(Model::mesh(&warped, &triangles)).with_marks(&after),
        &options,
    )?;
    let drawn = start.elapsed();
    std::fs::write(out, picture.png()?)?;
    writeln!(
        std::io::stderr(),
        "{} triangles, drawn in {drawn:.2?}, encoded in {:.2?}",
        triangles.len(),
        start.elapsed() - drawn
    )?;
    Ok(())
}
