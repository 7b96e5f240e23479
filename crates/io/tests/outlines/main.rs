//! Files of filled shapes, read and written.

#![cfg(all(feature = "fonts", feature = "svg"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod font;
mod written;

use anamorph_io::ReadErrorKind;
use anamorph_io::outlines::{Drawing, is_drawing, read};

fn damaged(name: &str) -> Vec<u8> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/fixtures/damaged");
    std::fs::read(format!("{folder}/{name}")).unwrap()
}

fn counts(drawing: &Drawing) -> Vec<usize> {
    let contours = drawing.parts.iter().flat_map(|part| &part.contours);
    contours.map(|contour| contour.segments.len()).collect()
}

#[test]
fn damaged_drawings_are_read_as_far_as_they_go_or_refused() {
    // What may be read: the number of segments of each contour.
    for (name, segments) in [
        ("polygon-clockwise.json", vec![3]),
        ("polygon-duplicate-points.json", vec![6]),
        ("polygon-figure-eight.json", vec![3]),
        ("polygon-hole-outside.json", vec![3, 3]),
        ("polygon-zero-area.json", vec![3]),
    ] {
        let bytes = damaged(name);
        assert!(is_drawing(&bytes), "{name}");
        let drawing = read(&bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(counts(&drawing), segments, "{name}");
        assert!(drawing.y_down, "{name}");
    }
    // Path data counts up to its first error.
    let cut = b"<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 9 9\"><path d=\"M1 1H8V8L 3 z z\"/></svg>";
    assert_eq!(counts(&read(cut).unwrap()), [2]);
    let arcs = read(&damaged("svg-arc-degenerate.svg")).unwrap();
    assert!(arcs.points().all(anamorph_core::glam::DVec2::is_finite));
    for (name, kind, says) in [
        ("polygon-nan.json", ReadErrorKind::Syntax, "line 1"),
        ("svg-empty-path.svg", ReadErrorKind::NoPath, "no path"),
        ("svg-entity-bomb.svg", ReadErrorKind::Syntax, "entities"),
        ("svg-huge-numbers.svg", ReadErrorKind::NoPath, "no path"),
        ("svg-path-garbage.svg", ReadErrorKind::NoPath, "no path"),
    ] {
        let error = read(&damaged(name)).unwrap_err();
        assert_eq!(error.kind, kind, "{name}: {error}");
        assert!(error.to_string().contains(says), "{name}: {error}");
    }
}

#[test]
fn what_is_no_drawing_is_said_to_be_none() {
    for bytes in [
        &b""[..],
        b"v 0 0 0\n",
        b"[[1,2]]",
        b"\x89PNG",
        b"{\"asset\":{}}",
    ] {
        assert!(!is_drawing(bytes));
        assert_eq!(read(bytes).unwrap_err().kind, ReadErrorKind::UnknownFormat);
    }
}
