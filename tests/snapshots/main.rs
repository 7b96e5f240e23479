//! Snapshots of every registered warp's example on a small model, coordinates rounded to six decimals.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_catalog::Context;
use anamorph_core::{Bounds, map_all};
use anamorph_tests::models::{cube_surface, plane_grid};
use anamorph_tests::subjects::{Registered, parameters};

/// A coordinate with six decimals; what rounds to zero has no sign.
fn rounded(value: f64) -> String {
    let text = format!("{value:.6}");
    if text == "-0.000000" {
        "0.000000".to_owned()
    } else {
        text
    }
}

fn snapshot<S: Registered>(space: &str, model: &[S]) {
    let bounds = Bounds::of(model).unwrap();
    for entry in S::registry() {
        let context = Context::of_bounds(bounds);
        let built = (entry.construct)(&parameters(entry.example), &context).unwrap();
        let mut points = model.to_vec();
        assert!(map_all(&built.warp, &mut points).is_empty());
        let lines: Vec<String> = points
            .iter()
            .map(|p| {
                let row: Vec<String> = (0..S::DIM).map(|i| rounded(p.component(i))).collect();
                row.join(" ")
            })
            .collect();
        let mut settings = insta::Settings::clone_current();
        settings.set_snapshot_path("stored");
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.bind(|| {
            insta::assert_snapshot!(format!("{space}_{}", entry.kind), lines.join("\n"));
        });
    }
}

#[test]
fn examples_in_the_plane() {
    snapshot("plane", &plane_grid(9));
}

#[test]
fn examples_in_space() {
    snapshot("solid", &cube_surface(5));
}
