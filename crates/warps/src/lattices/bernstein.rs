//! Free-form deformation with Bernstein polynomials (FFD).
//!
//! Computes `p̃ = p + Σ_ijk B_i(s) B_j(t) B_k(u) (P*_ijk − P_ijk)` for points with local coordinates `(s, t, u)` in the
//! closed lattice box; a point outside is left where it is.
//!
//! *Source*: T. W. Sederberg and S. R. Parry, *Free-Form Deformation of Solid Geometric Models*, SIGGRAPH 1986; cast as
//! in Milliron et al. 2002, §4.1. Errata F1 (index of the Bernstein polynomial), F2 (`T = P* − P`), F3 (outside the box;
//! continuity across its faces).

use super::grid::{face_smoothness, one};
use super::{Grid, LatticeError};
use anamorph_core::simd::{self, Level, Simd, dispatch, f64x8, prelude::*};
use anamorph_core::{
    Address, Affine, Condition, Deformation, Facts, Influences, Linear, Mark, Site, Smoothness,
    Space, Unmapped, Warp,
};
use anamorph_fields::basis;

/// Most control points along an axis. Beyond it the Bernstein polynomials are so flat that no one edits them, and their
/// binomials lose digits; a B-spline lattice takes over.
pub const MOST_POINTS: usize = 32;

/// A Bernstein lattice and the displacements of its control points.
#[derive(Debug, Clone, PartialEq)]
pub struct BernsteinLattice<S: Space> {
    grid: Grid<S>,
    displacements: Vec<S>,
    /// The same, three numbers a point, for the kernel.
    flat: Vec<[f64; 3]>,
    facts: Facts<S>,
}

impl<S: Space> BernsteinLattice<S> {
    /// The lattice on `grid` whose control point `i` (flat, last index fastest) moves by `displacements[i]`.
    ///
    /// # Errors
    /// [`LatticeError`] for fewer than two or more than [`MOST_POINTS`] points along an axis, a list of the wrong length,
    /// or a displacement that is not finite.
    pub fn construct(grid: Grid<S>, displacements: Vec<S>) -> Result<Self, LatticeError> {
        for (axis, &points) in grid.shape().iter().enumerate().take(S::DIM) {
            if !(2..=MOST_POINTS).contains(&points) {
                let need = format!(
                    "a Bernstein lattice takes 2 to {MOST_POINTS}; use a B-spline lattice for more"
                );
                return Err(LatticeError::Shape { axis, points, need });
            }
        }
        if displacements.len() != grid.len() {
            return Err(LatticeError::Count {
                expected: grid.len(),
                found: displacements.len(),
            });
        }
        if let Some(index) = displacements.iter().position(|d| !d.is_finite()) {
            return Err(LatticeError::NotFinite { index });
        }
        let flat = displacements
            .iter()
            .map(|d| core::array::from_fn(|axis| d.component(axis)))
            .collect();
        let mut lattice = Self {
            grid,
            displacements,
            flat,
            facts: Facts::identity(),
        };
        lattice.facts = lattice.derive_facts();
        Ok(lattice)
    }

    /// The box and its grid.
    pub fn grid(&self) -> &Grid<S> {
        &self.grid
    }
    /// Displacements of the control points.
    pub fn displacements(&self) -> &[S] {
        &self.displacements
    }

    /// Rest position of a control point: evenly spaced in the box.
    pub fn control_point(&self, flat: usize) -> S {
        control_point(&self.grid, flat)
    }

    /// The cage before and after, for pictures.
    pub fn marks(&self) -> Vec<Mark<S>> {
        let rest: Vec<S> = (0..self.grid.len())
            .map(|i| self.control_point(i))
            .collect();
        let targets: Vec<S> = rest
            .iter()
            .zip(&self.displacements)
            .map(|(&p, &d)| p + d)
            .collect();
        let moved: Vec<bool> = self.displacements.iter().map(|d| *d != S::ZERO).collect();
        let mut marks = self.grid.cage(&rest, &moved, false);
        marks.extend(self.grid.cage(&targets, &moved, true));
        marks
    }

    /// Bernstein values (or derivatives) along each axis at a local point.
    fn basis(&self, local: S, derivative_axis: Option<usize>) -> [Vec<f64>; 3] {
        core::array::from_fn(|axis| {
            let mut values = vec![1.0; self.grid.shape()[axis]];
            if axis < S::DIM {
                let t = local.component(axis);
                if derivative_axis == Some(axis) {
                    basis::bernstein::derivatives(t, &mut values);
                } else {
                    basis::bernstein::values(t, &mut values);
                }
            }
            values
        })
    }

