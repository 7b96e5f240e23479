//! Bindings as files: the influences of warps on one model, kept for new targets.
//!
//! A file says which version it is, which model it belongs to (name, number of points, fingerprint of their coordinates) and which warps
//! it binds; then come the numbers, little-endian, and a checksum. What is 0 or 1 throughout is not stored.
//!
//! *Source*: Milliron et al. 2002, §7.1 and §7.4 (precomputed field values); the layout is a decision: plain arrays, so that a reader in
//! any language is a page of code (docs/formats.md). The checksum is FNV-1a (Fowler, Noll and Vo, 1991).

use crate::error::{ReadError, ReadErrorKind};
use anamorph_core::{Address, Binding, Fingerprint, Influence};
use std::io::{self, Write};

/// What every file begins with.
const MAGIC: &[u8; 16] = b"anamorph binding";
/// The version that is written, and the only one that is read.
const VERSION: u32 = 2;
/// Longest name in a file.
const LONGEST_NAME: usize = 4096;

/// One warp's influences.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundWarp {
    /// Its kind in recipes.
    pub kind: String,
    /// Tells its description from others that differ otherwise than by numbers.
    pub structure: u64,
    /// The influences of all points.
    pub binding: Binding,
    /// The mask at all points, if it has one.
    pub mask: Option<Vec<f64>>,
}

/// A file of bindings.
#[derive(Debug, Clone, PartialEq)]
pub struct BindingFile {
    /// The name of the model's file.
    pub model: String,
    /// The number of its points.
    pub points: usize,
    /// What tells it from other models.
    pub fingerprint: Fingerprint,
    /// Coordinates of a point: 2 or 3.
    pub dimension: usize,
    /// Influences of a smaller share of their point's weight were dropped; 0 if none were.
    pub drop_below: f64,
    /// The largest distance by which any point moves otherwise than without the binding, because influences were dropped.
    pub dropped: f64,
    /// The warps in their order.
    pub warps: Vec<BoundWarp>,
}

/// Whether a file's bytes are those of a binding.
pub fn is_binding(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Writes bytes and keeps their checksum.
struct Summing<'a> {
    out: &'a mut dyn Write,
    sum: u64,
}

const START: u64 = 0xcbf2_9ce4_8422_2325;

