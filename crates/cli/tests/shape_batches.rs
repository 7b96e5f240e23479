//! `anamorph morph --batch`, chains as meshes, axes of fonts.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::{Folder, fixture};

const BAR: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><path d="M10 40H90V60H10Z"/></svg>"##;
const BENT: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><path d="M10 40H60V90H40V60H10Z"/></svg>"##;
const SQUARE: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><path d="M20 20H80V80H20Z"/></svg>"##;

fn folder() -> Folder {
    let folder = Folder::new();
    std::fs::create_dir(folder.path().join("list")).unwrap();
    folder
        .put("list/bar.svg", BAR)
        .put("list/bent.svg", BENT)
        .put("list/square.svg", SQUARE);
    folder
}

#[test]
fn a_batch_goes_on_after_failures_and_says_which() {
    let folder = folder();
    folder.put(
        "list/all.toml",
        r#"
[[morph]]
inputs = ["bar.svg", "bent.svg"]
output = "first.svg"
frames = 3
ease = "ease-in-out"
[[morph]]
inputs = ["bar.svg", "missing.svg"]
output = "second.svg"
[[morph]]
inputs = ["bar.svg", "bent.svg"]
output = "third.svg"
colour = "red"
[[morph]]
inputs = ["bar.svg"]
output = "fourth.svg"
[[morph]]
inputs = ["bar.svg", "square.svg"]
output = "fifth.png"
at = 0.5
size = 64
matching = "matching.svg"
quiet = true
[[morph]]
inputs = ["bar.svg", "square.svg"]
"#,
    );
    let run = folder.run(&["morph", "--batch", "list/all.toml"]);
    let run = run.failed(1, &["missing.svg", "2 of 6 morphs done"]);
    for (number, says) in [
        (2, "second.svg"),
        (3, "--colour"),
        (4, "two or more"),
        (6, "output"),
    ] {
        let named = run.err.lines().any(|line| {
            line.starts_with(&format!("error: list/all.toml: morph {number}"))
                && line.contains(says)
        });
        assert!(named, "{number}: {}", run.err);
    }
    for (name, there) in [
        ("first.svg", true),
        ("second.svg", false),
        ("third.svg", false),
        ("fifth.png", true),
        ("matching.svg", true),
    ] {
        let path = folder.path().join("list").join(name);
        assert_eq!(path.exists(), there, "{name}");
    }
    // Again: what exists is not replaced, unless that is asked for.
    folder.put(
        "list/one.toml",
        "[[morph]]\ninputs = [\"bar.svg\", \"bent.svg\"]\noutput = \"first.svg\"\n",
    );
    folder
        .run(&["morph", "--batch", "list/one.toml"])
        .failed(1, &["first.svg", "0 of 1"]);
    let run = folder
        .run(&["morph", "--batch", "list/one.toml", "-f", "-q"])
        .done();
    assert_eq!(run.err, "");
}

#[test]
fn lists_that_are_none_are_refused() {
    let folder = folder();
    for (text, says) in [
        ("", "no morph"),
        ("morph = 3", "no morph"),
        ("[[morphs]]\n", "morphs"),
        ("[[morph]\n", "TOML"),
    ] {
        folder.put("list.toml", text);
        folder
            .run(&["morph", "--batch", "list.toml"])
            .failed(1, &["list.toml", says]);
    }
    folder
        .run(&["morph", "--batch", "none.toml"])
        .failed(1, &["none.toml"]);
    for more in [
        &["list/bar.svg"][..],
        &["-o", "x.svg"],
        &["--frames", "3"],
        &["--scheme", "log"],
        &["--silhouette"],
        &["--filter", "nearest"],
    ] {
        let all = [&["morph", "--batch", "list.toml"][..], more].concat();
        folder.run(&all).failed(2, &["--batch"]);
    }
    folder.run(&["morph"]).failed(2, &["INPUT"]);
    folder
        .run(&["morph", "list/bar.svg", "list/bent.svg"])
        .failed(2, &["--output"]);
}

