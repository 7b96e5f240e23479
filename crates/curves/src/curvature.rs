//! Curvature and torsion.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Frenet frame – tangent and curvature vector"; M. do Carmo,
//! *Differential Geometry of Curves and Surfaces*, 1976, §1-5: `κ = |P′ × P″|/|P′|³`, `τ = (P′ × P″)·P‴/|P′ × P″|²`. The part of `P″`
//! across `P′` stands for the cross product, which the plane does not have.

use anamorph_core::{Differentiable, Jet, Plane, Solid, Space};

/// The part of the second derivative across the first.
fn across<S: Space>(jet: &Jet<S>) -> Option<(S, f64)> {
    let speed = jet.first.length();
    let along = jet.first.normalized()?;
    Some((jet.second - along * along.dot(jet.second), speed))
}

/// A curve whose bending is known.
pub trait Curvature<S: Space>: Differentiable<S> {
    /// The curvature in 1/scene unit, not negative; `None` where the speed is 0 (a cusp or a stop).
    fn curvature(&self, parameter: f64) -> Option<f64> {
        let (across, speed) = across(&self.jet(parameter))?;
        let curvature = across.length() / speed / speed;
        curvature.is_finite().then_some(curvature)
    }

    /// The vector from the curve towards the centre of its circle of curvature, of length `κ`; `None` where the speed is 0.
    fn curvature_vector(&self, parameter: f64) -> Option<S> {
        let (across, speed) = across(&self.jet(parameter))?;
        let vector = across / speed / speed;
        vector.is_finite().then_some(vector)
    }
}

impl<S: Space, C: Differentiable<S> + ?Sized> Curvature<S> for C {}

/// A curve of the plane, whose bending has a sign.
pub trait SignedCurvature: Differentiable<Plane> {
    /// The curvature, positive where the curve turns counter-clockwise; `None` where the speed is 0.
    fn signed_curvature(&self, parameter: f64) -> Option<f64> {
        let jet = self.jet(parameter);
        let (across, speed) = across(&jet)?;
        let sign = if jet.first.perp_dot(across) < 0.0 {
            -1.0
        } else {
            1.0
        };
        let curvature = sign * Space::length(across) / speed / speed;
        curvature.is_finite().then_some(curvature)
    }
}

impl<C: Differentiable<Plane> + ?Sized> SignedCurvature for C {}

/// A curve of space, which may leave its plane.
pub trait Torsion: Differentiable<Solid> {
    /// The torsion in radians per scene unit, positive where the curve winds as a right-handed screw; `None` where speed or curvature is 0.
    fn torsion(&self, parameter: f64) -> Option<f64> {
        let jet = self.jet(parameter);
        let (across, speed) = across(&jet)?;
        let bend = Space::length(across);
        let (along, to_centre) = (jet.first / speed, Space::normalized(across)?);
        let torsion = along.cross(to_centre).dot(jet.third) / bend / speed;
        torsion.is_finite().then_some(torsion)
    }
}

impl<C: Differentiable<Solid> + ?Sized> Torsion for C {}
