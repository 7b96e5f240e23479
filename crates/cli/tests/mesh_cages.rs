//! Coarse meshes: decimated from a model, edited, and read back by the warp `mesh`.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::{Folder, repository};
use std::fmt::Write as _;

const RECIPE: &str =
    "version = 1\n[[warp]]\nkind = \"mesh\"\nsource = \"cage.obj\"\ntarget = \"edited.obj\"\n";

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

fn faces(text: &str) -> Vec<[usize; 3]> {
    text.lines()
        .filter_map(|line| line.strip_prefix("f "))
        .map(|rest| {
            let mut numbers = rest.split_whitespace().map(|n| n.parse().unwrap());
            let face = [(); 3].map(|()| numbers.next().unwrap());
            assert_eq!(numbers.next(), None, "{rest}");
            face
        })
        .collect()
}

/// As a modeller writes it: its own comments and names, six decimals.
fn edited(text: &str, edit: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    let mut out = String::from("# Some Modeller 4.2\nmtllib edited.mtl\no Cage.001\n");
    for [x, y, z] in points(text).into_iter().map(edit) {
        writeln!(out, "v {x:.6} {y:.6} {z:.6}").unwrap();
    }
    for [a, b, c] in faces(text) {
        writeln!(out, "f {a} {b} {c}").unwrap();
    }
    out
}

fn farthest(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let apart =
        |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
    a.iter().zip(b).map(apart).fold(0.0, f64::max)
}

