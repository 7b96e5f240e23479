//! Free-form deformation with B-splines: lattices with local control.
//!
//! Computes `p̃ = p + Σ_ijk N_i(s) N_j(t) N_k(u) (P*_ijk − P_ijk)` for points in the closed lattice box, with B-spline
//! bases of a chosen degree. Moving one control point changes only points inside its knot spans.
//!
//! *Source*: J. Griessmair and W. Purgathofer, *Deformation of Solids with Trivariate B-Splines*, Eurographics 1989; cast
//! as in Milliron et al. 2002, §4.1. Errata F20: the box is the knot domain, and control points stand at the Greville
//! abscissae, so that affine edits of them are reproduced; with uniform knots (the default) that puts one ring outside
//! the box for degrees 2 and 3. Errata F3: outside the box nothing moves.

use super::bernstein::lattice_note;
use super::grid::{face_smoothness, one};
use super::{Grid, LatticeError, PointLattice, points};
use anamorph_core::simd::fearless_simd::{f64x4, prelude::*};
use anamorph_core::simd::{Level, Simd, dispatch};
use anamorph_core::{
    Address, Affine, Condition, Deformation, Facts, Influences, Linear, Site, Smoothness, Space,
    Unmapped, Warp,
};
use anamorph_fields::basis::KnotVector;

/// Highest degree of a lattice.
pub const HIGHEST_DEGREE: usize = 5;
/// Basis functions that are not zero at a parameter, at most.
const MOST: usize = HIGHEST_DEGREE + 1;

/// How the knots of a lattice are spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Knots {
    /// Equally spaced everywhere; outer control points lie outside the box.
    Uniform,
    /// Repeated at the faces; outer control points lie on the faces.
    Clamped,
}

/// The bases along one axis as polynomials per knot span.
#[derive(Debug, Clone, PartialEq)]
struct Spans {
    degree: usize,
    /// Left ends of the spans, and the right end of the last.
    breaks: Vec<f64>,
    /// For each span the `degree + 1` non-zero basis functions, each `degree + 1` coefficients in `t − break`, constant
    /// first.
    coefficients: Vec<[[f64; MOST]; MOST]>,
}

impl Spans {
    /// Cox–de Boor recursion on polynomials instead of numbers (C. de Boor, *A Practical Guide to Splines*, 1978).
    fn new(knots: &[f64], points: usize, degree: usize) -> Self {
        let mut spans = Self {
            degree,
            breaks: Vec::new(),
            coefficients: Vec::new(),
        };
        for span in degree..points {
            let (left, right) = (knots[span], knots[span + 1]);
            if right <= left {
                continue;
            }
            let mut basis = [[0.0; MOST]; MOST];
            basis[0][0] = 1.0;
            for p in 1..=degree {
                let mut next = [[0.0; MOST]; MOST];
                for local in 0..=p {
                    let i = span + local - p;
                    // (t − t_i)/(t_{i+p} − t_i) N_{i,p−1} + (t_{i+p+1} − t)/(t_{i+p+1} − t_{i+1}) N_{i+1,p−1}
                    if local > 0 {
                        let width = knots[i + p] - knots[i];
                        let from = basis[local - 1];
                        for power in 0..p {
                            next[local][power] += from[power] * ((left - knots[i]) / width);
                            next[local][power + 1] += from[power] / width;
                        }
                    }
                    if local < p {
                        let width = knots[i + p + 1] - knots[i + 1];
                        let from = basis[local];
                        for power in 0..p {
                            next[local][power] += from[power] * ((knots[i + p + 1] - left) / width);
                            next[local][power + 1] -= from[power] / width;
                        }
                    }
                }
                basis = next;
            }
            spans.breaks.push(left);
            spans.coefficients.push(basis);
        }
        spans.breaks.push(1.0);
        spans
    }

