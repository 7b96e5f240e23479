//! Random numbers and comparisons for the tests.

use anamorph_core::{Affine, Linear, Space};

/// Marsaglia's xorshift generator, seeded: the same numbers in every run.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
    pub(crate) fn vector<S: Space>(&mut self) -> S {
        S::from_fn(|_| self.between(-1.0, 1.0))
    }
    pub(crate) fn direction<S: Space>(&mut self) -> S {
        loop {
            let v = self.vector::<S>();
            if let (true, Some(unit)) = (v.length() > 0.1, v.normalized()) {
                return unit;
            }
        }
    }
    pub(crate) fn linear<S: Space>(&mut self) -> S::Linear {
        S::Linear::from_columns(|_| self.vector())
    }
    pub(crate) fn rotation<S: Space>(&mut self) -> S::Linear {
        let axis = self.direction();
        S::rotation(axis, self.between(-3.1, 3.1))
    }
}

/// Largest difference of entries.
pub(crate) fn far<S: Space>(a: &S::Linear, b: &S::Linear) -> f64 {
    (0..S::DIM).fold(0.0, |m, i| m.max((a.column(i) - b.column(i)).largest()))
}

/// Largest difference of entries, translation included.
pub(crate) fn affine_far<S: Space>(a: &Affine<S>, b: &Affine<S>) -> f64 {
    far::<S>(&a.linear, &b.linear).max((a.translation - b.translation).largest())
}
