//! Recipes over time as one GLB with morph targets, read by another reader and compared with numbered files.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::{EMPTY, Folder, TWIST};
use gltf::animation::util::ReadOutputs;
use std::collections::HashMap;

/// Numbers of a vertex.
type Three = [f64; 3];

/// A primitive's positions or normals, and what each target adds to them.
struct Shape {
    base: Vec<Three>,
    targets: Vec<Vec<Three>>,
}

/// A node whose weights are animated: its primitives, and the weights at each key.
struct Moving {
    node: usize,
    positions: Vec<Shape>,
    normals: Vec<Shape>,
    weights: Vec<Vec<f64>>,
}

struct Film {
    times: Vec<f64>,
    nodes: Vec<Moving>,
    file: gltf::Gltf,
}

/// The JSON of a GLB.
fn json_of(glb: &[u8]) -> serde_json::Value {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&glb[20..20 + length]).unwrap()
}

fn wide(list: impl Iterator<Item = [f32; 3]>) -> Vec<Three> {
    list.map(|p| p.map(f64::from)).collect()
}

impl Film {
    fn read(folder: &Folder, name: &str) -> Self {
        let file = gltf::Gltf::from_slice(&folder.read(name)).unwrap();
        let blob = file.blob.clone().unwrap();
        let data = |_: gltf::Buffer<'_>| Some(&blob[..]);
        let animation = file.animations().last().unwrap();
        let text = json_of(&folder.read(name));
        let named = text["animations"].as_array().unwrap().last().unwrap();
        assert_eq!(named["name"], "warp");
        let (mut times, mut nodes) = (Vec::new(), Vec::new());
        for channel in animation.channels() {
            assert_eq!(
                channel.sampler().interpolation(),
                gltf::animation::Interpolation::Linear
            );
            let reader = channel.reader(data);
            times = reader.read_inputs().unwrap().map(f64::from).collect();
            let input = channel.sampler().input();
            let bound = |b: Option<gltf::json::Value>| b.unwrap()[0].as_f64().unwrap() as f32;
            assert_eq!(bound(input.min()), times[0] as f32);
            assert_eq!(bound(input.max()), *times.last().unwrap() as f32);
            let Some(ReadOutputs::MorphTargetWeights(weights)) = reader.read_outputs() else {
                panic!("no weights");
            };
            let weights: Vec<f64> = weights.into_f32().map(f64::from).collect();
            let node = channel.target().node();
            let mesh = node.mesh().unwrap();
            let (mut positions, mut normals) = (Vec::new(), Vec::new());
            let count = mesh.weights().unwrap().len();
            for primitive in mesh.primitives() {
                assert_eq!(primitive.morph_targets().len(), count);
                let reader = primitive.reader(data);
                let mut of_positions = Vec::new();
                let mut of_normals = Vec::new();
                let moved = primitive.morph_targets().zip(reader.read_morph_targets());
                for (target, (offsets, turns, _)) in moved {
                    let offsets = wide(offsets.unwrap());
                    // The bounds are those of the numbers.
                    let accessor = target.positions().unwrap();
                    for axis in 0..3 {
                        let axis_of = offsets.iter().map(|offset| offset[axis]);
                        let low = axis_of.clone().fold(f64::INFINITY, f64::min);
                        let high = axis_of.fold(f64::NEG_INFINITY, f64::max);
                        // The reader of JSON may be off by the last place of 64 bits.
                        let bound = |b: Option<gltf::json::Value>| {
                            b.unwrap()[axis].as_f64().unwrap() as f32
                        };
                        assert_eq!(bound(accessor.min()), low as f32);
                        assert_eq!(bound(accessor.max()), high as f32);
                    }
                    of_positions.push(offsets);
                    of_normals.extend(turns.map(wide));
                }
                positions.push(Shape {
                    base: wide(reader.read_positions().unwrap()),
                    targets: of_positions,
                });
                if let Some(base) = reader.read_normals() {
                    normals.push(Shape {
                        base: wide(base),
                        targets: of_normals,
                    });
                }
            }
            assert_eq!(weights.len(), times.len() * count);
            // The mesh shows the first frame where nothing plays.
            let first: Vec<f64> = mesh
                .weights()
                .unwrap()
                .iter()
                .map(|w| f64::from(*w))
                .collect();
            assert_eq!(first, weights[..count]);
            nodes.push(Moving {
                node: node.index(),
                positions,
                normals,
                weights: weights.chunks_exact(count).map(<[f64]>::to_vec).collect(),
            });
        }
        Self { times, nodes, file }
    }
}

