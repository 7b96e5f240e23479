//! Images morphed by the command: the ends are the images, landmarks meet, films hold their frames, and what cannot be is refused.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use anamorph_io::images::{EncodeOptions, ImageFile, ImageFormat, ImageLimits};
use anamorph_raster::{Raster, Window};
use common::{Folder, fixture};

/// A dark picture with a bright blob, some pixels wide, at each place.
fn blobs(size: [usize; 2], places: &[[f64; 2]]) -> Raster {
    let window = Window::new(0, 0, size[0], size[1]).unwrap();
    let mut samples = Vec::new();
    for i in 0..size[0] * size[1] {
        let (x, y) = ((i % size[0]) as f64 + 0.5, (i / size[0]) as f64 + 0.5);
        let light = |p: &[f64; 2]| (-((x - p[0]).powi(2) + (y - p[1]).powi(2)) / 8.0).exp();
        samples.extend([places.iter().map(light).sum::<f64>() as f32; 3]);
    }
    Raster::from_samples(window, 3, samples).unwrap()
}

fn exr(raster: &Raster) -> Vec<u8> {
    let image = ImageFile::data(raster, &["B", "G", "R"]).unwrap();
    let encoded = image.encode(ImageFormat::OpenExr, &EncodeOptions::default());
    encoded.unwrap().0
}

fn read(folder: &Folder, name: &str) -> Raster {
    let bytes = std::fs::read(folder.path().join(name)).unwrap();
    let image = ImageFile::read(&bytes, ImageLimits::of_file(bytes.len())).unwrap();
    image.layers()[0].raster.clone().unwrap()
}

fn bits(raster: &Raster) -> Vec<u32> {
    raster.samples().iter().map(|s| s.to_bits()).collect()
}

fn landmarks(places: &[[f64; 2]]) -> String {
    format!("{places:?}")
}

/// The middle of the light near a place.
fn centroid(picture: &Raster, place: [f64; 2]) -> [f64; 2] {
    let (mut sum, mut at) = (0.0, [0.0; 2]);
    for row in 0..picture.height() {
        for column in 0..picture.width() {
            let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
            if (x - place[0]).hypot(y - place[1]) < 7.0 {
                let light = f64::from(picture.pixel(column, row)[0]);
                sum += light;
                at = [at[0] + light * x, at[1] + light * y];
            }
        }
    }
    [at[0] / sum, at[1] / sum]
}

const ANIMALS: [&str; 4] = [
    "cat.png",
    "raccoon.png",
    "cat.landmarks.json",
    "raccoon.landmarks.json",
];
const HERE: [[f64; 2]; 5] = [
    [30.0, 32.0],
    [92.0, 28.0],
    [61.0, 50.0],
    [40.0, 74.0],
    [85.0, 70.0],
];
const THERE: [[f64; 2]; 5] = [
    [36.0, 40.0],
    [84.0, 22.0],
    [66.0, 47.0],
    [46.0, 80.0],
    [79.0, 78.0],
];

