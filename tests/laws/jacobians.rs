//! Derivatives: analytic Jacobians, those of masks and stacks, volume, and normals.

use crate::laws;
use anamorph_core::{
    Bounds, Deformation, Linear, Masked, Modulated, Site, Solid, Space, Stack, carry_normal,
    difference_jacobian, difference_step, vertex_normals,
};
use anamorph_fields::falloffs::{Smootherstep, Wires};
use anamorph_fields::{BoxField, Radial};
use anamorph_tests::measure::{linear_distance, linear_size};
use anamorph_tests::models::patch;
use anamorph_tests::random::Random;
use anamorph_tests::subjects::{Registered, Subject};

laws!(
    jacobians_equal_differences,
    jacobians_of_masks_and_stacks_equal_differences,
);

/// The Jacobian by differences, or `None` where one-sided differences disagree: at a crease or a jump.
pub(crate) fn smooth_jacobian<S: Space>(
    deformation: &dyn Deformation<S>,
    p: S,
    size: f64,
) -> Option<S::Linear> {
    differences(deformation, p, size).map(|(jacobian, _)| jacobian)
}

/// The same, and how far one-sided differences disagree: where a second derivative jumps within the step, central ones err by up
/// to half of that.
fn differences<S: Space>(
    deformation: &dyn Deformation<S>,
    p: S,
    size: f64,
) -> Option<(S::Linear, f64)> {
    let site = Site::anywhere(p);
    let (here, step) = (deformation.map(&site), difference_step(p, size));
    let side = |step: f64| {
        S::Linear::from_columns(|i| {
            let there = p + S::unit(i) * step;
            (deformation.map(&Site::anywhere(there)) - here) / (there.component(i) - p.component(i))
        })
    };
    let (fore, aft) = (side(step), side(-step));
    let close = 1e-3 * (1.0 + linear_size::<S>(&fore));
    let apart = linear_distance::<S>(&fore, &aft);
    if apart >= close {
        return None;
    }
    Some((difference_jacobian(deformation, &site, size)?, apart))
}

/// Holds a deformation's Jacobian to differences at random points of a box.
pub(crate) fn check_jacobian<S: Space>(
    what: &str,
    deformation: &dyn Deformation<S>,
    bounds: Bounds<S>,
    seed: u64,
) {
    check_jacobian_where(what, deformation, bounds, seed, |_| true);
}

/// The same, at those of the points that fit.
fn check_jacobian_where<S: Space>(
    what: &str,
    deformation: &dyn Deformation<S>,
    bounds: Bounds<S>,
    seed: u64,
    fits: impl Fn(S) -> bool,
) {
    let (mut random, mut checked) = (Random::new(seed), 0);
    let size = bounds.diagonal();
    for _ in 0..40 {
        let p = bounds.at(S::from_fn(|_| random.between(-0.1, 1.1)));
        if !fits(p) {
            continue;
        }
        let Some((expected, apart)) = differences(deformation, p, size) else {
            continue;
        };
        let jacobian = deformation.jacobian(&Site::anywhere(p), size).unwrap();
        let error = linear_distance::<S>(&jacobian, &expected);
        let tolerance = 2e-6 * (1.0 + linear_size::<S>(&expected)) + 0.5 * apart;
        assert!(
            error < tolerance,
            "{what}\nat {p:?}: {jacobian:?}, not {expected:?}"
        );
        checked += 1;
    }
    // A polynomial of the coordinate makes no sense in a huge box.
    let wild = what.contains("polynomial") && size > 1e3;
    assert!(
        checked >= 25 || wild,
        "{what}\nonly {checked} places without a crease"
    );
}

fn jacobians_equal_differences<S: Registered>() {
    for (i, subject) in Subject::<S>::all().iter().enumerate() {
        check_jacobian(
            &subject.to_string(),
            &subject.warp(),
            subject.bounds,
            50 + i as u64,
        );
    }
}

fn jacobians_of_masks_and_stacks_equal_differences<S: Registered>() {
    let subjects = Subject::<S>::some();
    for (i, subject) in subjects.iter().enumerate() {
        let (bounds, what) = (subject.bounds, subject.to_string());
        let radius = 0.45 * bounds.diagonal();
        let radial = || Box::new(Radial::new(bounds.at(S::splat(0.4)), radius, Wires).unwrap());
        let inner = Bounds::new(bounds.at(S::splat(0.3)), bounds.at(S::splat(0.6)));
        let margin = 0.3 * bounds.diagonal();
        let boxed = || Box::new(BoxField::new(inner, margin, Smootherstep).unwrap());
        let masked = || Masked::new(subject.warp(), radial());
        check_jacobian(&what, &masked(), bounds, 90);
        let strength = Modulated::new(subject.warp()).with_strength(boxed());
        check_jacobian(&what, &strength, bounds, 91);
        let other = &subjects[(i * 7 + 3) % subjects.len()];
        let stack = Stack::new(vec![
            Box::new(masked()),
            other.warp(),
            Box::new(Masked::new(subject.warp(), Box::new(0.5))),
        ]);
        // A crease of the second can be within its own step and beside that of the whole.
        let (first, second, size) = (masked(), other.warp(), bounds.diagonal());
        let smooth = |p: S| smooth_jacobian(&second, first.map(&Site::anywhere(p)), size).is_some();
        check_jacobian_where(&format!("{what}, then {other}"), &stack, bounds, 92, smooth);
    }
}

#[test]
fn twists_keep_volume() {
    let mut random = Random::new(17);
    let twists = Subject::<Solid>::all();
    let twists = twists.iter().filter(|s| s.setting.kind == "twist");
    let mut count = 0;
    for subject in twists {
        let warp = subject.warp();
        for _ in 0..40 {
            let site = Site::anywhere(subject.inside(&mut random));
            let determinant = warp.jacobian(&site, subject.size()).unwrap().determinant();
            assert!((determinant - 1.0).abs() < 1e-9, "{subject}: {determinant}");
            count += 1;
        }
    }
    assert!(count > 1000);
}

#[test]
fn carried_normals_are_those_of_the_moved_surface() {
    for subject in Subject::<Solid>::some() {
        let (warp, mut random) = (subject.warp(), Random::new(77));
        let mut checked = 0;
        for _ in 0..12 {
            let p = subject.inside(&mut random);
            let normal = random.direction::<Solid>();
            let Some(jacobian) = smooth_jacobian(&warp, p, subject.size()) else {
                continue;
            };
            // Where the deformation nearly flattens space, a finite patch sees curvature instead.
            let volume = Linear::<Solid>::determinant(&jacobian).abs();
            if volume < 0.02 * linear_size::<Solid>(&jacobian).powi(3) {
                continue;
            }
            let (mut points, triangles) = patch(p, normal, 1e-5 * subject.size());
            assert!(vertex_normals(&points, &triangles)[0].dot(normal) > 1.0 - 1e-9);
            warp.map_points(0, &mut points);
            let seen = vertex_normals(&points, &triangles)[0];
            let exact = warp.jacobian(&Site::anywhere(p), subject.size()).unwrap();
            let carried = carry_normal(&exact, normal);
            assert!(
                (seen - carried).length() < 5e-3,
                "{subject}\n{seen:?}, {carried:?}"
            );
            checked += 1;
        }
        assert!(checked > 0, "{subject}");
    }
}
