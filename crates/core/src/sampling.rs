//! Sampling of continuous features: eq. (4)'s integrals over a feature become sums over nodes.
//!
//! A feature with extent, such as a curve, gives a transformation `T(v)`, a strength and a weight for every parameter `v`, and
//! eq. (4) averages over all of them. [`Sampling`] says at which parameters and with which shares of the measure.
//!
//! - *nearest*: the one parameter nearest to the point, with mass 1. It is a measure of its own (Wires and Barr's deformations
//!   mean it), not a limit of the others (errata F17).
//! - *uniform*: the middles of equal cells; the error falls with the square of the cells' size.
//! - *Gauss–Legendre*: exact for polynomials of degree `2n − 1` on every smooth piece.
//! - *adaptive*: Gauss–Kronrod pairs of 7 and 15 nodes on panels, the worst of which is halved until their differences add up to
//!   no more than the tolerance.
//!
//! *Source*: Milliron et al. 2002, §3.4, eq. (4) and its sampling functions; W. Gautschi, *Numerical Analysis*, 2nd ed., 2012,
//! §3.2 (Gauss–Legendre nodes by Newton's method); R. Piessens et al., *QUADPACK*, 1983 (the pair of 7 and 15 nodes, global
//! subdivision).

use crate::math;

/// How the integral over a continuous feature is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sampling {
    /// At the nearest parameter alone.
    Nearest,
    /// About this many cells of equal measure in all, at least one for every smooth piece, each sampled at its middle.
    Uniform(usize),
    /// This many nodes on every smooth piece.
    GaussLegendre(usize),
    /// As many as needed for an error of at most this share of the integral of the weights.
    Adaptive(f64),
}

/// Nodes that [`Sampling::Uniform`] and [`Sampling::GaussLegendre`] may ask for at most, which bounds memory.
pub const MOST_NODES: usize = 1 << 20;
/// The least tolerance of [`Sampling::Adaptive`]; sums of some thousand terms keep no more digits.
pub const LEAST_TOLERANCE: f64 = 1e-12;
/// Nodes of [`Sampling::GaussLegendre`] a piece at most.
pub const MOST_GAUSS: usize = 256;

/// A parameter and its share of the measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// The parameter.
    pub at: f64,
    /// Its share: the width of the cell it stands for.
    pub weight: f64,
}

impl Sampling {
    /// Whether the numbers make sense: a count from 1 (up to [`MOST_NODES`], for Gauss–Legendre [`MOST_GAUSS`]), a tolerance
    /// from [`LEAST_TOLERANCE`] to 0.1.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        match *self {
            Self::Nearest => true,
            Self::Uniform(count) => (1..=MOST_NODES).contains(&count),
            Self::GaussLegendre(count) => (1..=MOST_GAUSS).contains(&count),
            Self::Adaptive(tolerance) => (LEAST_TOLERANCE..=0.1).contains(&tolerance),
        }
    }

    /// The nodes over a variable whose measure is its own length, in order, where they depend on nothing else: those of
    /// *uniform* and *Gauss–Legendre*. `breaks` bound the smooth pieces, ascending; pieces without length have no nodes.
    /// Numbers that are not valid are brought into their range.
    #[must_use]
    pub fn nodes(&self, breaks: &[f64]) -> Option<Vec<Node>> {
        let pieces = breaks.windows(2).filter(|p| p[1] > p[0]);
        match *self {
            Self::Nearest | Self::Adaptive(_) => None,
            Self::Uniform(count) => {
                let count = count.clamp(1, MOST_NODES) as f64;
                let total: f64 = pieces.clone().map(|p| p[1] - p[0]).sum();
                let mut nodes = Vec::new();
                for piece in pieces {
                    let length = piece[1] - piece[0];
                    let cells = (count * (length / total)).round().max(1.0);
                    let width = length / cells;
                    for i in 0..cells as usize {
                        nodes.push(Node {
                            at: piece[0] + (i as f64 + 0.5) * width,
                            weight: width,
                        });
                    }
                }
                Some(nodes)
            }
            Self::GaussLegendre(count) => {
                let rule = gauss_legendre(count.clamp(1, MOST_GAUSS));
                let mut nodes = Vec::new();
                for piece in pieces {
                    let (middle, half) = (0.5 * (piece[0] + piece[1]), 0.5 * (piece[1] - piece[0]));
                    nodes.extend(rule.iter().map(|node| Node {
                        at: middle + half * node.at,
                        weight: half * node.weight,
                    }));
                }
                Some(nodes)
            }
        }
    }
}

/// The Gauss–Legendre rule of `count` nodes on [−1, 1], ascending.
#[must_use]
pub fn gauss_legendre(count: usize) -> Vec<Node> {
    let n = count as f64;
    let mut rule = vec![
        Node {
            at: 0.0,
            weight: 0.0
        };
        count
    ];
    for i in 0..count.div_ceil(2) {
        // Chebyshev's guess; Newton's method doubles its digits at every step.
        let mut x = math::cos(core::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5));
        let mut slope = 1.0;
        for _ in 0..8 {
            let (value, derivative) = legendre(count, x);
            slope = derivative;
            let step = value / derivative;
            x -= step;
            if step.abs() <= 2e-16 {
                break;
            }
        }
        if count % 2 == 1 && i == count / 2 {
            x = 0.0;
            slope = legendre(count, x).1;
        }
        let weight = 2.0 / ((1.0 - x * x) * slope * slope);
        rule[i] = Node { at: -x, weight };
        rule[count - 1 - i] = Node { at: x, weight };
    }
    rule
}