/// Proof of D10: the landmarks of both warped images coincide to half a pixel at every time.
#[test]
fn landmarks_of_both_images_meet_at_every_time() {
    let folder = Folder::new();
    folder.put("a.exr", exr(&blobs([120, 100], &HERE)));
    folder.put("b.exr", exr(&blobs([120, 100], &THERE)));
    folder.put("a.json", landmarks(&HERE));
    folder.put("b.json", landmarks(&THERE));
    let pins: String = [[0, 0], [100, 0], [0, 100], [100, 100]]
        .iter()
        .map(|[x, y]| format!("[[warp.point]]\nfrom = [\"{x}%\", \"{y}%\"]\n"))
        .collect();
    // Each landmark as the middle of a short line.
    let cross = |p: &[f64; 2]| format!("[[{}, {}], [{}, {}]]", p[0] - 8.0, p[1], p[0] + 8.0, p[1]);
    let lines: String = HERE
        .iter()
        .zip(&THERE)
        .map(|(a, b)| {
            format!(
                "[[warp.line]]\nsource = {}\ntarget = {}\n",
                cross(a),
                cross(b)
            )
        })
        .collect();
    let nodes = |middle: &[f64; 2]| {
        format!(
            "[[0, 0], [60, 0], [120, 0], [0, 50], [{}, {}], [120, 50], [0, 100], [60, 100], [120, 100]]",
            middle[0], middle[1]
        )
    };
    let grid = format!(
        "columns = 3\nrows = 3\nsource = {}\ntarget = {}\n",
        nodes(&HERE[2]),
        nodes(&THERE[2])
    );
    for (name, body, checked) in [
        (
            "thin-plate",
            format!(
                "[[warp]]\nkind = \"thin-plate\"\nsource = \"a.json\"\ntarget = \"b.json\"\n{pins}"
            ),
            0..5,
        ),
        (
            "lines",
            format!("[[warp]]\nkind = \"lines\"\np = 0.5\n{lines}"),
            0..5,
        ),
        ("grid", format!("[grid]\n{grid}"), 2..3),
    ] {
        for time in [0.1, 0.25, 0.5, 0.75, 0.9] {
            // The colours of one image alone.
            for (end, when) in [("a", "start = 1, end = 1"), ("b", "start = 0, end = 0")] {
                folder.put(
                    "r.toml",
                    format!("version = 1\n[time]\ndissolve = {{ {when} }}\n{body}"),
                );
                let at = time.to_string();
                let out = format!("{end}-out.exr");
                folder
                    .run(&[
                        "morph", "a.exr", "b.exr", "-r", "r.toml", "--at", &at, "-o", &out, "-f",
                    ])
                    .done();
                let picture = read(&folder, &out);
                for i in checked.clone() {
                    let wanted = [0, 1].map(|k| HERE[i][k] + (THERE[i][k] - HERE[i][k]) * time);
                    let found = centroid(&picture, wanted);
                    let off = (found[0] - wanted[0]).hypot(found[1] - wanted[1]);
                    assert!(
                        off <= 0.5,
                        "{name} {end} {time}: landmark {i} is {off} px off"
                    );
                }
            }
        }
    }
}

/// Proof of D10: the ends are the images, with all of their bits.
#[test]
fn the_first_and_the_last_frame_are_the_images() {
    let folder = Folder::new();
    let (mut a, b) = (
        blobs([60, 50], &[[20.0, 20.0]]),
        blobs([60, 50], &[[33.0, 25.0]]),
    );
    a.pixel_mut(3, 4)
        .copy_from_slice(&[f32::NAN, f32::INFINITY, -2.0]);
    folder.put("a.exr", exr(&a));
    folder.put("b.exr", exr(&b));
    folder.put("a.json", landmarks(&[[20.0, 20.0]]));
    folder.put("b.json", landmarks(&[[33.0, 25.0]]));
    let run = [
        "morph",
        "a.exr",
        "b.exr",
        "-l",
        "a.json",
        "b.json",
        "--frames",
        "5",
        "-o",
        "o.%02d.exr",
    ];
    folder.run(&run).done();
    assert_eq!(bits(&read(&folder, "o.01.exr")), bits(&a));
    assert_eq!(bits(&read(&folder, "o.05.exr")), bits(&b));
    // What is not finite stays near its place.
    let middle = read(&folder, "o.03.exr");
    let wild = middle.samples().iter().filter(|s| !s.is_finite()).count();
    assert!(wild > 0 && wild < 200, "{wild}");
}

/// Proof of D10: an image against its shifted copy gives the half shift.
#[test]
fn a_shifted_copy_gives_the_half_shift() {
    let folder = Folder::new();
    let by = |d: f64| HERE.map(|[x, y]| [x + d, y + d / 2.0]);
    folder.put("a.exr", exr(&blobs([120, 100], &HERE)));
    folder.put("b.exr", exr(&blobs([120, 100], &by(12.0))));
    folder.put("a.json", landmarks(&HERE));
    folder.put("b.json", landmarks(&by(12.0)));
    // Without pins at the border the warp is the shift itself.
    let recipe =
        "version = 1\n[[warp]]\nkind = \"thin-plate\"\nsource = \"a.json\"\ntarget = \"b.json\"\n";
    folder.put("r.toml", recipe);
    folder
        .run(&[
            "morph", "a.exr", "b.exr", "-r", "r.toml", "--at", "0.5", "--filter", "lanczos", "-o",
            "o.exr",
        ])
        .done();
    let (found, wanted) = (read(&folder, "o.exr"), blobs([120, 100], &by(6.0)));
    let pairs = found.samples().iter().zip(wanted.samples());
    let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(worst < 0.02, "{worst}");
}

