//! Shapes with an inside: parts of closed curves, their colours, and how they are flattened to polygons.
//!
//! Curves stay curves until somebody asks for points. Flattening cuts a curve evenly by its parameter, into as many pieces as a bound of its
//! second derivative asks for, so that no piece is farther from the curve than the tolerance; the ends of all segments are kept. Nothing but
//! plain arithmetic and square roots is used, and the points are the same everywhere.
//!
//! *Source*: G.-Z. Wang, *The subdivision method for finding the intersection between two Bézier curves or surfaces*, Zhejiang University
//! Journal, 1984 (the number of pieces); W3C, *Scalable Vector Graphics (SVG) 2*, 2018, section 13.3.2 (rules of what is inside).

use anamorph_core::glam::DVec2;

/// Most pieces that a curve is cut into, whatever the tolerance.
pub const MOST_PIECES: usize = 4096;

/// A picture of filled shapes, or of a single one.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawing {
    /// What it is called, if the file says.
    pub name: Option<String>,
    /// The unit of its coordinates, if the file says: `px`, `degrees`.
    pub units: Option<String>,
    /// The shapes, each drawn over those before it.
    pub parts: Vec<Part>,
    /// What is meant to be seen: left, the lesser y, width and height; nothing where the file does not say.
    pub canvas: Option<[f64; 4]>,
    /// Whether y grows downwards, as in SVG and in images, or upwards, as on maps and in fonts.
    pub y_down: bool,
    /// What a user should know about how the file was understood, a sentence each.
    pub notes: Vec<String>,
}

/// A shape of one colour.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Part {
    /// Its name for machines, the same in the other drawing for the part that it becomes.
    pub id: Option<String>,
    /// Its name for people.
    pub name: String,
    /// Red, green, blue and opacity from 0 to 1, sRGB-encoded; nothing where it is not filled.
    pub fill: Option<[f64; 4]>,
    /// The line along its outline.
    pub stroke: Option<Stroke>,
    /// Which places are inside.
    pub rule: Rule,
    /// The outlines, in no particular order or direction.
    pub contours: Vec<Contour>,
}

/// Which places are inside of outlines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Rule {
    /// Those that the outlines wind around a number of times that is not zero, each way counted against the other.
    #[default]
    NonZero,
    /// Those from which a ray crosses the outlines an odd number of times.
    EvenOdd,
}

impl Rule {
    /// What SVG and polygon files call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NonZero => "nonzero",
            Self::EvenOdd => "evenodd",
        }
    }

    /// The rule of a name.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        [Self::NonZero, Self::EvenOdd]
            .into_iter()
            .find(|rule| rule.name() == name)
    }
}

/// A line along an outline, as it was read; it is not morphed.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    /// Red, green, blue and opacity from 0 to 1, sRGB-encoded.
    pub colour: [f64; 4],
    /// Its width in units of the drawing.
    pub width: f64,
    /// `butt`, `round` or `square`.
    pub cap: &'static str,
    /// `miter`, `round` or `bevel`.
    pub join: &'static str,
    /// How long a mitre may be, by the width.
    pub miter_limit: f64,
    /// Lengths of dashes and of the gaps between them, in units of the drawing; empty for a line without gaps.
    pub dashes: Vec<f64>,
}

/// A curve around an inside. For filling it is closed by a straight line, whether it says so or not.
#[derive(Debug, Clone, PartialEq)]
pub struct Contour {
    /// Where it begins.
    pub start: DVec2,
    /// What follows, each from the end of the one before.
    pub segments: Vec<Segment>,
    /// Whether a line along it closes it, too.
    pub closed: bool,
}

/// A piece of a contour; the last point is its end, and those before pull the curve (Bézier).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segment {
    /// Straight.
    Line(DVec2),
    /// Of degree 2.
    Quadratic([DVec2; 2]),
    /// Of degree 3.
    Cubic([DVec2; 3]),
}

impl Segment {
    /// Where it ends.
    #[must_use]
    pub fn end(&self) -> DVec2 {
        match self {
            Self::Line(end) => *end,
            Self::Quadratic([_, end]) => *end,
            Self::Cubic([_, _, end]) => *end,
        }
    }

    /// All its points but the first.
    #[must_use]
    pub fn points(&self) -> &[DVec2] {
        match self {
            Self::Line(end) => core::slice::from_ref(end),
            Self::Quadratic(points) => points,
            Self::Cubic(points) => points,
        }
    }

    /// The same with other points.
    #[must_use]
    pub fn map(&self, place: impl Fn(DVec2) -> DVec2) -> Self {
        match self {
            Self::Line(end) => Self::Line(place(*end)),
            Self::Quadratic(points) => Self::Quadratic(points.map(place)),
            Self::Cubic(points) => Self::Cubic(points.map(place)),
        }
    }

