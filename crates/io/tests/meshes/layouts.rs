//! Binary PLY files of random layouts. What is read and written is compared with what the test itself puts together number
//! by number, so that layouts that are read a vector at a time and those that are not obey one law.

use super::*;
use std::fmt::Write;

/// How the vertices of a file are laid out.
struct Layout {
    /// 1 little, 2 big endian.
    encoding: usize,
    /// Names and types in the order of the file. The name `list` is a list of bytes counted by a byte.
    properties: Vec<(String, usize)>,
}

impl Layout {
    fn random(random: &mut Random) -> Self {
        let coordinate = if random.below(4) == 0 { 7 } else { 6 };
        let mut groups: Vec<Vec<(&str, usize)>> =
            vec![["x", "y", "z"].map(|n| (n, coordinate)).to_vec()];
        if random.below(2) == 0 {
            let kind = 6 + random.below(2);
            groups.push(["nx", "ny", "nz"].map(|n| (n, kind)).to_vec());
        }
        for (name, kind) in [("red", 1), ("flags", 2), ("weight", 7), ("label", 5)] {
            if random.below(3) == 0 {
                groups.push(vec![(name, kind)]);
            }
        }
        // Half of the layouts keep the axes together; the others do anything.
        match random.below(6) {
            0 => groups[0].swap(0, 2),
            1 => groups[0][random.below(3)].1 = random.below(8),
            2 => groups = groups.concat().into_iter().map(|p| vec![p]).collect(),
            _ => {}
        }
        if random.below(4) == 0 {
            groups.push(vec![("list", 1)]);
        }
        for i in (1..groups.len()).rev() {
            groups.swap(i, random.below(i + 1));
        }
        Self {
            encoding: 1 + random.below(2),
            properties: groups
                .concat()
                .into_iter()
                .map(|(n, k)| (n.to_owned(), k))
                .collect(),
        }
    }
    fn kind(&self, name: &str) -> Option<usize> {
        let found = self.properties.iter().find(|p| p.0 == name);
        found.map(|p| p.1)
    }
    fn header(&self, vertices: usize) -> String {
        let format = ["", "little", "big"][self.encoding];
        let mut out =
            format!("ply\nformat binary_{format}_endian 1.0\nelement vertex {vertices}\n");
        for (name, kind) in &self.properties {
            let list = if name == "list" { "list uchar " } else { "" };
            let _ = writeln!(out, "property {list}{} {name}", TYPES[*kind].0);
        }
        out
    }
    /// A file of these vertices; `uneven` makes the rows of different lengths where there are lists.
    fn file(&self, points: &[DVec3], normals: &[DVec3], uneven: bool) -> Vec<u8> {
        let mut out = self.header(points.len()).into_bytes();
        out.extend(b"end_header\n");
        for (i, (point, normal)) in points.iter().zip(normals).enumerate() {
            for (name, kind) in &self.properties {
                let value = match name.as_str() {
                    "x" => point.x,
                    "y" => point.y,
                    "z" => point.z,
                    "nx" => normal.x,
                    "ny" => normal.y,
                    "nz" => normal.z,
                    "list" => {
                        let count = if uneven { i % 4 } else { 3 };
                        out.push(count as u8);
                        out.extend((0..count).map(|n| n as u8));
                        continue;
                    }
                    _ => (i % 100) as f64,
                };
                put(&mut out, self.encoding, *kind, value);
            }
        }
        out
    }
    /// A vector as the types of three properties hold it.
    fn rounded(&self, names: [&str; 3], vector: DVec3) -> DVec3 {
        let mut all = vector.to_array();
        for (value, name) in all.iter_mut().zip(names) {
            *value = match self.kind(name) {
                Some(6) => f64::from(*value as f32),
                Some(7) | None => *value,
                // Whole numbers that all types hold.
                _ => value.abs().min(100.0).trunc(),
            };
        }
        DVec3::from_array(all)
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];
const NORMAL: [&str; 3] = ["nx", "ny", "nz"];

fn bits(vector: DVec3) -> [u64; 3] {
    vector.to_array().map(f64::to_bits)
}

/// A number that may be hard: of any size, denormal, or a zero of either sign.
fn number(random: &mut Random) -> f64 {
    match random.below(8) {
        0 => 0.0,
        1 => -0.0,
        2 => 1e-42 * random.unit(),
        3 => f64::from(f32::MAX) * (random.unit() - 0.5),
        _ => 20.0 * random.unit() - 10.0,
    }
}

fn vector(random: &mut Random) -> DVec3 {
    DVec3::new(number(random), number(random), number(random))
}

#[test]
fn ply_vectors_read_and_write_alike_in_every_layout() {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let (mut together, mut apart) = (0, 0);
    for round in 0..400 {
        let layout = Layout::random(&mut random);
        let uneven = random.below(2) == 0;
        // Now and then more than are handled together.
        let count = if round % 40 == 0 {
            70_000
        } else {
            1 + random.below(60)
        };
        let broken = random.below(3) == 0 && [6, 7].contains(&layout.kind("y").unwrap());
        let mut old: Vec<DVec3> = (0..count)
            .map(|_| layout.rounded(AXES, vector(&mut random)))
            .collect();
        let normals: Vec<DVec3> = (0..count)
            .map(|_| layout.rounded(NORMAL, vector(&mut random)))
            .collect();
        let mut nonfinite = Vec::new();
        if broken {
            for _ in 0..1 + count / 1000 {
                let i = random.below(count);
                old[i].y = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][random.below(3)];
                nonfinite.push(i);
            }
            nonfinite.sort_unstable();
            nonfinite.dedup();
        }
        let file = layout.file(&old, &normals, uneven);
        let what = format!("round {round}: {:?}", layout.properties);
        let options = ReadOptions::default().allow_nonfinite(true);
        let document = read(file.clone(), None, &options).unwrap();
        let found = points(&*document);
        assert_eq!(document.nonfinite(), nonfinite, "{what}");
        assert!(
            found.iter().zip(&old).all(|(a, b)| bits(*a) == bits(*b)),
            "{what}"
        );
        if broken {
            let error = refusal(&file);
            assert_eq!(error.kind, ReadErrorKind::NonFinite, "{what}");
            let name = format!("vertex {} ", nonfinite[0] + 1);
            assert!(error.what.starts_with(&name), "{what}: {error}");
        }
        let (out, report) = write(&*document, &found, Normals::Keep).unwrap();
        assert!(out == file, "{what}");
        assert_eq!(report.moved_points, 0, "{what}");

        // Some points move, in some coordinates; some places that are not finite are said to move, and do not.
        let mut new = found.clone();
        let mut expected = found.clone();
        let mut moved = 0;
        for (i, new) in new.iter_mut().enumerate() {
            let to = match random.below(4) {
                0 => vector(&mut random),
                1 => DVec3::new(number(&mut random), new.y, new.z),
                _ => continue,
            };
            let held = layout.rounded(AXES, to);
            let whole = AXES.iter().any(|axis| layout.kind(axis).unwrap() < 6);
            let to = if whole { held } else { to };
            if !to.is_finite() {
                continue;
            }
            moved += usize::from(found[i].is_finite() && bits(to) != bits(*new));
            *new = to;
            if found[i].is_finite() {
                expected[i] = held;
            }
        }
        let other: Vec<DVec3> = (0..count)
            .map(|_| layout.rounded(NORMAL, DVec3::X * random.unit() + DVec3::ONE))
            .collect();
        let (out, report) = write(&*document, &new, Normals::Keep).unwrap();
        assert!(out == layout.file(&expected, &normals, uneven), "{what}");
        assert_eq!(report.moved_points, moved, "{what}");
        if document.normals() > 0 {
            let turn = |i: usize, _: DVec3| other[i];
            let (out, report) = write(&*document, &new, Normals::Transform(&turn)).unwrap();
            let back = read(out.clone(), None, &options).unwrap();
            assert_eq!(report.moved_points, moved, "{what}");
            let geometry = back.geometry(&Moved::new(back.points())).unwrap();
            let anamorph_io::Values::Points(stored) = geometry.normals else {
                panic!("{what}");
            };
            assert!(out == layout.file(&expected, &stored, uneven), "{what}");
            let changed = stored.iter().zip(&normals);
            let changed = changed.filter(|(a, b)| bits(**a) != bits(**b)).count();
            assert_eq!(report.changed_normals, changed, "{what}");
        }
        // What does not fit is refused before anything is written, and so is what is not finite.
        let last = (0..count).rev().find(|&i| found[i].is_finite());
        if let Some(last) = last {
            let mut bad = found.clone();
            bad[last].z = 1e39;
            let mut out = Vec::new();
            let result = document.write(&Moved::new(Points::Solid(&bad)), &mut out);
            if layout.kind("z") == Some(7) {
                result.unwrap();
            } else {
                let error = result.unwrap_err();
                assert!(matches!(error, WriteError::DoesNotFit { .. }), "{error}");
                assert!(error.to_string().contains(&format!("vertex {}", last + 1)));
                assert!(out.is_empty(), "{what}");
            }
            bad[last].z = f64::NAN;
            let mut out = Vec::new();
            let result = document.write(&Moved::new(Points::Solid(&bad)), &mut out);
            let error = result.unwrap_err();
            assert!(
                matches!(error, WriteError::NonFinite { first, count: 1 } if first == last + 1)
            );
            assert!(out.is_empty(), "{what}");
        }
        let beside = layout.properties.windows(3).any(|three| {
            let names = three.iter().map(|p| p.0.as_str());
            names.eq(AXES) && three.iter().all(|p| p.1 == three[0].1 && p.1 >= 6)
        });
        if beside {
            together += 1;
        } else {
            apart += 1;
        }
    }
    assert!(together > 100 && apart > 100, "{together} {apart}");
}

