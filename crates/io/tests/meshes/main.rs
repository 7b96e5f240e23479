//! PLY, STL and OFF documents, and conversion, through the public interface.
#![allow(clippy::unwrap_used, clippy::panic)]

mod conversion;
mod layouts;

use anamorph_core::glam::{DVec2, DVec3};
use anamorph_io::{
    Document, Moved, Normals, Points, ReadError, ReadErrorKind, ReadOptions, WriteError,
    WriteReport, read, targets,
};

fn load(bytes: &[u8]) -> Result<Box<dyn Document>, ReadError> {
    read(bytes.to_vec(), None, &ReadOptions::default())
}

fn document(bytes: &[u8]) -> Box<dyn Document> {
    load(bytes).unwrap_or_else(|e| panic!("{e}\n{}", String::from_utf8_lossy(bytes)))
}

fn refusal(bytes: &[u8]) -> ReadError {
    match load(bytes) {
        Err(error) => error,
        Ok(_) => panic!("accepted: {}", String::from_utf8_lossy(bytes)),
    }
}

fn points(document: &dyn Document) -> Vec<DVec3> {
    match document.points() {
        Points::Solid(points) => points.to_vec(),
        Points::Plane(points) => points.iter().map(|p| p.extend(0.0)).collect(),
    }
}

fn write(
    document: &dyn Document,
    points: &[DVec3],
    normals: Normals<'_>,
) -> Result<(Vec<u8>, WriteReport), WriteError> {
    let plane: Vec<DVec2> = points.iter().map(|p| p.truncate()).collect();
    let points = match document.points() {
        Points::Solid(_) => Points::Solid(points),
        Points::Plane(_) => Points::Plane(&plane),
    };
    let mut out = Vec::new();
    let report = document.write(&Moved::new(points).with_normals(normals), &mut out)?;
    assert_eq!(report.bytes, out.len() as u64);
    Ok((out, report))
}

fn create(document: &dyn Document, format: &str) -> (Vec<u8>, Vec<String>) {
    let moved = Moved::new(document.points());
    let geometry = document.geometry(&moved).unwrap();
    let target = targets().iter().find(|t| t.name == format).unwrap();
    let mut out = Vec::new();
    let lost = target.create(&geometry, &mut out).unwrap();
    (out, lost.0)
}

/// A small generator of numbers (xorshift).
struct Random(u64);
impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

const TYPES: [(&str, &str); 8] = [
    ("char", "int8"),
    ("uchar", "uint8"),
    ("short", "int16"),
    ("ushort", "uint16"),
    ("int", "int32"),
    ("uint", "uint32"),
    ("float", "float32"),
    ("double", "float64"),
];

/// Appends a number in one of the encodings: 0 ascii, 1 little, 2 big endian.
fn put(out: &mut Vec<u8>, encoding: usize, kind: usize, value: f64) {
    let bytes: Vec<u8> = match kind {
        _ if encoding == 0 => format!("{value} ").into_bytes(),
        0 => (value as i8).to_le_bytes().to_vec(),
        1 => (value as u8).to_le_bytes().to_vec(),
        2 => (value as i16).to_le_bytes().to_vec(),
        3 => (value as u16).to_le_bytes().to_vec(),
        4 => (value as i32).to_le_bytes().to_vec(),
        5 => (value as u32).to_le_bytes().to_vec(),
        6 => (value as f32).to_le_bytes().to_vec(),
        _ => value.to_le_bytes().to_vec(),
    };
    if encoding == 2 {
        out.extend(bytes.iter().rev());
    } else {
        out.extend(bytes);
    }
}

