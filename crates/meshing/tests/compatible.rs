//! Compatible triangulations of shapes that differ much: checked by what knows nothing of how they were made.

// A test that cannot be set up has nothing to say.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_meshing::compatible::{
    CompatibleError, CompatibleOptions, CompatiblePair, PairFault, PairQuality, compatible,
};
use anamorph_meshing::planar::{Fineness, Region, RegionError, area, triangulate};

/// Points evenly along a closed polygon, its first corner first.
fn along(corners: &[[f64; 2]], count: usize) -> Vec<DVec2> {
    let corners: Vec<DVec2> = corners.iter().map(|&p| p.into()).collect();
    let next = |i: usize| corners[(i + 1) % corners.len()];
    let length: f64 = (0..corners.len())
        .map(|i| corners[i].distance(next(i)))
        .sum();
    let (mut points, mut edge, mut before) = (Vec::new(), 0, 0.0);
    for i in 0..count {
        let wanted = length * i as f64 / count as f64;
        while before + corners[edge].distance(next(edge)) < wanted {
            before += corners[edge].distance(next(edge));
            edge += 1;
        }
        let share = (wanted - before) / corners[edge].distance(next(edge));
        points.push(corners[edge].lerp(next(edge), share));
    }
    points
}

fn circle(centre: DVec2, radius: f64, count: usize, turn: f64) -> Vec<DVec2> {
    let angle = |i: usize| turn + core::f64::consts::TAU * i as f64 / count as f64;
    (0..count)
        .map(|i| centre + radius * DVec2::from_angle(angle(i)))
        .collect()
}

fn star(count: usize, inner: f64) -> Vec<DVec2> {
    let corners: Vec<[f64; 2]> = (0..10)
        .map(|i| {
            let radius = if i % 2 == 0 { 1.0 } else { inner };
            (radius * DVec2::from_angle(core::f64::consts::TAU * f64::from(i) / 10.0)).into()
        })
        .collect();
    along(&corners, count)
}

/// A strip along a path, of a width.
fn strip(path: impl Fn(f64) -> DVec2, width: f64, count: usize) -> Vec<DVec2> {
    let side = |t: f64, sign: f64| {
        let step = 1e-4;
        let way = (path(t + step) - path(t - step)).normalize();
        path(t) + sign * 0.5 * width * way.perp()
    };
    let t = |i: usize| i as f64 / count as f64;
    let below = (0..=count).map(|i| side(t(i), -1.0));
    let above = (0..=count).rev().map(|i| side(t(i), 1.0));
    below.chain(above).collect()
}

const CORNER: [[f64; 2]; 6] = [
    [0., 0.],
    [2., 0.],
    [2., 0.5],
    [0.5, 0.5],
    [0.5, 2.],
    [0., 2.],
];
const SQUARE: [[f64; 2]; 4] = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]];
const SHEET: [[f64; 2]; 4] = [[0., 0.], [3., 0.], [3., 2.], [0., 2.]];

fn solid(outer: Vec<DVec2>) -> Region {
    let holes = Vec::new();
    Region { outer, holes }
}

fn check(source: &Region, target: &Region) -> CompatiblePair {
    let pair = compatible(source, target, &[], &CompatibleOptions::default()).unwrap();
    let quality = pair.check().unwrap();
    // The rings are those given, bit for bit.
    for (own, region) in [(&pair.source, source), (&pair.target, target)] {
        for (ring, points) in pair.rings.iter().zip(region.rings()) {
            for (i, p) in ring.iter().zip(points) {
                assert_eq!(own[*i as usize], *p);
            }
        }
    }
    assert!(pair.triangles.len() < 16 * source.len(), "{quality:?}");
    // As it was laid over each other it is valid, too.
    let raw = CompatibleOptions {
        improve: false,
        ..CompatibleOptions::default()
    };
    let raw = compatible(source, target, &[], &raw).unwrap();
    let before = raw.check().unwrap();
    assert_eq!(raw.triangles.len(), pair.overlaid);
    let least = |q: &PairQuality| q.smallest_angle[0].min(q.smallest_angle[1]);
    assert!(least(&quality) >= least(&before), "{before:?} {quality:?}");
    for region in [(&pair.source, source), (&pair.target, target)] {
        let areas = pair
            .triangles
            .iter()
            .map(|t| area(&t.map(|i| region.0[i as usize])));
        let largest = areas.fold(0.0, f64::max) / region.1.area();
        assert!(largest < 0.0101, "{largest}");
    }
    pair
}

