//! A mesh of triangles whose edges are collapsed one by one, without a change of its topology.
//!
//! *Source*: T. K. Dey, H. Edelsbrunner, S. Guha and D. V. Nekhayev, *Topology Preserving Edge Contraction*, Publications de
//! l'Institut Mathématique 66(80), 1999: an edge may be collapsed if the links of its ends meet in the link of the edge, where
//! a further vertex, joined to all borders, closes them.

use anamorph_core::glam::DVec3;

use crate::{Surface, Topology};

/// From that many faces on a vertex stays where it is: its faces are not looked at each time that one of them changes,
/// which would take the square of their number.
const HUB: usize = 128;

/// A moved face may turn by no more than what this cosine says (about 78 degrees).
const TURN: f64 = 0.2;

/// A moved face is a needle below this compactness (1 for equal sides), and must not become a worse one.
const NEEDLE: f64 = 0.02;

/// Why an edge is not collapsed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Refusal {
    /// Both ends stay where they are, or a border would go where the other end stays.
    Locked,
    /// A hole, a handle or a piece would close or come apart.
    Topology,
    /// A face would turn over, or become a needle.
    Turning,
}

/// Faces by their vertices, vertices by their faces; parts die and keep their numbers.
pub(super) struct Complex {
    pub(super) positions: Vec<DVec3>,
    pub(super) faces: Vec<[usize; 3]>,
    pub(super) alive: Vec<bool>,
    /// Faces at each vertex, among them dead ones.
    at: Vec<Vec<usize>>,
    /// How many faces at each vertex are alive; a vertex without has been collapsed.
    degree: Vec<usize>,
    border: Vec<bool>,
    locked: Vec<bool>,
}

impl Complex {
    pub(super) fn new(surface: &Surface) -> Self {
        let topology = surface.topology();
        let vertices = topology.vertices();
        let faces: Vec<[usize; 3]> = (0..topology.faces())
            .map(|f| topology.triangle(f))
            .collect();
        let alive: Vec<bool> = (0..faces.len())
            .map(|f| topology.sides(f).is_some())
            .collect();
        let at: Vec<Vec<usize>> = (0..vertices)
            .map(|v| topology.corners(v).iter().map(|c| c.face).collect())
            .collect();
        Self {
            positions: surface.positions().to_vec(),
            faces,
            alive,
            degree: at.iter().map(Vec::len).collect(),
            at,
            border: (0..vertices)
                .map(|v| topology.is_boundary_vertex(v))
                .collect(),
            locked: locked(topology),
        }
    }

    pub(super) fn is_alive(&self, vertex: usize) -> bool {
        self.degree[vertex] > 0
    }

    pub(super) fn is_border(&self, vertex: usize) -> bool {
        self.border[vertex]
    }

    pub(super) fn is_locked(&self, vertex: usize) -> bool {
        self.locked[vertex]
    }

    pub(super) fn is_hub(&self, vertex: usize) -> bool {
        self.degree[vertex] >= HUB
    }

    /// Whether a vertex must stay where it is.
    pub(super) fn is_fixed(&self, vertex: usize) -> bool {
        self.locked[vertex] || self.is_hub(vertex)
    }

    pub(super) fn faces_at(&self, vertex: usize) -> impl Iterator<Item = usize> {
        self.at[vertex].iter().copied().filter(|&f| self.alive[f])
    }

