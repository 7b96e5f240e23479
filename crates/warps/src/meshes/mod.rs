//! Mesh features: a coarse mesh near a model, whose edited vertices carry the model with them.
//!
//! Computes eq. (3) with `T_i⟨p⟩ = P*_i + A_iᵀ(p − P_i)`, strength 1 and weight
//! `w_i = f_αβ(‖p − P_i‖/‖E_m‖) · Π_j f_γμ((p − P_i)·E_ij / E_ij·E_ij)` over the edges `E_ij` of vertex `i`, `E_m` the longest of them, `f_ab` 1 up
//! to `a`, 0 from `b` on, and a smoothstep between. Vertices are found through a grid of cells, so that a point looks at those near it only.
//!
//! *Source*: Milliron et al. 2002, §6, Figs. 17–18; errata F11–F14 (rows and columns, about the vertex, flat fans, which numbers are
//! allowed, vertices that break interpolation, points that are not covered).

mod cells;
mod fans;
#[cfg(feature = "recipe")]
pub(crate) mod parameters;

use anamorph_core::{
    Address, Affine, Condition, Deformation, Facts, Influences, Linear, Mark, Role, Shape, Site,
    Smoothness, Space, Support, Unmapped, Warp, evaluate,
};
use anamorph_transforms::Rotational;
use cells::Cells;
use fans::{Told, fan};

/// What is wrong with a mesh warp.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// There is no vertex with an edge.
    #[error("the coarse mesh has no edge: give edges or faces")]
    Empty,
    /// Source and target have different numbers of vertices.
    #[error(
        "the source has {source_count} vertices and the target {target_count}; give one target for each"
    )]
    Count {
        /// Of the source.
        source_count: usize,
        /// Of the target.
        target_count: usize,
    },
    /// A vertex that is not finite.
    #[error("vertex {vertex} has a coordinate that is not finite; give finite numbers")]
    NotFinite {
        /// Number of the vertex.
        vertex: usize,
    },
    /// An edge to a vertex that does not exist.
    #[error("an edge joins vertex {vertex}, and there are {count}, 0 to {}", count.saturating_sub(1))]
    Edge {
        /// The number given.
        vertex: usize,
        /// How many there are.
        count: usize,
    },
    /// Two vertices in one place with different targets.
    #[error(
        "vertices {first} and {second} lie in one place and have different targets; join them, or move them together"
    )]
    Torn {
        /// Number of the first.
        first: usize,
        /// Number of the second.
        second: usize,
    },
    /// A number outside of its range.
    #[error("{name} is {value}, and must be {range}")]
    Number {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
}

/// Sizes of the weights' maximum and support.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reaches {
    /// Up to this share of the longest edge from the vertex the distance does not count.
    pub alpha: f64,
    /// At this share of the longest edge the weight ends.
    pub beta: f64,
    /// Up to this share along an edge the edge does not count.
    pub gamma: f64,
    /// At this share along an edge the weight ends.
    pub mu: f64,
}

impl Default for Reaches {
    /// What covers the edges, faces and a shell around them: `α = 0.1`, `β = 1`, `γ = 0.1`, `μ = 1`.
    fn default() -> Self {
        Self {
            alpha: 0.1,
            beta: 1.0,
            gamma: 0.1,
            mu: 1.0,
        }
    }
}

impl Reaches {
    fn check(self) -> Result<(), MeshError> {
        let wrong = |name, value, range| Err(MeshError::Number { name, value, range });
        let Self {
            alpha,
            beta,
            gamma,
            mu,
        } = self;
        if !(beta > 0.0 && beta.is_finite()) {
            return wrong("beta", beta, "greater than 0");
        }
        if !(alpha < beta && alpha.is_finite()) {
            return wrong("alpha", alpha, "less than beta");
        }
        if !(mu > 0.0 && mu <= 1.0) {
            return wrong("mu", mu, "greater than 0 and at most 1");
        }
        if !(gamma < mu && gamma.is_finite()) {
            return wrong("gamma", gamma, "less than mu");
        }
        Ok(())
    }
}

/// What becomes of points that no vertex reaches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Uncovered {
    /// They stay.
    #[default]
    Stay,
    /// They go with the nearest vertex: nothing stays behind, but the model is cut where the nearest one changes.
    Nearest,
}

