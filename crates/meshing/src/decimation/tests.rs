//! Exact cases, the laws of every result, and hard meshes.

use super::*;
use crate::SurfaceTree;
use crate::testing::{Random, cone, cube, grid, grid_faces, rough, sphere};
use anamorph_core::glam::{DQuat, dvec3};
use anamorph_core::math;
use core::f64::consts::TAU;
use std::collections::BTreeMap;

/// What decimation must not change: Euler characteristic, pieces, loops of borders, whether it is a manifold wound one way.
#[derive(Debug, PartialEq, Eq)]
struct Shape {
    euler: isize,
    pieces: usize,
    loops: usize,
    non_manifold: usize,
    turned: usize,
    split: usize,
}

fn parts(count: usize, pairs: impl Iterator<Item = [usize; 2]>) -> usize {
    let mut parent: Vec<usize> = (0..count).collect();
    let mut parts = count;
    for pair in pairs {
        let [a, b] = pair.map(|mut v| {
            while parent[v] != v {
                parent[v] = parent[parent[v]];
                v = parent[v];
            }
            v
        });
        if a != b {
            parent[a] = b;
            parts -= 1;
        }
    }
    parts
}

fn shape(surface: &Surface) -> Shape {
    let topology = surface.topology();
    let vertices = topology.vertices();
    let inside = (0..vertices).filter(|&v| !topology.is_boundary_vertex(v));
    Shape {
        euler: vertices as isize - topology.edges() as isize + topology.faces() as isize,
        pieces: parts(vertices, (0..topology.edges()).map(|e| topology.ends(e))),
        loops: parts(
            vertices,
            topology.boundary_edges().map(|e| topology.ends(e)),
        ) - inside.count(),
        non_manifold: topology.non_manifold_edges().count(),
        turned: topology.turned_edges().count(),
        split: (0..vertices)
            .filter(|&v| topology.fans(v).count() != 1)
            .count(),
    }
}

/// Decimates, and checks the laws of every result.
fn decimated(surface: &Surface, count: usize) -> Decimation {
    let result = decimate(surface, count).expect("a coarse mesh");
    let topology = result.surface.topology();
    assert!(topology.degenerate().is_empty());
    assert!((0..topology.vertices()).all(|v| !topology.corners(v).is_empty()));
    let start = decimate(surface, usize::MAX).expect("the mesh itself");
    assert_eq!(start.hindered, None);
    let before = start.surface.topology().vertices();
    let left = topology.vertices();
    match result.hindered {
        None => assert_eq!(left, count.min(before)),
        Some(hindered) => {
            assert!(left > count && left <= before);
            let sum = hindered.topology + hindered.locked + hindered.turning;
            assert_eq!(sum, topology.edges());
        }
    }
    let (old, new) = (shape(&start.surface), shape(&result.surface));
    if start.locked == 0 {
        assert_eq!(
            new,
            Shape {
                turned: new.turned,
                ..old
            }
        );
        assert!(old.turned > 0 || new.turned == 0);
    } else {
        assert_eq!(
            (new.euler, new.pieces, new.loops),
            (old.euler, old.pieces, old.loops)
        );
        assert_eq!(new.non_manifold, old.non_manifold);
    }
    assert_eq!(decimate(surface, count).as_ref(), Ok(&result), "again");
    result
}

/// The greatest distance of the vertices of one surface from another.
fn farthest(from: &Surface, to: &Surface) -> f64 {
    let tree = SurfaceTree::new(to);
    let distances = from.positions().iter().map(|&p| tree.nearest(p));
    distances.fold(0.0, |most, n| most.max(n.expect("a place").distance))
}

fn area(surface: &Surface) -> f64 {
    let faces = 0..surface.topology().faces();
    faces.map(|f| surface.area_vector(f).length() / 2.0).sum()
}

