//! What can be wrong with a mesh, and with a place on it.

/// Why triangles have no topology.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum TopologyError {
    /// There is no face.
    #[error("the mesh has no faces; give at least one triangle")]
    Empty,
    /// A face names a vertex that does not exist.
    #[error(
        "face {face} names vertex {vertex}, but there are only {vertices} vertices, numbered from 0; mend the face's indices"
    )]
    IndexOutOfRange {
        /// Number of the face, from 0.
        face: usize,
        /// The vertex it names.
        vertex: usize,
        /// How many vertices there are.
        vertices: usize,
    },
    /// Every face repeats a vertex.
    #[error(
        "all {faces} faces name a vertex twice, so that the mesh has no surface; give triangles with three different vertices"
    )]
    AllDegenerate {
        /// How many faces there are.
        faces: usize,
    },
}

/// Why positions and triangles make no surface.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SurfaceError {
    /// The triangles are wrong.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// A topology is given other positions than it was made for.
    #[error(
        "there are {positions} positions for {vertices} vertices; give one position for each vertex"
    )]
    Count {
        /// How many positions were given.
        positions: usize,
        /// How many vertices the topology has.
        vertices: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error(
        "the position of vertex {vertex} is not finite; give coordinates that are neither infinite nor NaN"
    )]
    NotFinite {
        /// Number of the vertex, from 0.
        vertex: usize,
    },
    /// A coordinate is so large that areas and volumes overflow.
    #[error(
        "vertex {vertex} has a coordinate beyond 1e75, where areas overflow; scale the mesh down"
    )]
    TooLarge {
        /// Number of the vertex, from 0.
        vertex: usize,
    },
}

/// Why a place is not on a surface.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SurfacePointError {
    /// The vertex, edge or face does not exist.
    #[error("{what} {index} does not exist; the surface has {count}, numbered from 0")]
    NoSuch {
        /// `"vertex"`, `"edge"` or `"face"`.
        what: &'static str,
        /// The number given.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A fraction outside [0, 1], or not a number.
    #[error("the fraction {fraction} along edge {edge} is not between 0 and 1; clamp it")]
    Fraction {
        /// Number of the edge.
        edge: usize,
        /// The fraction given.
        fraction: f64,
    },
    /// Barycentric coordinates that are negative, not a number, or do not add up to 1.
    #[error(
        "the barycentric coordinates {}, {}, {} in face {face} are not a place in it; give three numbers that are not \
         negative and add up to 1", weights[0], weights[1], weights[2]
    )]
    Weights {
        /// Number of the face.
        face: usize,
        /// The coordinates given.
        weights: [f64; 3],
    },
    /// The face names a vertex twice and is no part of the surface.
    #[error("face {face} names a vertex twice and has no places; choose another face, or a vertex")]
    Degenerate {
        /// Number of the face.
        face: usize,
    },
    /// A point of space is infinite or not a number.
    #[error("the point is not finite; give coordinates that are neither infinite nor NaN")]
    NotFinite,
}
