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
use core::marker::PhantomData;

/// A part of a cubic whose length is wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    /// Local parameters of its ends.
    pub from: f64,
    pub to: f64,
}

/// A whole cubic.
pub(crate) const WHOLE: Stretch = Stretch { from: 0.0, to: 1.0 };

/// The velocity by the local parameter: three coefficients for each axis.
#[derive(Clone, Copy)]
struct Velocity {
    axes: [[f64; 3]; 3],
}

/// The zeros of the squared speed with positive imaginary part, `(x, y)`; far away ones are brought to a bound.
#[derive(Clone, Copy, Default)]
struct Zeros([(f64, f64); 2]);

const FAR: f64 = 1e6;
/// Nodes of the rules. Halves are multiples of four: whole vectors.
const RULES: usize = 5;
const NODES: [u32; RULES] = [8, 16, 24, 32, 40];
static RULE_8: Rule<4> = Rule::new();
static RULE_16: Rule<8> = Rule::new();
static RULE_24: Rule<12> = Rule::new();
static RULE_32: Rule<16> = Rule::new();
static RULE_40: Rule<20> = Rule::new();

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

#[inline(always)]
fn product(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

#[inline(always)]
fn quotient(a: Complex, b: Complex) -> Complex {
    let per = 1.0 / (b.0 * b.0 + b.1 * b.1);
    ((a.0 * b.0 + a.1 * b.1) * per, (a.1 * b.0 - a.0 * b.1) * per)
}

/// A square root with non-negative real part. Without branches: it is computed for many at once.
#[inline(always)]
fn root(a: Complex) -> Complex {
    let larger =
        ((a.0 * a.0 + a.1 * a.1).sqrt() + a.0.abs()).sqrt() * core::f64::consts::FRAC_1_SQRT_2;
    let smaller = a.1.abs() / (2.0 * larger.max(f64::MIN_POSITIVE));
    let right = a.0 >= 0.0;
    let (x, y) = (
        if right { larger } else { smaller },
        if right { smaller } else { larger },
    );
    (x, if a.1 < 0.0 { -y } else { y })
}

/// Brings zeros at infinity, or nowhere, to a bound, and all to the upper half-plane.
#[inline(always)]
fn bounded(zero: Complex) -> Complex {
    let bound = |c: f64| if c.abs() < FAR { c } else { FAR };
    (bound(zero.0), bound(zero.1).abs())
}

/// Zeros of the velocity of a plane curve as a complex polynomial. The squared speed is its product with its conjugate.
#[inline(always)]
fn plane_zeros([x, y]: [[f64; 3]; 2]) -> [Complex; 2] {
    let (z0, z1, z2) = ((x[0], y[0]), (x[1], y[1]), (x[2], y[2]));
    let square = product(z1, z1);
    let fourth = product(z0, z2);
    let r = root((square.0 - 4.0 * fourth.0, square.1 - 4.0 * fourth.1));
    // The sum without cancellation; the other zero from the product of both.
    let same = z1.0 * r.0 + z1.1 * r.1 >= 0.0;
    let r = (if same { r.0 } else { -r.0 }, if same { r.1 } else { -r.1 });
    let w = (-0.5 * (z1.0 + r.0), -0.5 * (z1.1 + r.1));
    [bounded(quotient(z0, w)), bounded(quotient(w, z2))]
}

/// Curves whose zeros are computed together.
const LANES: usize = 8;

/// Zeros of plane curves, by coordinates of zeros: `[re, im, re, im]`.
#[inline(always)]
fn plane_zeros_of(x: &[[f64; LANES]; 3], y: &[[f64; LANES]; 3]) -> [[f64; LANES]; 4] {
    let mut out = [[0.0; LANES]; 4];
    for i in 0..LANES {
        let zeros = plane_zeros([[x[0][i], x[1][i], x[2][i]], [y[0][i], y[1][i], y[2][i]]]);
        out[0][i] = zeros[0].0;
        out[1][i] = zeros[0].1;
        out[2][i] = zeros[1].0;
        out[3][i] = zeros[1].1;
    }
    out
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
    let start = plane_zeros([axes[(least + 1) % 3], axes[(least + 2) % 3]]);
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
fn sum<const H: usize>(
    rule: &Rule<H>,
    velocity: &Velocity,
    dim: usize,
    middle: f64,
    half: f64,
) -> f64 {
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
    for i in 0..H {
        above[i] = rule.weights[i] * (above[i].sqrt() + below[i].sqrt());
    }
    let mut sums = [0.0; 4];
    for four in above.as_chunks::<4>().0 {
        for (sum, value) in sums.iter_mut().zip(four) {
            *sum += value;
        }
    }
    ((sums[0] + sums[1]) + (sums[2] + sums[3])) * half
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
    #[cfg(feature = "simd")]
    let level = anamorph_core::simd::Level::new();
    let mut parts = parts.enumerate().peekable();
    let mut plans: Vec<(usize, Stretch, Plan)> = Vec::with_capacity(BLOCK);
    let mut work = Work::default();
    while parts.peek().is_some() {
        plans.clear();
        for (index, (cubic, stretch)) in parts.by_ref().take(BLOCK) {
            plans.push((index, stretch, plan(cubic)));
        }
        #[cfg(feature = "simd")]
        anamorph_core::simd::dispatch!(level, _v => find_zeros::<S>(&mut plans));
        #[cfg(not(feature = "simd"))]
        find_zeros::<S>(&mut plans);
        work.clear();
        for (slot, (_, stretch, plan)) in plans.iter().enumerate() {
            let mut cuts = Cuts::new(*stretch, plan, accuracy);
            while let Some((rule, middle, half)) = cuts.next() {
                let stretch = slot;
                work.add(
                    rule,
                    Interval {
                        stretch,
                        middle,
                        half,
                    },
                );
            }
        }
        work.values.resize(work.intervals.len(), 0.0);
        #[cfg(feature = "simd")]
        anamorph_core::simd::dispatch!(level, _v => sums::<S>(&mut work, &plans, accuracy));
        #[cfg(not(feature = "simd"))]
        sums::<S>(&mut work, &plans, accuracy);
        for (at, value) in work.intervals.iter().zip(&work.values) {
            let (index, _, plan) = &plans[at.stretch];
            let (from, to) = (at.middle - at.half, at.middle + at.half);
            done(*index, from, to, value * plan.scale);
        }
    }
}

/// The intervals of a block, sorted by the rule they need: the processor then does not have to guess which comes next.
#[derive(Default)]
struct Work {
    intervals: Vec<Interval>,
    by_rule: [Vec<u32>; RULES + 1],
    values: Vec<f64>,
}

impl Work {
    fn clear(&mut self) {
        self.intervals.clear();
        self.values.clear();
        self.by_rule.iter_mut().for_each(Vec::clear);
    }

    fn add(&mut self, rule: usize, interval: Interval) {
        self.by_rule[rule.min(RULES)].push(self.intervals.len() as u32);
        self.intervals.push(interval);
    }
}

/// The sums of all intervals. The same operations in the same order for any width of vectors.
#[inline(always)]
fn sums<S: Space>(work: &mut Work, plans: &[(usize, Stretch, Plan)], accuracy: f64) {
    let Work {
        intervals,
        by_rule,
        values,
    } = work;
    let [first, second, third, fourth, fifth, unknown] = by_rule;
    let (intervals, values) = (&intervals[..], &mut values[..]);
    apply::<S, 4>(&RULE_8, first, intervals, plans, values);
    apply::<S, 8>(&RULE_16, second, intervals, plans, values);
    apply::<S, 12>(&RULE_24, third, intervals, plans, values);
    apply::<S, 16>(&RULE_32, fourth, intervals, plans, values);
    apply::<S, 20>(&RULE_40, fifth, intervals, plans, values);
    for &index in unknown.iter() {
        let at = &intervals[index as usize];
        let plan = &plans[at.stretch].2;
        values[index as usize] = by_trial(plan, at.middle, at.half, accuracy);
    }
}

/// The sums of the intervals that need one rule.
#[inline(always)]
fn apply<S: Space, const H: usize>(
    rule: &Rule<H>,
    which: &[u32],
    intervals: &[Interval],
    plans: &[(usize, Stretch, Plan)],
    values: &mut [f64],
) {
    for &index in which {
        let at = &intervals[index as usize];
        let velocity = &plans[at.stretch].2.velocity;
        values[index as usize] = sum(rule, velocity, S::DIM, at.middle, at.half);
    }
}

/// One cubic, prepared to measure parts of it one after the other.
pub(crate) struct Ruler<S> {
    plan: Plan,
    space: PhantomData<S>,
}

impl<S: Space> Ruler<S> {
    #[inline(always)]
    pub(crate) fn new(cubic: &Cubic<S>) -> Self {
        let mut plans = [(0, WHOLE, plan(cubic))];
        if S::DIM > 2 {
            find_zeros::<S>(&mut plans);
        } else {
            let [x, y, _] = plans[0].2.velocity.axes;
            plans[0].2.zeros = Zeros(plane_zeros([x, y]));
            plans[0].2.known = true;
        }
        Self {
            plan: plans[0].2,
            space: PhantomData,
        }
    }

    /// The intervals of a stretch, from left to right: its ends, and its length.
    #[inline(always)]
    pub(crate) fn intervals(&self, stretch: Stretch, accuracy: f64) -> Intervals<'_, S> {
        Intervals {
            cuts: Cuts::new(stretch, &self.plan, accuracy),
            accuracy,
            space: PhantomData,
        }
    }

    /// The speed at a parameter, and its derivative (0 where the speed is).
    #[inline(always)]
    pub(crate) fn motion(&self, x: f64) -> (f64, f64) {
        let (mut square, mut product) = (0.0, 0.0);
        for [a, b, c] in &self.plan.velocity.axes[..S::DIM] {
            let (v, dv) = (a + x * (b + x * c), b + 2.0 * x * c);
            square += v * v;
            product += v * dv;
        }
        let speed = square.sqrt();
        let change = if speed > 0.0 { product / speed } else { 0.0 };
        (speed * self.plan.scale, change * self.plan.scale)
    }

    /// The length of a stretch.
    #[inline(always)]
    pub(crate) fn length(&self, from: f64, to: f64, accuracy: f64) -> f64 {
        let mut intervals = self.intervals(Stretch { from, to }, accuracy);
        let mut sum = 0.0;
        while let Some((_, _, length)) = intervals.next() {
            sum += length;
        }
        sum
    }
}

/// The intervals of a stretch of one cubic.
pub(crate) struct Intervals<'a, S> {
    cuts: Cuts<'a>,
    accuracy: f64,
    space: PhantomData<S>,
}