fn volume(surface: &Surface) -> f64 {
    let faces = 0..surface.topology().faces();
    faces
        .map(|f| {
            let [a, b, c] = surface.corners(f);
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

fn map(surface: &Surface, f: impl Fn(DVec3) -> DVec3) -> Surface {
    let moved = surface.positions().iter().map(|&p| f(p)).collect();
    Surface::with_topology(surface.topology().clone(), moved).expect("a moved surface")
}

/// Every face cut into four, `levels` times, at the middles of its sides.
fn cut(surface: &Surface, levels: usize) -> Surface {
    let mut positions = surface.positions().to_vec();
    let mut faces: Vec<[usize; 3]> = (0..surface.topology().faces())
        .map(|f| surface.topology().triangle(f))
        .collect();
    for _ in 0..levels {
        let mut middles = BTreeMap::new();
        let mut next = Vec::new();
        for [a, b, c] in faces {
            let [p, q, r] = [(a, b), (b, c), (c, a)].map(|(i, j): (usize, usize)| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    positions.push((positions[i] + positions[j]) / 2.0);
                    positions.len() - 1
                })
            });
            next.extend([[a, p, r], [p, b, q], [r, q, c], [p, q, r]]);
        }
        faces = next;
    }
    Surface::new(positions, &faces).expect("a finer surface")
}

