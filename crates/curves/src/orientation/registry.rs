//! The orientations by name: what recipes call them, what commands list, what tests run over.

use super::directions;
use super::error::{in_range, of_path};
use super::{
    Auxiliary, Banking, End, FixedUp, Flips, Frenet, FrenetUp, LookAhead, LookAt, OrientationError,
    Orienter, Pairing, Role, RotationMinimizing, Speed, UpdatedUp,
};
use crate::families::registry::Path;
use anamorph_core::Solid;
use anamorph_core::glam::DVec3;
use std::sync::Arc;

/// A path that orientations by name share.
pub type SharedPath = Arc<dyn Path<Solid>>;

/// The value of a parameter.
#[derive(Clone)]
pub enum Value {
    /// A number; angles are in radians.
    Number(f64),
    /// A vector or point, in scene units.
    Vector(DVec3),
    /// One of the words of a choice.
    Word(String),
    /// A curve.
    Curve(SharedPath),
}

impl core::fmt::Debug for Value {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Number(value) => write!(f, "Number({value})"),
            Self::Vector(value) => write!(f, "Vector({value})"),
            Self::Word(value) => write!(f, "Word({value})"),
            Self::Curve(_) => f.write_str("Curve(…)"),
        }
    }
}

/// What a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Takes {
    /// A number, with its default.
    Number(Option<f64>),
    /// A vector or point, with its default.
    Vector(Option<DVec3>),
    /// One of these words, by default the first.
    Word(&'static [&'static str]),
    /// A curve.
    Curve,
}

impl Takes {
    fn in_words(self) -> &'static str {
        match self {
            Self::Number(_) => "a number",
            Self::Vector(_) => "a vector",
            Self::Word(_) => "a word",
            Self::Curve => "a curve",
        }
    }
}

/// A parameter of an orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: &'static str,
    /// What it does, with its range and unit.
    pub meaning: &'static str,
    /// What it takes.
    pub takes: Takes,
    /// Whether it must be given.
    pub required: bool,
}

const fn optional(name: &'static str, meaning: &'static str, takes: Takes) -> Parameter {
    Parameter {
        name,
        meaning,
        takes,
        required: false,
    }
}

const fn required(name: &'static str, meaning: &'static str, takes: Takes) -> Parameter {
    Parameter {
        name,
        meaning,
        takes,
        required: true,
    }
}

/// Parameters by name; what is missing has its default.
pub type Settings = [(String, Value)];

