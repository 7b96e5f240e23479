//! Accessors: how numbers lie in buffers.
//!
//! *Source*: Khronos Group, *glTF 2.0 Specification*, 2021, section 3.6 "Binary Data Storage"; extension
//! `KHR_mesh_quantization` for which component types attributes may have. Everything is checked against the lengths that
//! the buffers really have before anything of it is read.

use super::json::Value;
use super::{At, fail};
use crate::{ReadError, ReadErrorKind};
use anamorph_core::glam::DVec3;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
    fn of(code: usize) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }
}

/// Where elements lie in a buffer. That they lie within it has been checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Layout {
    pub(super) buffer: usize,
    pub(super) start: usize,
    /// Bytes from one element to the next.
    pub(super) stride: usize,
    /// Bytes of an element.
    pub(super) size: usize,
    pub(super) count: usize,
}

impl Layout {
    /// The end of the last element.
    pub(super) fn end(&self) -> usize {
        match self.count {
            0 => self.start,
            count => self.start + (count - 1) * self.stride + self.size,
        }
    }
    fn element<'a>(&self, bytes: &'a [u8], i: usize) -> &'a [u8] {
        let start = self.start + i * self.stride;
        bytes.get(start..start + self.size).unwrap_or(&[])
    }
    /// Whether the two have a byte in common; `true` where that is not plain to see.
    pub(super) fn overlaps(&self, other: &Layout) -> bool {
        if self.buffer != other.buffer || self.end() <= other.start || other.end() <= self.start {
            return false;
        }
        let (low, high) = if self.start <= other.start {
            (self, other)
        } else {
            (other, self)
        };
        let stride = low.stride;
        // Interleaved elements of one table.
        let apart = (high.start - low.start) % stride.max(1);
        !(stride == high.stride && apart >= low.size && apart + high.size <= stride)
    }
}

/// Elements that differ from those of the base.
#[derive(Debug, Clone)]
pub(super) struct Sparse {
    pub(super) indices: Layout,
    pub(super) index: Component,
    pub(super) values: Layout,
}

#[derive(Debug, Clone)]
pub(super) struct Accessor {
    /// Elements without a base are zeros.
    pub(super) base: Option<Layout>,
    pub(super) count: usize,
    pub(super) component: Component,
    /// Numbers in an element.
    pub(super) width: usize,
    pub(super) normalized: bool,
    pub(super) sparse: Option<Sparse>,
}

/// A buffer view: a range of a buffer.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    pub(super) buffer: usize,
    pub(super) start: usize,
    pub(super) length: usize,
    pub(super) stride: Option<usize>,
}

/// The whole number at a key, 0 if there is none.
fn number(table: Value<'_>, key: &str, place: &At<'_>) -> Result<usize, ReadError> {
    Ok(whole(table, key, place)?.unwrap_or(0))
}

/// The whole number at a key.
pub(super) fn whole(
    table: Value<'_>,
    key: &str,
    place: &At<'_>,
) -> Result<Option<usize>, ReadError> {
    match table.get(key) {
        None => Ok(None),
        Some(value) => value.whole().map(Some).ok_or_else(|| {
            fail(
                ReadErrorKind::Shape,
                format!("{place}: `{key}` is no whole number from 0"),
            )
        }),
    }
}

/// As [`whole`], for a key that is needed.
pub(super) fn needed(table: Value<'_>, key: &str, place: &At<'_>) -> Result<usize, ReadError> {
    whole(table, key, place)?
        .ok_or_else(|| fail(ReadErrorKind::Shape, format!("{place} has no `{key}`")))
}

