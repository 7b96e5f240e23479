//! Fitting, painted previews, drawings as features, records of frames, and bindings that know what they were made from.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::{Folder, TWIST};
use serde_json::Value;

fn points(folder: &Folder, name: &str) -> Vec<[f64; 3]> {
    let text = String::from_utf8(folder.read(name)).unwrap();
    let rows = text.lines().filter(|l| {
        l.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '.') || l.starts_with("v ")
    });
    rows.map(|row| {
        let numbers = row.trim_start_matches("v ").split([',', ' ']);
        let mut numbers = numbers.filter_map(|n| n.parse::<f64>().ok());
        [(); 3].map(|()| numbers.next().unwrap_or(0.0))
    })
    .collect()
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f64>().sqrt()
}

const CLOUD: &str = "x,y,z\n-1,-1,-1\n1,1,1\n0.2,0.3,0.1\n-0.5,0.4,0.2\n0,0,0\n0.7,-0.6,-0.2\n";

fn fit(kind: &str, more: &str) -> String {
    format!(
        "version = 1\n[[warp]]\nkind = \"{kind}\"\n{more}\n[warp.fit]\n\
         pin = [{{ from = [0.2, 0.3, 0.1], to = [0.5, 0.3, 0.4] }}, {{ from = [-0.5, 0.4, 0.2] }},\n\
         {{ from = [0.7, -0.6, -0.2], by = [0, \"10%\", 0], weight = 3 }}]\n"
    )
}

#[test]
fn pins_are_met_by_every_warp_that_can_be_fitted() {
    let folder = Folder::new();
    folder.put("cloud.csv", CLOUD);
    let far = "point = [{ from = [1, 0, 0] }, { from = [0, 1, 0] }, { from = [0, 0, 1] }, { from = [-1, -1, 0] }]";
    for (kind, more) in [
        ("lattice", "shape = [4, 3, 4]"),
        (
            "lattice",
            "shape = [3, 3, 3]\nmove = [{ index = [0, 1, 2], by = [0.3, 0, 0] }]\nstrength = 0.5",
        ),
        ("spline-lattice", "shape = [5, 5, 5]\nambient = 0.2"),
        ("points", far),
    ] {
        let recipe = fit(kind, more);
        folder.put("fit.toml", &recipe);
        folder
            .run(&[
                "warp",
                "cloud.csv",
                "-r",
                "fit.toml",
                "-o",
                "out.csv",
                "-f",
                "--report",
                "r.json",
            ])
            .done();
        let moved = points(&folder, "out.csv");
        for (index, place) in [
            (2, [0.5, 0.3, 0.4]),
            (3, [-0.5, 0.4, 0.2]),
            (5, [0.7, -0.4, -0.2]),
        ] {
            assert!(apart(moved[index], place) < 1e-9, "{kind} {more}: {index}");
        }
        // Interpolation is judged by the pins.
        let report = folder.json("r.json");
        let found = &report["warps"][0]["guarantees"][0];
        assert_eq!(found["verdict"], "proved", "{found}");
        assert!(
            found["statement"].as_str().unwrap().contains("all 3"),
            "{found}"
        );
    }
    // A stiff lattice misses, and says which pin most.
    folder.put(
        "stiff.toml",
        fit("lattice", "shape = [4, 4, 4]") + "stiffness = 2.0\n",
    );
    let said = folder
        .run(&["check", "stiff.toml", "--model", "cloud.csv"])
        .done();
    assert!(
        said.text().contains("fitted to 3 pins; pin"),
        "{}",
        said.text()
    );
    assert!(said.text().contains("refuted"), "{}", said.text());
    // Files give pins, too.
    folder.put("from.csv", "x,y,z\n0.2,0.3,0.1\n-0.5,0.4,0.2\n");
    folder.put("to.csv", "x,y,z\n0.2,0.9,0.1\n-0.5,0.4,-0.2\n");
    folder.put(
        "files.toml",
        "version = 1\n[[warp]]\nkind = \"lattice\"\nshape = [4, 4, 4]\nfit = { source = \"from.csv\", target = \"to.csv\" }\n",
    );
    folder
        .run(&[
            "warp",
            "cloud.csv",
            "-r",
            "files.toml",
            "-o",
            "out.csv",
            "-f",
        ])
        .done();
    let moved = points(&folder, "out.csv");
    assert!(apart(moved[2], [0.2, 0.9, 0.1]) < 1e-9 && apart(moved[3], [-0.5, 0.4, -0.2]) < 1e-9);
}

