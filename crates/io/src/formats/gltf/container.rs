//! Where the bytes of a glTF are: the chunks of a GLB, data in the JSON itself, files beside it.
//!
//! *Source*: Khronos Group, *glTF 2.0 Specification*, 2021, section 4 "GLB File Format Specification"; RFC 2397, "The data URL
//! scheme", 1998; RFC 4648, "The Base16, Base32, and Base64 Data Encodings", 2006.

use crate::{ReadError, ReadErrorKind};
use core::ops::Range;

/// What every GLB begins with.
pub(super) const MAGIC: &[u8] = b"glTF";
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// The chunks of a GLB.
pub(super) struct Chunks {
    /// Content of the JSON chunk.
    pub(super) json: Range<usize>,
    /// Content of the BIN chunk.
    pub(super) bin: Option<Range<usize>>,
    /// Chunks behind those, with their headers.
    pub(super) rest: Range<usize>,
}

fn broken(what: impl Into<String>) -> ReadError {
    ReadError::new(
        ReadErrorKind::Container,
        what,
        "check that the file was copied whole, or export it again",
    )
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

/// Finds the chunks of a GLB.
pub(super) fn chunks(bytes: &[u8]) -> Result<Chunks, ReadError> {
    if !bytes.starts_with(MAGIC) {
        let what = if bytes.is_empty() {
            "there is nothing in it".to_owned()
        } else {
            "the file does not begin with `glTF`, so it is no GLB".to_owned()
        };
        return Err(broken(what));
    }
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err(broken("the file ends within its header"));
    };
    if version != 2 {
        return Err(ReadError::new(
            ReadErrorKind::Unsupported,
            format!("the file is GLB of version {version}"),
            "convert it to glTF 2.0",
        ));
    }
    if length as usize != bytes.len() {
        return Err(broken(format!(
            "the header says that the file has {length} bytes, and it has {}",
            bytes.len()
        )));
    }
    let mut at = HEADER;
    let mut found: Vec<(u32, Range<usize>)> = Vec::new();
    // The third chunk and those behind it are none of ours, but have to be whole.
    let mut rest = bytes.len();
    while at < bytes.len() {
        let (Some(length), Some(kind)) = (word(bytes, at), word(bytes, at + 4)) else {
            return Err(broken(format!(
                "the header of chunk {} is cut off",
                found.len() + 1
            )));
        };
        let start = at + CHUNK_HEADER;
        let end = start.checked_add(length as usize);
        let Some(end) = end.filter(|end| *end <= bytes.len()) else {
            return Err(broken(format!(
                "chunk {} should have {length} bytes, and {} are left",
                found.len() + 1,
                bytes.len() - start
            )));
        };
        let bin = found.len() == 1 && kind == BIN;
        if found.is_empty() || bin {
            rest = end;
        }
        if found.len() < 2 {
            found.push((kind, start..end));
        }
        at = end;
    }
    let Some((JSON, json)) = found.first().cloned() else {
        return Err(broken("the first chunk is not JSON"));
    };
    let bin = found
        .into_iter()
        .nth(1)
        .filter(|(kind, _)| *kind == BIN)
        .map(|(_, range)| range);
    Ok(Chunks {
        json,
        bin,
        rest: rest..bytes.len(),
    })
}

/// Header of a GLB with chunks of these lengths (the BIN chunk may be missing); `None` beyond 4 GiB.
pub(super) fn glb_header(json: usize, bin: Option<usize>, rest: usize) -> Option<Vec<u8>> {
    let bin = bin.map_or(0, |bin| CHUNK_HEADER + bin);
    let length = u32::try_from(HEADER + CHUNK_HEADER + json + bin + rest).ok()?;
    let mut out = MAGIC.to_vec();
    out.extend(2u32.to_le_bytes());
    out.extend(length.to_le_bytes());
    Some(out)
}

/// Header of a chunk.
pub(super) fn chunk_header(is_json: bool, length: usize) -> [u8; CHUNK_HEADER] {
    let mut out = [0; CHUNK_HEADER];
    out[..4].copy_from_slice(&(length as u32).to_le_bytes());
    out[4..].copy_from_slice(&(if is_json { JSON } else { BIN }).to_le_bytes());
    out
}

/// Where the content of a data URI begins, if it is one.
pub(super) fn data_start(uri: &str) -> Option<usize> {
    let head = uri.as_bytes().get(..5)?;
    head.eq_ignore_ascii_case(b"data:")
        .then(|| uri.find(',').map_or(uri.len(), |comma| comma + 1))
}

