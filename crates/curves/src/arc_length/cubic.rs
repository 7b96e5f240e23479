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
use super::zeros::{Complex, LANES, plane_zeros, plane_zeros_of, space_zeros};
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
pub(super) struct Velocity {
    pub(super) axes: [[f64; 3]; 3],
}

/// The zeros of the squared speed with positive imaginary part, `(x, y)`; far away ones are brought to a bound.
#[derive(Clone, Copy, Default)]
struct Zeros([(f64, f64); 2]);

/// Nodes of the rules: whole vectors.
const RULES: usize = 5;
const NODES: [u32; RULES] = [8, 16, 24, 32, 40];
static RULE_8: Nodes<1> = Nodes::new(&Rule::<4>::new());
static RULE_16: Nodes<2> = Nodes::new(&Rule::<8>::new());
static RULE_24: Nodes<3> = Nodes::new(&Rule::<12>::new());
static RULE_32: Nodes<4> = Nodes::new(&Rule::<16>::new());
static RULE_40: Nodes<5> = Nodes::new(&Rule::<20>::new());

/// A rule of `8·V` nodes, in vectors.
struct Nodes<const V: usize> {
    nodes: [[f64; LANES]; V],
    weights: [[f64; LANES]; V],
}

impl<const V: usize> Nodes<V> {
    /// Both signs of the nodes of a rule of `4·V` pairs.
    const fn new<const H: usize>(rule: &Rule<H>) -> Self {
        let mut all = Self {
            nodes: [[0.0; LANES]; V],
            weights: [[0.0; LANES]; V],
        };
        let mut i = 0;
        while i < H {
            let at = 2 * i;
            let (row, lane) = (at / LANES, at % LANES);
            all.nodes[row][lane] = -rule.nodes[i];
            all.nodes[row][lane + 1] = rule.nodes[i];
            all.weights[row][lane] = rule.weights[i];
            all.weights[row][lane + 1] = rule.weights[i];
            i += 1;
        }
        all
    }
}

/// The vectors of a processor, or none.
#[cfg(feature = "simd")]
pub(crate) use anamorph_core::simd::Simd as Vectors;

/// The vectors of a processor, or none.
#[cfg(not(feature = "simd"))]
pub(crate) trait Vectors: Copy {}
#[cfg(not(feature = "simd"))]
impl Vectors for () {}

/// Runs an expression with the widest vectors of the processor.
macro_rules! with_vectors {
    ($name:ident => $run:expr) => {{
        #[cfg(feature = "simd")]
        {
            let level = anamorph_core::simd::Level::new();
            anamorph_core::simd::dispatch!(level, $name => $run)
        }
        #[cfg(not(feature = "simd"))]
        {
            let $name = ();
            $run
        }
    }};
}
pub(crate) use with_vectors;

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

/// One interval whose rule is known.
#[derive(Clone, Copy)]
pub(super) struct Interval {
    /// Which stretch it belongs to.
    pub(super) stretch: usize,
    pub(super) middle: f64,
    pub(super) half: f64,
}

/// Intervals of one stretch at most: a cusp in the finest demand needs about 30.
const MOST: usize = 256;

/// Sums a rule over an interval: the same operations in the same order for any width of vectors.
#[inline(always)]
fn sum<T: Vectors, const V: usize>(
    vectors: T,
    rule: &Nodes<V>,
    velocity: &Velocity,
    dim: usize,
    middle: f64,
    half: f64,
) -> f64 {
    let mut axes = [[0.0; 3]; 3];
    for (local, [a, b, c]) in axes.iter_mut().zip(&velocity.axes[..dim]) {
        *local = [
            a + middle * (b + middle * c),
            (b + 2.0 * middle * c) * half,
            c * half * half,
        ];
    }
    let s = weighted(vectors, rule, &axes[..dim]);
    ((s[0] + s[4]) + (s[2] + s[6]) + ((s[1] + s[5]) + (s[3] + s[7]))) * half
}

