//! Outlines are matched by their form, exactly at anchors, and made consistent without losing a vertex.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::glam::{DMat2, DVec2, dvec2};
use anamorph_morph::matching::{
    Anchor, AnchorPlace, MatchError, Matching, RingPlace, Side, Thinning, Weights, match_outlines,
};
use core::f64::consts::TAU;

/// Numbers that are the same in every run.
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A closed curve with bumps of all kinds, at a share of its way round.
fn bumpy(share: f64) -> DVec2 {
    let a = share * TAU;
    let r =
        3.0 + (2.0 * a + 0.3).sin() * 0.7 + (3.0 * a + 1.0).sin() * 0.5 + (5.0 * a).cos() * 0.35;
    dvec2(a.cos(), a.sin()) * r
}

fn ring(count: usize, phase: f64) -> Vec<DVec2> {
    (0..count)
        .map(|i| bumpy((i as f64 + phase) / count as f64))
        .collect()
}

fn length(outline: &[DVec2]) -> f64 {
    let n = outline.len();
    (0..n)
        .map(|i| outline[i].distance(outline[(i + 1) % n]))
        .sum()
}

/// Where a place is, in shares of the length.
fn share(outline: &[DVec2], place: RingPlace) -> f64 {
    let n = outline.len();
    let edge = |i: usize| outline[i].distance(outline[(i + 1) % n]);
    let before: f64 = (0..place.index).map(edge).sum();
    (before + edge(place.index) * place.fraction) / length(outline)
}

/// Where in the target a place of the source goes, both in shares.
fn follow(matching: &Matching, source: &[DVec2], target: &[DVec2], at: f64) -> f64 {
    let pairs: Vec<(f64, f64)> = matching
        .pairs()
        .iter()
        .map(|p| (share(source, p.source), share(target, p.target)))
        .collect();
    let n = pairs.len();
    let k = (0..n).rev().find(|&k| pairs[k].0 <= at).unwrap_or(n - 1);
    let (a, b) = (pairs[k], pairs[(k + 1) % n]);
    let ahead = |x: f64| x - x.floor();
    let whole = |x: f64| if ahead(x) == 0.0 { 1.0 } else { ahead(x) };
    let part = ahead(at - a.0) / whole(b.0 - a.0);
    (a.1 + part * whole(b.1 - a.1)).fract()
}

fn matched(source: &[DVec2], target: &[DVec2]) -> Matching {
    match_outlines(source, target, &[], &Weights::default()).unwrap()
}

fn turned(outline: &[DVec2], angle: f64, scale: f64, by: DVec2) -> Vec<DVec2> {
    let turn = DMat2::from_angle(angle) * scale;
    outline.iter().map(|p| turn * *p + by).collect()
}

fn rotated(outline: &[DVec2], by: usize) -> Vec<DVec2> {
    let mut outline = outline.to_vec();
    outline.rotate_left(by);
    outline
}

/// Strictly on in both, all the way round once.
fn assert_monotone(matching: &Matching, source: &[DVec2], target: &[DVec2]) {
    let pairs = matching.pairs();
    assert!(!pairs.is_empty());
    for (k, side) in [source, target].into_iter().enumerate() {
        let at: Vec<f64> = pairs
            .iter()
            .map(|p| [p.source, p.target][k])
            .inspect(|p| assert!((0.0..1.0).contains(&p.fraction) && p.index < side.len()))
            .map(|p| p.index as f64 + p.fraction)
            .collect();
        let falls = (0..at.len())
            .filter(|&i| at[(i + 1) % at.len()] <= at[i])
            .count();
        assert_eq!(falls, 1, "{k}");
    }
}

