//! `anamorph morph` of shapes: what it reads, what it writes, what it refuses.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use anamorph_io::images::{ImageFile, ImageLimits};
use anamorph_io::outlines;
use common::{Folder, Run};

const BAR: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><path fill="#d02020" d="M10 40H90V60H10Z"/></svg>"##;
const BENT: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><path fill="#2040d0" d="M10 40H60V90H40V60H10Z"/></svg>"##;
const RING: &str = r#"{"y_axis": "down", "canvas": [0, 0, 100, 100], "polygons": [{"outer": [[10, 10], [90, 10], [90, 90], [10, 90]],
 "holes": [[[40, 40], [40, 60], [60, 60], [60, 40]]]}]}"#;

fn folder() -> Folder {
    let folder = Folder::new();
    folder
        .put("bar.svg", BAR)
        .put("bent.svg", BENT)
        .put("ring.json", RING);
    folder
}

fn morph(folder: &Folder, arguments: &[&str]) -> Run {
    let mut all = vec!["morph"];
    all.extend(arguments);
    folder.run(&all)
}

#[test]
fn drawings_become_one_another_in_every_form() {
    let folder = folder();
    for name in ["out.svg", "out.json", "out.gif", "out.apng", "out.glb"] {
        let run = morph(
            &folder,
            &[
                "bar.svg", "bent.svg", "-o", name, "--frames", "5", "--size", "64",
            ],
        );
        run.done();
        assert!(folder.read(name).len() > 400, "{name}");
    }
    let text = String::from_utf8(folder.read("out.svg")).unwrap();
    assert!(
        text.contains("<animate") && text.contains("attributeName=\"d\""),
        "{text}"
    );
    let lottie: serde_json::Value = serde_json::from_slice(&folder.read("out.json")).unwrap();
    assert!(lottie["layers"].is_array() && lottie["v"].is_string());
    for kind in ["svg", "png", "json", "obj"] {
        let pattern = format!("f.%02d.{kind}");
        morph(
            &folder,
            &["bar.svg", "ring.json", "-o", &pattern, "--frames", "3"],
        )
        .done();
        assert!(!folder.read(&format!("f.03.{kind}")).is_empty());
    }
}

#[test]
fn the_ends_are_the_drawings() {
    let folder = folder();
    for (at, source) in [("0", "bar.svg"), ("1", "ring.json")] {
        let out = format!("at{at}.json");
        morph(&folder, &["bar.svg", "ring.json", "-o", &out, "--at", at]).done();
        let area = |bytes: &[u8]| -> f64 {
            let drawing = outlines::read(bytes).unwrap();
            let polygons = drawing.parts.iter().flat_map(|part| part.polygons(0.01));
            let ring = |ring: &Vec<_>| anamorph_morph::shapes::area(ring);
            polygons
                .map(|p| ring(&p.outer) + p.holes.iter().map(ring).sum::<f64>())
                .sum()
        };
        let (found, given) = (area(&folder.read(&out)), area(&folder.read(source)));
        assert!(
            (found - given).abs() < 1e-3 * given,
            "{at}: {found} {given}"
        );
    }
}

#[test]
fn chains_metrics_and_pictures_of_the_matching() {
    let folder = folder();
    morph(
        &folder,
        &[
            "bar.svg",
            "bent.svg",
            "ring.json",
            "-o",
            "chain.svg",
            "--frames",
            "7",
            "--metrics",
            "m.json",
            "--matching",
            "m.png",
        ],
    )
    .done();
    let metrics: serde_json::Value = serde_json::from_slice(&folder.read("m.json")).unwrap();
    let morphs = metrics["morphs"].as_array().unwrap();
    assert_eq!(morphs.len(), 2);
    for morph in morphs {
        let own = &morph["methods"][0];
        assert_eq!(own["flips"], 0, "{own}");
        assert!(own["smallest_determinant"].as_f64().unwrap() > 0.0);
    }
    assert!(folder.read("m.png").starts_with(b"\x89PNG"));
}

