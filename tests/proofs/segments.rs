//! B10: feature lines that all let others have a say, which have a kernel of their own, against the formula of T. Beier and S. Neely written
//! out term by term.

use anamorph_core::{
    Deformation, Plane, Scaling, Site,
    glam::{DVec2, dvec2},
};
use anamorph_features::ElementPair;
use anamorph_tests::random::Random;
use anamorph_warps::lines::{WeightConstants, local};

/// A source line, its target, and `a`, `b` and `p`.
struct Line {
    source: [DVec2; 2],
    target: [DVec2; 2],
    a: f64,
    b: f64,
    p: f64,
}

/// A vector turned by a quarter.
fn across(v: DVec2) -> DVec2 {
    dvec2(-v.y, v.x)
}

/// Where the lines take a point.
fn formula(lines: &[Line], x: DVec2) -> DVec2 {
    let (mut sum, mut whole) = (DVec2::ZERO, 0.0);
    for line in lines {
        let [from, to] = line.source;
        let along = to - from;
        let length = along.length();
        let u = (x - from).dot(along) / (length * length);
        let v = (x - from).dot(across(along)) / length;
        let moved = line.target[1] - line.target[0];
        let place = line.target[0] + moved * u + across(moved) * (v / moved.length());
        let distance = if u < 0.0 {
            x.distance(from)
        } else if u > 1.0 {
            x.distance(to)
        } else {
            v.abs()
        };
        let weight = (length.powf(line.p) / (line.a + distance)).powf(line.b);
        sum += (place - x) * weight;
        whole += weight;
    }
    x + sum / whole
}

/// Points of all kinds: on lines and at their ends, beyond these, near, far, and very far away.
fn places(lines: &[Line], random: &mut Random) -> Vec<DVec2> {
    let mut places = Vec::new();
    for line in lines {
        let [from, to] = line.source;
        for share in [0.0, 0.25, 0.5, 1.0, -0.3, 1.7, -40.0, 1e3] {
            places.push(from + (to - from) * share);
            places.push(from + (to - from) * share + across(to - from) * 1e-9);
        }
    }
    for far in [1.0, 30.0, 1e4, 1e7] {
        places.extend((0..40).map(|_| random.vector::<Plane>() * far));
    }
    places
}

#[test]
fn b10_the_kernel_of_lines_is_the_formula() {
    let mut random = Random::new(77);
    for b in [1.0, 2.0, 0.7] {
        for p in [0.0, 0.5, 1.0] {
            for count in [1, 2, 3, 4, 5, 8, 11] {
                let lines: Vec<Line> = (0..count)
                    .map(|number| {
                        let from = random.vector::<Plane>() * 3.0;
                        let source = [from, from + random.vector::<Plane>() + dvec2(0.1, 2.0)];
                        let moved = random.vector::<Plane>() * 0.4;
                        let target = [source[0] + moved, source[1] - moved * 0.5];
                        let a = [0.01, 0.3, 2.0][number % 3];
                        Line {
                            source,
                            target,
                            a,
                            b,
                            p,
                        }
                    })
                    .collect();
                let pairs: Vec<_> = lines
                    .iter()
                    .map(|line| {
                        let pair = ElementPair::of_corners(&line.source, &line.target).unwrap();
                        let Line { a, b, p, .. } = *line;
                        (pair, WeightConstants { a, b, p })
                    })
                    .collect();
                let warp = local::construct(&pairs, Scaling::Displacement).unwrap();
                let places = places(&lines, &mut random);
                // Together, and one by one.
                let mut moved = places.clone();
                assert!(warp.map_points(0, &mut moved).is_empty());
                for (&place, &found) in places.iter().zip(&moved) {
                    let known = formula(&lines, place);
                    let room = 1e-12 * (10.0 + place.length());
                    let error = found.distance(known);
                    assert!(
                        error <= room,
                        "b = {b}, p = {p}, {count} lines, {place}: {found}, not {known}"
                    );
                    let alone = warp.map(&Site::anywhere(place));
                    assert!(
                        alone.distance(known) <= room,
                        "{place}: {alone}, not {known}"
                    );
                }
            }
        }
    }
}

/// Lines along the border that stay hold it, whatever the lines within do: images keep their frame.
#[test]
fn b10_lines_that_stay_hold_the_border() {
    let (width, height) = (180.0, 120.0);
    let corners = [
        dvec2(0.0, 0.0),
        dvec2(width, 0.0),
        dvec2(width, height),
        dvec2(0.0, height),
    ];
    let constants = WeightConstants {
        a: 0.0,
        b: 2.0,
        p: 0.0,
    };
    let line = |source: [DVec2; 2], target: [DVec2; 2]| {
        let pair = ElementPair::of_corners(&source, &target).unwrap();
        (pair, constants)
    };
    let inner = [
        line(
            [dvec2(60.0, 40.0), dvec2(120.0, 50.0)],
            [dvec2(50.0, 60.0), dvec2(130.0, 80.0)],
        ),
        line(
            [dvec2(90.0, 20.0), dvec2(90.0, 100.0)],
            [dvec2(70.0, 25.0), dvec2(100.0, 95.0)],
        ),
    ];
    let frame = (0..4).map(|i| {
        let side = [corners[i], corners[(i + 1) % 4]];
        line(side, side)
    });
    let border: Vec<DVec2> = (0..400)
        .map(|i| {
            let (side, share) = (i / 100, (i % 100) as f64 / 100.0);
            corners[side] + (corners[(side + 1) % 4] - corners[side]) * share
        })
        .collect();
    let farthest = |lines: &[_]| {
        let warp = local::construct(lines, Scaling::Displacement).unwrap();
        let ways = border
            .iter()
            .map(|p| warp.map(&Site::anywhere(*p)).distance(*p));
        ways.fold(0.0, f64::max)
    };
    assert!(farthest(&inner) > 5.0, "{}", farthest(&inner));
    let held: Vec<_> = inner.into_iter().chain(frame).collect();
    assert!(farthest(&held) < 1e-9, "{}", farthest(&held));
}
