//! Eight points at a time through the elements of a warp: the same operations as for one point, in vectors.
//!
//! Points that the plain way does not serve (on an element that decides alone, weights beyond their range) are left for the
//! caller, as are warps with oblique elements.
//!
//! *Source*: Milliron et al. 2002, eq. (3); the arrangement is a decision.

use super::elements::{Item, ON};
use super::weights::{Power, SAFE};
use anamorph_core::simd::{self, Block, LANES, Simd, f64x8, prelude::*};
use anamorph_core::{Linear, Space, math};

/// Squared lengths between these have a plain root; see [`Space::length`].
const PLAIN: core::ops::Range<f64> = 1e-280..1e280;

/// The image of eight points, and which of them, a bit each, are to be moved one by one.
#[inline(always)]
fn block<V: Simd, S: Space>(v: V, items: &[Item<S>], points: &[S; LANES]) -> (Block<V>, u8) {
    let number = |x: f64| simd::splat(v, x);
    let (zero, block) = (number(0.0), simd::read_block(v, points));
    let mut largest = zero;
    for coordinate in block.iter().take(S::DIM) {
        largest = largest.max(coordinate.abs());
    }
    let inside = |x: f64x8<V>, range: &core::ops::Range<f64>| {
        x.simd_ge(number(range.start)) & x.simd_lt(number(range.end))
    };
    let mut plain = zero.simd_eq(zero);
    let (mut moved, mut total) = ([zero; 3], zero);
    for item in items {
        let source = &item.pair.source;
        let corner = source.corner();
        let mut from = [zero; 3];
        for axis in 0..S::DIM {
            from[axis] = block[axis] - number(corner.component(axis));
        }
        let dot = |a: &Block<V>, b: &Block<V>| {
            let mut sum = a[0] * b[0];
            for axis in 1..S::DIM {
                sum += a[axis] * b[axis];
            }
            sum
        };
        let mut offset = from;
        let mut outside = zero.simd_lt(zero);
        for edge in 0..source.dimension() {
            let (vector, direction) = (source.edge(edge), source.direction(edge));
            let along = dot(
                &from,
                &core::array::from_fn(|axis| number(direction.component(axis))),
            );
            let before = along.simd_le(zero);
            let beyond = along.simd_ge(number(source.length(edge)));
            outside |= before | beyond;
            for (axis, offset) in offset.iter_mut().enumerate().take(S::DIM) {
                let between = number(direction.component(axis)) * along;
                let end = number(vector.component(axis));
                *offset -= before.select(zero, beyond.select(end, between));
            }
        }
        if source.dimension() == S::DIM {
            offset = offset.map(|coordinate| outside.select(coordinate, zero));
        }
        let squared = dot(&offset, &offset);
        plain &= inside(squared, &PLAIN) | squared.simd_eq(zero);
        let d = squared.sqrt();
        if item.weight.pins() {
            plain &= d.simd_gt(largest.max(number(item.reach)) * number(ON));
        }
        let base = number(item.weight.size) / (number(item.weight.constants.a) + d);
        let weight = match item.weight.power {
            Power::None => number(1.0),
            Power::Plain => base,
            Power::Square => base * base,
            Power::Cube => base * base * base,
            Power::Root => {
                plain &= inside(base, &SAFE);
                base.sqrt()
            }
            Power::Other(b) => {
                plain &= inside(base, &SAFE);
                let bases: [f64; LANES] = base.into();
                simd::lanes(v, |lane| math::pow(bases[lane], b))
            }
        };
        plain &= inside(weight, &SAFE);
        for (row, moved) in moved.iter_mut().enumerate().take(S::DIM) {
            let mut grown = number(item.growth.entry(row, 0)) * from[0];
            for (column, &from) in from.iter().enumerate().take(S::DIM).skip(1) {
                grown += number(item.growth.entry(row, column)) * from;
            }
            *moved += (number(item.shift.component(row)) + grown) * weight;
        }
        total += weight;
    }
    for row in moved.iter_mut().take(S::DIM) {
        *row /= total;
    }
    let mut odd = 0;
    if !plain.all_true() {
        for lane in (0..LANES).filter(|lane| plain.to_bitmask() >> lane & 1 == 0) {
            odd |= 1 << simd::point_of_lane::<S>(lane);
        }
    }
    (simd::moved_by::<V, S>(v, &block, &moved), odd)
}

/// Moves a run of points; `one` moves a point that the vectors do not serve.
#[inline(always)]
pub(super) fn run<V: Simd, S: Space>(
    v: V,
    items: &[Item<S>],
    points: &mut [S],
    one: &dyn Fn(S) -> S,
) {
    let mut blocks = simd::Blocks::new(points);
    while let Some(points) = blocks.next() {
        let before = *points;
        let (moved, odd) = block(v, items, points);
        simd::write_block(moved, points);
        for (i, (point, before)) in points.iter_mut().zip(before).enumerate() {
            if odd >> i & 1 == 1 {
                *point = one(before);
            }
        }
    }
    blocks.finish();
}