/// A PLY file with everything that may stand in one: elements before and behind, lists among the coordinates, comments.
/// `coordinate`, `count` and `index` are types; `uneven` makes the rows of different lengths.
fn rich(
    encoding: usize,
    coordinate: usize,
    count: usize,
    index: usize,
    uneven: bool,
    feed: &str,
) -> Vec<u8> {
    let name = |kind: usize| {
        if kind.is_multiple_of(2) {
            TYPES[kind].0
        } else {
            TYPES[kind].1
        }
    };
    let format = ["ascii", "binary_little_endian", "binary_big_endian"][encoding];
    let header = format!(
        "ply\ncomment before the format\nformat {format} 1.0\nobj_info  odd   blanks \nelement camera 1\n\
         property list {c} double matrix\nproperty int id\ncomment between\nelement nothing 0\nproperty char a\n\
         element vertex 4\nproperty short flags\nproperty {xyz} y\nproperty list {c} {i} rings\nproperty {xyz} x\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nproperty {xyz} z\nproperty float quality\n\
         element face 2\nproperty uchar mark\nproperty list {c} {i} vertex_index\nelement edge 1\n\
         property int vertex1\nproperty ushort vertex2\nelement user 2\nproperty double u\nend_header\n",
        c = name(count),
        i = name(index),
        xyz = name(coordinate),
    )
    .replace('\n', feed);
    let mut out = header.into_bytes();
    let end = |out: &mut Vec<u8>| {
        if encoding == 0 {
            out.extend_from_slice(feed.as_bytes());
        }
    };
    put(&mut out, encoding, count, 3.0);
    for v in [0.5, -1.0, 2.0] {
        put(&mut out, encoding, 7, v);
    }
    put(&mut out, encoding, 4, -77.0);
    end(&mut out);
    for (i, [x, y, z]) in [[0., 0., 0.], [10., 0., 1.], [10., 12., 2.], [0., 12., 3.]]
        .into_iter()
        .enumerate()
    {
        put(&mut out, encoding, 2, -5.0);
        put(&mut out, encoding, coordinate, y);
        let rings = if uneven { i } else { 2 };
        put(&mut out, encoding, count, rings as f64);
        for r in 0..rings {
            put(&mut out, encoding, index, (r + 1) as f64);
        }
        put(&mut out, encoding, coordinate, x);
        for c in [255.0, 51.0, 0.0] {
            put(&mut out, encoding, 1, c);
        }
        put(&mut out, encoding, coordinate, z);
        put(&mut out, encoding, 6, 0.25);
        end(&mut out);
    }
    let faces: [&[f64]; 2] = if uneven {
        [&[0., 1., 2., 3.], &[2., 1., 0.]]
    } else {
        [&[0., 1., 2.], &[2., 3., 0.]]
    };
    for face in faces {
        put(&mut out, encoding, 1, 9.0);
        put(&mut out, encoding, count, face.len() as f64);
        for &v in face {
            put(&mut out, encoding, index, v);
        }
        end(&mut out);
    }
    put(&mut out, encoding, 4, 1.0);
    put(&mut out, encoding, 3, 3.0);
    end(&mut out);
    for v in [1e300, -0.0] {
        put(&mut out, encoding, 7, v);
        end(&mut out);
    }
    out
}

#[test]
fn ply_of_every_type_keeps_what_does_not_move() {
    for encoding in 0..3 {
        for coordinate in 0..8 {
            for count in 0..6 {
                for index in 0..6 {
                    for (uneven, feed) in [(false, "\n"), (true, "\r\n")] {
                        let file = rich(encoding, coordinate, count, index, uneven, feed);
                        let what = format!("{encoding} {coordinate} {count} {index} {uneven}");
                        let document = load(&file).unwrap_or_else(|e| panic!("{what}: {e}"));
                        let old = points(&*document);
                        assert_eq!(
                            old,
                            [[0., 0., 0.], [10., 0., 1.], [10., 12., 2.], [0., 12., 3.]]
                                .map(DVec3::from_array)
                        );
                        let (out, report) = write(&*document, &old, Normals::Recompute).unwrap();
                        assert!(out == file, "{what}");
                        assert_eq!(report.moved_points, 0);
                        let mesh = document.mesh().unwrap();
                        assert_eq!(mesh.faces, 2, "{what}");
                        assert_eq!(mesh.lines, [[1, 3]]);
                        assert_eq!(
                            document.attributes(),
                            ["flags", "red", "green", "blue", "quality"]
                        );
                        assert_eq!(document.attribute("red").unwrap(), [1.0; 4]);
                        assert_eq!(document.attribute("green").unwrap(), [0.2; 4]);
                        assert_eq!(document.attribute("flags").unwrap(), [-5.0; 4]);
                        assert_eq!(document.attribute("x"), None);
                    }
                }
            }
        }
    }
}