/// Legendre's polynomial of a degree and its derivative, inside (−1, 1).
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut before, mut here) = (1.0, x);
    if degree == 0 {
        return (1.0, 0.0);
    }
    for k in 2..=degree {
        let k = k as f64;
        (before, here) = (here, ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k);
    }
    let derivative = degree as f64 * (x * here - before) / (x * x - 1.0);
    (here, derivative)
}

/// Kronrod's nodes in [0, 1) of the pair with Gauss' 7, from the outermost to the middle; every second one is Gauss'.
const KRONROD: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_5,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_5,
    0.0,
];
/// Their weights.
const KRONROD_WEIGHTS: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_55,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_82,
];
/// Gauss' weights of the nodes 1, 3, 5, 7 of the list.
const GAUSS_WEIGHTS: [f64; 4] = [
    0.129_484_966_168_869_7,
    0.279_705_391_489_276_64,
    0.381_830_050_505_118_9,
    0.417_959_183_673_469_4,
];

/// Nodes of a panel.
const PANEL: usize = 15;

/// A panel with what both rules say.
#[derive(Debug, Clone, Copy)]
struct Panel<const N: usize> {
    from: f64,
    to: f64,
    /// Kronrod's integrals.
    integral: [f64; N],
    /// Greatest difference from Gauss' integrals.
    error: f64,
}

/// The node `i` of a panel, 0 to 14, ascending, with its weight.
fn kronrod(from: f64, to: f64, i: usize) -> Node {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (j, sign) = if i < 8 {
        (i, -1.0)
    } else {
        (PANEL - 1 - i, 1.0)
    };
    Node {
        at: middle + sign * half * KRONROD[j],
        weight: half * KRONROD_WEIGHTS[j],
    }
}

/// What [`adaptive`] reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integral<const N: usize> {
    /// The integrals of the components.
    pub values: [f64; N],
    /// The sum of the panels' estimated errors, the greatest component of each.
    pub error: f64,
    /// Whether the tolerance was met with the panels allowed.
    pub complete: bool,
}

/// Panels of one integral at most: about 60 000 evaluations.
const MOST_PANELS: usize = 4096;

