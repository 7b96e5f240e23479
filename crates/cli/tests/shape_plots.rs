//! `anamorph morph --strain-plot`: the strains that are plotted are those of eq. (1).

// Helpers of tests outside of test functions.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_io::outlines::Pair;
use anamorph_morph::strain::{self, Settings};
use common::Folder;

const BAR: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><path d="M10 40H90V60H10Z"/></svg>"##;
const BENT: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><path d="M10 40H60V90H40V60H10Z"/></svg>"##;

/// Eq. (1) by the book: the displacement `u = p' − p` of a triangle is linear, and its gradient comes from Cramer's rule.
fn strain_of(rest: [DVec2; 3], moved: [DVec2; 3]) -> [f64; 3] {
    let u = [0, 1, 2].map(|i: usize| moved[i] - rest[i]);
    let (b, c) = (rest[1] - rest[0], rest[2] - rest[0]);
    let (db, dc) = (u[1] - u[0], u[2] - u[0]);
    let determinant = b.x * c.y - b.y * c.x;
    let by_x = (db * c.y - dc * b.y) / determinant;
    let by_y = (dc * b.x - db * c.x) / determinant;
    [
        by_x.x + 0.5 * (by_x.x * by_x.x + by_x.y * by_x.y),
        by_y.y + 0.5 * (by_y.x * by_y.x + by_y.y * by_y.y),
        by_y.x + by_x.y + by_x.x * by_y.x + by_x.y * by_y.y,
    ]
}

#[test]
fn plotted_strains_are_those_of_the_formula() {
    let folder = Folder::new();
    folder.put("bar.svg", BAR).put("bent.svg", BENT);
    folder
        .run(&["mesh", "bar.svg", "bent.svg", "-o", "pair.json"])
        .done();
    let chosen = [0, 5, 9];
    folder
        .run(&[
            "morph",
            "pair.json",
            "-o",
            "x.svg",
            "--frames",
            "2",
            "--strain-plot",
            "strain.csv",
            "--triangles",
            "0,5,9",
        ])
        .done();
    let pair = Pair::read(&folder.read("pair.json")).unwrap();
    let elements = pair.triangles.iter().map(|t| t.map(|i| i as usize).into());
    let mesh = strain::Pair::new(pair.source.clone(), pair.target.clone(), elements.collect());
    let method = strain::method("indifferent").unwrap();
    let between = method
        .prepare(&mesh.unwrap(), &Settings::default())
        .unwrap();
    let text = String::from_utf8(folder.read("strain.csv")).unwrap();
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some("step,method,triangle,time,strain_x,strain_y,shear_xy")
    );
    let mut counts = [0, 0];
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let triangle: usize = cells[2].parse().unwrap();
        assert!(chosen.contains(&triangle) && cells[0] == "1");
        let numbers: Vec<f64> = cells[3..]
            .iter()
            .map(|cell| cell.parse().unwrap())
            .collect();
        let time = numbers[0];
        let moved: Vec<DVec2> = match cells[1] {
            "vertex-linear" => {
                counts[0] += 1;
                let both = pair.source.iter().zip(&pair.target);
                both.map(|(p, q)| *p + (*q - *p) * time).collect()
            }
            "indifferent" => {
                counts[1] += 1;
                between.at(time).unwrap().positions
            }
            other => panic!("{other}"),
        };
        let corners = pair.triangles[triangle].map(|i| i as usize);
        let wanted = strain_of(corners.map(|i| pair.source[i]), corners.map(|i| moved[i]));
        for (found, wanted) in numbers[1..].iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-12, "{line}: {wanted}");
        }
    }
    assert_eq!(counts, [3 * 61; 2]);
}

#[test]
fn means_are_by_area_and_pictures_are_drawn() {
    let folder = Folder::new();
    folder.put("bar.svg", BAR).put("bent.svg", BENT);
    for name in ["s.csv", "s.svg", "s.png"] {
        folder
            .run(&[
                "morph",
                "bar.svg",
                "bent.svg",
                "bar.svg",
                "-o",
                "x.svg",
                "-f",
                "--frames",
                "2",
                "--strain-plot",
                name,
            ])
            .done();
    }
    let svg = String::from_utf8(folder.read("s.svg")).unwrap();
    for words in [
        "strain x",
        "shear xy",
        "vertex-linear",
        "indifferent",
        "time",
        ">0.25<",
    ] {
        assert!(svg.contains(words), "{words}");
    }
    assert!(folder.read("s.png").starts_with(b"\x89PNG"));
    let text = String::from_utf8(folder.read("s.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 1 + 2 * 2 * 61);
    assert_eq!(rows[0].len(), 18);
    for row in &rows[1..] {
        let numbers: Vec<f64> = row[2..].iter().map(|cell| cell.parse().unwrap()).collect();
        for values in numbers[1..].chunks_exact(5) {
            let [mean, low, high, least, most] = values.try_into().unwrap();
            assert!(least <= low && low <= high && high <= most);
            assert!(least - 1e-12 <= mean && mean <= most + 1e-12);
            assert!(numbers[0] > 0.0 || values.iter().all(|value| value.abs() < 1e-12));
        }
    }
    // At the end, whatever the method, strains are those of the target.
    let last = |method: &str| {
        let of = |row: &&Vec<&str>| row[0] == "1" && row[1] == method && row[2] == "1";
        rows.iter().find(of).unwrap()[3..].to_vec()
    };
    let numbers = |method: &str| -> Vec<f64> {
        last(method)
            .iter()
            .map(|cell| cell.parse().unwrap())
            .collect()
    };
    for (a, b) in numbers("indifferent").iter().zip(numbers("vertex-linear")) {
        assert!((a - b).abs() < 1e-6 * b.abs().max(1.0), "{a} {b}");
    }
    let scaled = strain_of(
        [dvec2(0.0, 0.0), dvec2(1.0, 0.0), dvec2(0.0, 1.0)],
        [dvec2(5.0, 0.0), dvec2(7.0, 0.0), dvec2(5.0, 1.0)],
    );
    assert_eq!(scaled, [1.5, 0.0, 0.0]);
}

#[test]
fn what_cannot_be_plotted_is_refused() {
    let folder = Folder::new();
    folder.put("bar.svg", BAR).put("bent.svg", BENT);
    for (more, says) in [
        (&["--strain-plot", "s.pdf"][..], "s.pdf"),
        (
            &["--strain-plot", "s.svg", "--triangles", "100000"],
            "100000",
        ),
        (&["--triangles", "1"], "--strain-plot"),
    ] {
        let all = [
            &["morph", "bar.svg", "bent.svg", "-o", "x.svg", "-f"][..],
            more,
        ]
        .concat();
        let run = folder.run(&all);
        assert_eq!(run.code, 2, "{run:?}");
        assert!(run.err.contains(says), "{}", run.err);
    }
}