#[test]
fn impossible_fits_are_named() {
    let folder = Folder::new();
    folder.put("cloud.csv", CLOUD);
    let lattice = "kind = \"lattice\"\nshape = [4, 4, 4]\n";
    for (table, says) in [
        ("kind = \"twist\"\naxis = \"y\"\nangle = \"1turn\"\nfit = { pin = [{ from = [0, 0, 0] }] }".to_owned(), &["warp.0.fit", "not linear"][..]),
        (format!("{lattice}fit = {{}}"), &["warp.0.fit", "no pin"]),
        (format!("{lattice}fit = {{ pins = [] }}"), &["warp.0.fit.pins", "did you mean `pin`"]),
        (format!("{lattice}fit = {{ pin = [{{ from = [9, 9, 9], to = [8, 8, 8] }}] }}"), &["warp.0.fit.pin.0", "no feature"]),
        (format!("{lattice}fit = {{ pin = [{{ from = [0, 0, 0], weight = 0 }}] }}"), &["warp.0.fit.pin.0", "weight"]),
        (format!("{lattice}fit = {{ stiffness = -1, pin = [{{ from = [0, 0, 0] }}] }}"), &["warp.0.fit.stiffness"]),
        (format!("{lattice}fit = {{ source = \"cloud.csv\" }}"), &["warp.0.fit.source", "no `target`"]),
        (format!("{lattice}fit = {{ pin = [{{ from = [0, 0, 0], to = [1, 0, 0], by = [1, 0, 0] }}] }}"), &["both `to` and `by`"]),
    ] {
        folder.put("bad.toml", format!("version = 1\n[[warp]]\n{table}\n"));
        folder
            .run(&["warp", "cloud.csv", "-r", "bad.toml", "-o", "out.csv"])
            .failed(1, says);
    }
}

#[test]
fn numbers_are_painted_on_the_model() {
    let folder = Folder::with("valid/spot.obj", &[("twist.toml", TWIST)]);
    let warp = |field: &str, name: &str| {
        folder
            .run(&[
                "warp",
                "spot.obj",
                "-r",
                "twist.toml",
                "-o",
                "out.obj",
                "-f",
                "--preview",
                name,
                "--size",
                "400x225",
                "--preview-field",
                field,
            ])
            .done()
    };
    let mut pictures: Vec<Vec<u8>> = Vec::new();
    for field in ["det", "strength", "weight", "displacement"] {
        let name = format!("{field}.png");
        let said = warp(field, &name);
        assert!(said.err.contains("painted: "), "{}", said.err);
        let picture = folder.read(&name);
        assert!(picture.starts_with(b"\x89PNG"));
        pictures.push(picture);
    }
    assert_ne!(pictures[0], pictures[3]);
    // A twist keeps volumes.
    assert!(
        warp("det", "again.png")
            .err
            .contains("determinant from 0.933 to 1.07")
    );
    let wrong = [
        "warp",
        "spot.obj",
        "-r",
        "twist.toml",
        "-o",
        "x.obj",
        "--preview-field",
        "det",
    ];
    folder.run(&wrong).failed(2, &["--preview"]);
}

#[test]
fn drawings_give_wires_and_lines() {
    let folder = Folder::new();
    folder.put("grid.csv", "x,y\n0,0\n50,50\n100,100\n50,20\n");
    folder.put(
        "a.svg",
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100\" height=\"100\"><path d=\"M0 50 C 30 50 70 50 100 50\" stroke=\"red\" fill=\"none\"/></svg>",
    );
    folder.put(
        "b.svg",
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100\" height=\"100\"><g transform=\"translate(0 10)\"><path d=\"M0 50 C 30 50 70 50 100 50\" stroke=\"red\" fill=\"none\"/></g></svg>",
    );
    for kind in ["lines", "wires", "elements"] {
        let radius = if kind == "wires" { "radius = 40\n" } else { "" };
        folder.put(
            "r.toml",
            format!("version = 1\n[[warp]]\nkind = \"{kind}\"\n{radius}source = \"a.svg\"\ntarget = \"b.svg\"\n"),
        );
        folder
            .run(&["warp", "grid.csv", "-r", "r.toml", "-o", "out.csv", "-f"])
            .done();
        let moved = points(&folder, "out.csv");
        assert!(
            apart(moved[1], [50.0, 60.0, 0.0]) < 1e-6,
            "{kind}: {:?}",
            moved[1]
        );
    }
    folder.put(
        "r.toml",
        "version = 1\n[[warp]]\nkind = \"lines\"\nsource = \"a.svg\"\n",
    );
    let run = ["warp", "grid.csv", "-r", "r.toml", "-o", "out.csv", "-f"];
    folder
        .run(&run)
        .failed(1, &["warp.0.source", "no `target`"]);
    folder.put(
        "c.svg",
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1\" height=\"1\"></svg>",
    );
    folder.put(
        "r.toml",
        "version = 1\n[[warp]]\nkind = \"lines\"\nsource = \"a.svg\"\ntarget = \"c.svg\"\n",
    );
    folder.run(&run).failed(1, &["c.svg", "no path"]);
}

