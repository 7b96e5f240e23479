//! Damaged and odd models: one clear message or the right result, never a panic, a part of a file, or more memory than
//! the file is worth.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::{EMPTY, Folder, TWIST, fixture, listed};
use serde_json::json;

/// Every file of `tests/fixtures/damaged`: what the message says.
const DAMAGED: &[(&str, &[&str])] = &[
    ("as-box-utf16-be.obj", &["UTF-16", "save it as UTF-8"]),
    (
        "as-malformed.obj",
        &[
            "line 23, column 5: face 1 refers to vertex \"12\", but the file has 8 vertices; correct the index",
        ],
    ),
    (
        "huge-index.obj",
        &[
            "line 9, column 7: face 1 refers to vertex \"4294967297\"",
            "8 vertices",
        ],
    ),
    (
        "nan-vertex.obj",
        &[
            "line 7, column 3: the x coordinate of vertex 7 is \"nan\"",
            "--allow-nonfinite",
        ],
    ),
    (
        "tm-notenoughindices.obj",
        &["line 9, column 1: face 1 has 2 corners and needs at least 3; add"],
    ),
    (
        "to-invalid-face-definition.obj",
        &["line 15, column 1: face 1 has 1 corner and needs at least 3"],
    ),
    (
        "to-invalid-relative-vertex-index.obj",
        &[
            "line 1, column 3: face 1 refers back to vertex \"-4\", but only 0 vertices come before it",
        ],
    ),
    (
        "to-issue-140-zero-face-idx.obj",
        &["line 16, column 3: face 1 has the index 0 in \"0/0/0\"; count from 1"],
    ),
    (
        "to-test-nan.obj",
        &[
            "line 12, column 3: the x coordinate of vertex 1 is \"nan\"",
            "--allow-nonfinite",
        ],
    ),
];

