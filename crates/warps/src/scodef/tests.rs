//! Constraints met, alone and together; bases, supports and what is refused.
//!
//! *Source*: the formulas are those of the module above; places are a sequence by M. Roberts, *The Unreasonable Effectiveness of
//! Quasirandom Sequences*, 2018.

use super::*;
use anamorph_core::{Plane, Solid, glam::dvec2, glam::dvec3, map_all};

/// Numbers in [−1, 1), evenly spread along each axis and together (M. Roberts' sequence of three axes).
fn number(i: usize, axis: usize) -> f64 {
    let share = [
        0.819_172_513_396_164_5,
        0.671_043_606_703_789_2,
        0.549_700_477_901_97,
    ][axis];
    let x = (i as f64 + 1.0) * share;
    2.0 * (x - x.floor()) - 1.0
}

fn place<S: Space>(i: usize) -> S {
    S::from_fn(|axis| number(i, axis))
}

fn constraint<S: Space>(source: S, by: S, basis: Basis<S>) -> Constraint<S> {
    let target = source + by;
    Constraint {
        pair: PointPair { source, target },
        basis,
    }
}

fn at<S: Space>(warp: &ScodefWarp<S>, p: S) -> S {
    warp.map(&Site::anywhere(p))
}

/// So many points that reach each other, with radii of their own.
fn overlapping<S: Space>(count: usize, cuboids: bool) -> Vec<Constraint<S>> {
    (0..count)
        .map(|i| {
            let radius = 0.4 + 0.3 * number(i + 31, 0).abs();
            let radii = S::from_fn(|axis| radius + 0.2 * number(i + 90, axis).abs());
            let basis = if cuboids {
                Basis::Box { radii }
            } else {
                Basis::BSpline { radius }
            };
            constraint(place(i), place::<S>(i + 500) * 0.2, basis)
        })
        .collect()
}

fn overlapping_constraints_are_met<S: Space>() {
    for cuboids in [false, true] {
        for count in [2, 9, 60] {
            let list = overlapping::<S>(count, cuboids);
            let warp = ScodefWarp::construct(list.clone()).unwrap();
            assert_eq!((warp.rank(), warp.missed()), (count, None));
            for Constraint { pair, .. } in &list {
                assert!(at(&warp, pair.source).distance(pair.target) < 1e-9);
            }
            // The terms, and the derivative.
            let places = (0..40).map(|i| place::<S>(i + 1000) * 1.3);
            for p in places {
                let site = Site::anywhere(p);
                let literal = anamorph_core::reference::evaluate(&warp, &site);
                assert!((at(&warp, p) - literal).largest() < 1e-12);
                let exact = warp.jacobian(&site, 1.0).unwrap();
                for axis in 0..S::DIM {
                    let step = S::unit(axis) * 1e-5;
                    let slope = (at(&warp, p + step) - at(&warp, p - step)) / 2e-5;
                    let apart = exact.column(axis) - slope;
                    assert!(apart.largest() < 1e-6, "{apart:?}");
                }
                let change = exact - S::Linear::IDENTITY;
                let bound = warp.facts().stretch().unwrap();
                assert!((0..S::DIM).all(|axis| change.column(axis).length() <= bound));
            }
        }
    }
}

#[test]
fn overlapping_constraints_are_met_in_plane_and_space() {
    overlapping_constraints_are_met::<Plane>();
    overlapping_constraints_are_met::<Solid>();
}

#[test]
fn a_lone_constraint_moves_by_its_function() {
    let by = dvec3(0.25, -1.0, 2.0);
    let centre = dvec3(5.0, 1.0, -2.0);
    let ball = Basis::BSpline { radius: 2.0 };
    let warp = ScodefWarp::construct(vec![constraint(centre, by, ball)]).unwrap();
    assert_eq!(warp.coefficients(), [by]);
    // At the centre, at half the radius, and at the radius.
    for (distance, share) in [(0.0, 1.0), (1.0, 0.25), (1.5, 0.03125), (2.0, 0.0)] {
        let p = centre + dvec3(0.0, distance, 0.0);
        assert!((at(&warp, p) - p - by * share).largest() < 1e-15);
    }
    let facts = warp.facts();
    let expected = Support::Ball {
        centre,
        radius: 2.0,
    };
    assert_eq!(facts.support, expected);
    assert_eq!(
        (facts.inside, facts.edge),
        (Smoothness::C(2), Smoothness::C(2))
    );
}