#[test]
fn frames_of_other_recipes_are_not_mixed() {
    let folder = Folder::with("valid/spot.obj", &[("twist.toml", TWIST)]);
    let frames = |count: &str, more: &[&str]| {
        let all = [
            "warp",
            "spot.obj",
            "-r",
            "twist.toml",
            "--frames",
            count,
            "-o",
            "k.%02d.obj",
        ];
        folder.run(&[&all[..], more].concat())
    };
    let said = frames("3", &[]).done();
    assert!(!said.err.contains("nothing moved"), "{}", said.err);
    assert_eq!(folder.json("k.frames.json")["frames"], 3);
    // The same again: all are kept. An empty file is no frame.
    folder.put("k.02.obj", "");
    let said = frames("3", &[]).done();
    assert!(
        said.err.contains("2 frames exist and are kept"),
        "{}",
        said.err
    );
    assert!(!folder.read("k.02.obj").is_empty());
    // Another number of frames, or another recipe.
    frames("5", &[]).failed(2, &["k.01.obj", "--force"]);
    frames("3", &["--set", "warp.0.angle=10deg"]).failed(2, &["k.01.obj", "--force"]);
    frames("5", &["-f"]).done();
    assert_eq!(folder.json("k.frames.json")["frames"], 5);
    // Neither the recipe nor the record of something else is replaced.
    folder.put("r.2.toml", TWIST);
    folder
        .run(&[
            "warp",
            "spot.obj",
            "-r",
            "r.2.toml",
            "--frames",
            "3",
            "-f",
            "-o",
            "r.%d.toml",
        ])
        .failed(2, &["would replace the recipe"]);
    assert_eq!(folder.read("r.2.toml"), TWIST.as_bytes());
    folder.put("q.frames.json", "{}");
    folder
        .run(&[
            "warp",
            "spot.obj",
            "-r",
            "twist.toml",
            "--frames",
            "3",
            "-o",
            "q.%d.obj",
        ])
        .failed(2, &["q.frames.json"]);
}

#[test]
fn bindings_know_the_structure_they_were_made_from() {
    let points = "version = 1\n[[warp]]\nkind = \"points\"\nradius = 0.4\npoint = [{ from = [0, 0.3, 0], by = [0, 0.2, 0] }]\n";
    let masked = format!("{points}mask = {{ field = \"axis\", axis = \"y\", range = [0, 0.5] }}\n");
    let folder = Folder::with("valid/spot.obj", &[("p.toml", points), ("m.toml", &masked)]);
    let bind = |recipe: &str, file: &str| {
        folder
            .run(&["bind", "spot.obj", "-r", recipe, "-o", file])
            .done();
    };
    bind("p.toml", "p.bind");
    bind("m.toml", "m.bind");
    let warp = |recipe: &str, binding: &str, set: &str| {
        folder.run(&[
            "warp",
            "spot.obj",
            "-r",
            recipe,
            "-o",
            "out.obj",
            "-f",
            "--binding",
            binding,
            "--set",
            set,
        ])
    };
    warp("p.toml", "p.bind", "warp.0.point.0.by=[0.1, 0, 0]").done();
    warp("p.toml", "p.bind", "warp.0.strength=0.5").done();
    for (recipe, binding, set) in [
        (
            "p.toml",
            "p.bind",
            "warp.0.point=[{ from = [0, 0.3, 0], by = [0, 0.2, 0] }, { from = [0, 0.3, 0.9], by = [0, 0.2, 0] }]",
        ),
        ("p.toml", "p.bind", "warp.0.radius=0.41"),
        ("p.toml", "p.bind", "warp.0.point.0.from=[0, 0.31, 0]"),
        ("m.toml", "m.bind", "warp.0.mask.range=[0, 0.6]"),
        ("m.toml", "m.bind", "warp.0.mask=0.5"),
    ] {
        let said = warp(recipe, binding, set);
        assert_eq!(said.code, 1, "{set}: {said:?}");
        assert!(said.err.contains("bind it again"), "{set}: {}", said.err);
    }
    warp("m.toml", "p.bind", "warp.0.label=x").failed(1, &["described otherwise"]);
}

