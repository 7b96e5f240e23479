//! Rows of the errata on strain fields, pinned one by one: what the formulas are, and what they are not.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod bodies;

use anamorph_core::glam::{DMat2, DVec2, dvec2};
use anamorph_core::math;
use anamorph_morph::strain::metrics::{asymmetry, measure};
use anamorph_morph::strain::{
    AsRigidAsPossible, Element, Energy, Frame, FrameError, InBetween, Pair, PairError,
    PrepareError, Rigid, Settings, Shear, Side, Solver, Strain, StrainMorph, method, schemes,
};
use bodies::{
    Random, apart, apart_rigidly, bend, hard, mapped, ring, ring_elements, spiral, strip, turned,
    wrapped,
};
use std::f64::consts::{PI, TAU};

fn scheme(name: &str) -> &'static dyn schemes::Scheme {
    schemes::by_name(name).unwrap()
}

fn at(pair: &Pair, name: &str, settings: &Settings, t: f64) -> Frame {
    let morph = method(name).unwrap().prepare(pair, settings).unwrap();
    morph.at(t).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Strains of maps that are not turned over.
fn some_strains() -> Vec<Strain> {
    let mut random = Random(77);
    let mut list = Vec::new();
    while list.len() < 50 {
        let f = DMat2::from_cols_array(&[(); 4].map(|()| 2.0 * random.next()));
        if f.determinant() > 0.05 {
            list.push(Strain::of(f));
        }
    }
    list
}

fn close(a: Strain, b: Strain) -> bool {
    let size = 1.0 + a.x.abs() + a.y.abs() + a.shear.abs();
    [a.x - b.x, a.y - b.y, a.shear - b.shear]
        .iter()
        .all(|d| d.abs() < 1e-12 * size)
}

/// S1: `t ε_n`, not `(1 − t) ε_n`; squared lengths go evenly.
#[test]
fn s1_linear_strain_begins_at_nothing() {
    for full in some_strains() {
        let linear = scheme("linear");
        assert_eq!(linear.strain(full, 0.0), Strain::default());
        assert_eq!(linear.strain(full, 1.0), full);
        let quarter = linear.strain(full, 0.25);
        // The squared length of (0.6, 0.8) is 1 + 2 (ε_x 0.36 + ε_y 0.64 + γ 0.48).
        let squared = |s: Strain| 1.0 + 2.0 * (s.x * 0.36 + s.y * 0.64 + s.shear * 0.48);
        assert!((squared(quarter) - (0.75 + 0.25 * squared(full))).abs() < 1e-12);
    }
}

/// S2: eq. (3) depends on the axes; the stretch of the polar decomposition does not; under stretch along the axes both are the same; only the
/// logarithm makes determinants monotone.
#[test]
fn s2_schemes_and_axes() {
    let [indifferent, modified, log] = ["indifferent", "modified", "log"].map(scheme);
    for t in [0.0, 0.3, 0.7, 1.0] {
        let full = Strain {
            x: 1.1,
            y: -0.35,
            shear: 0.0,
        };
        assert!(close(indifferent.strain(full, t), modified.strain(full, t)));
        for full in some_strains() {
            // U(t) = (1 − t) I + t U, with U by the formula of Cayley and Hamilton.
            let c = DMat2::from_cols_array(&[
                1.0 + 2.0 * full.x,
                full.shear,
                full.shear,
                1.0 + 2.0 * full.y,
            ]);
            let root = c.determinant().sqrt();
            let u = (c + DMat2::IDENTITY * root)
                * (1.0 / (c.x_axis.x + c.y_axis.y + 2.0 * root).sqrt());
            let between = DMat2::IDENTITY * (1.0 - t) + u * t;
            assert!(close(indifferent.strain(full, t), Strain::of(between)));
            let shear = math::tan(t * full.shear.atan());
            assert!((modified.strain(full, t).shear - shear).abs() < 1e-12 * (1.0 + shear.abs()));
            // det exp(t log U) = det(U)^t.
            let s = log.strain(full, t);
            let determinant = (1.0 + 2.0 * s.x) * (1.0 + 2.0 * s.y) - s.shear * s.shear;
            assert!((determinant - (root * root).powf(t)).abs() < 1e-10 * determinant.max(1.0));
        }
    }
    // Both shapes turned: only `modified` goes another way.
    let pair = bend(8, 2, 4.0, 2.0, false);
    let [x, y] = turned(0.7);
    let turn = |list: &[DVec2]| mapped(list, x, y, DVec2::ZERO);
    let other = Pair::new(
        turn(pair.source()),
        turn(pair.target()),
        pair.elements().to_vec(),
    )
    .unwrap();
    for (name, same) in [
        ("indifferent", true),
        ("log", true),
        ("linear", true),
        ("modified", false),
    ] {
        let settings = Settings::default();
        let (here, there) = (
            at(&pair, name, &settings, 0.4),
            at(&other, name, &settings, 0.4),
        );
        let off = apart(&turn(&here.positions), &there.positions);
        assert_eq!(off < 1e-8, same, "{name}: {off:e}");
    }
    // An element drawn out to (4, 1/8): its area rises before it falls, unless by logarithms.
    let full = Strain::of(DMat2::from_cols(dvec2(4.0, 0.0), dvec2(0.0, 0.125)));
    let area = |s: Strain| s.stretches().iter().product::<f64>();
    assert!(area(indifferent.strain(full, 0.3)) > 1.1);
    assert!(area(scheme("linear").strain(full, 0.3)) > 1.1);
    let steps = (0..=20).map(|k| area(log.strain(full, f64::from(k) / 20.0)));
    let steps: Vec<f64> = steps.collect();
    assert!(steps.windows(2).all(|pair| pair[1] < pair[0]));
}

/// S3: roots of what rounding made negative; degenerate elements by name; angles do not go linearly.
#[test]
fn s3_roots_and_degenerate_elements() {
    let flat = Strain {
        x: -0.5 - 1e-17,
        y: -0.500_000_000_000_000_1,
        shear: 1e-17,
    };
    for scheme in schemes::all() {
        let s = scheme.strain(flat, 0.5);
        assert!(s.x.is_finite() && s.y.is_finite() && s.shear.is_finite());
    }
    let (mut source, elements) = strip(3, 2, 3.0, false);
    let target = source.clone();
    source[1] = dvec2(0.0, 1.0);
    let error = Pair::new(source.clone(), target.clone(), elements.clone()).unwrap_err();
    assert!(
        matches!(error, PairError::Degenerate { element: 3, .. }),
        "{error}"
    );
    // Without area in the target only what needs no area goes on.
    let there = Pair::new(target, source, elements).unwrap();
    assert_eq!(there.vanishing(), [3]);
    let frame = at(&there, "indifferent", &Settings::default(), 0.5);
    assert!(frame.solution.residual < 1e-9);
    let error = StrainMorph::new(&there, scheme("log"), &Settings::default()).unwrap_err();
    assert!(matches!(error, PrepareError::Vanishing { element: 3 }));
    // Half way the angle between what were x and y is not half of what it becomes.
    let full = Strain::of(DMat2::from_cols(dvec2(1.6, 0.0), dvec2(1.2, 0.9)));
    let angle = |s: Strain| {
        let lengths = ((1.0 + 2.0 * s.x) * (1.0 + 2.0 * s.y)).sqrt();
        PI / 2.0 - math::acos(s.shear / lengths)
    };
    let half = scheme("modified").strain(full, 0.5);
    assert!((angle(half) - 0.5 * angle(full)).abs() > 0.02);
}

/// S4: the gradient and the Hessian against differences, of triangles and quadrilaterals; `B` is 3 × 6, so that each place counts twice.
#[test]
fn s4_derivatives_are_those_of_differences() {
    for quads in [false, true] {
        let pair = bend(2, 2, 2.0, 1.5, quads);
        for shear in Shear::all() {
            let energy = Energy::new(&pair, scheme("indifferent"), shear, 0.4);
            let mut random = Random(5);
            let mut places: Vec<DVec2> = pair.source().to_vec();
            for place in &mut places {
                *place += dvec2(random.next(), random.next()) * 0.15;
            }
            let (gradient, hessian) = (energy.gradient(&places), energy.hessian(&places));
            assert_eq!(hessian.len(), 2 * places.len());
            let step = 1e-5;
            for k in 0..2 * places.len() {
                let moved = |by: f64| {
                    let mut moved = places.clone();
                    moved[k / 2][k % 2] += by;
                    moved
                };
                let (less, more) = (moved(-step), moved(step));
                let slope = (energy.value(&more) - energy.value(&less)) / (2.0 * step);
                assert!((slope - gradient[k / 2][k % 2]).abs() < 1e-9, "{slope}");
                let (less, more) = (energy.gradient(&less), energy.gradient(&more));
                for (j, row) in hessian.iter().enumerate() {
                    let bend = (more[j / 2][j % 2] - less[j / 2][j % 2]) / (2.0 * step);
                    assert!((bend - row[k]).abs() < 1e-8, "{bend} {}", row[k]);
                }
            }
        }
    }
}

fn dot(matrix: &[Vec<f64>], x: &[f64]) -> f64 {
    let rows = matrix.iter().zip(x);
    rows.map(|(row, xi)| xi * row.iter().zip(x).map(|(a, b)| a * b).sum::<f64>())
        .sum()
}

/// S5: the Hessian is indefinite under compression; the default solver passes there, and nothing is turned over.
#[test]
fn s5_compression_makes_the_hessian_indefinite() {
    let (source, elements) = strip(4, 2, 2.0, false);
    let same = Pair::new(source.clone(), source.clone(), elements).unwrap();
    let energy = Energy::new(&same, scheme("linear"), Shear::Tensor, 1.0);
    let squeezed: Vec<DVec2> = source.iter().map(|p| *p * 0.4).collect();
    let hessian = energy.hessian(&squeezed);
    let mut random = Random(9);
    let mut least = f64::INFINITY;
    for _ in 0..200 {
        let x: Vec<f64> = hessian.iter().map(|_| random.next()).collect();
        least = least.min(dot(&hessian, &x));
    }
    assert!(least < 0.0, "{least}");
    // A ring that becomes a star: there are steps with an indefinite Hessian, and frames all the same.
    let pair = hard();
    let morph = method("linear")
        .unwrap()
        .prepare(&pair, &Settings::default())
        .unwrap();
    let times: Vec<f64> = (1..10).map(|k| f64::from(k) / 10.0).collect();
    let frames = morph.frames(&times).unwrap();
    assert!(frames.iter().any(|frame| frame.solution.projected > 0));
    for frame in &frames {
        let solution = frame.solution;
        assert!(
            solution.residual < 1e-9 || solution.held_up > 0,
            "{solution:?}"
        );
    }
    let found = measure(&pair, &*morph, &times).unwrap();
    assert!(found.flips() == 0 && found.smallest_determinant() > 0.0);
    // Newton's plain steps say that they cannot.
    let plain = Settings {
        solver: Solver::Newton,
        ..Settings::default()
    };
    let plain = method("linear").unwrap().prepare(&pair, &plain).unwrap();
    let errors: Vec<FrameError> = times.iter().filter_map(|&t| plain.at(t).err()).collect();
    assert!(
        errors
            .iter()
            .any(|e| matches!(e, FrameError::Indefinite { .. })),
        "{errors:?}"
    );
}

/// S5b: eq. (12) leads from a converged frame to the next minimum: with many stages and with one the chain ends in the same place.
#[test]
fn s5b_continuation_ends_where_newton_does() {
    let pair = bend(8, 2, 4.0, 2.2, false);
    let chain = |stages, chain| Settings {
        solver: Solver::Continuation,
        stages,
        chain,
        ..Settings::default()
    };
    let wanted = at(&pair, "indifferent", &Settings::default(), 0.6);
    for settings in [chain(1, 30), chain(6, 30), chain(12, 8)] {
        let found = at(&pair, "indifferent", &settings, 0.6);
        assert!(apart(&found.positions, &wanted.positions) < 1e-8);
        assert!(found.solution.steps >= settings.stages);
    }
}

/// S6: a strain is that of its mirror image too, so that a target turned over is refused by name.
#[test]
fn s6_reflection_is_refused() {
    let pair = bend(4, 2, 2.0, 1.0, false);
    let energy = Energy::new(&pair, scheme("linear"), Shear::Tensor, 0.5);
    let mirror = |list: &[DVec2]| mapped(list, dvec2(-1.0, 0.0), dvec2(0.0, 1.0), DVec2::ZERO);
    let (here, there) = (pair.source(), mirror(pair.source()));
    assert!((energy.value(here) - energy.value(&there)).abs() < 1e-15);
    let elements = pair.elements().to_vec();
    let turned = Pair::new(here.to_vec(), mirror(pair.target()), elements.clone());
    let error = turned.unwrap_err();
    assert!(
        matches!(error, PairError::Turned { element: 0, .. }),
        "{error}"
    );
    // Both mirrored are a pair again, and one element alone is found.
    let both = Pair::new(there, mirror(pair.target()), elements.clone()).unwrap();
    at(&both, "indifferent", &Settings::default(), 0.5);
    let mut target = pair.target().to_vec();
    target[4] = target[1] * 2.0 - target[4];
    let error = Pair::new(here.to_vec(), target, elements).unwrap_err();
    assert!(error.to_string().contains("element"), "{error}");
}

/// S7: the angle of anchors is `R_A0B0 + t R`, the shorter way, and whole turns on request.
#[test]
fn s7_anchors_turn_evenly() {
    let (source, elements) = strip(5, 2, 3.0, false);
    let [x, y] = turned(2.8);
    let target = mapped(&source, x, y, dvec2(1.0, 2.0));
    let pair = Pair::new(source.clone(), target.clone(), elements).unwrap();
    let (a, b) = (3, 16);
    let angle = |list: &[DVec2]| {
        let d = list[b] - list[a];
        math::atan2(d.y, d.x)
    };
    for turns in [0, 1, -2] {
        let settings = Settings {
            rigid: Rigid::Anchors(a, b),
            turns,
            ..Settings::default()
        };
        for t in [0.2, 0.5, 0.9] {
            let found = at(&pair, "indifferent", &settings, t).positions;
            assert!(found[a].distance(source[a].lerp(target[a], t)) < 1e-12);
            let wanted = angle(&source) + t * (2.8 + TAU * f64::from(turns));
            assert!(wrapped(angle(&found) - wanted).abs() < 1e-10);
            // The default turns as often.
            let settings = Settings {
                turns,
                ..Settings::default()
            };
            let found = at(&pair, "indifferent", &settings, t).positions;
            assert!(wrapped(angle(&found) - wanted).abs() < 1e-10);
        }
    }
    let bad = |a, b| Settings {
        rigid: Rigid::Anchors(a, b),
        ..Settings::default()
    };
    for (settings, wanted) in [(bad(2, 2), "same place"), (bad(2, 900), "no element")] {
        let error = StrainMorph::new(&pair, scheme("linear"), &settings).unwrap_err();
        assert!(error.to_string().contains(wanted), "{error}");
    }
}

/// S8: strains are measured in the axes of the source, so that anchors do not change shapes; the default is the mean of unwound rotations, also of a
/// ring that closes, and the centroid of each frame's area goes straight.
#[test]
fn s8_motion_does_not_change_shapes() {
    for quads in [false, true] {
        let pair = bend(10, 2, 4.0, 3.0, quads);
        for name in ["indifferent", "modified", "linear", "log"] {
            let best = at(&pair, name, &Settings::default(), 0.45);
            for (a, b) in [(0, 2), (5, 30), (32, 1)] {
                let settings = Settings {
                    rigid: Rigid::Anchors(a, b),
                    ..Settings::default()
                };
                let other = at(&pair, name, &settings, 0.45);
                assert!(apart_rigidly(&other.positions, &best.positions) < 1e-9);
            }
        }
    }
    // A strip that closes to a ring: the mean gradient vanishes, the mean rotation does not.
    let pair = bend(40, 2, 20.0, TAU * 0.999, false);
    let area = |places: &[DVec2]| {
        let (mut sum, mut moment) = (0.0, DVec2::ZERO);
        for element in pair.elements() {
            let v = element.vertices();
            let (p, q, r) = (places[v[0]], places[v[1]], places[v[2]]);
            let twice = (q - p).perp_dot(r - p);
            sum += twice;
            moment += (p + q + r) / 3.0 * twice;
        }
        moment / sum
    };
    let mut middles = Vec::new();
    for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
        let found = at(&pair, "indifferent", &Settings::default(), t).positions;
        let wanted = area(pair.source()).lerp(area(pair.target()), t);
        assert!(area(&found).distance(wanted) < 1e-10);
        // The middle of the strip turns evenly by half of the whole angle.
        let (from, to) = (found[3 * 20 + 1], found[3 * 21 + 1]);
        middles.push(math::atan2(to.y - from.y, to.x - from.x));
    }
    let step = wrapped(middles[1] - middles[0]);
    for pair in middles.windows(2) {
        assert!(
            (wrapped(pair[1] - pair[0]) - step).abs() < 1e-2,
            "{middles:?}"
        );
    }
    assert!((step.abs() - PI / 4.0).abs() < 0.05, "{step}");
}

