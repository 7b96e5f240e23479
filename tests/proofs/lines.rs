//! B10, B11, B12: lines, elements and global lines.

use anamorph_core::guarantees::{Verdict, interpolation};
use anamorph_core::{
    Affine, Binding, Deformation, Linear, Plane, Scaling, Site, Smoothness, Solid, Space, Warp,
    deforming_function, evaluate_points,
    glam::{dvec2, dvec3},
    map_all, reference,
};
use anamorph_features::{Element, ElementPair};
use anamorph_tests::measure::linear_distance;
use anamorph_tests::random::Random;
use anamorph_transforms::Rotational;
use anamorph_warps::lines::elements::ElementWarp;
use anamorph_warps::lines::{ElementError, WeightConstants, global, local};

type Line = (ElementPair<Plane>, WeightConstants);

fn line(source: [Plane; 2], target: [Plane; 2], [a, b, p]: [f64; 3]) -> Line {
    let pair = ElementPair::of_corners(&source, &target).unwrap();
    (pair, WeightConstants { a, b, p })
}

fn both(lines: &[Line]) -> [ElementWarp<Plane>; 2] {
    let scaling = Scaling::Displacement;
    [
        local::construct(lines, scaling).unwrap(),
        global::construct(lines, scaling).unwrap(),
    ]
}

fn random_constants(random: &mut Random) -> [f64; 3] {
    let a = [0.0, 0.01, 0.7][random.below(3)];
    let b = [0.5, 1.0, 2.0, 2.7][random.below(4)];
    [a, b, [0.0, 0.5, 1.0][random.below(3)]]
}

/// B10 (and B12): a rotation and translation of all lines is one of the plane. A scale is not: across, nothing scales.
#[test]
fn b10_rigid_motions_of_all_lines_are_reproduced() {
    let mut random = Random::new(101);
    for _ in 0..60 {
        let motion = Affine::<Plane>::new(random.rotation::<Plane>(), random.vector());
        let count = 1 + random.below(6);
        let list: Vec<[Plane; 2]> = (0..count)
            .map(|_| [random.vector(), random.vector()])
            .collect();
        let constants = random_constants(&mut random);
        let moved = |map: &dyn Fn(Plane) -> Plane| -> Vec<Line> {
            let lines = list.iter();
            lines.map(|&s| line(s, s.map(map), constants)).collect()
        };
        for warp in both(&moved(&|p| motion.apply(p))) {
            for _ in 0..40 {
                let p = random.vector::<Plane>() * 3.0;
                let error = warp.map(&Site::anywhere(p)).distance(motion.apply(p));
                assert!(error < 1e-12, "{error}");
            }
        }
        // A scale of one line along itself leaves what is across.
        let [warp, _] = both(&moved(&|p| p * 2.0)[..1]);
        let [from, to] = list[0];
        let normal = (to - from).perp().normalized().unwrap();
        let image = warp.map(&Site::anywhere(from + normal));
        assert!(image.distance(from * 2.0 + normal) < 1e-12);
    }
}