fn assert_consistent(matching: &Matching, source: &[DVec2], target: &[DVec2], thinning: &Thinning) {
    let both = matching.consistent(source, target, thinning).unwrap();
    assert_eq!(both.source.len(), both.target.len());
    assert_eq!(both.source.len(), both.places.len());
    assert!(both.source.len() <= source.len() + target.len() + matching.pairs().len());
    assert_eq!(both.source[0], source[0]);
    for (k, (new, old)) in [(&both.source, source), (&both.target, target)]
        .into_iter()
        .enumerate()
    {
        // The vertices, bit for bit and in order, from some start.
        let places: Vec<RingPlace> = both.places.iter().map(|p| p[k]).collect();
        let kept: Vec<usize> = places
            .iter()
            .filter(|p| p.fraction == 0.0)
            .map(|p| p.index)
            .collect();
        assert_eq!(kept.len(), old.len());
        for (i, &index) in kept.iter().enumerate() {
            assert_eq!(index, (kept[0] + i) % old.len());
        }
        let n = new.len();
        for i in 0..n {
            assert_ne!(new[i], new[(i + 1) % n], "{k} {i}");
            assert!(new[i].is_finite());
            let RingPlace { index, fraction } = places[i];
            if fraction == 0.0 {
                assert_eq!(new[i], old[index]);
            } else {
                let (a, b) = (old[index], old[(index + 1) % old.len()]);
                let off = (new[i] - a).perp_dot(b - a).abs() / (b - a).length();
                assert!(off < 1e-12 * (1.0 + a.length() + b.length()), "{off}");
            }
        }
        assert!((length(new) - length(old)).abs() < 1e-9 * length(old));
    }
}

#[test]
fn a_shift_is_recovered_exactly() {
    for shift in [1, 40, 99, 150] {
        let source = ring(200, 0.0);
        let target = rotated(&source, shift);
        let matching = matched(&source, &target);
        assert!(matching.cost() < 1e-9, "{}", matching.cost());
        for pair in matching.pairs() {
            if pair.source.fraction == 0.0 {
                assert_eq!(
                    pair.target,
                    RingPlace::vertex((pair.source.index + 200 - shift) % 200)
                );
            }
        }
        let both = matching
            .consistent(&source, &target, &Thinning::default())
            .unwrap();
        assert_eq!(both.source, source);
        assert_eq!(both.target, source);
    }
}

#[test]
fn a_shift_is_recovered_under_noise_and_resampling() {
    let mut random = Random(77);
    for (count, noise, most) in [
        (300, 0.0, 0.004),
        (170, 0.0, 0.006),
        (300, 0.012, 0.012),
        (517, 0.012, 0.012),
    ] {
        for shift in [0.13, 0.5, 0.81] {
            let source = ring(240, 0.0);
            let target: Vec<DVec2> = (0..count)
                .map(|i| {
                    let at = i as f64 / count as f64 + shift;
                    bumpy(at) + dvec2(random.between(-noise, noise), random.between(-noise, noise))
                })
                .collect();
            let matching = matched(&source, &target);
            assert_monotone(&matching, &source, &target);
            let whole = length(&ring(20_000, 0.0));
            for i in 0..60 {
                // The same place of the curve, by its share of the way round.
                let at = i as f64 / 60.0;
                let from = share(
                    &source,
                    RingPlace {
                        index: i * 4,
                        fraction: 0.0,
                    },
                );
                let to = follow(&matching, &source, &target, from);
                let n = target.len() as f64;
                let expected = (at - shift).rem_euclid(1.0) * n;
                let place = RingPlace {
                    index: expected as usize % target.len(),
                    fraction: expected.fract(),
                };
                let off = (to - share(&target, place)).abs();
                let off = off.min(1.0 - off);
                assert!(
                    off < most,
                    "{count} {noise} {shift}: {off} of {whole} at {at}"
                );
            }
        }
    }
}

