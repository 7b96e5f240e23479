//! glTF from the command: files beside a model, damaged files, notes, spaces.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::{EMPTY, Folder, TWIST, fixture, listed};

/// Every damaged glTF: what the message says.
const DAMAGED: &[(&str, &str)] = &[
    (
        "as-box-with-infinites.glb",
        "accessors[2] has a NaN or infinite coordinate; mend it in the model, or pass such points through (--allow-nonfinite)",
    ),
    (
        "as-index-out-of-range.gltf",
        "buffers[0] cannot be read; ./IndexOutOfRange.bin: ",
    ),
    (
        "as-recursive-nodes.gltf",
        "nodes[0] is among its own ancestors",
    ),
    (
        "gltf-accessor-count-huge.gltf",
        "accessors[0] has 4294967295 elements every 12 bytes from byte 0, and buffer view 0 has 36 bytes",
    ),
    ("gltf-deep-json.gltf", "the JSON is no table of keys"),
    (
        "gv-accessor-data-invalid-elements-float.gltf",
        "there are no meshes with positions in it",
    ),
    (
        "gv-accessor-invalid-sparse-count-and-stride.gltf",
        "accessors[0] replaces 2 of 1 elements",
    ),
    (
        "gv-buffer-invalid-uri-data.gltf",
        "there are no meshes with positions in it",
    ),
    (
        "gv-buffer-view-invalid-length.gltf",
        "bufferViews[0] has 5 bytes from byte 0, and buffer 0 has 4",
    ),
    (
        "gv-glb-chunk-too-big.glb",
        "the header says that the file has 13 bytes, and it has 48",
    ),
    ("gv-glb-empty-file.glb", "there is nothing in it"),
    ("gv-glb-invalid-magic.glb", "does not begin with `glTF`"),
    (
        "gv-glb-length-mismatch.glb",
        "the header says that the file has 49 bytes, and it has 48",
    ),
    (
        "gv-glb-truncated-chunk-data.glb",
        "the header says that the file has 48 bytes, and it has 47",
    ),
    (
        "gv-json-invalid-syntax.gltf",
        "line 1, column 2: the JSON has `]` where a key in quotes should be",
    ),
    (
        "gv-mesh-accessor-unequal-count.gltf",
        "COLOR_0 of meshes[0].primitives[0] has 4 elements for 3 vertices",
    ),
    (
        "gv-mesh-data-index-buffer-degenerate-triangle.gltf",
        "index_buffer_degenerate_triangle.bin: ",
    ),
    (
        "gv-mesh-data-index-buffer-oob.gltf",
        "index_buffer_oob.bin: ",
    ),
    (
        "gv-mesh-morph-attribute-invalid-count.gltf",
        "POSITION of target 0 of meshes[0].primitives[0] has 4 elements for 3 vertices",
    ),
    (
        "gv-mesh-morph-unequal-targets-count.gltf",
        "meshes[0].primitives[1] has 1 morph targets, and the primitives before it have 2",
    ),
    (
        "gv-node-node-loop.gltf",
        "nodes[0] is among its own ancestors",
    ),
];

#[test]
fn damaged_models_are_refused_with_one_clear_message() {
    let mut known = listed("tests/fixtures/damaged", ".glb");
    known.extend(listed("tests/fixtures/damaged", ".gltf"));
    known.sort();
    assert_eq!(known, DAMAGED.iter().map(|case| case.0).collect::<Vec<_>>());
    for (name, says) in DAMAGED {
        let folder = Folder::with(&format!("damaged/{name}"), &[("twist.toml", TWIST)]);
        let before = folder.names();
        let run = folder
            .run(&["warp", name, "-r", "twist.toml", "-o", "out/"])
            .failed(1, &[says]);
        assert_eq!(run.err.lines().count(), 1, "{}", run.err);
        assert_eq!(folder.names(), before, "{name} leaves something behind");
    }
}

#[test]
fn nothing_to_do_changes_nothing() {
    let mut names = listed("tests/fixtures/valid", ".glb");
    names.extend(listed("tests/fixtures/valid", ".gltf"));
    for name in names {
        let folder = beside(&name);
        folder
            .run(&["warp", &name, "-r", "empty.toml", "-o", "out/"])
            .done();
        assert!(
            folder.read(&format!("out/{name}")) == fixture(&format!("valid/{name}")),
            "{name}"
        );
    }
}