/// One vertex with its edges.
#[derive(Debug, Clone)]
struct Vertex<S: Space> {
    source: S,
    target: S,
    map: S::Linear,
    /// One over the length of its longest edge.
    per_longest: f64,
    /// Its range in the edges, each divided by the square of its length.
    edges: (u32, u32),
}

/// A warp by a coarse mesh.
#[derive(Debug, Clone)]
pub struct MeshWarp<S: Space> {
    vertices: Vec<Vertex<S>>,
    edges: Vec<S>,
    wires: Vec<[u32; 2]>,
    reaches: Reaches,
    uncovered: Uncovered,
    cells: Cells<S>,
    notes: Vec<String>,
}

/// 1 up to `a`, 0 from `b` on, a smoothstep between.
#[inline(always)]
fn fall(x: f64, a: f64, b: f64) -> f64 {
    if x <= a {
        1.0
    } else if x >= b {
        0.0
    } else {
        let t = (b - x) / (b - a);
        t * t * (3.0 - 2.0 * t)
    }
}

impl<S: Rotational> MeshWarp<S> {
    /// The warp that carries the vertices `source` to `target`; `edges` join them by number. Edges without length, and those given
    /// twice, are passed over; vertices without an edge say nothing.
    ///
    /// # Errors
    /// [`MeshError`] for lists of different lengths, no edges or impossible ones, numbers that are not finite or out of their ranges, and
    /// vertices in one place with different targets.
    pub fn construct(
        source: &[S],
        target: &[S],
        edges: &[[u32; 2]],
        reaches: Reaches,
        uncovered: Uncovered,
    ) -> Result<Self, MeshError> {
        reaches.check()?;
        let count = source.len();
        if target.len() != count {
            return Err(MeshError::Count {
                source_count: count,
                target_count: target.len(),
            });
        }
        let finite = |i: &usize| source[*i].is_finite() && target[*i].is_finite();
        if let Some(vertex) = (0..count).find(|i| !finite(i)) {
            return Err(MeshError::NotFinite { vertex });
        }
        let neighbours = neighbours(source, edges)?;
        if neighbours.iter().all(Vec::is_empty) {
            return Err(MeshError::Empty);
        }
        torn(source, target, &neighbours)?;
        let mut warp = Self {
            vertices: Vec::with_capacity(count),
            edges: Vec::new(),
            wires: wires(&neighbours),
            reaches,
            uncovered,
            cells: Cells::default(),
            notes: Vec::new(),
        };
        let mut lines = 0_usize;
        for i in 0..count {
            let fan_of = |i: usize| {
                let here = neighbours[i].iter();
                here.map(move |&j| {
                    let j = j as usize;
                    (source[j] - source[i], target[j] - target[i])
                })
            };
            let own: Vec<(S, S)> = fan_of(i).collect();
            let mut reached = vec![i];
            let mut seen = std::collections::BTreeSet::from([i]);
            let (map, told) = fan(&own, |_| {
                // One ring more: the fans of all vertices that are reached then.
                let before = reached.len();
                for at in 0..before {
                    for &j in &neighbours[reached[at]] {
                        if seen.insert(j as usize) {
                            reached.push(j as usize);
                        }
                    }
                }
                let grown = reached.len() > before;
                grown.then(|| reached.iter().flat_map(|&v| fan_of(v)).collect())
            });
            lines += usize::from(told == Told::Line);
            let first = index(warp.edges.len());
            let mut longest = 0.0_f64;
            for (edge, _) in &own {
                longest = longest.max(edge.length());
                warp.edges.push(*edge / edge.dot(*edge));
            }
            warp.vertices.push(Vertex {
                source: source[i],
                target: target[i],
                map,
                per_longest: 1.0 / longest,
                edges: (first, index(warp.edges.len())),
            });
        }
        let balls = warp.vertices.iter().enumerate().filter_map(|(i, v)| {
            let radius = reaches.beta / v.per_longest;
            (v.edges.0 < v.edges.1).then_some((index(i), v.source, radius))
        });
        warp.cells = Cells::new(&balls.collect::<Vec<_>>());
        warp.notes = warp.notes_on(&neighbours, lines);
        Ok(warp)
    }

