//! Where results go: nothing is replaced unasked, nothing appears half, nothing is left behind.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::{EMPTY, Folder, TWIST, fixture};

const SPOT: &str = "valid/spot.obj";

fn folder() -> Folder {
    Folder::with(SPOT, &[("empty.toml", EMPTY), ("twist.toml", TWIST)])
}

#[test]
fn an_existing_output_is_replaced_only_by_force() {
    let folder = folder();
    folder.put("out.obj", "mine");
    for what in ["-o", "--report", "--preview"] {
        let mut arguments = vec!["warp", "spot.obj", "-r", "twist.toml", what, "out.obj"];
        if what != "-o" {
            arguments.extend(["-o", "new.obj"]);
        }
        let before = folder.names();
        folder.run(&arguments).failed(
            1,
            &["out.obj: exists already; choose another name, or add --force"],
        );
        assert_eq!(folder.names(), before, "{what}");
        assert_eq!(folder.read("out.obj"), b"mine");
    }
    let run = folder.run(&[
        "warp",
        "spot.obj",
        "-r",
        "twist.toml",
        "-o",
        "out.obj",
        "--force",
    ]);
    assert!(run.done().err.contains("spot.obj -> out.obj: twist; 29"));
    assert!(folder.read("out.obj").starts_with(b"v "));
}

#[test]
fn a_model_may_replace_itself() {
    let folder = folder();
    let warp = ["warp", "spot.obj", "-r", "twist.toml", "-o"];
    folder.run(&[&warp[..], &["out.obj"]].concat()).done();
    folder
        .run(&[&warp[..], &["./spot.obj"]].concat())
        .failed(1, &["exists already"]);
    folder
        .run(&[&warp[..], &["./spot.obj", "-f"]].concat())
        .done();
    assert!(folder.read("spot.obj") == folder.read("out.obj"));
}

/// A report at `./out.obj` used to replace the model just written to `out.obj`, and `--report` with `--force` the input.
#[test]
fn results_never_replace_each_other_or_an_input() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    let before = folder.names();
    let same = "two results would be written there";
    let model = "a report or preview would replace a model";
    let recipe = "a result would replace the recipe";
    for (arguments, says) in [
        (["out.obj", "--report", "out.obj"], same),
        (["out.obj", "--report", "./out.obj"], same),
        (["out.obj", "--preview", "sub/../out.obj"], same),
        (["new/out.obj", "--preview", "./new/out.obj"], same),
        (["out.obj", "--report", "spot.obj"], model),
        (["out.obj", "--preview", "sub/../spot.obj"], model),
        (["./twist.toml", "--report", "x.json"], recipe),
        (["x.obj", "--report", "sub/../twist.toml"], recipe),
    ] {
        let warp = ["warp", "spot.obj", "-r", "twist.toml", "--force", "-o"];
        folder
            .run(&[&warp[..], &arguments].concat())
            .failed(2, &[says, "choose another name"]);
        assert_eq!(folder.names(), before, "{arguments:?}");
    }
    assert!(folder.read("spot.obj") == fixture(SPOT));
    assert_eq!(folder.read("twist.toml"), TWIST.as_bytes());
}

#[test]
fn an_output_that_cannot_be_is_refused_before_anything_is_done() {
    let folder = folder();
    folder.put("file", "");
    std::fs::create_dir_all(folder.path().join("sub/spot.obj")).unwrap();
    let before = folder.names();
    let missing = "its folder does not exist; make it first";
    for (what, path, says) in [
        ("-o", "missing/out.obj", missing),
        ("--report", "missing/report.json", missing),
        ("--preview", "missing/out.png", missing),
        ("-o", "file/out.obj", missing),
        ("-o", "sub/", "sub/spot.obj: is a folder; name a file in it"),
        ("-o", "file/", "a file of this name is in the way"),
        ("-o", "file/sub/", "cannot make the folder"),
    ] {
        let mut arguments = vec!["warp", "spot.obj", "-r", "twist.toml", what, path];
        if what != "-o" {
            arguments.extend(["-o", "out.obj"]);
        }
        folder.run(&arguments).failed(1, &[says]);
        assert_eq!(folder.names(), before, "{what} {path}");
    }
    for (path, says) in [
        ("nowhere.obj", "nowhere.obj: cannot read: "),
        ("sub", "sub: is a folder; name a file in it"),
    ] {
        folder
            .run(&["warp", path, "-r", "twist.toml", "-o", "out.obj"])
            .failed(1, &[says]);
        folder
            .run(&["warp", "spot.obj", "-r", path, "-o", "out.obj"])
            .failed(1, &[says]);
        assert_eq!(folder.names(), before);
    }
}

