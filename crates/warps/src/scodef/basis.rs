//! The functions about a constraint point: 1 there, 0 from a radius on, and C² everywhere.
//!
//! Computes the cubic B-spline with the knots −1, −½, 0, ½, 1 over its value at 0, which is `2(1 − u)³ − (1 − 2u)³` up to ½ and
//! `2(1 − u)³` up to 1, of the distance over the radius, or as a product of one for each axis.
//!
//! *Source*: P. Borrel, A. Rappoport, *Simple Constrained Deformations for Geometric Modeling and Interactive Design*, ACM TOG
//! 13(2), 1994, §3 (B-splines of the distance); P. Borrel, D. Bechmann, *Deformation of N-dimensional Objects*, 1991, and
//! D. Bechmann, *Space Deformation Models Survey*, Computers & Graphics 18(4), 1994 (tensor products of B-splines).

use anamorph_core::{Bounds, Space, Support};

/// The function about a constraint point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Basis<S> {
    /// A cubic B-spline of the distance.
    BSpline {
        /// The distance from which on it is 0, in scene units.
        radius: f64,
    },
    /// A product of cubic B-splines along the axes.
    Box {
        /// The distance along each axis from which on it is 0, in scene units.
        radii: S,
    },
}

/// The spline at a share of the radius that is not negative.
#[inline]
fn spline(u: f64) -> f64 {
    if u < 0.5 {
        1.0 - 6.0 * (u * u) * (1.0 - u)
    } else if u < 1.0 {
        let rest = 1.0 - u;
        2.0 * (rest * rest * rest)
    } else {
        0.0
    }
}

/// Its derivative.
fn spline_slope(u: f64) -> f64 {
    if u < 0.5 {
        u * (18.0 * u - 12.0)
    } else if u < 1.0 {
        let rest = 1.0 - u;
        -6.0 * (rest * rest)
    } else {
        0.0
    }
}

/// The largest of `|spline′|`, at a third.
const STEEPEST: f64 = 2.0;

impl<S: Space> Basis<S> {
    /// How far it reaches along each axis.
    pub fn extents(&self) -> S {
        match *self {
            Self::BSpline { radius } => S::splat(radius),
            Self::Box { radii } => radii,
        }
    }

    /// The first radius that is not a positive, finite number.
    pub(super) fn flaw(&self) -> Option<f64> {
        let extents = self.extents();
        let mut all = (0..S::DIM).map(|axis| extents.component(axis));
        all.find(|r| !(*r > 0.0 && r.is_finite()))
    }

    /// Shares of the radii, or nothing out of reach.
    #[inline]
    fn shares(&self, from_centre: S) -> Option<S> {
        let extents = self.extents();
        let within = |axis: usize| from_centre.component(axis).abs() < extents.component(axis);
        if !(0..S::DIM).all(within) {
            return None;
        }
        Some(S::from_fn(|axis| {
            from_centre.component(axis) / extents.component(axis)
        }))
    }

    /// The value at an offset from the point.
    #[inline]
    pub fn value(&self, from_centre: S) -> f64 {
        let Some(shares) = self.shares(from_centre) else {
            return 0.0;
        };
        match self {
            Self::BSpline { .. } => spline(shares.dot(shares).sqrt()),
            Self::Box { .. } => (0..S::DIM).fold(1.0, |product, axis| {
                product * spline(shares.component(axis).abs())
            }),
        }
    }

    /// The gradient at an offset from the point, per scene unit.
    pub fn gradient(&self, from_centre: S) -> S {
        let Some(shares) = self.shares(from_centre) else {
            return S::ZERO;
        };
        match *self {
            Self::BSpline { radius } => {
                let u = shares.dot(shares).sqrt();
                if u == 0.0 {
                    return S::ZERO;
                }
                shares * (spline_slope(u) / u / radius)
            }
            Self::Box { radii } => S::from_fn(|along| {
                (0..S::DIM).fold(1.0, |product, axis| {
                    let share = shares.component(axis);
                    product
                        * if axis == along {
                            spline_slope(share.abs()).copysign(-share) / radii.component(axis)
                        } else {
                            spline(share.abs())
                        }
                })
            }),
        }
    }

