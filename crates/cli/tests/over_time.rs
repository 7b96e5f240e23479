//! Bindings, inverses, recipes over time, and two recipes compared.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{Folder, TWIST};
use std::fs;

const POINTS: &str = r#"
version = 1
[[warp]]
kind = "points"
radius = "60%"
point = [
    { from = ["50%", "90%", "60%"], by = [0, "20%", 0] },
    { from = ["50%", "20%", "50%"] },
]
mask = { field = "axis", axis = "y", range = ["0%", "30%"] }
"#;

/// Coordinates of an OBJ's vertices.
fn vertices(folder: &Folder, name: &str) -> Vec<[f64; 3]> {
    let text = fs::read_to_string(folder.path().join(name)).unwrap();
    let lines = text.lines().filter_map(|line| line.strip_prefix("v "));
    lines
        .map(|line| {
            let mut numbers = line.split_whitespace().map(|n| n.parse().unwrap());
            [(); 3].map(|()| numbers.next().unwrap())
        })
        .collect()
}

fn farthest(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let apart = a.iter().zip(b).map(|(a, b)| {
        let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>().sqrt()
    });
    apart.fold(0.0, f64::max)
}

fn folder() -> Folder {
    Folder::with(
        "valid/spot.obj",
        &[("twist.toml", TWIST), ("points.toml", POINTS)],
    )
}

#[test]
fn a_bound_warp_is_the_warp_also_with_other_targets() {
    let folder = folder();
    let said = folder
        .run(&["bind", "spot.obj", "-r", "points.toml", "-o", "spot.bind"])
        .done();
    assert!(said.err.contains("bytes a point"), "{}", said.err);
    for (name, set) in [
        ("a", "warp.0.point.0.by=[0, \"20%\", 0]"),
        ("b", "warp.0.point.0.by=[\"10%\", \"-5%\", 0]"),
        ("c", "warp.0.strength=0.25"),
    ] {
        let (direct, bound) = (format!("{name}.obj"), format!("{name}-bound.obj"));
        let warp = ["warp", "spot.obj", "-r", "points.toml", "--set", set, "-o"];
        folder.run(&[&warp[..], &[&direct]].concat()).done();
        let with = ["--binding", "spot.bind"];
        folder
            .run(&[&warp[..], &[&bound], &with[..]].concat())
            .done();
        let off = farthest(&vertices(&folder, &direct), &vertices(&folder, &bound));
        assert!(off < 1e-14, "{set}: {off}");
        assert!(farthest(&vertices(&folder, &direct), &vertices(&folder, "spot.obj")) > 0.01);
    }
    // Influences that hardly count are dropped, and the file says what that costs.
    let drop = ["bind", "spot.obj", "-r", "points.toml", "-o", "few.bind"];
    let said = folder
        .run(&[&drop[..], &["--drop-below", "0.2"]].concat())
        .done();
    assert!(said.err.contains("otherwise"), "{}", said.err);
    let size = |name: &str| fs::metadata(folder.path().join(name)).unwrap().len();
    assert!(size("few.bind") < size("spot.bind"));
}

#[test]
fn a_binding_refuses_other_models_other_warps_and_other_sources_by_name() {
    let folder = folder();
    folder
        .run(&["bind", "spot.obj", "-r", "points.toml", "-o", "spot.bind"])
        .done();
    let moved = ["warp", "spot.obj", "-r", "twist.toml", "-o", "other.obj"];
    folder.run(&moved).done();
    let text = fs::read_to_string(folder.path().join("spot.obj")).unwrap();
    fs::write(folder.path().join("more.obj"), format!("{text}v 0 0 0\n")).unwrap();
    let bytes = fs::read(folder.path().join("spot.bind")).unwrap();
    fs::write(folder.path().join("cut.bind"), &bytes[..bytes.len() / 2]).unwrap();
    let before = folder.names();
    let run = |model: &str, recipe: &str, binding: &str, set: &[&str], says: &[&str]| {
        let warp = [
            "warp",
            model,
            "-r",
            recipe,
            "-o",
            "out.obj",
            "--binding",
            binding,
        ];
        folder.run(&[&warp[..], set].concat()).failed(1, says);
    };
    let none: &[&str] = &[];
    run(
        "other.obj",
        "points.toml",
        "spot.bind",
        none,
        &["made for spot.obj", "other.obj", "bind it again"],
    );
    run(
        "more.obj",
        "points.toml",
        "spot.bind",
        none,
        &["made for spot.obj", "more.obj"],
    );
    run(
        "spot.obj",
        "twist.toml",
        "spot.bind",
        none,
        &["points", "twist"],
    );
    let from = ["--set", "warp.0.point.0.from=[\"40%\", \"90%\", \"60%\"]"];
    run(
        "spot.obj",
        "points.toml",
        "spot.bind",
        &from,
        &["not those that were bound", "points"],
    );
    run("spot.obj", "points.toml", "cut.bind", none, &["checksum"]);
    run(
        "spot.obj",
        "points.toml",
        "twist.toml",
        none,
        &["no binding"],
    );
    run(
        "spot.obj",
        "points.toml",
        "nowhere.bind",
        none,
        &["nowhere.bind"],
    );
    assert_eq!(folder.names(), before);
    let over = [
        "bind",
        "spot.obj",
        "-r",
        "points.toml",
        "-o",
        "points.toml",
        "--force",
    ];
    folder.run(&over).failed(2, &["choose another name"]);
    let over = [
        "warp",
        "spot.obj",
        "-r",
        "points.toml",
        "--binding",
        "spot.bind",
        "-o",
        "spot.bind",
        "--force",
    ];
    folder.run(&over).failed(2, &["replace the binding"]);
}

