//! Proofs about strain fields: rotations and stretches are exact between (D1), quadrilaterals pass the patch test (D2), solvers meet in the
//! same minimum and nothing is turned over (D3), series and measures are what eq. (1) says (D8); frames do not depend on order or threads.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod bodies;

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_morph::strain::metrics::{asymmetry, measure};
use anamorph_morph::strain::{
    Element, METHODS, Pair, Settings, Solver, StrainSeries, crossings, method, schemes, strains,
};
use bodies::{apart, apart_rigidly, bend, bent, hard, mapped, spiral, strip, turned};
use std::fmt::Write as _;

const SCHEMES: [&str; 4] = ["indifferent", "linear", "modified", "log"];

fn centroid(places: &[DVec2]) -> DVec2 {
    places.iter().copied().sum::<DVec2>() / places.len() as f64
}

#[test]
fn d1_a_rotation_is_a_rotation_at_all_times() {
    for quads in [false, true] {
        let (source, elements) = strip(6, 3, 4.0, quads);
        for angle in [0.4, 2.0, 3.1, -2.9] {
            let [x, y] = turned(angle);
            let target = mapped(&source, x, y, dvec2(3.0, -2.0));
            let pair = Pair::new(source.clone(), target, elements.clone()).unwrap();
            for name in SCHEMES {
                let morph = method(name)
                    .unwrap()
                    .prepare(&pair, &Settings::default())
                    .unwrap();
                for t in [0.0, 0.3, 0.5, 0.9, 1.0] {
                    let frame = morph.at(t).unwrap();
                    // About the middle of the area, which goes straight: that of a strip, whatever its inner vertices.
                    let (from, to) = (dvec2(2.0, 0.5), x * 2.0 + y * 0.5 + dvec2(3.0, -2.0));
                    let [u, v] = turned(t * angle);
                    let wanted: Vec<DVec2> = source
                        .iter()
                        .map(|p| from.lerp(to, t) + u * (p.x - from.x) + v * (p.y - from.y))
                        .collect();
                    let off = apart(&frame.positions, &wanted);
                    assert!(off < 1e-10, "{name}, {angle}, {t}: {off:e}");
                }
            }
        }
    }
}

#[test]
fn d1_a_stretch_is_a_stretch_at_all_times() {
    let (source, elements) = strip(5, 4, 3.0, false);
    // Along axes that are turned by 0.6, and along x and y.
    for tilt in [0.0, 0.6] {
        let [a, b] = turned(tilt);
        let along = |p: DVec2, large: f64, small: f64| {
            let (u, v) = (a.dot(p), b.dot(p));
            a * (u * large) + b * (v * small)
        };
        let (large, small) = (2.5, 0.4);
        let target: Vec<DVec2> = source.iter().map(|p| along(*p, large, small)).collect();
        let pair = Pair::new(source.clone(), target, elements.clone()).unwrap();
        type Way = fn(f64, f64) -> f64;
        let even: Way = |s, t| 1.0 + t * (s - 1.0);
        let squares: Way = |s, t| (1.0 + t * (s * s - 1.0)).sqrt();
        let ratios: Way = f64::powf;
        for (name, way) in [
            ("indifferent", even),
            ("linear", squares),
            ("modified", even),
            ("log", ratios),
        ] {
            if name == "modified" && tilt != 0.0 {
                continue;
            }
            let morph = method(name)
                .unwrap()
                .prepare(&pair, &Settings::default())
                .unwrap();
            for t in [0.25, 0.5, 0.8] {
                let frame = morph.at(t).unwrap();
                let wanted: Vec<DVec2> = source
                    .iter()
                    .map(|p| along(*p, way(large, t), way(small, t)))
                    .collect();
                let off = apart_rigidly(&frame.positions, &wanted);
                assert!(off < 1e-9, "{name}, {tilt}, {t}: {off:e}");
                assert!(frame.solution.energy < 1e-20);
            }
        }
    }
}

