//! Shapes become regions whose borders are simple and apart, and all that was mended is told.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_meshing::planar::Region;
use anamorph_morph::matching::{Thinning, Weights, match_outlines};
use anamorph_morph::shapes::{
    FillRule, Mended, Part, PartPairing, Pieces, Ring, Shape, ShapeError, area, contains,
    crossings, pair_holes, pair_parts,
};
use core::f64::consts::TAU;

fn ring(points: &[(f64, f64)]) -> Ring {
    Ring {
        points: points.iter().map(|&(x, y)| dvec2(x, y)).collect(),
        hole: false,
    }
}

fn rectangle(x: f64, y: f64, width: f64, height: f64) -> Vec<DVec2> {
    vec![
        dvec2(x, y),
        dvec2(x + width, y),
        dvec2(x + width, y + height),
        dvec2(x, y + height),
    ]
}

fn disk(x: f64, y: f64, r: f64, count: usize) -> Vec<DVec2> {
    let angle = |i: usize| i as f64 / count as f64 * TAU;
    (0..count)
        .map(|i| dvec2(x + r * angle(i).cos(), y + r * angle(i).sin()))
        .collect()
}

fn shape(rings: Vec<Ring>, fill: FillRule) -> Shape {
    Shape { rings, fill }
}

fn plain(points: Vec<DVec2>) -> Ring {
    Ring {
        points,
        hole: false,
    }
}

/// Borders that a mesh can be made in.
fn assert_meshable(regions: &[Region]) {
    for region in regions {
        assert!(region.outer.len() >= 3 && area(&region.outer) > 0.0);
        assert!(
            region
                .holes
                .iter()
                .all(|hole| hole.len() >= 3 && area(hole) < 0.0)
        );
        let rings: Vec<&[DVec2]> = core::iter::once(&region.outer)
            .chain(&region.holes)
            .map(Vec::as_slice)
            .collect();
        assert_eq!(crossings(&rings, 9), []);
        for hole in &region.holes {
            assert!(contains(
                &Region {
                    outer: region.outer.clone(),
                    holes: Vec::new()
                },
                hole[0]
            ));
        }
    }
}

fn whole(regions: &[Region]) -> f64 {
    let one = |r: &Region| area(&r.outer) + r.holes.iter().map(|hole| area(hole)).sum::<f64>();
    regions.iter().map(one).sum()
}

fn damaged(name: &str) -> Shape {
    let path = format!(
        "{}/../../tests/fixtures/damaged/{name}",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let mut rings = Vec::new();
    for polygon in json["polygons"].as_array().unwrap() {
        let points = |ring: &serde_json::Value| -> Vec<DVec2> {
            let points = ring.as_array().unwrap().iter();
            points
                .map(|p| dvec2(p[0].as_f64().unwrap(), p[1].as_f64().unwrap()))
                .collect()
        };
        rings.push(plain(points(&polygon["outer"])));
        for hole in polygon["holes"].as_array().unwrap() {
            rings.push(Ring {
                points: points(hole),
                hole: true,
            });
        }
    }
    shape(rings, FillRule::EvenOdd)
}

#[test]
fn damaged_polygons_are_mended_and_told() {
    let (regions, mended) = damaged("polygon-clockwise.json").regions().unwrap();
    assert_meshable(&regions);
    assert_eq!(
        (whole(&regions), mended),
        (100.0, vec![Mended::Reversed { ring: 0 }])
    );

    let (regions, mended) = damaged("polygon-duplicate-points.json").regions().unwrap();
    assert_meshable(&regions);
    assert_eq!(regions[0].outer.len(), 4);
    assert_eq!((whole(&regions), mended.len()), (100.0, 4));
    assert!(
        mended
            .iter()
            .all(|m| matches!(m, Mended::Repeated { ring: 0, .. }))
    );

    let (regions, mended) = damaged("polygon-figure-eight.json").regions().unwrap();
    assert_meshable(&regions);
    assert_eq!((regions.len(), whole(&regions)), (2, 50.0));
    assert!(
        mended.contains(&Mended::Crossing {
            place: dvec2(5.0, 5.0)
        }),
        "{mended:?}"
    );

    let (regions, mended) = damaged("polygon-hole-outside.json").regions().unwrap();
    assert_eq!((regions.len(), whole(&regions)), (1, 100.0));
    assert_eq!(mended, [Mended::HoleOutside { ring: 1 }]);

    let error = damaged("polygon-zero-area.json").regions().unwrap_err();
    assert_eq!(error, ShapeError::NoArea { rings: 1 });
    assert_eq!(Shape::default().regions().unwrap_err(), ShapeError::Empty);
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        let rings = vec![
            plain(rectangle(0.0, 0.0, 1.0, 1.0)),
            ring(&[(0.0, 0.0), (bad, 1.0), (2.0, 1.0)]),
        ];
        let error = shape(rings, FillRule::NonZero).regions().unwrap_err();
        assert!(
            matches!(
                error,
                ShapeError::NotFinite {
                    ring: 1,
                    point: 1,
                    ..
                }
            ),
            "{error}"
        );
    }
}

