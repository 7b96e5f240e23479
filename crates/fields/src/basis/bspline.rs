//! B-spline bases over the unit interval.
//!
//! *Source*: C. de Boor, *On Calculating with B-Splines*, J. Approx. Theory 6, 1972; L. Piegl and W. Tiller, *The NURBS
//! Book*, 2nd ed. 1997, algorithms A2.1–A2.3. Errata C17: the domain is `[t_d, t_n]`, both ends included, here scaled to
//! [0, 1]. Errata F20: control points at the Greville abscissae make the spline reproduce straight lines; uniform knots
//! put one ring of them outside the box.

use crate::BasisError;

/// The knots of a B-spline basis of given degree, whose domain `[t_d, t_n]` is [0, 1].
#[derive(Debug, Clone, PartialEq)]
pub struct KnotVector {
    degree: usize,
    count: usize,
    knots: Vec<f64>,
}

impl KnotVector {
    /// Clamped knots for `count` control points: each end repeated `degree + 1` times, even spans in between. The curve
    /// starts at the first control point and ends at the last.
    ///
    /// # Errors
    /// [`BasisError`] unless `degree ≥ 1` and `count ≥ degree + 1`.
    pub fn clamped(count: usize, degree: usize) -> Result<Self, BasisError> {
        Self::build(count, degree, |index, spans| index.clamp(0.0, spans))
    }

    /// Evenly spaced knots for `count` control points, `degree` of them before 0 and after 1.
    ///
    /// # Errors
    /// [`BasisError`] unless `degree ≥ 1` and `count ≥ degree + 1`.
    pub fn uniform(count: usize, degree: usize) -> Result<Self, BasisError> {
        Self::build(count, degree, |index, _| index)
    }

    fn build(
        count: usize,
        degree: usize,
        place: impl Fn(f64, f64) -> f64,
    ) -> Result<Self, BasisError> {
        if degree == 0 {
            return Err(BasisError::DegreeZero);
        }
        if count <= degree {
            return Err(BasisError::TooFewPoints { degree, count });
        }
        let spans = (count - degree) as f64;
        let knot = |i: usize| place(i as f64 - degree as f64, spans) / spans;
        Ok(Self {
            degree,
            count,
            knots: (0..=count + degree).map(knot).collect(),
        })
    }

    /// The degree.
    pub fn degree(&self) -> usize {
        self.degree
    }
    /// Number of control points, one per basis function.
    pub fn count(&self) -> usize {
        self.count
    }
    /// Number of polynomial spans on [0, 1].
    pub fn spans(&self) -> usize {
        self.count - self.degree
    }
    /// The knots `t_0 … t_(n+d)`, ascending.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The index `k` from `degree` to `count − 1` of the span `[t_k, t_(k+1))` that contains `t`; 1 belongs to the last
    /// span. `None` outside [0, 1] and for NaN.
    pub fn span(&self, t: f64) -> Option<usize> {
        if !(0.0..=1.0).contains(&t) {
            return None;
        }
        // The spans are even; rounding may be off by one.
        // Between 0 and the number of spans.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let guess = (t * self.spans() as f64) as usize;
        let last = self.count - 1;
        let mut span = (self.degree + guess).min(last);
        if t < self.knots[span] {
            span -= 1;
        } else if span < last && t >= self.knots[span + 1] {
            span += 1;
        }
        Some(span)
    }

    /// Writes the values at `t` of the `degree + 1` basis functions that are not 0 there to the start of `out`, and returns
    /// the index of the first. `None`, with `out` unchanged, when `t` is outside [0, 1] or `out` is too short.
    pub fn values(&self, t: f64, out: &mut [f64]) -> Option<usize> {
        let span = self.span(t)?;
        let out = out.get_mut(..=self.degree)?;
        self.recursion(span, t, self.degree, out);
        Some(span - self.degree)
    }

    /// As [`KnotVector::values`] for the derivatives by `t`. At an inner knot of degree 1, the right derivative.
    pub fn derivatives(&self, t: f64, out: &mut [f64]) -> Option<usize> {
        let span = self.span(t)?;
        let degree = self.degree;
        let out = out.get_mut(..=degree)?;
        self.recursion(span, t, degree - 1, out);
        // N_i,d′ = d (N_i,d−1 / (t_(i+d) − t_i) − N_(i+1),d−1 / (t_(i+d+1) − t_(i+1))); from the last one back, each
        // reads the value before it.
        for r in (0..=degree).rev() {
            let i = span - degree + r;
            let before = if r > 0 {
                out[r - 1] / (self.knots[i + degree] - self.knots[i])
            } else {
                0.0
            };
            let after = if r < degree {
                out[r] / (self.knots[i + degree + 1] - self.knots[i + 1])
            } else {
                0.0
            };
            out[r] = degree as f64 * (before - after);
        }
        Some(span - degree)
    }

    /// The basis functions of `degree` (at most that of the spline) that are not 0 on `span`, by de Boor's recursion.
    fn recursion(&self, span: usize, t: f64, degree: usize, out: &mut [f64]) {
        out[0] = 1.0;
        for j in 1..=degree {
            let mut saved = 0.0;
            for (r, value) in out.iter_mut().enumerate().take(j) {
                let right = self.knots[span + r + 1] - t;
                let left = t - self.knots[span + 1 + r - j];
                let share = *value / (right + left);
                *value = saved + right * share;
                saved = left * share;
            }
            out[j] = saved;
        }
    }

