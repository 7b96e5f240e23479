//! Compatible triangulations that always exist: the triangulations of both regions, laid over each other.
//!
//! Both regions are disks with the same border ([`super::cuts`]), triangulated without points inside. Seen on a regular polygon, their inner edges are
//! chords; chords of one cross those of the other. Each crossing becomes a point, each piece of the polygon between chords a convex
//! polygon in both regions, which is triangulated. Which chords cross, and in which order, follows from the numbers of their ends alone, so that no
//! coordinates of the polygon are needed: along a chord, crossings are spread evenly. First, edges of either are flipped where fewer
//! chords cross then. The number of points grows with that of crossings, at most with the square of the border's.
//!
//! *Source*: B. Aronov, R. Seidel and D. Souvaine, *On compatible triangulations of simple polygons*, Computational Geometry 3, 1993; Yan, Hu and
//! Martin 2004, "Patch Parametrization Over a Regular Polygon" and "Merging": the overlay that their merge of points is compared with.

use super::cuts::{Disks, cut_open};
use super::mesh::inner_edges;
use crate::planar::{Region, RegionError, orientation};
use anamorph_core::glam::DVec2;
use std::collections::HashMap;

/// At most so many crossings.
const MOST_CROSSINGS: usize = 2_000_000;
/// Passes of flips.
const PASSES: usize = 6;

/// Points of source and target, and triangles of both.
pub(super) struct Overlay {
    pub(super) source: Vec<DVec2>,
    pub(super) target: Vec<DVec2>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// A chord of the polygon, `a < b`, and the crossings on it from `a` to `b`.
struct Chord {
    a: u32,
    b: u32,
    in_source: bool,
    in_target: bool,
    /// The other chord, and the end of it that is between `a` and `b`.
    crossings: Vec<(usize, u32)>,
}

/// Lays both over each other. Nothing where they cannot be cut open, or cross too often.
pub(super) fn overlay(
    regions: [&Region; 2],
    inner: &[(DVec2, DVec2)],
) -> Result<Option<Overlay>, RegionError> {
    let Some(mut disks) = cut_open(regions, inner)? else {
        return Ok(None);
    };
    uncross(&mut disks);
    Ok(laid_over(&disks))
}

/// The inner edges of a triangulated disk, as chords.
fn chords(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let edges = inner_edges(triangles);
    edges
        .iter()
        .map(|([a, b], _)| [*a.min(b), *a.max(b)])
        .collect()
}

fn cross([a, b]: [u32; 2], [c, d]: [u32; 2]) -> bool {
    let between = |x: u32| a < x && x < b;
    let outside = |x: u32| x < a || x > b;
    (between(c) && outside(d)) || (between(d) && outside(c))
}

/// Flips edges where fewer chords cross then.
fn uncross(disks: &mut Disks) {
    let places = |side: usize, i: u32| disks.points[side][disks.cycle[i as usize] as usize];
    for pass in 0..PASSES {
        let mut any = false;
        for side in [pass % 2, 1 - pass % 2] {
            let others = chords(&disks.triangles[1 - side]);
            let count = |ends: [u32; 2]| {
                let chord = [ends[0].min(ends[1]), ends[0].max(ends[1])];
                others.iter().filter(|other| cross(chord, **other)).count()
            };
            let edges = inner_edges(&disks.triangles[side]);
            let mut touched = vec![false; disks.triangles[side].len()];
            for ([a, b], [(first, c), (second, d)]) in edges {
                if touched[first] || touched[second] {
                    continue;
                }
                let [pa, pb, pc, pd] = [a, b, c, d].map(|i| places(side, i));
                // Not by a hair: what is made must be fit to be made better.
                let fat = |a: DVec2, b: DVec2, c: DVec2| {
                    let longest = a.distance_squared(b).max(b.distance_squared(c));
                    orientation(a, b, c) > 1e-9 * longest.max(c.distance_squared(a))
                };
                if !(fat(pa, pd, pc) && fat(pd, pb, pc)) || count([c, d]) >= count([a, b]) {
                    continue;
                }
                disks.triangles[side][first] = [a, d, c];
                disks.triangles[side][second] = [d, b, c];
                (touched[first], touched[second]) = (true, true);
                any = true;
            }
        }
        if !any {
            break;
        }
    }
}

fn laid_over(disks: &Disks) -> Option<Overlay> {
    let count = disks.cycle.len() as u32;
    let mut chords = gathered(disks);
    let mut crossings = 0;
    for i in 0..chords.len() {
        for j in i + 1..chords.len() {
            let (p, q) = (&chords[i], &chords[j]);
            let apart = (p.in_source && q.in_source) || (p.in_target && q.in_target);
            if apart || !cross([p.a, p.b], [q.a, q.b]) {
                continue;
            }
            let inside = |chord: &Chord, other: &Chord| {
                if chord.a < other.a && other.a < chord.b {
                    other.a
                } else {
                    other.b
                }
            };
            let (x, y) = (inside(p, q), inside(q, p));
            chords[i].crossings.push((j, x));
            chords[j].crossings.push((i, y));
            crossings += 1;
            if crossings > MOST_CROSSINGS {
                return None;
            }
        }
    }
    // In their order from `a` to `b`: by the end in between, then by the other, which goes the other way round.
    let ends: Vec<[u32; 2]> = chords.iter().map(|chord| [chord.a, chord.b]).collect();
    for chord in &mut chords {
        let a = chord.a;
        chord.crossings.sort_by_key(|&(other, inside)| {
            let [c, d] = ends[other];
            let outside = if c == inside { d } else { c };
            (inside, (a + count - outside) % count)
        });
    }
    let mut nodes: HashMap<(usize, usize), u32> = HashMap::new();
    let mut points = disks.points.clone();
    let mut names: Vec<u32> = disks.cycle.clone();
    let place = |side: usize, i: u32| disks.points[side][disks.cycle[i as usize] as usize];
    for (number, chord) in chords.iter().enumerate() {
        for (other, _) in &chord.crossings {
            if number < *other {
                nodes.insert((number, *other), names.len() as u32);
                names.push(points[0].len() as u32);
                for side in &mut points {
                    side.push(DVec2::ZERO);
                }
            }
        }
    }
    let node = |i: usize, j: usize| nodes.get(&(i.min(j), i.max(j))).copied();
    // Neighbours of all nodes, counterclockwise.
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); names.len()];
    let mut beside: Vec<Vec<(u32, u32)>> = vec![Vec::new(); count as usize];
    for (number, chord) in chords.iter().enumerate() {
        let mut line = vec![chord.a];
        for (other, _) in &chord.crossings {
            line.push(node(number, *other)?);
        }
        line.push(chord.b);
        let last = line.len() - 1;
        beside[chord.a as usize].push((chord.b, line[1]));
        beside[chord.b as usize].push((chord.a, line[last - 1]));
        let side = usize::from(!chord.in_source);
        for at in 1..last {
            let share = at as f64 / last as f64;
            let point = names[line[at] as usize] as usize;
            points[side][point] = place(side, chord.a).lerp(place(side, chord.b), share);
            // Back and on along the first chord; those of the other come between.
            let list = &mut around[line[at] as usize];
            let (other, inside) = chord.crossings[at - 1];
            if number < other {
                // Towards a, the end of the other in between, b, its other end.
                list.splice(0..0, [line[at - 1], u32::MAX, line[at + 1], u32::MAX]);
                let (theirs, back) = (&chords[other], number);
                let at_other = theirs.crossings.iter().position(|(i, _)| *i == back)?;
                let step = |k: usize| match theirs.crossings.get(k) {
                    Some((i, _)) => node(other, *i),
                    None => Some(theirs.b),
                };
                let before = match at_other {
                    0 => Some(theirs.a),
                    k => step(k - 1),
                }?;
                let after = step(at_other + 1)?;
                let (towards, away) = if inside == theirs.a {
                    (before, after)
                } else {
                    (after, before)
                };
                (list[1], list[3]) = (towards, away);
            }
        }
    }
    for (vertex, mut list) in (0..count).zip(beside) {
        let turn = |end: u32| (end + count - vertex) % count;
        list.sort_by_key(|(end, _)| turn(*end));
        let own = &mut around[vertex as usize];
        own.push((vertex + 1) % count);
        own.extend(list.iter().map(|(_, next)| *next));
        own.push((vertex + count - 1) % count);
    }
    let mut triangles = Vec::new();
    let mut done = std::collections::HashSet::new();
    for (from, list) in (0..).zip(&around) {
        for &to in list {
            let outside = from < count && to < count && (to + 1) % count == from;
            if outside || done.contains(&(from, to)) {
                continue;
            }
            let mut face = Vec::new();
            let (mut u, mut v) = (from, to);
            loop {
                done.insert((u, v));
                face.push(names[u as usize]);
                let neighbours = &around[v as usize];
                let at = neighbours.iter().position(|w| *w == u)?;
                let next = neighbours[(at + neighbours.len() - 1) % neighbours.len()];
                (u, v) = (v, next);
                if (u, v) == (from, to) {
                    break;
                }
                if face.len() > 12 {
                    return None;
                }
            }
            triangles.extend(best_fan(&face, &points));
        }
    }
    let [source, target] = points;
    Some(Overlay {
        source,
        target,
        triangles,
    })
}

