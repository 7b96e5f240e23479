//! Looking somewhere else than along the path: to a point, further on, to a point of another curve.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Now that we have the camera path defined" (`gluLookAt`: eye, centre, up), "Frenet
//! Frame – discontinuity" (look farther ahead), "Other ways to control orientation" (`P(s + ds)`; an auxiliary curve for
//! direction or up); errata C16: what is returned where the view is parallel to the up vector, and what is returned at all
//! ([`Frame::camera_to_world`] and [`Frame::view_matrix`]).
//!
//! The up axis is as near to an up vector as can be; where the view is parallel to it (to 1e-9 radians), the answer is that of
//! [`Frame::level`]. Where there is nothing to look at, because it is where one is, the view is along the path.

use super::error::{direction, in_range, of_path};
use super::up::Course;
use super::{Frame, OrientationError, Orienter, SpaceCurve};
use crate::{ArcLength, LengthTable};
use anamorph_core::glam::DVec3;
use anamorph_core::{Curve, Solid, Space};

/// Distances below this share of the path's length are taken as none: lengths are known to 1e-14 of it.
const NO_DISTANCE: f64 = 1e-9;
/// Two points nearer than this share of their coordinates coincide.
const COINCIDE: f64 = 1e-15;

/// The vector from one point to another; `None` where they coincide.
fn between(from: Solid, to: Solid) -> Option<DVec3> {
    let vector = to - from;
    let coincide = COINCIDE * from.largest().max(to.largest());
    (vector.largest() > coincide && vector.is_finite()).then_some(vector)
}

/// From the path to a point that does not move.
#[derive(Clone, Debug)]
pub struct LookAt<P> {
    course: Course<P>,
    target: Solid,
    up: DVec3,
}

impl<P: SpaceCurve> LookAt<P> {
    /// Prepares the frames along a path.
    ///
    /// # Errors
    ///
    /// A path without length, a target that is not finite, a vector that is no direction.
    pub fn along(path: P, target: Solid, up: DVec3) -> Result<Self, OrientationError> {
        if !target.is_finite() {
            return Err(OrientationError::NotFinite { name: "the target" });
        }
        Ok(Self {
            up: direction("up", up)?,
            target,
            course: Course::new(path)?,
        })
    }
}

impl<P: SpaceCurve> Orienter for LookAt<P> {
    fn frame(&self, parameter: f64) -> Frame {
        let place = self.course.place(parameter);
        let view = between(place.point, self.target).unwrap_or(place.ahead);
        Frame::level(view, self.up)
    }
}

/// From the path to where it is a distance further on, by arc length: `P(s + ds) − P(s)`.
///
/// A closed path goes on at its start; an open one as if it went on straight. A distance of 0, or of whole rounds of a closed
/// path, to a billionth of the path's length, gives the direction of the path, which is the limit.
#[derive(Clone, Debug)]
pub struct LookAhead<P> {
    course: Course<P>,
    table: LengthTable,
    distance: f64,
    /// Two points nearer than this are one: the lengths that led to them are not known better.
    coincide: f64,
    up: DVec3,
}

impl<P: SpaceCurve> LookAhead<P> {
    /// Prepares the frames along a path; `distance` in scene units, not negative.
    ///
    /// # Errors
    ///
    /// A path without length, a distance that is negative or not finite, a vector that is no direction.
    pub fn along(path: P, distance: f64, up: DVec3) -> Result<Self, OrientationError> {
        let range = "0 or more scene units";
        let distance = in_range("the distance", distance, distance >= 0.0, range)?;
        let up = direction("up", up)?;
        let course = Course::new(path)?;
        let rough = course.path.length(1e-3 * course.size());
        let accuracy = (1e-5 * distance).clamp(1e-14 * rough, 1e-9 * rough);
        let table = LengthTable::new(&*course.path, accuracy).map_err(of_path)?;
        Ok(Self {
            course,
            table,
            distance,
            coincide: 4.0 * accuracy,
            up,
        })
    }
}

