//! Images warped by the command: what does not move stays to the bit, what moves agrees with an independent resampler.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use anamorph_io::images::{EncodeOptions, ImageFile, ImageFormat, ImageLimits};
use anamorph_raster::{Raster, Window};
use common::{EMPTY, Folder, Run, fixture};

const TURN: &str = "version = 1\n[[warp]]\nkind = \"frames\"\n[[warp.frame]]\nat = [\"50%\", \"50%\"]\nturn = \"90deg\"\n";
const SWIRL: &str = "version = 1\n[[warp]]\nkind = \"vortex\"\ncentre = [\"50%\", \"50%\"]\nradius = \"35%\"\nangle = \"50deg\"\n";
/// Twice as wide, from the left edge.
const WIDE: &str = "version = 1\n[[warp]]\nkind = \"frames\"\n[[warp.frame]]\nat = [0, 0]\ntarget_axes = [[2, 0], [0, 1]]\n";

/// A smooth picture: waves of some ten pixels.
fn waves(size: usize, channels: usize) -> Raster {
    let window = Window::new(0, 0, size, size).unwrap();
    let value = |i: usize| {
        let (pixel, channel) = (i / channels, i % channels);
        let (x, y) = ((pixel % size) as f32, (pixel / size) as f32);
        let wave = (x * 0.31 + channel as f32).sin() * (y * 0.23).cos();
        0.5 + 0.4 * wave
    };
    let samples = (0..size * size * channels).map(value).collect();
    Raster::from_samples(window, channels, samples).unwrap()
}

fn exr(raster: &Raster, channels: &[&str]) -> Vec<u8> {
    encoded(
        &ImageFile::data(raster, channels).unwrap(),
        ImageFormat::OpenExr,
    )
}

fn encoded(image: &ImageFile, format: ImageFormat) -> Vec<u8> {
    image.encode(format, &EncodeOptions::default()).unwrap().0
}

fn read(folder: &Folder, name: &str) -> ImageFile {
    let bytes = std::fs::read(folder.path().join(name)).unwrap();
    ImageFile::read(&bytes, ImageLimits::of_file(bytes.len())).unwrap()
}

fn pixels(image: &ImageFile) -> &Raster {
    image.layers()[0].raster.as_ref().unwrap()
}

fn bits(raster: &Raster) -> Vec<u32> {
    raster.samples().iter().map(|s| s.to_bits()).collect()
}

/// Runs `warp` with these arguments and more.
fn warp(folder: &Folder, arguments: &[&str], more: &[&str]) -> Run {
    folder.run(&[&["warp"], arguments, more].concat())
}

/// Nothing but the folder's inputs is there, no part of a result either.
fn nothing_written(folder: &Folder, inputs: &[&str]) {
    let there = std::fs::read_dir(folder.path()).unwrap();
    let mut names: Vec<String> = there
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.retain(|name| !inputs.contains(&name.as_str()));
    assert!(names.is_empty(), "{names:?}");
}

#[test]
fn a_recipe_that_does_nothing_gives_the_same_pixels() {
    let folder = Folder::new();
    folder.put("r.toml", EMPTY);
    let mut odd = waves(40, 4);
    odd.pixel_mut(3, 5)
        .copy_from_slice(&[f32::NAN, f32::INFINITY, -0.0, f32::NEG_INFINITY]);
    odd.pixel_mut(20, 9)[1] = 1e30;
    folder.put("float.exr", exr(&odd, &["A", "B", "G", "Z"]));
    let colour = ImageFile::data(&waves(40, 3), &["B", "G", "R"]).unwrap();
    folder.put("sixteen.png", encoded(&colour, ImageFormat::Png));
    folder.put("eight.webp", encoded(&colour, ImageFormat::WebP));
    folder.put("float.tif", encoded(&colour, ImageFormat::Tiff));
    // From 8 bits to halves.
    warp(
        &folder,
        &["eight.webp", "-r", "r.toml", "-o", "half.exr"],
        &[],
    )
    .done();
    warp(
        &folder,
        &["eight.webp", "-r", "r.toml", "-o", "eight.png"],
        &[],
    )
    .done();
    folder.put("cat.png", fixture("valid/cat.png"));
    for (name, out) in [
        ("cat.png", "0.png"),
        ("float.exr", "1.exr"),
        ("sixteen.png", "2.png"),
        ("eight.webp", "3.webp"),
        ("float.tif", "4.tif"),
        ("half.exr", "5.exr"),
        ("eight.png", "6.png"),
    ] {
        for more in [
            &[][..],
            &["--max-error", "0"],
            &["--filter", "lanczos", "--edge", "wrap"],
        ] {
            warp(&folder, &[name, "-r", "r.toml", "-f", "-o", out], more).done();
            let (old, new) = (read(&folder, name), read(&folder, out));
            assert!(bits(pixels(&old)) == bits(pixels(&new)), "{name} {more:?}");
            assert_eq!(old.layers()[0].channels(), new.layers()[0].channels());
        }
    }
}

