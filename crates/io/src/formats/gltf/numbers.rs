//! Numbers as the bytes and the text of a glTF.

use super::accessor::Layout;
use super::content::Content;
use crate::{WriteError, WriteReport};
use std::collections::BTreeMap;
use std::io::Write;

/// Numbers turned into bytes at a time.
const PIECE: usize = 1 << 16;

/// Writes bytes with contents in the place of some stretches of them, which do not overlap.
pub(super) fn stretched(
    bytes: &[u8],
    stretches: &BTreeMap<usize, &[f32]>,
    report: &mut WriteReport,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let mut done = 0;
    let mut piece = Vec::with_capacity(4 * PIECE);
    for (&start, numbers) in stretches {
        report.put(bytes.get(done..start).unwrap_or(&[]), out)?;
        for some in numbers.chunks(PIECE) {
            piece.clear();
            piece.extend(some.iter().flat_map(|x| x.to_le_bytes()));
            report.put(&piece, out)?;
        }
        done = start + 4 * numbers.len();
    }
    report.put(bytes.get(done..).unwrap_or(&[]), out)
}

/// Writes elements where they lie; those numbered `except` (ascending) keep their bytes.
pub(super) fn put<'c>(
    bytes: &mut [u8],
    layout: &Layout,
    elements: impl Iterator<Item = &'c [f32]>,
    except: &[usize],
) {
    let mut except = except.iter().peekable();
    for (i, element) in elements.enumerate() {
        if except.next_if(|at| **at == i).is_some() {
            continue;
        }
        let start = layout.start + i * layout.stride;
        if let Some(place) = bytes.get_mut(start..start + 4 * element.len()) {
            for (four, number) in place.chunks_exact_mut(4).zip(element) {
                four.copy_from_slice(&number.to_le_bytes());
            }
        }
    }
}

/// Smallest and largest numbers of each component; `None` where one has no finite number.
pub(super) fn bounds(content: &Content) -> Option<(Vec<f32>, Vec<f32>)> {
    let mut low = vec![f32::INFINITY; content.width];
    let mut high = vec![f32::NEG_INFINITY; content.width];
    for element in content.numbers.chunks_exact(content.width) {
        for (axis, &value) in element.iter().enumerate() {
            if value < low[axis] {
                low[axis] = value;
            }
            if value > high[axis] {
                high[axis] = value;
            }
        }
    }
    let finite = |list: &[f32]| list.iter().all(|x| x.is_finite());
    (finite(&low) && finite(&high)).then_some((low, high))
}

/// Numbers as a JSON list. Readers take numbers for `f64`; these are exactly the stored ones.
pub(super) fn array(numbers: &[f32]) -> String {
    let texts = numbers.iter().map(|&x| {
        let mut buffer = zmij::Buffer::new();
        // Adding 0 turns −0 into 0.
        let text = buffer.format_finite(f64::from(x) + 0.0);
        text.strip_suffix(".0").unwrap_or(text).to_owned()
    });
    format!("[{}]", texts.collect::<Vec<_>>().join(","))
}
