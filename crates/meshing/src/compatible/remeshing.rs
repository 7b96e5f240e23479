//! What makes both meshes better at once: edges are flipped, collapsed and split, and inner points moved, wherever that lowers an energy.
//!
//! The energy of a triangle is `q⁻⁴` in the source plus `q⁻⁴` in the target, `q = 4√3 area / Σ length²` (1 where all sides are alike, 0 where
//! the area is none). The fourth power makes the worst triangles count most; that each triangle has a cost as well keeps their number
//! small. Every change lowers the sum and leaves each triangle positive in both meshes by exact tests, so a valid pair stays valid. Moving
//! one point in one mesh is a convex problem: `q⁻¹` is a square over a linear function of where the point is.
//!
//! *Source*: Yan, Hu and Martin 2004, "Merge all Patches and Optimization": moving interior vertices and flipping interior edges of both meshes;
//! V. Surazhsky and C. Gotsman, *High quality compatible triangulations*, Engineering with Computers 20, 2004 (splits and collapses in both at
//! once); P. Bhatia and K. Lawrence, *Two-dimensional finite element mesh generation based on stripwise automatic triangulation*, 1990 (the
//! measure `q`). The power and the order of changes are decisions.

use super::mesh::Mesh;
use crate::planar::orientation;
use anamorph_core::glam::{DMat2, DVec2};

/// `4√3 / 2`: doubled areas are at hand.
const EVEN: f64 = 3.464_101_615_137_754_4;
/// How much worse triangles may become by joining points, before all is moved into place.
const SLACKS: [f64; 3] = [30.0, 6.0, 1.5];
/// Triangles for each point that stays, above which there are far too many.
const MANY: usize = 12;
/// Rounds of all changes.
const ROUNDS: usize = 12;
/// Sweeps over all points in a round.
const SWEEPS: usize = 6;
/// Triangles above this are bad enough to be split: `q` of 0.27 in one mesh. If that does not help, only those above the next.
const BAD: [f64; 4] = [190.0, 1e3, 1e4, 1e5];
/// What each triangle costs, so that there are few.
const EACH: f64 = 20.0;
/// Passes in which large triangles are split.
const PASSES: usize = 16;
/// Rounds end where one lowers the energy by less than this share.
const GAIN: f64 = 2e-3;

/// Makes both meshes better.
pub(super) fn improve(mesh: &mut Mesh, largest: f64) {
    let mut work = Work::of(mesh);
    let mut before = work.total();
    work.relax(1);
    for slack in SLACKS {
        while work.try_collapses(slack) {}
    }
    for _ in 0..ROUNDS {
        work.relax(SWEEPS);
        work.collapse(1.0);
        work.relax(SWEEPS);
        let _ = BAD.iter().any(|bad| work.try_splits(*bad));
        let after = work.total();
        if after > before * (1.0 - GAIN) {
            break;
        }
        before = after;
    }
    work.refine(largest);
    work.into(mesh);
}

/// Energy of a triangle in one mesh; infinite where it is not positive.
fn energy(corners: [DVec2; 3]) -> f64 {
    let [a, b, c] = corners;
    let twice = orientation(a, b, c);
    if twice <= 0.0 || twice.is_nan() {
        return f64::INFINITY;
    }
    let lengths = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    let inverse = lengths / (EVEN * twice);
    let square = inverse * inverse;
    square * square
}

/// Energy of a triangle in both meshes.
pub(super) fn energy_of(places: &[Vec<DVec2>; 2], triangle: [u32; 3]) -> f64 {
    let of = |places: &[DVec2]| energy(triangle.map(|i| places[i as usize]));
    of(&places[0]) + of(&places[1])
}

/// Both meshes, with the triangles around each point.
#[derive(Clone)]
struct Work {
    places: [Vec<DVec2>; 2],
    /// Dead ones have three equal corners.
    triangles: Vec<[u32; 3]>,
    around: Vec<Vec<u32>>,
    fixed: usize,
}

const DEAD: [u32; 3] = [u32::MAX; 3];

