//! What is seen moving: an arrow for an object, a little camera for a camera.

use anamorph_core::glam::{DVec3, dvec3};
use anamorph_recipe::Subject;

/// Adds the triangles of a flat polygon.
fn fan(corners: &[DVec3], out: &mut Vec<[DVec3; 3]>) {
    for pair in corners[1..].windows(2) {
        out.push([corners[0], pair[0], pair[1]]);
    }
}

/// Adds a box between two corners.
fn cuboid(low: DVec3, high: DVec3, out: &mut Vec<[DVec3; 3]>) {
    let at = |x: bool, y: bool, z: bool| {
        let pick = |side: bool, low: f64, high: f64| if side { high } else { low };
        dvec3(
            pick(x, low.x, high.x),
            pick(y, low.y, high.y),
            pick(z, low.z, high.z),
        )
    };
    let (o, i) = (false, true);
    for corners in [
        [at(o, o, o), at(o, i, o), at(i, i, o), at(i, o, o)],
        [at(o, o, i), at(i, o, i), at(i, i, i), at(o, i, i)],
        [at(o, o, o), at(i, o, o), at(i, o, i), at(o, o, i)],
        [at(o, i, o), at(o, i, i), at(i, i, i), at(i, i, o)],
        [at(o, o, o), at(o, o, i), at(o, i, i), at(o, i, o)],
        [at(i, o, o), at(i, i, o), at(i, i, i), at(i, o, i)],
    ] {
        fan(&corners, out);
    }
}

/// An arrow that faces `+z`, with a fin up, about one unit long.
fn arrow() -> Vec<[DVec3; 3]> {
    let tip = dvec3(0.0, 0.0, 0.6);
    let tail = dvec3(0.0, 0.0, -0.25);
    let (left, right) = (dvec3(0.32, 0.0, -0.4), dvec3(-0.32, 0.0, -0.4));
    let (top, bottom) = (dvec3(0.0, 0.16, -0.28), dvec3(0.0, -0.06, -0.28));
    let mut out = vec![
        [tip, left, top],
        [tip, top, right],
        [tip, bottom, left],
        [tip, right, bottom],
        [top, left, tail],
        [tail, right, top],
        [left, bottom, tail],
        [tail, bottom, right],
    ];
    // The fin shows which way is up.
    let fin = [
        dvec3(0.0, 0.12, -0.05),
        dvec3(0.0, 0.42, -0.4),
        dvec3(0.0, 0.14, -0.3),
    ];
    for side in [0.025, -0.025] {
        let shifted = fin.map(|p| p + dvec3(side, 0.0, 0.0));
        out.push(if side > 0.0 {
            [shifted[0], shifted[2], shifted[1]]
        } else {
            shifted
        });
    }
    out
}

/// A camera that looks along `−z`: everything lies behind its eye, so that it does not see itself.
fn camera() -> Vec<[DVec3; 3]> {
    let mut out = Vec::new();
    cuboid(dvec3(-0.22, -0.18, 0.3), dvec3(0.22, 0.18, 0.85), &mut out);
    // The hood opens towards what is seen.
    let ring = |half: f64, z: f64| {
        [
            dvec3(-half, -half, z),
            dvec3(half, -half, z),
            dvec3(half, half, z),
            dvec3(-half, half, z),
        ]
    };
    let (near, far) = (ring(0.1, 0.3), ring(0.24, 0.02));
    for i in 0..4 {
        let next = (i + 1) % 4;
        fan(&[near[i], near[next], far[next], far[i]], &mut out);
    }
    // The handle shows which way is up.
    cuboid(dvec3(-0.04, 0.18, 0.42), dvec3(0.04, 0.34, 0.74), &mut out);
    out
}

/// The triangles of what a subject looks like, `size` long.
pub(crate) fn of(subject: Subject, size: f64) -> Vec<[DVec3; 3]> {
    let shape = match subject {
        Subject::Object => arrow(),
        Subject::Camera => camera(),
    };
    shape
        .into_iter()
        .map(|corners| corners.map(|p| p * size))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_point_ahead_and_cameras_do_not_see_themselves() {
        let farthest = |shape: &[[DVec3; 3]], along: DVec3| {
            shape
                .iter()
                .flatten()
                .map(|p| p.dot(along))
                .fold(f64::MIN, f64::max)
        };
        let object = of(Subject::Object, 2.0);
        assert_eq!(farthest(&object, DVec3::Z), 1.2);
        assert!(farthest(&object, DVec3::Y) > farthest(&object, -DVec3::Y));
        let camera = of(Subject::Camera, 1.0);
        assert!(farthest(&camera, -DVec3::Z) < 0.0);
        assert!(farthest(&camera, DVec3::Y) > farthest(&camera, -DVec3::Y));
        for triangle in object.iter().chain(&camera) {
            let [a, b, c] = *triangle;
            assert!((b - a).cross(c - a).length() > 1e-4);
        }
    }

    #[test]
    fn boxes_and_arrows_face_outwards() {
        let mut cube = Vec::new();
        cuboid(DVec3::splat(-1.0), DVec3::ONE, &mut cube);
        let arrow = &arrow()[..8];
        for shape in [cube.as_slice(), arrow] {
            // The signed volume is positive, and each edge is passed once either way.
            let volume: f64 = shape.iter().map(|[a, b, c]| a.dot(b.cross(*c)) / 6.0).sum();
            assert!(volume > 0.0);
            for [a, b, c] in shape {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    let back = shape
                        .iter()
                        .any(|[a, b, c]| [(a, b), (b, c), (c, a)].contains(&(to, from)));
                    assert!(back, "{from} {to}");
                }
            }
        }
    }
}
