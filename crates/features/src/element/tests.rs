use super::*;
use anamorph_core::glam::{DVec2, DVec3, dvec2, dvec3};

/// Marsaglia's xorshift generator, seeded.
struct Random(u64);

impl Random {
    fn number(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        2.0 * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64) - 1.0
    }
    fn vector<S: Space>(&mut self) -> S {
        S::from_fn(|_| self.number())
    }
    fn corners<S: Space>(&mut self, count: usize) -> Vec<S> {
        loop {
            let corners: Vec<S> = (0..count).map(|_| self.vector()).collect();
            if Element::new(&corners).is_ok_and(|e| count < 3 || e.volume_of_directions() > 0.2) {
                return corners;
            }
        }
    }
}

fn pair<S: Space>(source: &[S], target: &[S]) -> ElementPair<S> {
    ElementPair::of_corners(source, target).unwrap()
}

/// The distance by a fine search over shares of the edges, halving the steps about the best place.
fn searched<S: Space>(element: &Element<S>, p: S) -> f64 {
    let (mut best, mut step) = ([0.5; 3], 0.25);
    let distance = |shares: [f64; 3]| element.at(shares).distance(p);
    for _ in 0..60 {
        loop {
            let mut next = best;
            for i in 0..27_u32 {
                let delta = [i % 3, i / 3 % 3, i / 9].map(|d| f64::from(d) - 1.0);
                let shares = [0, 1, 2].map(|k| (best[k] + step * delta[k]).clamp(0.0, 1.0));
                if distance(shares) < distance(next) {
                    next = shares;
                }
            }
            if next == best {
                break;
            }
            best = next;
        }
        step *= 0.6;
    }
    distance(best)
}

fn distances<S: Space>() {
    let mut random = Random(0x9876_5432_1234_5679);
    for round in 0..60 {
        let count = 1 + round % (S::DIM + 1);
        let corners = random.corners::<S>(count);
        let element = Element::new(&corners).unwrap();
        assert_eq!(element.dimension(), count - 1);
        for _ in 0..20 {
            let p = random.vector::<S>() * 2.0;
            let (found, expected) = (element.distance(p), searched(&element, p));
            assert!(
                (found - expected).abs() < 1e-6,
                "{corners:?}, {p:?}: {found}, {expected}"
            );
            // The offset leads to a place of the element.
            let nearest = p - element.offset(p);
            assert!(element.distance(nearest) < 1e-14);
        }
        for shares in [[0.0; 3], [1.0; 3], [0.3, 0.8, 1.0], [0.5; 3]] {
            assert!(element.distance(element.at(shares)) < 1e-14);
        }
    }
}

#[test]
fn distances_are_the_smallest() {
    distances::<DVec2>();
    distances::<DVec3>();
}

#[test]
fn square_and_oblique_ways_agree() {
    let mut random = Random(77);
    let corners = [
        dvec3(0.0, 0.0, 0.0),
        dvec3(1.0, 2.0, 2.0),
        dvec3(2.0, 1.0, -2.0),
        dvec3(-2.0, 2.0, -1.0),
    ];
    let square = Element::new(&corners).unwrap();
    assert!(square.square);
    for _ in 0..500 {
        let p = random.vector::<DVec3>() * 5.0;
        let slow = Element {
            square: false,
            ..square
        };
        assert!((square.offset(p) - slow.offset(p)).length() < 1e-13);
    }
    assert_eq!(square.size(), 3.0);
    assert!((square.distance(dvec3(-1.0, -2.0, -2.0)) - 3.0).abs() < 1e-15);
}

/// Each constrains as many basis vectors as it has edges.
fn maps<S: Space>() {
    let mut random = Random(0x1234_5678_9ABC_DEF1);
    for round in 0..400 {
        let count = 1 + round % (S::DIM + 1);
        let (source, target) = (random.corners::<S>(count), random.corners::<S>(count));
        let pair = pair(&source, &target);
        let map = pair.affine().unwrap();
        for (from, to) in pair.source.corners().iter().zip(pair.target.corners()) {
            assert!((map.apply(*from) - to).length() < 1e-12, "{count}");
        }
        // What is across keeps its length and stays across.
        let mut across = random.vector::<S>();
        for _ in 0..3 {
            for i in 0..count - 1 {
                let d = pair.source.direction(i);
                across -= d * d.dot(across);
            }
            // Edges that are not perpendicular need another round: project on the normal instead.
            if let (Some(normal), 3) = (pair.source.normal(), S::DIM) {
                across = normal * normal.dot(across);
            }
        }
        let moved = map.linear.apply(across);
        if count <= S::DIM {
            assert!((moved.length() - across.length()).abs() < 1e-12);
            for i in 0..count - 1 {
                assert!(moved.dot(pair.target.direction(i)).abs() < 1e-12);
            }
            assert!(map.linear.determinant() > 0.0);
        }
    }
}

#[test]
fn corners_go_to_corners_and_what_is_across_stays_across() {
    maps::<DVec2>();
    maps::<DVec3>();
}

