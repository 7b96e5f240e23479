//! Cages that people edit: written, moved in a modeller, read back, and refused when they are no longer the same cage.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::{Folder, Run};
use std::fmt::Write as _;

const SPOT: &str = "valid/spot.obj";

fn recipe(kind: &str, rest: &str) -> String {
    format!("version = 1\n[[warp]]\nkind = \"{kind}\"\n{rest}\n")
}

fn files(kind: &str, rest: &str) -> String {
    recipe(
        kind,
        &format!("source = \"cage.obj\"\ntarget = \"edited.obj\"\n{rest}"),
    )
}

/// A folder with a model and its cage.
fn caged(fixture: &str, arguments: &[&str]) -> Folder {
    let folder = Folder::with(fixture, &[]);
    let model = fixture.rsplit('/').next().unwrap();
    let mut all = vec!["cage", model, "-o", "cage.obj"];
    all.extend(arguments);
    folder.run(&all).done();
    folder
}

fn text(folder: &Folder, name: &str) -> String {
    String::from_utf8(folder.read(name)).unwrap()
}

fn points(text: &str) -> Vec<[f64; 3]> {
    text.lines()
        .filter_map(|line| line.strip_prefix("v "))
        .map(|rest| {
            let mut numbers = rest.split_whitespace().map(|n| n.parse().unwrap());
            [(); 3].map(|()| numbers.next().unwrap())
        })
        .collect()
}

/// The text with the points replaced, everything else as it was.
fn with_points(text: &str, points: &[[f64; 3]]) -> String {
    let mut next = points.iter();
    let mut out = String::new();
    for line in text.lines() {
        if line.starts_with("v ") {
            if let Some([x, y, z]) = next.next() {
                writeln!(out, "v {x} {y} {z}").unwrap();
            }
        } else {
            writeln!(out, "{line}").unwrap();
        }
    }
    out
}

/// As a modeller writes it: its own comments and names, six decimals, wires as segments in another order.
fn exported(text: &str, points: &[[f64; 3]]) -> String {
    let mut out =
        String::from("# Some Modeller 4.2\n# www.example.org\nmtllib edited.mtl\no Cage.001\n");
    for [x, y, z] in points {
        let [x, y, z] = [*x as f32, *y as f32, *z as f32];
        writeln!(out, "v {x:.6} {y:.6} {z:.6}").unwrap();
    }
    let mut segments: Vec<[&str; 2]> = Vec::new();
    for line in text.lines().filter_map(|line| line.strip_prefix("l ")) {
        let ends: Vec<&str> = line.split_whitespace().collect();
        segments.extend(ends.windows(2).map(|pair| [pair[1], pair[0]]));
    }
    segments.sort_unstable();
    for [a, b] in segments {
        writeln!(out, "l {a} {b}").unwrap();
    }
    out
}

fn warp(folder: &Folder, model: &str, recipe: &str, output: &str) -> Run {
    folder.put("recipe.toml", recipe);
    folder.run(&["warp", model, "-r", "recipe.toml", "-o", output, "-f", "-q"])
}

fn farthest(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let apart =
        |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
    a.iter().zip(b).map(apart).fold(0.0, f64::max)
}

#[test]
fn what_nobody_edited_moves_nothing() {
    for fixture in [SPOT, "valid/teapot.obj"] {
        let model = fixture.rsplit('/').next().unwrap();
        for (kind, arguments) in [
            ("lattice", &["--lattice", "4,4,4"][..]),
            ("lattice", &["--lattice", "2x7x3", "--margin", "3%"]),
            (
                "spline-lattice",
                &["--lattice", "5,6,4", "--kind", "spline-lattice"],
            ),
            (
                "spline-lattice",
                &["--lattice", "6", "--degree", "2", "--knots", "clamped"],
            ),
            ("frame-lattice", &["--frames", "3,2,3"]),
            ("frames", &["--frames", "2,2,2", "--margin", "0.1"]),
            ("points", &["--points", "9"]),
        ] {
            let folder = caged(fixture, arguments);
            let cage = text(&folder, "cage.obj");
            // As written, and through a modeller.
            let extra = match (kind, arguments.contains(&"clamped")) {
                (_, true) => "degree = 2\nknots = \"clamped\"",
                ("frames" | "points", _) => "radius = \"40%\"",
                _ => "",
            };
            for edited in [cage.clone(), exported(&cage, &points(&cage))] {
                folder.put("edited.obj", edited);
                let run = warp(&folder, model, &files(kind, extra), "out.obj");
                assert_eq!(run.code, 0, "{kind} {arguments:?} {run:?}");
                assert!(
                    folder.read("out.obj") == folder.read(model),
                    "{kind} {arguments:?}"
                );
            }
        }
    }
}