#[test]
fn d1_strains_go_one_way_where_straight_vertices_squeeze() {
    let pair = bend(12, 4, 4.0, 3.6, false);
    let times: Vec<f64> = (0..=30).map(|k| f64::from(k) / 30.0).collect();
    let straight = method("vertex-linear")
        .unwrap()
        .prepare(&pair, &Settings::default())
        .unwrap();
    let straight = straight.frames(&times).unwrap();
    for name in SCHEMES {
        let morph = method(name)
            .unwrap()
            .prepare(&pair, &Settings::default())
            .unwrap();
        let frames = morph.frames(&times).unwrap();
        let (mut monotone, mut squeezed, mut largest) = (0, 0, 0.0_f64);
        for element in 0..pair.elements().len() {
            let series = StrainSeries::new(&pair, element, &frames).unwrap();
            let full = series.strains[30];
            // To a thousandth of the strain there is: elements help their neighbours out.
            monotone += usize::from(series.is_monotone(2e-3));
            for strain in &series.strains {
                for (value, end) in [(strain.x, full.x), (strain.y, full.y)] {
                    largest = largest.max(value - end.max(0.0)).max(end.min(0.0) - value);
                }
            }
            let series = StrainSeries::new(&pair, element, &straight).unwrap();
            squeezed += usize::from(!series.is_monotone(0.1));
        }
        assert!(
            monotone * 5 >= pair.elements().len() * 4,
            "{name}: {monotone}"
        );
        assert!(largest < 0.02, "{name}: {largest}");
        assert!(squeezed * 2 > pair.elements().len(), "{squeezed}");
    }
    // Elements that end longer are short on the way.
    let least = (0..pair.elements().len()).map(|element| {
        let series = StrainSeries::new(&pair, element, &straight).unwrap();
        let least = series.strains.iter().fold(0.0_f64, |m, s| m.min(s.x));
        if series.strains[30].x > 0.0 {
            least
        } else {
            0.0
        }
    });
    assert!(least.fold(0.0_f64, f64::min) < -0.2);
}

#[test]
fn d2_quadrilaterals_pass_the_patch_test() {
    // A patch with crooked inner vertices, all of it mapped by one affine map: every frame has to be affine, with no energy left.
    let places = [
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 3.0],
        [0.0, 3.0],
        [1.1, 0.8],
        [2.9, 0.6],
        [3.2, 2.1],
        [0.8, 2.3],
    ];
    let source: Vec<DVec2> = places.into_iter().map(DVec2::from).collect();
    let elements: Vec<Element> = [
        [0, 1, 5, 4],
        [1, 2, 6, 5],
        [2, 3, 7, 6],
        [3, 0, 4, 7],
        [4, 5, 6, 7],
    ]
    .map(Element::from)
    .to_vec();
    let target = mapped(&source, dvec2(1.3, 0.7), dvec2(-0.9, 1.1), dvec2(5.0, 1.0));
    let pair = Pair::new(source.clone(), target, elements).unwrap();
    for name in SCHEMES {
        for symmetric in [false, true] {
            let settings = Settings {
                symmetric,
                ..Settings::default()
            };
            let morph = method(name).unwrap().prepare(&pair, &settings).unwrap();
            for t in [0.2, 0.5, 0.7] {
                let found = morph.at(t).unwrap().positions;
                // The map of three corners, tried on all vertices.
                let (x, y) = ((found[1] - found[0]) / 4.0, (found[3] - found[0]) / 3.0);
                let off = apart(&found, &mapped(&source, x, y, found[0]));
                // Ahead and back the schemes but `log` want different things.
                let exact = !symmetric || name == "log";
                assert!(off < 1e-9, "{name}: {off:e}");
                if exact {
                    assert!(morph.at(t).unwrap().solution.energy < 1e-18, "{name}");
                }
            }
        }
    }
}

#[test]
fn d3_the_solvers_meet_in_the_same_minimum() {
    for quads in [false, true] {
        let pair = bend(8, 3, 4.0, 1.8, quads);
        for name in SCHEMES {
            let prepared = Solver::all().map(|solver| {
                let settings = Settings {
                    solver,
                    ..Settings::default()
                };
                method(name).unwrap().prepare(&pair, &settings).unwrap()
            });
            let prepared: Vec<_> = prepared.collect();
            assert_eq!(prepared.len(), 3);
            for t in [0.1, 0.5, 0.77] {
                let frames: Vec<_> = prepared.iter().map(|m| m.at(t).unwrap()).collect();
                for frame in &frames {
                    assert!(frame.solution.residual < 1e-10, "{:?}", frame.solution);
                    let off = apart(&frame.positions, &frames[0].positions);
                    assert!(off < 1e-8, "{name}, {quads}, {t}: {off:e}");
                }
            }
        }
    }
}