#[test]
fn fill_rules_decide_what_is_a_hole() {
    let rings = |second: Vec<DVec2>| vec![plain(rectangle(0.0, 0.0, 10.0, 10.0)), plain(second)];
    let inner = rectangle(2.0, 2.0, 4.0, 4.0);
    let reversed: Vec<DVec2> = inner.iter().rev().copied().collect();
    for (rings, fill, holes) in [
        (rings(inner.clone()), FillRule::EvenOdd, 1),
        (rings(reversed.clone()), FillRule::EvenOdd, 1),
        (rings(inner.clone()), FillRule::NonZero, 0),
        (rings(reversed), FillRule::NonZero, 1),
    ] {
        let (regions, mended) = shape(rings, fill).regions().unwrap();
        assert_meshable(&regions);
        assert_eq!((regions.len(), regions[0].holes.len()), (1, holes));
        if holes == 0 {
            assert_eq!(mended, [Mended::Covered { ring: 1 }]);
        }
    }
    // An island in a hole is a region of its own.
    let rings = [(0.0, 10.0), (1.0, 8.0), (2.0, 6.0), (3.0, 4.0)]
        .map(|(at, size)| plain(rectangle(at, at, size, size)))
        .to_vec();
    let (regions, mended) = shape(rings, FillRule::EvenOdd).regions().unwrap();
    assert_meshable(&regions);
    assert_eq!(
        (regions.len(), whole(&regions)),
        (2, 100.0 - 64.0 + 36.0 - 16.0)
    );
    assert!(mended.iter().all(|m| matches!(m, Mended::Reversed { .. })));
}

#[test]
fn points_keep_their_bits() {
    let outer = disk(0.1, 1e3, 0.3, 77);
    let hole = disk(0.1, 1e3, 0.1, 33);
    let rings = vec![
        plain(outer.clone()),
        Ring {
            points: hole.clone(),
            hole: true,
        },
    ];
    let (regions, mended) = shape(rings, FillRule::NonZero).regions().unwrap();
    assert_eq!(mended, [Mended::Reversed { ring: 1 }]);
    for point in &regions[0].outer {
        assert!(outer.contains(point));
    }
    assert_eq!(regions[0].outer.len(), outer.len());
    assert_eq!(regions[0].holes[0].len(), hole.len());
    assert!(regions[0].holes[0].iter().all(|p| hole.contains(p)));
}

#[test]
fn spikes_overlaps_and_touches_are_mended() {
    let spiky = ring(&[
        (0.0, 0.0),
        (4.0, 0.0),
        (9.0, 0.0),
        (4.0, 0.0),
        (4.0, 4.0),
        (2.0, 4.0),
        (2.0, 8.0),
        (2.0, 4.0),
        (0.0, 4.0),
    ]);
    let (regions, mended) = shape(vec![spiky], FillRule::NonZero).regions().unwrap();
    assert_meshable(&regions);
    assert_eq!(whole(&regions), 16.0);
    assert!(
        mended.contains(&Mended::Spike { ring: 0, point: 2 }),
        "{mended:?}"
    );
    assert!(
        mended.contains(&Mended::Spike { ring: 0, point: 6 }),
        "{mended:?}"
    );

    // Two that overlap are one.
    let rings = vec![
        plain(rectangle(0.0, 0.0, 4.0, 4.0)),
        plain(rectangle(3.0, 1.0, 4.0, 2.0)),
    ];
    let (regions, mended) = shape(rings, FillRule::NonZero).regions().unwrap();
    assert_meshable(&regions);
    assert_eq!((regions.len(), whole(&regions)), (1, 22.0));
    assert!(mended.contains(&Mended::Joined {
        first: 0,
        second: 1
    }));
    assert!(mended.contains(&Mended::Crossing {
        place: dvec2(4.0, 1.0)
    }));

    // A hole that touches the outline in a point, or along an edge, and two that touch each other.
    let outer = plain(rectangle(0.0, 0.0, 10.0, 10.0));
    let hole = |points: Vec<DVec2>| Ring { points, hole: true };
    let touching = hole(vec![dvec2(0.0, 5.0), dvec2(3.0, 4.0), dvec2(3.0, 6.0)]);
    let along = hole(rectangle(8.0, 3.0, 2.0, 2.0));
    let other = hole(vec![dvec2(3.0, 6.0), dvec2(5.0, 6.0), dvec2(5.0, 8.0)]);
    let (regions, mended) = shape(vec![outer, touching, along, other], FillRule::EvenOdd)
        .regions()
        .unwrap();
    assert_meshable(&regions);
    assert_eq!((regions.len(), regions[0].holes.len()), (1, 2));
    assert!(
        (whole(&regions) - (100.0 - 3.0 - 4.0 - 2.0)).abs() < 1e-3,
        "{}",
        whole(&regions)
    );
    let touches = mended
        .iter()
        .filter(|m| matches!(m, Mended::Touching { .. }))
        .count();
    assert_eq!(touches, 2, "{mended:?}");
}

