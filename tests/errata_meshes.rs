//! Rows of the errata on mesh features, pinned by name (F11–F14), and the proof of B17.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use anamorph_core::guarantees::{Verdict, coverage, interpolation};
use anamorph_core::{
    Deformation, Influences, Plane, Site, Solid, Warp,
    glam::{DMat3, dvec2, dvec3},
    reference,
};
use anamorph_tests::random::Random;
use anamorph_warps::meshes::{MeshError, MeshWarp, Reaches, Uncovered};

/// A grid of `n` by `n` vertices over the unit square, its squares cut in two, lifted by `height` alternately.
fn sheet(n: u32, height: f64) -> (Vec<Solid>, Vec<[u32; 2]>) {
    let step = 1.0 / f64::from(n - 1);
    let points = (0..n * n)
        .map(|i| {
            let lift = if (i % n + i / n).is_multiple_of(2) {
                height
            } else {
                0.0
            };
            dvec3(f64::from(i / n) * step, f64::from(i % n) * step, lift)
        })
        .collect();
    let mut edges = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let at = i * n + j;
            if j + 1 < n {
                edges.push([at, at + 1]);
            }
            if i + 1 < n {
                edges.push([at, at + n]);
            }
            if i + 1 < n && j + 1 < n {
                edges.push([at, at + n + 1]);
            }
        }
    }
    (points, edges)
}

fn rigid() -> (DMat3, Solid) {
    let turn = DMat3::from_axis_angle(dvec3(1.0, -2.0, 0.5).normalize(), 2.5);
    (turn, dvec3(3.0, -1.0, 0.25))
}

fn warp(source: &[Solid], target: &[Solid], edges: &[[u32; 2]]) -> MeshWarp<Solid> {
    MeshWarp::construct(source, target, edges, Reaches::default(), Uncovered::Stay).unwrap()
}

fn near_sheet(random: &mut Random) -> Solid {
    dvec3(
        random.between(0.0, 1.0),
        random.between(0.0, 1.0),
        random.between(-0.15, 0.15),
    )
}

fn weight(warp: &MeshWarp<Solid>, p: Solid) -> f64 {
    let mut list = Influences::default();
    warp.influences(&Site::anywhere(p), &mut list);
    list.list.iter().map(|i| i.weight).sum()
}

#[test]
fn b17_a_rigid_motion_of_the_coarse_mesh_is_rigid_on_the_model() {
    let (turn, shift) = rigid();
    // Flat fans, folded ones, and full ones alike.
    for height in [0.0, 1e-7, 0.2] {
        let (source, edges) = sheet(6, height);
        let target: Vec<Solid> = source.iter().map(|&p| turn * p + shift).collect();
        let warp = warp(&source, &target, &edges);
        let mut random = Random::new(5);
        let mut covered = 0;
        for _ in 0..500 {
            let p = near_sheet(&mut random);
            let moved = warp.map(&Site::anywhere(p));
            if weight(&warp, p) > 0.0 {
                assert!((moved - (turn * p + shift)).length() < 1e-9, "{height} {p}");
                covered += 1;
            } else {
                assert_eq!(moved, p);
            }
        }
        assert!(covered > 400, "{covered}");
        assert_eq!(interpolation(&warp, 1.7).verdict, Verdict::Proved);
    }
}

#[test]
fn b17_the_quick_evaluation_is_equation_3() {
    let (source, edges) = sheet(7, 0.1);
    let mut random = Random::new(8);
    let target: Vec<Solid> = source
        .iter()
        .map(|&p| p + random.vector::<Solid>() * 0.1)
        .collect();
    let warp = warp(&source, &target, &edges);
    for _ in 0..500 {
        let site = Site::anywhere(near_sheet(&mut random) * 1.4 - Solid::splat(0.2));
        let plain = reference::evaluate(&warp, &site);
        assert!(warp.map(&site).distance(plain) < 1e-12);
    }
}

#[test]
fn f11_f12_a_linear_map_of_full_fans_acts_about_each_vertex() {
    let map = DMat3::from_cols(
        dvec3(1.5, 0.2, 0.1),
        dvec3(-0.3, 1.0, 0.4),
        dvec3(0.0, 0.6, 0.8),
    );
    let shift = dvec3(5.0, -2.0, 1.0);
    let (source, edges) = sheet(7, 0.15);
    let target: Vec<Solid> = source.iter().map(|&p| map * p + shift).collect();
    let warp = warp(&source, &target, &edges);
    let mut random = Random::new(6);
    for _ in 0..300 {
        // Where only vertices inside the sheet reach, whose fans are full.
        let p = dvec3(0.5, 0.5, 0.0) + random.vector::<Solid>() * 0.1;
        assert!(weight(&warp, p) > 0.0);
        let off = (warp.map(&Site::anywhere(p)) - (map * p + shift)).length();
        assert!(off < 1e-9, "{p} {off}");
    }
}

#[test]
fn f13_a_nearly_flat_mesh_does_not_stretch_without_bound() {
    let (bumpy, edges) = sheet(5, 0.2);
    let mut last: Option<Solid> = None;
    for height in [0.0, 1e-12, 1e-9, 1e-6, 1e-4] {
        let (source, _) = sheet(5, height);
        let warp = warp(&source, &bumpy, &edges);
        let p = dvec3(0.52, 0.47, 0.1);
        let moved = warp.map(&Site::anywhere(p));
        assert!((moved - p).length() < 1.0, "{height} {moved}");
        if let Some(last) = last {
            assert!((moved - last).length() < 0.1, "{height} {moved} {last}");
        }
        last = Some(moved);
    }
    // A single edge in space lies on a line: the smallest turn, and a sentence about it.
    let line = [Solid::ZERO, Solid::X];
    let lifted = [Solid::ZERO, Solid::Y];
    let warp = warp(&line, &lifted, &[[0, 1]]);
    assert!(
        warp.facts()
            .notes
            .iter()
            .any(|n| n.contains("lie on a line"))
    );
    let moved = warp.map(&Site::anywhere(dvec3(0.5, 0.0, 0.2)));
    assert!((moved - dvec3(0.0, 0.5, 0.2)).length() < 1e-12);
}

