//! Snakes, previews and frames of images by the command, and what it says of image files.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use anamorph_io::images::{EncodeOptions, ImageFile, ImageFormat, ImageLimits};
use anamorph_raster::{Raster, Window};
use common::{Folder, fixture};

const SWIRL: &str = "version = 1\n[[warp]]\nkind = \"vortex\"\ncentre = [\"50%\", \"50%\"]\nradius = \"35%\"\nangle = \"50deg\"\n";

fn exr(raster: &Raster, channels: &[&str]) -> Vec<u8> {
    let image = ImageFile::data(raster, channels).unwrap();
    image
        .encode(ImageFormat::OpenExr, &EncodeOptions::default())
        .unwrap()
        .0
}

fn read(folder: &Folder, name: &str) -> ImageFile {
    let bytes = folder.read(name);
    ImageFile::read(&bytes, ImageLimits::of_file(bytes.len())).unwrap()
}

fn bits(image: &ImageFile) -> Vec<u32> {
    let raster = image.layers()[0].raster.as_ref().unwrap();
    raster.samples().iter().map(|s| s.to_bits()).collect()
}

/// A disc of radius 20 about (40, 36), light on dark.
fn disc() -> Raster {
    let window = Window::new(0, 0, 80, 72).unwrap();
    let mut image = Raster::new(window, 3).unwrap();
    for row in 0..72 {
        for column in 0..80 {
            let from = window.centre(column, row) - anamorph_core::glam::dvec2(40.0, 36.0);
            let light = (20.5 - from.length()).clamp(0.0, 1.0) as f32;
            image.pixel_mut(column, row).fill(0.1 + 0.8 * light);
        }
    }
    image
}

fn points(text: &str) -> Vec<[f64; 2]> {
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("x,y"));
    lines
        .map(|line| {
            let (x, y) = line.split_once(',').unwrap();
            [x.parse().unwrap(), y.parse().unwrap()]
        })
        .collect()
}

fn on_the_edge(points: &[[f64; 2]]) {
    for [x, y] in points {
        let radius = ((x - 40.0).powi(2) + (y - 36.0).powi(2)).sqrt();
        assert!((radius - 20.0).abs() < 0.5, "({x}, {y}): {radius}");
    }
}

#[test]
fn a_curve_settles_on_an_edge_as_table_and_as_drawing() {
    let folder = Folder::new();
    folder.put("disc.exr", exr(&disc(), &["B", "G", "R"]));
    let mut table = "x,y\n".to_owned();
    for i in 0..12 {
        let (sin, cos) = (f64::from(i) / 12.0 * std::f64::consts::TAU).sin_cos();
        let radius = if i % 2 == 0 { 17.0 } else { 23.0 };
        table.push_str(&format!(
            "{},{}\n",
            40.0 + radius * cos,
            36.0 + radius * sin
        ));
    }
    folder.put("rough.csv", &table);
    folder.put(
        "rough.svg",
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"80\" height=\"72\"><circle cx=\"41\" cy=\"35\" r=\"23\"/></svg>",
    );
    let run = folder
        .run(&[
            "snake",
            "disc.exr",
            "--curve",
            "rough.csv",
            "--closed",
            "-o",
            "out.csv",
            "--preview",
            "p.png",
            "--report",
            "r.json",
        ])
        .done();
    assert!(
        run.err.contains("12 points") && !run.err.contains("warning"),
        "{}",
        run.err
    );
    let settled = points(&String::from_utf8(folder.read("out.csv")).unwrap());
    assert_eq!(settled.len(), 12);
    on_the_edge(&settled);
    let report = folder.json("r.json");
    assert_eq!(
        (&report["settled"], &report["closed"]),
        (&true.into(), &true.into())
    );
    assert!(report["edge_strength"]["after"].as_f64() > report["edge_strength"]["before"].as_f64());
    let preview = read(&folder, "p.png");
    assert_eq!(
        (preview.display().width(), preview.display().height()),
        (1600, 900)
    );

    // A drawing says itself that it is closed, and can be read again.
    folder
        .run(&[
            "snake",
            "disc.exr",
            "-c",
            "rough.svg",
            "-o",
            "out.svg",
            "--points",
            "40",
        ])
        .done();
    let svg = String::from_utf8(folder.read("out.svg")).unwrap();
    assert!(svg.contains(" Z\""), "{svg}");
    let again = folder
        .run(&[
            "snake", "disc.exr", "-c", "out.svg", "-o", "-", "-q", "--points", "40",
        ])
        .done();
    let settled = points(&again.text());
    assert_eq!(settled.len(), 40);
    on_the_edge(&settled);
}

