//! Gauss–Legendre rules, made at compile time.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Reparameterizing by arc length – quadrature"; nodes are roots of the
//! Legendre polynomial by Newton's method with deflation from the largest (J. Stoer and R. Bulirsch, *Introduction to
//! Numerical Analysis*, §3.6, §5.5), weights `2/((1 − x²)P′(x)²)`.

/// A rule of `2·H` nodes on `[−1, 1]`: the positive ones, and their weights.
pub(crate) struct Rule<const H: usize> {
    pub nodes: [f64; H],
    pub weights: [f64; H],
}

/// The Legendre polynomial of degree `n` and its derivative at `x`, `|x| < 1`.
const fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    let mut k = 1;
    while k < n {
        let m = k as f64;
        let next = ((2.0 * m + 1.0) * x * value - m * before) / (m + 1.0);
        before = value;
        value = next;
        k += 1;
    }
    (value, n as f64 * (x * value - before) / (x * x - 1.0))
}

impl<const H: usize> Rule<H> {
    pub(crate) const fn new() -> Self {
        let n = 2 * H;
        let (mut nodes, mut weights) = ([0.0; H], [0.0; H]);
        let mut found = 0;
        while found < H {
            // Newton's method from above goes straight to the largest root that is left.
            let mut x = if found == 0 { 1.0 } else { nodes[H - found] } * (1.0 - 1e-9);
            let mut step = 0;
            while step < 100 {
                let (value, slope) = legendre(n, x);
                let mut poles = 0.0;
                let mut k = 0;
                while k < found {
                    let root = nodes[H - 1 - k];
                    poles += 1.0 / (x - root) + 1.0 / (x + root);
                    k += 1;
                }
                let by = value / (slope - value * poles);
                x -= by;
                if by < 1e-17 && by > -1e-17 {
                    break;
                }
                step += 1;
            }
            let (value, slope) = legendre(n, x);
            x -= value / slope;
            let (_, slope) = legendre(n, x);
            nodes[H - 1 - found] = x;
            weights[H - 1 - found] = 2.0 / ((1.0 - x * x) * slope * slope);
            found += 1;
        }
        Self { nodes, weights }
    }
}

/// The rule of the adaptive method.
pub(crate) static RULE_16: Rule<8> = Rule::new();

/// The integral of `f` over `[a, b]` by 16 nodes.
pub(crate) fn integral(f: &mut impl FnMut(f64) -> f64, a: f64, b: f64) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let pairs = RULE_16.nodes.iter().zip(&RULE_16.weights);
    let sum: f64 = pairs
        .map(|(x, w)| w * (f(middle - half * x) + f(middle + half * x)))
        .sum();
    sum * half
}

/// How often an interval is halved at most: 2⁻⁴⁵ of a span contributes nothing that its accuracy could miss.
const DEPTH: u32 = 45;
/// Rule applications after which an integral is taken as it is.
const APPLICATIONS: usize = 20_000;

/// The integral of `f ≥ 0` over `[a, b]` to `accuracy`: halves until a rule and its two halves agree at two levels in a row,
/// since one agreement may be chance where `f` has a corner. The agreement bounds the error of the *whole*; what is returned
/// is that of the halves, which for smooth `f` is far less.
pub(crate) fn adaptive(f: &mut impl FnMut(f64) -> f64, a: f64, b: f64, accuracy: f64) -> f64 {
    adaptive_or_not(f, a, b, accuracy).0
}

/// The same, and whether all intervals agreed before a cap was reached.
pub(crate) fn adaptive_or_not(
    f: &mut impl FnMut(f64) -> f64,
    a: f64,
    b: f64,
    accuracy: f64,
) -> (f64, bool) {
    let whole = integral(f, a, b);
    let mut stack = vec![(a, b, whole, accuracy, 0, false)];
    let (mut sum, mut applied, mut converged) = (0.0, 1, true);
    while let Some((a, b, whole, accuracy, depth, agreed)) = stack.pop() {
        let middle = 0.5 * (a + b);
        let (left, right) = (integral(f, a, middle), integral(f, middle, b));
        applied += 2;
        let halves = left + right;
        let rounding = 1e-15 * halves;
        let near = (halves - whole).abs();
        let agree = agreed && near <= accuracy.max(rounding);
        if agree || depth >= DEPTH || applied >= APPLICATIONS {
            converged &= agree;
            sum += halves;
        } else {
            let near = near <= 4.0 * accuracy.max(rounding);
            stack.push((middle, b, right, 0.5 * accuracy, depth + 1, near));
            stack.push((a, middle, left, 0.5 * accuracy, depth + 1, near));
        }
    }
    (sum, converged)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const H: usize>() {
        let rule = Rule::<H>::new();
        assert!(rule.nodes.windows(2).all(|w| w[0] < w[1]));
        // Exact for all even powers below 4H.
        for power in (0..4 * H as i32).step_by(2) {
            let pairs = rule.nodes.iter().zip(&rule.weights);
            let sum: f64 = pairs.map(|(x, w)| 2.0 * w * x.powi(power)).sum();
            let exact = 2.0 / f64::from(power + 1);
            assert!((sum - exact).abs() < 1e-14, "{H} {power}: {sum} {exact}");
        }
    }

    #[test]
    fn rules_are_exact_for_polynomials() {
        check::<2>();
        check::<3>();
        check::<4>();
        check::<8>();
        check::<18>();
    }

    #[test]
    fn adaptive_integrals_meet_their_accuracy_at_a_kink() {
        for accuracy in [1e-3, 1e-6, 1e-9, 1e-12] {
            let value = adaptive(&mut |x: f64| (x - 0.3).abs(), 0.0, 1.0, accuracy);
            assert!((value - 0.29).abs() <= accuracy);
        }
    }
}