    fn derive_facts(&self) -> Facts<S> {
        let scale = self
            .displacements
            .iter()
            .fold(0.0_f64, |m, d| m.max(d.largest()));
        if scale == 0.0 {
            return Facts::identity();
        }
        let derivative = |axis: usize, order: u8, end: bool| {
            end_derivatives(self.grid.shape()[axis], usize::from(order), end)
        };
        let moves = |flat: usize| self.flat[flat].to_vec();
        let edge = face_smoothness(&self.grid, Smoothness::Smooth, scale, derivative, &moves);
        let note = lattice_note(
            edge,
            "the outer k + 1 planes of control points must stay for C^k",
        );
        Facts {
            support: self.grid.support(),
            edge,
            ..Facts::identity()
        }
        .with_note(note)
    }

    fn sum(&self, basis: &[Vec<f64>; 3]) -> S {
        let mut sum = S::ZERO;
        for (flat, &d) in self.displacements.iter().enumerate() {
            let [i, j, k] = self.grid.triple(flat);
            sum += d * (basis[0][i] * basis[1][j] * basis[2][k]);
        }
        sum
    }
}

/// Rest position of an evenly spaced control point.
pub(crate) fn control_point<S: Space>(grid: &Grid<S>, flat: usize) -> S {
    let (triple, shape) = (grid.triple(flat), grid.shape());
    #[allow(clippy::cast_precision_loss)]
    grid.place(S::from_fn(|axis| {
        triple[axis] as f64 / (shape[axis].max(2) - 1) as f64
    }))
}

impl<S: Space> Deformation<S> for BernsteinLattice<S> {
    fn map(&self, site: &Site<S>) -> S {
        one(site, |points| {
            self.map_points(site.index, points);
        })
    }

    fn map_points(&self, _: usize, points: &mut [S]) -> Unmapped {
        // The usual sizes get code of their own, whose loops the compiler unrolls.
        match self.grid.shape() {
            [4, 4, 4] => {
                dispatch!(Level::new(), v => kernel::<_, S, 4>(v, self, [4, 4, 4], points));
            }
            [3, 3, 3] => {
                dispatch!(Level::new(), v => kernel::<_, S, 3>(v, self, [3, 3, 3], points));
            }
            [2, 2, 2] => {
                dispatch!(Level::new(), v => kernel::<_, S, 2>(v, self, [2, 2, 2], points));
            }
            shape if shape.iter().all(|&n| n <= 8) => {
                dispatch!(Level::new(), v => kernel::<_, S, 8>(v, self, shape, points));
            }
            shape => {
                dispatch!(Level::new(), v => kernel::<_, S, MOST_POINTS>(v, self, shape, points));
            }
        }
        Unmapped::none()
    }

    fn jacobian(&self, site: &Site<S>, _: f64) -> Option<S::Linear> {
        let Some(local) = self.grid.local(site.point) else {
            return Some(S::Linear::IDENTITY);
        };
        let gradients = self.grid.local_gradients();
        let mut jacobian = S::Linear::IDENTITY;
        for axis in 0..S::DIM {
            let along = self.sum(&self.basis(local, Some(axis)));
            jacobian = jacobian + S::Linear::outer(along, gradients.column(axis));
        }
        Some(jacobian)
    }

    fn facts(&self) -> Facts<S> {
        self.facts.clone()
    }
}

/// The sentence about the faces of a lattice box.
pub(crate) fn lattice_note(edge: Smoothness, condition: &str) -> String {
    let what = match edge {
        Smoothness::Jump => {
            "jumps across the faces of its box (a model inside the box does not see it)".to_owned()
        }
        class => format!("is {class} across the faces of its box"),
    };
    format!("the lattice {what}: {condition} (errata F3)")
}

/// Derivatives of order `order` of all Bernstein polynomials of `points` points at `t = 0` or 1: finite differences of
/// the unit vectors. Empty for an order above the degree.
pub(crate) fn end_derivatives(points: usize, order: usize, end: bool) -> Vec<f64> {
    if order >= points {
        return Vec::new();
    }
    // At t = 0: d!/(d−k)! Σ_j (−1)^(k−j) C(k,j) on coefficient j; at 1 mirrored.
    let mut row = vec![0.0; points];
    let mut binomial = 1.0;
    #[allow(clippy::cast_precision_loss)]
    for (j, entry) in row.iter_mut().enumerate().take(order + 1) {
        *entry = if (order - j).is_multiple_of(2) {
            binomial
        } else {
            -binomial
        };
        binomial = binomial * (order - j) as f64 / (j + 1) as f64;
    }
    if end {
        row.reverse();
    }
    row
}

