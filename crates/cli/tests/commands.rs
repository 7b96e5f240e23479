//! Usage, help, lists, the schema, `check`, and recipes that are wrong.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;
#[path = "../../recipe/tests/common/validator.rs"]
mod validator;

use common::{EMPTY, Folder, TWIST, fixture, listed, repository};
use serde_json::{Value, json};

const SHELLS: [&str; 5] = ["bash", "elvish", "fish", "powershell", "zsh"];
const COMMANDS: [&str; 7] = [
    "warp",
    "inspect",
    "check",
    "list",
    "schema",
    "completions",
    "man",
];

#[test]
fn wrong_usage_exits_with_2_and_prints_no_result() {
    let folder = Folder::with("valid/spot.obj", &[("twist.toml", TWIST)]);
    let before = folder.names();
    let warp = ["warp", "spot.obj", "-r", "twist.toml", "-o", "out.obj"];
    let threads = "write a whole number from 1 to 1024";
    for (arguments, says) in [
        (vec!["wrap"], "warp"),
        (vec!["warp"], "--recipe"),
        (vec!["warp", "spot.obj", "-r", "twist.toml"], "--output"),
        (vec!["warp", "spot.obj", "-o", "out.obj"], "--recipe"),
        ([&warp[..], &["--threads", "0"]].concat(), threads),
        ([&warp[..], &["--threads", "100000"]].concat(), threads),
        ([&warp[..], &["--threads", "two"]].concat(), threads),
        ([&warp[..], &["--view", "below"]].concat(), "three-quarter"),
        ([&warp[..], &["--nonsense"]].concat(), "--nonsense"),
        (vec!["list"], "<KIND>"),
        (vec!["list", "things"], "falloffs"),
        (vec!["inspect"], "<FILE>"),
        (vec!["check"], "<RECIPE>"),
        (
            vec!["check", "twist.toml", "--plane", "--model", "spot.obj"],
            "--plane",
        ),
        (vec!["completions", "tcsh"], "bash"),
    ] {
        let run = folder.run(&arguments).failed(2, &[says]);
        assert_eq!(run.out, b"", "{arguments:?}");
    }
    // Without a word, help is what is asked for; but nothing was done.
    let run = folder.run::<&str>(&[]);
    assert_eq!((run.code, run.out.len()), (2, 0));
    assert!(run.err.contains("Usage: anamorph <COMMAND>"));
    assert_eq!(folder.names(), before);
}

#[test]
fn help_version_completions_and_manual() {
    let folder = Folder::new();
    let help = folder.run(&["--help"]).done().text();
    let manual = folder.run(&["man"]).done().text();
    for command in COMMANDS {
        assert!(help.contains(&format!("  {command} ")), "{command}: {help}");
        for flag in ["-h", "--help"] {
            let text = folder.run(&[command, flag]).done().text();
            assert!(
                text.contains(&format!("Usage: anamorph {command}")),
                "{text}"
            );
        }
        let title = format!(".TH anamorph-{command} 1");
        assert!(manual.contains(&title), "{title} in {manual}");
    }
    // Each option has its paragraph, each page the full name of its command.
    for words in [
        r"\fBanamorph warp\fR",
        r"\fB\-\-allow\-nonfinite\fR",
        r"\fB\-\-size\fR",
    ] {
        assert!(manual.contains(words), "{words} in {manual}");
    }
    let version = folder.run(&["--version"]).done().text();
    assert_eq!(version, format!("anamorph {}\n", env!("CARGO_PKG_VERSION")));
    for shell in SHELLS {
        let text = folder.run(&["completions", shell]).done().text();
        for words in ["anamorph", "warp", "recipe", "allow-nonfinite"] {
            assert!(text.contains(words), "{shell} lacks {words}");
        }
    }
}

