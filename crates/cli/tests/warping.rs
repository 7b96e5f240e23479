//! What is computed: the same on any number of threads, normals and attributes as asked, points that are not finite
//! untouched, numbers that overflow refused.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::{EMPTY, Folder, TWIST, fixture};
use std::fmt::Write as _;

/// The three coordinates behind a keyword in all lines that begin with it.
fn vectors(bytes: &[u8], keyword: &str) -> Vec<[f64; 3]> {
    let text = String::from_utf8(bytes.to_vec()).unwrap();
    text.lines()
        .filter_map(|line| line.strip_prefix(keyword)?.strip_prefix(' '))
        .map(|rest| {
            let mut numbers = rest.split_whitespace().map(|n| n.parse().unwrap());
            [(); 3].map(|()| numbers.next().unwrap())
        })
        .collect()
}

/// A wavy sheet of `side` × `side` vertices with a normal each and a colour, large enough for several chunks of work.
fn sheet(side: usize) -> String {
    let mut text = String::from("# a sheet\n");
    for i in 0..side * side {
        let (x, y) = (
            (i % side) as f64 / side as f64,
            (i / side) as f64 / side as f64,
        );
        let height = (i * 7919 % 1000) as f64 / 9000.0;
        writeln!(text, "v {x:.6} {y:.6} {height:.6} {y:.4} {x:.4} 0.5").unwrap();
    }
    for i in 0..side * side {
        writeln!(text, "vn 0.0 {:.3} 1.0", (i % 13) as f64 / 13.0).unwrap();
    }
    for i in 0..side - 1 {
        for j in 0..side - 1 {
            let a = i * side + j + 1;
            let (b, c, d) = (a + 1, a + side + 1, a + side);
            // All corners share a normal with a neighbour, so that normals are added.
            writeln!(text, "f {a}//{a} {b}//{a} {c}//{c} {d}//{c}").unwrap();
        }
    }
    text
}

#[test]
fn threads_change_no_bit() {
    let lattice = "version = 1\n[[warp]]\nkind = \"lattice\"\nshape = [4, 4, 4]\n\
                   move = [{ index = [\"*\", -1, \"*\"], by = [\"25%\", 0, \"10%\"] }]\n";
    let masked = "mask = { field = \"attribute\", name = \"red\" }\n";
    let both = format!(
        "{TWIST}[[warp]]{}",
        lattice.split("[[warp]]").nth(1).unwrap()
    );
    let recomputed = format!("{both}{masked}");
    let folder = Folder::new();
    folder
        .put("sheet.obj", sheet(60))
        .put("spot.obj", fixture("valid/spot.obj"));
    for (number, (recipe, policy)) in [(both, "carried"), (recomputed, "recomputed")]
        .iter()
        .enumerate()
    {
        let recipe_name = format!("{number}.toml");
        folder.put(&recipe_name, recipe);
        for model in ["sheet.obj", "spot.obj"] {
            if model == "spot.obj" && *policy == "recomputed" {
                // It has no colours.
                continue;
            }
            let mut results = Vec::new();
            for threads in ["1", "2", "7"] {
                let mut arguments = vec!["warp", model, "-r", &recipe_name, "-o", "out.obj"];
                arguments.extend(["--threads", threads, "--force", "--report", "out.json"]);
                let mut made = vec!["out.obj", "out.json"];
                // Pictures take a while.
                if model == "spot.obj" {
                    arguments.extend(["--preview", "out.png", "--size", "48x32"]);
                    made.push("out.png");
                }
                folder.run(&arguments).done();
                results.push(
                    made.iter()
                        .map(|name| folder.read(name))
                        .collect::<Vec<_>>(),
                );
            }
            assert!(
                results[0] == results[1] && results[0] == results[2],
                "{model} {policy}"
            );
            let report: serde_json::Value = serde_json::from_slice(&results[0][1]).unwrap();
            assert!(report["points"]["moved"].as_u64().unwrap() > 2000);
            if model == "sheet.obj" {
                let normals = &report["normals"];
                assert!(
                    normals["policy"].as_str().unwrap().starts_with(policy),
                    "{normals}"
                );
                assert!(normals["changed"].as_u64().unwrap() > 1000, "{normals}");
                assert!(normals["added"].as_u64().unwrap() > 1000, "{normals}");
            }
        }
    }
}

