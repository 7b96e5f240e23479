//! Least-squares polynomials in a moving window.
//!
//! *Source*: A. Savitzky and M. J. E. Golay, *Smoothing and Differentiation of Data by Simplified Least Squares Procedures*,
//! Analytical Chemistry 36(8), 1964; at the ends, P. A. Gorry, *General Least-Squares Smoothing and Differentiation by the
//! Convolution (Savitzky–Golay) Method*, Analytical Chemistry 62(6), 1990: the first and the last window's polynomial is
//! evaluated off its middle. The polynomials are orthonormal on the window, by the Stieltjes procedure with
//! orthogonalization repeated, so that no degree loses digits.

use super::{Filter, Weights, wrapped};
use crate::CurveError;

/// The widest window, and the highest degree: what a window's polynomials take is their product.
const WIDEST: usize = 10_001;
const HIGHEST: usize = 64;

/// The value at each point of the polynomial that fits its window best. Polynomials of the degree pass unchanged, at the
/// ends of an open path, too.
///
/// An open path shorter than the window is one window, and the degree at most its number of points less one. Closed
/// paths wrap, also more than once.
#[derive(Clone, Debug, PartialEq)]
pub struct SavitzkyGolay {
    window: usize,
    degree: usize,
    basis: Basis,
    /// Weights at the middle of the window.
    middle: Vec<f64>,
}

impl SavitzkyGolay {
    /// A window of an odd number of points, at most 10 001, and a degree below that number, at most 64.
    ///
    /// # Errors
    /// [`CurveError::OutOfRange`].
    pub fn new(window: usize, degree: usize) -> Result<Self, CurveError> {
        #[allow(clippy::cast_precision_loss)]
        if window.is_multiple_of(2) || window > WIDEST {
            return Err(CurveError::OutOfRange {
                name: "window",
                value: window as f64,
                range: "an odd number from 1 to 10001",
            });
        }
        #[allow(clippy::cast_precision_loss)]
        if degree >= window || degree > HIGHEST {
            return Err(CurveError::OutOfRange {
                name: "degree",
                value: degree as f64,
                range: "less than the window, and at most 64",
            });
        }
        let basis = Basis::new(window, degree);
        let mut middle = vec![0.0; window];
        basis.weights(window / 2, &mut middle);
        Ok(Self {
            window,
            degree,
            basis,
            middle,
        })
    }
}

/// Orthonormal polynomials on `count` even points: their values, one polynomial after the other.
#[derive(Clone, Debug, PartialEq)]
struct Basis {
    count: usize,
    values: Vec<Vec<f64>>,
}

impl Basis {
    fn new(count: usize, degree: usize) -> Self {
        #[allow(clippy::cast_precision_loss)]
        let places: Vec<f64> = {
            let middle = 0.5 * (count as f64 - 1.0);
            let reach = middle.max(0.5);
            (0..count).map(|i| (i as f64 - middle) / reach).collect()
        };
        let mut values: Vec<Vec<f64>> = Vec::with_capacity(degree + 1);
        let mut next = vec![1.0; count];
        for _ in 0..=degree {
            for _ in 0..2 {
                for known in &values {
                    let part = dot(known, &next);
                    for (n, k) in next.iter_mut().zip(known) {
                        *n -= part * k;
                    }
                }
                let size = dot(&next, &next).sqrt();
                for n in &mut next {
                    *n /= size;
                }
            }
            let raised = next.iter().zip(&places).map(|(n, x)| n * x).collect();
            values.push(core::mem::replace(&mut next, raised));
        }
        Self { count, values }
    }

    /// The weights of the window's points in the fitted value at one of them.
    fn weights(&self, at: usize, weights: &mut [f64]) {
        weights.fill(0.0);
        for polynomial in &self.values {
            let here = polynomial[at];
            for (weight, there) in weights.iter_mut().zip(polynomial) {
                *weight += here * there;
            }
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

enum Fit<'a> {
    /// A path of at least a window, or a closed one.
    Moving {
        filter: &'a SavitzkyGolay,
        count: usize,
        closed: bool,
    },
    /// An open path that is one window.
    Whole(Basis),
}

impl Filter for SavitzkyGolay {
    fn weights(&self, count: usize, closed: bool) -> Box<dyn Weights + '_> {
        Box::new(if closed || count >= self.window {
            Fit::Moving {
                filter: self,
                count,
                closed,
            }
        } else {
            Fit::Whole(Basis::new(count, self.degree.min(count - 1)))
        })
    }
}

impl Weights for Fit<'_> {
    fn row(&self, index: usize, row: &mut Vec<(usize, f64)>) {
        let mut off_middle = |basis: &Basis, first: usize| {
            let mut weights = vec![0.0; basis.count];
            basis.weights(index - first, &mut weights);
            row.extend(weights.into_iter().enumerate().map(|(i, w)| (first + i, w)));
        };
        match self {
            Self::Whole(basis) => off_middle(basis, 0),
            Self::Moving {
                filter,
                count,
                closed,
            } => {
                let reach = filter.window / 2;
                if *closed {
                    #[allow(clippy::cast_possible_wrap)]
                    let offset = |i: usize| i as i64 - reach as i64;
                    let middle = filter.middle.iter().enumerate();
                    row.extend(middle.map(|(i, &w)| (wrapped(index, offset(i), *count), w)));
                } else if index < reach {
                    off_middle(&filter.basis, 0);
                } else if index + reach >= *count {
                    off_middle(&filter.basis, count - filter.window);
                } else {
                    let middle = filter.middle.iter().enumerate();
                    row.extend(middle.map(|(i, &w)| (index - reach + i, w)));
                }
            }
        }
    }
}