#[test]
fn schedules_of_features_and_colours_are_in_force() {
    let folder = Folder::new();
    folder.put("a.exr", exr(&blobs([120, 100], &HERE)));
    folder.put("b.exr", exr(&blobs([120, 100], &THERE)));
    let line = |i: usize| {
        let at = |p: [f64; 2]| format!("[[{}, {}], [{}, {}]]", p[0] - 8.0, p[1], p[0] + 8.0, p[1]);
        format!(
            "[[warp.line]]\nsource = {}\ntarget = {}\n",
            at(HERE[i]),
            at(THERE[i])
        )
    };
    folder.put(
        "r.toml",
        format!(
            "version = 1\n[time]\ndissolve = {{ start = 0.9 }}\n[[warp]]\nkind = \"lines\"\n\
             schedule = {{ features = [{{ end = 0.4 }}, {{ start = 0.6 }}] }}\n{}{}",
            line(0),
            line(1)
        ),
    );
    folder
        .run(&[
            "morph", "a.exr", "b.exr", "-r", "r.toml", "--at", "0.5", "-o", "o.exr",
        ])
        .done();
    let picture = read(&folder, "o.exr");
    for (place, what) in [
        (THERE[0], "the first has arrived"),
        (HERE[1], "the second has not left"),
    ] {
        let found = centroid(&picture, place);
        assert!(
            (found[0] - place[0]).hypot(found[1] - place[1]) < 0.5,
            "{what}: {found:?}"
        );
    }
    // The colours are still those of the first image: the blobs are as bright as they were.
    let brightest = picture.samples().iter().fold(0.0_f32, |a, b| a.max(*b));
    assert!(brightest > 0.9, "{brightest}");
}

/// A line that turns half round is across half way, and the images with it: the first a quarter forward, the second a quarter back.
#[test]
fn lines_turn_about_their_middles() {
    let folder = Folder::new();
    folder.put("a.exr", exr(&blobs([60, 50], &[[20.0, 20.0]])));
    folder.put(
        "r.toml",
        "version = 1\n[time]\npath = \"turning\"\n[[warp]]\nkind = \"lines\"\n[[warp.line]]\nsource = [[20, 25], [40, 25]]\n\
         target = [[40, 25], [20, 25]]\n",
    );
    let run = [
        "morph", "a.exr", "a.exr", "-r", "r.toml", "--at", "0.5", "-o", "o.exr",
    ];
    folder.run(&run).done();
    let picture = read(&folder, "o.exr");
    for place in [[35.0, 15.0], [25.0, 35.0]] {
        let found = centroid(&picture, place);
        let off = (found[0] - place[0]).hypot(found[1] - place[1]);
        assert!(off < 0.2, "{found:?}");
    }
    let brightest = picture.samples().iter().fold(0.0_f32, |a, b| a.max(*b));
    assert!((brightest - 0.5).abs() < 0.05, "{brightest}");
}

#[test]
fn numbered_frames_go_on_where_they_stopped() {
    let folder = Folder::new();
    for name in ANIMALS {
        folder.put(name, fixture(&format!("valid/{name}")));
    }
    let [a, b, from, to] = ANIMALS;
    let run = |frames: &str, more: &[&str]| {
        let all = [
            "morph", a, b, "-l", from, to, "--frames", frames, "-o", "o.##.png",
        ];
        folder.run(&[&all[..], more].concat())
    };
    run("4", &["--range", "2-3"]).done();
    let kept = std::fs::metadata(folder.path().join("o.02.png")).unwrap();
    let said = run("4", &[]).done().err;
    assert!(said.contains("2 frames exist and are kept"), "{said}");
    let same = std::fs::metadata(folder.path().join("o.02.png")).unwrap();
    assert_eq!(kept.modified().unwrap(), same.modified().unwrap());
    for name in ["o.01.png", "o.04.png"] {
        assert!(folder.path().join(name).exists(), "{name}");
    }
    // Frames of another morph are not mixed in.
    run("5", &[]).failed(2, &["o.frames.json"]);
    run("5", &["--force"]).done();
}