/// How an orientation is made.
type Make = fn(&Given<'_>, SharedPath) -> Result<Box<dyn Orienter>, OrientationError>;

/// An orientation.
pub struct Orientation {
    /// Its name in recipes.
    pub name: &'static str,
    /// Its name in sentences.
    pub title: &'static str,
    /// Where it comes from.
    pub reference: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
    /// What it reads.
    pub parameters: &'static [Parameter],
    make: Make,
}

/// How frames that exist are changed.
type Modify =
    fn(&Given<'_>, Box<dyn Orienter>, SharedPath) -> Result<Box<dyn Orienter>, OrientationError>;

/// A change of the frames of any orientation.
pub struct Modifier {
    /// Its name in recipes.
    pub name: &'static str,
    /// Its name in sentences.
    pub title: &'static str,
    /// Where it comes from.
    pub reference: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
    /// What it reads.
    pub parameters: &'static [Parameter],
    modify: Modify,
}

/// Settings that fit the parameters.
struct Given<'a> {
    kind: &'static str,
    parameters: &'static [Parameter],
    settings: &'a Settings,
}

impl<'a> Given<'a> {
    fn new(
        kind: &'static str,
        parameters: &'static [Parameter],
        settings: &'a Settings,
    ) -> Result<Self, OrientationError> {
        let names: Vec<String> = parameters.iter().map(|p| format!("`{}`", p.name)).collect();
        let not_read = |what| OrientationError::NotRead {
            kind,
            what,
            known: names.join(", "),
        };
        for (at, (name, value)) in settings.iter().enumerate() {
            let Some(parameter) = parameters.iter().find(|p| p.name == name) else {
                return Err(not_read(format!("`{name}`")));
            };
            if settings[..at].iter().any(|(other, _)| other == name) {
                return Err(not_read(format!("`{name}` twice")));
            }
            match (parameter.takes, value) {
                (Takes::Word(choices), Value::Word(word)) => {
                    if !choices.contains(&word.as_str()) {
                        let list: Vec<String> =
                            choices.iter().map(|c| format!("\"{c}\"")).collect();
                        return Err(OrientationError::NoChoice {
                            name: parameter.name,
                            value: word.clone(),
                            choices: list.join(", "),
                        });
                    }
                }
                (Takes::Number(_), Value::Number(_))
                | (Takes::Vector(_), Value::Vector(_))
                | (Takes::Curve, Value::Curve(_)) => {}
                (takes, _) => {
                    return Err(OrientationError::WrongType {
                        name: parameter.name,
                        takes: takes.in_words(),
                    });
                }
            }
        }
        let given = |name| settings.iter().any(|(other, _)| other == name);
        match parameters.iter().find(|p| p.required && !given(p.name)) {
            Some(missing) => Err(OrientationError::Missing {
                kind,
                name: missing.name,
                meaning: missing.meaning,
            }),
            None => Ok(Self {
                kind,
                parameters,
                settings,
            }),
        }
    }

    fn value(&self, name: &str) -> Option<&Value> {
        let mut settings = self.settings.iter();
        settings
            .find(|(other, _)| other == name)
            .map(|(_, value)| value)
    }

    fn takes(&self, name: &str) -> Option<Takes> {
        self.parameters
            .iter()
            .find(|p| p.name == name)
            .map(|p| p.takes)
    }

    fn number(&self, name: &str) -> f64 {
        match (self.value(name), self.takes(name)) {
            (Some(Value::Number(value)), _) => *value,
            (_, Some(Takes::Number(Some(value)))) => value,
            _ => 0.0,
        }
    }

    fn vector(&self, name: &str) -> Option<DVec3> {
        match (self.value(name), self.takes(name)) {
            (Some(Value::Vector(value)), _) => Some(*value),
            (_, Some(Takes::Vector(default))) => default,
            _ => None,
        }
    }

    fn up(&self) -> DVec3 {
        self.vector("up").unwrap_or(DVec3::Y)
    }

    /// Whether a choice is for that word.
    fn is(&self, name: &str, word: &str) -> bool {
        match (self.value(name), self.takes(name)) {
            (Some(Value::Word(value)), _) => value == word,
            (_, Some(Takes::Word(choices))) => choices.first() == Some(&word),
            _ => false,
        }
    }

    fn curve(
        &self,
        name: &'static str,
        meaning: &'static str,
    ) -> Result<SharedPath, OrientationError> {
        match self.value(name) {
            Some(Value::Curve(curve)) => Ok(Arc::clone(curve)),
            _ => Err(OrientationError::Missing {
                kind: self.kind,
                name,
                meaning,
            }),
        }
    }
}

impl Orientation {
    /// Makes the frames along a path.
    ///
    /// # Errors
    ///
    /// Settings that it does not read or that are not what it needs, and what it refuses.
    pub fn make(
        &self,
        path: SharedPath,
        settings: &Settings,
    ) -> Result<Box<dyn Orienter>, OrientationError> {
        let given = Given::new(self.name, self.parameters, settings)?;
        (self.make)(&given, path)
    }
}

impl Modifier {
    /// Changes frames that were made along the same path.
    ///
    /// # Errors
    ///
    /// Settings that it does not read or that are not what it needs, and what it refuses.
    pub fn modify(
        &self,
        base: Box<dyn Orienter>,
        path: SharedPath,
        settings: &Settings,
    ) -> Result<Box<dyn Orienter>, OrientationError> {
        let given = Given::new(self.name, self.parameters, settings)?;
        (self.modify)(&given, base, path)
    }
}

/// The orientation of that name.
#[must_use]
pub fn orientation(name: &str) -> Option<&'static Orientation> {
    ORIENTATIONS.iter().find(|entry| entry.name == name)
}

/// The modifier of that name.
#[must_use]
pub fn modifier(name: &str) -> Option<&'static Modifier> {
    MODIFIERS.iter().find(|entry| entry.name == name)
}