#[test]
fn an_inverted_recipe_leads_back() {
    let folder = folder();
    for recipe in ["twist.toml", "points.toml"] {
        let there = [
            "warp",
            "spot.obj",
            "-r",
            recipe,
            "-o",
            "there.obj",
            "--force",
        ];
        folder.run(&there).done();
        // Percentages are of the model as it is: give both ways the same.
        let report = ["--report", "report.json", "--force"];
        let back = [
            "warp",
            "there.obj",
            "-r",
            recipe,
            "-o",
            "back.obj",
            "--invert",
        ];
        let said = folder.run(&[&back[..], &report[..]].concat()).done();
        assert!(said.err.contains("undone: "), "{}", said.err);
        let report = folder.json("report.json");
        assert!(
            report["inverse"]["residual"].as_f64().unwrap() < 1e-9,
            "{report}"
        );
        assert_eq!(report["inverse"]["stayed"].as_array().unwrap().len(), 0);
        // The recipe moves what came back to where it was.
        let text = fs::read_to_string(folder.path().join(recipe)).unwrap();
        fs::write(
            folder.path().join("inverse.toml"),
            text.replacen("version = 1", "version = 1\nmapping = \"inverse\"", 1),
        )
        .unwrap();
        let back = [
            "warp",
            "there.obj",
            "-r",
            "inverse.toml",
            "-o",
            "again.obj",
            "--force",
        ];
        folder.run(&back).done();
        assert!(vertices(&folder, "again.obj") == vertices(&folder, "back.obj"));
    }
    // An absolute twist, there and back.
    let twist = "version = 1\n[[warp]]\nkind = \"twist\"\naxis = \"y\"\ncentre = [0, 0, 0]\npolynomial = [0, 1.5]\n";
    fs::write(folder.path().join("absolute.toml"), twist).unwrap();
    let there = ["warp", "spot.obj", "-r", "absolute.toml", "-o", "t.obj"];
    folder.run(&there).done();
    let back = [
        "warp",
        "t.obj",
        "-r",
        "absolute.toml",
        "-o",
        "b.obj",
        "--invert",
    ];
    folder.run(&back).done();
    let off = farthest(&vertices(&folder, "b.obj"), &vertices(&folder, "spot.obj"));
    assert!(off > 0.0 && off < 1e-6, "{off}");
}

#[test]
fn points_onto_which_nothing_is_moved_stay_and_are_named() {
    let folder = folder();
    // The lattice lifts all of its inside: what lies just above its floor has no origin.
    let lift = "version = 1\n[[warp]]\nkind = \"lattice\"\nshape = [2, 2, 2]\nbox = { min = [-9, -9, -9], max = [9, 9, 9] }\n\
        move = [{ index = [\"*\", \"*\", \"*\"], by = [0, 17.9, 0] }]\n";
    fs::write(folder.path().join("lift.toml"), lift).unwrap();
    let back = [
        "warp",
        "spot.obj",
        "-r",
        "lift.toml",
        "-o",
        "out.obj",
        "--invert",
        "--report",
        "r.json",
    ];
    let said = folder.run(&back).done();
    assert!(
        said.err
            .contains("nothing that the recipe moves lands on these points"),
        "{}",
        said.err
    );
    let stayed = folder.json("r.json")["inverse"]["stayed"]
        .as_array()
        .unwrap()
        .len();
    let count = vertices(&folder, "spot.obj").len();
    assert_eq!(stayed, count);
    assert!(vertices(&folder, "out.obj") == vertices(&folder, "spot.obj"));
}