impl<P: SpaceCurve> Orienter for LookAhead<P> {
    fn frame(&self, parameter: f64) -> Frame {
        let place = self.course.place(parameter);
        let length = self.table.length();
        let path = &*self.course.path;
        let rest = if path.is_closed() {
            let rest = self.distance % length;
            rest.min(length - rest)
        } else {
            self.distance
        };
        if rest <= NO_DISTANCE * length {
            return Frame::level(place.ahead, self.up);
        }
        let s = self.table.length_to(place.u) + self.distance;
        let beyond = s - length;
        let there = if beyond > 0.0 && !path.is_closed() {
            let end = self.course.place(path.domain().1);
            end.point + end.behind * beyond
        } else {
            path.point(self.table.parameter(s))
        };
        let view = between(place.point, there).filter(|view| view.largest() > self.coincide);
        let view = view.unwrap_or(place.ahead);
        Frame::level(view, self.up)
    }
}

/// What an auxiliary curve is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Role {
    /// The centre of interest: the view is from the path to the curve.
    #[default]
    Direction,
    /// The up vector is from the path to the curve; the view is along the path.
    Up,
}

/// Which point of the auxiliary curve belongs to a point of the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pairing {
    /// That at the same share of the domain: keys belong to keys.
    #[default]
    Parameter,
    /// That at the same share of the length.
    Length,
}

/// A second curve that runs along the path, for direction or for up.
#[derive(Clone, Debug)]
pub struct Auxiliary<P, Q> {
    course: Course<P>,
    other: Q,
    role: Role,
    /// Lengths of path and curve, where shares are of the length.
    tables: Option<(LengthTable, LengthTable)>,
    up: DVec3,
}

impl<P: SpaceCurve, Q: SpaceCurve> Auxiliary<P, Q> {
    /// Prepares the frames along a path. `up` is the up vector for [`Role::Direction`]; for [`Role::Up`], that where the curves meet.
    ///
    /// # Errors
    ///
    /// A path without length, a curve without length where shares are of the length, curves of which only one is closed, a
    /// vector that is no direction.
    pub fn along(
        path: P,
        other: Q,
        role: Role,
        pairing: Pairing,
        up: DVec3,
    ) -> Result<Self, OrientationError> {
        let kind = |closed| if closed { "closed" } else { "open" };
        if path.is_closed() != other.is_closed() {
            return Err(OrientationError::Unlike {
                path: kind(path.is_closed()),
                auxiliary: kind(other.is_closed()),
            });
        }
        let up = direction("up", up)?;
        let course = Course::new(path)?;
        let tables = match pairing {
            Pairing::Parameter => None,
            Pairing::Length => {
                let along = course.table()?;
                let of_other = |source| OrientationError::Curve {
                    what: "the auxiliary curve",
                    source,
                };
                let size = super::directions::Directions::new(&*other)
                    .map_err(of_other)?
                    .size();
                let accuracy = 1e-10 * other.length(1e-3 * size);
                let beside = LengthTable::new(&*other, accuracy).map_err(of_other)?;
                Some((along, beside))
            }
        };
        Ok(Self {
            course,
            other,
            role,
            tables,
            up,
        })
    }

    /// The parameter of the auxiliary curve that belongs to one of the path.
    fn paired(&self, u: f64) -> f64 {
        if let Some((along, beside)) = &self.tables {
            return beside.parameter(beside.length() * (along.length_to(u) / along.length()));
        }
        let ((a, b), (c, d)) = (self.course.path.domain(), self.other.domain());
        let share = (u - a) / (b - a);
        // Exact at both ends.
        c * (1.0 - share) + d * share
    }
}

impl<P: SpaceCurve, Q: SpaceCurve> Orienter for Auxiliary<P, Q> {
    fn frame(&self, parameter: f64) -> Frame {
        let place = self.course.place(parameter);
        let there = self.other.point(self.paired(place.u));
        let vector = between(place.point, there);
        match self.role {
            Role::Direction => Frame::level(vector.unwrap_or(place.ahead), self.up),
            Role::Up => Frame::level(place.ahead, vector.unwrap_or(self.up)),
        }
    }
}