#[test]
fn swapping_the_outlines_swaps_the_roles() {
    let shapes = [
        ring(90, 0.0),
        ring(140, 0.3),
        finger(0.0),
        finger(1.2),
        square(),
        star(7),
    ];
    for a in &shapes {
        for b in &shapes {
            let (there, back) = (matched(a, b), matched(b, a));
            assert_eq!(there.cost().to_bits(), back.cost().to_bits());
            let mut swapped: Vec<_> = back.pairs().iter().map(|p| (p.target, p.source)).collect();
            let key = |p: &(RingPlace, RingPlace)| p.0.index as f64 + p.0.fraction;
            swapped.sort_by(|p, q| key(p).total_cmp(&key(q)));
            let pairs: Vec<_> = there.pairs().iter().map(|p| (p.source, p.target)).collect();
            assert_eq!(pairs, swapped);
        }
    }
}

#[test]
fn place_turn_size_and_numbering_do_not_count() {
    let (source, target) = (finger(0.3), ring(150, 0.2));
    let plain = matched(&source, &target);
    for (angle, scale, by) in [
        (0.0, 1.0, dvec2(1e4, -3e3)),
        (2.5, 1.0, DVec2::ZERO),
        (-1.0, 1e-9, dvec2(1e-9, 0.0)),
        (3.1, 1e12, dvec2(-1e12, 1e11)),
    ] {
        let moved = turned(&source, angle, scale, by);
        let other = turned(&target, 1.0 - angle, 1.0, -by / scale);
        for (a, b) in [(&moved, &target), (&source, &other), (&moved, &other)] {
            let found = matched(a, b);
            assert!(
                (found.cost() - plain.cost()).abs() < 1e-4,
                "{} {}",
                found.cost(),
                plain.cost()
            );
            for i in 0..100 {
                let at = f64::from(i) / 100.0;
                let off = (follow(&found, a, b, at) - follow(&plain, &source, &target, at)).abs();
                assert!(
                    off.min(1.0 - off) < 1e-3,
                    "{angle} {scale} {by}: {off} at {at}"
                );
            }
        }
    }
    let renumbered = matched(&rotated(&source, 5), &rotated(&target, 60));
    assert!((renumbered.cost() - plain.cost()).abs() < 1e-5);
    // Both the other way round.
    let reverse = |outline: &[DVec2]| outline.iter().rev().copied().collect::<Vec<_>>();
    let reversed = matched(&reverse(&source), &reverse(&target));
    assert!((reversed.cost() - plain.cost()).abs() < 0.05 * plain.cost());
}

/// A palm with a finger that bends; the tip is the middle of its round end.
fn finger(bend: f64) -> Vec<DVec2> {
    let mut outline = vec![
        dvec2(-0.2, 0.0),
        dvec2(-1.5, 0.0),
        dvec2(-1.5, -2.0),
        dvec2(1.5, -2.0),
        dvec2(1.5, 0.0),
        dvec2(0.2, 0.0),
    ];
    let steps = 24;
    let middle = |share: f64| {
        if bend.abs() < 1e-9 {
            (dvec2(0.0, 3.0 * share), 0.0)
        } else {
            let (r, a) = (3.0 / bend, bend * share);
            (dvec2(r * (1.0 - a.cos()), r * a.sin()), a)
        }
    };
    let side = |share: f64, off: f64| {
        let (at, a) = middle(share);
        at + dvec2(a.cos(), -a.sin()) * off
    };
    for k in 1..steps {
        outline.push(side(f64::from(k) / f64::from(steps), 0.2));
    }
    let (end, a) = middle(1.0);
    for k in 0..=8 {
        let t = f64::from(k) / 8.0 * TAU / 2.0;
        let (across, along) = (dvec2(a.cos(), -a.sin()), dvec2(a.sin(), a.cos()));
        outline.push(end + across * (0.2 * t.cos()) + along * (0.2 * t.sin()));
    }
    for k in (1..steps).rev() {
        outline.push(side(f64::from(k) / f64::from(steps), -0.2));
    }
    outline
}
const TIP: usize = 6 + 23 + 4;