    /// The vertices that a vertex is joined to, in order.
    pub(super) fn neighbours(&self, vertex: usize) -> Vec<usize> {
        let mut all: Vec<usize> = self
            .faces_at(vertex)
            .flat_map(|f| self.faces[f])
            .filter(|&v| v != vertex)
            .collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Of two vertices that with fewer faces first.
    fn lighter(&self, a: usize, b: usize) -> (usize, usize) {
        if self.degree[b] < self.degree[a] {
            (b, a)
        } else {
            (a, b)
        }
    }

    /// The faces at an edge.
    fn faces_between(&self, a: usize, b: usize) -> Vec<usize> {
        let (few, other) = self.lighter(a, b);
        self.faces_at(few)
            .filter(|&f| self.faces[f].contains(&other))
            .collect()
    }

    /// Whether two vertices are joined; of two hubs always, for it would take too long to know.
    fn may_be_joined(&self, a: usize, b: usize) -> bool {
        let (few, other) = self.lighter(a, b);
        self.is_hub(few) || self.faces_at(few).any(|f| self.faces[f].contains(&other))
    }

    /// Whether an edge can be collapsed as far as topology goes.
    pub(super) fn check(&self, a: usize, b: usize) -> Result<(), Refusal> {
        if self.is_locked(a) && self.is_locked(b) {
            return Err(Refusal::Locked);
        }
        for (stays, goes) in [(a, b), (b, a)] {
            if self.is_fixed(stays) && self.border[goes] && !self.border[stays] {
                return Err(Refusal::Locked);
            }
        }
        let (few, other) = self.lighter(a, b);
        if self.is_hub(few) {
            return Err(Refusal::Topology);
        }
        let between = self.faces_between(a, b);
        let opposite: Vec<usize> = between
            .iter()
            .filter_map(|&f| self.faces[f].into_iter().find(|&v| v != a && v != b))
            .collect();
        let ordinary = match opposite.as_slice() {
            // At a border, or joining two borders, which would then touch in a point.
            [_] => true,
            [c, d] => c != d && !(self.border[a] && self.border[b]),
            _ => false,
        };
        if !ordinary {
            return Err(Refusal::Topology);
        }
        let mut common = self.neighbours(few).into_iter();
        if common.any(|c| c != other && !opposite.contains(&c) && self.may_be_joined(c, other)) {
            return Err(Refusal::Topology);
        }
        for &c in &opposite {
            // Both edges become one. A face with a side at the border goes only if the edge that stays had two faces: else a
            // hole of three edges would close, a triangle of its own vanish, or an edge of three faces lose one.
            let mut faces = [a, b].map(|v| self.faces_between(v, c).len());
            faces.sort_unstable();
            if faces[0] == 1 && faces[1] != 2 {
                return Err(Refusal::Topology);
            }
        }
        if let [c, d] = *opposite {
            // A tetrahedron.
            let has_face = |v: usize| {
                let (few, other) = self.lighter(c, v);
                self.faces_at(few)
                    .any(|f| self.faces[f].contains(&other) && self.faces[f].contains(&d))
            };
            if has_face(few) && has_face(other) {
                return Err(Refusal::Topology);
            }
        }
        Ok(())
    }

    /// Whether no face turns over when both ends of an edge go to a place.
    pub(super) fn keeps_sides(&self, a: usize, b: usize, to: DVec3) -> bool {
        let keeps = |from: usize, other: usize| {
            if self.positions[from] == to {
                return true;
            }
            self.faces_at(from).all(|f| {
                let face = self.faces[f];
                if face.contains(&other) {
                    return true;
                }
                let before = face.map(|v| self.positions[v]);
                let after = face.map(|v| if v == from { to } else { self.positions[v] });
                let (old, old_shape) = normal_and_shape(before);
                let (new, new_shape) = normal_and_shape(after);
                old.length_squared() <= 0.0
                    || (new.dot(old) > TURN * new.length() * old.length()
                        && (new_shape >= NEEDLE || new_shape >= 0.5 * old_shape))
            })
        };
        keeps(a, b) && keeps(b, a)
    }

    /// Joins vertex `gone` to `kept`, which goes to a place; the edge has been [checked](Self::check). The vertices whose edges
    /// to `kept` are new or changed where `kept` is fixed are the former neighbours of `gone`.
    pub(super) fn collapse(&mut self, gone: usize, kept: usize, to: DVec3) {
        self.positions[kept] = to;
        self.border[kept] |= self.border[gone];
        for f in core::mem::take(&mut self.at[gone]) {
            if !self.alive[f] {
                continue;
            }
            if self.faces[f].contains(&kept) {
                self.alive[f] = false;
                for v in self.faces[f] {
                    self.degree[v] -= 1;
                    self.forget_dead(v);
                }
            } else {
                self.faces[f] = self.faces[f].map(|v| if v == gone { kept } else { v });
                self.at[kept].push(f);
                self.degree[kept] += 1;
            }
        }
        self.degree[gone] = 0;
    }

    /// Shortens the list of a vertex's faces when half of it is dead.
    fn forget_dead(&mut self, vertex: usize) {
        if self.at[vertex].len() > 2 * self.degree[vertex] + 4 {
            let mut list = core::mem::take(&mut self.at[vertex]);
            list.retain(|&f| self.alive[f]);
            self.at[vertex] = list;
        }
    }
}

/// The vertices at edges of three faces and more, and those where fans of faces touch.
fn locked(topology: &Topology) -> Vec<bool> {
    let mut locked: Vec<bool> = (0..topology.vertices())
        .map(|v| topology.fans(v).count() > 1)
        .collect();
    for edge in topology.non_manifold_edges() {
        for v in topology.ends(edge) {
            locked[v] = true;
        }
    }
    locked
}

/// Twice the area times the normal, and the compactness: 1 for equal sides, 0 without area.
fn normal_and_shape([a, b, c]: [DVec3; 3]) -> (DVec3, f64) {
    let normal = (b - a).cross(c - a);
    let squares = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    let shape = 2.0 * 3.0_f64.sqrt() * normal.length() / squares;
    (normal, if squares > 0.0 { shape } else { 0.0 })
}