impl Work {
    fn of(mesh: &mut Mesh) -> Self {
        let mut work = Self {
            places: [
                core::mem::take(&mut mesh.source),
                core::mem::take(&mut mesh.target),
            ],
            triangles: core::mem::take(&mut mesh.triangles),
            around: Vec::new(),
            fixed: mesh.fixed,
        };
        work.around = vec![Vec::new(); work.places[0].len()];
        for (number, triangle) in (0..).zip(&work.triangles) {
            for &corner in triangle {
                work.around[corner as usize].push(number);
            }
        }
        work
    }

    /// Back, without what is dead.
    fn into(self, mesh: &mut Mesh) {
        let alive: Vec<_> = self.triangles.iter().filter(|t| **t != DEAD).collect();
        let mut numbers = vec![u32::MAX; self.places[0].len()];
        for (number, own) in (0..).zip(&mut numbers[..self.fixed]) {
            *own = number;
        }
        let mut count = self.fixed as u32;
        let [from, to] = &self.places;
        (mesh.source, mesh.target) = (from[..self.fixed].to_vec(), to[..self.fixed].to_vec());
        for (point, number) in numbers.iter_mut().enumerate().skip(self.fixed) {
            if !self.around[point].is_empty() {
                *number = count;
                count += 1;
                mesh.source.push(from[point]);
                mesh.target.push(to[point]);
            }
        }
        let renamed = |t: &[u32; 3]| t.map(|i| numbers[i as usize]);
        mesh.triangles = alive.into_iter().map(renamed).collect();
    }

    fn energy(&self, triangle: [u32; 3]) -> f64 {
        energy_of(&self.places, triangle)
    }

    fn total(&self) -> f64 {
        let alive = self.triangles.iter().filter(|t| **t != DEAD);
        alive.map(|t| self.energy(*t) + EACH).sum()
    }

    /// The triangle with an edge in this direction, and its third corner.
    fn side(&self, a: u32, b: u32) -> Option<(u32, u32)> {
        self.around[a as usize].iter().find_map(|&number| {
            let t = self.triangles[number as usize];
            let at = t.iter().position(|&corner| corner == a)?;
            (t[(at + 1) % 3] == b).then(|| (number, t[(at + 2) % 3]))
        })
    }

    fn put(&mut self, number: u32, triangle: [u32; 3]) {
        let old = core::mem::replace(&mut self.triangles[number as usize], triangle);
        for corner in old {
            if corner != u32::MAX && !triangle.contains(&corner) {
                self.around[corner as usize].retain(|&t| t != number);
            }
        }
        for corner in triangle {
            if corner != u32::MAX && !old.contains(&corner) {
                self.around[corner as usize].push(number);
            }
        }
    }

    fn add(&mut self, triangle: [u32; 3]) {
        let number = self.triangles.len() as u32;
        self.triangles.push(DEAD);
        self.put(number, triangle);
    }

    /// Flips and moves until they bring little.
    fn relax(&mut self, sweeps: usize) {
        let mut before = self.total();
        for _ in 0..sweeps {
            self.flip();
            for point in self.fixed as u32..self.places[0].len() as u32 {
                self.settle(point, 1);
            }
            let after = self.total();
            if after > before * (1.0 - 1e-3) {
                break;
            }
            before = after;
        }
    }

    /// Flips edges where that helps, each triangle's in turn.
    fn flip(&mut self) {
        for _ in 0..8 {
            let mut any = false;
            for number in 0..self.triangles.len() as u32 {
                for side in 0..3 {
                    let t = self.triangles[number as usize];
                    if t == DEAD {
                        break;
                    }
                    let [a, b, c] = [0, 1, 2].map(|i| t[(side + i) % 3]);
                    let Some((other, d)) = self.side(b, a) else {
                        continue;
                    };
                    let before = self.energy(t) + self.energy([b, a, d]);
                    let (left, right) = ([a, d, c], [d, b, c]);
                    let after = self.energy(left) + self.energy(right);
                    if after < before * (1.0 - 1e-9) {
                        self.put(number, left);
                        self.put(other, right);
                        any = true;
                    }
                }
            }
            if !any {
                break;
            }
        }
    }

    /// Moves a free point to where its triangles are best, in each mesh for itself.
    fn settle(&mut self, point: u32, steps: usize) {
        for side in 0..2 {
            for _ in 0..steps {
                if !self.step(point, side) {
                    break;
                }
            }
        }
    }

