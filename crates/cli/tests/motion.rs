//! `anamorph motion`: tables, animations and pictures of motions; what is refused, and that nothing is left then.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::{Folder, repository};
use serde_json::Value;

/// A recipe of the documentation.
fn documented(name: &str) -> String {
    std::fs::read_to_string(repository("docs/recipes").join(name)).unwrap()
}

/// A folder with this recipe as `m.toml`.
fn with(recipe: &str) -> Folder {
    let folder = Folder::new();
    folder.put("m.toml", recipe);
    folder
}

/// A recipe with this inside `[motion]`.
fn motion(inside: &str) -> String {
    format!("version = 1\n[motion]\n{inside}\n")
}

const LINE: &str =
    "path = { kind = \"catmull-rom\", points = [[0, 0, 0], [1, 1, 0], [3, 0, 1], [4, 2, 2]] }";

/// The rows of a table, without its head.
fn rows(text: &str) -> Vec<Vec<f64>> {
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("t,x,y,z,qw,qx,qy,qz,s,v"));
    lines
        .map(|line| line.split(',').map(|n| n.parse().unwrap()).collect())
        .collect()
}

#[test]
fn a_table_is_what_it_was() {
    let folder = with(&documented("figure-eight.toml"));
    let run = folder
        .run(&["motion", "m.toml", "-o", "-", "--fps", "4", "--quiet"])
        .done();
    assert_eq!(run.err, "");
    let mut text = String::new();
    for row in rows(&run.text()) {
        // Nine digits: what is behind them may depend on how lengths are measured.
        let row: Vec<String> = row
            .iter()
            .map(|n| format!("{:.9}", n + 0.0).replace("-0.000000000", "0.000000000"))
            .collect();
        text.push_str(&row.join(" "));
        text.push('\n');
    }
    insta::assert_snapshot!("figure-eight", text);
}

#[test]
fn tables_have_unit_quaternions_times_and_lengths() {
    for name in ["figure-eight.toml", "helix-camera.toml", "tumble.toml"] {
        let folder = with(&documented(name));
        folder
            .run(&["motion", "m.toml", "-o", "m.csv", "--fps", "30"])
            .done();
        let rows = rows(&String::from_utf8(folder.read("m.csv")).unwrap());
        let duration = rows.last().unwrap()[0];
        assert_eq!(rows.len(), (duration * 30.0).round() as usize + 1, "{name}");
        for (i, row) in rows.iter().enumerate() {
            assert_eq!(row[0], i as f64 / 30.0);
            let q: f64 = row[4..8].iter().map(|x| x * x).sum();
            assert!((q - 1.0).abs() < 1e-12, "{name} {i}");
        }
        for pair in rows.windows(2) {
            let (a, b) = (&pair[0], &pair[1]);
            let dot: f64 = (4..8).map(|k| a[k] * b[k]).sum();
            assert!(dot > 0.0, "{name}: signs jump at {}", b[0]);
            let chord = (1..4).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
            let along = b[8] - a[8];
            assert!(
                along >= chord - 1e-9 && along < chord * 1.2 + 1e-3,
                "{name} {} {along} {chord}",
                b[0]
            );
            // The speed is the length by the time, by the trapezoid rule.
            let mean = 0.5 * (a[9] + b[9]) / 30.0;
            assert!(
                (mean - along).abs() < 0.02 * (along + 0.01),
                "{name} {} {mean} {along}",
                b[0]
            );
        }
    }
}

#[test]
fn cameras_look_where_they_should() {
    let folder = with(&documented("helix-camera.toml"));
    folder.run(&["motion", "m.toml", "-o", "m.csv"]).done();
    for row in rows(&String::from_utf8(folder.read("m.csv")).unwrap()) {
        let [w, x, y, z] = [row[4], row[5], row[6], row[7]];
        // The camera's −z axis, turned.
        let ahead = [
            -2.0 * (x * z + w * y),
            -2.0 * (y * z - w * x),
            -(1.0 - 2.0 * (x * x + y * y)),
        ];
        let to = [-row[1], 1.5 - row[2], -row[3]];
        let length = to.iter().map(|n| n * n).sum::<f64>().sqrt();
        for k in 0..3 {
            assert!((ahead[k] - to[k] / length).abs() < 1e-9, "{row:?}");
        }
    }
}

