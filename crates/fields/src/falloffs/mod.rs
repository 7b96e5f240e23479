//! Falloffs: how influence fades with relative distance.
//!
//! A falloff is a function `f(t)` of `t = d/r ≥ 0`, the distance to a feature over a radius: 1 at the feature, not
//! increasing, and for the compact ones 0 from `t = 1` on. One file per falloff, one line per falloff in [`FALLOFFS`].
//!
//! *Source*: Milliron et al. 2002, §3.2 and §8.5 (falloffs and their continuity); K. Singh and E. Fiume, *Wires: A
//! Geometric Deformation Technique*, SIGGRAPH 1998. The continuity classes are derived in each file.

mod cosine;
mod fab;
mod gaussian;
mod inverse_distance;
mod linear;
mod smootherstep;
mod smoothstep;
mod wires;

pub use cosine::Cosine;
pub use fab::Fab;
pub use gaussian::Gaussian;
pub use inverse_distance::InverseDistance;
pub use linear::Linear;
pub use smootherstep::Smootherstep;
pub use smoothstep::Smoothstep;
pub use wires::Wires;

use anamorph_core::Smoothness;

/// What is known about a falloff.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FalloffFacts {
    /// Its name in recipes and lists.
    pub name: &'static str,
    /// The `t` from which on it is exactly 0; `None` if it never is.
    pub reach: Option<f64>,
    /// Class of `x ↦ f(|x|)` as a function of the plane or space inside the reach, the centre included: that of the even
    /// function `f(|t|)`. Where `f` is infinite at the centre, the class of `1/f`, on which normalized weights depend.
    pub centre: Smoothness,
    /// Class of the step that is 1 up to `t = 0` and `f(t)` from there, inside the reach.
    pub start: Smoothness,
    /// Class at the reach, where `f` meets 0; [`Smoothness::Smooth`] if it has no reach.
    pub edge: Smoothness,
}

/// A falloff `f(t)` of relative distance `t = d/r ≥ 0`.
pub trait Falloff: core::fmt::Debug + Send + Sync {
    /// `f(t)` for `t ≥ 0`: 1 at 0 (a plateau or infinity where the type says so), never increasing, never NaN for a
    /// number.
    fn value(&self, t: f64) -> f64;
    /// `f′(t)`; where the left and right derivatives differ, the right one.
    fn derivative(&self, t: f64) -> f64;
    /// Name, reach and continuity.
    fn facts(&self) -> FalloffFacts;

    /// The name in recipes and lists.
    fn name(&self) -> &'static str {
        self.facts().name
    }
    /// The `t` from which on the falloff is exactly 0; `None` if it never is.
    fn reach(&self) -> Option<f64> {
        self.facts().reach
    }
    /// Whether the falloff is exactly 0 from some `t` on.
    fn compact(&self) -> bool {
        self.reach().is_some()
    }
    /// Class of `x ↦ f(|x|/r)` as a function of space, centre and edge included.
    fn smoothness(&self) -> Smoothness {
        let facts = self.facts();
        facts.centre.min(facts.edge)
    }
    /// Class of the step that is 1 on one side, falls by `f` and is 0 on the other.
    fn step_smoothness(&self) -> Smoothness {
        let facts = self.facts();
        facts.start.min(facts.edge)
    }
    /// `f(√q)` for `q = t²`: for falloffs that need no root.
    fn value_of_square(&self, q: f64) -> f64 {
        self.value(q.sqrt())
    }
    /// Replaces every `t` by `f(t)`; equal to [`Falloff::value`] bit for bit.
    fn apply(&self, t: &mut [f64]) {
        for t in t {
            *t = self.value(*t);
        }
    }
    /// Replaces every `q = t²` by `f(t)`; equal to [`Falloff::value_of_square`] bit for bit.
    fn apply_to_squares(&self, q: &mut [f64]) {
        for q in q {
            *q = self.value_of_square(*q);
        }
    }
}

