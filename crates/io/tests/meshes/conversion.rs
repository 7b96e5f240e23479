//! Models of one format written in another.

use super::*;

/// Faces of a geometry as lists of points.
fn faces(document: &dyn Document) -> Vec<Vec<u32>> {
    let geometry = document.geometry(&Moved::new(document.points())).unwrap();
    geometry.faces().map(|(_, face)| face.to_vec()).collect()
}

const HOUSE: &str = "o house\ng walls\nusemtl red\nv 0 0 0 1 0 0\nv 1 0 0.1 0 1 0\nv 1 1 0.3333333333333333 0 0 1\nv 0 1 0 1 1 1\nv .5 1.5 1e-3 0 0 0\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nvn 0 1 0\nf 1/1/1 2/2/1 3/3/1 4/4/1\ng roof\nf 4/1/2 3/2/2 5/3/2\nl 1 5\n";

#[test]
fn conversion_keeps_what_both_hold_and_names_the_rest() {
    let house = document(HOUSE.as_bytes());
    let (ply, lost) = create(&*house, "ply");
    assert_eq!(
        lost,
        [
            "2 groups",
            "1 material",
            "normals (points have several, PLY holds one for each)"
        ]
    );
    let from_ply = document(&ply);
    assert_eq!(from_ply.format(), "ply");
    assert_eq!(points(&*from_ply), points(&*house));
    assert_eq!(faces(&*from_ply), faces(&*house));
    assert_eq!(from_ply.mesh().unwrap().lines, [[0, 4]]);
    for channel in ["red", "green", "blue"] {
        assert_eq!(from_ply.attribute(channel), house.attribute(channel));
    }
    let (obj, lost) = create(&*from_ply, "obj");
    assert!(lost.is_empty(), "{lost:?}");
    let back = document(&obj);
    assert_eq!(points(&*back), points(&*house));
    assert_eq!(faces(&*back), faces(&*house));
    // Texture coordinates came through, though points have several.
    let texture = |d: &dyn Document| {
        let g = d.geometry(&Moved::new(d.points())).unwrap();
        let index =
            |(c, &p): (usize, &u32)| g.textures.pool()[g.textures.index(c, p).unwrap() as usize];
        g.corners
            .iter()
            .enumerate()
            .map(index)
            .collect::<Vec<DVec2>>()
    };
    assert_eq!(texture(&*back), texture(&*house));

    let (off, lost) = create(&*house, "off");
    assert_eq!(lost.len(), 4, "{lost:?}");
    let from_off = document(&off);
    assert_eq!(
        (points(&*from_off), faces(&*from_off)),
        (points(&*house), faces(&*house))
    );
    assert_eq!(from_off.attribute("green"), house.attribute("green"));

    let (stl, lost) = create(&*house, "stl");
    for what in [
        "polygons", "colours", "texture", "lines", "digits", "2 groups",
    ] {
        assert!(lost.iter().any(|l| l.contains(what)), "{what} {lost:?}");
    }
    let from_stl = document(&stl);
    assert_eq!(
        (from_stl.points().len(), from_stl.mesh().unwrap().faces),
        (5, 3)
    );

    let (csv, lost) = create(&*house, "csv");
    assert!(lost.contains(&"faces".to_owned()));
    let from_csv = document(&csv);
    assert_eq!(points(&*from_csv), points(&*house));
    assert_eq!(from_csv.attribute("blue"), house.attribute("blue"));
    let (ply, lost) = create(&*from_csv, "ply");
    assert!(lost.is_empty(), "{lost:?}");
    assert_eq!(points(&*document_of(&ply)), points(&*house));
}

fn document_of(bytes: &[u8]) -> Box<dyn Document> {
    document(bytes)
}

#[test]
fn conversion_carries_normals_along() {
    let square = document(SQUARE.as_bytes());
    let turned: Vec<DVec3> = points(&*square)
        .iter()
        .map(|p| DVec3::new(p.z, p.x, p.y))
        .collect();
    let turn = |_: usize, n: DVec3| DVec3::new(n.z, n.x, n.y);
    let moved = Moved::new(Points::Solid(&turned)).with_normals(Normals::Transform(&turn));
    let geometry = square.geometry(&moved).unwrap();
    for format in ["obj", "off", "ply"] {
        let target = targets().iter().find(|t| t.name == format).unwrap();
        let mut out = Vec::new();
        assert!(target.create(&geometry, &mut out).unwrap().is_empty());
        let back = document(&out);
        assert_eq!((points(&*back), back.normals()), (turned.clone(), 4));
        let again = back.geometry(&Moved::new(back.points())).unwrap();
        assert_eq!(again.normals.pool(), [DVec3::X; 4]);
    }
}

/// The fixtures of these formats in a folder.
fn fixtures(folder: &str) -> Vec<(String, Vec<u8>)> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/fixtures")
        .join(folder);
    let mut all: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| {
            path.extension()
                .is_some_and(|e| e == "ply" || e == "stl" || e == "off")
        })
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, std::fs::read(path).unwrap())
        })
        .collect();
    all.sort();
    all
}

#[test]
fn fixtures_keep_their_bytes_and_survive_conversion() {
    let valid = fixtures("valid");
    assert_eq!(valid.len(), 5);
    for (name, bytes) in valid {
        let document = document(&bytes);
        assert!(name.ends_with(document.format()), "{name}");
        let old = points(&*document);
        let (out, _) = write(&*document, &old, Normals::Recompute).unwrap();
        assert!(out == bytes, "{name}");
        assert!(document.inspect().problems.is_empty(), "{name}");
        // A point that does not move keeps its bytes, whatever the others do.
        let mut new = old.clone();
        new[0] += DVec3::new(0.5, 0.25, 0.125);
        let (out, report) = write(&*document, &new, Normals::Keep).unwrap();
        assert_eq!(report.moved_points, 1, "{name}");
        assert_eq!(points(&*load(&out).unwrap()), new, "{name}");
        let (out, _) = write(&*load(&out).unwrap(), &old, Normals::Keep).unwrap();
        assert_eq!(points(&*load(&out).unwrap()), old, "{name}");
        for format in ["ply", "obj", "off"] {
            let (out, _) = create(&*document, format);
            let back = self::document(&out);
            assert_eq!(points(&*back), old, "{name} as {format}");
            assert_eq!(faces(&*back), faces(&*document), "{name} as {format}");
            assert_eq!(back.attribute("red"), document.attribute("red"));
        }
    }
}

#[test]
fn damaged_fixtures_are_refused() {
    let damaged = fixtures("damaged");
    assert_eq!(damaged.len(), 4);
    for (name, bytes) in damaged {
        let result = read(bytes, Some(&name), &ReadOptions::default());
        let Err(error) = result else {
            panic!("{name} is accepted");
        };
        assert!(!error.what.is_empty() && !error.mend.is_empty());
    }
}
