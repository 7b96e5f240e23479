//! B13: Barr's closed forms, volume, axis length, profiles.

use anamorph_core::{
    Deformation, Linear, Scaling, Site, Smoothness, Solid,
    glam::{DVec3, dvec2, dvec3},
};
use anamorph_fields::{AxisRange, Ends, Limit, Profile};
use anamorph_tests::random::Random;
use anamorph_warps::barr::bend::Bend;
use anamorph_warps::barr::taper::Taper;
use anamorph_warps::barr::twist::Twist;
use anamorph_warps::barr::{AxisFrame, Course};

/// The upright frame, in which Barr's formulas are printed.
fn upright() -> AxisFrame<Solid> {
    AxisFrame::new(Solid::ZERO, Solid::Z, Some(Solid::X)).unwrap()
}

fn range(from: f64, to: f64, limit: Limit) -> AxisRange {
    AxisRange::new(from, to, limit).unwrap()
}

#[test]
fn b13_taper_is_barrs() {
    let factor = Course::Polynomial(vec![1.0, 0.3, -0.1]);
    let warp = Taper::construct(upright(), factor, None, Scaling::Displacement).unwrap();
    let mut random = Random::new(131);
    for _ in 0..200 {
        let p = random.vector::<Solid>() * 3.0;
        let r = 1.0 + 0.3 * p.z - 0.1 * p.z * p.z;
        let q = warp.map(&Site::anywhere(p));
        assert!((q - dvec3(r * p.x, r * p.y, p.z)).length() < 1e-14 * 10.0);
        // Barr's local volume ratio: r².
        let jacobian = warp.jacobian(&Site::anywhere(p), 1.0).unwrap();
        assert!((Linear::<Solid>::determinant(&jacobian) - r * r).abs() < 1e-12);
    }
}

#[test]
fn b13_twist_is_barrs_and_keeps_volume() {
    let angle = |z: f64| 0.4 + 0.9 * z - 0.2 * z * z * z;
    let course = Course::Polynomial(vec![0.4, 0.9, 0.0, -0.2]);
    let warp = Twist::construct(upright(), course, None, Scaling::Composition).unwrap();
    let mut random = Random::new(132);
    for _ in 0..200 {
        let p = random.vector::<Solid>() * 2.0;
        let (s, c) = angle(p.z).sin_cos();
        let q = warp.map(&Site::anywhere(p));
        let expected = dvec3(p.x * c - p.y * s, p.x * s + p.y * c, p.z);
        assert!((q - expected).length() < 1e-14);
        let jacobian = warp.jacobian(&Site::anywhere(p), 1.0).unwrap();
        assert!((Linear::<Solid>::determinant(&jacobian) - 1.0).abs() < 1e-12);
    }
    // A whole: the volume of a twisted box, by the divergence theorem over its triangulated surface.
    let n = 60_u32;
    let side = |i: u32| -1.0 + 2.0 * f64::from(i) / f64::from(n);
    let mut volume = 0.0;
    let faces: [[Solid; 3]; 6] = [
        [Solid::X, Solid::Y, Solid::Z],
        [Solid::Y, Solid::Z, Solid::X],
        [Solid::Z, Solid::X, Solid::Y],
        [-Solid::X, Solid::Z, Solid::Y],
        [-Solid::Y, Solid::X, Solid::Z],
        [-Solid::Z, Solid::Y, Solid::X],
    ];
    for [out, u, v] in faces {
        let at = |i: u32, j: u32| warp.map(&Site::anywhere(out + u * side(i) + v * side(j)));
        for i in 0..n {
            for j in 0..n {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                volume += a.dot(b.cross(c)) / 6.0 + a.dot(c.cross(d)) / 6.0;
            }
        }
    }
    assert!((volume - 8.0).abs() < 5e-3, "{volume}");
}

/// Barr's bend of the y axis in the y–z plane: `θ = k (ŷ − y₀)`, `y ↦ −sin θ (z − 1/k) + y₀`,
/// `z ↦ cos θ (z − 1/k) + 1/k` and the straight continuations (1984, eqs. 3.4).
fn barr(p: DVec3, k: f64, y0: f64, from: f64, to: f64) -> DVec3 {
    let limited = p.y.clamp(from, to);
    let (s, c) = (k * (limited - y0)).sin_cos();
    let beyond = p.y - limited;
    dvec3(
        p.x,
        -s * (p.z - 1.0 / k) + y0 + c * beyond,
        c * (p.z - 1.0 / k) + 1.0 / k + s * beyond,
    )
}

