//! The plane and space as point types.
//!
//! *Source*: the point type **is** the space. A warp is written once over [`Space`] and works for [`Plane`] (2-D) and
//! [`Solid`] (3-D); marker types were tried and defeat type inference. Milliron et al., *A Framework for Geometric
//! Warps and Deformations*, ACM TOG 21(1), 2002, §3.1 asks for no more than points and affine maps.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use glam::{DMat2, DMat3, DVec2, DVec3};

/// A point or vector of the plane, in scene units.
pub type Plane = DVec2;
/// A point or vector of space, in scene units.
pub type Solid = DVec3;

/// A Euclidean space, named by its point type: [`Plane`] or [`Solid`].
///
/// Points and vectors share the type, as in glam. Coordinates are `f64`.
pub trait Space:
    Copy
    + Debug
    + Default
    + PartialEq
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + AddAssign
    + SubAssign
{
    /// Number of coordinates: 2 or 3.
    const DIM: usize;
    /// What messages call it: `"plane"` or `"space"`.
    const NAME: &'static str;
    /// The origin, also the null vector.
    const ZERO: Self;
    /// The linear maps of the space.
    type Linear: Linear<Self>;

    /// Builds a point from its coordinates: `f(axis)` for `axis` in `0..DIM`.
    fn from_fn(f: impl FnMut(usize) -> f64) -> Self;
    /// Coordinate number `axis`; 0 for an axis the space does not have.
    fn component(self, axis: usize) -> f64;
    /// The coordinates of a run of points, one after the other.
    #[cfg(feature = "simd")]
    fn coordinates(points: &[Self]) -> &[f64];
    /// The same, to change.
    #[cfg(feature = "simd")]
    fn coordinates_mut(points: &mut [Self]) -> &mut [f64];
    /// Inner product.
    fn dot(self, other: Self) -> f64;
    /// The linear map that turns by `angle` radians: counter-clockwise in the plane (where `axis` is not read), by the
    /// right-hand rule about `axis` in space. `axis` need not be of unit length; a null or non-finite axis gives the
    /// identity.
    fn rotation(axis: Self, angle: f64) -> Self::Linear;

    /// The unit vector along coordinate axis `axis`.
    fn unit(axis: usize) -> Self {
        Self::from_fn(|i| if i == axis { 1.0 } else { 0.0 })
    }
    /// The point whose coordinates are all `value`.
    fn splat(value: f64) -> Self {
        Self::from_fn(|_| value)
    }
    /// Euclidean length. Does not overflow or underflow where the length itself is representable.
    fn length(self) -> f64 {
        let plain = self.dot(self);
        if plain > 1e-280 && plain < 1e280 {
            return plain.sqrt();
        }
        let largest = self.largest();
        if largest == 0.0 || !largest.is_finite() {
            return largest;
        }
        let scaled = self / largest;
        scaled.dot(scaled).sqrt() * largest
    }
    /// Euclidean distance to `other`.
    fn distance(self, other: Self) -> f64 {
        (self - other).length()
    }
    /// The vector scaled to length 1, or `None` if it is null or not finite.
    fn normalized(self) -> Option<Self> {
        let length = self.length();
        (length > 0.0 && length.is_finite()).then(|| self / length)
    }
    /// Largest magnitude among the coordinates (NaN if any is NaN).
    fn largest(self) -> f64 {
        let mut largest = 0.0_f64;
        for axis in 0..Self::DIM {
            let magnitude = self.component(axis).abs();
            if magnitude > largest || magnitude.is_nan() {
                largest = magnitude;
            }
            if magnitude.is_nan() {
                return magnitude;
            }
        }
        largest
    }
    /// Whether every coordinate is finite.
    fn is_finite(self) -> bool {
        (0..Self::DIM).all(|axis| self.component(axis).is_finite())
    }
    /// The point moved by a vector. A coordinate that does not move keeps its bits: a negative zero its sign, too, which
    /// adding 0 would take away.
    fn moved_by(self, by: Self) -> Self {
        Self::from_fn(|i| {
            let (p, d) = (self.component(i), by.component(i));
            if d == 0.0 { p } else { p + d }
        })
    }
    /// Coordinate-wise minimum.
    fn min(self, other: Self) -> Self {
        Self::from_fn(|i| self.component(i).min(other.component(i)))
    }
    /// Coordinate-wise maximum.
    fn max(self, other: Self) -> Self {
        Self::from_fn(|i| self.component(i).max(other.component(i)))
    }
    /// Coordinate-wise product.
    fn scaled_by(self, other: Self) -> Self {
        Self::from_fn(|i| self.component(i) * other.component(i))
    }
}