#[test]
fn a_moved_vertex_is_a_move() {
    for (kind, arguments, shape) in [
        ("lattice", &["--lattice", "4,5,3"][..], "shape = [4, 5, 3]"),
        (
            "spline-lattice",
            &["--lattice", "4,5,4", "--kind", "spline-lattice"],
            "shape = [4, 5, 4]",
        ),
    ] {
        let folder = caged(SPOT, arguments);
        let cage = text(&folder, "cage.obj");
        let rows = if kind == "lattice" { 3 } else { 4 };
        let mut moved = points(&cage);
        // [1, 3, 2], counted as the file says.
        let vertex = (5 + 3) * rows + 2;
        for (axis, by) in [0.11, 0.23, -0.31].into_iter().enumerate() {
            moved[vertex][axis] += by;
        }
        folder.put("edited.obj", with_points(&cage, &moved));
        let by_hand = "move = [{ index = [1, 3, 2], by = [0.11, 0.23, -0.31] }]";
        let own = recipe(kind, &format!("{shape}\n{by_hand}"));
        warp(&folder, "spot.obj", &own, "own.obj").done();
        let own = points(&text(&folder, "own.obj"));
        assert!(farthest(&own, &points(&text(&folder, "spot.obj"))) > 0.01);
        let alone = recipe(kind, &format!("{shape}\ntarget = \"edited.obj\""));
        for recipe in [
            files(kind, ""),
            files(kind, shape),
            alone,
            recipe(kind, "target = \"edited.obj\""),
            recipe(kind, &format!("source = \"cage.obj\"\n{by_hand}")),
        ] {
            warp(&folder, "spot.obj", &recipe, "out.obj").done();
            let off = farthest(&own, &points(&text(&folder, "out.obj")));
            assert!(off < 1e-12, "{off} with {recipe}");
        }
        // Through a modeller, to its digits; its comments are lost, so the grid tells the shape.
        folder.put("edited.obj", exported(&cage, &moved));
        warp(&folder, "spot.obj", &files(kind, ""), "out.obj").done();
        assert!(farthest(&own, &points(&text(&folder, "out.obj"))) < 2e-6);
        folder.put(
            "cage.obj",
            with_points(&exported(&cage, &points(&cage)), &points(&cage)),
        );
        warp(&folder, "spot.obj", &files(kind, ""), "out.obj").done();
        assert!(farthest(&own, &points(&text(&folder, "out.obj"))) < 2e-6);
        // Both edits, one after the other.
        folder.put("edited.obj", with_points(&cage, &moved));
        warp(&folder, "spot.obj", &files(kind, by_hand), "twice.obj").done();
        let twice = by_hand.replace("0.11, 0.23, -0.31", "0.22, 0.46, -0.62");
        warp(
            &folder,
            "spot.obj",
            &recipe(kind, &format!("{shape}\n{twice}")),
            "own.obj",
        )
        .done();
        let both = ["twice.obj", "own.obj"].map(|name| points(&text(&folder, name)));
        assert!(farthest(&both[0], &both[1]) < 1e-12);
    }
}

#[test]
fn other_objects_in_the_file_do_not_matter() {
    let folder = caged(SPOT, &["--lattice", "3,3,3"]);
    let cage = text(&folder, "cage.obj");
    let mut moved = points(&cage);
    moved[13][1] += 0.4;
    folder.put("edited.obj", with_points(&cage, &moved));
    warp(&folder, "spot.obj", &files("lattice", ""), "own.obj").done();
    // A triangle with a wire before it, and the faces of the cage instead of some wires behind.
    let mut all = String::from("o Triangle\nv 5 5 5\nv 6 5 5\nv 5 6 5\nf 1 2 3\nl 1 2\no Cage\n");
    for line in with_points(&cage, &moved).lines() {
        if let Some(ends) = line.strip_prefix("l ") {
            let ends = ends
                .split(' ')
                .map(|n| (n.parse::<usize>().unwrap() + 3).to_string());
            writeln!(all, "l {}", ends.collect::<Vec<_>>().join(" ")).unwrap();
        } else if line.starts_with("v ") {
            writeln!(all, "{line}").unwrap();
        }
    }
    writeln!(all, "f 4 5 8 7").unwrap();
    folder.put("edited.obj", all);
    warp(&folder, "spot.obj", &files("lattice", ""), "out.obj").done();
    assert!(folder.read("own.obj") == folder.read("out.obj"));
}