#[test]
fn d3_nothing_is_turned_over() {
    let (small, large) = (bend(16, 3, 5.0, 6.1, false), bend(10, 4, 3.0, -4.0, true));
    for (number, pair) in [hard(), spiral(1.5), small, large].iter().enumerate() {
        for name in SCHEMES {
            for symmetric in [false, true] {
                let settings = Settings {
                    symmetric,
                    ..Settings::default()
                };
                let morph = method(name).unwrap().prepare(pair, &settings).unwrap();
                let times: Vec<f64> = (1..12).map(|k| f64::from(k) / 12.0).collect();
                let found = measure(pair, &*morph, &times)
                    .unwrap_or_else(|e| panic!("{number}, {name}, {symmetric}: {e}"));
                assert_eq!(found.flips(), 0);
                assert!(found.smallest_determinant() > 0.0);
                let usual = number > 0 && name == "indifferent";
                assert!(!usual || found.median_steps() <= 5, "{name}: {found}");
            }
        }
    }
}

#[test]
fn d8_series_are_eq_1_and_measures_agree_with_it() {
    let pair = bend(6, 2, 3.0, 2.0, false);
    let morph = method("indifferent")
        .unwrap()
        .prepare(&pair, &Settings::default())
        .unwrap();
    let times = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
    let frames = morph.frames(&times).unwrap();
    for (number, element) in pair.elements().iter().enumerate() {
        let &[a, b, c] = element.vertices() else {
            panic!("triangles");
        };
        let series = StrainSeries::new(&pair, number, &frames).unwrap();
        assert_eq!(series.times, times);
        for (frame, found) in frames.iter().zip(&series.strains) {
            // ∂p′/∂x and ∂p′/∂y by Cramer's rule from the edges.
            let (s, p) = (pair.source(), &frame.positions);
            let (e, f) = (s[b] - s[a], s[c] - s[a]);
            let (u, v) = (p[b] - p[a], p[c] - p[a]);
            let area = e.x * f.y - e.y * f.x;
            let (x, y) = ((u * f.y - v * e.y) / area, (v * e.x - u * f.x) / area);
            assert!((found.x - 0.5 * (x.dot(x) - 1.0)).abs() < 1e-12);
            assert!((found.y - 0.5 * (y.dot(y) - 1.0)).abs() < 1e-12);
            assert!((found.shear - x.dot(y)).abs() < 1e-12);
            assert_eq!(strains(&pair, p)[number], *found);
        }
    }
    let found = measure(&pair, &*morph, &times).unwrap();
    let first = &found.frames[0];
    assert_eq!((first.flips, first.crossings), (0, 0));
    assert!((first.area - 3.0).abs() < 1e-14);
    for spread in [first.symmetric_dirichlet, first.conformal, first.isometric] {
        assert!((spread.mean - 1.0).abs() < 1e-7 && (spread.largest - 1.0).abs() < 1e-7);
    }
    assert!(first.strain_difference.unwrap() < 1e-15);
    let last = &found.frames[5];
    assert!(last.strain_difference.unwrap() < 1e-14 && last.strain_overshoot < 1e-14);
    let middle = &found.frames[2];
    let energy = frames[2].solution.energy;
    let difference = (2.0 * energy / 3.0).sqrt();
    assert!((middle.strain_difference.unwrap() - difference).abs() < 1e-12);
    assert_eq!(found.mesh.vertices, 21);
    let table = found.to_string();
    assert!(
        table.lines().count() == 9 && table.contains("least det"),
        "{table}"
    );
    // What straight vertices do is seen.
    let pair = bend(10, 3, 4.0, 5.0, false);
    let straight = method("vertex-linear")
        .unwrap()
        .prepare(&pair, &Settings::default())
        .unwrap();
    let morph = method("indifferent")
        .unwrap()
        .prepare(&pair, &Settings::default())
        .unwrap();
    let (bad, good) = (
        measure(&pair, &*straight, &times).unwrap(),
        measure(&pair, &*morph, &times).unwrap(),
    );
    assert!(bad.flips() > 0 && bad.area_overshoot > 0.2);
    assert!(good.flips() == 0 && good.area_overshoot < 0.01);
}