fn square() -> Vec<DVec2> {
    vec![
        dvec2(0.0, 0.0),
        dvec2(1.0, 0.0),
        dvec2(1.0, 1.0),
        dvec2(0.0, 1.0),
    ]
}

fn star(spikes: usize) -> Vec<DVec2> {
    (0..2 * spikes)
        .map(|i| {
            let a = i as f64 / (2 * spikes) as f64 * TAU;
            dvec2(a.cos(), a.sin()) * if i % 2 == 0 { 2.0 } else { 0.8 }
        })
        .collect()
}

#[test]
fn a_bent_finger_is_matched_by_its_tip() {
    let straight = finger(0.0);
    for bend in [-1.9, -0.8, 0.4, 1.3, 2.2] {
        let bent = rotated(&finger(bend), 11);
        let matching = matched(&straight, &bent);
        let to = follow(
            &matching,
            &straight,
            &bent,
            share(&straight, RingPlace::vertex(TIP)),
        );
        let tip = share(&bent, RingPlace::vertex(TIP - 11));
        assert!((to - tip).abs() < 0.006, "{bend}: {to} {tip}");
        // The corners of the palm by each other, exactly.
        let both = matching
            .consistent(&straight, &bent, &Thinning::default())
            .unwrap();
        for corner in 1..5 {
            let other = RingPlace::vertex((corner + bent.len() - 11) % bent.len());
            assert!(
                both.places.contains(&[RingPlace::vertex(corner), other]),
                "{bend} {corner}"
            );
        }
    }
}

#[test]
fn corners_meet_corners_whatever_lies_between() {
    // A square and an oblong with points along its edges.
    let oblong: Vec<DVec2> = (0..40)
        .map(|i| match i / 10 {
            0 => dvec2(0.3 * f64::from(i), 0.0),
            1 => dvec2(3.0, 0.1 * f64::from(i - 10)),
            2 => dvec2(3.0 - 0.3 * f64::from(i - 20), 1.0),
            _ => dvec2(0.0, 1.0 - 0.1 * f64::from(i - 30)),
        })
        .collect();
    let matching = matched(&square(), &oblong);
    let both = matching
        .consistent(&square(), &oblong, &Thinning::default())
        .unwrap();
    assert_eq!(both.source.len(), 40);
    let corners: Vec<usize> = both
        .places
        .iter()
        .filter(|p| p[0].fraction == 0.0)
        .map(|p| p[1].index % 10)
        .collect();
    assert_eq!(corners, [0; 4]);
    // Upright, the square stays as it is.
    let upright = Weights {
        upright: 0.01,
        ..Weights::default()
    };
    for shift in 0..4 {
        let target = rotated(&square(), shift);
        let matching = match_outlines(&square(), &target, &[], &upright).unwrap();
        let both = matching
            .consistent(&square(), &target, &Thinning::default())
            .unwrap();
        assert_eq!(both.source, both.target);
    }
}

#[test]
fn anchors_are_met_exactly() {
    let (source, target) = (ring(120, 0.0), ring(200, 0.4));
    let point = AnchorPlace::Point;
    let anchors = [
        Anchor {
            source: point(30),
            target: point(90),
        },
        Anchor {
            source: AnchorPlace::Fraction(0.75),
            target: AnchorPlace::Fraction(0.1),
        },
        Anchor {
            source: point(31),
            target: AnchorPlace::Fraction(0.5),
        },
        Anchor {
            source: point(0),
            target: point(60),
        },
    ];
    for count in 1..=4 {
        let anchors = &anchors[..count];
        let matching = match_outlines(&source, &target, anchors, &Weights::default()).unwrap();
        assert_monotone(&matching, &source, &target);
        let met = matching.pairs().iter().filter(|p| p.anchor).count();
        assert_eq!(met, count);
        let first = matching
            .pairs()
            .iter()
            .find(|p| p.source == RingPlace::vertex(30))
            .unwrap();
        assert_eq!(first.target, RingPlace::vertex(90));
        for thinning in [
            Thinning::default(),
            Thinning {
                join: 0.0,
                every_pair: true,
            },
        ] {
            assert_consistent(&matching, &source, &target, &thinning);
            let both = matching.consistent(&source, &target, &thinning).unwrap();
            assert!(
                both.places
                    .contains(&[RingPlace::vertex(30), RingPlace::vertex(90)])
            );
            if count > 1 {
                let near = |p: &[RingPlace; 2]| {
                    (share(&source, p[0]) - 0.75).abs() < 1e-12
                        && (share(&target, p[1]) - 0.1).abs() < 1e-12
                };
                assert!(both.places.iter().any(near));
            }
        }
    }
}