/// Where users of one `vn` come to need different ones, lines are added and only their corners redirected.
#[test]
fn a_shared_normal_is_parted() {
    let folder = Folder::with("valid/tm-singlevn.obj", &[]);
    let original = folder.read("tm-singlevn.obj");
    let old = vectors(&original, "vn");
    assert_eq!(old.len(), 1);
    folder.put("bent.toml", TWIST.replace("\"y\"", "\"x\""));
    let warp = [
        "warp",
        "tm-singlevn.obj",
        "-r",
        "bent.toml",
        "--report",
        "r.json",
        "--force",
        "-o",
    ];

    let run = folder.run(&[&warp[..], &["carried.obj"]].concat()).done();
    assert!(
        run.err
            .contains("normals carried by the inverse transpose of the Jacobian")
    );
    let report = folder.json("r.json");
    let new = vectors(&folder.read("carried.obj"), "vn");
    assert_eq!(report["normals"]["added"], new.len() - 1);
    assert!(new.len() > 1, "{new:?}");
    // The faces, their texture coordinates and everything else that is not a number of `v`, `vn` or a normal's index
    // stay.
    let frame = |bytes: &[u8]| -> Vec<String> {
        let text = String::from_utf8(bytes.to_vec()).unwrap();
        let lines = text.lines().filter(|line| !line.starts_with("vn "));
        lines
            .map(|line| match line.split_once(' ') {
                Some(("v", _)) => "v".to_owned(),
                Some(("f", corners)) => corners
                    .split_whitespace()
                    .map(|corner| corner.rsplit_once('/').unwrap().0)
                    .collect::<Vec<_>>()
                    .join(" "),
                _ => line.to_owned(),
            })
            .collect()
    };
    assert_eq!(frame(&folder.read("carried.obj")), frame(&original));
    // A turn about the x axis carries normals by itself: their length stays, and so does their part along x.
    for normal in &new {
        let length = |n: &[f64; 3]| n.iter().map(|c| c * c).sum::<f64>().sqrt();
        assert!((length(normal) - length(&old[0])).abs() < 0.3, "{normal:?}");
    }

    let run = folder
        .run(&[&warp[..], &["kept.obj", "--keep-normals"]].concat())
        .done();
    assert!(run.err.contains("normals kept as they were"));
    assert_eq!(vectors(&folder.read("kept.obj"), "vn"), old);
    assert_eq!(
        vectors(&folder.read("kept.obj"), "v"),
        vectors(&folder.read("carried.obj"), "v")
    );
    let report = folder.json("r.json");
    assert_eq!(
        (&report["normals"]["changed"], &report["normals"]["added"]),
        (&0.into(), &0.into())
    );
}

/// A mask from a vertex colour: black vertices keep their bytes, white ones move fully, and normals come from faces.
#[test]
fn masks_read_vertex_colours_and_columns() {
    let folder = Folder::new();
    let obj = "v 0 0 0 0 0 0\nv 1.00 0 0 0 0 0\nv 1 1 0 1 0 0\nv 0 1 0 1 0 0\nv 2 1.5 0 0.5 0 0\n\
               vn 0 0 1\nf 1//1 2//1 3//1 4//1\nf 2//1 5//1 3//1\n";
    let shift = "version = 1\n[[warp]]\nkind = \"points\"\npoint = [{ from = [0, 0, 0], by = [0, 0, 4] }]\n\
                 mask = { field = \"attribute\", name = \"red\" }\n";
    folder.put("a.obj", obj).put("shift.toml", shift);
    let run = folder
        .run(&["warp", "a.obj", "-r", "shift.toml", "-o", "out.obj"])
        .done();
    assert!(run.err.contains("3 of 5 points moved"), "{}", run.err);
    assert!(run.err.contains("recomputed from faces"), "{}", run.err);
    let text = String::from_utf8(folder.read("out.obj")).unwrap();
    assert!(
        text.starts_with(
            "v 0 0 0 0 0 0\nv 1.00 0 0 0 0 0\nv 1 1 4 1 0 0\nv 0 1 4 1 0 0\nv 2 1.5 2 0.5 0 0\n"
        ),
        "{text}"
    );

    let csv = "name,x,y,heat\n\"a, b\",0,0,0\nc,1,0,0.5\nd,1,1.50,1\n";
    let flat = shift
        .replace("[0, 0, 0]", "[0, 0]")
        .replace("[0, 0, 4]", "[4, 0]");
    folder
        .put("a.csv", csv)
        .put("flat.toml", flat.replace("red", "heat"));
    folder
        .run(&["warp", "a.csv", "-r", "flat.toml", "-o", "out.csv"])
        .done();
    let text = String::from_utf8(folder.read("out.csv")).unwrap();
    assert_eq!(
        text,
        "name,x,y,heat\n\"a, b\",0,0,0\nc,3,0,0.5\nd,5,1.50,1\n"
    );

    // What the model does not have is named, with what it has.
    folder.put("wrong.toml", shift.replace("red", "heat"));
    folder
        .run(&["warp", "a.obj", "-r", "wrong.toml", "-o", "x.obj"])
        .failed(1, &["wrong.toml:5:", "`heat`", "red, green, blue"]);
}

