//! A mesh in two places: what a morph of shapes starts from, checked once.
//!
//! Elements are triangles and convex quadrilaterals, in any mixture, listed in either sense. Elements that share an edge belong to one
//! part; parts have nothing to do with each other. Shapes are the image of the source by its elements, so that an element without area
//! in the source is an error, and so is one that the target turns over: strains cannot tell it from its mirror image (errata S6).
//!
//! *Source*: H.-B. Yan, S.-M. Hu, R. Martin, *Morphing based on strain field interpolation*, 2004; errata S3, S6.

use super::tensor::cross;
use anamorph_core::glam::DVec2;

/// An element of a mesh: the numbers of its vertices, around it in either sense.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Element {
    /// Three vertices; linear inside.
    Triangle([usize; 3]),
    /// Four vertices; bilinear inside.
    Quadrilateral([usize; 4]),
}

impl Element {
    /// The element of three or four vertices.
    pub fn of(vertices: &[usize]) -> Option<Self> {
        match *vertices {
            [a, b, c] => Some(Self::Triangle([a, b, c])),
            [a, b, c, d] => Some(Self::Quadrilateral([a, b, c, d])),
            _ => None,
        }
    }

    /// Its vertices, around it.
    pub fn vertices(&self) -> &[usize] {
        match self {
            Self::Triangle(vertices) => vertices,
            Self::Quadrilateral(vertices) => vertices,
        }
    }

    /// Its edges, around it.
    pub fn edges(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let vertices = self.vertices();
        (0..vertices.len()).map(|k| (vertices[k], vertices[(k + 1) % vertices.len()]))
    }

    /// The corners whose triangles say whether it is turned over: one of a triangle, all four of a quadrilateral, whose determinant is
    /// linear in its coordinates and so is least at a corner.
    pub(crate) fn corners(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let vertices = self.vertices();
        let count = vertices.len();
        let shown = if count == 3 { 1 } else { count };
        (0..shown).map(move |k| {
            let before = vertices[(k + count - 1) % count];
            [vertices[k], vertices[(k + 1) % count], before]
        })
    }

    /// Twice its area, signed.
    pub(crate) fn twice_area(&self, at: impl Fn(usize) -> DVec2) -> f64 {
        match *self {
            Self::Triangle([a, b, c]) => cross(at(b) - at(a), at(c) - at(a)),
            Self::Quadrilateral([a, b, c, d]) => cross(at(c) - at(a), at(d) - at(b)),
        }
    }
}

impl From<[usize; 3]> for Element {
    fn from(vertices: [usize; 3]) -> Self {
        Self::Triangle(vertices)
    }
}
impl From<[usize; 4]> for Element {
    fn from(vertices: [usize; 4]) -> Self {
        Self::Quadrilateral(vertices)
    }
}

/// Which of the two places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Side {
    /// Where it comes from.
    Source,
    /// Where it goes.
    Target,
}

impl std::fmt::Display for Side {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Source => "source",
            Self::Target => "target",
        })
    }
}

/// Why two places of a mesh make no pair.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PairError {
    /// Lists of unequal length.
    #[error(
        "the source has {source_count} vertices, the target {target_count}; they must be the same vertices in the same order"
    )]
    Counts {
        /// Vertices of the source.
        source_count: usize,
        /// Vertices of the target.
        target_count: usize,
    },
    /// Nothing to morph.
    #[error("the mesh has no elements; give at least one triangle or quadrilateral")]
    NoElements,
    /// More than indices can count.
    #[error("a mesh of {vertices} vertices and {elements} elements is too large")]
    TooLarge {
        /// Vertices.
        vertices: usize,
        /// Elements.
        elements: usize,
    },
    /// A vertex that there is not.
    #[error("element {element} names vertex {vertex}, but there are only {count}, counted from 0")]
    Index {
        /// The element.
        element: usize,
        /// The vertex it names.
        vertex: usize,
        /// How many there are.
        count: usize,
    },
    /// A vertex twice in one element.
    #[error("element {element} names vertex {vertex} twice")]
    Repeated {
        /// The element.
        element: usize,
        /// The vertex.
        vertex: usize,
    },
    /// Infinite coordinates, or none.
    #[error("vertex {vertex} of the {side} is not at a finite place")]
    NotFinite {
        /// In which place.
        side: Side,
        /// The vertex.
        vertex: usize,
    },
    /// An element that no strain can be measured from.
    #[error(
        "element {element} of the source has no area, or is a quadrilateral that is not convex (vertices {vertices:?}); remove it or move its vertices"
    )]
    Degenerate {
        /// The element.
        element: usize,
        /// Its vertices.
        vertices: Vec<usize>,
    },
    /// An element that lies the other way round in the target.
    #[error(
        "element {element} (vertices {vertices:?}) is turned over in the target, or not convex there; mirror the target or mend the mesh"
    )]
    Turned {
        /// The element.
        element: usize,
        /// Its vertices.
        vertices: Vec<usize>,
    },
    /// More than two elements at an edge.
    #[error("more than two elements share the edge from vertex {from} to vertex {to}")]
    Edge {
        /// An end of it.
        from: usize,
        /// Its other end.
        to: usize,
    },
}

