//! Rows of the errata on feature lines, pinned by name: F6, F7 and C18.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::{
    Deformation, Influences, Linear, Modulated, Plane, Scaling, Site, Space, Warp, glam::dvec2,
    map_all, reference,
};
use anamorph_features::ElementPair;
use anamorph_tests::random::Random;
use anamorph_warps::lines::elements::ElementWarp;
use anamorph_warps::lines::global::LEAST_NORMAL;
use anamorph_warps::lines::{ElementError, WeightConstants, global, local};

type Line = (ElementPair<Plane>, WeightConstants);

fn line(source: [Plane; 2], target: [Plane; 2], [a, b, p]: [f64; 3]) -> Line {
    let pair = ElementPair::of_corners(&source, &target).unwrap();
    (pair, WeightConstants { a, b, p })
}

fn local_warp(lines: &[Line]) -> ElementWarp<Plane> {
    local::construct(lines, Scaling::Displacement).unwrap()
}

fn global_warp(lines: &[Line]) -> ElementWarp<Plane> {
    global::construct(lines, Scaling::Displacement).unwrap()
}

fn at(warp: &dyn Deformation<Plane>, p: Plane) -> Plane {
    warp.map(&Site::anywhere(p))
}

const X: [Plane; 2] = [Plane::NEG_X, Plane::X];
const Y: [Plane; 2] = [Plane::NEG_Y, Plane::Y];

/// Feature numbers and shares of the weights at a point.
fn shares(warp: &ElementWarp<Plane>, p: Plane) -> Vec<(u32, f64)> {
    let mut list = Influences::default();
    warp.influences(&Site::anywhere(p), &mut list);
    let infinite = list.list.iter().any(|i| i.weight == f64::INFINITY);
    let weight = |w: f64| {
        if infinite {
            f64::from(w == f64::INFINITY)
        } else {
            w
        }
    };
    let total: f64 = list.list.iter().map(|i| weight(i.weight)).sum();
    let all = list.list.iter();
    all.map(|i| (i.address.feature, weight(i.weight) / total))
        .collect()
}

/// F6: `(length^p / (a + dist))^b`, `dist` to the segment, not to its line.
#[test]
fn f6_the_weight_is_of_the_segment() {
    let [a, b, p] = [0.25, 1.5, 0.5];
    let upper = [dvec2(3.0, 2.0), dvec2(3.0, 5.0)];
    let warp = local_warp(&[line(X, X, [a, b, p]), line(upper, upper, [a, b, p])]);
    for point in [
        dvec2(0.5, 0.5),
        dvec2(2.0, 0.0),
        dvec2(3.0, 0.0),
        dvec2(-4.0, 3.0),
    ] {
        let nearest = dvec2(point.x.clamp(-1.0, 1.0), 0.0);
        let other = dvec2(3.0, point.y.clamp(2.0, 5.0));
        let weight = |length: f64, d: f64| (length.powf(p) / (a + d)).powf(b);
        let (w, v) = (
            weight(2.0, point.distance(nearest)),
            weight(3.0, point.distance(other)),
        );
        let found = shares(&warp, point);
        assert!((found[0].1 - w / (w + v)).abs() < 1e-12);
        assert!((found[1].1 - v / (w + v)).abs() < 1e-12);
    }
}

/// F6: plain powers over- and underflow on finite input; by logarithms nothing does, and where both can be had they agree.
#[test]
fn f6_powers_neither_overflow_nor_underflow() {
    let up = X.map(|p| p + dvec2(0.0, 3.0));
    let shift = |l: [Plane; 2], by: Plane| l.map(|p| p + by);
    // The upper line is nearer by a factor of 2; with b = 3000 both weights underflow.
    for (b, near) in [
        (3000.0, 1.0),
        (1e6, 1.0),
        (2.0, 0.8),
        (200.0, 1.0),
        (0.0, 0.5),
    ] {
        let warp = local_warp(&[
            line(X, shift(X, dvec2(5.0, 0.0)), [0.0, b, 0.0]),
            line(up, shift(up, dvec2(0.0, 7.0)), [0.0, b, 0.0]),
        ]);
        let found = shares(&warp, dvec2(0.0, 2.0));
        assert!((found[1].1 - near).abs() < 1e-12, "{b}: {found:?}");
        let moved = at(&warp, dvec2(0.0, 2.0)) - dvec2(0.0, 2.0);
        assert!(moved.distance(dvec2(5.0 * (1.0 - near), 7.0 * near)) < 1e-11);
    }
    // Ratios that are in range though neither weight is: the distances are 1e80 and 1.25e80, to the power of 5.
    let far = |x: f64| [dvec2(x, 1.0), dvec2(x, -1.0)];
    let warp = local_warp(&[
        line(
            far(1e80),
            shift(far(1e80), dvec2(1e79, 0.0)),
            [0.0, 5.0, 1.0],
        ),
        line(far(-1.25e80), far(-1.25e80), [0.0, 5.0, 1.0]),
    ]);
    let share = 1.25_f64.powi(5) / (1.0 + 1.25_f64.powi(5));
    assert!((shares(&warp, Plane::ZERO)[0].1 - share).abs() < 1e-12);
    assert!((at(&warp, Plane::ZERO).x / 1e79 - share).abs() < 1e-12);
    // An ambient weight still compares with what was divided out.
    let weak = Modulated::new(Box::new(local_warp(&[line(
        X,
        shift(X, Plane::Y),
        [0.0, 120.0, 0.0],
    )])))
    .with_ambient(1e-150);
    let moved = at(&weak, dvec2(0.0, 100.0)).y - 100.0;
    assert!(
        (moved / 1e-90 - 1.0).abs() < 1e-6 || moved == 0.0,
        "{moved:e}"
    );
    let strong = at(&weak, dvec2(0.0, 0.5)).y - 0.5;
    assert_eq!(strong, 1.0);
}

