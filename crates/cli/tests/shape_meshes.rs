//! `anamorph mesh`: pairs of meshes, their pictures, and morphs between them.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_io::outlines::{self, Pair, PairRing};
use common::Folder;

const BAR: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><path id="body" fill="#d02020" d="M10 40H90V60H10Z"/>
 <circle cx="30" cy="20" r="8" fill="#20a020"/></svg>"##;
const BENT: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 200 200"><path id="body" fill="#2040d0" d="M20 80H120V180H80V120H20Z"/></svg>"##;
const RING: &str = r#"{"y_axis": "up", "canvas": [0, 0, 100, 100], "polygons": [{"outer": [[10, 10], [90, 10], [90, 90], [10, 90]],
 "holes": [[[40, 40], [40, 60], [60, 60], [60, 40]]]}]}"#;

fn folder() -> Folder {
    let folder = Folder::new();
    folder
        .put("bar.svg", BAR)
        .put("bent.svg", BENT)
        .put("ring.json", RING);
    folder
}

fn twice_area(points: &[DVec2], [a, b, c]: [u32; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(|i| points[i as usize]);
    (b - a).perp_dot(c - a)
}

#[test]
fn a_pair_holds_both_shapes_by_the_same_triangles() {
    let folder = folder();
    let run = folder
        .run(&["mesh", "bar.svg", "bent.svg", "-o", "pair.json", "--json"])
        .done();
    let pair = Pair::read(&folder.read("pair.json")).unwrap();
    assert!(pair.y_down && pair.canvas == Some([0.0, 0.0, 100.0, 100.0]));
    // The bar goes with the bent one by its id; the disc has no partner and merges into it.
    assert_eq!(pair.parts.len(), 2);
    assert_eq!(pair.parts[0].name, "body");
    let report = run.json();
    assert_eq!(report["mesh"]["triangles"], pair.triangles.len());
    assert_eq!(report["parts"][0]["mesh"]["points"], pair.parts[0].points);
    assert!(report["mesh"]["smallest_angle_source"].as_f64().unwrap() > 3.0);
    // Every triangle is positive, and together they cover what was given.
    let slice = pair.split().next().unwrap();
    for points in [&pair.source, &pair.target] {
        let areas = slice.triangles.iter().map(|t| twice_area(points, *t));
        assert!(areas.clone().all(|area| area > 0.0));
        let covered = 0.5 * areas.sum::<f64>();
        assert!((covered - 1600.0).abs() < 1e-3, "{covered}");
    }
    // Rings are chains of edges with triangles on one side.
    let edges: std::collections::HashSet<[u32; 2]> = pair
        .triangles
        .iter()
        .flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]])
        .collect();
    for ring in &pair.rings {
        for (i, a) in ring.points.iter().enumerate() {
            let b = ring.points[(i + 1) % ring.points.len()];
            assert!(edges.contains(&[*a, b]) && !edges.contains(&[b, *a]));
        }
    }
}

#[test]
fn anchors_are_named() {
    let folder = folder();
    folder.put("anchors.toml", "[[anchor]]\nsource = 1\ntarget = 2\n");
    let arguments = [
        "mesh",
        "bar.svg",
        "bent.svg",
        "-o",
        "pair.json",
        "--anchors",
        "anchors.toml",
    ];
    folder.run(&arguments).done();
    let pair = Pair::read(&folder.read("pair.json")).unwrap();
    let places: Vec<(DVec2, DVec2)> = pair
        .anchors
        .iter()
        .map(|i| (pair.source[*i as usize], pair.target[*i as usize]))
        .collect();
    // A corner of the bar goes to a corner of the bent one, on half of its size.
    let corners =
        [[10.0, 40.0], [90.0, 40.0], [90.0, 60.0], [10.0, 60.0]].map(|[x, y]| dvec2(x, y));
    let bent = [[10, 40], [60, 40], [60, 90], [40, 90], [40, 60], [10, 60]];
    let bent = bent.map(|[x, y]| dvec2(f64::from(x), f64::from(y)));
    assert_eq!(places.len(), 1);
    let near = |list: &[DVec2], p: DVec2| list.iter().any(|q| q.distance(p) < 1e-6);
    assert!(
        places
            .iter()
            .any(|(p, q)| near(&corners, *p) && near(&bent, *q)),
        "{places:?}"
    );
}

