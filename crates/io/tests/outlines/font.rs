//! A font made here: an A of straight lines, a V with a curve, a blank, and a pair that is set closer.

use anamorph_core::glam::dvec2;
use anamorph_io::ReadErrorKind;
use anamorph_io::outlines::{FontOptions, Segment, is_font, read_text};

fn words(list: &[i32]) -> Vec<u8> {
    list.iter()
        .flat_map(|word| (*word as u16).to_be_bytes())
        .collect()
}

fn longs(list: &[u32]) -> Vec<u8> {
    list.iter().flat_map(|long| long.to_be_bytes()).collect()
}

/// A glyph of one contour; whether each point is on it.
fn glyph(points: &[(i32, i32, bool)]) -> Vec<u8> {
    let xs = points.iter().map(|p| p.0);
    let ys = points.iter().map(|p| p.1);
    let mut table = words(&[
        1,
        xs.clone().min().unwrap(),
        ys.clone().min().unwrap(),
        xs.clone().max().unwrap(),
        ys.clone().max().unwrap(),
        points.len() as i32 - 1,
        0,
    ]);
    table.extend(points.iter().map(|p| u8::from(p.2)));
    let steps = |list: Vec<i32>| {
        let before = std::iter::once(0).chain(list.clone());
        let steps: Vec<i32> = list.iter().zip(before).map(|(a, b)| a - b).collect();
        words(&steps)
    };
    table.extend(steps(xs.collect()));
    table.extend(steps(ys.collect()));
    while !table.len().is_multiple_of(4) {
        table.push(0);
    }
    table
}

fn font() -> Vec<u8> {
    let a = glyph(&[(0, 0, true), (500, 1000, true), (1000, 0, true)]);
    let v = glyph(&[(0, 1000, true), (500, -1000, false), (1000, 1000, true)]);
    let ends = [0, 0, a.len(), a.len() + v.len(), a.len() + v.len()];
    let loca = longs(&ends.map(|end| end as u32));
    let mut glyf = a;
    glyf.extend(v);
    let mut head = longs(&[0x0001_0000, 0x0001_0000, 0, 0x5f0f_3cf5]);
    head.extend(words(&[
        0, 1000, 0, 0, 0, 0, 0, 0, 0, 0, 0, -200, 1000, 1000, 0, 8, 2, 1, 0,
    ]));
    let mut hhea = longs(&[0x0001_0000]);
    hhea.extend(words(&[
        800, -200, 0, 1000, 0, 0, 1000, 1, 0, 0, 0, 0, 0, 0, 0, 4,
    ]));
    let mut maxp = longs(&[0x0001_0000]);
    maxp.extend(words(&[4, 3, 1, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0]));
    // Glyphs 1, 2 and 3 for A, V and the blank; format 4 of `cmap`.
    let segments = [
        (32, 32, 3 - 32),
        (65, 65, 1 - 65),
        (86, 86, 2 - 86),
        (0xffff, 0xffff, 1),
    ];
    let mut map = vec![4, 16 + 8 * 4, 0, 8, 8, 2, 0];
    map.extend(segments.map(|s| s.1));
    map.push(0);
    map.extend(segments.map(|s| s.0));
    map.extend(segments.map(|s| s.2));
    map.extend([0; 4]);
    let mut cmap = words(&[0, 1, 3, 1]);
    cmap.extend(longs(&[12]));
    cmap.extend(words(&map));
    let hmtx = words(&[500, 0, 1000, 0, 1000, 0, 300, 0]);
    let kern = words(&[0, 1, 0, 20, 1, 1, 6, 0, 0, 1, 2, -200]);
    let tables = [
        (b"cmap", cmap),
        (b"glyf", glyf),
        (b"head", head),
        (b"hhea", hhea),
        (b"hmtx", hmtx),
        (b"kern", kern),
        (b"loca", loca),
        (b"maxp", maxp),
    ];
    let mut file = longs(&[0x0001_0000]);
    file.extend(words(&[tables.len() as i32, 128, 3, 0]));
    let mut at = file.len() + 16 * tables.len();
    let mut data = Vec::new();
    for (tag, table) in tables {
        file.extend(tag);
        file.extend(longs(&[0, at as u32, table.len() as u32]));
        data.extend(&table);
        while !data.len().is_multiple_of(4) {
            data.push(0);
        }
        at = 12 + 16 * 8 + data.len();
    }
    file.extend(data);
    file
}