/// A binary file of `vertices` points and these faces, counted by the type `count` and of indices of the type `index`.
fn faced(
    encoding: usize,
    count: usize,
    index: usize,
    vertices: usize,
    faces: &[Vec<i64>],
) -> Vec<u8> {
    let format = ["", "little", "big"][encoding];
    let mut out = format!(
        "ply\nformat binary_{format}_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face {}\nproperty list {} {} vertex_indices\nend_header\n",
        faces.len(),
        TYPES[count].0,
        TYPES[index].0
    )
    .into_bytes();
    for i in 0..3 * vertices {
        put(&mut out, encoding, 6, i as f64);
    }
    for face in faces {
        put(&mut out, encoding, count, face.len() as f64);
        for &corner in face {
            put(&mut out, encoding, index, corner as f64);
        }
    }
    out
}

/// What reading gives: the faces, or the error without the place in the file.
fn outcome(file: &[u8]) -> Result<Vec<u32>, String> {
    let document = load(file).map_err(|error| {
        let text = error.to_string();
        match (text.find(" (at byte"), text.find(')')) {
            (Some(start), Some(end)) => format!("{}{}", &text[..start], &text[end..]),
            _ => text,
        }
    })?;
    let old = points(&*document);
    assert!(write(&*document, &old, Normals::Recompute).unwrap().0 == file);
    let geometry = document.geometry(&Moved::new(document.points())).unwrap();
    let faces = geometry.faces();
    Ok(faces
        .flat_map(|(_, face)| [&[face.len() as u32], face].concat())
        .collect())
}

