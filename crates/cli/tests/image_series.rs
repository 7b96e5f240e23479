//! Series of images that can be trusted: frames are those of their inputs, images of other channels are brought together, what lies outside
//! is transparent, straight edges stay straight, and an interrupted run leaves nothing behind.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use anamorph_io::images::{EncodeOptions, ImageFile, ImageFormat, ImageLimits};
use anamorph_raster::{Raster, Window};
use common::{Folder, Run, fixture};
use std::time::{Duration, SystemTime};

const EMPTY: &str = "version = 1\n";
const SHIFT: &str =
    "version = 1\n[[warp]]\nkind = \"frames\"\n[[warp.frame]]\nat = [0, 0]\nto = [9, 4]\n";
const SWIRL: &str = "version = 1\n[[warp]]\nkind = \"vortex\"\ncentre = [\"50%\", \"50%\"]\nradius = \"35%\"\nangle = \"50deg\"\n";
const MARKS: &str = "[[10, 10], [30, 12], [20, 22]]";
const THERE: &str = "[[12, 10], [28, 13], [21, 20]]";

/// A smooth picture of so many channels, coverage 1 in those named A.
fn picture(size: [usize; 2], channels: &[&str]) -> ImageFile {
    let window = Window::new(0, 0, size[0], size[1]).unwrap();
    let mut samples = Vec::new();
    for i in 0..size[0] * size[1] {
        let (x, y) = ((i % size[0]) as f32, (i / size[0]) as f32);
        for (c, name) in channels.iter().enumerate() {
            let wave = 0.5 + 0.4 * (0.2 * x + c as f32).sin() * (0.17 * y).cos();
            samples.push(if *name == "A" { 1.0 } else { wave });
        }
    }
    let raster = Raster::from_samples(window, channels.len(), samples).unwrap();
    ImageFile::data(&raster, channels).unwrap()
}

fn encoded(image: &ImageFile, format: ImageFormat) -> Vec<u8> {
    image.encode(format, &EncodeOptions::default()).unwrap().0
}

fn png(size: [usize; 2], channels: &[&str]) -> Vec<u8> {
    // By way of 16 bits, as the numbers of OpenEXR come out.
    encoded(&picture(size, channels), ImageFormat::Png)
}

fn decoded(bytes: &[u8]) -> ImageFile {
    ImageFile::read(bytes, ImageLimits::NONE).unwrap()
}

fn read(folder: &Folder, name: &str) -> ImageFile {
    decoded(&folder.read(name))
}

fn pixels(image: &ImageFile) -> &Raster {
    image.layers()[0].raster.as_ref().unwrap()
}

fn channels(image: &ImageFile) -> Vec<&str> {
    let all = image.layers()[0].channels().iter();
    all.map(anamorph_io::images::Channel::name).collect()
}

/// A folder with two pictures and their landmarks.
fn pair() -> Folder {
    let folder = Folder::new();
    folder.put("a.png", png([40, 30], &["B", "G", "R"]));
    folder.put("b.png", png([40, 30], &["B", "G", "R"]));
    folder.put("a.json", MARKS).put("b.json", THERE);
    folder
}

fn morph(folder: &Folder, more: &[&str]) -> Run {
    let all = ["morph", "a.png", "b.png", "-l", "a.json", "b.json"];
    folder.run(&[&all[..], more].concat())
}

fn touched(folder: &Folder, name: &str) -> SystemTime {
    let found = std::fs::metadata(folder.path().join(name)).unwrap();
    found.modified().unwrap()
}

fn touch(folder: &Folder, name: &str) {
    let file = std::fs::File::options()
        .write(true)
        .open(folder.path().join(name));
    let later = SystemTime::now() + Duration::from_secs(77);
    file.unwrap().set_modified(later).unwrap();
}