/// Integrates `N` functions at once over panels, halving the worst until the estimated errors add up to at most
/// `tolerance` times the integral of the first function, which should not be negative. The nodes of all panels, with which the
/// integrals are plain sums, are appended to `nodes` in the order of the panels.
///
/// A function that vanishes at all 15 nodes of a panel counts as vanishing on it: give panels no longer than what may hide.
pub fn adaptive<const N: usize>(
    panels: impl Iterator<Item = (f64, f64)>,
    tolerance: f64,
    integrand: &mut dyn FnMut(f64) -> [f64; N],
    nodes: &mut Vec<Node>,
) -> Integral<N> {
    let mut measure = |from: f64, to: f64| {
        let (mut whole, mut gauss) = ([0.0; N], [0.0; N]);
        for i in 0..PANEL {
            let node = kronrod(from, to, i);
            let values = integrand(node.at);
            let j = i.min(PANEL - 1 - i);
            for c in 0..N {
                whole[c] += node.weight * values[c];
                if j % 2 == 1 {
                    gauss[c] += 0.5 * (to - from) * GAUSS_WEIGHTS[j / 2] * values[c];
                }
            }
        }
        let differences = whole.iter().zip(&gauss).map(|(k, g)| (k - g).abs());
        let error = differences.fold(0.0, f64::max);
        Panel {
            from,
            to,
            integral: whole,
            error,
        }
    };
    let mut all: Vec<Panel<N>> = panels.map(|(from, to)| measure(from, to)).collect();
    let mut complete = true;
    loop {
        let (mut total, mut error, mut worst) = (0.0, 0.0, 0);
        for (i, panel) in all.iter().enumerate() {
            total += panel.integral.first().copied().unwrap_or(0.0);
            error += panel.error;
            if panel.error > all[worst].error {
                worst = i;
            }
        }
        if error <= tolerance * total || all.is_empty() {
            break;
        }
        let Panel { from, to, .. } = all[worst];
        let middle = 0.5 * (from + to);
        // Rounding alone is left, or no more panels.
        let rounding = error <= 1e-14 * total;
        if rounding || !(middle > from && middle < to) || all.len() >= MOST_PANELS {
            complete = rounding;
            break;
        }
        all[worst] = measure(from, middle);
        all.insert(worst + 1, measure(middle, to));
    }
    let mut values = [0.0; N];
    let mut error = 0.0;
    for panel in &all {
        for (value, part) in values.iter_mut().zip(panel.integral) {
            *value += part;
        }
        error += panel.error;
        if panel.integral.iter().any(|&i| i != 0.0) || panel.error > 0.0 {
            nodes.extend((0..PANEL).map(|i| kronrod(panel.from, panel.to, i)));
        }
    }
    Integral {
        values,
        error,
        complete,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The integral over [0, 2] of something smooth.
    fn smooth(x: f64) -> f64 {
        math::exp(math::sin(3.0 * x)) + x * x
    }

    fn sum(nodes: &[Node], f: impl Fn(f64) -> f64) -> f64 {
        nodes.iter().map(|n| n.weight * f(n.at)).sum()
    }

    #[test]
    fn gauss_legendre_is_exact_to_its_degree() {
        for count in [1, 2, 3, 5, 8, 15, 40, 256] {
            let rule = gauss_legendre(count);
            assert!(rule.windows(2).all(|p| p[0].at < p[1].at));
            let total: f64 = rule.iter().map(|n| n.weight).sum();
            assert!((total - 2.0).abs() < 2e-13, "{count}: {total}");
            for power in 0..2 * count.min(20) {
                let exact = if power % 2 == 1 {
                    0.0
                } else {
                    2.0 / (power as f64 + 1.0)
                };
                let found = sum(&rule, |x| math::powi(x, power as u32));
                assert!((found - exact).abs() < 1e-13, "{count}, {power}");
            }
        }
    }

    #[test]
    fn a2_uniform_converges_at_the_second_order() {
        let exact = sum(
            &Sampling::GaussLegendre(60).nodes(&[0.0, 2.0]).unwrap(),
            smooth,
        );
        let error = |n: usize| {
            let nodes = Sampling::Uniform(n).nodes(&[0.0, 0.3, 2.0]).unwrap();
            (sum(&nodes, smooth) - exact).abs()
        };
        let mut last = error(40);
        for n in [80, 160, 320, 640] {
            let next = error(n);
            let ratio = last / next;
            assert!((3.6..4.4).contains(&ratio), "{n}: {ratio}");
            last = next;
        }
    }

    #[test]
    fn a2_gauss_legendre_converges_at_once() {
        let rule = |n| {
            sum(
                &Sampling::GaussLegendre(n).nodes(&[0.0, 2.0]).unwrap(),
                smooth,
            )
        };
        let exact = rule(80);
        assert!((rule(10) - exact).abs() < 1e-4);
        assert!((rule(20) - exact).abs() < 1e-9);
        assert!((rule(40) - exact).abs() < 1e-13);
    }

    #[test]
    fn a2_adaptive_meets_its_tolerance() {
        // A hat that hides in a corner of the panel, a kink, and something wavy.
        let f = |x: f64| {
            let hat = math::powi((1.0 - ((x - 1.7) / 0.2) * ((x - 1.7) / 0.2)).max(0.0), 2);
            [hat + 1e-3, (x - 0.77).abs(), math::sin(20.0 * x)]
        };
        let hat = 0.2 * 16.0 / 15.0 + 2e-3;
        let kink = 0.5 * (0.77 * 0.77 + 1.23 * 1.23);
        let waves = (1.0 - math::cos(40.0)) / 20.0;
        for tolerance in [1e-2, 1e-4, 1e-6, 1e-9] {
            let mut nodes = Vec::new();
            let panels = [(0.0, 1.0), (1.0, 2.0)].into_iter();
            let found = adaptive(panels, tolerance, &mut { f }, &mut nodes);
            assert!(found.complete);
            for (value, exact) in found.values.iter().zip([hat, kink, waves]) {
                assert!((value - exact).abs() <= tolerance * hat, "{tolerance}");
            }
            // The nodes give the same integrals.
            let again = sum(&nodes, |x| f(x)[0]);
            assert!((again - found.values[0]).abs() < 1e-14);
        }
        let mut nodes = Vec::new();
        let none = adaptive(core::iter::empty(), 1e-3, &mut |_| [1.0], &mut nodes);
        assert!(none.complete && none.values == [0.0] && nodes.is_empty());
        // What no panels resolve ends, and says so.
        let wild = adaptive(
            [(0.0, 1.0)].into_iter(),
            1e-12,
            &mut |x| {
                [if ((x * 1e9) as u64).is_multiple_of(2) {
                    1.0
                } else {
                    0.0
                }]
            },
            &mut nodes,
        );
        assert!(!wild.complete);
    }

    #[test]
    fn nonsense_is_brought_into_range() {
        assert!(!Sampling::Uniform(0).is_valid() && !Sampling::Adaptive(f64::NAN).is_valid());
        assert!(!Sampling::GaussLegendre(1000).is_valid() && Sampling::Nearest.is_valid());
        assert_eq!(Sampling::Uniform(0).nodes(&[0.0, 1.0]).unwrap().len(), 1);
        assert_eq!(Sampling::Uniform(9).nodes(&[1.0, 1.0]).unwrap(), []);
        assert_eq!(Sampling::Uniform(9).nodes(&[]).unwrap(), []);
        assert_eq!(Sampling::Nearest.nodes(&[0.0, 1.0]), None);
    }
}