#[test]
fn films_hold_their_frames() {
    let folder = Folder::new();
    for name in ANIMALS {
        folder.put(name, fixture(&format!("valid/{name}")));
    }
    let [a, b, from, to] = ANIMALS;
    let run = |out: &str| {
        folder.run(&[
            "morph", a, b, "-l", from, to, "--frames", "3", "--fps", "25", "-o", out,
        ])
    };
    for (name, head) in [
        ("o.gif", &b"GIF89a"[..]),
        ("o.apng", b"\x89PNG"),
        ("o.y4m", b"YUV4MPEG2 W180 H120 F25:1 "),
    ] {
        run(name).done();
        let bytes = std::fs::read(folder.path().join(name)).unwrap();
        assert!(bytes.starts_with(head), "{name}");
        if name == "o.y4m" {
            let header = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
            assert_eq!(bytes.len(), header + 3 * (6 + 3 * 180 * 120));
        }
    }
    let piped = run("-").done().out;
    assert_eq!(piped, std::fs::read(folder.path().join("o.y4m")).unwrap());
}

/// A chain passes through its images, and a series plays along.
#[test]
fn chains_and_series() {
    let folder = Folder::new();
    let places = [[20.0, 20.0], [30.0, 22.0], [38.0, 30.0]];
    let names = ["a.exr", "b.exr", "c.exr"];
    for (name, place) in names.iter().zip(places) {
        folder.put(name, exr(&blobs([60, 50], &[place])));
        folder.put(&name.replace("exr", "json"), landmarks(&[place]));
    }
    let marks = ["a.json", "b.json", "c.json"];
    let all = [
        &["morph"],
        &names[..],
        &["-l"],
        &marks[..],
        &["--frames", "5", "-o", "o.%d.exr"],
    ]
    .concat();
    folder.run(&all).done();
    for (frame, name) in [
        ("o.1.exr", "a.exr"),
        ("o.3.exr", "b.exr"),
        ("o.5.exr", "c.exr"),
    ] {
        assert_eq!(
            bits(&read(&folder, frame)),
            bits(&read(&folder, name)),
            "{frame}"
        );
    }
    let one = [
        &["morph"],
        &names[..],
        &["-l"],
        &marks[..2],
        &["--frames", "5", "-o", "p.%d.exr"],
    ]
    .concat();
    folder.run(&one).failed(2, &["2 files for 3 images"]);

    // A clip whose blob moves, its feature keyed by a track; the other image stands still.
    for (number, x) in [(1, 16.0), (2, 20.0), (3, 24.0)] {
        folder.put(
            &format!("clip.{number:03}.exr"),
            exr(&blobs([60, 50], &[[x, 20.0]])),
        );
    }
    folder.put(
        "r.toml",
        "version = 1\n[time]\ndissolve = { start = 1 }\n[[warp]]\nkind = \"thin-plate\"\n\
         point = [{ from = [16, 20], to = [38, 30] }, { from = [0, 0] }, { from = [60, 0] }, { from = [0, 50] }, { from = [60, 50] }]\n\
         [[track]]\nset = \"warp.0.point.0.from\"\nkeys = [[0, [16, 20]], [1, [24, 20]]]\n",
    );
    folder
        .run(&[
            "morph",
            "clip.%03d.exr",
            "c.exr",
            "-r",
            "r.toml",
            "-o",
            "s.%d.exr",
        ])
        .done();
    // Half way between where the blob is in the second picture and where it shall go.
    let middle = centroid(&read(&folder, "s.2.exr"), [29.0, 25.0]);
    assert!(
        (middle[0] - 29.0).hypot(middle[1] - 25.0) < 0.5,
        "{middle:?}"
    );
    assert!(!folder.path().join("s.4.exr").exists());
    std::fs::remove_file(folder.path().join("clip.002.exr")).unwrap();
    folder
        .run(&[
            "morph",
            "clip.%03d.exr",
            "c.exr",
            "-r",
            "r.toml",
            "-o",
            "t.%d.exr",
        ])
        .failed(1, &["clip.002.exr"]);
}