/// The dates of inputs say nothing; their contents and the options say all.
#[test]
fn frames_are_those_of_their_inputs() {
    let folder = pair();
    let run = |more: &[&str]| {
        let all = [&["--frames", "4", "-o", "o.#.jpg"][..], more].concat();
        morph(&folder, &all)
    };
    run(&[]).done();
    let first = touched(&folder, "o.2.jpg");
    for name in ["a.png", "b.png", "a.json", "b.json"] {
        touch(&folder, name);
    }
    let said = run(&[]).done().err;
    assert!(said.contains("4 frames exist and are kept"), "{said}");
    assert_eq!(first, touched(&folder, "o.2.jpg"));
    // An option and an input that shape frames.
    run(&["--quality", "40"]).failed(2, &["o.frames.json", "--force"]);
    folder.put("b.json", MARKS);
    run(&[]).failed(2, &["o.frames.json", "--force"]);
    folder.put("b.json", THERE);
    run(&[]).done();
    // Another picture of the same size.
    folder.put("a.png", png([40, 30], &["G", "B", "R"]));
    run(&[]).failed(2, &["no frame of these inputs"]);
    run(&["--force"]).done();
}

/// A recipe's own files count, too.
#[test]
fn files_that_a_recipe_reads_count() {
    let folder = pair();
    folder.put(
        "r.toml",
        "version = 1\n[[warp]]\nkind = \"thin-plate\"\nsource = \"a.json\"\ntarget = \"b.json\"\n",
    );
    let morph = [
        "morph", "a.png", "b.png", "-r", "r.toml", "--frames", "3", "-o", "m.#.png",
    ];
    let warp = [
        "warp", "a.png", "-r", "r.toml", "--frames", "3", "-o", "w.#.png",
    ];
    folder.put("p.csv", "x,y\n1,2\n5,6\n");
    let model = [
        "warp", "p.csv", "-r", "r.toml", "--frames", "3", "-o", "p.#.csv",
    ];
    folder.run(&model).done();
    folder.run(&morph).done();
    folder.run(&warp).done();
    folder.put("b.json", "[[12, 10], [28, 13], [21, 19]]");
    folder.run(&morph).failed(2, &["no frame of these inputs"]);
    folder.run(&warp).failed(2, &["no frame of these inputs"]);
    folder.run(&model).failed(2, &["no frame of these inputs"]);
}

/// What is cut off, empty, of another size or no picture is made again.
#[test]
fn damaged_frames_are_made_again() {
    let folder = pair();
    folder.put("r.toml", SWIRL);
    let small = png([9, 9], &["B", "G", "R"]);
    for extension in ["png", "jpg", "webp", "tif", "exr"] {
        let names = |kind: &str| format!("{kind}.#.{extension}");
        let (m, w) = (names("m"), names("w"));
        let runs = [
            (
                "m",
                vec![
                    "morph", "a.png", "b.png", "-l", "a.json", "b.json", "--frames", "5", "-o", &m,
                ],
            ),
            (
                "w",
                vec!["warp", "a.png", "-r", "r.toml", "--frames", "5", "-o", &w],
            ),
        ];
        for (kind, run) in runs {
            folder.run(&run).done();
            let name = |n: usize| format!("{kind}.{n}.{extension}");
            let whole: Vec<Vec<u8>> = (1..=5).map(|n| folder.read(&name(n))).collect();
            folder.put(&name(1), &whole[0][..whole[0].len() - 1]);
            folder.put(&name(2), &whole[1][..whole[1].len() / 2]);
            folder.put(&name(3), b"");
            folder.put(
                &name(4),
                encoded(&decoded(&small), decoded(&whole[3]).format()),
            );
            let said = folder.run(&run).done().err;
            assert!(said.contains("1 frames exist and are kept"), "{said}");
            assert!(said.contains("4 frames were there, but damaged"), "{said}");
            for (n, whole) in (1..=5).zip(&whole) {
                assert!(&folder.read(&name(n)) == whole, "{kind} {n} {extension}");
            }
        }
    }
}

