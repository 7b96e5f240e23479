//! Segments of the plane none of which decides alone: the common case of feature lines, at the machine's speed.
//!
//! Computes the same as the general kernel. With `a > 0` a weight `(size^p / (a + d))^b` is `c / q`, `c = size^(p·b)` and
//! `q = (a + d)^b`, so that sums of displacements over their weights are sums of fractions; four of them are brought to a common
//! denominator before there is a division, and a point costs a root for each line and a division for every four. Roots are begun
//! in single precision and made double by a step of Newton's, which leaves a relative error of some 1e-14. Points for which
//! denominators leave their range are left for the caller.
//!
//! *Source*: T. Beier and S. Neely, *Feature-Based Image Metamorphosis*, SIGGRAPH 1992; the arrangement is a decision.

use super::elements::Item;
use super::weights::Power;
use anamorph_core::simd::fearless_simd::f32x16;
use anamorph_core::simd::{self, LANES, Level, Simd, dispatch, f64x8, mask64x8, prelude::*};
use anamorph_core::{Linear, Space};

/// Lines that share a division.
const GROUP: usize = 4;
/// Products of [`GROUP`] denominators between these lose nothing.
const RANGE: core::ops::Range<f64> = 1e-250..1e250;
/// Factors `c` between these keep the sums in range.
const FACTORS: core::ops::Range<f64> = 1e-50..1e50;
/// Of squared distances below this the roots are only right to a rounding beside `a` of [`LEAST`] and more.
const NEAR: f32 = 1e-36;
const LEAST: f64 = 1e-4;
/// Places this far out, and lines, are left to others: squared, their distances leave the range of single precision.
const FAR: f64 = 1e18;
/// Blocks that are moved together, because their roots share vectors.
const PAIR: usize = 2;
/// So many points with the same second coordinate are worth being treated as a row.
const ROW: usize = 64;

/// A line with all that its fraction needs. The displacement's parts are multiplied by `c`.
#[derive(Clone, Copy)]
struct Segment {
    corner: [f64; 2],
    direction: [f64; 2],
    length: f64,
    a: f64,
    b: f64,
    c: f64,
    shift: [f64; 2],
    /// By rows.
    growth: [f64; 4],
}

/// All lines of a warp, in groups.
pub(super) struct Segments {
    groups: Vec<[Segment; GROUP]>,
    power: Power,
    /// All `c` are 1.
    uniform: bool,
}

impl Segment {
    fn of<S: Space>(item: &Item<S>) -> Option<Self> {
        let (source, weight) = (&item.pair.source, &item.weight);
        let a = weight.constants.a;
        let c = match weight.power {
            Power::Plain => weight.size,
            Power::Square => weight.size * weight.size,
            _ => anamorph_core::math::exp(weight.log_factor()),
        };
        let near = item.reach < FAR && source.length(0) < FAR;
        let usable = source.dimension() == 1 && source.length(0) > 0.0 && a >= LEAST && near;
        if !usable || !FACTORS.contains(&c) {
            return None;
        }
        let plane = |v: S| [v.component(0), v.component(1)];
        let [x, y] = plane(item.shift);
        let entry = |row, column| item.growth.entry(row, column) * c;
        Some(Self {
            corner: plane(source.corner()),
            direction: plane(source.direction(0)),
            length: source.length(0),
            a,
            b: weight.constants.b,
            c,
            shift: [x * c, y * c],
            growth: [entry(0, 0), entry(0, 1), entry(1, 0), entry(1, 1)],
        })
    }
}

impl Segments {
    /// The lines of a warp of the plane; none where one of them is something else, decides alone, or has another `b`.
    pub(super) fn new<S: Space>(items: &[Item<S>]) -> Option<Self> {
        let power = items.first()?.weight.power;
        let kind = |power: &Power| core::mem::discriminant(power);
        let alike = items.iter().all(|i| kind(&i.weight.power) == kind(&power));
        if S::DIM != 2 || !alike {
            return None;
        }
        // One weight everywhere needs no distance.
        if power == Power::None {
            return None;
        }
        let all: Option<Vec<Segment>> = items.iter().map(Segment::of).collect();
        let all = all?;
        let uniform = all.len().is_multiple_of(GROUP) && all.iter().all(|s| s.c == 1.0);
        // What fills the last group moves nothing, and has an ordinary denominator.
        let filling = Segment {
            c: 0.0,
            shift: [0.0; 2],
            growth: [0.0; 4],
            ..*all.first()?
        };
        let groups = all
            .chunks(GROUP)
            .map(|part| core::array::from_fn(|i| part.get(i).copied().unwrap_or(filling)));
        Some(Self {
            groups: groups.collect(),
            power,
            uniform,
        })
    }