#[test]
fn a_quarter_turn_agrees_with_turning_the_pixels() {
    let folder = Folder::new();
    let size = 64;
    let picture = waves(size, 3);
    folder
        .put("r.toml", TURN)
        .put("in.exr", exr(&picture, &["B", "G", "R"]));
    for filter in ["nearest", "catmull-rom", "anisotropic"] {
        let run = ["in.exr", "-r", "r.toml", "-f", "-o", "out.exr"];
        warp(&folder, &run, &["--filter", filter]).done();
        let turned = read(&folder, "out.exr");
        let turned = pixels(&turned);
        // x goes right and y down: a turn from x to y takes the pixel in column x and row y to column −y, row x.
        for row in 0..size {
            for column in 0..size {
                let (new, old) = (
                    turned.pixel(size - 1 - row, column),
                    picture.pixel(column, row),
                );
                for (a, b) in new.iter().zip(old) {
                    assert!((a - b).abs() < 1e-4, "{filter} {column} {row} {a} {b}");
                }
            }
        }
    }
}

#[test]
fn there_and_back_is_near_the_original() {
    let folder = Folder::new();
    let size = 128;
    let picture = waves(size, 1);
    folder
        .put("r.toml", SWIRL)
        .put("in.exr", exr(&picture, &["Y"]));
    let filter = ["--filter", "catmull-rom"];
    let there = ["in.exr", "-r", "r.toml", "-o", "there.exr"];
    let there = warp(&folder, &there, &filter).done();
    assert!(
        there.err.contains("map within 0.05 px (an estimate"),
        "{}",
        there.err
    );
    let back = ["there.exr", "-r", "r.toml", "-o", "back.exr", "--invert"];
    warp(&folder, &back, &filter).done();
    let moved = |name: &str| {
        let image = read(&folder, name);
        let squares = pixels(&image).samples().iter().zip(picture.samples());
        let sum: f64 = squares.map(|(a, b)| f64::from(a - b).powi(2)).sum();
        -10.0 * (sum / (size * size) as f64).log10()
    };
    assert!(moved("there.exr") < 25.0, "{}", moved("there.exr"));
    assert!(moved("back.exr") > 42.0, "{}", moved("back.exr"));

    // Moving the pixels gives the same picture as looking them up.
    let forward = ["in.exr", "-r", "r.toml", "-o", "forward.exr"];
    warp(&folder, &forward, &["--mapping", "forward"]).done();
    let (a, b) = (read(&folder, "there.exr"), read(&folder, "forward.exr"));
    let apart = pixels(&a).samples().iter().zip(pixels(&b).samples());
    let mean = apart.map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / (size * size) as f64;
    assert!(mean < 0.02, "{mean}");
}

#[test]
fn maps_for_compositors_say_where_pixels_come_from_and_go() {
    let folder = Folder::new();
    folder
        .put("r.toml", WIDE)
        .put("in.exr", exr(&waves(40, 1), &["Y"]));
    let maps = [
        "--stmap",
        "st.exr",
        "--motion-vectors",
        "mv.exr",
        "--max-error",
        "0",
    ];
    let run = [
        "in.exr", "-r", "r.toml", "-o", "out.exr", "--report", "r.json",
    ];
    warp(&folder, &run, &maps).done();
    let (st, mv) = (read(&folder, "st.exr"), read(&folder, "mv.exr"));
    let names = |image: &ImageFile| -> Vec<String> {
        let channels = image.layers()[0].channels().iter();
        channels.map(|c| c.name().to_owned()).collect()
    };
    assert_eq!(names(&st), ["G", "R"]);
    assert_eq!(names(&mv), ["forward.u", "forward.v"]);
    for (column, row) in [(0, 0), (39, 0), (13, 28)] {
        let (x, y) = (column as f32 + 0.5, row as f32 + 0.5);
        let place = pixels(&st).pixel(column, row);
        assert!((place[1] - x / 2.0 / 40.0).abs() < 1e-6, "{place:?}");
        assert!((place[0] - (1.0 - y / 40.0)).abs() < 1e-6, "{place:?}");
        let moved = pixels(&mv).pixel(column, row);
        assert!(
            (moved[0] - x).abs() < 1e-4 && moved[1].abs() < 1e-4,
            "{moved:?}"
        );
    }
    // And the map warps as the recipe does.
    let by_map = ["in.exr", "--from-stmap", "st.exr", "-o", "by-map.exr"];
    warp(&folder, &by_map, &[]).done();
    let (a, b) = (read(&folder, "out.exr"), read(&folder, "by-map.exr"));
    let mut apart = pixels(&a).samples().iter().zip(pixels(&b).samples());
    assert!(apart.all(|(a, b)| (a - b).abs() < 1e-4));
    let wrong = ["in.exr", "--from-stmap", "mv.exr", "-o", "no.exr"];
    warp(&folder, &wrong, &[]).failed(1, &["mv.exr", "no ST map", "R and G"]);
    let nothing = ["in.exr", "-o", "no.exr"];
    warp(&folder, &nothing, &[]).failed(2, &["--recipe"]);

    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("r.json")).unwrap()).unwrap();
    assert_eq!(report["pixels"], 1600);
    assert_eq!(report["format"], "exr");
}