/// Reads the buffer views; `lengths` are those of the buffers.
pub(super) fn views(list: &[Value<'_>], lengths: &[usize]) -> Result<Vec<View>, ReadError> {
    let read = |(i, value): (usize, &Value<'_>)| {
        let place = At("bufferViews", i);
        let buffer = needed(*value, "buffer", &place)?;
        let length = needed(*value, "byteLength", &place)?;
        let start = number(*value, "byteOffset", &place)?;
        let Some(&available) = lengths.get(buffer) else {
            return Err(fail(
                ReadErrorKind::Reference,
                format!(
                    "{place} is of buffer {buffer}, and there are {}",
                    lengths.len()
                ),
            ));
        };
        if start.checked_add(length).is_none_or(|end| end > available) {
            return Err(fail(
                ReadErrorKind::Reference,
                format!(
                    "{place} has {length} bytes from byte {start}, and buffer {buffer} has {available}"
                ),
            ));
        }
        Ok(View {
            buffer,
            start,
            length,
            stride: whole(*value, "byteStride", &place)?.filter(|stride| *stride > 0),
        })
    };
    list.iter().enumerate().map(read).collect()
}

/// `count` elements of `size` bytes from byte `offset` of a view.
fn layout(
    views: &[View],
    view: usize,
    offset: usize,
    size: usize,
    count: usize,
    strided: bool,
    place: &At<'_>,
) -> Result<Layout, ReadError> {
    let Some(found) = views.get(view) else {
        return Err(fail(
            ReadErrorKind::Reference,
            format!(
                "{place} is in buffer view {view}, and there are {}",
                views.len()
            ),
        ));
    };
    let stride = found.stride.filter(|_| strided).unwrap_or(size);
    if stride < size {
        return Err(fail(
            ReadErrorKind::Shape,
            format!("{place} has elements of {size} bytes every {stride} bytes"),
        ));
    }
    let end = match count {
        0 => Some(offset),
        count => (count - 1)
            .checked_mul(stride)
            .and_then(|last| last.checked_add(size)?.checked_add(offset)),
    };
    if end.is_none_or(|end| end > found.length) {
        return Err(fail(
            ReadErrorKind::Reference,
            format!(
                "{place} has {count} elements every {stride} bytes from byte {offset}, and buffer view {view} has {} bytes",
                found.length
            ),
        ));
    }
    Ok(Layout {
        buffer: found.buffer,
        start: found.start + offset,
        stride,
        size,
        count,
    })
}

impl Accessor {
    fn read(value: Value<'_>, views: &[View], place: &At<'_>) -> Result<Self, ReadError> {
        let count = needed(value, "count", place)?;
        let component = |table: Value<'_>| {
            let code = needed(table, "componentType", place)?;
            Component::of(code).ok_or_else(|| {
                fail(
                    ReadErrorKind::Unsupported,
                    format!("{place} has the component type {code}, which glTF 2.0 does not know"),
                )
            })
        };
        let kind = component(value)?;
        let name = value.get("type").and_then(Value::text).unwrap_or_default();
        // Columns of matrices begin at multiples of four bytes.
        let (columns, rows) = match &*name {
            "SCALAR" => (1, 1),
            "VEC2" => (1, 2),
            "VEC3" => (1, 3),
            "VEC4" => (1, 4),
            "MAT2" => (2, 2),
            "MAT3" => (3, 3),
            "MAT4" => (4, 4),
            _ => {
                return Err(fail(
                    ReadErrorKind::Unsupported,
                    format!("{place} has the type {name:?}, which glTF 2.0 does not know"),
                ));
            }
        };
        let column = rows * kind.size();
        let size = match columns {
            1 => column,
            _ => columns * column.next_multiple_of(4),
        };
        let base = match whole(value, "bufferView", place)? {
            None => None,
            Some(view) => {
                let offset = number(value, "byteOffset", place)?;
                Some(layout(views, view, offset, size, count, true, place)?)
            }
        };
        let sparse = match value.get("sparse") {
            None => None,
            Some(sparse) => {
                let some = needed(sparse, "count", place)?;
                if some > count {
                    return Err(fail(
                        ReadErrorKind::Shape,
                        format!("{place} replaces {some} of {count} elements"),
                    ));
                }
                let part = |key: &str| {
                    sparse.get(key).ok_or_else(|| {
                        fail(
                            ReadErrorKind::Shape,
                            format!("{place}: its sparse storage has no `{key}`"),
                        )
                    })
                };
                let (indices, values) = (part("indices")?, part("values")?);
                let index = component(indices)?;
                let place_of = |table: Value<'_>, size: usize| {
                    let view = needed(table, "bufferView", place)?;
                    let offset = number(table, "byteOffset", place)?;
                    layout(views, view, offset, size, some, false, place)
                };
                Some(Sparse {
                    indices: place_of(indices, index.size())?,
                    index,
                    values: place_of(values, size)?,
                })
            }
        };
        Ok(Self {
            base,
            count,
            component: kind,
            width: columns * rows,
            normalized: value.get("normalized").is_some_and(Value::is_true),
            sparse,
        })
    }

    /// The buffers in which it has bytes.
    pub(super) fn buffers(&self) -> impl Iterator<Item = usize> {
        self.layouts().map(|layout| layout.buffer)
    }
    /// All the places in which it has bytes.
    pub(super) fn layouts(&self) -> impl Iterator<Item = Layout> {
        let sparse = self.sparse.as_ref();
        let sparse = sparse.into_iter().flat_map(|s| [s.indices, s.values]);
        self.base.into_iter().chain(sparse)
    }

    /// Indices of the elements that the sparse storage replaces.
    pub(super) fn replaced(&self, buffers: &[&[u8]]) -> Vec<usize> {
        let Some(sparse) = &self.sparse else {
            return Vec::new();
        };
        let bytes = bytes(buffers, sparse.indices.buffer);
        (0..sparse.indices.count)
            .map(|i| unsigned(sparse.index, sparse.indices.element(bytes, i)))
            .collect()
    }

    /// Checks that the sparse storage's indices ascend and are of elements that exist.
    pub(super) fn check_sparse(&self, buffers: &[&[u8]], place: &At<'_>) -> Result<(), ReadError> {
        let replaced = self.replaced(buffers);
        let ascends = replaced.windows(2).all(|pair| pair[0] < pair[1]);
        if !ascends || replaced.last().is_some_and(|last| *last >= self.count) {
            return Err(fail(
                ReadErrorKind::Reference,
                format!(
                    "{place}: the indices of its sparse storage do not ascend, or one is of no element"
                ),
            ));
        }
        Ok(())
    }

    /// Its elements, of `N` numbers each; components of an element beyond those it has are 0.
    pub(super) fn elements<const N: usize, T: Real>(&self, buffers: &[&[u8]]) -> Vec<[T; N]> {
        let mut out = match &self.base {
            None => vec![[T::default(); N]; self.count],
            Some(layout) => {
                let bytes = bytes(buffers, layout.buffer);
                if self.is_tight(N) {
                    // The usual case, in bulk.
                    bytes
                        .get(layout.start..layout.end())
                        .unwrap_or(&[])
                        .chunks_exact(4 * N)
                        .map(float)
                        .collect()
                } else {
                    (0..self.count)
                        .map(|i| self.decoded(layout.element(bytes, i)))
                        .collect()
                }
            }
        };
        if let Some(sparse) = &self.sparse {
            let bytes = bytes(buffers, sparse.values.buffer);
            for (i, at) in self.replaced(buffers).into_iter().enumerate() {
                if let Some(slot) = out.get_mut(at) {
                    *slot = self.decoded(sparse.values.element(bytes, i));
                }
            }
        }
        out
    }

    /// Its first element, if that has bytes.
    pub(super) fn first<const N: usize>(&self, buffers: &[&[u8]]) -> Option<[f64; N]> {
        let layout = self.base.filter(|layout| layout.count > 0)?;
        Some(self.decoded(layout.element(bytes(buffers, layout.buffer), 0)))
    }

    fn decoded<const N: usize, T: Real>(&self, element: &[u8]) -> [T; N] {
        let mut out = [T::default(); N];
        let size = self.component.size();
        for (slot, part) in out
            .iter_mut()
            .zip(element.chunks_exact(size))
            .take(self.width)
        {
            *slot = if self.component == Component::F32 {
                T::of_f32(f32_of(part))
            } else {
                let value = signed(self.component, part);
                // Section 3.11, "Animations", and KHR_mesh_quantization have the same equations.
                T::of_f64(match (self.normalized, self.component) {
                    (true, Component::I8) => (value / 127.0).max(-1.0),
                    (true, Component::U8) => value / 255.0,
                    (true, Component::I16) => (value / 32767.0).max(-1.0),
                    (true, Component::U16) => value / 65535.0,
                    _ => value,
                })
            };
        }
        out
    }

    /// Its elements as points.
    pub(super) fn points(&self, buffers: &[&[u8]]) -> Vec<DVec3> {
        match &self.base {
            Some(layout) if self.sparse.is_none() && self.is_tight(3) => {
                bytes(buffers, layout.buffer)
                    .get(layout.start..layout.end())
                    .unwrap_or(&[])
                    .chunks_exact(12)
                    .map(|element| DVec3::from_array(float(element)))
                    .collect()
            }
            _ => {
                let elements: Vec<[f64; 3]> = self.elements(buffers);
                elements.into_iter().map(DVec3::from_array).collect()
            }
        }
    }

    /// Whether it is `width` floats an element, one element behind the other.
    pub(super) fn is_tight(&self, width: usize) -> bool {
        self.component == Component::F32
            && self.width == width
            && self.base.is_some_and(|layout| layout.stride == 4 * width)
    }

    /// Whether it can be indices.
    pub(super) fn is_index(&self) -> bool {
        let unsigned = [Component::U8, Component::U16, Component::U32];
        self.width == 1 && unsigned.contains(&self.component)
    }

    /// The highest index among its elements.
    pub(super) fn highest(&self, buffers: &[&[u8]]) -> Option<u32> {
        match &self.base {
            Some(layout)
                if self.sparse.is_none()
                    && self.component == Component::U32
                    && layout.stride == 4 =>
            {
                let tight = bytes(buffers, layout.buffer).get(layout.start..layout.end());
                let words = tight.unwrap_or(&[]).chunks_exact(4);
                words
                    .map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]]))
                    .max()
            }
            _ => self.indices(buffers).into_iter().max(),
        }
    }

    /// Its elements as indices.
    pub(super) fn indices(&self, buffers: &[&[u8]]) -> Vec<u32> {
        let mut out = match &self.base {
            None => vec![0; self.count],
            Some(layout) => {
                let bytes = bytes(buffers, layout.buffer);
                let tight = bytes.get(layout.start..layout.end()).unwrap_or(&[]);
                match self.component {
                    Component::U32 if layout.stride == 4 => {
                        let words = tight.chunks_exact(4);
                        words
                            .map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]]))
                            .collect()
                    }
                    Component::U16 if layout.stride == 2 => {
                        let halves = tight.chunks_exact(2);
                        halves
                            .map(|h| u32::from(u16::from_le_bytes([h[0], h[1]])))
                            .collect()
                    }
                    kind => (0..self.count)
                        .map(|i| unsigned(kind, layout.element(bytes, i)) as u32)
                        .collect(),
                }
            }
        };
        if let Some(sparse) = &self.sparse {
            let bytes = bytes(buffers, sparse.values.buffer);
            for (i, at) in self.replaced(buffers).into_iter().enumerate() {
                if let Some(slot) = out.get_mut(at) {
                    *slot = unsigned(self.component, sparse.values.element(bytes, i)) as u32;
                }
            }
        }
        out
    }
}

