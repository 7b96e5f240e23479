//! What an inspection reports, and the checks that hold for faces of any format.

use crate::faces::Faces;
use crate::normals::area_vector;
use anamorph_core::glam::DVec3;

/// The result of [`Document::inspect`](crate::Document::inspect).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Inspection {
    /// The name of the format.
    pub format: &'static str,
    /// Number of coordinates of a point: 2 or 3.
    pub dimension: usize,
    /// How many there are of what, by the format's own terms, such as `("vertices", 8)`.
    pub counts: Vec<(&'static str, u64)>,
    /// Smallest and largest coordinates of the finite points, one per dimension; `None` without finite points.
    pub bounds: Option<(Vec<f64>, Vec<f64>)>,
    /// Names of the attributes.
    pub attributes: Vec<String>,
    /// What is wrong or odd, each kind once.
    pub problems: Vec<Problem>,
}

/// One kind of problem and where it first occurs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// What is wrong.
    pub kind: ProblemKind,
    /// How often it occurs.
    pub count: u64,
    /// The first occurrence, in words: `vertex 7`, `face 3 (vertex 12 of 8)`.
    pub first: String,
    /// The line of the first occurrence, where a line can be named.
    pub line: Option<u64>,
}

/// What can be wrong with a model that can still be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum ProblemKind {
    /// A coordinate is NaN or infinite.
    NonFinitePoint,
    /// An attribute's value is NaN or infinite.
    NonFiniteAttribute,
    /// A normal is not three finite numbers.
    NonFiniteNormal,
    /// A face, line or point element is malformed or refers to a vertex that does not exist.
    BrokenElement,
    /// A face refers to a normal or texture coordinate that does not exist.
    DanglingReference,
    /// Some corners of a face have a normal or texture coordinate and others have not.
    MixedReferences,
    /// A face has a vertex twice.
    RepeatedVertex,
    /// The corners of a face are distinct but span no area.
    ZeroAreaFace,
    /// No element uses a vertex, though there are elements.
    UnusedVertex,
    /// A vertex lies exactly where an earlier one does.
    CoincidentVertex,
    /// More than two faces share an edge.
    NonManifoldEdge,
    /// Two faces run along their common edge in the same direction: one of them is turned inside out.
    InconsistentWinding,
}

impl ProblemKind {
    /// A name for machines, lower case with hyphens.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NonFinitePoint => "non-finite-point",
            Self::NonFiniteAttribute => "non-finite-attribute",
            Self::NonFiniteNormal => "non-finite-normal",
            Self::BrokenElement => "broken-element",
            Self::DanglingReference => "dangling-reference",
            Self::MixedReferences => "mixed-references",
            Self::RepeatedVertex => "repeated-vertex",
            Self::ZeroAreaFace => "zero-area-face",
            Self::UnusedVertex => "unused-vertex",
            Self::CoincidentVertex => "coincident-vertex",
            Self::NonManifoldEdge => "non-manifold-edge",
            Self::InconsistentWinding => "inconsistent-winding",
        }
    }
    /// What it is, in words, for many: "faces with a vertex twice".
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::NonFinitePoint => "points with NaN or infinite coordinates",
            Self::NonFiniteAttribute => "attribute values that are NaN or infinite",
            Self::NonFiniteNormal => "normals that are not three finite numbers",
            Self::BrokenElement => {
                "elements that are malformed or refer to vertices that do not exist"
            }
            Self::DanglingReference => {
                "references to normals or texture coordinates that do not exist"
            }
            Self::MixedReferences => {
                "faces where only some corners have a normal or texture coordinate"
            }
            Self::RepeatedVertex => "faces with a vertex twice",
            Self::ZeroAreaFace => "faces without area",
            Self::UnusedVertex => "vertices that no element uses",
            Self::CoincidentVertex => "vertices exactly where an earlier one lies",
            Self::NonManifoldEdge => "edges shared by more than two faces",
            Self::InconsistentWinding => {
                "edges along which two faces run the same way (one is inside out)"
            }
        }
    }
}

/// A problem as a check finds it: the format names the line.
pub(crate) struct Finding {
    pub(crate) kind: ProblemKind,
    pub(crate) count: u64,
    pub(crate) first: First,
}

/// Where a finding first occurs; indices from 0.
#[derive(Clone, Copy)]
pub(crate) enum First {
    Vertex(usize),
    Face(usize),
    /// An edge by its vertices, and the face that makes it a problem.
    Edge(u32, u32, usize),
}

impl First {
    /// In words, counting from 1.
    pub(crate) fn words(self) -> String {
        match self {
            Self::Vertex(v) => format!("vertex {}", v + 1),
            Self::Face(f) => format!("face {}", f + 1),
            Self::Edge(a, b, f) => format!(
                "edge {}–{} of face {}",
                u64::from(a) + 1,
                u64::from(b) + 1,
                f + 1
            ),
        }
    }
}

/// Collects occurrences of one kind, lowest first.
struct Tally(ProblemKind, u64, Option<First>);

