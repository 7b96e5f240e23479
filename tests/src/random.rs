//! Random numbers that are the same in every run.

use anamorph_core::{Affine, Linear, Space};

/// Marsaglia's xorshift generator, seeded.
#[derive(Debug, Clone)]
pub struct Random(u64);

impl Random {
    /// The generator of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
    /// A number in `[low, high)`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        #[allow(clippy::cast_precision_loss)]
        let share = (self.next() >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * share
    }
    /// A whole number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        usize::try_from((self.next() >> 16) % count.max(1) as u64).unwrap()
    }
    /// A vector with coordinates in `[-1, 1)`.
    pub fn vector<S: Space>(&mut self) -> S {
        S::from_fn(|_| self.between(-1.0, 1.0))
    }
    /// A unit vector.
    pub fn direction<S: Space>(&mut self) -> S {
        loop {
            let v = self.vector::<S>();
            if let (true, Some(unit)) = (v.length() > 0.1, v.normalized()) {
                return unit;
            }
        }
    }
    /// A linear map with entries in `[-1, 1)`.
    pub fn linear<S: Space>(&mut self) -> S::Linear {
        S::Linear::from_columns(|_| self.vector())
    }
    /// A rotation by up to 3.1 radians.
    pub fn rotation<S: Space>(&mut self) -> S::Linear {
        let axis = self.direction();
        S::rotation(axis, self.between(-3.1, 3.1))
    }
    /// An affine map with entries in `[-1, 1)`.
    pub fn affine<S: Space>(&mut self) -> Affine<S> {
        Affine::new(self.linear::<S>(), self.vector())
    }
}
