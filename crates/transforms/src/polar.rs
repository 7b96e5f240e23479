//! Polar decomposition `A = R·U` into a rotation and a stretch.
//!
//! *Source*: K. Shoemake and T. Duff, *Matrix Animation and Polar Decomposition*, Graphics Interface 1992. Singular
//! vectors by one-sided Jacobi rotations (M. R. Hestenes, *Inversion of Matrices by Biorthogonalization and Related
//! Results*, J. SIAM 6(1), 1958; J. Demmel and K. Veselić, *Jacobi's Method is More Accurate than QR*, SIAM J. Matrix
//! Anal. Appl. 13(4), 1992): one code for the plane and for space, with sums, products, quotients and square roots only,
//! so that results do not depend on the processor, and accurate for nearly singular maps, where a method that forms
//! `AᵀA` loses half the digits. Errata F18.

use anamorph_core::{Linear, Space};

use crate::Rotational;

/// A linear map taken apart: `rotation · stretch`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polar<S: Space> {
    /// The rotation `R`, of determinant +1.
    pub rotation: S::Linear,
    /// The stretch `U`, symmetric. Its eigenvalues are not negative unless the map is a reflection.
    pub stretch: S::Linear,
}

/// Singular values below this share of the largest one count as zero when the rotation's free directions are chosen.
const RANK: f64 = 1e-14;
/// A smallest singular value below this share of the largest one does not make a map a reflection: such a determinant is
/// rounding of a flat map's.
const FLAT: f64 = 1e-12;
/// Singular values closer than this share of the largest one are equal: a reflection may choose its mirror freely there.
/// Also the difference of traces (cosines of angles) below which two rotations are equally small.
const EQUAL: f64 = 1e-12;
/// Jacobi sweeps until no pair of columns is less than perpendicular to rounding; six were the most ever seen.
const SWEEPS: usize = 32;

/// The polar decomposition `A = R·U` with `R` a rotation (determinant +1) and `U` symmetric.
///
/// - Determinant positive: the classical decomposition, `U` positive definite.
/// - Determinant negative (a reflection): `U² = AᵀA` still, with an odd number of negative eigenvalues, chosen so that
///   the angle of `R` is smallest; of two equally small rotations the one in the positive sense (counter-clockwise; first
///   non-zero component of the axis positive). It jumps where the smallest rotation is not unique.
/// - Singular: `U` has a null direction; `R` is completed to a rotation where that is unique, else (rank 1 in space) it is
///   the smallest rotation that does it, and the identity for the null map.
/// - Not finite: the identity and the map itself.
pub fn polar<S: Rotational>(map: &S::Linear) -> Polar<S> {
    let size = (0..S::DIM).fold(0.0_f64, |m, i| m.max(map.column(i).largest()));
    let finite = (0..S::DIM).all(|i| map.column(i).is_finite());
    if size == 0.0 || !finite {
        return Polar {
            rotation: S::Linear::IDENTITY,
            stretch: *map,
        };
    }
    // A power of two loses nothing, and keeps squares away from overflow and underflow.
    let scale = power_of_two_below(size);
    let mut frame = Singular::of(&(*map * (1.0 / scale)));
    let largest = frame.values[0];
    let rank = (0..S::DIM)
        .filter(|&i| frame.values[i] > RANK * largest)
        .count();

    if rank + 1 < S::DIM {
        let (from, to) = (frame.right[0], frame.left[0]);
        let rotation =
            S::turn_between(from, to).map_or(S::Linear::IDENTITY, |turn| turn.matrix(1.0));
        return Polar {
            rotation,
            stretch: S::Linear::outer(from, from) * (largest * scale),
        };
    }
    let last = S::DIM - 1;
    if rank < S::DIM {
        frame.left[last] = completed(&frame.left);
        if frame.handedness() < 0.0 {
            frame.left[last] = -frame.left[last];
        }
        frame.values[last] = 0.0;
    } else if frame.handedness() < 0.0 {
        if frame.values[last] <= FLAT * largest {
            frame.negate(last);
        } else {
            frame.undo_reflection();
        }
    }
    Polar {
        rotation: frame.rotation(),
        stretch: frame.stretch(scale),
    }
}

