//! Squared distances from planes and lines, added up; and how far a vertex's part of the surface spreads.
//!
//! *Source*: M. Garland and P. S. Heckbert, *Surface Simplification Using Quadric Error Metrics*, SIGGRAPH 1997, §4–5, §6
//! (borders); the singular case after P. Lindstrom, *Out-of-Core Simplification of Large Polygonal Models*, SIGGRAPH 2000,
//! §4.2: directions that the planes leave open are settled by the middle of the surface that the vertex stands for.

use anamorph_core::glam::DVec3;

/// A border counts as much as a face with an area of that many squares over it.
const BORDER: f64 = 10.0;

/// How much the spread of a vertex's part of the surface counts beside its distance from the planes. It keeps the edges of
/// flat regions even, and yields to a bend whose height is more than about a thirtieth of its width.
const SPREAD: f64 = 1e-3;

/// Directions along which the planes say less than this share of what they say along another are open: crossings that
/// are real first; then only those steeper than some two degrees, for flatter ones may lie far away.
const OPEN: [f64; 2] = [1e-8, 1e-3];

/// A symmetric matrix: its diagonal, and `[yz, zx, xy]`.
#[derive(Debug, Clone, Copy, Default)]
struct Symmetric {
    diagonal: DVec3,
    rest: DVec3,
}

impl Symmetric {
    fn square(v: DVec3, weight: f64) -> Self {
        Self {
            diagonal: v * v * weight,
            rest: DVec3::new(v.y * v.z, v.z * v.x, v.x * v.y) * weight,
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            diagonal: self.diagonal + other.diagonal,
            rest: self.rest + other.rest,
        }
    }

    fn times(self, v: DVec3) -> DVec3 {
        let Self {
            diagonal: d,
            rest: r,
        } = self;
        DVec3::new(
            d.x * v.x + r.z * v.y + r.y * v.z,
            r.z * v.x + d.y * v.y + r.x * v.z,
            r.y * v.x + r.x * v.y + d.z * v.z,
        )
    }

    /// Its eigenvalues and eigenvectors, by rotations that take away one entry off the diagonal each (C. G. J. Jacobi, 1846).
    fn eigen(self) -> [(f64, DVec3); 3] {
        let (d, r) = (self.diagonal.to_array(), self.rest.to_array());
        let mut m = [[d[0], r[2], r[1]], [r[2], d[1], r[0]], [r[1], r[0], d[2]]];
        let mut vectors = [DVec3::X, DVec3::Y, DVec3::Z];
        for _ in 0..32 {
            let off = m[0][1].abs() + m[0][2].abs() + m[1][2].abs();
            let on = m[0][0].abs() + m[1][1].abs() + m[2][2].abs();
            // Written so that an entry that is not a number ends it.
            let more = off > on * 1e-17;
            if !more {
                break;
            }
            for (p, q) in [(0, 1), (0, 2), (1, 2)] {
                if m[p][q] == 0.0 {
                    continue;
                }
                let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                let k = 3 - p - q;
                let (mpq, mkp, mkq) = (m[p][q], m[k][p], m[k][q]);
                m[p][p] -= t * mpq;
                m[q][q] += t * mpq;
                (m[p][q], m[q][p]) = (0.0, 0.0);
                let (kp, kq) = (c * mkp - s * mkq, s * mkp + c * mkq);
                (m[k][p], m[p][k]) = (kp, kp);
                (m[k][q], m[q][k]) = (kq, kq);
                let (vp, vq) = (vectors[p], vectors[q]);
                vectors[p] = vp * c - vq * s;
                vectors[q] = vp * s + vq * c;
            }
        }
        [0, 1, 2].map(|k| (m[k][k], vectors[k]))
    }
}

/// Squared distances from planes and lines as a function of the difference `d` from a reference place, the vertex that
/// has the quadric: `dᵀA d + 2 b·d + c`; with mass, centroid and spread of the surface that the vertex stands for.
///
/// Differences keep the digits that coordinates far from the origin would lose.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Quadric {
    a: Symmetric,
    b: DVec3,
    c: f64,
    mass: f64,
    /// Seen from the reference place.
    centroid: DVec3,
    /// The sum of mass times squared distance from the centroid.
    spread: f64,
}

impl Quadric {
    /// A corner of a face: its plane and a third of its area, by twice the area times the normal.
    pub(super) fn of_corner(area_vector: DVec3) -> Self {
        let twice = area_vector.length();
        if twice <= 0.0 {
            return Self::default();
        }
        let third = twice / 6.0;
        Self {
            a: Symmetric::square(area_vector / twice, third),
            mass: third,
            ..Self::default()
        }
    }

    /// An end of an edge at the border: the line along it.
    pub(super) fn of_border(edge: DVec3) -> Self {
        let square = edge.length_squared();
        if square <= 0.0 {
            return Self::default();
        }
        let weight = BORDER * square;
        let all = Symmetric {
            diagonal: DVec3::splat(weight),
            rest: DVec3::ZERO,
        };
        Self {
            a: all.plus(Symmetric::square(edge / square.sqrt(), -weight)),
            ..Self::default()
        }
    }