#[test]
fn f14_numbers_out_of_range_and_torn_vertices_are_refused() {
    let (source, edges) = sheet(3, 0.0);
    let usual = Reaches::default();
    for (reaches, wrong) in [
        (Reaches { beta: 0.0, ..usual }, "beta"),
        (
            Reaches {
                beta: f64::NAN,
                ..usual
            },
            "beta",
        ),
        (
            Reaches {
                alpha: 1.0,
                ..usual
            },
            "alpha",
        ),
        (Reaches { mu: 0.0, ..usual }, "mu"),
        (Reaches { mu: 1.01, ..usual }, "mu"),
        (
            Reaches {
                gamma: 1.0,
                ..usual
            },
            "gamma",
        ),
    ] {
        match MeshWarp::construct(&source, &source, &edges, reaches, Uncovered::Stay) {
            Err(MeshError::Number { name, .. }) => assert_eq!(name, wrong),
            other => panic!("{wrong}: {other:?}"),
        }
    }
    let build = |source: &[Solid], target: &[Solid], edges: &[[u32; 2]]| {
        MeshWarp::construct(source, target, edges, usual, Uncovered::Stay).unwrap_err()
    };
    assert_eq!(build(&source, &source, &[]), MeshError::Empty);
    assert_eq!(build(&[], &[], &[]), MeshError::Empty);
    assert_eq!(build(&source, &source, &[[0, 0]]), MeshError::Empty);
    let found = build(&source, &source, &[[0, 9]]);
    assert_eq!(
        found,
        MeshError::Edge {
            vertex: 9,
            count: 9
        }
    );
    let mut broken = source.clone();
    broken[4].y = f64::INFINITY;
    assert_eq!(
        build(&broken, &source, &edges),
        MeshError::NotFinite { vertex: 4 }
    );
    assert!(matches!(
        build(&source, &source[1..], &edges),
        MeshError::Count { .. }
    ));
    // Two vertices in one place, each with an edge of its own, pulled apart.
    let double = [Solid::ZERO, Solid::X, Solid::ZERO, Solid::Y];
    let torn = [Solid::ZERO, Solid::X, Solid::Z, Solid::Y];
    let found = build(&double, &torn, &[[0, 1], [2, 3]]);
    assert_eq!(
        found,
        MeshError::Torn {
            first: 0,
            second: 2
        }
    );
}

#[test]
fn f14_a_vertex_that_pulls_at_one_it_is_not_joined_to_is_named_with_the_beta_that_mends_it() {
    // Two edges side by side: the ends of one lie in the reach of the other's.
    let source = [Solid::ZERO, Solid::X, Solid::Y * 0.3, dvec3(1.0, 0.3, 0.0)];
    let target = [
        Solid::ZERO,
        Solid::X,
        dvec3(0.0, 0.3, 1.0),
        dvec3(1.0, 0.3, 1.0),
    ];
    let edges = [[0, 1], [2, 3]];
    let far = warp(&source, &target, &edges);
    assert_eq!(interpolation(&far, 1.0).verdict, Verdict::Refuted);
    let note = far
        .facts()
        .notes
        .into_iter()
        .find(|n| n.contains("beta = 0.3"));
    assert!(note.is_some_and(|n| n.contains("pulls at vertex")));
    let reaches = Reaches {
        beta: 0.3,
        ..Reaches::default()
    };
    let near = MeshWarp::construct(&source, &target, &edges, reaches, Uncovered::Stay).unwrap();
    assert_eq!(interpolation(&near, 1.0).verdict, Verdict::Proved);
}

#[test]
fn f14_points_that_are_not_covered_are_reported_or_go_with_the_nearest_vertex() {
    let source = [dvec2(0.0, 0.0), dvec2(1.0, 0.0)];
    let target = [dvec2(0.0, 1.0), dvec2(1.0, 1.0)];
    let half = Reaches {
        mu: 0.5,
        ..Reaches::default()
    };
    let middle = dvec2(0.5, 0.0);
    let build =
        |uncovered| MeshWarp::construct(&source, &target, &[[0, 1]], half, uncovered).unwrap();
    // With μ at most a half even the middle of every edge is left behind.
    let warp = build(Uncovered::Stay);
    let points = [source[0], middle, dvec2(5.0, 5.0)];
    let covered = coverage(&warp, &points, points.len());
    assert_eq!(covered.verdict, Verdict::Refuted);
    assert_eq!(covered.witness.unwrap().place, middle);
    assert!(
        covered.statement.starts_with("2 of 3"),
        "{}",
        covered.statement
    );
    assert_eq!(warp.map(&Site::anywhere(middle)), middle);
    let usual = MeshWarp::construct(
        &source,
        &target,
        &[[0, 1]],
        Reaches::default(),
        Uncovered::Stay,
    );
    assert_eq!(
        coverage(&usual.unwrap(), &points[..2], 2).verdict,
        Verdict::Proved
    );
    let whole = build(Uncovered::Nearest);
    assert_eq!(
        coverage(&whole, &points, points.len()).verdict,
        Verdict::Proved
    );
    for p in points {
        assert!(whole.map(&Site::anywhere(p)).distance(p + Plane::Y) < 1e-12);
    }
    let mut moved = points;
    whole.map_points(0, &mut moved);
    assert!(moved[2].distance(points[2] + Plane::Y) < 1e-12);
}