#[test]
fn d8_folds_and_crossings_are_counted() {
    let (source, elements) = strip(3, 1, 3.0, false);
    let pair = Pair::new(source.clone(), source, elements).unwrap();
    let mut folded = pair.source().to_vec();
    // The corner at the origin goes through the far side.
    folded[0] = dvec2(0.5, 1.5);
    assert!(!crossings(pair.boundary(), &folded).is_empty());
    assert!(crossings(pair.boundary(), pair.source()).is_empty());
}

#[test]
fn every_method_begins_and_ends_where_it_should_and_gives_the_same_in_any_order() {
    let pair = hard();
    let times = [0.9, 0.0, 0.35, 1.0, 0.1, 0.35, 0.6];
    let pool = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
    };
    for row in METHODS {
        let prepare = || row.prepare(&pair, &Settings::default()).unwrap();
        let morph = prepare();
        assert_eq!(morph.name(), row.name);
        let frames = pool(1).install(|| morph.frames(&times)).unwrap();
        assert_eq!(
            pool(3).install(|| prepare().frames(&times)).unwrap(),
            frames
        );
        for (frame, &time) in frames.iter().zip(&times) {
            assert_eq!(prepare().at(time).unwrap(), *frame, "{}", row.name);
        }
        assert!(apart(&frames[1].positions, pair.source()) < 1e-12);
        assert!(apart(&frames[3].positions, pair.target()) < 1e-12);
        assert!(morph.at(1.5).is_err() && morph.frames(&[0.5, f64::NAN]).is_err());
    }
    let error = method("indiferent").unwrap_err().to_string();
    assert!(error.contains("as-rigid-as-possible"), "{error}");
    // The chain gives a frame the same whether it was asked for alone or among others.
    let pair = bend(6, 2, 3.0, 2.0, false);
    let settings = Settings {
        solver: Solver::Continuation,
        ..Settings::default()
    };
    let chain = method("linear").unwrap().prepare(&pair, &settings).unwrap();
    for (frame, &time) in chain.frames(&times).unwrap().iter().zip(&times) {
        assert_eq!(chain.at(time).unwrap().positions, frame.positions);
    }
}

#[test]
fn the_default_is_chosen_by_numbers() {
    // A bend that thickens unevenly, its growth up to threefold.
    let (source, elements) = strip(16, 4, 4.0, false);
    let target = source.iter().map(|p| {
        let thick = 1.0 + 0.5 * p.x;
        bent(dvec2(p.x, 0.5 + (p.y - 0.5) * thick), 4.0, 2.0) * 1.3
    });
    let target = target.collect();
    let grown = Pair::new(source, target, elements).unwrap();
    let times: Vec<f64> = (0..=24).map(|k| f64::from(k) / 24.0).collect();
    let mut table = String::new();
    let mut unevenness = Vec::new();
    for (what, pair) in [
        ("bend", bend(16, 4, 4.0, 3.0, false)),
        ("growth", grown),
        ("star", hard()),
    ] {
        for name in [
            "indifferent",
            "linear",
            "modified",
            "log",
            "as-rigid-as-possible",
            "vertex-linear",
        ] {
            let morph = method(name)
                .unwrap()
                .prepare(&pair, &Settings::default())
                .unwrap();
            let found = measure(&pair, &*morph, &times).unwrap();
            let back = pair.reversed().unwrap();
            let back = method(name)
                .unwrap()
                .prepare(&back, &Settings::default())
                .unwrap();
            let asymmetry = asymmetry(&pair, &*morph, &*back, &[0.25, 0.5, 0.75]).unwrap();
            writeln!(
                table,
                "{what} {name}: uneven {:.5}, area beyond {:.5}, back {:.5}, monotone {}/{}, largest isometric {:.2}, asymmetry {asymmetry:.5}",
                found.stretch_unevenness,
                found.area_overshoot,
                found.area_reversal,
                found.monotone_elements,
                found.mesh.elements,
                found.frames.iter().map(|f| f.isometric.largest).fold(0.0, f64::max),
            )
            .unwrap();
            unevenness.push((what, name, found.stretch_unevenness));
        }
    }
    println!("{table}");
    let of = |what: &str, name: &str| {
        let found = unevenness.iter().find(|row| row.0 == what && row.1 == name);
        found.unwrap().2
    };
    for what in ["growth", "star"] {
        for other in ["linear", "log"] {
            assert!(of(what, "indifferent") < of(what, other), "{table}");
        }
    }
    assert_eq!(schemes::all().next().unwrap().name(), "indifferent");
    assert_eq!(METHODS[0].name, "indifferent");
}