/// A folder with a model, the files beside it, and recipes.
fn beside(name: &str) -> Folder {
    let folder = Folder::with(
        &format!("valid/{name}"),
        &[("twist.toml", TWIST), ("empty.toml", EMPTY)],
    );
    if name == "gltf-external.gltf" {
        for other in ["gltf-external.bin", "gltf-external.png"] {
            folder.put(other, fixture(&format!("valid/{other}")));
        }
    }
    folder
}

#[test]
fn files_beside_a_model_go_with_it() {
    let folder = beside("gltf-external.gltf");
    let warp = |output: &str, more: &[&str]| {
        let mut arguments = vec![
            "warp",
            "gltf-external.gltf",
            "-r",
            "twist.toml",
            "-o",
            output,
        ];
        arguments.extend(more);
        folder.run(&arguments)
    };
    let run = warp("out/", &[]).done();
    assert!(
        run.err
            .contains("gltf-external.bin was copied with the model"),
        "{}",
        run.err
    );
    for other in ["gltf-external.bin", "gltf-external.png"] {
        assert!(folder.read(&format!("out/{other}")) == fixture(&format!("valid/{other}")));
    }
    folder.run(&["inspect", "out/gltf-external.gltf"]).done();
    // In the same folder there is nothing to copy; the same files again are no obstacle, other ones are.
    let run = warp("again.gltf", &[]).done();
    assert!(!run.err.contains("copied"), "{}", run.err);
    warp("out/second.gltf", &[]).done();
    folder.put("out/gltf-external.png", b"another picture");
    let before = folder.names();
    warp("out/third.gltf", &[]).failed(1, &["out/gltf-external.png", "differs", "--force"]);
    assert_eq!(folder.names(), before);
    warp("out/third.gltf", &["--force"]).done();
    assert!(folder.read("out/gltf-external.png") == fixture("valid/gltf-external.png"));
    // A picture that is missing keeps nobody from warping.
    std::fs::remove_file(folder.path().join("gltf-external.png")).unwrap();
    let run = warp("new/", &[]).done();
    assert!(
        run.err
            .contains("refers to gltf-external.png, which is not"),
        "{}",
        run.err
    );
    // A buffer that is missing does.
    std::fs::remove_file(folder.path().join("gltf-external.bin")).unwrap();
    let before = folder.names();
    warp("none/", &[]).failed(1, &["buffers[0] cannot be read", "gltf-external.bin"]);
    assert_eq!(folder.names(), before);
}

#[test]
fn files_outside_of_the_folder_need_leave() {
    let text = String::from_utf8(fixture("valid/gltf-external.gltf")).unwrap();
    let folder = Folder::new();
    std::fs::create_dir(folder.path().join("inner")).unwrap();
    let data = fixture("valid/gltf-external.bin");
    folder.put("data.bin", &data).put("empty.toml", EMPTY);
    let absolute = folder.path().join("data.bin");
    let absolute = absolute.to_str().unwrap().replace('\\', "/");
    for (file, name) in [
        ("up.gltf", "../data.bin"),
        ("root.gltf", &absolute),
        ("hidden.gltf", "x/%2E%2E/..%2Fdata.bin"),
    ] {
        folder.put(
            &format!("inner/{file}"),
            text.replace("gltf%2Dexternal.bin", name),
        );
        let model = format!("inner/{file}");
        folder
            .run(&["inspect", &model])
            .failed(1, &["outside of the model's folder", "--allow-outside"]);
        folder
            .run(&["check", "empty.toml", "--model", &model])
            .failed(1, &["--allow-outside"]);
        let warp = ["warp", &model, "-r", "empty.toml", "-o", "out/"];
        folder.run(&warp).failed(1, &["--allow-outside"]);
        if file != "hidden.gltf" {
            folder.run(&["inspect", &model, "--allow-outside"]).done();
        }
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../data.bin", folder.path().join("inner/link.bin")).unwrap();
        folder.put(
            "inner/link.gltf",
            text.replace("gltf%2Dexternal.bin", "link.bin"),
        );
        folder
            .run(&["inspect", "inner/link.gltf"])
            .failed(1, &["is a link to", "--allow-outside"]);
        folder
            .run(&["inspect", "inner/link.gltf", "--allow-outside"])
            .done();
        // What never ends is no file.
        folder.put(
            "inner/zero.gltf",
            text.replace("gltf%2Dexternal.bin", "/dev/zero"),
        );
        folder
            .run(&["inspect", "inner/zero.gltf", "--allow-outside"])
            .failed(1, &["is no file"]);
    }
    // Standard input has no folder.
    let run = folder.run_with(text.as_bytes(), &["inspect", "-"]);
    run.failed(1, &["standard input has no folder"]);
}

