//! OBJ documents through the public interface: normals, hostile input, large files.
#![allow(clippy::unwrap_used, clippy::panic)]

use anamorph_core::glam::DVec3;
use anamorph_io::{
    Document, Inspection, Moved, Normals, Points, ProblemKind, ReadOptions, WriteError,
    WriteReport, read,
};

fn document(text: &str) -> Box<dyn Document> {
    read(
        text.as_bytes().to_vec(),
        Some("model.obj"),
        &ReadOptions::default(),
    )
    .unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn points(document: &dyn Document) -> Vec<DVec3> {
    match document.points() {
        Points::Solid(points) => points.to_vec(),
        Points::Plane(_) => panic!("OBJ files lie in space"),
    }
}

fn written(
    document: &dyn Document,
    points: &[DVec3],
    normals: Normals<'_>,
) -> (String, WriteReport) {
    let mut out = Vec::new();
    let report = document
        .write(
            &Moved::new(Points::Solid(points)).with_normals(normals),
            &mut out,
        )
        .unwrap();
    (String::from_utf8(out).unwrap(), report)
}

const SHARED: &str = "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nvn 0 0 1.000 # up\r\nf 1//-1 2//1 3//1\r\nf 1//1 3//-1 4//1";

#[test]
fn a_normal_that_stays_common_is_rewritten_in_place() {
    let document = document(SHARED);
    let turn = |_: usize, n: DVec3| DVec3::new(n.z, n.x, n.y);
    let (out, report) = written(&*document, &points(&*document), Normals::Transform(&turn));
    assert_eq!(out, SHARED.replace("vn 0 0 1.000 #", "vn 1 0 0 #"));
    assert_eq!(
        (
            report.moved_points,
            report.changed_normals,
            report.added_normals
        ),
        (0, 1, 0)
    );
}

#[test]
fn a_normal_that_parts_is_appended_behind_all_relative_indices() {
    let document = document(SHARED);
    // Vertex 2 keeps it, 1 and 3 get one new value, 4 another.
    let part = |v: usize, n: DVec3| [DVec3::X, n, DVec3::X, DVec3::Y][v];
    let (out, report) = written(&*document, &points(&*document), Normals::Transform(&part));
    let expected = SHARED
        .replace("f 1//-1 2//1 3//1", "f 1//3 2//1 3//3")
        .replace(
            "f 1//1 3//-1 4//1",
            "f 1//3 3//3 4//2\r\nvn 0 1 0\r\nvn 1 0 0",
        );
    assert_eq!(out, expected);
    assert_eq!(
        (
            report.changed_normals,
            report.added_normals,
            report.kept_normals
        ),
        (0, 2, 0)
    );
    // Where no use keeps the old one, the first use stays on the line.
    let part = |v: usize, _: DVec3| if v < 3 { DVec3::X } else { DVec3::Y };
    let (out, _) = written(&*document, &points(&*document), Normals::Transform(&part));
    assert_eq!(
        out,
        SHARED
            .replace("vn 0 0 1.000", "vn 1 0 0")
            .replace("4//1", "4//2\r\nvn 0 1 0")
    );
}

#[test]
fn rounding_does_not_part_a_normal() {
    let document = document(SHARED);
    let noise = |v: usize, _: DVec3| DVec3::new(1e-17 * v as f64, 0.0, 1.0 - 1e-16 * v as f64);
    assert_eq!(
        written(&*document, &points(&*document), Normals::Transform(&noise)).0,
        SHARED
    );
}

#[test]
fn a_last_line_that_is_joined_does_not_swallow_the_appendix() {
    for end in ["\\", "\\\n", "\n", "", " # note \\\n"] {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1{end}");
        let document = document(&text);
        let part = |v: usize, _: DVec3| DVec3::new(1.0, v as f64, 0.0);
        let (out, report) = written(&*document, &points(&*document), Normals::Transform(&part));
        assert_eq!(report.added_normals, 2);
        let back = read(out.clone().into_bytes(), None, &ReadOptions::default()).unwrap();
        assert_eq!(back.normals(), 3, "{out:?}");
        assert_eq!(back.mesh(), document.mesh());
        assert_eq!(out.ends_with('\n'), text.ends_with('\n'));
    }
}

#[test]
fn recomputed_normals_stand_on_the_moved_faces_and_keep_edges_hard() {
    // A wedge: two quads that share the edge 1–2, once smooth (one normal there), once hard (two).
    let vertices = "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nv -1 0 1\nv -1 0 0\nvn 0 1 0\nvn 0 1 0\n";
    let bend = |p: &DVec3| DVec3::new(p.x, 0.0 - p.x.abs(), p.z);
    let normals = |out: &str| -> Vec<DVec3> {
        let numbers =
            |line: &str| -> Vec<f64> { line[3..].split(' ').map(|t| t.parse().unwrap()).collect() };
        out.lines()
            .filter(|line| line.starts_with("vn"))
            .map(|line| DVec3::from_slice(&numbers(line)))
            .collect()
    };
    let (left, right) = (
        DVec3::new(-1., 1., 0.).normalize(),
        DVec3::new(1., 1., 0.).normalize(),
    );

    let hard = document(&format!(
        "{vertices}f 1//1 2//1 3//1 4//1\nf 2//2 1//2 6//2 5//2\n"
    ));
    let moved: Vec<DVec3> = points(&*hard).iter().map(bend).collect();
    let (out, report) = written(&*hard, &moved, Normals::Recompute);
    let found = normals(&out);
    assert_eq!((found.len(), report.added_normals), (2, 0));
    assert!(
        (found[0] - right).length() < 1e-15 && (found[1] - left).length() < 1e-15,
        "{out}"
    );

    let smooth = document(&format!(
        "{vertices}f 1//1 2//1 3//1 4//1\nf 2//1 1//1 6//1 5//1\n"
    ));
    let (out, report) = written(&*smooth, &moved, Normals::Recompute);
    let found = normals(&out);
    assert_eq!(
        (found.len(), report.added_normals, report.changed_normals),
        (4, 2, 0)
    );
    assert!(
        (found[0] - DVec3::Y).length() < 1e-15,
        "the edge between stays up: {out}"
    );
    assert!(found[2..].iter().any(|n| (*n - left).length() < 1e-15));
    assert!(found[2..].iter().any(|n| (*n - right).length() < 1e-15));

    let (out, report) = written(&*smooth, &moved, Normals::Keep);
    assert_eq!(normals(&out), [DVec3::Y, DVec3::Y]);
    assert_eq!((report.moved_points, report.changed_normals), (4, 0));
}

#[test]
fn odd_but_valid_files_load() {
    for (text, triangles) in [
        ("v 1 0 0 0.5\nv 0 1 0 0.1 \nv 0 0 1 3\nf 1 2 3", 1),
        ("v .8e-001 -.7e+02 -5.5\nv +1 2. 3\nv 1 1 1\nf 1 2 3\n", 1),
        ("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1// 2// 3// 4//\n", 2),
        ("f -0001 2 3\nv 0 0 0\n", usize::MAX),
        ("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", 1),
        ("g An f Three Other Things\nv 388.0 778.0 347.1", 0),
        (
            "v 1e38 1e308 0\nv -1e308 4.9e-324 0\nv 0 0 -1e308\nv 1 1 1\nf 1 2 3\nf 1 2 3 4\n",
            3,
        ),
        ("\u{FEFF}v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/9 2//9 3/9/9\n", 1),
        ("v 0 0 0\nl 1 1 1\np 1\n", 0),
    ] {
        let Ok(document) = read(text.as_bytes().to_vec(), None, &ReadOptions::default()) else {
            assert_eq!(triangles, usize::MAX, "{text}");
            continue;
        };
        assert_eq!(
            document.mesh().map_or(0, |mesh| mesh.triangles.len()),
            triangles,
            "{text}"
        );
        let (out, _) = written(&*document, &points(&*document), Normals::Recompute);
        assert_eq!(out, text);
    }
}

#[test]
fn points_that_are_not_finite_pass_untouched_on_request() {
    let text = "v 0 0 0\nv nan 1 1.#IND\nv 1 1 1\nv -inf 0 0\nf 1 2 3\n";
    assert!(read(text.into(), None, &ReadOptions::default()).is_err());
    let document = read(
        text.into(),
        None,
        &ReadOptions::default().allow_nonfinite(true),
    )
    .unwrap();
    assert_eq!(document.nonfinite(), [1, 3]);
    let (out, report) = written(&*document, &[DVec3::ONE; 4], Normals::Keep);
    assert_eq!(out, text.replace("v 0 0 0", "v 1 1 1"));
    assert_eq!(report.moved_points, 1);
}

#[test]
fn moves_that_cannot_be_written_are_refused_before_anything_is() {
    let document = document("v 0 0 0\nv 1 0 0\n");
    let mut out = Vec::new();
    let mut attempt = |points: Points<'_>| {
        let error = document.write(&Moved::new(points), &mut out).unwrap_err();
        assert!(out.is_empty());
        error
    };
    assert!(matches!(
        attempt(Points::Solid(&[DVec3::ZERO])),
        WriteError::Mismatch {
            expected: 2,
            got: 1,
            ..
        }
    ));
    assert!(matches!(
        attempt(Points::Plane(&[])),
        WriteError::Mismatch { .. }
    ));
    let error = attempt(Points::Solid(&[DVec3::ZERO, DVec3::INFINITY]));
    assert!(
        matches!(error, WriteError::NonFinite { first: 2, count: 1 }),
        "{error}"
    );
}