#[test]
fn a_changed_cage_is_refused() {
    let folder = caged(SPOT, &["--lattice", "4,4,4"]);
    let cage = text(&folder, "cage.obj");
    let all = points(&cage);
    let vertices: Vec<&str> = cage.lines().filter(|line| line.starts_with("v ")).collect();
    let bare = vertices.join("\n");
    let shuffled: Vec<[f64; 3]> = (0..64).map(|i| all[i * 7 % 64]).collect();
    // Numbered otherwise, wires and all.
    let renumbered = {
        let place = |old: usize| (old * 23) % 64;
        let mut moved = vec![[0.0; 3]; 64];
        for (old, point) in all.iter().enumerate() {
            moved[place(old)] = *point;
        }
        let mut out = String::new();
        for line in with_points(&cage, &moved).lines() {
            match line.strip_prefix("l ") {
                Some(ends) => {
                    let ends = ends
                        .split(' ')
                        .map(|n| place(n.parse::<usize>().unwrap() - 1) + 1);
                    let ends: Vec<String> = ends.map(|n| n.to_string()).collect();
                    writeln!(out, "l {}", ends.join(" ")).unwrap();
                }
                None => writeln!(out, "{line}").unwrap(),
            }
        }
        out
    };
    let reversed: Vec<[f64; 3]> = all.iter().rev().copied().collect();
    let mut not_a_number = cage.replacen(vertices[9], "v 0 nan 0", 1);
    not_a_number.push('\n');
    for (edited, says) in [
        (
            vertices[..63].join("\n"),
            "edited.obj has 63 points where cage.obj has 64",
        ),
        (format!("{cage}v 9 9 9\n"), "edited.obj has 65 points"),
        (
            format!("{cage}v 9 9 9\nl 64 65\n"),
            "edited.obj has 65 points where cage.obj has 64",
        ),
        (renumbered, "reordered"),
        (with_points(&cage, &shuffled), "another order"),
        (with_points(&bare, &shuffled), "another order"),
        (with_points(&cage, &reversed), "v 1 stands where v 64 stood"),
        (
            cage.replace("l 1 2 3 4\n", ""),
            "3 wires fewer, such as v 1 – v 2",
        ),
        (format!("{cage}l 1 64\n"), "1 wire more, such as v 1 – v 64"),
        (format!("{cage}f 1 2 64\n"), "no neighbours"),
        (not_a_number, "edited.obj"),
        (String::new(), "the file is empty"),
        ("o Cage\n".to_owned(), "edited.obj"),
    ] {
        folder.put("edited.obj", &edited);
        let run = warp(&folder, "spot.obj", &files("lattice", ""), "out.obj");
        let place = ["recipe.toml:5:10: warp.0.target", says];
        run.failed(1, &place);
    }
    // The edited cage as source.
    let mut moved = all.clone();
    moved[21][0] += 0.05;
    folder.put("edited.obj", with_points(&cage, &moved));
    let own = recipe("lattice", "source = \"edited.obj\"");
    let says = [
        "v 22 of edited.obj, control point [1, 1, 1], stands",
        "before any edit",
    ];
    warp(&folder, "spot.obj", &own, "out.obj").failed(1, &says);
    assert!(!folder.names().contains(&"out.obj".to_owned()));
}

