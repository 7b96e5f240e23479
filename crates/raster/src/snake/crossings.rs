//! Where a polyline crosses or touches itself.
//!
//! Boxes about runs of consecutive segments form a tree; two runs are looked into only where their boxes meet. Runs that follow each other
//! always meet, in one place, so that a curve that keeps clear of itself costs a number of boxes linear in its segments, however
//! unevenly long these are.
//!
//! *Source*: the boxes are the strip tree of D. H. Ballard, *Strip Trees: A Hierarchical Representation for Curves*, Communications of the
//! ACM 24(5), 1981, with boxes along the axes.

use anamorph_core::glam::DVec2;

/// A segment that goes somewhere: its ends, and the number of the point that it begins at.
struct Segment {
    from: DVec2,
    to: DVec2,
    number: usize,
}

/// Lowest and highest coordinates.
#[derive(Clone, Copy)]
struct Box2 {
    low: DVec2,
    high: DVec2,
}

impl Box2 {
    fn joined(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
    fn meets(self, other: Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }
}

/// On which side of the line through `a` and `b` a point is: 1, −1, or 0 on it.
fn side(a: DVec2, b: DVec2, p: DVec2) -> i8 {
    let area = (b - a).perp_dot(p - a);
    i8::from(area > 0.0) - i8::from(area < 0.0)
}

/// Whether two segments have a point in common.
fn meet(one: &Segment, other: &Segment) -> bool {
    let (a, b, c, d) = (one.from, one.to, other.from, other.to);
    let sides = [side(c, d, a), side(c, d, b), side(a, b, c), side(a, b, d)];
    if sides[0] * sides[1] < 0 && sides[2] * sides[3] < 0 {
        return true;
    }
    let on = |side: i8, from: DVec2, to: DVec2, p: DVec2| {
        side == 0 && p.cmpge(from.min(to)).all() && p.cmple(from.max(to)).all()
    };
    on(sides[0], c, d, a) || on(sides[1], c, d, b) || on(sides[2], a, b, c) || on(sides[3], a, b, d)
}

/// Whether a segment goes back over the one before it.
fn turns_back(one: &Segment, next: &Segment) -> bool {
    let (first, second) = (one.to - one.from, next.to - next.from);
    first.perp_dot(second) == 0.0 && first.dot(second) < 0.0
}

/// Pairs of segments, by the numbers of the points that they begin at, that have more in common than a curve's neighbours have; at most `most`. Points
/// in one place with the one before count once, and an open curve may end where it began.
pub(super) fn crossings(points: &[DVec2], closed: bool, most: usize) -> Vec<[usize; 2]> {
    let wrap = if closed { points.first() } else { None };
    let ends = points.iter().skip(1).chain(wrap);
    let segments: Vec<Segment> = points
        .iter()
        .zip(ends)
        .enumerate()
        .filter(|(_, (from, to))| from != to)
        .map(|(number, (&from, &to))| Segment { from, to, number })
        .collect();
    let boxes = segments.iter().map(|segment| Box2 {
        low: segment.from.min(segment.to),
        high: segment.from.max(segment.to),
    });
    let mut levels: Vec<Vec<Box2>> = vec![boxes.collect()];
    while let Some(last) = levels.last().filter(|last| last.len() > 1) {
        let joined = last.chunks(2).map(|pair| match *pair {
            [one, other] => one.joined(other),
            _ => pair[0],
        });
        let joined = joined.collect();
        levels.push(joined);
    }
    let count = segments.len();
    let is_ring = count > 0 && segments[0].from == segments[count - 1].to;
    let mut found = Vec::new();
    let mut todo = vec![(levels.len() - 1, 0, 0)];
    while let Some((level, a, b)) = todo.pop() {
        if found.len() >= most {
            break;
        }
        let boxes = &levels[level];
        if a >= boxes.len() || b >= boxes.len() || a != b && !boxes[a].meets(boxes[b]) {
            continue;
        }
        if level > 0 {
            let below = level - 1;
            todo.push((below, 2 * a, 2 * b));
            todo.push((below, 2 * a, 2 * b + 1));
            todo.push((below, 2 * a + 1, 2 * b + 1));
            if a != b {
                todo.push((below, 2 * a + 1, 2 * b));
            }
            continue;
        }
        let (one, other) = (&segments[a], &segments[b]);
        let crosses = if a == b {
            false
        } else if a + 1 == b {
            turns_back(one, other) || is_ring && count == 2
        } else if is_ring && a == 0 && b + 1 == count {
            turns_back(other, one)
        } else {
            meet(one, other)
        };
        if crosses {
            found.push([one.number, other.number]);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::dvec2;

    fn of(points: &[(f64, f64)], closed: bool) -> Vec<[usize; 2]> {
        let points: Vec<DVec2> = points.iter().map(|&(x, y)| dvec2(x, y)).collect();
        crossings(&points, closed, usize::MAX)
    }

    #[test]
    fn crossings_touches_and_turns_are_found() {
        let eight = [(0.0, 0.0), (4.0, 4.0), (4.0, 0.0), (0.0, 4.0)];
        assert_eq!(of(&eight, false), [[0, 2]]);
        assert_eq!(of(&eight, true), [[0, 2]]);
        let square = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)];
        assert!(of(&square, true).is_empty());
        // Doubled points and an open curve that ends where it began are no crossings.
        let ring = [
            (0.0, 0.0),
            (0.0, 0.0),
            (4.0, 0.0),
            (4.0, 0.0),
            (4.0, 4.0),
            (0.0, 0.0),
        ];
        assert!(of(&ring, false).is_empty() && of(&ring, true).is_empty());
        // A touch, a way back, and a part gone over twice are.
        assert_eq!(
            of(&[(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (2.0, 0.0)], false),
            [[0, 2]]
        );
        assert_eq!(of(&[(0.0, 0.0), (4.0, 0.0), (1.0, 0.0)], false), [[0, 1]]);
        assert!(of(&[(0.0, 0.0), (4.0, 0.0), (9.0, 0.0)], false).is_empty());
        assert!(of(&[], true).is_empty() && of(&[(1.0, 1.0); 4], true).is_empty());
    }

    #[test]
    fn the_tree_finds_what_all_pairs_find() {
        let mut state = 9_u64;
        let mut unit = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for count in [3, 4, 7, 64, 129] {
            for closed in [false, true] {
                let points: Vec<DVec2> = (0..count).map(|_| dvec2(unit(), unit())).collect();
                let mut found = crossings(&points, closed, usize::MAX);
                found.sort_unstable();
                let pieces = if closed { count } else { count - 1 };
                let segment = |i: usize| Segment {
                    from: points[i],
                    to: points[(i + 1) % count],
                    number: i,
                };
                let mut known = Vec::new();
                for a in 0..pieces {
                    for b in a + 2..pieces {
                        let neighbours = closed && a == 0 && b + 1 == count;
                        if !neighbours && meet(&segment(a), &segment(b)) {
                            known.push([a, b]);
                        }
                    }
                }
                assert_eq!(found, known, "{count} {closed}");
            }
        }
    }
}
