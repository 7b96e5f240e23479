//! Elements: points, segments, rectangles and boxes, of one kind because all are a corner with none to three edges.
//!
//! *Source*: A. Lerios, C. D. Garfinkle, M. Levoy, *Feature-Based Volume Metamorphosis*, SIGGRAPH 1995, who call them
//! elements; Milliron et al. 2002, §4.2: an element constrains as many basis vectors as it has edges, and the others are
//! perpendicular to these and to each other; T. Beier and S. Neely, *Feature-Based Image Metamorphosis*, SIGGRAPH 1992, for
//! the segment of the plane. Errata F6: a segment without length is a point, and one that loses its length keeps the
//! directions across. That edges may meet at any angle is a decision.

use crate::{FeatureError, Pair};
use anamorph_core::{Affine, Linear, Mark, Role, Shape, Space};

/// Edges whose volume is below this share of the product of their lengths are dependent.
const INDEPENDENT: f64 = 1e-12;
/// Edges whose cosine is below this are perpendicular: the distance is off by no more than this share of an edge.
const PERPENDICULAR: f64 = 1e-15;
/// Directions this close to opposite have no smallest turn.
const OPPOSITE: f64 = 1e-12;

/// One edge of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Edge<S> {
    vector: S,
    /// Of length 1, or null.
    direction: S,
    length: f64,
}

impl<S: Space> Edge<S> {
    fn new(vector: S) -> Self {
        Self {
            vector,
            direction: vector.normalized().unwrap_or(S::ZERO),
            length: vector.length(),
        }
    }

    /// The part of the edge that is nearest in its direction to `from`, a vector from its start, and whether that is neither
    /// end.
    #[inline(always)]
    fn clamped(&self, from: S) -> (S, bool) {
        let along = from.dot(self.direction);
        if along <= 0.0 {
            (S::ZERO, false)
        } else if along >= self.length {
            (self.vector, false)
        } else {
            (self.direction * along, true)
        }
    }
}

/// A point, a segment, a rectangle or a box (or, with edges at other angles, a parallelogram or parallelepiped).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element<S: Space> {
    corner: S,
    edges: [Edge<S>; 3],
    count: usize,
    /// All edges are perpendicular.
    square: bool,
    /// Lengths along oblique edges that fill space of a vector.
    inverse: S::Linear,
}

impl<S: Space> Element<S> {
    /// The element with the given corners: a point; the ends of a segment; a corner of a rectangle and the two next to it; a
    /// corner of a box and the three next to it.
    ///
    /// # Errors
    /// [`FeatureError::Corners`] for none or more corners than dimensions and one, [`FeatureError::NotFinite`], and
    /// [`FeatureError::Flat`] for a rectangle or box with dependent edges. A segment may have no length.
    pub fn new(corners: &[S]) -> Result<Self, FeatureError> {
        Self::named(corners, "element", true)
    }

    /// A point.
    ///
    /// # Errors
    /// [`FeatureError::NotFinite`].
    pub fn point(at: S) -> Result<Self, FeatureError> {
        Self::new(&[at])
    }

    /// A segment, possibly without length.
    ///
    /// # Errors
    /// [`FeatureError::NotFinite`].
    pub fn segment(from: S, to: S) -> Result<Self, FeatureError> {
        Self::new(&[from, to])
    }

    /// As [`Element::new`], called `what` in errors; `solid` forbids dependent edges.
    fn named(corners: &[S], what: &'static str, solid: bool) -> Result<Self, FeatureError> {
        let (Some(&corner), true) = (corners.first(), corners.len() <= S::DIM + 1) else {
            return Err(FeatureError::Corners {
                space: S::NAME,
                found: corners.len(),
                most: S::DIM + 1,
            });
        };
        let mut edges = [Edge::new(S::ZERO); 3];
        for (edge, &to) in edges.iter_mut().zip(&corners[1..]) {
            *edge = Edge::new(to - corner);
        }
        let count = corners.len() - 1;
        let finite = |e: &Edge<S>| e.vector.is_finite() && e.length.is_finite();
        if !(corners.iter().all(|c| c.is_finite()) && edges.iter().all(finite)) {
            return Err(FeatureError::NotFinite { what });
        }
        let mut element = Self {
            corner,
            edges,
            count,
            square: true,
            inverse: S::Linear::IDENTITY,
        };
        if count > 1 {
            let volume = element.volume_of_directions();
            if solid && volume <= INDEPENDENT {
                let flat = if count == 3 { "plane" } else { "line" };
                return Err(FeatureError::Flat { what, flat });
            }
            let cosine = |i: usize, j: usize| edges[i].direction.dot(edges[j].direction).abs();
            element.square = (0..count).all(|j| (0..j).all(|i| cosine(i, j) <= PERPENDICULAR));
            let unit = S::Linear::from_columns(|i| edges[i].direction);
            if let (true, Some(inverse)) = (count == S::DIM, unit.inverted()) {
                element.inverse = inverse;
            }
        }
        Ok(element)
    }

