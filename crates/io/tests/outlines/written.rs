//! What is written, read again.

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_io::outlines::{
    Animation, Contour, Drawing, MeshFrames, Part, Repeat, Rounding, Rule, Segment, mix_fill, read,
    write_svg,
};
use anamorph_io::{Points, ReadOptions, read as read_model};
use serde_json::Value;

const RED: [f64; 4] = [1.0, 0.0, 0.0, 1.0];
const BLUE: [f64; 4] = [0.0, 0.0, 1.0, 0.5];

/// A square with a hole and a leaf of two curves, at a time from 0 to 1.
fn scene(t: f64) -> Drawing {
    let square = |low: f64, high: f64| {
        [[low, low], [high, low], [high, high], [low, high]].map(|[x, y]| dvec2(x + 8.0 * t, y))
    };
    let mut frame = Part::of_rings(
        "frame",
        mix_fill(Some(RED), Some(BLUE), t),
        [
            square(2.0, 18.0).to_vec(),
            square(6.0, 12.0 + t / 3.0).to_vec(),
        ],
    );
    frame.id = Some("a<b>".to_owned());
    frame.rule = Rule::EvenOdd;
    let leaf = Contour {
        start: dvec2(20.0, 30.0),
        segments: vec![
            Segment::Quadratic([dvec2(30.0, 20.0 + 3.0 * t), dvec2(36.0, 30.0)]),
            Segment::Cubic([dvec2(33.0, 36.0), dvec2(24.0, 36.0 - t), dvec2(20.0, 30.0)]),
        ],
        closed: true,
    };
    let leaf = Part {
        name: "leaf".to_owned(),
        fill: Some([0.2, 0.6, 0.4, 1.0]),
        contours: vec![leaf],
        ..Part::default()
    };
    Drawing {
        name: Some("a & b".to_owned()),
        parts: vec![frame, leaf],
        canvas: Some([0.0, 0.0, 40.0, 40.0]),
        y_down: true,
        ..Drawing::default()
    }
}

fn frames() -> Vec<Drawing> {
    [0.0, 0.5, 1.0].map(scene).to_vec()
}

fn text(write: impl FnOnce(&mut Vec<u8>)) -> String {
    let mut out = Vec::new();
    write(&mut out);
    String::from_utf8(out).unwrap()
}

fn snapshot(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("stored");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, text));
}

fn near(a: &Drawing, b: &Drawing, tolerance: f64) {
    let (a, b): (Vec<DVec2>, Vec<DVec2>) = (a.points().collect(), b.points().collect());
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(&b) {
        assert!(a.distance(*b) <= tolerance, "{a} {b}");
    }
}

#[test]
fn an_animated_svg_shows_its_frames() {
    let frames = frames();
    let mut animation = Animation::new(&frames, 2.0);
    animation.repeat = Repeat::Times(3);
    let svg = text(|out| animation.write_svg(out).unwrap());
    snapshot("animated-svg", &svg);
    // Without animation it is the first frame. 32-bit numbers on the way keep 1e-5 here.
    let still = read(svg.as_bytes()).unwrap();
    near(&still, &frames[0], 1e-5);
    assert_eq!(still.parts[0].id.as_deref(), Some("a<b>"));
    assert_eq!(still.parts[0].fill, Some(RED));
    assert_eq!(still.parts[0].rule, Rule::EvenOdd);
    assert_eq!(still.name, frames[0].name);

    // Each value is path data of its own, the last one twice.
    let attribute = |text: &str, name: &str| {
        let from = text.find(&format!(" {name}=\"")).unwrap() + name.len() + 3;
        text[from..].split('"').next().unwrap().to_owned()
    };
    let animate = svg.split("<animate ").nth(1).unwrap();
    let values = attribute(&format!(" {animate}"), "values");
    let values: Vec<&str> = values.split(';').collect();
    assert_eq!((values.len(), values[2]), (4, values[3]));
    for (value, frame) in values.iter().zip(&frames) {
        let one = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 40 40\"><path d=\"{value}\"/></svg>"
        );
        let read = read(one.as_bytes()).unwrap();
        let mut part = frame.clone();
        part.parts.truncate(1);
        near(&read, &part, 1e-5);
    }
    // Three frames at two a second.
    assert_eq!(attribute(&format!(" {animate}"), "dur"), "1.5s");
    assert!(svg.contains("repeatCount=\"3\" fill=\"freeze\""));
}

