//! Blocks of eight points for kernels: explicit vectors with run-time dispatch.
//!
//! A kernel is a function generic over [`Simd`], called through [`dispatch!`], that reads points in blocks of [`LANES`]
//! ([`Blocks`]), one vector per coordinate. Every operation is an IEEE 754 operation on each lane and none is fused, so that results
//! do not depend on the processor or on how a model is cut into runs.
//!
//! Decision: explicit vectors of a fixed width of eight, rather than auto-vectorized arrays, because the compiler's
//! vectorizer gave code between a tenth and all of the speed depending on the surroundings.

use crate::{Space, math::constants::*};
pub use fearless_simd::{self, Level, Simd, dispatch, f64x8, mask64x8, prelude};
use fearless_simd::{prelude::*, u64x8};

/// Points in a block.
pub const LANES: usize = 8;

/// The coordinates of a block of points, one vector an axis; axes the space lacks are zero.
pub type Block<V> = [f64x8<V>; 3];

/// A vector with the same number in every lane.
#[inline(always)]
pub fn splat<V: Simd>(simd: V, value: f64) -> f64x8<V> {
    f64x8::splat(simd, value)
}

/// A vector from a number per lane.
#[inline(always)]
pub fn lanes<V: Simd>(simd: V, number: impl FnMut(usize) -> f64) -> f64x8<V> {
    f64x8::from_fn(simd, number)
}

/// Coordinates of eight points.
#[inline(always)]
pub fn read_block<V: Simd, S: Space>(simd: V, points: &[S; LANES]) -> Block<V> {
    core::array::from_fn(|axis| {
        if axis < S::DIM {
            f64x8::from_fn(simd, |lane| points[lane].component(axis))
        } else {
            f64x8::splat(simd, 0.0)
        }
    })
}

/// Eight points from their coordinates.
#[inline(always)]
pub fn write_block<V: Simd, S: Space>(block: Block<V>, points: &mut [S; LANES]) {
    let rows: [[f64; LANES]; 3] = [block[0].into(), block[1].into(), block[2].into()];
    for (lane, point) in points.iter_mut().enumerate() {
        *point = S::from_fn(|axis| rows[axis][lane]);
    }
}

/// Eight points moved by vectors; equal to [`Space::moved_by`] bit for bit. Axes the space lacks stay.
#[inline(always)]
pub fn moved_by<V: Simd, S: Space>(simd: V, points: &Block<V>, by: &Block<V>) -> Block<V> {
    let zero = f64x8::splat(simd, 0.0);
    let mut moved = *points;
    for axis in 0..S::DIM {
        let (p, d) = (points[axis], by[axis]);
        moved[axis] = d.simd_eq(zero).select(p, p + d);
    }
    moved
}

/// The points of a run in blocks of eight, one after the other; the last, shorter one is padded with its own last point.
///
/// A lending iterator rather than a function that takes a closure: a closure that the compiler does not inline loses the
/// processor's vector instructions, and with them the speed.
///
/// ```
/// use anamorph_core::{Solid, simd::Blocks};
///
/// let mut points = vec![Solid::ZERO; 11];
/// let mut blocks = Blocks::new(&mut points);
/// while let Some(block) = blocks.next() {
///     block.iter_mut().for_each(|p| *p += Solid::X);
/// }
/// blocks.finish();
/// assert!(points.iter().all(|&p| p == Solid::X));
/// ```
pub struct Blocks<'a, S> {
    blocks: core::slice::IterMut<'a, [S; LANES]>,
    rest: &'a mut [S],
    padded: [S; LANES],
    pending: bool,
}

impl<'a, S: Space> Blocks<'a, S> {
    /// Blocks over `points`.
    #[inline(always)]
    pub fn new(points: &'a mut [S]) -> Self {
        let (blocks, rest) = points.as_chunks_mut::<LANES>();
        let mut padded = [rest.last().copied().unwrap_or(S::ZERO); LANES];
        padded[..rest.len()].copy_from_slice(rest);
        let pending = !rest.is_empty();
        Self {
            blocks: blocks.iter_mut(),
            rest,
            padded,
            pending,
        }
    }

    /// The next block to change in place.
    #[allow(clippy::should_implement_trait)] // it lends from itself, which `Iterator` cannot say
    #[inline(always)]
    pub fn next(&mut self) -> Option<&mut [S; LANES]> {
        if let Some(block) = self.blocks.next() {
            return Some(block);
        }
        if self.pending {
            self.pending = false;
            return Some(&mut self.padded);
        }
        None
    }

