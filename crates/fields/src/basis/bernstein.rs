//! Bernstein polynomials `B_i^d(t) = C(d,i) t^i (1−t)^(d−i)`.
//!
//! *Source*: G. Farin, *Curves and Surfaces for CAGD*, 5th ed. 2002, §5.1 (the recursion); errata F1: the index printed in
//! Milliron et al. 2002, note 10, is reversed. Here `B_0` is 1 at `t = 0`.
//!
//! Decision: the recursion of convex combinations, which is stable on [0, 1] for every degree; it is the same polynomial
//! outside, where some values are negative (errata F3).

/// The values of all Bernstein polynomials of degree `out.len() − 1` at `t`. Nothing for an empty slice.
pub fn values(t: f64, out: &mut [f64]) {
    let Some(first) = out.first_mut() else { return };
    *first = 1.0;
    let s = 1.0 - t;
    for degree in 1..out.len() {
        // From degree − 1 to degree, from the last one back.
        out[degree] = t * out[degree - 1];
        for i in (1..degree).rev() {
            out[i] = s * out[i] + t * out[i - 1];
        }
        out[0] *= s;
    }
}

/// The derivatives by `t` of all Bernstein polynomials of degree `out.len() − 1`: `d (B_{i−1}^{d−1} − B_i^{d−1})`.
pub fn derivatives(t: f64, out: &mut [f64]) {
    let count = out.len();
    if count < 2 {
        out.fill(0.0);
        return;
    }
    let degree = (count - 1) as f64;
    values(t, &mut out[..count - 1]);
    out[count - 1] = degree * out[count - 2];
    for i in (1..count - 1).rev() {
        out[i] = degree * (out[i - 1] - out[i]);
    }
    out[0] *= -degree;
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::math;

    fn binomial(d: u32, i: u32) -> f64 {
        (0..i).fold(1.0, |c, k| c * f64::from(d - k) / f64::from(k + 1))
    }

    #[test]
    fn errata_f1_the_closed_form() {
        for d in 0..=9_u32 {
            for step in -3..=13 {
                let t = f64::from(step) * 0.1;
                let mut out = vec![0.0; d as usize + 1];
                values(t, &mut out);
                for i in 0..=d {
                    let expected = binomial(d, i) * math::powi(t, i) * math::powi(1.0 - t, d - i);
                    assert!((out[i as usize] - expected).abs() < 1e-13 * (1.0 + expected.abs()));
                }
            }
        }
        // B_0 belongs to the first control point.
        let mut out = [0.0; 4];
        values(0.0, &mut out);
        assert_eq!(out, [1.0, 0.0, 0.0, 0.0]);
        values(1.0, &mut out);
        assert_eq!(out, [0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn unity_positivity_and_linear_precision_up_to_high_degree() {
        for d in [1, 2, 3, 7, 20, 60, 200] {
            for step in 0..=50 {
                let t = f64::from(step) * 0.02;
                let mut out = vec![0.0; d + 1];
                values(t, &mut out);
                assert!(out.iter().all(|&b| b >= 0.0));
                assert!((out.iter().sum::<f64>() - 1.0).abs() < 1e-13);
                let line = |(i, b): (usize, &f64)| b * i as f64 / d as f64;
                let linear: f64 = out.iter().enumerate().map(line).sum();
                assert!((linear - t).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_values() {
        for d in 0..=8_usize {
            for step in -2..=12 {
                let (t, h) = (f64::from(step) * 0.1, 1e-6);
                let mut slopes = vec![f64::NAN; d + 1];
                derivatives(t, &mut slopes);
                let (mut fore, mut aft) = (vec![0.0; d + 1], vec![0.0; d + 1]);
                values(t + h, &mut fore);
                values(t - h, &mut aft);
                for i in 0..=d {
                    let difference = (fore[i] - aft[i]) / (2.0 * h);
                    assert!(
                        (slopes[i] - difference).abs() < 1e-7,
                        "degree {d}, {i} at {t}"
                    );
                }
                assert!(slopes.iter().sum::<f64>().abs() < 1e-12);
            }
        }
        values(0.5, &mut []);
        derivatives(0.5, &mut []);
    }
}