/// A forced run that stops leaves no frame of the old one that the next would keep.
#[test]
fn frames_of_an_old_making_do_not_survive_a_forced_run() {
    let folder = pair();
    let run = |more: &[&str]| {
        morph(
            &folder,
            &[&["--frames", "3", "-o", "o.#.png"][..], more].concat(),
        )
    };
    run(&[]).done();
    let old = folder.read("o.2.png");
    folder.put("b.json", "[[18, 10], [28, 19], [11, 20]]");
    // The first frame cannot be written, so that the run fails on its way.
    std::fs::remove_file(folder.path().join("o.1.png")).unwrap();
    std::fs::create_dir(folder.path().join("o.1.png")).unwrap();
    run(&["--force"]).failed(1, &["o.1.png"]);
    std::fs::remove_dir(folder.path().join("o.1.png")).unwrap();
    run(&[]).done();
    assert!(folder.read("o.2.png") != old);
}

/// Grey and colour, with and without alpha, meet in what all have; what is said names it.
#[test]
fn channels_are_brought_together() {
    let kinds: [&[&str]; 4] = [&["Y"], &["A", "Y"], &["B", "G", "R"], &["A", "B", "G", "R"]];
    for first in kinds {
        for second in kinds.into_iter().filter(|second| *second != first) {
            let folder = pair();
            folder.put("a.png", png([40, 30], first));
            folder.put("b.png", png([40, 30], second));
            let said = morph(&folder, &["--frames", "3", "-o", "o.#.png"])
                .done()
                .err;
            let has = |name: &str| first.contains(&name) || second.contains(&name);
            let mut wanted = if has("R") {
                vec!["R", "G", "B"]
            } else {
                vec!["Y"]
            };
            wanted.extend(has("A").then_some("A"));
            for frame in ["o.1.png", "o.2.png", "o.3.png"] {
                assert_eq!(channels(&read(&folder, frame)), wanted, "{frame}");
            }
            let gets_alpha = first.contains(&"A") != second.contains(&"A");
            assert_eq!(
                said.contains("no alpha, so it is opaque"),
                gets_alpha,
                "{said}"
            );
            let gets_colour = first.contains(&"R") != second.contains(&"R");
            assert_eq!(said.contains("stands in R, G and B"), gets_colour, "{said}");
            // The ends are the images, in the channels of both.
            for (end, image) in [("o.1.png", "a.png"), ("o.3.png", "b.png")] {
                let own = read(&folder, image).with_channels(0, &wanted).unwrap();
                let (found, own) = (read(&folder, end), pixels(&own).clone());
                assert_eq!(
                    pixels(&found).samples(),
                    own.samples(),
                    "{first:?} {second:?}"
                );
            }
        }
    }
}

#[test]
fn files_of_codes_and_numbers_meet() {
    let folder = pair();
    folder.put(
        "b.exr",
        encoded(&picture([40, 30], &["A", "Y"]), ImageFormat::OpenExr),
    );
    for (images, out, wanted) in [
        (["a.png", "b.exr"], "o.png", ["R", "G", "B", "A"]),
        (["b.exr", "a.png"], "o.exr", ["A", "B", "G", "R"]),
    ] {
        let all = [
            "morph", images[0], images[1], "-l", "a.json", "b.json", "--at", "0.5", "-o", out,
        ];
        folder.run(&all).done();
        assert_eq!(channels(&read(&folder, out)), wanted);
    }
    folder.put(
        "z.exr",
        encoded(&picture([40, 30], &["A", "Y", "Z"]), ImageFormat::OpenExr),
    );
    let before = folder.names();
    folder
        .run(&[
            "morph", "a.png", "z.exr", "-l", "a.json", "b.json", "-o", "o.gif",
        ])
        .failed(1, &["z.exr", "A, Y, Z", "only one of them has Z"]);
    assert_eq!(folder.names(), before);
}