#[test]
fn frames_go_from_rest_to_the_full_warp_and_go_on_where_they_stopped() {
    let folder = folder();
    let frames = [
        "warp",
        "spot.obj",
        "-r",
        "twist.toml",
        "--frames",
        "5",
        "-o",
        "f.%03d.obj",
    ];
    folder.run(&frames).done();
    folder
        .run(&["warp", "spot.obj", "-r", "twist.toml", "-o", "full.obj"])
        .done();
    let at = |name: &str| vertices(&folder, name);
    assert!(at("f.001.obj") == at("spot.obj"));
    assert!(at("f.005.obj") == at("full.obj"));
    let ways = (1..5).map(|n| {
        farthest(
            &at(&format!("f.{n:03}.obj")),
            &at(&format!("f.{:03}.obj", n + 1)),
        )
    });
    assert!(ways.into_iter().all(|way| way > 0.01));
    // A missing frame is made, finished ones are kept to the byte.
    fs::remove_file(folder.path().join("f.003.obj")).unwrap();
    fs::write(folder.path().join("f.002.obj"), "mine").unwrap();
    let third = at("f.004.obj");
    let said = folder.run(&frames).done();
    assert!(
        said.err.contains("4 frames exist and are kept"),
        "{}",
        said.err
    );
    assert_eq!(
        fs::read_to_string(folder.path().join("f.002.obj")).unwrap(),
        "mine"
    );
    assert!(folder.names().contains(&"f.003.obj".to_owned()));
    assert!(at("f.004.obj") == third);
    // A range, with numbers of its own.
    let some = [
        "warp",
        "spot.obj",
        "-r",
        "twist.toml",
        "--frames",
        "5",
        "--start",
        "1001",
        "--range",
        "1002-1003",
    ];
    folder
        .run(&[&some[..], &["-o", "g.####.obj"]].concat())
        .done();
    assert!(at("g.1003.obj") == at("f.003.obj"));
    assert!(!folder.names().contains(&"g.1001.obj".to_owned()));
    for (arguments, says) in [
        (vec!["--frames", "5", "-o", "out.obj"], "out.%04d.obj"),
        (vec!["--frames", "1", "-o", "o.#.obj"], "from 2 to"),
        (
            vec!["--frames", "5", "--range", "3-9", "-o", "o.#.obj"],
            "1 to 5",
        ),
        (vec!["--range", "3-4", "-o", "o.#.obj"], "--frames"),
        (
            vec!["--frames", "5", "--range", "x", "-o", "o.#.obj"],
            "10-20",
        ),
        (
            vec!["--frames", "5", "-o", "o.#.obj", "--report", "r.json"],
            "--report",
        ),
    ] {
        let base = ["warp", "spot.obj", "-r", "twist.toml"];
        folder
            .run(&[&base[..], &arguments].concat())
            .failed(2, &[says]);
    }
}

#[test]
fn tracks_and_schedules_are_in_force_frame_by_frame() {
    let folder = folder();
    let keyed = format!(
        "{}\n[[track]]\nset = \"warp.0.angle\"\nkeys = [[0, \"0deg\"], [0.5, \"80deg\"], [1, \"20deg\"]]\n",
        "version = 1\n[[warp]]\nkind = \"twist\"\naxis = \"y\"\nangle = \"1deg\""
    );
    fs::write(folder.path().join("keyed.toml"), keyed).unwrap();
    folder
        .run(&[
            "warp",
            "spot.obj",
            "-r",
            "keyed.toml",
            "--frames",
            "3",
            "-o",
            "k.%d.obj",
        ])
        .done();
    for (frame, angle) in [(1, "0deg"), (2, "80deg"), (3, "20deg")] {
        let set = format!("warp.0.angle={angle}");
        let warp = [
            "warp",
            "spot.obj",
            "-r",
            "keyed.toml",
            "--force",
            "-o",
            "still.obj",
            "--set",
            &set,
        ];
        folder.run(&warp).done();
        let off = farthest(
            &vertices(&folder, "still.obj"),
            &vertices(&folder, &format!("k.{frame}.obj")),
        );
        assert!(off < 1e-12, "{frame}: {off}");
    }
    // The second point comes in after the first is there.
    let schedule = POINTS.replace(
        "mask =",
        "schedule = { features = [{ end = 0.5 }, { start = 0.5 }] }\nmask =",
    );
    fs::write(folder.path().join("staged.toml"), schedule).unwrap();
    folder
        .run(&[
            "warp",
            "spot.obj",
            "-r",
            "staged.toml",
            "--frames",
            "3",
            "-o",
            "s.%d.obj",
        ])
        .done();
    folder
        .run(&["warp", "spot.obj", "-r", "points.toml", "-o", "all.obj"])
        .done();
    assert!(vertices(&folder, "s.3.obj") == vertices(&folder, "all.obj"));
    assert!(vertices(&folder, "s.1.obj") == vertices(&folder, "spot.obj"));
    // A pinned point moves nothing, whenever it comes in.
    let off = farthest(&vertices(&folder, "s.2.obj"), &vertices(&folder, "all.obj"));
    assert!(off < 1e-14, "{off}");
}

#[test]
fn two_recipes_are_compared() {
    let folder = folder();
    let text = folder
        .run(&["check", "twist.toml", "points.toml", "--model", "spot.obj"])
        .done()
        .text();
    assert!(
        text.contains("twist.toml and points.toml\n  commutation    refuted"),
        "{text}"
    );
    let json = folder
        .run(&["check", "twist.toml", "twist.toml", "--json"])
        .done()
        .json();
    let last = &json[2];
    assert_eq!(last["recipes"][0], "twist.toml");
    assert_eq!(last["guarantees"]["property"], "commutation");
    assert!(last["guarantees"]["verdict"] != "refuted", "{last}");
}
