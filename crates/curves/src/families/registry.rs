//! The families by name: what recipes call them, what commands list, what tests run over.
//!
//! *Source*: *Interpolation Techniques*, chapter 2, "Curve formulations"; each entry names its own. Decision: one table feeds
//! recipes, lists, the gallery and the tests, so that none can forget a family.

use super::{
    BSpline, BlendedParabolas, CatmullRom, CubicBezier, FourPoint, Generator, Hermite, Knots,
    KochanekBartels, Lagrange, Shape, Spacing,
};
use crate::{Bezier, CurveError, InverseArcLength, Pieces};
use anamorph_core::{Plane, Solid, Space};

/// Everything that a curve by name can do.
pub trait Path<S: Space>: InverseArcLength<S> + Pieces<S> {}

impl<S: Space, C: InverseArcLength<S> + Pieces<S>> Path<S> for C {}

/// What a family makes a curve from. What a family does not read must be empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Given<S> {
    /// Points or control points.
    pub points: Vec<S>,
    /// Velocities at the points.
    pub velocities: Vec<S>,
    /// Times, nodes or knots, as the family calls them.
    pub times: Vec<f64>,
    /// Whether the curve returns to its start.
    pub closed: bool,
    /// Named numbers; what is missing has its default.
    pub numbers: Vec<(String, f64)>,
}

impl<S> Given<S> {
    fn times(&self) -> Option<Vec<f64>> {
        (!self.times.is_empty()).then(|| self.times.clone())
    }
}

/// A number that a family takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number {
    /// Its name.
    pub name: &'static str,
    /// What it does, with its range.
    pub meaning: &'static str,
    /// What it is when not given.
    pub default: f64,
    /// Whether it is a question: 1 is yes, 0 no, and nothing else is an answer.
    pub flag: bool,
}

/// How a family makes a curve.
type Make<S> = fn(&Family, &Given<S>) -> Result<Box<dyn Path<S>>, CurveError>;

/// A family of curves.
pub struct Family {
    /// Its name in recipes.
    pub name: &'static str,
    /// Its name in sentences.
    pub title: &'static str,
    /// Where it comes from.
    pub reference: &'static str,
    /// What its points are, and what else it reads.
    pub reads: &'static str,
    /// Whether its curves can be closed.
    pub closes: bool,
    /// Whether it reads velocities.
    pub velocities: bool,
    /// What it calls its times, if it reads any.
    pub times: Option<&'static str>,
    /// Its numbers.
    pub numbers: &'static [Number],
    plane: Make<Plane>,
    space: Make<Solid>,
}

/// A space in which families make curves.
pub trait InFamily: Space {
    #[doc(hidden)]
    fn make(family: &Family, given: &Given<Self>) -> Result<Box<dyn Path<Self>>, CurveError>;
}

impl InFamily for Plane {
    fn make(family: &Family, given: &Given<Self>) -> Result<Box<dyn Path<Self>>, CurveError> {
        (family.plane)(family, given)
    }
}

impl InFamily for Solid {
    fn make(family: &Family, given: &Given<Self>) -> Result<Box<dyn Path<Self>>, CurveError> {
        (family.space)(family, given)
    }
}

impl Family {
    /// Makes a curve.
    ///
    /// # Errors
    ///
    /// What the family refuses, and input that it would not read.
    pub fn make<S: InFamily>(&self, given: &Given<S>) -> Result<Box<dyn Path<S>>, CurveError> {
        let unread = |what| CurveError::NotRead {
            family: self.name,
            what,
        };
        if given.closed && !self.closes {
            return Err(CurveError::NotClosed { family: self.name });
        }
        if !given.velocities.is_empty() && !self.velocities {
            return Err(unread("velocities".to_owned()));
        }
        if !given.times.is_empty() && self.times.is_none() {
            return Err(unread("times".to_owned()));
        }
        for (name, value) in &given.numbers {
            if !self.numbers.iter().any(|n| n.name == name) {
                return Err(unread(format!("`{name}`")));
            }
            if !value.is_finite() {
                return Err(CurveError::NotFinite {
                    what: "number",
                    index: 0,
                });
            }
            let flag = self.numbers.iter().any(|n| n.name == name && n.flag);
            if flag && *value != 0.0 && *value != 1.0 {
                return Err(CurveError::OutOfRange {
                    name: "what is asked with yes or no",
                    value: *value,
                    range: "1 (yes) or 0 (no)",
                });
            }
        }
        S::make(self, given)
    }

