//! Two regions cut open along paths that correspond, until each is a disk whose border has the same points in the same order.
//!
//! Rings, and inner points that were asked for, are joined to what is joined already, each by one path between a pair of points that are near to each
//! other in both regions; no point has two. A path goes along an edge of the triangulation where there is one, else through a
//! strip of triangles, away from their corners; both paths get equally many points. Joined to a border of which both
//! regions have the same points in the same order, a ring can be joined anywhere: the order stays the same.
//!
//! *Source*: Yan, Hu and Martin 2004, "Triangulation and Patching" (disjoint paths in the same cyclic order). That paths join rings and not
//! feature points is a decision: it is what regions with holes need.

use crate::planar::{Region, RegionError, constrained};
use anamorph_core::glam::DVec2;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

/// The share of a gate's width that a path keeps from its ends.
const NARROWEST: f64 = 0.2;

/// Both regions as disks.
pub(super) struct Disks {
    /// Points in the source and in the target: rings, inner ones, those of paths.
    pub(super) points: [Vec<DVec2>; 2],
    /// Points along the border of the disk; those that were cut come by more than once.
    pub(super) cycle: Vec<u32>,
    /// Triangles of source and target, by places in the cycle. They have no points inside the disk.
    pub(super) triangles: [Vec<[u32; 3]>; 2],
}

/// Cuts both open. Nothing where rings have too few points to be joined, or triangles do not tile a region to the last digits.
pub(super) fn cut_open(
    regions: [&Region; 2],
    inner: &[(DVec2, DVec2)],
) -> Result<Option<Disks>, RegionError> {
    let mut points = regions.map(|r| r.rings().flatten().copied().collect::<Vec<_>>());
    for (a, b) in inner {
        points[0].push(*a);
        points[1].push(*b);
    }
    let mut groups: Vec<(usize, usize)> = Vec::new();
    let counts = regions[0].rings().map(Vec::len);
    for count in counts.chain(inner.iter().map(|_| 1)) {
        let first = groups.last().map_or(0, |(_, end)| *end);
        groups.push((first, first + count));
    }
    let own = points[0].len();
    let border: Vec<[usize; 2]> = regions[0].edges();
    let sizes = regions.map(|r| r.area().abs().sqrt());
    let mut used = vec![false; own];
    let mut joined = vec![false; groups.len()];
    joined[0] = true;
    let mut paths: Vec<[usize; 2]> = Vec::new();
    for _ in 1..groups.len() {
        let free = |group: usize| (groups[group].0..groups[group].1).filter(|&i| !used[i]);
        let mut best: Option<(f64, usize, usize, usize)> = None;
        for from in (0..groups.len()).filter(|g| joined[*g]).flat_map(free) {
            for group in (0..groups.len()).filter(|g| !joined[*g]) {
                for to in free(group) {
                    let far = |side: usize| points[side][from].distance(points[side][to]);
                    let far = far(0) / sizes[0] + far(1) / sizes[1];
                    if best.is_none_or(|(least, ..)| far < least) {
                        best = Some((far, group, from, to));
                    }
                }
            }
        }
        let Some((_, group, from, to)) = best else {
            return Ok(None);
        };
        let mut ways = [Vec::new(), Vec::new()];
        for (side, way) in ways.iter_mut().enumerate() {
            let triangles = constrained(&points[side], &border, &paths)?;
            let Some(found) = way_through(&points[side], &triangles, &paths, [from, to]) else {
                return Ok(None);
            };
            *way = found;
        }
        let most = ways[0].len().max(ways[1].len());
        let first = points[0].len();
        for (way, points) in ways.iter_mut().zip(&mut points) {
            subdivide(way, [points[from], points[to]], most);
            points.append(way);
        }
        let mut last = from;
        for next in (first..first + most).chain([to]) {
            paths.push([last, next]);
            last = next;
        }
        (used[from], used[to], joined[group]) = (true, true, true);
    }
    let mut disks = Vec::new();
    for side in points.iter() {
        let triangles = constrained(side, &border, &paths)?;
        match unrolled(&triangles, &border, &paths) {
            Some(disk) => disks.push(disk),
            None => return Ok(None),
        }
    }
    let (Some((other, of_target)), Some((cycle, of_source))) = (disks.pop(), disks.pop()) else {
        return Ok(None);
    };
    Ok((cycle == other).then_some(Disks {
        points,
        cycle,
        triangles: [of_source, of_target],
    }))
}