impl Moving {
    /// The weights between a key and the next.
    fn weights(&self, key: usize, share: f64) -> Vec<f64> {
        let before = &self.weights[key];
        let after = self.weights.get(key + 1).unwrap_or(before);
        let pairs = before.iter().zip(after);
        pairs.map(|(a, b)| a + share * (b - a)).collect()
    }
}

impl Shape {
    fn at(&self, weights: &[f64]) -> Vec<Three> {
        let mut all = self.base.clone();
        for (target, weight) in self.targets.iter().zip(weights) {
            for (place, offset) in all.iter_mut().zip(target) {
                for axis in 0..3 {
                    place[axis] += weight * offset[axis];
                }
            }
        }
        all
    }
}

fn vertices(folder: &Folder, name: &str) -> Vec<Three> {
    let text = String::from_utf8(folder.read(name)).unwrap();
    let lines = text.lines().filter_map(|line| line.strip_prefix("v "));
    lines
        .map(|line| {
            let mut numbers = line.split_whitespace().map(|n| n.parse().unwrap());
            [(); 3].map(|()| numbers.next().unwrap())
        })
        .collect()
}

fn distance(a: &Three, b: &Three) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f64>().sqrt()
}

fn farthest(a: &[Three], b: &[Three]) -> f64 {
    assert_eq!(a.len(), b.len());
    let apart = a.iter().zip(b).map(|(a, b)| distance(a, b));
    apart.fold(0.0, f64::max)
}

/// The vertex of an OBJ that each vertex of the file comes from, found by its place.
fn sources(file: &[Three], model: &[Three]) -> Vec<usize> {
    let key = |p: &Three| p.map(|x| (x as f32 + 0.0).to_bits());
    let places: HashMap<[u32; 3], usize> =
        model.iter().enumerate().map(|(i, p)| (key(p), i)).collect();
    assert_eq!(places.len(), model.len(), "places are not told apart");
    file.iter().map(|p| places[&key(p)]).collect()
}

fn warp(folder: &Folder, arguments: &[&str]) -> common::Run {
    folder.run(&[&["warp"], arguments].concat())
}

#[test]
fn keys_are_the_numbered_frames_and_the_stated_error_is_attained() {
    let lumps = "version = 1\n[[warp]]\nkind = \"points\"\nradius = \"25%\"\nschedule = { start = 0.2, ease = \"sine-in-out\" }\n\
        point = [{ from = [\"50%\", \"90%\", \"60%\"], by = [0, \"20%\", 0] }]\n";
    let folder = Folder::with(
        "valid/spot.obj",
        &[("twist.toml", TWIST), ("lumps.toml", lumps)],
    );
    let model = vertices(&folder, "spot.obj");
    for recipe in ["twist", "lumps"] {
        let path = format!("{recipe}.toml");
        let base = ["spot.obj", "-r", &path, "--force"];
        let one = [
            "--frames", "5", "--fps", "10", "-o", "out.glb", "--report", "r.json",
        ];
        let said = warp(&folder, &[&base[..], &one].concat()).done().err;
        assert!(said.contains("between frames the file is up to"), "{said}");
        assert!(said.contains("5 frames in 0.4 seconds"), "{said}");
        // Seventeen frames: those five, and a quarter, half and three quarters between each two.
        let many = ["--frames", "17", "-o", "n.%02d.obj"];
        warp(&folder, &[&base[..], &many].concat()).done();
        let film = Film::read(&folder, "out.glb");
        assert_eq!(film.times.len(), 5);
        for (key, time) in film.times.iter().enumerate() {
            assert_eq!(*time, f64::from(key as f32 / 10.0));
        }
        let [node] = &film.nodes[..] else {
            panic!("one node")
        };
        let shape = &node.positions[0];
        let sources = sources(&shape.base, &model);
        let used: std::collections::HashSet<usize> = sources.iter().copied().collect();
        assert_eq!(used.len(), model.len());
        let (mut between, mut at_frames) = (0.0_f64, 0.0_f64);
        for step in 0..17 {
            let (key, share) = (step / 4, f64::from(step as u32 % 4) / 4.0);
            let warped = vertices(&folder, &format!("n.{:02}.obj", step + 1));
            let warped: Vec<Three> = sources.iter().map(|i| warped[*i]).collect();
            let off = farthest(&shape.at(&node.weights(key, share)), &warped);
            if share == 0.0 {
                at_frames = at_frames.max(off);
            } else {
                between = between.max(off);
            }
        }
        let report = folder.json("r.json");
        let stated = |what: &str| report["error"][what]["distance"].as_f64().unwrap();
        assert!(at_frames < 2e-7, "{at_frames}");
        assert!((stated("at_frames") - at_frames).abs() < 1e-12, "{report}");
        assert!(between > 1e-3, "{between}");
        assert!(
            (stated("between_frames") - between).abs() < 1e-12,
            "{between}: {report}"
        );
        let relative = report["error"]["between_frames"]["relative"]
            .as_f64()
            .unwrap();
        let size = report["error"]["size"].as_f64().unwrap();
        assert!((relative * size - between).abs() < 1e-12);
        // The first frame shows the model as it is, and needs no target.
        let lone = recipe == "lumps";
        let targets = report["animation"]["targets"].as_u64().unwrap();
        assert_eq!(targets, 4, "{report}");
        let sparse = film
            .file
            .accessors()
            .filter(|a| a.sparse().is_some())
            .count() as u64;
        assert_eq!(report["animation"]["sparse"], sparse);
        assert_eq!(sparse, if lone { targets } else { 0 });
    }
}