/// The JSON part of a GLB file, and its buffer.
fn opened(file: &[u8]) -> (Value, Vec<u8>) {
    let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(&file[..4], b"glTF");
    assert_eq!(word(8), file.len());
    let json = word(12);
    let value = serde_json::from_slice(&file[20..20 + json]).unwrap();
    let bin = 20 + json;
    assert_eq!(word(bin), file.len() - bin - 8);
    (value, file[bin + 8..].to_vec())
}

/// The rows of an accessor.
fn accessor(json: &Value, buffer: &[u8], index: &Value) -> Vec<Vec<f64>> {
    let accessor = &json["accessors"][index.as_u64().unwrap() as usize];
    let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let width = match accessor["type"].as_str().unwrap() {
        "SCALAR" => 1,
        "VEC3" => 3,
        _ => 4,
    };
    let at = view["byteOffset"].as_u64().unwrap() as usize;
    let bytes = &buffer[at..at + view["byteLength"].as_u64().unwrap() as usize];
    let numbers: Vec<f64> = bytes
        .chunks(4)
        .map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap())))
        .collect();
    assert_eq!(
        numbers.len(),
        width * accessor["count"].as_u64().unwrap() as usize
    );
    if let Some(low) = accessor["min"].as_array() {
        for (k, low) in low.iter().enumerate() {
            let least = numbers
                .iter()
                .skip(k)
                .step_by(width)
                .copied()
                .fold(f64::INFINITY, f64::min);
            assert_eq!(low.as_f64().unwrap(), least);
        }
    }
    numbers.chunks(width).map(<[f64]>::to_vec).collect()
}

/// The sampler of a channel: how it interpolates, its times and its values.
fn sampler(json: &Value, buffer: &[u8], path: &str) -> (String, Vec<f64>, Vec<Vec<f64>>) {
    let animation = &json["animations"][0];
    let channels = animation["channels"].as_array().unwrap();
    let channel = channels
        .iter()
        .find(|c| c["target"]["path"] == path)
        .unwrap();
    let sampler = &animation["samplers"][channel["sampler"].as_u64().unwrap() as usize];
    let times: Vec<f64> = accessor(json, buffer, &sampler["input"]).concat();
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]) && times[0] == 0.0);
    let values = accessor(json, buffer, &sampler["output"]);
    let how = sampler["interpolation"].as_str().unwrap().to_owned();
    (how, times, values)
}

/// The value of a translation at a time, as glTF's appendix C says.
fn evaluated((how, times, values): &(String, Vec<f64>, Vec<Vec<f64>>), time: f64) -> [f64; 3] {
    let span = times
        .partition_point(|t| *t <= time)
        .clamp(1, times.len() - 1)
        - 1;
    let width = times[span + 1] - times[span];
    let x = ((time - times[span]) / width).clamp(0.0, 1.0);
    let mut out = [0.0; 3];
    for (k, out) in out.iter_mut().enumerate() {
        *out = if how == "LINEAR" {
            values[span][k] * (1.0 - x) + values[span + 1][k] * x
        } else {
            let key = |i: usize, part: usize| values[3 * i + part][k];
            let (x2, x3) = (x * x, x * x * x);
            (2.0 * x3 - 3.0 * x2 + 1.0) * key(span, 1)
                + width * (x3 - 2.0 * x2 + x) * key(span, 2)
                + (3.0 * x2 - 2.0 * x3) * key(span + 1, 1)
                + width * (x3 - x2) * key(span + 1, 0)
        };
    }
    out
}