/// F6: `a = 0` on a line is an infinite weight; such lines alone decide, of unlike ones those with the larger `b`.
#[test]
fn f6_lines_decide_alone_on_themselves() {
    let to = |v: Plane| X.map(|p| p + v);
    let exact = [0.0, 1.0, 0.5];
    let soft = line(Y, Y.map(|p| p + dvec2(9.0, 9.0)), [0.1, 4.0, 1.0]);
    let warp = local_warp(&[line(X, to(Plane::Y), exact), soft]);
    for x in [-1.0, -0.3, 0.0, 0.77, 1.0] {
        assert_eq!(at(&warp, dvec2(x, 0.0)), dvec2(x, 1.0));
    }
    // Equal b: the mean; unlike: the larger, whatever the others' weights.
    let two = |b: f64| {
        local_warp(&[
            line(X, to(Plane::Y), [0.0, b, 0.0]),
            line(Y, Y, [0.0, 1.0, 0.0]),
        ])
    };
    assert_eq!(at(&two(1.0), Plane::ZERO), dvec2(0.0, 0.5));
    assert_eq!(at(&two(2.0), Plane::ZERO), dvec2(0.0, 1.0));
    assert_eq!(at(&two(0.5), Plane::ZERO), Plane::ZERO);
    // b = 0: weight 1, and no infinity.
    assert_eq!(shares(&two(0.0), dvec2(0.5, 0.0)).len(), 2);
    let both = local_warp(&[line(X, to(Plane::Y), [0.0; 3]), line(Y, Y, [0.0; 3])]);
    assert_eq!(at(&both, dvec2(0.5, 0.0)), dvec2(0.5, 0.5));
    // Slanted lines, on which rounding hides the zero; a small b would show it.
    let slant = [dvec2(0.1, 0.3), dvec2(0.7, -0.9)];
    let weak = local_warp(&[
        line(slant, slant.map(|p| p + Plane::Y), [0.0, 0.25, 0.0]),
        line(Y, Y, [0.0, 0.25, 0.0]),
    ]);
    for share in [0.0, 0.1, 1.0 / 3.0, 0.7, 1.0] {
        let p = slant[0] * (1.0 - share) + slant[1] * share;
        assert!(at(&weak, p).distance(p + Plane::Y) < 1e-14, "{share}");
    }
}

/// F6: a source without length is a point, a target without length keeps the direction across.
#[test]
fn f6_lines_without_length() {
    let place = dvec2(0.5, -0.5);
    let point = line([place; 2], X, [0.0, 2.0, 0.0]);
    let warp = local_warp(&[point]);
    for p in [Plane::ZERO, place, dvec2(7.0, 3.0)] {
        assert!(at(&warp, p).distance(p + X[0] - place) < 1e-15);
    }
    assert!(warp.facts().translations_only);
    // With p > 0 it has no weight: alone, nothing moves; beside others, nothing changes. The report says so.
    let idle = line([place; 2], X, [0.0, 2.0, 0.5]);
    let alone = local_warp(&[idle]);
    assert_eq!(at(&alone, place), place);
    assert!(alone.facts().notes.iter().any(|n| n.contains("no weight")));
    let other = line(Y, X, [0.1, 2.0, 0.5]);
    let (with, without) = (local_warp(&[idle, other]), local_warp(&[other]));
    for p in [place, Plane::ONE] {
        assert_eq!(at(&with, p), at(&without, p));
    }
    for warp in [local_warp, global_warp] {
        let pressed = warp(&[line(X, [place; 2], [0.0, 2.0, 0.0])]);
        assert!(at(&pressed, dvec2(0.3, 0.25)).distance(place + dvec2(0.0, 0.25)) < 1e-15);
    }
}