/// The positions and normals of a node's mesh in a file without targets.
fn of_node(file: &gltf::Gltf, node: usize) -> (Vec<Vec<Three>>, Vec<Vec<Three>>) {
    let blob = file.blob.clone().unwrap();
    let mesh = file.nodes().nth(node).unwrap().mesh().unwrap();
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for primitive in mesh.primitives() {
        let reader = primitive.reader(|_| Some(&blob[..]));
        positions.push(wide(reader.read_positions().unwrap()));
        normals.extend(reader.read_normals().map(wide));
    }
    (positions, normals)
}

#[test]
fn scenes_keep_what_they_have_and_every_instance_moves_as_in_numbered_files() {
    let local = TWIST.replacen("version = 1", "version = 1\nspace = \"local\"", 1);
    for model in ["gltf-instances.glb", "gltf-interleaved.glb"] {
        for recipe in ["twist.toml", "local.toml"] {
            let folder = Folder::with(
                &format!("valid/{model}"),
                &[("twist.toml", TWIST), ("local.toml", &local)],
            );
            let base = [model, "-r", recipe, "--frames", "4"];
            warp(&folder, &[&base[..], &["-o", "out.glb"]].concat()).done();
            warp(&folder, &[&base[..], &["-o", "n.%d.glb"]].concat()).done();
            let film = Film::read(&folder, "out.glb");
            assert!(!film.nodes.is_empty());
            let before = gltf::Gltf::from_slice(&folder.read(model)).unwrap();
            for key in 0..4 {
                let name = format!("n.{}.glb", key + 1);
                let numbered = gltf::Gltf::from_slice(&folder.read(&name)).unwrap();
                let mut moving = 0;
                for node in &film.nodes {
                    let (places, directions) = of_node(&numbered, node.node);
                    for (shape, wanted) in node.positions.iter().zip(&places) {
                        let off = farthest(&shape.at(&node.weights(key, 0.0)), wanted);
                        assert!(off < 1e-6, "{model} {name}: {off}");
                    }
                    for (shape, wanted) in node.normals.iter().zip(&directions) {
                        let off = farthest(&shape.at(&node.weights(key, 0.0)), wanted);
                        assert!(off < 1e-6, "{model} {name}: normals {off}");
                    }
                    moving += 1;
                }
                // What has no weights does not move.
                for node in numbered.nodes().filter(|node| node.mesh().is_some()) {
                    if film.nodes.iter().all(|moving| moving.node != node.index()) {
                        assert_eq!(
                            of_node(&numbered, node.index()),
                            of_node(&before, node.index())
                        );
                        moving += 1;
                    }
                }
                assert_eq!(
                    moving,
                    before.nodes().filter(|n| n.mesh().is_some()).count()
                );
            }
            assert_eq!(film.file.materials().len(), before.materials().len());
            assert_eq!(film.file.images().len(), before.images().len());
            assert_eq!(film.file.animations().len(), before.animations().len() + 1);
            let [new, old] = ["out.glb", model].map(|name| json_of(&folder.read(name)));
            for key in ["scene", "scenes", "skins", "textures", "extensionsUsed"] {
                assert_eq!(new[key], old[key], "{key}");
            }
            let nodes = new["nodes"].as_array().unwrap();
            for (new, old) in nodes.iter().zip(old["nodes"].as_array().unwrap()) {
                let but = |node: &serde_json::Value| {
                    let mut node = node.clone();
                    node.as_object_mut().unwrap().remove("mesh");
                    node
                };
                assert_eq!(but(new), but(old));
            }
            // The mesh as it is, at weights of zero: to the bit.
            for node in &film.nodes {
                let (places, _) = of_node(&before, node.node);
                for (shape, old) in node.positions.iter().zip(&places) {
                    assert_eq!(shape.base, *old);
                }
            }
        }
    }
    // Other forms become a GLB, too, with one buffer more in it.
    for model in ["gltf-sparse.gltf", "gltf-quantized.glb"] {
        let folder = Folder::with(&format!("valid/{model}"), &[("twist.toml", TWIST)]);
        let base = [model, "-r", "twist.toml", "--frames", "3", "-o", "out.glb"];
        warp(&folder, &base).done();
        let said = folder.run(&["inspect", "out.glb", "--json"]).done().json();
        assert!(said.to_string().contains("out.glb"), "{said}");
    }
}