impl<S: Space> Intervals<'_, S> {
    /// The next interval: from, to, length.
    #[inline(always)]
    pub(crate) fn next(&mut self) -> Option<(f64, f64, f64)> {
        let (rule, middle, half) = self.cuts.next()?;
        let (plan, dim) = (self.cuts.plan, S::DIM);
        let v = &plan.velocity;
        let length = match rule {
            0 => sum(&RULE_8, v, dim, middle, half),
            1 => sum(&RULE_16, v, dim, middle, half),
            2 => sum(&RULE_24, v, dim, middle, half),
            3 => sum(&RULE_32, v, dim, middle, half),
            4 => sum(&RULE_40, v, dim, middle, half),
            _ => by_trial(plan, middle, half, self.accuracy),
        };
        Some((middle - half, middle + half, length * plan.scale))
    }
}

/// The length of an interval whose zeros are not known.
fn by_trial(plan: &Plan, middle: f64, half: f64, accuracy: f64) -> f64 {
    let mut speed = |t: f64| {
        let squares = plan.velocity.axes.map(|[a, b, c]| {
            let v = a + t * (b + t * c);
            v * v
        });
        (squares[0] + squares[1] + squares[2]).sqrt()
    };
    let (from, to) = (middle - half, middle + half);
    super::gauss::adaptive(&mut speed, from, to, accuracy / plan.scale)
}