#[test]
fn what_cannot_be_is_refused_and_nothing_written() {
    let folder = folder();
    folder.put(
        "empty.svg",
        r#"<svg xmlns="http://www.w3.org/2000/svg"><path d=""/></svg>"#,
    );
    folder.put("anchors.toml", "[[anchor]]\nsource = 0\ntarget = 99\n");
    for (arguments, says) in [
        (&["bar.svg", "empty.svg", "-o", "x.svg"][..], "empty.svg"),
        (
            &["bar.svg", "bent.svg", "-o", "x.svg", "--scheme", "wave"],
            "wave",
        ),
        (
            &[
                "bar.svg",
                "bent.svg",
                "-o",
                "x.svg",
                "--anchors",
                "anchors.toml",
            ],
            "99",
        ),
        (&["bar.svg", "bent.svg", "-o", "x.tga"], "x.tga"),
        (
            &["bar.svg", "bent.svg", "-o", "bar.svg", "--force"],
            "replace",
        ),
        (
            &[
                "bar.svg",
                "bent.svg",
                "-o",
                "x.svg",
                "--landmarks",
                "a",
                "b",
            ],
            "--landmarks",
        ),
        (&["bar.svg", "missing.svg", "-o", "x.svg"], "missing.svg"),
    ] {
        let run = morph(&folder, arguments);
        assert_ne!(run.code, 0, "{arguments:?}");
        assert!(run.err.contains(says), "{arguments:?}: {}", run.err);
        assert!(!folder.path().join("x.svg").exists());
    }
}

fn fixture(name: &str) -> String {
    format!(
        "{}/../../tests/fixtures/shapes/{name}",
        env!("CARGO_MANIFEST_DIR")
    )
}

#[test]
fn metrics_are_those_of_what_is_drawn() {
    let folder = folder();
    let [a, b] = ["letter-A.json", "letter-B.json"].map(fixture);
    folder
        .run(&[
            "morph",
            &a,
            &b,
            "--at",
            "0.5",
            "-o",
            "x.obj",
            "--metrics",
            "m.json",
            "-q",
        ])
        .done();
    let metrics: serde_json::Value = serde_json::from_slice(&folder.read("m.json")).unwrap();
    for couple in metrics["morphs"].as_array().unwrap() {
        assert!(couple["mesh"]["triangles_of_overlay"].as_u64().unwrap() > 0);
        for method in couple["methods"].as_array().unwrap() {
            let name = method["method"].as_str().unwrap();
            if name != "vertex-linear" && name != "as-rigid-as-possible" {
                assert_eq!(method["flips"], 0, "{name}: {}", method["error"]);
                assert!(method["frames"][10]["unfinished"].is_u64());
            }
        }
    }
    // Nothing is flat in the file, either.
    let text = String::from_utf8(folder.read("x.obj")).unwrap();
    let (mut points, mut count) = (Vec::new(), 0);
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let mut number = || words.next().unwrap().parse::<f64>().unwrap();
                points.push([number(), number()]);
            }
            Some("f") => {
                let number = |word: &str| word.split('/').next().unwrap().parse::<usize>().unwrap();
                let [p, q, r]: [[f64; 2]; 3] = words
                    .map(|word| points[number(word) - 1])
                    .collect::<Vec<_>>()
                    .try_into()
                    .unwrap();
                let twice = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
                assert!(twice > 0.0, "{line}");
                count += 1;
            }
            _ => {}
        }
    }
    assert!(count > 100);
}

#[test]
fn what_lies_over_itself_is_filled_and_holes_stay_open() {
    let folder = folder();
    folder
        .run(&[
            "morph",
            "ring.json",
            "ring.json",
            "--at",
            "0.5",
            "-o",
            "x.svg",
            "-q",
        ])
        .done();
    assert!(
        !String::from_utf8(folder.read("x.svg"))
            .unwrap()
            .contains("evenodd")
    );
    folder
        .run(&[
            "morph",
            "ring.json",
            "ring.json",
            "--at",
            "0.5",
            "-o",
            "x.png",
            "-q",
        ])
        .done();
    let image = ImageFile::read(&folder.read("x.png"), ImageLimits::of_file(1 << 20)).unwrap();
    let raster = image.colours().unwrap();
    let at = |x: usize, y: usize| raster.samples()[(y * raster.width() + x) * raster.channels()];
    let (wide, high) = (raster.width(), raster.height());
    assert!(at(wide / 2, high / 2) > 0.9, "the hole");
    assert!(at(wide / 4, high / 2) < 0.1, "the ring");
}

#[test]
fn results_of_one_name_and_files_that_are_not_there_are_refused_at_once() {
    let folder = folder();
    folder
        .run(&[
            "morph",
            "bar.svg",
            "bent.svg",
            "-o",
            "x.svg",
            "--matching",
            "x.svg",
        ])
        .failed(2, &["x.svg", "two results"]);
    assert!(!folder.path().join("x.svg").exists());
    folder
        .run(&["morph", "none.svg", "nothing.svg", "-o", "x.svg"])
        .failed(1, &["none.svg"]);
}