fn minimizing(given: &Given<'_>, path: SharedPath) -> Result<Box<dyn Orienter>, OrientationError> {
    let turns = given.number("turns");
    let holds = turns.fract() == 0.0 && turns.abs() <= 1e6;
    let turns = in_range(
        "`turns`",
        turns,
        holds,
        "a whole number up to a million either way",
    )?;
    let settings = RotationMinimizing {
        up: given.up(),
        end: match given.vector("end-up") {
            Some(up) => End::Up(up),
            None if given.is("end", "free") => End::Free,
            None => End::Close,
        },
        turns: turns as i32,
        accuracy: given.number("accuracy"),
    };
    Ok(Box::new(settings.along(path)?))
}

fn frenet(given: &Given<'_>, path: SharedPath) -> Result<Box<dyn Orienter>, OrientationError> {
    let settings = Frenet {
        axis: if given.is("axis", "binormal") {
            FrenetUp::Binormal
        } else {
            FrenetUp::Normal
        },
        flips: if given.is("flips", "as-printed") {
            Flips::AsPrinted
        } else {
            Flips::Repaired
        },
        up: given.up(),
    };
    Ok(Box::new(settings.along(path)?))
}

fn up(given: &Given<'_>, path: SharedPath) -> Result<Box<dyn Orienter>, OrientationError> {
    Ok(Box::new(FixedUp::along(path, given.up())?))
}

fn updated_up(given: &Given<'_>, path: SharedPath) -> Result<Box<dyn Orienter>, OrientationError> {
    Ok(Box::new(UpdatedUp::along(path, given.up())?))
}

fn look_ahead(given: &Given<'_>, path: SharedPath) -> Result<Box<dyn Orienter>, OrientationError> {
    let distance = given.number("distance");
    Ok(Box::new(LookAhead::along(path, distance, given.up())?))
}

fn look_at(given: &Given<'_>, path: SharedPath) -> Result<Box<dyn Orienter>, OrientationError> {
    let target = given.vector("target").unwrap_or(DVec3::ZERO);
    Ok(Box::new(LookAt::along(path, target, given.up())?))
}

fn auxiliary(given: &Given<'_>, path: SharedPath) -> Result<Box<dyn Orienter>, OrientationError> {
    let other = given.curve("curve", "the curve beside the path")?;
    let role = if given.is("role", "up") {
        Role::Up
    } else {
        Role::Direction
    };
    let pairing = if given.is("pairing", "length") {
        Pairing::Length
    } else {
        Pairing::Parameter
    };
    Ok(Box::new(Auxiliary::along(
        path,
        other,
        role,
        pairing,
        given.up(),
    )?))
}

/// Half the width over which leans are averaged, in shares of the path, where a setting does not say it.
const SMOOTHING: f64 = 0.02;

fn banking(
    given: &Given<'_>,
    base: Box<dyn Orienter>,
    path: SharedPath,
) -> Result<Box<dyn Orienter>, OrientationError> {
    // Most families bend anew at each of their points: without any smoothing, leans would jump there.
    let smoothing = match given.value("smoothing") {
        Some(Value::Number(smoothing)) => *smoothing,
        _ => {
            SMOOTHING
                * path.length(1e-3 * directions::Directions::new(&*path).map_err(of_path)?.size())
        }
    };
    let settings = Banking {
        speed: Speed::Constant(given.number("speed")),
        gravity: given.number("gravity"),
        gain: given.number("gain"),
        limit: given.number("limit"),
        smoothing,
    };
    Ok(Box::new(settings.of(base, path)?))
}

const UP: Parameter = optional("up", "the up vector", Takes::Vector(Some(DVec3::Y)));
const FIRST_UP: Parameter = optional(
    "up",
    "the up vector of the first frame",
    Takes::Vector(Some(DVec3::Y)),
);