#[test]
fn glyphs_are_laid_out_with_advances_and_kerning() {
    let font = font();
    assert!(is_font(&font) && !is_font(b"<svg/>"));
    let drawing = read_text(&font, "A VAV", &FontOptions::default()).unwrap();
    assert!(!drawing.y_down);
    let names: Vec<&str> = drawing
        .parts
        .iter()
        .map(|part| part.name.as_str())
        .collect();
    assert_eq!(names, ["A", "V", "A", "V"]);
    let left = |i: usize| drawing.parts[i].contours[0].start.x;
    // A of 1000, a blank of 300, V of 1000, A of 1000, and the pair AV is 200 closer.
    assert_eq!([0, 1, 2, 3].map(left), [0.0, 1300.0, 2300.0, 3100.0]);
    assert_eq!(drawing.canvas, Some([0.0, -200.0, 4100.0, 1000.0]));
    let v = &drawing.parts[1].contours[0];
    assert!(v.closed);
    assert!(v.segments.iter().any(|segment| matches!(segment,
        Segment::Quadratic([pull, end]) if *pull == dvec2(1800.0, -1000.0) && *end == dvec2(2300.0, 1000.0))));

    let small = FontOptions {
        size: 10.0,
        ..FontOptions::default()
    };
    let small = read_text(&font, "V", &small).unwrap();
    let ends = small.parts[0].contours[0].flatten(1e-3);
    assert!(ends.contains(&dvec2(10.0, 10.0)));
}

#[test]
fn what_the_font_does_not_have_is_named() {
    let font = font();
    let error = |text: &str, options: &FontOptions| read_text(&font, text, options).unwrap_err();
    let plain = FontOptions::default();
    let missing = error("AÄV", &plain);
    assert_eq!(missing.kind, ReadErrorKind::Glyph('Ä'), "{missing}");
    assert!(missing.to_string().contains("'Ä' (U+00C4)"), "{missing}");
    assert_eq!(error("A\nV", &plain).kind, ReadErrorKind::Glyph('\n'));
    assert_eq!(error("  ", &plain).kind, ReadErrorKind::NoPath);
    assert_eq!(error("", &plain).kind, ReadErrorKind::NoPath);
    assert_eq!(
        error(&"A".repeat(10_001), &plain).kind,
        ReadErrorKind::TooLarge
    );
    let axis = FontOptions {
        axes: vec![("wght".to_owned(), 700.0)],
        ..FontOptions::default()
    };
    let axis = error("A", &axis);
    assert_eq!(axis.kind, ReadErrorKind::Unsupported);
    assert!(axis.to_string().contains("no axis \"wght\""), "{axis}");
    let second = FontOptions {
        index: 1,
        ..FontOptions::default()
    };
    assert_eq!(error("A", &second).kind, ReadErrorKind::Container);
    let nothing = FontOptions {
        size: 0.0,
        ..FontOptions::default()
    };
    assert_eq!(error("A", &nothing).kind, ReadErrorKind::Number);
}

#[test]
fn fonts_cut_off_anywhere_are_refused() {
    let font = font();
    for length in 0..font.len() {
        let error = read_text(&font[..length], "AV", &FontOptions::default()).unwrap_err();
        assert!(
            matches!(
                error.kind,
                ReadErrorKind::Truncated | ReadErrorKind::Container
            ),
            "{length}: {error}"
        );
    }
    // Bytes that are changed may make another font, and never a panic.
    for at in 0..font.len() {
        for value in [0, 1, 0x7f, 0xff] {
            let mut other = font.clone();
            other[at] = value;
            let _ = read_text(&other, "AV", &FontOptions::default());
        }
    }
}
