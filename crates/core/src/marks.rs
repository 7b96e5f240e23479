//! What a deformation looks like: the lines and points a picture draws over a model.
//!
//! *Source*: the figures of Milliron et al. 2002 (Figs. 2–18): source features orange, target features blue. A mark is
//! pure geometry with a role; which colour or width a role gets is the painter's business.

use crate::Space;

/// What a mark stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A source feature: where the warp takes hold. Drawn over the model before the warp.
    Source,
    /// A target feature: where the source goes. Drawn over the model after the warp.
    Target,
    /// A construction line of the source side: an axis, a lattice cage, a range or support.
    SourceGuide,
    /// A construction line of the target side.
    TargetGuide,
}

/// The geometry of a mark, in scene units.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape<S> {
    /// A single point.
    Point(S),
    /// A connected line through the points in order.
    Polyline(Vec<S>),
    /// An arrow from the first point to the second.
    Arrow(S, S),
}

/// One thing to draw.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark<S> {
    /// What it stands for.
    pub role: Role,
    /// Its geometry.
    pub shape: Shape<S>,
}

impl<S: Space> Mark<S> {
    /// A mark of the given role and shape.
    pub fn new(role: Role, shape: Shape<S>) -> Self {
        Self { role, shape }
    }
}