/// S9: there and back differ; the symmetric energy makes them the same for schemes that are.
#[test]
fn s9_symmetry() {
    let (source, elements) = strip(8, 3, 3.0, false);
    let target = source
        .iter()
        .map(|p| dvec2(p.x * (1.0 + 0.4 * p.y), p.y * (1.0 + 0.5 * p.x)))
        .collect();
    let pair = Pair::new(source, target, elements).unwrap();
    let back = pair.reversed().unwrap();
    let times = [0.2, 0.5, 0.7];
    let differ = |name: &str, symmetric: bool| {
        let settings = Settings {
            symmetric,
            ..Settings::default()
        };
        let prepare = |pair: &Pair| method(name).unwrap().prepare(pair, &settings).unwrap();
        asymmetry(&pair, &*prepare(&pair), &*prepare(&back), &times).unwrap()
    };
    for name in ["indifferent", "linear", "modified", "log"] {
        assert!(differ(name, false) > 1e-4, "{name}");
        // Both are then the same sum of two energies, whatever the scheme.
        assert!(differ(name, true) < 1e-8, "{name}");
    }
}

/// S10, as far as strains go: a hole may open from a slit, whose edges lie on each other in the source.
#[test]
fn s10_a_hole_opens_from_a_slit() {
    let (mut source, mut elements) = strip(6, 4, 3.0, false);
    // Two edges of the middle row are cut: the vertex between them is doubled for the elements above.
    let at = |i: usize, j: usize| i * 5 + j;
    let cut = at(3, 2);
    let first = source.len();
    source.push(source[cut]);
    for element in &mut elements {
        let Element::Triangle(list) = element else {
            panic!("triangles");
        };
        let above = list.iter().any(|&v| v % 5 > 2 && v < first);
        for v in list.iter_mut() {
            if above && *v == cut {
                *v = first;
            }
        }
    }
    let mut target = source.clone();
    target[cut].y -= 0.12;
    target[first].y += 0.12;
    let pair = Pair::new(source, target, elements).unwrap();
    let morph = method("indifferent")
        .unwrap()
        .prepare(&pair, &Settings::default())
        .unwrap();
    let times: Vec<f64> = (0..=10).map(|k| f64::from(k) / 10.0).collect();
    let found = measure(&pair, &*morph, &times).unwrap();
    assert_eq!((found.flips(), found.crossings()), (0, 0));
    let gaps: Vec<f64> = morph
        .frames(&times)
        .unwrap()
        .iter()
        .map(|f| f.positions[first].distance(f.positions[cut]))
        .collect();
    assert!(gaps.windows(2).all(|pair| pair[1] > pair[0]), "{gaps:?}");
}

