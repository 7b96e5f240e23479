//! Arc lengths of cubics to a tolerance, without trial and error.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Reparameterizing by arc length – quadrature"; L. N. Trefethen,
//! *Is Gauss quadrature better than Clenshaw–Curtis?*, SIAM Review 50(1), 2008, theorem 4.5. The speed of a cubic is the
//! root of a polynomial of degree 4, analytic but at its zeros. On an interval mapped to `[−1, 1]`, Gauss' rule with `n` nodes errs
//! by a multiple of `ρ^(−2n)`, `ρ` the sum of the half-axes of the largest ellipse with foci ±1 that holds no zero. In the
//! plane the zeros are those of a quadratic with complex coefficients, in closed form; in space they are found from these by
//! Bairstow's method. So the rule that an interval needs is *known*: it is used, or the interval is cut at the point next
//! to the nearest zero, or as far from it as the largest rule reaches. A real zero (a cusp) is a corner of the speed; cut
//! there, both sides are smooth.
//!
//! The work is done in three passes over many intervals: zeros, cuts, sums. Within a pass nothing waits for the last
//! result, which for short computations counts more than their number.

use super::gauss::Rule;
use crate::Cubic;
use anamorph_core::Space;

/// A part of a cubic whose length is wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    /// Local parameters of its ends.
    pub from: f64,
    pub to: f64,
}

/// The velocity by the local parameter: three coefficients for each axis.
#[derive(Clone, Copy)]
struct Velocity {
    axes: [[f64; 3]; 3],
}

/// The zeros of the squared speed with positive imaginary part, `(x, y)`; far away ones are brought to a bound.
#[derive(Clone, Copy, Default)]
struct Zeros([(f64, f64); 2]);

const FAR: f64 = 1e6;
/// Half the nodes of the rules: 6, 8, 12, 16, 20, 24, 30, 36.
const RULES: usize = 8;
const NODES: [u32; RULES] = [6, 8, 12, 16, 20, 24, 30, 36];
static RULE_6: Rule<3> = Rule::new();
static RULE_8: Rule<4> = Rule::new();
static RULE_12: Rule<6> = Rule::new();
static RULE_16: Rule<8> = Rule::new();
static RULE_20: Rule<10> = Rule::new();
static RULE_24: Rule<12> = Rule::new();
static RULE_30: Rule<15> = Rule::new();
static RULE_36: Rule<18> = Rule::new();

/// What decides, for a demanded number of binary digits.
#[derive(Clone, Copy)]
struct Demand {
    /// Inverse squares of the half-axes of the ellipse that the largest rule needs.
    wide: f64,
    high: f64,
    /// A zero at least this far beyond the largest rule's ellipse allows a smaller rule; by rule.
    smaller: [f64; RULES - 1],
    /// Width that the largest rule covers beside a zero, in units of the zero's distance.
    reach: f64,
}

/// Binary digits the table goes to: 2⁶² is beyond what `f64` can tell.
const DIGITS: usize = 63;

/// Half-axes of the ellipse with `ρ^(2n) = 2^digits`, squared: `(c², c² − 1)`.
const fn ellipse(nodes: u32, digits: usize) -> (f64, f64) {
    let target = (1_u64 << digits) as f64;
    let (mut low, mut high) = (1.0, 4096.0);
    let mut step = 0;
    while step < 64 {
        let middle = 0.5 * (low + high);
        let (mut power, mut base, mut exponent) = (1.0, middle, 2 * nodes);
        while exponent > 0 {
            if exponent & 1 == 1 {
                power *= base;
            }
            base *= base;
            exponent >>= 1;
        }
        if power < target {
            low = middle;
        } else {
            high = middle;
        }
        step += 1;
    }
    let wide = 0.5 * (high + 1.0 / high);
    let high = 0.5 * (high - 1.0 / high);
    (wide * wide, high * high)
}

static DEMANDS: [Demand; DIGITS] = {
    let mut table = [Demand {
        wide: 1.0,
        high: 1.0,
        smaller: [0.0; RULES - 1],
        reach: 1.0,
    }; DIGITS];
    let mut digits = 1;
    while digits < DIGITS {
        let (wide, high) = ellipse(NODES[RULES - 1], digits);
        let mut smaller = [0.0; RULES - 1];
        let mut rule = 0;
        while rule < RULES - 1 {
            // The least of what a zero on the smaller rule's ellipse can have.
            smaller[rule] = ellipse(NODES[rule], digits).1 / high;
            rule += 1;
        }
        // c − 1 = (c² − 1)/(c + 1), c near 1.
        table[digits] = Demand {
            wide: 1.0 / wide,
            high: 1.0 / high,
            smaller,
            reach: 2.2 / (wide - 1.0),
        };
        digits += 1;
    }
    table
};