    /// How many pieces stay within `tolerance` of it.
    fn pieces(&self, start: DVec2, tolerance: f64) -> usize {
        // A chord over a share h of the parameter is at most h² / 8 times the largest second derivative away.
        let second = match self {
            Self::Line(_) => return 1,
            Self::Quadratic([a, end]) => 2.0 * (start - 2.0 * *a + *end).length(),
            Self::Cubic([a, b, end]) => {
                let first = (start - 2.0 * *a + *b).length();
                6.0 * first.max((*a - 2.0 * *b + *end).length())
            }
        };
        let pieces = (second / (8.0 * tolerance)).sqrt().ceil();
        // Comparisons with NaN fail: without a tolerance, the most.
        if pieces <= 1.0 {
            1
        } else if pieces < MOST_PIECES as f64 {
            pieces as usize
        } else {
            MOST_PIECES
        }
    }

    /// The place at a share `t` of the parameter.
    fn at(&self, start: DVec2, t: f64) -> DVec2 {
        let s = 1.0 - t;
        match self {
            Self::Line(end) => s * start + t * *end,
            Self::Quadratic([a, end]) => s * s * start + 2.0 * s * t * *a + t * t * *end,
            Self::Cubic([a, b, end]) => {
                s * s * s * start + 3.0 * s * s * t * *a + 3.0 * s * t * t * *b + t * t * t * *end
            }
        }
    }
}

impl Contour {
    /// The polygon through points; the last is joined to the first, which is not repeated. Nothing without a point.
    #[must_use]
    pub fn polygon(points: impl IntoIterator<Item = DVec2>) -> Option<Self> {
        let mut points = points.into_iter();
        Some(Self {
            start: points.next()?,
            segments: points.map(Segment::Line).collect(),
            closed: true,
        })
    }

    /// Whether it has no curves.
    #[must_use]
    pub fn is_polygon(&self) -> bool {
        self.segments
            .iter()
            .all(|segment| matches!(segment, Segment::Line(_)))
    }

    /// Where its last segment ends.
    #[must_use]
    pub fn end(&self) -> DVec2 {
        self.segments.last().map_or(self.start, Segment::end)
    }

    /// All points that describe it, those that only pull among them.
    pub fn points(&self) -> impl Iterator<Item = DVec2> + '_ {
        let rest = self.segments.iter().flat_map(Segment::points);
        core::iter::once(self.start).chain(rest.copied())
    }

    /// The same with other points.
    #[must_use]
    pub fn map(&self, place: impl Fn(DVec2) -> DVec2) -> Self {
        Self {
            start: place(self.start),
            segments: self
                .segments
                .iter()
                .map(|segment| segment.map(&place))
                .collect(),
            closed: self.closed,
        }
    }

    /// A ring of points that is nowhere farther than `tolerance` from the contour (in units of the drawing), with the ends of all segments
    /// among them. The first point is not repeated at the end. Points that the contour itself repeats are kept.
    ///
    /// A curve is cut into [`MOST_PIECES`] at most; a tolerance that is not positive asks for as many.
    #[must_use]
    pub fn flatten(&self, tolerance: f64) -> Vec<DVec2> {
        let mut ring = vec![self.start];
        let mut from = self.start;
        for segment in &self.segments {
            let pieces = segment.pieces(from, tolerance);
            for i in 1..pieces {
                ring.push(segment.at(from, i as f64 / pieces as f64));
            }
            from = segment.end();
            ring.push(from);
        }
        if ring.len() > 1 && ring.last() == ring.first() {
            ring.pop();
        }
        ring
    }

    /// Whether two contours are made of the same kinds of segments in the same order.
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        self.closed == other.closed
            && self.segments.len() == other.segments.len()
            && self
                .segments
                .iter()
                .zip(&other.segments)
                .all(|(a, b)| core::mem::discriminant(a) == core::mem::discriminant(b))
    }
}

impl Part {
    /// A part of polygons.
    #[must_use]
    pub fn of_rings(
        name: impl Into<String>,
        fill: Option<[f64; 4]>,
        rings: impl IntoIterator<Item = Vec<DVec2>>,
    ) -> Self {
        Self {
            name: name.into(),
            fill,
            contours: rings.into_iter().filter_map(Contour::polygon).collect(),
            ..Self::default()
        }
    }

    /// Whether two parts are made of the same kinds of segments in the same order.
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        self.contours.len() == other.contours.len()
            && self
                .contours
                .iter()
                .zip(&other.contours)
                .all(|(a, b)| a.is_like(b))
    }
}

impl Drawing {
    /// All points that describe it.
    pub fn points(&self) -> impl Iterator<Item = DVec2> + '_ {
        let contours = self.parts.iter().flat_map(|part| &part.contours);
        contours.flat_map(Contour::points)
    }

    /// The least box along the axes that holds all points that describe it, and so its curves.
    #[must_use]
    pub fn bounds(&self) -> Option<[DVec2; 2]> {
        let fold = |bounds: Option<[DVec2; 2]>, point: DVec2| match bounds {
            Some([low, high]) => Some([low.min(point), high.max(point)]),
            None => Some([point, point]),
        };
        self.points().fold(None, fold)
    }

    /// What is meant to be seen; where the file does not say, the bounds and a twentieth of the longer side around them.
    #[must_use]
    pub fn view(&self) -> [f64; 4] {
        self.canvas
            .unwrap_or_else(|| view_of(self.bounds().unwrap_or_default()))
    }

    /// The same drawing with y growing the other way or as it does, turned over at y = 0.
    #[must_use]
    pub fn turned(&self, y_down: bool) -> Self {
        if self.y_down == y_down {
            return self.clone();
        }
        let mut drawing = self.clone();
        drawing.y_down = y_down;
        drawing.canvas = self.canvas.map(|[x, y, w, h]| [x, 0.0 - (y + h), w, h]);
        for contour in drawing.parts.iter_mut().flat_map(|part| &mut part.contours) {
            // 0 − y has no negative zero.
            *contour = contour.map(|point| DVec2::new(point.x, 0.0 - point.y));
        }
        drawing
    }
}