fn plan<S: Space>(cubic: &Cubic<S>) -> Plan {
    let velocity = Velocity::of(cubic);
    let size = velocity.size();
    let (velocity, scale) = if size > 1e-100 && size < 1e100 || size == 0.0 {
        (velocity, 1.0)
    } else {
        (velocity.times(1.0 / size), size)
    };
    Plan {
        velocity,
        scale,
        size,
        zeros: Zeros::default(),
        known: false,
    }
}

/// Finds the zeros of all plans.
#[inline(always)]
fn find_zeros<S: Space>(plans: &mut [(usize, Stretch, Plan)]) {
    if S::DIM > 2 {
        for (_, _, plan) in plans {
            let found = space_zeros(&plan.velocity);
            plan.zeros = Zeros(found.unwrap_or_default());
            plan.known = found.is_some();
        }
        return;
    }
    for some in plans.chunks_mut(LANES) {
        let (mut x, mut y) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for (lane, (_, _, plan)) in some.iter().enumerate() {
            for k in 0..3 {
                x[k][lane] = plan.velocity.axes[0][k];
                y[k][lane] = plan.velocity.axes[1][k];
            }
        }
        let [a, b, c, d] = plane_zeros_of(&x, &y);
        for (lane, (_, _, plan)) in some.iter_mut().enumerate() {
            plan.zeros = Zeros([(a[lane], b[lane]), (c[lane], d[lane])]);
            plan.known = true;
        }
    }
}