/// The largest power of two not above a positive finite number.
fn power_of_two_below(x: f64) -> f64 {
    let exponent = x.to_bits() >> 52;
    // Subnormal numbers are small enough to be treated as the smallest normal one.
    f64::from_bits(exponent.clamp(1, 2044) << 52)
}

/// The unit vector that makes a right-handed frame with the first `DIM − 1` vectors.
fn completed<S: Space>(vectors: &[S; 3]) -> S {
    let last = S::DIM - 1;
    let frame = S::Linear::from_columns(|i| if i < last { vectors[i] } else { S::ZERO });
    frame.cofactor().column(last)
}

/// Singular values in descending order with their vectors: `A·right[i] = values[i]·left[i]`.
struct Singular<S> {
    values: [f64; 3],
    left: [S; 3],
    right: [S; 3],
}

impl<S: Rotational> Singular<S> {
    fn of(map: &S::Linear) -> Self {
        // Rotating pairs of columns until all are perpendicular gives A·V = W·Σ.
        let mut g: [S; 3] = core::array::from_fn(|i| map.column(i));
        let mut v: [S; 3] = core::array::from_fn(S::unit);
        for _ in 0..SWEEPS {
            let mut rotated = false;
            for p in 0..S::DIM {
                for q in p + 1..S::DIM {
                    let (alpha, beta, gamma) = (g[p].dot(g[p]), g[q].dot(g[q]), g[p].dot(g[q]));
                    let threshold = f64::EPSILON * alpha.sqrt() * beta.sqrt();
                    if gamma.abs() <= threshold {
                        continue;
                    }
                    rotated = true;
                    let (cos, sin) = diagonalizing(alpha, beta, gamma);
                    turn_pair(&mut g, p, q, cos, sin);
                    turn_pair(&mut v, p, q, cos, sin);
                }
            }
            if !rotated {
                break;
            }
        }
        let mut order = [0, 1, 2];
        let length: [f64; 3] = core::array::from_fn(|i| g[i].length());
        order[..S::DIM].sort_by(|&i, &j| length[j].total_cmp(&length[i]));
        Self {
            values: order.map(|i| length[i]),
            left: order.map(|i| g[i].normalized().unwrap_or(S::ZERO)),
            right: order.map(|i| v[i]),
        }
    }

    /// Sign of the determinant of `W Vᵀ`: negative for a reflection.
    fn handedness(&self) -> f64 {
        let determinant = |vectors: &[S; 3]| S::Linear::from_columns(|i| vectors[i]).determinant();
        determinant(&self.left) * determinant(&self.right)
    }

    /// Lets the stretch carry a mirror along direction `i`.
    fn negate(&mut self, i: usize) {
        self.left[i] = -self.left[i];
        self.values[i] = -self.values[i];
    }