    /// The target of an element: as [`Element::new`], but a box may be flat.
    ///
    /// # Errors
    /// As [`Element::new`].
    pub fn target(corners: &[S]) -> Result<Self, FeatureError> {
        Self::named(corners, "target", corners.len() <= S::DIM)
    }

    /// Volume (area, length) of the parallelotope of the edges' directions.
    fn volume_of_directions(&self) -> f64 {
        let [a, b, _] = self.edges.map(|e| e.direction);
        if self.count == S::DIM {
            let unit = S::Linear::from_columns(|i| self.edges[i].direction);
            return unit.determinant().abs();
        }
        // A parallelogram of space.
        (b - a * a.dot(b)).length()
    }

    /// The first corner: the origin of the element's frame.
    pub fn corner(&self) -> S {
        self.corner
    }
    /// Number of edges: 0 for a point to 3 for a box; so many basis vectors it constrains.
    pub fn dimension(&self) -> usize {
        self.count
    }
    /// Edge number `index` as a vector from the first corner; null if there is none.
    pub fn edge(&self, index: usize) -> S {
        self.edges.get(index).map_or(S::ZERO, |e| e.vector)
    }
    /// Direction of edge `index`, of length 1; null without length.
    pub fn direction(&self, index: usize) -> S {
        self.edges.get(index).map_or(S::ZERO, |e| e.direction)
    }
    /// Length of edge `index`.
    pub fn length(&self, index: usize) -> f64 {
        self.edges.get(index).map_or(0.0, |e| e.length)
    }

    /// Whether the edges are perpendicular to each other, as those of points and segments are.
    pub fn is_square(&self) -> bool {
        self.square
    }

    /// The geometric mean of the edges' lengths: a segment's length; 0 for a point.
    pub fn size(&self) -> f64 {
        let lengths = self.edges.map(|e| e.length);
        match self.count {
            0 => 0.0,
            1 => lengths[0],
            // Roots first, so that nothing overflows.
            2 => lengths[0].sqrt() * lengths[1].sqrt(),
            _ => {
                let [a, b, c] = lengths.map(anamorph_core::math::cbrt);
                a * b * c
            }
        }
    }

    /// The point at the given shares of the edges.
    pub fn at(&self, shares: [f64; 3]) -> S {
        let edges = self.edges.iter().zip(shares).take(self.count);
        edges.fold(self.corner, |p, (e, share)| p + e.vector * share)
    }

    /// All corners, 2 to the power of [`Element::dimension`]: the bits of their number say which edges lead there.
    pub fn corners(&self) -> Vec<S> {
        let bit = |number: u32, i: u32| f64::from(number >> i & 1);
        (0..1_u32 << self.count)
            .map(|number| self.at([0, 1, 2].map(|i| bit(number, i))))
            .collect()
    }

    /// The sides that are segments, as pairs of corners; for a segment itself.
    pub fn sides(&self) -> Vec<[S; 2]> {
        let corners = self.corners();
        let pair = |from: usize, edge: usize| {
            let to = from | 1 << edge;
            (to != from).then(|| [corners[from], corners[to]])
        };
        (0..self.count)
            .flat_map(|edge| (0..corners.len()).filter_map(move |from| pair(from, edge)))
            .collect()
    }

    /// From the nearest point of the element to `p`: null inside a box and on anything.
    #[inline]
    pub fn offset(&self, p: S) -> S {
        let from = p - self.corner;
        match self.count {
            0 => from,
            1 => from - self.edges[0].clamped(from).0,
            count if self.square => {
                // Within all edges of what fills space, rounding shall leave nothing.
                let (mut rest, mut inside) = (from, count == S::DIM);
                for edge in &self.edges[..count] {
                    let (part, within) = edge.clamped(from);
                    rest -= part;
                    inside &= within;
                }
                if inside { S::ZERO } else { rest }
            }
            count => {
                let inside = || {
                    let along = self.inverse.apply(from);
                    (0..count).all(|i| (0.0..=self.edges[i].length).contains(&along.component(i)))
                };
                if count == S::DIM && inside() {
                    return S::ZERO;
                }
                oblique(&self.edges[..count], from)
            }
        }
    }