    /// Sentences for the report.
    fn notes_on(&self, neighbours: &[Vec<u32>], lines: usize) -> Vec<String> {
        let mut notes = Vec::new();
        let alone = |v: &&Vertex<S>| v.edges.0 == v.edges.1;
        let strays = self.vertices.iter().filter(alone).count();
        if strays > 0 {
            let moved = self.vertices.iter().filter(alone);
            let moved = moved.filter(|v| v.source != v.target).count();
            notes.push(format!(
                "{strays} vertices have no edge and carry nothing along, {moved} of them although they are moved"
            ));
        }
        if lines > 0 {
            notes.push(format!(
                "{lines} vertices lie on a line with all that they are joined to: they are turned by the smallest rotation (errata F13)"
            ));
        }
        // Vertices that pull at others that they are not joined to.
        let mut worst: Option<(usize, usize, f64)> = None;
        for (j, at) in self.vertices.iter().enumerate() {
            for &i in self.cells.at(at.source) {
                let other = &self.vertices[i as usize];
                let joined = neighbours[j].contains(&i) || i as usize == j;
                if joined || self.weight_of(other, at.source) == 0.0 {
                    continue;
                }
                let share = at.source.distance(other.source) * other.per_longest;
                if worst.is_none_or(|(_, _, least)| share < least) {
                    worst = Some((i as usize, j, share));
                }
            }
        }
        if let Some((i, j, share)) = worst {
            notes.push(format!(
                "vertex {i} also pulls at vertex {j}, which it is not joined to, so that this one misses its target; with beta = {share:.4} \
                 no vertex does (errata F14)"
            ));
        }
        notes
    }
}