/// Kind, count and line of the first.
type Found = (&'static str, u64, u64);

/// Odd files that are read: what `inspect` finds in them.
const ODD: &[(&str, &[Found])] = &[
    ("as-box-without-lineending.obj", &[]),
    ("as-concave-polygon.obj", &[("repeated-vertex", 1, 77)]),
    (
        "degenerate-triangles.obj",
        &[
            ("repeated-vertex", 2, 7),
            ("zero-area-face", 2, 6),
            ("coincident-vertex", 1, 5),
            ("non-manifold-edge", 1, 7),
        ],
    ),
    ("flat-zero-thickness.obj", &[]),
    ("huge-coordinates.obj", &[("zero-area-face", 1, 6)]),
    (
        "inconsistent-winding.obj",
        &[("inconsistent-winding", 8, 11)],
    ),
    (
        "isolated-vertices.obj",
        &[("zero-area-face", 1, 51), ("unused-vertex", 47, 4)],
    ),
    ("nonmanifold-bowtie-vertex.obj", &[]),
    ("nonmanifold-edge.obj", &[("non-manifold-edge", 1, 16)]),
    ("spot.obj", &[]),
    ("teapot.obj", &[("coincident-vertex", 403, 6)]),
    ("tm-face-in-group-name.obj", &[]),
    ("tm-nancolor.obj", &[("non-finite-attribute", 1, 7)]),
    ("tm-negative-indices.obj", &[]),
    ("tm-obj-points.obj", &[]),
    ("tm-polygonfaces.obj", &[]),
    ("tm-singlevn.obj", &[]),
    ("tm-wallhole.obj", &[("coincident-vertex", 57, 13)]),
    ("to-cube-vertex-w-component.obj", &[]),
    ("to-issue-161-inconsistent-f.obj", &[]),
    ("to-leading-zero-in-exponent-notation-issue-210.obj", &[]),
];

/// The tables above name each fixture: a new one asks for a line.
#[test]
fn every_fixture_has_its_line() {
    let names = |list: Vec<&str>| -> Vec<String> { list.into_iter().map(str::to_owned).collect() };
    let damaged = DAMAGED.iter().map(|case| case.0).collect();
    assert_eq!(listed("tests/fixtures/damaged", ".obj"), names(damaged));
    let odd = ODD.iter().map(|case| case.0).collect();
    assert_eq!(listed("tests/fixtures/valid", ".obj"), names(odd));
}

#[test]
fn damaged_models_are_refused_with_one_clear_message() {
    for (name, says) in DAMAGED {
        let folder = Folder::with(&format!("damaged/{name}"), &[("twist.toml", TWIST)]);
        let before = folder.names();
        let arguments = [
            "warp",
            name,
            "-r",
            "twist.toml",
            "-o",
            "out/",
            "--report",
            "reports/",
            "--preview",
            "out/",
        ];
        let run = folder.run(&arguments).failed(1, says);
        let prefix = format!("error: {name}: ");
        assert!(run.err.starts_with(&prefix), "{}", run.err);
        assert_eq!(run.err.lines().count(), 1, "{}", run.err);
        assert_eq!(run.out, b"");
        assert_eq!(folder.names(), before, "{name} leaves something behind");
        // The same through standard input, and no part of it on standard output.
        let input = fixture(&format!("damaged/{name}"));
        let run = folder.run_with(&input, &["warp", "-", "-r", "twist.toml", "-o", "-"]);
        assert_eq!(run.failed(1, says).out, b"");
    }
}

#[test]
fn an_empty_recipe_changes_no_byte() {
    for (name, _) in ODD {
        let folder = Folder::with(&format!("valid/{name}"), &[("empty.toml", EMPTY)]);
        let run = folder.run(&[
            "warp",
            name,
            "-r",
            "empty.toml",
            "-o",
            "out.obj",
            "--report",
            "report.json",
        ]);
        assert!(run.done().err.contains("0 of"), "{name}");
        assert!(
            folder.read("out.obj") == folder.read(name),
            "{name} differs"
        );
        let report = folder.json("report.json");
        assert_eq!(report["points"]["moved"], 0);
        assert_eq!(report["points"]["farthest"], json!(null));
        assert_eq!(report["normals"]["changed"], 0);
        let run = folder.run_with(
            &folder.read(name),
            &["warp", "-", "-r", "empty.toml", "-o", "-"],
        );
        assert!(run.done().out == folder.read(name), "{name} differs");
    }
}

/// Every odd model through every committed recipe, with a picture: done or refused, but nothing in between.
#[test]
fn odd_models_are_warped_or_refused() {
    for recipe in ["lattice.toml", "twist.toml"] {
        let text =
            std::fs::read_to_string(common::repository("docs/recipes").join(recipe)).unwrap();
        for (name, _) in ODD {
            let folder = Folder::with(&format!("valid/{name}"), &[(recipe, &text)]);
            let before = folder.names();
            let mut made = vec!["out.obj", "report.json"];
            let mut arguments = vec!["warp", name, "-r", recipe, "-o", "out.obj"];
            arguments.extend(["--report", "report.json"]);
            // Pictures take a while.
            if recipe == "twist.toml" {
                arguments.extend(["--preview", "out.png", "--size", "48x32"]);
                made.push("out.png");
            }
            let run = folder.run(&arguments);
            if run.code == 0 {
                for made in made {
                    assert!(!folder.read(made).is_empty(), "{name} {recipe} {made}");
                }
                // What was written is read again, and only the numbers of moved vertices have changed.
                let lines = |bytes: Vec<u8>| bytes.split(|b| *b == b'\n').count();
                let run = folder.run(&["inspect", "out.obj", "--json"]).done().json();
                let was = folder.run(&["inspect", name, "--json"]).done().json();
                assert_eq!(
                    run[0]["counts"]["faces"], was[0]["counts"]["faces"],
                    "{name} {recipe}"
                );
                assert_eq!(
                    run[0]["attributes"], was[0]["attributes"],
                    "{name} {recipe}"
                );
                if was[0]["counts"]["normals"].is_null() {
                    assert_eq!(lines(folder.read("out.obj")), lines(folder.read(name)));
                }
            } else {
                run.failed(1, &[recipe, "; "]);
                assert_eq!(folder.names(), before, "{name} {recipe}");
            }
        }
    }
}

#[test]
fn inspect_names_what_is_odd() {
    for (name, expected) in ODD {
        let folder = Folder::with(&format!("valid/{name}"), &[]);
        let found = folder.run(&["inspect", "--json", name]).done().json();
        let list = found.as_array().unwrap();
        assert_eq!(list.len(), 1);
        assert_eq!(list[0]["file"], *name);
        assert_eq!(list[0]["format"], "obj");
        assert_eq!(list[0]["dimension"], 3);
        let problems: Vec<(String, u64, u64)> = list[0]["problems"]
            .as_array()
            .unwrap()
            .iter()
            .map(|p| {
                assert!(p["title"].is_string() && p["first"].is_string(), "{p}");
                (
                    p["kind"].as_str().unwrap().to_owned(),
                    p["count"].as_u64().unwrap(),
                    p["line"].as_u64().unwrap(),
                )
            })
            .collect();
        let expected: Vec<(String, u64, u64)> = expected
            .iter()
            .map(|&(kind, count, line)| (kind.to_owned(), count, line))
            .collect();
        assert_eq!(problems, expected, "{name}");
    }
}

/// `inspect` looks into damaged files too, unless there is nothing that could be a model.
#[test]
fn inspect_reads_damaged_files() {
    for (name, kind, count, line) in [
        ("as-malformed.obj", "broken-element", 2, 23),
        ("huge-index.obj", "broken-element", 3, 9),
        ("nan-vertex.obj", "non-finite-point", 2, 7),
        ("tm-notenoughindices.obj", "broken-element", 1, 9),
        ("to-invalid-face-definition.obj", "broken-element", 2, 15),
        ("to-issue-140-zero-face-idx.obj", "broken-element", 2, 16),
        ("to-test-nan.obj", "non-finite-point", 4, 12),
    ] {
        let folder = Folder::with(&format!("damaged/{name}"), &[]);
        let found = folder.run(&["inspect", "--json", name]).done().json();
        let first = &found[0]["problems"][0];
        assert_eq!(
            (&first["kind"], &first["count"], &first["line"]),
            (&json!(kind), &json!(count), &json!(line)),
            "{name}"
        );
        let text = folder.run(&["inspect", name]).done().text();
        assert!(text.contains(&format!("(line {line})")), "{text}");
    }
    // One that cannot be read does not keep the others from being shown.
    let folder = Folder::with("damaged/as-box-utf16-be.obj", &[]);
    folder.put("good.obj", fixture("valid/tm-polygonfaces.obj"));
    let run = folder.run(&["inspect", "--json", "as-box-utf16-be.obj", "good.obj"]);
    let found = run
        .failed(1, &["as-box-utf16-be.obj: the text is UTF-16"])
        .json();
    assert_eq!(found.as_array().unwrap().len(), 1);
    assert_eq!(found[0]["file"], "good.obj");
}

/// Whatever the numbers in a file claim, memory stays within what the file is worth: here a limit on all of the
/// process's address space.
#[cfg(target_os = "linux")]
#[test]
fn memory_is_bounded() {
    const LIMIT_KIB: usize = 600_000;
    let huge = "[4294967296, 4294967296, 4294967296]";
    let cases = [
        ("damaged/huge-index.obj", TWIST.to_owned(), 1),
        (
            "damaged/to-invalid-relative-vertex-index.obj",
            TWIST.to_owned(),
            1,
        ),
        ("valid/huge-coordinates.obj", TWIST.to_owned(), 0),
        (
            "valid/spot.obj",
            format!("version = 1\n[[warp]]\nkind = \"lattice\"\nshape = {huge}\nmove = []\n"),
            1,
        ),
        (
            "valid/spot.obj",
            format!(
                "version = 1\n[[warp]]\nkind = \"spline-lattice\"\nshape = {huge}\nmove = []\n"
            ),
            1,
        ),
        (
            "valid/spot.obj",
            format!("version = 1\nname = {}", "[".repeat(100_000)),
            1,
        ),
    ];
    for (path, recipe, code) in cases {
        let folder = Folder::with(path, &[("recipe.toml", &recipe)]);
        let name = path.rsplit('/').next().unwrap();
        let mut shell = std::process::Command::new("sh");
        let script = format!("ulimit -v {LIMIT_KIB} && exec \"$@\"");
        shell
            .args(["-c", &script, "sh", env!("CARGO_BIN_EXE_anamorph")])
            .args([
                "warp",
                name,
                "-r",
                "recipe.toml",
                "-o",
                "out.obj",
                "--threads",
                "1",
            ])
            .current_dir(folder.path())
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped());
        let run = folder.finish(&mut shell, b"");
        assert_eq!(run.code, code, "{path}: {run:?}");
    }
}