#[test]
fn a_box_has_an_extent_of_its_own_along_each_axis() {
    let radii = dvec3(1.0, 4.0, 0.5);
    let list = vec![constraint(Solid::ZERO, Solid::X, Basis::Box { radii })];
    let warp = ScodefWarp::construct(list).unwrap();
    for axis in 0..3 {
        let edge = Solid::unit(axis) * radii.component(axis);
        assert_eq!(at(&warp, edge), edge);
        let inside = edge * 0.999;
        assert!(at(&warp, inside).x > inside.x);
        assert!((at(&warp, edge * 0.5) - edge * 0.5).distance(Solid::X * 0.25) < 1e-15);
    }
    // A corner is out of every ball that fits, and yet within the box.
    let corner = radii * 0.9;
    assert!(at(&warp, corner).x > corner.x);
    let expected = Support::Box(Bounds::new(-radii, radii));
    assert_eq!(warp.facts().support, expected);
}

#[test]
fn groups_apart_do_not_know_of_each_other() {
    let ball = Basis::BSpline { radius: 1.0 };
    // A chain, whose ends do not reach each other, and a pair far away.
    let places = [0.0, 50.0, 0.8, 1.6, 50.5];
    let list = places.map(|x| constraint(dvec2(x, 0.0), dvec2(0.0, 1.0 + x), ball));
    assert_eq!(groups(&list), [vec![0, 2, 3], vec![1, 4]]);
    let all = ScodefWarp::construct(list.to_vec()).unwrap();
    let pair = ScodefWarp::construct(vec![list[1], list[4]]).unwrap();
    let p = dvec2(50.3, 0.2);
    assert_eq!(at(&all, p), at(&pair, p));
    // A large radius that reaches a point which does not reach back joins them as well.
    let wide = Basis::BSpline { radius: 60.0 };
    let joined = [
        list[0],
        list[1],
        constraint(dvec2(25.0, 0.0), Plane::Y, wide),
    ];
    assert_eq!(groups(&joined), [vec![0, 1, 2]]);
    let warp = ScodefWarp::construct(joined.to_vec()).unwrap();
    assert_eq!(warp.missed(), None);
}

#[test]
fn constraints_in_one_place_share_what_they_move() {
    let ball = |radius| Basis::BSpline { radius };
    let one = constraint(dvec2(1.0, 1.0), Plane::X, ball(1.0));
    let twice = ScodefWarp::construct(vec![one, one]).unwrap();
    assert_eq!((twice.rank(), twice.missed()), (1, None));
    let lone = ScodefWarp::construct(vec![one]).unwrap();
    for p in [dvec2(1.0, 1.0), dvec2(1.3, 0.8), dvec2(1.9, 1.0)] {
        assert!((at(&twice, p) - at(&lone, p)).largest() < 1e-14);
    }
    let halves = twice.coefficients();
    assert!((halves[0] - Plane::X * 0.5).largest() < 1e-14);
    // Two radii: the least norm takes half of each.
    let wide = constraint(dvec2(1.0, 1.0), Plane::X, ball(3.0));
    let both = ScodefWarp::construct(vec![one, wide]).unwrap();
    assert_eq!((both.rank(), both.missed()), (1, None));
    let share = 0.5 * (ball(1.0).value(dvec2(0.4, 0.0)) + ball(3.0).value(dvec2(0.4, 0.0)));
    let p = dvec2(1.4, 1.0);
    assert!((at(&both, p) - p - Plane::X * share).largest() < 1e-14);
}