    /// Moves a run of points, given by their coordinates. Those that the vectors do not serve stay; gives their numbers.
    pub(super) fn run(&self, coordinates: &mut [f64]) -> Vec<usize> {
        let mut odd = Vec::new();
        let mut row = Vec::new();
        let mut first = 0;
        while first < coordinates.len() {
            let rest = &mut coordinates[first..];
            let y = rest.get(1).map_or(0, |y| y.to_bits());
            let points = rest.chunks_exact(2);
            let alike = points.take_while(|p| p[1].to_bits() == y).count();
            // Of points in no rows as many as there are until the next row.
            let size = if alike >= ROW { alike } else { scattered(rest) };
            let part = &mut rest[..2 * size];
            let number = first / 2;
            if alike >= ROW {
                row.clear();
                let lines = self.groups.iter();
                row.extend(lines.map(|group| group.map(|line| Row::new(line, part[1]))));
                dispatch!(Level::new(), v => self.vectors(v, &row, part, number, &mut odd));
            } else {
                dispatch!(Level::new(), v => self.vectors(v, &self.groups, part, number, &mut odd));
            }
            first += 2 * size;
        }
        odd
    }

    #[inline(always)]
    fn vectors<V: Simd, L: Line>(
        &self,
        v: V,
        groups: &[[L; GROUP]],
        coordinates: &mut [f64],
        first: usize,
        odd: &mut Vec<usize>,
    ) {
        match (self.power, self.uniform) {
            (Power::Plain, true) => run::<V, L, Plain, true>(v, groups, coordinates, first, odd),
            (Power::Plain, _) => run::<V, L, Plain, false>(v, groups, coordinates, first, odd),
            (Power::Square, true) => run::<V, L, Square, true>(v, groups, coordinates, first, odd),
            (Power::Square, _) => run::<V, L, Square, false>(v, groups, coordinates, first, odd),
            _ => run::<V, L, Other, false>(v, groups, coordinates, first, odd),
        }
    }
}

/// How many points there are before a row, or before the end: at least one.
fn scattered(coordinates: &[f64]) -> usize {
    let count = coordinates.len() / 2;
    let mut first = 0;
    for i in 1..count {
        if coordinates[2 * i + 1].to_bits() != coordinates[2 * first + 1].to_bits() {
            first = i;
        } else if i + 1 - first >= ROW && first > 0 {
            return first;
        }
    }
    count
}

/// A line as seen from points.
trait Line: Copy {
    fn segment(&self) -> &Segment;
    /// What depends on the second coordinate alone: down from the corner, its part of the distance along the line, and of the
    /// displacement.
    fn down<V: Simd>(&self, v: V, y: f64x8<V>) -> [f64x8<V>; 4];
}

impl Line for Segment {
    #[inline(always)]
    fn segment(&self) -> &Segment {
        self
    }
    #[inline(always)]
    fn down<V: Simd>(&self, v: V, y: f64x8<V>) -> [f64x8<V>; 4] {
        let fy = y - simd::splat(v, self.corner[1]);
        [
            fy,
            fy * simd::splat(v, self.direction[1]),
            simd::splat(v, self.shift[0]) + simd::splat(v, self.growth[1]) * fy,
            simd::splat(v, self.shift[1]) + simd::splat(v, self.growth[3]) * fy,
        ]
    }
}

/// A line for points that all have the same second coordinate.
#[derive(Clone, Copy)]
struct Row {
    segment: Segment,
    down: [f64; 4],
}

impl Row {
    /// The same operations as for any points.
    fn new(segment: Segment, y: f64) -> Self {
        let fy = y - segment.corner[1];
        let down = [
            fy,
            fy * segment.direction[1],
            segment.shift[0] + segment.growth[1] * fy,
            segment.shift[1] + segment.growth[3] * fy,
        ];
        Self { segment, down }
    }
}

impl Line for Row {
    #[inline(always)]
    fn segment(&self) -> &Segment {
        &self.segment
    }
    #[inline(always)]
    fn down<V: Simd>(&self, v: V, _: f64x8<V>) -> [f64x8<V>; 4] {
        let [fy, along, x, y] = self.down;
        [
            simd::splat(v, fy),
            simd::splat(v, along),
            simd::splat(v, x),
            simd::splat(v, y),
        ]
    }
}

/// `s ↦ s^b`. A trait rather than a closure, because a closure that is not inlined loses the processor's vectors.
trait Denominator {
    /// Whether products of [`GROUP`] of them are in range for all `a` of [`LEAST`] and more and places nearer than [`FAR`].
    const SAFE: bool;
    fn of<V: Simd>(v: V, s: f64x8<V>, b: f64) -> f64x8<V>;
}