#[test]
fn b13_bend_is_barrs() {
    let (from, to) = (-0.7, 1.1);
    let mut random = Random::new(133);
    for (k, y0) in [(0.8, 0.2), (-1.9, -0.7), (3.0, 1.1), (0.05, 0.0)] {
        let frame = AxisFrame::new(Solid::ZERO, Solid::Y, Some(Solid::Z)).unwrap();
        let limits = range(from, to, Limit::Clamp);
        let warp = Bend::construct(frame, k, y0, Some(limits), Scaling::Composition).unwrap();
        for _ in 0..200 {
            let p = random.vector::<Solid>() * 2.0;
            let error = (warp.map(&Site::anywhere(p)) - barr(p, k, y0, from, to)).length();
            // Barr's own form cancels for small curvature.
            assert!(error < 1e-13 * (1.0 + 1.0 / k.abs()), "{k}: {error}");
            // Barr's local volume ratio within the range: 1 − k z̄, z̄ the height towards the centre.
            let inside = (from..=to).contains(&p.y);
            let jacobian = warp.jacobian(&Site::anywhere(p), 1.0).unwrap();
            let ratio = if inside { 1.0 - k * p.z } else { 1.0 };
            assert!((Linear::<Solid>::determinant(&jacobian) - ratio).abs() < 1e-12);
        }
    }
}

