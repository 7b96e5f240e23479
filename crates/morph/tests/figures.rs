//! Drawings that become one another: ends are met, nothing folds between, holes open, parts appear and split.

// A test that cannot be set up has nothing to say.
#![allow(clippy::unwrap_used)]

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_meshing::planar::{Region, area};
use anamorph_morph::figures::{Figure, FigureError, FigureOptions};
use anamorph_morph::matching::{Anchor, AnchorPlace};
use anamorph_morph::shapes::Part;
use anamorph_morph::strain::{METHODS, method};
use std::f64::consts::TAU;
use std::slice::from_ref;

fn round(centre: DVec2, radius: f64, count: usize) -> Vec<DVec2> {
    (0..count)
        .map(|i| centre + radius * DVec2::from_angle(TAU * i as f64 / count as f64))
        .collect()
}

fn polygon(points: &[[f64; 2]]) -> Vec<DVec2> {
    points.iter().map(|&p| p.into()).collect()
}

fn part(outer: Vec<DVec2>, holes: Vec<Vec<DVec2>>) -> Part {
    let turned = |hole: Vec<DVec2>| hole.into_iter().rev().collect();
    Part {
        region: Region {
            outer,
            holes: holes.into_iter().map(turned).collect(),
        },
        ..Part::default()
    }
}

/// A bar, and the same bent at its middle.
fn bars() -> [Part; 2] {
    let straight = [[0., 0.], [4., 0.], [8., 0.], [8., 1.], [4., 1.], [0., 1.]];
    let bent = [
        [0., 0.],
        [4.5, 0.],
        [4.5, 4.5],
        [3.5, 4.5],
        [3.5, 1.],
        [0., 1.],
    ];
    [straight, bent].map(|points| part(polygon(&points), Vec::new()))
}

fn figure(source: &[Part], target: &[Part]) -> Figure {
    let method = method("indifferent").unwrap();
    Figure::new(source, target, &method, &FigureOptions::default()).unwrap()
}

/// Every triangle of every couple is positive at some times, and outlines have the area of their triangles.
fn check(figure: &Figure) {
    for couple in figure.couples() {
        couple.mesh.check().unwrap();
        for t in [0.0, 0.2, 0.5, 0.8, 1.0] {
            let places = couple.places(t).unwrap();
            for triangle in &couple.mesh.triangles {
                let [a, b, c] = triangle.map(|i| places[i as usize]);
                assert!((b - a).perp_dot(c - a) > 0.0, "{t}");
            }
        }
    }
}

fn whole(rings: &[Vec<DVec2>]) -> f64 {
    rings.iter().map(|ring| area(ring)).sum()
}

#[test]
fn a_bar_bends_without_squeezing() {
    let [straight, bent] = bars();
    let figure = figure(from_ref(&straight), from_ref(&bent));
    check(&figure);
    let area_at = |t: f64| whole(&figure.at(t).unwrap()[0].rings);
    assert!((area_at(0.0) - straight.region.area()).abs() < 1e-9);
    assert!((area_at(1.0) - bent.region.area()).abs() < 1e-9);
    // Straight lines of its corners would lose much of it.
    let least = straight.region.area().min(bent.region.area());
    for t in [0.25, 0.5, 0.75] {
        assert!(area_at(t) > 0.93 * least, "{t}: {}", area_at(t));
    }
}

#[test]
fn ends_are_the_outlines_given() {
    let [straight, bent] = bars();
    let figure = figure(from_ref(&straight), from_ref(&bent));
    for (t, region) in [(0.0, &straight.region), (1.0, &bent.region)] {
        let piece = &figure.at(t).unwrap()[0];
        for corner in &region.outer {
            assert!(piece.rings[0].contains(corner), "{t}: {corner}");
        }
    }
}

#[test]
fn a_hole_opens_and_its_area_only_grows() {
    let disc = part(round(DVec2::ZERO, 2.0, 40), Vec::new());
    let ring = part(
        round(DVec2::ZERO, 2.0, 40),
        vec![round(dvec2(0.4, 0.1), 0.8, 24)],
    );
    let figure = figure(&[disc], from_ref(&ring));
    check(&figure);
    assert_eq!(figure.at(0.0).unwrap()[0].rings.len(), 1);
    assert_eq!(figure.at(1.0).unwrap()[0].rings.len(), 2);
    let mut before = 0.0;
    for i in 1..=8 {
        let piece = &figure.at(f64::from(i) / 8.0).unwrap()[0];
        let hole = -area(&piece.rings[1]);
        assert!(hole > before, "{i}: {hole} after {before}");
        before = hole;
    }
    assert!((before + area(&ring.region.holes[0])).abs() < 1e-9);
}

#[test]
fn parts_split_and_appear() {
    let one = part(round(DVec2::ZERO, 2.0, 32), Vec::new());
    let two = [dvec2(-3.0, 0.0), dvec2(3.0, 0.0)].map(|c| part(round(c, 1.0, 24), Vec::new()));
    let split = figure(from_ref(&one), &two);
    check(&split);
    assert_eq!(split.couples().len(), 2);
    assert!(split.couples().iter().all(|c| c.source == Some(0)));
    let options = FigureOptions {
        pieces: anamorph_morph::shapes::Pieces::Grow,
        ..FigureOptions::default()
    };
    let grown = Figure::new(&[one], &two, &method("indifferent").unwrap(), &options).unwrap();
    check(&grown);
    assert_eq!(grown.at(0.0).unwrap().len(), 1);
    assert_eq!(grown.at(1.0).unwrap().len(), 2);
}

#[test]
fn all_methods_meet_both_ends() {
    let [straight, bent] = bars();
    for method in METHODS {
        let options = FigureOptions::default();
        let figure = Figure::new(from_ref(&straight), from_ref(&bent), method, &options).unwrap();
        let couple = &figure.couples()[0];
        assert_eq!(couple.places(0.0).unwrap(), couple.mesh.source);
        assert_eq!(couple.places(1.0).unwrap(), couple.mesh.target);
        assert!(couple.places(0.5).unwrap().iter().all(|p| p.is_finite()));
    }
}

#[test]
fn anchors_that_cross_are_named() {
    let [straight, bent] = bars();
    let anchor = |source, target| Anchor {
        source: AnchorPlace::Point(source),
        target: AnchorPlace::Point(target),
    };
    let options = FigureOptions {
        anchors: vec![anchor(0, 0), anchor(1, 3), anchor(2, 2)],
        ..FigureOptions::default()
    };
    let method = method("indifferent").unwrap();
    let found = Figure::new(&[straight], &[bent], &method, &options);
    let text = found.map(|_| ()).unwrap_err();
    assert!(matches!(text, FigureError::Match { .. }), "{text}");
    assert!(text.to_string().contains("cross"), "{text}");
}