    /// The span of a parameter in [0, 1], which is also the index of the first control point it depends on.
    #[inline(always)]
    fn span(&self, t: f64) -> usize {
        let count = self.coefficients.len();
        #[allow(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss
        )]
        let mut span = ((t * count as f64) as usize).min(count - 1);
        // The guess is at most one off by rounding.
        if t < self.breaks[span] {
            span -= 1;
        } else if span + 1 < count && t >= self.breaks[span + 1] {
            span += 1;
        }
        span
    }

    /// Values of the non-zero basis functions in a span.
    #[inline(always)]
    fn values(&self, span: usize, t: f64) -> [f64; MOST] {
        let u = t - self.breaks[span];
        let rows = &self.coefficients[span];
        let mut values = [0.0; MOST];
        for (value, c) in values.iter_mut().zip(rows).take(self.degree + 1) {
            *value = c[self.degree];
            for power in (0..self.degree).rev() {
                *value = c[power] + u * *value;
            }
        }
        values
    }

    /// Derivatives of order `order` of the non-zero basis functions in a span.
    fn derivatives(&self, span: usize, t: f64, order: usize) -> [f64; MOST] {
        let u = t - self.breaks[span];
        let mut values = [0.0; MOST];
        for (value, c) in values
            .iter_mut()
            .zip(&self.coefficients[span])
            .take(self.degree + 1)
        {
            for power in (order..=self.degree).rev() {
                #[allow(clippy::cast_precision_loss)]
                let falling: f64 = (power - order + 1..=power).map(|n| n as f64).product();
                *value = *value * u + c[power] * falling;
            }
        }
        values
    }
}

/// A B-spline lattice and the displacements of its control points.
#[derive(Debug, Clone, PartialEq)]
pub struct BsplineLattice<S: Space> {
    grid: Grid<S>,
    degree: usize,
    greville: Vec<Vec<f64>>,
    spans: Vec<Spans>,
    displacements: Vec<S>,
    /// The same, four numbers a point, so that a control point is one vector load.
    padded: Vec<[f64; 4]>,
    facts: Facts<S>,
}