/// S11: `½γ²` is the norm that no rotation of the axes changes; `γ²` as printed is not, and both can be had.
#[test]
fn s11_the_norm_of_the_tensor() {
    let pair = bend(6, 2, 3.0, 2.0, false);
    let [x, y] = turned(0.6);
    let turn = |list: &[DVec2]| mapped(list, x, y, DVec2::ZERO);
    let other = Pair::new(
        turn(pair.source()),
        turn(pair.target()),
        pair.elements().to_vec(),
    )
    .unwrap();
    let places: Vec<DVec2> = pair
        .source()
        .iter()
        .map(|p| dvec2(p.x * 1.1, p.y + 0.3 * p.x))
        .collect();
    for (shear, same) in [(Shear::Tensor, true), (Shear::Printed, false)] {
        let value = |pair: &Pair, places: &[DVec2]| {
            Energy::new(pair, scheme("indifferent"), shear, 0.3).value(places)
        };
        let (here, there) = (value(&pair, &places), value(&other, &turn(&places)));
        assert_eq!((here - there).abs() < 1e-13, same, "{here} {there}");
        let settings = Settings {
            shear,
            ..Settings::default()
        };
        let (here, there) = (
            at(&pair, "indifferent", &settings, 0.5),
            at(&other, "indifferent", &settings, 0.5),
        );
        let off = apart(&turn(&here.positions), &there.positions);
        assert_eq!(off < 1e-9, same, "{off:e}");
    }
    // ½ ∫ (ε_x² + ε_y² + s γ²) of one triangle of area ½, by hand.
    let corner = vec![DVec2::ZERO, DVec2::X, DVec2::Y];
    let pair = Pair::new(corner.clone(), corner, vec![[0, 1, 2].into()]).unwrap();
    let sheared = [DVec2::ZERO, DVec2::X, dvec2(0.5, 1.0)];
    for (shear, weight) in [(Shear::Tensor, 0.5), (Shear::Printed, 1.0)] {
        let found = Energy::new(&pair, scheme("linear"), shear, 0.5).value(&sheared);
        let wanted = 0.25 * (0.125 * 0.125 + weight * 0.25);
        assert!((found - wanted).abs() < 1e-16);
    }
}

