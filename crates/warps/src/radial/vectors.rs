//! The sum of radial basis functions at one point, and at eight at a time: the same operations, the same bits.
//!
//! The work is points times centres, the memory that of the centres.
//!
//! *Source*: Arad et al. 1994; the arrangement is a decision.

use super::kernels::{Profile, TOGETHER};
use super::{Terms, squared};
use anamorph_core::Space;
use anamorph_core::simd::{self, LANES, Simd, f64x8, prelude::*};

/// The image of a point.
pub(super) fn one<P: Profile, S: Space>(terms: &Terms<S>, p: S) -> S {
    let place = terms.place(p);
    let mut moved = S::ZERO;
    for (&c, &at) in terms.coefficients.iter().zip(&terms.places) {
        moved += c * P::value(squared(place, at));
    }
    for (axis, &a) in terms.affine.iter().enumerate() {
        let strength = if axis == 0 {
            1.0
        } else {
            place.component(axis - 1)
        };
        moved += a * strength;
    }
    p.moved_by(moved)
}

/// Squared distances of eight places from a centre; the operations of [`squared`].
#[inline(always)]
fn apart<V: Simd, S: Space>(v: V, place: &simd::Block<V>, at: S) -> f64x8<V> {
    let d = place[0] - simd::splat(v, at.component(0));
    let mut q = d * d;
    for (axis, &place) in place.iter().enumerate().take(S::DIM).skip(1) {
        let d = place - simd::splat(v, at.component(axis));
        q += d * d;
    }
    q
}

/// Moves a run of points. Centres are taken four at a time, and added one after the other.
#[inline(always)]
pub(super) fn run<V: Simd, P: Profile, S: Space>(v: V, terms: &Terms<S>, points: &mut [S]) {
    let number = |x: f64| simd::splat(v, x);
    let mut blocks = simd::Blocks::new(points);
    while let Some(points) = blocks.next() {
        let points: &mut [S; LANES] = points;
        let block = simd::read_block(v, points);
        let mut place = [number(0.0); 3];
        for axis in 0..S::DIM {
            place[axis] =
                (block[axis] - number(terms.centre.component(axis))) * number(terms.scale);
        }
        let mut moved = [number(0.0); 3];
        let (groups, rest) = terms.places.as_chunks::<TOGETHER>();
        let (shares, last) = terms.coefficients.as_chunks::<TOGETHER>();
        for (group, shares) in groups.iter().zip(shares) {
            let mut q = [number(0.0); TOGETHER];
            for (q, &at) in q.iter_mut().zip(group) {
                *q = apart::<V, S>(v, &place, at);
            }
            if P::COMPACT && q.iter().all(|q| q.simd_ge(number(1.0)).all_true()) {
                continue;
            }
            let values = P::values_of_each(v, q);
            for (&c, value) in shares.iter().zip(values) {
                for (axis, moved) in moved.iter_mut().enumerate().take(S::DIM) {
                    *moved += number(c.component(axis)) * value;
                }
            }
        }
        for (&c, &at) in last.iter().zip(rest) {
            let value = P::values(v, apart::<V, S>(v, &place, at));
            for (axis, moved) in moved.iter_mut().enumerate().take(S::DIM) {
                *moved += number(c.component(axis)) * value;
            }
        }
        for (k, a) in terms.affine.iter().enumerate() {
            for (axis, moved) in moved.iter_mut().enumerate().take(S::DIM) {
                let coefficient = number(a.component(axis));
                *moved += match k {
                    0 => coefficient,
                    k => coefficient * place[k - 1],
                };
            }
        }
        simd::write_block(simd::moved_by::<V, S>(v, &block, &moved), points);
    }
    blocks.finish();
}
