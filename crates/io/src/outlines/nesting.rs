//! Outlines of a part sorted into polygons with holes.
//!
//! An outline is a hole if the places just inside of it are not inside of the part by its rule, counted at its first point: with the
//! even-odd rule by how many outlines lie around it, with the nonzero rule by how often they wind around it. A hole belongs to the smallest
//! outline that is no hole and contains it. Outlines that cross each other are sorted, not cut.
//!
//! *Source*: D. Sunday, *Inclusion of a Point in a Polygon*, 2001 (winding numbers); W3C, *Scalable Vector Graphics (SVG) 2*, 2018, section
//! 13.3.2.

use super::drawing::{Part, Rule};
use anamorph_core::glam::DVec2;

/// An outline and the holes in it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Polygon {
    /// Runs in the positive direction: its shoelace area is not negative.
    pub outer: Vec<DVec2>,
    /// Run in the other one.
    pub holes: Vec<Vec<DVec2>>,
}

/// Twice the area inside a ring, negative where it runs clockwise with y upwards (shoelace, from its first point).
fn doubled_area(ring: &[DVec2]) -> f64 {
    let Some(first) = ring.first() else {
        return 0.0;
    };
    let corner = |pair: &[DVec2]| (pair[0] - *first).perp_dot(pair[1] - *first);
    ring.windows(2).map(corner).sum()
}

/// How often a ring winds around a point.
fn winding(ring: &[DVec2], point: DVec2) -> i32 {
    let next = ring.iter().cycle().skip(1);
    let step = |(a, b): (&DVec2, &DVec2)| {
        let side = (*b - *a).perp_dot(point - *a);
        match (a.y <= point.y, b.y <= point.y) {
            (true, false) if side > 0.0 => 1,
            (false, true) if side < 0.0 => -1,
            _ => 0,
        }
    };
    ring.iter().zip(next).map(step).sum()
}

struct Ring {
    points: Vec<DVec2>,
    low: DVec2,
    high: DVec2,
    doubled: f64,
    hole: bool,
}

impl Ring {
    fn around(&self, point: DVec2) -> i32 {
        let inside = point.cmpge(self.low).all() && point.cmple(self.high).all();
        if inside {
            winding(&self.points, point)
        } else {
            0
        }
    }
}

impl Part {
    /// Its outlines as polygons with holes, curves flattened to `tolerance` in units of the drawing. They come in the order of the outlines;
    /// those of fewer than three points are left out. A hole outside of every outline becomes an outline of its own.
    #[must_use]
    pub fn polygons(&self, tolerance: f64) -> Vec<Polygon> {
        let rings = self
            .contours
            .iter()
            .map(|contour| contour.flatten(tolerance));
        let mut rings: Vec<Ring> = rings
            .filter(|ring| ring.len() > 2)
            .map(|points| Ring {
                low: points.iter().copied().fold(points[0], DVec2::min),
                high: points.iter().copied().fold(points[0], DVec2::max),
                doubled: doubled_area(&points),
                hole: false,
                points,
            })
            .collect();
        let holes: Vec<bool> = (0..rings.len()).map(|i| self.is_hole(&rings, i)).collect();
        for (ring, hole) in rings.iter_mut().zip(holes) {
            ring.hole = hole;
        }
        let owner = |hole: &Ring| {
            let outer = rings.iter().enumerate().filter(|(_, ring)| !ring.hole);
            let around = outer.filter(|(_, ring)| ring.around(hole.points[0]) != 0);
            let smallest = around.min_by(|a, b| a.1.doubled.abs().total_cmp(&b.1.doubled.abs()));
            smallest.map(|(i, _)| i)
        };
        let owners: Vec<Option<usize>> = rings
            .iter()
            .map(|ring| ring.hole.then(|| owner(ring)).flatten())
            .collect();
        let mut polygons: Vec<(usize, Polygon)> = Vec::new();
        let mut place = vec![0; rings.len()];
        for (i, ring) in rings.iter().enumerate() {
            if owners[i].is_none() {
                place[i] = polygons.len();
                let outer = directed(ring, true);
                polygons.push((
                    i,
                    Polygon {
                        outer,
                        holes: Vec::new(),
                    },
                ));
            }
        }
        for (ring, owner) in rings.iter().zip(&owners) {
            if let Some(owner) = owner {
                polygons[place[*owner]].1.holes.push(directed(ring, false));
            }
        }
        polygons.into_iter().map(|(_, polygon)| polygon).collect()
    }

    fn is_hole(&self, rings: &[Ring], own: usize) -> bool {
        let point = rings[own].points[0];
        let others = rings.iter().enumerate().filter(|(i, _)| *i != own);
        let around = others.map(|(_, ring)| ring.around(point));
        match self.rule {
            Rule::EvenOdd => around.filter(|winding| *winding != 0).count() % 2 == 1,
            Rule::NonZero => {
                let around: i32 = around.sum();
                let direction = if rings[own].doubled < 0.0 { -1 } else { 1 };
                around != 0 && around + direction == 0
            }
        }
    }
}

fn directed(ring: &Ring, positive: bool) -> Vec<DVec2> {
    let mut points = ring.points.clone();
    if (ring.doubled < 0.0) == positive && ring.doubled != 0.0 {
        // The first point stays the first.
        points[1..].reverse();
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::dvec2;

    fn square(x: f64, side: f64, positive: bool) -> Vec<DVec2> {
        let mut ring = vec![
            dvec2(x, x),
            dvec2(x + side, x),
            dvec2(x + side, x + side),
            dvec2(x, x + side),
        ];
        if !positive {
            ring.reverse();
        }
        ring
    }

    #[test]
    fn holes_islands_and_directions() {
        // An island in a hole; the hole comes first, and directions are mixed.
        let rings = [
            square(2.0, 6.0, true),
            square(0.0, 10.0, false),
            square(4.0, 1.0, true),
        ];
        let mut part = Part::of_rings("p", None, rings);
        part.rule = Rule::EvenOdd;
        let polygons = part.polygons(1.0);
        assert_eq!(polygons.len(), 2);
        assert_eq!(polygons[0].holes.len(), 1);
        assert!(doubled_area(&polygons[0].outer) == 200.0);
        assert!(doubled_area(&polygons[0].holes[0]) == -72.0);
        assert_eq!((polygons[1].outer.len(), polygons[1].holes.len()), (4, 0));
    }

    #[test]
    fn the_rule_decides_what_is_a_hole() {
        for (inner_positive, holes) in [(true, 0), (false, 1)] {
            let rings = [square(0.0, 10.0, true), square(2.0, 6.0, inner_positive)];
            let part = Part::of_rings("p", None, rings);
            let polygons = part.polygons(1.0);
            assert_eq!(polygons[0].holes.len(), holes);
            assert_eq!(polygons.len(), 2 - holes);
        }
    }

    #[test]
    fn a_lone_hole_and_specks_do_not_get_lost_or_in_the_way() {
        let rings = [square(0.0, 2.0, false), vec![dvec2(9.0, 9.0)]];
        let polygons = Part::of_rings("p", None, rings).polygons(1.0);
        assert_eq!(polygons.len(), 1);
        assert!(doubled_area(&polygons[0].outer) > 0.0);
    }
}