#[test]
fn points_that_are_not_finite_pass_untouched_if_allowed() {
    for name in ["nan-vertex.obj", "to-test-nan.obj"] {
        let folder = Folder::with(
            &format!("damaged/{name}"),
            &[("twist.toml", TWIST), ("empty.toml", EMPTY)],
        );
        let warp = [
            "warp",
            name,
            "--allow-nonfinite",
            "--report",
            "r.json",
            "--force",
            "-o",
            "out.obj",
            "-r",
        ];
        folder.run(&[&warp[..], &["empty.toml"]].concat()).done();
        assert!(folder.read("out.obj") == folder.read(name));
        let preview = ["twist.toml", "--preview", "out.png", "--size", "64x36"];
        folder.run(&[&warp[..], &preview].concat()).done();
        let report = folder.json("r.json");
        let bad = report["points"]["not_finite"].as_u64().unwrap();
        assert!(
            bad > 0 && report["points"]["moved"].as_u64().unwrap() > 0,
            "{report}"
        );
        for corner in ["min", "max"] {
            let bounds = report["bounds"]["after"][corner].as_array().unwrap();
            assert!(
                bounds
                    .iter()
                    .all(|c| c.as_f64().is_some_and(f64::is_finite))
            );
        }
        let (before, after) = (folder.read(name), folder.read("out.obj"));
        let mut kept = 0;
        for (old, new) in before
            .split(|b| *b == b'\n')
            .zip(after.split(|b| *b == b'\n'))
        {
            let text = String::from_utf8_lossy(old).to_lowercase();
            if text.starts_with("v ")
                && (["nan", "inf", "#ind"]
                    .iter()
                    .any(|word| text.contains(word)))
            {
                assert_eq!(old, new);
                kept += 1;
            } else if !text.starts_with("v ") {
                assert_eq!(old, new);
            }
        }
        assert_eq!(kept, bad);
    }
    let folder = Folder::new();
    folder
        .put("empty.toml", EMPTY)
        .put("a.csv", "x,y\nnan,1\n2,-INF\n1,1e-400\n");
    let warp = ["warp", "a.csv", "-r", "empty.toml", "-o", "out.csv"];
    folder.run(&warp).failed(
        1,
        &[
            "a.csv: line 2, column 1: the x coordinate of point 1",
            "--allow-nonfinite",
        ],
    );
    folder
        .run(&[&warp[..], &["--allow-nonfinite"]].concat())
        .done();
    assert!(folder.read("out.csv") == folder.read("a.csv"));
}

/// Numbers near the end of the range: moved while they fit, refused with the first point when they do not.
#[test]
fn extreme_coordinates_are_moved_or_refused() {
    let folder = Folder::new();
    folder.put("twist.toml", TWIST);
    let large = "v 1e300 0 0\nv 0 1e300 0\nv 0 0 -1e300\nv 1e299 5e299 0\nf 1 2 3\nf 1 2 4\n";
    folder.put("large.obj", large);
    let preview = [
        "--preview",
        "out.png",
        "--size",
        "64x36",
        "--report",
        "out.json",
    ];
    let warp = ["warp", "large.obj", "-r", "twist.toml", "-o", "out.obj"];
    folder.run(&[&warp[..], &preview].concat()).done();
    let moved = vectors(&folder.read("out.obj"), "v");
    assert!(moved.iter().flatten().all(|c| c.abs() < 2e300), "{moved:?}");
    let height = |points: &[[f64; 3]]| -> Vec<f64> { points.iter().map(|p| p[1]).collect() };
    assert_eq!(height(&moved), [0.0, 1e300, 0.0, 5e299]);

    folder.put(
        "edge.obj",
        "v 1.7e308 0 0\nv -1.7e308 1e300 0\nv 0 0 -1e300\nf 1 2 3\n",
    );
    let before = folder.names();
    let run = folder.run(
        &[
            &["warp", "edge.obj", "-r", "twist.toml", "-o", "new/"],
            &["--report", "new/"][..],
        ]
        .concat(),
    );
    run.failed(
        1,
        &[
            "edge.obj: point 2 moves to a place that is not finite",
            "; scale the model down",
        ],
    );
    assert_eq!(folder.names(), before);
}