/// Sums of weighted speeds, lane by lane.
#[cfg(feature = "simd")]
#[inline(always)]
fn weighted<T: Vectors, const V: usize>(
    vectors: T,
    rule: &Nodes<V>,
    axes: &[[f64; 3]],
) -> [f64; LANES] {
    use anamorph_core::simd::{f64x8, prelude::*};
    let mut sums = f64x8::splat(vectors, 0.0);
    for (nodes, weights) in rule.nodes.iter().zip(&rule.weights) {
        let (x, w) = (
            f64x8::simd_from(vectors, *nodes),
            f64x8::simd_from(vectors, *weights),
        );
        let mut square = f64x8::splat(vectors, 0.0);
        for &[a, b, c] in axes {
            let v = x * (x * c + b) + a;
            square += v * v;
        }
        sums += w * square.sqrt();
    }
    sums.into()
}

/// Sums of weighted speeds, lane by lane.
#[cfg(not(feature = "simd"))]
#[inline(always)]
fn weighted<T: Vectors, const V: usize>(_: T, rule: &Nodes<V>, axes: &[[f64; 3]]) -> [f64; LANES] {
    let mut sums = [0.0; LANES];
    for (nodes, weights) in rule.nodes.iter().zip(&rule.weights) {
        for (lane, sum) in sums.iter_mut().enumerate() {
            let x = nodes[lane];
            let mut square = 0.0;
            for &[a, b, c] in axes {
                let v = x * (x * c + b) + a;
                square += v * v;
            }
            *sum += weights[lane] * f64::sqrt(square);
        }
    }
    sums
}

/// Stretches worked on together.
pub(super) const BLOCK: usize = 64;

/// What is known of a stretch while a block is worked on.
#[derive(Clone, Copy)]
pub(super) struct Plan {
    pub(super) velocity: Velocity,
    /// What lengths must be multiplied by: velocities are brought to about 1.
    pub(super) scale: f64,
    size: f64,
    zeros: Zeros,
    /// Whether zeros are known.
    known: bool,
}

