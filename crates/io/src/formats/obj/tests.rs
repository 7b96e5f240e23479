//! Laws of OBJ documents, on files drawn at random from a grammar and read in small chunks.

use super::{Obj, Text, read};
use crate::{Document, Format, Moved, Normals, Points, ReadErrorKind, ReadOptions, Recognition};
use anamorph_core::glam::DVec3;

/// Marsaglia's xorshift.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
    fn below(&mut self, n: usize) -> usize {
        (self.next() >> 11) as usize % n
    }
    fn one<'a>(&mut self, of: &[&'a str]) -> &'a str {
        of[self.below(of.len())]
    }
    fn finite(&mut self) -> f64 {
        loop {
            let value = f64::from_bits(self.next());
            if value.is_finite() {
                return value;
            }
        }
    }
    /// A number as files spell it.
    fn number(&mut self) -> String {
        let (whole, part) = (self.below(100), self.below(1_000_000));
        match self.below(8) {
            0 => format!("{whole}"),
            1 => format!("-{whole}.{part:06}"),
            2 => format!("+.{part}"),
            3 => format!("{whole}.e-{:03}", part % 20),
            4 => format!("{whole}.{part}E+0{}", part % 9),
            5 => format!("{:e}", self.finite()),
            6 => "-0".to_string(),
            _ => format!("{whole}.{part:06}"),
        }
    }
}

/// A random file and what it is known to say.
struct Sample {
    text: String,
    positions: Vec<DVec3>,
}

/// What a sample may contain.
#[derive(Clone, Copy)]
struct Grammar {
    /// Joined lines and comments behind statements, which simple readers do not know.
    odd: bool,
    /// All vertices on a circle in order, and faces running round it: every face is convex.
    convex: bool,
}

fn sample(random: &mut Random, grammar: Grammar) -> Sample {
    let mut text = String::new();
    let feed = random.one(&["\n", "\n", "\r\n"]);
    let mut positions = Vec::new();
    let (mut textures, mut normals) = (0, 0);
    for _ in 0..random.below(40) + 3 {
        let kind = if positions.len() < 3 {
            0
        } else {
            random.below(10)
        };
        let mut tokens: Vec<String> = Vec::new();
        match kind {
            0..=2 => {
                tokens.push("v".into());
                let spelled: [String; 3] = if grammar.convex {
                    let angle = positions.len() as f64 * 0.1;
                    [angle.cos(), angle.sin(), 0.5 * angle.sin()].map(|c| format!("{c}"))
                } else {
                    core::array::from_fn(|_| random.number())
                };
                positions.push(DVec3::from_array(
                    spelled.clone().map(|s| s.parse().unwrap()),
                ));
                tokens.extend(spelled);
                // tobj divides by a fourth number, and wants colours at all vertices or none.
                let extras = if grammar.convex {
                    0
                } else {
                    [0, 0, 1, 3][random.below(4)]
                };
                tokens.extend((0..extras).map(|_| random.number()));
            }
            3 => {
                tokens.push("vn".into());
                tokens.extend((0..3).map(|_| random.number()));
                normals += 1;
            }
            4 => {
                tokens.push("vt".into());
                tokens.extend((0..2).map(|_| random.number()));
                textures += 1;
            }
            5..=7 => {
                tokens.push("f".into());
                let most = positions.len();
                let corners: Vec<usize> = if grammar.convex {
                    let mut all: Vec<usize> = (0..most).collect();
                    while all.len() > 3 && random.below(3) > 0 {
                        all.remove(random.below(all.len()));
                    }
                    all
                } else {
                    (0..3 + random.below(4))
                        .map(|_| random.below(most))
                        .collect()
                };
                let shape = random.below(5);
                for corner in corners {
                    let mut written = |index: usize, total: usize| match random.below(3) {
                        0 => format!("-{}", total - index),
                        _ => format!("{}", index + 1),
                    };
                    let vertex = written(corner, most);
                    let texture = if textures > 0 {
                        written(corner % textures, textures)
                    } else {
                        String::new()
                    };
                    let normal = if normals > 0 {
                        written(corner % normals, normals)
                    } else {
                        String::new()
                    };
                    tokens.push(match shape {
                        1 => format!("{vertex}/{texture}"),
                        2 => format!("{vertex}//{normal}"),
                        3 => format!("{vertex}/{texture}/{normal}"),
                        _ => vertex,
                    });
                }
            }
            8 => {
                tokens.push(random.one(&["l", "p"]).into());
                tokens.extend(
                    (0..2 + random.below(3))
                        .map(|_| format!("{}", random.below(positions.len()) + 1)),
                );
            }
            _ => tokens.push(
                random
                    .one(&[
                        "g a f v 1 2 3",
                        "usemtl v",
                        "s off",
                        "# v 9 9 9",
                        "",
                        "o f 1 2 3",
                        "mtllib a\\b.mtl",
                        "vp 1 2",
                    ])
                    .into(),
            ),
        }
        let statement = matches!(tokens[0].as_str(), "v" | "vn" | "vt" | "f" | "l" | "p");
        if statement {
            text.push_str(random.one(&["", "", "", " ", "\t"]));
        }
        for (i, token) in tokens.iter().enumerate() {
            if i > 0 {
                match random.below(12) {
                    0 if grammar.odd => {
                        text.push_str(random.one(&[" \\", "\\", "\\ ", "\t\\\t"]));
                        text.push_str(feed);
                        text.push_str(random.one(&["", " "]));
                    }
                    1 => text.push_str("\t "),
                    _ => text.push(' '),
                }
            }
            text.push_str(token);
        }
        if statement {
            text.push_str(random.one(&["", "", " ", "\t"]));
            if grammar.odd && random.below(5) == 0 {
                text.push_str(random.one(&[" # note", " # ends in \\", "\t#"]));
            }
        }
        text.push_str(feed);
    }
    if random.below(4) == 0 {
        text.truncate(text.trim_end().len());
    }
    Sample { text, positions }
}