/// B12: two crossing lines, one turned by 60°: the local variant folds, the global one shears.
#[test]
fn b12_crossing_lines_fold_locally_and_not_globally() {
    let turned = dvec2(3_f64.sqrt() / 2.0, 0.5);
    let [a, b, p] = [0.02, 2.0, 0.0];
    let lines = [
        line([-Plane::X, Plane::X], [-Plane::X, Plane::X], [a, b, p]),
        line([-Plane::Y, Plane::Y], [-turned, turned], [a, b, p]),
    ];
    let [local, global] = both(&lines);
    let least = |warp: &ElementWarp<Plane>| {
        let mut random = Random::new(102);
        let mut least = f64::INFINITY;
        for _ in 0..4000 {
            let site = Site::anywhere(random.vector::<Plane>() * 2.0);
            let jacobian = warp.jacobian(&site, 4.0).unwrap();
            least = Linear::<Plane>::determinant(&jacobian).min(least);
        }
        least
    };
    let (folds, shears) = (least(&local), least(&global));
    assert!(folds < -0.05, "{folds}");
    assert!(shears > 0.4, "{shears}");
    // It is the shear that both lines ask for, nearly: a to the line's length is 0.01.
    let shear = |p: Plane| Plane::X * p.x + turned * p.y;
    for p in [dvec2(1.0, 1.0), dvec2(-0.5, 0.3), dvec2(0.2, -1.4)] {
        assert!(global.map(&Site::anywhere(p)).distance(shear(p)) < 0.03);
        assert!(local.map(&Site::anywhere(p)).distance(shear(p)) > 0.1);
    }
    // Without `a` exactly: perpendicular lines have infinite weights in each other's averages.
    let exact = lines.map(|(pair, _)| (pair, WeightConstants::default()));
    let [_, global] = both(&exact);
    for p in [dvec2(1.0, 1.0), dvec2(-0.5, 0.3)] {
        assert!(global.map(&Site::anywhere(p)).distance(shear(p)) < 1e-14);
    }
    // Parallel lines that slide against each other fold under both.
    let slide = dvec2(3.0, 0.0);
    let ends = |y: f64| [dvec2(-1.0, y), dvec2(1.0, y)];
    let sliding = [
        line(ends(0.0), ends(0.0), [0.02, 2.0, 0.0]),
        line(ends(0.2), ends(0.2).map(|p| p + slide), [0.02, 2.0, 0.0]),
    ];
    let image = |warp: &ElementWarp<Plane>, p| warp.map(&Site::anywhere(p));
    for warp in both(&sliding) {
        // Beyond the upper line points go less far than on it, a step to its left farther than one to its right.
        let (left, right) = (dvec2(1.05, 0.2), dvec2(1.6, 0.2));
        assert!(image(&warp, left).x > image(&warp, right).x);
    }
}

/// B12: opposed rotations leave no direction across, and the line is named.
#[test]
fn b12_opposed_rotations_are_refused_by_name() {
    let quarter = |angle: f64, p: Plane| Plane::rotation(Plane::ZERO, angle).apply(p);
    let star = |angles: [f64; 3]| -> Vec<Line> {
        [dvec2(1.0, 0.0), dvec2(0.0, 1.0), dvec2(1.0, 0.0)]
            .into_iter()
            .zip(angles)
            .map(|(v, angle)| {
                let to = quarter(angle, v);
                line([-v, v], [-to, to], [0.0, 2.0, 0.0])
            })
            .collect()
    };
    let (up, down) = (core::f64::consts::FRAC_PI_2, -core::f64::consts::FRAC_PI_2);
    // Both lines across line 1 turn against each other.
    let refused = global::construct(&star([up, 0.3, down]), Scaling::Displacement);
    let error = refused.err().unwrap();
    assert_eq!(error.feature(), 1);
    assert!(matches!(error, ElementError::ShortNormal { length, .. } if length < 1e-3));
    // A little less than opposed is served.
    assert!(global::construct(&star([up, 0.3, down + 0.01]), Scaling::Displacement).is_ok());
}

fn element<S: Space>(random: &mut Random, count: usize) -> Element<S> {
    loop {
        let corners: Vec<S> = (0..=count).map(|_| random.vector()).collect();
        if let Ok(element) = Element::new(&corners)
            && (element.size() > 0.3 || count == 0)
        {
            return element;
        }
    }
}

