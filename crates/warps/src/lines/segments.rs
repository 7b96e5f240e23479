//! Segments of the plane none of which decides alone: the common case of feature lines, at the machine's speed.
//!
//! Computes the same as the general kernel. With `a > 0` a weight `(size^p / (a + d))^b` is `c / q`, `c = size^(p·b)` and
//! `q = (a + d)^b`, so that sums of displacements over their weights are sums of fractions; four of them are brought to a common
//! denominator before there is a division, and a point costs a root for each line and a division for every four. Points for which
//! denominators leave their range are left for the caller.
//!
//! *Source*: T. Beier and S. Neely, *Feature-Based Image Metamorphosis*, SIGGRAPH 1992; the arrangement is a decision.

use super::elements::Item;
use super::weights::Power;
use anamorph_core::simd::{self, LANES, Level, Simd, dispatch, f64x8, prelude::*};
use anamorph_core::{Linear, Space};

/// Lines that share a division.
const GROUP: usize = 4;
/// Products of [`GROUP`] denominators between these lose nothing.
const RANGE: core::ops::Range<f64> = 1e-250..1e250;
/// Factors `c` between these keep the sums in range.
const FACTORS: core::ops::Range<f64> = 1e-50..1e50;
/// Offsets of this size are still told from 0 when squared, beside `a` of this size and more.
const LEAST: f64 = 1e-100;

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
        let usable = source.dimension() == 1 && source.length(0) > 0.0 && a >= LEAST;
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
        })
    }

    /// Moves a run of points, given by their coordinates. Those that the vectors do not serve stay; gives their numbers.
    pub(super) fn run(&self, coordinates: &mut [f64]) -> Vec<usize> {
        let mut odd = Vec::new();
        dispatch!(Level::new(), v => self.vectors(v, coordinates, &mut odd));
        odd
    }

    #[inline(always)]
    fn vectors<V: Simd>(&self, v: V, coordinates: &mut [f64], odd: &mut Vec<usize>) {
        match self.power {
            Power::Plain => run::<V, Plain>(v, &self.groups, coordinates, odd),
            Power::Square => run::<V, Square>(v, &self.groups, coordinates, odd),
            _ => run::<V, Other>(v, &self.groups, coordinates, odd),
        }
    }
}

/// `s ↦ s^b`. A trait rather than a closure, because a closure that is not inlined loses the processor's vectors.
trait Denominator {
    fn of<V: Simd>(v: V, s: f64x8<V>, b: f64) -> f64x8<V>;
}

struct Plain;
struct Square;
struct Other;

impl Denominator for Plain {
    #[inline(always)]
    fn of<V: Simd>(_: V, s: f64x8<V>, _: f64) -> f64x8<V> {
        s
    }
}
impl Denominator for Square {
    #[inline(always)]
    fn of<V: Simd>(_: V, s: f64x8<V>, _: f64) -> f64x8<V> {
        s * s
    }
}
impl Denominator for Other {
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

/// What a line does at eight points.
#[inline(always)]
fn fraction<V: Simd, D: Denominator>(
    v: V,
    segment: &Segment,
    [x, y]: [f64x8<V>; 2],
) -> Fraction<V> {
    let number = |x: f64| simd::splat(v, x);
    let [dx, dy] = segment.direction.map(number);
    let (fx, fy) = (x - number(segment.corner[0]), y - number(segment.corner[1]));
    let along = fx * dx + fy * dy;
    let along = along.max(number(0.0)).min(number(segment.length));
    let (ox, oy) = (fx - dx * along, fy - dy * along);
    let d = (ox * ox + oy * oy).sqrt();
    let [xx, xy, yx, yy] = segment.growth.map(number);
    [
        number(segment.shift[0]) + (xx * fx + xy * fy),
        number(segment.shift[1]) + (yx * fx + yy * fy),
        number(segment.c),
        D::of(v, number(segment.a) + d, segment.b),
    ]
}

#[inline(always)]
fn run<V: Simd, D: Denominator>(
    v: V,
    groups: &[[Segment; GROUP]],
    coordinates: &mut [f64],
    odd: &mut Vec<usize>,
) {
    for (number, part) in coordinates.chunks_mut(2 * LANES).enumerate() {
        // The last block is filled with its own last point.
        let last = part.len().saturating_sub(2);
        let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
        for (lane, (x, y)) in x.iter_mut().zip(&mut y).enumerate() {
            let at = (2 * lane).min(last);
            (*x, *y) = (part[at], part[at + 1]);
        }
        let (moved, plain) = block::<V, D>(v, groups, [x, y]);
        for (lane, point) in part.chunks_exact_mut(2).enumerate() {
            if plain >> lane & 1 == 1 {
                (point[0], point[1]) = (moved[0][lane], moved[1][lane]);
            } else {
                odd.push(number * LANES + lane);
            }
        }
    }
}

/// The images of eight points, and which of them, a bit each, are right.
#[inline(always)]
fn block<V: Simd, D: Denominator>(
    v: V,
    groups: &[[Segment; GROUP]],
    place: [[f64; LANES]; 2],
) -> ([[f64; LANES]; 2], u8) {
    let zero = simd::splat(v, 0.0);
    let place = place.map(|row| f64x8::simd_from(v, row));
    let (low, high) = (simd::splat(v, RANGE.start), simd::splat(v, RANGE.end));
    let (mut x, mut y, mut total) = (zero, zero, zero);
    let mut plain = zero.simd_eq(zero);
    for [a, b, c, d] in groups {
        let first = sum(
            &fraction::<V, D>(v, a, place),
            &fraction::<V, D>(v, b, place),
        );
        let second = sum(
            &fraction::<V, D>(v, c, place),
            &fraction::<V, D>(v, d, place),
        );
        let [across, down, weight, under] = sum(&first, &second);
        plain &= under.simd_ge(low) & under.simd_lt(high);
        let over = simd::splat(v, 1.0) / under;
        x += across * over;
        y += down * over;
        total += weight * over;
    }
    let (x, y) = (x / total, y / total);
    // Zero times a number is zero exactly if it is finite.
    plain &= ((x + y) * zero).simd_eq(zero);
    let by = |p: f64x8<V>, d: f64x8<V>| d.simd_eq(zero).select(p, p + d);
    let moved = [by(place[0], x).into(), by(place[1], y).into()];
    (moved, plain.to_bitmask() as u8)
}