fn summed(sum: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(sum, |sum, &byte| {
        (sum ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

impl Summing<'_> {
    fn bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.sum = summed(self.sum, bytes);
        self.out.write_all(bytes)
    }
    fn number(&mut self, number: u64) -> io::Result<()> {
        self.bytes(&number.to_le_bytes())
    }
    fn text(&mut self, text: &str) -> io::Result<()> {
        self.number(text.len() as u64)?;
        self.bytes(text.as_bytes())
    }
    /// Numbers, or only that all of them are `usual`.
    fn numbers(
        &mut self,
        numbers: impl Iterator<Item = f64> + Clone,
        usual: f64,
    ) -> io::Result<()> {
        if numbers.clone().all(|n| n.to_bits() == usual.to_bits()) {
            return self.bytes(&[0]);
        }
        self.bytes(&[1])?;
        numbers
            .into_iter()
            .try_for_each(|n| self.bytes(&n.to_le_bytes()))
    }
}

impl BindingFile {
    /// Writes the file.
    ///
    /// # Errors
    ///
    /// Those of `out`.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let mut out = Summing { out, sum: START };
        out.bytes(MAGIC)?;
        out.bytes(&VERSION.to_le_bytes())?;
        out.text(&self.model)?;
        out.number(self.points as u64)?;
        out.number(self.fingerprint.0)?;
        out.number(self.dimension as u64)?;
        out.bytes(&self.drop_below.to_le_bytes())?;
        out.bytes(&self.dropped.to_le_bytes())?;
        out.number(self.warps.len() as u64)?;
        for warp in &self.warps {
            out.text(&warp.kind)?;
            out.number(warp.structure)?;
            let binding = &warp.binding;
            out.number(binding.influence_count() as u64)?;
            for index in 0..self.points {
                let count = u32::try_from(binding.site(index).len()).unwrap_or(u32::MAX);
                out.bytes(&count.to_le_bytes())?;
            }
            let all = || binding.influences();
            for influence in all() {
                out.bytes(&influence.address.feature.to_le_bytes())?;
            }
            out.numbers(all().map(|i| i.address.at), 0.0)?;
            out.numbers(all().map(|i| i.strength), 1.0)?;
            out.numbers(all().map(|i| i.weight), 1.0)?;
            out.numbers((0..self.points).map(|i| binding.log_scale(i)), 0.0)?;
            let mask = warp.mask.as_deref();
            out.numbers((0..self.points).map(|i| mask.map_or(1.0, |m| m[i])), 1.0)?;
        }
        let sum = out.sum;
        out.number(sum)
    }

    /// Reads a file.
    ///
    /// # Errors
    ///
    /// What is no binding, of another version, cut off or damaged. No number in the file makes it take more memory than a few times the
    /// file's size.
    pub fn read(bytes: &[u8]) -> Result<Self, ReadError> {
        if !is_binding(bytes) {
            return Err(ReadError::new(
                ReadErrorKind::UnknownFormat,
                "this is no binding",
                "name a file that `anamorph bind` wrote",
            ));
        }
        let mut cursor = Cursor {
            bytes,
            at: MAGIC.len(),
        };
        let version = u32::from_le_bytes(cursor.array()?);
        if version != VERSION {
            return Err(ReadError::new(
                ReadErrorKind::Unsupported,
                format!("this binding has version {version}, and version {VERSION} can be read"),
                "bind the model again",
            ));
        }
        let Some(end) = bytes.len().checked_sub(8) else {
            return Err(truncated());
        };
        let body = summed(START, &bytes[..end]);
        if bytes[end..] != body.to_le_bytes() {
            return Err(ReadError::new(
                ReadErrorKind::Container,
                "the checksum does not fit: the file is cut off or damaged",
                "bind the model again",
            ));
        }
        cursor.bytes = &bytes[..end];
        let model = cursor.text()?;
        let points = cursor.count(4)?;
        let fingerprint = Fingerprint(cursor.number()?);
        let dimension = cursor.count(0)?;
        let drop_below = f64::from_le_bytes(cursor.array()?);
        let dropped = f64::from_le_bytes(cursor.array()?);
        let count = cursor.count(1)?;
        let mut warps = Vec::new();
        for _ in 0..count {
            warps.push(cursor.warp(points)?);
        }
        if cursor.at != end || !(2..=3).contains(&dimension) {
            return Err(damaged());
        }
        Ok(Self {
            model,
            points,
            fingerprint,
            dimension,
            drop_below,
            dropped,
            warps,
        })
    }
}

fn truncated() -> ReadError {
    ReadError::new(
        ReadErrorKind::Truncated,
        "the binding ends before what it announces",
        "bind the model again",
    )
}

fn damaged() -> ReadError {
    ReadError::new(
        ReadErrorKind::Container,
        "the numbers of the binding disagree",
        "bind the model again",
    )
}

struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Cursor<'_> {
    fn take(&mut self, count: usize) -> Result<&[u8], ReadError> {
        let end = self.at.checked_add(count).ok_or_else(truncated)?;
        let taken = self.bytes.get(self.at..end).ok_or_else(truncated)?;
        self.at = end;
        Ok(taken)
    }
    fn array<const N: usize>(&mut self) -> Result<[u8; N], ReadError> {
        self.take(N)?.try_into().map_err(|_| truncated())
    }
    fn number(&mut self) -> Result<u64, ReadError> {
        Ok(u64::from_le_bytes(self.array()?))
    }
    /// A number of things that take at least `each` bytes of what is left.
    fn count(&mut self, each: usize) -> Result<usize, ReadError> {
        let count = usize::try_from(self.number()?).map_err(|_| truncated())?;
        let left = self.bytes.len() - self.at;
        if count.checked_mul(each).is_none_or(|size| size > left) {
            return Err(truncated());
        }
        Ok(count)
    }
    fn text(&mut self) -> Result<String, ReadError> {
        let length = self.count(1)?;
        if length > LONGEST_NAME {
            return Err(damaged());
        }
        String::from_utf8(self.take(length)?.to_vec()).map_err(|_| damaged())
    }
    fn words(&mut self, count: usize) -> Result<Vec<u32>, ReadError> {
        let size = count.checked_mul(4).ok_or_else(truncated)?;
        let (words, _) = self.take(size)?.as_chunks::<4>();
        Ok(words.iter().map(|word| u32::from_le_bytes(*word)).collect())
    }
    /// Numbers, if they are not all as usual.
    fn numbers(&mut self, count: usize) -> Result<Option<Vec<f64>>, ReadError> {
        match self.take(1)?[0] {
            0 => Ok(None),
            1 => {
                let size = count.checked_mul(8).ok_or_else(truncated)?;
                let (numbers, _) = self.take(size)?.as_chunks::<8>();
                Ok(Some(
                    numbers.iter().map(|n| f64::from_le_bytes(*n)).collect(),
                ))
            }
            _ => Err(damaged()),
        }
    }
    fn warp(&mut self, points: usize) -> Result<BoundWarp, ReadError> {
        let kind = self.text()?;
        let structure = self.number()?;
        let count = self.count(4)?;
        let counts = self.words(points)?;
        let features = self.words(count)?;
        let places = self.numbers(count)?;
        let strengths = self.numbers(count)?;
        let weights = self.numbers(count)?;
        let at = |list: &Option<Vec<f64>>, i: usize, usual: f64| {
            list.as_ref().map_or(usual, |list| list[i])
        };
        let influences = features.iter().enumerate().map(|(i, &feature)| Influence {
            address: Address {
                feature,
                at: at(&places, i, 0.0),
            },
            strength: at(&strengths, i, 1.0),
            weight: at(&weights, i, 1.0),
        });
        let log_scales = self.numbers(points)?.unwrap_or_default();
        let mask = self.numbers(points)?;
        let binding = Binding::from_parts(&counts, influences, log_scales).ok_or_else(damaged)?;
        Ok(BoundWarp {
            kind,
            structure,
            binding,
            mask,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file() -> BindingFile {
        let influence = |feature, at, weight| Influence {
            address: Address { feature, at },
            strength: 0.5,
            weight,
        };
        let influences = vec![
            influence(0, 0.25, 1.0),
            influence(7, 0.5, f64::INFINITY),
            influence(1, -0.0, 1e-300),
        ];
        let binding = Binding::from_parts(&[1, 0, 2], influences, vec![0.0, 0.0, -3.0]).unwrap();
        BindingFile {
            model: "Föhn.obj".to_owned(),
            points: 3,
            fingerprint: Fingerprint(42),
            dimension: 3,
            drop_below: 1e-3,
            dropped: 1e-5,
            warps: vec![
                BoundWarp {
                    kind: "wires".to_owned(),
                    structure: 99,
                    binding,
                    mask: Some(vec![0.0, 0.5, 1.0]),
                },
                BoundWarp {
                    kind: "points".to_owned(),
                    structure: 7,
                    binding: Binding::from_parts(&[0; 3], Vec::new(), Vec::new()).unwrap(),
                    mask: None,
                },
            ],
        }
    }

    fn written(file: &BindingFile) -> Vec<u8> {
        let mut out = Vec::new();
        file.write(&mut out).unwrap();
        out
    }

    #[test]
    fn what_is_written_is_read() {
        assert_eq!(BindingFile::read(&written(&file())).unwrap(), file());
    }

    #[test]
    fn every_cut_and_every_flipped_byte_is_an_error() {
        let bytes = written(&file());
        for length in 0..bytes.len() {
            assert!(BindingFile::read(&bytes[..length]).is_err(), "{length}");
        }
        for index in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[index] ^= 0x55;
            assert!(BindingFile::read(&damaged).is_err(), "{index}");
        }
    }

    #[test]
    fn numbers_that_lie_take_no_memory() {
        let good = written(&file());
        // Also with a checksum that fits.
        for at in (0..good.len() - 16).step_by(4) {
            let mut bytes = good[..good.len() - 8].to_vec();
            bytes[at..at + 8].copy_from_slice(&[0xff, 0xff, 0xff, 0xff, 0xff, 0x7f, 0, 0]);
            let sum = summed(START, &bytes);
            bytes.extend(sum.to_le_bytes());
            let _ = BindingFile::read(&bytes);
        }
        let mut other = good.clone();
        other[16] = 9;
        let error = BindingFile::read(&other).unwrap_err();
        assert!(error.to_string().contains("version 9"), "{error}");
    }
}