#[test]
fn ply_faces_counted_by_bytes_are_read_as_all_others() {
    let mut random = Random(0x0123_4567_89ab_cdef);
    let (mut good, mut bad) = (0, 0);
    for round in 0..300 {
        let vertices = 3 + random.below(40);
        // Enough for several runs now and then; alike, mixed, or alike up to the last.
        let count = if round % 50 == 0 {
            40_000
        } else {
            1 + random.below(50)
        };
        let corners = 3 + random.below(4);
        let mixed = random.below(3);
        let mut faces: Vec<Vec<i64>> = (0..count)
            .map(|i| {
                let corners = match mixed {
                    0 => 3 + random.below(30),
                    1 if i + 1 == count => corners + 1,
                    _ => corners,
                };
                (0..corners)
                    .map(|_| random.below(vertices) as i64)
                    .collect()
            })
            .collect();
        if random.below(2) == 0 {
            let at = random.below(count);
            match random.below(5) {
                0 => faces[at][0] = -1,
                1 => faces[at][2] = vertices as i64,
                2 => faces[at].truncate(2),
                3 => faces[at].clear(),
                _ => faces[at][1] = i64::from(i32::MAX),
            }
        }
        for encoding in [1, 2] {
            // Counted by a short, faces take the general way.
            let general = outcome(&faced(encoding, 3, 4, vertices, &faces));
            let bytes = outcome(&faced(encoding, 1, 4, vertices, &faces));
            assert_eq!(bytes, general, "round {round}");
            if faces.iter().flatten().all(|corner| *corner >= 0) {
                let unsigned = outcome(&faced(encoding, 1, 5, vertices, &faces));
                assert_eq!(unsigned, general, "round {round}");
            }
            let sound = |face: &Vec<i64>| {
                face.len() >= 3 && face.iter().all(|c| (0..vertices as i64).contains(c))
            };
            assert_eq!(general.is_ok(), faces.iter().all(sound), "round {round}");
            if general.is_ok() {
                good += 1;
            } else {
                bad += 1;
            }
        }
        let file = faced(1, 1, 4, vertices, &faces);
        let cut = refusal(&file[..file.len() - 1 - random.below(4)]);
        assert!(
            matches!(cut.kind, ReadErrorKind::Truncated | ReadErrorKind::Element),
            "{cut}"
        );
    }
    assert!(good > 100 && bad > 100, "{good} {bad}");
}
