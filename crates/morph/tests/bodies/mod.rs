//! Pairs that tests of strain fields share.

#![allow(dead_code)]

use anamorph_core::glam::{DVec2, dvec2};
use anamorph_core::math;
use anamorph_morph::strain::{Element, Pair};
use std::f64::consts::{PI, TAU};

/// Numbers in [−1, 1).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Places and elements of a strip `length` by 1 of so many cells, its inner vertices moved about.
pub(crate) fn strip(
    columns: usize,
    rows: usize,
    length: f64,
    quads: bool,
) -> (Vec<DVec2>, Vec<Element>) {
    let mut random = Random(0x1234_5678_9abc_def1);
    let mut places = Vec::new();
    for i in 0..=columns {
        for j in 0..=rows {
            let cell = dvec2(length / columns as f64, 1.0 / rows as f64);
            let mut place = dvec2(i as f64, j as f64);
            if i > 0 && i < columns && j > 0 && j < rows {
                place += dvec2(random.next(), random.next()) * 0.15;
            }
            places.push(place * cell);
        }
    }
    let at = |i: usize, j: usize| i * (rows + 1) + j;
    let mut elements = Vec::new();
    for i in 0..columns {
        for j in 0..rows {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if quads {
                elements.push([a, b, c, d].into());
            } else {
                elements.push([a, b, c].into());
                elements.push([a, c, d].into());
            }
        }
    }
    (places, elements)
}

/// A strip whose middle line becomes an arc of `angle`, without a change of its length.
pub(crate) fn bend(columns: usize, rows: usize, length: f64, angle: f64, quads: bool) -> Pair {
    let (source, elements) = strip(columns, rows, length, quads);
    let target = source.iter().map(|p| bent(*p, length, angle)).collect();
    Pair::new(source, target, elements).unwrap()
}

/// Where a place of a strip goes when it is bent.
pub(crate) fn bent(p: DVec2, length: f64, angle: f64) -> DVec2 {
    let radius = length / angle;
    let (sin, cos) = math::sin_cos(angle * p.x / length);
    dvec2(sin, -cos) * (radius - (p.y - 0.5))
}

/// A spiral of `turns` turns that uncurls to a straight strip.
pub(crate) fn spiral(turns: f64) -> Pair {
    let (straight, elements) = strip(60, 2, 30.0, false);
    let curled: Vec<DVec2> = straight
        .iter()
        .map(|p| {
            let angle = TAU * turns * p.x / 30.0;
            let radius = 3.0 + angle / TAU * 1.6;
            let (sin, cos) = math::sin_cos(angle);
            dvec2(cos, sin) * (radius - (p.y - 0.5))
        })
        .collect();
    Pair::new(curled, straight, elements).unwrap()
}

/// A ring of so many cells around and across, with places by a function of angle (0 to 2π) and share (0 inside to 1).
pub(crate) fn ring(around: usize, across: usize, place: impl Fn(f64, f64) -> DVec2) -> Vec<DVec2> {
    let mut places = Vec::new();
    for i in 0..around {
        for j in 0..=across {
            places.push(place(
                TAU * i as f64 / around as f64,
                j as f64 / across as f64,
            ));
        }
    }
    places
}

/// The elements of such a ring.
pub(crate) fn ring_elements(around: usize, across: usize) -> Vec<Element> {
    let at = |i: usize, j: usize| (i % around) * (across + 1) + j;
    let mut elements = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            elements.push([a, b, c].into());
            elements.push([a, c, d].into());
        }
    }
    elements
}

/// The places of a pair under an affine map: columns, then the move.
pub(crate) fn mapped(places: &[DVec2], x: DVec2, y: DVec2, to: DVec2) -> Vec<DVec2> {
    places.iter().map(|p| x * p.x + y * p.y + to).collect()
}

/// A rotation's columns.
pub(crate) fn turned(angle: f64) -> [DVec2; 2] {
    let (sin, cos) = math::sin_cos(angle);
    [dvec2(cos, sin), dvec2(-sin, cos)]
}

/// The greatest distance of places from others.
pub(crate) fn apart(a: &[DVec2], b: &[DVec2]) -> f64 {
    assert_eq!(a.len(), b.len());
    let distances = a.iter().zip(b).map(|(p, q)| p.distance(*q));
    distances.fold(0.0, f64::max)
}

/// The greatest distance after the best rigid motion.
pub(crate) fn apart_rigidly(a: &[DVec2], b: &[DVec2]) -> f64 {
    let mean = |list: &[DVec2]| list.iter().copied().sum::<DVec2>() / list.len() as f64;
    let (ca, cb) = (mean(a), mean(b));
    let (mut dot, mut cross) = (0.0, 0.0);
    for (p, q) in a.iter().zip(b) {
        dot += (*p - ca).dot(*q - cb);
        cross += (*p - ca).perp_dot(*q - cb);
    }
    let [x, y] = turned(math::atan2(cross, dot));
    let moved: Vec<DVec2> = a
        .iter()
        .map(|p| {
            let d = *p - ca;
            cb + x * d.x + y * d.y
        })
        .collect();
    apart(&moved, b)
}

/// An angle up to whole turns.
pub(crate) fn wrapped(angle: f64) -> f64 {
    let rest = angle.rem_euclid(TAU);
    if rest > PI { rest - TAU } else { rest }
}

/// A ring whose hole moves about and whose outside becomes a star, all of it turned: much compression.
pub(crate) fn hard() -> Pair {
    let source = ring(40, 4, |angle, share| {
        dvec2(angle.cos(), angle.sin()) * (0.3 + 0.7 * share)
    });
    let target = ring(40, 4, |angle, share| {
        let star = 1.0 + 0.55 * (5.0 * angle).cos();
        let turned = angle + 2.4;
        dvec2(turned.cos(), turned.sin()) * (0.1 + share * (star - 0.1)) * 2.0
    });
    Pair::new(source, target, ring_elements(40, 4)).unwrap()
}