    /// A bound of the gradient's length.
    pub(super) fn steepest(&self) -> f64 {
        match *self {
            Self::BSpline { radius } => STEEPEST / radius,
            Self::Box { radii } => S::from_fn(|axis| STEEPEST / radii.component(axis)).length(),
        }
    }

    /// Where it is not 0, about a point.
    pub(super) fn support(&self, centre: S) -> Support<S> {
        match *self {
            Self::BSpline { radius } => Support::Ball { centre, radius },
            Self::Box { radii } => Support::Box(Bounds::new(centre - radii, centre + radii)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::{Plane, Solid, glam::dvec2, glam::dvec3};

    #[test]
    fn the_spline_is_twice_continuous_and_the_b_spline_of_its_knots() {
        // By truncated powers, over the value at 0.
        let power = |x: f64| x.max(0.0).powi(3);
        for i in 0..=120 {
            let u = f64::from(i) / 100.0;
            let terms = [
                (1.0, 1.0),
                (-4.0, 0.5),
                (6.0, 0.0),
                (-4.0, -0.5),
                (1.0, -1.0),
            ];
            let sum: f64 = terms.iter().map(|(c, k)| c * power(k - u)).sum();
            assert!((spline(u) - 2.0 * sum).abs() < 1e-14, "{u}");
            assert!(spline_slope(u).abs() < STEEPEST + 1e-15);
        }
        assert_eq!(spline(0.0), 1.0);
        assert_eq!(spline(1.0), 0.0);
        assert!((spline_slope(1.0 / 3.0) + STEEPEST).abs() < 1e-15);
        let h = 1e-4;
        for knot in [0.5, 1.0] {
            let second = |u: f64| (spline_slope(u + h) - spline_slope(u - h)) / (2.0 * h);
            let jump = second(knot + 2.0 * h) - second(knot - 2.0 * h);
            assert!(jump.abs() < 0.05, "{knot}: {jump}");
        }
    }

    fn gradient_is_that_of_differences<S: Space>(all: &[Basis<S>]) {
        for basis in all {
            for i in 0..60 {
                let d = S::from_fn(|axis| 0.9 * f64::from(i * (axis as i32 + 2) % 7 - 3) / 3.0);
                let h = 1e-6;
                for axis in 0..S::DIM {
                    let at = |h: f64| basis.value(d + S::unit(axis) * h);
                    let slope = (at(h) - at(-h)) / (2.0 * h);
                    let claimed = basis.gradient(d).component(axis);
                    assert!((slope - claimed).abs() < 1e-8, "{basis:?} at {d:?}");
                }
                assert!(basis.gradient(d).length() <= basis.steepest());
            }
        }
    }

    #[test]
    fn gradients_are_those_of_the_values() {
        gradient_is_that_of_differences(&[
            Basis::BSpline { radius: 1.3 },
            Basis::Box {
                radii: dvec2(0.8, 2.0),
            },
        ]);
        gradient_is_that_of_differences(&[
            Basis::BSpline { radius: 0.9 },
            Basis::Box {
                radii: dvec3(0.7, 1.1, 2.0),
            },
        ]);
    }

    #[test]
    fn what_is_out_of_reach_has_no_value() {
        let ball = Basis::<Plane>::BSpline { radius: 2.0 };
        assert_eq!(ball.value(dvec2(1.5, 1.5)), 0.0);
        assert_eq!(ball.value(dvec2(0.0, 2.0)), 0.0);
        assert!(ball.value(dvec2(1.9, 0.0)) > 0.0);
        let cuboid = Basis::<Solid>::Box {
            radii: dvec3(1.0, 2.0, 3.0),
        };
        assert!(cuboid.value(dvec3(0.9, -1.9, 2.9)) > 0.0);
        assert_eq!(cuboid.value(dvec3(1.0, 0.0, 0.0)), 0.0);
        assert_eq!(cuboid.value(dvec3(0.0, 0.0, f64::INFINITY)), 0.0);
        assert_eq!(cuboid.value(dvec3(0.5, -1.0, 1.5)), 0.25 * 0.25 * 0.25);
        assert_eq!(cuboid.gradient(dvec3(0.0, 5.0, 0.0)), Solid::ZERO);
    }
}