    /// Lets the stretch carry a reflection, so that what is left is the rotation of smallest angle.
    fn undo_reflection(&mut self) {
        // With Q = W Vᵀ the rotation is Q·J for a symmetric involution J that commutes with the stretch. Its trace is
        // largest when J is diagonal in the basis in which the symmetric part of Q is, as far as equal singular values
        // leave the basis free.
        let equal = |a: f64, b: f64| (a - b).abs() <= EQUAL * self.values[0];
        let free: [[bool; 3]; 3] = core::array::from_fn(|i| {
            core::array::from_fn(|j| equal(self.values[i], self.values[j]))
        });
        for _ in 0..SWEEPS {
            for p in 0..S::DIM {
                for q in p + 1..S::DIM {
                    if !free[p][q] {
                        continue;
                    }
                    let (v, w) = (self.right, self.left);
                    let off = 0.5 * (v[p].dot(w[q]) + v[q].dot(w[p]));
                    if off.abs() <= f64::EPSILON {
                        continue;
                    }
                    let (cos, sin) = diagonalizing(v[p].dot(w[p]), v[q].dot(w[q]), off);
                    turn_pair(&mut self.left, p, q, cos, sin);
                    turn_pair(&mut self.right, p, q, cos, sin);
                }
            }
        }
        let cosines: [f64; 3] = core::array::from_fn(|i| self.right[i].dot(self.left[i]));
        let mut best: Option<(f64, bool, u32)> = None;
        // Bit i of a pattern says that eigenvalue i is negative; the mirror of the smallest stretch comes first.
        for pattern in (0..1_u32 << S::DIM).rev() {
            if pattern.count_ones() % 2 == 0 {
                continue;
            }
            let trace: f64 = (0..S::DIM)
                .map(|i| {
                    if pattern >> i & 1 == 1 {
                        -cosines[i]
                    } else {
                        cosines[i]
                    }
                })
                .sum();
            let positive = S::sense_is_positive(&S::turn_of(&self.negated(pattern).rotation()));
            let better = best
                .is_none_or(|(t, p, _)| trace > t + EQUAL || (trace > t - EQUAL && positive && !p));
            if better {
                best = Some((trace, positive, pattern));
            }
        }
        if let Some((_, _, pattern)) = best {
            *self = self.negated(pattern);
        }
    }

    fn negated(&self, pattern: u32) -> Self {
        let mut copy = Self { ..*self };
        for i in (0..S::DIM).filter(|i| pattern >> i & 1 == 1) {
            copy.negate(i);
        }
        copy
    }

    fn rotation(&self) -> S::Linear {
        (0..S::DIM).fold(S::Linear::ZERO, |sum, i| {
            sum + S::Linear::outer(self.left[i], self.right[i])
        })
    }

    fn stretch(&self, scale: f64) -> S::Linear {
        (0..S::DIM).fold(S::Linear::ZERO, |sum, i| {
            sum + S::Linear::outer(self.right[i], self.right[i]) * (self.values[i] * scale)
        })
    }
}

/// Cosine and sine of the Jacobi rotation that makes `[alpha gamma; gamma beta]` diagonal.
fn diagonalizing(alpha: f64, beta: f64, gamma: f64) -> (f64, f64) {
    let zeta = (beta - alpha) / (2.0 * gamma);
    // The smaller root; a huge zeta (its square may overflow) gives a tiny tangent.
    let tan = if zeta.abs() > 1e150 {
        0.5 / zeta
    } else {
        let root = zeta.abs() + (1.0 + zeta * zeta).sqrt();
        if zeta < 0.0 { -1.0 / root } else { 1.0 / root }
    };
    let cos = 1.0 / (1.0 + tan * tan).sqrt();
    (cos, cos * tan)
}