#[test]
fn morphs_of_a_pair_are_those_of_its_shapes() {
    let folder = folder();
    folder
        .run(&["mesh", "bar.svg", "bent.svg", "-o", "pair.json"])
        .done();
    for at in ["0", "0.4", "1"] {
        let morph = |inputs: &[&str], out: &str| -> Vec<DVec2> {
            let mut all = vec!["morph"];
            all.extend(inputs);
            all.extend(["-o", out, "--at", at]);
            folder.run(&all).done();
            let drawing = outlines::read(&folder.read(out)).unwrap();
            assert_eq!(drawing.canvas, Some([0.0, 0.0, 100.0, 100.0]));
            drawing.points().collect()
        };
        let direct = morph(&["bar.svg", "bent.svg"], &format!("a{at}.json"));
        let by_pair = morph(&["pair.json"], &format!("b{at}.json"));
        assert_eq!(direct, by_pair, "{at}");
    }
    for out in ["pair.svg", "pair.png"] {
        folder
            .run(&["mesh", "pair.json", "-o", out, "--size", "300"])
            .done();
    }
    let svg = String::from_utf8(folder.read("pair.svg")).unwrap();
    let pair = Pair::read(&folder.read("pair.json")).unwrap();
    // Inner edges once on each side, and the outlines.
    let border: usize = pair.rings.iter().map(|ring| ring.points.len()).sum();
    let inner = (3 * pair.triangles.len() - border) / 2;
    let lines = svg.matches("<polyline").count();
    assert!(lines >= 2 * (inner + pair.rings.len()) && lines <= 2 * (inner + border));
}

/// A square of two triangles, hand-made: y up, one triangle the other way round, no rings.
fn by_hand() -> Pair {
    let square = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]].map(|[x, y]| dvec2(x, y));
    let turned = square.map(|p| dvec2(-p.y, 2.0 * p.x));
    Pair {
        source: square.to_vec(),
        target: turned.to_vec(),
        triangles: vec![[0, 1, 2], [0, 3, 2]],
        ..Pair::default()
    }
}