    /// The Greville abscissae `(t_(i+1) + … + t_(i+d))/d`, one per control point: where control points must stand for the
    /// spline to reproduce straight lines. With uniform knots some lie outside [0, 1].
    pub fn greville(&self) -> Vec<f64> {
        (0..self.count)
            .map(|i| {
                let sum: f64 = self.knots[i + 1..=i + self.degree].iter().sum();
                sum / self.degree as f64
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    fn all() -> Vec<KnotVector> {
        let mut all = Vec::new();
        for degree in 1..=6 {
            for extra in [1, 2, 3, 7, 26] {
                all.push(KnotVector::clamped(degree + extra, degree).unwrap());
                all.push(KnotVector::uniform(degree + extra, degree).unwrap());
            }
        }
        all
    }

    fn places(random: &mut Random, basis: &KnotVector) -> Vec<f64> {
        let mut places: Vec<f64> = (0..40).map(|_| random.between(0.0, 1.0)).collect();
        let inner = basis.knots().iter().filter(|t| (0.0..=1.0).contains(*t));
        places.extend(inner);
        places.extend([0.0, 1.0, 1.0 - f64::EPSILON, f64::MIN_POSITIVE]);
        places
    }

    #[test]
    fn unity_positivity_and_linear_precision() {
        let mut random = Random::new(61);
        for basis in all() {
            let greville = basis.greville();
            for t in places(&mut random, &basis) {
                let mut out = vec![f64::NAN; basis.degree() + 1];
                let first = basis.values(t, &mut out).unwrap();
                assert!(out.iter().all(|&b| (0.0..=1.0 + 1e-15).contains(&b)), "{t}");
                assert!((out.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                let linear: f64 = out.iter().zip(&greville[first..]).map(|(b, g)| b * g).sum();
                assert!((linear - t).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_values() {
        let mut random = Random::new(62);
        for basis in all() {
            let n = basis.degree() + 1;
            for t in places(&mut random, &basis) {
                let h = 1e-7;
                let mut slopes = vec![f64::NAN; n];
                let first = basis.derivatives(t, &mut slopes).unwrap();
                assert!(slopes.iter().sum::<f64>().abs() < 1e-11 * basis.count() as f64);
                // Within one span, so that degree 1 has a derivative at all.
                let (mut fore, mut aft) = (vec![0.0; n], vec![0.0; n]);
                let ends = (
                    basis.values(t + h, &mut fore),
                    basis.values(t - h, &mut aft),
                );
                if ends != (Some(first), Some(first)) {
                    continue;
                }
                for i in 0..n {
                    let difference = (fore[i] - aft[i]) / (2.0 * h);
                    assert!((slopes[i] - difference).abs() < 1e-4, "{basis:?} at {t}");
                }
            }
        }
    }

    #[test]
    fn errata_c17_both_ends_belong_to_the_domain() {
        for basis in all() {
            let mut out = vec![0.0; basis.degree() + 1];
            assert_eq!(basis.span(0.0), Some(basis.degree()));
            assert_eq!(basis.span(1.0), Some(basis.count() - 1));
            assert!(basis.values(1.0, &mut out).is_some());
            for t in [-1e-300, 1.0 + f64::EPSILON, f64::NAN] {
                assert!(basis.span(t).is_none() && basis.values(t, &mut out).is_none());
            }
            assert!(basis.values(0.5, &mut [0.0]).is_none());
            let knots = basis.knots();
            assert_eq!((knots[basis.degree()], knots[basis.count()]), (0.0, 1.0));
        }
    }

    #[test]
    fn spans_contain_their_places() {
        let mut random = Random::new(63);
        for basis in all() {
            for t in places(&mut random, &basis) {
                let span = basis.span(t).unwrap();
                assert!(basis.knots()[span] <= t);
                assert!(t < basis.knots()[span + 1] || t == 1.0);
            }
        }
    }

    #[test]
    fn local_support() {
        // Function i is 0 outside [t_i, t_(i+d+1)] and not inside.
        let basis = KnotVector::uniform(9, 3).unwrap();
        let mut out = [0.0; 4];
        for step in 0..=200 {
            let t = f64::from(step) / 200.0;
            let first = basis.values(t, &mut out).unwrap();
            for i in 0..basis.count() {
                let inside = basis.knots()[i] < t && t < basis.knots()[i + 4];
                let value = if (first..first + 4).contains(&i) {
                    out[i - first]
                } else {
                    0.0
                };
                assert_eq!(value > 0.0, inside, "{i} at {t}");
            }
        }
    }

    #[test]
    fn errata_f20_greville_abscissae() {
        // Cubic, six control points, uniform knots: three spans, one ring outside.
        let uniform = KnotVector::uniform(6, 3).unwrap().greville();
        let expected = [-1.0 / 3.0, 0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0, 4.0 / 3.0];
        for (g, e) in uniform.iter().zip(expected) {
            assert!((g - e).abs() < 1e-15);
        }
        let clamped = KnotVector::clamped(6, 3).unwrap().greville();
        assert_eq!((clamped[0], clamped[5]), (0.0, 1.0));
        assert!((clamped[1] - 1.0 / 9.0).abs() < 1e-15);
        // One span of a clamped basis is Bernstein's.
        let basis = KnotVector::clamped(4, 3).unwrap();
        let (mut spline, mut bernstein) = ([0.0; 4], [0.0; 4]);
        for step in 0..=10 {
            let t = f64::from(step) * 0.1;
            basis.values(t, &mut spline);
            crate::basis::bernstein::values(t, &mut bernstein);
            for i in 0..4 {
                assert!((spline[i] - bernstein[i]).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn bad_counts_are_refused() {
        assert_eq!(KnotVector::clamped(4, 0), Err(BasisError::DegreeZero));
        let few = KnotVector::uniform(3, 3).unwrap_err();
        assert_eq!(
            few.to_string(),
            "a B-spline of degree 3 needs at least 4 control points, not 3"
        );
    }
}
