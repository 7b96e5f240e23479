//! Moving whole models: runs of points, threads, and 32-bit coordinates at the edge.
//!
//! Decision: results are bit-identical for any thread count, because a deformation moves every point on its own and runs
//! are cut at fixed places.

use crate::{Deformation, Space, Unmapped};

/// Points a task moves at a time: 192 KiB of 3-D points, large enough to hide the cost of handing it out.
const TASK: usize = 8192;
/// Points whose places are remembered at a time, so that one that cannot be moved can be put back.
const RUN: usize = 512;

/// Whether all points are finite. Zero times a number is zero exactly if it is finite; sixteen sums, so that no addition
/// waits for the last.
#[cfg(feature = "simd")]
pub(crate) fn all_finite<S: Space>(points: &[S]) -> bool {
    const SUMS: usize = 16;
    #[inline(always)]
    fn sums(numbers: &[f64]) -> f64 {
        let (blocks, rest) = numbers.as_chunks::<SUMS>();
        let mut sums = [0.0; SUMS];
        for block in blocks {
            for (sum, &number) in sums.iter_mut().zip(block) {
                *sum += number * 0.0;
            }
        }
        let rest = rest.iter().map(|&number| number * 0.0);
        sums.iter().sum::<f64>() + rest.sum::<f64>()
    }
    let level = crate::simd::Level::new();
    crate::simd::dispatch!(level, _v => sums(S::coordinates(points))) == 0.0
}

/// Whether all points are finite.
#[cfg(not(feature = "simd"))]
pub(crate) fn all_finite<S: Space>(points: &[S]) -> bool {
    points.iter().all(|p| p.is_finite())
}

/// Moves a run and puts back, and names, points whose image is not finite though they were.
fn map_run<S: Space, D: Deformation<S> + ?Sized>(
    deformation: &D,
    first: usize,
    points: &mut [S],
) -> Unmapped {
    if deformation.keeps_finite() {
        return deformation.map_points(first, points);
    }
    let mut unmapped = Unmapped::none();
    let mut rest = [S::ZERO; RUN];
    for (run, chunk) in points.chunks_mut(RUN).enumerate() {
        let first = first + run * RUN;
        let rest = &mut rest[..chunk.len()];
        rest.copy_from_slice(chunk);
        let named = deformation.map_points(first, chunk);
        for &index in named.indices() {
            if let Some(i) = index.checked_sub(first).filter(|&i| i < rest.len()) {
                chunk[i] = rest[i];
            }
        }
        unmapped.append(named);
        if !all_finite(chunk) {
            for (i, (point, &p)) in chunk.iter_mut().zip(rest.iter()).enumerate() {
                if !point.is_finite() {
                    *point = p;
                    unmapped.push(first + i);
                }
            }
        }
    }
    unmapped
}

/// Moves all points of a model (indices from 0) in place, on one thread.
///
/// A point whose image is not finite (a coordinate overflowed, or was not finite to begin with) stays where it was and is
/// named in the result.
pub fn map_all<S: Space, D: Deformation<S> + ?Sized>(
    deformation: &D,
    points: &mut [S],
) -> Unmapped {
    let mut unmapped = Unmapped::none();
    for (task, chunk) in points.chunks_mut(TASK).enumerate() {
        unmapped.append(map_run(deformation, task * TASK, chunk));
    }
    unmapped.tidy();
    unmapped
}

/// As [`map_all`], on the threads of rayon's current pool. `done(n)` is called from any thread when `n` more points have
/// moved.
#[cfg(feature = "parallel")]
pub fn map_all_parallel<S: Space, D: Deformation<S> + ?Sized>(
    deformation: &D,
    points: &mut [S],
    done: &(dyn Fn(usize) + Sync),
) -> Unmapped {
    use rayon::prelude::*;
    let mut parts: Vec<Unmapped> = points
        .par_chunks_mut(TASK)
        .enumerate()
        .map(|(task, chunk)| {
            let unmapped = map_run(deformation, task * TASK, chunk);
            done(chunk.len());
            unmapped
        })
        .filter(|unmapped| !unmapped.is_empty())
        .collect();
    let mut unmapped = Unmapped::none();
    parts.drain(..).for_each(|part| unmapped.append(part));
    unmapped.tidy();
    unmapped
}

/// Moves points held as arrays of 32-bit coordinates, `N` of which (2 or 3) are those of the space: computed in `f64`,
/// rounded once. Extra coordinates of a wider array stay as they are.
pub fn map_all_f32<S: Space, D: Deformation<S> + ?Sized, const N: usize>(
    deformation: &D,
    points: &mut [[f32; N]],
) -> Unmapped {
    let mut unmapped = Unmapped::none();
    let mut wide = [S::ZERO; RUN];
    for (run, chunk) in points.chunks_mut(RUN).enumerate() {
        let wide = &mut wide[..chunk.len()];
        for (w, p) in wide.iter_mut().zip(chunk.iter()) {
            *w = S::from_fn(|axis| p.get(axis).copied().map_or(0.0, f64::from));
        }
        unmapped.append(map_run(deformation, run * RUN, wide));
        for (i, (p, w)) in chunk.iter_mut().zip(wide.iter()).enumerate() {
            let narrow: [f32; N] = core::array::from_fn(|axis| {
                // The edge of the format: rounding to f32 is what the caller asked for.
                #[allow(clippy::cast_possible_truncation)]
                if axis < S::DIM {
                    w.component(axis) as f32
                } else {
                    p[axis]
                }
            });
            if narrow.iter().all(|c| c.is_finite()) {
                *p = narrow;
            } else {
                unmapped.push(run * RUN + i);
            }
        }
    }
    unmapped.tidy();
    unmapped
}
