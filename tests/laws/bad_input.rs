//! Bad parameters of every registered warp: errors that say where, what, and how to mend; never a panic.

use super::bad_rows::{ROWS, Row};
use anamorph_catalog::serde_json::{Number, json};
use anamorph_catalog::{ConstructError, Context, Value};
use anamorph_core::{Bounds, Plane, Site, Solid, map_all};
use anamorph_tests::models::boxes;
use anamorph_tests::random::Random;
use anamorph_tests::settings::settings;
use anamorph_tests::subjects::{Registered, entry, parameters};

crate::laws!(
    mutated_parameters_never_panic,
    unknown_and_missing_parameters_are_named,
    relative_parameters_need_a_model,
    models_without_extent_are_served_or_refused,
);

fn refusal<S: Registered>(kind: &str, toml: &str, bounds: Option<Bounds<S>>) -> ConstructError {
    let context = Context {
        bounds,
        ..Context::default()
    };
    match (entry::<S>(kind).construct)(&parameters(toml), &context) {
        Err(error) => error,
        Ok(_) => panic!("{kind} accepts\n{toml}"),
    }
}

#[test]
fn bad_parameters_are_refused_where_they_stand() {
    let mut failures = Vec::new();
    for (kind, toml, path, words) in ROWS {
        let error = refusal::<Solid>(kind, toml, Some(boxes()[0]));
        let text = error.to_string();
        let ended = error.message.is_empty() || error.message.ends_with('.');
        if error.path != *path || !text.contains(words) || ended {
            failures.push(format!("{kind} with\n{toml}\n`{}`, {text}", error.path));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
    // Every warp has rows.
    for entry in Solid::registry() {
        assert!(ROWS.iter().any(|row| row.0 == entry.kind), "{}", entry.kind);
    }
}

#[test]
fn the_plane_refuses_what_only_space_has() {
    let rows: &[Row] = &[
        (
            "vortex",
            "centre = \"50%\"\naxis = \"x\"\nangle = \"1deg\"\nradius = 1",
            "axis",
            "remove",
        ),
        (
            "frames",
            "frame = [{ at = \"1%\", turn = \"1deg\", axis = \"x\" }]",
            "frame.0.axis",
            "remove",
        ),
        ("taper", "axis = \"z\"\nfactor = 2", "axis", "plane"),
        ("taper", "axis = [1, 0, 0]\nfactor = 2", "axis", "plane"),
        ("axial", "axis = \"y\"\nturn = [[0, \"1deg\"]]", "", "plane"),
        (
            "points",
            "point = [{ from = [1, 2, 3] }]",
            "point.0.from",
            "[x, y]",
        ),
        ("lattice", "shape = [4, 4, 4]", "shape", "plane"),
        (
            "elements",
            "element = [{ source = [\"1%\", [2, 0], [0, 2], [3, 3]] }]",
            "element.0.source",
            "1 to 3 corners",
        ),
        ("lines", "line = []", "line", "no line"),
        (
            "lines",
            "line = [{ source = [[0, 0]] }]",
            "line.0.source",
            "2 ends",
        ),
        (
            "global-lines",
            "line = [{ source = [[0, 0], [1, 0]], target = [[0, 0], [1, 0], [2, 0]] }]",
            "line.0.target",
            "2 ends",
        ),
        ("grid", "columns = 1\nrows = 2", "columns", "2 to"),
        ("grid", "columns = 2\nrows = [0]", "rows", "at least 2"),
        (
            "grid",
            "columns = [0, 2, 2]\nrows = 2",
            "columns.2",
            "ascend",
        ),
        (
            "grid",
            "columns = 1000000\nrows = 1000000",
            "columns",
            "at most",
        ),
        (
            "grid",
            "columns = 3\nrows = 2\nmove = [{ index = [3, 0], by = \"1%\" }]",
            "move.0.index.0",
            "indices run",
        ),
        (
            "grid",
            "columns = 3\nrows = 2\ncells = \"cubic\"",
            "cells",
            "smooth",
        ),
        ("grid", "rows = 2", "", "columns"),
        (
            "lines",
            "a = \"-1%\"\nline = [{ source = [[0, 0], [1, 0]] }]",
            "a",
            "not be negative",
        ),
        (
            "global-lines",
            "line = [{ source = [[-1, 0], [1, 0]], target = [[0, -1], [0, 1]] },
                { source = [[0, -1], [0, 1]], target = [[1, 0], [-1, 0]] },
                { source = [[-1, 0], [1, 0]], target = [[0, 1], [0, -1]] }]",
            "line.0",
            "turn against each other",
        ),
    ];
    for (kind, toml, path, words) in rows {
        let error = refusal::<Plane>(kind, toml, Some(boxes()[0]));
        let text = error.to_string();
        assert_eq!(error.path, *path, "{kind} with\n{toml}\n{text}");
        assert!(text.contains(words), "{kind} with\n{toml}\n{text}");
    }
    assert!(Plane::registry().iter().all(|e| e.kind != "twist"));
}

fn unknown_and_missing_parameters_are_named<S: Registered>() {
    for entry in S::registry() {
        let example = parameters(entry.example);
        let context = Context::of_bounds(boxes::<S>()[0]);
        let mut with = example.clone();
        with["colour"] = json!("red");
        let error = (entry.construct)(&with, &context).err().unwrap();
        assert!(
            error.to_string().contains("`colour`"),
            "{}: {error}",
            entry.kind
        );
        // Whatever is left out is missed or optional, never a panic.
        for key in example.as_object().unwrap().keys() {
            let mut without = example.clone();
            without.as_object_mut().unwrap().remove(key);
            if let Err(error) = (entry.construct)(&without, &context) {
                assert!(!error.message.is_empty());
            }
        }
        for nonsense in [json!(null), json!(3), json!("x"), json!([]), json!({})] {
            let error = (entry.construct)(&nonsense, &context).err().unwrap();
            assert!(!error.message.is_empty(), "{}", entry.kind);
        }
    }
}

fn relative_parameters_need_a_model<S: Registered>() {
    for entry in S::registry() {
        let context = Context::<S>::default();
        let built = (entry.construct)(&parameters(entry.example), &context);
        let error = built.err().unwrap();
        assert!(
            error.to_string().contains("model"),
            "{}: {error}",
            entry.kind
        );
    }
}

fn models_without_extent_are_served_or_refused<S: Registered>() {
    // A single point, a line, and in space a sheet.
    let flat = [
        Bounds::new(S::ZERO, S::ZERO),
        Bounds::new(S::ZERO, S::unit(0)),
        Bounds::new(S::ZERO, S::unit(0) + S::unit(1)),
        Bounds::new(S::splat(1e-300), S::splat(2e-300)),
        Bounds::new(S::splat(-1e300), S::splat(1e300)),
        Bounds::new(S::splat(-1.7e308), S::splat(1.7e308)),
    ];
    for bounds in flat {
        for setting in settings::<S>() {
            let entry = entry::<S>(setting.kind);
            let context = Context::of_bounds(bounds);
            let Ok(built) = (entry.construct)(&parameters(&setting.toml), &context) else {
                continue;
            };
            let mut points = vec![bounds.min, bounds.max, bounds.centre(), S::ZERO];
            points.retain(|p| p.is_finite());
            map_all(&built.warp, &mut points);
            assert!(
                points.iter().all(|p| p.is_finite()),
                "{} in {bounds:?}",
                setting.toml
            );
        }
    }
}

/// Replaces one random value somewhere inside.
fn mutate(value: &mut Value, random: &mut Random) {
    let count = match value {
        Value::Array(list) => list.len(),
        Value::Object(table) => table.len(),
        _ => 0,
    };
    // Leaves are replaced, tables and lists entered three times out of four.
    if count > 0 && random.below(4) > 0 {
        let which = random.below(count);
        match value {
            Value::Array(list) => match random.below(12) {
                0 => drop(list.remove(which)),
                1 => list.push(list[which].clone()),
                _ => mutate(&mut list[which], random),
            },
            Value::Object(table) => {
                let key = table.keys().nth(which).unwrap().clone();
                if random.below(15) == 0 {
                    table.remove(&key);
                } else {
                    mutate(&mut table[&key], random);
                }
            }
            _ => {}
        }
        return;
    }
    let float = |x: f64| Value::Number(Number::from_f64(x).unwrap());
    // Often something of the same type, so that other mutations get a hearing.
    if random.below(3) > 0 {
        let number = random.between(-1.5, 3.0);
        match value {
            Value::Number(n) if n.is_f64() => *value = float(number),
            Value::Number(_) => *value = json!(random.below(9)),
            Value::String(s) if s.ends_with('%') => *value = json!(format!("{}%", number * 50.0)),
            Value::String(s) if s.ends_with("deg") => {
                *value = json!(format!("{}deg", number * 200.0));
            }
            _ => {}
        }
        return;
    }
    *value = match random.below(24) {
        0 => json!(null),
        1 => json!(true),
        2 => json!("nonsense"),
        3 => json!([]),
        4 => json!({}),
        5 => json!("50%"),
        6 => json!("-1e300%"),
        7 => json!("90deg"),
        8 => json!("1e300turn"),
        9 => json!(i64::MIN),
        10 => json!(u64::MAX),
        11 => float(f64::MAX),
        12 => float(-1e200),
        13 => float(5e-324),
        14 => float(-0.0),
        15 => json!(0),
        16 => json!(-1),
        17 => json!([1, 2, 3]),
        18 => json!(["*", "*", "*"]),
        19 => json!("-x"),
        20 => json!("inverse-distance"),
        21 => json!("composition"),
        22 => json!(random.below(12)),
        _ => float(random.between(-3.0, 3.0)),
    };
}

fn mutated_parameters_never_panic<S: Registered>() {
    let mut random = Random::new(2024);
    let originals: Vec<(&str, Value)> = settings::<S>()
        .iter()
        .map(|s| (s.kind, parameters(&s.toml)))
        .collect();
    let bounds = boxes::<S>();
    let (mut accepted, mut refused) = (0, 0);
    for round in 0..12_000 {
        let (kind, original) = &originals[random.below(originals.len())];
        let mut value = original.clone();
        for _ in 0..=random.below(3) {
            mutate(&mut value, &mut random);
        }
        let context = Context {
            bounds: Some(bounds[round % bounds.len()]),
            scaling: settings_scaling(round),
            meshes: None,
            attributes: None,
        };
        let Ok(built) = (entry::<S>(kind).construct)(&value, &context) else {
            refused += 1;
            continue;
        };
        accepted += 1;
        let b = context.bounds.unwrap();
        let mut points: Vec<S> = (0..9)
            .map(|_| b.at(S::from_fn(|_| random.between(-0.2, 1.2))))
            .chain(built.warp.conditions().iter().take(3).map(|c| c.source))
            .collect();
        let _ = built.warp.facts();
        let _ = built
            .warp
            .jacobian(&Site::anywhere(points[0]), b.diagonal());
        let unmapped = map_all(&built.warp, &mut points);
        for (i, p) in points.iter().enumerate() {
            let excused = unmapped.indices().contains(&i);
            assert!(p.is_finite() || excused, "{kind} {value} moves to {p:?}");
        }
        for condition in built.warp.conditions() {
            let ends = condition.source.is_finite() && condition.target.is_finite();
            assert!(ends, "{kind} {value}: {condition:?}");
        }
    }
    assert!(accepted > 1000 && refused > 3000, "{accepted}, {refused}");
}

fn settings_scaling(round: usize) -> Option<anamorph_core::Scaling> {
    use anamorph_core::Scaling::{Composition, Displacement};
    [None, Some(Displacement), Some(Composition)][round % 3]
}