/// The manual is well-formed for the program that shows it, where there is one.
#[cfg(unix)]
#[test]
fn the_manual_renders() {
    let folder = Folder::new();
    folder.put("anamorph.1", folder.run(&["man"]).done().out);
    let shown = std::process::Command::new("man")
        .args(["--warnings", "-E", "UTF-8", "-l", "anamorph.1"])
        .env("MANWIDTH", "100")
        .env("LC_ALL", "C.UTF-8")
        .current_dir(folder.path())
        .output();
    let Ok(shown) = shown else { return };
    if !shown.status.success() {
        // Not a `man` that takes files.
        return;
    }
    assert_eq!(String::from_utf8_lossy(&shown.stderr), "");
    let text = String::from_utf8_lossy(&shown.stdout).into_owned();
    assert!(text.contains("--allow-nonfinite"), "{text}");
}

#[test]
fn lists_are_complete_and_agree_with_their_json() {
    let folder = Folder::new();
    for kind in ["warps", "fields", "falloffs", "formats"] {
        let text = folder.run(&["list", kind]).done().text();
        let list = folder.run(&["list", kind, "--json"]).done().json();
        let list = list.as_array().unwrap();
        assert_eq!(text.lines().count(), list.len(), "{kind}");
        assert!(list.len() >= 2, "{kind}");
        for (line, entry) in text.lines().zip(list) {
            let name = entry
                .get("kind")
                .or(entry.get("name"))
                .unwrap()
                .as_str()
                .unwrap();
            assert!(line.starts_with(&format!("{name} ")), "{line}");
        }
    }
}

#[test]
fn committed_recipes_satisfy_the_schema_and_do_what_they_say() {
    let folder = Folder::with("valid/spot.obj", &[]);
    let mut points = String::from("x,y\n");
    for i in 0..100 {
        points.push_str(&format!("{},{}\n", i % 10, i / 10));
    }
    folder.put("points.csv", points);
    let schema = folder.run(&["schema"]).done().json();
    assert!(schema["$schema"].is_string());
    for file in listed("docs/recipes", ".obj") {
        let bytes = std::fs::read(repository("docs/recipes").join(&file)).unwrap();
        folder.put(&file, bytes);
    }
    for name in listed("docs/recipes", ".toml") {
        let text = std::fs::read_to_string(repository("docs/recipes").join(&name)).unwrap();
        folder.put(&name, &text);
        let recipe = anamorph_recipe::Recipe::read(text.as_bytes(), &name).unwrap();
        let tree = Value::Object(recipe.tree().clone());
        assert!(
            validator::validate(&tree, &schema, &schema).is_some(),
            "{name}"
        );
        // The same as JSON, and through a check on a real model.
        let json = format!("{name}.json");
        folder.put(&json, tree.to_string());
        if recipe.is_motion() {
            for recipe in [&name, &json] {
                folder.run(&["check", recipe]).done();
                let out = format!("{recipe}.csv");
                folder.run(&["motion", recipe, "-o", &out]).done();
                assert!(folder.read(&out).len() > 1000, "{recipe}");
            }
            assert!(folder.read(&format!("{name}.csv")) == folder.read(&format!("{json}.csv")));
            continue;
        }
        let (plane, model) = if text.lines().any(|line| line.contains("in the plane")) {
            (true, "points.csv")
        } else {
            (false, "spot.obj")
        };
        for recipe in [&name, &json] {
            let alone = ["check", recipe, "--plane"];
            folder.run(&alone[..if plane { 3 } else { 2 }]).done();
            folder.run(&["check", recipe, "--model", model]).done();
            let out = format!("{recipe}.out");
            folder
                .run(&["warp", model, "-r", recipe, "-o", &out])
                .done();
            assert!(
                folder.read(&out) != folder.read(model),
                "{name} moves nothing"
            );
        }
        assert!(folder.read(&format!("{name}.out")) == folder.read(&format!("{json}.out")));
        // And what the schema must refuse, it refuses.
        let mut wrong = tree;
        wrong["warp"][0]["nonsense"] = json!(1);
        assert!(
            validator::validate(&wrong, &schema, &schema).is_none(),
            "{name}"
        );
    }
}