/// A linear map of a [`Space`], a square matrix acting on columns.
pub trait Linear<S: Space>:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<f64, Output = Self>
{
    /// The identity map.
    const IDENTITY: Self;
    /// The null map.
    const ZERO: Self;
    /// Builds a map from its columns, the images of the unit vectors.
    fn from_columns(f: impl FnMut(usize) -> S) -> Self;
    /// Column `index`: the image of unit vector `index`.
    fn column(&self, index: usize) -> S;
    /// The image of `v`.
    fn apply(&self, v: S) -> S;
    /// `self` after `first`: the matrix product `self · first`.
    fn after(&self, first: &Self) -> Self;
    /// The determinant: signed volume (area) of the image of the unit cube (square).
    fn determinant(&self) -> f64;
    /// The transposed map.
    fn transposed(&self) -> Self;
    /// The cofactor matrix, `det · (inverse transpose)`, defined for singular maps too. It carries surface normals: the
    /// image of a normal is normal to the image of the surface, with the orientation the image's winding gives it.
    fn cofactor(&self) -> Self;

    /// Entry in row `row` and column `column`.
    fn entry(&self, row: usize, column: usize) -> f64 {
        self.column(column).component(row)
    }
    /// The outer product `a bᵀ`.
    fn outer(a: S, b: S) -> Self {
        Self::from_columns(|i| a * b.component(i))
    }
    /// The inverse map, or `None` when the determinant is zero, not finite, or so small that the inverse overflows.
    fn inverted(&self) -> Option<Self> {
        // Scaled first, so that a tiny or huge but regular map is not mistaken for a singular one.
        let size = (0..S::DIM).fold(0.0_f64, |m, i| m.max(self.column(i).largest()));
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let scaled = *self * (1.0 / size);
        let determinant = scaled.determinant();
        if determinant == 0.0 || !determinant.is_finite() {
            return None;
        }
        let inverse = scaled.cofactor().transposed() * (1.0 / determinant) * (1.0 / size);
        (0..S::DIM)
            .all(|i| inverse.column(i).is_finite())
            .then_some(inverse)
    }
}

impl Space for DVec2 {
    const DIM: usize = 2;
    const NAME: &'static str = "plane";
    const ZERO: Self = DVec2::ZERO;
    type Linear = DMat2;

    #[inline]
    fn from_fn(mut f: impl FnMut(usize) -> f64) -> Self {
        DVec2::new(f(0), f(1))
    }
    #[inline]
    fn component(self, axis: usize) -> f64 {
        match axis {
            0 => self.x,
            1 => self.y,
            _ => 0.0,
        }
    }
    #[cfg(feature = "simd")]
    #[inline]
    fn coordinates(points: &[Self]) -> &[f64] {
        bytemuck::cast_slice(points)
    }
    #[cfg(feature = "simd")]
    #[inline]
    fn coordinates_mut(points: &mut [Self]) -> &mut [f64] {
        bytemuck::cast_slice_mut(points)
    }
    #[inline]
    fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.y * other.y
    }
    fn rotation(_axis: Self, angle: f64) -> DMat2 {
        let (sin, cos) = crate::math::sin_cos(angle);
        DMat2::from_cols(DVec2::new(cos, sin), DVec2::new(-sin, cos))
    }
}

impl Linear<DVec2> for DMat2 {
    const IDENTITY: Self = DMat2::IDENTITY;
    const ZERO: Self = DMat2::ZERO;

    #[inline]
    fn from_columns(mut f: impl FnMut(usize) -> DVec2) -> Self {
        DMat2::from_cols(f(0), f(1))
    }
    #[inline]
    fn column(&self, index: usize) -> DVec2 {
        match index {
            0 => self.x_axis,
            1 => self.y_axis,
            _ => DVec2::ZERO,
        }
    }
    #[inline]
    fn apply(&self, v: DVec2) -> DVec2 {
        DVec2::new(
            self.x_axis.x * v.x + self.y_axis.x * v.y,
            self.x_axis.y * v.x + self.y_axis.y * v.y,
        )
    }
    #[inline]
    fn after(&self, first: &Self) -> Self {
        Self::from_columns(|i| self.apply(Linear::column(first, i)))
    }
    #[inline]
    fn determinant(&self) -> f64 {
        self.x_axis.x * self.y_axis.y - self.y_axis.x * self.x_axis.y
    }
    #[inline]
    fn transposed(&self) -> Self {
        self.transpose()
    }
    fn cofactor(&self) -> Self {
        DMat2::from_cols(
            DVec2::new(self.y_axis.y, -self.y_axis.x),
            DVec2::new(-self.x_axis.y, self.x_axis.x),
        )
    }
}

impl Space for DVec3 {
    const DIM: usize = 3;
    const NAME: &'static str = "space";
    const ZERO: Self = DVec3::ZERO;
    type Linear = DMat3;