#[test]
fn undoing_takes_the_bounds_of_the_model_as_it_was() {
    let folder = Folder::with("valid/spot.obj", &[("twist.toml", TWIST)]);
    folder
        .run(&["warp", "spot.obj", "-r", "twist.toml", "-o", "out.obj"])
        .done();
    let undo = [
        "warp",
        "out.obj",
        "-r",
        "twist.toml",
        "--invert",
        "-o",
        "back.obj",
        "-f",
    ];
    let said = folder.run(&undo).done();
    assert!(said.err.contains("--rest"), "{}", said.err);
    let said = folder
        .run(&[&undo[..], &["--rest", "spot.obj"]].concat())
        .done();
    assert!(!said.err.contains("--rest"), "{}", said.err);
    let (there, back) = (points(&folder, "spot.obj"), points(&folder, "back.obj"));
    let worst = there
        .iter()
        .zip(&back)
        .map(|(a, b)| apart(*a, *b))
        .fold(0.0, f64::max);
    // As exact as the digits of the file.
    assert!(worst < 1e-6, "{worst}");
}

#[test]
fn moments_of_a_recipe_are_checked() {
    let keyed = format!(
        "{TWIST}[[track]]\nset = \"warp.0.angle\"\nkeys = [[0, 0], [0.5, \"0.25turn\"], [1, \"30deg\"]]\n"
    );
    let folder = Folder::new();
    folder.put("keyed.toml", &keyed);
    let said = folder.run(&["check", "keyed.toml"]).done();
    assert!(said.text().contains("--time"), "{}", said.text());
    let at = |time: &str| {
        folder
            .run(&["check", "keyed.toml", "--json", "--time", time])
            .done()
            .json()
    };
    let stretch = |json: &Value| json[0]["warps"][0]["guarantees"].to_string();
    assert_ne!(stretch(&at("0")), stretch(&at("0.5")));
    folder
        .run(&["check", "keyed.toml", "--time", "2"])
        .failed(2, &["--time"]);
    for (track, says) in [
        (
            "set = \"warp.0.foo\"\nkeys = [[0, 1]]",
            &["unknown key `foo`", "of its track"][..],
        ),
        (
            "set = \"warp.7.angle\"\nkeys = [[0, \"1deg\"]]",
            &["`warp` has one entry"],
        ),
        (
            "set = \"warp.0.angle\"\nkeys = [[0, \"1deg\"]]",
            &["track 0 sets this value, too"],
        ),
        (
            "set = \"warp.0.axis\"\nkeys = [[0, [1, 0, 0]], [1, [1, 0]]]",
            &["a list of 3", "a list of 2"],
        ),
        (
            "set = \"warp.0.strength\"\nkeys = [[0, 0], [1, 1]]\nease = \"cubc\"",
            &["did you mean `cubic`"],
        ),
    ] {
        folder.put("bad.toml", format!("{keyed}[[track]]\n{track}\n"));
        folder.run(&["check", "bad.toml"]).failed(1, says);
    }
    // Commutation of a recipe with itself, and promises of an inverse.
    let said = folder.run(&["check", "keyed.toml", "keyed.toml"]).done();
    assert!(said.text().contains("both are the same"), "{}", said.text());
    folder.put(
        "inverse.toml",
        TWIST.replace("version = 1", "version = 1\nmapping = \"inverse\""),
    );
    let said = folder.run(&["check", "inverse.toml"]).done();
    assert!(
        said.text().contains("of the warps as they are"),
        "{}",
        said.text()
    );
}