#[test]
fn what_is_wrong_with_a_snake_is_one_message() {
    let folder = Folder::new();
    folder
        .put("disc.exr", exr(&disc(), &["B", "G", "R"]))
        .put("few.csv", "x,y\n1,2\n3,4\n")
        .put("out.csv", "x,y\n1,2\n3,4\n300,2\n")
        .put("no.png", "no picture")
        .put(
            "two.svg",
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\" height=\"9\"><rect width=\"3\" height=\"3\"/><rect x=\"5\" width=\"3\" height=\"3\"/></svg>",
        );
    let fails = |arguments: &[&str], code: i32, says: &[&str]| {
        folder
            .run(&[&["snake"], arguments, &["-o", "o.csv"]].concat())
            .failed(code, says);
        assert!(!folder.path().join("o.csv").exists());
    };
    fails(
        &["disc.exr", "-c", "few.csv", "--closed"],
        1,
        &["few.csv", "2 points", "at least 3"],
    );
    fails(
        &["disc.exr", "-c", "out.csv"],
        1,
        &["out.csv", "point 2", "outside", "y going down"],
    );
    fails(&["no.png", "-c", "few.csv"], 1, &["no.png"]);
    fails(&["disc.exr", "-c", "two.svg"], 1, &["two.svg", "one path"]);
    fails(&["disc.exr", "-c", "none.csv"], 1, &["none.csv"]);
    fails(
        &["disc.exr", "-c", "few.csv", "--sigma", "-1"],
        1,
        &["`sigma` is -1"],
    );
    fails(
        &["disc.exr", "-c", "few.csv", "--preview", "p.gif"],
        2,
        &["PNG"],
    );
    fails(
        &["disc.exr", "-c", "few.csv", "--preview", "o.csv"],
        2,
        &["another"],
    );
    // Nothing to see is no error, and said.
    let flat = Raster::new(Window::new(0, 0, 20, 20).unwrap(), 1).unwrap();
    folder.put("flat.exr", exr(&flat, &["Y"]));
    let run = folder
        .run(&["snake", "flat.exr", "-c", "few.csv", "-o", "-"])
        .done();
    assert_eq!(run.text(), "x,y\n1,2\n3,4\n");
    assert!(run.err.contains("no edge within reach"), "{}", run.err);
}

#[test]
fn previews_show_both_pictures() {
    let folder = Folder::new();
    folder
        .put("r.toml", SWIRL)
        .put("cat.png", fixture("valid/cat.png"));
    folder
        .run(&[
            "warp",
            "cat.png",
            "-r",
            "r.toml",
            "-o",
            "out.png",
            "--preview",
            "p.png",
            "--size",
            "800x400",
        ])
        .done();
    let preview = read(&folder, "p.png");
    assert_eq!(
        (preview.display().width(), preview.display().height()),
        (800, 400)
    );
    let light = preview.light().unwrap();
    // The ground at the rim, the cat in both halves, and not the same cat.
    let ground = light.pixel(1, 1).to_vec();
    let (mut left, mut right, mut apart) = (0, 0, 0);
    for row in 0..400 {
        for column in 0..400 {
            let (a, b) = (light.pixel(column, row), light.pixel(column + 400, row));
            left += usize::from(a != ground);
            right += usize::from(b != ground);
            apart += usize::from(a.iter().zip(b).any(|(a, b)| (a - b).abs() > 0.05));
        }
    }
    assert!(
        left > 40_000 && right > 40_000 && apart > 3_000,
        "{left} {right} {apart}"
    );
    // Data without colours is seen, too; the result is the same with and without a preview.
    let depth = Raster::from_samples(
        Window::new(5, 5, 30, 20).unwrap(),
        1,
        (0..600_u16).map(f32::from).collect(),
    );
    folder.put("z.exr", exr(&depth.unwrap(), &["Z"]));
    folder
        .run(&[
            "warp",
            "z.exr",
            "-r",
            "r.toml",
            "-o",
            "z1.exr",
            "--preview",
            "z.png",
            "--grow",
        ])
        .done();
    folder
        .run(&["warp", "z.exr", "-r", "r.toml", "-o", "z2.exr", "--grow"])
        .done();
    assert_eq!(folder.read("z1.exr"), folder.read("z2.exr"));
    for (more, says) in [
        (["--turntable", "8"], "turntable"),
        (["--preview-field", "moved"], "preview-field"),
    ] {
        let run = [
            "warp",
            "cat.png",
            "-r",
            "r.toml",
            "-o",
            "no.png",
            "--preview",
            "q.gif",
        ];
        let run = if more[0] == "--turntable" {
            run
        } else {
            run.map(|a| if a == "q.gif" { "q.png" } else { a })
        };
        folder.run(&[&run[..], &more].concat()).failed(2, &[says]);
    }
}

