//! A start for the search where the stitched guess has elements turned over.
//!
//! Minimizes `Σ (tr JᵀJ + λ(1 + det²J)) / χ(det J)` over all places, `J = F U⁻¹`, `F` the gradient of the map from the source and `U` the stretch
//! that is wanted there, `χ(D) = (D + √(ε² + D²))/2`. As `ε` goes to 0, an element that is turned over costs without bound. The least
//! energy has every element near a turned copy of what is wanted, and none turned over. Steps take the part of the Hessian that
//! is positive.
//!
//! *Source*: V. Garanzha, I. Kaporin, L. Kudryavtseva, F. Protais, N. Ray and D. Sokolov, *Foldover-free maps in 50 lines of code*, ACM TOG 40(4),
//! 2021 (the energy and the rule for ε). That it begins a search for strains is a decision.

use super::energy::{Curvature, Local, Term};
use super::tensor::cross;
use anamorph_core::glam::{DMat2, DVec2};

/// What the spread of areas counts beside that of angles.
const LAMBDA: f64 = 0.5;

/// The energy that turns elements back.
#[derive(Clone, Copy)]
pub(crate) struct UntangleTerm<'a> {
    /// Inverses of the stretches that are wanted.
    pub(crate) inverses: &'a [DMat2],
    /// What each point counts beside its area.
    pub(crate) shares: &'a [f64],
    pub(crate) epsilon: f64,
}

/// What the energy is made of at a point.
struct Parts {
    jacobian: DMat2,
    det: f64,
    chi: f64,
    root: f64,
    sum: f64,
}

impl UntangleTerm<'_> {
    fn parts(&self, point: usize, gradient: DMat2) -> Parts {
        let jacobian = gradient * self.inverses[point];
        let (x, y) = (jacobian.x_axis, jacobian.y_axis);
        let det = cross(x, y);
        let root = (self.epsilon * self.epsilon + det * det).sqrt();
        // Without cancellation where it is negative.
        let chi = if det > 0.0 {
            0.5 * (det + root)
        } else {
            0.5 * self.epsilon * self.epsilon / (root - det)
        };
        let sum = x.length_squared() + y.length_squared() + LAMBDA * (1.0 + det * det);
        Parts {
            jacobian,
            det,
            chi,
            root,
            sum,
        }
    }

    /// Derivatives by the columns of `J`, carried to those of `F`.
    fn carried(&self, point: usize, by: [DVec2; 2]) -> [DVec2; 2] {
        let a = self.inverses[point];
        [
            by[0] * a.x_axis.x + by[1] * a.y_axis.x,
            by[0] * a.x_axis.y + by[1] * a.y_axis.y,
        ]
    }

    /// The derivative of the sum over `χ` by the determinant.
    fn by_det(parts: &Parts) -> f64 {
        2.0 * LAMBDA * parts.det / parts.chi - parts.sum / (parts.chi * parts.root)
    }
}

/// The derivatives of `x × y` by both.
fn cofactor(jacobian: DMat2) -> [DVec2; 2] {
    [-jacobian.y_axis.perp(), jacobian.x_axis.perp()]
}

impl Term for UntangleTerm<'_> {
    fn energy(&self, point: usize, gradient: DMat2) -> f64 {
        let parts = self.parts(point, gradient);
        self.shares[point] * parts.sum / parts.chi
    }

    fn first(&self, point: usize, gradient: DMat2) -> [DVec2; 2] {
        let parts = self.parts(point, gradient);
        let share = self.shares[point];
        let (straight, by_det) = (share * 2.0 / parts.chi, share * Self::by_det(&parts));
        let turned = cofactor(parts.jacobian);
        let axes = [parts.jacobian.x_axis, parts.jacobian.y_axis];
        self.carried(
            point,
            [0, 1].map(|i| axes[i] * straight + turned[i] * by_det),
        )
    }

    /// The positive part whatever is asked for.
    fn local(&self, point: usize, gradient: DMat2, _: Curvature) -> Option<Local> {
        let parts = self.parts(point, gradient);
        let Parts {
            det,
            chi,
            root,
            sum,
            ..
        } = parts;
        let share = self.shares[point];
        let straight = share * 2.0 / chi;
        let curve = 2.0 * LAMBDA / chi - 4.0 * LAMBDA * det / (chi * root)
            + sum / (chi * root * root) * (1.0 + det / root);
        let curve = share * curve.max(0.0);
        let turned = self.carried(point, cofactor(parts.jacobian));
        let by = [turned[0].x, turned[0].y, turned[1].x, turned[1].y];
        let mut second = [[0.0; 4]; 4];
        for (row, a) in second.iter_mut().zip(by) {
            for (entry, b) in row.iter_mut().zip(by) {
                *entry = curve * a * b;
            }
        }
        // U⁻¹ U⁻ᵀ between the columns.
        let a = self.inverses[point];
        let square = a * a.transpose();
        for i in 0..2 {
            for j in 0..2 {
                let entry = straight * square.col(j)[i];
                second[2 * i][2 * j] += entry;
                second[2 * i + 1][2 * j + 1] += entry;
            }
        }
        Some(Local {
            energy: share * sum / chi,
            first: self.first(point, gradient),
            second,
        })
    }
}

/// `ε` where the least determinant is `least`.
pub(crate) fn epsilon(least: f64) -> f64 {
    if least > 0.0 {
        1e-12
    } else {
        (1e-10 + 0.04 * least * least).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_those_of_differences_and_curves_are_positive() {
        let inverses = [DMat2::from_cols_array(&[0.8, 0.2, 0.2, 1.7])];
        for epsilon in [1e-12, 0.3] {
            let term = UntangleTerm {
                inverses: &inverses,
                shares: &[0.7],
                epsilon,
            };
            for f in [[0.8, 0.3, -0.4, 0.9], [0.8, 0.3, 0.9, 0.2]] {
                if epsilon < 0.1 && DMat2::from_cols_array(&f).determinant() < 0.0 {
                    continue;
                }
                let at = |f: [f64; 4]| DMat2::from_cols_array(&f);
                let local = term.local(0, at(f), Curvature::Positive).unwrap();
                assert_eq!(local.energy, term.energy(0, at(f)));
                for k in 0..4 {
                    let (mut less, mut more) = (f, f);
                    less[k] -= 1e-6;
                    more[k] += 1e-6;
                    let slope = (term.energy(0, at(more)) - term.energy(0, at(less))) / 2e-6;
                    let found = local.first[k / 2][k % 2];
                    assert!((slope - found).abs() < 1e-6 * (1.0 + found.abs()));
                }
                let mut positive = local.second;
                super::super::energy::make_positive(&mut positive);
                for (a, b) in positive
                    .as_flattened()
                    .iter()
                    .zip(local.second.as_flattened())
                {
                    assert!((a - b).abs() < 1e-9 * local.energy.powi(2));
                }
            }
        }
    }

    #[test]
    fn nothing_is_better_than_what_is_wanted() {
        let inverses = [DMat2::from_cols_array(&[0.8, 0.2, 0.2, 1.7])];
        let term = UntangleTerm {
            inverses: &inverses,
            shares: &[0.7],
            epsilon: 1e-12,
        };
        let wanted = inverses[0].inverse();
        let turned = super::super::tensor::turn(2.0) * wanted;
        let slope = term.first(0, turned);
        assert!(slope.iter().all(|by| by.length() < 1e-9), "{slope:?}");
    }
}
