//! The energy of a frame, its gradient and its Hessian.
//!
//! Computes `W = ½ ∫ (ε′ − ε)ᵀ D (ε′ − ε) dΩ`, eq. (4), with `D = diag(1, 1, s)`: `s = ½` is the norm of the tensor, which no rotation of the
//! axes changes, since `γ = 2ε_xy`; `s = 1` is as printed. Its gradient is `Σ ∫ Bᵀ D (ε′ − ε)` and its Hessian `Σ ∫ Bᵀ D B + Gᵀ Ŝ G`, eqs. (9) and
//! (10), where `Ŝ` has the strain's difference in its blocks, `s (γ′ − γ)` beside the diagonal. Both are sums over points, of derivatives by the
//! columns of `F`, in the order of the elements. Where the Hessian is to be positive, it is made so at each point.
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004, eqs. (4) to (10); errata S4, S5 and S11. The
//! barrier: M. Li et al., *Incremental Potential Contact*, 2020, eq. (6), of determinants in place of distances.

use super::cells::{Cells, Points};
use super::tensor::{Strain, cross};
use anamorph_core::glam::{DMat2, DVec2};

/// What a point contributes, by the columns `(F_x, F_y)` of the gradient there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Local {
    pub(crate) energy: f64,
    /// Derivatives by the columns.
    pub(crate) first: [DVec2; 2],
    /// Second derivatives, by the columns one behind the other.
    pub(crate) second: [[f64; 4]; 4],
}

/// How much the derivatives are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Curvature {
    /// As they are.
    True,
    /// Without the parts that are negative.
    Positive,
    /// Without `Ŝ`, which is positive and true where the strains are those wanted.
    Smooth,
}

/// Something that is summed over points.
pub(crate) trait Term {
    fn energy(&self, point: usize, gradient: DMat2) -> f64;
    fn first(&self, point: usize, gradient: DMat2) -> [DVec2; 2];
    fn local(&self, point: usize, gradient: DMat2, curvature: Curvature) -> Option<Local>;
}

/// The difference of strains from those wanted at the points.
#[derive(Clone, Copy)]
pub(crate) struct StrainTerm<'a> {
    pub(crate) wanted: &'a [Strain],
    pub(crate) shear: f64,
}

impl StrainTerm<'_> {
    #[inline]
    fn off(&self, point: usize, gradient: DMat2) -> (f64, f64, f64) {
        let (found, wanted) = (Strain::of(gradient), self.wanted[point]);
        (
            found.x - wanted.x,
            found.y - wanted.y,
            found.shear - wanted.shear,
        )
    }
}

impl Term for StrainTerm<'_> {
    #[inline]
    fn energy(&self, point: usize, gradient: DMat2) -> f64 {
        let (x, y, shear) = self.off(point, gradient);
        0.5 * (x * x + y * y + self.shear * shear * shear)
    }

    #[inline]
    fn first(&self, point: usize, gradient: DMat2) -> [DVec2; 2] {
        let (x, y, shear) = self.off(point, gradient);
        let (fx, fy, shear) = (gradient.x_axis, gradient.y_axis, self.shear * shear);
        [fx * x + fy * shear, fy * y + fx * shear]
    }

    #[inline]
    fn local(&self, point: usize, gradient: DMat2, curvature: Curvature) -> Option<Local> {
        let (x, y, shear) = self.off(point, gradient);
        let (fx, fy, s) = (gradient.x_axis, gradient.y_axis, self.shear);
        let mixed = s * shear;
        let first = [fx * x + fy * mixed, fy * y + fx * mixed];
        let energy = 0.5 * (x * x + y * y + s * shear * shear);
        let xx = [
            fx.x * fx.x + s * fy.x * fy.x,
            fx.x * fx.y + s * fy.x * fy.y,
            fx.y * fx.y + s * fy.y * fy.y,
        ];
        let yy = [
            fy.x * fy.x + s * fx.x * fx.x,
            fy.x * fy.y + s * fx.x * fx.y,
            fy.y * fy.y + s * fx.y * fx.y,
        ];
        // Rows by x, columns by y.
        let xy = [
            [s * fy.x * fx.x, s * fy.x * fx.y],
            [s * fy.y * fx.x, s * fy.y * fx.y],
        ];
        // Ŝ, the part that may be negative.
        let (x, y, mixed) = match curvature {
            Curvature::Smooth => (0.0, 0.0, 0.0),
            Curvature::True | Curvature::Positive => (x, y, mixed),
        };
        let mut second = [
            [xx[0] + x, xx[1], xy[0][0] + mixed, xy[0][1]],
            [xx[1], xx[2] + x, xy[1][0], xy[1][1] + mixed],
            [xy[0][0] + mixed, xy[1][0], yy[0] + y, yy[1]],
            [xy[0][1], xy[1][1] + mixed, yy[1], yy[2] + y],
        ];
        if curvature == Curvature::Positive {
            make_positive(&mut second);
        }
        Some(Local {
            energy,
            first,
            second,
        })
    }
}