impl<S: Space> Warp<S> for BernsteinLattice<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        let Some(local) = self.grid.local(site.point) else {
            return;
        };
        let basis = self.basis(local, None);
        for flat in 0..self.grid.len() {
            let [i, j, k] = self.grid.triple(flat);
            let weight = basis[0][i] * basis[1][j] * basis[2][k];
            if weight != 0.0 {
                out.push(
                    Address::of(u32::try_from(flat).unwrap_or(u32::MAX)),
                    1.0,
                    weight,
                );
            }
        }
    }
    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        let displacement = self
            .displacements
            .get(address.feature as usize)
            .copied()
            .unwrap_or(S::ZERO);
        Affine::translation(displacement * strength)
    }
    fn conditions(&self) -> Vec<Condition<S>> {
        moved_points(&self.displacements, |flat| self.control_point(flat))
    }
}

/// Conditions at the control points that move.
pub(crate) fn moved_points<S: Space>(
    displacements: &[S],
    place: impl Fn(usize) -> S,
) -> Vec<Condition<S>> {
    let moved = displacements
        .iter()
        .enumerate()
        .filter(|(_, d)| **d != S::ZERO);
    moved
        .map(|(flat, &d)| {
            let source = place(flat);
            Condition {
                feature: u32::try_from(flat).unwrap_or(u32::MAX),
                source,
                target: source + d,
            }
        })
        .collect()
}

/// All Bernstein polynomials of degree `n − 1` at eight parameters by the triangular scheme, which has no cancellation
/// inside [0, 1].
#[inline(always)]
fn bernstein_block<V: Simd, const N: usize>(v: V, t: f64x8<V>, n: usize) -> [f64x8<V>; N] {
    let mut b = [simd::splat(v, 0.0); N];
    b[0] = simd::splat(v, 1.0);
    let u = b[0] - t;
    for degree in 1..n {
        let mut carry = simd::splat(v, 0.0);
        for value in b.iter_mut().take(degree) {
            let old = *value;
            *value = carry + u * old;
            carry = t * old;
        }
        b[degree] = carry;
    }
    b
}

/// The kernel: eight points at a time, contracting the last axis first. 400 to 500 operations a point for 4×4×4.
#[inline(always)]
fn kernel<V: Simd, S: Space, const N: usize>(
    v: V,
    lattice: &BernsteinLattice<S>,
    shape: [usize; 3],
    points: &mut [S],
) {
    let mut blocks = simd::Blocks::new(points);
    while let Some(block) = blocks.next() {
        eight::<V, S, N>(v, lattice, shape, block);
    }
    blocks.finish();
}

/// One block of the kernel. Loops and no closures: what is not inlined loses the vector instructions.
#[inline(always)]
fn eight<V: Simd, S: Space, const N: usize>(
    v: V,
    lattice: &BernsteinLattice<S>,
    shape: [usize; 3],
    points: &mut [S; simd::LANES],
) {
    let rows = lattice.flat.as_slice();
    let block = simd::read_block(v, points);
    let (t, inside) = lattice.grid.local_block(v, &block);
    if !inside.any_true() {
        return;
    }
    let b0 = bernstein_block::<V, N>(v, t[0], shape[0]);
    let b1 = bernstein_block::<V, N>(v, t[1], shape[1]);
    let b2 = bernstein_block::<V, N>(v, t[2], shape[2]);
    let zero = simd::splat(v, 0.0);
    let mut sum = [zero; 3];
    for i in 0..shape[0] {
        let mut plane = [zero; 3];
        for j in 0..shape[1] {
            let row = &rows[(i * shape[1] + j) * shape[2]..][..shape[2]];
            let mut line = [zero; 3];
            for c in 0..S::DIM {
                line[c] = simd::splat(v, row[0][c]) * b2[0];
            }
            for k in 1..shape[2] {
                for c in 0..S::DIM {
                    line[c] += simd::splat(v, row[k][c]) * b2[k];
                }
            }
            for c in 0..S::DIM {
                plane[c] += line[c] * b1[j];
            }
        }
        for c in 0..S::DIM {
            sum[c] += plane[c] * b0[i];
        }
    }
    for by in &mut sum {
        *by = inside.select(*by, zero);
    }
    simd::write_block(simd::moved_by::<V, S>(v, &block, &sum), points);
}