#[test]
fn segments_turn_no_more_than_they_must() {
    let source = [DVec3::ZERO, dvec3(2.0, 0.0, 0.0)];
    let turned = |to: DVec3| pair(&source, &[DVec3::ZERO, to]).affine().unwrap().linear;
    // The axis of the turn stays.
    let map = turned(dvec3(0.0, 2.0, 0.0));
    assert!((map.apply(DVec3::Z) - DVec3::Z).length() < 1e-15);
    assert!((map.apply(DVec3::Y) + DVec3::X).length() < 1e-15);
    // Opposite: a half turn about x × (the axis least aligned), here y and hence z.
    for end in [dvec3(-2.0, 0.0, 0.0), dvec3(-2.0, 1e-14, 0.0)] {
        let map = turned(end);
        assert!((map.apply(DVec3::Z) - DVec3::Z).length() < 1e-12, "{map:?}");
        assert!((map.apply(DVec3::Y) + DVec3::Y).length() < 1e-12);
    }
    // Almost opposite it is still a rotation, exactly onto the target.
    for tilt in [1e-11, 1e-8, 1e-4] {
        let end = dvec3(-2.0, tilt, -tilt);
        let map = turned(end);
        assert!((map.apply(DVec3::X) * 2.0 - end).length() < 1e-15 * 4.0);
        assert!((Linear::<DVec3>::determinant(&map) - end.length() / 2.0).abs() < 1e-13);
    }
}

#[test]
fn the_normal_of_a_rectangle_turns_with_it() {
    let source = [DVec3::ZERO, DVec3::X, DVec3::Y * 3.0];
    let target = [DVec3::ZERO, DVec3::Y * 2.0, DVec3::Z];
    let map = pair(&source, &target).affine().unwrap().linear;
    assert!((map.apply(DVec3::Z) - DVec3::X).length() < 1e-15);
    let left = Element::segment(DVec2::ZERO, DVec2::X).unwrap().normal();
    assert_eq!(left, Some(DVec2::Y));
}

#[test]
fn without_extent() {
    let p = dvec2(1.0, 2.0);
    // A source without length is a point, whatever the target.
    let point = pair(&[p, p], &[DVec2::ZERO, DVec2::X]).affine().unwrap();
    assert_eq!(point, Affine::translation(-p));
    // A target without length keeps what is across.
    let kept = pair(&[p, p + DVec2::X], &[DVec2::ZERO; 2])
        .affine()
        .unwrap();
    assert!((kept.apply(p + dvec2(0.7, 0.5)) - dvec2(0.0, 0.5)).length() < 1e-15);
    let space = pair(&[DVec3::ZERO, DVec3::X], &[DVec3::Y; 2])
        .affine()
        .unwrap();
    assert!((space.apply(dvec3(5.0, 2.0, 3.0)) - dvec3(0.0, 3.0, 3.0)).length() < 1e-15);
    // Rectangles and boxes need extent; a target box may be flat, a target rectangle of space not.
    let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
    let flat = ElementPair::of_corners(&line, &line).unwrap_err();
    assert!(flat.to_string().contains("source is flat") && flat.to_string().contains("line"));
    let plate = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let flat = ElementPair::of_corners(&plate, &line).unwrap_err();
    assert!(flat.to_string().contains("target is flat"));
    let solid = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let pressed = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X];
    let map = pair(&solid, &pressed).affine().unwrap();
    assert_eq!(Linear::<DVec3>::determinant(&map.linear), 0.0);
    assert!(ElementPair::of_corners(&pressed, &solid).is_err());
}

#[test]
fn bad_corners_are_named() {
    let error = Element::<DVec2>::new(&[]).unwrap_err();
    assert!(error.to_string().contains("1 to 3 corners"));
    let error = Element::new(&[DVec2::ZERO; 4]).unwrap_err();
    assert!(error.to_string().contains("4 are given"));
    let error = Element::segment(DVec2::ZERO, dvec2(0.0, f64::NAN)).unwrap_err();
    assert!(error.to_string().contains("not finite"));
    // Finite corners, an infinite edge.
    let far = DVec2::splat(f64::MAX);
    assert!(Element::segment(far, -far).is_err());
    let error = ElementPair::of_corners(&[DVec2::ZERO], &[DVec2::ZERO, DVec2::X]).unwrap_err();
    assert!(error.to_string().contains("the target 2"));
}

#[test]
fn extreme_sizes() {
    for size in [1e-150, 1e150] {
        let source = [DVec3::ZERO, DVec3::X * size, DVec3::Y * size];
        let target = [DVec3::ZERO, DVec3::Y * size, DVec3::Z * size];
        let pair = pair(&source, &target);
        let map = pair.affine().unwrap();
        let landed = map.apply(dvec3(0.5, 0.5, 1.0) * size) / size;
        assert!((landed - dvec3(1.0, 0.5, 0.5)).length() < 1e-14);
        let p = dvec3(3.0, 0.5, 4.0) * size;
        assert!((pair.source.distance(p) / size - 20_f64.sqrt()).abs() < 1e-14);
    }
    let tiny = [DVec2::ZERO, DVec2::X * 1e-200];
    let huge = [DVec2::ZERO, DVec2::X * 1e200];
    let error = pair(&tiny, &huge).affine().unwrap_err();
    assert_eq!(error, FeatureError::Overflow);
    // Edges of very unequal lengths are independent all the same.
    let plate = [DVec3::ZERO, DVec3::X * 1e-9, DVec3::Y * 1e9];
    assert_eq!(pair(&plate, &plate).affine().unwrap(), Affine::IDENTITY);
}

#[test]
fn corners_and_sides() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    for (count, sides) in [(1, 0), (2, 1), (3, 4), (4, 12)] {
        let element = Element::new(&corners[..count]).unwrap();
        assert_eq!(element.corners().len(), 1 << (count - 1));
        assert_eq!(element.sides().len(), sides);
        for [from, to] in element.sides() {
            assert!(((to - from).length() - 1.0).abs() < 1e-15);
        }
    }
    assert_eq!(pair(&corners, &corners).marks().len(), 8);
    assert_eq!(pair(&corners[..1], &[DVec3::X]).marks().len(), 3);
}