#[test]
fn a_failing_output_is_an_error() {
    struct Full;
    impl std::io::Write for Full {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(std::io::Error::other("no space"))
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    for text in ["v 0 0 0\n", "x,y\n1,2\n"] {
        let document = read(text.into(), None, &ReadOptions::default()).unwrap();
        let result = document.write(&Moved::new(document.points()), &mut Full);
        assert!(matches!(result, Err(WriteError::Output(_))));
    }
}

fn inspection(text: &str) -> Inspection {
    read(text.into(), None, &ReadOptions::for_inspection())
        .unwrap()
        .inspect()
}

/// Kind, count, line and words of each problem.
fn problems(text: &str) -> Vec<(ProblemKind, u64, Option<u64>, String)> {
    inspection(text)
        .problems
        .into_iter()
        .map(|p| (p.kind, p.count, p.line, p.first))
        .collect()
}

#[test]
fn inspection_names_each_problem_and_its_place() {
    use ProblemKind::*;
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    assert_eq!(problems(&format!("{square}f 1 2 3 4\n")), []);
    assert_eq!(
        problems(&format!(
            "{square}f 1 2 3\nf 1 2 3 3\nf 1 9 2\nf 0 1 2\nf 1 1 1 1\n"
        )),
        [
            (
                BrokenElement,
                2,
                Some(7),
                "face 3 refers to vertex \"9\", but the file has 4 vertices".into()
            ),
            (RepeatedVertex, 2, Some(6), "face 2".into()),
            (UnusedVertex, 1, Some(4), "vertex 4".into()),
            (InconsistentWinding, 3, Some(6), "edge 1–2 of face 2".into()),
        ]
    );
    assert_eq!(
        problems(
            "v 0 0 0\nv 1 1 1\nv 2 2 2\n\nv -0 0 0\nv nan 0 0\nvn 1 x\nf 1/1 2//1 3\nf 1 2 3\n"
        ),
        [
            (NonFinitePoint, 1, Some(6), "vertex 5".into()),
            (NonFiniteNormal, 1, Some(7), "normal 1".into()),
            (
                DanglingReference,
                1,
                Some(8),
                "face 1: texture coordinate 1 of 0".into()
            ),
            (MixedReferences, 1, Some(8), "face 1".into()),
            (ZeroAreaFace, 2, Some(8), "face 1".into()),
            (UnusedVertex, 2, Some(5), "vertex 4".into()),
            (CoincidentVertex, 1, Some(5), "vertex 4".into()),
            (InconsistentWinding, 3, Some(9), "edge 1–2 of face 2".into()),
        ]
    );
    assert_eq!(
        problems(&format!(
            "f 1 2 9\n{square}v 0 0 1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n"
        )),
        [
            (
                BrokenElement,
                1,
                Some(1),
                "face 1 refers to vertex \"9\", but the file has 5 vertices".into()
            ),
            (NonManifoldEdge, 1, Some(9), "edge 1–2 of face 4".into()),
        ]
    );
    let coloured = inspection("v 0 0 0 1 0.5 0\nv 1 2 -3 nan 1 1\n");
    assert_eq!(coloured.attributes, ["red", "green", "blue"]);
    assert_eq!(
        coloured.bounds,
        Some((vec![0.0, 0.0, -3.0], vec![1.0, 2.0, 0.0]))
    );
    assert_eq!(coloured.counts, [("vertices", 2), ("faces", 0)]);
    assert_eq!(
        (coloured.problems[0].kind, coloured.problems[0].line),
        (NonFiniteAttribute, Some(2))
    );
    assert_eq!(
        document("v 0 0 0 2\nv 0 0 0 3").attribute("w"),
        Some(vec![2.0, 3.0])
    );
    assert_eq!(
        document("v 0 0 0 1 2 3\nv 0 0 0 4 5 6").attribute("green"),
        Some(vec![2.0, 5.0])
    );
    assert!(document("v 0 0 0 1 2 3\nv 0 0 0").attributes().is_empty());
}

/// Several chunks of full size: a sphere whose positions and triangles tobj reads too.
#[test]
fn a_large_file_agrees_with_tobj() {
    use std::fmt::Write as _;
    let (rings, sides) = (200_u32, 300_u32);
    let mut text = String::new();
    for i in 0..rings {
        for j in 0..sides {
            let (a, b) = (
                f64::from(i) / f64::from(rings),
                f64::from(j) / f64::from(sides),
            );
            let _ = writeln!(
                text,
                "v {} {:.6} {:e}",
                (a - 0.5) * b,
                (b - 0.5) * (1.0 - a),
                a * a + b * b - a * b
            );
        }
    }
    for i in 0..rings - 1 {
        for j in 0..sides {
            let (a, b) = (i * sides + j + 1, i * sides + (j + 1) % sides + 1);
            let _ = writeln!(
                text,
                "f {a} {b} {}\nf {a} {} {}",
                b + sides,
                b + sides,
                a + sides
            );
        }
    }
    assert!(text.len() > 4 << 20);
    let document = document(&text);
    let old = points(&*document);
    let (same, _) = written(&*document, &old, Normals::Recompute);
    assert!(same == text);
    let new: Vec<DVec3> = old
        .iter()
        .map(|p| DVec3::new(p.y / 3.0, p.z * p.x, p.x))
        .collect();
    let (out, report) = written(&*document, &new, Normals::Keep);
    assert!(report.moved_points > 59_000);
    let (models, _) =
        tobj::load_obj_buf(&mut out.as_bytes(), &tobj::LoadOptions::default(), |_| {
            Ok(Default::default())
        })
        .unwrap();
    let mesh = &models[0].mesh;
    let theirs = mesh
        .indices
        .iter()
        .map(|i| DVec3::from_slice(&mesh.positions[3 * *i as usize..]));
    let triangles = document.mesh().unwrap().triangles;
    let ours = triangles.iter().flatten().map(|v| new[*v as usize]);
    assert!(ours.eq(theirs));
}