/// S12: a spiral of one and a half turns uncurls; a ring turned inside out does not close, which is said.
#[test]
fn s12_rotations_are_unwound() {
    let pair = spiral(1.5);
    let morph = StrainMorph::new(&pair, scheme("indifferent"), &Settings::default()).unwrap();
    assert!(morph.open_windings().is_empty());
    let rigid = AsRigidAsPossible::new(&pair, &Settings::default()).unwrap();
    for t in [0.25, 0.5, 0.75] {
        let turning = |places: &[DVec2]| {
            // The sum of the turns along the middle line.
            let middle: Vec<DVec2> = places.chunks(3).map(|c| c[1]).collect();
            let edges: Vec<DVec2> = middle.windows(2).map(|p| p[1] - p[0]).collect();
            let turns = edges.windows(2).map(|e| e[0].angle_to(e[1]));
            turns.sum::<f64>()
        };
        let (whole, found) = (
            turning(pair.source()),
            turning(&morph.at(t).unwrap().positions),
        );
        assert!(
            (found - (1.0 - t) * whole).abs() < 0.15,
            "{t}: {found} of {whole}"
        );
        // Without unwinding it does not.
        let rigid = turning(&rigid.at(t).unwrap().positions);
        assert!((rigid - (1.0 - t) * whole).abs() > 0.5, "{t}: {rigid}");
    }
    // Inside out by inversion: the derivative of 1/z winds twice about the hole.
    let source = ring(48, 3, |a, s| dvec2(a.cos(), a.sin()) * (1.0 + s));
    let target = ring(48, 3, |a, s| dvec2(a.cos(), -a.sin()) / (1.0 + s));
    let pair = Pair::new(source, target, ring_elements(48, 3)).unwrap();
    let morph = StrainMorph::new(&pair, scheme("indifferent"), &Settings::default()).unwrap();
    let open = morph.open_windings();
    assert!(!open.is_empty() && open.len() < 24, "{open:?}");
}

