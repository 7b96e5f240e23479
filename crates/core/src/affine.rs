//! Affine maps `p ↦ L p + t`, the matrix form of every transformation.
//!
//! *Source*: Milliron et al. 2002, §3.3: transformations are added and averaged as homogeneous matrices; errata F5.

use crate::{Linear, Space};

/// The affine map `p ↦ linear · p + translation`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine<S: Space> {
    /// The linear part.
    pub linear: S::Linear,
    /// The image of the origin.
    pub translation: S,
}

impl<S: Space> Affine<S> {
    /// The identity.
    pub const IDENTITY: Self = Self {
        linear: <S::Linear as Linear<S>>::IDENTITY,
        translation: S::ZERO,
    };

    /// The map `p ↦ linear · p + translation`.
    pub fn new(linear: S::Linear, translation: S) -> Self {
        Self {
            linear,
            translation,
        }
    }

    /// The translation by `offset`.
    pub fn translation(offset: S) -> Self {
        Self {
            linear: S::Linear::IDENTITY,
            translation: offset,
        }
    }

    /// The map `p ↦ centre + offset + linear · (p − centre)`: `linear` about `centre`, then a translation.
    pub fn about(centre: S, linear: S::Linear, offset: S) -> Self {
        // With an identity linear part the centre must not leave rounding behind.
        let drift = (S::Linear::IDENTITY - linear).apply(centre);
        Self {
            linear,
            translation: drift + offset,
        }
    }

    /// The image of a point.
    #[inline]
    pub fn apply(&self, p: S) -> S {
        self.linear.apply(p) + self.translation
    }

    /// How far a point moves: `apply(p) − p`, computed as `(L − I) p + t`, which loses no digits of a small move far
    /// from the origin.
    #[inline]
    pub fn displacement(&self, p: S) -> S {
        (self.linear - S::Linear::IDENTITY).apply(p) + self.translation
    }

    /// `self` after `first`.
    pub fn after(&self, first: &Self) -> Self {
        Self {
            linear: self.linear.after(&first.linear),
            translation: self.apply(first.translation),
        }
    }

    /// The inverse map, or `None` when it is singular.
    pub fn inverted(&self) -> Option<Self> {
        let linear = self.linear.inverted()?;
        Some(Self {
            linear,
            translation: -linear.apply(self.translation),
        })
    }

    /// Displacement scaling `s·T = sT + (1 − s)I`, exactly the identity at 0 and exactly `self` at 1.
    #[inline]
    pub fn lerp_from_identity(&self, strength: f64) -> Self {
        if strength == 1.0 {
            return *self;
        }
        Self {
            linear: S::Linear::IDENTITY + (self.linear - S::Linear::IDENTITY) * strength,
            translation: self.translation * strength,
        }
    }

    /// Whether all entries are finite.
    pub fn is_finite(&self) -> bool {
        self.translation.is_finite() && (0..S::DIM).all(|i| self.linear.column(i).is_finite())
    }
}