impl Tally {
    fn new(kind: ProblemKind) -> Self {
        Self(kind, 0, None)
    }
    fn add(&mut self, first: First) {
        self.1 += 1;
        self.2.get_or_insert(first);
    }
    fn report(self, findings: &mut Vec<Finding>) {
        if let Some(first) = self.2 {
            findings.push(Finding {
                kind: self.0,
                count: self.1,
                first,
            });
        }
    }
}

/// Vertices that lie exactly where an earlier one does. Those that are not finite lie nowhere.
pub(crate) fn coincident<const D: usize>(
    points: impl Iterator<Item = [f64; D]>,
    findings: &mut Vec<Finding>,
) {
    // Adding 0 turns −0 into 0.
    let mut keyed: Vec<([u64; D], usize)> = points
        .enumerate()
        .filter(|(_, p)| p.iter().all(|c| c.is_finite()))
        .map(|(i, p)| (p.map(|c| (c + 0.0).to_bits()), i))
        .collect();
    keyed.sort_unstable();
    let mut again: Vec<usize> = keyed
        .windows(2)
        .filter(|pair| pair[0].0 == pair[1].0)
        .map(|pair| pair[1].1)
        .collect();
    again.sort_unstable();
    let mut tally = Tally::new(ProblemKind::CoincidentVertex);
    again.into_iter().for_each(|v| tally.add(First::Vertex(v)));
    tally.report(findings);
}

/// A face spans no area when its area is below this fraction of its longest side squared: rounding of coordinates that
/// were collinear when written with seven digits gives about 10⁻⁷, of exact ones 10⁻¹⁶. Only the latter is meant.
const NO_AREA: f64 = 1e-14;

/// Degenerate faces, and edges that make a surface no surface. Returns the number of boundary edges.
pub(crate) fn faces(faces: &Faces, points: &[DVec3], findings: &mut Vec<Finding>) -> u64 {
    let mut repeated = Tally::new(ProblemKind::RepeatedVertex);
    let mut flat = Tally::new(ProblemKind::ZeroAreaFace);
    // Each directed edge as (low, high, face, whether from low to high).
    let mut edges: Vec<(u32, u32, u32, bool)> = Vec::with_capacity(faces.vertices.len());
    for f in 0..faces.len() {
        let face = faces.vertices(f);
        let mut sorted = face.to_vec();
        sorted.sort_unstable();
        if sorted.windows(2).any(|pair| pair[0] == pair[1]) {
            repeated.add(First::Face(f));
        } else if face.iter().all(|v| points[*v as usize].is_finite()) {
            let side =
                |i: usize| points[face[i] as usize] - points[face[(i + 1) % face.len()] as usize];
            let size =
                (0..face.len()).fold(0.0_f64, |size, i| size.max(side(i).abs().max_element()));
            let area = area_vector(face.len(), |i| {
                (points[face[i] as usize] - points[face[0] as usize]) / size
            })
            .length();
            // An infinite size: too large to tell.
            if size == 0.0 || size.is_finite() && area <= NO_AREA {
                flat.add(First::Face(f));
            }
        }
        for (i, &a) in face.iter().enumerate() {
            let b = face[(i + 1) % face.len()];
            if a != b {
                edges.push((a.min(b), a.max(b), f as u32, a < b));
            }
        }
    }
    repeated.report(findings);
    flat.report(findings);

    edges.sort_unstable();
    let (mut boundary, mut crowded, mut turned) = (0, Vec::new(), Vec::new());
    for same in edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        match same {
            [_] => boundary += 1,
            [first, second] if first.3 == second.3 => turned.push((second.2, second.0, second.1)),
            [_, _] => {}
            [_, _, third, ..] => crowded.push((third.2, third.0, third.1)),
            [] => {}
        }
    }
    for (kind, mut list) in [
        (ProblemKind::NonManifoldEdge, crowded),
        (ProblemKind::InconsistentWinding, turned),
    ] {
        list.sort_unstable();
        let mut tally = Tally::new(kind);
        list.into_iter()
            .for_each(|(f, a, b)| tally.add(First::Edge(a, b, f as usize)));
        tally.report(findings);
    }
    boundary
}

/// Vertices that `used` does not mark, if any is marked at all: points alone are a cloud, not a mesh with leftovers.
pub(crate) fn unused(used: &[bool], findings: &mut Vec<Finding>) {
    if used.contains(&true) {
        let mut tally = Tally::new(ProblemKind::UnusedVertex);
        used.iter()
            .enumerate()
            .filter(|(_, u)| !**u)
            .for_each(|(v, _)| tally.add(First::Vertex(v)));
        tally.report(findings);
    }
}

/// Bounds of the finite points.
pub(crate) fn bounds<const D: usize>(
    points: impl Iterator<Item = [f64; D]>,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let mut finite = points.filter(|p| p.iter().all(|c| c.is_finite()));
    let first = finite.next()?;
    let (low, high) = finite.fold((first, first), |(mut low, mut high), p| {
        for axis in 0..D {
            low[axis] = low[axis].min(p[axis]);
            high[axis] = high[axis].max(p[axis]);
        }
        (low, high)
    });
    Some((low.to_vec(), high.to_vec()))
}