    fn number<S>(&self, given: &Given<S>, name: &str) -> f64 {
        let set = given.numbers.iter().find(|(n, _)| n == name);
        let default = || self.numbers.iter().find(|n| n.name == name);
        set.map(|(_, value)| *value)
            .or_else(|| default().map(|n| n.default))
            .unwrap_or(0.0)
    }
}

/// The family of that name.
#[must_use]
pub fn family(name: &str) -> Option<&'static Family> {
    FAMILIES.iter().find(|family| family.name == name)
}

fn boxed<S: Space, C: Path<S> + 'static>(curve: C) -> Result<Box<dyn Path<S>>, CurveError> {
    Ok(Box::new(curve))
}

fn lagrange<S: Space>(_: &Family, given: &Given<S>) -> Result<Box<dyn Path<S>>, CurveError> {
    let points = given.points.clone();
    match given.times() {
        Some(nodes) => boxed(Lagrange::at_nodes(nodes, points)?),
        None => boxed(Lagrange::new(points)?),
    }
}

fn hermite<S: Space>(_: &Family, given: &Given<S>) -> Result<Box<dyn Path<S>>, CurveError> {
    let hermite = Hermite {
        points: given.points.clone(),
        velocities: given.velocities.clone(),
        times: given.times(),
        closed: given.closed,
    };
    boxed(hermite.curve()?)
}

fn catmull_rom<S: Space>(
    family: &Family,
    given: &Given<S>,
) -> Result<Box<dyn Path<S>>, CurveError> {
    let spacing = Spacing::Power(family.number(given, "spacing"));
    let curve = CatmullRom {
        closed: given.closed,
        ..CatmullRom::new(given.points.clone()).spaced(spacing)
    };
    boxed(curve.curve()?)
}

fn parabolas<S: Space>(_: &Family, given: &Given<S>) -> Result<Box<dyn Path<S>>, CurveError> {
    let curve = BlendedParabolas {
        points: given.points.clone(),
        closed: given.closed,
    };
    boxed(curve.curve()?)
}

fn bezier<S: Space>(_: &Family, given: &Given<S>) -> Result<Box<dyn Path<S>>, CurveError> {
    let curve = CubicBezier {
        points: given.points.clone(),
        closed: given.closed,
    };
    boxed(curve.curve()?)
}

fn general_bezier<S: Space>(_: &Family, given: &Given<S>) -> Result<Box<dyn Path<S>>, CurveError> {
    boxed(Bezier::new(given.points.clone())?)
}

fn bspline<S: Space>(family: &Family, given: &Given<S>) -> Result<Box<dyn Path<S>>, CurveError> {
    let degree = family.number(given, "degree");
    if degree.fract() != 0.0 || !(1.0..=16.0).contains(&degree) {
        return Err(CurveError::OutOfRange {
            name: "the degree",
            value: degree,
            range: "a whole number from 1 to 16",
        });
    }
    if given.numbers.iter().any(|(name, value)| {
        name == "clamped" && (!given.times.is_empty() || given.closed && *value != 0.0)
    }) {
        let beside = if given.closed {
            "it is closed"
        } else {
            "there are `knots`"
        };
        return Err(CurveError::NotRead {
            family: family.name,
            what: format!("`clamped` where {beside}"),
        });
    }
    let curve = BSpline {
        points: given.points.clone(),
        degree: degree as usize,
        knots: match given.times() {
            Some(knots) => Knots::Given(knots),
            None if given.closed || family.number(given, "clamped") == 0.0 => Knots::Uniform,
            None => Knots::Clamped,
        },
        closed: given.closed,
    };
    if curve.degree <= 3 {
        boxed(curve.curve()?)
    } else {
        boxed(curve.pieces()?)
    }
}

fn kochanek_bartels<S: Space>(
    family: &Family,
    given: &Given<S>,
) -> Result<Box<dyn Path<S>>, CurveError> {
    let shape = Shape {
        tension: family.number(given, "tension"),
        continuity: family.number(given, "continuity"),
        bias: family.number(given, "bias"),
    };
    let curve = KochanekBartels {
        times: given.times(),
        closed: given.closed,
        ..KochanekBartels::new(given.points.clone(), shape)
    };
    boxed(curve.curve()?)
}

