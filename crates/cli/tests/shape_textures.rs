//! `anamorph morph --texture`: images on shapes.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use anamorph_io::images::{EncodeOptions, ImageFile, ImageFormat, ImageLimits};
use anamorph_raster::{Raster, Window};
use common::Folder;

const BAR: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 40"><path fill="#d02020" d="M6 14H54V27H6Z"/></svg>"##;
const BENT: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 120 80"><path id="body" fill="#2040d0" d="M12 16H80V72H56V42H12Z"/></svg>"##;

/// A picture whose pixels all differ, as PNG of 8 bits.
fn picture(width: usize, height: usize, seed: usize) -> Vec<u8> {
    let window = Window::new(0, 0, width, height).unwrap();
    let samples = (0..width * height).flat_map(|i| {
        let (x, y) = (i % width, i / width);
        let code = |n: usize| ((n * 37 + seed * 11) % 256) as f32 / 255.0;
        [code(x * 3 + y), code(y * 5), code(x + 7 * y), 1.0]
    });
    let raster = Raster::from_samples(window, 4, samples.collect()).unwrap();
    let file = ImageFile::data(&raster, &["R", "G", "B", "A"]).unwrap();
    file.encode(ImageFormat::Png, &EncodeOptions::default())
        .unwrap()
        .0
}

fn pixels(bytes: &[u8]) -> Raster {
    let file = ImageFile::read(bytes, ImageLimits::NONE).unwrap();
    file.colours().unwrap().into_owned()
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder
        .put("bar.svg", BAR)
        .put("bent.svg", BENT)
        .put("a.png", picture(180, 120, 1))
        .put("b.png", picture(240, 160, 2));
    folder
}

const TEXTURED: [&str; 6] = [
    "morph",
    "bar.svg",
    "bent.svg",
    "--texture",
    "a.png",
    "b.png",
];