#[test]
fn frames_that_show_the_same_share_a_target_and_ranges_start_at_zero() {
    let held = "version = 1\n[[warp]]\nkind = \"twist\"\naxis = \"y\"\nangle = \"5deg\"\n\
        [[track]]\nset = \"warp.0.angle\"\nkeys = [[0, \"0deg\"], [0.5, \"60deg\"], [0.8, \"60deg\"], [1, \"0deg\"]]\n";
    let folder = Folder::with(
        "valid/spot.obj",
        &[("held.toml", held), ("empty.toml", EMPTY)],
    );
    let run = |more: &[&str]| {
        let base = [
            "spot.obj",
            "-r",
            "held.toml",
            "--frames",
            "11",
            "--report",
            "r.json",
        ];
        warp(&folder, &[&base[..], more].concat())
    };
    run(&["-o", "all.glb"]).done();
    let film = Film::read(&folder, "all.glb");
    // At rest, five on the way, which stay for three more, one on the way back, at rest.
    let rows = &film.nodes[0].weights;
    assert_eq!(rows[0], [0.0; 6]);
    assert_eq!(rows[10], [0.0; 6]);
    for row in &rows[5..9] {
        assert_eq!(row[..], [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    }
    run(&[
        "--start",
        "1001",
        "--range",
        "1004-1008",
        "--fps",
        "25",
        "-o",
        "some.glb",
        "--force",
    ])
    .done();
    let some = Film::read(&folder, "some.glb");
    assert_eq!(some.times.len(), 5);
    assert_eq!(some.times[0], 0.0);
    for (key, row) in rows[3..8].iter().enumerate() {
        let (a, b) = (&film.nodes[0], &some.nodes[0]);
        let off = farthest(&a.positions[0].at(row), &b.positions[0].at(&b.weights[key]));
        assert!(off == 0.0, "{key}: {off}");
    }
    let names = &json_of(&folder.read("some.glb"))["meshes"][0]["extras"]["targetNames"];
    assert_eq!(names[0], "frame 1004");
    let report = folder.json("r.json");
    assert_eq!(report["frames"]["first"], 1004);
    assert_eq!(report["frames"]["of"], 11);
    // A track without --frames does nothing, and the command says so.
    let said = warp(&folder, &["spot.obj", "-r", "held.toml", "-o", "still.obj"])
        .done()
        .err;
    assert!(
        said.contains("without --frames the recipe's tracks do nothing"),
        "{said}"
    );
    let set = [
        "spot.obj",
        "-r",
        "held.toml",
        "--set",
        "track=[]",
        "-o",
        "five.obj",
    ];
    let said = warp(&folder, &set).done().err;
    assert!(!said.contains("tracks"), "{said}");
    assert!(folder.read("still.obj") == folder.read("five.obj"));
    // Nothing moves: the model and nothing else.
    let still = ["spot.obj", "-r", "empty.toml", "-o"];
    let said = warp(
        &folder,
        &[&still[..], &["none.glb", "--frames", "3"]].concat(),
    )
    .done()
    .err;
    assert!(
        said.contains("nothing moves, so the file has no animation"),
        "{said}"
    );
    warp(&folder, &[&still[..], &["plain.glb"]].concat()).done();
    assert!(folder.read("none.glb") == folder.read("plain.glb"));
}

#[test]
fn points_in_the_plane_and_points_without_faces_are_animated() {
    let push = "version = 1\n[[warp]]\nkind = \"points\"\nradius = \"80%\"\npoint = [{ from = [\"50%\", \"50%\"], by = [\"20%\", 0] }]\n";
    let folder = Folder::with("valid/grid.csv", &[("push.toml", push)]);
    warp(
        &folder,
        &[
            "grid.csv",
            "-r",
            "push.toml",
            "--frames",
            "3",
            "-o",
            "out.glb",
        ],
    )
    .done();
    let film = Film::read(&folder, "out.glb");
    let mesh = film.file.meshes().next().unwrap();
    assert!(
        mesh.primitives()
            .all(|p| p.mode() == gltf::mesh::Mode::Points)
    );
    let shape = &film.nodes[0].positions[0];
    assert!(farthest(&shape.base, &shape.at(&film.nodes[0].weights[2])) > 0.0);
    assert!(
        shape
            .at(&film.nodes[0].weights[2])
            .iter()
            .all(|p| p[2] == 0.0)
    );
}

#[test]
fn bad_input_is_refused_before_any_work_and_leaves_nothing() {
    let folder = Folder::with("valid/spot.obj", &[("twist.toml", TWIST)]);
    folder.put("morph.glb", common::fixture("valid/gltf-skinned-morph.glb"));
    folder.put("there.glb", "mine");
    let before = folder.names();
    let run =
        |model: &str, more: &[&str]| warp(&folder, &[&[model, "-r", "twist.toml"], more].concat());
    for (arguments, says) in [
        (&["--frames", "0", "-o", "out.glb"][..], "from 2 to"),
        (&["--frames", "1", "-o", "out.glb"], "from 2 to"),
        (
            &["--frames", "5", "--fps", "0", "-o", "out.glb"],
            "frames a second",
        ),
        (
            &["--frames", "5", "--fps", "nan", "-o", "out.glb"],
            "frames a second",
        ),
        (
            &["--frames", "5", "--fps", "-24", "-o", "out.glb"],
            "frames a second",
        ),
        (&["--fps", "24", "-o", "out.glb"], "--frames"),
        (
            &["--frames", "5", "--range", "2-2", "-o", "out.glb"],
            "at least two frames",
        ),
        (&["--frames", "5", "-o", "out.gltf"], "name a .glb"),
        (
            &["--frames", "5", "-o", "out.glb", "--preview", "p.png"],
            "numbered files",
        ),
    ] {
        run("spot.obj", arguments).failed(2, &[says]);
    }
    let refused = [
        "vertices can take",
        "a GLB holds at most 4294967295",
        "numbered files",
    ];
    let start = std::time::Instant::now();
    run("spot.obj", &["--frames", "1000000", "-o", "out.glb"]).failed(1, &refused);
    assert!(start.elapsed().as_secs() < 20);
    run("spot.obj", &["--frames", "3", "-o", "there.glb"]).failed(1, &["exists already"]);
    let own = ["meshes[0]", "2 morph targets of its own", "numbered files"];
    run("morph.glb", &["--frames", "3", "-o", "out.glb"]).failed(1, &own);
    run("spot.obj", &["--frames", "3", "-o", "none/out.glb"]).failed(1, &["folder"]);
    run("nowhere.obj", &["--frames", "3", "-o", "out.glb"]).failed(1, &["nowhere.obj"]);
    assert_eq!(folder.names(), before);
    // A mesh with targets that does not move keeps them.
    let still = [
        "morph.glb",
        "-r",
        "twist.toml",
        "--set",
        "warp.0.angle=0deg",
        "--frames",
        "3",
        "-o",
        "out.glb",
    ];
    warp(&folder, &still).done();
    assert!(folder.read("out.glb") == folder.read("morph.glb"));
    // Numbered files have no rate, and the command says so.
    let said = run(
        "spot.obj",
        &["--frames", "2", "--fps", "2", "-o", "n.#.obj"],
    )
    .done()
    .err;
    assert!(said.contains("numbered files have no rate"), "{said}");
}
