//! Elements of one list of 32-bit whole numbers, each list counted by a byte: how binary files hold their faces. One walk
//! tells where the lists end, whether they are equally long, and whether they can be faces.

use super::header::{Element, Kind};
use super::scalar::{Order, Scalar};
use crate::text;

/// Lists looked at together.
const RUN: usize = 1 << 14;

/// What a walk found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Lists {
    /// Bytes of all lists with their counts.
    pub(super) length: usize,
    /// The number of items that every list has, if that is one number.
    pub(super) alike: Option<usize>,
    /// Whether each list has three items or more, all of them below the limit.
    pub(super) sound: bool,
}

/// Whether an element is of this kind.
pub(super) fn fits(element: &Element) -> bool {
    matches!(
        element.properties.as_slice(),
        [property] if matches!(
            property.kind,
            Kind::List {
                count: Scalar::U8,
                item: Scalar::I32 | Scalar::U32
            }
        )
    )
}

/// Walks the lists of `rows` rows, at least one, from the beginning of `bytes`. Items are sound below `limit`, which is at
/// most 2³¹: a negative one is larger as an unsigned number. `None` if the bytes end before the lists.
pub(super) fn walk(bytes: &[u8], rows: usize, order: Order, limit: u32) -> Option<Lists> {
    match order {
        Order::Little => walk_as(bytes, rows, limit, u32::from_le_bytes),
        Order::Big => walk_as(bytes, rows, limit, u32::from_be_bytes),
    }
}

fn walk_as(
    bytes: &[u8],
    rows: usize,
    limit: u32,
    value: impl Fn([u8; 4]) -> u32 + Sync,
) -> Option<Lists> {
    let &count = bytes.first()?;
    let stride = 1 + 4 * usize::from(count);
    let whole = rows
        .checked_mul(stride)
        .and_then(|length| bytes.get(..length));
    if let Some(whole) = whole {
        let runs: Vec<&[u8]> = whole.chunks(stride * RUN).collect();
        // The usual counts as constants: the loop over the items is unrolled.
        let found = match count {
            3 => text::map(&runs, |run| equal(run, 3, limit, &value)),
            4 => text::map(&runs, |run| equal(run, 4, limit, &value)),
            _ => text::map(&runs, |run| equal(run, count, limit, &value)),
        };
        if found.iter().all(|(alike, _)| *alike) {
            return Some(Lists {
                length: whole.len(),
                alike: Some(count.into()),
                sound: count >= 3 && found.iter().all(|(_, sound)| *sound),
            });
        }
    }
    let (mut rest, mut fewest, mut largest) = (bytes, u8::MAX, 0);
    for _ in 0..rows {
        let (&count, behind) = rest.split_first()?;
        let (items, behind) = behind.split_at_checked(4 * usize::from(count))?;
        fewest = fewest.min(count);
        largest = greatest(items, largest, &value);
        rest = behind;
    }
    Some(Lists {
        length: bytes.len() - rest.len(),
        alike: None,
        sound: fewest >= 3 && largest < limit,
    })
}

/// Whether all lists of a run have `count` items, and whether these are all below the limit.
#[inline(always)]
fn equal(run: &[u8], count: u8, limit: u32, value: &impl Fn([u8; 4]) -> u32) -> (bool, bool) {
    let mut largest = 0;
    for row in run.chunks_exact(1 + 4 * usize::from(count)) {
        if row[0] != count {
            return (false, false);
        }
        largest = greatest(&row[1..], largest, value);
    }
    (true, largest < limit)
}

/// The largest of the items and `least`.
#[inline(always)]
fn greatest(items: &[u8], least: u32, value: &impl Fn([u8; 4]) -> u32) -> u32 {
    let (items, _) = items.as_chunks::<4>();
    items
        .iter()
        .fold(least, |most, item| most.max(value(*item)))
}