/// F6: bound, plain and literal evaluation agree through all of it.
#[test]
fn f6_all_evaluators_agree_at_the_ends_of_the_range() {
    let mut random = Random::new(606);
    for round in 0..200 {
        let size = 10_f64.powf(random.between(-120.0, 120.0));
        let lines: Vec<Line> = (0..4)
            .map(|_| {
                let mut ends = || {
                    [
                        random.vector::<Plane>() * size,
                        random.vector::<Plane>() * size,
                    ]
                };
                let (source, target) = (ends(), ends());
                let b = [0.0, 0.3, 2.0, 40.0, 2000.0][round % 5];
                line(source, target, [0.0, b, [0.0, 1.0, 30.0][round % 3]])
            })
            .collect();
        for warp in [
            local_warp(&lines),
            global::construct(&lines, Scaling::Displacement).unwrap_or(local_warp(&lines)),
        ] {
            let mut points: Vec<Plane> = (0..20).map(|_| random.vector::<Plane>() * size).collect();
            points.push(lines[1].0.source.corner());
            let mut moved = points.clone();
            assert!(map_all(&warp, &mut moved).is_empty());
            for (&p, &q) in points.iter().zip(&moved) {
                let literal = reference::evaluate(&warp, &Site::anywhere(p));
                let scale = literal.largest().max(size);
                assert!(q.distance(literal) < 1e-11 * scale, "{round}");
            }
        }
    }
}

/// The target's direction across line `number`.
fn across(warp: &ElementWarp<Plane>, lines: &[Line], number: usize) -> Plane {
    let normal = lines[number].0.source.normal().unwrap();
    warp.affine(number).unwrap().linear.apply(normal)
}

/// F7: the formula, written out: absolute cosine, both summands lengths.
#[test]
fn f7_the_average_is_the_formula() {
    let mut random = Random::new(707);
    for _ in 0..100 {
        let apart: Vec<Line> = (0..4)
            .map(|i| {
                let from = dvec2(3.0 * f64::from(i), 0.0);
                let source = [from, from + random.direction::<Plane>()];
                let turn = random.between(-0.5, 0.5);
                let target = source.map(|p| Plane::rotation(Plane::ZERO, turn).apply(p));
                line(source, target, [0.2, 1.3, 0.5])
            })
            .collect();
        let warp = global_warp(&apart);
        for (i, (one, _)) in apart.iter().enumerate() {
            let (normal, own) = (one.source.normal().unwrap(), one.source.length(0));
            let (mut sum, mut total) = (Plane::ZERO, 0.0);
            for (other, c) in &apart {
                let dist = one
                    .source
                    .corners()
                    .iter()
                    .map(|&p| other.source.distance(p))
                    .chain(
                        other
                            .source
                            .corners()
                            .iter()
                            .map(|&p| one.source.distance(p)),
                    )
                    .fold(f64::INFINITY, f64::min);
                let cosine = one.source.direction(0).dot(other.source.direction(0)).abs();
                let length = other.source.length(0);
                let w = (length.powf(c.p)
                    / ((c.a + dist) * (c.a + cosine * (own * length).sqrt())))
                .powf(c.b);
                let angle = other.source.edge(0).angle_to(other.target.edge(0));
                sum += Plane::rotation(Plane::ZERO, angle).apply(normal) * w;
                total += w;
            }
            assert!(across(&warp, &apart, i).distance(sum / total) < 1e-12);
        }
    }
}

/// F7: antiparallel lines are alongside each other as parallel ones are; a plain dot product would prefer them.
#[test]
fn f7_the_sense_of_a_line_does_not_matter() {
    let turned = |l: [Plane; 2]| l.map(|p| Plane::rotation(Plane::ZERO, 0.7).apply(p));
    let up = X.map(|p| p + dvec2(0.3, 0.9));
    let c = [0.1, 2.0, 0.5];
    let lines = [line(X, X, c), line(up, turned(up), c)];
    let back = [up[1], up[0]];
    let reversed = [lines[0], line(back, turned(back), c)];
    let (one, other) = (global_warp(&lines), global_warp(&reversed));
    assert!(across(&one, &lines, 0).distance(across(&other, &reversed, 0)) < 1e-14);
}

