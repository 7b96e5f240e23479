//! A file in memory: its points, what hangs on them, and how it is written once they have moved.

use crate::{Geometry, Inspection, WriteError};
use anamorph_core::glam::{DVec2, DVec3};
use std::borrow::Cow;
use std::io::Write;

/// A file that has been read: points to move, and every byte needed to write it again.
///
/// A document never changes. Moving its points is the caller's business; [`Document::write`] then writes the original
/// with the moved points in place of its own.
pub trait Document: Send + Sync {
    /// The name of the format, as in the registry: `"obj"`.
    fn format(&self) -> &'static str;
    /// The positions, in file order and in the file's units.
    fn points(&self) -> Points<'_>;
    /// How many of the points, counted from the first, are the model as it is seen. Those behind them have to be moved with
    /// it (the places that morph targets lead to) but belong to none of its faces and do not count for its bounds.
    fn visible(&self) -> usize {
        self.points().len()
    }
    /// What a user should know about how the file was understood, a sentence each.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
    /// Names of other files that the written document refers to, relative to the place of the one that was read.
    fn companions(&self) -> Vec<String> {
        Vec::new()
    }
    /// Indices (from 0, ascending) of the points with a NaN or infinite coordinate. Empty unless
    /// [`ReadOptions::allow_nonfinite`](crate::ReadOptions::allow_nonfinite) was set. Such points are written as they were
    /// read, wherever they are said to have moved.
    fn nonfinite(&self) -> &[usize];
    /// How many normals the file stores. With none, the policy in [`Moved::normals`] is idle.
    fn normals(&self) -> usize {
        0
    }
    /// The faces as triangles, and the other elements; built on each call. `None` when the document has no elements.
    fn mesh(&self) -> Option<Mesh> {
        None
    }
    /// Names of the numbers that every point carries besides its position, such as `red` or a table's column.
    fn attributes(&self) -> Vec<String> {
        Vec::new()
    }
    /// The values of the attribute called `name`, one per point, or `None` when there is no such attribute.
    fn attribute(&self, name: &str) -> Option<Vec<f64>> {
        let _ = name;
        None
    }
    /// Counts, bounds, attributes and problems.
    fn inspect(&self) -> Inspection;
    /// The model without its file, with its points moved, to be written in another format.
    ///
    /// # Errors
    /// [`WriteError::Mismatch`] and [`WriteError::NonFinite`].
    fn geometry(&self, moved: &Moved<'_>) -> Result<Geometry, WriteError> {
        Geometry::of(self, moved)
    }
    /// Writes the document with its points moved. A point that has not moved (bit for bit) keeps its bytes, a moved one
    /// gets the shortest numbers that read back to exactly the new position (rounded once to 32 bits, where the file says
    /// that its numbers have so many), and nothing else changes but the normals that [`Moved::normals`] says.
    ///
    /// # Errors
    /// [`WriteError::Mismatch`], [`WriteError::NonFinite`] and [`WriteError::DoesNotFit`] before anything is written;
    /// [`WriteError::Output`] when `out` fails, with a part written.
    fn write(&self, moved: &Moved<'_>, out: &mut dyn Write) -> Result<WriteReport, WriteError>;
    /// Names of the formats, besides its own, that hold all that this document holds.
    fn sisters(&self) -> &'static [&'static str] {
        &[]
    }
    /// As [`Document::write`], in the form of one of [`Document::sisters`]; any other name is that of its own format.
    ///
    /// # Errors
    /// As [`Document::write`].
    fn write_as(
        &self,
        sister: &str,
        moved: &Moved<'_>,
        out: &mut dyn Write,
    ) -> Result<WriteReport, WriteError> {
        let _ = sister;
        self.write(moved, out)
    }
}