/// The outside of unit cells, each side of a cell cut in two.
fn cells(filled: impl Fn(i32, i32, i32) -> bool, size: i32) -> Surface {
    let mut numbers = BTreeMap::new();
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    let all = || -1..=size;
    for (x, y, z) in all().flat_map(|x| all().flat_map(move |y| all().map(move |z| (x, y, z)))) {
        if !filled(x, y, z) {
            continue;
        }
        for axis in 0..3 {
            for side in [0, 1] {
                let mut next = [x, y, z];
                next[axis] += 2 * side - 1;
                if filled(next[0], next[1], next[2]) {
                    continue;
                }
                let corner = |u: i32, v: i32| {
                    let mut at = [x, y, z];
                    at[axis] += side;
                    at[(axis + 1) % 3] += u;
                    at[(axis + 2) % 3] += v;
                    at
                };
                let mut round = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                if side == 0 {
                    round.reverse();
                }
                let [a, b, c, d] = round.map(|at| {
                    *numbers.entry(at).or_insert_with(|| {
                        positions.push(dvec3(at[0].into(), at[1].into(), at[2].into()));
                        positions.len() - 1
                    })
                });
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    Surface::new(positions, &faces).expect("cells")
}

fn torus(n: usize, m: usize, tube: f64) -> Surface {
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for i in 0..n {
        let (s, c) = math::sin_cos(TAU * i as f64 / n as f64);
        for j in 0..m {
            let (t, d) = math::sin_cos(TAU * j as f64 / m as f64);
            let r = 1.0 + tube * d;
            positions.push(dvec3(r * c, r * s, tube * t));
            let at = |i: usize, j: usize| (i % n) * m + j % m;
            let (p, q, r, s) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            faces.extend([[p, q, r], [p, r, s]]);
        }
    }
    Surface::new(positions, &faces).expect("a torus")
}

fn soup(surface: &Surface) -> Surface {
    let faces = 0..surface.topology().faces();
    let positions: Vec<DVec3> = faces.flat_map(|f| surface.corners(f)).collect();
    let faces: Vec<[usize; 3]> = (0..positions.len() / 3)
        .map(|f| [3 * f, 3 * f + 1, 3 * f + 2])
        .collect();
    Surface::new(positions, &faces).expect("a soup")
}

#[test]
fn a_flat_grid_becomes_its_corners() {
    let turn = DQuat::from_scaled_axis(dvec3(0.3, -1.1, 0.7));
    for (nx, ny) in [(1, 1), (5, 3), (24, 17)] {
        let flat = grid(nx, ny, |_, _| 0.0);
        let result = decimated(&flat, 4);
        let corners =
            [(0, 0), (nx, 0), (0, ny), (nx, ny)].map(|(x, y)| dvec3(x as f64, y as f64, 0.0));
        assert_eq!(result.surface.positions(), corners);
        assert_eq!(area(&result.surface), (nx * ny) as f64);
        // Turned, and far from the origin.
        let place = |p: DVec3| turn * p + dvec3(31.0, -57.0, 11.0);
        let tilted = map(&flat, place);
        for count in [4, 7, 12] {
            let result = decimated(&tilted, count);
            assert!(farthest(&result.surface, &tilted) < 1e-12);
            assert!((area(&result.surface) - (nx * ny) as f64).abs() < 1e-10);
            for corner in corners {
                let kept = result.surface.positions().contains(&place(corner));
                assert!(kept, "{nx} {ny} {count}");
            }
        }
    }
}

#[test]
fn a_cut_cube_becomes_its_corners() {
    let turn = DQuat::from_scaled_axis(dvec3(0.3, -1.1, 0.7));
    for levels in [1, 3, 5] {
        let fine = cut(&cube(), levels);
        let result = decimated(&fine, 8);
        assert_eq!(result.surface.positions(), cube().positions());
        assert!((volume(&result.surface) - 1.0).abs() < 1e-15);
        let tilted = map(&fine, |p| turn * p * 3.7 + dvec3(1.0, 2.0, 3.0));
        let result = decimated(&tilted, 8);
        for &corner in cube().positions() {
            let corner = turn * corner * 3.7 + dvec3(1.0, 2.0, 3.0);
            let apart = result
                .surface
                .positions()
                .iter()
                .map(|p| p.distance(corner));
            assert!(apart.fold(f64::INFINITY, f64::min) < 1e-13);
        }
    }
    // A cube cannot do with less than four vertices.
    let least = decimated(&cut(&cube(), 3), 1);
    assert!(least.surface.positions().len() <= 6, "{least:?}");
    assert!(least.surface.positions().len() >= 4);
}

#[test]
fn a_sphere_is_met_as_well_as_by_even_meshes() {
    let fine = sphere(6);
    let mut last = f64::INFINITY;
    for (levels, count) in [(0, 6), (1, 18), (2, 66), (3, 258)] {
        let result = decimated(&fine, count);
        assert_eq!(result.hindered, None);
        let error = farthest(&fine, &result.surface);
        let even = farthest(&fine, &sphere(levels));
        assert!(
            error < even || (count == 6 && error < 1.2 * even),
            "{count}: {error} and {even}"
        );
        assert!(error < 0.5 * last);
        // The planes of faces pull outwards: inside and outside errors are alike.
        assert!(farthest(&result.surface, &fine) < error * 1.5);
        let edges = 0..result.surface.topology().edges();
        let lengths: Vec<f64> = edges.map(|e| result.surface.edge_length(e)).collect();
        let least = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let most = lengths.iter().copied().fold(0.0, f64::max);
        assert!(most < 4.0 * least, "{count}: edges from {least} to {most}");
        last = error;
    }
}

#[test]
fn holes_handles_and_pieces_stay() {
    let ring = decimated(&torus(40, 20, 0.4), 60);
    assert_eq!(shape(&ring.surface).euler, 0);
    // Whatever is asked for, a torus keeps seven vertices and more.
    let least = decimated(&torus(40, 20, 0.4), 4);
    assert!(least.surface.positions().len() >= 7);
    assert!(
        least.surface.positions().len() <= 12,
        "{:?}",
        least.hindered
    );
    assert!(least.hindered.expect("a reason").topology > 0);

    // A plate with two holes through it, cells of a third of its holes.
    let plate = |x: i32, y: i32, z: i32| {
        let hole = (3..6).contains(&y) && ((3..6).contains(&x) || (9..12).contains(&x));
        (0..15).contains(&x) && (0..9).contains(&y) && (0..3).contains(&z) && !hole
    };
    let plate = cells(plate, 15);
    assert_eq!(shape(&plate).euler, -2);
    let coarse = decimated(&plate, 24);
    assert_eq!(coarse.surface.positions().len(), 24);
    // Eight outer corners and eight at each hole, all exact.
    assert!(farthest(&plate, &coarse.surface) < 1e-12);
    assert!((volume(&coarse.surface) - (15.0 * 9.0 - 18.0) * 3.0).abs() < 1e-9);

    // Two spheres, one in the other, and a grid beside.
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for (part, size, at) in [
        (sphere(3), 1.0, DVec3::ZERO),
        (sphere(2), 0.5, DVec3::ZERO),
        (grid(9, 9, |_, _| 0.0), 0.1, DVec3::X * 3.0),
    ] {
        let first = positions.len();
        positions.extend(part.positions().iter().map(|&p| p * size + at));
        let topology = part.topology();
        faces.extend((0..topology.faces()).map(|f| topology.triangle(f).map(|v| v + first)));
    }
    let pieces = Surface::new(positions, &faces).expect("three pieces");
    assert_eq!(shape(&decimated(&pieces, 60).surface).pieces, 3);
    let least = decimated(&pieces, 4);
    assert!(
        (11..=16).contains(&least.surface.positions().len()),
        "{least:?}"
    );
}

#[test]
fn borders_stay_where_they_are() {
    // A grid with a hole in it, and heights.
    let n = 30;
    let height = |x: f64, y: f64| 1.5 * math::sin_cos(x / 5.0).0 * math::sin_cos(y / 7.0).1;
    let whole = grid(n, n, height);
    let faces: Vec<[usize; 3]> = grid_faces(n, n)
        .into_iter()
        .filter(|t| {
            t.iter().any(|&v| {
                let (x, y) = (v % (n + 1), v / (n + 1));
                !(10..=20).contains(&x) || !(8..=22).contains(&y)
            })
        })
        .collect();
    let holed = Surface::new(whole.positions().to_vec(), &faces).expect("a grid with a hole");
    let result = decimated(&holed, 60);
    assert_eq!(result.loose, 9 * 13);
    let shape = shape(&result.surface);
    assert_eq!((shape.euler, shape.loops), (0, 2));
    assert!(farthest(&result.surface, &holed) < 0.4);
    // All four corners of the hole and of the outline are kept: the borders are straight seen from above.
    for (x, y) in [
        (0, 0),
        (n, 0),
        (0, n),
        (n, n),
        (10, 8),
        (20, 8),
        (10, 22),
        (20, 22),
    ] {
        let near = result
            .surface
            .positions()
            .iter()
            .map(|p| dvec3(p.x - x as f64, p.y - y as f64, 0.0).length());
        assert!(near.fold(f64::INFINITY, f64::min) < 0.05, "{x} {y}");
    }
}

#[test]
fn random_bumpy_spheres_keep_every_law() {
    let mut random = Random::new(21);
    for round in 0..24 {
        let bumps: Vec<(DVec3, f64)> = (0..6)
            .map(|_| (random.vector() * 4.0, random.between(0.0, 0.12)))
            .collect();
        let bumpy = map(&sphere(4), |p| {
            let sum: f64 = bumps
                .iter()
                .map(|&(way, size)| size * math::sin_cos(way.dot(p)).0)
                .sum();
            p * (1.0 + sum) * dvec3(1.0, 1.0, 1.0 + round as f64 * 0.1)
        });
        let count = 4 + random.below(200);
        let result = decimated(&bumpy, count);
        assert_eq!(shape(&result.surface).euler, 2);
        if count >= 40 {
            assert_eq!(result.hindered, None);
            let size = 2.0 + round as f64 * 0.2;
            let error = farthest(&bumpy, &result.surface);
            assert!(error < 4.0 * size / count as f64, "{count}: {error}");
            let volumes = [&bumpy, &result.surface].map(volume);
            assert!(
                (volumes[1] / volumes[0] - 1.0).abs() < 8.0 / count as f64,
                "{volumes:?}"
            );
        }
        // Sizes do not matter, to the last bit.
        for exponent in [-200, -3, 100] {
            let factor = 2.0_f64.powi(exponent);
            let other = decimate(&map(&bumpy, |p| p * factor), count).expect("another size");
            assert_eq!(map(&result.surface, |p| p * factor), other.surface);
        }
    }
}

#[test]
fn rough_grids_and_random_soups_keep_their_topology() {
    let mut random = Random::new(22);
    for round in 0..30 {
        let size = 3 + round % 12;
        let count = 3 + random.below(size * size);
        decimated(&rough(size, size, &mut random), count);
    }
    // Anything: three and more faces at edges, faces twice, collinear ones.
    for round in 0..200 {
        let vertices = 4 + round % 14;
        let positions: Vec<DVec3> = (0..vertices)
            .map(|_| (random.vector() * 2.0).round())
            .collect();
        let faces: Vec<[usize; 3]> = (0..1 + round % 60)
            .map(|_| [(); 3].map(|()| random.below(vertices)))
            .collect();
        let Ok(surface) = Surface::new(positions, &faces) else {
            continue;
        };
        match decimate(&surface, usize::MAX) {
            Ok(_) => {
                decimated(&surface, 1 + round % vertices);
            }
            Err(error) => assert!(matches!(error, SurfaceError::Topology(_)), "{error}"),
        }
    }
}

#[test]
fn seams_are_joined() {
    let whole = sphere(3);
    let loose = soup(&whole);
    let result = decimated(&loose, 40);
    assert_eq!(
        result.joined,
        loose.positions().len() - whole.positions().len()
    );
    assert_eq!(shape(&result.surface).euler, 2);
    assert_eq!(result.surface.positions().len(), 40);
    // Both sides of a sheet are one, and zero has no sign.
    let sheet = grid(6, 6, |_, _| 0.0);
    let mut positions = sheet.positions().to_vec();
    positions.extend(sheet.positions().iter().map(|&p| p * dvec3(1.0, 1.0, -1.0)));
    let mut faces = grid_faces(6, 6);
    faces.extend(
        grid_faces(6, 6)
            .into_iter()
            .map(|[a, b, c]| [a + 49, c + 49, b + 49]),
    );
    let double = Surface::new(positions, &faces).expect("a sheet with two sides");
    let result = decimated(&double, 4);
    assert_eq!((result.joined, result.left_out, result.locked), (49, 72, 0));
    assert_eq!(area(&result.surface), 36.0);
}

#[test]
fn what_is_no_manifold_stays() {
    // Three sheets that meet in a line.
    let n = 8;
    let sheet = grid(n, n, |_, _| 0.0);
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for k in 0..3 {
        let (s, c) = math::sin_cos(TAU * k as f64 / 3.0);
        let first = positions.len();
        positions.extend(
            sheet
                .positions()
                .iter()
                .map(|p| dvec3(p.x, p.y * c, p.y * s)),
        );
        faces.extend(grid_faces(n, n).into_iter().map(|t| t.map(|v| v + first)));
    }
    let book = Surface::new(positions, &faces).expect("a book");
    let result = decimated(&book, n + 1 + 6);
    assert_eq!((result.joined, result.locked), (2 * (n + 1), n + 1));
    assert_eq!(
        (result.surface.positions().len(), result.hindered),
        (n + 7, None)
    );
    for x in 0..=n {
        let spine = dvec3(x as f64, 0.0, 0.0);
        assert!(result.surface.positions().contains(&spine));
    }
    assert!((area(&result.surface) - 3.0 * 64.0).abs() < 1e-9);
    let least = decimated(&book, 4);
    assert!(least.surface.positions().len() > n + 1);
    assert!(least.hindered.expect("a reason").locked >= n);

    // Two cubes that touch in a corner.
    let one = cut(&cube(), 2);
    let mut positions = one.positions().to_vec();
    let first = positions.len();
    positions.extend(one.positions().iter().map(|&p| p + DVec3::ONE));
    let mut faces = Vec::new();
    for f in 0..one.topology().faces() {
        let t = one.topology().triangle(f);
        faces.extend([t, t.map(|v| v + first)]);
    }
    let touching = Surface::new(positions, &faces).expect("two cubes");
    let result = decimated(&touching, 15);
    assert_eq!((result.locked, result.surface.positions().len()), (1, 15));
    assert!((volume(&result.surface) - 2.0).abs() < 1e-12);
}

#[test]
fn strips_with_a_half_twist_and_faces_wound_anyhow() {
    let n = 60;
    let mut positions = Vec::new();
    for i in 0..n {
        let (s, c) = math::sin_cos(TAU * i as f64 / n as f64);
        let (t, d) = math::sin_cos(TAU * i as f64 / n as f64 / 2.0);
        for j in 0..7 {
            let w = (j as f64 - 3.0) / 9.0;
            positions.push(dvec3((1.0 + w * d) * c, (1.0 + w * d) * s, w * t));
        }
    }
    let mut faces = Vec::new();
    for i in 0..n {
        for j in 0..6 {
            let at = |i: usize, j: usize| if i == n { 6 - j } else { 7 * i + j };
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    let strip = Surface::new(positions, &faces).expect("a Möbius strip");
    let coarse = decimated(&strip, 30);
    assert_eq!(
        (shape(&coarse.surface).euler, shape(&coarse.surface).loops),
        (0, 1)
    );
    let off = farthest(&strip, &coarse.surface);
    assert!(off < 0.07, "{off}");

    let mut random = Random::new(23);
    let whole = sphere(3);
    let faces: Vec<[usize; 3]> = (0..whole.topology().faces())
        .map(|f| {
            let [a, b, c] = whole.topology().triangle(f);
            if random.below(2) == 0 {
                [a, b, c]
            } else {
                [b, a, c]
            }
        })
        .collect();
    let wound = Surface::new(whole.positions().to_vec(), &faces).expect("a sphere wound anyhow");
    assert_eq!(decimated(&wound, 30).surface.positions().len(), 30);
}

#[test]
fn faces_without_area_are_no_obstacle() {
    // Every square of a grid has its diagonal cut by a vertex that only a needle without area uses.
    let n = 8;
    let flat = grid(n, n, |_, _| 0.0);
    let mut positions = flat.positions().to_vec();
    let mut faces = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
            let middle = positions.len();
            positions.push((positions[a] + positions[c]) / 2.0);
            faces.extend([[a, b, c], [a, c, middle], [a, middle, d], [middle, c, d]]);
        }
    }
    let needles = Surface::new(positions, &faces).expect("a grid with needles");
    let result = decimated(&needles, 4);
    assert_eq!(area(&result.surface), (n * n) as f64);
    assert_eq!(result.hindered, None);

    let nothing = Surface::new(vec![DVec3::ONE; 3], &[[0, 1, 2]]).expect("a face in a point");
    let error = decimate(&nothing, 4).expect_err("nothing is left");
    assert_eq!(
        error,
        SurfaceError::Topology(TopologyError::AllDegenerate { faces: 1 })
    );
    let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
    let line = Surface::new(line.to_vec(), &[[0, 1, 2]]).expect("a face along a line");
    assert_eq!(decimated(&line, 4).surface, line);
}

#[test]
fn vertices_of_many_faces_do_not_take_the_square_of_their_number() {
    let start = std::time::Instant::now();
    let n = 20_000;
    let result = decimated(&cone(n, 1.0), 100);
    assert_eq!(result.hindered, None);
    assert!(result.surface.positions().contains(&DVec3::Z), "the tip");
    assert!(farthest(&result.surface, &cone(n, 1.0)) < 0.01);
    // A lens: two tips over one ring.
    let one = cone(n, 1.0);
    let mut positions = one.positions().to_vec();
    positions.push(-DVec3::Z);
    let faces: Vec<[usize; 3]> = (0..n)
        .flat_map(|k| [[k, (k + 1) % n, n], [(k + 1) % n, k, n + 1]])
        .collect();
    let lens = Surface::new(positions, &faces).expect("a lens");
    assert_eq!(decimated(&lens, 100).surface.positions().len(), 100);
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}

#[test]
fn hard_sizes() {
    // Far from the origin, beyond squares of numbers, and next to nothing.
    let far = map(&sphere(4), |p| p + dvec3(1e6, -1e6, 1e6));
    let result = decimated(&far, 50);
    assert!(farthest(&far, &result.surface) < 0.2);
    for size in [1e-300, 1e-74, 1e70] {
        let result = decimated(&map(&sphere(3), |p| p * size), 30);
        assert_eq!(result.surface.positions().len(), 30);
        let most = result
            .surface
            .positions()
            .iter()
            .map(|p| p.abs().max_element());
        assert!(most.fold(0.0, f64::max) < 1.3 * size);
    }
    // Beams. Very long ones are cut along before their sides are told apart, for edges are to be even.
    for (length, exact) in [(10.0, true), (1e6, false)] {
        let needle = map(&cut(&cube(), 4), |p| p * dvec3(length, 1.0, 1.0));
        let result = decimated(&needle, 8);
        assert_eq!(result.hindered, None);
        let off = (volume(&result.surface) / length - 1.0).abs();
        assert!(off < if exact { 1e-12 } else { 1.0 }, "{length}: {off}");
    }
}