/// Points between two points: none along an edge, else the middles of the edges that the shortest strip of triangles crosses.
fn way_through(
    points: &[DVec2],
    triangles: &[[u32; 3]],
    paths: &[[usize; 2]],
    [from, to]: [usize; 2],
) -> Option<Vec<DVec2>> {
    let (from, to) = (from as u32, to as u32);
    let mut sides: HashMap<[u32; 2], usize> = HashMap::new();
    for (number, t) in triangles.iter().enumerate() {
        for i in 0..3 {
            sides.insert([t[i], t[(i + 1) % 3]], number);
        }
    }
    if sides.contains_key(&[from, to]) && sides.contains_key(&[to, from]) {
        return Some(Vec::new());
    }
    let closed = |a: u32, b: u32| {
        let (a, b) = (a as usize, b as usize);
        paths.iter().any(|p| *p == [a, b] || *p == [b, a])
    };
    // By length, then by number: lengths of positive numbers are ordered as their bits are.
    let mut heap = BinaryHeap::new();
    let mut length = vec![f64::INFINITY; triangles.len()];
    let mut before: Vec<Option<(usize, [u32; 2])>> = vec![None; triangles.len()];
    for (number, t) in triangles.iter().enumerate() {
        if t.contains(&from) {
            length[number] = 0.0;
            heap.push(Reverse((0_u64, number)));
        }
    }
    let mut here = vec![points[from as usize]; triangles.len()];
    while let Some(Reverse((bits, number))) = heap.pop() {
        if f64::from_bits(bits) > length[number] {
            continue;
        }
        let t = triangles[number];
        if t.contains(&to) {
            let mut gates = Vec::new();
            let mut at = number;
            while let Some((earlier, edge)) = before[at] {
                gates.push(edge.map(|i| points[i as usize]));
                at = earlier;
            }
            gates.reverse();
            let ends = [from, to].map(|i| points[i as usize]);
            return Some(straightened(&gates, ends));
        }
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            let Some(&next) = sides.get(&[b, a]) else {
                continue;
            };
            if closed(a, b) {
                continue;
            }
            let middle = 0.5 * (points[a as usize] + points[b as usize]);
            let far = length[number] + here[number].distance(middle);
            if far < length[next] {
                length[next] = far;
                here[next] = middle;
                before[next] = Some((number, [a, b]));
                heap.push(Reverse((far.to_bits(), next)));
            }
        }
    }
    None
}

/// Points of a way through gates, as few as there can be if each straight piece goes through the middles of the gates that it passes, or near
/// them.
fn straightened(gates: &[[DVec2; 2]], [from, to]: [DVec2; 2]) -> Vec<DVec2> {
    let middle = |k: usize| gates.get(k).map_or(to, |[a, b]| 0.5 * (*a + *b));
    // Where a straight piece passes a gate, as a share of its width.
    let passes = |p: DVec2, q: DVec2, [a, b]: [DVec2; 2]| {
        let (left, right) = ((q - p).perp_dot(a - p), (q - p).perp_dot(b - p));
        let share = left / (left - right);
        (NARROWEST..=1.0 - NARROWEST).contains(&share)
    };
    let mut way = Vec::new();
    let (mut here, mut next) = (from, 0);
    while next < gates.len() {
        // The last point that can be seen from here through all gates on the way.
        let mut last = next;
        while last < gates.len() {
            let there = middle(last + 1);
            if !(next..=last).all(|k| passes(here, there, gates[k])) {
                break;
            }
            last += 1;
        }
        if last == gates.len() {
            break;
        }
        here = middle(last);
        way.push(here);
        next = last + 1;
    }
    way
}

/// Halves the longest piece until there are so many points between.
fn subdivide(way: &mut Vec<DVec2>, [from, to]: [DVec2; 2], count: usize) {
    while way.len() < count {
        let all: Vec<DVec2> = [from]
            .into_iter()
            .chain(way.iter().copied())
            .chain([to])
            .collect();
        let longest = all
            .windows(2)
            .enumerate()
            .fold((0, -1.0), |best, (i, pair)| {
                let length = pair[0].distance_squared(pair[1]);
                if length > best.1 { (i, length) } else { best }
            });
        let middle = 0.5 * (all[longest.0] + all[longest.0 + 1]);
        way.insert(longest.0, middle);
    }
}

/// The border of a triangulation that is cut along paths, by points, and its triangles by places in it.
fn unrolled(
    triangles: &[[u32; 3]],
    border: &[[usize; 2]],
    paths: &[[usize; 2]],
) -> Option<(Vec<u32>, Vec<[u32; 3]>)> {
    let mut sides: HashMap<[u32; 2], (usize, usize)> = HashMap::new();
    for (number, t) in triangles.iter().enumerate() {
        for i in 0..3 {
            sides.insert([t[i], t[(i + 1) % 3]], (number, i));
        }
    }
    let both = paths.iter().flat_map(|&[a, b]| [[a, b], [b, a]]);
    let open: std::collections::HashSet<[u32; 2]> = border
        .iter()
        .copied()
        .chain(both)
        .map(|edge| edge.map(|i| i as u32))
        .collect();
    let mut places = vec![[u32::MAX; 3]; triangles.len()];
    let mut cycle = Vec::new();
    let first = border.first()?.map(|i| i as u32);
    let mut edge = first;
    loop {
        cycle.push(edge[0]);
        let next_place = cycle.len() as u32;
        let (mut number, mut corner) = *sides.get(&edge)?;
        // Around the end of the edge, to the next one that is open.
        loop {
            let end = (corner + 1) % 3;
            places[number][end] = next_place;
            let t = triangles[number];
            let next = [t[end], t[(end + 1) % 3]];
            if open.contains(&next) {
                edge = next;
                break;
            }
            (number, corner) = *sides.get(&[next[1], next[0]])?;
        }
        if edge == first {
            break;
        }
        if cycle.len() > open.len() {
            return None;
        }
    }
    let count = cycle.len() as u32;
    for place in places.as_flattened_mut() {
        // What is reached at the end of the last edge is the first place.
        if *place == count {
            *place = 0;
        }
    }
    let whole = cycle.len() == open.len() && places.as_flattened().iter().all(|p| *p < count);
    whole.then_some((cycle, places))
}
