//! Polynomials in Bernstein form on the unit interval: evaluation, halving, and all their real roots.
//!
//! *Source*: G. Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002, chapters 4–6 (de Casteljau's algorithm, variation
//! diminution): a polynomial has no more roots in the interval than its Bernstein coefficients have changes of sign, so
//! that halving until there is none or one isolates them all. No sampling, and nothing is missed but pairs of roots that
//! rounding cannot tell from none.

/// Halvings after which two roots count as one: intervals of 2⁻⁴⁸ are at the rounding of their ends.
const DEPTH: u32 = 48;
/// Steps of the bracketed root search; halving alone needs 53.
const STEPS: u32 = 80;

/// Value at `t` by de Casteljau's algorithm.
pub(crate) fn value(coefficients: &[f64], t: f64, scratch: &mut Vec<f64>) -> f64 {
    scratch.clear();
    scratch.extend_from_slice(coefficients);
    let n = scratch.len();
    for level in 1..n {
        for i in 0..n - level {
            scratch[i] = scratch[i] * (1.0 - t) + scratch[i + 1] * t;
        }
    }
    scratch.first().copied().unwrap_or(0.0)
}

/// Cuts at `t`: the coefficients on `[0, t]` replace `left`, those on `[t, 1]` are returned.
fn cut(left: &mut [f64], t: f64) -> Vec<f64> {
    let n = left.len();
    let mut right = left.to_vec();
    // `left[i]` becomes the first of level i; `right[n − 1 − i]` the last of level i.
    for (level, first) in left.iter_mut().enumerate().skip(1) {
        for i in 0..n - level {
            right[i] = right[i] * (1.0 - t) + right[i + 1] * t;
        }
        *first = right[0];
    }
    right
}

/// Changes of sign in the list, zeros left out.
fn changes(coefficients: &[f64]) -> usize {
    let mut changes = 0;
    let mut last = 0.0;
    for &c in coefficients {
        if c != 0.0 {
            if last != 0.0 && (last < 0.0) != (c < 0.0) {
                changes += 1;
            }
            last = c;
        }
    }
    changes
}

/// A place where the polynomial changes sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    /// Where, in `[0, 1]`.
    pub at: f64,
    /// Whether from negative to positive.
    pub rising: bool,
}

/// All places in the open unit interval where the polynomial changes its sign, in order.
pub(crate) fn crossings(coefficients: &[f64]) -> Vec<Crossing> {
    let mut found = Vec::new();
    if changes(coefficients) == 0 {
        return found;
    }
    let mut scratch = Vec::with_capacity(coefficients.len());
    // Left parts are done first: a stack with the right part below.
    let mut stack = vec![Task::Search(coefficients.to_vec(), 0.0, 1.0, 0)];
    while let Some(task) = stack.pop() {
        let (mut piece, a, b, depth) = match task {
            Task::Found(crossing) => {
                found.push(crossing);
                continue;
            }
            Task::Search(piece, a, b, depth) => (piece, a, b, depth),
        };
        let (Some(&first), Some(&last)) = (piece.first(), piece.last()) else {
            continue;
        };
        let rising = first < 0.0;
        match changes(&piece) {
            0 => {}
            1 if first != 0.0 && last != 0.0 => {
                let at = a + (b - a) * bracketed(&piece, &mut scratch);
                found.push(Crossing { at, rising });
            }
            _ if depth >= DEPTH => {
                if first != 0.0 && last != 0.0 && rising == (last > 0.0) {
                    let at = 0.5 * (a + b);
                    found.push(Crossing { at, rising });
                }
            }
            _ => {
                // A cut off the middle: symmetric curves have roots there.
                let m = a + (b - a) * CUT;
                let right = cut(&mut piece, CUT);
                let before = piece.iter().rev().find(|c| **c != 0.0).copied();
                let behind = right.iter().find(|c| **c != 0.0).copied();
                let at_the_cut = right.first() == Some(&0.0);
                stack.push(Task::Search(right, m, b, depth + 1));
                if let (true, Some(before), Some(behind)) = (at_the_cut, before, behind)
                    && (before < 0.0) != (behind < 0.0)
                {
                    let rising = before < 0.0;
                    stack.push(Task::Found(Crossing { at: m, rising }));
                }
                stack.push(Task::Search(piece, a, m, depth + 1));
            }
        }
    }
    found
}