    #[inline]
    fn from_fn(mut f: impl FnMut(usize) -> f64) -> Self {
        DVec3::new(f(0), f(1), f(2))
    }
    #[inline]
    fn component(self, axis: usize) -> f64 {
        match axis {
            0 => self.x,
            1 => self.y,
            2 => self.z,
            _ => 0.0,
        }
    }
    #[cfg(feature = "simd")]
    #[inline]
    fn coordinates(points: &[Self]) -> &[f64] {
        bytemuck::cast_slice(points)
    }
    #[cfg(feature = "simd")]
    #[inline]
    fn coordinates_mut(points: &mut [Self]) -> &mut [f64] {
        bytemuck::cast_slice_mut(points)
    }
    #[inline]
    fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }
    fn rotation(axis: Self, angle: f64) -> DMat3 {
        let Some(k) = Space::normalized(axis) else {
            return DMat3::IDENTITY;
        };
        let (sin, cos) = crate::math::sin_cos(angle);
        // Rodrigues: cos·I + sin·[k]× + (1 − cos)·k kᵀ.
        let cross = DMat3::from_cols(
            DVec3::new(0.0, k.z, -k.y),
            DVec3::new(-k.z, 0.0, k.x),
            DVec3::new(k.y, -k.x, 0.0),
        );
        DMat3::IDENTITY * cos + cross * sin + <DMat3 as Linear<DVec3>>::outer(k, k) * (1.0 - cos)
    }
}

impl Linear<DVec3> for DMat3 {
    const IDENTITY: Self = DMat3::IDENTITY;
    const ZERO: Self = DMat3::ZERO;

    #[inline]
    fn from_columns(mut f: impl FnMut(usize) -> DVec3) -> Self {
        DMat3::from_cols(f(0), f(1), f(2))
    }
    #[inline]
    fn column(&self, index: usize) -> DVec3 {
        match index {
            0 => self.x_axis,
            1 => self.y_axis,
            2 => self.z_axis,
            _ => DVec3::ZERO,
        }
    }
    #[inline]
    fn apply(&self, v: DVec3) -> DVec3 {
        DVec3::new(
            self.x_axis.x * v.x + self.y_axis.x * v.y + self.z_axis.x * v.z,
            self.x_axis.y * v.x + self.y_axis.y * v.y + self.z_axis.y * v.z,
            self.x_axis.z * v.x + self.y_axis.z * v.y + self.z_axis.z * v.z,
        )
    }
    #[inline]
    fn after(&self, first: &Self) -> Self {
        Self::from_columns(|i| self.apply(Linear::column(first, i)))
    }
    #[inline]
    fn determinant(&self) -> f64 {
        self.x_axis.dot(self.y_axis.cross(self.z_axis))
    }
    #[inline]
    fn transposed(&self) -> Self {
        self.transpose()
    }
    fn cofactor(&self) -> Self {
        DMat3::from_cols(
            self.y_axis.cross(self.z_axis),
            self.z_axis.cross(self.x_axis),
            self.x_axis.cross(self.y_axis),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_of_tiny_and_huge_regular_maps() {
        for size in [1e-150, 1.0, 1e150] {
            let map = DMat3::from_cols(
                DVec3::new(2.0, 1.0, 0.0),
                DVec3::new(0.0, 1.0, 0.5),
                DVec3::new(0.0, 0.3, 1.0),
            ) * size;
            let back = Linear::inverted(&map).unwrap().after(&map);
            for i in 0..3 {
                assert!((Linear::column(&back, i) - DVec3::unit(i)).length() < 1e-14);
            }
        }
        assert!(Linear::inverted(&DMat3::ZERO).is_none());
        assert!(Linear::inverted(&<DMat2 as Linear<DVec2>>::outer(DVec2::X, DVec2::ONE)).is_none());
    }

    #[test]
    fn cofactor_is_determinant_times_inverse_transpose() {
        let map = DMat2::from_cols(DVec2::new(2.0, 1.0), DVec2::new(-3.0, 0.5));
        let expected = Linear::inverted(&map).unwrap().transpose() * Linear::determinant(&map);
        assert!(
            (map.cofactor() - expected)
                .to_cols_array()
                .iter()
                .all(|e| e.abs() < 1e-14)
        );
    }

    #[test]
    fn rotation_turns_counter_clockwise() {
        let quarter = core::f64::consts::FRAC_PI_2;
        assert!(
            (DVec2::rotation(DVec2::ZERO, quarter).apply(DVec2::X) - DVec2::Y).length() < 1e-15
        );
        assert!(
            (DVec3::rotation(DVec3::Z * 7.0, quarter).apply(DVec3::X) - DVec3::Y).length() < 1e-15
        );
        assert_eq!(DVec3::rotation(DVec3::ZERO, quarter), DMat3::IDENTITY);
    }

    #[test]
    fn length_neither_overflows_nor_underflows() {
        assert!((Space::length(DVec3::splat(1e200)) / 1e200 - 3f64.sqrt()).abs() < 1e-15);
        assert!((Space::length(DVec2::splat(1e-200)) / 1e-200 - 2f64.sqrt()).abs() < 1e-15);
    }
}