/// Writes a motion as an animation and as a fine table, and compares them; the interpolation of the translation, and the report.
fn compared(recipe: &str) -> (String, Value) {
    let folder = with(recipe);
    folder
        .run(&[
            "motion", "m.toml", "-o", "m.glb", "--report", "r.json", "--fps", "24",
        ])
        .done();
    folder
        .run(&["motion", "m.toml", "-o", "m.csv", "--fps", "997"])
        .done();
    let report = folder.json("r.json");
    let (json, buffer) = opened(&folder.read("m.glb"));
    assert_eq!(
        json["asset"]["extras"]["translation"],
        report["tracks"]["translation"]
    );
    let translation = sampler(&json, &buffer, "translation");
    let rotation = sampler(&json, &buffer, "rotation");
    assert_eq!(rotation.0, "LINEAR");
    for q in &rotation.2 {
        assert!((q.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-6);
    }
    let said = report["tracks"]["translation"]["error"].as_f64().unwrap();
    let rows = rows(&String::from_utf8(folder.read("m.csv")).unwrap());
    let size = rows
        .iter()
        .flat_map(|r| &r[1..4])
        .fold(0.0_f64, |m, x| m.max(x.abs()));
    let mut worst = 0.0_f64;
    for row in rows {
        let at = evaluated(&translation, row[0]);
        let off = (0..3)
            .map(|k| (at[k] - row[k + 1]).powi(2))
            .sum::<f64>()
            .sqrt();
        worst = worst.max(off);
    }
    // Errors are measured at other places than here, and numbers have 32 bits.
    assert!(worst <= 1.1 * said + 1e-6 * size, "{worst} {said}");
    if translation.0 == "LINEAR" {
        assert!(worst >= 0.5 * said, "{worst} {said}");
    }
    (translation.0, report)
}

#[test]
fn animations_are_cubic_where_that_is_exact_and_else_say_their_error() {
    assert_eq!(compared(&documented("tumble.toml")).0, "CUBICSPLINE");
    let (linear, report) = compared(&documented("figure-eight.toml"));
    assert_eq!(linear, "LINEAR");
    assert!(report["tracks"]["translation"]["error"].as_f64().unwrap() > 1e-4);
    assert_eq!(compared(&documented("helix-camera.toml")).0, "LINEAR");
    // A polyline passed by a cubic of the time: corners and the ease's breaks are keys.
    let polyline = "path = { kind = \"b-spline\", degree = 1, points = [[0, 0, 0], [1, 0, 0], [1, 2, 0], [1, 2, 5]] }";
    let cubic = format!("duration = 3\nspeed = \"cubic\"\n{polyline}");
    let (how, report) = compared(&motion(&cubic));
    assert_eq!(how, "CUBICSPLINE");
    assert_eq!(report["tracks"]["translation"]["keys"], 4);
    // Distances by cubics in time, there and back.
    let keys =
        format!("speed = {{ distances = [[0, 0], [1, \"100%\"], [2.5, \"10%\"]] }}\n{polyline}");
    assert_eq!(compared(&motion(&keys)).0, "CUBICSPLINE");
    // A jump is no cubic.
    let steps = format!("duration = 3\nspeed = \"steps(3)\"\n{LINE}");
    let folder = with(&motion(&steps));
    folder.run(&["motion", "m.toml", "-o", "m.glb"]).done();
    let (json, buffer) = opened(&folder.read("m.glb"));
    assert_eq!(sampler(&json, &buffer, "translation").0, "LINEAR");
}

#[test]
fn slerp_between_keys_is_written_at_its_keys() {
    let keys = "orientation = { kind = \"slerp\", keys = [{ time = 0, axis = \"y\", angle = \"0deg\" }, \
        { time = 0.7, axis = \"y\", angle = \"100deg\" }, { time = 2, axis = \"x\", angle = \"-90deg\" }] }";
    let folder = with(&motion(&format!("duration = 2\n{LINE}\n{keys}")));
    folder
        .run(&["motion", "m.toml", "-o", "m.glb", "--report", "r.json"])
        .done();
    let rotation = &folder.json("r.json")["tracks"]["rotation"];
    assert_eq!(rotation["keys"], 3);
    assert!(rotation["error"].as_f64().unwrap() < 5e-7);
    let (json, buffer) = opened(&folder.read("m.glb"));
    let (_, times, values) = sampler(&json, &buffer, "rotation");
    assert!((times[1] - 0.7).abs() < 1e-6);
    assert!((values[1][1] - 50.0_f64.to_radians().sin()).abs() < 1e-6);
}

#[test]
fn cameras_are_cameras() {
    let folder = with(&documented("helix-camera.toml"));
    folder.run(&["motion", "m.toml", "-o", "m.glb"]).done();
    let (json, _) = opened(&folder.read("m.glb"));
    assert_eq!(json["nodes"][0]["camera"], 0);
    assert_eq!(json["cameras"][0]["type"], "perspective");
    // The file is one that is read.
    folder.run(&["inspect", "m.glb", "--json"]).done();
}

#[test]
fn pictures_are_drawn() {
    for name in ["figure-eight.toml", "helix-camera.toml"] {
        let folder = with(&documented(name));
        folder.run(&["motion", "m.toml", "-o", "m.svg"]).done();
        let svg = String::from_utf8(folder.read("m.svg")).unwrap();
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
        assert!(svg.contains(">speed</text>") && !svg.contains("NaN"));
        assert!(svg.matches("<circle").count() >= 50);
        folder
            .run(&[
                "motion", "m.toml", "-o", "m.png", "--size", "640x360", "--theme", "dark",
            ])
            .done();
        let png = folder.read("m.png");
        let picture = tiny_skia::Pixmap::decode_png(&png).unwrap();
        assert_eq!((picture.width(), picture.height()), (640, 360));
        let orange = picture
            .pixels()
            .iter()
            .filter(|p| p.red() > 220 && p.blue() < 100 && p.green() < 180);
        assert!(orange.count() > 100);
    }
    let folder = with(&documented("figure-eight.toml"));
    folder
        .run(&["motion", "m.toml", "-o", "m.png", "--size", "100000x3"])
        .failed(2, &["--size", "pixels"]);
    assert_eq!(folder.names(), ["m.toml"]);
}

#[test]
fn faults_and_repairs_are_warnings() {
    let speed = "speed = { distances = [[0, 0], [1, \"60%\", -1], [2, \"40%\"], [3, \"100%\"]] }";
    let folder = with(&motion(&format!("{LINE}\n{speed}")));
    let run = folder.run(&["motion", "m.toml", "-o", "-"]).done();
    assert!(
        run.err.contains("warning: m.toml: it backs up from 1 to 2"),
        "{}",
        run.err
    );
    assert!(
        run.err
            .contains("the speed of key 1 is 0 instead of -1: the keys turn round there")
    );
    let run = folder
        .run(&["motion", "m.toml", "-o", "-", "--quiet"])
        .done();
    assert_eq!(run.err, "");
    folder
        .run(&["motion", "m.toml", "-o", "x.csv", "--report", "r.json"])
        .done();
    let report = folder.json("r.json");
    assert!(
        report["findings"]
            .as_array()
            .unwrap()
            .iter()
            .any(|f| f["time"] == 1.0)
    );
    assert_eq!(report["changes"].as_array().unwrap().len(), 1);
    let check = folder.run(&["check", "m.toml"]).done().text();
    assert!(
        check.contains("backs up") && check.contains("catmull-rom"),
        "{check}"
    );
    let check = folder.run(&["check", "m.toml", "--json"]).done().json();
    assert_eq!(check[0]["motion"]["path"]["family"], "catmull-rom");
}

#[test]
fn duration_and_settings_change_the_motion() {
    let folder = with(&motion(&format!(
        "duration = 2\nspeed = \"ease-in-out\"\n{LINE}"
    )));
    let last = |arguments: &[&str]| {
        let mut all = vec!["motion", "m.toml", "-o", "-", "--quiet"];
        all.extend(arguments);
        rows(&folder.run(&all).done().text())
            .last()
            .unwrap()
            .clone()
    };
    assert_eq!(last(&[])[0], 2.0);
    assert_eq!(last(&["--duration", "5"])[0], 5.0);
    assert_eq!(last(&["--duration", "5"])[1..4], [4.0, 2.0, 2.0]);
    let flat = last(&["--set", "motion.path.points=[[0, 0], [3, 4]]", "--fps", "2"]);
    assert_eq!(flat[1..4], [3.0, 4.0, 0.0]);
    assert!((flat[8] - 5.0).abs() < 1e-9);
}

#[test]
fn paths_from_files() {
    let from = |file: &str| {
        motion(&format!(
            "duration = 1\npath = {{ kind = \"b-spline\", degree = 1, points = \"{file}\" }}"
        ))
    };
    let folder = with(&from("points.csv"));
    folder.put("points.csv", "x,y,z\n0,0,0\n1,0,0\n1,1,0\n");
    let end = |folder: &Folder| {
        let run = folder
            .run(&["motion", "m.toml", "-o", "-", "--quiet"])
            .done();
        rows(&run.text()).last().unwrap()[1..4].to_vec()
    };
    assert_eq!(end(&folder), [1.0, 1.0, 0.0]);
    // In the order of its lines, not of its points; a ring is closed.
    folder.put("m.toml", from("line.obj"));
    folder.put("line.obj", "v 0 0 0\nv 9 9 9\nv 5 0 0\nv 5 5 0\nl 4 3 1\n");
    assert_eq!(end(&folder), [5.0, 5.0, 0.0]);
    folder.put("line.obj", "v 0 0 0\nv 5 0 0\nv 5 5 0\nl 1 2 3 1\n");
    assert_eq!(end(&folder), [0.0, 0.0, 0.0]);
    folder.put(
        "line.obj",
        "v 0 0 0\nv 5 0 0\nv 5 5 0\nv 7 7 7\nl 1 2 3\nl 2 4\n",
    );
    let run = folder.run(&["motion", "m.toml", "-o", "x.csv"]);
    run.failed(1, &["m.toml:4:", "motion.path.points", "not one polyline"]);
    folder.put("m.toml", from("../line.obj"));
    folder
        .run(&["motion", "m.toml", "-o", "x.csv"])
        .failed(1, &["outside", "--allow-outside"]);
    folder.put("m.toml", from("none.csv"));
    folder
        .run(&["motion", "m.toml", "-o", "x.csv"])
        .failed(1, &["none.csv"]);
    folder.put("points.csv", "x,y,z\n0,0,0\nnan,0,0\n");
    folder.put("m.toml", from("points.csv"));
    folder
        .run(&["motion", "m.toml", "-o", "x.csv"])
        .failed(1, &["points.csv"]);
    folder.put("points.csv", "x,y,z\n0,0,0\n1,0,0\n");
    folder
        .run(&["motion", "m.toml", "-o", "points.csv", "--force"])
        .failed(2, &["would replace a file that the recipe reads"]);
    assert!(!folder.names().iter().any(|name| name == "x.csv"));
}

#[test]
fn bad_input_has_one_message_and_leaves_nothing() {
    let path = |points: &str| {
        format!("duration = 1\npath = {{ kind = \"catmull-rom\", points = {points} }}")
    };
    let long: String = "x".repeat(300);
    let cases: &[(String, &[&str])] = &[
        (path("[[0, 0, 0], [nan, 0, 0]]"), &["m.toml:4:", "finite"]),
        (path("[[0, 0, 0]]"), &["m.toml:4:", "motion.path.points", "at least 2 points"]),
        (path("[]"), &["motion.path.points"]),
        (path("[[0, 0, 0], [0, 0, 0]]"), &["no length"]),
        (path("[[0, 0, 0], [1, 0]]"), &["motion.path.points.1", "two numbers, or all three"]),
        (path("[[0, 0, 0], [1]]"), &["motion.path.points.1", "a point of 1 number"]),
        (path("[[0, 0, 0], [1e60, 0, 0]]"), &["too large"]),
        (path("3"), &["motion.path.points", "points were expected"]),
        ("duration = 1".to_owned(), &["`path` is missing"]),
        (format!("{LINE}\nspeed = \"linear\""), &["`duration` is missing"]),
        (format!("duration = 0\n{LINE}"), &["m.toml:3:", "motion.duration", "duration is 0"]),
        (format!("duration = -1\n{LINE}"), &["motion.duration"]),
        (format!("duration = 1\n{LINE}\nspeed = \"ease-inn-out\""), &["motion.speed", "did you mean `ease-in-out`"]),
        (format!("duration = 1\n{LINE}\nspeed = \"{long}\""), &["motion.speed", "no ease"]),
        (format!("duration = 1\n{LINE}\nspeed = \"steps(0)\""), &["motion.speed"]),
        (format!("duration = 1\n{LINE}\nspeed = {{ ease = \"back-in\", overshot = 1 }}"), &["m.toml:5:", "overshot", "did you mean `overshoot`"]),
        (format!("duration = 1\n{LINE}\nspeed = {{ ease = \"back-in\", overshoot = 1000 }}"), &["motion.speed", "overshoot"]),
        (format!("{LINE}\nspeed = {{ distances = [[0, 0], [2, 1], [1, 3]] }}"), &["motion.speed.distances", "the time of key 2 is 1"]),
        (format!("{LINE}\nspeed = {{ distances = [[0, 0]] }}"), &["motion.speed.distances", "at least 2"]),
        (format!("{LINE}\nspeed = {{ distances = [[0, 0], [1, 2, 3, 4]] }}"), &["motion.speed.distances.1", "4 entries"]),
        (format!("{LINE}\nspeed = {{ distances = [[\"0%\", 0], [1, 2]] }}"), &["add `duration`"]),
        (format!("{LINE}\nspeed = {{ speeds = [[0, 0], [1, 0]] }}"), &["motion.speed.speeds", "cannot be met"]),
        (
            format!("{LINE}\nspeed = {{ speeds = [[0, 100, \"fixed\"], [1, 100, \"fixed\"]] }}"),
            &["cannot be met"],
        ),
        (format!("{LINE}\nspeed = {{ speeds = [[0, 1, \"fast\"], [1, 1]] }}"), &["motion.speed.speeds.0.2", "\"fixed\""]),
        (format!("{LINE}\nspeed = {{ speeds = [[0, 1], [1, 1]], distances = [[0, 1], [1, 1]] }}"), &["motion.speed"]),
        (format!("duration = 1\n{LINE}\nspede = 1"), &["m.toml:5:1", "motion.spede", "did you mean `speed`"]),
        (format!("duration = 1\n{LINE}\norientation = \"frenett\""), &["motion.orientation", "did you mean `frenet`"]),
        (format!("duration = 1\n{LINE}\norientation = \"look-at\""), &["`target` is missing"]),
        (format!("duration = 1\n{LINE}\norientation = {{ kind = \"frenet\", target = [0, 0, 0] }}"), &["target"]),
        (format!("duration = 1\n{LINE}\norientation = {{ kind = \"up\", up = [0, 0, 0] }}"), &["motion.orientation.up"]),
        (format!("duration = 1\n{LINE}\norientation = {{ kind = \"squad\", keys = [] }}"), &["motion.orientation.keys", "no keys"]),
        (
            format!("duration = 1\n{LINE}\norientation = {{ kind = \"squad\", keys = [{{ time = 0, quaternion = [0, 0, 0, 0] }}] }}"),
            &["keys.0.quaternion", "no rotation"],
        ),
        (
            format!("duration = 1\n{LINE}\norientation = {{ kind = \"squad\", keys = [{{ time = 0, axis = \"y\", angle = 90 }}] }}"),
            &["keys.0.angle", "90deg"],
        ),
        (
            format!("duration = 1\n{LINE}\norientation = {{ kind = \"slerp\", keys = [{{ time = 1, axis = \"y\", angle = \"1deg\" }}, {{ time = 0, axis = \"y\", angle = \"1deg\" }}] }}"),
            &["sort the keys by time"],
        ),
        ("duration = 1\npath = { kind = \"catmul-rom\", points = [[0, 0], [1, 1]] }".to_owned(), &["m.toml:4:", "did you mean `catmull-rom`"]),
        ("duration = 1\npath = { kind = \"lagrange\", closed = true, points = [[0, 0], [1, 1]] }".to_owned(), &["closed"]),
        ("duration = 1\npath = { kind = \"hermite\", points = [[0, 0], [1, 1]] }".to_owned(), &["velocities"]),
        (
            "duration = 1\npath = { kind = \"catmull-rom\", points = [[0, 0], [1, 1]], smooth = { kind = \"box\", radius = 1.5 } }".to_owned(),
            &["motion.path.smooth.radius", "whole number"],
        ),
        (
            "duration = 1\npath = { kind = \"catmull-rom\", points = [[0, 0], [1, 1]], smooth = { kind = \"average\", pinned = [7] } }".to_owned(),
            &["pinned point 7 does not exist"],
        ),
        (format!("duration = 1\n{LINE}\n[[warp]]\nkind = \"twist\""), &["warp", "keep them in two files"]),
    ];
    for (inside, says) in cases {
        let folder = with(&motion(inside));
        let mut all = vec!["error: "];
        all.extend(*says);
        let run = folder
            .run(&["motion", "m.toml", "-o", "m.csv"])
            .failed(1, &all);
        assert!(!run.err.contains("panicked"), "{}", run.err);
        assert!(run.err.lines().all(|line| line.len() < 1200), "{}", run.err);
        assert_eq!(folder.names(), ["m.toml"], "{inside}");
    }
}

#[test]
fn arguments_that_make_no_sense_are_refused() {
    let folder = with(&motion(&format!("duration = 1\n{LINE}")));
    let cases: &[(&[&str], i32, &[&str])] = &[
        (&["-o", "m.csv", "--fps", "0"], 2, &["--fps"]),
        (&["-o", "m.csv", "--fps", "-3"], 2, &["fps"]),
        (&["-o", "m.csv", "--fps", "nan"], 2, &["--fps"]),
        (&["-o", "m.csv", "--fps", "1e9"], 2, &["--fps"]),
        (
            &["-o", "m.csv", "--fps", "1000000"],
            1,
            &["more than 1000000 frames"],
        ),
        (&["-o", "m.csv", "--duration", "0"], 2, &["--duration"]),
        (&["-o", "m.csv", "--duration", "inf"], 2, &["--duration"]),
        (
            &["-o", "m.glb", "--duration", "1e9", "--fps", "0.001"],
            1,
            &["more than 1000000 frames"],
        ),
        (&["-o", "m.txt"], 2, &[".csv", ".glb"]),
        (&["-o", "m"], 2, &[".csv"]),
        (&["-o", "m.gltf"], 2, &["name it .glb"]),
        (&["-o", "none/m.csv"], 1, &["folder does not exist"]),
        (&["-o", "m.toml", "--force"], 2, &[".csv"]),
        (&["-o", "m.csv", "--report", "m.csv"], 2, &["two results"]),
        (
            &["-o", "m.csv", "--report", "m.toml", "--force"],
            2,
            &["replace the recipe"],
        ),
        (&["-o", "m.csv", "--report", "-"], 2, &["only the table"]),
        (
            &["-o", "m.csv", "--set", "motion.path.kind=lagrangee"],
            1,
            &["did you mean `lagrange`"],
        ),
    ];
    for (arguments, code, says) in cases {
        let mut all = vec!["motion", "m.toml"];
        all.extend(*arguments);
        let run = folder.run(&all);
        assert_eq!(run.code, *code, "{arguments:?} {run:?}");
        for words in *says {
            assert!(
                run.err.contains(words),
                "{arguments:?}: no {words:?} in {}",
                run.err
            );
        }
        assert_eq!(folder.names(), ["m.toml"], "{arguments:?}");
    }
    folder.run(&["motion", "m.toml", "-o", "m.csv"]).done();
    folder
        .run(&["motion", "m.toml", "-o", "m.csv"])
        .failed(1, &["--force"]);
    folder
        .run(&["motion", "m.toml", "-o", "m.csv", "--force"])
        .done();
}

#[test]
fn warps_and_motions_are_told_apart() {
    let folder = with(&documented("tumble.toml"));
    folder
        .put("twist.toml", common::TWIST)
        .put("spot.obj", common::fixture("valid/spot.obj"));
    folder
        .run(&["warp", "spot.obj", "-r", "m.toml", "-o", "x.obj"])
        .failed(1, &["m.toml:4:", "of a motion", "anamorph motion"]);
    folder
        .run(&["motion", "twist.toml", "-o", "x.csv"])
        .failed(1, &["no motion", "anamorph warp"]);
    assert!(!folder.names().iter().any(|name| name.starts_with("x.")));
}

#[test]
fn lists_name_everything() {
    let folder = Folder::new();
    for (kind, least, some) in [
        ("curves", 9, "catmull-rom"),
        ("eases", 30, "constant-acceleration"),
        ("orientations", 13, "rotation-minimizing"),
    ] {
        let text = folder.run(&["list", kind]).done().text();
        let json = folder.run(&["list", kind, "--json"]).done().json();
        let all = json.as_array().unwrap();
        assert!(
            all.len() >= least && text.lines().count() == all.len(),
            "{kind}"
        );
        assert!(all.iter().any(|entry| entry["name"] == some));
        for entry in all {
            assert!(
                entry["reference"].as_str().is_some_and(|r| r.len() > 5),
                "{entry}"
            );
        }
    }
}
