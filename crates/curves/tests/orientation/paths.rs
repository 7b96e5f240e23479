//! Paths that are hard in some way, and what tests of frames ask of them.

use anamorph_core::glam::{DMat3, DQuat, DVec3, dvec3};
use anamorph_core::{Curve, Differentiable, Jet, Solid};
use anamorph_curves::families::{BSpline, CatmullRom, CubicBezier, Generator, Knots};
use anamorph_curves::orientation::registry::{SharedPath, Value};
use anamorph_curves::orientation::{End, Frame, Orienter, RotationMinimizing};
use anamorph_curves::{ArcLength, LengthTable, PiecewiseCubic};
use core::f64::consts::TAU;
use std::sync::Arc;

pub(crate) type Cubics = PiecewiseCubic<Solid>;

pub(crate) fn bezier(points: &[[f64; 3]]) -> Cubics {
    let points = points.iter().map(|p| DVec3::from_array(*p)).collect();
    let closed = false;
    CubicBezier { points, closed }.curve().unwrap()
}

pub(crate) fn polyline(points: &[[f64; 3]], closed: bool) -> Cubics {
    let spline = BSpline {
        points: points.iter().map(|p| DVec3::from_array(*p)).collect(),
        degree: 1,
        knots: if closed {
            Knots::Uniform
        } else {
            Knots::Clamped
        },
        closed,
    };
    spline.curve().unwrap()
}

/// A closed curve through samples of a function of the angle.
pub(crate) fn around(count: usize, point: impl Fn(f64) -> DVec3) -> Cubics {
    let points = (0..count).map(|i| point(TAU * i as f64 / count as f64));
    let curve = CatmullRom::new(points.collect());
    CatmullRom {
        closed: true,
        ..curve
    }
    .curve()
    .unwrap()
}

pub(crate) fn trefoil() -> Cubics {
    around(48, |t| {
        let (s, c) = t.sin_cos();
        let (s2, c2) = (2.0 * t).sin_cos();
        dvec3(s + 2.0 * s2, c - 2.0 * c2, -(3.0 * t).sin())
    })
}

pub(crate) fn figure_eight() -> Cubics {
    around(32, |t| dvec3(t.sin(), 0.2 * t.cos(), (2.0 * t).sin()))
}

pub(crate) fn tilted_circle() -> Cubics {
    around(24, |t| {
        let tilt = DQuat::from_axis_angle(dvec3(1.0, 2.0, -0.5).normalize(), 1.1);
        tilt * dvec3(t.cos(), t.sin(), 0.0) * 3.0 + dvec3(1.0, 2.0, 3.0)
    })
}

pub(crate) fn space_curve() -> Cubics {
    bezier(&[[0., 0., 0.], [2., 2., 0.3], [1., -2., 1.], [3., 0., 0.5]])
}

pub(crate) fn s_curve() -> Cubics {
    bezier(&[[0., 0., 0.], [2., 0., 2.], [2., 0., -2.], [4., 0., 0.]])
}