struct Plain;
struct Square;
struct Other;

impl Denominator for Plain {
    const SAFE: bool = true;
    #[inline(always)]
    fn of<V: Simd>(_: V, s: f64x8<V>, _: f64) -> f64x8<V> {
        s
    }
}
impl Denominator for Square {
    const SAFE: bool = true;
    #[inline(always)]
    fn of<V: Simd>(_: V, s: f64x8<V>, _: f64) -> f64x8<V> {
        s * s
    }
}
impl Denominator for Other {
    const SAFE: bool = false;
    /// By logarithms; infinite where it overflows, 0 where it vanishes.
    #[inline(always)]
    fn of<V: Simd>(v: V, s: f64x8<V>, b: f64) -> f64x8<V> {
        let number = |x: f64| simd::splat(v, x);
        let log = simd::ln_positive(v, s) * number(b);
        let down = simd::exp_negative(v, number(0.0) - log.abs());
        let grows = log.simd_gt(number(0.0));
        let power = grows.select(number(1.0) / down, down);
        s.simd_lt(number(1e300))
            .select(power, number(f64::INFINITY))
    }
}

/// A sum of displacements over its denominator: across, down, weight, denominator.
type Fraction<V> = [f64x8<V>; 4];

/// The sum of two fractions.
#[inline(always)]
fn sum<V: Simd>(a: &Fraction<V>, b: &Fraction<V>) -> Fraction<V> {
    [
        a[0] * b[3] + b[0] * a[3],
        a[1] * b[3] + b[1] * a[3],
        a[2] * b[3] + b[2] * a[3],
        a[3] * b[3],
    ]
}

/// The sum of two fractions of weight 1, if they are said to be.
#[inline(always)]
fn first_sum<V: Simd, const UNIFORM: bool>(a: &Fraction<V>, b: &Fraction<V>) -> Fraction<V> {
    let mut sum = sum(a, b);
    if UNIFORM {
        sum[2] = a[3] + b[3];
    }
    sum
}

/// Numerator of the reciprocal root in single precision: near the half's cube root, for which [`refined`] is a step of
/// Newton's.
const NUMERATOR: f32 = 0.793_700_5;
/// Makes that step exact for an exact root.
const NEWTON: f64 = 1.0 / (NUMERATOR as f64) + (NUMERATOR as f64) * (NUMERATOR as f64);

/// `√s` from `r ≈ k/√s`, `k` the [`NUMERATOR`]: with `2k³ = 1` the expression `s·r·(3k² − s·r²)` has no first-order error in `r`.
#[inline(always)]
fn refined<V: Simd>(v: V, s: f64x8<V>, r: f64x8<V>) -> f64x8<V> {
    let root = s * r;
    root * (simd::splat(v, NEWTON) - root * r)
}

/// Roots of not negative numbers of at most [`FAR`] squared.
#[inline(always)]
fn roots<V: Simd>(v: V, [a, b]: [f64x8<V>; PAIR]) -> [f64x8<V>; PAIR] {
    let single = v.narrow_f64x8(a, b).max(f32x16::splat(v, NEAR));
    let (ra, rb) = v.widen_f32x16(f32x16::splat(v, NUMERATOR) / single.sqrt());
    [refined(v, a, ra), refined(v, b, rb)]
}

/// What a line does at eight points, but for its denominator, and their squared distances to it.
#[inline(always)]
fn offsets<V: Simd, L: Line>(v: V, line: &L, [x, y]: [f64x8<V>; 2]) -> [f64x8<V>; 3] {
    let segment = line.segment();
    let [fy, along_down, right, down] = line.down(v, y);
    let (dx, dy) = (
        simd::splat(v, segment.direction[0]),
        simd::splat(v, segment.direction[1]),
    );
    let fx = x - simd::splat(v, segment.corner[0]);
    let along = fx * dx + along_down;
    let along = along
        .max(simd::splat(v, 0.0))
        .min(simd::splat(v, segment.length));
    let (ox, oy) = (fx - dx * along, fy - dy * along);
    [
        right + simd::splat(v, segment.growth[0]) * fx,
        down + simd::splat(v, segment.growth[2]) * fx,
        ox * ox + oy * oy,
    ]
}