/// Reads the accessors.
pub(super) fn accessors(list: &[Value<'_>], views: &[View]) -> Result<Vec<Accessor>, ReadError> {
    let read = |(i, value): (usize, &Value<'_>)| Accessor::read(*value, views, &At("accessors", i));
    list.iter().enumerate().map(read).collect()
}

fn bytes<'a>(buffers: &[&'a [u8]], buffer: usize) -> &'a [u8] {
    buffers.get(buffer).copied().unwrap_or(&[])
}

/// A number that floats and integers can be read as.
pub(super) trait Real: Copy + Default {
    fn of_f32(value: f32) -> Self;
    fn of_f64(value: f64) -> Self;
}

impl Real for f32 {
    fn of_f32(value: f32) -> Self {
        value
    }
    fn of_f64(value: f64) -> Self {
        value as f32
    }
}

impl Real for f64 {
    fn of_f32(value: f32) -> Self {
        Self::from(value)
    }
    fn of_f64(value: f64) -> Self {
        value
    }
}

fn f32_of(part: &[u8]) -> f32 {
    part.first_chunk()
        .map_or(0.0, |four| f32::from_le_bytes(*four))
}

fn float<const N: usize, T: Real>(element: &[u8]) -> [T; N] {
    let mut out = [T::default(); N];
    for (slot, part) in out.iter_mut().zip(element.chunks_exact(4)) {
        *slot = T::of_f32(f32_of(part));
    }
    out
}