/// `−κ (1 − r)² ln r` of the determinant's ratio `r` to a threshold, nothing above it: keeps elements from vanishing. `κ` is that of each point.
#[derive(Clone, Copy)]
pub(crate) struct BarrierTerm<'a> {
    pub(crate) thresholds: &'a [f64],
    pub(crate) stiffness: &'a [f64],
}

impl BarrierTerm<'_> {
    /// The barrier and its derivatives by the determinant.
    fn values(&self, point: usize, determinant: f64) -> Option<[f64; 3]> {
        let threshold = self.thresholds[point];
        let ratio = determinant / threshold;
        if ratio >= 1.0 {
            return None;
        }
        if ratio <= 0.0 {
            return Some([f64::INFINITY, 0.0, 0.0]);
        }
        let (rest, log) = (1.0 - ratio, anamorph_core::math::ln(ratio));
        let k = self.stiffness[point];
        Some([
            -k * rest * rest * log,
            k * (2.0 * rest * log - rest * rest / ratio) / threshold,
            k * (-2.0 * log + 4.0 * rest / ratio + rest * rest / (ratio * ratio))
                / (threshold * threshold),
        ])
    }
}

impl Term for BarrierTerm<'_> {
    fn energy(&self, point: usize, gradient: DMat2) -> f64 {
        let values = self.values(point, cross(gradient.x_axis, gradient.y_axis));
        values.map_or(0.0, |[energy, ..]| energy)
    }

    fn first(&self, point: usize, gradient: DMat2) -> [DVec2; 2] {
        let (fx, fy) = (gradient.x_axis, gradient.y_axis);
        let slope = self.values(point, cross(fx, fy)).map_or(0.0, |v| v[1]);
        [-fy.perp() * slope, fx.perp() * slope]
    }

    fn local(&self, point: usize, gradient: DMat2, curvature: Curvature) -> Option<Local> {
        let (fx, fy) = (gradient.x_axis, gradient.y_axis);
        let [energy, slope, bend] = self.values(point, cross(fx, fy))?;
        // Derivatives of F_x × F_y.
        let (by_x, by_y) = (-fy.perp(), fx.perp());
        let by = [by_x.x, by_x.y, by_y.x, by_y.y];
        let mut second = [[0.0; 4]; 4];
        for (row, a) in second.iter_mut().zip(by) {
            for (entry, b) in row.iter_mut().zip(by) {
                *entry = bend * a * b;
            }
        }
        if curvature == Curvature::True {
            second[0][3] += slope;
            second[3][0] += slope;
            second[1][2] -= slope;
            second[2][1] -= slope;
        }
        Some(Local {
            energy,
            first: [by_x * slope, by_y * slope],
            second,
        })
    }
}

/// Whether all pivots are positive.
#[allow(clippy::needless_range_loop)]
fn is_positive(matrix: &[[f64; 4]; 4]) -> bool {
    let mut m = *matrix;
    for k in 0..4 {
        if m[k][k] <= 0.0 {
            return false;
        }
        for i in k + 1..4 {
            let factor = m[i][k] / m[k][k];
            for j in k + 1..=i {
                m[i][j] -= factor * m[j][k];
            }
        }
    }
    true
}

