//! What `anamorph motion` once did wrong, or for ever, each under the name of what it was.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::{Folder, repository};
use std::fmt::Write;
use std::time::{Duration, Instant};

/// A folder with this inside `[motion]` of `m.toml`.
fn with(inside: &str) -> Folder {
    let folder = Folder::new();
    folder.put("m.toml", format!("version = 1\n[motion]\n{inside}\n"));
    folder
}

const LINE: &str =
    "path = { kind = \"catmull-rom\", points = [[0, 0, 0], [1, 1, 0], [3, 0, 1], [4, 2, 2]] }";
const RING: &str = "path = { kind = \"catmull-rom\", closed = true, points = [[2, 0, 0], [0, 0.3, 2], [-2, 0, 0.5], [0.5, -0.3, -2]] }";

/// The rows of the table of a recipe, and what was said.
fn table(inside: &str, more: &[&str]) -> (Vec<Vec<f64>>, String) {
    let folder = with(inside);
    let mut arguments = vec!["motion", "m.toml", "-o", "m.csv"];
    arguments.extend(more);
    let run = folder.run(&arguments).done();
    let text = String::from_utf8(folder.read("m.csv")).unwrap();
    let rows = text.lines().skip(1).map(|line| {
        let numbers = line.split(',').map(|n| n.parse().unwrap());
        numbers.collect::<Vec<f64>>()
    });
    let rows: Vec<Vec<f64>> = rows.collect();
    assert!(rows.iter().flatten().all(|n| n.is_finite()), "{inside}");
    (rows, run.err)
}

/// Refuses a recipe with words.
fn refused(inside: &str, says: &[&str]) {
    let folder = with(inside);
    let started = Instant::now();
    folder
        .run(&["motion", "m.toml", "-o", "m.csv"])
        .failed(1, says);
    assert_eq!(folder.names(), ["m.toml"], "{inside}");
    assert!(started.elapsed() < Duration::from_secs(20), "{inside}");
}

#[test]
fn wild_paths_took_minutes() {
    let started = Instant::now();
    for count in [17, 25, 33] {
        let mut points = String::new();
        for i in 0..count {
            let _ = write!(points, "[{i}, {}, 0], ", if i % 2 == 0 { 1 } else { -1 });
        }
        let path = format!("path = {{ kind = \"lagrange\", points = [{points}] }}");
        let (rows, _) = table(&format!("duration = 2\n{path}"), &[]);
        assert_eq!(rows.len(), 49);
    }
    assert!(started.elapsed() < Duration::from_secs(60));
    let nodes = |nodes: &str| {
        format!(
            "duration = 1\npath = {{ kind = \"lagrange\", points = [[0, 0], [1, 1], [2, 0], [3, 1]], nodes = {nodes} }}"
        )
    };
    refused(
        &nodes("[0, 1, 1.000000000000001, 3]"),
        &["motion.path.nodes", "node 2", "a billionth"],
    );
    refused(
        &nodes("[0, 1e150, 2e150, 3e150]"),
        &["motion.path.nodes.1", "at most 1e50"],
    );
}

#[test]
fn tiny_paths_took_long() {
    for kind in ["lagrange", "catmull-rom", "bezier", "b-spline"] {
        for size in ["1e-155", "1e-160", "1e-310"] {
            let path = format!(
                "path = {{ kind = \"{kind}\", points = [[0, 0], [{size}, {size}], [{size}, 0], [0, {size}]] }}"
            );
            refused(
                &format!("duration = 1\n{path}"),
                &["motion.path.points", "too small", "at least 1e-75"],
            );
        }
    }
}

#[test]
fn a_million_steps_printed_a_million_warnings() {
    let started = Instant::now();
    let (_, said) = table(
        &format!("duration = 2\nspeed = \"steps(1000000)\"\n{LINE}"),
        &[],
    );
    assert!(
        started.elapsed() < Duration::from_secs(60),
        "{:?}",
        started.elapsed()
    );
    assert!(said.lines().count() < 40, "{said}");
    assert!(said.contains("more jumps"), "{said}");
    let folder = with(&format!("duration = 2\nspeed = \"steps(20000)\"\n{LINE}"));
    folder
        .run(&["motion", "m.toml", "-o", "m.svg", "--report", "r.json"])
        .done();
    let report = folder.json("r.json");
    assert!(report["findings"].as_array().unwrap().len() < 5000);
    assert!(report["more"]["jumps"].as_u64().unwrap() > 10_000);
    assert!(folder.read("m.svg").len() < 2_000_000);
}