impl Plan {
    /// The speed at a parameter, and its first three derivatives; not finite where the speed is 0.
    #[inline(always)]
    pub(super) fn speeds(&self, dim: usize, x: f64) -> [f64; 4] {
        // The squared speed and halves of its derivatives.
        let mut half = [0.0; 4];
        for [a, b, c] in &self.velocity.axes[..dim] {
            let (v, dv, ddv) = (a + x * (b + x * c), b + 2.0 * x * c, 2.0 * c);
            half[0] += v * v;
            half[1] += v * dv;
            half[2] += dv * dv + v * ddv;
            half[3] += 3.0 * dv * ddv;
        }
        let speed = half[0].sqrt();
        let slowness = 1.0 / speed;
        let first = half[1] * slowness;
        let second = (half[2] - first * first) * slowness;
        let third = (half[3] - 3.0 * first * second) * slowness;
        [speed, first, second, third].map(|s| s * self.scale)
    }
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
    let mut work = Work::default();
    let mut waiting: Waiting = [(0.0, 0.0); HEIGHT];
    while parts.peek().is_some() {
        plans.clear();
        for (index, (cubic, stretch)) in parts.by_ref().take(BLOCK) {
            plans.push((index, stretch, plan(cubic)));
        }
        with_vectors!(_vectors => find_zeros::<S>(&mut plans));
        work.clear();
        for (slot, (_, stretch, plan)) in plans.iter().enumerate() {
            let mut cuts = Cuts::new(*stretch, plan, accuracy);
            while let Some((rule, middle, half)) = cuts.next(&mut waiting) {
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
        with_vectors!(vectors => sums::<S, _>(vectors, &mut work, &plans, accuracy));
        for (at, value) in work.intervals.iter().zip(&work.values) {
            let (index, _, plan) = &plans[at.stretch];
            let (from, to) = (at.middle - at.half, at.middle + at.half);
            done(*index, from, to, value * plan.scale);
        }
    }
}

/// The intervals of a block, sorted by the rule they need: the processor then does not have to guess which comes next.
#[derive(Default)]
pub(super) struct Work {
    pub(super) intervals: Vec<Interval>,
    by_rule: [Vec<u32>; RULES + 1],
    pub(super) values: Vec<f64>,
}

impl Work {
    pub(super) fn clear(&mut self) {
        self.intervals.clear();
        self.values.clear();
        self.by_rule.iter_mut().for_each(Vec::clear);
    }

    pub(super) fn add(&mut self, rule: usize, interval: Interval) {
        self.by_rule[rule.min(RULES)].push(self.intervals.len() as u32);
        self.intervals.push(interval);
    }
}

/// The sums of all intervals. The same operations in the same order for any width of vectors.
#[inline(always)]
pub(super) fn sums<S: Space, T: Vectors>(
    vectors: T,
    work: &mut Work,
    plans: &[(usize, Stretch, Plan)],
    accuracy: f64,
) {
    let Work {
        intervals,
        by_rule,
        values,
    } = work;
    let [first, second, third, fourth, fifth, unknown] = by_rule;
    values.resize(intervals.len(), 0.0);
    let (intervals, values) = (&intervals[..], &mut values[..]);
    apply::<S, _, 1>(vectors, &RULE_8, first, intervals, plans, values);
    apply::<S, _, 2>(vectors, &RULE_16, second, intervals, plans, values);
    apply::<S, _, 3>(vectors, &RULE_24, third, intervals, plans, values);
    apply::<S, _, 4>(vectors, &RULE_32, fourth, intervals, plans, values);
    apply::<S, _, 5>(vectors, &RULE_40, fifth, intervals, plans, values);
    for &index in unknown.iter() {
        let at = &intervals[index as usize];
        let plan = &plans[at.stretch].2;
        values[index as usize] = by_trial(plan, at.middle, at.half, accuracy);
    }
}

/// The sums of the intervals that need one rule.
#[inline(always)]
fn apply<S: Space, T: Vectors, const V: usize>(
    vectors: T,
    rule: &Nodes<V>,
    which: &[u32],
    intervals: &[Interval],
    plans: &[(usize, Stretch, Plan)],
    values: &mut [f64],
) {
    for &index in which {
        let at = &intervals[index as usize];
        let velocity = &plans[at.stretch].2.velocity;
        values[index as usize] = sum(vectors, rule, velocity, S::DIM, at.middle, at.half);
    }
}

/// One cubic, prepared to measure parts of it one after the other.
pub(crate) struct Ruler<S> {
    plan: Plan,
    waiting: Waiting,
    space: PhantomData<S>,
}

impl<S: Space> Ruler<S> {
    #[inline(always)]
    pub(crate) fn new(cubic: &Cubic<S>) -> Self {
        let mut plan = plan(cubic);
        find_own_zeros::<S>(&mut plan);
        Self {
            plan,
            waiting: [(0.0, 0.0); HEIGHT],
            space: PhantomData,
        }
    }

    /// The intervals of a stretch, from left to right: its ends, and its length.
    #[inline(always)]
    pub(crate) fn intervals(&mut self, stretch: Stretch, accuracy: f64) -> Intervals<'_, S> {
        Intervals {
            cuts: Cuts::new(stretch, &self.plan, accuracy),
            waiting: &mut self.waiting,
            accuracy,
            space: PhantomData,
        }
    }

    /// The length of a stretch.
    #[inline(always)]
    pub(crate) fn length<T: Vectors>(
        &mut self,
        vectors: T,
        from: f64,
        to: f64,
        accuracy: f64,
    ) -> f64 {
        let mut intervals = self.intervals(Stretch { from, to }, accuracy);
        let mut sum = 0.0;
        while let Some((_, _, length)) = intervals.next(vectors) {
            sum += length;
        }
        sum
    }
}

/// The sum of one interval by the rule of that number.
#[inline(always)]
pub(super) fn apply_one<S: Space, T: Vectors>(
    vectors: T,
    plan: &Plan,
    rule: usize,
    middle: f64,
    half: f64,
    accuracy: f64,
) -> f64 {
    let (v, dim) = (&plan.velocity, S::DIM);
    match rule {
        0 => sum(vectors, &RULE_8, v, dim, middle, half),
        1 => sum(vectors, &RULE_16, v, dim, middle, half),
        2 => sum(vectors, &RULE_24, v, dim, middle, half),
        3 => sum(vectors, &RULE_32, v, dim, middle, half),
        4 => sum(vectors, &RULE_40, v, dim, middle, half),
        _ => by_trial(plan, middle, half, accuracy),
    }
}

/// The intervals of a stretch of one cubic.
pub(crate) struct Intervals<'a, S> {
    cuts: Cuts<'a>,
    waiting: &'a mut Waiting,
    accuracy: f64,
    space: PhantomData<S>,
}