#[test]
fn frames_of_other_segments_are_shown_one_by_one() {
    let mut frames = frames();
    frames[1].parts[0].contours.pop();
    frames[2].parts[0].contours.clear();
    let svg = text(|out| Animation::new(&frames, 1.0).write_svg(out).unwrap());
    assert!(svg.contains("repeatCount=\"indefinite\" calcMode=\"discrete\" values=\"M2 2"));
    assert!(svg.contains(";M0 0\"/>"), "{svg}");
    let lottie = text(|out| Animation::new(&frames, 1.0).write_lottie(out).unwrap());
    let value: Value = serde_json::from_str(&lottie).unwrap();
    let hole = &value["layers"][1]["shapes"][0]["it"][1]["ks"]["k"];
    assert_eq!(hole[0]["h"], 1);
    assert_eq!(hole[1]["s"][0]["v"], serde_json::json!([[0, 0]]));
}

#[test]
fn a_plain_svg_is_read_back() {
    let mut up = scene(0.25).turned(false);
    let stroke = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 9 9\"><path d=\"M1 1L8 1L4 7\" fill=\"none\" \
        stroke=\"#00ff00\" stroke-opacity=\"0.5\" stroke-width=\"0.25\" stroke-linecap=\"round\" stroke-linejoin=\"bevel\" \
        stroke-dasharray=\"1 2\"/></svg>";
    let stroke = read(stroke.as_bytes()).unwrap().turned(false);
    up.parts.extend(stroke.parts);
    let svg = text(|out| write_svg(&up, None, out).unwrap());
    assert!(!svg.contains("animate"), "{svg}");
    let read = read(svg.as_bytes()).unwrap();
    near(&read, &up.turned(true), 1e-4);
    assert_eq!(read.canvas, Some([0.0, 0.0, 40.0, 40.0]));
    let (one, other) = (&read.parts[2], &up.parts[2]);
    assert_eq!((&one.stroke, one.fill), (&other.stroke, None));
    assert!(!one.contours[0].closed);
}

/// Whether a value is a list of `count` pairs of numbers.
fn pairs(value: &Value, count: usize) -> bool {
    let list = value.as_array().unwrap();
    let pair = |pair: &Value| {
        pair.as_array()
            .is_some_and(|p| p.len() == 2 && p.iter().all(Value::is_number))
    };
    list.len() == count && list.iter().all(pair)
}

