//! What warps and motions need to know of a curve, whatever its family.
//!
//! *Source*: Milliron et al., *A Framework for Geometric Warps and Deformations*, ACM TOG 21(1), 2002, §4 (curve
//! features need points, tangents and nearest points); *Interpolation Techniques*, chapter 2, "Controlling motion along
//! p = P(u)". One capability a trait: whoever needs only points asks for [`Curve`].

use crate::Space;

/// A curve: a point for each parameter of its domain.
///
/// Evaluation is total: where a curve is open, parameters before and behind its domain give its ends; where it is closed,
/// they wrap. A parameter that is not a number gives the start.
pub trait Curve<S: Space>: Send + Sync {
    /// The first and the last parameter; the first is less, both are finite.
    fn domain(&self) -> (f64, f64);

    /// The point at a parameter.
    fn point(&self, parameter: f64) -> S;

    /// Whether the curve ends where it starts and parameters wrap.
    fn is_closed(&self) -> bool {
        false
    }

    /// The parameter brought into the domain: clamped where the curve is open, wrapped where it is closed.
    fn within(&self, parameter: f64) -> f64 {
        let (start, end) = self.domain();
        if parameter >= start && parameter <= end {
            return parameter;
        }
        if !parameter.is_finite() {
            return if parameter == f64::INFINITY && !self.is_closed() {
                end
            } else {
                start
            };
        }
        if !self.is_closed() {
            return parameter.clamp(start, end);
        }
        let wrapped = start + (parameter - start).rem_euclid(end - start);
        if wrapped < end { wrapped } else { start }
    }
}

/// The point of a curve at a parameter and the derivatives by the parameter there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<S: Space> {
    /// The point, in scene units.
    pub point: S,
    /// First derivative: the velocity, scene units for a unit of the parameter.
    pub first: S,
    /// Second derivative.
    pub second: S,
    /// Third derivative.
    pub third: S,
}

/// A curve whose derivatives are known.
pub trait Differentiable<S: Space>: Curve<S> {
    /// The point and the first three derivatives. At a break they are those of the piece behind it, at the end of the
    /// domain those of the last piece.
    fn jet(&self, parameter: f64) -> Jet<S>;

    /// First derivative alone.
    fn velocity(&self, parameter: f64) -> S {
        self.jet(parameter).first
    }

    /// The parameters between which the curve is smooth (all derivatives exist), both ends of the domain included,
    /// strictly increasing.
    fn breaks(&self) -> Vec<f64>;
}

/// A place on a curve that is near a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest<S: Space> {
    /// Where on the curve.
    pub parameter: f64,
    /// The point there.
    pub point: S,
    /// Its distance, in scene units.
    pub distance: f64,
}

/// A curve that finds its nearest point.
pub trait NearestPoint<S: Space>: Curve<S> {
    /// The place nearest to a point. Of places equally near, to 1e-12 of the curve's size, that of the least parameter
    /// (errata F10).
    fn nearest(&self, to: S) -> Nearest<S>;

    /// The same if it is no farther than `reach`. Prepared curves answer at once for points that are far from all of the
    /// curve.
    fn nearest_within(&self, to: S, reach: f64) -> Option<Nearest<S>> {
        let nearest = self.nearest(to);
        (nearest.distance <= reach).then_some(nearest)
    }
}