/// Vertices, edges and faces; every edge has at most two faces.
fn counts(text: &str) -> [usize; 3] {
    let mut edges = std::collections::BTreeMap::<[usize; 2], usize>::new();
    for [a, b, c] in faces(text) {
        for [a, b] in [[a, b], [b, c], [c, a]] {
            *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    [points(text).len(), edges.len(), faces(text).len()]
}

/// A grid of `n` by `n` squares as a file, its vertices moved.
fn sheet(n: usize, place: impl Fn(f64, f64) -> [f64; 3]) -> String {
    let mut out = String::new();
    for (j, i) in (0..=n).flat_map(|j| (0..=n).map(move |i| (j, i))) {
        let [x, y, z] = place(i as f64 / n as f64, j as f64 / n as f64);
        writeln!(out, "v {x} {y} {z}").unwrap();
    }
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let a = j * (n + 1) + i + 1;
        writeln!(out, "f {a} {} {} {}", a + 1, a + n + 2, a + n + 1).unwrap();
    }
    out
}

#[test]
fn a_model_is_carried_by_its_own_coarse_mesh() {
    for count in ["30", "100", "400"] {
        let folder = Folder::with("valid/spot.obj", &[("recipe.toml", RECIPE)]);
        let run = folder
            .run(&["cage", "spot.obj", "--mesh", count, "-o", "cage.obj"])
            .done();
        let says = format!("spot.obj -> cage.obj: {count} vertices");
        assert!(run.err.contains(&says), "{}", run.err);
        assert!(run.err.contains("% of the model's size"), "{}", run.err);
        assert!(!run.err.contains("note"), "{}", run.err);
        let cage = text(&folder, "cage.obj");
        let [vertices, edges, triangles] = counts(&cage);
        // Closed and of one piece, like Spot.
        assert_eq!(vertices.to_string(), count);
        assert_eq!(
            (edges * 2, vertices + triangles),
            (triangles * 3, edges + 2)
        );

        let warp = [
            "warp",
            "spot.obj",
            "-r",
            "recipe.toml",
            "-o",
            "out.obj",
            "-f",
        ];
        // What nobody edited moves nothing, whatever the modeller rounds.
        for same in [cage.clone(), edited(&cage, |p| p)] {
            folder.put("edited.obj", same);
            folder.run(&warp).done();
            assert!(folder.read("out.obj") == folder.read("spot.obj"));
        }
        // A shift of the coarse mesh is a shift of the model: all of it is near.
        let shift = |[x, y, z]: [f64; 3]| [x + 0.5, y - 0.25, z + 2.0];
        folder.put("edited.obj", edited(&cage, shift));
        folder.run(&warp).done();
        let model = points(&text(&folder, "spot.obj"));
        let shifted: Vec<[f64; 3]> = model.iter().copied().map(shift).collect();
        let out = points(&text(&folder, "out.obj"));
        assert!(farthest(&out, &shifted) < 1e-5);
        // One vertex moves what is near it, and nothing else.
        let tip = points(&cage)
            .into_iter()
            .max_by(|a, b| a[0].total_cmp(&b[0]))
            .unwrap();
        let pull = |p: [f64; 3]| {
            if p == tip {
                [p[0] + 0.2, p[1], p[2]]
            } else {
                p
            }
        };
        folder.put("edited.obj", edited(&cage, pull));
        folder.run(&warp).done();
        let out = points(&text(&folder, "out.obj"));
        assert!(farthest(&out, &model) > 0.02);
        let stay = out.iter().zip(&model).filter(|(a, b)| a == b).count();
        assert!(stay > model.len() / 4, "{stay}");
    }
}

#[test]
fn the_documented_cage_is_what_the_command_writes() {
    let folder = Folder::with("valid/spot.obj", &[]);
    let arguments = ["cage", "spot.obj", "--mesh", "80", "-o", "mesh-cage.obj"];
    folder.run(&arguments).done();
    let kept = std::fs::read_to_string(repository("docs/recipes/mesh-cage.obj")).unwrap();
    assert_eq!(text(&folder, "mesh-cage.obj"), kept);
    let edited = std::fs::read_to_string(repository("docs/recipes/mesh-edited.obj")).unwrap();
    assert_eq!(faces(&kept), faces(&edited));
}

#[test]
fn coarse_meshes_come_in_every_format_of_meshes() {
    let folder = Folder::with("valid/spot.obj", &[]);
    folder
        .run(&["cage", "spot.obj", "--mesh", "50", "-o", "cage.obj", "-q"])
        .done();
    let own = points(&text(&folder, "cage.obj"));
    for name in ["cage.ply", "cage.off", "cage.stl", "cage.glb", "cage.GLTF"] {
        let run = folder.run(&["cage", "spot.obj", "--mesh", "50", "-o", name]);
        let run = run.done();
        assert_eq!(
            run.err.contains("cannot hold"),
            !name.ends_with("ply") && !name.ends_with("off")
        );
        // As a recipe reads it.
        let recipe = format!(
            "version = 1\n[[warp]]\nkind = \"mesh\"\nsource = \"{name}\"\nmove = [{{ index = 3, by = [1, 0, 0] }}]\n"
        );
        folder.put("recipe.toml", recipe);
        let warp = [
            "warp",
            "spot.obj",
            "-r",
            "recipe.toml",
            "-o",
            "out.obj",
            "-f",
        ];
        folder.run(&warp).done();
        let inspected = folder.run(&["inspect", name, "--json"]).done().json();
        assert!(inspected.to_string().contains("50"), "{inspected}");
    }
    let stream = folder.run(&["cage", "spot.obj", "--mesh", "50", "-o", "-", "-q"]);
    let stream = stream.done();
    assert_eq!(points(&stream.text()), own);
    assert_eq!(stream.err, "");
    let piped = folder.run_with(
        &folder.read("spot.obj"),
        &["cage", "-", "--mesh", "50", "-o", "-"],
    );
    assert_eq!(points(&piped.done().text()), own);
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = Folder::with("valid/spot.obj", &[]);
    folder.put("grid.csv", common::fixture("valid/grid.csv"));
    folder.put("nan.obj", common::fixture("damaged/nan-vertex.obj"));
    folder.put("huge.obj", common::fixture("valid/huge-coordinates.obj"));
    folder.put("point.obj", "v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n");
    folder.put("loose.obj", "v 1 2 3\nv 2 2 3\nl 1 2\n");
    let cases: [(&[&str], i32, &[&str]); 13] = [
        (
            &["spot.obj", "--mesh", "3", "-o", "c.obj"],
            2,
            &["at least 4"],
        ),
        (&["spot.obj", "--mesh", "-8", "-o", "c.obj"], 2, &["-8"]),
        (
            &["spot.obj", "--mesh", "many", "-o", "c.obj"],
            2,
            &["whole number"],
        ),
        (
            &[
                "spot.obj",
                "--mesh",
                "99999999999999999999999",
                "-o",
                "c.obj",
            ],
            2,
            &["whole number"],
        ),
        (
            &["spot.obj", "--mesh", "9", "--margin", "1%", "-o", "c.obj"],
            2,
            &["--margin"],
        ),
        (
            &["spot.obj", "--mesh", "9", "--points", "9", "-o", "c.obj"],
            2,
            &["--points"],
        ),
        (
            &["spot.obj", "--mesh", "9", "-o", "c.csv"],
            2,
            &["has no faces", ".ply"],
        ),
        (
            &["spot.obj", "--mesh", "9", "-o", "spot.obj", "-f"],
            2,
            &["replace the model"],
        ),
        (
            &["grid.csv", "--mesh", "9", "-o", "c.obj"],
            1,
            &["grid.csv", "no faces", "--points"],
        ),
        (
            &["loose.obj", "--mesh", "9", "-o", "c.obj"],
            1,
            &["loose.obj", "no faces"],
        ),
        (
            &["nan.obj", "--mesh", "9", "-o", "c.obj"],
            1,
            &["nan.obj", "line 7", "not finite"],
        ),
        (
            &["huge.obj", "--mesh", "9", "-o", "c.obj"],
            1,
            &["huge.obj", "beyond 1e75"],
        ),
        (
            &["point.obj", "--mesh", "9", "-o", "c.obj"],
            1,
            &["point.obj", "no surface"],
        ),
    ];
    let before = folder.names();
    for (arguments, code, says) in cases {
        let all = [&["cage"], arguments].concat();
        folder.run(&all).failed(code, says);
        assert_eq!(folder.names(), before, "{arguments:?}");
    }
}

#[test]
fn what_is_odd_is_said() {
    let folder = Folder::new();
    let cage = |model: &str, count: &str| {
        let run = folder.run(&["cage", "m.obj", "--mesh", count, "-o", "cage.obj", "-f"]);
        let run = run.done();
        (run.err, text(&folder, "cage.obj"), model.to_owned())
    };
    // Larger than the model: as it is.
    let flat = sheet(6, |x, y| [x, 0.0, y]);
    folder.put("m.obj", &flat);
    let (err, out, model) = cage(&flat, "1000");
    assert!(
        err.contains("no more than 49 vertices, 1000 were asked for"),
        "{err}"
    );
    assert_eq!(points(&out), points(&model));
    // A flat open sheet keeps its corners.
    let (err, out, _) = cage(&flat, "4");
    assert!(!err.contains("note"), "{err}");
    assert!(err.contains("at most 0 from it, 0 %"), "{err}");
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
    ];
    assert_eq!(points(&out), corners);
    // An open bowl keeps its rim.
    let bowl = sheet(20, |x, y| {
        let (x, y) = (2.0 * x - 1.0, 2.0 * y - 1.0);
        [x, x * x + y * y, y]
    });
    folder.put("m.obj", &bowl);
    let (_, out, _) = cage(&bowl, "40");
    let [vertices, edges, triangles] = counts(&out);
    assert_eq!((vertices, vertices + triangles - edges), (40, 1));
    for corner in [[-1.0, 2.0, -1.0], [1.0, 2.0, 1.0]] {
        let places = points(&out).into_iter();
        let near = places.map(|p| farthest(&[p], &[corner]));
        let nearest = near.fold(1.0, f64::min);
        assert!(nearest < 0.1, "{nearest}");
    }
    // Every face with its own vertices.
    let own: Vec<[f64; 3]> = points(&bowl);
    let mut soup = String::new();
    for line in bowl.lines().filter_map(|line| line.strip_prefix("f ")) {
        for v in line.split(' ').map(|v| v.parse::<usize>().unwrap()) {
            let [x, y, z] = own[v - 1];
            writeln!(soup, "v {x} {y} {z}").unwrap();
        }
        soup.push_str("f -4 -3 -2 -1\n");
    }
    folder.put("m.obj", &soup);
    let (err, out, _) = cage(&soup, "40");
    assert!(
        err.contains("1159 vertices were joined with others"),
        "{err}"
    );
    assert_eq!(counts(&out)[0], 40);
    // Two pieces cannot become one.
    let mut two = String::from_utf8(common::fixture("valid/spot.obj")).unwrap();
    two.retain(|c| c != '\r');
    let (vertices, shifted) = (points(&two).len(), points(&two));
    let first: Vec<[usize; 3]> = two
        .lines()
        .filter_map(|l| l.strip_prefix("f "))
        .map(|l| {
            let mut all = l
                .split_whitespace()
                .map(|c| c.split('/').next().unwrap().parse().unwrap());
            [(); 3].map(|()| all.next().unwrap())
        })
        .collect();
    let mut both = String::new();
    for [x, y, z] in shifted.iter().chain(
        &shifted
            .iter()
            .map(|[x, y, z]| [x + 5.0, *y, *z])
            .collect::<Vec<_>>(),
    ) {
        writeln!(both, "v {x} {y} {z}").unwrap();
    }
    for [a, b, c] in first {
        writeln!(
            both,
            "f {a} {b} {c}\nf {} {} {}",
            a + vertices,
            b + vertices,
            c + vertices
        )
        .unwrap();
    }
    folder.put("m.obj", &both);
    let (_, out, _) = cage(&both, "100");
    let [vertices, edges, triangles] = counts(&out);
    assert_eq!((vertices, vertices + triangles), (100, edges + 4));
    let (err, out, _) = cage(&both, "4");
    assert!(err.contains("vertices are left, not 4"), "{err}");
    assert!(err.contains("a hole, a handle or a piece"), "{err}");
    assert!(counts(&out)[0] >= 8);
    // Three faces at an edge.
    folder.put("m.obj", common::fixture("valid/nonmanifold-edge.obj"));
    let (err, _, _) = cage("", "8");
    assert!(err.contains("2 vertices stay as they are"), "{err}");
}