/// A preview or report that fails takes the model with it, and folders that were made for them.
#[test]
fn results_appear_together_or_not_at_all() {
    let folder = Folder::with("damaged/nan-vertex.obj", &[("empty.toml", EMPTY)]);
    folder.put("alone.obj", "v nan 0 0\n");
    let before = folder.names();
    let preview = [
        "--preview",
        "new/pictures/",
        "--report",
        "new/reports/",
        "--allow-nonfinite",
    ];
    let warp = ["warp", "alone.obj", "-r", "empty.toml", "-o"];
    for output in ["new/", "out.obj", "-"] {
        let run = folder.run(&[&warp[..], &[output], &preview].concat());
        let run = run.failed(1, &["alone.obj: cannot draw the preview: nothing to draw"]);
        assert_eq!(run.out, b"", "a part was written");
        assert_eq!(folder.names(), before, "{output}");
    }
    // Sizes that no picture has are wrong usage, whatever the model.
    for size in [
        "0x0",
        "1x1",
        "100000x100000",
        "4294967295x4294967295",
        "99999999999x9",
        "16384x16384",
        "x",
        "axb",
    ] {
        folder
            .run(
                &[
                    &warp[..],
                    &["out.obj", "--preview", "a.png", "--size", size],
                ]
                .concat(),
            )
            .failed(2, &["--size"]);
        assert_eq!(folder.names(), before, "{size}");
    }
}

#[test]
fn several_models_go_into_a_folder() {
    let folder = folder();
    folder
        .put("bad.obj", fixture("damaged/nan-vertex.obj"))
        .put("last.obj", fixture("valid/tm-wallhole.obj"));
    let all = [
        "warp",
        "spot.obj",
        "bad.obj",
        "last.obj",
        "-r",
        "twist.toml",
    ];
    let run = folder.run(
        &[
            &all[..],
            &[
                "-o",
                "out/deep/",
                "--report",
                "out/",
                "--preview",
                "pictures/",
                "--size",
                "64x36",
            ],
        ]
        .concat(),
    );
    // One that fails does not keep the others from being done.
    run.failed(
        1,
        &[
            "bad.obj: line 7",
            "spot.obj -> out/deep/spot.obj",
            "last.obj -> ",
        ],
    );
    let made: Vec<String> = folder
        .names()
        .into_iter()
        .filter(|name| name.starts_with("out") || name.starts_with("pictures"))
        .collect();
    assert_eq!(
        made,
        [
            "out/",
            "out/deep/",
            "out/deep/last.obj",
            "out/deep/spot.obj",
            "out/last.json",
            "out/spot.json",
            "pictures/",
            "pictures/last.png",
            "pictures/spot.png"
        ]
    );
    let before = folder.names();
    folder
        .run(&[
            "warp",
            "spot.obj",
            "./spot.obj",
            "-r",
            "twist.toml",
            "-o",
            "other/",
        ])
        .failed(2, &["spot.obj: two results would be written there"]);
    for output in ["out.obj", "-"] {
        folder
            .run(&[&all[..], &["-o", output]].concat())
            .failed(2, &["several models need a folder for --output: "]);
    }
    for extra in [["--report", "r.json"], ["--preview", "p.png"]] {
        folder
            .run(&[&all[..], &["-o", "other/"], &extra].concat())
            .failed(2, &["several models need a folder for --", "/`"]);
    }
    assert_eq!(folder.names(), before);
}

