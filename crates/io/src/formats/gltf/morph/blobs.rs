//! Displacements as the bytes of accessors, equal ones once, and none of them in memory.

use super::super::json::quoted;
use super::super::numbers::array;
use super::Storage;
use crate::WriteError;
use core::hash::{Hash, Hasher};
use std::collections::HashMap;
use std::io::SeekFrom;

/// Bytes of an accessor's elements.
const ELEMENT: usize = 12;
/// Bytes copied at a time.
const PIECE: usize = 1 << 16;

/// The displacements of the vertices of an accessor.
struct Blob {
    /// Elements.
    count: usize,
    /// Where its bytes are in the storage.
    offset: u64,
    length: usize,
    /// Elements that are not zero, and the bytes of an index; nothing for one that holds all elements.
    sparse: Option<(usize, usize)>,
    low: [f32; 3],
    high: [f32; 3],
}

/// All of them, in the order in which they came.
pub(super) struct Blobs<'a> {
    storage: &'a mut dyn Storage,
    stored: u64,
    list: Vec<Blob>,
    known: HashMap<(u64, usize), Vec<usize>>,
}

/// The bytes of an index below `count`.
fn index_size(count: usize) -> usize {
    match count {
        0..=0xFF => 1,
        0x100..=0xFFFF => 2,
        _ => 4,
    }
}

/// The number of bytes of `count` indices, with what fills up to four.
fn indices_length(count: usize, size: usize) -> usize {
    (count * size).next_multiple_of(4)
}

impl<'a> Blobs<'a> {
    pub(super) fn new(storage: &'a mut dyn Storage) -> Self {
        Self {
            storage,
            stored: 0,
            list: Vec::new(),
            known: HashMap::new(),
        }
    }

    /// Adds displacements, unless they are there; gives their number, or nothing if all are zero.
    pub(super) fn add(&mut self, values: &[[f32; 3]]) -> Result<Option<usize>, WriteError> {
        let moving = |value: &&[f32; 3]| **value != [0.0; 3];
        match values.iter().filter(moving).count() {
            0 => Ok(None),
            moving => self.insert(values, moving).map(Some),
        }
    }

    /// As [`Blobs::add`] for this many zeros, which are stored as a sparse accessor of one element: not all programs know one without any
    /// bytes.
    pub(super) fn zeros(&mut self, count: usize) -> Result<usize, WriteError> {
        let size = index_size(count);
        let bytes = vec![0; indices_length(1, size) + ELEMENT];
        self.keep(count, Some((1, size)), &bytes, [[0.0; 3]; 2])
    }

    fn insert(&mut self, values: &[[f32; 3]], moving: usize) -> Result<usize, WriteError> {
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for value in values {
            for axis in 0..3 {
                low[axis] = low[axis].min(value[axis]);
                high[axis] = high[axis].max(value[axis]);
            }
        }
        let size = index_size(values.len());
        let taken = indices_length(moving, size) + ELEMENT * moving;
        let sparse = 2 * taken <= ELEMENT * values.len();
        let mut bytes = Vec::with_capacity(if sparse {
            taken
        } else {
            ELEMENT * values.len()
        });
        if sparse {
            for (i, value) in values.iter().enumerate() {
                if *value != [0.0; 3] {
                    bytes.extend_from_slice(&(i as u32).to_le_bytes()[..size]);
                }
            }
            bytes.resize(indices_length(moving, size), 0);
        }
        for value in values {
            if !sparse || *value != [0.0; 3] {
                bytes.extend(value.iter().flat_map(|x| x.to_le_bytes()));
            }
        }
        let sparse = sparse.then_some((moving, size));
        self.keep(values.len(), sparse, &bytes, [low, high])
    }