#[test]
fn wrong_anchors_are_named() {
    let outline = ring(50, 0.0);
    let point = |a: usize, b: usize| Anchor {
        source: AnchorPlace::Point(a),
        target: AnchorPlace::Point(b),
    };
    let tried = |anchors: &[Anchor]| {
        match_outlines(&outline, &outline, anchors, &Weights::default()).unwrap_err()
    };
    assert_eq!(
        tried(&[point(0, 0), point(20, 30), point(10, 40)]),
        MatchError::CrossingAnchors {
            first: 1,
            second: 2
        }
    );
    assert_eq!(
        tried(&[point(0, 0), point(20, 30), point(20, 40)]),
        MatchError::RepeatedAnchor {
            first: 1,
            second: 2,
            side: Side::Source
        }
    );
    assert_eq!(
        tried(&[point(3, 7), point(20, 30), point(40, 7)]),
        MatchError::RepeatedAnchor {
            first: 0,
            second: 2,
            side: Side::Target
        }
    );
    // Fraction 1 is point 0.
    let whole = Anchor {
        source: AnchorPlace::Fraction(1.0),
        target: AnchorPlace::Point(9),
    };
    assert!(matches!(
        tried(&[point(0, 0), whole]),
        MatchError::RepeatedAnchor {
            first: 0,
            second: 1,
            ..
        }
    ));
    for place in [
        AnchorPlace::Point(50),
        AnchorPlace::Fraction(-0.1),
        AnchorPlace::Fraction(f64::NAN),
    ] {
        let anchor = Anchor {
            source: AnchorPlace::Point(1),
            target: place,
        };
        let error = tried(&[point(0, 0), anchor]);
        assert!(matches!(
            error,
            MatchError::NoPlace {
                anchor: 1,
                side: Side::Target,
                count: 50,
                ..
            }
        ));
        assert!(error.to_string().contains("anchor 1"), "{error}");
    }
    // Two anchors never cross: around a cycle their order is the same.
    assert!(
        match_outlines(
            &outline,
            &outline,
            &[point(0, 9), point(10, 3)],
            &Weights::default()
        )
        .is_ok()
    );
}