    /// Distance to the nearest point of the element.
    #[inline]
    pub fn distance(&self, p: S) -> f64 {
        self.offset(p).length()
    }

    /// The unit normal of an element with one edge fewer than dimensions: a segment of the plane (to its left) or a rectangle
    /// of space (by the right-hand rule). `None` for others and for what has no extent.
    pub fn normal(&self) -> Option<S> {
        if self.count + 1 != S::DIM {
            return None;
        }
        // The last cofactor column of a matrix without last column is the cross product of the others.
        let edges = S::Linear::from_columns(|i| self.edges[i].direction);
        let normal = edges.cofactor().column(self.count);
        (normal.length() > INDEPENDENT).then(|| normal.normalized())?
    }

    /// The element's outline.
    fn marks(&self, role: Role) -> Vec<Mark<S>> {
        let c = self.corners();
        let line = |list: &[usize]| {
            let points = list.iter().map(|&i| c[i]).collect();
            Mark::new(role, Shape::Polyline(points))
        };
        match self.count {
            0 => vec![Mark::new(role, Shape::Point(self.corner))],
            1 if self.edges[0].length == 0.0 => vec![Mark::new(role, Shape::Point(self.corner))],
            // Directed.
            1 => vec![Mark::new(role, Shape::Arrow(c[0], c[1]))],
            2 => vec![line(&[0, 1, 3, 2, 0])],
            _ => vec![
                line(&[0, 1, 3, 2, 0, 4, 5, 7, 6, 4]),
                line(&[1, 5]),
                line(&[3, 7]),
                line(&[2, 6]),
            ],
        }
    }
}

/// [`Element::offset`] for edges at any angles, outside of what they fill.
fn oblique<S: Space>(edges: &[Edge<S>], from: S) -> S {
    match *edges {
        [] => from,
        [edge] => from - edge.clamped(from).0,
        [a, b] => {
            // Lengths along two directions that are not perpendicular.
            let cosine = a.direction.dot(b.direction);
            let (along_a, along_b) = (from.dot(a.direction), from.dot(b.direction));
            let sine2 = 1.0 - cosine * cosine;
            let s = (along_a - cosine * along_b) / sine2;
            let t = (along_b - cosine * along_a) / sine2;
            if (0.0..=a.length).contains(&s) && (0.0..=b.length).contains(&t) {
                return from - a.direction * s - b.direction * t;
            }
            nearest_face(edges, from)
        }
        _ => nearest_face(edges, from),
    }
}

/// The shortest offset from a face: edges without one of them, at its start or at its end.
fn nearest_face<S: Space>(edges: &[Edge<S>], from: S) -> S {
    let mut nearest = (f64::INFINITY, from);
    for skipped in 0..edges.len() {
        let mut rest = [edges[0]; 2];
        let others = edges.iter().enumerate().filter(|&(i, _)| i != skipped);
        for (slot, (_, &edge)) in rest.iter_mut().zip(others) {
            *slot = edge;
        }
        let rest = &rest[..edges.len() - 1];
        for start in [from, from - edges[skipped].vector] {
            let offset = oblique(rest, start);
            let distance = offset.length();
            if distance < nearest.0 {
                nearest = (distance, offset);
            }
        }
    }
    nearest.1
}

/// The smallest turn from one unit vector to another, two reflections. Opposite vectors have none: then a half turn about
/// `from` × (the coordinate axis least aligned with it), which in the plane is the half turn.
fn smallest_turn<S: Space>(from: S, to: S) -> S::Linear {
    let reflection = |w: S| S::Linear::IDENTITY - S::Linear::outer(w, w) * 2.0;
    let sum = from + to;
    let between = (sum.length() > OPPOSITE)
        .then(|| sum.normalized())
        .flatten();
    let mirror = between.unwrap_or_else(|| {
        let least = (0..S::DIM)
            .min_by(|&a, &b| {
                let size = |axis| f64::abs(from.component(axis));
                size(a).total_cmp(&size(b))
            })
            .map_or(S::ZERO, S::unit);
        let across = least - from * least.dot(from);
        across.normalized().unwrap_or(S::ZERO)
    });
    reflection(mirror).after(&reflection(from))
}

/// A source element and the target element it should become, with as many edges.
pub type ElementPair<S> = Pair<Element<S>>;