/// Films of a warp hold its frames, by the same names as those of a morph.
#[test]
fn warps_of_images_are_films() {
    let folder = Folder::new();
    folder.put("cat.png", fixture("valid/cat.png"));
    folder.put("r.toml", SWIRL);
    let run = |out: &str, more: &[&str]| {
        let all = [
            "warp", "cat.png", "-r", "r.toml", "--frames", "3", "-o", out,
        ];
        folder.run(&[&all[..], more].concat())
    };
    for (name, head) in [
        ("o.gif", &b"GIF89a"[..]),
        ("o.apng", b"\x89PNG"),
        ("o.y4m", b"YUV4MPEG2 W180 H120 F24:1 "),
    ] {
        let said = run(name, &[]).done().err;
        assert!(said.contains("3 frames, 0.125 seconds at 24"), "{said}");
        assert!(folder.read(name).starts_with(head), "{name}");
        run(name, &[]).failed(1, &["exists already"]);
    }
    let film = folder.read("o.y4m");
    assert_eq!(run("-", &["-q"]).done().out, film);
    let header = film.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    let frame = 6 + 3 * 180 * 120;
    assert_eq!(film.len(), header + 3 * frame);
    let frames: Vec<&[u8]> = film[header..].chunks(frame).collect();
    assert!(frames[0] != frames[1] && frames[1] != frames[2]);
    // The frames of a range, and a clock that does not hold the rate.
    let said = run("p.gif", &["--range", "2-3", "--fps", "30"]).done().err;
    assert!(said.contains("hundredths of a second"), "{said}");
    let before = folder.names();
    for (more, says) in [
        (vec!["--grow"], "--grow"),
        (vec!["--preview", "p.png"], "--preview"),
        (vec!["--report", "p.json"], "--report"),
    ] {
        run("q.gif", &more).failed(2, &[says, "numbered images"]);
    }
    assert_eq!(folder.names(), before);
}

/// What lies outside is transparent where the format can say so, and said where it cannot.
#[test]
fn what_lies_outside_is_transparent() {
    let folder = Folder::new();
    folder.put("r.toml", SHIFT).put("still.toml", EMPTY);
    for (format, name, extension) in [
        (ImageFormat::Png, "a.png", "png"),
        (ImageFormat::Jpeg, "a.jpg", "jpg"),
        (ImageFormat::Tiff, "a.tif", "tif"),
        (ImageFormat::WebP, "a.webp", "webp"),
        (ImageFormat::OpenExr, "a.exr", "exr"),
    ] {
        folder.put(name, encoded(&picture([40, 30], &["B", "G", "R"]), format));
        let own = read(&folder, name);
        for how in [&["--edge", "transparent"][..], &["--grow"]] {
            let out = format!("o.{extension}");
            let run = |recipe: &str| {
                let all = ["warp", name, "-r", recipe, "-f", "-o", &out];
                folder.run(&[&all[..], how].concat()).done().err
            };
            // Nothing outside is seen: nothing is added, and lossless pixels are the same.
            run("still.toml");
            let still = read(&folder, &out);
            assert_eq!(channels(&still), channels(&own), "{name} {how:?}");
            if format != ImageFormat::Jpeg {
                assert_eq!(pixels(&still).samples(), pixels(&own).samples(), "{name}");
            }
            let said = run("r.toml");
            let moved = read(&folder, &out);
            // The picture itself grows to where it goes, without what it leaves.
            if format == ImageFormat::Jpeg {
                assert_eq!(channels(&moved), channels(&own));
                assert!(
                    said.contains("is black, because JPEG has no alpha"),
                    "{said}"
                );
                continue;
            }
            assert!(said.contains("has an alpha channel"), "{said}");
            let alpha = channels(&moved).iter().position(|c| *c == "A").unwrap();
            let raster = pixels(&moved);
            let all = raster.samples().chunks_exact(raster.channels());
            let coverage: Vec<f32> = all.map(|pixel| pixel[alpha]).collect();
            assert!(
                coverage.contains(&0.0) && coverage.contains(&1.0),
                "{name} {how:?}"
            );
        }
    }
}

