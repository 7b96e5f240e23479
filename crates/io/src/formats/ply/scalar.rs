//! The types of numbers in PLY files.

/// A type of number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// The order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    Little,
    Big,
}

/// The first bytes as an array, zeros where there are fewer; callers give enough.
#[inline]
fn array<const N: usize>(bytes: &[u8]) -> [u8; N] {
    bytes.first_chunk::<N>().copied().unwrap_or([0; N])
}

macro_rules! read {
    ($type:ty, $bytes:expr, $order:expr) => {
        match $order {
            Order::Little => <$type>::from_le_bytes(array($bytes)),
            Order::Big => <$type>::from_be_bytes(array($bytes)),
        }
    };
}

impl Scalar {
    /// The type that a word of the header names, in either of the two sets of names.
    pub(super) fn named(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }
    /// Its name in the first of the two sets.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::I8 => "char",
            Self::U8 => "uchar",
            Self::I16 => "short",
            Self::U16 => "ushort",
            Self::I32 => "int",
            Self::U32 => "uint",
            Self::F32 => "float",
            Self::F64 => "double",
        }
    }
    /// Bytes of a number.
    #[inline]
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }
    /// Smallest and largest value of a type of whole numbers.
    fn range(self) -> (f64, f64) {
        match self {
            Self::I8 => (i8::MIN.into(), i8::MAX.into()),
            Self::U8 => (0.0, u8::MAX.into()),
            Self::I16 => (i16::MIN.into(), i16::MAX.into()),
            Self::U16 => (0.0, u16::MAX.into()),
            Self::I32 => (i32::MIN.into(), i32::MAX.into()),
            Self::U32 => (0.0, u32::MAX.into()),
            Self::F32 => (f32::MIN.into(), f32::MAX.into()),
            Self::F64 => (f64::MIN, f64::MAX),
        }
    }
    /// What a value of the type means as a colour from 0 to 1.
    pub(super) fn full(self) -> f64 {
        if self.is_float() { 1.0 } else { self.range().1 }
    }
    /// The number at the beginning of `bytes`.
    #[inline]
    pub(super) fn read(self, bytes: &[u8], order: Order) -> f64 {
        match self {
            Self::I8 => f64::from(array::<1>(bytes)[0] as i8),
            Self::U8 => f64::from(array::<1>(bytes)[0]),
            Self::I16 => f64::from(read!(i16, bytes, order)),
            Self::U16 => f64::from(read!(u16, bytes, order)),
            Self::I32 => f64::from(read!(i32, bytes, order)),
            Self::U32 => f64::from(read!(u32, bytes, order)),
            Self::F32 => f64::from(read!(f32, bytes, order)),
            Self::F64 => read!(f64, bytes, order),
        }
    }
    /// Whether a finite value can be written in this type: whole numbers exactly, others rounded once.
    #[inline]
    pub(super) fn holds(self, value: f64) -> bool {
        match self {
            Self::F64 => true,
            Self::F32 => (value as f32).is_finite(),
            _ => {
                let (low, high) = self.range();
                value == value.trunc() && (low..=high).contains(&value)
            }
        }
    }
    /// Puts a value that it [`holds`](Self::holds) at the beginning of `bytes`.
    #[inline]
    pub(super) fn write(self, value: f64, order: Order, bytes: &mut [u8]) {
        let (mut buffer, size) = ([0u8; 8], self.size());
        match self {
            Self::I8 | Self::I16 | Self::I32 => {
                buffer[..4].copy_from_slice(&(value as i32).to_le_bytes());
            }
            Self::U8 | Self::U16 | Self::U32 => {
                buffer[..4].copy_from_slice(&(value as u32).to_le_bytes());
            }
            Self::F32 => buffer[..4].copy_from_slice(&(value as f32).to_le_bytes()),
            Self::F64 => buffer = value.to_le_bytes(),
        }
        if order == Order::Big {
            buffer[..size].reverse();
        }
        bytes[..size].copy_from_slice(&buffer[..size]);
    }
}