#[test]
fn check_says_what_is_promised() {
    let folder = Folder::with(
        "valid/spot.obj",
        &[("twist.toml", TWIST), ("empty.toml", EMPTY)],
    );
    let plane = "version = 1\n[[warp]]\nkind = \"lattice\"\nshape = [3, 3]\nmove = [{ index = [\"*\", -1], by = [\"50%\", 0] }]\n";
    folder
        .put("plane.toml", plane)
        .put("points.csv", "x,y\n0,0\n1,0\n1,1\n0,1\n");
    for (arguments, on) in [
        (vec!["twist.toml"], "a cube from -1 to 1"),
        (vec!["twist.toml", "--model", "spot.obj"], "spot.obj"),
        (vec!["plane.toml", "--plane"], "a square from -1 to 1"),
        (vec!["plane.toml", "--model", "points.csv"], "points.csv"),
    ] {
        let all = [&["check"], &arguments[..]].concat();
        let text = folder.run(&all).done().text();
        assert!(
            text.contains(&format!("{} on {on}", arguments[0])),
            "{text}"
        );
        let value = folder.run(&[&all[..], &["--json"]].concat()).done().json();
        let warp = &value[0]["warps"][0];
        let mut properties = Vec::new();
        for guarantee in warp["guarantees"].as_array().unwrap() {
            let verdict = guarantee["verdict"].as_str().unwrap();
            assert!(["proved", "refuted", "unknown"].contains(&verdict));
            let property = guarantee["property"].as_str().unwrap();
            assert!(text.contains(property) && text.contains(verdict), "{text}");
            properties.push(property.to_owned());
        }
        assert_eq!(
            properties,
            [
                "interpolation",
                "coverage",
                "continuity",
                "no fold",
                "invertibility"
            ]
        );
    }
    let text = folder.run(&["check", "empty.toml"]).done().text();
    assert!(text.contains("no warp: nothing moves"), "{text}");
    // A fold is shown with the place.
    let fold = folder.run(&[
        "check",
        "plane.toml",
        "--plane",
        "--json",
        "--set",
        "warp.0.move.0.by=[0, \"-300%\"]",
    ]);
    let fold = fold.done().json();
    let no_fold = &fold[0]["warps"][0]["guarantees"][3];
    assert_eq!(no_fold["verdict"], "refuted", "{no_fold}");
    assert!(no_fold["witness"]["value"].as_f64().unwrap() <= 0.0);
    assert_eq!(no_fold["witness"]["place"].as_array().unwrap().len(), 2);
    // Of several recipes the good ones are answered.
    let run = folder.run(&[
        "check",
        "twist.toml",
        "nowhere.toml",
        "empty.toml",
        "--json",
    ]);
    assert_eq!(
        run.failed(1, &["nowhere.toml: cannot read"])
            .json()
            .as_array()
            .unwrap()
            .len(),
        2
    );
    folder.run(&["check", "twist.toml", "--plane"]).failed(
        1,
        &["twist.toml:3:8: warp.0.kind: the warp `twist` works only in space"],
    );
}