impl<S: Space> BsplineLattice<S> {
    /// The lattice on `grid` (its box is the knot domain) of the given degree, whose control point `i` (flat, last index
    /// fastest) moves by `displacements[i]`.
    ///
    /// # Errors
    /// [`LatticeError`] for a degree outside 1 to [`HIGHEST_DEGREE`], fewer than `degree + 1` points along an axis, a list
    /// of the wrong length, or a displacement that is not finite.
    pub fn construct(
        grid: Grid<S>,
        degree: usize,
        knots: Knots,
        displacements: Vec<S>,
    ) -> Result<Self, LatticeError> {
        let (mut greville, mut spans) = (Vec::new(), Vec::new());
        for (axis, &points) in grid.shape().iter().enumerate().take(S::DIM) {
            if !(1..=HIGHEST_DEGREE).contains(&degree) {
                let need = format!("the degree is {degree}, and must be 1 to {HIGHEST_DEGREE}");
                return Err(LatticeError::Shape { axis, points, need });
            }
            let vector = match knots {
                Knots::Uniform => KnotVector::uniform(points, degree),
                Knots::Clamped => KnotVector::clamped(points, degree),
            };
            let need = || format!("a lattice of degree {degree} takes at least {}", degree + 1);
            let vector = vector.map_err(|_| LatticeError::Shape {
                axis,
                points,
                need: need(),
            })?;
            greville.push(vector.greville());
            spans.push(Spans::new(vector.knots(), points, degree));
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
        let padded = displacements
            .iter()
            .map(|d| core::array::from_fn(|axis| d.component(axis)))
            .collect();
        let mut lattice = Self {
            grid,
            degree,
            greville,
            spans,
            displacements,
            padded,
            facts: Facts::identity(),
        };
        lattice.facts = lattice.derive_facts();
        Ok(lattice)
    }

    fn derive_facts(&self) -> Facts<S> {
        let scale = self
            .displacements
            .iter()
            .fold(0.0_f64, |m, d| m.max(d.largest()));
        if scale == 0.0 {
            return Facts::identity();
        }
        #[allow(clippy::cast_possible_truncation)]
        let inside = if self
            .grid
            .shape()
            .iter()
            .take(S::DIM)
            .all(|&n| n == self.degree + 1)
        {
            // A single span: one polynomial.
            Smoothness::Smooth
        } else {
            Smoothness::C(self.degree as u8 - 1)
        };
        let derivative = |axis: usize, order: u8, end: bool| {
            let order = usize::from(order);
            if order > self.degree {
                return Vec::new();
            }
            let spans = &self.spans[axis];
            let (span, t) = if end {
                (spans.coefficients.len() - 1, 1.0)
            } else {
                (0, 0.0)
            };
            let mut row = vec![0.0; self.grid.shape()[axis]];
            row[span..=span + self.degree]
                .copy_from_slice(&spans.derivatives(span, t, order)[..=self.degree]);
            row
        };
        let moves = |flat: usize| self.padded[flat][..S::DIM].to_vec();
        let edge = face_smoothness(&self.grid, inside, scale, derivative, &moves);
        let note = lattice_note(edge, "the control points that reach a face must stay");
        // The derivative of a spline is a spline of the divided differences at Greville's abscissae: an average of them.
        let by_local = core::array::from_fn(|axis| {
            if axis >= S::DIM {
                return 0.0;
            }
            let greville = &self.greville[axis];
            let spacing = |index: usize| greville[index + 1] - greville[index];
            self.grid
                .steepest(axis, |flat| self.displacements[flat], spacing)
        });
        let upright = self.small_moves();
        let one_to_one = upright.clone().filter(|_| edge > Smoothness::Jump);
        Facts {
            support: self.grid.support(),
            inside,
            edge,
            stretch: Some(self.grid.stretch(by_local)),
            upright,
            one_to_one,
            ..Facts::identity()
        }
        .with_note(note)
    }

    /// The sufficient condition of Choi and Lee (2000) for cubic B-splines with uniform knots: along each edge of the lattice, control
    /// points move less than about 0.48 of their distance in the plane, 0.40 in space.
    fn small_moves(&self) -> Option<String> {
        const PLANE: f64 = 1.0 / 2.046_392_675;
        const SPACE: f64 = 1.0 / 2.479_472_335;
        let limit = if S::DIM == 2 { PLANE } else { SPACE };
        let gradients = self.grid.local_gradients();
        if self.degree != 3 {
            return None;
        }
        for axis in 0..S::DIM {
            let greville = &self.greville[axis];
            let spacing = greville[1] - greville[0];
            // Uniform knots put a ring of control points outside of the box. A clamped lattice of a single span has evenly spaced
            // points, too, but Bernstein's polynomials, of which the theorem says nothing.
            let uniform = (greville[0] + spacing).abs() <= 1e-9 * spacing
                && greville
                    .windows(2)
                    .all(|w| (w[1] - w[0] - spacing).abs() <= 1e-9 * spacing);
            let along = |d: &S| gradients.column(axis).dot(*d).abs();
            let farthest = self.displacements.iter().map(along).fold(0.0, f64::max);
            if !uniform || farthest >= limit * spacing {
                return None;
            }
        }
        Some(format!(
            "every control point moves less than {limit:.3} of the lattice's spacing along each edge (Choi and Lee 2000)"
        ))
    }

    /// First control point and basis values along each axis; one value of 1 for an axis the space lacks.
    #[inline(always)]
    fn at(&self, local: S) -> ([usize; 3], [[f64; MOST]; 3]) {
        let mut first = [0; 3];
        let mut values = [[1.0; MOST]; 3];
        for axis in 0..S::DIM {
            let t = local.component(axis);
            first[axis] = self.spans[axis].span(t);
            values[axis] = self.spans[axis].values(first[axis], t);
        }
        (first, values)
    }

    /// Calls with the flat index and the share of every control point that has one in the move of a point.
    pub(crate) fn shares(&self, p: S, mut with: impl FnMut(usize, f64)) {
        let Some(local) = self.grid.local(p) else {
            return;
        };
        let (first, values) = self.at(local);
        let reach = self.reach();
        for i in 0..reach[0] {
            for j in 0..reach[1] {
                for k in 0..reach[2] {
                    let share = values[0][i] * values[1][j] * values[2][k];
                    if share > 0.0 {
                        let flat = self.grid.flat([first[0] + i, first[1] + j, first[2] + k]);
                        with(flat, share);
                    }
                }
            }
        }
    }

    /// Number of basis functions along each axis that can differ from zero at a point.
    fn reach(&self) -> [usize; 3] {
        core::array::from_fn(|axis| if axis < S::DIM { self.degree + 1 } else { 1 })
    }
}

impl<S: Space> Deformation<S> for BsplineLattice<S> {
    fn map(&self, site: &Site<S>) -> S {
        one(site, |points| {
            self.map_points(site.index, points);
        })
    }

    fn map_points(&self, _: usize, points: &mut [S]) -> Unmapped {
        match self.degree {
            1 => dispatch!(Level::new(), v => kernel::<_, S, 2>(v, self, points)),
            2 => dispatch!(Level::new(), v => kernel::<_, S, 3>(v, self, points)),
            3 => dispatch!(Level::new(), v => kernel::<_, S, 4>(v, self, points)),
            4 => dispatch!(Level::new(), v => kernel::<_, S, 5>(v, self, points)),
            _ => dispatch!(Level::new(), v => kernel::<_, S, MOST>(v, self, points)),
        }
        Unmapped::none()
    }