const ALL: Grammar = Grammar {
    odd: true,
    convex: false,
};
const PLAIN: Grammar = Grammar {
    odd: false,
    convex: false,
};

fn text_of(text: &str, random: &mut Random) -> Text {
    read(
        text.as_bytes().to_vec(),
        &ReadOptions::default(),
        1 + random.below(200),
    )
    .unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn written(text: &Text, points: &[DVec3], normals: Normals<'_>) -> String {
    let mut out = Vec::new();
    let report = text
        .write(
            &Moved::new(Points::Solid(points)).with_normals(normals),
            &mut out,
        )
        .unwrap();
    assert_eq!(report.bytes, out.len() as u64);
    String::from_utf8(out).unwrap()
}

fn bits(points: &[DVec3]) -> Vec<[u64; 3]> {
    points
        .iter()
        .map(|p| p.to_array().map(f64::to_bits))
        .collect()
}

/// Some points stay, some change in one coordinate, some in all.
fn moved(random: &mut Random, positions: &[DVec3]) -> Vec<DVec3> {
    let new = |random: &mut Random, p: &DVec3| match random.below(4) {
        0 => *p,
        1 => {
            let mut q = *p;
            q[random.below(3)] = random.finite();
            q
        }
        _ => DVec3::new(random.finite(), random.finite(), random.finite()),
    };
    positions.iter().map(|p| new(random, p)).collect()
}

#[test]
fn what_does_not_move_keeps_its_bytes() {
    let mut random = Random(1);
    for _ in 0..3000 {
        let sample = sample(&mut random, ALL);
        let text = text_of(&sample.text, &mut random);
        assert_eq!(
            bits(&text.positions),
            bits(&sample.positions),
            "{}",
            sample.text
        );
        let same = |_: usize, n: DVec3| n;
        for normals in [Normals::Keep, Normals::Recompute, Normals::Transform(&same)] {
            assert_eq!(written(&text, &sample.positions, normals), sample.text);
        }
    }
}

#[test]
fn what_moves_reads_back_exactly() {
    let mut random = Random(2);
    for _ in 0..3000 {
        let sample = sample(&mut random, ALL);
        let text = text_of(&sample.text, &mut random);
        let new = moved(&mut random, &sample.positions);
        let out = written(&text, &new, Normals::Keep);
        let back = text_of(&out, &mut random);
        assert_eq!(bits(&back.positions), bits(&new), "{}\n{out}", sample.text);
        assert_eq!(back.totals, text.totals);
        // Moved back, every number is spelled the shortest way; moved again, nothing changes any more.
        let home = written(&back, &sample.positions, Normals::Keep);
        let there = written(&text_of(&home, &mut random), &new, Normals::Keep);
        assert_eq!(there, out);
    }
}

#[test]
fn only_the_moved_numbers_change() {
    let mut random = Random(3);
    for _ in 0..2000 {
        let sample = sample(&mut random, PLAIN);
        let text = text_of(&sample.text, &mut random);
        let new = moved(&mut random, &sample.positions);
        let out = written(&text, &new, Normals::Keep);
        let (mut before, mut after) = (sample.text.split('\n'), out.split('\n'));
        let mut vertex = 0;
        while let (Some(a), Some(b)) = (before.next(), after.next()) {
            if a.trim_start().starts_with("v ") || a.trim_start().starts_with("v\t") {
                let (old, now) = (sample.positions[vertex].to_array(), new[vertex].to_array());
                vertex += 1;
                // Blanks, and each token with its place.
                let blanks = |s: &str| s.split(|c: char| !c.is_whitespace()).collect::<String>();
                assert_eq!(blanks(a), blanks(b));
                let (a, b): (Vec<&str>, Vec<&str>) = (
                    a.split_whitespace().collect(),
                    b.split_whitespace().collect(),
                );
                assert_eq!(a.len(), b.len());
                for i in 0..a.len() {
                    let moves = (1..4).contains(&i) && old[i - 1].to_bits() != now[i - 1].to_bits();
                    if moves {
                        assert_eq!(b[i].parse::<f64>().unwrap().to_bits(), now[i - 1].to_bits());
                    } else {
                        assert_eq!(a[i], b[i]);
                    }
                }
            } else {
                assert_eq!(a, b);
            }
        }
        assert!(before.next().is_none() && after.next().is_none());
    }
}

#[test]
fn chunks_do_not_show() {
    let mut random = Random(4);
    for _ in 0..500 {
        let sample = sample(&mut random, ALL);
        let options = ReadOptions::default();
        let whole = read(sample.text.clone().into_bytes(), &options, usize::MAX).unwrap();
        let parts = read(sample.text.clone().into_bytes(), &options, 1).unwrap();
        assert_eq!(whole.chunks.len(), 1);
        assert_eq!(whole.mesh(), parts.mesh());
        assert_eq!(whole.inspect(), parts.inspect());
        assert_eq!(whole.attributes(), parts.attributes());
        let new = moved(&mut random, &sample.positions);
        let field = |v: usize, n: DVec3| DVec3::new(n.y, (v % 3) as f64, -n.x);
        for normals in [Normals::Recompute, Normals::Transform(&field)] {
            assert_eq!(
                written(&whole, &new, normals),
                written(&parts, &new, normals)
            );
        }
    }
}

/// Corners of the faces as a plain reader sees them: vertex, and the normal's value.
fn plain_corners(text: &str) -> Vec<Vec<(usize, Option<DVec3>)>> {
    let lines: Vec<Vec<&str>> = text
        .lines()
        .map(|line| line.split_whitespace().collect())
        .collect();
    let of = |keyword: &str| lines.iter().filter(|l| l.first() == Some(&keyword)).count() as i64;
    let normals: Vec<DVec3> = lines
        .iter()
        .filter(|l| l.first() == Some(&"vn"))
        .map(|l| {
            DVec3::new(
                l[1].parse().unwrap(),
                l[2].parse().unwrap(),
                l[3].parse().unwrap(),
            )
        })
        .collect();
    let (vertices, normal_count) = (of("v"), of("vn"));
    let (mut seen_vertices, mut seen_normals) = (0, 0);
    let mut faces = Vec::new();
    for line in &lines {
        match line.first() {
            Some(&"v") => seen_vertices += 1,
            Some(&"vn") => seen_normals += 1,
            Some(&"f") => faces.push(
                line[1..]
                    .iter()
                    .map(|corner| {
                        let mut parts = corner.split('/');
                        let absolute = |part: Option<&str>, seen: i64, total: i64| {
                            let written: i64 = part.filter(|p| !p.is_empty())?.parse().unwrap();
                            let index = if written < 0 {
                                seen + written
                            } else {
                                written - 1
                            };
                            assert!((0..total).contains(&index));
                            Some(index as usize)
                        };
                        let vertex = absolute(parts.next(), seen_vertices, vertices).unwrap();
                        let normal = absolute(parts.nth(1), seen_normals, normal_count);
                        (vertex, normal.map(|n| normals[n]))
                    })
                    .collect(),
            ),
            _ => {}
        }
    }
    faces
}

#[test]
fn every_corner_gets_the_normal_of_its_vertex() {
    let mut random = Random(5);
    let mut added = 0;
    for round in 0..2000 {
        let sample = sample(&mut random, PLAIN);
        let text = text_of(&sample.text, &mut random);
        // Few classes of vertices, of which one keeps its normals and one has no usable new one.
        let field = move |v: usize, n: DVec3| match (v + round) % 4 {
            0 => n,
            1 => DVec3::new(n.z, 1.0, 0.5),
            2 => DVec3::new(0.25, f64::from((v % 3) as u32), n.x.signum()),
            _ => DVec3::splat(f64::NAN),
        };
        let out = written(&text, &sample.positions, Normals::Transform(&field));
        added += out.lines().count() - sample.text.lines().count();
        let (before, after) = (plain_corners(&sample.text), plain_corners(&out));
        assert_eq!(before.len(), after.len());
        for (old, new) in before.iter().flatten().zip(after.iter().flatten()) {
            assert_eq!(old.0, new.0);
            let expected = old
                .1
                .map(|n| Some(field(old.0, n)).filter(|m| m.is_finite()).unwrap_or(n));
            match (expected, new.1) {
                (Some(expected), Some(found)) => {
                    assert!(
                        (expected - found).abs().max_element()
                            <= 1e-12 * expected.abs().max_element(),
                        "{out}"
                    );
                }
                (expected, found) => assert_eq!(expected, found),
            }
        }
    }
    assert!(added > 1000, "the samples do not share normals: {added}");
}

#[test]
fn tobj_sees_the_same_moved_triangles() {
    let mut random = Random(6);
    let grammar = Grammar {
        odd: false,
        convex: true,
    };
    for _ in 0..1000 {
        let sample = sample(&mut random, grammar);
        let text = text_of(&sample.text, &mut random);
        // An affine map keeps faces convex, so that a fan is right and unique.
        let new: Vec<DVec3> = sample
            .positions
            .iter()
            .map(|p| DVec3::new(p.x * 2.0 + p.y, p.z - 0.3 * p.x, p.y + 7.0))
            .collect();
        let out = written(&text, &new, Normals::Keep);
        let options = tobj::LoadOptions {
            triangulate: true,
            ..Default::default()
        };
        // tobj takes a line element with three vertices for a triangle.
        let faces: Vec<&str> = out
            .lines()
            .filter(|line| !line.trim_start().starts_with(['l', 'p']))
            .collect();
        let (models, _) = tobj::load_obj_buf(&mut faces.join("\n").as_bytes(), &options, |_| {
            Ok(Default::default())
        })
        .unwrap();
        let theirs: Vec<DVec3> = models
            .iter()
            .flat_map(|m| {
                m.mesh
                    .indices
                    .iter()
                    .map(|i| DVec3::from_slice(&m.mesh.positions[3 * *i as usize..]))
            })
            .collect();
        let back = text_of(&out, &mut random);
        let triangles = back.mesh().map_or(Vec::new(), |mesh| mesh.triangles);
        let ours: Vec<DVec3> = triangles
            .iter()
            .flatten()
            .map(|v| new[*v as usize])
            .collect();
        assert_eq!(bits(&ours), bits(&theirs), "{out}");
    }
}

#[test]
fn damage_never_panics() {
    let mut random = Random(7);
    let mut refused = 0;
    for _ in 0..6000 {
        let mut bytes = sample(&mut random, ALL).text.into_bytes();
        for _ in 0..1 + random.below(4) {
            let at = random.below(bytes.len());
            match random.below(5) {
                0 => bytes.truncate(at + 1),
                1 => bytes[at] = random.next() as u8,
                2 => bytes[at] = *b"\\\n# /-.0e\r"[..].get(random.below(10)).unwrap(),
                3 => {
                    let part = bytes[at..(at + random.below(30)).min(bytes.len())].to_vec();
                    bytes.splice(at..at, part);
                }
                _ => {
                    bytes.drain(at..(at + random.below(10)).min(bytes.len() - 1).max(at));
                }
            }
        }
        let chunk = 1 + random.below(100);
        Obj.recognises(&bytes);
        refused += usize::from(read(bytes.clone(), &ReadOptions::default(), chunk).is_err());
        let Ok(text) = read(bytes.clone(), &ReadOptions::for_inspection(), chunk) else {
            continue;
        };
        text.inspect();
        text.mesh();
        let mut out = Vec::new();
        text.write(
            &Moved::new(text.points()).with_normals(Normals::Recompute),
            &mut out,
        )
        .unwrap();
        assert_eq!(out, bytes);
        let new = vec![DVec3::new(1.5, -2.0, 3.0); text.positions.len()];
        out.clear();
        let field = |v: usize, _: DVec3| DVec3::new(v as f64, 1.0, 0.0);
        text.write(
            &Moved::new(Points::Solid(&new)).with_normals(Normals::Transform(&field)),
            &mut out,
        )
        .unwrap();
        let back = read(out, &ReadOptions::for_inspection(), chunk).unwrap();
        for (i, p) in back.positions.iter().enumerate() {
            assert!(*p == new[i] || !text.positions[i].is_finite());
        }
    }
    assert!(refused > 500, "{refused}");
}

/// The error for a text, in strict reading.
fn refusal(text: &str) -> (ReadErrorKind, Option<u64>, String) {
    let error = Obj
        .read(text.as_bytes().to_vec(), &ReadOptions::default())
        .err()
        .unwrap_or_else(|| panic!("{text:?} passes"));
    assert!(!error.mend.is_empty());
    (error.kind, error.line, error.to_string())
}

#[test]
fn errors_say_what_and_where() {
    use ReadErrorKind::{Element, Encoding, NoPoints, NonFinite, Number, Shape};
    let three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (text, kind, line, words) in [
        ("", NoPoints, None, "empty"),
        ("# nothing\ng a\n", NoPoints, None, "no vertices"),
        ("v 1 2\n", Shape, Some(1), "vertex 1 has 2 coordinates"),
        ("v\n", Shape, Some(1), "vertex 1 has 0 coordinates"),
        (
            "\nv 1 x 2\n",
            Number,
            Some(2),
            "the y coordinate of vertex 1 is \"x\"",
        ),
        ("v 1,5 2 3\n", Number, Some(1), "decimal point"),
        ("v 0 0 0\nv 0 nan 0\n", NonFinite, Some(2), "vertex 2"),
        (
            "v 0 0 -1.#INF\n",
            NonFinite,
            Some(1),
            "the z coordinate of vertex 1",
        ),
        ("v 0 0 1e999\n", NonFinite, Some(1), "not finite"),
        (
            "v 0 0 0\rv 1 0 0\rf 1 1 1\r",
            Encoding,
            None,
            "carriage returns",
        ),
        ("v 0 \0 0\n", Encoding, None, "binary"),
        (
            "f -1 -2 -3\n",
            Element,
            Some(1),
            "only 0 vertices come before",
        ),
    ] {
        let error = refusal(text);
        assert_eq!((error.0, error.1), (kind, line), "{text:?}: {}", error.2);
        assert!(error.2.contains(words), "{text:?}: {}", error.2);
    }
    for (face, words) in [
        (
            "f 1 2 4",
            "column 7: face 1 refers to vertex \"4\", but the file has 3",
        ),
        ("f 1 2 4294967297", "4294967297"),
        ("f 1 2 99999999999999999999", "99999999999999999999"),
        ("f 1 2 -2147483649", "only 3 vertices come before"),
        ("f 1 2 -4", "refers back to vertex \"-4\""),
        ("f 1 2 0", "index 0"),
        ("f 1/1/0 2 3", "index 0 in \"1/1/0\""),
        ("f 1// 2//", "has 2 corners and needs at least 3"),
        ("f", "has 0 corners"),
        ("f 1 2 x", "\"x\", which is no reference"),
        ("f 1 2 3/1/1/1", "which is no reference"),
        ("l 1", "line element 1 has 1 corner and"),
        ("p 7", "point element 1 refers to vertex \"7\""),
    ] {
        let error = refusal(&format!("{three}{face}\n"));
        assert_eq!(
            (error.0, error.1),
            (Element, Some(4)),
            "{face}: {}",
            error.2
        );
        assert!(error.2.contains(words), "{face}: {}", error.2);
    }
    let wide: Vec<u8> = "v 0 0 0\n"
        .encode_utf16()
        .flat_map(u16::to_be_bytes)
        .collect();
    for bytes in [wide.clone(), [b"\xFE\xFF".to_vec(), wide].concat()] {
        let error = Obj.read(bytes, &ReadOptions::default()).err().unwrap();
        assert!(
            error.kind == Encoding && error.what.contains("UTF-16"),
            "{error}"
        );
    }
}

#[test]
fn recognition_by_content() {
    assert_eq!(
        Obj.recognises(b"# c\nmtllib x\nv 1 2 3"),
        Recognition::Certain
    );
    assert_eq!(Obj.recognises(b"v 1 2 3."), Recognition::Certain);
    assert_eq!(Obj.recognises(b"mtllib x\no y\n"), Recognition::Possible);
    for other in [
        &b"ply\nformat ascii 1.0\n"[..],
        b"solid x\n",
        b"x,y\n1,2\n",
        b"{\"a\": 1}",
        b"v x y z\n",
        b"version 1 2 3",
    ] {
        assert_eq!(Obj.recognises(other), Recognition::No);
    }
}