/// The nearest matrix without negative principal values, by Jacobi's rotations.
#[allow(clippy::needless_range_loop)]
pub(crate) fn make_positive(matrix: &mut [[f64; 4]; 4]) {
    if is_positive(matrix) {
        return;
    }
    let mut m = *matrix;
    let mut axes = [[0.0; 4]; 4];
    for (k, axis) in axes.iter_mut().enumerate() {
        axis[k] = 1.0;
    }
    for _ in 0..12 {
        let mut off = 0.0;
        let mut on = 0.0;
        for (i, row) in m.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                *if i == j { &mut on } else { &mut off } += entry * entry;
            }
        }
        if off <= 1e-30 * on {
            break;
        }
        for p in 0..3 {
            for q in p + 1..4 {
                if m[p][q] == 0.0 {
                    continue;
                }
                let theta = 0.5 * (m[q][q] - m[p][p]) / m[p][q];
                let sign = if theta < 0.0 { -1.0 } else { 1.0 };
                let tan = sign / (theta.abs() + (theta * theta + 1.0).sqrt());
                let cos = 1.0 / (tan * tan + 1.0).sqrt();
                let sin = tan * cos;
                for row in &mut m {
                    (row[p], row[q]) = (cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]);
                }
                for column in 0..4 {
                    let (a, b) = (m[p][column], m[q][column]);
                    m[p][column] = cos * a - sin * b;
                    m[q][column] = sin * a + cos * b;
                }
                for axis in &mut axes {
                    (axis[p], axis[q]) =
                        (cos * axis[p] - sin * axis[q], sin * axis[p] + cos * axis[q]);
                }
            }
        }
    }
    for i in 0..4 {
        for j in 0..4 {
            matrix[i][j] = (0..4)
                .map(|k| axes[i][k] * m[k][k].max(0.0) * axes[j][k])
                .sum();
        }
    }
}

/// Where the derivatives go.
pub(crate) struct Sums<'a> {
    pub(crate) energy: f64,
    /// By the places of the vertices.
    pub(crate) gradient: &'a mut [DVec2],
    /// The values of the matrix, and one behind them for what is held fast.
    pub(crate) values: &'a mut [f64],
}

impl<'a> Sums<'a> {
    /// Nothing added up yet.
    pub(crate) fn cleared(gradient: &'a mut [DVec2], values: &'a mut [f64]) -> Self {
        gradient.fill(DVec2::ZERO);
        values.fill(0.0);
        Self {
            energy: 0.0,
            gradient,
            values,
        }
    }
}

/// Four entries for each pair of vertices of an element, the later first.
pub(crate) const fn stride(vertices: usize) -> usize {
    2 * vertices * (vertices + 1)
}

impl<const K: usize> Cells<K> {
    fn energy(&self, term: &impl Term, first: usize, positions: &[DVec2]) -> f64 {
        let mut sum = 0.0;
        for (cell, nodes) in self.nodes.iter().enumerate() {
            for point in cell * self.per..(cell + 1) * self.per {
                let gradient = self.gradient(nodes, point, positions);
                sum += self.weights[point] * term.energy(first + point, gradient);
            }
        }
        sum
    }

    fn gradient_sum(&self, term: &impl Term, first: usize, positions: &[DVec2], sum: &mut [DVec2]) {
        for (cell, nodes) in self.nodes.iter().enumerate() {
            for point in cell * self.per..(cell + 1) * self.per {
                let gradient = self.gradient(nodes, point, positions);
                let by = term.first(first + point, gradient);
                let weight = self.weights[point];
                for (g, &node) in self.gradients[point].iter().zip(nodes) {
                    sum[node as usize] += (by[0] * g.x + by[1] * g.y) * weight;
                }
            }
        }
    }

