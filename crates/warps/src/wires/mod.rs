//! Warps by curves: wires, their continuous variant, and deformation along an axis that bends.
//!
//! - [`Wires`]: what is near a source curve follows it to its target, each point by its nearest place (B14), with the options of
//!   Singh and Fiume; with a direction of view, depth is kept.
//! - [`ContinuousWires`]: the same as an integral over every wire's length, which does not tear (B15).
//! - [`AxialCurve`]: a straight or curved axis carries the model along when it is bent (B16).
//!
//! Curves are spoken to through the traits of `anamorph-core` alone.
//!
//! *Source*: Milliron et al. 2002, §3.4, §4.4 and §5.3.

mod axial_curve;
#[cfg(feature = "recipe")]
pub(crate) mod axial_parameters;
mod continuous;
#[cfg(feature = "recipe")]
mod curve_parameters;
mod nearest;
#[cfg(feature = "recipe")]
pub(crate) mod parameters;
mod rail;
mod tangents;
mod turning;
mod wire;

pub use axial_curve::{AxialCurve, AxialReach, Axis};
pub use continuous::ContinuousWires;
pub use nearest::Wires;
pub use rail::{Rail, Station};
pub use wire::{Along, Anchor, Wire, WireCurve};

use anamorph_core::{Bounds, Condition, Mark, Role, Shape, Site, Space, Warp, evaluate};
use anamorph_transforms::Rotational;
use wire::Prepared;

/// What is wrong with a warp by curves.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WireError {
    /// There is no wire.
    #[error("there is no wire: give at least one source curve")]
    None,
    /// A curve with points that are not finite, or without a domain.
    #[error("the {which} curve of wire {feature} is not finite; give finite points")]
    NotFinite {
        /// Number of the wire.
        feature: usize,
        /// `source`, `target`, `domain` or `anchor`.
        which: &'static str,
    },
    /// A curve without length where one is needed.
    #[error("the {which} curve of wire {feature} has no length; give points that differ")]
    NoLength {
        /// Number of the wire.
        feature: usize,
        /// Which curve.
        which: &'static str,
    },
    /// A radius that is not a positive number.
    #[error("a radius of wire {feature} is {radius}, and must be greater than 0 and finite")]
    Radius {
        /// Number of the wire.
        feature: usize,
        /// The radius given.
        radius: f64,
    },
    /// A number out of its range.
    #[error("the {what} of wire {feature} is out of range: give {range}")]
    Number {
        /// Number of the wire.
        feature: usize,
        /// Which number.
        what: &'static str,
        /// What is allowed.
        range: &'static str,
    },
    /// A falloff that does not end at the radius.
    #[error(
        "the falloff `{name}` of wire {feature} does not end at the radius; take one that does, such as \"wires\""
    )]
    Falloff {
        /// Number of the wire.
        feature: usize,
        /// Its name.
        name: &'static str,
    },
    /// A sampling with numbers out of range.
    #[error(
        "the sampling is out of range: give a count of at least 1, or a tolerance from 1e-12 to 0.1"
    )]
    Sampling,
    /// A direction of view that is none, or one in the plane.
    #[error("the direction of view is none: give a vector of space that is not zero")]
    View,
}

/// A feature's number as addresses hold it.
fn number(feature: usize) -> u32 {
    u32::try_from(feature).unwrap_or(u32::MAX)
}

/// Prepares wires; `view` is brought to unit length.
fn prepared<S: Rotational>(
    wires: Vec<Wire<S>>,
    view: Option<S>,
) -> Result<Vec<Prepared<S>>, WireError> {
    let view = match view {
        None => None,
        Some(_) if S::DIM == 2 => return Err(WireError::View),
        Some(view) => Some(view.normalized().ok_or(WireError::View)?),
    };
    let all = wires.into_iter().enumerate();
    all.map(|(feature, wire)| Prepared::new(feature, wire, view))
        .collect()
}

/// A box around all that wires may move; `None` without wires.
fn support<S: Rotational>(wires: &[Prepared<S>]) -> Option<Bounds<S>> {
    wires.iter().map(Prepared::support).reduce(Bounds::union)
}

/// Eq. (3) inside of a box around all that moves; outside everything stays.
fn within<S: Space>(bounds: Bounds<S>, warp: &impl Warp<S>, site: &Site<S>) -> S {
    if bounds.contains(site.point) {
        evaluate(warp, site)
    } else {
        site.point
    }
}

/// Places of a wire at which it states where it goes.
const CONDITIONS: u32 = 8;

fn conditions<S: Rotational>(wires: &[Prepared<S>]) -> Vec<Condition<S>> {
    let mut conditions = Vec::new();
    for (feature, wire) in wires.iter().enumerate() {
        for i in 0..=CONDITIONS {
            let (source, target) = wire.condition(f64::from(i) / f64::from(CONDITIONS));
            conditions.push(Condition {
                feature: number(feature),
                source,
                target,
            });
        }
    }
    conditions
}

/// Segments of a drawn curve, a piece at least.
const DRAWN: u32 = 96;

/// The points of a curve for pictures.
fn polyline<S: Space>(curve: &dyn anamorph_core::Differentiable<S>) -> Vec<S> {
    let (start, end) = curve.domain();
    let mut parameters = curve.breaks();
    if parameters.len() > 4096 {
        parameters.truncate(4096);
    }
    for i in 0..=DRAWN {
        let share = f64::from(i) / f64::from(DRAWN);
        parameters.push(start * (1.0 - share) + end * share);
    }
    parameters.sort_by(f64::total_cmp);
    parameters.dedup();
    parameters.into_iter().map(|v| curve.point(v)).collect()
}

fn marks<S: Rotational>(wires: &[Prepared<S>]) -> Vec<Mark<S>> {
    let mut marks = Vec::new();
    for wire in wires {
        let line = |curve| Shape::Polyline(polyline(curve));
        marks.push(Mark::new(Role::Source, line(wire.source.curve.as_ref())));
        marks.push(Mark::new(Role::Target, line(wire.target.curve.as_ref())));
        if let Some(domain) = &wire.wire.domain {
            marks.push(Mark::new(Role::SourceGuide, line(domain.as_ref())));
        }
        for anchor in &wire.wire.anchors {
            let points = polyline(anchor.curve.as_ref());
            marks.push(Mark::new(Role::SourceGuide, Shape::Polyline(points)));
        }
    }
    marks
}