#[test]
fn frames_go_from_the_picture_to_the_warp_and_resume() {
    let folder = Folder::new();
    folder
        .put("r.toml", SWIRL)
        .put("cat.png", fixture("valid/cat.png"));
    let run = [
        "warp",
        "cat.png",
        "-r",
        "r.toml",
        "-o",
        "out.%04d.png",
        "--frames",
        "4",
    ];
    folder.run(&run).done();
    folder
        .run(&["warp", "cat.png", "-r", "r.toml", "-o", "whole.png"])
        .done();
    let pixels = |name: &str| bits(&read(&folder, name));
    assert!(pixels("out.0001.png") == pixels("cat.png"));
    assert!(pixels("out.0004.png") == pixels("whole.png"));
    assert!(pixels("out.0002.png") != pixels("out.0003.png"));
    // One that is missing is made again, the same; the others are kept.
    let third = folder.read("out.0003.png");
    std::fs::remove_file(folder.path().join("out.0003.png")).unwrap();
    let date = || {
        let second = std::fs::metadata(folder.path().join("out.0002.png"));
        second.unwrap().modified().unwrap()
    };
    let before = date();
    let again = folder.run(&run).done();
    assert!(
        again.err.contains("3 frames exist and are kept"),
        "{}",
        again.err
    );
    assert_eq!(folder.read("out.0003.png"), third);
    assert_eq!(date(), before);
    // Frames drawn otherwise are not mixed with these.
    folder
        .run(&[&run[..], &["--filter", "nearest"]].concat())
        .failed(2, &["out.0001.png", "--force"]);
    folder
        .run(&[&run[..], &["--filter", "nearest", "--force"]].concat())
        .done();
    // Previews and reports of each; no maps.
    let more = [
        "--preview",
        "p.##.png",
        "--report",
        "r.##.json",
        "--range",
        "2-3",
    ];
    let other = run.map(|a| {
        if a == "out.%04d.png" {
            "other.#.exr"
        } else {
            a
        }
    });
    folder.run(&[&other[..], &more].concat()).done();
    for name in ["other.2.exr", "other.3.exr", "p.02.png", "r.03.json"] {
        assert!(folder.path().join(name).exists(), "{name}");
    }
    folder
        .run(&[&run[..], &["--stmap", "s.exr"]].concat())
        .failed(2, &["--stmap"]);
    let unnumbered = run.map(|a| if a == "out.%04d.png" { "out.png" } else { a });
    folder.run(&unnumbered).failed(2, &["out.%04d"]);
}

#[test]
fn image_formats_are_listed_and_images_inspected() {
    let folder = Folder::new();
    let formats = folder.run(&["list", "formats", "--json"]).done().json();
    let names: Vec<&str> = formats
        .as_array()
        .unwrap()
        .iter()
        .map(|f| f["name"].as_str().unwrap())
        .collect();
    for name in ["png", "jpg", "tif", "webp", "exr", "obj"] {
        assert!(names.contains(&name), "{name} in {names:?}");
    }
    let raster = Raster::new(Window::new(3, 4, 20, 10).unwrap(), 2).unwrap();
    let raster = raster.with_display(Window::new(0, 0, 40, 30).unwrap());
    folder
        .put("data.exr", exr(&raster, &["Y", "Z"]))
        .put("cat.png", fixture("valid/cat.png"));
    let text = folder
        .run(&["inspect", "data.exr", "cat.png"])
        .done()
        .text();
    for words in [
        "OpenEXR",
        "40 × 30 pixels",
        "Y (float), Z (float)",
        "20 × 10 pixels at (3, 4)",
        "compression",
        "180 × 120 pixels",
        "8 bits",
    ] {
        assert!(text.contains(words), "{words} in {text}");
    }
    let json = folder.run(&["inspect", "--json", "data.exr"]).done().json();
    assert_eq!(json[0]["width"], 40);
    assert_eq!(
        json[0]["layers"][0]["data_window"],
        serde_json::json!([3, 4, 20, 10])
    );
    folder.put("no.png", "none");
    folder.run(&["inspect", "no.png"]).failed(1, &["no.png"]);
}

#[test]
fn snakes_say_what_the_reach_held_back_and_where_curves_cross() {
    // The light grows faster and faster to the right, so that the curve would go on and on.
    let mut slope = Raster::new(Window::new(0, 0, 200, 40).unwrap(), 1).unwrap();
    for row in 0..40 {
        for column in 0..200_u16 {
            let x = f32::from(column) / 200.0;
            slope.pixel_mut(usize::from(column), row)[0] = x * x;
        }
    }
    let folder = Folder::new();
    folder
        .put("slope.exr", exr(&slope, &["Y"]))
        .put("line.csv", "x,y\n60,5\n60,15\n60,25\n60,35\n")
        .put("eight.csv", "x,y\n40,10\n80,30\n80,10\n40,30\n");
    let run = folder
        .run(&[
            "snake",
            "slope.exr",
            "-c",
            "line.csv",
            "-o",
            "out.csv",
            "--reach",
            "6",
            "--report",
            "r.json",
        ])
        .done();
    assert!(
        run.err.contains("held 6 px from where it was drawn") && run.err.contains("raise --reach"),
        "{}",
        run.err
    );
    for [x, _] in points(&String::from_utf8(folder.read("out.csv")).unwrap()) {
        assert!((x - 66.0).abs() < 1e-6, "{x}");
    }
    let report = folder.json("r.json");
    assert!(report["held"]["points"].as_u64() > Some(3), "{report}");
    assert!(report["held"]["first"].is_array() && report["crossing"]["after"].is_null());
    let run = folder
        .run(&[
            "snake",
            "slope.exr",
            "-c",
            "eight.csv",
            "-o",
            "eight-out.csv",
            "--closed",
        ])
        .done();
    assert!(
        run.err.contains("crosses itself near") && run.err.contains("as it did when it was drawn"),
        "{}",
        run.err
    );
}