/// Eight-point Gauss–Legendre nodes and weights on [−1, 1].
const GAUSS: [(f64, f64); 8] = [
    (-0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
    (-0.796_666_477_413_626_7, 0.222_381_034_453_374_47),
    (-0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (-0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_47),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
];

#[test]
fn b13_bend_keeps_the_length_of_the_axis() {
    let frame = AxisFrame::new(dvec3(0.1, 0.2, -0.4), dvec3(1.0, 2.0, 2.0), None).unwrap();
    let limits = [
        Limit::Clamp,
        Limit::Smooth { width: 0.4 },
        Limit::Smooth { width: 0.9 },
    ];
    for limit in limits {
        for (k, pivot) in [(0.9, -1.0), (4.0, 0.3), (-25.0, 2.5)] {
            let bounds = range(-1.0, 0.8, limit);
            let warp = Bend::construct(frame, k, pivot, Some(bounds), Scaling::Composition);
            let warp = warp.unwrap();
            let axis = |z: f64| warp.map(&Site::anywhere(frame.place([0.0, 0.0, z])));
            // The speed of the bent axis, from the Jacobian: 1 everywhere.
            let speed = |z: f64| {
                let site = Site::anywhere(frame.place([0.0, 0.0, z]));
                warp.jacobian(&site, 1.0).unwrap() * frame.basis[2]
            };
            let (from, to, pieces) = (-2.0, 2.0, 400_u32);
            let mut length = 0.0;
            for piece in 0..pieces {
                let step = (to - from) / f64::from(pieces);
                let middle = from + (f64::from(piece) + 0.5) * step;
                // Its integral is the curve itself: position and derivative belong together.
                let mut moved = Solid::ZERO;
                for (node, weight) in GAUSS {
                    let velocity = speed(middle + 0.5 * step * node);
                    length += velocity.length() * weight * 0.5 * step;
                    moved += velocity * (weight * 0.5 * step);
                }
                let chord = axis(middle + 0.5 * step) - axis(middle - 0.5 * step);
                // A clamp's corner falls between pieces, and the zones' polynomials end there, too.
                assert!(
                    (chord - moved).length() < 1e-12,
                    "{limit:?}, {k}, piece {piece}"
                );
            }
            let error = (length - (to - from)).abs();
            assert!(error < 1e-12 * 4.0, "{limit:?}, {k}: {error}");
            // The pivot stays and keeps its direction.
            let stayed = axis(pivot).distance(frame.place([0.0, 0.0, pivot]));
            assert!(stayed < 1e-13, "{limit:?}, {k}: {stayed}");
            let turned = speed(pivot) - frame.basis[2];
            assert!(turned.length() < 1e-13);
        }
    }
}

#[test]
fn b13_bent_cross_sections_stay_rigid() {
    let frame = AxisFrame::new(Solid::ZERO, Solid::Y, Some(Solid::X)).unwrap();
    let limits = range(-1.0, 1.0, Limit::Smooth { width: 0.5 });
    let warp = Bend::construct(frame, 1.2, 0.0, Some(limits), Scaling::Composition).unwrap();
    let mut random = Random::new(134);
    for _ in 0..200 {
        let z = random.between(-2.0, 2.0);
        let p = |random: &mut Random| {
            let q = random.vector::<Solid>();
            frame.place([q.x, q.y, z])
        };
        let (a, b) = (p(&mut random), p(&mut random));
        let moved = |p| warp.map(&Site::anywhere(p));
        assert!((moved(a).distance(moved(b)) - a.distance(b)).abs() < 1e-13);
    }
}

#[test]
fn b13_taper_profiles_pass_through_their_points() {
    let points = [[0.0, 1.0], [0.25, 0.4], [0.5, 0.6], [0.8, 1.5], [1.0, 1.0]];
    let (from, to) = (-0.5, 1.5);
    let profile = Profile::through_with_ends(&points, Ends::Linear).unwrap();
    let course = Course::Drawn {
        profile,
        from,
        per_length: 1.0 / (to - from),
        scale: 1.0,
    };
    let limits = range(from, to, Limit::Clamp);
    let warp = Taper::construct(upright(), course, Some(limits), Scaling::Displacement).unwrap();
    let width = |z: f64| warp.map(&Site::anywhere(dvec3(1.0, 2.0, z)));
    for [share, factor] in points {
        let z = from + share * (to - from);
        let q = width(z);
        assert!(
            (q - dvec3(factor, 2.0 * factor, z)).length() < 1e-14,
            "{share}: {q:?}"
        );
    }
    // Beyond the range the ends' factors go on; between the points it stays within their reach.
    assert_eq!(width(-3.0), dvec3(1.0, 2.0, -3.0));
    for i in 0..=100 {
        let x = width(from + 0.02 * f64::from(i)).x;
        assert!(x > 0.2 && x < 1.7, "{x}");
    }
    // Smooth through them: the slope has no jump at a point.
    let slope = |z: f64, h: f64| (width(z + h).x - width(z).x) / h;
    for [share, _] in &points[1..4] {
        let z = from + share * (to - from);
        assert!((slope(z, 1e-6) - slope(z, -1e-6)).abs() < 1e-4);
    }
}

#[test]
fn b13_reports_name_the_limits_in_force() {
    let course = || Course::linear(-1.0, 0.0, 1.0, 2.0);
    let twist = |limit| {
        let limits = Some(range(-1.0, 1.0, limit));
        Twist::construct(upright(), course(), limits, Scaling::Composition).unwrap()
    };
    let clamp = twist(Limit::Clamp).facts();
    assert_eq!(clamp.smoothness(), Smoothness::C(0));
    assert!(clamp.notes[0].contains("clamp"));
    let smooth = twist(Limit::Smooth { width: 0.5 }).facts();
    assert_eq!(smooth.smoothness(), Smoothness::C(2));
    assert!(smooth.notes[0].contains("smooth blend"));
}

#[test]
fn b13_the_plane_tapers_and_bends() {
    let frame = AxisFrame::new(dvec2(0.0, 0.0), dvec2(0.0, 1.0), Some(dvec2(1.0, 0.0))).unwrap();
    let bend = Bend::construct(
        frame,
        core::f64::consts::FRAC_PI_2,
        0.0,
        None,
        Scaling::Composition,
    );
    // A quarter turn over one unit of height.
    let tip = bend.unwrap().map(&Site::anywhere(dvec2(0.0, 1.0)));
    let radius = core::f64::consts::FRAC_2_PI;
    assert!((tip - dvec2(radius, radius)).length() < 1e-15);
    let course = Course::Polynomial(vec![1.0, 1.0]);
    let taper = Taper::construct(frame, course, None, Scaling::Displacement).unwrap();
    assert_eq!(taper.map(&Site::anywhere(dvec2(0.5, 1.0))), dvec2(1.0, 1.0));
}
