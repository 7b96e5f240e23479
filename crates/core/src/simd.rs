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

/// Which of a block's points a lane holds. In space the lanes are not in the order of the points: that way a block takes
/// six blends and two rotations to read, and as many to write, instead of a shuffle for every coordinate.
#[inline(always)]
pub fn point_of_lane<S: Space>(lane: usize) -> usize {
    if S::DIM == 3 { 3 * lane % LANES } else { lane }
}

/// Coordinates of eight points; lane `i` is that of point [`point_of_lane`]`(i)`.
#[inline(always)]
pub fn read_block<V: Simd, S: Space>(simd: V, points: &[S; LANES]) -> Block<V> {
    if S::DIM == 3
        && let ([a, b, c], []) = S::coordinates(points).as_chunks::<LANES>()
    {
        let rows = [a, b, c].map(|row| f64x8::simd_from(simd, *row));
        return [
            every_third(simd, rows, 0),
            rotated::<V, 1>(every_third(simd, rows, 1)),
            rotated::<V, 2>(every_third(simd, rows, 2)),
        ];
    }
    core::array::from_fn(|axis| {
        if axis < S::DIM {
            f64x8::from_fn(simd, |lane| points[lane].component(axis))
        } else {
            f64x8::splat(simd, 0.0)
        }
    })
}

/// Eight points from their coordinates, in the order of [`read_block`].
#[inline(always)]
pub fn write_block<V: Simd, S: Space>(block: Block<V>, points: &mut [S; LANES]) {
    let simd = block[0].simd;
    if S::DIM == 3
        && let ([a, b, c], []) = S::coordinates_mut(points).as_chunks_mut::<LANES>()
    {
        let rows = [
            block[0],
            rotated::<V, 7>(block[1]),
            rotated::<V, 6>(block[2]),
        ];
        // Place `i` of row `r` is coordinate `8 r + i`, of axis `(8 r + i) mod 3`.
        *a = every_third(simd, rows, 0).into();
        *b = every_third(simd, [rows[2], rows[0], rows[1]], 0).into();
        *c = every_third(simd, [rows[1], rows[2], rows[0]], 0).into();
        return;
    }
    let rows: [[f64; LANES]; 3] = [block[0].into(), block[1].into(), block[2].into()];
    for (lane, point) in points.iter_mut().enumerate() {
        *point = S::from_fn(|axis| rows[axis][lane]);
    }
}

/// Blends three rows: lane `i` is taken from row `(i + 3 − shift) mod 3` of them, counted so that with consecutive
/// coordinates in the rows the lanes hold the coordinates of axis `shift`.
#[inline(always)]
fn every_third<V: Simd>(simd: V, rows: [f64x8<V>; 3], shift: usize) -> f64x8<V> {
    // Lanes 0, 3, 6; then 1, 4, 7; then 2, 5.
    const THIRDS: [u64; 3] = [0b0100_1001, 0b1001_0010, 0b0010_0100];
    let first = mask64x8::from_bitmask(simd, THIRDS[shift % 3]);
    let second = mask64x8::from_bitmask(simd, THIRDS[(shift + 1) % 3]);
    first.select(rows[0], second.select(rows[1], rows[2]))
}