#[test]
fn images_of_other_sizes_are_fitted_with_their_features() {
    let folder = Folder::new();
    let small = [[20.0, 20.0], [40.0, 30.0]];
    let large = small.map(|[x, y]| [2.0 * x, 2.0 * y]);
    folder.put("a.exr", exr(&blobs([60, 50], &small)));
    folder.put("b.exr", exr(&blobs([120, 100], &large)));
    folder.put("a.json", landmarks(&small));
    folder.put("b.json", landmarks(&large));
    let run = [
        "morph", "a.exr", "b.exr", "-l", "a.json", "b.json", "--at", "0.5", "-o", "o.exr",
    ];
    folder.run(&run).failed(1, &["120 × 100", "--fit"]);
    for fit in ["stretch", "contain", "cover"] {
        folder
            .run(&[&run[..], &["--fit", fit, "-f"]].concat())
            .done();
        let picture = read(&folder, "o.exr");
        for place in small {
            let found = centroid(&picture, place);
            assert!(
                (found[0] - place[0]).hypot(found[1] - place[1]) < 0.3,
                "{fit}: {found:?}"
            );
        }
    }
}

/// Everything that cannot be is refused in words, and nothing is written.
#[test]
fn what_cannot_be_is_refused() {
    let folder = Folder::new();
    let a = exr(&blobs([60, 50], &[[20.0, 20.0]]));
    folder.put("a.exr", a.clone());
    folder.put("b.exr", a);
    folder.put("cut.exr", &exr(&blobs([60, 50], &[[20.0, 20.0]]))[..200]);
    let depth = ImageFile::data(
        &Raster::new(Window::new(0, 0, 60, 50).unwrap(), 1).unwrap(),
        &["Z"],
    )
    .unwrap();
    folder.put(
        "depth.exr",
        depth
            .encode(ImageFormat::OpenExr, &EncodeOptions::default())
            .unwrap()
            .0,
    );
    for (name, content) in [
        ("a.json", "[[20, 20], [40, 40]]"),
        ("b.json", "[[22, 20], [40, 44]]"),
        ("three.json", "[[1, 1], [2, 2], [3, 3]]"),
        ("same.json", "[[20, 20], [20, 20]]"),
        ("far.json", "[[20, 20], [5000, 40]]"),
        (
            "large.json",
            "{\"width\": 600, \"height\": 500, \"points\": [[20, 20], [40, 40]]}",
        ),
        ("broken.json", "[[20, 20], [40"),
        (
            "twist.toml",
            "version = 1\n[[warp]]\nkind = \"polynomial\"\nx = [1]\ny = [1]\n",
        ),
        (
            "two.toml",
            "version = 1\n[[warp]]\nkind = \"points\"\npoint = [{ from = [1, 1] }]\n[[warp]]\nkind = \"points\"\npoint = [{ from = [1, 1] }]\n",
        ),
        (
            "mask.toml",
            "version = 1\n[[warp]]\nkind = \"points\"\nmask = 0.5\npoint = [{ from = [1, 1] }]\n",
        ),
        ("none.toml", "version = 1\n"),
        (
            "grid.toml",
            "version = 1\n[grid]\ncolumns = 2\nrows = 2\ntarget = [[0, 0], [60, 0], [0, 50], [-9, 50]]\n",
        ),
        (
            "grids.toml",
            "version = 1\n[grid]\ncolumns = 2\nrows = 2\ntarget = [[0, 0], [60, 0]]\n",
        ),
        (
            "zero.toml",
            "version = 1\n[[warp]]\nkind = \"lines\"\n[[warp.line]]\nsource = [[5, 5], [5, 5]]\n",
        ),
    ] {
        folder.put(name, content);
    }
    let before = std::fs::read_dir(folder.path()).unwrap().count();
    let pair = ["a.json", "b.json"];
    let with = |marks: [&'static str; 2]| {
        vec![
            "a.exr", "b.exr", "-l", marks[0], marks[1], "--at", "0.5", "-o", "o.png",
        ]
    };
    let recipe =
        |name: &'static str| vec!["a.exr", "b.exr", "-r", name, "--at", "0.5", "-o", "o.png"];
    for (arguments, code, wanted) in [
        (
            vec![
                "a.exr", "cut.exr", "-l", pair[0], pair[1], "--at", "0.5", "-o", "o.png",
            ],
            1,
            "cut.exr",
        ),
        (
            vec![
                "a.exr",
                "depth.exr",
                "-l",
                pair[0],
                pair[1],
                "--at",
                "0.5",
                "-o",
                "o.png",
            ],
            1,
            "channels",
        ),
        (
            vec![
                "a.exr", "none.exr", "-l", pair[0], pair[1], "--at", "0.5", "-o", "o.png",
            ],
            1,
            "none.exr",
        ),
        (
            vec!["a.exr", "b.exr", "-l", pair[0], pair[1], "-o", "o.png"],
            2,
            "--at",
        ),
        (
            vec!["a.exr", "b.exr", "-l", pair[0], pair[1], "-o", "o.obj"],
            2,
            "numbered images",
        ),
        (
            vec![
                "a.exr", "b.exr", "-l", pair[0], pair[1], "--at", "0.5", "-o", "a.exr",
            ],
            2,
            "made from",
        ),
        (
            vec![
                "a.exr", "b.exr", "-l", pair[0], pair[1], "--frames", "1", "-o", "o.gif",
            ],
            2,
            "--frames",
        ),
        (
            vec![
                "a.exr", "b.exr", "-l", pair[0], pair[1], "--frames", "4", "--range", "3-9", "-o",
                "o.gif",
            ],
            2,
            "--range",
        ),
        (
            vec![
                "a.exr", "b.exr", "-l", pair[0], pair[1], "--ease", "wobbly", "-o", "o.gif",
            ],
            2,
            "wobbly",
        ),
        (
            vec![
                "a.exr", "b.exr", "-l", pair[0], pair[1], "--filter", "soft", "-o", "o.gif",
            ],
            2,
            "soft",
        ),
        (
            vec![
                "a.exr", "b.exr", "-l", pair[0], pair[1], "--method", "twist", "--at", "0.5", "-o",
                "o.png",
            ],
            2,
            "twist",
        ),
        (with(["a.json", "three.json"]), 1, "3 points"),
        (with(["same.json", "b.json"]), 1, "same source"),
        (with(["a.json", "far.json"]), 1, "(5000, 40)"),
        (with(["large.json", "b.json"]), 1, "600 × 500"),
        (with(["broken.json", "b.json"]), 1, "broken.json"),
        (recipe("twist.toml"), 1, "twist.toml"),
        (recipe("two.toml"), 1, "second"),
        (recipe("mask.toml"), 1, "mask"),
        (recipe("none.toml"), 1, "needs a warp"),
        (recipe("grid.toml"), 1, "grid"),
        (recipe("grids.toml"), 1, "2 nodes"),
        (recipe("zero.toml"), 1, "without length"),
    ] {
        folder
            .run(&[&["morph"], arguments.as_slice()].concat())
            .failed(code, &[wanted]);
        let after = std::fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(after, before, "{arguments:?}");
    }
}

