//! Orientation along a path: which way a camera or an object faces, and which way is up for it.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Frenet Frame – control orientation", "Other ways to control
//! orientation", "Direction & Up vector"; errata C10, C14, C16.
//!
//! | orientation | faces | up | when to use it |
//! | --- | --- | --- | --- |
//! | [`RotationMinimizing`] | along the path | carried along without twist | the default: never flips |
//! | [`Frenet`] | along the path | towards the centre of curvature | to show the curve's own bending |
//! | [`FixedUp`] | along the path | as near as can be to a vector | roads, walks |
//! | [`UpdatedUp`] | along the path | the last sample's, made perpendicular | as the slides do it |
//! | [`LookAhead`] | where the path is a distance further on | as near as can be to a vector | driving |
//! | [`LookAt`] | to a point | as near as can be to a vector | cameras |
//! | [`Auxiliary`] | to a point of another curve | as near as can be to a vector | cameras with a centre of interest |
//!
//! or with the other curve for up; and [`Banking`] leans any of them into turns. All answer for any parameter of the path, are
//! [`Orienter`]s, and are listed by name in [`registry`].
//!
//! A path is held by any handle ([`SpaceCurve`]): `&curve`, `Box`, `Arc`.
//!
//! ```
//! use anamorph_core::glam::dvec3;
//! use anamorph_curves::families::{CatmullRom, Generator};
//! use anamorph_curves::orientation::{Orienter, RotationMinimizing};
//!
//! let points = vec![dvec3(0.0, 0.0, 0.0), dvec3(1.0, 0.0, 2.0), dvec3(3.0, 1.0, 2.0), dvec3(4.0, 1.0, 0.0)];
//! let path = CatmullRom::new(points).curve()?;
//! let frames = RotationMinimizing::default().along(&path)?;
//! let camera = frames.frame(1.5).camera_to_world();
//! assert!((camera.determinant() - 1.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod banking;
mod directions;
mod error;
mod frame;
mod frenet;
mod look;
mod minimizing;
pub mod registry;
mod up;

pub use banking::{Banked, Banking, Speed};
pub use error::OrientationError;
pub use frame::{Frame, heading};
pub use frenet::{Flips, Frenet, FrenetFrames, FrenetUp};
pub use look::{Auxiliary, LookAhead, LookAt, Pairing, Role};
pub use minimizing::{ACCURACY, End, RotationMinimizing, RotationMinimizingFrames};
pub use up::{FixedUp, UpdatedUp};

use crate::ArcLength;
use anamorph_core::Solid;
use core::ops::Deref;

/// A handle of a curve in space whose length is known: a reference, a `Box`, an `Arc`.
pub trait SpaceCurve: Deref<Target: ArcLength<Solid>> + Send + Sync {}

impl<P: Deref<Target: ArcLength<Solid>> + Send + Sync> SpaceCurve for P {}

/// Frames along a path. Answers are total: never NaN, whatever the parameter ([`Curve::within`](anamorph_core::Curve::within)).
pub trait Orienter: Send + Sync {
    /// The frame at a parameter of the path.
    fn frame(&self, parameter: f64) -> Frame;

    /// Hands out a frame for each parameter, in order, without keeping any: a million need no memory.
    fn stream(&self, parameters: &mut dyn Iterator<Item = f64>, each: &mut dyn FnMut(Frame)) {
        for parameter in parameters {
            each(self.frame(parameter));
        }
    }

    /// The frames at parameters, into memory of the caller; as many as the shorter list has.
    fn frames_into(&self, parameters: &[f64], out: &mut [Frame]) {
        let mut slots = out.iter_mut();
        let mut wanted = parameters.iter().copied().take(slots.len());
        self.stream(&mut wanted, &mut |frame| {
            if let Some(slot) = slots.next() {
                *slot = frame;
            }
        });
    }

    /// The frames at parameters.
    fn frames(&self, parameters: &[f64]) -> Vec<Frame> {
        let mut out = vec![Frame::default(); parameters.len()];
        self.frames_into(parameters, &mut out);
        out
    }
}

macro_rules! handles {
    ($($handle:ty),*) => {$(
        impl<O: Orienter + ?Sized> Orienter for $handle {
            fn frame(&self, parameter: f64) -> Frame {
                (**self).frame(parameter)
            }

            fn stream(
                &self,
                parameters: &mut dyn Iterator<Item = f64>,
                each: &mut dyn FnMut(Frame),
            ) {
                (**self).stream(parameters, each);
            }
        }
    )*};
}
handles!(&O, Box<O>, std::sync::Arc<O>);