    /// One step of Newton's method. Whether it went anywhere.
    fn step(&mut self, point: u32, side: usize) -> bool {
        let here = self.places[side][point as usize];
        let (mut value, mut slope, mut curve) = (0.0, DVec2::ZERO, DMat2::ZERO);
        for &number in &self.around[point as usize] {
            let [b, c] = self
                .opposite(number, point)
                .map(|i| self.places[side][i as usize]);
            let twice = (b - here).perp_dot(c - here);
            let lengths =
                here.distance_squared(b) + here.distance_squared(c) + b.distance_squared(c);
            let inverse = lengths / (EVEN * twice);
            let way = b - c;
            let by_area = EVEN * DVec2::new(way.y, -way.x);
            let first = (2.0 * (2.0 * here - b - c) - inverse * by_area) / (EVEN * twice);
            let outer = |u: DVec2, v: DVec2| DMat2::from_cols(u * v.x, u * v.y);
            let second = (DMat2::from_diagonal(DVec2::splat(4.0))
                - outer(first, by_area)
                - outer(by_area, first))
                * (1.0 / (EVEN * twice));
            let square = inverse * inverse;
            value += square * square;
            slope += 4.0 * square * inverse * first;
            curve += outer(first, first) * (12.0 * square) + second * (4.0 * square * inverse);
        }
        let way = -(curve.inverse() * slope);
        if !way.is_finite() || !value.is_finite() {
            return false;
        }
        let mut length = 1.0;
        for _ in 0..12 {
            let there = here + length * way;
            self.places[side][point as usize] = there;
            let all = self.around[point as usize].iter();
            let after: f64 = all
                .map(|&number| {
                    let t = self.triangles[number as usize];
                    energy(t.map(|i| self.places[side][i as usize]))
                })
                .sum();
            if after < value * (1.0 - 1e-9) {
                return true;
            }
            length *= 0.4;
        }
        self.places[side][point as usize] = here;
        false
    }

    /// The other corners of a triangle, in its order.
    fn opposite(&self, number: u32, point: u32) -> [u32; 2] {
        let t = self.triangles[number as usize];
        let at = t.iter().position(|&corner| corner == point).unwrap_or(0);
        [t[(at + 1) % 3], t[(at + 2) % 3]]
    }

    /// Joins free points to a neighbour where that helps, or costs no more than `slack` times what there was. Whether there were any.
    fn collapse(&mut self, slack: f64) -> bool {
        let mut touched = vec![false; self.places[0].len()];
        let mut any = false;
        for point in self.fixed as u32..self.places[0].len() as u32 {
            let star = self.around[point as usize].clone();
            // What has just been joined is looked at again when all has settled.
            if star.is_empty() || touched[point as usize] {
                continue;
            }
            let stars = star
                .iter()
                .map(|&t| self.energy(self.triangles[t as usize]));
            let before = stars.sum::<f64>() * slack + 2.0 * EACH;
            let mut best: Option<(f64, u32)> = None;
            let ends: Vec<[u32; 2]> = star.iter().map(|&t| self.opposite(t, point)).collect();
            for &[neighbour, _] in &ends {
                let mut after = 0.0;
                let most = best.map_or(before * (1.0 - 1e-9), |(least, _)| least);
                for &[b, c] in ends.iter().filter(|ends| !ends.contains(&neighbour)) {
                    after += self.energy([neighbour, b, c]);
                    if after >= most {
                        break;
                    }
                }
                if after < most {
                    best = Some((after, neighbour));
                }
            }
            let Some((_, neighbour)) = best else { continue };
            for (number, [b, c]) in star.into_iter().zip(ends) {
                if b == neighbour || c == neighbour {
                    self.put(number, DEAD);
                } else {
                    self.put(number, [neighbour, b, c]);
                }
                (touched[b as usize], touched[c as usize]) = (true, true);
            }
            any = true;
        }
        any
    }

    /// Joins points, and keeps that if all is better in the end.
    fn try_collapses(&mut self, slack: f64) -> bool {
        let mut trial = self.clone();
        if !trial.collapse(slack) {
            return false;
        }
        // While there are far too many, it is enough that nothing is in the way.
        let many = trial.triangles.len() > MANY * self.fixed;
        trial.relax(if many { 1 } else { SWEEPS });
        let better = trial.total() < self.total();
        if better {
            trial.compact();
            *self = trial;
        }
        better
    }

