//! Tests of all paths together: meshes of any kind, and meshes moved, turned over and scaled.

use anamorph_core::glam::{DVec3, dvec3};

use super::{EdgeEnd, PathError, Upright, downhill, edge_path, section, straightest};
use crate::testing::{Random, assert_lawful, rough};
use crate::{Surface, SurfacePoint};

/// Faces between few points of a small lattice, so that vertices coincide, faces have no area, lie in each other, share
/// edges by threes and planes go exactly through vertices.
fn lattice_soup(random: &mut Random, faces: usize) -> Option<Surface> {
    let positions: Vec<DVec3> = (0..14)
        .map(|_| [(); 3].map(|()| random.below(4) as f64 - 1.0).into())
        .collect();
    let faces: Vec<[usize; 3]> = (0..faces)
        .map(|_| [(); 3].map(|()| random.below(14)))
        .collect();
    Surface::new(positions, &faces).ok()
}

fn place(random: &mut Random, surface: &Surface) -> Option<SurfacePoint> {
    let place = match random.place(surface) {
        SurfacePoint::Edge { edge, .. } if random.below(2) == 0 => SurfacePoint::Edge {
            edge,
            fraction: 0.5,
        },
        other => other,
    };
    surface.simplest(place).ok()
}

#[test]
fn nothing_is_too_odd_for_a_path() {
    let mut random = Random::new(20);
    let (mut asked, mut reached) = (0, 0);
    for round in 0..1500 {
        let Some(surface) = lattice_soup(&mut random, 1 + round % 40) else {
            continue;
        };
        for _ in 0..6 {
            let (Some(from), Some(to)) =
                (place(&mut random, &surface), place(&mut random, &surface))
            else {
                continue;
            };
            let direction = if random.below(2) == 0 {
                random.vector()
            } else {
                DVec3::AXES[random.below(3)]
            };
            asked += 1;
            let edges = edge_path(&surface, from, to).expect("two places");
            assert_lawful(&surface, &edges);
            reached += usize::from(edges.ending == EdgeEnd::Reached);
            for upright in [Upright::Normals, Upright::Along(direction)] {
                match section(&surface, from, to, upright) {
                    Ok(path) => assert_lawful(&surface, &path),
                    Err(error) => assert!(matches!(
                        error,
                        PathError::SamePlace | PathError::UprightAlongChord
                    )),
                }
            }
            match straightest(&surface, from, direction, 7.0) {
                Ok(path) => {
                    assert_lawful(&surface, &path);
                    assert!((path.length + path.ending.remaining - 7.0).abs() < 1e-10);
                }
                Err(error) => assert!(matches!(
                    error,
                    PathError::NoTangent | PathError::Perpendicular
                )),
            }
            match downhill(&surface, from, direction, f64::INFINITY) {
                Ok(path) => {
                    assert_lawful(&surface, &path);
                    for pair in path.positions.windows(2) {
                        assert!((pair[0] - pair[1]).dot(direction) > -1e-14);
                    }
                }
                Err(error) => assert_eq!(error, PathError::NoTangent),
            }
        }
    }
    assert!(asked > 5000 && reached > 2000, "{asked} {reached}");
}

/// Scaling by a power of two loses no bit, and so no path may change, whatever the units.
#[test]
fn units_do_not_matter() {
    let mut random = Random::new(21);
    let mesh = rough(8, 8, &mut random);
    for power in [-200, -40, 13, 200] {
        let scale = 2.0_f64.powi(power);
        let positions = mesh.positions().iter().map(|&p| p * scale).collect();
        let scaled = Surface::with_topology(mesh.topology().clone(), positions).expect("a mesh");
        for _ in 0..60 {
            let (a, b) = (random.place(&mesh), random.place(&mesh));
            let direction = random.vector();
            let same = |x: &[SurfacePoint], y: &[SurfacePoint]| assert_eq!(x, y, "2^{power}");
            let section_of = |m| section(m, a, b, Upright::Normals).map(|p| p.points).ok();
            assert_eq!(section_of(&mesh), section_of(&scaled));
            let edges_of = |m| edge_path(m, a, b).expect("a path").points;
            same(&edges_of(&mesh), &edges_of(&scaled));
            let walk = straightest(&mesh, a, direction, 5.0).map(|p| p.points);
            let scaled_walk = straightest(&scaled, a, direction, 5.0 * scale).map(|p| p.points);
            assert_eq!(walk, scaled_walk);
            let down = downhill(&mesh, a, direction, 5.0).map(|p| p.points);
            let scaled_down = downhill(&scaled, a, direction, 5.0 * scale).map(|p| p.points);
            assert_eq!(down, scaled_down);
        }
    }
}

/// Which way faces are wound does not matter to walks, nor the order of their corners.
#[test]
fn windings_do_not_matter() {
    let mut random = Random::new(22);
    let mesh = rough(8, 8, &mut random);
    let faces: Vec<[usize; 3]> = (0..mesh.topology().faces())
        .map(|f| {
            let [a, b, c] = mesh.topology().triangle(f);
            [[a, b, c], [b, c, a], [a, c, b], [c, b, a]][f % 4]
        })
        .collect();
    let turned = Surface::new(mesh.positions().to_vec(), &faces).expect("a mesh");
    assert!(turned.topology().turned_edges().count() > 20);
    for _ in 0..200 {
        let edge = random.below(mesh.topology().edges());
        let start = SurfacePoint::Edge {
            edge,
            fraction: random.between(0.1, 0.9),
        };
        let direction = random.vector();
        let ends = [&mesh, &turned].map(|m| {
            let walk = straightest(m, start, direction, 4.0).expect("a walk");
            let down = downhill(m, start, DVec3::Z, f64::INFINITY).expect("a walk");
            let up = Upright::Along(dvec3(0.1, 0.0, 1.0));
            let cut = section(m, start, SurfacePoint::Vertex(40), up).expect("a plane");
            let last = |p: &[DVec3]| p[p.len() - 1];
            (
                last(&walk.positions),
                last(&down.positions),
                last(&cut.positions),
                cut.length,
            )
        });
        assert!(ends[0].0.distance(ends[1].0) < 1e-9);
        assert!(ends[0].1.distance(ends[1].1) < 1e-9);
        assert!(ends[0].2.distance(ends[1].2) < 1e-9);
        assert!((ends[0].3 - ends[1].3).abs() < 1e-9);
    }
}