    fn assemble(
        &self,
        term: &impl Term,
        first: usize,
        positions: &[DVec2],
        curvature: Curvature,
        places: &[u32],
        sums: &mut Sums<'_>,
    ) {
        for ((cell, nodes), places) in self
            .nodes
            .iter()
            .enumerate()
            .zip(places.chunks_exact(stride(K)))
        {
            for point in cell * self.per..(cell + 1) * self.per {
                let gradient = self.gradient(nodes, point, positions);
                let Some(local) = term.local(first + point, gradient, curvature) else {
                    continue;
                };
                let (weight, gradients) = (self.weights[point], &self.gradients[point]);
                sums.energy += weight * local.energy;
                let h = &local.second;
                let mut place = places.chunks_exact(4);
                for (k, (&node, gk)) in nodes.iter().zip(gradients).enumerate() {
                    let by = local.first[0] * gk.x + local.first[1] * gk.y;
                    sums.gradient[node as usize] += by * weight;
                    // Rows of vertex k against all columns of F.
                    let (a, b) = (gk.x * weight, gk.y * weight);
                    let row = [0, 1].map(|i| [0, 1, 2, 3].map(|j| a * h[i][j] + b * h[i + 2][j]));
                    for (gl, place) in gradients[..=k].iter().zip(&mut place) {
                        for i in 0..2 {
                            for j in 0..2 {
                                let entry = row[i][j] * gl.x + row[i][j + 2] * gl.y;
                                sums.values[place[2 * i + j] as usize] += entry;
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Where the entries of elements go in the list of values.
#[derive(Debug, Clone, Default)]
pub(crate) struct Places {
    pub(crate) triangles: Vec<u32>,
    pub(crate) quadrilaterals: Vec<u32>,
}

impl Points {
    /// The sum of a term.
    pub(crate) fn energy(&self, term: &impl Term, positions: &[DVec2]) -> f64 {
        let first = self.triangles.len();
        self.triangles.energy(term, 0, positions)
            + self.quadrilaterals.energy(term, first, positions)
    }

    /// Adds the derivatives of a term by the places of the vertices.
    pub(crate) fn gradient(&self, term: &impl Term, positions: &[DVec2], sum: &mut [DVec2]) {
        let first = self.triangles.len();
        self.triangles.gradient_sum(term, 0, positions, sum);
        self.quadrilaterals
            .gradient_sum(term, first, positions, sum);
    }

    /// Adds the derivatives of a term, and their derivatives.
    pub(crate) fn assemble(
        &self,
        term: &impl Term,
        positions: &[DVec2],
        curvature: Curvature,
        places: &Places,
        sums: &mut Sums<'_>,
    ) {
        let first = self.triangles.len();
        self.triangles
            .assemble(term, 0, positions, curvature, &places.triangles, sums);
        self.quadrilaterals.assemble(
            term,
            first,
            positions,
            curvature,
            &places.quadrilaterals,
            sums,
        );
    }
}

#[cfg(test)]
#[allow(clippy::needless_range_loop)]
mod tests {
    use super::*;

    #[test]
    fn negative_principal_values_are_taken_away_and_nothing_else() {
        let mut matrix = [
            [2.0, -1.0, 0.3, 0.9],
            [-1.0, -0.5, 0.2, 1.1],
            [0.3, 0.2, 1.0, -2.0],
            [0.9, 1.1, -2.0, 0.4],
        ];
        let before = matrix;
        make_positive(&mut matrix);
        let mut shifted = matrix;
        for k in 0..4 {
            shifted[k][k] += 1e-12;
        }
        assert!(is_positive(&shifted));
        // What was taken away is negative, and stands at right angles to what is left.
        for i in 0..4 {
            for j in 0..4 {
                let product: f64 = (0..4)
                    .map(|k| matrix[i][k] * (matrix[k][j] - before[k][j]))
                    .sum();
                assert!(product.abs() < 1e-13);
                assert!((matrix[i][j] - matrix[j][i]).abs() < 1e-14);
            }
        }
        let positive = [
            [3.0, 1.0, 0.0, 0.5],
            [1.0, 2.0, 0.2, 0.0],
            [0.0, 0.2, 1.0, 0.1],
            [0.5, 0.0, 0.1, 4.0],
        ];
        let mut kept = positive;
        make_positive(&mut kept);
        assert_eq!(kept, positive);
    }

    /// Derivatives of terms against differences.
    #[test]
    fn derivatives_by_the_columns_are_those_of_differences() {
        let wanted = [Strain {
            x: 0.2,
            y: -0.3,
            shear: 0.4,
        }];
        let strain = StrainTerm {
            wanted: &wanted,
            shear: 0.5,
        };
        let barrier = BarrierTerm {
            thresholds: &[1.5],
            stiffness: &[0.3],
        };
        let f = [0.8, 0.3, -0.4, 0.9];
        check(&strain, f);
        check(&barrier, f);
    }

    fn check(term: &impl Term, f: [f64; 4]) {
        let at = |f: [f64; 4]| DMat2::from_cols_array(&f);
        let step = 1e-5;
        let local = term.local(0, at(f), Curvature::True).unwrap();
        assert!((local.energy - term.energy(0, at(f))).abs() < 1e-15);
        assert_eq!(local.first, term.first(0, at(f)));
        for k in 0..4 {
            let (mut less, mut more) = (f, f);
            less[k] -= step;
            more[k] += step;
            let slope = (term.energy(0, at(more)) - term.energy(0, at(less))) / (2.0 * step);
            let found = local.first[k / 2][k % 2];
            assert!((slope - found).abs() < 1e-8, "{slope} {found}");
            let (less, more) = (term.first(0, at(less)), term.first(0, at(more)));
            for j in 0..4 {
                let bend = (more[j / 2][j % 2] - less[j / 2][j % 2]) / (2.0 * step);
                let found = local.second[j][k];
                assert!((bend - found).abs() < 1e-7, "{bend} {found}");
            }
        }
    }
}