#[test]
fn ply_only_the_moved_numbers_change() {
    for encoding in 0..3 {
        for coordinate in 0..8 {
            for uneven in [false, true] {
                let file = rich(encoding, coordinate, 1, 4, uneven, "\n");
                let document = document(&file);
                let mut new = points(&*document);
                // A whole number, so that every type holds it; one coordinate of one point.
                new[2].x = 7.0;
                let (out, report) = write(&*document, &new, Normals::Keep).unwrap();
                assert_eq!(report.moved_points, 1);
                assert_eq!(points(&*load(&out).unwrap()), new);
                if encoding > 0 {
                    assert_eq!(out.len(), file.len());
                    let differ = out.iter().zip(&file).filter(|(a, b)| a != b).count();
                    assert!((1..=8).contains(&differ), "{differ}");
                } else {
                    let (old, new) = (
                        String::from_utf8(file).unwrap(),
                        String::from_utf8(out).unwrap(),
                    );
                    let (old, new): (Vec<&str>, Vec<&str>) =
                        (old.split(' ').collect(), new.split(' ').collect());
                    let changed: Vec<_> = old.iter().zip(&new).filter(|(a, b)| a != b).collect();
                    assert_eq!(changed, [(&"10", &"7")]);
                }
            }
        }
    }
}

#[test]
fn ply_rounds_floats_once_and_refuses_what_does_not_fit() {
    let third = 1.0 / 3.0;
    for encoding in 0..3 {
        for uneven in [false, true] {
            let single = document(&rich(encoding, 6, 1, 4, uneven, "\n"));
            let mut new = points(&*single);
            new[1].y = third;
            let (out, _) = write(&*single, &new, Normals::Keep).unwrap();
            let back = points(&*load(&out).unwrap())[1].y;
            assert_eq!((back as f32).to_bits(), (third as f32).to_bits());
            if encoding == 0 {
                let text = String::from_utf8(out).unwrap();
                assert!(text.contains(" 0.33333334 ") && !text.contains("0.333333343"));
            } else {
                assert_eq!(back, f64::from(third as f32));
            }
            new[1].y = 1e39;
            let error = write(&*single, &new, Normals::Keep).unwrap_err();
            assert!(matches!(error, WriteError::DoesNotFit { .. }), "{error}");
            assert!(error.to_string().contains("vertex 2"), "{error}");

            let double = document(&rich(encoding, 7, 1, 4, uneven, "\n"));
            let mut new = points(&*double);
            new[1].y = third;
            let (out, _) = write(&*double, &new, Normals::Keep).unwrap();
            assert_eq!(points(&*load(&out).unwrap()), new);

            for (kind, fits, not) in [
                (0, -128.0, 128.0),
                (1, 255.0, -1.0),
                (2, 32767.0, 0.5),
                (3, 65535.0, 65536.0),
                (4, -2_147_483_648.0, 1e10),
                (5, 4_294_967_295.0, -1.0),
            ] {
                let whole = document(&rich(encoding, kind, 1, 4, uneven, "\n"));
                let mut new = points(&*whole);
                new[3].z = fits;
                let (out, _) = write(&*whole, &new, Normals::Keep).unwrap();
                assert_eq!(points(&*load(&out).unwrap()), new);
                new[3].z = not;
                let error = write(&*whole, &new, Normals::Keep).unwrap_err();
                assert!(error.to_string().contains("whole numbers"), "{error}");
            }
        }
    }
}

const SQUARE: &str = "ply\rformat ascii 1.0\relement vertex 4\rproperty float x\rproperty float y\r\
    property float nx\rproperty float ny\rproperty float nz\rproperty float z\relement face 1\r\
    property list uchar int vertex_indices\rend_header\r0 0 0 0 1 0\r1 0 0 0 1 0\r1 1 0 0 1 0\r0 1 0 0 1 0\r4 0 1 2 3\r";