#[test]
fn a_data_window_grows_and_the_display_window_stays() {
    let folder = Folder::new();
    folder
        .put("r.toml", WIDE)
        .put("in.exr", exr(&waves(40, 1), &["Y"]));
    warp(&folder, &["in.exr", "-r", "r.toml", "-o", "same.exr"], &[]).done();
    warp(
        &folder,
        &["in.exr", "-r", "r.toml", "-o", "grown.exr"],
        &["--grow"],
    )
    .done();
    let (same, grown) = (read(&folder, "same.exr"), read(&folder, "grown.exr"));
    assert_eq!(same.layers()[0].window(), Window::new(0, 0, 40, 40).ok());
    let window = grown.layers()[0].window().unwrap();
    assert!(
        window.x() <= 0 && (80..=84).contains(&window.width()),
        "{window}"
    );
    assert_eq!(grown.display(), same.display());
    // The far end of the picture is there.
    let column = usize::try_from(77 - window.x()).unwrap();
    let row = usize::try_from(20 - window.y()).unwrap();
    assert!(pixels(&grown).pixel(column, row)[0] > 0.0);
}

#[test]
fn folded_places_are_counted_and_spread_nothing() {
    let folder = Folder::new();
    // A point pulled far over its neighbours.
    let fold = "version = 1\n[[warp]]\nkind = \"points\"\n[[warp.point]]\nfrom = [20, 32]\nto = [50, 32]\nradius = 14\n";
    folder
        .put("r.toml", fold)
        .put("in.exr", exr(&waves(64, 1), &["Y"]));
    let forward = ["in.exr", "-r", "r.toml", "-o", "f.exr"];
    let run = warp(&folder, &forward, &["--mapping", "forward"]).done();
    assert!(run.err.contains("covered more than once"), "{}", run.err);
    warp(&folder, &["in.exr", "-r", "r.toml", "-o", "i.exr"], &[]).done();
    for name in ["f.exr", "i.exr"] {
        let image = read(&folder, name);
        assert!(
            pixels(&image).samples().iter().all(|s| s.is_finite()),
            "{name}"
        );
    }
}

#[test]
fn bad_inputs_are_one_message_and_write_nothing() {
    let folder = Folder::new();
    folder
        .put("r.toml", TURN)
        .put("in.exr", exr(&waves(16, 1), &["Z"]));
    folder
        .put("no.png", "not a picture")
        .put("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let damaged = [
        "png-bad-crc.png",
        "png-zero-size.png",
        "exr-zero-tile-size.exr",
        "openexr-02.exr",
    ];
    for name in damaged {
        folder.put(name, fixture(&format!("damaged/{name}")));
    }
    let inputs: Vec<&str> = ["r.toml", "in.exr", "no.png", "m.obj"]
        .into_iter()
        .chain(damaged)
        .collect();
    let fails = |arguments: &[&str], code: i32, says: &[&str]| {
        warp(&folder, arguments, &["-r", "r.toml"]).failed(code, says);
        nothing_written(&folder, &inputs);
    };
    fails(&["no.png", "-o", "o.png"], 1, &["no.png", "no image"]);
    for name in damaged {
        fails(&[name, "-o", "o.exr"], 1, &[name, ";"]);
    }
    fails(
        &["in.exr", "-o", "o.png"],
        1,
        &["no channel R, G, B or Y", "Z"],
    );
    fails(&["in.exr", "-o", "o.obj"], 1, &["cannot become OBJ"]);
    fails(
        &["in.exr", "-o", "o.exr", "--filter", "box"],
        2,
        &["box", "lanczos"],
    );
    fails(
        &["in.exr", "-o", "o.exr", "--edge", "round"],
        2,
        &["round", "mirror"],
    );
    fails(
        &["in.exr", "-o", "o.exr", "--max-error", "-1"],
        2,
        &["pixels"],
    );
    fails(
        &[
            "in.exr",
            "-o",
            "o.exr",
            "--preview",
            "p.gif",
            "--turntable",
            "9",
        ],
        2,
        &["turntable"],
    );
    fails(
        &["in.exr", "-o", "o.exr", "--frames", "3"],
        2,
        &["--output", "o.exr", "%04d"],
    );
    fails(
        &["in.exr", "-o", "o.exr", "--stmap", "o.exr"],
        2,
        &["a file of its own"],
    );
    fails(&["in.exr", "-o", "o.exr", "--stmap", "s.png"], 2, &[".exr"]);
    fails(
        &["m.obj", "-o", "o.obj", "--grow"],
        2,
        &["--grow is for images"],
    );
}