/// All orientations, the default first.
pub static ORIENTATIONS: &[Orientation] = &[
    Orientation {
        name: "rotation-minimizing",
        title: "Rotation-minimizing frames",
        reference: "Wang, Jüttler, Zheng and Liu 2008",
        summary: "along the path, carried along without twist; closed paths close",
        parameters: &[
            FIRST_UP,
            optional(
                "end-up",
                "the up vector of the last frame; the difference is spread evenly by arc length",
                Takes::Vector(None),
            ),
            optional(
                "end",
                "what closed paths do with the twist left over after a round: spread it, or leave a jump",
                Takes::Word(&["close", "free"]),
            ),
            optional(
                "turns",
                "whole turns added over the path, clockwise as seen facing forward",
                Takes::Number(Some(0.0)),
            ),
            optional(
                "accuracy",
                "the largest error of the twist, up to 0.1 radians",
                Takes::Number(Some(super::ACCURACY)),
            ),
        ],
        make: minimizing,
    },
    Orientation {
        name: "frenet",
        title: "Frenet frames",
        reference: "Interpolation Techniques, chapter 2",
        summary: "along the path, up towards the centre of curvature",
        parameters: &[
            optional(
                "axis",
                "which of the curve's vectors is up",
                Takes::Word(&["normal", "binormal"]),
            ),
            optional(
                "flips",
                "what frames do at inflections: carry their sign through, or flip",
                Takes::Word(&["repaired", "as-printed"]),
            ),
            optional(
                "up",
                "the up vector of the first frame of a path that is straight all along",
                Takes::Vector(Some(DVec3::Y)),
            ),
        ],
        make: frenet,
    },
    Orientation {
        name: "up",
        title: "Fixed up vector",
        reference: "Interpolation Techniques, chapter 2",
        summary: "along the path, head up",
        parameters: &[UP],
        make: up,
    },
    Orientation {
        name: "updated-up",
        title: "Updated up vector",
        reference: "Interpolation Techniques, chapter 2",
        summary: "along the path, up made from that of the sample before; depends on the samples",
        parameters: &[FIRST_UP],
        make: updated_up,
    },
    Orientation {
        name: "look-ahead",
        title: "Look ahead",
        reference: "Interpolation Techniques, chapter 2",
        summary: "to where the path is a distance further on",
        parameters: &[
            required(
                "distance",
                "how far ahead along the path, 0 or more scene units",
                Takes::Number(None),
            ),
            UP,
        ],
        make: look_ahead,
    },
    Orientation {
        name: "look-at",
        title: "Look at a point",
        reference: "Interpolation Techniques, chapter 2",
        summary: "to a point that does not move",
        parameters: &[
            required("target", "the point to look at", Takes::Vector(None)),
            UP,
        ],
        make: look_at,
    },
    Orientation {
        name: "auxiliary",
        title: "Auxiliary curve",
        reference: "Interpolation Techniques, chapter 2",
        summary: "to a point that runs along another curve, or up towards it",
        parameters: &[
            required("curve", "the curve beside the path", Takes::Curve),
            optional(
                "role",
                "what the curve is for",
                Takes::Word(&["direction", "up"]),
            ),
            optional(
                "pairing",
                "which points belong together: those at equal shares of the parameter or of the length",
                Takes::Word(&["parameter", "length"]),
            ),
            UP,
        ],
        make: auxiliary,
    },
];

/// All modifiers.
pub static MODIFIERS: &[Modifier] = &[Modifier {
    name: "banking",
    title: "Banking",
    reference: "Interpolation Techniques, chapter 2",
    summary: "leans into turns, as a coordinated turn does",
    parameters: &[
        optional(
            "speed",
            "how fast the path is travelled, in scene units a second",
            Takes::Number(Some(1.0)),
        ),
        optional(
            "gravity",
            "scene units a second squared",
            Takes::Number(Some(9.81)),
        ),
        optional(
            "gain",
            "how much to lean; 1 is a coordinated turn, negative numbers lean out",
            Takes::Number(Some(1.0)),
        ),
        optional(
            "limit",
            "the largest lean, up to π/2 radians",
            Takes::Number(Some(core::f64::consts::FRAC_PI_3)),
        ),
        optional(
            "smoothing",
            "half the width over which leans are averaged, in scene units; a fiftieth of the path if left out, and 0 jumps where the \
             curvature does",
            Takes::Number(None),
        ),
    ],
    modify: banking,
}];