fn b11<S: Rotational>() {
    let mut random = Random::new(103);
    for round in 0..200 {
        let count = round % (S::DIM + 1);
        let source = element::<S>(&mut random, count);
        let target = element::<S>(&mut random, count);
        let pair = ElementPair { source, target };
        let constants = WeightConstants::default();
        let warp = ElementWarp::construct(&[(pair, constants)], Scaling::Displacement).unwrap();
        let site = Site::anywhere(random.vector::<S>());
        let map = deforming_function(&warp, &site);
        // As many basis vectors as edges go where the target's are.
        for i in 0..count {
            let error = map.linear.apply(source.edge(i)) - target.edge(i);
            assert!(error.length() < 1e-11, "{count}: {}", error.length());
        }
        assert!(map.apply(source.corner()).distance(target.corner()) < 1e-11);
        // The others keep length and right angles: Aᵀ A has the eigenvalue 1 for each, with an eigenvector across.
        let metric = map.linear.transposed().after(&map.linear);
        let mut across = random.vector::<S>();
        match (count, source.normal()) {
            (0, _) => {}
            (_, Some(normal)) => across = normal,
            (1, None) => across -= source.direction(0) * source.direction(0).dot(across),
            _ => continue,
        }
        assert!((metric.apply(across) - across).length() < 1e-10, "{count}");
        if count == 0 {
            assert_eq!(map.linear, S::Linear::IDENTITY);
        }
    }
}

/// B11: points, segments, rectangles and boxes constrain 0, 1, 2 and 3 basis vectors.
#[test]
fn b11_elements_constrain_as_many_vectors_as_they_have_edges() {
    b11::<Plane>();
    b11::<Solid>();
}

/// Random elements of all kinds.
fn mixed<S: Rotational>(
    random: &mut Random,
    constants: [f64; 3],
) -> Vec<(ElementPair<S>, WeightConstants)> {
    let [a, b, p] = constants;
    (0..2 + random.below(4))
        .map(|_| {
            let count = random.below(S::DIM + 1);
            let source = element::<S>(random, count);
            let target = element::<S>(random, count);
            (ElementPair { source, target }, WeightConstants { a, b, p })
        })
        .collect()
}

fn b11_together<S: Rotational>() {
    let mut random = Random::new(104);
    for _ in 0..60 {
        let constants = random_constants(&mut random);
        for scaling in [Scaling::Displacement, Scaling::Composition] {
            let warp =
                ElementWarp::<S>::construct(&mixed(&mut random, constants), scaling).unwrap();
            let points: Vec<S> = (0..50).map(|_| random.vector::<S>() * 2.0).collect();
            let (mut fast, mut plain) = (points.clone(), points.clone());
            map_all(&warp, &mut fast);
            evaluate_points(&warp, 0, &mut plain);
            let mut bound = points.clone();
            Binding::new(&warp, &points).map_points(&warp, 0, &mut bound);
            assert_eq!(bound, plain);
            for ((&p, &q), &r) in points.iter().zip(&fast).zip(&plain) {
                let literal = reference::evaluate(&warp, &Site::anywhere(p));
                let size = 1.0 + literal.length();
                assert!(q.distance(literal) < 1e-13 * size && q.distance(r) < 1e-13 * size);
            }
        }
    }
}

#[test]
fn b11_all_kinds_in_one_warp_equal_the_literal_formula() {
    b11_together::<Plane>();
    b11_together::<Solid>();
}

/// Rigid motions of all elements are reproduced, of a point and a box alike; a point by itself knows no rotation.
#[test]
fn b11_boxes_reproduce_any_affine_map() {
    let mut random = Random::new(105);
    let boxes: Vec<Element<Solid>> = (0..4).map(|_| element(&mut random, 3)).collect();
    let map = Affine::<Solid>::new(random.linear::<Solid>(), random.vector());
    let pairs = boxes.iter().map(|source| {
        let ends = |e: &Element<Solid>| {
            [
                e.corner(),
                e.corner() + e.edge(0),
                e.corner() + e.edge(1),
                e.corner() + e.edge(2),
            ]
        };
        let target = ends(source).map(|p| map.apply(p));
        let pair = ElementPair::of_corners(&ends(source), &target).unwrap();
        (pair, WeightConstants::default())
    });
    let warp = ElementWarp::construct(&pairs.collect::<Vec<_>>(), Scaling::Displacement).unwrap();
    for _ in 0..100 {
        let p = random.vector::<Solid>() * 3.0;
        assert!(warp.map(&Site::anywhere(p)).distance(map.apply(p)) < 1e-9);
    }
}