#[test]
fn standard_streams_stand_for_files() {
    let folder = folder();
    folder.put("points.csv", "x,y,note\n0,1,\"a\nb\"\n2.50,3,c\n");
    folder
        .run(&["warp", "spot.obj", "-r", "twist.toml", "-o", "out.obj"])
        .done();
    let expected = folder.read("out.obj");
    let to_stream = ["-r", "twist.toml", "-o", "-"];
    let run = folder.run_with(&fixture(SPOT), &[&["warp", "-"], &to_stream[..]].concat());
    assert!(run.done().out == expected);
    let run = folder.run(&[&["warp", "spot.obj"], &to_stream[..]].concat());
    assert!(run.done().out == expected);
    let run = folder.run_with(
        TWIST.as_bytes(),
        &["warp", "spot.obj", "-r", "-", "-o", "-", "-q"],
    );
    assert!(run.clone().done().out == expected);
    assert_eq!(run.err, "");
    let points = folder.read("points.csv");
    let run = folder.run_with(&points, &["warp", "-", "-r", "empty.toml", "-o", "-"]);
    assert!(run.done().out == points);
    let run = folder.run_with(&points, &["inspect", "-", "--json"]);
    assert_eq!(run.done().json()[0]["file"], "standard input");
    let run = folder.run_with(b"version = 1\nwrap = 1\n", &["check", "-"]);
    run.failed(
        1,
        &["standard input:2:1: wrap: unknown key `wrap`; did you mean `warp`?"],
    );

    for (arguments, says) in [
        (vec!["warp", "-", "-r", "-", "-o", "-"], "only once"),
        (
            vec!["warp", "-", "-", "-r", "empty.toml", "-o", "out/"],
            "only once",
        ),
        (vec!["check", "-", "--model", "-"], "only once"),
        (vec!["inspect", "-", "-"], "only once"),
        (
            vec!["warp", "-", "-r", "empty.toml", "-o", "out/"],
            "has no name; name the output file",
        ),
        (
            vec![
                "warp",
                "spot.obj",
                "-r",
                "empty.toml",
                "-o",
                "o.obj",
                "--report",
                "-",
            ],
            "only the model",
        ),
        (
            vec![
                "warp",
                "spot.obj",
                "-r",
                "empty.toml",
                "-o",
                "o.obj",
                "--preview",
                "-",
            ],
            "only the model",
        ),
    ] {
        folder.run(&arguments).failed(2, &[says]);
    }
    folder
        .run(&["warp", "-", "-r", "empty.toml", "-o", "-"])
        .failed(1, &["standard input: there is nothing in it"]);
}