/// The lanes rotated down by `N`: lane `i` is what was lane `i + N`.
#[inline(always)]
fn rotated<V: Simd, const N: usize>(row: f64x8<V>) -> f64x8<V> {
    row.slide::<N>(row)
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

/// Writes eight points moved from `before` by vectors. A point whose image is not finite stays; its bit is set in the
/// result.
#[inline(always)]
pub fn settle<V: Simd, S: Space>(
    simd: V,
    before: &Block<V>,
    by: &Block<V>,
    points: &mut [S; LANES],
) -> u8 {
    let moved = moved_by::<V, S>(simd, before, by);
    let lost = not_finite::<V, S>(simd, &moved);
    if lost == 0 {
        write_block(moved, points);
        return 0;
    }
    let still = *points;
    write_block(moved, points);
    for (i, (point, still)) in points.iter_mut().zip(still).enumerate() {
        if lost >> i & 1 == 1 {
            *point = still;
        }
    }
    lost
}

/// Which of eight points, a bit each, have a coordinate that is not finite.
#[inline(always)]
pub fn not_finite<V: Simd, S: Space>(simd: V, block: &Block<V>) -> u8 {
    // Zero times a number is zero exactly if it is finite.
    let zero = f64x8::splat(simd, 0.0);
    let mut probe = zero;
    for coordinate in block.iter().take(S::DIM) {
        probe += *coordinate * zero;
    }
    if probe.simd_eq(zero).all_true() {
        return 0;
    }
    let probes: [f64; LANES] = probe.into();
    let bit = |(lane, probe): (usize, &f64)| u8::from(probe.is_nan()) << point_of_lane::<S>(lane);
    probes.iter().enumerate().map(bit).sum()
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

/// Natural logarithms of eight positive normal numbers; equal to [`crate::math::ln_positive`] bit for bit.
#[inline(always)]
pub fn ln_positive<V: Simd>(simd: V, x: f64x8<V>) -> f64x8<V> {
    let [ln] = ln_positive_each(simd, [x]);
    ln
}

/// [`ln_positive`] of several vectors, all of them a step at a time: one logarithm is a long chain of operations that wait for each
/// other, and a processor looks only so far ahead for others that need not.
#[inline(always)]
pub fn ln_positive_each<V: Simd, const N: usize>(simd: V, x: [f64x8<V>; N]) -> [f64x8<V>; N] {
    let c = |value: f64| f64x8::splat(simd, value);
    let bit = |value: u64| u64x8::splat(simd, value);
    let zero = c(0.0);
    let (mut k, mut f, mut half, mut s) = ([zero; N], [zero; N], [zero; N], [zero; N]);
    for i in 0..N {
        let shifted = x[i].bitcast::<u64x8<V>>() + bit(ONE - ROOT_HALF);
        k[i] = ((shifted >> 52) | bit(TWO_52)).bitcast::<f64x8<V>>() - c(TWO_52_BIASED);
        f[i] = ((shifted & bit(MANTISSA)) + bit(ROOT_HALF)).bitcast::<f64x8<V>>() - c(1.0);
    }
    for i in 0..N {
        s[i] = f[i] / (c(2.0) + f[i]);
        half[i] = c(0.5) * f[i] * f[i];
    }
    let (mut z, mut w) = ([zero; N], [zero; N]);
    for i in 0..N {
        z[i] = s[i] * s[i];
        w[i] = z[i] * z[i];
    }
    let (mut even, mut odd) = ([zero; N], [zero; N]);
    for i in 0..N {
        even[i] = c(LN[3]) + w[i] * c(LN[5]);
        odd[i] = c(LN[4]) + w[i] * c(LN[6]);
    }
    for i in 0..N {
        even[i] = c(LN[1]) + w[i] * even[i];
        odd[i] = c(LN[2]) + w[i] * odd[i];
    }
    for i in 0..N {
        even[i] = w[i] * even[i];
        odd[i] = z[i] * (c(LN[0]) + w[i] * odd[i]);
    }
    for i in 0..N {
        s[i] *= half[i] + (even[i] + odd[i]);
    }
    for i in 0..N {
        s[i] = s[i] + k[i] * c(LN_2_2) - half[i] + f[i] + k[i] * c(LN_2_1);
    }
    s
}

/// Exponentials of eight numbers that are not positive; equal to [`crate::math::exp_negative`] bit for bit.
#[inline(always)]
pub fn exp_negative<V: Simd>(simd: V, x: f64x8<V>) -> f64x8<V> {
    let c = |value: f64| f64x8::splat(simd, value);
    let shifted = x * c(core::f64::consts::LOG2_E) + c(ROUNDER);
    let k = shifted - c(ROUNDER);
    let (high, low) = (x - k * c(LN_2_1), k * c(LN_2_2));
    let r = high - low;
    let z = r * r;
    let tail = c(EXP[1]) + z * (c(EXP[2]) + z * (c(EXP[3]) + z * c(EXP[4])));
    let t = r - z * (c(EXP[0]) + z * tail);
    let y = c(1.0) + (r * t / (c(2.0) - t) - low + high);
    let power = (shifted.bitcast::<u64x8<V>>() + u64x8::splat(simd, 1023)) << 52;
    let value = y * power.bitcast::<f64x8<V>>();
    x.simd_lt(c(LEAST_EXPONENT)).select(c(0.0), value)
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

    #[test]
    fn logarithms_and_exponentials_equal_scalars_bit_for_bit() {
        for i in 0..40_000 {
            let x: [f64; LANES] = core::array::from_fn(|lane| {
                let number = f64::from(i * 8 + lane as i32);
                [math::pow(10.0, number * 1e-3 - 150.0), 0.5 + number * 1e-5][i as usize % 2]
            });
            let y = x.map(|x| -(math::ln(x) + 346.0).abs() * 2.2);
            let (ln, exp): ([f64; LANES], [f64; LANES]) = dispatch!(Level::new(), simd => {
                let x = f64x8::simd_from(simd, x);
                let [ln, _, again] = ln_positive_each(simd, [x, splat(simd, 2.0), x]);
                assert!(ln.simd_eq(again).all_true());
                assert!(ln.simd_eq(ln_positive(simd, x)).all_true());
                let exp = exp_negative(simd, f64x8::simd_from(simd, y));
                (ln.into(), exp.into())
            });
            for lane in 0..LANES {
                assert_eq!(ln[lane].to_bits(), math::ln_positive(x[lane]).to_bits());
                let plain = math::exp_negative(y[lane]);
                assert_eq!(exp[lane].to_bits(), plain.to_bits(), "exp {}", y[lane]);
            }
        }
    }

    fn numbered<S: Space>() -> [S; LANES] {
        core::array::from_fn(|i| S::from_fn(|axis| (10 * i + axis) as f64))
    }

    /// What a block holds, and what `settle` makes of it when point 5 and one more go to infinity.
    #[inline(always)]
    fn read_and_settle<V: Simd, S: Space>(simd: V) -> ([[f64; LANES]; 3], [S; LANES], u8) {
        let mut points = numbered::<S>();
        let block = read_block(simd, &points);
        let mut by = [f64x8::splat(simd, 0.5); 3];
        by[S::DIM - 1] = block[0]
            .simd_eq(f64x8::splat(simd, 50.0))
            .select(f64x8::splat(simd, f64::INFINITY), f64x8::splat(simd, 0.5));
        let lost = settle(simd, &block, &by, &mut points);
        (block.map(Into::into), points, lost)
    }

    fn check_blocks<S: Space>() {
        let (block, points, lost) = dispatch!(Level::new(), simd => read_and_settle::<_, S>(simd));
        for (i, &p) in numbered::<S>().iter().enumerate() {
            let lane = (0..LANES).find(|&lane| point_of_lane::<S>(lane) == i);
            let lane = lane.expect("every point has a lane");
            for (axis, row) in block.iter().enumerate() {
                assert_eq!(row[lane], p.component(axis));
            }
            let moved = if i == 5 { p } else { p + S::splat(0.5) };
            assert_eq!(points[i], moved, "point {i}");
        }
        assert_eq!(lost, 1 << 5);
    }

    #[test]
    fn blocks_hold_every_point_and_keep_the_lost() {
        check_blocks::<Solid>();
        check_blocks::<crate::Plane>();
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