    /// Puts the padded block back. Without it the last points of a run that is no multiple of eight stay unchanged.
    #[inline(always)]
    pub fn finish(self) {
        let count = self.rest.len();
        self.rest.copy_from_slice(&self.padded[..count]);
    }
}

/// Sine and cosine of eight angles in radians; equal to [`crate::math::sin_cos`] bit for bit.
#[inline(always)]
pub fn sin_cos<V: Simd>(simd: V, angle: f64x8<V>) -> (f64x8<V>, f64x8<V>) {
    let c = |value: f64| f64x8::splat(simd, value);
    let shifted = angle * c(core::f64::consts::FRAC_2_PI) + c(ROUNDER);
    let k = shifted - c(ROUNDER);
    let quadrant = shifted.bitcast::<u64x8<V>>();
    let r1 = angle - k * c(HALF_PI_1);
    let r2 = k * c(HALF_PI_2);
    let r = r1 - r2;
    let tail = ((r1 - r) - r2) - k * c(HALF_PI_3);

    let z = r * r;
    let sin_poly = c(SIN[1]) + z * (c(SIN[2]) + z * (c(SIN[3]) + z * (c(SIN[4]) + z * c(SIN[5]))));
    let v = z * r;
    let sin = r - ((z * (c(0.5) * tail - v * sin_poly) - tail) - v * c(SIN[0]));
    let cos_poly = z
        * (c(COS[0])
            + z * (c(COS[1])
                + z * (c(COS[2]) + z * (c(COS[3]) + z * (c(COS[4]) + z * c(COS[5]))))));
    let half = c(0.5) * z;
    let one = c(1.0) - half;
    let cos = one + (((c(1.0) - one) - half) + (z * cos_poly - r * tail));

    let bit = |value: u64| u64x8::splat(simd, value);
    let swap = (quadrant & bit(1)).simd_eq(bit(1));
    let (s, co) = (swap.select(cos, sin), swap.select(sin, cos));
    let s_sign = (quadrant & bit(2)) << 62;
    let c_sign = ((quadrant + bit(1)) & bit(2)) << 62;
    let mut sin = (s.bitcast::<u64x8<V>>() ^ s_sign).bitcast::<f64x8<V>>();
    let mut cos = (co.bitcast::<u64x8<V>>() ^ c_sign).bitcast::<f64x8<V>>();

    // Beyond the reduction's reach (or not finite): rare, lane by lane.
    if !angle.abs().simd_le(c(REDUCIBLE)).all_true() {
        let angles: [f64; LANES] = angle.into();
        let pairs = angles.map(crate::math::sin_cos);
        sin = f64x8::from_fn(simd, |lane| pairs[lane].0);
        cos = f64x8::from_fn(simd, |lane| pairs[lane].1);
    }
    (sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Solid, math};

    #[test]
    fn vectors_equal_scalars_bit_for_bit() {
        let mut state = 1_u64;
        for round in 0..2000 {
            let angles: [f64; LANES] = core::array::from_fn(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                let unit = (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
                unit * [1.0, 10.0, 1e4, 3e5][round % 4]
            });
            let (s, c): ([f64; LANES], [f64; LANES]) = dispatch!(Level::new(), simd => {
                let (s, c) = sin_cos(simd, f64x8::simd_from(simd, angles));
                (s.into(), c.into())
            });
            for lane in 0..LANES {
                assert_eq!(
                    s[lane].to_bits(),
                    math::sin(angles[lane]).to_bits(),
                    "sin {}",
                    angles[lane]
                );
                assert_eq!(
                    c[lane].to_bits(),
                    math::cos(angles[lane]).to_bits(),
                    "cos {}",
                    angles[lane]
                );
            }
        }
    }

    #[inline(always)]
    fn add_one<V: Simd>(simd: V, points: &mut [Solid]) {
        let mut blocks = Blocks::new(points);
        while let Some(block) = blocks.next() {
            let moved = read_block(simd, block).map(|c| c + splat(simd, 1.0));
            write_block(moved, block);
        }
        blocks.finish();
    }

    #[test]
    fn blocks_cover_every_point_once() {
        for count in 0..40 {
            let mut points: Vec<Solid> = (0..count).map(|i| Solid::splat(f64::from(i))).collect();
            dispatch!(Level::new(), simd => add_one(simd, &mut points));
            let expected: Vec<Solid> = (0..count)
                .map(|i| Solid::splat(f64::from(i) + 1.0))
                .collect();
            assert_eq!(points, expected);
        }
    }
}
