//! The sum of radial basis functions at one point, and at eight at a time: the same operations, the same bits.
//!
//! The work is points times centres, the memory that of the centres.
//!
//! *Source*: Arad et al. 1994; the arrangement is a decision.

use super::kernels::Profile;
use super::{Terms, squared};
use anamorph_core::Space;
use anamorph_core::simd::{self, LANES, Simd, prelude::*};

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

/// Moves a run of points.
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
        for (c, at) in terms.coefficients.iter().zip(&terms.places) {
            let d = place[0] - number(at.component(0));
            let mut q = d * d;
            for (axis, &place) in place.iter().enumerate().take(S::DIM).skip(1) {
                let d = place - number(at.component(axis));
                q += d * d;
            }
            if P::COMPACT && q.simd_ge(number(1.0)).all_true() {
                continue;
            }
            let value = P::values(v, q);
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