    /// The same function seen from the reference place plus `by`.
    pub(super) fn seen_from(self, by: DVec3) -> Self {
        let slope = self.a.times(by);
        Self {
            b: self.b + slope,
            c: (self.c + 2.0 * self.b.dot(by) + slope.dot(by)).max(0.0),
            centroid: self.centroid - by,
            ..self
        }
    }

    /// Both together; they must be seen from the same place.
    pub(super) fn plus(self, other: Self) -> Self {
        let mass = self.mass + other.mass;
        let share = if mass > 0.0 { other.mass / mass } else { 0.5 };
        let apart = other.centroid - self.centroid;
        Self {
            a: self.a.plus(other.a),
            b: self.b + other.b,
            c: self.c + other.c,
            mass,
            centroid: self.centroid + apart * share,
            spread: self.spread + other.spread + self.mass * share * apart.length_squared(),
        }
    }

    /// What it costs to have the vertex at a difference from the reference place.
    pub(super) fn cost(self, d: DVec3) -> f64 {
        let planes = (self.a.times(d) + 2.0 * self.b).dot(d) + self.c;
        let spread = self.mass * (d - self.centroid).length_squared() + self.spread;
        planes.max(0.0) + SPREAD * spread
    }

    /// The difference that is nearest to the planes, and in directions that they leave open to the centroid; none if it is
    /// farther than `reach`.
    pub(super) fn best(self, reach: f64) -> Option<DVec3> {
        let eigen = self.a.eigen();
        let largest = eigen.iter().map(|e| e.0).fold(0.0, f64::max);
        let within = |open: f64| {
            let best: DVec3 = eigen
                .iter()
                .map(|&(value, vector)| {
                    if value > open * largest {
                        vector * (-vector.dot(self.b) / value)
                    } else {
                        vector * vector.dot(self.centroid)
                    }
                })
                .sum();
            // Also false for what is not a number.
            (best.length() <= reach).then_some(best)
        };
        OPEN.into_iter().find_map(within)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;
    use anamorph_core::glam::dvec3;

    #[test]
    fn eigenvectors_diagonalize() {
        let mut random = Random::new(11);
        for round in 0..500 {
            let mut m = Symmetric::default();
            for _ in 0..1 + round % 4 {
                let weight = random.between(0.0, 2.0);
                m = m.plus(Symmetric::square(random.vector(), weight));
            }
            let eigen = m.eigen();
            for (i, (value, vector)) in eigen.iter().enumerate() {
                assert!((vector.length() - 1.0).abs() < 1e-14);
                assert!((m.times(*vector) - *vector * *value).length() < 1e-14);
                for (_, other) in &eigen[..i] {
                    assert!(vector.dot(*other).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn costs_are_squared_distances_seen_from_anywhere() {
        let mut random = Random::new(12);
        for _ in 0..200 {
            let (place, normal) = (random.vector(), random.vector());
            let border = random.vector();
            let point = random.vector();
            let own = Quadric::of_corner(normal).plus(Quadric::of_border(border));
            let seen = own.seen_from(point - place);
            let (area, off) = (normal.length() / 6.0, point - place);
            let across = off - off.project_onto(border);
            let expected = area * off.dot(normal.normalize()).powi(2)
                + BORDER * border.length_squared() * across.length_squared()
                + SPREAD * area * off.length_squared();
            assert!((own.cost(off) - expected).abs() < 1e-12);
            assert!((seen.cost(DVec3::ZERO) - expected).abs() < 1e-12);
            let further = random.vector();
            assert!((own.cost(off + further) - seen.cost(further)).abs() < 1e-11);
        }
    }

    #[test]
    fn the_best_place_is_where_planes_cross_or_in_the_middle() {
        // Three planes through a corner, seen from three places.
        let corner = dvec3(0.3, -0.2, 0.7);
        let planes = [DVec3::X, DVec3::Y, dvec3(1.0, 1.0, 2.0)];
        let all = planes
            .iter()
            .map(|&n| Quadric::of_corner(n).seen_from(-corner))
            .fold(Quadric::default(), Quadric::plus);
        assert!(all.best(10.0).expect("a corner").distance(corner) < 1e-14);
        assert_eq!(all.best(0.1), None);
        // Twice the same plane, from two of its places: between them.
        let [a, b] = [dvec3(1.0, 0.0, 0.5), dvec3(2.0, 3.0, 0.5)];
        let flat = Quadric::of_corner(DVec3::Z).seen_from(-a);
        let flat = flat.plus(Quadric::of_corner(DVec3::Z).seen_from(-b));
        assert!(flat.best(10.0).expect("a place").distance((a + b) / 2.0) < 1e-15);
    }
}
