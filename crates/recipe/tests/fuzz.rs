//! Seeded mutations of valid recipes: no panic, and every error names a line of the file.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use anamorph_recipe::{Place, Recipe};
use common::{build, run};

const TOML: &str = r#"# A recipe with all there is.
version = 1
name = "é"

[[warp]]
kind = "shift"
offset = [1, "50%", -2.5e-3]
angle = "45deg"
move = [{ index = 1, by = "1%", blend = "smooth" }, { index = 2, by = [0, 0, 1] }]
profile = [[0, 1], [0.5, 0.6]]
strength = 0.5
mask = { field = "product", of = [0.5, { field = "radial", centre = "50%", radius = 1.0 }] }

[[warp]]
kind = "grow"
factor = 2
scaling = "composition"
[warp.weight]
field = "radial"
centre.x = 1

[[warp]]
kind = 'screw'
by = """slope"""
rise = 1
run = 0x2
enabled = false
"#;

struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        // xorshift64*
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        usize::try_from((self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) % n as u64).unwrap()
    }
}

fn mutate(bytes: &mut Vec<u8>, random: &mut Random) {
    const PIECES: [&str; 24] = [
        "[",
        "]",
        "[[",
        "{",
        "}",
        "\"",
        "'''",
        "\\",
        ".",
        ",",
        "=",
        ":",
        "\n",
        "\r",
        "#",
        "nan",
        "1e999",
        "%",
        "-",
        "[a]\n",
        "[[warp]]\n",
        "a.b.c",
        "\u{e9}",
        "/*",
    ];
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len() + 1);
        let end = (at + random.below(12)).min(bytes.len());
        match random.below(6) {
            0 if at < bytes.len() => bytes[at] = u8::try_from(random.below(256)).unwrap(),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let copy = bytes[at..end].to_vec();
                let to = random.below(bytes.len() + 1);
                bytes.splice(to..to, copy);
            }
            3 => bytes.truncate(at),
            _ => {
                let piece = PIECES[random.below(PIECES.len())].bytes();
                bytes.splice(at..at, piece);
            }
        }
    }
}

fn check(bytes: &[u8], name: &str) -> bool {
    let Err(error) = run(bytes, name, &[]) else {
        return true;
    };
    assert!(!error.problems.is_empty());
    let lines = 1 + bytes.iter().filter(|&&b| b == b'\n').count();
    for problem in &error.problems {
        let Place::File { line, column } = problem.place else {
            panic!("{error}");
        };
        assert!((1..=lines).contains(&line), "{error}");
        let text = bytes.split(|&b| b == b'\n').nth(line - 1).unwrap();
        assert!(
            (1..=text.len() + 1).contains(&column),
            "{error}\n{}",
            String::from_utf8_lossy(bytes)
        );
        assert!(!problem.message.is_empty());
    }
    false
}

#[test]
fn mutations_of_valid_recipes_never_panic() {
    // The one wrong line is there so that mutations of a nearly valid recipe are tried as well.
    let valid = TOML.replace("centre.x = 1", "centre = \"50%\"\nradius = 1");
    let json = Recipe::read(valid.as_bytes(), "a.toml").unwrap();
    let json =
        serde_json::to_string_pretty(&serde_json::Value::Object(json.tree().clone())).unwrap();
    for (text, name) in [
        (valid.as_str(), "a.toml"),
        (TOML, "a.toml"),
        (&json, "a.json"),
    ] {
        assert_eq!(check(text.as_bytes(), name), text != TOML);
        let mut random = Random(0x9E37_79B9_7F4A_7C15);
        let mut accepted = 0;
        for _ in 0..4000 {
            let mut bytes = text.as_bytes().to_vec();
            mutate(&mut bytes, &mut random);
            accepted += usize::from(check(&bytes, name));
        }
        // Neither all nor none: the mutations reach beyond the parser.
        assert!(accepted < 2000, "{accepted}");
        assert!(text == TOML || accepted > 40, "{accepted}");
    }
}

#[test]
fn mutated_settings_never_panic() {
    let recipe = Recipe::read(TOML.as_bytes(), "a.toml").unwrap();
    let mut random = Random(7);
    for _ in 0..4000 {
        let mut recipe = recipe.clone();
        for setting in [
            "warp.0.move.1.by=[1, 2, {a = \"3%\"}]",
            "warp.0.mask.of.1.radius=5%",
            "warp.1.weight.field=radial",
        ] {
            let mut bytes = setting.as_bytes().to_vec();
            mutate(&mut bytes, &mut random);
            let _ = recipe.set(&String::from_utf8_lossy(&bytes));
        }
        if let Err(error) = build(&recipe) {
            assert!(!error.to_string().is_empty());
        }
    }
}

#[test]
fn every_truncation_is_answered() {
    for end in 0..TOML.len() {
        check(&TOML.as_bytes()[..end], "a.toml");
    }
}
