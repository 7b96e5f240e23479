//! A coarse mesh from a fine one, of the same topology.
//!
//! Edges are collapsed one by one, the cheapest first, until as many vertices are left as were asked for. The cost is the
//! squared distance of the new vertex from the planes of all faces that it stands for, weighted by their areas, and from
//! the lines of borders; a small share of the spread of these faces keeps the edges of flat regions even. No collapse
//! changes the topology (pieces, holes, handles), turns a face over or makes a needle. Of collapses that cost the same, to the
//! last bit, that of the lower vertices comes first. The result does not depend on the model's size.
//!
//! *Source*: M. Garland and P. S. Heckbert, *Surface Simplification Using Quadric Error Metrics*, SIGGRAPH 1997; T. K. Dey
//! et al., *Topology Preserving Edge Contraction*, 1999. The spread is a decision.

mod complex;
mod quadric;
#[cfg(test)]
mod tests;

use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashSet};

use anamorph_core::glam::DVec3;

use crate::{Surface, SurfaceError, TopologyError};
use complex::{Complex, Refusal};
use quadric::Quadric;

/// How far a new vertex may lie from the middle of the edge that it replaces, in lengths of that edge.
const REACH: f64 = 2.0;

/// A new vertex that is nearer to an end of its edge than this share of the edge is that end.
const SAME: f64 = 1e-9;

/// A coarse mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Decimation {
    /// The coarse mesh. Its vertices and faces have the order of those that they were; no vertex is without a face.
    pub surface: Surface,
    /// Vertices that lay in one place with another and were joined with it, seams of a model among them.
    pub joined: usize,
    /// Vertices of no face, which were left out.
    pub loose: usize,
    /// Faces that were left out first: they name a place twice, or the same three places as another.
    pub left_out: usize,
    /// Vertices of edges of three faces and more, and where surfaces touch in a point. They stay where they are.
    pub locked: usize,
    /// Why more vertices are left than asked for.
    pub hindered: Option<Hindered>,
}

/// How many of the remaining edges cannot be collapsed, and why.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Hindered {
    /// A hole, a handle or a piece of the surface would close or come apart.
    pub topology: usize,
    /// Both ends belong to edges of three faces and more, or to points where surfaces touch.
    pub locked: usize,
    /// A face would turn over or become a needle.
    pub turning: usize,
}

/// A collapse that waits.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    cost: f64,
    ends: [usize; 2],
    /// How often each end had changed when the cost was found.
    changes: [u32; 2],
}