#[test]
fn parameters_that_do_not_fit_the_files_are_refused() {
    let folder = caged(SPOT, &["--lattice", "5,5,5", "--knots", "clamped"]);
    folder.put("edited.obj", folder.read("cage.obj"));
    folder.put("flat.csv", "x,y\n0,0\n1,0\n");
    for (kind, rest, says) in [
        (
            "lattice",
            "source = \"cage.obj\"",
            "cage for `spline-lattice`",
        ),
        (
            "points",
            "source = \"cage.obj\"\ntarget = \"edited.obj\"",
            "cage for `spline-lattice`",
        ),
        (
            "spline-lattice",
            "source = \"cage.obj\"\ndegree = 2",
            "warp.0.degree",
        ),
        (
            "spline-lattice",
            "source = \"cage.obj\"\nknots = \"uniform\"",
            "warp.0.knots",
        ),
        (
            "spline-lattice",
            "source = \"cage.obj\"\nshape = [5, 5, 4]",
            "5 × 5 × 4",
        ),
        (
            "spline-lattice",
            "source = \"cage.obj\"\nmargin = 1",
            "remove `margin`",
        ),
        (
            "spline-lattice",
            "source = \"cage.obj\"\nbox = \"fit\"",
            "remove `box`",
        ),
        (
            "spline-lattice",
            "source = \"flat.csv\"",
            "lies in the plane",
        ),
        ("spline-lattice", "source = \"missing.obj\"", "missing.obj"),
        ("spline-lattice", "source = \"\"", "empty name"),
        ("spline-lattice", "source = \".\"", "name a file"),
        ("spline-lattice", "source = 3", "warp.0.source"),
        (
            "spline-lattice",
            "sorce = \"cage.obj\"",
            "did you mean `source`",
        ),
        ("spline-lattice", "", "`shape` is missing"),
        ("points", "source = \"edited.obj\"", "no `target`"),
        ("frames", "target = \"edited.obj\"", "no `source`"),
    ] {
        warp(&folder, "spot.obj", &recipe(kind, rest), "out.obj").failed(1, &[says]);
    }
}

#[test]
fn files_are_sought_beside_the_recipe_and_nowhere_else() {
    let folder = caged(SPOT, &["--lattice", "3"]);
    std::fs::create_dir_all(folder.path().join("inner/deep")).unwrap();
    let own = |source: &str| {
        recipe(
            "lattice",
            &format!("source = {source:?}\nmove = [{{ index = [1, 1, 1], by = \"9%\" }}]"),
        )
    };
    let arguments = [
        "warp",
        "spot.obj",
        "-r",
        "inner/recipe.toml",
        "-o",
        "out.obj",
        "-f",
        "-q",
    ];
    let whole = folder.path().join("cage.obj").display().to_string();
    for source in ["../cage.obj", "deep/../../cage.obj", whole.as_str()] {
        folder.put("inner/recipe.toml", own(source));
        folder
            .run(&arguments)
            .failed(1, &["outside", "--allow-outside"]);
        let mut allowed = arguments.to_vec();
        allowed.push("--allow-outside");
        folder.run(&allowed).done();
        folder
            .run(&["check", "inner/recipe.toml"])
            .failed(1, &["--allow-outside"]);
        folder
            .run(&["check", "inner/recipe.toml", "--allow-outside"])
            .done();
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../cage.obj", folder.path().join("inner/link.obj")).unwrap();
        folder.put("inner/recipe.toml", own("link.obj"));
        folder
            .run(&arguments)
            .failed(1, &["a link that leads out of"]);
    }
    folder.put("inner/deep/cage.obj", folder.read("cage.obj"));
    folder.put("inner/recipe.toml", own("deep/../deep/./cage.obj"));
    folder.run(&arguments).done();
    // From standard input: in the current folder.
    let input = own("cage.obj");
    folder
        .run_with(
            input.as_bytes(),
            &["warp", "spot.obj", "-r", "-", "-o", "out.obj", "-f"],
        )
        .done();
    // What the recipe reads is not overwritten.
    folder.put("recipe.toml", own("cage.obj"));
    folder
        .run(&[
            "warp",
            "spot.obj",
            "-r",
            "recipe.toml",
            "-o",
            "cage.obj",
            "-f",
        ])
        .failed(2, &["that the recipe reads"]);
}