#[test]
fn shapes_without_holes() {
    let square = solid(along(&SQUARE, 40));
    let corner = solid(along(&CORNER, 40));
    check(&square, &corner);
    check(&corner, &square);
    let (sharp, round) = (
        solid(star(60, 0.25)),
        solid(circle(DVec2::ZERO, 1.0, 60, 0.0)),
    );
    check(&sharp, &round);
    check(&round, &sharp);
    check(&solid(star(60, 0.4)), &solid(along(&CORNER, 60)));
}

#[test]
fn a_spiral_of_one_and_a_half_turns_and_a_bar() {
    let bar = solid(strip(|t| dvec2(10.0 * t, 0.0), 0.5, 60));
    let spiral = solid(strip(
        |t| {
            let angle = 3.0 * core::f64::consts::PI * t;
            (0.8 + 0.25 * angle) * DVec2::from_angle(angle)
        },
        0.5,
        60,
    ));
    check(&bar, &spiral);
    check(&spiral, &bar);
}

fn holed(holes: &[(DVec2, f64)]) -> Region {
    let ring = |&(centre, radius): &(DVec2, f64)| -> Vec<DVec2> {
        circle(centre, radius, 24, 0.3).into_iter().rev().collect()
    };
    Region {
        outer: along(&SHEET, 50),
        holes: holes.iter().map(ring).collect(),
    }
}

#[test]
fn holes_move_and_grow() {
    let a = holed(&[(dvec2(0.7, 0.7), 0.4)]);
    let b = holed(&[(dvec2(2.2, 1.2), 0.6)]);
    // One that is hardly there.
    let speck = holed(&[(dvec2(1.5, 1.0), 0.004)]);
    check(&a, &b);
    check(&a, &speck);
    check(&speck, &b);
    let two = |x: f64| holed(&[(dvec2(0.7, 1.0), 0.3), (dvec2(x, 1.0), 0.3)]);
    check(&two(2.3), &two(1.5));
}

#[test]
fn inner_points_are_met() {
    let square = solid(along(&SQUARE, 40));
    let inner = [
        (dvec2(0.3, 0.3), dvec2(0.6, 0.5)),
        (dvec2(0.7, 0.7), dvec2(0.8, 0.8)),
    ];
    let pair = compatible(&square, &square, &inner, &CompatibleOptions::default()).unwrap();
    pair.check().unwrap();
    for (i, (a, b)) in inner.iter().enumerate() {
        assert_eq!((pair.source[40 + i], pair.target[40 + i]), (*a, *b));
    }
    let outside = [(dvec2(0.3, 0.3), dvec2(1.6, 0.5))];
    assert!(matches!(
        compatible(&square, &square, &outside, &CompatibleOptions::default()),
        Err(CompatibleError::Inner { point: 0, .. })
    ));
}

#[test]
fn holes_are_joined_however_they_lie() {
    // In another order in the target, so that paths have to go round.
    let places = |turn: f64| -> Vec<(DVec2, f64)> {
        let angle = |i: usize| turn + core::f64::consts::TAU * i as f64 / 5.0;
        let at = |i: usize| dvec2(1.5, 1.0) + 0.6 * DVec2::from_angle(angle(i));
        (0..5).map(|i| (at(i), 0.15)).collect()
    };
    for turn in [0.3, 1.5, 3.0] {
        check(&holed(&places(0.0)), &holed(&places(turn)));
    }
    // Three corners only, and as many holes.
    let triangle = |k: f64| -> Vec<DVec2> {
        [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]
            .iter()
            .map(|&p| DVec2::from(p) * k)
            .collect()
    };
    let sheet = |at: [f64; 3]| Region {
        outer: along(&SHEET, 4),
        holes: at
            .iter()
            .map(|x| triangle(0.3).iter().map(|p| *p + dvec2(*x, 0.8)).collect())
            .collect(),
    };
    let pair = compatible(
        &sheet([0.3, 1.0, 2.0]),
        &sheet([0.5, 1.4, 2.4]),
        &[],
        &CompatibleOptions::default(),
    );
    pair.unwrap().check().unwrap();
}