/// Points that swap places crush what is between them, which is said; where they meet nothing can be drawn, which is found before anything is.
#[test]
fn folds_are_said_and_meetings_found_before_the_first_frame() {
    let folder = Folder::new();
    folder.put("a.exr", exr(&blobs([60, 50], &[[20.0, 20.0]])));
    folder.put(
        "swap.toml",
        "version = 1\n[[warp]]\nkind = \"thin-plate\"\npoint = [{ from = [0, 0] }, { from = [60, 0] }, { from = [0, 50] }, \
         { from = [60, 50] }, { from = [20, 25], to = [40, 25] }, { from = [40, 25], to = [20, 25] }]\n",
    );
    let run = |more: &[&str]| {
        folder.run(&[&["morph", "a.exr", "a.exr", "-r", "swap.toml"], more].concat())
    };
    let said = run(&["--at", "0.45", "-o", "o.exr"]).done().err;
    assert!(said.contains("folds over"), "{said}");
    let before = folder.names();
    run(&["--frames", "5", "-o", "f.%d.exr"]).failed(1, &["frame 3", "meet on their way"]);
    assert_eq!(folder.names(), before);
}

/// Small files whose data windows are far apart do not become a large one.
#[test]
fn data_windows_far_apart_are_refused() {
    let folder = Folder::new();
    let shown = Window::new(0, 0, 32, 32).unwrap();
    for (name, x) in [("a.exr", 0), ("b.exr", 8000)] {
        let own = Window::new(x, x, 16, 16).unwrap();
        folder.put(name, exr(&Raster::new(own, 3).unwrap().with_display(shown)));
    }
    folder.put("a.json", landmarks(&[[8.0, 8.0]]));
    let run = [
        "morph", "a.exr", "b.exr", "-l", "a.json", "a.json", "--at", "0.5", "-o", "o.exr",
    ];
    folder
        .run(&run)
        .failed(1, &["far more than they show", "--allow-large"]);
}