/// What a line does at the places of two blocks.
#[inline(always)]
fn fractions<V: Simd, L: Line, D: Denominator>(
    v: V,
    line: &L,
    places: &[[f64x8<V>; 2]; PAIR],
) -> [Fraction<V>; PAIR] {
    let segment = line.segment();
    let [x0, y0, first] = offsets(v, line, places[0]);
    let [x1, y1, second] = offsets(v, line, places[1]);
    let [first, second] = roots(v, [first, second]);
    let (a, c) = (simd::splat(v, segment.a), simd::splat(v, segment.c));
    [
        [x0, y0, c, D::of(v, a + first, segment.b)],
        [x1, y1, c, D::of(v, a + second, segment.b)],
    ]
}

#[inline(always)]
fn run<V: Simd, L: Line, D: Denominator, const UNIFORM: bool>(
    v: V,
    groups: &[[L; GROUP]],
    coordinates: &mut [f64],
    first: usize,
    odd: &mut Vec<usize>,
) {
    const POINTS: usize = PAIR * LANES;
    for (number, part) in coordinates.chunks_mut(2 * POINTS).enumerate() {
        // The last blocks are filled with their own last point.
        let last = part.len().saturating_sub(2);
        let mut places = [[[0.0; LANES]; 2]; PAIR];
        for (block, [x, y]) in places.iter_mut().enumerate() {
            for (lane, (x, y)) in x.iter_mut().zip(y).enumerate() {
                let at = (2 * (block * LANES + lane)).min(last);
                (*x, *y) = (part[at], part[at + 1]);
            }
        }
        let moved = blocks::<V, L, D, UNIFORM>(v, groups, &places);
        for (i, point) in part.chunks_exact_mut(2).enumerate() {
            let ([x, y], plain) = &moved[i / LANES];
            let lane = i % LANES;
            if plain >> lane & 1 == 1 {
                (point[0], point[1]) = (x[lane], y[lane]);
            } else {
                odd.push(first + number * POINTS + i);
            }
        }
    }
}

/// The images of two blocks, and which of them, a bit each, are right.
#[inline(always)]
fn blocks<V: Simd, L: Line, D: Denominator, const UNIFORM: bool>(
    v: V,
    groups: &[[L; GROUP]],
    places: &[[[f64; LANES]; 2]; PAIR],
) -> [([[f64; LANES]; 2], u8); PAIR] {
    let zero = simd::splat(v, 0.0);
    let [[x0, y0], [x1, y1]] = *places;
    let places = [
        [f64x8::simd_from(v, x0), f64x8::simd_from(v, y0)],
        [f64x8::simd_from(v, x1), f64x8::simd_from(v, y1)],
    ];
    let (low, high) = (simd::splat(v, RANGE.start), simd::splat(v, RANGE.end));
    let mut sums = [[zero; 3]; PAIR];
    let mut plain = [inside(v, places[0]), inside(v, places[1])];
    for [a, b, c, d] in groups {
        let a = fractions::<V, L, D>(v, a, &places);
        let b = fractions::<V, L, D>(v, b, &places);
        let c = fractions::<V, L, D>(v, c, &places);
        let d = fractions::<V, L, D>(v, d, &places);
        for i in 0..PAIR {
            let first = first_sum::<V, UNIFORM>(&a[i], &b[i]);
            let second = first_sum::<V, UNIFORM>(&c[i], &d[i]);
            let [across, down, weight, under] = sum(&first, &second);
            if !D::SAFE {
                plain[i] &= under.simd_ge(low) & under.simd_lt(high);
            }
            let over = simd::splat(v, 1.0) / under;
            sums[i][0] += across * over;
            sums[i][1] += down * over;
            sums[i][2] += weight * over;
        }
    }
    [
        image(v, places[0], sums[0], plain[0]),
        image(v, places[1], sums[1], plain[1]),
    ]
}

/// Whether places are near enough for single precision.
#[inline(always)]
fn inside<V: Simd>(v: V, [x, y]: [f64x8<V>; 2]) -> mask64x8<V> {
    let far = simd::splat(v, FAR);
    x.abs().simd_lt(far) & y.abs().simd_lt(far)
}

/// The images of eight places, moved by a quotient.
#[inline(always)]
fn image<V: Simd>(
    v: V,
    [px, py]: [f64x8<V>; 2],
    [x, y, total]: [f64x8<V>; 3],
    plain: mask64x8<V>,
) -> ([[f64; LANES]; 2], u8) {
    let zero = simd::splat(v, 0.0);
    let (x, y) = (x / total, y / total);
    // Zero times a number is zero exactly if it is finite.
    let plain = plain & ((x + y) * zero).simd_eq(zero);
    let px = x.simd_eq(zero).select(px, px + x);
    let py = y.simd_eq(zero).select(py, py + y);
    ([px.into(), py.into()], plain.to_bitmask() as u8)
}