impl<S: Space> Pair<Element<S>> {
    /// The pair of the elements with the given corners; see [`Element::new`].
    ///
    /// # Errors
    /// Those of [`Element::new`] for either; [`FeatureError::Unlike`]. A target segment may lose its length and a target
    /// that fills space may be flat; a rectangle of space may not, because that leaves its normal open.
    pub fn of_corners(source: &[S], target: &[S]) -> Result<Self, FeatureError> {
        if source.len() != target.len() {
            return Err(FeatureError::Unlike {
                source_corners: source.len(),
                target_corners: target.len(),
            });
        }
        Ok(Self {
            source: Element::named(source, "source", true)?,
            target: Element::target(target)?,
        })
    }

    /// The affine map that takes the source to the target: corner to corner, edge to edge, and whatever is perpendicular to
    /// the source, without stretch, to what is perpendicular to the target; a segment of space turns no more than it must.
    ///
    /// A point, and a segment without length, is a translation. A target segment without length keeps the source's
    /// directions across.
    ///
    /// # Errors
    /// [`FeatureError::Overflow`] for elements that differ too much in size; [`FeatureError::Flat`] for a target rectangle
    /// of space without area.
    pub fn affine(&self) -> Result<Affine<S>, FeatureError> {
        let (source, target) = (&self.source, &self.target);
        let edges = source.edges.iter().zip(&target.edges);
        let alike = edges.clone().all(|(s, t)| s.vector == t.vector);
        let first = (source.edges[0], target.edges[0]);
        if alike || source.count == 0 || source.count == 1 && first.0.length == 0.0 {
            return self.about_corner(S::Linear::IDENTITY);
        }
        if let Some(normal) = source.normal() {
            let across = match (target.normal(), source.count) {
                (Some(across), _) => across,
                (None, 1) => normal,
                (None, _) => {
                    return Err(FeatureError::Flat {
                        what: "target",
                        flat: "line",
                    });
                }
            };
            return self.affine_across(across);
        }
        if source.count == 1 {
            let (from, to) = (first.0.direction, first.1.direction);
            let turn = if to == S::ZERO {
                S::Linear::IDENTITY
            } else {
                smallest_turn(from, to)
            };
            let along = S::Linear::outer(from, from);
            let stretched = S::Linear::outer(first.1.vector / first.0.length, from);
            return self.about_corner(stretched + turn.after(&(S::Linear::IDENTITY - along)));
        }
        self.about_corner(self.columns(S::ZERO, S::ZERO)?)
    }

    /// As [`Pair::affine`] for elements with one edge fewer than dimensions, with the unit normal of the source taken to
    /// `across` instead of the target's.
    ///
    /// # Errors
    /// [`FeatureError::Overflow`]; a source without normal is a translation.
    pub fn affine_across(&self, across: S) -> Result<Affine<S>, FeatureError> {
        match self.source.normal() {
            None => self.about_corner(S::Linear::IDENTITY),
            Some(normal) => {
                let edges = self.source.edges.iter().zip(&self.target.edges);
                let alike = normal == across && edges.clone().all(|(s, t)| s.vector == t.vector);
                self.about_corner(if alike {
                    S::Linear::IDENTITY
                } else {
                    self.columns(normal, across)?
                })
            }
        }
    }

    /// The linear map of edges to edges and `normal`, if the edges leave one open, to `across`.
    fn columns(&self, normal: S, across: S) -> Result<S::Linear, FeatureError> {
        let count = self.source.count;
        // Scaled to unit columns, which keeps unequal edges from looking dependent.
        let from = S::Linear::from_columns(|i| {
            if i < count {
                self.source.edges[i].direction
            } else {
                normal
            }
        });
        let to = S::Linear::from_columns(|i| {
            if i < count {
                self.target.edges[i].vector / self.source.edges[i].length
            } else {
                across
            }
        });
        let inverse = from.inverted().ok_or(FeatureError::Overflow)?;
        Ok(to.after(&inverse))
    }

    /// The affine map with a linear part about the source's corner, and the corner to the target's.
    fn about_corner(&self, linear: S::Linear) -> Result<Affine<S>, FeatureError> {
        let offset = self.target.corner - self.source.corner;
        let map = Affine::about(self.source.corner, linear, offset);
        if map.is_finite() {
            Ok(map)
        } else {
            Err(FeatureError::Overflow)
        }
    }

    /// The source's corner: the centre about which the map is scaled (errata F18).
    pub fn centre(&self) -> S {
        self.source.corner
    }

    /// The outlines of both; for points an arrow between them.
    pub fn marks(&self) -> Vec<Mark<S>> {
        if self.source.count == 0 {
            return crate::PointPair::new(self.source.corner, self.target.corner).marks();
        }
        let mut marks = self.source.marks(Role::Source);
        marks.extend(self.target.marks(Role::Target));
        marks
    }
}

#[cfg(test)]
mod tests;