#[test]
fn a_lottie_has_the_published_structure() {
    let frames = frames();
    let lottie = text(|out| Animation::new(&frames, 30.0).write_lottie(out).unwrap());
    snapshot("lottie", &lottie);
    let all: Value = serde_json::from_str(&lottie).unwrap();
    for (key, expected) in [
        ("fr", 30),
        ("ip", 0),
        ("op", 3),
        ("w", 512),
        ("h", 512),
        ("ddd", 0),
    ] {
        assert_eq!(all[key], expected, "{key}");
    }
    assert!(all["v"].as_str().unwrap().starts_with("5.7"));
    let layers = all["layers"].as_array().unwrap();
    let names: Vec<&str> = layers
        .iter()
        .map(|layer| layer["nm"].as_str().unwrap())
        .collect();
    // The topmost first.
    assert_eq!(names, ["leaf", "frame"]);
    for (i, layer) in layers.iter().enumerate() {
        assert_eq!(
            (&layer["ty"], &layer["ind"]),
            (&Value::from(4), &Value::from(i + 1))
        );
        assert_eq!(
            (&layer["ip"], &layer["op"], &layer["st"]),
            (&Value::from(0), &Value::from(3), &Value::from(0))
        );
        for key in ["o", "r", "p", "a", "s"] {
            assert_eq!(layer["ks"][key]["a"], 0, "{key}");
        }
        let group = &layer["shapes"][0];
        let items = group["it"].as_array().unwrap();
        assert_eq!(items.last().unwrap()["ty"], "tr");
        assert_eq!(group["np"], items.len());
        let part = &frames[0].parts[1 - i];
        let paths: Vec<&Value> = items.iter().filter(|item| item["ty"] == "sh").collect();
        assert_eq!(paths.len(), part.contours.len());
        for (k, path) in paths.iter().enumerate() {
            let keys = path["ks"]["k"].as_array().unwrap();
            assert_eq!((path["ks"]["a"].as_u64(), keys.len()), (Some(1), 3));
            for (t, key) in keys.iter().enumerate() {
                assert_eq!(key["t"], t);
                let shape = &key["s"][0];
                let contour = &frames[t].parts[1 - i].contours[k];
                let count = contour.flatten(f64::INFINITY).len();
                assert!(
                    ["v", "i", "o"]
                        .iter()
                        .all(|list| pairs(&shape[list], count))
                );
                assert_eq!(shape["c"], true);
                // The curve between two vertices is that of the drawing.
                let point = |list: &str, n: usize| {
                    let n = n % count;
                    dvec2(
                        shape[list][n][0].as_f64().unwrap(),
                        shape[list][n][1].as_f64().unwrap(),
                    )
                };
                let mut from = contour.start;
                for (n, segment) in contour.segments.iter().enumerate() {
                    let middle = match segment {
                        Segment::Line(end) => (from + *end) * 0.5,
                        Segment::Quadratic([a, end]) => (from + 2.0 * *a + *end) * 0.25,
                        Segment::Cubic([a, b, end]) => (from + 3.0 * (*a + *b) + *end) * 0.125,
                    };
                    let (a, b) = (point("v", n), point("v", n + 1));
                    let (out, into) = (point("o", n), point("i", n + 1));
                    let own = (a + 3.0 * (a + out + b + into) + b) * 0.125;
                    assert!(own.distance(middle) < 1e-5, "{own} {middle}");
                    from = segment.end();
                }
                let last = t + 1 == keys.len();
                assert_eq!(key.get("i").is_some() && key.get("o").is_some(), !last);
            }
        }
        let fill = items.iter().find(|item| item["ty"] == "fl").unwrap();
        assert_eq!(fill["r"], if i == 0 { 1 } else { 2 });
        assert_eq!(fill["c"]["a"], i);
    }
    let fill = &layers[1]["shapes"][0]["it"][2];
    assert_eq!(fill["c"]["k"][0]["s"], serde_json::json!([1, 0, 0, 1]));
    assert_eq!(fill["o"]["k"][2]["s"], serde_json::json!([50]));
}

#[test]
fn what_is_no_animation_is_refused() {
    let mut frames = frames();
    let refused = |frames: &[Drawing], rate: f64| {
        let mut out = Vec::new();
        let animation = Animation::new(frames, rate);
        let error = animation.write_svg(&mut out).unwrap_err();
        assert!(animation.write_lottie(&mut out).is_err() && out.is_empty());
        error.to_string()
    };
    assert!(refused(&[], 1.0).contains("no frame"));
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(refused(&frames, rate).contains("frames a second"));
    }
    frames[1].parts[0].contours[0].start.x = f64::NAN;
    assert!(refused(&frames, 1.0).contains("frame 2 is not finite"));
    frames[1].parts.pop();
    assert!(refused(&frames, 1.0).contains("1 parts, and the first has 2"));
}

fn square(t: f64) -> Vec<DVec2> {
    [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0], [9.0, 9.0]]
        .map(|[x, y]| dvec2(x + t, y + t * t / 3.0))
        .to_vec()
}