#[test]
fn random_scribbles_become_meshable() {
    let mut seed = 9_u64;
    let mut next = || {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (seed >> 33) as f64 / (1_u64 << 31) as f64
    };
    for round in 0..150 {
        let (scale, far) = ([1e-6, 1.0, 1e5][round % 3], [0.0, 1e3, -1e7][round / 3 % 3]);
        // Whole numbers touch and overlap, others cross.
        let whole_numbers = round % 2 == 0;
        let rings = (0..1 + round % 4)
            .map(|_| {
                let count = 3 + (next() * 12.0) as usize;
                let mut place = || {
                    if whole_numbers {
                        (next() * 8.0).floor()
                    } else {
                        next() * 8.0
                    }
                };
                let points = (0..count)
                    .map(|_| dvec2(place(), place()) * scale + far)
                    .collect();
                Ring {
                    points,
                    hole: false,
                }
            })
            .collect();
        let fill = [FillRule::EvenOdd, FillRule::NonZero][round / 2 % 2];
        match shape(rings, fill).regions() {
            Ok((regions, _)) => assert_meshable(&regions),
            // A millionth, ten millions away, has a thousand places across.
            Err(ShapeError::TooNear { .. }) => assert!(scale < 1.0 && far < 0.0, "{round}"),
            Err(error) => assert!(matches!(error, ShapeError::NoArea { .. }), "{error}"),
        }
    }
}

#[test]
fn thousands_of_specks_are_fast() {
    let rings: Vec<Ring> = (0..6000)
        .map(|i| {
            plain(disk(
                f64::from(i % 80) * 3.0,
                f64::from(i / 80) * 3.0,
                1.0,
                6,
            ))
        })
        .collect();
    let start = std::time::Instant::now();
    let (regions, mended) = shape(rings, FillRule::NonZero).regions().unwrap();
    assert_eq!((regions.len(), mended.len()), (6000, 0));
    // A tenth of a second where nothing else runs; quadratic time would be minutes.
    assert!(start.elapsed().as_secs() < 20);
}

fn part(id: Option<&str>, colour: Option<[f64; 3]>, outer: Vec<DVec2>) -> Part {
    Part {
        id: id.map(str::to_owned),
        colour,
        region: Region {
            outer,
            holes: Vec::new(),
        },
    }
}

#[test]
fn parts_are_paired_by_id_then_by_colour_and_place() {
    let (red, blue) = (Some([0.6, 0.2, 0.1]), Some([0.45, 0.0, -0.3]));
    let source = [
        part(Some("eye"), red, rectangle(0.0, 0.0, 1.0, 1.0)),
        part(None, red, rectangle(2.0, 0.0, 2.0, 2.0)),
        part(None, blue, rectangle(2.0, 3.0, 2.0, 2.0)),
    ];
    // Elsewhere, larger, and in another order.
    let target = [
        part(None, blue, rectangle(120.0, 100.0, 20.0, 20.0)),
        part(None, red, rectangle(120.0, 130.0, 20.0, 20.0)),
        part(Some("eye"), blue, rectangle(100.0, 145.0, 9.0, 9.0)),
    ];
    let one = |source, target| PartPairing::One { source, target };
    assert_eq!(
        pair_parts(&source, &target, Pieces::default()),
        [one(0, 2), one(1, 1), one(2, 0)]
    );
    // Without colours and ids by place.
    let bare = |parts: &[Part]| {
        parts
            .iter()
            .map(|p| part(None, None, p.region.outer.clone()))
            .collect::<Vec<_>>()
    };
    assert_eq!(
        pair_parts(&bare(&source), &bare(&target), Pieces::default()),
        [one(0, 2), one(1, 0), one(2, 1)]
    );

    let more = [
        target[0].clone(),
        target[1].clone(),
        target[2].clone(),
        part(None, red, rectangle(141.0, 131.0, 3.0, 3.0)),
    ];
    let split = PartPairing::Split {
        source: 1,
        targets: vec![1, 3],
    };
    assert_eq!(
        pair_parts(&source, &more, Pieces::Split),
        [one(0, 2), split, one(2, 0)]
    );
    let merged = PartPairing::Merge {
        sources: vec![1, 3],
        target: 1,
    };
    let back = pair_parts(&more, &source, Pieces::SplitAndMerge);
    assert!(back.contains(&merged), "{back:?}");
    let grown = pair_parts(&source, &more, Pieces::Grow);
    let Some(PartPairing::Grow { target: 3, from }) = grown.last() else {
        panic!("{grown:?}")
    };
    // In the source's frame, towards its right side.
    assert!(from.x > 3.5 && from.x <= 4.0 && from.y > 0.0, "{from}");
    let shrunk = pair_parts(&more, &source, Pieces::Split);
    assert!(
        shrunk
            .iter()
            .any(|p| matches!(p, PartPairing::Shrink { source: 3, .. }))
    );
    // One of nothing.
    let alone = pair_parts(&source[..1], &[], Pieces::default());
    assert!(matches!(alone[..], [PartPairing::Shrink { source: 0, to }] if to == dvec2(0.5, 0.5)));
}