    fn jacobian(&self, site: &Site<S>, _: f64) -> Option<S::Linear> {
        let Some(local) = self.grid.local(site.point) else {
            return Some(S::Linear::IDENTITY);
        };
        let (first, values) = self.at(local);
        let reach = self.reach();
        let gradients = self.grid.local_gradients();
        let mut jacobian = S::Linear::IDENTITY;
        for axis in 0..S::DIM {
            let mut basis = values;
            basis[axis] = self.spans[axis].derivatives(first[axis], local.component(axis), 1);
            let mut along = S::ZERO;
            for i in 0..reach[0] {
                for j in 0..reach[1] {
                    for k in 0..reach[2] {
                        let flat = self.grid.flat([first[0] + i, first[1] + j, first[2] + k]);
                        along +=
                            self.displacements[flat] * (basis[0][i] * basis[1][j] * basis[2][k]);
                    }
                }
            }
            jacobian = jacobian + S::Linear::outer(along, gradients.column(axis));
        }
        Some(jacobian)
    }

    fn facts(&self) -> Facts<S> {
        self.facts.clone()
    }
}

impl<S: Space> PointLattice<S> for BsplineLattice<S> {
    fn grid(&self) -> &Grid<S> {
        &self.grid
    }
    fn displacements(&self) -> &[S] {
        &self.displacements
    }
    fn control_point(&self, flat: usize) -> S {
        let triple = self.grid.triple(flat);
        self.grid
            .place(S::from_fn(|axis| self.greville[axis][triple[axis]]))
    }
}

impl<S: Space> Warp<S> for BsplineLattice<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        self.shares(site.point, |flat, weight| {
            let address = Address::of(u32::try_from(flat).unwrap_or(u32::MAX));
            out.push(address, 1.0, weight);
        });
    }
    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        points::scaled(self, address, strength)
    }
    fn conditions(&self) -> Vec<Condition<S>> {
        points::conditions(self)
    }
}

/// The kernel: point by point, the three coordinates of a control point in one vector; `N` is the degree plus one. The
/// cost does not depend on the size of the lattice but for what the caches hold.
#[inline(always)]
fn kernel<V: Simd, S: Space, const N: usize>(v: V, lattice: &BsplineLattice<S>, points: &mut [S]) {
    let shape = lattice.grid.shape();
    // In the plane the outer loop has a single pass and the two axes take the inner places.
    let solid = S::DIM == 3;
    let (stride, line_stride) = if solid {
        (shape[1] * shape[2], shape[2])
    } else {
        (0, shape[1])
    };
    let zero = f64x4::splat(v, 0.0);
    for point in points {
        let Some(local) = lattice.grid.local(*point) else {
            continue;
        };
        let mut basis = [[1.0; N]; 3];
        let mut first = [0; 3];
        for axis in 0..S::DIM {
            let place = if solid { axis } else { axis + 1 };
            let spans = &lattice.spans[axis];
            let t = local.component(axis);
            let span = spans.span(t);
            let u = t - spans.breaks[span];
            first[place] = span;
            let rows = &spans.coefficients[span];
            for n in 0..N {
                // Horner's scheme, highest power first.
                let mut value = rows[n][N - 1];
                for power in (0..N - 1).rev() {
                    value = rows[n][power] + u * value;
                }
                basis[place][n] = value;
            }
        }
        let start = first[0] * stride + first[1] * line_stride + first[2];
        let mut sum = zero;
        for i in 0..if solid { N } else { 1 } {
            let mut plane = zero;
            for j in 0..N {
                let from = start + i * stride + j * line_stride;
                let Some(row) = lattice.padded.get(from..from + N) else {
                    continue;
                };
                let mut line = zero;
                for k in 0..N {
                    line += f64x4::simd_from(v, row[k]) * f64x4::splat(v, basis[2][k]);
                }
                plane += line * f64x4::splat(v, basis[1][j]);
            }
            sum += plane * f64x4::splat(v, basis[0][i]);
        }
        let sum: [f64; 4] = sum.into();
        *point = point.moved_by(S::from_fn(|axis| sum[axis]));
    }
}