impl Velocity {
    fn of<S: Space>(cubic: &Cubic<S>) -> Self {
        let [_, b, c, d] = cubic.0;
        let mut axes = [[0.0; 3]; 3];
        for (axis, a) in axes.iter_mut().enumerate().take(S::DIM) {
            *a = [
                b.component(axis),
                2.0 * c.component(axis),
                3.0 * d.component(axis),
            ];
        }
        Self { axes }
    }

    /// The sum of the magnitudes of its coefficients: a bound of the speed on `[0, 1]`.
    fn size(&self) -> f64 {
        let axes = self.axes.iter();
        axes.map(|a| a[0].abs() + a[1].abs() + a[2].abs()).sum()
    }

    /// Multiplied so that squares neither overflow nor vanish.
    fn times(&self, factor: f64) -> Self {
        Self {
            axes: self.axes.map(|axis| axis.map(|c| c * factor)),
        }
    }
}

type Complex = (f64, f64);

fn product(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

fn quotient(a: Complex, b: Complex) -> Complex {
    let per = 1.0 / (b.0 * b.0 + b.1 * b.1);
    ((a.0 * b.0 + a.1 * b.1) * per, (a.1 * b.0 - a.0 * b.1) * per)
}

fn root(a: Complex) -> Complex {
    let larger =
        ((a.0 * a.0 + a.1 * a.1).sqrt() + a.0.abs()).sqrt() * core::f64::consts::FRAC_1_SQRT_2;
    if larger == 0.0 {
        return (0.0, 0.0);
    }
    let smaller = a.1 / (2.0 * larger);
    if a.0 >= 0.0 {
        (larger, smaller)
    } else {
        (smaller.abs(), if a.1 < 0.0 { -larger } else { larger })
    }
}

/// Brings zeros at infinity, or nowhere, to a bound, and all to the upper half-plane.
fn bounded(zero: Complex) -> Complex {
    let bound = |c: f64| if c.abs() < FAR { c } else { FAR };
    (bound(zero.0), bound(zero.1).abs())
}

/// Zeros of the velocity of a plane curve as a complex polynomial. The squared speed is its product with its conjugate.
fn plane_zeros([x, y]: [[f64; 3]; 2]) -> [Complex; 2] {
    let [z0, z1, z2] = core::array::from_fn(|k| (x[k], y[k]));
    let square = product(z1, z1);
    let fourth = product(z0, z2);
    let r = root((square.0 - 4.0 * fourth.0, square.1 - 4.0 * fourth.1));
    // The sum without cancellation; the other zero from the product of both.
    let sign = if z1.0 * r.0 + z1.1 * r.1 >= 0.0 {
        1.0
    } else {
        -1.0
    };
    let w = (-0.5 * (z1.0 + sign * r.0), -0.5 * (z1.1 + sign * r.1));
    [quotient(z0, w), quotient(w, z2)]
}

/// Steps of Bairstow's method; from a good start three to six are enough.
const BAIRSTOW: usize = 24;

/// Zeros of the squared speed of a space curve, from those of its projection along the axis that matters least: one pair of
/// conjugate zeros as a quadratic factor by Bairstow's method (which, unlike zeros themselves, is well determined also where
/// both are nearly real), the other from the quotient. `None` where the method did not settle.
fn space_zeros(velocity: &Velocity) -> Option<[Complex; 2]> {
    let axes = &velocity.axes;
    let weight = |a: &[f64; 3]| a[0].abs() + a[1].abs() + a[2].abs();
    let least = (0..3).min_by(|i, j| weight(&axes[*i]).total_cmp(&weight(&axes[*j])))?;
    let start = plane_zeros([axes[(least + 1) % 3], axes[(least + 2) % 3]]).map(bounded);
    if weight(&axes[least]) == 0.0 {
        return Some(start);
    }
    // Coefficients of the squared speed.
    let mut q = [0.0; 5];
    for [a, b, c] in axes {
        q[0] += a * a;
        q[1] += 2.0 * a * b;
        q[2] += b * b + 2.0 * a * c;
        q[3] += 2.0 * b * c;
        q[4] += c * c;
    }
    let size = q.iter().map(|c| c.abs()).sum::<f64>();
    // The pair nearer to the curve: it matters more, and is known better.
    let off = |z: &Complex| (z.0 - 0.5).abs() + z.1;
    let (x, y) = if off(&start[0]) <= off(&start[1]) {
        start[0]
    } else {
        start[1]
    };
    let (mut p, mut r) = (-2.0 * x, x * x + y * y);
    for _ in 0..BAIRSTOW {
        let (b1, b0) = (q[3] - p * q[4], q[2] - p * (q[3] - p * q[4]) - r * q[4]);
        let (r1, r0) = (q[1] - p * b0 - r * b1, q[0] - r * b0);
        let (c1, c0) = (b1 - p * q[4], b0 - r * q[4]);
        if (r1.abs() + r0.abs()) <= 1e-14 * size * (1.0 + p.abs() + r.abs()) {
            let pair = |half: f64, product: f64| {
                let square = product - half * half;
                bounded((half, square.max(0.0).sqrt()))
            };
            return Some([pair(-0.5 * p, r), pair(-0.5 * b1 / q[4], b0 / q[4])]);
        }
        // Derivatives of the remainder by p and r.
        let (r1p, r1r, r0p, r0r) = (p * c1 - c0, -c1, r * c1, -c0);
        let determinant = r1p * r0r - r1r * r0p;
        let (dp, dr) = (
            (r1r * r0 - r0r * r1) / determinant,
            (r0p * r1 - r1p * r0) / determinant,
        );
        p += dp;
        r += dr;
        if !(p.abs() < 1e12 && r.abs() < 1e12) {
            return None;
        }
    }
    None
}

/// One interval whose rule is known.
#[derive(Clone, Copy)]
struct Interval {
    /// Which stretch it belongs to.
    stretch: usize,
    middle: f64,
    half: f64,
}

/// Intervals of one stretch at most: a cusp in the finest demand needs about 30.
const MOST: usize = 256;

/// Sums a rule over an interval, by its nodes in pairs about the middle.
#[inline(always)]
fn sum<const H: usize>(rule: &Rule<H>, velocity: &Velocity, dim: usize, at: &Interval) -> f64 {
    let (middle, half) = (at.middle, at.half);
    let (mut above, mut below) = ([0.0; H], [0.0; H]);
    for [a, b, c] in &velocity.axes[..dim] {
        let (v, dv) = (a + middle * (b + middle * c), (b + 2.0 * middle * c) * half);
        let ddv = c * half * half;
        for i in 0..H {
            let x = rule.nodes[i];
            let (even, odd) = (v + ddv * (x * x), dv * x);
            above[i] += (even + odd) * (even + odd);
            below[i] += (even - odd) * (even - odd);
        }
    }
    let mut sums = [0.0; 2];
    for i in 0..H {
        sums[i % 2] += rule.weights[i] * (above[i].sqrt() + below[i].sqrt());
    }
    (sums[0] + sums[1]) * half
}

/// Stretches worked on together.
const BLOCK: usize = 64;

/// What is known of a stretch while a block is worked on.
#[derive(Clone, Copy)]
struct Plan {
    velocity: Velocity,
    /// What lengths must be multiplied by: velocities are brought to about 1.
    scale: f64,
    size: f64,
    zeros: Zeros,
    /// Whether zeros are known.
    known: bool,
}

/// Lengths of stretches of cubics, each to `accuracy` (absolute, at least 1e-15 of its size), in order. `done(stretch,
/// from, to, length)` is told each interval's length, from left to right within a stretch.
pub(crate) fn lengths<'a, S: Space>(
    parts: impl Iterator<Item = (&'a Cubic<S>, Stretch)>,
    accuracy: f64,
    mut done: impl FnMut(usize, f64, f64, f64),
) {
    let mut parts = parts.enumerate().peekable();
    let mut plans: Vec<(usize, Stretch, Plan)> = Vec::with_capacity(BLOCK);
    let mut intervals: Vec<(u8, Interval)> = Vec::with_capacity(4 * BLOCK);
    let mut values: Vec<f64> = Vec::with_capacity(4 * BLOCK);
    while parts.peek().is_some() {
        plans.clear();
        for (index, (cubic, stretch)) in parts.by_ref().take(BLOCK) {
            plans.push((index, stretch, plan(cubic)));
        }
        intervals.clear();
        for (slot, (_, stretch, plan)) in plans.iter().enumerate() {
            cut(slot, *stretch, plan, accuracy, &mut intervals);
        }
        values.clear();
        #[cfg(feature = "simd")]
        {
            let level = anamorph_core::simd::Level::new();
            anamorph_core::simd::dispatch!(level, _v => sums::<S>(&intervals, &plans, accuracy, &mut values));
        }
        #[cfg(not(feature = "simd"))]
        sums::<S>(&intervals, &plans, accuracy, &mut values);
        for ((_, at), value) in intervals.iter().zip(&values) {
            let (index, _, plan) = &plans[at.stretch];
            done(
                *index,
                at.middle - at.half,
                at.middle + at.half,
                value * plan.scale,
            );
        }
    }
}

/// The sums of all intervals. The same operations in the same order for any width of vectors.
#[inline(always)]
fn sums<S: Space>(
    intervals: &[(u8, Interval)],
    plans: &[(usize, Stretch, Plan)],
    accuracy: f64,
    values: &mut Vec<f64>,
) {
    let dim = S::DIM;
    for (rule, at) in intervals {
        let v = &plans[at.stretch].2.velocity;
        values.push(match rule {
            0 => sum(&RULE_6, v, dim, at),
            1 => sum(&RULE_8, v, dim, at),
            2 => sum(&RULE_12, v, dim, at),
            3 => sum(&RULE_16, v, dim, at),
            4 => sum(&RULE_20, v, dim, at),
            5 => sum(&RULE_24, v, dim, at),
            6 => sum(&RULE_30, v, dim, at),
            7 => sum(&RULE_36, v, dim, at),
            _ => by_trial(v, at, accuracy / plans[at.stretch].2.scale),
        });
    }
}

/// The length of an interval whose zeros are not known.
fn by_trial(velocity: &Velocity, at: &Interval, accuracy: f64) -> f64 {
    let mut speed = |t: f64| {
        let squares = velocity.axes.map(|[a, b, c]| {
            let v = a + t * (b + t * c);
            v * v
        });
        (squares[0] + squares[1] + squares[2]).sqrt()
    };
    super::gauss::adaptive(
        &mut speed,
        at.middle - at.half,
        at.middle + at.half,
        accuracy,
    )
}

fn plan<S: Space>(cubic: &Cubic<S>) -> Plan {
    let velocity = Velocity::of(cubic);
    let size = velocity.size();
    let (velocity, scale) = if size > 1e-100 && size < 1e100 || size == 0.0 {
        (velocity, 1.0)
    } else {
        (velocity.times(1.0 / size), size)
    };
    let found = if S::DIM == 2 {
        Some(plane_zeros([velocity.axes[0], velocity.axes[1]]))
    } else {
        space_zeros(&velocity)
    };
    Plan {
        velocity,
        scale,
        size,
        zeros: Zeros(found.unwrap_or_default().map(bounded)),
        known: found.is_some(),
    }
}

/// Digits added to the demand: rules that were tried on a million random and adverse cubics erred by at most a tenth of the
/// accuracy with it.
const MARGIN: i64 = -3;

/// Cuts a stretch into intervals with rules, from left to right.
fn cut(slot: usize, stretch: Stretch, plan: &Plan, accuracy: f64, out: &mut Vec<(u8, Interval)>) {
    let whole = Interval {
        stretch: slot,
        middle: 0.5 * (stretch.from + stretch.to),
        half: 0.5 * (stretch.to - stretch.from),
    };
    if plan.size == 0.0 || whole.half <= 0.0 {
        out.push((0, whole));
        return;
    }
    if !plan.known {
        out.push((u8::MAX, whole));
        return;
    }
    // The exponent of size/accuracy, rounded up.
    let digits = ((plan.size / accuracy).to_bits() >> 52) as i64 - 1022 + MARGIN;
    let demand = &DEMANDS[digits.clamp(1, DIGITS as i64 - 1) as usize];
    // A zero whose corner is rounded by less than matters is one on the axis.
    let sharp = 1e-2 * accuracy / plan.size;
    let zeros = &plan.zeros.0;
    let mut stack = [(0.0, 0.0); 64];
    stack[0] = (stretch.from, stretch.to);
    let mut height = 1;
    let start = out.len();
    while height > 0 {
        height -= 1;
        let (a, b) = stack[height];
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        let square = half * half;
        let far = |&(x, y): &Complex| {
            let (dx, yy) = ((x - middle) * (x - middle), y * y);
            // A corner at an end harms neither side.
            if yy < sharp && (dx - square).abs() <= 1e-12 * square {
                f64::MAX
            } else {
                dx * demand.wide + yy * demand.high
            }
        };
        let (first, second) = (far(&zeros[0]), far(&zeros[1]));
        let nearest = first.min(second);
        let full = height + 2 > stack.len() || out.len() - start >= MOST;
        if nearest >= square || half < 1e-14 || full {
            let distance = nearest / square;
            let above = demand.smaller.iter().filter(|limit| distance < **limit);
            let rule = above.count() as u8;
            out.push((
                rule,
                Interval {
                    stretch: slot,
                    middle,
                    half,
                },
            ));
            continue;
        }
        let (x, y) = zeros[usize::from(second < first)];
        let width = b - a;
        let inside = x > a && x < b;
        let at = if inside && (y * y < sharp || (x > a + 0.05 * width && x < b - 0.05 * width)) {
            x
        } else {
            let edge = x.clamp(a, b);
            let distance = y + (x - edge).abs();
            let reach = (distance * demand.reach).clamp(1e-4 * width, 0.5 * width);
            if edge < middle {
                (edge + reach).min(middle)
            } else {
                (edge - reach).max(middle)
            }
        };
        stack[height] = (at, b);
        stack[height + 1] = (a, at);
        height += 2;
    }
}
