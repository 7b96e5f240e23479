//! What the text formats share: encodings, places in a text, and work in chunks.

use crate::{ReadError, ReadErrorKind};

/// The mark with which some editors begin a UTF-8 text.
pub(crate) const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// Line and column of byte `offset`, both from 1; a column counts bytes.
pub(crate) fn place(bytes: &[u8], offset: usize) -> (u64, u64) {
    let before = &bytes[..offset.min(bytes.len())];
    let line = memchr::memchr_iter(b'\n', before).count() as u64 + 1;
    let start = memchr::memrchr(b'\n', before).map_or(0, |at| at + 1);
    (line, (before.len() - start) as u64 + 1)
}

/// Whether the bytes look like UTF-16 or UTF-32: by their mark, or because every other byte of the beginning is zero.
pub(crate) fn is_wide(bytes: &[u8]) -> bool {
    if bytes.starts_with(b"\xFE\xFF")
        || bytes.starts_with(b"\xFF\xFE")
        || bytes.starts_with(b"\0\0\xFE\xFF")
    {
        return true;
    }
    let head = &bytes[..bytes.len().min(64) & !1];
    let all_zero = |first: usize| head.iter().skip(first).step_by(2).all(|&b| b == 0);
    head.len() >= 8 && (all_zero(0) != all_zero(1))
}

/// The error for bytes that are no text of the expected kind, if they are not: checked when reading has failed, so that
/// the message names the cause rather than its consequence.
pub(crate) fn encoding_error(bytes: &[u8], format: &str) -> Option<ReadError> {
    if is_wide(bytes) {
        return Some(ReadError::new(
            ReadErrorKind::Encoding,
            "the text is UTF-16 or UTF-32",
            "save it as UTF-8 (in most editors: Save As, Encoding)",
        ));
    }
    memchr::memchr(0, bytes).map(|at| {
        ReadError::new(
            ReadErrorKind::Encoding,
            format!(
                "byte {} is zero, so this is binary data and not {format} text",
                at + 1
            ),
            "check that the file has the right name and was not damaged in transfer",
        )
    })
}

/// A piece of the input for a message: on one line, cut after 40 characters.
pub(crate) fn excerpt(bytes: &[u8]) -> String {
    let head = &bytes[..bytes.len().min(160)];
    let text = String::from_utf8_lossy(head);
    let mut shown: String = text
        .chars()
        .take(40)
        .map(|c| if c.is_control() { '\u{FFFD}' } else { c })
        .collect();
    if shown.chars().count() < text.chars().count() || head.len() < bytes.len() {
        shown.push('…');
    }
    shown
}

/// `f` of every item, in order; on all cores with the feature `parallel`.
#[cfg(feature = "parallel")]
pub(crate) fn map<T: Sync, R: Send>(items: &[T], f: impl Fn(&T) -> R + Sync) -> Vec<R> {
    use rayon::prelude::*;
    if items.len() < 2 {
        return items.iter().map(f).collect();
    }
    items.par_iter().with_max_len(1).map(&f).collect()
}

/// `f` of every item, in order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn map<T: Sync, R: Send>(items: &[T], f: impl Fn(&T) -> R + Sync) -> Vec<R> {
    items.iter().map(f).collect()
}

/// Calls `f` with each run of `size` items (the last may be shorter) and the index of its first item; on all cores with the
/// feature `parallel`. The results are in order.
#[cfg(feature = "parallel")]
pub(crate) fn fill<T: Send, R: Send>(
    items: &mut [T],
    size: usize,
    f: impl Fn(usize, &mut [T]) -> R + Sync,
) -> Vec<R> {
    use rayon::prelude::*;
    items
        .par_chunks_mut(size)
        .enumerate()
        .map(|(i, run)| f(i * size, run))
        .collect()
}

/// Calls `f` with each run of `size` items (the last may be shorter) and the index of its first item. The results are in
/// order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn fill<T: Send, R: Send>(
    items: &mut [T],
    size: usize,
    f: impl Fn(usize, &mut [T]) -> R + Sync,
) -> Vec<R> {
    let runs = items.chunks_mut(size).enumerate();
    runs.map(|(i, run)| f(i * size, run)).collect()
}

/// `f` of every row of `stride` bytes, in order; on all cores with the feature `parallel`.
#[cfg(feature = "parallel")]
pub(crate) fn rows<R: Send>(
    bytes: &[u8],
    stride: usize,
    f: impl Fn(&[u8]) -> R + Sync + Send,
) -> Vec<R> {
    use rayon::prelude::*;
    // Straight into the memory of the result, which is touched by no other pass.
    bytes.par_chunks_exact(stride).map(f).collect()
}

/// `f` of every row of `stride` bytes, in order.
#[cfg(not(feature = "parallel"))]
pub(crate) fn rows<R: Send>(
    bytes: &[u8],
    stride: usize,
    f: impl Fn(&[u8]) -> R + Sync + Send,
) -> Vec<R> {
    bytes.chunks_exact(stride).map(f).collect()
}

/// The ranges of `size` (the last may be shorter) that make up `0..count`.
pub(crate) fn runs(count: usize, size: usize) -> Vec<core::ops::Range<usize>> {
    (0..count)
        .step_by(size)
        .map(|start| start..count.min(start + size))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_from_one() {
        assert_eq!(place(b"ab\ncd", 0), (1, 1));
        assert_eq!(place(b"ab\ncd", 4), (2, 2));
        assert_eq!(place(b"ab\n", 3), (2, 1));
        assert_eq!(place(b"", 9), (1, 1));
    }

    #[test]
    fn wide_text_is_told_from_narrow() {
        assert!(is_wide(b"\xFE\xFF\0v"));
        assert!(is_wide(b"v\0 \x000\0 \0"));
        assert!(!is_wide(b"v 0 0 0\n"));
        assert!(!is_wide(&[0; 64]));
        assert!(!is_wide(b""));
    }

    #[test]
    fn excerpts_stay_short_and_on_one_line() {
        assert_eq!(excerpt(b"a\nb"), "a\u{FFFD}b");
        assert_eq!(excerpt(&[b'x'; 1000]).chars().count(), 41);
    }
}
