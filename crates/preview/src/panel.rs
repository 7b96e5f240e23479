//! What is drawn: a model and the marks over it.

use anamorph_core::glam::{DVec2, DVec3};
use anamorph_core::{Mark, Space};

mod sealed {
    pub trait Sealed {}
    impl Sealed for anamorph_core::glam::DVec2 {}
    impl Sealed for anamorph_core::glam::DVec3 {}
}

/// A space that can be drawn: the plane ([`DVec2`]) as a flat drawing on a grid, space ([`DVec3`]) in light and shadow.
pub trait Drawable: Space + sealed::Sealed {
    /// Whether it is drawn flat.
    const FLAT: bool;
    /// The point in space; a point of the plane lies at `z = 0`.
    fn lift(self) -> DVec3;
}

impl Drawable for DVec2 {
    const FLAT: bool = true;
    fn lift(self) -> DVec3 {
        DVec3::new(self.x, self.y, 0.0)
    }
}

impl Drawable for DVec3 {
    const FLAT: bool = false;
    fn lift(self) -> DVec3 {
        self
    }
}

/// The model of a panel, borrowed. With triangles or lines these are drawn, otherwise the points.
///
/// What cannot be drawn is left out: points that are not finite, triangles and lines that name such a point or one that
/// does not exist, triangles without area (if no triangle and no line remains, the points are drawn).
#[derive(Debug, Clone, Copy)]
pub struct Model<'a, S> {
    /// `n` points, scene units.
    pub points: &'a [S],
    /// Triangles as indices into the points; counter-clockwise seen from outside. The inside is drawn cooler.
    pub triangles: &'a [[u32; 3]],
    /// Lines as pairs of indices into the points.
    pub lines: &'a [[u32; 2]],
    /// One colour for each point, red, green and blue from 0 to 1, sRGB-encoded as in OBJ and PLY files. A point that
    /// has none (too short a slice) or a non-finite one gets the colour of the material.
    pub colours: Option<&'a [[f32; 3]]>,
}

impl<'a, S> Model<'a, S> {
    /// Points alone.
    #[must_use]
    pub fn cloud(points: &'a [S]) -> Self {
        Self {
            points,
            triangles: &[],
            lines: &[],
            colours: None,
        }
    }

    /// A triangle mesh.
    #[must_use]
    pub fn mesh(points: &'a [S], triangles: &'a [[u32; 3]]) -> Self {
        Self {
            points,
            triangles,
            lines: &[],
            colours: None,
        }
    }

    /// The same model with these lines.
    #[must_use]
    pub fn with_lines(self, lines: &'a [[u32; 2]]) -> Self {
        Self { lines, ..self }
    }

    /// The same model with these colours.
    #[must_use]
    pub fn with_colours(self, colours: &'a [[f32; 3]]) -> Self {
        Self {
            colours: Some(colours),
            ..self
        }
    }
}

/// One view: a model and what is drawn over it.
#[derive(Debug, Clone, Copy)]
pub struct Panel<'a, S> {
    /// The model.
    pub model: Model<'a, S>,
    /// Lines, points and arrows over it; parts behind the model are drawn faded.
    pub marks: &'a [Mark<S>],
}

impl<'a, S> Panel<'a, S> {
    /// A model without marks.
    #[must_use]
    pub fn new(model: Model<'a, S>) -> Self {
        Self { model, marks: &[] }
    }

    /// The same model with these marks over it.
    #[must_use]
    pub fn with_marks(self, marks: &'a [Mark<S>]) -> Self {
        Self { marks, ..self }
    }
}
