//! Eases: how the share of a distance that is covered grows with the share of the time.
//!
//! An ease is a function `s = ease(t)` from the unit interval, normally from 0 to 1 ("normalize distance and time to 1.0
//! to facilitate reuse"). One file a family; [`registry`] lists all of them by name, [`parse`] reads the notation of style
//! sheets.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Speed control" (sinusoidal, piecewise sinusoidal, single cubic,
//! constant acceleration; errata C4, C12); W3C, *CSS Easing Functions Level 2* (`cubic-bezier()`, `steps()`,
//! `linear()`); R. Penner, *Programming Macromedia Flash MX*, 2002, chapter 7 (the families in, out and in-out).

mod back;
mod bounce;
mod circular;
mod constant_acceleration;
mod css;
mod cubic_bezier;
mod direction;
mod elastic;
mod exponential;
mod piecewise_sinusoidal;
mod polynomials;
mod power;
mod registry;
mod sines;
mod spring;
mod steps;
mod stops;
mod table;

pub use back::Back;
pub use bounce::Bounce;
pub use circular::Circular;
pub use constant_acceleration::ConstantAcceleration;
pub use css::parse;
pub use cubic_bezier::CubicBezier;
pub use direction::{Directed, Direction};
pub use elastic::Elastic;
pub use exponential::Exponential;
pub use piecewise_sinusoidal::PiecewiseSinusoidal;
pub use polynomials::{Cubic, Linear, Quintic};
pub use power::Power;
pub use registry::{EaseEntry, EaseParameter, Setting, Settings, ease, entry, registry};
pub use sines::{Sine, Sinusoidal};
pub use spring::Spring;
pub use steps::{StepPosition, Steps};
pub use stops::Stops;

use crate::CurveError;
use anamorph_core::Smoothness;

/// An ease at one time, with its derivatives by the share of the time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EaseState {
    /// The share of the distance.
    pub value: f64,
    /// First derivative. 1 is the speed of even motion.
    pub speed: f64,
    /// Second derivative.
    pub acceleration: f64,
}

/// What is known about an ease.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EaseFacts {
    /// Whether it never goes back.
    pub monotone: bool,
    /// Whether it is exactly 0 at time 0.
    pub starts_at_zero: bool,
    /// Whether it is exactly 1 at time 1.
    pub ends_at_one: bool,
    /// Class between the ends, at least.
    pub smoothness: Smoothness,
    /// Whether speed is finite everywhere; where it is not, it is infinite at single times.
    pub finite_speed: bool,
}

impl EaseFacts {
    /// From 0 to 1 without going back, smooth, with finite speed.
    pub const PLAIN: Self = Self {
        monotone: true,
        starts_at_zero: true,
        ends_at_one: true,
        smoothness: Smoothness::Smooth,
        finite_speed: true,
    };
}

/// An ease. Total: every time, even one that is not a number, has a value that is finite.
pub trait Ease: core::fmt::Debug + Send + Sync {
    /// Value and derivatives at a time in [0, 1]; for other times call [`Ease::value`] and its like, which clamp. At a
    /// break derivatives are those of one of the sides, at the ends those from within. Nothing is ever NaN; where an
    /// acceleration does not exist, because speed is infinite, it is given as 0.
    fn state(&self, t: f64) -> EaseState;

    /// What is known about it.
    fn facts(&self) -> EaseFacts;

    /// The times strictly between 0 and 1, increasing, at which it may not be smooth. Between them it is analytic.
    fn breaks(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The share of the distance at the share `t` of the time. Before 0, and for what is not a number, the value at 0;
    /// after 1 that at 1.
    fn value(&self, t: f64) -> f64 {
        self.state(clamped(t)).value
    }

    /// First derivative; 0 outside the unit interval, where the ease rests.
    fn speed(&self, t: f64) -> f64 {
        if (0.0..=1.0).contains(&t) {
            self.state(t).speed
        } else {
            0.0
        }
    }

    /// Second derivative; 0 outside the unit interval.
    fn acceleration(&self, t: f64) -> f64 {
        if (0.0..=1.0).contains(&t) {
            self.state(t).acceleration
        } else {
            0.0
        }
    }
}

macro_rules! forward_ease {
    ($($pointer:ty),*) => {$(
        impl<E: Ease + ?Sized> Ease for $pointer {
            fn state(&self, t: f64) -> EaseState { (**self).state(t) }
            fn facts(&self) -> EaseFacts { (**self).facts() }
            fn breaks(&self) -> Vec<f64> { (**self).breaks() }
            fn value(&self, t: f64) -> f64 { (**self).value(t) }
            fn speed(&self, t: f64) -> f64 { (**self).speed(t) }
            fn acceleration(&self, t: f64) -> f64 { (**self).acceleration(t) }
        }
    )*};
}
forward_ease!(&E, Box<E>, std::sync::Arc<E>);

/// The time brought into [0, 1]; 0 for what is not a number.
fn clamped(t: f64) -> f64 {
    if t >= 0.0 { t.min(1.0) } else { 0.0 }
}

/// Refuses a parameter outside a closed range.
fn ranged(
    name: &'static str,
    value: f64,
    low: f64,
    high: f64,
    range: &'static str,
) -> Result<f64, CurveError> {
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(CurveError::OutOfRange { name, value, range })
    }
}

#[cfg(test)]
mod tests;