#[test]
fn an_edited_mesh_that_is_another_mesh_is_refused() {
    let folder = Folder::with("valid/spot.obj", &[("recipe.toml", RECIPE)]);
    folder
        .run(&["cage", "spot.obj", "--mesh", "40", "-o", "cage.obj"])
        .done();
    let cage = text(&folder, "cage.obj");
    let warp = ["warp", "spot.obj", "-r", "recipe.toml", "-o", "out.obj"];
    // A vertex less, a vertex more.
    folder.put("edited.obj", cage.replacen("\nv ", "\nvt ", 1));
    assert_ne!(folder.run(&warp).code, 0);
    folder.put("edited.obj", format!("v 0 0 0\n{cage}"));
    folder
        .run(&warp)
        .failed(1, &["edited.obj has 41 points where cage.obj has 40"]);
    // Two vertices have changed their numbers; all of it looks as before.
    let renumbered = |v: usize| match v {
        7 => 19,
        19 => 7,
        v => v,
    };
    let mut places = points(&cage);
    places.swap(6, 18);
    let mut other = String::new();
    for [x, y, z] in &places {
        writeln!(other, "v {x} {y} {z}").unwrap();
    }
    for face in faces(&cage) {
        let [a, b, c] = face.map(renumbered);
        writeln!(other, "f {a} {b} {c}").unwrap();
    }
    folder.put("edited.obj", other);
    folder
        .run(&warp)
        .failed(1, &["edited.obj join other points", "keep vertex order"]);
    // Points alone say nothing of faces.
    let bare: String = cage
        .lines()
        .filter(|l| l.starts_with("v "))
        .fold(String::new(), |text, l| text + l + "\n");
    folder.put("edited.obj", bare);
    folder.run(&warp).done();
}

#[test]
fn squares_may_be_cut_along_the_other_diagonal() {
    let flat = sheet(3, |x, y| [x, 0.0, y]);
    let folder = Folder::with("valid/spot.obj", &[("recipe.toml", RECIPE)]);
    folder.put("cage.obj", &flat);
    let mut cut = String::new();
    for line in flat.lines() {
        match line.strip_prefix("f ") {
            None => writeln!(cut, "{line}").unwrap(),
            Some(rest) => {
                let v: Vec<&str> = rest.split(' ').collect();
                let [a, b, c, d] = [v[0], v[1], v[2], v[3]];
                writeln!(cut, "f {a} {b} {d}\nf {b} {c} {d}").unwrap();
            }
        }
    }
    folder.put("edited.obj", cut);
    folder.put("m.obj", &flat);
    folder
        .run(&["warp", "m.obj", "-r", "recipe.toml", "-o", "out.obj"])
        .done();
}