#[test]
fn chains_are_numbered_meshes() {
    let folder = folder();
    let chain = [
        "morph",
        "list/bar.svg",
        "list/bent.svg",
        "list/square.svg",
        "--frames",
        "7",
        "-o",
    ];
    let run = |out: &str| folder.run(&[&chain[..], &[out]].concat());
    run("x.glb").failed(2, &["out.%d.glb"]);
    run("x.%d.glb").done();
    for number in ["1", "2"] {
        let bytes = folder.read(&format!("x.{number}.glb"));
        let document = gltf::Gltf::from_slice(&bytes).unwrap();
        let mesh = document.meshes().next().unwrap();
        let primitive = mesh.primitives().next().unwrap();
        assert_eq!(primitive.morph_targets().count(), 3);
    }
    assert!(!folder.path().join("x.3.glb").exists());
    // Every OBJ frame has the mesh of its step, with texture coordinates that stay.
    run("x.%d.obj").done();
    let lines = |number: usize, word: &str| -> Vec<String> {
        let text = String::from_utf8(folder.read(&format!("x.{number}.obj"))).unwrap();
        let lines = text.lines().filter(|line| line.starts_with(word));
        lines.map(str::to_owned).collect()
    };
    for (a, b) in [(1, 3), (4, 7)] {
        assert_eq!(lines(a, "f "), lines(b, "f "));
        assert_eq!(lines(a, "vt "), lines(b, "vt "));
        assert_ne!(lines(a, "v "), lines(b, "v "));
    }
    assert_ne!(lines(3, "f "), lines(4, "f "));
}

#[test]
fn fonts_are_set_on_their_axes() {
    let folder = Folder::new();
    folder.put("stems.ttf", fixture("valid/stems-variable.ttf"));
    // The stem is a bar of 700 units: 100 wide at 400, 300 at 900, 20 at 100.
    let morph = |at: &str, axes: &[&str]| {
        let own = [
            "morph",
            "stems.ttf",
            "stems.ttf",
            "--text",
            "I",
            "-f",
            "--at",
            at,
            "-o",
            "x.json",
        ];
        folder.run(&[&own[..], axes].concat())
    };
    let area = |at: &str, axes: &[&str]| -> f64 {
        morph(at, axes).done();
        let drawing = anamorph_io::outlines::read(&folder.read("x.json")).unwrap();
        let polygons = drawing.parts.iter().flat_map(|part| part.polygons(0.01));
        polygons
            .map(|polygon| anamorph_morph::shapes::area(&polygon.outer))
            .sum()
    };
    for (at, axes, width) in [
        ("0", &[][..], 100.0),
        ("0", &["--axis", "wght=900"], 300.0),
        ("1", &["--axis", "wght=900"], 300.0),
        ("0", &["--axis", "wght=100,900"], 20.0),
        ("1", &["--axis", "wght=100,900", "--axis", "slnt=-4"], 300.0),
    ] {
        let found = area(at, axes).abs() / 700.0;
        assert!((found - width).abs() < 0.5, "{at} {axes:?}: {found}");
    }
    // Letters of unlike widths keep their sizes: `L` is as high as `I` and `LL`.
    let text = ["--text", "I", "LL"];
    let own = [
        "morph",
        "stems.ttf",
        "stems.ttf",
        "-f",
        "--at",
        "1",
        "-o",
        "x.json",
    ];
    folder.run(&[&own[..], &text].concat()).done();
    let drawing = anamorph_io::outlines::read(&folder.read("x.json")).unwrap();
    let [low, high] = drawing.bounds().unwrap();
    assert!((high.y - low.y - 700.0).abs() < 0.5, "{low} {high}");
    morph("0", &["--axis", "wdth=3"]).failed(1, &["stems.ttf", "wdth"]);
    morph("0", &["--axis", "wght=1,2,3"]).failed(2, &["3 numbers", "2 fonts"]);
    morph("0", &["--axis", "wght"]).failed(2, &["wght=700"]);
    folder.put("bar.svg", BAR).put("bent.svg", BENT);
    folder
        .run(&[
            "morph", "bar.svg", "bent.svg", "-o", "y.svg", "--axis", "wght=700",
        ])
        .failed(2, &["0 fonts"]);
}