#[test]
fn too_many_points_were_refused_late_and_without_a_limit() {
    let mut points = String::new();
    for i in 0..100_001 {
        let _ = write!(points, "[{i},{}],", i % 3);
    }
    refused(
        &format!("duration = 1\npath = {{ kind = \"b-spline\", points = [{points}] }}"),
        &["motion.path.points", "100001 points", "at most 100000"],
    );
    let mut points = String::new();
    for i in 0..50_000 {
        let _ = write!(points, "[{i},{}],", i % 3);
    }
    refused(
        &format!("duration = 1\npath = {{ kind = \"b-spline\", degree = 5, points = [{points}] }}"),
        &["motion.path.points", "49995 pieces", "at most 10922"],
    );
}

#[test]
fn errors_of_animations_left_out_their_rounding() {
    let said = |offset: &str| {
        let folder = with(&format!(
            "duration = 2\npath = {{ kind = \"b-spline\", degree = 1, points = [[{offset}, 0, 0], [{offset}.3, 1, 0], [{offset}.7, 3, 0.1]] }}"
        ));
        let run = folder
            .run(&["motion", "m.toml", "-o", "m.glb", "--report", "r.json"])
            .done();
        let error = folder.json("r.json")["tracks"]["translation"]["error"]
            .as_f64()
            .unwrap();
        (error, run.err)
    };
    let (near, quiet) = said("0");
    assert!(
        near > 1e-9 && near < 1e-6 && !quiet.contains("32-bit"),
        "{near} {quiet}"
    );
    let (far, loud) = said("1000000");
    assert!(
        far > 1e-3 && far < 0.1 && loud.contains("32-bit numbers of glTF"),
        "{far} {loud}"
    );
    let tiny = with(
        "duration = 2\npath = { kind = \"catmull-rom\", points = [[0, 0, 0], [1e-60, 0, 0], [0, 1e-60, 0]] }",
    );
    let run = tiny.run(&["motion", "m.toml", "-o", "m.glb"]).done();
    assert!(run.err.contains("32-bit numbers of glTF"), "{}", run.err);
}

#[test]
fn infinite_speeds_stood_in_tables() {
    for ease in [
        "circular-in",
        "circular-out",
        "circular-in-out",
        "cubic-bezier(1, 0, 0, 1)",
    ] {
        let (rows, _) = table(
            &format!("duration = 2\nspeed = \"{ease}\"\n{LINE}"),
            &["--fps", "10"],
        );
        let most = rows.iter().map(|row| row[9]).fold(0.0, f64::max);
        assert!(most > 5.0 && most < 1e3, "{ease}: {most}");
    }
}

#[test]
fn rounds_and_a_half_never_arrived() {
    let (rows, said) = table(
        &format!("duration = 5\nspeed = {{ ease = \"sinusoidal\", distance = \"250%\" }}\n{RING}"),
        &[],
    );
    assert!(!said.contains("warning"), "{said}");
    assert!(rows.last().unwrap()[8] > 2.0 * rows[0][8]);
}

#[test]
fn eases_beyond_the_end_were_said_to_back_up() {
    let (rows, said) = table(&format!("duration = 2\nspeed = \"back-out\"\n{LINE}"), &[]);
    assert!(
        said.contains("goes beyond the end of the path") && said.contains("waits at the end"),
        "{said}"
    );
    assert!(!said.contains("backs up"), "{said}");
    let length = rows.last().unwrap()[8];
    assert!(rows.iter().all(|row| row[8] <= length));
    let waiting: Vec<&Vec<f64>> = rows.iter().filter(|row| row[8] == length).collect();
    assert!(waiting.len() > 10 && waiting.iter().all(|row| row[9] == 0.0));
}

#[test]
fn tables_and_animations_ended_at_different_times() {
    let folder = with(&format!("duration = 1.23\n{LINE}"));
    folder
        .run(&["motion", "m.toml", "-o", "m.csv", "--fps", "10"])
        .done();
    folder
        .run(&["motion", "m.toml", "-o", "m.glb", "--fps", "10"])
        .done();
    let text = String::from_utf8(folder.read("m.csv")).unwrap();
    assert!(text.lines().last().unwrap().starts_with("1.23,"));
    assert_eq!(text.lines().count(), 1 + 13 + 1);
    let file = folder.read("m.glb");
    let json = String::from_utf8_lossy(&file).into_owned();
    let end = format!("{:?}", f64::from(1.23_f32));
    assert!(json.contains(&format!("\"max\":[{end}]")), "{end}");
}