fn four_point<S: Space>(_: &Family, given: &Given<S>) -> Result<Box<dyn Path<S>>, CurveError> {
    let curve = FourPoint {
        points: given.points.clone(),
        closed: given.closed,
    };
    boxed(curve.curve()?)
}

/// All families, in the order of the slides.
pub static FAMILIES: &[Family] = &[
    Family {
        name: "lagrange",
        title: "Lagrange polynomial",
        reference: "Interpolation Techniques, chapter 2; Berrut and Trefethen 2004",
        reads: "2 to 33 points to pass, and when (0, 1, 2, … by default)",
        closes: false,
        velocities: false,
        times: Some("nodes"),
        numbers: &[],
        plane: lagrange,
        space: lagrange,
    },
    Family {
        name: "hermite",
        title: "Hermite curve",
        reference: "Interpolation Techniques, chapter 2",
        reads: "points to pass, a velocity at each, and when",
        closes: true,
        velocities: true,
        times: Some("times"),
        numbers: &[],
        plane: hermite,
        space: hermite,
    },
    Family {
        name: "catmull-rom",
        title: "Catmull–Rom curve",
        reference: "Catmull and Rom 1974; Yuksel, Schaefer and Keyser 2011",
        reads: "points to pass",
        closes: true,
        velocities: false,
        times: None,
        numbers: &[Number {
            name: "spacing",
            meaning: "power of the distance between knots, 0 (uniform) to 1 (chordal)",
            default: 0.5,
            flag: false,
        }],
        plane: catmull_rom,
        space: catmull_rom,
    },
    Family {
        name: "blended-parabolas",
        title: "Blended parabolas",
        reference: "Interpolation Techniques, chapter 2; Overhauser 1968",
        reads: "points to pass",
        closes: true,
        velocities: false,
        times: None,
        numbers: &[],
        plane: parabolas,
        space: parabolas,
    },
    Family {
        name: "bezier",
        title: "Cubic Bézier curves",
        reference: "Interpolation Techniques, chapter 2",
        reads: "4, 7, 10, … control points (closed: 3, 6, 9, …), every third of which is passed",
        closes: true,
        velocities: false,
        times: None,
        numbers: &[],
        plane: bezier,
        space: bezier,
    },
    Family {
        name: "general-bezier",
        title: "Bézier curve of any degree",
        reference: "Farin 2002, chapter 4",
        reads: "control points, of which the first and last are passed",
        closes: false,
        velocities: false,
        times: None,
        numbers: &[],
        plane: general_bezier,
        space: general_bezier,
    },
    Family {
        name: "b-spline",
        title: "B-spline",
        reference: "Interpolation Techniques, chapter 2; Farin 2002, chapter 8",
        reads: "control points, and knots (clamped uniform ones by default)",
        closes: true,
        velocities: false,
        times: Some("knots"),
        numbers: &[
            Number {
                name: "degree",
                meaning: "1 (a polyline) to 16",
                default: 3.0,
                flag: false,
            },
            Number {
                name: "clamped",
                meaning: "whether it runs from the first to the last control point; else its knots are uniform throughout",
                default: 1.0,
                flag: true,
            },
        ],
        plane: bspline,
        space: bspline,
    },
    Family {
        name: "tension-continuity-bias",
        title: "Tension, continuity and bias",
        reference: "Kochanek and Bartels 1984",
        reads: "points to pass, and when",
        closes: true,
        velocities: false,
        times: Some("times"),
        numbers: &[
            Number {
                name: "tension",
                meaning: "1 tight, 0 normal, -1 slack",
                default: 0.0,
                flag: false,
            },
            Number {
                name: "continuity",
                meaning: "0 smooth, towards -1 and 1 corners",
                default: 0.0,
                flag: false,
            },
            Number {
                name: "bias",
                meaning: "1 turns late, 0 evenly, -1 early",
                default: 0.0,
                flag: false,
            },
        ],
        plane: kochanek_bartels,
        space: kochanek_bartels,
    },
    Family {
        name: "four-point",
        title: "4-point form",
        reference: "Interpolation Techniques, chapter 2",
        reads: "4, 7, 10, … points to pass (closed: 3, 6, 9, …), three to a span",
        closes: true,
        velocities: false,
        times: None,
        numbers: &[],
        plane: four_point,
        space: four_point,
    },
];