/// A connected part of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Part {
    /// Its vertices, ascending.
    pub(crate) vertices: Vec<usize>,
    /// Its elements, ascending.
    pub(crate) elements: Vec<usize>,
}

/// A mesh with a place in the source and one in the target for every vertex.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    source: Vec<DVec2>,
    target: Vec<DVec2>,
    elements: Vec<Element>,
    parts: Vec<Part>,
    boundary: Vec<(usize, usize)>,
    /// Pairs of elements that share an edge.
    neighbours: Vec<(usize, usize)>,
    /// Elements without area in the target.
    vanishing: Vec<usize>,
}

/// Twice the area of a triangle whose longest edge is 1, under which it has none.
const NO_AREA: f64 = 1e-14;

/// What the corners of an element say: the sense in which it lies (0: no area), or nothing if they disagree.
fn sense(element: &Element, positions: &[DVec2]) -> Option<f64> {
    let vertices = element.vertices();
    let origin = positions[vertices[0]];
    let largest = vertices.iter().fold(0.0_f64, |most, &v| {
        most.max((positions[v] - origin).abs().max_element())
    });
    if largest == 0.0 {
        return Some(0.0);
    }
    let at = |v: usize| (positions[v] - origin) / largest;
    let (mut positive, mut negative) = (0, 0);
    for [a, b, c] in element.corners() {
        let area = cross(at(b) - at(a), at(c) - at(a));
        positive += usize::from(area > NO_AREA);
        negative += usize::from(area < -NO_AREA);
    }
    match (positive, negative) {
        (0, 0) => Some(0.0),
        (_, 0) => Some(1.0),
        (0, _) => Some(-1.0),
        _ => None,
    }
}

/// Whether some corner of an element has no area.
fn has_flat_corner(element: &Element, positions: &[DVec2]) -> bool {
    let origin = positions[element.vertices()[0]];
    let largest = element.vertices().iter().fold(0.0_f64, |most, &v| {
        most.max((positions[v] - origin).abs().max_element())
    });
    let at = |v: usize| (positions[v] - origin) / largest;
    largest == 0.0
        || element
            .corners()
            .any(|[a, b, c]| cross(at(b) - at(a), at(c) - at(a)).abs() <= NO_AREA)
}