fn with(more: &[&'static str]) -> Vec<&'static str> {
    TEXTURED.iter().chain(more).copied().collect()
}

#[test]
fn the_ends_are_the_images_pixel_by_pixel() {
    let folder = folder();
    // Insides of the shapes in pixels of each image: bars of whole pixels.
    for (at, size, image, boxes) in [
        ("0", "180", "a.png", vec![[18, 42, 162, 81]]),
        (
            "1",
            "240",
            "b.png",
            vec![[24, 32, 160, 84], [112, 84, 160, 144]],
        ),
    ] {
        folder
            .run(&with(&["-o", "end.png", "--at", at, "--size", size, "-f"]))
            .done();
        let (found, given) = (pixels(&folder.read("end.png")), pixels(&folder.read(image)));
        assert_eq!(found.window(), given.window());
        let mut whole = 0;
        for y in 0..found.height() {
            for x in 0..found.width() {
                let inside = boxes
                    .iter()
                    .any(|[l, t, r, b]| (*l..*r).contains(&x) && (*t..*b).contains(&y));
                let pixel = found.pixel(x, y);
                if inside {
                    whole += 1;
                    assert_eq!(pixel[..3], given.pixel(x, y)[..3], "{at}: {x} {y}");
                    assert_eq!(pixel[3], 1.0);
                } else {
                    assert_eq!(pixel, [0.0; 4], "{at}: {x} {y}");
                }
            }
        }
        assert!(whole > 5000);
    }
}

#[test]
fn frames_are_the_same_on_any_number_of_threads() {
    let folder = folder();
    for threads in ["1", "3"] {
        let out = format!("t{threads}.%02d.png");
        let mut all = with(&["--frames", "4", "--threads", threads, "-o"]);
        let out: &'static str = out.leak();
        all.push(out);
        folder.run(&all).done();
    }
    for number in 1..=4 {
        let one = folder.read(&format!("t1.{number:02}.png"));
        assert!(one == folder.read(&format!("t3.{number:02}.png")));
        // Without --size a frame is as large as the first image.
        assert_eq!(pixels(&one).window(), Window::new(0, 0, 180, 120).unwrap());
    }
    // Half way there are both.
    let half = pixels(&folder.read("t1.02.png"));
    let opaque = half.samples().chunks_exact(4).filter(|p| p[3] == 1.0);
    let partly = half.samples().chunks_exact(4);
    assert!(opaque.count() > 3000 && partly.filter(|p| p[3] > 0.0 && p[3] < 1.0).count() > 50);
}

#[test]
fn films_chains_pairs_and_what_has_no_partner() {
    let folder = folder();
    folder.put(
        "two.svg",
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 40"><path id="body" d="M6 4H54V12H6Z"/><circle cx="30" cy="28" r="9"/></svg>"#,
    );
    for out in ["out.gif", "out.apng", "out.y4m"] {
        folder.run(&with(&["--frames", "3", "-o", out])).done();
        assert!(folder.read(out).len() > 1000);
    }
    folder
        .run(&["mesh", "bar.svg", "bent.svg", "-o", "pair.json"])
        .done();
    // A pair's images both lie over its canvas; the first's does so in the shapes' own morph, too.
    let pair = [
        "morph",
        "pair.json",
        "--texture",
        "a.png",
        "b.png",
        "--at",
        "0",
    ];
    folder
        .run(&[&pair[..], &["-o", "pair.png"]].concat())
        .done();
    folder.run(&with(&["--at", "0", "-o", "own.png"])).done();
    assert!(folder.read("pair.png") == folder.read("own.png"));
    folder
        .run(&[
            "morph",
            "bar.svg",
            "bent.svg",
            "two.svg",
            "--texture",
            "a.png",
            "b.png",
            "a.png",
            "--pieces",
            "grow",
            "--frames",
            "7",
            "-o",
            "chain.#.png",
        ])
        .done();
    // The disc that grows is there in the end and not before.
    let alpha = |name: &str| pixels(&folder.read(name)).pixel(81, 84)[3];
    assert_eq!((alpha("chain.4.png"), alpha("chain.7.png")), (0.0, 1.0));
    let growing = alpha("chain.6.png");
    assert!(growing > 0.0 && growing < 1.0, "{growing}");
    // A silhouette wears its own image.
    folder
        .run(&[
            "morph",
            "chain.7.png",
            "chain.1.png",
            "--silhouette",
            "--texture",
            "chain.7.png",
            "chain.1.png",
            "--at",
            "0.5",
            "-o",
            "s.png",
        ])
        .done();
}

#[test]
fn what_holds_no_pixels_is_refused() {
    let folder = folder();
    folder.put("bad.png", &b"\x89PNG\r\n\x1a\nnothing"[..]);
    for out in ["x.svg", "x.json", "x.glb", "x.%02d.obj"] {
        folder
            .run(&with(&["-o", out]))
            .failed(2, &["--texture draws pixels", out]);
    }
    for (arguments, says) in [
        (
            &[
                "morph",
                "bar.svg",
                "bent.svg",
                "--texture",
                "a.png",
                "-o",
                "x.gif",
            ][..],
            "an image for each",
        ),
        (
            &[
                "morph",
                "bar.svg",
                "bent.svg",
                "--texture",
                "a.png",
                "bad.png",
                "-o",
                "x.gif",
            ],
            "bad.png",
        ),
        (
            &[
                "morph",
                "bar.svg",
                "bent.svg",
                "--texture",
                "a.png",
                "none.png",
                "-o",
                "x.gif",
            ],
            "none.png",
        ),
        (&with(&["--at", "0", "-o", "a.png", "-f"])[..], "replace"),
        (
            &[
                "morph",
                "a.png",
                "b.png",
                "--texture",
                "a.png",
                "b.png",
                "-o",
                "x.gif",
                "-l",
                "c",
                "d",
            ],
            "--texture",
        ),
    ] {
        let run = folder.run(arguments);
        assert_ne!(run.code, 0, "{arguments:?}");
        assert!(run.err.contains(says), "{arguments:?}: {}", run.err);
        assert!(!folder.path().join("x.gif").exists());
    }
}