    fn keep(
        &mut self,
        count: usize,
        sparse: Option<(usize, usize)>,
        bytes: &[u8],
        [low, high]: [[f32; 3]; 2],
    ) -> Result<usize, WriteError> {
        let mut hasher = std::collections::hash_map::DefaultHasher::new();
        bytes.hash(&mut hasher);
        let key = (hasher.finish(), count);
        for &known in self.known.get(&key).into_iter().flatten() {
            let blob = &self.list[known];
            if blob.sparse == sparse
                && blob.length == bytes.len()
                && holds(self.storage, blob.offset, bytes)?
            {
                return Ok(known);
            }
        }
        self.storage.seek(SeekFrom::Start(self.stored))?;
        self.storage.write_all(bytes)?;
        let number = self.list.len();
        self.list.push(Blob {
            count,
            offset: self.stored,
            length: bytes.len(),
            sparse,
            low,
            high,
        });
        self.stored += bytes.len() as u64;
        self.known.entry(key).or_default().push(number);
        Ok(number)
    }

    /// Bytes of all.
    pub(super) fn bytes(&self) -> u64 {
        self.stored
    }

    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    pub(super) fn sparse(&self) -> usize {
        self.list
            .iter()
            .filter(|blob| blob.sparse.is_some())
            .count()
    }

    /// The accessors in JSON, and the views of the buffer they lie in: the bytes of all stand from `base` on, and the first view is number
    /// `view`.
    pub(super) fn described(&self, base: u64, view: usize) -> (Vec<String>, Vec<String>) {
        let (mut accessors, mut views) = (Vec::new(), Vec::new());
        for blob in &self.list {
            let next = view + views.len();
            let at = base + blob.offset;
            let head = format!(
                r#""componentType":5126,"count":{},"type":"VEC3","min":{},"max":{}"#,
                blob.count,
                array(&blob.low),
                array(&blob.high)
            );
            let Some((moving, size)) = blob.sparse else {
                accessors.push(format!(r#"{{"bufferView":{next},{head}}}"#));
                // 34962: vertices.
                views.push(format!(
                    r#"{{"buffer":0,"byteOffset":{at},"byteLength":{},"target":34962}}"#,
                    blob.length
                ));
                continue;
            };
            // 5121, 5123, 5125: indices of one, two, four bytes.
            let kind = match size {
                1 => 5121,
                2 => 5123,
                _ => 5125,
            };
            accessors.push(format!(
                r#"{{{head},{}:{{"count":{moving},"indices":{{"bufferView":{next},"componentType":{kind}}},"values":{{"bufferView":{}}}}}}}"#,
                quoted("sparse"),
                next + 1
            ));
            let indices = indices_length(moving, size);
            for (offset, length) in [(0, moving * size), (indices, blob.length - indices)] {
                views.push(format!(
                    r#"{{"buffer":0,"byteOffset":{},"byteLength":{length}}}"#,
                    at + offset as u64
                ));
            }
        }
        (accessors, views)
    }

    /// Gives the bytes of all to `put`, piece by piece.
    pub(super) fn copy(
        &mut self,
        mut put: impl FnMut(&[u8]) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        self.storage.seek(SeekFrom::Start(0))?;
        let mut left = self.stored;
        let mut piece = vec![0; PIECE];
        while left > 0 {
            let length = piece.len().min(usize::try_from(left).unwrap_or(PIECE));
            self.storage.read_exact(&mut piece[..length])?;
            put(&piece[..length])?;
            left -= length as u64;
        }
        Ok(())
    }
}

/// Whether these bytes stand at a place of the storage.
fn holds(storage: &mut dyn Storage, offset: u64, bytes: &[u8]) -> Result<bool, WriteError> {
    storage.seek(SeekFrom::Start(offset))?;
    let mut piece = vec![0; PIECE.min(bytes.len())];
    for some in bytes.chunks(PIECE) {
        let piece = &mut piece[..some.len()];
        storage.read_exact(piece)?;
        if *piece != *some {
            return Ok(false);
        }
    }
    Ok(true)
}