/// With `a = 0` elements that do not touch are met exactly, throughout; with `a > 0` nearly, and the report says so.
#[test]
fn elements_are_met_exactly_without_a() {
    let ends = [dvec3(-1.0, 0.0, 0.0), dvec3(1.0, 0.2, 0.0)];
    let plate = [
        dvec3(0.0, 1.0, 1.0),
        dvec3(1.0, 1.0, 1.5),
        dvec3(0.0, 2.0, 1.0),
    ];
    let solid = [
        dvec3(0.0, 1.0, -1.0),
        dvec3(1.0, 1.0, -1.0),
        dvec3(0.0, 2.0, -1.0),
        dvec3(0.1, 1.0, -2.0),
    ];
    let spread = |p: Solid| dvec3(p.x + 0.3 * p.y, p.y * 1.2, p.z - 0.1 * p.x);
    for (a, b, verdict) in [
        (0.0, 2.0, Verdict::Proved),
        (0.0, 0.5, Verdict::Proved),
        (0.1, 2.0, Verdict::Refuted),
        (0.0, 0.0, Verdict::Refuted),
    ] {
        let constants = WeightConstants { a, b, p: 0.0 };
        let mut pairs: Vec<_> = [&ends[..], &plate, &solid]
            .iter()
            .map(|source| {
                let target: Vec<Solid> = source.iter().map(|&p| spread(p)).collect();
                (ElementPair::of_corners(source, &target).unwrap(), constants)
            })
            .collect();
        let pinned = [dvec3(-1.0, -1.0, -1.0)];
        pairs.push((
            ElementPair::of_corners(&pinned, &pinned).unwrap(),
            constants,
        ));
        let warp = ElementWarp::construct(&pairs, Scaling::Displacement).unwrap();
        assert_eq!(interpolation(&warp, 4.0).verdict, verdict, "{a}, {b}");
        assert_eq!(warp.conditions().len(), 5 + 5 + 9 + 1);
        if verdict == Verdict::Proved {
            // Inside of the box, too.
            let mut random = Random::new(106);
            for _ in 0..50 {
                let s = [0; 3].map(|_| random.between(0.0, 1.0));
                let source = Element::new(&solid).unwrap();
                let landed = warp.map(&Site::anywhere(source.at(s)));
                assert!(landed.distance(spread(source.at(s))) < 1e-12);
            }
        }
    }
}

/// What elements claim about continuity follows how they meet.
#[test]
fn lines_that_part_where_they_touch_jump_and_say_which() {
    let class = |lines: &[Line]| {
        let facts = both(lines)[0].facts();
        let named = facts.notes.iter().any(|n| n.contains("features 0 and 1"));
        (facts.smoothness(), named)
    };
    let [x, y, o] = [Plane::X, Plane::Y, Plane::ZERO];
    let exact = [0.0, 2.0, 0.0];
    let soft = [0.1, 2.0, 0.0];
    // Apart: C1 with b > 1, C0 with less or with a.
    let apart = |constants| {
        [
            line([o, x], [o, y], constants),
            line([y, y + x], [y, x * 2.0], constants),
        ]
    };
    assert_eq!(class(&apart(exact)), (Smoothness::C(1), false));
    assert_eq!(class(&apart([0.0, 1.0, 0.0])), (Smoothness::C(0), false));
    assert_eq!(class(&apart(soft)), (Smoothness::C(0), false));
    assert_eq!(class(&apart([0.0, 0.0, 1.0])), (Smoothness::Smooth, false));
    // Joined at an end that both take to one place; then to two.
    let joined = |to: Plane| {
        [
            line([o, x], [o, x * 2.0], exact),
            line([x, x + y], [to, x + y], exact),
        ]
    };
    assert_eq!(class(&joined(x * 2.0)), (Smoothness::C(0), false));
    assert_eq!(class(&joined(x * 1.5)), (Smoothness::Jump, true));
    // In one place with other targets; and the same with a finite pull.
    let double = |constants| {
        [
            line([o, x], [o, y], constants),
            line([o, x], [x, y], constants),
        ]
    };
    assert_eq!(class(&double(exact)), (Smoothness::Jump, true));
    assert_eq!(class(&double(soft)), (Smoothness::C(0), false));
    // The documented mean.
    let [warp, _] = both(&double(exact));
    let middle = warp.map(&Site::anywhere(x * 0.5));
    assert!(middle.distance((y * 0.5 + (x + y) * 0.5) * 0.5) < 1e-15);
    // One line alone is an affine map, smooth; one that stays is nothing at all.
    assert_eq!(class(&apart(exact)[..1]), (Smoothness::Smooth, false));
    let still = both(&[line([o, x], [o, x], exact)]);
    assert_eq!(still[0].facts().support, anamorph_core::Support::Nowhere);
}