/// Curves that are hard in some way, by name.
pub(crate) fn hard() -> Vec<(&'static str, Cubics)> {
    let straight = [[0., 0., 0.], [1., 0., 1.], [2., 0., 2.], [3., 0., 3.]];
    let twice = |p: [f64; 3]| vec![p; 2];
    let mut repeated = vec![[0., 0., 0.], [1., 0., 0.]];
    repeated.extend(twice([1., 1., 0.]));
    repeated.extend(twice([1., 1., 0.]));
    repeated.extend([[1., 1., 1.], [2., 3., 1.]]);
    let repeated = repeated.iter().map(|p| DVec3::from_array(*p)).collect();
    vec![
        ("space", space_curve()),
        ("inflection", s_curve()),
        ("straight", bezier(&straight)),
        ("straight up", bezier(&straight.map(|p| [0., p[0], 0.]))),
        ("straight down", bezier(&straight.map(|p| [0., -p[0], 0.]))),
        (
            "cusp",
            bezier(&[[0., 0., 0.], [2., 2., 0.], [0., 2., 0.], [2., 0., 0.]]),
        ),
        (
            "near cusp",
            bezier(&[[0., 0., 0.], [2., 2., 0.], [1e-9, 2., 1e-9], [2., 0., 0.]]),
        ),
        (
            "straight back",
            bezier(&[[0., 0., 0.], [3., 0., 1.], [3., 0., 1.], [0., 0., 0.]]),
        ),
        (
            "stops at its ends",
            bezier(&[[0., 0., 0.], [0., 0., 0.], [1., 2., 3.], [1., 2., 3.]]),
        ),
        (
            "repeated points",
            CatmullRom::new(repeated).curve().unwrap(),
        ),
        (
            "corners",
            polyline(
                &[
                    [0., 0., 0.],
                    [0., 0., 1.],
                    [0., 1., 1.],
                    [1., 1., 1.],
                    [1., 1., -2.],
                ],
                false,
            ),
        ),
        (
            "turns back",
            polyline(
                &[[0., 0., 0.], [0., 0., 1.], [0., 0., -1.], [0., 2., -1.]],
                false,
            ),
        ),
        (
            "rests",
            polyline(
                &[
                    [0., 0., 0.],
                    [0., 0., 0.],
                    [1., 0., 0.],
                    [1., 0., 0.],
                    [1., 1., 0.],
                    [1., 1., 0.],
                ],
                false,
            ),
        ),
        (
            "closed corners",
            polyline(
                &[[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [1., 1., 1.]],
                true,
            ),
        ),
        ("trefoil", trefoil()),
        ("figure eight", figure_eight()),
        ("tilted circle", tilted_circle()),
        (
            "far away",
            bezier(&[
                [1e8, 0., 0.],
                [1e8 + 1., 2., 0.],
                [1e8 + 2., -2., 1.],
                [1e8 + 3., 0., 1.],
            ]),
        ),
        (
            "tiny",
            bezier(&[
                [0., 0., 0.],
                [1e-150, 2e-150, 0.],
                [2e-150, -2e-150, 1e-150],
                [3e-150, 0., 0.],
            ]),
        ),
        (
            "huge",
            bezier(&[
                [0., 0., 0.],
                [1e90, 2e90, 0.],
                [2e90, -2e90, 1e90],
                [3e90, 0., 0.],
            ]),
        ),
    ]
}

pub(crate) fn shared(curve: &Cubics) -> SharedPath {
    Arc::new(curve.clone())
}

/// Settings with which each orientation works.
pub(crate) fn settings(name: &str, path: &Cubics) -> Vec<(String, Value)> {
    let set = |name: &str, value| vec![(name.to_owned(), value)];
    match name {
        "look-ahead" => set("distance", Value::Number(0.3)),
        "look-at" => set("target", Value::Vector(dvec3(0.5, 0.25, 0.0))),
        "auxiliary" => set("curve", Value::Curve(Arc::new(path.reversed()))),
        _ => Vec::new(),
    }
}

/// Parameters all over the domain, breaks, neighbours of breaks, and beyond.
pub(crate) fn parameters(curve: &Cubics) -> Vec<f64> {
    let (a, b) = curve.domain();
    let mut list: Vec<f64> = (0..=256)
        .map(|i| a + (b - a) * f64::from(i) / 256.0)
        .collect();
    for at in curve.breaks() {
        list.extend([at.next_down(), at, at.next_up(), at + 1e-9, at - 1e-9]);
    }
    list.extend([
        a - 1.0,
        b + 1.0,
        b + 0.3,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        1e300,
    ]);
    list
}

pub(crate) fn assert_sound(frame: &Frame, what: &str) {
    let m = frame.to_matrix();
    let off = m.transpose() * m - DMat3::IDENTITY;
    let largest = off
        .to_cols_array()
        .iter()
        .fold(0.0_f64, |l, e| l.max(e.abs()));
    assert!(largest < 1e-12, "{what}: {frame:?}");
    assert!((m.determinant() - 1.0).abs() < 1e-12, "{what}: {frame:?}");
    assert_eq!(frame.side(), frame.up().cross(frame.forward()), "{what}");
}

pub(crate) fn close(a: &Frame, b: &Frame) -> f64 {
    (a.forward() - b.forward())
        .length()
        .max((a.up() - b.up()).length())
}

/// `count` + 1 parameters evenly over the domain.
pub(crate) fn even<C: Curve<Solid> + ?Sized>(curve: &C, count: usize) -> Vec<f64> {
    let (a, b) = curve.domain();
    (0..=count)
        .map(|i| {
            if i == count {
                b
            } else {
                a + (b - a) * i as f64 / count as f64
            }
        })
        .collect()
}

/// An exact helix of radius `r` that climbs `h` a radian; its curvature is `r/(r² + h²)`, its torsion `h/(r² + h²)`.
pub(crate) struct Helix {
    pub(crate) r: f64,
    pub(crate) h: f64,
    pub(crate) turns: f64,
}

impl Curve<Solid> for Helix {
    fn domain(&self) -> (f64, f64) {
        (0.0, TAU * self.turns)
    }
    fn point(&self, u: f64) -> Solid {
        self.jet(u).point
    }
}

impl Differentiable<Solid> for Helix {
    fn jet(&self, u: f64) -> Jet<Solid> {
        let u = self.within(u);
        let (s, c) = u.sin_cos();
        let (r, h) = (self.r, self.h);
        Jet {
            point: dvec3(r * c, r * s, h * u),
            first: dvec3(-r * s, r * c, h),
            second: dvec3(-r * c, -r * s, 0.0),
            third: dvec3(r * s, -r * c, 0.0),
        }
    }
    fn breaks(&self) -> Vec<f64> {
        vec![0.0, TAU * self.turns]
    }
}

impl ArcLength<Solid> for Helix {
    fn length_between(&self, start: f64, end: f64, _: f64) -> f64 {
        self.r.hypot(self.h) * (self.within(end) - self.within(start))
    }
}

#[test]
fn closed_paths_close_with_twist_spread_evenly() {
    for (name, curve) in [
        ("figure eight", figure_eight()),
        ("trefoil", trefoil()),
        ("circle", tilted_circle()),
        ("corners", hard().remove(13).1),
    ] {
        let (a, b) = curve.domain();
        let free = RotationMinimizing {
            end: End::Free,
            ..RotationMinimizing::default()
        }
        .along(&curve)
        .unwrap();
        let closed = RotationMinimizing::default().along(&curve).unwrap();
        let leftover = free.leftover().unwrap();
        assert!(
            (free.frame(a).twist_to(&free.frame(b)) - leftover).abs() < 1e-12,
            "{name}"
        );
        assert!((closed.added_twist() + leftover).abs() < 1e-12, "{name}");
        match name {
            "circle" => assert!(leftover.abs() < 1e-9, "{leftover:e}"),
            "trefoil" | "figure eight" => assert!(leftover.abs() > 0.01, "{name}: {leftover}"),
            _ => {}
        }
        assert_eq!(closed.frame(a), closed.frame(b), "{name}");
        if name != "corners" {
            let seam = close(&closed.frame(b - 1e-10), &closed.frame(a));
            assert!(seam < 3e-9, "{name}: {seam:e}");
        }
        // Equal lengths take back equal twist.
        let table = LengthTable::new(&curve, 1e-11).unwrap();
        for u in even(&curve, 50).into_iter().take(50) {
            let back = free.frame(u).twist_to(&closed.frame(u));
            let share = table.length_to(u) / table.length();
            assert!((back + leftover * share).abs() < 3e-9, "{name} at {u}");
        }
        // With whole turns it closes as well, and turns that often.
        let turned = RotationMinimizing {
            turns: -2,
            ..RotationMinimizing::default()
        }
        .along(&curve)
        .unwrap();
        assert!((turned.added_twist() + leftover + 2.0 * TAU).abs() < 1e-12);
        assert_eq!(turned.frame(a), turned.frame(b));
        assert!(
            name == "corners" || close(&turned.frame(b - 1e-10), &turned.frame(a)) < 1e-8,
            "{name}"
        );
    }
    // A path that only comes back is open.
    let open = s_curve();
    assert_eq!(
        RotationMinimizing::default()
            .along(&open)
            .unwrap()
            .leftover(),
        None
    );
}