#[test]
fn ply_normals_follow_the_policy() {
    for text in [SQUARE.to_owned(), SQUARE.replace('\r', "\n")] {
        let document = document(text.as_bytes());
        assert_eq!(document.normals(), 4);
        let turned: Vec<DVec3> = points(&*document)
            .iter()
            .map(|p| DVec3::new(p.z, p.x, p.y))
            .collect();
        let turn = |_: usize, n: DVec3| DVec3::new(n.z, n.x, n.y);
        let (carried, report) = write(&*document, &turned, Normals::Transform(&turn)).unwrap();
        assert_eq!((report.moved_points, report.changed_normals), (3, 4));
        let (again, _) = write(&*document, &turned, Normals::Recompute).unwrap();
        assert_eq!(again, carried);
        assert!(String::from_utf8(carried).unwrap().contains("0 1 1 0 0 0"));
        let (kept, report) = write(&*document, &turned, Normals::Keep).unwrap();
        assert_eq!(report.changed_normals, 0);
        assert!(String::from_utf8(kept).unwrap().contains("0 1 0 0 1 0"));
        // No direction: the old one stays.
        let none = |_: usize, _: DVec3| DVec3::ZERO;
        let (_, report) = write(&*document, &turned, Normals::Transform(&none)).unwrap();
        assert_eq!(report.kept_normals, 4);
    }
}

#[test]
fn ply_in_the_plane_strips_and_wrapped_lines() {
    let plane = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nend_header\n0 0\n1 0\n0 1\n";
    let flat = document(plane);
    assert_eq!(flat.points().dimension(), 2);
    assert!(flat.mesh().is_none());
    let (out, _) = write(&*flat, &points(&*flat), Normals::Keep).unwrap();
    assert_eq!(out, plane);

    let strip = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
        element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0 1 0 0\n0 1 0 1\n1 0 2 2 2\n9 0 1 2 3 -1 2 3 4 4\n";
    let strip = document(strip.as_bytes());
    assert_eq!(
        strip.mesh().unwrap().triangles,
        [[0, 1, 2], [2, 1, 3], [2, 3, 4]]
    );
    let mut new = points(&*strip);
    new[4] = DVec3::splat(0.5);
    let (out, _) = write(&*strip, &new, Normals::Keep).unwrap();
    assert!(
        String::from_utf8(out)
            .unwrap()
            .contains("0 1\n1 0 0.5 0.5 0.5\n9 0")
    );
}

#[test]
fn ply_errors_say_what_and_where() {
    let header = |format: &str, vertices: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
             element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    use ReadErrorKind as K;
    let ascii = header("ascii", "3");
    let good = "0 0 0\n1 0 0\n0 1 0\n";
    let cases = [
        ("ply\n".to_owned(), K::Truncated, None, "does not end"),
        ("ply\nformat ascii 1.0\nend_header\n".to_owned(), K::NoPoints, None, "vertices"),
        ("ply\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n".to_owned(), K::Header, Some(1), "format"),
        ("ply\nformat ascii 2.0\nend_header\n".to_owned(), K::Unsupported, Some(2), "2.0"),
        ("ply\nformat binary 1.0\nend_header\n".to_owned(), K::Header, Some(2), "binary_little_endian"),
        ("ply\nformat ascii 1.0\nproperty int a\nend_header\n".to_owned(), K::Header, Some(3), "before any"),
        ("ply\nformat ascii 1.0\nelement vertex many\nend_header\n".to_owned(), K::Header, Some(3), "element vertex 8"),
        ("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\nend_header\n".to_owned(), K::Header, Some(4), "real"),
        ("ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar float x\nproperty float y\nend_header\n1 1 1\n".to_owned(), K::Header, Some(3), "is a list"),
        ("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float x\nend_header\n".to_owned(), K::Header, Some(5), "twice"),
        (header("ascii", "3000000000") + good, K::Truncated, Some(3), "3000000000"),
        (header("binary_big_endian", "1000000000000000000") + good, K::Truncated, Some(3), "room"),
        (ascii.clone() + "0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n", K::Number, Some(11), "y of vertex 2 is \"x\""),
        (ascii.clone() + "0 0 0\n1 0\n0 1 0\n3 0 1 2\n", K::Shape, Some(11), "vertex 2 has no value for z"),
        (ascii.clone() + "0 0 0\n1 0 0 5\n0 1 0\n3 0 1 2\n", K::Shape, Some(11), "more numbers"),
        (ascii.clone() + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", K::NonFinite, Some(11), "--allow-nonfinite"),
        (ascii.clone() + good + "3 0 1 3\n", K::Element, Some(13), "refers to vertex index 3"),
        (ascii.clone() + good + "3 0 1 -1\n", K::Element, Some(13), "index -1"),
        (ascii.clone() + good + "3 0 1 1.5\n", K::Element, Some(13), "index 1.5"),
        (ascii.clone() + good + "2 0 1\n", K::Element, Some(13), "2 corners"),
        (ascii.clone() + good + "-3 0 1 2\n", K::Element, Some(13), "-3 items"),
        (ascii.clone() + good + "255 0 1 2\n", K::Element, Some(13), "room"),
        (ascii.clone() + good + "4 0 1 2\n\n", K::Truncated, Some(13), "ends within face 1"),
        (ascii + good, K::Truncated, Some(13), "ends within face 1"),
    ];
    for (text, kind, line, words) in cases {
        let error = refusal(text.as_bytes());
        assert_eq!((error.kind, error.line), (kind, line), "{error}\n{text}");
        assert!(error.to_string().contains(words), "{error}");
    }
    let mut file = header("binary_little_endian", "3").into_bytes();
    for v in [0_f32, 0., 0., 1., 0., 0., 0., 1., 0.] {
        file.extend(v.to_le_bytes());
    }
    let face = file.len();
    let mut bad = file.clone();
    bad.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 255, 255, 255, 255]);
    let error = refusal(&bad).to_string();
    assert!(
        error.contains(&format!(
            "face 1 (at byte {face}) refers to vertex index -1"
        )),
        "{error}"
    );
    file.extend([200, 0, 0, 0, 0]);
    let error = refusal(&file).to_string();
    assert!(error.contains("200 items"), "{error}");
}