/// A view of bounds: a twentieth of the longer side around them.
pub(super) fn view_of([low, high]: [DVec2; 2]) -> [f64; 4] {
    let size = high - low;
    let margin = if size.max_element() > 0.0 {
        0.05 * size.max_element()
    } else {
        1.0
    };
    let (low, size) = (low - margin, size + 2.0 * margin);
    [low.x, low.y, size.x, size.y]
}

#[cfg(test)]
mod tests {
    use super::*;
    use anamorph_core::glam::dvec2;

    /// A circle of four cubics about the origin, 2.8e-4 of its radius off.
    fn circle(radius: f64) -> Contour {
        const K: f64 = 0.552_284_749_8;
        let p = |x: f64, y: f64| dvec2(x, y) * radius;
        let quarter = |a, b, end| Segment::Cubic([a, b, end]);
        Contour {
            start: p(1.0, 0.0),
            segments: vec![
                quarter(p(1.0, K), p(K, 1.0), p(0.0, 1.0)),
                quarter(p(-K, 1.0), p(-1.0, K), p(-1.0, 0.0)),
                quarter(p(-1.0, -K), p(-K, -1.0), p(0.0, -1.0)),
                quarter(p(K, -1.0), p(1.0, -K), p(1.0, 0.0)),
            ],
            closed: true,
        }
    }

    #[test]
    fn flattening_stays_within_the_tolerance_and_keeps_ends() {
        for radius in [1.0, 300.0] {
            let circle = circle(radius);
            for tolerance in [1e-1, 1e-2, 1e-3] {
                let ring = circle.flatten(tolerance);
                let next = ring.iter().cycle().skip(1);
                for (a, b) in ring.iter().zip(next).take(ring.len()) {
                    // The middles of chords are farthest from the curve.
                    let off = ((*a + *b) * 0.5).length() - radius;
                    assert!(
                        off.abs() <= tolerance + 2.8e-4 * radius,
                        "{radius} {tolerance}: {off}"
                    );
                }
                for segment in &circle.segments {
                    assert!(ring.contains(&segment.end()));
                }
                assert_ne!(ring.first(), ring.last());
            }
            // Four times the points for a sixteenth of the tolerance, and no more.
            let [coarse, fine] = [1e-2, 1e-2 / 16.0].map(|t| circle.flatten(t).len());
            assert!((3 * coarse..=4 * coarse).contains(&fine), "{coarse} {fine}");
        }
    }

    #[test]
    fn flattening_ends_whatever_is_asked() {
        for tolerance in [0.0, -1.0, f64::NAN] {
            assert_eq!(circle(1.0).flatten(tolerance).len(), 4 * MOST_PIECES);
        }
        assert_eq!(circle(1.0).flatten(f64::INFINITY).len(), 4);
        let dot = Contour::polygon([dvec2(1.0, 2.0)]).unwrap();
        assert_eq!(dot.flatten(1.0), [dvec2(1.0, 2.0)]);
        assert!(Contour::polygon([]).is_none());
    }

    #[test]
    fn quadratics_are_cut_by_their_own_bound() {
        let arch = Contour {
            start: dvec2(0.0, 0.0),
            segments: vec![Segment::Quadratic([dvec2(1.0, 2.0), dvec2(2.0, 0.0)])],
            closed: false,
        };
        // y = 2 x − x², so that a chord of width h is h² / 4 away at most.
        let ring = arch.flatten(1e-3);
        for pair in ring.windows(2) {
            let h = pair[1].x - pair[0].x;
            assert!(h * h / 4.0 <= 1e-3 + 1e-12);
            assert!((pair[0].y - pair[0].x * (2.0 - pair[0].x)).abs() < 1e-12);
        }
    }

    #[test]
    fn turning_over_twice_changes_nothing() {
        let part = Part {
            contours: vec![circle(2.0)],
            ..Part::default()
        };
        let drawing = Drawing {
            parts: vec![part],
            canvas: Some([0.0, 1.0, 4.0, 5.0]),
            y_down: true,
            ..Drawing::default()
        };
        let up = drawing.turned(false);
        assert_eq!(up.canvas, Some([0.0, -6.0, 4.0, 5.0]));
        assert_eq!(up.parts[0].contours[0].segments[0].end(), dvec2(0.0, -2.0));
        assert_eq!(up.turned(true), drawing);
        assert_eq!(drawing.bounds(), Some([dvec2(-2.0, -2.0), dvec2(2.0, 2.0)]));
    }
}