fn unsigned(kind: Component, part: &[u8]) -> usize {
    match (kind, part) {
        (Component::U8 | Component::I8, [a, ..]) => usize::from(*a),
        (Component::U16 | Component::I16, [a, b, ..]) => usize::from(u16::from_le_bytes([*a, *b])),
        (Component::U32 | Component::F32, [a, b, c, d, ..]) => {
            u32::from_le_bytes([*a, *b, *c, *d]) as usize
        }
        _ => 0,
    }
}

fn signed(kind: Component, part: &[u8]) -> f64 {
    match (kind, part) {
        (Component::I8, [a, ..]) => f64::from(*a as i8),
        (Component::I16, [a, b, ..]) => f64::from(i16::from_le_bytes([*a, *b])),
        _ => unsigned(kind, part) as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interleaved_elements_do_not_overlap_and_doubtful_ones_do() {
        let layout = |start, stride, size| Layout {
            buffer: 0,
            start,
            stride,
            size,
            count: 10,
        };
        let position = layout(0, 24, 12);
        assert!(!position.overlaps(&layout(12, 24, 12)));
        assert!(!layout(12, 24, 12).overlaps(&position));
        assert!(position.overlaps(&layout(8, 24, 12)));
        assert!(position.overlaps(&layout(24, 24, 12)));
        assert!(position.overlaps(&layout(12, 12, 12)));
        assert!(!position.overlaps(&layout(228, 12, 12)));
        assert!(position.overlaps(&layout(227, 12, 12)));
        assert!(!position.overlaps(&Layout {
            buffer: 1,
            ..position
        }));
    }
}