/// S13: any time on its own, in any order; the same as along the chain.
#[test]
fn s13_every_time_stands_alone() {
    let pair = bend(8, 2, 4.0, 2.0, true);
    let prepare = || StrainMorph::new(&pair, scheme("log"), &Settings::default()).unwrap();
    let morph = prepare();
    let later = morph.at(0.8).unwrap();
    let sooner = morph.at(0.2).unwrap();
    assert_eq!(prepare().at(0.2).unwrap(), sooner);
    assert_eq!(morph.at(0.8).unwrap(), later);
    assert_eq!(
        prepare().frames(&[0.8, 0.2]).unwrap(),
        [later.clone(), sooner]
    );
    let chain = Settings {
        solver: Solver::Continuation,
        ..Settings::default()
    };
    let chained = at(&pair, "log", &chain, 0.8);
    assert!(apart(&chained.positions, &later.positions) < 1e-9);
    assert!(chained.solution.steps > 5 * later.solution.steps);
}

/// What is no pair says so.
#[test]
fn wrong_meshes_are_refused_by_name() {
    let (source, elements) = strip(2, 1, 2.0, false);
    let pair = |source: &[DVec2], target: &[DVec2], elements: &[Element]| {
        Pair::new(source.to_vec(), target.to_vec(), elements.to_vec()).unwrap_err()
    };
    assert!(matches!(
        pair(&source, &source[1..], &elements),
        PairError::Counts { .. }
    ));
    assert_eq!(pair(&source, &source, &[]), PairError::NoElements);
    let wrong = [Element::from([0, 1, 9])];
    assert!(matches!(
        pair(&source, &source, &wrong),
        PairError::Index {
            element: 0,
            vertex: 9,
            count: 6
        }
    ));
    let wrong = [Element::from([0, 1, 1])];
    assert!(matches!(
        pair(&source, &source, &wrong),
        PairError::Repeated { vertex: 1, .. }
    ));
    let mut wild = source.clone();
    wild[3].y = f64::NAN;
    assert_eq!(
        pair(&source, &wild, &elements),
        PairError::NotFinite {
            side: Side::Target,
            vertex: 3
        }
    );
    let mut thrice = elements.clone();
    thrice.push([0, 2, 1].into());
    thrice.push([0, 2, 3].into());
    assert!(matches!(
        pair(&source, &source, &thrice),
        PairError::Edge { .. }
    ));
    // A quadrilateral that is not convex.
    let dart = [
        dvec2(0.0, 0.0),
        dvec2(2.0, 0.0),
        dvec2(0.4, 0.4),
        dvec2(0.0, 2.0),
    ];
    assert!(matches!(
        pair(&dart, &dart, &[[0, 1, 2, 3].into()]),
        PairError::Degenerate { element: 0, .. }
    ));
}