#[test]
fn files_that_are_no_models_are_refused() {
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".as_slice();
    let program = b"\x7fELF\x02\x01\x01\0\0\0\0".as_slice();
    let cases: [(&str, &[u8], &[&str]); 13] = [
        ("picture.png", png, &["the PNG file is damaged"]),
        ("empty.obj", b"", &["the file is empty; give an OBJ file"]),
        ("empty", b"", &["there is nothing in it"]),
        (
            "program.bin",
            program,
            &[
                "neither the content nor the name",
                "ply, off, stl, obj, csv",
            ],
        ),
        (
            "program.obj",
            program,
            &["zero, so this is binary data and not OBJ text"],
        ),
        (
            "mac.obj",
            b"v 0 0 0\rv 1 0 0\r",
            &["old Macintosh", "line feeds"],
        ),
        (
            "comma.obj",
            b"v 0,5 0 0\n",
            &["\"0,5\", which is not a number; write a decimal point"],
        ),
        (
            "short.obj",
            b"v 1 2\n",
            &["line 1, column 1: vertex 1 has 2 coordinates and needs 3"],
        ),
        (
            "letters.csv",
            b"x,y\n1,a\n",
            &["line 2, column 3: the y coordinate of point 1 (column 2) is \"a\""],
        ),
        (
            "ragged.csv",
            b"x,y\n1\n",
            &["line 2, column 1: the row of point 1 has 1 fields"],
        ),
        (
            "headless.csv",
            b"1,2\n3,4\n",
            &[
                "the first row holds numbers",
                "add a first line such as x,y",
            ],
        ),
        (
            "quote.csv",
            b"x,y\n\"1,2\n",
            &["line 2, column 1: the quote that begins here is not closed"],
        ),
        (
            "rowless.csv",
            b"x,y\n",
            &["the table has a header but no rows"],
        ),
    ];
    for (name, content, says) in cases {
        let folder = Folder::new();
        folder.put(name, content).put("empty.toml", EMPTY);
        let before = folder.names();
        folder
            .run(&["warp", name, "-r", "empty.toml", "-o", "out/"])
            .failed(1, says);
        assert_eq!(folder.names(), before, "{name}");
    }
}
