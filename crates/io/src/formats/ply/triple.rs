//! Vectors whose three numbers are of one floating type and stand side by side in rows of equal length: how nearly all
//! binary files hold coordinates and normals. They are read and written a vector at a time, where
//! [`Scalar`](super::scalar::Scalar) takes each number on its own.

use super::scalar::{Order, Scalar};
use super::{Column, Strided};
use crate::normals::same;
use crate::text;
use anamorph_core::glam::DVec3;

/// Where the vectors of an element stand.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triple {
    /// Bytes of a row.
    stride: usize,
    /// Bytes of a row before the vector.
    start: usize,
    number: Number,
}

/// The type of the numbers and their byte order.
#[derive(Debug, Clone, Copy)]
enum Number {
    SingleLittle,
    SingleBig,
    DoubleLittle,
    DoubleBig,
}

/// Calls `$call` with the number of bytes of a vector, how it is read and how it is written.
macro_rules! by_number {
    ($number:expr, $call:ident($($argument:expr),*)) => {
        match $number {
            Number::SingleLittle => $call::<12, 4>(
                $($argument,)* |n| f64::from(f32::from_le_bytes(n)), |x| (x as f32).to_le_bytes()),
            Number::SingleBig => $call::<12, 4>(
                $($argument,)* |n| f64::from(f32::from_be_bytes(n)), |x| (x as f32).to_be_bytes()),
            Number::DoubleLittle => $call::<24, 8>(
                $($argument,)* f64::from_le_bytes, f64::to_le_bytes),
            Number::DoubleBig => $call::<24, 8>(
                $($argument,)* f64::from_be_bytes, f64::to_be_bytes),
        }
    };
}

impl Triple {
    /// The vectors of three columns of an element, if they stand so.
    pub(super) fn of(columns: &[Column], layout: Strided<'_>) -> Option<Self> {
        let &[(x, scalar), (y, second), (z, third)] = columns else {
            return None;
        };
        let number = match (scalar, layout.order) {
            (Scalar::F32, Order::Little) => Number::SingleLittle,
            (Scalar::F32, Order::Big) => Number::SingleBig,
            (Scalar::F64, Order::Little) => Number::DoubleLittle,
            (Scalar::F64, Order::Big) => Number::DoubleBig,
            _ => return None,
        };
        let alike = scalar == second && scalar == third;
        let Strided { stride, spots, .. } = layout;
        let start = spots[x].start;
        let beside = spots[y].start == start + scalar.size()
            && spots[z].start == start + 2 * scalar.size()
            && start + 3 * scalar.size() <= stride;
        (alike && beside).then_some(Self {
            stride,
            start,
            number,
        })
    }

    /// The vectors of all rows.
    pub(super) fn read(self, rows: &[u8]) -> Vec<DVec3> {
        by_number!(self.number, read(self, rows))
    }

    /// Writes a new vector into each row; where the old one is not finite, it stays. The new ones must be finite, in this
    /// type. The result is how many differ from the old ones in any bit.
    pub(super) fn write(self, rows: &mut [u8], new: &[DVec3]) -> usize {
        by_number!(self.number, write(self, rows, new))
    }

    /// Whether all vectors are finite, also once they are rounded to this type.
    pub(super) fn holds(self, vectors: &[DVec3]) -> bool {
        let runs: Vec<&[DVec3]> = vectors.chunks(RUN).collect();
        let single = matches!(self.number, Number::SingleLittle | Number::SingleBig);
        let held = text::map(&runs, |run| {
            if single {
                all_finite(run, |x| f64::from(x as f32))
            } else {
                all_finite(run, |x| x)
            }
        });
        held.iter().all(|held| *held)
    }
}

/// Vectors checked together.
const RUN: usize = 1 << 14;

/// Whether what becomes of all numbers is finite. Zero times a number is zero only then; adding that up takes no branch.
#[inline(always)]
pub(super) fn all_finite(vectors: &[DVec3], rounded: impl Fn(f64) -> f64) -> bool {
    let sum = vectors.iter().fold(DVec3::ZERO, |sum, vector| {
        sum + DVec3::from_array(vector.to_array().map(&rounded)) * 0.0
    });
    sum == DVec3::ZERO
}

/// The vector in the `BYTES` bytes of its three numbers of `SIZE` bytes.
#[inline(always)]
fn vector<const BYTES: usize, const SIZE: usize>(
    bytes: &[u8; BYTES],
    from: impl Fn([u8; SIZE]) -> f64,
) -> DVec3 {
    match bytes.as_chunks::<SIZE>().0 {
        [x, y, z] => DVec3::new(from(*x), from(*y), from(*z)),
        // There are three.
        _ => DVec3::ZERO,
    }
}

fn read<const BYTES: usize, const SIZE: usize>(
    triple: Triple,
    rows: &[u8],
    from: impl Fn([u8; SIZE]) -> f64 + Sync,
    _: impl Fn(f64) -> [u8; SIZE],
) -> Vec<DVec3> {
    text::rows(rows, triple.stride, |row| {
        // There are so many: `Triple::of` has seen to that.
        row[triple.start..]
            .first_chunk::<BYTES>()
            .map_or(DVec3::ZERO, |bytes| vector(bytes, &from))
    })
}

fn write<const BYTES: usize, const SIZE: usize>(
    triple: Triple,
    rows: &mut [u8],
    new: &[DVec3],
    from: impl Fn([u8; SIZE]) -> f64,
    to: impl Fn(f64) -> [u8; SIZE],
) -> usize {
    let mut moved = 0;
    for (row, &new) in rows.chunks_exact_mut(triple.stride).zip(new) {
        let Some(bytes) = row[triple.start..].first_chunk_mut::<BYTES>() else {
            continue;
        };
        let old = vector(bytes, &from);
        if !old.is_finite() {
            continue;
        }
        moved += usize::from(!same(old, new));
        // A number that has not changed gets the bytes it has.
        if let [x, y, z] = bytes.as_chunks_mut::<SIZE>().0 {
            (*x, *y, *z) = (to(new.x), to(new.y), to(new.z));
        }
    }
    moved
}