#[test]
fn meshes_are_read_back_from_obj_and_glb() {
    let frames = [0.0, 0.5, 1.0].map(square);
    // Wound clockwise as seen with y upwards.
    let triangles = [[0, 2, 1], [0, 3, 2]];
    for y_down in [false, true] {
        let mesh = MeshFrames {
            triangles: &triangles,
            frames: &frames,
            textures: None,
            y_down,
            fill: Some(RED),
            rate: 4.0,
        };
        let mut obj = Vec::new();
        mesh.write_obj(2, Rounding::places(4), &mut obj).unwrap();
        let text = String::from_utf8(obj.clone()).unwrap();
        let model = read_model(obj, Some("a.obj"), &ReadOptions::default()).unwrap();
        let Points::Solid(points) = model.points() else {
            panic!("{text}")
        };
        assert_eq!(points.len(), 5);
        let sign = if y_down { -1.0 } else { 1.0 };
        for (point, place) in points.iter().zip(&frames[2]) {
            assert!((point.truncate() - dvec2(place.x, sign * place.y)).length() < 1e-4);
            assert_eq!(point.z, 0.0);
        }
        let faces = model.mesh().unwrap().triangles;
        assert_eq!(faces.len(), 2);
        for [a, b, c] in faces {
            let [a, b, c] = [a, b, c].map(|i| points[i as usize].truncate());
            assert!((b - a).perp_dot(c - a) > 0.0, "{text}");
        }
        assert!(text.contains("vt "), "{text}");

        let mut glb = Vec::new();
        let mut storage = std::io::Cursor::new(Vec::new());
        let report = mesh.write_glb(&mut storage, &mut glb).unwrap();
        assert_eq!((report.targets, report.nodes), (2, 1));
        let file = gltf::Gltf::from_slice(&glb).unwrap();
        let blob = file.blob.as_deref().unwrap();
        let primitive = file.meshes().next().unwrap().primitives().next().unwrap();
        let reader = primitive.reader(|_| Some(blob));
        let base: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
        // The loose point is left out.
        assert_eq!(base.len(), 4);
        assert!(reader.read_tex_coords(0).is_some() && reader.read_colors(0).is_some());
        let last = reader.read_morph_targets().last().unwrap().0.unwrap();
        for (base, moved) in base.iter().zip(last) {
            let there = [base[0] + moved[0], sign as f32 * (base[1] + moved[1])];
            let found = frames[2].iter().any(|p| {
                (p.x as f32 - there[0]).abs() < 1e-5 && (p.y as f32 - there[1]).abs() < 1e-5
            });
            assert!(found, "{there:?}");
        }
        let animation = file.animations().next().unwrap();
        let channel = animation.channels().next().unwrap();
        let times = channel.reader(|_| Some(blob)).read_inputs().unwrap();
        assert_eq!(times.collect::<Vec<f32>>(), [0.0, 0.25, 0.5]);
    }
}

#[test]
fn meshes_that_do_not_fit_are_refused() {
    let mesh = |triangles: &[[u32; 3]], frames: &[Vec<DVec2>], rate: f64| {
        let mesh = MeshFrames {
            triangles,
            frames,
            textures: None,
            y_down: false,
            fill: None,
            rate,
        };
        let mut out = Vec::new();
        let error = mesh
            .write_obj(0, Rounding::places(4), &mut out)
            .unwrap_err();
        assert!(out.is_empty());
        error.to_string()
    };
    assert!(mesh(&[[0, 1, 2]], &[], 1.0).contains("no frame"));
    assert!(mesh(&[[0, 1, 5]], &[square(0.0)], 1.0).contains("point 5 of 5"));
    let short = square(0.0)[..4].to_vec();
    assert!(mesh(&[[0, 1, 2]], &[square(0.0), short], 1.0).contains("5 points"));
    assert!(mesh(&[[0, 1, 2]], &[square(f64::NAN)], 1.0).contains("not finite"));
    assert!(mesh(&[[0, 1, 2]], &[square(0.0)], 0.0).contains("frames a second"));
}