/// An index that fits: vertices are counted by 32 bits.
fn index(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

/// The neighbours of each vertex, in ascending order, without those in the same place.
fn neighbours<S: Space>(source: &[S], edges: &[[u32; 2]]) -> Result<Vec<Vec<u32>>, MeshError> {
    let count = source.len();
    let mut neighbours = vec![Vec::new(); count];
    for edge in edges {
        let [a, b] = edge.map(|v| v as usize);
        if let Some(vertex) = [a, b].into_iter().find(|v| *v >= count) {
            return Err(MeshError::Edge { vertex, count });
        }
        // Too short to be squared is too short to have a direction.
        let square = (source[b] - source[a]).dot(source[b] - source[a]);
        if square > f64::MIN_POSITIVE {
            neighbours[a].push(index(b));
            neighbours[b].push(index(a));
        }
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    Ok(neighbours)
}

/// The joined pairs, each once.
fn wires(neighbours: &[Vec<u32>]) -> Vec<[u32; 2]> {
    let each = neighbours.iter().enumerate();
    each.flat_map(|(i, list)| {
        let i = index(i);
        list.iter().filter(move |j| **j > i).map(move |&j| [i, j])
    })
    .collect()
}

/// Refuses vertices in one place with different targets.
fn torn<S: Space>(source: &[S], target: &[S], neighbours: &[Vec<u32>]) -> Result<(), MeshError> {
    let mut order: Vec<usize> = (0..source.len())
        .filter(|i| !neighbours[*i].is_empty())
        .collect();
    let compare = |a: &usize, b: &usize| {
        (0..S::DIM)
            .map(|axis| {
                source[*a]
                    .component(axis)
                    .total_cmp(&source[*b].component(axis))
            })
            .find(|o| o.is_ne())
            .unwrap_or(std::cmp::Ordering::Equal)
    };
    order.sort_by(compare);
    for pair in order.windows(2) {
        let [first, second] = [pair[0].min(pair[1]), pair[0].max(pair[1])];
        if source[first] == source[second] && target[first] != target[second] {
            return Err(MeshError::Torn { first, second });
        }
    }
    Ok(())
}

impl<S: Space> MeshWarp<S> {
    /// How many vertices the coarse mesh has.
    pub fn len(&self) -> usize {
        self.vertices.len()
    }
    /// Whether there is none: never, as construction refuses it.
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// The weight of a vertex at a point.
    #[inline]
    fn weight_of(&self, vertex: &Vertex<S>, point: S) -> f64 {
        let Reaches {
            alpha,
            beta,
            gamma,
            mu,
        } = self.reaches;
        let away = point - vertex.source;
        let mut weight = fall(away.length() * vertex.per_longest, alpha, beta);
        for edge in &self.edges[vertex.edges.0 as usize..vertex.edges.1 as usize] {
            if weight == 0.0 {
                break;
            }
            weight *= fall(away.dot(*edge), gamma, mu);
        }
        weight
    }

    /// The vertex nearest to a point, of those with edges; of equally near ones the first.
    fn nearest(&self, point: S) -> Option<usize> {
        let with_edges = self.vertices.iter().enumerate();
        let away = with_edges
            .filter(|(_, v)| v.edges.0 < v.edges.1)
            .map(|(i, v)| (i, v.source.distance(point)));
        away.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
    }

    fn affine(vertex: &Vertex<S>) -> Affine<S> {
        Affine::about(vertex.source, vertex.map, vertex.target - vertex.source)
    }

    /// The coarse mesh before and after, for pictures.
    pub fn marks(&self) -> Vec<Mark<S>> {
        let line = |role, side: fn(&Vertex<S>) -> S| {
            self.wires.iter().map(move |wire| {
                let ends = wire.map(|i| side(&self.vertices[i as usize]));
                Mark::new(role, Shape::Polyline(ends.to_vec()))
            })
        };
        line(Role::Source, |v| v.source)
            .chain(line(Role::Target, |v| v.target))
            .collect()
    }
}

impl<S: Rotational> Deformation<S> for MeshWarp<S> {
    fn map(&self, site: &Site<S>) -> S {
        let (mut moved, mut total) = (S::ZERO, 0.0);
        for &i in self.cells.at(site.point) {
            let vertex = &self.vertices[i as usize];
            let weight = self.weight_of(vertex, site.point);
            if weight > 0.0 {
                let away = site.point - vertex.source;
                // The map's displacement about the vertex, which loses no digits far from the origin.
                let by = (vertex.map - S::Linear::IDENTITY).apply(away)
                    + (vertex.target - vertex.source);
                moved += by * weight;
                total += weight;
            }
        }
        if total > 1e-290 {
            return site.point.moved_by(moved / total);
        }
        evaluate(self, site)
    }

    fn map_points(&self, first: usize, points: &mut [S]) -> Unmapped {
        for (i, point) in points.iter_mut().enumerate() {
            *point = self.map(&Site::new(first + i, *point));
        }
        Unmapped::none()
    }

    fn facts(&self) -> Facts<S> {
        let still = |v: &Vertex<S>| v.source == v.target && v.map == S::Linear::IDENTITY;
        if self.vertices.iter().all(still) {
            return Facts::identity();
        }
        let whole = self.uncovered == Uncovered::Nearest;
        let mut facts = Facts {
            support: if whole {
                Support::Everywhere
            } else {
                self.cells.bounds().map_or(Support::Nowhere, Support::Box)
            },
            inside: if whole {
                Smoothness::Jump
            } else {
                Smoothness::C(1)
            },
            edge: Smoothness::Jump,
            translations_only: self.vertices.iter().all(|v| v.map == S::Linear::IDENTITY),
            strength_blends: true,
            weights_fade: !whole,
            ..Facts::identity()
        };
        facts.notes.clone_from(&self.notes);
        facts.with_note(if whole {
            "points that no vertex reaches go with the nearest: the warp jumps where that changes"
        } else {
            "jumps where the last weight vanishes, because strengths are 1 (errata F4); a model near the coarse mesh does not see it, and an \
             ambient weight repairs it"
        })
    }
}

impl<S: Rotational> Warp<S> for MeshWarp<S> {
    fn influences(&self, site: &Site<S>, out: &mut Influences) {
        for &i in self.cells.at(site.point) {
            let weight = self.weight_of(&self.vertices[i as usize], site.point);
            if weight > 0.0 {
                out.push(Address::of(i), 1.0, weight);
            }
        }
        if out.list.is_empty()
            && self.uncovered == Uncovered::Nearest
            && let Some(nearest) = self.nearest(site.point)
        {
            out.push(Address::of(index(nearest)), 1.0, 1.0);
        }
    }
    fn scaled(&self, address: Address, strength: f64) -> Affine<S> {
        let vertex = self.vertices.get(address.feature as usize);
        vertex.map_or(Affine::IDENTITY, |v| {
            Self::affine(v).lerp_from_identity(strength)
        })
    }
    fn conditions(&self) -> Vec<Condition<S>> {
        let all = self.vertices.iter().enumerate();
        all.filter(|(_, v)| v.edges.0 < v.edges.1)
            .map(|(i, v)| Condition {
                feature: index(i),
                source: v.source,
                target: v.target,
            })
            .collect()
    }
}