impl Pair {
    /// The elements between these places.
    ///
    /// # Errors
    /// [`PairError`], which names the vertex or element.
    pub fn new(
        source: Vec<DVec2>,
        target: Vec<DVec2>,
        elements: Vec<Element>,
    ) -> Result<Self, PairError> {
        let count = source.len();
        if count != target.len() {
            return Err(PairError::Counts {
                source_count: count,
                target_count: target.len(),
            });
        }
        if elements.is_empty() {
            return Err(PairError::NoElements);
        }
        if count > (i32::MAX / 4) as usize || elements.len() > (i32::MAX / 64) as usize {
            return Err(PairError::TooLarge {
                vertices: count,
                elements: elements.len(),
            });
        }
        for (side, positions) in [(Side::Source, &source), (Side::Target, &target)] {
            // A place whose distances overflow is none either.
            let wild = |p: &DVec2| p.is_nan() || p.abs().max_element() >= 1e150;
            if let Some(vertex) = positions.iter().position(wild) {
                return Err(PairError::NotFinite { side, vertex });
            }
        }
        let mut vanishing = Vec::new();
        for (number, element) in elements.iter().enumerate() {
            let vertices = element.vertices();
            if let Some(&vertex) = vertices.iter().find(|&&v| v >= count) {
                return Err(PairError::Index {
                    element: number,
                    vertex,
                    count,
                });
            }
            for (k, vertex) in vertices.iter().enumerate() {
                if vertices[..k].contains(vertex) {
                    return Err(PairError::Repeated {
                        element: number,
                        vertex: *vertex,
                    });
                }
            }
            let here = sense(element, &source).unwrap_or(0.0);
            if here == 0.0 || has_flat_corner(element, &source) {
                return Err(PairError::Degenerate {
                    element: number,
                    vertices: vertices.to_vec(),
                });
            }
            match sense(element, &target) {
                Some(there) if there * here >= 0.0 => {
                    if has_flat_corner(element, &target) {
                        vanishing.push(number);
                    }
                }
                _ => {
                    return Err(PairError::Turned {
                        element: number,
                        vertices: vertices.to_vec(),
                    });
                }
            }
        }
        let mut edges: Vec<(usize, usize, usize)> = Vec::with_capacity(4 * elements.len());
        for (number, element) in elements.iter().enumerate() {
            edges.extend(element.edges().map(|(a, b)| (a.min(b), a.max(b), number)));
        }
        edges.sort_unstable();
        let (mut lone, mut neighbours) = (Vec::new(), Vec::new());
        for run in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            match *run {
                [(from, to, element)] => lone.push((from, to, element)),
                [(.., first), (.., second)] => neighbours.push((first, second)),
                [(from, to, _), ..] => return Err(PairError::Edge { from, to }),
                [] => {}
            }
        }
        let parts = parts(count, &elements, &neighbours);
        // In the order of elements, and around each.
        lone.sort_unstable_by_key(|&(from, to, element)| (element, from, to));
        let boundary = lone.into_iter().map(|(from, to, _)| (from, to)).collect();
        Ok(Self {
            source,
            target,
            elements,
            parts,
            boundary,
            neighbours,
            vanishing,
        })
    }

    /// Places of the vertices in the source.
    pub fn source(&self) -> &[DVec2] {
        &self.source
    }
    /// Places of the vertices in the target.
    pub fn target(&self) -> &[DVec2] {
        &self.target
    }
    /// The elements.
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }
    /// How many parts there are that nothing connects.
    pub fn part_count(&self) -> usize {
        self.parts.len()
    }
    /// Edges of one element only.
    pub fn boundary(&self) -> &[(usize, usize)] {
        &self.boundary
    }
    /// Elements that have no area in the target.
    pub fn vanishing(&self) -> &[usize] {
        &self.vanishing
    }
    pub(crate) fn parts(&self) -> &[Part] {
        &self.parts
    }
    pub(crate) fn neighbours(&self) -> &[(usize, usize)] {
        &self.neighbours
    }

    /// From the target back to the source.
    ///
    /// # Errors
    /// [`PairError::Degenerate`] if an element has no area in the target.
    pub fn reversed(&self) -> Result<Self, PairError> {
        Self::new(
            self.target.clone(),
            self.source.clone(),
            self.elements.clone(),
        )
    }
}

/// The root of a tree of numbers, with paths halved on the way.
pub(crate) fn root(above: &mut [usize], mut of: usize) -> usize {
    while above[of] != of {
        above[of] = above[above[of]];
        of = above[of];
    }
    of
}

/// Parts in the order of their first elements. Elements that meet at a vertex only are parts of their own where no edge joins them, but a
/// vertex can be in one place only, so that they count as one.
fn parts(count: usize, elements: &[Element], neighbours: &[(usize, usize)]) -> Vec<Part> {
    let mut above: Vec<usize> = (0..elements.len()).collect();
    let join = |above: &mut Vec<usize>, a: usize, b: usize| {
        let (a, b) = (root(above, a), root(above, b));
        above[a.max(b)] = a.min(b);
    };
    for &(a, b) in neighbours {
        join(&mut above, a, b);
    }
    let mut first = vec![usize::MAX; count];
    for (number, element) in elements.iter().enumerate() {
        for &vertex in element.vertices() {
            if first[vertex] == usize::MAX {
                first[vertex] = number;
            } else {
                join(&mut above, first[vertex], number);
            }
        }
    }
    let mut number_of = vec![usize::MAX; elements.len()];
    let mut parts: Vec<Part> = Vec::new();
    for element in 0..elements.len() {
        let top = root(&mut above, element);
        if number_of[top] == usize::MAX {
            number_of[top] = parts.len();
            parts.push(Part {
                vertices: Vec::new(),
                elements: Vec::new(),
            });
        }
        parts[number_of[top]].elements.push(element);
    }
    for (vertex, &element) in first.iter().enumerate() {
        if element != usize::MAX {
            let top = root(&mut above, element);
            parts[number_of[top]].vertices.push(vertex);
        }
    }
    parts
}