#[test]
fn a_picture_without_coverage_is_said_to_be_empty() {
    let folder = Folder::new();
    folder.put("r.toml", EMPTY);
    let raster = pixels(&picture([8, 8], &["B", "G", "R", "Z"])).clone();
    let mut empty = raster.clone();
    for pixel in empty.samples_mut().chunks_exact_mut(4) {
        pixel[3] = 0.0;
    }
    let image = ImageFile::data(&empty, &["B", "G", "R", "A"]).unwrap();
    folder.put("a.exr", encoded(&image, ImageFormat::OpenExr));
    let said = folder
        .run(&["warp", "a.exr", "-r", "r.toml", "-o", "a.png"])
        .done()
        .err;
    assert!(said.contains("alpha is 0 everywhere"), "{said}");
}

/// A signal ends a run with 130, and no part of a result stays.
#[cfg(unix)]
#[test]
fn a_signal_leaves_nothing_behind() {
    for signal in ["INT", "TERM"] {
        let folder = pair();
        let before = folder.names();
        let arguments = [
            "--default-signal=INT,TERM,HUP",
            env!("CARGO_BIN_EXE_anamorph"),
            "morph",
            "a.png",
            "b.png",
            "-l",
            "a.json",
            "b.json",
            "--frames",
            "9000",
            "-o",
            "o.y4m",
        ];
        let mut child = std::process::Command::new("env")
            .args(arguments)
            .current_dir(folder.path())
            .stderr(std::process::Stdio::null())
            .spawn()
            .unwrap();
        let begun = || folder.names().iter().any(|name| name.ends_with(".part"));
        for _ in 0..2000 {
            if begun() {
                break;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        assert!(begun(), "no temporary file");
        let mut kill = std::process::Command::new("kill");
        let id = child.id().to_string();
        assert!(kill.args(["-s", signal, &id]).status().unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
        assert_eq!(folder.names(), before, "{signal}");
    }
}

#[test]
fn odd_names_of_series_are_refused() {
    let folder = pair();
    let before = folder.names();
    for (name, says) in [
        ("x.%0999d.png", "999 digits"),
        ("x.%04d.%04d.png", "two places"),
        ("x.%04d.##.png", "two places"),
        ("x.%s.png", "`%s` is no place"),
        ("x.%-4d.png", "`%-4d` is no place"),
    ] {
        morph(&folder, &["--frames", "3", "-o", name]).failed(2, &[says, name]);
        folder
            .run(&[
                "morph", name, "b.png", "-l", "a.json", "b.json", "-o", "o.gif",
            ])
            .failed(2, &[says, name]);
    }
    assert_eq!(folder.names(), before);
    // Numbers below 0 are as good as others.
    let negative = [
        "--frames",
        "3",
        "--start",
        "-1",
        "--range",
        "-1-0",
        "-o",
        "n.%02d.png",
    ];
    morph(&folder, &negative).done();
    assert!(folder.names().contains(&"n.-01.png".to_owned()));
}

/// Where a picture lies within another its edges stay straight on their way.
#[test]
fn edges_of_fitted_pictures_stay_straight() {
    let folder = Folder::new();
    // The first picture is empty, so that coverage is that of the second.
    let flat = |size: [usize; 2], sample: f32| {
        let window = Window::new(0, 0, size[0], size[1]).unwrap();
        let raster = Raster::from_samples(window, 4, vec![sample; 4 * size[0] * size[1]]);
        let image = ImageFile::data(&raster.unwrap(), &["A", "B", "G", "R"]).unwrap();
        encoded(&image, ImageFormat::OpenExr)
    };
    folder.put("a.exr", flat([180, 120], 0.0));
    folder.put("b.exr", flat([60, 120], 1.0));
    folder.put("a.json", "[[20, 30], [60, 32], [40, 80]]");
    folder.put("b.json", "[[18, 40], [42, 40], [30, 85]]");
    for time in [0.25, 0.5, 0.75] {
        let at = time.to_string();
        let run = [
            "morph", "a.exr", "b.exr", "-l", "a.json", "b.json", "--fit", "contain",
        ];
        folder
            .run(&[&run[..], &["--at", &at, "-f", "-o", "o.exr"]].concat())
            .done();
        let drawn = read(&folder, "o.exr");
        let drawn = pixels(&drawn);
        let left = |row: usize| -> f64 {
            let uncovered = |column| 1.0 - f64::from(drawn.pixel(column, row)[0]) / time;
            (0..90).map(uncovered).sum()
        };
        // The edge is on its way from that of the first picture to its own.
        let edges: Vec<f64> = (2..118).map(left).collect();
        let (least, most) = edges
            .iter()
            .fold((90.0_f64, 0.0_f64), |(a, b), &x| (a.min(x), b.max(x)));
        assert!(
            (least - 60.0 * time).abs() < 1.0,
            "{time}: {least} to {most}"
        );
        assert!(most - least < 1.0, "{time}: {least} to {most}");
    }
}

/// Grey numbers of 32 bits, which renderers write as TIFF, are read and written as they are.
#[test]
fn grey_numbers_stay_grey_numbers() {
    let folder = Folder::new();
    folder.put("r.toml", EMPTY);
    let image = picture([12, 9], &["Y"]);
    folder.put("a.exr", encoded(&image, ImageFormat::OpenExr));
    folder
        .run(&["warp", "a.exr", "-r", "r.toml", "-o", "a.tif"])
        .done();
    folder
        .run(&["warp", "a.tif", "-r", "r.toml", "-o", "b.tif"])
        .done();
    for name in ["a.tif", "b.tif"] {
        let found = read(&folder, name);
        assert_eq!(channels(&found), ["Y"]);
        assert_eq!(pixels(&found).samples(), pixels(&image).samples(), "{name}");
    }
}

/// Messages name what the user wrote, and nothing of the program's insides.
#[test]
fn messages_name_what_the_user_wrote() {
    let folder = pair();
    let run = |marks: [&str; 2], more: &[&str]| {
        let all = [
            "morph", "a.png", "b.png", "-l", marks[0], marks[1], "-o", "o.gif",
        ];
        folder.run(&[&all[..], more].concat())
    };
    folder.put("corner.json", "[[0, 0], [30, 12], [20, 22]]");
    folder.put("twice.json", "[[10, 10], [30, 12], [10, 10]]");
    folder.put("few.json", "[[10, 10]]");
    for (marks, says) in [
        (
            ["corner.json", "b.json"],
            "landmark 0 and the border pin at (0%, 0%)",
        ),
        (["twice.json", "b.json"], "landmark 0 and landmark 2"),
        (["few.json", "b.json"], "3 points where few.json has 1"),
    ] {
        for fit in [&[][..], &["--fit", "contain"]] {
            let err = run(marks, fit).failed(1, &[says]).err;
            for word in ["recipe", "warp.", "point.", ":1:"] {
                assert!(!err.contains(word), "{word}: {err}");
            }
        }
    }
    run(["a.json", "b.json"], &["--method", "lines"]).failed(1, &["list its chains"]);
    run(["a.json", "b.json"], &["--method", "twist"]).failed(2, &["--method twist", "thin-plate"]);
    folder.put(
        "grid.toml",
        "version = 1\n\n[grid]\ncolumns = 2\nrows = 2\ntarget = [[0, 0], [40, 0], [0, 30], [-9, 30]]\n",
    );
    folder
        .run(&["morph", "a.png", "b.png", "-r", "grid.toml", "-o", "o.gif"])
        .failed(1, &["grid.toml:6:", "target"]);
    let mut damaged = folder.read("a.png");
    let middle = damaged.len() / 2;
    damaged[middle] ^= 0x55;
    folder.put("a.png", damaged);
    let err = run(["a.json", "b.json"], &[])
        .failed(1, &["a.png", "damaged"])
        .err;
    assert!(!err.contains(['{', '[', '`']), "{err}");
}