    /// Drops what is dead.
    fn compact(&mut self) {
        if self.triangles.iter().filter(|t| **t == DEAD).count() * 4 < self.triangles.len() {
            return;
        }
        self.triangles.retain(|t| *t != DEAD);
        for list in &mut self.around {
            list.clear();
        }
        for (number, triangle) in (0..).zip(&self.triangles) {
            for &corner in triangle {
                self.around[corner as usize].push(number);
            }
        }
    }

    /// Splits the longest edges of bad triangles, and keeps that if all is better in the end.
    fn try_splits(&mut self, bad: f64) -> bool {
        let mut trial = self.clone();
        if trial.split(bad) == 0 {
            return false;
        }
        trial.relax(SWEEPS);
        trial.collapse(1.0);
        trial.relax(SWEEPS);
        let better = trial.total() < self.total();
        if better {
            *self = trial;
        }
        better
    }

    /// Splits triangles that are larger than a share of all, in either mesh, as long as there are such.
    fn refine(&mut self, largest: f64) {
        let area = |work: &Self, side: usize, t: [u32; 3]| {
            let [a, b, c] = t.map(|i| work.places[side][i as usize]);
            (b - a).perp_dot(c - a)
        };
        let alive = self.triangles.iter().filter(|t| **t != DEAD);
        let alive: Vec<[u32; 3]> = alive.copied().collect();
        let whole = [0, 1].map(|side| alive.iter().map(|t| area(self, side, *t)).sum::<f64>());
        for pass in 0..PASSES {
            let mut count = 0;
            for number in 0..self.triangles.len() as u32 {
                let t = self.triangles[number as usize];
                if t == DEAD {
                    continue;
                }
                let shares = [0, 1].map(|side| area(self, side, t) / whole[side]);
                let worse = usize::from(shares[1] > shares[0]);
                if shares[worse] > largest && self.split_longest(number, worse) {
                    count += 1;
                }
            }
            if count == 0 {
                break;
            }
            // Moving points makes triangles even, and some larger again: not in the last passes.
            if pass < PASSES / 2 {
                self.relax(SWEEPS);
            }
        }
    }

    /// How many edges were split.
    fn split(&mut self, bad: f64) -> usize {
        let mut count = 0;
        for number in 0..self.triangles.len() as u32 {
            let t = self.triangles[number as usize];
            if t == DEAD || self.energy(t) < bad {
                continue;
            }
            // In the mesh where it is worse.
            let of = |side: usize| energy(t.map(|i| self.places[side][i as usize]));
            let worse = usize::from(of(1) > of(0));
            count += usize::from(self.split_longest(number, worse));
        }
        count
    }

    /// Splits the inner edge of a triangle that is longest in one of the meshes. Whether there was one.
    fn split_longest(&mut self, number: u32, side: usize) -> bool {
        let t = self.triangles[number as usize];
        let length = |i: usize| {
            let ends = [t[i], t[(i + 1) % 3]].map(|i| self.places[side][i as usize]);
            ends[0].distance_squared(ends[1])
        };
        let inner = (0..3).filter(|&i| self.side(t[(i + 1) % 3], t[i]).is_some());
        let longest = inner.fold(None, |best: Option<usize>, i| match best {
            Some(best) if length(best) >= length(i) => Some(best),
            _ => Some(i),
        });
        let Some(longest) = longest else {
            return false;
        };
        let [a, b, c] = [0, 1, 2].map(|i| t[(longest + i) % 3]);
        let Some((other, d)) = self.side(b, a) else {
            return false;
        };
        let middle = self.places[0].len() as u32;
        for places in &mut self.places {
            places.push(0.5 * (places[a as usize] + places[b as usize]));
        }
        self.around.push(Vec::new());
        let made = [
            [a, middle, c],
            [middle, b, c],
            [b, middle, d],
            [middle, a, d],
        ];
        if made.iter().any(|t| self.energy(*t).is_infinite()) {
            // Too thin for the numbers.
            for places in &mut self.places {
                places.pop();
            }
            self.around.pop();
            return false;
        }
        self.put(number, made[0]);
        self.add(made[1]);
        self.put(other, made[2]);
        self.add(made[3]);
        self.settle(middle, 3);
        true
    }
}