impl<S: Space> Intervals<'_, S> {
    /// The next interval: from, to, length.
    #[inline(always)]
    pub(crate) fn next<T: Vectors>(&mut self, vectors: T) -> Option<(f64, f64, f64)> {
        let (rule, middle, half) = self.cuts.next(self.waiting)?;
        let plan = self.cuts.plan;
        let length = apply_one::<S, T>(vectors, plan, rule, middle, half, self.accuracy);
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

pub(super) fn plan<S: Space>(cubic: &Cubic<S>) -> Plan {
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

/// Finds the zeros of one plan.
#[inline(always)]
pub(super) fn find_own_zeros<S: Space>(plan: &mut Plan) {
    if S::DIM > 2 {
        let found = space_zeros(&plan.velocity.axes);
        plan.zeros = Zeros(found.unwrap_or_default());
        plan.known = found.is_some();
    } else {
        let [x, y, _] = plan.velocity.axes;
        plan.zeros = Zeros(plane_zeros([x, y]));
        plan.known = true;
    }
}

/// Finds the zeros of all plans.
#[inline(always)]
pub(super) fn find_zeros<S: Space>(plans: &mut [(usize, Stretch, Plan)]) {
    if S::DIM > 2 {
        for (_, _, plan) in plans {
            find_own_zeros::<S>(plan);
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
pub(super) const HEIGHT: usize = 48;

/// Intervals that wait, the next one last.
pub(super) type Waiting = [(f64, f64); HEIGHT];

/// The intervals of a stretch with their rules, from left to right. (Methods, not closures: those would not be compiled for
/// the vectors of their caller.)
pub(super) struct Cuts<'a> {
    plan: &'a Plan,
    demand: &'a Demand,
    /// The square of the height below which a zero is one on the axis: its corner is rounded by less than matters.
    sharp: f64,
    /// The interval to look at.
    at: (f64, f64),
    /// How many wait behind it; nothing when all is done.
    height: Option<usize>,
    count: usize,
}

impl<'a> Cuts<'a> {
    #[inline(always)]
    pub(super) fn new(stretch: Stretch, plan: &'a Plan, accuracy: f64) -> Self {
        let share = accuracy / plan.size;
        // The exponent of size/accuracy, rounded up.
        let digits = 1024 - (share.to_bits() >> 52) as i64 + MARGIN;
        Self {
            plan,
            demand: &DEMANDS[digits.clamp(1, DIGITS as i64 - 1) as usize],
            sharp: 1e-2 * share,
            at: (stretch.from, stretch.to),
            height: Some(0),
            count: 0,
        }
    }

    /// Done with the interval.
    #[inline(always)]
    fn advance(&mut self, waiting: &Waiting) {
        self.count += 1;
        self.height = self.height.and_then(|height| height.checked_sub(1));
        if let Some(height) = self.height {
            self.at = waiting[height];
        }
    }

    /// The next interval: rule, middle, half. The rule is a number beyond the table where zeros are not known.
    #[inline(always)]
    pub(super) fn next(&mut self, waiting: &mut Waiting) -> Option<(usize, f64, f64)> {
        let mut height = self.height?;
        loop {
            let (a, b) = self.at;
            let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
            let square = half * half;
            if self.plan.size == 0.0 || half.is_nan() || half <= 0.0 || !self.plan.known {
                let unknown = !self.plan.known && self.plan.size != 0.0 && half > 0.0;
                self.height = Some(height);
                self.advance(waiting);
                return Some((if unknown { RULES } else { 0 }, middle, half));
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
            if !inside || height >= HEIGHT || self.count >= MOST {
                let rule = self.rule(nearest, square);
                self.height = Some(height);
                self.advance(waiting);
                return Some((rule, middle, half));
            }
            waiting[height] = (at, b);
            self.at = (a, at);
            height += 1;
        }
    }

    /// The rule that an interval of that squared half-width needs whose nearest zero is that far.
    #[inline(always)]
    fn rule(&self, nearest: f64, square: f64) -> usize {
        let smaller = self.demand.smaller.iter();
        smaller
            .map(|limit| usize::from(nearest < limit * square))
            .sum()
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