#[test]
fn orientations_that_jump_had_no_faults() {
    let cases = [
        (
            "path = { kind = \"b-spline\", points = [[-1, 0, 0], [0, 0, 0], [1, 0, 0], [3, 0, 0]] }\norientation = { kind = \"look-at\", target = [1, 0, 0] }",
            "turns by 180 degrees at once",
        ),
        (
            "path = { kind = \"catmull-rom\", closed = true, points = [[0, 0, 0], [1, 1, 0], [0, 2, 0], [-1, 1, 0]] }\norientation = \"up\"",
            "turns by 180 degrees at once",
        ),
    ];
    for (inside, says) in cases {
        let folder = with(&format!("duration = 4\n{inside}"));
        let text = folder.run(&["check", "m.toml"]).done().text();
        assert!(text.contains(says) && !text.contains("no faults"), "{text}");
        let (_, said) = table(&format!("duration = 4\n{inside}"), &[]);
        assert!(said.contains(says), "{said}");
    }
    // Banking closes a loop, and leans evenly where curvature jumps.
    let banked = format!(
        "duration = 2\n{RING}\norientation = {{ kind = \"rotation-minimizing\", banking = true }}"
    );
    let (rows, said) = table(&banked, &["--fps", "200"]);
    assert!(!said.contains("at once"), "{said}");
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    let dot: f64 = (4..8).map(|k| first[k] * last[k]).sum();
    assert!(dot.abs() > 1.0 - 1e-6, "{dot}");
}

#[test]
fn documented_recipes_have_no_faults() {
    for name in ["figure-eight.toml", "helix-camera.toml", "tumble.toml"] {
        let folder = Folder::new();
        let recipe = std::fs::read_to_string(repository("docs/recipes").join(name)).unwrap();
        folder.put("m.toml", recipe);
        let text = folder.run(&["check", "m.toml"]).done().text();
        // What is thrown starts and ends abruptly.
        assert!(
            text.contains("no faults") || name == "tumble.toml",
            "{text}"
        );
        assert!(!text.contains("at once"), "{text}");
    }
}

#[test]
fn what_was_taken_without_a_word() {
    let spline = |more: &str| {
        format!(
            "duration = 1\npath = {{ kind = \"b-spline\", points = [[0, 0], [1, 1], [2, 0], [3, 1]], {more} }}"
        )
    };
    for good in [
        "clamped = true",
        "clamped = false",
        "clamped = 1",
        "clamped = 0",
    ] {
        table(&spline(good), &[]);
    }
    refused(
        &spline("clamped = 2"),
        &["motion.path.clamped", "true or false"],
    );
    refused(
        &spline("clamped = true, knots = [0, 0, 0, 0, 1, 1, 1, 1]"),
        &["motion.path.clamped", "does not read `clamped`"],
    );
    let keys = |keys: &str| {
        format!("duration = 2\n{LINE}\norientation = {{ kind = \"slerp\", keys = [{keys}] }}")
    };
    refused(
        &keys(
            "{ time = -1, axis = \"y\", angle = \"0deg\" }, { time = 1, axis = \"y\", angle = \"9deg\" }",
        ),
        &["keys.0.time", "is -1", "begins at 0"],
    );
    let (_, said) = table(
        &keys(
            "{ time = 0, axis = \"y\", angle = \"0deg\" }, { time = 2, axis = \"y\", angle = \"360deg\" }",
        ),
        &[],
    );
    assert!(
        said.contains("keys 0 and 1 are 360 degrees apart") && said.contains("turns by 0"),
        "{said}"
    );
    let (_, said) = table(
        &keys(
            "{ time = 0, axis = \"y\", angle = \"0deg\" }, { time = 1, axis = \"y\", angle = \"120deg\" }, { time = 5, axis = \"y\", angle = \"240deg\" }",
        ),
        &[],
    );
    assert!(
        said.contains("key 2 of the orientation, at 5, is later than the end of the motion, 2"),
        "{said}"
    );
    let (_, said) = table(
        &format!("{LINE}\nduration = 1\nspeed = {{ distances = [[0, 0], [3, 1], [4, \"100%\"]] }}"),
        &[],
    );
    assert!(
        said.contains("keys 1 to 2 of distances, from 3 to 4, are later"),
        "{said}"
    );
    refused(
        &format!(
            "{LINE}\nduration = 1\nspeed = {{ ease = \"stops\", stops = [[0, 0], [0.5, 1], [0.2, 0.5], [1, 1]] }}"
        ),
        &["motion.speed.stops.2", "time of stop 2 is 0.2", "sort"],
    );
    let folder = with(&format!("duration = 1\n{LINE}"));
    for name in ["m.svg", "m.png"] {
        folder
            .run(&["motion", "m.toml", "-o", name, "--size", "0x0"])
            .failed(2, &["--size", "from 1 to 16384"]);
    }
    assert_eq!(folder.names(), ["m.toml"]);
}

