//! A model without its file: what one format gives when another is to be written.
//!
//! A [`Document`] keeps a file; a [`Geometry`] keeps what most formats have in common, and names the rest. A [`Target`]
//! writes it as a new file and says what got lost.

use crate::{Document, Moved, WriteError};
use anamorph_core::glam::{DVec2, DVec3};
use std::borrow::Cow;
use std::fmt;
use std::io::Write;

/// Points, polygons and what hangs on them.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Geometry {
    /// Whether the points lie in the plane; their z is 0 then.
    pub planar: bool,
    /// The positions.
    pub points: Vec<DVec3>,
    /// Red, green, blue and opacity from 0 to 1, sRGB-encoded, one for each point; empty where there are none.
    pub colours: Vec<[f64; 4]>,
    /// Other numbers of the points: a name, and a value for each point.
    pub attributes: Vec<(String, Vec<f64>)>,
    /// Point of each corner, one face after the other.
    pub corners: Vec<u32>,
    /// Where the corners of each face end.
    pub ends: Vec<usize>,
    /// Normals of points or corners, usually of unit length.
    pub normals: Values<DVec3>,
    /// Texture coordinates of points or corners, `v` upwards.
    pub textures: Values<DVec2>,
    /// Segments.
    pub lines: Vec<[u32; 2]>,
    /// Point elements.
    pub loose: Vec<u32>,
    /// What the source holds besides, in words, such as `2 materials`.
    pub beyond: Vec<String>,
}

/// Values of points or of corners.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Values<T> {
    /// There are none.
    #[default]
    None,
    /// One for each point.
    Points(Vec<T>),
    /// Some, and for each corner which of them it has.
    Corners {
        /// The values.
        pool: Vec<T>,
        /// The index of each corner's value.
        index: Vec<Option<u32>>,
    },
}

impl<T> Values<T> {
    /// Whether there are none.
    #[must_use]
    pub fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }
    /// All values, in the order that [`Values::index`] counts in.
    #[must_use]
    pub fn pool(&self) -> &[T] {
        match self {
            Self::None => &[],
            Self::Points(pool) | Self::Corners { pool, .. } => pool,
        }
    }
    /// Which of the [`pool`](Values::pool) a corner has, by its number and its point.
    #[must_use]
    pub fn index(&self, corner: usize, point: u32) -> Option<u32> {
        match self {
            Self::None => None,
            Self::Points(_) => Some(point),
            Self::Corners { index, .. } => index.get(corner).copied().flatten(),
        }
    }
}

impl<T: Copy + PartialEq + Default> Values<T> {
    /// One value for each of `count` points, where all corners have one and those of a point have equal ones; a point
    /// without corners gets the default, zero.
    pub(crate) fn per_point(&self, count: usize, corners: &[u32]) -> Option<Cow<'_, [T]>> {
        match self {
            Self::None => None,
            Self::Points(values) => Some(Cow::Borrowed(values)),
            Self::Corners { pool, index } => {
                let mut values: Vec<Option<T>> = vec![None; count];
                for (&point, index) in corners.iter().zip(index) {
                    let value = *pool.get((*index)? as usize)?;
                    let slot = values.get_mut(point as usize)?;
                    if slot.is_some_and(|other| other != value) {
                        return None;
                    }
                    *slot = Some(value);
                }
                Some(values.into_iter().map(Option::unwrap_or_default).collect())
            }
        }
    }
}

/// One value for each point, where that is possible.
type PerPoint<'a, T> = Option<Cow<'a, [T]>>;

impl Geometry {
    /// What every document can say of itself once its points have moved: points, triangles, lines and attributes.
    ///
    /// # Errors
    /// [`WriteError::Mismatch`] and [`WriteError::NonFinite`].
    pub fn of(document: &(impl Document + ?Sized), moved: &Moved<'_>) -> Result<Self, WriteError> {
        document.points().check(&moved.points)?;
        let visible = document.visible();
        let mut geometry = Self {
            planar: document.points().dimension() == 2,
            points: moved.points.solid()[..visible].to_vec(),
            ..Self::default()
        };
        geometry.take_attributes(document);
        if let Some(mesh) = document.mesh() {
            for triangle in mesh.triangles {
                geometry.push_face(triangle);
            }
            geometry.lines = mesh.lines;
            geometry.loose = mesh.points;
        }
        if document.normals() > 0 {
            geometry.beyond.push("normals".to_owned());
        }
        Ok(geometry)
    }

    /// Takes over a document's attributes, `red`, `green`, `blue` and `alpha` as colours.
    pub(crate) fn take_attributes(&mut self, document: &(impl Document + ?Sized)) {
        let count = self.points.len();
        let names = document.attributes();
        let value = |name: &str| {
            let known = names.iter().any(|known| known == name);
            let values = known.then(|| document.attribute(name)).flatten();
            values.filter(|values| values.len() >= count)
        };
        let mut coloured = false;
        if let (Some(red), Some(green), Some(blue)) = (value("red"), value("green"), value("blue"))
        {
            let alpha = value("alpha");
            let opacity = |i: usize| alpha.as_ref().map_or(1.0, |alpha| alpha[i]);
            self.colours = (0..count)
                .map(|i| [red[i], green[i], blue[i], opacity(i)])
                .collect();
            coloured = true;
        }
        for name in &names {
            if coloured && matches!(name.as_str(), "red" | "green" | "blue" | "alpha") {
                continue;
            }
            if let Some(mut values) = value(name) {
                values.truncate(count);
                self.attributes.push((name.clone(), values));
            }
        }
    }