/// All chords of both, each once.
fn gathered(disks: &Disks) -> Vec<Chord> {
    let mut found: HashMap<[u32; 2], usize> = HashMap::new();
    let mut all: Vec<Chord> = Vec::new();
    for (side, triangles) in disks.triangles.iter().enumerate() {
        for [a, b] in chords(triangles) {
            let number = *found.entry([a, b]).or_insert_with(|| {
                all.push(Chord {
                    a,
                    b,
                    in_source: false,
                    in_target: false,
                    crossings: Vec::new(),
                });
                all.len() - 1
            });
            if side == 0 {
                all[number].in_source = true;
            } else {
                all[number].in_target = true;
            }
        }
    }
    all
}

/// The triangles of a convex polygon from the corner that makes the best ones.
fn best_fan(face: &[u32], points: &[Vec<DVec2>; 2]) -> Vec<[u32; 3]> {
    let count = face.len();
    let fan = |first: usize| -> Vec<[u32; 3]> {
        let corner = |i: usize| face[(first + i) % count];
        let rest = (1..count - 1).map(|i| [corner(0), corner(i), corner(i + 1)]);
        rest.collect()
    };
    let cost = |fan: &[[u32; 3]]| -> f64 {
        let all = fan.iter().map(|t| super::remeshing::energy_of(points, *t));
        all.sum()
    };
    let (mut best, mut least) = (fan(0), f64::INFINITY);
    for first in 0..count {
        let made = fan(first);
        let made_cost = cost(&made);
        if made_cost < least {
            (best, least) = (made, made_cost);
        }
    }
    best
}