#[test]
fn many_parts_are_each_in_one_pairing() {
    let specks = |count: usize| -> Vec<Part> {
        (0..count)
            .map(|i| {
                part(
                    None,
                    None,
                    disk((i * 37 % 101) as f64, (i * 53 % 97) as f64, 0.3, 5),
                )
            })
            .collect()
    };
    for (m, n) in [(40, 25), (25, 40), (500, 700), (700, 500)] {
        let pairings = pair_parts(&specks(m), &specks(n), Pieces::default());
        let mut seen = [vec![0; m], vec![0; n]];
        for pairing in pairings {
            let (sources, targets) = match pairing {
                PartPairing::One { source, target } => (vec![source], vec![target]),
                PartPairing::Split { source, targets } => (vec![source], targets),
                PartPairing::Merge { sources, target } => (sources, vec![target]),
                PartPairing::Grow { target, .. } => (vec![], vec![target]),
                PartPairing::Shrink { source, .. } => (vec![source], vec![]),
            };
            sources.iter().for_each(|&i| seen[0][i] += 1);
            targets.iter().for_each(|&j| seen[1][j] += 1);
        }
        assert!(seen.iter().flatten().all(|&times| times == 1));
    }
}

#[test]
fn holes_are_paired_by_place_and_open_inside() {
    let reversed = |ring: Vec<DVec2>| ring.into_iter().rev().collect::<Vec<_>>();
    let source = Region {
        outer: rectangle(0.0, 0.0, 10.0, 4.0),
        holes: vec![
            reversed(disk(2.0, 2.0, 0.5, 12)),
            reversed(disk(8.0, 2.0, 0.7, 12)),
            reversed(disk(5.0, 2.0, 0.6, 12)),
        ],
    };
    // Stood upright and moved, with a hole less.
    let turn = |p: DVec2| dvec2(-p.y, p.x) * 3.0 + dvec2(50.0, -7.0);
    let turned = |ring: &[DVec2]| ring.iter().map(|p| turn(*p)).collect::<Vec<_>>();
    let target = Region {
        outer: turned(&source.outer),
        holes: vec![turned(&source.holes[2]), turned(&source.holes[0])],
    };
    let matching = match_outlines(&source.outer, &target.outer, &[], &Weights::default()).unwrap();
    let both = matching
        .consistent(&source.outer, &target.outer, &Thinning::default())
        .unwrap();
    let there = pair_holes(&source, &target, &both);
    assert_eq!(there.pairs, [[0, 1], [2, 0]]);
    assert!(there.opening.is_empty());
    assert_eq!(there.closing.len(), 1);
    assert_eq!(there.closing[0].hole, 1);
    // An oblong fits itself turned by half a turn as well.
    let (one, other) = (turn(dvec2(8.0, 2.0)), turn(dvec2(2.0, 2.0)));
    let at = there.closing[0].at;
    assert!(at.distance(one).min(at.distance(other)) < 1.0 || contains(&target, at));
    assert!(contains(&target, at));

    // A place that would be outside, or in a hole, is kept inside.
    let bent = Region {
        outer: [
            (0.0, 0.0),
            (10.0, 0.0),
            (10.0, 1.0),
            (1.0, 1.0),
            (1.0, 10.0),
            (0.0, 10.0),
        ]
        .map(|(x, y)| dvec2(x, y))
        .to_vec(),
        holes: Vec::new(),
    };
    let matching = match_outlines(&source.outer, &bent.outer, &[], &Weights::default()).unwrap();
    let both = matching
        .consistent(&source.outer, &bent.outer, &Thinning::default())
        .unwrap();
    let there = pair_holes(&source, &bent, &both);
    assert_eq!(there.closing.len(), 3);
    assert!(
        there
            .closing
            .iter()
            .all(|opening| contains(&bent, opening.at))
    );
}