#[test]
fn a_recipe_chooses_its_space() {
    let folder = beside("gltf-instances.glb");
    folder.put("local.toml", format!("space = \"local\"\n{TWIST}"));
    let meshes = |recipe: &str, out: &str| {
        folder
            .run(&[
                "warp",
                "gltf-instances.glb",
                "-r",
                recipe,
                "-o",
                out,
                "--report",
                "report.json",
                "--force",
            ])
            .done();
        let inspected = folder.run(&["inspect", "--json", out]).done().json();
        inspected[0]["counts"]["meshes"].as_u64().unwrap()
    };
    assert_eq!(meshes("twist.toml", "world.glb"), 5);
    let report = folder.json("report.json");
    assert_eq!(report["points"]["count"], 144);
    assert_eq!(meshes("local.toml", "local.glb"), 3);
    let report = folder.json("report.json");
    assert_eq!(report["points"]["count"], 72);
    assert!(
        report["notes"][0]
            .as_str()
            .unwrap()
            .contains("own coordinates")
    );
    folder
        .run(&["check", "local.toml", "--model", "gltf-instances.glb"])
        .done();
    folder.put("odd.toml", format!("space = \"screen\"\n{TWIST}"));
    folder
        .run(&[
            "warp",
            "gltf-instances.glb",
            "-r",
            "odd.toml",
            "-o",
            "odd.glb",
        ])
        .failed(
            1,
            &[
                "odd.toml:1:9: space: the text \"screen\" is no space",
                "\"local\"",
            ],
        );
}

#[test]
fn notes_are_printed_and_reported() {
    let folder = beside("gltf-skinned-morph.glb");
    let arguments = [
        "warp",
        "gltf-skinned-morph.glb",
        "-r",
        "twist.toml",
        "-o",
        "out.glb",
        "--report",
        "r.json",
        "--preview",
        "p.png",
    ];
    let run = folder.run(&arguments).done();
    assert!(
        run.err
            .contains("note: skinned meshes are warped in their bind pose"),
        "{}",
        run.err
    );
    assert!(run.err.contains(" of 108 points moved"), "{}", run.err);
    assert!(
        folder.json("r.json")["notes"][0]
            .as_str()
            .unwrap()
            .contains("bind pose")
    );
    let text = folder.run(&["inspect", "out.glb"]).done().text();
    assert!(
        text.contains("morph targets        2") && text.contains("bind pose"),
        "{text}"
    );
    // Another format is told what it cannot hold, and gets the rest.
    let converted = [
        "warp",
        "gltf-skinned-morph.glb",
        "-r",
        "twist.toml",
        "-o",
        "out.obj",
    ];
    let run = folder.run(&converted).done();
    assert!(
        run.err
            .contains("warning: OBJ cannot hold: 2 morph targets, 1 skin, 1 animation"),
        "{}",
        run.err
    );
    assert!(run.err.contains("96 of 108 points moved"), "{}", run.err);
    let obj = String::from_utf8(folder.read("out.obj")).unwrap();
    assert_eq!(obj.matches("\nvn ").count(), 108);
}

/// A model that names its own output, or the recipe, as a file beside it cannot make a copy replace it.
#[test]
fn companions_replace_nothing_of_the_run() {
    let folder = beside("gltf-skinned-morph.glb");
    let model = |image: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"images":[{{"uri":"{image}"}}],"nodes":[{{"mesh":0}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[0,0,0]}}],
"bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36,
"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"}}]}}"#
        )
    };
    std::fs::create_dir(folder.path().join("in")).unwrap();
    std::fs::create_dir(folder.path().join("out")).unwrap();
    folder.put("out/r.toml", "version = 1\n");
    for name in ["r.toml", "m.gltf", "p.png"] {
        folder.put("in/m.gltf", model(name));
        if name != "m.gltf" {
            folder.put(&format!("in/{name}"), "COMPANION");
        }
        let arguments = [
            "warp",
            "in/m.gltf",
            "-r",
            "out/r.toml",
            "-o",
            "out/m.gltf",
            "--preview",
            "out/p.png",
            "--force",
        ];
        folder.run(&arguments).failed(
            1,
            &["would be copied to where another file of this run is or goes"],
        );
        assert!(folder.read("out/r.toml") == b"version = 1\n");
        assert!(!folder.path().join("out/m.gltf").exists());
    }
}