const CUBE_CORNER: &str = "solid a name\r\n facet normal 0 0 -1\r\n  outer loop\r\n   vertex 0 0 0\r\n   vertex 0.0 1 -0\r\n\
    \x20  vertex 1e0 0 0\r\n  endloop\r\n endfacet\r\nFACET NORMAL 0 0 0\r\nouter loop vertex 1 0 0 vertex 0 1 0 vertex 1 1 5 endloop endfacet\r\nendsolid a name\r\n\
    solid b\nendsolid\n";

fn binary_stl(header: &[u8], facets: &[[[f32; 3]; 4]]) -> Vec<u8> {
    let mut out = header.to_vec();
    out.resize(80, b'.');
    out.extend((facets.len() as u32).to_le_bytes());
    for (i, facet) in facets.iter().enumerate() {
        for value in facet.iter().flatten() {
            out.extend(value.to_le_bytes());
        }
        out.extend([i as u8, 0x80]);
    }
    out
}

const FACETS: [[[f32; 3]; 4]; 2] = [
    [[0., 0., 1.], [0., 0., 0.], [1., 0., -0.0], [0., 1., 0.]],
    [[0., 0., 0.5], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]],
];

#[test]
fn stl_joins_corners_and_recomputes_normals_of_moved_triangles() {
    let text = document(CUBE_CORNER.as_bytes());
    assert_eq!(text.points().len(), 4);
    let old = points(&*text);
    let (out, _) = write(&*text, &old, Normals::Recompute).unwrap();
    assert_eq!(out, CUBE_CORNER.as_bytes());
    let mut new = old.clone();
    new[1] = DVec3::new(0.0, 1.0, 1.0);
    let carry = |_: usize, n: DVec3| n;
    let (out, report) = write(&*text, &new, Normals::Transform(&carry)).unwrap();
    assert_eq!((report.moved_points, report.changed_normals), (1, 1));
    let half = 2_f64.sqrt().recip();
    let expected = CUBE_CORNER
        .replace(
            "facet normal 0 0 -1",
            &format!("facet normal 0 {half} {}", -half),
        )
        .replace("0.0 1 -0", "0.0 1 1")
        .replace("vertex 0 1 0", "vertex 0 1 1");
    assert_eq!(String::from_utf8(out).unwrap(), expected);
    let (out, _) = write(&*text, &new, Normals::Keep).unwrap();
    assert!(String::from_utf8(out).unwrap().contains("normal 0 0 -1"));

    for header in [&b"solid but binary"[..], b"\0\0", b"v 0 0 0\n"] {
        let file = binary_stl(header, &FACETS);
        let binary = document(&file);
        assert_eq!((binary.format(), binary.points().len()), ("stl", 4));
        let old = points(&*binary);
        let (out, _) = write(&*binary, &old, Normals::Recompute).unwrap();
        assert!(out == file);
        let turned: Vec<DVec3> = old
            .iter()
            .map(|p| DVec3::new(p.x, 0.0 - p.z, p.y))
            .collect();
        let (out, report) = write(&*binary, &turned, Normals::Recompute).unwrap();
        assert_eq!((report.moved_points, report.changed_normals), (3, 2));
        let mut expected = FACETS.map(|f| f.map(|[x, y, z]| [x, -z, y]));
        expected[0][0] = [0., -1., 0.];
        expected[1][0] = [0., -1., 0.];
        let expected = binary_stl(header, &expected);
        // The sign of zeros aside, all is as expected, the attributes included.
        let plain = |bytes: &[u8]| points(&*load(bytes).unwrap());
        assert_eq!(plain(&out), plain(&expected));
        assert_eq!(out[84 + 48..84 + 50], [0, 0x80]);
        assert_eq!(out[134 + 48..], [1, 0x80]);
        let mut trailing = file.clone();
        trailing.extend(b"more");
        let named = read(trailing.clone(), Some("a.stl"), &ReadOptions::default());
        if header != b"v 0 0 0\n" {
            let (out, _) = write(&*named.unwrap(), &old, Normals::Keep).unwrap();
            assert!(out == trailing);
        }
    }
}