#[test]
fn meshes_made_by_hand_are_morphed() {
    let folder = Folder::new();
    let mut file = Vec::new();
    by_hand().write(&mut file).unwrap();
    folder.put("hand.json", &file);
    folder
        .run(&["morph", "hand.json", "-o", "half.json", "--at", "0.5"])
        .done();
    let drawing = outlines::read(&folder.read("half.json")).unwrap();
    let points: Vec<DVec2> = drawing.points().collect();
    assert_eq!(points.len(), 4);
    // Half way to twice as long.
    let mut sides: Vec<f64> = (0..4)
        .map(|i| points[i].distance(points[(i + 1) % 4]))
        .collect();
    sides.sort_by(f64::total_cmp);
    for (side, wanted) in sides.iter().zip([10.0, 10.0, 15.0, 15.0]) {
        assert!((side - wanted).abs() < 1e-3, "{sides:?}");
    }
    // Two parts that nothing connects, with rings, stay two.
    let mut two = by_hand();
    let one = two.clone();
    two.source
        .extend(one.source.iter().map(|p| *p + dvec2(5.0, 5.0)));
    two.target
        .extend(one.target.iter().map(|p| *p + dvec2(5.0, 5.0)));
    two.triangles.extend([[4, 5, 6], [4, 6, 7]]);
    two.rings = vec![
        PairRing {
            points: vec![3, 2, 1, 0],
            hole: false,
        },
        PairRing {
            points: vec![4, 5, 6, 7],
            hole: false,
        },
    ];
    let mut file = Vec::new();
    two.write(&mut file).unwrap();
    folder.put("two.json", &file);
    folder
        .run(&["morph", "two.json", "-o", "two.%d.json", "--frames", "2"])
        .done();
    let drawing = outlines::read(&folder.read("two.1.json")).unwrap();
    assert_eq!(drawing.parts.len(), 2);
    folder
        .run(&["mesh", "two.json", "-o", "two.svg", "--json"])
        .done();
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = folder();
    let mut turned = by_hand();
    turned.target.swap(0, 2);
    turned.target[1] = dvec2(30.0, 30.0);
    let mut file = Vec::new();
    turned.write(&mut file).unwrap();
    folder.put("turned.json", &file);
    folder.put(
        "empty.json",
        r#"{"format": "anamorph-pair", "version": 1, "y_axis": "up", "source": {"points": []}, "target": {"points": []},
 "rings": [], "triangles": []}"#,
    );
    folder.put("cut.json", r#"{"format": "anamorph-pair", "version": 1"#);
    for (arguments, says) in [
        (&["mesh", "bar.svg", "-o", "x.json"][..], "two or more"),
        (&["mesh", "bar.svg", "bent.svg", "-o", "x.obj"], "x.obj"),
        (
            &["mesh", "bar.svg", "bent.svg", "-o", "bar.svg", "-f"],
            "replace",
        ),
        (
            &["mesh", "bar.svg", "bent.svg", "-o", "-", "--json"],
            "--json",
        ),
        (&["morph", "turned.json", "-o", "x.svg"], "turned"),
        (&["morph", "empty.json", "-o", "x.svg"], "no triangle"),
        (&["morph", "cut.json", "-o", "x.svg"], "cut.json"),
        (&["morph", "turned.json", "bar.svg", "-o", "x.svg"], "alone"),
        (
            &["morph", "turned.json", "-o", "x.svg", "--pieces", "grow"],
            "--pieces",
        ),
        (&["morph", "bar.svg", "-o", "x.svg"], "two or more"),
        (&["morph", "x.png", "-o", "y.png"], "x.png: cannot read"),
    ] {
        let run = folder.run(arguments);
        assert_ne!(run.code, 0, "{arguments:?}");
        assert!(run.err.contains(says), "{arguments:?}: {}", run.err);
        assert!(!folder.path().join("x.svg").exists() && !folder.path().join("x.json").exists());
    }
    // The pair on standard output.
    let run = folder
        .run(&["mesh", "ring.json", "bent.svg", "-o", "-"])
        .done();
    let pair = Pair::read(&run.out).unwrap();
    assert_eq!(pair.rings.iter().filter(|ring| ring.hole).count(), 1);
}

#[test]
fn damaged_shapes_end_with_a_message_or_a_result() {
    let folder = folder();
    let mut results = 0;
    for name in common::listed("tests/fixtures/damaged", "") {
        if !(name.starts_with("svg-") || name.starts_with("polygon-")) {
            continue;
        }
        folder.put(&name, common::fixture(&format!("damaged/{name}")));
        for arguments in [
            &["morph", &name, &name, "-o", "x.svg", "--frames", "3", "-f"][..],
            &[
                "morph", &name, "bar.svg", "-o", "x.svg", "--frames", "3", "-f",
            ],
            &["mesh", &name, &name, "-o", "x.json", "-f"],
        ] {
            let start = std::time::Instant::now();
            let run = folder.run(arguments);
            assert!(start.elapsed().as_secs() < 10, "{arguments:?}");
            match run.code {
                0 => results += 1,
                code => assert!(code == 1 && run.err.contains(&name), "{run:?}"),
            }
        }
    }
    assert!(results >= 10, "{results}");
}