#[test]
fn messages_that_led_astray() {
    let speed = |speed: &str| format!("duration = 2\n{LINE}\nspeed = {{ {speed} }}");
    let path = |path: &str| format!("duration = 2\npath = {{ {path} }}");
    let square = "points = [[0, 0], [1, 0], [1, 1], [0, 1]]";
    let cases: &[(String, &[&str])] = &[
        (
            speed("distances = [[0, 0], [2, 1]], repair = \"mono\""),
            &["motion.speed.repair", "`mono`", "monotone"],
        ),
        (
            speed("speeds = [[0, 1], [2, 1]], between = \"cubic\""),
            &["motion.speed.between", "`cubic`", "smooth"],
        ),
        (speed("ease = \"\""), &["motion.speed.ease", "cannot be ``"]),
        (
            speed("ease = \"steps(4)\", count = 3"),
            &["motion.speed.count", "brackets"],
        ),
        (
            speed("speeds = [[0, 0], [2, 0]]"),
            &["no free key has a speed", "cannot be met; no free key"],
        ),
        (
            speed("accelerations = [[0, 0], [2, 0]]"),
            &["an acceleration that could be scaled"],
        ),
        (
            speed("distances = [[0, 0], [2, \"x\"]]"),
            &["motion.speed.distances.1.1", "a share such as"],
        ),
        (
            speed("distances = [[0, 0], [2, 1], [1, 3]]"),
            &["the time of key 2 is 1, not greater than the one before it, 2"],
        ),
        (
            path(&format!("kind = \"lagrange\", closed = true, {square}")),
            &["motion.path.closed", "cannot be closed"],
        ),
        (
            path(&format!(
                "kind = \"b-spline\", closed = true, {square}, knots = [0, 1, 2, 3, 4, 5, 6, 7]"
            )),
            &[
                "motion.path.knots",
                "closed B-spline curve does not read knots",
            ],
        ),
        (
            path(&format!(
                "kind = \"b-spline\", {square}, knots = [0, 0, 0, 2, 1, 3, 3, 3]"
            )),
            &[
                "motion.path.knots",
                "less than the one before it, 2",
                "sort them",
            ],
        ),
        (
            path(&format!(
                "kind = \"tension-continuity-bias\", closed = true, {square}, times = [0, 1, 2, 3]"
            )),
            &[
                "motion.path.times",
                "there are 4 times, but 4 points and the return to the first need 5",
            ],
        ),
        (
            format!("duration = 2\n{LINE}\norientation = \"banking\""),
            &["motion.orientation", "banking = true"],
        ),
        (
            format!("duration = 2\n{LINE}\norientation = {{ kind = \"banking\", gain = 2 }}"),
            &["motion.orientation.kind", "banking = true"],
        ),
        (
            format!("duration = 1e300\n{LINE}"),
            &["the duration is 1e300 seconds"],
        ),
        (
            path(
                "kind = \"catmull-rom\", points = [[0, 0], [1, 1]], spacing = 0.123456789012345e301",
            ),
            &["1.23457e300"],
        ),
    ];
    for (inside, says) in cases {
        let folder = with(inside);
        let run = folder
            .run(&["motion", "m.toml", "-o", "m.csv"])
            .failed(1, says);
        assert!(!run.err.contains("model's bounds"), "{}", run.err);
        assert!(!run.err.contains("unknown key"), "{}", run.err);
        assert!(
            !run.err.contains("()") && !run.err.contains("a acceleration"),
            "{}",
            run.err
        );
    }
    let folder = Folder::new();
    let tumble = std::fs::read_to_string(repository("docs/recipes/tumble.toml")).unwrap();
    folder.put("m.toml", tumble);
    folder
        .run(&["motion", "m.toml", "-o", "m.csv", "--duration", "1"])
        .failed(
            1,
            &["key 2 of the orientation, at 1.2, is later than the end of the motion, 1"],
        );
}
