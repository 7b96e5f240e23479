//! Transformations that can be scaled by a strength.
//!
//! *Source*: Milliron et al. 2002, §3.3: displacement and composition scaling; errata F18. The displacement method is
//! here; composition scaling needs a decomposition and lives in `anamorph-transforms`.

use crate::{Affine, Linear, Space};

/// How a transformation is multiplied by a strength.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scaling {
    /// `s·T = sT + (1 − s)I`: every displacement is multiplied by `s`.
    Displacement,
    /// The parameters of the components (angle, shift, stretch) are multiplied by `s` and composed again.
    Composition,
}

/// An affine transformation together with the way it is scaled: `0·T = I` and `1·T = T`.
pub trait Transformation<S: Space>: Send + Sync {
    /// The whole transformation, `1·T`.
    fn affine(&self) -> Affine<S>;
    /// The transformation multiplied by a strength; exactly the identity at 0.
    fn scaled(&self, strength: f64) -> Affine<S>;
    /// The scaling method.
    fn scaling(&self) -> Scaling;
    /// Whether `T` is a translation, for which both methods agree.
    fn is_translation(&self) -> bool {
        self.affine().linear == S::Linear::IDENTITY
    }
}

/// An affine map scales by the displacement method.
impl<S: Space> Transformation<S> for Affine<S> {
    fn affine(&self) -> Affine<S> {
        *self
    }
    fn scaled(&self, strength: f64) -> Affine<S> {
        self.lerp_from_identity(strength)
    }
    fn scaling(&self) -> Scaling {
        Scaling::Displacement
    }
}

impl<S: Space, T: Transformation<S> + ?Sized> Transformation<S> for Box<T> {
    fn affine(&self) -> Affine<S> {
        (**self).affine()
    }
    fn scaled(&self, strength: f64) -> Affine<S> {
        (**self).scaled(strength)
    }
    fn scaling(&self) -> Scaling {
        (**self).scaling()
    }
    fn is_translation(&self) -> bool {
        (**self).is_translation()
    }
}