/// Coordinates near the ends of the range of numbers scale like others.
#[test]
fn lines_scale_with_the_model() {
    let mut random = Random::new(107);
    let list: Vec<[Plane; 4]> = (0..4).map(|_| [0; 4].map(|_| random.vector())).collect();
    let points: Vec<Plane> = (0..40).map(|_| random.vector::<Plane>() * 2.0).collect();
    for constants in [[0.0, 2.0, 0.0], [0.3, 1.5, 0.5], [0.01, 0.5, 1.0]] {
        let at = |size: f64, variant: usize| -> Vec<Plane> {
            let [a, b, p] = constants;
            let lines: Vec<Line> = list
                .iter()
                .map(|l| {
                    let [s, t, u, v] = l.map(|p| p * size);
                    line([s, t], [u, v], [a * size, b, p])
                })
                .collect();
            let warp = &both(&lines)[variant];
            let mut moved: Vec<Plane> = points.iter().map(|&p| p * size).collect();
            assert!(map_all(warp, &mut moved).is_empty());
            moved.iter().map(|&q| q / size).collect()
        };
        for variant in [0, 1] {
            let plain = at(1.0, variant);
            for size in [1e-150, 1e-60, 1e60, 1e150] {
                for (&q, &expected) in at(size, variant).iter().zip(&plain) {
                    assert!(q.distance(expected) < 1e-10, "{constants:?}, {size:e}");
                }
            }
        }
    }
}

#[test]
fn bad_lines_are_refused_by_name() {
    let good = line(
        [Plane::ZERO, Plane::X],
        [Plane::ZERO, Plane::Y],
        [0.0, 2.0, 0.0],
    );
    let refuse = |bad: Line| {
        let [one, other] = [local::construct, global::construct].map(|construct| {
            construct(&[good, bad], Scaling::Displacement)
                .err()
                .unwrap()
        });
        assert_eq!(one.to_string(), other.to_string());
        assert_eq!(one.feature(), 1);
        one.to_string()
    };
    for (constants, name) in [
        ([-1e-9, 1.0, 0.0], "`a`"),
        ([f64::NAN, 1.0, 0.0], "`a`"),
        ([0.0, -0.5, 0.0], "`b`"),
        ([0.0, f64::INFINITY, 0.0], "`b`"),
        ([0.0, 1.0, -1.0], "`p`"),
    ] {
        let [a, b, p] = constants;
        let text = refuse((good.0, WeightConstants { a, b, p }));
        assert!(text.contains(name), "{text}");
    }
    let point = ElementPair::of_corners(&[Plane::ZERO], &[Plane::X]).unwrap();
    assert!(refuse((point, good.1)).contains("a line has 2"));
    let tiny = ElementPair::of_corners(
        &[Plane::ZERO, Plane::X * 1e-200],
        &[Plane::ZERO, Plane::X * 1e200],
    );
    assert!(refuse((tiny.unwrap(), good.1)).contains("overflows"));
    assert!(ElementPair::of_corners(&[Plane::NAN; 2], &[Plane::ZERO; 2]).is_err());
    assert!(
        linear_distance::<Plane>(
            &good.0.affine().unwrap().linear,
            &Plane::rotation(Plane::ZERO, core::f64::consts::FRAC_PI_2)
        ) < 1e-15
    );
}