    /// Adds a face by the points of its corners.
    pub(crate) fn push_face(&mut self, corners: impl IntoIterator<Item = u32>) {
        self.corners.extend(corners);
        self.ends.push(self.corners.len());
    }

    /// The faces: the number of the first corner, and the points of all.
    pub fn faces(&self) -> impl Iterator<Item = (usize, &[u32])> {
        let mut start = 0;
        self.ends.iter().map(move |&end| {
            let face = (start, &self.corners[start..end]);
            start = end;
            face
        })
    }

    /// The faces as triangles: numbers of corners, not points.
    pub(crate) fn corner_triangles(&self) -> Vec<[u32; 3]> {
        let (mut all, mut cut) = (Vec::new(), Vec::new());
        for (first, face) in self.faces() {
            if face.len() == 3 {
                all.push([0, 1, 2].map(|i| (first + i) as u32));
                continue;
            }
            let points: Vec<DVec3> = face.iter().map(|&v| self.points[v as usize]).collect();
            let local: Vec<u32> = (0..face.len() as u32).collect();
            cut.clear();
            crate::faces::triangulate(&local, &points, &mut cut);
            all.extend(cut.iter().map(|t| t.map(|i| first as u32 + i)));
        }
        all
    }

    /// Normals and texture coordinates one a point, where that is possible; else they are added to `lost`.
    pub(crate) fn per_point(
        &self,
        format: &str,
        lost: &mut Lost,
    ) -> (PerPoint<'_, DVec3>, PerPoint<'_, DVec2>) {
        let count = self.points.len();
        let normals = self.normals.per_point(count, &self.corners);
        lost.add(
            normals.is_none() && !self.normals.is_none(),
            format!("normals (points have several, {format} holds one for each)"),
        );
        (normals, self.textures.per_point(count, &self.corners))
    }

    /// Whether some face is no triangle.
    pub(crate) fn has_polygons(&self) -> bool {
        self.faces().any(|(_, face)| face.len() != 3)
    }

    /// Whether some colour is not opaque.
    pub(crate) fn has_opacity(&self) -> bool {
        self.colours.iter().any(|c| c[3] != 1.0)
    }

    /// Checks that the positions can be rounded to 32 bits, and says whether that changes any.
    pub(crate) fn check_single(&self, format: &str) -> Result<bool, WriteError> {
        let mut rounded = false;
        for (i, point) in self.points.iter().enumerate() {
            for value in point.to_array() {
                if value.is_finite() && !(value as f32).is_finite() {
                    return Err(WriteError::DoesNotFit {
                        what: format!(
                            "the coordinate {value} of point {} is too large for the 32-bit numbers of {format}",
                            i + 1
                        ),
                        mend: "scale the model down, or write it as PLY or OBJ",
                    });
                }
                rounded |= f64::from(value as f32).to_bits() != value.to_bits();
            }
        }
        Ok(rounded)
    }
}

/// What a written file does not hold of what its source did.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Lost(pub Vec<String>);

impl Lost {
    /// Whether nothing got lost.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
    pub(crate) fn add(&mut self, lost: bool, what: impl Into<String>) {
        if lost {
            self.0.push(what.into());
        }
    }
    /// The attributes that are not written, by name.
    pub(crate) fn add_attributes(&mut self, geometry: &Geometry) {
        const MOST: usize = 8;
        let names: Vec<&str> = geometry
            .attributes
            .iter()
            .map(|(n, _)| n.as_str())
            .collect();
        let plural = if names.len() == 1 { "" } else { "s" };
        match names.len() {
            0 => {}
            1..=MOST => self
                .0
                .push(format!("the attribute{plural} {}", names.join(", "))),
            more => self.0.push(format!("{more} attributes")),
        }
    }
}

impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join(", "))
    }
}

/// Writes a geometry as a new file.
pub type Create = fn(&Geometry, &mut dyn Write) -> Result<Lost, WriteError>;

/// A format that a [`Geometry`] can be written in: an entry of [`targets`](crate::targets).
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Target {
    /// Its short name, that of the format where there is one.
    pub name: &'static str,
    /// What it is called in prose.
    pub title: &'static str,
    /// Extensions of such files, in lower case, without the point.
    pub extensions: &'static [&'static str],
    pub(crate) create: Create,
}

impl Target {
    /// Writes a geometry; the result names what the format cannot hold.
    ///
    /// # Errors
    /// [`WriteError::DoesNotFit`] before anything is written; [`WriteError::Output`] when `out` fails, with a part
    /// written.
    pub fn create(&self, geometry: &Geometry, out: &mut dyn Write) -> Result<Lost, WriteError> {
        (self.create)(geometry, out)
    }
}
