//! Up vectors: fixed, and updated from sample to sample.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Direction & Up vector"; errata C10: `u = v × w`, `v = w × u`, where the
//! slides print `u = w × v`, a mirror.

use super::directions::{Directions, Place};
use super::error::{direction, of_path};
use super::{Frame, OrientationError, Orienter, SpaceCurve};
use crate::{ArcLength, LengthTable};
use anamorph_core::Curve;
use anamorph_core::glam::DVec3;

/// A path with its directions.
#[derive(Clone, Debug)]
pub(super) struct Course<P> {
    pub(super) path: P,
    directions: Directions,
}

impl<P: SpaceCurve> Course<P> {
    pub(super) fn new(path: P) -> Result<Self, OrientationError> {
        let directions = Directions::new(&*path).map_err(of_path)?;
        Ok(Self { path, directions })
    }

    /// A length of the size of the path.
    pub(super) fn size(&self) -> f64 {
        self.directions.size()
    }

    /// Lengths along the path, to 1e-10 of the whole.
    pub(super) fn table(&self) -> Result<LengthTable, OrientationError> {
        let rough = self.path.length(1e-3 * self.size());
        LengthTable::new(&*self.path, 1e-10 * rough).map_err(of_path)
    }

    /// The place of any parameter. Its direction `ahead` is that in which the curve leaves, at the end of an open one that
    /// in which it arrives.
    pub(super) fn place(&self, parameter: f64) -> Place {
        self.directions
            .place(&*self.path, self.path.within(parameter))
    }
}

/// Along the path, head up: the up axis is as near to a fixed vector as can be.
///
/// Where the path is parallel to the vector (to 1e-9 radians), the answer is that of [`Frame::level`]. Around such places frames turn quickly,
/// and in a vertical loop they turn over twice: there, rotation-minimizing frames are better.
#[derive(Clone, Debug)]
pub struct FixedUp<P> {
    course: Course<P>,
    up: DVec3,
}

impl<P: SpaceCurve> FixedUp<P> {
    /// Prepares the frames along a path.
    ///
    /// # Errors
    ///
    /// A path without length, a vector that is no direction.
    pub fn along(path: P, up: DVec3) -> Result<Self, OrientationError> {
        Ok(Self {
            up: direction("up", up)?,
            course: Course::new(path)?,
        })
    }
}

impl<P: SpaceCurve> Orienter for FixedUp<P> {
    fn frame(&self, parameter: f64) -> Frame {
        Frame::level(self.course.place(parameter).ahead, self.up)
    }
}

/// Along the path, the up axis of each sample made from that of the sample before it: `u = v_old × w`, `v = w × u`.
///
/// Frames depend on which samples are asked for, and in which order; for ever finer ones they become rotation-minimizing, with an
/// error of the first order. A sample whose direction is parallel to the up axis of the last keeps the last frame, direction
/// included. [`Orienter::frame`] is the frame of a first sample.
#[derive(Clone, Debug)]
pub struct UpdatedUp<P> {
    course: Course<P>,
    up: DVec3,
}

impl<P: SpaceCurve> UpdatedUp<P> {
    /// Prepares the frames along a path; `up` is for the first sample ([`Frame::level`]).
    ///
    /// # Errors
    ///
    /// A path without length, a vector that is no direction.
    pub fn along(path: P, up: DVec3) -> Result<Self, OrientationError> {
        Ok(Self {
            up: direction("up", up)?,
            course: Course::new(path)?,
        })
    }
}

impl<P: SpaceCurve> Orienter for UpdatedUp<P> {
    fn frame(&self, parameter: f64) -> Frame {
        Frame::level(self.course.place(parameter).ahead, self.up)
    }

    fn stream(&self, parameters: &mut dyn Iterator<Item = f64>, each: &mut dyn FnMut(Frame)) {
        let mut last: Option<Frame> = None;
        for parameter in parameters {
            let forward = self.course.place(parameter).ahead;
            let frame = match last {
                Some(old) => Frame::new(forward, old.up()).unwrap_or(old),
                None => Frame::level(forward, self.up),
            };
            each(frame);
            last = Some(frame);
        }
    }
}
