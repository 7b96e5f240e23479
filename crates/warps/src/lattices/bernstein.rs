//! Free-form deformation with Bernstein polynomials (FFD).
//!
//! Computes `p̃ = p + Σ_ijk B_i(s) B_j(t) B_k(u) (P*_ijk − P_ijk)` for points with local coordinates `(s, t, u)` in the
//! closed lattice box; a point outside is left where it is.
//!
//! *Source*: T. W. Sederberg and S. R. Parry, *Free-Form Deformation of Solid Geometric Models*, SIGGRAPH 1986; cast as
//! in Milliron et al. 2002, §4.1. Errata F1 (index of the Bernstein polynomial), F2 (`T = P* − P`), F3 (outside the box;
//! continuity across its faces).

use super::grid::{face_smoothness, one};
use super::{Grid, LatticeError, PointLattice, points};
use anamorph_core::simd::{self, Level, Simd, dispatch, f64x8, prelude::*};
use anamorph_core::{
    Address, Affine, Condition, Deformation, Facts, Influences, Linear, Site, Smoothness, Space,
    Unmapped, Warp,
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
    /// The coefficients of the kernel, three numbers a point: see [`differences`].
    coefficients: Vec<[f64; 3]>,
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
        let mut lattice = Self {
            coefficients: differences(&displacements, grid.shape()),
            grid,
            displacements,
            facts: Facts::identity(),
        };
        lattice.facts = lattice.derive_facts();
        Ok(lattice)
    }

    /// Bernstein values along each axis at a local point.
    fn basis(&self, local: S) -> [Vec<f64>; 3] {
        core::array::from_fn(|axis| {
            let mut values = vec![1.0; self.grid.shape()[axis]];
            if axis < S::DIM {
                basis::bernstein::values(local.component(axis), &mut values);
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
        let moves = |flat: usize| {
            let d = self.displacements[flat];
            (0..3).map(|axis| d.component(axis)).collect()
        };
        let edge = face_smoothness(&self.grid, Smoothness::Smooth, scale, derivative, &moves);
        let note = lattice_note(
            edge,
            "the outer k + 1 planes of control points must stay for C^k",
        );
        // A derivative is a Bernstein polynomial of the differences of neighbours, times the degree: an average of them.
        let by_local = core::array::from_fn(|axis| {
            if axis >= S::DIM {
                return 0.0;
            }
            #[allow(clippy::cast_precision_loss)]
            let spacing = 1.0 / (self.grid.shape()[axis].max(2) - 1) as f64;
            self.grid
                .steepest(axis, |flat| self.displacements[flat], |_| spacing)
        });
        Facts {
            support: self.grid.support(),
            edge,
            stretch: Some(self.grid.stretch(by_local)),
            ..Facts::identity()
        }
        .with_note(note)
    }

    /// Derivatives of the displacement by the local coordinates: contracted axis by axis, values and derivatives together.
    fn local_derivatives(&self, local: S) -> [S; 3] {
        let mut values = [[1.0; MOST_POINTS]; 3];
        let mut slopes = [[0.0; MOST_POINTS]; 3];
        let shape = self.grid.shape();
        for axis in 0..S::DIM {
            let t = local.component(axis);
            basis::bernstein::values(t, &mut values[axis][..shape[axis]]);
            basis::bernstein::derivatives(t, &mut slopes[axis][..shape[axis]]);
        }
        let mut sums = [S::ZERO; 3];
        let mut rows = self.displacements.chunks_exact(shape[2]);
        for i in 0..shape[0] {
            let mut planes = [S::ZERO; 3];
            for (j, row) in rows.by_ref().take(shape[1]).enumerate() {
                let (mut line, mut slope) = (S::ZERO, S::ZERO);
                for (k, &d) in row.iter().enumerate() {
                    line += d * values[2][k];
                    slope += d * slopes[2][k];
                }
                planes[0] += line * values[1][j];
                planes[1] += line * slopes[1][j];
                planes[2] += slope * values[1][j];
            }
            sums[0] += planes[0] * slopes[0][i];
            sums[1] += planes[1] * values[0][i];
            sums[2] += planes[2] * values[0][i];
        }
        sums
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

    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        let level = Level::new();
        // The usual sizes get code of their own, whose loops the compiler unrolls.
        match self.grid.shape() {
            [4, 4, 4] => {
                dispatch!(level, v => kernel::<_, S, 4>(v, self, [4, 4, 4], first, points))
            }
            [3, 3, 3] => {
                dispatch!(level, v => kernel::<_, S, 3>(v, self, [3, 3, 3], first, points))
            }
            [2, 2, 2] => {
                dispatch!(level, v => kernel::<_, S, 2>(v, self, [2, 2, 2], first, points))
            }
            shape if shape.iter().all(|&n| n <= 8) => {
                dispatch!(level, v => kernel::<_, S, 8>(v, self, shape, first, points))
            }
            shape => {
                dispatch!(level, v => kernel::<_, S, MOST_POINTS>(v, self, shape, first, points))
            }
        }
    }

    fn keeps_finite(&self) -> bool {
        true
    }

    fn jacobian(&self, site: &Site<S>, _: f64) -> Option<S::Linear> {
        let Some(local) = self.grid.local(site.point) else {
            return Some(S::Linear::IDENTITY);
        };
        let gradients = self.grid.local_gradients();
        let along = self.local_derivatives(local);
        let mut jacobian = S::Linear::IDENTITY;
        for (axis, along) in along.into_iter().enumerate().take(S::DIM) {
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

impl<S: Space> PointLattice<S> for BernsteinLattice<S> {
    fn grid(&self) -> &Grid<S> {
        &self.grid
    }
    fn displacements(&self) -> &[S] {
        &self.displacements
    }
    fn control_point(&self, flat: usize) -> S {
        control_point(&self.grid, flat)
    }
}

impl<S: Space> Warp<S> for BernsteinLattice<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        let Some(local) = self.grid.local(site.point) else {
            return;
        };
        let basis = self.basis(local);
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
        points::scaled(self, address, strength)
    }
    fn conditions(&self) -> Vec<Condition<S>> {
        points::conditions(self)
    }
}

/// Displacements as the kernel sums them. The Bernstein polynomials along an axis add up to one, so
/// `Σ_i B_i c_i = c_0 + Σ_{i≥1} B_i (c_i − c_0)`, which saves a quarter of the work; the differences are taken along each
/// axis in turn. A face whose control points stay still is still exactly: there all that is left is `c_0 − c_0`.
fn differences<S: Space>(displacements: &[S], shape: [usize; 3]) -> Vec<[f64; 3]> {
    let mut all: Vec<[f64; 3]> = displacements
        .iter()
        .map(|d| core::array::from_fn(|axis| d.component(axis)))
        .collect();
    let steps = [shape[1] * shape[2], shape[2], 1];
    for (points, step) in shape.into_iter().zip(steps) {
        for flat in 0..all.len() {
            let along = flat / step % points;
            if along == 0 {
                let first = all[flat];
                for other in 1..points {
                    let [x, y, z] = all[flat + other * step];
                    all[flat + other * step] = [x - first[0], y - first[1], z - first[2]];
                }
            }
        }
    }
    all
}

/// The Bernstein polynomials of degree `n − 1` at eight parameters, of which the kernel does not read the first. By
/// the triangular scheme, which has no cancellation inside [0, 1]; the cubic ones by their formula.
#[inline(always)]
fn bernstein_block<V: Simd, const N: usize>(v: V, t: f64x8<V>, n: usize) -> [f64x8<V>; N] {
    let one = simd::splat(v, 1.0);
    let u = one - t;
    let mut b = [simd::splat(v, 0.0); N];
    if N == 4 && n == 4 {
        let three = t * simd::splat(v, 3.0);
        b[1] = three * (u * u);
        b[2] = (three * t) * u;
        b[3] = (t * t) * t;
        return b;
    }
    b[0] = one;
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
    first: usize,
    points: &mut [S],
) -> Unmapped {
    let mut unmapped = Unmapped::none();
    let (mut index, end) = (first, first + points.len());
    let mut blocks = simd::Blocks::new(points);
    while let Some(block) = blocks.next() {
        let lost = eight::<V, S, N>(v, lattice, shape, block);
        if lost != 0 {
            unmapped.push_lanes(index, lost, end);
        }
        index += simd::LANES;
    }
    blocks.finish();
    unmapped
}

/// One block of the kernel. Loops and no closures: what is not inlined loses the vector instructions.
#[inline(always)]
fn eight<V: Simd, S: Space, const N: usize>(
    v: V,
    lattice: &BernsteinLattice<S>,
    shape: [usize; 3],
    points: &mut [S; simd::LANES],
) -> u8 {
    // Cut once, so that the compiler need not check the rows one by one.
    let rows = &lattice.coefficients[..shape[0] * shape[1] * shape[2]];
    let block = simd::read_block(v, points);
    let (t, inside) = lattice.grid.local_block(v, &block);
    if !inside.any_true() {
        return simd::not_finite::<V, S>(v, &block);
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
                line[c] = simd::splat(v, row[0][c]);
            }
            for k in 1..shape[2] {
                for c in 0..S::DIM {
                    line[c] += simd::splat(v, row[k][c]) * b2[k];
                }
            }
            for c in 0..S::DIM {
                plane[c] = if j == 0 {
                    line[c]
                } else {
                    plane[c] + line[c] * b1[j]
                };
            }
        }
        for c in 0..S::DIM {
            sum[c] = if i == 0 {
                plane[c]
            } else {
                sum[c] + plane[c] * b0[i]
            };
        }
    }
    for by in &mut sum {
        *by = inside.select(*by, zero);
    }
    simd::settle::<V, S>(v, &block, &sum, points)
}
