//! Chunks of PNG files beside the pixels: text, resolution, colour spaces. They are copied byte for byte.
//!
//! *Source*: ISO/IEC 15948:2004, §5.3 (chunk layout), §11.3 (ancillary chunks), §14 (editors).

/// Chunks that stay true whatever the pixels are.
const COPIED: [&[u8; 4]; 13] = [
    b"cHRM", b"cICP", b"gAMA", b"iCCP", b"sRGB", b"mDCV", b"cLLI", b"pHYs", b"tIME", b"tEXt",
    b"zTXt", b"iTXt", b"eXIf",
];
/// Chunks of the pixels themselves, which are made anew.
const PIXELS: [&[u8; 4]; 5] = [b"IHDR", b"PLTE", b"IDAT", b"IEND", b"tRNS"];

/// What is beside the pixels.
#[derive(Debug, Clone, Default)]
pub(super) struct Chunks {
    /// Whole chunks, one after the other.
    pub(super) copied: Vec<u8>,
    /// Names of others.
    pub(super) left: Vec<String>,
}

impl Chunks {
    /// Leaves out a colour profile.
    pub(super) fn drop_profile(&mut self) {
        let all = [&[0; 8][..], &self.copied].concat();
        let kept = chunks(&all).filter(|(name, _)| *name != b"iCCP");
        self.copied = kept.flat_map(|(_, chunk)| chunk.to_vec()).collect();
    }
}

/// A file's chunks: type and all bytes. Ends at the first that is cut off.
fn chunks(bytes: &[u8]) -> impl Iterator<Item = (&[u8], &[u8])> {
    let mut rest = bytes.get(8..).unwrap_or_default();
    std::iter::from_fn(move || {
        let length = rest.first_chunk::<4>()?;
        let whole = usize::try_from(u32::from_be_bytes(*length))
            .ok()?
            .checked_add(12)?;
        let chunk = rest.get(..whole)?;
        rest = &rest[whole..];
        Some((&chunk[4..8], chunk))
    })
}

/// The chunks of a file that can be copied to another, and the names of those that cannot.
pub(super) fn beside_pixels(bytes: &[u8]) -> Chunks {
    let mut found = Chunks::default();
    for (name, chunk) in chunks(bytes) {
        let is = |known: &&[u8; 4]| known.as_slice() == name;
        if COPIED.iter().any(is) {
            found.copied.extend_from_slice(chunk);
        } else if !PIXELS.iter().any(is) {
            let name = String::from_utf8_lossy(name).into_owned();
            if !found.left.contains(&name) {
                found.left.push(name);
            }
        }
    }
    found
}

/// A file with more chunks behind its header.
pub(super) fn insert(file: &mut Vec<u8>, chunks: &[u8]) {
    /// Signature and header chunk.
    const HEADER: usize = 8 + 25;
    if file.len() >= HEADER {
        file.splice(HEADER..HEADER, chunks.iter().copied());
    }
}