/// Digits added to the demand: rules that were tried on a million random and adverse cubics erred by at most a fifth of the
/// accuracy with it.
const MARGIN: i64 = -4;

/// Intervals that wait at once at most.
const HEIGHT: usize = 48;

/// The intervals of a stretch with their rules, from left to right. (Methods, not closures: those would not be compiled for
/// the vectors of their caller.)
struct Cuts<'a> {
    plan: &'a Plan,
    demand: &'a Demand,
    /// The square of the height below which a zero is one on the axis: its corner is rounded by less than matters.
    sharp: f64,
    stack: [(f64, f64); HEIGHT],
    height: usize,
    count: usize,
}

impl<'a> Cuts<'a> {
    #[inline(always)]
    fn new(stretch: Stretch, plan: &'a Plan, accuracy: f64) -> Self {
        // The exponent of size/accuracy, rounded up.
        let digits = ((plan.size / accuracy).to_bits() >> 52) as i64 - 1022 + MARGIN;
        let mut stack = [(0.0, 0.0); HEIGHT];
        stack[0] = (stretch.from, stretch.to);
        Self {
            plan,
            demand: &DEMANDS[digits.clamp(1, DIGITS as i64 - 1) as usize],
            sharp: 1e-2 * accuracy / plan.size,
            stack,
            height: 1,
            count: 0,
        }
    }

    /// The next interval: rule, middle, half. The rule is a number beyond the table where zeros are not known.
    #[inline(always)]
    fn next(&mut self) -> Option<(usize, f64, f64)> {
        while self.height > 0 {
            self.height -= 1;
            let (a, b) = self.stack[self.height];
            let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
            let square = half * half;
            if self.plan.size == 0.0 || half.is_nan() || half <= 0.0 {
                return Some((0, middle, half));
            }
            if !self.plan.known {
                return Some((RULES, middle, half));
            }
            let zeros = &self.plan.zeros.0;
            let (first, second) = (
                self.distance(zeros[0], middle, square),
                self.distance(zeros[1], middle, square),
            );
            let nearest = first.min(second);
            let at = if nearest >= square || half < 1e-14 {
                a
            } else {
                self.place(zeros[usize::from(second < first)], a, b)
            };
            // Also where numbers are too coarse to cut, or cuts too many, the largest rule must do.
            let inside = at > a && at < b;
            if !inside || self.height + 2 > HEIGHT || self.count >= MOST {
                let mut rule = 0;
                for limit in &self.demand.smaller {
                    rule += usize::from(nearest < limit * square);
                }
                self.count += 1;
                return Some((rule, middle, half));
            }
            self.stack[self.height] = (at, b);
            self.stack[self.height + 1] = (a, at);
            self.height += 2;
        }
        None
    }

    /// How far a zero is from an interval: at least `square` where it lies outside the largest rule's ellipse.
    #[inline(always)]
    fn distance(&self, (x, y): Complex, middle: f64, square: f64) -> f64 {
        let (dx, yy) = ((x - middle) * (x - middle), y * y);
        // A corner at an end harms neither side.
        if yy < self.sharp && (dx - square).abs() <= 1e-12 * square {
            f64::MAX
        } else {
            dx * self.demand.wide + yy * self.demand.high
        }
    }

    /// Where to cut the interval from `a` to `b` because of a zero.
    #[inline(always)]
    fn place(&self, (x, y): Complex, a: f64, b: f64) -> f64 {
        let (middle, width) = (0.5 * (a + b), b - a);
        let inside = x > a && x < b;
        let well_inside = x > a + 0.05 * width && x < b - 0.05 * width;
        if inside && (y * y < self.sharp || well_inside) {
            return x;
        }
        let edge = x.clamp(a, b);
        let distance = y + (x - edge).abs();
        let reach = (distance * self.demand.reach).clamp(1e-4 * width, 0.5 * width);
        if edge < middle {
            (edge + reach).min(middle)
        } else {
            (edge - reach).max(middle)
        }
    }
}