#[test]
fn what_is_no_region_is_refused_by_name() {
    let square = along(&SQUARE, 8);
    let error = |region: &Region| region.check().unwrap_err();
    let clockwise: Vec<DVec2> = square.iter().rev().copied().collect();
    assert!(matches!(
        error(&solid(clockwise.clone())),
        RegionError::Orientation { ring: 0, .. }
    ));
    let mut crossed = square.clone();
    crossed.swap(1, 5);
    assert!(matches!(
        error(&solid(crossed)),
        RegionError::Crossing { .. }
    ));
    let mut twice = square.clone();
    twice[3] = twice[0];
    assert!(matches!(
        error(&solid(twice)),
        RegionError::Repeated {
            point: 3,
            other: 0,
            ..
        }
    ));
    let mut wild = square.clone();
    wild[2].y = f64::NAN;
    assert!(matches!(
        error(&solid(wild)),
        RegionError::NotFinite { point: 2, .. }
    ));
    let outside = Region {
        outer: square.clone(),
        holes: vec![clockwise.iter().map(|p| *p + 5.0).collect()],
    };
    assert!(matches!(
        error(&outside),
        RegionError::HoleOutside { ring: 1 }
    ));
    assert!(matches!(
        error(&solid(square[..2].to_vec())),
        RegionError::TooFew { count: 2, .. }
    ));
    // A spike that goes back along itself.
    let mut spike = square.clone();
    spike.splice(1..1, [dvec2(0.4, 0.0), dvec2(0.2, 0.0)]);
    assert!(matches!(error(&solid(spike)), RegionError::Crossing { .. }));
    let more = solid(along(&SQUARE, 9));
    let found = compatible(&solid(square), &more, &[], &CompatibleOptions::default());
    assert!(matches!(
        found,
        Err(CompatibleError::Points { ring: 0, .. })
    ));
}

#[test]
fn triangulations_cover_their_region() {
    let region = Region {
        outer: circle(DVec2::ZERO, 2.0, 80, 0.0),
        holes: vec![star(40, 0.5).into_iter().rev().collect()],
    };
    let fine = Fineness {
        largest_triangle: 0.002,
        ..Fineness::default()
    };
    for fineness in [Fineness::default(), fine] {
        let mesh = triangulate(&region, &[dvec2(1.5, 0.1)], &fineness).unwrap();
        let corners = |t: &[u32; 3]| t.map(|i| mesh.points[i as usize]);
        let covered: f64 = mesh.triangles.iter().map(|t| area(&corners(t))).sum();
        assert!((covered - region.area()).abs() < 1e-12);
        assert_eq!(mesh.points[120], dvec2(1.5, 0.1));
        let largest = mesh
            .triangles
            .iter()
            .map(|t| area(&corners(t)))
            .fold(0.0, f64::max);
        assert!(largest <= fineness.largest_triangle * region.area() * 1.0001);
    }
}

#[test]
fn faults_of_pairs_are_found() {
    let square = solid(along(&SQUARE, 20));
    let pair = check(&square, &square);
    let mut folded = pair.clone();
    let inner = folded.triangles[0];
    folded.triangles[0] = [inner[1], inner[0], inner[2]];
    assert!(folded.check().is_err());
    let mut moved = pair.clone();
    let last = moved.target.len() - 1;
    moved.target[last] += 2.0;
    assert!(matches!(
        moved.check(),
        Err(PairFault::Folded { side: "target", .. })
    ));
    let mut open = pair.clone();
    open.triangles.pop();
    assert!(matches!(open.check(), Err(PairFault::Tiling { .. })));
}