/// Each message names the file, the line and column, the place in the recipe, and what to do.
#[test]
fn wrong_recipes_are_refused_where_they_are_wrong() {
    let head = "version = 1\n[[warp]]\nkind = \"twist\"\naxis = \"y\"\n";
    let deep = format!("a = {}", "[".repeat(10_000));
    let cases = [
        ("version = 1\nwarp = ", "r.toml:2:", ""),
        (
            "[[warp]]\nkind = \"twist\"\n",
            "r.toml:1:1: version: the recipe does not say its version",
            "write `version = 1`",
        ),
        (
            "version = 2\n",
            "r.toml:1:11: version: version 2",
            "the version is 1",
        ),
        (
            "version = 1\nkind = \"twist\"\n",
            "r.toml:2:1: kind: this stands outside of any warp",
            "[[warp]]",
        ),
        (
            "version = 1\n[warp]\nkind = \"twist\"\n",
            "r.toml:2:",
            "two brackets",
        ),
        (
            "version = 1\n[[warp]]\nkind = \"twsit\"\n",
            "r.toml:3:8: warp.0.kind: no warp is called `twsit`",
            "did you mean `twist`?",
        ),
        (
            "version = 1\n[[warp]]\nkind = 3\n",
            "r.toml:3:8: warp.0.kind: the kind is a word in quotes",
            "",
        ),
        (
            "version = 1\n[[warp]]\n",
            "r.toml:2:1: warp.0.kind: the warp does not say its kind",
            "add one",
        ),
        (
            &format!("{head}angle = 30\n"),
            "r.toml:5:9: warp.0.angle: an angle needs its unit",
            "\"30deg\"",
        ),
        (
            &format!("{head}angel = \"3deg\"\n"),
            "r.toml:5:1: warp.0.angel: unknown key `angel`",
            "did you mean `angle`?",
        ),
        (
            &format!("{head}angle = \"\u{e9}deg\"\n"),
            "r.toml:5:9: warp.0.angle: `\u{e9}deg` is not an angle",
            "45deg",
        ),
        (
            &format!("{head}angle = nan\n"),
            "r.toml:5:9: warp.0.angle: ",
            "finite",
        ),
        (&head.replace("\"y\"", "[0, 0, 0]"), "r.toml:", ""),
        (
            "version = 1\n[[warp]]\nkind = \"twist\"\nangle = \"1deg\"\n",
            "r.toml:2:1: warp.0: `axis` is missing",
            "add `axis`",
        ),
        (
            &format!("version = 1\n{deep}\n"),
            "nested deeper than 64",
            "",
        ),
        (
            &format!("{head}angle = \"9deg\"\nmask = {{ field = \"radial\" }}\n"),
            "r.toml:6:8: warp.0.mask",
            "add `centre`",
        ),
        (
            &format!(
                "{head}angle = \"9deg\"\nmask = {{ field = \"attribute\", name = \"heat\" }}\n"
            ),
            "r.toml:6:",
            "",
        ),
        (
            &format!("{head}angle = \"9deg\"\nmask = 2\n"),
            "r.toml:6:8: warp.0.mask: the mask is 2 everywhere",
            "from 0 to 1",
        ),
        (
            &format!("{head}angle = \"9deg\"\nangle = \"9deg\"\n"),
            "r.toml:6:1: ",
            "",
        ),
        (
            "{ \"version\": 1, \"warp\": [{ \"kind\": \"twist\", } ] }",
            "r.toml:1:",
            "",
        ),
        (
            "{ \"version\": 1,\n \"warp\": [{ \"kind\": \"twist\", \"axs\": \"y\" }] }",
            "r.toml:2:30: warp.0.axs: unknown key",
            "axis",
        ),
        (
            "",
            "r.toml:1:1: version: the recipe does not say its version",
            "",
        ),
    ];
    for (text, place, mend) in cases {
        let folder = Folder::with("valid/spot.obj", &[("r.toml", text)]);
        let before = folder.names();
        let shown: String = text.chars().take(200).collect();
        let arguments = [
            "warp", "spot.obj", "-r", "r.toml", "-o", "out/", "--report", "out/",
        ];
        let run = folder.run(&arguments).failed(1, &[place, mend]);
        for line in run.err.lines() {
            assert!(line.starts_with("error: r.toml:"), "{shown}: {line}");
            assert!(line.chars().count() < 1500, "{shown}: {line}");
        }
        assert_eq!(folder.names(), before, "{shown}");
        let arguments = ["check", "r.toml", "--model", "spot.obj"];
        folder.run(&arguments).failed(1, &[place, mend]);
    }
    let folder = Folder::with("valid/spot.obj", &[]);
    for (bytes, says) in [
        (b"\xFF\xFEv\0".to_vec(), "r.toml"),
        (b"version = 1\nname = \"\xFF\"\n".to_vec(), "r.toml"),
        (fixture("valid/spot.obj"), "r.toml:1:"),
        (vec![0; 1000], "r.toml"),
    ] {
        folder.put("r.toml", bytes);
        folder
            .run(&["warp", "spot.obj", "-r", "r.toml", "-o", "out.obj"])
            .failed(1, &[says]);
    }
}