#[test]
fn turned_frames_turn() {
    let folder = caged(SPOT, &["--frames", "3,3,3"]);
    let cage = text(&folder, "cage.obj");
    let mut moved = points(&cage);
    // Frame [1, 2, 0]: vertices 1 + 4 * ((1 * 3 + 2) * 3 + 0) on, turned by 30° about y and moved.
    let first = 4 * 15;
    let origin = moved[first];
    let (sin, cos) = 30.0_f64.to_radians().sin_cos();
    for point in &mut moved[first..first + 4] {
        let [x, y, z] = [0, 1, 2].map(|i| point[i] - origin[i]);
        *point = [
            origin[0] + cos * x + sin * z + 0.1,
            origin[1] + y - 0.05,
            origin[2] + cos * z - sin * x,
        ];
    }
    folder.put("edited.obj", with_points(&cage, &moved));
    for scaling in ["", "scaling = \"displacement\"\n"] {
        let own = format!(
            "{scaling}shape = [3, 3, 3]\nframe = [{{ index = [1, 2, 0], turn = \"30deg\", axis = \"y\", by = [0.1, -0.05, 0] }}]"
        );
        warp(
            &folder,
            "spot.obj",
            &recipe("frame-lattice", &own),
            "own.obj",
        )
        .done();
        let own = points(&text(&folder, "own.obj"));
        for rest in [
            format!("{scaling}source = \"cage.obj\"\ntarget = \"edited.obj\""),
            format!("{scaling}shape = [3, 3, 3]\ntarget = \"edited.obj\""),
        ] {
            warp(
                &folder,
                "spot.obj",
                &recipe("frame-lattice", &rest),
                "out.obj",
            )
            .done();
            let off = farthest(&own, &points(&text(&folder, "out.obj")));
            assert!(off < 1e-12, "{off} with {rest}");
        }
    }
    assert!(
        farthest(
            &points(&text(&folder, "own.obj")),
            &points(&text(&folder, "spot.obj"))
        ) > 0.01
    );
    // A frame drawn flat is none.
    moved[first + 1] = moved[first];
    folder.put("edited.obj", with_points(&cage, &moved));
    warp(&folder, "spot.obj", &files("frame-lattice", ""), "out.obj").failed(1, &["v 61 to 64"]);
}

#[test]
fn points_go_where_the_file_has_them() {
    let folder = caged(SPOT, &["--points", "7"]);
    let cage = text(&folder, "cage.obj");
    let mut moved = points(&cage);
    let from = moved[2];
    moved[2][1] += 0.3;
    folder.put("edited.obj", exported(&cage, &moved));
    folder.put("exact.obj", with_points(&cage, &moved));
    let mut own = String::from("radius = 0.5\n");
    for (index, [x, y, z]) in points(&cage).into_iter().enumerate() {
        let by = if index == 2 {
            moved[2][1] - from[1]
        } else {
            0.0
        };
        writeln!(
            own,
            "[[warp.point]]\nfrom = [{x:?}, {y:?}, {z:?}]\nby = [0, {by:?}, 0]"
        )
        .unwrap();
    }
    warp(&folder, "spot.obj", &recipe("points", &own), "own.obj").done();
    let read = "radius = 0.5\nsource = \"cage.obj\"\ntarget = \"exact.obj\"";
    warp(&folder, "spot.obj", &recipe("points", read), "out.obj").done();
    let [own, out] = ["own.obj", "out.obj"].map(|name| points(&text(&folder, name)));
    assert!(farthest(&own, &out) < 1e-12);
    // The point itself is a vertex of the model, and meets its target.
    let at = points(&text(&folder, "spot.obj"))
        .iter()
        .position(|p| *p == from)
        .unwrap();
    assert!(farthest(&out[at..=at], &moved[2..3]) < 1e-12);
    warp(
        &folder,
        "spot.obj",
        &files("points", "radius = 0.5"),
        "out.obj",
    )
    .done();
    assert!(farthest(&own, &points(&text(&folder, "out.obj"))) < 1e-5);
    let few = with_points(&cage, &moved).replacen("v ", "# ", 1);
    folder.put("edited.obj", few.replace("p 7\n", ""));
    let says = ["edited.obj has 6 points where cage.obj has 7"];
    warp(
        &folder,
        "spot.obj",
        &files("points", "radius = 0.5"),
        "out.obj",
    )
    .failed(1, &says);
}

