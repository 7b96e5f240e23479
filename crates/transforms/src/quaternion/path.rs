//! What paths through orientations have in common.

use super::arc::Moving;
use super::error::OrientationError;
use anamorph_core::glam::{DQuat, DVec3};

/// An orientation that changes over time, prepared for queries.
///
/// Times are those of the keys, in the unit of the caller. Outside of the domain an open path stands still at its nearer
/// end, a closed one repeats; NaN, and for closed paths infinity, stand for the start.
pub trait Orientations: Send + Sync {
    /// The times of the keys, increasing, the ends of the domain included: between them the path is smooth.
    fn times(&self) -> &[f64];

    /// Whether the path repeats outside of its domain.
    fn is_closed(&self) -> bool;

    /// The orientation at the time `t`, a unit quaternion.
    fn orientation(&self, t: f64) -> DQuat;

    /// The angular velocity at the time `t`, in radians per unit of time about an axis fixed in space (not in the body):
    /// `q̇ = ½·ω·q`. At a key of a path that has corners there, that of the span after it. Null where an open path has
    /// ended or not begun.
    fn angular_velocity(&self, t: f64) -> DVec3;

    /// First and last time.
    fn domain(&self) -> [f64; 2] {
        match self.times() {
            [start, .., end] => [*start, *end],
            [only] => [*only; 2],
            [] => [0.0; 2],
        }
    }

    /// The orientations at many times, in any order: those of [`Self::orientation`], bit for bit.
    ///
    /// # Errors
    /// [`OrientationError::Room`] when `out` is not as long as `times`.
    fn orientations(&self, times: &[f64], out: &mut [DQuat]) -> Result<(), OrientationError> {
        room(times, out)?;
        for (q, &t) in out.iter_mut().zip(times) {
            *q = self.orientation(t);
        }
        Ok(())
    }
}

macro_rules! forward_orientations {
    ($($pointer:ty),*) => {$(
        impl<P: Orientations + ?Sized> Orientations for $pointer {
            fn times(&self) -> &[f64] { (**self).times() }
            fn is_closed(&self) -> bool { (**self).is_closed() }
            fn orientation(&self, t: f64) -> DQuat { (**self).orientation(t) }
            fn angular_velocity(&self, t: f64) -> DVec3 { (**self).angular_velocity(t) }
            fn orientations(&self, times: &[f64], out: &mut [DQuat]) -> Result<(), OrientationError> {
                (**self).orientations(times, out)
            }
        }
    )*};
}
forward_orientations!(&P, Box<P>);

/// Whether there is a place for each orientation.
pub(super) fn room(times: &[f64], out: &[DQuat]) -> Result<(), OrientationError> {
    if times.len() == out.len() {
        Ok(())
    } else {
        Err(OrientationError::Room {
            times: times.len(),
            out: out.len(),
        })
    }
}

/// The angular velocity of a moving quaternion whose parameter passes 1 in the time `span`.
pub(super) fn angular_velocity(moving: Moving, span: f64) -> DVec3 {
    let turn = moving.rate * moving.at.conjugate();
    DVec3::new(turn.x, turn.y, turn.z) * (2.0 / span)
}

/// Orientations that a batch holds at a time: few enough for the nearest cache.
pub(super) const RUN: usize = 128;

/// Sines and cosines of a run of angles.
pub(super) struct Circle {
    pub(super) angle: [f64; RUN],
    pub(super) sin: [f64; RUN],
    pub(super) cos: [f64; RUN],
}

impl Circle {
    pub(super) fn new() -> Self {
        Self {
            angle: [0.0; RUN],
            sin: [0.0; RUN],
            cos: [0.0; RUN],
        }
    }

    /// Fills the sines and cosines of at least the first `count` angles.
    #[cfg(not(feature = "simd"))]
    pub(super) fn fill(&mut self, count: usize) {
        for i in 0..count {
            (self.sin[i], self.cos[i]) = anamorph_core::math::sin_cos(self.angle[i]);
        }
    }

    /// Fills the sines and cosines of at least the first `count` angles, eight at a time: the same numbers.
    #[cfg(feature = "simd")]
    pub(super) fn fill(&mut self, count: usize) {
        use anamorph_core::simd::{LANES, Level, Simd, dispatch, f64x8, prelude::*, sin_cos};
        #[inline(always)]
        fn blocks<V: Simd>(simd: V, circle: &mut Circle, count: usize) {
            let angles = circle.angle.as_chunks::<LANES>().0;
            let sines = circle.sin.as_chunks_mut::<LANES>().0;
            let cosines = circle.cos.as_chunks_mut::<LANES>().0;
            let rows = angles.iter().zip(sines).zip(cosines);
            for ((angle, sin), cos) in rows.take(count.div_ceil(LANES)) {
                let (s, c) = sin_cos(simd, f64x8::simd_from(simd, *angle));
                *sin = s.into();
                *cos = c.into();
            }
        }
        dispatch!(Level::new(), simd => blocks(simd, self, count));
    }
}