/// Thousands of wrong warps are counted, not listed, and take no longer than they must.
#[test]
fn very_many_problems_are_counted() {
    let mut text = String::from("version = 1\n");
    text.push_str(&"[[warp]]\nkind = \"twist\"\naxis = \"y\"\nangel = \"1deg\"\n".repeat(5000));
    let folder = Folder::with("valid/tm-singlevn.obj", &[("r.toml", &text)]);
    let run = folder.run(&["warp", "tm-singlevn.obj", "-r", "r.toml", "-o", "out.obj"]);
    let run = run.failed(
        1,
        &["r.toml:5:1: warp.0.angel: unknown key", "r.toml: and "],
    );
    assert_eq!(run.err.lines().count(), 11);
    // And a long stack that is right is named by its first warps.
    let long = text.replace("angel", "angle").replace("\"y\"", "\"x\"");
    let long: Vec<&str> = long.lines().take(1 + 4 * 100).collect();
    folder.put("long.toml", long.join("\n"));
    let run = folder
        .run(&[
            "warp",
            "tm-singlevn.obj",
            "-r",
            "long.toml",
            "-o",
            "out.obj",
        ])
        .done();
    assert!(
        run.err
            .contains("twist, twist, twist, twist, twist, twist, twist, twist and "),
        "{}",
        run.err
    );
    assert!(run.err.len() < 500);
}

#[test]
fn nonsense_in_set_is_refused() {
    let folder = Folder::with("valid/spot.obj", &[("twist.toml", TWIST)]);
    let long = format!("warp.0.{0}={0}", "a".repeat(50_000));
    let deep = format!("{}x=1", "a.".repeat(10_000));
    for (set, says) in [
        ("", "there is no `=`"),
        ("=", "a word of the path is empty"),
        ("warp.0.angle", "there is no `=`; write path=value"),
        ("warp..angle=1deg", "a word of the path is empty"),
        ("warp.0.angle=", "is not an angle"),
        (
            "warp.0.angle=30",
            "an angle needs its unit, and 30 has none; write \"30deg\"",
        ),
        ("warp.0.angle=1e999deg", "is not an angle"),
        ("warp.0.angle=inf", "not a finite number"),
        ("warp.0.angle=[[[[", "not a complete TOML value"),
        ("warp.0.angle=\"3deg", "not a complete TOML value"),
        ("warp.0.angel=3deg", "did you mean `angle`?"),
        ("warp.7.angle=3deg", "`warp` has one entry, number 0"),
        ("warp.-1.angle=3deg", "`warp` has one entry"),
        (
            "warp.99999999999999999999.angle=3deg",
            "`warp` has one entry",
        ),
        (
            "warp.0.kind.deeper=3",
            "only tables and lists have something inside",
        ),
        ("warp=3", "a list of tables"),
        ("warp.0=3", "a warp is a table"),
        ("version=9", "the version is 1"),
        ("a.b.c=1", "unknown key `a`"),
        ("warp.0.strength=-1e308", "not finite"),
        ("warp.0.range=[\"100%\", \"0%\"]", "warp.0.range: "),
        (&long, "unknown key"),
        (&deep, "longer than 64 words"),
    ] {
        let arguments = [
            "warp",
            "spot.obj",
            "-r",
            "twist.toml",
            "-o",
            "out.obj",
            "--set",
            set,
        ];
        let run = folder.run(&arguments).failed(1, &[says]);
        assert!(run.err.chars().count() < 2000, "{}", run.err);
        assert!(!folder.names().contains(&"out.obj".to_owned()), "{set}");
    }
    let run = folder.run(&[
        "warp",
        "spot.obj",
        "-r",
        "twist.toml",
        "-o",
        "out.obj",
        "--set",
        "warp.0.angle=10deg",
        "--set",
        "warp.0.label = hinge",
    ]);
    assert!(run.done().err.contains("out.obj: hinge; "));
}