#[test]
fn cages_of_the_plane_are_tables_or_wires() {
    let folder = Folder::with("valid/grid.csv", &[]);
    let own = recipe(
        "lattice",
        "shape = [4, 3]\nmove = [{ index = [2, 1], by = [0.25, -0.5] }]",
    );
    warp(&folder, "grid.csv", &own, "own.csv").done();
    for (name, other) in [("cage.csv", "edited.csv"), ("cage.obj", "edited.obj")] {
        folder
            .run(&["cage", "grid.csv", "--lattice", "4,3", "-o", name])
            .done();
        let cage = text(&folder, name);
        let rest = format!("source = {name:?}\ntarget = {other:?}");
        folder.put(other, &cage);
        warp(&folder, "grid.csv", &recipe("lattice", &rest), "out.csv").done();
        assert!(folder.read("out.csv") == folder.read("grid.csv"), "{name}");
        // [2, 1] is the eighth point.
        let line = cage
            .lines()
            .filter(|line| line.starts_with(['v', '-', '0', '1']))
            .nth(7)
            .unwrap();
        let separator = if name == "cage.csv" { ',' } else { ' ' };
        let mut fields: Vec<String> = line.split(separator).map(str::to_owned).collect();
        let x = usize::from(name != "cage.csv");
        for (field, by) in [(x, 0.25), (x + 1, -0.5)] {
            fields[field] = (fields[field].parse::<f64>().unwrap() + by).to_string();
        }
        folder.put(
            other,
            cage.replace(line, &fields.join(&separator.to_string())),
        );
        warp(&folder, "grid.csv", &recipe("lattice", &rest), "out.csv").done();
        let numbers = |name: &str| -> Vec<f64> {
            let text = text(&folder, name);
            let fields = text.lines().skip(1).flat_map(|line| line.split(','));
            fields.filter_map(|field| field.parse().ok()).collect()
        };
        let (own, out) = (numbers("own.csv"), numbers("out.csv"));
        let off = own
            .iter()
            .zip(&out)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(own.len() == out.len() && off < 1e-12, "{name}: {off}");
    }
    let lifted = text(&folder, "cage.obj").replacen(" 0\n", " 0.5\n", 1);
    folder.put("edited.obj", lifted);
    warp(&folder, "grid.csv", &files("lattice", ""), "out.csv").failed(1, &["z = 0.5", "plane"]);
}

#[test]
fn cages_are_written_whole_and_the_same_each_time() {
    let folder = caged(SPOT, &["--points", "40"]);
    let before = folder.read("cage.obj");
    let again = ["cage", "spot.obj", "--points", "40", "-o", "cage.obj"];
    folder.run(&again).failed(1, &["exists already", "--force"]);
    folder.run(&[&again[..], &["--force"]].concat()).done();
    assert!(folder.read("cage.obj") == before);
    let out = folder
        .run(&["cage", "spot.obj", "--points", "40", "-o", "-", "-q"])
        .done();
    assert_eq!(
        points(&out.text()),
        points(&String::from_utf8(before).unwrap())
    );
    for (arguments, code, says) in [
        (
            &["--lattice", "4,4,4", "-o", "spot.obj", "-f"][..],
            2,
            "replace the model",
        ),
        (&["--lattice", "4,4,4", "-o", "a.ply"], 2, "OBJ or CSV"),
        (&["--lattice", "4,4", "-o", "a.obj"], 1, "4,4,4"),
        (&["--lattice", "33,4,4", "-o", "a.obj"], 1, "2 to 32"),
        (&["--lattice", "4,1,4", "-o", "a.obj"], 2, "at least 2"),
        (
            &[
                "--lattice",
                "999999,999999,999999",
                "-o",
                "a.obj",
                "--kind",
                "spline-lattice",
            ],
            1,
            "at most",
        ),
        (
            &["--lattice", "3", "--degree", "3", "-o", "a.obj"],
            1,
            "at least 4",
        ),
        (
            &["--lattice", "8", "--degree", "9", "-o", "a.obj"],
            1,
            "1 to 5",
        ),
        (
            &[
                "--lattice",
                "4",
                "--kind",
                "lattice",
                "--degree",
                "2",
                "-o",
                "a.obj",
            ],
            2,
            "spline-lattice",
        ),
        (
            &["--lattice", "4", "--margin", "-1%", "-o", "a.obj"],
            1,
            "not negative",
        ),
        (
            &["--lattice", "4", "--margin=-1%", "-o", "a.obj"],
            1,
            "not negative",
        ),
        (
            &["--lattice", "4", "--margin", "wide", "-o", "a.obj"],
            1,
            "percentage",
        ),
        (&["--points", "0", "-o", "a.obj"], 2, "1 to 10000"),
        (&["--points", "9000", "-o", "a.obj"], 1, "different points"),
        (
            &["--points", "4", "--frames", "3", "-o", "a.obj"],
            2,
            "cannot be used with",
        ),
        (&["-o", "a.obj"], 2, "--lattice"),
    ] {
        let all = [&["cage", "spot.obj"][..], arguments].concat();
        folder.run(&all).failed(code, &[says]);
    }
    assert!(!folder.names().iter().any(|name| name.starts_with("a.")));
}