#[test]
fn parts_move_for_themselves_and_loose_vertices_straight() {
    let (first, mut elements) = strip(3, 2, 2.0, false);
    let (second, more) = strip(2, 2, 1.0, true);
    let count = first.len();
    elements.extend(more.iter().map(|e| {
        let list: Vec<usize> = e.vertices().iter().map(|v| v + count).collect();
        Element::of(&list).unwrap()
    }));
    let [x, y] = turned(1.0);
    let [u, v] = turned(-2.0);
    let away = mapped(&second, DVec2::X, DVec2::Y, dvec2(5.0, 0.0));
    let loose = dvec2(9.0, 9.0);
    let source: Vec<DVec2> = first.iter().chain(&away).copied().chain([loose]).collect();
    let target: Vec<DVec2> = mapped(&first, x, y, dvec2(0.0, 1.0))
        .into_iter()
        .chain(mapped(&away, u, v, dvec2(1.0, 0.0)))
        .chain([loose * 2.0])
        .collect();
    let pair = Pair::new(source, target, elements).unwrap();
    assert_eq!(pair.part_count(), 2);
    let morph = method("indifferent")
        .unwrap()
        .prepare(&pair, &Settings::default())
        .unwrap();
    let frame = morph.at(0.5).unwrap();
    let [x, y] = turned(0.5);
    let [u, v] = turned(-1.0);
    let turned_first = mapped(&first, x, y, DVec2::ZERO);
    let turned_second = mapped(&second, u, v, DVec2::ZERO);
    for (found, wanted) in [
        (&frame.positions[..count], &turned_first),
        (
            &frame.positions[count..count + second.len()],
            &turned_second,
        ),
    ] {
        let shift = centroid(found) - centroid(wanted);
        let wanted: Vec<DVec2> = wanted.iter().map(|p| *p + shift).collect();
        assert!(apart(found, &wanted) < 1e-10);
    }
    assert_eq!(frame.positions[frame.positions.len() - 1], loose * 1.5);
}

#[test]
fn elements_that_hang_by_a_vertex_are_no_obstacle() {
    let source = vec![
        dvec2(0.0, 0.0),
        dvec2(1.0, 0.0),
        dvec2(0.0, 1.0),
        dvec2(-1.0, 0.0),
        dvec2(0.0, -1.0),
    ];
    let mut target = source.clone();
    target[3] = dvec2(-1.2, 0.4);
    target[4] = dvec2(0.5, -1.1);
    let pair = Pair::new(source, target, vec![[0, 1, 2].into(), [0, 3, 4].into()]).unwrap();
    assert_eq!(pair.part_count(), 1);
    for row in METHODS {
        let frame = row
            .prepare(&pair, &Settings::default())
            .unwrap()
            .at(0.5)
            .unwrap_or_else(|e| panic!("{}: {e}", row.name));
        assert!(frame.solution.energy < 1e-15, "{:?}", frame.solution);
    }
}

#[test]
fn a_bend_is_as_it_was_checked() {
    let pair = bend(5, 1, 3.0, 2.5, false);
    let mut text = String::new();
    for name in ["indifferent", "modified", "as-rigid-as-possible"] {
        let morph = method(name)
            .unwrap()
            .prepare(&pair, &Settings::default())
            .unwrap();
        for frame in morph.frames(&[0.25, 0.5, 0.75]).unwrap() {
            let places = frame.positions.iter();
            let places: Vec<String> = places
                .map(|p| format!("({:.6}, {:.6})", p.x + 0.0, p.y + 0.0))
                .collect();
            writeln!(text, "{name}, {}: {}", frame.time, places.join(" ")).unwrap();
        }
    }
    insta::assert_snapshot!(text);
}