#[test]
fn stl_errors_say_what_and_where() {
    use ReadErrorKind as K;
    let cases = [
        (
            "solid\nfacet normal 0 0\n",
            K::Truncated,
            Some(3),
            "triangle 1",
        ),
        (
            "solid\nfacet normal 0 0 q outer",
            K::Number,
            Some(2),
            "\"q\"",
        ),
        (
            "solid\nfacet normal 0 0 1 outer loop\nvertex 0 0 0 vertex 1 0 0 endloop",
            K::Shape,
            Some(3),
            "`vertex`",
        ),
        (
            "solid\nfacet normal 0 0 1 outer loop\nvertex 0 0 0 vertex 1 0 0\nvertex inf 1 0 endloop endfacet endsolid",
            K::NonFinite,
            Some(4),
            "corner 3 of triangle 1",
        ),
        (
            "solid nothing\nendsolid nothing\n",
            K::NoPoints,
            None,
            "no triangles",
        ),
        (
            "solid\nfacet normal 0 0 1 outer loop\nvertex 0 0 0 vertex 1 0 0\nvertex 1 1 0 endloop endfacet",
            K::Truncated,
            Some(4),
            "endsolid",
        ),
    ];
    for (text, kind, line, words) in cases {
        let error = refusal(text.as_bytes());
        assert_eq!((error.kind, error.line), (kind, line), "{error}");
        assert!(error.to_string().contains(words), "{error}");
    }
    let file = binary_stl(b"\0", &FACETS);
    let named = |bytes: &[u8]| match read(bytes.to_vec(), Some("x.stl"), &ReadOptions::default()) {
        Err(error) => error,
        Ok(_) => panic!("accepted"),
    };
    let mut claims = file.clone();
    claims[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let error = named(&claims);
    assert_eq!(error.kind, K::Truncated);
    assert!(
        error.what.contains("4294967295") && error.what.contains("only 2"),
        "{error}"
    );
    assert_eq!(named(&file[..60]).kind, K::Truncated);
    let mut bad = file.clone();
    bad[84 + 24..84 + 28].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(
        named(&bad)
            .what
            .contains("corner 2 of triangle 1 (at byte 108)")
    );
    let passed = read(
        bad.clone(),
        Some("x.stl"),
        &ReadOptions::default().allow_nonfinite(true),
    );
    let passed = passed.unwrap();
    assert_eq!(passed.nonfinite(), [1]);
    let (out, _) = write(
        &*passed,
        &vec![DVec3::X; passed.points().len()],
        Normals::Recompute,
    )
    .unwrap();
    assert_eq!(out[84 + 24..84 + 28], bad[84 + 24..84 + 28]);
}

const OFF: &str = "# first\n\nCNOFF # kind\r\n4 2 0 # counts\n\n0 0 0 0 0 1 255 0 0 255\n  1.0 0 0\t0 0 1 0 255 0 255 # b\n\
    1 1 0 0 0 1 0 0 255 255\n# between\n0 1 0 0 0 1 0 0 0 51\n4 0 1 2 3 0.5 0.5 0.5\n2 0 2\n# last";

#[test]
fn off_keeps_its_text() {
    let text = document(OFF.as_bytes());
    assert_eq!((text.points().len(), text.normals()), (4, 4));
    assert_eq!(text.attributes(), ["red", "green", "blue", "alpha"]);
    assert_eq!(text.attribute("red").unwrap(), [1.0, 0.0, 0.0, 0.0]);
    assert_eq!(text.attribute("alpha").unwrap()[3], 0.2);
    let mesh = text.mesh().unwrap();
    assert_eq!((mesh.faces, mesh.lines), (1, vec![[0, 2]]));
    let old = points(&*text);
    assert_eq!(
        write(&*text, &old, Normals::Recompute).unwrap().0,
        OFF.as_bytes()
    );
    let turn = |_: usize, n: DVec3| DVec3::new(n.z, n.x, n.y);
    let mut new = old;
    new[1] = DVec3::new(1.0, 0.1, 0.0);
    let (out, report) = write(&*text, &new, Normals::Transform(&turn)).unwrap();
    assert_eq!((report.moved_points, report.changed_normals), (1, 4));
    let expected = OFF
        .replace("1.0 0 0\t0 0 1 0 255", "1.0 0.1 0\t1 0 0 0 255")
        .replace("0 0 0 0 0 1 255 0 0", "0 0 0 1 0 0 255 0 0")
        .replace("1 1 0 0 0 1 ", "1 1 0 1 0 0 ")
        .replace("0 1 0 0 0 1 0 0 0 51", "0 1 0 1 0 0 0 0 0 51");
    assert_eq!(String::from_utf8(out).unwrap(), expected);

    for same in [
        "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "OFF\r\n3 1 0\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2",
        "STOFF\n3 0\n0 0 0 1 1\n0 0 1 .5 1\n1 0 0 0 0\n",
    ] {
        let text = document(same.as_bytes());
        assert_eq!(text.points().len(), 3);
        assert_eq!(
            write(&*text, &points(&*text), Normals::Recompute)
                .unwrap()
                .0,
            same.as_bytes()
        );
    }
}

#[test]
fn off_errors_say_what_and_where() {
    use ReadErrorKind as K;
    for (text, kind, line, words) in [
        ("OFF BINARY\n\0\0\0", K::Unsupported, Some(1), "binary OFF"),
        ("4OFF\n1 0 0\n0 0 0 0\n", K::Unsupported, Some(1), "4OFF"),
        ("CnOFF\n3\n1 0 0\n0 0 0\n", K::Unsupported, Some(1), "CnOFF"),
        ("OFF\nmany\n", K::Header, Some(2), "counts"),
        ("OFF\n", K::Truncated, Some(2), "counts"),
        ("OFF\n0 0 0\n", K::NoPoints, None, "no points"),
        (
            "OFF\n4000000000 1 0\n0 0 0\n",
            K::Truncated,
            None,
            "4000000000",
        ),
        (
            "OFF\n2 18446744073709551615 0\n0 0 0\n1 1 1\n",
            K::Truncated,
            None,
            "announces",
        ),
        (
            "OFF\n2 0 0\n0 0 0\n1 1\n# very long comment so that there is room\n",
            K::Shape,
            Some(4),
            "point 2 has 2 numbers",
        ),
        (
            "OFF\n2 0 0\n0 0 0\n# very long comment so that there is room\n",
            K::Truncated,
            Some(5),
            "point 2 of 2",
        ),
        ("OFF\n2 0 0\n0 0 0\n1 x 1\n", K::Number, Some(4), "\"x\""),
        (
            "OFF\n2 0 0\n0 0 0\n1 inf 1\n",
            K::NonFinite,
            Some(4),
            "point 2",
        ),
        (
            "OFF\n2 1 0\n0 0 0\n1 1 1\n3 0 1 2\n",
            K::Element,
            Some(5),
            "index 2",
        ),
        (
            "OFF\n2 1 0\n0 0 0\n1 1 1\n3 0 1 -1\n",
            K::Element,
            Some(5),
            "index -1",
        ),
        (
            "OFF\n2 1 0\n0 0 0\n1 1 1\n9999999999 0 1\n",
            K::Element,
            Some(5),
            "9999999999",
        ),
    ] {
        let error = refusal(text.as_bytes());
        assert_eq!((error.kind, error.line), (kind, line), "{error}\n{text}");
        assert!(error.to_string().contains(words), "{error}");
    }
}

#[test]
fn damage_never_panics() {
    let mut random = Random(0x1234_5678_9abc_def1);
    let mut samples = vec![
        (OFF.as_bytes().to_vec(), "x.off"),
        (CUBE_CORNER.as_bytes().to_vec(), "x.stl"),
        (binary_stl(b"solid", &FACETS), "x.stl"),
        (SQUARE.as_bytes().to_vec(), "x.ply"),
    ];
    for encoding in 0..3 {
        for uneven in [false, true] {
            samples.push((rich(encoding, 6, 1, 4, uneven, "\n"), "x.ply"));
        }
    }
    let (mut accepted, mut refused) = (0, 0);
    for round in 0..20_000 {
        let (sample, name) = &samples[round % samples.len()];
        let mut bytes = sample.clone();
        match random.below(4) {
            0 => bytes.truncate(random.below(bytes.len())),
            1 => {
                let at = random.below(bytes.len());
                bytes.remove(at);
            }
            _ => {
                for _ in 0..=random.below(3) {
                    let at = random.below(bytes.len());
                    bytes[at] ^= 1 << random.below(8);
                }
            }
        }
        let options = if round % 3 == 0 {
            ReadOptions::for_inspection()
        } else {
            ReadOptions::default()
        };
        let Ok(document) = read(bytes.clone(), Some(name), &options) else {
            refused += 1;
            continue;
        };
        accepted += 1;
        let _ = document.inspect();
        let old = points(&*document);
        let same = Moved::new(document.points()).with_normals(Normals::Recompute);
        let mut out = Vec::new();
        document.write(&same, &mut out).unwrap();
        assert!(out == bytes, "{name} round {round}");
        let new: Vec<DVec3> = old
            .iter()
            .map(|p| {
                if p.is_finite() {
                    *p + random.unit()
                } else {
                    *p
                }
            })
            .collect();
        if new
            .iter()
            .zip(&old)
            .all(|(n, o)| n.is_finite() || !o.is_finite())
        {
            let _ = write(&*document, &new, Normals::Recompute);
            let geometry = document.geometry(&Moved::new(document.points())).unwrap();
            for target in targets() {
                let _ = target.create(&geometry, &mut Vec::new());
            }
        }
    }
    assert!(accepted > 2000 && refused > 5000, "{accepted} {refused}");
}

#[test]
fn attributes_in_ply_survive() {
    let table = document(b"x,y,heat,a b\n0,1,5,6\n2,3,7,8\n");
    let (ply, lost) = create(&*table, "ply");
    assert_eq!(lost, ["the attribute \"a b\""]);
    let back = document(&ply);
    assert_eq!(back.points().dimension(), 2);
    assert_eq!(back.attribute("heat").unwrap(), [5.0, 7.0]);
    let (_, lost) = create(&*table, "obj");
    assert_eq!(lost, ["the attributes heat, a b"]);
    let geometry = table.geometry(&Moved::new(table.points())).unwrap();
    let stl = targets().iter().find(|t| t.name == "stl").unwrap();
    let error = stl.create(&geometry, &mut Vec::new()).unwrap_err();
    assert!(error.to_string().contains("no faces"), "{error}");
}
