//! Tables of points, through the public interface.
#![allow(clippy::unwrap_used, clippy::panic)]

use anamorph_core::glam::{DVec2, DVec3};
use anamorph_io::{
    Document, Moved, Normals, Points, ProblemKind, ReadError, ReadErrorKind, ReadOptions, read,
};

fn table(text: &str) -> Box<dyn Document> {
    read(
        text.as_bytes().to_vec(),
        Some("points.csv"),
        &ReadOptions::default(),
    )
    .unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn refusal(text: &str) -> ReadError {
    match read(
        text.as_bytes().to_vec(),
        Some("points.csv"),
        &ReadOptions::default(),
    ) {
        Err(error) => error,
        Ok(_) => panic!("{text:?} passes"),
    }
}

fn plane(points: &[(f64, f64)]) -> Vec<DVec2> {
    points.iter().map(|&(x, y)| DVec2::new(x, y)).collect()
}

fn written(document: &dyn Document, points: Points<'_>) -> String {
    let mut out = Vec::new();
    let report = document
        .write(
            &Moved::new(points).with_normals(Normals::Recompute),
            &mut out,
        )
        .unwrap();
    assert_eq!(report.bytes, out.len() as u64);
    String::from_utf8(out).unwrap()
}

#[test]
fn other_columns_quotes_blanks_and_line_ends_stay() {
    let text = "\u{FEFF}name; Y ;\"x\";note\r\n\"a;\"\"b\"\"\";1.50; \"2\" ;\"two\nlines\"\r\n\r\n'q';0.10;4e0;\r\nlast;7;8;9";
    let document = table(text);
    assert_eq!(
        document.points(),
        Points::Plane(&plane(&[(2.0, 1.5), (4.0, 0.1), (8.0, 7.0)]))
    );
    assert_eq!(written(&*document, document.points()), text);
    let new = plane(&[(2.5, 1.5), (4.0, 0.25), (1e21, -0.0)]);
    assert_eq!(
        written(&*document, Points::Plane(&new)),
        "\u{FEFF}name; Y ;\"x\";note\r\n\"a;\"\"b\"\"\";1.50; \"2.5\" ;\"two\nlines\"\r\n\r\n'q';0.25;4e0;\r\nlast;-0;1e+21;9"
            .replace("1e+21", &exponent(1e21))
    );
}

/// How a large number is spelled is not the point here.
fn exponent(value: f64) -> String {
    let document = table("x,y\n0,0\n");
    let out = written(&*document, Points::Plane(&[DVec2::new(value, 0.0)]));
    let text = out
        .lines()
        .nth(1)
        .unwrap()
        .split(',')
        .next()
        .unwrap()
        .to_string();
    assert_eq!(text.parse(), Ok(value));
    text
}

#[test]
fn the_header_gives_dimension_delimiter_and_order() {
    for (text, point) in [
        ("x,y,z\n1,2,3\n", DVec3::new(1., 2., 3.)),
        ("Z\tX\tY\n3\t1\t2\n", DVec3::new(1., 2., 3.)),
        ("a|z|b|y|x\n,|3|;|2|1", DVec3::new(1., 2., 3.)),
        ("\n\nid;x;y;z\r\n7;1;2;3\r\n\r\n", DVec3::new(1., 2., 3.)),
    ] {
        assert_eq!(table(text).points(), Points::Solid(&[point]), "{text:?}");
    }
    // A column may be empty under a tab.
    assert_eq!(
        table("x\ty\tc\n1\t2\t\n").points(),
        Points::Plane(&plane(&[(1.0, 2.0)]))
    );
}

#[test]
fn numeric_columns_are_attributes() {
    let document = table("mass,x,label,y,heat,heat\n1,0,a,0,nan,1\n2.5,1,b,1,3,2\n");
    assert_eq!(document.attributes(), ["mass", "heat"]);
    assert_eq!(document.attribute("mass"), Some(vec![1.0, 2.5]));
    assert_eq!(document.attribute("label"), None);
    assert_eq!(document.attribute("x"), None);
    let inspection = document.inspect();
    assert_eq!(inspection.counts, [("points", 2), ("columns", 6)]);
    assert_eq!(inspection.bounds, Some((vec![0.0, 0.0], vec![1.0, 1.0])));
    let kinds: Vec<_> = inspection
        .problems
        .iter()
        .map(|p| (p.kind, p.count, p.line))
        .collect();
    assert_eq!(kinds, [(ProblemKind::NonFiniteAttribute, 1, Some(2))]);
}

#[test]
fn errors_say_what_and_where() {
    use ReadErrorKind::{Encoding, Header, NoPoints, NonFinite, Number, Quote, Shape};
    for (text, kind, line, words) in [
        ("", NoPoints, None, "empty"),
        ("\n \n", NoPoints, None, "empty"),
        ("x,y\n", NoPoints, None, "no rows"),
        ("1,2\n3,4\n", Header, Some(1), "not the names"),
        ("\nx,z\n3,4\n", Header, Some(2), "no column y"),
        (
            "a;b\n3;4\n",
            Header,
            Some(1),
            "no column x; its columns are: a, b",
        ),
        (
            "x,y,X\n1,2,3\n",
            Header,
            Some(1),
            "columns 1 and 3 are both called x",
        ),
        (
            "x,y\n1,2\n\n3\n",
            Shape,
            Some(4),
            "point 2 has 1 fields, but the header has 2",
        ),
        ("x,y\n1,2,3\n", Shape, Some(2), "point 1 has 3 fields"),
        (
            "x,y\n1,two\n",
            Number,
            Some(2),
            "the y coordinate of point 1 (column 2) is \"two\"",
        ),
        ("x;y\n1;2,5\n", Number, Some(2), "decimal point"),
        ("x,y\n1,\n", Number, Some(2), "is empty"),
        ("x,y\n1,inf\n", NonFinite, Some(2), "not finite"),
        ("x,y,n\n1,2,\"a\n3,4,b\n", Quote, Some(2), "not closed"),
        ("x,y\n1,\0\n", Encoding, None, "binary"),
    ] {
        let error = refusal(text);
        assert_eq!((error.kind, error.line), (kind, line), "{text:?}: {error}");
        assert!(
            error.to_string().contains(words) && !error.mend.is_empty(),
            "{text:?}: {error}"
        );
    }
    assert_eq!(refusal("x,y\n1,two\n").column, Some(3));
    let wide: Vec<u8> = "x,y\n1,2\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    let error = read(wide, Some("a.csv"), &ReadOptions::default())
        .err()
        .unwrap();
    assert_eq!(error.kind, Encoding);
}

#[test]
fn points_that_are_not_finite_pass_untouched() {
    let text = "x,y\n1,2\nNaN,3\n4,-inf\n";
    let options = ReadOptions::default().allow_nonfinite(true);
    let document = read(text.as_bytes().to_vec(), None, &options).unwrap();
    assert_eq!(document.nonfinite(), [1, 2]);
    let new = plane(&[(5.0, 2.0), (9.0, 9.0), (9.0, 9.0)]);
    assert_eq!(
        written(&*document, Points::Plane(&new)),
        "x,y\n5,2\nNaN,3\n4,-inf\n"
    );
}

#[test]
fn random_tables_and_random_damage() {
    let mut state = 0xdead_beef_cafe_u64;
    let mut next = move |n: u64| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 9) % n
    };
    for _ in 0..2000 {
        let delimiter = [",", ";", "\t", "|"][next(4) as usize];
        let feed = ["\n", "\r\n"][next(2) as usize];
        let mut columns = vec!["x".to_string(), "\"Y\"".into()];
        for i in 0..next(3) {
            columns.insert(next(columns.len() as u64 + 1) as usize, format!("c{i}"));
        }
        let mut text = columns.join(delimiter) + feed;
        for _ in 0..1 + next(6) {
            let fields: Vec<String> = columns
                .iter()
                .map(|name| match (name.starts_with('c'), next(3)) {
                    (true, 0) => "\"a,;\t|\"\" b\n\"".to_string(),
                    (true, _) => " text ".into(),
                    (false, 0) => format!("\" {}.{:03} \"", next(50), next(1000)),
                    (false, _) => format!(" {}e-{}", next(1_000_000), next(9)),
                })
                .collect();
            text += &(fields.join(delimiter) + feed);
        }
        let document = table(&text);
        let Points::Plane(old) = document.points() else {
            panic!("{text}")
        };
        assert_eq!(written(&*document, document.points()), text);
        let new: Vec<DVec2> = old
            .iter()
            .map(|p| DVec2::new(p.y / 3.0, if next(2) == 0 { p.y } else { 0.1 }))
            .collect();
        let out = written(&*document, Points::Plane(&new));
        let back = table(&out);
        assert_eq!(back.points(), Points::Plane(&new));
        assert_eq!(out.matches("text").count(), text.matches("text").count());

        let mut bytes = text.into_bytes();
        for _ in 0..1 + next(3) {
            let at = next(bytes.len() as u64) as usize;
            match next(3) {
                0 => bytes.truncate(at + 1),
                1 => bytes[at] = next(256) as u8,
                _ => bytes[at] = b"\"\n,;x\r"[next(6) as usize],
            }
        }
        if let Ok(document) = read(bytes.clone(), Some("a.csv"), &ReadOptions::for_inspection()) {
            document.inspect();
            let mut out = Vec::new();
            document
                .write(&Moved::new(document.points()), &mut out)
                .unwrap();
            assert_eq!(out, bytes);
        }
    }
}

/// Names used to be compared each with each: this took minutes.
#[test]
fn very_many_columns_are_read_in_one_pass() {
    const COLUMNS: usize = 100_000;
    let mut text = String::from("x,y");
    for column in 0..COLUMNS {
        text.push_str(&format!(",c{column}"));
    }
    // Twice the same name: the first one counts.
    text.push_str(",c7\n1,2");
    text.push_str(&",3".repeat(COLUMNS - 1));
    text.push_str(",inf,4\n");
    let document = read(text.into_bytes(), None, &ReadOptions::default()).unwrap();
    assert_eq!(document.attributes().len(), COLUMNS);
    assert_eq!(document.attribute("c7").unwrap(), [3.0]);
    assert_eq!(document.attribute("c"), None);
    let problems = document.inspect().problems;
    assert_eq!(problems.len(), 1);
    assert_eq!(problems[0].kind, ProblemKind::NonFiniteAttribute);
    assert_eq!((problems[0].count, problems[0].line), (1, Some(2)));
}