/// The content of a data URI.
pub(super) fn decoded(uri: &str) -> Result<Vec<u8>, &'static str> {
    let start = data_start(uri).ok_or("it is no data URI")?;
    let head = &uri[..start];
    let Some(head) = head.strip_suffix(',') else {
        return Err("the data URI has no comma");
    };
    let content = &uri[start..];
    if !head
        .get(head.len().saturating_sub(7)..)
        .is_some_and(|end| end.eq_ignore_ascii_case(";base64"))
    {
        return Ok(unescaped(content));
    }
    let bytes: std::borrow::Cow<'_, [u8]> = if content.contains('%') {
        unescaped(content).into()
    } else {
        content.as_bytes().into()
    };
    from_base64(&bytes).ok_or("the data URI is not valid base64")
}

/// Percent signs and the two digits behind them become the byte they mean.
pub(super) fn unescaped(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let digit = |i: usize| Some(char::from(*bytes.get(at + i)?).to_digit(16)? as u8);
        match (bytes[at], digit(1), digit(2)) {
            (b'%', Some(high), Some(low)) => {
                out.push(high * 16 + low);
                at += 3;
            }
            (byte, _, _) => {
                out.push(byte);
                at += 1;
            }
        }
    }
    out
}

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

fn from_base64(text: &[u8]) -> Option<Vec<u8>> {
    const BAD: u8 = 64;
    let mut value = [BAD; 256];
    for (i, digit) in DIGITS.iter().enumerate() {
        value[*digit as usize] = i as u8;
    }
    let end = text.iter().rposition(|b| *b != b'=').map_or(0, |at| at + 1);
    if text.len() - end > 2 || end % 4 == 1 {
        return None;
    }
    let mut out = Vec::with_capacity(end / 4 * 3 + 2);
    let mut bad = false;
    for group in text[..end].chunks(4) {
        let mut bits = 0u32;
        for i in 0..4 {
            let digit = group.get(i).map_or(0, |digit| value[*digit as usize]);
            bad |= digit == BAD;
            bits = bits << 6 | u32::from(digit & 63);
        }
        let [_, a, b, c] = bits.to_be_bytes();
        out.extend_from_slice(&[a, b, c][..group.len() - 1]);
    }
    (!bad).then_some(out)
}

/// Bytes as base64 with its padding.
pub(super) fn to_base64(bytes: &[u8]) -> String {
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            out.push(if i <= group.len() {
                char::from(DIGITS[(bits >> (18 - 6 * i) & 63) as usize])
            } else {
                '='
            });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_comes_back_and_nonsense_is_refused() {
        for (bytes, text) in [
            (&b""[..], ""),
            (b"f", "Zg=="),
            (b"fo", "Zm8="),
            (b"foo", "Zm9v"),
            (b"foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(to_base64(bytes), text);
            assert_eq!(from_base64(text.as_bytes()).unwrap(), bytes);
        }
        let all: Vec<u8> = (0..=255).collect();
        assert_eq!(from_base64(to_base64(&all).as_bytes()).unwrap(), all);
        for text in ["Z", "Zg===", "Z*==", "Zm9vZ", "Zg==Zg=="] {
            assert!(from_base64(text.as_bytes()).is_none(), "{text}");
        }
        assert_eq!(decoded("data:;base64,Zm8%3D").unwrap(), b"fo");
        assert_eq!(decoded("data:text/plain,a%20b%").unwrap(), b"a b%");
        assert!(decoded("data:;base64").is_err());
    }

    #[test]
    fn chunks_are_found_and_their_lengths_believed_only_within_the_file() {
        let glb = |chunks: &[(u32, &[u8])]| {
            let mut body = Vec::new();
            for (kind, content) in chunks {
                body.extend((content.len() as u32).to_le_bytes());
                body.extend(kind.to_le_bytes());
                body.extend_from_slice(content);
            }
            let mut out = b"glTF\x02\0\0\0".to_vec();
            out.extend((body.len() as u32 + 12).to_le_bytes());
            out.extend(body);
            out
        };
        let whole = glb(&[(JSON, b"{}  "), (BIN, b"1234"), (7, b"abcd")]);
        let found = chunks(&whole).unwrap();
        assert_eq!(&whole[found.json], b"{}  ");
        assert_eq!(&whole[found.bin.unwrap()], b"1234");
        assert_eq!(found.rest.len(), 12);
        let other = glb(&[(JSON, b"{}  "), (7, b"abcd"), (BIN, b"1234")]);
        let found = chunks(&other).unwrap();
        assert!(found.bin.is_none());
        assert_eq!(found.rest.len(), 24);
        assert!(chunks(&glb(&[(BIN, b"1234")])).is_err());
        for length in 0..whole.len() {
            assert!(chunks(&whole[..length]).is_err(), "{length}");
        }
    }
}