fn turn_pair<S: Space>(vectors: &mut [S; 3], p: usize, q: usize, cos: f64, sin: f64) {
    let (a, b) = (vectors[p], vectors[q]);
    vectors[p] = a * cos - b * sin;
    vectors[q] = a * sin + b * cos;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Turn;
    use crate::testing::{Random, far};
    use anamorph_core::glam::{DMat2, DMat3, DVec2, DVec3};
    use anamorph_core::math;

    /// Checks what every decomposition promises and returns it.
    fn checked<S: Rotational>(map: &S::Linear) -> Polar<S> {
        let size = (0..S::DIM).fold(0.0_f64, |m, i| m.max(map.column(i).largest()));
        let parts = polar::<S>(map);
        let back = parts.rotation.after(&parts.stretch);
        assert!(far::<S>(&back, map) <= 2e-14 * size, "{map:?}");
        let square = parts.rotation.transposed().after(&parts.rotation);
        assert!(far::<S>(&square, &S::Linear::IDENTITY) < 5e-15, "{map:?}");
        assert!((parts.rotation.determinant() - 1.0).abs() < 1e-14);
        assert_eq!(parts.stretch, parts.stretch.transposed());
        parts
    }

    fn angle<S: Rotational>(rotation: &S::Linear) -> f64 {
        S::turn_of(rotation).angle.abs()
    }

    /// Smallest eigenvalue of a symmetric map.
    fn smallest(map: &DMat3) -> f64 {
        let m = nalgebra::Matrix3::from_column_slice(&map.to_cols_array());
        m.symmetric_eigenvalues().min()
    }

    #[test]
    fn known_parts_are_found() {
        let mut random = Random::new(1);
        for step in 0..3000 {
            let rotation = match step % 3 {
                // Down to 1e-12 from a half turn.
                0 => <DVec3 as Space>::rotation(
                    random.direction(),
                    core::f64::consts::PI - math::powi(0.1, step % 12),
                ),
                _ => random.rotation::<DVec3>(),
            };
            let axes = random.rotation::<DVec3>();
            // Stretches from 1 down to 1e-10 along any axes.
            let thin = math::powi(0.1, step % 11);
            let lengths = DVec3::new(1.0, random.between(0.5, 2.0), thin);
            let stretch = axes * DMat3::from_diagonal(lengths) * axes.transpose();
            let size = math::powi(10.0, step % 7);
            let parts = checked::<DVec3>(&(rotation * stretch * size));
            // The two larger stretches fix the rotation, however thin the third.
            assert!(
                far::<DVec3>(&parts.rotation, &rotation) < 1e-13,
                "{step}: {}",
                far::<DVec3>(&parts.rotation, &rotation)
            );
            assert!(far::<DVec3>(&parts.stretch, &(stretch * size)) < 1e-13 * size);
            assert!(smallest(&parts.stretch) > -1e-13 * size);
        }
    }

    #[test]
    fn agrees_with_nalgebra() {
        let mut random = Random::new(2);
        let mut compared = 0;
        for _ in 0..1000 {
            let map = random.linear::<DVec3>();
            let parts = checked::<DVec3>(&map);
            let m = nalgebra::Matrix3::from_column_slice(&map.to_cols_array());
            let svd = m.svd(true, true);
            if m.determinant() > 0.0 && svd.singular_values.min() > 0.05 {
                let rotation = svd.u.unwrap() * svd.v_t.unwrap();
                let rotation = DMat3::from_cols_slice(rotation.as_slice());
                assert!(far::<DVec3>(&parts.rotation, &rotation) < 1e-12);
                compared += 1;
            }
        }
        assert!(compared > 300);
    }

    #[test]
    fn plane_maps_of_every_kind() {
        let mut random = Random::new(3);
        for step in 0..3000 {
            let mut map = random.linear::<DVec2>();
            if step % 3 == 0 {
                map.y_axis = map.x_axis * 2.0 + map.y_axis * math::powi(0.1, step % 30);
            }
            let parts = checked::<DVec2>(&map);
            if Linear::determinant(&map) > 1e-12 {
                // The plane has a closed form: the rotation is that of A + cofactor(A).
                let sum = map + Linear::cofactor(&map);
                let expected = sum * (1.0 / Space::length(sum.x_axis));
                let size = Space::length(sum.x_axis);
                assert!(far::<DVec2>(&parts.rotation, &expected) < 1e-14 / size.min(1.0));
                assert!(parts.stretch.x_axis.x + parts.stretch.y_axis.y > 0.0);
            }
        }
    }

    #[test]
    fn errata_f18_reflections_take_the_smallest_rotation() {
        let mut random = Random::new(4);
        for _ in 0..500 {
            let mut map = random.linear::<DVec3>();
            if map.determinant() > 0.0 {
                map.z_axis = -map.z_axis;
            }
            let parts = checked::<DVec3>(&map);
            let m = nalgebra::Matrix3::from_column_slice(&map.to_cols_array());
            let svd = m.svd(true, true);
            if svd.singular_values.min() < 1e-3 {
                continue;
            }
            let (u, v_t) = (svd.u.unwrap(), svd.v_t.unwrap());
            for signs in [
                [1.0, 1.0, -1.0],
                [1.0, -1.0, 1.0],
                [-1.0, 1.0, 1.0],
                [-1.0, -1.0, -1.0],
            ] {
                let other = u * nalgebra::Matrix3::from_diagonal(&signs.into()) * v_t;
                let other = DMat3::from_cols_slice(other.as_slice());
                assert!(angle::<DVec3>(&parts.rotation) <= angle::<DVec3>(&other) + 1e-9);
            }
        }
    }

    #[test]
    fn errata_f18_pure_mirrors_do_not_turn() {
        let mut random = Random::new(5);
        for _ in 0..200 {
            // Equal singular values: the mirror's plane is found all the same.
            let n: DVec3 = random.direction();
            let mirror = DMat3::IDENTITY - <DMat3 as Linear<DVec3>>::outer(n, n) * 2.0;
            assert!(angle::<DVec3>(&checked::<DVec3>(&(mirror * 3.0)).rotation) < 1e-14);
            let n: DVec2 = random.direction();
            let mirror = DMat2::IDENTITY - <DMat2 as Linear<DVec2>>::outer(n, n) * 2.0;
            assert!(angle::<DVec2>(&checked::<DVec2>(&mirror).rotation) < 1e-14);
            // Point reflection, and a mirror after a rotation about its normal: only that rotation is left.
            let n: DVec3 = random.direction();
            let mirror = DMat3::IDENTITY - <DMat3 as Linear<DVec3>>::outer(n, n) * 2.0;
            let turned = <DVec3 as Space>::rotation(n, 0.7) * mirror;
            assert!((angle::<DVec3>(&checked::<DVec3>(&turned).rotation) - 0.7).abs() < 1e-13);
        }
        assert_eq!(
            polar::<DVec3>(&(DMat3::IDENTITY * -2.0)).rotation,
            DMat3::IDENTITY
        );
        // Both quarter turns are equally small: the counter-clockwise one.
        let tie = DMat2::from_cols(DVec2::new(0.0, 2.0), DVec2::new(1.0, 0.0));
        let parts = checked::<DVec2>(&tie);
        let turn: Turn<DVec2> = DVec2::turn_of(&parts.rotation);
        assert!((turn.angle - core::f64::consts::FRAC_PI_2).abs() < 1e-14);
    }

    #[test]
    fn singular_maps() {
        let mut random = Random::new(6);
        for _ in 0..300 {
            // Flat: still fixed by the plane it keeps.
            let rotation = random.rotation::<DVec3>();
            let axes = random.rotation::<DVec3>();
            let flat = axes * DMat3::from_diagonal(DVec3::new(2.0, 0.7, 0.0)) * axes.transpose();
            let parts = checked::<DVec3>(&(rotation * flat));
            assert!(far::<DVec3>(&parts.rotation, &rotation) < 1e-13);
            // Squeezed into a line: the smallest rotation onto it.
            let (from, to): (DVec3, DVec3) = (random.direction(), random.direction());
            let parts = checked::<DVec3>(&(<DMat3 as Linear<DVec3>>::outer(to, from) * 5.0));
            assert!((angle::<DVec3>(&parts.rotation) - from.angle_between(to)).abs() < 1e-7);
            let (from, to): (DVec2, DVec2) = (random.direction(), random.direction());
            checked::<DVec2>(&<DMat2 as Linear<DVec2>>::outer(to, from));
        }
        let null = polar::<DVec3>(&DMat3::ZERO);
        assert_eq!(
            (null.rotation, null.stretch),
            (DMat3::IDENTITY, DMat3::ZERO)
        );
    }

    #[test]
    fn sizes_at_the_ends_of_the_range() {
        let mut random = Random::new(7);
        for size in [1e-300, 1e-160, 1e160, 1e300] {
            let map = random.linear::<DVec3>();
            let small = checked::<DVec3>(&(map * size));
            assert!(far::<DVec3>(&small.rotation, &polar::<DVec3>(&map).rotation) < 1e-13);
        }
        let nan = polar::<DVec2>(&(DMat2::IDENTITY * f64::NAN));
        assert_eq!(nan.rotation, DMat2::IDENTITY);
        assert!(
            polar::<DVec3>(&(DMat3::IDENTITY * 5e-324))
                .rotation
                .is_finite()
        );
    }
}