macro_rules! forward_falloff {
    ($($pointer:ty),*) => {$(
        impl<F: Falloff + ?Sized> Falloff for $pointer {
            fn value(&self, t: f64) -> f64 { (**self).value(t) }
            fn derivative(&self, t: f64) -> f64 { (**self).derivative(t) }
            fn facts(&self) -> FalloffFacts { (**self).facts() }
            fn value_of_square(&self, q: f64) -> f64 { (**self).value_of_square(q) }
            fn apply(&self, t: &mut [f64]) { (**self).apply(t) }
            fn apply_to_squares(&self, q: &mut [f64]) { (**self).apply_to_squares(q) }
        }
    )*};
}
forward_falloff!(&F, Box<F>, std::sync::Arc<F>);

/// Every falloff, with its default parameters.
pub static FALLOFFS: &[&dyn Falloff] = &[
    &Wires,
    &Smoothstep,
    &Smootherstep,
    &Fab::DEFAULT,
    &Linear,
    &Cosine,
    &Gaussian::DEFAULT,
    &InverseDistance::DEFAULT,
];

/// The falloff of that name, with its default parameters.
pub fn falloff(name: &str) -> Option<&'static dyn Falloff> {
    FALLOFFS.iter().copied().find(|f| f.name() == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// Every falloff of the registry, and the families at other parameters.
    fn all() -> Vec<Box<dyn Falloff>> {
        let mut all: Vec<Box<dyn Falloff>> = Vec::new();
        for f in FALLOFFS {
            all.push(Box::new(*f));
        }
        for (alpha, beta) in [(0.0, 1.0), (-0.5, 0.9), (0.3, 0.6), (0.2, 1.7)] {
            all.push(Box::new(Fab::new(alpha, beta).unwrap()));
        }
        for steepness in [0.01, 1.0, 20.0, 100.0] {
            all.push(Box::new(Gaussian::new(steepness).unwrap()));
        }
        for power in [0.5, 1.0, 1.5, 3.0, 4.0] {
            all.push(Box::new(InverseDistance::new(power).unwrap()));
        }
        all
    }

    #[test]
    fn names_are_unique_and_found() {
        let names: HashSet<_> = FALLOFFS.iter().map(Falloff::name).collect();
        assert_eq!(names.len(), FALLOFFS.len());
        for f in FALLOFFS {
            assert_eq!(falloff(f.name()).unwrap().facts(), f.facts());
        }
        assert!(falloff("wire").is_none());
    }

    #[test]
    fn from_one_to_zero_and_never_up() {
        for f in all() {
            let name = f.name();
            if f.compact() && f.facts().start != Smoothness::Jump {
                assert_eq!(f.value(0.0), 1.0, "{name}");
            }
            if let Some(reach) = f.reach() {
                for t in [
                    reach,
                    1.0 + 1e-15 + reach,
                    2.0 * reach,
                    1e300,
                    f64::INFINITY,
                ] {
                    assert_eq!(f.value(t), 0.0, "{name} at {t}");
                    assert_eq!(f.derivative(t), 0.0, "{name} at {t}");
                }
                assert!(f.value(0.97 * reach) > 0.0, "{name}");
            }
            let mut last = f.value(0.0);
            for i in 1..=4000 {
                let t = f64::from(i) * 5e-4;
                let v = f.value(t);
                assert!(v <= last + 1e-15 && v >= 0.0, "{name} rises at {t}");
                last = v;
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_values() {
        for f in all() {
            for i in 1..200 {
                let (t, h) = (f64::from(i) * 0.008_37, 1e-6);
                let slope = (f.value(t + h) - f.value(t - h)) / (2.0 * h);
                let error = (f.derivative(t) - slope).abs();
                assert!(error < 1e-5 * (1.0 + slope.abs()), "{} at {t}", f.name());
            }
        }
    }

    #[test]
    fn squares_and_batches_agree() {
        for f in all() {
            let t: Vec<f64> = (0..400).map(|i| f64::from(i) * 0.004).collect();
            let (mut values, mut squares) =
                (t.clone(), t.iter().map(|t| t * t).collect::<Vec<_>>());
            f.apply(&mut values);
            f.apply_to_squares(&mut squares);
            for (i, &t) in t.iter().enumerate() {
                assert_eq!(values[i].to_bits(), f.value(t).to_bits());
                assert_eq!(squares[i].to_bits(), f.value_of_square(t * t).to_bits());
                let relative = (squares[i] - values[i]).abs() / values[i].max(1e-2);
                assert!(
                    values[i] == squares[i] || relative < 1e-13,
                    "{} at {t}",
                    f.name()
                );
            }
        }
    }

    /// Derivatives 0 to 8 of `g` at `t`, from one side: those of the polynomial through nine points beside it.
    fn derivatives(g: &dyn Fn(f64) -> f64, t: f64, side: f64) -> [f64; 9] {
        let h = 0.006;
        let mut c: [f64; 9] = core::array::from_fn(|i| g(t + side * h * i as f64));
        for order in 1..9 {
            for i in (order..9).rev() {
                c[i] = (c[i] - c[i - 1]) / order as f64;
            }
        }
        // Newton's form in the unit u = (x − t)/h to plain powers.
        for start in (0..8).rev() {
            for i in start..8 {
                c[i] -= c[i + 1] * start as f64;
            }
        }
        let mut factor = 1.0;
        core::array::from_fn(|i| {
            if i > 0 {
                factor *= i as f64 / (side * h);
            }
            c[i] * factor
        })
    }

    /// The class of a function whose derivatives jump by `jumps`; classes above C⁴ are out of the differences' sight.
    fn class(jumps: impl Iterator<Item = f64>) -> Smoothness {
        for (order, jump) in jumps.take(5).enumerate() {
            if jump.abs() > 0.05 {
                return match order {
                    0 => Smoothness::Jump,
                    n => Smoothness::C(n as u8 - 1),
                };
            }
        }
        Smoothness::Smooth
    }

    #[test]
    fn classes_are_as_stated_and_not_better() {
        for f in all() {
            let facts = f.facts();
            let infinite = f.value(0.0).is_infinite();
            let g = |t: f64| {
                if infinite {
                    1.0 / f.value(t)
                } else {
                    f.value(t)
                }
            };
            if facts.name == "gaussian" && g(0.5) < 2e-2 {
                continue; // So steep that its edge is below what differences see.
            }
            let at_centre = derivatives(&g, 0.0, 1.0);
            // The even function's odd derivatives must vanish.
            let even = at_centre.iter().enumerate();
            let mut centre = class(even.map(|(i, d)| if i % 2 == 1 { *d } else { 0.0 }));
            let first = if infinite {
                f64::INFINITY
            } else {
                at_centre[0] - 1.0
            };
            let rest = at_centre[1..].iter().copied();
            let mut start = class(core::iter::once(first).chain(rest));
            for joint in (1..40).map(|i| f64::from(i) * 0.05) {
                if facts.reach.is_some_and(|reach| joint > reach - 0.06) {
                    break;
                }
                let (left, right) = (derivatives(&g, joint, -1.0), derivatives(&g, joint, 1.0));
                let inside = class(
                    left.iter()
                        .zip(right)
                        .map(|(l, r)| (l - r) / (1.0 + r.abs())),
                );
                centre = centre.min(inside);
                start = start.min(inside);
            }
            let stated = (facts.centre, facts.start);
            assert_eq!((centre, start), stated, "{f:?}");
            if let Some(reach) = facts.reach {
                let edge = class(derivatives(&g, reach, -1.0).into_iter());
                assert_eq!(edge, facts.edge, "{f:?}");
            } else {
                assert_eq!(facts.edge, Smoothness::Smooth);
            }
        }
    }
}