#[test]
fn constraints_that_contradict_each_other_are_met_as_nearly_as_can_be() {
    let wide = Basis::BSpline { radius: 1.0 };
    let (near, far) = (dvec2(0.0, 0.0), dvec2(0.6, 0.0));
    let list = vec![
        constraint(near, dvec2(0.0, 0.3), wide),
        constraint(near + dvec2(1e-8, 0.0), dvec2(0.0, 0.1), wide),
        constraint(far, dvec2(0.2, 0.0), wide),
    ];
    let warp = ScodefWarp::construct(list).unwrap();
    assert_eq!(warp.rank(), 2);
    // The mean of the two, so that the squares of both misses are least; the third is met.
    assert!((at(&warp, near) - near - dvec2(0.0, 0.2)).largest() < 1e-7);
    assert!((at(&warp, far) - far - dvec2(0.2, 0.0)).largest() < 1e-7);
    let miss = warp.missed().unwrap();
    assert!((miss.distance - 0.1).abs() < 1e-7 && miss.point < 2);
    let notes = warp.facts().notes;
    assert!(notes[0].contains("rank 2 of 3") && notes[0].contains("1.0e-1"));
    // So near that many digits cancel, yet independent: they are met.
    let close = vec![
        constraint(near, dvec2(0.0, 0.3), wide),
        constraint(near + dvec2(1e-3, 0.0), dvec2(0.0, 0.3 + 1e-4), wide),
    ];
    let warp = ScodefWarp::construct(close).unwrap();
    assert_eq!((warp.rank(), warp.missed()), (2, None));
}

#[test]
fn what_no_constraint_reaches_stays_and_nothing_moves_without_displacements() {
    let list = overlapping::<Solid>(12, false);
    let warp = ScodefWarp::construct(list.clone()).unwrap();
    let support = warp.facts().support;
    let (mut still, mut moved) = (0, 0);
    for i in 0..2000 {
        let p = place::<Solid>(i + 300) * 2.0;
        let reached = list.iter().any(|c| c.basis.value(p - c.pair.source) != 0.0);
        if reached {
            assert!(support.contains(p));
            moved += usize::from(at(&warp, p) != p);
        } else {
            assert_eq!(at(&warp, p), p);
            still += 1;
        }
    }
    assert!(still > 200 && moved > 200, "{still}, {moved}");
    let pinned = list.iter().map(|c| Constraint {
        pair: PointPair {
            source: c.pair.source,
            target: c.pair.source,
        },
        basis: c.basis,
    });
    let identity = ScodefWarp::construct(pinned.collect()).unwrap();
    assert_eq!(identity.facts(), Facts::identity());
    let far = [Solid::splat(f64::MAX), Solid::splat(-1e200)];
    let mut points = far;
    assert!(map_all(&warp, &mut points).is_empty());
    assert_eq!(points, far);
}

#[test]
fn bad_constraints_are_refused() {
    let ball = |radius| Basis::BSpline { radius };
    let good = constraint(Plane::ZERO, Plane::X, ball(1.0));
    let refused = |list: Vec<Constraint<Plane>>| ScodefWarp::construct(list).unwrap_err();
    assert_eq!(refused(vec![]), ScodefError::NoPoint);
    let bad = constraint(dvec2(f64::NAN, 0.0), Plane::X, ball(1.0));
    let not_finite = ScodefError::NotFinite { point: 1 };
    assert_eq!(refused(vec![good, bad]), not_finite);
    for radius in [0.0, -2.0, f64::INFINITY] {
        let radii = dvec2(1.0, radius);
        let error = ScodefError::Radius { point: 1, radius };
        let list = vec![good, constraint(Plane::Y, Plane::X, Basis::Box { radii })];
        assert_eq!(refused(list), error);
        let list = vec![good, constraint(Plane::Y, Plane::X, ball(radius))];
        assert_eq!(refused(list), error);
    }
    let other = constraint(dvec2(-0.0, 0.0), Plane::Y, ball(3.0));
    let apart = constraint(Plane::ONE, Plane::Y, ball(3.0));
    let coincident = ScodefError::Coincident {
        first: 0,
        second: 2,
    };
    assert_eq!(refused(vec![good, apart, other]), coincident);
    let huge = Constraint {
        pair: PointPair {
            source: dvec2(-1e308, 0.0),
            target: dvec2(1e308, 0.0),
        },
        basis: ball(1.0),
    };
    assert_eq!(refused(vec![huge]), ScodefError::Overflow { point: 0 });
    let many = vec![good; MOST_POINTS + 1];
    let too_many = ScodefError::TooMany {
        points: MOST_POINTS + 1,
        most: MOST_POINTS,
    };
    assert_eq!(refused(many), too_many);
}