/// Who stops reading is no error, as for other tools in a pipe.
#[test]
fn a_closed_pipe_ends_quietly() {
    let folder = folder();
    for arguments in [
        vec!["warp", "spot.obj", "-r", "twist.toml", "-o", "-", "-q"],
        vec!["inspect", "spot.obj"],
        vec!["check", "twist.toml", "--json"],
        vec!["list", "warps"],
        vec!["schema"],
        vec!["man"],
        vec!["completions", "bash"],
    ] {
        let mut command = folder.command(&arguments);
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let run = folder.finish(command.stdout(writer), b"");
        assert_eq!((run.code, run.err.as_str()), (0, ""), "{arguments:?}");
    }
    // Nor is one that does not want to hear of errors: this used to be a panic.
    for (arguments, code) in [
        (
            vec!["warp", "spot.obj", "-r", "twist.toml", "-o", "out.obj"],
            0,
        ),
        (vec!["inspect", "nowhere.obj"], 1),
        (vec!["warp", "spot.obj"], 2),
    ] {
        let mut command = folder.command(&arguments);
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        assert_eq!(
            folder.finish(command.stderr(writer), b"").code,
            code,
            "{arguments:?}"
        );
    }
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    use std::os::unix::fs::{PermissionsExt, symlink};
    use std::path::Path;

    fn permit(path: &Path, mode: u32) {
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode)).unwrap();
    }

    fn mode(path: &Path) -> u32 {
        std::fs::metadata(path).unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn links_stay_links_and_permissions_stay() {
        let folder = folder();
        let at = |name: &str| folder.path().join(name);
        folder.put("real.obj", "mine");
        permit(&at("real.obj"), 0o640);
        symlink("real.obj", at("link.obj")).unwrap();
        symlink("missing.obj", at("dangling.obj")).unwrap();
        let warp = |output: &str, force: &[&str]| {
            folder.run(
                &[
                    &["warp", "spot.obj", "-r", "twist.toml", "-o", output],
                    force,
                ]
                .concat(),
            )
        };
        warp("link.obj", &[]).failed(1, &["link.obj: exists already"]);
        warp("dangling.obj", &[]).failed(1, &["dangling.obj: exists already"]);
        assert_eq!(folder.read("real.obj"), b"mine");
        warp("link.obj", &["--force"]).done();
        assert!(at("link.obj").symlink_metadata().unwrap().is_symlink());
        assert!(folder.read("real.obj").starts_with(b"v "));
        assert_eq!(mode(&at("real.obj")), 0o640);
        // A new file is as any other new file.
        warp("new.obj", &[]).done();
        std::fs::write(at("other"), "").unwrap();
        assert_eq!(mode(&at("new.obj")), mode(&at("other")));
        // A model that may only be read can be read.
        permit(&at("spot.obj"), 0o444);
        warp("again.obj", &[]).done();
    }

    #[test]
    fn a_folder_that_may_not_be_written_to_is_named() {
        let folder = folder();
        let closed = folder.path().join("closed");
        std::fs::create_dir(&closed).unwrap();
        permit(&closed, 0o555);
        // The superuser may write anywhere; then another place stands in where the system has one.
        let permitted = std::fs::write(closed.join("probe"), "").is_ok();
        if !permitted {
            folder
                .run(&[
                    "warp",
                    "spot.obj",
                    "-r",
                    "twist.toml",
                    "-o",
                    "closed/out.obj",
                ])
                .failed(
                    1,
                    &["closed/out.obj: cannot write: ", "; check the permissions"],
                );
            folder
                .run(&["warp", "spot.obj", "-r", "twist.toml", "-o", "closed/new/"])
                .failed(
                    1,
                    &[
                        "closed/new",
                        "cannot make the folder: ",
                        "; check the permissions",
                    ],
                );
        } else if Path::new("/proc/self").is_dir() {
            folder
                .run(&[
                    "warp",
                    "spot.obj",
                    "-r",
                    "twist.toml",
                    "-o",
                    "/proc/out.obj",
                ])
                .failed(1, &["/proc/out.obj: cannot write: "]);
        }
        permit(&closed, 0o755);
        assert!(!closed.join("out.obj").exists());
    }

    /// `-o /dev/null --force` used to replace the device by a file.
    #[test]
    fn devices_and_pipes_are_written_to() {
        use std::os::unix::fs::FileTypeExt;
        let folder = folder();
        let arguments = ["warp", "spot.obj", "-r", "twist.toml", "-o"];
        for force in [&[][..], &["--force"]] {
            folder
                .run(&[&arguments[..], &["/dev/null"], force].concat())
                .done();
        }
        let null = std::fs::metadata("/dev/null").unwrap().file_type();
        assert!(null.is_char_device());
        let mut command = folder.command(&[&arguments[..], &["/dev/stdout", "-q"]].concat());
        let run = folder.finish(&mut command, b"").done();
        folder.run(&[&arguments[..], &["out.obj"]].concat()).done();
        assert!(run.out == folder.read("out.obj"));
        if Path::new("/dev/full").exists() {
            folder
                .run(&[&arguments[..], &["/dev/full"]].concat())
                .failed(1, &["/dev/full: cannot write: ", "; make room"]);
            let full = std::fs::OpenOptions::new()
                .write(true)
                .open("/dev/full")
                .unwrap();
            let mut command =
                folder.command(&[&arguments[..], &["-", "--report", "r.json"]].concat());
            let run = folder.finish(command.stdout(full), b"");
            run.failed(1, &["cannot write to standard output: "]);
            assert!(!folder.names().contains(&"r.json".to_owned()));
        }
    }

    #[test]
    fn names_need_not_be_text() {
        let folder = folder();
        let name = OsStr::from_bytes(b"sp\xFFot.obj");
        if std::fs::write(folder.path().join(name), fixture(SPOT)).is_err() {
            // This file system takes text only.
            return;
        }
        let arguments = [
            "-r",
            "twist.toml",
            "-o",
            "out/",
            "--report",
            "out/",
            "--preview",
            "out/",
            "--size",
            "64x36",
        ];
        let mut all = vec![OsStr::new("warp"), name];
        all.extend(arguments.map(OsStr::new));
        let run = folder.run(&all).done();
        assert!(run.err.contains("sp\u{FFFD}ot.obj"), "{}", run.err);
        for made in [&b"sp\xFFot.obj"[..], b"sp\xFFot.json", b"sp\xFFot.png"] {
            assert!(
                folder
                    .path()
                    .join("out")
                    .join(OsStr::from_bytes(made))
                    .exists()
            );
        }
        let run = folder.run(&[OsStr::new("inspect"), name, OsStr::new("--json")]);
        assert_eq!(run.done().json()[0]["counts"]["vertices"], 2930);
        folder
            .run(&[OsStr::new("inspect"), OsStr::from_bytes(b"\xFF")])
            .failed(1, &["\u{FFFD}: cannot read"]);
        // Arguments that must be text are refused as usage.
        let set = [OsStr::new("--set"), OsStr::from_bytes(b"warp.0.angle=\xFF")];
        folder.run(&[&all[..], &set].concat()).failed(2, &["UTF-8"]);
    }
}
