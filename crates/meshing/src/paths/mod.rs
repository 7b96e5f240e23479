//! Paths that stay on a surface.
//!
//! | path | from | ends |
//! | --- | --- | --- |
//! | [`section`] | the plane through two places, upright on the surface | [`SectionEnd`] |
//! | [`edge_path`] | the shortest way along edges | [`EdgeEnd`] |
//! | [`straightest`] | a place, a direction and a length | [`StraightestEnd`] |
//! | [`downhill`] | a place and a direction that is up | [`DownhillEnd`] |
//!
//! Each gives a [`SurfacePath`], and says by the type of its end how it ended: a surface that ends, a pit, a target that
//! cannot be reached are answers, not errors. Errors ([`PathError`]) are questions without meaning.

mod downhill;
mod edges;
mod heading;
#[cfg(test)]
mod hostile;
mod section;
mod straightest;
mod unfold;

pub use downhill::{DOWNHILL_STEPS, DownhillEnd, downhill, uphill};
pub use edges::{EdgeDistances, EdgeEnd, edge_path};
pub use section::{SectionEnd, SectionPlane, Upright, section};
pub use straightest::{STRAIGHTEST_STEPS, StraightestEnd, StraightestStop, straightest};

use anamorph_core::glam::DVec3;

use crate::{Surface, SurfacePoint, SurfacePointError};

/// A path of straight segments on a surface. Consecutive points touch a common face.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePath<End> {
    /// The `n ≥ 1` places, from the start on.
    pub points: Vec<SurfacePoint>,
    /// Where they are in space.
    pub positions: Vec<DVec3>,
    /// The `n − 1` faces in which the segments lie; a segment along an edge names one of the edge's faces.
    pub faces: Vec<usize>,
    /// The sum of the segments' lengths.
    pub length: f64,
    /// How the path ended.
    pub ending: End,
}

/// Why there is no path to look for.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PathError {
    /// An end is not on the surface.
    #[error("the {which} is not on the surface: {problem}")]
    Point {
        /// `"start"` or `"target"`.
        which: &'static str,
        /// What is wrong with it.
        problem: SurfacePointError,
    },
    /// A direction is null, infinite or not a number.
    #[error("the {what} is null or not finite; give it a direction")]
    Direction {
        /// Which direction.
        what: &'static str,
    },
    /// A length is negative or not a number.
    #[error("the {what} is {length}; give a length that is not negative")]
    Length {
        /// Which length.
        what: &'static str,
        /// The length given.
        length: f64,
    },
    /// Two different places of the surface are at the same point of space, and no plane is defined by them.
    #[error(
        "start and target are two sheets' places at the same point, through which no plane is better than another; move \
         one of them"
    )]
    SamePlace,
    /// The direction that the plane should contain is that from start to target.
    #[error(
        "the plane's upright direction is parallel to the way from start to target; give another"
    )]
    UprightAlongChord,
    /// A walk starts at a vertex of no face, or in a face without area.
    #[error(
        "the surface has no tangent at the start, for it touches no face with area; start elsewhere"
    )]
    NoTangent,
    /// A walk's direction points away from the surface.
    #[error(
        "the direction has no part along the surface at the start; give one that is not perpendicular to it"
    )]
    Perpendicular,
}

/// A start or target in its simplest form.
fn checked(
    surface: &Surface,
    which: &'static str,
    point: SurfacePoint,
) -> Result<SurfacePoint, PathError> {
    surface
        .simplest(point)
        .map_err(|problem| PathError::Point { which, problem })
}

/// A unit vector; lengths beyond the range of squares are no hindrance.
fn unit(what: &'static str, direction: DVec3) -> Result<DVec3, PathError> {
    if !direction.is_finite() {
        return Err(PathError::Direction { what });
    }
    (direction / direction.abs().max_element())
        .try_normalize()
        .ok_or(PathError::Direction { what })
}

fn checked_length(what: &'static str, length: f64) -> Result<f64, PathError> {
    // Written so that NaN fails.
    if length >= 0.0 {
        Ok(length)
    } else {
        Err(PathError::Length { what, length })
    }
}

/// A path that is being walked.
struct Trace<'a> {
    surface: &'a Surface,
    points: Vec<SurfacePoint>,
    positions: Vec<DVec3>,
    faces: Vec<usize>,
    length: f64,
}

impl<'a> Trace<'a> {
    fn new(surface: &'a Surface, start: SurfacePoint) -> Self {
        Self {
            surface,
            points: vec![start],
            positions: vec![surface.position(start)],
            faces: Vec::new(),
            length: 0.0,
        }
    }

    /// Goes on to a place by a straight segment in a face. A step to the same place is none.
    fn step(&mut self, face: usize, point: SurfacePoint) {
        if self.points.last() == Some(&point) {
            return;
        }
        let position = self.surface.position(point);
        if let Some(&last) = self.positions.last() {
            self.length += last.distance(position);
        }
        self.faces.push(face);
        self.points.push(point);
        self.positions.push(position);
    }

    fn end<End>(self, ending: End) -> SurfacePath<End> {
        SurfacePath {
            points: self.points,
            positions: self.positions,
            faces: self.faces,
            length: self.length,
            ending,
        }
    }
}

/// A distance in a queue that gives the least first, equal ones in the order of their nodes.
#[derive(Debug, Clone, Copy)]
struct Waiting {
    distance: f64,
    node: usize,
}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> core::cmp::Ordering {
        other
            .distance
            .total_cmp(&self.distance)
            .then(other.node.cmp(&self.node))
    }
}
impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<core::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}
impl Eq for Waiting {}