impl Candidate {
    fn key(&self) -> (f64, [usize; 2]) {
        (self.cost, self.ends)
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Candidate {}
impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Candidate {
    /// The cheapest, then the lowest, is the greatest, for a heap gives that first.
    fn cmp(&self, other: &Self) -> Ordering {
        let ((cost, ends), (other_cost, other_ends)) = (self.key(), other.key());
        other_cost.total_cmp(&cost).then(other_ends.cmp(&ends))
    }
}

/// Where the vertex of a collapsed edge goes.
#[derive(Debug, Clone, Copy)]
struct Place {
    position: DVec3,
    cost: f64,
    /// The end whose place it is.
    end: Option<usize>,
}

/// A coarse mesh of `count` vertices in the shape of a surface.
///
/// Vertices in one place are joined first. More vertices are left where fewer would change the topology: a closed piece
/// keeps 4 and more, an open one 3, and vertices that belong to no manifold stay. A surface that has no more vertices than
/// asked for is returned with its vertices joined and nothing else changed.
///
/// Takes O(n log n) time for n faces, and memory in proportion.
///
/// # Errors
/// [`TopologyError::AllDegenerate`] where no face is left once vertices in one place are joined. [`SurfaceError::TooLarge`]
/// where a new vertex would be beyond 1e75.
pub fn decimate(surface: &Surface, count: usize) -> Result<Decimation, SurfaceError> {
    let welded = Welded::new(surface);
    if welded.faces.is_empty() {
        return Err(SurfaceError::Topology(TopologyError::AllDegenerate {
            faces: surface.topology().faces(),
        }));
    }
    let given: Vec<DVec3> = welded
        .vertices
        .iter()
        .map(|&v| surface.positions()[v])
        .collect();
    // A power of two, so that sizes do not matter to the last bit, and squares of areas neither overflow nor vanish.
    let low = given.iter().copied().reduce(DVec3::min).unwrap_or_default();
    let high = given.iter().copied().reduce(DVec3::max).unwrap_or_default();
    let unit = power_of_two((high - low).max_element());
    let scaled = given.iter().map(|&p| p / unit).collect();
    let mut work = Work::new(&Surface::new(scaled, &welded.faces)?);
    let locked = (0..given.len()).filter(|&v| work.mesh.is_locked(v)).count();
    work.run(count);
    let hindered = (work.left > count).then(|| work.hindrances());

    let mut number = vec![usize::MAX; given.len()];
    let mut positions = Vec::with_capacity(work.left);
    for (vertex, number) in number.iter_mut().enumerate() {
        if work.mesh.is_alive(vertex) {
            *number = positions.len();
            positions.push(match work.kept[vertex] {
                Some(source) => given[source],
                None => work.mesh.positions[vertex] * unit,
            });
        }
    }
    let faces: Vec<[usize; 3]> = (0..work.mesh.faces.len())
        .filter(|&f| work.mesh.alive[f])
        .map(|f| work.mesh.faces[f].map(|v| number[v]))
        .collect();
    Ok(Decimation {
        surface: Surface::new(positions, &faces)?,
        joined: welded.joined,
        loose: welded.loose,
        left_out: surface.topology().faces() - welded.faces.len(),
        locked,
        hindered,
    })
}

/// The greatest power of two up to a number; the least that there is for 0 and what is less than normal numbers.
fn power_of_two(size: f64) -> f64 {
    f64::from_bits(size.to_bits() & (0x7FF << 52)).max(f64::MIN_POSITIVE)
}

/// Triangles over places.
struct Welded {
    /// The lowest vertex at each place that has a face.
    vertices: Vec<usize>,
    faces: Vec<[usize; 3]>,
    joined: usize,
    loose: usize,
}

impl Welded {
    fn new(surface: &Surface) -> Self {
        let topology = surface.topology();
        let positions = surface.positions();
        let mut order: Vec<usize> = (0..positions.len())
            .filter(|&v| !topology.corners(v).is_empty())
            .collect();
        let used = order.len();
        // Zero and its negative are one place.
        let key = |v: usize| (positions[v] + DVec3::ZERO).to_array().map(f64::to_bits);
        order.sort_by_cached_key(|&v| (key(v), v));
        let mut lowest: Vec<usize> = (0..positions.len()).collect();
        for pair in order.windows(2) {
            if key(pair[0]) == key(pair[1]) {
                lowest[pair[1]] = lowest[pair[0]];
            }
        }
        order.retain(|&v| lowest[v] == v);
        order.sort_unstable();
        let mut number = vec![0; positions.len()];
        for (new, &old) in order.iter().enumerate() {
            number[old] = new;
        }
        let mut known = HashSet::new();
        let faces = (0..topology.faces())
            .map(|f| topology.triangle(f).map(|v| number[lowest[v]]))
            .zip((0..topology.faces()).map(|f| topology.sides(f).is_some()))
            .filter(|&(face, sound)| {
                let mut sorted = face;
                sorted.sort_unstable();
                sound && sorted[0] < sorted[1] && sorted[1] < sorted[2] && known.insert(sorted)
            })
            .map(|(face, _)| face)
            .collect();
        let mut welded = Self {
            joined: used - order.len(),
            loose: positions.len() - used,
            vertices: order,
            faces,
        };
        welded.drop_faceless();
        welded
    }

    /// Leaves out vertices whose faces have all been left out.
    fn drop_faceless(&mut self) {
        let mut used = vec![false; self.vertices.len()];
        for v in self.faces.iter().flatten() {
            used[*v] = true;
        }
        let mut number = vec![0; used.len()];
        let mut next = 0;
        for (v, &used) in used.iter().enumerate() {
            number[v] = next;
            next += usize::from(used);
        }
        self.loose += used.len() - next;
        let mut is_used = used.iter();
        self.vertices
            .retain(|_| is_used.next().copied().unwrap_or_default());
        for face in &mut self.faces {
            *face = face.map(|v| number[v]);
        }
    }
}

/// A mesh while it is collapsed.
struct Work {
    mesh: Complex,
    quadrics: Vec<Quadric>,
    /// The vertex whose place a vertex has; none where it has a new one.
    kept: Vec<Option<usize>>,
    changes: Vec<u32>,
    /// Whether the collapse of an edge at a vertex has been refused since its surroundings changed.
    refused: Vec<bool>,
    waiting: BinaryHeap<Candidate>,
    left: usize,
}

impl Work {
    fn new(surface: &Surface) -> Self {
        let topology = surface.topology();
        let vertices = topology.vertices();
        let mut quadrics = vec![Quadric::default(); vertices];
        let mut add = |v: usize, quadric: Quadric| quadrics[v] = quadrics[v].plus(quadric);
        for face in 0..topology.faces() {
            let quadric = Quadric::of_corner(surface.area_vector(face));
            for v in topology.triangle(face) {
                add(v, quadric);
            }
        }
        for edge in topology.boundary_edges() {
            let [a, b] = topology.ends(edge);
            let quadric = Quadric::of_border(surface.positions()[b] - surface.positions()[a]);
            add(a, quadric);
            add(b, quadric);
        }
        let mut work = Self {
            mesh: Complex::new(surface),
            quadrics,
            kept: (0..vertices).map(Some).collect(),
            changes: vec![0; vertices],
            refused: vec![false; vertices],
            waiting: BinaryHeap::new(),
            left: vertices,
        };
        for edge in 0..topology.edges() {
            let [a, b] = topology.ends(edge);
            work.wait(a, b);
        }
        work
    }

    /// Where the vertex of a collapsed edge may go, the cheapest place first.
    fn places(&self, a: usize, b: usize) -> Vec<Place> {
        let mesh = &self.mesh;
        let [p, q] = [a, b].map(|v| mesh.positions[v]);
        let middle = (p + q) / 2.0;
        let both = self.quadrics[a]
            .seen_from(middle - p)
            .plus(self.quadrics[b].seen_from(middle - q));
        let at_end = |end: usize| {
            let position = mesh.positions[end];
            Place {
                position,
                cost: both.cost(position - middle),
                end: Some(end),
            }
        };
        // What is locked stays, then what is a hub, then what is at a border: the inside does not pull at it.
        let rank = |v: usize| {
            if mesh.is_locked(v) {
                3
            } else if mesh.is_hub(v) {
                2
            } else {
                u8::from(mesh.is_border(v))
            }
        };
        match rank(a).cmp(&rank(b)) {
            Ordering::Greater => return vec![at_end(a)],
            Ordering::Less => return vec![at_end(b)],
            Ordering::Equal if mesh.is_fixed(a) => return Vec::new(),
            Ordering::Equal => {}
        }
        let length = p.distance(q);
        let mut places = vec![at_end(a), at_end(b)];
        let best = both.best(REACH * length);
        let near = |p: DVec3| best.is_some_and(|best| (middle + best).distance(p) <= SAME * length);
        if !near(p) && !near(q) {
            let new = |d: DVec3| Place {
                position: middle + d,
                cost: both.cost(d),
                end: None,
            };
            places.push(new(DVec3::ZERO));
            if let Some(best) = best {
                // Ahead of places that cost as much.
                places.insert(0, new(best));
            }
        }
        places.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        places
    }

    fn wait(&mut self, a: usize, b: usize) {
        let ends = [a.min(b), a.max(b)];
        if let Some(place) = self.places(ends[0], ends[1]).first() {
            self.waiting.push(Candidate {
                cost: place.cost,
                ends,
                changes: ends.map(|v| self.changes[v]),
            });
        }
    }

    /// The first place that the collapse of an edge can go to.
    fn possible(&self, a: usize, b: usize) -> Result<Place, Refusal> {
        self.mesh.check(a, b)?;
        let mut places = self.places(a, b).into_iter();
        places
            .find(|place| self.mesh.keeps_sides(a, b, place.position))
            .ok_or(Refusal::Turning)
    }

    fn run(&mut self, count: usize) {
        while self.left > count {
            let Some(candidate) = self.waiting.pop() else {
                break;
            };
            let [a, b] = candidate.ends;
            if candidate.ends.map(|v| self.changes[v]) != candidate.changes
                || !self.mesh.is_alive(a)
                || !self.mesh.is_alive(b)
            {
                continue;
            }
            match self.possible(a, b) {
                // Dearer than was thought: it waits again, unless nothing is gained by it.
                Ok(place) if place.cost > candidate.cost => self.waiting.push(Candidate {
                    cost: place.cost,
                    ..candidate
                }),
                Ok(place) => self.collapse(a, b, place),
                Err(_) => {
                    self.refused[a] = true;
                    self.refused[b] = true;
                }
            }
        }
    }

    fn collapse(&mut self, a: usize, b: usize, place: Place) {
        // The one that keeps its place keeps its number; else the lower one does.
        let (kept, gone) = if place.end == Some(b) { (b, a) } else { (a, b) };
        let around = self.mesh.neighbours(gone);
        let [from_kept, from_gone] = [kept, gone].map(|v| place.position - self.mesh.positions[v]);
        self.quadrics[kept] = self.quadrics[kept]
            .seen_from(from_kept)
            .plus(self.quadrics[gone].seen_from(from_gone));
        if place.end.is_none() {
            self.kept[kept] = None;
        }
        let hub = self.mesh.is_hub(kept);
        self.mesh.collapse(gone, kept, place.position);
        self.left -= 1;
        self.changes[gone] += 1;
        // The edges of a hub wait with the costs that they had; only its new ones are added.
        let changed = if hub {
            around
        } else {
            self.changes[kept] += 1;
            self.refused[kept] = false;
            self.mesh.neighbours(kept)
        };
        for &other in &changed {
            if other != kept {
                self.wait(kept, other);
            }
        }
        // What was refused near by may be possible now.
        for &other in &changed {
            if self.refused[other] && other != kept && !self.mesh.is_hub(other) {
                self.refused[other] = false;
                for further in self.mesh.neighbours(other) {
                    if further != kept {
                        self.wait(other, further);
                    }
                }
            }
        }
    }

    /// Why the remaining edges are not collapsed.
    fn hindrances(&self) -> Hindered {
        let mut hindered = Hindered::default();
        for a in (0..self.mesh.positions.len()).filter(|&v| self.mesh.is_alive(v)) {
            for b in self.mesh.neighbours(a).into_iter().filter(|&b| b > a) {
                match self.possible(a, b) {
                    Err(Refusal::Locked) => hindered.locked += 1,
                    Err(Refusal::Topology) => hindered.topology += 1,
                    Err(Refusal::Turning) | Ok(_) => hindered.turning += 1,
                }
            }
        }
        hindered
    }
}