#[test]
fn degenerate_outlines_are_errors() {
    let good = ring(20, 0.0);
    let tried = |bad: &[DVec2]| {
        let error = match_outlines(&good, bad, &[], &Weights::default()).unwrap_err();
        let other = match_outlines(bad, &good, &[], &Weights::default()).unwrap_err();
        if error != MatchError::Opposite {
            assert_ne!(error, other);
        }
        error
    };
    let side = Side::Target;
    assert_eq!(tried(&[]), MatchError::TooFew { side, count: 0 });
    assert_eq!(tried(&good[..2]), MatchError::TooFew { side, count: 2 });
    let mut bad = good.clone();
    bad[7].y = f64::NAN;
    assert_eq!(tried(&bad), MatchError::NotFinite { side, point: 7 });
    bad[7].y = f64::INFINITY;
    assert_eq!(tried(&bad), MatchError::NotFinite { side, point: 7 });
    bad[7] = bad[6];
    assert_eq!(tried(&bad), MatchError::Repeated { side, point: 7 });
    let mut closed = good.clone();
    closed.push(good[0]);
    assert_eq!(tried(&closed), MatchError::Repeated { side, point: 0 });
    let line: Vec<DVec2> = [0.0, 1.0, 2.0, 1.0].map(|x| dvec2(x, 2.0 * x)).to_vec();
    assert_eq!(tried(&line), MatchError::NoArea { side });
    assert_eq!(tried(&[DVec2::ONE; 5]), MatchError::NoArea { side });
    let reversed: Vec<DVec2> = good.iter().rev().copied().collect();
    assert_eq!(tried(&reversed), MatchError::Opposite);
    let huge: Vec<DVec2> = square()
        .iter()
        .map(|p| (*p - dvec2(0.5, 0.5)) * 1.7e308)
        .collect();
    assert!(match_outlines(&good, &huge, &[], &Weights::default()).is_ok());
    let weights = Weights {
        stretching: 0.0,
        ..Weights::default()
    };
    let error = match_outlines(&good, &good, &[], &weights).unwrap_err();
    assert_eq!(
        error,
        MatchError::Weight {
            name: "stretching",
            value: 0.0
        }
    );
}

#[test]
fn random_outlines_are_matched_and_made_consistent() {
    let mut random = Random(123_456_789);
    for round in 0..120 {
        let mut outline = || {
            let count = 3 + random.between(0.0, 40.0).powi(2) as usize / 20;
            let (far, rough) = (random.between(-1e3, 1e3), random.between(0.0, 0.9));
            let mut angles: Vec<f64> = (0..count).map(|_| random.between(0.0, TAU)).collect();
            if round % 3 == 0 {
                // Clusters of points, and far between them nothing.
                angles = angles
                    .iter()
                    .map(|a| (a * 1.3).floor() / 1.3 + a * 1e-4)
                    .collect();
            }
            angles.sort_by(f64::total_cmp);
            let points = angles.iter().map(|a| {
                dvec2(a.cos(), a.sin()) * (1.0 - random.between(0.0, rough)) + dvec2(far, -far)
            });
            points.collect::<Vec<_>>()
        };
        let (source, target) = (outline(), outline());
        let area = |o: &[DVec2]| {
            (0..o.len())
                .map(|i| (o[i] - o[0]).perp_dot(o[(i + 1) % o.len()] - o[0]))
                .sum::<f64>()
        };
        if area(&source) < 1e-3 || area(&target) < 1e-3 {
            continue;
        }
        let places = [0.1, 0.4, 0.9].map(|at| at + random.between(0.0, 0.09));
        let anchors: Vec<Anchor> = places[..round % 4]
            .iter()
            .map(|&at| Anchor {
                source: AnchorPlace::Fraction(at),
                target: AnchorPlace::Fraction((at * at + 0.5).fract()),
            })
            .collect();
        let matching = match_outlines(&source, &target, &anchors, &Weights::default()).unwrap();
        assert!(matching.cost().is_finite() && matching.cost() >= 0.0);
        assert_monotone(&matching, &source, &target);
        for thinning in [
            Thinning::default(),
            Thinning {
                join: 0.0,
                every_pair: false,
            },
            Thinning {
                join: 0.5,
                every_pair: true,
            },
        ] {
            assert_consistent(&matching, &source, &target, &thinning);
        }
    }
}

#[test]
fn costs_compare_choices() {
    let (a, b) = (finger(0.0), finger(0.5));
    let other = star(5);
    let same = matched(&a, &b).cost();
    let unlike = matched(&a, &other).cost();
    assert!(same * 3.0 < unlike, "{same} {unlike}");
    // Not by how finely they are drawn.
    let (coarse, fine) = (
        matched(&other, &ring(80, 0.0)).cost(),
        matched(&other, &ring(700, 0.0)).cost(),
    );
    assert!((coarse - fine).abs() < 0.15 * fine, "{coarse} {fine}");
}