/// F7: with `a = 0` the line itself is left out, or its infinite weight would make the variant the local one.
#[test]
fn f7_without_a_a_line_does_not_count_itself() {
    let c = [0.0, 2.0, 0.0];
    let up = X.map(|p| p + dvec2(0.3, 0.9));
    let turn = Plane::rotation(Plane::ZERO, 0.4);
    let turned = up.map(|p| turn.apply(p));
    let lines = [line(X, X, c), line(up, turned, c)];
    let (local, global) = (local_warp(&lines), global_warp(&lines));
    assert!(across(&local, &lines, 0).distance(Plane::Y) < 1e-15);
    assert!(across(&global, &lines, 0).distance(turn.apply(Plane::Y)) < 1e-15);
    // With none left it turns by itself.
    let alone = [lines[1]];
    let expected = turn.apply(Plane::Y);
    assert!(across(&global_warp(&alone), &alone, 0).distance(expected) < 1e-15);
    // Perpendicular lines have infinite weights in each other's averages, and then decide alone; of unlike b the larger.
    let lines = [
        line(X, X, c),
        line(up, turned, c),
        line(Y, Y.map(|p| turn.apply(p) * 2.0), c),
        line(Y.map(|p| p + Plane::X), Y, [0.0, 1.0, 0.0]),
    ];
    assert!(across(&global_warp(&lines), &lines, 0).distance(expected) < 1e-15);
}

/// F7: the weights keep their ratios when everything scales, `a` too.
#[test]
fn f7_scale_covariant() {
    let mut random = Random::new(708);
    let list: Vec<[Plane; 4]> = (0..5).map(|_| [0; 4].map(|_| random.vector())).collect();
    let built = |size: f64| {
        let lines: Vec<Line> = list
            .iter()
            .map(|l| {
                let [s, t, u, v] = l.map(|p| p * size);
                line([s, t], [u, v], [0.1 * size, 1.5, 0.5])
            })
            .collect();
        (global_warp(&lines), lines)
    };
    let (one, lines) = built(1.0);
    for size in [1e-3, 1e4, 1e-130, 1e130] {
        let (other, scaled) = built(size);
        for i in 0..5 {
            let (a, b) = (across(&one, &lines, i), across(&other, &scaled, i));
            assert!(a.distance(b) < 1e-12, "{size:e}");
        }
    }
}

/// F7: what rotations leave may be short, and is then short in the warp; below the threshold it is an error by name.
#[test]
fn f7_short_averages() {
    let c = [0.0, 2.0, 0.0];
    let turned = |angle: f64| Y.map(|p| Plane::rotation(Plane::ZERO, angle).apply(p));
    // Line 0 counts lines 1 and 2, which turn by ±angle: cos(angle) is left.
    let lines = |angle: f64| {
        [
            line(X, X, c),
            line(Y, turned(angle), c),
            line(Y, turned(-angle), c),
        ]
    };
    for angle in [0.3, 1.2, 1.569] {
        let warp = global_warp(&lines(angle));
        let short = across(&warp, &lines(angle), 0);
        assert!(short.distance(dvec2(0.0, angle.cos())) < 1e-12);
        let jacobian = warp
            .jacobian(&Site::anywhere(dvec2(0.5, 0.0)), 2.0)
            .unwrap();
        assert!((Linear::<Plane>::determinant(&jacobian) - angle.cos()).abs() < 1e-4);
    }
    for angle in [1.5701, core::f64::consts::FRAC_PI_2] {
        let error = global::construct(&lines(angle), Scaling::Displacement)
            .err()
            .unwrap();
        let ElementError::ShortNormal {
            feature,
            length,
            least,
        } = error
        else {
            panic!("{error}");
        };
        assert_eq!((feature, least), (0, LEAST_NORMAL));
        assert!((length - angle.cos()).abs() < 1e-12);
        assert!(
            ElementError::ShortNormal {
                feature,
                length,
                least
            }
            .to_string()
            .contains("feature 0")
        );
    }
}

/// C18: the coordinate across a line is signed and a length; only the one along it scales with the line.
#[test]
fn c18_across_is_signed_and_does_not_scale() {
    let target = [dvec2(5.0, 0.0), dvec2(5.0, 6.0)];
    let warp = local_warp(&[line(
        [Plane::ZERO, dvec2(2.0, 0.0)],
        target,
        [0.0, 2.0, 0.0],
    )]);
    for (p, q) in [
        // Halfway along is halfway along; one unit to the left is one unit to the left.
        (dvec2(1.0, 1.0), dvec2(4.0, 3.0)),
        (dvec2(1.0, -1.0), dvec2(6.0, 3.0)),
        (dvec2(4.0, 0.5), dvec2(4.5, 12.0)),
    ] {
        assert!(at(&warp, p).distance(q) < 1e-14, "{p}: {}", at(&warp, p));
    }
}