/// Where intervals are cut.
const CUT: f64 = 0.5 - 0.007_812_5;

/// What remains to be done, the leftmost last.
enum Task {
    /// Coefficients on an interval, and how often it was cut.
    Search(Vec<f64>, f64, f64, u32),
    /// A crossing exactly at a cut.
    Found(Crossing),
}

/// The one root of a polynomial whose end coefficients have opposite signs.
fn bracketed(coefficients: &[f64], scratch: &mut Vec<f64>) -> f64 {
    let n = coefficients.len();
    let slopes: Vec<f64> = coefficients.windows(2).map(|p| p[1] - p[0]).collect();
    let degree = (n - 1) as f64;
    let rising = coefficients[0] < 0.0;
    let (mut low, mut high) = (0.0, 1.0);
    let (first, last) = (coefficients[0], coefficients[n - 1]);
    let mut t = first / (first - last);
    for _ in 0..STEPS {
        if !(t > low && t < high) {
            t = 0.5 * (low + high);
        }
        let f = value(coefficients, t, scratch);
        if f == 0.0 {
            return t;
        }
        if (f < 0.0) == rising {
            low = t;
        } else {
            high = t;
        }
        let slope = degree * value(&slopes, t, scratch);
        let next = t - f / slope;
        if (next - t).abs() <= 1e-16 || high - low <= 1e-16 {
            return if next > low && next < high { next } else { t };
        }
        t = next;
    }
    t
}

/// The product of two polynomials.
pub(crate) fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let (m, n) = (a.len() - 1, b.len() - 1);
    let mut out = vec![0.0; m + n + 1];
    let (ma, nb, mn) = (binomials(m), binomials(n), binomials(m + n));
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            out[i + j] += ma[i] * nb[j] / mn[i + j] * x * y;
        }
    }
    out
}

/// The row of Pascal's triangle with `n + 1` numbers.
pub(crate) fn binomials(n: usize) -> Vec<f64> {
    let mut row = vec![1.0; n + 1];
    for i in 1..n {
        row[i] = row[i - 1] * (n + 1 - i) as f64 / i as f64;
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bernstein coefficients of `Π (t − r)`.
    fn with_roots(roots: &[f64]) -> Vec<f64> {
        roots
            .iter()
            .fold(vec![1.0], |poly, r| product(&poly, &[-r, 1.0 - r]))
    }

    #[test]
    fn finds_all_roots_in_the_interval() {
        for roots in [
            vec![0.5],
            vec![0.1, 0.2, 0.9],
            vec![0.25, 0.5, 0.75, 1.5, -2.0],
            vec![0.496, 0.4961, 0.99999],
            vec![1e-6, 0.3, 0.300001],
        ] {
            let found = crossings(&with_roots(&roots));
            let inside: Vec<f64> = roots
                .iter()
                .copied()
                .filter(|r| (0.0..1.0).contains(r))
                .collect();
            assert_eq!(found.len(), inside.len(), "{roots:?}: {found:?}");
            for (f, r) in found.iter().zip(&inside) {
                assert!((f.at - r).abs() < 1e-9, "{roots:?}: {found:?}");
            }
            assert!(found.windows(2).all(|w| w[0].rising != w[1].rising));
        }
        assert!(crossings(&with_roots(&[0.5, 0.5])).len() != 1);
        assert!(crossings(&[0.0, 0.0, 0.0]).is_empty());
        assert!(crossings(&[1.0, -0.4, 1.0]).is_empty());
    }

    #[test]
    fn a_root_on_a_cut_is_found() {
        let t = CUT;
        let found = crossings(&with_roots(&[0.1, t, 0.8]));
        assert_eq!(found.len(), 3, "{found:?}");
        assert!((found[1].at - t).abs() < 1e-12);
    }

    #[test]
    fn products_multiply_values() {
        let (a, b) = ([1.0, -2.0, 0.5], [3.0, 1.0, 4.0, -1.0]);
        let c = product(&a, &b);
        let mut s = Vec::new();
        for t in [0.0, 0.3, 0.77, 1.0] {
            let expected = value(&a, t, &mut s) * value(&b, t, &mut s);
            assert!((value(&c, t, &mut s) - expected).abs() < 1e-13);
        }
    }
}
