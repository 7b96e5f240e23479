//! A preview is held to a committed picture within a tolerance, never by hash: drawing may round differently elsewhere.
//!
//! When the look changes on purpose, `ANAMORPH_REWRITE_PICTURES=1 cargo test -p anamorph-cli --test pictures` writes the
//! reference anew; look at it before it is committed.

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::{Folder, repository};
use tiny_skia::Pixmap;

const REFERENCE: &str = "crates/cli/tests/pictures/spot-lattice.png";

/// Mean difference of the channels, of 255, that rounding may explain. A lamp moved by ten degrees makes about 4.
const MEAN: f64 = 0.25;
/// Difference that all channels but one in a thousand stay below. A mark left out is far more in more of them.
const MOST: u8 = 16;

/// Mean, 99.9th percentile of the differences of all channels of all pixels.
fn difference(a: &Pixmap, b: &Pixmap) -> (f64, u8) {
    assert_eq!((a.width(), a.height()), (b.width(), b.height()));
    let mut all: Vec<u8> = a
        .data()
        .iter()
        .zip(b.data())
        .map(|(a, b)| a.abs_diff(*b))
        .collect();
    all.sort_unstable();
    let mean = all.iter().map(|d| f64::from(*d)).sum::<f64>() / all.len() as f64;
    (mean, all[all.len() - 1 - all.len() / 1000])
}

fn drawn(extra: &[&str]) -> Vec<u8> {
    let folder = Folder::with("valid/spot.obj", &[]);
    let recipe = repository("docs/recipes/lattice.toml");
    let recipe = recipe.to_str().unwrap();
    let arguments = [
        "warp",
        "spot.obj",
        "-r",
        recipe,
        "-o",
        "out.obj",
        "--preview",
        "out.png",
        "--size",
        "480x270",
    ];
    folder.run(&[&arguments[..], extra].concat()).done();
    folder.read("out.png")
}

#[test]
fn the_preview_looks_as_it_did() {
    let path = repository(REFERENCE);
    let png = drawn(&[]);
    if std::env::var_os("ANAMORPH_REWRITE_PICTURES").is_some() {
        std::fs::write(&path, &png).unwrap();
    }
    let reference =
        std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let reference = Pixmap::decode_png(&reference).unwrap();
    let (mean, most) = difference(&Pixmap::decode_png(&png).unwrap(), &reference);
    if mean > MEAN || most > MOST {
        let seen = std::env::temp_dir().join("anamorph-spot-lattice.png");
        std::fs::write(&seen, &png).unwrap();
        panic!(
            "differs by {mean:.3} in the mean and {most} at the 99.9th percentile; compare {} with {}",
            seen.display(),
            path.display()
        );
    }
    // The test can fail: another lattice and another side are told apart.
    for other in [["--set", "warp.0.move.0.scale=1.5"], ["--view", "front"]] {
        let (mean, most) = difference(&Pixmap::decode_png(&drawn(&other)).unwrap(), &reference);
        assert!(
            mean > MEAN && most > MOST,
            "{other:?} differs only by {mean}, {most}"
        );
    }
}
