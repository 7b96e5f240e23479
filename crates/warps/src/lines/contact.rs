//! Where two elements touch, as corners of what they share.
//!
//! The shared set is convex, and each of its corners lies on a side of one element and in the other: along a side the
//! distance to the other element is a convex function, whose smallest place is found by golden section and whose zeros by
//! bisection.
//!
//! *Source*: golden-section search, J. Kiefer, *Sequential Minimax Search for a Maximum*, Proc. AMS 4, 1953; the use of it is
//! a decision.

use anamorph_core::{Bounds, Space};
use anamorph_features::Element;

/// Golden-section steps: the bracket shrinks to 1e-16 of the side.
const STEPS: usize = 78;
/// The golden ratio less 1.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Whether two boxes are farther from each other than `tolerance`, and all in them.
pub(super) fn apart<S: Space>(one: &Bounds<S>, other: &Bounds<S>, tolerance: f64) -> bool {
    (0..S::DIM).any(|axis| {
        one.min.component(axis) > other.max.component(axis) + tolerance
            || other.min.component(axis) > one.max.component(axis) + tolerance
    })
}

/// Corners of the set that two elements share; none if they are farther than `tolerance` from each other.
pub(super) fn contacts<S: Space>(a: &Element<S>, b: &Element<S>, tolerance: f64) -> Vec<S> {
    let mut shared = Vec::new();
    for (element, other) in [(a, b), (b, a)] {
        let corners = element.corners().into_iter();
        shared.extend(corners.filter(|&c| other.distance(c) <= tolerance));
        for [from, to] in element.sides() {
            shared.extend(along(from, to, other, tolerance));
        }
    }
    shared
}

/// First and last place of a side within `tolerance` of an element.
fn along<S: Space>(from: S, to: S, element: &Element<S>, tolerance: f64) -> Vec<S> {
    let at = |t: f64| from * (1.0 - t) + to * t;
    let distance = |t: f64| element.distance(at(t));
    let (mut low, mut high) = (0.0, 1.0);
    let (mut s, mut t) = (1.0 - GOLDEN, GOLDEN);
    let (mut at_s, mut at_t) = (distance(s), distance(t));
    for _ in 0..STEPS {
        if at_s <= tolerance || at_t <= tolerance {
            break;
        }
        if at_s <= at_t {
            (high, t, at_t) = (t, s, at_s);
            s = high - GOLDEN * (high - low);
            at_s = distance(s);
        } else {
            (low, s, at_s) = (s, t, at_t);
            t = low + GOLDEN * (high - low);
            at_t = distance(t);
        }
    }
    let inside = if at_s <= at_t { s } else { t };
    if at_s.min(at_t) > tolerance {
        return Vec::new();
    }
    let edge = |mut outside: f64| {
        let mut inside = inside;
        if distance(outside) <= tolerance {
            return at(outside);
        }
        for _ in 0..60 {
            let middle = 0.5 * (inside + outside);
            if distance(middle) <= tolerance {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        at(inside)
    };
    vec![edge(0.0), edge(1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::{dvec2, dvec3};

    #[test]
    fn crossings_ends_and_overlaps() {
        let segment = |a, b| Element::segment(a, b).unwrap();
        let base = segment(dvec2(-1.0, 0.0), dvec2(2.0, 0.3));
        let cross = segment(dvec2(0.1, -1.0), dvec2(0.3, 1.0));
        let found = contacts(&base, &cross, 1e-13);
        assert!(!found.is_empty());
        for p in &found {
            assert!(base.distance(*p) < 1e-12 && cross.distance(*p) < 1e-12);
        }
        let near = segment(dvec2(0.1, 0.2), dvec2(0.3, 1.0));
        assert!(contacts(&base, &near, 1e-13).is_empty());
        let joined = segment(dvec2(2.0, 0.3), dvec2(2.0, 5.0));
        assert!(contacts(&base, &joined, 1e-13).contains(&dvec2(2.0, 0.3)));
        // Over half its length: both ends of what is shared are found.
        let over = segment(dvec2(0.5, 0.15), dvec2(5.0, 0.6));
        let found = contacts(&base, &over, 1e-13);
        let reaches = |q| found.iter().any(|p| p.distance(q) < 1e-9);
        assert!(reaches(dvec2(0.5, 0.15)) && reaches(dvec2(2.0, 0.3)));
    }

    #[test]
    fn solids_that_pierce() {
        let plate = Element::new(&[
            dvec3(0.0, 0.0, 0.0),
            dvec3(2.0, 0.0, 0.0),
            dvec3(0.0, 2.0, 0.0),
        ])
        .unwrap();
        let pin = Element::segment(dvec3(0.5, 0.6, -1.0), dvec3(0.6, 0.5, 1.0)).unwrap();
        let found = contacts(&plate, &pin, 1e-13);
        assert!(found.iter().all(|p| p.z.abs() < 1e-12) && !found.is_empty());
        let corners = [
            dvec3(0.2, 0.2, -1.0),
            dvec3(0.4, 0.2, -1.0),
            dvec3(0.2, 0.5, -1.0),
            dvec3(0.2, 0.2, 3.0),
        ];
        let column = Element::new(&corners).unwrap();
        let shared = contacts(&plate, &column, 1e-13);
        assert!(
            shared
                .iter()
                .any(|p| p.distance(dvec3(0.4, 0.5, 0.0)) < 1e-9)
        );
        // A point within, and one without.
        let inside = Element::point(dvec3(0.3, 0.3, 1.0)).unwrap();
        assert_eq!(contacts(&column, &inside, 1e-13).len(), 1);
        let outside = Element::point(dvec3(0.3, 0.6, 1.0)).unwrap();
        assert!(contacts(&column, &outside, 1e-13).is_empty());
    }
}