/// Positions, in the plane or in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Points<'a> {
    /// Points with two coordinates.
    Plane(&'a [DVec2]),
    /// Points with three coordinates.
    Solid(&'a [DVec3]),
}

impl<'a> Points<'a> {
    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Plane(points) => points.len(),
            Self::Solid(points) => points.len(),
        }
    }
    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Number of coordinates of a point: 2 or 3.
    #[must_use]
    pub fn dimension(&self) -> usize {
        match self {
            Self::Plane(_) => 2,
            Self::Solid(_) => 3,
        }
    }
    /// The points in space; those of the plane get z = 0.
    pub(crate) fn solid(self) -> Cow<'a, [DVec3]> {
        match self {
            Self::Plane(points) => points.iter().map(|p| p.extend(0.0)).collect(),
            Self::Solid(points) => Cow::Borrowed(points),
        }
    }
    fn space(&self) -> &'static str {
        match self {
            Self::Plane(_) => "the plane",
            Self::Solid(_) => "space",
        }
    }

    /// Checks that `moved` can stand in for these points: as many, of the same dimension, and finite where these are.
    pub(crate) fn check(&self, moved: &Points<'_>) -> Result<(), WriteError> {
        let bad: Vec<usize> = match (self, moved) {
            (Points::Plane(old), Points::Plane(new)) if old.len() == new.len() => (0..old.len())
                .filter(|&i| old[i].is_finite() && !new[i].is_finite())
                .collect(),
            (Points::Solid(old), Points::Solid(new)) if old.len() == new.len() => (0..old.len())
                .filter(|&i| old[i].is_finite() && !new[i].is_finite())
                .collect(),
            _ => {
                return Err(WriteError::Mismatch {
                    expected: self.len(),
                    space: self.space(),
                    got: moved.len(),
                    got_space: moved.space(),
                });
            }
        };
        match bad.first() {
            Some(&first) => Err(WriteError::NonFinite {
                first: first + 1,
                count: bad.len(),
            }),
            None => Ok(()),
        }
    }
}

/// How one normal changes: see [`Normals::Transform`].
pub type NormalMap<'a> = &'a (dyn Fn(usize, DVec3) -> DVec3 + Sync);

/// What becomes of stored normals when points move.
#[derive(Clone, Copy)]
pub enum Normals<'a> {
    /// They stay as they are, to the byte.
    Keep,
    /// The function gives, for a vertex (index from 0) and its old normal, the new normal, usually through the inverse
    /// transpose of the Jacobian; it is written as returned. One that is null or not finite leaves the old one in place.
    /// The function is called once for each pair of vertex and normal that a face uses, in no particular order.
    Transform(NormalMap<'a>),
    /// New ones from the moved faces: at a vertex, the mean of the unit normals of the faces around it, each weighted by
    /// the face's angle there (G. Thürmer and C. A. Wüthrich, "Computing Vertex Normals from Polygonal Facets", Journal
    /// of Graphics Tools 3(1), 1998). Smoothing stays as it was: faces count together at a vertex where they shared a
    /// normal there, and stay apart where they did not. A normal none of whose faces moved is kept.
    Recompute,
}

/// Where the points went, and what becomes of the directions stored with them.
#[derive(Clone, Copy)]
pub struct Moved<'a> {
    /// The new positions: as many and in the same order as [`Document::points`].
    pub points: Points<'a>,
    /// What becomes of stored normals; they are kept if nothing is said.
    pub normals: Normals<'a>,
    /// Gives, for a vertex (index from 0) and its old unit tangent, the new one, usually through the Jacobian. Without it,
    /// and where the new one is null or not finite, tangents stay as they are.
    pub tangents: Option<NormalMap<'a>>,
}

impl<'a> Moved<'a> {
    /// Moved points; directions stay as they are.
    #[must_use]
    pub fn new(points: Points<'a>) -> Self {
        Self {
            points,
            normals: Normals::Keep,
            tangents: None,
        }
    }
    /// Says what becomes of normals.
    #[must_use]
    pub fn with_normals(mut self, normals: Normals<'a>) -> Self {
        self.normals = normals;
        self
    }
    /// Says what becomes of tangents.
    #[must_use]
    pub fn with_tangents(mut self, tangents: NormalMap<'a>) -> Self {
        self.tangents = Some(tangents);
        self
    }
}

/// What [`Document::write`] did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct WriteReport {
    /// Points with at least one new coordinate.
    pub moved_points: usize,
    /// Normals whose numbers were replaced.
    pub changed_normals: usize,
    /// Normals added because vertices that shared one now need different ones.
    pub added_normals: usize,
    /// Pairs of vertex and normal for which no usable new normal was found, so that the old one stands.
    pub kept_normals: usize,
    /// Bytes written.
    pub bytes: u64,
}

/// The elements of a document, in terms of its points.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Mesh {
    /// Faces cut into triangles, wound as the faces are. A face is fanned from its first corner where that is correct, and
    /// cut ear by ear where it is concave.
    pub triangles: Vec<[u32; 3]>,
    /// Number of faces before cutting.
    pub faces: usize,
    /// Segments of the line elements.
    pub lines: Vec<[u32; 2]>,
    /// Point elements.
    pub points: Vec<u32>,
}
